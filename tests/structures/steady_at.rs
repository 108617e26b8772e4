//! Steady sliding at given velocities, with rigid-body modes left out.

use stick_slip::nalgebra::{Complex, DMatrix};
use stick_slip::structure::{NotSliding, State, SteadySliding};
use stick_slip::{
    Contact, Coulomb, Drive, Error, Exponential, FirstOrder, FrictionLaw, LuGre, Structure,
};

use crate::common::property::for_all;

use crate::common::{exactly, larger, refused};

fn falling() -> Exponential {
    Exponential::new(0.35, 0.3, 2.0).unwrap()
}

/// The largest distance of an eigenvalue in one list from the nearest in the other.
fn apart(a: &[Complex<f64>], b: &[Complex<f64>]) -> f64 {
    let from = |a: &[Complex<f64>], b: &[Complex<f64>]| {
        let nearest = |x: &Complex<f64>| b.iter().map(|y| (x - y).norm()).fold(1e300, f64::min);
        a.iter().map(nearest).fold(0.0, larger)
    };
    from(a, b).max(from(b, a))
}

/// The Jacobian of displacements and velocities at a state, by central differences of the
/// accelerations that the engine computes.
fn jacobian(system: &Structure, state: &State) -> DMatrix<f64> {
    const STEP: f64 = 1e-5;
    let n = system.len();
    let rates = |k: usize, by: f64| {
        let mut state = state.clone();
        match k.checked_sub(n) {
            None => state.displacements[k] += by,
            Some(k) => state.velocities[k] += by,
        }
        let accelerations = system.acceleration(0.0, &state).unwrap();
        [state.velocities, accelerations].concat()
    };
    let columns = (0..2 * n).map(|k| [rates(k, STEP), rates(k, -STEP)]);
    let columns: Vec<[Vec<f64>; 2]> = columns.collect();
    DMatrix::from_fn(2 * n, 2 * n, |i, k| {
        (columns[k][0][i] - columns[k][1][i]) / (2.0 * STEP)
    })
}

/// Free chains of three masses with full mass matrices, loads that depend on twists, on belts and
/// with joints, all slipping: the eigenvalues are those of the Jacobian without its zeros, and the
/// accelerations those of the engine.
#[test]
fn eigenvalues_are_those_of_the_equations_without_zeros() {
    for_all(
        200,
        [0.2..3.0, 0.2..3.0, 0.1..5.0, 0.0..0.3, 0.3..2.0, -0.4..0.4],
        |[mass, other, stiffness, damping, speed, tilt]| {
            let coupled = 0.2 * mass.min(other);
            let mass = DMatrix::from_row_slice(
                3,
                3,
                &[mass, coupled, 0.0, coupled, other, 0.0, 0.0, 0.0, 1.0],
            );
            let belt = Contact::new(2, falling(), 1.0)
                .unwrap()
                .on_belt(3.0 * speed);
            let belt = belt.with_load_gradient(0, tilt).unwrap();
            let belt = belt.with_load_gradient(1, -tilt).unwrap();
            let joint = Contact::between(1, 2, falling(), 0.7).unwrap();
            let system = Structure::with_mass_matrix(mass)
                .and_then(|s| s.with_spring(0, 1, stiffness)?.with_damper(0, 1, damping))
                .and_then(|s| s.with_contact(belt)?.with_contact(joint))
                .unwrap();
            // Masses 0 and 1 move together, mass 2 alone.
            let velocities = [speed, speed, -speed];
            let found = system.steady_sliding_at(&velocities).unwrap();
            let state = State::new(&found.displacements, &velocities);
            let accelerations = system.acceleration(0.0, &state).unwrap();
            for (found, expected) in std::iter::zip(&found.accelerations, accelerations) {
                assert!((found - expected).abs() < 1e-11, "{found} {expected}");
            }
            let all = jacobian(&system, &state).complex_eigenvalues();
            let all: Vec<Complex<f64>> = all.iter().copied().collect();
            // Two displacements without a force; dampers see every velocity.
            assert_eq!(found.eigenvalues.len(), 4);
            let near_zero = |s: &&Complex<f64>| s.norm() < 1e-4;
            assert!(all.iter().filter(near_zero).count() >= 2, "{all:?}");
            for s in &found.eigenvalues {
                let nearest = all.iter().map(|x| (x - s).norm()).fold(1e300, f64::min);
                // Rounding of differences, 1e-10, and its root where eigenvalues nearly meet.
                assert!(nearest < 1e-4, "{s} {all:?}");
            }
            // The trace is the sum of all, with the zeros.
            let trace = jacobian(&system, &state).trace();
            let sum: Complex<f64> = found.eigenvalues.iter().sum();
            assert!((sum.re - trace).abs() < 1e-8 && sum.im.abs() < 1e-12);
            Ok(())
        },
    );
}

