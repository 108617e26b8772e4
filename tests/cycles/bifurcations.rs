//! Bifurcation velocities against 25-digit reference data, and Hopf velocities of laws that are
//! hard for a search.

use approx::assert_abs_diff_eq;
use std::ops::Range;

use crate::common::laws::Wave;
use crate::common::polynomials::Polynomials;
use crate::common::{
    Ends, assert_met, count, exactly, json, list, number, on_belt, paper, refused, system_of, text,
};
use stick_slip::bifurcation::{
    Criticality, criticality, crossing_velocities, fold_velocities, grazing_velocities,
    hopf_velocities, overshoot_velocities, silencing_damping,
};
use stick_slip::{
    Coulomb, CycleKind, Error, Exponential, FrictionLaw, LimitCycle, MassOnBelt, Polynomial,
    Tabulated, limit_cycle,
};

#[test]
fn every_number_of_the_reference() {
    let data = json(include_str!("../data/bifurcations.json"));
    for case in list(&data["cases"]) {
        let id = text(&case["id"]);
        let mut case = case.clone();
        if case.get("v_b").is_none() {
            case["v_b"] = "1".into();
        }
        let field = |name: &str| number(&case[name]);
        let met = |what: &str, found: f64, expected: f64| {
            assert_met(&format!("{id}: {what}"), found, expected, 1e-13);
        };
        let system = system_of(&case);
        match text(&case["kind"]) {
            "poly_grazing" => {
                let v_b1 = field("v_b1");
                let found = grazing_velocities(&system, 0.0..1.1 * v_b1).unwrap();
                assert_eq!(found.len(), 1, "{id}: {found:?}");
                met("grazing", found[0], field("v_grazing"));
                let hopf = hopf_velocities(&system, 0.0..2.0 * v_b1).unwrap();
                assert_eq!(hopf.len(), 1, "{id}: {hopf:?}");
                met("hopf", hopf[0], v_b1);
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
                met("low hopf", hopf[0], field("v_hopf_low"));
                met("high hopf", hopf[1], field("v_hopf_high"));
                let found = grazing_velocities(&system, 0.0..high).unwrap();
                let expected = list(&case["grazings"]);
                assert_eq!(found.len(), expected.len(), "{id}: {found:?}");
                for (found, expected) in std::iter::zip(found, expected) {
                    met("grazing", found, number(&expected["v_b"]));
                }
            }
            "coulomb_vmax" => {
                let expected = field("v_stick_slip_max");
                let found = grazing_velocities(&system, 0.0..2.0 * expected).unwrap();
                assert_eq!(found.len(), 1, "{id}: {found:?}");
                met("largest", found[0], expected);
            }
            "overshoot_threshold" => {
                let expected = field("v_b");
                let found = overshoot_velocities(&system, 0.0..2.0 * expected).unwrap();
                assert_eq!(found.len(), 1, "{id}: {found:?}");
                met("overshoot", found[0], expected);
            }
            "exp_pure_slip_fold" => {
                let expected = field("v_fold");
                let found = fold_velocities(&system, 0.5 * expected..1.5 * expected).unwrap();
                assert_eq!(found.len(), 1, "{id}: {found:?}");
                met("fold", found[0], expected);
            }
            other => panic!("unknown kind {other}"),
        }
    }
}

const NONE: [f64; 0] = [];

// Laws whose slopes have known zeros.

/// Slope −1 + 2s: root at ½, in exact arithmetic of binary fractions.
fn parabola() -> Polynomials {
    Polynomials::new(2.0, &[1.0, -1.0, 1.0])
}

/// Slope −20·a·sin(20 s).
fn waves(a: f64) -> Wave {
    Wave {
        static_coefficient: 1.0 + a,
        fall: 0.0,
        height: a,
        number: 20.0,
    }
}

/// Slope (s − a)² − d; 1 at speed 0.
fn touch(a: f64, d: f64) -> Polynomials {
    let there = 1.0 - a * d + a.powi(3) / 3.0;
    Polynomials::about(a, 2.0, &[there, -d, 0.0, 1.0 / 3.0])
}

/// Slope −0.3 below the speed, 0.2 above.
fn kink(b: f64) -> Polynomials {
    Polynomials::about(b, 2.0, &[1.0, -0.3])
        .then(b, &[1.0, 0.2])
        .told()
}

