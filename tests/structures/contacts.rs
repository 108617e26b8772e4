//! Contacts in any direction: identities, limits, and what cannot be decided.

use approx::assert_abs_diff_eq;
use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::structure::State;
use stick_slip::{
    AnyLaw, Contact, Coulomb, Direction, Drive, Element, Error, Event, EventKind, Exponential,
    Integrator, Mode, Structure, Trajectory,
};

use crate::common::{Random, count, even, exactly, forces, keys, larger, one_mass, text};
use crate::plain::Plain;
use crate::reading::{cases, law, structure};
use crate::work::Work;

fn dry() -> Coulomb {
    Coulomb::new(0.5, 0.3).unwrap()
}

/// The motion as far as it goes.
fn motion(structure: &Structure, start: &State, duration: f64) -> Trajectory<State> {
    match structure.simulate(start.clone(), duration) {
        Ok(motion) => motion,
        Err(Error::Separation { reached, .. }) => {
            let before = reached.time * (1.0 - 1e-12);
            structure.simulate(start.clone(), before).unwrap()
        }
        Err(error) => panic!("{error}"),
    }
}

/// Events with contacts of other numbers; those of one time in the order of the contacts.
fn sorted(mut events: Vec<Event<State>>, number: impl Fn(usize) -> usize) -> Vec<Event<State>> {
    for event in &mut events {
        event.element = Element::Contact(number(event.contact().unwrap()));
    }
    let mut begun = 0;
    for k in 1..=events.len() {
        if k == events.len() || events[k].time - events[begun].time > 1e-11 {
            events[begun..k].sort_by_key(|event| event.contact().unwrap());
            begun = k;
        }
    }
    events
}

/// How far events of two motions lie apart, in time and, with a map of the states, in place: every
/// number in units of max(1, |number|).
fn apart(a: &Event<State>, b: &Event<State>, mapped: impl Fn(&[f64]) -> Vec<f64>) -> f64 {
    let of = |a: &[f64], b: &[f64]| -> f64 {
        let pairs = a.iter().zip(mapped(b));
        let parts = pairs.map(|(a, b)| (a - b).abs() / a.abs().max(1.0));
        parts.fold(0.0, larger)
    };
    let places = of(&a.state.displacements, &b.state.displacements);
    let speeds = of(&a.state.velocities, &b.state.velocities);
    (a.time - b.time).abs().max(places).max(speeds)
}

/// The same structure in the coordinates x, q = T x.
fn changed(plain: &Plain, t: &DMatrix<f64>) -> Plain {
    let seen = |matrix: &DMatrix<f64>| t.transpose() * matrix * t;
    let mut plain = plain.clone();
    [plain.mass, plain.stiffness, plain.damping] =
        [&plain.mass, &plain.stiffness, &plain.damping].map(seen);
    for contact in &mut plain.contacts {
        contact.direction = t.transpose() * &contact.direction;
        let gradient = t.transpose() * DVector::from_column_slice(&contact.gradient);
        contact.gradient = gradient.as_slice().to_vec();
    }
    plain
}

/// How much a change of the start grows on the way to each event.
fn growth(structure: &Structure, start: &State, motion: &Trajectory<State>, end: f64) -> f64 {
    const CHANGE: f64 = 1e-9;
    let mut largest = 1.0_f64;
    for i in 0..2 * structure.len() {
        let mut beside = start.clone();
        let n = structure.len();
        let number = match i.checked_sub(n) {
            None => &mut beside.displacements[i],
            Some(i) => &mut beside.velocities[i],
        };
        *number += CHANGE * number.abs().max(1.0);
        let Ok(other) = structure.simulate(beside, end) else {
            continue;
        };
        for (a, b) in motion.events().iter().zip(other.events()) {
            largest = largest.max(apart(a, b, <[f64]>::to_vec) / CHANGE);
        }
    }
    largest
}

