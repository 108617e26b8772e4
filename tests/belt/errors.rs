//! Every error is reached through the public API, carries its numbers and names a remedy; and bad
//! input of any kind ends in a typed error or in the right answer, in bounded time.

use std::sync::mpsc;
use std::sync::{Arc, Mutex};
use std::time::Duration;

use crate::common::polynomials::Polynomials;
use crate::common::{
    Random, Table, assert_message, friction_law, message, on_belt, paper, refused, ulp,
};
use stick_slip::{
    Coulomb, Error, EventKind, Exponential, FrictionLaw, Integrator, MassOnBelt, Mode, Polynomial,
    State,
};

/// Runs a function on a thread of its own; a test that hangs fails with the last note it took.
#[track_caller]
fn within<T: Send + 'static>(
    seconds: u64,
    run: impl FnOnce(&dyn Fn(String)) -> T + Send + 'static,
) -> T {
    let result = Arc::new(Mutex::new(None));
    let place = Arc::clone(&result);
    end_within(
        seconds,
        Box::new(move |note| *place.lock().unwrap() = Some(run(note))),
    );
    let result = result.lock().unwrap().take();
    result.unwrap()
}

/// What runs, with a place for its notes.
type Noting = dyn FnOnce(&dyn Fn(String)) + Send;

#[track_caller]
fn end_within(seconds: u64, run: Box<Noting>) {
    let note = Arc::new(Mutex::new(String::new()));
    let (sender, receiver) = mpsc::channel();
    let written = Arc::clone(&note);
    let thread = std::thread::spawn(move || {
        run(&|text| *written.lock().unwrap() = text);
        let _ = sender.send(());
    });
    match receiver.recv_timeout(Duration::from_secs(seconds)) {
        Ok(()) => {}
        Err(mpsc::RecvTimeoutError::Timeout) => {
            panic!("still running after {seconds} s: {}", note.lock().unwrap())
        }
        Err(mpsc::RecvTimeoutError::Disconnected) => match thread.join() {
            Err(panic) => std::panic::resume_unwind(panic),
            Ok(()) => unreachable!(),
        },
    }
}

/// One of the laws that have no name.
macro_rules! law {
    ($($law:tt)*) => {{
        friction_law! { Given: $($law)* }
        Given
    }};
}

const NOT_FINITE: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

// -------------------------------------------------------------------------------------------------
// Each variant
// -------------------------------------------------------------------------------------------------

#[test]
fn invalid_state() {
    let system = paper(0.2);
    // 1e300 is the largest scale of a motion.
    for x in NOT_FINITE.into_iter().chain([1e301, -1e305, f64::MAX]) {
        for start in [State::new(x, 0.1), State::new(0.1, x), State::new(x, x)] {
            let refused = system.simulate(start, 1.0);
            let (u, v) = refused!(&refused =>
                Error::InvalidState { displacement, velocity }, (displacement, velocity));
            assert_eq!(u.to_bits(), start.displacement.to_bits());
            assert_eq!(v.to_bits(), start.velocity.to_bits());
            let remedy = if x.is_finite() {
                "unit of length"
            } else {
                "finite"
            };
            message(refused, &["u = ", "v = ", remedy]);
            message(
                Integrator::new().flow(&system, start),
                &["u = ", "v = ", remedy],
            );
        }
    }
}

#[test]
fn invalid_duration() {
    for duration in NOT_FINITE.into_iter().chain([-1.0, -5e-324]) {
        let refused = paper(0.2).simulate(State::new(0.0, 0.0), duration);
        let value = refused!(&refused => Error::InvalidDuration { value, .. }, value);
        assert_eq!(value.to_bits(), duration.to_bits());
        let error = refused.unwrap_err();
        assert_message(&error, &["duration", "flow"]);
        assert_eq!(error.to_string().contains("finite"), !duration.is_finite());
    }
}

