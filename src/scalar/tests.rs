//! Every operation of the Taylor coefficient to order 30: against known series, against contour
//! integrals of the same expression in complex numbers, and against the other operations.

mod expression;

use expression::{Expression, SPEED};
use num_complex::Complex;

use super::dual::{Dual, Tangent};
use super::jet::{self, Tape};
use super::lanes::Chunk;
use super::recorded::Recorder;
use super::{LONGEST, Scalar, Workspace, expand};
use crate::friction::{FrictionLaw, Piece};
use crate::series::{PowerSeries, TERMS};

/// Coefficients of orders 0 to 31 of a sliding speed s(t).
type Inner = [f64; LONGEST];

/// Orders compared.
const ORDERS: usize = 31;

/// Coefficients of orders 0 to 30 of law(s(t)), piece `piece` of the law, in a workspace that may
/// hold an older series.
fn compose_in(
    workspace: &mut Workspace<LONGEST>,
    law: Expression,
    piece: usize,
    inner: &Inner,
) -> [f64; ORDERS] {
    let mut series = [f64::NAN; ORDERS];
    let (value, slope) = expand(
        Piece {
            law: &law,
            index: piece,
        },
        workspace,
        inner[0],
        |k, s, m| {
            series[k] = if k == 0 {
                m.rest
            } else {
                m.slope * s + m.scale * m.rest
            };
            inner[k + 1]
        },
    );
    assert!(value.is_finite() && slope.is_finite(), "{value} {slope}");
    assert_eq!(value.to_bits(), series[0].to_bits());
    assert_jets_agree(
        &series,
        &compose_by_jets(&mut Tape::new(), law, piece, inner),
    );
    assert_jets_agree(&series, &compose_recorded(law, piece, inner, series));
    assert_jets_agree(&series, &compose_whole(law, piece, inner, series));
    series
}

/// Computes the series by the recorded law, in the last lane. In the first lane the law is at
/// another speed, if it has the same operations there; what is in a lane that is not in use adds
/// nothing. The value and the orders beyond are those of `series`.
fn compose_recorded(
    law: Expression,
    piece: usize,
    inner: &Inner,
    mut series: [f64; ORDERS],
) -> [f64; ORDERS] {
    let mut recorder = Recorder::default();
    let mut chunk = Chunk::new();
    for (lane, speed) in [(0, 1.1 * inner[0]), (3, inner[0])] {
        let run = recorder.begin(0);
        let output = law.kinetic_on(piece, run.argument(speed)).output();
        if lane == 0 || !chunk.take(lane, &mut recorder, output) {
            chunk.begin(lane, &mut recorder, output);
        }
    }
    for k in 1..TERMS {
        let arguments = [0.9 * inner[k], 0.0, 7.0, inner[k]];
        let found = chunk.order::<false, false>(k, arguments, [0.0, 0.0, f64::INFINITY, 0.0]);
        assert_eq!(found[2], f64::INFINITY);
        series[k] = found[3];
    }
    series
}

/// Computes the series with all orders at once. The orders beyond are those of `series`.
fn compose_whole(
    law: Expression,
    piece: usize,
    inner: &Inner,
    mut series: [f64; ORDERS],
) -> [f64; ORDERS] {
    let found = law.kinetic_on(piece, PowerSeries::from_fn(|k| inner[k]));
    series[..TERMS].copy_from_slice(found.coefficients());
    series
}

/// Computes the series with the order at run time.
fn compose_by_jets(tape: &mut Tape, law: Expression, piece: usize, inner: &Inner) -> [f64; ORDERS] {
    let mut series = [f64::NAN; ORDERS];
    for (k, (s, m)) in std::iter::zip(inner, &mut series).enumerate() {
        *m = tape.run(k, |run| {
            law.kinetic_on(piece, run.variable(*s)).coefficient()
        });
    }
    series
}

/// Asserts that two ways to compute a series differ by roundings alone, of terms of lower orders
/// that are of the size of these, on a circle of radius [`RADIUS`].
#[track_caller]
fn assert_jets_agree(unrolled: &[f64; ORDERS], jets: &[f64; ORDERS]) {
    let mut magnitude = 0.0_f64;
    for (k, (unrolled, jet)) in std::iter::zip(unrolled, jets).enumerate() {
        magnitude = (magnitude / RADIUS).max(unrolled.abs());
        let apart = (unrolled - jet).abs();
        assert!(
            apart <= 1e-13 * magnitude,
            "order {k}: {jet:e}, not {unrolled:e}"
        );
    }
}

