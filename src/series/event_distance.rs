//! Events of a step: a quantity that starts positive, and the first time at which it is 0.

use super::{PowerSeries, TERMS, TooCurved, quarters};

/// A quantity that is positive until an event: a sliding speed, the distance of a load from its
/// limit, the distance from a breakpoint, a normal load.
///
/// A known root at the start is excluded: the first coefficients that are exactly 0 are counted and
/// divided out. Their number is 0 away from zero, 1 after an arrival at a bound from which the
/// quantity returns inside, 2 after a release or if a bound was only touched, and 3 after a release
/// under forcing that begins at its extremum.
#[derive(Debug, Clone, Copy)]
pub(crate) struct EventDistance(PowerSeries);

impl EventDistance {
    /// A quantity given by a series whose first coefficients are exactly 0 for each known root at t
    /// = 0; `None` if all coefficients are 0.
    pub(crate) fn new(series: &PowerSeries) -> Option<Self> {
        let known = series.0.iter().position(|&c| c != 0.0)?;
        Some(Self(series.without_root(known)))
    }

    /// The first time in (0, h] at which the quantity is 0; time 0 if it starts negative, which
    /// rounding can cause.
    pub(crate) fn first_zero(&self, h: f64) -> Result<Option<f64>, TooCurved> {
        if self.0[0] < 0.0 {
            return Ok(Some(0.0));
        }
        if self.0.is_linear() {
            let t = -self.0[0] / self.0[1];
            return Ok((t > 0.0 && t <= h && t.is_finite()).then_some(t));
        }
        self.0.first_root(h, self.0.at_four(quarters(h)))
    }
}

impl PowerSeries {
    /// Returns true if all terms beyond the first two are 0.
    #[inline]
    pub(crate) fn is_linear(&self) -> bool {
        self.0[2..].iter().all(|&c| c == 0.0)
    }

    /// Returns true if the series is the same at all times.
    #[inline]
    pub(crate) fn is_constant(&self) -> bool {
        self.0[1] == 0.0 && self.is_linear()
    }

    /// Returns true if the series surely stays between −bound and bound on [0, h], by its values at
    /// the [`quarters`] and the bound of its curvature.
    #[inline]
    pub(crate) fn stays_within(&self, bound: f64, h: f64) -> bool {
        let (values, curvature) = self.survey(h);
        let largest = values.iter().fold(self.0[0].abs(), |m, v| m.max(v.abs()));
        bound - largest > curvature * h * h / 128.0
    }

    /// Largest of |c_k| t^k, k ≥ 1: a bound of the change of the series within a time t for which
    /// it converges.
    pub(crate) fn largest_change(&self, t: f64) -> f64 {
        // Four chains of powers: each product waits for the one before.
        let t2 = t * t;
        let mut powers = [t, t2, t2 * t, t2 * t2];
        let t4 = powers[3];
        let mut largest = [0.0; 4];
        for k in (1..TERMS).step_by(4) {
            for (j, (power, largest)) in std::iter::zip(&mut powers, &mut largest).enumerate() {
                let change = self.get(k + j).abs() * *power;
                if change > *largest {
                    *largest = change;
                }
                *power *= t4;
            }
        }
        largest.into_iter().fold(0.0, f64::max)
    }

    /// The series of c(t) − level.
    pub(crate) fn minus(&self, level: f64) -> Self {
        let mut shifted = *self;
        shifted.0[0] -= level;
        shifted
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn first_zero(c: &[f64], h: f64) -> Option<f64> {
        EventDistance::new(&PowerSeries::from(c))?
            .first_zero(h)
            .unwrap()
    }

    #[test]
    fn known_roots_at_the_start_are_divided_out() {
        // t^n (1 − t)(2 − t)
        for n in 0..4 {
            let mut c = [0.0; 8];
            c[n..n + 3].copy_from_slice(&[2.0, -3.0, 1.0]);
            let root = first_zero(&c, 3.0).unwrap();
            assert!((root - 1.0).abs() <= f64::EPSILON, "{n} roots at 0: {root}");
            assert_eq!(first_zero(&c, 0.9), None, "{n} roots at 0");
        }
    }

    #[test]
    fn straight_lines_are_followed_for_ever() {
        assert_eq!(first_zero(&[3.0, -1e-9], f64::INFINITY), Some(3e9));
        for never in [[3.0, 1.0], [3.0, 0.0], [3.0, -0.0], [0.0, 1.0], [0.0, 0.0]] {
            assert_eq!(first_zero(&never, f64::INFINITY), None, "{never:?}");
        }
        // Just arrived at a bound that it leaves at once.
        assert_eq!(first_zero(&[0.0, -1.0], 1.0), Some(0.0));
        // And one that it leaves later: −t² + t.
        assert_eq!(first_zero(&[0.0, 1.0, -1.0], 5.0), Some(1.0));
    }

    #[test]
    fn what_stays_inside_is_told_from_what_may_leave() {
        let wave = PowerSeries::from(&[0.5, 0.0, -0.5]);
        assert!(wave.stays_within(0.6, 1.0));
        assert!(!wave.stays_within(0.5, 1.0));
        assert!(!wave.stays_within(0.6, 2.0));
        assert!(!wave.stays_within(0.6, f64::INFINITY));
    }
}
