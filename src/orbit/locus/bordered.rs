//! Scalars that are 0 exactly where a matrix is singular, and smooth: bordered matrices,
//!
//! ```text
//! A W + b G = 0,    cᵀ W = 1
//! Aᵀ U + c Gᵀ = 0,  bᵀ U = 1
//! G_α = −Uᵀ A_α W
//! ```
//!
//! with one border, or two where two singular values vanish together. Source: Govaerts, *Numerical
//! Methods for Bifurcations of Dynamical Equilibria*, chapter 3.

use crate::numerics::sort::order;
use nalgebra::{DMatrix, DVector, SVD};

/// A bordered matrix, solved.
#[derive(Debug, Clone)]
pub(super) struct Bordered {
    /// The borders b and c.
    borders: [DMatrix<f64>; 2],
    pub(super) left: DMatrix<f64>,
    pub(super) right: DMatrix<f64>,
    pub(super) scalars: DMatrix<f64>,
}

impl Bordered {
    /// Borders for a matrix that is almost singular: its last singular vectors.
    pub(super) fn begin(matrix: &DMatrix<f64>, count: usize) -> Option<Self> {
        let n = matrix.nrows();
        if !matrix.iter().all(|x| x.is_finite()) || n < count {
            return None;
        }
        let svd = SVD::try_new(matrix.clone(), true, true, f64::EPSILON, 1000 * n)?;
        let (left, right) = (svd.u?, svd.v_t?.transpose());
        let order = order(svd.singular_values.as_slice());
        let last = |vectors: &DMatrix<f64>| vectors.select_columns(&order[..count]);
        let borders = [last(&left), last(&right)];
        Self::solve(borders, matrix)
    }

    /// Solves for another matrix with these borders; `None` if the bordered matrix is singular.
    pub(super) fn with(&self, matrix: &DMatrix<f64>) -> Option<Self> {
        Self::solve(self.borders.clone(), matrix)
    }

    /// Borders from these solutions.
    pub(super) fn renewed(&self) -> Option<Self> {
        let orthonormal = |vectors: &DMatrix<f64>| {
            if vectors.ncols() == 1 {
                return vectors.normalize();
            }
            vectors.clone().qr().q()
        };
        let borders = [orthonormal(&self.left), orthonormal(&self.right)];
        let finite = borders.iter().flatten().all(|x| x.is_finite());
        finite.then(|| Self {
            borders,
            ..self.clone()
        })
    }

    /// Converts to other units by the ratios of the old ones to the new ones; rows behind these
    /// keep their units.
    pub(super) fn rescaled(mut self, ratio: &DVector<f64>) -> Self {
        let rescale = |vectors: &mut DMatrix<f64>, power: i32| {
            for (i, mut row) in vectors.row_iter_mut().enumerate().take(ratio.len()) {
                row *= ratio[i].powi(power);
            }
        };
        let [left, right] = &mut self.borders;
        for (vectors, power) in [
            (left, -1),
            (&mut self.left, -1),
            (right, 1),
            (&mut self.right, 1),
        ] {
            rescale(vectors, power);
        }
        self
    }

    fn solve(borders: [DMatrix<f64>; 2], matrix: &DMatrix<f64>) -> Option<Self> {
        let (n, count) = (matrix.nrows(), borders[0].ncols());
        let mut system = DMatrix::zeros(n + count, n + count);
        system.view_mut((0, 0), (n, n)).copy_from(matrix);
        system.view_mut((0, n), (n, count)).copy_from(&borders[0]);
        system
            .view_mut((n, 0), (count, n))
            .copy_from(&borders[1].transpose());
        let mut unit = DMatrix::zeros(n + count, count);
        unit.view_mut((n, 0), (count, count)).fill_with_identity();
        let adjoint = system.transpose().lu().solve(&unit)?;
        let found = system.lu().solve(&unit)?;
        let numbers = found.iter().chain(&adjoint);
        if !numbers.copied().all(f64::is_finite) {
            return None;
        }
        Some(Self {
            borders,
            left: adjoint.rows(0, n).into_owned(),
            right: found.rows(0, n).into_owned(),
            scalars: found.rows(n, count).into_owned(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The derivative of the scalars, against differences, and their zero with a singular matrix.
    #[test]
    fn scalars_vanish_with_the_matrix_and_have_the_derivative_of_the_formula() {
        let turn = DMatrix::from_row_slice(3, 3, &[0.6, -0.8, 0.3, 0.8, 0.6, -0.2, 0.0, 0.0, 0.5]);
        let matrix = |kappa: f64| &turn * &turn - &turn * (2.0 * kappa) + DMatrix::identity(3, 3);
        let begun = Bordered::begin(&matrix(0.59), 2).unwrap();
        let there = begun.with(&matrix(0.6)).unwrap();
        assert!(there.scalars.amax() < 1e-14);
        let h = 1e-4;
        let [low, high] = [0.6 - h, 0.6 + h].map(|kappa| begun.with(&matrix(kappa)).unwrap());
        let slope = (high.scalars - low.scalars) / (2.0 * h);
        let formula = there.left.transpose() * &turn * &there.right * 2.0;
        assert!((slope - formula).amax() < 1e-7);
        assert!(Bordered::begin(&DMatrix::from_element(2, 2, f64::NAN), 1).is_none());
    }
}
