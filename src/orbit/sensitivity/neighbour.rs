//! Motions of a family beside another one, and the order of their events.
//!
//! Events of several contacts at one instant are a group, in which the motions may have them in
//! different orders: states are compared before and after the group, and each time with that of
//! the same event.

use std::cmp::Ordering;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::DVector;

use super::super::period_map::vector;
use super::super::tangent::flow_at;
use super::super::type_erased_system::GeneralForm;
use crate::error::{Element, Error, Reached};
use crate::motion::{Event, EventKind, Integrator, Mode, Segment};
use crate::series::PowerSeries;
use crate::state::structure::State;
use crate::structure::{Flow, Step};

/// A motion, with its steps grouped by the events between them.
#[derive(Debug, Clone)]
pub(super) struct Run {
    segments: Vec<Vec<Step>>,
    pub(super) events: Vec<Event<State>>,
    pub(super) start: State,
    pub(super) begin: f64,
    /// The time of its end, and the duration.
    pub(super) end: f64,
    pub(super) duration: f64,
    order: usize,
    /// The contacts that creep.
    creeping: Vec<usize>,
}

/// Events whose times differ by at most this part happen at one instant: rounding separates those
/// of mirrored masses.
const TOGETHER: f64 = 1024.0 * f64::EPSILON;

/// The order of two events; equal if they happen at one instant.
fn order_of(a: &Event<State>, b: &Event<State>) -> Ordering {
    if (a.time - b.time).abs() <= TOGETHER * a.time.abs().max(b.time.abs()) {
        Ordering::Equal
    } else {
        a.time.total_cmp(&b.time)
    }
}

/// The place of each event of a group in another group; `None` if an element has other events
/// there.
fn places(group: &[Event<State>], other: &[Event<State>]) -> Option<Vec<usize>> {
    let of = |element: Element| move |event: &&Event<State>| event.element == element;
    let place = |(i, event): (usize, &Event<State>)| {
        let number = group[..i].iter().filter(of(event.element)).count();
        let mut same = (0..other.len()).filter(|&j| other[j].element == event.element);
        same.nth(number).filter(|&j| other[j].kind == event.kind)
    };
    group.iter().enumerate().map(place).collect()
}

impl Run {
    /// The motion from a start at a time over a duration; and beyond, up to as many events as are
    /// expected.
    pub(super) fn of(
        form: &GeneralForm<'_>,
        (begin, start): (f64, &State),
        duration: f64,
        expected: usize,
    ) -> Result<Self, Error> {
        /// Part of the duration by which an event of a neighbouring motion may be later.
        const LATER: f64 = 1.01;
        let settings = Integrator::new()
            .with_max_steps(Integrator::DEFAULT_MAX_STEPS)?
            .with_start_time(begin)?;
        let end = begin + duration;
        let mut run = Self {
            segments: vec![Vec::new()],
            events: Vec::new(),
            start: start.clone(),
            begin,
            end,
            duration,
            order: form.order(),
            creeping: form.model().creeping.clone(),
        };
        for step in Flow::new(settings, form.model().clone(), start)? {
            let step = step?;
            form.count(&|| Reached::new(step.start_time(), step.state().clone()))?;
            let reached = step.end_time();
            let missing = run.events.len() < expected && reached <= begin + LATER * duration;
            let events = step.events().iter();
            let events = events.filter(|event| event.time > begin && event.time.is_finite());
            let events: Vec<_> = events
                .filter(|event| event.time <= end || missing)
                .cloned()
                .collect();
            if step.duration() > 0.0
                && let Some(segment) = run.segments.last_mut()
            {
                segment.push(step);
            }
            for event in events {
                run.events.push(event);
                run.segments.push(Vec::new());
            }
            // Behind an event at the end, too, states are compared.
            let is_begun = run.segments.last().is_some_and(|last| !last.is_empty());
            if reached >= end && is_begun && !(run.events.len() < expected && missing) {
                break;
            }
        }
        Ok(run)
    }

    /// The number of entries of a state.
    pub(super) fn order(&self) -> usize {
        self.order
    }

    /// The modes of the contacts at the start.
    fn first_modes(&self) -> &[Mode] {
        let first = self.segments.iter().flatten().next();
        first.map_or(&[], |step| step.modes())
    }

