//! Derivatives of motions, events and orbits by parameters: closed forms, the monodromy matrix, and
//! neighbouring orbits.

use approx::assert_abs_diff_eq;
use stick_slip::nalgebra::DMatrix;
use stick_slip::orbit::{
    NotDifferentiable, Period, orbit_sensitivities, sensitivities, settle, shoot,
};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Drive, Element, Error, EventKind, Exponential, ForceLaw, MassOnBelt, Mode,
    Polynomial, RateState, Scalar, Structure,
};

use crate::common::orbit::monodromy;
use crate::common::{at_least, exactly, one_mass, oscillator, text, vector};
use crate::reading::{remembering, structure};
use crate::references::{all, period, remembers, start};

/// Error promised, in units of the largest derivative, where the motion does not magnify errors.
const ACCURACY: f64 = 1e-10;

/// A mass on a spring that sticks to a belt, and slips from the release on.
#[test]
fn stick_release_and_slip_have_the_derivatives_of_their_closed_forms() {
    // μ_s, μ_k, k, v, q0; in SI units.
    let parameters = [0.5, 0.3, 2000.0, 0.02, 0.001];
    let (mass, load) = (2.0, 30.0);
    let family = |p: &[f64]| {
        let contact = Contact::new(0, Coulomb::new(p[0], p[1])?, load)?.on_belt(p[3]);
        let system = one_mass([mass, 0.0, p[2]], 0.0, contact)?;
        Ok((system, State::new(&[p[4]], &[p[3]])))
    };
    let release = |p: &[f64]| (load * p[0] / p[2] - p[4]) / p[3];
    let motion = |p: &[f64], t: f64| {
        let since = t - release(p);
        let omega = (p[2] / mass).sqrt();
        let (sine, cosine) = (omega * since).sin_cos();
        let (middle, apart) = (load * p[1] / p[2], load * (p[0] - p[1]) / p[2]);
        [
            middle + apart * cosine + p[3] / omega * sine,
            -apart * omega * sine + p[3] * cosine,
        ]
    };
    // Sixth-order differences of the closed forms.
    let slope = |of: &dyn Fn(&[f64]) -> f64, j: usize| {
        let h = 2e-3 * parameters[j];
        let at = |times: f64| {
            let mut p = parameters;
            p[j] += times * h;
            of(&p)
        };
        let pair = |k: f64| at(k) - at(-k);
        (pair(1.0) * 0.75 - pair(2.0) * 0.15 + pair(3.0) / 60.0) / h
    };
    let end = release(&parameters) + 0.08;
    let found = sensitivities(family, &parameters, end).unwrap();
    let events = found.events();
    assert_eq!(events[0].kind.to_string(), "release (lagging)");
    for j in 0..5 {
        let expected = slope(&release, j);
        let error = events[0].by_parameters[j] - expected;
        assert!(
            error.abs() < ACCURACY * (1.0 + expected.abs()),
            "{j}: {error:e}"
        );
        for i in 0..2 {
            let expected = slope(&|p: &[f64]| motion(p, end)[i], j);
            let error = found.at(end).unwrap()[(i, j)] - expected;
            assert!(
                error.abs() < 1e-9 * (1.0 + expected.abs()),
                "{i}, {j}: {error:e}"
            );
        }
    }
    // In stick the velocity is that of the belt.
    let stuck = found.at(0.1).unwrap();
    assert_eq!(
        stuck.row(1).iter().map(|x| x.abs()).sum::<f64>() - stuck[(1, 3)],
        0.0
    );
    assert_abs_diff_eq!(stuck[(1, 3)], 1.0, epsilon = ACCURACY);
    assert_abs_diff_eq!(stuck[(0, 3)], 0.1, epsilon = ACCURACY);
    // A time within rounding of an event belongs to what was before it.
    let time = events[0].time;
    let [before, after] = [time * (1.0 - 1e-9), time * (1.0 + 1e-9)];
    assert!((found.at(time).unwrap() - found.at(before).unwrap()).amax() < 1e-6);
    assert!((found.at(time).unwrap() - found.at(after).unwrap()).amax() > 1e-3);
}

