//! The power series of several perturbations, computed together: each sum of the variational
//! equations is computed for all of them at once, in vector registers.

use std::ops::Range;

use nalgebra::DMatrix;

use super::coefficient::Coefficient;
use super::elements::ElementDerivatives;
use super::type_erased_system::GeneralForm;
use super::variational_equations::Linear;
use crate::motion::step_control::root_of_ratio;
use crate::scalar::{self, fused};
use crate::series::{INTEGRAL, TERMS};
use crate::structure::engine::contact_data::Entries;
use crate::structure::engine::element_data::ElementData;
use crate::structure::engine::model::Model;

/// Numbers of W perturbations.
pub(super) type Lanes<const W: usize> = [f64; W];

/// The series of one number of W perturbations.
pub(super) type Row<const W: usize> = [Lanes<W>; LONG];

/// The series of W perturbations: displacements, velocities, memory variables and first-order
/// states, then the sliding velocities of all contacts and their loads, and the positions and
/// velocities of force elements.
pub(super) type Rows<const W: usize> = [Row<W>];

/// Most coefficients: one more than the series of the motion have, which give it.
pub(super) const LONG: usize = TERMS + 1;

/// Fewest coefficients.
const SHORT: usize = 6;

/// Bound of the two terms before the last. The truncation error is about a tenth of it, because
/// steps are about a third of the radius of convergence.
///
/// The series of derivatives have the radius of convergence of the motion, but coefficients that
/// are larger by about the factor k at order k. With the bound ε that is used for motions, most
/// steps would have to be divided in two parts.
pub(super) const LAST_TERM: f64 = 64.0 * f64::EPSILON;

/// The variational equations along one step.
#[derive(Clone, Copy)]
pub(super) struct Equations<'e> {
    model: &'e Model<'e>,
    linear: &'e Linear,
    /// Length of a state vector.
    order: usize,
    /// Number of coefficients.
    terms: usize,
}

impl<'e> Equations<'e> {
    /// Takes so many coefficients, or [`LONG`] or `SHORT` if they are more or fewer.
    pub(super) fn new(form: &'e GeneralForm<'e>, linear: &'e Linear, terms: usize) -> Self {
        Self {
            model: &form.model,
            linear,
            order: form.order(),
            terms: terms.clamp(SHORT, LONG),
        }
    }

    /// Number of coefficients.
    pub(super) fn terms(&self) -> usize {
        self.terms
    }

    /// Number of rows.
    pub(super) fn rows(&self) -> usize {
        let elements = self.linear.elements.iter();
        let inputs = elements.map(|element| element.0.len());
        self.order + 2 * self.model.contacts.len() + inputs.sum::<usize>()
    }

    /// The series of perturbations whose values at time 0 are given.
    pub(super) fn expand<const W: usize>(&self, rows: &mut Rows<W>) {
        self.expand_orders(rows, 0..self.terms - 1);
    }

