//! Periodic motions, attractors and bifurcations of structures with first-order states.

use std::f64::consts::TAU;

use stick_slip::bifurcation::hopf_locus;
use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::orbit::{self, AttractorKind, BifurcationKind, Orbit, Period};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Drive, Error, Exponential, FirstOrder, ForceElement, PolynomialSpring,
    Structure,
};

use crate::common::orbit::monodromy;
use crate::common::{Random, count};

/// A mass of 1 under position control against stiction.
fn servo(proportional: f64, derivative: f64, integral: f64) -> Result<Structure, Error> {
    let integrator = FirstOrder::integrator()
        .with_displacement(0, 1.0)?
        .with_force(0, -integral)?;
    Structure::new(&[1.0])?
        .with_ground_spring(0, proportional)?
        .with_ground_damper(0, derivative)?
        .with_first_order(integrator)?
        .with_contact(Contact::new(0, Coulomb::new(0.75, 0.5)?, 100.0)?)
}

/// The hunting of a servo from 0.3 off its target.
fn hunting(integral: f64) -> Orbit<State> {
    let servo = servo(100.0, 20.0, integral).unwrap();
    let start = State::new(&[0.3], &[0.0]);
    orbit::settle(&servo, &start, 60.0, Period::Free(4.7)).unwrap()
}

/// Amplitude and period of another program, which joins matrix exponentials at the events.
#[test]
fn a_servo_hunts() {
    let orbit = hunting(500.0);
    let (least, largest) = orbit.extremes(0);
    assert!((largest - 0.1234006199725).abs() < 1e-13, "{largest}");
    assert!((least + 0.1234006199725).abs() < 1e-13, "{least}");
    assert!(
        (orbit.period() - 4.68909349795808).abs() < 1e-12,
        "{}",
        orbit.period()
    );
    assert!(orbit.is_stable());
    assert_eq!(orbit.events().len(), 4);
    // 2 + 1 numbers, without the one along the flow.
    assert_eq!(orbit.multipliers().len(), 2);
    let servo = servo(100.0, 20.0, 500.0).unwrap();
    let attractor = orbit::classify(&servo, &State::new(&[0.3], &[0.0])).unwrap();
    assert_eq!(attractor.kind(), AttractorKind::StickSlip);
    // Over a period the controller's springs and damper and friction take what the integral gives.
    let energy = orbit.energy();
    assert!(energy.defect().abs() < 1e-11, "{energy:?}");
    assert!(energy.first_order_work[0] > 1.0);
}

/// Without an integral there is nothing to hunt: the mass rests where it stops. A slow integral
/// makes the mass wait, but not for ever.
#[test]
fn a_mass_that_waits_for_its_integral_is_not_at_rest() {
    let start = State::new(&[0.3], &[0.0]);
    let still = orbit::classify(&servo(100.0, 20.0, 0.0).unwrap(), &start).unwrap();
    assert_eq!(still.kind(), AttractorKind::Rest);
    let waiting = servo(100.0, 20.0, 0.5).unwrap();
    let attractor = orbit::classify(&waiting, &State::new(&[0.12], &[0.0])).unwrap();
    assert_ne!(attractor.kind(), AttractorKind::Rest);
}

/// Derivatives of the period by the gains, against differences.
#[test]
fn hunting_has_derivatives_by_the_gains() {
    let start = hunting(500.0);
    let family = |p: &[f64]| servo(p[0], p[1], p[2]);
    let gains = [100.0, 20.0, 500.0];
    let found = orbit::orbit_sensitivities(family, &gains, &start).unwrap();
    for (k, gain) in gains.into_iter().enumerate() {
        let h = 1e-5 * gain;
        let period = |change: f64| {
            let mut p = gains;
            p[k] += change;
            let servo = servo(p[0], p[1], p[2]).unwrap();
            let start = State::new(&[0.3], &[0.0]);
            orbit::settle(&servo, &start, 60.0, Period::Free(4.7))
                .unwrap()
                .period()
        };
        let slope = (period(h) - period(-h)) / (2.0 * h);
        let by = found.period[k];
        assert!(
            (by - slope).abs() < 1e-7 * slope.abs().max(1e-3),
            "{k}: {by} {slope}"
        );
    }
}

