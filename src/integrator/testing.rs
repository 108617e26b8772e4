//! What tests share.

use super::{Polynomial, TERMS};

/// Σ c_k t^k, with 0 for all further coefficients.
pub(crate) fn polynomial(coefficients: &[f64]) -> Polynomial {
    let mut c = [0.0; TERMS];
    c[..coefficients.len()].copy_from_slice(coefficients);
    c
}
