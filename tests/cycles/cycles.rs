//! Limit cycles against 25-digit reference data.

use crate::common::polynomials::Polynomials;
use crate::common::{
    Worst, assert_met, assert_mirrored, json, list, number, paper, system_of, text,
};
use serde_json::Value;
use std::f64::consts::TAU;
use stick_slip::{Coulomb, CycleKind, CycleSet, FrictionLaw, LimitCycle, MassOnBelt, limit_cycle};

/// Checks every number that the reference gives of a cycle.
fn compare(id: &str, cycle: &LimitCycle, expected: &Value) {
    let energy = cycle.energy();
    let fields = [
        ("period", cycle.period()),
        ("stick", cycle.stick_duration()),
        ("slip", cycle.period() - cycle.stick_duration()),
        ("slip_positive", cycle.leading_duration()),
        ("u_max", cycle.max_displacement()),
        ("u_min", cycle.min_displacement()),
        ("v_max", cycle.max_velocity()),
        ("v_min", cycle.min_velocity()),
        ("belt_work_on_mass", energy.belt_work),
        ("damper_loss", energy.damper_loss),
        ("belt_drive_work", energy.drive_work),
        ("friction_loss", energy.friction_loss),
    ];
    let turns = cycle.frequency() * cycle.period() / TAU;
    assert!((turns - 1.0).abs() < 1e-15, "{id}: {turns}");
    let mut worst = Worst::default();
    for (name, value) in fields {
        if let Some(reference) = expected.get(name).map(number) {
            worst.meet(name, value, reference);
        }
    }
    worst.assert(id, 1e-13);
    if let Some(reference) = expected.get("multiplier").map(number) {
        assert_met(
            &format!("{id}: multiplier"),
            cycle.multiplier(),
            reference,
            1e-11,
        );
    }
}

fn of_kind(cycles: &CycleSet, kind: CycleKind) -> Vec<&LimitCycle> {
    cycles.iter().filter(|cycle| cycle.kind() == kind).collect()
}

fn check<L: FrictionLaw>(case: &Value, system: &MassOnBelt<L>) {
    let id = text(&case["id"]);
    let cycles = limit_cycle::find(system).unwrap_or_else(|error| panic!("{id}: {error}"));
    assert_eq!(cycles.unresolved(), [], "{id}: {cycles:?}");
    let pure_slip = of_kind(&cycles, CycleKind::PureSlip);
    let stick_slip = of_kind(&cycles, CycleKind::StickSlip);
    assert_eq!(
        limit_cycle::stick_slip(system).unwrap().as_ref(),
        stick_slip.first().copied(),
        "{id}"
    );
    match text(&case["type"]) {
        "stick_slip" => compare(id, stick_slip[0], &case["cycle"]),
        "pure_slip" => {
            assert_eq!(pure_slip.len(), 1, "{id}");
            compare(id, pure_slip[0], &case["cycle"]);
        }
        "exp_all_attractors" => {
            let expected = list(&case["pure_slip"]);
            assert_eq!(pure_slip.len(), expected.len(), "{id}");
            for (cycle, expected) in std::iter::zip(pure_slip, expected) {
                compare(id, cycle, expected);
            }
            assert_eq!(
                stick_slip.len(),
                usize::from(!case["stick_slip"].is_null()),
                "{id}"
            );
            if let [cycle] = stick_slip[..] {
                compare(id, cycle, &case["stick_slip"]);
            }
        }
        "no_cycle" => assert!(cycles.is_empty(), "{id}"),
        other => panic!("unknown type {other}"),
    }
}

#[test]
fn every_number_of_the_reference() {
    let data = json(include_str!("../data/cycles.json"));
    for case in list(&data["cases"]) {
        check(case, &system_of(case));
    }
}

#[test]
fn overshoot_and_crossing_of_the_reference() {
    let data = json(include_str!("../data/overshoot.json"));
    for case in list(&data["cases"]) {
        let id = text(&case["id"]);
        let system = system_of(case);
        let cycles = limit_cycle::find(&system).unwrap_or_else(|error| panic!("{id}: {error}"));
        assert_eq!(cycles.unresolved(), [], "{id}: {cycles:?}");
        let sticking = limit_cycle::stick_slip(&system).unwrap();
        assert_eq!(sticking.is_some(), !case["stick_cycle"].is_null(), "{id}");
        if let Some(cycle) = sticking {
            let crosses = list(&case["stick_cycle"]["sequence"]).len() == 3;
            let kind = if crosses {
                CycleKind::Overshoot
            } else {
                CycleKind::StickSlip
            };
            assert_eq!(cycle.kind(), kind, "{id}");
            assert_eq!(of_kind(&cycles, kind), [&cycle], "{id}");
            compare(id, &cycle, &case["stick_cycle"]);
        }
        let crossing = of_kind(&cycles, CycleKind::Crossing);
        assert_eq!(
            crossing.len(),
            usize::from(!case["crossing_cycle"].is_null()),
            "{id}"
        );
        if let [cycle] = crossing[..] {
            compare(id, cycle, &case["crossing_cycle"]);
            let release = system.release_state().unwrap().displacement;
            assert!(cycle.state().displacement > release, "{id}");
        }
    }
}

