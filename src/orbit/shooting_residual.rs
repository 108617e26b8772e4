//! One trial of a search: a start, its motion over one period, and the residual.

use nalgebra::DVector;

use super::period_map::PeriodMap;
use crate::error::Error;

/// An autonomous motion counts as one that leaves its start and returns if its residual and its
/// last Newton step are at most this part of its extent. If a motion shrinks to an equilibrium, or
/// to the duration 0, its residual is as large as its extent.
const RETURN: f64 = 1e-4;

/// A residual below this, in units of the sizes, is rounding.
const LEAST_MISS: f64 = 1e-13;

/// A start, and the motion from there over one period.
#[derive(Debug, Clone)]
pub(super) struct TrialMotion {
    pub(super) period: f64,
    pub(super) map: PeriodMap,
    /// Largest residual, each number in units of its errors.
    pub(super) residual: f64,
}

impl TrialMotion {
    pub(super) fn new(map: PeriodMap, period: f64) -> Self {
        Self {
            period,
            residual: map.miss(),
            map,
        }
    }

    /// Returns true if a motion that is closed to rounding leaves its start and returns: each of
    /// its numbers is in units of the sizes.
    pub(super) fn returns(&self, step: Option<&DVector<f64>>) -> bool {
        let sizes = self.map.sizes();
        let away = self.map.largest(&self.map.extents().component_div(&sizes));
        let residual = self.map.residual().component_div(&sizes);
        std::iter::once(&residual).chain(step).all(|missed| {
            let missed = std::iter::zip(self.map.largest(missed), away);
            missed
                .into_iter()
                .all(|(missed, away)| missed.max(LEAST_MISS) <= RETURN * away)
        })
    }

    /// The error if this motion does not close.
    pub(super) fn not_periodic(&self) -> Error {
        self.map.not_periodic(self.period)
    }
}
