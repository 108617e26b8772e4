//! Loads of any shape: N = N0(t) + n·q + φ(a·q, a·v).

use stick_slip::nalgebra::DMatrix;
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Drive, Element, Error, Event, EventKind, ForceElement, ForceLaw, FrictionLaw,
    Mode, Pendulum, PolynomialSpring, Rational, Scalar, SnapThrough, Stribeck, Structure,
    VanDerPol,
};

use crate::common::collocation::integrate;
use crate::common::heat::Heat;
use crate::common::orbit::monodromy;
use crate::common::property::for_all;
use crate::common::{Random, count, larger};

/// φ of a bead on a ring of radius l in the vertical plane, s its way along the ring:
/// m(s'²/l + g cos(s/l)).
#[derive(Debug, Clone, Copy)]
struct Ring {
    mass: f64,
    gravity: f64,
    radius: f64,
}

impl ForceLaw for Ring {
    fn force<S: Scalar>(&self, position: S, velocity: S, _: usize) -> S {
        let angle = position / self.radius;
        (velocity.square() / self.radius + angle.cos() * self.gravity) * self.mass
    }
}

/// A bead that swings in a ring: between two turning points θ'² obeys a linear equation in θ, with
/// u(θ) = Ce^{−2μσθ} + A cos θ + B sin θ.
#[test]
fn a_bead_on_a_ring_turns_where_the_closed_form_says() {
    for_all(
        60,
        [0.05..0.4, 0.3..3.0, 0.5..2.0, 1.0..10.0, 0.3..1.4],
        |[mu, mass, radius, gravity, angle]| {
            let ring = Ring {
                mass,
                gravity,
                radius,
            };
            let contact = Contact::new(0, Coulomb::new(mu, mu).unwrap(), 0.0).unwrap();
            let contact = contact.with_load_law(&[(0, 1.0)], ring).unwrap();
            let weight = Pendulum::new(mass * gravity, radius).unwrap();
            let bead = Structure::new(&[mass])
                .and_then(|s| {
                    s.with_element(ForceElement::new(0, weight)?)?
                        .with_contact(contact)
                })
                .unwrap();
            let start = State::new(&[radius * angle], &[0.0]);
            let motion = bead.simulate(start, 60.0).unwrap();
            let k = gravity / radius;
            let a = 2.0 * k * (1.0 - 2.0 * mu * mu) / (1.0 + 4.0 * mu * mu);
            let (mut from, mut side) = (angle, -1.0);
            let turns = motion.events().iter();
            let turns = turns.filter(|e| !matches!(e.kind, EventKind::Release(_)));
            for turn in turns {
                let b = -6.0 * mu * side * k / (1.0 + 4.0 * mu * mu);
                let particular = |theta: f64| a * theta.cos() + b * theta.sin();
                let to = turn.state.displacements[0] / radius;
                let decay = (-2.0 * mu * side * (to - from)).exp();
                let u = particular(to) - particular(from) * decay;
                assert!(u.abs() < 1e-13 * k, "{from} {to}: {u:e}");
                (from, side) = (to, -side);
            }
            // It rests where friction holds it: tan θ ≤ μ.
            let last = motion.last().displacements[0] / radius;
            assert!(last.tan().abs() <= mu * (1.0 + 1e-12), "{last}");
            Ok(())
        },
    );
}

/// The normal part of an oblique spring that holds a block from a height h.
#[derive(Debug, Clone, Copy)]
struct Oblique {
    stiffness: f64,
    free_length: f64,
    height: f64,
}

impl ForceLaw for Oblique {
    fn force<S: Scalar>(&self, position: S, _: S, _: usize) -> S {
        let length = (position.square() + self.height * self.height).sqrt();
        (-length.recip() * self.free_length + 1.0) * (-self.stiffness * self.height)
    }
}

