use super::model::Belt;
use crate::clock::Clock;
use crate::error::{Element, Error};
use crate::motion::sealed::{self, Part as _};
use crate::motion::{
    self, Ended, Event, EventKind, Mode, Segment, Steps, Stop, SystemState, Trajectory,
};
use crate::series::PowerSeries;
use crate::state::structure;
use crate::state::{Direction, State, Units};

/// A step of the motion of a mass on a belt: a stick phase, or one Taylor step of a slip phase.
///
/// Events happen only at the end of a step. A step does not borrow the system: it contains the
/// power series of the motion, which is accurate to the integrator's tolerance over the
/// [`duration`](Self::duration) of the step. At the time t since the start of the step, velocity v,
/// displacement u and sliding speed s are
///
/// ```text
/// v(t) = v(0) + σ(s(t) − s(0)),   u(t) = u(0) + ∫ v dt,   s(t) = Σ s_k t^k
/// ```
///
/// v_b is the belt velocity, s = |v − v_b|, and σ = ±1 is the direction of slip. In stick s is 0,
/// and v = v_b.
///
/// ```
/// use stick_slip::{Integrator, MassOnBelt, Mode, Polynomial, State};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let mut flow = Integrator::new().flow(&system, State::new(0.1, 0.2))?;
/// let stick = flow.next().unwrap()?;
/// assert_eq!(stick.mode(), Mode::Stick);
/// assert!((stick.duration() - (0.38 - 0.1) / 0.2).abs() < 1e-15);
/// assert_eq!(stick.state_at(1.0), State::new(0.1 + 0.2, 0.2));
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Clone, Copy, PartialEq)]
pub struct Step {
    pub(crate) start: Clock,
    pub(crate) duration: f64,
    pub(crate) mode: Mode,
    pub(crate) state: State,
    /// The series of the sliding speed; zero in stick.
    pub(crate) speed: PowerSeries,
    pub(crate) event: Option<Event>,
    pub(crate) belt_velocity: f64,
}

impl Step {
    /// A Taylor step of a slip phase, with the series of its sliding speed.
    #[inline(always)]
    pub(crate) fn slip(
        start: Clock,
        duration: f64,
        direction: Direction,
        state: State,
        speed: &PowerSeries,
        belt_velocity: f64,
        end: Option<(EventKind, State)>,
    ) -> Self {
        let time = start.after(duration).time;
        Self {
            start,
            duration,
            mode: Mode::Slip(direction),
            state,
            speed: *speed,
            event: end.map(|(kind, state)| event(time, kind, state)),
            belt_velocity,
        }
    }

    /// A stick phase from displacement u.
    ///
    /// The displacement grows at the rate v_b up to the release point. At v_b = 0 the mass stays at
    /// rest for ever.
    pub(crate) fn stick(start: Clock, displacement: f64, system: &Belt<'_>) -> Self {
        let v_b = system.belt_velocity();
        let state = State::new(displacement, v_b);
        let rest = Self {
            start,
            duration: f64::INFINITY,
            mode: Mode::Stick,
            state,
            speed: PowerSeries::ZERO,
            event: None,
            belt_velocity: v_b,
        };
        let Some(release) = system.release_state() else {
            return rest;
        };
        let (duration, released) = if system.is_release(displacement) {
            (0.0, state)
        } else {
            ((release.displacement - displacement) / v_b, release)
        };
        if duration == f64::INFINITY {
            // The belt is so slow that the time of the release overflows.
            return rest;
        }
        let direction = if v_b > 0.0 {
            Direction::Lagging
        } else {
            Direction::Leading
        };
        Self { duration, ..rest }.ended_by(EventKind::Release(direction), released)
    }

    /// Returns this step with an event of the given kind, in the given state, at its end.
    #[inline(always)]
    pub(crate) fn ended_by(mut self, kind: EventKind, state: State) -> Self {
        self.event = Some(event(self.end_time(), kind, state));
        self
    }

    /// Returns this step, with its event, shifted to another start time.
    pub(crate) fn starting_at(mut self, start: Clock) -> Self {
        self.start = start;
        let time = self.end_time();
        if let Some(event) = &mut self.event {
            event.time = time;
        }
        self
    }

