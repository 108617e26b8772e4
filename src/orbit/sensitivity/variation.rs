//! Differences between motions of a family with the same events.
//!
//! Events of several contacts at one instant are a group, in which the motions may have them in
//! different orders: states are compared before and after the group, and each time with that of
//! the same event. If the order on one side of the parameter is another one than on the other side,
//! the motion on each side is smooth, and the derivative exists if both sides have the same.

use std::cell::RefCell;
use std::cmp::Ordering;
use std::ops::Range;
use std::sync::Arc;

use nalgebra::DVector;

use super::super::form::GeneralForm;
use super::super::map::vector;
use crate::error::{Element, Error, NotDifferentiable, Reached};
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
    begin: f64,
    /// The time of its end, and the duration.
    pub(super) end: f64,
    pub(super) duration: f64,
    order: usize,
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

/// For each event of a group the place of the same event in another group; `None` if an element
/// has other events there.
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

    /// The step for a time after this number of events, and the time since its start; it may lie
    /// outside.
    fn step(&self, passed: usize, time: f64) -> Option<(&Step, f64)> {
        let steps = self.segments.get(passed)?;
        let step = steps.iter().find(|step| step.end_time() >= time);
        let step = step.or(steps.last())?;
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
        let ends = groups.iter().flat_map(of_group);
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
    fn apart(&self, other: &Self, groups: &Groups) -> Option<f64> {
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
struct Groups(Vec<bool>);

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
    fn join(&mut self, other: &Self) {
        for (between, other) in std::iter::zip(&mut self.0, &other.0) {
            *between &= other;
        }
    }

    /// The number of events before the group, if an event within it is the next.
    fn before(&self, mut passed: usize) -> usize {
        while !self.0[passed] {
            passed -= 1;
        }
        passed
    }
}

/// How the events of a motion follow, compared with another motion.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Likeness {
    /// In the same order.
    Same,
    /// Events that happen at one instant in the other motion follow one another; the time of the
    /// first of them.
    Parted(f64),
    /// Events that follow one another in the other motion have changed their order; the time of the
    /// first of them.
    Crossed(f64),
}