/// A block on an oblique spring that pushes it down: load and restoring force of one spring. Energy
/// between turning points in closed form.
#[test]
fn a_block_under_an_oblique_spring_turns_where_energy_says() {
    for_all(
        60,
        [0.05..0.3, 0.5..3.0, 1.1..1.6, 0.5..1.5, 2.0..5.0, 0.5..2.0],
        |[mu, stiffness, free, height, weight, away]| {
            let free = free * height;
            let oblique = Oblique {
                stiffness,
                free_length: free,
                height,
            };
            let snap = SnapThrough::new(stiffness, free, height).unwrap();
            let contact = Contact::new(0, Coulomb::new(mu, mu).unwrap(), weight).unwrap();
            let contact = contact.with_load_law(&[(0, 1.0)], oblique).unwrap();
            let block = Structure::new(&[1.0])
                .and_then(|s| {
                    s.with_element(ForceElement::new(0, snap)?)?
                        .with_contact(contact)
                })
                .unwrap();
            let start = free + away;
            let motion = block.simulate(State::new(&[start], &[0.0]), 80.0).unwrap();
            let energy = |x: f64| {
                let stretch = x.hypot(height) - free;
                0.5 * stiffness * stretch * stretch
            };
            // ∫N dx.
            let pressed =
                |x: f64| weight * x - stiffness * height * (x - free * (x / height).asinh());
            let mut from = start;
            let mut turns = 0;
            for event in motion.events() {
                if let EventKind::Release(_) | EventKind::Open | EventKind::Close = event.kind {
                    continue;
                }
                let to = event.state.displacements[0];
                let loss = mu * (pressed(to) - pressed(from)).abs();
                let left = energy(from) - energy(to) - loss;
                // Without a load nothing is lost: also at a start with an open contact.
                let is_open = |e: &Event<_>| matches!(e.kind, EventKind::Open | EventKind::Close);
                let opens = motion.events().iter().any(is_open);
                assert!(
                    opens || left.abs() < 1e-13 * energy(from).max(1.0),
                    "{left:e}"
                );
                (from, turns) = (to, turns + 1);
            }
            // A weak spring does not overcome friction.
            let stretched = start.hypot(height) - free;
            let along = stiffness * stretched * start / start.hypot(height);
            let load = weight - stiffness * height * stretched / start.hypot(height);
            assert_eq!(turns > 0, along > mu * load.max(0.0));
            Ok(())
        },
    );
}

/// A random chain with contacts, whose loads come from `load`.
fn chain(
    random: &mut Random,
    load: &mut dyn FnMut(&mut Random, Contact) -> [Contact; 2],
) -> [Structure; 2] {
    let n = 1 + (random.bits() % 3) as usize;
    let coupling = random.pick(&[0.0, 0.1]);
    let masses: Vec<f64> = (0..n).map(|_| random.uniform(0.5, 2.0)).collect();
    let mass = DMatrix::from_fn(n, n, |i, j| if i == j { masses[i] } else { coupling });
    let mut chain = Structure::with_mass_matrix(mass).unwrap();
    for i in 0..n {
        let force = Drive::harmonic(random.uniform(0.2, 0.8), random.uniform(0.5, 2.0), 0.3);
        chain = chain
            .with_ground_spring(i, random.uniform(0.5, 2.0))
            .and_then(|s| s.with_ground_damper(i, 0.05)?.with_force(i, force?))
            .unwrap();
        if i > 0 {
            chain = chain
                .with_spring(i - 1, i, random.uniform(0.2, 1.0))
                .unwrap();
        }
    }
    let mut pair = [chain.clone(), chain];
    for i in 0..n {
        let limit = random.uniform(0.3, 0.6);
        let n0 = random.uniform(1.0, 2.0);
        let speed = random.uniform(-0.5, 0.5);
        let belt = random.pick(&[0.0, speed]);
        let place = match (i, random.bits() % 3) {
            (0, _) | (_, 0 | 1) => vec![(i, 1.0)],
            _ => vec![(i - 1, 1.0), (i, -1.0)],
        };
        let contact = match random.bits() % 3 {
            0 => Contact::along(&place, Coulomb::new(limit, 0.7 * limit).unwrap(), n0),
            1 => Contact::along(&place, Rational::new(limit, 1.0).unwrap(), n0),
            _ => Contact::along(
                &place,
                Stribeck::new(limit, 0.6 * limit, 0.4, 1).unwrap(),
                n0,
            ),
        };
        let contacts = load(random, contact.unwrap().on_belt(belt));
        for (structure, contact) in pair.iter_mut().zip(contacts) {
            *structure = structure.clone().with_contact(contact).unwrap();
        }
    }
    pair
}

/// Compares the motions of pairs of structures that are the same system.
fn same_motions(
    seed: u64,
    load: &mut dyn FnMut(&mut Random, Contact) -> [Contact; 2],
    is_exact: bool,
) {
    let mut random = Random::new(seed);
    let (mut events, mut worst) = (0, 0.0_f64);
    for _ in 0..count(40, 1000) {
        let pair = chain(&mut random, load);
        let n = pair[0].len();
        let q: Vec<f64> = (0..n).map(|_| random.uniform(-0.5, 0.5)).collect();
        let v: Vec<f64> = (0..n).map(|_| random.uniform(-0.5, 0.5)).collect();
        let start = State::new(&q, &v);
        let run = |s: &Structure| s.simulate(start.clone(), 12.0);
        let [one, other] = match [run(&pair[0]), run(&pair[1])] {
            [Err(Error::Separation { .. }), _] => continue,
            [one, other] => [one.unwrap(), other.unwrap()],
        };
        let kinds = |e: &[Event<State>]| -> Vec<(Element, EventKind)> {
            e.iter().map(|e| (e.element, e.kind)).collect()
        };
        assert_eq!(
            kinds(one.events()),
            kinds(other.events()),
            "{pair:?} {start:?}"
        );
        events += one.events().len();
        for (a, b) in one.events().iter().zip(other.events()) {
            worst = larger(worst, (a.time - b.time).abs());
        }
        let [a, b] = [one.last(), other.last()];
        for (a, b) in a.displacements.iter().zip(&b.displacements) {
            worst = larger(worst, (a - b).abs());
        }
        if is_exact {
            assert_eq!(one.last(), other.last());
        }
    }
    println!("{events} events, {worst:.1e}");
    assert!(events > 100 && worst < 1e-11, "{events} {worst:e}");
}

