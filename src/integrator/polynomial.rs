//! Polynomials in the time since the start of a step, and their first root.

use std::cell::Cell;
use std::ops::ControlFlow;

use crate::scalar::mul_add;

/// Coefficients of a step's series: order 26.
///
/// Chosen for round-off, the usual tolerance, where none is faster at equal achieved error; looser
/// ones lose up to a quarter of the time by it (`benches/orders`). A multiple of three, for
/// [`evaluate`].
pub(crate) const TERMS: usize = 27;

/// c_0 + c_1 t + … + c_26 t²⁶.
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

/// Σ c(k) t^k in three interleaved chains, so that the latency of one multiply-add is shared by
/// three.
///
/// Three and not four: four would be vectorised, with loads that span coefficients just written one
/// by one, and stall on them.
#[inline(always)]
fn sum_of_powers(t: f64, c: impl Fn(usize) -> f64) -> f64 {
    let t3 = t * t * t;
    let mut lanes: [f64; 3] = std::array::from_fn(|j| c(TERMS - 3 + j));
    for block in (0..TERMS / 3 - 1).rev() {
        for (j, lane) in lanes.iter_mut().enumerate() {
            *lane = mul_add(*lane, t3, c(3 * block + j));
        }
    }
    mul_add(t, mul_add(t, lanes[2], lanes[1]), lanes[0])
}

/// c(t).
#[inline(always)]
pub(crate) fn evaluate(c: &Polynomial, t: f64) -> f64 {
    sum_of_powers(t, |k| c[k])
}

/// Mean of c over [0, t].
#[inline(always)]
pub(crate) fn mean(c: &Polynomial, t: f64) -> f64 {
    sum_of_powers(t, |k| c[k] * INTEGRAL[k])
}

/// The polynomial dc/dt.
pub(crate) fn derivative(c: &Polynomial) -> Polynomial {
    std::array::from_fn(|k| c.get(k + 1).map_or(0.0, |c| (k + 1) as f64 * c))
}

/// The polynomial c(h − t).
pub(crate) fn reflected(c: &Polynomial, h: f64) -> Polynomial {
    let mut shifted = *c;
    for first in 0..TERMS - 1 {
        for k in (first..TERMS - 1).rev() {
            shifted[k] += h * shifted[k + 1];
        }
    }
    std::array::from_fn(|k| if k % 2 == 0 { shifted[k] } else { -shifted[k] })
}

/// c at four times at once, in four chains each: powers 0, 4, 8, …, powers 1, 5, 9, … and so on.
///
/// The next step waits for this, so short chains count: two of twice the length make a whole step 3
/// % slower.
#[inline(always)]
pub(crate) fn evaluate_four(c: &Polynomial, t: [f64; 4]) -> [f64; 4] {
    const TOP: usize = (TERMS - 1) / 4 * 4;
    let t2 = t.map(|t| t * t);
    let t4 = t2.map(|t2| t2 * t2);
    let mut chains = std::array::from_fn::<_, 4, _>(|j| [c.get(TOP + j).map_or(0.0, |c| *c); 4]);
    for k in (0..TOP).step_by(4).rev() {
        for (j, chain) in chains.iter_mut().enumerate() {
            for (lane, t4) in std::iter::zip(chain, t4) {
                *lane = mul_add(*lane, t4, c[k + j]);
            }
        }
    }
    std::array::from_fn(|i| {
        let low = mul_add(chains[1][i], t[i], chains[0][i]);
        let high = mul_add(chains[3][i], t[i], chains[2][i]);
        mul_add(high, t2[i], low)
    })
}

/// How far the terms of the highest orders stay below `error`: (error/|c_n|)^(1/n) for the last two
/// n, to 6 %.
#[inline(always)]
pub(crate) fn reach(c: &Polynomial, error: f64) -> f64 {
    let by = |n: usize| root_of_ratio(error, c[n].abs(), n);
    by(TERMS - 1).min(by(TERMS - 2)).min(FARTHEST)
}

/// No series is used further, even where its last coefficients vanish: the oscillator turns once in
/// about 2π.
const FARTHEST: f64 = 8.0;

/// (x/y)^(1/n) to 6 %, from the bits of x and y: exponent and mantissa together are nearly a
/// logarithm.
#[inline(always)]
fn root_of_ratio(x: f64, y: f64, n: usize) -> f64 {
    const ONE: i64 = 1.0_f64.to_bits() as i64;
    f64::from_bits((ONE + (x.to_bits() as i64 - y.to_bits() as i64) / n as i64) as u64)
}

