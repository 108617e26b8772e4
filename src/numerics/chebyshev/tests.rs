use std::cell::RefCell;

use super::*;
use crate::numerics::testing::rough;

/// A function that keeps the points at which it was looked at.
struct Watched<F> {
    f: F,
    seen: RefCell<Vec<f64>>,
}

impl<F: Fn(f64) -> f64> Watched<F> {
    fn new(f: F) -> Self {
        let seen = RefCell::default();
        Self { f, seen }
    }

    fn at(&self, x: f64) -> f64 {
        self.seen.borrow_mut().push(x);
        assert!(self.looks() < 100_000, "endless");
        (self.f)(x)
    }

    fn looks(&self) -> usize {
        self.seen.borrow().len()
    }

    fn isolated(&self, noise: f64) -> Vec<Node> {
        let sample = |t| {
            let value = self.at(t);
            Ok(Sample { value, noise })
        };
        isolate(sample, |t| t).unwrap()
    }

    fn refined(&self, a: f64, b: f64) -> f64 {
        refine(a, b, |x| Ok(self.at(x))).unwrap()
    }
}

fn roots(f: impl Fn(f64) -> f64) -> Vec<f64> {
    let sample = |x| {
        let value = f(x);
        Ok(Sample {
            value,
            noise: 1e-15,
        })
    };
    let nodes = isolate(sample, |t| 3.0 * t).unwrap();
    let refined = |[a, b]: [f64; 2]| refine(a, b, |x| Ok(f(x))).unwrap();
    brackets(&nodes).into_iter().map(refined).collect()
}

/// T_k(x), by its definition.
fn chebyshev(k: i32, x: f64) -> f64 {
    (f64::from(k) * x.acos()).cos()
}

/// Whether a function of −1 ≤ x ≤ 1 is settled in one piece.
fn settles(noise: f64, f: impl Fn(f64) -> f64) -> bool {
    let watched = Watched::new(|t: f64| f((2.0 * t - 1.0).clamp(-1.0, 1.0)));
    watched.isolated(noise);
    watched.looks() == DEGREE + 1
}

#[test]
fn all_roots_are_found() {
    let expected: Vec<f64> = (1..=47)
        .map(|k| std::f64::consts::PI * f64::from(k) / 50.0)
        .collect();
    let found = roots(|x| (50.0 * x).sin());
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 4e-16 * expected.max(1.0));
    }
}

#[test]
fn close_pairs_are_split_and_flat_functions_have_no_root() {
    let gap = 1e-7;
    let found = roots(|x| (x - 1.1) * (x - 1.1 - gap));
    assert_eq!(found.len(), 2);
    assert!((found[1] - found[0] - gap).abs() < 1e-15);
    assert!(roots(|x| 1e-16 * (40.0 * x).sin()).is_empty());
    assert!(roots(|x| (x - 1.1).powi(2)).is_empty());
    assert_eq!(roots(|x| (x - 1.1).powi(3)).len(), 1);
}

#[test]
fn undeclared_kinks_end() {
    let found = roots(|x| (x - 1.0 / 3.0).abs() - 0.125);
    assert_eq!(found.len(), 2);
}

// Which functions are settled in one piece: the coefficient of each Chebyshev polynomial T_k must
// be right for these.

#[test]
fn a_constant_that_outweighs_an_oscillation_leaves_no_root() {
    // |T_k| ≤ 1, and T_k has k roots.
    for k in 2..=28 {
        for sign in [1.0, -1.0] {
            assert!(settles(1e-13, |x| sign * 1.001 + chebyshev(k, x)), "{k}");
            assert!(!settles(1e-13, |x| sign * 0.999 + chebyshev(k, x)), "{k}");
        }
    }
    // Two of them may add up.
    assert!(settles(1e-13, |x| 2.001 + chebyshev(5, x) - chebyshev(8, x)));
    assert!(!settles(1e-13, |x| 1.999 + chebyshev(5, x) - chebyshev(8, x)));
    // A root may hide in the noise.
    assert!(settles(0.1, |x| 1.11 + chebyshev(3, x)));
    assert!(!settles(0.1, |x| 1.09 + chebyshev(3, x)));
}

