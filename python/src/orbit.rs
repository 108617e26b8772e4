//! Periodic motions of any system. A mass on a belt becomes a structure of one mass.

use std::sync::Arc;

use numpy::{IntoPyArray, PyArray1};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyIterator;
use stick_slip::bifurcation::{self, HopfLocus};
use stick_slip::orbit::{self, Attractor, Branch, BranchPoint, Period, Sensitivities, Sweep};
use stick_slip::structure::State;
use stick_slip::{Element, EventKind, Search, Structure};

use crate::belt::BeltArgument;
use crate::convert::{ComplexNumbers, Count, Index, Numbers, Table, short, within};
use crate::error::{OrRaise, in_python};
use crate::family::{AnySystem, Family};
use crate::motion::{
    AnyMotion, EnergyBudget, Happening, PyMotion, contact_and_stop, criticality_name, entry,
    events_array, iterator, kind_name,
};
use crate::record::record;
use crate::state::{Shown, Start};
use crate::waiting::{Options, Waiting, options, search, work};

type RustOrbit = orbit::Orbit<State>;

/// A periodic motion of any system, exact to rounding. A mass on a belt is coordinate 0, with
/// contact 0.
///
/// >>> from stick_slip import Contact, Drive, Polynomial, Structure, settle
/// >>> contact = Contact(0, Polynomial(0.4, 0.25, 0.5), 1.0, belt_velocity=0.2)
/// >>> forced = (Structure([1.0]).with_ground_spring(0, 1.0).with_ground_damper(0, 0.1)
/// ...     .with_force(0, Drive.harmonic(0.15, 0.8)).with_contact(contact))
/// >>> orbit = settle(forced, ([0.0], [0.0]), 100.0, periods=1)
/// >>> orbit
/// <Orbit of period 7.853982, stable>
/// >>> orbit.events["kind"]
/// array(['release', 'stick'], dtype='<U8')
/// >>> abs(orbit.extremes(0)[1] - 0.5884147960427818) < 1e-14
/// True
#[pyclass(frozen, name = "Orbit", module = "stick_slip")]
pub struct PyOrbit {
    orbit: Arc<RustOrbit>,
    /// The system, if the search was of one; a branch has many.
    system: Option<Arc<Structure>>,
}

impl PyOrbit {
    fn of(orbit: RustOrbit, system: Option<Arc<Structure>>) -> Self {
        Self {
            orbit: Arc::new(orbit),
            system,
        }
    }

    /// The crate panics if there is no such coordinate.
    fn coordinate(&self, index: Index) -> PyResult<usize> {
        let count = self.orbit.state().displacements.len();
        within(index, count, "coordinate")
    }

    fn contact(&self, index: Index) -> PyResult<usize> {
        let count = self.orbit.energy().friction_loss.len();
        within(index, count, "contact")
    }
}

#[pymethods]
impl PyOrbit {
    /// True if a drive forces the motion; False if it is autonomous.
    #[getter]
    fn is_forced(&self) -> bool {
        matches!(self.orbit.kind(), Period::Driven(_))
    }

    /// The period, in units of time.
    #[getter]
    fn period(&self) -> f64 {
        self.orbit.period()
    }

    /// The angular frequency, in radians per unit of time.
    #[getter]
    fn frequency(&self) -> f64 {
        self.orbit.frequency()
    }

    /// The frequency 1/period.
    #[getter]
    fn hertz(&self) -> f64 {
        self.orbit.hertz()
    }

    /// The `State` at the start of the period.
    #[getter]
    fn state(&self) -> Shown {
        Shown(self.orbit.state())
    }

    /// The motion over one period.
    #[getter]
    fn motion(&self) -> PyMotion {
        let motion = Arc::new(self.orbit.trajectory().clone());
        PyMotion(AnyMotion::Structure(motion, self.system.clone()))
    }

    /// The events of a period: see `Motion.events`.
    #[getter]
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let events = self.orbit.events().iter().map(Happening::from);
        events_array(py, &events.collect::<Vec<_>>())
    }

    /// The Floquet multipliers by descending modulus, without those that are 1 for every motion of
    /// this kind.
    #[getter]
    fn multipliers(&self) -> ComplexNumbers {
        ComplexNumbers(self.orbit.multipliers().to_vec())
    }

    /// True if small perturbations decay, up to a change of the member of a family: all multipliers
    /// are inside the unit circle, except the multipliers 1 of a family.
    #[getter]
    fn is_stable(&self) -> bool {
        self.orbit.is_stable()
    }

    /// True if the second half of the period is the mirror image of the first.
    #[getter]
    fn is_symmetric(&self) -> bool {
        self.orbit.is_symmetric()
    }

    /// The contacts that never slip, which make the motion one of a family.
    #[getter]
    fn unslipped(&self) -> Vec<usize> {
        self.orbit.unslipped().to_vec()
    }

    /// The directions of the continuous family to which the motion belongs, a `State` for each:
    /// the motion from the state plus a small multiple of it is periodic, too. Empty if the motion
    /// is isolated.
    ///
    /// Two bodies that rub on each other and that nothing holds keep their momentum:
    ///
    /// >>> from stick_slip import Contact, Coulomb, Drive, Structure, settle
    /// >>> pair = (Structure([1.0, 3.0]).with_spring(0, 1, 2.0)
    /// ...     .with_force(0, Drive.harmonic(1.0, 1.1))
    /// ...     .with_contact(Contact.between(0, 1, Coulomb(0.3, 0.2), 1.0)))
    /// >>> orbit = settle(pair, ([0.0, 0.0], [2.0, -0.4]), 100.0, periods=1)
    /// >>> [direction] = orbit.families
    /// >>> bool(abs(direction.velocities[0] - direction.velocities[1]) < 1e-12)
    /// True
    #[getter]
    fn families(&self) -> Vec<Shown> {
        self.orbit.families().iter().cloned().map(Shown).collect()
    }

    /// Work and heat of every part in a period.
    #[getter]
    fn energy(&self) -> EnergyBudget {
        self.orbit.energy().clone().into()
    }

    /// Least and largest displacement of a coordinate.
    #[pyo3(signature = (coordinate = Index(0)), text_signature = "($self, coordinate=0)")]
    fn extremes(&self, coordinate: Index) -> PyResult<(f64, f64)> {
        Ok(self.orbit.extremes(self.coordinate(coordinate)?))
    }

    /// Least and largest velocity of a coordinate.
    #[pyo3(signature = (coordinate = Index(0)), text_signature = "($self, coordinate=0)")]
    fn velocity_extremes(&self, coordinate: Index) -> PyResult<(f64, f64)> {
        Ok(self.orbit.velocity_extremes(self.coordinate(coordinate)?))
    }

    /// Least and largest acceleration of a coordinate.
    #[pyo3(signature = (coordinate = Index(0)), text_signature = "($self, coordinate=0)")]
    fn acceleration_extremes(&self, coordinate: Index) -> PyResult<(f64, f64)> {
        Ok(self
            .orbit
            .acceleration_extremes(self.coordinate(coordinate)?))
    }

    /// Half the distance between the largest and the least displacement of a coordinate.
    #[pyo3(signature = (coordinate = Index(0)), text_signature = "($self, coordinate=0)")]
    fn amplitude(&self, coordinate: Index) -> PyResult<f64> {
        Ok(self.orbit.amplitude(self.coordinate(coordinate)?))
    }

    /// Mean velocity of a coordinate.
    #[pyo3(signature = (coordinate = Index(0)), text_signature = "($self, coordinate=0)")]
    fn mean_velocity(&self, coordinate: Index) -> PyResult<f64> {
        Ok(self.orbit.mean_velocity(self.coordinate(coordinate)?))
    }

    /// Mean displacement of a coordinate.
    #[pyo3(signature = (coordinate = Index(0)), text_signature = "($self, coordinate=0)")]
    fn mean_displacement(&self, coordinate: Index) -> PyResult<f64> {
        Ok(self.orbit.mean_displacement(self.coordinate(coordinate)?))
    }

    /// Root mean square of the velocity of a coordinate.
    #[pyo3(signature = (coordinate = Index(0)), text_signature = "($self, coordinate=0)")]
    fn rms_velocity(&self, coordinate: Index) -> PyResult<f64> {
        Ok(self.orbit.rms_velocity(self.coordinate(coordinate)?))
    }

    /// Root mean square of the acceleration of a coordinate.
    #[pyo3(signature = (coordinate = Index(0)), text_signature = "($self, coordinate=0)")]
    fn rms_acceleration(&self, coordinate: Index) -> PyResult<f64> {
        Ok(self.orbit.rms_acceleration(self.coordinate(coordinate)?))
    }

    /// Largest size of the acceleration of a coordinate.
    #[pyo3(signature = (coordinate = Index(0)), text_signature = "($self, coordinate=0)")]
    fn peak_acceleration(&self, coordinate: Index) -> PyResult<f64> {
        Ok(self.orbit.peak_acceleration(self.coordinate(coordinate)?))
    }

    /// Time in stick of a contact in a period.
    #[pyo3(signature = (contact = Index(0)), text_signature = "($self, contact=0)")]
    fn stick_duration(&self, contact: Index) -> PyResult<f64> {
        Ok(self.orbit.stick_duration(self.contact(contact)?))
    }

    /// Number of slip phases of a contact in a period.
    #[pyo3(signature = (contact = Index(0)), text_signature = "($self, contact=0)")]
    fn slips(&self, contact: Index) -> PyResult<usize> {
        Ok(self.orbit.slips(self.contact(contact)?))
    }

    /// Largest sliding speed of a contact.
    #[pyo3(signature = (contact = Index(0)), text_signature = "($self, contact=0)")]
    fn max_sliding_speed(&self, contact: Index) -> PyResult<f64> {
        Ok(self.orbit.max_sliding_speed(self.contact(contact)?))
    }

    /// Complex amplitudes of the first n harmonics of the displacement of a coordinate.
    #[pyo3(signature = (n, coordinate = Index(0)), text_signature = "($self, n, coordinate=0)")]
    fn harmonics(&self, n: Count, coordinate: Index) -> PyResult<ComplexNumbers> {
        let coordinate = self.coordinate(coordinate)?;
        Ok(ComplexNumbers(self.orbit.harmonics(coordinate, n.0)))
    }

    /// Complex amplitudes of the first n harmonics of the velocity of a coordinate.
    #[pyo3(signature = (n, coordinate = Index(0)), text_signature = "($self, n, coordinate=0)")]
    fn velocity_harmonics(&self, n: Count, coordinate: Index) -> PyResult<ComplexNumbers> {
        let coordinate = self.coordinate(coordinate)?;
        Ok(ComplexNumbers(
            self.orbit.velocity_harmonics(coordinate, n.0),
        ))
    }

    /// Complex amplitudes of the first n harmonics of the acceleration of a coordinate.
    #[pyo3(signature = (n, coordinate = Index(0)), text_signature = "($self, n, coordinate=0)")]
    fn acceleration_harmonics(&self, n: Count, coordinate: Index) -> PyResult<ComplexNumbers> {
        let coordinate = self.coordinate(coordinate)?;
        Ok(ComplexNumbers(
            self.orbit.acceleration_harmonics(coordinate, n.0),
        ))
    }

    fn __repr__(&self) -> String {
        let stability = if self.orbit.is_stable() {
            "stable"
        } else {
            "unstable"
        };
        format!(
            "<Orbit of period {}, {stability}>",
            short(self.orbit.period())
        )
    }
}

