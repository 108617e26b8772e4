//! What the searches need of a system.

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
/// A belt is looked at as the structure of one mass that it is; its trajectories are its own.
pub trait Oscillator: System {
    /// The general form of a state.
    #[doc(hidden)]
    fn general(state: &Self::State) -> State;
    /// The system's own form of a state.
    #[doc(hidden)]
    fn own(state: &State) -> Self::State;
    /// The system as the searches see it.
    #[doc(hidden)]
    fn form(&self) -> Form<'_>;
    /// The motion over one period in the system's own form.
    #[doc(hidden)]
    fn trajectory(&self, map: PeriodMap, period: f64) -> Result<Trajectory<Self::State>, Error>;
}

/// A system without the type of its laws: what all searches work on, so that they are compiled
/// once.
#[derive(Debug)]
pub struct Form<'s> {
    pub(super) model: Model<'s>,
    /// Steps taken so far.
    taken: Cell<usize>,
}

/// Most steps of all the motions of one search: seconds for a few masses.
const MOST_STEPS: usize = 10 * Integrator::DEFAULT_MAX_STEPS;

/// How drives vary.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Rhythm {
    /// Not at all.
    Constant,
    /// With a common period.
    Periodic(f64),
    /// Without one.
    Aperiodic,
}

impl<'s> Form<'s> {
    fn new(model: Model<'s>) -> Self {
        Self {
            model,
            taken: Cell::new(0),
        }
    }

    /// Counts a step, or a part of one, that is to be taken from a state.
    pub(super) fn count(&self, reached: impl FnOnce() -> Reached) -> Result<(), Error> {
        if self.taken.get() >= MOST_STEPS {
            return Err(Self::too_many(reached()));
        }
        self.taken.set(self.taken.get() + 1);
        Ok(())
    }

    /// The error of a search that would take more steps than it may.
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

    /// Numbers of a state: displacements, velocities, and what contacts remember.
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

    /// Whether no drive varies.
    pub(super) fn is_free(&self) -> bool {
        self.model.drives().all(|drive| drive.is_constant())
    }

    /// Whether a number of a state is the velocity of a coordinate that contacts share.
    pub(super) fn shares(&self, row: usize) -> bool {
        let coordinate = row.checked_sub(self.len());
        coordinate.is_some_and(|j| self.model.shared_coordinates.binary_search(&j).is_ok())
    }

    /// Number of contacts.
    pub(super) fn contacts(&self) -> usize {
        self.model.contacts.len()
    }

    /// Whether a contact has no relative velocity at a time, as far as its law can tell.
    pub(super) fn is_at_rest(&self, contact: usize, velocities: &[f64], time: f64) -> bool {
        let contact = &self.model.contacts[contact];
        let surface = contact.belt_velocity.value(time);
        contact.sliding_velocity(|j| velocities[j], surface) == 0.0
    }

    /// Sets the velocities at a time so that these contacts are at rest.
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
