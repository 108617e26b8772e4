//! What contacts at rest with dependent directions carry: of all possible forces, those with the
//! least Σ (λ_c/B_c)², where B_c is the bound on the side of λ_c.
//!
//! ```text
//! λ_c = B_c clamp(B_c s_c),   s = R u,   Rᵀλ = F
//! ```
//!
//! R are the directions of the contacts in units of the base, and F the forces of the base. u
//! minimises Σ H(B_c s_c(u)) − F·u, H' = clamp: Newton's method on a convex function whose second
//! derivative is piecewise constant. A force without a bound costs nothing: by the method of
//! multipliers s_c is shifted until it is 0 where this force acts.

use nalgebra::{DMatrix, DVector};

use super::cholesky::ROUNDING;
use super::limits::larger_finite;
use super::stick_band_edge::side_of;

/// Limit of the steps of Newton's method.
const MOST_ROUNDS: usize = 100;

/// Rounds of the method of multipliers, each of which leaves a part of some 1/STIFF².
const SHIFTS: usize = 4;

/// Factor by which a contact whose share has no bound carries more than the others.
const STIFF: f64 = 1e3;

/// Shares of forces, in units of the largest finite bound or force.
struct Shares<'r> {
    rows: &'r DMatrix<f64>,
    bounds: Vec<[f64; 2]>,
    goal: DVector<f64>,
    shifts: DVector<f64>,
}

/// The forces λ of contacts with these directions, one in each row, of which the base has these
/// forces; bounds against slip backward and forward.
pub(super) fn least_norm_shares(
    rows: &DMatrix<f64>,
    forces: &DVector<f64>,
    bounds: &[[f64; 2]],
) -> Vec<f64> {
    let finite = bounds.iter().map(|&bounds| larger_finite(bounds));
    let largest = finite.fold(forces.amax(), f64::max);
    if largest == 0.0 || !largest.is_finite() {
        return vec![0.0; bounds.len()];
    }
    let of_unit = bounds.iter().map(|both| both.map(|b| b / largest));
    let mut shares = Shares {
        rows,
        bounds: of_unit.collect(),
        goal: forces / largest,
        shifts: DVector::zeros(bounds.len()),
    };
    let mut u = shares.minimum(DVector::zeros(rows.ncols()));
    for _ in 0..SHIFTS {
        let next = shares.shifts_at(&u);
        if next == shares.shifts {
            break;
        }
        shares.shifts = next;
        u = shares.minimum(u);
    }
    (shares.balanced(&u) * largest).iter().copied().collect()
}

impl Shares<'_> {
    fn bound(&self, row: usize, s: f64) -> f64 {
        self.bounds[row][side_of(s).place()]
    }

    /// λ.
    fn carried(&self, u: &DVector<f64>) -> DVector<f64> {
        self.each(u, |bound, s| match bound.is_infinite() {
            true => STIFF * STIFF * s,
            false => bound * (bound * s).clamp(-1.0, 1.0),
        })
    }

    /// The slope of each λ_c by s_c.
    fn slopes(&self, u: &DVector<f64>) -> DVector<f64> {
        self.each(u, |bound, s| match bound.is_infinite() {
            true => STIFF * STIFF,
            false if (bound * s).abs() <= 1.0 => bound * bound,
            false => 0.0,
        })
    }

    /// A function of the bound and s of each contact.
    fn each(&self, u: &DVector<f64>, of: impl Fn(f64, f64) -> f64) -> DVector<f64> {
        let mut all = self.rows * u + &self.shifts;
        for (row, s) in all.iter_mut().enumerate() {
            *s = of(self.bound(row, *s), *s);
        }
        all
    }

    /// F − Rᵀλ.
    fn rest(&self, shares: &DVector<f64>) -> DVector<f64> {
        &self.goal - self.rows.transpose() * shares
    }

    /// The step of Newton's method.
    fn step(&self, slopes: &DVector<f64>, rest: &DVector<f64>) -> Option<DVector<f64>> {
        let rank = self.rows.ncols();
        let mut second = DMatrix::identity(rank, rank) * 1e-12;
        for (row, slope) in std::iter::zip(self.rows.row_iter(), slopes) {
            second += row.transpose() * row * *slope;
        }
        second.cholesky().map(|factor| factor.solve(rest))
    }

    /// The u of the least sum.
    fn minimum(&self, mut u: DVector<f64>) -> DVector<f64> {
        let rest_at = |u: &DVector<f64>| self.rest(&self.carried(u));
        for _ in 0..MOST_ROUNDS {
            let rest = rest_at(&u);
            if rest.amax() <= ROUNDING * self.goal.amax() {
                break;
            }
            let Some(direction) = self.step(&self.slopes(&u), &rest) else {
                break;
            };
            // The minimum along the direction, where the slope changes its sign.
            let rises = |t: f64| rest_at(&(&u + &direction * t)).dot(&direction) > 0.0;
            let mut part = 1.0;
            if !rises(part) {
                let mut low = 0.0;
                for _ in 0..60 {
                    let middle = 0.5 * (low + part);
                    *(if rises(middle) { &mut low } else { &mut part }) = middle;
                }
            }
            let next = &u + &direction * part;
            if next == u {
                break;
            }
            u = next;
        }
        u
    }

    /// The shifts with which the forces without a bound cost nothing.
    fn shifts_at(&self, u: &DVector<f64>) -> DVector<f64> {
        let mut shares = self.carried(u);
        for (row, share) in shares.iter_mut().enumerate() {
            *share = match self.bound(row, *share).is_infinite() {
                true => *share / (STIFF * STIFF),
                false => 0.0,
            };
        }
        shares
    }

    /// The shares, balanced to rounding. A share without a bound magnifies the rounding errors of
    /// u: those that may change take them up, and the base what is left then.
    fn balanced(&self, u: &DVector<f64>) -> DVector<f64> {
        let mut shares = self.carried(u);
        let mut rest = self.rest(&shares);
        let slopes = self.slopes(u);
        if let Some(direction) = self.step(&slopes, &rest) {
            shares += slopes.component_mul(&(self.rows * direction));
            rest = self.rest(&shares);
        }
        for (share, rest) in shares.iter_mut().zip(&rest) {
            *share += rest;
        }
        shares
    }
}
