//! Limit cycles of random systems with random laws against return maps that the tests simulate on
//! their own, so that lost, invented and misjudged cycles show.

use std::f64::consts::TAU;

use crate::common::any::systems;
use crate::common::orbit::{Turn, at_peak, find, next_crossing, next_peak, settles};
use crate::common::{Random, count, larger};
use stick_slip::limit_cycle::{Attractor, attractor};
use stick_slip::{CycleKind, FrictionLaw, LimitCycle, MassOnBelt, State};

const EPS: f64 = f64::EPSILON;

/// Whether a cycle just outside those, and inside the release point's motion, would be met by a
/// growing motion.
fn grows_at_the_belt<L: FrictionLaw>(system: &MassOnBelt<L>) -> Option<bool> {
    match next_peak(system, system.belt_velocity() * (1.0 - 1e-9)) {
        Turn::Belt => Some(true),
        Turn::Returns(peak) if (peak / system.belt_velocity() - 1.0).abs() < 1e-7 => None,
        Turn::Returns(_) | Turn::Ends => Some(false),
    }
}

#[test]
fn cycles_are_nested_and_their_stability_alternates() {
    let mut checked = 0;
    let of_each = count(10, 60);
    for (about, system) in systems(5, of_each) {
        let system = system
            .clone()
            .with_belt_velocity(system.belt_velocity().abs())
            .unwrap();
        let set = find(&about, &system);
        if !set.unresolved().is_empty() {
            continue;
        }
        checked += 1;
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
        // At the belt and beyond: the motion from the release point, then crossings, and all from
        // far away comes in.
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
    assert!(60 * checked > 640 * of_each, "{checked}");
}

/// The return maps, simulated point by point, change sign once between every two cycles found, and
/// nowhere else.
#[test]
fn no_cycle_is_lost_or_invented() {
    let mut changes = [0; 2];
    let of_each = count(6, 60);
    for (about, system) in systems(6, of_each) {
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
        // What can't be resolved is one cycle for the scan, an unstable one.
        let peaks: Vec<f64> = of_kind(CycleKind::PureSlip)
            .map(LimitCycle::max_velocity)
            .chain(set.unresolved().iter().map(|range| range.end))
            .filter(|&peak| peak < v_b)
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
    assert!(changes.iter().all(|&count| 5 * count > of_each));
}

#[test]
fn multipliers_are_the_contraction_of_simulated_turns() {
    let mut worst = 0.0_f64;
    let mut measured = 0;
    let of_each = count(20, 120);
    for (about, system) in systems(7, of_each) {
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
            // Richardson's extrapolation; where the three slopes show no order, the map has a kink
            // or an end near by.
            let h = 2e-4 * x.abs();
            let (Some(a), Some(b), Some(c)) = (slope(h), slope(0.5 * h), slope(0.25 * h)) else {
                continue;
            };
            let [wide, narrow] = [(4.0 * b - a) / 3.0, (4.0 * c - b) / 3.0];
            let m = cycle.multiplier();
            let allowed = 10.0 * (wide - narrow).abs() + 1e-9 * (1.0 + m);
            if (wide - narrow).abs() < 1e-6 * (1.0 + m) {
                measured += 1;
                worst = larger(worst, (narrow - m).abs() / (1.0 + m));
                assert!(
                    (narrow - m).abs() <= allowed,
                    "{about}: {:?} {m} {narrow}",
                    cycle.kind()
                );
            }
        }
    }
    println!("{measured} multipliers, worst relative error {worst:e}");
    assert!(6 * measured > 5 * of_each);
}

#[test]
fn motions_stay_near_stable_cycles_and_end_on_the_attractor_named() {
    let mut random = Random::new(80);
    let mut reached = [0; 2];
    let of_each = count(3, 12);
    for (about, system) in systems(8, of_each) {
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
    assert!(reached.iter().all(|&count| count > 4 * of_each));
}
