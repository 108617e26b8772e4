//! A system for the searches, without the type of its laws.

use std::cell::Cell;

use super::map::{self, PeriodMap};
use crate::belt::MassOnBelt;
use crate::drive;
use crate::error::{Error, Reached};
use crate::friction::FrictionLaw;
use crate::motion::{Ended, Integrator, System, Trajectory};
use crate::state;
use crate::state::structure::State;
use crate::structure::Structure;
use crate::structure::engine::model::Model;

/// A system whose periodic motions can be found: [`MassOnBelt`] or [`Structure`]. Sealed, as
/// [`System`] is.
///
/// A belt is treated as a structure of one mass; its trajectories have its own type.
pub trait Oscillator: System {
    /// The general form of a state.
    #[doc(hidden)]
    fn general(state: &Self::State) -> State;
    /// The system's own form of a state.
    #[doc(hidden)]
    fn own(state: &State) -> Self::State;
    /// The system without the type of its laws.
    #[doc(hidden)]
    fn form(&self) -> Form<'_>;
    /// The motion over one period in the system's own form.
    #[doc(hidden)]
    fn trajectory(&self, map: PeriodMap, period: f64) -> Result<Trajectory<Self::State>, Error>;
}

/// A system without the type of its laws, on which all searches work, so that they are compiled
/// once.
#[derive(Debug)]
pub struct Form<'s> {
    pub(super) model: Model<'s>,
    /// Steps taken so far.
    taken: Cell<usize>,
}

/// Limit of steps of all the motions of one search: seconds for a few masses.
const MOST_STEPS: usize = 10 * Integrator::DEFAULT_MAX_STEPS;

/// The time dependence of the drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Rhythm {
    /// All are constant.
    Constant,
    /// They have this common period.
    Periodic(f64),
    /// They vary without a common period.
    Aperiodic,
}

impl<'s> Form<'s> {
    fn new(model: Model<'s>) -> Self {
        Self {
            model,
            taken: Cell::new(0),
        }
    }

    /// Counts a step, or a part of one, before it is taken from a state.
    pub(super) fn count(&self, reached: impl FnOnce() -> Reached) -> Result<(), Error> {
        if self.taken.get() >= MOST_STEPS {
            return Err(Self::too_many(reached()));
        }
        self.taken.set(self.taken.get() + 1);
        Ok(())
    }

    /// The error of a search that exceeds its limit of steps.
    pub(super) fn too_many(reached: Reached) -> Error {
        let limit = MOST_STEPS;
        Error::TooManySteps { limit, reached }
    }

    /// Steps taken so far.
    pub(super) fn taken(&self) -> usize {
        self.taken.get()
    }

    /// Number of displacements.
    pub(super) fn len(&self) -> usize {
        self.model.len()
    }

    /// Length of a state vector: displacements, velocities and memory variables.
    pub(super) fn order(&self) -> usize {
        2 * self.len() + self.model.remembered()
    }

    pub(super) fn rhythm(&self) -> Rhythm {
        match drive::common_period(self.model.drives()) {
            Some(period) => Rhythm::Periodic(period),
            None if self.is_free() => Rhythm::Constant,
            None => Rhythm::Aperiodic,
        }
    }

    /// Returns true if the system is autonomous: no drive varies.
    pub(super) fn is_free(&self) -> bool {
        self.model.drives().all(|drive| drive.is_constant())
    }

    /// Returns true if this number of a state is the velocity of a coordinate that contacts share.
    pub(super) fn shares(&self, row: usize) -> bool {
        let coordinate = row.checked_sub(self.len());
        coordinate.is_some_and(|j| self.model.shared_coordinates.binary_search(&j).is_ok())
    }

    /// Number of contacts.
    pub(super) fn contacts(&self) -> usize {
        self.model.contacts.len()
    }

    /// Returns true if the relative velocity of a contact at a time is 0.
    pub(super) fn is_at_rest(&self, contact: usize, velocities: &[f64], time: f64) -> bool {
        let contact = &self.model.contacts[contact];
        let surface = contact.belt_velocity.value(time);
        contact.sliding_velocity(|j| velocities[j], surface) == 0.0
    }

    /// Sets the velocities at a time so that these contacts have no relative velocity.
    pub(super) fn put_at_rest(
        &self,
        velocities: &mut [f64],
        time: f64,
        rests: impl Fn(usize) -> bool,
    ) {
        self.model.put_at_rest(velocities, time, rests);
    }

    /// The motion from a state at time 0 over a duration, with its derivative with respect to that
    /// state.
    pub fn period_map(&self, start: &State, duration: f64) -> Result<PeriodMap, Error> {
        map::period_map(self, 0.0, start, duration)
    }
}

impl Oscillator for Structure {
    fn general(state: &State) -> State {
        state.clone()
    }

    fn own(state: &State) -> State {
        state.clone()
    }

    fn form(&self) -> Form<'_> {
        Form::new(self.model())
    }

    fn trajectory(&self, map: PeriodMap, period: f64) -> Result<Trajectory<State>, Error> {
        Ok(Trajectory::new(map.steps, 0.0, period, Ended::Duration))
    }
}

impl<L: FrictionLaw> Oscillator for MassOnBelt<L> {
    fn general(state: &state::State) -> State {
        (*state).into()
    }

    fn own(state: &State) -> state::State {
        match (&state.displacements[..], &state.velocities[..]) {
            ([displacement], [velocity]) => state::State::new(*displacement, *velocity),
            // One mass has no other state.
            _ => state::State::new(f64::NAN, f64::NAN),
        }
    }

    fn form(&self) -> Form<'_> {
        Form::new(Model::of_belt(self))
    }

    fn trajectory(&self, map: PeriodMap, period: f64) -> Result<Trajectory, Error> {
        self.simulate(Self::own(&map.start), period)
    }
}
