//! The equations of changes of events: the motion is closed, and a scalar g is 0:
//!
//! | curve | g | which motion |
//! |---|---|---|
//! | grazing | r at its extremum | held past the touch, or at the end of a branch stuck from there on (`prescribed_modes.rs`) |
//! | onset of a stop | σR − N μ_s at an arrival that becomes a crossing | the real one |
//! | order | t_a − t_b of two events | the real one |
//!
//! The maps are continuous at these motions. They are smooth, or piecewise smooth with the border
//! g = 0 between the pieces. Derivatives are differences between motions with the same events.

use std::cell::Cell;
use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::super::event_sequence::Sequence;
use super::super::period_map::{CLOSED, vector};
use super::super::phase_condition::FrozenStart;
use super::super::prescribed_modes::{Hold, Then, Touch};
use super::super::shooting_residual::TrialMotion;
use super::super::type_erased_system::GeneralForm;
use super::change::{Change, margin};
use super::curve_of_motions::CurveOfMotions;
use super::found::{LocusKind, SpecialKind};
use super::motions::Motions;
use crate::error::{Element, Error};
use crate::motion::{EventKind, Segment};
use crate::numerics::trace::{Equations, Point};
use crate::structure::Step;

/// Curves of changes of events.
pub(super) struct EventCurve<'f> {
    pub(super) motions: Motions<'f>,
    pub(super) kind: LocusKind,
    pub(super) ranges: [Range<f64>; 2],
    /// The factor by which the last held motion magnifies perturbations.
    pub(super) growth: Cell<f64>,
}

/// A motion with its scalar.
#[derive(Debug, Clone)]
pub(super) struct Held {
    pub(super) begin: FrozenStart,
    start: DVector<f64>,
    /// End minus start; 0 for variables on which nothing depends.
    residual: DVector<f64>,
    scalar: f64,
    events: Vec<(Element, EventKind)>,
    /// The motion of a solution with its derivative, and its events except those that change.
    pub(super) trial: TrialMotion,
    sequence: Option<Sequence>,
    /// The products of 1 − μ over all multipliers μ of a solution: of the motion without the touch,
    /// and of the motion in which the contacts come to rest for a short time; NaN if there is no
    /// such motion.
    folds: [f64; 2],
}

/// The condition of a curve at a motion, and the times of its watched events.
struct Seen {
    scalar: f64,
    /// The times of the watched events since the start.
    marks: Vec<f64>,
}

/// Increments for differences, in units of the sizes. They are short, because a touch is strongly
/// nonlinear near another change of events; Newton's method needs no more steps with short
/// increments.
const PARTS: [f64; 2] = [1e-7, 1e-9];

