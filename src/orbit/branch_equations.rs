//! A branch as a curve: the equations with the parameter as one more unknown, and Newton's method
//! on a plane across the curve.
//!
//! The unknowns y are the start, the period of an autonomous motion, and the parameter.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::branch::BranchEnd;
use super::event_sequence::Sequence;
use super::hopf_point::spectrum;
use super::oscillator::{Family, FamilyMember};
use super::period::Period;
use super::period_map::run::period_map;
use super::period_map::{CLOSED, PeriodMap, vector};
use super::periodic_orbit::Closed;
use super::phase_condition::FrozenStart;
use super::shooting_residual::TrialMotion;
use super::time_integration::{Events, events_of, held_steps};
use super::type_erased_system::GeneralForm;
use super::work::Work;
use crate::error::Error;
use crate::motion::Segment;
use crate::numerics::least_norm::{LeastNorm, least_norm_by_rows, nullity};
use crate::numerics::trace::{Plane, is_in_or_near};
use crate::state::structure::State;

/// The equations of the periodic motions of a family.
pub(super) struct Curve<'f> {
    pub(super) family: &'f Family<'f>,
    pub(super) kind: Period,
    pub(super) range: Range<f64>,
    pub(super) n: usize,
    pub(super) order: usize,
    /// √(M⁻¹)_ii for each coordinate i; for each memory variable √k_t if it is the force of an
    /// elastic contact, otherwise 0. States of equal energy are in proportion to these numbers.
    pub(super) mobilities: Vec<f64>,
    pub(super) work: Work<'f>,
}

/// A point of the curve.
#[derive(Clone)]
pub(super) struct Solved {
    pub(super) y: DVector<f64>,
    pub(super) trial: TrialMotion,
    pub(super) sequence: Sequence,
    pub(super) multipliers: Vec<Complex<f64>>,
    /// The unit tangent of the curve, in units of the scales with which it was found.
    pub(super) tangent: DVector<f64>,
    /// The derivative of the residual with respect to the parameter; `None` for a guess.
    slope: Option<DVector<f64>>,
    /// Number of Newton steps.
    pub(super) steps: usize,
    pub(super) begin: FrozenStart,
}

impl Solved {
    /// Returns true if another motion has the same events in the same order, so that the curve is
    /// smooth between them.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        self.sequence.is_like(&other.sequence)
    }
}

/// The start and the end of a motion, and its events.
type Passage = (State, State, Events);

/// Limit of the motions tried in one direction.
pub(super) const MOST_TRIALS: usize = 50_000;

/// Limit of Newton steps; three or four are usual.
const MOST_STEPS: usize = 16;

/// A step larger than this part of the step before does not converge, or is rounding.
const FALLING: f64 = 0.5;

