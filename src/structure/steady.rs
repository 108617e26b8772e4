use nalgebra::{Complex, DMatrix, DVector};

use super::Structure;
use super::model::Support;
use crate::drive::Drive;
use crate::friction::memory::{ContactLaw, Sliding, Slip};
use crate::friction::piece_above;
use crate::numerics::eigenvalues::eigenvalues as eigenvalues_of;
use crate::state::Direction;

/// Steady sliding of a [`Structure`]: every mass stands still while the belts move, and how small
/// motions about that go.
///
/// ```text
/// K q = f + Σ_i e_i N_i sgn(w_i) μ̂_i(|w_i|),    N_i = N0_i + Σ_j n_ij q_j
/// M δq'' + (C + diag(N_i dμ̂_i/ds)) δq' + (K − Σ_i e_i sgn(w_i) μ̂_i n_iᵀ) δq = 0
/// ```
///
/// Contacts that remember, as bristles do, hold the memory at which z' = 0; its deviations join
/// those of the masses: −N_i Σ_j ∂μ_i/∂z_j δz_j on the right, and δz' linear in δz and δq'.
///
/// The load that follows the displacements makes the stiffness matrix unsymmetric: two modes can
/// merge and one of them grow (flutter by mode coupling), even where friction does not fall with
/// speed.
///
/// Eigenvalues are by the Schur form of the 2n × 2n matrix of the scaled system, good to about nε
/// times the largest; where two of them are nearly equal, to the root of that. With memory the
/// matrix has a row more for each number. Work grows as n³: a second for n = 100, minutes for 1000.
///
/// ```
/// use stick_slip::nalgebra::DMatrix;
/// use stick_slip::{Contact, Coulomb, Structure};
///
/// // The model of N. Hoffmann et al. (2002): a normal spring of stiffness 4/3 carries the load.
/// let brake = |coefficient: f64| {
///     Structure::new(&[1.0, 1.0])?
///         .with_stiffness(DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]))?
///         .with_contact(
///             Contact::new(0, Coulomb::new(coefficient, coefficient)?, 10.0)?
///                 .with_load_gradient(1, 4.0 / 3.0)?
///                 .on_belt(1.0),
///         )
/// };
/// // The modes merge at μ = 3/4, and beyond one grows.
/// let growth = |coefficient| Some(brake(coefficient).ok()?.steady_sliding()?.eigenvalues[0].re);
/// assert_eq!(growth(0.74), Some(0.0));
/// assert!(growth(0.76) > Some(0.01));
/// # Ok::<(), stick_slip::Error>(())
/// ```
///
/// Source of the example: Hoffmann, Fischer, Allgaier and Gaul, *Mech. Res. Commun.* 29 (2002)
/// 197-205.
#[derive(Debug, Clone, PartialEq)]
pub struct SteadySliding {
    /// Displacement of each coordinate.
    pub displacements: Vec<f64>,
    /// Eigenvalues of small motions, by falling real part, and for equal ones by falling imaginary
    /// part; two for each coordinate and one for each number that a contact remembers, per unit of
    /// time. What slip neither changes nor asks for, as the clock of rest of a
    /// [`Dwell`](crate::Dwell), is −∞: nothing is left of a deviation.
    pub eigenvalues: Vec<Complex<f64>>,
}

impl SteadySliding {
    /// Whether small motions die out: all eigenvalues have negative real parts.
    pub fn is_stable(&self) -> bool {
        self.eigenvalues
            .iter()
            .all(|eigenvalue| eigenvalue.re < 0.0)
    }

    pub(super) fn of<const Z: usize, L: ContactLaw<Z>>(
        structure: &Structure<L, Z>,
    ) -> Option<Self> {
        if !structure.drives().all(|drive| drive.is_constant()) {
            return None;
        }
        let contacts = structure.contacts().iter().map(|contact| {
            let velocity = contact.belt_velocity().value(0.0);
            let direction = Direction::of(-velocity)?.sign();
            let speed = velocity.abs();
            let slip = Slip {
                speed,
                direction,
                piece: piece_above(contact.law().breakpoints(), speed),
            };
            let sliding = Sliding::of(contact.law(), slip)?;
            Some((contact.support(), sliding, direction))
        });
        let contacts: Vec<_> = contacts.collect::<Option<_>>()?;
        Self::with(
            structure.masses(),
            [structure.stiffness().clone(), structure.damping().clone()],
            structure.forces(),
            &contacts,
        )
    }