impl EventCurve<'_> {
    fn unknowns(&self) -> usize {
        self.motions.own() + 2
    }

    /// The first guess: a motion from a start, with what is held and watched.
    pub(super) fn begin(
        &self,
        y: &DVector<f64>,
        begin: &FrozenStart,
    ) -> Result<(DVector<f64>, Held), Error> {
        let motions = &self.motions;
        let mut begin = begin.clone();
        begin.slip_on();
        let trial = motions.trial(y, &begin)?;
        let (y, begin) = motions.begun(y, &trial, &begin)?;
        let trial = motions.trial(&y, &begin)?;
        let held = self.held(&y, &begin, trial)?;
        Ok((y, held))
    }

    /// The value of a motion, of which the derivative is known.
    fn held(
        &self,
        y: &DVector<f64>,
        begin: &FrozenStart,
        trial: TrialMotion,
    ) -> Result<Held, Error> {
        let map = &trial.map;
        let (residual, start) = (map.residual(), vector(&map.start, self.motions.order));
        let events = map.events().map(|(event, _)| (event.element, event.kind));
        let seen = self.motions.with(self.motions.parameters(y), |form| {
            Ok(self.seen(form, (&map.steps, &map.touches), begin))
        })?;
        let seen = seen.ok_or_else(|| self.motions.lost(y, &trial))?;
        Ok(Held {
            begin: begin.clone(),
            start,
            residual,
            scalar: seen.scalar,
            events: events.collect(),
            sequence: None,
            folds: [f64::NAN; 2],
            trial,
        })
    }

    /// The scalar of a motion; `None` if the events are not found in it.
    fn seen(
        &self,
        form: &GeneralForm<'_>,
        (steps, touches): (&[Step], &[Touch]),
        begin: &FrozenStart,
    ) -> Option<Seen> {
        let marks: Option<Vec<_>> = begin.marks.iter().map(|mark| mark.find(steps)).collect();
        let marks = marks?;
        let scalar = match (self.kind, &marks[..]) {
            (LocusKind::StopOnset { .. }, [(step, event, _), ..]) => margin(form, step, event)?,
            (LocusKind::Order { .. }, [a, b, ..]) => (a.2 - b.2) / self.period_of(steps),
            _ => {
                if touches.len() < begin.holds.len() {
                    return None;
                }
                let touch = touches.iter().find(|touch| touch.hold.number == 0)?;
                touch.speed / speed_size(form, touch.hold.contact, begin)
            }
        };
        Some(Seen {
            scalar,
            marks: marks.iter().map(|mark| mark.2).collect(),
        })
    }

    fn period_of(&self, steps: &[Step]) -> f64 {
        steps.iter().map(Segment::duration).sum()
    }

    /// The motion with its residual, without its derivative.
    fn steps(&self, y: &DVector<f64>, near: &Held) -> Result<Held, Error> {
        let (motions, begin) = (&self.motions, &near.begin);
        let found = motions.steps(y, begin, |form, start, (steps, touches), _| {
            let Some(seen) = self.seen(form, (&steps, &touches), begin) else {
                return Ok(None);
            };
            let end = steps.last().map(Segment::end_state).unwrap_or_default();
            let residual = near.trial.map.residual_near(&start, &end);
            let events = steps.iter().flat_map(Segment::events);
            let events = events.map(|event| (event.element, event.kind)).collect();
            Ok(Some(Held {
                start: vector(&start, motions.order),
                residual,
                scalar: seen.scalar,
                events,
                ..near.clone()
            }))
        });
        found?.ok_or_else(|| motions.lost(y, &near.trial))
    }

    /// The residuals: closure, phase condition, and the scalar.
    fn residual_of(&self, y: &DVector<f64>, held: &Held) -> DVector<f64> {
        let motion = (&held.start, &held.residual);
        let residual = self.motions.residual(y, motion, &held.begin);
        let rows = residual.len();
        residual.insert_row(rows, held.scalar)
    }

    /// The start of the motion in which contacts that touch rest for no time; `None` if a contact
    /// sticks, or remembers its rest.
    fn resting(
        &self,
        y: &DVector<f64>,
        trial: &TrialMotion,
        begin: &FrozenStart,
    ) -> Option<FrozenStart> {
        let rests = self.motions.with_form(self.motions.parameters(y), |form| {
            let start = &trial.map.start;
            let rests = |hold: &Hold| hold.then == Then::Slips && hold.may_rest(&form, start);
            Ok(begin.holds.iter().all(rests))
        });
        rests.ok().filter(|rests| *rests)?;
        let mut begin = begin.clone();
        for hold in &mut begin.holds {
            hold.then = Then::SlipsAfterRest;
        }
        Some(begin)
    }

    /// The events except those that are held or watched.
    fn sequence(&self, trial: &TrialMotion, begin: &FrozenStart) -> Sequence {
        let begins = trial.map.steps.first().map_or(0.0, Segment::start_time);
        Sequence::except(&trial.map, trial.period, |event| {
            let mut marks = begin.marks.iter();
            marks.any(|mark| mark.covers(event, begins, trial.period))
        })
    }
}

impl<'f> CurveOfMotions<'f> for EventCurve<'f> {
    fn motions(&self) -> &Motions<'f> {
        &self.motions
    }

    fn motion(held: &Held) -> (&TrialMotion, &FrozenStart) {
        (&held.trial, &held.begin)
    }

    fn jumps_behind(&self, point: &Point<Held>) -> bool {
        /// Distances behind it, in units of the scales.
        const AWAY: [f64; 4] = [1e-9, 1e-8, 1e-7, 1e-6];
        let held = &point.value;
        AWAY.iter().any(|away| {
            let y = &point.y + point.tangent.component_mul(&point.scale) * *away;
            let beyond = self.motions.trial(&y, &held.begin);
            beyond.is_ok_and(|beyond| {
                let sequence = self.sequence(&beyond, &held.begin);
                held.sequence
                    .as_ref()
                    .is_some_and(|own| !own.is_like(&sequence))
            })
        })
    }

    fn holding(&self, held: &Held, change: &Change) -> Held {
        let mut held = held.clone();
        change.add_to(&mut held.begin);
        held.begin.slip_on();
        held
    }

    fn kind_with(&self, _: &GeneralForm<'_>, _: &TrialMotion, _: &Change) -> Option<SpecialKind> {
        Some(SpecialKind::DoubleGrazing)
    }

    fn special(&self, _: usize, _: &Point<Held>) -> Option<SpecialKind> {
        Some(SpecialKind::FoldGrazing)
    }
}

/// The size of the sliding speed of a contact.
pub(super) fn speed_size(form: &GeneralForm<'_>, contact: usize, begin: &FrozenStart) -> f64 {
    let n = form.len();
    form.model.contacts[contact].size_along(|j| begin.sizes[n + j])
}

