//! Friction that depends on the direction of slip, and contacts that slip in one direction only.

use std::f64::consts::{PI, TAU};

use approx::{assert_abs_diff_eq, assert_relative_eq};
use stick_slip::orbit::{self, Period};
use stick_slip::structure::{NotSliding, State};
use stick_slip::{
    Contact, ContactLaw, Coulomb, Direction, Directional, Drive, Error, EventKind, Freewheel,
    FrictionLaw, Integrator, Mode, Motion, RateState, Scalar, Slip, Stribeck, Structure, Tabulated,
};

use crate::common::any::Any;
use crate::common::{
    Random, count, even, keys, list, memory_stays, message, number, refused, text,
};
use crate::reading::{cases, numbers, structure};

fn sine(amplitude: f64, frequency: f64) -> Drive {
    let rest = Drive::constant(0.0);
    rest.with_sine(amplitude, frequency).unwrap()
}

/// x'' = sin 2πt with less friction forward than backward.
fn shaken_block() -> Structure {
    let law = Directional::new(even(0.2), even(0.6)).unwrap();
    Structure::new(&[1.0])
        .and_then(|s| {
            s.with_force(0, sine(1.0, TAU))?
                .with_contact(Contact::new(0, law, 1.0)?)
        })
        .unwrap()
}

#[test]
fn a_shaken_block_moves_with_the_nap() {
    let motion = shaken_block().simulate(State::at_rest(1), 40.0).unwrap();
    let first = &motion.events()[0];
    assert_eq!(first.kind, EventKind::Release(Direction::Leading));
    assert_abs_diff_eq!(first.time, 0.03204710842448746580593714, epsilon = 1e-16);
    // It stops within each period, so that all are alike.
    let way = |t: f64| motion.state_at(t).unwrap().displacements[0];
    let mean = way(40.0) - way(39.0);
    assert_abs_diff_eq!(mean, 0.0853, epsilon = 5e-5);
    assert_abs_diff_eq!(way(30.0) - way(20.0), 10.0 * mean, epsilon = 1e-13);
    assert!(
        motion
            .events()
            .iter()
            .all(|event| event.state.velocities[0] >= 0.0)
    );
}

/// The tension of a rope with one turn around a bar, at which it slips: forward at e^{2πμ} times
/// the tension of the other end, back at the inverse.
#[test]
fn a_rope_slips_at_the_ratio_of_eytelwein() {
    let law = Directional::capstan(0.3, 0.2, TAU).unwrap();
    let (tension, rate) = (2.0, 0.5);
    let largest = 6.586061962694724858363079;
    for (rate, expected, side) in [
        (rate, (largest - 1.0) * tension, Direction::Leading),
        (-rate, (1.0 - 1.0 / largest) * tension, Direction::Lagging),
    ] {
        // The pull of the free end beside that of the tension.
        let pull = Drive::profile(&[(0.0, 0.0), (100.0, 100.0 * rate)]).unwrap();
        let contact = Contact::new(0, law.clone(), tension).unwrap();
        let rope = Structure::new(&[1.0])
            .and_then(|s| s.with_force(0, pull)?.with_contact(contact))
            .unwrap();
        let motion = rope.simulate(State::at_rest(1), 40.0).unwrap();
        assert_eq!(keys(&motion)[0], (0, EventKind::Release(side)));
        let released = motion.events()[0].time;
        assert_relative_eq!(released * rate.abs(), expected, max_relative = 1e-14);
    }
}

/// Two masses with a joint between them, one on a belt; with these laws forward and backward.
fn pair<L>(joint: L, belt: L, load: Drive) -> Structure
where
    L: ContactLaw + Send + Sync + 'static,
{
    Structure::new(&[1.0, 2.0])
        .and_then(|s| s.with_ground_spring(0, 4.0)?.with_spring(0, 1, 3.0))
        .and_then(|s| s.with_force(0, sine(4.0, 1.3)))
        .and_then(|s| s.with_contact(Contact::between(0, 1, joint, load)?))
        .and_then(|s| s.with_contact(Contact::new(1, belt, 2.0)?.on_belt(sine(0.4, 0.7))))
        .unwrap()
}

