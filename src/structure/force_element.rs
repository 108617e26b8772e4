use std::borrow::Cow;
use std::sync::Arc;

use super::direction::{check_coordinates, checked_direction};
use super::engine::element_data::ElementData;
use crate::drive::Drive;
use crate::error::{Element, Error};
use crate::force::object::{OneDirection, SeveralDirections};
use crate::force::{ForceField, ForceLaw, SharedForce, validate};

/// A force that is not linear in displacements and velocities: a nonlinear spring or damper between
/// coordinates, a pendulum, backlash, or a force of several coordinates.
///
/// ```text
/// force on the structure  −D(t) Σ_i a_i F_i(x, y),   x_i = a_i·q,   y_i = a_i·v
/// ```
///
/// q and v are the displacements and velocities of the coordinates, a_i are constant directions
/// (dimensionless), F is the [`ForceLaw`] or [`ForceField`] of the element, and D(t) its factor, 1
/// unless [set](Self::with_factor). A factor with a linear law is a stiffness that varies in time.
///
/// In the table e_i is the i-th unit vector:
///
/// | element | x | y |
/// |---|---|---|
/// | [`ForceElement::new(i, ..)`](Self::new) | q_i | v_i |
/// | [`ForceElement::between(i, j, ..)`](Self::between) | q_i − q_j | v_i − v_j |
/// | [`ForceElement::along(&[(j, a_j), ..], ..)`](Self::along) | Σ a_j q_j | Σ a_j v_j |
/// | [`ForceElement::field(&[&[..], ..], ..)`](Self::field) | one for each direction | |
///
/// The mass matrix is constant, so inertia that depends on displacements (a double pendulum)
/// cannot be described; forces of any shape can. Events of contacts are unchanged: the force is
/// continuous. A passage of a breakpoint of the law ends a step, but is no event. Elements are
/// equal if their data are; a law of your own is equal only to itself, in a clone of its element.
///
/// ```
/// use stick_slip::{ForceElement, ForceLaw, Scalar, Structure, structure::State};
///
/// struct Duffing;
/// impl ForceLaw for Duffing {
///     fn force<S: Scalar>(&self, x: S, _: S, _: usize) -> S {
///         x + x.powi(3) * 0.7
///     }
/// }
///
/// // Free vibration on a hardening spring, F = x + 0.7 x³ (Duffing), from x = 2: its period is
/// // 4 K(m)/Ω with Ω² = 1 + 0.7·4 and m = 0.7·4/(2Ω²), where K is the elliptic integral.
/// let spring = ForceElement::new(0, Duffing)?;
/// let duffing = Structure::new(&[1.0])?.with_element(spring)?;
/// let period = 3.603712656168182309250034;
/// let motion = duffing.simulate(State::new(&[2.0], &[0.0]), period)?;
/// assert!((motion.last().displacements[0] - 2.0).abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::ElementText<crate::force::NamedForce>"),
    serde(into = "super::read::ElementText<super::read::Written<crate::force::NamedForce>>")
)]
pub struct ForceElement {
    /// a_i, each by ascending coordinate; no entry is 0.
    directions: Vec<Vec<(usize, f64)>>,
    law: SharedForce,
    factor: Arc<Drive>,
}

