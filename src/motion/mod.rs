//! What the motions of every system share. Nothing here knows a system.
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

/// A system that the [`Integrator`] can follow: [`MassOnBelt`](crate::MassOnBelt). Sealed.
pub trait System: sealed::Sealed {
    /// What is known of it at one time.
    type State: SystemState;
    /// Its motion, step by step.
    type Flow<'s>: Iterator<Item = Result<<Self::State as SystemState>::Step, Error>>
    where
        Self: 's;

    /// The motion from `start`, as [`Integrator::flow`] gives it.
    #[doc(hidden)]
    fn flow(&self, settings: Integrator, start: Self::State) -> Result<Self::Flow<'_>, Error>;
}

/// A state of some kind of system: [`State`](crate::State) of one mass. Sealed.
pub trait SystemState: sealed::Sealed + Clone {
    /// A step of a motion through such states.
    type Step: Segment<State = Self>;
}

/// A stretch of a motion, with events at its end only. Sealed.
pub trait Segment: sealed::Sealed + Clone {
    /// What is known of the system at one time.
    type State: SystemState<Step = Self>;

    /// Time at which it starts, in the units of the system.
    fn start_time(&self) -> f64;
    /// Time at which it ends; infinite for a rest that lasts for ever.
    fn end_time(&self) -> f64;
    /// How long it lasts; infinite for a rest that lasts for ever.
    fn duration(&self) -> f64;
    /// Time since its start at a time of the motion, kept within 0 and its duration.
    fn since_start(&self, time: f64) -> f64;
    /// State at a finite time t after its **start**, 0 ≤ t ≤ [`duration`](Self::duration).
    fn state_at(&self, t: f64) -> Self::State;
    /// State at its end; at an event the event's own.
    fn end_state(&self) -> Self::State;
    /// The events that end it, in the order of the contacts.
    fn events(&self) -> &[Event<Self::State>];
    /// The part of it that lies before `time`, which it does not reach itself.
    fn until(self, time: f64) -> Self;
}
