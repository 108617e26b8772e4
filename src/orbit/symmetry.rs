//! Motions of symmetric systems: the half-period map, and pitchforks.

use nalgebra::{DMatrix, DVector};

use super::changes::{CurvePoint, LocalCurve};
use super::curve::solution;
use super::form::GeneralForm;
use super::map::SINGULAR;
use super::map::{CLOSED, PeriodMap, state, vector};
use crate::drive::Drive;
use crate::numerics::bracket::Bracket;
use crate::numerics::least_norm::least_norm;

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
/// including the springs and the given loads of normal springs; divided by the mass matrix.
#[derive(Debug, Clone)]
pub(super) struct Balance {
    stiffness: DMatrix<f64>,
    forces: DVector<f64>,
}

/// Places in half a period at which a symmetry is checked.
const PLACES: usize = 12;

/// Largest violation of a symmetry, in units of the sizes.
const SYMMETRIC: f64 = 1e-7;

/// Limit of Newton steps; three or four are usual.
const MOST_STEPS: usize = 12;

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

    /// The map of a symmetric motion, from its map over a period; `None` if it is not symmetric.
    pub(super) fn of_symmetric(map: &PeriodMap, period: f64) -> Option<Self> {
        let (n, sizes) = (map.start.displacements.len(), map.sizes());
        let pairs = (0..PLACES).map(|k| {
            let time = 0.5 * period * (k as f64 + 0.37) / PLACES as f64;
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

    /// The map for another system of the family, with other forces that determine the centre. A
    /// force that the springs do not balance, such as that of a contact that always sticks, is
    /// kept.
    pub(super) fn moved(&self, from: &Balance, to: &Balance) -> Option<Self> {
        let n = to.forces.len();
        let held = (&to.stiffness - &from.stiffness) * self.shift.rows(0, n);
        let change = &to.forces - &from.forces - held;
        let mut moved = self.clone();
        if change.amax() != 0.0 {
            let mut shift = moved.shift.rows_mut(0, n);
            shift += least_norm(to.stiffness.clone(), &change, SINGULAR)?;
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
fn inverting(image: &PeriodMap, sizes: &DVector<f64>) -> DMatrix<f64> {
    image.in_units(sizes) + DMatrix::identity(image.order(), image.order())
}

impl Balance {
    pub(super) fn of(form: &GeneralForm<'_>, period: f64) -> Self {
        let (model, n) = (&form.model, form.len());
        let mut stiffness = DMatrix::zeros(n, n);
        let mut forces = DVector::zeros(n);
        let twice = |drive: &Drive| drive.value(0.0) + drive.value(0.5 * period);
        let rows = std::iter::zip(model.stiffness.rows(), model.inverse_mass.rows());
        for (i, ((own, beside), (mobility, mobilities))) in rows.enumerate() {
            for &(j, entry) in beside.iter().chain([&(i, own)]) {
                stiffness[(i, j)] += entry;
            }
            for &(j, entry) in mobilities.iter().chain([&(i, mobility)]) {
                forces[i] += entry * twice(&model.forces[j]);
            }
        }
        for contact in &model.contacts {
            for &(i, reaction) in &contact.reaction {
                forces[i] -= reaction * twice(&contact.load);
                for &(j, gradient) in &contact.load_gradient {
                    stiffness[(i, j)] += reaction * gradient;
                }
            }
        }
        Self { stiffness, forces }
    }
}

impl LocalCurve<'_, '_> {
    /// The pitchfork between two symmetric motions whose multipliers pass 1, if there is one.
    ///
    /// At a pitchfork the equations of `follow` are singular, but those of the half-period map G
    /// are not: a symmetric motion is a fixed point of G, and det(G' + 1) changes its sign at a
    /// pitchfork.
    pub(super) fn pitchfork(&self, from: &CurvePoint, to: &CurvePoint) -> Option<CurvePoint> {
        let ends = [from, to].map(|place| {
            let (map, period) = (&place.solved.trial.map, place.solved.trial.period);
            let symmetric = HalfMap::of_symmetric(map, period);
            let y = &place.solved.y;
            let balance = self
                .curve
                .with(y, |form, period| Ok(Balance::of(form, period)));
            let held = (symmetric?, balance.ok()?);
            let motion = self.symmetric(&held, y, from)?;
            Some((self.curve.parameter(y), motion, held))
        });
        let [Some(mut low), Some(mut high)] = ends else {
            return None;
        };
        if low.0 > high.0 {
            std::mem::swap(&mut low, &mut high);
        }
        let values = [&low, &high].map(|end| (end.0, end.1.determinant));
        if !(values[0].0 < values[1].0 && values[0].1 * values[1].1 < 0.0) {
            return None;
        }
        let mut bracket = Bracket::new(values[0], values[1]);
        let mut best = low.1.clone();
        while let Some(parameter) = bracket.next_place() {
            let part = (parameter - low.0) / (high.0 - low.0);
            let mut guess = &low.1.y * (1.0 - part) + &high.1.y * part;
            guess[self.curve.unknowns() - 1] = parameter;
            best = self.symmetric(&low.2, &guess, from)?;
            bracket.narrow(parameter, best.determinant);
            if best.determinant == 0.0 {
                break;
            }
        }
        let curve = self.curve;
        let start = state(&best.y.rows(0, curve.order).into_owned(), curve.n);
        let solved = curve
            .guess(&start, best.period, curve.parameter(&best.y))
            .ok()?;
        let moved = self.scaled(&solved) - self.scaled(self.base);
        Some(CurvePoint {
            distance: self.base.tangent.dot(&moved),
            solved,
        })
    }

    /// The symmetric motion at the parameter of a guess, from the half-period map of another
    /// symmetric motion and the forces that determine its centre.
    fn symmetric(
        &self,
        (half_map, balance): &(HalfMap, Balance),
        guess: &DVector<f64>,
        near: &CurvePoint,
    ) -> Option<Symmetric> {
        let (curve, mut y) = (self.curve, guess.clone());
        let (order, modes) = (curve.order, near.solved.trial.map.end_modes());
        let own = curve.unknowns() - 1;
        let mut before = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let (half, period) = curve.motion(&y, modes, 0.5).ok()?;
            let here = curve.with(&y, |form, period| Ok(Balance::of(form, period)));
            let image = half_map.moved(balance, &here.ok()?)?.applied(half);
            y.rows_mut(0, order).copy_from(&vector(&image.start, order));
            let sizes = image.sizes();
            let (mut matrix, right) = image.closing(&sizes, own);
            if let Some(turning) = &curve.turning {
                let late = image.flow[1].component_div(&sizes) * period;
                matrix.view_mut((0, order), (order, 1)).copy_from(&late);
                let unit = sizes[curve.n + turning.coordinate];
                for (j, factor) in turning.entries(curve.n) {
                    matrix[(order, j)] = factor * (sizes[j] / unit);
                }
            }
            let change = solution(&matrix, &right)?;
            let size = change.amax();
            if size <= f64::EPSILON || (size <= CLOSED.sqrt() && size >= 0.5 * before) {
                return Some(Symmetric {
                    determinant: inverting(&image, &sizes).determinant(),
                    period,
                    y,
                });
            }
            before = size;
            for (i, change) in change.iter().enumerate() {
                y[i] += change * if i < order { sizes[i] } else { period };
            }
        }
        None
    }
}

/// A symmetric motion: a point of the curve.
#[derive(Clone)]
struct Symmetric {
    y: DVector<f64>,
    period: f64,
    /// det(G' + 1).
    determinant: f64,
}
