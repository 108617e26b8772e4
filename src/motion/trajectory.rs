use std::borrow::Borrow;

use super::sealed::Part as _;
use super::{Event, Segment, SystemState};
use crate::error::Error;
use crate::state::State;

/// The reason why a motion ended: see
/// [`Integrator::simulate_until`](crate::Integrator::simulate_until).
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Ended {
    /// The duration is over.
    Duration,
    /// The stop condition ended the motion.
    Stopped,
    /// The integration failed, or a limit of steps or events was reached.
    Error(Error),
}

/// A motion over a finite time, with its events and its state at any time.
///
/// Returned by [`MassOnBelt::simulate`](crate::MassOnBelt::simulate) and
/// [`Structure::simulate`](crate::Structure::simulate). A trajectory contains the power series of
/// all steps, so the state at any time is as accurate as the states at the ends of steps.
///
/// ```
/// use stick_slip::{EventKind, MassOnBelt, Mode, Polynomial, State};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let motion = system.simulate(State::new(0.0, 0.0), 2.0)?;
/// let event = motion.events()[0];
/// assert_eq!(event.kind, EventKind::Stick);
/// assert!((event.time - 0.613882489595888487).abs() < 1e-15);
/// assert_eq!(motion.mode_at(event.time), Some(Mode::Stick));
/// assert_eq!(motion.state_at(1.7).unwrap().velocity, 0.2);
/// assert_eq!(motion.state_at(2.1), None);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Clone, PartialEq)]
pub struct Trajectory<S: SystemState = State> {
    /// The steps, at least one; the last reaches the end.
    steps: Vec<S::Step>,
    events: Vec<Event<S>>,
    start: f64,
    duration: f64,
    ended: Ended,
}

impl<S: SystemState> Trajectory<S> {
    pub(crate) fn new(steps: Vec<S::Step>, start: f64, duration: f64, ended: Ended) -> Self {
        let events = steps.iter().flat_map(|step| step.events().iter().cloned());
        let events = events.collect();
        Self {
            steps,
            events,
            start,
            duration,
            ended,
        }
    }

    /// The reason for the end of the motion. It is [`Ended::Duration`] unless the motion comes from
    /// [`simulate_until`](crate::Integrator::simulate_until).
    pub fn ended(&self) -> &Ended {
        &self.ended
    }

    /// The events in order of time, including an event exactly at the end.
    ///
    /// A start in stick is not an event. A start exactly at the release point is a release event at
    /// the start time.
    pub fn events(&self) -> &[Event<S>] {
        &self.events
    }

    /// The steps of the motion, as returned by [`Integrator::flow`](crate::Integrator::flow). The
    /// last step is cut at the end of the motion.
    pub fn steps(&self) -> &[S::Step] {
        &self.steps
    }

    /// Time from start to end, in the units of the system: τ, dimensionless, for a
    /// [`MassOnBelt`](crate::MassOnBelt).
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// State at the end of the motion.
    pub fn last(&self) -> S {
        // There is one at least.
        self.steps[self.steps.len() - 1].end_state()
    }

    /// State at a time from the start to the end of the motion; `None` for any other time and for
    /// NaN.
    ///
    /// The start is at time 0, unless
    /// [`Integrator::with_start_time`](crate::Integrator::with_start_time) sets another time.
    pub fn state_at(&self, time: f64) -> Option<S> {
        Some(self.step_at(time)?.state_at_time(time))
    }

    /// The states at n equidistant times from start to end, each with its time. For n = 0 the list
    /// is empty; for n = 1 it contains the start alone.
    ///
    /// ```
    /// use stick_slip::{Coulomb, MassOnBelt, State};
    ///
    /// let motion = MassOnBelt::new(Coulomb::new(0.4, 0.25)?, 0.5)?
    ///     .simulate(State::new(0.0, 0.5), 1.5)?;
    /// let times: Vec<f64> = motion.sample(4).map(|(time, _)| time).collect();
    /// assert_eq!(times, [0.0, 0.5, 1.0, 1.5]);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn sample(&self, n: usize) -> impl ExactSizeIterator<Item = (f64, S)> + '_ {
        let last = n.saturating_sub(1).max(1) as f64;
        (0..n).map(move |i| {
            let time = if i as f64 == last {
                self.end()
            } else {
                (self.start + self.duration * i as f64 / last).min(self.end())
            };
            let state = self.state_at(time).unwrap_or_else(|| self.last());
            (time, state)
        })
    }

    /// The states at given times, each with its time. Times outside of the motion, and times that
    /// are NaN, are skipped.
    ///
    /// ```
    /// use stick_slip::{Coulomb, MassOnBelt, State};
    ///
    /// let motion = MassOnBelt::new(Coulomb::new(0.4, 0.25)?, 0.5)?
    ///     .simulate(State::new(0.0, 0.5), 1.5)?;
    /// let states: Vec<_> = motion.sample_at([0.25, 0.5, 99.0]).collect();
    /// assert_eq!(states, [(0.25, State::new(0.125, 0.5)), (0.5, State::new(0.25, 0.5))]);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn sample_at<T: Borrow<f64>>(
        &self,
        times: impl IntoIterator<Item = T>,
    ) -> impl Iterator<Item = (f64, S)> {
        let times = times.into_iter().map(|time| *time.borrow());
        times.filter_map(|time| Some((time, self.state_at(time)?)))
    }

    /// The steps that hold the times start, start + interval, … up to the end, each with its time.
    pub(crate) fn steps_every(
        &self,
        interval: f64,
    ) -> Result<impl Iterator<Item = (f64, &S::Step)>, Error> {
        Error::check(
            "Trajectory",
            "interval",
            interval,
            interval > 0.0,
            "interval > 0",
        )?;
        // An interval that fits is not lost by rounding.
        let n = (self.duration / interval * (1.0 + 4.0 * f64::EPSILON)) as usize;
        let mut step = 0;
        Ok((0..=n).filter_map(move |i| {
            let time = (self.start + interval * i as f64).min(self.end());
            while let Some(next) = self.steps.get(step + 1)
                && next.start_time() <= time
            {
                step += 1;
            }
            Some((time, self.steps.get(step)?))
        }))
    }

    /// The time at which the motion ends.
    fn end(&self) -> f64 {
        self.start + self.duration
    }

    /// The step that holds a time: the last one that starts at that time or before.
    pub(crate) fn step_at(&self, time: f64) -> Option<&S::Step> {
        if !(self.start..=self.end()).contains(&time) {
            return None;
        }
        let after = self.steps.partition_point(|step| step.start_time() <= time);
        self.steps.get(after.checked_sub(1)?)
    }
}

/// Shows only the number of steps, because steps are long.
impl<S: SystemState + std::fmt::Debug> std::fmt::Debug for Trajectory<S> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Trajectory")
            .field("start", &self.start)
            .field("duration", &self.duration)
            .field("ended", &self.ended)
            .field("steps", &self.steps.len())
            .field("events", &self.events.len())
            .field("last", &self.last())
            .finish_non_exhaustive()
    }
}
