//! Motions of a family with two parameters, over one period from a start away from events, and
//! their derivatives with respect to start, period and parameters.
//!
//! The unknowns y are the start, the period T of an autonomous motion, the two parameters, and for
//! a torus κ, the cosine of the angle of its multipliers.

use nalgebra::{DMatrix, DVector};

use super::super::event_sequence::Sequence;
use super::super::half_map::{Balance, HalfMap};
use super::super::oscillator::FamilyOfTwo;
use super::super::period::Period;
use super::super::period_map::run::held_period_map;
use super::super::period_map::{PeriodMap, vector};
use super::super::phase_condition::FrozenStart;
use super::super::shooting_residual::TrialMotion;
use super::super::time_integration::{StepsAndTouches, events_of, held_steps};
use super::super::type_erased_system::GeneralForm;
use super::super::work::Work;
use crate::error::Error;
use crate::search::Watched;
use crate::state::structure::State;

/// The motions of a family.
pub(super) struct Motions<'f> {
    pub(super) family: &'f FamilyOfTwo<'f>,
    pub(super) kind: Period,
    /// The half-period map of symmetric motions that are closed by it, and the forces that
    /// determine its centre.
    pub(super) half: Option<(HalfMap, Balance)>,
    pub(super) widths: [f64; 2],
    pub(super) n: usize,
    pub(super) order: usize,
    pub(super) work: Work<'f>,
}

/// The derivatives of a motion with respect to start and period, and its residual.
pub(super) struct MotionDerivatives {
    pub(super) by_start: DMatrix<f64>,
    pub(super) residual: DVector<f64>,
}

/// Limit of the motions tried in one direction.
const MOST_TRIALS: usize = 200_000;

/// Increments for differences, in units of the sizes: about the third root of ε, and shorter ones
/// near a change of the event sequence.
const PARTS: [f64; 5] = [6e-6, 6e-7, 6e-8, 6e-9, 6e-10];

/// Part of an increment.
const BESIDE: f64 = 0.1;

