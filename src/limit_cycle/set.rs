use std::ops::Range;

use super::continuum::Continuum;
use super::cycle::LimitCycle;
use crate::state::Units;

/// The periodic motions of a system, found by [`find`](super::find): the isolated cycles by
/// ascending amplitude, a continuous family if there is one, and the unresolved ranges.
///
/// ```
/// use stick_slip::{MassOnBelt, Polynomial, limit_cycle};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.4071)?.with_damping(0.05)?;
/// let cycles = limit_cycle::find(&system)?;
/// assert_eq!(cycles.len(), 1);
/// assert_eq!(cycles.unstable().count(), 0);
/// let cycle = &cycles[0];
/// assert!(cycle.is_stable());
/// assert!((cycle.max_velocity() - 0.3436099223332305314).abs() < 1e-14);
/// assert!((cycle.multiplier() - 0.7118018577630064207).abs() < 1e-13);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CycleSet {
    pub(super) cycles: Vec<LimitCycle>,
    pub(super) continuum: Option<Continuum>,
    pub(super) unresolved: Vec<Range<f64>>,
}

impl CycleSet {
    /// The isolated cycles, by ascending amplitude. In the plane of displacement and velocity each
    /// cycle lies inside the next.
    pub fn iter(&self) -> std::slice::Iter<'_, LimitCycle> {
        self.cycles.iter()
    }

    /// The stable cycles, by ascending amplitude.
    pub fn stable(&self) -> impl Iterator<Item = &LimitCycle> {
        self.iter().filter(|cycle| cycle.is_stable())
    }

    /// The cycles that are not stable, by ascending amplitude.
    pub fn unstable(&self) -> impl Iterator<Item = &LimitCycle> {
        self.iter().filter(|cycle| !cycle.is_stable())
    }

    /// The isolated cycles as a slice, by ascending amplitude.
    pub fn as_slice(&self) -> &[LimitCycle] {
        &self.cycles
    }

    /// Adds a cycle outside the others, if there is one.
    #[inline(never)]
    pub(super) fn add(&mut self, cycle: Option<LimitCycle>) {
        self.cycles.extend(cycle);
    }

    /// Replaces the motions by their mirror images.
    pub(super) fn mirror(&mut self) {
        self.cycles.iter_mut().for_each(LimitCycle::mirror);
    }

    /// Converts these dimensionless motions to other units.
    pub(crate) fn in_units(self, units: Units) -> Self {
        let cycles = self.cycles.into_iter().map(|cycle| cycle.in_units(units));
        let continuum = self.continuum.map(|continuum| Continuum {
            max_amplitude: continuum.max_amplitude * units.length,
        });
        let ranges = self.unresolved.iter();
        let ranges = ranges.map(|range| Range {
            start: range.start * units.velocity(),
            end: range.end * units.velocity(),
        });
        Self {
            cycles: cycles.collect(),
            continuum,
            unresolved: ranges.collect(),
        }
    }

    /// Number of isolated cycles.
    pub fn len(&self) -> usize {
        self.cycles.len()
    }

    /// Returns true if there is no isolated cycle.
    pub fn is_empty(&self) -> bool {
        self.cycles.is_empty()
    }

    /// The continuous family of periodic motions; `None` if there is none.
    pub fn continuum(&self) -> Option<Continuum> {
        self.continuum
    }

    /// Ranges of peak velocities in which the number of cycles is not resolved. The peak velocity
    /// is the largest velocity in the direction of the belt, dimensionless.
    ///
    /// There are three reasons:
    ///
    /// * Motions decay strongly at the lower end of the range and grow strongly at its upper end,
    ///   and the range is too narrow to be divided. The range contains at least one unstable cycle,
    ///   usually one cycle in all. If there are more, stable cycles lie between unstable ones.
    /// * Motions in the range change over one period by no more than rounding errors, and
    ///   [`averaging`](crate::analysis::averaging) cannot exclude a cycle among them.
    /// * The law rises and falls thousands of times. The search then ends after 2·10⁵ steps, and
    ///   the rest of the range of peak velocities is unresolved.
    pub fn unresolved(&self) -> &[Range<f64>] {
        &self.unresolved
    }
}

impl<'s> IntoIterator for &'s CycleSet {
    type Item = &'s LimitCycle;
    type IntoIter = std::slice::Iter<'s, LimitCycle>;
    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

impl IntoIterator for CycleSet {
    type Item = LimitCycle;
    type IntoIter = std::vec::IntoIter<LimitCycle>;
    fn into_iter(self) -> Self::IntoIter {
        self.cycles.into_iter()
    }
}

/// Isolated cycle number `index`, by ascending amplitude. Panics if there is no such cycle.
impl std::ops::Index<usize> for CycleSet {
    type Output = LimitCycle;
    fn index(&self, index: usize) -> &LimitCycle {
        &self.cycles[index]
    }
}
