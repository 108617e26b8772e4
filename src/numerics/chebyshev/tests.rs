use approx::assert_abs_diff_eq;
use std::cell::RefCell;

use super::*;
use crate::numerics::bracket::root_between;
use crate::numerics::testing::rough;

/// A function that records the points of its evaluations.
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
        let mut sample = |t| {
            let value = self.at(t);
            Ok(Sample { value, noise })
        };
        isolate(&mut sample, &|t| t).unwrap()
    }
}

fn roots(f: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut sample = |x| {
        let value = f(x);
        Ok(Sample {
            value,
            noise: 1e-15,
        })
    };
    let nodes = isolate(&mut sample, &|t| 3.0 * t).unwrap();
    let refined = |[a, b]: [f64; 2]| root_between(&mut |x| Ok(f(x)), a, b).unwrap();
    brackets(&nodes).into_iter().map(refined).collect()
}

/// T_k(x), by its definition.
fn chebyshev(k: i32, x: f64) -> f64 {
    (f64::from(k) * x.acos()).cos()
}

/// Returns true if a function of −1 ≤ x ≤ 1 is settled in one piece.
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
        assert_abs_diff_eq!(*found, expected, epsilon = 4e-16 * expected.max(1.0));
    }
}

#[test]
fn close_pairs_are_split_and_flat_functions_have_no_root() {
    let gap = 1e-7;
    let found = roots(|x| (x - 1.1) * (x - 1.1 - gap));
    assert_eq!(found.len(), 2);
    assert_abs_diff_eq!(found[1] - found[0], gap, epsilon = 1e-15);
    assert!(roots(|x| 1e-16 * (40.0 * x).sin()).is_empty());
    assert!(roots(|x| (x - 1.1).powi(2)).is_empty());
    assert_eq!(roots(|x| (x - 1.1).powi(3)).len(), 1);
}

/// The values show nothing of an even number of roots between two neighbouring places. The last
/// coefficients of the logarithm are 0 where the roots lie midway.
#[test]
fn a_pair_is_found_between_any_two_places() {
    for twice in 1..4 * DEGREE {
        let angle = std::f64::consts::PI * twice as f64 / (4 * DEGREE) as f64;
        let middle = 0.5 * (1.0 + angle.cos());
        for gap in [1e-4, 1e-7] {
            let f = |t: f64| ((t - middle).powi(2) - gap * gap) * (0.3 * t).exp();
            let nodes = Watched::new(f).isolated(1e-16);
            assert_eq!(brackets(&nodes).len(), 2, "{twice} {gap}");
        }
    }
}

#[test]
fn undeclared_kinks_end() {
    let found = roots(|x| (x - 1.0 / 3.0).abs() - 0.125);
    assert_eq!(found.len(), 2);
}

// Which functions are settled in one piece. These tests fail if the coefficient of any Chebyshev
// polynomial T_k is wrong.

