//! Power series in the time since the start of a step, with as many terms as the integrators use.

// | file | what is in it |
// |---|---|
// | `mod.rs` | `TERMS`, the number of coefficients; `PowerSeries`: values, means, derivative, reflection, division by known roots |
// | `roots.rs` | the first root, and all sign changes, isolated so that none is skipped |
// | `event_distance.rs` | `EventDistance`: the first time at which a quantity reaches zero, apart from known roots at the start |
// | `minima.rs` | where a series comes close to zero |
// | `number.rs` | a series as a number on which laws are evaluated |
// | `many.rs` | the values of two series at many times |

mod event_distance;
pub(crate) mod many;
mod minima;
mod number;
mod roots;
#[cfg(test)]
mod roots_tests;
#[cfg(test)]
mod tests;

pub(crate) use event_distance::EventDistance;
pub(crate) use roots::TooCurved;

use std::ops::{Index, IndexMut};

use crate::scalar::lanes::{self, times};
use crate::scalar::{LONGEST, fused, mul_add};

/// Number of coefficients of a step's series, whose order is 26.
///
/// No order is faster for the usual tolerance, round-off, at equal achieved error; at looser
/// tolerances a lower one would save up to a quarter, and double what is compiled for each law.
/// Time per cycle of the polynomial law with the loosest tolerance that keeps within an error of
/// event times, in units of order 26, native build on a Zen 5 core, and the time of a step:
///
/// ```text
/// order          14     17     20     23     26     29
/// 1e-4         0.76   0.82   0.93   0.85   1      1.20
/// 1e-6         0.80   0.91   0.90   0.86   1      1.02
/// 1e-8         1.06   1.01   1.03   0.98   1      1.20
/// 1e-10        1.29   1.17   1.12   0.98   1      1.21
/// 1e-12        1.52   1.28   1.16   1.06   1      1.20
/// 2e-13        1.60    -     1.04   1.06   1      1.07
/// a step       0.49   0.65   0.74   0.84   1      1.22
/// ```
///
/// Steps come in whole numbers a cycle, 4 to 8 at order 26, so a ratio may be off by a step. The
/// number is a multiple of three, for [`PowerSeries::at`].
pub(crate) const TERMS: usize = 27;

const _: () = assert!(TERMS.is_multiple_of(3) && TERMS < LONGEST);

/// Weights 1/(k + 1) of an integral: that of t^k is t^(k+1)/(k+1).
pub(crate) const INTEGRAL: [f64; TERMS] = {
    let mut weights = [0.0; TERMS];
    let mut k = 0;
    while k < TERMS {
        weights[k] = 1.0 / (k + 1) as f64;
        k += 1;
    }
    weights
};

/// The times h/4, h/2, 3h/4 and h, at which a step is checked.
#[inline(always)]
pub(crate) fn quarters(h: f64) -> [f64; 4] {
    [0.25 * h, 0.5 * h, 0.75 * h, h]
}

/// A power series c(t) = c_0 + c_1 t + … + c_26 t²⁶. Not exported.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PowerSeries([f64; TERMS]);

impl PowerSeries {
    pub(crate) const ZERO: Self = Self([0.0; TERMS]);

    /// The series with the coefficient `c(k)` of t^k.
    pub(crate) fn from_fn(c: impl FnMut(usize) -> f64) -> Self {
        Self(std::array::from_fn(c))
    }

    /// The first coefficient that is not 0.
    pub(crate) fn first_nonzero(&self) -> Option<f64> {
        self.0.iter().copied().find(|c| *c != 0.0)
    }

    /// The coefficient c_k; 0 beyond the last.
    #[inline(always)]
    fn get(&self, k: usize) -> f64 {
        self.0.get(k).map_or(0.0, |c| *c)
    }

    /// The value c(t). Not inlined: a call costs little relative to the sum, and copies would be
    /// much code.
    #[inline(never)]
    pub(crate) fn at(&self, t: f64) -> f64 {
        if t > FAR {
            return sum_far(t, |k| self.0[k]);
        }
        sum_of_powers(t, |k| self.0[k])
    }