/// φ = cx is the load gradient c, to rounding.
#[test]
fn a_linear_law_is_a_load_gradient() {
    same_motions(
        1,
        &mut |random, contact| {
            let (j, gradient) = (contact.coordinate(), random.uniform(-0.4, 0.4));
            let law = PolynomialSpring::new(&[gradient]).unwrap();
            [
                contact.clone().with_load_gradient(j, gradient).unwrap(),
                contact.with_load_law(&[(j, 1.0)], law).unwrap(),
            ]
        },
        false,
    );
}

/// A constant φ is a part of N0; two laws of half the size are one.
#[test]
fn laws_add_up() {
    #[derive(Debug, Clone, Copy)]
    struct Constant(f64);
    impl ForceLaw for Constant {
        fn force<S: Scalar>(&self, position: S, _: S, _: usize) -> S {
            position.constant(self.0)
        }
    }
    same_motions(
        2,
        &mut |random, contact| {
            let more = random.uniform(0.1, 1.0);
            let j = contact.coordinate();
            let cubic = |part: f64| PolynomialSpring::new(&[0.0, 0.0, part]).unwrap();
            let along = [(j, 1.0)];
            let whole = contact.clone().with_load_law(&along, cubic(0.3)).unwrap();
            let halves = contact
                .with_load_law(&along, cubic(0.15))
                .and_then(|c| c.with_load_law(&[(j, 2.0)], cubic(0.15 / 8.0)))
                .and_then(|c| c.with_load_law(&along, Constant(more)))
                .and_then(|c| c.with_load_law(&along, Constant(-more)))
                .unwrap();
            [whole, halves]
        },
        false,
    );
}

/// Two masses on fast belts, each pressed by laws of both positions and velocities, with friction
/// that heats: against an integrator of its own.
#[test]
fn motions_are_those_of_an_independent_integrator() {
    let law = Heat {
        cold: 0.5,
        hot: 0.2,
        heating: 0.4,
        cooling: 0.3,
        conduction: 0.2,
        kept: 1.0,
    };
    let cubic = PolynomialSpring::new(&[0.2, 0.3, 0.5]).unwrap();
    let damper = VanDerPol::new(-0.1, 0.2).unwrap();
    let ring = Ring {
        mass: 0.3,
        gravity: 1.0,
        radius: 2.0,
    };
    let contacts = [
        Contact::new(
            0,
            law,
            Drive::constant(2.0).with_harmonic(0.5, 1.3, 0.2).unwrap(),
        )
        .and_then(|c| c.with_load_law(&[(1, 1.0), (0, -1.0)], cubic))
        .and_then(|c| c.with_load_law(&[(0, 1.0)], ring)),
        Contact::new(1, law, 3.0)
            .and_then(|c| c.with_load_law(&[(0, 0.5), (1, 1.0)], damper))
            .and_then(|c| c.with_load_gradient(0, 0.2)),
    ];
    let system = Structure::new(&[1.0, 0.7])
        .and_then(|s| s.with_ground_spring(0, 1.5)?.with_ground_spring(1, 0.8))
        .and_then(|s| s.with_spring(0, 1, 0.6)?.with_ground_damper(0, 0.1))
        .and_then(|s| s.with_contacts(contacts.map(|c| c.unwrap().on_belt(6.0))))
        .unwrap();
    let start = [0.4, -0.3, 0.2, 0.5, 0.1, 0.6];
    let rates = |t: f64, y: &[f64]| {
        let [q0, q1, v0, v1, z0, z1] = *y else {
            panic!("six numbers")
        };
        let x = q1 - q0;
        let n0 = 2.0 + 0.5 * (1.3 * t + 0.2).cos() + 0.2 * x + 0.3 * x * x + 0.5 * x * x * x;
        let n0 = n0 + 0.3 * (v0 * v0 / 2.0 + (q0 / 2.0).cos());
        let (x, y) = (0.5 * q0 + q1, 0.5 * v0 + v1);
        let n1 = 3.0 + (0.2 * x * x + 0.1) * y + 0.2 * q0;
        let at = |load: f64, v: f64, z: f64| {
            let mu = 0.2 + 0.3 * (-z).exp();
            let heat = 0.4 * mu * load * (6.0 - v) - 0.3 * (1.0 + 0.2 * load) * z;
            (mu * load, heat)
        };
        let ((f0, h0), (f1, h1)) = (at(n0, v0, z0), at(n1, v1, z1));
        vec![
            v0,
            v1,
            f0 - 1.5 * q0 - 0.6 * (q0 - q1) - 0.1 * v0,
            (f1 - 0.8 * q1 - 0.6 * (q1 - q0)) / 0.7,
            h0,
            h1,
        ]
    };
    let state = State::new(&start[..2], &start[2..4]).with_memory(&start[4..]);
    let accelerations = system.acceleration(0.0, &state).unwrap();
    let expected = rates(0.0, &start);
    for (a, expected) in accelerations.iter().zip(&expected[2..4]) {
        assert!((a - expected).abs() < 1e-14, "{a} {expected}");
    }
    let [expected, again] = [600, 900].map(|n| integrate(&rates, &start, [0.0, 12.0], n));
    let motion = system.simulate(state, 12.0).unwrap();
    assert_eq!(motion.events(), []);
    let last = motion.last();
    let found = [last.displacements, last.velocities, last.memory].concat();
    for ((found, expected), again) in found.iter().zip(&expected).zip(&again) {
        assert!((expected - again).abs() < 1e-13);
        assert!((found - expected).abs() < 1e-13, "{found} {expected}");
    }
    // The loads of samples are those of `load_in`.
    for sample in system.samples(&motion, 0.7).unwrap() {
        for (contact, load) in system.contacts().iter().zip(&sample.loads) {
            assert!((contact.load_in(sample.time, &sample.state) - load).abs() < 1e-13);
        }
        assert_eq!(sample.element_forces.len(), 0);
    }
    let budget = system.energy_budget(&motion).unwrap();
    assert!(budget.defect().abs() < 1e-12, "{budget:?}");
}

