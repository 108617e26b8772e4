//! Random contacts with bristles, beside an implicit integrator that shares nothing with the
//! crate's.

use approx::assert_abs_diff_eq;
use stick_slip::structure::State;
use stick_slip::{
    Contact, ContactLaw, Drive, LuGre, Mode, Motion, RateState, Scalar, Slip, Structure,
};

use crate::common::bristles::{Block, Bristles, Radau, apart, follow};
use crate::common::{Random, count, even, larger, one_mass};
use crate::stiff_memory::Padded;

/// LuGre's bristles, Dahl's, and a law of one's own that fades or has a bump; from soft to stiff,
/// and with a friction that rises below speeds far under those of the motion, so that a series that
/// begins there cannot know it.
#[test]
fn random_bristles_agree_with_an_implicit_integrator() {
    let mut random = Random::new(2028);
    let times: Vec<f64> = (1..=8).map(|i| 1.5 * f64::from(i)).collect();
    let (mut worst, mut most) = (0.0_f64, 0);
    for number in 0..count(4, 32) {
        let (block, kind) = Block::random(&mut random);
        let q = random.uniform(-1.0, 1.0);
        let v = if random.bits().is_multiple_of(2) {
            block.belt
        } else {
            random.uniform(-1.0, 1.0)
        };
        let start = State::new(&[q], &[v]);
        let about = format!("{number}: {kind} {block:?} {start:?}");
        let mut motions = vec![block.follow(kind, &start, &times).expect(&about)];
        if block.law.stiffness < 1e3 {
            // Followed by explicit steps.
            let padded = block.structure(Padded(block.law.clone()));
            motions.push(follow(&padded, &start, &times).expect(&about));
        }
        let (steps, crossings) = (motions[0].0, motions[0].1);
        // What swings on its bristles, or creeps, is followed; what slides on them is slow.
        let [stiffness, damping] = [block.law.stiffness, block.law.damping];
        let [stiffness, damping] = [stiffness, damping].map(|x| x * block.load / block.mass);
        let swing = (stiffness.sqrt() + damping) * times[7];
        assert!(
            (steps as f64) < 500.0 + 0.3 * swing + 40.0 * crossings as f64,
            "{steps} steps, {crossings} crossings: {about}"
        );
        most = most.max(steps);
        let mut radau = Radau::new(&block, 1e-13, &start);
        // How far the motion itself carries a small error.
        let aside = State::new(&[q + 1e-13], &[v]);
        let mut nearby = Radau::new(&block, 1e-11, &aside);
        let mut spread = 0.0_f64;
        for i in 0..times.len() {
            assert!(
                radau.advance(1.5, 200_000) && nearby.advance(1.5, 200_000),
                "{about}"
            );
            spread = spread.max(apart(&block, &radau.state(), &nearby.state()));
            for motion in &motions {
                let error = apart(&block, &radau.state(), &motion.2[i]);
                assert!(
                    error < 1e-11 + 3.0 * spread,
                    "{error:e} beside {spread:e}: {about}"
                );
                worst = larger(worst, error);
            }
        }
        assert!(spread < 1e-4, "{spread:e}: {about}");
    }
    println!("worst {worst:.1e}, up to {most} steps");
}

/// The bristles of Table I of C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, *IEEE
/// Trans. Automatic Control* 40 (1995) 419-425, under a spring whose end moves at 0.1 m/s.
fn table_one() -> Block {
    Block {
        law: Bristles {
            stiffness: 1e5,
            damping: 1e5_f64.sqrt(),
            viscous: 0.4,
            fading: 0.0,
            limit: 1.5,
            least: 1.0,
            stribeck: 0.001,
            exponent: 2,
            bump: [0.0, 0.0, 1.0],
        },
        mass: 1.0,
        spring: 2.0,
        damper: 0.0,
        load: 1.0,
        belt: -0.1,
    }
}

/// The mass slides at 0.7 and more, where nothing is left of the rise of g below 0.003, and comes
/// to rest within one step.
#[test]
fn the_bristles_of_table_one_come_to_rest() {
    let block = table_one();
    let start = State::new(&[0.0], &[-0.1]);
    let times = [10.2660909413, 10.5, 20.0, 30.0];
    let (steps, crossings, states) = block.follow(1, &start, &times).unwrap();
    // Fixed steps of 1e-6 and of 2e-6 by the classical Runge-Kutta method.
    let [q, v, z] = states[0];
    assert!((q + 0.390324710315).abs() < 1e-8 && (v + 0.1).abs() < 1e-10);
    assert_abs_diff_eq!(z, 1.06108505e-5, epsilon = 1e-13);
    assert!((states[1][0] + 0.4137160002756).abs() < 1e-12);
    let seen = compare(&block, &start, times, &states, 1e-12);
    assert!(steps < 700 && crossings == seen, "{steps} {crossings}");
}

/// Compares states at times with those of the other method. Returns the crossings that it sees.
fn compare(
    block: &Block,
    start: &State,
    times: [f64; 4],
    states: &[[f64; 3]],
    allowed: f64,
) -> usize {
    let mut radau = Radau::new(block, 1e-13, start);
    let mut time = 0.0;
    for (t, state) in std::iter::zip(times, states) {
        assert!(radau.advance(t - time, 100_000));
        time = t;
        let error = apart(block, state, &radau.state());
        assert!(error < allowed, "{t}: {error:e} {block:?}");
    }
    radau.crossings
}