/// The kind of a periodic motion, from exactly one of the two arguments.
fn period(periods: Option<usize>, estimate: Option<f64>) -> PyResult<Period> {
    match (periods, estimate) {
        (Some(periods), None) => Ok(Period::Driven(periods)),
        (None, Some(estimate)) => Ok(Period::Free(estimate)),
        _ => Err(PyValueError::new_err(
            "give periods (of the drives) for a forced motion, or estimate (of its period) for an \
             autonomous one",
        )),
    }
}

/// The periodic motion near a guess, stable or not, by Newton's method.
///
/// Args:
///     system: a Structure or a mass on a belt.
///     guess: a state (q, v) or (q, v, memory) near the motion; for a mass on a belt (u, v).
///     periods: of a forced motion: how many periods of the drives the motion takes.
///     estimate: of an autonomous motion: an estimate of its period, in units of time.
///     max_steps: bound of the work, in integration steps.
///     progress: a function called with a Progress; the search ends if it returns False.
///
/// Returns:
///     The Orbit.
///
/// >>> from stick_slip import Exponential, MassOnBelt, shoot
/// >>> system = MassOnBelt(Exponential(0.6, 0.3, 0.4), 1.0, damping=0.01)
/// >>> shoot(system, (0.3, 0.6), estimate=6.28)
/// <Orbit of period 6.283819, unstable>
#[pyfunction]
#[pyo3(signature = (system, guess, *, periods = None, estimate = None, max_steps = None,
    progress = None))]
pub fn shoot(
    py: Python<'_>,
    system: AnySystem<'_>,
    guess: Start,
    periods: Option<usize>,
    estimate: Option<f64>,
    max_steps: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    let (system, period) = (
        Arc::new(system.structure().or_raise()?),
        period(periods, estimate)?,
    );
    search(
        py,
        options(max_steps, None, progress),
        |search, _| search.shoot(&*system, &guess.0, period),
        |orbit| Ok(Py::new(py, PyOrbit::of(orbit, Some(system.clone())))?.into_any()),
    )
}

/// The periodic motion that a motion settles to after a transient.
///
/// Args:
///     system: a Structure or a mass on a belt.
///     start: a state (q, v) or (q, v, memory); for a mass on a belt (u, v).
///     transient: how long the motion is simulated first, in units of time.
///     periods: of a forced motion: how many periods of the drives the motion takes.
///     estimate: of an autonomous motion: an estimate of its period, in units of time.
///     max_steps: bound of the work, in integration steps.
///     progress: a function called with a Progress; the search ends if it returns False.
///
/// Returns:
///     The Orbit.
#[pyfunction]
#[pyo3(signature = (system, start, transient, *, periods = None, estimate = None,
    max_steps = None, progress = None))]
pub fn settle(
    py: Python<'_>,
    system: AnySystem<'_>,
    start: Start,
    transient: f64,
    periods: Option<usize>,
    estimate: Option<f64>,
    max_steps: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    let (system, period) = (
        Arc::new(system.structure().or_raise()?),
        period(periods, estimate)?,
    );
    search(
        py,
        options(max_steps, None, progress),
        |search, _| search.settle(&*system, &start.0, transient, period),
        |orbit| Ok(Py::new(py, PyOrbit::of(orbit, Some(system.clone())))?.into_any()),
    )
}

/// The attractor that a motion approaches; returned by `classify`.
#[pyclass(frozen, get_all, name = "Attractor", module = "stick_slip")]
pub struct PyAttractor {
    /// "rest", "steady sliding", "pure slip", "stick-slip" or "irregular".
    kind: String,
    /// The periodic motion; None if it is none.
    orbit: Option<Py<PyOrbit>>,
}

#[pymethods]
impl PyAttractor {
    fn __repr__(&self) -> String {
        format!("<Attractor {}>", self.kind)
    }
}

fn attractor(
    py: Python<'_>,
    found: Attractor<State>,
    system: Option<Arc<Structure>>,
) -> PyResult<Py<PyAttractor>> {
    let kind = found.kind().to_string();
    let orbit = found
        .orbit()
        .map(|orbit| Py::new(py, PyOrbit::of(orbit.clone(), system)));
    Py::new(
        py,
        PyAttractor {
            kind,
            orbit: orbit.transpose()?,
        },
    )
}