/// A gap: a normal spring whose load is negative at first is the same spring in coordinates in
/// which it is positive, and a piecewise law in load and force is that spring, too.
#[test]
fn a_gap_is_a_negative_load() {
    #[derive(Debug, Clone, Copy)]
    struct OneSided {
        stiffness: f64,
        gap: f64,
    }
    impl ForceLaw for OneSided {
        fn force<S: Scalar>(&self, position: S, _: S, piece: usize) -> S {
            if piece == 0 {
                position.constant(0.0)
            } else {
                (position - self.gap) * self.stiffness
            }
        }
        fn breakpoints(&self) -> impl Iterator<Item = f64> {
            std::iter::once(self.gap)
        }
    }
    let mut closings = 0;
    for_all(
        60,
        [0.1..1.0, 1.0..9.0, 0.2..0.6, 0.5..2.0, 0.5..2.0],
        |[gap, stiffness, mu, force, frequency]| {
            let law = Coulomb::new(mu, 0.7 * mu).unwrap();
            let base = || {
                Structure::new(&[1.0, 1.5])
                    .and_then(|s| s.with_ground_spring(0, 1.0)?.with_ground_spring(1, 0.7))
                    .and_then(|s| s.with_ground_damper(1, 0.1))
                    .and_then(|s| s.with_force(1, Drive::sine(force, frequency)?))
                    .unwrap()
            };
            // Its rubbing acts on mass 0, on a belt.
            let contact = |load: f64| Contact::new(0, law, load).unwrap().on_belt(0.4);
            let spring = contact(-stiffness * gap)
                .with_normal_spring(&[(1, 1.0)], stiffness)
                .unwrap();
            let open = base().with_contact(spring).unwrap();
            let one_sided = OneSided { stiffness, gap };
            let pressed = contact(0.0).with_load_law(&[(1, 1.0)], one_sided).unwrap();
            let pressed = base()
                .with_contact(pressed)
                .and_then(|s| s.with_element(ForceElement::new(1, one_sided)?))
                .unwrap();
            // In coordinates from a point beyond the gap.
            let shift = 2.0 * gap;
            let moved = contact(stiffness * gap)
                .with_normal_spring(&[(1, 1.0)], stiffness)
                .unwrap();
            let moved = base()
                .with_force(1, -0.7 * shift)
                .and_then(|s| s.with_contact(moved))
                .unwrap();
            let start = State::new(&[0.1, 0.0], &[0.2, 0.3]);
            let mut from = start.clone();
            from.displacements[1] -= shift;
            let motion = open.simulate(start.clone(), 15.0).unwrap();
            let other = moved.simulate(from, 15.0).unwrap();
            let law = pressed.simulate(start, 15.0).unwrap();
            let kinds = |e: &[Event<State>]| e.iter().map(|e| e.kind).collect::<Vec<_>>();
            assert_eq!(kinds(motion.events()), kinds(other.events()));
            assert_eq!(kinds(motion.events()), kinds(law.events()));
            for ((a, b), c) in motion.events().iter().zip(other.events()).zip(law.events()) {
                assert!((a.time - b.time).abs() < 1e-11, "{} {}", a.time, b.time);
                assert!((a.time - c.time).abs() < 1e-11, "{} {}", a.time, c.time);
            }
            let (a, b, c) = (motion.last(), other.last(), law.last());
            assert!((a.displacements[1] - b.displacements[1] - shift).abs() < 1e-11);
            assert!((a.displacements[1] - c.displacements[1]).abs() < 1e-11);
            let budget = open.energy_budget(&motion).unwrap();
            assert!(budget.defect().abs() < 1e-11, "{budget:?}");
            Ok(())
        },
    );
    let law = Coulomb::new(0.3, 0.3).unwrap();
    let stop = Contact::new(0, law, -1.0).unwrap();
    let stop = stop.with_normal_spring(&[(0, 1.0)], 4.0).unwrap();
    let ball = Structure::new(&[1.0]).unwrap().with_contact(stop).unwrap();
    let motion = ball.simulate(State::new(&[0.0], &[1.0]), 2.0).unwrap();
    closings += motion
        .events()
        .iter()
        .filter(|e| e.kind == EventKind::Close)
        .count();
    // It touches at the gap N0/k_n = 1/4.
    assert!((motion.events()[0].time - 0.25).abs() < 1e-15 && closings == 1);
}

