//! All roots, in an interval, of a function whose value and slope are known at every point.

use std::ops::Range;

use crate::Error;

/// A value of the function with its slope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sample {
    pub(crate) x: f64,
    pub(crate) value: f64,
    pub(crate) slope: f64,
    /// Size of its rounding error.
    pub(crate) noise: f64,
    /// Work done so far, in Taylor steps.
    pub(crate) work: usize,
}

impl Sample {
    /// Zero to rounding.
    pub(crate) fn vanishes(&self) -> bool {
        self.value.abs() <= self.noise
    }
}

/// What a search has found.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Found {
    /// Roots in ascending order.
    pub(crate) roots: Vec<f64>,
    /// Neighbouring floating-point numbers, or nearly so, between which the function jumps over zero; and ranges where it is zero to rounding.
    pub(crate) unresolved: Vec<Range<f64>>,
}

/// Width, relative to the interval searched, below which an interval is not divided further.
const NARROWEST: f64 = 1e-9;

/// Taylor steps after which what is left goes unresolved. Some hundreds are the rule; a law with thousands of waves below the speed of the motion
/// needs a limit.
const MOST_WORK: usize = 200_000;

/// The cubic through both ends must predict the value in the middle this well, relative to the values around.
const CUBIC_FITS: f64 = 0.02;

/// Finds the roots between two samples, and adds them to those found in intervals before.
///
/// An interval is divided until the cubic through the values and slopes at its ends predicts value and slope in the middle. Then the
/// cubics of the two halves decide: a half holds a root if the signs at its ends differ, and may hold two if its cubic comes closer to
/// zero than the prediction was wrong; such a half is divided further. A pair of roots is lost only if the
/// function turns within an interval in which its cubic fits, or if the pair is closer than [`NARROWEST`].
pub(crate) fn roots_between(
    f: &mut impl FnMut(f64) -> Result<Sample, Error>,
    a: Sample,
    b: Sample,
    found: &mut Found,
) -> Result<(), Error> {
    let narrowest = NARROWEST * (b.x - a.x);
    divide(f, a, b, narrowest, found)
}

/// Halvings after which turning points are taken from what is known.
const DEEPEST: usize = 9;

/// Finds the points between two samples at which the slope changes sign, with the values there.
///
/// Divided until the cubics fit, and then refined by bisection on the sign of the slope.
pub(crate) fn turning_points_between(
    f: &mut impl FnMut(f64) -> Result<Sample, Error>,
    a: Sample,
    b: Sample,
) -> Result<Vec<(f64, f64)>, Error> {
    let mut samples = vec![a];
    let mut intervals = vec![(b, 0)];
    while let Some((right, depth)) = intervals.pop() {
        let left = samples[samples.len() - 1];
        let middle = f(0.5 * (left.x + right.x))?;
        if depth >= 2 && (depth >= DEEPEST || fits(left, middle, right).0) {
            samples.extend([middle, right]);
        } else {
            intervals.extend([(right, depth + 1), (middle, depth + 1)]);
        }
    }
    let mut points = Vec::new();
    for pair in samples.windows(2) {
        let [mut left, mut right] = [pair[0], pair[1]];
        if (left.slope > 0.0) == (right.slope > 0.0) {
            continue;
        }
        // The value is stationary: half the digits of x give all of its own.
        while right.x - left.x > 1e-9 * right.x {
            let chord = left.x + (right.x - left.x) * (left.slope / (left.slope - right.slope));
            let middle = 0.5 * (left.x + right.x);
            let x = 0.5 * (chord + middle);
            let sample = f(x)?;
            if (sample.slope > 0.0) == (left.slope > 0.0) {
                left = sample;
            } else {
                right = sample;
            }
        }
        points.push((left.x, left.value));
    }
    Ok(points)
}

/// Whether the cubic through the values and slopes at both ends predicts those in the middle, and by how much the value is missed.
fn fits(a: Sample, m: Sample, b: Sample) -> (bool, f64) {
    let width = b.x - a.x;
    let value = 0.5 * (a.value + b.value) + width * (a.slope - b.slope) / 8.0;
    let slope = 1.5 * (b.value - a.value) / width - 0.25 * (a.slope + b.slope);
    let error = (m.value - value).abs() + 0.125 * width * (m.slope - slope).abs();
    let variation = (a.value - m.value).abs() + (m.value - b.value).abs();
    let fits = error <= CUBIC_FITS * (variation + m.value.abs()) + m.noise;
    (fits, error)
}

