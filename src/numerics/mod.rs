//! Numerical methods, independent of friction.
//!
//! Searches take their function as `&mut dyn FnMut` and so are compiled once. The indirect call
//! costs nothing compared with the function, which computes a whole slip arc or searches for
//! cycles.

// | file | what is in it |
// |---|---|
// | `bracket.rs` | one root between two points of different sign, to neighbouring `f64` numbers, without slopes |
// | `scan.rs` | the search of a range over a grid: how many intervals, and how often one is halved where a root may hide |
// | `roots_with_slopes.rs` | all roots of a function known with its slope, and its outline (where it turns); how close two roots may lie |
// | `gauss.rs` | Gauss-Legendre quadrature on one interval |
// | `fourier.rs` | Fourier coefficients of a function that is known piece by piece |
// | `adaptive.rs` | quadrature to round-off: trapezoidal rule, adaptive Gauss-Legendre |
// | `eigenvalues.rs` | eigenvalues of any real matrix, also where the QR method by itself does not move; units in which a matrix is balanced |
// | `exponential.rs` | the exponential of a matrix |
// | `least_norm.rs` | minimum-norm least-squares solutions of linear systems |
// | `sort.rs` | sorting by a number, compiled once for all types |
// | `interpolation.rs` | curves through the points of a table: straight lines or monotone cubics |
// | `trace` | curves in two parameters: Newton's method across a curve (`mod.rs`), pseudo-arclength steps along it (`arclength.rs`), points beside a chord of it (`chord.rs`), zeros of test functions on it (`zero.rs`) |
// | `chebyshev.rs` | all roots of a function known from values, by Chebyshev interpolation |

pub(crate) mod adaptive;
pub(crate) mod bracket;
pub(crate) mod chebyshev;
#[cfg(feature = "structures")]
pub(crate) mod eigenvalues;
#[cfg(feature = "orbits")]
pub(crate) mod exponential;
pub(crate) mod fourier;
pub(crate) mod gauss;
pub(crate) mod interpolation;
#[cfg(feature = "structures")]
pub(crate) mod least_norm;
pub(crate) mod roots_with_slopes;
pub(crate) mod scan;
pub(crate) mod sort;
#[cfg(test)]
pub(crate) mod testing;
#[cfg(feature = "orbits")]
pub(crate) mod trace;

/// The power of two of a size ≥ 0, at least that of the smallest normal number: a unit that causes
/// no rounding, in which numbers up to this size do not overflow in sums and products.
pub(crate) fn power_of_two(size: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    f64::from_bits(size.max(f64::MIN_POSITIVE).to_bits() & EXPONENT)
}