    /// The number of contacts that stick at the start.
    pub(super) fn sticking(&self) -> usize {
        let modes = self.first_modes().iter();
        modes.filter(|mode| **mode == Mode::Stick).count()
    }

    /// Returns true if an event and the one before it happen at one instant.
    fn continues(&self, event: usize) -> bool {
        let pair = self.events.get(event - 1).zip(self.events.get(event));
        pair.is_some_and(|(a, b)| order_of(a, b) == Ordering::Equal)
    }

    /// The number of events before a time.
    pub(super) fn passed(&self, time: f64) -> usize {
        self.events.partition_point(|event| event.time < time)
    }

    /// Returns true if no series is continued over an event: where a contact that creeps changes
    /// its direction, μ ~ ln |r| has a series for an instant only, and the motion is smooth.
    pub(super) fn is_smooth(&self, event: usize) -> bool {
        let smooth = self.events.get(event).filter(|event| {
            let contact = event.contact();
            let creeps = contact.is_some_and(|c| self.creeping.contains(&c));
            creeps && matches!(event.kind, EventKind::Crossing(_))
        });
        smooth.is_some()
    }

    /// The step for a time after this number of events, and the time since its start; it may lie
    /// outside, unless the events beside it are smooth.
    fn step(&self, passed: usize, time: f64) -> Option<(&Step, f64)> {
        let (mut first, mut last) = (passed, passed);
        while first > 0 && self.is_smooth(first - 1) {
            first -= 1;
        }
        while self.is_smooth(last) {
            last += 1;
        }
        let mut steps = self.segments.get(first..=last)?.iter().flatten();
        let end = steps.clone().next_back();
        let step = steps.find(|step| step.end_time() >= time).or(end)?;
        Some((step, step.clock().until(time)))
    }

    /// The state at a time after this number of events, by the power series there.
    pub(super) fn state_at(&self, passed: usize, time: f64) -> Option<State> {
        let (step, since) = self.step(passed, time)?;
        Some(step.state_at(since))
    }

    pub(super) fn vector_at(&self, passed: usize, time: f64) -> Option<DVector<f64>> {
        Some(vector(&self.state_at(passed, time)?, self.order))
    }

    /// The rates of change of the state at a time after this number of events.
    pub(super) fn rates_at(&self, passed: usize, time: f64) -> Option<DVector<f64>> {
        let (step, since) = self.step(passed, time)?;
        Some(flow_at(step, since, step.state_at(since).velocities))
    }

    /// The end minus the start.
    pub(super) fn missed(&self, passed: usize) -> Option<DVector<f64>> {
        Some(self.vector_at(passed, self.end)? - vector(&self.start, self.order))
    }

    /// Returns true if the power series of this motion can be continued beyond their steps to the
    /// event times of another motion, and to its end.
    fn is_continued_to(&self, other: &Self, groups: &Groups) -> bool {
        /// The part of a step's length by which every series can be continued.
        const BEYOND: f64 = 0.5;
        let of_group = |group: Range<usize>| {
            let times = [group.start, group.end - 1].map(|i| other.events[i].time);
            [
                (group.start, times[0]),
                (group.start, times[1]),
                (group.end, times[1]),
            ]
        };
        let bound = |group: &Range<usize>| group.clone().all(|event| !other.is_smooth(event));
        let ends = groups.iter().filter(bound).flat_map(of_group);
        // Behind the last event too: an event of this motion alone is one that the other has not.
        let whole = [(0, other.begin), (other.events.len(), other.end)];
        let mut ends = whole.into_iter().chain(ends);
        ends.all(|(passed, time)| {
            let Some((step, since)) = self.step(passed, time) else {
                return false;
            };
            let outside = (since - step.duration()).max(-since).max(0.0);
            outside <= BEYOND * step.duration() || have_converged(step.series(), since)
        })
    }