#[test]
fn static_below_kinetic() {
    let error = MassOnBelt::new(Polynomials::new(0.4, &[0.5, 1.0]), 0.2).unwrap_err();
    let expected = Error::StaticBelowKinetic {
        static_coefficient: 0.4,
        kinetic_coefficient: 0.5,
    };
    assert_eq!(error, expected);
    assert_message(&error, &[" 0.4 ", " 0.5;", "raise", "lower"]);
    for (excess, valid) in [(1.0, true), (2.0, true), (100.0, false), (1e6, false)] {
        let made = MassOnBelt::new(Polynomials::new(0.4, &[0.4 + excess * ulp(0.4)]), 0.2);
        assert_eq!(made.is_ok(), valid, "{excess} ulps above");
    }
    assert!(MassOnBelt::new(Polynomials::new(0.0, &[1e-300]), 1.0).is_err());
}

/// μ̂(0) an ulp above μ_s is a valid law: its release starts with an exact double root.
#[test]
fn kinetic_an_ulp_above_static_releases_like_an_equal_one() {
    let [above, equal] = [0.4_f64.next_up(), 0.4].map(|at_rest| {
        let system = MassOnBelt::new(Polynomials::new(0.4, &[at_rest, -0.2]), 0.2).unwrap();
        system
            .simulate(system.release_state().unwrap(), 50.0)
            .unwrap()
    });
    assert_eq!(above.events()[0].time, 0.0);
    assert!(above.events().len() > 4);
    assert_eq!(above.events().len(), equal.events().len());
    for (a, b) in std::iter::zip(above.events(), equal.events()) {
        assert_eq!(a.kind, b.kind);
        approx::assert_abs_diff_eq!(a.time, b.time, epsilon = 1e-13);
    }
}

#[test]
fn non_finite_friction() {
    // When the system is made: at speed 0, and at |v_b|.
    fn check<L>(made: Result<MassOnBelt<L>, Error>, at: f64) {
        let (speed, value) = refused!(&made =>
            Error::NonFiniteFriction { speed, value, reached: None }, (*speed, *value));
        assert!(speed == at && !value.is_finite());
        message(made, &["speed", "define the law"]);
    }
    for bad in [f64::NAN, f64::NEG_INFINITY] {
        check(MassOnBelt::new(Polynomials::new(0.4, &[bad]), 0.2), 0.0);
    }
    check(MassOnBelt::new(law!(0.4, |s| -s.ln() * 0.01), 0.2), 0.0);
    let upper = Polynomials::new(0.4, &[0.4, -0.1]).then(0.3_f64.next_up(), &[f64::NAN]);
    check(MassOnBelt::new(upper.clone(), -0.5), 0.5);

    // On the way, from where the law is defined: the time and state before.
    let system = MassOnBelt::new(upper, 0.2).unwrap();
    let on_its_way = system.clone();
    let run = within(10, move |_| on_its_way.simulate(State::new(0.0, 0.2), 20.0));
    let (speed, value, reached) = refused!(&run =>
        Error::NonFiniteFriction { speed, value, reached: Some(at) }, (*speed, value, at));
    assert!(value.is_nan());
    approx::assert_relative_eq!(speed, 0.3, max_relative = 1e-9);
    approx::assert_relative_eq!(0.2 - reached.state.velocities[0], 0.3, max_relative = 1e-6);
    assert!(reached.time > 2.0);
    message(run, &["NaN", "at time", "u = ", "v = "]);

    // At the start.
    let start = State::new(0.0, 1.0);
    let (speed, reached) = refused!(system.simulate(start, 1.0) =>
        Error::NonFiniteFriction { speed, reached: Some(reached), .. }, (speed, reached));
    assert_eq!(
        (speed, reached.time, reached.state),
        (0.8, 0.0, start.into())
    );
}

