//! A start that is tried, and what its motion comes to.

use nalgebra::DVector;

use super::map::PeriodMap;
use crate::error::Error;

/// A free motion leaves its start and comes back: it misses the start by at most this part of its
/// own extent, whatever its size, and no step of Newton's method leads farther than that away.
/// A motion that shrinks to a state of rest, or to no time at all, misses it by all of its extent.
const RETURN: f64 = 1e-2;

/// A miss below this, in units of the sizes, is rounding.
const LEAST_MISS: f64 = 1e-13;

/// A start, and the motion from there over one period.
#[derive(Debug, Clone)]
pub(super) struct Trial {
    pub(super) period: f64,
    pub(super) map: PeriodMap,
    /// Size of the residual, each number in units of its own size.
    pub(super) residual: f64,
}

impl Trial {
    pub(super) fn new(map: PeriodMap, period: f64) -> Self {
        Self {
            period,
            residual: map.miss(),
            map,
        }
    }

    /// Whether a motion that is closed to rounding leaves its start and comes back: each of its
    /// numbers is in units of the sizes.
    pub(super) fn returns(&self, step: Option<&DVector<f64>>) -> bool {
        let sizes = self.map.sizes();
        let away = self.map.extents(&sizes);
        let residual = self.map.residual().component_div(&sizes);
        std::iter::once(&residual).chain(step).all(|missed| {
            let missed = std::iter::zip(self.map.largest(missed), away);
            missed
                .into_iter()
                .all(|(missed, away)| missed.max(LEAST_MISS) <= RETURN * away)
        })
    }

    pub(super) fn not_periodic(self) -> Error {
        Error::NotPeriodic {
            residual: self.residual,
            period: self.period,
            start: self.map.start,
        }
    }
}
