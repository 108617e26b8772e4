use std::borrow::Cow;

use nalgebra::DMatrix;

use super::contact::Contact;
use super::engine::model::{Mass, Model};
use super::first_order::FirstOrder;
use super::force_element::ForceElement;
use super::matrices::{
    MAX_CONTACTS, MAX_COORDINATES, MAX_FIRST_ORDERS, add, add_between, add_matrix, check_contacts,
    check_count, check_definite, check_first_orders, check_masses, make_symmetric,
};
use super::stop::Stop;
use crate::belt::MassOnBelt;
use crate::drive::{self, Drive};
use crate::error::{Element, Error};
use crate::friction::memory::ContactLaw;

/// Several masses with springs, dampers, nonlinear force elements and forces that vary in time, and
/// with friction contacts between masses or on moving surfaces.
///
/// ```text
/// M v' = f(t) − C v − K q − Σ_e D_e(t) Σ_i a_ei F_ei − Σ_c b_c λ_c + Σ_k d_k F_k + B z,   v = q'
/// contacts:  r_c = b_c·v − w_c(t),   N_c = N0_c(t) + Σ_j n_cj q_j + k_c d_c·q + Σ φ_c
///            slip:  λ_c = N_c μ_c(r_c)     stick:  r_c = 0  while  |λ_c| ≤ N_c μ_s,c
/// elements:  F_e = F_e(x_e, y_e),   x_ei = a_ei·q,   y_ei = a_ei·v
/// stops:     F_k = F_k(δ_k, δ_k'),   δ_k = −(g_k + d_k·q)
/// states:    z' = A_q q + A_v v + A_z z + u(t) + F_z
/// ```
///
/// The n coordinates q_i are displacements, angles or modal coordinates. M, C and K are the mass,
/// damping and stiffness matrices, n × n, and f(t) are the forces. M is symmetric and positive
/// definite: diagonal with [`new`](Self::new), full with
/// [`with_mass_matrix`](Self::with_mass_matrix). K and C need not be symmetric: follower forces and
/// gyroscopic terms are allowed.
///
/// [`Contact`] c has the direction b_c, the friction force λ_c, the normal load N_c with the
/// gradient n_c, the relative velocity r_c, and a surface of velocity w_c (0 unless set). μ_c is
/// the friction coefficient in slip, and μ_s,c the static coefficient. The direction may be any
/// vector, a coordinate may have any number of contacts, and each contact may have its own law.
/// Contacts are numbered from 0 in the order in which they are added. A contact with a [normal
/// spring](Contact::with_normal_spring) of stiffness k_c and direction d_c also exerts the force
/// −d_c N_c. φ_c are [load laws](Contact::with_load_law). In an [elastic
/// contact](Contact::with_tangential_stiffness) the force of its spring takes the place of λ_c.
///
/// [`ForceElement`] e has the directions a_ei, the positions x_ei and velocities y_ei along them,
/// the law F_e, a nonlinear function of these, and the factor D_e, 1 unless set. Elements are
/// numbered from 0 in the order in which they are added.
///
/// [`Stop`] k has the direction d_k and the gap g_k at q = 0. Its force F_k is that of a spring and
/// a damper while the depth δ_k is positive.
///
/// First-order states z, such as the integral of a controller or the current of a motor, have no
/// mass; each is a [`FirstOrder`], which gives its row of the equation and its forces, a column of
/// B.
///
/// # What is not covered
///
/// * **Inertia that depends on displacements:** M is constant. A pendulum is covered if its pivot
///   is at rest, a double pendulum or a linkage is not.
/// * **Delays:** all forces depend on the present state, so regenerative chatter is not covered.
/// * **Friction in a plane:** each contact slides along its own fixed direction.
/// * **Rigid impacts:** velocities never jump. A [`Stop`] has a stiffness: its page says what to
///   take for a [rigid stop](Stop#rigid-stops).
/// * **Forces that jump** at a displacement, except that of a damped [`Stop`]. A force that jumps
///   with the sign of a velocity is friction.
///
/// # Contacts that share masses
///
/// The force in a sticking contact depends on the other contacts on the same masses. Stick or slip
/// at r = 0 is therefore decided for all these contacts together:
///
/// * if static and kinetic coefficients are equal, exactly one combination of stick and slip
///   satisfies the equations, and the contacts follow it;
/// * otherwise the *fastest yields first*. Let G_cc = b_cᵀM⁻¹b_c. In the first decision each
///   contact has its static limit N μ_s as the largest force in stick and as the force in slip.
///   This decision gives relative accelerations r'. Of the contacts that slip, the contact with the
///   largest |r'|/(G_cc N μ_s) gets its kinetic friction instead of N μ_s. The decision is repeated
///   until every contact that slips has its kinetic friction. Friction that falls from its static
///   to its kinetic value over a small range of sliding speeds leads to this rule as the range
///   shrinks to 0.
///
/// Contacts that reach the ends of their stick bands at the same time are compared by the first
/// derivatives of r that are not 0, instead of r'. A contact whose r stays 0 sticks, even if its
/// force stays at its limit: a stack of blocks of one material moves as one body if its lowest
/// block is pulled.
///
/// The result does not depend on the numbering of contacts.
///
/// A law may have static coefficients that differ by direction
/// ([`Directional`](crate::Directional)), and a [freewheel](Contact::freewheel) an infinite one:
/// the μ_s of the direction in which the contact slips, or would slip, then takes the place of μ_s
/// in the rules above.
///
/// Contacts whose directions are linearly dependent (parallel clutches; two brakes and the clutch
/// between them) may stick at the same time. What each of them carries is then not determined, but
/// when they slip is. A mechanism is a motion with relative velocities s_c in which as few contacts
/// as possible slip. Contacts at rest begin to slip in the first mechanism in which the power of
/// the load exceeds Σ N_c μ_s |s_c| (the kinematic theorem of limit analysis). If static and
/// kinetic coefficients are equal, exactly the contacts of this mechanism slip then, all at one
/// time; otherwise they are those that may yield by the rule above.
/// [`carried`](Self::carried) returns the range of the forces that are possible.
///
/// ```
/// use stick_slip::{Contact, Coulomb, Rational, Structure};
///
/// // Two blocks on a belt, coupled by a spring (U. Galvanetto, S. R. Bishop, 1999).
/// let law = Rational::new(1.0, 3.0)?;
/// let blocks = Structure::new(&[1.0, 1.0])?
///     .with_ground_spring(0, 1.0)?
///     .with_ground_spring(1, 1.0)?
///     .with_spring(0, 1, 1.2)?
///     .with_contact(Contact::new(0, law, 1.0)?.on_belt(0.17))?
///     .with_contact(Contact::new(1, law, 1.3)?.on_belt(0.17))?;
/// assert_eq!(blocks.stiffness()[(0, 1)], -1.2);
/// assert_eq!(blocks.contacts()[1].coordinate(), 1);
/// assert!(!blocks.steady_sliding()?.is_stable());
/// # Ok::<(), stick_slip::Error>(())
/// ```
///
/// ```
/// use stick_slip::{Contact, Coulomb, Structure, structure::State};
///
/// // Two shafts, 1 kg m² at 5 rad/s and 0.5 kg m² at rest; the clutch slips at 1.2 N m.
/// let clutch = Contact::between(0, 1, Coulomb::new(0.36, 0.3)?, 4.0)?;
/// let shafts = Structure::new(&[1.0, 0.5])?.with_contact(clutch)?;
/// let motion = shafts.simulate(State::new(&[0.0, 0.0], &[5.0, 0.0]), 5.0)?;
/// // They lock when their speeds are equal; the angular momentum is conserved.
/// let lock_up = &motion.events()[0];
/// assert!((lock_up.time - 5.0 / (1.2 / 1.0 + 1.2 / 0.5)).abs() < 1e-15);
/// assert!((motion.last().velocities[1] - 5.0 / 1.5).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
///
/// Any consistent units may be used, SI or dimensionless. With kilograms, newtons and metres, times
/// are in seconds. A rotational coordinate has a moment of inertia in kg·m², torques in N·m, and an
/// angle in radians. Power series have coefficients up to ω²⁶ with the largest angular
/// frequency ω: choose a unit of time in which ω is below 1e11, microseconds instead of seconds for
/// atoms.
///
/// ```
/// use stick_slip::{Contact, Coulomb, Structure, structure};
///
/// // A block of 2 kg on a belt at 50 mm/s, held by a spring of 800 N/m, pressed by its weight.
/// let (mass, stiffness, speed, load) = (2.0_f64, 800.0, 0.05, 2.0 * 9.80665);
/// let law = Coulomb::new(0.3, 0.2)?;
/// let block = Structure::new(&[mass])?
///     .with_ground_spring(0, stiffness)?
///     .with_contact(Contact::new(0, law, load)?.on_belt(speed))?;
/// // It moves with the belt until the spring force is 0.3 × 19.6 N, at 7.4 mm: first release.
/// let motion = block.simulate(structure::State::new(&[0.0], &[speed]), 1.0)?;
/// let [release, stick, again, ..] = motion.events() else { panic!() };
/// assert!((release.time - 0.3 * load / stiffness / speed).abs() < 1e-15); // 0.147 s
/// // One slip and one stick together then take 0.335 s, as theory says.
/// let (jump, omega) = ((0.3 - 0.2) * load, (stiffness / mass).sqrt());
/// let slip = 2.0 / omega * (std::f64::consts::PI - (jump * omega / (stiffness * speed)).atan());
/// assert!((stick.time - release.time - slip).abs() < 1e-14);
/// assert!((again.time - stick.time - 2.0 * jump / (stiffness * speed)).abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
///
/// Source of the first example: Galvanetto and Bishop, *Int. J. Mech. Sci.* 41 (1999) 683-695.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(
        try_from = "super::read::StructureText",
        into = "super::read::StructureText"
    )
)]
pub struct Structure {
    /// The diagonal of M.
    masses: Vec<f64>,
    /// M, unless it is diagonal.
    mass_matrix: Option<DMatrix<f64>>,
    stiffness: DMatrix<f64>,
    damping: DMatrix<f64>,
    /// One for each coordinate.
    forces: Vec<Drive>,
    contacts: Vec<Contact>,
    elements: Vec<ForceElement>,
    stops: Vec<Stop>,
    first_orders: Vec<FirstOrder>,
}