/// Slope 0 up to the speed 1, (s − 1)(1.3 − s) above.
fn hump() -> Polynomials {
    Polynomials::new(2.0, &[1.0])
        .then(1.0, &[1.0, 0.0, 0.15, -1.0 / 3.0])
        .told()
}

fn made<L: FrictionLaw>(law: L, damping: f64) -> MassOnBelt<L> {
    on_belt(law, 0.25, damping, 1.0)
}

#[test]
fn hopf_at_the_ends_of_a_range() {
    let system = made(parabola(), 0.0);
    assert_eq!(hopf_velocities(&system, 0.1..1.0).unwrap(), [0.5]);
    assert_eq!(hopf_velocities(&system, 0.5..1.0).unwrap(), [0.5]);
    assert_eq!(hopf_velocities(&system, 0.1..0.5).unwrap(), NONE);
    assert_eq!(hopf_velocities(&system, 0.51..1.0).unwrap(), NONE);
    assert_eq!(hopf_velocities(&system, -0.3..1.0).unwrap(), [0.5]);
    assert_eq!(hopf_velocities(&system, -3.0..1.0).unwrap(), [-0.5, 0.5]);
    // The lower end of a range belongs to it, and the upper one does not, below 0 too.
    assert_eq!(hopf_velocities(&system, -0.5..-0.1).unwrap(), [-0.5]);
    assert_eq!(hopf_velocities(&system, -1.0..-0.5).unwrap(), NONE);
    assert_eq!(hopf_velocities(&system, 0.5 - 1e-9..1.0).unwrap(), [0.5]);
}

/// h1 is zero up to a speed, and again within the same power series.
#[test]
fn hopf_beside_a_zero_at_a_breakpoint() {
    let found = hopf_velocities(&made(hump(), 0.0), 0.5..100.0).unwrap();
    assert_eq!(found.len(), 1, "{found:?}");
    assert!((found[0] - 1.3).abs() < 1e-14, "{found:?}");
}

/// h1 is of order 1e-18, and the law changes by much in a part of the range only.
#[test]
fn hopf_velocities_depend_on_the_ratio_of_damping_and_load() {
    let narrow = on_belt(Exponential::new(0.4, 0.25, 0.01).unwrap(), 0.2, 0.05, 1.0);
    let weak = narrow
        .with_damping(0.05 * 2.0_f64.powi(-60))
        .and_then(|system| system.with_load(2.0_f64.powi(-60)))
        .unwrap();
    let found = hopf_velocities(&narrow, 0.0..10.0).unwrap();
    assert_eq!(found.len(), 2);
    assert_eq!(hopf_velocities(&weak, 0.0..10.0).unwrap(), found);
}

#[test]
fn hopf_at_a_breakpoint_over_which_the_slope_jumps() {
    for b in [0.1, 0.3, 1.0 / 3.0, 0.7] {
        // 2β − 0.3 < 0 < 2β + 0.2
        let system = made(kink(b), 0.05);
        assert_eq!(hopf_velocities(&system, 0.0..1.0).unwrap(), [b]);
        assert_eq!(hopf_velocities(&system, b..1.0).unwrap(), [b]);
        assert_eq!(hopf_velocities(&system, 0.0..b).unwrap(), NONE);
        // Damped so much that it jumps above zero only.
        assert_eq!(
            hopf_velocities(&made(kink(b), 0.2), 0.0..1.0).unwrap(),
            NONE
        );
    }
    // The least coefficient of a table lies at a point, where its slope is zero.
    let table = Tabulated::new([
        (0.0, 0.4),
        (0.1, 0.33),
        (0.3, 0.27),
        (0.6, 0.25),
        (1.0, 0.26),
    ]);
    let system = MassOnBelt::new(table.unwrap(), 0.2).unwrap();
    assert_eq!(hopf_velocities(&system, 0.0..2.0).unwrap(), [0.6]);
    // A flat stretch in between: where it ends.
    let table = Tabulated::new([(0.0, 0.4), (0.2, 0.3), (0.4, 0.3), (1.0, 0.5), (2.0, 0.6)]);
    let system = MassOnBelt::new(table.unwrap(), 0.2).unwrap();
    assert_eq!(hopf_velocities(&system, 0.0..2.0).unwrap(), [0.4]);
    // With damping, one root of each cubic's parabola: told apart by the signs of h1 on a grid.
    let table = Tabulated::new([
        (0.0, 0.5),
        (0.1, 0.3),
        (0.3, 0.45),
        (0.6, 0.25),
        (1.0, 0.26),
    ]);
    let system = on_belt(table.unwrap(), 0.2, 0.02, 1.0);
    let h1 = |v: f64| 2.0 * system.damping() + system.law().slope(v);
    let grid: Vec<f64> = (1..20000).map(|i| f64::from(i) * 1e-4 + 3e-5).collect();
    let changes: Vec<f64> = grid
        .windows(2)
        .filter(|pair| (h1(pair[0]) > 0.0) != (h1(pair[1]) > 0.0))
        .map(|pair| pair[0])
        .collect();
    let roots = hopf_velocities(&system, 3e-5..2.0).unwrap();
    assert_eq!(roots.len(), changes.len(), "{roots:?} {changes:?}");
    for (root, change) in std::iter::zip(&roots, changes) {
        assert!(*root >= change && *root <= change + 1e-4);
        assert!(h1(*root).abs() < 1e-14);
    }
}

