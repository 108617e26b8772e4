//! Runs that stop: at a condition on the state, after events, at a limit; what they return is the
//! motion up to there, the same as without the stop.

use approx::assert_abs_diff_eq;
use stick_slip::{
    Contact, Coulomb, Direction, Ended, Error, Event, Integrator, MassOnBelt, Mode, Segment, State,
    Structure, structure,
};

use super::common::polynomials::Polynomials;
use super::common::{Random, one_mass, paper, refused};

const START: State = State::new(0.0, 0.0);

/// A condition on the state.
type Condition = fn(&State) -> f64;

/// What is 0 at an event is 0 in its state, not in the rounded series before it; and the mode at
/// the end is that after the event.
#[test]
fn a_condition_that_is_met_at_an_event_is_met_there() {
    let mut random = Random::new(91);
    let mut before = 0;
    for _ in 0..100 {
        let v_b = random.uniform(0.02, 0.35);
        let system = paper(v_b);
        let whole = system.simulate(START, 60.0).unwrap();
        let [stick, release] = [0, 1].map(|i| whole.events()[i]);
        let cases = [
            (START, stick, Mode::Stick),
            (stick.state, release, Mode::Slip(Direction::Lagging)),
        ];
        for (start, event, mode) in cases {
            let condition = |state: &State| match mode {
                Mode::Stick => state.velocity - v_b,
                _ => state.displacement - event.state.displacement,
            };
            let motion = Integrator::new()
                .simulate_until(&system, start, 60.0, |step| step.first_zero(condition))
                .unwrap();
            let end = motion.duration();
            assert_eq!(motion.ended(), &Ended::Stopped);
            let [only] = motion.events() else {
                // The condition is 0 to rounding just before.
                assert!(condition(&motion.last()).abs() <= f64::EPSILON);
                let first = system.simulate(start, 60.0).unwrap().events()[0].time;
                assert!((0.0..1e-14).contains(&(first - end)), "{:e}", first - end);
                before += 1;
                continue;
            };
            assert_eq!((only.kind, only.state), (event.kind, event.state));
            assert_eq!(end, only.time);
            assert_eq!(motion.mode_at(end), Some(mode));
            assert_eq!(motion.state_at(end), Some(motion.last()));
        }
        let block = Structure::from(&system);
        let start = structure::State::at_rest(1);
        let motion = Integrator::new()
            .simulate_until(&block, start, 60.0, |step| {
                step.first_zero(|state| state.velocities[0] - v_b)
            })
            .unwrap();
        let end = motion.duration();
        if let [stick] = motion.events() {
            assert_eq!(stick.time, end);
            assert_eq!(motion.mode_at(0, end), Some(Mode::Stick));
        } else {
            before += 1;
        }
        assert_eq!(motion.state_at(end), Some(motion.last()));
    }
    assert!(before < 100, "{before} of 300");
}

#[test]
fn a_condition_is_met_to_the_last_bits() {
    let system = paper(0.2);
    let whole = system.simulate(START, 50.0).unwrap();
    let conditions: [(Condition, f64); 5] = [
        (|state| state.displacement - 0.35, 1.0),
        (|state| state.velocity, 1.0),
        (|state| state.velocity + 0.2, 1.0),
        (|state| state.displacement * state.velocity - 0.01, 1.0),
        (
            |state| state.displacement.powi(2) + state.velocity.powi(2) - 0.2,
            1.0,
        ),
    ];
    for (i, (condition, scale)) in conditions.into_iter().enumerate() {
        let motion = Integrator::new()
            .simulate_until(&system, START, 50.0, |step| step.first_zero(condition))
            .unwrap();
        assert_eq!(motion.ended(), &Ended::Stopped, "condition {i}");
        let end = motion.duration();
        assert!(
            condition(&motion.last()).abs() < 4e-16 * scale,
            "condition {i}"
        );
        // The condition keeps its sign up to there.
        let first = condition(&motion.state_at(1e-9).unwrap()).signum();
        for (time, state) in motion.sample(1000).skip(1).take(998) {
            assert!(condition(&state) * first > 0.0, "condition {i} at {time}");
        }
        // And the motion is the whole one, cut.
        let n = motion.steps().len();
        assert_eq!(motion.steps()[..n - 1], whole.steps()[..n - 1]);
        assert_eq!(motion.last(), whole.state_at(end).unwrap());
        let before: Vec<Event> = whole
            .events()
            .iter()
            .copied()
            .filter(|e| e.time < end)
            .collect();
        assert_eq!(motion.events(), before);
    }
}

