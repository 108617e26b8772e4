//! The phase machine: stick and slip in turn, step by step.

use std::ops::RangeInclusive;

use super::Integrator;
use super::polynomial::Polynomial;
use super::series::{SlipPoint, Time};
use super::slip::{Advance, Stepper};
use super::step::{Clock, Event, EventKind, Mode, Step};
use crate::friction::FrictionLaw;
use crate::{Direction, Error, MassOnBelt, Reached, State};

/// The motion from a start state, step by step, without an end: an iterator of [`Step`]s in
/// constant memory.
///
/// Made by [`Integrator::flow`]. Steps follow each other without a gap. After an error comes
/// `None`. A motion that comes to rest for ever (in stick at v_b = 0, or exactly on an equilibrium)
/// is one last step of infinite duration. One that settles to steady sliding goes on without
/// events: whoever waits for the next event sets [`Integrator::with_max_steps`].
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
    state: State,
    phase: Phase,
    steps: usize,
    events: usize,
}

/// What comes next.
#[derive(Debug, Clone, Copy)]
enum Phase {
    Stick,
    Slip(SlipPoint),
    Ended,
}

/// Scales of a motion, max(|u − ū|, |v|, |v_b|), at which the terms of its series neither become
/// subnormal numbers nor overflow.
const SCALES: RangeInclusive<f64> = 1e-280..=1e300;

/// Distance from the release point, in units of ε times the largest term of its formula, within
/// which a start is one exactly on it.
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
        let ordinary = scale == 0.0 || SCALES.contains(&scale);
        if !(force.is_finite() && relative_velocity.is_finite() && ordinary) {
            return Err(Error::InvalidState {
                displacement: start.displacement,
                velocity: start.velocity,
            });
        }
        let mut flow = Self {
            stepper: Stepper::new(system.by_reference(), settings.tolerance),
            settings,
            clock: Clock::default(),
            state: if relative_velocity == 0.0 {
                State::new(start.displacement, v_b)
            } else {
                start
            },
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
            Phase::Slip(SlipPoint {
                direction,
                displacement,
                speed: relative_velocity.abs(),
                rate: None,
            })
        } else if flow.is_release(displacement) {
            // In stick, with no time left in it: the release is reported at time 0.
            Phase::Stick
        } else {
            match system.slides_at(displacement) {
                None => Phase::Stick,
                Some(direction) => flow.slip_from_belt(displacement, direction),
            }
        };
        Ok(flow)
    }

    fn system(&self) -> &MassOnBelt<&'s L> {
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
        Phase::Slip(SlipPoint {
            rate: Some(system.slip_rate(exact, direction)),
            ..SlipPoint::on_belt(displacement, direction)
        })
    }

    /// A stick phase: u grows at the rate v_b up to the release point.
    fn stick(&mut self) -> Step {
        let v_b = self.system().belt_velocity();
        let State { displacement, .. } = self.state;
        let (duration, released) = match self.system().release_state() {
            None => (f64::INFINITY, self.state),
            Some(_) if self.is_release(displacement) => (0.0, self.state),
            Some(release) => ((release.displacement - displacement) / v_b, release),
        };
        let (phase, event) = if duration.is_finite() {
            let direction = if v_b > 0.0 {
                Direction::Lagging
            } else {
                Direction::Leading
            };
            let slip = self.slip_from_belt(released.displacement, direction);
            (slip, Some(EventKind::Release(direction)))
        } else {
            (Phase::Ended, None)
        };
        self.phase = phase;
        self.step(
            Mode::Stick,
            Step::AT_REST_ON_BELT,
            duration,
            released,
            event,
        )
    }

    /// One Taylor step of a slip phase that has been taken, and what follows if it ends in contact.
    fn slip(&mut self, direction: Direction, advance: Advance) -> Step {
        let Advance { duration, end } = advance;
        let (phase, event) = if duration.is_infinite() {
            (Phase::Ended, None)
        } else if !advance.is_contact() {
            (Phase::Slip(end), None)
        } else {
            match self.system().slides_at(end.displacement) {
                None => (Phase::Stick, Some(EventKind::Stick)),
                Some(side) => {
                    // To the same side it is a touch at the open end of the band, and no event.
                    let event = (side != direction).then_some(EventKind::Crossing(side));
                    (self.slip_from_belt(end.displacement, side), event)
                }
            }
        };
        self.phase = phase;
        let (state, speed) = (self.stepper.state(&end), *self.stepper.speed());
        self.step(Mode::Slip(direction), speed, duration, state, event)
    }

    /// The step from here to a state, where the motion then stands.
    fn step(
        &mut self,
        mode: Mode,
        speed: Polynomial,
        duration: f64,
        end: State,
        event: Option<EventKind>,
    ) -> Step {
        let (start, state) = (self.clock, self.state);
        self.clock = start.after(duration);
        self.state = end;
        Step {
            start,
            duration,
            mode,
            state,
            speed,
            event: event.map(|kind| Event {
                time: self.clock.time,
                kind,
                state: end,
            }),
            belt_velocity: self.system().belt_velocity(),
        }
    }

    /// Why the run may not go on, if it may not.
    fn limit_reached(&self) -> Option<Error> {
        let Integrator {
            max_steps,
            max_events,
            ..
        } = self.settings;
        let reached = Reached {
            time: self.clock.time,
            state: self.state,
        };
        if let Some(limit) = max_steps.filter(|&limit| self.steps >= limit) {
            return Some(Error::TooManySteps { limit, reached });
        }
        max_events
            .filter(|&limit| self.events > limit)
            .map(|limit| Error::TooManyEvents { limit, reached })
    }
}

impl<L: FrictionLaw> Iterator for Flow<'_, L> {
    type Item = Result<Step, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let step = match (&self.phase, self.limit_reached()) {
            (Phase::Ended, _) => return None,
            (_, Some(error)) => Err(error),
            (Phase::Stick, None) => Ok(self.stick()),
            // By reference: a copy of the point would load, as a whole, what has just been stored
            // in parts, and wait for it.
            (Phase::Slip(point), None) => {
                let direction = point.direction;
                self.stepper
                    .advance(point, Time::Forward, self.clock.time)
                    .map(|advance| self.slip(direction, advance))
            }
        };
        self.steps += 1;
        match step {
            Ok(Step { event: Some(_), .. }) => self.events += 1,
            Ok(_) => (),
            // An error is the last item.
            Err(_) => self.phase = Phase::Ended,
        }
        Some(step)
    }
}
