//! The equilibrium of steady sliding: linear equations, and Newton's method where forces are
//! nonlinear.

use nalgebra::{DMatrix, DVector};

use super::engine::contact_data::{ContactData, Entries};
use super::engine::element_data::ElementTangent;
use super::engine::model::Model;
use super::freedom::{direction_row, elastic_rows, null_space, units};
use crate::error::{Element, NotSliding};
use crate::friction::memory::Slip;

/// Accelerations, and singular values, below this part of the largest are rounding.
pub(super) const ROUNDING: f64 = 1e-12;

/// The equations of steady sliding, K q + Σ D M⁻¹a_i F_i(a·q, 0) = f, all divided by M, and z' = 0
/// of first-order states. The positions are the displacements q, then the states z.
pub(super) struct Equilibrium<'e, 'm, 's> {
    pub(super) model: &'m Model<'s>,
    /// Stiffness, with the loads of friction that follow displacements.
    pub(super) stiffness: DMatrix<f64>,
    pub(super) right: DVector<f64>,
    /// Velocities at which contacts stick; `None` for masses at rest.
    pub(super) velocities: Option<&'e [f64]>,
    pub(super) sticking: &'e [usize],
    /// The contacts whose friction is not in `stiffness` and `right`, because it is not linear in
    /// the displacements, and how they slip.
    pub(super) frictions: &'e [(usize, Slip<f64>)],
    /// True for each contact that is open.
    pub(super) open: &'e [bool],
}

/// Bound of the iterations of Newton's method.
const MOST_ITERATIONS: usize = 200;

/// The least part by which a whole step of Newton's method is shorter than the one before: near a
/// root of order p steps shrink by the factor 1 − 1/p.
const LEAST_GAIN: f64 = 1.0 / 64.0;

/// The least part of a step of Newton's method.
const LEAST_PART: f64 = 1.0 / 1024.0;

/// Number of the steps in which the load is raised if no equilibrium is found under the whole load.
const LOAD_STEPS: usize = 8;

