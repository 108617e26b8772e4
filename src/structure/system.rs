use std::borrow::Cow;
use std::rc::Rc;

use nalgebra::DMatrix;

use super::contact::Contact;
use super::laws::Typed;
use super::model::Model;
use super::steady::SteadySliding;
use crate::belt::MassOnBelt;
use crate::drive::{self, Drive};
use crate::error::{Element, Error};
use crate::friction::memory::ContactLaw;

/// Several masses on springs and dampers, driven in time, with a friction contact at some or all.
///
/// ```text
/// slip:   m_i v_i' = f_i(t) − (C v)_i − (K q)_i − N_i μ_i(r_i),   v = q',  r_i = v_i − w_i(t)
/// stick:  v_i = w_i(t)  while  |R_i| ≤ N_i μ_s,   R_i = f_i(t) − (C v)_i − (K q)_i − m_i w_i'(t)
/// load:   N_i = N0_i(t) + Σ_j n_ij q_j
/// ```
///
/// q_i are displacements or angles, m_i > 0 masses or moments of inertia. K and C need not be
/// symmetric: follower forces and gyroscopic terms are allowed.
///
/// A coordinate has at most one contact, and the number of a contact is its place in the order of
/// [`with_contact`](Self::with_contact).
///
/// The type of the law, `L`, follows from the first contact. Where there is none, write any law:
/// `let frame: Structure<Coulomb> = Structure::new(&[1.0])?;`. Contacts of different laws share
/// [`AnyLaw`](crate::AnyLaw). `Z` is the number of memory variables of the law, 0 for every dry
/// law.
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
/// let sliding = blocks.steady_sliding().ok_or("not sliding")?;
/// assert!(!sliding.is_stable());
///
/// let frame: Structure<Coulomb> = Structure::new(&[1.0])?.with_ground_spring(0, 4.0)?;
/// assert_eq!(frame.contacts().len(), 0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Any consistent units will do, SI or dimensionless: nothing in the crate depends on them.
/// Kilograms, newtons and metres give seconds; a coordinate that turns has kg·m², N·m and radians.
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
/// // It goes with the belt up to 0.3 × 19.6 N / (800 N/m) = 7.4 mm, for the first time after:
/// let motion = block.simulate(structure::State::new(&[0.0], &[speed]), 1.0)?;
/// let [release, stick, again, ..] = motion.events() else { panic!() };
/// assert!((release.time - 0.3 * load / stiffness / speed).abs() < 1e-15); // 0.147 s
/// // Slip and stick then take as long as theory has it, 0.335 s together.
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
    serde(try_from = "super::read::Structure<L, Z>"),
    serde(bound(
        deserialize = "L: crate::friction::memory::ContactLaw<Z> + serde::Deserialize<'de>"
    ))
)]
pub struct Structure<L, const Z: usize = 0> {
    masses: Vec<f64>,
    #[cfg_attr(feature = "serde", serde(serialize_with = "super::read::rows"))]
    stiffness: DMatrix<f64>,
    #[cfg_attr(feature = "serde", serde(serialize_with = "super::read::rows"))]
    damping: DMatrix<f64>,
    /// One for each coordinate.
    forces: Vec<Drive>,
    contacts: Vec<Contact<L, Z>>,
}

impl<L, const Z: usize> Structure<L, Z> {
    /// Free masses m_i > 0, one for each coordinate: no springs, dampers, forces or contacts yet.
    ///
    /// # Errors
    ///
    /// [`Error::BadElement`] with the first mass that is not positive and finite;
    /// [`Error::InvalidParameter`] if there is none.
    pub fn new(masses: &[f64]) -> Result<Self, Error> {
        check_masses(masses)?;
        let n = masses.len();
        Ok(Self {
            masses: masses.to_vec(),
            stiffness: DMatrix::zeros(n, n),
            damping: DMatrix::zeros(n, n),
            forces: vec![Drive::constant(0.0); n],
            contacts: Vec::new(),
        })
    }

    /// A spring of stiffness k between two coordinates, added to what is there:
    /// f_i = −k(q_i − q_j) = −f_j. k may be negative.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchCoordinate`]; [`Error::BadElement`] unless i and j differ and k, and what it
    /// is added to, are finite.
    pub fn with_spring(mut self, i: usize, j: usize, stiffness: f64) -> Result<Self, Error> {
        add_between(
            &mut self.stiffness,
            Element::Stiffness(i, j),
            (i, j),
            stiffness,
        )?;
        Ok(self)
    }

    /// A damper between two coordinates, added to what is there: f_i = −c(v_i − v_j) = −f_j.
    /// c may be negative.
    ///
    /// # Errors
    ///
    /// As for [`with_spring`](Self::with_spring).
    pub fn with_damper(mut self, i: usize, j: usize, damping: f64) -> Result<Self, Error> {
        add_between(&mut self.damping, Element::Damping(i, j), (i, j), damping)?;
        Ok(self)
    }