/// The attractor that the motion from a start reaches.
///
/// Args:
///     system: a Structure or a mass on a belt.
///     start: a state (q, v) or (q, v, memory); for a mass on a belt (u, v).
///     max_steps: bound of the work, in integration steps.
///     progress: a function called with a Progress; the search ends if it returns False.
///
/// Returns:
///     An Attractor with its kind and its orbit.
#[pyfunction]
#[pyo3(signature = (system, start, *, max_steps = None, progress = None))]
pub fn classify(
    py: Python<'_>,
    system: AnySystem<'_>,
    start: Start,
    max_steps: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    let system = Arc::new(system.structure().or_raise()?);
    search(
        py,
        options(max_steps, None, progress),
        |search, _| search.classify(&*system, &start.0),
        |found| Ok(attractor(py, found, Some(system.clone()))?.into_any()),
    )
}

/// A periodic motion at a value of the parameter.
#[pyclass(frozen, get_all, name = "BranchPoint", module = "stick_slip")]
pub struct PyBranchPoint {
    /// The parameter, in its own units.
    parameter: f64,
    /// The motion.
    orbit: Py<PyOrbit>,
}

#[pymethods]
impl PyBranchPoint {
    fn __repr__(&self) -> String {
        format!(
            "<BranchPoint {}: {}>",
            short(self.parameter),
            self.orbit.get().__repr__()
        )
    }
}

fn branch_point(py: Python<'_>, parameter: f64, orbit: RustOrbit) -> PyResult<Py<PyBranchPoint>> {
    let orbit = Py::new(py, PyOrbit::of(orbit, None))?;
    Py::new(py, PyBranchPoint { parameter, orbit })
}

/// A bifurcation on a branch.
#[pyclass(frozen, name = "Bifurcation", module = "stick_slip")]
pub struct PyBifurcation(Arc<orbit::Bifurcation<State>>);

#[pymethods]
impl PyBifurcation {
    /// The parameter, in its own units.
    #[getter]
    fn parameter(&self) -> f64 {
        self.0.parameter
    }

    /// "fold", "flip", "pitchfork", "Neimark-Sacker", "grazing" or "change of events".
    #[getter]
    fn kind(&self) -> String {
        self.0.kind.to_string()
    }

    /// The motion at the bifurcation.
    #[getter]
    fn orbit(&self) -> PyOrbit {
        PyOrbit::of(self.0.orbit.clone(), None)
    }

    /// A point of the other branch that crosses at a flip or a pitchfork.
    ///
    /// Args:
    ///     family: the function that returns the system for a value of the parameter.
    ///     progress: a function called with a Progress; the search ends if it returns False.
    #[pyo3(signature = (family, *, progress = None))]
    fn switch(
        &self,
        py: Python<'_>,
        family: Py<PyAny>,
        progress: Option<Py<PyAny>>,
    ) -> PyResult<Py<PyAny>> {
        search(
            py,
            options(None, None, progress),
            |search, waiting| {
                let family = Family::new(family, waiting);
                search.switch(&self.0, |value| family.of_one(value))
            },
            |point| Ok(branch_point(py, point.parameter, point.orbit)?.into_any()),
        )
    }

    fn __repr__(&self) -> String {
        format!(
            "<Bifurcation {} at {}>",
            self.0.kind,
            short(self.0.parameter)
        )
    }
}

record! {
    /// An end of a branch.
    BranchEnd {
        /// "range", "Hopf", "grazing", "discontinuity", "one-way slip", "birth", "closed", "work",
        /// "stopped" or "lost".
        kind: &'static str,
        /// The parameter there; None for "range", "closed" and "work".
        parameter: Option<f64>,
        /// The reason in words; empty if the kind says all.
        reason: String,
    }
}

fn sequence(events: &[(Element, EventKind)]) -> String {
    let event =
        |(element, kind): &(Element, EventKind)| format!("{element}: {}", kind_name(*kind).0);
    events.iter().map(event).collect::<Vec<_>>().join(", ")
}

impl From<&orbit::BranchEnd> for BranchEnd {
    fn from(end: &orbit::BranchEnd) -> Self {
        let (kind, parameter, reason) = match end {
            orbit::BranchEnd::Range => ("range", None, String::new()),
            orbit::BranchEnd::Hopf { parameter } => ("Hopf", Some(*parameter), String::new()),
            orbit::BranchEnd::Grazing { parameter } => ("grazing", Some(*parameter), String::new()),
            orbit::BranchEnd::Discontinuity {
                parameter,
                time,
                contact,
                events,
                beyond,
            } => (
                "discontinuity",
                Some(*parameter),
                format!(
                    "contact {contact} at time {}: events ({}) become ({})",
                    short(*time),
                    sequence(events),
                    sequence(beyond)
                ),
            ),
            orbit::BranchEnd::OneWaySlip {
                parameter,
                contact,
                direction,
            } => (
                "one-way slip",
                Some(*parameter),
                format!(
                    "contact {contact} slips in the direction {:+}",
                    direction.sign()
                ),
            ),
            orbit::BranchEnd::Birth { parameter } => ("birth", Some(*parameter), String::new()),
            orbit::BranchEnd::Closed => ("closed", None, String::new()),
            orbit::BranchEnd::Work => ("work", None, String::new()),
            orbit::BranchEnd::Stopped { parameter } => ("stopped", Some(*parameter), String::new()),
            orbit::BranchEnd::Lost { parameter, error } => {
                ("lost", Some(*parameter), in_python(error))
            }
            other => ("other", None, format!("{other:?}")),
        };
        Self {
            kind,
            parameter,
            reason,
        }
    }
}

/// A branch of periodic motions over a parameter.
#[pyclass(frozen, name = "Branch", module = "stick_slip")]
pub struct PyBranch {
    points: Vec<(f64, Py<PyOrbit>)>,
    bifurcations: Vec<Py<PyBifurcation>>,
    ends: (BranchEnd, BranchEnd),
}

impl PyBranch {
    fn of(py: Python<'_>, branch: Branch<State>) -> PyResult<Self> {
        let Branch {
            points,
            bifurcations,
            ends,
            ..
        } = branch;
        let ends = (BranchEnd::from(&ends[0]), BranchEnd::from(&ends[1]));
        let point =
            |BranchPoint {
                 parameter, orbit, ..
             }| { Ok((parameter, Py::new(py, PyOrbit::of(orbit, None))?)) };
        let points = points.into_iter().map(point).collect::<PyResult<_>>()?;
        let bifurcations = bifurcations.into_iter();
        let bifurcations = bifurcations.map(|it| Py::new(py, PyBifurcation(Arc::new(it))));
        Ok(Self {
            points,
            bifurcations: bifurcations.collect::<PyResult<_>>()?,
            ends,
        })
    }
}

#[pymethods]
impl PyBranch {
    /// The motions, from one end of the branch to the other.
    #[getter]
    fn points(&self, py: Python<'_>) -> PyResult<Vec<Py<PyBranchPoint>>> {
        let point = |(parameter, orbit): &(f64, Py<PyOrbit>)| {
            Py::new(
                py,
                PyBranchPoint {
                    parameter: *parameter,
                    orbit: orbit.clone_ref(py),
                },
            )
        };
        self.points.iter().map(point).collect()
    }

    /// The parameter of each point, as an array.
    #[getter]
    fn parameters(&self) -> Numbers {
        Numbers(self.points.iter().map(|point| point.0).collect())
    }

