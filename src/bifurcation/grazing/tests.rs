//! Ranges in which the system is stiff, or the law fails, at some velocities.

use super::*;
use crate::friction::{Polynomial, Stribeck};
use crate::scalar::Scalar;
use approx::assert_abs_diff_eq;

#[test]
fn a_range_with_stiff_velocities_has_its_harmless_answer() {
    let law = Polynomial::new(0.4, 0.2, 0.3).unwrap();
    let system = MassOnBelt::new(law, 0.2)
        .and_then(|system| system.with_damping(0.02))
        .and_then(|system| system.with_load(2.5))
        .unwrap();
    let found = grazing_velocities(&system, 1e-4..8.0).unwrap();
    let [grazing] = found[..] else {
        panic!("{found:?}")
    };
    assert_abs_diff_eq!(grazing, 0.2904677118946553, epsilon = 1e-13);
    // A system that is overdamped at every belt velocity down to 0.
    let law = Stribeck::new(0.4, 0.25, 0.05, 1).unwrap();
    let system = MassOnBelt::new(law, 0.2)
        .unwrap()
        .with_damping(50.0)
        .unwrap();
    assert_eq!(grazing_velocities(&system, 0.0..1.0), Ok(vec![]));
}

/// A law that is NaN at speeds between 1 and 2.
#[derive(Debug, Clone, Copy)]
struct Gap;

impl FrictionLaw for Gap {
    fn static_coefficient(&self) -> f64 {
        0.4
    }
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        let value = if (1.0..2.0).contains(&speed.value()) {
            f64::NAN
        } else {
            0.3
        };
        speed * 0.0 + value
    }
}

#[test]
fn an_error_tells_at_which_velocity_it_happened() {
    let system = MassOnBelt::new(Gap, 0.2).unwrap();
    match grazing_velocities(&system, 0.1..6.5) {
        Err(error) => {
            let Error::At {
                parameter,
                value,
                source,
            } = &error
            else {
                panic!("{error}")
            };
            assert_eq!(*parameter, "belt_velocity");
            assert!((0.1..2.0).contains(value));
            assert!(
                matches!(**source, Error::NonFiniteFriction { .. }),
                "{source}"
            );
            // `std::error::Error::source` gives the error inside.
            let inner = std::error::Error::source(&error).unwrap();
            assert_eq!(inner.to_string(), source.to_string());
        }
        other => panic!("{other:?}"),
    }
}