#[test]
fn a_slope_that_outweighs_an_oscillation_leaves_one_root() {
    // |T_k'| ≤ k², and is k² at an end, where x − T_k/k² has the slope 0.
    for k in 2..=28 {
        let square = f64::from(k * k);
        assert!(
            settles(1e-13, |x| x - 0.999 * chebyshev(k, x) / square),
            "{k}"
        );
        assert!(
            !settles(1e-13, |x| x - 1.001 * chebyshev(k, x) / square),
            "{k}"
        );
        // What is smaller than its noise is not counted.
        let noise = 1.002 / square;
        assert!(
            settles(noise, |x| x - 1.001 * chebyshev(k, x) / square),
            "{k}"
        );
    }
    assert!(settles(1e-13, |x| -x) && settles(1e-13, |x| 0.5 - x) && settles(1e-13, |x| 3.0 - x));
}

#[test]
fn the_last_coefficients_tell_whether_a_function_is_resolved() {
    for k in 29..=32 {
        for sign in [1.0, -1.0] {
            assert!(!settles(1e-13, |x| 3.0 + sign * chebyshev(k, x)), "{k}");
            // Four times the noise is taken for noise.
            assert!(
                settles(1e-3, |x| 3.0 + sign * 3.99e-3 * chebyshev(k, x)),
                "{k}"
            );
            assert!(
                !settles(1e-3, |x| 3.0 + sign * 4.01e-3 * chebyshev(k, x)),
                "{k}"
            );
        }
    }
}

#[test]
fn what_is_smaller_than_its_noise_has_no_roots() {
    assert!(settles(1.0, |x| 0.99 * chebyshev(5, x)));
    assert!(!settles(1.0, |x| 1.01 * chebyshev(5, x)));
    assert!(settles(1.0, |x| 0.5 * chebyshev(2, x) - 0.49 * chebyshev(3, x)));
    // Together larger than the noise, each smaller: not flat, and no slope is known.
    assert!(!settles(1.0, |x| 0.5 * chebyshev(2, x) - 0.51 * chebyshev(3, x)));
    assert!(settles(0.0, |_| 0.0));
}

#[test]
fn pieces_are_halved_where_they_must_be_and_nowhere_else() {
    // A kink at an end of pieces of length 2⁻ⁿ takes 2n + 1 pieces, a straight line one.
    for (kink, ends) in [
        (0.0, vec![0.0, 1.0]),
        (0.5, vec![0.0, 0.5, 0.5, 1.0]),
        (0.25, vec![0.0, 0.25, 0.25, 0.5, 0.5, 1.0]),
        (0.625, vec![0.0, 0.5, 0.5, 0.625, 0.625, 0.75, 0.75, 1.0]),
    ] {
        let watched = Watched::new(|t| (t - kink).abs() + 0.5 * t - 0.1);
        let nodes = watched.isolated(1e-15);
        assert_eq!(nodes.iter().map(|node| node.at).collect::<Vec<_>>(), ends);
        assert_eq!(watched.looks(), (ends.len() - 1) * (DEGREE + 1));
        for node in nodes {
            assert_eq!(node.sample.value, (watched.f)(node.at));
        }
        assert!(
            watched
                .seen
                .borrow()
                .iter()
                .all(|t| (0.0..=1.0).contains(t))
        );
    }
}

#[test]
fn nodes_are_points_of_the_mapped_interval() {
    let sample = |x: f64| {
        Ok(Sample {
            value: x - 7.3,
            noise: 1e-14,
        })
    };
    let nodes = isolate(sample, |t| 9.0 - 4.0 * t * t).unwrap();
    assert_eq!(
        nodes.iter().map(|node| node.at).collect::<Vec<_>>(),
        [9.0, 5.0]
    );
    assert_eq!(brackets(&nodes), [[9.0, 5.0]]);
}

