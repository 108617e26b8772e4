//! Contacts with linearly dependent directions that are at rest together: brakes and clutches in a
//! ring, parallel pads.

use std::f64::consts::FRAC_PI_2;

use approx::{assert_abs_diff_eq, assert_relative_eq};
use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Direction, Directional, Drive, EventKind, ForceElement, Freewheel, Mode, Structure,
    TabulatedForce, Trajectory,
};

use crate::common::{Random, count, even, forces, keys, list, text};
use crate::naive::relax;
use crate::reading::{cases, numbers, structure};

/// A mass on a breakpoint of its spring is pulled off to either side: several pads that share the
/// load move as one.
#[test]
fn pads_released_on_a_breakpoint_move_as_one() {
    let spring = [(-1.0, -1.0), (0.0, 0.0), (1.0, 4.0)];
    let spring = TabulatedForce::piecewise_linear(&spring).unwrap();
    for side in [-1.0, 1.0] {
        let pull = Drive::profile(&[(0.0, 0.0), (10.0, side)]).unwrap();
        let run = |pads: usize| {
            let mut block = Structure::new(&[1.0])
                .and_then(|block| block.with_force(0, pull.clone()))
                .and_then(|block| block.with_element(ForceElement::new(0, spring.clone())?))
                .unwrap();
            for _ in 0..pads {
                let pad = Contact::new(0, even(0.3), 1.0 / pads as f64).unwrap();
                block = block.with_contact(pad).unwrap();
            }
            let motion = block.simulate(State::at_rest(1), 8.0).unwrap();
            let budget = block.energy_budget(&motion).unwrap();
            assert!(budget.defect().abs() < 1e-14, "{:e}", budget.defect());
            motion.last()
        };
        let one = run(1);
        for pads in [2, 3] {
            let several = run(pads);
            let [found, expected] = [&several, &one].map(|state| state.displacements[0]);
            assert_abs_diff_eq!(found, expected, epsilon = 1e-13);
        }
    }
}

/// Two shafts, a brake on each and a clutch between them, with a torque that grows by 1 in a unit
/// of time on shaft 0.
fn ring(limits: [f64; 3], change: impl Fn(Contact) -> Contact) -> Structure {
    let torque = Drive::profile(&[(0.0, 0.0), (20.0, 20.0)]).unwrap();
    driven_ring(limits, torque, change)
}

fn driven_ring(limits: [f64; 3], torque: Drive, change: impl Fn(Contact) -> Contact) -> Structure {
    let [first, second, clutch] = limits;
    let contacts = [
        Contact::new(0, even(1.0), first).unwrap(),
        Contact::new(1, even(1.0), second).unwrap(),
        Contact::between(0, 1, even(1.0), clutch).unwrap(),
    ];
    Structure::new(&[1.0, 1.0])
        .and_then(|s| s.with_force(0, torque)?.with_contacts(contacts.map(change)))
        .unwrap()
}

