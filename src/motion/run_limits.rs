//! The limits of steps and events of one run, and the error when one is reached.

use super::Integrator;
use crate::clock::Clock;
use crate::error::{Error, Reached};
use crate::state::structure::State;

/// The clock of one run, with its counts of steps and events and their limits.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    pub(crate) clock: Clock,
    settings: Integrator,
    steps: usize,
    events: usize,
}

impl Run {
    pub(crate) fn new(settings: Integrator) -> Self {
        Self {
            clock: Clock::at(settings.start_time()),
            settings,
            steps: 0,
            events: 0,
        }
    }

    /// The error that ends the run at this state, if a limit is reached.
    #[inline]
    pub(crate) fn limit_reached(&self, state: impl FnOnce() -> State) -> Option<Error> {
        let steps = self.settings.max_steps();
        if let Some(limit) = steps.filter(|&limit| self.steps >= limit) {
            let reached = Reached::new(self.clock.time, state());
            return Some(Error::TooManySteps { limit, reached });
        }
        let events = self.settings.max_events();
        events.filter(|&limit| self.events > limit).map(|limit| {
            let reached = Reached::new(self.clock.time, state());
            Error::TooManyEvents { limit, reached }
        })
    }

    /// Counts a step that was taken, with the events at its end.
    #[inline]
    pub(crate) fn count(&mut self, events: usize) {
        self.steps += 1;
        self.events += events;
    }
}