#[test]
fn a_constant_that_outweighs_an_oscillation_leaves_no_root() {
    // |T_k| ≤ 1, and T_k has k roots.
    for k in 2..=28 {
        for sign in [1.0, -1.0] {
            assert!(settles(1e-13, |x| sign * 1.001 + chebyshev(k, x)), "{k}");
            assert!(!settles(1e-13, |x| sign * 0.999 + chebyshev(k, x)), "{k}");
        }
    }
    // Two coefficients may add up.
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
        // A coefficient smaller than the noise is not counted.
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
            // With a root, so that no logarithm is looked at.
            assert!(!settles(1e-13, |x| 5.0 * x + sign * chebyshev(k, x)), "{k}");
            // Last coefficients of up to four times the noise count as noise.
            assert!(
                settles(1e-3, |x| 5.0 * x + sign * 3.99e-3 * chebyshev(k, x)),
                "{k}"
            );
            assert!(
                !settles(1e-3, |x| 5.0 * x + sign * 4.01e-3 * chebyshev(k, x)),
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
    // Two coefficients, together larger than the noise, each smaller: the function is not flat, and
    // its slope is not known.
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
        let watched = Watched::new(|t| (t - kink).abs() + 0.5 * t - 0.35);
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
    let mut sample = |x: f64| {
        Ok(Sample {
            value: x - 7.3,
            noise: 1e-14,
        })
    };
    let nodes = isolate(&mut sample, &|t| 9.0 - 4.0 * t * t).unwrap();
    assert_eq!(
        nodes.iter().map(|node| node.at).collect::<Vec<_>>(),
        [9.0, 5.0]
    );
    assert_eq!(brackets(&nodes), [[9.0, 5.0]]);
}

#[test]
fn pieces_end_at_the_shortest_length() {
    // A root with a kink, at no end of any piece: two pieces more at each halving, down to 2⁻³⁰.
    let watched = Watched::new(|t: f64| {
        let beyond = t - 1.0 / 3.0;
        if beyond > 0.0 { 2.0 * beyond } else { beyond }
    });
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
    // The pieces still cover the interval, evenly.
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
    let fails = || Error::check("test", "x", f64::NAN, false, "");
    assert!(isolate(&mut |_| Err(fails().unwrap_err()), &|t| t).is_err());
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
    // A value exactly as large as its noise has no sign, nor has 0.
    assert!(found(&[(0.2, 0.1), (-0.1, 0.1), (0.2, 0.1)]).is_empty());
    assert!(found(&[(0.2, 0.1), (0.0, 0.0), (0.3, 0.1)]).is_empty());
    assert!(found(&[(0.2, 0.1), (7.0, 0.1)]).is_empty() && found(&[]).is_empty());
}

/// The sign of a function throughout, and the number of evaluations.
fn sign(noise: f64, f: impl Fn(f64) -> f64) -> (Option<bool>, usize) {
    let watched = Watched::new(f);
    let mut sample = |t| {
        let value = watched.at(t);
        Ok(Sample { value, noise })
    };
    let sign = sign_throughout(&mut sample, &|t| t).unwrap();
    (sign, watched.looks())
}

#[test]
fn a_sign_is_told_in_few_looks_over_hundreds_of_decades() {
    for scale in [1.0, -1e-3] {
        let positive = Some(scale > 0.0);
        let one_piece = (positive, DEGREE + 1);
        assert_eq!(sign(0.0, |_| scale), one_piece);
        assert_eq!(sign(0.0, |t| scale * (-700.0 * t * t).exp()), one_piece);
        // A near zero takes some halvings.
        let (found, looks) = sign(0.0, |t| scale * ((t - 0.3).powi(2) + 1e-6));
        assert!(found == positive && looks < 60 * (DEGREE + 1), "{looks}");
    }
}

#[test]
fn a_sign_that_changes_or_is_not_sure_is_unknown() {
    let unknown = |noise: f64, f: fn(f64) -> f64| {
        let (sign, looks) = sign(noise, f);
        assert!(looks <= 250 * (DEGREE + 1), "{looks}");
        assert_eq!(sign, None);
    };
    unknown(0.0, |t| t - 0.3);
    unknown(0.0, |_| 0.0);
    unknown(0.0, |_| f64::NAN);
    unknown(0.0, |t| (t - 0.3).powi(2));
    unknown(1e-3, |_| 1e-4);
    // Two roots 10⁻³ apart, of one sign almost everywhere.
    unknown(0.0, |t| (t - 0.3) * (t - 0.301));
    // Noise that is no larger than it says, but hides a root.
    unknown(1e-3, |t| (t - 0.3).powi(2) + 2e-3 + 1e-3 * rough(t));
}

/// A function without a root that no polynomial resolves, as its logarithm is smooth; one with a
/// pair of roots between two samples is halved.
#[test]
fn smooth_logarithms_have_no_roots() {
    let falling = Watched::new(|t: f64| (-900.0 * t).exp());
    falling.isolated(1e-15);
    assert!(falling.looks() <= 31 * (DEGREE + 1));
    for half in [1e-3, 1e-5, 1e-7] {
        let pair = Watched::new(|t: f64| (t - 0.4321).powi(2) - half * half);
        let roots = brackets(&pair.isolated(1e-17)).len();
        assert_eq!(roots, 2, "{half}");
    }
}
