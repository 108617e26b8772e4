//! A branch as a curve: the equations with the parameter as one more unknown, and Newton's method
//! on a plane across the curve.
//!
//! The unknowns y are the start, the period of an autonomous motion, and the parameter. The phase
//! condition of an autonomous motion is a turning point of one coordinate, v_i = 0: it remains
//! valid for arbitrarily small motions. If the system can be translated, v_i is relative to the
//! velocity of another coordinate.

use std::cell::Cell;
use std::ops::{ControlFlow, Range};

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::branch::BranchEnd;
use super::form::GeneralForm;
use super::map::{self, CLOSED, PeriodMap, state, vector};
use super::oscillator::{Family, FamilyMember};
use super::passage::{is_inside, passage};
use super::period::Period;
use super::sequence::Sequence;
use super::spectrum::spectrum;
use super::translation::Turning;
use super::trial::TrialMotion;
use crate::error::Error;
use crate::motion::{Mode, Segment};
use crate::numerics::least_norm::least_norm_by_rows;
use crate::numerics::trace::{Plane, is_in_or_near};
use crate::search::{MOST_STEPS_OF_A_SEARCH, Watched};
use crate::state::structure::State;

/// The equations of the periodic motions of a family.
pub(super) struct Curve<'f> {
    pub(super) family: &'f Family<'f>,
    pub(super) kind: Period,
    pub(super) range: Range<f64>,
    pub(super) n: usize,
    pub(super) order: usize,
    /// The weight of each unknown in distances and planes. It is 0 for a memory that events reset,
    /// because such a memory jumps when one of these events passes the start; otherwise 1.
    pub(super) weights: DVector<f64>,
    /// √(M⁻¹)_ii for each coordinate i; for each memory variable √k_t if it is the force of an
    /// elastic contact, otherwise 0. States of equal energy are in proportion to these numbers.
    pub(super) mobilities: Vec<f64>,
    /// The coordinate of the phase condition of an autonomous motion.
    pub(super) turning: Option<Turning>,
    /// Number of motions tried.
    pub(super) tried: Cell<usize>,
    /// Number of steps of all motions tried.
    pub(super) steps: Cell<usize>,
    /// Limits of steps and of points in one direction.
    pub(super) most: (usize, usize),
    pub(super) watched: &'f Watched<'f>,
}

/// A point of the curve.
#[derive(Clone)]
pub(super) struct Solved {
    pub(super) y: DVector<f64>,
    pub(super) trial: TrialMotion,
    pub(super) sequence: Sequence,
    pub(super) multipliers: Vec<Complex<f64>>,
    /// The unit tangent of the curve, in units of the scales with which it was found; a memory that
    /// events set anew does not count for its length.
    pub(super) tangent: DVector<f64>,
    /// The derivative of the residual with respect to the parameter; `None` for a guess.
    slope: Option<DVector<f64>>,
    /// Number of Newton steps.
    pub(super) steps: usize,
    /// The modes of the contacts at the start.
    pub(super) modes: Vec<Mode>,
}

impl Solved {
    /// Returns true if another motion has the same events in the same order from the start, so that
    /// the curve is smooth between them.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        let [first, others] = [self, other].map(|solved| solved.trial.map.first_modes());
        self.sequence.is_like(&other.sequence) && first == others
    }
}

/// Limit of the motions tried in one direction.
const MOST_TRIALS: usize = 50_000;

/// Limit of Newton steps; three or four are usual.
const MOST_STEPS: usize = 16;

/// The first step with the derivatives of another motion is at most this long, and each other at
/// most this part of the one before.
const NEARBY: f64 = 1e-3;
const CONVERGING: f64 = 0.25;

/// They have converged, to rounding or nearly, if the last one is below this size.
const CONVERGED: f64 = 1e-9;

/// A step above this size has the derivative by the parameter computed again.
const COARSE: f64 = 1e-5;

/// Steps below this size are rounding.
pub(super) const FINE: f64 = 1e-13;

/// If a Newton step is smaller than this part of the step before, convergence is quadratic, and the
/// next step would be rounding.
const FAST: f64 = 1e-3;

/// Curvature of a residual over an increment of the parameter, as a part of its change, up to which
/// a central difference has errors of its square only.
const STRAIGHT: f64 = 1e-3;

/// A derivative up to which short increments lose few digits.
const MILD: f64 = 30.0;

/// Increments of the parameter for the derivative, in units of the range: shorter ones near a
/// change of the event sequence.
const PARTS: [f64; 3] = [1e-6, 1e-8, 1e-10];

