//! Eigenvalues of any real matrix, and units in which its rows and columns are of one size.

use nalgebra::linalg::Schur;
use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::sort::sort_by;

/// Sweeps for each eigenvalue; two or three are usual.
const MOST_SWEEPS: usize = 100;

/// Number of reflections of the matrix, if its eigenvalues do not converge.
const MOST_REFLECTIONS: usize = 4;

/// The eigenvalues of a square matrix, by its Schur form; `None` if it holds a number that is not
/// finite, or if they do not converge.
///
/// Eigenvalues that are smaller than the largest by many powers of ten, such as those of a fault
/// beside the rate at which its speed settles, keep their digits if rows and columns are balanced:
/// the QR method finds small eigenvalues at the end, where rows are smallest, and an entry below
/// the diagonal counts as 0 only below ε² of its neighbours, since the entry above the diagonal may
/// be larger by 1/ε.
///
/// The double-shift QR method does not converge for orthogonal Hessenberg matrices, such as that of
/// a cyclic permutation, because their shifts are 0. The same matrix in another orthonormal basis,
/// reflected across some vector, has the same eigenvalues and another Hessenberg form.
pub(crate) fn eigenvalues(matrix: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    if !matrix.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let order = matrix.nrows();
    if order == 0 {
        return Some(Vec::new());
    }
    // Products of two entries must not overflow; a power of two changes no digit.
    let unit = matrix.amax().log2().round().clamp(-1000.0, 1000.0).exp2();
    let matrix = graded(&(matrix / unit));
    let most = MOST_SWEEPS * order;
    let mut values = Schur::try_new(matrix.clone(), f64::EPSILON.powi(2), most);
    for i in 0..MOST_REFLECTIONS {
        if values.is_some() {
            break;
        }
        // Any vector will do that is not special.
        let vector = DVector::from_fn(order, |j, _| ((i + 1) * (j + 1)) as f64 % 1.618 + 0.1);
        values = Schur::try_new(reflected(matrix.clone(), &vector), f64::EPSILON, most);
    }
    let values = values?.complex_eigenvalues();
    Some(values.iter().map(|value| value * unit).collect())
}

/// The matrix with its rows and columns in the order of the largest entries of its rows.
fn graded(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let sizes: Vec<f64> = matrix.row_iter().map(|row| row.amax()).collect();
    let mut order: Vec<usize> = (0..sizes.len()).collect();
    sort_by(&mut order, |&i| -sizes[i]);
    DMatrix::from_fn(order.len(), order.len(), |i, j| {
        matrix[(order[i], order[j])]
    })
}

/// The left and the right eigenvector u and w of a simple eigenvalue s, uᴴ A = s uᴴ and A w = s w,
/// of length 1; `None` if a number overflows.
///
/// Inverse iteration: the factors of A − s keep the digits of small rows, which a singular value
/// decomposition loses beside large ones.
pub(crate) fn eigenvectors(
    matrix: &DMatrix<f64>,
    value: Complex<f64>,
) -> Option<[DVector<Complex<f64>>; 2]> {
    /// Two are enough if the eigenvalue is known to rounding.
    const ITERATIONS: usize = 4;
    let order = matrix.nrows();
    // Off the eigenvalue by little more than rounding, so that no pivot is 0.
    let shift = value * (1.0 + 16.0 * f64::EPSILON);
    let shifted = DMatrix::from_fn(order, order, |i, j| {
        let shift = if i == j { shift } else { Complex::ZERO };
        matrix[(i, j)] - shift
    });
    let adjoint = shifted.adjoint().lu();
    let factors = shifted.lu();
    let any = |i: usize, _| Complex::cis((1.0 + i as f64).sqrt());
    let mut vectors = [(); 2].map(|()| DVector::from_fn(order, any).normalize());
    for _ in 0..ITERATIONS {
        for (vector, factors) in std::iter::zip(&mut vectors, [&adjoint, &factors]) {
            let solved = factors.solve(vector)?;
            let unit = solved.camax();
            *vector = (solved / Complex::from(unit)).normalize();
        }
    }
    let is_finite = vectors.iter().flatten().all(|x| x.is_finite());
    is_finite.then_some(vectors)
}

