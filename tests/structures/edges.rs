//! Contacts that nearly depend on each other, or stand exactly on an edge; motions that no spring
//! gives a time.

use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Direction, Drive, EventKind, Exponential, FrictionLaw, Mode, Rational,
    Segment, Structure, Tabulated,
};

use crate::common::{exactly, one_mass};

use crate::work::Work;

/// Without a spring a step may be so long that its series overflow.
#[test]
fn a_block_stops_under_the_largest_friction() {
    for friction in [1.0, 1e100, 1e300, 1e307, 1e308, f64::MAX] {
        for speed in [1e2, 1e10] {
            let law = Coulomb::new(friction, friction).unwrap();
            let block = Structure::new(&[1.0])
                .and_then(|s| s.with_contact(Contact::new(0, law, 1.0)?))
                .unwrap();
            let motion = block.simulate(State::new(&[0.0], &[speed]), 1e11).unwrap();
            let [stick] = motion.events() else {
                panic!("{friction:e} {speed:e}: {:?}", motion.events())
            };
            let time = speed / friction;
            assert_eq!(stick.kind, EventKind::Stick);
            assert!((stick.time - time).abs() <= 4.0 * f64::EPSILON * time);
        }
    }
}

/// A block that slides to a stop takes ∫ m ds/(N μ(s)). Where it starts, the law has no derivative
/// that is not rounding, and no spring, or a very soft one, gives a time in which to measure
/// velocities.
#[test]
fn a_block_without_a_spring_slides_to_a_stop() {
    let law = Exponential::new(0.31, 0.144, 0.0278).unwrap();
    let load = 0.7;
    for speed in [0.1, 0.3, 0.6, 0.755] {
        // Simpson's rule.
        let n = 20_000;
        let part = speed / f64::from(n);
        let weight = |i: i32| match i {
            0 => 1.0,
            i if i == n => 1.0,
            i => f64::from(2 + 2 * (i % 2)),
        };
        let sum: f64 = (0..=n)
            .map(|i| weight(i) / law.kinetic(part * f64::from(i)))
            .sum();
        let expected = sum * part / (3.0 * load);
        for spring in [0.0, 1e-30, 1e-20] {
            for belt in [0.0, 1.0] {
                let contact = Contact::new(0, law, load).unwrap().on_belt(belt);
                let block = one_mass([1.0, 0.0, spring], 0.0, contact).unwrap();
                let start = State::new(&[0.0], &[belt + speed]);
                let motion = block.simulate(start, 1.5 * expected).unwrap();
                let [stick] = exactly(motion.events());
                assert_eq!(stick.kind, EventKind::Stick);
                let error = stick.time / expected - 1.0;
                assert!(error.abs() < 2e-12, "{speed} {spring:e} {belt}: {error:e}");
            }
        }
    }
}

/// One contact holds two masses on springs, so that they can only move against each other; another
/// slides along nearly the same direction: the motion is that of a spring, to rounding.
#[test]
fn nearly_parallel_contacts_do_not_magnify_rounding() {
    for apart in [1e-3, 1e-5, 1e-7] {
        for i in 0..20 {
            let omega = 0.8 + 0.05 * f64::from(i);
            let law = Coulomb::new(0.4, 0.3).unwrap();
            let holds = Contact::along(&[(0, 1.0), (1, 1.0)], law, 20.0).unwrap();
            let slides = Contact::along(&[(0, 1.0), (1, 1.0 + apart)], law, 1.0).unwrap();
            let two = Structure::new(&[1.0, 1.0])
                .and_then(|s| s.with_ground_spring(0, omega * omega))
                .and_then(|s| s.with_ground_spring(1, omega * omega))
                .and_then(|s| s.with_contact(holds))
                .and_then(|s| s.with_contact(slides.on_belt(-0.15)))
                .unwrap();
            let motion = two
                .simulate(State::new(&[1.0, -1.0], &[0.0, 0.0]), 20.0)
                .unwrap();
            assert!(motion.events().is_empty());
            // x'' = −ω²(x − x_e), the force of what slides is −0.3(1, 1 + apart).
            let rest = 0.15 * apart / (omega * omega);
            for step in motion.steps() {
                let time = step.end_time();
                let (sin, cos) = (omega * time).sin_cos();
                let end = step.end_state();
                let x = rest + (1.0 - rest) * cos;
                let v = -omega * (1.0 - rest) * sin;
                for (found, expected) in [
                    (end.displacements[0], x),
                    (end.displacements[1], -x),
                    (end.velocities[0], v),
                    (end.velocities[1], -v),
                ] {
                    let error = found - expected;
                    assert!(error.abs() < 1e-13, "{apart:e} {i} {time}: {error:e}");
                }
            }
        }
    }
}