/// A ring slips where the least sum of limits around shaft 0 is reached, at min(B_0 + B_c, B_0 +
/// B_1), by the contacts of that sum.
#[test]
fn a_ring_slips_at_the_least_sum_of_limits() {
    let forward = EventKind::Release(Direction::Leading);
    for (limits, time, contacts) in [
        ([3.0, 5.0, 4.0], 7.0, [0, 2]),
        ([3.0, 4.0, 5.0], 7.0, [0, 1]),
        ([1.0, 0.5, 9.0], 1.5, [0, 1]),
    ] {
        let ring = ring(limits, |contact| contact);
        let motion = ring.simulate(State::at_rest(2), 9.0).unwrap();
        let first: Vec<_> = keys(&motion).into_iter().take(2).collect();
        assert_eq!(first, contacts.map(|c| (c, forward)));
        assert_abs_diff_eq!(motion.events()[0].time, time, epsilon = 2e-15);
    }
    // From 7 on shaft 0 accelerates by t − 7.
    let ring = ring([3.0, 5.0, 4.0], |contact| contact);
    let motion = ring.simulate(State::at_rest(2), 9.0).unwrap();
    assert_abs_diff_eq!(motion.last().velocities[0], 2.0, epsilon = 1e-14);
    assert_eq!(motion.last().velocities[1], 0.0);
    // What each may carry at a torque of 6: brake 0 and the clutch share it, and the other brake
    // holds the clutch.
    let carried = ring.carried(6.0, &State::at_rest(2)).unwrap();
    for (carried, [least, most]) in carried.iter().zip([[2.0, 3.0], [3.0, 4.0], [3.0, 4.0]]) {
        assert!(!carried.is_determined());
        assert_abs_diff_eq!(carried.least, least, epsilon = 1e-14);
        assert_abs_diff_eq!(carried.most, most, epsilon = 1e-14);
        assert!(carried.least <= carried.force && carried.force <= carried.most);
    }
    assert_abs_diff_eq!(carried[0].force + carried[2].force, 6.0, epsilon = 1e-14);
    assert_abs_diff_eq!(carried[1].force, carried[2].force, epsilon = 1e-14);
    // At its limit all of them are determined.
    let carried = ring.carried(7.0, &State::at_rest(2)).unwrap();
    assert!(carried.iter().all(|carried| carried.is_determined()));
    assert_eq!(forces(&carried), [3.0, 4.0, 4.0]);
}

/// The largest distance of two motions in displacements, and in velocities.
fn apart(one: &Trajectory<State>, other: &Trajectory<State>, end: f64) -> [f64; 2] {
    let mut apart = [0.0_f64; 2];
    for i in 0..=900 {
        let time = end * f64::from(i) / 900.0;
        let [a, b] = [one, other].map(|motion| motion.state_at(time).unwrap());
        for j in 0..2 {
            apart[0] = apart[0].max((a.displacements[j] - b.displacements[j]).abs());
            apart[1] = apart[1].max((a.velocities[j] - b.velocities[j]).abs());
        }
    }
    apart
}

/// Elastic contacts carry determined forces, and tend to the motion of rigid ones as their
/// stiffness k grows: displacements with 1/k. So do velocities until contacts come to rest; then
/// these vibrate by Δ/k at the frequency √k for ever, and velocities tend with 1/√k.
#[test]
fn stiff_elastic_contacts_move_as_rigid_ones() {
    let up = [(0.0, 0.0), (20.0, 20.0)];
    let and_down = [(0.0, 0.0), (9.0, 9.0), (12.0, 3.0)];
    for (torque, end, events, orders) in [
        (&up[..], 9.0, 2, [1.0; 2]),
        (&and_down, 13.0, 4, [1.0, 0.5]),
    ] {
        let torque = Drive::profile(torque).unwrap();
        let moved = |change: &dyn Fn(Contact) -> Contact| {
            let ring = driven_ring([3.0, 5.0, 4.0], torque.clone(), change);
            ring.simulate(State::at_rest(2), end).unwrap()
        };
        let rigid = moved(&|contact| contact);
        assert_eq!(rigid.events().len(), events);
        let [soft, stiff] = [1e3, 1.024e6].map(|stiffness| {
            let spring = |c: Contact| c.with_tangential_stiffness(stiffness).unwrap();
            apart(&rigid, &moved(&spring), end)
        });
        assert!(soft[0] < 0.03, "{soft:?}");
        for (k, order) in orders.into_iter().enumerate() {
            let measured = (soft[k] / stiff[k]).ln() / 1024.0_f64.ln();
            // The phase of the vibration at the events differs.
            assert_abs_diff_eq!(measured, order, epsilon = 0.05);
        }
    }
}

