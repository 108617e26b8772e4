//! The power series of several perturbations, side by side: each sum of the variational equations
//! is made for all of them at once, in vector registers.

use super::form::Form;
use super::linear::{Coefficient, Linear};
use crate::motion::step_control::root_of_ratio;
use crate::scalar::{self, fused};
use crate::series::{INTEGRAL, TERMS};
use crate::structure::engine::model::{Entries, Model};

/// Numbers of W perturbations.
pub(super) type Lanes<const W: usize> = [f64; W];

/// The series of one number of W perturbations.
pub(super) type Row<const W: usize> = [Lanes<W>; TERMS];

/// The series of W perturbations: displacements, velocities and memory variables, then the sliding
/// velocities of all contacts and their loads.
pub(super) type Rows<const W: usize> = [Row<W>];

/// Bound of the last terms of a series. What is left out is about a quarter of that, because steps
/// are about a quarter of the radius of convergence.
///
/// The series of derivatives have the radius of convergence of the motion, but larger coefficients,
/// by about their order: with the bound ε most steps of a motion would be taken in two parts.
const LAST_TERM: f64 = 16.0 * f64::EPSILON;

/// The variational equations along one step.
#[derive(Clone, Copy)]
pub(super) struct Equations<'e> {
    model: &'e Model<'e>,
    linear: &'e Linear,
    /// Length of a state vector.
    order: usize,
}