/// A unimodular change of coordinates changes nothing but rounding: every number by at most 1e-13
/// of the condition number of T and of what the motion itself magnifies.
#[test]
fn coordinates_may_be_changed() {
    let mut random = Random::new(31);
    let (mut events, mut compared, mut worst) = (0, 0, 0.0_f64);
    let cases = count(100, 500);
    for i in 0..cases {
        let mut plain = Plain::shared(&mut random, false);
        let n = plain.len();
        // Forces are changed as sums of drives, which plain numbers do not have.
        plain.forces = vec![Default::default(); n];
        let start = plain.start_at_rest(&mut random);
        // A product of elementary ones.
        let mut t = DMatrix::identity(n, n);
        for _ in 0..n {
            let [a, b] = [0; 2].map(|_| (random.bits() % n as u64) as usize);
            if a != b {
                let row = t.row(a) * random.sign();
                t.set_row(b, &(t.row(b) + row));
            }
        }
        let back = t.clone().try_inverse().unwrap();
        let condition = t.norm() * back.norm();
        let seen = |x: &[f64]| (&back * DVector::from_column_slice(x)).as_slice().to_vec();
        let mapped = |x: &[f64]| (&t * DVector::from_column_slice(x)).as_slice().to_vec();
        let duration = 8.0;
        let one = plain.structure();
        let plain_seen = changed(&plain, &t);
        let other = plain_seen.structure();
        let start_seen = State::new(&seen(&start.displacements), &seen(&start.velocities));
        // What is at rest but for rounding slides in one of them.
        if !(plain.is_clear(&start) && plain_seen.is_clear(&start_seen)) {
            continue;
        }
        let (Ok(a), Ok(b)) = (
            one.simulate(start.clone(), duration),
            other.simulate(start_seen, duration),
        ) else {
            continue;
        };
        let about = || format!("{i}: {plain:?}\n{start:?}\n{t}");
        // What is at rest within rounding may come to rest a moment later.
        let later = |motion: &Trajectory<State>| -> Vec<Event<State>> {
            let events = motion.events().iter().cloned();
            sorted(events.filter(|event| event.time > 1e-12).collect(), |c| c)
        };
        let (first, second) = (later(&a), later(&b));
        let times = |events: &[Event<State>]| -> Vec<_> {
            let events = events.iter();
            events
                .map(|e| (e.time, e.contact().unwrap(), e.kind))
                .collect()
        };
        let both = [&first, &second].map(|events| times(events));
        assert_eq!(first.len(), second.len(), "{both:?}\n{}", about());
        let allowed = 1e-13 * condition * growth(&one, &start, &a, duration);
        for (a, b) in first.iter().zip(&second) {
            assert_eq!(
                (a.contact().unwrap(), a.kind),
                (b.contact().unwrap(), b.kind),
                "{}",
                about()
            );
            let apart = apart(a, b, mapped);
            assert!(apart <= allowed, "{apart:e} of {allowed:e}: {}", about());
            worst = larger(worst, apart / allowed);
            events += 1;
        }
        compared += 1;
    }
    println!("{compared} motions, {events} events, worst {worst:.1e} of what is allowed");
    assert!(
        3 * compared > cases && events > 2 * cases,
        "{compared} {events}"
    );
}

/// Two masses and a joint, and the same in x_0 = q_0 − q_1, x_1 = q_1: the joint is along one
/// coordinate then, and M is full.
#[test]
fn a_joint_is_a_contact_of_the_relative_coordinate() {
    let mut random = Random::new(8);
    let mut events = 0;
    for _ in 0..100 {
        let [m, k, c] = [(0.5, 2.0), (0.3, 2.0), (0.0, 0.2)]
            .map(|(low, high)| [0; 2].map(|_| random.uniform(low, high)));
        let law = Coulomb::new(0.3 + random.uniform(0.0, 0.3), 0.3).unwrap();
        let load = random.uniform(0.3, 1.5);
        let force = Drive::sine(random.uniform(0.5, 2.0), random.uniform(0.5, 2.0)).unwrap();
        let made = |masses: Structure, contact: Contact, t: DMatrix<f64>| {
            let matrix =
                |x: [f64; 2]| t.transpose() * DMatrix::from_diagonal(&x.into_vector()) * &t;
            masses
                .with_stiffness(matrix(k))
                .and_then(|s| s.with_damping(matrix(c)))
                .and_then(|s| s.with_force(0, force.clone()))
                .and_then(|s| s.with_contact(contact))
                .unwrap()
        };
        // The force acts on q_0 = x_0 + x_1: on both of x.
        let between = Contact::between(0, 1, law, load).unwrap();
        let one = made(
            Structure::new(&m).unwrap(),
            between,
            DMatrix::identity(2, 2),
        );
        let t = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 0.0, 1.0]);
        let mass = DMatrix::from_row_slice(2, 2, &[m[0], m[0], m[0], m[0] + m[1]]);
        let alone = Contact::new(0, law, load).unwrap();
        let other = made(Structure::with_mass_matrix(mass).unwrap(), alone, t)
            .with_force(1, force.clone())
            .unwrap();
        let (a, b) = (
            motion(&one, &State::new(&[0.3, -0.2], &[0.5, 0.1]), 20.0),
            motion(&other, &State::new(&[0.5, -0.2], &[0.4, 0.1]), 20.0),
        );
        assert_eq!(keys(&a), keys(&b));
        for (a, b) in a.events().iter().zip(b.events()) {
            let apart = apart(a, b, |x| vec![x[0] + x[1], x[1]]);
            assert!(apart < 1e-12, "{apart:e}");
            events += 1;
        }
    }
    assert!(events > 500, "{events}");
}

