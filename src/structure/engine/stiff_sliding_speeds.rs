//! The slow manifold of contacts that are stiff in the sliding speed.
//!
//! A contact in slip whose friction rises steeply with the sliding speed settles at the rate D = N
//! G ∂μ/∂s + c, with its compliance G and the damping c of its relative velocity, until friction
//! balances all other forces. The motion itself may be slower by many orders of magnitude: under
//! rate-and-state friction D is N a G/s, 1e17 per second where a fault creeps at 1e-12 m/s, and the
//! motion takes years. An explicit step has a length of about 10/D. As in `slow_manifold.rs`, the
//! coefficients of the slow motion are the minimal solution of their recurrence, found in passes.
//! Here the unknown is the sliding speed s; the balance is linear in s_k for k > 0:
//!
//! ```text
//! s_k ← s_k + [σ p_k − N G μ_k − (k + 1) s_{k+1}]/D,      s_{k+1} of the pass before, s_26 = 0
//! ```
//!
//! p are the accelerations of the relative velocity by all other forces. At order 0 the same
//! equation is solved for ln s by Newton's method, because friction may follow the logarithm of s.
//! Each pass adds one more power of 1/D: at order k it multiplies the error by (k + 1)/(D·R), where
//! R is the radius of convergence.
//!
//! Contacts that share masses settle together: D is then a matrix, for the relative velocities of
//! the contacts with independent directions. Velocities of coordinates are corrected along M⁻¹b of
//! these contacts, so that contacts that stick remain at rest, and the motion across these
//! directions is integrated as usual.

use nalgebra::{DVector, Dyn, LU};

use super::contact_series::StepMode;
use super::coordinate_series::ALL;
use super::directions::{Dependent, Directions};
use super::model::Model;
use super::series::Series;
use super::state::{Phase, Situation};
use crate::series::PowerSeries;

/// Limit of Newton's passes at order 0: the speeds of two steps differ by a few decades at most.
const MOST_PASSES: usize = 40;

/// Largest change of ln s in a pass.
const LONGEST: f64 = 3.0;

/// Change of ln s after which Newton's next one is less than rounding.
const SMALL: f64 = 1e-8;

/// The contacts whose sliding speeds are on a slow manifold, in the step that is computed.
#[derive(Debug, Clone, Default)]
pub(super) struct Stiff {
    /// The contacts whose speeds determine all others.
    directions: Directions,
    /// The other contacts in slip that share coordinates, those that depend on the contacts above
    /// with their parts.
    others: Vec<(usize, Option<Dependent>)>,
    /// The speeds of the pass before.
    before: Vec<PowerSeries>,
    /// How far the balance of forces is from the speeds that are 0, to first order, in this pass
    /// and in the one before.
    missing: Vec<[f64; 2]>,
    /// The matrix D.
    rates: Option<LU<f64, Dyn, Dyn>>,
}

impl Stiff {
    /// Returns true if there is any contact.
    pub(super) fn is_active(&self) -> bool {
        !self.directions.contacts.is_empty()
    }

    /// Takes all contacts that are marked as settling, at their present speeds.
    pub(super) fn of(model: &Model<'_>, situation: &Situation, series: &Series) -> Self {
        let number = |c: usize| {
            let settling = series.contacts[c].settling;
            (settling > 0.0).then_some(-settling)
        };
        let directions = Directions::new(model, &situation.holding, &number);
        let holding = &directions.holding;
        let mut others = Vec::new();
        if !holding.contacts.is_empty() {
            let slips = |c: usize| matches!(situation.contacts[c].phase, Phase::Slip { .. });
            let slipping = model.shared.iter().copied().filter(|&c| slips(c));
            let left = slipping.filter(|c| !holding.contacts.contains(c));
            others.extend(left.map(|c| (c, Dependent::on(model, holding, c))));
        }
        let speed = |&c: &usize| PowerSeries::of(situation.contacts[c].speed());
        Self {
            before: directions.contacts.iter().map(speed).collect(),
            missing: vec![[0.0; 2]; directions.contacts.len()],
            directions,
            others,
            rates: None,
        }
    }

