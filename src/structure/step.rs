use crate::clock::Clock;
use crate::error::Error;
use crate::motion::sealed::Sealed;
use crate::motion::{self, Event, EventKind, Mode, Segment, Steps, Stop, SystemState, Trajectory};
use crate::series::PowerSeries;
use crate::state::Direction;
use crate::state::structure::State;

/// A step of the motion of a [`Structure`](crate::Structure), with events at its end only.
///
/// Returned by [`Integrator::flow`](crate::Integrator::flow), and stored in a [`Trajectory`].
/// Between its ends it holds the power series of all velocities.
#[derive(Clone, PartialEq)]
pub struct Step {
    start: Clock,
    end: Clock,
    duration: f64,
    modes: Vec<Mode>,
    state: State,
    /// Series of the velocities, then of the memory variables; none for a step of duration 0.
    series: Vec<PowerSeries>,
    events: Vec<Event<State>>,
    after: EventData,
    end_state: State,
}

/// Data for the tangent flow about the events at the end of a step.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct EventData {
    /// Contacts with a coordinate to themselves, released by a jump of a drive.
    pub(crate) forced: Vec<usize>,
    /// v' just after, if a contact that shares coordinates has an event.
    pub(crate) rates: Vec<f64>,
    /// The condition that determines the time of events of contacts that share coordinates; none at
    /// a jump of a drive.
    pub(crate) trigger: Option<Trigger>,
    /// Elastic contacts that came to their limit there, and on which side: their sliders start, or
    /// the load has jumped below what they carried.
    pub(crate) limited: Vec<(usize, Direction)>,
}

/// The condition that a contact with shared coordinates has reached; it may have no event itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Trigger {
    /// Rest: r = 0.
    Rest(usize),
    /// The bound of its stick band on a side; the rate of σλ − N μ_s just before, multiplied by
    /// G_cc.
    Bound(usize, Direction, f64),
}

impl Step {
    /// A step with its duration and the time of its end.
    pub(super) fn new(
        start: Clock,
        (duration, end): (f64, Clock),
        modes: Vec<Mode>,
        state: State,
        series: Vec<PowerSeries>,
        events: Vec<Event<State>>,
        end_state: State,
    ) -> Self {
        Self {
            start,
            end,
            duration,
            modes,
            state,
            series,
            events,
            after: EventData::default(),
            end_state,
        }
    }

    /// The same step, with the data about the events at its end.
    pub(super) fn followed_by(self, after: EventData) -> Self {
        Self { after, ..self }
    }

    /// The data about the events at its end.
    pub(crate) fn after(&self) -> &EventData {
        &self.after
    }

    /// The clock at its start.
    pub(crate) fn clock(&self) -> Clock {
        self.start
    }

    /// The same step over another duration, shorter or longer, by its power series, without events.
    pub(crate) fn lasting(self, duration: f64) -> Self {
        Self {
            end_state: self.state_at(duration),
            end: self.start.after(duration),
            duration,
            events: Vec::new(),
            after: EventData::default(),
            ..self
        }
    }

    /// The same step with a contact that comes to rest at its end, in a state there.
    pub(crate) fn coming_to_rest(self, contact: usize, state: State) -> Self {
        let event = Event {
            time: self.end.time,
            contact,
            kind: EventKind::Stick,
            state: state.clone(),
        };
        Self {
            events: vec![event],
            end_state: state,
            ..self
        }
    }

    /// Power series of the velocities in the time since the start, then of the memory variables;
    /// none for a step of duration 0.
    pub(crate) fn series(&self) -> &[PowerSeries] {
        &self.series
    }

    /// Returns true if a release at its end was forced by a jump of a drive.
    pub(crate) fn is_forced(&self, contact: usize) -> bool {
        self.after.forced.contains(&contact)
    }

    /// The mode of each contact during the step.
    pub fn modes(&self) -> &[Mode] {
        &self.modes
    }

    /// State at the start of the step. If the step begins at an event, the memory variables have
    /// their values after the event.
    pub fn state(&self) -> &State {
        &self.state
    }
}

/// Shows a step without its power series, which are long.
impl std::fmt::Debug for Step {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Step")
            .field("start_time", &self.start.time)
            .field("duration", &self.duration)
            .field("modes", &self.modes)
            .field("state", &self.state)
            .field("events", &self.events)
            .finish_non_exhaustive()
    }
}

impl Sealed for Step {}

impl Segment for Step {
    type State = State;

    fn start_time(&self) -> f64 {
        self.start.time
    }

    fn end_time(&self) -> f64 {
        self.end.time
    }

    fn duration(&self) -> f64 {
        self.duration
    }

    fn since_start(&self, time: f64) -> f64 {
        self.start.until(time).clamp(0.0, self.duration)
    }

    fn state_at(&self, t: f64) -> State {
        if t == 0.0 || self.series.is_empty() {
            return self.state.clone();
        }
        if t == self.duration && t.is_finite() {
            return self.end_state.clone();
        }
        let n = self.state.displacements.len();
        let (velocities, memory) = self.series.split_at(n);
        let displacements = std::iter::zip(&self.state.displacements, velocities);
        State {
            displacements: displacements.map(|(q, v)| q + t * v.mean(t)).collect(),
            velocities: velocities.iter().map(|v| v.at(t)).collect(),
            memory: memory.iter().map(|z| z.at(t)).collect(),
        }
    }

    fn end_state(&self) -> State {
        self.end_state.clone()
    }

    fn events(&self) -> &[Event<State>] {
        &self.events
    }

    fn until(self, time: f64) -> Self {
        let duration = self.since_start(time);
        Self {
            end_state: self.state_at(duration),
            end: Clock::at(time),
            duration,
            events: Vec::new(),
            after: EventData::default(),
            ..self
        }
    }
}

impl Sealed for State {}

impl SystemState for State {
    type Step = Step;

    fn trajectory(
        steps: Steps<'_, Step>,
        start_time: f64,
        duration: f64,
        stop: Option<Stop<'_, Step>>,
    ) -> Result<Trajectory<Self>, Error> {
        motion::trajectory(steps, start_time, duration, stop)
    }
}

impl Trajectory<State> {
    /// The mode of a contact at a time of the motion; at the time of an event, the mode after it.
    /// `None` if the time lies outside the motion or is NaN, or if there is no such contact.
    pub fn mode_at(&self, contact: usize, time: f64) -> Option<Mode> {
        self.step_at(time)?.modes().get(contact).copied()
    }

    /// Samples of the motion at equal intervals, from its start to the last sampling time within
    /// the motion: time, state, and the mode of each contact.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless the interval is finite and > 0.
    ///
    /// ```
    /// use stick_slip::{Contact, Coulomb, Mode, Structure, structure};
    ///
    /// let structure = Structure::new(&[2.0])?
    ///     .with_ground_spring(0, 50.0)?
    ///     .with_contact(Contact::new(0, Coulomb::new(0.4, 0.3)?, 20.0)?.on_belt(0.1))?;
    /// let motion = structure.simulate(structure::State::at_rest(1), 2.0)?;
    /// let sticks = motion.sample_every(1e-3)?.filter(|(_, _, modes)| modes[0] == Mode::Stick);
    /// assert!(sticks.count() > 500);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn sample_every(
        &self,
        interval: f64,
    ) -> Result<impl Iterator<Item = (f64, State, &[Mode])>, Error> {
        let steps = self.steps_every(interval)?;
        Ok(steps.map(|(time, step)| (time, step.state_at(step.since_start(time)), step.modes())))
    }
}
