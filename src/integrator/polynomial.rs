//! Polynomials in the time since the start of a step, and their first root.

use crate::scalar::mul_add;

/// Coefficients of a step's series: order 27.
///
/// Time per unit of τ at equal achieved error is flat between orders 18 and 27 at every tolerance; the upper end takes the
/// fewest steps. A multiple of four, for [`evaluate`].
pub(crate) const TERMS: usize = 28;

/// c_0 + c_1 t + … + c_27 t²⁷.
pub(crate) type Polynomial = [f64; TERMS];

/// 1/(k + 1): the integral of t^k is t^(k+1)/(k+1).
pub(crate) const INTEGRAL: Polynomial = {
    let mut weights = [0.0; TERMS];
    let mut k = 0;
    while k < TERMS {
        weights[k] = 1.0 / (k + 1) as f64;
        k += 1;
    }
    weights
};

/// k(k − 1): the second derivative of t^k is k(k−1) t^(k−2).
const CURVATURE: Polynomial = {
    let mut weights = [0.0; TERMS];
    let mut k = 1;
    while k < TERMS {
        weights[k] = (k * (k - 1)) as f64;
        k += 1;
    }
    weights
};

/// Σ w(c_k, k) t^k in four interleaved chains, so that the latency of one multiply-add is shared by four.
#[inline(always)]
fn evaluate_with(c: &Polynomial, t: f64, weight: impl Fn(f64, usize) -> f64) -> f64 {
    let t2 = t * t;
    let t4 = t2 * t2;
    let mut lanes: [f64; 4] = std::array::from_fn(|j| weight(c[TERMS - 4 + j], TERMS - 4 + j));
    for block in (0..TERMS / 4 - 1).rev() {
        for (j, lane) in lanes.iter_mut().enumerate() {
            *lane = mul_add(*lane, t4, weight(c[4 * block + j], 4 * block + j));
        }
    }
    let [a, b, c, d] = lanes;
    mul_add(t2, mul_add(t, d, c), mul_add(t, b, a))
}

/// c(t).
#[inline(always)]
pub(crate) fn evaluate(c: &Polynomial, t: f64) -> f64 {
    evaluate_with(c, t, |c, _| c)
}

/// Mean of c over [0, t], t ≠ 0.
#[inline(always)]
pub(crate) fn mean(c: &Polynomial, t: f64) -> f64 {
    evaluate_with(c, t, |c, k| c * INTEGRAL[k])
}

/// dc/dt.
#[inline(always)]
pub(crate) fn differentiate(c: &Polynomial, t: f64) -> f64 {
    let mut slope = 0.0;
    for k in (1..TERMS).rev() {
        slope = mul_add(slope, t, k as f64 * c[k]);
    }
    slope
}

/// c at four times at once, even and odd powers in chains of their own.
#[inline(always)]
pub(crate) fn evaluate_four(c: &Polynomial, t: [f64; 4]) -> [f64; 4] {
    let t2 = t.map(|t| t * t);
    let (mut even, mut odd) = ([c[TERMS - 2]; 4], [c[TERMS - 1]; 4]);
    for k in (0..TERMS - 2).step_by(2).rev() {
        for i in 0..4 {
            even[i] = mul_add(even[i], t2[i], c[k]);
            odd[i] = mul_add(odd[i], t2[i], c[k + 1]);
        }
    }
    std::array::from_fn(|i| mul_add(odd[i], t[i], even[i]))
}

/// Bound of |d²c/dt²| on [0, t]: Σ k(k−1)|c_k| t^(k−2).
#[inline(always)]
fn curvature_bound(c: &Polynomial, t: f64) -> f64 {
    let (even, odd) = (t * t, t);
    let (mut sum_even, mut sum_odd) = (0.0, 0.0);
    for k in (2..TERMS).step_by(2).rev() {
        sum_even = mul_add(sum_even, even, CURVATURE[k] * c[k].abs());
        sum_odd = mul_add(sum_odd, even, CURVATURE[k + 1] * c[k + 1].abs());
    }
    mul_add(sum_odd, odd, sum_even)
}