/// A mass whose sliding speed comes down to about that below which g rises, and goes up again:
/// where it is slowest the rate of the bristles is small whatever g is.
#[test]
fn slow_minima_see_the_rise_of_friction() {
    for stribeck in [1e-2, 1e-3, 1e-4, 1e-5] {
        for least in [3.0, 1.0, 0.1, 1e-4] {
            for stiffness in [1e2, 1e4, 1e6] {
                let mut block = table_one();
                block.law.stiffness = stiffness;
                (block.law.damping, block.law.viscous) = (0.0, 0.0);
                block.law.stribeck = stribeck;
                // Sliding backward the mass is pushed forward by 1; from a velocity of 0 it comes
                // to 0.6 ω.
                let start = State::new(&[0.5 - 0.6], &[0.0]).with_memory(&[-1.0 / stiffness]);
                block.belt = 0.6 * 2.0_f64.sqrt() + least * stribeck;
                let times = [1.0, 1.2, 2.0, 4.0];
                let (_, _, states) = block.follow(1, &start, &times).unwrap();
                compare(&block, &start, times, &states, 1e-11);
            }
        }
    }
}

/// A static coefficient with a dip after some time of rest, of which nothing is seen at its start.
struct Dip;

impl ContactLaw for Dip {
    type Memory<S: Scalar> = [S; 1];
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, _: [S; 1]) -> S {
        slip.speed.constant(0.2 * slip.direction)
    }
    fn limit<S: Scalar>(&self, _: S, [rest]: [S; 1]) -> Option<S> {
        let part = (rest - 5.0) / 0.15;
        Some((-(part * part)).exp() * -0.3 + 0.6)
    }
    fn rates<S: Scalar>(&self, motion: Motion<S>, _: S, [rest]: [S; 1]) -> [S; 1] {
        [rest.constant(match motion {
            Motion::Stick => 1.0,
            Motion::Slip(_) => 0.0,
        })]
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        std::iter::empty()
    }
    fn caught(&self, _: [f64; 1]) -> [f64; 1] {
        [0.0]
    }
}

/// A contact that sticks is released where its limit falls to what it carries, however late the
/// limit begins to fall.
#[test]
fn a_limit_that_dips_at_rest_is_met() {
    for carried in [0.59, 0.45, 0.31] {
        let block = one_mass([1.0, 0.0, 1.0], carried, Contact::new(0, Dip, 1.0).unwrap()).unwrap();
        let motion = block.simulate(State::new(&[0.0], &[0.0]), 20.0).unwrap();
        let expected = 5.0 - 0.15 * (0.3 / (0.6 - carried)).ln().sqrt();
        let released = motion.events()[0].time;
        println!("{released} {expected}");
        assert_abs_diff_eq!(released, expected, epsilon = 1e-12);
    }
}

/// A contact that never sticks, beside a joint that does: the joint holds it at rest, and it has no
/// events of its own.
#[test]
fn contacts_that_others_hold_do_not_cross() {
    let mut random = Random::new(93);
    let mut uniform = |low, high| random.uniform(low, high);
    let mut draws: Vec<[f64; 5]> = (0..count(12, 100))
        .map(|_| {
            let [a, b] = [0; 2].map(|_| uniform(0.5, 2.0));
            [
                a,
                b,
                uniform(0.5, 1.5),
                uniform(0.2, 0.8),
                uniform(-0.5, 0.5),
            ]
        })
        .collect();
    // Here rate-and-state friction could not decide in which direction it is at rest.
    draws.push([
        0.6225012313728265,
        1.9161807356264384,
        0.8766023957928147,
        0.5169227077471096,
        -0.1664601460105316,
    ]);
    let mut held = 0;
    for (i, [a, b, frequency, u, v]) in draws.into_iter().enumerate() {
        let force = Drive::harmonic(1.0, frequency, 0.0).unwrap();
        let start = State::new(&[0.1, 0.0], &[u, v]);
        let bristles = LuGre::new(even(0.3), 20.0, 0.2, 0.05);
        let aging = RateState::aging(0.3, 0.1, 0.05, 0.3, 0.2);
        let contacts = [
            bristles.and_then(|law| Contact::between(0, 1, law, 0.5)),
            aging.and_then(|law| Contact::between(0, 1, law, 0.5)),
        ];
        for (kind, contact) in contacts.into_iter().enumerate() {
            let structure = Structure::new(&[a, b])
                .and_then(|s| s.with_ground_spring(0, 1.0)?.with_spring(0, 1, 0.7))
                .and_then(|s| s.with_force(0, force.clone()))
                .and_then(|s| s.with_contact(Contact::between(0, 1, even(0.4), 1.0)?))
                .and_then(|s| s.with_contact(Contact::new(1, even(0.4), 1.0)?))
                .and_then(|s| s.with_contact(contact?))
                .unwrap();
            let motion = structure.simulate(start.clone(), 30.0);
            let motion = motion.unwrap_or_else(|error| panic!("{i}, {kind}: {error}"));
            let sticks = |time: f64| motion.mode_at(0, time) == Some(Mode::Stick);
            for event in motion.events() {
                let is_held = sticks(event.time - 1e-5) && sticks(event.time + 1e-5);
                assert!(
                    !(is_held && event.contact() == Some(2)),
                    "{i}, {kind}: {} at {}",
                    event.kind,
                    event.time
                );
                held += usize::from(event.contact() == Some(0) && sticks(event.time + 1e-5));
            }
        }
    }
    println!("held {held} times");
    assert!(held > 50);
}