impl Structure {
    /// The largest number of coordinates, 4096. Matrices are stored with all their entries: at this
    /// size each takes 128 MiB.
    pub const MAX_COORDINATES: usize = MAX_COORDINATES;

    /// The largest number of contacts, 4096. If all of them act on one coordinate, their couplings
    /// take 256 MiB.
    pub const MAX_CONTACTS: usize = MAX_CONTACTS;

    /// The largest number of first-order states, 4096, as that of coordinates.
    pub const MAX_FIRST_ORDERS: usize = MAX_FIRST_ORDERS;

    /// Creates a structure of free masses m_i > 0, one for each coordinate, without springs,
    /// dampers, forces or contacts.
    ///
    /// # Errors
    ///
    /// [`Error::BadElement`] for the first mass that is not positive and finite;
    /// [`Error::InvalidParameter`] if the list is empty or has more than
    /// [`MAX_COORDINATES`](Self::MAX_COORDINATES) entries.
    pub fn new(masses: &[f64]) -> Result<Self, Error> {
        check_masses(masses, Element::Mass)?;
        let n = masses.len();
        Ok(Self {
            masses: masses.to_vec(),
            mass_matrix: None,
            stiffness: DMatrix::zeros(n, n),
            damping: DMatrix::zeros(n, n),
            forces: vec![Drive::constant(0.0); n],
            contacts: Vec::new(),
            elements: Vec::new(),
            stops: Vec::new(),
            first_orders: Vec::new(),
        })
    }