    /// A spring between a coordinate and the ground, added to what is there: f_i = −k q_i. k may be
    /// negative.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchCoordinate`]; [`Error::BadElement`] unless k, and what it is added to, are
    /// finite.
    pub fn with_ground_spring(mut self, i: usize, stiffness: f64) -> Result<Self, Error> {
        add(
            &mut self.stiffness,
            Element::Stiffness(i, i),
            (i, i),
            stiffness,
        )?;
        Ok(self)
    }

    /// A damper between a coordinate and the ground, added to what is there: f_i = −c v_i. c may be
    /// negative.
    ///
    /// # Errors
    ///
    /// As for [`with_ground_spring`](Self::with_ground_spring).
    pub fn with_ground_damper(mut self, i: usize, damping: f64) -> Result<Self, Error> {
        add(&mut self.damping, Element::Damping(i, i), (i, i), damping)?;
        Ok(self)
    }

    /// A stiffness matrix, added to what is there. It need not be symmetric.
    ///
    /// # Errors
    ///
    /// [`Error::WrongSize`] unless it has a row and a column for each coordinate;
    /// [`Error::BadElement`] with the first entry that is not finite, in it or in the sum.
    #[allow(clippy::needless_pass_by_value)] // as the other builders take what they are given
    pub fn with_stiffness(mut self, stiffness: DMatrix<f64>) -> Result<Self, Error> {
        let names = [
            "rows of the stiffness matrix",
            "columns of the stiffness matrix",
        ];
        add_matrix(&mut self.stiffness, &stiffness, names, Element::Stiffness)?;
        Ok(self)
    }

    /// A damping matrix, added to what is there. It need not be symmetric.
    ///
    /// # Errors
    ///
    /// As for [`with_stiffness`](Self::with_stiffness).
    #[allow(clippy::needless_pass_by_value)]
    pub fn with_damping(mut self, damping: DMatrix<f64>) -> Result<Self, Error> {
        let names = [
            "rows of the damping matrix",
            "columns of the damping matrix",
        ];
        add_matrix(&mut self.damping, &damping, names, Element::Damping)?;
        Ok(self)
    }

    /// A force f_i(t) on a coordinate, added to what is there.
    ///
    /// # Errors
    ///
    /// [`Error::NoSuchCoordinate`]; [`Error::BadElement`] if the force, or its sum with what is
    /// there, is not finite.
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

    /// A contact, with the next number.
    ///
    /// # Errors
    ///
    /// * [`Error::NoSuchCoordinate`] for its own coordinate and those of its load;
    /// * [`Error::CoordinateTaken`] if that coordinate has one already;
    /// * [`Error::BeltVelocityJumps`], and [`Error::BadElement`] if that velocity is not finite.
    pub fn with_contact(mut self, contact: Contact<L, Z>) -> Result<Self, Error> {
        contact.support().check(self.contacts.len(), self.len())?;
        let coordinate = contact.coordinate();
        if let Some(taken) = self.contact_of(coordinate) {
            return Err(Error::CoordinateTaken {
                coordinate,
                contact: taken,
            });
        }
        self.contacts.push(contact);
        Ok(self)
    }

    /// Number of coordinates, at least 1.
    #[allow(clippy::len_without_is_empty)] // it never is
    pub fn len(&self) -> usize {
        self.masses.len()
    }

    /// Mass of each coordinate.
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// K, in units of force per displacement.
    pub fn stiffness(&self) -> &DMatrix<f64> {
        &self.stiffness
    }

    /// C, in units of force per velocity.
    pub fn damping(&self) -> &DMatrix<f64> {
        &self.damping
    }

    /// Force f_i(t) on each coordinate.
    pub fn forces(&self) -> &[Drive] {
        &self.forces
    }

    /// The contacts, by their numbers.
    pub fn contacts(&self) -> &[Contact<L, Z>] {
        &self.contacts
    }

    /// The least common period of all drives: forces, loads and belts. `None` if all are constant,
    /// or if they have none, as for [`Drive::period`].
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

    /// The same motion seen from a frame that oscillates with all belts: at the displacement W(t)
    /// and the velocity W'(t), harmonics both.
    pub(crate) fn seen_from(&self, velocity: &Drive, displacement: &Drive) -> Result<Self, Error>
    where
        L: Clone,
    {
        let mut seen = self.clone();
        let acceleration = velocity.derivative()?;
        for (i, mass) in self.masses.iter().enumerate() {
            let [damping, stiffness] = [&self.damping, &self.stiffness].map(|m| m.row(i).sum());
            let parts = [
                (&acceleration, *mass),
                (velocity, damping),
                (displacement, stiffness),
            ];
            for (part, factor) in parts {
                seen = seen.with_force(i, part.scaled(-factor)?)?;
            }
        }
        for contact in &mut seen.contacts {
            *contact = contact.seen_from(velocity, displacement)?;
        }
        Ok(seen)
    }