/// A mass on a belt whose damper is a Maxwell element, with a filtered force that follows the
/// displacement, and a drive.
fn filtered(p: [f64; 3], amplitude: f64) -> Result<Structure, Error> {
    let [maxwell, gain, speed] = p;
    let damper = FirstOrder::lag(0.4)?
        .with_velocity(0, maxwell)?
        .with_force(0, -1.0)?;
    let filter = FirstOrder::lag(0.7)?
        .with_displacement(0, 1.0)?
        .with_velocity(1, 0.2)?
        .with_state(0, 0.3)?
        .with_force(1, gain)?
        .with_force(0, -0.5 * gain)?;
    let law = Exponential::new(0.4, 0.25, 0.3)?;
    Structure::new(&[1.0, 0.7])?
        .with_ground_spring(0, 1.0)?
        .with_ground_spring(1, 0.6)?
        .with_spring(0, 1, 0.8)?
        .with_ground_damper(1, 0.05)?
        .with_force(1, Drive::sine(amplitude, 1.1)?)?
        .with_first_orders([damper, filter])?
        .with_contact(Contact::new(0, law, 1.0)?.on_belt(speed))?
        .with_contact(Contact::between(0, 1, Coulomb::new(0.3, 0.2)?, 0.3)?)
}

/// The same with velocities of further coordinates in place of the states.
fn with_coordinates(p: [f64; 3], amplitude: f64) -> Result<Structure, Error> {
    let [maxwell, gain, speed] = p;
    let [a, b] = [1.0 / 0.4, 1.0 / 0.7];
    let law = Exponential::new(0.4, 0.25, 0.3)?;
    let mut stiffness = DMatrix::zeros(4, 4);
    stiffness[(3, 0)] = -b;
    let mut damping = DMatrix::zeros(4, 4);
    for (i, j, entry) in [
        (2, 0, -a * maxwell),
        (2, 2, a),
        (0, 2, 1.0),
        (3, 1, -0.2 * b),
        (3, 2, -0.3 * b),
        (3, 3, b),
        (1, 3, -gain),
        (0, 3, 0.5 * gain),
    ] {
        damping[(i, j)] = entry;
    }
    Structure::new(&[1.0, 0.7, 1.0, 1.0])?
        .with_ground_spring(0, 1.0)?
        .with_ground_spring(1, 0.6)?
        .with_spring(0, 1, 0.8)?
        .with_ground_damper(1, 0.05)?
        .with_stiffness(stiffness)?
        .with_damping(damping)?
        .with_force(1, Drive::sine(amplitude, 1.1)?)?
        .with_contact(Contact::new(0, law, 1.0)?.on_belt(speed))?
        .with_contact(Contact::between(0, 1, Coulomb::new(0.3, 0.2)?, 0.3)?)
}

