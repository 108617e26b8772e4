//! Search for all roots in an interval, and for the outline (the turning points), of a function
//! whose value and slope are known at every point.

use std::ops::Range;

use super::bracket::Bracket;
use crate::error::Error;

/// A value of the function with its slope.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sample {
    pub(crate) x: f64,
    pub(crate) value: f64,
    pub(crate) slope: f64,
    /// Size of the rounding error of `value`.
    pub(crate) noise: f64,
    /// Work done so far, in Taylor steps.
    pub(crate) work: usize,
}

impl Sample {
    /// Returns true if the value is zero to rounding.
    pub(crate) fn vanishes(&self) -> bool {
        self.value.abs() <= self.noise
    }

    /// Returns true if the value is positive; `None` if it is zero to rounding.
    pub(crate) fn grows(self) -> Option<bool> {
        (!self.vanishes()).then_some(self.value > 0.0)
    }
}

/// The result of a search for roots.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Roots {
    /// Roots in ascending order.
    pub(crate) roots: Vec<f64>,
    /// Ranges in which roots could not be decided, of two sorts: (nearly) neighbouring numbers
    /// between which the function jumps over zero; and ranges in which it is zero to rounding.
    pub(crate) unresolved: Vec<Range<f64>>,
}

/// Width, relative to the interval searched, below which an interval is not divided further.
const NARROWEST: f64 = 1e-9;

/// Taylor steps after which the rest of the interval is left unresolved, and an outline as it is.
/// Some hundreds are usual; a law with thousands of waves below the speed of the motion needs a
/// limit.
const MOST_WORK: usize = 200_000;

/// Largest error, relative to the values around, with which the cubic through both ends may predict
/// the value in the middle.
const CUBIC_FITS: f64 = 0.02;

/// Places inside an interval at which a function is not smooth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Kinks {
    /// The middle one.
    pub(crate) x: f64,
    /// Bound of the error that kinks cause in the cubic between the ends of the interval.
    pub(crate) error: f64,
}

/// Returns the kinks between two places, if there are any.
pub(crate) type KinksBetween<'k> = &'k dyn Fn(f64, f64) -> Option<Kinks>;

/// Finds the roots between two samples, and adds them to those found in intervals before.
///
/// An interval is divided until the cubic through the values and slopes at its ends predicts value
/// and slope in the middle. Then the cubics of the two halves decide. A half holds a root if the
/// signs at its ends differ. It may hold two roots, and is divided further, if its cubic comes
/// closer to zero than the error of the prediction. If the cubic comes closer to zero than the
/// error that kinks can cause, the half is divided at the kinks. A pair of roots is lost only if
/// the function has two turning points within an interval in which its cubic fits and no kink is
/// known, or if the pair is closer than [`NARROWEST`].
pub(crate) fn roots_between(
    f: &mut dyn FnMut(f64) -> Result<Sample, Error>,
    kinks: KinksBetween<'_>,
    a: Sample,
    b: Sample,
    found: &mut Roots,
) -> Result<(), Error> {
    let narrowest = NARROWEST * (b.x - a.x);
    divide(f, kinks, a, b, narrowest, found)
}

/// A point at which a function turns, or an end of its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TurningPoint {
    pub(crate) x: f64,
    pub(crate) value: f64,
    /// Size of the rounding error of `value`.
    pub(crate) noise: f64,
}

/// Relative error to which an outline knows the values at its turning points.
const HUNDREDTH: f64 = 0.01;

/// Halvings after which turning points are taken from the samples at hand.
const DEEPEST: usize = 9;

/// Halvings after which a part of an outline that stays beyond reach is not divided further.
const BEYOND: usize = 4;