/// The derivative by the start, through all events of every reference motion, is the monodromy
/// matrix of the tangent flow.
#[test]
fn derivatives_by_the_start_are_those_of_the_tangent_flow() {
    let mut compared = 0;
    for case in all() {
        let id = text(&case["id"]);
        let system = if remembers(&case) {
            remembering(&case["system"])
        } else {
            structure(&case["system"], f64::NAN)
        };
        let begin = start(&case, system.contacts().len());
        let n = system.len();
        // Away from events: a start at one is on one side of it.
        let whole = system.simulate(begin.clone(), 1e3).unwrap();
        let events: Vec<f64> = whole.events().iter().map(|event| event.time).collect();
        let [Some(first), Some(second)] = [events.first(), events.get(1)] else {
            continue;
        };
        let drives = matches!(period(&case), Period::Driven(_));
        let (time, pause) = if drives {
            (0.0, *first)
        } else {
            (0.5 * (first + second), second - first)
        };
        let sticks = |c: usize| whole.mode_at(c, time) == Some(Mode::Stick);
        if pause < 1e-3 || (0..system.contacts().len()).any(sticks) {
            continue;
        }
        let state = whole.state_at(time).unwrap();
        let mut numbers = state.displacements.clone();
        numbers.extend(&state.velocities);
        let duration = 1.37 * second + 2.0;
        let family = |p: &[f64]| {
            let start = State::new(&p[..n], &p[n..]).with_memory(&state.memory);
            let again = if remembers(&case) {
                remembering(&case["system"])
            } else {
                structure(&case["system"], f64::NAN)
            };
            Ok((again, start))
        };
        let found = match sensitivities(family, &numbers, duration) {
            Ok(found) => found.at(duration).unwrap(),
            // Events at one time change their order.
            Err(Error::NoDerivative { .. }) => continue,
            Err(error) => panic!("{id}: {error}"),
        };
        let (_, matrix) = monodromy(&system, &state, duration).unwrap();
        let exact: DMatrix<f64> = matrix.columns(0, 2 * n).into();
        let error = (&found - &exact).amax() / exact.amax().max(1.0);
        println!("{id}: {error:.1e}");
        assert!(error < 1e-9, "{id}: {error:e}");
        compared += 1;
    }
    assert!(compared > 12, "{compared}");
}

#[test]
fn orbits_follow_their_parameters() {
    // A driven motion with stick: over frequency, force, damping and both coefficients.
    let family = |p: &[f64]| {
        let force = Drive::harmonic(p[1], p[0], 0.0)?;
        let contact = Contact::new(0, Coulomb::new(p[3], p[4])?, 1.5)?.on_belt(0.1);
        one_mass([1.0, p[2], 1.0], force, contact)
    };
    let parameters = [0.78, 0.2, 0.05, 0.5, 0.3];
    let guess = State::new(&[0.3], &[0.0]);
    let orbit = settle(
        &family(&parameters).unwrap(),
        &guess,
        400.0,
        Period::Driven(1),
    )
    .unwrap();
    let found = orbit_sensitivities(family, &parameters, &orbit).unwrap();
    let expected = -std::f64::consts::TAU / parameters[0].powi(2);
    assert_abs_diff_eq!(found.period[0], expected, epsilon = 1e-9);
    assert!(found.period[1..].iter().all(|slope| *slope == 0.0));
    let events = found.motion.events();
    assert!(events.len() >= 2);
    for j in 0..5 {
        let h = 1e-5;
        let beside = |change: f64| {
            let mut p = parameters;
            p[j] += change;
            shoot(&family(&p).unwrap(), &orbit.state(), Period::Driven(1)).unwrap()
        };
        let [low, high] = [-h, h].map(beside);
        for event in &events {
            let nearest = |orbit: &stick_slip::orbit::Orbit<State>| {
                let times = orbit.events().iter().map(|event| event.time);
                let period = orbit.period();
                let shifted = times.flat_map(|t| [t, t + period]);
                let near = |t: &f64| (t - event.time).abs();
                shifted.min_by(|a, b| near(a).total_cmp(&near(b))).unwrap()
            };
            let slope = (nearest(&high) - nearest(&low)) / (2.0 * h);
            let error = event.by_parameters[j] - slope;
            assert!(
                error.abs() < 1e-6 * (1.0 + slope.abs()),
                "{j}: {slope} {error:e}"
            );
        }
    }

    // A limit cycle of a belt, whose period is unknown.
    let belt =
        |p: &[f64]| MassOnBelt::new(Polynomial::new(p[0], 0.25, 0.5)?, p[1])?.with_damping(p[2]);
    let parameters = [0.4, 0.2, 0.05];
    let guess = (0.1, 0.2).into();
    let cycle = shoot(&belt(&parameters).unwrap(), &guess, Period::Free(6.8)).unwrap();
    let found = orbit_sensitivities(belt, &parameters, &cycle).unwrap();
    for j in 0..3 {
        let h = 1e-5;
        let beside = |change: f64| {
            let mut p = parameters;
            p[j] += change;
            let guess = (cycle.state().displacement, p[1]).into();
            shoot(&belt(&p).unwrap(), &guess, Period::Free(6.8))
                .unwrap()
                .period()
        };
        let slope = (beside(h) - beside(-h)) / (2.0 * h);
        let error = found.period[j] - slope;
        assert!(
            error.abs() < 1e-7 * (1.0 + slope.abs()),
            "{j}: {slope} {error:e}"
        );
    }
}