/// Nor is a stretch without a value left out if the step that holds it begins and ends where the
/// law is defined.
#[test]
fn a_law_without_a_value_inside_a_step_is_noticed() {
    let whole = Polynomials::new(0.4, &[0.4, -0.1]);
    let gap = whole.clone().then(0.3_f64.next_up(), &[f64::NAN]);
    let [whole, gap] = [whole, gap].map(|law| MassOnBelt::new(law, 0.2).unwrap());
    let mut reached = 0;
    for i in 0..200 {
        let start = State::new(0.4 + 0.002 * f64::from(i), 0.2);
        let fastest = |motion: &stick_slip::Trajectory| {
            let speeds = motion.sample(1000).map(|(_, state)| 0.2 - state.velocity);
            speeds.fold(0.0, f64::max)
        };
        let fastest = fastest(&whole.simulate(start, 5.0).unwrap());
        if fastest < 0.33 {
            continue;
        }
        reached += 1;
        let gap = gap.clone();
        match within(10, move |_| gap.simulate(start, 5.0)) {
            Err(Error::NonFiniteFriction { speed, .. }) => assert!(speed > 0.3, "{speed}"),
            Err(other) => panic!("{start:?}: {other}"),
            Ok(motion) => panic!(
                "{start:?}: reaches s = {fastest}, but ends at {:?}",
                motion.last()
            ),
        }
    }
    assert!(reached > 50, "{reached}");
}

#[test]
fn not_analytic() {
    // √s, s^1.5 and √|s − 0.2|, which is not analytic at |v_b|.
    fn check<L>(made: Result<MassOnBelt<L>, Error>, speed: f64) {
        let error = made.map(drop).unwrap_err();
        let reached = None;
        assert_eq!(error, Error::NotAnalytic { speed, reached });
        assert_message(&error, &["not analytic", "integer powers", "breakpoint"]);
    }
    check(
        MassOnBelt::new(law!(0.4, |s| -s.sqrt() * 0.1 + 0.4), 0.2),
        0.0,
    );
    check(MassOnBelt::new(law!(0.4, |s| -s.powf(1.5) + 0.4), 0.2), 0.0);
    check(MassOnBelt::new(law!(0.4, |s| -s.powf(0.5) + 0.4), 0.2), 0.0);
    let cusp = law!(0.4, |s| (s - 0.2).abs().sqrt() * -0.1 + 0.4);
    check(MassOnBelt::new(cusp, 0.2), 0.2);
    assert!(MassOnBelt::new(cusp, 0.3).is_ok());

    // Met on the way, at a breakpoint with a vertical tangent.
    let vertical = law!(0.5, |s| (s - 0.25).abs().sqrt() * -0.1 + 0.4, at[0.25]);
    let system = MassOnBelt::new(vertical, 0.5).unwrap();
    let run = within(10, move |_| system.simulate(State::new(0.0, 0.5), 20.0));
    let error = run.unwrap_err();
    let (speed, reached) = match error {
        Error::NotAnalytic { speed, ref reached } => (speed, reached.as_ref().unwrap()),
        // The tangent grows without bound on the way: steps may fall below the clock's ulp first.
        Error::StepUnderflow { ref reached, .. } => (0.25, reached),
        other => panic!("{other}"),
    };
    assert_eq!(speed, 0.25);
    approx::assert_relative_eq!(reached.state.velocities[0], 0.25, max_relative = 1e-6);
    assert_message(&error, &["at time", "breakpoint"]);
}

#[test]
fn bad_breakpoints() {
    // Constant, and lower by `fall` on each piece.
    let with = |breakpoints: &[f64], fall: f64| {
        let mut law = Polynomials::new(0.5, &[0.5]).told();
        for (&at, level) in breakpoints.iter().zip(1..) {
            law = law.then(at, &[0.5 - fall * f64::from(level)]);
        }
        MassOnBelt::new(law, 0.2)
    };
    let cases: [(&[f64], usize); 9] = [
        (&[0.0], 0),
        (&[-0.0, 1.0], 0),
        (&[-1.0], 0),
        (&[f64::NAN], 0),
        (&[0.5, f64::NAN], 1),
        (&[0.5, f64::INFINITY], 1),
        (&[0.5, 0.5], 1),
        (&[0.5, 1.0, 0.75], 2),
        (&[f64::NEG_INFINITY], 0),
    ];
    for (breakpoints, at) in cases {
        let refused = with(breakpoints, 0.0);
        let (index, value) = refused!(&refused =>
            Error::BadBreakpoints { index, value }, (*index, value));
        assert_eq!(index, at, "{breakpoints:?}");
        assert_eq!(value.to_bits(), breakpoints[at].to_bits());
        message(refused, &["breakpoint", "ascending", "continuous"]);
    }
    // A jump; and rounding, which is none.
    assert!(with(&[0.5, 1.0], 0.0).is_ok());
    refused!(with(&[0.5, 1.0], 1e-3) => Error::BadBreakpoints { index: 0, value: 0.5 });
    assert!(with(&[0.5, 1.0], 4e-13).is_ok());
    assert!(with(&[0.5, 1.0], 1e-12).is_err());
}

