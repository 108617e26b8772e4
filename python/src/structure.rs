//! `Structure` with contacts and force elements.

use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use stick_slip::{Error, ForceElement, ForceLaw, Integrator, Structure, structure};

use crate::convert::{
    ComplexNumbers, Direction, Index, Matrix, Numbers, Points, Start, Table, float,
};
use crate::drive::DriveArgument;
use crate::error::OrRaise;
use crate::law::ContactLawArgument;
use crate::motion::{AnyMotion, PyMotion, ended_well};
use crate::record::record;
use crate::simulate::Settings;
use crate::traced::{TracedForce, pieces_of};
use crate::waiting::Waiting;

fn direction_text(direction: &[(usize, f64)]) -> String {
    let terms = direction.iter().map(|(i, b)| format!("{i}: {}", float(*b)));
    format!("{{{}}}", terms.collect::<Vec<_>>().join(", "))
}

/// A friction contact of a structure: relative velocity r = b v - w, friction force N mu(r).
///
/// Args:
///     direction: b. A coordinate i for a mass on a belt or the ground (b = e_i), a dict
///         {coordinate: coefficient} or pairs otherwise; dimensionless.
///         `Contact.between(i, j, ...)` is the direction {i: 1, j: -1}.
///     law: a friction law, or one with memory (`Dwell`, `Dahl`, `LuGre`).
///     load: the normal load, in units of force: a number or a Drive.
///     belt_velocity: w, the velocity of the surface, in units of velocity: a number or a Drive.
///     load_gradient: a dict {coordinate: force per displacement} that adds to the load; the normal
///         spring is then part of the stiffness matrix.
///     tangential_stiffness: of an elastic contact, a spring in series with the slider, force per
///         displacement. Its law must be Coulomb(mu, mu).
///     normal_spring: a pair (direction, stiffness) of a spring that presses, and can open.
///
/// >>> from stick_slip import Contact, Coulomb
/// >>> Contact.between(0, 1, Coulomb(0.4, 0.3), 5.0)
/// Contact({0: 1.0, 1: -1.0}, Coulomb(0.4, 0.3), 5.0)
#[pyclass(frozen, name = "Contact", module = "stick_slip")]
pub struct PyContact {
    contact: stick_slip::Contact,
    text: String,
}

/// The keyword arguments of a contact.
struct Options<'py> {
    belt_velocity: Option<DriveArgument<'py>>,
    load_gradient: Option<Direction>,
    tangential_stiffness: Option<f64>,
    normal_spring: Option<(Direction, f64)>,
}

fn drive_text(drive: &DriveArgument<'_>) -> PyResult<String> {
    Ok(match drive {
        DriveArgument::Number(value) => float(*value),
        DriveArgument::Drive(drive) => drive.repr()?.to_string(),
    })
}

impl PyContact {
    fn build(
        direction: &[(usize, f64)],
        law: &ContactLawArgument<'_>,
        load: &DriveArgument<'_>,
        options: Options<'_>,
    ) -> PyResult<Self> {
        let mut contact = law.contact(direction, load.drive()).or_raise()?;
        let mut text = format!(
            "{}, {}, {}",
            direction_text(direction),
            law.text(),
            drive_text(load)?
        );
        if let Some(velocity) = options.belt_velocity {
            text += &format!(", belt_velocity={}", drive_text(&velocity)?);
            contact = contact.on_belt(velocity.drive());
        }
        if let Some(Direction(gradient)) = options.load_gradient {
            text += &format!(", load_gradient={}", direction_text(&gradient));
            for (coordinate, gradient) in gradient {
                contact = contact
                    .with_load_gradient(coordinate, gradient)
                    .or_raise()?;
            }
        }
        if let Some(stiffness) = options.tangential_stiffness {
            text += &format!(", tangential_stiffness={}", float(stiffness));
            contact = contact.with_tangential_stiffness(stiffness).or_raise()?;
        }
        if let Some((Direction(direction), stiffness)) = options.normal_spring {
            let spring = (direction_text(&direction), float(stiffness));
            text += &format!(", normal_spring=({}, {})", spring.0, spring.1);
            contact = contact
                .with_normal_spring(&direction, stiffness)
                .or_raise()?;
        }
        Ok(Self {
            contact,
            text: format!("Contact({text})"),
        })
    }
}