#[test]
fn pieces_end_at_the_shortest_length() {
    // A kink that is at no end of any piece: two pieces more at each halving, down to 2⁻³⁰.
    let watched = Watched::new(|t: f64| (t - 1.0 / 3.0).abs() + 1.0);
    let nodes = watched.isolated(1e-15);
    assert_eq!(watched.looks(), (2 * 30 + 1) * (DEGREE + 1));
    let lengths = nodes.chunks(2).map(|ends| ends[1].at - ends[0].at);
    assert_eq!(lengths.fold(f64::INFINITY, f64::min), SHORTEST);
    assert_eq!(SHORTEST, 0.5_f64.powi(30));
}

#[test]
fn functions_noisier_than_they_say_are_not_followed_for_ever() {
    let watched = Watched::new(rough);
    let nodes = watched.isolated(0.0);
    // Every piece but the first is one of two halves, so that their number is odd.
    assert_eq!(watched.looks(), (MOST_PIECES - 1) * (DEGREE + 1));
    // They still cover the interval, evenly.
    assert_eq!((nodes[0].at, nodes[nodes.len() - 1].at), (0.0, 1.0));
    assert_eq!(nodes.len(), MOST_PIECES);
    assert!(
        nodes
            .windows(2)
            .skip(1)
            .step_by(2)
            .all(|pair| pair[0].at == pair[1].at)
    );
    let lengths = nodes.chunks(2).map(|ends| ends[1].at - ends[0].at);
    assert!(lengths.fold(0.0, f64::max) == 0.5_f64.powi(9));
}

#[test]
fn errors_of_the_function_are_handed_on() {
    let fails = || Error::check("x", f64::NAN, false, "");
    assert!(isolate(|_| Err(fails().unwrap_err()), |t| t).is_err());
    assert!(refine(0.0, 1.0, |_| Err(fails().unwrap_err())).is_err());
}

#[test]
fn brackets_need_two_values_beyond_their_noise() {
    let nodes = |values: &[(f64, f64)]| -> Vec<Node> {
        let node = |(at, &(value, noise))| Node {
            at: at as f64,
            sample: Sample { value, noise },
        };
        values.iter().enumerate().map(node).collect()
    };
    let found = |values: &[(f64, f64)]| brackets(&nodes(values));
    assert_eq!(
        found(&[(5.0, 0.1), (-3.0, 0.1), (0.3, 0.1)]),
        [[0.0, 1.0], [1.0, 2.0]]
    );
    assert_eq!(
        found(&[(-0.2, 0.1), (0.05, 0.1), (-0.1, 0.1), (0.2, 0.1)]),
        [[0.0, 3.0]]
    );
    // No sign at exactly the noise, and none for 0.
    assert!(found(&[(0.2, 0.1), (-0.1, 0.1), (0.2, 0.1)]).is_empty());
    assert!(found(&[(0.2, 0.1), (0.0, 0.0), (0.3, 0.1)]).is_empty());
    assert!(found(&[(0.2, 0.1), (7.0, 0.1)]).is_empty() && found(&[]).is_empty());
}

// Refinement.

#[test]
fn a_parabola_as_inverse_is_met_as_soon_as_three_points_are_known() {
    // The inverse of √x − c is a parabola, and interpolation of it exact: the two ends, the middle,
    // and the root.
    for root in [1.3_f64, 1.7, 2.1, 3.6, 4.8] {
        for [a, b] in [[1.0, 5.0], [5.0, 1.0]] {
            let watched = Watched::new(|x: f64| x.sqrt() - root.sqrt());
            let found = watched.refined(a, b);
            assert!((found - root).abs() < 1e-15 * root, "{root}");
            assert!(
                (watched.seen.borrow()[3] - root).abs() < 2e-15 * root,
                "{root}"
            );
            assert!(watched.looks() <= 5, "{root}: {}", watched.looks());
        }
    }
}