/// The outline of a function between two samples: both ends and, in ascending order between them,
/// the points at which the slope changes sign. Maxima and minima alternate, each higher than its
/// neighbours, or lower, by more than rounding.
///
/// The interval is divided until the cubics fit and have no more turning points than the slopes at
/// their ends show, or until they are farther from zero than `reach`. Each turning point within
/// `reach` is then refined as a root of the slope, until its sign is known, and its size to a
/// hundredth. Turning points farther from zero have approximate places and sizes, or are left out
/// in pairs.
pub(crate) fn outline_between(
    f: &mut dyn FnMut(f64) -> Result<Sample, Error>,
    a: Sample,
    b: Sample,
    reach: f64,
) -> Result<Vec<TurningPoint>, Error> {
    let mut samples = vec![a];
    let mut intervals = vec![(b, 0)];
    let mut work = 0;
    while let Some((right, depth)) = intervals.pop() {
        let left = samples[samples.len() - 1];
        let middle = f(0.5 * (left.x + right.x))?;
        let settled = || {
            let (fits, error) = fits(left, middle, right);
            let is_beyond = |a, b| depth >= BEYOND && closest(a, b) - 2.0 * error > reach;
            (fits && !turns_twice(left, middle) && !turns_twice(middle, right))
                || (is_beyond(left, middle) && is_beyond(middle, right))
        };
        work = middle.work;
        if depth >= 2 && (depth >= DEEPEST || work >= MOST_WORK || settled()) {
            samples.extend([middle, right]);
        } else {
            intervals.extend([(right, depth + 1), (middle, depth + 1)]);
        }
    }
    let mut outline = vec![TurningPoint::from(a)];
    for pair in samples.windows(2) {
        let [left, right] = [pair[0], pair[1]];
        if (left.slope > 0.0) != (right.slope > 0.0) {
            // The cubic may be wrong by as much as it is allowed to miss, and more beside.
            let error = 5.0 * CUBIC_FITS * left.value.abs().max(right.value.abs());
            let turn = if closest(left, right) - error > reach || work >= MOST_WORK {
                left
            } else {
                turn(f, left, right, HUNDREDTH)?
            };
            work = work.max(turn.work);
            outline.push(turn.into());
        }
    }
    outline.push(b.into());
    smooth(&mut outline);
    Ok(outline)
}

/// The points of the coarse outline: nine, at equal distances.
pub(crate) fn eighths(
    f: &mut dyn FnMut(f64) -> Result<Sample, Error>,
    a: Sample,
    b: Sample,
) -> Result<Vec<Sample>, Error> {
    let mut samples = vec![a, b];
    while samples.len() < 9 {
        for i in (0..samples.len() - 1).map(|interval| 2 * interval) {
            // As an outline finds it, to the bit.
            let middle = f(0.5 * (samples[i].x + samples[i + 1].x))?;
            samples.insert(i + 1, middle);
        }
    }
    Ok(samples)
}

/// Least |value| that the cubic between two samples has; 0 if it changes its sign.
#[inline(never)]
fn closest(a: Sample, b: Sample) -> f64 {
    if (a.value > 0.0) == (b.value > 0.0) {
        let ends = a.value.abs().min(b.value.abs());
        ends.min(lowest(a, b)).max(0.0)
    } else {
        0.0
    }
}

/// The point between two samples at which the slope passes through zero, as close as the value
/// there, which is stationary, needs it for this relative error.
pub(crate) fn turn(
    f: &mut dyn FnMut(f64) -> Result<Sample, Error>,
    a: Sample,
    b: Sample,
    error: f64,
) -> Result<Sample, Error> {
    let mut bracket = Bracket::new((a.x, a.slope), (b.x, b.slope));
    let mut ends = [a, b];
    loop {
        let flatter = usize::from(ends[0].slope.abs() >= ends[1].slope.abs());
        let best = ends[flatter];
        let allowed = (0.01 * best.noise).max(error * best.value.abs());
        if best.slope.abs() * bracket.width() <= allowed {
            return Ok(best);
        }
        let Some(x) = bracket.next_place() else {
            return Ok(best);
        };
        let sample = f(x)?;
        bracket.narrow(x, sample.slope);
        let upper = (sample.slope > 0.0) != (ends[0].slope > 0.0);
        ends[usize::from(upper)] = sample;
    }
}