#[pymethods]
impl PyContact {
    #[new]
    #[pyo3(signature = (direction, law, load, *, belt_velocity = None, load_gradient = None,
        tangential_stiffness = None, normal_spring = None))]
    fn new(
        direction: Direction,
        law: ContactLawArgument<'_>,
        load: DriveArgument<'_>,
        belt_velocity: Option<DriveArgument<'_>>,
        load_gradient: Option<Direction>,
        tangential_stiffness: Option<f64>,
        normal_spring: Option<(Direction, f64)>,
    ) -> PyResult<Self> {
        let options = Options {
            belt_velocity,
            load_gradient,
            tangential_stiffness,
            normal_spring,
        };
        Self::build(&direction.0, &law, &load, options)
    }

    /// A contact between coordinates i and j: a clutch, a damper between blades, a pad on a disc.
    #[staticmethod]
    #[pyo3(signature = (i, j, law, load, *, belt_velocity = None, load_gradient = None,
        tangential_stiffness = None, normal_spring = None))]
    #[allow(clippy::too_many_arguments)]
    fn between(
        i: Index,
        j: Index,
        law: ContactLawArgument<'_>,
        load: DriveArgument<'_>,
        belt_velocity: Option<DriveArgument<'_>>,
        load_gradient: Option<Direction>,
        tangential_stiffness: Option<f64>,
        normal_spring: Option<(Direction, f64)>,
    ) -> PyResult<Self> {
        let options = Options {
            belt_velocity,
            load_gradient,
            tangential_stiffness,
            normal_spring,
        };
        Self::build(&[(i.0, 1.0), (j.0, -1.0)], &law, &load, options)
    }

    /// This elastic contact as several in parallel, which slide one after the other.
    ///
    /// Args:
    ///     elements: pairs (stiffness, limit force), for example of `Iwan4.elements`.
    ///
    /// >>> from stick_slip import Contact, Coulomb, Iwan4
    /// >>> joint = Iwan4(3.0, 2.0, -0.1, 0.1)
    /// >>> len(Contact(0, Coulomb(1.0, 1.0), 1.0).in_parallel(joint.elements(3, 0.5)))
    /// 4
    fn in_parallel(&self, elements: Points) -> PyResult<Vec<Self>> {
        let contacts = self.contact.in_parallel(&elements.0).or_raise()?;
        let text = |contact: &stick_slip::Contact| {
            let stiffness = contact.tangential_stiffness().unwrap_or(0.0);
            format!(
                "<Contact in parallel, tangential_stiffness={}>",
                float(stiffness)
            )
        };
        Ok(contacts
            .into_iter()
            .map(|it| Self {
                text: text(&it),
                contact: it,
            })
            .collect())
    }

    /// The direction b, a dict {coordinate: coefficient}.
    #[getter]
    fn direction(&self) -> std::collections::BTreeMap<usize, f64> {
        self.contact.direction().iter().copied().collect()
    }

    /// Stiffness of an elastic contact, force per displacement; None for a rigid one.
    #[getter]
    fn tangential_stiffness(&self) -> Option<f64> {
        self.contact.tangential_stiffness()
    }

    /// The normal load at a time with given displacements, in units of force.
    fn load_at(&self, time: f64, displacements: Numbers) -> f64 {
        self.contact.load_at(time, &displacements.0)
    }

    fn __repr__(&self) -> &str {
        &self.text
    }
}

/// A law of force for a `ForceElement`: `PolynomialSpring`, `Backlash`, `Pendulum`, `SnapThrough`,
/// `VanDerPol`, `TabulatedForce`, or a function of your own, recorded like a `Law`.
///
/// Args:
///     function: the force, a function of position and velocity along the element; with breakpoints
///         a list of functions, one for each piece, which must meet.
///     breakpoints: the positions, ascending, at which pieces meet.
///
/// >>> from stick_slip import ForceLaw
/// >>> ForceLaw(lambda x, v: x + 0.2 * v**3).force(1.0, 2.0)
/// 2.6
#[pyclass(frozen, name = "ForceLaw", module = "stick_slip")]
pub struct PyForceLaw {
    law: Force,
    text: String,
}