impl ForceElement {
    /// Creates an element between one coordinate and the ground, x = q_i.
    ///
    /// # Errors
    ///
    /// * [`Error::BadBreakpoints`] for the first breakpoint of the law that is not finite, does not
    ///   ascend, or at which the force jumps;
    /// * [`Error::InvalidParameter`] if the slope of the law's potential is not its force at rest
    ///   (compared at five positions).
    pub fn new<L: ForceLaw + Send + Sync + 'static>(
        coordinate: usize,
        law: L,
    ) -> Result<Self, Error> {
        Self::along(&[(coordinate, 1.0)], law)
    }

    /// Creates an element between two coordinates, x = q_i − q_j: it pulls i and j together if F is
    /// positive.
    ///
    /// # Errors
    ///
    /// [`Error::BadDirection`] if i = j; the errors of [`new`](Self::new).
    pub fn between<L: ForceLaw + Send + Sync + 'static>(
        i: usize,
        j: usize,
        law: L,
    ) -> Result<Self, Error> {
        Self::along(&[(i, 1.0), (j, -1.0)], law)
    }

    /// Creates an element along any direction a, x = Σ a_j q_j: an oblique spring, or a point of a
    /// reduced model by its mode shapes.
    ///
    /// # Errors
    ///
    /// [`Error::BadDirection`] if no coordinate is given, if a coordinate is given twice, if an a_j
    /// is not finite, or if all a_j are 0; the errors of [`new`](Self::new).
    pub fn along<L: ForceLaw + Send + Sync + 'static>(
        direction: &[(usize, f64)],
        law: L,
    ) -> Result<Self, Error> {
        Self::with(&[direction], SharedForce::new(OneDirection(law)))
    }

    /// Creates an element of several directions a_i, x_i = Σ_j a_ij q_j.
    ///
    /// # Errors
    ///
    /// [`Error::WrongSize`] unless there are as many directions as the field has;
    /// [`Error::BadDirection`] for the first direction at fault, as in [`along`](Self::along);
    /// [`Error::InvalidParameter`] if a slope of the potential is not the force at rest.
    pub fn field<F: ForceField + Send + Sync + 'static>(
        directions: &[&[(usize, f64)]],
        field: F,
    ) -> Result<Self, Error> {
        Self::with(directions, SharedForce::new(SeveralDirections(field)))
    }

    /// Creates an element with a law without its type.
    pub(super) fn with(directions: &[&[(usize, f64)]], law: SharedForce) -> Result<Self, Error> {
        let (found, expected) = (directions.len(), law.count());
        if found != expected {
            return Err(Error::WrongSize {
                name: "directions of the force element",
                found,
                expected,
            });
        }
        validate(&*law)?;
        let directions = directions
            .iter()
            .map(|given| Ok(checked_direction(given)?.1));
        Ok(Self {
            directions: directions.collect::<Result<_, Error>>()?,
            law,
            factor: Arc::new(Drive::constant(1.0)),
        })
    }

    /// Sets the factor D(t) of the force, dimensionless. With a linear law it is a stiffness or a
    /// damping constant that varies in time, such as that of meshing teeth.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if the factor is not finite at all times.
    pub fn with_factor(mut self, factor: impl Into<Drive>) -> Result<Self, Error> {
        let factor = factor.into();
        factor.check("factor", "a factor of any size")?;
        self.factor = Arc::new(factor);
        Ok(self)
    }

    /// The directions a_i: for each, pairs of a coordinate j and its a_ij ≠ 0 (dimensionless), by
    /// ascending j.
    pub fn directions(&self) -> &[Vec<(usize, f64)>] {
        &self.directions
    }

    /// The factor D(t), dimensionless.
    pub fn factor(&self) -> &Drive {
        &self.factor
    }

    /// Holds the factor at its value at a time.
    pub(super) fn frozen(&self, time: f64) -> Result<Self, Error> {
        self.clone().with_factor(self.factor.value(time))
    }

    #[cfg(feature = "serde")]
    pub(super) fn law(&self) -> &SharedForce {
        &self.law
    }

    /// The element as the engine needs it.
    pub(super) fn data(&self) -> ElementData<'_> {
        let directions = Cow::Borrowed(&self.directions[..]);
        ElementData::new(directions, &*self.law, Arc::clone(&self.factor))
    }

    /// Checks that this may be element number `number` of a structure with so many coordinates.
    pub(super) fn check(&self, number: usize, count: usize) -> Result<(), Error> {
        let coordinates = self.directions.iter().flatten().map(|&(j, _)| j);
        check_coordinates(Element::ForceElement(number), coordinates, count)
    }
}
