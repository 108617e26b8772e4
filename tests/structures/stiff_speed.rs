//! Contacts whose friction rises so steeply with the sliding speed that slip settles on a slow
//! manifold: in a structure as on a belt, and in structures of several masses.

use crate::common::radau::{Matrix, STAGES, corrections, end, weights};
use crate::common::{Random, Worst, count};
use stick_slip::structure::State;
use stick_slip::{
    AnyLaw, Contact, FrictionLaw, Integrator, MassOnBelt, Polynomial, Segment, Stribeck, Structure,
    Tabulated, Trajectory,
};

/// A law that rises steeply beyond its least value, and a belt.
fn steep(random: &mut Random, i: usize) -> (AnyLaw, f64) {
    let law = match i % 3 {
        0 => Stribeck::new(0.4, 0.25, random.logarithmic(1e-3, 1.0), 2)
            .and_then(|law| law.with_viscous_coefficient(random.logarithmic(1.0, 1e8)))
            .unwrap()
            .into(),
        1 => Polynomial::new(0.4, 0.25, random.logarithmic(1e-5, 0.3))
            .unwrap()
            .into(),
        _ => {
            let width = random.logarithmic(1e-6, 0.1);
            let points = [
                (0.0, 0.4),
                (width, 0.3),
                (2.0 * width, 0.35),
                (4.0 * width, 0.5),
                (10.0 * width, 3.0),
                (1000.0 * width, 1000.0),
            ];
            Tabulated::new(points).unwrap().into()
        }
    };
    (law, random.logarithmic(1e-3, 1.0))
}

/// The error of a time that is accepted, relative from time 1 on.
const TIMES: f64 = 1e-12;

/// Checks that there are at most so many more steps than on a belt.
fn assert_as_few(found: usize, expected: usize, about: &str) {
    assert!(
        2 * found <= 3 * expected + 30,
        "{about}: {found} beside {expected}"
    );
}

/// The engine of one mass, which has Newton's method for the whole series, is the witness.
#[test]
fn one_mass_moves_as_on_its_belt() {
    let (mut worst, mut random) = (Worst::default(), Random::new(54));
    let all = count(60, 2000);
    let [mut one, mut other] = [0, 0];
    for i in 0..all {
        let (law, velocity) = steep(&mut random, i);
        let belt = MassOnBelt::new(law, velocity)
            .and_then(|belt| belt.with_damping(random.uniform(0.0, 0.2)))
            .unwrap();
        let start = [(); 2].map(|()| random.uniform(-1.0, 1.0));
        let about = format!("{i}: {belt:?}");
        let start_there = stick_slip::State::new(start[0], start[1]);
        let expected = belt.simulate(start_there, 20.0).unwrap();
        let found = Structure::from(&belt)
            .simulate(State::new(&start[..1], &start[1..]), 20.0)
            .unwrap();
        assert_eq!(expected.events().len(), found.events().len(), "{about}");
        for (a, b) in std::iter::zip(expected.events(), found.events()) {
            assert_eq!((a.kind, Some(0)), (b.kind, b.contact()), "{about}");
            worst.meet_within(TIMES, &about, b.time, a.time);
        }
        for (time, a) in expected.sample(41) {
            let b = found.state_at(time).unwrap();
            let (u, slip) = (b.displacements[0], b.velocities[0] - velocity);
            worst.meet_within(1e-13, &about, u, a.displacement);
            // A hundredth of the belt's velocity, and its rounding; and what the speed changes by
            // within the error of a time. Before a stick it may fall by a thousand times its size
            // within one unit of time, so that an ulp of the time is more than its digits.
            let size = (a.velocity - velocity).abs().max(1e-2 * velocity);
            let earlier = (time - TIMES * time.max(1.0)).max(0.0);
            let change = expected.state_at(earlier).unwrap().velocity - a.velocity;
            let allowed = 1e-11 * size + change.abs();
            worst.meet_within(allowed, &about, slip, a.velocity - velocity);
        }
        (one, other) = (one + expected.steps().len(), other + found.steps().len());
        assert_as_few(found.steps().len(), expected.steps().len(), &about);
    }
    worst.assert("both engines", 1.0);
    assert!(10 * other < 11 * one, "{other} steps beside {one}");
}

fn ends<'a>(
    one: &'a Trajectory<State>,
    other: &'a Trajectory<State>,
) -> impl Iterator<Item = (State, State)> + 'a {
    (0..=40).map(|k| {
        let state = |motion: &Trajectory<State>| motion.state_at(0.5 * f64::from(k)).unwrap();
        (state(one), state(other))
    })
}