#[test]
fn a_motion_that_is_stopped_can_go_on() {
    let system = paper(0.2);
    let whole = system.simulate(START, 30.0).unwrap();
    let integrator = Integrator::new();
    let mut from = START;
    let mut time = 0.0;
    // Every turning point of the displacement, each the start of the next run.
    let mut turns = 0;
    while time < 20.0 {
        let motion = integrator
            .simulate_until(&system, from, 30.0, |step| {
                // Where it starts it rests, up to rounding.
                step.first_zero(|state| state.velocity)
                    .filter(|&turn| turn > 1e-9)
            })
            .unwrap();
        time += motion.duration();
        from = motion.last();
        let there = whole.state_at(time).unwrap();
        assert_abs_diff_eq!(from.displacement, there.displacement, epsilon = 1e-13);
        turns += 1;
    }
    assert_eq!(turns, 6);
}

#[test]
fn events_and_limits_end_a_motion_with_what_there_is() {
    let system = paper(0.2);
    let whole = system.simulate(START, 50.0).unwrap();
    for n in [1, 2, 5, 8] {
        let mut left = n;
        let motion = Integrator::new()
            .simulate_until(&system, START, 50.0, |step| {
                left -= step.events().len();
                (left == 0).then(|| step.end_time())
            })
            .unwrap();
        assert_eq!(motion.events(), &whole.events()[..n]);
        assert_eq!(motion.duration(), whole.events()[n - 1].time);
        assert_eq!(motion.last(), whole.events()[n - 1].state);
    }
    for steps in [1, 7, 30] {
        let few = Integrator::new().with_max_steps(steps).unwrap();
        assert!(few.simulate(&system, START, 50.0).is_err());
        let motion = few.simulate_until(&system, START, 50.0, |_| None).unwrap();
        let Ended::Error(Error::TooManySteps { limit, reached }) = motion.ended() else {
            panic!("{motion:?}")
        };
        assert_eq!((*limit, reached.time), (steps, motion.duration()));
        assert_eq!(motion.steps(), &whole.steps()[..steps]);
    }
    // Nothing stops it: as without the condition.
    let motion = Integrator::new()
        .simulate_until(&system, START, 50.0, |_| None)
        .unwrap();
    assert_eq!(motion, whole);
    assert_eq!(motion.ended(), &Ended::Duration);
}

#[test]
fn an_error_on_the_way_keeps_the_motion_before_it() {
    // Defined up to the speed 0.3.
    let short = Polynomials::new(0.4, &[0.3, -0.1]).then(0.3, &[f64::NAN]);
    let system = MassOnBelt::new(short, 0.2).unwrap();
    let error = system.simulate(START, 50.0).unwrap_err();
    let motion = Integrator::new()
        .simulate_until(&system, START, 50.0, |_| None)
        .unwrap();
    let Ended::Error(end) = motion.ended() else {
        panic!("{motion:?}")
    };
    // The value in it is NaN, which does not equal itself.
    assert_eq!(end.to_string(), error.to_string());
    assert!(motion.duration() > 1.0 && !motion.events().is_empty());
    assert!(motion.state_at(motion.duration()).is_some());
    // A first step that fails leaves nothing to return.
    let far = Integrator::new().simulate_until(&system, State::new(0.0, 5.0), 1.0, |_| None);
    assert!(far.is_err());
}

