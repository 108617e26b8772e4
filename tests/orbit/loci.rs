//! Curves of bifurcations in two parameters, known to 25 digits.

use approx::assert_abs_diff_eq;
use std::ops::Range;

use serde_json::Value;
use stick_slip::orbit::{
    self, Bifurcation, BifurcationKind, Locus, LocusEnd, LocusKind, LocusPoint, Orbit, Period,
    SpecialKind, follow, settle, shoot,
};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, Error, ForceElement, PolynomialSpring, Structure};

use crate::common::orbit::last_turn;
use crate::common::{assert_met, count, larger, list, number, one_mass, some, text};
use crate::reading::{cases, remembering, structure};

/// A reference curve.
pub(crate) fn curve(id: &str) -> Value {
    let cases = cases(include_str!("../data/loci.json"));
    cases
        .into_iter()
        .find(|case| text(&case["id"]) == id)
        .unwrap()
}

/// A system of a reference curve.
pub(crate) fn member(system: &Value, first: f64, second: f64) -> Structure {
    let mut system = system.clone();
    put(&mut system, [first, second]);
    let dwells = |contact: &Value| contact.get("dwell").is_some();
    if list(&system["contacts"]).iter().any(dwells) {
        remembering(&system)
    } else {
        structure(&system, f64::NAN)
    }
}

/// Puts numbers in place of the names of the parameters.
fn put(value: &mut Value, parameters: [f64; 2]) {
    match value {
        Value::String(text) => {
            for (name, number) in [("PARAM1", parameters[0]), ("PARAM2", parameters[1])] {
                if text == name {
                    *text = number.to_string();
                } else if text.strip_prefix("-1*") == Some(name) {
                    *text = (-number).to_string();
                }
            }
        }
        Value::Array(items) => items.iter_mut().for_each(|item| put(item, parameters)),
        Value::Object(fields) => fields.values_mut().for_each(|item| put(item, parameters)),
        _ => {}
    }
}

/// Error promised for parameters, in units of max(1, |value|).
const ACCURACY: f64 = 1e-12;

/// A bifurcation of a kind over the first parameter, from a motion there.
fn bifurcation(
    case: &Value,
    kind: BifurcationKind,
    second: f64,
    (start, motion): (f64, &Orbit<State>),
    range: Range<f64>,
) -> Vec<Bifurcation<State>> {
    let family = |first: f64| Ok(member(&case["system"], first, second));
    let branch = follow(family, start, motion, range).unwrap();
    let mut found = branch.bifurcations;
    found.retain(|found| found.kind == kind);
    found
}

pub(crate) fn parameters(point: &Value) -> [f64; 2] {
    ["PARAM1", "PARAM2"].map(|name| number(&point[name]))
}

/// Follows the curve up to points of the reference, at each of which one parameter is a side of the
/// rectangle, in a usual run to two of them; returns the largest error.
pub(crate) fn compare(
    case: &Value,
    points: &[Value],
    which: usize,
    (at, second): (&Bifurcation<State>, f64),
    ranges: &[Range<f64>; 2],
) -> f64 {
    let family = |first: f64, second: f64| Ok(member(&case["system"], first, second));
    let begins = [at.parameter, second][which];
    let mut worst: f64 = 0.0;
    let every = points.len().div_ceil(count(2, points.len()));
    for point in points.iter().step_by(every) {
        let expected = parameters(point);
        let mut ranges = ranges.clone();
        if expected[which] < begins {
            ranges[which].start = expected[which];
        } else {
            ranges[which].end = expected[which];
        }
        let locus = orbit::locus(family, at, second, ranges).unwrap();
        // The curve may meet this side at both of its ends.
        let away =
            |point: &&LocusPoint<State>| (point.parameters[1 - which] - expected[1 - which]).abs();
        let at_side = locus.points.iter();
        let at_side = at_side.filter(|point| point.parameters[which] == expected[which]);
        let there = at_side.min_by(|a, b| away(a).total_cmp(&away(b)));
        let there = there.unwrap_or_else(|| panic!("{expected:?}: {:?}", locus.ends));
        let errors = [
            (there.parameters[1 - which], expected[1 - which]),
            (there.orbit.period(), number(&point["period"])),
        ];
        for (found, expected) in errors {
            worst = larger(worst, (found - expected).abs() / expected.abs().max(1.0));
        }
    }
    worst
}

