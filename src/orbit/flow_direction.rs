//! Perturbations along an autonomous motion whose contacts all creep, kept apart from all others.
//!
//! The flow x' solves the variational equations, also through events, so a perturbation c x' along
//! the motion stays c x'. It grows as the motion becomes faster, by 4e8 from the creep of a fault
//! to an earthquake, and in a matrix its rounding errors would hide every other perturbation. Once
//! the parts along the motion are large, they are taken out of the perturbations, and their factors
//! c are kept:
//!
//! ```text
//! δx_j = c_j x' + p_j
//! ```

use nalgebra::{DMatrix, DVector, RowDVector};

use super::period_map::vector;
use crate::state::structure::State;

/// The growth of a part along the motion, in units of the perturbation at the start, from which on
/// it is taken out.
const LARGE: f64 = 100.0;

/// What is taken out of perturbations.
#[derive(Debug, Clone)]
pub(super) struct Along {
    /// The factors c.
    factors: RowDVector<f64>,
    /// The largest size of each number of the state so far.
    sizes: DVector<f64>,
}

/// The derivative over a part of a motion, p + x' c, with the flow x' at the end of the part.
#[derive(Debug, Clone)]
pub(super) struct Derivative {
    pub(super) across: DMatrix<f64>,
    factors: RowDVector<f64>,
}

impl Along {
    pub(super) fn new(order: usize) -> Self {
        Self {
            factors: RowDVector::zeros(order),
            sizes: DVector::zeros(order),
        }
    }

    /// Takes the parts along the flow out of perturbations in a state, if one of them is large.
    pub(super) fn take(
        &mut self,
        perturbations: &mut DMatrix<f64>,
        flow: &DVector<f64>,
        state: &State,
    ) {
        let order = self.sizes.len();
        for (size, x) in std::iter::zip(&mut self.sizes, &vector(state, order)) {
            *size = size.max(x.abs());
        }
        // A row of zeros stays one.
        let rows = perturbations.row_iter();
        let lives: Vec<bool> = rows.map(|row| row.iter().any(|x| *x != 0.0)).collect();
        let weights = DVector::from_fn(order, |i, _| match self.sizes[i] {
            size if size > 0.0 && lives[i] => size.recip(),
            _ => 0.0,
        });
        let scaled = flow.component_mul(&weights);
        let length = scaled.norm();
        if !(length > 0.0 && length.is_finite()) {
            return;
        }
        let factors = scaled.component_mul(&weights).tr_mul(perturbations) / (length * length);
        let growth = std::iter::zip(&factors, &self.sizes).map(|(c, size)| c.abs() * size * length);
        if growth.fold(0.0, f64::max) <= LARGE {
            return;
        }
        for i in (0..order).filter(|&i| lives[i]) {
            for j in 0..order {
                perturbations[(i, j)] -= flow[i] * factors[j];
            }
        }
        self.factors += factors;
    }

    /// The derivative over the part of the motion up to now; the next part begins.
    pub(super) fn end(&mut self, perturbations: DMatrix<f64>) -> Derivative {
        let none = RowDVector::zeros(self.sizes.len());
        Derivative {
            across: perturbations,
            factors: std::mem::replace(&mut self.factors, none),
        }
    }
}

impl Derivative {
    pub(super) fn identity(order: usize) -> Self {
        Self {
            across: DMatrix::identity(order, order),
            factors: RowDVector::zeros(order),
        }
    }

    /// The derivative over this part and the one that follows it.
    pub(super) fn then(&self, later: &Self) -> Self {
        Self {
            across: &later.across * &self.across,
            factors: &self.factors + &later.factors * &self.across,
        }
    }

    /// The whole matrix, with the flow at the end.
    pub(super) fn with_flow(&self, flow: &DVector<f64>) -> DMatrix<f64> {
        if self.factors.amax() == 0.0 {
            return self.across.clone();
        }
        &self.across + flow * &self.factors
    }
}