#[test]
fn multipliers_are_those_of_coordinates_in_place_of_states() {
    let mut random = Random::new(514);
    let mut compared = 0;
    for _ in 0..count(6, 40) {
        let p = [
            random.uniform(0.05, 0.3),
            random.uniform(-0.2, 0.2),
            random.uniform(0.1, 0.4),
        ];
        let amplitude = random.uniform(0.3, 0.8);
        let one = filtered(p, amplitude).unwrap();
        let other = with_coordinates(p, amplitude).unwrap();
        let found = orbit::settle(&one, &State::at_rest(2), 300.0, Period::Driven(1));
        let expected = orbit::settle(&other, &State::at_rest(4), 300.0, Period::Driven(1));
        let (Ok(found), Ok(expected)) = (found, expected) else {
            continue;
        };
        compared += 1;
        let multipliers = [found.multipliers(), expected.multipliers()];
        assert_eq!(multipliers[0].len(), 6);
        assert!(multipliers[1].len() >= 6, "{multipliers:?}");
        for (a, b) in multipliers[0].iter().zip(multipliers[1]) {
            assert!((a - b).norm() < 1e-9, "{multipliers:?}");
        }
        for i in 0..2 {
            let apart = found.extremes(i).1 - expected.extremes(i).1;
            assert!(apart.abs() < 1e-11, "{apart:e}");
        }
        assert_eq!(found.events().len(), expected.events().len());
        assert!(found.energy().defect().abs() < 1e-12);
    }
    assert!(compared > 3, "{compared}");
}

/// A law in the rate of a state: z' = −z − z³ + q, whose force acts on the mass; and a law of a
/// direction.
fn nonlinear() -> Structure {
    let cubic = PolynomialSpring::new(&[-0.5, 0.0, -1.0]).unwrap();
    let saturating = PolynomialSpring::new(&[0.8, 0.1, -0.05]).unwrap();
    let law = Exponential::new(0.4, 0.25, 0.3).unwrap();
    let hard = PolynomialSpring::new(&[0.0, 0.0, 0.3]).unwrap();
    Structure::new(&[1.0])
        .and_then(|s| s.with_ground_spring(0, 1.0))
        .and_then(|s| s.with_element(ForceElement::new(0, hard)?))
        .and_then(|s| {
            let state = FirstOrder::lag(0.8)?
                .with_law_of_state(0, cubic)?
                .with_law(&[(0, 1.0)], saturating)?
                .with_force(0, -0.4)?;
            s.with_first_order(state)
        })
        .and_then(|s| s.with_contact(Contact::new(0, law, 1.0)?.on_belt(0.25)))
        .unwrap()
}

/// Central differences of simulated motions through stick and slip.
#[test]
fn monodromy_is_the_derivative_of_the_period_map() {
    let forced = filtered([0.1, 0.2, 0.2], 0.5).unwrap();
    let servo = servo(100.0, 20.0, 500.0).unwrap();
    let cases: [(&str, Structure, State, f64); 3] = [
        (
            "filtered",
            forced,
            State::new(&[0.3, 0.1], &[0.1, -0.1]).with_memory(&[0.02, 0.2]),
            7.0,
        ),
        (
            "nonlinear",
            nonlinear(),
            State::new(&[0.1], &[-0.2]).with_memory(&[0.3]),
            9.0,
        ),
        (
            "servo",
            servo,
            State::new(&[0.2], &[-0.1]).with_memory(&[0.05]),
            5.0,
        ),
    ];
    for (name, structure, start, duration) in cases {
        let (steps, matrix) = monodromy(&structure, &start, duration).unwrap();
        let events: usize = steps
            .iter()
            .map(|s| stick_slip::Segment::events(s).len())
            .sum();
        assert!(events > 1, "{name}: {events}");
        let n = start.displacements.len();
        let numbers =
            |state: &State| [&state.displacements[..], &state.velocities, &state.memory].concat();
        let at = numbers(&start);
        let size = matrix.amax().max(1.0);
        for j in 0..at.len() {
            let end = |change: f64| {
                let mut at = at.clone();
                at[j] += change;
                let start = State::new(&at[..n], &at[n..2 * n]).with_memory(&at[2 * n..]);
                numbers(&structure.simulate(start, duration).unwrap().last())
            };
            let h = 1e-5;
            let (low, high) = (end(-h), end(h));
            for i in 0..at.len() {
                let slope = (high[i] - low[i]) / (2.0 * h);
                let found = matrix[(i, j)];
                assert!(
                    (found - slope).abs() < 1e-6 * size,
                    "{name} ({i}, {j}): {found} {slope}"
                );
            }
        }
    }
}

