//! The tangent flow: how small changes of the start go on along a motion.
//!
//! ```text
//! δq' = δv,   m δv' = −K δq − C δv − ∂(Nμ)/∂v δv − ∂(Nμ)/∂z δz − μ n·δq
//! δz' = ∂z'/∂v δv + ∂z'/∂z δz
//! ```
//!
//! by power series on the very steps of the motion. A contact that sticks has δv = 0; events are in
//! `saltation.rs`. Each column of a matrix is one change: n displacements, n velocities, and what
//! the contacts remember.

use std::borrow::Cow;

use nalgebra::{DMatrix, DVector};

use super::linear::{Joint, joints};
use super::oscillator::Form;
use crate::error::{Error, Reached};
use crate::motion::step_control::reach;
use crate::motion::{Integrator, Mode, Segment};
use crate::scalar::jet::Tape;
use crate::series::{INTEGRAL, PowerSeries, TERMS};
use crate::state::structure::State;
use crate::structure::sparse::Sparse;
use crate::structure::{Flow, Step};

/// A motion with changes of it.
#[derive(Debug)]
pub(super) struct TangentFlow<'s> {
    pub(super) form: &'s Form<'s>,
    flow: Flow<'s>,
    /// The changes, one in each column.
    pub(super) tangents: DMatrix<f64>,
    /// Whether anything has depended on each number of the memory so far.
    pub(super) depends: Vec<bool>,
    /// If a number, what of the one change was taken out of `tangents` as a factor, so that it does
    /// not overflow, and underflows only with all that depends on it: its logarithm.
    pub(super) logarithm: Option<f64>,
    /// Whether a step of positive length has been taken.
    has_begun: bool,
    pub(super) start: State,
    tape: Tape,
    work: Vec<PowerSeries>,
}

impl<'s> TangentFlow<'s> {
    /// Changes of a start, which go on along the motion from there.
    pub(super) fn new(
        form: &'s Form<'s>,
        settings: Integrator,
        start: &State,
        tangents: DMatrix<f64>,
    ) -> Result<Self, Error> {
        Ok(Self {
            form,
            flow: Flow::new(settings, form.model.clone(), start)?,
            work: vec![PowerSeries::ZERO; tangents.nrows()],
            tangents,
            depends: vec![false; form.model.remembered()],
            logarithm: None,
            has_begun: false,
            start: start.clone(),
            tape: Tape::new(),
        })
    }

    /// The next step, cut at a time if it goes on beyond. The tangents stand at its start, without
    /// what takes a contact out of stick: such a change is gone at once.
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
            for (mode, contact) in std::iter::zip(step.modes(), &self.form.model.contacts) {
                if *mode == Mode::Stick {
                    let row = self.form.len() + contact.coordinate;
                    self.tangents.row_mut(row).fill(0.0);
                }
            }
        }
        Some(Ok(step))
    }

    /// Takes the tangents from the start of a step to its end, behind its events. Events at the
    /// start of the motion belong to what was before.
    pub(super) fn carry(&mut self, step: &Step) -> Result<(), Error> {
        if step.duration() > 0.0 {
            if !self.has_begun {
                self.begin(step);
                self.has_begun = true;
            }
            let joints = joints(self.form, step, &mut self.tape);
            let of_memory = joints.iter().flat_map(|joint| &joint.depends);
            for (ever, now) in self.depends.iter_mut().zip(of_memory) {
                *ever |= now;
            }
            let rows = self.tangents.nrows();
            for column in self.tangents.as_mut_slice().chunks_mut(rows) {
                if column.iter().any(|x| *x != 0.0) {
                    let logarithm = self.logarithm.as_mut();
                    advance(
                        self.form,
                        step,
                        &joints,
                        column,
                        (&mut self.work, logarithm),
                    )?;
                }
            }
        }
        if self.has_begun {
            self.pass(step);
        }
        Ok(())
    }

    /// Puts other tangents in the place of those there are.
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

/// Carries one change over a step of length h. Where its own series does not reach so far, as on a
/// steady motion of any length, the step is taken in parts, each counted as a step.
fn advance(
    form: &Form<'_>,
    step: &Step,
    joints: &[Joint],
    column: &mut [f64],
    (work, mut logarithm): (&mut [PowerSeries], Option<&mut f64>),
) -> Result<(), Error> {
    /// Parts of the whole below which there are too many.
    const SHORTEST: f64 = 1e-9;
    let matrices = [&form.model.stiffness, &form.model.damping];
    let h = step.duration();
    let mut joints = Cow::Borrowed(joints);
    let mut left = h;
    loop {
        expand(matrices, &joints, column, work);
        let n = matrices[0].len();
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
            return Err(Form::too_many(reached()));
        }
        form.count(reached)?;
        joints = Cow::Owned(joints.iter().map(|joint| joint.shifted(part)).collect());
    }
}

/// How far the series of a change are good to rounding, at most `h`.
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

/// The series of a change from where it stands, order by order.
fn expand(
    [stiffness, damping]: [&Sparse; 2],
    joints: &[Joint],
    column: &[f64],
    work: &mut [PowerSeries],
) {
    for (series, x) in work.iter_mut().zip(column) {
        series[0] = *x;
    }
    let n = stiffness.len();
    let (q, rest) = work.split_at_mut(n);
    let (v, z) = rest.split_at_mut(n);
    for k in 0..TERMS - 1 {
        for (i, (springs, dampers)) in stiffness.rows().zip(damping.rows()).enumerate() {
            let mut rate = -springs.0 * q[i][k] - dampers.0 * v[i][k];
            for &(j, a) in springs.1 {
                rate -= a * q[j][k];
            }
            for &(j, a) in dampers.1 {
                rate -= a * v[j][k];
            }
            v[i][k + 1] = rate;
        }
        let mut first = 0;
        for joint in joints {
            let i = joint.body;
            let z = &mut z[first..first + joint.rates.len()];
            first += joint.rates.len();
            let inputs = |row: &[PowerSeries], v: &PowerSeries, z: &[PowerSeries]| -> f64 {
                let inputs = std::iter::once(v).chain(z);
                let terms = row.iter().zip(inputs);
                terms.map(|(a, x)| convolution(a, x, k)).sum()
            };
            if joint.is_stuck {
                v[i][k + 1] = 0.0;
            } else {
                v[i][k + 1] -= inputs(&joint.friction, &v[i], z);
            }
            if let Some((by_load, gradient)) = &joint.by_load {
                for &(j, a) in gradient {
                    v[i][k + 1] -= a * convolution(by_load, &q[j], k);
                }
            }
            for j in 0..z.len() {
                z[j][k + 1] = inputs(&joint.rates[j], &v[i], z) * INTEGRAL[k];
            }
        }
        for (q, v) in q.iter_mut().zip(v.iter_mut()) {
            q[k + 1] = v[k] * INTEGRAL[k];
            v[k + 1] *= INTEGRAL[k];
        }
    }
}

/// Coefficient k of a product, in two sums that do not wait for each other.
fn convolution(a: &PowerSeries, b: &PowerSeries, k: usize) -> f64 {
    let mut sums = [0.0; 2];
    for l in 0..=k {
        sums[l % 2] += a[l] * b[k - l];
    }
    sums[0] + sums[1]
}