/// Equal laws in both directions are one law, to the last bit.
#[test]
fn equal_laws_are_one_law() {
    let mut random = Random::new(31);
    let start = State::new(&[0.3, -0.2], &[0.1, 0.2]);
    let mut compared = 0;
    for kind in 0..count(Any::KINDS, 4 * Any::KINDS) {
        let [joint, belt] = [(); 2].map(|()| random.any_law(kind % Any::KINDS));
        let both = |law: &Any| Directional::new(law.clone(), law.clone()).unwrap();
        for load in [
            Drive::constant(1.5),
            sine(0.7, 2.0).with_constant(1.5).unwrap(),
        ] {
            let plain = pair(joint.clone(), belt.clone(), load.clone());
            let sided = pair(both(&joint), both(&belt), load);
            let [plain, sided] = [plain, sided].map(|s| s.simulate(start.clone(), 20.0));
            match (plain, sided) {
                (Ok(plain), Ok(sided)) => {
                    assert_eq!(plain.events(), sided.events());
                    assert_eq!(plain.last(), sided.last());
                    compared += 1;
                }
                (plain, sided) => assert_eq!(plain.err(), sided.err()),
            }
        }
    }
    assert!(compared >= Any::KINDS);
    // Alone on its belt, by the code of one mass.
    let law = random.any_law(1);
    let alone = |contact: Contact| {
        Structure::new(&[1.0])
            .and_then(|s| {
                s.with_ground_spring(0, 1.0)?
                    .with_contact(contact.on_belt(0.2))
            })
            .and_then(|s| s.simulate(State::at_rest(1), 50.0))
            .unwrap()
    };
    let both = Directional::new(law.clone(), law.clone()).unwrap();
    let plain = alone(Contact::new(0, law, 1.0).unwrap());
    let sided = alone(Contact::new(0, both, 1.0).unwrap());
    assert_eq!(plain.events(), sided.events());
    assert_eq!(plain.last(), sided.last());
    assert!(plain.events().len() > 4);
}

/// Under a constant load half the sum of both coefficients is friction, and half the difference a
/// constant force.
#[test]
fn a_difference_under_constant_load_is_a_force() {
    let coulomb = |s: f64, k: f64| Coulomb::new(s, k).unwrap();
    let sided = || Directional::new(coulomb(0.6, 0.5), coulomb(0.4, 0.3)).unwrap();
    let [joint, belt] = [1.5, 2.0];
    let directional = pair(sided(), sided(), Drive::constant(joint));
    let [half, force] = [coulomb(0.5, 0.4), coulomb(0.1, 0.1)];
    let offset = force.static_coefficient();
    let plain = pair(half, half, Drive::constant(joint))
        .with_force(0, -offset * joint)
        .and_then(|s| s.with_force(1, offset * joint - offset * belt))
        .unwrap();
    let start = State::new(&[0.3, -0.2], &[0.1, 0.2]);
    let [a, b] = [directional, plain].map(|s| s.simulate(start.clone(), 30.0).unwrap());
    assert_eq!(keys(&a), keys(&b));
    assert!(a.events().len() > 20);
    for (a, b) in a.events().iter().zip(b.events()) {
        assert_abs_diff_eq!(a.time, b.time, epsilon = 1e-11);
    }
    for i in 0..2 {
        assert_abs_diff_eq!(
            a.last().velocities[i],
            b.last().velocities[i],
            epsilon = 1e-11
        );
    }
}