    /// An array: True for each point whose motion is stable.
    #[getter]
    fn stable<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        let stable = self
            .points
            .iter()
            .map(|point| point.1.get().orbit.is_stable());
        stable.collect::<Vec<bool>>().into_pyarray(py)
    }

    /// The period of each point, as an array, in units of time.
    #[getter]
    fn periods(&self) -> Numbers {
        Numbers(
            self.points
                .iter()
                .map(|point| point.1.get().orbit.period())
                .collect(),
        )
    }

    /// The amplitude of a coordinate at each point, as an array.
    #[pyo3(signature = (coordinate = Index(0)), text_signature = "($self, coordinate=0)")]
    fn amplitudes(&self, coordinate: Index) -> PyResult<Numbers> {
        let amplitude = |point: &(f64, Py<PyOrbit>)| point.1.get().amplitude(coordinate);
        self.points
            .iter()
            .map(amplitude)
            .collect::<PyResult<_>>()
            .map(Numbers)
    }

    /// The point with the largest amplitude of a coordinate: the resonance, as exact as the points
    /// are close. None if no amplitude is known.
    #[pyo3(signature = (coordinate = Index(0)), text_signature = "($self, coordinate=0)")]
    fn peak(&self, py: Python<'_>, coordinate: Index) -> PyResult<Option<Py<PyBranchPoint>>> {
        let sizes = self.amplitudes(coordinate)?.0.into_iter();
        let known = sizes.zip(&self.points).filter(|(size, _)| !size.is_nan());
        let peak = known.max_by(|one, other| one.0.total_cmp(&other.0));
        let peak = peak.map(|(_, (parameter, orbit))| {
            let (parameter, orbit) = (*parameter, orbit.clone_ref(py));
            Py::new(py, PyBranchPoint { parameter, orbit })
        });
        peak.transpose()
    }

    /// The bifurcations, in the order of the branch.
    #[getter]
    fn bifurcations(&self, py: Python<'_>) -> Vec<Py<PyBifurcation>> {
        self.bifurcations
            .iter()
            .map(|it| it.clone_ref(py))
            .collect()
    }

    /// The two ends of the branch, in the order of its points.
    #[getter]
    fn ends(&self) -> (BranchEnd, BranchEnd) {
        self.ends.clone()
    }

    /// Draws a measure over the parameter, unstable motions dashed, with bifurcations marked. Needs
    /// matplotlib.
    ///
    /// Args:
    ///     ax: the axes to draw into; new ones if it is None.
    ///     coordinate: whose amplitude is drawn.
    ///     measure: a function of an Orbit to draw instead.
    ///     bifurcations: mark them.
    ///
    /// Returns:
    ///     The axes.
    #[pyo3(signature = (ax = None, *, coordinate = 0, measure = None, bifurcations = true))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<Bound<'py, PyAny>>,
        coordinate: usize,
        measure: Option<Bound<'py, PyAny>>,
        bifurcations: bool,
    ) -> PyResult<Bound<'py, PyAny>> {
        let plots = slf.py().import("stick_slip._plot")?;
        plots.call_method1("branch", (slf, ax, coordinate, measure, bifurcations))
    }

    fn __len__(&self) -> usize {
        self.points.len()
    }

    fn __repr__(&self) -> String {
        let (first, last) = (self.points.first(), self.points.last());
        let [first, last] = [first, last].map(|point| point.map_or(f64::NAN, |point| point.0));
        format!(
            "<Branch of {} points from {} to {}, {} bifurcations, ends: {}, {}>",
            self.points.len(),
            short(first),
            short(last),
            self.bifurcations.len(),
            self.ends.0.kind,
            self.ends.1.kind
        )
    }
}

/// Follows a periodic motion as a parameter changes, in both directions, through folds.
///
/// Args:
///     family: a function of the parameter that returns the system.
///     parameter: the value to which the orbit belongs.
///     orbit: a periodic motion of `family(parameter)`.
///     low, high: the range of the parameter, in its own units.
///     max_steps: bound of the work in each direction, in integration steps.
///     max_points: bound of the points in each direction.
///     progress: a function called with a Progress; the branch ends if it returns False.
///
/// Returns:
///     The Branch. An exception of the family, or Ctrl-C, carries the branch so far as `found`.
///
/// >>> from stick_slip import MassOnBelt, Polynomial, follow, settle
/// >>> law = Polynomial(0.4, 0.25, 0.5)
/// >>> family = lambda belt_velocity: MassOnBelt(law, belt_velocity, damping=0.05)
/// >>> orbit = settle(family(0.2), (0.0, 0.0), 50.0, estimate=6.8)
/// >>> branch = follow(family, 0.2, orbit, 0.05, 0.5)
/// >>> [(end.kind, end.parameter) for end in branch.ends]
/// [('range', None), ('Hopf', 0.44...)]
#[pyfunction]
#[pyo3(signature = (family, parameter, orbit, low, high, *, max_steps = None, max_points = None,
    progress = None))]
pub fn follow(
    py: Python<'_>,
    family: Py<PyAny>,
    parameter: f64,
    orbit: Bound<'_, PyOrbit>,
    low: f64,
    high: f64,
    max_steps: Option<usize>,
    max_points: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    let orbit = orbit.get().orbit.clone();
    search(
        py,
        options(max_steps, max_points, progress),
        |search, waiting| {
            let family = Family::new(family, waiting);
            search.follow(|value| family.of_one(value), parameter, &orbit, low..high)
        },
        |branch| Ok(Py::new(py, PyBranch::of(py, branch)?)?.into_any()),
    )
}

/// The periodic motion that is born at the Hopf point of steady sliding near a parameter.
///
/// Args:
///     family: a function of the parameter that returns the system.
///     near: a value of the parameter near the Hopf point.
///     progress: a function called with a Progress; the search ends if it returns False.
///
/// Returns:
///     A BranchPoint, from which `follow` goes on.
#[pyfunction]
#[pyo3(signature = (family, near, *, progress = None))]
pub fn begin(
    py: Python<'_>,
    family: Py<PyAny>,
    near: f64,
    progress: Option<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    search(
        py,
        options(None, None, progress),
        |search, waiting| {
            let family = Family::new(family, waiting);
            search.begin(|value| family.of_one(value), near)
        },
        |point| Ok(branch_point(py, point.parameter, point.orbit)?.into_any()),
    )
}

/// The attractors as a parameter rises and falls, each from the end of the one before.
#[pyclass(frozen, get_all, name = "Sweep", module = "stick_slip")]
pub struct PySweep {
    /// The points of the way up.
    up: Vec<Py<SweepPoint>>,
    /// The points of the way down.
    down: Vec<Py<SweepPoint>>,
    /// The parameter at which the sweep was stopped; None if it was not.
    stopped: Option<f64>,
    /// The changes of the attractor on the way up, then those on the way down.
    changes: Vec<Change>,
}

record! {
    /// A change of the attractor between two values of a sweep.
    Change {
        /// The values of the parameter before and after the change.
        between: (f64, f64),
        /// The kind of the attractor before the change.
        before: String,
        /// The kind of the attractor after the change.
        after: String,
    }
}

impl From<orbit::Change> for Change {
    fn from(change: orbit::Change) -> Self {
        Self {
            between: (change.between[0], change.between[1]),
            before: change.from.to_string(),
            after: change.to.to_string(),
        }
    }
}

/// The attractor at one parameter of a sweep.
#[pyclass(frozen, get_all, module = "stick_slip")]
pub struct SweepPoint {
    /// The parameter, in its own units.
    parameter: f64,
    /// The attractor; None if the motion failed.
    attractor: Option<Py<PyAttractor>>,
    /// The error in words if the motion failed, otherwise None.
    error: Option<String>,
}

impl SweepPoint {
    fn all(py: Python<'_>, points: Vec<orbit::SweepPoint<State>>) -> PyResult<Vec<Py<Self>>> {
        let point = |point: orbit::SweepPoint<State>| {
            let (found, error) = match point.attractor {
                Ok(found) => (Some(attractor(py, found, None)?), None),
                Err(error) => (None, Some(in_python(error))),
            };
            let point = Self {
                parameter: point.parameter,
                attractor: found,
                error,
            };
            Py::new(py, point)
        };
        points.into_iter().map(point).collect()
    }
}