fn compose(law: Expression, inner: &Inner) -> [f64; ORDERS] {
    compose_in(&mut Workspace::new(), law, 0, inner)
}

/// s_0 + t.
fn line(base: f64) -> Inner {
    let mut inner = [0.0; LONGEST];
    (inner[0], inner[1]) = (base, 1.0);
    inner
}

/// A series without a zero coefficient, |s(t) − s_0| < 0.43 for |t| ≤ 0.9.
fn wavy(base: f64) -> Inner {
    let mut inner: Inner = std::array::from_fn(|k| {
        0.4 * (-0.5_f64).powi(k as i32) * (1.0 + 0.3 * (2.0 * k as f64).cos())
    });
    inner[0] = base;
    inner
}

/// Asserts |actual − expected| ≤ tolerance·magnitude(k) for every order k.
#[track_caller]
fn assert_series(
    actual: &[f64; ORDERS],
    expected: impl Fn(usize) -> f64,
    tolerance: f64,
    magnitude: impl Fn(usize) -> f64,
) {
    let (expected, magnitude) = (
        std::array::from_fn(expected),
        std::array::from_fn(magnitude),
    );
    assert_close(actual, &expected, tolerance, &magnitude);
}

#[track_caller]
fn assert_close(
    actual: &[f64; ORDERS],
    expected: &[f64; ORDERS],
    tolerance: f64,
    magnitude: &[f64; ORDERS],
) {
    for (k, &actual) in actual.iter().enumerate() {
        let (expected, allowed) = (expected[k], tolerance * magnitude[k]);
        assert!(
            (actual - expected).abs() <= allowed,
            "order {k}: {actual:e}, not {expected:e} ± {allowed:.1e}"
        );
    }
}

/// 1/k!.
fn inverse_factorial(k: usize) -> f64 {
    (1..=k).map(|i| 1.0 / i as f64).product()
}

/// Binomial coefficient "p over k" for real p.
fn binomial(p: f64, k: usize) -> f64 {
    (0..k).map(|i| (p - i as f64) / (i + 1) as f64).product()
}

/// Allowed where the expected coefficients are known to all digits: a hundred roundings.
const KNOWN: f64 = 2e-14;

#[test]
fn arithmetic_is_exact() {
    let s = SPEED;
    let inner = wavy(0.75);
    let same = |law: [f64; ORDERS], expected: &dyn Fn(usize) -> f64| {
        assert_series(&law, expected, f64::EPSILON, |k| expected(k).abs());
    };
    let base = |k: usize, c: f64| if k == 0 { c } else { 0.0 };
    same(compose(s, &inner), &|k| inner[k]);
    same(compose(-s, &inner), &|k| -inner[k]);
    same(compose(s + 2.5, &inner), &|k| inner[k] + base(k, 2.5));
    same(compose(s - 0.5, &inner), &|k| inner[k] - base(k, 0.5));
    same(compose(s * -3.0, &inner), &|k| -3.0 * inner[k]);
    same(compose(s / 8.0, &inner), &|k| inner[k] / 8.0);
    same(compose(s + s, &inner), &|k| 2.0 * inner[k]);
    same(compose(s - s, &inner), &|_| 0.0);
    same(compose(s - s * 3.0, &inner), &|k| -2.0 * inner[k]);
    same(compose(s * 4.0 - 1.0 + s / 2.0, &inner), &|k| {
        4.5 * inner[k] - base(k, 1.0)
    });
    same(compose(s.constant(0.3), &inner), &|k| base(k, 0.3));
    same(compose(s.constant(0.25) - s, &inner), &|k| {
        base(k, 0.25) - inner[k]
    });
    same(compose(s.constant(2.0) * s, &inner), &|k| 2.0 * inner[k]);
    same(compose(s / s.constant(2.0), &inner), &|k| inner[k] / 2.0);
    same(compose(s * 0.0 + 7.0, &inner), &|k| base(k, 7.0));
    // Scaled views: nothing underflows on the way to a moderate result.
    same(compose(s * 1e-200 * 1e200, &inner), &|k| inner[k]);
}

