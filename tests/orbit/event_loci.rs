//! Curves of grazing motions, onsets of stops and orders of events in two parameters.

use std::f64::consts::PI;
use std::ops::Range;

use serde_json::Value;

use stick_slip::orbit::{
    self, Bifurcation, BifurcationKind, LocusEnd, LocusKind, Orbit, Period, Search, SpecialKind,
    follow, settle, shoot,
};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Drive, Error, EventKind, Exponential, MassOnBelt, RateState, Structure,
    bifurcation, limit_cycle,
};

use crate::common::{larger, list, number, one_mass, some, text};
use crate::loci::{compare, curve, has_special, member, parameters};

/// Relative error promised for parameters, where they are well conditioned.
const ACCURACY: f64 = 1e-13;

/// The bifurcations of a kind over the first parameter, from a motion at a value of it.
fn bifurcations(
    case: &Value,
    kind: BifurcationKind,
    [first, second]: [f64; 2],
    motion: &Orbit<State>,
    range: Range<f64>,
) -> Vec<Bifurcation<State>> {
    let family = |first: f64| Ok(member(&case["system"], first, second));
    let branch = follow(family, first, motion, range).unwrap();
    let mut found = branch.bifurcations;
    found.retain(|found| found.kind == kind);
    found
}

fn driven(case: &Value, [first, second]: [f64; 2]) -> Orbit<State> {
    let system = member(&case["system"], first, second);
    settle(
        &system,
        &State::new(&[0.1], &[0.0]),
        600.0,
        Period::Driven(1),
    )
    .unwrap()
}

/// The end of the unstable stick-slip motion with dwell, over belt velocity and the time constant
/// of dwell: v_graze = γ₂ (μ_s(θ) − μ_k) Λ(β).
#[test]
fn grazing_ends_of_stick_slip_with_dwell() {
    let case = curve("dwg");
    let (v_b, theta) = (0.15, 1.5);
    let system = member(&case["system"], v_b, theta);
    let motion = system.simulate(State::new(&[-0.6], &[0.0]), 300.0).unwrap();
    let sticks = motion.events().iter().rev();
    let mut sticks = sticks.filter(|e| e.kind == EventKind::Stick);
    let period = sticks.next().unwrap().time - sticks.next().unwrap().time;
    let motion = settle(&system, &motion.last(), 0.0, Period::Free(period)).unwrap();
    let ends = bifurcations(
        &case,
        BifurcationKind::Grazing,
        [v_b, theta],
        &motion,
        0.1..0.4,
    );
    let ranges = [0.05..0.6, 0.3..4.0];
    let worst = compare(&case, list(&case["points"]), 1, (&ends[0], theta), &ranges);
    assert!(worst < ACCURACY, "{worst:e}");
    let family = |first: f64, second: f64| Ok(member(&case["system"], first, second));
    let locus = orbit::locus(family, &ends[0], theta, ranges).unwrap();
    assert_eq!(locus.kind, LocusKind::Grazing { contact: 0 });
    assert_eq!(locus.ends, [LocusEnd::Ranges, LocusEnd::Ranges]);
    for point in &locus.points {
        // Slip time and stick time do not depend on the time constant.
        assert!((point.orbit.period() - 6.322850189905037743).abs() < 1e-13);
        assert!(!point.orbit.is_stable());
    }
}

/// Pure slip under a harmonic force reaches the velocity of the belt:
/// p = v_b √((1 − Ω²)² + (cΩ)²)/Ω.
#[test]
fn grazing_of_forced_pure_slip() {
    let case = curve("cgr");
    let motion = driven(&case, [0.6, 0.25]);
    let kind = BifurcationKind::Grazing;
    let grazing = bifurcations(&case, kind, [0.6, 0.25], &motion, 0.6..0.8);
    let ranges = [0.3..3.2, 0.01..1.0];
    let worst = compare(
        &case,
        list(&case["points"]),
        0,
        (&grazing[0], 0.25),
        &ranges,
    );
    assert!(worst < ACCURACY, "{worst:e}");
}

