//! `Structure`: masses with contacts, force elements, stops and first-order states.

use std::sync::Arc;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use stick_slip::{Error, Integrator, Structure, structure};

use crate::contact::PyContact;
use crate::convert::{ComplexNumbers, Index, Matrix, Numbers, Table};
use crate::drive::DriveArgument;
use crate::error::OrRaise;
use crate::first_order::PyFirstOrder;
use crate::force::PyForceElement;
use crate::made::{Arguments, Made, Reduced};
use crate::motion::{AnyMotion, PyMotion, ended_well};
use crate::record::record;
use crate::simulate::Settings;
use crate::state::Start;
use crate::stop::PyStop;
use crate::waiting::Waiting;

record! {
    /// Steady sliding of a structure.
    SteadySliding {
        /// Displacements, one for each coordinate.
        displacements: Numbers,
        /// First-order states, one for each.
        first_order: Numbers,
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
            first_order: Numbers(found.first_order),
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

/// Several masses with springs, dampers, forces, friction contacts, force elements, stops and
/// first-order states:
///
/// M v' = f(t) - C v - K q - contacts - elements + stops + forces of first-order states, v = q'.
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
/// <Structure of 2 coordinates, 2 contacts>
/// >>> blocks.steady_sliding().is_stable
/// False
#[pyclass(frozen, name = "Structure", module = "stick_slip")]
pub struct PyStructure(pub Arc<Structure>, Made);

impl PyStructure {
    pub fn of(structure: Structure, made: Made) -> Self {
        Self(Arc::new(structure), made)
    }

    /// What a method with these arguments makes of the structure.
    fn with<'py>(
        &self,
        py: Python<'py>,
        method: &'static str,
        arguments: impl Arguments<'py>,
        change: impl FnOnce(Structure) -> Result<Structure, Error>,
    ) -> PyResult<Self> {
        let structure = change((*self.0).clone()).or_raise()?;
        Ok(Self::of(structure, self.1.then(py, method, arguments)?))
    }
}

#[pymethods]
impl PyStructure {
    #[new]
    #[pyo3(signature = (masses = None, *, mass_matrix = None, stiffness = None, damping = None))]
    fn new(
        py: Python<'_>,
        masses: Option<Numbers>,
        mass_matrix: Option<Matrix>,
        stiffness: Option<Matrix>,
        damping: Option<Matrix>,
    ) -> PyResult<Self> {
        let tables = [&mass_matrix, &stiffness, &damping];
        let [mass, spring, damper] = tables.map(|it| it.as_ref().map(|it| Table::of(&it.0)));
        let made = Made::by(py, "Structure", ())?
            .with_given(py, "masses", masses.clone())?
            .with_given(py, "mass_matrix", mass)?
            .with_given(py, "stiffness", spring)?
            .with_given(py, "damping", damper)?;
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
        structure
            .or_raise()
            .map(|structure| Self::of(structure, made))
    }

    /// Adds a spring between two coordinates; stiffness in force per displacement.
    fn with_spring(&self, py: Python<'_>, i: Index, j: Index, stiffness: f64) -> PyResult<Self> {
        self.with(py, "with_spring", (i.0, j.0, stiffness), |structure| {
            structure.with_spring(i.0, j.0, stiffness)
        })
    }

    /// Adds a damper between two coordinates; damping in force per velocity.
    fn with_damper(&self, py: Python<'_>, i: Index, j: Index, damping: f64) -> PyResult<Self> {
        self.with(py, "with_damper", (i.0, j.0, damping), |structure| {
            structure.with_damper(i.0, j.0, damping)
        })
    }

    /// Adds a spring between a coordinate and the ground; stiffness in force per displacement.
    fn with_ground_spring(&self, py: Python<'_>, i: Index, stiffness: f64) -> PyResult<Self> {
        self.with(py, "with_ground_spring", (i.0, stiffness), |structure| {
            structure.with_ground_spring(i.0, stiffness)
        })
    }

