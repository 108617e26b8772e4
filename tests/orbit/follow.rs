//! Branches over a parameter: bifurcations known to 25 digits, the belt's own numbers, ends, and
//! families that misbehave.

use approx::assert_abs_diff_eq;
use std::cell::Cell;
use std::f64::consts::TAU;

use serde_json::Value;
use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::orbit::{
    self, BifurcationKind, Branch, BranchEnd, BranchPoint, Orbit, Period, Search, follow, settle,
    shoot,
};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Direction, Drive, Dwell, Element, Error, EventKind, Exponential, FrictionLaw,
    Integrator, MassOnBelt, Polynomial, Rational, Stribeck, Structure, SystemState, bifurcation,
    limit_cycle,
};

use crate::common::orbit::last_turn;
use crate::common::{Random, count, exactly, number, one_mass, some};
use crate::reading::{cases, structure};

/// Error promised for every parameter.
const ACCURACY: f64 = 1e-10;

fn at<S: SystemState>(branch: &Branch<S>, kind: BifurcationKind) -> Vec<f64> {
    let of_kind = branch.bifurcations.iter().filter(|b| b.kind == kind);
    of_kind.map(|b| b.parameter).collect()
}

fn close(actual: f64, expected: f64) -> bool {
    (actual - expected).abs() <= ACCURACY * expected.abs().max(1.0)
}

fn nearest(values: &[f64], to: f64) -> f64 {
    let by_distance = |a: &&f64, b: &&f64| (*a - to).abs().total_cmp(&(*b - to).abs());
    values
        .iter()
        .min_by(by_distance)
        .copied()
        .unwrap_or(f64::NAN)
}

fn driven(case: &Value, parameter: f64) -> Result<Structure, Error> {
    Ok(structure(&case["system"], parameter))
}

/// Where to start, the range, and the kind of what is known to happen in it.
#[test]
fn bifurcations_of_forced_motions_are_those_of_the_reference() {
    use BifurcationKind::{Flip, Fold, Grazing, Sequence};
    let known = [
        ("sb_05", 0.15, 0.05..0.3, Grazing),
        ("sb_06", 0.5, 0.3..0.95, Sequence),
        ("sb_07", 0.78, 0.6..0.9, Flip),
        ("sb_08", 0.35, 0.1..0.5, Flip),
        ("sb_09", 0.72, 0.5..1.0, Fold),
        ("sb_10", 0.3, 0.1..1.0, Grazing),
    ];
    let cases = cases(include_str!("../data/structure_bifurcations.json"));
    for (id, start, range, kind) in known {
        let case = cases.iter().find(|case| case["id"] == id).unwrap();
        let family = |parameter: f64| driven(case, parameter);
        let system = family(start).unwrap();
        let orbit = settle(
            &system,
            &State::new(&[0.3], &[0.0]),
            400.0,
            Period::Driven(1),
        );
        let branch = follow(family, start, &orbit.unwrap(), range.clone()).unwrap();
        let expected = number(&case["value"]);
        let found = nearest(&at(&branch, kind), expected);
        println!("{id}: {:.1e}", found - expected);
        assert!(close(found, expected), "{id}: {found}, not {expected}");
        let there = branch.bifurcations.iter().find(|b| b.parameter == found);
        let there = &there.unwrap().orbit;
        if let Some(period) = case.get("period") {
            assert!(close(there.period(), number(period)), "{id}");
            let (least, largest) = there.extremes(0);
            assert!((least - number(&case["q_min"][0])).abs() < 1e-7, "{id}");
            assert!((largest - number(&case["q_max"][0])).abs() < 1e-7, "{id}");
            let first = number(&case["multipliers"][0]["re"]);
            assert!((there.multipliers()[0].re - first).abs() < 1e-7, "{id}");
        }
        // Through changes of events and sharp corners, to both ends of the range.
        if id != "sb_06" {
            assert_eq!(branch.ends, [BranchEnd::Range, BranchEnd::Range], "{id}");
        }
        // Along the branch, and inside the range.
        for pair in branch.points.windows(2) {
            let step = (pair[0].parameter - pair[1].parameter).abs();
            assert!(step <= (range.end - range.start) / 32.0, "{id}");
        }
        for point in &branch.points {
            assert!((range.start..=range.end).contains(&point.parameter), "{id}");
        }
    }
}

/// The system of Fig. 5 over the belt velocity.
fn paper(belt_velocity: f64) -> Result<MassOnBelt<Polynomial>, Error> {
    MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, belt_velocity)?.with_damping(0.05)
}

fn cycle<L: FrictionLaw>(system: &MassOnBelt<L>, is_stable: bool) -> Orbit<stick_slip::State> {
    let cycles = limit_cycle::find(system).unwrap();
    let cycle = cycles.iter().find(|cycle| cycle.is_stable() == is_stable);
    let cycle = cycle.unwrap();
    let start = cycle.trajectory().state_at(0.0).unwrap();
    shoot(system, &start, Period::Free(cycle.period())).unwrap()
}

#[test]
fn the_branch_of_the_paper_goes_from_stick_slip_through_grazing_to_the_hopf_point() {
    let system = paper(0.2).unwrap();
    let branch = follow(paper, 0.2, &cycle(&system, true), 0.05..0.5).unwrap();
    let grazing = bifurcation::grazing_velocities(&system, 0.01..0.5).unwrap();
    let hopf = bifurcation::hopf_velocities(&system, 0.01..0.5).unwrap();
    let found = at(&branch, BifurcationKind::Grazing);
    assert_eq!((found.len(), branch.bifurcations.len()), (1, 1));
    assert!((found[0] - grazing[0]).abs() < 1e-12, "{found:?}");
    assert_eq!(branch.ends[0], BranchEnd::Range);
    assert_eq!(branch.points[0].parameter, 0.05);
    let BranchEnd::Hopf { parameter } = branch.ends[1] else {
        panic!("{:?}", branch.ends)
    };
    assert!((parameter - hopf[0]).abs() < ACCURACY, "{parameter}");
    // The motions between are the cycles of the complete search.
    let mut compared = 0;
    for point in branch.points.iter().step_by(9) {
        let cycles = limit_cycle::find(&paper(point.parameter).unwrap()).unwrap();
        let Some(cycle) = cycles.stable().next() else {
            continue;
        };
        let (least, largest) = point.orbit.extremes(0);
        let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{}", point.parameter);
        near(point.orbit.period(), cycle.period());
        near(least, cycle.min_displacement());
        near(largest, cycle.max_displacement());
        near(point.orbit.multipliers()[0].re, cycle.multiplier());
        compared += 1;
    }
    assert!(compared > 10);
}