impl Curve<'_> {
    /// Number of unknowns.
    pub(super) fn unknowns(&self) -> usize {
        self.order + usize::from(self.turning.is_some()) + 1
    }

    /// Sets the weights and mobilities, for systems of a form.
    pub(super) fn weigh(&mut self, form: &GeneralForm<'_>) {
        let masses = form.model.inverse_mass.rows().map(|(own, _)| own);
        let springs = form.model.contacts.iter().flat_map(|contact| {
            let stiffness = contact.tangential_stiffness.unwrap_or(0.0);
            std::iter::repeat_n(stiffness, contact.memory.len())
        });
        self.mobilities = masses.chain(springs).map(f64::sqrt).collect();
        self.weights = DVector::from_element(self.unknowns(), 1.0);
        let reset = form.are_reset();
        for (weight, reset) in self.weights.iter_mut().skip(2 * form.len()).zip(reset) {
            *weight = if reset { 0.0 } else { 1.0 };
        }
    }

    /// A vector in units of the scales, times the weights: the part that counts for distances and
    /// directions.
    pub(super) fn measured(&self, vector: &DVector<f64>) -> DVector<f64> {
        vector.component_mul(&self.weights)
    }

    /// A tangent of length 1, as far as it counts.
    pub(super) fn unit(&self, tangent: &DVector<f64>) -> DVector<f64> {
        tangent / self.measured(tangent).norm()
    }

    /// A point of the curve in units of scales, as far as it counts.
    pub(super) fn scaled(&self, y: &DVector<f64>, scale: &DVector<f64>) -> DVector<f64> {
        self.measured(&y.component_div(scale))
    }

    /// Number of periods of the drives in one of the motion.
    pub(super) fn periods(&self) -> usize {
        match self.kind {
            Period::Driven(periods) => periods,
            Period::Free(_) => 1,
        }
    }

    /// The point of the same motion if it begins some periods of the drives later.
    pub(super) fn begun_later(&self, solved: &Solved, periods: usize) -> Option<DVector<f64>> {
        let part = periods as f64 / self.periods() as f64;
        let map = &solved.trial.map;
        let state = map.vector_at(part * solved.trial.period)?;
        let mut change = state - vector(&map.start, self.order);
        map.untranslated(&mut change);
        let mut y = solved.y.clone();
        let mut start = y.rows_mut(0, self.order);
        start += map.without_idle(change);
        Some(y)
    }

    pub(super) fn width(&self) -> f64 {
        self.range.end - self.range.start
    }

    pub(super) fn parameter(&self, y: &DVector<f64>) -> f64 {
        y[self.unknowns() - 1]
    }

    fn member(&self, parameter: f64) -> Result<Box<dyn FamilyMember + '_>, Error> {
        Error::check(
            "orbit::follow",
            "parameter",
            parameter,
            is_in_or_near(&self.range, parameter),
            "inside its range",
        )
        .and_then(|parameter| (self.family)(parameter))
    }

    /// The eigenvalues of steady sliding at a value of the parameter.
    pub(super) fn spectrum(&self, parameter: f64) -> Result<Vec<Complex<f64>>, Error> {
        spectrum(&self.member(parameter)?.form())
    }

    /// The start for one system: contacts that stick have the velocity of their belts, elastic ones
    /// that slip their limit.
    fn start(&self, form: &GeneralForm<'_>, y: &DVector<f64>, modes: &[Mode]) -> State {
        let mut start = state(&y.rows(0, self.order).into_owned(), self.n);
        form.put_in_modes(&mut start, 0.0, &|c| modes.get(c).copied());
        self.anchor(&mut start);
        start
    }

    /// Sets the velocity of the phase condition.
    fn anchor(&self, start: &mut State) {
        if let Some(turning) = &self.turning {
            turning.impose(&mut start.velocities);
        }
    }

    fn period(&self, form: &GeneralForm<'_>, y: &DVector<f64>) -> Result<f64, Error> {
        let kind = match self.kind {
            Period::Free(_) => Period::Free(y[self.order]),
            driven @ Period::Driven(_) => driven,
        };
        kind.duration(form.rhythm())
    }

    pub(super) fn trial(&self, y: &DVector<f64>, modes: &[Mode]) -> Result<TrialMotion, Error> {
        let (map, period) = self.motion(y, modes, 1.0)?;
        Ok(TrialMotion::new(map, period))
    }

    /// A system of the family, watched.
    fn form<'m>(&'m self, member: &'m dyn FamilyMember, parameter: f64) -> GeneralForm<'m> {
        self.watched.at(parameter);
        member.form().within(MOST_STEPS_OF_A_SEARCH, self.watched)
    }

    /// The result of a function of the system with the parameter of y and of the period.
    pub(super) fn with<T>(
        &self,
        y: &DVector<f64>,
        take: impl FnOnce(&GeneralForm<'_>, f64) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let find = || {
            let member = self.member(self.parameter(y))?;
            let form = self.form(&*member, self.parameter(y));
            let period = self.period(&form, y)?;
            let found = take(&form, period);
            self.watched.add(form.taken());
            self.steps.set(self.steps.get() + form.taken());
            found
        };
        find().map_err(|error: Error| error.at("parameter", self.parameter(y)))
    }

    /// Returns true if the work allowed in one direction is done, or the search was stopped.
    pub(super) fn is_at_limit(&self) -> bool {
        let is_done = self.tried.get() > MOST_TRIALS || self.steps.get() > self.most.0;
        is_done || self.watched.is_stopped()
    }

    /// The end of a branch at a limit of work, after its last motion.
    pub(super) fn end_at_limit(&self, last: &Solved) -> BranchEnd {
        let parameter = self.parameter(&last.y);
        if self.watched.is_stopped() {
            BranchEnd::Stopped { parameter }
        } else {
            BranchEnd::Work
        }
    }

    /// The motion over a number of its periods, and the period.
    pub(super) fn motion(
        &self,
        y: &DVector<f64>,
        modes: &[Mode],
        periods: f64,
    ) -> Result<(PeriodMap, f64), Error> {
        self.tried.set(self.tried.get() + 1);
        self.with(y, |form, period| {
            let start = self.start(form, y, modes);
            Ok((form.period_map(&start, periods * period)?, period))
        })
    }

    /// The derivative of the residual by the parameter, by differences between motions with the
    /// same events: central, or one-sided if one side has no such motion.
    pub(super) fn by_parameter(
        &self,
        y: &DVector<f64>,
        trial: &TrialMotion,
        modes: &[Mode],
    ) -> DVector<f64> {
        let last = self.unknowns() - 1;
        let steps = trial.map.steps.iter().flat_map(Segment::events);
        let events: Vec<_> = steps
            .filter(|event| is_inside(event.time, trial.period))
            .map(|event| (event.element, event.kind))
            .collect();
        let miss = |change: f64| {
            let mut beside = y.clone();
            beside[last] += change;
            let found = self.with(&beside, |form, period| {
                passage(form, &self.start(form, &beside, modes), period)
            });
            let (end, passed) = found.ok()?;
            // From the start of the trial: what the modes impose on a start changes with the
            // parameter.
            let miss = trial.map.residual_near(&trial.map.start, &end);
            Some((beside[last] - y[last], miss, passed == events))
        };
        let here = trial.map.residual();
        let mut slope = DVector::zeros(self.order);
        // A map with a large derivative may be nonlinear as strongly as its square, as beside a
        // tangential arrival. If it is not, longer increments lose less to rounding.
        let growth = 0.5 * trial.map.growth();
        let nonlinearity = 1.0 + growth * growth;
        if growth > MILD {
            let step = PARTS[0] * self.width() / nonlinearity.cbrt();
            let (low, high) = (miss(-step), miss(step));
            if let (Some((a, below, true)), Some((b, above, true))) = (low, high)
                && (&below + &above - &here * 2.0).norm() <= STRAIGHT * (&above - &below).norm()
            {
                return (above - below) / (b - a);
            }
        }
        for part in PARTS {
            let step = part * self.width() / nonlinearity;
            let (low, high) = (miss(-step), miss(step));
            let here = Some((0.0, here.clone(), true));
            let is_same =
                |side: &Option<(f64, DVector<f64>, bool)>| side.as_ref().is_some_and(|side| side.2);
            let any = is_same(&low) || is_same(&high);
            let pair = match (is_same(&low), is_same(&high)) {
                (true, false) => (low, here),
                (false, true) => (here, high),
                _ if low.is_none() => (here, high),
                _ if high.is_none() => (low, here),
                _ => (low, high),
            };
            if let (Some((a, below, _)), Some((b, above, _))) = pair {
                slope = (above - below) / (b - a);
            }
            if any {
                break;
            }
        }
        slope
    }

    /// The Jacobian of the equations in units of the scales, with a row of zeros below; and the
    /// right-hand side of Newton's method.
    pub(super) fn linearised(
        &self,
        y: &DVector<f64>,
        trial: &TrialMotion,
        by_parameter: &DVector<f64>,
        scale: &DVector<f64>,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let (map, order, unknowns) = (&trial.map, self.order, self.unknowns());
        let sizes = map.sizes();
        let (mut matrix, mut right) = map.closing(scale, unknowns);
        for i in 0..order {
            matrix[(i, unknowns - 1)] = by_parameter[i] * (scale[unknowns - 1] / sizes[i]);
        }
        if let Some(turning) = &self.turning {
            for i in 0..order {
                matrix[(i, order)] = map.flow[1][i] * (scale[order] / sizes[i]);
            }
            let unit = scale[self.n + turning.coordinate];
            for (j, factor) in turning.entries(self.n) {
                matrix[(order, j)] = factor * (scale[j] / unit);
            }
        }
        // Before M − 1 cancels, the terms of a row are as large as that of the 1. In a continuum a
        // row cancels to rounding: enlarged to size 1 it would be an equation between errors.
        for i in 0..order {
            let mut row = matrix.row_mut(i);
            if row.amax() <= SINGULAR * (scale[i] / sizes[i]) {
                row.fill(0.0);
            }
        }
        self.turn_in(&mut right, y, scale);
        // What is kept depends neither on the parameter nor on the period.
        for row in map.kept() {
            let mut row = matrix.row_mut(row);
            row.columns_mut(order, unknowns - order).fill(0.0);
        }
        (matrix, right)
    }

    /// Sets the right-hand side of the phase condition.
    fn turn_in(&self, right: &mut DVector<f64>, y: &DVector<f64>, scale: &DVector<f64>) {
        if let Some(turning) = &self.turning {
            let unit = scale[self.n + turning.coordinate];
            right[self.order] = -turning.of_velocities(|j| y[self.n + j]) / unit;
        }
    }

    /// The memory variables that their laws reset, of contacts that stick at the end of a trial but
    /// not at its start: their places and their values at the end.
    ///
    /// If the release of such a contact passes the start of the period, the memory at the start
    /// jumps from that of slip to that of the whole rest, which Newton's method does not know.
    fn stopped_clocks(
        &self,
        y: &DVector<f64>,
        trial: &TrialMotion,
        modes: &[Mode],
    ) -> Result<Vec<(usize, f64)>, Error> {
        let after = std::iter::zip(modes, trial.map.end_modes()).enumerate();
        let begins =
            after.filter(|(_, (start, end))| **end == Mode::Stick && **start != Mode::Stick);
        let mut sticking = begins.map(|(c, _)| c).peekable();
        if sticking.peek().is_none() {
            return Ok(Vec::new());
        }
        let end = vector(&trial.map.end, self.order);
        self.with(y, |form, _| {
            let places = sticking.flat_map(|c| form.model.memory(c));
            let places = places.map(|j| 2 * form.len() + j);
            let reset = places.filter(|&place| self.weights[place] == 0.0);
            Ok(reset.map(|place| (place, end[place])).collect())
        })
    }

    /// The point of the curve on a plane, near a guess, by Newton's method.
    pub(super) fn solve(
        &self,
        guess: &DVector<f64>,
        near: &Solved,
        plane: &Plane<'_>,
    ) -> Result<Solved, Error> {
        let (mut y, mut modes) = (guess.clone(), near.modes.clone());
        // With the modes at the end of the motion to which it belongs.
        let mut slope: Option<(Vec<Mode>, DVector<f64>)> = None;
        let mut before = f64::INFINITY;
        let mut steps = 0;
        loop {
            let mut trial = self.trial(&y, &modes)?;
            let clocks = self.stopped_clocks(&y, &trial, &modes)?;
            if !clocks.is_empty() {
                for (place, value) in clocks {
                    y[place] = value;
                }
                modes = trial.map.end_modes().to_vec();
                trial = self.trial(&y, &modes)?;
            }
            y.rows_mut(0, self.order)
                .copy_from(&vector(&trial.map.start, self.order));
            let growth = trial.map.growth();
            let end_modes = trial.map.end_modes();
            let is_fine = before < COARSE / (growth * growth);
            let (_, slope) = match &mut slope {
                Some(slope) if is_fine && slope.0 == *end_modes => slope,
                slope => {
                    let by_parameter = self.by_parameter(&y, &trial, &modes);
                    slope.insert((end_modes.to_vec(), by_parameter))
                }
            };
            let (mut matrix, mut right) = self.linearised(&y, &trial, slope, plane.scale);
            let last = self.unknowns() - 1;
            matrix.row_mut(last).copy_from(&plane.normal.transpose());
            right[last] = plane.missed_by(&y);
            let Some(change) = solution(&matrix, &right) else {
                return Err(self.lost(&y, &trial));
            };
            let size = self.largest(&change, plane.scale, &trial);
            let closed = trial.residual <= CLOSED * growth && size <= CLOSED.sqrt();
            let is_last = steps > 0 && size <= (10.0 * FINE).min(FAST * before);
            let is_rounding = is_last || size >= 0.5 * before;
            if size <= FINE || (closed && is_rounding) {
                let slope = slope.clone();
                return self.solved((y, trial, slope), (modes, steps), matrix, plane);
            }
            steps += 1;
            let falls = steps <= 2 || size <= 2.0 * before;
            let is_near = size.is_finite() && self.measured(&change).amax() <= 1.0;
            if !(is_near && falls && steps < MOST_STEPS) {
                return Err(self.lost(&y, &trial));
            }
            before = size;
            modes = trial.map.end_modes().to_vec();
            y += change.component_mul(plane.scale);
        }
    }

    /// A guess brought nearer to the point of the curve on a plane, by Newton steps with the
    /// derivatives of a motion nearby: a step costs one motion, and a monodromy matrix as much as
    /// several. `None` if they do not converge.
    pub(super) fn nearer(
        &self,
        mut y: DVector<f64>,
        near: &Solved,
        plane: &Plane<'_>,
    ) -> Option<DVector<f64>> {
        let (map, last) = (&near.trial.map, self.unknowns() - 1);
        let (mut matrix, _) = self.linearised(&y, &near.trial, near.slope.as_ref()?, plane.scale);
        matrix.row_mut(last).copy_from(&plane.normal.transpose());
        let mut before = NEARBY;
        for _ in 0..MOST_STEPS {
            let residual = self.residual(&y, near).ok()?;
            let mut right = map.closing_by(&residual, last + 1);
            self.turn_in(&mut right, &y, plane.scale);
            right[last] = plane.missed_by(&y);
            let change = solution(&matrix, &right)?;
            let size = self.largest(&change, plane.scale, &near.trial);
            if size.is_nan() || size > before {
                return (size <= CONVERGED).then_some(y);
            }
            y += change.component_mul(plane.scale);
            before = CONVERGING * size;
        }
        Some(y)
    }

    /// End minus start of the motion from a start near that of another motion.
    fn residual(&self, y: &DVector<f64>, near: &Solved) -> Result<DVector<f64>, Error> {
        self.tried.set(self.tried.get() + 1);
        self.with(y, |form, period| {
            let (end, _) = passage(form, &self.start(form, y, &near.modes), period)?;
            let mut start = state(&y.rows(0, self.order).into_owned(), self.n);
            self.anchor(&mut start);
            Ok(near.trial.map.residual_near(&start, &end))
        })
    }

    /// The largest part of a Newton step: each number in units of its scale, or of its size in the
    /// motion if that is smaller.
    fn largest(&self, change: &DVector<f64>, scale: &DVector<f64>, trial: &TrialMotion) -> f64 {
        let sizes = trial.map.sizes();
        let larger = |i: usize| {
            sizes
                .get(i)
                .map_or(1.0, |size| f64::max(1.0, scale[i] / size))
        };
        let parts = change.iter().enumerate();
        parts.fold(0.0, |most: f64, (i, x)| match x.abs() * larger(i) {
            part if part.is_nan() => part,
            part => most.max(part),
        })
    }

    /// The error if no motion was found near here.
    pub(super) fn lost(&self, y: &DVector<f64>, trial: &TrialMotion) -> Error {
        let error = Error::NotPeriodic {
            residual: trial.residual,
            period: trial.period,
            start: trial.map.start.clone(),
        };
        error.at("parameter", self.parameter(y))
    }

    fn solved(
        &self,
        (y, trial, slope): (DVector<f64>, TrialMotion, DVector<f64>),
        (modes, steps): (Vec<Mode>, usize),
        mut matrix: DMatrix<f64>,
        plane: &Plane<'_>,
    ) -> Result<Solved, Error> {
        let last = self.unknowns() - 1;
        let along = self.measured(plane.along);
        matrix.row_mut(last).copy_from(&along.transpose());
        let mut right = DVector::zeros(self.unknowns());
        right[last] = 1.0;
        let is_free = self.turning.is_some();
        let apart = self.apart(&y, &trial)?;
        let begun = apart.as_ref().unwrap_or(&trial.map);
        if !begun.is_nearly_closed() || (is_free && !trial.returns(None)) {
            return Err(self.lost(&y, &trial));
        }
        let sequence = Sequence::of(begun, trial.period);
        let found = (
            solution(&matrix, &right).filter(|tangent| self.measured(tangent).norm() > 0.0),
            begun.multipliers(is_free),
        );
        let (Some(tangent), Some(multipliers)) = found else {
            return Err(self.lost(&y, &trial));
        };
        Ok(Solved {
            sequence,
            y,
            trial,
            multipliers,
            tangent: self.unit(&tangent),
            slope: Some(slope),
            steps,
            modes,
        })
    }

    /// The motion of a trial with a start away from events, if its start lies near one.
    fn apart(&self, y: &DVector<f64>, trial: &TrialMotion) -> Result<Option<PeriodMap>, Error> {
        self.with(y, |form, _| {
            map::begun_apart(form, &trial.map, trial.period)
        })
    }

    /// The first point, as a guess for `solve`: the tangent is not known yet.
    pub(super) fn guess(
        &self,
        start: &State,
        period: f64,
        parameter: f64,
    ) -> Result<Solved, Error> {
        let mut y = DVector::zeros(self.unknowns());
        y.rows_mut(0, self.order)
            .copy_from(&vector(start, self.order));
        if self.turning.is_some() {
            y[self.order] = period;
        }
        y[self.unknowns() - 1] = parameter;
        let trial = self.trial(&y, &[])?;
        let modes = trial.map.end_modes().to_vec();
        let apart = self.apart(&y, &trial)?;
        let begun = apart.as_ref().unwrap_or(&trial.map);
        Ok(Solved {
            sequence: Sequence::of(begun, trial.period),
            tangent: DVector::zeros(self.unknowns()),
            slope: None,
            multipliers: Vec::new(),
            steps: 0,
            modes,
            y,
            trial,
        })
    }

    /// The acceleration at the phase condition of an autonomous motion; 1 for a forced one.
    pub(super) fn turn(&self, solved: &Solved) -> f64 {
        let flow = &solved.trial.map.flow[0];
        let at = |turning: &Turning| turning.of_velocities(|j| flow[self.n + j]);
        self.turning.as_ref().map_or(1.0, at)
    }
}

