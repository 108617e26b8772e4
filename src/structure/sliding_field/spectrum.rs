//! The eigenvalues of steady sliding.

use nalgebra::DMatrix;
use num_complex::Complex;

use super::SlidingField;
use crate::numerics::eigenvalues::{balance, eigenvalues as eigenvalues_of, growing};
use crate::numerics::sort::sort_by;

/// Real parts below this part of their terms count as 0.
const ROUNDING: f64 = 1e-10;

/// Eigenvalues of steady sliding.
pub(crate) struct Spectrum {
    /// The eigenvalues, by falling real part, then by falling imaginary part.
    pub(crate) values: Vec<Complex<f64>>,
    /// The number of them in the right half plane, with those of rounding left out.
    pub(crate) growing: usize,
}

impl Spectrum {
    /// `None` if the matrix holds a number that is not finite, or if they do not converge.
    pub(crate) fn of(mut matrix: DMatrix<f64>) -> Option<Self> {
        let _ = balance(&mut matrix);
        let values = eigenvalues_of(matrix.clone())?;
        let growing = growing(&matrix, &values, ROUNDING);
        Some(Self::sorted(values, growing))
    }

    /// Eigenvalues s of s² + K: s² = −λ of K alone, so that the real parts of a symmetric K are
    /// exactly 0.
    fn undamped(stiffness: DMatrix<f64>) -> Option<Self> {
        let squares = eigenvalues_of(stiffness)?;
        let roots = squares.iter().map(|&square| (-square).sqrt());
        let values: Vec<_> = roots.flat_map(|root| [root, -root]).collect();
        let largest = values.iter().map(|value| value.norm()).fold(0.0, f64::max);
        let grows = |value: &&Complex<f64>| value.re > ROUNDING * largest;
        let growing = values.iter().filter(grows).count();
        Some(Self::sorted(values, growing))
    }

    fn sorted(mut values: Vec<Complex<f64>>, growing: usize) -> Self {
        // No −0, which would sort after 0.
        for value in &mut values {
            *value += Complex::new(0.0, 0.0);
        }
        sort_by(&mut values, |value| -value.im);
        sort_by(&mut values, |value| -value.re);
        Self { values, growing }
    }
}

impl SlidingField<'_, '_> {
    /// The eigenvalues, without the zeros of rigid-body motions, and the number of memory variables
    /// without influence; `None` if they do not converge.
    pub(crate) fn eigenvalues(&self) -> Option<(Spectrum, usize)> {
        let (motions, active) = (self.small_motions()?, self.acting());
        let (displacements, velocities) = (&motions.displacements, &motions.velocities);
        let mut matrix = self.derivatives();
        let n = self.displacements.len();
        for (i, unit) in motions.units.iter().enumerate() {
            for k in [i, n + i] {
                matrix.row_mut(k).unscale_mut(*unit);
                matrix.column_mut(k).scale_mut(*unit);
            }
        }
        let remembered = self.order() - 2 * n;
        let sticking = self.held.iter();
        let sticking = sticking.map(|held| self.model.memory(held.contact).len());
        let idle = remembered - sticking.sum::<usize>() - active.len();
        let part = |i: usize, j: usize| matrix.view((i, j), (n, n));
        let elastic = &motions.kept * part(n, 0) * displacements;
        let damping = &motions.kept * part(n, n) * velocities;
        let same = displacements.ncols() == velocities.ncols();
        let spectrum = if active.is_empty() && same && damping.iter().all(|c| *c == 0.0) {
            Spectrum::undamped(-elastic)?
        } else {
            let [m, k] = [displacements, velocities].map(DMatrix::ncols);
            let order = m + k + active.len();
            let mut reduced = DMatrix::zeros(order, order);
            let link = displacements.transpose() * velocities;
            reduced.view_mut((0, m), (m, k)).copy_from(&link);
            reduced.view_mut((m, 0), (k, m)).copy_from(&elastic);
            reduced.view_mut((m, m), (k, k)).copy_from(&damping);
            for (j, &z) in active.iter().enumerate() {
                let acts = &motions.kept * matrix.view((n, z), (n, 1));
                let loaded = matrix.view((z, 0), (1, n)) * displacements;
                let driven = matrix.view((z, n), (1, n)) * velocities;
                reduced.view_mut((m + k + j, 0), (1, m)).copy_from(&loaded);
                reduced.view_mut((m, m + k + j), (k, 1)).copy_from(&acts);
                reduced.view_mut((m + k + j, m), (1, k)).copy_from(&driven);
                for (l, &other) in active.iter().enumerate() {
                    reduced[(m + k + j, m + k + l)] = matrix[(z, other)];
                }
            }
            Spectrum::of(reduced)?
        };
        Some((spectrum, idle))
    }
}
