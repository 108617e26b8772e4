//! Memories that depend on the load: heat of friction.

use std::cell::Cell;

use stick_slip::structure::State;
use stick_slip::{
    Contact, ContactLaw, Drive, Error, EventKind, Mode, Motion, Scalar, Segment, Slip, Structure,
};

use crate::common::collocation::integrate;
use crate::common::heat::Heat;
use crate::common::property::for_all;

fn brake() -> Heat {
    Heat {
        cold: 0.5,
        hot: 0.2,
        heating: 0.3,
        cooling: 0.0,
        conduction: 0.0,
        kept: 1.0,
    }
}

/// A block that friction brings to rest: its energy is heat, whatever the load does in time and
/// over the way.
#[test]
fn what_friction_takes_is_heat() {
    for_all(
        200,
        [0.3..3.0, 0.5..4.0, 0.0..0.8, 0.3..3.0, 0.0..0.5],
        |[mass, speed, swing, frequency, gradient]| {
            let load = Drive::constant(4.0)
                .with_harmonic(swing, frequency, 1.0)
                .unwrap();
            let contact = Contact::new(0, brake(), load).unwrap();
            let contact = contact.with_load_gradient(0, gradient).unwrap();
            let block = Structure::new(&[mass])
                .unwrap()
                .with_contact(contact)
                .unwrap();
            let motion = block.simulate(State::new(&[0.0], &[speed]), 60.0).unwrap();
            assert_eq!(motion.events()[0].kind, EventKind::Stick);
            let heat = 0.3 * 0.5 * mass * speed * speed;
            let found = motion.last().memory[0];
            assert!(
                (found - heat).abs() < 1e-14 * (1.0 + heat),
                "{found} {heat}"
            );
            Ok(())
        },
    );
}

/// In stick z' = −b(1 + cN)z with N(t) given.
#[test]
fn a_contact_cools_in_stick_under_its_load() {
    let law = Heat {
        cooling: 0.25,
        conduction: 0.5,
        ..brake()
    };
    let load = Drive::constant(2.0).with_harmonic(1.5, 3.0, 0.4).unwrap();
    let contact = Contact::new(0, law, load).unwrap();
    let block = Structure::new(&[1.0])
        .unwrap()
        .with_contact(contact)
        .unwrap();
    let start = State::new(&[0.0], &[0.0]).with_memory(&[0.8]);
    let motion = block.simulate(start, 9.0).unwrap();
    for (t, state) in motion.sample(50) {
        let integral = 2.0 * t + 0.5 * ((3.0 * t + 0.4).sin() - 0.4_f64.sin());
        // A harmonic is a cosine.
        let expected = 0.8 * (-0.25 * (t + 0.5 * integral)).exp();
        assert!((state.memory[0] - expected).abs() < 1e-15, "{t} {state:?}");
    }
}

/// Two masses on fast belts, coupled by a spring, each pressed by the displacement of the other:
/// against an integrator of its own.
#[test]
fn motions_are_those_of_an_independent_integrator() {
    let law = Heat {
        heating: 0.4,
        cooling: 0.3,
        conduction: 0.2,
        ..brake()
    };
    let drive = || Drive::constant(2.0).with_harmonic(0.5, 1.3, 0.2).unwrap();
    let contact = |i: usize| Contact::new(i, law, drive()).unwrap().on_belt(6.0);
    let system = Structure::new(&[1.0, 0.7])
        .and_then(|s| s.with_ground_spring(0, 1.5)?.with_ground_spring(1, 0.8))
        .and_then(|s| s.with_spring(0, 1, 0.6)?.with_ground_damper(0, 0.1))
        .and_then(|s| s.with_contact(contact(0).with_load_gradient(1, 0.4)?))
        .and_then(|s| s.with_contact(contact(1).with_load_gradient(0, -0.3)?))
        .unwrap();
    let start = [0.4, -0.3, 0.2, 0.5, 0.1, 0.6];
    let rates = |t: f64, y: &[f64]| {
        let [q0, q1, v0, v1, z0, z1] = *y else {
            panic!("six numbers")
        };
        let given = 2.0 + 0.5 * (1.3 * t + 0.2).cos();
        let at = |load: f64, v: f64, z: f64| {
            let mu = 0.2 + 0.3 * (-z).exp();
            let heat = 0.4 * mu * load * (6.0 - v) - 0.3 * (1.0 + 0.2 * load) * z;
            (mu * load, heat)
        };
        let (f0, h0) = at(given + 0.4 * q1, v0, z0);
        let (f1, h1) = at(given - 0.3 * q0, v1, z1);
        vec![
            v0,
            v1,
            f0 - 1.5 * q0 - 0.6 * (q0 - q1) - 0.1 * v0,
            (f1 - 0.8 * q1 - 0.6 * (q1 - q0)) / 0.7,
            h0,
            h1,
        ]
    };
    let expected = integrate(&rates, &start, [0.0, 12.0], 600);
    let again = integrate(&rates, &start, [0.0, 12.0], 900);
    let state = State::new(&start[..2], &start[2..4]).with_memory(&start[4..]);
    let last = system.simulate(state, 12.0).unwrap().last().clone();
    let found = [last.displacements, last.velocities, last.memory].concat();
    for ((found, expected), again) in found.iter().zip(&expected).zip(&again) {
        assert!((expected - again).abs() < 1e-13);
        assert!((found - expected).abs() < 1e-13, "{found} {expected}");
    }
}