/// With surfaces that move and springs that hold, it is steady sliding; in a frame that moves at a
/// constant velocity nothing changes.
#[test]
fn at_rest_it_is_steady_sliding_and_frames_do_not_matter() {
    let chain = |held: bool, shift: f64| {
        let mut chain = Structure::new(&[1.0, 0.5, 2.0]).unwrap();
        for i in 0..2 {
            chain = chain.with_spring(i, i + 1, 1.0 + i as f64).unwrap();
        }
        if held {
            chain = chain.with_ground_spring(0, 2.0).unwrap();
        }
        for i in 0..3 {
            let contact = Contact::new(i, falling(), 1.0 + 0.1 * i as f64).unwrap();
            chain = chain.with_contact(contact.on_belt(0.5 + shift)).unwrap();
        }
        chain
    };
    let one = chain(true, 0.0).steady_sliding().unwrap();
    let other = chain(true, 0.0).steady_sliding_at(&[0.0; 3]).unwrap();
    for (one, other) in std::iter::zip(&one.displacements, &other.displacements) {
        assert!((one - other).abs() < 1e-14);
    }
    assert!(apart(&one.eigenvalues, &other.eigenvalues) < 1e-13);
    assert_eq!(other.accelerations, [0.0; 3]);
    let still = chain(false, 0.0).steady_sliding_at(&[0.0; 3]).unwrap();
    // The displacement as a whole has no eigenvalue, its velocity has.
    assert_eq!(still.eigenvalues.len(), 5);
    let moves = chain(false, 1.25).steady_sliding_at(&[1.25; 3]).unwrap();
    assert!(apart(&still.eigenvalues, &moves.eigenvalues) < 1e-13);
    // The mean displacement is 0 in units of energy, and the belts push all masses on.
    let total: f64 = std::iter::zip([1.0, 0.5, 2.0], &moves.accelerations)
        .map(|(m, a)| m * a)
        .sum();
    let force = falling().coefficient(0.5) * 3.3;
    assert!((total - force).abs() < 1e-14, "{total} {force}");
}

/// A clutch that is locked, between a motor and a load with a spring: rigid, the two inertias are
/// one; elastic, it is a spring. The torque that it carries accelerates the load.
#[test]
fn contacts_without_relative_velocity_stick() {
    let [motor, gear, load, shaft, torque] = [0.4, 0.1, 2.0, 50.0, 1.5];
    let driven = |stiffness: Option<f64>, pressed: f64| {
        let clutch = Contact::between(0, 1, Coulomb::new(0.5, 0.5).unwrap(), pressed).unwrap();
        let clutch = match stiffness {
            Some(stiffness) => clutch.with_tangential_stiffness(stiffness).unwrap(),
            None => clutch,
        };
        Structure::new(&[motor, gear, load])
            .and_then(|s| s.with_spring(1, 2, shaft)?.with_force(0, torque))
            .and_then(|s| s.with_contact(clutch))
            .unwrap()
    };
    let turns = [3.0, 3.0, 3.0];
    let check = |found: &SteadySliding, squares: &[f64]| {
        // Undamped: real parts are exactly 0, and each frequency has both signs.
        let roots = squares.iter().map(|x| x.sqrt());
        let expected = roots.flat_map(|w| [w, -w]).map(|w| Complex::new(0.0, w));
        let expected: Vec<_> = expected.collect();
        assert_eq!(found.eigenvalues.len(), expected.len());
        assert!(apart(&found.eigenvalues, &expected) < 1e-12, "{found:?}");
        let acceleration = torque / (motor + gear + load);
        for found in &found.accelerations {
            assert!((found - acceleration).abs() < 1e-14);
        }
        // The shaft accelerates the load.
        let twist = found.displacements[1] - found.displacements[2];
        assert!((shaft * twist - load * acceleration).abs() < 1e-13);
    };
    let rigid = driven(None, 10.0).steady_sliding_at(&turns).unwrap();
    check(&rigid, &[shaft / (motor + gear) + shaft / load]);
    // (k_t/J0 − x)(…)…: the two frequencies of three inertias in a row.
    let stiffness = 20.0;
    let (a, b) = (stiffness, shaft);
    let sum = a / motor + (a + b) / gear + b / load;
    let product = a * b * (motor + gear + load) / (motor * gear * load);
    let root = (sum * sum / 4.0 - product).sqrt();
    let squares = [sum / 2.0 + root, sum / 2.0 - root];
    let elastic = driven(Some(stiffness), 10.0)
        .steady_sliding_at(&turns)
        .unwrap();
    check(&elastic, &squares);
    // The clutch carries what the load needs, and no more than it can.
    let carried = torque * (gear + load) / (motor + gear + load);
    for (pressed, holds) in [
        (carried / 0.5 * 1.001, true),
        (carried / 0.5 * 0.999, false),
    ] {
        for stiffness in [None, Some(stiffness)] {
            match driven(stiffness, pressed).steady_sliding_at(&turns) {
                Ok(_) => assert!(holds),
                Err(Error::NoSteadySliding(NotSliding::OverLimit { contact, force, .. })) => {
                    assert!(!holds && contact == 0);
                    assert!((force - carried).abs() < 1e-13);
                }
                other => panic!("{other:?}"),
            }
        }
    }
}