#[test]
fn odd_answers_are_put_into_the_step() {
    let system = paper(0.2);
    let stop = |answer: f64| {
        let motion = Integrator::new().simulate_until(&system, START, 5.0, |_| Some(answer));
        motion.unwrap().duration()
    };
    assert_eq!(stop(-1.0), 0.0);
    let first = system.simulate(START, 5.0).unwrap().steps()[0].duration();
    assert_eq!(stop(1e300), first);
    assert_eq!(stop(0.5 * first), 0.5 * first);
    // A motion of no length, and one that the duration ends within its first step.
    let none = Integrator::new()
        .simulate_until(&system, START, 0.0, |_| None)
        .unwrap();
    assert_eq!((none.duration(), none.ended()), (0.0, &Ended::Duration));
    for bad in [-1.0, f64::NAN, f64::INFINITY] {
        let found = Integrator::new().simulate_until(&system, START, bad, |_| None);
        refused!(found => Error::InvalidDuration { .. });
    }
}

#[test]
fn a_structure_stops_as_a_belt_does() {
    let belt = paper(0.2);
    let one: Structure = Structure::from(&belt);
    let integrator = Integrator::new();
    let here = integrator
        .simulate_until(&belt, START, 50.0, |step| {
            step.first_zero(|s| s.displacement - 0.35)
        })
        .unwrap();
    let there = integrator
        .simulate_until(&one, structure::State::from(START), 50.0, |step| {
            step.first_zero(|state| state.displacements[0] - 0.35)
        })
        .unwrap();
    assert_abs_diff_eq!(here.duration(), there.duration(), epsilon = 1e-14);
    assert_eq!(there.ended(), &Ended::Stopped);
    assert_eq!(there.events().len(), here.events().len());
}

/// A rate with which the samples of a motion agree with its states, and say what the mass does.
#[test]
fn samples_at_a_rate_hold_the_phase() {
    let system = paper(0.2);
    let motion = system.simulate(START, 20.0).unwrap();
    for interval in [0.1, 0.03, 1.0 / 3.0, 20.0, 7.0, 100.0] {
        let samples: Vec<_> = motion.sample_every(interval).unwrap().collect();
        assert_eq!(samples.len(), (20.0 / interval + 1e-9) as usize + 1);
        for (i, &(time, state, mode)) in samples.iter().enumerate() {
            assert_eq!(time, (interval * i as f64).min(20.0));
            assert_eq!(Some(state), motion.state_at(time));
            assert_eq!(Some(mode), motion.mode_at(time));
            assert_eq!(
                mode == Mode::Stick,
                state.velocity == 0.2,
                "{interval}, {time}"
            );
        }
    }
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        refused!(motion.sample_every(bad) => Error::InvalidParameter { .. });
    }
    // From another start time on.
    let contact = Contact::new(0, Coulomb::new(0.4, 0.3).unwrap(), 1.0)
        .unwrap()
        .on_belt(0.1);
    let structure = one_mass([1.0, 0.0, 1.0], 0.0, contact).unwrap();
    let later = Integrator::new().with_start_time(3.0).unwrap();
    let motion = later
        .simulate(&structure, structure::State::at_rest(1), 10.0)
        .unwrap();
    let samples: Vec<_> = motion.sample_every(0.5).unwrap().collect();
    assert_eq!(
        (samples.len(), samples[0].0, samples[20].0),
        (21, 3.0, 13.0)
    );
    for (time, state, modes) in samples {
        assert_eq!(Some(state), motion.state_at(time));
        assert_eq!(modes.first().copied(), motion.mode_at(0, time));
    }
}

#[test]
fn what_is_printed_for_finding_faults_is_short() {
    let system = paper(0.2);
    let motion = system.simulate(START, 50.0).unwrap();
    assert!(format!("{motion:?}").len() < 300);
    assert!(format!("{:?}", motion.steps()[0]).len() < 400);
    let cycle = stick_slip::limit_cycle::stick_slip(&system)
        .unwrap()
        .unwrap();
    assert!(format!("{cycle:?}").len() < 300);
    let one: Structure = Structure::from(&system);
    let motion = one.simulate(structure::State::at_rest(1), 50.0).unwrap();
    assert!(format!("{motion:?}").len() < 400);
    assert!(format!("{:?}", motion.steps()[0]).len() < 400);
}
