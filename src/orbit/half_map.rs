//! Motions of symmetric systems, and of those that take twice their own period: the half-period
//! map.

use nalgebra::{DMatrix, DVector};

use super::period_map::SINGULAR;
use super::period_map::{PeriodMap, vector};
use super::type_erased_system::GeneralForm;
use crate::drive::Drive;
use crate::numerics::least_norm::least_norm;
use crate::structure::engine::first_order;

/// The map G over half of a period, of which a motion is a fixed point: G(x) = S P(x) + c with
/// diagonal S and constant c. For a motion that takes twice its own period S is the identity; for a
/// symmetric one S is −1, except for variables that do not depend on the direction, such as the
/// time in stick.
#[derive(Debug, Clone)]
pub(super) struct HalfMap {
    signs: DVector<f64>,
    shift: DVector<f64>,
}

/// The forces that determine the centre c/2 of a symmetric motion, K c = f(t) + f(t + T/2),
/// including the springs and the given loads of normal springs; divided by the mass matrix. The
/// equations of first-order states follow.
#[derive(Debug, Clone)]
pub(super) struct Balance {
    stiffness: DMatrix<f64>,
    forces: DVector<f64>,
    /// Largest rounding error of each of these forces: a drive that returns with the other sign
    /// leaves one.
    rounding: DVector<f64>,
    /// The directions of force elements, along which the centre may not move: their laws are odd
    /// about it.
    directions: Vec<Vec<(usize, f64)>>,
    /// The numbers of a state that the centre has: displacements and first-order states.
    places: Vec<usize>,
}

/// Places in half a period at which a symmetry is checked.
const PLACES: usize = 12;

/// Largest violation of a symmetry, in units of the sizes.
const SYMMETRIC: f64 = 1e-7;

/// Rounding errors of drives, in parts of their sizes.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// Tolerance for a direction that the half-period map inverts.
const INVERTED: f64 = 1e-4;

impl HalfMap {
    /// The map of motions that take twice their own period.
    pub(super) fn of_doubled(order: usize) -> Self {
        Self {
            signs: DVector::from_element(order, 1.0),
            shift: DVector::zeros(order),
        }
    }

    /// The map of a symmetric motion, from its map over a period; `None` if it is not symmetric, or
    /// friction depends on the direction.
    pub(super) fn of_symmetric(map: &PeriodMap, period: f64) -> Option<Self> {
        if !map.is_friction_even {
            return None;
        }
        let (n, sizes) = (map.start.displacements.len(), map.sizes());
        let pairs = (0..PLACES).map(|k| {
            let time = map.begins() + 0.5 * period * (k as f64 + 0.37) / PLACES as f64;
            Some([map.vector_at(time)?, map.vector_at(time + 0.5 * period)?])
        });
        let pairs: Vec<[DVector<f64>; 2]> = pairs.collect::<Option<_>>()?;
        let [first, second] = pairs.first()?;
        let sums = first + second;
        let bound = map.without_free_velocities(&sums);
        let (mut signs, mut shift) = (DVector::zeros(sums.len()), DVector::zeros(sums.len()));
        for i in 0..sums.len() {
            let is_small = |x: f64| x.abs() <= SYMMETRIC * sizes[i];
            // A velocity has no mean value but one that nothing depends on.
            let is_velocity = (n..2 * n).contains(&i);
            let is_odd = pairs.iter().all(|[a, b]| is_small(a[i] + b[i] - sums[i]))
                && (!is_velocity || is_small(bound[i]));
            let is_even = i >= 2 * n && pairs.iter().all(|[a, b]| is_small(a[i] - b[i]));
            signs[i] = match (is_odd, is_even) {
                (true, _) => -1.0,
                (false, true) => 1.0,
                (false, false) => return None,
            };
            // A centre that is 0 to rounding is 0.
            if is_odd && !is_small(sums[i]) {
                shift[i] = sums[i];
            }
        }
        Some(Self { signs, shift })
    }

