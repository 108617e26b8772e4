use nalgebra::DMatrix;

/// A square matrix stored row by row, with a separate diagonal and without zeros: the cost for a
/// chain of n masses is proportional to n, not n².
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sparse {
    rows: Vec<Row>,
    /// Column and value.
    entries: Vec<(usize, f64)>,
}

#[derive(Debug, Clone, PartialEq)]
struct Row {
    diagonal: f64,
    /// Begin and end of the row among the entries.
    start: usize,
    end: usize,
}

impl Sparse {
    /// The entries of a dense matrix that are not 0.
    pub(crate) fn new(dense: &DMatrix<f64>) -> Self {
        let n = dense.nrows();
        let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new(); n];
        // Column by column, as it lies in memory.
        for (j, column) in dense.as_slice().chunks_exact(n).enumerate() {
            for (i, &value) in column.iter().enumerate() {
                if value != 0.0 && i != j {
                    rows[i].push((j, value));
                }
            }
        }
        let mut entries = Vec::new();
        let rows = rows.into_iter().enumerate().map(|(i, row)| {
            let start = entries.len();
            entries.extend(row);
            Row {
                diagonal: dense[(i, i)],
                start,
                end: entries.len(),
            }
        });
        Self {
            rows: rows.collect(),
            entries,
        }
    }

    /// A diagonal matrix.
    pub(crate) fn diagonal(entries: impl Iterator<Item = f64>) -> Self {
        let row = |diagonal: f64| Row {
            diagonal,
            start: 0,
            end: 0,
        };
        Self {
            rows: entries.map(row).collect(),
            entries: Vec::new(),
        }
    }

    /// The product with a dense matrix.
    pub(crate) fn times(&self, dense: &DMatrix<f64>) -> Self {
        if self.entries.is_empty() {
            let mut product = Self::new(dense);
            for (row, by) in std::iter::zip(&mut product.rows, &self.rows) {
                row.diagonal *= by.diagonal;
                for (_, entry) in &mut product.entries[row.start..row.end] {
                    *entry *= by.diagonal;
                }
            }
            return product;
        }
        let mut product = DMatrix::zeros(dense.nrows(), dense.ncols());
        for (column, mut into) in std::iter::zip(dense.column_iter(), product.column_iter_mut()) {
            for (i, (diagonal, beside)) in self.rows().enumerate() {
                let terms = beside.iter();
                into[i] = terms.fold(diagonal * column[i], |sum, &(l, a)| sum + a * column[l]);
            }
        }
        Self::new(&product)
    }

    /// A row: its entry on the diagonal, and column and value of those beside it that are not 0, by
    /// ascending column.
    #[inline]
    pub(crate) fn row(&self, i: usize) -> (f64, &[(usize, f64)]) {
        let row = &self.rows[i];
        (row.diagonal, &self.entries[row.start..row.end])
    }

    /// Row by row.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (f64, &[(usize, f64)])> {
        (0..self.rows.len()).map(|i| self.row(i))
    }

    /// Largest |i − j| of an entry that is not 0.
    pub(crate) fn bandwidth(&self) -> usize {
        let rows = self.rows().enumerate();
        rows.flat_map(|(i, (_, beside))| beside.iter().map(move |&(j, _)| i.abs_diff(j)))
            .max()
            .unwrap_or(0)
    }
}

/// Two matrices, stored so that equal rows of both are neighbours.
#[derive(Debug, Clone)]
pub(super) struct SparsePair {
    rows: Vec<PairRow>,
    entries: Vec<(usize, f64)>,
}

#[derive(Debug, Clone)]
struct PairRow {
    diagonal: [f64; 2],
    /// Begin of the row among the entries, begin of the entries of the second matrix, and end.
    start: usize,
    middle: usize,
    end: usize,
}

impl SparsePair {
    pub(super) fn new(of: [&Sparse; 2]) -> Self {
        let mut entries = Vec::new();
        let rows = (0..of[0].rows.len()).map(|i| {
            let [(first, beside_first), (second, beside_second)] = of.map(|matrix| matrix.row(i));
            let start = entries.len();
            entries.extend(beside_first.iter().chain(beside_second));
            PairRow {
                diagonal: [first, second],
                start,
                middle: start + beside_first.len(),
                end: entries.len(),
            }
        });
        Self {
            rows: rows.collect(),
            entries,
        }
    }

    /// −(A x + B y)_i; `own` are x_i and y_i.
    #[inline(always)]
    pub(super) fn minus_products(
        &self,
        i: usize,
        own: [f64; 2],
        x: impl Fn(usize) -> f64,
        y: impl Fn(usize) -> f64,
    ) -> f64 {
        let row = &self.rows[i];
        let mut sum = -row.diagonal[1] * own[1] - row.diagonal[0] * own[0];
        for &(j, a) in &self.entries[row.start..row.middle] {
            sum -= a * x(j);
        }
        // Seldom true.
        if row.middle < row.end {
            for &(j, b) in &self.entries[row.middle..row.end] {
                sum -= b * y(j);
            }
        }
        sum
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dense(n: usize) -> DMatrix<f64> {
        DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 => 2.0 + i as f64,
            1 => -1.0 - j as f64,
            _ => 0.0,
        })
    }

    #[test]
    fn a_chain_has_two_entries_a_row_beside_the_diagonal() {
        let sparse = Sparse::new(&dense(5));
        assert_eq!(sparse.row(0), (2.0, &[(1, -2.0)][..]));
        assert_eq!(sparse.row(2), (4.0, &[(1, -2.0), (3, -4.0)][..]));
        assert_eq!(sparse.row(4), (6.0, &[(3, -4.0)][..]));
        assert_eq!(sparse.rows().count(), 5);
        assert_eq!(sparse.bandwidth(), 1);
    }

    #[test]
    fn products_of_a_pair_are_those_of_both() {
        let of = [dense(4), DMatrix::identity(4, 4)];
        let x = nalgebra::DVector::from_row_slice(&[1.0, -2.0, 0.5, 4.0]);
        let y = nalgebra::DVector::from_row_slice(&[-0.25, 3.0, 8.0, 1.0]);
        for [a, b] in [[0, 1], [1, 0], [0, 0]] {
            let pair = SparsePair::new([&Sparse::new(&of[a]), &Sparse::new(&of[b])]);
            let expected = -(&of[a] * &x + &of[b] * &y);
            for i in 0..4 {
                assert_eq!(
                    pair.minus_products(i, [x[i], y[i]], |j| x[j], |j| y[j]),
                    expected[i]
                );
            }
        }
    }

    #[test]
    fn products_are_those_of_dense_matrices() {
        let [a, b] = [dense(4), dense(4).transpose()];
        assert_eq!(Sparse::new(&a).times(&b), Sparse::new(&(a * &b)));
        let diagonal = [0.5, 2.0, 1.0, 4.0];
        let product = Sparse::diagonal(diagonal.into_iter()).times(&b);
        let matrix = DMatrix::from_diagonal(&nalgebra::DVector::from_row_slice(&diagonal));
        assert_eq!(product, Sparse::new(&(matrix * b)));
    }
}
