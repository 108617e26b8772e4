//! Roots of functions that are known in closed form, and the number of evaluations.

use super::*;
use approx::assert_abs_diff_eq;

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

/// The root of a function without gaps, in either order of the ends, and the number of evaluations.
fn root(f: impl Fn(f64) -> f64, a: f64, b: f64) -> (f64, usize) {
    let mut evaluations = 0;
    let mut counted = |x| {
        evaluations += 1;
        assert!(a.min(b) <= x && x <= a.max(b), "{x}");
        Ok(f(x))
    };
    let root = root_between(&mut counted, a, b).unwrap();
    (root, evaluations)
}

#[test]
fn the_nearer_of_two_neighbours_is_the_root() {
    let third = 1.0 / 3.0;
    for sign in [1.0, -1.0] {
        for [a, b] in [[0.0, 1.0], [1.0, 0.0]] {
            for exact in [0.25, third, 0.7, 1e-3] {
                // The exact root lies a quarter of the way to one neighbour, or to the other.
                for (part, expected) in [(0.25, exact), (0.75, f64::next_up(exact))] {
                    let ulp = f64::next_up(exact) - exact;
                    let f = |x: f64| sign * ((x - exact) / ulp - part);
                    let (found, evaluations) = root(f, a, b);
                    assert_eq!(found, expected, "{exact}");
                    assert!(evaluations <= 8, "{exact}: {evaluations}");
                }
            }
        }
    }
}

#[test]
fn an_end_may_be_the_root() {
    for (a, b) in [(0.25, 1.0), (-1.0, 0.25), (1.0, 0.25)] {
        assert_eq!(root(|x| 4.0 * x - 1.0, a, b), (0.25, 2));
    }
    // A root within rounding of an end is found from inside.
    for k in 1..=200 {
        let end = 1.0 + f64::from(k) / 201.0;
        let last = end.ln() * (1.0 - f64::EPSILON);
        let (found, evaluations) = root(|x| x.ln() - last, end, 0.5);
        assert_abs_diff_eq!(found, end, epsilon = 2.0 * f64::EPSILON * end);
        assert!(evaluations <= 12, "{end}: {evaluations}");
    }
}

#[test]
fn roots_are_found_however_small_they_are() {
    for exact in [1e-30, 1e-100, 1e-300, 5e-324] {
        let (found, evaluations) = root(|x| if x < exact { -1.0 } else { 2.0 }, 0.0, 1.0);
        assert_eq!(found, exact.next_down(), "{exact}");
        assert!(evaluations <= 2 + 1140, "{exact}: {evaluations}");
    }
}

#[test]
fn errors_of_the_function_are_handed_on() {
    let mut fails = |_| Error::check("test", "x", f64::NAN, false, "");
    assert!(root_between(&mut fails, 0.0, 1.0).is_err());
}
