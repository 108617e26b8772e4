//! What motions settle to: against the complete search of one mass, against known motions, and
//! sweeps with hysteresis.

use approx::assert_abs_diff_eq;
use std::ops::ControlFlow::{Break, Continue};

use stick_slip::limit_cycle::{self, Attractor as Planar};
use stick_slip::orbit::{
    AttractorKind, Change, Period, Search, classify, settle, sweep, vibration_ranges,
};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, CycleKind, Drive, Dwell, Error, EventKind, Exponential, MassOnBelt, Rational,
    Stribeck, Structure, bifurcation,
};

use crate::common::{Random, exactly, one_mass, oscillator, paper, refused, text};
use crate::reading::structure;
use crate::references::{all, period, remembers, start};

/// Planar motions cannot hide: the attractor of each start is known.
#[test]
fn belts_settle_to_what_the_complete_search_says() {
    use AttractorKind::{PureSlip, Rest, SteadySliding, StickSlip};
    let mut random = Random::new(5);
    let mut counts = std::collections::BTreeMap::new();
    for i in 0..120 {
        let system = random.system();
        let system = if i % 8 == 0 {
            system.with_belt_velocity(0.0).unwrap()
        } else {
            system
        };
        let begin = (random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
        let about = format!("{i}: {system:?} {begin:?}");
        let expected = limit_cycle::attractor(&system, begin).unwrap();
        let found = classify(&system, &begin.into()).unwrap_or_else(|e| panic!("{about}: {e}"));
        let (kind, cycle) = match &expected {
            Planar::Rest => (Rest, None),
            Planar::Equilibrium => (SteadySliding, None),
            Planar::Cycle(cycle) => match cycle.kind() {
                CycleKind::PureSlip | CycleKind::Crossing => (PureSlip, Some(cycle)),
                CycleKind::StickSlip | CycleKind::Overshoot => (StickSlip, Some(cycle)),
            },
            _ => continue,
        };
        assert_eq!(found.kind(), kind, "{about}");
        *counts.entry(kind).or_insert(0) += 1;
        if let Some(cycle) = cycle {
            let orbit = found.orbit().unwrap();
            // The period, or a multiple that was seen first.
            let times = orbit.period() / cycle.period();
            assert!((times - times.round()).abs() < 1e-10, "{about}: {times}");
            assert!(
                (orbit.amplitude(0) - cycle.amplitude()).abs() < 1e-10,
                "{about}"
            );
            assert!(orbit.is_stable());
        }
    }
    println!("{counts:?}");
    assert!(
        counts[&Rest] > 5 && counts[&SteadySliding] > 20 && counts[&StickSlip] > 20,
        "{counts:?}"
    );
}

/// Stable motions of the reference data, started beside them.
#[test]
fn reference_orbits_are_found_from_beside_them() {
    let mut compared = 0;
    for case in all() {
        if remembers(&case) {
            continue;
        }
        let id = text(&case["id"]);
        let contacts = case["system"]["contacts"].as_array().unwrap().len();
        let system = structure(&case["system"], f64::NAN);
        let known = stick_slip::orbit::shoot(&system, &start(&case, contacts), period(&case));
        let known = known.unwrap();
        let slow = known.multipliers()[0].norm() > 0.99;
        if slow {
            continue;
        }
        let mut begin = known.state();
        begin.displacements[0] += 1e-3;
        let found = classify(&system, &begin).unwrap();
        let orbit = found.orbit().unwrap_or_else(|| panic!("{id}: {found:?}"));
        let times = orbit.period() / known.period();
        assert!((times - times.round()).abs() < 1e-9, "{id}: {times}");
        for i in 0..system.len() {
            let apart = orbit.amplitude(i) - known.amplitude(i);
            assert!(apart.abs() < 1e-9, "{id}: {apart}");
        }
        compared += 1;
    }
    assert!(compared > 6, "{compared}");
}

#[test]
fn chaos_rest_and_what_is_held() {
    // K. Popp, P. Stelter 1990: chaotic by its exponent (long_run.rs).
    let law = Rational::new(0.3, 1.42)
        .and_then(|law| law.with_offset(0.1)?.with_quadratic(0.01))
        .unwrap();
    let forced = |force: f64| {
        let force = Drive::harmonic(force, 0.75, 0.0)?;
        let contact = Contact::new(0, law, 1.0)?.on_belt(0.2);
        one_mass([1.0, 0.0, 1.0], force, contact)
    };
    let chaotic = classify(&forced(0.1).unwrap(), &State::at_rest(1)).unwrap();
    assert_eq!(chaotic.kind(), AttractorKind::Irregular);
    assert!(chaotic.orbit().is_none());
    let block = |force: f64| {
        let force = Drive::sine(force, 1.3)?;
        let contact = Contact::new(0, Coulomb::new(0.4, 0.3)?, 1.0)?;
        one_mass([1.0, 0.1, 1.0], force, contact)
    };
    let kind = |system: Structure, begin: State| classify(&system, &begin).unwrap().kind();
    let begin = || State::new(&[0.3], &[0.2]);
    assert_eq!(kind(block(0.05).unwrap(), begin()), AttractorKind::Rest);
    assert_eq!(kind(block(0.38).unwrap(), begin()), AttractorKind::Rest);
    for force in [0.5, 0.6, 1.0, 5.0] {
        let late = block(force).unwrap().simulate(begin(), 500.0).unwrap();
        let mut late = late.events().iter().filter(|event| event.time > 400.0);
        let expected = if late.any(|event| event.kind == EventKind::Stick) {
            AttractorKind::StickSlip
        } else {
            AttractorKind::PureSlip
        };
        assert_eq!(kind(block(force).unwrap(), begin()), expected, "{force}");
    }
    // No friction that varies, no damping: every motion is periodic, none attracts.
    let contact = Contact::new(0, Coulomb::new(0.3, 0.3).unwrap(), 1.0)
        .unwrap()
        .on_belt(1.0);
    let level = one_mass([1.0, 0.0, 1.0], 0.0, contact).unwrap();
    let found = classify(&level, &State::new(&[0.3], &[0.5])).unwrap();
    assert_eq!(found.kind(), AttractorKind::PureSlip);
    assert_abs_diff_eq!(found.orbit().unwrap().amplitude(0), 0.5, epsilon = 1e-12);
    // Drives without a common period.
    let ramp = block(0.5)
        .unwrap()
        .with_force(0, Drive::profile(&[(0.0, 0.0), (1.0, 1.0)]).unwrap());
    let found = classify(&ramp.unwrap(), &begin()).map(drop);
    assert_eq!(found, Err(Error::NoCommonPeriod));
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let found = classify(&block(0.5).unwrap(), &State::new(&[bad], &[0.0]));
        refused!(found => Error::InvalidState { .. });
    }
}