/// v' = −k x − c v − z, T z' = x − z: with Routh's criterion, and a curve of Hopf points.
#[test]
fn hopf_points_are_those_of_routh() {
    let sliding = |k: f64, gain: f64| -> Result<Structure, Error> {
        let lag = FirstOrder::lag(0.5)?
            .with_displacement(0, gain)?
            .with_force(0, 1.0)?;
        Structure::new(&[1.0])?
            .with_ground_spring(0, k)?
            .with_ground_damper(0, 0.2)?
            .with_first_order(lag)?
            .with_contact(Contact::new(0, Coulomb::new(0.3, 0.3)?, 1.0)?.on_belt(50.0))
    };
    // s³ + (c + 1/T) s² + (k + c/T) s + (k − g)/T: (c + 1/T)(k + c/T) = (k − g)/T.
    let (c, rate) = (0.2, 2.0);
    let critical = |k: f64| k - (c + rate) * (k + c * rate) / rate;
    let growth = |gain: f64| {
        sliding(3.0, gain)
            .unwrap()
            .steady_sliding()
            .unwrap()
            .eigenvalues[0]
            .re
    };
    let gain = critical(3.0);
    assert!(growth(gain).abs() < 1e-13);
    assert!(growth(gain - 1e-3) > 0.0 && growth(gain + 1e-3) < 0.0);
    let curves = hopf_locus(sliding, [2.0..4.0, -3.0..1.0]).unwrap();
    let [curve] = &curves[..] else {
        panic!("{curves:?}")
    };
    assert!(curve.points.len() > 2);
    for point in &curve.points {
        let [k, g] = point.parameters;
        assert!((g - critical(k)).abs() < 1e-11, "{k} {g}");
        let frequency = (k + c * rate).sqrt();
        assert!((point.frequency - frequency).abs() < 1e-11);
    }
}

/// A belt whose mass is held by an integral alone: K = 0, and the motion stays where it is told.
#[test]
fn an_integral_is_no_translation() {
    let law = Exponential::new(0.4, 0.25, 0.3).unwrap();
    let integral = FirstOrder::lag(0.05)
        .and_then(|s| s.with_displacement(0, 1.0))
        .and_then(|s| s.with_velocity(0, 0.05))
        .and_then(|s| s.with_force(0, -1.0))
        .unwrap();
    // T z' + z = x + T v has z = x but for what decays: a spring.
    let held = Structure::new(&[1.0])
        .and_then(|s| s.with_first_order(integral))
        .and_then(|s| s.with_contact(Contact::new(0, law, 1.0)?.on_belt(0.2)))
        .unwrap();
    let spring = Structure::new(&[1.0])
        .and_then(|s| s.with_ground_spring(0, 1.0))
        .and_then(|s| s.with_contact(Contact::new(0, law, 1.0)?.on_belt(0.2)))
        .unwrap();
    let start = State::at_rest(1);
    let [found, expected] =
        [&held, &spring].map(|s| orbit::settle(s, &start, 100.0, Period::Free(TAU)).unwrap());
    assert!((found.period() - expected.period()).abs() < 1e-12);
    let apart = found.extremes(0).1 - expected.extremes(0).1;
    assert!(apart.abs() < 1e-12, "{apart:e}");
    // The difference of z and x decays by e^(−t/T).
    let decay = (-found.period() / 0.05).exp();
    let multipliers = found.multipliers();
    assert_eq!(multipliers.len(), 2);
    assert!(
        multipliers.iter().any(|m| (m - decay).norm() < 1e-12),
        "{multipliers:?}"
    );
}