/// Bound of the rounding error of [`evaluate`] anywhere on [0, t]: Σ (k/2 + 4)·ε|c_k| t^k.
fn rounding_bound(c: &Polynomial, t: f64) -> f64 {
    let mut sum = 0.0;
    for k in (0..TERMS).rev() {
        sum = mul_add(sum, t, (0.5 * k as f64 + 4.0) * c[k].abs());
    }
    sum * f64::EPSILON
}

/// The quarters of [0, h].
#[inline(always)]
pub(crate) fn quarters(h: f64) -> [f64; 4] {
    [0.25 * h, 0.5 * h, 0.75 * h, h]
}

/// First time in (0, h] at which a polynomial that starts positive becomes zero or negative, to the last bit.
///
/// `values` are its values at the [`quarters`] of h. No root is skipped, however close two lie: an interval of width Δ
/// between positive values p, q is passed only if min(p, q) exceeds max|c''|·Δ²/8, or if c is monotone there because
/// |q − p| exceeds max|c''|·Δ²/2; otherwise it is halved. It ends where Δ is so small that c differs from a line by less
/// than its rounding error; there the computed sign at the interval's end decides, so that a tangential touch within rounding is no root.
#[inline(always)]
pub(crate) fn first_root(c: &Polynomial, h: f64, values: [f64; 4]) -> Option<f64> {
    let curvature = curvature_bound(c, h);
    let margin = curvature * h * h / 128.0;
    // Most steps: far from contact everywhere.
    let least = values.iter().fold(c[0], |least, &value| least.min(value));
    if least > margin {
        return None;
    }
    first_root_near(c, h, values, curvature)
}

/// The rest of [`first_root`]: some quarter comes close to zero.
#[inline(never)]
fn first_root_near(c: &Polynomial, h: f64, values: [f64; 4], curvature: f64) -> Option<f64> {
    let search = Search {
        c,
        curvature,
        rounding: rounding_bound(c, h),
    };
    let times = quarters(h);
    let mut left = (0.0, c[0]);
    for right in std::iter::zip(times, values) {
        if let Some(root) = search.between(left, right) {
            return Some(root);
        }
        left = right;
    }
    None
}

/// What a search for the first root knows of the polynomial.
struct Search<'c> {
    c: &'c Polynomial,
    /// Bound of |c''|.
    curvature: f64,
    /// Bound of the error of a computed value.
    rounding: f64,
}

impl Search<'_> {
    /// First root in (a, b], given the values there; c(a) > 0 or rounded to 0.
    fn between(&self, (a, at_a): (f64, f64), (b, at_b): (f64, f64)) -> Option<f64> {
        let width = b - a;
        // Largest distance of c from the chord.
        let sagitta = self.curvature * width * width / 8.0;
        let monotone = (at_b - at_a).abs() > 4.0 * sagitta + 2.0 * self.rounding;
        let decided = monotone || at_a.min(at_b) > sagitta + self.rounding;
        let middle = 0.5 * (a + b);
        let divisible = sagitta > self.rounding && a < middle && middle < b;
        if decided || !divisible {
            return (at_b <= 0.0).then(|| self.refine((a, at_a), (b, at_b)));
        }
        let at_middle = (middle, evaluate(self.c, middle));
        self.between((a, at_a), at_middle)
            .or_else(|| self.between(at_middle, (b, at_b)))
    }

    /// The root between a and b, where c changes sign once: Newton's method kept inside the bracket.
    fn refine(&self, (mut a, at_a): (f64, f64), (mut b, at_b): (f64, f64)) -> f64 {
        let mut t = if at_a > at_b {
            b + (b - a) * (at_b / (at_a - at_b))
        } else {
            b
        };
        // Bisection alone would need some 60 halvings; each pass at least halves or converges.
        for _ in 0..128 {
            let value = evaluate(self.c, t);
            if value > 0.0 {
                a = t;
            } else {
                b = t;
            }
            let newton = t - value / differentiate(self.c, t);
            if (newton - t).abs() <= 0.5 * f64::EPSILON * t {
                break;
            }
            t = if a < newton && newton < b {
                newton
            } else {
                0.5 * (a + b)
            };
        }
        t
    }
}
