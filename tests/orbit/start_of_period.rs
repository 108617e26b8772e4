//! Changes of events at the start of the period of the drives: they are those of the same system
//! with a later start.

use std::f64::consts::{FRAC_PI_2, TAU};

use stick_slip::orbit::{
    self, Bifurcation, BifurcationKind, Branch, BranchEnd, LocusEnd, LocusKind, Period, follow,
    settle,
};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, Error, Structure};

use crate::common::some;

/// Distances of the change from the start, in periods: exactly there, within rounding on either
/// side, near, and far away.
const DISTANCES: [f64; 9] = [0.0, 1e-11, -1e-11, 1e-9, -1e-9, 1e-8, -1e-8, 1e-3, 0.3];

const BELT: f64 = 0.35;

/// A mass on a belt under a force, over its amplitude and the damping. The sliding speed of its
/// pure slip has a minimum at a part of the period, at one damping.
struct Touch {
    frequency: f64,
    damping: f64,
    /// Static and kinetic coefficients.
    limits: [f64; 2],
    part: f64,
}

impl Touch {
    fn at(&self, force: f64, damping: f64) -> Result<Structure, Error> {
        let behind = f64::atan2(self.damping * self.frequency, 1.0 - self.frequency.powi(2));
        let phase = behind - FRAC_PI_2 - self.part * TAU;
        let [limit, kinetic] = self.limits;
        Structure::new(&[1.0])?
            .with_ground_spring(0, 1.0)?
            .with_ground_damper(0, damping)?
            .with_force(0, Drive::harmonic(force, self.frequency, phase)?)?
            .with_contact(Contact::new(0, Coulomb::new(limit, kinetic)?, 1.0)?.on_belt(BELT))
    }

    /// The force at which the speed of the mass reaches that of the belt.
    fn known(&self, damping: f64) -> f64 {
        let detuning = 1.0 - self.frequency.powi(2);
        BELT * detuning.hypot(damping * self.frequency) / self.frequency
    }

    fn branch(&self) -> Branch<State> {
        let family = |force: f64| self.at(force, self.damping);
        let known = self.known(self.damping);
        let first = family(0.8 * known).unwrap();
        let motion = settle(&first, &State::at_rest(1), 900.0, Period::Driven(1)).unwrap();
        follow(family, 0.8 * known, &motion, 0.7 * known..1.2 * known).unwrap()
    }
}

#[test]
fn a_touch_may_be_there() {
    for (frequency, damping) in [(0.6, 0.06), (1.3, 0.1), (2.2, 0.1)] {
        for part in DISTANCES {
            let touch = Touch {
                frequency,
                damping,
                limits: [0.4, 0.4],
                part,
            };
            let branch = touch.branch();
            let [found] = &branch.bifurcations[..] else {
                panic!("{frequency}, {part:e}: {:?}", branch.bifurcations.len());
            };
            assert_eq!(
                found.kind,
                BifurcationKind::Grazing,
                "{frequency}, {part:e}"
            );
            let known = touch.known(damping);
            let error = found.parameter / known - 1.0;
            assert!(error.abs() < 1e-11, "{frequency}, {part:e}: {error:e}");
            let ranges = [0.7 * known..1.3 * known, 0.5 * damping..1.5 * damping];
            let family = |force: f64, damping: f64| touch.at(force, damping);
            let locus = orbit::locus(family, found, damping, ranges).unwrap();
            assert_eq!(locus.kind, LocusKind::Grazing { contact: 0 });
            assert_eq!(locus.ends, [LocusEnd::Ranges, LocusEnd::Ranges]);
            for point in &locus.points {
                let [force, damping] = point.parameters;
                let error = force - touch.known(damping);
                assert!(error.abs() < 1e-13, "{frequency}, {part:e}: {error:e}");
            }
        }
    }
}

