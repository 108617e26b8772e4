//! The drift against its closed form for the cubic law, and against the growth over exact periods.

use std::f64::consts::TAU;

use super::super::peaks::PeakMap;
use super::super::testing::{assert_close, circles, paper, repelling, spiral, traced, with_knee};
use super::*;

#[test]
fn the_drift_of_a_cubic_law_has_a_closed_form() {
    // −½h1 − (3/8)h3 A² with h1 = −0.278, h3 = 0.6
    let system = paper(0.2);
    let forward = Forward::of(system.belt()).unwrap();
    for amplitude in [1e-5, 0.1, 0.2] {
        let drift = drift(&forward, amplitude).unwrap();
        assert_close(drift.value, 0.139 - 0.225 * amplitude * amplitude, 1e-15);
    }
}

#[test]
fn where_friction_is_weak_an_exact_turn_grows_as_the_drift_says_and_no_less_exactly() {
    for load in [1e-2, 1e-3] {
        for v_b in [0.2, 0.42, 0.7] {
            let system = paper(v_b)
                .with_load(load)
                .unwrap()
                .with_damping(0.05 * load)
                .unwrap();
            let forward = Forward::of(system.belt()).unwrap();
            for part in [0.1, 0.5, 0.8] {
                let amplitude = part * v_b;
                let Sample { value, noise } = drift(&forward, amplitude).unwrap();
                let growth = traced(&system, |tracer| PeakMap::of(tracer).growth(amplitude));
                let Ok(Some(grows)) = grows(&forward, amplitude) else {
                    panic!("{value} {noise}")
                };
                assert_eq!(growth.value > 0.0, grows);
                // A changes during the turn, so the two differ by a relative amount of the order of
                // the growth.
                let rate = growth.value.ln_1p() / TAU;
                assert_close(rate, value, 4.0 * load * value.abs() + growth.noise);
            }
        }
    }
}

#[test]
fn a_range_without_cycles_is_told_from_one_with_a_cycle() {
    let has_none = |system: &super::super::testing::System, range: Range<f64>| {
        let all = all_grow(&Forward::of(system.belt()).unwrap(), &range).unwrap();
        all.is_some()
    };
    let weak = paper(0.42)
        .with_load(1e-3)
        .unwrap()
        .with_damping(0.05e-3)
        .unwrap();
    // The averaged cycle has A = √(−(4/3) h1/h3) = 0.26866.
    assert!(has_none(&weak, 1e-4..0.26) && has_none(&weak, 0.28..0.42));
    assert!(!has_none(&weak, 0.26..0.28) && !has_none(&weak, 0.1..0.4));
    // Without damping and with constant friction nothing but rounding is left.
    assert!(!has_none(&circles(0.4, 0.25, 0.5), 1e-4..0.5));
    assert!(has_none(&spiral(2e-17, 0.5), 1e-4..0.5));
    assert!(has_none(&spiral(-1e-300, 0.5), 1e-4..0.5));
    // Friction is too strong for averaging to tell.
    assert!(!has_none(&repelling(0.3, 6.0), 0.1..0.2));
    // Below the knee nothing damps a motion; beyond it motions die.
    let kneed = with_knee(*circles(0.4, 0.25, 0.5).law(), 0.7, 0.01, 0.5);
    assert!(!has_none(&kneed, 0.1..0.4) && !has_none(&kneed, 0.1..0.2));
    assert!(has_none(&kneed, 0.3..0.4));
}
