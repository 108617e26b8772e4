//! Systems for which the search once failed.

use super::*;
use crate::friction::{Coulomb, Polynomial, Stribeck};
use approx::assert_abs_diff_eq;

#[test]
fn a_leading_slip_that_cannot_begin_at_the_end_of_the_stick_band_is_not_followed() {
    // System 8822 of the soak: μ̂(0) = μ_s, and a belt 240 000 times as fast as v_m.
    let law = Polynomial::new(
        0.0631621354498618,
        0.04293497287149199,
        0.00011546861552758402,
    );
    let system = MassOnBelt::new(law.unwrap(), -27.620406873625818)
        .and_then(|system| system.with_damping(0.07898895542034953))
        .and_then(|system| system.with_load(0.20974019958398257))
        .unwrap();
    assert_eq!(find(&system).map(|cycles| cycles.len()), Ok(0));
}

#[test]
fn an_overdamped_mass_on_a_slow_belt_settles() {
    let law = Stribeck::new(0.4, 0.25, 0.05, 1).unwrap();
    let viscous = law.with_viscous_coefficient(50.0).unwrap();
    for v_b in [1e-5, 1e-6, 1e-7, 1e-9] {
        for (law, damping) in [(viscous, 0.05), (law, 50.0)] {
            let system = MassOnBelt::new(law, v_b)
                .unwrap()
                .with_damping(damping)
                .unwrap();
            assert!(system.equilibrium().unwrap().is_stable());
            assert_eq!(
                find(&system).map(|cycles| cycles.len()),
                Ok(0),
                "{v_b} {damping}"
            );
        }
    }
}

#[test]
fn a_pure_slip_cycle_is_whole() {
    let law = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    let system = MassOnBelt::new(law, 0.42)
        .unwrap()
        .with_damping(0.05)
        .unwrap();
    let cycles = find(&system).unwrap();
    let [cycle] = cycles.iter().collect::<Vec<_>>()[..] else {
        panic!("{cycles:?}")
    };
    assert_eq!(cycle.kind(), CycleKind::PureSlip);
    // The motion closes after a period.
    let motion = system.simulate(cycle.state(), cycle.period()).unwrap();
    let (start, end) = (cycle.state(), motion.last());
    assert_abs_diff_eq!(end.displacement, start.displacement, epsilon = 1e-13);
    assert_abs_diff_eq!(end.velocity, start.velocity, epsilon = 1e-13);
}

#[test]
fn nothing_is_unresolved_where_rounding_hides_that_every_motion_dies() {
    // Motions that shrink by less than 1e-15 of themselves over a turn; and a belt so slow that
    // rounding of the force is larger than any change.
    let coulomb = MassOnBelt::new(Coulomb::new(0.4, 0.4).unwrap(), 0.2).unwrap();
    let slow = MassOnBelt::new(Polynomial::new(0.4, 0.4, 0.5).unwrap(), 1e-9).unwrap();
    for damping in [1e-17, 1e-30, 1e-300] {
        for cycles in [
            find(&coulomb.with_damping(damping).unwrap()).unwrap(),
            find(&slow.with_damping(damping).unwrap()).unwrap(),
        ] {
            assert!(cycles.is_empty(), "{damping:e} {cycles:?}");
            assert!(cycles.unresolved().is_empty(), "{damping:e} {cycles:?}");
            assert_eq!(cycles.continuum(), None);
        }
    }
}
