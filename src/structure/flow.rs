//! The motion of a structure, step by step.

use super::carried::Carried;
use super::energy::finite;
use super::engine::model::Model;
use super::engine::{Engine, check_start};
use super::mechanism::Mechanism;
use super::step::Step;
use super::system::Structure;
use crate::clock::Clock;
use crate::error::Error;
use crate::motion::sealed;
use crate::motion::{Integrator, Run, Segment, System, Trajectory};
use crate::state::structure::State;

/// The motion of a [`Structure`] from a start state: an unbounded iterator of [`Step`]s in constant
/// memory.
///
/// Returned by [`Integrator::flow`]. After an error the iterator returns `None`. If all velocities
/// stay constant and no further event follows, the last step has an infinite duration. A flow
/// cannot be sent to another thread, but threads may share a structure.
#[derive(Debug, Clone)]
pub struct Flow<'s> {
    engine: Engine<'s>,
    run: Run,
    /// The events of the start itself.
    first: Option<Step>,
    ended: bool,
}

impl<'s> Flow<'s> {
    pub(crate) fn new(
        settings: Integrator,
        model: Model<'s>,
        start: &State,
    ) -> Result<Self, Error> {
        let run = Run::new(settings);
        check_start(&model, run.clock.time, start)?;
        let (engine, first) = Engine::start(model, settings.tolerance(), run.clock, start)?;
        Ok(Self {
            engine,
            run,
            first,
            ended: false,
        })
    }
}

impl Iterator for Flow<'_> {
    type Item = Result<Step, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.ended {
            return None;
        }
        let step = match self.run.limit_reached(|| self.engine.state()) {
            Some(error) => Err(error),
            None => match self.first.take() {
                Some(first) => Ok(first),
                None => self.engine.step(),
            },
        };
        match &step {
            Ok(step) => {
                self.run.count(step.events().len());
                self.run.clock = self.engine.clock();
                self.ended = step.duration().is_infinite();
            }
            // An error is the last item.
            Err(_) => self.ended = true,
        }
        Some(step)
    }
}

impl sealed::Sealed for Structure {}

impl System for Structure {
    type State = State;
    type Flow<'s> = Flow<'s>;
}

impl<'s> sealed::Flow<'s, Structure> for Flow<'s> {
    fn new(system: &'s Structure, settings: Integrator, start: State) -> Result<Self, Error> {
        Self::new(settings, system.model(), &start)
    }
}

impl Structure {
    /// Computes the motion from `start` over `duration`, accurate to round-off. This function calls
    /// [`Integrator::simulate`](crate::Integrator::simulate) with the default settings.
    ///
    /// # Errors
    ///
    /// The errors of [`Integrator::simulate`](crate::Integrator::simulate).
    #[doc(alias = "integrate")]
    #[doc(alias = "solve")]
    pub fn simulate(
        &self,
        start: impl Into<State>,
        duration: f64,
    ) -> Result<Trajectory<State>, Error> {
        Integrator::new().simulate(self, start, duration)
    }