impl Equations for EventCurve<'_> {
    type Value = Held;

    fn parameters(&self) -> [usize; 2] {
        let own = self.motions.own();
        [own, own + 1]
    }

    fn ranges(&self) -> &[Range<f64>; 2] {
        &self.ranges
    }

    fn value(&self, y: &mut DVector<f64>, near: &Held) -> Result<Held, Error> {
        let held = self.steps(y, near)?;
        y.rows_mut(0, self.motions.order).copy_from(&held.start);
        Ok(held)
    }

    fn residual(&self, y: &DVector<f64>, held: &Held) -> DVector<f64> {
        self.residual_of(y, held)
    }

    fn jacobian(
        &self,
        y: &DVector<f64>,
        held: &Held,
        scale: &DVector<f64>,
    ) -> Result<DMatrix<f64>, Error> {
        let own = self.motions.own();
        let mut jacobian = DMatrix::zeros(own + 1, self.unknowns());
        for j in 0..self.unknowns() {
            let size = match j.checked_sub(own) {
                None => held.begin.sizes[j],
                Some(which) => self.motions.widths[which],
            };
            let beside = |step: f64| {
                let mut beside = y.clone();
                beside[j] += step;
                let found = self.steps(&beside, held).ok()?;
                let same = found.events == held.events;
                // What is left of the step beside a large parameter.
                let step = beside[j] - y[j];
                Some((step, self.residual_of(&beside, &found), same))
            };
            let here = || Some((0.0, self.residual_of(y, held), true));
            let mut slope = None;
            for part in PARTS {
                let (low, high) = (beside(-part * size), beside(part * size));
                let is_same = |side: &Option<(f64, DVector<f64>, bool)>| {
                    side.as_ref().is_some_and(|side| side.2)
                };
                let any = is_same(&low) || is_same(&high);
                let pair = match (is_same(&low), is_same(&high)) {
                    (true, false) => (low, here()),
                    (false, true) => (here(), high),
                    _ if low.is_none() => (here(), high),
                    _ if high.is_none() => (low, here()),
                    _ => (low, high),
                };
                if let (Some((a, below, _)), Some((b, above, _))) = pair {
                    slope = Some((above - below) / (b - a));
                }
                if any {
                    break;
                }
            }
            let slope = slope.ok_or_else(|| self.motions.lost(y, &held.trial))?;
            jacobian.set_column(j, &(slope * scale[j]));
        }
        let growth = jacobian.view((0, 0), (own, own)).amax();
        self.growth.set(growth.max(1.0));
        Ok(jacobian)
    }

    fn rounding(&self, _: &Held) -> f64 {
        CLOSED * self.growth.get()
    }

    fn complete(&self, y: &DVector<f64>, mut held: Held) -> Result<Held, Error> {
        let motions = &self.motions;
        let trial = motions.trial(y, &held.begin)?;
        let is_free = held.begin.condition.is_some();
        let seen = motions.with(motions.parameters(y), |form| {
            let map = &trial.map;
            Ok(self.seen(form, (&map.steps, &map.touches), &held.begin))
        })?;
        let seen = seen.ok_or_else(|| motions.lost(y, &trial))?;
        for (mark, since) in std::iter::zip(&mut held.begin.marks, seen.marks) {
            mark.since = since;
        }
        let sequence = self.sequence(&trial, &held.begin);
        let is_other = |own: &Sequence| !own.is_like(&sequence);
        if held.sequence.as_ref().is_some_and(is_other) || (is_free && !trial.returns(None)) {
            return Err(motions.lost(y, &trial));
        }
        let folds = |trial: &TrialMotion| {
            let multipliers = trial.map.multipliers(is_free)?;
            let factors = multipliers.iter().map(|m| Complex::from(1.0) - m);
            Some(factors.product::<Complex<f64>>().re)
        };
        held.folds[0] = folds(&trial).ok_or_else(|| motions.lost(y, &trial))?;
        held.folds[1] = match self.resting(y, &trial, &held.begin) {
            Some(begin) => folds(&motions.trial(y, &begin)?).unwrap_or(f64::NAN),
            None => f64::NAN,
        };
        held.sequence = Some(sequence);
        held.begin.holds = trial.map.touches.iter().map(|touch| touch.hold).collect();
        let start = y.rows(0, motions.order).into_owned();
        held.begin.settle(start, &trial)?;
        held.trial = trial;
        Ok(held)
    }

    fn scale(&self, y: &DVector<f64>, held: &Held) -> DVector<f64> {
        let own = self.motions.own();
        DVector::from_fn(y.len(), |i, _| match i.checked_sub(own) {
            None => held.begin.sizes[i],
            Some(which) => self.motions.widths[which],
        })
    }

    fn moved(&self, point: &Point<Held>) -> Option<(DVector<f64>, Held)> {
        let held = &point.value;
        let (y, begin) = self.motions.moved(&point.y, &held.trial, &held.begin)?;
        let trial = self.motions.trial(&y, &begin).ok()?;
        let moved = self.held(&y, &begin, trial).ok()?;
        let sequence = held.sequence.clone();
        Some((y, Held { sequence, ..moved }))
    }

    fn tests(&self, point: &Point<Held>) -> Vec<f64> {
        match self.kind {
            LocusKind::Grazing { .. } => point.value.folds.to_vec(),
            _ => Vec::new(),
        }
    }

    fn ends_at(&self, _: usize) -> bool {
        false
    }

    fn begin_again(&self) {
        self.motions.work.begin_again();
    }

    fn is_at_limit(&self) -> bool {
        self.motions.work.is_at_limit()
    }

    fn most_points(&self) -> usize {
        self.motions.work.most.1
    }

    fn found(&self, point: &Point<Held>) {
        self.motions.found(&point.y);
    }

    fn lost(&self, y: &DVector<f64>, held: &Held) -> Error {
        self.motions.lost(y, &held.trial)
    }
}