#[pymethods]
impl SweepPoint {
    fn __repr__(&self) -> String {
        let kind = self
            .attractor
            .as_ref()
            .map_or("failed", |it| &it.get().kind);
        format!("<SweepPoint {}: {kind}>", short(self.parameter))
    }
}

#[pymethods]
impl PySweep {
    fn __repr__(&self) -> String {
        format!(
            "<Sweep of {} points up, {} down>",
            self.up.len(),
            self.down.len()
        )
    }
}

impl PySweep {
    fn of(py: Python<'_>, sweep: Sweep<State>) -> PyResult<Self> {
        Ok(Self {
            changes: sweep.changes().map(Change::from).collect(),
            up: SweepPoint::all(py, sweep.up)?,
            down: SweepPoint::all(py, sweep.down)?,
            stopped: sweep.stopped,
        })
    }
}

/// The attractors as a parameter rises over given values and falls again.
///
/// Args:
///     family: a function of the parameter that returns the system.
///     values: of the parameter, ascending.
///     start: the state (q, v) or (q, v, memory) at the first value.
///     max_steps: bound of the work, in integration steps.
///     progress: a function called with a Progress; the sweep ends if it returns False.
#[pyfunction]
#[pyo3(signature = (family, values, start, *, max_steps = None, progress = None))]
pub fn sweep(
    py: Python<'_>,
    family: Py<PyAny>,
    values: Numbers,
    start: Start,
    max_steps: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    search(
        py,
        options(max_steps, None, progress),
        |search, waiting| {
            let family = Family::new(family, waiting);
            search.sweep(|value| family.of_one(value), &values.0, &start.0)
        },
        |sweep| Ok(Py::new(py, PySweep::of(py, sweep)?)?.into_any()),
    )
}

record! {
    /// A range of a parameter with the same attractors.
    VibrationRange {
        /// The least parameter, in its own units.
        low: f64,
        /// The largest parameter.
        high: f64,
        /// The kinds of the attractors.
        attractors: Vec<String>,
        /// The changes at the two borders; empty for a mass on a belt.
        borders: Vec<String>,
    }

    /// True if there are several attractors: the past decides.
    #[getter]
    fn is_bistable(&self) -> bool {
        self.attractors.len() > 1
    }

    /// True if one of the attractors is a vibration.
    #[getter]
    fn vibrates(&self) -> bool {
        self.attractors.iter().any(|kind| kind != "rest" && kind != "steady sliding")
    }
}

/// Ranges of a parameter by their attractors: a sequence of VibrationRange.
#[pyclass(frozen, sequence, name = "VibrationRanges", module = "stick_slip")]
pub struct VibrationRanges {
    ranges: Vec<VibrationRange>,
    branches: Vec<Py<PyBranch>>,
    sweep: Option<Py<PySweep>>,
    probes: Vec<Py<SweepPoint>>,
    stopped: Option<f64>,
}

impl VibrationRanges {
    pub fn of_belt(_: Python<'_>, ranges: Vec<bifurcation::VibrationRange>) -> PyResult<Self> {
        let range = |range: bifurcation::VibrationRange| VibrationRange {
            low: range.velocities.start,
            high: range.velocities.end,
            attractors: range.attractors.iter().map(ToString::to_string).collect(),
            borders: Vec::new(),
        };
        let ranges = ranges.into_iter().map(range).collect();
        Ok(Self {
            ranges,
            branches: Vec::new(),
            sweep: None,
            probes: Vec::new(),
            stopped: None,
        })
    }

    fn of(py: Python<'_>, found: orbit::VibrationRanges<State>) -> PyResult<Self> {
        let range = |range: orbit::VibrationRange| VibrationRange {
            low: range.parameters.start,
            high: range.parameters.end,
            attractors: range.attractors.iter().map(ToString::to_string).collect(),
            borders: range.borders.iter().map(ToString::to_string).collect(),
        };
        let branches = found.branches.into_iter();
        let branches = branches.map(|branch| Py::new(py, PyBranch::of(py, branch)?));
        Ok(Self {
            ranges: found.ranges.into_iter().map(range).collect(),
            branches: branches.collect::<PyResult<_>>()?,
            sweep: Some(Py::new(py, PySweep::of(py, found.sweep)?)?),
            probes: SweepPoint::all(py, found.probes)?,
            stopped: found.stopped,
        })
    }
}

#[pymethods]
impl VibrationRanges {
    fn __len__(&self) -> usize {
        self.ranges.len()
    }

    fn __getitem__(&self, index: isize) -> PyResult<VibrationRange> {
        entry(&self.ranges, index)
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        iterator(py, self.ranges.clone())
    }

    /// The branches of periodic motions; empty for a mass on a belt.
    #[getter]
    fn branches(&self, py: Python<'_>) -> Vec<Py<PyBranch>> {
        let branches = self.branches.iter();
        branches.map(|branch| branch.clone_ref(py)).collect()
    }

    /// The attractors that single motions reached, from rest and beyond borders; empty for a mass
    /// on a belt.
    #[getter]
    fn probes(&self, py: Python<'_>) -> Vec<Py<SweepPoint>> {
        let points = self.probes.iter();
        points.map(|point| point.clone_ref(py)).collect()
    }

    /// The sweep with which the search began; None for a mass on a belt.
    #[getter]
    fn sweep(&self, py: Python<'_>) -> Option<Py<PySweep>> {
        self.sweep.as_ref().map(|sweep| sweep.clone_ref(py))
    }

    /// The parameter at which the search was stopped; None if it was not.
    #[getter]
    fn stopped(&self) -> Option<f64> {
        self.stopped
    }

    fn __repr__(&self) -> String {
        let range = |range: &VibrationRange| {
            let attractors = range.attractors.join(" or ");
            format!("{}..{}: {attractors}", short(range.low), short(range.high))
        };
        let ranges = self.ranges.iter().map(range).collect::<Vec<_>>();
        format!("<VibrationRanges {}>", ranges.join("; "))
    }
}

/// The attractors over a range of a parameter, with the borders between them.
///
/// Args:
///     family: a function of the parameter that returns the system; or a MassOnBelt or
///         PhysicalMassOnBelt, whose belt velocity is then the parameter. At each velocity that is
///         tried, all attractors are found, within the limits of `limit_cycles`.
///     low, high: the range of the parameter, in its own units.
///     max_steps: bound of the work, in integration steps.
///     max_points: bound of the points of each branch in each direction.
///     progress: a function called with a Progress; the search ends if it returns False.
///
/// >>> from stick_slip import Exponential, MassOnBelt, vibration_ranges
/// >>> system = MassOnBelt(Exponential(0.6, 0.3, 0.4), 1.0, damping=0.01)
/// >>> for r in vibration_ranges(system, 0.05, 4.0):
/// ...     print(f"{r.low:.3f} to {r.high:.3f}:", " or ".join(r.attractors))
/// 0.050 to 0.906: stick-slip
/// 0.906 to 3.840: steady sliding or stick-slip
/// 3.840 to 4.000: steady sliding
#[pyfunction]
#[pyo3(signature = (family, low, high, *, max_steps = None, max_points = None, progress = None))]
pub fn vibration_ranges(
    py: Python<'_>,
    family: Bound<'_, PyAny>,
    low: f64,
    high: f64,
    max_steps: Option<usize>,
    max_points: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    if let Ok(belt) = family.extract::<BeltArgument<'_>>() {
        if max_points.is_some() {
            return Err(PyValueError::new_err(
                "max_points bounds branches, and a mass on a belt needs none: give max_steps",
            ));
        }
        let system = belt.system();
        return search(
            py,
            options(max_steps, None, progress).in_units_of(system.velocity_unit()),
            |search, _| system.ranges(low..high, search),
            |ranges| Ok(Py::new(py, VibrationRanges::of_belt(py, ranges)?)?.into_any()),
        );
    }
    if !family.is_callable() {
        return Err(PyTypeError::new_err(
            "family is a function of the parameter that returns the system, or a mass on a belt",
        ));
    }
    let family = family.unbind();
    search(
        py,
        options(max_steps, max_points, progress),
        |search, waiting| {
            let family = Family::new(family, waiting);
            search.vibration_ranges(|value| family.of_one(value), low..high)
        },
        |found| Ok(Py::new(py, VibrationRanges::of(py, found)?)?.into_any()),
    )
}