/// With all signs changed, the other side yields.
#[test]
fn mirrored_systems_move_mirrored() {
    let table = |top: f64| Tabulated::new([(0.0, top), (0.3, 0.6 * top), (2.0, 0.9 * top)]);
    let [more, less] = [0.7, 0.3].map(|top| table(top).unwrap());
    let stribeck = |top: f64| Coulomb::new(top, 0.8 * top).unwrap();
    let made = |sign: f64| {
        let joint = match sign > 0.0 {
            true => Directional::new(more.clone(), less.clone()).unwrap(),
            false => Directional::new(less.clone(), more.clone()).unwrap(),
        };
        let [front, back] = if sign > 0.0 { [0.5, 0.8] } else { [0.8, 0.5] };
        let belt = Directional::new(stribeck(front), stribeck(back)).unwrap();
        Structure::new(&[1.0, 2.0])
            .and_then(|s| s.with_ground_spring(0, 4.0)?.with_spring(0, 1, 3.0))
            .and_then(|s| s.with_force(0, sine(4.0 * sign, 1.3)))
            .and_then(|s| s.with_contact(Contact::between(0, 1, joint, 1.5)?))
            .and_then(|s| {
                s.with_contact(Contact::new(1, belt, 2.0)?.on_belt(sine(0.4 * sign, 0.7)))
            })
            .and_then(|s| {
                let start = State::new(&[0.3 * sign, -0.2 * sign], &[0.1 * sign, 0.2 * sign]);
                s.simulate(start, 30.0)
            })
            .unwrap()
    };
    let [there, here] = [made(1.0), made(-1.0)];
    let mirrored = |(contact, kind): (usize, EventKind)| match kind {
        EventKind::Release(side) => (contact, EventKind::Release(side.opposite())),
        EventKind::Crossing(side) => (contact, EventKind::Crossing(side.opposite())),
        other => (contact, other),
    };
    let expected: Vec<_> = keys(&there).into_iter().map(mirrored).collect();
    assert_eq!(keys(&here), expected);
    assert!(expected.len() > 10);
    for i in 0..2 {
        let [a, b] = [&there, &here].map(|motion| motion.last().displacements[i]);
        assert_abs_diff_eq!(a, -b, epsilon = 1e-12);
    }
}

/// Energies along the motions of the reference file with limits by direction, and forces in samples
/// that balance the accelerations within the limits.
#[test]
fn energies_balance() {
    let all = cases(include_str!("../data/limits_trajectories.json"));
    let sided = all.iter().filter(|case| case["gap"].as_u64() == Some(3));
    let mut samples = 0;
    for case in sided {
        let system = structure(&case["system"], f64::NAN);
        let start = State::new(&numbers(&case["start"]["q"]), &numbers(&case["start"]["v"]));
        let motion = system.simulate(start, number(&case["t_end"])).unwrap();
        let budget = system.energy_budget(&motion).unwrap();
        let size = budget.friction_loss.iter().sum::<f64>() + budget.damper_loss;
        let id = text(&case["id"]);
        assert!(budget.defect().abs() < 1e-12 * size, "{id} {budget:?}");
        assert!(budget.friction_loss.iter().all(|loss| *loss >= 0.0), "{id}");
        for sample in system.samples(&motion, 0.37).unwrap() {
            for (c, given) in list(&case["system"]["contacts"]).iter().enumerate() {
                let params = &given["law_params"];
                let [least, most] = match text(&given["law"]) {
                    "directional" => ["backward", "forward"].map(|d| number(&params[d]["mus"])),
                    "freewheel" => [number(&params["drag"]), f64::INFINITY],
                    _ => [number(&params["mus"]); 2],
                };
                let (load, force) = (sample.loads[c].max(0.0), sample.friction[c]);
                let within = 1.0 + 1e-12;
                let forward = if load > 0.0 {
                    most * load * within
                } else {
                    0.0
                };
                assert!(
                    -least * load * within <= force && force <= forward,
                    "{id} {sample:?}"
                );
                if sample.modes[c] == Mode::Slip(Direction::Leading) {
                    assert!(most.is_finite());
                }
                samples += 1;
            }
        }
    }
    assert!(samples > 50);
}

