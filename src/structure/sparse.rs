use nalgebra::DMatrix;

/// A square matrix row by row, its diagonal apart and without the zeros beside it: a chain of n
/// masses costs n and not n².
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sparse {
    diagonal: Vec<f64>,
    /// Where row i begins and ends in `entries`.
    spans: Vec<(usize, usize)>,
    /// Column and value.
    entries: Vec<(usize, f64)>,
}

impl Sparse {
    /// The matrix whose entry (i, j) is `scale(i, j)` times that of a dense one.
    pub(crate) fn scaled(dense: &DMatrix<f64>, scale: impl Fn(usize, usize) -> f64) -> Self {
        let n = dense.nrows();
        let mut rows: Vec<Vec<(usize, f64)>> = vec![Vec::new(); n];
        // Column by column, as it lies in memory.
        for (j, column) in dense.as_slice().chunks_exact(n).enumerate() {
            for (i, &value) in column.iter().enumerate() {
                if value != 0.0 && i != j {
                    rows[i].push((j, scale(i, j) * value));
                }
            }
        }
        let mut spans = Vec::with_capacity(n);
        let mut entries = Vec::new();
        for row in rows {
            let start = entries.len();
            entries.extend(row);
            spans.push((start, entries.len()));
        }
        let diagonal = (0..n).map(|i| scale(i, i) * dense[(i, i)]).collect();
        Self {
            diagonal,
            spans,
            entries,
        }
    }

    /// The entries on the diagonal.
    pub(crate) fn diagonal(&self) -> &[f64] {
        &self.diagonal
    }

    /// Row by row: the entry on the diagonal, and those beside it that are not 0.
    pub(crate) fn rows(&self) -> impl Iterator<Item = (f64, &[(usize, f64)])> {
        let beside = (0..self.diagonal.len()).map(|i| self.beside_diagonal(i));
        self.diagonal.iter().copied().zip(beside)
    }

    /// Column and value of the entries of a row that are not 0, but for the diagonal; columns
    /// ascend.
    #[inline]
    pub(crate) fn beside_diagonal(&self, row: usize) -> &[(usize, f64)] {
        let (start, end) = self.spans[row];
        &self.entries[start..end]
    }

    /// Largest |i − j| of an entry that is not 0.
    pub(crate) fn bandwidth(&self) -> usize {
        let rows = self.rows().enumerate();
        rows.flat_map(|(i, (_, beside))| beside.iter().map(move |&(j, _)| i.abs_diff(j)))
            .max()
            .unwrap_or(0)
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
        assert_eq!(sparse.bandwidth(), 1);
    }
}