/// The branch of hunting over the integral gain: its phase condition is the turning point of the
/// integral, because the mass turns nowhere, but stops.
#[test]
fn hunting_is_followed_over_the_gain() {
    let start = hunting(500.0);
    let family = |integral: f64| servo(100.0, 20.0, integral);
    let branch = orbit::follow(family, 500.0, &start, 300.0..1500.0).unwrap();
    let amplitude = |gain: f64| {
        let near = |point: &&orbit::BranchPoint<State>| (point.parameter - gain).abs() < 1e-9;
        let point = branch.points.iter().find(near);
        point
            .unwrap_or_else(|| panic!("{:?}", branch.ends))
            .orbit
            .extremes(0)
            .1
    };
    assert!((amplitude(300.0) - hunting(300.0).extremes(0).1).abs() < 1e-11);
    // Of the other program.
    assert!((amplitude(1500.0) - 0.1704933613143485).abs() < 1e-11);
    assert!(
        branch.bifurcations.is_empty(),
        "{:?}",
        branch.bifurcations.len()
    );
}

/// e^A by its series and ten squarings.
fn exponential(a: DMatrix<f64>) -> DMatrix<f64> {
    let (part, n) = (a / 1024.0, 3);
    let mut term = DMatrix::identity(n, n);
    let mut sum = term.clone();
    for k in 1..=20 {
        term = &term * &part / f64::from(k);
        sum += &term;
    }
    (0..10).fold(sum, |power, _| &power * &power)
}

/// Hunting outlives the stability of the control loop, which ends at 100·20 = 2000. It ends where
/// the mass no longer sticks at its turning points: the branch turns back there, as a motion
/// without a stop, beyond which motions grow.
///
/// This border as the solution of three equations: in half a period, with friction of 50, x and its
/// integral change their signs, and at its turning point the mass is just held by 75.
#[test]
fn hunting_ends_where_the_mass_no_longer_stops() {
    let family = |integral: f64| servo(100.0, 20.0, integral);
    let start = State::new(&[0.3], &[0.0]);
    let hunting = orbit::settle(&family(2300.0).unwrap(), &start, 60.0, Period::Free(0.8)).unwrap();
    let branch = orbit::follow(family, 2300.0, &hunting, 2200.0..3000.0).unwrap();
    let [change] = &branch.bifurcations[..] else {
        panic!("{:?}", branch.bifurcations)
    };
    assert_eq!(change.kind, BifurcationKind::Sequence);
    let largest = branch.points.iter().map(|point| point.parameter);
    assert!(largest.fold(0.0, f64::max) <= change.parameter);
    let both_sides = branch.points.iter().map(|point| {
        let stops = point.orbit.events().len() == 4;
        assert_eq!(stops, point.orbit.is_stable(), "{}", point.parameter);
        stops
    });
    let both_sides: Vec<bool> = both_sides.collect();
    assert!(both_sides.contains(&true) && both_sides.contains(&false));

    // The turning point, half the period and the gain; (x, v, z + 50/K) has no constant force.
    let residual = |[x, half, gain]: [f64; 3]| {
        let loop_ =
            DMatrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, -100.0, -20.0, -gain, 1.0, 0.0, 0.0]);
        let begin = DVector::from_row_slice(&[x, 0.0, -(100.0 * x + 25.0) / gain]);
        let end = exponential(loop_ * half) * &begin;
        let turned = DVector::from_row_slice(&[-x, 0.0, 100.0 / gain - begin[2]]);
        end - turned
    };
    let mut found = [-1.1, 0.33, 2400.0];
    for _ in 0..20 {
        let at = residual(found);
        let columns = [0, 1, 2].map(|k| {
            let h = 1e-6 * found[k];
            let mut beside = found;
            beside[k] += h;
            (residual(beside) - &at) / h
        });
        let step = DMatrix::from_columns(&columns).lu().solve(&at).unwrap();
        for (number, step) in found.iter_mut().zip(&step) {
            *number -= step;
        }
    }
    let [x, half, gain] = found;
    assert!(
        (change.parameter - gain).abs() < 1e-6 * gain,
        "{} {gain}",
        change.parameter
    );
    let at = &change.orbit;
    assert!(
        (at.period() - 2.0 * half).abs() < 1e-6,
        "{} {half}",
        at.period()
    );
    assert!(
        (at.amplitude(0) + x).abs() < 1e-5,
        "{} {x}",
        at.amplitude(0)
    );

    // Motions on both sides, from the same start.
    let farthest = |gain: f64| {
        let motion = family(gain)
            .unwrap()
            .simulate(State::new(&[1.0], &[0.0]), 60.0)
            .unwrap();
        let late = motion.events().iter().filter(|event| event.time > 50.0);
        late.map(|event| event.state.displacements[0].abs())
            .fold(0.0, f64::max)
    };
    assert!(farthest(2390.0) < 1.0 && farthest(2420.0) > 10.0);
}

