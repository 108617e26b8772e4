//! The eigenvalues of steady sliding.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::super::equilibrium_newton::{self, inverse_mass_times};
use super::super::freedom::{direction_row, elastic_rows, null_space, rate_rows, units};
use super::{Slides, SlidingField};
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
    ///
    /// Displacements and velocities are in units of one energy. Rigid contacts that stick leave the
    /// perturbations b·δv = 0 only, and take the part P = 1 − X(BᵀX)⁻¹Bᵀ, X = M⁻¹B, of
    /// accelerations. Displacements along which no force changes, and velocities along which none
    /// changes, are left out: the matrix of the others has the remaining eigenvalues.
    pub(crate) fn eigenvalues(&self) -> Option<(Spectrum, usize)> {
        let (model, n) = (self.model, self.model.len());
        let units = units(model);
        let scaled = |row: &DVector<f64>| DVector::from_fn(n, |j, _| row[j] * units[j]);
        let sticking = self.sticking();
        let rigid = sticking
            .iter()
            .filter(|&&c| !model.contacts[c].is_elastic());
        let rigid: Vec<DVector<f64>> = rigid.map(|&c| direction_row(model, c)).collect();
        // Rigid-body motions.
        let mut rows = elastic_rows(model);
        rows.extend(sticking.iter().map(|&c| direction_row(model, c)));
        let displaced = null_space(model, &rows);
        let active = self.acting();
        let mut remembered = model.first_order.len();
        rows.extend(rate_rows(model));
        for (c, slides) in self.contacts.iter().enumerate() {
            let Some(Slides { sliding, .. }) = slides else {
                continue;
            };
            remembered += model.memory(c).len();
            let acts = (0..sliding.memory.len()).any(|j| !sliding.is_idle(j));
            if sliding.slope != 0.0 || acts {
                rows.push(direction_row(model, c));
            }
        }
        let moved = null_space(model, &rows);
        // What is left, in units of one energy.
        let left = |motions: &[DVector<f64>]| {
            let unit = |e: &DVector<f64>| DVector::from_fn(n, |j, _| e[j] / units[j]);
            let motions = motions.iter().map(unit);
            complement(n, motions.chain(rigid.iter().map(scaled)))
        };
        let (displacements, velocities) = (left(&displaced), left(&moved));
        let mut matrix = self.jacobian();
        for (i, unit) in units.iter().enumerate() {
            for k in [i, n + i] {
                matrix.row_mut(k).unscale_mut(*unit);
                matrix.column_mut(k).scale_mut(*unit);
            }
        }
        let kept = velocities.transpose() * self.released(&rigid, &units)?;
        let elastic = &kept * matrix.view((n, 0), (n, n)) * &displacements;
        let damping = &kept * matrix.view((n, n), (n, n)) * &velocities;
        let same = displacements.ncols() == velocities.ncols();
        let spectrum = if active.is_empty() && same && damping.iter().all(|c| *c == 0.0) {
            Spectrum::undamped(-elastic)?
        } else {
            let [m, k] = [&displacements, &velocities].map(DMatrix::ncols);
            let order = m + k + active.len();
            let mut reduced = DMatrix::zeros(order, order);
            let link = displacements.transpose() * &velocities;
            reduced.view_mut((0, m), (m, k)).copy_from(&link);
            reduced.view_mut((m, 0), (k, m)).copy_from(&elastic);
            reduced.view_mut((m, m), (k, k)).copy_from(&damping);
            for (j, &z) in active.iter().enumerate() {
                let acts = &kept * matrix.view((n, z), (n, 1));
                let loaded = matrix.view((z, 0), (1, n)) * &displacements;
                let driven = matrix.view((z, n), (1, n)) * &velocities;
                reduced.view_mut((m + k + j, 0), (1, m)).copy_from(&loaded);
                reduced.view_mut((m, m + k + j), (k, 1)).copy_from(&acts);
                reduced.view_mut((m + k + j, m), (1, k)).copy_from(&driven);
                for (l, &other) in active.iter().enumerate() {
                    reduced[(m + k + j, m + k + l)] = matrix[(z, other)];
                }
            }
            Spectrum::of(reduced)?
        };
        Some((spectrum, remembered - active.len()))
    }

    /// P in units of one energy.
    fn released(&self, rigid: &[DVector<f64>], units: &[f64]) -> Option<DMatrix<f64>> {
        let n = units.len();
        let identity = DMatrix::identity(n, n);
        if rigid.is_empty() {
            return Some(identity);
        }
        let along = DMatrix::from_fn(n, rigid.len(), |j, c| rigid[c][j] * units[j]);
        let responses = along
            .column_iter()
            .map(|b| inverse_mass_times(self.model, units, &b.into_owned()));
        let responses = DMatrix::from_columns(&responses.collect::<Vec<_>>());
        let compliance = along.transpose() * &responses;
        let least = equilibrium_newton::ROUNDING * compliance.amax();
        let inverse = compliance.pseudo_inverse(least).ok()?;
        Some(identity - responses * inverse * along.transpose())
    }
}

/// An orthonormal basis of the vectors normal to all of some vectors.
fn complement(n: usize, vectors: impl Iterator<Item = DVector<f64>>) -> DMatrix<f64> {
    let mut squares = DMatrix::zeros(n, n);
    let mut is_whole = true;
    for vector in vectors {
        let unit = vector.normalize();
        squares.ger(1.0, &unit, &unit, 1.0);
        is_whole = false;
    }
    if is_whole {
        return DMatrix::identity(n, n);
    }
    let eigen = squares.symmetric_eigen();
    let largest = eigen.eigenvalues.amax();
    let is_normal = |i: &usize| eigen.eigenvalues[*i] <= equilibrium_newton::ROUNDING * largest;
    let normal: Vec<usize> = (0..n).filter(is_normal).collect();
    eigen.eigenvectors.select_columns(&normal)
}
