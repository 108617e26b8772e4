//! How far the series of coordinates and contacts reach.

use super::coordinate_series::DisplacementSeries;
use super::model::Model;
use super::series::Series;
use super::state::{Phase, Situation};
use crate::motion::step_control::{reach, root_of_ratio};
use crate::series::{PowerSeries, TERMS};

/// How far series reach.
#[derive(Clone, Copy)]
pub(super) struct Reach {
    pub(super) tolerance: f64,
    /// True if there are force elements, or functions of users as drives. A series whose last
    /// terms are 0 is then no polynomial: that of x'' = −x⁶ from x = 0 has every seventh term only.
    pub(super) has_gaps: bool,
    /// Number of the last orders that no series has.
    pub(super) dropped: usize,
}

impl Reach {
    /// The reach of a series; infinite if it ends before its last terms, even if no error is
    /// allowed because nothing moves.
    #[inline(always)]
    pub(super) fn of(self, error: f64, c: &PowerSeries, n: usize) -> f64 {
        // Roots are taken of the last order and of the one before it.
        let n = n.saturating_sub(self.dropped).max(2);
        let by_last = if c[n] == 0.0 && c[n - 1] == 0.0 {
            f64::INFINITY
        } else {
            reach(error, c, n)
        };
        if !self.has_gaps {
            return by_last;
        }
        /// The last terms of a series without gaps may show a radius that is larger by this factor:
        /// that of e^t at order 26 is 1.28 times that at order 19.
        const DENSE: f64 = 1.5;
        let over_gaps = self.over_gaps(error, c, n);
        if by_last <= DENSE * over_gaps {
            by_last
        } else {
            over_gaps
        }
    }

    /// The reach by the least radius of convergence that one of the last terms shows.
    #[inline(never)]
    fn over_gaps(self, error: f64, c: &PowerSeries, n: usize) -> f64 {
        /// Number of the last terms of which one at least is not 0 in a series with gaps.
        const LAST: usize = 8;
        let radii = (n.saturating_sub(LAST - 1).max(1)..=n).filter(|&k| c[k] != 0.0);
        let radii = radii.map(|k| root_of_ratio(error / self.tolerance, c[k].abs(), k));
        let least = radii.fold(f64::INFINITY, f64::min);
        root_of_ratio(self.tolerance, 1.0, n) * least
    }
}

/// The velocity of a coordinate as it is integrated: v = w + σy with a contact of its own.
pub(super) enum CoordinateMotion<'a> {
    Free(&'a DisplacementSeries),
    Slips(&'a PowerSeries, &'a PowerSeries),
    Sticks(&'a PowerSeries),
}

#[inline(always)]
pub(super) fn motion<'a>(
    model: &Model<'_>,
    situation: &Situation,
    series: &'a Series,
    i: usize,
) -> CoordinateMotion<'a> {
    let owner = model.owner[i].map(|c| (situation.contacts[c].phase, &series.contacts[c]));
    match owner {
        Some((Phase::Slip { .. }, of)) => CoordinateMotion::Slips(&of.speeds, &of.surface),
        Some((Phase::Stick { .. }, of)) => CoordinateMotion::Sticks(&of.surface),
        Some((Phase::Open, _)) | None => CoordinateMotion::Free(&series.coordinates[i].motion),
    }
}

impl CoordinateMotion<'_> {
    /// Coefficient k of y, or of v.
    pub(super) fn speed(&self, k: usize) -> f64 {
        match self {
            Self::Free(motion) => motion.velocity(k),
            Self::Slips(speeds, _) => speeds[k],
            Self::Sticks(_) => 0.0,
        }
    }

    /// Coefficient k of w.
    pub(super) fn surface(&self, k: usize) -> f64 {
        match self {
            Self::Free(_) => 0.0,
            Self::Slips(_, surface) | Self::Sticks(surface) => surface[k],
        }
    }

    pub(super) fn largest_change(&self, time: f64) -> f64 {
        match self {
            Self::Free(motion) => motion.velocities().largest_change(time),
            Self::Slips(speeds, _) => speeds.largest_change(time),
            Self::Sticks(surface) => surface.largest_change(time),
        }
    }

    pub(super) fn reach(&self, reaches: Reach, error: f64) -> f64 {
        let of = |series| reaches.of(error, series, TERMS - 1);
        match self {
            Self::Free(motion) => of(&motion.velocities()),
            Self::Slips(speeds, surface) => of(speeds).min(of(surface)),
            Self::Sticks(surface) => of(surface),
        }
    }
}