#[derive(Clone)]
enum Force {
    PolynomialSpring(stick_slip::PolynomialSpring),
    Backlash(stick_slip::Backlash),
    Pendulum(stick_slip::Pendulum),
    SnapThrough(stick_slip::SnapThrough),
    VanDerPol(stick_slip::VanDerPol),
    Tabulated(stick_slip::TabulatedForce),
    Traced(TracedForce),
}

/// Runs an expression with the law of force of any kind.
macro_rules! with_force {
    ($force:expr, $law:ident => $result:expr) => {
        match $force {
            Force::PolynomialSpring($law) => $result,
            Force::Backlash($law) => $result,
            Force::Pendulum($law) => $result,
            Force::SnapThrough($law) => $result,
            Force::VanDerPol($law) => $result,
            Force::Tabulated($law) => $result,
            Force::Traced($law) => $result,
        }
    };
}

#[pymethods]
impl PyForceLaw {
    #[new]
    #[pyo3(signature = (function, *, breakpoints = Vec::new()))]
    fn new(py: Python<'_>, function: &Bound<'_, PyAny>, breakpoints: Vec<f64>) -> PyResult<Self> {
        let (pieces, shown) = pieces_of(py, function, &breakpoints, &["x", "v"])?;
        let law = TracedForce {
            pieces: pieces.into(),
            breakpoints: breakpoints.into(),
        };
        Ok(Self {
            law: Force::Traced(law),
            text: format!("ForceLaw({shown})"),
        })
    }

    /// The force at a position and a velocity along the element, in units of force.
    ///
    /// >>> from stick_slip import PolynomialSpring
    /// >>> PolynomialSpring([1.0, 0.0, 0.7]).force(2.0)
    /// 7.6
    #[pyo3(signature = (position, velocity = 0.0))]
    fn force(&self, position: f64, velocity: f64) -> f64 {
        with_force!(&self.law, law => {
            let piece = law.breakpoints().take_while(|point| *point <= position).count();
            law.force(position, velocity, piece)
        })
    }

    fn __repr__(&self) -> &str {
        &self.text
    }
}

fn force(law: Result<Force, Error>, text: String) -> PyResult<PyForceLaw> {
    Ok(PyForceLaw {
        law: law.or_raise()?,
        text,
    })
}

/// A spring with the force c_0 x + c_1 x^2 + c_2 x^3 + ...; [k, 0, k3] is Duffing's.
///
/// Args:
///     coefficients: force per displacement, per displacement squared, and so on.
#[pyfunction(name = "PolynomialSpring")]
pub fn polynomial_spring(coefficients: Numbers) -> PyResult<PyForceLaw> {
    let text = format!("PolynomialSpring({:?})", coefficients.0);
    force(
        stick_slip::PolynomialSpring::new(&coefficients.0).map(Force::PolynomialSpring),
        text,
    )
}

/// A spring with play: no force while |x| <= gap.
///
/// Args:
///     stiffness: force per displacement, >= 0.
///     gap: in units of displacement, >= 0.
#[pyfunction(name = "Backlash")]
pub fn backlash(stiffness: f64, gap: f64) -> PyResult<PyForceLaw> {
    let text = format!("Backlash({}, {})", float(stiffness), float(gap));
    force(
        stick_slip::Backlash::new(stiffness, gap).map(Force::Backlash),
        text,
    )
}

/// A pendulum with its pivot at rest: the force moment sin(x/length).
///
/// Args:
///     moment: the weight, in units of force.
///     length: of the pendulum, in units of displacement; 1 for angles.
#[pyfunction(name = "Pendulum")]
pub fn pendulum(moment: f64, length: f64) -> PyResult<PyForceLaw> {
    let text = format!("Pendulum({}, {})", float(moment), float(length));
    force(
        stick_slip::Pendulum::new(moment, length).map(Force::Pendulum),
        text,
    )
}