#[test]
fn products_and_quotients_of_polynomials_are_the_convolutions() {
    let s = SPEED;
    for inner in [wavy(0.7), wavy(0.0), line(0.0), line(-1.5)] {
        let convolution = |k: usize| (0..=k).map(|i| inner[i] * inner[k - i]).sum::<f64>();
        let magnitude = |k: usize| {
            (0..=k)
                .map(|i| (inner[i] * inner[k - i]).abs())
                .sum::<f64>()
        };
        for series in [
            compose(s * s, &inner),
            compose(s.square(), &inner),
            compose(s.powi(2), &inner),
            compose(s.powf(2.0), &inner),
        ] {
            assert_series(&series, convolution, 4.0 * f64::EPSILON, magnitude);
        }
        // (2s + 1)(3 − s/2) = 3 + 5.5 s − s², from two views of one row.
        let product = compose((s * 2.0 + 1.0) * (-s / 2.0 + 3.0), &inner);
        let expected = |k: usize| 5.5 * inner[k] - convolution(k) + if k == 0 { 3.0 } else { 0.0 };
        assert_series(&product, expected, 4.0 * f64::EPSILON, |k| {
            8.0 + magnitude(k)
        });
        // A quotient undoes a product.
        let quotient = compose(s * (s.square() + 2.0) / (s * s + 2.0), &inner);
        assert_series(&quotient, |k| inner[k], KNOWN, |_| 2.0);
    }
}

#[test]
fn known_series_about_zero() {
    let s = SPEED;
    let zero = line(0.0);
    let odd = |k: usize| k % 2 == 1;
    let alternate = |m: usize| if m.is_multiple_of(2) { 1.0 } else { -1.0 };
    let relative = |law: [f64; ORDERS], expected: &dyn Fn(usize) -> f64| {
        assert_series(&law, expected, KNOWN, |k| expected(k).abs());
    };
    relative(compose(s.exp(), &zero), &inverse_factorial);
    relative(compose((s * -3.0).exp(), &zero), &|k| {
        inverse_factorial(k) * (-3.0_f64).powi(k as i32)
    });
    relative(compose(s.sin(), &zero), &|k| {
        if odd(k) {
            alternate(k / 2) * inverse_factorial(k)
        } else {
            0.0
        }
    });
    relative(compose(s.cos(), &zero), &|k| {
        if odd(k) {
            0.0
        } else {
            alternate(k / 2) * inverse_factorial(k)
        }
    });
    relative(compose(s.asinh(), &zero), &|k| match k {
        0 => 0.0,
        _ => binomial(-0.5, k / 2) * f64::from(u8::from(odd(k))) / k as f64,
    });
    relative(compose(s.atan(), &zero), &|k| {
        if odd(k) {
            alternate(k / 2) / k as f64
        } else {
            0.0
        }
    });
    // From the poles of tanh at ±iπ/2, ±3iπ/2, ...: c_k = ±2 (2/π)^(k+1) Σ 1/(2j+1)^(k+1),
    // Bernoulli numbers in closed form.
    relative(compose(s.tanh(), &zero), &|k| {
        let n = k as i32 + 1;
        let poles: f64 = (0..200_000)
            .map(|j| f64::from(2 * j + 1).powi(-n))
            .rev()
            .sum();
        match k {
            // These sums converge slowly.
            1 => 1.0,
            3 => -1.0 / 3.0,
            _ if odd(k) => alternate(k / 2) * 2.0 * std::f64::consts::FRAC_2_PI.powi(n) * poles,
            _ => 0.0,
        }
    });
    relative(compose((s + 1.0).ln(), &zero), &|k| {
        if k == 0 {
            0.0
        } else {
            -alternate(k) / k as f64
        }
    });
    relative(compose((s + 1.0).recip(), &zero), &alternate);
    relative(compose(s.constant(1.0) / (s + 1.0), &zero), &alternate);
    relative(compose((s + 1.0).sqrt(), &zero), &|k| binomial(0.5, k));
    for p in [0.5, -0.5, 1.0 / 3.0, 2.5, -1.75, 7.3, 29.5, 1e-3] {
        relative(compose((s + 1.0).powf(p), &zero), &|k| binomial(p, k));
    }
    for n in [-12, -7, -3, -2, -1, 0, 1, 2, 3, 5, 8, 13, 30] {
        let p = f64::from(n);
        let by_powi = compose((s + 1.0).powi(p as i32), &zero);
        relative(by_powi, &|k| binomial(p, k));
        assert_eq!(compose((s + 1.0).powf(p), &zero), by_powi);
    }
}