/// The special points of a curve, each with its parameters.
fn special(locus: &Locus<State>) -> Vec<(SpecialKind, [f64; 2])> {
    let special = locus.special.iter();
    special
        .map(|point| (point.kind, point.parameters))
        .collect()
}

/// A special point of a kind has the parameters and the period of the reference.
pub(crate) fn has_special(locus: &Locus<State>, kind: SpecialKind, known: &Value, accuracy: f64) {
    let found = locus.special.iter().find(|point| point.kind == kind);
    let found = found.unwrap_or_else(|| panic!("{kind}: {:?}", special(locus)));
    let expected = parameters(known)
        .into_iter()
        .chain([number(&known["period"])]);
    let numbers = found.parameters.into_iter().chain([found.orbit.period()]);
    for (found, expected) in numbers.zip(expected) {
        assert_met(&kind.to_string(), found, expected, accuracy);
    }
}

#[test]
fn flips_of_forced_stick_slip() {
    let case = curve("flc");
    let system = member(&case["system"], 0.78, 0.3);
    let start = State::new(&[0.3], &[0.0]);
    let motion = settle(&system, &start, 400.0, Period::Driven(1)).unwrap();
    let flips = bifurcation(&case, BifurcationKind::Flip, 0.3, (0.78, &motion), 0.7..0.8);
    let worst = compare(
        &case,
        list(&case["points"]),
        0,
        (&flips[0], 0.3),
        &[0.64..0.82, 0.1..0.7],
    );
    assert!(worst < ACCURACY, "{worst:e}");
}

#[test]
fn folds_of_stick_slip_with_dwell() {
    let case = curve("dwf");
    let (v_b, theta) = (0.15, 1.5);
    let system = member(&case["system"], v_b, theta);
    let motion = system.simulate(State::new(&[-0.6], &[0.0]), 300.0).unwrap();
    let period = Period::Free(last_turn(&motion));
    let motion = settle(&system, &motion.last(), 0.0, period).unwrap();
    let folds = bifurcation(
        &case,
        BifurcationKind::Fold,
        theta,
        (v_b, &motion),
        0.1..0.4,
    );
    let worst = compare(
        &case,
        list(&case["points"]),
        1,
        (&folds[0], theta),
        &[0.05..0.6, 0.3..4.0],
    );
    assert!(worst < ACCURACY, "{worst:e}");
}

#[test]
fn tori_of_a_forced_pure_slip_motion() {
    let case = curve("vdp_ns");
    let tori = |[first, second]: [f64; 2], range: Range<f64>| {
        let system = member(&case["system"], first, second);
        let start = State::new(&[0.1], &[0.0]);
        let motion = settle(&system, &start, 400.0, Period::Driven(1)).unwrap();
        let kind = BifurcationKind::NeimarkSacker;
        bifurcation(&case, kind, second, (first, &motion), range).remove(0)
    };
    let torus = tori([1.0, 0.05], 1.0..1.3);
    let ranges = [0.99..1.8, 0.001..0.4];
    let worst = compare(&case, list(&case["points"]), 0, (&torus, 0.05), &ranges);
    assert!(worst < ACCURACY, "{worst:e}");
    // From the 1:1 resonance to a tongue of doubled motions, and from there on.
    let family = |first: f64, second: f64| Ok(member(&case["system"], first, second));
    let below = orbit::locus(family, &torus, 0.05, [0.99..2.5, 0.001..0.6]).unwrap();
    assert_eq!(below.ends, [LocusEnd::Special, LocusEnd::Special]);
    let above = tori([2.2, 0.45], 2.1..2.6);
    let above = orbit::locus(family, &above, 0.45, [0.99..2.5, 0.001..0.6]).unwrap();
    assert_eq!(above.ends, [LocusEnd::Special, LocusEnd::Ranges]);
    assert_eq!(special(&below).len() + special(&above).len(), 5);
    for known in list(&case["codimension_two"]) {
        let order = text(&known["kind"]).strip_prefix("resonance_1_").unwrap();
        let kind = SpecialKind::Resonance(order.parse().unwrap());
        let locus = if order == "2" { &above } else { &below };
        has_special(locus, kind, known, ACCURACY);
    }
    // In between multipliers lie on the unit circle.
    for point in &below.points {
        let product: f64 = point.orbit.multipliers().iter().map(|m| m.norm()).product();
        assert_abs_diff_eq!(product, 1.0, epsilon = 1e-10);
    }
}