/// Hardly anything moves so heavy a mass: a step is longer than 10⁹ periods of the force.
#[test]
fn a_step_may_be_longer_than_any_number_of_periods() {
    let heavy = oscillator([1e140, 0.0, 1.0], Drive::sine(0.4, 0.35).unwrap()).unwrap();
    let search = Search::new().with_max_steps(300).unwrap();
    let found = search.classify(&heavy, &State::new(&[0.0], &[1e140]));
    let found = found.map(|found| found.kind());
    let Err(Error::TooManySteps { limit, reached }) = &found else {
        panic!("{found:?}");
    };
    assert!(*limit == 300 && reached.time > 1e10, "{found:?}");
}

/// Steady sliding that decays by 4e-5 over a radian takes longer than the default bound.
#[test]
fn a_larger_bound_simulates_a_longer_transient() {
    let contact = Contact::new(0, Coulomb::new(0.4, 0.25).unwrap(), 1.0).unwrap();
    let system = one_mass([1.0, 4e-5, 1.0], 0.0, contact.on_belt(2.0)).unwrap();
    let start = State::new(&[0.5], &[0.0]);
    let within = |bound: usize| {
        let search = Search::new().with_max_steps(bound).unwrap();
        search.classify(&system, &start).unwrap().kind()
    };
    assert_eq!(within(Search::DEFAULT_MAX_STEPS), AttractorKind::Irregular);
    assert_eq!(
        within(8 * Search::DEFAULT_MAX_STEPS),
        AttractorKind::SteadySliding
    );
}

fn exponential(velocity: f64) -> Result<MassOnBelt<Exponential>, Error> {
    MassOnBelt::new(Exponential::new(0.6, 0.3, 0.4)?, velocity)?.with_damping(0.01)
}