/// q_0 = x_0 and q_1 = x_0 + x_1: a contact of q_1 is along both, but its force accelerates only
/// x_1.
#[test]
fn a_contact_may_run_along_a_coordinate_that_it_does_not_accelerate() {
    let mass = DMatrix::from_row_slice(2, 2, &[4.0, 2.0, 2.0, 2.0]);
    for pull in [0.0, 3.0, -3.0] {
        let contact = Contact::along(&[(0, 1.0), (1, 1.0)], dry(), 1.0).unwrap();
        let pair = Structure::with_mass_matrix(mass.clone())
            .and_then(|s| s.with_force(0, pull + 0.3)?.with_force(1, 0.3))
            .and_then(|s| s.with_contact(contact))
            .unwrap();
        let start = State::at_rest(2);
        let carried = forces(&pair.carried(0.0, &start).unwrap());
        assert_abs_diff_eq!(carried[0], 0.3, epsilon = 1e-14);
        // q_0 goes alone.
        let motion = pair.simulate(start, 2.0).unwrap();
        assert_eq!(motion.events(), []);
        let [&x_0, &x_1] = exactly(&motion.last().displacements);
        assert_abs_diff_eq!(x_0, pull, epsilon = 1e-14);
        assert_abs_diff_eq!(x_1, -pull, epsilon = 1e-14);
    }
}

trait IntoVector {
    fn into_vector(self) -> DVector<f64>;
}

impl IntoVector for [f64; 2] {
    fn into_vector(self) -> DVector<f64> {
        DVector::from_column_slice(&self)
    }
}

#[test]
fn contacts_may_be_numbered_in_any_order() {
    let mut random = Random::new(17);
    let (mut events, mut falling) = (0, 0);
    let cases = count(50, 200);
    for i in 0..cases {
        let plain = Plain::shared(&mut random, i % 4 == 0);
        let start = plain.start_at_rest(&mut random);
        let mut order: Vec<usize> = (0..plain.contacts.len()).collect();
        for c in (1..order.len()).rev() {
            order.swap(c, (random.bits() % (c as u64 + 1)) as usize);
        }
        let mut other = plain.clone();
        other.contacts = order.iter().map(|&c| plain.contacts[c].clone()).collect();
        let duration = 8.0;
        let (Ok(a), Ok(b)) = (
            plain.structure().simulate(start.clone(), duration),
            other.structure().simulate(start.clone(), duration),
        ) else {
            continue;
        };
        let one = sorted(a.events().to_vec(), |c| c);
        let other = sorted(b.events().to_vec(), |c| order[c]);
        let allowed = 1e-13 * growth(&plain.structure(), &start, &a, duration);
        let about = || format!("{i}: {plain:?}\n{start:?}\n{order:?}");
        assert_eq!(one.len(), other.len(), "{}", about());
        for (a, b) in one.iter().zip(&other) {
            assert_eq!(
                (a.contact().unwrap(), a.kind),
                (b.contact().unwrap(), b.kind),
                "{}",
                about()
            );
            let apart = apart(a, b, <[f64]>::to_vec);
            assert!(apart <= allowed, "{apart:e} of {allowed:e}: {}", about());
            events += 1;
        }
        let falls = |c: &crate::plain::PlainContact| matches!(c.law, AnyLaw::Coulomb(_));
        falling += usize::from(plain.contacts.iter().any(falls));
    }
    println!("{events} events, {falling} motions where friction falls");
    assert!(
        events > 5 * cases / 2 && falling > cases / 4,
        "{events} {falling}"
    );
}

/// Work is the change of energy over every step, at round-off: reference motions, in which contacts
/// stick, slip, open and close.
#[test]
fn energy_balances_along_contacts() {
    let mut worst = 0.0_f64;
    for case in cases(include_str!("../data/contact_trajectories.json")) {
        let contacts = case["system"]["contacts"].as_array().unwrap();
        let remembers = |c: &serde_json::Value| !c["dwell"].is_null() || !c["bristle"].is_null();
        if contacts.iter().any(remembers) {
            continue;
        }
        let laws: Vec<AnyLaw> = contacts.iter().map(|c| law(c, f64::NAN)).collect();
        let system = structure(&case["system"], f64::NAN);
        let [q, v] = ["q", "v"].map(|x| crate::reading::numbers(&case["start"][x]));
        let end = crate::common::number(&case["t_end"]);
        let motion = motion(&system, &State::new(&q, &v), end);
        worst = larger(
            worst,
            Work::new(&system, &laws).balances(&motion, text(&case["id"])),
        );
    }
    println!("worst {worst:.1e}");
}

