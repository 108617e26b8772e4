//! The tangent flow: the variational equations along a trajectory,
//!
//! ```text
//! δq' = δv,   m δv' = −K δq − C δv − ∂(Nμ)/∂v δv − ∂(Nμ)/∂z δz − μ n·δq
//! δz' = ∂z'/∂v δv + ∂z'/∂z δz
//! ```
//!
//! What an elastic contact carries, T, has δT' = k_t b·δv in stick and δT = σμ n·δq in slip; a
//! closed normal spring adds −d n·δq to the forces.
//!
//! by power series on the steps of the trajectory. A contact that sticks has δv = 0; events are in
//! `saltation.rs`. Each column of a matrix is one perturbation: n displacements, n velocities and
//! the memory variables of the contacts.

use std::borrow::Cow;

use nalgebra::{DMatrix, DVector};

use super::form::Form;
use super::hold::{HeldFlow, Hold, Touch};
use super::linear::Linear;
use crate::error::{Error, Reached};
use crate::motion::step_control::reach;
use crate::motion::{Integrator, Mode, Segment};
use crate::scalar::jet::Tape;
use crate::series::{INTEGRAL, PowerSeries, TERMS};
use crate::state::structure::State;
use crate::structure::Step;
use crate::structure::engine::factor::Holding;
use crate::structure::engine::model::Model;

/// A trajectory with perturbations of it.
#[derive(Debug)]
pub(super) struct TangentFlow<'s> {
    pub(super) form: &'s Form<'s>,
    flow: HeldFlow<'s>,
    /// The perturbations, one in each column.
    pub(super) tangents: DMatrix<f64>,
    /// For each memory variable: true if anything has depended on it so far.
    pub(super) depends: Vec<bool>,
    /// The logarithm of a factor taken out of the single perturbation, so that it does not
    /// overflow, and underflows only with everything that depends on it; `None` if no factor is
    /// taken out.
    pub(super) logarithm: Option<f64>,
    /// True if a step of positive length has been taken.
    has_begun: bool,
    pub(super) start: State,
    tape: Tape,
    work: Vec<PowerSeries>,
}

impl<'s> TangentFlow<'s> {
    /// Perturbations of a start at a time, to be carried along the trajectory from there, with
    /// contacts held.
    pub(super) fn new(
        form: &'s Form<'s>,
        settings: Integrator,
        (time, start): (f64, &State),
        holds: &[Hold],
        tangents: DMatrix<f64>,
    ) -> Result<Self, Error> {
        Ok(Self {
            form,
            flow: HeldFlow::new(form, settings, time, start, holds)?,
            work: vec![PowerSeries::ZERO; tangents.nrows()],
            tangents,
            depends: vec![false; form.model.remembered()],
            logarithm: None,
            has_begun: false,
            start: start.clone(),
            tape: Tape::new(),
        })
    }

    /// The next step, cut at a time if it is longer. The tangents are those at its start; velocity
    /// perturbations of a sticking contact are projected out.
    pub(super) fn fetch(&mut self, end: f64) -> Option<Result<Step, Error>> {
        let step = match self.flow.next()? {
            Ok(step) if step.end_time() > end => step.until(end),
            Ok(step) => step,
            error => return Some(error),
        };
        let reached = || Reached::new(step.start_time(), step.state().clone());
        if let Err(error) = self.form.count(reached) {
            return Some(Err(error));
        }
        if step.duration() > 0.0 {
            let (n, model) = (self.form.len(), &self.form.model);
            for (c, mode) in step.modes().iter().enumerate() {
                if let (Mode::Stick, Some(i)) = (mode, model.owner_of(c)) {
                    self.tangents.row_mut(n + i).fill(0.0);
                }
            }
            let holding = Holding::of(model, step.modes());
            if !holding.contacts.is_empty() {
                for mut column in self.tangents.column_iter_mut() {
                    holding.project(model, column.rows_mut(n, n).as_mut_slice());
                }
            }
        }
        Some(Ok(step))
    }

    /// Carries the tangents from the start of a step to its end, past its events. Events at the
    /// start of the trajectory belong to the step before.
    pub(super) fn carry(&mut self, step: &Step) -> Result<(), Error> {
        let mut linear = None;
        if step.duration() > 0.0 {
            if !self.has_begun {
                self.begin(step);
                self.has_begun = true;
            }
            let linear = &*linear.insert(Linear::of(&self.form.model, step, &mut self.tape));
            let of_memory = linear.joints.iter().flat_map(|joint| &joint.depends);
            for (ever, now) in self.depends.iter_mut().zip(of_memory) {
                *ever |= now;
            }
            let rows = self.tangents.nrows();
            for column in self.tangents.as_mut_slice().chunks_mut(rows) {
                if column.iter().any(|x| *x != 0.0) {
                    let logarithm = self.logarithm.as_mut();
                    advance(self.form, step, linear, column, (&mut self.work, logarithm))?;
                }
            }
            self.limit_elastic(step);
        }
        if self.has_begun {
            self.pass(step, linear.as_ref());
        }
        Ok(())
    }

    /// The touches passed so far.
    pub(super) fn touches(&self) -> &[Touch] {
        &self.flow.touches
    }

    /// Replaces the tangents, and returns the old ones.
    pub(super) fn replace(&mut self, tangents: DMatrix<f64>) -> DMatrix<f64> {
        std::mem::replace(&mut self.tangents, tangents)
    }
}

/// The rates of change of all coordinates at the start of a step.
pub(super) fn flow_of(step: &Step, n: usize) -> DVector<f64> {
    let velocities = step.state().velocities.iter().copied();
    let rates = step.series().iter().map(|series| series[1]);
    DVector::from_iterator(n + step.series().len(), velocities.chain(rates))
}

