//! Motions that must agree exactly: closed forms, mirror images, clones, energies, late phases.

use approx::assert_abs_diff_eq;
use std::f64::consts::{FRAC_PI_2, PI, TAU};

use proptest::{prop_assert, prop_assert_eq};
use stick_slip::analysis::forced::ForcedOscillator;
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Drive, Exponential, Integrator, Mode, Polynomial, Segment, Structure,
};

use crate::common::property::for_all;
use crate::common::{count, exactly, forced, larger, one_mass};
use crate::work::Work;

/// Two blocks on belts that oscillate together, with velocities w̄_i + W', and the same from the
/// belts' frame, q = y + W: steady belts, the additional forces −(M W'' + C W' + K W), row sums of
/// the matrices, and the additional loads Σ n W.
#[test]
fn an_oscillating_belt_is_a_forced_mass() {
    for (omega, amplitude, gradient) in [(0.7, 0.2, 0.0), (1.9, 0.1, 0.15), (3.1, 0.3, -0.1)] {
        // A multiple of a derivative of W', or of its integral W, added.
        let add = |drive: Drive, order: i32, factor: f64| -> Drive {
            let waves = [
                (amplitude, omega, 0.4),
                (0.5 * amplitude, 2.0 * omega, -FRAC_PI_2),
            ];
            waves.iter().fold(
                drive,
                |drive, &(amplitude, omega, phase): &(f64, f64, f64)| {
                    let amplitude = factor * amplitude * omega.powi(order);
                    let phase = phase + FRAC_PI_2 * f64::from(order);
                    drive.with_harmonic(amplitude, omega, phase).unwrap()
                },
            )
        };
        let law = Exponential::new(0.5, 0.3, 0.25).unwrap();
        let blocks = |oscillates: f64| {
            let contact = |i: usize, mean: f64| {
                let load = add(1.0.into(), -1, (1.0 - oscillates) * gradient);
                Contact::new(i, law, load)
                    .and_then(|contact| contact.with_load_gradient(1 - i, gradient))
                    .map(|contact| contact.on_belt(add(mean.into(), 0, oscillates)))
            };
            let force = |mass: f64, damping: f64, stiffness: f64| {
                [(1, mass), (0, damping), (-1, stiffness)]
                    .iter()
                    .fold(Drive::constant(0.0), |force, &(order, factor)| {
                        add(force, order, (oscillates - 1.0) * factor)
                    })
            };
            Structure::new(&[1.0, 1.6])
                .and_then(|s| s.with_ground_spring(0, 1.0)?.with_ground_spring(1, 0.8))
                .and_then(|s| s.with_spring(0, 1, 0.7)?.with_damper(0, 1, 0.05))
                .and_then(|s| s.with_ground_damper(0, 0.1)?.with_ground_damper(1, 0.03))
                .and_then(|s| s.with_force(0, force(1.0, 0.1, 1.0)))
                .and_then(|s| s.with_force(1, force(1.6, 0.03, 0.8)))
                .and_then(|s| {
                    s.with_contact(contact(0, 0.2)?)?
                        .with_contact(contact(1, 0.1)?)
                })
                .unwrap()
        };
        let [shift, rate] = [-1, 0].map(|order| add(Drive::constant(0.0), order, 1.0));
        let seen = |state: &State, time: f64| {
            let mut seen = state.clone();
            seen.displacements
                .iter_mut()
                .for_each(|q| *q -= shift.value(time));
            seen.velocities
                .iter_mut()
                .for_each(|v| *v -= rate.value(time));
            seen
        };
        let start = State::new(&[0.1, -0.2], &[0.3, 0.0]);
        let duration = 40.0;
        let other = blocks(0.0).simulate(seen(&start, 0.0), duration).unwrap();
        let one = blocks(1.0).simulate(start, duration).unwrap();
        assert!(one.events().len() > 10, "{}", one.events().len());
        assert_eq!(one.events().len(), other.events().len(), "{omega}");
        for (a, b) in one.events().iter().zip(other.events()) {
            assert_eq!(
                (a.contact().unwrap(), a.kind),
                (b.contact().unwrap(), b.kind),
                "{omega}"
            );
            assert!(
                (a.time - b.time).abs() < 1e-12,
                "{omega}: {} {}",
                a.time,
                b.time
            );
            let moved = seen(&a.state, a.time);
            for i in 0..2 {
                let apart = moved.displacements[i] - b.state.displacements[i];
                assert!(apart.abs() < 1e-12, "{omega}: {apart:e}");
            }
        }
    }
}

