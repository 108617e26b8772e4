//! The common part of the curves of all bifurcations.

use super::super::phase_condition::FrozenStart;
use super::super::shooting_residual::TrialMotion;
use super::super::type_erased_system::GeneralForm;
use super::change::Change;
use super::found::SpecialKind;
use super::motions::Motions;
use crate::numerics::trace::{Equations, Point};

/// The equations of a curve of motions.
pub(super) trait CurveOfMotions<'f>: Equations {
    fn motions(&self) -> &Motions<'f>;

    /// The motion of a value, and where it begins.
    fn motion(value: &Self::Value) -> (&TrialMotion, &FrozenStart);

    /// The kind of special point at a zero of a test.
    fn special(&self, test: usize, point: &Point<Self::Value>) -> Option<SpecialKind>;

    /// Returns true if the events of the motion are others just behind a point.
    fn jumps_behind(&self, point: &Point<Self::Value>) -> bool;

    /// The value with another change of events held.
    fn holding(&self, value: &Self::Value, change: &Change) -> Self::Value;

    /// The kind of special point at which another change of events happens.
    fn kind_with(
        &self,
        form: &GeneralForm<'_>,
        trial: &TrialMotion,
        change: &Change,
    ) -> Option<SpecialKind>;
}
