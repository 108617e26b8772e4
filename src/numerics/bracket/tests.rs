//! Roots of functions that are known in closed form, and how often they are asked.

use super::*;

/// The root between a and b, and the number of evaluations.
fn between(f: impl Fn(f64) -> Option<f64>, a: f64, b: f64) -> (Option<SignChange>, usize) {
    let mut evaluations = 0;
    let mut counted = |x| {
        evaluations += 1;
        assert!(a < x && x < b, "{x}");
        Ok(f(x))
    };
    let ends = [a, b].map(|end| (end, f(end).unwrap()));
    let root = sign_change_between(&mut counted, ends[0], ends[1]).unwrap();
    (root, evaluations)
}

#[test]
fn a_root_takes_few_evaluations() {
    // Bisection takes 53.
    type Function = fn(f64) -> f64;
    let cases: [(Function, f64, usize); 11] = [
        (|x| x, 0.0, 1),
        (|x| 1.0 - x, 1.0_f64.next_down(), 1),
        (|x| x - 0.7, 0.7, 3),
        (|x| 0.7 - x, 0.7, 3),
        (|x| x * x - 0.5, 0.5_f64.sqrt(), 12),
        (|x| 0.5 - x * x, 0.5_f64.sqrt(), 12),
        (|x| (1.0 - x) * (1.0 - x) - 0.5, 1.0 - 0.5_f64.sqrt(), 12),
        (|x| 0.5 - (1.0 - x) * (1.0 - x), 1.0 - 0.5_f64.sqrt(), 12),
        (|x| 8.0_f64.powf(x) - 3.0, 3.0_f64.log(8.0), 11),
        (|x| 1.0 / (x + 0.01) - 2.0, 0.49, 14),
        (|x| (x - 0.7).powi(5), 0.7, 98),
    ];
    for (f, root, most) in cases {
        let (found, evaluations) = between(|x| Some(f(x)), 0.0, 1.0);
        let change = found.unwrap();
        let (found, size) = (change.below, change.residual());
        assert!((found - root).abs() <= 4.0 * f64::EPSILON, "{found} {root}");
        assert!(size <= 2e-15 && size == f(found).abs().max(f(found.next_up()).abs()));
        assert!(evaluations <= most, "{root}: {evaluations}");
    }
    let (found, evaluations) = between(|x| Some(if x > 0.7 { 1e-3 } else { -20.0 }), 0.0, 1.0);
    let change = found.unwrap();
    assert_eq!((change.below, change.values), (0.7, [-20.0, 1e-3]));
    assert_eq!(change.residual(), 20.0);
    assert!(evaluations <= 98, "{evaluations}");
}

#[test]
fn a_gap_between_the_ends_is_told() {
    let (found, evaluations) = between(|x| (!(0.4..0.6).contains(&x)).then_some(x - 0.5), 0.0, 1.0);
    assert_eq!((found, evaluations), (None, 1));
}