/// The motions of the reference file with dependent contacts, with each contact replaced by two
/// parallel ones, and with the contacts in another order.
#[test]
fn parts_of_a_contact_move_as_the_whole() {
    let all = cases(include_str!("../data/limits_trajectories.json"));
    let of = |name: &str| all.iter().find(|case| text(&case["family"]) == name);
    for name in [
        "ring_brakes_clutch",
        "planetary_at_rest",
        "ring_static_above",
    ] {
        let case = of(name).unwrap();
        let whole = structure(&case["system"], f64::NAN);
        let n = whole.len();
        let start = State::new(&numbers(&case["start"]["q"]), &numbers(&case["start"]["v"]));
        let end = 12.0;
        let motion = whole.simulate(start.clone(), end).unwrap();
        let loads: Vec<Drive> = whole.contacts().iter().map(|c| c.load().clone()).collect();
        let part = |c: usize, part: f64| {
            let given = &list(&case["system"]["contacts"])[c];
            let direction: Vec<_> = numbers(&given["direction"])
                .into_iter()
                .enumerate()
                .collect();
            let law = crate::reading::law(given, f64::NAN);
            let load = scaled(&given["N0"], part).unwrap_or_else(|| loads[c].clone());
            Contact::along(&direction, law, load).unwrap()
        };
        let bare = |contacts: Vec<Contact>| {
            let mut bare = Structure::with_mass_matrix(whole.mass_matrix().into_owned())
                .and_then(|s| s.with_stiffness(whole.stiffness().clone()))
                .and_then(|s| s.with_damping(whole.damping().clone()))
                .and_then(|s| s.with_contacts(contacts))
                .unwrap();
            for (i, force) in whole.forces().iter().enumerate() {
                bare = bare.with_force(i, force.clone()).unwrap();
            }
            bare
        };
        let thirds = [1.0 / 3.0, 2.0 / 3.0];
        let in_two = (0..3).flat_map(|c| thirds.map(|x| part(c, x)));
        let in_order = [2, 0, 1].map(|c| part(c, 1.0));
        for other in [bare(in_two.collect()), bare(in_order.to_vec())] {
            let found = other.simulate(start.clone(), end).unwrap();
            let times = |motion: &Trajectory<State>| {
                let mut times: Vec<f64> = motion.events().iter().map(|e| e.time).collect();
                times.dedup();
                times
            };
            let (expected, found_times) = (times(&motion), times(&found));
            assert_eq!(expected.len(), found_times.len(), "{name}");
            for (a, b) in expected.iter().zip(found_times) {
                assert_abs_diff_eq!(*a, b, epsilon = 1e-12);
            }
            for i in 0..n {
                let [a, b] = [&motion, &found].map(|m| m.last().velocities[i]);
                assert_abs_diff_eq!(a, b, epsilon = 1e-12);
            }
        }
    }
}

/// A load of the reference file, multiplied by a part.
fn scaled(load: &serde_json::Value, part: f64) -> Option<Drive> {
    if load.is_string() {
        return Some((part * crate::common::number(load)).into());
    }
    let (times, values) = (numbers(&load["t"]), numbers(&load["values"]));
    let mut points = vec![(times[0], part * values[0])];
    for k in 1..times.len() {
        points.extend([
            (times[k], part * values[k - 1]),
            (times[k], part * values[k]),
        ]);
    }
    Drive::profile(&points).ok()
}

/// Energy and momentum along the motions of the reference file: no contact at rest makes heat.
#[test]
fn energies_balance() {
    let all = cases(include_str!("../data/limits_trajectories.json"));
    let dependent = all.iter().filter(|case| case["gap"].as_u64() == Some(1));
    for case in dependent {
        let system = structure(&case["system"], f64::NAN);
        let start = State::new(&numbers(&case["start"]["q"]), &numbers(&case["start"]["v"]));
        let end = crate::common::number(&case["t_end"]);
        let motion = system.simulate(start, end).unwrap();
        let budget = system.energy_budget(&motion).unwrap();
        let size = budget.friction_loss.iter().sum::<f64>() + budget.damper_loss;
        assert!(
            budget.defect().abs() < 1e-13 * size,
            "{} {budget:?}",
            case["id"]
        );
        // Forces of samples balance the accelerations, and are within their limits.
        for sample in system.samples(&motion, 0.37).unwrap() {
            let (q, v) = (&sample.state.displacements, &sample.state.velocities);
            let [q, v, a] = [q, v, &sample.accelerations].map(|x| DVector::from_column_slice(x));
            let given = system.forces().iter().map(|force| force.value(sample.time));
            let mut rest = DVector::from_iterator(system.len(), given);
            rest -= system.mass_matrix().as_ref() * a;
            rest -= system.stiffness() * q + system.damping() * v;
            for (c, contact) in system.contacts().iter().enumerate() {
                for &(j, b) in contact.direction() {
                    rest[j] -= b * sample.friction[c];
                }
                let given = &list(&case["system"]["contacts"])[c]["law_params"]["mus"];
                let most = sample.loads[c] * crate::common::number(given);
                assert!(
                    sample.friction[c].abs() <= most * (1.0 + 1e-13),
                    "{}",
                    case["id"]
                );
            }
            assert!(rest.amax() < 1e-13 * 40.0, "{} {rest}", case["id"]);
        }
    }
}