/// An oblique spring that snaps through.
///
/// Args:
///     stiffness: force per displacement.
///     free_length: in units of displacement.
///     span: its horizontal distance, in units of displacement.
#[pyfunction(name = "SnapThrough")]
pub fn snap_through(stiffness: f64, free_length: f64, span: f64) -> PyResult<PyForceLaw> {
    let text = format!(
        "SnapThrough({}, {}, {})",
        float(stiffness),
        float(free_length),
        float(span)
    );
    let law = stick_slip::SnapThrough::new(stiffness, free_length, span);
    force(law.map(Force::SnapThrough), text)
}

/// Van der Pol's damper: the force (-negative + nonlinear x^2) y.
///
/// Args:
///     negative_damping: force per velocity.
///     nonlinear_damping: force per velocity and displacement squared.
#[pyfunction(name = "VanDerPol")]
pub fn van_der_pol(negative_damping: f64, nonlinear_damping: f64) -> PyResult<PyForceLaw> {
    let text = format!(
        "VanDerPol({}, {})",
        float(negative_damping),
        float(nonlinear_damping)
    );
    let law = stick_slip::VanDerPol::new(negative_damping, nonlinear_damping);
    force(law.map(Force::VanDerPol), text)
}

/// Measured points (position, force), joined by monotone cubic pieces or straight lines.
///
/// Args:
///     points: pairs with ascending positions, or an array of two columns.
///     piecewise_linear: join the points by straight lines.
#[pyfunction(name = "TabulatedForce")]
#[pyo3(signature = (points, piecewise_linear = false))]
pub fn tabulated_force(points: Points, piecewise_linear: bool) -> PyResult<PyForceLaw> {
    let text = format!("TabulatedForce(<{} points>)", points.0.len());
    let law = if piecewise_linear {
        stick_slip::TabulatedForce::piecewise_linear(&points.0)
    } else {
        stick_slip::TabulatedForce::new(&points.0)
    };
    force(law.map(Force::Tabulated), text)
}

/// A force that is not linear in displacements and velocities, along a direction.
///
/// Args:
///     direction: a coordinate, a dict {coordinate: coefficient}, or pairs. A dict {i: 1, j: -1}
///         is an element between two coordinates.
///     law: a ForceLaw.
///     factor: by which the force is multiplied: a number or a Drive.
///
/// >>> from stick_slip import ForceElement, PolynomialSpring, Structure
/// >>> spring = ForceElement(0, PolynomialSpring([1.0, 0.0, 0.7]))
/// >>> duffing = Structure([1.0]).with_element(spring)
/// >>> q, v = duffing.simulate(([2.0], [0.0]), 3.603712656168182).last
/// >>> bool(abs(q[0] - 2.0) < 1e-14)
/// True
#[pyclass(frozen, name = "ForceElement", module = "stick_slip")]
pub struct PyForceElement {
    element: ForceElement,
    text: String,
}

#[pymethods]
impl PyForceElement {
    #[new]
    #[pyo3(signature = (direction, law, *, factor = None))]
    fn new(
        direction: Direction,
        law: &PyForceLaw,
        factor: Option<DriveArgument<'_>>,
    ) -> PyResult<Self> {
        let element = with_force!(law.law.clone(), law => ForceElement::along(&direction.0, law));
        let mut element = element.or_raise()?;
        let mut text = format!("{}, {}", direction_text(&direction.0), law.text);
        if let Some(factor) = factor {
            text += &format!(", factor={}", drive_text(&factor)?);
            element = element.with_factor(factor.drive()).or_raise()?;
        }
        Ok(Self {
            element,
            text: format!("ForceElement({text})"),
        })
    }

    fn __repr__(&self) -> &str {
        &self.text
    }
}

record! {
    /// Steady sliding of a structure.
    SteadySliding {
        /// Displacements, one for each coordinate.
        displacements: Numbers,
        /// Eigenvalues of the linearized equations, per unit of time.
        eigenvalues: ComplexNumbers,
        /// Accelerations: 0 except for motions that speed up as a whole.
        accelerations: Numbers,
        /// True if small perturbations decay.
        is_stable: bool,
    }
}

impl From<structure::SteadySliding> for SteadySliding {
    fn from(found: structure::SteadySliding) -> Self {
        Self {
            is_stable: found.is_stable(),
            displacements: Numbers(found.displacements),
            eigenvalues: ComplexNumbers(found.eigenvalues),
            accelerations: Numbers(found.accelerations),
        }
    }
}