/// Nothing acts on the whole: a clutch leaves the momentum as it is.
#[test]
fn clutches_keep_momentum() {
    let load = Drive::profile(&[(0.0, 0.0), (0.5, 2.0), (2.0, 2.0), (2.0, 0.0)]).unwrap();
    let load = load.with_harmonic(0.4, 3.0, 0.0).unwrap();
    let clutch = |i: usize| Contact::between(i, i + 1, dry(), load.clone()).unwrap();
    let inertias = [1.0, 0.7, 2.3];
    let shafts = Structure::new(&inertias)
        .and_then(|s| s.with_spring(0, 2, 0.8))
        .and_then(|s| s.with_contact(clutch(0))?.with_contact(clutch(1)))
        .unwrap();
    let start = State::new(&[0.0, 0.3, 0.0], &[5.0, -1.0, 0.2]);
    let momentum = |state: &State| -> f64 {
        let parts = inertias.iter().zip(&state.velocities);
        parts.map(|(inertia, v)| inertia * v).sum()
    };
    let first = momentum(&start);
    let motion = shafts.simulate(start, 20.0).unwrap();
    assert!(motion.events().len() > 6);
    for (time, state) in motion.sample(200) {
        let apart = momentum(&state) - first;
        assert!(apart.abs() < 1e-13, "{apart:e} at {time}");
    }
}

/// A joint with a mass 10¹² times as heavy is a belt at rest.
#[test]
fn a_heavy_mass_is_a_belt() {
    let law = Exponential::new(0.5, 0.3, 0.25).unwrap();
    let force = || Drive::sine(0.6, 0.9).unwrap();
    let on_belt = one_mass([1.0, 0.0, 1.0], force(), Contact::new(0, law, 1.0).unwrap()).unwrap();
    let jointed = Structure::new(&[1.0, 1e12])
        .and_then(|s| s.with_ground_spring(0, 1.0)?.with_force(0, force()))
        .and_then(|s| s.with_contact(Contact::between(0, 1, law, 1.0)?))
        .unwrap();
    let one = on_belt.simulate(State::new(&[0.9], &[0.0]), 40.0).unwrap();
    let start = State::new(&[0.9, 0.0], &[0.0, 0.0]);
    let other = jointed.simulate(start, 40.0).unwrap();
    assert!(one.events().len() > 8);
    assert_eq!(keys(&one), keys(&other));
    for (a, b) in one.events().iter().zip(other.events()) {
        assert_abs_diff_eq!(a.time, b.time, epsilon = 1e-10);
    }
}

/// So much load that nothing slips: one rigid body.
#[test]
fn a_large_load_makes_a_rigid_pair() {
    for load in [1e3, 1e9, 1e15] {
        let pair = Structure::new(&[1.0, 3.0])
            .and_then(|s| s.with_ground_spring(0, 2.0)?.with_ground_spring(1, 7.0))
            .and_then(|s| s.with_contact(Contact::between(0, 1, dry(), load)?))
            .unwrap();
        let motion = pair
            .simulate(State::new(&[0.5, 0.1], &[0.4, 0.4]), 30.0)
            .unwrap();
        assert_eq!(motion.events(), []);
        // 4 v' = −2 q_0 − 7 q_1, q_0 − q_1 = 0.4, ω = 3/2.
        let omega = 1.5_f64;
        let middle = -2.0 * 0.4 / 9.0;
        for (t, state) in motion.sample(100) {
            let (sin, cos) = (omega * t).sin_cos();
            let expected = middle + (0.1 - middle) * cos + 0.4 / omega * sin;
            let [&q_0, &q_1] = exactly(&state.displacements);
            assert!((q_1 - expected).abs() < 1e-13, "{load} {t}");
            assert!((q_0 - q_1 - 0.4).abs() < 1e-14, "{load} {t}");
        }
    }
}