/// Random contacts at rest with dependent directions: accelerations are those of the programme, by
/// sweeps over single forces.
struct Drawn {
    structure: Structure,
    rows: DMatrix<f64>,
    inverse: DMatrix<f64>,
    force: DVector<f64>,
    /// Backward and forward.
    limits: Vec<[f64; 2]>,
}

impl Drawn {
    fn new(random: &mut Random) -> Self {
        let n = 1 + (random.bits() % 4) as usize;
        let k = n + 1 + (random.bits() % 3) as usize;
        let part = DMatrix::from_fn(n, n, |_, _| random.uniform(-0.7, 0.7));
        let diagonal = DVector::from_fn(n, |_, _| random.uniform(0.5, 2.0));
        let mass = DMatrix::from_diagonal(&diagonal) + &part * part.transpose();
        let force = DVector::from_fn(n, |_, _| random.uniform(-2.0, 2.0));
        let mut structure = Structure::with_mass_matrix(mass.clone()).unwrap();
        for i in 0..n {
            structure = structure.with_force(i, force[i]).unwrap();
        }
        let mut rows = DMatrix::zeros(k, n);
        let mut limits = vec![];
        for c in 0..k {
            let i = (random.bits() % n as u64) as usize;
            let other = (i + 1 + (random.bits() % n as u64) as usize) % n;
            let direction = if i == other || random.bits().is_multiple_of(2) {
                vec![(i, 1.0)]
            } else {
                vec![(i, 1.0), (other, -1.0)]
            };
            for &(j, b) in &direction {
                rows[(c, j)] = b;
            }
            let mut limit = [0, 1].map(|_| random.uniform(0.1, 1.5));
            let contact = match random.bits() % 4 {
                0 | 1 => {
                    limit[1] = limit[0];
                    Contact::along(&direction, even(0.5), 2.0 * limit[0])
                }
                2 => {
                    let law = Directional::new(even(0.5 * limit[1]), even(0.5 * limit[0]));
                    Contact::along(&direction, law.unwrap(), 2.0)
                }
                _ => {
                    limit[1] = f64::INFINITY;
                    let law = Freewheel::new(even(0.5)).unwrap();
                    Contact::along(&direction, law, 2.0 * limit[0])
                }
            };
            limits.push(limit);
            structure = structure.with_contact(contact.unwrap()).unwrap();
        }
        Self {
            structure,
            rows,
            inverse: mass.try_inverse().unwrap(),
            force,
            limits,
        }
    }

    /// v' of the programme; with a force held at a value also how far that is from balance.
    fn accelerations(&self, held: Option<(usize, f64)>) -> DVector<f64> {
        let k = self.limits.len();
        let compliance = &self.rows * &self.inverse * self.rows.transpose();
        let free = &self.rows * &self.inverse * &self.force;
        let mut carried = DVector::zeros(k);
        if let Some((c, value)) = held {
            carried[c] = value;
        }
        relax(
            &compliance,
            &free,
            &self.limits,
            &mut carried,
            held.map(|(c, _)| c),
        );
        &self.inverse * (&self.force - self.rows.transpose() * carried)
    }
}