#[test]
fn refinement_is_fast_and_ends_at_the_best_point() {
    fn check(a: f64, b: f64, root: f64, most: usize, f: impl Fn(f64) -> f64) {
        for sign in [1.0, -1.0] {
            for (a, b) in [(a, b), (b, a)] {
                let watched = Watched::new(|x| sign * f(x));
                let found = watched.refined(a, b);
                assert!(
                    (found - root).abs() <= 4.0 * f64::EPSILON * root.abs(),
                    "{found} {root}"
                );
                assert!(watched.looks() <= most, "{root}: {}", watched.looks());
                let seen = watched.seen.borrow();
                assert!(seen.iter().all(|&x| x >= a.min(b) && x <= a.max(b)));
                assert!(seen.iter().all(|&x| f(x).abs() >= f(found).abs()));
            }
        }
    }
    // Bisection takes some 54 steps, and more where the root is small beside the interval.
    check(1.0, 2.0, 2_f64.cbrt(), 10, |x| x * x * x - 2.0);
    check(0.0, 3.0, 2_f64.ln(), 10, |x| x.exp() - 2.0);
    check(0.0, 30.0, 2_f64.ln(), 16, |x| (-x).exp() - 0.5);
    check(0.1, 100.0, 1.0 / 7.0, 20, |x| x.recip() - 7.0);
    check(-1.0, 2.0, 0.739_085_133_215_160_6, 10, |x| x.cos() - x);
    check(0.0, 1e10, 3.0, 5, |x| x / 3.0 - 1.0);
    // A root so flat that nothing helps costs no more than bisection.
    check(0.0, 1.0, 0.3, 57, |x| (x - 0.3).powi(9));
}

#[test]
fn roots_within_rounding_of_an_end_are_found_from_inside() {
    // Interpolation alone would look at the end again, or beyond it.
    for k in 1..=200 {
        let end = 1.0 + f64::from(k) / 201.0;
        let last = end.ln() * (1.0 - f64::EPSILON);
        for [a, b] in [[0.5, end], [end, 0.5]] {
            let watched = Watched::new(|x: f64| {
                assert!((0.5..=end).contains(&x), "{x} {end}");
                x.ln() - last
            });
            let found = watched.refined(a, b);
            assert!((found - end).abs() <= 2.0 * f64::EPSILON * end);
            assert!(watched.looks() <= 5, "{end}: {}", watched.looks());
        }
    }
}

#[test]
fn exact_roots_end_the_refinement_at_once() {
    for (a, b, looks) in [
        (0.25, 1.0, 2),
        (-1.0, 0.25, 2),
        (0.0, 0.5, 3),
        (0.5, 0.0, 3),
    ] {
        let watched = Watched::new(|x| 4.0 * x - 1.0);
        assert_eq!((watched.refined(a, b), watched.looks()), (0.25, looks));
    }
}

#[test]
fn jumps_are_bisected_to_neighbouring_numbers() {
    // A function without a shape: no interpolation helps, and 2⁵² numbers lie between two powers of
    // two.
    for root in [1.1, 1.5, 1.9999] {
        let watched = Watched::new(|x| if x < root { -1.0 } else { 3.0 });
        let found = watched.refined(1.0, 2.0);
        assert!((found - root).abs() <= 2.0 * f64::EPSILON * root && found < root);
        assert!(watched.looks() <= 2 + 53, "{}", watched.looks());
    }
    // Near 0, the smallest normal number is the aim.
    let watched = Watched::new(|x| if x < 3e-306 { -1.0 } else { 1.0 });
    assert!((watched.refined(0.0, 1e-305) - 3e-306).abs() < 2.0 * f64::MIN_POSITIVE);
    assert!(watched.looks() <= 2 + 10, "{}", watched.looks());
}

#[test]
fn refinement_gives_up_with_the_better_end() {
    // Some 990 halvings away from 1.
    let root = 1e-300;
    for [below, above] in [[-1.0, 2.0], [-2.0, 1.0]] {
        let watched = Watched::new(|x| if x < root { below } else { above });
        let found = watched.refined(-1.0, 1.0);
        assert_eq!(found < root, above == 2.0);
        assert!(found.abs() < 1e-59, "{found}");
        assert_eq!(watched.looks(), 2 + 200);
    }
}
