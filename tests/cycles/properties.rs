//! Limit cycles of random systems with random laws: identities that hold on every cycle.

use std::f64::consts::TAU;

use crate::common::any::systems;
use crate::common::orbit::{around, find, size};
use crate::common::{assert_mirrored, count};
use stick_slip::limit_cycle;
use stick_slip::{CycleKind, Direction, EventKind, FrictionLaw, Mode, State};

const EPS: f64 = f64::EPSILON;

#[test]
fn energy_balances() {
    let mut worst = [0.0_f64; 3];
    let mut cycles = 0;
    let of_each = count(15, 60);
    for (about, system) in systems(1, of_each) {
        for cycle in &find(&about, &system) {
            cycles += 1;
            let v_b = system.belt_velocity();
            let energy = cycle.energy();
            let u_max = cycle
                .max_displacement()
                .abs()
                .max(cycle.min_displacement().abs());
            let v_max = cycle.max_velocity().abs().max(cycle.min_velocity().abs());
            let allowed = 1e-13 * energy.drive_work + 20.0 * EPS * (u_max * u_max + v_max * v_max);
            let lever = 40.0 * EPS * v_b.abs() * cycle.amplitude() * cycle.period();
            let mean = v_b * cycle.mean_displacement() * cycle.period();
            // Friction from the law, not from the motion.
            let force = |state: State| system.friction_force(state);
            let drive = around(cycle, |_, state| force(state) * v_b);
            let friction = around(cycle, |_, state| force(state) * (v_b - state.velocity));
            let belt = around(cycle, |_, state| force(state) * state.velocity);
            let losses = energy.damper_loss + energy.friction_loss;
            for (i, (what, a, b, allowed)) in [
                (
                    "belt work and damper loss",
                    energy.belt_work,
                    energy.damper_loss,
                    allowed,
                ),
                ("drive work and losses", energy.drive_work, losses, allowed),
                (
                    "drive work and ∮u",
                    energy.drive_work,
                    mean,
                    allowed + lever,
                ),
                ("drive work by the law", energy.drive_work, drive, allowed),
                (
                    "friction loss by the law",
                    energy.friction_loss,
                    friction,
                    allowed,
                ),
                ("belt work by the law", energy.belt_work, belt, allowed),
            ]
            .into_iter()
            .enumerate()
            {
                let error = (a - b).abs() / allowed;
                worst[i.min(2)] = worst[i.min(2)].max(error);
                assert!(
                    error <= 1.0,
                    "{about}: {:?} {}: {what} {a:e} {b:e}: {error}",
                    cycle.kind(),
                    cycle.amplitude()
                );
            }
            assert!(
                energy.drive_work >= -allowed && energy.friction_loss >= -allowed,
                "{about}"
            );
        }
    }
    println!("{cycles} cycles, worst errors in units of those allowed: {worst:?}");
    assert!(cycles > 5 * of_each);
}