    /// The start of this step alone, shifted to another start time: a step of duration 0.
    pub(crate) fn start_at(self, start: Clock) -> Self {
        Self {
            start,
            duration: 0.0,
            event: None,
            ..self
        }
    }

    /// Time τ at which the step starts, dimensionless.
    pub fn start_time(&self) -> f64 {
        self.start.time
    }

    /// Time τ at which the step ends, dimensionless; infinite for an equilibrium that lasts for
    /// ever.
    pub fn end_time(&self) -> f64 {
        self.start.after(self.duration).time
    }

    /// Duration of the step, dimensionless; infinite for an equilibrium that lasts for ever.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// The mode of the mass during the step.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// State at the start of the step.
    pub fn state(&self) -> State {
        self.state
    }

    /// State at a finite time t after the **start** of the step, 0 ≤ t ≤
    /// [`duration`](Self::duration). The series is not valid outside this range.
    pub fn state_at(&self, t: f64) -> State {
        let State {
            displacement,
            velocity,
        } = self.state;
        match self.mode {
            _ if t == 0.0 || self.is_rest() => self.state,
            Mode::Stick | Mode::Open => State::new(displacement + velocity * t, velocity),
            Mode::Slip(direction) => {
                let mean_velocity = self.belt_velocity + direction.sign() * self.speed.mean(t);
                State::new(
                    displacement + mean_velocity * t,
                    self.belt_velocity + direction.sign() * self.speed.at(t),
                )
            }
        }
    }

    /// Returns true if the mass stands still for ever: exactly on the equilibrium, or in stick on a
    /// belt that stands still.
    fn is_rest(&self) -> bool {
        self.state.velocity == 0.0 && self.speed[1] == 0.0 && self.speed[2] == 0.0
    }

    /// Coefficients of the power series of the sliding speed s in the time since the step's start,
    /// s(t) = Σ s_k t^k, dimensionless. They are exactly the coefficients that the integrator used
    /// in this step; in stick all are zero.
    ///
    /// ```
    /// use stick_slip::{Coulomb, MassOnBelt, State};
    ///
    /// let system = MassOnBelt::new(Coulomb::new(0.4, 0.25)?, 0.2)?;
    /// let motion = system.simulate(State::new(0.0, 0.0), 0.5)?;
    /// // s(0) = v_b, s'(0) = −μ_k
    /// assert_eq!(motion.steps()[0].speed_coefficients()[..2], [0.2, -0.25]);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn speed_coefficients(&self) -> &[f64] {
        self.speed.coefficients()
    }

    /// The event at the end of the step, if there is one.
    pub fn event(&self) -> Option<Event> {
        self.event
    }

    /// The sign σ of v_r; 0 in stick.
    pub(crate) fn sigma(&self) -> f64 {
        self.direction().map_or(0.0, Direction::sign)
    }

    /// The direction of slip; `None` in stick.
    pub(crate) fn direction(&self) -> Option<Direction> {
        match self.mode {
            Mode::Slip(direction) => Some(direction),
            Mode::Stick | Mode::Open => None,
        }
    }

    /// Converts this step of a dimensionless motion to other units.
    pub(crate) fn in_units(&self, units: Units) -> Self {
        let start = self.start.at_rate(units.rate);
        let duration = self.duration / units.rate;
        let mut factor = units.velocity();
        let speed = PowerSeries::from_fn(|k| {
            let coefficient = self.speed[k] * factor;
            factor *= units.rate;
            coefficient
        });
        let converted = units.velocity() * self.belt_velocity;
        let belt_velocity = units.belt_velocity.unwrap_or(converted);
        let state = |state: State| {
            let is_held = state.velocity == self.belt_velocity;
            let state = units.state(state);
            let velocity = if is_held {
                belt_velocity
            } else {
                state.velocity
            };
            State { velocity, ..state }
        };
        let step = Self {
            start,
            duration,
            state: state(self.state),
            speed,
            event: None,
            belt_velocity,
            ..*self
        };
        match self.event {
            Some(event) => step.ended_by(event.kind, state(event.state)),
            None => step,
        }
    }

    /// The mirror image of this step: (u, v, v_b) → (−u, −v, −v_b).
    pub(crate) fn mirrored(&self) -> Self {
        let kind = |kind| match kind {
            EventKind::Release(direction) => EventKind::Release(direction.opposite()),
            EventKind::Crossing(direction) => EventKind::Crossing(direction.opposite()),
            EventKind::Stick | EventKind::Open | EventKind::Close => kind,
        };
        Self {
            mode: self
                .direction()
                .map_or(Mode::Stick, |direction| Mode::Slip(direction.opposite())),
            state: self.state.mirrored(),
            belt_velocity: -self.belt_velocity,
            event: self.event.map(|event| Event {
                kind: kind(event.kind),
                state: event.state.mirrored(),
                ..event
            }),
            ..*self
        }
    }
}

