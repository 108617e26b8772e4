//! The events of a periodic motion as a cyclic sequence, and the bifurcation between two sequences.

use super::branch::BifurcationKind;
use super::period_map::PeriodMap;
use crate::error::Element;
use crate::motion::{Event, EventKind, Mode};
use crate::state::structure::State;

/// An event: element, kind, and the mode of the element afterwards.
type Kind = (Element, EventKind, Mode);

/// The events of a period, from any start.
#[derive(Debug, Clone)]
pub(super) struct Sequence {
    kinds: Vec<Kind>,
    /// The times of the events, in periods.
    times: Vec<f64>,
}

/// A measure of the distance of a motion from a change of its events.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Nearness {
    /// Two events change their order: the delay of the event of the element that is listed last at
    /// one time. It has different signs on the two sides.
    Order(f64),
    /// Two events of an element vanish on one side: the time between them.
    Pair(f64),
}

/// Events of different elements closer than this part of the period count as simultaneous: they
/// are listed by element.
const TOGETHER: f64 = 1e-11;

impl Sequence {
    /// The events of a closed motion whose start is not near an event.
    pub(super) fn of(map: &PeriodMap, period: f64) -> Self {
        Self::except(map, period, |_| false)
    }

    /// The events of a motion without some.
    pub(super) fn except(
        map: &PeriodMap,
        period: f64,
        is_left_out: impl Fn(&Event<State>) -> bool,
    ) -> Self {
        let events = map.events();
        let slips_by_rounding = |event: &Event<State>| {
            let contact = event.contact();
            contact.is_some_and(|contact| map.slips_by_rounding(contact))
        };
        let mut events: Vec<_> = events
            .filter(|(event, _)| !slips_by_rounding(event) && !is_left_out(event))
            .map(|(event, after)| (event.time, (event.element, event.kind, after)))
            .collect();
        // The sequence begins after the longest pause, so that simultaneous events are not
        // separated by the end of the period.
        let count = events.len();
        let pause = |i: usize| match i {
            0 => events[0].0 + period - events[count - 1].0,
            _ => events[i].0 - events[i - 1].0,
        };
        let longest = (0..count).max_by(|&a, &b| pause(a).total_cmp(&pause(b)));
        let longest = longest.unwrap_or(0);
        events.rotate_left(longest);
        for event in events.iter_mut().skip(count - longest) {
            event.0 += period;
        }
        let mut first = 0;
        for i in 1..=count {
            if i == count || events[i].0 - events[i - 1].0 > TOGETHER * period {
                events[first..i].sort_by_key(|event| event.1.0);
                first = i;
            }
        }
        Self {
            times: events.iter().map(|event| event.0 / period).collect(),
            kinds: events.into_iter().map(|event| event.1).collect(),
        }
    }

    /// The distance of the motion from the change to another sequence; `None` if more than two
    /// events change at once, or if the events do not show the distance.
    pub(super) fn nearness(&self, other: &Self) -> Option<Nearness> {
        let count = self.kinds.len();
        if count == other.kinds.len() {
            return (0..count).find_map(|turned| self.exchanged(other, turned));
        }
        // The other side has no such events.
        if count < other.kinds.len() {
            return None;
        }
        let last_of = |i: usize| {
            let before = (1..count).map(|back| (i + count - back) % count);
            let mut own = before.filter(|&j| self.kinds[j].0 == self.kinds[i].0);
            own.next()
        };
        let pauses = (0..count).filter_map(|i| {
            let pause = self.times[i] - self.times[last_of(i)?];
            Some(pause.rem_euclid(1.0))
        });
        let least = pauses.min_by(f64::total_cmp)?;
        Some(Nearness::Pair(least))
    }

    /// The two neighbouring events that have the opposite order in another sequence, which may
    /// begin with another event.
    fn exchanged(&self, other: &Self, turned: usize) -> Option<Nearness> {
        let count = self.kinds.len();
        let there = |i: usize| other.kinds[(i + turned) % count];
        let mut differing = (0..count).filter(|&i| self.kinds[i] != there(i));
        let (first, last) = (differing.next()?, differing.next()?);
        let (a, b) = match (first, last) {
            (0, last) if last > 1 && last + 1 == count => (last, 0),
            (first, last) if first + 1 == last => (first, last),
            _ => return None,
        };
        let are_swapped = self.kinds[a] == there(b) && self.kinds[b] == there(a);
        if !are_swapped || differing.next().is_some() {
            return None;
        }
        // Events at one time are listed by element.
        let later = (self.times[b] - self.times[a] + 0.5).rem_euclid(1.0) - 0.5;
        Some(Nearness::Order(
            if self.kinds[a].0 < self.kinds[b].0 {
                later
            } else {
                -later
            } + TOGETHER,
        ))
    }

    /// Returns true if the events are the same, in the same cyclic order.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        is_rotated(&self.kinds, &other.kinds)
    }

    /// The kind of bifurcation between two sequences.
    pub(super) fn change(&self, other: &Self) -> BifurcationKind {
        let (short, long) = if self.kinds.len() < other.kinds.len() {
            (self, other)
        } else {
            (other, self)
        };
        let mut elements = long.kinds.iter().chain(&short.kinds).map(|event| event.0);
        let grazes = elements.all(|element| {
            let of = |sequence: &Self| -> Vec<(EventKind, Mode)> {
                let own = sequence.kinds.iter().filter(|event| event.0 == element);
                own.map(|event| (event.1, event.2)).collect()
            };
            has_more_pairs(element, &of(short), &of(long))
        });
        if grazes && short.kinds.len() < long.kinds.len() {
            BifurcationKind::Grazing
        } else {
            BifurcationKind::Sequence
        }
    }
}

fn is_rotated<T: PartialEq>(a: &[T], b: &[T]) -> bool {
    let turned = |by: usize| a.iter().eq(b.iter().cycle().skip(by).take(b.len()));
    a.len() == b.len() && (a.is_empty() || (0..a.len()).any(turned))
}

/// Returns true if the events of one element become others by removing pairs of events after which
/// the element continues as before.
fn has_more_pairs(
    element: Element,
    short: &[(EventKind, Mode)],
    long: &[(EventKind, Mode)],
) -> bool {
    /// Limit of the pairs to be removed.
    const MOST_PAIRS: usize = 4;
    let more = long.len().saturating_sub(short.len());
    if more == 0 || !more.is_multiple_of(2) || more > 2 * MOST_PAIRS {
        return is_rotated(short, long);
    }
    (0..long.len()).any(|i| {
        let at = |j: usize| long[(i + j) % long.len()];
        let before = match (at(0).0, at(1).0) {
            // Independent of the direction of slip before the stick.
            (EventKind::Stick, EventKind::Release(to)) => {
                let last = long.len() - 1;
                long.len() == 2 || at(last).1 == Mode::Slip(to)
            }
            (EventKind::Release(_), EventKind::Stick) => true,
            (EventKind::Crossing(from), EventKind::Crossing(to)) => from != to,
            // A stop that is touched, or loses its force for a short time.
            (EventKind::Close, EventKind::Open) | (EventKind::Open, EventKind::Close) => {
                matches!(element, Element::Stop(_))
            }
            _ => false,
        };
        if !before {
            return false;
        }
        let rest: Vec<_> = (2..long.len()).map(at).collect();
        has_more_pairs(element, short, &rest)
    })
}
