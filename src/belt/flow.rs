//! The sequence of stick and slip phases of a motion, step by step.

use std::ops::RangeInclusive;

use super::model::{Belt, Landing};
use super::slip_point::Start;
use super::step::Step;
use super::stepper::{Advance, Stepper};
use super::system::MassOnBelt;
use crate::clock::Time;
use crate::error::Error;
use crate::friction::slip_series::SlipPoint;
use crate::friction::{FrictionLaw, static_is_nan};
use crate::motion::sealed;
use crate::motion::{EventKind, Integrator, Mode, Run, Segment, System, Trajectory};
use crate::state::{Direction, State};

/// The motion of a mass from a start state, as an unbounded iterator of [`Step`]s in constant
/// memory.
///
/// Returned by [`Integrator::flow`]. Steps follow each other without a gap. After an error the
/// iterator returns `None`. If the motion reaches an equilibrium (stick on a belt at rest, or
/// exactly the equilibrium of steady sliding), the last step has an infinite duration.
///
/// A motion that settles to steady sliding continues for ever without events. If your program waits
/// for the next event, set [`Integrator::with_max_steps`].
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
    system: &'s MassOnBelt<L>,
    machine: Machine,
}

/// The motion without its system, which is an argument of each step. A flow therefore contains no
/// trait object, and can be sent to another thread with its law.
#[derive(Debug, Clone)]
struct Machine {
    stepper: Stepper,
    run: Run,
    state: State,
    phase: Phase,
}

/// The phase that comes next.
#[derive(Debug, Clone, Copy)]
enum Phase {
    Stick,
    /// Slip in a direction, from the velocity of the belt.
    Leaving(Direction),
    Slip(SlipPoint),
    Ended,
}

/// The sizes max(|u − ū|, |v|, |v_b|) of a start with which the terms of its series neither become
/// subnormal numbers nor overflow. The tolerance's scale may be smaller.
const SIZES: RangeInclusive<f64> = 1e-280..=1e300;

impl Machine {
    fn new(settings: Integrator, system: &Belt<'_>, start: State) -> Result<Self, Error> {
        let v_b = system.belt_velocity();
        let State {
            displacement,
            velocity,
        } = start;
        let force = displacement + 2.0 * system.damping() * velocity;
        let deviation = displacement - system.equilibrium_displacement();
        let size = deviation.abs().max(velocity.abs()).max(v_b.abs());
        let ordinary = size == 0.0 || SIZES.contains(&size);
        if !(force.is_finite() && (velocity - v_b).is_finite() && ordinary) {
            return Err(Error::InvalidState {
                displacement,
                velocity,
            });
        }
        Ok(Self {
            stepper: Stepper::new(system, settings.tolerance()),
            run: Run::new(settings),
            state: if system.relative_velocity(velocity) == 0.0 {
                State::new(displacement, v_b)
            } else {
                start
            },
            phase: match Start::of(system, start) {
                Start::Stick => Phase::Stick,
                Start::Slip(point) => Phase::Slip(point),
            },
        })
    }

    fn next(&mut self, system: &Belt<'_>) -> Option<Result<Step, Error>> {
        if matches!(self.phase, Phase::Ended) {
            return None;
        }
        let step = match self.run.limit_reached(|| self.state.into()) {
            Some(error) => Err(error),
            None => self.step(system),
        };
        match &step {
            Ok(step) => self.run.count(usize::from(step.event().is_some())),
            // An error is the last item.
            Err(_) => self.phase = Phase::Ended,
        }
        Some(step)
    }

    /// The next step. Afterwards `self` is at the end of this step.
    fn step(&mut self, system: &Belt<'_>) -> Result<Step, Error> {
        let start = self.run.clock;
        let leaving;
        let point = match &self.phase {
            // By reference: a copy would load the point as a whole, and wait for its parts, which
            // have just been stored.
            Phase::Slip(point) => point,
            Phase::Leaving(side) => {
                leaving = SlipPoint::leaving(system, self.state.displacement, *side);
                &leaving
            }
            Phase::Stick | Phase::Ended => return self.stick(system),
        };
        let from = point.displacement;
        let advance = self
            .stepper
            .advance(system, point, Time::Forward, start.time)?;
        let Advance { duration, end } = advance;
        let state = std::mem::replace(&mut self.state, end.state(system));
        self.run.clock = start.after(duration);
        // In place, for the same reason.
        let event = if duration.is_infinite() {
            self.phase = Phase::Ended;
            None
        } else if advance.is_contact() {
            self.arrive(system, from, &end)
        } else {
            self.phase = Phase::Slip(end);
            None
        };
        let event = event.map(|kind| (kind, self.state));
        let (speed, v_b) = (self.stepper.speed(), system.belt_velocity());
        Ok(Step::slip(
            start,
            duration,
            end.direction,
            state,
            speed,
            v_b,
            event,
        ))
    }