/// A turning point of a coordinate of an autonomous motion.
pub(super) struct TurningPoint {
    /// Its acceleration in units of its largest velocity.
    pub(super) sharpness: f64,
    pub(super) turning: Turning,
    pub(super) time: f64,
    pub(super) state: State,
    /// The modes of the contacts there.
    pub(super) modes: Vec<Mode>,
}

/// The phase condition of an autonomous motion is re-anchored once the acceleration there is this
/// part of that at the sharpest turning point.
pub(super) const BLUNT: f64 = 0.3;

/// The sharpest turning point of an autonomous motion.
pub(super) fn sharpest(map: &PeriodMap) -> Option<TurningPoint> {
    let n = map.start.displacements.len();
    let mut sharpest: Option<TurningPoint> = None;
    let speeds = map.sizes();
    let turnings: Vec<Turning> = (0..n).map(|i| map.turning(i)).collect();
    for step in &map.steps {
        for (coordinate, turning) in turnings.iter().enumerate() {
            let Some(velocity) = turning.series(step) else {
                continue;
            };
            let _ = velocity.sign_changes(step.duration(), &mut |t, _| {
                let sharpness = velocity.derivative().at(t).abs() / speeds[n + coordinate];
                // The first of several equal ones, in spite of rounding.
                let most = sharpest.as_ref().map_or(0.0, |most| 1.001 * most.sharpness);
                if sharpness > most {
                    let mut state = step.state_at(t);
                    turning.impose(&mut state.velocities);
                    sharpest = Some(TurningPoint {
                        sharpness,
                        turning: turning.clone(),
                        time: step.start_time() + t,
                        modes: step.modes().to_vec(),
                        state,
                    });
                }
                ControlFlow::Continue(())
            });
        }
    }
    sharpest
}

/// Singular values below this part of the largest count as 0, as in shooting; here rows are of size
/// 1.
const SINGULAR: f64 = 1e-8;

/// The minimum-norm solution of a linear system.
pub(super) fn solution(matrix: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    least_norm_by_rows(matrix.clone(), right.clone(), SINGULAR)
}