impl Equilibrium<'_, '_, '_> {
    /// The equilibrium near these displacements and states of 0, and the force elements in it.
    pub(super) fn solve(
        &self,
        start: &[f64],
    ) -> Result<(Balance, Vec<ElementTangent>), NotSliding> {
        if self.model.elements.is_empty() && self.frictions.is_empty() {
            return Ok((self.linearised(&Tangents::default(), 1.0)?, Vec::new()));
        }
        let start = DVector::from_column_slice(start);
        let start = start.resize_vertically(self.right.len(), 0.0);
        let mut found = self.newton(start.clone(), 1.0);
        if let Err(NotSliding::NotFound { .. } | NotSliding::Singular) = found {
            found = self.raise_load(start);
        }
        let balance = found?;
        let Tangents { elements, .. } = self.tangents(&balance.positions)?;
        for (number, (element, tangent)) in
            std::iter::zip(&self.model.elements, &elements).enumerate()
        {
            let position = tangent.positions[0];
            let size = element.directions[0].iter();
            let size = size
                .map(|&(j, a)| (a * balance.positions[j]).abs())
                .sum::<f64>();
            let is_at = |b: &f64| (position - b).abs() <= 8.0 * f64::EPSILON * size.max(b.abs());
            if element.breakpoints.iter().any(is_at) {
                let data = &self.model.elements[number];
                let stop = number.checked_sub(self.model.first_stop());
                let element = match (stop, data.rate_of, data.pressed) {
                    (Some(stop), ..) => Element::Stop(stop),
                    (_, Some((state, _)), _) => Element::FirstOrder(state),
                    (.., Some(contact)) => {
                        return Err(NotSliding::LoadAtBreakpoint { contact, position });
                    }
                    _ => Element::ForceElement(number),
                };
                return Err(NotSliding::AtBreakpoint { element, position });
            }
        }
        Ok((balance, elements))
    }

    /// Raises the load step by step, each from the equilibrium before.
    fn raise_load(&self, start: DVector<f64>) -> Result<Balance, NotSliding> {
        let mut q = start;
        let mut last = Err(NotSliding::Singular);
        for step in 1..=LOAD_STEPS {
            let load = step as f64 / LOAD_STEPS as f64;
            // A force without a slope at rest, such as that of a cubic spring alone.
            let push = self.right.try_normalize(0.0).map(|push| &q + push);
            let found = match (self.newton(q, load), push) {
                (Err(NotSliding::Singular), Some(pushed)) => self.newton(pushed, load),
                (found, _) => found,
            };
            q = match &found {
                Ok(balance) => balance.positions.clone(),
                Err(NotSliding::NotFound { residual, .. }) => {
                    let load = (step - 1) as f64 / LOAD_STEPS as f64;
                    let residual = *residual;
                    return Err(NotSliding::NotFound { residual, load });
                }
                Err(_) => return found,
            };
            last = found;
        }
        last
    }

    /// Newton's method under a part of the load. A step is halved while the step after it would be
    /// longer.
    fn newton(&self, mut q: DVector<f64>, load: f64) -> Result<Balance, NotSliding> {
        let mut balance = self.linearised(&self.tangents(&q)?, load)?;
        let mut step = &balance.positions - &q;
        for _ in 0..MOST_ITERATIONS {
            let size = self.size_by(&balance.positions);
            let least = 4.0 * f64::EPSILON * size(&q).max(size(&balance.positions));
            if size(&step) <= least {
                return Ok(balance);
            }
            let mut part = 1.0;
            let (next, then) = loop {
                let next = &q + &step * part;
                let then = self.tangents(&next);
                let then = then.and_then(|tangents| self.linearised(&tangents, load));
                let shorter = |balance: &Balance| {
                    let after = size(&(&balance.positions - &next));
                    after <= (1.0 - LEAST_GAIN * part) * size(&step) || after <= least
                };
                match then {
                    Ok(then) if shorter(&then) => break (next, then),
                    _ if part <= LEAST_PART => {
                        // Rounding errors alone are left.
                        if size(&step) <= 1e-10 * size(&q) {
                            return Ok(balance);
                        }
                        return Err(self.not_found(&q, load));
                    }
                    _ => part *= 0.5,
                }
            };
            (step, q, balance) = (&then.positions - &next, next, then);
        }
        Err(self.not_found(&q, load))
    }

    /// The size of positions, with states in units that make them as large as displacements.
    fn size_by(&self, positions: &DVector<f64>) -> impl Fn(&DVector<f64>) -> f64 + use<> {
        let n = self.model.len();
        let states = positions.rows(n, positions.len() - n).amax();
        let unit = positions.rows(0, n).amax() / states;
        let unit = if unit.is_normal() { unit } else { 1.0 };
        move |x| {
            let states = x.rows(n, x.len() - n).amax();
            x.rows(0, n).amax().max(unit * states)
        }
    }

    fn not_found(&self, q: &DVector<f64>, load: f64) -> NotSliding {
        let mut left = &self.right * load - &self.stiffness * q;
        let Ok(tangents) = self.tangents(q) else {
            return NotSliding::Overflow;
        };
        for push in &tangents.pushes {
            for &(i, x) in push.responses {
                left[i] -= x * push.force;
            }
        }
        for (element, tangent) in std::iter::zip(&self.model.elements, &tangents.elements) {
            let factor = element.factor.value(0.0);
            for (response, force) in std::iter::zip(&element.responses, &tangent.forces) {
                response
                    .iter()
                    .for_each(|&(i, x)| left[i] -= x * factor * force);
            }
        }
        NotSliding::NotFound {
            residual: left.amax(),
            load: 0.0,
        }
    }

    /// The nonlinear forces at these displacements.
    fn tangents(&self, q: &DVector<f64>) -> Result<Tangents<'_>, NotSliding> {
        let at_rest = vec![0.0; q.len()];
        let elements = self.model.elements.iter();
        let elements: Vec<ElementTangent> = elements
            .map(|element| element.tangent(q.as_slice(), &at_rest))
            .collect();
        // Those of a load by its laws, and their derivatives by displacements.
        let by_laws = |contact: &ContactData<'_>| {
            let (mut load, mut slopes) = (0.0, Vec::new());
            for e in contact.load_laws.clone() {
                let (law, tangent) = (&self.model.elements[e], &elements[e]);
                let factor = law.factor.value(0.0);
                load += factor * tangent.forces[0];
                let slope = factor * tangent.slopes[0][0];
                slopes.extend(law.directions[0].iter().map(|&(j, a)| (j, slope * a)));
            }
            (load, slopes)
        };
        let mut pushes = Vec::new();
        for &(number, slip) in self.frictions {
            let contact = &self.model.contacts[number];
            let (load, mut slopes) = by_laws(contact);
            let load = load + contact.load_at(0.0, |j| q[j]);
            slopes.extend(&contact.load_gradient);
            let sliding = contact.law.sliding(slip, load);
            let by_load = sliding.and_then(|at| Some((at.coefficient, at.by_load()?)));
            let (coefficient, slope) =
                by_load.ok_or(NotSliding::NoSteadyMemory { contact: number })?;
            let slope = contact.compliance * (coefficient + load * slope);
            slopes.iter_mut().for_each(|(_, by)| *by *= slope);
            pushes.push(Push {
                responses: contact.responses(),
                force: contact.compliance * load * coefficient,
                slopes,
            });
        }
        for (contact, open) in std::iter::zip(&self.model.contacts, self.open) {
            if !open && !contact.load_laws.is_empty() && !contact.reaction.is_empty() {
                let (force, slopes) = by_laws(contact);
                pushes.push(Push {
                    responses: &contact.reaction,
                    force,
                    slopes,
                });
            }
        }
        Ok(Tangents {
            elements,
            pushes,
            displacements: q.as_slice().to_vec(),
        })
    }

    /// The equilibrium with the tangents of the nonlinear forces in their place.
    fn linearised(&self, tangents: &Tangents<'_>, load: f64) -> Result<Balance, NotSliding> {
        let (mut stiffness, mut right) = (self.stiffness.clone(), &self.right * load);
        for push in &tangents.pushes {
            let slopes = push.slopes.iter();
            let changes = slopes.map(|&(j, slope)| slope * tangents.displacements[j]);
            let force = push.force - changes.sum::<f64>();
            for &(i, x) in push.responses {
                right[i] -= x * force;
                for &(j, slope) in &push.slopes {
                    stiffness[(i, j)] += x * slope;
                }
            }
        }
        for (element, tangent) in std::iter::zip(&self.model.elements, &tangents.elements) {
            let factor = element.factor.value(0.0);
            for (k, response) in element.responses.iter().enumerate() {
                let by_positions = std::iter::zip(&tangent.slopes, &tangent.positions);
                let changes = by_positions.map(|(slopes, x)| slopes[k] * x);
                let force = factor * (tangent.forces[k] - changes.sum::<f64>());
                let slopes = std::iter::zip(&*element.directions, &tangent.slopes);
                for &(i, x) in response {
                    right[i] -= x * force;
                    for (direction, slopes) in slopes.clone() {
                        for &(j, a) in direction {
                            stiffness[(i, j)] += x * factor * slopes[k] * a;
                        }
                    }
                }
            }
        }
        if let Some(velocities) = self.velocities {
            return Balance::of(self.model, (stiffness, right), velocities, self.sticking);
        }
        Ok(Balance {
            positions: solve_with_states(stiffness, right, self.model.len())?,
            accelerations: DVector::zeros(self.model.len()),
            forces: Vec::new(),
        })
    }
}