/// Integral powers of 0 itself are exact: no division by the base.
#[test]
fn integral_powers_of_zero_are_exact() {
    let s = SPEED;
    for n in 0..=30 {
        let p = f64::from(n);
        let expected: [f64; ORDERS] =
            std::array::from_fn(|k| if k == n as usize { 1.0 } else { 0.0 });
        assert_eq!(compose(s.powi(p as i32), &line(0.0)), expected, "s^{n}");
        assert_eq!(compose(s.powf(p), &line(0.0)), expected, "s^{n}");
        let law = SPEED.powi(p as i32);
        let jets = compose_by_jets(&mut Tape::new(), law, 0, &line(0.0));
        assert_eq!(jets, expected, "s^{n}");
    }
    let cubed = compose(s.powi(3), &wavy(0.0));
    let product = compose(s * s * s, &wavy(0.0));
    assert_eq!(cubed[..3], [0.0; 3]);
    assert_series(&cubed, |k| product[k], KNOWN, |_| 1.0);
}

#[test]
fn known_series_about_other_points() {
    let s = SPEED;
    for base in [1e-3, 0.3, 1.0, 2.75, 40.0] {
        let at = line(base);
        let power = |k: usize| base.powi(-(k as i32));
        let ln = compose(s.ln(), &at);
        let coefficient = |k: usize| -(-1.0_f64).powi(k as i32) * power(k) / k as f64;
        let expected = |k: usize| if k == 0 { base.ln() } else { coefficient(k) };
        assert_series(&ln, expected, KNOWN, |k| expected(k).abs());
        let recip = compose(s.recip(), &at);
        let expected = |k: usize| (-1.0_f64).powi(k as i32) * power(k) / base;
        assert_series(&recip, expected, KNOWN, |k| expected(k).abs());
        let sqrt = compose(s.sqrt(), &at);
        let expected = |k: usize| binomial(0.5, k) * base.sqrt() * power(k);
        assert_series(&sqrt, expected, KNOWN, |k| expected(k).abs());
        for p in [0.37, -1.21, 3.5] {
            let powf = compose(s.powf(p), &at);
            let expected = |k: usize| binomial(p, k) * base.powf(p) * power(k);
            assert_series(&powf, expected, KNOWN, |k| expected(k).abs());
        }
        let exp = compose(s.exp(), &at);
        let expected = |k: usize| base.exp() * inverse_factorial(k);
        assert_series(&exp, expected, KNOWN, |k| expected(k).abs());
        let quarter = |k: usize| std::f64::consts::FRAC_PI_2 * k as f64;
        let sin = compose(s.sin(), &at);
        let expected = |k: usize| (base + quarter(k)).sin() * inverse_factorial(k);
        assert_series(&sin, expected, KNOWN, inverse_factorial);
        let cos = compose(s.cos(), &at);
        let expected = |k: usize| (base + quarter(k)).cos() * inverse_factorial(k);
        assert_series(&cos, expected, KNOWN, inverse_factorial);
        // dᵏ atan/dsᵏ = (k−1)! cosᵏφ sin k(φ + π/2), φ = atan s.
        let phi = base.atan();
        let atan = compose(s.atan(), &at);
        let magnitude = |k: usize| phi.cos().powi(k as i32) / k.max(1) as f64;
        let expected = |k: usize| match k {
            0 => phi,
            _ => magnitude(k) * (k as f64 * (phi + std::f64::consts::FRAC_PI_2)).sin(),
        };
        assert_series(&atan, expected, 3.0 * KNOWN, |k| {
            magnitude(k).max(expected(k).abs())
        });
    }
}

#[test]
fn abs_takes_the_branch_of_the_base_value() {
    let s = SPEED;
    for (base, sign) in [(0.3, -1.0), (1.0, 1.0), (1.5, 1.0)] {
        let inner = wavy(base);
        let actual = compose((s - 1.0).abs(), &inner);
        let shifted = |k: usize| inner[k] - if k == 0 { 1.0 } else { 0.0 };
        assert_series(
            &actual,
            |k| sign * shifted(k),
            f64::EPSILON,
            |k| shifted(k).abs(),
        );
    }
    let (below, above) = (s.exp(), s.sin() + s * s);
    let law = Expression::below(0.5, below, above);
    for (base, chosen) in [(0.4, below), (0.5, above)] {
        let inner = wavy(base);
        assert_eq!(compose(law, &inner), compose(chosen, &inner));
    }
}

/// Radius of the circle for [`contour`].
const RADIUS: f64 = 0.9;