/// Both ways change where the complete search has its borders.
#[test]
fn a_sweep_shows_the_hysteresis_of_a_bistable_mass() {
    let velocities: Vec<f64> = (2..=80).map(|i| 0.05 * f64::from(i)).collect();
    let found = sweep(exponential, &velocities, &(0.0, 0.0).into()).unwrap();
    assert_eq!((found.up.len(), found.down.len()), (79, 79));
    let changes: Vec<Change> = found.changes().collect();
    let ranges = bifurcation::vibration_ranges(&exponential(1.0).unwrap(), 0.1..4.0).unwrap();
    let bistable = ranges.iter().filter(|range| range.is_bistable());
    let bistable: Vec<_> = bistable.map(|range| range.velocities.clone()).collect();
    let (low, high) = (bistable[0].start, bistable[bistable.len() - 1].end);
    let inside = |change: &Change, value: f64| {
        let [a, b] = change.between;
        assert!(
            a.min(b) <= value && value <= a.max(b),
            "{change:?}, {value}"
        );
    };
    // Vibration begins at the lower border, and ends below the upper one: a step of the velocity is
    // a push, and near the border a small one is enough.
    let ends = changes
        .iter()
        .find(|change| change.to == AttractorKind::SteadySliding);
    let end = ends.unwrap().between[0];
    assert!(high - 0.2 < end && end < high, "{end} {high}");
    let begins = changes
        .iter()
        .find(|change| change.from == AttractorKind::SteadySliding);
    inside(begins.unwrap(), low);
    // The way up and the way down differ in between alone.
    for (up, down) in std::iter::zip(&found.up, found.down.iter().rev()) {
        assert_eq!(up.parameter, down.parameter);
        let differs = up.kind() != down.kind();
        let both = low <= up.parameter && up.parameter <= end;
        assert_eq!(differs, both, "{}", up.parameter);
    }
}

#[test]
fn sweeps_are_bounded_watched_and_go_on_behind_errors() {
    let values = [0.2, 0.3, 0.4];
    let start = (0.0, 0.0).into();
    for bad in [
        [0.2, 0.2, 0.3],
        [0.3, 0.2, 0.4],
        [0.2, f64::NAN, 0.4],
        [0.2, 0.3, f64::INFINITY],
    ] {
        refused!(sweep(exponential, &bad, &start) => Error::InvalidParameter { .. });
    }
    let error = sweep(exponential, &[], &start).map(drop).unwrap_err();
    assert!(error.to_string().contains("at least one value"), "{error}");
    // A family with a hole.
    let family = |velocity: f64| {
        if velocity == 0.3 {
            return Err(Error::AtRest);
        }
        exponential(velocity)
    };
    let found = sweep(family, &values, &start).unwrap();
    let Err(Error::At { value, .. }) = &found.up[1].attractor else {
        panic!("{found:?}")
    };
    assert_eq!((*value, found.up[1].kind()), (0.3, None));
    assert_eq!(found.up[2].kind(), Some(AttractorKind::StickSlip));
    // The first value has no system, for a number that its constructor refuses.
    let family = |velocity: f64| {
        Coulomb::new(velocity, 0.25)?;
        exponential(velocity)
    };
    let found = sweep(family, &values, &start).unwrap();
    let error = found.up[0].attractor.as_ref().unwrap_err();
    assert!(matches!(error, Error::At { value: 0.2, .. }), "{error}");
    assert_eq!(found.up[1].kind(), Some(AttractorKind::StickSlip));
    // Too little work for each value, and a watcher.
    let few = Search::new().with_max_steps(20).unwrap();
    let found = few.sweep(exponential, &values, &start).unwrap();
    assert_eq!(found.up.len() + found.down.len(), 6);
    let error = found.up[0].attractor.as_ref().unwrap_err();
    assert!(error.to_string().contains("20 steps"), "{error}");
    let stops = Search::new().watched(|progress| {
        if progress.points < 4 {
            Continue(())
        } else {
            Break(())
        }
    });
    let found = stops.sweep(exponential, &values, &start).unwrap();
    assert_eq!((found.up.len(), found.down.len()), (3, 1));
    assert_eq!(found.stopped, Some(0.3));
    let never = Search::new().watched(|_| Break(()));
    refused!(never.classify(&paper(0.2), &start) => Error::Stopped { .. });
}