/// Energies close with a load law that acts by a normal spring, and depends on velocity: a damped
/// stop.
#[test]
fn energy_closes_with_a_damped_stop() {
    let damper = VanDerPol::new(-0.3, 0.0).unwrap();
    let stop = Contact::new(1, Coulomb::new(0.3, 0.2).unwrap(), -0.4)
        .and_then(|c| c.with_normal_spring(&[(0, 1.0)], 20.0))
        .and_then(|c| c.with_load_law(&[(0, 1.0)], damper))
        .unwrap();
    let system = Structure::new(&[1.0, 0.5])
        .and_then(|s| s.with_ground_spring(0, 1.0)?.with_ground_spring(1, 3.0))
        .and_then(|s| s.with_force(0, Drive::sine(1.0, 0.8)?))
        .and_then(|s| s.with_contact(stop.on_belt(0.3)))
        .unwrap();
    let motion = system.simulate(State::at_rest(2), 40.0).unwrap();
    let kinds: Vec<EventKind> = motion.events().iter().map(|e| e.kind).collect();
    assert!(
        kinds.iter().filter(|k| **k == EventKind::Close).count() > 3,
        "{kinds:?}"
    );
    let budget = system.energy_budget(&motion).unwrap();
    assert!(budget.defect().abs() < 1e-11, "{budget:?}");
    // The damper takes energy: this is the work of the normal spring's load law.
    assert!(budget.normal_work[0] < -1e-3, "{budget:?}");
}

/// Steady sliding under laws in the load: forces balance, and the eigenvalues are those of the
/// equations.
#[test]
fn steady_sliding_and_its_eigenvalues_follow_the_law() {
    for_all(
        100,
        [
            0.5..3.0,
            0.5..3.0,
            -0.5..0.5,
            -0.2..0.5,
            -0.4..0.4,
            0.3..2.0,
        ],
        |[stiffness, load, square, cubic, damping, speed]| {
            let spring = PolynomialSpring::new(&[0.2, square, cubic]).unwrap();
            let damper = VanDerPol::new(damping, 0.3).unwrap();
            let law = Rational::new(0.5, 1.0).unwrap();
            let contact = Contact::new(1, law, load)
                .and_then(|c| c.with_load_law(&[(0, 1.0), (1, 0.5)], spring))
                .and_then(|c| c.with_load_law(&[(1, 1.0)], damper))
                .unwrap();
            let system = Structure::new(&[1.0, 0.8])
                .and_then(|s| s.with_ground_spring(0, stiffness)?.with_spring(0, 1, 2.0))
                .and_then(|s| s.with_contact(contact.on_belt(speed)))
                .unwrap();
            let Ok(steady) = system.steady_sliding() else {
                // Too soft for what presses it.
                return Ok(());
            };
            let at = State::new(&steady.displacements, &[0.0, 0.0]);
            for a in system.acceleration(0.0, &at).unwrap() {
                assert!(a.abs() < 1e-12, "{a:e}");
            }
            const STEP: f64 = 1e-5;
            let column = |k: usize| {
                let beside = |by: f64| {
                    let mut state = at.clone();
                    match k {
                        0 | 1 => state.displacements[k] += by,
                        _ => state.velocities[k - 2] += by,
                    }
                    let rates = system.acceleration(0.0, &state).unwrap();
                    [state.velocities, rates].concat()
                };
                let (a, b) = (beside(STEP), beside(-STEP));
                (0..4)
                    .map(|i| (a[i] - b[i]) / (2.0 * STEP))
                    .collect::<Vec<_>>()
            };
            let columns: Vec<Vec<f64>> = (0..4).map(column).collect();
            let jacobian = DMatrix::from_fn(4, 4, |i, k| columns[k][i]);
            let sum: f64 = steady.eigenvalues.iter().map(|s| s.re).sum();
            assert!((sum - jacobian.trace()).abs() < 1e-8);
            let all = jacobian.complex_eigenvalues();
            for s in &steady.eigenvalues {
                let nearest = all.iter().map(|x| (x - s).norm()).fold(1e300, f64::min);
                assert!(nearest < 1e-5, "{s} {all}");
            }
            Ok(())
        },
    );
}