#[test]
fn trajectories_close_and_fit_their_kind() {
    let mut worst = [0.0_f64; 2];
    for (about, system) in systems(2, count(15, 60)) {
        for cycle in &find(&about, &system) {
            let about = format!(
                "{about}\n{:?} {} {}",
                cycle.kind(),
                cycle.amplitude(),
                cycle.multiplier()
            );
            let motion = cycle.trajectory();
            let size = size(&system, cycle);
            assert_eq!(
                (motion.duration(), motion.last()),
                (cycle.period(), cycle.state()),
                "{about}"
            );
            // From step to step, and from the end of the last to the start of the first. There the
            // error of the fixed point comes in, and it grows with the multiplier.
            let steps: Vec<_> = motion
                .steps()
                .iter()
                .filter(|step| step.duration() > 0.0)
                .collect();
            for (i, step) in steps.iter().enumerate() {
                let (end, next) = (
                    step.state_at(step.duration()),
                    steps[(i + 1) % steps.len()].state(),
                );
                let gap = (end.displacement - next.displacement)
                    .abs()
                    .max((end.velocity - next.velocity).abs());
                let last = usize::from(i + 1 == steps.len());
                let error = gap / (EPS * size * (1.0 + cycle.multiplier()));
                worst[last] = worst[last].max(error);
                assert!(
                    error <= 64.0,
                    "{about}: step {i} of {}: {error}",
                    steps.len()
                );
            }

            let (behind, ahead) = if system.belt_velocity() > 0.0 {
                (Direction::Lagging, Direction::Leading)
            } else {
                (Direction::Leading, Direction::Lagging)
            };
            let (release, overtake, fall) = (
                EventKind::Release(behind),
                EventKind::Crossing(ahead),
                EventKind::Crossing(behind),
            );
            let kinds: Vec<EventKind> = motion.events().iter().map(|event| event.kind).collect();
            match cycle.kind() {
                CycleKind::PureSlip => assert_eq!(kinds, [], "{about}"),
                CycleKind::StickSlip => assert_eq!(kinds, [EventKind::Stick, release], "{about}"),
                CycleKind::Overshoot => {
                    assert_eq!(kinds, [overtake, EventKind::Stick, release], "{about}");
                }
                CycleKind::Crossing => assert_eq!(kinds, [overtake, fall], "{about}"),
            }
            let times: Vec<f64> = motion.events().iter().map(|event| event.time).collect();
            assert!(
                times.is_sorted() && times.last().is_none_or(|&t| t == cycle.period()),
                "{about}"
            );
            let stick = match times[..] {
                [.., stick, release] if cycle.stick_duration() > 0.0 => release - stick,
                _ => 0.0,
            };
            let leading = match (cycle.kind(), &times[..]) {
                (CycleKind::Overshoot | CycleKind::Crossing, [start, end, ..]) => end - start,
                _ => 0.0,
            };
            for (actual, expected) in [
                (cycle.stick_duration(), stick),
                (cycle.leading_duration(), leading),
            ] {
                assert!(
                    (actual - expected).abs() <= 8.0 * EPS * cycle.period(),
                    "{about}"
                );
            }
            let sticks = matches!(cycle.kind(), CycleKind::StickSlip | CycleKind::Overshoot);
            assert_eq!(
                (cycle.multiplier() == 0.0, sticks),
                (sticks, cycle.stick_duration() > 0.0),
                "{about}"
            );
            assert_eq!(cycle.is_stable(), cycle.multiplier() < 1.0);

            let [mut u, mut v] = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
            for (_, state) in motion.sample(2001) {
                u = [u[0].min(state.displacement), u[1].max(state.displacement)];
                v = [v[0].min(state.velocity), v[1].max(state.velocity)];
            }
            let exact_u = [cycle.min_displacement(), cycle.max_displacement()];
            let exact_v = [cycle.min_velocity(), cycle.max_velocity()];
            for (sampled, exact) in [(u, exact_u), (v, exact_v)] {
                let slack = 8.0 * EPS * size;
                assert!(
                    exact[0] <= sampled[0] + slack && sampled[1] <= exact[1] + slack,
                    "{about}: {sampled:?} {exact:?}"
                );
                let missed = (sampled[0] - exact[0]).max(exact[1] - sampled[1]);
                // Extremes are flat, but v has corners at the belt.
                let span = exact[1] - exact[0];
                assert!(missed <= 2e-2 * span, "{about}: {sampled:?} {exact:?}");
            }
            assert_eq!(cycle.amplitude(), 0.5 * (exact_u[1] - exact_u[0]));
            if cycle.kind() == CycleKind::PureSlip {
                for step in steps {
                    assert_eq!(step.mode(), Mode::Slip(behind), "{about}");
                }
                let fastest = if system.belt_velocity() > 0.0 {
                    cycle.max_velocity()
                } else {
                    -cycle.min_velocity()
                };
                assert!(fastest < system.belt_velocity().abs(), "{about}");
            }
        }
    }
    println!("worst gap within, and at the end, in ε of the size: {worst:?}");
}

