//! Expansions for weak friction and damping, (γ², β) → (εγ², εβ), and the orders of their errors.

use std::f64::consts::TAU;

use proptest::prelude::*;
use stick_slip::analysis::{PureSlip, averaging};
use stick_slip::{CycleKind, EventKind, FrictionLaw, MassOnBelt, State, limit_cycle};

use super::{Bounds, Verdict, any_law, check, check_some, decades, or_zero, sign};
use crate::common::count;
use crate::orders::points::{Parameters, Point, at, system};
use crate::orders::tables::{
    AVERAGED_CROSSING, Errors, Series, averaged_rows, pure_slip_rows, stick_slip_rows,
};

/// Sizes ε, each `step` times smaller than the one before, the last by so many steps.
fn sizes(step: f64, last: i32) -> [f64; 4] {
    [0, 1, 2, 2 + last].map(|k| step.powi(-k))
}

/// The system at these ε, if its motion is of that kind at each.
fn along(parameters: &Parameters, sizes: &[f64], kind: CycleKind) -> Option<[Vec<Point>; 1]> {
    let points = sizes.iter().map(|&epsilon| at(*parameters, epsilon, kind));
    points.collect::<Option<_>>().map(|points| [points])
}

/// What takes the rows of a table.
fn judge<'a>(
    bounds: &'a Bounds,
    sizes: &'a [f64],
    verdict: &'a mut Verdict,
) -> impl FnMut(&str, f64, Series, &Errors) + 'a {
    move |name, p, series, errors| {
        let node = match series {
            Series::Whole => |x: f64| x,
            Series::Halves => f64::sqrt,
        };
        if verdict.is_ok() {
            *verdict = bounds.order(name, p, node, sizes, &errors[0]);
        }
    }
}

/// A polynomial law, η at ε = 1, and (v_b/v_b1)²: what γ², β and v_b follow from.
fn parameters(
    eta: impl Strategy<Value = f64>,
    squares: std::ops::Range<f64>,
) -> impl Strategy<Value = Parameters> {
    let law = (decades(0.1, 2.0), 0.0..0.95, decades(0.2, 2.0));
    (law, eta, 0.3..1.0, squares).prop_map(|((mu_s, mu_m, v_m), eta, excess, square)| {
        let mu_m = mu_m * mu_s;
        let load = eta * v_m / (1.5 * (mu_s - mu_m));
        let v_b = v_m * f64::sqrt(excess * square);
        [mu_s, mu_m, v_m, load, 0.5 * eta * (1.0 - excess), v_b]
    })
}

#[test]
fn pure_slip() {
    check(
        (parameters(0.05..0.8, 0.86..0.99), 1..6_i32),
        |(parameters, last), bounds| {
            let sizes = sizes(2.0, last);
            let points = along(&parameters, &sizes, CycleKind::PureSlip);
            prop_assert!(points.is_some(), "no pure slip");
            let mut verdict = Ok(());
            pure_slip_rows(&points.unwrap(), judge(bounds, &sizes, &mut verdict));
            verdict
        },
    );
}

#[test]
fn slow_transient() {
    let cases = (
        parameters(0.05..0.4, 0.86..0.99),
        0.1..0.9,
        0.0..TAU,
        1..4_i32,
        1..6_i32,
    );
    check(cases, |(parameters, part, phase, turns, last), bounds| {
        let sizes = sizes(2.0, last);
        let error = |&epsilon: &f64| {
            let system = system(parameters, epsilon);
            let formulas = PureSlip::new(&system).unwrap();
            let amplitude = part * formulas.amplitude().unwrap();
            let transient = formulas.transient(amplitude, phase).unwrap();
            let time = TAU * f64::from(turns) / epsilon;
            let exact = system
                .simulate(transient.state(0.0).unwrap(), time)
                .unwrap()
                .last();
            let State {
                displacement,
                velocity,
            } = transient.state(time).unwrap();
            let error = (displacement - exact.displacement).hypot(velocity - exact.velocity);
            (
                error,
                f64::EPSILON * (1.0 + exact.displacement.abs()) / epsilon,
            )
        };
        let errors: Vec<_> = sizes.iter().map(error).collect();
        bounds.order("transient", 1.0, |x| x, &sizes, &errors)
    });
}