/// A one-way clutch behind a torque of 10 sin 6πt: it engages when ½ = (10/6π)(1 − cos 6πt).
#[test]
fn a_one_way_clutch_engages_without_a_jump() {
    let clutch = Structure::new(&[1.0, 1.0])
        .and_then(|s| {
            s.with_force(0, sine(10.0, 6.0 * PI))?
                .with_contact(Contact::freewheel(0, 1)?)
        })
        .unwrap();
    let motion = clutch
        .simulate(State::new(&[0.0; 2], &[0.0, 0.5]), 0.4)
        .unwrap();
    assert_eq!(keys(&motion)[0], (0, EventKind::Stick));
    let engaged = motion.events()[0].time;
    assert_abs_diff_eq!(engaged, 0.08028000024134917137001713, epsilon = 1e-16);
    // Together they gain half of the impulse until the torque changes its sign at 1/6.
    assert_eq!(
        keys(&motion)[1],
        (0, EventKind::Release(Direction::Lagging))
    );
    assert_abs_diff_eq!(motion.events()[1].time, 1.0 / 6.0, epsilon = 1e-15);
    let [first, second] = [0, 1].map(|i| motion.state_at(0.2).unwrap().velocities[i]);
    let peak = 10.0 / (6.0 * PI) * 2.0;
    assert_abs_diff_eq!(second, 0.5 * (peak + 0.5), epsilon = 1e-14);
    assert!(first < second);
}

/// A limit that is never reached is an infinite one.
#[test]
fn large_limits_are_infinite_ones() {
    let drag = Coulomb::new(0.3, 0.2).unwrap();
    let large = Directional::new(even(1e6), drag).unwrap();
    let with = |contact: Contact| {
        Structure::new(&[1.0, 2.0])
            .and_then(|s| s.with_force(0, sine(6.0, 4.0))?.with_contact(contact))
            .and_then(|s| s.with_contact(Contact::new(1, Coulomb::new(0.3, 0.2)?, 2.0)?))
            .and_then(|s| s.simulate(State::at_rest(2), 20.0))
            .unwrap()
    };
    let infinite = Contact::freewheel(0, 1)
        .unwrap()
        .with_drag(drag, 0.5)
        .unwrap();
    let [infinite, large] = [infinite, Contact::between(0, 1, large, 0.5).unwrap()].map(with);
    assert_eq!(keys(&infinite), keys(&large));
    assert!(keys(&infinite).len() > 20);
    for (a, b) in infinite.events().iter().zip(large.events()) {
        assert_abs_diff_eq!(a.time, b.time, epsilon = 1e-13);
    }
}

/// A pawl that is lifted carries nothing, and one that falls in holds.
#[test]
fn a_freewheel_without_a_load_is_open() {
    let lifted = Drive::profile(&[(0.0, 0.0), (2.0, 0.0), (3.0, 1.0), (5.0, 1.0), (6.0, 0.0)]);
    let backstop = Contact::along(
        &[(0, -1.0)],
        Freewheel::new(even(0.0)).unwrap(),
        lifted.unwrap(),
    );
    let push = Drive::profile(&[
        (0.0, -1.0),
        (1.0, -1.0),
        (1.0, 1.0),
        (2.0, 1.0),
        (2.0, 0.0),
        (4.0, 0.0),
        (4.0, -1.0),
    ]);
    let shaft = Structure::new(&[1.0])
        .and_then(|s| {
            s.with_force(0, push.unwrap())?
                .with_contact(backstop.unwrap())
        })
        .unwrap();
    let motion = shaft.simulate(State::at_rest(1), 7.0).unwrap();
    let velocity = |t: f64| motion.state_at(t).unwrap().velocities[0];
    assert_abs_diff_eq!(velocity(1.0), -1.0, epsilon = 1e-15);
    assert_eq!(keys(&motion), [(0, EventKind::Close), (0, EventKind::Open)]);
    assert_eq!(motion.events()[0].time, 2.0);
    assert_eq!(velocity(5.0), 0.0);
    assert_abs_diff_eq!(velocity(7.0), -1.0, epsilon = 1e-14);
}