#[test]
fn cycles_on_a_belt_that_runs_backwards_are_mirror_images() {
    let data = [
        include_str!("../data/cycles.json"),
        include_str!("../data/overshoot.json"),
    ];
    let data = data.map(json);
    let mut kinds = std::collections::HashSet::new();
    for case in data.iter().flat_map(|data| list(&data["cases"])) {
        let system = system_of(case);
        let backwards = -system.belt_velocity();
        let mirror = system.clone().with_belt_velocity(backwards).unwrap();
        let [here, there] = [&system, &mirror].map(|system| limit_cycle::find(system).unwrap());
        let one = [&system, &mirror].map(|system| limit_cycle::stick_slip(system).unwrap());
        assert_eq!(here.len(), there.len());
        let found = here.iter().zip(&there).map(|(a, b)| [a.clone(), b.clone()]);
        for [a, b] in found.chain(
            one.iter()
                .all(Option::is_some)
                .then(|| one.map(Option::unwrap)),
        ) {
            kinds.insert(a.kind());
            assert_mirrored(&a, &b, text(&case["id"]));
        }
    }
    assert_eq!(kinds.len(), 4, "{kinds:?}");
}

/// Against the trapezoidal rule over a period, nine tenths of it in stick for the second cycle;
/// what the rule adds of the higher harmonics falls as the cube of the number of points.
#[test]
fn harmonics_to_high_orders() {
    const POINTS: u32 = 1 << 16;
    let slow = MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), 0.01);
    let slow = limit_cycle::stick_slip(&slow.unwrap()).unwrap().unwrap();
    assert!(slow.stick_duration() > 0.9 * slow.period());
    let usual = limit_cycle::stick_slip(&paper(0.2)).unwrap().unwrap();
    for cycle in [usual, slow] {
        let harmonics = cycle.harmonics(2000);
        let trajectory = cycle.trajectory();
        let part = |j: u32| f64::from(j) / f64::from(POINTS);
        let displacement = |j: u32| {
            let state = trajectory.state_at(part(j) * cycle.period());
            state.unwrap().displacement
        };
        let displacements: Vec<_> = (0..POINTS).map(displacement).collect();
        for k in [1, 2, 3, 7, 20, 41, 60, 333, 2000] {
            let (mut re, mut im) = (0.0, 0.0);
            for (j, u) in (0..POINTS).zip(&displacements) {
                // Whole turns taken out first: large angles are rounded.
                let phase = TAU * f64::from(j * k % POINTS) / f64::from(POINTS);
                re += 2.0 * part(1) * u * phase.cos();
                im -= 2.0 * part(1) * u * phase.sin();
            }
            let found = harmonics[k as usize - 1];
            let error = (found.re - re).hypot(found.im - im);
            assert!(error < 1e-13, "{k}: {found} {re} {im} {error:e}");
        }
    }
}

/// Rayleigh's oscillator: friction that drives the mass by a·v and brakes it by a·v³/(3c²), about
/// the sliding speed 1; constant from 2 on.
fn rayleigh(a: f64, c: f64) -> Polynomials {
    let cube = a / (3.0 * c * c);
    Polynomials::about(1.0, 20.0, &[10.0, -a, 0.0, cube])
        .then(2.0, &[10.0 - a + cube])
        .told()
}

/// v/c is van der Pol's oscillator z'' − a(1 − z²)z' + z = 0, whose amplitude, period and
/// multiplier are known: Andersen and Geer, SIAM J. Appl. Math. 42 (1982) 678-693, here from Taylor
/// series with 34 digits. −a turns its time round: the cycle is the same, and repels.
#[test]
fn van_der_pols_oscillator() {
    for (a, amplitude, period, multiplier) in [
        (
            0.1,
            2.000103979872795923818,
            6.287111272288726806054,
            0.5330692592096738359157,
        ),
        (
            1.0,
            2.00861986087484313651,
            6.6632868593231301897,
            8.596950636038051861197e-4,
        ),
        (
            2.0,
            2.019891384667136024114,
            7.629874479674841631969,
            1.273849304439408339594e-8,
        ),
    ] {
        for sign in [1.0, -1.0] {
            let c = 0.25;
            let system = MassOnBelt::new(rayleigh(sign * a, c), 1.0).unwrap();
            let cycles = limit_cycle::find(&system).unwrap();
            let cycle = &of_kind(&cycles, CycleKind::PureSlip)[0];
            let relative = |found: f64, expected: f64| (found / expected - 1.0).abs();
            let errors = [
                relative(cycle.max_velocity(), c * amplitude),
                relative(cycle.min_velocity(), -c * amplitude),
                relative(cycle.period(), period),
                relative(cycle.multiplier(), f64::powf(multiplier, sign)),
            ];
            // It closes: the last step ends where the first begins.
            let trajectory = cycle.trajectory();
            let before = trajectory.state_at(cycle.period().next_down()).unwrap();
            let gap = (before.displacement - cycle.state().displacement).abs()
                + (before.velocity - cycle.state().velocity).abs();
            println!("a = {}: {errors:?}, {gap:e}", sign * a);
            assert!(errors[..3].iter().all(|error| *error < 1e-14), "{errors:?}");
            assert!(errors[3] < 1e-13 && gap < 1e-14, "{errors:?} {gap:e}");
        }
    }
}