/// Carries one perturbation over a step of length h. If its own series converges over less than h,
/// as on a steady motion of any length, the step is taken in parts, each counted as a step.
fn advance(
    form: &Form<'_>,
    step: &Step,
    linear: &Linear,
    column: &mut [f64],
    (work, mut logarithm): (&mut [PowerSeries], Option<&mut f64>),
) -> Result<(), Error> {
    /// The shortest part of a step.
    const SHORTEST: f64 = 1e-9;
    let (model, h) = (&form.model, step.duration());
    let mut linear = Cow::Borrowed(linear);
    let mut left = h;
    loop {
        expand(model, &linear, column, work);
        let n = model.len();
        let part = reach_of(work, n, left);
        if part.is_nan() {
            column.fill(f64::NAN);
            return Ok(());
        }
        for (x, series) in column.iter_mut().zip(work.iter()) {
            *x = series.at(part);
        }
        if let Some(logarithm) = logarithm.as_deref_mut() {
            let size = column.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
            if size > 0.0 && !(1e-100..1e100).contains(&size) {
                column.iter_mut().for_each(|x| *x /= size);
                *logarithm += size.ln();
            }
        }
        if part >= left {
            return Ok(());
        }
        left -= part;
        let reached = || Reached::new(step.start_time() + (h - left), step.state_at(h - left));
        if part < SHORTEST * h {
            return Err(form.too_many(reached()));
        }
        form.count(reached)?;
        linear = Cow::Owned(linear.shifted(part));
    }
}

/// The time over which the series of a perturbation are exact to rounding, at most `h`.
fn reach_of(work: &[PowerSeries], n: usize, h: f64) -> f64 {
    let largest = |series: &[PowerSeries]| series.iter().fold(0.0, |m: f64, c| m.max(c[0].abs()));
    let size = largest(&work[..n]).max(h * largest(&work[n..2 * n]));
    let mut reached = h;
    for (i, series) in work.iter().enumerate() {
        const LAST: usize = TERMS - 1;
        if series[LAST] == 0.0 && series[LAST - 1] == 0.0 {
            continue;
        }
        let scale = if i < n {
            size
        } else if i < 2 * n {
            size / h
        } else {
            series[0].abs().max(h * series[1].abs())
        };
        if scale > 0.0 {
            reached = reached.min(reach(f64::EPSILON * scale, series, LAST));
        } else if !series[LAST].is_finite() {
            return f64::NAN;
        }
    }
    reached
}

/// The series of a perturbation, order by order.
fn expand(model: &Model<'_>, linear: &Linear, column: &[f64], work: &mut [PowerSeries]) {
    for (series, x) in work.iter_mut().zip(column) {
        series[0] = *x;
    }
    let n = model.len();
    let (q, rest) = work.split_at_mut(n);
    let (v, z) = rest.split_at_mut(n);
    let mut slips = vec![PowerSeries::ZERO; linear.joints.len()];
    for k in 0..TERMS - 1 {
        let rows = model.stiffness.rows().zip(model.damping.rows());
        for (i, (springs, dampers)) in rows.enumerate() {
            let mut rate = -springs.0 * q[i][k] - dampers.0 * v[i][k];
            for &(j, a) in springs.1 {
                rate -= a * q[j][k];
            }
            for &(j, a) in dampers.1 {
                rate -= a * v[j][k];
            }
            v[i][k + 1] = rate;
        }
        for (c, joint) in linear.joints.iter().enumerate() {
            let contact = &model.contacts[c];
            let z = &mut z[model.memory(c)];
            slips[c][k] = contact.along(|j| v[j][k]);
            let slip = &slips[c];
            let inputs = |row: &[PowerSeries], z: &[PowerSeries]| -> f64 {
                let inputs = std::iter::once(slip).chain(z);
                let terms = row.iter().zip(inputs);
                terms.map(|(a, x)| convolution(a, x, k)).sum()
            };
            if !joint.is_stuck {
                let friction = inputs(&joint.friction, z);
                for &(j, x) in contact.responses() {
                    v[j][k + 1] -= x * friction;
                }
            }
            if let Some((by_load, gradient)) = &joint.by_load {
                for &(l, a) in gradient {
                    let friction = a * convolution(by_load, &q[l], k);
                    for &(j, x) in contact.responses() {
                        v[j][k + 1] -= x * friction;
                    }
                }
            }
            if joint.is_closed && !contact.reaction.is_empty() {
                let load = contact.displacement_load(|l| q[l][k]);
                for &(j, y) in &contact.reaction {
                    v[j][k + 1] -= y * load;
                }
            }
            for j in 0..z.len() {
                z[j][k + 1] = inputs(&joint.rates[j], z) * INTEGRAL[k];
            }
        }
        for (i, owner) in model.owner.iter().enumerate() {
            if owner.is_some_and(|c| linear.joints[c].is_stuck) {
                v[i][k + 1] = 0.0;
            }
        }
        if !linear.holding.contacts.is_empty() {
            let along = |c: usize| model.contacts[c].along(|j| v[j][k + 1]);
            for (j, correction) in model.corrections(&linear.holding, along) {
                v[j][k + 1] -= correction;
            }
        }
        for (q, v) in q.iter_mut().zip(v.iter_mut()) {
            q[k + 1] = v[k] * INTEGRAL[k];
            v[k + 1] *= INTEGRAL[k];
        }
    }
}

/// Coefficient k of a product, in two independent sums, which the processor computes in parallel.
fn convolution(a: &PowerSeries, b: &PowerSeries, k: usize) -> f64 {
    let mut sums = [0.0; 2];
    for l in 0..=k {
        sums[l % 2] += a[l] * b[k - l];
    }
    sums[0] + sums[1]
}
