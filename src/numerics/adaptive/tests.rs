use approx::assert_abs_diff_eq;
use std::cell::Cell;

use super::*;
use crate::numerics::testing::rough;

/// The result of a rule for a function, and how many values the rule took.
fn watched<T>(
    f: impl Fn(f64) -> [f64; 2],
    rule: impl FnOnce(&dyn Fn(f64) -> Result<[f64; 2], Error>) -> Result<T, Error>,
) -> (T, usize) {
    let looks = Cell::new(0);
    let result = rule(&|x| {
        looks.set(looks.get() + 1);
        assert!(looks.get() < 1_000_000, "endless");
        Ok(f(x))
    });
    (result.unwrap(), looks.get())
}

fn counted(f: impl Fn(f64) -> [f64; 2], mesh: &[f64]) -> (Integral<2>, usize) {
    watched(f, |f| gauss(f, mesh, 0.0))
}

fn counted_trapezoid(f: impl Fn(f64) -> [f64; 2]) -> (Option<Integral<2>>, usize) {
    watched(f, |f| trapezoid(f))
}

#[test]
fn kinks_and_narrow_features_are_resolved() {
    let kink = gauss(|x| Ok([(x - 0.3).abs(), 0.0]), &[0.0, 1.0], 0.0).unwrap();
    assert_abs_diff_eq!(kink.parts[0], 0.29, epsilon = 1e-12);
    let narrow = gauss(|x| Ok([(-x / 1e-5).exp(), 0.0]), &graded(0.0, 1.0), 0.0).unwrap();
    assert_abs_diff_eq!(narrow.parts[0], 1e-5, epsilon = 1e-19);
}

#[test]
fn trapezoid_meets_bessel_functions() {
    // ∫₀^π e^{x cos ψ} dψ = π I_0(x)
    let integral = trapezoid(|psi| Ok([(10.0 * psi.cos()).exp(), 0.0])).unwrap();
    let i0 = 2_815.716_628_466_254;
    assert_abs_diff_eq!(integral.unwrap().parts[0] / (PI * i0), 1.0, epsilon = 1e-14);
    assert!(trapezoid(|psi| Ok([psi * psi, 0.0])).unwrap().is_none());
}

#[test]
fn both_integrals_their_size_and_their_peak_are_those_of_the_interval() {
    let check = |integral: Integral<2>, length: f64| {
        let expected = [-2.0 * length, 3.0 * length];
        for (part, expected) in integral.parts.into_iter().zip(expected) {
            assert!((part - expected).abs() < 1e-14 * length, "{integral:?}");
        }
        assert_abs_diff_eq!(integral.size, 5.0 * length, epsilon = 1e-14 * length);
        assert_eq!(integral.peak, 5.0);
    };
    let constant = |_| [-2.0, 3.0];
    check(counted(constant, &[1.0, 4.0]).0, 3.0);
    check(counted(constant, &[-1.0, 0.5, 0.75, 6.0]).0, 7.0);
    check(counted(constant, &graded(-1.0, 6.0)).0, 7.0);
    check(counted_trapezoid(constant).0.unwrap(), PI);
    // |−x| + x has its peak at the end, on the last of several panels or on the first.
    for [a, b] in [[0.0, 1.0], [-1.0, 0.0]] {
        let (integral, _) = counted(|x| [-x, x], &graded(a, b));
        assert_abs_diff_eq!(integral.size, 1.0, epsilon = 1e-15);
        assert!(integral.peak > 1.99 && integral.peak <= 2.0);
    }
}

#[test]
fn smooth_integrands_take_one_comparison() {
    // 16 points are exact to degree 31: a panel and its halves.
    let polynomial = |x: f64| [x.powi(31), x.powi(8)];
    for (mesh, panels) in [(vec![0.0, 1.0], 1), (vec![0.0, 0.1, 0.5, 1.0], 3)] {
        let (integral, looks) = counted(polynomial, &mesh);
        assert_abs_diff_eq!(integral.parts[0], 1.0 / 32.0, epsilon = 1e-16);
        assert_abs_diff_eq!(integral.parts[1], 1.0 / 9.0, epsilon = 1e-16);
        assert_eq!(looks, panels * (16 + 2 * 16));
    }
    // 0 agrees with 0.
    let (integral, looks) = counted(|_| [0.0, 0.0], &[0.0, 1.0]);
    assert_eq!((integral.parts, integral.peak, looks), ([0.0; 2], 0.0, 48));
    // n intervals of the trapezoidal rule are exact for cos kψ, k < 2n: 64 and 128 of them.
    let (integral, looks) = counted_trapezoid(|psi| [psi.sin().powi(2), (127.0 * psi).cos()]);
    let parts = integral.unwrap().parts;
    assert!((parts[0] - 0.5 * PI).abs() < 1e-15 && parts[1].abs() < 1e-14);
    assert_eq!(looks, 129);
    assert_eq!(counted_trapezoid(|_| [0.0, 0.0]).1, 129);
}

