//! The phase machine: stick and slip in turn, step by step.

use super::Integrator;
use super::polynomial::Polynomial;
use super::series::{SlipPoint, Time};
use super::slip::{Advance, Stepper};
use super::step::{Clock, Event, EventKind, Mode, Step};
use crate::friction::FrictionLaw;
use crate::{Direction, Error, MassOnBelt, Reached, State};

/// The motion from a start state, step by step, without an end: an iterator of [`Step`]s in constant memory.
///
/// Made by [`Integrator::flow`]. Steps follow each other without a gap. After an error comes `None`. A motion that comes to
/// rest for ever (in stick at v_b = 0, or exactly on an equilibrium) is one last step of infinite duration.
///
/// ```
/// use stick_slip::{Coulomb, Integrator, MassOnBelt, Mode, State};
///
/// // Free vibration on a belt at rest: the mass stops in the stick band.
/// let system = MassOnBelt::new(Coulomb::new(1.0, 1.0)?, 0.0)?;
/// let steps: Vec<_> = Integrator::new()
///     .flow(&system, State::new(2.5, 0.0))?
///     .collect::<Result<_, _>>()?;
/// let rest = steps.last().unwrap();
/// assert_eq!(rest.mode(), Mode::Stick);
/// assert_eq!(rest.duration(), f64::INFINITY);
/// assert!((rest.state().displacement + 0.5).abs() < 4e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone)]
pub struct Flow<'s, L> {
    stepper: Stepper<'s, L>,
    settings: Integrator,
    clock: Clock,
    phase: Phase,
    steps: usize,
    events: usize,
}

/// Where the motion stands.
#[derive(Debug, Clone, Copy)]
enum Phase {
    Stick { displacement: f64 },
    Slip { point: SlipPoint, state: State },
    Ended,
}

/// Scale of a motion, max(|u − ū|, |v|, |v_b|), below which the last terms of its series would be subnormal numbers.
const LEAST_SCALE: f64 = 1e-280;

/// Distance from the release point, in units of ε times the largest term of its formula, within which a start is one exactly on it.
const RELEASE_ROUNDING: f64 = 4.0;

impl<'s, L: FrictionLaw> Flow<'s, L> {
    pub(super) fn new(
        settings: Integrator,
        system: &'s MassOnBelt<L>,
        start: State,
    ) -> Result<Self, Error> {
        let v_b = system.belt_velocity();
        let relative_velocity = start.velocity - v_b;
        let force = start.displacement + 2.0 * system.damping() * start.velocity;
        let deviation = start.displacement - system.equilibrium_displacement();
        let scale = deviation.abs().max(start.velocity.abs()).max(v_b.abs());
        let underflows = scale > 0.0 && scale < LEAST_SCALE;
        if !(force.is_finite() && relative_velocity.is_finite()) || underflows {
            return Err(Error::InvalidState {
                displacement: start.displacement,
                velocity: start.velocity,
            });
        }
        let mut flow = Self {
            stepper: Stepper::new(system, settings.tolerance),
            settings,
            clock: Clock::default(),
            phase: Phase::Ended,
            steps: 0,
            events: 0,
        };
        let State { displacement, .. } = start;
        flow.phase = if relative_velocity != 0.0 {
            let direction = if relative_velocity < 0.0 {
                Direction::Lagging
            } else {
                Direction::Leading
            };
            let point = SlipPoint {
                direction,
                displacement,
                speed: relative_velocity.abs(),
                rate: None,
            };
            Phase::Slip {
                point,
                state: start,
            }
        } else if flow.is_release(displacement) {
            // In stick, with no time left in it: the release is reported at time 0.
            Phase::Stick { displacement }
        } else {
            match system.slides_at(displacement) {
                None => Phase::Stick { displacement },
                Some(direction) => flow.slip_from_belt(displacement, direction),
            }
        };
        Ok(flow)
    }