/// Taylor coefficients of f(s(t)) by the trapezoidal rule for Cauchy's integral on |t| =
/// [`RADIUS`], which shares nothing with the recurrences; and the largest |f| on the circle.
fn contour(f: Expression, inner: &Inner) -> ([f64; ORDERS], f64) {
    const POINTS: usize = 512;
    let mut sums = [Complex::new(0.0, 0.0); ORDERS];
    let mut largest = 0.0_f64;
    for j in 0..POINTS {
        let angle = std::f64::consts::TAU * j as f64 / POINTS as f64;
        let t = Complex::from_polar(RADIUS, angle);
        let s = inner
            .iter()
            .rev()
            .fold(Complex::new(0.0, 0.0), |sum, &c| sum * t + c);
        let value = f.complex(s);
        largest = largest.max(value.norm());
        for (k, sum) in sums.iter_mut().enumerate() {
            *sum += value * Complex::from_polar(1.0, -angle * k as f64);
        }
    }
    let coefficient = |k: usize| sums[k].re / POINTS as f64 / RADIUS.powi(k as i32);
    (std::array::from_fn(coefficient), largest)
}

/// Compares the series of an expression with its contour integral in complex numbers.
#[track_caller]
fn check(inner: &Inner, law: Expression) {
    let (expected, largest) = contour(law, inner);
    // Coefficients of a function below `largest` on the circle are below largest/RADIUS^k.
    let magnitude = |k: usize| largest / RADIUS.powi(k as i32);
    assert_slopes_agree(inner, law);
    assert_series(&compose(law, inner), |k| expected[k], 1e-13, magnitude);
}

/// Asserts that df/dt = f'(s) ds/dt, with the series of f' by a number with a tangent.
#[track_caller]
fn assert_slopes_agree(inner: &Inner, law: Expression) {
    let (mut tape, mut plain) = (Tape::new(), Tape::new());
    let mut slopes = [0.0; ORDERS];
    for (k, slope) in slopes.iter_mut().enumerate() {
        let found = tape.run(k, |run| {
            let number = law.kinetic(Dual::along(run.variable(inner[k]), 1.0));
            match number.tangent {
                Tangent::Varying(tangent) => tangent.coefficient(),
                Tangent::Constant(c) if k == 0 => c,
                Tangent::Constant(_) => 0.0,
            }
        });
        *slope = found;
    }
    let whole = law.kinetic(Dual::along(PowerSeries::from_fn(|k| inner[k]), 1.0));
    let mut at_once = slopes;
    at_once[..TERMS].copy_from_slice(whole.derivative().coefficients());
    assert_jets_agree(&slopes, &at_once);
    let series = compose_by_jets(&mut plain, law, 0, inner);
    let mut magnitude = 0.0_f64;
    for k in 0..ORDERS - 1 {
        let terms = |l: usize| slopes[l] * (k - l + 1) as f64 * inner[k - l + 1];
        let found: f64 = (0..=k).map(terms).sum();
        let sizes: f64 = (0..=k).map(|l| terms(l).abs()).sum();
        let expected = (k + 1) as f64 * series[k + 1];
        magnitude = (magnitude / RADIUS).max(sizes).max(expected.abs());
        let apart = (found - expected).abs();
        assert!(
            apart <= 1e-12 * magnitude,
            "order {k}: {found:e}, not {expected:e}"
        );
    }
}

#[test]
fn every_operation_composes_with_a_series() {
    let s = SPEED;
    for inner in &[wavy(0.7), wavy(0.0), wavy(1.9), line(0.0), line(0.7)] {
        check(inner, s.exp());
        check(inner, (s * -2.0 + 0.5).exp());
        check(inner, (s * s * -1.5).exp() * 0.15 + 0.25);
        check(inner, (s + 1.5).ln());
        check(inner, (s * -0.3 + 2.0).ln());
        check(inner, (s + 1.5).sqrt());
        check(inner, (-s * 0.2 + 3.0).sqrt() * -2.0);
        check(inner, (s + 1.5).powf(-1.3));
        check(inner, (s * 0.4 + 1.5).powf(2.7));
        check(inner, s.powi(5));
        check(inner, (s * -0.5 + 3.0).powi(-4));
        check(inner, s.tanh());
        check(inner, (s * -1.5 + 1.0).tanh());
        check(inner, (s * 0.3 + 0.7).atan());
        check(inner, (s * -0.6).atan());
        check(inner, (s * 0.3 + 0.7).asinh());
        check(inner, (s * -0.6).asinh());
        check(inner, s.sin());
        check(inner, (s * 3.0 - 1.0).sin());
        check(inner, s.cos());
        check(inner, (s * -2.0 + 0.3).cos() / 3.0 - 1.0);
        check(inner, (s + 1.5).recip());
        check(inner, (s * -0.5 + 3.0).recip() * 2.0);
        check(inner, (s * 2.0 - 0.5).square());
        check(inner, s / (s * 0.5 + 1.5));
        check(inner, (s - 2.0) / (-s + 4.0) * 3.0);
        check(inner, (s * 3.0 - 2.0) * (s * 0.5 + 1.0));
        check(inner, s.exp() - s.sin() * 2.0 - s);
    }
}