/// A structure with everything: coupling, loads in time and displacement, drives, three laws.
fn everything(sign: f64) -> (Structure, [stick_slip::AnyLaw; 3]) {
    let laws: [stick_slip::AnyLaw; 3] = [
        Polynomial::new(0.4, 0.25, 0.5).unwrap().into(),
        Exponential::new(0.5, 0.3, 0.25).unwrap().into(),
        Coulomb::new(0.3, 0.2).unwrap().into(),
    ];
    let law = |i: usize| -> stick_slip::AnyLaw { laws[i].clone() };
    let contact = |i: usize, law: stick_slip::AnyLaw, load: Drive, belt: Drive| {
        Contact::new(i, law, load).map(|contact| contact.on_belt(belt))
    };
    let load = Drive::sine(0.3, 0.9)
        .and_then(|d| d.with_constant(1.0))
        .unwrap();
    let ramp = [(0.0, 0.0), (5.0, 0.3 * sign), (20.0, -0.1 * sign)];
    let square = [
        (3.0, 0.0),
        (3.0, 0.4 * sign),
        (9.0, 0.4 * sign),
        (9.0, -0.2 * sign),
    ];
    let structure = Structure::new(&[1.0, 0.7, 2.0])
        .and_then(|s| s.with_ground_spring(0, 1.0)?.with_ground_spring(2, 1.5))
        .and_then(|s| s.with_spring(0, 1, 0.8)?.with_spring(1, 2, 0.6))
        .and_then(|s| s.with_damper(0, 1, 0.04)?.with_ground_damper(2, 0.06))
        .and_then(|s| s.with_force(0, Drive::harmonic(0.3 * sign, 1.3, 0.2)?))
        .and_then(|s| s.with_force(2, Drive::profile(&square)?))
        .and_then(|s| s.with_contact(contact(0, law(0), load, (0.2 * sign).into())?))
        .and_then(|s| {
            let contact = contact(2, law(1), 1.0.into(), Drive::profile(&ramp)?)?;
            s.with_contact(contact.with_load_gradient(1, 0.2 * sign)?)
        })
        .and_then(|s| {
            let belt = Drive::sine(0.25 * sign, 0.6)?;
            s.with_contact(contact(1, law(2), 0.8.into(), belt)?)
        })
        .unwrap();
    (structure, laws)
}

#[test]
fn mirror_images_agree_to_the_bit() {
    let start = State::new(&[0.4, -0.1, 0.2], &[0.1, 0.0, -0.3]);
    let negated = |numbers: &[f64]| numbers.iter().map(|x| -x).collect::<Vec<_>>();
    let mirrored =
        |state: &State| State::new(&negated(&state.displacements), &negated(&state.velocities));
    let one = everything(1.0).0.simulate(start.clone(), 40.0).unwrap();
    let other = everything(-1.0).0.simulate(mirrored(&start), 40.0).unwrap();
    assert!(one.events().len() > 20);
    assert_eq!(one.events().len(), other.events().len());
    for (a, b) in one.events().iter().zip(other.events()) {
        assert_eq!(a.time, b.time);
        assert_eq!(
            (a.contact().unwrap(), a.kind.mode() == Mode::Stick),
            (b.contact().unwrap(), b.kind.mode() == Mode::Stick)
        );
        assert_eq!(mirrored(&a.state), b.state);
    }
}