/// Three equal masses in a row that start alike move as one; and two contacts on one coordinate,
/// whose directions are dependent, as one with both loads.
#[test]
fn several_contacts_move_as_one() {
    let (mut worst, mut random) = (Worst::default(), Random::new(3));
    for i in 0..count(15, 500) {
        let (law, w) = steep(&mut random, i);
        let contact =
            |place: usize, load: f64| Contact::new(place, law.clone(), load).unwrap().on_belt(w);
        let one = Structure::new(&[1.0])
            .and_then(|one| one.with_ground_spring(0, 1.0))
            .unwrap();
        let twice = one
            .clone()
            .with_contacts([contact(0, 0.25), contact(0, 0.75)])
            .unwrap();
        let one = one.with_contact(contact(0, 1.0)).unwrap();
        let mut three = Structure::new(&[1.0; 3]).unwrap();
        for place in 0..3 {
            three = three
                .with_ground_spring(place, 1.0)
                .and_then(|three| three.with_contact(contact(place, 1.0)))
                .unwrap();
        }
        let three = three
            .with_spring(0, 1, 0.7)
            .and_then(|three| three.with_spring(1, 2, 0.4));
        let [q, v] = [(); 2].map(|()| random.uniform(-1.0, 1.0));
        let expected = one.simulate(State::new(&[q], &[v]), 20.0).unwrap();
        let found = [
            twice.simulate(State::new(&[q], &[v]), 20.0).unwrap(),
            three
                .unwrap()
                .simulate(State::new(&[q; 3], &[v; 3]), 20.0)
                .unwrap(),
        ];
        // The three can vibrate against each other, at up to √3.2 radians per unit of time. A
        // contact that settles less than 8 times as fast is not stiff beside that, and explicit
        // steps of 10/D are longer than 10/(8·√3.2).
        let faster = [0, 29];
        for (found, faster) in std::iter::zip(&found, faster) {
            let about = format!("{i}: {law:?} on {w}");
            for (a, b) in ends(&expected, found) {
                for q in &b.displacements {
                    worst.meet_within(1e-13, &about, *q, a.displacements[0]);
                }
                for v in &b.velocities {
                    worst.meet_within(1e-12, &about, *v, a.velocities[0]);
                }
            }
            assert_as_few(found.steps().len(), expected.steps().len() + faster, &about);
        }
    }
    worst.assert("one and several", 1.0);
}

/// Two masses with a stiff contact between them: their relative motion is that of one mass, and
/// their common motion, which no contact slows, the free vibration.
#[test]
fn a_contact_between_masses_leaves_their_common_motion() {
    let (mut worst, mut random) = (Worst::default(), Random::new(8));
    for i in 0..count(15, 500) {
        let (law, _) = steep(&mut random, i);
        let load = random.uniform(0.3, 2.0);
        let springs = |structure: Structure, n: usize| {
            (0..n).try_fold(structure, |structure, place| {
                structure.with_ground_spring(place, 1.0)
            })
        };
        let both = springs(Structure::new(&[1.0; 2]).unwrap(), 2)
            .and_then(|both| both.with_contact(Contact::between(1, 0, law.clone(), load)?))
            .unwrap();
        let relative = springs(Structure::new(&[1.0]).unwrap(), 1)
            .and_then(|one| one.with_contact(Contact::new(0, law.clone(), 2.0 * load)?))
            .unwrap();
        let [x, y, u, v] = [(); 4].map(|()| random.uniform(-1.0, 1.0));
        let start = State::new(&[y - 0.5 * x, y + 0.5 * x], &[v - 0.5 * u, v + 0.5 * u]);
        let found = both.simulate(start, 20.0).unwrap();
        let expected = relative.simulate(State::new(&[x], &[u]), 20.0).unwrap();
        let about = format!("{i}: {law:?} under {load}");
        for k in 0..=40 {
            let t = 0.5 * f64::from(k);
            let (a, b) = (expected.state_at(t).unwrap(), found.state_at(t).unwrap());
            let [one, other] = b.displacements[..] else {
                unreachable!("two masses");
            };
            worst.meet_within(2e-13, &about, other - one, a.displacements[0]);
            let free = y * t.cos() + v * t.sin();
            worst.meet_within(2e-13, &about, 0.5 * (one + other), free);
        }
        let vibration = 20;
        assert_as_few(
            found.steps().len(),
            expected.steps().len() + vibration,
            &about,
        );
    }
    worst.assert("relative and common motion", 1.0);
}

/// q' = v, v' of two masses on belts with a spring and a damper between them.
struct Pair {
    laws: [Stribeck; 2],
    belts: [f64; 2],
    weights: Matrix,
}

impl Pair {
    fn rates(&self, y: &[f64; 4]) -> [f64; 4] {
        let [p, q, v, w] = *y;
        let friction = |i: usize, v: f64| {
            let r = v - self.belts[i];
            self.laws[i].kinetic(r.abs()) * r.signum()
        };
        let between = 0.6 * (q - p) + 0.3 * (w - v);
        let forces = [
            between - p - friction(0, v),
            -between - 0.8 * q - friction(1, w),
        ];
        [v, w, forces[0], forces[1] / 1.7]
    }