/// The slider of a joint never slips, so the force of its spring follows the mass. The start of a
/// motion with another period has the same position of the slider, and lies on the plane normal to
/// the flow.
#[test]
fn a_slider_that_never_slips_keeps_its_position() {
    const STIFFNESS: f64 = 0.7;
    let family = |p: &[f64]| {
        let belt = Contact::new(0, Exponential::new(0.4, 0.25, 0.5)?, 1.0)?.on_belt(p[0]);
        let joint = Contact::new(0, Coulomb::new(0.5, 0.5)?, 20.0)?;
        one_mass([1.0, p[1], 0.3], 0.0, belt)?
            .with_contact(joint.with_tangential_stiffness(STIFFNESS)?)
    };
    let parameters = [0.3, 0.1];
    let system = family(&parameters).unwrap();
    let orbit = settle(&system, &State::at_rest(1), 100.0, Period::Free(6.5)).unwrap();
    let found = orbit_sensitivities(family, &parameters, &orbit).unwrap();
    let [begin, _] = found.motion.times();
    let state = found.motion.state_at(begin).unwrap();
    let slopes = found.motion.at(begin).unwrap();
    assert!(state.velocities[0].abs() > 1e-3);
    let flow = [
        state.velocities[0],
        system.acceleration(begin, &state).unwrap()[0],
        STIFFNESS * state.velocities[0],
    ];
    for slope in slopes.column_iter() {
        let slid = slope[2] - STIFFNESS * slope[0];
        assert!(slid.abs() < 1e-9, "{slid:e}: {slopes}");
        let along: f64 = std::iter::zip(flow, slope.iter()).map(|(f, s)| f * s).sum();
        assert!(along.abs() < 1e-9, "{along:e}: {slopes}");
    }
}

#[test]
fn parameters_without_a_derivative_are_named() {
    let family = |p: &[f64]| {
        let law = Exponential::new(0.4, 0.25, 0.5)?;
        let contact = Contact::new(0, law, 1.0)?.on_belt(0.3);
        let system = one_mass([1.0, p[0], 1.0], 0.0, contact)?;
        Ok((system, State::new(&[0.0], &[p[1]])))
    };
    // At 0 a damping has motions on one side only, and no size to compare an increment with.
    let at_zero = sensitivities(family, &[0.0, 0.1], 9.0).unwrap();
    let beside = sensitivities(family, &[1e-6, 0.1], 9.0).unwrap();
    let change = (at_zero.at(9.0).unwrap() - beside.at(9.0).unwrap()).amax();
    assert!(change < 1e-4, "{change:e}");
    // No parameter at all is a motion.
    let none = sensitivities(|_: &[f64]| family(&[0.1, 0.1]), &[], 9.0).unwrap();
    assert_eq!(none.at(3.0).unwrap().shape(), (2, 0));
    assert!(none.at(-1.0).is_none() && none.at(9.1).is_none() && none.at(f64::NAN).is_none());
    assert!(none.state_at(f64::NAN).is_none() && none.state_at(9.0).is_some());
    // One without influence has the derivative 0.
    let idle = sensitivities(|_: &[f64]| family(&[0.1, 0.1]), &[3.0], 9.0).unwrap();
    assert_eq!(idle.at(3.0).unwrap().amax(), 0.0);
    for bad in [f64::NAN, f64::INFINITY] {
        let error = sensitivities(family, &[0.1, bad], 9.0).unwrap_err();
        assert!(matches!(error, Error::InvalidParameter { .. }), "{error}");
        let error = sensitivities(family, &[0.1, 0.1], bad).unwrap_err();
        assert!(matches!(error, Error::InvalidDuration { .. }), "{error}");
    }
    let only_there = |p: &[f64]| {
        if p[1] == 0.1 {
            family(p)
        } else {
            Err(Error::NotFree)
        }
    };
    let error = sensitivities(only_there, &[0.1, 0.1], 9.0).unwrap_err();
    let reason = NotDifferentiable::NoMotion(Box::new(Error::NotFree));
    assert_eq!(
        error,
        Error::NoDerivative {
            parameter: 1,
            reason
        }
    );
    // An orbit of another system.
    let system = |p: &[f64]| Ok(family(&[p[0], 0.0])?.0);
    let start = State::new(&[0.5], &[0.3]);
    let orbit = settle(&system(&[0.05]).unwrap(), &start, 50.0, Period::Free(7.0)).unwrap();
    assert!(
        orbit
            .events()
            .iter()
            .any(|event| event.kind == EventKind::Stick)
    );
    let error = orbit_sensitivities(system, &[0.1], &orbit).unwrap_err();
    assert!(matches!(error, Error::NotPeriodic { .. }), "{error}");
}