/// Returns true if the real part of an eigenvalue is at most a part of its terms: its sign is one
/// of rounding, or nearly so.
///
/// A relative change ε of each entry changes an eigenvalue by at most ε |u|ᵀ|A||w|/|uᴴw|, with its
/// left and right eigenvectors u and w, in any units of rows and columns. This size is much smaller
/// than the largest eigenvalue if the eigenvalue is one of slow motions beside fast ones.
///
/// Source: A. J. Geurts, *Numer. Math.* 39 (1982) 85-96.
pub(crate) fn is_neutral(
    matrix: &DMatrix<f64>,
    values: &[Complex<f64>],
    value: Complex<f64>,
    part: f64,
) -> bool {
    let largest = values.iter().map(|value| value.norm()).fold(0.0, f64::max);
    let real = value.re.abs();
    if real > part * largest {
        return false;
    }
    // No more than the terms.
    if real <= part * value.norm() {
        return true;
    }
    let Some([u, w]) = eigenvectors(matrix, value) else {
        return true;
    };
    let [sizes, along] = [&u, &w].map(|x| x.map(|x| x.norm()));
    let terms = sizes.dot(&(matrix.abs() * along)) / u.dotc(&w).norm();
    // Where the vectors are too nearly normal for a size, nothing is known of the sign.
    real <= part * terms || terms.is_nan()
}

/// The number of eigenvalues in the right half plane, with those of rounding left out.
pub(crate) fn growing(matrix: &DMatrix<f64>, values: &[Complex<f64>], part: f64) -> usize {
    let grows =
        |value: &&Complex<f64>| value.re > 0.0 && !is_neutral(matrix, values, **value, part);
    values.iter().filter(grows).count()
}

/// Changes a matrix M to D⁻¹ M D, where the diagonal of D, the result, holds the powers of two for
/// which each row is about as large as its column: nothing is rounded. Units that are out of the
/// range of numbers stay as they are.
///
/// Source: E. E. Osborne, *J. ACM* 7 (1960) 338-345; the condition to go on is that of B. N.
/// Parlett, C. Reinsch, *Numer. Math.* 13 (1969) 293-304.
pub(crate) fn balance(matrix: &mut DMatrix<f64>) -> DVector<f64> {
    let order = matrix.nrows();
    let mut units = DVector::repeat(order, 1.0);
    for _ in 0..MOST_SWEEPS {
        let mut changed = false;
        for i in 0..order {
            // The largest sizes: a sum of squares could overflow.
            let others = || (0..order).filter(|j| *j != i);
            let column = others().fold(0.0_f64, |size, j| size.max(matrix[(j, i)].abs()));
            let row = others().fold(0.0_f64, |size, j| size.max(matrix[(i, j)].abs()));
            let unit = (0.5 * (row.log2() - column.log2())).round().exp2();
            let all = units[i] * unit;
            if !(all.is_normal() && all.recip().is_normal() && unit.recip().is_normal()) {
                continue;
            }
            if column * unit + row / unit < 0.95 * (column + row) {
                changed = true;
                units[i] = all;
                matrix.column_mut(i).scale_mut(unit);
                matrix.row_mut(i).unscale_mut(unit);
            }
        }
        if !changed {
            break;
        }
    }
    units
}