/// Constant friction neither brakes nor drives a slip speed: a rigid-body velocity without an
/// eigenvalue. A law that falls has a real one.
#[test]
fn slip_speeds_have_an_eigenvalue_where_friction_depends_on_them() {
    let shafts = |law: Exponential| {
        let clutch = Contact::between(0, 1, law, 2.0).unwrap();
        Structure::new(&[1.0, 0.5]).and_then(|s| s.with_contact(clutch))
    };
    let constant = Exponential::new(0.3, 0.3, 1.0).unwrap();
    let found = shafts(constant).unwrap().steady_sliding_at(&[5.0, 2.0]);
    assert_eq!(found.unwrap().eigenvalues, []);
    let found = shafts(falling()).unwrap().steady_sliding_at(&[5.0, 2.0]);
    let [&value] = exactly(&found.unwrap().eigenvalues);
    // −N dμ̂/ds (1/J0 + 1/J1), μ̂ = 0.3 + 0.05 e^{−(s/2)²}
    let slope = -0.05 * 2.0 * 3.0 / 4.0 * (-9.0_f64 / 4.0).exp();
    assert!((value - Complex::new(-2.0 * slope * 3.0, 0.0)).norm() < 1e-15);
}

#[test]
fn velocities_that_are_not_steady_are_refused() {
    let clutch = |law| Contact::between(0, 1, law, 2.0).unwrap();
    let pair = Structure::new(&[1.0, 0.5, 1.0])
        .and_then(|s| s.with_spring(1, 2, 3.0)?.with_contact(clutch(falling())))
        .unwrap();
    let reason = |found: Result<SteadySliding, Error>| match found {
        Err(Error::NoSteadySliding(reason)) => reason,
        other => panic!("{other:?}"),
    };
    let found = reason(pair.steady_sliding_at(&[2.0, 1.0, 1.5]));
    assert_eq!(found, NotSliding::Deforms { coordinate: 1 });
    assert!(found.to_string().contains("coordinate 1"));
    assert_eq!(
        pair.steady_sliding_at(&[2.0, 1.0]),
        Err(Error::WrongSize {
            name: "velocities",
            found: 2,
            expected: 3,
        })
    );
    for bad in [f64::NAN, f64::INFINITY] {
        refused!(pair.steady_sliding_at(&[2.0, bad, 1.0]) => Error::InvalidParameter { .. });
    }
    let driven = pair.clone().with_force(0, Drive::sine(1.0, 1.0).unwrap());
    let found = driven.unwrap().steady_sliding_at(&[2.0, 1.0, 1.0]);
    assert_eq!(reason(found), NotSliding::Driven);
    let bristles = LuGre::new(falling(), 100.0, 0.1, 0.0).unwrap();
    let joint = Contact::between(0, 1, bristles, 1.0).unwrap();
    let bristly = Structure::new(&[1.0, 1.0]).and_then(|s| s.with_contact(joint));
    let bristly = bristly.unwrap();
    let found = reason(bristly.steady_sliding_at(&[1.0, 1.0]));
    assert_eq!(found, NotSliding::NoSpeed { contact: 0 });
    // In slip they add their deflection: a second eigenvalue beside that of the slip speed.
    let found = bristly.steady_sliding_at(&[3.0, 1.0]).unwrap();
    assert_eq!(found.eigenvalues.len(), 2);
}

