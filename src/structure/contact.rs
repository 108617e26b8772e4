use std::borrow::Cow;
use std::fmt;
use std::sync::Arc;

use super::direction::{add_entry, check_coordinates, checked_direction};
use super::engine::contact_data::ContactData;
use super::engine::element_data::ElementData;
use super::force_element::ForceElement;
use crate::belt::MassOnBelt;
use crate::drive::Drive;
use crate::error::{Element, Error};
use crate::force::ForceLaw;
use crate::friction::FrictionLaw;
use crate::friction::memory::object::LawObject;
use crate::friction::memory::{ContactLaw, Freewheel, Slip, validate};
use crate::state::structure::State;

/// A friction contact: its direction, its law, its normal load, and the velocity of the surface on
/// which it slides.
///
/// ```text
/// r = b·v − w(t)              relative velocity
/// λ = N μ(r)                  friction force in slip; the force on the structure is −b λ
/// N = N0(t) + Σ n_j q_j + k_n d·q + Σ φ(a·q, a·v)     the normal load
/// ```
///
/// q and v are the displacements and velocities of the coordinates, b is the direction of the
/// contact, and w is the velocity of the surface. μ is the friction coefficient, N0 the part of the
/// load that depends on time, n_j the load gradient, a force per displacement, k_n d·q the force of
/// a [normal spring](Self::with_normal_spring), and φ a [load law](Self::with_load_law). μ, b and d
/// are dimensionless. If b is multiplied by a factor, so are b·v and the force −b λ, but not w and
/// N.
///
/// In the table e_i is the i-th unit vector:
///
/// | contact | b | r |
/// |---|---|---|
/// | [`Contact::new(i, ..)`](Self::new) | e_i | v_i − w: mass i on a belt or on the ground |
/// | [`Contact::between(i, j, ..)`](Self::between) | e_i − e_j | v_i − v_j − w: a clutch, a damper between blades, a pad on a disc |
/// | [`Contact::freewheel(i, j)`](Self::freewheel) | e_i − e_j | v_i − v_j − w ≤ 0: a one-way clutch |
/// | [`Contact::along(&[(i, b_i), ..], ..)`](Self::along) | any | Σ b_i v_i − w: a lever, a gear, a point of a reduced model by its mode shapes |
///
/// A contact is open, and transmits no friction, while N is negative or stays 0. If the load
/// depends on time alone, or has a load law, the contact may open and close again. A load gradient
/// without a load law describes a normal spring that is part of the stiffness matrix. That spring
/// would pull for N < 0, so the motion ends with [`Error::Separation`] when the contact would open.
/// To let the contact open and close, use [`with_normal_spring`](Self::with_normal_spring) instead.
///
/// A contact is either rigid or [elastic](Self::with_tangential_stiffness). An elastic contact is a
/// spring in series with a friction slider.
///
/// A load that only touches 0 does not open or close its contact. A stick force that only touches
/// its limit does not end stick. To touch means to reach the value and to return to the same side
/// of it. A local extremum of the load counts as a touch if its distance from 0 is at most 8ε times
/// the sum of the absolute values of the terms of the load (ε = 2.2e-16). A local extremum of the
/// stick force counts as a touch if it exceeds the limit by at most 8ε times the limit. A
/// [profile](Drive::profile) through the values 1, 0 and 1 touches 0 at its second point.
///
/// The type of the law is not part of the type of the contact, so a structure may have contacts
/// with different laws.
///
/// ```
/// use stick_slip::{Contact, Coulomb, Drive};
///
/// // On coordinate 1, pressed by 5 + 0.3·q_0, on a belt that starts at t = 2.
/// let law = Coulomb::new(0.4, 0.25)?;
/// let belt = Drive::profile(&[(2.0, 0.0), (4.0, 0.1)])?;
/// let contact = Contact::new(1, law, 5.0)?.with_load_gradient(0, 0.3)?.on_belt(belt);
/// assert_eq!(contact.direction(), [(1, 1.0)]);
/// assert_eq!(contact.load_at(0.0, &[1.0, 0.0]), 5.3);
///
/// // A clutch between shafts 0 and 1.
/// let clutch = Contact::between(0, 1, law, Drive::profile(&[(0.0, 0.0), (0.5, 40.0)])?)?;
/// assert_eq!(clutch.direction(), [(0, 1.0), (1, -1.0)]);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Clone)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::ContactText<super::read::LawText>"),
    serde(
        into = "super::read::ContactText<super::read::Written<crate::friction::memory::NamedLaw>>"
    )
)]
pub struct Contact {
    /// The coordinate given first, by which errors and `coordinate` name the contact.
    coordinate: usize,
    /// b by ascending coordinate; none is 0.
    direction: Vec<(usize, f64)>,
    law: Arc<dyn LawObject + Send + Sync>,
    pub(super) load: Arc<Drive>,
    /// n_j by ascending coordinate j; none is 0.
    pub(super) load_gradient: Vec<(usize, f64)>,
    /// The laws φ of the load, each with its direction a.
    load_laws: Vec<ForceElement>,
    belt_velocity: Arc<Drive>,
    /// k_t of an elastic contact.
    pub(super) tangential_stiffness: Option<f64>,
    /// d by ascending coordinate, and k_n.
    pub(super) normal_spring: Option<(Vec<(usize, f64)>, f64)>,
}