/// Two freewheels and a brake are at or near their limits, and a third freewheel carries the rest
/// on its side without a limit: its rounding errors, of 2e-8, were given to one that has no room.
#[test]
fn a_share_without_a_limit_keeps_the_balance() {
    let mass = DMatrix::from_row_slice(
        2,
        2,
        &[
            1.329996584025747,
            -0.31724640005278126,
            -0.31724640005278126,
            0.8096617721737038,
        ],
    );
    let force = [-0.9013021783991961, 1.0070603834217664];
    let freewheel = |direction: &[(usize, f64)], load: f64| {
        Contact::along(direction, Freewheel::new(even(0.5)).unwrap(), load).unwrap()
    };
    let system = Structure::with_mass_matrix(mass)
        .and_then(|s| s.with_force(0, force[0])?.with_force(1, force[1]))
        .and_then(|s| s.with_contact(freewheel(&[(0, 1.0)], 0.36928022214296424)))
        .and_then(|s| s.with_contact(freewheel(&[(0, 1.0), (1, -1.0)], 1.061294866152712)))
        .and_then(|s| s.with_contact(freewheel(&[(1, 1.0)], 0.3778941204428813)))
        .and_then(|s| s.with_contact(Contact::new(0, even(0.5), 0.6192695535212707)?))
        .unwrap();
    let state = State::at_rest(2);
    assert_eq!(system.acceleration(0.0, &state).unwrap(), [0.0; 2]);
    let carried = forces(&system.carried(0.0, &state).unwrap());
    let left = force[0] - carried[0] - carried[1] - carried[3];
    assert_abs_diff_eq!(left, 0.0, epsilon = 1e-15);
    let left = force[1] + carried[1] - carried[2];
    assert_abs_diff_eq!(left, 0.0, epsilon = 1e-15);
}

/// A force without a limit costs nothing in Σ (λ/B)², so a clutch beside a backstop carries nothing
/// of what the backstop can hold, and all of what it cannot.
#[test]
fn a_freewheel_relieves_the_clutch_beside_it() {
    let held = |force: f64| {
        let shaft = Structure::new(&[1.3])
            .and_then(|s| s.with_force(0, force))
            .and_then(|s| s.with_contact(Contact::new(0, even(0.5), 0.7)?))
            .and_then(|s| s.with_contact(Contact::new(0, Freewheel::new(even(0.2))?, 0.9)?))
            .unwrap();
        forces(&shaft.carried(0.0, &State::at_rest(1)).unwrap())
    };
    // Slip backward is limited by both: 0.35 and 0.18, in the ratio of the squares.
    let squares = [0.35_f64.powi(2), 0.18_f64.powi(2)];
    for force in [0.2, 0.01, 5.0] {
        let carried = held(force);
        assert_abs_diff_eq!(carried[0], 0.0, epsilon = 1e-15);
        assert_abs_diff_eq!(carried[1], force, epsilon = 1e-15);
        let carried = held(-0.1 * force.min(1.0));
        for (carried, square) in carried.iter().zip(squares) {
            let share = -0.1 * force.min(1.0) * square / (squares[0] + squares[1]);
            assert_abs_diff_eq!(*carried, share, epsilon = 1e-15);
        }
    }
}