/// Large velocities are those of a rigid-body motion, or not, like others; what overflows is told.
#[test]
fn large_velocities_are_compared_and_overflow_is_told() {
    let reason = |found: Result<SteadySliding, Error>| match found {
        Err(Error::NoSteadySliding(reason)) => reason,
        other => panic!("{other:?}"),
    };
    let pair = Structure::new(&[1.0, 1.0]).unwrap();
    let pair = pair.with_spring(0, 1, 1e300).unwrap();
    for v in [1e-308, 1.0, 1e308] {
        let found = reason(pair.steady_sliding_at(&[v, -v]));
        assert_eq!(found, NotSliding::Deforms { coordinate: 0 }, "{v}");
        assert!(pair.steady_sliding_at(&[v, v]).is_ok(), "{v}");
    }
    let damped = pair.clone().with_ground_damper(0, 10.0).unwrap();
    let found = reason(damped.steady_sliding_at(&[1e308, 1e308]));
    assert_eq!(found, NotSliding::Overflow);
    let clutch = Contact::between(0, 1, falling(), 1.0).unwrap();
    let apart = Structure::new(&[1.0, 1.0]).unwrap();
    let apart = apart.with_contact(clutch).unwrap();
    let found = reason(apart.steady_sliding_at(&[1e308, -1e308]));
    assert_eq!(found, NotSliding::Overflow);
    // A soft spring under a large force, in both searches.
    let soft = Structure::new(&[1.0])
        .and_then(|s| s.with_ground_spring(0, 1e-300)?.with_force(0, 1e300))
        .unwrap();
    assert_eq!(reason(soft.steady_sliding()), NotSliding::Overflow);
    assert_eq!(reason(soft.steady_sliding_at(&[0.0])), NotSliding::Overflow);
}

/// A rigid joint that sticks is a constraint: with a full mass matrix, a load that depends on
/// displacements, and contacts that slip, the structure of one coordinate less has the same
/// eigenvalues.
#[test]
fn a_rigid_joint_that_sticks_is_a_constraint() {
    for_all(
        100,
        [0.2..3.0, 0.2..3.0, 0.1..5.0, 0.0..0.3, 0.3..2.0, -0.2..0.2],
        |[mass, other, stiffness, damping, speed, tilt]| {
            let coupled = 0.3 * mass.min(other);
            let entries = [mass, coupled, 0.1, coupled, other, 0.0, 0.1, 0.0, 1.0];
            let whole = DMatrix::from_row_slice(3, 3, &entries);
            // q = Z y: coordinates 0 and 1 are one.
            let one = DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 1.0, 0.0, 0.0, 1.0]);
            let finished = |system: Structure, place: [usize; 2]| {
                let [first, last] = place;
                let belt = Contact::new(last, falling(), 1.0)?.on_belt(speed);
                system
                    .with_ground_spring(first, 1.0)?
                    .with_spring(first, last, stiffness)?
                    .with_ground_damper(last, damping)?
                    .with_contact(belt.with_load_gradient(first, tilt)?)
            };
            let joint = Contact::between(0, 1, Coulomb::new(0.4, 0.3).unwrap(), 1.0).unwrap();
            let joined = Structure::with_mass_matrix(whole.clone())
                .and_then(|s| finished(s, [0, 2])?.with_contact(joint))
                .unwrap();
            // Without the ground, coordinate 1 would be free to move alone.
            let found = joined.steady_sliding_at(&[0.0; 3]).unwrap();
            let reduced = Structure::with_mass_matrix(one.transpose() * whole * &one);
            let reduced = reduced.and_then(|s| finished(s, [0, 1])).unwrap();
            let expected = reduced.steady_sliding().unwrap();
            let size = expected.eigenvalues[0].norm().max(1.0);
            let apart = apart(&found.eigenvalues, &expected.eigenvalues);
            assert!(apart < 1e-12 * size, "{apart:e} {found:?} {expected:?}");
            Ok(())
        },
    );
}