/// An event of the one contact.
fn event(time: f64, kind: EventKind, state: State) -> Event {
    Event {
        time,
        element: Element::Contact(0),
        kind,
        state,
    }
}

/// Shows a step without its power series, because the series is long.
impl std::fmt::Debug for Step {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Step")
            .field("start_time", &self.start_time())
            .field("duration", &self.duration)
            .field("mode", &self.mode)
            .field("state", &self.state)
            .field("event", &self.event)
            .finish_non_exhaustive()
    }
}

impl sealed::Part for Step {
    fn relative_velocity(&self, contact: usize) -> Option<PowerSeries> {
        (contact == 0 && self.duration > 0.0).then(|| self.speed.scaled(self.sigma()))
    }
}

impl Segment for Step {
    type State = State;

    fn start_time(&self) -> f64 {
        self.start_time()
    }

    fn end_time(&self) -> f64 {
        self.end_time()
    }

    fn duration(&self) -> f64 {
        self.duration
    }

    fn since_start(&self, time: f64) -> f64 {
        self.start.until(time).clamp(0.0, self.duration)
    }

    fn state_at(&self, t: f64) -> State {
        self.state_at(t)
    }

    fn end_state(&self) -> State {
        match self.event {
            Some(event) => event.state,
            None => self.state_at(self.duration),
        }
    }

    fn events(&self) -> &[Event] {
        self.event.as_slice()
    }

    fn until(self, time: f64) -> Self {
        Self {
            duration: self.before_end(time),
            event: None,
            ..self
        }
    }
}

impl SystemState for State {
    type Step = Step;
}

impl sealed::State for State {
    fn general(&self) -> structure::State {
        (*self).into()
    }

    fn of_general(state: &structure::State) -> Self {
        Self::new(state.displacements[0], state.velocities[0])
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

impl Trajectory {
    /// The mode of the mass at a time from the start to the end of the motion. At the time of an
    /// event it is the mode after the event. `None` for any other time and for NaN.
    pub fn mode_at(&self, time: f64) -> Option<Mode> {
        Some(self.step_at(time)?.mode)
    }

    /// Converts this dimensionless motion from time 0 to other units. `asked` is the requested
    /// duration in these units.
    pub(crate) fn in_units(&self, units: Units, asked: f64) -> Self {
        let steps = self.steps().iter().map(|step| step.in_units(units));
        let reached = self.duration() / units.rate;
        let (duration, ended) = match self.ended().clone() {
            Ended::Duration => (asked, Ended::Duration),
            Ended::Stopped => (reached, Ended::Stopped),
            Ended::Error(error) => (reached, Ended::Error(error.in_units(units))),
        };
        Self::new(steps.collect(), 0.0, duration, ended)
    }

    /// Samples of the motion at equal intervals, from its start to the last sampling time within
    /// the motion: time, state and mode. To give a sampling rate in hertz, use
    /// [`PhysicalMassOnBelt`](crate::PhysicalMassOnBelt).
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless the interval is finite and > 0.
    ///
    /// ```
    /// use stick_slip::{MassOnBelt, Mode, Polynomial, State};
    ///
    /// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
    /// let motion = system.simulate(State::new(0.0, 0.0), 10.0)?;
    /// let samples: Vec<_> = motion.sample_every(0.01)?.collect();
    /// assert_eq!(samples.len(), 1001);
    /// let in_stick = samples.iter().filter(|(_, _, mode)| *mode == Mode::Stick).count();
    /// assert_eq!(in_stick, 322);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn sample_every(
        &self,
        interval: f64,
    ) -> Result<impl Iterator<Item = (f64, State, Mode)>, Error> {
        let steps = self.steps_every(interval)?;
        Ok(steps.map(|(time, step)| (time, step.state_at(step.since_start(time)), step.mode)))
    }
}