impl Contact {
    /// Creates a contact between one coordinate and a surface at rest, with a law and a normal load
    /// N0(t).
    ///
    /// # Errors
    ///
    /// * [`Error::InvalidParameter`] if the load is not finite, if μ_s is negative or not finite,
    ///   if friction at speed 0 does not oppose slip, or if the law breaks another rule of
    ///   [`ContactLaw`];
    /// * the errors of [`MassOnBelt::new`](crate::MassOnBelt::new) that concern the law.
    pub fn new<L: ContactLaw + Send + Sync + 'static>(
        coordinate: usize,
        law: L,
        load: impl Into<Drive>,
    ) -> Result<Self, Error> {
        Self::along(&[(coordinate, 1.0)], law, load)
    }

    /// Creates a contact between two coordinates, r = v_i − v_j, with a law and a normal load
    /// N0(t).
    ///
    /// # Errors
    ///
    /// [`Error::BadDirection`] if i = j; the errors of [`new`](Self::new).
    pub fn between<L: ContactLaw + Send + Sync + 'static>(
        i: usize,
        j: usize,
        law: L,
        load: impl Into<Drive>,
    ) -> Result<Self, Error> {
        Self::along(&[(i, 1.0), (j, -1.0)], law, load)
    }

    /// Creates a freewheel (one-way clutch) between two coordinates, without drag: r = v_i − v_j
    /// ≤ 0. It drives coordinate j by coordinate i, and lets j run ahead.
    ///
    /// Its force λ ≥ 0 keeps r at 0. In the common decision of several contacts, its limit forward
    /// is infinite; see [`Freewheel`], also for freewheels along any direction. A start with r > 0
    /// is refused with [`Error::WrongWay`]. If several freewheels would need an infinite force, the
    /// motion ends with [`Error::Jammed`].
    ///
    /// # Errors
    ///
    /// [`Error::BadDirection`] if i = j.
    ///
    /// ```
    /// use stick_slip::{Contact, Drive, Structure, structure::State};
    ///
    /// // A torque of sin t drives two shafts while it is positive; then shaft 1 runs ahead.
    /// let shafts = Structure::new(&[1.0, 3.0])?
    ///     .with_force(0, Drive::constant(0.0).with_sine(1.0, 1.0)?)?
    ///     .with_contact(Contact::freewheel(0, 1)?)?;
    /// let motion = shafts.simulate(State::at_rest(2), 4.0)?;
    /// assert!((motion.events()[0].time - std::f64::consts::PI).abs() < 1e-14);
    /// assert!((motion.last().velocities[1] - 0.5).abs() < 1e-15);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn freewheel(i: usize, j: usize) -> Result<Self, Error> {
        Self::between(i, j, Freewheel::without_drag()?, 1.0)
    }

    /// Gives a freewheel the drag of a friction law under a normal load, in place of its law and
    /// its load. While the load is not positive, the freewheel is open.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if the contact is no freewheel; the errors of
    /// [`new`](Self::new).
    pub fn with_drag<L: FrictionLaw + Send + Sync + 'static>(
        mut self,
        law: L,
        load: impl Into<Drive>,
    ) -> Result<Self, Error> {
        let [_, forward] = self.law.limits(&|_| 0.0).unwrap_or([0.0; 2]);
        if forward != f64::INFINITY {
            return Err(Error::InvalidParameter {
                of: "Contact",
                name: "static_coefficient forward",
                value: forward,
                allowed: "an infinite one, that of a `Contact::freewheel`, for `with_drag`",
            });
        }
        self.law = Arc::new(Freewheel::new(law)?);
        let load = load.into();
        load.check("load", LOAD)?;
        self.load = Arc::new(load);
        Ok(self)
    }

    /// Creates a contact with the relative velocity r = Σ b_i v_i of the given coordinates, with a
    /// law and a normal load N0(t).
    ///
    /// # Errors
    ///
    /// [`Error::BadDirection`] if no coordinate is given, if a coordinate is given twice, if a b_i
    /// is not finite, or if all b_i are 0; the errors of [`new`](Self::new).
    pub fn along<L: ContactLaw + Send + Sync + 'static>(
        direction: &[(usize, f64)],
        law: L,
        load: impl Into<Drive>,
    ) -> Result<Self, Error> {
        let load = load.into();
        load.check("load", LOAD)?;
        validate(&law, load.value(0.0).max(0.0))?;
        let (coordinate, direction) = checked_direction(direction)?;
        Ok(Self {
            coordinate,
            direction,
            law: Arc::new(law),
            load: Arc::new(load),
            load_gradient: Vec::new(),
            load_laws: Vec::new(),
            belt_velocity: Arc::new(Drive::constant(0.0)),
            tangential_stiffness: None,
            normal_spring: None,
        })
    }

    /// The contact of a mass on a belt.
    pub(super) fn of_belt<L>(belt: &MassOnBelt<L>) -> Self
    where
        L: ContactLaw + Clone + Send + Sync + 'static,
    {
        Self {
            coordinate: 0,
            direction: vec![(0, 1.0)],
            law: Arc::new(belt.law().clone()),
            load: Arc::new(Drive::constant(belt.load())),
            load_gradient: Vec::new(),
            load_laws: Vec::new(),
            belt_velocity: Arc::new(Drive::constant(belt.belt_velocity())),
            tangential_stiffness: None,
            normal_spring: None,
        }
    }

    /// Sets the velocity w(t) of the surface, such as a belt, on which the contact slides. In a
    /// contact between two coordinates, w(t) is subtracted from their relative velocity.
    ///
    /// The velocity must not jump, except at an elastic contact and under a law that never sticks;
    /// [`Structure::with_contact`](crate::Structure::with_contact) checks this.
    pub fn on_belt(mut self, velocity: impl Into<Drive>) -> Self {
        self.belt_velocity = Arc::new(velocity.into());
        self
    }

    /// Adds n q to the normal load of the contact. q is the displacement of the coordinate, and n
    /// is the gradient, a force per displacement.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if n is not finite, or if the sum of n and the gradient already
    /// set for this coordinate is not finite.
    pub fn with_load_gradient(mut self, coordinate: usize, gradient: f64) -> Result<Self, Error> {
        let sum = add_entry(&mut self.load_gradient, coordinate, gradient);
        Error::check(
            "Contact",
            "gradient",
            gradient,
            sum.is_finite(),
            "a finite sum",
        )?;
        Ok(self)
    }

    /// Adds φ(x, y) to the normal load of the contact: a load of any shape.
    ///
    /// ```text
    /// N = N0(t) + Σ n_j q_j + Σ φ(x, y),   x = a·q,   y = a·v
    /// ```
    ///
    /// The direction a is a list of pairs (j, a_j), dimensionless; φ is the
    /// [`force`](ForceLaw::force) of the law, in units of force. Several laws add up. The law acts
    /// on the load alone: if the force that presses the contact also acts on the structure, give
    /// the same law to a [`ForceElement`], or use a [normal spring](Self::with_normal_spring),
    /// whose force on the structure is −d N with all terms of N.
    ///
    /// The contact opens when N falls below 0, and closes when N rises above 0 again; N0 may be
    /// negative or 0. The contact must be rigid. A [potential](ForceLaw::potential) is not used.
    ///
    /// # Errors
    ///
    /// * [`Error::BadDirection`] if no coordinate is given, if a coordinate is given twice, if an
    ///   a_j is not finite, or if all a_j are 0;
    /// * [`Error::BadBreakpoints`] for the first breakpoint of the law that is not finite, does not
    ///   ascend, or at which φ jumps;
    /// * [`Error::InvalidParameter`] if the contact is elastic, or if the slope of the law's
    ///   potential is not its force at rest.
    ///
    /// ```
    /// use stick_slip::{Contact, Coulomb, ForceLaw, Scalar, Structure, structure::State};
    ///
    /// /// A bead of mass 1 that slides on a horizontal ring of radius 2, without weight: the ring
    /// /// presses with the centripetal force v²/2.
    /// struct Ring;
    /// impl ForceLaw for Ring {
    ///     fn force<S: Scalar>(&self, _: S, velocity: S, _: usize) -> S {
    ///         velocity.square() / 2.0
    ///     }
    /// }
    ///
    /// let ring = Contact::new(0, Coulomb::new(0.3, 0.3)?, 0.0)?.with_load_law(&[(0, 1.0)], Ring)?;
    /// let bead = Structure::new(&[1.0])?.with_contact(ring)?;
    /// let motion = bead.simulate(State::new(&[0.0], &[3.0]), 10.0)?;
    /// // v' = −0.3 v²/2: the bead never stops.
    /// let v = 3.0 / (1.0 + 0.15 * 3.0 * 10.0);
    /// assert!((motion.last().velocities[0] - v).abs() < 1e-15);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn with_load_law<L: ForceLaw + Send + Sync + 'static>(
        mut self,
        direction: &[(usize, f64)],
        law: L,
    ) -> Result<Self, Error> {
        self.load_laws.push(ForceElement::along(direction, law)?);
        self.check_load_laws()?;
        Ok(self)
    }

    /// The laws φ of the normal load, each with its direction a.
    pub fn load_laws(&self) -> &[ForceElement] {
        &self.load_laws
    }

    /// Checks that the contact may close: without a force of the structure that presses it, a
    /// constant load is positive.
    pub(super) fn check_load(&self) -> Result<(), Error> {
        let value = self.load.value(0.0);
        let is_pressed = self.normal_spring.is_some() || !self.load_laws.is_empty();
        let is_allowed = value > 0.0 || is_pressed || !self.load.is_constant();
        Error::check("Contact", "load", value, is_allowed, LOAD).map(drop)
    }

    /// Sets the laws of the load.
    pub(super) fn with_load_laws(mut self, laws: Vec<ForceElement>) -> Result<Self, Error> {
        self.load_laws = laws;
        self.check_load_laws()?;
        Ok(self)
    }

    /// Checks that an elastic contact has no load law.
    pub(super) fn check_load_laws(&self) -> Result<(), Error> {
        let count = self.load_laws.len();
        let is_allowed = count == 0 || self.tangential_stiffness.is_none();
        let allowed = "no load law at an elastic contact; give the slider a mass: a coordinate of \
                       its own, with a spring of stiffness k_t to the structure and a rigid \
                       contact with this load";
        Error::check("Contact", "load laws", count as f64, is_allowed, allowed).map(drop)
    }

    /// Number, counted from 0, of the coordinate that was given first.
    /// [`direction`](Self::direction) lists all coordinates.
    pub fn coordinate(&self) -> usize {
        self.coordinate
    }

    /// The direction b: pairs of a coordinate i and its coefficient b_i ≠ 0 (dimensionless), by
    /// ascending i.
    pub fn direction(&self) -> &[(usize, f64)] {
        &self.direction
    }

    /// N0(t), the part of the normal load that depends on time, in units of force.
    pub fn load(&self) -> &Drive {
        &self.load
    }

    /// The load gradient: pairs of a coordinate j and its n_j ≠ 0, in units of force per
    /// displacement, by ascending j.
    pub fn load_gradient(&self) -> &[(usize, f64)] {
        &self.load_gradient
    }

    /// Velocity w(t) of the surface on which the contact slides.
    pub fn belt_velocity(&self) -> &Drive {
        &self.belt_velocity
    }

    /// Normal load N = N0(t) + Σ n_j q_j + k_n d·q + Σ φ(a·q, 0) at a time, in units of force; NaN
    /// if a displacement is missing. The term k_n d·q is the force of a [normal
    /// spring](Self::with_normal_spring) of stiffness k_n and direction d. [Load
    /// laws](Self::with_load_law) φ are taken at rest: see [`load_in`](Self::load_in). The result
    /// may be negative: the contact is then open, and its forces are 0. With a load gradient and
    /// without a normal spring or a load law, a motion ends with [`Error::Separation`] before N
    /// becomes negative.
    pub fn load_at(&self, time: f64, displacements: &[f64]) -> f64 {
        self.load_with(time, displacements, |_| 0.0)
    }

    /// Normal load in a state at a time, in units of force: [`load_at`](Self::load_at) with the
    /// velocities of the state.
    pub fn load_in(&self, time: f64, state: &State) -> f64 {
        let velocity = |j: usize| state.velocities.get(j).copied().unwrap_or(f64::NAN);
        self.load_with(time, &state.displacements, velocity)
    }

    fn load_with(&self, time: f64, displacements: &[f64], velocity: impl Fn(usize) -> f64) -> f64 {
        let displacement = |j: usize| displacements.get(j).copied().unwrap_or(f64::NAN);
        let gradient = self.whole_gradient().into_iter();
        let terms = gradient.map(|(j, n)| n * displacement(j));
        let linear = self.load.value(time) + terms.sum::<f64>();
        let laws = self.load_data();
        laws.fold(linear, |sum, law| {
            sum + law.pressure(time, &displacement, &velocity)
        })
    }

    /// Coordinates with the derivative of the load by their displacements, that of a normal spring
    /// included.
    pub(super) fn whole_gradient(&self) -> Vec<(usize, f64)> {
        let mut gradient = self.load_gradient.clone();
        if let Some((direction, k)) = &self.normal_spring {
            for &(j, d) in direction {
                add_entry(&mut gradient, j, k * d);
            }
        }
        gradient
    }

    /// The larger μ_s and the smaller μ̂(0) of both directions, with a memory of zeros; `None` if
    /// it never sticks.
    pub(super) fn coefficients_at_rest(&self) -> Option<[f64; 2]> {
        let [backward, forward] = self.law.limits(&|_| 0.0)?;
        let kinetic = [-1.0, 1.0].map(|direction| {
            let slip = Slip {
                speed: 0.0,
                direction,
                piece: 0,
            };
            direction * self.law.coefficient(slip, &|_| 0.0)
        });
        Some([backward.max(forward), kinetic[0].min(kinetic[1])])
    }

    /// The law of the contact, without its type.
    pub(super) fn law(&self) -> &(dyn LawObject + Send + Sync) {
        &*self.law
    }

    /// The contact as the engine needs it.
    pub(super) fn data(&self) -> ContactData<'_> {
        let mut data = ContactData::new(
            Cow::Borrowed(&self.direction),
            &*self.law,
            [&self.load, &self.belt_velocity].map(Arc::clone),
            self.whole_gradient(),
        );
        data.tangential_stiffness = self.tangential_stiffness;
        if let Some((direction, _)) = &self.normal_spring {
            data.normal = direction;
        }
        data
    }

    /// The laws of its load as the engine needs them.
    pub(super) fn load_data(&self) -> impl Iterator<Item = ElementData<'_>> {
        self.load_laws.iter().map(ForceElement::data)
    }

    /// Checks that this may be contact number `number` of a structure with these masses.
    pub(super) fn check(&self, number: usize, masses: &[f64]) -> Result<(), Error> {
        let element = Element::Contact(number);
        let direction = self.direction.iter().map(|&(j, _)| j);
        // Both parts of the gradient: they may cancel.
        let normal = self.normal_spring.iter().flat_map(|(normal, _)| normal);
        let gradients = self.load_gradient.iter().chain(normal).map(|&(j, _)| j);
        let laws = self.load_laws.iter().flat_map(ForceElement::directions);
        let laws = laws.flatten().map(|&(j, _)| j);
        let coordinates = std::iter::once(self.coordinate)
            .chain(direction)
            .chain(gradients)
            .chain(laws);
        check_coordinates(element, coordinates, masses.len())?;
        // At most bᵀM⁻¹b, by which forces are divided: digits are lost below the normal numbers.
        let parts = self.direction.iter().map(|&(j, b)| b / masses[j] * b);
        let compliance = parts.sum();
        let has_digits = (1e-290..=1e290).contains(&compliance);
        let allowed = "1e-290 ≤ Σ b_j²/m_j ≤ 1e290; change the unit of mass or of the direction";
        Error::check("Structure", "direction", compliance, has_digits, allowed)
            .map_err(|error| error.of_element(element))?;
        self.belt_velocity
            .check("belt_velocity", "a belt velocity of any size")
            .map_err(|error| error.of_element(element))?;
        let may_stick = self.law.limits(&|_| 0.0).is_some();
        match self.belt_velocity.first_jump() {
            Some(time) if self.tangential_stiffness.is_none() && may_stick => {
                Err(Error::BeltVelocityJumps {
                    coordinate: self.coordinate,
                    time,
                })
            }
            _ => Ok(()),
        }
    }
}

