//! A whole power series as a number: a friction law that is evaluated on the series of its inputs
//! gives its own series along the motion. Used where all inputs are known beforehand; where the
//! law's own coefficients determine the next ones, see `scalar/mod.rs`.
//!
//! Each operation computes all orders before the next operation begins, and is compiled once for
//! all laws. The recurrences are those of `scalar/operations.rs`; most are of the form
//!
//! ```text
//! y_k = r_k + f_k Σ w_i y_{k−i}    (0 < i ≤ k)
//! ```

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::{PowerSeries, TERMS};
use crate::scalar::lanes::{self, LANES, Lanes};
use crate::scalar::{
    INVERSE, LONGEST, Scalar, fused, integral, power_by_squaring, root_beside_one, sealed,
};

/// Number of groups of four coefficients.
const GROUPS: usize = TERMS.div_ceil(LANES);

/// Number of coefficients in whole groups.
const ROUND: usize = GROUPS * LANES;

/// Coefficients after as many zeros, so that every sum runs over whole groups.
struct Shifted([f64; 2 * ROUND]);

impl Shifted {
    #[inline(always)]
    fn new(series: &PowerSeries) -> Self {
        let mut shifted = [0.0; 2 * ROUND];
        shifted[ROUND..][..TERMS].copy_from_slice(&series.0);
        Self(shifted)
    }
}

/// Σ x_i w_{k−i} over i < `end`, an even number, for k = `first` and the three after it.
#[inline(always)]
fn sum<const CHOSEN: bool>(x: &[f64; ROUND], end: usize, w: &Shifted, first: usize) -> Lanes {
    let pairs = x[..end].as_chunks::<2>().0;
    // From w_{first − 1} to w_{first + 3}, then two earlier for each pair.
    let start = ROUND + first;
    let windows = w.0[start + 1 - end..start + LANES].windows(LANES + 1);
    // Two sums at a time, because a single one would wait for each of its terms.
    let mut sums = [[0.0; LANES]; 2];
    for (pair, w) in std::iter::zip(pairs, windows.rev().step_by(2)) {
        let (earlier, later) = ([w[0], w[1], w[2], w[3]], [w[1], w[2], w[3], w[4]]);
        sums[0] = lanes::mul_add::<CHOSEN>([pair[0]; LANES], later, sums[0]);
        sums[1] = lanes::mul_add::<CHOSEN>([pair[1]; LANES], earlier, sums[1]);
    }
    lanes::plus(sums[0], sums[1])
}

/// Σ a_i b_{k−i} for all k.
#[inline(never)]
fn product(a: &PowerSeries, b: &PowerSeries) -> PowerSeries {
    #[inline(always)]
    fn by<const CHOSEN: bool>([a, b]: [&PowerSeries; 2], product: &mut PowerSeries) {
        let mut round = [0.0; ROUND];
        round[..TERMS].copy_from_slice(&a.0);
        let b = Shifted::new(b);
        for (group, product) in product.0.chunks_mut(LANES).enumerate() {
            let first = LANES * group;
            let sum = sum::<CHOSEN>(&round, first + LANES, &b, first);
            product.copy_from_slice(&sum[..product.len()]);
        }
    }
    let mut found = PowerSeries::ZERO;
    fused::compute(
        &[a, b],
        &mut found,
        #[inline(always)]
        |series, product| by::<true>(*series, product),
        |series, product| by::<false>(*series, product),
    );
    found
}

/// The solution of y_k = r_k + f_k Σ w_i y_{k−i} with 0 < i ≤ k; y_0 = r_0.
#[inline(never)]
fn solution(w: &PowerSeries, factors: &[f64; LONGEST], right: &PowerSeries) -> PowerSeries {
    #[inline(always)]
    fn by<const CHOSEN: bool>(
        (w, factors, right): (&PowerSeries, &[f64; LONGEST], &PowerSeries),
        found: &mut PowerSeries,
    ) {
        let shifted = Shifted::new(w);
        let mut y = [0.0; ROUND];
        for first in (0..TERMS).step_by(LANES) {
            let older = sum::<CHOSEN>(&y, first, &shifted, first);
            for k in first..TERMS.min(first + LANES) {
                let mut sum = older[k - first];
                for i in first..k {
                    sum = fused::mul_add_in::<CHOSEN>(w[k - i], y[i], sum);
                }
                y[k] = fused::mul_add_in::<CHOSEN>(factors[k], sum, right[k]);
            }
        }
        found.0.copy_from_slice(&y[..TERMS]);
    }
    let mut found = PowerSeries::ZERO;
    fused::compute(
        &(w, factors, right),
        &mut found,
        #[inline(always)]
        |given, found| by::<true>(*given, found),
        |given, found| by::<false>(*given, found),
    );
    found
}

impl PowerSeries {
    /// The series of a constant.
    pub(crate) fn of(value: f64) -> Self {
        let mut series = Self::ZERO;
        series[0] = value;
        series
    }

    /// The series k c_k.
    fn weighted(&self) -> Self {
        Self::from_fn(|k| k as f64 * self[k])
    }