impl<'e> Equations<'e> {
    pub(super) fn new(form: &'e Form<'e>, linear: &'e Linear) -> Self {
        Self {
            model: &form.model,
            linear,
            order: form.order(),
        }
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> usize {
        self.order + 2 * self.model.contacts.len()
    }

    /// The series of perturbations whose values at time 0 are given.
    pub(super) fn expand<const W: usize>(&self, rows: &mut Rows<W>) {
        fused::compute(
            self,
            &mut &mut *rows,
            #[inline(always)]
            |equations, rows| equations.expand_by::<W, true>(rows),
            |equations, rows| equations.expand_by::<W, false>(rows),
        );
    }

    /// The values at a time, in place of those at time 0.
    pub(super) fn go_to<const W: usize>(&self, rows: &mut Rows<W>, time: f64) {
        fused::compute(
            &(self, time),
            &mut &mut *rows,
            #[inline(always)]
            |(equations, time), rows| equations.sum_by::<W, true>(rows, *time),
            |(equations, time), rows| equations.sum_by::<W, false>(rows, *time),
        );
    }

    #[inline(always)]
    fn expand_by<const W: usize, const FUSED: bool>(&self, rows: &mut Rows<W>) {
        let Self { model, linear, .. } = *self;
        let (n, contacts) = (model.len(), model.contacts.len());
        let (states, derived) = rows.split_at_mut(self.order);
        let (q, rest) = states.split_at_mut(n);
        let (v, memories) = rest.split_at_mut(n);
        let (slips, loads) = derived.split_at_mut(contacts);
        for k in 0..TERMS - 1 {
            // −(k + 1) v_{k+1}
            for i in 0..n {
                let mut sum = [0.0; W];
                for (x, matrix) in [(&*q, &model.stiffness), (&*v, &model.damping)] {
                    let (diagonal, beside) = matrix.row(i);
                    add::<W, FUSED>(&mut sum, diagonal, &x[i][k]);
                    add_all::<W, FUSED>(&mut sum, beside, x, k);
                }
                v[i][k + 1] = sum;
            }
            for (c, joint) in linear.joints.iter().enumerate() {
                let contact = &model.contacts[c];
                let z = &mut memories[model.memory(c)];
                let (slip, load) = (&mut slips[c], &mut loads[c]);
                if joint.takes_slip {
                    slip[k] = [0.0; W];
                    add_all::<W, FUSED>(&mut slip[k], &contact.direction, v, k);
                }
                let is_reacting = joint.is_closed && !contact.reaction.is_empty();
                if is_reacting || joint.by_load.is_some() {
                    load[k] = [0.0; W];
                    add_all::<W, FUSED>(&mut load[k], &contact.load_gradient, q, k);
                }
                if joint.acts() {
                    let mut sum = [0.0; W];
                    convolve_all::<W, FUSED>(&mut sum, &joint.friction, (slip, z), k);
                    if let Some(by_load) = &joint.by_load {
                        convolve::<W, FUSED>(&mut sum, by_load, load, k);
                    }
                    for &(j, x) in contact.responses() {
                        add::<W, FUSED>(&mut v[j][k + 1], x, &sum);
                    }
                }
                if is_reacting {
                    for &(j, y) in &contact.reaction {
                        add::<W, FUSED>(&mut v[j][k + 1], y, &load[k]);
                    }
                }
                for (j, coefficients) in joint.rates.iter().enumerate() {
                    let mut sum = [0.0; W];
                    convolve_all::<W, FUSED>(&mut sum, coefficients, (slip, z), k);
                    z[j][k + 1] = times(&sum, INTEGRAL[k]);
                }
            }
            for (i, owner) in model.owner.iter().enumerate() {
                if owner.is_some_and(|c| linear.joints[c].is_stuck) {
                    v[i][k + 1] = [0.0; W];
                }
            }
            if !linear.holding.contacts.is_empty() {
                linear.holding.project(model, v, k + 1);
            }
            for (q, v) in std::iter::zip(&mut *q, &mut *v) {
                q[k + 1] = times(&v[k], INTEGRAL[k]);
                v[k + 1] = times(&v[k + 1], -INTEGRAL[k]);
            }
        }
    }

    #[inline(always)]
    fn sum_by<const W: usize, const FUSED: bool>(&self, rows: &mut Rows<W>, time: f64) {
        for row in &mut rows[..self.order] {
            let mut sum = row[TERMS - 1];
            for k in (0..TERMS - 1).rev() {
                let mut next = row[k];
                add::<W, FUSED>(&mut next, time, &sum);
                sum = next;
            }
            row[0] = sum;
        }
    }

    /// The time over which the series are exact to rounding, at most `h`; NaN if they are not
    /// finite.
    pub(super) fn reach<const W: usize>(&self, rows: &Rows<W>, h: f64) -> f64 {
        const LAST: [usize; 2] = [TERMS - 1, TERMS - 2];
        let n = self.model.len();
        let largest = |rows: &Rows<W>| {
            rows.iter().fold([0.0; W], |most: Lanes<W>, row| {
                std::array::from_fn(|lane| most[lane].max(row[0][lane].abs()))
            })
        };
        let (q, v) = (largest(&rows[..n]), largest(&rows[n..2 * n]));
        let sizes: Lanes<W> = std::array::from_fn(|lane| q[lane].max(h * v[lane]));
        // The largest of the last two coefficients, in units of what they may be off by.
        let mut most = [0.0_f64; 2];
        let mut finite = 0.0;
        for (i, row) in rows[..self.order].iter().enumerate() {
            let scales: Lanes<W> = match i {
                _ if i < n => sizes,
                _ if i < 2 * n => sizes.map(|size| size / h),
                _ => std::array::from_fn(|lane| row[0][lane].abs().max(h * row[1][lane].abs())),
            };
            for (most, k) in std::iter::zip(&mut most, LAST) {
                for (last, scale) in std::iter::zip(row[k], scales) {
                    finite += 0.0 * last;
                    let ratio = if scale > 0.0 { last.abs() / scale } else { 0.0 };
                    *most = most.max(ratio);
                }
            }
        }
        if finite != 0.0 {
            return f64::NAN;
        }
        std::iter::zip(most, LAST).fold(h, |reached, (most, k)| {
            reached.min(root_of_ratio(LAST_TERM, most, k))
        })
    }
}

/// Adds a·x.
#[inline(always)]
fn add<const W: usize, const FUSED: bool>(sum: &mut Lanes<W>, a: f64, x: &Lanes<W>) {
    for lane in 0..W {
        sum[lane] = if FUSED {
            fused::mul_add(a, x[lane], sum[lane])
        } else {
            scalar::mul_add(a, x[lane], sum[lane])
        };
    }
}

/// Adds coefficient k of Σ_j a_j x_j.
#[inline(always)]
fn add_all<const W: usize, const FUSED: bool>(
    sum: &mut Lanes<W>,
    entries: &Entries,
    x: &Rows<W>,
    k: usize,
) {
    let mut total = *sum;
    for &(j, a) in entries {
        add::<W, FUSED>(&mut total, a, &x[j][k]);
    }
    *sum = total;
}

#[inline(always)]
fn times<const W: usize>(x: &Lanes<W>, factor: f64) -> Lanes<W> {
    let mut product = *x;
    for x in &mut product {
        *x *= factor;
    }
    product
}

/// Adds coefficient k of the products with the sliding velocity and the memory.
#[inline(always)]
fn convolve_all<const W: usize, const FUSED: bool>(
    sum: &mut Lanes<W>,
    coefficients: &[Coefficient],
    (slip, memory): (&Row<W>, &Rows<W>),
    k: usize,
) {
    let inputs = std::iter::once(slip).chain(memory);
    for (coefficient, input) in std::iter::zip(coefficients, inputs) {
        convolve::<W, FUSED>(sum, coefficient, input, k);
    }
}

/// Adds coefficient k of a product, the newest term last, because it is known last.
#[inline(always)]
fn convolve<const W: usize, const FUSED: bool>(
    sum: &mut Lanes<W>,
    coefficient: &Coefficient,
    row: &Row<W>,
    k: usize,
) {
    let mut total = *sum;
    let terms = coefficient.terms.min(k + 1);
    let coefficients = coefficient.series.coefficients()[..terms].iter();
    for (a, x) in std::iter::zip(coefficients.rev(), &row[k + 1 - terms..=k]) {
        add::<W, FUSED>(&mut total, *a, x);
    }
    *sum = total;
}