#[test]
fn decisions_of_dependent_contacts_solve_the_programme() {
    let mut random = Random::new(73);
    let (mut rest, mut ranges) = (0, 0);
    let cases = count(25, 250);
    for case in 0..cases {
        let drawn = Drawn::new(&mut random);
        let structure = &drawn.structure;
        let state = State::at_rest(structure.len());
        let found = structure.acceleration(0.0, &state).unwrap();
        let expected = drawn.accelerations(None);
        for (found, expected) in found.iter().zip(&expected) {
            assert_abs_diff_eq!(found, expected, epsilon = 1e-11);
        }
        let carried = structure.carried(0.0, &state).unwrap();
        let balance = &drawn.inverse
            * (&drawn.force - drawn.rows.transpose() * DVector::from_vec(forces(&carried)));
        assert_abs_diff_eq!(balance, DVector::from_vec(found), epsilon = 1e-13);
        for (c, of) in carried.iter().enumerate() {
            let [least, most] = drawn.limits[c].map(|limit| limit * (1.0 + 1e-13));
            assert!(
                -least <= of.force && of.force <= most,
                "{case} {of:?} {least} {most}"
            );
            assert!(of.least <= of.force && of.force <= of.most, "{case} {of:?}");
            if of.is_determined() {
                continue;
            }
            rest += 1;
            // The ends of the range are possible, and nothing beyond them.
            let ends = [(of.least, -1e-3), (of.most, 1e-3)];
            for (end, beyond) in ends.into_iter().filter(|(end, _)| end.is_finite()) {
                let apart = |value: f64| {
                    let held = drawn.accelerations(Some((c, value)));
                    (held - &expected).amax()
                };
                assert!(apart(end) < 1e-6, "{case} {c} {of:?}");
                let [least, most] = drawn.limits[c];
                if (-least..most).contains(&(end + beyond)) {
                    assert!(apart(end + beyond) > 1e-6, "{case} {c} {of:?}");
                    ranges += 1;
                }
            }
        }
    }
    println!("{rest} forces not determined, {ranges} ends of ranges inside the limits");
    assert!(rest > cases && ranges > cases / 4);
}

/// Loads that grow in proportion are carried up to the least factor of a mechanism; beyond it the
/// contacts of this mechanism slip, in its proportions, and no others.
#[test]
fn loads_grow_up_to_the_first_mechanism() {
    const REST: f64 = 0.05;
    let mut random = Random::new(74);
    let (mut compared, mut several) = (0, 0);
    for case in 0..count(60, 600) {
        let mut drawn = Drawn::new(&mut random);
        let n = drawn.structure.len();
        let mut structure = drawn.structure.clone();
        for i in 0..n {
            structure = structure
                .with_force(i, (REST - 1.0) * drawn.force[i])
                .unwrap();
        }
        let state = State::at_rest(n);
        let still = structure.acceleration(0.0, &state).unwrap();
        if still.iter().any(|a| *a != 0.0) {
            continue;
        }
        let mechanisms = structure.mechanisms(0.0, &state).unwrap();
        let mut factors: Vec<(f64, usize)> = Vec::new();
        for (number, mechanism) in mechanisms.iter().enumerate() {
            assert!(mechanism.margin() > 0.0, "{case} {mechanism:?}");
            let sum: f64 = mechanism.contacts.iter().fold(0.0, |sum, &(c, slip)| {
                sum + slip.abs() * drawn.limits[c][usize::from(slip > 0.0)]
            });
            assert_relative_eq!(mechanism.resistance, sum, max_relative = 1e-13);
            if mechanism.power > 1e-6 {
                factors.push((mechanism.resistance / mechanism.power, number));
            }
        }
        factors.sort_by(|a, b| a.0.total_cmp(&b.0));
        let [(first, number), (second, _), ..] = factors[..] else {
            continue;
        };
        let force = &drawn.force * REST;
        drawn.force = &force * (first * (1.0 - 1e-3));
        // The sweeps stop while changes are still small.
        assert!(drawn.accelerations(None).amax() < 1e-6, "{case}");
        drawn.force = &force * (first * (1.0 + 1e-3));
        let slips = &drawn.rows * drawn.accelerations(None);
        assert!(slips.amax() > 1e-5, "{case}");
        if second < 1.02 * first {
            continue;
        }
        let slipping = &mechanisms[number].contacts;
        for c in 0..drawn.limits.len() {
            let found = slipping
                .iter()
                .find(|(d, _)| *d == c)
                .map_or(0.0, |(_, slip)| *slip);
            let (one, _) = slipping[0];
            let slip = slips[c] / slips[one] * slipping[0].1;
            assert_abs_diff_eq!(found, slip, epsilon = 1e-2);
        }
        compared += 1;
        several += usize::from(slipping.len() > 1);
    }
    println!("{compared} mechanisms compared, {several} of several contacts");
    assert!(compared > 20 && several > 10);
}