#[test]
fn clones_stay_together_to_the_bit() {
    // Two equal blocks, coupled to each other and each to the ground, one load on both.
    let blocks = |belt: &Drive| {
        let law = Exponential::new(0.6, 0.3, 0.25).unwrap();
        let contact = |i| Contact::new(i, law, 1.0).map(|contact| contact.on_belt(belt.clone()));
        Structure::new(&[1.3, 1.3])
            .and_then(|s| s.with_ground_spring(0, 1.1)?.with_ground_spring(1, 1.1))
            .and_then(|s| s.with_spring(0, 1, 0.37)?.with_damper(0, 1, 0.03))
            .and_then(|s| s.with_ground_damper(0, 0.06)?.with_ground_damper(1, 0.06))
            .and_then(|s| s.with_contact(contact(0)?)?.with_contact(contact(1)?))
            .unwrap()
    };
    let shaken = Drive::sine(0.2, 0.77)
        .and_then(|d| d.with_constant(0.25))
        .unwrap();
    for belt in [Drive::constant(0.25), shaken] {
        let motion = blocks(&belt).simulate(State::at_rest(2), 200.0).unwrap();
        assert!(motion.events().len() > 50);
        for pair in motion.events().chunks(2) {
            let [a, b] = exactly(pair);
            assert_eq!((a.contact().unwrap(), b.contact().unwrap()), (0, 1));
            assert_eq!((a.time, a.kind, &a.state), (b.time, b.kind, &b.state));
        }
        for (_, state) in motion.sample(1000) {
            assert_eq!(state.displacements[0], state.displacements[1]);
            assert_eq!(state.velocities[0], state.velocities[1]);
        }
    }
}

/// The work of forces, dampers and contacts is the change of energy, whatever happens between.
#[test]
fn energy_balances() {
    let (structure, laws) = everything(1.0);
    let start = State::new(&[0.4, -0.1, 0.2], &[0.1, 0.0, -0.3]);
    let motion = structure.simulate(start, 40.0).unwrap();
    Work::new(&structure, &laws).balances(&motion, "everything");
}

/// A motion that is locked to its drive comes at the same phases after 10⁶ and 10⁹ periods.
#[test]
fn late_phases_are_the_early_ones() {
    let (omega, law) = (1.3, Exponential::new(0.5, 0.3, 0.25).unwrap());
    let force = Drive::sine(0.3, omega).unwrap();
    let contact = Contact::new(0, law, 1.0).unwrap().on_belt(0.2);
    let structure = one_mass([1.0, 0.06, 1.0], force, contact).unwrap();
    let period = structure.period().unwrap();
    let late_events = |periods: f64| {
        let start = Integrator::new()
            .with_start_time((periods * period).round())
            .unwrap();
        let motion = start
            .simulate(&structure, State::at_rest(1), 100.0 * period)
            .unwrap();
        let events = motion.events();
        events[events.len() - 4..].to_vec()
    };
    // T in two numbers: 2π/1.3 with the error of its rounding, by 2π = τ + 2.4492935982947064e-16.
    let rest = (TAU - (period * omega) - omega.mul_add(period, -(period * omega))
        + 2.449_293_598_294_706_4e-16)
        / omega;
    let early = late_events(0.0);
    assert_eq!(early.len(), 4);
    for periods in [1e3, 1e6, 1e9] {
        for event in late_events(periods) {
            // Its partner: of the same kind, a whole number of periods before.
            let apart = early
                .iter()
                .filter(|other| other.kind == event.kind)
                .map(|other| {
                    let between = event.time - other.time;
                    let turns = (between / period).round();
                    let whole = turns * period;
                    let error = turns.mul_add(period, -whole);
                    ((between - whole) - error - turns * rest).abs()
                })
                .fold(f64::INFINITY, f64::min);
            let ulp = event.time.next_up() - event.time;
            assert!(
                apart <= 2.0 * ulp + 4e-15,
                "{periods:e}: {apart:e}, ulp {ulp:e}"
            );
        }
    }
}

