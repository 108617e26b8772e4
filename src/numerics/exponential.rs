//! The exponential of a matrix.

use nalgebra::{DMatrix, DVector};

use super::eigenvalues::balance;
use crate::scalar::fused;

/// Entries of a column that are computed together; the order is filled up to a multiple of it.
const LANES: usize = 8;

/// Columns that are computed together.
const COLUMNS: usize = 4;

/// A matrix A in units in which it is balanced, for e^A: the Taylor polynomial of A/2^s, squared s
/// times.
///
/// Source: A. H. Al-Mohy, N. J. Higham, *SIAM J. Sci. Comput.* 33 (2011) 488-511; the order of
/// products is that of M. S. Paterson, L. J. Stockmeyer, *SIAM J. Comput.* 2 (1973) 60-66.
pub(crate) struct Exponent {
    balanced: DMatrix<f64>,
    units: DVector<f64>,
    /// The largest sum of the sizes of the entries of a column.
    pub(crate) norm: f64,
}

impl Exponent {
    pub(crate) fn new(mut matrix: DMatrix<f64>) -> Self {
        let units = balance(&mut matrix);
        let columns = matrix.column_iter();
        let sums = columns.map(|column| column.iter().map(|x| x.abs()).sum::<f64>());
        Self {
            norm: sums.fold(0.0, f64::max),
            balanced: matrix,
            units,
        }
    }

    fn squarings(&self) -> f64 {
        /// Up to this norm the remainder of the polynomial is below rounding errors.
        const LARGEST: f64 = 2.2;
        /// More squarings overflow.
        const MOST: f64 = 1100.0;
        (self.norm / LARGEST).log2().ceil().clamp(0.0, MOST)
    }

    /// The number of products of matrices that [`exponential`](Self::exponential) takes.
    pub(crate) fn products(&self) -> f64 {
        2.0 * (POWERS - 1) as f64 + self.squarings()
    }

    /// e^A. Only products are used, so zeros are kept: where a row of A is zero, that of e^A is the
    /// row of the identity. Numbers that are not finite give NaN or infinity.
    pub(crate) fn exponential(&self) -> DMatrix<f64> {
        let order = self.balanced.nrows();
        let squarings = self.squarings();
        let filled = order.next_multiple_of(LANES);
        let mut scaled = DMatrix::zeros(filled, filled);
        let columns = std::iter::zip(self.balanced.column_iter(), scaled.column_iter_mut());
        for (column, mut part) in columns {
            part.rows_mut(0, order)
                .axpy((-squarings).exp2(), &column, 0.0);
        }
        let mut power = taylor(&scaled);
        for _ in 0..squarings as usize {
            power = product(&power, &power);
        }
        let units = &self.units;
        DMatrix::from_fn(order, order, |i, j| power[(i, j)] * (units[i] / units[j]))
    }
}

/// Number of powers, from that of exponent 0, of which blocks of the polynomial consist, and number
/// of blocks.
const POWERS: usize = 5;

/// Σ A^k/k! up to k = 24.
fn taylor(a: &DMatrix<f64>) -> DMatrix<f64> {
    let mut powers = vec![DMatrix::identity(a.nrows(), a.nrows()), a.clone()];
    while powers.len() <= POWERS {
        powers.push(product(&powers[powers.len() - 1], a));
    }
    // 1/k!
    let mut coefficients = [1.0; POWERS * POWERS];
    for k in 1..coefficients.len() {
        coefficients[k] = coefficients[k - 1] / k as f64;
    }
    let mut sum = DMatrix::zeros(a.nrows(), a.nrows());
    for (place, block) in coefficients.chunks(POWERS).enumerate().rev() {
        if place + 1 < POWERS {
            sum = product(&sum, &powers[POWERS]);
        }
        for (coefficient, power) in std::iter::zip(block, &powers).rev() {
            sum.zip_apply(power, |sum, x| *sum += coefficient * x);
        }
    }
    sum
}

/// The product of square matrices of an order that is a multiple of [`LANES`].
fn product(a: &DMatrix<f64>, b: &DMatrix<f64>) -> DMatrix<f64> {
    let mut c = DMatrix::zeros(a.nrows(), a.nrows());
    if c.is_empty() {
        return c;
    }
    fused::compute(
        &(a.as_slice(), b.as_slice(), a.nrows()),
        &mut c.as_mut_slice(),
        #[inline(always)]
        |fixed, c| multiply::<true>(*fixed, c),
        |fixed, c| multiply::<false>(*fixed, c),
    );
    c
}