/// Compares the data of two contacts. Laws of this crate are equal if their types and numbers are
/// equal. A law of your own is equal only to itself, in a clone of its contact.
impl PartialEq for Contact {
    fn eq(&self, other: &Self) -> bool {
        let laws = [&self.law, &other.law];
        let is_same_law = match laws.map(|law| law.named()) {
            [Some(one), Some(other)] => one == other,
            _ => Arc::ptr_eq(&self.law, &other.law),
        };
        is_same_law
            && self.direction == other.direction
            && self.load == other.load
            && self.load_gradient == other.load_gradient
            && self.load_laws == other.load_laws
            && self.belt_velocity == other.belt_velocity
            && self.tangential_stiffness == other.tangential_stiffness
            && self.normal_spring == other.normal_spring
    }
}

impl fmt::Debug for Contact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let law: &dyn LawObject = &*self.law;
        f.debug_struct("Contact")
            .field("direction", &self.direction)
            .field("law", &law)
            .field("load", &self.load)
            .field("load_gradient", &self.load_gradient)
            .field("load_laws", &self.load_laws)
            .field("belt_velocity", &self.belt_velocity)
            .field("tangential_stiffness", &self.tangential_stiffness)
            .field("normal_spring", &self.normal_spring)
            .finish()
    }
}

/// The allowed values of a load.
const LOAD: &str = "load > 0; a constant load ≤ 0 is a gap, which needs a normal spring or a load \
                    law that closes it: see `Contact::with_normal_spring` and \
                    `Contact::with_load_law`";