    /// One step of Radau's method, by Newton's method.
    fn step(&self, y: &mut [f64; 4], h: f64) {
        let rates = |y: &[f64; 4]| self.rates(y);
        // Relative to the sliding speed, the law's argument.
        let increment = |at: &[f64; 4], by: usize| match by {
            0 | 1 => 1e-6,
            _ => 1e-6 * (at[by] - self.belts[by - 2]).abs(),
        };
        let mut slopes = [self.rates(y); STAGES];
        for _ in 0..20 {
            let change = corrections(&self.weights, &rates, &increment, (y, h), &slopes);
            for (slopes, change) in std::iter::zip(&mut slopes, change) {
                for (slope, change) in std::iter::zip(slopes, change) {
                    *slope += change;
                }
            }
        }
        *y = end(&self.weights, y, h, &slopes);
    }
}

/// Two masses that settle at rates of different size, with a damper between them, which couples the
/// speeds of both contacts, beside an implicit method that shares nothing with the crate's.
#[test]
fn two_masses_move_as_by_an_implicit_method() {
    let mut worst = Worst::default();
    for rises in [[30.0, 2e3], [1e5, 40.0], [1e6, 3e7], [500.0, 500.0]] {
        let laws = rises.map(|rise| {
            let law = Stribeck::new(0.4, 0.25, 0.02, 2).unwrap();
            law.with_viscous_coefficient(rise).unwrap()
        });
        let pair = Pair {
            laws,
            belts: [0.5, 0.8],
            weights: weights(),
        };
        let contact = |i: usize| {
            let contact = Contact::new(i, pair.laws[i], 1.0).unwrap();
            contact.on_belt(pair.belts[i])
        };
        let structure = Structure::new(&[1.0, 1.7])
            .and_then(|pair| pair.with_ground_spring(0, 1.0)?.with_ground_spring(1, 0.8))
            .and_then(|pair| pair.with_spring(0, 1, 0.6)?.with_damper(0, 1, 0.3))
            .and_then(|pair| pair.with_contacts([contact(0), contact(1)]))
            .unwrap();
        let start = State::new(&[2.0, 2.5], &[0.3, 0.5]);
        let motion = Integrator::new()
            .with_max_steps(300)
            .and_then(|integrator| integrator.simulate(&structure, start, 6.0))
            .unwrap();
        // On the slow manifold: the method needs no steps for the transient.
        let from = motion.state_at(1.0).unwrap();
        let mut y = [0.0; 4];
        y[..2].copy_from_slice(&from.displacements);
        y[2..].copy_from_slice(&from.velocities);
        let steps = 1000;
        for k in 1..=steps {
            pair.step(&mut y, 5.0 / f64::from(steps));
            if k % 200 == 0 {
                let state = motion
                    .state_at(1.0 + 5.0 * f64::from(k) / f64::from(steps))
                    .unwrap();
                let about = format!("{rises:?}, {k}");
                worst.meet_all(1e-11, &about, &state.displacements, &y[..2]);
                worst.meet_all(1e-10, &about, &state.velocities, &y[2..]);
            }
        }
        let longest = motion
            .steps()
            .iter()
            .map(Segment::duration)
            .fold(0.0, f64::max);
        let least = rises.into_iter().fold(f64::INFINITY, f64::min);
        assert!(longest * least > 10.0, "{rises:?}: steps of {longest}");
    }
    worst.assert("Radau", 1.0);
}

/// The work does not grow with the stiffness, and the limit is that of a rigid joint.
#[test]
fn work_does_not_grow_with_the_stiffness() {
    for (masses, tolerance) in [(1, 1e-6), (2, 1e-9), (3, 1e-15)] {
        let mut fewest = usize::MAX;
        for power in [3, 6, 9, 12, 15] {
            let law = Stribeck::new(0.4, 0.25, 0.1, 1)
                .and_then(|law| law.with_viscous_coefficient(10_f64.powi(power)))
                .unwrap();
            let mut structure = Structure::new(&vec![1.0; masses]).unwrap();
            for i in 0..masses {
                let contact = Contact::new(i, law, 1.0 + 0.1 * i as f64).unwrap();
                structure = structure
                    .with_ground_spring(i, 1.0)
                    .and_then(|structure| structure.with_contact(contact.on_belt(0.3)))
                    .unwrap();
                if i > 0 {
                    structure = structure.with_spring(i - 1, i, 0.5).unwrap();
                }
            }
            let start = State::new(&vec![3.0; masses], &vec![0.0; masses]);
            let motion = Integrator::new()
                .with_tolerance(tolerance)
                .and_then(|integrator| integrator.simulate(&structure, start, 30.0))
                .unwrap();
            let steps = motion.steps().len();
            fewest = fewest.min(steps);
            assert!(
                steps <= 2 * fewest + 40,
                "{masses} masses, 1e{power}: {steps} steps"
            );
        }
    }
}
