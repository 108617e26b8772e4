//! Stick-slip at many belt velocities for each of two laws, shallow sticks and shallow misses among
//! them, at tolerances from 1e-4 to round-off: every run must show the same events.

use crate::common::any::Any;
use crate::common::formula::Formula;
use crate::common::simple::{Seen, Simple, told};
use crate::common::{count, on_belt};
use stick_slip::{CycleKind, Integrator, MassOnBelt, State, limit_cycle};

const DURATION: f64 = 60.0;
const START: State = State::new(0.0, 0.0);
const DAMPING: f64 = 0.05;

/// Errors over a period, in tolerances: what `requested_tolerance_is_met` asserts of the
/// integrator.
const ERRORS_OF_A_PERIOD: f64 = 100.0;

/// Velocities inside a range, equidistant.
fn velocities(low: f64, high: f64) -> Vec<f64> {
    let n = count(60, 300);
    let velocity = |i| low + (high - low) * (i as f64 + 0.5) / n as f64;
    (0..n).map(velocity).collect()
}

fn system(law: &Any, belt_velocity: f64) -> MassOnBelt<&Any> {
    on_belt(law, belt_velocity, DAMPING, 1.0)
}

fn run(system: &MassOnBelt<&Any>, tolerance: f64) -> Vec<Seen> {
    let integrator = Integrator::new().with_tolerance(tolerance).unwrap();
    told(
        integrator
            .simulate(system, START, DURATION)
            .unwrap()
            .events(),
    )
}

/// Events up to just before the end: one beside it may lie on either side.
fn inside(seen: &[Seen], margin: f64) -> usize {
    seen.iter()
        .take_while(|event| event.0 < DURATION - margin)
        .count()
}

/// Asserts the same kinds of events, and times within what is allowed for each.
fn assert_same(about: &str, actual: &[Seen], expected: &[Seen], allowed: impl Fn(usize) -> f64) {
    let n = inside(expected, 0.1).max(inside(actual, 0.1));
    for i in 0..n {
        let (Some(a), Some(b)) = (actual.get(i), expected.get(i)) else {
            panic!("{about}: event {i} of {actual:?}\n{expected:?}");
        };
        assert_eq!(
            (a.1, a.2),
            (b.1, b.2),
            "{about}: event {i} of {actual:?}\n{expected:?}"
        );
        let (difference, allowed) = ((a.0 - b.0).abs(), allowed(i));
        assert!(
            difference <= allowed,
            "{about}: event {i}: {difference:e} > {allowed:e}"
        );
    }
}

/// The run to round-off against the exact cycle, and against Runge-Kutta steps.
fn validate(about: &str, system: &MassOnBelt<&Any>, truth: &[Seen], formula: &Formula) {
    // From the release point on the motion is the periodic one, if there is one.
    let releases = truth.iter().position(|event| event.1 == 'r');
    let after = &truth[releases.unwrap_or(truth.len())..];
    match limit_cycle::stick_slip(system).unwrap() {
        Some(cycle) if releases.is_some() => {
            assert_eq!(cycle.kind(), CycleKind::StickSlip, "{about}");
            for (i, event) in after.iter().enumerate() {
                let slipped = if i % 2 == 0 {
                    0.0
                } else {
                    cycle.period() - cycle.stick_duration()
                };
                let time = after[0].0 + (i / 2) as f64 * cycle.period() + slipped;
                assert_eq!(event.1, if i % 2 == 0 { 'r' } else { 's' }, "{about}");
                // Near grazing the time of contact moves by some ε/|v_r'|, and v_r' is v_b times
                // the duration of the stick that follows.
                let rate = system.belt_velocity() * cycle.stick_duration().min(1.0);
                let allowed = 1e-13 + 16.0 * f64::EPSILON * (1 + i) as f64 / rate;
                assert!(
                    (event.0 - time).abs() <= allowed,
                    "{about}: {} {time}",
                    event.0
                );
            }
            let expected = after[0].0 + after.len() as f64 / 2.0 * cycle.period();
            assert!(
                expected > DURATION - cycle.period(),
                "{about}: events are missing"
            );
        }
        _ => assert!(after.len() <= 1, "{about}: {truth:?}"),
    }

    let simple = Simple::new(formula, system.belt_velocity(), DAMPING, 1.0);
    let [coarse, fine] = [8e-3, 4e-3].map(|h| simple.run([0.0, 0.0], DURATION, |_| h).0);
    assert_same(about, truth, &fine, |i| {
        2.0 * coarse
            .get(i)
            .map_or(0.0, |event| (event.0 - fine[i].0).abs())
            + 1e-9
    });
}

/// Runs one law at all velocities and tolerances.
fn sweep(formula: &Formula, velocities: Vec<f64>) {
    let law = &formula.law();
    let mut shallow = 0;
    let mut worst = [0.0_f64; 3];
    let mut undecided = [0; 3];
    for v_b in velocities {
        let (about, system) = (format!("{law:?} at v_b = {v_b}"), system(law, v_b));
        let truth = run(&system, Integrator::MIN_TOLERANCE);
        validate(&about, &system, &truth, formula);
        let sticks = truth.windows(2).filter(|pair| pair[0].1 == 's');
        shallow += usize::from(sticks.skip(1).any(|pair| pair[1].0 - pair[0].0 < 0.45));
        for (k, tolerance) in [1e-4, 1e-6, 1e-9].into_iter().enumerate() {
            let about = format!("{about}, tolerance {tolerance:e}");
            let actual = run(&system, tolerance);
            // Each step may err by the tolerance. An event moves at most so far as if each datum
            // were wrong by the errors of a period.
            let moved = ERRORS_OF_A_PERIOD * tolerance;
            let others: Vec<_> = [1.0 - moved, 1.0 + moved]
                .into_iter()
                .flat_map(|factor| {
                    [
                        system.with_belt_velocity(factor * v_b),
                        system.with_load(factor),
                        system.with_damping(factor * DAMPING),
                    ]
                })
                .map(|other| run(&other.unwrap(), Integrator::MIN_TOLERANCE))
                .collect();
            let allowed = |i: usize| {
                let moves = others.iter().map(|other| match other.get(i) {
                    Some(other) if other.1 == truth[i].1 => (other.0 - truth[i].0).abs(),
                    // The data within the tolerance do not say what comes, but the run must.
                    _ => f64::INFINITY,
                });
                moves.sum::<f64>() + 1e-13
            };
            assert_same(&about, &actual, &truth, allowed);
            let n = inside(&truth, 0.1).min(inside(&actual, 0.1));
            for i in 0..n {
                worst[k] = worst[k].max((actual[i].0 - truth[i].0).abs() / allowed(i));
            }
            undecided[k] += usize::from((0..n).any(|i| allowed(i).is_infinite()));
        }
    }
    println!("{shallow} with shallow sticks, {undecided:?} undecided, {worst:?}");
    assert!(60 * shallow > count(60, 300));
}

#[test]
fn polynomial_law() {
    sweep(
        &Formula::Polynomial([0.4, 0.25, 0.5]),
        velocities(0.0, 0.44),
    );
}

#[test]
fn exponential_law() {
    sweep(
        &Formula::Exponential([0.4, 0.25, 0.3]),
        velocities(0.01, 0.4),
    );
}