    /// Of contacts that slide so, each in a direction.
    fn with(
        masses: &[f64],
        [mut stiffness, mut damping]: [DMatrix<f64>; 2],
        forces: &[Drive],
        contacts: &[(Support<'_>, Sliding, f64)],
    ) -> Option<Self> {
        let n = masses.len();
        let mut forces = DVector::from_iterator(n, forces.iter().map(|force| force.value(0.0)));
        for (contact, sliding, _) in contacts {
            let i = contact.coordinate;
            forces[i] -= contact.load.value(0.0) * sliding.coefficient;
            for &(j, gradient) in contact.load_gradient {
                stiffness[(i, j)] += sliding.coefficient * gradient;
            }
        }
        // In √m q both matrices have units of time alone, and keep their symmetry if they have it.
        let roots: Vec<f64> = masses.iter().map(|mass| mass.sqrt()).collect();
        let scale = |matrix: &mut DMatrix<f64>| {
            for ((i, j), entry) in (0..n)
                .flat_map(|j| (0..n).map(move |i| (i, j)))
                .zip(matrix.iter_mut())
            {
                *entry = *entry / roots[i] / roots[j];
            }
        };
        scale(&mut stiffness);
        for (force, root) in forces.iter_mut().zip(&roots) {
            *force /= root;
        }
        let displacements = solve(&stiffness, &forces)?;
        let displacements: Vec<f64> = displacements
            .iter()
            .zip(&roots)
            .map(|(y, root)| y / root)
            .collect();
        let mut memories = Vec::new();
        let mut idle = 0;
        for (contact, sliding, direction) in contacts {
            let load = contact.load_at(0.0, &displacements);
            if load.is_nan() || load <= 0.0 {
                return None;
            }
            let i = contact.coordinate;
            damping[(i, i)] += load * direction * sliding.slope;
            // As the velocity of √m q has it.
            let memory = Memory::of(sliding, i, load / roots[i], direction / roots[i]);
            idle += sliding.by_memory.len() - memory.matrix.nrows();
            memories.push(memory);
        }
        scale(&mut damping);
        let mut eigenvalues = eigenvalues(&stiffness, &damping, &memories)?;
        let forgotten = Complex::new(f64::NEG_INFINITY, 0.0);
        eigenvalues.extend(std::iter::repeat_n(forgotten, idle));
        Some(Self {
            displacements,
            eigenvalues,
        })
    }
}

/// Deviations of what one contact remembers, but for what slip has nothing to do with.
struct Memory {
    coordinate: usize,
    /// ∂z_i'/∂z_j.
    matrix: DMatrix<f64>,
    /// What z does to the velocity of the coordinate, and that velocity to z.
    acts: Vec<f64>,
    driven: Vec<f64>,
}

impl Memory {
    fn of(sliding: &Sliding, coordinate: usize, load: f64, direction: f64) -> Self {
        let remembered = 0..sliding.by_memory.len();
        let numbers: Vec<usize> = remembered.filter(|&j| !sliding.is_idle(j)).collect();
        let count = numbers.len();
        let acts = numbers.iter().map(|&j| -load * sliding.by_memory[j]);
        let driven = numbers
            .iter()
            .map(|&j| direction * sliding.rates_by_speed[j]);
        let (mut acts, mut driven): (Vec<f64>, Vec<f64>) = (acts.collect(), driven.collect());
        let entry = |i: usize, j: usize| sliding.rates_by_memory[(numbers[i], numbers[j])];
        let mut matrix = DMatrix::from_fn(count, count, entry);
        // In units in which z acts on the velocity as strongly as that on z.
        for j in 0..count {
            let unit = (driven[j] / acts[j]).abs().sqrt();
            if unit > 0.0 && unit.is_finite() {
                acts[j] *= unit;
                driven[j] /= unit;
                matrix.row_mut(j).unscale_mut(unit);
                matrix.column_mut(j).scale_mut(unit);
            }
        }
        Self {
            coordinate,
            matrix,
            acts,
            driven,
        }
    }
}

/// The solution of A x = b; `None` if A is singular to rounding.
fn solve(a: &DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let largest = a.amax();
    let lu = a.clone().lu();
    let pivots = lu.u().diagonal();
    let least = f64::EPSILON * a.nrows() as f64 * largest;
    if !pivots.iter().all(|pivot| pivot.abs() > least) {
        return None;
    }
    lu.solve(b).filter(|x| x.iter().all(|x| x.is_finite()))
}

/// Eigenvalues s of s² + s C + K and what contacts remember, by falling real part; `None` if they
/// do not converge.
fn eigenvalues(
    stiffness: &DMatrix<f64>,
    damping: &DMatrix<f64>,
    memories: &[Memory],
) -> Option<Vec<Complex<f64>>> {
    let n = stiffness.nrows();
    let remembered: usize = memories.iter().map(|memory| memory.matrix.nrows()).sum();
    let mut values: Vec<Complex<f64>> = if damping.amax() == 0.0 && remembered == 0 {
        // s² = −λ of K alone: what is undamped has a real part of exactly 0.
        let squares = eigenvalues_of(stiffness.clone())?;
        squares
            .iter()
            .map(|&square| (-square).sqrt())
            .flat_map(|root| [root, -root])
            .collect()
    } else {
        // (ω q, q', z) for (q, q', z): blocks of one size.
        let unit = stiffness.amax().sqrt();
        let unit = if unit > 0.0 { unit } else { 1.0 };
        let mut matrix = DMatrix::zeros(2 * n + remembered, 2 * n + remembered);
        matrix.view_mut((0, n), (n, n)).fill_diagonal(unit);
        matrix
            .view_mut((n, 0), (n, n))
            .copy_from(&(stiffness / -unit));
        matrix.view_mut((n, n), (n, n)).copy_from(&-damping);
        let mut start = 2 * n;
        for memory in memories {
            let count = memory.matrix.nrows();
            let place = (start, start);
            matrix
                .view_mut(place, (count, count))
                .copy_from(&memory.matrix);
            for j in 0..count {
                matrix[(n + memory.coordinate, start + j)] = memory.acts[j];
                matrix[(start + j, n + memory.coordinate)] = memory.driven[j];
            }
            start += count;
        }
        eigenvalues_of(matrix)?
    };
    // No −0, which would sort after 0.
    for value in &mut values {
        *value += Complex::new(0.0, 0.0);
    }
    values.sort_by(|a, b| b.re.total_cmp(&a.re).then(b.im.total_cmp(&a.im)));
    Some(values)
}