#[test]
fn rules_are_refined_until_both_integrals_agree() {
    // cos 2nψ is 1 at all of n + 1 points, and has the integral 0.
    for (most, looks) in [(1, 257), (2, 513), (3, 1025), (4, 2049)] {
        for swapped in [false, true] {
            let (integral, taken) = counted_trapezoid(|psi| {
                let waves = (0..most).map(|j| (f64::from(128 << j) * psi).cos());
                let (one, other) = (1.0 + waves.sum::<f64>(), psi.cos().powi(2));
                if swapped { [other, one] } else { [one, other] }
            });
            let parts = integral.unwrap().parts;
            assert_abs_diff_eq!(parts[usize::from(swapped)], PI, epsilon = 1e-12);
            assert_abs_diff_eq!(parts[usize::from(!swapped)], 0.5 * PI, epsilon = 1e-12);
            assert_eq!(taken, looks);
        }
    }
    // After three halvings a kink at 3/8 is an end of panels: 7 panels, the last 4 of which agree
    // with their halves.
    for swapped in [false, true] {
        let kinked = |x: f64| {
            if swapped {
                [x, (x - 0.375).abs()]
            } else {
                [(x - 0.375).abs(), x]
            }
        };
        let (integral, looks) = counted(kinked, &[0.0, 1.0]);
        let exact = 0.5 * (0.375_f64.powi(2) + 0.625_f64.powi(2));
        assert_abs_diff_eq!(integral.parts[usize::from(swapped)], exact, epsilon = 1e-15);
        assert_abs_diff_eq!(integral.parts[usize::from(!swapped)], 0.5, epsilon = 1e-15);
        assert_eq!(looks, 16 + 7 * 32);
    }
}

#[test]
fn integrands_that_are_not_resolved_end() {
    let (integral, looks) = counted_trapezoid(|psi| [rough(psi), 0.0]);
    assert!(integral.is_none());
    assert_eq!(looks, 2048 + 1);
    // Each halving makes two more panels, 256 at most; even then the whole interval is covered.
    let (integral, looks) = counted(|x| [rough(x), 1.0], &[0.0, 3.0]);
    assert_eq!(looks, 16 + (1 + 256) * 32);
    assert_abs_diff_eq!(integral.parts[1], 3.0, epsilon = 1e-12);
    // An undeclared kink takes two panels at each halving, until its panel is shorter than the
    // tolerance.
    let (_, looks) = counted(|x| [(x - 1.0 / 3.0).abs(), 0.0], &[0.0, 1.0]);
    assert!(looks <= 16 + 50 * 32, "{looks}");
}

#[test]
fn tolerances_grow_with_the_integral_and_with_the_peak() {
    let tolerance = |size, peak| {
        Integral {
            parts: [0.0; 2],
            size,
            peak,
        }
        .tolerance()
    };
    // The tolerance allows for some round-off of the sum and of the largest term, but not for much.
    for scale in [1e-9, 1.0, 1e9] {
        let (wide, narrow) = (tolerance(scale, 0.0), tolerance(0.0, scale));
        assert!(wide > f64::EPSILON * scale && wide <= 1e-12 * scale);
        assert!(narrow > f64::EPSILON * scale && narrow < 1e-13 * scale);
        assert!(tolerance(scale, scale) > wide.max(narrow));
    }
    assert!(tolerance(0.0, 0.0) > 0.0);
}

#[test]
fn a_difference_in_either_integral_counts() {
    let of = |parts| Integral {
        parts,
        ..Integral::ZERO
    };
    let whole = of([1.0, -1.0]);
    assert!(whole.agrees(&of([1.5, -1.5]), 0.5) && whole.agrees(&of([0.5, -0.5]), 0.5));
    for parts in [[1.6, -1.0], [0.4, -1.0], [1.0, -0.4], [1.0, -1.6]] {
        assert!(!whole.agrees(&of(parts), 0.5), "{parts:?}");
    }
}

#[test]
fn graded_points_are_four_times_closer_from_one_to_the_next() {
    // For these ends every point is a binary fraction.
    for [a, b] in [[0.0, 2.0], [-3.0, 5.0], [5.0, 7.0]] {
        let points = graded(a, b);
        assert_eq!([points[0], points[6], points[12]], [a, 0.5 * (a + b), b]);
        for j in 1..6 {
            assert_eq!(points[j + 1] - a, 4.0 * (points[j] - a), "{j}");
        }
        for j in 1..12 {
            assert_eq!(points[j] - a, b - points[12 - j], "{j}");
        }
    }
}