    /// Creates a structure with an n × n mass matrix M, symmetric and positive definite, without
    /// springs, dampers, forces or contacts. M may be the mass matrix of a reduced finite-element
    /// model. A diagonal matrix gives the same structure as [`new`](Self::new).
    ///
    /// Entries (i, j) and (j, i) may differ by up to 4ε√(m_ii m_jj) with ε = 2.2e-16; their mean is
    /// used. Such a difference is the rounding error of a product ΦᵀMΦ with mode shapes Φ.
    ///
    /// # Errors
    ///
    /// * [`Error::InvalidParameter`] if the matrix is empty or has more than
    ///   [`MAX_COORDINATES`](Self::MAX_COORDINATES) rows, [`Error::WrongSize`] if it is not square;
    /// * [`Error::BadElement`] for the first entry that is not finite, or not positive on the
    ///   diagonal;
    /// * [`Error::NotSymmetric`] or [`Error::NotPositiveDefinite`] if the matrix is not symmetric
    ///   or not positive definite.
    ///
    /// ```
    /// use stick_slip::nalgebra::DMatrix;
    /// use stick_slip::{Contact, Coulomb, Structure};
    ///
    /// // Two masses in coordinates x_0 = q_0 − q_1 and x_1 = q_1: the joint between them has the
    /// // direction x_0.
    /// let mass = DMatrix::from_row_slice(2, 2, &[1.0, 1.0, 1.0, 3.0]);
    /// let pair = Structure::with_mass_matrix(mass)?
    ///     .with_contact(Contact::new(0, Coulomb::new(0.4, 0.3)?, 1.0)?)?;
    /// assert_eq!(pair.mass_matrix()[(0, 1)], 1.0);
    /// assert_eq!(pair.masses(), [1.0, 3.0]);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn with_mass_matrix(mut mass: DMatrix<f64>) -> Result<Self, Error> {
        let n = mass.nrows();
        if mass.ncols() != n {
            return Err(Error::WrongSize {
                name: "columns of the mass matrix",
                found: mass.ncols(),
                expected: n,
            });
        }
        check_count(n)?;
        let element = |i: usize| Element::MassMatrix(i, i);
        let diagonal: Vec<f64> = mass.diagonal().iter().copied().collect();
        check_masses(&diagonal, element)?;
        make_symmetric(&mut mass)?;
        let mut structure = Self::new(&diagonal)?;
        let beside = (0..n).flat_map(|i| (0..i).map(move |j| (i, j)));
        if beside.clone().any(|(i, j)| mass[(i, j)] != 0.0) {
            check_definite(&mass)?;
            structure.mass_matrix = Some(mass);
        }
        Ok(structure)
    }

    /// Adds a spring of stiffness k between two coordinates, with the forces f_i = −k(q_i − q_j)
    /// and f_j = −f_i. k may be negative.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchCoordinate`] if there is no coordinate i or j; [`Error::BadElement`] if i =
    /// j, or if k or the stiffness after the addition is not finite.
    pub fn with_spring(mut self, i: usize, j: usize, stiffness: f64) -> Result<Self, Error> {
        add_between(
            &mut self.stiffness,
            Element::Stiffness(i, j),
            (i, j),
            stiffness,
        )?;
        Ok(self)
    }

    /// Adds a damper of constant c between two coordinates, with the forces f_i = −c(v_i − v_j) and
    /// f_j = −f_i. c may be negative.
    ///
    /// # Errors
    ///
    /// The errors of [`with_spring`](Self::with_spring).
    pub fn with_damper(mut self, i: usize, j: usize, damping: f64) -> Result<Self, Error> {
        add_between(&mut self.damping, Element::Damping(i, j), (i, j), damping)?;
        Ok(self)
    }

    /// Adds a spring of stiffness k between a coordinate and the ground, with the force f_i = −k
    /// q_i. k may be negative.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchCoordinate`] if there is no coordinate i; [`Error::BadElement`] if k or the
    /// stiffness after the addition is not finite.
    pub fn with_ground_spring(mut self, i: usize, stiffness: f64) -> Result<Self, Error> {
        add(
            &mut self.stiffness,
            Element::Stiffness(i, i),
            (i, i),
            stiffness,
        )?;
        Ok(self)
    }

    /// Adds a damper of constant c between a coordinate and the ground, with the force f_i = −c
    /// v_i. c may be negative.
    ///
    /// # Errors
    ///
    /// The errors of [`with_ground_spring`](Self::with_ground_spring).
    pub fn with_ground_damper(mut self, i: usize, damping: f64) -> Result<Self, Error> {
        add(&mut self.damping, Element::Damping(i, i), (i, i), damping)?;
        Ok(self)
    }

    /// Adds a matrix to the stiffness matrix K, in units of force per displacement. The added
    /// matrix need not be symmetric.
    ///
    /// # Errors
    ///
    /// [`Error::WrongSize`] unless the matrix has a row and a column for each coordinate;
    /// [`Error::BadElement`] for the first entry that is not finite, in this matrix or in the
    /// stiffness matrix after the addition.
    #[allow(clippy::needless_pass_by_value)] // as the other builders take what they are given
    pub fn with_stiffness(mut self, stiffness: DMatrix<f64>) -> Result<Self, Error> {
        let names = [
            "rows of the stiffness matrix",
            "columns of the stiffness matrix",
        ];
        add_matrix(&mut self.stiffness, &stiffness, names, Element::Stiffness)?;
        Ok(self)
    }

    /// Adds a matrix to the damping matrix C, in units of force per velocity. The added matrix need
    /// not be symmetric.
    ///
    /// # Errors
    ///
    /// The errors of [`with_stiffness`](Self::with_stiffness).
    #[allow(clippy::needless_pass_by_value)]
    pub fn with_damping(mut self, damping: DMatrix<f64>) -> Result<Self, Error> {
        let names = [
            "rows of the damping matrix",
            "columns of the damping matrix",
        ];
        add_matrix(&mut self.damping, &damping, names, Element::Damping)?;
        Ok(self)
    }

    /// Adds a force f_i(t) on a coordinate.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchCoordinate`] if there is no coordinate i; [`Error::BadElement`] if f_i or the
    /// total force on the coordinate is not finite.
    pub fn with_force(mut self, i: usize, force: impl Into<Drive>) -> Result<Self, Error> {
        let element = Element::Force(i);
        let count = self.len();
        let old = self.forces.get_mut(i).ok_or(Error::NoSuchCoordinate {
            element,
            coordinate: i,
            count,
        })?;
        let sum = old.clone().plus(&force.into());
        *old = sum.map_err(|error| error.of_element(element))?;
        Ok(self)
    }

    /// Adds a contact. Contacts are numbered from 0, in the order in which they are added.
    ///
    /// # Errors
    ///
    /// * [`Error::NoSuchCoordinate`] if the direction or the load of the contact names a coordinate
    ///   that does not exist;
    /// * [`Error::BeltVelocityJumps`] if the contact is rigid and the velocity of its surface
    ///   jumps; [`Error::BadElement`] if that velocity is not finite at all times;
    /// * [`Error::BadElement`] unless 1e-290 ≤ Σ b_j²/m_j ≤ 1e290: outside this range forces would
    ///   lose digits. b_j are the entries of the direction, and m_j the masses;
    /// * [`Error::InvalidParameter`] beyond [`MAX_CONTACTS`](Self::MAX_CONTACTS), and if the load
    ///   is a constant ≤ 0 and the contact has neither a normal spring nor a load law.
    pub fn with_contact(self, contact: Contact) -> Result<Self, Error> {
        contact.check_load()?;
        self.with_any_load(contact)
    }

    /// Adds a contact that may be open at all times.
    pub(super) fn with_any_load(mut self, contact: Contact) -> Result<Self, Error> {
        check_contacts(self.contacts.len() + 1)?;
        contact.check(self.contacts.len(), &self.masses)?;
        self.contacts.push(contact);
        Ok(self)
    }

    /// Adds several contacts, one after the other, by [`with_contact`](Self::with_contact).
    ///
    /// # Errors
    ///
    /// The errors of [`with_contact`](Self::with_contact), for the first contact at fault.
    pub fn with_contacts(self, contacts: impl IntoIterator<Item = Contact>) -> Result<Self, Error> {
        contacts.into_iter().try_fold(self, Self::with_contact)
    }

    /// Adds a force element: a nonlinear spring or damper, or a force of several coordinates.
    /// Elements are numbered from 0, in the order in which they are added.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchCoordinate`] if a direction of the element names a coordinate that does not
    /// exist.
    pub fn with_element(mut self, element: ForceElement) -> Result<Self, Error> {
        element.check(self.elements.len(), self.len())?;
        self.elements.push(element);
        Ok(self)
    }

    /// Adds a stop with spring and damper. Stops are numbered from 0, in the order in which they
    /// are added.
    ///
    /// # Errors
    ///
    /// [`Error::RigidStop`] if the stop has no contact stiffness; [`Error::NoSuchCoordinate`] if
    /// its direction names a coordinate that does not exist.
    ///
    /// ```
    /// use stick_slip::{Drive, Stop, Structure, structure::State};
    ///
    /// // A force throws a mass to and fro between two stops.
    /// let stop = |stop: Stop| stop.with_contact_stiffness(200.0, 4.0);
    /// let mass = Structure::new(&[1.0])?
    ///     .with_force(0, Drive::sine(3.0, 2.0)?)?
    ///     .with_stop(stop(Stop::above(0, 0.5, 0.0)?)?)?
    ///     .with_stop(stop(Stop::below(0, -0.5, 0.0)?)?)?;
    /// let motion = mass.simulate(State::at_rest(1), 20.0)?;
    /// // From rest q = 3t/2 − (3/4) sin 2t: the mass first touches a stop at q = 1/2.
    /// let first = motion.events()[0].time;
    /// assert!((1.5 * first - 0.75 * (2.0 * first).sin() - 0.5).abs() < 1e-15);
    /// let depth = |q: f64| q.abs() - 0.5;
    /// let depths = motion.steps().iter().map(|step| depth(step.state().displacements[0]));
    /// assert!(motion.events().len() > 10 && depths.fold(0.0, f64::max) < 0.2);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn with_stop(mut self, stop: Stop) -> Result<Self, Error> {
        stop.check(self.stops.len(), self.len())?;
        self.stops.push(stop);
        Ok(self)
    }

    /// Adds a first-order state: an integral, a current, a filter. States are numbered from 0, in
    /// the order in which they are added. It may read the states before it and itself; states that
    /// read each other are added together, by [`with_first_orders`](Self::with_first_orders).
    ///
    /// # Errors
    ///
    /// * [`Error::NoSuchCoordinate`] if it names a coordinate that does not exist;
    /// * [`Error::NoSuchState`] if it reads a first-order state that does not exist;
    /// * [`Error::InvalidParameter`] beyond [`MAX_FIRST_ORDERS`](Self::MAX_FIRST_ORDERS).
    #[doc(alias = "state space")]
    #[doc(alias = "PID")]
    pub fn with_first_order(self, state: FirstOrder) -> Result<Self, Error> {
        self.with_first_orders([state])
    }

    /// Adds several first-order states, which may read each other.
    ///
    /// # Errors
    ///
    /// The errors of [`with_first_order`](Self::with_first_order), for the first state at fault.
    ///
    /// ```
    /// use stick_slip::{FirstOrder, Structure, structure::State};
    ///
    /// // z_0' = z_1, z_1' = −z_0: cos t and −sin t.
    /// let circle = Structure::new(&[1.0])?.with_first_orders([
    ///     FirstOrder::integrator().with_state(1, 1.0)?,
    ///     FirstOrder::integrator().with_state(0, -1.0)?,
    /// ])?;
    /// let start = State::at_rest(1).with_memory(&[1.0, 0.0]);
    /// let end = circle.simulate(start, 10.0)?.last();
    /// assert!((end.memory[0] - 10.0_f64.cos()).abs() < 1e-14);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn with_first_orders(
        mut self,
        states: impl IntoIterator<Item = FirstOrder>,
    ) -> Result<Self, Error> {
        let first = self.first_orders.len();
        for state in states {
            check_first_orders(self.first_orders.len() + 1)?;
            self.first_orders.push(state);
        }
        let count = self.first_orders.len();
        for (number, state) in self.first_orders.iter().enumerate().skip(first) {
            state.check(number, self.len(), count)?;
        }
        Ok(self)
    }

    /// Number of coordinates, at least 1.
    #[allow(clippy::len_without_is_empty)] // it never is
    pub fn len(&self) -> usize {
        self.masses.len()
    }

    /// Mass of each coordinate: the diagonal of M.
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// The mass matrix M.
    pub fn mass_matrix(&self) -> Cow<'_, DMatrix<f64>> {
        match &self.mass_matrix {
            Some(mass) => Cow::Borrowed(mass),
            None => {
                let n = self.len();
                let entry = |i, j| if i == j { self.masses[i] } else { 0.0 };
                Cow::Owned(DMatrix::from_fn(n, n, entry))
            }
        }
    }

    /// The stiffness matrix K, in units of force per displacement.
    pub fn stiffness(&self) -> &DMatrix<f64> {
        &self.stiffness
    }

    /// The damping matrix C, in units of force per velocity.
    pub fn damping(&self) -> &DMatrix<f64> {
        &self.damping
    }

    /// Force f_i(t) on each coordinate.
    pub fn forces(&self) -> &[Drive] {
        &self.forces
    }

    /// The contacts, by their numbers.
    pub fn contacts(&self) -> &[Contact] {
        &self.contacts
    }

    /// The force elements, by their numbers.
    pub fn elements(&self) -> &[ForceElement] {
        &self.elements
    }

    /// The stops, by their numbers.
    pub fn stops(&self) -> &[Stop] {
        &self.stops
    }

    /// The first-order states, by their numbers.
    pub fn first_orders(&self) -> &[FirstOrder] {
        &self.first_orders
    }

    /// The least common period of all drives: forces, loads, belt velocities, factors of force
    /// elements and of load laws, and inputs of first-order states. `None` if all are constant or
    /// have no common period; see [`Drive::period`].
    ///
    /// ```
    /// use stick_slip::{Contact, Coulomb, Drive, Structure};
    ///
    /// let contact = Contact::new(0, Coulomb::new(0.4, 0.3)?, 1.0)?;
    /// let shaken = Structure::new(&[1.0])?
    ///     .with_ground_spring(0, 1.0)?
    ///     .with_force(0, Drive::sine(0.5, 2.0)?)?
    ///     .with_contact(contact.on_belt(Drive::sine(0.1, 3.0)?))?;
    /// assert_eq!(shaken.period(), Some(std::f64::consts::TAU));
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn period(&self) -> Option<f64> {
        drive::common_period(self.drives())
    }

    /// The functions of time that act on the structure.
    pub(crate) fn drives(&self) -> impl Iterator<Item = &Drive> {
        let contacts = self.contacts.iter();
        let of_contacts = contacts.flat_map(|contact| [contact.load(), contact.belt_velocity()]);
        let load_laws = self.contacts.iter().flat_map(Contact::load_laws);
        let elements = self.elements.iter().chain(load_laws);
        let of_elements = elements.map(ForceElement::factor);
        let of_states = self.first_orders.iter().map(FirstOrder::drive);
        let others = of_contacts.chain(of_elements).chain(of_states);
        self.forces.iter().chain(others)
    }

    /// The model that the engine integrates.
    pub(crate) fn model(&self) -> Model<'_> {
        let mass = match &self.mass_matrix {
            Some(mass) => Mass::Full(mass),
            None => Mass::Diagonal(&self.masses),
        };
        let states = || self.first_orders.iter().enumerate();
        let laws = states().flat_map(|(number, state)| state.law_data(number, self.len()));
        let elements = self.elements.iter().map(ForceElement::data).chain(laws);
        let elements = elements.chain(self.stops.iter().map(Stop::data));
        let first_order = states().map(|(number, state)| state.data(number));
        Model::new(
            mass,
            [&self.stiffness, &self.damping],
            Cow::Borrowed(&self.forces),
            self.contacts.iter().map(Contact::data).collect(),
            (elements.collect(), first_order.collect()),
            self.contacts
                .iter()
                .map(|contact| contact.load_data().collect()),
        )
    }
}