/// Steady sliding under a load that follows the displacement: the forces balance, and z rests.
#[test]
fn steady_sliding_is_warm() {
    for_all(
        200,
        [0.3..3.0, 0.5..2.0, -1.0..1.0, 0.1..2.0, 0.0..0.5, 0.3..3.0],
        |[stiffness, load, slope, speed, heating, cooling]| {
            let gradient = slope * stiffness;
            let law = Heat {
                heating,
                cooling,
                conduction: 0.3,
                ..brake()
            };
            let contact = Contact::new(0, law, load).unwrap().on_belt(speed);
            let contact = contact.with_load_gradient(0, gradient).unwrap();
            let system = Structure::new(&[1.0])
                .and_then(|s| s.with_ground_spring(0, stiffness)?.with_contact(contact))
                .unwrap();
            let steady = system.steady_sliding().unwrap();
            let q = steady.displacements[0];
            let n = load + gradient * q;
            // k q = N μ(z), and z is what heat and loss leave.
            let mu = stiffness * q / n;
            let z = heating * mu * n * speed / (cooling * (1.0 + 0.3 * n));
            assert!((0.2 + 0.3 * (-z).exp() - mu).abs() < 1e-12, "{q} {z}");
            // The derivatives along the motion are e^{Jt}.
            let at = |q: f64, v: f64, z: f64| {
                let (n, mu) = (load + gradient * q, 0.2 + 0.3 * (-z).exp());
                let heat = heating * mu * n * (speed - v) - cooling * (1.0 + 0.3 * n) * z;
                [v, mu * n - stiffness * q, heat]
            };
            let size = 1e-4;
            let slope = |k: usize| {
                let beside = |change: f64| {
                    let mut place = [q, 0.0, z];
                    place[k] += change;
                    at(place[0], place[1], place[2])
                };
                let [a, b] = [beside(size), beside(-size)];
                std::array::from_fn::<f64, 3, _>(|i| (a[i] - b[i]) / (2.0 * size))
            };
            let columns = [slope(0), slope(1), slope(2)];
            let trace = columns[0][0] + columns[1][1] + columns[2][2];
            let jacobian = stick_slip::nalgebra::Matrix3::from_fn(|i, k| columns[k][i]);
            let sum: f64 = steady.eigenvalues.iter().map(|s| s.re).sum();
            let product = steady.eigenvalues.iter().fold(
                stick_slip::nalgebra::Complex::new(1.0, 0.0),
                |product, s| product * s,
            );
            assert_eq!(steady.eigenvalues.len(), 3);
            assert!((sum - trace).abs() < 1e-7, "{sum} {trace}");
            assert!((product.re - jacobian.determinant()).abs() < 1e-6 * (1.0 + product.norm()));
            Ok(())
        },
    );
}

/// A law that gives NaN under the load of its contact is refused where the contact is made, and
/// ends a motion whose load comes there.
#[test]
fn a_rate_that_is_no_number_under_a_load_is_an_error() {
    struct Broken;
    impl ContactLaw for Broken {
        type Memory<S: Scalar> = [S; 1];
        fn coefficient<S: Scalar>(&self, slip: Slip<S>, _: [S; 1]) -> S {
            slip.speed.constant(0.3 * slip.direction)
        }
        fn limit<S: Scalar>(&self, zero: S, _: [S; 1]) -> Option<S> {
            Some(zero.constant(0.3))
        }
        fn rates<S: Scalar>(&self, _: Motion<S>, load: S, _: [S; 1]) -> [S; 1] {
            [(-load + 2.0).sqrt()]
        }
        fn breakpoints(&self) -> impl Iterator<Item = f64> {
            std::iter::empty()
        }
        fn caught(&self, memory: [f64; 1]) -> [f64; 1] {
            memory
        }
    }
    let refused = Contact::new(0, Broken, 3.0).unwrap_err();
    assert!(
        matches!(refused, Error::InvalidParameter { .. }),
        "{refused}"
    );
    let load = Drive::profile(&[(0.0, 1.0), (4.0, 3.0)]).unwrap();
    let contact = Contact::new(0, Broken, load).unwrap().on_belt(1.0);
    let block = Structure::new(&[1.0])
        .and_then(|s| s.with_ground_spring(0, 1.0)?.with_contact(contact))
        .unwrap();
    let start = State::new(&[0.0], &[0.0]);
    let error = block.simulate(start, 9.0).unwrap_err();
    let reached = match &error {
        Error::NonFiniteFriction { reached, .. } => reached.as_ref().unwrap(),
        Error::StepUnderflow { reached, .. } => reached,
        _ => panic!("{error}"),
    };
    assert!((reached.time - 2.0).abs() < 1e-3, "{error}");
}