/// A contact holds two masses on an oscillating plate; another, along nearly the same direction,
/// slips there and back. Where it passes r = 0 its own rounding does not move the masses.
#[test]
fn nearly_parallel_contacts_that_reverse_do_not_magnify_rounding() {
    for apart in [1e-3, 1e-5, 1e-7] {
        for i in 0..20 {
            let plate = Drive::sine(0.2, 0.9 + 0.05 * f64::from(i)).unwrap();
            let law = Coulomb::new(0.4, 0.3).unwrap();
            let holds = Contact::along(&[(0, 1.0), (1, 1.0)], law, 20.0).unwrap();
            let slides = Contact::along(&[(0, 1.0), (1, 1.0 + apart)], law, 0.01).unwrap();
            let two = Structure::new(&[1.0, 1.0])
                .and_then(|s| s.with_ground_spring(0, 1.0))
                .and_then(|s| s.with_ground_spring(1, 1.3))
                .and_then(|s| s.with_contact(holds.on_belt(plate)))
                .and_then(|s| s.with_contact(slides.on_belt(0.07)))
                .unwrap();
            let start = State::new(&[1.0, -1.0], &[0.0, 0.0]);
            let motion = two.simulate(start, 20.0).unwrap();
            let kinds = motion.events().iter().map(|event| event.kind);
            let reversals = kinds.filter(|kind| matches!(kind, EventKind::Crossing(_)));
            assert!(reversals.count() > 4, "{:?}", motion.events());
            Work::new(&two, &[law.into(), law.into()]).balances(&motion, &format!("{apart:e} {i}"));
        }
    }
}

/// A belt under a block turns round, and what it pushes with is, both ways, exactly what the ground
/// can hold: the block stays at rest. It does not slip with less friction and no acceleration.
#[test]
fn a_block_on_the_edge_of_its_band_stays() {
    let pushed = Coulomb::new(0.5, 0.5).unwrap();
    let held = Coulomb::new(0.75, 0.5).unwrap();
    for i in 0..40 {
        let belt = Drive::harmonic(0.3, 1.1, 0.4 + 0.05 * f64::from(i)).unwrap();
        let block = Structure::new(&[1.75])
            .and_then(|s| s.with_ground_spring(0, 1.25))
            .and_then(|s| s.with_contact(Contact::new(0, pushed, 1.5)?.on_belt(belt)))
            .and_then(|s| s.with_contact(Contact::new(0, held, 1.0)?))
            .unwrap();
        let motion = block.simulate(State::at_rest(1), 20.0).unwrap();
        assert!(motion.events().len() >= 6);
        for event in motion.events() {
            let is_turn =
                matches!(event.kind, EventKind::Crossing(_)) && event.contact().unwrap() == 0;
            assert!(is_turn, "{i}: {event:?}");
        }
        assert_eq!(motion.last(), State::at_rest(1));
    }
}

/// Falls from 0.6 to 0.3 until a speed of 0.5, and is constant from there on.
fn table() -> Tabulated {
    Tabulated::new([(0.0, 0.6), (0.2, 0.45), (0.5, 0.3), (1.2, 0.4)]).unwrap()
}

/// A block slides at a speed at which pieces of a law meet, for as long as it is carried by a belt
/// or joined to another one: rounding of that speed does not stop the motion.
#[test]
fn a_held_block_slides_at_a_breakpoint() {
    let law = Rational::new(0.68, 0.57).unwrap();
    let mut releases = 0;
    for i in 0..40 {
        // Carried by a belt, until the spring pulls it back; on another belt that is faster by 0.5.
        let spring = 1.0 + 0.03 * f64::from(i);
        let block = Structure::new(&[1.8125])
            .and_then(|s| s.with_ground_spring(0, spring))
            .and_then(|s| s.with_ground_damper(0, 0.15))
            .and_then(|s| s.with_contact(Contact::new(0, law, 1.25)?.on_belt(0.25)))
            .and_then(|s| s.with_contact(Contact::new(0, table(), 0.8)?.on_belt(0.75)))
            .unwrap();
        let motion = block
            .simulate(State::new(&[0.0], &[0.25]), 12.0)
            .unwrap_or_else(|error| panic!("{i}: {error}"));
        let kinds = motion
            .events()
            .iter()
            .map(|event| (event.contact().unwrap(), event.kind));
        let release = (0, EventKind::Release(Direction::Lagging));
        releases += kinds.filter(|kind| *kind == release).count();

        // Two that stick to each other and swing, with a belt between them.
        let force = Drive::harmonic(0.4, 0.7 + 0.02 * f64::from(i), 0.3).unwrap();
        let joined = Contact::between(0, 1, law, 5.0).unwrap();
        let beside = Contact::between(0, 1, table(), 0.75).unwrap();
        let two = Structure::new(&[2.8, 3.1])
            .and_then(|s| s.with_ground_spring(0, 2.25))
            .and_then(|s| s.with_ground_spring(1, 0.5))
            .and_then(|s| s.with_force(1, force))
            .and_then(|s| s.with_contact(joined))
            .and_then(|s| s.with_contact(beside.on_belt(-0.5)))
            .unwrap();
        let motion = two
            .simulate(State::new(&[0.1, 0.2], &[0.3, 0.3]), 12.0)
            .unwrap_or_else(|error| panic!("{i}: {error}"));
        assert!(motion.events().is_empty(), "{i}: {:?}", motion.events());
        let modes = motion.steps().iter().map(|step| step.modes());
        assert!(modes.into_iter().all(|modes| modes[0] == Mode::Stick));
    }
    assert!(releases >= 40, "{releases}");
}