/// A Maxwell element, c x' = z + T z', beside a mass that sticks or slides steadily: its force
/// decays below every number.
#[test]
fn a_force_that_decays_is_at_rest() {
    let machine = |time: f64, belt: f64| {
        let element = FirstOrder::lag(time)?
            .with_velocity(0, 0.2)?
            .with_force(0, -1.0)?;
        Structure::new(&[1.0])?
            .with_ground_spring(0, 1.0)?
            .with_first_order(element)?
            .with_contact(Contact::new(0, Coulomb::new(0.3, 0.3)?, 1.0)?.on_belt(belt))
    };
    let start = State::new(&[1.0], &[0.0]);
    for i in 0..40 {
        let time = 0.05 * 1.1_f64.powi(i);
        for (belt, kind) in [
            (0.0, AttractorKind::Rest),
            (0.5, AttractorKind::SteadySliding),
        ] {
            let system = machine(time, belt).unwrap();
            let attractor = orbit::classify(&system, &start).unwrap();
            assert_eq!(attractor.kind(), kind, "{time} {belt}");
        }
        let sticks = machine(time, 0.0).unwrap();
        let motion = sticks.simulate(start.clone(), 1500.0 * time).unwrap();
        assert!(motion.last().memory[0].abs() < 1e-300, "{time}");
    }
}

/// A state that only decays, beside a mass that vibrates: its value in the periodic motion is 0.
#[test]
fn a_state_that_decays_does_not_hide_a_periodic_motion() {
    let contact = || {
        let law = Exponential::new(0.4, 0.25, 0.5)?;
        Ok::<_, Error>(Contact::new(0, law, 1.0)?.on_belt(0.2))
    };
    let plain = || {
        Structure::new(&[1.0])?
            .with_ground_spring(0, 1.0)?
            .with_ground_damper(0, 0.1)?
            .with_contact(contact()?)
    };
    let settled = |system: &Structure, start: &State, transient: f64| {
        orbit::settle(system, start, transient, Period::Free(6.43)).unwrap()
    };
    let cycle = settled(&plain().unwrap(), &State::at_rest(1), 400.0);
    for (time, force) in [(0.5, 0.1), (1.0, 0.1), (5.0, 0.1), (5.0, 0.0), (20.0, 0.1)] {
        let state = FirstOrder::lag(time).unwrap().with_force(0, force).unwrap();
        let system = plain().unwrap().with_first_order(state).unwrap();
        for memory in [0.0, 0.05] {
            let start = State::at_rest(1).with_memory(&[memory]);
            for transient in [100.0, 400.0, 3000.0] {
                let found = settled(&system, &start, transient);
                let apart = (found.period() - cycle.period()).abs();
                assert!(apart < 1e-12, "{time} {memory} {transient}: {apart:e}");
                assert!(
                    found.state().memory[0].abs() < 1e-15,
                    "{time} {memory} {transient}"
                );
            }
            let attractor = orbit::classify(&system, &start).unwrap();
            assert_eq!(
                attractor.kind(),
                AttractorKind::StickSlip,
                "{time} {memory}"
            );
        }
    }
}