/// A point of a curve of bifurcations.
#[pyclass(frozen, get_all, name = "LocusPoint", module = "stick_slip")]
pub struct PyLocusPoint {
    /// The two parameters, each in its own units.
    parameters: (f64, f64),
    /// The motion.
    orbit: Py<PyOrbit>,
}

#[pymethods]
impl PyLocusPoint {
    fn __repr__(&self) -> String {
        let (first, second) = self.parameters;
        format!("<LocusPoint ({}, {})>", short(first), short(second))
    }
}

/// A special point of a curve of bifurcations.
#[pyclass(frozen, get_all, name = "SpecialPoint", module = "stick_slip")]
pub struct PySpecialPoint {
    /// The kind of the point, for example "cusp", "1:3 resonance" or "Bautin".
    kind: String,
    /// The two parameters, each in its own units.
    parameters: (f64, f64),
}

#[pymethods]
impl PySpecialPoint {
    fn __repr__(&self) -> String {
        let (first, second) = self.parameters;
        format!(
            "<SpecialPoint {} at ({}, {})>",
            self.kind,
            short(first),
            short(second)
        )
    }
}

record! {
    /// An end of a curve of bifurcations.
    LocusEnd {
        /// "ranges", "closed", "special", "jump", "Hopf", "crawls", "work", "stopped" or "lost".
        kind: &'static str,
        /// The parameters there; None if the last point says them.
        parameters: Option<(f64, f64)>,
        /// The reason in words; empty if the kind says all.
        reason: String,
    }
}

impl From<&orbit::LocusEnd> for LocusEnd {
    fn from(end: &orbit::LocusEnd) -> Self {
        let none = String::new;
        let (kind, parameters, reason) = match end {
            orbit::LocusEnd::Ranges => ("ranges", None, none()),
            orbit::LocusEnd::Closed => ("closed", None, none()),
            orbit::LocusEnd::Special => ("special", None, none()),
            orbit::LocusEnd::Jump => ("jump", None, none()),
            orbit::LocusEnd::Hopf { parameters } => ("Hopf", Some(*parameters), none()),
            orbit::LocusEnd::Crawls { parameters } => ("crawls", Some(*parameters), none()),
            orbit::LocusEnd::Work => ("work", None, none()),
            orbit::LocusEnd::Stopped { parameters } => ("stopped", Some(*parameters), none()),
            orbit::LocusEnd::Lost { parameters, error } => {
                ("lost", Some(*parameters), in_python(error))
            }
            other => ("other", None, format!("{other:?}")),
        };
        Self {
            kind,
            parameters: parameters.map(|[first, second]| (first, second)),
            reason,
        }
    }
}

/// A curve of bifurcations in two parameters.
#[pyclass(frozen, get_all, name = "Locus", module = "stick_slip")]
pub struct PyLocus {
    /// The kind of the bifurcation.
    kind: String,
    /// The points of the curve.
    points: Vec<Py<PyLocusPoint>>,
    /// Special points on the curve.
    special: Vec<Py<PySpecialPoint>>,
    /// The two ends of the curve.
    ends: (LocusEnd, LocusEnd),
}

#[pymethods]
impl PyLocus {
    /// The parameters of the points, an array of shape (n, 2).
    #[getter]
    fn parameters(&self) -> Table {
        let mut table = Table::new(2);
        for point in &self.points {
            let (first, second) = point.get().parameters;
            table.push(&[first, second]);
        }
        table
    }

    /// Draws the curve with its special points. Needs matplotlib.
    ///
    /// Args:
    ///     ax: the axes to draw into; new ones if it is None.
    #[pyo3(signature = (ax = None))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        slf.py()
            .import("stick_slip._plot")?
            .call_method1("locus", (slf, ax))
    }

    fn __repr__(&self) -> String {
        format!(
            "<Locus of {}: {} points, {} special>",
            self.kind,
            self.points.len(),
            self.special.len()
        )
    }
}

/// The curve of a bifurcation in two parameters.
///
/// Args:
///     family: a function of two parameters that returns the system.
///     bifurcation: of a branch over the first parameter.
///     second: the second parameter of that branch.
///     ranges: ((low, high), (low, high)) of the two parameters.
///     max_steps: bound of the work in each direction, in integration steps.
///     max_points: bound of the points in each direction.
///     progress: a function called with a Progress; the curve ends if it returns False.
#[pyfunction]
#[pyo3(signature = (family, bifurcation, second, ranges, *, max_steps = None, max_points = None,
    progress = None))]
pub fn locus(
    py: Python<'_>,
    family: Py<PyAny>,
    bifurcation: Bound<'_, PyBifurcation>,
    second: f64,
    ranges: ((f64, f64), (f64, f64)),
    max_steps: Option<usize>,
    max_points: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    let at = bifurcation.get().0.clone();
    let ranges = [ranges.0.0..ranges.0.1, ranges.1.0..ranges.1.1];
    search(
        py,
        options(max_steps, max_points, progress),
        |search, waiting| {
            let family = Family::new(family, waiting);
            search.locus(
                |first, second| family.of_two(first, second),
                &at,
                second,
                ranges,
            )
        },
        |found| {
            let pair = |[first, second]: [f64; 2]| (first, second);
            let points = found.points.into_iter().map(|point| {
                let orbit = Py::new(py, PyOrbit::of(point.orbit, None))?;
                Py::new(
                    py,
                    PyLocusPoint {
                        parameters: pair(point.parameters),
                        orbit,
                    },
                )
            });
            let special = found.special.into_iter().map(|point| {
                let kind = point.kind.to_string();
                Py::new(
                    py,
                    PySpecialPoint {
                        kind,
                        parameters: pair(point.parameters),
                    },
                )
            });
            let locus = PyLocus {
                kind: found.kind.to_string(),
                points: points.collect::<PyResult<_>>()?,
                special: special.collect::<PyResult<_>>()?,
                ends: (
                    LocusEnd::from(&found.ends[0]),
                    LocusEnd::from(&found.ends[1]),
                ),
            };
            Ok(Py::new(py, locus)?.into_any())
        },
    )
}

record! {
    /// A point of a curve of Hopf points.
    HopfPoint {
        /// The two parameters, each in its own units.
        parameters: (f64, f64),
        /// The angular frequency, in radians per unit of time.
        frequency: f64,
        /// The displacements of steady sliding.
        displacements: Numbers,
        /// The first Lyapunov coefficient: negative if the vibration begins softly.
        first_lyapunov_coefficient: f64,
        /// The largest real part of the other eigenvalues, per unit of time; -inf without others.
        /// If it is positive, steady sliding is unstable on both sides of the curve.
        largest_other: f64,
        /// "supercritical", "subcritical" or "degenerate".
        criticality: &'static str,
    }
}

impl From<bifurcation::HopfPoint> for HopfPoint {
    fn from(point: bifurcation::HopfPoint) -> Self {
        Self {
            parameters: (point.parameters[0], point.parameters[1]),
            criticality: criticality_name(point.criticality()),
            frequency: point.frequency,
            displacements: Numbers(point.displacements),
            largest_other: point.largest_other,
            first_lyapunov_coefficient: point.first_lyapunov_coefficient,
        }
    }
}