/// A second mass that creeps, slower at its turns than the first one, changes nothing of the curve.
#[test]
fn grazing_beside_a_mass_that_creeps() {
    const BELT: f64 = 0.3;
    let creep = RateState::aging(0.3, 0.05, 0.02, 0.1, 0.01).unwrap();
    let family = |frequency: f64, amplitude: f64| -> Result<Structure, Error> {
        Structure::new(&[1.0, 1.0])?
            .with_ground_spring(0, 1.0)?
            .with_ground_damper(0, 0.06)?
            .with_force(0, Drive::harmonic(amplitude, frequency, 0.0)?)?
            .with_contact(Contact::new(0, Coulomb::new(0.3, 0.3)?, 1.0)?.on_belt(BELT))?
            .with_ground_spring(1, 1.0)?
            .with_ground_damper(1, 0.1)?
            .with_force(1, Drive::harmonic(0.1, frequency, 0.0)?)?
            .with_contact(Contact::new(1, creep, 1.0)?.on_belt(0.01))
    };
    let at = [0.6, 0.25];
    let system = family(at[0], at[1]).unwrap();
    let motion = settle(&system, &State::at_rest(2), 600.0, Period::Driven(1)).unwrap();
    let along = |frequency: f64| family(frequency, at[1]);
    let branch = follow(along, at[0], &motion, 0.6..0.8).unwrap();
    let mut found = branch.bifurcations.iter();
    let grazing = found.find(|found| found.kind == BifurcationKind::Grazing);
    let ranges = [0.6..0.8, 0.1..0.3];
    let locus = orbit::locus(family, grazing.unwrap(), at[1], ranges).unwrap();
    assert_eq!(locus.kind, LocusKind::Grazing { contact: 0 });
    assert_eq!(locus.ends, [LocusEnd::Ranges, LocusEnd::Ranges]);
    for point in &locus.points {
        let [frequency, amplitude] = point.parameters;
        let known = BELT * (1.0 - frequency.powi(2)).hypot(0.06 * frequency) / frequency;
        let off = amplitude - known;
        assert!(off.abs() < 1e-12, "{off:e} at {frequency}");
    }
}

/// Cycles that touch the belt; where their multiplier is 1 a curve of folds ends.
#[test]
fn grazing_of_cycles_on_a_belt() {
    let case = curve("bel_grazing");
    let points = list(&case["points"]);
    let near = &points[4];
    let [v_b, damping] = parameters(near);
    let slower = v_b * 0.998;
    let system = member(&case["system"], slower, damping);
    let (q, period) = (number(&near["start"]["q"][0]), number(&near["period"]));
    let cycle = shoot(
        &system,
        &State::new(&[0.995 * q], &[0.0]),
        Period::Free(period),
    )
    .unwrap();
    assert!(cycle.events().is_empty());
    let range = 0.99 * v_b..1.01 * v_b;
    let kind = BifurcationKind::Grazing;
    let grazing = bifurcations(&case, kind, [slower, damping], &cycle, range);
    let ranges = [0.8..1.9, 0.03..0.1];
    let worst = compare(&case, points, 1, (&grazing[0], damping), &ranges);
    assert!(worst < 10.0 * ACCURACY, "{worst:e}");
    let family = |first: f64, second: f64| Ok(member(&case["system"], first, second));
    let locus = orbit::locus(family, &grazing[0], damping, ranges).unwrap();
    let known = &list(&case["codimension_two"])[0];
    has_special(&locus, SpecialKind::FoldGrazing, known, 1e-12);
}

