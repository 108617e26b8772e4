use nalgebra::{DMatrix, DVector};
use num_complex::Complex;

use super::contact::Contact;
use super::engine::contact::Entries;
use super::system::Structure;
use crate::error::{Error, NotSliding};
use crate::friction::memory::object::LawObject;
use crate::friction::memory::{Sliding, Slip};
use crate::friction::piece_above;
use crate::numerics::eigenvalues::eigenvalues as eigenvalues_of;
use crate::numerics::sort::sort_by;
use crate::state::Direction;

/// Steady sliding of a [`Structure`]: the equilibrium in which every mass stands still while the
/// belts move, and the eigenvalues of small motions about it.
///
/// ```text
/// K q = f + Σ_c b_c N_c sgn(w_c) μ̂_c(|w_c|),    N_c = N0_c + n_c·q
/// M δq'' + (C + Σ_c N_c dμ̂_c/ds b_c b_cᵀ) δq' + (K − Σ_c sgn(w_c) μ̂_c b_c n_cᵀ) δq = 0
/// ```
///
/// The symbols are those of [`Structure`]. μ̂_c(s) is the kinetic coefficient at the sliding speed
/// s = |w_c|, n_c the load gradient, and δq a perturbation of q. With a [normal
/// spring](crate::Contact::with_normal_spring) of stiffness k_n and direction d, n_c includes
/// k_n·d, and the force −d N_c and its perturbation are added on the right sides. The memory
/// variables z of a contact, such as the deflection of bristles, have the values at which z' = 0.
/// Their perturbations δz add −b_c N_c Σ_j ∂μ_c/∂z_j δz_j to the right side of the second equation,
/// and δz' is linear in δz and b_c·δq'.
///
/// If a load depends on displacements, friction makes the stiffness matrix unsymmetric. Two modes
/// can then merge, and one of them can grow (flutter by mode coupling). This can happen even if
/// friction does not fall with speed.
///
/// For n coordinates the eigenvalues come from the Schur form of a 2n × 2n matrix. Each memory
/// variable adds a row and a column to this matrix. The error of an eigenvalue is about nε times
/// the largest eigenvalue (ε = 2.2e-16). The error grows to √(nε) times the largest eigenvalue if
/// two eigenvalues nearly coincide. The work grows as n³.
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
/// // The modes merge at μ = 3/4; above it one mode grows.
/// let growth = |coefficient| {
///     let sliding = brake(coefficient)?.steady_sliding()?;
///     Ok::<f64, stick_slip::Error>(sliding.eigenvalues[0].re)
/// };
/// assert_eq!(growth(0.74)?, 0.0);
/// assert!(growth(0.76)? > 0.01);
/// # Ok::<(), stick_slip::Error>(())
/// ```
///
/// Source of the example: Hoffmann, Fischer, Allgaier and Gaul, *Mech. Res. Commun.* 29 (2002)
/// 197-205.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SteadySliding {
    /// Displacement of each coordinate, in the units of the structure.
    pub displacements: Vec<f64>,
    /// Eigenvalues of small motions, in units of 1/time: two for each coordinate and one for each
    /// memory variable. They are sorted by descending real part; if real parts are equal, by
    /// descending imaginary part. Two kinds of memory variables do not influence small motions: the
    /// force of an elastic contact, which slip keeps at its limit, and a variable that is constant
    /// in slip and has no effect on slip, such as the clock of a [`Dwell`](crate::Dwell). By
    /// definition their eigenvalue is −∞, so that they do not count for stability.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Acceleration of each coordinate, in the units of the structure: 0, except for rigid-body
    /// motions of [`Structure::steady_sliding_at`] whose velocities are not steady.
    pub accelerations: Vec<f64>,
}

impl Structure {
    /// Steady sliding: every mass stands still, every contact slips, and memory variables are
    /// constant.
    ///
    /// The force of each elastic contact is its limit force. An elastic contact whose surface does
    /// not move can be in equilibrium with any force up to its limit force. This is an error with
    /// the reason [`NotSliding::Continuum`].
    ///
    /// See [`SteadySliding`] for formulas and an example.
    ///
    /// # Errors
    ///
    /// [`Error::NoSteadySliding`], with the reason ([`NotSliding`]), if a drive varies in time, if
    /// the surface of a contact does not move (w = 0), or if a load is not positive in the
    /// equilibrium. The same error is returned if memory variables have no constant values, or if
    /// the stiffness matrix with the terms of friction is singular. To make it non-singular,
    /// restrain the rigid-body modes, or use [`steady_sliding_at`](Self::steady_sliding_at), which
    /// leaves them out. For a drill string that is driven at a given speed, use the frame that
    /// rotates at this speed: in this frame the driven end is fixed to the ground.
    pub fn steady_sliding(&self) -> Result<SteadySliding, Error> {
        SteadySliding::of(self)
    }
}

impl SteadySliding {
    /// Returns true if small motions die out: all eigenvalues have negative real parts.
    pub fn is_stable(&self) -> bool {
        self.eigenvalues
            .iter()
            .all(|eigenvalue| eigenvalue.re < 0.0)
    }