/// Bound of |d²c/dt²| on [0, t]: Σ k(k−1)|c_k| t^(k−2).
#[inline(always)]
fn curvature_bound(c: &Polynomial, t: f64) -> f64 {
    sum_of_powers(t, |k| {
        c.get(k + 2)
            .map_or(0.0, |c| ((k + 2) * (k + 1)) as f64 * c.abs())
    })
}

/// Bound of the rounding error of [`evaluate`] anywhere on [0, t]: Σ (k/2 + 4)·ε|c_k| t^k.
fn rounding_bound(c: &Polynomial, t: f64) -> f64 {
    f64::EPSILON * sum_of_powers(t, |k| (0.5 * k as f64 + 4.0) * c[k].abs())
}

/// The quarters of [0, h].
#[inline(always)]
pub(crate) fn quarters(h: f64) -> [f64; 4] {
    [0.25 * h, 0.5 * h, 0.75 * h, h]
}

/// The roots of a polynomial can't be isolated in bounded work, because its coefficients are far
/// larger than its values or it is very flat about a root: use it less far.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TooCurved;

/// Divisions after which a search gives up. Two roots that are almost one take about a hundred.
const MOST_DIVISIONS: usize = 1000;

/// First time in (0, h] at which a polynomial that starts positive becomes zero or negative, to the
/// last bit.
///
/// `values` are its values at the [`quarters`] of h.
#[inline(always)]
pub(crate) fn first_root(
    c: &Polynomial,
    h: f64,
    values: [f64; 4],
) -> Result<Option<f64>, TooCurved> {
    let curvature = curvature_bound(c, h);
    if stays_away(c, h, values, curvature) {
        return Ok(None);
    }
    let mut root = None;
    let search = Search::new(c, h, curvature);
    let _ = search.run(h, values, &mut |t, rising| {
        if rising {
            return ControlFlow::Continue(());
        }
        root = Some(t);
        ControlFlow::Break(())
    });
    if search.divisions.get() < MOST_DIVISIONS {
        Ok(root)
    } else {
        Err(TooCurved)
    }
}

/// Every time in (0, h] at which a polynomial changes sign, in order, with `true` where it rises;
/// the visitor can stop the search.
///
/// A root at t = 0 is not among them. After [`MOST_DIVISIONS`], in stiff systems, the signs found
/// so far decide.
pub(crate) fn sign_changes(
    c: &Polynomial,
    h: f64,
    visit: &mut impl FnMut(f64, bool) -> ControlFlow<()>,
) -> ControlFlow<()> {
    let values = evaluate_four(c, quarters(h));
    let curvature = curvature_bound(c, h);
    if stays_away(c, h, values, curvature) {
        return ControlFlow::Continue(());
    }
    Search::new(c, h, curvature).run(h, values, visit)
}

/// Whether a polynomial is further from zero at 0 and at the quarters of h than it can bend in
/// between, as in most steps.
#[inline(always)]
fn stays_away(c: &Polynomial, h: f64, values: [f64; 4], curvature: f64) -> bool {
    let sign = c[0].signum();
    let least = values
        .iter()
        .fold(c[0].abs(), |least, value| least.min(sign * value));
    least > curvature * h * h / 128.0
}

/// A search for the sign changes of a polynomial on [0, h].
///
/// None is skipped, however close two lie: an interval of width Δ between values p, q of one sign
/// is passed only if min(|p|, |q|) exceeds max|c''|·Δ²/8, and one is taken to hold at most one root
/// only if c is monotone there because |q − p| exceeds max|c''|·Δ²/2. Any other is halved. That
/// ends where Δ is so small that c differs from its chord by less than the rounding error of its
/// values; there the computed signs at the ends decide, so that a tangential touch within rounding
/// is no root.
struct Search<'c> {
    c: &'c Polynomial,
    /// Bound of |c''|.
    curvature: f64,
    /// Bound of the error of a computed value.
    rounding: f64,
    divisions: Cell<usize>,
}

impl<'c> Search<'c> {
    #[inline(never)]
    fn new(c: &'c Polynomial, h: f64, curvature: f64) -> Self {
        Self {
            c,
            curvature,
            rounding: rounding_bound(c, h),
            divisions: Cell::new(0),
        }
    }

