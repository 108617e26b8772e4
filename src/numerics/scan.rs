//! The search of a range over a grid, which is refined wherever a result could be missed.

use std::ops::Range;

use super::bracket::sign_change_between;
use crate::error::Error;

/// Number of equal intervals that a range is first divided into.
pub(crate) const INTERVALS: usize = 64;

/// The search for something over a range, as [`scan`] needs it.
pub(crate) trait Survey {
    /// The information at one place.
    type Sample;

    /// Number of times that an interval of the grid may be halved.
    const HALVINGS: u32;

    /// Computes the information at x.
    fn sample(&mut self, x: f64) -> Result<Self::Sample, Error>;

    /// Computes the information in the middle of an interval, and may compare it with that at the
    /// ends.
    fn middle(
        &mut self,
        x: f64,
        _: &mut Self::Sample,
        _: &mut Self::Sample,
    ) -> Result<Self::Sample, Error> {
        self.sample(x)
    }

    /// Searches the interval between two neighbouring places, each given with its sample, to which
    /// it may add: records what lies there, or requests that the interval be halved, if `halvings`
    /// are left.
    fn examine(
        &mut self,
        left: &mut (f64, Self::Sample),
        right: &mut (f64, Self::Sample),
        halvings: u32,
    ) -> Result<Refinement, Error>;
}

/// Result of the search of an interval.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Refinement {
    Done,
    Halve,
}

/// Searches a range: [`INTERVALS`] intervals of equal width, and the halves of those for which the
/// survey requests it.
pub(crate) fn scan<S: Survey>(survey: &mut S, range: &Range<f64>) -> Result<(), Error> {
    let width = (range.end - range.start) / INTERVALS as f64;
    let mut left = None;
    for i in 0..=INTERVALS {
        let x = match i {
            0 => range.start,
            INTERVALS => range.end,
            _ => range.start + width * i as f64,
        };
        let mut right = (x, survey.sample(x)?);
        if let Some(left) = &mut left {
            refine(survey, left, &mut right, S::HALVINGS)?;
        }
        left = Some(right);
    }
    Ok(())
}

/// Searches one interval, and its halves if the survey requests it.
pub(crate) fn refine<S: Survey>(
    survey: &mut S,
    left: &mut (f64, S::Sample),
    right: &mut (f64, S::Sample),
    halvings: u32,
) -> Result<(), Error> {
    if survey.examine(left, right, halvings)? == Refinement::Halve && halvings > 0 {
        let x = 0.5 * (left.0 + right.0);
        let mut middle = (x, survey.middle(x, &mut left.1, &mut right.1)?);
        refine(survey, left, &mut middle, halvings - 1)?;
        refine(survey, &mut middle, right, halvings - 1)?;
    }
    Ok(())
}

/// Adds to `found` the sign changes over a range, ascending, each to the last bit, of a function f
/// whose values are of order 1; f gives `None` where it is not defined.
///
/// An interval of the grid is halved, up to 10 times, while f is defined at one end only, or while
/// f is closer to zero at an end than it changes across the interval or may bend within it. Two
/// sign changes are lost only if f passes zero and turns back between two points of the refined
/// grid, and is nearly straight around them. A narrower range has a finer grid.
pub(crate) fn sign_changes(
    f: &mut dyn FnMut(f64) -> Result<Option<f64>, Error>,
    range: &Range<f64>,
    found: &mut Vec<f64>,
) -> Result<(), Error> {
    let before = None;
    scan(&mut SignChanges { f, found, before }, range)
}

struct SignChanges<'f> {
    f: &'f mut dyn FnMut(f64) -> Result<Option<f64>, Error>,
    found: &'f mut Vec<f64>,
    /// The last point to the left of the current interval, with the value there.
    before: Option<(f64, f64)>,
}

impl SignChanges<'_> {
    /// Bound of the approach to zero, between two places of the same sign, of a function that bends
    /// as much there as nearby: twice what a parabola needs.
    fn bend(&self, a: (f64, f64), b: (f64, f64)) -> f64 {
        let Some(before) = self.before else {
            return 0.0;
        };
        let slope = |p: (f64, f64), q: (f64, f64)| (q.1 - p.1) / (q.0 - p.0);
        let second = 2.0 * (slope(a, b) - slope(before, a)) / (b.0 - before.0);
        let towards_zero = if a.1 > 0.0 { second } else { -second };
        0.25 * towards_zero.max(0.0) * (b.0 - a.0).powi(2)
    }
}

impl Survey for SignChanges<'_> {
    type Sample = Option<f64>;

    const HALVINGS: u32 = 10;

    fn sample(&mut self, x: f64) -> Result<Self::Sample, Error> {
        (self.f)(x)
    }

    fn examine(
        &mut self,
        a: &mut (f64, Option<f64>),
        b: &mut (f64, Option<f64>),
        halvings: u32,
    ) -> Result<Refinement, Error> {
        let may_hide = match (a.1, b.1) {
            (None, None) => false,
            // Such a function is zero throughout, as for a motion that returns to the belt
            // tangentially at every belt velocity.
            (Some(p), Some(q)) if p.abs().max(q.abs()) <= ROUNDING => false,
            (Some(p), Some(q)) if (p > 0.0) != (q > 0.0) => {
                // A jump over zero counts as a root: the motion may depend so steeply on the belt
                // velocity that the function passes through zero within an ulp.
                match sign_change_between(self.f, (a.0, p), (b.0, q))? {
                    Some(change) => {
                        self.found.push(change.below);
                        false
                    }
                    None => true,
                }
            }
            (Some(p), Some(q)) => {
                let reach = (p - q).abs().max(self.bend((a.0, p), (b.0, q)));
                p.abs().min(q.abs()) < reach
            }
            _ => true,
        };
        if may_hide && halvings > 0 {
            return Ok(Refinement::Halve);
        }
        self.before = a.1.map(|value| (a.0, value));
        Ok(Refinement::Done)
    }
}

/// Size of the rounding error of a function of order 1.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

#[cfg(test)]
mod tests;
