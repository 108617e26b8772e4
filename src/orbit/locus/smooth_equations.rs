//! The equations of folds, flips and tori: the motion is closed, and scalars are 0 if a multiplier
//! is 1 or −1, or a pair is exp(±iθ).
//!
//! | curve | matrix A |
//! |---|---|
//! | fold | M − 1; for an autonomous motion [M − 1, f(T); phase condition, 0] |
//! | flip | M + 1 |
//! | pitchfork | G' + 1, of the half-period map G: a flip of it, which closes the motion in place of P |
//! | torus | M² − 2κM + 1, κ = cos θ, with two borders |
//!
//! Derivatives of A by start and period take one pair of motions for each product: D²P is
//! symmetric, so uᵀ D²P[w, ·] is uᵀ(M(x + hw) − M(x − hw))/2h.

use std::ops::Range;

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::super::event_sequence::Sequence;
use super::super::period_map::{CLOSED, vector};
use super::super::phase_condition::FrozenStart;
use super::super::prescribed_modes::{Hold, Then};
use super::super::shooting_residual::TrialMotion;
use super::super::time_integration::events_of;
use super::super::type_erased_system::GeneralForm;
use super::bordered::Bordered;
use super::change::Change;
use super::curve_of_motions::CurveOfMotions;
use super::found::{LocusKind, SpecialKind};
use super::motions::Motions;
use crate::error::Error;
use crate::numerics::trace::{Equations, Point};

/// The kind of curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Smooth {
    Fold,
    Flip,
    Torus,
}

/// Curves of folds, flips or tori.
pub(super) struct SmoothCurve<'f> {
    pub(super) motions: Motions<'f>,
    pub(super) kind: Smooth,
    pub(super) ranges: [Range<f64>; 2],
}

/// A motion with its scalars.
#[derive(Debug, Clone)]
pub(super) struct Motion {
    /// The closed map: the motion over a period, or its half-period map.
    trial: TrialMotion,
    /// The motion over a period, for a solution that is closed by the half-period map.
    whole: Option<TrialMotion>,
    pub(super) begin: FrozenStart,
    pub(super) bordered: Bordered,
    /// Events of a solution, the multipliers of the closed map, and ½ uᵀD²P[w, w].
    sequence: Option<Sequence>,
    pub(super) multipliers: Vec<Complex<f64>>,
    pub(super) quadratic: f64,
}

/// Special points at which the curve of tori ends: κ = 1 and κ = −1.
const TORUS_ENDS: [usize; 2] = [0, 1];

impl<'f> SmoothCurve<'f> {
    fn count(&self) -> usize {
        match self.kind {
            Smooth::Torus => 2,
            Smooth::Fold | Smooth::Flip => 1,
        }
    }

    fn unknowns(&self) -> usize {
        self.motions.own() + 2 + usize::from(self.kind == Smooth::Torus)
    }

    /// The cosine of the angle of the critical pair of a torus.
    pub(super) fn kappa(&self, y: &DVector<f64>) -> f64 {
        y[self.unknowns() - 1]
    }

    /// The first guess: a motion from a start near a bifurcation, with its multipliers.
    pub(super) fn begin(
        &self,
        start: &DVector<f64>,
        period: f64,
        parameters: [f64; 2],
        multipliers: &[Complex<f64>],
    ) -> Result<(DVector<f64>, Motion), Error> {
        let (motions, own) = (&self.motions, self.motions.own());
        let y = motions.at(start, period, parameters);
        let mut y = y.resize_vertically(self.unknowns(), 0.0);
        let begin = FrozenStart::at_zero();
        let trial = motions.trial(&y, &begin)?;
        if self.kind == Smooth::Torus {
            let pairs = multipliers.iter().filter(|m| m.im != 0.0);
            let off = |m: &Complex<f64>| (m.norm() - 1.0).abs();
            let nearest = pairs.min_by(|a, b| off(a).total_cmp(&off(b)));
            let nearest = nearest.ok_or_else(|| motions.lost(&y, &trial))?;
            y[own + 2] = nearest.re / nearest.norm();
        }
        let (y, begin) = motions.begun(&y, &trial, &begin)?;
        let trial = motions.closing_trial(&y, &begin)?;
        let bordered = Bordered::begin(&self.matrix(&y, &trial, &begin), self.count());
        let bordered = bordered.ok_or_else(|| motions.lost(&y, &trial))?;
        let motion = Motion {
            trial,
            whole: None,
            begin,
            bordered,
            sequence: None,
            multipliers: Vec::new(),
            quadratic: f64::NAN,
        };
        Ok((y, motion))
    }

