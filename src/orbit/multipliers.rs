//! Floquet multipliers: the eigenvalues of the monodromy matrix of a closed motion.

use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use crate::numerics::eigenvalues::{eigenvalues, reflected};
use crate::numerics::sort::sort_by;

/// The part of a vector across others, relative to it, that is rounding.
pub(super) const DEPENDENT: f64 = 1e-13;

/// The multipliers by falling modulus, without the 1 that belongs to each vector of `shifts`;
/// `None` if they do not converge.
///
/// Each row or column of zeros gives one multiplier that is exactly 0, and so does each vector of
/// `held`: the image of the matrix is normal to these vectors. The matrix is scaled by the sizes of
/// the numbers, so that units do not matter. Eigenvectors of the multiplier 1 are known, such as
/// the flow f of an autonomous motion: in an orthonormal basis (f, Q) the matrix M is block
/// triangular, and the other multipliers are the eigenvalues of QᵀMQ.
pub(super) fn multipliers(
    matrix: &DMatrix<f64>,
    shifts: &[DVector<f64>],
    held: &[DVector<f64>],
    sizes: &DVector<f64>,
) -> Option<Vec<Complex<f64>>> {
    let order = matrix.nrows();
    if !matrix.iter().all(|x| x.is_finite()) {
        return None;
    }
    let alive = alive(matrix);
    let mut scaled = DMatrix::from_fn(alive.len(), alive.len(), |i, j| {
        matrix[(alive[i], alive[j])] * (sizes[alive[j]] / sizes[alive[i]])
    });
    let vector = |row: &dyn Fn(usize) -> f64| {
        DVector::from_iterator(alive.len(), alive.iter().map(|&i| row(i)))
    };
    // In these units; the shifts last.
    let mut normals: Vec<_> = held
        .iter()
        .map(|row| vector(&|i| row[i] * sizes[i]))
        // A vector without a component in the remaining coordinates is covered by the rows of
        // zeros.
        .filter(|row| row.amax() > 0.0)
        .chain(shifts.iter().map(|shift| vector(&|i| shift[i] / sizes[i])))
        .collect();
    normals.reverse();
    let mut lengths: Vec<_> = normals.iter().map(|normal| normal.norm()).collect();
    while let (Some(normal), Some(length)) = (normals.pop(), lengths.pop()) {
        // One that depends on those before it has no direction left.
        if normal.norm() > DEPENDENT * length {
            scaled = across(&scaled, normal, &mut normals);
        }
    }
    let count = order.saturating_sub(shifts.len());
    let mut values = eigenvalues(scaled)?;
    sort_by(&mut values, |value| -value.im);
    sort_by(&mut values, |value| -value.norm_sqr());
    values.resize(count, Complex::new(0.0, 0.0));
    Some(values)
}

/// Functions of multipliers μ that change sign at a fold, the product of all 1 − μ; at a flip, that
/// of all 1 + μ; and at a Neimark-Sacker bifurcation, that of all 1 − μμ'. A product is 0 if
/// rounding, of this size, could give one of its factors any sign.
pub(super) fn tests(multipliers: &[Complex<f64>], rounding: f64) -> [f64; 3] {
    let one = Complex::new(1.0, 0.0);
    let product = |factors: &mut dyn Iterator<Item = Complex<f64>>| {
        let (mut product, mut is_rounding) = (one, false);
        for factor in factors {
            product *= factor;
            is_rounding |= factor.norm() < rounding;
        }
        if is_rounding { 0.0 } else { product.re }
    };
    let pairs = multipliers.iter().enumerate();
    let pairs = pairs.flat_map(|(i, a)| multipliers[..i].iter().map(move |b| a * b));
    [
        product(&mut multipliers.iter().map(|m| one - m)),
        product(&mut multipliers.iter().map(|m| one + m)),
        product(&mut pairs.map(|pair| one - pair)),
    ]
}

/// The coordinates that remain after those with a row or a column of zeros are removed repeatedly.
fn alive(matrix: &DMatrix<f64>) -> Vec<usize> {
    let mut alive: Vec<usize> = (0..matrix.nrows()).collect();
    loop {
        let lives = |i: usize| {
            let in_row = alive.iter().any(|&j| matrix[(i, j)] != 0.0);
            in_row && alive.iter().any(|&j| matrix[(j, i)] != 0.0)
        };
        let kept: Vec<usize> = alive.iter().copied().filter(|&i| lives(i)).collect();
        if kept.len() == alive.len() {
            return alive;
        }
        alive = kept;
    }
}

/// QᵀMQ, with Q a basis normal to a vector, by the reflection that maps it to an axis. `held`
/// becomes Qᵀ times itself.
fn across(
    matrix: &DMatrix<f64>,
    mut vector: DVector<f64>,
    others: &mut [DVector<f64>],
) -> DMatrix<f64> {
    let n = vector.len();
    let Some(first) = vector.get(0).copied() else {
        return DMatrix::zeros(0, 0);
    };
    let norm = vector.norm();
    vector[0] += if first < 0.0 { -norm } else { norm };
    for other in others.iter_mut() {
        let (part, length) = (vector.dot(other), vector.norm_squared());
        if length > 0.0 {
            other.axpy(-2.0 * part / length, &vector, 1.0);
        }
        *other = other.rows(1, n - 1).into_owned();
    }
    let reflected = reflected(matrix.clone(), &vector);
    reflected.view((1, 1), (n - 1, n - 1)).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A perturbation that returns after six periods: the QR method alone does not converge on it.
    #[test]
    fn a_cyclic_permutation_has_the_sixth_roots_of_unity() {
        let matrix = DMatrix::from_fn(6, 6, |i, j| f64::from(u8::from(i == (j + 1) % 6)));
        let sizes = DVector::from_element(6, 1.0);
        let found = multipliers(&matrix, &[], &[], &sizes).unwrap();
        for multiplier in &found {
            assert!((multiplier.powu(6) - 1.0).norm() < 1e-13, "{found:?}");
        }
        let sum: Complex<f64> = found.iter().sum();
        assert!(sum.norm() < 1e-13, "{found:?}");
        // Without the one along the flow, which is the sum of all.
        let flow = DVector::from_element(6, 0.3);
        let found = multipliers(&matrix, &[flow], &[], &sizes).unwrap();
        let sum: Complex<f64> = found.iter().sum();
        assert!(found.len() == 5 && (sum + 1.0).norm() < 1e-13, "{found:?}");
    }
}
