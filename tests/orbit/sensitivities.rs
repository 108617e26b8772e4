//! Derivatives of motions, events and orbits by parameters: closed forms, the monodromy matrix, and
//! neighbouring orbits.

use approx::assert_abs_diff_eq;
use stick_slip::nalgebra::DMatrix;
use stick_slip::orbit::{Oscillator, Period, orbit_sensitivities, sensitivities, settle, shoot};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Drive, Error, EventKind, Exponential, MassOnBelt, Mode, Polynomial, Structure,
};

use crate::common::text;
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
        let system = Structure::new(&[mass])?
            .with_ground_spring(0, p[2])?
            .with_contact(contact)?;
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
        let map = system.form().period_map(&state, duration).unwrap();
        let exact: DMatrix<f64> = map.monodromy().columns(0, 2 * n).into();
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
        Structure::new(&[1.0])?
            .with_ground_spring(0, 1.0)?
            .with_ground_damper(0, p[2])?
            .with_force(0, Drive::harmonic(p[1], p[0], 0.0)?)?
            .with_contact(Contact::new(0, Coulomb::new(p[3], p[4])?, 1.5)?.on_belt(0.1))
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
            let nearest = |orbit: &stick_slip::orbit::Orbit<Structure>| {
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

#[test]
fn parameters_without_a_derivative_are_named() {
    let family = |p: &[f64]| {
        let law = Exponential::new(0.4, 0.25, 0.5)?;
        let contact = Contact::new(0, law, 1.0)?.on_belt(0.3);
        let system = Structure::new(&[1.0])?
            .with_ground_spring(0, 1.0)?
            .with_ground_damper(0, p[0])?
            .with_contact(contact)?;
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
    assert_eq!(error, Error::NoDerivative { parameter: 1 });
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