    /// M, each number in units of its size.
    fn monodromy(&self, trial: &TrialMotion, begin: &FrozenStart) -> DMatrix<f64> {
        let sizes = begin.sizes.rows(0, self.motions.order).into_owned();
        trial.map.in_units(&sizes)
    }

    /// The matrix A in units of the sizes.
    fn matrix(&self, y: &DVector<f64>, trial: &TrialMotion, begin: &FrozenStart) -> DMatrix<f64> {
        let order = self.motions.order;
        let matrix = self.monodromy(trial, begin);
        let one = DMatrix::identity(order, order);
        match (self.kind, &begin.condition) {
            (Smooth::Fold, None) => matrix - one,
            (Smooth::Fold, Some(condition)) => {
                let mut matrix = (matrix - one).resize(order + 1, order + 1, 0.0);
                for i in 0..order {
                    matrix[(i, order)] =
                        trial.map.flow[1][i] * (begin.sizes[order] / begin.sizes[i]);
                    matrix[(order, i)] = condition.normal[i] * begin.sizes[i];
                }
                matrix
            }
            (Smooth::Flip, _) => matrix + one,
            (Smooth::Torus, _) => &matrix * &matrix - &matrix * (2.0 * self.kappa(y)) + one,
        }
    }

    /// The vectors l and a of each product lᵀ M_α a in the derivative of each scalar, in the units
    /// of the system; a with a part for the period.
    fn products(&self, y: &DVector<f64>, value: &Motion) -> Vec<Vec<[DVector<f64>; 2]>> {
        let (order, own) = (self.motions.order, self.motions.own());
        let Motion {
            bordered, begin, ..
        } = value;
        let sizes = begin.sizes.rows(0, order).into_owned();
        let lefts: Vec<_> = bordered
            .left
            .column_iter()
            .map(|u| u.into_owned())
            .collect();
        let rights: Vec<_> = bordered
            .right
            .column_iter()
            .map(|w| w.into_owned())
            .collect();
        let with_period = |w: &DVector<f64>| w.clone().resize_vertically(own, 0.0);
        let mut products = Vec::new();
        for w in &rights {
            for u in &lefts {
                products.push(match self.kind {
                    Smooth::Fold => {
                        let left = u.rows(0, order).component_div(&sizes);
                        vec![[left, w.component_mul(&begin.sizes)]]
                    }
                    Smooth::Flip => {
                        let left = u.component_div(&sizes);
                        vec![[left, with_period(&w.component_mul(&sizes))]]
                    }
                    Smooth::Torus => {
                        let matrix = self.monodromy(&value.trial, begin);
                        let further = &matrix * w;
                        let back = matrix.transpose() * u - u * (2.0 * self.kappa(y));
                        [(u.clone(), further), (back, w.clone())]
                            .map(|(l, a)| {
                                let left = l.component_div(&sizes);
                                [left, with_period(&a.component_mul(&sizes))]
                            })
                            .into()
                    }
                });
            }
        }
        products
    }

    /// lᵀ D²P[a, ·], a row over start and period.
    fn second(
        &self,
        y: &DVector<f64>,
        value: &Motion,
        [left, along]: &[DVector<f64>; 2],
    ) -> Result<DVector<f64>, Error> {
        let direction = along.clone().resize_vertically(self.unknowns(), 0.0);
        let beside = self.beside(y, &direction, value)?;
        Ok(beside.by_start.transpose() * left)
    }

    fn beside(
        &self,
        y: &DVector<f64>,
        direction: &DVector<f64>,
        value: &Motion,
    ) -> Result<super::motions::MotionDerivatives, Error> {
        let known = (&value.trial, &value.begin);
        let beside = self.motions.difference(y, direction, known);
        beside.ok_or_else(|| self.motions.lost(y, &value.trial))
    }

    /// ½ uᵀD²P[w, w].
    fn quadratic(&self, y: &DVector<f64>, value: &Motion) -> Result<f64, Error> {
        let products = self.products(y, value);
        let [product] = &products[0][..] else {
            return Ok(f64::NAN);
        };
        Ok(0.5 * self.second(y, value, product)?.dot(&product[1]))
    }
}