/// Converts a mass on a belt into a structure with one coordinate and one contact: m = 1, K = 1, C
/// = 2β, load γ², belt velocity v_b. The motions of the two systems have the same events.
///
/// ```
/// use stick_slip::{MassOnBelt, Polynomial, Structure};
///
/// let belt = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let structure = Structure::from(&belt);
/// assert_eq!(structure.damping()[(0, 0)], 0.1);
/// let (one, other) = (belt.equilibrium().unwrap(), structure.steady_sliding().unwrap());
/// assert_eq!(one.displacement, other.displacements[0]);
/// assert!((one.eigenvalues[0] - other.eigenvalues[0]).norm() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
impl<L> From<&MassOnBelt<L>> for Structure
where
    L: ContactLaw + Clone + Send + Sync + 'static,
{
    fn from(belt: &MassOnBelt<L>) -> Self {
        let contact = Contact::of_belt(belt);
        Self {
            masses: vec![1.0],
            mass_matrix: None,
            stiffness: DMatrix::from_element(1, 1, 1.0),
            damping: DMatrix::from_element(1, 1, 2.0 * belt.damping()),
            forces: vec![Drive::constant(0.0)],
            contacts: vec![contact],
            elements: Vec::new(),
            stops: Vec::new(),
            first_orders: Vec::new(),
        }
    }
}
