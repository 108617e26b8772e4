//! A law over a range of sliding speeds, as a chain of power series. Each series is used only
//! within its radius of convergence, and is compared with the law at three points of its interval,
//! so that no feature of the law is missed.

use std::ops::Range;

use super::{Values, finite_at, slope_on, taylor_coefficients_on};
use crate::error::Error;
use crate::series::{PowerSeries, TERMS, quarters};

/// Largest size of a series' last terms, relative to its largest term: the limit of its use.
const TRUNCATION: f64 = 1e-16;

/// Largest error of a series in between, relative to its largest term.
const DEFECT: f64 = 1e-12;

/// Rounding error of h, relative to the largest |h| met so far.
const ROUNDING: f64 = 1e-14;

/// Least number of series for a range.
const PIECES: f64 = 64.0;

/// Relative distance below the range at which the search for sign changes begins, so that a root
/// exactly at the start of the range counts.
const LOOK_BACK: f64 = 1e-6;

/// Largest growth from one series to the next: a range of 1e300 would be halved 10³ times for each.
const GROWTH: f64 = 1024.0;

/// Number of series after which a search returns an error, well within a second.
pub(super) const MOST_STRETCHES: usize = 10_000;
const TOO_LONG: &str =
    "a shorter range: it takes more than 10000 power series of the law to get there";

/// The function h(s) = c + f·dμ̂/ds of the sliding speed, where c ≥ 0 and f > 0.
pub(crate) struct AlongSlope<'l> {
    pub(crate) law: &'l dyn Values,
    pub(crate) constant: f64,
    pub(crate) factor: f64,
}

/// The end of a range that has the highest speed, as the user gave it, for the error that it is too
/// far away.
#[derive(Clone, Copy)]
pub(crate) struct FarEnd {
    /// The function that was called.
    pub(crate) of: &'static str,
    pub(crate) name: &'static str,
    pub(crate) value: f64,
}

impl AlongSlope<'_> {
    /// Sliding speeds, ascending, at which h changes its sign, in a range of positive speeds.
    ///
    /// A touch of zero to rounding without a change of sign is not reported. A breakpoint at which
    /// h jumps over zero is reported. If h is zero over a whole interval of speeds and has
    /// different signs on its two sides, the upper end of the interval is reported.
    pub(crate) fn sign_changes(&self, range: &Range<f64>, end: FarEnd) -> Result<Vec<f64>, Error> {
        let mut changes = SignChanges {
            h: |speed| self.constant + self.factor * self.law.slope(speed),
            positive: None,
            roots: Vec::new(),
        };
        let from = range.start * (1.0 - LOOK_BACK);
        self.follow(from..range.end, end, &mut |stretch, rounding| {
            changes.follow(stretch, rounding);
            Ok(())
        })?;
        changes.roots.retain(|root| range.contains(root));
        Ok(changes.roots)
    }

    /// Least value of h over a range, its ends included, exact to rounding.
    pub(crate) fn least(&self, range: Range<f64>, end: FarEnd) -> Result<f64, Error> {
        let mut least = f64::INFINITY;
        self.follow(range, end, &mut |stretch, _| {
            let mut speeds = vec![stretch.start, stretch.start + stretch.length];
            // The places of the minima need not be exact, because h is flat there.
            let slope = stretch.series.derivative();
            slope.sign_changes(stretch.length, &mut |t, rising| {
                if rising {
                    speeds.push(stretch.start + t);
                }
            });
            for speed in speeds {
                let slope = slope_on(self.law, stretch.piece, speed)?;
                least = least.min(self.constant + self.factor * slope);
            }
            Ok(())
        })?;
        Ok(least)
    }

    /// Visits the stretches that make up a range, in order, each with the rounding error of h up to
    /// there.
    fn follow(
        &self,
        range: Range<f64>,
        far: FarEnd,
        visit: &mut dyn FnMut(&Stretch, f64) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let mut start = range.start;
        // A range of some ulps would be divided into nothing.
        let longest = ((range.end - start) / PIECES).max(start.next_up() - start);
        let (mut stretches, mut last) = (0, f64::INFINITY);
        let ends = self.law.breakpoints();
        let mut ends: Vec<f64> = ends.filter(|&end| start < end && end < range.end).collect();
        ends.push(range.end);
        let mut largest = self.constant;
        for end in ends {
            while start < end {
                let is_near = stretches < MOST_STRETCHES;
                Error::check(far.of, far.name, far.value, is_near, TOO_LONG)?;
                stretches += 1;
                let most = longest.min(GROWTH * last);
                let mut stretch = self.stretch(start, most.min(end - start), &mut largest)?;
                last = stretch.length;
                let ends_here = start + stretch.length >= end;
                if !ends_here {
                    stretch.end_away_from_zero();
                }
                visit(&stretch, ROUNDING * largest)?;
                start = if ends_here {
                    end
                } else {
                    (start + stretch.length).max(start.next_up())
                };
            }
        }
        Ok(())
    }

    /// Returns the error of the first speed at which the law has no finite value or slope, if there
    /// is none at `end`; found by bisection from `start`.
    fn finite_between(&self, start: f64, end: f64) -> Result<(), Error> {
        let (mut good, mut bad) = (start, end);
        let mut found = finite_at(self.law, bad);
        while found.is_err() {
            let middle = 0.5 * (good + bad);
            if !(good < middle && middle < bad) {
                break;
            }
            match finite_at(self.law, middle) {
                Ok(()) => good = middle,
                error => (bad, found) = (middle, error),
            }
        }
        found
    }

    /// The stretch that begins at the speed `start` and is at most `longest` long. Updates
    /// `largest`, the largest |h| met so far.
    fn stretch(&self, start: f64, longest: f64, largest: &mut f64) -> Result<Stretch, Error> {
        finite_at(self.law, start)?;
        let piece = self.law.piece_above(start);
        let friction = taylor_coefficients_on::<{ TERMS + 1 }>(self.law, piece, start);
        let mut series = PowerSeries::from_fn(|k| self.factor * (k + 1) as f64 * friction[k + 1]);
        series[0] += self.constant;
        let mut stretch = Stretch {
            start,
            length: longest,
            piece,
            series,
        };
        let h = |speed: f64| self.constant + self.factor * self.law.value_and_slope(piece, speed).1;
        loop {
            let size = stretch.largest_term();
            *largest = largest.max(series[0].abs());
            let allowed =
                DEFECT * (size + self.constant) + ROUNDING * *largest + stretch.rounding_of_speed();
            if stretch.converges(size + *largest * ROUNDING) && stretch.fits(allowed, h) {
                return Ok(stretch);
            }
            stretch.length *= 0.5;
            if start + stretch.length <= start {
                self.finite_between(start, start + longest)?;
                return Err(Error::NotAnalytic {
                    speed: start,
                    reached: None,
                });
            }
        }
    }
}