#[test]
fn operations_on_operations() {
    let s = SPEED;
    for inner in &[wavy(0.7), wavy(0.0)] {
        check(inner, (s.exp() + 1.0).ln());
        check(inner, s.sin().exp() / (s.cos() * 0.4 + 2.0));
        check(inner, (s.exp() * -0.5).asinh() * (s.sin() * 0.3).asinh());
        check(inner, ((s * s + 1.5).sqrt() * -0.5).tanh().atan());
        check(inner, (s.tanh() * 0.5 + 1.0).powf(1.7) * (s.atan() - 2.0));
        check(inner, ((s + 2.0).ln().powi(3) + 4.0).powi(-2));
        check(inner, (s.cos() - s.sin() * 0.5) * (s.cos() - s.sin() * 0.5));
        check(
            inner,
            (-(s.exp() * 0.3)).exp() - (s.exp() * 0.3 + 1.0).powf(-0.5),
        );
        // Friction laws that people use: Stribeck with exponent 1.5 and viscous term, regularised,
        // rational.
        check(inner, (-(s + 0.8).powf(1.5)).exp() * 0.2 + 0.3 + s * 0.01);
        check(inner, (s * 2.0).tanh() * 0.4 + s / (s * s + 2.0) * 0.1);
    }
}

/// Views of a row whose scale is not ±1, of a row that has a rest.
#[test]
fn every_operation_on_scaled_views() {
    let s = SPEED;
    for inner in &[wavy(0.7), wavy(0.0)] {
        let a = s.exp() * 0.3 + 1.2;
        let b = s.sin() * -0.4 + 2.0;
        check(inner, a.recip());
        check(inner, a.square());
        check(inner, a.exp());
        check(inner, a.ln());
        check(inner, a.sqrt());
        check(inner, a.powf(1.3));
        check(inner, a.tanh());
        check(inner, b.atan());
        check(inner, a.asinh());
        check(inner, a.sin());
        check(inner, a.cos());
        check(inner, a * b);
        check(inner, a / b);
        check(inner, a - b);
    }
}

/// A constant made from a number is free of it, even of an infinite slope.
#[test]
fn constants_forget_what_they_were_made_from() {
    let s = SPEED;
    let series = compose(s.sqrt().constant(0.25) + s, &line(0.0));
    let expected: [f64; ORDERS] =
        std::array::from_fn(|k| [0.25, 1.0].get(k).copied().unwrap_or(0.0));
    assert_eq!(series, expected);
}

/// Asserts that two expressions have the same series.
#[track_caller]
fn same(inner: &Inner, (left, right): (Expression, Expression)) {
    let [left, right] = [left, right].map(|law| compose(law, inner));
    let magnitude = |k: usize| right[0].abs().max(1.0) / RADIUS.powi(k as i32);
    assert_series(&left, |k| right[k], 1e-13, magnitude);
}

