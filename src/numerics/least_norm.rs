//! Minimum-norm least-squares solutions of linear systems.

use nalgebra::{DMatrix, DVector, SVD};

/// The minimum-norm least-squares solution: singular values below a part of the largest count as 0.
pub(crate) fn least_norm(
    matrix: DMatrix<f64>,
    right: &DVector<f64>,
    singular: f64,
) -> Option<DVector<f64>> {
    if !matrix.iter().chain(right).all(|x| x.is_finite()) {
        return None;
    }
    let sweeps = 1000 * matrix.nrows();
    let svd = SVD::try_new(matrix, true, true, f64::EPSILON, sweeps)?;
    let least = singular * svd.singular_values.max();
    svd.solve(right, least).ok()
}

/// The same with the rows in units of their sizes, if it is finite.
pub(crate) fn least_norm_by_rows(
    mut matrix: DMatrix<f64>,
    mut right: DVector<f64>,
    singular: f64,
) -> Option<DVector<f64>> {
    for (mut row, right) in matrix.row_iter_mut().zip(right.iter_mut()) {
        let size = row.amax();
        if size > 0.0 {
            row /= size;
            *right /= size;
        }
    }
    let solution = least_norm(matrix, &right, singular)?;
    solution.iter().all(|x| x.is_finite()).then_some(solution)
}
