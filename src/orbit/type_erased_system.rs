//! A system without the type of its laws, for all searches.

use std::cell::{Cell, OnceCell};

use crate::clock::Clock;
use crate::drive;
use crate::error::{Error, Reached};
use crate::motion::{Integrator, Mode};
use crate::search::{LOOK_EVERY, MOST_STEPS_OF_A_SEARCH, Watched};
use crate::state::structure::State;
use crate::structure::engine::model::Model;
use crate::structure::freedom::Freedom;

/// A system without the type of its laws, on which all searches work, so that they are compiled
/// once.
#[derive(Debug)]
pub struct GeneralForm<'s> {
    pub(super) model: Model<'s>,
    /// Steps taken so far, the limit of the search, and that of the part of it under way.
    taken: Cell<usize>,
    most: usize,
    until: Cell<usize>,
    watched: Option<&'s Watched<'s>>,
    freedom: OnceCell<Freedom>,
}

/// The time dependence of the drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Rhythm {
    /// All functions of time are constant.
    Constant,
    /// The functions of time have this common period.
    Periodic(f64),
    /// The functions of time vary without a common period.
    Aperiodic,
}

impl<'s> GeneralForm<'s> {
    pub(super) fn new(model: Model<'s>) -> Self {
        Self {
            model,
            taken: Cell::new(0),
            most: MOST_STEPS_OF_A_SEARCH,
            until: Cell::new(MOST_STEPS_OF_A_SEARCH),
            watched: None,
            freedom: OnceCell::new(),
        }
    }

    /// Sets another limit of steps, and a watcher.
    pub(super) fn within(self, most: usize, watched: &'s Watched<'s>) -> Self {
        Self {
            most,
            until: Cell::new(most),
            watched: Some(watched),
            ..self
        }
    }

    /// Sets the number of steps that the search has taken on other systems before.
    pub(super) fn after(self, taken: usize) -> Self {
        self.taken.set(taken);
        self
    }

    /// The limit of steps.
    pub(super) fn most(&self) -> usize {
        self.most
    }

    /// Part of a search, which may take so many steps.
    pub(super) fn within_steps<T>(&self, steps: usize, search: impl FnOnce() -> T) -> T {
        self.until.set((self.taken() + steps).min(self.most));
        let found = search();
        self.until.set(self.most);
        found
    }

    /// The model of the engine.
    pub(crate) fn model(&self) -> &Model<'s> {
        &self.model
    }

    /// Counts a step, or a part of one, before it is taken from a state.
    pub(super) fn count(&self, reached: &dyn Fn() -> Reached) -> Result<(), Error> {
        let taken = self.taken.get();
        if taken >= self.until.get() {
            return Err(self.too_many(reached()));
        }
        if let Some(watched) = self.watched {
            if !watched.is_stopped() && taken.is_multiple_of(LOOK_EVERY) {
                watched.look(reached().time, taken);
            }
            watched.check()?;
        }
        self.taken.set(taken + 1);
        Ok(())
    }

    /// The error of a search that exceeds its limit of steps.
    pub(super) fn too_many(&self, reached: Reached) -> Error {
        let limit = self.most;
        Error::TooManySteps { limit, reached }
    }

    /// Limit of the steps of one motion over a period.
    pub(super) fn most_of_a_period(&self) -> usize {
        (self.most / 10).max(Integrator::DEFAULT_MAX_STEPS)
    }

    /// The directions in which the system can be moved without any change of a force.
    pub(super) fn freedom(&self) -> &Freedom {
        self.freedom.get_or_init(|| Freedom::of(&self.model))
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

    /// Returns true if the system is autonomous: all drives are constant.
    pub(super) fn is_free(&self) -> bool {
        self.model.drives().all(|drive| drive.is_constant())
    }

    /// Returns true if several contacts may determine this entry of a state: the velocity of a
    /// coordinate that they share, or the force of an elastic contact.
    pub(super) fn is_held(&self, row: usize) -> bool {
        let shared = &self.model.shared_coordinates;
        let is_shared = |j: usize| shared.binary_search(&j).is_ok();
        let elastic = (0..self.contacts()).filter(|&c| !self.holds(c));
        row.checked_sub(self.len()).is_some_and(is_shared)
            || elastic.into_iter().any(|c| row == self.carried_row(c))
    }

    /// Index of the force of an elastic contact in a state.
    pub(super) fn carried_row(&self, contact: usize) -> usize {
        2 * self.len() + self.model.memory(contact).start
    }

    /// The unit of each memory variable: the change that changes a coefficient of friction by 1;
    /// infinite if none does, for the force of an elastic contact, and for first-order states.
    pub(super) fn memory_units(&self) -> Vec<f64> {
        let units = self.model.contacts.iter().flat_map(|contact| {
            (0..contact.memory.len()).map(|j| match contact.is_elastic() {
                true => f64::INFINITY,
                false => contact.law.memory_unit(j),
            })
        });
        units.chain(self.of_states(f64::INFINITY)).collect()
    }

    /// A value for each first-order state.
    fn of_states<T: Clone>(&self, value: T) -> impl Iterator<Item = T> {
        std::iter::repeat_n(value, self.model.first_order.len())
    }

    /// Number of contacts.
    pub(super) fn contacts(&self) -> usize {
        self.model.contacts.len()
    }

    /// Returns true if the relative velocity of a contact at a time is 0.
    pub(super) fn is_at_rest(&self, contact: usize, velocities: &[f64], time: f64) -> bool {
        let contact = &self.model.contacts[contact];
        let surface = contact.belt_velocity.at(Clock::at(time));
        contact.sliding_velocity(|j| velocities[j], surface, time) == 0.0
    }

    /// Returns true if a contact that sticks holds its coordinates: an elastic one does not.
    pub(super) fn holds(&self, contact: usize) -> bool {
        !self.model.contacts[contact].is_elastic()
    }

    /// Returns true if the sliding speed of a contact may touch 0: that of an elastic one has no
    /// event there, and one that creeps passes through 0 smoothly.
    pub(super) fn may_touch(&self, contact: usize) -> bool {
        self.holds(contact) && !self.model.creeping.contains(&contact)
    }

    /// Adjusts a state at a time to the modes of its contacts, if they are given. Contacts that
    /// stick get the relative velocity 0. Elastic contacts get their limit force in slip, the force
    /// 0 if they are open, and at most their limit force in stick.
    pub(super) fn put_in_modes(
        &self,
        state: &mut State,
        time: f64,
        mode: &dyn Fn(usize) -> Option<Mode>,
    ) {
        let rests = |c: usize| mode(c) == Some(Mode::Stick);
        self.model.put_at_rest(&mut state.velocities, time, &rests);
        for (c, contact) in self.model.contacts.iter().enumerate() {
            let place = self.model.memory(c).start;
            if self.holds(c) {
                continue;
            }
            let limit = contact.limit_at(time, |j| state.displacements[j]);
            if let Some(carried) = state.memory.get_mut(place) {
                *carried = match mode(c) {
                    Some(Mode::Stick) | None => carried.clamp(-limit, limit),
                    Some(Mode::Slip(side)) => side.sign() * limit,
                    Some(Mode::Open) => 0.0,
                };
            }
        }
    }
}