/// The cubic so far from the belt that not even the coefficients of a step are finite.
#[test]
fn step_underflow() {
    let start = State::new(0.0, 1e80);
    let run = within(10, move |_| paper(0.2).simulate(start, 1.0));
    let (step, reached) = refused!(&run =>
        Error::StepUnderflow { step, reached }, (*step, reached));
    assert!((0.0..1e-12).contains(&step), "{step:e}");
    assert_eq!((reached.time, &reached.state), (0.0, &start.into()));
    message(run, &["at time", "stiff", "breakpoint"]);
}

/// A jump that the law does not name and on which the motion must stay: pushed up to it from below
/// and down from above.
#[test]
fn a_jump_that_holds_the_motion_is_an_error() {
    let jump = Polynomials::new(0.5, &[0.1]).then(0.25, &[0.9]);
    let system = MassOnBelt::new(jump, 0.5).unwrap();
    let run = within(20, move |_| system.simulate(State::new(0.5, 0.5), 20.0));
    let reached = refused!(&run =>
        Error::StepUnderflow { reached, .. } | Error::TooManySteps { reached, .. }, reached);
    approx::assert_relative_eq!(reached.state.velocities[0], 0.25, max_relative = 1e-9);
    assert!(reached.time > 0.3);
    message(run, &["at time", "stiff"]);
}

#[test]
fn too_many_steps() {
    let system = paper(0.2);
    let start = State::new(0.0, 0.0);
    let run = |limit: usize| {
        Integrator::new()
            .with_max_steps(limit)
            .unwrap()
            .simulate(&system, start, 50.0)
    };
    let whole = system.simulate(start, 50.0).unwrap();
    let needed = whole.steps().len();
    assert_eq!(run(needed).unwrap(), whole);
    for limit in [1, 5, needed - 1] {
        let found = run(limit);
        let (met, reached) = refused!(&found =>
            Error::TooManySteps { limit, reached }, (*limit, reached));
        assert_eq!(met, limit);
        let last = &whole.steps()[limit];
        let there = (last.start_time(), &last.state().into());
        assert_eq!((reached.time, &reached.state), there);
        message(
            found,
            &[&limit.to_string(), "at time", "with_max_steps", "flow"],
        );
    }
    // The default limit ends a run that was asked to last for ever.
    let endless = within(20, move |_| paper(0.2).simulate(start, 1e300));
    refused!(endless => Error::TooManySteps { limit: Integrator::DEFAULT_MAX_STEPS, .. });
    // In a flow the limit holds too; then nothing comes.
    let mut flow = Integrator::new()
        .with_max_steps(3)
        .unwrap()
        .flow(&system, start)
        .unwrap();
    assert_eq!(flow.by_ref().take(3).filter(Result::is_ok).count(), 3);
    refused!(flow.next().unwrap() => Error::TooManySteps { limit: 3, .. });
    assert!(flow.next().is_none());
}