/// Central differences of a state at several increments, which agree.
#[track_caller]
fn assert_slope(found: f64, of: impl Fn(f64) -> f64, at: f64) {
    for part in [1e-4, 1e-5, 1e-6] {
        let h = part * at.abs().max(1.0);
        let slope = (of(at + h) - of(at - h)) / (2.0 * h);
        // The error of the difference is of second order, and rounding errors are some 1e-15.
        let error = (found - slope).abs();
        assert!(
            error < 1e3 * h * h * (1.0 + slope.abs()) + 1e-13 / h,
            "{found} {slope} at {h:e}"
        );
    }
}

/// Elements in parallel on one mass stick together at each turn.
#[test]
fn elements_in_parallel_have_events_at_one_instant() {
    let family = |p: &[f64]| {
        let joint = Contact::new(0, Coulomb::new(0.3, 0.3)?, 1.0)?;
        let structure = Structure::new(&[1.0])?
            .with_ground_spring(0, p[0])?
            .with_force(0, Drive::harmonic(1.0, 0.8, -std::f64::consts::FRAC_PI_2)?)?
            .with_contacts(joint.in_parallel(&[(5.0, 0.25), (2.0, 0.75)])?)?;
        Ok((structure, State::at_rest(1)))
    };
    let found = sensitivities(family, &[1.0], 8.0).unwrap();
    let events = found.events();
    let same = events
        .windows(2)
        .filter(|pair| pair[0].time == pair[1].time);
    assert!(same.count() > 0);
    let slope = found.at(8.0).unwrap()[(0, 0)];
    let end = |k: f64| {
        let (structure, start) = family(&[k]).unwrap();
        let motion = structure.simulate(start, 8.0).unwrap();
        motion.last().displacements[0]
    };
    assert_slope(slope, end, 1.0);
    assert_abs_diff_eq!(slope, 3.898047511, epsilon = 1e-9);

    // Their periodic motion, with a damper.
    let damped = |p: &[f64]| family(p)?.0.with_ground_damper(0, 0.1);
    let orbit = |k: f64| {
        let structure = damped(&[k]).unwrap();
        settle(&structure, &State::at_rest(1), 200.0, Period::Driven(1)).unwrap()
    };
    let found = orbit_sensitivities(damped, &[1.0], &orbit(1.0)).unwrap();
    let time = found.motion.times()[0];
    let there = |k: f64| {
        let motion = damped(&[k]).unwrap().simulate(orbit(k).state(), time);
        motion.unwrap().last().displacements[0]
    };
    assert_slope(found.motion.at(time).unwrap()[(0, 0)], there, 1.0);
}

/// Equal blocks stop together, and blocks of nearly equal speeds nearly so.
#[test]
fn blocks_that_stop_together_have_their_closed_form() {
    let family = |p: &[f64]| {
        let mut blocks = Structure::new(&[2.0, 2.0])?;
        for i in 0..2 {
            let contact = Contact::new(i, Coulomb::new(p[0], p[0])?, 2.0 * 9.81)?;
            blocks = blocks.with_contact(contact)?;
        }
        Ok((blocks, State::new(&[0.0, 0.0], &[p[1], p[2]])))
    };
    for apart in [0.0, 1e-13, 1e-9, -1e-9, 1e-5] {
        let [mu, speed] = [0.3, 1.5];
        let parameters = [mu, speed, speed + apart];
        let found = sensitivities(family, &parameters, 1.0).unwrap();
        let slopes = found.at(1.0).unwrap();
        for (i, own) in [speed, speed + apart].into_iter().enumerate() {
            // v²/(2μg).
            let by_mu = -own * own / (2.0 * mu * mu * 9.81);
            let by_speed = own / (mu * 9.81);
            assert_abs_diff_eq!(slopes[(i, 0)], by_mu, epsilon = 1e-9);
            assert_abs_diff_eq!(slopes[(i, 1 + i)], by_speed, epsilon = 1e-9);
            assert_abs_diff_eq!(slopes[(i, 2 - i)], 0.0, epsilon = 1e-9);
        }
        for event in found.events() {
            let expected = |j: usize| match j {
                0 => -speed / (mu * mu * 9.81),
                j if j > 0 && event.element == Element::Contact(j - 1) => 1.0 / (mu * 9.81),
                _ => 0.0,
            };
            for (j, slope) in event.by_parameters.iter().enumerate() {
                assert_abs_diff_eq!(*slope, expected(j), epsilon = 1e-4);
            }
        }
    }
}

