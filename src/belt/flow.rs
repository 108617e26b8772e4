//! The phase machine: stick and slip in turn, step by step.

use std::ops::RangeInclusive;

use super::slip_point::{SlipPoint, Start};
use super::step::Step;
use super::stepper::{Advance, Stepper};
use super::system::{Landing, MassOnBelt};
use crate::clock::Time;
use crate::error::Error;
use crate::friction::{FrictionLaw, static_is_nan};
use crate::motion::sealed::Sealed;
use crate::motion::{EventKind, Integrator, Mode, Run, Segment, System, Trajectory};
use crate::state::State;

/// The motion of a mass from a start state, as an iterator of [`Step`]s without an end, in constant
/// memory.
///
/// [`Integrator::flow`] makes it. Steps follow each other without a gap. After an error comes
/// `None`. If the motion comes to rest for ever (in stick at v_b = 0, or exactly on an
/// equilibrium), the last step has an infinite duration.
///
/// A motion that settles to steady sliding goes on for ever without events. If your program waits
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
    stepper: Stepper<'s, L>,
    run: Run,
    state: State,
    phase: Phase,
}

/// The phase that comes next.
#[derive(Debug, Clone, Copy)]
enum Phase {
    Stick,
    Slip(SlipPoint),
    Ended,
}

/// The sizes max(|u − ū|, |v|, |v_b|) of a start with which the terms of its series neither become
/// subnormal numbers nor overflow. The tolerance's scale may be smaller.
const SIZES: RangeInclusive<f64> = 1e-280..=1e300;

impl<'s, L: FrictionLaw> Flow<'s, L> {
    fn new(settings: Integrator, system: &'s MassOnBelt<L>, start: State) -> Result<Self, Error> {
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
            stepper: Stepper::new(system.by_reference(), settings.tolerance()),
            run: Run::new(settings),
            state: if velocity - v_b == 0.0 {
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

    /// The next step. Afterwards the motion stands at the end of this step.
    fn step(&mut self) -> Result<Step, Error> {
        let system = *self.stepper.system();
        let start = self.run.clock;
        let (step, phase, end) = match &self.phase {
            Phase::Slip(point) => {
                // By reference: a copy of the point would load, as a whole, what has just been
                // stored in parts, and wait for it.
                let advance = self.stepper.advance(point, Time::Forward, start.time)?;
                let direction = advance.end.direction;
                let (duration, speed, v_b) =
                    (advance.duration, *advance.speed, system.belt_velocity());
                let step = Step::slip(start, duration, direction, self.state, speed, v_b);
                let (phase, event, end) = after(&system, point, &advance);
                let step = match event {
                    Some(kind) => step.ended_by(kind, end),
                    None => step,
                };
                (step, phase, end)
            }
            Phase::Stick | Phase::Ended => {
                let step = Step::stick(start, self.state.displacement, &system);
                if step.duration.is_nan() {
                    return Err(static_is_nan());
                }
                let phase = match (step.event(), step.end_state()) {
                    (Some(event), State { displacement, .. }) => match event.kind.mode() {
                        Mode::Slip(side) => {
                            Phase::Slip(SlipPoint::leaving(&system, displacement, side))
                        }
                        Mode::Stick | Mode::Open => Phase::Stick,
                    },
                    (None, _) => Phase::Ended,
                };
                (step, phase, step.end_state())
            }
        };
        self.phase = phase;
        self.state = end;
        self.run.clock = start.after(step.duration());
        Ok(step)
    }
}

/// What follows a Taylor step: the phase, the event at the end of the step, if there is one, and
/// the state there.
type Next = (Phase, Option<EventKind>, State);

fn after<L: FrictionLaw>(system: &MassOnBelt<L>, from: &SlipPoint, advance: &Advance) -> Next {
    let end = advance.end;
    let state = end.state(system);
    if advance.duration.is_infinite() {
        return (Phase::Ended, None, state);
    }
    if !advance.is_contact() {
        return (Phase::Slip(end), None, state);
    }
    let leaving = |side| Phase::Slip(SlipPoint::leaving(system, end.displacement, side));
    match system.landing(end.displacement, end.direction) {
        Landing::Stick => (Phase::Stick, Some(EventKind::Stick), state),
        Landing::Touch if end.displacement == from.displacement => unmoved(system, &end),
        Landing::Touch => (leaving(end.direction), None, state),
        Landing::Crossing(side) => (leaving(side), Some(EventKind::Crossing(side)), state),
    }
}

/// What follows where a mass that should slide away has come back to the belt before u moved by an
/// ulp.
///
/// The force by which it should slide is lost there in the rounding of the forces, and the same
/// short step would come again and again. On a belt at rest the mass rests, at the end of the stick
/// band; a belt that moves takes it along, here by one ulp.
#[cold]
fn unmoved<L: FrictionLaw>(system: &MassOnBelt<L>, end: &SlipPoint) -> Next {
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
    let state = State::new(displacement, v_b);
    match system.slides_at(displacement) {
        None => (Phase::Stick, Some(EventKind::Stick), state),
        Some(side) => {
            let leaving = SlipPoint::leaving(system, displacement, side);
            (Phase::Slip(leaving), None, state)
        }
    }
}

impl<L: FrictionLaw> Iterator for Flow<'_, L> {
    type Item = Result<Step, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        if matches!(self.phase, Phase::Ended) {
            return None;
        }
        let step = match self.run.limit_reached(|| self.state.into()) {
            Some(error) => Err(error),
            None => self.step(),
        };
        match &step {
            Ok(step) => self.run.count(usize::from(step.event().is_some())),
            // An error is the last item.
            Err(_) => self.phase = Phase::Ended,
        }
        Some(step)
    }
}

impl<L: FrictionLaw> Sealed for MassOnBelt<L> {}

impl<L: FrictionLaw> System for MassOnBelt<L> {
    type State = State;
    type Flow<'s>
        = Flow<'s, L>
    where
        Self: 's;

    fn flow(&self, settings: Integrator, start: State) -> Result<Flow<'_, L>, Error> {
        Flow::new(settings, self, start)
    }
}

impl<L: FrictionLaw> MassOnBelt<L> {
    /// The motion from `start` over `duration`, both dimensionless, to round-off:
    /// [`Integrator::simulate`] with the default settings.
    ///
    /// # Errors
    ///
    /// Those of [`Integrator::simulate`].
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
    pub fn simulate(&self, start: State, duration: f64) -> Result<Trajectory, Error> {
        Integrator::new().simulate(self, start, duration)
    }
}
