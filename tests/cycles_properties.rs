//! Limit cycles of random systems with random laws: identities that hold on every cycle, and return maps simulated by the tests' own code,
//! so that lost, invented and misjudged cycles show.

mod common;

use std::f64::consts::TAU;

use common::Random;
use common::any::Any;
use common::orbit::{Turn, at_peak, integrate, next_crossing, next_peak, settles};
use stick_slip::limit_cycle::{self, Attractor, attractor};
use stick_slip::{
    CycleKind, CycleSet, Direction, EventKind, FrictionLaw, LimitCycle, MassOnBelt, Mode, State,
};

const EPS: f64 = f64::EPSILON;

/// Random systems, so many of each law.
fn systems(seed: u64, of_each: usize) -> impl Iterator<Item = (String, MassOnBelt<Any>)> {
    let mut random = Random::new(seed);
    (0..of_each * Random::KINDS).map(move |i| {
        let system = random.any_system(i % Random::KINDS);
        (format!("system {i}: {system:?}"), system)
    })
}

fn find<L: FrictionLaw>(about: &str, system: &MassOnBelt<L>) -> CycleSet {
    limit_cycle::find(system).unwrap_or_else(|error| panic!("{about}: {error}"))
}

/// The largest of |u|, |v| and |v_b| on a cycle.
fn size<L: FrictionLaw>(system: &MassOnBelt<L>, cycle: &LimitCycle) -> f64 {
    [
        cycle.max_displacement(),
        cycle.min_displacement(),
        cycle.max_velocity(),
        cycle.min_velocity(),
        system.belt_velocity(),
    ]
    .into_iter()
    .fold(0.0, |largest, x: f64| largest.max(x.abs()))
}

/// ∮ over a cycle, by the tests' own quadrature.
fn around(cycle: &LimitCycle, mut integrand: impl FnMut(f64, State) -> f64) -> f64 {
    cycle
        .trajectory()
        .steps()
        .iter()
        .map(|step| {
            integrate(step.duration(), |t| {
                integrand(step.start_time() + t, step.state_at(t))
            })
        })
        .sum()
}

#[test]
fn energy_balances() {
    let mut worst = [0.0_f64; 3];
    let mut cycles = 0;
    for (about, system) in systems(1, 60) {
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
    assert!(cycles > 300);
}

#[test]
fn trajectories_close_and_fit_their_kind() {
    let mut worst = [0.0_f64; 2];
    for (about, system) in systems(2, 60) {
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
            // From step to step, and from the end of the last to the start of the first. There the error of the fixed point comes in, and it grows
            // with the multiplier.
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
                    assert_eq!(kinds, [overtake, EventKind::Stick, release], "{about}")
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
            assert!(motion.sample(101).all(|(t, s)| {
                cycle.kind() != CycleKind::PureSlip
                    || motion.mode_at(t) == Some(Mode::Slip(behind))
                        && (s.velocity / system.belt_velocity()) < 1.0
            }));
        }
    }
    println!("worst gap within, and at the end, in ε of the size: {worst:?}");
}