    /// The map for another system of the family, with other forces that determine the centre;
    /// `None` if force elements, which have no other centre, would hold them. A force that the
    /// springs do not balance, such as that of a contact that always sticks, is kept.
    pub(super) fn moved(&self, from: &Balance, to: &Balance) -> Option<Self> {
        let centre = DVector::from_iterator(
            to.places.len(),
            to.places.iter().map(|&place| self.shift[place]),
        );
        let held = (&to.stiffness - &from.stiffness) * centre;
        let mut change = &to.forces - &from.forces - held;
        let rounding = &from.rounding + &to.rounding;
        change.zip_apply(&rounding, |change: &mut f64, rounding| {
            if change.abs() <= rounding {
                *change = 0.0;
            }
        });
        let mut moved = self.clone();
        if change.amax() != 0.0 {
            let by = least_norm(to.stiffness.clone(), &change, SINGULAR)?;
            let along = |direction: &Vec<(usize, f64)>| {
                let terms = direction.iter().map(|&(j, a)| a * by[j]);
                let [sum, size] = terms.fold([0.0, 0.0], |[s, n], x| [s + x, n + x.abs()]);
                f64::abs(sum) > SYMMETRIC * size
            };
            if to.directions.iter().any(along) {
                return None;
            }
            for (&place, by) in std::iter::zip(&to.places, &by) {
                moved.shift[place] += by;
            }
        }
        Some(moved)
    }

    /// G as a map like that over a period, from the motion over half of it: its end is the image of
    /// the start, with the derivatives by the start and by the whole period.
    pub(super) fn applied(&self, mut half: PeriodMap) -> PeriodMap {
        half.end_at(self.image(&vector(&half.end, half.order())));
        for (mut row, sign) in half.monodromy.row_iter_mut().zip(&self.signs) {
            row *= *sign;
        }
        half.flow[1].component_mul_assign(&self.signs);
        half.flow[1] *= 0.5;
        half
    }

    /// G(x), from the motion over half a period.
    fn image(&self, end: &DVector<f64>) -> DVector<f64> {
        end.component_mul(&self.signs) + &self.shift
    }

    /// The direction w with G'w = −w, of size 1 in units of the sizes, from the motion over half a
    /// period; `None` if there is none.
    pub(super) fn inverted(&self, half: &PeriodMap, sizes: &DVector<f64>) -> Option<DVector<f64>> {
        let order = half.order();
        let matrix = inverting(&self.applied(half.clone()), sizes);
        let svd = matrix.try_svd(false, true, f64::EPSILON, 1000 * order)?;
        let values = &svd.singular_values;
        let (least, value) = values.argmin();
        let vector = svd.v_t?.row(least).transpose();
        (value <= INVERTED * values.max().max(1.0))
            .then(|| (&vector / vector.amax()).component_mul(sizes))
    }
}

/// G' + 1, in units of the sizes.
pub(super) fn inverting(image: &PeriodMap, sizes: &DVector<f64>) -> DMatrix<f64> {
    image.in_units(sizes) + DMatrix::identity(image.order(), image.order())
}

impl Balance {
    pub(super) fn of(form: &GeneralForm<'_>, period: f64) -> Self {
        let (model, n) = (&form.model, form.len());
        let all = n + model.first_order.len();
        let mut stiffness = DMatrix::zeros(all, all);
        let mut forces = DVector::zeros(all);
        let mut sizes = DVector::zeros(all);
        let twice = |drive: &Drive| drive.value(0.0) + drive.value(0.5 * period);
        let rows = std::iter::zip(model.stiffness.rows(), model.inverse_mass.rows());
        for (i, ((own, beside), (mobility, mobilities))) in rows.enumerate() {
            for &(j, entry) in beside.iter().chain([&(i, own)]) {
                stiffness[(i, j)] += entry;
            }
            for &(j, entry) in mobilities.iter().chain([&(i, mobility)]) {
                forces[i] += entry * twice(&model.forces[j]);
                sizes[i] += (entry * model.forces[j].size()).abs();
            }
        }
        for contact in &model.contacts {
            for &(i, reaction) in &contact.reaction {
                forces[i] -= reaction * twice(&contact.load);
                sizes[i] += (reaction * contact.load.size()).abs();
                for &(j, gradient) in &contact.load_gradient {
                    stiffness[(i, j)] += reaction * gradient;
                }
            }
        }
        for (state, row) in std::iter::zip(&model.first_order, n..) {
            forces[row] = state.scale * twice(&state.drive);
            sizes[row] = (state.scale * state.drive.size()).abs();
        }
        first_order::subtract(&model.first_order, &mut stiffness, n);
        let elements = model.elements.iter();
        Self {
            places: (0..all).map(|j| model.position_row(j)).collect(),
            stiffness,
            forces,
            rounding: sizes * ROUNDING,
            directions: elements
                .flat_map(|element| element.directions.to_vec())
                .collect(),
        }
    }
}
