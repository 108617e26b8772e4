use nalgebra::DMatrix;

/// A square matrix row by row, its diagonal apart and without the zeros beside it: a chain of n
/// masses costs n and not n².
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sparse {
    diagonal: Vec<f64>,
    /// Where row i begins in `entries`; one more than there are rows.
    starts: Vec<usize>,
    /// Column and value.
    entries: Vec<(usize, f64)>,
}

impl Sparse {
    /// The matrix whose entry (i, j) is `scale(i, j)` times that of a dense one.
    pub(crate) fn scaled(dense: &DMatrix<f64>, scale: impl Fn(usize, usize) -> f64) -> Self {
        let n = dense.nrows();
        let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new(); n];
        // Column by column, as it lies in memory.
        for (j, column) in dense.column_iter().enumerate() {
            for (i, &value) in column.iter().enumerate() {
                if i != j && value != 0.0 {
                    rows[i].push((j, scale(i, j) * value));
                }
            }
        }
        let mut starts = Vec::with_capacity(n + 1);
        let mut entries = Vec::new();
        starts.push(0);
        for row in rows {
            entries.extend(row);
            starts.push(entries.len());
        }
        let diagonal = (0..n).map(|i| scale(i, i) * dense[(i, i)]).collect();
        Self {
            diagonal,
            starts,
            entries,
        }
    }

    /// The entries on the diagonal.
    pub(crate) fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// Row by row: the entry on the diagonal, and those beside it that are not 0.
    #[inline]
    pub(crate) fn rows(&self) -> impl Iterator<Item = (f64, &[(usize, f64)])> {
        let ends = self.starts.windows(2);
        let beside = ends.map(|ends| &self.entries[ends[0]..ends[1]]);
        self.diagonal.iter().copied().zip(beside)
    }

    /// Column and value of the entries of a row that are not 0, but for the diagonal; columns
    /// ascend.
    #[inline]
    pub(crate) fn beside_diagonal(&self, row: usize) -> &[(usize, f64)] {
        &self.entries[self.starts[row]..self.starts[row + 1]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_chain_has_two_entries_a_row_beside_the_diagonal() {
        let n = 5;
        let dense = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
            0 => 2.0 + i as f64,
            1 => -1.0 - j as f64,
            _ => 0.0,
        });
        let sparse = Sparse::scaled(&dense, |i, j| if i == j { 1.0 } else { 10.0 });
        assert_eq!(sparse.diagonal(), [2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(sparse.beside_diagonal(0), [(1, -20.0)]);
        assert_eq!(sparse.beside_diagonal(2), [(1, -20.0), (3, -40.0)]);
        assert_eq!(sparse.beside_diagonal(4), [(3, -40.0)]);
    }
}