record! {
    /// The force in a contact at one instant: see `Structure.carried`.
    Carried {
        /// The friction force, in units of force; one of those possible if it is not determined.
        force: f64,
        /// The least possible force.
        least: f64,
        /// The largest possible force.
        most: f64,
        /// True if the equations determine the force.
        is_determined: bool,
    }
}

record! {
    /// A way in which contacts at rest can begin to slip: see `Structure.mechanisms`.
    Mechanism {
        /// The contacts that slip, each with its relative velocity in units of that of the first.
        contacts: Vec<(usize, f64)>,
        /// The power of the load, in units of force.
        power: f64,
        /// The power that friction can dissipate at most, in units of force.
        resistance: f64,
        /// The resistance minus the power: what is left before these contacts slip.
        margin: f64,
    }
}

record! {
    /// A change of the stability of steady sliding along a speed profile.
    StabilityChange {
        /// The time.
        time: f64,
        /// True if steady sliding becomes stable there.
        becomes_stable: bool,
        /// The angular frequency of the vibration, in radians per unit of time.
        frequency: f64,
    }
}

/// Several masses with springs, dampers, forces, friction contacts and force elements:
///
/// M v' = f(t) - C v - K q - contacts - elements, v = q'.
///
/// Any consistent units. Every method that adds something returns a new structure.
///
/// Args:
///     masses: of the coordinates, in units of mass (or moments of inertia).
///     mass_matrix: symmetric and positive definite, instead of masses.
///     stiffness: the matrix K, n by n, in addition to springs added later.
///     damping: the matrix C, n by n.
///
/// >>> from stick_slip import Contact, Rational, Structure
/// >>> law = Rational(1.0, 3.0)
/// >>> blocks = (Structure([1.0, 1.0])
/// ...     .with_ground_spring(0, 1.0).with_ground_spring(1, 1.0).with_spring(0, 1, 1.2)
/// ...     .with_contact(Contact(0, law, 1.0, belt_velocity=0.17))
/// ...     .with_contact(Contact(1, law, 1.3, belt_velocity=0.17)))
/// >>> blocks
/// <Structure of 2 coordinates, 2 contacts, 0 force elements>
/// >>> blocks.steady_sliding().is_stable
/// False
#[pyclass(frozen, name = "Structure", module = "stick_slip")]
pub struct PyStructure(pub Arc<Structure>);

impl PyStructure {
    pub fn of(structure: Structure) -> Self {
        Self(Arc::new(structure))
    }

    fn with(&self, change: impl FnOnce(Structure) -> Result<Structure, Error>) -> PyResult<Self> {
        change((*self.0).clone()).or_raise().map(Self::of)
    }
}

#[pymethods]
impl PyStructure {
    #[new]
    #[pyo3(signature = (masses = None, *, mass_matrix = None, stiffness = None, damping = None))]
    fn new(
        masses: Option<Numbers>,
        mass_matrix: Option<Matrix>,
        stiffness: Option<Matrix>,
        damping: Option<Matrix>,
    ) -> PyResult<Self> {
        let structure = match (masses, mass_matrix) {
            (Some(Numbers(masses)), None) => Structure::new(&masses),
            (None, Some(Matrix(mass))) => Structure::with_mass_matrix(mass),
            _ => return Err(PyValueError::new_err("give either masses or mass_matrix")),
        };
        let structure = structure.and_then(|mut structure| {
            if let Some(Matrix(stiffness)) = stiffness {
                structure = structure.with_stiffness(stiffness)?;
            }
            if let Some(Matrix(damping)) = damping {
                structure = structure.with_damping(damping)?;
            }
            Ok(structure)
        });
        structure.or_raise().map(Self::of)
    }

    /// Adds a spring between two coordinates; stiffness in force per displacement.
    fn with_spring(&self, i: Index, j: Index, stiffness: f64) -> PyResult<Self> {
        self.with(|structure| structure.with_spring(i.0, j.0, stiffness))
    }

    /// Adds a damper between two coordinates; damping in force per velocity.
    fn with_damper(&self, i: Index, j: Index, damping: f64) -> PyResult<Self> {
        self.with(|structure| structure.with_damper(i.0, j.0, damping))
    }