/// Den Hartog's limit of motions without stops: stops begin at the turning points, or between.
#[test]
fn stops_begin_at_den_hartogs_limit() {
    let cases = [
        (
            "dh_05",
            vec![
                ([0.7, 0.45], 0.55..0.75, 3..10),
                ([0.5, 0.15], 0.4..0.5, 1..3),
            ],
        ),
        ("dh_0", vec![([0.7, 0.5], 0.55..0.75, 1..10)]),
    ];
    for (id, seeds) in some(1, cases) {
        let case = curve(id);
        let points = list(&case["points"]);
        for (at, range, known) in seeds {
            let motion = driven(&case, at);
            let family = |first: f64| Ok(member(&case["system"], first, at[1]));
            let branch = follow(family, at[0], &motion, range).unwrap();
            let at_turns = text(&points[known.start]["at"]) == "turning";
            let kind = [BifurcationKind::Grazing, BifurcationKind::Sequence][usize::from(at_turns)];
            let mut limits = branch.bifurcations.iter();
            let limit = limits.find(|found| found.kind == kind).unwrap();
            let family = |first: f64, second: f64| Ok(member(&case["system"], first, second));
            let ranges = [0.25..2.1, 0.01..1.0];
            let search = Search::new().with_max_points(150).unwrap();
            let locus = search.locus(family, limit, at[1], ranges.clone()).unwrap();
            assert_eq!(at_turns, locus.kind == LocusKind::StopOnset { contact: 0 });
            let worst = compare(&case, &points[known], 0, (limit, at[1]), &ranges);
            assert!(worst < ACCURACY, "{id}: {worst:e}");
            let ends = [0, locus.points.len() - 1].map(|i| locus.points[i].parameters);
            // Both kinds up to where the touch falls onto the turning point.
            if id == "dh_05" {
                let meeting = ends[usize::from(!at_turns)];
                let apart = (meeting[0] - 0.47593).hypot(meeting[1] - 0.24828);
                assert!(apart < 2e-3, "{meeting:?}");
            }
        }
    }
}

/// Without damping stops begin at the turning points above half of the natural frequency and
/// between them below, and the curves of both end at one point. Between two turns, with the force
/// cos(Ωt + φ) and friction F,
///
/// ```text
/// v = F sin t − F tan(π/2Ω) cos t − Ω/(1 − Ω²) sin(Ωt + φ),    v(0) = 0:
/// ```
///
/// v'(0) = 0 is the onset at the turns. At Ω = 1/2, v = sin(t/2) (2 F cos(t/2) − 2/3), which has
/// the onset at F = 1/3, with v''(0) = 0: there the touch falls onto the turn. A multiplier is 1.
#[test]
fn stops_without_damping_begin_at_the_turns_above_half_of_the_frequency() {
    let family = |frequency: f64, friction: f64| -> Result<Structure, Error> {
        Structure::new(&[1.0])?
            .with_ground_spring(0, 1.0)?
            .with_force(0, Drive::harmonic(1.0, frequency, 0.0)?)?
            .with_contact(Contact::new(0, Coulomb::new(friction, friction)?, 1.0)?)
    };
    let known = |frequency: f64| {
        let tangent = (0.5 * PI / frequency).tan();
        frequency.powi(2) / (1.0 - frequency.powi(2)).abs() / 1.0_f64.hypot(frequency * tangent)
    };
    let seeds = [([0.7, 0.5], 0.55..0.75), ([0.45, 0.15], 0.38..0.49)];
    for (at, range) in seeds {
        let system = family(at[0], at[1]).unwrap();
        let motion = settle(&system, &State::at_rest(1), 600.0, Period::Driven(1)).unwrap();
        let branch = follow(|first| family(first, at[1]), at[0], &motion, range).unwrap();
        let begin = &branch.bifurcations[0];
        let locus = orbit::locus(family, begin, at[1], [0.3..0.9, 0.05..0.9]).unwrap();
        let at_turns = locus.kind == LocusKind::StopOnset { contact: 0 };
        assert_eq!(at_turns, at[0] == 0.7);
        let ends = [0, locus.points.len() - 1].map(|i| locus.points[i].parameters);
        let apart = |end: &[f64; 2]| (end[0] - 0.5).hypot(end[1] - 1.0 / 3.0);
        let meets = usize::from(apart(&ends[0]) > apart(&ends[1]));
        // Steps crawl within 1e-3 of the scales before the point.
        assert!(apart(&ends[meets]) < 2e-3, "{ends:?} {:?}", locus.ends);
        let end = &locus.ends[meets];
        assert!(match end {
            LocusEnd::Jump | LocusEnd::Lost { .. } => at_turns,
            LocusEnd::Crawls { .. } => !at_turns,
            _ => false,
        });
        let near = &locus.points[if meets == 0 {
            0
        } else {
            locus.points.len() - 1
        }];
        assert!((near.orbit.multipliers()[0] - 1.0).norm() < 1e-3);
        let points = locus.points.iter().filter(|_| at_turns);
        for point in points.filter(|point| point.parameters[0] > 0.501) {
            let [frequency, friction] = point.parameters;
            let off = friction - known(frequency);
            assert!(off.abs() < 1e-10, "{off:e} at {frequency}");
        }
    }
}