    /// A stick phase.
    fn stick(&mut self, system: &Belt<'_>) -> Result<Step, Error> {
        let step = Step::stick(self.run.clock, self.state.displacement, system);
        if step.duration.is_nan() {
            return Err(static_is_nan());
        }
        self.phase = match step.event().map(|event| event.kind.mode()) {
            Some(Mode::Slip(side)) => Phase::Leaving(side),
            Some(Mode::Stick | Mode::Open) => Phase::Stick,
            None => Phase::Ended,
        };
        self.state = step.end_state();
        self.run.clock = self.run.clock.after(step.duration());
        Ok(step)
    }

    /// Sets the phase that follows when slip that began at displacement `from` reaches the belt's
    /// velocity. Returns the kind of the event.
    fn arrive(&mut self, system: &Belt<'_>, from: f64, end: &SlipPoint) -> Option<EventKind> {
        let (phase, event) = match system.landing(end.displacement, end.direction) {
            Landing::Stick => (Phase::Stick, Some(EventKind::Stick)),
            Landing::Touch if end.displacement == from => return self.stay(system, end),
            Landing::Touch => (Phase::Leaving(end.direction), None),
            Landing::Crossing(side) => (Phase::Leaving(side), Some(EventKind::Crossing(side))),
        };
        self.phase = phase;
        event
    }

    /// Sets the phase of a mass that should slide away, but has returned to the belt before u moved
    /// by an ulp.
    ///
    /// The accelerating force is smaller than the rounding errors of the forces, and the same short
    /// step would be repeated for ever. On a belt at rest the mass therefore stays at rest, at the
    /// end of the stick band. On a moving belt it moves with the belt, by one ulp.
    #[cold]
    fn stay(&mut self, system: &Belt<'_>, end: &SlipPoint) -> Option<EventKind> {
        let u = end.displacement;
        let v_b = system.belt_velocity();
        let [low, high] = system.stick_limits();
        let displacement = if v_b > 0.0 {
            u.next_up()
        } else if v_b < 0.0 {
            u.next_down()
        } else if system.is_at_limit(u) {
            u.clamp(low, high)
        } else {
            u
        };
        self.state = State::new(displacement, v_b);
        let (phase, event) = match system.slides_at(displacement) {
            None => (Phase::Stick, Some(EventKind::Stick)),
            Some(side) => (Phase::Leaving(side), None),
        };
        self.phase = phase;
        event
    }
}

impl<L: FrictionLaw> Iterator for Flow<'_, L> {
    type Item = Result<Step, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        self.machine.next(&self.system.belt())
    }
}

impl<L: FrictionLaw> sealed::Sealed for MassOnBelt<L> {}

impl<L: FrictionLaw> System for MassOnBelt<L> {
    type State = State;
    type Flow<'s>
        = Flow<'s, L>
    where
        Self: 's;
}

impl<'s, L: FrictionLaw> sealed::Flow<'s, MassOnBelt<L>> for Flow<'s, L> {
    fn new(system: &'s MassOnBelt<L>, settings: Integrator, start: State) -> Result<Self, Error> {
        let machine = Machine::new(settings, &system.belt(), start)?;
        Ok(Self { system, machine })
    }
}

impl<L: FrictionLaw> MassOnBelt<L> {
    /// Computes the motion from `start` over `duration`, both dimensionless, accurate to round-off:
    /// [`Integrator::simulate`] with the default settings.
    ///
    /// # Errors
    ///
    /// The errors of [`Integrator::simulate`].
    ///
    /// ```
    /// use stick_slip::{EventKind, MassOnBelt, Polynomial, State};
    ///
    /// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
    /// let motion = system.simulate(system.release_state().unwrap(), 10.0)?;
    /// let [release, stick, ..] = motion.events() else { panic!() };
    /// assert_eq!((release.time, stick.kind), (0.0, EventKind::Stick));
    /// assert!((stick.time - 5.169862999532134).abs() < 4e-15);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    #[doc(alias = "integrate")]
    #[doc(alias = "solve")]
    pub fn simulate(&self, start: impl Into<State>, duration: f64) -> Result<Trajectory, Error> {
        Integrator::new().simulate(self, start, duration)
    }
}