    /// Adds a damper between a coordinate and the ground; damping in force per velocity.
    fn with_ground_damper(&self, py: Python<'_>, i: Index, damping: f64) -> PyResult<Self> {
        self.with(py, "with_ground_damper", (i.0, damping), |structure| {
            structure.with_ground_damper(i.0, damping)
        })
    }

    /// Adds a stiffness matrix, which need not be symmetric.
    fn with_stiffness(&self, py: Python<'_>, stiffness: Matrix) -> PyResult<Self> {
        let table = Table::of(&stiffness.0);
        self.with(py, "with_stiffness", (table,), |structure| {
            structure.with_stiffness(stiffness.0)
        })
    }

    /// Adds a damping matrix, which need not be symmetric.
    fn with_damping(&self, py: Python<'_>, damping: Matrix) -> PyResult<Self> {
        let table = Table::of(&damping.0);
        self.with(py, "with_damping", (table,), |structure| {
            structure.with_damping(damping.0)
        })
    }

    /// Sets the force on a coordinate, in units of force: a number or a Drive.
    fn with_force(&self, py: Python<'_>, i: Index, force: DriveArgument<'_>) -> PyResult<Self> {
        self.with(py, "with_force", (i.0, &force), |structure| {
            structure.with_force(i.0, force.drive())
        })
    }

    /// Adds a contact. Contacts are numbered from 0 in the order in which they are added.
    fn with_contact(&self, contact: &Bound<'_, PyContact>) -> PyResult<Self> {
        self.with(contact.py(), "with_contact", (contact,), |structure| {
            structure.with_contact(contact.get().contact.clone())
        })
    }

    /// Adds several contacts, for example those of `Contact.in_parallel`.
    fn with_contacts(&self, py: Python<'_>, contacts: Vec<Bound<'_, PyContact>>) -> PyResult<Self> {
        self.with(py, "with_contacts", (&contacts,), |structure| {
            let contacts = contacts.iter().map(|contact| contact.get().contact.clone());
            structure.with_contacts(contacts)
        })
    }

    /// Adds a force element.
    fn with_element(&self, element: &Bound<'_, PyForceElement>) -> PyResult<Self> {
        self.with(element.py(), "with_element", (element,), |structure| {
            structure.with_element(element.get().element.clone())
        })
    }

    /// Adds a stop. Stops are numbered from 0 in the order in which they are added.
    fn with_stop(&self, stop: &Bound<'_, PyStop>) -> PyResult<Self> {
        self.with(stop.py(), "with_stop", (stop,), |structure| {
            structure.with_stop(stop.get().stop.clone())
        })
    }

    /// Adds several stops, for example the two of a play.
    fn with_stops(&self, py: Python<'_>, stops: Vec<Bound<'_, PyStop>>) -> PyResult<Self> {
        self.with(py, "with_stops", (&stops,), |structure| {
            let mut stops = stops.iter().map(|stop| stop.get().stop.clone());
            stops.try_fold(structure, Structure::with_stop)
        })
    }

    /// Adds a first-order state, which may read itself and those before it.
    fn with_first_order(&self, state: &Bound<'_, PyFirstOrder>) -> PyResult<Self> {
        self.with(state.py(), "with_first_order", (state,), |structure| {
            structure.with_first_order(state.get().state.clone())
        })
    }

