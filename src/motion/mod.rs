//! What the motions of every system share. No file here knows a system.
//!
//! | file | what is in it |
//! |---|---|
//! | `integrator.rs` | [`Integrator`]: tolerance, limits of work, `simulate` and `flow` |
//! | `event.rs` | [`Event`], [`EventKind`], [`Mode`]; which mode follows each kind of event |
//! | `step_control.rs` | how long a step may be, which defect is accepted, what counts as stiff |
//! | `run.rs` | counts and limits of one run (the clock itself: `src/clock.rs`) |
//! | `trajectory.rs` | [`Trajectory`]: a motion over a finite time |

mod event;
mod integrator;
mod run;
pub(crate) mod step_control;
mod trajectory;

pub use event::{Event, EventKind, Mode};
pub use integrator::Integrator;
pub(crate) use run::Run;
pub use trajectory::Trajectory;

use crate::error::Error;

pub(crate) mod sealed {
    pub trait Sealed {}
}

/// A system that the [`Integrator`] can follow: [`MassOnBelt`](crate::MassOnBelt) or
/// [`Structure`](crate::Structure). Sealed: no other type can implement it.
pub trait System: sealed::Sealed {
    /// The state of the system at one time.
    type State: SystemState;
    /// The motion of the system, step by step.
    type Flow<'s>: Iterator<Item = Result<<Self::State as SystemState>::Step, Error>>
    where
        Self: 's;

    /// The motion from `start`, as [`Integrator::flow`] gives it.
    #[doc(hidden)]
    fn flow(&self, settings: Integrator, start: Self::State) -> Result<Self::Flow<'_>, Error>;
}

/// The state of a system: [`State`](crate::State) of one mass, or
/// [`structure::State`](crate::structure::State) of several. Sealed: no other type can implement
/// it.
pub trait SystemState: sealed::Sealed + Clone {
    /// The steps of which motions through such states consist.
    type Step: Segment<State = Self>;
}

/// A stretch of a motion without events but at its end: a step of any system. Sealed: no other
/// type can implement it.
///
/// All times are in the units of the system.
pub trait Segment: sealed::Sealed + Clone {
    /// The state of the system at one time.
    type State: SystemState<Step = Self>;

    /// Time at which the stretch starts.
    fn start_time(&self) -> f64;
    /// Time at which the stretch ends; infinite for a rest that lasts for ever.
    fn end_time(&self) -> f64;
    /// How long the stretch lasts; infinite for a rest that lasts for ever.
    fn duration(&self) -> f64;
    /// The time that has passed at `time` since the **start** of the stretch: 0 before the stretch,
    /// and its duration after it.
    fn since_start(&self, time: f64) -> f64;
    /// State at a finite time t after the **start** of the stretch,
    /// 0 ≤ t ≤ [`duration`](Self::duration).
    fn state_at(&self, t: f64) -> Self::State;
    /// State at the end of the stretch; if it ends with an event, the state of the event.
    fn end_state(&self) -> Self::State;
    /// The events that end the stretch, in the order of the contacts.
    fn events(&self) -> &[Event<Self::State>];
    /// The stretch cut short at `time`, without the events at its end.
    fn until(self, time: f64) -> Self;
}
