//! Quadrature to round-off: the trapezoidal rule for smooth periodic integrands, Gauss-Legendre for
//! piecewise smooth ones.

use std::f64::consts::PI;

use crate::error::Error;
use crate::numerics::gauss::gauss_nodes;

/// Integrals of f_1 … f_N over the same interval. `size` is the integral of Σ |f_i|, and `peak` the
/// largest value of that sum.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Integral<const N: usize> {
    pub(crate) parts: [f64; N],
    size: f64,
    pub(crate) peak: f64,
}

impl<const N: usize> Integral<N> {
    pub(crate) const ZERO: Self = Self {
        parts: [0.0; N],
        size: 0.0,
        peak: 0.0,
    };

    fn add(&mut self, weight: f64, value: [f64; N]) {
        for (part, value) in self.parts.iter_mut().zip(value) {
            *part += weight * value;
        }
        let size = value.iter().map(|value| value.abs()).sum::<f64>();
        self.size += weight * size;
        self.peak = self.peak.max(size);
    }

    pub(crate) fn merged(&self, other: &Self) -> Self {
        let mut sum = *other;
        for (sum, part) in sum.parts.iter_mut().zip(self.parts) {
            *sum += part;
        }
        sum.size += self.size;
        sum.peak = sum.peak.max(self.peak);
        sum
    }

    /// Largest difference between a coarse and a fine rule at which the fine rule is accurate to
    /// round-off. The rules converge so fast that the error of the fine rule is smaller than this
    /// difference by many orders. For a narrow integrand, rounding of the argument is the largest
    /// error; it is proportional to the peak.
    fn tolerance(&self) -> f64 {
        1e-12 * self.size + 16.0 * f64::EPSILON * self.peak + f64::MIN_POSITIVE
    }

    fn agrees(&self, other: &Self, tolerance: f64) -> bool {
        self.parts
            .iter()
            .zip(other.parts)
            .all(|(a, b)| (a - b).abs() <= tolerance)
    }
}

/// First comparison: 64 against 128 intervals, so that no feature wider than π/128 is missed.
const COARSEST: usize = 64;
/// Most intervals. An analytic integrand that needs more is nearly singular, and Gauss-Legendre
/// panels are cheaper.
const FINEST: usize = 2048;

/// ∫₀^π f dψ of an even 2π-periodic analytic f, by the trapezoidal rule, which converges
/// geometrically. The intervals are halved until two rules agree; `None` if those with [`FINEST`]
/// do not.
pub(crate) fn trapezoid<const N: usize>(
    mut f: impl FnMut(f64) -> Result<[f64; N], Error>,
) -> Result<Option<Integral<N>>, Error> {
    let mut n = COARSEST;
    let mut sum = Integral::ZERO;
    sum.add(0.5, f(0.0)?);
    sum.add(0.5, f(PI)?);
    for j in 1..n {
        sum.add(1.0, f(PI * j as f64 / n as f64)?);
    }
    let scaled = |sum: &Integral<N>, n: usize| {
        let mut integral = Integral::ZERO.merged(sum);
        let step = PI / n as f64;
        integral.parts = sum.parts.map(|part| part * step);
        integral.size *= step;
        integral
    };
    while n < FINEST {
        let coarse = scaled(&sum, n);
        for j in 0..n {
            sum.add(1.0, f(PI * (j as f64 + 0.5) / n as f64)?);
        }
        n *= 2;
        let fine = scaled(&sum, n);
        if fine.agrees(&coarse, fine.tolerance()) {
            return Ok(Some(fine));
        }
    }
    Ok(None)
}

#[inline(never)]
fn gauss_panel<const N: usize>(
    f: &mut impl FnMut(f64) -> Result<[f64; N], Error>,
    [a, b]: [f64; 2],
) -> Result<Integral<N>, Error> {
    let mut integral = Integral::ZERO;
    for (x, weight) in gauss_nodes(a, b) {
        integral.add(weight, f(x)?);
    }
    Ok(integral)
}

/// Points that divide a ≤ x ≤ b into panels. Towards both ends each panel is four times shorter
/// than the one before, to resolve a law at slow speeds whatever its scale (down to some 10⁻⁶ of
/// the interval).
pub(crate) fn graded(a: f64, b: f64) -> [f64; 13] {
    let half = 0.5 * (b - a);
    std::array::from_fn(|j| match j {
        0 => a,
        1..=6 => a + half * 0.25_f64.powi(6 - j as i32),
        7..=11 => b - half * 0.25_f64.powi(j as i32 - 6),
        _ => b,
    })
}

/// ∫ f dx over a mesh, by Gauss-Legendre, of an f that is analytic between neighbouring points of
/// the mesh. Each interval is a panel, and is halved until the panel agrees with its halves. `peak`
/// is a size of f relative to which smaller values are rounding; 0 if there is none.
pub(crate) fn gauss<const N: usize>(
    mut f: impl FnMut(f64) -> Result<[f64; N], Error>,
    mesh: &[f64],
    peak: f64,
) -> Result<Integral<N>, Error> {
    /// Most panels beyond those of the mesh. An undeclared kink needs about 50; for a law noisier
    /// than its rounding the halving would never end.
    const MOST_PANELS: usize = 256;
    let mut panels = Vec::new();
    let mut estimate = Integral {
        peak,
        ..Integral::ZERO
    };
    for ends in mesh.windows(2) {
        let ends = [ends[0], ends[1]];
        let integral = gauss_panel(&mut f, ends)?;
        estimate = estimate.merged(&integral);
        panels.push((ends, integral));
    }
    let mut total = Integral::ZERO;
    let most = panels.len() + MOST_PANELS;
    let mut next = 0;
    while let Some(&([a, b], whole)) = panels.get(next) {
        next += 1;
        let mid = 0.5 * (a + b);
        let halves = [[a, mid], [mid, b]];
        let [left, right] = [
            gauss_panel(&mut f, halves[0])?,
            gauss_panel(&mut f, halves[1])?,
        ];
        let sum = left.merged(&right);
        if panels.len() >= most || sum.agrees(&whole, estimate.tolerance()) {
            total = total.merged(&sum);
        } else {
            panels.extend([(halves[0], left), (halves[1], right)]);
        }
    }
    Ok(total)
}

#[cfg(test)]
mod tests;
