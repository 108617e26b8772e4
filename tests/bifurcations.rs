//! Bifurcation velocities against 25-digit reference data.

mod common;

use common::{list, number, system_of, text};
use serde_json::Value;
use stick_slip::bifurcation::{
    Criticality, criticality, fold_velocities, grazing_velocities, hopf_velocities,
    overshoot_velocities,
};
use stick_slip::limit_cycle;

fn assert_close(id: &str, what: &str, found: f64, expected: f64) {
    let error = (found - expected).abs() / expected.abs().max(1.0);
    println!("{id}: {what} = {found:e}, error {error:.1e}");
    assert!(
        error <= 1e-13,
        "{id}: {what} = {found:e}, not {expected:e}: {error:e}"
    );
}

#[test]
fn every_number_of_the_reference() {
    let data: Value = serde_json::from_str(include_str!("data/bifurcations.json")).unwrap();
    for case in list(&data["cases"]) {
        let id = text(&case["id"]);
        let mut case = case.clone();
        if case.get("v_b").is_none() {
            case["v_b"] = "1".into();
        }
        let field = |name: &str| number(&case[name]);
        let system = system_of(&case);
        match text(&case["kind"]) {
            "poly_grazing" => {
                let v_b1 = field("v_b1");
                let found = grazing_velocities(&system, 0.0..1.1 * v_b1).unwrap();
                assert_eq!(found.len(), 1, "{id}: {found:?}");
                assert_close(id, "grazing", found[0], field("v_grazing"));
                let hopf = hopf_velocities(&system, 0.0..2.0 * v_b1).unwrap();
                assert_eq!(hopf.len(), 1, "{id}: {hopf:?}");
                assert_close(id, "hopf", hopf[0], v_b1);
                assert_eq!(criticality(&system, hopf[0]), Criticality::Supercritical);
                // The cycle that touches the belt.
                let at = system.with_belt_velocity(found[0]).unwrap();
                let touching =
                    limit_cycle::find(&at.with_belt_velocity(found[0] * (1.0 + 1e-14)).unwrap())
                        .unwrap();
                let cycle = touching.iter().next().unwrap();
                println!(
                    "{id} {} {:e} {:e}",
                    cycle.kind(),
                    cycle.period() - field("period_at_grazing"),
                    cycle.multiplier() - field("multiplier_at_grazing")
                );
            }
            "exp_hopf_and_grazing" => {
                let high = 3.0 * field("v_hopf_high").max(field("v_stick_slip_max"));
                let hopf = hopf_velocities(&system, 0.0..high).unwrap();
                assert_eq!(hopf.len(), 2, "{id}: {hopf:?}");
                assert_close(id, "low hopf", hopf[0], field("v_hopf_low"));
                assert_close(id, "high hopf", hopf[1], field("v_hopf_high"));
                let found = grazing_velocities(&system, 0.0..high).unwrap();
                let expected = list(&case["grazings"]);
                assert_eq!(found.len(), expected.len(), "{id}: {found:?}");
                for (found, expected) in std::iter::zip(found, expected) {
                    assert_close(id, "grazing", found, number(&expected["v_b"]));
                }
            }
            "coulomb_vmax" => {
                let expected = field("v_stick_slip_max");
                let found = grazing_velocities(&system, 0.0..2.0 * expected).unwrap();
                assert_eq!(found.len(), 1, "{id}: {found:?}");
                assert_close(id, "largest", found[0], expected);
            }
            "overshoot_threshold" => {
                let expected = field("v_b");
                let found = overshoot_velocities(&system, 0.0..2.0 * expected).unwrap();
                assert_eq!(found.len(), 1, "{id}: {found:?}");
                assert_close(id, "overshoot", found[0], expected);
            }
            "exp_pure_slip_fold" => {
                let expected = field("v_fold");
                let found = fold_velocities(&system, 0.5 * expected..1.5 * expected).unwrap();
                assert_eq!(found.len(), 1, "{id}: {found:?}");
                assert_close(id, "fold", found[0], expected);
            }
            other => panic!("unknown kind {other}"),
        }
    }
}