#[test]
fn hopf_velocities_of_a_law_with_many() {
    let system = made(waves(0.1), 0.0);
    let roots = hopf_velocities(&system, 0.0..30.0).unwrap();
    let expected: Vec<f64> = (1..=190)
        .map(|k| f64::from(k) * std::f64::consts::PI / 20.0)
        .collect();
    assert_eq!(roots.len(), expected.len());
    for (root, expected) in std::iter::zip(&roots, &expected) {
        assert!(
            (root - expected).abs() <= 1e-14 * expected.max(1.0),
            "{root} {expected}"
        );
    }
    // Wherever a range is cut, none is lost and none is found twice.
    for i in 0..count(8, 100) {
        let cut = 0.03 + 0.29 * i as f64;
        let [below, above] =
            [0.0..cut, cut..30.0].map(|range| hopf_velocities(&system, range).unwrap());
        assert_eq!(below.len() + above.len(), 190, "cut at {cut}");
    }
    // 2β above the steepest fall: none. Just below: two in each wave.
    let count = |damping: f64| {
        hopf_velocities(&made(waves(0.1), damping), 0.0..30.0)
            .unwrap()
            .len()
    };
    assert_eq!(count(1.0 + 1e-9), 0);
    assert_eq!(count(1.0 - 1e-9), 2 * 96);
}

#[test]
fn hopf_to_round_off_wherever_the_series_meet() {
    let system = on_belt(Polynomial::new(0.4, 0.25, 0.5).unwrap(), 0.2, 0.05, 1.0);
    // v_m √(1 − 2β/η), η = 0.45
    let expected = 0.5 * (1.0_f64 - 0.1 / 0.45).sqrt();
    for i in 0..1000 {
        let start = 1e-4 * f64::from(i);
        for range in [
            start..1.0,
            start..expected + (expected - start) * f64::from(i % 64 + 1),
        ] {
            let found = hopf_velocities(&system, range.clone()).unwrap();
            assert_eq!(found.len(), 1, "{range:?}");
            assert!((found[0] - expected).abs() < 4e-16, "{range:?} {found:?}");
        }
    }
}

#[test]
fn hopf_is_not_where_the_slope_touches_zero() {
    for range in [0.0..1.0, 0.01..0.9, 0.0..50.0, 1.0 / 3.0..1.0] {
        assert_eq!(
            hopf_velocities(&made(touch(1.0 / 3.0, 0.0), 0.0), range).unwrap(),
            NONE
        );
    }
    for distance in [1e-2, 1e-4, 1e-6] {
        let system = made(touch(1.0 / 3.0, distance * distance), 0.0);
        let found = hopf_velocities(&system, 0.0..1.0).unwrap();
        assert_eq!(found.len(), 2, "{distance}");
        assert!((found[1] - found[0] - 2.0 * distance).abs() < 1e-15 / distance);
    }
    // A dip of h1 below zero that is rounding, 1e-14, of what h1 was before, 100; and deeper ones.
    let dip = |depth: f64| {
        let system = made(touch(10.0, depth), 0.0);
        hopf_velocities(&system, 0.0..20.0).unwrap()
    };
    for depth in [3e-14, 1e-13, 5e-13] {
        assert_eq!(dip(depth), NONE, "{depth}");
    }
    for depth in [3e-12, 1e-11] {
        let found = dip(depth);
        assert_eq!(found.len(), 2, "{depth}: {found:?}");
        assert_abs_diff_eq!(found[1] - found[0], 2.0 * depth.sqrt(), epsilon = 1e-8);
    }
    // Nothing changes its sign where friction is constant and there is no damping.
    let flat = MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), 0.2).unwrap();
    assert_eq!(hopf_velocities(&flat, 0.0..10.0).unwrap(), NONE);
}