#[test]
fn too_many_events() {
    let system = paper(0.2);
    let start = State::new(0.0, 0.0);
    let run = |limit: usize| {
        Integrator::new()
            .with_max_events(limit)
            .unwrap()
            .simulate(&system, start, 50.0)
    };
    let whole = system.simulate(start, 50.0).unwrap();
    let count = whole.events().len();
    // A motion with n events needs a limit of n, no more and no less.
    assert_eq!(run(count).unwrap(), whole);
    for limit in [1, count / 2, count - 1] {
        let found = run(limit);
        let (met, reached) = refused!(&found =>
            Error::TooManyEvents { limit, reached }, (*limit, reached));
        assert_eq!(met, limit);
        assert!(reached.time >= whole.events()[limit - 1].time);
        assert!(reached.time <= whole.events()[limit].time);
        message(
            found,
            &[&limit.to_string(), "at time", "with_max_events", "flow"],
        );
    }
}

// -------------------------------------------------------------------------------------------------
// Bad input
// -------------------------------------------------------------------------------------------------

/// Numbers that break things.
#[rustfmt::skip]
const HOSTILE: [f64; 26] = [
    0.0, -0.0, 5e-324, f64::MIN_POSITIVE, 1e-300, 1e-160, 1e-100, 1e-20, 1e-8, 0.25, 0.4, 1.0,
    3.0, 1e3, 1e8, 1e20, 1e100, 1e150, 1e300, 1e305, f64::MAX, f64::NAN, f64::INFINITY,
    f64::NEG_INFINITY, -1.0, -1e300,
];

/// Hostile in one to three places of an ordinary case, or in all of them.
fn hostile(random: &mut Random, ordinary: f64, rate: f64) -> f64 {
    if random.uniform(0.0, 1.0) < rate {
        random.pick(&HOSTILE) * random.sign()
    } else {
        ordinary
    }
}

/// What a case gave: a motion, or a typed error.
fn attempt<L: FrictionLaw + std::fmt::Debug>(
    law: Result<L, Error>,
    [v_b, damping, load, u, v, duration, tolerance]: [f64; 7],
) -> Result<stick_slip::Trajectory, Error> {
    let system = MassOnBelt::new(law?, v_b)?
        .with_damping(damping)?
        .with_load(load)?;
    for state in [State::new(u, v), State::new(u, v_b)] {
        let _ = (system.friction_force(state), system.acceleration(state));
    }
    let _ = (
        system.release_state(),
        system.equilibrium(),
        system.stick_limits(),
    );
    Integrator::new()
        .with_tolerance(tolerance)?
        .with_max_steps(300)?
        .with_max_events(50)?
        .simulate(&system, State::new(u, v), duration)
}

fn hostile_cases(seed: u64, cases: usize, rate: f64) {
    within(60, move |note| {
        let mut random = Random::new(seed);
        let (mut motions, mut errors) = (0, 0);
        for case in 0..cases {
            let mut next = |ordinary| hostile(&mut random, ordinary, rate);
            let parameters = [
                next(0.2),
                next(0.05),
                next(1.0),
                next(0.3),
                next(-0.5),
                next(10.0),
                next(1e-10),
            ];
            let [a, b, c] = [next(0.4), next(0.25), next(0.5)];
            note(format!(
                "case {case}: law {:?}, v_b, β, γ², u, v, duration, tolerance {parameters:?}",
                [a, b, c]
            ));
            let result = match case % 4 {
                0 => attempt(Polynomial::new(a, b, c), parameters),
                1 => attempt(Exponential::new(a, b, c), parameters),
                2 => attempt(Coulomb::new(a, b), parameters),
                _ => attempt(
                    Ok(Table {
                        static_coefficient: a,
                        points: vec![(0.0, b), (c, 0.5 * b), (2.0 * c, 0.75 * b)],
                    }),
                    parameters,
                ),
            };
            match result {
                Ok(motion) => {
                    motions += 1;
                    let State {
                        displacement,
                        velocity,
                    } = motion.last();
                    let what = format!(
                        "case {case}: law {:?}, {parameters:?}: {:?}",
                        [a, b, c],
                        motion.last()
                    );
                    assert!(displacement.is_finite() && velocity.is_finite(), "{what}");
                    assert_eq!(motion.duration(), parameters[5], "{what}");
                    assert!(
                        motion
                            .events()
                            .iter()
                            .all(|e| e.time.is_finite() && e.time <= parameters[5]),
                        "{what}"
                    );
                    for (time, state) in motion.sample(7) {
                        let finite = state.displacement.is_finite() && state.velocity.is_finite();
                        assert!(time.is_finite() && finite, "{what}: {time} {state:?}");
                    }
                }
                Err(error) => {
                    errors += 1;
                    assert_message(&error, &[]);
                }
            }
        }
        println!("hostile input, rate {rate}: {motions} motions, {errors} errors");
        assert!(motions > cases / 1000 && errors > cases / 10);
    });
}