/// At the onset a mass may cross the belt's velocity and arrive again at once, from the other side:
/// the curve is that of the first arrival, and meets the onsets of `follow`. With these digits, the
/// first motion of the curve does arrive again.
#[test]
fn stops_begin_where_a_mass_arrives_twice() {
    const MASS: [f64; 3] = [1.5121236713213477, 0.020503563401108763, 1.090516417752021];
    const FRICTION: f64 = 0.4821848972389353;
    const FREQUENCY: f64 = 1.4680450371880323;
    const BELT: f64 = 0.17864841628308548;
    const LOAD: f64 = 0.5336937627235221;
    let family = |force: f64, load: f64| {
        let contact = Contact::new(0, Coulomb::new(FRICTION, FRICTION)?, load)?.on_belt(BELT);
        one_mass(MASS, Drive::harmonic(force, FREQUENCY, 0.0)?, contact)
    };
    let onsets = |load: f64| {
        let system = family(1.0, load).unwrap();
        let motion = settle(&system, &State::at_rest(1), 400.0, Period::Driven(1)).unwrap();
        let branch = follow(|force| family(force, load), 1.0, &motion, 0.2..3.0).unwrap();
        let mut found = branch.bifurcations;
        found.retain(|found| found.kind == BifurcationKind::Sequence);
        <[Bifurcation<State>; 2]>::try_from(found).unwrap()
    };
    let [low, middle, high] = [0.4, LOAD, 0.7].map(onsets);
    for (i, onset) in middle.iter().enumerate() {
        let locus = orbit::locus(family, onset, LOAD, [0.2..3.0, 0.4..0.7]).unwrap();
        assert_eq!(locus.kind, LocusKind::StopOnset { contact: 0 });
        assert_eq!(locus.ends, [LocusEnd::Ranges, LocusEnd::Ranges]);
        for (load, known) in [(0.4, &low[i]), (0.7, &high[i])] {
            let mut ends = locus.points.iter();
            let end = ends.find(|point| point.parameters[1] == load).unwrap();
            let off = end.parameters[0] - known.parameter;
            assert!(off.abs() < ACCURACY, "{load}: {off:e}");
        }
    }
}

/// Two masses on belts, each under a force, with a spring between them: over the phase of one force
/// and the amplitude of the other.
fn pair(coupling: f64, [phase, amplitude]: [f64; 2]) -> Result<Structure, Error> {
    let contact = |i: usize| Contact::new(i, Coulomb::new(0.5, 0.3)?, 1.5);
    let mut pair = Structure::new(&[1.0, 1.0])?
        .with_ground_spring(0, 1.0)?
        .with_ground_spring(1, 1.3)?
        .with_ground_damper(0, 0.2)?
        .with_ground_damper(1, 0.2)?
        .with_contact(contact(0)?.on_belt(0.1))?
        .with_contact(contact(1)?.on_belt(0.1))?;
    pair = pair
        .with_force(0, Drive::harmonic(amplitude, 0.78, 0.0)?)?
        .with_force(1, Drive::harmonic(0.4, 0.78, phase)?)?;
    if coupling > 0.0 {
        pair = pair.with_spring(0, 1, coupling)?;
    }
    Ok(pair)
}

/// Events of two contacts at one time. Without the spring they are those of single masses.
#[test]
fn events_change_their_order() {
    for coupling in [0.0, 0.05] {
        let family = |first: f64, second: f64| pair(coupling, [first, second]);
        let start = State::new(&[0.3, 0.3], &[0.0, 0.0]);
        let system = family(0.0, 0.4).unwrap();
        let motion = settle(&system, &start, 600.0, Period::Driven(1)).unwrap();
        let branch = follow(|first| family(first, 0.4), 0.0, &motion, -1.5..1.5).unwrap();
        let mut orders = branch.bifurcations.iter();
        let order = orders
            .find(|found| found.kind == BifurcationKind::Sequence)
            .unwrap();
        let locus = orbit::locus(family, order, 0.4, [-1.5..1.5, 0.3..0.5]).unwrap();
        assert_eq!(locus.ends, [LocusEnd::Ranges, LocusEnd::Ranges]);
        assert_eq!(locus.kind, LocusKind::Order { contacts: [0, 1] });
        assert!(locus.points.len() > 10);
        for point in &locus.points {
            let events = point.orbit.events();
            let together = events.windows(2).map(|pair| pair[1].time - pair[0].time);
            let least = together.fold(f64::INFINITY, f64::min);
            assert!(least < 1e-13, "{:?}", point.parameters);
        }
    }
}

