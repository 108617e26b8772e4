//! Eigenvalues of any real matrix.

use nalgebra::linalg::Schur;
use nalgebra::{Complex, DMatrix, DVector};

/// Sweeps for each eigenvalue; two or three are usual.
const MOST_SWEEPS: usize = 100;

/// Number of reflections of the matrix, if its eigenvalues do not converge.
const MOST_REFLECTIONS: usize = 4;

/// The eigenvalues of a square matrix, by its Schur form; `None` if it holds a number that is not
/// finite, or if they do not converge.
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
    let matrix = matrix / unit;
    let most = MOST_SWEEPS * order;
    let mut values = Schur::try_new(matrix.clone(), f64::EPSILON, most);
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

/// H M H, H = 1 − 2 v vᵀ/(vᵀv): the matrix in the basis that the reflection takes to the axes.
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
        for order in 1..=24 {
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
    fn what_is_not_finite_has_none() {
        for bad in [f64::NAN, f64::INFINITY] {
            assert_eq!(eigenvalues(DMatrix::from_element(3, 3, bad)), None);
        }
        assert_eq!(eigenvalues(DMatrix::zeros(0, 0)), Some(Vec::new()));
        let zeros = eigenvalues(DMatrix::zeros(5, 5)).unwrap();
        assert!(zeros.iter().all(|value| value.norm() == 0.0));
    }
}