/// Nothing pulls on any of a thousand joints that stick, and all masses swing as one.
#[test]
fn a_thousand_joints_that_stick_are_one_body() {
    let n = 1001;
    let mut chain = Structure::new(&vec![1.0; n]).unwrap();
    for i in 0..n {
        chain = chain.with_ground_spring(i, 1.0).unwrap();
        if i > 0 {
            let joint = Contact::between(i, i - 1, dry(), 1.0).unwrap();
            chain = chain
                .with_spring(i - 1, i, 0.5)
                .and_then(|s| s.with_contact(joint))
                .unwrap();
        }
    }
    let start = State::new(&vec![0.3; n], &vec![0.0; n]);
    let motion = chain.simulate(start, 7.0).unwrap();
    assert_eq!(motion.events(), []);
    for (t, state) in motion.sample(5) {
        for q in state.displacements {
            assert_abs_diff_eq!(q, 0.3 * t.cos(), epsilon = 1e-13);
        }
    }
    // Its ends are pulled apart: joint i carries the force on all before it.
    let pulled = chain
        .with_force(0, -0.4)
        .and_then(|s| s.with_force(n - 1, 0.4))
        .unwrap();
    for force in forces(&pulled.carried(0.0, &State::at_rest(n)).unwrap()) {
        assert_abs_diff_eq!(force, 0.4, epsilon = 1e-9);
    }
}

/// Two clutches in series between three inertias: one pair locks, then all turn with their common
/// momentum.
#[test]
fn clutches_in_series_lock_one_after_the_other() {
    let clutch = |i: usize, load: f64| Contact::between(i, i + 1, dry(), load).unwrap();
    let shafts = Structure::new(&[1.0, 1.0, 1.0])
        .and_then(|s| s.with_contact(clutch(0, 2.0))?.with_contact(clutch(1, 0.4)))
        .unwrap();
    let start = State::new(&[0.0; 3], &[6.0, 0.0, 0.0]);
    let motion = shafts.simulate(start, 20.0).unwrap();
    use EventKind::Stick;
    assert_eq!(keys(&motion), [(0, Stick), (1, Stick)]);
    let [first, second] = exactly(motion.events());
    // 0 loses 0.6, 1 gains 0.6 − 0.12, 2 gains 0.12; then 0 and 1 lose 0.06 each.
    let lock = 6.0 / 1.08;
    assert_abs_diff_eq!(first.time, lock, epsilon = 1e-14);
    let rest = (6.0 - 0.72 * lock) / 0.18;
    assert_abs_diff_eq!(second.time - lock, rest, epsilon = 1e-13);
    for v in motion.last().velocities {
        assert_abs_diff_eq!(v, 2.0, epsilon = 1e-14);
    }
}

/// A mass between a belt and the ground: two contacts of one coordinate, of which one at most is at
/// rest.
#[test]
fn a_clamped_mass_goes_on() {
    let clamped = Structure::new(&[1.0])
        .and_then(|s| s.with_ground_spring(0, 1.0))
        .and_then(|s| s.with_force(0, Drive::sine(0.9, 0.4)?))
        .and_then(|s| s.with_contact(Contact::new(0, dry(), 1.0)?.on_belt(0.3)))
        .and_then(|s| s.with_contact(Contact::new(0, dry(), 0.4)?))
        .unwrap();
    let motion = clamped.simulate(State::new(&[0.0], &[0.3]), 60.0).unwrap();
    let count = |c: usize| {
        motion
            .events()
            .iter()
            .filter(|e| e.contact().unwrap() == c)
            .count()
    };
    assert!(count(0) > 4 && count(1) > 2, "{:?}", keys(&motion));
    for step in motion.steps() {
        assert_ne!(step.modes(), [Mode::Stick, Mode::Stick]);
    }
}