    /// Expands some orders: order k of the displacements and velocities gives order k + 1.
    pub(super) fn expand_orders<const W: usize>(&self, rows: &mut Rows<W>, orders: Range<usize>) {
        fused::compute(
            &(self, orders),
            &mut &mut *rows,
            #[inline(always)]
            |(equations, orders), rows| equations.expand_by::<W, true>(rows, orders),
            |(equations, orders), rows| equations.expand_by::<W, false>(rows, orders),
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
    fn expand_by<const W: usize, const FUSED: bool>(
        &self,
        rows: &mut Rows<W>,
        orders: &Range<usize>,
    ) {
        let Self { model, linear, .. } = *self;
        let (n, contacts) = (model.len(), model.contacts.len());
        let (states, derived) = rows.split_at_mut(self.order);
        let (q, rest) = states.split_at_mut(n);
        let (v, memories) = rest.split_at_mut(n);
        let (slips, derived) = derived.split_at_mut(contacts);
        let (loads, inputs) = derived.split_at_mut(contacts);
        // A constant range, so that the compiler knows which coefficients there are.
        for k in (0..LONG - 1).take(orders.end).skip(orders.start) {
            // −(k + 1) v_{k+1}
            for i in 0..n {
                let mut sum = [0.0; W];
                for (x, matrix) in [(&*q, &model.stiffness), (&*v, &model.damping)] {
                    let (diagonal, beside) = matrix.row(i);
                    add::<W, FUSED>(&mut sum, diagonal, &x[i][k]);
                    sum = sum_of::<W, FUSED>(sum, beside, x, k);
                }
                v[i][k + 1] = sum;
            }
            let (contacts, states) = memories.split_at_mut(model.state_place(0));
            if !states.is_empty() {
                self.add_states::<W, FUSED>((q, v), states, k);
            }
            loads.iter_mut().for_each(|load| load[k] = [0.0; W]);
            let mut inputs = &mut *inputs;
            for (element, derivatives) in std::iter::zip(&model.elements, &linear.elements) {
                let own;
                (own, inputs) = inputs.split_at_mut(derivatives.0.len());
                let motion = (&*q, &mut *v);
                let sum =
                    self.add_element::<W, FUSED>(motion, (states, own), element, derivatives, k);
                if let Some(c) = element.pressed {
                    add::<W, FUSED>(&mut loads[c][k], 1.0, &sum);
                }
            }
            let memories = contacts;
            let derived = std::iter::zip(&mut *slips, &mut *loads);
            let contacts = std::iter::zip(&linear.contacts, &model.contacts);
            for ((joint, contact), (slip, load)) in std::iter::zip(contacts, derived) {
                let z = &mut memories[contact.memory.clone()];
                if joint.takes_slip {
                    slip[k] = sum_of::<W, FUSED>([0.0; W], &contact.direction, v, k);
                }
                if joint.takes_load() {
                    load[k] = sum_of::<W, FUSED>(load[k], &contact.load_gradient, q, k);
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
                if joint.reacts {
                    for &(j, y) in &contact.reaction {
                        add::<W, FUSED>(&mut v[j][k + 1], y, &load[k]);
                    }
                }
                for (j, coefficients) in joint.rates.iter().enumerate() {
                    let mut sum = [0.0; W];
                    convolve_all::<W, FUSED>(&mut sum, coefficients, (slip, z), k);
                    if let Some(by_load) = joint.rates_by_load.get(j) {
                        convolve::<W, FUSED>(&mut sum, by_load, load, k);
                    }
                    z[j][k + 1] = times(&sum, INTEGRAL[k]);
                }
            }
            for &i in &linear.stuck {
                v[i][k + 1] = [0.0; W];
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

    /// Order k + 1 of first-order states, and order k of their forces.
    #[inline(always)]
    fn add_states<const W: usize, const FUSED: bool>(
        &self,
        (q, v): (&Rows<W>, &mut Rows<W>),
        states: &mut Rows<W>,
        k: usize,
    ) {
        for (number, data) in self.model.first_order.iter().enumerate() {
            for &(j, x) in &data.responses {
                add::<W, FUSED>(&mut v[j][k + 1], -x, &states[number][k]);
            }
            let mut rate = sum_of::<W, FUSED>([0.0; W], &data.displacements, q, k);
            rate = sum_of::<W, FUSED>(rate, &data.velocities, v, k);
            rate = sum_of::<W, FUSED>(rate, &data.states, states, k);
            states[number][k + 1] = times(&rate, INTEGRAL[k]);
        }
    }

    /// Adds order k of the forces of an element, or of the law of a first-order state; returns that
    /// of the last of them.
    #[inline(always)]
    fn add_element<const W: usize, const FUSED: bool>(
        &self,
        (q, v): (&Rows<W>, &mut Rows<W>),
        (states, inputs): (&mut Rows<W>, &mut Rows<W>),
        element: &ElementData<'_>,
        ElementDerivatives(derivatives): &ElementDerivatives,
        k: usize,
    ) -> Lanes<W> {
        let (positions, velocities) = inputs.split_at_mut(element.directions.len());
        let mut last = [0.0; W];
        for (i, direction) in element.directions.iter().enumerate() {
            // A law of a state has this one input.
            if let [(j, 1.0)] = direction[..]
                && let Some(state) = j.checked_sub(q.len())
            {
                (positions[i][k], velocities[i][k]) = (states[state][k], [0.0; W]);
                continue;
            }
            positions[i][k] = sum_of::<W, FUSED>([0.0; W], direction, q, k);
            velocities[i][k] = sum_of::<W, FUSED>([0.0; W], direction, v, k);
        }
        for (i, response) in element.responses.iter().enumerate() {
            let mut sum = [0.0; W];
            for (by, input) in std::iter::zip(derivatives, &*inputs) {
                convolve::<W, FUSED>(&mut sum, &by[i], input, k);
            }
            for &(j, x) in response {
                match j.checked_sub(v.len()) {
                    None => add::<W, FUSED>(&mut v[j][k + 1], x, &sum),
                    Some(state) => {
                        add::<W, FUSED>(&mut states[state][k + 1], -x * INTEGRAL[k], &sum);
                    }
                }
            }
            last = sum;
        }
        last
    }

    #[inline(always)]
    fn sum_by<const W: usize, const FUSED: bool>(&self, rows: &mut Rows<W>, time: f64) {
        for row in &mut rows[..self.order] {
            let mut sum = [0.0; W];
            for coefficient in row[..self.terms].iter().rev() {
                let mut next = *coefficient;
                add::<W, FUSED>(&mut next, time, &sum);
                sum = next;
            }
            row[0] = sum;
        }
    }

    /// The time over which the series are exact to rounding, at most `h`; NaN if they are not
    /// finite.
    pub(super) fn reach<const W: usize>(&self, rows: &Rows<W>, h: f64) -> f64 {
        fused::compute(
            &(self, h),
            &mut &*rows,
            #[inline(always)]
            |(equations, h), rows| equations.reach_by(rows, *h),
            |(equations, h), rows| equations.reach_by(rows, *h),
        )
    }

    /// The number of coefficients that suffice for the time that is left after these have reached
    /// over a part of it.
    ///
    /// Terms fall like (t/ρ)^k, with ρ the distance of the nearest singularity. It may lie ahead,
    /// and is then closer to the next part.
    pub(super) fn terms_for(&self, left: f64, part: f64) -> usize {
        let fallen = LAST_TERM.powf(1.0 / (self.terms - 2) as f64);
        let ratio = left / part * fallen / (1.0 - fallen);
        if ratio < 1.0 {
            3 + (LAST_TERM.ln() / ratio.ln()).ceil() as usize
        } else {
            LONG
        }
    }

    #[inline(always)]
    fn reach_by<const W: usize>(&self, rows: &Rows<W>, h: f64) -> f64 {
        let last = [self.terms - 2, self.terms - 3];
        let n = self.model.len();
        let units = (0..2 * n).map(|i| if i < n { 1.0 } else { h });
        let mut sizes = [0.0; W];
        for (row, unit) in std::iter::zip(&rows[..2 * n], units) {
            for lane in 0..W {
                sizes[lane] = f64::max(sizes[lane], unit * row[0][lane].abs());
            }
        }
        // The largest of the last two coefficients, in units of the sizes.
        let mut most = [[0.0; W]; 2];
        let mut finite = [0.0; W];
        for (i, row) in rows[..self.order].iter().enumerate() {
            for lane in 0..W {
                let scale = match i {
                    _ if i < n => sizes[lane],
                    _ if i < 2 * n => sizes[lane] / h,
                    _ => f64::max(row[0][lane].abs(), h * row[1][lane].abs()),
                };
                let is_given = scale >= f64::MIN_POSITIVE;
                let unit = if is_given { scale.recip() } else { 0.0 };
                finite[lane] += 0.0 * row[self.terms - 1][lane];
                for (most, k) in std::iter::zip(&mut most, last) {
                    finite[lane] += 0.0 * row[k][lane];
                    most[lane] = f64::max(most[lane], unit * row[k][lane].abs());
                }
            }
        }
        if finite.iter().any(|finite| *finite != 0.0) {
            return f64::NAN;
        }
        std::iter::zip(most, last).fold(h, |reached, (most, k)| {
            let most = most.into_iter().fold(0.0, f64::max);
            reached.min(root_of_ratio(LAST_TERM, most, k))
        })
    }
}

/// The matrix A of the equations x' = A x, if their coefficients are constant.
pub(super) fn matrix(form: &GeneralForm<'_>, linear: &Linear) -> DMatrix<f64> {
    const WIDTH: usize = 8;
    let equations = Equations {
        terms: 2,
        ..Equations::new(form, linear, SHORT)
    };
    let order = equations.order;
    let mut rows = vec![[[0.0; WIDTH]; LONG]; equations.rows()];
    let mut matrix = DMatrix::zeros(order, order);
    for first in (0..order).step_by(WIDTH) {
        for (i, row) in rows[..order].iter_mut().enumerate() {
            row[0] = std::array::from_fn(|lane| f64::from(i == first + lane));
        }
        equations.expand(&mut rows);
        for lane in 0..WIDTH.min(order - first) {
            for (i, row) in rows[..order].iter().enumerate() {
                matrix[(i, first + lane)] = row[1][lane];
            }
        }
    }
    matrix
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

/// The sum of this and coefficient k of Σ_j a_j x_j.
#[inline(always)]
fn sum_of<const W: usize, const FUSED: bool>(
    mut sum: Lanes<W>,
    entries: &Entries,
    x: &Rows<W>,
    k: usize,
) -> Lanes<W> {
    for &(j, a) in entries {
        add::<W, FUSED>(&mut sum, a, &x[j][k]);
    }
    sum
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

/// Adds coefficient k of a product. The newest terms come last, because they are known last. Four
/// sums are computed at a time, because a single sum would wait for each of its terms.
#[inline(always)]
fn convolve<const W: usize, const FUSED: bool>(
    sum: &mut Lanes<W>,
    coefficient: &Coefficient,
    row: &Row<W>,
    k: usize,
) {
    let terms = coefficient.terms.min(k + 1);
    if terms == 0 {
        return;
    }
    let (fours, others) = coefficient.series.coefficients()[..terms].as_chunks::<4>();
    let (oldest, newest) = row[k + 1 - terms..=k].as_rchunks::<4>();
    let mut sums = [[0.0; W]; 4];
    for (a, x) in std::iter::zip(others.iter().rev(), oldest) {
        add::<W, FUSED>(&mut sums[0], *a, x);
    }
    for (a, x) in std::iter::zip(fours.iter().rev(), newest) {
        add::<W, FUSED>(&mut sums[0], a[3], &x[0]);
        add::<W, FUSED>(&mut sums[1], a[2], &x[1]);
        add::<W, FUSED>(&mut sums[2], a[1], &x[2]);
        add::<W, FUSED>(&mut sums[3], a[0], &x[3]);
    }
    for lane in 0..W {
        sum[lane] += (sums[0][lane] + sums[1][lane]) + (sums[2][lane] + sums[3][lane]);
    }
}