impl<'f> CurveOfMotions<'f> for SmoothCurve<'f> {
    fn motions(&self) -> &Motions<'f> {
        &self.motions
    }

    fn motion(value: &Motion) -> (&TrialMotion, &FrozenStart) {
        (value.whole.as_ref().unwrap_or(&value.trial), &value.begin)
    }

    fn jumps_behind(&self, point: &Point<Motion>) -> bool {
        /// Distances behind it, in units of the scales.
        const AWAY: [f64; 4] = [1e-9, 1e-8, 1e-7, 1e-6];
        let value = &point.value;
        AWAY.iter().any(|away| {
            let y = &point.y + point.tangent.component_mul(&point.scale) * *away;
            let beyond = self.motions.closing_trial(&y, &value.begin);
            beyond.is_ok_and(|beyond| {
                events_of(&beyond.map.steps) != events_of(&value.trial.map.steps)
            })
        })
    }

    fn holding(&self, motion: &Motion, change: &Change) -> Motion {
        let mut motion = motion.clone();
        change.add_to(&mut motion.begin);
        motion
    }

    fn kind_with(
        &self,
        form: &GeneralForm<'_>,
        trial: &TrialMotion,
        change: &Change,
    ) -> Option<SpecialKind> {
        let mut holds = change.holds.iter();
        let is_bounded = |hold: &Hold| match hold.then {
            Then::Slips => true,
            Then::SlipsAfterRest => hold.may_rest(form, &trial.map.start),
            Then::Sticks => false,
        };
        match (self.kind, change.kind) {
            (Smooth::Fold, LocusKind::Grazing { .. }) if holds.all(is_bounded) => {
                Some(SpecialKind::FoldGrazing)
            }
            _ => None,
        }
    }

    fn special(&self, test: usize, point: &Point<Motion>) -> Option<SpecialKind> {
        self.special_of(test, &point.y, &point.value)
    }
}