    /// The friction force λ_c of each contact at the given time in the given state, in units of
    /// force. A positive λ_c opposes a positive relative velocity. At relative velocity 0, stick or
    /// slip is decided as at the start of a motion. The force of an open contact is 0. If contacts
    /// at rest have linearly dependent directions, each has a range of possible forces.
    ///
    /// # Errors
    ///
    /// The errors of [`simulate`](Self::simulate) for a start state that is not valid;
    /// [`Error::InvalidParameter`] if the time is not finite; [`Error::InvalidState`], with a
    /// displacement and a velocity of the state, if a result overflows.
    ///
    /// ```
    /// use stick_slip::{Contact, Coulomb, Structure, structure::State};
    ///
    /// // The torque in a locked clutch accelerates shaft 1.
    /// let clutch = Contact::between(0, 1, Coulomb::new(0.4, 0.3)?, 10.0)?;
    /// let shafts = Structure::new(&[1.0, 3.0])?.with_force(0, 2.0)?.with_contact(clutch)?;
    /// let state = State::at_rest(2);
    /// let carried = shafts.carried(0.0, &state)?;
    /// assert!(carried[0].force == 1.5 && carried[0].is_determined());
    /// assert_eq!(shafts.acceleration(0.0, &state)?, [0.5, 0.5]);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn carried(&self, time: f64, state: &State) -> Result<Vec<Carried>, Error> {
        let carried = self.at(time, state)?.carried();
        all_finite(carried.iter().map(|carried| carried.force).collect(), state)?;
        Ok(carried)
    }

    /// The ways in which contacts at rest can begin to slip, at the given time in the given state.
    /// Stick or slip is decided as at the start of a motion.
    ///
    /// A contact on whose direction no other contact at rest depends is a mechanism by itself.
    /// Contacts with linearly dependent directions slip together, as the page of
    /// [`Structure`](Self#contacts-that-share-masses) says. A motion and its opposite are two
    /// mechanisms. Mechanisms against the infinite limit of a freewheel are left out. Elastic
    /// contacts belong to no mechanism, because the state contains their forces. The mechanisms are
    /// ordered by the numbers of their contacts.
    ///
    /// # Errors
    ///
    /// The errors of [`carried`](Self::carried), among them [`Error::TooManyMechanisms`].
    ///
    /// ```
    /// use stick_slip::{Contact, Coulomb, Structure, structure::State};
    ///
    /// // Two shafts, a brake on each (3 N m and 5 N m) and a clutch between them (4 N m). A torque
    /// // of 6 N m on shaft 0 is carried by its brake and by the clutch.
    /// let law = Coulomb::new(1.0, 1.0)?;
    /// let shafts = Structure::new(&[1.0, 1.0])?
    ///     .with_force(0, 6.0)?
    ///     .with_contact(Contact::new(0, law, 3.0)?)?
    ///     .with_contact(Contact::new(1, law, 5.0)?)?
    ///     .with_contact(Contact::between(0, 1, law, 4.0)?)?;
    /// let mechanisms = shafts.mechanisms(0.0, &State::at_rest(2))?;
    ///
    /// // Both shafts turn together, shaft 0 alone, or shaft 1 alone; forward or backward.
    /// let slipping = mechanisms.iter().map(|it| it.contacts.iter().map(|c| c.0).collect());
    /// let slipping: Vec<Vec<usize>> = slipping.collect();
    /// assert_eq!(slipping, [[0, 1], [0, 1], [0, 2], [0, 2], [1, 2], [1, 2]]);
    /// // At 7 N m shaft 0 begins to turn alone.
    /// let next = mechanisms.iter().min_by(|a, b| a.margin().total_cmp(&b.margin())).unwrap();
    /// let [(0, first), (2, second)] = next.contacts[..] else { panic!() };
    /// assert!(first == 1.0 && (second - 1.0).abs() < 1e-15);
    /// assert!((next.power - 6.0).abs() < 1e-14 && (next.resistance - 7.0).abs() < 1e-14);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn mechanisms(&self, time: f64, state: &State) -> Result<Vec<Mechanism>, Error> {
        let mechanisms = self.at(time, state)?.mechanisms();
        let margins = mechanisms.iter().map(Mechanism::margin);
        all_finite(margins.collect(), state)?;
        Ok(mechanisms)
    }

    /// The acceleration v' of each coordinate at the given time in the given state, in units of
    /// velocity per time. At relative velocity 0, stick or slip of a contact is decided as at the
    /// start of a motion.
    ///
    /// # Errors
    ///
    /// The errors of [`carried`](Self::carried).
    pub fn acceleration(&self, time: f64, state: &State) -> Result<Vec<f64>, Error> {
        all_finite(self.at(time, state)?.acceleration(), state)
    }

    /// The engine at an instant.
    fn at(&self, time: f64, state: &State) -> Result<Engine<'_>, Error> {
        Error::check("Structure", "time", time, true, "any time")?;
        let model = self.model();
        check_start(&model, time, state)?;
        let (engine, _) = Engine::start(model, f64::EPSILON, Clock::at(time), state)?;
        Ok(engine)
    }
}

/// Numbers that follow from a state, if none overflows.
fn all_finite(numbers: Vec<f64>, state: &State) -> Result<Vec<f64>, Error> {
    // 0 times what is not finite is no number.
    finite(numbers.iter().map(|x| 0.0 * x).sum(), state)?;
    Ok(numbers)
}
