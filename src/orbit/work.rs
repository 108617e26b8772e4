//! The work of a search along a curve, counted and bounded in each of its directions.

use std::cell::Cell;

use super::type_erased_system::GeneralForm;
use crate::error::Error;
use crate::search::{MOST_STEPS_OF_A_SEARCH, Watched};

/// The motions tried in one direction, and their steps.
pub(super) struct Work<'w> {
    tried: Cell<usize>,
    steps: Cell<usize>,
    most_trials: usize,
    /// Limits of steps and of points.
    pub(super) most: (usize, usize),
    pub(super) watched: &'w Watched<'w>,
}

impl<'w> Work<'w> {
    pub(super) fn new(most_trials: usize, most: (usize, usize), watched: &'w Watched<'w>) -> Self {
        Self {
            tried: Cell::new(0),
            steps: Cell::new(0),
            most_trials,
            most,
            watched,
        }
    }

    /// Another direction begins.
    pub(super) fn begin_again(&self) {
        self.tried.set(0);
        self.steps.set(0);
    }

    /// Counts a motion that is tried.
    pub(super) fn count_trial(&self) {
        self.tried.set(self.tried.get() + 1);
    }

    /// Returns true if the work allowed in one direction is done, or the search was stopped.
    pub(super) fn is_at_limit(&self) -> bool {
        let is_done = self.tried.get() > self.most_trials || self.steps.get() > self.most.0;
        is_done || self.watched.is_stopped()
    }

    /// The result of a function of one system, which is watched and whose steps are counted.
    pub(super) fn with<T>(
        &self,
        form: GeneralForm<'_>,
        take: impl FnOnce(&GeneralForm<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let form = form.within(MOST_STEPS_OF_A_SEARCH, self.watched);
        let found = take(&form);
        self.steps.set(self.steps.get() + form.taken());
        self.watched.add(form.taken());
        found
    }
}