/// A mass that a belt catches releases the joint beside it: the first example of `structure`.
#[test]
fn an_event_that_causes_another_has_a_derivative() {
    let family = |p: &[f64]| {
        let belt = Contact::new(0, Exponential::new(0.4, 0.25, 0.3)?, 1.0)?.on_belt(0.2);
        let joint = Contact::between(0, 1, Coulomb::new(0.3, 0.2)?, 0.5)?;
        let blocks = Structure::new(&[1.0, 1.0])?
            .with_ground_spring(0, p[0])?
            .with_ground_damper(0, 0.1)?
            .with_spring(0, 1, 1.2)?
            .with_force(1, Drive::harmonic(0.5, 0.8, 0.0)?)?
            .with_contact(belt)?
            .with_contact(joint)?;
        Ok((blocks, State::at_rest(2)))
    };
    let found = sensitivities(family, &[1.0], 1.0).unwrap();
    let events = found.events();
    let [stick, release] = at_least(&events);
    assert_eq!(stick.time, release.time);
    assert_eq!(stick.by_parameters, release.by_parameters);
    let slopes = found.at(1.0).unwrap();
    for i in 0..2 {
        let end = |k: f64| {
            let (structure, start) = family(&[k]).unwrap();
            let motion = structure.simulate(start, 1.0).unwrap();
            motion.last().displacements[i]
        };
        assert_slope(slopes[(i, 0)], end, 1.0);
    }
    assert_abs_diff_eq!(slopes[(1, 0)], -0.0021709, epsilon = 5e-8);
}

/// Two masses are released together from a belt, and friction falls by 0.2. A damper between them
/// makes the second one slip sooner once the first one slips: with R' = kv alone 5 units of time
/// per unit of displacement, else with R' = kv + 0.2c.
#[test]
fn events_that_hasten_each_other_have_no_derivative() {
    let family = |damping: f64| {
        move |p: &[f64]| {
            let mut masses = Structure::new(&[1.0, 1.0])?.with_damper(0, 1, damping)?;
            for i in 0..2 {
                let contact = Contact::new(i, Coulomb::new(0.5, 0.3)?, 1.0)?.on_belt(0.2);
                masses = masses.with_ground_spring(i, 1.0)?.with_contact(contact)?;
            }
            Ok((masses, State::new(&[p[0] + p[1], p[0]], &[0.2, 0.2])))
        }
    };
    let error = sensitivities(family(0.5), &[0.0, 0.0], 3.0).unwrap_err();
    let Error::NoDerivative { parameter, reason } = &error else {
        panic!("{error}")
    };
    assert_eq!(*parameter, 1);
    let NotDifferentiable::Order { time } = reason else {
        panic!("{reason}")
    };
    assert_abs_diff_eq!(*time, 2.5, epsilon = 1e-14);
    // On each side, the second release is 1/(0.2 + 0.1) later per unit of displacement.
    for (side, first, second) in [(1.0, 0, 1), (-1.0, 1, 0)] {
        let h = 1e-6 * side;
        let (masses, start) = family(0.5)(&[0.0, h]).unwrap();
        let motion = masses.simulate(start, 3.0).unwrap();
        let [a, b] = at_least(motion.events());
        assert_eq!(
            [a.contact().unwrap(), b.contact().unwrap()],
            [first, second]
        );
        assert_abs_diff_eq!((b.time - a.time) / 1e-6, 1.0 / 0.3, epsilon = 1e-4);
    }
    // If both are displaced, there is a derivative; and without the damper.
    let both = |p: &[f64]| family(0.5)(&[p[0], 0.0]);
    let found = sensitivities(both, &[0.0], 3.0).unwrap();
    for event in &found.events()[..2] {
        assert_abs_diff_eq!(event.by_parameters[0], -5.0, epsilon = 1e-9);
    }
    let found = sensitivities(family(0.0), &[0.0, 0.0], 3.0).unwrap();
    for (event, expected) in found.events()[..2].iter().zip([-5.0, 0.0]) {
        assert_abs_diff_eq!(event.by_parameters[1], expected, epsilon = 1e-9);
    }
}

/// A velocity of a mass that sticks at the start is gone after no time; the mass has moved by its
/// square.
#[test]
fn a_velocity_at_rest_has_the_derivative_of_the_motion_after_it() {
    let family = |p: &[f64]| {
        let contact = Contact::new(0, Coulomb::new(0.5, 0.3)?, 1.0)?;
        let force = Drive::profile(&[(0.0, 0.0), (4.0, 1.0)])?;
        let mass = one_mass([1.0, 0.0, 1.0], force, contact)?;
        Ok((mass, State::new(&[p[1]], &[p[0]])))
    };
    let found = sensitivities(family, &[0.0, 0.1], 3.5).unwrap();
    let slopes = found.at(3.5).unwrap();
    assert_abs_diff_eq!(slopes[(0, 0)], 0.0, epsilon = 1e-8);
    assert_abs_diff_eq!(slopes[(1, 0)], 0.0, epsilon = 1e-8);
    // Released when t/4 − q = 0.5.
    let events = found.events();
    let [release] = exactly(&events);
    assert_abs_diff_eq!(release.by_parameters[0], 0.0, epsilon = 1e-8);
    assert_abs_diff_eq!(release.by_parameters[1], 4.0, epsilon = 1e-9);
}