    /// The solution of y' = rate·y, from its value at 0.
    fn growing(value: f64, rate: &Self) -> Self {
        let weights = Self::from_fn(|k| if k == 0 { 0.0 } else { rate[k - 1] });
        solution(&weights, &INVERSE, &Self::of(value))
    }

    /// The series whose derivative this is, of a function with a value at 0.
    fn integral_from(&self, value: f64) -> Self {
        Self::from_fn(|k| match k {
            0 => value,
            k => self[k - 1] * INVERSE[k],
        })
    }

    /// The power y of this series a with its value at 0: a·y' = p·y·a'.
    fn power(&self, value: f64, p: f64) -> Self {
        let mut y = Self::of(value);
        for k in 1..TERMS {
            let part = (p + 1.0) * INVERSE[k];
            let term = |i: usize| (part * i as f64 - 1.0) * self[i] * y[k - i];
            y[k] = (1..=k).map(term).sum::<f64>() / self[0];
        }
        y
    }

    /// S' = C·a', C' = −S·a'.
    fn sin_cos(self) -> [Self; 2] {
        let weighted = self.weighted();
        let (sine, cosine) = self[0].sin_cos();
        let [mut s, mut c] = [sine, cosine].map(Self::of);
        for k in 1..TERMS {
            let sum = |y: &Self| (1..=k).map(|i| weighted[i] * y[k - i]).sum::<f64>();
            [s[k], c[k]] = [sum(&c) * INVERSE[k], -sum(&s) * INVERSE[k]];
        }
        [s, c]
    }
}

impl sealed::Sealed for PowerSeries {}

impl Scalar for PowerSeries {
    fn constant(self, c: f64) -> Self {
        Self::of(c)
    }

    fn value(self) -> f64 {
        self[0]
    }

    fn recip(self) -> Self {
        Self::of(1.0) / self
    }

    fn square(self) -> Self {
        product(&self, &self)
    }

    /// y' = y·a'.
    fn exp(self) -> Self {
        Self::growing(self[0].exp(), &self.derivative())
    }

    /// y' = a'/a.
    fn ln(self) -> Self {
        (self.derivative() / self).integral_from(self[0].ln())
    }

    fn sqrt(self) -> Self {
        self.power(self[0].sqrt(), 0.5)
    }

    fn powi(self, exponent: i32) -> Self {
        power_by_squaring(self, exponent)
    }

    fn powf(self, exponent: f64) -> Self {
        match integral(exponent) {
            Some(exponent) => self.powi(exponent),
            None => self.power(self[0].powf(exponent), exponent),
        }
    }

    /// y' = g·a', g = 1 − y².
    fn tanh(self) -> Self {
        let weighted = self.weighted();
        let mut y = Self::of(self[0].tanh());
        let mut g = Self::of(self[0].cosh().powi(-2));
        for k in 1..TERMS {
            y[k] = (1..=k).map(|i| weighted[i] * g[k - i]).sum::<f64>() * INVERSE[k];
            g[k] = -(0..=k).map(|i| y[i] * y[k - i]).sum::<f64>();
        }
        y
    }

    /// y' = a'/(1 + a²).
    fn atan(self) -> Self {
        (self.derivative() / (self.square() + 1.0)).integral_from(self[0].atan())
    }

    /// y' = a'/√(1 + a²).
    fn asinh(self) -> Self {
        (self.derivative() / root_beside_one(self)).integral_from(self[0].asinh())
    }

    fn sin(self) -> Self {
        self.sin_cos()[0]
    }

    fn cos(self) -> Self {
        self.sin_cos()[1]
    }

    fn abs(self) -> Self {
        if self[0] < 0.0 { -self } else { self }
    }
}

impl Neg for PowerSeries {
    type Output = Self;
    fn neg(self) -> Self {
        self.scaled(-1.0)
    }
}

impl Add for PowerSeries {
    type Output = Self;
    fn add(mut self, other: Self) -> Self {
        PowerSeries::add(&mut self, 1.0, &other);
        self
    }
}

impl Sub for PowerSeries {
    type Output = Self;
    fn sub(mut self, other: Self) -> Self {
        PowerSeries::add(&mut self, -1.0, &other);
        self
    }
}

impl Mul for PowerSeries {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        product(&self, &other)
    }
}

impl Div for PowerSeries {
    type Output = Self;
    /// q·b = a.
    fn div(self, other: Self) -> Self {
        let inverse = other[0].recip();
        solution(&other, &[-inverse; LONGEST], &(self * inverse))
    }
}

impl Add<f64> for PowerSeries {
    type Output = Self;
    fn add(mut self, c: f64) -> Self {
        self[0] += c;
        self
    }
}

impl Sub<f64> for PowerSeries {
    type Output = Self;
    fn sub(mut self, c: f64) -> Self {
        self[0] -= c;
        self
    }
}

impl Mul<f64> for PowerSeries {
    type Output = Self;
    fn mul(self, c: f64) -> Self {
        self.scaled(c)
    }
}

impl Div<f64> for PowerSeries {
    type Output = Self;
    fn div(mut self, c: f64) -> Self {
        for a in &mut self.0 {
            *a /= c;
        }
        self
    }
}
