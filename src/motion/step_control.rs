//! Step sizes, and the accepted defect of a series.

use crate::series::{PowerSeries, TERMS};

/// Length of a step, in radians of the undamped oscillator, above which its defect is checked at
/// more than four points. Few steps are so long.
///
/// The unit for several masses is the time of the fastest possible motion.
pub(crate) const LONG: f64 = 1.0;

/// The largest number of groups of four points at which a step longer than [`LONG`] is checked.
/// Only steps on a slow manifold, which may be 10²⁰ radians long, need so many; others have up to
/// eight.
pub(crate) const MOST_FOURS: f64 = 16.0;

/// The longest time over which a series is used, even if its last coefficients vanish: the period
/// of the oscillator is about 2π.
pub(crate) const FARTHEST: f64 = 8.0;

/// The rate above which a system is stiff: the rate at which deviations from the slow manifold
/// decay or grow.
pub(crate) const STIFF: f64 = 8.0;

/// Length of an explicit step, in units of 1/D, above which the motion may have reached the slow
/// manifold. D is the rate at which deviations from it decay.
pub(crate) const SETTLING: f64 = 7.0;

/// Length of an explicit step in units of 1/D, about, from a series of all orders.
pub(crate) const EXPLICIT: f64 = 10.0;

/// The largest tolerance of a stiff system. Its errors are measured in units of v and v_b, and must
/// be small relative to the speeds over which the law is nonlinear; otherwise the motion does not
/// reach the slow manifold. A small tolerance costs little, because the length of a step grows only
/// like tolerance^(1/26).
pub(crate) const LOOSEST: f64 = 1e-12;

/// The defect that rounding alone may cause, in units of ε times the largest term of the equation
/// of motion. Rounding seldom causes more than 8.
const DEFECT_FLOOR: f64 = 1000.0;

/// Largest product of defect and step length that is accepted, in units of the error allowed in a
/// step's last term.
const DEFECT_LIMIT: f64 = 40.0 * TERMS as f64;

/// The outcome of a step of a given length.
pub(crate) enum Attempt<T> {
    /// The step is accepted.
    Taken(T),
    /// The series of the step are too curved for their roots to be isolated.
    TooCurved,
    /// The defect of the step, up to this time, is too large.
    Inexact(f64),
}

/// The longest accepted step up to `longest`, by halving, with the length that was tried.
///
/// # Errors
///
/// The length at which steps became too short.
#[inline(always)]
pub(crate) fn settle<T>(
    longest: f64,
    is_long_enough: impl Fn(f64) -> bool,
    mut attempt: impl FnMut(f64) -> Attempt<T>,
) -> Result<(T, f64), f64> {
    let mut h = longest;
    loop {
        if !is_long_enough(h) {
            return Err(h);
        }
        let tried = h;
        h = 0.5
            * match attempt(h) {
                Attempt::Taken(step) => return Ok((step, h)),
                Attempt::TooCurved => h,
                // Where an event lies at a break of a drive to rounding, it may be behind h.
                Attempt::Inexact(end) => end.min(h),
            };
        // A step of length 0, at a break of a drive, has no half.
        if h >= tried {
            return Err(tried);
        }
    }
}

/// The errors that are allowed in a step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Allowance {
    /// Bound of the last terms of the series.
    pub(crate) error: f64,
    /// Defect that rounding alone may cause.
    floor: f64,
}

impl Allowance {
    /// Allows this error of the motion, and the rounding error of the largest term of its equation.
    #[inline(always)]
    pub(crate) fn new(error: f64, largest_term: f64) -> Self {
        Self {
            // Smaller numbers have few digits.
            error: error.max(f64::MIN_POSITIVE),
            floor: DEFECT_FLOOR * f64::EPSILON * largest_term,
        }
    }

    /// The time up to which the terms of the highest orders stay below the error:
    /// (error/|c_n|)^(1/n) for the last two n, to 6 %.
    #[inline(always)]
    pub(crate) fn reach(&self, c: &PowerSeries) -> f64 {
        self.reach_of(c, TERMS - 1, FARTHEST)
    }

    /// [`reach`](Self::reach) for a series that ends with an earlier order, and for the slow
    /// manifold of a stiff system, whose radius of convergence is larger.
    #[inline(always)]
    pub(crate) fn reach_of(&self, c: &PowerSeries, order: usize, farthest: f64) -> f64 {
        reach(self.error, c, order).min(farthest)
    }

    /// The longest time over which a series is used, for a motion that tends to a slow manifold at
    /// the rate D = `closing`: the motion on the manifold changes within the time D.
    pub(crate) fn farthest(closing: f64) -> f64 {
        FARTHEST * closing.max(1.0)
    }

    /// Returns true if a force is at most one that rounding alone may cause.
    pub(crate) fn is_rounding(&self, force: f64) -> bool {
        force <= self.floor
    }

    /// Returns true if a step of length h may be taken with these defects. NaN is not accepted.
    ///
    /// A defect is the residual that the series leaves in the equation of motion.
    #[inline(always)]
    pub(crate) fn accepts(&self, defects: [f64; 3], h: f64) -> bool {
        let accepted = DEFECT_LIMIT * self.error + self.floor * h;
        defects.iter().all(|defect| defect * h <= accepted)
    }
}

/// The time up to which the terms of order n and n − 1 stay below an error: (error/|c_n|)^(1/n), to
/// 6 %. Where nothing moves no error is allowed, and any term of rounding would be too large.
#[inline(always)]
pub(crate) fn reach(error: f64, c: &PowerSeries, n: usize) -> f64 {
    let error = error.max(f64::MIN_POSITIVE);
    let by = |n: usize| root_of_ratio(error, c[n].abs(), n);
    by(n).min(by(n - 1))
}

/// (x/y)^(1/n) to 6 %, from the bits of x and y: exponent and mantissa together are nearly a
/// logarithm.
#[inline(always)]
pub(crate) fn root_of_ratio(x: f64, y: f64, n: usize) -> f64 {
    const ONE: i64 = 1.0_f64.to_bits() as i64;
    const INFINITE: i64 = f64::INFINITY.to_bits() as i64;
    let bits = ONE.saturating_add((x.to_bits() as i64 - y.to_bits() as i64) / n as i64);
    f64::from_bits(bits.clamp(0, INFINITE) as u64)
}

#[cfg(test)]
mod tests {
    use super::root_of_ratio;

    #[test]
    fn roots_of_any_ratio_are_numbers() {
        let extreme = [0.0, f64::from_bits(1), 1e-300, 1.0, 1e300, f64::MAX];
        for n in 1..=26 {
            for (x, y) in extreme.iter().flat_map(|x| extreme.map(|y| (*x, y))) {
                let root = root_of_ratio(x, y, n);
                assert!(root >= 0.0, "{x:e} {y:e} {n}: {root}");
            }
            let root = root_of_ratio(2.7e-11, 4.1e5, n);
            let exact = (2.7e-11_f64 / 4.1e5).powf((n as f64).recip());
            // A mantissa of bits is off the logarithm by 0.0861 at most.
            let off = (root / exact).log2().abs();
            assert!(
                off < 0.0861 * (1.0 + (n as f64).recip()),
                "{n}: {root} {exact}"
            );
        }
    }
}