/// A curve of Hopf points of steady sliding in two parameters.
#[pyclass(frozen, get_all, name = "HopfLocus", module = "stick_slip")]
pub struct PyHopfLocus {
    /// The points of the curve.
    points: Vec<HopfPoint>,
    /// Special points on the curve.
    special: Vec<Py<PySpecialPoint>>,
    /// The two ends of the curve.
    ends: (LocusEnd, LocusEnd),
}

#[pymethods]
impl PyHopfLocus {
    /// The parameters of the points, an array of shape (n, 2).
    #[getter]
    fn parameters(&self) -> Table {
        let mut table = Table::new(2);
        for point in &self.points {
            table.push(&[point.parameters.0, point.parameters.1]);
        }
        table
    }

    fn __repr__(&self) -> String {
        format!(
            "<HopfLocus of {} points, {} special>",
            self.points.len(),
            self.special.len()
        )
    }
}

/// The curves in two parameters at which steady sliding gains or loses stability.
///
/// Args:
///     family: a function of two parameters that returns the system.
///     ranges: ((low, high), (low, high)) of the two parameters.
#[pyfunction]
pub fn hopf_locus(
    py: Python<'_>,
    family: Py<PyAny>,
    ranges: ((f64, f64), (f64, f64)),
) -> PyResult<Py<PyAny>> {
    let ranges = [ranges.0.0..ranges.0.1, ranges.1.0..ranges.1.1];
    let run = |waiting: &Waiting, _: &Options| {
        let family = Family::new(family, waiting);
        bifurcation::hopf_locus(|first, second| family.of_two(first, second), ranges)
    };
    work(
        py,
        options(None, None, None),
        run,
        |found: Vec<HopfLocus>| {
            let curve = |curve: HopfLocus| {
                let special = curve.special.into_iter().map(|special| {
                    let [first, second] = special.point.parameters;
                    let kind = special.kind.to_string();
                    Py::new(
                        py,
                        PySpecialPoint {
                            kind,
                            parameters: (first, second),
                        },
                    )
                });
                Py::new(
                    py,
                    PyHopfLocus {
                        special: special.collect::<PyResult<_>>()?,
                        ends: (
                            LocusEnd::from(&curve.ends[0]),
                            LocusEnd::from(&curve.ends[1]),
                        ),
                        points: curve.points.into_iter().map(HopfPoint::from).collect(),
                    },
                )
            };
            let curves: Vec<Py<PyHopfLocus>> =
                found.into_iter().map(curve).collect::<PyResult<_>>()?;
            Ok(curves.into_pyobject(py)?.into_any().unbind())
        },
    )
}

record! {
    /// A Lyapunov exponent with its standard error.
    LyapunovExponent {
        /// The exponent, per unit of time: positive means chaos.
        value: f64,
        /// The standard error of the exponent, per unit of time.
        spread: f64,
    }
}

/// The largest Lyapunov exponent of the motion from a start, with its standard error.
///
/// Args:
///     system: a Structure or a mass on a belt.
///     start: a state (q, v) or (q, v, memory); for a mass on a belt (u, v).
///     transient: the time before the average, in units of time.
///     duration: of the average, in units of time.
///     max_steps: bound of the work, in integration steps.
///     progress: a function called with a Progress; the search ends if it returns False.
///
/// >>> from stick_slip import MassOnBelt, Polynomial, lyapunov
/// >>> system = MassOnBelt(Polynomial(0.4, 0.25, 0.5), 0.2, damping=0.05)
/// >>> lyapunov(system, (0.0, 0.0), 0.0, 100.0)
/// LyapunovExponent(value=-inf, spread=0.0)
#[pyfunction]
#[pyo3(signature = (system, start, transient, duration, *, max_steps = None, progress = None))]
pub fn lyapunov(
    py: Python<'_>,
    system: AnySystem<'_>,
    start: Start,
    transient: f64,
    duration: f64,
    max_steps: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    let system = system.structure().or_raise()?;
    search(
        py,
        options(max_steps, None, progress),
        |search: Search<'_>, _| search.lyapunov_with_spread(&system, &start.0, transient, duration),
        |found| {
            let exponent = LyapunovExponent {
                value: found.value,
                spread: found.spread,
            };
            Ok(Py::new(py, exponent)?.into_any())
        },
    )
}

fn states(py: Python<'_>, states: &[State]) -> PyResult<Py<PyAny>> {
    let count = states.first().map_or(0, |state| state.displacements.len());
    let (mut q, mut v) = (Table::new(count), Table::new(count));
    for state in states {
        q.push(&state.displacements);
        v.push(&state.velocities);
    }
    Ok((q, v).into_pyobject(py)?.into_any().unbind())
}

/// A Poincare section: the states after each period.
///
/// Args:
///     system: a Structure or a mass on a belt.
///     start: a state (q, v) or (q, v, memory); for a mass on a belt (u, v).
///     period: in units of time, > 0.
///     count: how many states.
///     skip: how many states are left out first.
///
/// Returns:
///     Arrays (q, v) of shape (count, coordinates).
#[pyfunction]
#[pyo3(signature = (system, start, period, count, *, skip = 0))]
pub fn section(
    py: Python<'_>,
    system: AnySystem<'_>,
    start: Start,
    period: f64,
    count: usize,
    skip: usize,
) -> PyResult<Py<PyAny>> {
    let system = system.structure().or_raise()?;
    let run = |waiting: &Waiting, _: &Options| {
        waiting.items(orbit::section(&system, &start.0, period), skip, count)
    };
    work(py, options(None, None, None), run, |found| {
        states(py, &found)
    })
}

/// A Poincare section: the states at the events of one kind at a contact.
///
/// Args:
///     system: a Structure or a mass on a belt.
///     start: a state (q, v) or (q, v, memory); for a mass on a belt (u, v).
///     contact: the number of the contact.
///     kind: "stick", "release", "crossing", "open" or "close".
///     count: how many events.
///     direction: of a release or a crossing: -1 or +1, of slip after the event.
///     skip: how many events are left out first.
///
/// Returns:
///     Arrays (times, q, v); q and v of shape (n, coordinates). There are fewer than count if the
///     motion has no more events.
#[pyfunction]
#[pyo3(signature = (system, start, contact, kind, count, *, direction = -1, skip = 0))]
pub fn section_at(
    py: Python<'_>,
    system: AnySystem<'_>,
    start: Start,
    contact: Index,
    kind: &str,
    count: usize,
    direction: i32,
    skip: usize,
) -> PyResult<Py<PyAny>> {
    let side = match direction {
        -1 => stick_slip::Direction::Lagging,
        1 => stick_slip::Direction::Leading,
        _ => return Err(PyValueError::new_err("direction is -1 or +1")),
    };
    let kind = match kind {
        "stick" => EventKind::Stick,
        "release" => EventKind::Release(side),
        "crossing" => EventKind::Crossing(side),
        "open" => EventKind::Open,
        "close" => EventKind::Close,
        _ => {
            return Err(PyValueError::new_err(
                "kind is 'stick', 'release', 'crossing', 'open' or 'close'",
            ));
        }
    };
    let system = system.structure().or_raise()?;
    let run = |waiting: &Waiting, _: &Options| {
        let events = orbit::section_at(&system, &start.0, contact.0, kind);
        waiting.items(events, skip, count)
    };
    work(
        py,
        options(None, None, None),
        run,
        |found: Vec<stick_slip::Event<State>>| {
            let found = found.into_iter().map(|event| (event.time, event.state));
            let (times, found): (Vec<f64>, Vec<State>) = found.unzip();
            let pair = states(py, &found)?;
            let (q, v): (Py<PyAny>, Py<PyAny>) = pair.extract(py)?;
            Ok((Numbers(times), q, v)
                .into_pyobject(py)?
                .into_any()
                .unbind())
        },
    )
}