    /// The largest distance of another motion before the events and at the end, in units of the
    /// sizes.
    pub(super) fn apart(&self, other: &Self, groups: &Groups) -> Option<f64> {
        let begins = groups.iter().map(|group| group.start);
        let begins = begins.map(|passed| (passed, self.events[passed].time));
        let mut apart: DVector<f64> = DVector::zeros(self.order);
        for (passed, time) in begins.chain([(self.events.len(), self.end)]) {
            let [a, b] = [self, other].map(|run| run.vector_at(passed, time));
            apart.zip_apply(&(a? - b?), |apart, x| *apart = apart.max(x.abs()));
        }
        let n = self.start.displacements.len();
        let places = [(0, n), (n, n), (2 * n, self.order - 2 * n)];
        let kinds = std::iter::zip(places, self.sizes()).filter(|(_, size)| *size > 0.0);
        let parts = kinds.map(|((first, count), size)| apart.rows(first, count).amax() / size);
        Some(parts.fold(0.0, f64::max))
    }

    /// The sizes of displacements, velocities and memory variables: one for each kind.
    fn sizes(&self) -> [f64; 3] {
        let mut sizes = [0.0; 3];
        // A step may lead from rest to rest.
        let states = |step: &Step| {
            let middle = 0.5 * step.duration().min(self.duration);
            [step.end_state(), step.state_at(middle)]
        };
        for state in self.segments.iter().flatten().flat_map(states) {
            let parts = [state.displacements, state.velocities, state.memory];
            for (size, part) in std::iter::zip(&mut sizes, parts) {
                *size = part.iter().fold(*size, |size: f64, x| size.max(x.abs()));
            }
        }
        sizes
    }

    /// The times of the events, the displacements and velocities after each group, and the state at
    /// the end of another motion; those of an event within a group are those after the group, and
    /// those of a smooth event, beside which derivatives change fast, those at the end.
    pub(super) fn probe(&self, here: &Self, groups: &Groups) -> Option<DVector<f64>> {
        let mut numbers: Vec<f64> = Vec::new();
        let count = here.events.len();
        numbers.extend(self.events[..count].iter().map(|event| event.time));
        let mut velocities = Vec::new();
        let ends = groups.iter().flat_map(|group| {
            let end = group.end;
            let is_smooth = group.clone().any(|event| here.is_smooth(event));
            let at = match is_smooth {
                true => (count, here.end),
                false => (end, here.events[end - 1].time),
            };
            group.map(move |_| at)
        });
        for (passed, time) in ends.chain([(count, here.end)]) {
            let state = self.state_at(passed, time)?;
            numbers.extend(&state.displacements);
            velocities.extend(state.velocities);
        }
        numbers.append(&mut velocities);
        numbers.extend(self.state_at(count, here.end)?.memory);
        Some(DVector::from_vec(numbers))
    }

    /// The places of the times, displacements, velocities and memory variables there, and the sizes
    /// of these numbers in the motion.
    pub(super) fn kinds(&self) -> [(Range<usize>, f64); 4] {
        let (events, n) = (self.events.len(), self.start.displacements.len());
        let states = (events + 1) * n;
        let counts = [events, states, states, self.order - 2 * n];
        let [displacement, velocity, memory] = self.sizes();
        let sizes = [self.duration, displacement, velocity, memory];
        let mut end = 0;
        std::array::from_fn(|kind| {
            let begin = end;
            end += counts[kind];
            (begin..end, sizes[kind])
        })
    }
}

/// Returns true if series have converged at a time since the start of their step: the last terms
/// are rounding errors. A step that ends at an event may be much shorter than its series converge.
fn have_converged(series: &[PowerSeries], time: f64) -> bool {
    /// The largest last term, in units of the largest term of the same series.
    const LAST: f64 = 64.0 * f64::EPSILON;
    series.iter().all(|series| {
        let mut power = 1.0;
        let (mut largest, mut last): (f64, [f64; 2]) = (0.0, [0.0; 2]);
        for c in series.coefficients() {
            last = [last[1], (c * power).abs()];
            largest = largest.max(last[1]);
            power *= time;
        }
        last[0].max(last[1]) <= LAST * largest
    })
}

/// The groups of events between which motions are compared: for each number of events whether the
/// motion after so many is between two groups. The events of a group may follow in any order.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Groups(pub(super) Vec<bool>);