/// Returns H M H with the reflection H = 1 − 2 v vᵀ/(vᵀv): the matrix in the basis that H takes to
/// the axes.
pub(crate) fn reflected(mut matrix: DMatrix<f64>, vector: &DVector<f64>) -> DMatrix<f64> {
    let length = vector.norm_squared();
    if length > 0.0 {
        let row = vector.transpose() * &matrix;
        matrix -= vector * row * (2.0 / length);
        let column = &matrix * vector;
        matrix -= column * vector.transpose() * (2.0 / length);
    }
    matrix
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::*;
    use crate::numerics::testing::count;

    /// The largest distance of a value from the one that is expected next to it.
    fn apart(mut found: Vec<Complex<f64>>, expected: &[Complex<f64>]) -> f64 {
        assert_eq!(found.len(), expected.len());
        let nearest = |found: &mut Vec<Complex<f64>>, to: &Complex<f64>| {
            let distances = found.iter().map(|value| (value - to).norm());
            let (i, distance) = distances
                .enumerate()
                .min_by(|a, b| a.1.total_cmp(&b.1))
                .unwrap();
            found.swap_remove(i);
            distance
        };
        let distances = expected.iter().map(|to| nearest(&mut found, to));
        distances.fold(0.0, f64::max)
    }

    fn cyclic(order: usize, sign: f64) -> DMatrix<f64> {
        DMatrix::from_fn(order, order, |i, j| match (i, j) {
            (0, j) if j == order - 1 => sign,
            (i, j) if i == j + 1 => 1.0,
            _ => 0.0,
        })
    }

    #[test]
    fn cyclic_permutations_have_the_roots_of_unity() {
        for order in 1..=count(14, 24).min(24) {
            for (sign, begin) in [(1.0, 0.0), (-1.0, 0.5)] {
                let angles = (0..order).map(|k| TAU * (k as f64 + begin) / order as f64);
                let expected: Vec<_> = angles.map(Complex::cis).collect();
                for size in [1.0, 1e-200, 1e200] {
                    let found = eigenvalues(cyclic(order, sign) * size).unwrap();
                    let expected: Vec<_> = expected.iter().map(|root| root * size).collect();
                    let worst = apart(found, &expected) / size;
                    assert!(worst < 1e-13, "{order}, {sign}: {worst:e}");
                }
            }
        }
    }

    #[test]
    fn rows_and_columns_are_balanced() {
        // Units from 1 to 1e240 of a matrix of ordinary numbers.
        let plain = DMatrix::from_fn(4, 4, |i, j| 1.0 + ((3 * i + 5 * j) % 7) as f64);
        let unit = |i: usize| (200.0 * i as f64).exp2();
        let mut matrix = DMatrix::from_fn(4, 4, |i, j| plain[(i, j)] * (unit(i) / unit(j)));
        let scaled = matrix.clone();
        let units = balance(&mut matrix);
        for i in 0..4 {
            for j in 0..4 {
                assert_eq!(matrix[(i, j)], scaled[(i, j)] / units[i] * units[j]);
                let ratio = matrix[(i, j)] / plain[(i, j)];
                assert!((0.1..10.0).contains(&ratio), "{i}, {j}: {ratio:e}");
            }
        }
    }

    /// Numbers whose squares overflow or vanish, rows and columns of zeros, and what is not finite.
    #[test]
    fn any_matrix_is_balanced_in_the_end() {
        let numbers = [
            0.0,
            1.0,
            -1e200,
            1e308,
            1e-200,
            5e-324,
            f64::INFINITY,
            f64::NAN,
        ];
        for first in 0..512 {
            for step in 1..8 {
                let number =
                    |i: usize, j: usize| numbers[(first / (1 + i) + step * (i + 2 * j)) % 8];
                let mut matrix = DMatrix::from_fn(3, 3, number);
                let units = balance(&mut matrix);
                assert!(units.iter().all(|unit| unit.is_normal()), "{first}, {step}");
            }
        }
    }

    /// x' = v, v' = −k x − d v + c y, y' = v − l y: for a large d, v settles at this rate, and what
    /// is left is slower by d². On the imaginary axis if (d + l)(k + d l − c) = k l.
    #[test]
    fn slow_eigenvalues_keep_their_digits_beside_fast_ones() {
        for decades in 0..10 {
            let l = 1.25e-7 * 10_f64.powi(-decades);
            let d: f64 = 15.0 / l;
            let frequency = 0.7 * l;
            let k = frequency.powi(2) * (d + l) / l;
            let c = k + d * l - frequency.powi(2);
            let mut matrix =
                DMatrix::from_row_slice(3, 3, &[0.0, 1.0, 0.0, -k, -d, c, 0.0, 1.0, -l]);
            let _ = balance(&mut matrix);
            let values = eigenvalues(matrix.clone()).unwrap();
            let pair: Vec<_> = values.iter().filter(|value| value.norm() < 1.0).collect();
            assert_eq!(pair.len(), 2, "{values:?}");
            for value in &pair {
                // Each entry has an error of ε; c is one of d l.
                assert!(value.re.abs() < 1e-14 * frequency, "{l:e}: {value}");
                assert!((value.im.abs() / frequency - 1.0).abs() < 1e-14, "{value}");
                assert!(is_neutral(&matrix, &values, **value, 1e-12));
            }
            // Moved off the axis by a millionth of the frequency.
            let mut moved = matrix.clone();
            moved[(2, 2)] += 2e-6 * frequency;
            let values = eigenvalues(moved.clone()).unwrap();
            assert_eq!(growing(&moved, &values, 1e-10), 2, "{values:?}");
            let [u, w] = eigenvectors(&matrix, Complex::new(0.0, pair[0].im)).unwrap();
            let off = &matrix.map(Complex::from) * &w - &w * Complex::new(0.0, pair[0].im);
            let terms = matrix.abs() * w.map(|x| x.norm());
            for (off, terms) in std::iter::zip(&off, &terms) {
                assert!(off.norm() < 1e-13 * terms, "{off} {terms:e}");
            }
            assert!(u.iter().chain(&w).all(|x| x.is_finite()));
        }
    }

    #[test]
    fn what_is_not_finite_has_none() {
        for bad in [f64::NAN, f64::INFINITY] {
            assert_eq!(eigenvalues(DMatrix::from_element(3, 3, bad)), None);
        }
        assert_eq!(eigenvalues(DMatrix::zeros(0, 0)), Some(Vec::new()));
        let zeros = eigenvalues(DMatrix::zeros(5, 5)).unwrap();
        assert!(zeros.iter().all(|value| value.norm() == 0.0));
    }
}