#[test]
fn folds_of_a_forced_pure_slip_motion() {
    let case = curve("vdp_fold");
    let points = list(&case["points"]);
    let system = member(&case["system"], 1.0, 0.00635);
    let start = State::new(&[0.1], &[0.0]);
    let motion = settle(&system, &start, 2000.0, Period::Driven(1)).unwrap();
    let kind = BifurcationKind::Fold;
    // On the two branches that meet at the cusp.
    let folds = bifurcation(&case, kind, 0.00635, (1.0, &motion), 0.99..1.02);
    let [lower, upper] = &folds[..] else { panic!() };
    let (lower, upper) = if lower.parameter < upper.parameter {
        (lower, upper)
    } else {
        (upper, lower)
    };
    let ranges = [0.99..1.01, 1e-4..0.01];
    let mut worst = compare(&case, &points[3..], 1, (upper, 0.00635), &ranges);
    worst = larger(
        worst,
        compare(&case, &points[..2], 1, (lower, 0.00635), &ranges),
    );
    assert!(worst < ACCURACY, "{worst:e}");
    let family = |first: f64, second: f64| Ok(member(&case["system"], first, second));
    for fold in [lower, upper] {
        let locus = orbit::locus(family, fold, 0.00635, ranges.clone()).unwrap();
        assert_eq!(locus.kind, LocusKind::Fold);
        assert_eq!(special(&locus).len(), 2);
        let [cusp, resonance] = [0, 1].map(|i| &list(&case["codimension_two"])[i]);
        has_special(&locus, SpecialKind::Cusp, cusp, 1e-10);
        has_special(&locus, SpecialKind::Resonance(1), resonance, ACCURACY);
    }
}

#[test]
fn folds_of_cycles_on_a_belt() {
    let case = curve("bel_fold");
    let points = list(&case["points"]);
    let near = &points[4];
    let [v_b, damping] = parameters(near);
    let neighbour = &near["neighbours"][0];
    let damping = damping * (1.0 + neighbour["change"].as_f64().unwrap());
    let system = member(&case["system"], v_b, damping);
    let q = neighbour["cycles"][0]["q"].as_f64().unwrap();
    let guess = State::new(&[q], &[0.0]);
    let motion = shoot(&system, &guess, Period::Free(number(&near["period"]))).unwrap();
    let kind = BifurcationKind::Fold;
    let folds = bifurcation(&case, kind, damping, (v_b, &motion), 0.5..0.9);
    let ranges = [0.5..1.3, 0.03..0.2];
    let worst = compare(&case, points, 0, (&folds[0], damping), &ranges);
    assert!(worst < ACCURACY, "{worst:e}");
    // From the Bautin point of the Hopf curve to where the cycle touches the belt.
    let family = |first: f64, second: f64| Ok(member(&case["system"], first, second));
    let locus = orbit::locus(family, &folds[0], damping, ranges).unwrap();
    let hopf_curve = curve("hbe");
    let bautin = &list(&hopf_curve["codimension_two"])[0];
    let near = |found: [f64; 2], known: &Value, accuracy: f64| {
        let pairs = std::iter::zip(found, parameters(known));
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, larger) < accuracy
    };
    let hopf = locus.ends.iter().find_map(|end| match end {
        LocusEnd::Hopf { parameters } => Some(*parameters),
        _ => None,
    });
    assert!(near(hopf.unwrap(), bautin, 1e-8), "{hopf:?}");
    let jumps = locus.ends.iter().position(|end| *end == LocusEnd::Jump);
    let last = [0, locus.points.len() - 1][jumps.unwrap()];
    let grazing = &list(&case["codimension_two"])[0];
    assert!(near(locus.points[last].parameters, grazing, 1e-8));
    has_special(&locus, SpecialKind::FoldGrazing, grazing, ACCURACY);
}