#[test]
fn operations_agree_with_each_other() {
    let s = SPEED;
    for inner in &[wavy(0.7), wavy(1.4), line(1.2), line(2.0)] {
        same(inner, (s.exp().ln(), s));
        same(inner, (s.ln().exp(), s));
        same(inner, (s.sqrt().square(), s));
        same(inner, (s.sqrt(), s.powf(0.5)));
        same(inner, (s.recip(), s.constant(1.0) / s));
        same(inner, (s.recip(), s.powi(-1)));
        same(inner, (s.recip().recip(), s));
        same(inner, (s.powi(7), s * s * s * s * s * s * s));
        same(inner, (s.powi(-3), (s * s * s).recip()));
        for p in [0.37, -1.21, 2.5] {
            same(inner, (s.powf(p), (s.ln() * p).exp()));
            same(inner, (s.powf(p) * s.powf(-p), s.constant(1.0)));
        }
    }
    for inner in &[wavy(0.7), wavy(0.0), line(0.0), line(0.3)] {
        let one = SPEED.constant(1.0);
        same(inner, (s.sin().square() + s.cos().square(), one));
        same(inner, (s.exp() * (-s).exp(), one));
        same(
            inner,
            (s.tanh(), ((s * 2.0).exp() - 1.0) / ((s * 2.0).exp() + 1.0)),
        );
        same(inner, ((s * 2.0).sin(), s.sin() * s.cos() * 2.0));
        same(
            inner,
            ((s * 2.0).cos(), s.cos().square() - s.sin().square()),
        );
        // sinh(arsinh s) = s.
        let exponential = s.asinh().exp();
        same(inner, ((exponential - exponential.recip()) * 0.5, s));
        // Beyond the size at which s² + 1 is s² to rounding, and beyond that of its overflow.
        for size in [2e8, -3e8, 1e200, -1e300] {
            let logarithm = (s + 1.0).ln() + f64::ln(2.0 * size.abs());
            same(
                inner,
                (((s + 1.0) * size).asinh() * size.signum(), logarithm),
            );
        }
        same(inner, ((s + 1.0).abs(), s + 1.0));
        // tan(atan s) = s and sin(2 atan s) = 2s/(1 + s²).
        same(inner, (s.atan().sin() / s.atan().cos(), s));
        same(
            inner,
            ((s.atan() * 2.0).sin(), s * 2.0 / (s.square() + 1.0)),
        );
    }
}

/// More operations than there are rows kept in place, and every number of rows around that limit.
#[test]
fn a_law_may_have_any_number_of_operations() {
    // Nested as deeply as no law is: unoptimised, they take more stack than a test has.
    let test = std::thread::Builder::new().stack_size(1 << 24);
    let test = test.spawn(many_operations).unwrap();
    test.join().unwrap();
}

fn many_operations() {
    let s = SPEED;
    for inner in &[wavy(0.7), wavy(0.0)] {
        // 14 rounds of sin, +, tanh and a product: 56 operations that own rows.
        let round = |x: Expression| ((x * 0.7).sin() * 0.3 + s * 0.5).tanh() * (s * 0.5 + 1.0);
        check(inner, (0..14).fold(s, |x, _| round(x)));
    }
    for factors in 1..=60 {
        let power = (1..factors).fold(s + 1.0, |product, _| product * (s + 1.0));
        let expected = |k: usize| binomial(f64::from(factors), k);
        assert_series(&compose(power, &line(0.0)), expected, KNOWN, expected);
    }
}

/// One workspace serves pieces with different sequences of operations: nothing old leaks into a new
/// series.
#[test]
fn a_workspace_keeps_nothing_between_series() {
    let s = SPEED;
    let pieces = Expression::pieces(vec![
        s.exp(),
        (s.tanh() * s.atan() + (s + 2.0).powf(0.7)).ln() / (s.cos() + 3.0).sqrt(),
        s * s + s.sin(),
        s.powi(9) - s.powi(-5) + (s * s + 1.0).recip().tanh().sin().exp(),
    ]);
    let (mut workspace, mut tape) = (Workspace::new(), Tape::new());
    for round in 0..3 {
        for piece in [0, 3, 1, 0, 2, 1, 3, 2] {
            let inner = wavy(0.5 + 0.3 * f64::from(round));
            let used = compose_in(&mut workspace, pieces, piece, &inner);
            let fresh = compose_in(&mut Workspace::new(), pieces, piece, &inner);
            assert_eq!(used, fresh, "piece {piece}");
            let used = compose_by_jets(&mut tape, pieces, piece, &inner);
            let fresh = compose_by_jets(&mut Tape::new(), pieces, piece, &inner);
            assert_eq!(used, fresh, "piece {piece}");
        }
    }
}