/// Two clutches side by side share what they carry when both stick, and nothing says how; but both
/// hold until they cannot hold together.
#[test]
fn parallel_clutches_lock_and_slip_together() {
    let clutch = |load: f64| Contact::between(0, 1, even(0.5), load).unwrap();
    let other = Contact::new(2, even(0.5), 1.0).unwrap();
    let shafts = |force: Drive| {
        Structure::new(&[1.0, 1.0, 1.0])
            .and_then(|s| s.with_force(0, force))
            .and_then(|s| s.with_contact(other.clone())?.with_contact(clutch(1.0)))
            .and_then(|s| s.with_contact(clutch(2.0)))
            .unwrap()
    };
    let start = State::new(&[0.0; 3], &[3.0, 0.0, 0.0]);
    use EventKind::{Release, Stick};
    // r = 3 − 3 t. From t = 2 on the force t − 2 on shaft 0: half of it passes, up to 1.5.
    let force = Drive::profile(&[(2.0, 0.0), (12.0, 10.0)]).unwrap();
    let motion = shafts(force.clone()).simulate(start.clone(), 7.0).unwrap();
    let side = Direction::Leading;
    let expected = [
        (1, Stick),
        (2, Stick),
        (1, Release(side)),
        (2, Release(side)),
    ];
    assert_eq!(keys(&motion), expected);
    for (event, time) in std::iter::zip(motion.events(), [1.0, 1.0, 5.0, 5.0]) {
        assert_abs_diff_eq!(event.time, time, epsilon = 2e-15);
    }
    let [v_0, v_1, _] = motion.last().velocities[..] else {
        panic!()
    };
    // r' = t − 5.
    assert_abs_diff_eq!(v_0 - v_1, 2.0, epsilon = 1e-14);
    let state = motion.state_at(4.0).unwrap();
    let carried = shafts(force).carried(4.0, &state).unwrap();
    assert!(carried[0].is_determined() && !carried[1].is_determined());
    for (carried, [force, least, most]) in
        std::iter::zip(&carried[1..], [[0.2, 0.0, 0.5], [0.8, 0.5, 1.0]])
    {
        assert_abs_diff_eq!(carried.force, force, epsilon = 1e-15);
        assert_abs_diff_eq!(carried.least, least, epsilon = 1e-15);
        assert_abs_diff_eq!(carried.most, most, epsilon = 1e-15);
    }
    // Where they only slide it goes on.
    let slides = shafts(4.0.into()).simulate(start.clone(), 5.0).unwrap();
    assert!(slides.events().is_empty());
    // r' = 4 − 3.
    let [&v_0, &v_1, _] = exactly(&slides.last().velocities);
    assert!((v_0 - v_1 - 8.0).abs() < 1e-13, "{v_0} {v_1}");
}

/// A load that jumps away: what the others hold is asked with what is left.
#[test]
fn others_decide_without_a_contact_that_opens() {
    // From t = 1 on nothing presses the first contact, and its friction no longer counts: the
    // second holds 0.4, though not 0.4 + 0.2.
    let load = Drive::profile(&[(1.0, 0.4), (1.0, -3.0), (2.0, -3.0)]).unwrap();
    let mass = Structure::new(&[1.0])
        .and_then(|s| s.with_force(0, 0.4))
        .and_then(|s| s.with_contact(Contact::new(0, even(0.5), load)?.on_belt(-1.0)))
        .and_then(|s| s.with_contact(Contact::new(0, even(0.5), 1.0)?))
        .unwrap();
    let motion = mass.simulate(State::at_rest(1), 3.0).unwrap();
    assert_eq!(keys(&motion), [(0, EventKind::Open)]);
    assert_eq!(motion.last(), State::at_rest(1));
}

/// Two contacts that hold one mass are undetermined, but not where nothing presses one of them: at
/// the start, or where its load jumps away as the other comes to rest.
#[test]
fn a_contact_without_load_holds_nothing() {
    let mass = |contact: Contact| {
        Structure::new(&[1.0])
            .and_then(|s| s.with_force(0, 0.4))
            .and_then(|s| s.with_contact(contact))
            .and_then(|s| s.with_contact(Contact::new(0, even(0.5), 1.0)?))
            .unwrap()
    };
    let pressed = |points: &[(f64, f64)]| {
        let load = Drive::profile(points).unwrap();
        Contact::new(0, even(0.5), load).unwrap()
    };
    let start = State::at_rest(1);
    let above = mass(pressed(&[(0.0, 1e-9), (1.0, 1.0)]));
    // The load that begins may carry as much as its limit.
    let [light, other] = above.carried(0.0, &start).unwrap()[..] else {
        panic!()
    };
    assert_abs_diff_eq!(light.most, 5e-10, epsilon = 1e-24);
    assert_abs_diff_eq!(light.least, -5e-10, epsilon = 1e-24);
    assert_abs_diff_eq!(light.force + other.force, 0.4, epsilon = 1e-16);
    assert_abs_diff_eq!(other.least, 0.4 - 5e-10, epsilon = 1e-16);
    for points in [[(0.0, -3.0), (1.0, -1.0)], [(0.0, 0.0), (1.0, -1.0)]] {
        let mass = mass(pressed(&points));
        assert_eq!(forces(&mass.carried(0.0, &start).unwrap()), [0.0, 0.4]);
        let motion = mass.simulate(start.clone(), 3.0).unwrap();
        assert!(motion.events().is_empty());
        assert_eq!(motion.last(), start);
    }
    // By its displacement: 0 there, and falling at once, or below.
    let light = Contact::new(0, even(0.5), 1.0).unwrap();
    let lifted = mass(light.with_load_gradient(0, 1.0).unwrap().on_belt(-1.0));
    for start in [State::new(&[-1.0], &[-1.0]), State::new(&[-2.0], &[-1.0])] {
        match lifted.simulate(start, 1.0) {
            Err(Error::Separation {
                contact: 0,
                reached,
            }) => assert_eq!(reached.time, 0.0),
            other => panic!("{other:?}"),
        }
    }
    // Held by a belt that stops at t = 1, where the load ends.
    let belt = Drive::profile(&[(0.0, 1.0), (1.0, 0.0), (2.0, 0.0)]).unwrap();
    let ends = pressed(&[(0.0, 8.0), (1.0, 8.0), (1.0, -1.0), (2.0, -1.0)]);
    let motion = mass(ends.on_belt(belt)).simulate(State::new(&[0.0], &[1.0]), 3.0);
    let motion = motion.unwrap();
    assert_eq!(keys(&motion), [(0, EventKind::Open), (1, EventKind::Stick)]);
    assert_eq!(motion.last(), State::new(&[0.5], &[0.0]));
}

