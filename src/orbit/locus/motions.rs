//! Motions of a family with two parameters: one period from a start away from events, and its
//! differences by start, period and parameters.
//!
//! The unknowns y are the start, the period T of an autonomous motion, the two parameters, and for
//! a torus κ, the cosine of the angle of its multipliers.

use std::cell::Cell;

use nalgebra::{DMatrix, DVector};

use super::super::curve::{FamilyMember, sharpest};
use super::super::form::GeneralForm;
use super::super::hold::Hold;
use super::super::map::{self, Course, PeriodMap, held_course, held_period_map, state, vector};
use super::super::period::Period;
use super::super::search::{MOST_STEPS_OF_A_SEARCH, Watched};
use super::super::sequence::Sequence;
use super::super::trial::Trial;
use super::super::walk::BLUNT;
use super::change::Change;
use crate::error::Error;
use crate::motion::{EventKind, Mode, Segment};
use crate::state::structure::State;

pub(super) type Family<'f> = dyn Fn(f64, f64) -> Result<Box<dyn FamilyMember + 'f>, Error> + 'f;

/// The motions of a family.
pub(super) struct Motions<'f> {
    pub(super) family: &'f Family<'f>,
    pub(super) kind: Period,
    pub(super) widths: [f64; 2],
    pub(super) n: usize,
    pub(super) order: usize,
    /// Number of motions tried, and of their steps.
    tried: Cell<usize>,
    steps: Cell<usize>,
    /// Limits of steps and of points in one direction.
    pub(super) most: (usize, usize),
    pub(super) watched: &'f Watched<'f>,
}

/// The start of motions, as far as it stays the same while Newton's method runs.
#[derive(Debug, Clone)]
pub(super) struct FrozenStart {
    /// The start of a forced motion, as a part of its period.
    pub(super) phase: f64,
    /// The modes of the contacts at the start.
    pub(super) modes: Vec<Mode>,
    /// The phase condition of an autonomous motion.
    pub(super) section: Option<Section>,
    /// The sizes of the start, and the period.
    pub(super) sizes: DVector<f64>,
    /// Contacts held past touches, and events that are watched.
    pub(super) holds: Vec<Hold>,
    pub(super) marks: Vec<Mark>,
}

/// An event that is watched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Mark {
    pub(super) contact: usize,
    /// Its kind; `None` for an arrival, which may become a stop or a crossing.
    pub(super) kind: Option<EventKind>,
    /// When, about, since the start of the motion, and at most how far from there.
    pub(super) since: f64,
    pub(super) within: f64,
}

/// The phase condition of an autonomous motion: a plane.
#[derive(Debug, Clone)]
pub(super) struct Section {
    /// The coordinate that turns at the start, v_i = 0: the condition holds however small the
    /// motion becomes. Otherwise the plane lies across the flow.
    pub(super) turning: Option<usize>,
    point: DVector<f64>,
    /// The normal, in units in which it is of size 1.
    pub(super) normal: DVector<f64>,
}

/// The derivatives of a motion by start and period, and its residual.
pub(super) struct MotionDerivatives {
    pub(super) by_start: DMatrix<f64>,
    pub(super) residual: DVector<f64>,
}

/// Limit of the motions tried in one direction.
const MOST_TRIALS: usize = 200_000;

/// Increments for differences, in units of the sizes: about the third root of ε, and shorter ones
/// near a change of the events.
const PARTS: [f64; 3] = [6e-6, 1e-7, 1e-9];

/// Parts of the period within which an event is near the start, when that is chosen and later.
const FAR: f64 = 0.02;
const NEAR: f64 = 0.005;

impl FrozenStart {
    /// The start at time 0, with no contact known to stick.
    pub(super) fn at_zero() -> Self {
        Self {
            phase: 0.0,
            modes: Vec::new(),
            section: None,
            sizes: DVector::zeros(0),
            holds: Vec::new(),
            marks: Vec::new(),
        }
    }

    /// Holds and watches another change of events.
    pub(super) fn add(&mut self, change: &Change) {
        let first = self.holds.len();
        let holds = change.holds.iter().map(|hold| Hold {
            number: first + hold.number,
            ..*hold
        });
        self.holds.extend(holds);
        self.marks.extend(&change.marks);
    }
}

impl Section {
    /// The residual of the phase condition, in units in which the normal is of size 1.
    pub(super) fn at(&self, start: &DVector<f64>) -> f64 {
        self.normal.dot(&(start - &self.point))
    }
}

impl<'f> Motions<'f> {
    pub(super) fn new(
        family: &'f Family<'f>,
        kind: Period,
        widths: [f64; 2],
        [n, order]: [usize; 2],
        (most, watched): ((usize, usize), &'f Watched<'f>),
    ) -> Self {
        Self {
            family,
            kind,
            widths,
            n,
            order,
            tried: Cell::new(0),
            steps: Cell::new(0),
            most,
            watched,
        }
    }