/// A start that no system can have is no result at a value.
#[test]
fn sweeps_refuse_a_start_that_does_not_fit() {
    let law = Coulomb::new(0.4, 0.3).unwrap();
    let family = |velocity: f64| {
        if velocity == 0.1 {
            return Err(Error::AtRest);
        }
        Structure::new(&[1.0, 2.0])?
            .with_ground_spring(0, 1.0)?
            .with_spring(0, 1, 1.0)?
            .with_contact(Contact::new(0, law, 1.0)?.on_belt(velocity))
    };
    for (start, words) in [
        (State::at_rest(1), "1 given; 2 are needed"),
        (State::at_rest(3), "3 given; 2 are needed"),
        (State::new(&[0.0, f64::NAN], &[0.0, 0.0]), "NaN"),
        (State::new(&[0.0, 0.0], &[0.0, f64::INFINITY]), "inf"),
    ] {
        let error = sweep(family, &[0.1, 0.2, 0.3], &start)
            .map(drop)
            .unwrap_err();
        assert!(matches!(error, Error::At { value: 0.2, .. }), "{error}");
        assert!(error.to_string().contains(words), "{error}");
    }
    // A family that changes its size stays an error at a value.
    let changing = |velocity: f64| {
        if velocity > 0.15 {
            return family(velocity);
        }
        let contact = Contact::new(0, law, 1.0)?.on_belt(velocity);
        one_mass([1.0, 0.0, 1.0], 0.0, contact)
    };
    let found = sweep(changing, &[0.12, 0.2], &State::at_rest(1)).unwrap();
    assert!(found.up[0].attractor.is_ok() && found.up[1].attractor.is_err());
}

/// A motion that approaches its periodic motion from alternating sides is nearest to itself after
/// two periods; the attractor has one.
#[test]
fn a_motion_is_found_over_its_own_period() {
    let law = Stribeck::new(0.6, 0.518, 0.39, 1)
        .and_then(|law| law.with_viscous_coefficient(0.02))
        .unwrap();
    let (frequency, mass) = (2.1723346550697147, 1.4541912021794672);
    let load = Drive::constant(1.0188)
        .with_harmonic(0.5094, frequency, 1.0)
        .unwrap();
    let force = Drive::harmonic(0.604, frequency, 0.6485).unwrap();
    let contact = Contact::new(0, law, load)
        .unwrap()
        .on_belt(0.34421046638054836);
    let forced = one_mass(
        [mass, 0.2377471473980021, 1.4817921323783971],
        force,
        contact,
    )
    .unwrap();
    let one = settle(&forced, &State::at_rest(1), 400.0, Period::Driven(1)).unwrap();
    assert!(one.multipliers()[0].re < -0.7, "{one:?}");
    for i in 0..8 {
        let start = State::new(&[0.5 * f64::from(i) - 2.0], &[0.3]);
        let found = classify(&forced, &start).unwrap();
        let found = found.orbit().unwrap();
        assert_eq!(found.kind(), Period::Driven(1), "{start:?}");
        let apart = found.multipliers()[0] - one.multipliers()[0];
        assert!(apart.norm() < 1e-11, "{start:?}: {apart}");
    }
    // Free motions: the two blocks of the page of `classify`.
    for belt in [0.34, 0.36, 0.38, 0.52, 0.54] {
        let mut blocks = Structure::new(&[1.0, 1.0])
            .and_then(|s| s.with_spring(0, 1, 1.2))
            .unwrap();
        for (i, load) in [(0, 1.0), (1, 1.3)] {
            blocks = blocks
                .with_ground_spring(i, 1.0)
                .and_then(|s| s.with_ground_damper(i, 0.1))
                .and_then(|s| {
                    let contact = Contact::new(i, Rational::new(1.0, 3.0)?, load)?;
                    s.with_contact(contact.on_belt(belt))
                })
                .unwrap();
        }
        let start = State::new(&[0.7, 0.0], &[0.2, -0.2]);
        let found = classify(&blocks, &start).unwrap();
        let orbit = found.orbit().unwrap();
        let half = orbit.trajectory().state_at(0.5 * orbit.period()).unwrap();
        let apart = (half.velocities[0] - orbit.state().velocities[0]).abs()
            + (half.displacements[1] - orbit.state().displacements[1]).abs();
        assert!(apart > 1e-3, "{belt}: period {}", orbit.period());
    }
}

