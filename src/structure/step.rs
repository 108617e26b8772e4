use std::sync::{Arc, OnceLock};

use super::engine::mode_constraints::Modes;
use super::trigger::EventData;
use crate::clock::Clock;
use crate::error::{Element, Error};
use crate::motion::sealed::{self, Part as _};
use crate::motion::{self, Event, EventKind, Mode, Segment, Steps, Stop, SystemState, Trajectory};
use crate::series::PowerSeries;
use crate::state::structure::State;

/// A step of the motion of a [`Structure`](crate::Structure). Events occur only at the end of a
/// step.
///
/// Returned by [`Integrator::flow`](crate::Integrator::flow), and stored in a [`Trajectory`]. The
/// step contains the power series of all velocities.
#[derive(Clone)]
pub struct Step {
    start: Clock,
    end: Clock,
    duration: f64,
    /// Shared with other steps in the same modes.
    modes: Arc<Modes>,
    /// The number of coordinates.
    coordinates: usize,
    /// Displacements, velocities, memory variables and relative velocities at the start, then at
    /// the end: in one piece, for a step is emitted faster the fewer its parts are.
    ends: Vec<f64>,
    /// The state at the start, once it was asked for.
    state: OnceLock<Box<State>>,
    /// Series of the velocities, then of the memory variables, then of the relative velocities that
    /// are numbers of a state; none for a step of duration 0.
    series: Vec<PowerSeries>,
    /// Apart, because few steps have one: a step is copied faster the smaller it is.
    ending: Option<Box<Ending>>,
}

/// The events at the end of a step.
#[derive(Debug, Clone, PartialEq, Default)]
struct Ending {
    events: Vec<Event<State>>,
    after: EventData,
}

impl Step {
    /// A step with its duration and the time of its end, the number of coordinates, all numbers of
    /// the states at its ends, and what happens at its end.
    pub(super) fn new(
        start: Clock,
        (duration, end): (f64, Clock),
        modes: Arc<Modes>,
        (coordinates, ends): (usize, Vec<f64>),
        series: Vec<PowerSeries>,
        (events, after): (Vec<Event<State>>, EventData),
    ) -> Self {
        let is_plain = events.is_empty() && after == EventData::NONE;
        Self {
            start,
            end,
            duration,
            modes,
            coordinates,
            ends,
            state: OnceLock::new(),
            series,
            ending: (!is_plain).then(|| Box::new(Ending { events, after })),
        }
    }

    /// The numbers of the states at its start and its end.
    fn ends(&self) -> (&[f64], &[f64]) {
        self.ends.split_at(self.ends.len() / 2)
    }

    /// The state with these numbers.
    fn state_of(&self, numbers: &[f64]) -> State {
        self.modes.state(self.coordinates, numbers)
    }

    /// The state at a time, of which also the duration since the start is known; beyond the step,
    /// that of its series continued.
    fn state_since(&self, t: f64, time: f64) -> State {
        let (start, end) = self.ends();
        if t == 0.0 || self.series.is_empty() {
            return self.state_of(start);
        }
        if t == self.duration && t.is_finite() {
            return self.state_of(end);
        }
        let (velocities, memory) = self.series().split_at(self.coordinates);
        let sliding = self.modes.sliding.iter().copied();
        let relative = &self.series[self.series().len()..];
        let displacements = std::iter::zip(start, velocities);
        let displacements = displacements.map(|(q, v)| q + t * v.mean(t));
        let mut parts: [Vec<f64>; 3] = [
            displacements.collect(),
            velocities.iter().map(|v| v.at(t)).collect(),
            memory.iter().map(|z| z.at(t)).collect(),
        ];
        let [displacements, velocities, memory] = &mut parts;
        let is_within = (0.0..=self.duration).contains(&t);
        self.modes
            .put((time, is_within), displacements, velocities, memory);
        let sliding = std::iter::zip(sliding, relative.iter().map(|r| r.at(t)));
        State::of_parts(parts).sliding_at(sliding)
    }

    /// Sets another state at the end of the step.
    fn ending_in(mut self, state: &State) -> Self {
        self.ends.truncate(self.ends.len() / 2);
        self.ends.extend(state.numbers());
        self
    }

    /// The data about the events at its end.
    pub(crate) fn after(&self) -> &EventData {
        static NONE: EventData = EventData::NONE;
        self.ending.as_ref().map_or(&NONE, |ending| &ending.after)
    }

    /// The clock at its start.
    pub(crate) fn clock(&self) -> Clock {
        self.start
    }

    /// Extends or cuts the step to another duration, shorter or longer, by its power series,
    /// without events.
    pub(crate) fn lasting(self, duration: f64) -> Self {
        let state = self.state_at(duration);
        Self {
            end: self.start.after(duration),
            duration,
            ending: None,
            ..self.ending_in(&state)
        }
    }

    /// The rest of the step from a time since its start on.
    pub(crate) fn from(self, since: f64) -> Self {
        let shifted = |series: &PowerSeries| series.shifted(since);
        let state = self.state_at(since);
        Self {
            start: self.start.after(since),
            duration: self.duration - since,
            ends: state
                .numbers()
                .chain(self.ends().1.iter().copied())
                .collect(),
            state: OnceLock::new(),
            series: self.series.iter().map(shifted).collect(),
            ..self
        }
    }

