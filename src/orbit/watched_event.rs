//! Events that are watched along a curve of motions.

use crate::motion::{Event, EventKind, Mode, Segment};
use crate::state::Direction;
use crate::state::structure::State;
use crate::structure::Step;

/// An event that is watched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mark {
    pub(super) contact: usize,
    pub(super) kind: MarkKind,
    /// The approximate time since the start of the motion, and the largest distance from this time.
    pub(super) since: f64,
    pub(super) within: f64,
}

/// The kind of an event that is watched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum MarkKind {
    Event(EventKind),
    /// An arrival after slip in this direction, which may become a stop or a crossing. After a
    /// crossing the contact may soon arrive again, from the other side.
    Arrival(Direction),
}

impl Mark {
    fn is(&self, step: &Step, event: &Event<State>) -> bool {
        let kind = match self.kind {
            MarkKind::Event(kind) => event.kind == kind,
            MarkKind::Arrival(side) => {
                let arrives = matches!(event.kind, EventKind::Stick | EventKind::Crossing(_));
                arrives && step.modes()[self.contact] == Mode::Slip(side)
            }
        };
        event.contact() == Some(self.contact) && kind
    }

    /// Finds the marked event in a motion, with the step that it ends.
    pub(super) fn find<'s>(&self, steps: &'s [Step]) -> Option<(&'s Step, &'s Event<State>, f64)> {
        let begins = steps.first()?.start_time();
        let events = steps
            .iter()
            .flat_map(|step| step.events().iter().map(move |event| (step, event)));
        let found = events.filter_map(|(step, event)| {
            let since = event.time - begins;
            let away = (since - self.since).abs();
            (self.is(step, event) && away <= self.within).then_some((step, event, since))
        });
        let away = |since: f64| (since - self.since).abs();
        found.min_by(|a, b| away(a.2).total_cmp(&away(b.2)))
    }

    /// Returns true if an event is this one, or one of a stop there that lasts no longer than
    /// rounding.
    pub(super) fn covers(&self, event: &Event<State>, begins: f64, period: f64) -> bool {
        const LASTS: f64 = 1e-6;
        let near = (event.time - begins - self.since).abs() <= LASTS * period;
        let kind = match self.kind {
            MarkKind::Event(kind) => event.kind == kind,
            MarkKind::Arrival(_) => true,
        };
        near && event.contact() == Some(self.contact) && kind
    }
}