/// Masses that dry contacts hold stand still, although a force varies: rounding moves them by less
/// than 1e-16.
#[test]
fn what_contacts_hold_is_at_rest() {
    let law = Exponential::new(0.64, 0.35, 0.84).unwrap();
    let held = Structure::new(&[1.8, 0.7])
        .and_then(|s| s.with_ground_spring(0, 0.9)?.with_ground_spring(1, 1.7))
        .and_then(|s| s.with_spring(0, 1, 1.6)?.with_ground_damper(0, 0.1))
        .and_then(|s| s.with_ground_damper(1, 0.2))
        .and_then(|s| s.with_force(0, Drive::harmonic(0.2, 0.9, 0.0)?))
        .and_then(|s| s.with_force(1, 0.43 * 0.97))
        .and_then(|s| s.with_contact(Contact::new(0, law, 0.55)?))
        .and_then(|s| s.with_contact(Contact::between(0, 1, Coulomb::new(0.44, 0.44)?, 1.3)?))
        .unwrap();
    for (q, v) in [(0.3, 0.1), (-0.2, 0.0), (0.5, 0.5), (0.0, -0.4)] {
        let found = classify(&held, &State::new(&[q, 0.1], &[v, 0.2])).unwrap();
        assert_eq!(found.kind(), AttractorKind::Rest, "{q} {v}: {found:?}");
    }
}

/// A force pushes a mass on by a shorter slip in each period, and these slips never cease: the mass
/// approaches the place at which the largest force is just held.
#[test]
fn what_a_force_shakes_down_is_at_rest() {
    let mass = |amplitude: f64| {
        let force = Drive::constant(0.25).with_harmonic(amplitude, 2.0, 0.0)?;
        let contact = Contact::new(0, Coulomb::new(0.3, 0.3)?, 1.0)?;
        one_mass([1.0, 0.0, 1.0], force, contact)
    };
    for amplitude in [0.04, 0.06, 0.08, 0.1, 0.15, 0.2, 0.25] {
        let system = mass(amplitude).unwrap();
        let found = classify(&system, &State::at_rest(1)).unwrap();
        assert_eq!(found.kind(), AttractorKind::Rest, "{amplitude}: {found:?}");
        // What is missing falls like 1/t.
        let motion = system.simulate(State::at_rest(1), 3000.0).unwrap();
        let expected = (0.25 + amplitude - 0.3_f64).max(0.0);
        let missed = |time: f64| expected - motion.state_at(time).unwrap().displacements[0];
        let [early, late] = [1500.0, 3000.0].map(missed);
        let falls = (early / late - 2.0).abs() < 0.1;
        assert!(expected == 0.0 || falls, "{amplitude}: {early} {late}");
    }
    let found = vibration_ranges(mass, 0.04..0.25).unwrap();
    let [only] = exactly(&found.ranges);
    assert_eq!(only.attractors, [AttractorKind::Rest]);
}

/// What is at rest does not depend on a free inertia that turns beside it, nor on the time for
/// which a contact has been at rest.
#[test]
fn rest_beside_a_free_inertia_and_with_a_clock() {
    let moved = Structure::new(&[1.0, 1.0])
        .and_then(|s| s.with_ground_spring(0, 1.0)?.with_ground_damper(0, 0.1))
        .and_then(|s| s.with_force(0, Drive::sine(0.1, 0.7)?));
    let dry = Coulomb::new(0.4, 0.4).unwrap();
    let clock = Dwell::exponential(dry, 0.6, 1.0).unwrap();
    let contacts = [
        Contact::new(0, dry, 1.0).unwrap(),
        Contact::new(0, clock, 1.0).unwrap(),
    ];
    for contact in contacts {
        let system = moved.clone().and_then(|s| s.with_contact(contact)).unwrap();
        for velocity in [0.0, 0.5] {
            let start = State::new(&[0.3, 0.0], &[0.2, velocity]);
            let found = classify(&system, &start).unwrap();
            assert_eq!(found.kind(), AttractorKind::Rest, "{velocity}: {found:?}");
        }
    }
}

/// A mass that a slow force moves in every period is not at rest, although fast ripples of the
/// force let 256 steps pass before it slips for the first time.
#[test]
fn a_mass_does_not_rest_before_a_whole_period_of_rest() {
    let force = Drive::harmonic(-1.5, 1.0, 0.0).unwrap();
    let force = force.with_constant(0.7).unwrap();
    let force = force.with_sine(1e-3, 900.0).unwrap();
    let contact = Contact::new(0, Coulomb::new(1.0, 0.8).unwrap(), 1.0).unwrap();
    let system = oscillator([1.0, 0.2, 1.0], force).unwrap();
    let system = system.with_contact(contact).unwrap();
    let found = classify(&system, &State::at_rest(1)).unwrap();
    assert_eq!(found.kind(), AttractorKind::PureSlip);
    assert!(found.orbit().unwrap().amplitude(0) > 1.0);
}