    /// Adds a spring between a coordinate and the ground; stiffness in force per displacement.
    fn with_ground_spring(&self, i: Index, stiffness: f64) -> PyResult<Self> {
        self.with(|structure| structure.with_ground_spring(i.0, stiffness))
    }

    /// Adds a damper between a coordinate and the ground; damping in force per velocity.
    fn with_ground_damper(&self, i: Index, damping: f64) -> PyResult<Self> {
        self.with(|structure| structure.with_ground_damper(i.0, damping))
    }

    /// Adds a stiffness matrix, which need not be symmetric.
    fn with_stiffness(&self, stiffness: Matrix) -> PyResult<Self> {
        self.with(|structure| structure.with_stiffness(stiffness.0))
    }

    /// Adds a damping matrix, which need not be symmetric.
    fn with_damping(&self, damping: Matrix) -> PyResult<Self> {
        self.with(|structure| structure.with_damping(damping.0))
    }

    /// Sets the force on a coordinate, in units of force: a number or a Drive.
    fn with_force(&self, i: Index, force: DriveArgument<'_>) -> PyResult<Self> {
        self.with(|structure| structure.with_force(i.0, force.drive()))
    }

    /// Adds a contact. Contacts are numbered from 0 in the order in which they are added.
    fn with_contact(&self, contact: &PyContact) -> PyResult<Self> {
        self.with(|structure| structure.with_contact(contact.contact.clone()))
    }

    /// Adds several contacts, for example those of `Contact.in_parallel`.
    fn with_contacts(&self, contacts: Vec<Bound<'_, PyContact>>) -> PyResult<Self> {
        let contacts = contacts.iter().map(|contact| contact.get().contact.clone());
        self.with(|structure| structure.with_contacts(contacts))
    }

    /// Adds a force element.
    fn with_element(&self, element: &PyForceElement) -> PyResult<Self> {
        self.with(|structure| structure.with_element(element.element.clone()))
    }

    /// The number of coordinates.
    fn __len__(&self) -> usize {
        self.0.len()
    }

    /// The mass matrix.
    #[getter]
    fn mass_matrix(&self) -> Table {
        Table::of(&self.0.mass_matrix())
    }

    /// The stiffness matrix.
    #[getter]
    fn stiffness(&self) -> Table {
        Table::of(self.0.stiffness())
    }

    /// The damping matrix.
    #[getter]
    fn damping(&self) -> Table {
        Table::of(self.0.damping())
    }

    /// The common period of all drives, in units of time; None if there is none.
    #[getter]
    fn period(&self) -> Option<f64> {
        self.0.period()
    }

    /// The number of contacts.
    #[getter]
    fn contacts(&self) -> usize {
        self.0.contacts().len()
    }

    /// The number of force elements.
    #[getter]
    fn elements(&self) -> usize {
        self.0.elements().len()
    }