/// A mass that is held has no velocity, not even that of rounding errors, and nothing but a belt
/// that moves below it limits the steps.
#[test]
fn a_held_mass_is_at_rest_to_the_bit() {
    let belt = Drive::sine(0.06, 2.0)
        .unwrap()
        .with_constant(-0.46)
        .unwrap();
    let mass = Structure::new(&[3.5])
        .and_then(|s| s.with_contact(Contact::new(0, dry(), 1.5)?))
        .and_then(|s| s.with_contact(Contact::new(0, dry(), 0.75)?.on_belt(belt)))
        .unwrap();
    let motion = mass.simulate(State::new(&[-0.5], &[0.83]), 100.0).unwrap();
    assert_eq!(keys(&motion), [(0, EventKind::Stick)]);
    assert_eq!(motion.last().velocities, [0.0]);
    assert!(motion.steps().len() < 200, "{}", motion.steps().len());
}

/// A joint along two coordinates may be driven as well as a belt.
#[test]
fn a_joint_slips_the_way_its_motor_turns() {
    let joint = Contact::between(0, 1, even(0.5), 1.0).unwrap().on_belt(1.0);
    let pair = Structure::new(&[1.0, 1.0])
        .unwrap()
        .with_contact(joint)
        .unwrap();
    assert_eq!(
        forces(&pair.carried(0.0, &State::at_rest(2)).unwrap()),
        [-0.5]
    );
    let motion = pair.simulate(State::at_rest(2), 5.0).unwrap();
    // r = −1 + t.
    assert_eq!(keys(&motion), [(0, EventKind::Stick)]);
    assert_abs_diff_eq!(motion.events()[0].time, 1.0, epsilon = 1e-15);
    assert_eq!(motion.last().velocities, [0.5, -0.5]);
    let first = motion.steps().first().unwrap();
    assert_eq!(first.modes(), [Mode::Slip(Direction::Lagging)]);
}

/// With a joint that sticks both ends move alike: contacts of the ends with the ground, each with
/// a relative velocity of its own, come to r = 0 at one time, to the bit, and decide together.
#[test]
fn contacts_come_to_rest_with_those_that_they_depend_on() {
    let mut random = Random::new(46);
    let mut together = 0;
    let cases = count(30, 100);
    for i in 0..cases {
        let mut uniform = |low, high| random.uniform(low, high);
        let (masses, springs) = ([0; 2].map(|_| uniform(0.5, 2.0)), uniform(0.5, 2.0));
        let force = Drive::harmonic(uniform(0.5, 2.0), uniform(0.4, 1.5), 0.0).unwrap();
        let pair = Structure::new(&masses)
            .and_then(|s| s.with_ground_spring(0, springs)?.with_ground_spring(1, 0.7))
            .and_then(|s| {
                s.with_ground_damper(1, uniform(0.0, 0.1))?
                    .with_force(0, force)
            })
            .and_then(|s| s.with_contact(Contact::new(0, dry(), uniform(0.1, 0.4))?))
            .and_then(|s| s.with_contact(Contact::between(0, 1, dry(), 40.0)?))
            .and_then(|s| {
                let direction = [(0, uniform(0.2, 1.0)), (1, uniform(0.2, 1.0))];
                s.with_contact(Contact::along(&direction, dry(), uniform(0.1, 0.4))?)
            })
            .unwrap();
        let start = State::new(&[uniform(-2.0, 2.0), 0.0], &[0.8, 0.8]);
        let motion = motion(&pair, &start, 30.0);
        for pair in motion.events().chunks(2) {
            let [first, second] = exactly(pair);
            assert_eq!(first.time, second.time, "{i}");
            assert_eq!(
                [first.contact().unwrap(), second.contact().unwrap()],
                [0, 2],
                "{i}"
            );
            together += 1;
        }
    }
    println!("{together} times together");
    assert!(together > 3 * cases);
}