#[test]
fn an_unstable_cycle_is_followed_through_a_fold() {
    let law = Exponential::new(0.4, 0.3, 1.0).unwrap();
    let family = |v_b: f64| MassOnBelt::new(law, v_b)?.with_damping(0.02);
    let system = family(1.45).unwrap();
    let unstable = cycle(&system, false);
    let branch = follow(family, 1.45, &unstable, 1.0..1.6).unwrap();
    let fold = bifurcation::fold_velocities(&system, 1.3..1.6).unwrap()[0];
    let grazing = bifurcation::grazing_velocities(&system, 1.0..2.0).unwrap()[0];
    let hopf = bifurcation::hopf_velocities(&system, 1.0..2.0).unwrap()[0];
    assert!(close(at(&branch, BifurcationKind::Fold)[0], fold));
    assert!(close(at(&branch, BifurcationKind::Grazing)[0], grazing));
    let end =
        |end: &BranchEnd| matches!(end, BranchEnd::Hopf { parameter } if close(*parameter, hopf));
    assert!(branch.ends.iter().any(end), "{:?}", branch.ends);
    assert!(branch.ends.contains(&BranchEnd::Range));
    // Stable on one side of the fold, unstable on the other.
    let turns = branch.points.iter().map(|point| point.parameter);
    let turn = turns
        .enumerate()
        .max_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap()
        .0;
    let stable = |points: &[orbit::BranchPoint<_>]| {
        points
            .iter()
            .filter(|point| point.orbit.is_stable())
            .count()
    };
    let (before, after) = branch.points.split_at(turn);
    let counts = (stable(before), stable(&after[1..]));
    let expected = (0, after.len() - 1);
    let mirrored = (before.len(), 0);
    assert!(counts == expected || counts == mirrored, "{counts:?}");
}

fn dwelling(
    [damping, kinetic, at_once]: [f64; 3],
    form: &dyn Fn(Coulomb) -> Result<Dwell<Coulomb>, Error>,
    belt_velocity: f64,
) -> Result<Structure, Error> {
    let law = form(Coulomb::new(at_once, kinetic)?)?;
    let contact = Contact::new(0, law, 1.0)?.on_belt(belt_velocity);
    one_mass([1.0, damping, 1.0], 0.0, contact)
}

