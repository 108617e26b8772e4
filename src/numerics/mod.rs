//! Numerical methods that know nothing of friction.
//!
//! | file | what is in it |
//! |---|---|
//! | `gauss.rs` | Gauss-Legendre quadrature on one interval |
//! | `adaptive.rs` | quadrature to round-off: trapezoidal rule, adaptive Gauss-Legendre |
//! | `chebyshev.rs` | all roots of a function known from values, by Chebyshev interpolation |

pub(crate) mod adaptive;
pub(crate) mod chebyshev;
pub(crate) mod gauss;
#[cfg(test)]
pub(crate) mod testing;
