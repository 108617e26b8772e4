//! The defect of the series of a slip phase: the residual that the series leaves in the equation of
//! motion. The coefficients satisfy the equation at the start of a step; the defect shows whether
//! the series satisfies it later in the step.

use super::model::Belt;
use crate::friction::slip_series::SlipSeries;
use crate::motion::step_control::MOST_FOURS;
use crate::state::State;

impl Belt<'_> {
    /// The largest defect at four times, |γ²[μ̂(s(t)) − m(t)]| up to terms as small as the last of
    /// the series. m(t) is the series of the friction; `friction` and `speeds` are the values of m
    /// and s at these times.
    ///
    /// The coefficients alone do not contain terms that underflow at the start of the step, such as
    /// the flank of a narrow Gaussian in the law.
    #[inline(always)]
    pub(crate) fn defect(&self, piece: usize, friction: [f64; 4], speeds: [f64; 4]) -> f64 {
        let exact = self.law().at_four(piece, speeds.map(|s| s.max(0.0)));
        let mut largest = 0.0;
        for (exact, m) in std::iter::zip(exact, friction) {
            let difference = (exact - m).abs();
            // Not f64::max, which would drop a NaN.
            largest = if largest >= difference {
                largest
            } else {
                difference + 0.0 * largest
            };
        }
        self.load() * largest
    }
}

impl SlipSeries {
    /// The sum |u| + 2β|v| + γ²μ̂ at the start, by which the rounding errors of the equation of
    /// motion are measured.
    #[inline(always)]
    pub(crate) fn largest_term(&self, system: &Belt<'_>, state: State) -> f64 {
        state.displacement.abs()
            + 2.0 * system.damping() * state.velocity.abs()
            + system.load() * self.friction[0].abs()
    }

    /// The largest defect at four other times of the step.
    #[inline(never)]
    fn defect_elsewhere(&self, system: &Belt<'_>, piece: usize, times: [f64; 4]) -> f64 {
        let [friction, speeds] = [&self.friction, &self.speed].map(|series| series.at_some(times));
        system.defect(piece, friction, speeds)
    }

    /// The defect near the minima of s(t) inside a step of length h, where the relative velocity is
    /// smallest: the largest one near each minimum, added up. `speeds` are the values of s at the
    /// [`quarters`] of h.
    ///
    /// The law may have a feature at slow speeds, which a motion may pass between two quarters.
    #[inline(always)]
    pub(crate) fn defect_at_minimum(
        &self,
        system: &Belt<'_>,
        piece: usize,
        h: f64,
        speeds: [f64; 4],
    ) -> f64 {
        let mut largest = 0.0;
        self.speed.about_minima(h, speeds, &mut |times| {
            // Not f64::max, which would drop a NaN.
            largest += self.defect_elsewhere(system, piece, times);
        });
        largest
    }

    /// The defect at times in between, at least every quarter of a radian, for a step longer than
    /// [`LONG`]: the largest one of each four times, added up.
    ///
    /// Steps are long where the law is flat, and one may pass over a whole feature of the law.
    #[inline(never)]
    pub(crate) fn defect_in_between(&self, system: &Belt<'_>, piece: usize, h: f64) -> f64 {
        let fours = h.ceil().min(MOST_FOURS);
        let part = 0.25 * h / fours;
        let mut largest = 0.0;
        for i in 0..fours as usize {
            let start = i as f64 * 4.0 * part;
            let times = [0.5, 1.5, 2.5, 3.5].map(|place| start + place * part);
            // Not f64::max, which would drop a NaN.
            largest += self.defect_elsewhere(system, piece, times);
        }
        largest
    }
}

#[cfg(test)]
mod tests;