    /// The values of c at four times at once, each summed in four chains: powers 0, 4, 8, …, powers
    /// 1, 5, 9, … and so on.
    ///
    /// The next step waits for these values, so short chains count: two chains of twice the length
    /// make a whole step 3 % slower.
    #[inline(always)]
    pub(crate) fn at_four(&self, t: [f64; 4]) -> [f64; 4] {
        const TOP: usize = (TERMS - 1) / 4 * 4;
        let t2 = t.map(|t| t * t);
        let t4 = t2.map(|t2| t2 * t2);
        let mut chains = std::array::from_fn::<_, 4, _>(|j| [self.get(TOP + j); 4]);
        for k in (0..TOP).step_by(4).rev() {
            for (j, chain) in chains.iter_mut().enumerate() {
                for (lane, t4) in std::iter::zip(chain, t4) {
                    *lane = mul_add(*lane, t4, self.0[k + j]);
                }
            }
        }
        std::array::from_fn(|i| {
            let low = mul_add(chains[1][i], t[i], chains[0][i]);
            let high = mul_add(chains[3][i], t[i], chains[2][i]);
            mul_add(high, t2[i], low)
        })
    }

    /// Computes [`at_four`](Self::at_four) where speed does not count: one copy of the code for all
    /// callers.
    #[inline(never)]
    pub(crate) fn at_some(&self, t: [f64; 4]) -> [f64; 4] {
        self.at_four(t)
    }

    /// The values at the [`quarters`] of h, and the bound of |c''| on [0, h], with the fused
    /// instructions of the processor, if it has them: their last bits depend on it.
    #[inline(never)]
    pub(crate) fn survey(&self, h: f64) -> ([f64; 4], f64) {
        let mut found = ([0.0; 4], h);
        fused::compute(
            self,
            &mut found,
            #[inline(always)]
            |c, (values, curvature)| {
                *values = quarters(*curvature);
                c.in_lanes::<true>(values);
                *curvature = c.curvature_in_lanes::<true>(*curvature);
            },
            |c, (values, curvature)| {
                *values = quarters(*curvature);
                c.in_lanes::<false>(values);
                *curvature = c.curvature_in_lanes::<false>(*curvature);
            },
        );
        found
    }

    /// Puts values in the place of times: the four chains of [`at_four`](Self::at_four) in the
    /// lanes of one register, one time after the other. Times in its lanes would have to wait: they
    /// have just been stored one by one.
    #[inline(always)]
    fn in_lanes<const CHOSEN: bool>(&self, values: &mut [f64; 4]) {
        const TOP: usize = (TERMS - 1) / 4 * 4;
        let part = |k: usize| {
            [
                self.get(k),
                self.get(k + 1),
                self.get(k + 2),
                self.get(k + 3),
            ]
        };
        for value in values {
            let t = *value;
            let t2 = t * t;
            let t4 = [t2 * t2; 4];
            let mut sums = part(TOP);
            for k in (0..TOP).step_by(4).rev() {
                sums = lanes::mul_add::<CHOSEN>(sums, t4, part(k));
            }
            *value = (sums[0] + sums[1] * t) + (sums[2] + sums[3] * t) * t2;
        }
    }

    /// [`curvature_bound`](Self::curvature_bound) from four powers in the lanes of one register.
    #[inline(always)]
    fn curvature_in_lanes<const CHOSEN: bool>(&self, t: f64) -> f64 {
        const TOP: usize = (TERMS - 1) / 4;
        let t2 = t * t;
        let t4 = [t2 * t2; 4];
        let mut sums = [0.0; 4];
        for block in (0..=TOP).rev() {
            let k = 4 * block;
            let sizes = [
                self.get(k + 2).abs(),
                self.get(k + 3).abs(),
                self.get(k + 4).abs(),
                self.get(k + 5).abs(),
            ];
            let factor = |k: usize| ((k + 2) * (k + 1)) as f64;
            let factors = [factor(k), factor(k + 1), factor(k + 2), factor(k + 3)];
            sums = lanes::mul_add::<CHOSEN>(sums, t4, times(factors, sizes));
        }
        (sums[0] + sums[1] * t) + (sums[2] + sums[3] * t) * t2
    }

    pub(crate) fn coefficients(&self) -> &[f64] {
        &self.0
    }

    /// Mean of c over [0, t].
    #[inline(always)]
    pub(crate) fn mean(&self, t: f64) -> f64 {
        if t > FAR {
            return sum_far(t, |k| self.0[k] * INTEGRAL[k]);
        }
        sum_of_powers(t, |k| self.0[k] * INTEGRAL[k])
    }

    /// The integral over [0, t] of the integral of c, divided by t²: Σ c_k t^k/((k + 1)(k + 2)).
    pub(crate) fn twice_integrated(&self, t: f64) -> f64 {
        Self::from_fn(|k| self.0[k] / ((k + 1) * (k + 2)) as f64).at(t)
    }

    /// Least and largest value on [0, h].
    pub(crate) fn extremes(&self, h: f64) -> (f64, f64) {
        let (start, end) = (self.at(0.0), self.at(h));
        let (mut least, mut largest) = (start.min(end), start.max(end));
        self.derivative().sign_changes(h, &mut |t, _| {
            let value = self.at(t);
            (least, largest) = (least.min(value), largest.max(value));
        });
        (least, largest)
    }