#[test]
fn hopf_where_the_law_ends_is_an_error() {
    let system = made(Ends, 0.0);
    assert_eq!(hopf_velocities(&system, 0.0..0.7).unwrap(), NONE);
    for range in [0.0..1.5, 0.5..0.8 + 1e-9] {
        let error = hopf_velocities(&system, range).unwrap_err();
        let at = match error {
            Error::NotAnalytic {
                speed,
                reached: None,
            } => speed,
            Error::NonFiniteFriction {
                speed,
                reached: None,
                ..
            } => speed,
            other => panic!("{other}"),
        };
        assert!((at - 0.8).abs() < 1e-9, "{at}");
    }
}

#[test]
fn damping_that_silences() {
    // Supercritical: the pure-slip cycle shrinks to nothing where steady sliding becomes stable.
    let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5).unwrap(), 0.42).unwrap();
    let silent = silencing_damping(&system).unwrap();
    assert_eq!(silent, -0.5 * system.law().slope(0.42));
    assert_eq!(
        silencing_damping(&system.with_belt_velocity(-0.42).unwrap()).unwrap(),
        silent
    );
    assert_eq!(
        silencing_damping(&system.with_load(0.6).unwrap()).unwrap(),
        -0.5 * 0.6 * system.law().slope(0.42)
    );
    assert_eq!(
        silencing_damping(&system.with_belt_velocity(0.0).unwrap()).unwrap(),
        0.0
    );
    assert_eq!(
        silencing_damping(&system.with_belt_velocity(0.6).unwrap()).unwrap(),
        0.0
    );
    // Elsewhere cycles last beyond: there is one just below the border, and none anywhere above.
    let exponential = MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5).unwrap(), 1.0).unwrap();
    check(&exponential);
    let coulomb = MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), 0.1).unwrap();
    check(&coulomb);
    // Grazing over the belt velocity at that damping gives the belt velocity back.
    let silent = silencing_damping(&coulomb).unwrap();
    let at = coulomb.with_damping(silent).unwrap();
    let grazing = grazing_velocities(&at, 0.05..0.2).unwrap();
    assert!((grazing[0] - 0.1).abs() < 1e-12, "{grazing:?}");

    fn check<L: FrictionLaw + Clone>(system: &MassOnBelt<L>) {
        let silent = silencing_damping(system).unwrap();
        let cycles = |factor: f64| {
            let system = system.clone().with_damping(factor * silent).unwrap();
            let cycles = limit_cycle::find(&system).unwrap();
            cycles.len() + cycles.unresolved().len()
        };
        println!("silent from β = {silent}");
        assert!(cycles(1.0 - 1e-9) > 0);
        for factor in [1.0, 1.0 + 1e-9, 1.001, 1.1, 1.5, 2.0, 5.0] {
            assert_eq!(cycles(factor), 0, "{factor}");
        }
    }
}