/// The same where a third contact, which holds both ends and another mass, has no part in it.
#[test]
fn contacts_come_to_rest_together_beside_one_that_holds() {
    let mut random = Random::new(48);
    let mut together = 0;
    let cases = count(30, 100);
    for i in 0..cases {
        let mut uniform = |low, high| random.uniform(low, high);
        let slanting = [0, 1, 2].map(|j| (j, uniform(0.5, 1.5)));
        let masses = [0; 3].map(|_| uniform(0.5, 2.0));
        let springs = [0; 3].map(|_| uniform(0.5, 2.0));
        let held = Structure::new(&masses)
            .and_then(|s| {
                s.with_ground_spring(0, springs[0])?
                    .with_ground_spring(1, springs[1])
            })
            .and_then(|s| s.with_ground_spring(2, springs[2]))
            .and_then(|s| s.with_contact(Contact::new(0, dry(), uniform(0.1, 0.4))?))
            .and_then(|s| s.with_contact(Contact::new(1, dry(), uniform(0.1, 0.4))?))
            .and_then(|s| s.with_contact(Contact::between(0, 1, dry(), 40.0)?))
            .and_then(|s| s.with_contact(Contact::along(&slanting, dry(), 40.0)?))
            .unwrap();
        let [a, b, c] = slanting.map(|(_, part)| part);
        let start = State::new(
            &[uniform(-2.0, 2.0), 0.0, 0.0],
            &[0.8, 0.8, -0.8 * (a + b) / c],
        );
        for tolerance in [1e-6, 1e-9, f64::EPSILON] {
            let integrator = Integrator::new().with_tolerance(tolerance).unwrap();
            let motion = match integrator.simulate(&held, start.clone(), 20.0) {
                Ok(motion) => motion,
                Err(error) => panic!("{error}"),
            };
            let events = motion.events();
            for pair in events.chunks(2) {
                let [first, second] = exactly(pair);
                assert_eq!(first.time, second.time, "{i}, {tolerance:e}");
                assert_eq!(
                    [first.contact().unwrap(), second.contact().unwrap()],
                    [0, 1],
                    "{i}, {tolerance:e}"
                );
                together += 1;
            }
        }
    }
    assert!(together > 3 * cases, "{together}");
}

/// Contacts that hold all coordinates, in directions none of which has a coordinate to itself.
#[test]
fn masses_held_in_slanting_directions_are_at_rest_to_the_bit() {
    let mut random = Random::new(47);
    let mut held = [0; 2];
    let cases = count(20, 50);
    for i in 0..cases {
        let (base, apart, more) = [(0.0, 1.0, 3), (1.0, 1e-3, 1)][i % 2];
        let n = 2 + (random.bits() % more) as usize;
        let masses: Vec<f64> = (0..n).map(|_| random.uniform(0.5, 2.0)).collect();
        let mut structure = Structure::new(&masses).unwrap();
        for _ in 0..n {
            let entry = |j| (j, base + apart * random.uniform(-1.0, 1.0));
            let direction: Vec<(usize, f64)> = (0..n).map(entry).collect();
            let contact = Contact::along(&direction, dry(), random.uniform(0.5, 2.0));
            structure = structure.with_contact(contact.unwrap()).unwrap();
        }
        // Belts that slide below one of them for ever.
        for belt in [0.13, -0.65] {
            let contact = Contact::new(0, dry(), 0.2).unwrap().on_belt(belt);
            structure = structure.with_contact(contact).unwrap();
        }
        let velocities: Vec<f64> = (0..n).map(|_| random.uniform(-1.0, 1.0)).collect();
        let start = State::new(&vec![0.0; n], &velocities);
        let motion = structure.simulate(start, 1e4).unwrap();
        let last = motion.steps().last().unwrap();
        if last.modes()[..n].iter().all(|mode| *mode == Mode::Stick) {
            held[i % 2] += 1;
            assert!(
                motion.last().velocities.iter().all(|v| *v == 0.0),
                "{motion:?}"
            );
        }
        assert!(motion.steps().len() < 1000, "{}", motion.steps().len());
    }
    assert!(held.iter().all(|held| *held > cases / 20), "{held:?}");
}