/// A block that slides on the ground, as a family of its friction coefficient.
fn sliding_block(friction: f64) -> Result<(Structure, State), Error> {
    let contact = Contact::new(0, Coulomb::new(friction, friction)?, 1.0)?;
    let block = Structure::new(&[1.0])?.with_contact(contact)?;
    Ok((block, State::new(&[0.0], &[1.0])))
}

/// q = t − μt²/2: a parameter whose parts underflow is one that is 0.
#[test]
fn a_parameter_within_underflow_has_the_derivative_of_zero() {
    for friction in [0.0, 5e-324, 1e-310] {
        let found = sensitivities(|p: &[f64]| sliding_block(p[0]), &[friction], 1.0).unwrap();
        let end = found.at(1.0).unwrap();
        assert_abs_diff_eq!(end[(0, 0)], -0.5, epsilon = ACCURACY);
        assert_abs_diff_eq!(end[(1, 0)], -1.0, epsilon = ACCURACY);
    }
}

/// A parameter that is small in the unit of the motion: q = t(1 + p) − t²/4.
#[test]
fn a_parameter_may_be_far_below_its_unit() {
    for value in [1e-300, 1e-100, -1e-30, 1e-12, -1e-8, 1e-6, 1e-4] {
        let family = |p: &[f64]| Ok((sliding_block(0.5)?.0, State::new(&[0.0], &[1.0 + p[0]])));
        let found = sensitivities(family, &[value], 1.0).unwrap();
        let end = found.at(1.0).unwrap();
        assert_abs_diff_eq!(end[(0, 0)], 1.0, epsilon = ACCURACY);
        assert_abs_diff_eq!(end[(1, 0)], 1.0, epsilon = ACCURACY);
    }
}

/// A mass whose largest velocity is that of the belt and a little more: it sticks for a time that
/// grows with the root of its amplitude, and then slips with the velocity of the belt as its
/// amplitude. On the other side of the parameter it slips all the time.
#[test]
fn a_stop_that_only_just_happens_has_no_derivative_of_its_time() {
    let (friction, velocity) = (0.25, 0.5);
    let family = |p: &[f64]| {
        let contact = Contact::new(0, Coulomb::new(friction, friction)?, 1.0)?.on_belt(velocity);
        let system = one_mass([1.0, 0.0, 1.0], 0.0, contact)?;
        Ok((system, State::new(&[friction + p[0]], &[0.0])))
    };
    for beyond in [1e-15, 1e-13, 1e-11] {
        let found = sensitivities(family, &[velocity * (1.0 + beyond)], 6.0).unwrap();
        let events = found.events();
        let kinds: Vec<String> = events.iter().map(|event| event.kind.to_string()).collect();
        assert_eq!(kinds, ["stick", "release (lagging)"]);
        assert!(events[0].by_parameters[0].is_nan(), "{events:?}");
        // The shortest increments are some 1e-11, and the error grows with their root.
        let end = found.at(6.0).unwrap();
        assert!(end.amax() < 1e-4, "{beyond:e}: {end}");
    }
}

/// The force of an elastic contact grows until it slips. Its derivative just before is not that of
/// the limit, which it has from then on; and just after it turns back, not that before.
#[test]
fn a_force_at_its_limit_has_the_derivative_of_the_mode_before() {
    // T = k_t v sin t up to μN, between −μN and μN.
    let (stiffness, limit) = (2.0, 0.5);
    let family = |p: &[f64]| {
        let contact = Contact::new(0, Coulomb::new(p[1], p[1])?, 1.0)?;
        let contact = contact.with_tangential_stiffness(stiffness)?;
        let system = one_mass([1.0, 0.0, 1.0 - stiffness * 0.25], 0.0, contact)?;
        Ok((system, State::new(&[0.0], &[p[0]])))
    };
    for duration in [4.0, 0.0] {
        let parameters = [0.7, limit];
        let whole = sensitivities(family, &parameters, 4.0).unwrap();
        let (release, stick) = (whole.events()[0].time, whole.events()[1].time);
        for (time, is_release) in [(release, true), (stick, false)] {
            let found = match duration {
                4.0 => whole.clone(),
                _ => sensitivities(family, &parameters, time).unwrap(),
            };
            let by = found.at(time).unwrap();
            let force = [by[(2, 0)], by[(2, 1)]];
            // T = k_t (v/ω) sin ωt with ω² = 0.5 + k_t, and then μN.
            let omega = 2.5_f64.sqrt();
            let expected = match is_release {
                true => [stiffness * (omega * time).sin() / omega, 0.0],
                false => [0.0, 1.0],
            };
            for (found, expected) in std::iter::zip(force, expected) {
                assert_abs_diff_eq!(found, expected, epsilon = 1e-9);
            }
        }
        // Just behind the turn the force falls from its limit.
        let beyond = whole.at(stick + 1e-9).unwrap();
        let mass = whole.state_at(stick).unwrap();
        assert!(mass.velocities[0].abs() < 1e-15 && mass.memory == [limit]);
        assert_abs_diff_eq!(beyond[(2, 1)], 1.0, epsilon = 1e-7);
    }
}