/// Laws that give no number, run into a pole, or have no series, at the start and later.
#[test]
fn laws_that_fail_are_errors_with_contact_and_place() {
    #[derive(Debug, Clone, Copy)]
    enum Broken {
        Nan,
        Infinite,
        Pole,
        Root,
        Speed,
    }
    impl ForceLaw for Broken {
        fn force<S: Scalar>(&self, position: S, velocity: S, _: usize) -> S {
            match self {
                Self::Nan => (-position + 1.0).sqrt() + 1.0,
                Self::Infinite => (position * 800.0).exp(),
                Self::Pole => (-position + 1.0).recip().square() + 1.0,
                Self::Root => position.sqrt() * position + 1.0,
                Self::Speed => (-velocity + 0.5).sqrt() + 1.0,
            }
        }
    }
    let system = |law: Broken| {
        let contact = Contact::new(1, Coulomb::new(0.3, 0.2).unwrap(), 1.0).unwrap();
        let contact = contact
            .with_load_law(&[(0, 1.0)], law)
            .unwrap()
            .on_belt(0.5);
        let still = Contact::new(1, Coulomb::new(0.1, 0.1).unwrap(), 1.0).unwrap();
        Structure::new(&[1.0, 1.0])
            .and_then(|s| s.with_force(0, 0.1)?.with_ground_spring(1, 1.0))
            .and_then(|s| s.with_contact(still)?.with_contact(contact))
            .unwrap()
    };
    let run = |law: Broken, q: f64, v: f64| {
        system(law)
            .simulate(State::new(&[q, 0.0], &[v, 0.0]), 50.0)
            .unwrap_err()
    };
    let is_finite = |e: &Error, near: f64| match e {
        Error::NonFiniteLoad {
            contact, position, ..
        }
        | Error::NotAnalyticLoad {
            contact, position, ..
        } => *contact == 1 && (position - near).abs() < 1e-3,
        _ => false,
    };
    for (law, at_start, moving, place) in [
        (Broken::Nan, 2.0, 0.2, 1.0),
        (Broken::Pole, 1.0, 0.2, 1.0),
        (Broken::Root, -1.0, 0.0, 0.0),
    ] {
        let error = run(law, at_start, 0.0);
        assert!(is_finite(&error, at_start), "{law:?}: {error}");
        assert!(error.to_string().contains("contact 1"), "{error}");
        if moving > 0.0 {
            let error = run(law, 0.0, moving);
            assert!(is_finite(&error, place), "{law:?}: {error}");
        }
    }
    let error = run(Broken::Infinite, 2.0, 0.0);
    assert!(is_finite(&error, 2.0), "{error}");
    let error = run(Broken::Speed, 0.0, 0.6);
    assert!(
        matches!(error, Error::NonFiniteLoad { contact: 1, .. }),
        "{error}"
    );
    // Steady sliding finds nothing there, and says so.
    let contact = Contact::new(0, Coulomb::new(0.3, 0.2).unwrap(), 1.0).unwrap();
    for law in [Broken::Nan, Broken::Pole, Broken::Root] {
        let contact = contact.clone().with_load_law(&[(0, 1.0)], law).unwrap();
        let block = Structure::new(&[1.0])
            .and_then(|s| {
                s.with_ground_spring(0, 1.0)?
                    .with_contact(contact.on_belt(0.4))
            })
            .unwrap();
        match block.steady_sliding_from(&[1.5]) {
            Err(Error::NoSteadySliding(_)) => {}
            Ok(found) => assert!(found.displacements[0].is_finite()),
            Err(error) => panic!("{error}"),
        }
    }
}

/// A contact without friction never sticks: steady sliding needs no velocity of its surface, and a
/// mass at rest on it is as free as without it.
#[test]
fn a_contact_without_friction_does_not_stick() {
    let smooth = Coulomb::new(0.0, 0.0).unwrap();
    let pad = Contact::new(0, smooth, 1.0).unwrap();
    let rod = Contact::between(0, 1, smooth, 2.0).unwrap();
    let stop = Contact::new(1, smooth, 0.5)
        .and_then(|c| c.with_normal_spring(&[(1, 1.0)], 2.0))
        .unwrap();
    let masses = |contacts: Vec<Contact>| {
        Structure::new(&[1.0, 2.0])
            .and_then(|s| s.with_ground_spring(0, 1.0)?.with_spring(0, 1, 3.0))
            .and_then(|s| s.with_contacts(contacts))
            .unwrap()
    };
    let free = masses(Vec::new());
    for contacts in [vec![pad.clone()], vec![rod]] {
        let held = masses(contacts);
        for start in [State::at_rest(2), State::new(&[0.3, -0.2], &[0.0, 0.0])] {
            let [a, b] = [&held, &free].map(|s| s.simulate(start.clone(), 20.0).unwrap());
            assert!(!a.steps().iter().any(|s| s.modes().contains(&Mode::Stick)));
            let ends = [a.last(), b.last()].map(|s| [s.displacements, s.velocities].concat());
            for (a, b) in ends[0].iter().zip(&ends[1]) {
                assert!((a - b).abs() < 1e-12, "{a} {b}");
            }
            let maps = [&held, &free].map(|s| monodromy(s, &start, 20.0).unwrap().1);
            assert!(
                (&maps[0] - &maps[1]).amax() < 1e-11,
                "{}{}",
                maps[0],
                maps[1]
            );
        }
        let [a, b] = [&held, &free].map(|s| s.steady_sliding().unwrap().eigenvalues);
        for (a, b) in a.iter().zip(&b) {
            assert!((a - b).norm() < 1e-14, "{a} {b}");
        }
    }
    // A stop that presses with 1/2 moves the equilibrium.
    let steady = masses(vec![stop]).steady_sliding().unwrap();
    let q = &steady.displacements;
    assert!((q[0] + 0.5 + 2.0 * q[1]).abs() < 1e-15, "{q:?}");
    assert_eq!(steady.eigenvalues.len(), 4);
}