/// A stretch of speeds, with a function h of the speed on it: h(start + t) as a power series in t,
/// for 0 ≤ t ≤ length.
pub(super) struct Stretch {
    pub(super) start: f64,
    pub(super) length: f64,
    /// Piece of the law.
    pub(super) piece: usize,
    pub(super) series: PowerSeries,
}

impl Stretch {
    /// h(start + t), in one copy of the code.
    fn at(&self, t: f64) -> f64 {
        self.series.at(t)
    }

    /// Size of term k at the end of the stretch, |c_k| length^k.
    fn term(&self, k: usize) -> f64 {
        match self.series[k] {
            // Avoids 0·∞.
            0.0 => 0.0,
            coefficient => coefficient.abs() * self.length.powi(k as i32),
        }
    }

    fn largest_term(&self) -> f64 {
        (0..TERMS).map(|k| self.term(k)).fold(0.0, f64::max)
    }

    /// Error of h that is caused by rounding of start + t.
    fn rounding_of_speed(&self) -> f64 {
        let steepest = (1..TERMS).map(|k| k as f64 * self.term(k)).sum::<f64>() / self.length;
        f64::EPSILON * (self.start + self.length) * steepest
    }

    /// Returns true if the last two terms are rounding relative to `size`; two, because a series
    /// may be even or odd.
    pub(super) fn converges(&self, size: f64) -> bool {
        [TERMS - 2, TERMS - 1]
            .iter()
            .all(|&k| self.term(k) <= TRUNCATION * size)
    }

    /// Returns true if the series agrees with `h` at three places inside, to `allowed`.
    fn fits(&self, allowed: f64, h: impl Fn(f64) -> f64) -> bool {
        let times = quarters(self.length);
        std::iter::zip(times, self.series.at_some(times))
            // The end is left out: it may be a breakpoint, where the slope is that of the next
            // piece.
            .take(3)
            .all(|(t, value)| (h(self.start + t) - value).abs() <= allowed)
    }

    /// Shortens the interval so that no root of h lies at its end: rounding of the two series that
    /// meet there could lose the root or find it twice.
    fn end_away_from_zero(&mut self) {
        let ends = [1.0, 0.875, 0.75].map(|part| part * self.length);
        let height = |t: &f64| self.at(*t).abs();
        if let Some(end) = ends
            .into_iter()
            .max_by(|a, b| height(a).total_cmp(&height(b)))
        {
            self.length = end;
        }
    }
}

/// Part of a stretch, at either end, within which a root belongs to a zero at that end.
const AT_END: f64 = 1e-3;

/// Distance, relative to the speed, within which two roots may be one touch of zero, split by
/// rounding.
const TOUCH: f64 = 1e-6;

/// The sign changes of h, collected while h is followed.
struct SignChanges<H> {
    h: H,
    positive: Option<bool>,
    roots: Vec<f64>,
}

impl<H: Fn(f64) -> f64> SignChanges<H> {
    /// Adds the sign changes on a stretch, and one at its start if h jumps over zero or passes it
    /// there.
    fn follow(&mut self, stretch: &Stretch, rounding: f64) {
        let Stretch {
            start,
            length,
            series,
            ..
        } = stretch;
        if stretch.largest_term() <= rounding {
            return; // zero all along
        }
        // A zero at an end counts at the start of this stretch or of the next one.
        let is_zero = |t: f64| stretch.at(t).abs() <= rounding;
        let first = if is_zero(0.0) { AT_END * length } else { 0.0 };
        let last = if is_zero(*length) {
            (1.0 - AT_END) * length
        } else {
            *length
        };
        self.add(*start, stretch.at(first) > 0.0, rounding);
        series.sign_changes(*length, &mut |t, rising| {
            if first <= t && t <= last {
                self.add(start + t, rising, rounding);
            }
        });
    }

    /// Notes the sign of h from this speed on.
    fn add(&mut self, speed: f64, positive: bool, rounding: f64) {
        let before = self.positive.replace(positive);
        if before.is_none_or(|before| before == positive) {
            return;
        }
        match self.roots.last() {
            // A change and back again within rounding is none.
            Some(&last)
                if speed - last <= TOUCH * speed
                    && (self.h)(0.5 * (last + speed)).abs() <= rounding =>
            {
                self.roots.pop();
            }
            _ => self.roots.push(speed),
        }
    }
}