/// A parameter that is 0 and vanishes in the numbers that it is added to as soon as it leaves the
/// events as they are.
#[test]
fn an_increment_that_vanishes_shows_no_derivative() {
    let family = |p: &[f64]| {
        let load = if 0.4 + p[0] == 0.4 { 0.5 } else { 0.1 };
        Ok((sliding_block(load)?.0, State::new(&[0.0], &[1.0])))
    };
    let found = sensitivities(family, &[0.0], 3.0).map(|found| found.at(3.0));
    let reason = NotDifferentiable::Events { time: 2.0 };
    let parameter = 0;
    assert_eq!(found, Err(Error::NoDerivative { parameter, reason }));
}

/// Families that are not smooth at the parameter, on whichever side its value belongs.
#[test]
fn jumps_and_kinks_of_a_family_are_told() {
    type Speed = fn(f64) -> f64;
    let jumps: [Speed; 3] = [
        |p| if p > 1.0 { 1.5 } else { 1.0 },
        |p| p + if p >= 1.0 { 0.5 } else { 0.0 },
        |p| 1.0 + 0.5 * if p == 1.0 { 0.0 } else { (p - 1.0).signum() },
    ];
    let kinks: [Speed; 4] = [
        |p| 1.0 + (p - 1.0).abs(),
        |p| p + 1e-3 * (p - 1.0).max(0.0),
        |p| 1.0 + (p - 1.0).cbrt(),
        |p| 1.0 + (p - 1.0).abs().sqrt(),
    ];
    for speed in jumps.into_iter().chain(kinks) {
        for duration in [1.0, 3.0] {
            let start = |p: f64| State::new(&[0.0], &[speed(p)]);
            let family = |p: &[f64]| Ok((sliding_block(0.5)?.0, start(p[0])));
            let found = sensitivities(family, &[1.0], duration).map(|found| found.at(duration));
            let reason = NotDifferentiable::Kink;
            let kink = Error::NoDerivative {
                parameter: 0,
                reason,
            };
            assert_eq!(found, Err(kink));
        }
    }
    // Smooth functions with large derivatives of higher orders.
    let smooth: [Speed; 3] = [
        |p| 1.0 + (100.0 * (p - 1.0)).sin(),
        |p| 1.0 + (30.0 * (p - 1.0)).exp_m1(),
        |p| 1.0 / (1.0 + 300.0 * (p - 1.0).powi(2)),
    ];
    for (speed, slope) in std::iter::zip(smooth, [100.0, 30.0, 0.0]) {
        let start = |p: f64| State::new(&[0.0], &[speed(p)]);
        let family = |p: &[f64]| Ok((sliding_block(0.5)?.0, start(p[0])));
        let found = sensitivities(family, &[1.0], 1.0).unwrap();
        assert_abs_diff_eq!(
            found.at(1.0).unwrap()[(0, 0)],
            slope,
            epsilon = 1e-8 * (1.0 + slope)
        );
    }
}

/// Members of a family that have other coordinates or memory variables than the motion have no
/// difference from it.
#[test]
fn members_of_another_size_are_refused() {
    let is_refused = |found: Error, sizes: [usize; 2]| {
        let Error::NoDerivative { parameter, reason } = found else {
            panic!("{found}")
        };
        let NotDifferentiable::NoMotion(error) = reason else {
            panic!("{reason}")
        };
        let [found, expected] = sizes;
        let name = "entries of a state of the family";
        let wrong = Error::WrongSize {
            name,
            found,
            expected,
        };
        assert_eq!((parameter, *error), (0, wrong));
    };
    for (here, beside) in [(1, 2), (2, 1)] {
        let family = |p: &[f64]| {
            let n = if p[0] == 0.3 { here } else { beside };
            Ok((Structure::new(&vec![1.0; n])?, State::at_rest(n)))
        };
        let found = sensitivities(family, &[0.3], 1.0).unwrap_err();
        is_refused(found, [2 * beside, 2 * here]);
    }
    let driven = |size: f64| {
        let force = Drive::harmonic(size, 0.7, 0.0)?;
        oscillator([1.0, 0.2, 1.0], force)
    };
    let start = State::at_rest(1);
    let orbit = settle(&driven(0.5).unwrap(), &start, 50.0, Period::Driven(1)).unwrap();
    let family = |p: &[f64]| {
        let contact = Contact::new(0, Coulomb::new(0.1, 0.1)?, 1.0)?;
        let system = driven(p[0])?;
        match p[0] {
            0.5 => Ok(system),
            _ => system.with_contact(contact.with_tangential_stiffness(1.0)?),
        }
    };
    is_refused(
        orbit_sensitivities(family, &[0.5], &orbit).unwrap_err(),
        [3, 2],
    );
    // Other contacts without memory are other motions.
    let family = |p: &[f64]| {
        let system = driven(p[0])?;
        match p[0] {
            0.5 => Ok(system),
            _ => system.with_contact(Contact::new(0, Coulomb::new(0.1, 0.1)?, 1.0)?),
        }
    };
    assert!(orbit_sensitivities(family, &[0.5], &orbit).is_err());
}