    fn run(
        &self,
        h: f64,
        values: [f64; 4],
        visit: &mut impl FnMut(f64, bool) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        // A polynomial that starts at 0 has the sign that it takes first, and a value that doesn't
        // show it to stay away from 0.
        let start = if self.c[0] == 0.0 {
            let first = self.c.iter().find(|c| **c != 0.0);
            first.map_or(0.0, |c| f64::MIN_POSITIVE.copysign(*c))
        } else {
            self.c[0]
        };
        let mut left = (0.0, start);
        for right in std::iter::zip(quarters(h), values) {
            self.between(left, right, visit)?;
            left = right;
        }
        ControlFlow::Continue(())
    }

    /// Sign changes in (a, b], given the values there; zero counts as negative.
    fn between(
        &self,
        (a, at_a): (f64, f64),
        (b, at_b): (f64, f64),
        visit: &mut impl FnMut(f64, bool) -> ControlFlow<()>,
    ) -> ControlFlow<()> {
        let width = b - a;
        let changes = (at_a > 0.0) != (at_b > 0.0);
        let is_settled = |curvature: f64| {
            // Largest distance of c from its chord.
            let sagitta = curvature * width * width / 8.0;
            let monotone = (at_b - at_a).abs() > 4.0 * sagitta + 2.0 * self.rounding;
            let away = !changes && at_a.abs().min(at_b.abs()) > sagitta + self.rounding;
            away || monotone || sagitta <= self.rounding
        };
        let middle = 0.5 * (a + b);
        let exhausted = !(a < middle && middle < b) || self.divisions.get() >= MOST_DIVISIONS;
        let settled = is_settled(self.curvature) || exhausted || {
            // The bound for [0, b] is the smaller the earlier that is, and worth its time where the
            // one for all of [0, h] is too large.
            let curvature = curvature_bound(self.c, b);
            is_settled(curvature) || !curvature.is_finite()
        };
        if settled {
            return if changes {
                visit(self.refine((a, at_a), (b, at_b)), at_b > 0.0)
            } else {
                ControlFlow::Continue(())
            };
        }
        self.divisions.set(self.divisions.get() + 1);
        let at_middle = (middle, evaluate(self.c, middle));
        self.between((a, at_a), at_middle, visit)?;
        self.between(at_middle, (b, at_b), visit)
    }

    /// The root between a and b, where c changes sign once: Newton's method kept inside the
    /// bracket.
    fn refine(&self, (mut a, at_a): (f64, f64), (mut b, at_b): (f64, f64)) -> f64 {
        let slope = derivative(self.c);
        let mut t = b + (b - a) * (at_b / (at_a - at_b));
        if t <= a {
            // So close to a that it is rounded away, or a itself is another root, at the start.
            let newton = a - at_a / evaluate(&slope, a);
            t = if a <= newton && newton < b {
                newton.max(a.next_up())
            } else {
                0.5 * (a + b)
            };
        }
        let mut last = f64::INFINITY;
        // Bisection alone takes some 60 passes; Newton's method three or four.
        for _ in 0..128 {
            let value = evaluate(self.c, t);
            if (value > 0.0) == (at_a > 0.0) {
                a = t;
            } else {
                b = t;
            }
            let slope_here = evaluate(&slope, t);
            let correction = value / slope_here;
            // Quadratic convergence ends where rounding takes over and corrections no longer
            // shrink.
            let settled = correction.abs() <= NEWTON_REGIME * t && correction.abs() >= 0.25 * last;
            if settled || correction.abs() <= 0.5 * f64::EPSILON * t {
                break;
            }
            let newton = t - correction;
            // Largest distance of the next correction from this one.
            let error = 0.5 * self.curvature * correction * correction / slope_here.abs();
            (t, last) = if a < newton && newton < b {
                // And t itself is not so much larger that its rounding would count.
                if error <= 0.25 * f64::EPSILON * newton && correction.abs() <= 0.5 * newton {
                    return newton;
                }
                (newton, correction.abs())
            } else {
                (0.5 * (a + b), f64::INFINITY)
            };
        }
        t
    }
}

/// Relative correction below which Newton's method must be converging quadratically, if it is not
/// at the rounding floor.
const NEWTON_REGIME: f64 = 1e-8;

#[cfg(test)]
mod attack;
#[cfg(test)]
mod tests;
