//! Settings, steps, events and trajectories of any system.

// | file | what is in it |
// |---|---|
// | `integrator.rs` | `Integrator`: tolerance, limits of work, `simulate` and `flow` |
// | `attractor.rs` | `AttractorKind` |
// | `energy.rs` | `EnergyBudget`: work and heat of a motion |
// | `event.rs` | `Event`, `EventKind`, `Mode`; the mode after each kind of event |
// | `step_control.rs` | step sizes, accepted defects, the limit of stiffness |
// | `run_limits.rs` | counts and limits of one run (the clock itself: `src/clock.rs`) |
// | `trajectory.rs` | `Trajectory`: a motion over a finite time, and why it ended (`Ended`) |
// | `first_zero.rs` | the first zero of a user's function in a step |

mod attractor;
mod energy;
mod event;
mod first_zero;
mod integrator;
mod run_limits;
pub(crate) mod step_control;
mod trajectory;

pub use attractor::AttractorKind;
pub use energy::EnergyBudget;
pub use event::{Event, EventKind, Mode};
pub use integrator::Integrator;
pub(crate) use integrator::{Steps, Stop, trajectory};
pub(crate) use run_limits::Run;
pub use trajectory::{Ended, Trajectory};

use std::fmt::Debug;

use crate::error::Error;

/// Items of the sealed traits that only the crate calls, hidden from users.
pub(crate) mod sealed {
    use super::{Integrator, Segment, Steps, Stop, System, SystemState, Trajectory};
    use crate::error::Error;
    use crate::series::PowerSeries;
    use crate::state::structure;

    pub trait Sealed {}

    pub trait Flow<'s, S: System + ?Sized>: Sized {
        /// The motion from `start`, as returned by [`Integrator::flow`].
        fn new(system: &'s S, settings: Integrator, start: S::State) -> Result<Self, Error>;
    }

    pub trait State: Sized {
        /// The state in its general form.
        fn general(&self) -> structure::State;

        /// The state with this general form.
        fn of_general(state: &structure::State) -> Self;

        /// Collects steps into a motion over a duration, or until it is stopped or fails. Compiled
        /// once for each type of state.
        fn trajectory(
            steps: Steps<'_, <Self as SystemState>::Step>,
            start_time: f64,
            duration: f64,
            stop: Option<Stop<'_, <Self as SystemState>::Step>>,
        ) -> Result<Trajectory<Self>, Error>
        where
            Self: SystemState;
    }

    pub trait Part {
        /// The series of the relative velocity of a contact since the start of the step, exact to
        /// its last digits also where the contact creeps; `None` in a step of duration 0, or if
        /// there is no such contact.
        fn relative_velocity(&self, contact: usize) -> Option<PowerSeries>;

        /// The state at a time of the step, as [`Trajectory::state_at`] returns it: a time since
        /// the start has a rounding error of its own.
        fn state_at_time(&self, time: f64) -> <Self as Segment>::State
        where
            Self: Segment,
        {
            self.state_at(self.since_start(time))
        }

        /// The part of the step before a motion's end, as a duration: none at the time of the event
        /// before it, from which `time` differs by its rounding.
        fn before_end(&self, time: f64) -> f64
        where
            Self: Segment,
        {
            match time == self.start_time() {
                true => 0.0,
                false => self.since_start(time),
            }
        }
    }
}

/// A system with equations of motion for the [`Integrator`]: [`MassOnBelt`](crate::MassOnBelt) or
/// [`Structure`](crate::Structure). The trait is sealed: no other type can implement it.
pub trait System: sealed::Sealed {
    /// The state of the system at one time.
    type State: SystemState;
    /// The motion of the system, step by step.
    type Flow<'s>: Iterator<Item = Result<<Self::State as SystemState>::Step, Error>>
        + sealed::Flow<'s, Self>
    where
        Self: 's;
}

/// The state of a system: [`State`](crate::State) of one mass, or
/// [`structure::State`](crate::structure::State) of several. The trait is sealed: no other type can
/// implement it.
pub trait SystemState: sealed::State + Clone + Debug {
    /// The type of a step of the motion.
    type Step: Segment<State = Self>;
}

/// A step of any system: a part of a motion with events only at its end. The trait is sealed: no
/// other type can implement it.
///
/// All times are in the units of the system.
pub trait Segment: sealed::Part + Clone {
    /// The state of the system at one time.
    type State: SystemState<Step = Self>;

    /// Time at which the step starts.
    fn start_time(&self) -> f64;
    /// Time at which the step ends; infinite if all velocities stay constant and no further event
    /// follows.
    fn end_time(&self) -> f64;
    /// Duration of the step; infinite if all velocities stay constant and no further event follows.
    fn duration(&self) -> f64;
    /// Time elapsed at `time` since the **start** of the step: 0 if `time` lies before the step,
    /// and the duration of the step if `time` lies after the step.
    fn since_start(&self, time: f64) -> f64;
    /// State at a finite time t after the **start** of the step,
    /// 0 ≤ t ≤ [`duration`](Self::duration).
    fn state_at(&self, t: f64) -> Self::State;
    /// State at the end of the step; if it ends with an event, the state of the event.
    fn end_state(&self) -> Self::State;
    /// The events that end the step, in the order of the contacts.
    fn events(&self) -> &[Event<Self::State>];
    /// Returns the part of the step up to `time`, without the events at the end of the step.
    fn until(self, time: f64) -> Self;

    /// The first time in this step at which a function f of the state is 0. The time is exact to
    /// the last bit. `None` if f has no zero in this step, or if the step has infinite duration.
    ///
    /// f must be continuous. If f is NaN where it is evaluated, at or before its first zero, the
    /// result is NaN, and [`Integrator::simulate_until`] returns an error. A zero at the start of
    /// the step does not count: it belongs to the step before. A zero without a change of sign may
    /// be missed. f is evaluated at 33 times. Between these times, extremes of f near zero are
    /// searched. Two zeros between neighbouring times are therefore usually found; they may be
    /// missed near another such pair or near an end of the step. (A slip phase has several steps,
    /// each usually at most one radian of the vibration long.)
    ///
    /// ```
    /// use stick_slip::{Integrator, MassOnBelt, Polynomial, Segment, State};
    ///
    /// // When does the mass first turn back?
    /// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
    /// for step in Integrator::new().flow(&system, State::new(0.0, 0.0))?.skip(1) {
    ///     let step = step?;
    ///     if let Some(time) = step.first_zero(|state| state.velocity) {
    ///         assert!((time - 3.6286366270396).abs() < 1e-12);
    ///         break;
    ///     }
    /// }
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    fn first_zero(&self, mut f: impl FnMut(&Self::State) -> f64) -> Option<f64> {
        let h = self.duration();
        // The state of an event, in which what is 0 is 0 to the last bit; the series are rounded.
        let mut value = |t: f64| match t == h {
            true => f(&self.end_state()),
            false => f(&self.state_at(t)),
        };
        let t = first_zero::first_zero(&mut value, h)?;
        if t == h {
            return Some(self.end_time());
        }
        let time = self.start_time() + t;
        // The sum may round beyond the end. `min` would hide NaN.
        let is_beyond = time > self.end_time();
        Some(if is_beyond { self.end_time() } else { time })
    }
}