/// Bad input is refused where it enters.
#[test]
fn bad_input_is_refused() {
    let law = Coulomb::new(0.3, 0.3).unwrap();
    let spring = PolynomialSpring::new(&[1.0]).unwrap();
    let contact = Contact::new(0, law, 1.0).unwrap();
    for direction in [
        &[][..],
        &[(0, 0.0)],
        &[(0, f64::NAN)],
        &[(0, 1.0), (0, 2.0)],
    ] {
        let refused = contact.clone().with_load_law(direction, spring.clone());
        assert!(
            matches!(refused, Err(Error::BadDirection { .. })),
            "{refused:?}"
        );
    }
    let elsewhere = contact
        .clone()
        .with_load_law(&[(3, 1.0)], spring.clone())
        .unwrap();
    let block = || Structure::new(&[1.0]).unwrap();
    let refused = block().with_contact(elsewhere).unwrap_err();
    assert!(
        matches!(refused, Error::NoSuchCoordinate { coordinate: 3, .. }),
        "{refused}"
    );
    let elastic = contact.clone().with_tangential_stiffness(2.0).unwrap();
    let pressed = contact
        .clone()
        .with_load_law(&[(0, 1.0)], spring.clone())
        .unwrap();
    for refused in [
        elastic.with_load_law(&[(0, 1.0)], spring),
        pressed.with_tangential_stiffness(2.0),
    ] {
        let error = refused.unwrap_err();
        assert!(matches!(
            error,
            Error::InvalidParameter {
                name: "load laws",
                ..
            }
        ));
    }
    // A load ≤ 0 that nothing closes.
    for load in [0.0, -1.0] {
        let open = Contact::new(0, law, load).unwrap();
        let error = block().with_contact(open.clone()).unwrap_err();
        assert!(
            matches!(error, Error::InvalidParameter { name: "load", .. }),
            "{error}"
        );
        let held = open.with_normal_spring(&[(0, 1.0)], 1.0).unwrap();
        assert!(block().with_contact(held).is_ok());
    }
    for load in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert!(Contact::new(0, law, load).is_err());
    }
    assert_eq!(law.static_coefficient(), 0.3);
    let motion = block().simulate(State::at_rest(1), 1.0).unwrap();
    assert!(motion.steps().iter().all(|step| step.modes().is_empty()));
}

/// A block on a spherical bearing of radius R whose base moves up and down with the acceleration
/// a(t): the load m(g + a + v²/R) is that of the restoring force, which is the load times q/R.
/// Against an integrator of its own.
#[test]
fn a_friction_pendulum_with_vertical_motion_has_one_load_for_both_forces() {
    /// mv²/R as a load, and times x/R as a force.
    #[derive(Debug, Clone, Copy)]
    struct Centripetal {
        mass: f64,
        radius: f64,
        acts: bool,
    }
    impl ForceLaw for Centripetal {
        fn force<S: Scalar>(&self, position: S, velocity: S, _: usize) -> S {
            let load = velocity.square() * (self.mass / self.radius);
            match self.acts {
                true => load * position / self.radius,
                false => load,
            }
        }
    }
    for_all(
        40,
        [0.03..0.1, 0.5..2.0, 1.0..3.0, 0.0..0.6, 3.0..9.0, 0.2..0.6],
        |[mu, mass, radius, shaken, frequency, angle]| {
            const GRAVITY: f64 = 9.81;
            let weight = Drive::constant(mass * GRAVITY)
                .with_harmonic(mass * GRAVITY * shaken, frequency, 0.4)
                .unwrap();
            let law = |acts| Centripetal { mass, radius, acts };
            let spring = PolynomialSpring::new(&[1.0 / radius]).unwrap();
            let contact = Contact::new(0, Coulomb::new(mu, mu).unwrap(), weight.clone())
                .and_then(|c| c.with_load_law(&[(0, 1.0)], law(false)))
                .unwrap();
            let block = Structure::new(&[mass])
                .and_then(|s| {
                    s.with_element(ForceElement::new(0, spring)?.with_factor(weight)?)?
                        .with_element(ForceElement::new(0, law(true))?)?
                        .with_contact(contact)
                })
                .unwrap();
            let start = [radius * angle, 0.0];
            let motion = block
                .simulate(State::new(&start[..1], &start[1..]), 6.0)
                .unwrap();
            // The block swings to the other side until it turns.
            let turn = motion.events().iter().find(|e| e.time > 0.0).unwrap();
            let rates = |t: f64, y: &[f64]| {
                let load = mass * GRAVITY * (1.0 + shaken * (frequency * t + 0.4).cos());
                let load = load + mass * y[1] * y[1] / radius;
                vec![y[1], (mu * load - load * y[0] / radius) / mass]
            };
            let [end, again] = [200, 300].map(|n| integrate(&rates, &start, [0.0, turn.time], n));
            let found = [turn.state.displacements[0], turn.state.velocities[0]];
            for ((found, end), again) in found.iter().zip(&end).zip(&again) {
                assert!((end - again).abs() < 1e-12, "{end} {again}");
                assert!((found - end).abs() < 1e-12, "{found} {end}");
            }
            Ok(())
        },
    );
}