/// Fold and grazing velocities of the belt over its damping, by its own searches.
#[test]
fn curves_of_a_belt_are_those_of_its_own_searches() {
    let law = Exponential::new(0.4, 0.3, 1.0).unwrap();
    let family = |v_b: f64, damping: f64| MassOnBelt::new(law, v_b)?.with_damping(damping);
    let system = family(1.45, 0.02).unwrap();
    let cycles = limit_cycle::find(&system).unwrap();
    let unstable = cycles.iter().find(|cycle| !cycle.is_stable()).unwrap();
    let start = unstable.trajectory().state_at(0.0).unwrap();
    let motion = shoot(&system, &start, Period::Free(unstable.period())).unwrap();
    let branch = follow(|v_b| family(v_b, 0.02), 1.45, &motion, 1.0..1.6).unwrap();
    for kind in [BifurcationKind::Fold, BifurcationKind::Grazing] {
        let mut found = branch.bifurcations.iter();
        let at = found.find(|found| found.kind == kind).unwrap();
        let ranges = [1.0..1.8, 0.012..0.026];
        let locus = orbit::locus(family, at, 0.02, ranges).unwrap();
        assert!(locus.points.len() > 20);
        let mut worst: f64 = 0.0;
        for point in locus.points.iter().step_by(5) {
            let [v_b, damping] = point.parameters;
            let system = family(v_b, damping).unwrap();
            let range = 0.9 * v_b..1.1 * v_b;
            let own = match kind {
                BifurcationKind::Fold => bifurcation::fold_velocities(&system, range),
                _ => bifurcation::grazing_velocities(&system, range),
            };
            let own = own.unwrap().into_iter().map(|own| (own - v_b).abs());
            worst = larger(worst, own.fold(f64::INFINITY, f64::min));
        }
        println!("{kind}: {worst:.1e} {:?}", locus.ends);
        assert!(worst < 1e-11, "{kind}: {worst:e}");
    }
}

/// A motion that is not at a change of its events has no curve of them.
#[test]
fn a_motion_beside_its_change_of_events_is_refused() {
    let case = curve("cgr");
    let motion = driven(&case, [0.6, 0.25]);
    let kind = BifurcationKind::Grazing;
    let grazing = bifurcations(&case, kind, [0.6, 0.25], &motion, 0.6..0.8);
    let family = |first: f64, second: f64| Ok(member(&case["system"], first, second));
    let ranges = [0.6..0.8, 0.1..0.3];
    let error = orbit::locus(family, &grazing[0], 0.2, ranges.clone()).unwrap_err();
    assert!(error.to_string().contains("no grazing"), "{error}");
    for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
        let error = orbit::locus(family, &grazing[0], bad, ranges.clone()).unwrap_err();
        assert!(matches!(error, Error::InvalidParameter { .. }), "{error}");
    }
    let refuses = |_: f64, _: f64| -> Result<Structure, Error> { Err(Error::NotFree) };
    let error = orbit::locus(refuses, &grazing[0], 0.25, ranges.clone()).unwrap_err();
    assert!(error.to_string().contains("first parameter"), "{error}");
    // A part of the rectangle that is refused ends the curve with the error.
    let half = |first: f64, second: f64| {
        if second > 0.26 {
            return Err(Error::NotFree);
        }
        family(first, second)
    };
    let locus = orbit::locus(half, &grazing[0], 0.25, ranges).unwrap();
    let lost = |end: &LocusEnd| match end {
        LocusEnd::Lost { parameters, .. } => (parameters[1] - 0.26).abs() < 1e-6,
        _ => false,
    };
    assert!(locus.ends.iter().any(lost), "{:?}", locus.ends);
}