#[test]
fn stick_slip_with_dwell_ends_at_the_folds_of_the_reference() {
    type Form<'f> = &'f dyn Fn(Coulomb) -> Result<Dwell<Coulomb>, Error>;
    let cases = cases(include_str!("../data/dwell_cycles.json"));
    let known: [(&str, [f64; 3], f64, Form<'_>); 3] = [
        ("dwc_bif_01", [0.05, 0.3, 0.3], 0.1, &|law| {
            Dwell::exponential(law, 0.6, 2.0)
        }),
        ("dwc_bif_02", [0.04, 0.3, 0.35], 0.15, &|law| {
            Dwell::hyperbolic(law, 0.6, 1.5)
        }),
        ("dwc_bif_03", [0.05, 0.4, 0.4], 0.08, &|law| {
            Dwell::logarithmic(law, 0.03, 0.1)
        }),
    ];
    for (id, numbers, start, form) in known {
        let case = cases.iter().find(|case| case["id"] == id).unwrap();
        let family = |v_b: f64| dwelling(numbers, form, v_b);
        let system = family(start).unwrap();
        let motion = system.simulate(State::new(&[-0.6], &[0.0]), 300.0).unwrap();
        let period = Period::Free(last_turn(&motion));
        let orbit = settle(&system, &motion.last(), 0.0, period).unwrap();
        let branch = follow(family, start, &orbit, 0.02..0.5).unwrap();
        let folds = at(&branch, BifurcationKind::Fold);
        let expected = number(&case["v_fold"]);
        println!("{id}: {:.1e}, {:?}", folds[0] - expected, branch.ends);
        assert_eq!(folds.len(), 1);
        assert!(close(folds[0], expected), "{id}: {folds:?}");
        // The unstable motion ends where its arc comes back tangentially.
        let BranchEnd::Grazing { parameter } = branch.ends[1] else {
            panic!("{id}: {:?}", branch.ends)
        };
        let expected = number(&case["v_graze"]);
        // To rounding, in units of the range.
        let error = (parameter - expected).abs() / (0.5 - 0.02);
        println!("{id}: end {error:.1e}");
        assert!(error < 1e-14, "{id}: {parameter}");
        // The last motion is the one there.
        let last = branch.bifurcations.last().unwrap();
        assert_eq!(
            (last.kind, last.parameter),
            (BifurcationKind::Grazing, parameter)
        );
        assert_eq!(last.orbit.multipliers()[0].re, f64::INFINITY);
    }
}

/// A slider that slips all the time pulls with a constant force, which shifts every motion of the
/// mass and changes nothing else.
#[test]
fn an_end_does_not_depend_on_forces_beside_the_contact() {
    let form = |law| Dwell::exponential(law, 0.6, 2.0);
    let mass = |velocity: f64| dwelling([0.05, 0.3, 0.3], &form, velocity);
    let slider = || {
        let contact = Contact::new(0, Coulomb::new(0.4, 0.4)?, 1.0)?.on_belt(9.0);
        contact.with_tangential_stiffness(3.0)
    };
    let end = |family: &dyn Fn(f64) -> Result<Structure, Error>, start: f64| {
        let system = family(0.1).unwrap();
        let motion = system.simulate(State::new(&[start], &[0.0]), 300.0);
        let motion = motion.unwrap();
        let period = Period::Free(last_turn(&motion));
        let orbit = settle(&system, &motion.last(), 0.0, period).unwrap();
        let branch = follow(family, 0.1, &orbit, 0.02..0.5).unwrap();
        let BranchEnd::Grazing { parameter } = branch.ends[1] else {
            panic!("{:?}", branch.ends)
        };
        parameter
    };
    let alone = end(&mass, -0.6);
    let pulled = end(&|velocity| mass(velocity)?.with_contact(slider()?), -0.2);
    assert!((pulled - alone).abs() < 1e-14, "{alone} {pulled}");
}

fn small() -> (Structure, Orbit<State>) {
    let system = forced(0.3).unwrap();
    let orbit = settle(&system, &State::at_rest(1), 200.0, Period::Driven(1)).unwrap();
    (system, orbit)
}

/// The system of `sb_10` of the reference, over the amplitude of its force.
fn forced(amplitude: f64) -> Result<Structure, Error> {
    let law = Polynomial::new(0.45, 0.3, 0.5)?;
    let force = Drive::harmonic(amplitude, 0.8, 0.0)?;
    let contact = Contact::new(0, law, 1.0)?.on_belt(0.7);
    one_mass([1.0, 0.2, 1.0], force, contact)
}

#[test]
fn a_branch_is_the_same_each_time_to_the_bit() {
    let (_, orbit) = small();
    let [a, b] = [0, 1].map(|_| follow(forced, 0.3, &orbit, 0.1..0.6).unwrap());
    assert_eq!(a.points.len(), b.points.len());
    for (a, b) in a.points.iter().zip(&b.points) {
        assert_eq!(a.parameter.to_bits(), b.parameter.to_bits());
        assert_eq!(a.orbit.state(), b.orbit.state());
        assert_eq!(a.orbit.multipliers(), b.orbit.multipliers());
    }
    let bits = |branch: &Branch<_>| {
        let places = branch.bifurcations.iter().map(|b| b.parameter.to_bits());
        places.collect::<Vec<_>>()
    };
    assert_eq!(bits(&a), bits(&b));
}

#[test]
fn a_family_that_fails_ends_the_branch_with_its_error() {
    let (_, orbit) = small();
    let refuse = |amplitude: f64| match amplitude {
        a if a > 0.4 => Err(Error::NotFree),
        a if a < 0.2 => Polynomial::new(0.4, f64::NAN, a).and_then(|_| forced(a)),
        a => forced(a),
    };
    let branch = follow(refuse, 0.3, &orbit, 0.1..0.6).unwrap();
    for (end, border) in branch.ends.iter().zip([0.2, 0.4]) {
        let BranchEnd::Lost { parameter, error } = end else {
            panic!("{end:?}")
        };
        assert!((parameter - border).abs() < 1e-6, "{parameter}");
        let Error::At {
            parameter: "parameter",
            value,
            ..
        } = error
        else {
            panic!("{error:?}")
        };
        assert!((value - border).abs() < 1e-6, "{value}");
    }
}

#[test]
fn a_family_that_jumps_ends_the_branch() {
    let (_, orbit) = small();
    let jumps = |a: f64| forced(if a > 0.35 { a + 0.1 } else { a });
    let branch = follow(jumps, 0.3, &orbit, 0.1..0.6).unwrap();
    assert_eq!(branch.ends[0], BranchEnd::Range);
    let BranchEnd::Lost { parameter, .. } = branch.ends[1] else {
        panic!("{:?}", branch.ends)
    };
    assert_abs_diff_eq!(parameter, 0.35, epsilon = 1e-6);
}

/// The force of a sticking contact that just reaches its limit at a maximum. The motion at the end
/// is known up to one number: the time of the maximum follows from the force, and the displacement
/// there from the limit. From this state the contact must come back to it after a period.
#[test]
fn a_release_that_becomes_tangential_ends_the_branch_there() {
    const FORCE: f64 = 0.112_416_454_375_324_7;
    const OMEGA: f64 = 0.857_113_939_158_918_2;
    const DAMPING: f64 = 0.008_484_572_687_977_2;
    const BELT: f64 = 0.046_186_779_667_100_9;
    let law = Coulomb::new(0.352_523_204_526_248_6, 0.225_371_866_433_964_9).unwrap();
    let family = |load: f64| {
        let force = Drive::sine(FORCE, OMEGA)?;
        let contact = Contact::new(0, law, load)?.on_belt(BELT);
        one_mass([1.0, DAMPING, 1.0], force, contact)
    };
    let start = State::new(&[0.3], &[0.0]);
    let orbit = settle(&family(1.246).unwrap(), &start, 200.0, Period::Driven(1)).unwrap();
    let branch = follow(family, 1.246, &orbit, 1.0..3.0).unwrap();
    let BranchEnd::Discontinuity {
        parameter,
        time,
        contact: 0,
        events,
        beyond,
    } = &branch.ends[1]
    else {
        panic!("{:?}", branch.ends)
    };
    let stick = (Element::Contact(0), EventKind::Stick);
    let release = EventKind::Release(Direction::Lagging);
    assert_eq!(events, &[stick, (Element::Contact(0), release)]);
    assert_eq!(beyond, &[stick]);

    let (period, highest) = (TAU / OMEGA, (TAU - (BELT / (FORCE * OMEGA)).acos()) / OMEGA);
    let missed = |load: f64| {
        let limit = load * law.static_coefficient();
        let displacement = limit + FORCE * (OMEGA * highest).sin() - DAMPING * BELT;
        // Beyond the limit by rounding, so that the contact slips.
        let start = State::new(&[displacement + 1e-14], &[BELT]);
        let integrator = Integrator::new().with_start_time(highest).unwrap();
        let motion = integrator.simulate(&family(load).unwrap(), start, period);
        let motion = motion.unwrap();
        let mut events = motion.events().iter();
        let stick = events.find(|event| event.kind == EventKind::Stick).unwrap();
        let rest = highest + period - stick.time;
        stick.state.displacements[0] + BELT * rest - displacement
    };
    let (mut low, mut high) = (1.70, 1.71);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if missed(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    // The last motion lies 2e-5 before the end.
    let last = branch.points.last().unwrap();
    assert!((low - last.parameter).abs() > 1e-6);
    assert_abs_diff_eq!(*parameter, low, epsilon = 1e-8);
    assert_abs_diff_eq!(*time, highest, epsilon = 1e-5);
}

#[test]
fn what_cannot_be_followed_is_refused() {
    let (_, orbit) = small();
    let nan = f64::NAN;
    for (parameter, range) in [
        (0.3, 0.6..0.1),
        (0.3, nan..0.6),
        (0.3, 0.1..nan),
        (0.3, 0.1..f64::INFINITY),
        (0.3, f64::NEG_INFINITY..0.6),
        (nan, 0.1..0.6),
        (0.7, 0.1..0.6),
        (0.3, 0.3..0.3),
    ] {
        let calls = Cell::new(0);
        let family = |a: f64| {
            calls.set(calls.get() + 1);
            forced(a)
        };
        let error = follow(family, parameter, &orbit, range).unwrap_err();
        assert!(matches!(error, Error::InvalidParameter { .. }), "{error}");
        assert_eq!(calls.get(), 0);
    }
    // Not a motion of this family at this parameter.
    let error = follow(forced, 0.31, &orbit, 0.1..0.6).unwrap_err();
    let is_refused = |error: &Error| {
        matches!(error, Error::At { value: 0.31, source, .. }
            if matches!(**source, Error::NotPeriodic { .. }))
    };
    assert!(is_refused(&error), "{error}");
    let family = |_| Err::<Structure, _>(Error::NotFree);
    assert_eq!(
        follow(family, 0.3, &orbit, 0.1..0.6).unwrap_err(),
        Error::At {
            parameter: "parameter",
            value: 0.3,
            source: Box::new(Error::NotFree)
        }
    );
}

/// Any start on the branch gives the same branch.
/// Two harmonics over the frequency of one: a common period exists at 1.5 and not beside it.
#[test]
fn a_common_period_at_single_values_makes_no_branch() {
    let family = |frequency: f64| -> Result<Structure, Error> {
        let drive = Drive::sine(0.3, frequency)?.with_harmonic(0.2, 1.0, 0.0)?;
        let contact = Contact::new(0, Coulomb::new(0.4, 0.4)?, 0.1)?;
        one_mass([1.0, 0.2, 4.0], drive, contact)
    };
    let start = State::at_rest(1);
    let orbit = settle(&family(1.5).unwrap(), &start, 50.0, Period::Driven(1)).unwrap();
    let asked = Cell::new(0);
    let counted = |frequency: f64| {
        asked.set(asked.get() + 1);
        family(frequency)
    };
    let error = follow(counted, 1.5, &orbit, 1.4..1.6).unwrap_err();
    let Error::At { source, .. } = &error else {
        panic!("{error}")
    };
    assert!(matches!(**source, Error::NoCommonPeriod), "{error}");
    assert!(asked.get() < 5, "{}", asked.get());
}

#[test]
fn both_directions_meet() {
    let (_, orbit) = small();
    let branch = follow(forced, 0.3, &orbit, 0.1..0.6).unwrap();
    let grazing = at(&branch, BifurcationKind::Grazing);
    for i in [0, branch.points.len() / 2, branch.points.len() - 1] {
        let point = &branch.points[i];
        let again = follow(forced, point.parameter, &point.orbit, 0.1..0.6).unwrap();
        assert_eq!(again.ends, [BranchEnd::Range, BranchEnd::Range]);
        assert!(close(at(&again, BifurcationKind::Grazing)[0], grazing[0]));
        let ends = |branch: &Branch<_>| {
            let last = branch.points.len() - 1;
            [0, last].map(|i| branch.points[i].orbit.extremes(0))
        };
        for (a, b) in ends(&again).iter().zip(ends(&branch)) {
            assert!((a.0 - b.0).abs() < 1e-11 && (a.1 - b.1).abs() < 1e-11);
        }
    }
}

/// Csernák, Stépán and Shaw's continuum at Ω = 1/2: one multiplier is 1 along a whole family, and
/// nothing hangs.
#[test]
fn a_continuum_is_passed() {
    let family = |friction: f64| {
        let force = Drive::harmonic(1.0, 0.5, 0.0)?;
        let contact = Contact::new(0, Coulomb::new(friction, friction)?, 1.0)?;
        one_mass([1.0, 0.0, 1.0], force, contact)
    };
    let system = family(0.2).unwrap();
    let orbit = settle(&system, &State::at_rest(1), 400.0, Period::Driven(1)).unwrap();
    let branch = follow(family, 0.2, &orbit, 0.19..0.21).unwrap();
    assert!(branch.points.len() < 200);
    for point in &branch.points {
        let (least, largest) = point.orbit.extremes(0);
        assert!(
            (largest - least - 8.0 / 3.0).abs() < 1e-9,
            "{}",
            point.parameter
        );
    }
}

/// A forced mass beside one that slides steadily on a belt: where the second one begins to vibrate
/// by itself, a pair of multipliers leaves the unit circle.
fn forced_beside_sliding(velocity: f64, coupling: f64) -> Result<Structure, Error> {
    let law = Polynomial::new(0.4, 0.25, 0.5)?;
    Structure::new(&[2.0, 1.0])?
        .with_ground_spring(0, 3.0)?
        .with_ground_damper(0, 0.2)?
        .with_force(0, Drive::harmonic(0.05, 0.7, 0.0)?)?
        .with_ground_spring(1, 1.0)?
        .with_ground_damper(1, 0.1)?
        .with_spring(0, 1, coupling)?
        .with_contact(Contact::new(1, law, 1.0)?.on_belt(velocity))
}

#[test]
fn a_pair_of_multipliers_leaves_the_unit_circle() {
    // Without coupling at the Hopf velocity: 2β = 0.1 = 0.45 − 1.8 v².
    let hopf = (0.35_f64 / 1.8).sqrt();
    for (coupling, exact) in [(0.0, Some(hopf)), (0.15, None)] {
        let family = |velocity: f64| forced_beside_sliding(velocity, coupling);
        let guess = State::new(&[0.0, 0.25], &[0.0, 0.0]);
        let orbit = shoot(&family(0.6).unwrap(), &guess, Period::Driven(1)).unwrap();
        assert!(orbit.is_stable() && orbit.multipliers().len() == 4);
        let branch = follow(family, 0.6, &orbit, 0.35..0.8).unwrap();
        let found = at(&branch, BifurcationKind::NeimarkSacker);
        assert_eq!(found.len(), 1, "{found:?}");
        assert_eq!(branch.bifurcations.len(), 1);
        if let Some(exact) = exact {
            assert!(close(found[0], exact), "{} not {exact}", found[0]);
        }
        let largest = branch.bifurcations[0].orbit.multipliers()[0];
        assert!((largest.norm() - 1.0).abs() < 1e-12 && largest.im.abs() > 0.1);
        for point in &branch.points {
            let is_sure = (point.parameter - found[0]).abs() > 1e-9;
            assert!(!is_sure || point.orbit.is_stable() == (point.parameter > found[0]));
        }
        let ends = [&branch.ends[0], &branch.ends[1]];
        assert!(ends.iter().all(|end| matches!(end, BranchEnd::Range)));
    }
}

/// A block that a force holds against the ground moves as soon as the force reaches what static
/// friction carries, and then at once by a finite way.
#[test]
fn where_a_block_breaks_loose_the_branch_ends_by_a_jump() {
    let family = |amplitude: f64| {
        let force = Drive::harmonic(amplitude, 0.7, 1.0)?;
        let contact = Contact::new(0, Coulomb::new(0.5, 0.3)?, 2.0)?;
        one_mass([1.0, 0.1, 1.0], force, contact)
    };
    let start = State::new(&[0.25], &[0.0]);
    let orbit = shoot(&family(0.3).unwrap(), &start, Period::Driven(1)).unwrap();
    assert_eq!(orbit.extremes(0), (0.25, 0.25));
    let branch = follow(family, 0.3, &orbit, 0.1..2.0).unwrap();
    assert_eq!(branch.ends[0], BranchEnd::Range);
    let BranchEnd::Discontinuity {
        parameter,
        time,
        contact: 0,
        events,
        beyond,
    } = &branch.ends[1]
    else {
        panic!("{:?}", branch.ends[1])
    };
    // R = a cos(0.7 t + 1) − q reaches −1 first, where the cosine is −1; any q near 1/4 is one.
    let place = |orbit: &Orbit<State>| orbit.state().displacements[0];
    let last = branch.points.last().unwrap();
    let force = parameter + place(&last.orbit);
    assert!((force - 1.0).abs() < 1e-8, "{force}");
    assert!(
        (time - (std::f64::consts::PI - 1.0) / 0.7).abs() < 1e-6,
        "{time}"
    );
    assert_eq!(events, &[]);
    let release = EventKind::Release(Direction::Lagging);
    assert_eq!(beyond[0], (Element::Contact(0), release));
    for point in &branch.points {
        assert_abs_diff_eq!(place(&point.orbit), 0.25, epsilon = 1e-3);
    }
}

/// Of a forced block that stops in each period, the last motion at a jump and the motion from the
/// same start beyond it.
#[test]
fn a_jump_is_where_motions_from_one_start_part() {
    let mut random = crate::common::Random::new(11);
    let mut jumps = 0;
    for i in 0..count(20, 40) {
        let mut between = |low: f64, high: f64| random.uniform(low, high);
        let (limit, part) = (between(0.3, 0.6), between(0.4, 0.9));
        let (damping, belt) = (between(0.02, 0.3), between(-0.3, 0.3));
        let (amplitude, frequency, phase) =
            (between(0.5, 1.5), between(0.3, 1.2), between(0.0, 6.0));
        let family = |frequency: f64| {
            let law = Coulomb::new(limit, part * limit)?;
            let force = Drive::harmonic(amplitude, frequency, phase)?;
            let contact = Contact::new(0, law, 1.0)?.on_belt(belt);
            one_mass([1.0, damping, 1.0], force, contact)
        };
        let start = State::at_rest(1);
        let Ok(orbit) = settle(
            &family(frequency).unwrap(),
            &start,
            400.0,
            Period::Driven(1),
        ) else {
            continue;
        };
        let range = 0.8 * frequency..1.25 * frequency;
        let branch = follow(family, frequency, &orbit, range).unwrap();
        for (which, end) in branch.ends.iter().enumerate() {
            let BranchEnd::Discontinuity {
                parameter,
                time,
                events,
                beyond,
                ..
            } = end
            else {
                continue;
            };
            jumps += 1;
            let last = &branch.points[which * (branch.points.len() - 1)];
            // Before a release that becomes tangential the multiplier grows without bound.
            if last.orbit.multipliers()[0].norm() > 1e3 {
                check_tangential_end(&branch, which, *parameter);
                continue;
            }
            assert!((last.parameter - parameter).abs() < 1e-8 * frequency, "{i}");
            let away = 1e-7 * (2.0 * which as f64 - 1.0);
            let kinds = |parameter: f64| -> Vec<(Element, EventKind)> {
                let system = family(parameter).unwrap();
                let motion = system
                    .simulate(last.orbit.state(), system.period().unwrap())
                    .unwrap();
                let events = motion.events().iter().filter(|event| event.time > 1e-6);
                events.map(|event| (event.element, event.kind)).collect()
            };
            assert_eq!(&kinds(parameter - away), events, "{i}");
            assert_ne!(events, beyond, "{i}");
            assert!(*time > 0.0 && *time <= 1.001 * last.orbit.period(), "{i}");
        }
    }
    println!("{jumps} jumps");
    assert!(jumps >= count(1, 4), "{jumps}");
}

/// Before a tangential release the first multiplier grows like 1/d, d the distance of the parameter
/// from the end.
fn check_tangential_end(branch: &Branch<State>, which: usize, end: f64) {
    let mut inwards: Vec<_> = branch.points.iter().collect();
    if which == 1 {
        inwards.reverse();
    }
    let first = |point: &BranchPoint<State>| point.orbit.multipliers()[0].norm();
    let distance = |point: &BranchPoint<State>| (point.parameter - end).abs();
    let last = inwards[0];
    let mut before = inwards.iter();
    let before = before.find(|point| first(point) < 0.5 * first(last));
    let [near, far] = [last, before.unwrap()].map(|point| first(point) * distance(point));
    assert!((near / far - 1.0).abs() < 0.01, "{end}: {near} {far}");
    assert!(distance(last) < 1e-4 * end, "{end} {}", last.parameter);
}

/// Near a tangential release the multiplier is 14 000, and derivatives by the parameter are taken
/// over increments that rounding leaves alone: with shorter ones the branch was lost.
#[test]
fn a_branch_with_large_multipliers_is_followed_to_its_end() {
    let family = |load: f64| {
        let law = Coulomb::new(0.5680164645955348, 0.2512321222867724)?;
        let force = Drive::sine(0.41119169421346063, 0.6672762460406475)?;
        let contact = Contact::new(0, law, load)?.on_belt(0.03688300575324713);
        one_mass([1.0, 0.07206176696343199, 1.0], force, contact)
    };
    let load = 1.0075678562841528;
    let start = State::new(&[0.3], &[0.0]);
    let orbit = settle(&family(load).unwrap(), &start, 200.0, Period::Driven(1)).unwrap();
    let branch = follow(family, load, &orbit, 0.3 * load..2.5 * load).unwrap();
    let BranchEnd::Discontinuity { parameter, .. } = &branch.ends[1] else {
        panic!("{:?}", branch.ends);
    };
    check_tangential_end(&branch, 1, *parameter);
}

/// A second mass, apart from the first, becomes neutral at once, where the first one gets its
/// contact, and then stable; it moves as sin 0.7 t all the time. No multiplier passes 1.
#[test]
fn no_sign_is_carried_across_a_change_of_events() {
    let family = |parameter: f64| {
        let (frequency, damping) = (0.7, 0.5);
        let stiffness = if parameter > 0.0 { parameter } else { -0.1 };
        let force = Drive::harmonic(damping * frequency, frequency, 0.0)?
            .with_sine(stiffness - frequency * frequency, frequency)?;
        let free = Structure::new(&[1.0, 1.0])?
            .with_ground_spring(0, 1.0)?
            .with_ground_damper(0, 0.2)?
            .with_force(0, Drive::harmonic(1.0, frequency, 0.0)?)?
            .with_ground_damper(1, damping)?
            .with_stiffness(DMatrix::from_row_slice(2, 2, &[0.0, 0.0, 0.0, stiffness]))?
            .with_force(1, force)?;
        if parameter > 0.0 {
            free.with_contact(Contact::new(0, Coulomb::new(0.3, 0.3)?, parameter)?)
        } else {
            Ok(free)
        }
    };
    let start = State::new(&[0.0, 0.0], &[0.0, 0.7]);
    let orbit = shoot(&family(-0.1).unwrap(), &start, Period::Driven(1)).unwrap();
    assert!(orbit.multipliers()[0].re > 1.0);
    let branch = follow(family, -0.1, &orbit, -0.2..0.2).unwrap();
    let kinds: Vec<_> = branch.bifurcations.iter().map(|found| found.kind).collect();
    let ends = (&branch.ends[0], &branch.ends[1]);
    assert_eq!(ends, (&BranchEnd::Range, &BranchEnd::Range), "{kinds:?}");
    assert_eq!(
        kinds,
        [BifurcationKind::Grazing],
        "{:?}",
        branch.bifurcations
    );
    assert!(branch.points.last().unwrap().orbit.is_stable());
}

/// Den Hartog's oscillator without and with stops: the two halves of a symmetric motion get a stop
/// at one frequency, and that is one bifurcation.
#[test]
fn what_happens_in_both_halves_of_a_motion_is_one_bifurcation() {
    let family = |frequency: f64| {
        let force = Drive::harmonic(1.0, frequency, 0.0)?;
        let contact = Contact::new(0, Coulomb::new(0.5, 0.5)?, 1.0)?;
        one_mass([1.0, 0.05, 1.0], force, contact)
    };
    let start = State::at_rest(1);
    let orbit = settle(&family(0.9).unwrap(), &start, 300.0, Period::Driven(1)).unwrap();
    let branch = follow(family, 0.9, &orbit, 0.1..0.95).unwrap();
    let found = branch.bifurcations.iter();
    let found: Vec<_> = found.map(|found| (found.kind, found.parameter)).collect();
    let stops = |frequency: f64| {
        let orbit = settle(&family(frequency)?, &start, 300.0, Period::Driven(1))?;
        let stops = orbit.events().iter();
        Ok::<usize, Error>(stops.filter(|event| event.kind == EventKind::Stick).count())
    };
    // By simulation beside each.
    let [&more, &pair, &first] = exactly(&found);
    for ((kind, parameter), below, above) in [(more, 6, 4), (pair, 4, 2), (first, 2, 0)] {
        assert_eq!(stops(parameter - 1e-4), Ok(below), "{kind} {parameter}");
        assert_eq!(stops(parameter + 1e-4), Ok(above), "{kind} {parameter}");
    }
}

/// Behind a fold the branch meets the touch at which its stop vanishes, so near to the fold that
/// the parameter hardly changes in between; the motions without a stop go on from there.
#[test]
fn a_branch_goes_on_where_a_stop_vanishes_beside_a_fold() {
    use BifurcationKind::{Fold, Grazing};
    let law = Polynomial::new(0.55, 0.3, 0.7).unwrap();
    let family = |amplitude: f64, frequency: f64| {
        let force = Drive::harmonic(amplitude, frequency, 0.0)?;
        let contact = Contact::new(0, law, 0.9)?.on_belt(0.25);
        one_mass([1.0, 0.06, 1.0], force, contact)
    };
    let amplitudes = [0.124, 0.126, 0.1245, 0.125];
    for amplitude in some(2, amplitudes) {
        let family = |frequency: f64| family(amplitude, frequency);
        let start = State::at_rest(1);
        let orbit = settle(&family(0.9).unwrap(), &start, 400.0, Period::Driven(1)).unwrap();
        let branch = follow(family, 0.9, &orbit, 0.5..1.3).unwrap();
        assert_eq!(
            branch.ends,
            [BranchEnd::Range, BranchEnd::Range],
            "{amplitude}"
        );
        let kinds: Vec<_> = branch.bifurcations.iter().map(|b| b.kind).collect();
        assert_eq!(kinds, [Grazing, Fold, Fold, Fold, Grazing], "{amplitude}");
        // The motion there just touches the velocity of the belt.
        let touch = &branch.bifurcations[0];
        let fastest = touch.orbit.velocity_extremes(0).1;
        println!("{amplitude}: {} {:.1e}", touch.parameter, fastest - 0.25);
        assert!((fastest - 0.25).abs() < 1e-12, "{fastest}");
        // From both sides: the same motion starts the branch without stops.
        let free = &branch.points[0];
        assert!(free.orbit.events().is_empty());
        let back = follow(family, free.parameter, &free.orbit, 0.5..0.9).unwrap();
        let found = nearest(&at(&back, Grazing), touch.parameter);
        assert!(
            (found - touch.parameter).abs() < 1e-12,
            "{found} {}",
            touch.parameter
        );
    }
}

/// A chain with a belt at its first mass, driven by a second belt whose changing speed does not
/// change its friction: a motion that is constant, K x = (Σ μ N, 0, 0).
#[test]
fn a_chain_that_stands_still_under_a_drive_is_followed() {
    let law = Rational::new(0.4, 0.5).unwrap();
    for (damping, coupling) in [(0.2, 0.1), (0.25, 1.0), (0.5, 1.0)] {
        let family = |speed: f64| -> Result<Structure, Error> {
            let mut system = Structure::new(&[1.0; 3])?;
            for (i, stiffness) in [1.0, 2.0, 3.0].into_iter().enumerate() {
                system = system.with_ground_spring(i, stiffness)?;
                system = system.with_ground_damper(i, damping)?;
            }
            let belt = Drive::constant(0.3).with_harmonic(0.2, 2.5, 0.0)?;
            system
                .with_spring(0, 1, coupling)?
                .with_spring(1, 2, coupling)?
                .with_contact(Contact::new(0, Coulomb::new(0.2, 0.2)?, 0.5)?.on_belt(belt))?
                .with_contact(Contact::new(0, law, 0.7)?.on_belt(speed))
        };
        let start = State::new(&[0.3; 3], &[0.0; 3]);
        let orbit = settle(&family(0.5).unwrap(), &start, 400.0, Period::Driven(1)).unwrap();
        let branch = follow(family, 0.5, &orbit, 0.3..1.0).unwrap();
        assert_eq!(branch.ends, [BranchEnd::Range, BranchEnd::Range]);
        assert!(branch.bifurcations.is_empty());
        for point in &branch.points {
            let force = 0.2 * 0.5 + law.kinetic(point.parameter) * 0.7;
            let held = family(point.parameter).unwrap().stiffness()
                * DVector::from_vec(point.orbit.state().displacements);
            let error = (held - DVector::from_vec(vec![force, 0.0, 0.0])).amax();
            assert!(error < 1e-11, "{}: {error:e}", point.parameter);
        }
    }
}

/// Where a motion lies does not matter: under a constant force of up to 10⁴ extents its branch has
/// the same points, and ends at the Hopf point to which it shrinks.
#[test]
fn a_branch_does_not_depend_on_the_static_displacement() {
    // The Hopf point of steady sliding and the bifurcations above it, as in `vibration_ranges`.
    const HOPF: f64 = 0.738_553_461_542_470_2;
    let followed = |force: f64| {
        let mass = |velocity: f64| -> Result<Structure, Error> {
            let law = Exponential::new(0.4, 0.25, 0.5)?;
            let force = Drive::constant(force);
            let contact = Contact::new(0, law, 1.0)?.on_belt(velocity);
            one_mass([1.0, 0.1, 1.0], force, contact)
        };
        let start = State::new(&[force + 0.3], &[0.3]);
        let orbit = orbit::settle(&mass(0.6).unwrap(), &start, 300.0, Period::Free(6.3)).unwrap();
        orbit::follow(mass, 0.6, &orbit, 0.5..1.0).unwrap()
    };
    for force in [0.0, 1e2, 1e3, 1e4] {
        let branch = followed(force);
        println!(
            "{force:e}: {} points, {:?}",
            branch.points.len(),
            branch.ends
        );
        let BranchEnd::Hopf { parameter } = branch.ends[1] else {
            panic!("{force:e}: {:?}", branch.ends);
        };
        assert_abs_diff_eq!(parameter, HOPF, epsilon = 1e-9 + 1e-12 * force);
        assert!(branch.points.len() < 200);
        let [grazing, fold] = exactly(&branch.bifurcations);
        let kinds = [grazing.kind, fold.kind];
        assert_eq!(kinds, [BifurcationKind::Grazing, BifurcationKind::Fold]);
        assert_abs_diff_eq!(grazing.parameter, 0.795_625_251_483, epsilon = 1e-10);
        assert_abs_diff_eq!(fold.parameter, 0.819_099_550_916_72, epsilon = 1e-10);
    }
}

/// A drill string of four inertias, turned at a speed in revolutions per minute: the table, two
/// parts of the pipe, and the bit with dry friction on the rock.
fn drill_string(speed: f64) -> Result<Structure, Error> {
    let speed = speed * TAU / 60.0;
    let mut string = Structure::new(&[374.0, 60.0, 60.0, 2122.0])?;
    for i in 0..3 {
        string = string
            .with_spring(i, i + 1, 1419.0)?
            .with_damper(i, i + 1, 69.6)?;
    }
    let bit = Contact::new(0, Stribeck::new(0.8, 0.4, 1.0, 1)?, 12e3)?;
    string
        .with_ground_spring(3, 4000.0)?
        .with_ground_damper(3, 425.0)?
        .with_contact(bit.on_belt(-speed))
}

/// The start of a branch is a turning point of one coordinate. When stick of the bit passes it, the
/// velocity of the bit at the start has a kink over the parameter, by more than a right angle in
/// the units of the walk. The motion itself does not change: no bifurcation, and the branch goes on
/// to motions that a simulation reaches.
#[test]
fn an_event_may_pass_the_start_at_a_sharp_corner() -> Result<(), Error> {
    let start = State::at_rest(4);
    let orbit = settle(&drill_string(18.75)?, &start, 1500.0, Period::Free(15.0))?;
    let branch = follow(drill_string, 18.75, &orbit, 16.0..60.0)?;
    assert_eq!(branch.ends, [BranchEnd::Range, BranchEnd::Range]);
    let kinds: Vec<_> = branch.bifurcations.iter().map(|found| found.kind).collect();
    assert!(
        kinds.iter().all(|kind| *kind == BifurcationKind::Fold),
        "{kinds:?}"
    );
    let last = &branch.points.last().unwrap().orbit;
    let settled = settle(&drill_string(60.0)?, &start, 1500.0, Period::Free(7.7))?;
    assert_abs_diff_eq!(last.period(), settled.period(), epsilon = 1e-11);
    let [low, high] = [last, &settled].map(|orbit| orbit.extremes(0));
    assert_abs_diff_eq!(low.0, high.0, epsilon = 1e-10);
    assert_abs_diff_eq!(low.1, high.1, epsilon = 1e-10);
    Ok(())
}

/// A joint, and a contact on the ground at one of its masses: where both stick, the start of a
/// motion is at rest to the bit, so that a motion from it has the events of the orbit.
#[test]
fn starts_at_which_contacts_share_a_mass_stick() {
    let mut random = Random::new(61);
    let (mut at_rest, mut branches) = (0, 0);
    for i in 0..count(4, 40) {
        let uniform = |random: &mut Random, low: f64, high: f64| random.uniform(low, high);
        let [a, b, c] = [(); 3].map(|()| uniform(&mut random, 0.0, 1.0));
        let (force, frequency) = (
            uniform(&mut random, 0.3, 1.3),
            uniform(&mut random, 0.6, 1.6),
        );
        let phase = uniform(&mut random, 0.0, 6.0);
        let family = |factor: f64| -> Result<Structure, Error> {
            Structure::new(&[1.0 + a, 1.0 + b])?
                .with_ground_spring(0, 1.0)?
                .with_ground_spring(1, 0.9)?
                .with_spring(0, 1, 1.0 + c)?
                .with_ground_damper(0, 0.05)?
                .with_ground_damper(1, 0.1)?
                .with_force(0, Drive::harmonic(force * factor, frequency, phase)?)?
                .with_contact(Contact::between(0, 1, Coulomb::new(0.4, 0.25)?, 0.5)?)?
                .with_contact(Contact::new(1, Coulomb::new(0.4, 0.36)?, 0.9)?)
        };
        let start = State::new(&[-0.4, 0.2], &[0.0; 2]);
        let Ok(orbit) = settle(&family(1.0).unwrap(), &start, 600.0, Period::Driven(1)) else {
            continue;
        };
        if orbit.events().is_empty() {
            continue;
        }
        let search = Search::new().with_max_steps(400_000).unwrap();
        let Ok(branch) = search.follow(family, 1.0, &orbit, 0.95..1.05) else {
            continue;
        };
        branches += 1;
        for point in &branch.points {
            let state = point.orbit.state();
            let is_rest = |v: &f64| *v == 0.0;
            at_rest += usize::from(state.velocities.iter().any(is_rest));
            // What is no rounding of 0 is a velocity.
            let is_bit = |v: &f64| *v != 0.0 && v.abs() < 1e-17;
            assert!(
                !state.velocities.iter().any(is_bit),
                "{i}, {}: {state:?}",
                point.parameter
            );
        }
    }
    assert!(branches > 1 && at_rest > 0, "{branches}, {at_rest}");
}