/// 10⁵ periods of the drive, or 10⁶, step by step: turning points where the closed form has them,
/// and the same as of a motion that begins a few hundred periods before.
#[test]
fn many_periods_lose_no_phase() {
    let periods = count(30_000, 1_000_000) as f64;
    let oscillator = ForcedOscillator {
        damping: 0.05,
        angular_frequency: 2.0,
        kinetic_friction: 0.3,
        static_friction: 0.3,
        force: 1.0,
    };
    let orbit = oscillator.without_stops().unwrap();
    let structure = forced(&oscillator, orbit.phase());
    let period = orbit.period();
    assert_eq!(period, PI);
    let start = || State::new(&[orbit.amplitude()], &[0.0]);
    let last = |from: f64| {
        let flow = Integrator::new().with_start_time(from).unwrap();
        let steps = flow.flow(&structure, start()).unwrap();
        let steps = steps.map(Result::unwrap);
        let late = steps.skip_while(|step| step.start_time() < (periods - 4.0) * period);
        let events = late.flat_map(|step| step.events().to_vec());
        events.take(8).collect::<Vec<_>>()
    };
    // π in two numbers.
    const REST: f64 = 1.224_646_799_147_353_2e-16;
    let followed = last(0.0);
    let close = last((periods - 200.0) * period);
    let mut worst = 0.0_f64;
    for (event, other) in std::iter::zip(&followed, &close) {
        assert_eq!(event.kind, other.kind);
        let ulp = event.time.next_up() - event.time;
        assert_abs_diff_eq!(event.time, other.time, epsilon = 2.0 * ulp);
        let halves = (event.time / (0.5 * PI)).round();
        let product = halves * (0.5 * PI);
        let error = halves.mul_add(0.5 * PI, -product) + halves * 0.5 * REST;
        let apart = ((event.time - product) - error).abs();
        worst = larger(worst, apart / ulp);
        let turn = orbit.amplitude() * if halves % 2.0 == 0.0 { 1.0 } else { -1.0 };
        let place = event.state.displacements[0];
        assert!((place - turn).abs() < 4e-15, "{place} {turn}");
    }
    assert_eq!(followed.len(), 8);
    assert!(worst <= 4.0, "{worst} ulps");
}

/// Stuck for 10⁴ periods on a belt that oscillates: carried along without an error.
#[test]
fn a_stuck_mass_is_carried_exactly() {
    let omega = 0.9;
    let contact = Contact::new(0, Coulomb::new(0.9, 0.5).unwrap(), 10.0).unwrap();
    let contact = contact.on_belt(Drive::sine(0.4, omega).unwrap());
    let structure = one_mass([1.0, 0.0, 1.0], 0.0, contact).unwrap();
    let start = State::new(&[0.0], &[0.0]);
    let flow = Integrator::new().flow(&structure, start).unwrap();
    let (mut last, mut steps) = (None, 0);
    for step in flow {
        let step = step.unwrap();
        assert_eq!(step.modes(), [Mode::Stick]);
        let end = step.end_time();
        last = Some(step);
        steps += 1;
        if end > 1e4 * TAU / omega {
            break;
        }
    }
    // Inside the step: its ends are times of two numbers.
    let last = last.unwrap();
    let time = 0.5 * (last.start_time() + last.end_time());
    // q = (w/Ω)(1 − cos Ωt)
    let expected = Drive::harmonic(-0.4 / omega, omega, 0.0)
        .and_then(|drive| drive.with_constant(0.4 / omega))
        .unwrap();
    let found = last.state_at(last.since_start(time)).displacements[0];
    assert!(
        (found - expected.value(time)).abs() < 2e-15,
        "{found} {} {steps}",
        expected.value(time)
    );
}

/// Two coordinates that are not coupled move as each does alone.
#[test]
fn uncoupled_masses_do_not_feel_each_other() {
    for_all(
        256,
        [
            0.3..3.0,
            0.3..3.0,
            0.3..3.0,
            0.3..3.0,
            0.0..0.3,
            0.0..0.3,
            -0.5..0.5,
            -0.5..0.5,
            0.0..1.0,
            0.0..1.0,
            -1.0..1.0,
            -1.0..1.0,
            -1.0..1.0,
            -1.0..1.0,
        ],
        |[m1, m2, k1, k2, c1, c2, b1, b2, f1, f2, starts @ ..]| {
            let (masses, stiffness, damping) = ([m1, m2], [k1, k2], [c1, c2]);
            let (belts, forces) = ([b1, b2], [f1, f2]);
            let law = Exponential::new(0.5, 0.3, 0.25).unwrap();
            let force = |i: usize| Drive::sine(forces[i], 1.1 + 0.4 * i as f64);
            let alone = |i: usize| {
                Structure::new(&masses[i..=i])
                    .and_then(|s| s.with_ground_spring(0, stiffness[i]))
                    .and_then(|s| s.with_ground_damper(0, damping[i]))
                    .and_then(|s| s.with_force(0, force(i)?))
                    .and_then(|s| s.with_contact(Contact::new(0, law, 1.0)?.on_belt(belts[i])))
                    .and_then(|s| {
                        s.simulate(State::new(&starts[i..=i], &starts[2 + i..=2 + i]), 20.0)
                    })
            };
            let both = Structure::new(&masses)
                .and_then(|s| s.with_ground_spring(0, stiffness[0]))
                .and_then(|s| s.with_ground_spring(1, stiffness[1]))
                .and_then(|s| {
                    s.with_ground_damper(0, damping[0])?
                        .with_ground_damper(1, damping[1])
                })
                .and_then(|s| s.with_force(0, force(0)?)?.with_force(1, force(1)?))
                .and_then(|s| s.with_contact(Contact::new(0, law, 1.0)?.on_belt(belts[0])))
                .and_then(|s| s.with_contact(Contact::new(1, law, 1.0)?.on_belt(belts[1])))
                .and_then(|s| s.simulate(State::new(&starts[..2], &starts[2..]), 20.0))
                .unwrap();
            for i in 0..2 {
                let alone = alone(i).unwrap();
                let mine: Vec<_> = both
                    .events()
                    .iter()
                    .filter(|event| event.contact().unwrap() == i)
                    .collect();
                prop_assert_eq!(mine.len(), alone.events().len());
                for (a, b) in mine.into_iter().zip(alone.events()) {
                    prop_assert_eq!(a.kind, b.kind);
                    prop_assert!((a.time - b.time).abs() < 1e-11, "{} {}", a.time, b.time);
                }
                let (a, b) = (both.last().displacements[i], alone.last().displacements[0]);
                prop_assert!((a - b).abs() < 1e-11, "{} {}", a, b);
            }
            Ok(())
        },
    );
}