#[test]
fn what_is_no_curve_is_refused() {
    let case = curve("flc");
    let system = member(&case["system"], 0.78, 0.3);
    let start = State::new(&[0.3], &[0.0]);
    let motion = settle(&system, &start, 400.0, Period::Driven(1)).unwrap();
    let family = |first: f64, second: f64| Ok(member(&case["system"], first, second));
    let flips = bifurcation(&case, BifurcationKind::Flip, 0.3, (0.78, &motion), 0.7..0.8);
    let flip = &flips[0];
    for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
        for ranges in [[0.7..bad, 0.2..0.4], [0.7..0.8, bad..0.4]] {
            let error = orbit::locus(family, flip, 0.3, ranges).unwrap_err();
            assert!(matches!(error, Error::InvalidParameter { .. }), "{error}");
        }
        let error = orbit::locus(family, flip, bad, [0.7..0.8, 0.2..0.4]).unwrap_err();
        assert!(matches!(error, Error::InvalidParameter { .. }), "{error}");
    }
    // Outside the rectangle.
    assert!(orbit::locus(family, flip, 0.5, [0.7..0.8, 0.2..0.4]).is_err());
    // A family that refuses a part of the rectangle ends the curve with its error.
    let half = |first: f64, second: f64| {
        if second > 0.31 {
            return Err(Error::NotFree);
        }
        family(first, second)
    };
    let locus = orbit::locus(half, flip, 0.3, [0.7..0.8, 0.2..0.4]).unwrap();
    let lost = |end: &LocusEnd| match end {
        LocusEnd::Lost { parameters, error } => {
            (parameters[1] - 0.31).abs() < 1e-6 && error.to_string().contains("drive")
        }
        _ => false,
    };
    assert!(locus.ends.iter().any(lost), "{:?}", locus.ends);
    // A range without width in the other parameter's direction ends at once, at both sides.
    let locus = orbit::locus(family, flip, 0.3, [0.7..0.8, 0.3..0.4]).unwrap();
    assert!(locus.ends.iter().all(|end| *end == LocusEnd::Ranges));
}

/// The symmetric motion with two stops a period: the multiplier of its half period is −1.
#[test]
fn pitchforks_of_symmetric_stick_slip() {
    let case = curve("pit");
    let points = list(&case["points"]);
    let second = 0.9;
    let system = member(&case["system"], 0.36, second);
    let motion = settle(&system, &State::at_rest(1), 400.0, Period::Driven(1)).unwrap();
    let kind = BifurcationKind::Pitchfork;
    let found = bifurcation(&case, kind, second, (0.36, &motion), 0.36..0.375);
    let ranges = [0.3..0.65, 0.4..1.2];
    let worst = compare(&case, points, 0, (&found[0], second), &ranges);
    println!("{worst:.1e}");
    assert!(worst < ACCURACY, "{worst:e}");
    let family = |first: f64, second: f64| Ok(member(&case["system"], first, second));
    let locus = orbit::locus(family, &found[0], second, ranges).unwrap();
    println!("{:?} {:?}", special(&locus), locus.ends);
    assert_eq!(locus.kind, LocusKind::Pitchfork);
    for point in &locus.points {
        assert!(point.orbit.is_symmetric());
        let multiplier = point.orbit.multipliers()[0];
        assert!((multiplier - 1.0).norm() < 1e-10, "{multiplier}");
    }
}