#[inline(always)]
fn multiply<const CHOSEN: bool>((a, b, order): (&[f64], &[f64], usize), c: &mut [f64]) {
    let columns = std::iter::zip(
        b.chunks_exact(COLUMNS * order),
        c.chunks_exact_mut(COLUMNS * order),
    );
    for (b, c) in columns {
        for first in (0..order).step_by(LANES) {
            let mut sums = [[0.0; LANES]; COLUMNS];
            for (l, a) in a.chunks_exact(order).enumerate() {
                let (a, _) = a[first..].as_chunks::<LANES>();
                for (column, sum) in sums.iter_mut().enumerate() {
                    let x = b[column * order + l];
                    for lane in 0..LANES {
                        sum[lane] = fused::mul_add_in::<CHOSEN>(a[0][lane], x, sum[lane]);
                    }
                }
            }
            for (column, sum) in sums.iter().enumerate() {
                let begin = column * order + first;
                c[begin..begin + LANES].copy_from_slice(sum);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn exponential(matrix: DMatrix<f64>) -> DMatrix<f64> {
        Exponent::new(matrix).exponential()
    }

    /// The matrix of an oscillator with displacement, velocity, and a memory that nothing depends
    /// on, and its exponential.
    fn oscillator(omega: f64, time: f64) -> [DMatrix<f64>; 2] {
        let (sine, cosine) = (omega * time).sin_cos();
        let matrix = [
            [0.0, time, 0.0],
            [-omega * omega * time, 0.0, 0.0],
            [0.0, time, 0.0],
        ];
        let exponential = [
            [cosine, sine / omega, 0.0],
            [-omega * sine, cosine, 0.0],
            [cosine - 1.0, sine / omega, 1.0],
        ];
        [matrix, exponential].map(|rows| DMatrix::from_fn(3, 3, |i, j| rows[i][j]))
    }

    #[test]
    fn that_of_an_oscillator_is_a_rotation_in_units_of_any_size() {
        for omega in [1e-6, 1e-3, 1.0, 7.3, 1e4, 1e9] {
            for angle in [1e-9, 0.1, 0.78, 1.0, 3.0, 100.0, 1000.0] {
                let [matrix, expected] = oscillator(omega, angle / omega);
                let found = exponential(matrix);
                let units = [1.0, omega, 1.0];
                for i in 0..3 {
                    for j in 0..3 {
                        let error = found[(i, j)] - expected[(i, j)];
                        let error = error.abs() / units[i] * units[j];
                        let bound = 4.0 * f64::EPSILON * f64::max(1.0, angle);
                        assert!(error <= bound, "{omega} {angle}: {error:e} at {i}, {j}");
                    }
                }
                assert_eq!(found.column(2).as_slice(), [0.0, 0.0, 1.0]);
            }
        }
    }

    #[test]
    fn that_of_a_nilpotent_matrix_ends_and_zeros_are_kept() {
        let matrix = DMatrix::from_row_slice(2, 2, &[0.0, 1e300, 0.0, 0.0]);
        assert_eq!(
            exponential(matrix.clone()),
            matrix + DMatrix::identity(2, 2)
        );
        assert_eq!(exponential(DMatrix::zeros(0, 0)), DMatrix::zeros(0, 0));
        // Nine numbers fill a block of eight and one.
        let matrix = DMatrix::from_fn(9, 9, |i, j| if i < 8 { (i + 2 * j) as f64 } else { 0.0 });
        let found = exponential(matrix * 0.01);
        assert!((0..9).all(|j| found[(8, j)] == f64::from(j == 8)));
    }

    #[test]
    fn it_solves_the_differential_equation_of_a_full_matrix() {
        // e^A e^{−A} = 1 and e^{2A} = (e^A)², where the polynomial is taken at other places.
        let matrix = DMatrix::from_fn(20, 20, |i, j| {
            ((3 * i * i + 5 * j) % 11) as f64 / 11.0 - 0.5
        });
        for scale in [0.02, 0.3, 1.0] {
            let [plus, minus, twice] =
                [1.0, -1.0, 2.0].map(|factor| exponential(&matrix * (factor * scale)));
            let size = plus.norm() * minus.norm();
            let identity = DMatrix::identity(20, 20);
            assert!((&plus * &minus - identity).norm() < 1e-15 * size);
            assert!((&plus * &plus - &twice).norm() < 1e-15 * plus.norm().powi(2));
            // d/dt e^{At} at t = 1, by differences of fourth order.
            let at = |t: f64| exponential(&matrix * (scale * t));
            let h = 1e-3;
            let slope = (at(1.0 - 2.0 * h) - at(1.0 + 2.0 * h) + (at(1.0 + h) - at(1.0 - h)) * 8.0)
                / (12.0 * h);
            let expected = &matrix * scale * plus;
            assert!((&slope - &expected).norm() < 1e-10 * expected.norm());
        }
    }

    #[test]
    fn the_norm_does_not_depend_on_units() {
        let norm = |omega: f64| Exponent::new(oscillator(omega, 3.0 / omega)[0].clone()).norm;
        assert!(
            [1e-9, 1e-3, 1e4, 1e9]
                .iter()
                .all(|&omega| norm(omega) < 2.0 * norm(1.0))
        );
    }

    #[test]
    fn numbers_that_are_not_finite_do_not_hang() {
        for bad in [f64::NAN, f64::INFINITY, 1e300] {
            let matrix = DMatrix::from_row_slice(2, 2, &[bad, 1.0, 2.0, bad]);
            assert!(exponential(matrix).iter().any(|x| !x.is_finite()));
        }
    }
}