    pub(super) fn is_free(&self) -> bool {
        matches!(self.kind, Period::Free(_))
    }

    /// Number of unknowns of the motion alone: its start and its period.
    pub(super) fn own(&self) -> usize {
        self.order + usize::from(self.is_free())
    }

    /// The unknowns of a motion.
    pub(super) fn at(
        &self,
        start: &DVector<f64>,
        period: f64,
        parameters: [f64; 2],
    ) -> DVector<f64> {
        let own = self.own();
        let mut y = DVector::zeros(own + 2);
        y.rows_mut(0, self.order).copy_from(start);
        if self.is_free() {
            y[self.order] = period;
        }
        y.rows_mut(own, 2).copy_from_slice(&parameters);
        y
    }

    /// The parameters in y.
    pub(super) fn parameters(&self, y: &DVector<f64>) -> [f64; 2] {
        [y[self.own()], y[self.own() + 1]]
    }

    /// A point of a curve was found.
    pub(super) fn found(&self, y: &DVector<f64>) {
        let [first, second] = self.parameters(y);
        self.watched.at_pair(first, second);
        self.watched.found(first);
    }

    pub(super) fn begin_again(&self) {
        self.tried.set(0);
        self.steps.set(0);
    }

    pub(super) fn is_at_limit(&self) -> bool {
        let is_done = self.tried.get() > MOST_TRIALS || self.steps.get() > self.most.0;
        is_done || self.watched.is_stopped()
    }