    pub(super) fn of(structure: &Structure) -> Result<Self, Error> {
        if !structure.drives().all(|drive| drive.is_constant()) {
            return Err(Error::NoSteadySliding(NotSliding::Driven));
        }
        let contacts = structure.contacts().iter().enumerate();
        let contacts = contacts.map(|(number, contact)| {
            Steady::of(contact).map_err(|reason| Error::NoSteadySliding(reason(number)))
        });
        let contacts: Vec<Steady<'_>> = contacts.collect::<Result<_, _>>()?;
        Self::with(structure, &contacts).map_err(Error::NoSteadySliding)
    }

    /// Steady sliding with these contacts.
    fn with(structure: &Structure, contacts: &[Steady<'_>]) -> Result<Self, NotSliding> {
        let n = structure.len();
        let mut stiffness = structure.stiffness().clone();
        let mut damping = structure.damping().clone();
        let forces = structure.forces().iter().map(|force| force.value(0.0));
        let mut forces = DVector::from_iterator(n, forces);
        for Steady {
            contact, sliding, ..
        } in contacts
        {
            for &(i, b) in contact.direction() {
                forces[i] -= b * (contact.load().value(0.0) * sliding.coefficient);
                for (j, gradient) in contact.whole_gradient() {
                    stiffness[(i, j)] += b * (sliding.coefficient * gradient);
                }
            }
            // A normal spring acts on its own direction.
            let (normal, _) = contact.normal_spring().unwrap_or_default();
            for &(i, d) in normal {
                forces[i] -= d * contact.load().value(0.0);
                for (j, gradient) in contact.whole_gradient() {
                    stiffness[(i, j)] += d * gradient;
                }
            }
        }
        let frame = Frame::of(structure)?;
        frame.scale(&mut stiffness);
        frame.scale_force(&mut forces);
        let displacements = solve(&stiffness, &forces).ok_or(NotSliding::Singular)?;
        let displacements = frame.displacements(displacements);
        let mut memories = Vec::new();
        let mut idle = 0;
        for (number, steady) in contacts.iter().enumerate() {
            let Steady {
                contact,
                sliding,
                direction,
            } = steady;
            let load = contact.load_at(0.0, &displacements);
            if load.is_nan() || load <= 0.0 {
                return Err(NotSliding::NoLoad {
                    contact: number,
                    load,
                });
            }
            for &(i, b) in contact.direction() {
                for &(j, other) in contact.direction() {
                    damping[(i, j)] += b * other * (load * direction * sliding.slope);
                }
            }
            let row = frame.row(contact.direction());
            let memory = Memory::of(sliding, &row, load, *direction);
            idle += sliding.by_memory.len() - memory.matrix.nrows();
            // The force of an elastic contact follows its limit at once.
            idle += usize::from(contact.tangential_stiffness().is_some());
            memories.push(memory);
        }
        frame.scale(&mut damping);
        let mut eigenvalues =
            eigenvalues(&stiffness, &damping, &memories).ok_or(NotSliding::Eigenvalues)?;
        let forgotten = Complex::new(f64::NEG_INFINITY, 0.0);
        eigenvalues.extend(std::iter::repeat_n(forgotten, idle));
        Ok(Self {
            displacements,
            eigenvalues,
            accelerations: vec![0.0; n],
        })
    }
}

/// A contact that slides steadily, and its direction of slip.
struct Steady<'s> {
    contact: &'s Contact,
    sliding: Sliding,
    direction: f64,
}

impl<'s> Steady<'s> {
    /// The contact while all masses are at rest; otherwise the reason why it does not slide, by its
    /// number.
    fn of(contact: &'s Contact) -> Result<Self, fn(usize) -> NotSliding> {
        let is_still = contact.belt_velocity().value(0.0) == 0.0;
        if is_still && contact.tangential_stiffness().is_some() {
            return Err(|contact| NotSliding::Continuum { contact });
        }
        let relative = -contact.belt_velocity().value(0.0);
        let (sliding, direction) = sliding_of(relative, contact.law())?;
        Ok(Self {
            contact,
            sliding,
            direction,
        })
    }
}

/// Steady sliding at a relative velocity, and the direction of slip; otherwise the reason why the
/// contact does not slide, by its number.
pub(super) fn sliding_of(
    relative: f64,
    law: &dyn LawObject,
) -> Result<(Sliding, f64), fn(usize) -> NotSliding> {
    let Some(direction) = Direction::of(relative) else {
        return Err(|contact| NotSliding::NoSpeed { contact });
    };
    let (speed, direction) = (relative.abs(), direction.sign());
    let slip = Slip {
        speed,
        direction,
        piece: piece_above(law.breakpoints().into_iter(), speed),
    };
    match law.sliding(slip) {
        Some(sliding) => Ok((sliding, direction)),
        None => Err(|contact| NotSliding::NoSteadyMemory { contact }),
    }
}

/// Coordinates y = Lᵀq with M = L Lᵀ: the matrices L⁻¹ K L⁻ᵀ have units of time alone, and keep
/// their symmetry if they have it.
struct Frame(DMatrix<f64>);