    /// Shifts a step of a periodic motion to an earlier time by a number of periods, and moves it
    /// back.
    pub(crate) fn earlier(mut self, by: f64, moved: &[f64]) -> Self {
        (self.start, self.end) = (self.start.after(-by), self.end.after(-by));
        let half = self.ends.len() / 2;
        for ends in self.ends.chunks_mut(half.max(1)) {
            std::iter::zip(ends, moved).for_each(|(x, moved)| *x -= moved);
        }
        self.state = OnceLock::new();
        for event in self.ending.iter_mut().flat_map(|ending| &mut ending.events) {
            event.time -= by;
            let displacements = event.state.displacements.iter_mut();
            displacements.zip(moved).for_each(|(x, moved)| *x -= moved);
        }
        self
    }

    /// Lets a contact come to rest at the end of the step, in a given state.
    pub(crate) fn coming_to_rest(self, contact: usize, state: State) -> Self {
        let mut step = self.ending_in(&state);
        let event = Event {
            time: step.end.time,
            element: Element::Contact(contact),
            kind: EventKind::Stick,
            state,
        };
        step.ending.get_or_insert_default().events = vec![event];
        step
    }

    /// Power series of the velocities in the time since the start, then of the memory variables;
    /// none for a step of duration 0.
    pub(crate) fn series(&self) -> &[PowerSeries] {
        let count = self.series.len().saturating_sub(self.modes.sliding.len());
        &self.series[..count]
    }

    /// Returns true if a release at its end was forced by a jump of a drive.
    pub(crate) fn is_forced(&self, contact: usize) -> bool {
        self.after().forced.contains(&contact)
    }

    /// The mode of each contact during the step.
    pub fn modes(&self) -> &[Mode] {
        &self.modes.modes
    }

    /// The piece of the law of each stop during the step.
    pub(crate) fn stops(&self) -> &[usize] {
        &self.modes.stops
    }

    /// State at the start of the step. If the step begins at an event, the memory variables have
    /// their values after the event.
    pub fn state(&self) -> &State {
        let state = || Box::new(self.state_of(self.ends().0));
        self.state.get_or_init(state)
    }
}

impl PartialEq for Step {
    fn eq(&self, other: &Self) -> bool {
        let plain = |step: &Self| (step.start, step.end, step.duration, step.coordinates);
        plain(self) == plain(other)
            && self.modes() == other.modes()
            && self.stops() == other.stops()
            && self.ends == other.ends
            && self.series == other.series
            && self.ending == other.ending
    }
}

/// Shows a step without its power series, which are long.
impl std::fmt::Debug for Step {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Step")
            .field("start_time", &self.start.time)
            .field("duration", &self.duration)
            .field("modes", &self.modes())
            .field("state", self.state())
            .field("events", &self.events())
            .finish_non_exhaustive()
    }
}

impl sealed::Part for Step {
    fn relative_velocity(&self, contact: usize) -> Option<PowerSeries> {
        let (others, sliding) = self.series.split_at(self.series().len());
        let velocities = others.get(..self.coordinates)?;
        let series = [velocities, sliding];
        self.modes.relative_series(contact, self.start, series)
    }

    fn state_at_time(&self, time: f64) -> State {
        self.state_since(self.since_start(time), time)
    }
}

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
        self.state_since(t, self.start.after(t).time)
    }

    fn end_state(&self) -> State {
        self.state_of(self.ends().1)
    }

    fn events(&self) -> &[Event<State>] {
        self.ending.as_ref().map_or(&[], |ending| &ending.events)
    }

    fn until(self, time: f64) -> Self {
        let duration = self.before_end(time);
        let state = self.state_since(duration, time);
        Self {
            end: Clock::at(time),
            duration,
            ending: None,
            ..self.ending_in(&state)
        }
    }
}

impl SystemState for State {
    type Step = Step;
}

impl sealed::State for State {
    fn general(&self) -> State {
        self.clone()
    }

    fn of_general(state: &State) -> Self {
        state.clone()
    }

    fn trajectory(
        steps: Steps<'_, Step>,
        start_time: f64,
        duration: f64,
        stop: Option<Stop<'_, Step>>,
    ) -> Result<Trajectory<Self>, Error> {
        motion::trajectory(steps, start_time, duration, stop)
    }
}

/// Motions of a structure.
impl Trajectory<State> {
    /// The mode of a contact at a time of the motion; at the time of an event, the mode after the
    /// event. `None` if the time lies outside the motion or is NaN, or if the contact does not
    /// exist.
    pub fn mode_at(&self, contact: usize, time: f64) -> Option<Mode> {
        self.step_at(time)?.modes().get(contact).copied()
    }

    /// The relative velocity r of a contact at a time of the motion; it is exact to its last digits
    /// also where the contact [creeps](crate::ContactLaw::creeps). 0 if the contact sticks. NaN if
    /// the time lies outside the motion or is NaN, or if the contact does not exist.
    ///
    /// ```
    /// use stick_slip::{Contact, Coulomb, Structure, structure::State};
    ///
    /// let contact = Contact::new(0, Coulomb::new(0.4, 0.4)?, 10.0)?.on_belt(0.5);
    /// let block = Structure::new(&[2.0])?.with_contact(contact)?;
    /// let motion = block.simulate(State::at_rest(1), 1.0)?;
    /// // The belt drags the block along: r' = 2.
    /// assert_eq!(motion.sliding_velocity(0, 0.125), -0.25);
    /// assert_eq!(motion.sliding_velocity(0, 0.5), 0.0);
    /// assert!(motion.sliding_velocity(1, 0.5).is_nan());
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn sliding_velocity(&self, contact: usize, time: f64) -> f64 {
        self.step_at(time).map_or(f64::NAN, |step| {
            let state = step.state_at_time(time);
            step.modes.relative_velocity(contact, time, &state)
        })
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
        Ok(steps.map(|(time, step)| (time, step.state_at_time(time), step.modes())))
    }
}