impl Groups {
    fn iter(&self) -> impl Iterator<Item = Range<usize>> {
        let mut begin = 0;
        let ends = self.0.iter().enumerate().skip(1);
        ends.filter(|(_, between)| **between).map(move |(end, _)| {
            let group = begin..end;
            begin = end;
            group
        })
    }

    /// Makes groups of those that overlap.
    pub(super) fn join(&mut self, other: &Self) {
        for (between, other) in std::iter::zip(&mut self.0, &other.0) {
            *between &= other;
        }
    }

    /// The number of events before the group, if an event within it is the next.
    pub(super) fn before(&self, mut passed: usize) -> usize {
        while !self.0[passed] {
            passed -= 1;
        }
        passed
    }
}

/// The order of a motion's events, compared with that of another motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Likeness {
    /// The events follow in the same order.
    Same,
    /// Events that happen at one instant in the other motion follow one another; the time of the
    /// first of them.
    Parted(f64),
    /// Events that follow one another in the other motion have changed their order; the time of the
    /// first of them.
    Crossed(f64),
}

impl Likeness {
    /// Returns the likeness of several motions.
    pub(super) fn and(self, other: Self) -> Self {
        match (self, other) {
            (Self::Crossed(a), Self::Crossed(b)) => Self::Crossed(a.min(b)),
            (Self::Crossed(time), _) | (_, Self::Crossed(time)) => Self::Crossed(time),
            (Self::Parted(a), Self::Parted(b)) => Self::Parted(a.min(b)),
            (Self::Same, other) => other,
            (parted, Self::Same) => parted,
        }
    }
}

/// A motion beside another one, with its events in the order of the other one.
#[derive(Debug, Clone)]
pub(super) struct Neighbour {
    pub(super) run: Arc<Run>,
    pub(super) groups: Groups,
    pub(super) likeness: Likeness,
}

impl Neighbour {
    /// A motion beside another one; the time from which on it has other events, if it has.
    pub(super) fn of(here: &Run, mut run: Run) -> Result<Self, f64> {
        /// The most events that change their order without being at one instant.
        const CROSSING: usize = 32;
        let mut likeness = Likeness::Same;
        // Contacts that stick at the start come to rest at once if they have a velocity.
        let first_modes = here.first_modes();
        let comes_to_rest = |event: &&Event<State>| {
            event.kind == EventKind::Stick
                && event.contact().and_then(|c| first_modes.get(c)) == Some(&Mode::Stick)
        };
        let settling = run.events.iter().take_while(comes_to_rest).count();
        if settling > 0 {
            likeness = Likeness::Parted(here.begin);
            run.events.drain(..settling);
            run.segments.drain(..settling);
        }
        let count = here.events.len();
        let mut groups = Groups(vec![true; count + 1]);
        let mut begin = 0;
        while begin < count {
            let time = here.events[begin].time;
            let mut end = begin + 1;
            let mut crossing = 0;
            let places = loop {
                while end < count && (here.continues(end) || run.continues(end)) {
                    end += 1;
                }
                let others = run.events.get(begin..end).ok_or(time)?;
                if let Some(places) = places(&here.events[begin..end], others) {
                    break places;
                }
                (end, crossing) = (end + 1, crossing + 1);
                if end > count || crossing > CROSSING {
                    return Err(time);
                }
            };
            let (own, others) = (&here.events[begin..end], &mut run.events[begin..end]);
            for i in 1..own.len() {
                for j in 0..i {
                    let [now, then] = [
                        order_of(&own[j], &own[i]),
                        order_of(&others[places[j]], &others[places[i]]),
                    ];
                    likeness = likeness.and(match (now, then) {
                        (now, then) if now == then => Likeness::Same,
                        (Ordering::Equal, _) => Likeness::Parted(time),
                        _ => Likeness::Crossed(time),
                    });
                }
            }
            let sorted: Vec<_> = places.iter().map(|&place| others[place].clone()).collect();
            others.clone_from_slice(&sorted);
            groups.0[begin + 1..end].fill(false);
            begin = end;
        }
        if !run.is_continued_to(here, &groups) {
            return Err(here.begin);
        }
        let run = Arc::new(run);
        Ok(Self {
            run,
            groups,
            likeness,
        })
    }
}