/// Removes turning points that are rounding.
fn smooth(outline: &mut Vec<TurningPoint>) {
    let hidden = |pair: &[TurningPoint]| {
        (pair[0].value - pair[1].value).abs() <= pair[0].noise.max(pair[1].noise)
    };
    while outline.len() > 2
        && let Some(i) = outline.windows(2).position(hidden)
    {
        // Both neighbouring turns are removed, but an end of the range stays.
        let last = outline.len() - 1;
        outline.drain(i.max(1)..(i + 2).min(last));
    }
}

/// Returns true if the cubic through two ends, whose slopes have the same sign, turns twice in
/// between.
fn turns_twice(a: Sample, b: Sample) -> bool {
    let width = b.x - a.x;
    let (dp, dq) = (a.slope * width, b.slope * width);
    // c'(t) = dp + 2 c2 t + 3 c3 t² on [0, 1], farthest down or up at t = −c2/(3 c3).
    let (c2, c3) = (
        3.0 * (b.value - a.value) - 2.0 * dp - dq,
        dp + dq - 2.0 * (b.value - a.value),
    );
    let t = -c2 / (3.0 * c3);
    let extreme = dp + c2 * t;
    dp * dq > 0.0
        && 0.0 < t
        && t < 1.0
        && extreme * dp < 0.0
        && extreme.abs() > a.noise.max(b.noise)
}

/// Returns true if the cubic through the values and slopes at both ends predicts those in the
/// middle; and the error of the value.
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
    f: &mut dyn FnMut(f64) -> Result<Sample, Error>,
    kinks: KinksBetween<'_>,
    a: Sample,
    b: Sample,
    narrowest: f64,
    found: &mut Roots,
) -> Result<(), Error> {
    let m = f(0.5 * (a.x + b.x))?;
    let (fits, error) = fits(a, m, b);
    let noise = a.noise.max(m.noise).max(b.noise);
    // If the prediction is as good as rounding allows, further division tells no more about a root
    // that rounding hides.
    let at_rounding = error <= noise;
    for (left, right) in [(a, m), (m, b)] {
        // Beyond the limit of work kinks are stepped over.
        let kink = kinks(left.x + narrowest, right.x - narrowest).filter(|kinks| {
            let matters = closest(left, right) - error <= kinks.error && kinks.error > noise;
            matters && m.work < MOST_WORK
        });
        let changes = (left.value > 0.0) != (right.value > 0.0);
        if left.vanishes() && right.vanishes() {
            found.leave(left.x..right.x);
        } else if right.x - left.x <= narrowest || is_indivisible(left.x, right.x) {
            if changes {
                found.refine(f, left, right)?;
            } else if left.vanishes() || right.vanishes() {
                found.leave(left.x..right.x);
            }
        } else if fits && changes && kink.is_none() && one_way(left, right) {
            found.refine(f, left, right)?;
        } else if at_rounding && hidden(left, right, noise) {
            found.leave(left.x..right.x);
        } else if let Some(kink) = kink.filter(|_| fits) {
            let at = f(kink.x)?;
            divide(f, kinks, left, at, narrowest, found)?;
            divide(f, kinks, at, right, narrowest, found)?;
        } else if !fits || changes || lowest(left, right) <= error.max(noise) {
            if m.work < MOST_WORK {
                divide(f, kinks, left, right, narrowest, found)?;
            } else {
                found.leave(left.x..right.x);
            }
        }
    }
    Ok(())
}

/// Returns true if no number lies between two.
fn is_indivisible(a: f64, b: f64) -> bool {
    let middle = 0.5 * (a + b);
    !(a < middle && middle < b)
}