#[test]
fn freewheels_are_refused_the_wrong_way() {
    let shafts = |contact: Contact| {
        Structure::new(&[1.0, 1.0])
            .and_then(|s| s.with_contact(contact))
            .unwrap()
    };
    let freewheel = shafts(Contact::freewheel(0, 1).unwrap());
    let wrong = State::new(&[0.0; 2], &[0.5, 0.25]);
    let velocity = refused!(
        freewheel.simulate(wrong.clone(), 1.0) => Error::WrongWay { contact: 0, velocity }, velocity
    );
    assert_eq!(velocity, 0.25);
    message(
        freewheel.simulate(wrong.clone(), 1.0),
        &["contact 0", "0.25", "exchanging"],
    );
    // Where the pawl falls in.
    let pawl = Drive::profile(&[(0.0, -1.0), (2.0, 1.0)]).unwrap();
    let falling = Contact::freewheel(0, 1)
        .unwrap()
        .with_drag(even(0.1), pawl)
        .unwrap();
    let falling = shafts(falling);
    assert!(falling.simulate(wrong.clone(), 0.9).is_ok());
    refused!(falling.simulate(wrong, 1.1) => Error::WrongWay { contact: 0, .. });
    // Steady sliding on a belt that turns backward.
    let belt = shafts(Contact::freewheel(0, 1).unwrap().on_belt(-0.5));
    refused!(belt.steady_sliding() =>
        Error::NoSteadySliding(NotSliding::WrongWay { contact: 0, velocity: 0.5 }));
    // The way of the belt: the drag slips.
    let springs = shafts(Contact::freewheel(0, 1).unwrap().on_belt(0.5));
    let springs = springs
        .with_ground_spring(0, 1.0)
        .and_then(|s| s.with_ground_spring(1, 1.0));
    assert!(springs.unwrap().steady_sliding().is_ok());
    // What is no freewheel has no drag.
    let clutch = Contact::between(0, 1, even(0.3), 1.0).unwrap();
    message(
        clutch.with_drag(even(0.1), 1.0),
        &["Contact", "infinite", "`with_drag`"],
    );
    // Two of them, on surfaces that part: 0 ≤ v ≤ −t.
    let ramp = |rate: f64| Drive::profile(&[(0.0, 0.0), (1.0, 0.0), (2.0, rate)]).unwrap();
    let stop = |sign: f64, rate: f64| {
        let law = Freewheel::new(even(0.0)).unwrap();
        Contact::along(&[(0, sign)], law, 1.0)
            .unwrap()
            .on_belt(ramp(sign * rate))
    };
    let between = |low: f64, high: f64| {
        Structure::new(&[1.0])
            .and_then(|s| s.with_contacts([stop(1.0, high), stop(-1.0, low)]))
            .and_then(|s| s.simulate(State::at_rest(1), 2.0))
    };
    let reached = refused!(
        between(0.0, -1.0) => Error::Jammed { contacts, reached }, (contacts, reached.time)
    );
    assert_eq!(reached, (vec![0, 1], 1.0));
    message(between(0.0, -1.0), &["[0, 1]", "jam", "`Directional`"]);
    // Surfaces that move together, and such between which there is room.
    assert_abs_diff_eq!(
        between(1.0, 1.0).unwrap().last().velocities[0],
        1.0,
        epsilon = 1e-15
    );
    assert_eq!(between(-1.0, 1.0).unwrap().last().velocities[0], 0.0);
    assert_abs_diff_eq!(
        between(0.5, 1.0).unwrap().last().velocities[0],
        0.5,
        epsilon = 1e-15
    );
}

/// A law with these static coefficients, backward and forward, and no other friction.
#[derive(Debug, Clone, Copy)]
struct Given([f64; 2]);

impl ContactLaw for Given {
    type Memory<S: Scalar> = [S; 0];
    memory_stays!(0);
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, _: [S; 0]) -> S {
        slip.speed.constant(0.0)
    }
    fn limit<S: Scalar>(&self, _: S, _: [S; 0]) -> Option<S> {
        unreachable!("the engine asks for both")
    }
    fn limits<S: Scalar>(&self, zero: S, _: [S; 0]) -> Option<[S; 2]> {
        Some(self.0.map(|limit| zero.constant(limit)))
    }
    fn rates<S: Scalar>(&self, _: Motion<S>, _: S, memory: [S; 0]) -> [S; 0] {
        memory
    }
}