/// A constant force that follows the parameters moves the centre of the motion, and nothing else;
/// pitchforks found by `follow` at other values of the second parameter lie on the curve.
#[test]
fn a_centre_that_moves_does_not_change_pitchforks() {
    let case = curve("pit");
    let [first, second] = parameters(&list(&case["points"])[1]);
    let family = |frequency: f64, stiffness: f64| {
        let force =
            Drive::harmonic(second, frequency, 0.0)?.with_constant(2.0 * frequency - 0.3)?;
        let contact = Contact::new(0, Coulomb::new(0.6, 0.3)?, 0.6)?;
        one_mass([1.0, 0.02, stiffness], force, contact)
    };
    let at = |stiffness: f64, around: f64| {
        let family = |frequency: f64| family(frequency, stiffness);
        let begin = 0.99 * around;
        let system = family(begin).unwrap();
        let motion = settle(&system, &State::at_rest(1), 400.0, Period::Driven(1)).unwrap();
        let branch = follow(family, begin, &motion, 0.98 * around..1.02 * around).unwrap();
        let mut found = branch.bifurcations;
        found.retain(|found| found.kind == BifurcationKind::Pitchfork);
        found.remove(0)
    };
    let pitchfork = at(1.0, first);
    let error = (pitchfork.parameter - first).abs();
    assert!(error < 1e-12, "{error:e}");
    for stiffness in [0.97_f64, 1.04] {
        let ranges = [0.3..0.5, stiffness.min(1.0)..stiffness.max(1.0)];
        let locus = orbit::locus(family, &pitchfork, 1.0, ranges).unwrap();
        let mut ends = locus.points.iter();
        let end = ends.find(|point| point.parameters[1] == stiffness);
        let end = end.unwrap_or_else(|| panic!("{:?}", locus.ends));
        let known = at(stiffness, end.parameters[0]);
        let error = (end.parameters[0] - known.parameter).abs();
        assert!(error < 1e-11, "{stiffness}: {error:e}");
    }
}

/// The force of an elastic contact that slips where the motions start is its limit, and changes
/// with it. The curve over the limit does not depend on where they start, and its folds are those
/// of `follow`.
#[test]
fn folds_do_not_depend_on_what_modes_impose_on_the_start() {
    let shifted = |limit: f64, frequency: f64, phase: f64| {
        let hardening = PolynomialSpring::new(&[0.0, 0.0, 0.3])?;
        let slider = Contact::new(0, Coulomb::new(1.0, 1.0)?, limit)?;
        let force = Drive::harmonic(0.6, frequency, phase)?;
        one_mass(
            [1.0, 0.03, 1.0],
            force,
            slider.with_tangential_stiffness(0.5)?,
        )?
        .with_element(ForceElement::new(0, hardening)?)
    };
    let ranges = [0.6..3.0, 0.17..0.23];
    let folds = |limit: f64, phase: f64| {
        let family = |frequency: f64| shifted(limit, frequency, phase);
        let system = family(0.8).unwrap();
        let motion = settle(&system, &State::at_rest(1), 400.0, Period::Driven(1)).unwrap();
        let branch = follow(family, 0.8, &motion, ranges[0].clone()).unwrap();
        let mut found = branch.bifurcations;
        found.retain(|found| found.kind == BifurcationKind::Fold);
        <[Bifurcation<State>; 2]>::try_from(found).unwrap()
    };
    let sides = [ranges[1].start, ranges[1].end];
    let known = sides.map(|limit| folds(limit, 0.0).map(|fold| fold.parameter));
    for phase in some(2, [0.0, 0.9, 1.8, 2.7]) {
        let family = |frequency: f64, limit: f64| shifted(limit, frequency, phase);
        for (i, fold) in folds(0.2, phase).iter().enumerate() {
            let locus = orbit::locus(family, fold, 0.2, ranges.clone()).unwrap();
            assert_eq!(locus.ends, [LocusEnd::Ranges, LocusEnd::Ranges]);
            for (side, known) in sides.into_iter().zip(known) {
                let mut ends = locus.points.iter();
                let end = ends.find(|point| point.parameters[1] == side).unwrap();
                let off = end.parameters[0] - known[i];
                assert!(off.abs() < 1e-11, "{phase} {side}: {off:e}");
            }
        }
    }
}