impl Frame {
    fn of(structure: &Structure) -> Result<Self, NotSliding> {
        let masses = structure.masses();
        let mass = structure.mass_matrix();
        let is_diagonal = matches!(mass, std::borrow::Cow::Owned(_));
        if is_diagonal {
            let roots = masses.iter().map(|mass| mass.sqrt());
            let roots = DVector::from_iterator(masses.len(), roots);
            return Ok(Self(DMatrix::from_diagonal(&roots)));
        }
        // Checked where the matrix was given.
        let factor = mass.into_owned().cholesky();
        factor
            .map(|factor| Self(factor.l()))
            .ok_or(NotSliding::Singular)
    }

    /// L⁻¹ A L⁻ᵀ.
    fn scale(&self, matrix: &mut DMatrix<f64>) {
        self.divide(matrix);
        matrix.transpose_mut();
        self.divide(matrix);
        matrix.transpose_mut();
    }

    /// L⁻¹ A.
    fn divide(&self, matrix: &mut DMatrix<f64>) {
        let Self(root) = self;
        for mut column in matrix.column_iter_mut() {
            for i in 0..root.nrows() {
                for j in 0..i {
                    if root[(i, j)] != 0.0 {
                        column[i] -= root[(i, j)] * column[j];
                    }
                }
                column[i] /= root[(i, i)];
            }
        }
    }

    fn scale_force(&self, force: &mut DVector<f64>) {
        let mut column = DMatrix::from_column_slice(force.len(), 1, force.as_slice());
        self.divide(&mut column);
        force.copy_from(&column.column(0));
    }

    /// q = L⁻ᵀy.
    fn displacements(&self, mut y: DVector<f64>) -> Vec<f64> {
        let Self(root) = self;
        for i in (0..y.len()).rev() {
            for j in i + 1..y.len() {
                if root[(j, i)] != 0.0 {
                    y[i] -= root[(j, i)] * y[j];
                }
            }
            y[i] /= root[(i, i)];
        }
        y.as_slice().to_vec()
    }

    /// L⁻¹b.
    fn row(&self, direction: &Entries) -> Vec<f64> {
        let mut row = DVector::zeros(self.0.nrows());
        for &(i, b) in direction {
            row[i] = b;
        }
        self.scale_force(&mut row);
        row.as_slice().to_vec()
    }
}

/// Deviations of one contact's memory, except for variables without influence.
struct Memory {
    /// ∂z_i'/∂z_j.
    matrix: DMatrix<f64>,
    /// The direction L⁻¹b of the contact.
    row: Vec<f64>,
    /// The influence of z on the velocity along the contact, and of that velocity on z.
    acts: Vec<f64>,
    driven: Vec<f64>,
}

impl Memory {
    fn of(sliding: &Sliding, row: &[f64], load: f64, direction: f64) -> Self {
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
            matrix,
            row: row.to_vec(),
            acts,
            driven,
        }
    }
}

/// The solution of A x = b; `None` if A is singular to rounding.
pub(super) fn solve(a: &DMatrix<f64>, b: &DVector<f64>) -> Option<DVector<f64>> {
    let largest = a.amax();
    let lu = a.clone().lu();
    let pivots = lu.u().diagonal();
    let least = f64::EPSILON * a.nrows() as f64 * largest;
    if !pivots.iter().all(|pivot| pivot.abs() > least) {
        return None;
    }
    lu.solve(b).filter(|x| x.iter().all(|x| x.is_finite()))
}

/// Eigenvalues s of s² + s C + K and the memory variables, by falling real part; `None` if they do
/// not converge.
fn eigenvalues(
    stiffness: &DMatrix<f64>,
    damping: &DMatrix<f64>,
    memories: &[Memory],
) -> Option<Vec<Complex<f64>>> {
    let n = stiffness.nrows();
    let remembered: usize = memories.iter().map(|memory| memory.matrix.nrows()).sum();
    let mut values: Vec<Complex<f64>> = if damping.amax() == 0.0 && remembered == 0 {
        undamped(stiffness.clone())?
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
                for (i, b) in memory.row.iter().enumerate() {
                    matrix[(n + i, start + j)] = b * memory.acts[j];
                    matrix[(start + j, n + i)] = b * memory.driven[j];
                }
            }
            start += count;
        }
        eigenvalues_of(matrix)?
    };
    sort(&mut values);
    Some(values)
}

/// Eigenvalues s of s² + K: s² = −λ of K alone, so that the real parts of a symmetric K are exactly
/// 0.
pub(super) fn undamped(stiffness: DMatrix<f64>) -> Option<Vec<Complex<f64>>> {
    let squares = eigenvalues_of(stiffness)?;
    let roots = squares.iter().map(|&square| (-square).sqrt());
    Some(roots.flat_map(|root| [root, -root]).collect())
}

/// By falling real part, then by falling imaginary part.
pub(super) fn sort(values: &mut [Complex<f64>]) {
    // No −0, which would sort after 0.
    for value in values.iter_mut() {
        *value += Complex::new(0.0, 0.0);
    }
    sort_by(values, |value| -value.im);
    sort_by(values, |value| -value.re);
}