fn divide(
    f: &mut impl FnMut(f64) -> Result<Sample, Error>,
    a: Sample,
    b: Sample,
    narrowest: f64,
    found: &mut Found,
) -> Result<(), Error> {
    let m = f(0.5 * (a.x + b.x))?;
    let (fits, error) = fits(a, m, b);
    let noise = a.noise.max(m.noise).max(b.noise);
    // Then no division tells more.
    let at_rounding = error <= noise;
    for (left, right) in [(a, m), (m, b)] {
        let changes = (left.value > 0.0) != (right.value > 0.0);
        if left.vanishes() && right.vanishes() {
            found.leave(left.x..right.x);
        } else if right.x - left.x <= narrowest {
            if changes {
                found.refine(f, left, right)?;
            } else if left.vanishes() || right.vanishes() {
                found.leave(left.x..right.x);
            }
        } else if fits && changes && one_way(left, right) {
            found.refine(f, left, right)?;
        } else if at_rounding {
            if changes || touches(left, right, noise) {
                found.leave(left.x..right.x);
            }
        } else if !fits || changes || touches(left, right, error) {
            if m.work < MOST_WORK {
                divide(f, left, right, narrowest, found)?;
            } else {
                found.leave(left.x..right.x);
            }
        }
    }
    Ok(())
}

/// Both slopes agree with the sign of the change, neither is so steep that the cubic turns in between, and none is mere rounding.
fn one_way(a: Sample, b: Sample) -> bool {
    let secant = (b.value - a.value) / (b.x - a.x);
    [a, b].iter().all(|end| {
        let relative = end.slope / secant;
        let flat = end.vanishes() && (end.slope * end.x).abs() <= 10.0 * end.noise;
        relative > 0.0 && relative < 3.0 && !flat
    })
}

/// Whether the cubic through both ends, which have one sign, comes within `margin` of zero between them.
fn touches(a: Sample, b: Sample, margin: f64) -> bool {
    let width = b.x - a.x;
    let sign = if a.value > 0.0 { 1.0 } else { -1.0 };
    let (p, q) = (sign * a.value, sign * b.value);
    let (dp, dq) = (sign * a.slope * width, sign * b.slope * width);
    // c(t) = p + dp t + c2 t² + c3 t³ on [0, 1]; an extremum inside is a root of dp + 2 c2 t + 3 c3 t².
    let (c2, c3) = (3.0 * (q - p) - 2.0 * dp - dq, dp + dq - 2.0 * (q - p));
    let discriminant = c2 * c2 - 3.0 * c3 * dp;
    if discriminant < 0.0 {
        return false;
    }
    let larger = -(c2 + discriminant.sqrt().copysign(c2));
    [larger / (3.0 * c3), dp / larger]
        .into_iter()
        .filter(|t| (0.0..=1.0).contains(t))
        .any(|t| p + t * (dp + t * (c2 + t * c3)) <= margin)
}

impl Found {
    /// Leaves a range unresolved, as one with that before it if they meet.
    fn leave(&mut self, range: Range<f64>) {
        match self.unresolved.last_mut() {
            Some(last) if last.end == range.start => last.end = range.end,
            _ => self.unresolved.push(range),
        }
    }

    /// The root between samples of different sign: Newton's method kept inside the bracket.
    fn refine(
        &mut self,
        f: &mut impl FnMut(f64) -> Result<Sample, Error>,
        mut a: Sample,
        mut b: Sample,
    ) -> Result<(), Error> {
        let mut now = if a.value.abs() < b.value.abs() { a } else { b };
        let mut closest = now;
        let mut last = f64::INFINITY;
        loop {
            let correction = (now.value / now.slope).abs();
            // Quadratic convergence ends where rounding takes over and corrections no longer shrink.
            let settled = correction <= NEWTON_REGIME * now.x && correction >= 0.25 * last;
            if settled || correction <= 0.5 * f64::EPSILON * now.x {
                break;
            }
            let newton = now.x - now.value / now.slope;
            let x = if a.x < newton && newton < b.x && correction < 0.5 * last {
                last = correction;
                newton
            } else {
                last = f64::INFINITY;
                0.5 * (a.x + b.x)
            };
            if x <= a.x || x >= b.x {
                break;
            }
            now = f(x)?;
            if (now.value > 0.0) == (a.value > 0.0) {
                a = now;
            } else {
                b = now;
            }
            if now.value.abs() < closest.value.abs() {
                closest = now;
            }
        }
        if closest.value.abs() <= JUMP {
            self.roots.push(closest.x);
        } else {
            self.unresolved.push(a.x..b.x);
        }
        Ok(())
    }
}

/// Relative correction below which Newton's method must be converging quadratically, if it is not at the rounding floor.
const NEWTON_REGIME: f64 = 1e-7;

/// A function that is still larger when its bracket has shrunk to nothing jumps over zero.
const JUMP: f64 = 1e-7;