/// A bead on a horizontal ring, v' = −μv²/R: derivatives of the closed form by μ, R and the start,
/// where R is a number of the load law.
#[test]
fn a_bead_on_a_ring_has_the_derivatives_of_its_closed_form() {
    struct Ring(f64);
    impl ForceLaw for Ring {
        fn force<S: Scalar>(&self, _: S, velocity: S, _: usize) -> S {
            velocity.square() / self.0
        }
    }
    let (mu, radius, v0, t) = (0.3, 2.0, 3.0, 7.0);
    let family = |p: &[f64]| {
        let contact = Contact::new(0, Coulomb::new(p[0], p[0])?, 0.0)?;
        let contact = contact.with_load_law(&[(0, 1.0)], Ring(p[1]))?;
        let bead = Structure::new(&[1.0])?.with_contact(contact)?;
        Ok((bead, State::new(&[0.0], &[p[2]])))
    };
    let found = sensitivities(family, &[mu, radius, v0], t).unwrap();
    let found = found.at(t).unwrap();
    // s = (R/μ) ln D, v = v0/D, D = 1 + μ v0 t/R.
    let d = 1.0 + mu * v0 * t / radius;
    let by_d = [
        v0 * t / radius,
        -mu * v0 * t / (radius * radius),
        mu * t / radius,
    ];
    let scale = radius / mu;
    let by_scale = [-scale / mu, 1.0 / mu, 0.0];
    for j in 0..3 {
        let place = by_scale[j] * d.ln() + scale * by_d[j] / d;
        let speed = f64::from(u8::from(j == 2)) / d - v0 * by_d[j] / (d * d);
        assert_abs_diff_eq!(found[(0, j)], place, epsilon = ACCURACY * 10.0);
        assert_abs_diff_eq!(found[(1, j)], speed, epsilon = ACCURACY * 10.0);
    }
}

/// Rate-and-state friction turns within an instant where its contact changes its direction: beyond
/// 1e-9 of it no series converges. Compared with plain differences of eighth order.
#[test]
fn a_creeping_contact_that_turns_has_derivatives() {
    let family = |p: &[f64]| -> Result<(Structure, State), Error> {
        let law = RateState::aging(0.545, p[1], 0.05, 0.0129, 0.231)?;
        let contact = Contact::new(0, law, 0.32)?.on_belt(p[0]);
        let mass = one_mass([1.0, 0.0893, 1.57], 0.0, contact)?;
        Ok((mass, State::new(&[0.166], &[0.112]).with_memory(&[0.094])))
    };
    let at = [0.081, 0.027];
    let found = sensitivities(family, &at, 1.37).unwrap();
    let [turn] = &found.events()[..] else {
        panic!()
    };
    assert!(matches!(turn.kind, EventKind::Crossing(_)));
    let end = |p: &[f64], time: f64| {
        let (mass, start) = family(p).unwrap();
        vector(&mass.simulate(start, time).unwrap().last())
    };
    // The increment moves the event by less than the distance of the time from it.
    let times = [
        (turn.time - 1e-4, 1e-5),
        (turn.time + 1e-4, 1e-5),
        (turn.time + 0.03, 1e-3),
        (1.37, 1e-3),
    ];
    for (time, increment) in times {
        let slopes = found.at(time).unwrap();
        for parameter in 0..2 {
            let h = increment * at[parameter];
            let beside = |count: f64| {
                let mut p = at;
                p[parameter] += count * h;
                end(&p, time)
            };
            let pair = |count: f64| beside(count) - beside(-count);
            let slope = (pair(1.0) * 672.0 - pair(2.0) * 168.0 + pair(3.0) * 32.0
                - pair(4.0) * 3.0)
                / (840.0 * h);
            let apart = (slopes.column(parameter) - &slope).amax() / slope.amax();
            let allowed = if increment < 1e-3 { 1e-7 } else { 1e-9 };
            assert!(apart < allowed, "{time} {parameter}: {apart:e}");
        }
    }
}