#[test]
fn laws_by_direction_are_checked() {
    let infinite = f64::INFINITY;
    for limits in [[0.1, 0.2], [0.0, infinite], [infinite, 0.3], [0.0, 0.0]] {
        assert!(Contact::new(0, Given(limits), 1.0).is_ok(), "{limits:?}");
    }
    for limits in [
        [infinite; 2],
        [0.1, -0.1],
        [-1.0, infinite],
        [f64::NAN, infinite],
        [0.1, f64::NAN],
    ] {
        let made = Contact::new(0, Given(limits), 1.0).map(drop);
        refused!(made => Error::InvalidParameter { name: "static_coefficient", .. });
    }
    // Each direction has its own kinetic coefficient.
    let bad = Directional::new(even(0.2), Tabulated::new([(0.0, 0.3), (1.0, 0.2)]).unwrap());
    assert!(bad.is_ok());
    for (wrap, static_coefficient) in [(-1.0, 0.3), (f64::NAN, 0.3), (1e4, 0.3), (infinite, 0.0)] {
        let made = Directional::capstan(static_coefficient, 0.0, wrap);
        refused!(made => Error::InvalidParameter { of: "Directional", name: "wrap", .. });
    }
    // Elastic contacts have one coefficient.
    let sided = Directional::new(even(0.2), even(0.6)).unwrap();
    let elastic = Contact::new(0, sided, 1.0)
        .unwrap()
        .with_tangential_stiffness(2.0);
    let coefficients = refused!(elastic => Error::LawNotConstant { coefficients }, coefficients);
    assert_eq!(coefficients, Some([0.6, 0.2]));
    let same = Directional::new(even(0.2), even(0.2)).unwrap();
    assert!(
        Contact::new(0, same, 1.0)
            .unwrap()
            .with_tangential_stiffness(2.0)
            .is_ok()
    );
    let freewheel = Contact::freewheel(0, 1)
        .unwrap()
        .with_tangential_stiffness(2.0);
    refused!(freewheel => Error::LawNotConstant { .. });
}

/// An oscillator with these kinetic coefficients forward and backward, at rest.
fn oscillator(parameters: &[f64]) -> Result<(Structure, State), Error> {
    let law = |of: f64| Coulomb::new(1.2 * of, of);
    let law = Directional::new(law(parameters[0])?, law(parameters[1])?)?;
    let system = Structure::new(&[1.0])?
        .with_ground_spring(0, 4.0)?
        .with_ground_damper(0, 0.1)?
        .with_force(0, sine(3.0, 1.1))?
        .with_contact(Contact::new(0, law, 1.0)?)?;
    Ok((system, State::at_rest(1)))
}

/// A periodic motion under unequal friction is not symmetric.
#[test]
fn unequal_friction_breaks_the_symmetry() {
    let find = |parameters: [f64; 2]| {
        let (system, start) = oscillator(&parameters).unwrap();
        orbit::settle(&system, &start, 200.0, Period::Driven(1)).unwrap()
    };
    let [equal, sided] = [find([0.4, 0.4]), find([0.3, 0.6])];
    assert!(equal.is_symmetric() && !sided.is_symmetric());
    assert!(sided.is_stable());
    let (low, high) = sided.extremes(0);
    // It slips all the time: the mean force of friction moves its centre.
    assert_abs_diff_eq!(0.5 * (low + high), 0.5 * (0.6 - 0.3) / 4.0, epsilon = 1e-9);
    // Two contacts that make up for each other: the motion is symmetric, and friction is not.
    let law = Directional::new(even(0.3), even(0.6)).unwrap();
    let back = Directional::new(even(0.6), even(0.3)).unwrap();
    let both = Structure::new(&[1.0])
        .and_then(|s| s.with_ground_spring(0, 4.0)?.with_ground_damper(0, 0.1))
        .and_then(|s| s.with_force(0, sine(6.0, 1.1)))
        .and_then(|s| s.with_contact(Contact::new(0, law, 1.0)?))
        .and_then(|s| s.with_contact(Contact::new(0, back, 1.0)?))
        .unwrap();
    let found = orbit::settle(&both, &State::at_rest(1), 200.0, Period::Driven(1)).unwrap();
    let (low, high) = found.extremes(0);
    assert_abs_diff_eq!(low, -high, epsilon = 1e-9);
    assert!(!found.is_symmetric());
}