impl Likeness {
    /// That of several motions.
    fn and(self, other: Self) -> Self {
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
struct Neighbour {
    run: Arc<Run>,
    groups: Groups,
    likeness: Likeness,
}

impl Neighbour {
    /// A motion beside another one; the time from which on it has other events, if it has.
    fn of(here: &Run, mut run: Run) -> Result<Self, f64> {
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

/// Motions at several values of one parameter, with their weights in the derivative.
#[derive(Debug, Clone)]
pub(super) struct Variation {
    parts: Vec<(f64, Arc<Run>)>,
    groups: Groups,
    likeness: Likeness,
    /// Events whose times have no derivative, although the states have one.
    pub(super) timeless: Vec<usize>,
}

/// Formulas of fourth order: places in units of the increment, and weights.
type Stencil = &'static [(f64, f64)];

const CENTRAL: Stencil = &[
    (-2.0, 1.0 / 12.0),
    (-1.0, -2.0 / 3.0),
    (1.0, 2.0 / 3.0),
    (2.0, -1.0 / 12.0),
];
const ONE_SIDED: Stencil = &[
    (0.0, -25.0 / 12.0),
    (1.0, 4.0),
    (2.0, -3.0),
    (3.0, 4.0 / 3.0),
    (4.0, -0.25),
];

/// The change of the motion, in units of its size, that the increment is to cause: about the fifth
/// root of ε.
const CHANGE: f64 = 1e-3;

/// Derivatives that agree to this part need no shorter increment.
const AGREE: f64 = 1e-11;

/// Derivatives that differ by more than this part differ not by rounding alone, and shorter
/// increments bring them nearer to each other at last.
const COARSE: f64 = 1e-7;

/// Derivatives that differ by more than this part, as at a jump, do not converge.
const DIVERGED: f64 = 1e-3;

/// Derivatives of both sides may differ by this many errors of the derivative.
const ERRORS: f64 = 16.0;

/// A change below this is too small to be measured.
const UNSEEN: f64 = 1e-9;

/// If a hundredth of a small parameter changes the motion by less than this, increments are those
/// of a parameter of size 1.
const SLIGHT: f64 = 1e-5;

/// The largest increment, in parts of the parameter, or of 1.
const LARGEST: f64 = 1e-2;

/// The first increment.
const FIRST: f64 = 1e-7;

/// The least increment.
const LEAST: f64 = 1e-11;

/// The rounding errors of a motion, in units of its size.
const ROUNDING: f64 = 8192.0 * f64::EPSILON;

/// Derivatives of both sides that differ by this part are different.
const APART: f64 = 1e-7;

/// The motions beside one, for changes of a parameter.
struct Beside<'b> {
    here: &'b Run,
    run: &'b dyn Fn(f64) -> Result<Run, Error>,
    /// Those of one increment.
    found: RefCell<Vec<(f64, Option<Neighbour>)>>,
    /// The reason why the last was none.
    reason: RefCell<NotDifferentiable>,
}

impl Beside<'_> {
    fn at(&self, change: f64) -> Option<Neighbour> {
        let known = self.found.borrow();
        if let Some((_, found)) = known.iter().find(|known| known.0 == change) {
            return found.clone();
        }
        drop(known);
        let run = if change == 0.0 {
            Ok(self.here.clone())
        } else {
            (self.run)(change)
        };
        let found = match run.map(|run| Neighbour::of(self.here, run)) {
            Ok(Ok(found)) => Some(found),
            Ok(Err(time)) => {
                self.reason.replace(NotDifferentiable::Events { time });
                None
            }
            Err(error) => {
                self.reason
                    .replace(NotDifferentiable::NoMotion(Box::new(error)));
                None
            }
        };
        self.found.borrow_mut().push((change, found.clone()));
        found
    }

    /// The motions of a formula on a side.
    fn with(&self, stencil: Stencil, value: f64, step: f64) -> Option<Variation> {
        let parts = stencil.iter().map(|&(place, weight)| {
            // The increment as it is, in spite of rounding.
            let change = (value + place * step) - value;
            Some((weight / step, self.at(change)?))
        });
        let parts: Vec<(f64, Neighbour)> = parts.collect::<Option<_>>()?;
        let mut groups = Groups(vec![true; self.here.events.len() + 1]);
        let mut likeness = Likeness::Same;
        for (_, part) in &parts {
            groups.join(&part.groups);
            likeness = likeness.and(part.likeness);
        }
        let parts = parts.into_iter().map(|(weight, part)| (weight, part.run));
        Some(Variation {
            parts: parts.collect(),
            groups,
            likeness,
            timeless: Vec::new(),
        })
    }
}

/// What one increment gives.
enum Slope {
    /// Motions on both sides, or on one.
    Of(Variation),
    /// The derivatives of both sides differ by these numbers: of displacements, velocities and
    /// memory variables. The time of the events.
    Differs([f64; 3], f64),
    /// There are no motions with the same events.
    None,
}

impl Variation {
    /// Motions beside another one with the same events. `value` is the parameter, and `run` makes
    /// the motion for a change of it.
    pub(super) fn of(
        here: &Run,
        value: f64,
        run: &dyn Fn(f64) -> Result<Run, Error>,
    ) -> Result<Self, NotDifferentiable> {
        /// Increments after which derivatives will not come closer.
        const TRIED: usize = 3;
        let stays = |differences: &[[f64; 3]]| {
            let count = differences.len();
            let before = count.checked_sub(TRIED + 1).map(|i| differences[i]);
            before.is_some_and(|before| {
                std::iter::zip(differences[count - 1], before).any(|(by, before)| by > 0.5 * before)
            })
        };
        // A parameter that is 0 tells nothing of its unit; nor does one of which parts underflow.
        let mut has_no_unit = value.abs() < f64::MIN_POSITIVE;
        let [mut least, first, mut most] = if has_no_unit {
            [1e-60, FIRST, 1e60]
        } else {
            [LEAST, FIRST, LARGEST].map(|part| part * value.abs())
        };
        let beside = Beside {
            here,
            run,
            found: RefCell::new(Vec::new()),
            reason: RefCell::new(NotDifferentiable::Events { time: here.begin }),
        };
        // The increment that changes the motion as much as it may.
        let mut step = first;
        let mut is_bounded = most >= LARGEST;
        loop {
            let sides = [step, -step].into_iter();
            let change = sides
                .filter_map(|change| {
                    let found = beside.at(change)?;
                    here.apart(&found.run, &found.groups)
                })
                .next();
            beside.found.borrow_mut().clear();
            match change {
                Some(change) if change < UNSEEN && 100.0 * step < most => step *= 100.0,
                Some(change) if !is_bounded && change * most < SLIGHT * step => {
                    (most, is_bounded, has_no_unit) = (LARGEST, true, true);
                }
                Some(change) => {
                    step = (step * CHANGE / change.max(UNSEEN * UNSEEN)).min(most);
                    if has_no_unit {
                        least = LEAST / CHANGE * step;
                    }
                    break;
                }
                None if step < least => return Err(beside.reason.into_inner()),
                None => {
                    (most, is_bounded) = (step, true);
                    step *= 0.1;
                }
            }
        }
        // Shorter ones, as long as that brings derivatives nearer to each other: a motion may bend
        // more than its size says, and rounding grows with every reduction.
        let mut best: Option<Candidate> = None;
        let mut last: Option<DVector<f64>> = None;
        let mut apart: Vec<[f64; 3]> = Vec::new();
        let mut rough: Vec<[f64; 3]> = Vec::new();
        while step >= least {
            let slope = Self::with_step(value, step, &beside);
            beside.found.borrow_mut().clear();
            let increment = step;
            step *= 0.25;
            let found = match slope {
                Slope::Of(found) => found,
                Slope::Differs(by, time) => {
                    apart.push(by);
                    if stays(&apart) {
                        return Err(NotDifferentiable::Order { time });
                    }
                    continue;
                }
                Slope::None => continue,
            };
            let Some(probe) = found.derivative(|run| run.probe(here, &found.groups)) else {
                continue;
            };
            let Some(before) = last.replace(probe.clone()) else {
                continue;
            };
            let size = probe.amax();
            let found = Candidate {
                error: &probe - before,
                step: increment,
                probe,
                found,
            };
            let roughness = found.roughness(here);
            if roughness != [0.0; 3] {
                rough.push(roughness);
                if stays(&rough) {
                    return Err(NotDifferentiable::Kink);
                }
                continue;
            }
            let error = found.error.amax();
            let least = best.as_ref().map(|best| best.error.amax());
            if least.is_none_or(|least| error < least) {
                best = Some(found);
            }
            let is_rising = |least: f64| error > 0.5 * least && least <= COARSE * size;
            if error <= AGREE * size || least.is_some_and(is_rising) {
                break;
            }
        }
        match best {
            Some(best) => Ok(best.found),
            None if rough.is_empty() => Err(beside.reason.into_inner()),
            None => Err(NotDifferentiable::Kink),
        }
    }

    /// The motions for one increment: on both sides if their derivatives agree, or on one if the
    /// events of the other side are others.
    fn with_step(value: f64, step: f64, beside: &Beside<'_>) -> Slope {
        let central = beside.with(CENTRAL, value, step);
        if let Some(found) = central.filter(|found| found.likeness == Likeness::Same) {
            return Slope::Of(found);
        }
        let sides = [step, -step].map(|step| beside.with(ONE_SIDED, value, step));
        match sides {
            [Some(up), Some(down)] => {
                let Some((timeless, apart)) = up.apart_from(&down, beside.here, step) else {
                    return Slope::None;
                };
                if apart == [0.0; 3] {
                    return Slope::Of(up.and(down, timeless));
                }
                match (up.likeness, down.likeness) {
                    (Likeness::Same, Likeness::Crossed(_)) => Slope::Of(up),
                    (Likeness::Crossed(_), Likeness::Same) => Slope::Of(down),
                    // Shorter increments may leave the order as it is.
                    (Likeness::Crossed(time), _) | (_, Likeness::Crossed(time)) => {
                        beside.reason.replace(NotDifferentiable::Order { time });
                        Slope::None
                    }
                    (Likeness::Parted(time), _) | (_, Likeness::Parted(time)) => {
                        Slope::Differs(apart, time)
                    }
                    _ => Slope::None,
                }
            }
            [Some(one), None] | [None, Some(one)] => match one.likeness {
                Likeness::Crossed(_) => Slope::None,
                _ => Slope::Of(one),
            },
            [None, None] => Slope::None,
        }
    }

    /// The mean of the derivatives of both sides.
    fn and(mut self, other: Self, timeless: Vec<usize>) -> Self {
        self.timeless = timeless;
        self.groups.join(&other.groups);
        self.parts.extend(other.parts);
        self.parts.iter_mut().for_each(|part| part.0 *= 0.5);
        self
    }

    /// The events whose times have other derivatives on another side, for an increment; and by how
    /// much the derivatives of displacements, velocities and memory variables differ.
    fn apart_from(&self, other: &Self, here: &Run, step: f64) -> Option<(Vec<usize>, [f64; 3])> {
        let mut groups = self.groups.clone();
        groups.join(&other.groups);
        let probe = |of: &Self| of.derivative(|run| run.probe(here, &groups));
        let (a, b) = (probe(self)?, probe(other)?);
        let apart = here.kinds().map(|(kind, size)| {
            let [a, b] = [&a, &b].map(|of| of.rows_range(kind.clone()));
            let least = APART * a.amax().max(b.amax()) + ROUNDING * size / step;
            (a - b).map(|apart| {
                if apart.abs() <= least {
                    0.0
                } else {
                    apart.abs()
                }
            })
        });
        let [times, states @ ..] = apart;
        let timeless = times.iter().enumerate();
        let timeless = timeless.filter(|(_, apart)| **apart != 0.0).map(|(i, _)| i);
        Some((timeless.collect(), states.map(|apart| apart.amax())))
    }

    /// The number of events before a time at which the motions can be compared.
    pub(super) fn passed(&self, here: &Run, time: f64) -> usize {
        self.groups.before(here.passed(time))
    }

    /// The difference of the derivatives of both sides, by formulas of second order with the
    /// motions of the central formula; `None` if there is only one side.
    fn kink(&self, here: &Run, step: f64) -> Option<DVector<f64>> {
        let [far_down, down, up, far_up] = &self.parts[..] else {
            return None;
        };
        let at = |run: &Run| run.probe(here, &self.groups);
        let near = at(&down.1)? + at(&up.1)?;
        let far = at(&far_down.1)? + at(&far_up.1)?;
        Some((near * 4.0 - far - at(here)? * 6.0) / (2.0 * step))
    }

    /// The derivative of a quantity of the motions.
    pub(super) fn derivative(
        &self,
        of: impl Fn(&Run) -> Option<DVector<f64>>,
    ) -> Option<DVector<f64>> {
        // The weights sum to 0: what does not change has the derivative 0 to the bit.
        let first = of(&self.parts.first()?.1)?;
        let mut sum = &first * 0.0;
        for (weight, run) in &self.parts {
            sum += (of(run)? - &first) * *weight;
        }
        Some(sum)
    }
}

/// A derivative, and its difference from that of an increment four times as large.
struct Candidate {
    found: Variation,
    step: f64,
    probe: DVector<f64>,
    error: DVector<f64>,
}

impl Candidate {
    /// By how much the derivatives of displacements, velocities and memory variables differ between
    /// the increments, or between both sides; 0 if they are those of a smooth family.
    fn roughness(&self, here: &Run) -> [f64; 3] {
        let kink = self.found.kink(here, self.step);
        let [_, states @ ..] = here.kinds();
        states.map(|(kind, size)| {
            let of = |numbers: &DVector<f64>| numbers.rows_range(kind.clone()).amax();
            let (largest, error) = (of(&self.probe), of(&self.error));
            let kink = kink.as_ref().map_or(0.0, of);
            let rounding = ROUNDING * size / self.step;
            let converges = error <= DIVERGED * largest + rounding;
            if converges && kink <= APART * largest + rounding + ERRORS * error {
                0.0
            } else {
                kink.max(error)
            }
        })
    }
}

impl Run {
    /// The times of the events, the displacements and velocities after each group, and the state at
    /// the end of another motion; those of an event within a group are those after the group.
    fn probe(&self, here: &Self, groups: &Groups) -> Option<DVector<f64>> {
        let mut numbers: Vec<f64> = Vec::new();
        let count = here.events.len();
        numbers.extend(self.events[..count].iter().map(|event| event.time));
        let mut velocities = Vec::new();
        let ends = groups.iter().flat_map(|group| {
            let end = group.end;
            let time = here.events[end - 1].time;
            group.map(move |_| (end, time))
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
    fn kinds(&self) -> [(Range<usize>, f64); 4] {
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
