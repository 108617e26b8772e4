//! The defect of a slip phase's series: what is missing in the equation of motion when the series
//! is put in. The coefficients fulfil the equation at the start of a step; the defect shows whether
//! the series fulfils it elsewhere in the step.

use super::expansion::SlipSeries;
use super::system::MassOnBelt;
use crate::friction::FrictionLaw;
use crate::state::State;

impl SlipSeries {
    /// The sum |u| + 2β|v| + γ²μ̂ at the start, by which the rounding errors of the equation of
    /// motion are measured.
    #[inline(always)]
    pub(crate) fn largest_term<L>(&self, system: &MassOnBelt<L>, state: State) -> f64 {
        state.displacement.abs()
            + 2.0 * system.damping() * state.velocity.abs()
            + system.load() * self.friction[0].abs()
    }

    /// The largest defect at four times, |γ²[μ̂(s(t)) − m(t)]| up to terms as small as the last of
    /// the series. m(t) is the series of the friction, and `speeds` are the values of s at these
    /// times.
    ///
    /// The coefficients alone do not show what underflows where the step starts, such as the flank
    /// of a narrow Gaussian in the law.
    #[inline(always)]
    pub(crate) fn defect<L: FrictionLaw>(
        &self,
        system: &MassOnBelt<L>,
        piece: usize,
        times: [f64; 4],
        speeds: [f64; 4],
    ) -> f64 {
        let friction = self.friction.at_four(times);
        let mut largest = 0.0;
        for (s, m) in std::iter::zip(speeds, friction) {
            let difference = (system.law().kinetic_on(piece, s.max(0.0)) - m).abs();
            // Not f64::max, which would drop a NaN.
            largest = if largest >= difference {
                largest
            } else {
                difference + 0.0 * largest
            };
        }
        system.load() * largest
    }

    /// The defect near the minima of s(t) inside a step of length h, where the motion comes closest
    /// to the belt: the largest one near each minimum, added up. `speeds` are the values of s at
    /// the [`quarters`] of h.
    ///
    /// The law may have a feature at slow speeds, and a motion may pass it between two quarters.
    #[inline(always)]
    pub(crate) fn defect_at_minimum<L: FrictionLaw>(
        &self,
        system: &MassOnBelt<L>,
        piece: usize,
        h: f64,
        speeds: [f64; 4],
    ) -> f64 {
        let (start, [a, b, c, d]) = (self.speed[0], speeds);
        // The slope at the end, by the polynomial of fourth degree through the five values.
        let at_end = (25.0 * d - 48.0 * c + 36.0 * b - 16.0 * a + 3.0 * start) / 12.0;
        // ds/dt·h/4 at the PARTS of the step.
        let start_slope = 0.25 * h * self.speed[1];
        let slopes = [start_slope, a - start, b - a, c - b, d - c, at_end];
        if slopes.windows(2).any(is_turn) {
            self.defect_near_minima(system, piece, h, slopes)
        } else {
            0.0
        }
    }

    #[inline(never)]
    fn defect_near_minima<L: FrictionLaw>(
        &self,
        system: &MassOnBelt<L>,
        piece: usize,
        h: f64,
        slopes: [f64; 6],
    ) -> f64 {
        const PARTS: [f64; 6] = [0.0, 0.125, 0.375, 0.625, 0.875, 1.0];
        const MOST_PASSES: usize = 10;
        /// Correction, as part of the step, after which the next one would be far smaller.
        const CLOSE: f64 = 1e-3;
        let slope = self.speed.derivative();
        let curvature = slope.derivative();
        let mut largest = 0.0;
        for (slopes, parts) in std::iter::zip(slopes.windows(2), PARTS.windows(2)) {
            if !is_turn(slopes) {
                continue;
            }
            let [mut left, mut right] = [parts[0] * h, parts[1] * h];
            let mut t = left + (right - left) * slopes[0] / (slopes[0] - slopes[1]);
            // Newton's method, and halving where it would leave the stretch.
            for _ in 0..MOST_PASSES {
                let slope_here = slope.at(t);
                if slope_here > 0.0 {
                    right = t;
                } else {
                    left = t;
                }
                let newton = t - slope_here / curvature.at(t);
                let last = t;
                t = if left <= newton && newton <= right {
                    newton
                } else {
                    0.5 * (left + right)
                };
                if (t - last).abs() <= CLOSE * h {
                    break;
                }
            }
            let about = [-0.05, 0.0, 0.02, 0.1].map(|part| (t + part * h).clamp(0.0, h));
            // Not f64::max, which would drop a NaN.
            largest += self.defect(system, piece, about, self.speed.at_four(about));
        }
        largest
    }

    /// The defect at places in between, at least every quarter of a radian, for a step longer than
    /// [`LONG`]: the largest one of each four places, added up.
    ///
    /// Where the law is flat, steps are long, and one may pass over a whole feature of the law.
    #[inline(never)]
    pub(crate) fn defect_in_between<L: FrictionLaw>(
        &self,
        system: &MassOnBelt<L>,
        piece: usize,
        h: f64,
    ) -> f64 {
        let fours = h.ceil().min(MOST_FOURS);
        let part = 0.25 * h / fours;
        let mut largest = 0.0;
        for i in 0..fours as usize {
            let start = i as f64 * 4.0 * part;
            let times = [0.5, 1.5, 2.5, 3.5].map(|place| start + place * part);
            // Not f64::max, which would drop a NaN.
            largest += self.defect(system, piece, times, self.speed.at_four(times));
        }
        largest
    }
}

/// The largest number of such fours of places. Only motions that hardly move have steps
/// longer than three radians.
const MOST_FOURS: f64 = 16.0;

/// Whether a function has a minimum between two places, by its slopes there.
#[inline(always)]
fn is_turn(slopes: &[f64]) -> bool {
    slopes[0] < 0.0 && slopes[1] >= 0.0
}

#[cfg(test)]
mod tests;