/// With a larger static friction the motion jumps at the touch.
#[test]
fn a_jump_may_be_there() {
    for (frequency, damping) in [(0.6, 0.06), (1.3, 0.1), (2.2, 0.1)] {
        for part in DISTANCES {
            let touch = Touch {
                frequency,
                damping,
                limits: [0.5, 0.3],
                part,
            };
            let branch = touch.branch();
            let BranchEnd::Discontinuity {
                parameter, contact, ..
            } = branch.ends[1]
            else {
                panic!("{frequency}, {part:e}: {:?}", branch.ends[1]);
            };
            let error = parameter / touch.known(damping) - 1.0;
            assert!(error.abs() < 1e-11, "{frequency}, {part:e}: {error:e}");
            assert_eq!(contact, 0);
        }
    }
}

/// The changes of one kind of a branch over the first parameter, and the curve from each, up to
/// some of its points.
#[track_caller]
fn same_curves(
    kind: BifurcationKind,
    family: impl Fn(f64, [f64; 2]) -> Result<Structure, Error>,
    [first, second]: [f64; 2],
    ranges: &[std::ops::Range<f64>; 2],
) {
    let of = |phase: f64| {
        let family = |first: f64| family(phase, [first, second]);
        let start = State::at_rest(family(first).unwrap().len());
        let motion = settle(&family(first).unwrap(), &start, 900.0, Period::Driven(1)).unwrap();
        let branch = follow(family, first, &motion, ranges[0].clone()).unwrap();
        let found = branch.bifurcations.into_iter();
        found.filter(|found| found.kind == kind).collect::<Vec<_>>()
    };
    let locus = |phase: f64, at: &Bifurcation<State>| {
        let family = |first: f64, second: f64| family(phase, [first, second]);
        let search = orbit::Search::new().with_max_points(20).unwrap();
        search.locus(family, at, second, ranges.clone()).unwrap()
    };
    let expected = of(0.0);
    let known = &expected[0];
    let curve = locus(0.0, known);
    let period = known.orbit.period();
    for event in known.orbit.events() {
        for part in some(4, DISTANCES) {
            let phase = TAU * (event.time / period - part);
            let found = of(phase);
            assert_eq!(found.len(), expected.len(), "{} {part:e}", event.time);
            let error = found[0].parameter - known.parameter;
            assert!(error.abs() < 1e-9, "{} {part:e}: {error:e}", event.time);
            let other = locus(phase, &found[0]);
            assert_eq!(other.kind, curve.kind, "{} {part:e}", event.time);
            println!("{:?} {} {part:e} {error:e}", curve.kind, event.time);
        }
    }
}

/// Events of two contacts at one time, which begin and end the period.
#[test]
fn events_may_change_their_order_there() {
    let pair = |shift: f64, [phase, amplitude]: [f64; 2]| {
        let contact = |i: usize| Contact::new(i, Coulomb::new(0.5, 0.3)?, 1.5);
        Structure::new(&[1.0, 1.0])?
            .with_ground_spring(0, 1.0)?
            .with_ground_spring(1, 1.3)?
            .with_ground_damper(0, 0.2)?
            .with_ground_damper(1, 0.2)?
            .with_spring(0, 1, 0.05)?
            .with_contact(contact(0)?.on_belt(0.1))?
            .with_contact(contact(1)?.on_belt(0.1))?
            .with_force(0, Drive::harmonic(amplitude, 0.78, shift)?)?
            .with_force(1, Drive::harmonic(0.4, 0.78, phase + shift)?)
    };
    same_curves(
        BifurcationKind::Sequence,
        pair,
        [0.0, 0.4],
        &[-1.5..1.5, 0.3..0.5],
    );
}

/// Stops of Den Hartog's oscillator begin at its turning points.
#[test]
fn stops_may_begin_there() {
    let family = |shift: f64, [frequency, friction]: [f64; 2]| {
        Structure::new(&[1.0])?
            .with_ground_spring(0, 1.0)?
            .with_ground_damper(0, 0.1)?
            .with_force(0, Drive::harmonic(1.0, frequency, shift)?)?
            .with_contact(Contact::new(0, Coulomb::new(friction, friction)?, 1.0)?)
    };
    same_curves(
        BifurcationKind::Sequence,
        family,
        [0.7, 0.5],
        &[0.55..0.75, 0.05..0.9],
    );
}
