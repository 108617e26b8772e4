//! The course of a periodic motion over its period: kept, or computed again when it is asked for.

use std::sync::{Arc, OnceLock};

use super::prescribed_modes::{HeldFlow, Hold};
use super::time_integration::collect;
use super::type_erased_system::GeneralForm;
use crate::motion::{Integrator, Segment, SystemState, Trajectory};
use crate::state::structure::State;
use crate::structure::Step;

/// What a closed motion is computed again from, equal in every bit: its steps fill a hundred times
/// as much.
#[derive(Debug, Clone, PartialEq)]
pub struct Course {
    /// The time and the state at which it begins.
    pub(super) time: f64,
    pub(super) start: State,
    pub(super) holds: Vec<Hold>,
    /// The displacements by which it is translated over a period.
    pub(super) translation: Vec<f64>,
}

impl Course {
    /// The steps of the motion from time 0 of the drives. A search has computed them before, so
    /// that errors cannot occur, and has counted them.
    pub(super) fn steps(&self, form: &GeneralForm<'_>, period: f64) -> Vec<Step> {
        let mut steps = Vec::new();
        let flow = HeldFlow::new(form, Integrator::new(), self.time, &self.start, &self.holds);
        let _ = flow
            .and_then(|mut flow| collect(&mut flow, (self.time, period), &mut steps, &|_| Ok(())));
        since_zero(steps, period, &self.translation)
    }
}

/// The steps of a closed motion from time 0 of the drives.
pub(super) fn since_zero(steps: Vec<Step>, period: f64, translation: &[f64]) -> Vec<Step> {
    if steps.first().is_none_or(|step| step.start_time() == 0.0) {
        return steps;
    }
    let mut before = Vec::new();
    let mut after = Vec::new();
    for step in steps {
        let since = step.since_start(period);
        if since >= step.duration() {
            before.push(step);
            continue;
        }
        if since > 0.0 {
            before.push(step.clone().lasting(since));
        }
        let later = step.from(since.max(0.0));
        after.push(later.earlier(period, translation));
    }
    after.extend(before);
    after
}

/// The motion over one period in the states of its system.
#[derive(Clone)]
pub enum KeptMotion<S: SystemState> {
    Known(Trajectory<S>),
    /// Computed when it is asked for first.
    Later(Again<S>, OnceLock<Trajectory<S>>),
}

type Again<S> = Arc<dyn Fn() -> Trajectory<S> + Send + Sync>;

impl<S: SystemState> KeptMotion<S> {
    pub(super) fn trajectory(&self) -> &Trajectory<S> {
        match self {
            Self::Known(trajectory) => trajectory,
            Self::Later(again, known) => known.get_or_init(|| again()),
        }
    }
}