/// `derivative` to order 30 against closed forms, and `slope`, `curvature` as its first two.
#[test]
fn derivatives_of_laws_to_order_thirty() {
    // dⁿ exp(−s²) = (−1)ⁿ Hₙ(s) exp(−s²), Hₙ₊₁ = 2s Hₙ − 2n Hₙ₋₁ (Abramowitz and Stegun 22.7.13).
    let gaussian = (SPEED.square() * -1.0).exp();
    for s in [0.0, 0.25, 1.0, 2.0] {
        let (mut before, mut hermite, mut magnitude) = (0.0, 1.0_f64, 1.0_f64);
        let mut magnitude_before = 0.0;
        for n in 0..=30 {
            let expected = hermite * (-s * s).exp() * (-1.0_f64).powi(n);
            let actual = gaussian.derivative(n as usize, s);
            let allowed = 1e-13 * magnitude * (-s * s).exp();
            assert!(
                (actual - expected).abs() <= allowed,
                "n = {n}, s = {s}: {actual:e} {expected:e}"
            );
            let twice = 2.0 * f64::from(n);
            (before, hermite) = (hermite, 2.0 * s * hermite - twice * before);
            (magnitude_before, magnitude) =
                (magnitude, 2.0 * s * magnitude + twice * magnitude_before);
        }
        assert_eq!(gaussian.slope(s), gaussian.derivative(1, s));
        assert_eq!(gaussian.curvature(s), gaussian.derivative(2, s));
        assert!(gaussian.derivative(31, s).is_nan());
        assert!(gaussian.derivative(usize::MAX, s).is_nan());
    }
    let cubic = crate::Polynomial::new(0.4, 0.25, 0.5).unwrap();
    let derivatives: Vec<f64> = (0..=5).map(|n| cubic.derivative(n, 0.0)).collect();
    approx::assert_relative_eq!(
        derivatives[..],
        [0.4, -0.45, 0.0, 3.6, 0.0, 0.0][..],
        epsilon = 1e-15
    );
}

/// Every method of `Scalar` for `f64` is the number's own.
#[test]
fn f64_is_itself() {
    fn all<S: Scalar>(s: S) -> [f64; 18] {
        [
            s.constant(0.1),
            -s,
            s + s,
            s - s * 2.0,
            s * s,
            s.constant(1.0) / s,
            s.recip(),
            s.square(),
            s.exp(),
            s.ln(),
            s.sqrt(),
            s.powi(-3),
            s.powf(1.7),
            s.tanh(),
            s.atan(),
            s.asinh(),
            s.sin(),
            s.cos(),
        ]
        .map(Scalar::value)
    }
    for x in [1e-300_f64, 0.3, 1.0, 7.25, 300.0] {
        let expected = [
            0.1,
            -x,
            x + x,
            x - x * 2.0,
            x * x,
            1.0 / x,
            x.recip(),
            x * x,
            x.exp(),
            x.ln(),
            x.sqrt(),
            x.powi(-3),
            x.powf(1.7),
            x.tanh(),
            x.atan(),
            x.asinh(),
            x.sin(),
            x.cos(),
        ];
        assert_eq!(all(x), expected);
    }
    assert_eq!(Scalar::abs(-2.0), 2.0);
}

/// Two coupled equations, advanced one order at a time on one tape: x' = xy, y' = −x², from
/// (1, 1).
#[test]
fn coupled_series_advance_order_by_order() {
    let mut tape = Tape::new();
    let (mut x, mut y) = ([1.0; LONGEST], [1.0; LONGEST]);
    for k in 0..LONGEST - 1 {
        let rates = tape.run(k, |run| {
            let (x, y) = (run.variable(x[k]), run.input(y[k]));
            [(x * y).coefficient(), (-x.square()).coefficient()]
        });
        [x[k + 1], y[k + 1]] = rates.map(|rate| rate / (k + 1) as f64);
    }
    // x² + y² = 2: with a = √2, y = a tanh(c − at), x = a/cosh(c − at), tanh c = 1/a.
    let a = 2.0_f64.sqrt();
    let exact = ((SPEED * -a) + (1.0 / a).atanh()).tanh() * a;
    let exact = compose(exact, &line(0.0));
    assert_series(
        &std::array::from_fn(|k| y[k]),
        |k| exact[k],
        1e-13,
        |k| 0.7_f64.powi(-(k as i32)),
    );
}

#[test]
fn coefficients_about_a_point_in_one_call() {
    let law = (SPEED * 0.5).exp();
    let piece = Piece {
        law: &law,
        index: 0,
    };
    let mut series = [f64::NAN; 5];
    jet::coefficients(piece, 0.0, &mut series);
    assert_eq!(series, [1.0, 0.5, 0.125, 0.125 / 6.0, 0.125 / 48.0]);
    let mut value = [f64::NAN];
    jet::coefficients(piece, 0.0, &mut value);
    assert_eq!(value, [1.0]);
}