#[test]
fn one_hostile_number_gives_an_error_or_a_motion() {
    hostile_cases(71, 6000, 0.1);
}

#[test]
fn hostile_numbers_everywhere_give_an_error_or_a_motion() {
    hostile_cases(72, 12_000, 0.5);
}

/// 1e300 and 1e-300 are units like any other: the same motion, to the bit where no coefficient of a
/// step is subnormal.
#[test]
fn extreme_units_give_the_same_motion() {
    let motion = |length: f64| {
        let system = on_belt(
            Coulomb::new(0.5, 0.25).unwrap(),
            0.125 * length,
            0.0625,
            length,
        );
        system.simulate(State::new(1.5 * length, -0.75 * length), 30.0)
    };
    let plain = motion(1.0).unwrap();
    assert!(plain.events().len() > 5);
    for exponent in [
        -1060, -1000, -980, -960, -900, -600, 600, 900, 960, 1000, 1020,
    ] {
        // In two factors: the reciprocal of 2^1060 overflows.
        let length = 2.0_f64.powi(exponent / 2) * 2.0_f64.powi(exponent - exponent / 2);
        let Ok(other) = within(10, move |_| motion(length)) else {
            assert!(exponent.abs() > 900, "2^{exponent} is refused");
            continue;
        };
        assert_eq!(plain.events().len(), other.events().len(), "2^{exponent}");
        for (a, b) in std::iter::zip(plain.events(), other.events()) {
            assert_eq!(a.kind, b.kind, "2^{exponent}");
            // Where states themselves have fewer bits, so has the motion.
            let subnormal = 1e-323 / length;
            let allowed = if exponent.abs() <= 900 {
                0.0
            } else {
                1e-12 + 100.0 * subnormal
            };
            approx::assert_abs_diff_eq!(a.time, b.time, epsilon = allowed);
            let displacement = b.state.displacement / length;
            approx::assert_abs_diff_eq!(a.state.displacement, displacement, epsilon = allowed);
        }
    }
}

/// Bounds that overflow although no coefficient does: a search for contact must not halve for ever.
#[test]
fn states_near_the_largest_number_do_not_hang() {
    for damping in [0.5, 2.0, 5.0, 20.0] {
        for exponent in 290..=308 {
            for mantissa in [1.0, 2.0, 5.0, 7.0, 9.0] {
                let size = format!("{mantissa}e{exponent}").parse::<f64>().unwrap();
                if !size.is_finite() {
                    continue;
                }
                let result = within(20, move |note| {
                    note(format!("β = {damping}, u = v = {size:e}"));
                    MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), 0.2)
                        .and_then(|system| system.with_damping(damping))
                        .and_then(|system| {
                            Integrator::new().with_max_steps(200)?.simulate(
                                &system,
                                State::new(size, size),
                                1.0,
                            )
                        })
                });
                if let Ok(motion) = result {
                    // At v_r < 0 or > 0 friction is nothing here: the linear oscillator, within its
                    // envelope.
                    assert!(
                        motion.last().displacement.abs() <= 4.0 * size,
                        "{:?}",
                        motion.last()
                    );
                }
            }
        }
    }
}

