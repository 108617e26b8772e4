use num_complex::Complex;

use super::sliding_field::SlidingField;
use super::system::Structure;
use crate::error::{Error, NotSliding};

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
/// and δz' is linear in δz, b_c·δq' and δN_c.
///
/// [Load laws](crate::Contact::with_load_law) φ(a·q, a·v) add φ(a·q, 0) to N_c, and the terms
/// (∂φ/∂x a·δq + ∂φ/∂y a·δq') to n_c·δq. The displacements then follow by Newton's method, as with
/// force elements.
///
/// If a load depends on displacements, friction makes the stiffness matrix unsymmetric. Two modes
/// can then merge, and one of them can grow (flutter by mode coupling). This can happen even if
/// friction does not fall with speed.
///
/// [First-order states](crate::FirstOrder) have the values at which z' = 0. Their forces B z are
/// added on the right sides, and the rows δz' = A_q δq + A_v δq' + A_z δz to the second equation.
///
/// For n coordinates the eigenvalues come from the Schur form of a 2n × 2n matrix. Each memory
/// variable, and each first-order state, adds a row and a column to this matrix. The error of an
/// eigenvalue is about nε times the largest eigenvalue (ε = 2.2e-16). Slow motions have a smaller
/// error if the large eigenvalues belong to sliding speeds that settle at once, as on a fault. The
/// error grows to √(nε) times the largest eigenvalue if two eigenvalues nearly coincide. The work
/// grows as n³.
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
    /// Eigenvalues of small motions, in units of 1/time: two for each coordinate, one for each
    /// memory variable and one for each first-order state. They are sorted by descending real part;
    /// if real parts are equal, by descending imaginary part. Two kinds of memory variables do not
    /// influence small motions: the force of an elastic contact, which slip keeps at its limit, and
    /// a variable that is constant in slip and has no effect on slip, such as the clock of a
    /// [`Dwell`](crate::Dwell). By definition their eigenvalue is −∞, so that they do not count for
    /// stability.
    pub eigenvalues: Vec<Complex<f64>>,
    /// Acceleration of each coordinate, in the units of the structure: 0, except for rigid-body
    /// motions of [`Structure::steady_sliding_at`] whose velocities are not steady.
    pub accelerations: Vec<f64>,
    /// Value of each [first-order state](crate::FirstOrder).
    pub first_order: Vec<f64>,
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
    /// [`Error::NoSteadySliding`], with the reason; [`NotSliding`] lists all reasons. Among them: a
    /// drive varies in time; the surface of a contact with friction does not move (w = 0); no
    /// equilibrium of nonlinear forces is found; the stiffness matrix with the terms of friction
    /// and of first-order states is singular, as with an integrator whose input cannot be 0. To
    /// make it non-singular, restrain the rigid-body modes, or use
    /// [`steady_sliding_at`](Self::steady_sliding_at), which leaves them out. For a drill string
    /// that is driven at a given speed, use the frame that rotates at this speed: in this frame the
    /// driven end is fixed to the ground.
    ///
    /// Contacts whose load is not positive are open: they have no friction, and their surfaces may
    /// be at rest. [`NotSliding::NoLoad`] names the exceptions.
    pub fn steady_sliding(&self) -> Result<SteadySliding, Error> {
        SteadySliding::of(SlidingField::of(&self.model())?)
    }

    /// Steady sliding of a structure, searched from given displacements, one for each coordinate.
    ///
    /// If a force is nonlinear in the displacements (force elements, stops, load laws, laws of
    /// first-order states), Newton's method starts from the given displacements. There may be
    /// several equilibria; the search returns one of them, which need not be the nearest. If none
    /// is found, the load is raised in eight steps. If all forces are linear, the given
    /// displacements matter only if contacts can open. [`steady_sliding`](Self::steady_sliding)
    /// searches from displacements of 0.
    ///
    /// # Errors
    ///
    /// * the errors of [`steady_sliding`](Self::steady_sliding);
    /// * [`Error::WrongSize`] unless there is one displacement for each coordinate;
    ///   [`Error::InvalidParameter`] for the first that is not finite.
    ///
    /// ```
    /// use stick_slip::{Contact, Coulomb, ForceElement, ForceLaw, Scalar, Structure};
    ///
    /// /// A buckled beam: two wells at ±1.
    /// struct Wells;
    /// impl ForceLaw for Wells {
    ///     fn force<S: Scalar>(&self, x: S, _: S, _: usize) -> S {
    ///         x.powi(3) - x
    ///     }
    /// }
    ///
    /// let friction = Contact::new(0, Coulomb::new(0.2, 0.2)?, 1.0)?.on_belt(0.5);
    /// let beam = Structure::new(&[1.0])?
    ///     .with_element(ForceElement::new(0, Wells)?)?
    ///     .with_contact(friction)?;
    /// for start in [-1.0, 1.0] {
    ///     let sliding = beam.steady_sliding_from(&[start])?;
    ///     let x = sliding.displacements[0];
    ///     assert!((x.powi(3) - x - 0.2).abs() < 1e-15 && (x - start).abs() < 0.2);
    ///     assert!((sliding.eigenvalues[0].im - (3.0 * x * x - 1.0).sqrt()).abs() < 1e-15);
    /// }
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn steady_sliding_from(&self, displacements: &[f64]) -> Result<SteadySliding, Error> {
        check_numbers(self, ["displacements", "displacement"], displacements)?;
        SteadySliding::of(SlidingField::from(&self.model(), displacements)?)
    }

    /// Steady sliding at given velocities of the coordinates, for example of turning shafts. A
    /// contact with the relative velocity r_c = b_c·v − w_c ≠ 0 slips at the speed |r_c|; a contact
    /// with r_c = 0 (up to rounding of the sum) sticks.
    ///
    /// ```text
    /// K q + M a + Σ_c b_c λ_c = f − C v,    a: acceleration of a rigid-body motion
    /// ```
    ///
    /// The symbols are those of [`Structure`]. The velocities v must be those of a rigid-body
    /// motion: K v = 0, and no load changes along v. With v = 0 this is
    /// [`steady_sliding`](Self::steady_sliding), but contacts with surfaces at rest stick.
    ///
    /// * **Rigid-body motions** are directions e with K e = 0 along which no load changes, and
    ///   which contacts that stick allow. [`SteadySliding::displacements`] has no part along such
    ///   directions, and [`SteadySliding::eigenvalues`] does not contain their zeros: one for each
    ///   direction of displacements, and one for each direction of velocities along which neither a
    ///   damper nor friction changes. (A clutch with constant friction has such a velocity; the
    ///   slope of a law gives the clutch a real eigenvalue.)
    /// * If forces do not balance along a rigid-body motion, its velocity is not steady, as in a
    ///   clutch that engages. [`SteadySliding::accelerations`] is then not 0. The eigenvalues are
    ///   those at the given velocities, which must change little within 1/|s| for the eigenvalue s.
    /// * **A first-order state that integrates velocities**, as in PI control of a speed, has the
    ///   value at which forces balance along a rigid-body motion; no acceleration is left there.
    /// * **Contacts that stick.** In a rigid one b·δv = 0; an elastic one is a spring of stiffness
    ///   k_t. Either can carry any force within its limit, so the equilibria form a continuum. The
    ///   result is the equilibrium in which these contacts carry only forces that springs cannot
    ///   carry. The eigenvalues depend on these forces only if the load of a contact that slips
    ///   depends on displacements. The memory variables of these contacts have no eigenvalues here.
    ///
    /// # Errors
    ///
    /// [`Error::WrongSize`] unless there is a velocity for each coordinate;
    /// [`Error::InvalidParameter`] unless all are finite; the errors of
    /// [`steady_sliding`](Self::steady_sliding), except that a contact with the relative velocity 0
    /// is an error only if its law has friction and never sticks. Further reasons
    /// ([`NotSliding`](crate::structure::NotSliding)) are velocities that deform a spring, change a
    /// load or make a first-order state grow, and a contact that sticks if balance requires more
    /// than its limit force. The stiffness matrix must be non-singular on the directions that are
    /// not rigid-body motions.
    ///
    /// ```
    /// use stick_slip::{Contact, Exponential, Structure};
    ///
    /// // A clutch between a motor and a driveline of two inertias, slipping at 10 rad/s. Its
    /// // coefficient 0.3 + 0.05 e^{−(s/20)²} falls with the slip speed s; the load is 1000 N m.
    /// let (motor, gearbox, car, shaft) = (0.2, 0.05, 2.0, 500.0);
    /// let clutch = Contact::between(0, 1, Exponential::new(0.35, 0.3, 20.0)?, 1000.0)?;
    /// let driveline = Structure::new(&[motor, gearbox, car])?
    ///     .with_spring(1, 2, shaft)?
    ///     .with_contact(clutch)?;
    /// assert!(driveline.steady_sliding().is_err());
    /// let slipping = driveline.steady_sliding_at(&[110.0, 100.0, 100.0])?;
    ///
    /// // Two rigid-body displacements and one rigid-body velocity have no eigenvalue. The slope of
    /// // friction drives the shaft: it judders.
    /// let [first, second, third] = slipping.eigenvalues[..] else { panic!() };
    /// assert!(!slipping.is_stable() && first.re > 0.0 && second == first.conj());
    /// let fall = 0.05 * (-0.25_f64).exp();
    /// let slope = -2.0 * 10.0 / 400.0 * fall * 1000.0;
    /// // The cubic of slip speed and twist.
    /// let cubic = |s: stick_slip::nalgebra::Complex<f64>| {
    ///     let slip = s + slope * (1.0 / motor + 1.0 / gearbox);
    ///     let twist = s * s + shaft * (1.0 / gearbox + 1.0 / car);
    ///     (slip * twist - shaft * slope / (gearbox * gearbox)).norm()
    /// };
    /// assert!(cubic(first).max(cubic(third)) < 1e-12 * first.norm().powi(3));
    ///
    /// // The clutch slows the motor down: its speed is not steady.
    /// let torque = (0.3 + fall) * 1000.0;
    /// assert!((slipping.accelerations[0] + torque / motor).abs() < 1e-9);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn steady_sliding_at(&self, velocities: &[f64]) -> Result<SteadySliding, Error> {
        check_numbers(self, ["velocities", "velocity"], velocities)?;
        let model = self.model();
        SteadySliding::of(SlidingField::at(&model, velocities)?)
    }
}