/// The nonlinear forces at some displacements.
#[derive(Default)]
struct Tangents<'e> {
    elements: Vec<ElementTangent>,
    pushes: Vec<Push<'e>>,
    displacements: Vec<f64>,
}

/// A force that depends on displacements: the friction of a contact, or the reaction of its normal
/// spring to the laws of its load.
struct Push<'e> {
    /// The accelerations by a force of 1.
    responses: &'e Entries,
    force: f64,
    /// Derivatives of the force.
    slopes: Vec<(usize, f64)>,
}

/// Steady sliding at given velocities.
pub(super) struct Balance {
    /// Displacements, then first-order states.
    pub(super) positions: DVector<f64>,
    /// Accelerations of rigid-body motions.
    pub(super) accelerations: DVector<f64>,
    /// Forces of the contacts that stick.
    pub(super) forces: Vec<f64>,
}

impl Balance {
    /// The displacements q, the accelerations a of the rigid-body motions E and the forces λ of
    /// contacts that stick, with directions B:
    ///
    /// ```text
    /// K q + M a + B λ = f,    a = E α,    Bᵀa = 0
    /// ```
    ///
    /// with z' = 0 of the first-order states; A_v a = 0 in its place for a state whose rate depends
    /// on velocities only. q has no part along E. Where balance leaves forces undetermined, they
    /// have the least sum of squares: contacts carry nothing that springs can carry. All rows are
    /// multiplied by M⁻¹.
    fn of(
        model: &Model<'_>,
        (stiffness, right): (DMatrix<f64>, DVector<f64>),
        velocities: &[f64],
        sticking: &[usize],
    ) -> Result<Self, NotSliding> {
        let n = model.len();
        let rows = elastic_rows(model);
        let fastest = velocities.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        for row in &rows {
            // In units in which no sum overflows.
            let terms = row.iter().zip(velocities);
            let terms = terms.map(|(k, v)| (k / row.amax()) * (v / fastest));
            let [sum, size] = terms.fold([0.0, 0.0], |[sum, size], x| [sum + x, size + x.abs()]);
            // NaN for a row of zeros and for rest, which change no force.
            if f64::abs(sum) > ROUNDING * size {
                let moves = |j: &usize| row[*j] * velocities[*j] != 0.0;
                let coordinate = (0..n).find(moves).unwrap_or(0);
                return Err(NotSliding::Deforms { coordinate });
            }
        }
        let motions = null_space(model, &rows);
        if motions.is_empty() {
            return Ok(Self {
                positions: solve_with_states(stiffness, right, n)?,
                accelerations: DVector::zeros(n),
                forces: vec![0.0; sticking.len()],
            });
        }
        // In units of one energy, and each unknown in a unit that makes the entries of one size.
        let units = units(model);
        let unit = |x: &DVector<f64>| DVector::from_fn(n, |j, _| x[j] / units[j]).normalize();
        let motions: Vec<DVector<f64>> = motions.iter().map(unit).collect();
        let motions = DMatrix::from_columns(&motions);
        let along = sticking.iter().map(|&c| {
            let row = direction_row(model, c);
            DVector::from_fn(n, |j, _| row[j] * units[j])
        });
        let along: Vec<DVector<f64>> = along.collect();
        // The combinations of forces that rigid-body motions feel.
        let combined = if along.is_empty() {
            DMatrix::zeros(0, 0)
        } else {
            // A contact within what moves as a whole feels nothing but rounding.
            let felt = DMatrix::from_fn(along.len(), motions.ncols(), |c, j| {
                let felt = along[c].dot(&motions.column(j));
                if felt.abs() > ROUNDING * along[c].norm() {
                    felt
                } else {
                    0.0
                }
            });
            let svd = felt.svd(true, false);
            let least = ROUNDING * svd.singular_values.amax();
            let counts = |i: &usize| svd.singular_values[*i] > least;
            let kept: Vec<usize> = (0..svd.singular_values.len()).filter(counts).collect();
            svd.u.ok_or(NotSliding::Singular)?.select_columns(&kept)
        };
        // The unknowns: displacements, first-order states, accelerations and forces.
        let (d, r, positions) = (motions.ncols(), combined.ncols(), right.len());
        let all = positions + d + r;
        let mut matrix = DMatrix::zeros(all, all);
        let scaled = DMatrix::from_fn(n, n, |i, j| stiffness[(i, j)] * units[j] / units[i]);
        let size = Some(scaled.amax())
            .filter(|size| *size > 0.0)
            .unwrap_or(1.0);
        matrix.view_mut((0, 0), (n, n)).copy_from(&scaled);
        matrix
            .view_mut((0, positions), (n, d))
            .copy_from(&(&motions * size));
        matrix
            .view_mut((positions, 0), (d, n))
            .copy_from(&(motions.transpose() * size));
        let mut forces = DVector::from_fn(all, |i, _| match i {
            i if i < n => right[i] / units[i],
            i if i < positions => right[i],
            _ => 0.0,
        });
        for (number, state) in (n..positions).enumerate() {
            for i in 0..n {
                matrix[(i, state)] = stiffness[(i, state)] / units[i];
                matrix[(state, i)] = stiffness[(state, i)] * units[i];
            }
            let of_states = stiffness.view((state, n), (1, positions - n));
            matrix
                .view_mut((state, n), (1, positions - n))
                .copy_from(&of_states);
            if stiffness.row(state).iter().any(|x| *x != 0.0) {
                continue;
            }
            // The integral of a velocity: its rate is 0, and accelerations do not change it.
            let data = &model.first_order[number];
            let rate = std::mem::take(&mut forces[state]);
            let terms = data.velocities.iter().map(|&(j, a)| a * velocities[j]);
            let size = terms.map(f64::abs).sum::<f64>();
            if rate.abs() > ROUNDING * size {
                let state = number;
                return Err(NotSliding::Grows { state, rate });
            }
            for &(j, a) in &data.velocities {
                for c in 0..d {
                    matrix[(state, positions + c)] += a * units[j] * motions[(j, c)];
                }
            }
        }
        let mut force_units = Vec::new();
        for j in 0..r {
            let force = (0..along.len()).fold(DVector::zeros(n), |sum, c| {
                sum + &along[c] * combined[(c, j)]
            });
            let (unit, felt) = (force.norm(), motions.transpose() * &force);
            let response = inverse_mass_times(model, &units, &force);
            matrix
                .view_mut((0, positions + d + j), (n, 1))
                .copy_from(&(response * (size / unit)));
            matrix
                .view_mut((positions + d + j, positions), (1, d))
                .copy_from(&(felt.transpose() * (size / unit)));
            force_units.push(size / unit);
        }
        let found = solve_with_states(matrix, forces.clone(), n + d + r)?;
        let accelerations = &motions * found.rows(positions, d) * size;
        let largest = scaled.amax() * found.rows(0, n).amax();
        let rounding = ROUNDING * forces.rows(0, n).amax().max(largest);
        let accelerations = DVector::from_fn(n, |j, _| match accelerations[j] {
            a if a.abs() <= rounding => 0.0,
            a => a * units[j],
        });
        let carried = |c: usize| (0..r).map(move |j| (c, j));
        Ok(Self {
            positions: DVector::from_fn(positions, |j, _| match units.get(j) {
                Some(unit) => found[j] * unit,
                None => found[j],
            }),
            accelerations,
            forces: (0..along.len())
                .map(|c| {
                    let parts = carried(c);
                    let parts = parts
                        .map(|(c, j)| combined[(c, j)] * found[positions + d + j] * force_units[j]);
                    parts.sum()
                })
                .collect(),
        })
    }
}