    /// True for each coordinate that they leave no motion of its own.
    pub(super) fn slaved(&self, model: &Model<'_>) -> Vec<bool> {
        let mut slaved = vec![false; model.len()];
        for &c in &self.directions.contacts {
            if let Some(i) = model.owner_of(c) {
                slaved[i] = true;
            }
        }
        if !self.directions.holding.contacts.is_empty() {
            for &i in &model.shared_coordinates {
                let unit = |j: usize| if j == i { 1.0 } else { 0.0 };
                let mut rest: Vec<f64> = (0..model.len()).map(unit).collect();
                let apart = |c: usize| model.contacts[c].along(unit);
                for (j, correction) in model.corrections(&self.directions.holding, &apart) {
                    rest[j] -= correction;
                }
                slaved[i] = rest.iter().all(|rest| rest.abs() < f64::EPSILON.sqrt());
            }
        }
        slaved
    }

    /// Order k of all series. `evaluate` computes it from the speeds and velocities of order k, and
    /// the next order of these as by an explicit step. Returns false if there is no balance.
    pub(super) fn order(
        &mut self,
        model: &Model<'_>,
        situation: &Situation,
        series: &mut Series,
        k: usize,
        evaluate: &mut dyn FnMut(&mut Series),
    ) -> bool {
        if k == 0 {
            // What the velocities differ by from the speeds is rounding, no motion of others.
            for &c in &self.directions.contacts {
                series.contacts[c].speeds[0] = situation.contacts[c].speed();
            }
            self.hold_velocities(model, series, 0);
        }
        for (&c, before) in std::iter::zip(&self.directions.contacts, &self.before) {
            series.contacts[c].speeds[k] = before[k];
        }
        self.move_velocities(model, series, k);
        evaluate(series);
        if k == 0 {
            return self.find_balance(model, situation, series, evaluate);
        }
        let Some(corrections) = self.corrections(series, k) else {
            return false;
        };
        for (&c, correction) in std::iter::zip(&self.directions.contacts, corrections) {
            let speed = &mut series.contacts[c].speeds[k];
            // Rounding errors alone would change the coefficients again and again.
            if correction.abs() > 2.0 * f64::EPSILON * speed.abs() {
                *speed += correction;
            }
        }
        self.move_velocities(model, series, k);
        evaluate(series);
        if k + 1 == ALL {
            for &c in &self.directions.contacts {
                series.contacts[c].speeds[ALL] = 0.0;
            }
            self.move_velocities(model, series, ALL);
        }
        true
    }

    /// How far the speed of a contact is from the balance of forces if it is 0, where Newton's
    /// method in ln s does not move it: in the last pass, and in the one before.
    pub(super) fn missing(&self, c: usize) -> [f64; 2] {
        let place = self.directions.contacts.iter().position(|&d| d == c);
        place.map_or([0.0; 2], |place| self.missing[place])
    }

    /// Keeps the speeds for the next pass.
    pub(super) fn end_pass(&mut self, series: &Series) {
        for (&c, before) in std::iter::zip(&self.directions.contacts, &mut self.before) {
            *before = series.contacts[c].speeds;
        }
    }

    /// Order 0: the speeds at which all forces balance, with s_1 of the pass before.
    fn find_balance(
        &mut self,
        model: &Model<'_>,
        situation: &Situation,
        series: &mut Series,
        evaluate: &mut dyn FnMut(&mut Series),
    ) -> bool {
        for [now, before] in &mut self.missing {
            *before = *now;
        }
        for _ in 0..MOST_PASSES {
            let braking = |c: usize| {
                let of = &series.contacts[c];
                match of.mode {
                    StepMode::Slip if !model.contacts[c].is_elastic() => of.load[0] * of.slope,
                    _ => 0.0,
                }
            };
            self.rates = self.directions.rates(model, &situation.holding, &braking);
            let Some(corrections) = self.corrections(series, 0) else {
                return false;
            };
            let mut largest = 0.0;
            let contacts = std::iter::zip(&self.directions.contacts, &mut self.missing);
            for ((&c, missing), &correction) in std::iter::zip(contacts, &corrections) {
                let speed = &mut series.contacts[c].speeds[0];
                // Slip changes its direction: on the manifold forces balance there.
                if *speed == 0.0 {
                    missing[0] = correction.abs();
                    continue;
                }
                let change = correction / *speed;
                if !change.is_finite() {
                    return false;
                }
                largest = f64::max(largest, change.abs());
                if change.abs() < SMALL {
                    *speed += correction;
                } else {
                    *speed *= change.clamp(-LONGEST, LONGEST).exp();
                }
            }
            self.move_velocities(model, series, 0);
            evaluate(series);
            if largest < SMALL {
                return true;
            }
        }
        false
    }