/// Checks that there is a finite number for each coordinate; their name, and that of one of them.
fn check_numbers(
    structure: &Structure,
    [name, one]: [&'static str; 2],
    numbers: &[f64],
) -> Result<(), Error> {
    let (found, expected) = (numbers.len(), structure.len());
    if found != expected {
        return Err(Error::WrongSize {
            name,
            found,
            expected,
        });
    }
    for &number in numbers {
        Error::check("Structure", one, number, true, "any size")?;
    }
    Ok(())
}

impl SteadySliding {
    /// Returns true if small motions die out: all eigenvalues have negative real parts.
    pub fn is_stable(&self) -> bool {
        self.eigenvalues
            .iter()
            .all(|eigenvalue| eigenvalue.re < 0.0)
    }

    /// The result from the field near steady sliding.
    fn of(field: SlidingField<'_, '_>) -> Result<Self, Error> {
        let found = field.eigenvalues();
        let (spectrum, idle) = found.ok_or(Error::NoSteadySliding(NotSliding::Eigenvalues))?;
        let mut eigenvalues = spectrum.values;
        let forgotten = Complex::new(f64::NEG_INFINITY, 0.0);
        eigenvalues.extend(std::iter::repeat_n(forgotten, idle));
        Ok(Self {
            displacements: field.displacements,
            eigenvalues,
            accelerations: field.accelerations,
            first_order: field.first_order,
        })
    }
}