/// Stops with a gap in front of masses that are pushed by constant forces: in steady sliding some
/// are open and have no friction. Forces balance, and open stops leave the eigenvalues as they are.
#[test]
fn steady_sliding_is_found_with_open_contacts() {
    let mut random = Random::new(77);
    let (mut open, mut closed) = (0, 0);
    for _ in 0..count(100, 1000) {
        let n = 2 + (random.bits() % 3) as usize;
        let mut masses = Structure::new(&vec![1.0; n]).unwrap();
        for i in 0..n {
            masses = masses
                .with_ground_spring(i, random.uniform(0.5, 2.0))
                .and_then(|s| s.with_force(i, random.uniform(-1.0, 1.0)))
                .unwrap();
            if i > 0 {
                masses = masses.with_spring(i - 1, i, 0.5).unwrap();
            }
        }
        let mut stops = Vec::new();
        for i in 0..n {
            // Pressed by one mass, rubs on the next; some at rest while open.
            let stiffness = random.uniform(0.5, 3.0);
            let gap = random.uniform(-0.3, 0.6);
            let law = Rational::new(random.uniform(0.05, 0.3), 1.0).unwrap();
            let along = (i + 1) % n;
            let contact = Contact::new(along, law, -stiffness * gap)
                .unwrap()
                .on_belt(0.7);
            stops.push(match random.bits() % 3 {
                0 => {
                    let spring = PolynomialSpring::new(&[stiffness, 0.0, 0.3]).unwrap();
                    contact.with_load_law(&[(i, 1.0)], spring).unwrap()
                }
                _ => contact.with_normal_spring(&[(i, 1.0)], stiffness).unwrap(),
            });
        }
        let system = masses.clone().with_contacts(stops.clone()).unwrap();
        let steady = system.steady_sliding().unwrap();
        let at = State::new(&steady.displacements, &vec![0.0; n]);
        for a in system.acceleration(0.0, &at).unwrap() {
            assert!(a.abs() < 1e-13, "{a:e}");
        }
        let presses = |stop: &&Contact| stop.load_at(0.0, &steady.displacements) > 0.0;
        let pressing: Vec<Contact> = stops.iter().filter(presses).cloned().collect();
        open += n - pressing.len();
        closed += pressing.len();
        let fewer = masses.with_contacts(pressing).unwrap();
        let fewer = fewer.steady_sliding_from(&steady.displacements).unwrap();
        for (a, b) in steady.eigenvalues.iter().zip(&fewer.eigenvalues) {
            assert!((a - b).norm() < 1e-11, "{a} {b}");
        }
    }
    assert!(open > 50 && closed > 50, "{open} {closed}");
    // A surface at rest behind a gap; elastic, too. Without the gap it may carry any force.
    for gap in [0.5, -0.5] {
        let law = Coulomb::new(0.3, 0.3).unwrap();
        let stop = Contact::new(1, law, -gap)
            .and_then(|c| c.with_normal_spring(&[(0, 1.0)], 1.0))
            .unwrap();
        let elastic = stop.clone().with_tangential_stiffness(2.0).unwrap();
        for stop in [stop, elastic] {
            let pair = Structure::new(&[1.0, 1.0])
                .and_then(|s| s.with_ground_spring(0, 1.0)?.with_ground_spring(1, 4.0))
                .and_then(|s| s.with_force(0, 0.25)?.with_contact(stop))
                .unwrap();
            let found = pair.steady_sliding();
            assert_eq!(found.is_ok(), gap > 0.0, "{found:?}");
            if let Ok(found) = found {
                assert_eq!(found.displacements, [0.25, 0.0]);
                let frequencies = found.eigenvalues.iter().map(|s| s.im.abs());
                assert_eq!(
                    frequencies.take(4).collect::<Vec<_>>(),
                    [2.0, 1.0, 1.0, 2.0]
                );
            }
        }
    }
}