    /// D⁻¹ times the residuals of the balance of order k: Newton's corrections of the speeds.
    fn corrections(&self, series: &Series, k: usize) -> Option<Vec<f64>> {
        let order = (k + 1) as f64;
        let residual = |(&c, before): (&usize, &PowerSeries)| {
            let of = &series.contacts[c];
            of.side * (order * (of.speeds[k + 1] - before[k + 1]))
        };
        let residuals = std::iter::zip(&self.directions.contacts, &self.before).map(residual);
        let mut corrections = DVector::from_iterator(self.directions.contacts.len(), residuals);
        if !self.rates.as_ref()?.solve_mut(&mut corrections) {
            return None;
        }
        let sides = self
            .directions
            .contacts
            .iter()
            .map(|&c| series.contacts[c].side);
        Some(
            std::iter::zip(&corrections, sides)
                .map(|(x, side)| side * x)
                .collect(),
        )
    }

    /// Sets order k of the velocities by the speeds of these contacts.
    fn hold_velocities(&self, model: &Model<'_>, series: &mut Series, k: usize) {
        for &c in &self.directions.contacts {
            if let Some(i) = model.owner_of(c) {
                let of = &series.contacts[c];
                let velocity = of.side * of.speeds[k] + of.surface[k];
                series.coordinates[i].motion.set_velocity(k, velocity);
            }
        }
        if self.directions.holding.contacts.is_empty() {
            return;
        }
        // Twice: the corrections have rounding errors of what they take away.
        for _ in 0..2 {
            let apart = |c: usize| {
                let of = &series.contacts[c];
                along(model, series, c, k) - of.surface[k] - relative(series, c, k)
            };
            let corrections = model.corrections(&self.directions.holding, &apart);
            for (j, correction) in corrections {
                let motion = &mut series.coordinates[j].motion;
                motion.set_velocity(k, motion.velocity(k) - correction);
            }
        }
    }

    /// Sets order k of the velocities, and of the speeds of other contacts, by the speeds of these
    /// contacts.
    fn move_velocities(&self, model: &Model<'_>, series: &mut Series, k: usize) {
        let before = self.others.iter().map(|&(c, _)| along(model, series, c, k));
        let before: Vec<f64> = before.collect();
        self.hold_velocities(model, series, k);
        for ((c, dependent), before) in std::iter::zip(&self.others, before) {
            let speed = match dependent {
                Some(dependent) => {
                    let surface = |c: usize| series.contacts[c].surface[k];
                    let relative = dependent.relative(|d| relative(series, d, k), surface);
                    series.contacts[*c].side * relative
                }
                None => {
                    let of = &series.contacts[*c];
                    of.speeds[k] + of.side * (along(model, series, *c, k) - before)
                }
            };
            series.contacts[*c].speeds[k] = speed;
        }
    }
}

/// Order k of the relative velocity of a contact.
fn relative(series: &Series, c: usize, k: usize) -> f64 {
    let of = &series.contacts[c];
    match of.mode {
        StepMode::Slip => of.side * of.speeds[k],
        StepMode::Open | StepMode::Stick => 0.0,
    }
}

/// Order k of b·v.
fn along(model: &Model<'_>, series: &Series, c: usize, k: usize) -> f64 {
    model.contacts[c].along(|j| series.coordinates[j].motion.velocity(k))
}