    /// The derivative dc/dt.
    #[inline(never)]
    pub(crate) fn derivative(&self) -> Self {
        Self::from_fn(|k| (k + 1) as f64 * self.get(k + 1))
    }

    /// The value of dc/dt.
    #[inline(never)]
    pub(crate) fn slope_at(&self, t: f64) -> f64 {
        sum_of_powers(t, |k| (k + 1) as f64 * self.get(k + 1))
    }

    /// Replaces the series by that of c(h − t).
    pub(crate) fn reflect(&mut self, h: f64) {
        *self = self.shifted(h);
        for [_, odd] in self.0.as_chunks_mut().0 {
            *odd = -*odd;
        }
    }

    /// The series of c(start + t).
    pub(crate) fn shifted(&self, start: f64) -> Self {
        let mut shifted = self.0;
        // A bound known at run time only, so that the loops are not unrolled into 6 kB of code.
        let last = self.0.iter().rposition(|c| *c != 0.0).unwrap_or(0);
        for first in 0..last {
            for k in (first..last).rev() {
                shifted[k] += start * shifted[k + 1];
            }
        }
        Self(shifted)
    }

    /// The series of factor·c(t).
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        // Not by `map`, which is not compiled to vectors.
        let mut scaled = Self::ZERO;
        for (scaled, c) in std::iter::zip(&mut scaled.0, &self.0) {
            *scaled = c * factor;
        }
        scaled
    }

    /// Adds factor·c(t).
    pub(crate) fn add(&mut self, factor: f64, other: &Self) {
        for (c, other) in std::iter::zip(&mut self.0, &other.0) {
            *c += factor * other;
        }
    }

    /// The series of c(t)/t^order: a known root at t = 0 is divided out. The first `order`
    /// coefficients are taken to be 0.
    pub(crate) fn without_root(&self, order: usize) -> Self {
        let mut series = Self::ZERO;
        for (c, later) in std::iter::zip(&mut series.0, self.0.iter().skip(order)) {
            *c = *later;
        }
        series
    }

    /// Bound of |d²c/dt²| on [0, t]: Σ k(k−1)|c_k| t^(k−2).
    #[inline(never)]
    fn curvature_bound(&self, t: f64) -> f64 {
        sum_of_powers(t, |k| ((k + 2) * (k + 1)) as f64 * self.get(k + 2).abs())
    }

    /// Bound of the rounding error of [`at`](Self::at) anywhere on [0, t]: Σ (k/2 + 4)·ε|c_k| t^k.
    fn rounding_bound(&self, t: f64) -> f64 {
        f64::EPSILON * sum_of_powers(t, |k| (0.5 * k as f64 + 4.0) * self.0[k].abs())
    }
}

impl From<[f64; TERMS]> for PowerSeries {
    #[inline(always)]
    fn from(coefficients: [f64; TERMS]) -> Self {
        Self(coefficients)
    }
}

impl Index<usize> for PowerSeries {
    type Output = f64;
    #[inline(always)]
    fn index(&self, k: usize) -> &f64 {
        &self.0[k]
    }
}

impl IndexMut<usize> for PowerSeries {
    #[inline(always)]
    fn index_mut(&mut self, k: usize) -> &mut f64 {
        &mut self.0[k]
    }
}

/// Σ c(k) t^k in three interleaved chains, so that the latency of one multiply-add is shared by
/// three.
///
/// Why not four chains: the compiler would vectorise them, and its wide loads would stall on
/// coefficients that were just written one by one.
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

/// A time whose powers may overflow. Only rest and motions without springs last so long.
const FAR: f64 = 1e100;

/// Sums a series with few terms at a time beyond [`FAR`].
#[inline(never)]
fn sum_far(t: f64, c: impl Fn(usize) -> f64) -> f64 {
    let terms = (0..TERMS)
        .rposition(|k| c(k) != 0.0)
        .map_or(0, |last| last + 1);
    (0..terms).rev().fold(0.0, |sum, k| sum * t + c(k))
}

/// Σ c_k t^k, with 0 for all further coefficients.
#[cfg(test)]
impl<const N: usize> From<&[f64; N]> for PowerSeries {
    fn from(coefficients: &[f64; N]) -> Self {
        Self::from(&coefficients[..])
    }
}

#[cfg(test)]
impl From<&[f64]> for PowerSeries {
    fn from(coefficients: &[f64]) -> Self {
        let mut c = Self::ZERO;
        c.0[..coefficients.len()].copy_from_slice(coefficients);
        c
    }
}
