//! Systems in which rounding hides how much a motion grows over one period.

use super::*;
use crate::friction::{Coulomb, Exponential, Polynomial};
use crate::numerics::testing::some;

#[track_caller]
fn assert_silenced<L: FrictionLaw>(system: &MassOnBelt<L>, expected: f64) {
    let silent = silencing_damping(system).unwrap();
    assert!(
        (silent - expected).abs() <= 4.0 * f64::EPSILON * expected,
        "{silent:e} {expected:e}"
    );
}

#[test]
fn on_slow_belts_vibration_ends_where_steady_sliding_becomes_stable() {
    // −½γ²μ̂'(v_b) = 0.6 v_b exp(−4 v_b²): at this β a stable cycle is born, and no other is left.
    let law = Exponential::new(0.4, 0.25, 0.5).unwrap();
    for v_b in some(3, [1e-1_f64, 1e-4, 1e-9, 1e-2, 1e-3, 1e-5, 1e-6, 1e-7]) {
        let system = MassOnBelt::new(law, v_b).unwrap();
        assert_silenced(&system, 0.6 * v_b * (-4.0 * v_b * v_b).exp());
        assert_silenced(
            &system
                .with_belt_velocity(-v_b)
                .unwrap()
                .with_load(0.5)
                .unwrap(),
            0.3 * v_b * (-4.0 * v_b * v_b).exp(),
        );
    }
    // −k1 + 3 k3 v_b² with k1 = 0.45, k3 = 0.6.
    let law = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    for v_b in [0.49_f64, 0.4999, 0.499_999] {
        let system = MassOnBelt::new(law, v_b).unwrap();
        let silent = silencing_damping(&system).unwrap();
        let stable = 0.5 * (0.45 - 1.8 * v_b * v_b);
        assert!((silent - stable).abs() <= 1e-15, "{silent:e} {stable:e}");
    }
}

#[test]
fn friction_that_never_varies_is_silenced_by_any_damping() {
    for v_b in [1e-6, 0.2, 30.0] {
        let system = MassOnBelt::new(Coulomb::new(0.4, 0.4).unwrap(), v_b).unwrap();
        assert_eq!(silencing_damping(&system), Ok(0.0));
        let system = MassOnBelt::new(Coulomb::new(0.0, 0.0).unwrap(), v_b).unwrap();
        assert_eq!(silencing_damping(&system), Ok(0.0));
    }
}