impl<'f> Motions<'f> {
    pub(super) fn new(
        family: &'f FamilyOfTwo<'f>,
        kind: Period,
        widths: [f64; 2],
        [n, order]: [usize; 2],
        (most, watched): ((usize, usize), &'f Watched<'f>),
    ) -> Self {
        Self {
            family,
            kind,
            half: None,
            widths,
            n,
            order,
            work: Work::new(MOST_TRIALS, most, watched),
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

    /// Records that a point of a curve was found.
    pub(super) fn found(&self, y: &DVector<f64>) {
        let [first, second] = self.parameters(y);
        self.work.watched.at_pair(first, second);
        self.work.watched.found(first);
    }

    /// The result of a function of the system with these parameters.
    pub(super) fn with<T>(
        &self,
        [first, second]: [f64; 2],
        take: impl FnOnce(&GeneralForm<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        self.with_form([first, second], |form| {
            self.work.watched.at_pair(first, second);
            self.work.with(form, take)
        })
    }

    /// Gives the form of a system to a function, not watched and not counted: a search that is
    /// stopped keeps its results.
    pub(super) fn with_form<T>(
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
        find().map_err(|error: Error| error.at_pair([first, second]))
    }

    /// The time of the start in y, the start in its modes, and the period.
    fn start(
        &self,
        form: &GeneralForm<'_>,
        y: &DVector<f64>,
        begin: &FrozenStart,
    ) -> Result<(f64, State, f64), Error> {
        let kind = self.kind.with_period(y[self.order]);
        let period = kind.duration(form.rhythm())?;
        let (time, start) = begin.of(form, y, period);
        Ok((time, start, period))
    }

    /// A start of the motion away from its events: y there, and what stays.
    pub(super) fn begun(
        &self,
        y: &DVector<f64>,
        trial: &TrialMotion,
        old: &FrozenStart,
    ) -> Result<(DVector<f64>, FrozenStart), Error> {
        let begun = FrozenStart::away(&trial.map, trial.period, old, self.is_free())?;
        self.settled(y, begun)
    }

    /// Another start, if this one has become unsuitable.
    pub(super) fn moved(
        &self,
        y: &DVector<f64>,
        trial: &TrialMotion,
        begin: &FrozenStart,
    ) -> Option<(DVector<f64>, FrozenStart)> {
        let moved = begin.moved(&trial.map, trial.period)?;
        self.settled(y, moved).ok()
    }

    fn settled(
        &self,
        y: &DVector<f64>,
        (start, mut begin): (DVector<f64>, FrozenStart),
    ) -> Result<(DVector<f64>, FrozenStart), Error> {
        let mut y = y.clone();
        y.rows_mut(0, self.order).copy_from(&start);
        let trial = self.trial(&y, &begin)?;
        let start = vector(&trial.map.start, self.order);
        y.rows_mut(0, self.order).copy_from(&start);
        begin.settle(start, &trial)?;
        Ok((y, begin))
    }

    /// The motion over one period from the start in y.
    pub(super) fn trial(
        &self,
        y: &DVector<f64>,
        begin: &FrozenStart,
    ) -> Result<TrialMotion, Error> {
        self.work.count_trial();
        self.with(self.parameters(y), |form| {
            let (time, start, period) = self.start(form, y, begin)?;
            let map = held_period_map(form, (time, &start), period, &begin.holds)?;
            Ok(TrialMotion::new(map, period))
        })
    }

    /// The map whose fixed point is searched: the motion over one period, or its half-period map.
    pub(super) fn closing_trial(
        &self,
        y: &DVector<f64>,
        begin: &FrozenStart,
    ) -> Result<TrialMotion, Error> {
        let Some((half_map, balance)) = &self.half else {
            return self.trial(y, begin);
        };
        self.work.count_trial();
        self.with(self.parameters(y), |form| {
            let (time, start, period) = self.start(form, y, begin)?;
            let half = held_period_map(form, (time, &start), 0.5 * period, &begin.holds)?;
            let here = half_map.moved(balance, &Balance::of(form, period));
            let image = here.unwrap_or_else(|| half_map.clone()).applied(half);
            Ok(TrialMotion::new(image, period))
        })
    }

    /// Sets the half-period map that closes symmetric motions, from the symmetric motion `trial`.
    pub(super) fn close_by_half(
        &mut self,
        y: &DVector<f64>,
        trial: &TrialMotion,
    ) -> Result<(), Error> {
        let (map, period) = (&trial.map, trial.period);
        let half = HalfMap::of_symmetric(map, period);
        let balance = self.with(self.parameters(y), |form| Ok(Balance::of(form, period)))?;
        let half = half.ok_or_else(|| self.lost(y, trial))?;
        self.half = Some((half, balance));
        Ok(())
    }

    /// The result of `take` for the motion over one period, without derivatives. `take` gets the
    /// start, the steps and the period.
    pub(super) fn steps<T>(
        &self,
        y: &DVector<f64>,
        begin: &FrozenStart,
        take: impl FnOnce(&GeneralForm<'_>, State, StepsAndTouches, f64) -> Result<T, Error>,
    ) -> Result<T, Error> {
        self.work.count_trial();
        self.with(self.parameters(y), |form| {
            let (time, start, period) = self.start(form, y, begin)?;
            let steps = held_steps(form, (time, &start), period, &begin.holds)?;
            take(form, start, steps, period)
        })
    }

    /// The derivatives of the end with respect to start and period.
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
        (trial, begin): (&TrialMotion, &FrozenStart),
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
        let events = events_of(&trial.map.steps);
        let beside = |step: f64| {
            let y = y + direction * step;
            let map = self.closing_trial(&y, begin).ok()?.map;
            (events_of(&map.steps) == events).then(|| MotionDerivatives {
                by_start: self.by_start(&map),
                residual: self.residual_of_y(&y, &vector(&map.start, self.order), &map.residual()),
            })
        };
        let here = || MotionDerivatives {
            by_start: self.by_start(&trial.map),
            residual: trial.map.residual(),
        };
        let steps = PARTS.map(|part| part / (growth * growth) / length);
        let both = |step: f64| Some((beside(-step)?, beside(step)?, 2.0 * step));
        let central = steps.iter().find_map(|&step| {
            let pair = both(step)?;
            if step == steps[0] {
                return Some(pair);
            }
            // The derivatives change fast beside the change of events.
            both(BESIDE * step).or(Some(pair))
        });
        let pair = central.or_else(|| {
            steps.iter().rev().find_map(|&step| {
                let low = beside(-step).map(|low| (low, here(), step));
                low.or_else(|| Some((here(), beside(step)?, step)))
            })
        });
        let (below, above, width) = pair?;
        Some(MotionDerivatives {
            by_start: (above.by_start - below.by_start) / width,
            residual: (above.residual - below.residual) / width,
        })
    }

    /// The residual of the start in y, from that of the motion from `start`, on which modes have
    /// imposed velocities and forces. These change with parameters, and `start` − y is part of it.
    fn residual_of_y(
        &self,
        y: &DVector<f64>,
        start: &DVector<f64>,
        residual: &DVector<f64>,
    ) -> DVector<f64> {
        residual + start - y.rows(0, self.order)
    }

    /// The residual of a closed motion, and that of the phase condition, in units of the sizes.
    pub(super) fn residual(
        &self,
        y: &DVector<f64>,
        (start, residual): (&DVector<f64>, &DVector<f64>),
        begin: &FrozenStart,
    ) -> DVector<f64> {
        let mut residual = self.residual_of_y(y, start, residual);
        residual.component_div_assign(&begin.sizes.rows(0, self.order));
        if let Some(condition) = &begin.condition {
            let missed = condition.missed_by(&y.rows(0, self.order).into_owned());
            residual = residual.insert_row(self.order, missed);
        }
        residual
    }

    /// The derivatives of these residuals with respect to start and period.
    pub(super) fn closing(
        &self,
        trial: &TrialMotion,
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
        if let Some(condition) = &begin.condition {
            for j in 0..order {
                matrix[(order, j)] = condition.normal[j] * scale[j];
            }
        }
        matrix
    }

    /// The error if no periodic motion was found near y.
    pub(super) fn lost(&self, y: &DVector<f64>, trial: &TrialMotion) -> Error {
        trial.not_periodic().at_pair(self.parameters(y))
    }

    pub(super) fn sequence(trial: &TrialMotion) -> Sequence {
        Sequence::of(&trial.map, trial.period)
    }
}