    /// All functions of time that act on it.
    pub(crate) fn drives(&self) -> impl Iterator<Item = &Drive> {
        let contacts = self.contacts.iter();
        let of_contacts = contacts.flat_map(|contact| [contact.load(), contact.belt_velocity()]);
        self.forces.iter().chain(of_contacts)
    }

    /// The number of the contact that a coordinate has.
    pub(crate) fn contact_of(&self, coordinate: usize) -> Option<usize> {
        let mut contacts = self.contacts.iter();
        contacts.position(|contact| contact.coordinate() == coordinate)
    }
}

impl<const Z: usize, L: ContactLaw<Z>> Structure<L, Z> {
    /// What moves, as the engine sees it.
    pub(crate) fn model(&self) -> Model<'_> {
        Model::new(
            Cow::Borrowed(&self.masses),
            [&self.stiffness, &self.damping],
            Cow::Borrowed(&self.forces),
            self.contacts.iter().map(Contact::support).collect(),
            Rc::new(self.laws()),
        )
    }

    /// The laws of its contacts.
    pub(crate) fn laws(&self) -> Typed<'_, L, Z> {
        Typed(self.contacts.iter().map(Contact::law).collect())
    }

    /// Steady sliding: every mass stands still, every belt moves under its mass, and what contacts
    /// remember stays as it is.
    ///
    /// `None` unless all drives are constant, every belt moves, every load is positive there, and
    /// the place is unique: nothing may be free to turn or to travel as a whole. So hold one end:
    /// a string that is turned at a given speed has a spring to the ground where seen from a frame
    /// that turns with it. See [`SteadySliding`] for formulas and an example.
    pub fn steady_sliding(&self) -> Option<SteadySliding> {
        SteadySliding::of(self)
    }
}

/// The mass on a belt as a structure of one coordinate, with contact 0: m = 1, K = 1, C = 2β, load
/// γ², belt velocity v_b. Its motions have the same events.
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
impl<L: Clone> From<&MassOnBelt<L>> for Structure<L> {
    fn from(belt: &MassOnBelt<L>) -> Self {
        let contact = Contact::of_belt(belt);
        Self {
            masses: vec![1.0],
            stiffness: DMatrix::from_element(1, 1, 1.0),
            damping: DMatrix::from_element(1, 1, 2.0 * belt.damping()),
            forces: vec![Drive::constant(0.0)],
            contacts: vec![contact],
        }
    }
}

/// Whether a structure may have these masses.
fn check_masses(masses: &[f64]) -> Result<(), Error> {
    let n = masses.len();
    Error::check(
        "Structure",
        "masses",
        n as f64,
        n > 0,
        "at least one: their number",
    )?;
    for (i, &mass) in masses.iter().enumerate() {
        Error::check("Structure", "mass", mass, mass > 0.0, "mass > 0")
            .map_err(|error| error.of_element(Element::Mass(i)))?;
    }
    Ok(())
}

/// Adds a value at one place of a matrix of a structure.
fn add(
    matrix: &mut DMatrix<f64>,
    element: Element,
    (i, j): (usize, usize),
    value: f64,
) -> Result<(), Error> {
    let count = matrix.nrows();
    for coordinate in [i, j] {
        if coordinate >= count {
            return Err(Error::NoSuchCoordinate {
                element,
                coordinate,
                count,
            });
        }
    }
    let sum = matrix[(i, j)] + value;
    Error::check("Structure", "value", value, sum.is_finite(), "a finite sum")
        .map_err(|error| error.of_element(element))?;
    matrix[(i, j)] = sum;
    Ok(())
}

/// Adds what connects two coordinates.
fn add_between(
    matrix: &mut DMatrix<f64>,
    element: Element,
    (i, j): (usize, usize),
    value: f64,
) -> Result<(), Error> {
    if i == j {
        return Err(Error::BadElement {
            element,
            value,
            allowed: "between two different coordinates; there is another method for the ground",
        });
    }
    for (row, column, sign) in [(i, i, 1.0), (j, j, 1.0), (i, j, -1.0), (j, i, -1.0)] {
        add(matrix, element, (row, column), sign * value)?;
    }
    Ok(())
}

/// Adds a whole matrix.
fn add_matrix(
    matrix: &mut DMatrix<f64>,
    added: &DMatrix<f64>,
    [rows, columns]: [&'static str; 2],
    element: impl Fn(usize, usize) -> Element,
) -> Result<(), Error> {
    let expected = matrix.nrows();
    for (name, found) in [(rows, added.nrows()), (columns, added.ncols())] {
        if found != expected {
            return Err(Error::WrongSize {
                name,
                found,
                expected,
            });
        }
    }
    for i in 0..expected {
        for j in 0..expected {
            add(matrix, element(i, j), (i, j), added[(i, j)])?;
        }
    }
    Ok(())
}
