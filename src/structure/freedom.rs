//! The directions in which a structure can be moved without any change of a force.

use nalgebra::{DMatrix, DVector};

use super::engine::contact_data::Entries;
use super::engine::first_order::FirstOrderData;
use super::engine::model::Model;
use super::engine::sparse::Sparse;

/// Entries of a direction, and remainders of a singular matrix, below this part are rounding.
const ROUNDING: f64 = 1e-12;

/// The directions in which a system can be moved without any change of a force: displacements on
/// which nothing depends, and velocities on which nothing depends either.
#[derive(Debug, Clone, Default)]
pub(crate) struct Freedom {
    pub(crate) displacements: Vec<DVector<f64>>,
    pub(crate) velocities: Vec<DVector<f64>>,
}

impl Freedom {
    /// K e = 0, n_c·e = 0 of each load gradient, a·e = 0 of each force element and A_q e = 0 of
    /// first-order states; for velocities C e = 0, A_v e = 0 and b_c·e = 0 too.
    pub(crate) fn of(model: &Model<'_>) -> Self {
        let rows = elastic_rows(model);
        let displacements = null_space(model, &rows);
        if displacements.is_empty() {
            return Self::default();
        }
        let along = (0..model.contacts.len()).map(|c| direction_row(model, c));
        let rows = rows.into_iter().chain(rate_rows(model)).chain(along);
        let velocities = null_space(model, &rows.collect::<Vec<_>>());
        Self {
            displacements,
            velocities,
        }
    }
}

/// The rows of K, the load gradients, the directions of force elements, and the rows of A_q of
/// first-order states on which anything depends: the forces that displacements change.
pub(super) fn elastic_rows(model: &Model<'_>) -> Vec<DVector<f64>> {
    let gradients = model.contacts.iter();
    let gradients = gradients.map(|contact| row(model.len(), &contact.load_gradient));
    let elements = model
        .elements
        .iter()
        .flat_map(|element| &*element.directions);
    let elements = elements.map(|direction| row(model.len(), direction));
    let states = acting(model).map(|state| row(model.len(), &state.displacements));
    rows_of(&model.stiffness)
        .chain(gradients)
        .chain(elements)
        .chain(states)
        .collect()
}

/// The rows of C, and of A_v of first-order states on which anything depends.
pub(super) fn rate_rows(model: &Model<'_>) -> impl Iterator<Item = DVector<f64>> {
    let states = acting(model).map(|state| row(model.len(), &state.velocities));
    rows_of(&model.damping).chain(states)
}

fn acting<'m>(model: &'m Model<'_>) -> impl Iterator<Item = &'m FirstOrderData> {
    model.first_order.iter().filter(|state| state.acts)
}

/// The direction of a contact.
pub(super) fn direction_row(model: &Model<'_>, contact: usize) -> DVector<f64> {
    row(model.len(), &model.contacts[contact].direction)
}

fn row(n: usize, entries: &Entries) -> DVector<f64> {
    let mut row = DVector::zeros(n);
    // Numbers beyond those of the coordinates are first-order states.
    let entries = entries.iter().filter(|&&(j, _)| j < n);
    entries.for_each(|&(j, x)| row[j] += x);
    row
}

fn rows_of(matrix: &Sparse) -> impl Iterator<Item = DVector<f64>> {
    matrix.rows().enumerate().map(|(i, (own, beside))| {
        let mut row = DVector::zeros(matrix.rows().count());
        row[i] = own;
        beside.iter().for_each(|&(j, x)| row[j] = x);
        row
    })
}

/// The displacement, or velocity, of each coordinate in units of one energy.
pub(super) fn units(model: &Model<'_>) -> Vec<f64> {
    model.inverse_mass.rows().map(|(x, _)| x.sqrt()).collect()
}

/// A basis of the vectors to which all rows are normal but for rounding, by a QR decomposition with
/// column pivots. Columns are in units of one energy and rows of size 1, so that units of the
/// system do not matter.
pub(super) fn null_space(model: &Model<'_>, rows: &[DVector<f64>]) -> Vec<DVector<f64>> {
    let n = model.len();
    let units = units(model);
    let rows = rows.iter().filter_map(|row| {
        let row = DVector::from_fn(n, |j, _| row[j] * units[j]);
        let size = row.amax();
        (size > 0.0).then(|| (row / size).transpose())
    });
    let rows: Vec<_> = rows.collect();
    if rows.is_empty() {
        let unit = |i: usize| DVector::from_fn(n, |j, _| f64::from(u8::from(i == j)));
        return (0..n).map(unit).collect();
    }
    let count = rows.len().max(n);
    let matrix = DMatrix::from_rows(&rows).resize_vertically(count, 0.0);
    let qr = matrix.clone().col_piv_qr();
    let upper = qr.r();
    let least = ROUNDING * upper[(0, 0)].abs();
    let rank = (0..n).take_while(|&i| upper[(i, i)].abs() > least).count();
    let mut basis = DMatrix::zeros(n, n - rank);
    let solved = upper
        .view((0, 0), (rank, rank))
        .solve_upper_triangular(&upper.view((0, rank), (rank, n - rank)));
    let Some(solved) = solved else {
        return Vec::new();
    };
    basis.view_mut((0, 0), (rank, n - rank)).copy_from(&-solved);
    basis
        .view_mut((rank, 0), (n - rank, n - rank))
        .fill_with_identity();
    qr.p().inv_permute_rows(&mut basis);
    for mut column in basis.column_iter_mut() {
        let least = ROUNDING * column.amax();
        let rounding = column.iter_mut().filter(|x| x.abs() <= least);
        rounding.for_each(|x| *x = 0.0);
    }
    let found = basis.column_iter().filter_map(|column| {
        let is_null = matrix.row_iter().all(|row| {
            let terms = row.iter().zip(&column).map(|(a, e)| a * e);
            let [sum, size] = terms.fold([0.0, 0.0], |[sum, size], x| [sum + x, size + x.abs()]);
            f64::abs(sum) <= ROUNDING * size
        });
        let direction = DVector::from_fn(n, |j, _| column[j] * units[j]);
        is_null.then(|| &direction / direction.amax())
    });
    found.collect()
}