#[test]
fn harmonics_are_those_of_the_motion() {
    let mut worst = [0.0_f64; 3];
    for (about, system) in systems(3, 12) {
        for cycle in &find(&about, &system) {
            let (period, mean, amplitude) =
                (cycle.period(), cycle.mean_displacement(), cycle.amplitude());
            let size = size(&system, cycle);
            let harmonics = cycle.harmonics(40);
            assert_eq!(harmonics.len(), 40);
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
    for (about, system) in systems(4, 60) {
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
            let of = |cycle: &LimitCycle| {
                (
                    cycle.kind(),
                    cycle.period(),
                    cycle.multiplier(),
                    cycle.amplitude(),
                    cycle.energy(),
                )
            };
            assert_eq!(of(a), of(b), "{about}");
            assert_eq!(a.max_displacement(), -b.min_displacement(), "{about}");
            assert_eq!(a.min_velocity(), -b.max_velocity(), "{about}");
            assert_eq!(a.mean_displacement(), -b.mean_displacement(), "{about}");
            assert_eq!(a.leading_duration(), b.leading_duration(), "{about}");
            for (s, t) in std::iter::zip(a.trajectory().sample(20), b.trajectory().sample(20)) {
                let (s, t) = (
                    (s.0, s.1.displacement, s.1.velocity),
                    (t.0, -t.1.displacement, -t.1.velocity),
                );
                assert_eq!(s, t, "{about}");
            }
        }
    }
}

/// Whether a cycle just outside those, and inside the release point's motion, would be met by a growing motion.
fn grows_at_the_belt<L: FrictionLaw>(system: &MassOnBelt<L>) -> Option<bool> {
    match next_peak(system, system.belt_velocity() * (1.0 - 1e-9)) {
        Turn::Belt => Some(true),
        Turn::Returns(peak) if (peak / system.belt_velocity() - 1.0).abs() < 1e-7 => None,
        Turn::Returns(_) | Turn::Ends => Some(false),
    }
}

#[test]
fn cycles_are_nested_and_their_stability_alternates() {
    for (about, system) in systems(5, 60) {
        let system = system
            .clone()
            .with_belt_velocity(system.belt_velocity().abs())
            .unwrap();
        let set = find(&about, &system);
        assert_eq!(set.unresolved(), [], "{about}");
        let cycles: Vec<_> = set.iter().collect();
        let about = format!(
            "{about}\n{:?}",
            cycles
                .iter()
                .map(|c| (c.kind(), c.amplitude(), c.multiplier()))
                .collect::<Vec<_>>()
        );
        for pair in cycles.windows(2) {
            let (inner, outer) = (pair[0], pair[1]);
            assert!(inner.amplitude() < outer.amplitude(), "{about}");
            assert!(
                inner.max_displacement() < outer.max_displacement(),
                "{about}"
            );
            assert!(
                inner.min_displacement() > outer.min_displacement(),
                "{about}"
            );
            assert!(inner.min_velocity() > outer.min_velocity(), "{about}");
            assert!(inner.max_velocity() <= outer.max_velocity(), "{about}");
        }
        assert_eq!(set.len(), cycles.len());
        assert_eq!(
            set.stable().count(),
            cycles.iter().filter(|c| c.is_stable()).count()
        );
        if set.continuum().is_some() {
            assert!(
                cycles
                    .iter()
                    .all(|cycle| cycle.kind() != CycleKind::PureSlip),
                "{about}"
            );
            continue;
        }
        // Behind the belt: equilibrium, then pure slip, up to the motion that grazes the belt.
        let (inside, outside): (Vec<&LimitCycle>, Vec<&LimitCycle>) = cycles
            .iter()
            .partition(|cycle| cycle.kind() == CycleKind::PureSlip);
        let mut attracts = system.equilibrium().unwrap().is_stable();
        for cycle in &inside {
            assert_eq!(cycle.is_stable(), !attracts, "{about}");
            attracts = !attracts;
        }
        if let Some(grows) = grows_at_the_belt(&system) {
            assert_eq!(grows, !attracts, "{about}: the outermost pure slip");
        }
        // At the belt and beyond: the motion from the release point, then crossings, and all from far away comes in.
        let sticks = outside
            .first()
            .is_some_and(|cycle| cycle.stick_duration() > 0.0);
        let release = system.release_state().unwrap();
        let touches = system.law().static_coefficient() - system.law().kinetic(0.0) <= EPS;
        if touches && sticks {
            assert!(!attracts, "{about}: sticks");
        }
        let outward = outside
            .first()
            .is_some_and(|cycle| !sticks && cycle.is_stable());
        let mut repels = outward;
        for cycle in &outside[usize::from(sticks)..] {
            assert_eq!(cycle.is_stable(), repels, "{about}: crossing");
            repels = !repels;
        }
        assert!(!repels, "{about}: the outermost");
        let first = next_crossing(&system, release.displacement * (1.0 + 1e-12) + 1e-12);
        if let (true, Turn::Returns(next)) = (outward, first) {
            assert!(next > release.displacement, "{about}");
        }
    }
}

/// The return maps, simulated point by point, change sign once between every two cycles found, and nowhere else.
#[test]
fn no_cycle_is_lost_or_invented() {
    let mut changes = [0; 2];
    for (about, system) in systems(6, 30) {
        let system = system
            .clone()
            .with_belt_velocity(system.belt_velocity().abs())
            .unwrap();
        let v_b = system.belt_velocity();
        let set = find(&about, &system);
        if set.continuum().is_some() {
            continue;
        }
        let about = format!(
            "{about}\n{:?}",
            set.iter()
                .map(|c| (c.kind(), c.state(), c.multiplier()))
                .collect::<Vec<_>>()
        );
        let of_kind = |kind| set.iter().filter(move |cycle| cycle.kind() == kind);
        let peaks: Vec<f64> = of_kind(CycleKind::PureSlip)
            .map(LimitCycle::max_velocity)
            .collect();
        let scan = |points: &[f64], found: &[f64], grows: &dyn Fn(f64) -> Option<bool>| {
            let signs: Vec<_> = points
                .iter()
                .filter_map(|&x| grows(x).map(|sign| (x, sign)))
                .collect();
            let mut count = 0;
            for pair in signs.windows(2) {
                let [(a, at_a), (b, at_b)] = [pair[0], pair[1]];
                let between = found.iter().filter(|&&root| a < root && root <= b).count();
                count += usize::from(at_a != at_b);
                assert_eq!(
                    between % 2 == 1,
                    at_a != at_b,
                    "{about}: {between} between {a:e} and {b:e}"
                );
            }
            count
        };
        let points: Vec<f64> = (1..=150).map(|i| v_b * f64::from(i) / 150.5).collect();
        changes[0] += scan(&points, &peaks, &|peak| match next_peak(&system, peak) {
            Turn::Belt => Some(true),
            Turn::Ends => Some(false),
            Turn::Returns(next) => ((next / peak - 1.0).abs() > 1e-11).then_some(next > peak),
        });
        let crossings: Vec<f64> = of_kind(CycleKind::Crossing)
            .map(|cycle| cycle.state().displacement)
            .collect();
        let release = system.release_state().unwrap().displacement;
        let unit = v_b + system.load() * system.law().static_coefficient();
        let points: Vec<f64> = (0..=100)
            .map(|i| release + unit * ((f64::from(i) / 20.0).exp() - 1.0 + 1e-9))
            .collect();
        changes[1] += scan(&points, &crossings, &|u| match next_crossing(&system, u) {
            Turn::Returns(next) => ((next - u).abs() > 1e-11 * unit).then_some(next > u),
            _ => Some(false),
        });
    }
    println!("changes of sign: {changes:?}");
    assert!(changes.iter().all(|&count| count > 20));
}

#[test]
fn multipliers_are_the_contraction_of_simulated_turns() {
    let mut worst = 0.0_f64;
    let mut measured = 0;
    for (about, system) in systems(7, 60) {
        let system = system
            .clone()
            .with_belt_velocity(system.belt_velocity().abs())
            .unwrap();
        for cycle in &find(&about, &system) {
            let (x, map): (f64, &dyn Fn(f64) -> Turn) = match cycle.kind() {
                CycleKind::PureSlip => (cycle.max_velocity(), &|peak| next_peak(&system, peak)),
                CycleKind::Crossing => (cycle.state().displacement, &|u| next_crossing(&system, u)),
                _ => continue,
            };
            let slope = |h: f64| match (map(x + h), map(x - h)) {
                (Turn::Returns(after), Turn::Returns(before)) => Some((after - before) / (2.0 * h)),
                _ => None,
            };
            // Richardson's extrapolation; where the three slopes show no order, the map has a kink or an end near by.
            let h = 2e-4 * x.abs();
            let (Some(a), Some(b), Some(c)) = (slope(h), slope(0.5 * h), slope(0.25 * h)) else {
                continue;
            };
            let [wide, narrow] = [(4.0 * b - a) / 3.0, (4.0 * c - b) / 3.0];
            let m = cycle.multiplier();
            let allowed = 10.0 * (wide - narrow).abs() + 1e-9 * (1.0 + m);
            if (wide - narrow).abs() < 1e-6 * (1.0 + m) {
                measured += 1;
                worst = worst.max((narrow - m).abs() / (1.0 + m));
                assert!(
                    (narrow - m).abs() <= allowed,
                    "{about}: {:?} {m} {narrow}",
                    cycle.kind()
                );
            }
        }
    }
    println!("{measured} multipliers, worst relative error {worst:e}");
    assert!(measured > 100);
}

#[test]
fn motions_stay_near_stable_cycles_and_end_on_the_attractor_named() {
    let mut random = Random::new(80);
    let mut reached = [0; 2];
    for (about, system) in systems(8, 12) {
        let set = find(&about, &system);
        let equilibrium = system.equilibrium().unwrap();
        let h1 = -equilibrium.jacobian[(1, 1)];
        // Turns until a factor of 10⁻⁹ is left near the slowest attractor.
        let slowest = set
            .iter()
            .map(|cycle| cycle.multiplier().ln().abs())
            .fold(3.0 * h1.abs(), f64::min);
        let turns = 20.0 / slowest;
        if set.continuum().is_some() || turns > 600.0 {
            continue;
        }
        let longest = set.iter().map(LimitCycle::period).fold(TAU, f64::max);
        let (duration, window) = (2.0 * (turns + 3.0) * longest, 1.5 * longest);
        for cycle in set.stable() {
            let exact = [cycle.min_displacement(), cycle.max_displacement()];
            let state = cycle.state();
            let near = State::new(
                state.displacement + 1e-7 * cycle.amplitude(),
                state.velocity,
            );
            let end = settles(&system, near, duration, window);
            let error = (end[0] - exact[0]).abs().max((end[1] - exact[1]).abs());
            assert!(
                error < 2e-3 * cycle.amplitude(),
                "{about}: {:?} {exact:?} {end:?}",
                cycle.kind()
            );
        }
        let scale =
            system.belt_velocity().abs() + system.load() * system.law().static_coefficient();
        let mut starts: Vec<State> = (0..6)
            .map(|_| {
                let far = random.logarithmic(0.05, 4.0) * scale;
                State::new(
                    equilibrium.displacement + far * random.uniform(-1.0, 1.0),
                    far * random.uniform(-1.0, 1.0),
                )
            })
            .collect();
        // On both sides of an unstable cycle.
        for cycle in set.iter().filter(|cycle| !cycle.is_stable()) {
            for side in [-1e-5, 1e-5] {
                let state = cycle.state();
                starts.push(match cycle.kind() {
                    CycleKind::PureSlip if state.velocity > 0.0 => {
                        at_peak(&system, state.velocity * (1.0 + side))
                    }
                    CycleKind::PureSlip => continue,
                    _ => State::new(state.displacement * (1.0 + side), state.velocity),
                });
            }
        }
        for start in starts {
            let expected = match attractor(&system, start).unwrap() {
                Attractor::Equilibrium => [equilibrium.displacement; 2],
                Attractor::Cycle(cycle) => {
                    assert!(
                        cycle.is_stable() && set.iter().any(|one| *one == cycle),
                        "{about}"
                    );
                    [cycle.min_displacement(), cycle.max_displacement()]
                }
                other => panic!("{about}: {start:?} {other:?}"),
            };
            reached[usize::from(expected[0] != expected[1])] += 1;
            let end = settles(&system, start, duration, window);
            let error = (end[0] - expected[0])
                .abs()
                .max((end[1] - expected[1]).abs());
            assert!(
                error < 2e-3 * scale.min(system.belt_velocity().abs()),
                "{about}: {start:?} {expected:?} {end:?}"
            );
        }
    }
    println!(
        "{} starts ended at equilibria, {} on cycles",
        reached[0], reached[1]
    );
    assert!(reached.iter().all(|&count| count > 50));
}