/// Steps with the derivatives of another motion that no longer fall are rounding below this size.
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
        self.order + usize::from(self.is_free()) + 1
    }

    pub(super) fn is_free(&self) -> bool {
        matches!(self.kind, Period::Free(_))
    }

    /// Refuses a family whose drives have a common period at a value of the parameter, and none
    /// beside it: no motion of a branch closes there.
    ///
    /// # Errors
    ///
    /// [`Error::NoCommonPeriod`], at the value beside.
    pub(super) fn check_common_period(&self, parameter: f64) -> Result<(), Error> {
        let Range { start, end } = self.range;
        let beside = [1.0, -1.0].map(|side| parameter + side * PARTS[0] * (end - start));
        let mut inside = beside.iter().filter(|value| (start..=end).contains(*value));
        inside.try_for_each(|&value| match (self.family)(value) {
            Ok(system) => {
                let found = self.kind.duration(system.form().rhythm());
                found
                    .map(drop)
                    .map_err(|error| error.at("parameter", value))
            }
            // The branch ends there.
            Err(_) => Ok(()),
        })
    }

    /// Sets the mobilities, for systems of a form.
    pub(super) fn weigh(&mut self, form: &GeneralForm<'_>) {
        let masses = form.model.inverse_mass.rows().map(|(own, _)| own);
        let springs = form.model.contacts.iter().flat_map(|contact| {
            let stiffness = contact.tangential_stiffness.unwrap_or(0.0);
            std::iter::repeat_n(stiffness, contact.memory.len())
        });
        let states = std::iter::repeat_n(0.0, form.model.first_order.len());
        let others = springs.chain(states);
        self.mobilities = masses.chain(others).map(f64::sqrt).collect();
    }

    /// Number of periods of the drives in one of the motion.
    pub(super) fn periods(&self) -> usize {
        match self.kind {
            Period::Driven(periods) => periods,
            Period::Free(_) => 1,
        }
    }

    /// The points of a motion with other starts: at each of them it could have this one.
    pub(super) fn seen(&self, solved: &Solved, begin: &FrozenStart) -> Vec<DVector<f64>> {
        let motion = (&solved.trial.map, solved.trial.period);
        let starts = begin.seen(motion, &solved.begin, self.periods());
        let at = |start: DVector<f64>| {
            let mut y = solved.y.clone();
            y.rows_mut(0, self.order).copy_from(&start);
            y
        };
        starts.into_iter().map(at).collect()
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

    /// A motion of the curve as a result.
    pub(super) fn closed(&self, solved: &Solved) -> Result<Closed, Error> {
        let parameter = self.parameter(&solved.y);
        let find = || {
            let system = self.member(parameter)?;
            Closed::new(&*system, &system.form(), solved.trial.clone(), self.kind)
        };
        find().map_err(|error: Error| error.at("parameter", parameter))
    }

    /// The eigenvalues of steady sliding at a value of the parameter.
    pub(super) fn spectrum(&self, parameter: f64) -> Result<Vec<Complex<f64>>, Error> {
        Ok(spectrum(&self.member(parameter)?.form())?.values)
    }

    pub(super) fn trial(
        &self,
        y: &DVector<f64>,
        begin: &FrozenStart,
    ) -> Result<TrialMotion, Error> {
        let (map, period) = self.motion(y, begin, 1.0)?;
        Ok(TrialMotion::new(map, period))
    }

    /// The result of a function of the system with the parameter of y and of the period.
    pub(super) fn with<T>(
        &self,
        y: &DVector<f64>,
        take: impl FnOnce(&GeneralForm<'_>, f64) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let find = || {
            let member = self.member(self.parameter(y))?;
            self.work.watched.at(self.parameter(y));
            self.work.with(member.form(), |form| {
                let kind = self.kind.with_period(y[self.order]);
                take(form, kind.duration(form.rhythm())?)
            })
        };
        find().map_err(|error: Error| error.at("parameter", self.parameter(y)))
    }

    /// The end of a branch at a limit of work, after its last motion.
    pub(super) fn end_at_limit(&self, last: &Solved) -> BranchEnd {
        let parameter = self.parameter(&last.y);
        if self.work.watched.is_stopped() {
            BranchEnd::Stopped { parameter }
        } else {
            BranchEnd::Work
        }
    }

    /// The motion over a number of its periods, and the period.
    pub(super) fn motion(
        &self,
        y: &DVector<f64>,
        begin: &FrozenStart,
        periods: f64,
    ) -> Result<(PeriodMap, f64), Error> {
        self.work.count_trial();
        self.with(y, |form, period| {
            let (time, start) = begin.of(form, y, period);
            let map = period_map(form, time, &start, periods * period)?;
            Ok((map, period))
        })
    }

    /// The end of a motion over one period, and its events.
    fn passage(&self, y: &DVector<f64>, begin: &FrozenStart) -> Result<Passage, Error> {
        self.with(y, |form, period| {
            let (time, start) = begin.of(form, y, period);
            let (steps, _) = held_steps(form, (time, &start), period, &[])?;
            let end = steps.last().map(Segment::end_state).unwrap_or_default();
            Ok((start, end, events_of(&steps)))
        })
    }

    /// The derivative of the residual by the parameter, by differences between motions with the
    /// same events: central, or one-sided if one side has no such motion.
    pub(super) fn by_parameter(
        &self,
        y: &DVector<f64>,
        trial: &TrialMotion,
        begin: &FrozenStart,
    ) -> DVector<f64> {
        let last = self.unknowns() - 1;
        let events = events_of(&trial.map.steps);
        let miss = |change: f64| {
            let mut beside = y.clone();
            beside[last] += change;
            let (_, end, passed) = self.passage(&beside, begin).ok()?;
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
        let longer = [nonlinearity.cbrt(), nonlinearity.sqrt()];
        let longer = longer.iter().filter(|_| growth > MILD);
        let mut straightest: Option<(f64, DVector<f64>)> = None;
        for part in longer.chain([&nonlinearity]) {
            let step = PARTS[0] * self.width() / part;
            if let (Some((a, below, true)), Some((b, above, true))) = (miss(-step), miss(step))
                && a < b
            {
                let change = &above - &below;
                let bend = (below + above - &here * 2.0).norm() / change.norm();
                let slope = change / (b - a);
                if bend <= STRAIGHT {
                    return slope;
                }
                if straightest.as_ref().is_none_or(|(least, _)| bend < *least) {
                    straightest = Some((bend, slope));
                }
            }
        }
        if let Some((_, slope)) = straightest {
            return slope;
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
            if let (Some((a, below, _)), Some((b, above, _))) = pair
                && a < b
            {
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
        (trial, begin): (&TrialMotion, &FrozenStart),
        by_parameter: &DVector<f64>,
        scale: &DVector<f64>,
    ) -> (DMatrix<f64>, DVector<f64>) {
        let (map, order, unknowns) = (&trial.map, self.order, self.unknowns());
        let sizes = map.sizes();
        let (mut matrix, mut right) = map.closing(scale, unknowns);
        for i in 0..order {
            matrix[(i, unknowns - 1)] = by_parameter[i] * (scale[unknowns - 1] / sizes[i]);
        }
        if let Some(condition) = &begin.condition {
            map.close_by_period(&mut matrix, scale[order]);
            for j in 0..order {
                matrix[(order, j)] = condition.normal[j] * scale[j];
            }
            right[order] = -condition.missed_by(&y.rows(0, order).into_owned());
        }
        // Before M − 1 cancels, the terms of a row are as large as that of the 1. In a continuum a
        // row cancels to rounding: enlarged to size 1 it would be an equation between errors.
        for i in 0..order {
            let mut row = matrix.row_mut(i);
            if row.amax() <= SINGULAR * (scale[i] / sizes[i]) {
                row.fill(0.0);
            }
        }
        // What is kept does not depend on the parameter either.
        for row in map.kept() {
            matrix[(row, unknowns - 1)] = 0.0;
        }
        (matrix, right)
    }

    /// The point of the curve on a plane, near a guess, by Newton's method.
    pub(super) fn solve(
        &self,
        guess: &DVector<f64>,
        near: &Solved,
        plane: &Plane<'_>,
    ) -> Result<Solved, Error> {
        self.newton(guess, f64::INFINITY, near, plane)
    }

    /// Newton's method from a guess, of which this error is expected, in units of the scales. Where
    /// rounding alone is expected, the first motion is not confirmed by a second one.
    pub(super) fn newton(
        &self,
        guess: &DVector<f64>,
        error: f64,
        near: &Solved,
        plane: &Plane<'_>,
    ) -> Result<Solved, Error> {
        let (mut y, begin) = (guess.clone(), &near.begin);
        // With the events of the motion to which it belongs.
        let mut slope: Option<(Events, DVector<f64>)> = None;
        let mut before = f64::INFINITY;
        let mut steps = 0;
        loop {
            let trial = self.trial(&y, begin)?;
            y.rows_mut(0, self.order)
                .copy_from(&vector(&trial.map.start, self.order));
            let growth = trial.map.growth();
            let events = events_of(&trial.map.steps);
            let is_fine = before < COARSE / (growth * growth);
            let (_, slope) = match &mut slope {
                Some(slope) if is_fine && slope.0 == events => slope,
                slope => {
                    let by_parameter = self.by_parameter(&y, &trial, begin);
                    slope.insert((events, by_parameter))
                }
            };
            let motion = (&trial, begin);
            let (mut matrix, mut right) = self.linearised(&y, motion, slope, plane.scale);
            let last = self.unknowns() - 1;
            matrix.row_mut(last).copy_from(&plane.normal.transpose());
            right[last] = plane.missed_by(&y);
            let Some(change) = solution(&matrix, &right) else {
                return Err(self.lost(&y, &trial));
            };
            let size = self.largest(&change, plane.scale, &trial);
            let closed = trial.residual <= CLOSED * growth && size <= CLOSED.sqrt();
            let is_expected = match steps {
                0 => error <= f64::EPSILON,
                _ => size <= FAST * before,
            };
            let is_last = is_expected && size <= 10.0 * FINE;
            let is_rounding = is_last || size >= FALLING * before;
            if size <= FINE || (closed && is_rounding) {
                let slope = slope.clone();
                return self.solved((y, trial, slope), (begin, steps), matrix, plane);
            }
            steps += 1;
            let falls = steps <= 2 || size <= 2.0 * before;
            let is_near = size.is_finite() && change.amax() <= 1.0;
            if !(is_near && falls && steps < MOST_STEPS) {
                return Err(self.lost(&y, &trial));
            }
            before = size;
            y += change.component_mul(plane.scale);
        }
    }

    /// A guess brought nearer to the point of the curve on a plane, to rounding: bifurcations are
    /// found between points as exact as Newton's. By Broyden's method from the derivatives of a
    /// motion nearby: a step costs one motion, and a monodromy matrix as much as several. `None` if
    /// the steps do not converge, or lead to other events, of which those derivatives know nothing.
    pub(super) fn nearer(
        &self,
        mut y: DVector<f64>,
        near: &Solved,
        plane: &Plane<'_>,
    ) -> Option<DVector<f64>> {
        let (map, last) = (&near.trial.map, self.unknowns() - 1);
        let motion = (&near.trial, &near.begin);
        let (mut matrix, _) = self.linearised(&y, motion, near.slope.as_ref()?, plane.scale);
        matrix.row_mut(last).copy_from(&plane.normal.transpose());
        let inverse = LeastNorm::of(matrix, SINGULAR)?;
        let events = events_of(&map.steps);
        let mut taken: Vec<DVector<f64>> = Vec::new();
        let mut before = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            self.work.count_trial();
            let (start, end, passed) = self.passage(&y, &near.begin).ok()?;
            if passed != events {
                return None;
            }
            let mut right = map.closing_by(&map.residual_near(&start, &end), last + 1);
            if let Some(condition) = &near.begin.condition {
                right[self.order] = -condition.missed_by(&y.rows(0, self.order).into_owned());
            }
            right[last] = plane.missed_by(&y);
            let mut step = inverse.solve(&right)?;
            // The inverse with all updates; each follows from two steps in succession.
            for pair in taken.windows(2) {
                step += &pair[1] * (pair[0].dot(&step) / pair[0].norm_squared());
            }
            if let Some(last) = taken.last() {
                step /= 1.0 - last.dot(&step) / last.norm_squared();
            }
            let size = self.largest(&step, plane.scale, &near.trial);
            let is_near = size.is_finite() && step.amax() <= 1.0;
            if !is_near || size > FALLING * before {
                return (before <= CONVERGED).then_some(y);
            }
            y += step.component_mul(plane.scale);
            // What remains, if steps go on to fall as this one.
            let rate = if taken.is_empty() { 1.0 } else { size / before };
            if size * rate <= f64::EPSILON {
                return Some(y);
            }
            before = size;
            taken.push(step);
        }
        None
    }

    /// The largest part of a Newton step: each number in units of its scale, or of its errors in
    /// the motion if those are smaller.
    fn largest(&self, change: &DVector<f64>, scale: &DVector<f64>, trial: &TrialMotion) -> f64 {
        let sizes = trial.map.units_of_errors();
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
        let error = trial.not_periodic();
        error.at("parameter", self.parameter(y))
    }

    fn solved(
        &self,
        (y, trial, slope): (DVector<f64>, TrialMotion, DVector<f64>),
        (begin, steps): (&FrozenStart, usize),
        mut matrix: DMatrix<f64>,
        plane: &Plane<'_>,
    ) -> Result<Solved, Error> {
        let last = self.unknowns() - 1;
        if self.is_free() && !trial.returns(None) {
            return Err(self.lost(&y, &trial));
        }
        let sequence = Sequence::of(&trial.map, trial.period);
        matrix.row_mut(last).fill(0.0);
        // In a continuum, the direction in which the parameter changes most.
        let is_curve = nullity(matrix.clone(), SINGULAR) <= 1 + trial.map.known_directions();
        let direction = |i: usize| {
            if i == last || is_curve {
                plane.along[i]
            } else {
                0.0
            }
        };
        (0..=last).for_each(|i| matrix[(last, i)] = direction(i));
        let mut right = DVector::zeros(self.unknowns());
        right[last] = 1.0;
        let tangent = solution(&matrix, &right);
        let found = (
            tangent.and_then(|tangent| tangent.try_normalize(0.0)),
            trial.map.multipliers(self.is_free()),
        );
        let (Some(tangent), Some(multipliers)) = found else {
            return Err(self.lost(&y, &trial));
        };
        Ok(Solved {
            sequence,
            y,
            trial,
            multipliers,
            tangent,
            slope: Some(slope),
            steps,
            begin: begin.clone(),
        })
    }

    /// A motion near the curve, as a guess for `solve`: its tangent is not known yet.
    pub(super) fn guess(
        &self,
        start: &DVector<f64>,
        (period, parameter): (f64, f64),
        begin: FrozenStart,
    ) -> Result<Solved, Error> {
        let mut y = DVector::zeros(self.unknowns());
        y.rows_mut(0, self.order).copy_from(start);
        if self.is_free() {
            y[self.order] = period;
        }
        y[self.unknowns() - 1] = parameter;
        self.guess_at(y, begin)
    }

    /// The same from all unknowns.
    pub(super) fn guess_at(&self, y: DVector<f64>, begin: FrozenStart) -> Result<Solved, Error> {
        let trial = self.trial(&y, &begin)?;
        Ok(Solved {
            sequence: Sequence::of(&trial.map, trial.period),
            tangent: DVector::zeros(self.unknowns()),
            slope: None,
            multipliers: Vec::new(),
            steps: 0,
            begin,
            y,
            trial,
        })
    }

    /// The speed at which an autonomous motion passes its phase condition; 1 for a forced one.
    pub(super) fn speed(solved: &Solved) -> f64 {
        let condition = solved.begin.condition.as_ref();
        condition.map_or(1.0, |condition| condition.speed(&solved.trial.map.flow[0]))
    }
}

/// Singular values below this part of the largest count as 0, as in shooting; here rows are of size
/// 1.
const SINGULAR: f64 = 1e-8;

/// The minimum-norm solution of a linear system.
pub(super) fn solution(matrix: &DMatrix<f64>, right: &DVector<f64>) -> Option<DVector<f64>> {
    least_norm_by_rows(matrix.clone(), right, SINGULAR)
}