impl Equations for SmoothCurve<'_> {
    type Value = Motion;

    fn parameters(&self) -> [usize; 2] {
        let own = self.motions.own();
        [own, own + 1]
    }

    fn ranges(&self) -> &[Range<f64>; 2] {
        &self.ranges
    }

    fn value(&self, y: &mut DVector<f64>, near: &Motion) -> Result<Motion, Error> {
        let (motions, begin) = (&self.motions, near.begin.clone());
        let trial = motions.closing_trial(y, &begin)?;
        y.rows_mut(0, motions.order)
            .copy_from(&vector(&trial.map.start, motions.order));
        let bordered = near.bordered.with(&self.matrix(y, &trial, &begin));
        let bordered = bordered.ok_or_else(|| motions.lost(y, &trial))?;
        Ok(Motion {
            trial,
            begin,
            bordered,
            ..near.clone()
        })
    }

    fn residual(&self, y: &DVector<f64>, value: &Motion) -> DVector<f64> {
        let map = &value.trial.map;
        let motion = (&vector(&map.start, self.motions.order), &map.residual());
        let closing = self.motions.residual(y, motion, &value.begin);
        let scalars = value.bordered.scalars.iter().copied();
        let numbers: Vec<f64> = closing.iter().copied().chain(scalars).collect();
        DVector::from_vec(numbers)
    }

    fn jacobian(
        &self,
        y: &DVector<f64>,
        value: &Motion,
        scale: &DVector<f64>,
    ) -> Result<DMatrix<f64>, Error> {
        let (own, unknowns) = (self.motions.own(), self.unknowns());
        let products = self.products(y, value);
        let rows = own + products.len();
        let mut jacobian = DMatrix::zeros(rows, unknowns);
        let closing = self.motions.closing(&value.trial, &value.begin, scale);
        jacobian.view_mut((0, 0), (own, own)).copy_from(&closing);
        for j in own..own + 2 {
            let mut direction = DVector::zeros(unknowns);
            direction[j] = 1.0;
            let beside = self.beside(y, &direction, value)?;
            for i in 0..self.motions.order {
                jacobian[(i, j)] = beside.residual[i] * (scale[j] / value.begin.sizes[i]);
            }
            for (k, products) in products.iter().enumerate() {
                let slopes = products.iter().map(|[l, a]| l.dot(&(&beside.by_start * a)));
                jacobian[(own + k, j)] = -slopes.sum::<f64>() * scale[j];
            }
        }
        for (k, products) in products.iter().enumerate() {
            let mut row = DVector::zeros(own);
            for product in products {
                row += self.second(y, value, product)?;
            }
            for j in 0..own {
                jacobian[(own + k, j)] = -row[j] * scale[j];
            }
        }
        if self.kind == Smooth::Torus {
            let matrix = self.monodromy(&value.trial, &value.begin);
            let slopes = value.bordered.left.transpose() * matrix * &value.bordered.right * 2.0;
            for (k, slope) in slopes.iter().enumerate() {
                jacobian[(own + k, unknowns - 1)] = slope * scale[unknowns - 1];
            }
        }
        Ok(jacobian)
    }

    fn rounding(&self, value: &Motion) -> f64 {
        CLOSED * value.trial.map.growth()
    }

    fn complete(&self, y: &DVector<f64>, mut value: Motion) -> Result<Motion, Error> {
        let motions = &self.motions;
        let is_free = value.begin.condition.is_some();
        let (map, growth) = (&value.trial.map, value.trial.map.growth());
        let mut multipliers = None;
        value.whole = match motions.half {
            Some(_) => {
                multipliers = Some(map.multipliers_by_start(is_free));
                Some(motions.trial(y, &value.begin)?)
            }
            None => None,
        };
        let trial = value.whole.as_ref().unwrap_or(&value.trial);
        // A motion closed by the half-period map is also closed over the period, if the centre is
        // right.
        let closes = trial.residual <= CLOSED * (1.0 + growth).powi(2);
        if !closes || (is_free && !trial.returns(None)) {
            return Err(motions.lost(y, trial));
        }
        let multipliers = multipliers.unwrap_or_else(|| trial.map.multipliers(is_free));
        let multipliers = multipliers.ok_or_else(|| motions.lost(y, trial))?;
        value.sequence = Some(Motions::sequence(trial));
        let trial = trial.clone();
        value.multipliers = multipliers;
        value.quadratic = match self.kind {
            Smooth::Fold => self.quadratic(y, &value)?,
            Smooth::Flip | Smooth::Torus => f64::NAN,
        };
        let renewed = value.bordered.renewed();
        let bordered = renewed.ok_or_else(|| motions.lost(y, &value.trial))?;
        let old = value.begin.sizes.clone();
        let start = y.rows(0, motions.order).into_owned();
        value.begin.settle(start, &trial)?;
        value.bordered = bordered.rescaled(&old.component_div(&value.begin.sizes));
        Ok(value)
    }

    fn scale(&self, y: &DVector<f64>, value: &Motion) -> DVector<f64> {
        let own = self.motions.own();
        DVector::from_fn(y.len(), |i, _| match i.checked_sub(own) {
            None => value.begin.sizes[i],
            Some(which @ (0 | 1)) => self.motions.widths[which],
            Some(_) => 1.0,
        })
    }

    fn is_like(&self, a: &Motion, b: &Motion) -> bool {
        match (&a.sequence, &b.sequence) {
            (Some(a), Some(b)) => a.is_like(b),
            _ => true,
        }
    }

    fn moved(&self, point: &Point<Motion>) -> Option<(DVector<f64>, Motion)> {
        let value = &point.value;
        let (trial, begin) = Self::motion(value);
        let (y, begin) = self.motions.moved(&point.y, trial, begin)?;
        let trial = self.motions.closing_trial(&y, &begin).ok()?;
        let bordered = Bordered::begin(&self.matrix(&y, &trial, &begin), self.count())?;
        let value = Motion {
            trial,
            begin,
            bordered,
            ..value.clone()
        };
        Some((y, value))
    }

    fn size(&self, value: &Motion) -> Option<(usize, f64)> {
        let turning = value.begin.condition.as_ref()?.turning.as_ref()?;
        let flow = &value.trial.map.flow[0];
        let acceleration = turning.of_velocities(|j| flow[self.motions.n + j]);
        Some((turning.coordinate, acceleration))
    }

    fn tests(&self, point: &Point<Motion>) -> Vec<f64> {
        self.test_values(&point.y, &point.value)
    }

    fn ends_at(&self, test: usize) -> bool {
        self.kind == Smooth::Torus && TORUS_ENDS.contains(&test)
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

    fn found(&self, point: &Point<Motion>) {
        self.motions.found(&point.y);
    }

    fn lost(&self, y: &DVector<f64>, value: &Motion) -> Error {
        self.motions.lost(y, &value.trial)
    }
}