    fn system(&self) -> &'s MassOnBelt<L> {
        self.stepper.system()
    }

    /// Whether u is the release point, as far as its formula can be rounded differently.
    fn is_release(&self, displacement: f64) -> bool {
        self.system().release_state().is_some_and(|release| {
            let force = self.system().load() * self.system().law().static_coefficient();
            let largest = force
                .max(release.displacement.abs())
                .max(displacement.abs());
            (displacement - release.displacement).abs() <= RELEASE_ROUNDING * f64::EPSILON * largest
        })
    }

    /// The start of a slip phase, with v = v_b.
    fn slip_from_belt(&self, displacement: f64, direction: Direction) -> Phase {
        let system = self.system();
        let exact = match system.release_state() {
            Some(release) if self.is_release(displacement) => release.displacement,
            _ => displacement,
        };
        let point = SlipPoint {
            direction,
            displacement,
            speed: 0.0,
            rate: Some(system.slip_rate(exact, direction)),
        };
        let state = State::new(displacement, system.belt_velocity());
        Phase::Slip { point, state }
    }

    fn reached(&self, state: State) -> Reached {
        Reached {
            time: self.clock.time,
            state,
        }
    }

    /// A stick phase: u grows at the rate v_b up to the release point.
    fn stick(&mut self, displacement: f64) -> Step {
        let v_b = self.system().belt_velocity();
        let state = State::new(displacement, v_b);
        let (duration, released) = match self.system().release_state() {
            None => (f64::INFINITY, state),
            Some(_) if self.is_release(displacement) => (0.0, state),
            Some(release) => ((release.displacement - displacement) / v_b, release),
        };
        let event = if duration.is_finite() {
            let direction = if v_b > 0.0 {
                Direction::Lagging
            } else {
                Direction::Leading
            };
            self.phase = self.slip_from_belt(released.displacement, direction);
            Some((EventKind::Release(direction), released))
        } else {
            self.phase = Phase::Ended;
            None
        };
        self.step(Mode::Stick, state, Step::AT_REST_ON_BELT, duration, event)
    }

    /// One Taylor step of a slip phase, and what follows if it ends in contact.
    fn slip(&mut self, point: SlipPoint, state: State) -> Result<Step, Error> {
        let advance = self
            .stepper
            .advance(&point, Time::Forward, self.clock.time)?;
        let Advance { duration, end } = advance;
        let displacement = end.displacement;
        let mut event = None;
        self.phase = if duration.is_infinite() {
            Phase::Ended
        } else if !advance.is_contact() {
            let state = self.stepper.state(&end);
            Phase::Slip { point: end, state }
        } else {
            let on_belt = State::new(displacement, self.system().belt_velocity());
            match self.system().slides_at(displacement) {
                None => {
                    event = Some((EventKind::Stick, on_belt));
                    Phase::Stick { displacement }
                }
                Some(direction) => {
                    // To the same side it is a touch at the open end of the band, and no event.
                    if direction != point.direction {
                        event = Some((EventKind::Crossing(direction), on_belt));
                    }
                    self.slip_from_belt(displacement, direction)
                }
            }
        };
        let mode = Mode::Slip(point.direction);
        Ok(self.step(mode, state, *self.stepper.speed(), duration, event))
    }

    fn step(
        &mut self,
        mode: Mode,
        state: State,
        speed: Polynomial,
        duration: f64,
        event: Option<(EventKind, State)>,
    ) -> Step {
        let start = self.clock;
        self.clock = start.after(duration);
        Step {
            start,
            duration,
            mode,
            state,
            speed,
            event: event.map(|(kind, state)| Event {
                time: self.clock.time,
                kind,
                state,
            }),
            belt_velocity: self.system().belt_velocity(),
        }
    }
}

impl<L: FrictionLaw> Iterator for Flow<'_, L> {
    type Item = Result<Step, Error>;

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        // Ended from here on unless the step says otherwise: an error is the last item.
        let phase = std::mem::replace(&mut self.phase, Phase::Ended);
        let v_b = self.system().belt_velocity();
        let state = match phase {
            Phase::Ended => return None,
            Phase::Stick { displacement } => State::new(displacement, v_b),
            Phase::Slip { state, .. } => state,
        };
        let Integrator {
            max_steps,
            max_events,
            ..
        } = self.settings;
        if let Some(limit) = max_steps.filter(|&limit| self.steps >= limit) {
            let reached = self.reached(state);
            return Some(Err(Error::TooManySteps { limit, reached }));
        }
        if let Some(limit) = max_events.filter(|&limit| self.events > limit) {
            let reached = self.reached(state);
            return Some(Err(Error::TooManyEvents { limit, reached }));
        }
        let step = match phase {
            Phase::Slip { point, state } => self.slip(point, state),
            _ => Ok(self.stick(state.displacement)),
        };
        self.steps += 1;
        if let Ok(Step { event: Some(_), .. }) = step {
            self.events += 1;
        }
        Some(step)
    }
}