/// Two shafts, the first held by a spring whose other end turns to and fro, rubbing on the ground
/// and on each other, with a damper to the ground: from the ground, and from a frame that turns
/// with that end.
#[test]
fn a_frame_that_turns_at_varying_speed_changes_nothing() {
    let (size, frequency) = (0.8, 0.7);
    let (spring, joint, damper) = (1.3, 0.9, 0.15);
    let mass = stick_slip::nalgebra::DMatrix::from_row_slice(2, 2, &[1.0, 0.2, 0.2, 0.6]);
    // Θ = a sin ωt.
    let speed = |factor: f64| Drive::harmonic(factor * size * frequency, frequency, 0.0);
    let acceleration = |factor: f64| Drive::sine(-factor * size * frequency.powi(2), frequency);
    let common = || {
        Structure::with_mass_matrix(mass.clone())?
            .with_ground_spring(0, spring)?
            .with_spring(0, 1, joint)?
            .with_damper(0, 1, 0.1)?
            .with_ground_damper(1, damper)
    };
    let law = Exponential::new(0.4, 0.25, 0.3).unwrap();
    let rubbing = || Contact::new(1, law, 0.8);
    let clutch = || Contact::between(0, 1, law, 0.3);
    let ground = common()
        .and_then(|s| s.with_force(0, Drive::sine(spring * size, frequency)?))
        .and_then(|s| s.with_contact(rubbing()?)?.with_contact(clutch()?))
        .unwrap();
    let frame = common()
        .and_then(|s| {
            s.with_force(0, acceleration(-1.2)?)?
                .with_force(1, acceleration(-0.8)?)
        })
        .and_then(|s| s.with_force(1, speed(-damper)?))
        .and_then(|s| {
            s.with_contact(rubbing()?.on_belt(speed(-1.0)?))?
                .with_contact(clutch()?)
        })
        .unwrap();
    let begin = size * frequency;
    let seen = ground
        .simulate(State::new(&[0.3, -0.2], &[0.5, 0.1]), 60.0)
        .unwrap();
    let start = State::new(&[0.3, -0.2], &[0.5 - begin, 0.1 - begin]);
    let other = frame.simulate(start, 60.0).unwrap();
    assert!(seen.events().len() > 20);
    assert_eq!(seen.events().len(), other.events().len());
    for (one, same) in std::iter::zip(seen.events(), other.events()) {
        assert_eq!(
            (one.contact().unwrap(), one.kind),
            (same.contact().unwrap(), same.kind)
        );
        assert!(
            (one.time - same.time).abs() < 1e-11,
            "{} {}",
            one.time,
            same.time
        );
    }
    for ((time, one), (_, same)) in std::iter::zip(seen.sample(200), other.sample(200)) {
        let (angle, rate) = (
            size * (frequency * time).sin(),
            size * frequency * (frequency * time).cos(),
        );
        for i in 0..2 {
            let apart = one.displacements[i] - angle - same.displacements[i];
            assert!(apart.abs() < 1e-11, "{time}: {apart:e}");
            let apart = one.velocities[i] - rate - same.velocities[i];
            assert!(apart.abs() < 1e-11, "{time}: {apart:e}");
        }
    }
}

