//! The forces in several sticking contacts at once: G λ = b, with the compliance G of the masses at
//! the contacts.

/// The rounding error of a sum, in parts of the sizes of its terms.
pub(super) const ROUNDING: f64 = 8.0 * f64::EPSILON;

/// The Cholesky factor of a symmetric positive definite matrix with a unit diagonal, row by row
/// from each row's first entry that is not 0: the cost of a chain of contacts is proportional to
/// its length.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Factor {
    rows: Vec<Row>,
}

/// Sticking contacts that share coordinates and whose directions are independent, with the factor
/// of their G.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Holding {
    pub(crate) contacts: Vec<usize>,
    pub(crate) factor: Factor,
}

/// A coordinate whose velocity follows from contacts at rest, and the velocities of others:
/// own v + Σ others v_j = Σ surfaces w_c.
#[derive(Debug, Clone)]
pub(super) struct Pivot {
    pub(super) coordinate: usize,
    pub(super) own: f64,
    pub(super) others: Vec<(usize, f64)>,
    pub(super) surfaces: Vec<(usize, f64)>,
}

impl Pivot {
    /// v, from the velocities of surfaces and of the other coordinates.
    pub(super) fn velocity(
        &self,
        surface: impl Fn(usize) -> f64,
        other: impl Fn(usize) -> f64,
    ) -> f64 {
        let carried = self.surfaces.iter().map(|&(c, part)| part * surface(c));
        let others = self.others.iter().map(|&(j, b)| b * other(j));
        (carried.sum::<f64>() - others.sum::<f64>()) / self.own
    }
}

#[derive(Debug, Clone, PartialEq)]
struct Row {
    /// Column of the first entry.
    first: usize,
    /// The entries from there to the diagonal.
    entries: Vec<f64>,
}

impl Factor {
    /// Factorises the matrix of which row i has these entries left of its diagonal, by column.
    ///
    /// # Errors
    ///
    /// The number of the first row that depends on the rows before it, within rounding.
    pub(crate) fn new(rows: &mut dyn Iterator<Item = Vec<(usize, f64)>>) -> Result<Self, usize> {
        Self::with_diagonal(&|_| 1.0, rows)
    }

    /// Factorises a matrix with another diagonal, by the number of the row.
    ///
    /// # Errors
    ///
    /// The errors of [`new`](Self::new).
    pub(crate) fn with_diagonal(
        diagonal: &dyn Fn(usize) -> f64,
        rows: &mut dyn Iterator<Item = Vec<(usize, f64)>>,
    ) -> Result<Self, usize> {
        let mut factor = Self::default();
        // Bounds of the rounding error of each entry, to distinguish a small diagonal from 0.
        let mut errors: Vec<Row> = Vec::new();
        for (i, beside) in rows.enumerate() {
            let first = beside.iter().map(|&(j, _)| j).min().unwrap_or(i);
            let mut entries = vec![0.0; i + 1 - first];
            for (j, value) in beside {
                entries[j - first] = value;
            }
            let mut moved = vec![0.0; i + 1 - first];
            let diagonal = diagonal(i);
            let (mut square, mut square_moved) = (diagonal, ROUNDING * diagonal);
            for j in first..i {
                let (other, other_moved) = (&factor.rows[j], &errors[j]);
                let (mut rest, mut error) = (entries[j - first], ROUNDING);
                for l in first.max(other.first)..j {
                    let own = entries[l - first];
                    rest -= own * other.entry(l);
                    error += moved[l - first] * other.entry(l).abs();
                    error += own.abs() * other_moved.entry(l);
                }
                let diagonal = other.entry(j);
                let entry = rest / diagonal;
                error = (error + entry.abs() * other_moved.entry(j)) / diagonal;
                entries[j - first] = entry;
                moved[j - first] = error;
                square -= entry * entry;
                square_moved += 2.0 * entry.abs() * error + error * error;
            }
            if square.is_nan() || square <= square_moved {
                return Err(i);
            }
            let root = square.sqrt();
            entries[i - first] = root;
            // Of the root, half as much in proportion: twice that would double along a chain.
            moved[i - first] = square_moved / (root + (square - square_moved).sqrt());
            factor.rows.push(Row { first, entries });
            errors.push(Row {
                first,
                entries: moved,
            });
        }
        Ok(factor)
    }

    /// Solves in place.
    pub(crate) fn solve(&self, x: &mut [f64]) {
        self.solve_all(x.as_chunks_mut::<1>().0);
    }

