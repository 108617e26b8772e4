//! Differences between motions of a family with the same events.

use nalgebra::DVector;

use super::super::form::GeneralForm;
use super::super::map::vector;
use crate::error::{Error, Reached};
use crate::motion::{Event, EventKind, Integrator, Segment};
use crate::state::structure::State;
use crate::structure::{Flow, Step};

/// A motion, with its steps grouped by the events between them.
#[derive(Debug, Clone)]
pub(super) struct Run {
    segments: Vec<Vec<Step>>,
    pub(super) events: Vec<Event<State>>,
    pub(super) start: State,
    /// The time of its end, and the duration.
    pub(super) end: f64,
    pub(super) duration: f64,
    order: usize,
}

/// The events of a motion: contact and kind.
pub(super) type Kinds = [(usize, EventKind)];

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
            if reached >= end && !(run.events.len() < expected && missing) {
                break;
            }
        }
        Ok(run)
    }

    pub(super) fn kinds(&self) -> Vec<(usize, EventKind)> {
        let events = self.events.iter();
        events.map(|event| (event.contact, event.kind)).collect()
    }

    fn begins_like(&self, kinds: &Kinds) -> bool {
        let own = self.events.iter().take(kinds.len());
        own.map(|event| (event.contact, event.kind))
            .eq(kinds.iter().copied())
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

    /// The times of events and the states there, and the state at a time behind them.
    fn probe(&self, kinds: &Kinds, end: f64) -> Option<DVector<f64>> {
        let mut numbers = Vec::new();
        for event in &self.events[..kinds.len()] {
            numbers.push(event.time);
            numbers.extend(&event.state.displacements);
            numbers.extend(&event.state.velocities);
        }
        numbers.extend(self.vector_at(kinds.len(), end)?.iter());
        Some(DVector::from_vec(numbers))
    }

    /// The length by which the power series of this motion have to be continued beyond their steps
    /// for the event times of another one, in units of the steps' lengths.
    fn overhang(&self, other: &Self) -> f64 {
        let ends = other.events.iter().enumerate();
        let overhangs = ends.flat_map(|(i, event)| {
            [i, i + 1].map(|passed| {
                let Some((step, since)) = self.step(passed, event.time) else {
                    return f64::INFINITY;
                };
                let outside = (since - step.duration()).max(-since).max(0.0);
                outside / step.duration()
            })
        });
        overhangs.fold(0.0, f64::max)
    }

    /// The largest distance of another motion at the events and at the end, in units of the sizes.
    fn apart(&self, other: &Self) -> Option<f64> {
        let events = self.events.iter().map(|event| event.time);
        let mut sizes: DVector<f64> = DVector::zeros(self.order);
        let mut apart: DVector<f64> = DVector::zeros(self.order);
        for (passed, time) in events.chain([self.end]).enumerate() {
            let passed = passed.min(self.events.len());
            let [a, b] = [self, other].map(|run| run.vector_at(passed, time));
            let (a, b) = (a?, b?);
            sizes.zip_apply(&a, |size, x| *size = size.max(x.abs()));
            apart.zip_apply(&(a - b), |apart, x| *apart = apart.max(x.abs()));
        }
        let n = other
            .segments
            .iter()
            .flatten()
            .next()?
            .state()
            .displacements
            .len();
        // Displacements, velocities and memory variables each have one size.
        let mut largest: f64 = 0.0;
        for (first, count) in [(0, n), (n, n), (2 * n, self.order - 2 * n)] {
            let size = sizes.rows(first, count).amax();
            if size > 0.0 {
                largest = largest.max(apart.rows(first, count).amax() / size);
            }
        }
        Some(largest)
    }
}

/// Motions at several values of one parameter, with their weights in the derivative.
#[derive(Debug, Clone)]
pub(super) struct Variation {
    parts: Vec<(f64, Run)>,
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

/// A change below this is too small to be measured.
const UNSEEN: f64 = 1e-9;

/// The largest increment, in parts of the parameter, and that of a parameter that is 0.
const LARGEST: f64 = 1e-2;

/// The first increment.
const FIRST: f64 = 1e-7;

/// The least increment.
const LEAST: f64 = 1e-11;

impl Variation {
    /// Motions beside another one with the same events; `None` if there are none, however small the
    /// increment. `value` is the parameter, and `run` makes the motion for a change of it.
    pub(super) fn of(
        here: &Run,
        value: f64,
        run: &dyn Fn(f64) -> Result<Run, Error>,
    ) -> Option<Self> {
        let kinds = here.kinds();
        // A parameter that is 0 tells nothing of its unit.
        let [least, first, largest] = if value == 0.0 {
            [1e-60, FIRST, 1e60]
        } else {
            [LEAST, FIRST, LARGEST].map(|part| part * value.abs())
        };
        let beside = |change: f64| {
            let found = if change == 0.0 {
                here.clone()
            } else {
                run(change).ok()?
            };
            let fits = found.begins_like(&kinds) && found.overhang(here) <= 0.5;
            fits.then_some(found)
        };
        // The increment that changes the motion as much as it may.
        let mut step = first;
        let mut most = largest;
        loop {
            let sides = [step, -step].into_iter();
            let change = sides
                .filter_map(|change| here.apart(&beside(change)?))
                .next();
            match change {
                Some(change) if change < UNSEEN && 100.0 * step < most => step *= 100.0,
                Some(change) => {
                    step = (step * CHANGE / change.max(UNSEEN * UNSEEN)).min(most);
                    break;
                }
                None if step < least => return None,
                None => {
                    most = step;
                    step *= 0.1;
                }
            }
        }
        // Shorter ones, as long as that brings derivatives nearer to each other: a motion may bend
        // more than its size says, and rounding grows with every reduction.
        let mut best: Option<(f64, Self)> = None;
        let mut last: Option<DVector<f64>> = None;
        while step >= least {
            let Some(found) = Self::with_step(value, step, &beside) else {
                step *= 0.25;
                continue;
            };
            let probe = found.derivative(|run| run.probe(&kinds, here.end))?;
            let Some(before) = last.replace(probe.clone()) else {
                best = Some((f64::INFINITY, found));
                step *= 0.25;
                continue;
            };
            let error = (&probe - before).amax();
            if error <= AGREE * probe.amax() {
                return Some(found);
            }
            match &best {
                Some((least, _)) if error > 0.5 * least => break,
                _ => best = Some((error, found)),
            }
            step *= 0.25;
        }
        best.map(|best| best.1)
    }

    /// The motions for one increment: on both sides, or on one.
    fn with_step(value: f64, step: f64, beside: &dyn Fn(f64) -> Option<Run>) -> Option<Self> {
        let sides = [(CENTRAL, 1.0), (ONE_SIDED, 1.0), (ONE_SIDED, -1.0)];
        sides.into_iter().find_map(|(stencil, side)| {
            let parts = stencil.iter().map(|&(place, weight)| {
                // The increment as it is, in spite of rounding.
                let change = (value + side * place * step) - value;
                Some((weight * side / step, beside(change)?))
            });
            let parts: Option<Vec<_>> = parts.collect();
            parts.map(|parts| Self { parts })
        })
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