/// Another unit of time changes rounding only: no step, no event.
#[test]
fn the_unit_of_time_does_not_matter() {
    // Seconds in `unit`.
    let motion = |unit: f64| {
        let (rate, force) = (1.0 / unit, 1.0 / (unit * unit));
        let law = Exponential::new(0.4, 0.25, 0.3 * rate).unwrap();
        let elastic = Contact::between(0, 1, Coulomb::new(0.3, 0.3)?, 0.5 * force)?
            .with_tangential_stiffness(2.0 * force)?;
        Structure::new(&[1.0, 0.7])?
            .with_ground_spring(0, force)?
            .with_spring(0, 1, 0.8 * force)?
            .with_damper(0, 1, 0.05 * rate)?
            .with_force(1, Drive::sine(0.5 * force, 0.75 * rate)?)?
            .with_contact(Contact::new(0, law, force)?.on_belt(0.2 * rate))?
            .with_contact(elastic)?
            .simulate(
                State::new(&[0.3, -0.2], &[0.5 * rate, -0.1 * rate]),
                30.0 * unit,
            )
    };
    let first = motion(1.0).unwrap();
    assert!(first.events().len() > 20);
    for power in [-34, -10, 10, 30] {
        let unit = 2.0_f64.powi(power);
        let other = motion(unit).unwrap();
        assert_eq!(first.steps().len(), other.steps().len(), "2^{power}");
        assert_eq!(first.events().len(), other.events().len(), "2^{power}");
        for (one, same) in std::iter::zip(first.events(), other.events()) {
            assert_eq!(
                (one.contact().unwrap(), one.kind),
                (same.contact().unwrap(), same.kind)
            );
            assert_abs_diff_eq!(one.time, same.time / unit, epsilon = 1e-12);
            for (x, y) in std::iter::zip(&one.state.displacements, &same.state.displacements) {
                assert_abs_diff_eq!(*x, *y, epsilon = 1e-12);
            }
        }
    }
}

/// A mass without a ground spring is slower than its drives: their own time is the scale by which
/// errors are measured, and a narrow law at the end of a step is not stepped over.
#[test]
fn errors_follow_the_tolerance_under_a_fast_surface() {
    let surface = Drive::sine(0.49771337747009914, 3.0687358676696874)
        .and_then(|drive| drive.with_constant(-0.05791618370614726))
        .unwrap();
    let law = Exponential::new(0.29701115141331247, 0.23706454888389647, 0.0549066127385061);
    let rigid = Contact::new(0, law.unwrap(), 1.0319745411503436).unwrap();
    let coulomb = Coulomb::new(0.2766483635195277, 0.2766483635195277).unwrap();
    let elastic = Contact::new(0, coulomb, 0.4138683850898119)
        .and_then(|contact| contact.with_tangential_stiffness(0.6794736866916499))
        .unwrap();
    let structure = Structure::new(&[2.8173773985555135])
        .and_then(|structure| structure.with_ground_damper(0, 0.053051621162190025))
        .and_then(|structure| structure.with_contact(rigid.on_belt(surface)))
        .and_then(|structure| structure.with_contact(elastic.on_belt(0.32)))
        .unwrap();
    let start = || State::new(&[-0.23768315433777576], &[-0.05791618370614726]);
    let exact = structure.simulate(start(), 6.0).unwrap();
    for tolerance in [1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11] {
        let integrator = Integrator::new().with_tolerance(tolerance).unwrap();
        let motion = integrator.simulate(&structure, start(), 6.0).unwrap();
        for k in 1..=60 {
            let time = 0.1 * f64::from(k);
            let [a, b] = [&exact, &motion].map(|motion| motion.state_at(time).unwrap());
            let apart = (a.velocities[0] - b.velocities[0]).abs();
            assert!(apart < 40.0 * tolerance, "{tolerance:e} {time}: {apart:e}");
        }
    }
}