/// M⁻¹ b in units of one energy, of a direction in these units.
pub(super) fn inverse_mass_times(
    model: &Model<'_>,
    units: &[f64],
    force: &DVector<f64>,
) -> DVector<f64> {
    DVector::from_fn(units.len(), |i, _| {
        let (own, beside) = model.inverse_mass.row(i);
        let sum = beside.iter().map(|&(j, a)| a * force[j] / units[j]);
        (own * force[i] / units[i] + sum.sum::<f64>()) / units[i]
    })
}

/// The solution of A x = b. If there are more numbers than these n, some are first-order states, of
/// any units: rows and columns are brought to one size first.
fn solve_with_states(
    mut a: DMatrix<f64>,
    mut b: DVector<f64>,
    n: usize,
) -> Result<DVector<f64>, NotSliding> {
    /// Sizes converge by square roots; two digits are enough.
    const ROUNDS: usize = 8;
    if a.nrows() == n {
        return solve(&a, &b);
    }
    let mut units = DVector::from_element(b.len(), 1.0);
    // A power of two, so that the scaling is exact.
    let root = |size: f64| {
        if size.is_normal() {
            (-0.5 * size.log2()).round().exp2()
        } else {
            1.0
        }
    };
    for _ in 0..ROUNDS {
        let rows: Vec<f64> = a.row_iter().map(|row| root(row.amax())).collect();
        let columns: Vec<f64> = a.column_iter().map(|column| root(column.amax())).collect();
        for (i, factor) in rows.into_iter().enumerate() {
            a.row_mut(i).scale_mut(factor);
            b[i] *= factor;
        }
        for (j, factor) in columns.into_iter().enumerate() {
            a.column_mut(j).scale_mut(factor);
            units[j] *= factor;
        }
    }
    Ok(solve(&a, &b)?.component_mul(&units))
}

/// The solution of A x = b.
///
/// # Errors
///
/// [`NotSliding::Singular`] if A is singular to rounding, [`NotSliding::Overflow`] if a number is
/// not finite.
fn solve(a: &DMatrix<f64>, b: &DVector<f64>) -> Result<DVector<f64>, NotSliding> {
    let largest = a.amax();
    if !a.iter().chain(b.iter()).all(|x| x.is_finite()) {
        return Err(NotSliding::Overflow);
    }
    let lu = a.clone().lu();
    let pivots = lu.u().diagonal();
    let least = f64::EPSILON * a.nrows() as f64 * largest;
    if !pivots.iter().all(|pivot| pivot.abs() > least) {
        return Err(NotSliding::Singular);
    }
    let found = lu.solve(b).ok_or(NotSliding::Singular)?;
    if found.iter().all(|x| x.is_finite()) {
        Ok(found)
    } else {
        Err(NotSliding::Overflow)
    }
}