/// Stiff systems: the answer, or an error that says so, in bounded time.
#[test]
fn stiff_systems_end_in_bounded_time() {
    let cubic = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    for speed in [10.0, 1e2, 1e3, 1e5, 1e8, 1e50, 1e99, 1e103, 1e200] {
        let result = within(30, move |_| {
            MassOnBelt::new(cubic, 0.2)?.simulate(State::new(0.0, speed), 10.0)
        });
        match result {
            Ok(motion) => assert!(
                motion.last().velocity.abs() < 2.0,
                "{speed}: {:?}",
                motion.last()
            ),
            Err(error) => assert!(
                error.to_string().contains("stiff")
                    || matches!(error, Error::NonFiniteFriction { .. }),
                "{speed}: {error}"
            ),
        }
    }
    for (load, velocity) in [
        (1e3, 1e-3),
        (1e6, 1e-3),
        (1e3, 1e-8),
        (1.0, 1e-12),
        (1e9, 1e-9),
    ] {
        let result = within(30, move |_| {
            MassOnBelt::new(Exponential::new(0.4, 0.25, velocity)?, 0.2)?
                .with_load(load)?
                .simulate(State::new(0.0, 0.0), 10.0)
        });
        match result {
            Ok(motion) => assert!(motion.last().displacement.abs() <= 0.41 * load + 1.0),
            Err(error) => assert!(error.to_string().contains("stiff"), "{error}"),
        }
    }
    // A law that rises steeply: viscous friction so strong that v follows the belt.
    for slope in [1e2, 1e4, 1e8] {
        let result = within(30, move |_| {
            MassOnBelt::new(Polynomials::new(0.1, &[0.1, slope]), 0.2)?
                .simulate(State::new(0.0, 0.0), 10.0)
        });
        match result {
            Ok(motion) => assert!(motion.last().velocity.abs() <= 0.2 + 1e-9),
            Err(error) => assert!(error.to_string().contains("stiff"), "{error}"),
        }
    }
}

/// A start beside the belt by the least number there is, and belts that hardly move.
#[test]
fn tiny_speeds_are_speeds() {
    for v_r in [5e-324, -5e-324, 1e-300, -1e-300, 1e-20] {
        let motion = within(10, move |_| {
            let still = MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), 0.0)?;
            still.simulate(State::new(0.1, v_r), 1.0)
        })
        .unwrap();
        assert_ne!(
            motion.mode_at(0.0),
            Some(Mode::Stick),
            "{v_r:e} is not the belt's velocity"
        );
        assert_eq!(motion.events().len(), 1);
        assert_eq!(motion.events()[0].kind, EventKind::Stick);
        assert!(motion.events()[0].time <= 10.0 * v_r.abs());
    }
    for v_b in [5e-324, -5e-324, 1e-300, -1e-300, 1e-12] {
        let system = paper(v_b);
        let release = system.release_state().unwrap();
        let motion = within(10, move |_| system.simulate(State::new(0.1, v_b), 10.0)).unwrap();
        assert_eq!(
            (motion.events(), motion.mode_at(10.0)),
            (&[][..], Some(Mode::Stick))
        );
        // A motion of that size about u = 0.4 is lost in the rounding of u, and its series in
        // underflow.
        match within(10, move |_| system.simulate(release, 0.1)) {
            Err(Error::InvalidState { .. }) => assert!(v_b.abs() < 1e-280),
            released => {
                let released = released.unwrap();
                assert!(matches!(released.events()[0].kind, EventKind::Release(_)));
                assert!(released.last().displacement.is_finite());
            }
        }
    }
}

/// Friction that drives the mass beyond all numbers is not taken for a kink of the law; and what
/// drives it from the start on is refused.
#[test]
fn friction_that_drives() {
    let falls = |from: f64| Polynomials::new(0.4, &[from, -0.5]);
    let system = MassOnBelt::new(falls(0.4), 0.2).unwrap();
    let run = system.simulate((3.0, 0.0), 1e5);
    message(run, &["at time", "beyond the largest numbers"]);
    let parts = ["kinetic coefficient at speed 0 = -0.1", "opposes"];
    message(MassOnBelt::new(falls(-0.1), 0.2), &parts);
    assert!(MassOnBelt::new(falls(0.0), 0.2).is_ok());
}