#[test]
fn harmonics_are_those_of_the_motion() {
    let mut worst = [0.0_f64; 3];
    for (about, system) in systems(3, count(3, 12)) {
        for cycle in &find(&about, &system) {
            let (period, mean, amplitude) =
                (cycle.period(), cycle.mean_displacement(), cycle.amplitude());
            let size = size(&system, cycle);
            // 24 in the time of a free oscillation: a slow cycle has its fast phases too.
            let n = (24.0 * period / TAU).clamp(24.0, 360.0) as usize;
            let harmonics = cycle.harmonics(n);
            assert_eq!(harmonics.len(), n);
            let own_mean = around(cycle, |_, state| state.displacement) / period;
            worst[0] = worst[0].max((mean - own_mean).abs() / size);
            for k in [1, 2, 5] {
                let wave = |t: f64| TAU * k as f64 * t / period;
                let re = around(cycle, |t, state| {
                    (state.displacement - mean) * wave(t).cos()
                }) * 2.0
                    / period;
                let im = around(cycle, |t, state| {
                    -(state.displacement - mean) * wave(t).sin()
                }) * 2.0
                    / period;
                let error = (harmonics[k - 1].re - re).hypot(harmonics[k - 1].im - im);
                worst[1] = worst[1].max(error / size);
                assert!(
                    error <= 1e-14 * size,
                    "{about}: harmonic {k} {} {re} {im} {error:e}",
                    harmonics[k - 1]
                );
            }
            assert!((mean - own_mean).abs() <= 1e-14 * size, "{about}");
            // Parseval; a corner in v leaves harmonics like k⁻³.
            let power = around(cycle, |_, state| (state.displacement - mean).powi(2)) / period;
            let sum: f64 = harmonics.iter().map(|c| 0.5 * c.norm_sqr()).sum();
            let smooth =
                cycle.kind() == CycleKind::PureSlip && system.law().breakpoints().next().is_none();
            let allowed = if smooth { 1e-13 } else { 1e-6 } * amplitude * amplitude
                + 1e-14 * amplitude * size;
            worst[2] = worst[2].max((power - sum).abs() / allowed);
            assert!(
                (power - sum).abs() <= allowed,
                "{about}: {power:e} {sum:e} {:e}",
                power - sum
            );
        }
    }
    println!(
        "worst: mean {:e}, harmonics {:e}, power {:e} of what is allowed",
        worst[0], worst[1], worst[2]
    );
}

#[test]
fn stick_slip_and_find_agree_and_mirror_images_are_exact() {
    for (about, system) in systems(4, count(15, 60)) {
        let cycles = find(&about, &system);
        let sticking: Vec<_> = cycles
            .iter()
            .filter(|cycle| cycle.stick_duration() > 0.0)
            .collect();
        let one = limit_cycle::stick_slip(&system).unwrap();
        assert_eq!(
            sticking,
            one.as_ref().into_iter().collect::<Vec<_>>(),
            "{about}"
        );
        let mirrored = find(
            &about,
            &system
                .clone()
                .with_belt_velocity(-system.belt_velocity())
                .unwrap(),
        );
        assert_eq!(mirrored.len(), cycles.len(), "{about}");
        assert_eq!(mirrored.unresolved(), cycles.unresolved(), "{about}");
        assert_eq!(mirrored.continuum(), cycles.continuum(), "{about}");
        for (a, b) in std::iter::zip(&cycles, &mirrored) {
            assert_mirrored(a, b, &about);
        }
    }
}

/// What vibrates with some damping vibrates with less of it, too: the field of velocities turns
/// outwards at every state.
#[test]
fn vibration_lasts_with_every_smaller_damping() {
    let mut vibrating = 0;
    for (about, system) in systems(5, count(6, 60)) {
        let moves = |damping: f64| {
            let cycles = find(&about, &system.clone().with_damping(damping).unwrap());
            !cycles.is_empty() || cycles.continuum().is_some() || !cycles.unresolved().is_empty()
        };
        let damping = system.damping();
        if moves(damping) {
            vibrating += 1;
            for part in [1.0 - 1e-6, 0.9, 0.5, 0.1, 1e-3, 0.0] {
                assert!(moves(part * damping), "{about}: {part}");
            }
        }
    }
    assert!(vibrating > 20, "{vibrating}");
}