/// Belts that move in the same way hold together; one that speeds up is left by its contact.
#[test]
fn surfaces_that_part_do_not_hold_together() {
    let belt = |late: f64| Drive::profile(&[(0.0, 0.3), (2.0, 0.3), (4.0, late)]).unwrap();
    let block = |late: f64| {
        Structure::new(&[2.0])
            .and_then(|s| s.with_contact(Contact::new(0, even(0.5), 3.0)?.on_belt(belt(0.3))))
            .and_then(|s| s.with_contact(Contact::new(0, even(0.5), 1.0)?.on_belt(belt(late))))
            .unwrap()
    };
    let start = State::new(&[0.0], &[0.3]);
    let motion = block(0.3).simulate(start.clone(), 5.0).unwrap();
    assert!(motion.events().is_empty());
    let motion = block(0.9).simulate(start.clone(), 3.0).unwrap();
    assert_eq!(keys(&motion), [(1, EventKind::Release(Direction::Lagging))]);
    assert_eq!(motion.events()[0].time, 2.0);
    assert_eq!(motion.mode_at(0, 2.5), Some(Mode::Stick));
    // Two that start together, and part with their second derivatives only.
    let swinging = |size: f64| {
        Drive::harmonic(size, 1.0, 0.0)
            .unwrap()
            .with_constant(-size)
    };
    let block = Structure::new(&[2.0])
        .and_then(|s| s.with_contact(Contact::new(0, even(0.5), 3.0)?.on_belt(swinging(0.1)?)))
        .and_then(|s| s.with_contact(Contact::new(0, even(0.5), 1.0)?.on_belt(swinging(0.3)?)))
        .unwrap();
    let motion = block.simulate(State::at_rest(1), 1.0).unwrap();
    assert_eq!(motion.mode_at(0, 0.5), Some(Mode::Stick));
    assert_eq!(motion.mode_at(1, 0.5), Some(Mode::Slip(Direction::Leading)));
    assert_relative_eq!(motion.last().velocities[0], 0.1 * (1.0_f64.cos() - 1.0));
}

/// A belt that turns back takes the mass along by a freewheel, off the ground and off the freewheel
/// there: both are asked whether they can rest with the one on the belt, in any order.
#[test]
fn a_belt_that_turns_back_leaves_no_contact_behind() {
    const BELT: f64 = 0.4;
    for order in [
        [0, 1, 2],
        [0, 2, 1],
        [1, 0, 2],
        [1, 2, 0],
        [2, 0, 1],
        [2, 1, 0],
    ] {
        let mut block = Structure::new(&[1.0]).unwrap();
        for which in order {
            let freewheel = || Contact::new(0, Freewheel::new(even(0.1))?, 1.0);
            let contact = match which {
                0 => Contact::new(0, even(0.3), 1.0),
                1 => freewheel(),
                _ => freewheel().map(|it| it.on_belt(Drive::harmonic(BELT, 1.0, 0.0).unwrap())),
            };
            block = block.with_contact(contact.unwrap()).unwrap();
        }
        let motion = block.simulate(State::at_rest(1), 3.0).unwrap();
        let place = |which: usize| order.iter().position(|&it| it == which).unwrap();
        let mut expected = [
            (place(0), EventKind::Release(Direction::Lagging)),
            (place(1), EventKind::Release(Direction::Lagging)),
            (place(2), EventKind::Stick),
        ];
        expected.sort_by_key(|&(c, _)| c);
        assert_eq!(keys(&motion), expected, "{order:?}");
        for event in motion.events() {
            assert_abs_diff_eq!(event.time, FRAC_PI_2, epsilon = 1e-15);
        }
        assert_abs_diff_eq!(
            motion.last().velocities[0],
            BELT * 3.0_f64.cos(),
            epsilon = 1e-15
        );
        let way = BELT * (3.0_f64.sin() - 1.0);
        assert_abs_diff_eq!(motion.last().displacements[0], way, epsilon = 1e-15);
    }
}