    /// Something of the system with these parameters.
    pub(super) fn with<T>(
        &self,
        [first, second]: [f64; 2],
        take: impl FnOnce(&GeneralForm<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        self.with_form([first, second], |form| {
            self.watched.at_pair(first, second);
            let form = form.within(MOST_STEPS_OF_A_SEARCH, self.watched);
            let found = take(&form);
            self.steps.set(self.steps.get() + form.taken());
            self.watched.add(form.taken());
            found
        })
    }

    /// The same, not watched and not counted: what was found is kept if the search is stopped.
    fn with_form<T>(
        &self,
        [first, second]: [f64; 2],
        take: impl FnOnce(GeneralForm<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let find = || {
            for value in [first, second] {
                Error::check("orbit::locus", "parameter", value, true, "a number")?;
            }
            let member = (self.family)(first, second)?;
            take(member.form())
        };
        find().map_err(|error: Error| {
            error
                .at("second parameter", second)
                .at("first parameter", first)
        })
    }

    fn period(&self, form: &GeneralForm<'_>, y: &DVector<f64>) -> Result<f64, Error> {
        let kind = match self.kind {
            Period::Free(_) => Period::Free(y[self.order]),
            driven @ Period::Driven(_) => driven,
        };
        kind.duration(form.rhythm())
    }

    /// The time of the start in y, the start in its modes, and the period.
    fn start(
        &self,
        form: &GeneralForm<'_>,
        y: &DVector<f64>,
        begin: &FrozenStart,
    ) -> Result<(f64, State, f64), Error> {
        let period = self.period(form, y)?;
        let time = begin.phase * period;
        let mut start = state(&y.rows(0, self.order).into_owned(), self.n);
        form.put_in_modes(&mut start, time, |c| begin.modes.get(c).copied());
        Ok((time, start, period))
    }

    /// The motion over one period from the start in y.
    pub(super) fn trial(&self, y: &DVector<f64>, begin: &FrozenStart) -> Result<Trial, Error> {
        self.tried.set(self.tried.get() + 1);
        self.with(self.parameters(y), |form| {
            let (time, start, period) = self.start(form, y, begin)?;
            let map = held_period_map(form, (time, &start), period, &begin.holds)?;
            Ok(Trial::new(map, period))
        })
    }

    /// The same without derivatives, and something of it: the start, the steps and the period.
    pub(super) fn course<T>(
        &self,
        y: &DVector<f64>,
        begin: &FrozenStart,
        take: impl FnOnce(&GeneralForm<'_>, State, Course, f64) -> Result<T, Error>,
    ) -> Result<T, Error> {
        self.tried.set(self.tried.get() + 1);
        self.with(self.parameters(y), |form| {
            let (time, start, period) = self.start(form, y, begin)?;
            let course = held_course(form, (time, &start), period, &begin.holds)?;
            take(form, start, course, period)
        })
    }

    /// The derivatives of the end by start and period.
    pub(super) fn by_start(&self, map: &PeriodMap) -> DMatrix<f64> {
        let mut matrix = map.monodromy.clone();
        if self.is_free() {
            matrix = matrix.insert_column(self.order, 0.0);
            matrix.column_mut(self.order).copy_from(&map.flow[1]);
        }
        matrix
    }

    /// The difference quotients along a direction of y, in units of y, between motions with the
    /// same events: central, or one-sided if one side has no such motion.
    pub(super) fn difference(
        &self,
        y: &DVector<f64>,
        direction: &DVector<f64>,
        (trial, begin): (&Trial, &FrozenStart),
    ) -> Option<MotionDerivatives> {
        let own = self.own();
        let growth = trial.map.growth();
        let size = |i: usize| match i.checked_sub(own) {
            None => begin.sizes[i],
            Some(which) => self.widths[which],
        };
        let length = (0..own + 2).map(|i| (direction[i] / size(i)).abs());
        let length = length.fold(0.0, f64::max);
        if length == 0.0 {
            return Some(MotionDerivatives {
                by_start: DMatrix::zeros(self.order, own),
                residual: DVector::zeros(self.order),
            });
        }
        let events = events_of(&trial.map);
        let beside = |step: f64| {
            let beside = self.trial(&(y + direction * step), begin).ok()?;
            (events_of(&beside.map) == events).then(|| MotionDerivatives {
                by_start: self.by_start(&beside.map),
                residual: beside.map.residual(),
            })
        };
        let here = || {
            Some(MotionDerivatives {
                by_start: self.by_start(&trial.map),
                residual: trial.map.residual(),
            })
        };
        PARTS.iter().find_map(|part| {
            let step = part / (growth * growth) / length;
            let (low, high) = match (beside(-step), beside(step)) {
                (None, None) => return None,
                (None, high) => ((0.0, here()), (step, high)),
                (low, None) => ((-step, low), (0.0, here())),
                (low, high) => ((-step, low), (step, high)),
            };
            let (below, above, width) = (low.1?, high.1?, high.0 - low.0);
            Some(MotionDerivatives {
                by_start: (above.by_start - below.by_start) / width,
                residual: (above.residual - below.residual) / width,
            })
        })
    }

    /// A start of the motion away from its events: y there, and what stays.
    pub(super) fn begun(
        &self,
        y: &DVector<f64>,
        trial: &Trial,
        old: &FrozenStart,
    ) -> Result<(DVector<f64>, FrozenStart), Error> {
        let (map, period) = (&trial.map, trial.period);
        let begins = old.phase * period;
        let turn = sharpest(map).filter(|_| self.is_free());
        let turn = turn.filter(|turn| !near_events(map, turn.time, period, NEAR));
        let (time, state, modes) = match &turn {
            Some(turn) => (turn.time, turn.state.clone(), Some(&turn.modes[..])),
            None if near_events(map, begins, period, FAR) => middle(map, begins, period),
            None => (begins, map.start.clone(), map.first_modes()),
        };
        let mut begin = FrozenStart {
            phase: if self.is_free() {
                0.0
            } else {
                (time / period).fract()
            },
            modes: modes.unwrap_or_default().to_vec(),
            section: turn.map(|turn| Section {
                turning: Some(turn.coordinate),
                point: DVector::zeros(self.order),
                normal: DVector::zeros(self.order),
            }),
            sizes: DVector::zeros(0),
            holds: map.holds_later(time - begins, period),
            marks: old.marks.clone(),
        };
        for mark in &mut begin.marks {
            mark.since = (mark.since + begins - time).rem_euclid(period);
        }
        let mut y = y.clone();
        y.rows_mut(0, self.order)
            .copy_from(&vector(&state, self.order));
        let trial = self.trial(&y, &begin)?;
        y.rows_mut(0, self.order)
            .copy_from(&vector(&trial.map.start, self.order));
        self.settle(&y, &trial, &mut begin)?;
        Ok((y, begin))
    }

    /// The residual of a closed motion, and that of the phase condition, in units of the sizes.
    pub(super) fn residual(
        &self,
        y: &DVector<f64>,
        trial: &Trial,
        begin: &FrozenStart,
    ) -> DVector<f64> {
        let start = y.rows(0, self.order);
        let mut residual = trial.map.residual();
        residual.component_div_assign(&begin.sizes.rows(0, self.order));
        if let Some(section) = &begin.section {
            residual = residual.insert_row(self.order, section.at(&start.into_owned()));
        }
        residual
    }

    /// The derivatives of these residuals by start and period.
    pub(super) fn closing(
        &self,
        trial: &Trial,
        begin: &FrozenStart,
        scale: &DVector<f64>,
    ) -> DMatrix<f64> {
        let (order, own) = (self.order, self.own());
        let mut matrix = self.by_start(&trial.map).resize_vertically(own, 0.0);
        for i in 0..order {
            matrix[(i, i)] -= 1.0;
            for j in 0..own {
                matrix[(i, j)] *= scale[j] / begin.sizes[i];
            }
        }
        if let Some(Section { normal, .. }) = &begin.section {
            for j in 0..order {
                matrix[(order, j)] = normal[j] * scale[j];
            }
        }
        matrix
    }

    /// The error if no motion was found near here.
    pub(super) fn lost(&self, y: &DVector<f64>, trial: &Trial) -> Error {
        let [first, second] = self.parameters(y);
        let error = Error::NotPeriodic {
            residual: trial.residual,
            period: trial.period,
            start: trial.map.start.clone(),
        };
        error
            .at("second parameter", second)
            .at("first parameter", first)
    }

    /// Sets sizes and phase condition to those of a motion.
    pub(super) fn settle(
        &self,
        y: &DVector<f64>,
        trial: &Trial,
        begin: &mut FrozenStart,
    ) -> Result<(), Error> {
        let mut sizes = trial.map.sizes();
        if self.is_free() {
            sizes = sizes.insert_row(self.order, trial.period);
            let turning = begin.section.as_ref().and_then(|section| section.turning);
            let own = sizes.rows(0, self.order);
            let (point, normal) = if let Some(i) = turning {
                let mut normal = DVector::zeros(self.order);
                normal[self.n + i] = own[self.n + i].recip();
                (DVector::zeros(self.order), normal)
            } else {
                let normal = trial.map.flow[0].component_div(&own);
                if normal.amax() == 0.0 {
                    return Err(Error::AtRest);
                }
                let normal = normal.normalize().component_div(&own);
                (y.rows(0, self.order).into_owned(), normal)
            };
            begin.section = Some(Section {
                turning,
                point,
                normal,
            });
        }
        begin.sizes = sizes;
        Ok(())
    }

    /// Another start, if an event has come near this one, or the motion turns more sharply
    /// elsewhere.
    pub(super) fn moved(
        &self,
        y: &DVector<f64>,
        trial: &Trial,
        begin: &FrozenStart,
    ) -> Option<(DVector<f64>, FrozenStart)> {
        let begins = begin.phase * trial.period;
        let is_near = near_events(&trial.map, begins, trial.period, NEAR);
        let turning = begin.section.as_ref().and_then(|section| section.turning);
        let is_blunt = turning.is_some_and(|i| {
            let sharpness = trial.map.flow[0][self.n + i].abs() / begin.sizes[self.n + i];
            sharpest(&trial.map).is_some_and(|turn| sharpness < BLUNT * turn.sharpness)
        });
        (is_near || is_blunt).then(|| self.begun(y, trial, begin).ok())?
    }

    /// The motion from time 0 of the drives.
    pub(super) fn since_zero(
        &self,
        y: &DVector<f64>,
        trial: &Trial,
        begin: &FrozenStart,
    ) -> Result<Trial, Error> {
        if begin.phase == 0.0 {
            return Ok(trial.clone());
        }
        let period = trial.period;
        let step = trial.map.steps.iter().find(|step| step.end_time() > period);
        let Some(step) = step else {
            return Ok(trial.clone());
        };
        self.with_form(self.parameters(y), |form| {
            let mut start = step.state_at(step.since_start(period));
            form.put_in_modes(&mut start, 0.0, |c| Some(step.modes()[c]));
            let holds = trial.map.holds_later((1.0 - begin.phase) * period, period);
            let map = held_period_map(&form, (0.0, &start), period, &holds)?;
            Ok(Trial::new(map, period))
        })
    }

    pub(super) fn sequence(trial: &Trial) -> Sequence {
        Sequence::of(&trial.map, trial.period)
    }
}

/// The events of a motion behind its start: contact and kind.
pub(super) fn events_of(map: &PeriodMap) -> Vec<(usize, EventKind)> {
    let begins = map.steps.first().map_or(0.0, Segment::start_time);
    let events = map.steps.iter().flat_map(Segment::events);
    let events = events.filter(|event| event.time > begins);
    events.map(|event| (event.contact, event.kind)).collect()
}

/// Returns true if an event or a touch lies within a part of the period from a time of a closed
/// motion.
fn near_events(map: &PeriodMap, time: f64, period: f64, part: f64) -> bool {
    map.times().into_iter().any(|event| {
        let since = (event - time).rem_euclid(period);
        since < part * period || since > (1.0 - part) * period
    })
}

/// The middle of the longest time without an event in a motion: the time, the state and the modes.
fn middle(map: &PeriodMap, begins: f64, period: f64) -> (f64, State, Option<&[Mode]>) {
    let time = map::longest_pause(map, begins, begins + period);
    let step = map.steps.iter().find(|step| step.end_time() > time);
    step.map_or((begins, map.start.clone(), map.first_modes()), |step| {
        let state = step.state_at(step.since_start(time));
        (time, state, Some(step.modes()))
    })
}