/// z' = −bz without a load, with any reversals of r and rests on the way.
#[test]
fn a_contact_cools_while_it_is_open() {
    let closings = Cell::new(0);
    for_all(
        200,
        [0.5..3.0, 1.1..2.5, 0.3..1.5, 0.05..0.6, 0.0..1.0],
        |[stiffness, swing, frequency, cooling, belt]| {
            let law = Heat { cooling, ..brake() };
            let load = Drive::constant(1.0)
                .with_harmonic(swing, frequency, 1.0)
                .unwrap();
            let contact = Contact::new(0, law, load).unwrap().on_belt(belt);
            let block = Structure::new(&[1.0])
                .and_then(|block| {
                    block
                        .with_ground_spring(0, stiffness)?
                        .with_contact(contact)
                })
                .unwrap();
            let start = State::new(&[0.5], &[1.5]).with_memory(&[0.3]);
            let motion = block.simulate(start, 30.0).unwrap();
            let mut opened: Option<(f64, f64)> = None;
            for event in motion.events() {
                let (t, z) = (event.time, event.state.memory[0]);
                match event.kind {
                    EventKind::Open => opened = Some((t, z)),
                    EventKind::Close => {
                        let (since, before) = opened.take().unwrap_or((0.0, 0.3));
                        let expected = before * (-cooling * (t - since)).exp();
                        assert!((z - expected).abs() < 1e-15, "{t} {z} {expected}");
                        closings.set(closings.get() + 1);
                    }
                    _ => assert_eq!(opened, None, "{t}"),
                }
            }
            Ok(())
        },
    );
    assert!(closings.get() > 500, "{closings:?}");
}

/// Slip begins with the friction of the memory that the law gives it: of a contact alone, and of
/// one on masses that share it.
#[test]
fn slip_begins_with_the_friction_of_its_memory() {
    let slips = Cell::new(0);
    for_all(
        100,
        [0.5..3.0, 0.0..0.4, 0.3..1.0, 0.3..0.9],
        |[stiffness, damping, frequency, kept]| {
            let law = Heat {
                heating: 1.5,
                cooling: 0.2,
                kept,
                ..brake()
            };
            let [alone, shared] = [Contact::new(0, law, 0.6), Contact::between(0, 1, law, 0.6)]
                .map(|contact| {
                    Structure::new(&[1.0, 2.0])
                        .and_then(|s| s.with_ground_spring(0, stiffness)?.with_contact(contact?))
                        .and_then(|s| s.with_ground_damper(0, damping))
                        .and_then(|s| s.with_force(0, Drive::harmonic(1.0, frequency, 0.0)?))
                        .unwrap()
                });
            for (is_shared, system) in [(false, alone), (true, shared)] {
                let start = State::new(&[0.3, 0.0], &[0.4, 0.1]).with_memory(&[0.2]);
                let motion = system.simulate(start, 30.0).unwrap();
                // Central differences, with an error of the second order.
                let width = 1e-4;
                for step in motion.steps() {
                    let Mode::Slip(side) = step.modes()[0] else {
                        continue;
                    };
                    if step.duration() < 2.0 * width {
                        continue;
                    }
                    let time = step.start_time() + width;
                    let [before, at, after] =
                        [-width, 0.0, width].map(|by| motion.state_at(time + by).unwrap());
                    let friction = side.sign() * 0.6 * (0.2 + 0.3 * (-at.memory[0]).exp());
                    let drive = (frequency * time).cos();
                    let others = stiffness * at.displacements[0] + damping * at.velocities[0];
                    let expected = [
                        drive - others - friction,
                        if is_shared { 0.5 * friction } else { 0.0 },
                    ];
                    for (i, expected) in expected.into_iter().enumerate() {
                        let found = (after.velocities[i] - before.velocities[i]) / (2.0 * width);
                        assert!((found - expected).abs() < 1e-6, "{time} {found} {expected}");
                    }
                    slips.set(slips.get() + 1);
                }
            }
            Ok(())
        },
    );
    assert!(slips.get() > 5000, "{slips:?}");
}

/// z' = −bz beside masses that nothing moves: down to 0.
#[test]
fn a_contact_that_nothing_moves_cools() {
    let law = Heat {
        cooling: 0.5,
        ..brake()
    };
    let contact = || Contact::between(0, 1, law, 1.0).unwrap();
    let clutch = Structure::new(&[1.0, 2.0]).unwrap();
    let clutch = clutch.with_contact(contact()).unwrap();
    for speed in [0.0, 0.7] {
        let start = State::new(&[0.0; 2], &[speed; 2]).with_memory(&[0.8]);
        let motion = clutch.simulate(start, 1e5).unwrap();
        for t in [1.0, 20.0, 50.0, 300.0, 1400.0, 1e5] {
            let found = motion.state_at(t).unwrap().memory[0];
            let expected = 0.8 * (-0.5 * t).exp();
            // The exponent is right to 1e-13.
            let allowed = 1e-13 * (1.0 + 0.5 * t) * expected + 1e-307;
            assert!((found - expected).abs() < allowed, "{t} {found} {expected}");
        }
        assert!(motion.steps().len() < 1000, "{}", motion.steps().len());
    }
}