record! {
    /// A passage of the sliding speed of a contact through a value: see `section_through`.
    Passage {
        /// The time, in units of time.
        time: f64,
        /// The `State` at this time.
        state: Shown,
        /// True if the contact becomes faster.
        rises: bool,
    }
}

/// A Poincare section: where the sliding speed of a contact passes a value. For contacts that never
/// stick, as with the law `RateState`; no passage is missed.
///
/// Args:
///     system: a Structure or a mass on a belt.
///     start: a state (q, v) or (q, v, memory); for a mass on a belt (u, v).
///     contact: the number of the contact.
///     speed: in units of velocity, > 0.
///     count: how many passages.
///     skip: how many passages are left out first.
///
/// Returns:
///     A list of Passage. There are fewer than count if the motion comes to rest.
///
/// Earthquakes of a fault, by the square metre; a passage to a lower speed is a guess for `shoot`:
///
/// >>> from stick_slip import Contact, RateState, Structure, section_through, shoot
/// >>> law = RateState(f0=0.6, a=0.01, b=0.015, d_c=8e-3, v0=1e-6)
/// >>> fault = (Structure([3.90625e6]).with_ground_spring(0, 1.5625e7)
/// ...     .with_ground_damper(0, 4.6e6).with_force(0, 4.6e6 * 1e-9)
/// ...     .with_contact(Contact(0, law, 5e7, belt_velocity=1e-9)))
/// >>> start = ([1.92], [0.0], [6.9], {0: -1.2e-9})
/// >>> passages = section_through(fault, start, 0, 1e-10, 8)
/// >>> one, other = [passage for passage in passages if not passage.rises][2:4]
/// >>> orbit = shoot(fault, one.state, estimate=other.time - one.time)
/// >>> round(orbit.period), orbit.is_stable
/// (581267701, True)
#[pyfunction]
#[pyo3(signature = (system, start, contact, speed, count, *, skip = 0))]
pub fn section_through(
    py: Python<'_>,
    system: AnySystem<'_>,
    start: Start,
    contact: Index,
    speed: f64,
    count: usize,
    skip: usize,
) -> PyResult<Py<PyAny>> {
    let system = system.structure().or_raise()?;
    let run = |waiting: &Waiting, _: &Options| {
        let passages = orbit::section_through(&system, &start.0, contact.0, speed);
        waiting.items(passages, skip, count)
    };
    work(py, options(None, None, None), run, |found| {
        let passage = |passage: orbit::Passage<State>| Passage {
            time: passage.time,
            state: Shown(passage.state),
            rises: passage.rises,
        };
        let passages: Vec<Passage> = found.into_iter().map(passage).collect();
        Ok(passages.into_pyobject(py)?.into_any().unbind())
    })
}

/// A motion with its derivatives by parameters.
#[pyclass(frozen, name = "Sensitivities", module = "stick_slip")]
pub struct PySensitivities(Arc<Sensitivities>);

#[pymethods]
impl PySensitivities {
    /// The times at which the motion begins and ends.
    #[getter]
    fn times(&self) -> (f64, f64) {
        let [begin, end] = self.0.times();
        (begin, end)
    }

    /// The `State` at a time; None outside of the motion.
    fn state_at(&self, time: f64) -> Option<Shown> {
        self.0.state_at(time).map(Shown)
    }

    /// The derivatives of the state at a time: a row for each displacement, then each velocity,
    /// then each memory variable; a column for each parameter. None outside of the motion.
    fn at(&self, time: f64) -> Option<Table> {
        self.0.at(time).as_ref().map(Table::of)
    }

    /// The events, each with the derivatives of its time.
    #[getter]
    fn events(&self) -> Vec<EventSensitivity> {
        let event = |event: orbit::EventSensitivity| {
            let [contact, stop] = contact_and_stop(event.element);
            EventSensitivity {
                time: event.time,
                contact,
                stop,
                kind: kind_name(event.kind).0,
                by_parameters: Numbers(event.by_parameters),
            }
        };
        self.0.events().into_iter().map(event).collect()
    }

    fn __repr__(&self) -> String {
        let [begin, end] = self.0.times();
        format!("<Sensitivities from {} to {}>", short(begin), short(end))
    }
}

record! {
    /// An event with the derivatives of its time by parameters.
    EventSensitivity {
        /// The time of the event.
        time: f64,
        /// The number of the contact; None if it is an event of a stop.
        contact: Option<usize>,
        /// The number of the stop; None if it is an event of a contact.
        stop: Option<usize>,
        /// "stick", "release", "crossing", "open" or "close".
        kind: &'static str,
        /// The derivative of the time by each parameter.
        by_parameters: Numbers,
    }
}

/// A motion with its derivatives by parameters.
///
/// Args:
///     family: a function of an array of parameters that returns (system, start).
///     parameters: at which the derivatives are taken.
///     duration: of the motion, in units of time.
///     max_steps: bound of the work, in integration steps.
///     progress: a function called with a Progress; the search ends if it returns False.
///
/// >>> from stick_slip import Coulomb, MassOnBelt, sensitivities
/// >>> law = Coulomb(0.4, 0.25)
/// >>> family = lambda p: (MassOnBelt(law, p[0]), (0.0, p[0]))
/// >>> sensitivities(family, [0.5], 4.0).events[0].kind
/// 'release'
#[pyfunction]
#[pyo3(signature = (family, parameters, duration, *, max_steps = None, progress = None))]
pub fn sensitivities(
    py: Python<'_>,
    family: Py<PyAny>,
    parameters: Numbers,
    duration: f64,
    max_steps: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    search(
        py,
        options(max_steps, None, progress),
        |search, waiting| {
            let family = Family::new(family, waiting);
            search.sensitivities(
                |values: &[f64]| family.with_start(values),
                &parameters.0,
                duration,
            )
        },
        |found| Ok(Py::new(py, PySensitivities(Arc::new(found)))?.into_any()),
    )
}

/// A periodic motion with its derivatives by parameters.
#[pyclass(frozen, get_all, name = "OrbitSensitivities", module = "stick_slip")]
pub struct PyOrbitSensitivities {
    /// The derivative of the period by each parameter.
    period: Numbers,
    /// The motion over a period with its derivatives.
    motion: Py<PySensitivities>,
}

#[pymethods]
impl PyOrbitSensitivities {
    fn __repr__(&self) -> String {
        format!("<OrbitSensitivities of {} parameters>", self.period.0.len())
    }
}

/// A periodic motion with its derivatives by parameters.
///
/// Args:
///     family: a function of an array of parameters that returns the system.
///     parameters: at which the derivatives are taken.
///     orbit: a periodic motion of `family(parameters)`.
///     max_steps: bound of the work, in integration steps.
///     progress: a function called with a Progress; the search ends if it returns False.
#[pyfunction]
#[pyo3(signature = (family, parameters, orbit, *, max_steps = None, progress = None))]
pub fn orbit_sensitivities(
    py: Python<'_>,
    family: Py<PyAny>,
    parameters: Numbers,
    orbit: Bound<'_, PyOrbit>,
    max_steps: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    let orbit = orbit.get().orbit.clone();
    search(
        py,
        options(max_steps, None, progress),
        |search, waiting| {
            let family = Family::new(family, waiting);
            search.orbit_sensitivities(
                |values: &[f64]| family.of_many(values),
                &parameters.0,
                &orbit,
            )
        },
        |found| {
            let motion = Py::new(py, PySensitivities(Arc::new(found.motion)))?;
            Ok(Py::new(
                py,
                PyOrbitSensitivities {
                    period: Numbers(found.period),
                    motion,
                },
            )?
            .into_any())
        },
    )
}
