use nalgebra::DMatrix;

/// A square matrix row by row, its diagonal apart and without the zeros beside it: a chain of n
/// masses costs n and not n².
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Sparse {
    rows: Vec<Row>,
    /// Column and value.
    entries: Vec<(usize, f64)>,
}

#[derive(Debug, Clone, PartialEq)]
struct Row {
    diagonal: f64,
    /// Where it begins and ends in the entries.
    start: usize,
    end: usize,
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
        let mut entries = Vec::new();
        let rows = rows.into_iter().enumerate().map(|(i, row)| {
            let start = entries.len();
            entries.extend(row);
            Row {
                diagonal: scale(i, i) * dense[(i, i)],
                start,
                end: entries.len(),
            }
        });
        Self {
            rows: rows.collect(),
            entries,
        }
    }

    /// Number of rows.
    pub(crate) fn len(&self) -> usize {
        self.rows.len()
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
        assert_eq!(sparse.row(0), (2.0, &[(1, -20.0)][..]));
        assert_eq!(sparse.row(2), (4.0, &[(1, -20.0), (3, -40.0)][..]));
        assert_eq!(sparse.row(4), (6.0, &[(3, -40.0)][..]));
        assert_eq!(sparse.len(), n);
        assert_eq!(sparse.bandwidth(), 1);
    }
}
