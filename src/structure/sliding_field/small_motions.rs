//! The small motions about steady sliding that contacts which stick allow.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::super::equilibrium_newton::{self, inverse_mass_times};
use super::super::freedom::{direction_row, elastic_rows, null_space, rate_rows, units};
use super::{Slides, SlidingField};

/// Bases of small motions, in units of one energy. A rigid contact that sticks leaves the
/// perturbations b·δq = 0 and b·δv = 0 only. Displacements along which no force changes, and
/// velocities along which none changes, are left out: rigid-body motions.
pub(super) struct SmallMotions {
    /// The displacement, or velocity, of each coordinate.
    pub(super) units: Vec<f64>,
    /// Orthonormal bases D and V of displacements and velocities.
    pub(super) displacements: DMatrix<f64>,
    pub(super) velocities: DMatrix<f64>,
    /// VᵀP: rigid contacts that stick take the part P = 1 − X(BᵀX)⁻¹Bᵀ, X = M⁻¹B, of accelerations.
    pub(super) kept: DMatrix<f64>,
    /// (BᵀX)⁻¹Bᵀ: the forces of rigid contacts that stick, in their order.
    reactions: DMatrix<f64>,
}

impl SlidingField<'_, '_> {
    /// `None` if a number is not finite.
    pub(super) fn small_motions(&self) -> Option<SmallMotions> {
        let (model, n) = (self.model, self.model.len());
        let units = units(model);
        let scaled = |row: &DVector<f64>| DVector::from_fn(n, |j, _| row[j] * units[j]);
        let sticking = self.sticking();
        let rigid = sticking
            .iter()
            .filter(|&&c| !model.contacts[c].is_elastic());
        let rigid = rigid.map(|&c| scaled(&direction_row(model, c)));
        let rigid: Vec<DVector<f64>> = rigid.collect();
        // Rigid-body motions.
        let mut rows = elastic_rows(model);
        rows.extend(sticking.iter().map(|&c| direction_row(model, c)));
        let displaced = null_space(model, &rows);
        rows.extend(rate_rows(model));
        for (c, slides) in self.contacts.iter().enumerate() {
            let Some(Slides { sliding, .. }) = slides else {
                continue;
            };
            let acts = (0..sliding.memory.len()).any(|j| !sliding.is_idle(j));
            if sliding.slope != 0.0 || acts {
                rows.push(direction_row(model, c));
            }
        }
        let moved = null_space(model, &rows);
        let left = |motions: &[DVector<f64>]| {
            let unit = |e: &DVector<f64>| DVector::from_fn(n, |j, _| e[j] / units[j]);
            complement(n, motions.iter().map(unit).chain(rigid.iter().cloned()))
        };
        let (displacements, velocities) = (left(&displaced), left(&moved));
        let mut kept = velocities.transpose();
        let mut reactions = DMatrix::zeros(0, n);
        if !rigid.is_empty() {
            let along = DMatrix::from_columns(&rigid);
            let responses = rigid.iter().map(|b| inverse_mass_times(model, &units, b));
            let responses = DMatrix::from_columns(&responses.collect::<Vec<_>>());
            let compliance = along.transpose() * &responses;
            let least = equilibrium_newton::ROUNDING * compliance.amax();
            reactions = compliance.pseudo_inverse(least).ok()? * along.transpose();
            kept *= DMatrix::identity(n, n) - responses * &reactions;
        }
        Some(SmallMotions {
            units,
            displacements,
            velocities,
            kept,
            reactions,
        })
    }

    /// The projection Π of perturbations of a state on those of small motions, with the memory
    /// variables that act. The force of an elastic contact that sticks follows its displacement.
    pub(crate) fn projection(&self) -> Option<DMatrix<f64>> {
        let (model, n) = (self.model, self.model.len());
        let SmallMotions {
            units,
            displacements,
            velocities,
            kept,
            ..
        } = self.small_motions()?;
        let mut projection = DMatrix::zeros(self.order(), self.order());
        let parts = [
            &displacements * displacements.transpose(),
            velocities * kept,
        ];
        for (first, part) in std::iter::zip([0, n], parts) {
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                projection[(first + i, first + j)] = part[(i, j)] * (units[i] / units[j]);
            }
        }
        for held in &self.held {
            let contact = &model.contacts[held.contact];
            let row = 2 * n + model.memory(held.contact).start;
            for &(i, b) in contact.direction.iter() {
                let Some(stiffness) = contact.tangential_stiffness else {
                    break;
                };
                for j in 0..n {
                    projection[(row, j)] += stiffness * b * projection[(i, j)];
                }
            }
        }
        for place in self.acting() {
            projection[(place, place)] = 1.0;
        }
        Some(projection)
    }

    /// ∂F/∂x, with what is no small motion decaying by itself: Π(∂F/∂x)Π + Π − 1.
    pub(crate) fn jacobian(&self) -> Option<DMatrix<f64>> {
        let projection = self.projection()?;
        let decays = &projection - DMatrix::identity(self.order(), self.order());
        Some(&projection * self.derivatives() * &projection + decays)
    }

    /// The sizes of the forces of contacts that stick in the small motion Re(q e^{iωt}), in their
    /// order.
    pub(crate) fn held_forces(&self, q: &DVector<Complex<f64>>) -> Option<Vec<f64>> {
        let (model, n) = (self.model, self.model.len());
        let SmallMotions {
            units, reactions, ..
        } = self.small_motions()?;
        let accelerations = self.derivatives().rows(n, n).map(Complex::from) * q;
        let units = DVector::from_vec(units).map(Complex::from);
        let rigid = reactions.map(Complex::from) * accelerations.component_div(&units);
        let mut rigid = rigid.iter();
        let forces = self.held.iter().map(|held| {
            let contact = &model.contacts[held.contact];
            let Some(stiffness) = contact.tangential_stiffness else {
                return rigid.next().map(|force| force.norm());
            };
            let stretch = contact.direction.iter().map(|&(j, b)| q[j] * b);
            Some(stiffness * stretch.sum::<Complex<f64>>().norm())
        });
        forces.collect()
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