    /// Adds several first-order states, which may read each other.
    ///
    /// >>> import math
    /// >>> from stick_slip import FirstOrder, Structure
    /// >>> circle = Structure([1.0]).with_first_orders(
    /// ...     [FirstOrder(states={1: 1.0}), FirstOrder(states={0: -1.0})])
    /// >>> end = circle.simulate(([0.0], [0.0], [1.0, 0.0]), 10.0).state_at()
    /// >>> bool(abs(end.memory[0] - math.cos(10.0)) < 1e-14)
    /// True
    fn with_first_orders(
        &self,
        py: Python<'_>,
        states: Vec<Bound<'_, PyFirstOrder>>,
    ) -> PyResult<Self> {
        self.with(py, "with_first_orders", (&states,), |structure| {
            structure.with_first_orders(states.iter().map(|state| state.get().state.clone()))
        })
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

    /// The number of stops.
    #[getter]
    fn stops(&self) -> usize {
        self.0.stops().len()
    }

    /// The number of first-order states.
    #[getter]
    fn first_orders(&self) -> usize {
        self.0.first_orders().len()
    }

    /// The motion from a start.
    ///
    /// Args:
    ///     start: (q, v), (q, v, memory) or (q, v, memory, sliding): arrays of displacements and
    ///         velocities, or numbers for one coordinate; the memory variables of the contacts and
    ///         then the first-order states, 0 if they are not given; a dict {contact: relative
    ///         velocity} of contacts that creep, whose digits the velocities have not (the
    ///         velocities are changed accordingly). A `State` is such a start.
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
    ///         shafts; then without `near`. Contacts whose relative velocity is 0 stick.
    ///
    /// A clutch whose friction falls with the slip speed, in front of an elastic shaft, judders:
    ///
    /// >>> from stick_slip import Contact, Exponential, Structure
    /// >>> clutch = Contact.between(0, 1, Exponential(0.35, 0.3, 20.0), 1000.0)
    /// >>> driveline = Structure([0.2, 0.05, 2.0]).with_spring(1, 2, 500.0).with_contact(clutch)
    /// >>> slipping = driveline.steady_sliding(velocities=[110.0, 100.0, 100.0])
    /// >>> slipping.is_stable, slipping.eigenvalues[0].round(6)
    /// (False, np.complex128(...))
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
    fn frozen(&self, py: Python<'_>, time: f64) -> PyResult<Self> {
        self.with(py, "frozen", (time,), |structure| structure.frozen(time))
    }

    /// The times between two given times at which steady sliding gains or loses stability, with the
    /// drives held constant at each time.
    fn stability_changes(&self, start: f64, end: f64) -> PyResult<Vec<StabilityChange>> {
        let changes = self.0.stability_changes(start..end).or_raise()?;
        let changes = changes.into_iter().map(|change| StabilityChange {
            time: change.time,
            becomes_stable: change.becomes_stable,
            frequency: change.frequency,
        });
        Ok(changes.collect())
    }

    /// The friction force of each contact in a state, with the range of those possible where
    /// contacts at rest share a load (parallel clutches, two brakes and the clutch between them).
    ///
    /// >>> from stick_slip import Contact, Coulomb, Structure
    /// >>> brakes = [Contact(0, Coulomb(0.5, 0.4), load) for load in (4.0, 6.0)]
    /// >>> disc = Structure([1.0]).with_contacts(brakes).with_force(0, 4.0)
    /// >>> first, second = disc.carried(0.0, ([0.0], [0.0]))
    /// >>> (first.least, first.most), (second.least, second.most), first.is_determined
    /// ((1.0, 2.0), (2.0, 3.0), False)
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

    fn __reduce__<'py>(&self, py: Python<'py>) -> Reduced<'py> {
        self.1.reduced(py)
    }

    fn __repr__(&self) -> String {
        let counts = [
            (self.0.len(), "coordinate"),
            (self.0.contacts().len(), "contact"),
            (self.0.elements().len(), "force element"),
            (self.0.stops().len(), "stop"),
            (self.0.first_orders().len(), "first-order state"),
        ];
        let parts = counts.iter().filter(|(count, _)| *count > 0);
        let parts = parts.map(|(count, what)| {
            let plural = if *count == 1 { "" } else { "s" };
            format!("{count} {what}{plural}")
        });
        format!("<Structure of {}>", parts.collect::<Vec<_>>().join(", "))
    }
}