#[test]
fn hopf_search_ends_whatever_the_range_and_the_law() {
    let system = paper(0.2);
    for width in [1e-13, 1e-14, 1e-15] {
        assert!(
            hopf_velocities(&system, 0.1..0.1 + width)
                .unwrap()
                .is_empty()
        );
    }
    assert!(
        hopf_velocities(&system, 0.4..0.4_f64.next_up())
            .unwrap()
            .is_empty()
    );
    let [&near] = exactly(&hopf_velocities(&system, 0.0..1.0).unwrap());
    let [&wide] = exactly(&hopf_velocities(&system, 0.0..1e9).unwrap());
    assert_abs_diff_eq!(wide, near, epsilon = 1e-14);
    // The end that is too far away is named, as it was given.
    for (range, name, far) in [
        (0.0..1e100, "range.end", 1e100),
        (0.0..1e300, "range.end", 1e300),
        (-1e100..0.5, "range.start", -1e100),
    ] {
        match hopf_velocities(&system, range) {
            Err(Error::InvalidParameter { name: n, value, .. }) => {
                assert_eq!((n, value), (name, far));
            }
            other => panic!("{other:?}"),
        }
    }

    // A kink that is not named is passed; what is not a number is an error.
    let broken = |beyond| {
        let law = Polynomials::new(0.4, &[0.4, -0.5]).then(0.2, &[0.3, beyond]);
        on_belt(law, 0.1, 0.05, 1.0)
    };
    let kink = hopf_velocities(&broken(0.1), 0.0..1.0).unwrap();
    assert!(kink.len() == 1 && (kink[0] - 0.2).abs() < 1e-12, "{kink:?}");
    let found = hopf_velocities(&broken(f64::NAN), 0.0..1.0);
    refused!(found => Error::NonFiniteFriction { .. } | Error::NotAnalytic { .. });
}

#[test]
fn criticality_is_the_sign_of_the_third_derivative() {
    let of = |law: Wave, v_b: f64| criticality(&made(law, 0.0), v_b);
    // cos 20s has the third derivative 8000 sin 20s.
    for (v_b, expected) in [
        (0.02, Criticality::Supercritical),
        (0.2, Criticality::Subcritical),
    ] {
        assert_eq!(of(waves(0.1), v_b), expected);
        assert_eq!(of(waves(0.1), -v_b), expected);
    }
    let flat = MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), 0.2).unwrap();
    assert_eq!(criticality(&flat, 0.2), Criticality::Degenerate);
}

/// What the attracting cycle is just below and just above its borders.
#[test]
fn kinds_change_where_the_contacts_say() {
    let kinds =
        |load: f64, damping: f64, borders: fn(&_, Range<f64>) -> Result<Vec<f64>, Error>| {
            let system = on_belt(
                Polynomial::new(0.38, 0.22, 0.55).unwrap(),
                0.2,
                damping,
                load,
            );
            let found = borders(&system, 0.05..0.3).unwrap();
            assert_eq!(found.len(), 1, "{found:?}");
            [-1e-9, 1e-9].map(|offset| {
                let system = system.with_belt_velocity(found[0] + offset).unwrap();
                let cycles = limit_cycle::find(&system).unwrap();
                let kind = cycles.stable().map(LimitCycle::kind).next();
                kind.expect("an attracting cycle")
            })
        };
    assert_eq!(
        kinds(0.1, 0.004, overshoot_velocities),
        [CycleKind::StickSlip, CycleKind::Overshoot]
    );
    assert_eq!(
        kinds(0.03, 0.001, crossing_velocities),
        [CycleKind::Overshoot, CycleKind::Crossing]
    );
}

/// Where all motions in slip are periodic no two cycles meet, and rounding makes none.
#[test]
fn no_folds_in_families_of_periodic_motions() {
    let flat = MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), 0.2).unwrap();
    assert_eq!(fold_velocities(&flat, 0.01..0.5).unwrap(), NONE);
}

/// A fold is found in each range that holds it, and in no other, wherever the range begins and
/// ends.
#[test]
fn folds_are_in_the_range_that_holds_them() {
    let system = on_belt(Exponential::new(0.4, 0.3, 1.0).unwrap(), 1.4, 0.02, 1.0);
    let fold = 1.457823592457963272;
    for (range, count) in [
        (1.3..1.6, 1),
        (1.455..1.46, 1),
        (1.3..fold - 1e-6, 0),
        (1.3..fold + 1e-6, 1),
        (fold - 1e-6..1.6, 1),
        (fold + 1e-6..1.6, 0),
        (0.6..0.8, 0),
    ] {
        let found = fold_velocities(&system, range.clone()).unwrap();
        assert_eq!(found.len(), count, "{range:?}: {found:?}");
        assert!(
            found.iter().all(|found| (found - fold).abs() < 1e-13),
            "{found:?}"
        );
    }
}