#[test]
fn stick_slip() {
    check(
        (parameters(0.02..0.3, 0.02..0.5), 1..5_i32),
        |(parameters, last), bounds| {
            let sizes = sizes(4.0, last);
            // Without a change of the motion μ is raised, so that the mass sticks where it meets
            // the belt, and so that μ is positive where `growth` continues the law beyond it.
            let [mu_s, mu_m, v_m, load, damping, v_b] = parameters;
            let raise = 100.0 * mu_s + v_b / (load * sizes[3].sqrt());
            let parameters = [mu_s + raise, mu_m + raise, v_m, load, damping, v_b];
            let points = along(&parameters, &sizes, CycleKind::StickSlip);
            prop_assert!(points.is_some(), "no stick-slip");
            let mut verdict = Ok(());
            stick_slip_rows(&points.unwrap(), judge(bounds, &sizes, &mut verdict));
            verdict
        },
    );
}

#[test]
fn averaged_crossing_cycles() {
    let law = (0.1..0.6, 0.0..0.2, 0.3..1.2);
    let cases = (law, 0.5..0.75, 0.0..1.0, 1..6_i32);
    // Fewer: all cycles of four systems are searched.
    check_some(
        count(24, 96),
        cases,
        |((mu_s, mu_m, v_m), ratio, damping, last), bounds| {
            let (mu_m, v_b) = (mu_m * mu_s, ratio * v_m);
            let damping = damping * 0.1 * (mu_s - mu_m) / v_m;
            // Half the load at which, by averaging, the motion begins to stick: A sin s = 2γ²μ_s.
            let one =
                averaging::cycles(&system([mu_s, mu_m, v_m, 1.0, damping, v_b], 1.0)).unwrap();
            let turned = (0.5 * one[0].leading_duration()).sin();
            let load = one[0].amplitude() * turned / (4.0 * mu_s);
            let sizes = sizes(2.0, last);
            let parameters = [mu_s, mu_m, v_m, load, load * damping, v_b];
            let points = along(&parameters, &sizes, CycleKind::Crossing);
            prop_assert!(points.is_some(), "no crossing");
            let (table, mut verdict) = (AVERAGED_CROSSING, Ok(()));
            averaged_rows(&points.unwrap(), table, judge(bounds, &sizes, &mut verdict));
            verdict
        },
    );
}

/// Smallest relative distance of an amplitude from those at which the motion touches the belt or a
/// breakpoint. Near them an expansion in whole powers of ε ends.
fn distance<L: FrictionLaw>(of: &MassOnBelt<L>, amplitude: f64) -> f64 {
    let w = of.belt_velocity().abs();
    let kinks = of.law().breakpoints().flat_map(|b| [(w - b).abs(), w + b]);
    let all = kinks
        .chain([w])
        .map(|touching| (touching / amplitude - 1.0).abs());
    all.fold(f64::INFINITY, f64::min)
}