/// Beside a force element, which has a centre of its own, the rounding error of a drive that
/// returns with the other sign moves no centre: pitchforks do not depend on the phase of the drive.
#[test]
fn pitchforks_do_not_depend_on_the_phase() {
    let pitchforks = |phase: f64| {
        let family = |frequency: f64, limit: f64| {
            let hardening = PolynomialSpring::new(&[0.0, 0.0, 0.26])?;
            let slider = Contact::new(0, Coulomb::new(1.0, 1.0)?, limit)?;
            let slider = slider.with_tangential_stiffness(0.75)?;
            let force = Drive::harmonic(0.86, frequency, phase)?;
            one_mass([1.19, 0.021, 0.875], force, slider)?
                .with_element(ForceElement::new(0, hardening)?)
        };
        let system = family(0.6, 0.26).unwrap();
        let motion = settle(&system, &State::at_rest(1), 400.0, Period::Driven(1)).unwrap();
        let branch = follow(|first| family(first, 0.26), 0.6, &motion, 0.5..0.6).unwrap();
        let found = branch.bifurcations.iter();
        let found = found.map(|found| {
            assert_eq!(found.kind, BifurcationKind::Pitchfork, "{phase}");
            let ranges = [0.5..0.6, 0.25..0.27];
            let locus = orbit::locus(family, found, 0.26, ranges).unwrap();
            assert_eq!(locus.kind, LocusKind::Pitchfork);
            assert_eq!(locus.ends, [LocusEnd::Ranges, LocusEnd::Ranges]);
            found.parameter
        });
        let mut found: Vec<f64> = found.collect();
        found.sort_by(f64::total_cmp);
        found
    };
    let known = pitchforks(0.0);
    assert_eq!(known.len(), 2);
    for phase in some(2, [5.186772240635667, 0.3, 1.1, 2.9]) {
        let found = pitchforks(phase);
        assert_eq!(found.len(), 2);
        for (found, known) in found.iter().zip(&known) {
            assert!((found - known).abs() < 1e-11, "{phase}");
        }
    }
}

/// Near a touch that falls onto another event steps become ever shorter: the curve ends soon, and
/// says so.
#[test]
fn a_curve_that_crawls_ends() {
    let family = crate::common::masses::driven;
    let system = family(0.6, 0.3).unwrap();
    let start = State::new(&[0.3], &[0.0]);
    let motion = settle(&system, &start, 400.0, Period::Driven(1)).unwrap();
    let branch = follow(|frequency| family(frequency, 0.3), 0.6, &motion, 0.6..0.8).unwrap();
    let mut found = branch.bifurcations.iter();
    let flip = found.find(|found| found.kind == BifurcationKind::Flip);
    let flip = flip.unwrap_or_else(|| panic!("{branch:?}"));
    let locus = orbit::locus(family, flip, 0.3, [0.2..2.0, 0.01..1.5]).unwrap();
    let [LocusEnd::Crawls { parameters }, LocusEnd::Jump] = locus.ends[..] else {
        panic!("{:?}", locus.ends)
    };
    assert_eq!(parameters, locus.points[0].parameters);
    assert!(locus.points.len() < 400, "{}", locus.points.len());
}
