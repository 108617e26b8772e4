//! Perturbations of a motion on a slow manifold: contacts that are stiff in the sliding speed,
//! along one step.
//!
//! A perturbation δr of the relative velocity of such a contact decays at the rate D, so that
//! explicit series of perturbations reach over 10/D only. Once it has decayed, the series are the
//! minimal solution of their recurrence, which is found in passes as that of the motion
//! (`structure/engine/stiff_sliding_speeds.rs`): the same equations, linear.

use nalgebra::{DVector, Dyn, LU};

use super::perturbation_series::{Equations, LAST_TERM, LONG, Lanes, Rows};
use super::variational_equations::Linear;
use crate::motion::step_control::SETTLING;
use crate::structure::engine::directions::Directions;
use crate::structure::engine::model::Model;
use crate::structure::engine::slow_manifold::{CLOSE, INNER, MOST_PASSES};

/// The contacts that settle along a step.
pub(super) struct Settling<'m> {
    model: &'m Model<'m>,
    directions: Directions,
    rates: LU<f64, Dyn, Dyn>,
}

/// The rate D of a contact at the start of a step: 0 if it does not slip, or is elastic.
fn braking(model: &Model<'_>, linear: &Linear, c: usize) -> f64 {
    let friction = linear.contacts[c].friction.first();
    let friction = friction.filter(|_| !model.contacts[c].is_elastic());
    friction.map_or(0.0, |by_speed| by_speed.series[0])
}

/// The largest rate at which a contact settles at the start of a step.
pub(super) fn stiffest(model: &Model<'_>, linear: &Linear) -> f64 {
    let rates = (0..model.contacts.len()).map(|c| braking(model, linear, c));
    rates.fold(0.0, f64::max)
}

impl<'m> Settling<'m> {
    /// The contacts that settle well within a time; `None` if there are none.
    pub(super) fn within(model: &'m Model<'m>, linear: &Linear, time: f64) -> Option<Self> {
        let rate = |c: usize| braking(model, linear, c);
        let number = |c: usize| (rate(c) * time > SETTLING).then_some(-rate(c));
        let directions = Directions::new(model, &linear.holding, &number);
        if directions.contacts.is_empty() {
            return None;
        }
        let rates = directions.rates(model, &linear.holding, &rate)?;
        Some(Self {
            model,
            directions,
            rates,
        })
    }

    /// The series of perturbations that have settled, and how far they reach, at most `left`. If
    /// they have not settled, the values at the start are as before.
    pub(super) fn expand<const W: usize>(
        &self,
        equations: &Equations<'_>,
        rows: &mut Rows<W>,
        left: f64,
    ) -> Option<f64> {
        let n = self.model.len();
        let start: Vec<Lanes<W>> = rows[n..2 * n].iter().map(|row| row[0]).collect();
        let found = self.passes(equations, rows, left);
        if found.is_none() {
            for (row, start) in std::iter::zip(&mut rows[n..2 * n], start) {
                row[0] = start;
            }
        }
        found
    }

    fn passes<const W: usize>(
        &self,
        equations: &Equations<'_>,
        rows: &mut Rows<W>,
        left: f64,
    ) -> Option<f64> {
        let contacts = 0..self.directions.contacts.len();
        let mut now: Vec<[Lanes<W>; LONG]> = vec![[[0.0; W]; LONG]; contacts.len()];
        for place in contacts.clone() {
            now[place][0] = self.velocity(rows, place, 0);
        }
        let given: Vec<Lanes<W>> = now.iter().map(|series| series[0]).collect();
        let last = equations.terms() - 1;
        for pass in 0..MOST_PASSES {
            let before = now.clone();
            for k in 0..last {
                self.move_to(rows, &now, k);
                equations.expand_orders(rows, k..k + 1);
                self.correct(rows, &mut now, k)?;
                self.move_to(rows, &now, k);
                equations.expand_orders(rows, k..k + 1);
            }
            for series in &mut now {
                series[last] = [0.0; W];
            }
            self.move_to(rows, &now, last);
            let reach = equations.reach(rows, left);
            if reach.is_nan() {
                return None;
            }
            let errors = self.errors(rows, left);
            let mut is_settled = pass > 0;
            for place in contacts.clone() {
                for lane in 0..W {
                    let [now, before] =
                        [&now, &before].map(|of| move |k: usize| of[place][k][lane]);
                    let moved = (now(0) - before(0)).abs();
                    let error = CLOSE * errors[lane];
                    if pass > 0 && (now(0) - given[place][lane]).abs() > 4.0 * moved + error {
                        return None;
                    }
                    let mut power = 1.0;
                    let mut change = 0.0;
                    for k in 0..last {
                        change += (now(k) - before(k)).abs() * power;
                        power *= INNER * reach;
                    }
                    is_settled &= change <= error;
                }
            }
            if is_settled {
                return Some(reach);
            }
        }
        None
    }

    /// The errors allowed in velocities of a step of this length: those of its last terms.
    fn errors<const W: usize>(&self, rows: &Rows<W>, h: f64) -> Lanes<W> {
        let n = self.model.len();
        let mut sizes = [0.0; W];
        for i in 0..n {
            for (lane, size) in sizes.iter_mut().enumerate() {
                let (q, v) = (rows[i][0][lane].abs(), rows[n + i][0][lane].abs());
                *size = f64::max(*size, f64::max(q / h, v));
            }
        }
        sizes.map(|size| LAST_TERM * size)
    }

    /// Coefficient k of δr of a contact.
    fn velocity<const W: usize>(&self, rows: &Rows<W>, place: usize, k: usize) -> Lanes<W> {
        let contact = &self.model.contacts[self.directions.contacts[place]];
        std::array::from_fn(|lane| contact.along(|j| rows[self.model.len() + j][k][lane]))
    }

    /// Moves coefficient k of the velocities so that the contacts have these relative velocities.
    fn move_to<const W: usize>(
        &self,
        rows: &mut Rows<W>,
        velocities: &[[Lanes<W>; LONG]],
        k: usize,
    ) {
        // Twice: the first corrections have rounding errors of what they take away.
        for _ in 0..2 {
            let apart: Vec<Lanes<W>> = (0..velocities.len())
                .map(|place| {
                    let present = self.velocity(rows, place, k);
                    std::array::from_fn(|lane| velocities[place][k][lane] - present[lane])
                })
                .collect();
            for (place, apart) in apart.iter().enumerate() {
                let column = self.directions.column(place);
                for (row, part) in std::iter::zip(&mut rows[self.model.len()..], column) {
                    if *part != 0.0 {
                        for (x, apart) in std::iter::zip(&mut row[k], apart) {
                            *x += part * apart;
                        }
                    }
                }
            }
        }
    }

    /// Corrects order k of the relative velocities by the residuals of their balance.
    fn correct<const W: usize>(
        &self,
        rows: &Rows<W>,
        now: &mut [[Lanes<W>; LONG]],
        k: usize,
    ) -> Option<()> {
        let order = (k + 1) as f64;
        let next: Vec<Lanes<W>> = (0..now.len())
            .map(|place| self.velocity(rows, place, k + 1))
            .collect();
        for lane in 0..W {
            let residual = |place: usize| order * (next[place][lane] - now[place][k + 1][lane]);
            let mut residuals = DVector::from_fn(now.len(), |place, _| residual(place));
            if !self.rates.solve_mut(&mut residuals) {
                return None;
            }
            for (series, correction) in std::iter::zip(&mut *now, &residuals) {
                series[k][lane] += correction;
            }
        }
        Some(())
    }
}