/// Returns true if the cubic is certainly monotone: both slopes agree with the sign of the change,
/// neither is so steep that the cubic turns between the ends, and neither is a rounding error.
fn one_way(a: Sample, b: Sample) -> bool {
    let secant = (b.value - a.value) / (b.x - a.x);
    [a, b].iter().all(|end| {
        let relative = end.slope / secant;
        let flat = end.vanishes() && (end.slope * end.x).abs() <= 10.0 * end.noise;
        relative > 0.0 && relative < 3.0 && !flat
    })
}

/// Returns true if rounding may hide a root: next to an end at which the function is zero to
/// rounding, or where its cubic comes closest to zero.
fn hidden(a: Sample, b: Sample, noise: f64) -> bool {
    if (a.value > 0.0) != (b.value > 0.0) {
        a.vanishes() || b.vanishes()
    } else {
        lowest(a, b).abs() <= noise
    }
}

/// The least |value|, between two ends of the same sign, that the cubic through them has at an
/// extremum, negative if the extremum lies beyond zero; infinite if there is none.
#[inline(never)]
fn lowest(a: Sample, b: Sample) -> f64 {
    let width = b.x - a.x;
    let sign = if a.value > 0.0 { 1.0 } else { -1.0 };
    let (p, q) = (sign * a.value, sign * b.value);
    let (dp, dq) = (sign * a.slope * width, sign * b.slope * width);
    // c(t) = p + dp t + c2 t² + c3 t³ on [0, 1]; an extremum inside is a root of dp + 2 c2 t + 3 c3
    // t².
    let (c2, c3) = (3.0 * (q - p) - 2.0 * dp - dq, dp + dq - 2.0 * (q - p));
    let discriminant = c2 * c2 - 3.0 * c3 * dp;
    if discriminant < 0.0 {
        return f64::INFINITY;
    }
    let larger = -(c2 + discriminant.sqrt().copysign(c2));
    [larger / (3.0 * c3), dp / larger]
        .into_iter()
        .filter(|t| (0.0..=1.0).contains(t))
        .map(|t| p + t * (dp + t * (c2 + t * c3)))
        .fold(f64::INFINITY, f64::min)
}

impl From<Sample> for TurningPoint {
    fn from(sample: Sample) -> Self {
        Self {
            x: sample.x,
            value: sample.value,
            noise: sample.noise,
        }
    }
}

impl Roots {
    /// Leaves a range unresolved, and joins it to the one before if they meet.
    fn leave(&mut self, range: Range<f64>) {
        match self.unresolved.last_mut() {
            Some(last) if last.end == range.start => last.end = range.end,
            _ => self.unresolved.push(range),
        }
    }

    /// The root between samples of different sign: Newton's method kept inside the bracket.
    fn refine(
        &mut self,
        f: &mut dyn FnMut(f64) -> Result<Sample, Error>,
        mut a: Sample,
        mut b: Sample,
    ) -> Result<(), Error> {
        let rises = b.value > 0.0;
        let mut now = if a.value.abs() < b.value.abs() { a } else { b };
        let mut closest: Option<Sample> = None;
        let mut last = f64::INFINITY;
        loop {
            // A slope of the other sign belongs to another root, close by.
            let is_of_root = now.slope != 0.0 && (now.slope > 0.0) == rises;
            if is_of_root && closest.is_none_or(|best| now.value.abs() < best.value.abs()) {
                closest = Some(now);
            }
            let correction = if is_of_root {
                (now.value / now.slope).abs()
            } else {
                f64::INFINITY
            };
            // Quadratic convergence ends where rounding takes over and corrections no longer
            // shrink.
            let settled = is_of_root && now.vanishes() && correction >= 0.25 * last;
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
        }
        let nearer = if a.value.abs() < b.value.abs() { a } else { b };
        let closest = closest.unwrap_or(nearer);
        if closest.value.abs() <= JUMP {
            self.roots.push(closest.x);
        } else {
            self.unresolved.push(a.x..b.x);
        }
        Ok(())
    }
}

/// Largest |value| at a root: a function that is still larger when its bracket has shrunk to
/// neighbouring numbers jumps over zero.
const JUMP: f64 = 1e-7;

#[cfg(test)]
mod tests;
