//! Minimum-norm least-squares solutions of linear systems.

use nalgebra::{DMatrix, DVector, Dyn, SVD};

/// The minimum-norm least-squares solution: singular values below a part of the largest count as 0.
pub(crate) fn least_norm(
    matrix: DMatrix<f64>,
    right: &DVector<f64>,
    singular: f64,
) -> Option<DVector<f64>> {
    let svd = decomposed(matrix, right)?;
    let least = singular * svd.singular_values.max();
    svd.solve(right, least).ok()
}

/// A decomposed matrix with its rows in units of their sizes, for many right-hand sides.
#[derive(Debug)]
pub(crate) struct LeastNorm {
    sizes: DVector<f64>,
    svd: SVD<f64, Dyn, Dyn>,
    least: f64,
}

impl LeastNorm {
    /// Singular values below a part of the largest count as 0.
    pub(crate) fn of(mut matrix: DMatrix<f64>, singular: f64) -> Option<Self> {
        let mut sizes = DVector::from_element(matrix.nrows(), 1.0);
        for (mut row, unit) in matrix.row_iter_mut().zip(sizes.iter_mut()) {
            let size = row.amax();
            if size > 0.0 {
                row /= size;
                *unit = size;
            }
        }
        let svd = decomposed(matrix, &DVector::zeros(0))?;
        let least = singular * svd.singular_values.max();
        Some(Self { sizes, svd, least })
    }

    /// The minimum-norm least-squares solution, if it is finite.
    pub(crate) fn solve(&self, right: &DVector<f64>) -> Option<DVector<f64>> {
        let right = right.component_div(&self.sizes);
        let solution = self.svd.solve(&right, self.least).ok()?;
        solution.iter().all(|x| x.is_finite()).then_some(solution)
    }
}

/// Solves the equations with their rows in units of the rows' sizes, if the solution is finite.
pub(crate) fn least_norm_by_rows(
    matrix: DMatrix<f64>,
    right: &DVector<f64>,
    singular: f64,
) -> Option<DVector<f64>> {
    LeastNorm::of(matrix, singular)?.solve(right)
}

/// The number of singular values below a part of the largest, of a matrix with its rows in units of
/// their sizes.
pub(crate) fn nullity(mut matrix: DMatrix<f64>, singular: f64) -> usize {
    for mut row in matrix.row_iter_mut() {
        let size = row.amax();
        if size > 0.0 {
            row /= size;
        }
    }
    let sweeps = 1000 * matrix.nrows();
    let values = SVD::try_new(matrix, false, false, f64::EPSILON, sweeps);
    values.map_or(0, |svd| {
        let least = singular * svd.singular_values.max();
        let values = svd.singular_values.iter();
        values.filter(|value| **value <= least).count()
    })
}

fn decomposed(matrix: DMatrix<f64>, right: &DVector<f64>) -> Option<SVD<f64, Dyn, Dyn>> {
    if !matrix.iter().chain(right).all(|x| x.is_finite()) {
        return None;
    }
    let sweeps = 1000 * matrix.nrows();
    SVD::try_new(matrix, true, true, f64::EPSILON, sweeps)
}

/// The null space of a square matrix, without the part that all left null vectors are normal to.
///
/// Rows and columns are in the same units. The first `count` unknowns belong to the first `count`
/// equations; the others, such as a period, belong to none.
struct Conserved {
    /// Left null vectors u, by columns: u·(equations) is always satisfied.
    left: DMatrix<f64>,
    /// Null vectors, by columns.
    directions: DMatrix<f64>,
    /// Matrix that gives the parts of the null vectors in a vector, from its products with u.
    parts: DMatrix<f64>,
}

impl Conserved {
    /// The least singular value of UᵀV, between unit vectors.
    const ACROSS: f64 = 1e-4;

    /// `None` if there are none.
    fn of(svd: &SVD<f64, Dyn, Dyn>, least: f64, count: usize) -> Option<Self> {
        let null = |i: &usize| svd.singular_values[*i] <= least;
        let null: Vec<usize> = (0..svd.singular_values.len()).filter(null).collect();
        if null.is_empty() {
            return None;
        }
        let left = svd.u.as_ref()?.select_columns(&null);
        let right = svd.v_t.as_ref()?.select_rows(&null).transpose();
        let across = left.rows(0, count).tr_mul(&right.rows(0, count));
        let kept = SVD::try_new(across, true, true, f64::EPSILON, 1000 * null.len())?;
        let (z, w) = (kept.u?, kept.v_t?.transpose());
        let is_kept = |i: &usize| kept.singular_values[*i] > Self::ACROSS;
        let numbers: Vec<usize> = (0..null.len()).filter(is_kept).collect();
        if numbers.is_empty() {
            return None;
        }
        let (z, w) = (z.select_columns(&numbers), w.select_columns(&numbers));
        let mut parts = z.transpose();
        for (mut row, i) in parts.row_iter_mut().zip(&numbers) {
            row /= kept.singular_values[*i];
        }
        Some(Self {
            left,
            directions: right * w,
            parts,
        })
    }

    /// The change along the null vectors that takes back what a change of the first unknowns does
    /// to the conserved quantities.
    fn restoring(&self, change: &DVector<f64>) -> DVector<f64> {
        let changed = self.left.rows(0, change.len()).tr_mul(change);
        -(&self.directions * (&self.parts * changed))
    }
}

/// The solution that changes no conserved quantity; where none determines it, the one of least
/// norm. Singular values below a part of the largest count as 0.
///
/// The equations are (M − 1)x = r with the derivative M of a map. If a quantity u·x is the same
/// after the map as before, uᵀ(M − 1) = 0: the equations determine x up to a change of this
/// quantity, and u·x = 0 keeps it.
pub(crate) fn conserving(
    matrix: DMatrix<f64>,
    right: &DVector<f64>,
    singular: f64,
    count: usize,
) -> Option<DVector<f64>> {
    let svd = decomposed(matrix, right)?;
    let least = singular * svd.singular_values.max();
    let mut solution = svd.solve(right, least).ok()?;
    let Some(conserved) = Conserved::of(&svd, least, count) else {
        return Some(solution);
    };
    let first = solution.rows(0, count).into_owned();
    solution += conserved.restoring(&first);
    Some(solution)
}

/// The change along the null directions of such equations that takes back what a change of the
/// first unknowns does to the conserved quantities; `None` if nothing is conserved.
pub(crate) fn restoring(
    matrix: DMatrix<f64>,
    change: &DVector<f64>,
    singular: f64,
) -> Option<DVector<f64>> {
    Some(conserved(matrix, singular, change.len())?.restoring(change))
}

/// The directions in which such equations have neighbouring solutions, to first order, by columns.
pub(crate) fn directions(
    matrix: DMatrix<f64>,
    singular: f64,
    count: usize,
) -> Option<DMatrix<f64>> {
    conserved(matrix, singular, count).map(|found| found.directions)
}

fn conserved(matrix: DMatrix<f64>, singular: f64, count: usize) -> Option<Conserved> {
    let svd = decomposed(matrix, &DVector::zeros(0))?;
    let least = singular * svd.singular_values.max();
    Conserved::of(&svd, least, count)
}
