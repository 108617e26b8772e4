//! A system as the searches see it.

use std::cell::Cell;

use crate::drive;
use crate::error::{Error, Reached};
use crate::motion::Integrator;
use crate::structure::engine::model::Model;

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
    pub(super) fn new(model: Model<'s>) -> Self {
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
}