    /// The motion from a start.
    ///
    /// Args:
    ///     start: (q, v) or (q, v, memory): arrays of displacements, velocities and memory
    ///         variables, or numbers for one coordinate.
    ///     duration: in units of time, >= 0.
    ///     tolerance: of the integrator, 1e-16 to 1e-2, relative to the motion's scale; round-off
    ///         if it is None.
    ///     max_steps: largest number of integration steps.
    ///     max_events: largest number of events.
    ///     start_time: the time of the start, for drives.
    ///     until: a function of arrays (q, v); the motion ends where its value passes 0.
    ///
    /// Returns:
    ///     The Motion. KeyboardInterrupt and errors carry the motion so far as `found`.
    #[pyo3(signature = (start, duration, *, tolerance = None, max_steps = None, max_events = None,
        start_time = 0.0, until = None))]
    #[allow(clippy::too_many_arguments)]
    fn simulate(
        &self,
        py: Python<'_>,
        start: Start,
        duration: f64,
        tolerance: Option<f64>,
        max_steps: Option<usize>,
        max_events: Option<usize>,
        start_time: f64,
        until: Option<Py<PyAny>>,
    ) -> PyResult<PyMotion> {
        let settings = Settings {
            tolerance,
            max_steps,
            max_events,
            start_time,
            until,
        };
        let structure = self.0.clone();
        let (motion, exception) = py.detach(|| {
            let waiting = Waiting::new();
            let motion = settings.integrator().and_then(|integrator: Integrator| {
                let stop = settings.stop(&waiting, |until, state: &structure::State| {
                    let q = Numbers(state.displacements.clone());
                    let v = Numbers(state.velocities.clone());
                    until.call1((q, v))
                });
                integrator.simulate_until(&*structure, start.0, duration, stop)
            });
            (motion, waiting.into_exception())
        });
        let motion = AnyMotion::Structure(Arc::new(motion.or_raise()?), Some(structure));
        if let Some(exception) = exception {
            exception
                .value(py)
                .setattr("found", PyMotion(motion).into_pyobject(py)?)?;
            return Err(exception);
        }
        ended_well(py, motion)
    }

    /// Steady sliding, near given displacements if there are several, and its stability.
    ///
    /// Args:
    ///     near: displacements from which the search starts.
    ///     velocities: constant velocities of the coordinates, of a slipping clutch or turning
    ///         shafts; then without `near`.
    #[pyo3(signature = (*, near = None, velocities = None))]
    fn steady_sliding(
        &self,
        py: Python<'_>,
        near: Option<Numbers>,
        velocities: Option<Numbers>,
    ) -> PyResult<SteadySliding> {
        let found = py.detach(|| match (near, velocities) {
            (None, None) => Ok(self.0.steady_sliding()),
            (Some(near), None) => Ok(self.0.steady_sliding_from(&near.0)),
            (None, Some(velocities)) => Ok(self.0.steady_sliding_at(&velocities.0)),
            _ => Err(PyValueError::new_err("give near or velocities, not both")),
        })?;
        found.or_raise().map(SteadySliding::from)
    }

    /// The structure with its drives frozen at a time.
    fn frozen(&self, time: f64) -> PyResult<Self> {
        self.0.frozen(time).or_raise().map(Self::of)
    }

    /// Where steady sliding gains or loses stability between two times of a speed profile.
    fn stability_changes(&self, start: f64, end: f64) -> PyResult<Vec<StabilityChange>> {
        let changes = self.0.stability_changes(start..end).or_raise()?;
        let changes = changes.into_iter().map(|change| StabilityChange {
            time: change.time,
            becomes_stable: change.becomes_stable,
            frequency: change.frequency,
        });
        Ok(changes.collect())
    }

    /// The friction force of each contact in a state, with the range of those possible.
    fn carried(&self, time: f64, state: Start) -> PyResult<Vec<Carried>> {
        let carried = self.0.carried(time, &state.0).or_raise()?;
        let carried = carried.into_iter().map(|it| Carried {
            force: it.force,
            least: it.least,
            most: it.most,
            is_determined: it.is_determined(),
        });
        Ok(carried.collect())
    }

    /// The ways in which contacts at rest can begin to slip in a state, ordered by their contacts.
    fn mechanisms(&self, time: f64, state: Start) -> PyResult<Vec<Mechanism>> {
        let mechanisms = self.0.mechanisms(time, &state.0).or_raise()?;
        let mechanisms = mechanisms.into_iter().map(|it| Mechanism {
            margin: it.margin(),
            contacts: it.contacts,
            power: it.power,
            resistance: it.resistance,
        });
        Ok(mechanisms.collect())
    }

    /// The accelerations in a state, in units of velocity per time.
    fn acceleration(&self, time: f64, state: Start) -> PyResult<Numbers> {
        self.0.acceleration(time, &state.0).or_raise().map(Numbers)
    }

    /// The kinetic energy of a state, in units of force times displacement.
    fn kinetic_energy(&self, state: Start) -> PyResult<f64> {
        self.0.kinetic_energy(&state.0).or_raise()
    }

    /// The elastic energy of a state at a time, in units of force times displacement.
    fn elastic_energy(&self, time: f64, state: Start) -> PyResult<f64> {
        self.0.elastic_energy(time, &state.0).or_raise()
    }

    fn __repr__(&self) -> String {
        format!(
            "<Structure of {} coordinates, {} contacts, {} force elements>",
            self.0.len(),
            self.0.contacts().len(),
            self.0.elements().len()
        )
    }
}
