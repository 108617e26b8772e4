//! Numerical methods that know nothing of friction.
//!
//! | file | what is in it |
//! |---|---|
//! | `bracket.rs` | one root between two signs, to neighbouring numbers, from values alone |
//! | `scan.rs` | a range looked at over a grid: how many intervals, how often halved where something may hide |
//! | `with_slopes.rs` | all roots, and the outline, of a function known with its slope; how close two roots may lie |
//! | `gauss.rs` | Gauss-Legendre quadrature on one interval |
//! | `adaptive.rs` | quadrature to round-off: trapezoidal rule, adaptive Gauss-Legendre |
//! | `chebyshev.rs` | all roots of a function known from values, by Chebyshev interpolation |
//!
//! Searches take their function as `&mut dyn FnMut`, and are compiled once: one call costs a whole
//! slip arc, or a search for cycles.

pub(crate) mod adaptive;
pub(crate) mod bracket;
pub(crate) mod chebyshev;
pub(crate) mod gauss;
pub(crate) mod scan;
#[cfg(test)]
pub(crate) mod testing;
pub(crate) mod with_slopes;
