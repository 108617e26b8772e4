//! Times about the minima of a power series within a step, where it comes close to zero.

use super::PowerSeries;

impl PowerSeries {
    /// Calls `look` with four times about each minimum within [0, h]; `values` are the series'
    /// values at the [`quarters`](super::quarters) of h.
    #[inline(always)]
    pub(crate) fn about_minima(&self, h: f64, values: [f64; 4], look: &mut dyn FnMut([f64; 4])) {
        let (start, [a, b, c, d]) = (self[0], values);
        // The slope at the end is that of the polynomial of fourth degree through the five values.
        let at_end = (25.0 * d - 48.0 * c + 36.0 * b - 16.0 * a + 3.0 * start) / 12.0;
        // Slope·h/4 at the PARTS of the step.
        let start_slope = 0.25 * h * self[1];
        let slopes = [start_slope, a - start, b - a, c - b, d - c, at_end];
        if slopes.windows(2).any(is_turn) {
            self.about_turns(h, slopes, look);
        }
    }

    /// Calls `look` about each minimum and each maximum, as [`about_minima`](Self::about_minima)
    /// about each minimum.
    pub(crate) fn about_extrema(&self, h: f64, values: [f64; 4], look: &mut dyn FnMut([f64; 4])) {
        self.about_minima(h, values, look);
        self.scaled(-1.0)
            .about_minima(h, values.map(|value| -value), look);
    }

    #[inline(never)]
    fn about_turns(&self, h: f64, slopes: [f64; 6], look: &mut dyn FnMut([f64; 4])) {
        const PARTS: [f64; 6] = [0.0, 0.125, 0.375, 0.625, 0.875, 1.0];
        const MOST_PASSES: usize = 10;
        /// Part of a step. After a correction as small as this the next one would be far smaller.
        const CLOSE: f64 = 1e-3;
        let slope = self.derivative();
        let curvature = slope.derivative();
        for (slopes, parts) in std::iter::zip(slopes.windows(2), PARTS.windows(2)) {
            if !is_turn(slopes) {
                continue;
            }
            let [mut left, mut right] = [parts[0] * h, parts[1] * h];
            let mut t = left + (right - left) * slopes[0] / (slopes[0] - slopes[1]);
            // Newton's method; halving where that would leave the interval.
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
            look([-0.05, 0.0, 0.02, 0.1].map(|part| (t + part * h).clamp(0.0, h)));
        }
    }
}

/// Returns true if a function has a minimum between two places, by its slopes at them.
#[inline(always)]
fn is_turn(slopes: &[f64]) -> bool {
    slopes[0] < 0.0 && slopes[1] >= 0.0
}