    /// Solves for several right-hand sides, side by side.
    pub(crate) fn solve_all<const W: usize>(&self, x: &mut [[f64; W]]) {
        for (i, row) in self.rows.iter().enumerate() {
            let mut sum = [0.0; W];
            for j in row.first..i {
                for (sum, x) in std::iter::zip(&mut sum, x[j]) {
                    *sum += row.entry(j) * x;
                }
            }
            for (x, sum) in std::iter::zip(&mut x[i], sum) {
                *x = (*x - sum) / row.entry(i);
            }
        }
        for (i, row) in self.rows.iter().enumerate().rev() {
            for x in &mut x[i] {
                *x /= row.entry(i);
            }
            let solved = x[i];
            for j in row.first..i {
                for (x, solved) in std::iter::zip(&mut x[j], solved) {
                    *x -= row.entry(j) * solved;
                }
            }
        }
    }

    /// A bound of |G⁻¹| x for x ≥ 0, in place: how far rounding errors of the right-hand side may
    /// move the solution.
    pub(crate) fn magnify(&self, x: &mut [f64]) {
        for (i, row) in self.rows.iter().enumerate() {
            let products = (row.first..i).map(|j| row.entry(j).abs() * x[j]);
            x[i] = (x[i] + products.sum::<f64>()) / row.entry(i);
        }
        for (i, row) in self.rows.iter().enumerate().rev() {
            x[i] /= row.entry(i);
            for j in row.first..i {
                x[j] += row.entry(j).abs() * x[i];
            }
        }
    }
}

impl Row {
    fn entry(&self, column: usize) -> f64 {
        self.entries[column - self.first]
    }
}

#[cfg(test)]
mod tests {
    use super::Factor;

    fn rows(n: usize, entry: impl Fn(usize, usize) -> f64) -> Vec<Vec<(usize, f64)>> {
        let entry = &entry;
        let row = |i: usize| {
            (0..i)
                .map(move |j| (j, entry(i, j)))
                .filter(|(_, g)| *g != 0.0)
        };
        (0..n).map(|i| row(i).collect()).collect()
    }

    /// (G x)_i of the chain 1 on the diagonal, −1/2 beside it.
    fn chain(x: &[f64], i: usize) -> f64 {
        let at = |i: Option<&f64>| i.copied().unwrap_or(0.0);
        x[i] - 0.5 * (at(x.get(i + 1)) + at(i.checked_sub(1).and_then(|i| x.get(i))))
    }

    #[test]
    fn a_chain_is_solved_with_two_entries_a_row() {
        let n = 50;
        let g = |i: usize, j: usize| if i.abs_diff(j) == 1 { -0.5 } else { 0.0 };
        let factor = Factor::new(&mut rows(n, g).into_iter()).unwrap();
        assert!(factor.rows.iter().all(|row| row.entries.len() <= 2));
        let b: Vec<f64> = (0..n).map(|i| (i as f64).sin()).collect();
        let mut x = b.clone();
        factor.solve(&mut x);
        for (i, b) in b.iter().enumerate() {
            assert!((chain(&x, i) - b).abs() < 1e-12);
        }
        // All entries of its inverse are positive: the bound is exact.
        let [mut bound, mut exact] = [vec![1.0; n], vec![1.0; n]];
        factor.magnify(&mut bound);
        factor.solve(&mut exact);
        for (bound, exact) in bound.iter().zip(exact) {
            assert!((bound / exact - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn long_chains_are_independent() {
        let g = |i: usize, j: usize| if i.abs_diff(j) == 1 { -0.5 } else { 0.0 };
        assert!(Factor::new(&mut rows(1000, g).into_iter()).is_ok());
        // Closed to a ring by one that moves as all of them together.
        let n = 30;
        let ring = |i: usize, j: usize| match i - j {
            1 => -0.5,
            _ if j == 0 && i == n - 1 => -0.5,
            _ => 0.0,
        };
        assert_eq!(Factor::new(&mut rows(n, ring).into_iter()), Err(n - 1));
    }

    #[test]
    fn rows_that_depend_on_others_are_found() {
        // Unit vectors at these angles have the products cos(a − b): three lie in a plane.
        let angles = [0.0_f64, 0.3, 1.9];
        let g = |i: usize, j: usize| (angles[i] - angles[j]).cos();
        assert_eq!(Factor::new(&mut rows(3, g).into_iter()), Err(2));
        assert!(Factor::new(&mut rows(2, g).into_iter()).is_ok());
        let same = |_: usize, _: usize| 1.0;
        assert_eq!(Factor::new(&mut rows(2, same).into_iter()), Err(1));
        assert_eq!(
            Factor::new(&mut rows(1, |_, _| f64::NAN).into_iter())
                .unwrap()
                .rows
                .len(),
            1
        );
        assert_eq!(
            Factor::new(&mut rows(2, |_, _| f64::NAN).into_iter()),
            Err(1)
        );
    }
}