/// In a turn the amplitude changes by 2π dA/dτ, with an error O(ε²) in its mean rate, whatever the
/// law, whether the motion overtakes the belt or not; O(ε^{3/2}) where it just reaches the belt.
/// The error of the slope is O(ε²).
#[test]
fn averaged_drift() {
    let sizes_of = (or_zero((0.0..0.02).boxed()), 0.01..0.04);
    let cases = (
        any_law(),
        decades(0.05, 2.0),
        sign(),
        prop_oneof![2 => Just(1.0), 3 => 0.05..2.5],
        sign(),
        sizes_of,
        1..6_i32,
    );
    check(
        cases,
        |(law, w, sign, ratio, side, (damping, force), last), bounds| {
            let amplitude = ratio * w;
            let load = force * f64::min(amplitude, w).min(0.1) / law.static_coefficient();
            let full = super::system(law, sign * w, damping, load);
            let touches = ratio == 1.0;
            prop_assume!(touches || distance(&full, amplitude) > 0.1);
            let sizes = sizes(2.0, last);
            let mut errors: [Vec<(f64, f64)>; 2] = Default::default();
            for epsilon in sizes {
                let system = full.clone().with_damping(epsilon * damping).unwrap();
                let system = system.with_load(epsilon * load).unwrap();
                let rest = system.equilibrium().unwrap().displacement;
                let rate = |amplitude: f64| {
                    let start = State::new(rest + side * amplitude, 0.0);
                    let motion = system.simulate(start, TAU).unwrap();
                    let crosses = |kind| matches!(kind, EventKind::Crossing(_));
                    if !motion.events().iter().all(|event| crosses(event.kind)) {
                        return None;
                    }
                    let end = motion.last();
                    let distance = (end.displacement - rest).hypot(end.velocity);
                    Some((distance - amplitude) / TAU)
                };
                let found = rate(amplitude);
                // Where the mass just reaches the belt it may stick.
                prop_assert!(found.is_some() || touches);
                prop_assume!(found.is_some());
                let noise = f64::EPSILON * (w + amplitude);
                let drift = averaging::drift(&system, amplitude).unwrap();
                errors[0].push((found.unwrap() - drift, noise));
                if touches {
                    continue;
                }
                // By differences, with an error of fourth order.
                let h = 1e-3 * amplitude;
                let across = |h: f64| rate(amplitude + h).unwrap() - rate(amplitude - h).unwrap();
                let slope = (8.0 * across(h) - across(2.0 * h)) / (12.0 * h);
                let expected = averaging::drift_slope(&system, amplitude).unwrap();
                errors[1].push((slope - expected, noise / h));
            }
            let [drift, slope] = errors;
            if touches {
                return bounds.order("drift that touches", 1.5, f64::sqrt, &sizes, &drift);
            }
            bounds.order("drift", 2.0, |x| x, &sizes, &drift)?;
            bounds.order("slope", 2.0, |x| x, &sizes, &slope)
        },
    );
}

/// Of each cycle of the slow flow that does not stick there is an exact one, with errors of the
/// orders that are stated.
#[test]
fn averaged_cycles() {
    let cases = (any_law(), 0.1..1.5, sign(), (0.0..1.0, 0.02..0.2), 1..4_i32);
    check_some(
        count(5, 32),
        cases,
        |(law, w, sign, (part, load), last), bounds| {
            let bare = super::system(law, sign * w, 0.0, load * w);
            let needed = stick_slip::analysis::design::stabilizing_damping(&bare).unwrap();
            let damping = part * needed;
            let full = bare.with_damping(damping).unwrap();
            let averaged = averaging::cycles(&full).unwrap();
            let expanded = averaged
                .iter()
                .find(|cycle| cycle.is_valid() && distance(&full, cycle.amplitude()) > 0.05);
            prop_assume!(expanded.is_some());
            let expanded = expanded.unwrap();
            let sizes = sizes(2.0, last);
            let mut rows: [Vec<(f64, f64)>; 3] = Default::default();
            for epsilon in sizes {
                let system = full.clone().with_damping(epsilon * damping).unwrap();
                let system = system.with_load(epsilon * load * w).unwrap();
                let found = limit_cycle::find(&system).unwrap();
                let beside = |a: f64| (a - expanded.amplitude()).abs();
                let nearest = found
                    .iter()
                    .filter(|cycle| cycle.stick_duration() == 0.0)
                    .filter(|cycle| cycle.is_stable() == expanded.is_stable())
                    .min_by(|a, b| beside(a.amplitude()).total_cmp(&beside(b.amplitude())));
                prop_assume!(nearest.is_some());
                let exact = nearest.unwrap();
                let noise = 8.0 * f64::EPSILON / (1.0 - exact.multiplier()).abs();
                let rate = exact.multiplier().ln() / exact.period();
                let slope = epsilon * expanded.drift_slope();
                rows[0].push((exact.amplitude() / expanded.amplitude() - 1.0, noise));
                rows[1].push((exact.period() - TAU, noise));
                rows[2].push((rate - slope, noise));
            }
            for ((name, p), errors) in [("A", 2.0), ("T", 2.0), ("dA'/dA", 3.0)].iter().zip(&rows) {
                bounds.order(name, *p, |x| x, &sizes, errors)?;
            }
            Ok(())
        },
    );
}