/// Derivatives of a motion through stick, releases and crossings, against differences.
#[test]
fn motions_of_unequal_friction_have_derivatives() {
    const H: f64 = 1e-6;
    let (parameters, end) = ([0.8, 1.6], 21.0);
    let found = orbit::sensitivities(oscillator, &parameters, end).unwrap();
    let derivative = found.at(end).unwrap();
    let at = |changed: [f64; 2]| {
        let (system, start) = oscillator(&changed).unwrap();
        let motion = system.simulate(start, end).unwrap();
        let times: Vec<f64> = motion.events().iter().map(|event| event.time).collect();
        (motion.last(), times)
    };
    for j in 0..2 {
        let moved = |by: f64| {
            let mut changed = parameters;
            changed[j] += by;
            at(changed)
        };
        let [(low, early), (high, late)] = [moved(-H), moved(H)];
        assert!(early.len() > 6 && early.len() == late.len());
        let slope = (high.displacements[0] - low.displacements[0]) / (2.0 * H);
        assert_abs_diff_eq!(derivative[(0, j)], slope, epsilon = 1e-7);
        let slope = (high.velocities[0] - low.velocities[0]) / (2.0 * H);
        assert_abs_diff_eq!(derivative[(1, j)], slope, epsilon = 1e-7);
        for (k, event) in found.events().iter().enumerate() {
            let slope = (late[k] - early[k]) / (2.0 * H);
            assert_abs_diff_eq!(event.by_parameters[j], slope, epsilon = 1e-6);
        }
    }
}

/// A freewheel at rest has an infinite limit, which no coefficient of a series beside it
/// overflows. It moves as a contact with a limit that is large.
#[test]
fn a_freewheel_rests_beside_a_contact_that_is_stiff_in_the_speed() {
    let creeping = RateState::aging(0.4, 0.09, 0.1, 0.3, 0.1).unwrap();
    let steep = Stribeck::new(0.4, 0.25, 0.1, 1)
        .and_then(|law| law.with_viscous_coefficient(1e4))
        .unwrap();
    let mut random = Random::new(62);
    for i in 0..count(12, 200) {
        let [m, n, k, l, load, force] = [(); 6].map(|()| random.uniform(0.5, 2.0));
        let (frequency, belt) = (random.uniform(0.5, 2.0), random.uniform(-0.5, 0.5));
        let moved = |is_freewheel: bool| {
            let pair = || {
                Structure::new(&[m, n])?
                    .with_ground_spring(0, k)?
                    .with_ground_spring(1, l)?
                    .with_ground_damper(0, 0.1)?
                    .with_ground_damper(1, 0.1)?
                    .with_force(1, Drive::harmonic(force, frequency, 0.5)?)
            };
            let joint = |structure: Structure| match is_freewheel {
                true => {
                    let law = Freewheel::new(even(0.3))?;
                    structure.with_contact(Contact::between(0, 1, law, 1.1)?)
                }
                false => {
                    let law = Directional::new(even(1e7), even(0.3))?;
                    structure.with_contact(Contact::between(0, 1, law, 1.1)?)
                }
            };
            let belted = match i % 2 {
                0 => pair()?.with_contact(Contact::new(0, creeping, load)?.on_belt(belt))?,
                _ => pair()?.with_contact(Contact::new(0, steep, load)?.on_belt(belt))?,
            };
            let memory = vec![0.0; 1 - i % 2];
            let start = State::new(&[0.2; 2], &[0.0, 0.1]).with_memory(&memory);
            let fine = Integrator::new().with_tolerance(1e-14)?;
            fine.simulate(&joint(belted)?, start, 15.0)
        };
        let [wheel, limit] = [true, false].map(|wheel| moved(wheel).unwrap());
        let [wheel, limit] = [wheel, limit].map(|motion| motion.last());
        for (a, b) in std::iter::zip(wheel.displacements, limit.displacements) {
            assert!(
                (a - b).abs() < 1e-11 * a.abs().max(1.0),
                "{i}: {a:e}, {b:e}"
            );
        }
    }
}