/// Joints that stick between masses which springs make one: the forces in them are not felt by what
/// moves as a whole, whatever the last bits of its directions are.
#[test]
fn joints_within_what_moves_as_a_whole_feel_nothing() {
    for_all(
        100,
        [0.3..2.0, 0.3..2.0, 0.3..3.0, 0.0..0.2, -0.5..0.1, 0.5..1.5],
        |[mass, other, stiffness, damping, velocity, load]| {
            let joint = |i, j| Contact::between(i, j, Coulomb::new(5.0, 5.0).unwrap(), 1.0);
            let belt = Contact::new(0, falling(), load).unwrap().on_belt(1.0);
            let system = Structure::new(&[mass, other, 1.0])
                .and_then(|s| {
                    s.with_spring(0, 1, stiffness)?
                        .with_ground_damper(0, damping)
                })
                .and_then(|s| s.with_contact(belt)?.with_contact(joint(0, 1)?))
                .unwrap();
            let found = system
                .steady_sliding_at(&[velocity, velocity, 0.0])
                .unwrap();
            // Masses 0 and 1 are one, with one eigenvalue; mass 2 is free and at rest.
            let slip = 1.0 - velocity;
            let slope = load
                * (falling().coefficient(slip + 1e-6) - falling().coefficient(slip - 1e-6))
                / 2e-6;
            let [&eigenvalue] = exactly(&found.eigenvalues);
            let expected = -(slope + damping) / (mass + other);
            assert!(
                (eigenvalue - expected).norm() < 1e-8,
                "{eigenvalue} {expected}"
            );
            let force = load * falling().coefficient(slip) - damping * velocity;
            let whole = force / (mass + other);
            let expected = [whole, whole, 0.0];
            for (a, expected) in std::iter::zip(&found.accelerations, expected) {
                assert!((a - expected).abs() < 1e-12, "{:?}", found.accelerations);
            }
            Ok(())
        },
    );
}

/// A motor under PI control of its speed drives a rotor that slips in a brake: the integral has the
/// value that carries the friction, and the eigenvalues are the roots of the polynomial of the
/// loop.
#[test]
fn an_integral_of_the_speed_carries_what_turns() {
    let (motor, rotor, shaft, given) = (0.5, 2.0, 30.0, 4.0);
    let (proportional, integral) = (3.0, 7.0);
    let speed_control = |unit: f64| {
        FirstOrder::integrator()
            .with_velocity(0, unit)
            .and_then(|s| s.with_drive(-unit * given)?.with_force(0, -integral / unit))
            .unwrap()
    };
    let drive = |unit: f64| {
        Structure::new(&[motor, rotor])
            .and_then(|s| {
                s.with_spring(0, 1, shaft)?
                    .with_ground_damper(0, proportional)
            })
            .and_then(|s| s.with_force(0, proportional * given))
            .and_then(|s| s.with_first_order(speed_control(unit)))
            .and_then(|s| s.with_contact(Contact::new(1, falling(), 5.0)?))
            .unwrap()
    };
    let mu = |speed: f64| 0.3 + 0.05 * (-(speed / 2.0).powi(2)).exp();
    let slope = 5.0 * 0.05 * (-(given / 2.0_f64).powi(2)).exp() * (-2.0 * given / 4.0);
    for unit in [1.0, 1e-9, 1e9] {
        let found = drive(unit).steady_sliding_at(&[given; 2]).unwrap();
        assert_eq!(found.accelerations, [0.0; 2]);
        let friction = 5.0 * mu(given);
        let carried = -integral * found.first_order[0] / unit;
        assert!((carried - friction).abs() < 1e-13, "{carried} {friction}");
        let [first, second] = found.displacements[..] else {
            panic!()
        };
        assert!((shaft * (first - second) - friction).abs() < 1e-13);
        // The angle has no eigenvalue.
        assert_eq!(found.eigenvalues.len(), 4);
        for s in &found.eigenvalues {
            // Of the speeds: [J_0 s² + K_p s + K_i + k, −k; −k, J_1 s² + c s + k].
            let one = s * s * motor + s * proportional + integral + shaft;
            let other = s * s * rotor + s * slope + shaft;
            let size = (s.norm() + 10.0).powi(4);
            assert!((one * other - shaft * shaft).norm() < 1e-13 * size, "{s}");
        }
    }
    // At another speed the integral grows.
    let (state, rate) = (0, 0.5);
    let grows = drive(1.0).steady_sliding_at(&[given + rate; 2]);
    let expected = Error::NoSteadySliding(NotSliding::Grows { state, rate });
    assert_eq!(grows.unwrap_err(), expected);
}
