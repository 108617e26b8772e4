//! Limit cycles of a mass on a belt, and their bifurcations.

use std::ops::Range;
use std::sync::Arc;

use pyo3::exceptions::PyTypeError;
use pyo3::gc::{PyTraverseError, PyVisit};
use pyo3::prelude::*;
use pyo3::types::PyIterator;
use stick_slip::Error;
use stick_slip::bifurcation::DiagramPoint;
use stick_slip::limit_cycle::Attractor;

use crate::any_belt::{Answer, Belt, Border, Question, Silencing};
use crate::belt::{BeltArgument, Equilibrium};
use crate::convert::{BeltStart, ComplexNumbers, Count, Numbers, short};
use crate::error::OrRaise;
use crate::motion::{AnyMotion, PyMotion, criticality_name, entry, iterator};
use crate::orbit::VibrationRanges;
use crate::record::record;
use crate::waiting::{Options, Progress, Waiting, options, search, work};

/// A periodic motion of a mass on a belt, exact to rounding. Quantities are dimensionless, or in SI
/// units in a cycle of a `PhysicalMassOnBelt`.
///
/// >>> from stick_slip import MassOnBelt, Polynomial, stick_slip_cycle
/// >>> cycle = stick_slip_cycle(MassOnBelt(Polynomial(0.4, 0.25, 0.5), 0.2, damping=0.05))
/// >>> cycle
/// <LimitCycle stick-slip: T = 6.79942, amplitude = 0.286209, stable>
/// >>> abs(cycle.period - 6.799421444472158) < 1e-14
/// True
#[pyclass(frozen, name = "LimitCycle", module = "stick_slip")]
pub struct LimitCycle(Arc<stick_slip::LimitCycle>);

impl LimitCycle {
    fn of(cycle: &stick_slip::LimitCycle) -> Self {
        Self(Arc::new(cycle.clone()))
    }
}

#[pymethods]
impl LimitCycle {
    /// "pure slip", "stick-slip", "overshoot" or "crossing".
    #[getter]
    fn kind(&self) -> String {
        self.0.kind().to_string()
    }

    /// The state (u, v) at which the motion starts: the release point of a cycle that sticks.
    #[getter]
    fn state(&self) -> (f64, f64) {
        let state = self.0.state();
        (state.displacement, state.velocity)
    }

    /// The period, in units of time.
    #[getter]
    fn period(&self) -> f64 {
        self.0.period()
    }

    /// The angular frequency, in radians per unit of time.
    #[getter]
    fn frequency(&self) -> f64 {
        self.0.frequency()
    }

    /// The frequency 1/period: in hertz in SI units.
    #[getter]
    fn hertz(&self) -> f64 {
        self.0.hertz()
    }

    /// Time in stick in each period.
    #[getter]
    fn stick_duration(&self) -> f64 {
        self.0.stick_duration()
    }

    /// Time in each period in which the mass is faster than the belt.
    #[getter]
    fn leading_duration(&self) -> f64 {
        self.0.leading_duration()
    }

    /// Half the distance between the largest and the least displacement.
    #[getter]
    fn amplitude(&self) -> f64 {
        self.0.amplitude()
    }

    /// Largest displacement.
    #[getter]
    fn max_displacement(&self) -> f64 {
        self.0.max_displacement()
    }

    /// Least displacement.
    #[getter]
    fn min_displacement(&self) -> f64 {
        self.0.min_displacement()
    }

    /// Mean displacement.
    #[getter]
    fn mean_displacement(&self) -> f64 {
        self.0.mean_displacement()
    }

    /// Largest velocity.
    #[getter]
    fn max_velocity(&self) -> f64 {
        self.0.max_velocity()
    }

    /// Least velocity.
    #[getter]
    fn min_velocity(&self) -> f64 {
        self.0.min_velocity()
    }

    /// Root mean square of the velocity.
    #[getter]
    fn rms_velocity(&self) -> f64 {
        self.0.rms_velocity()
    }

    /// Root mean square of the acceleration.
    #[getter]
    fn rms_acceleration(&self) -> f64 {
        self.0.rms_acceleration()
    }

    /// Largest size of the acceleration.
    #[getter]
    fn peak_acceleration(&self) -> f64 {
        self.0.peak_acceleration()
    }

    /// Largest sliding speed: the law must be known up to it.
    #[getter]
    fn max_sliding_speed(&self) -> f64 {
        self.0.max_sliding_speed()
    }

    /// The Floquet multiplier: the factor by which a small perturbation changes in a period.
    #[getter]
    fn multiplier(&self) -> f64 {
        self.0.multiplier()
    }

    /// True if the cycle attracts.
    #[getter]
    fn is_stable(&self) -> bool {
        self.0.is_stable()
    }

    /// The motion over one period.
    #[getter]
    fn motion(&self) -> PyMotion {
        PyMotion(AnyMotion::Belt(Arc::new(self.0.trajectory())))
    }

    /// Work and losses in a period, in units of force times displacement.
    #[getter]
    fn energy(&self) -> CycleEnergy {
        let energy = self.0.energy();
        CycleEnergy {
            drive_work: energy.drive_work,
            belt_work: energy.belt_work,
            friction_loss: energy.friction_loss,
            damper_loss: energy.damper_loss,
        }
    }

    /// Complex amplitudes of the first n harmonics of the displacement.
    fn harmonics(&self, n: Count) -> ComplexNumbers {
        ComplexNumbers(self.0.harmonics(n.0))
    }

    /// Complex amplitudes of the first n harmonics of the velocity.
    fn velocity_harmonics(&self, n: Count) -> ComplexNumbers {
        ComplexNumbers(self.0.velocity_harmonics(n.0))
    }

    /// Complex amplitudes of the first n harmonics of the acceleration.
    fn acceleration_harmonics(&self, n: Count) -> ComplexNumbers {
        ComplexNumbers(self.0.acceleration_harmonics(n.0))
    }

    fn __repr__(&self) -> String {
        format!("<LimitCycle {}>", self.0)
    }
}

record! {
    /// Work and losses of a limit cycle in a period, in units of force times displacement.
    CycleEnergy {
        /// Work of the drive that moves the belt.
        drive_work: f64,
        /// Work of friction on the mass.
        belt_work: f64,
        /// Heat in the contact.
        friction_loss: f64,
        /// Heat in the damper.
        damper_loss: f64,
    }
}

/// All limit cycles of a system by ascending amplitude: a sequence, with what it does not contain.
///
/// >>> from stick_slip import MassOnBelt, Polynomial, limit_cycles
/// >>> cycles = limit_cycles(MassOnBelt(Polynomial(0.4, 0.25, 0.5), 0.2, damping=0.05))
/// >>> cycles
/// <CycleSet [stick-slip: T = 6.79942, amplitude = 0.286209, stable]>
/// >>> [cycle.kind for cycle in cycles]
/// ['stick-slip']
#[pyclass(frozen, sequence, module = "stick_slip")]
#[derive(Clone)]
pub struct CycleSet(Arc<stick_slip::CycleSet>);

#[pymethods]
impl CycleSet {
    fn __len__(&self) -> usize {
        self.0.len()
    }

    fn __getitem__(&self, index: isize) -> PyResult<LimitCycle> {
        entry(self.0.as_slice(), index).map(|cycle| LimitCycle::of(&cycle))
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        iterator(py, self.0.iter().map(LimitCycle::of).collect())
    }

    /// The stable cycles.
    #[getter]
    fn stable(&self) -> Vec<LimitCycle> {
        self.0.stable().map(LimitCycle::of).collect()
    }

    /// The cycles that are not stable.
    #[getter]
    fn unstable(&self) -> Vec<LimitCycle> {
        self.0.unstable().map(LimitCycle::of).collect()
    }

    /// The largest amplitude of a continuous family of periodic motions; None if there is none.
    #[getter]
    fn continuum(&self) -> Option<f64> {
        self.0.continuum().map(|family| family.max_amplitude)
    }

    /// Ranges (low, high) of velocity maxima in which rounding hides whether there are cycles.
    #[getter]
    fn unresolved(&self) -> Vec<(f64, f64)> {
        pairs(self.0.unresolved())
    }

    fn __repr__(&self) -> String {
        let cycles: Vec<String> = self.0.iter().map(ToString::to_string).collect();
        let mut text = format!("<CycleSet [{}]", cycles.join("; "));
        if let Some(family) = self.0.continuum() {
            text += &format!(
                ", continuum up to amplitude {}",
                short(family.max_amplitude)
            );
        }
        if !self.0.unresolved().is_empty() {
            text += &format!(", unresolved {:?}", pairs(self.0.unresolved()));
        }
        text + ">"
    }
}

fn pairs(ranges: &[Range<f64>]) -> Vec<(f64, f64)> {
    ranges
        .iter()
        .map(|range| (range.start, range.end))
        .collect()
}

/// All limit cycles, stable and unstable.
///
/// Args:
///     system: a MassOnBelt or a PhysicalMassOnBelt.
///
/// Returns:
///     A CycleSet.
#[pyfunction]
pub fn limit_cycles(py: Python<'_>, system: BeltArgument<'_>) -> PyResult<CycleSet> {
    let system = system.system();
    let cycles = py.detach(|| system.cycles()).or_raise()?;
    Ok(CycleSet(Arc::new(cycles)))
}

/// The limit cycle that sticks; None if there is none.
#[pyfunction]
pub fn stick_slip_cycle(py: Python<'_>, system: BeltArgument<'_>) -> PyResult<Option<LimitCycle>> {
    let system = system.system();
    let cycle = py.detach(|| system.stick_slip()).or_raise()?;
    Ok(cycle.as_ref().map(LimitCycle::of))
}

/// The attractor that a motion approaches; returned by `attractor` of a mass on a belt.
#[pyclass(frozen, get_all, module = "stick_slip")]
pub struct BeltAttractor {
    /// "rest", "steady sliding", "pure slip", "stick-slip", "overshoot", "crossing", "continuum",
    /// "unbounded", "unresolved", or "separatrix (...)" if the start is on an unstable cycle.
    kind: String,
    /// The limit cycle; None if it is none.
    cycle: Option<Py<LimitCycle>>,
}

#[pymethods]
impl BeltAttractor {
    fn __repr__(&self) -> String {
        format!("<BeltAttractor {}>", self.kind)
    }
}

/// The attractor that a motion reaches.
///
/// Args:
///     system: a MassOnBelt or a PhysicalMassOnBelt.
///     start: the state (u, v), or a list of such states; for many the work is done once.
///
/// >>> from stick_slip import MassOnBelt, Polynomial, attractor
/// >>> system = MassOnBelt(Polynomial(0.4, 0.25, 0.5), 0.2, damping=0.05)
/// >>> attractor(system, (0.0, 0.0))
/// <BeltAttractor stick-slip>
#[pyfunction]
pub fn attractor<'py>(
    py: Python<'py>,
    system: BeltArgument<'py>,
    start: &Bound<'py, PyAny>,
) -> PyResult<Py<PyAny>> {
    let found = |attractor: &Attractor| {
        let cycle = match attractor {
            Attractor::Cycle(cycle) | Attractor::Separatrix(cycle) => Some(LimitCycle::of(cycle)),
            _ => None,
        };
        let cycle = cycle.map(|cycle| Py::new(py, cycle)).transpose()?;
        Py::new(
            py,
            BeltAttractor {
                kind: attractor.to_string(),
                cycle,
            },
        )
    };
    let system = system.system();
    if let Ok(start) = start.extract::<BeltStart>() {
        let attractors = py.detach(|| system.attractors(&[start.0])).or_raise()?;
        return Ok(found(&attractors[0])?.into_any());
    }
    let starts: Vec<BeltStart> = start.extract()?;
    let starts: Vec<stick_slip::State> = starts.into_iter().map(|start| start.0).collect();
    let attractors = py.detach(|| system.attractors(&starts)).or_raise()?;
    let attractors: Vec<Py<BeltAttractor>> =
        attractors.iter().map(found).collect::<PyResult<_>>()?;
    Ok(attractors.into_pyobject(py)?.into_any().unbind())
}

fn border(
    py: Python<'_>,
    border: Border,
    system: BeltArgument<'_>,
    range: (f64, f64),
    max_steps: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    let system = system.system();
    let range = range.0..range.1;
    search(
        py,
        options(max_steps, None, progress).in_units_of(system.velocity_unit()),
        |search, _| system.velocities(border, range, search),
        |found| Ok(Numbers(found).into_pyobject(py)?.into_any().unbind()),
    )
}

/// The functions that search belt velocities of one system.
macro_rules! velocities {
    ($($(#[$meta:meta])* $name:ident: $border:ident;)*) => {$(
        $(#[$meta])*
        ///
        /// Args:
        ///     system: a MassOnBelt or a PhysicalMassOnBelt; its own belt velocity is ignored.
        ///     low, high: the range of belt velocities, in units of velocity.
        ///     max_steps: bound of the work, in integration steps.
        ///     progress: a function called with a Progress; the search ends if it returns False.
        ///
        /// Returns:
        ///     An array of velocities, ascending.
        #[pyfunction]
        #[pyo3(signature = (system, low, high, *, max_steps = None, progress = None))]
        pub fn $name(
            py: Python<'_>,
            system: BeltArgument<'_>,
            low: f64,
            high: f64,
            max_steps: Option<usize>,
            progress: Option<Py<PyAny>>,
        ) -> PyResult<Py<PyAny>> {
            border(py, Border::$border, system, (low, high), max_steps, progress)
        }
    )*};
}

velocities! {
    /// The belt velocities at which steady sliding gains or loses stability.
    hopf_velocities: Hopf;
    /// The belt velocities at which stick-slip appears or disappears.
    grazing_velocities: Grazing;
    /// The belt velocities at which the largest velocity of a pure-slip cycle reaches the belt's.
    touching_velocities: Touching;
    /// The belt velocities at which stick-slip begins to overshoot the belt velocity.
    overshoot_velocities: Overshoot;
    /// The belt velocities at which an overshooting cycle ceases to stick.
    crossing_velocities: Crossing;
    /// The belt velocities at which a stable and an unstable cycle meet and vanish.
    fold_velocities: Folds;
}

fn silencing(py: Python<'_>, system: &BeltArgument<'_>, of: Silencing) -> PyResult<f64> {
    let system = system.system();
    py.detach(|| system.silencing(of)).or_raise()
}

/// The least damping without vibration at the system's belt velocity: a damping ratio, or N s/m.
///
/// >>> from stick_slip import Exponential, MassOnBelt, silencing_damping
/// >>> silencing_damping(MassOnBelt(Exponential(0.4, 0.25, 0.5), 1.0)) > 0.012
/// True
#[pyfunction]
pub fn silencing_damping(py: Python<'_>, system: BeltArgument<'_>) -> PyResult<f64> {
    silencing(py, &system, Silencing::Damping)
}

/// The load at which vibration begins: a friction load, or N.
#[pyfunction]
pub fn silencing_load(py: Python<'_>, system: BeltArgument<'_>) -> PyResult<f64> {
    silencing(py, &system, Silencing::Load)
}

/// The stiffness of the spring at which vibration ends: a multiple of that of a MassOnBelt, or N/m.
#[pyfunction]
pub fn silencing_stiffness(py: Python<'_>, system: BeltArgument<'_>) -> PyResult<f64> {
    silencing(py, &system, Silencing::Stiffness)
}

/// The kind of Hopf bifurcation at a Hopf velocity: "supercritical", "subcritical" or "degenerate".
#[pyfunction]
pub fn criticality(system: BeltArgument<'_>, velocity: f64) -> &'static str {
    criticality_name(system.system().criticality(velocity))
}

/// Steady sliding and all limit cycles over belt velocities: a sequence of points.
///
/// >>> from stick_slip import MassOnBelt, Polynomial, diagram
/// >>> system = MassOnBelt(Polynomial(0.4, 0.25, 0.5), 0.2, damping=0.05)
/// >>> points = diagram(system, [0.2, 0.42, 0.46])
/// >>> [[cycle.kind for cycle in point.cycles] for point in points]
/// [['stick-slip'], ['pure slip'], []]
#[pyclass(frozen, sequence, module = "stick_slip")]
pub struct Diagram(Vec<Py<PyDiagramPoint>>);

#[pymethods]
impl Diagram {
    fn __len__(&self) -> usize {
        self.0.len()
    }

    fn __getitem__(&self, py: Python<'_>, index: isize) -> PyResult<Py<PyDiagramPoint>> {
        let places: Vec<usize> = (0..self.0.len()).collect();
        Ok(self.0[entry(&places, index)?].clone_ref(py))
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyIterator>> {
        iterator(py, self.0.iter().map(|point| point.clone_ref(py)).collect())
    }

    /// Draws the amplitudes of the cycles over the belt velocity, unstable ones dashed. Needs
    /// matplotlib.
    ///
    /// Args:
    ///     ax: the axes to draw into; new ones if it is None.
    ///     measure: a property of LimitCycle to draw.
    ///
    /// Returns:
    ///     The axes.
    #[pyo3(signature = (ax = None, *, measure = "amplitude"))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<Bound<'py, PyAny>>,
        measure: &str,
    ) -> PyResult<Bound<'py, PyAny>> {
        let plots = slf.py().import("stick_slip._plot")?;
        plots.call_method1("diagram", (slf, ax, measure))
    }

    fn __repr__(&self) -> String {
        format!("<Diagram of {} belt velocities>", self.0.len())
    }
}

/// Steady sliding and all limit cycles at one belt velocity.
#[pyclass(frozen, name = "DiagramPoint", module = "stick_slip")]
pub struct PyDiagramPoint {
    belt_velocity: f64,
    equilibrium: Option<Equilibrium>,
    cycles: CycleSet,
}

#[pymethods]
impl PyDiagramPoint {
    /// The belt velocity, in units of velocity.
    #[getter]
    fn belt_velocity(&self) -> f64 {
        self.belt_velocity
    }

    /// Steady sliding; None on a belt at rest.
    #[getter]
    fn equilibrium(&self) -> Option<Equilibrium> {
        self.equilibrium.clone()
    }

    /// The limit cycles.
    #[getter]
    fn cycles(&self) -> CycleSet {
        self.cycles.clone()
    }

    fn __repr__(&self) -> String {
        format!(
            "<DiagramPoint {}: {} cycles>",
            short(self.belt_velocity),
            self.cycles.0.len()
        )
    }
}

impl From<DiagramPoint> for PyDiagramPoint {
    fn from(point: DiagramPoint) -> Self {
        Self {
            belt_velocity: point.belt_velocity,
            equilibrium: point.equilibrium.map(Equilibrium::from),
            cycles: CycleSet(Arc::new(point.cycles)),
        }
    }
}

/// Steady sliding and all limit cycles at each of several belt velocities.
///
/// Args:
///     system: a MassOnBelt or a PhysicalMassOnBelt; its own belt velocity is ignored.
///     velocities: an array, in units of velocity.
///     progress: a function called with a Progress before each velocity; the diagram ends if it
///         returns False.
///
/// Returns:
///     A Diagram. Ctrl-C keeps what was computed as `found` of the KeyboardInterrupt.
#[pyfunction]
#[pyo3(signature = (system, velocities, *, progress = None))]
pub fn diagram(
    py: Python<'_>,
    system: BeltArgument<'_>,
    velocities: Numbers,
    progress: Option<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    let system = system.system();
    let options = options(None, None, progress);
    let run = |waiting: &Waiting, options: &Options| {
        let mut points = Vec::new();
        for &velocity in &velocities.0 {
            let now = Progress {
                value: velocity,
                second: None,
                points: points.len(),
                steps: 0,
            };
            if !waiting.goes_on(options, now) {
                break;
            }
            points.push(system.point(velocity)?);
        }
        Ok(points)
    };
    work(py, options, run, |points: Vec<DiagramPoint>| {
        let points = points
            .into_iter()
            .map(|point| Py::new(py, PyDiagramPoint::from(point)));
        let diagram = Diagram(points.collect::<PyResult<_>>()?);
        Ok(Py::new(py, diagram)?.into_any())
    })
}

/// A search of a family of masses on a belt along any parameter: `along(family, low, high)`.
///
/// >>> from stick_slip import Exponential, MassOnBelt, along
/// >>> law = Exponential(0.4, 0.25, 0.5)
/// >>> search = along(lambda load: MassOnBelt(law, 0.4, damping=0.05, load=load), 0.01, 2.0)
/// >>> search.hopf()
/// array([0.39510018])
#[pyclass(frozen, module = "stick_slip")]
pub struct Along {
    family: Py<PyAny>,
    low: f64,
    high: f64,
    max_steps: Option<usize>,
    progress: Option<Py<PyAny>>,
}

/// A search of a family of masses on a belt along any parameter.
///
/// Args:
///     family: a function of the parameter that returns a MassOnBelt or a PhysicalMassOnBelt.
///     low, high: the range of the parameter, in its own units.
///     max_steps: bound of the work, in integration steps.
///     progress: a function called with a Progress; the search ends if it returns False.
///
/// Returns:
///     An Along; its methods are the searches. Each calls the family anew.
#[pyfunction]
#[pyo3(signature = (family, low, high, *, max_steps = None, progress = None))]
pub fn along(
    family: Py<PyAny>,
    low: f64,
    high: f64,
    max_steps: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> Along {
    Along {
        family,
        low,
        high,
        max_steps,
        progress,
    }
}

impl Along {
    fn ask(&self, py: Python<'_>, question: Question) -> PyResult<Py<PyAny>> {
        let progress = self.progress.as_ref().map(|it| it.clone_ref(py));
        let options = options(self.max_steps, None, progress);
        let function = self.family.clone_ref(py);
        let range = self.low..self.high;
        let low = self.low;
        search(
            py,
            options,
            |search, waiting| {
                let family = |value: f64| -> Result<Arc<dyn Belt>, Error> {
                    waiting.call(|py| {
                        let system = function.bind(py).call1((value,))?;
                        let system: BeltArgument<'_> = system.extract().map_err(|_| {
                            PyTypeError::new_err(
                                "the family must return a MassOnBelt or a PhysicalMassOnBelt",
                            )
                        })?;
                        Ok(system.system())
                    })
                };
                // Any member of the family knows its kind of law.
                family(low)?.along(question, &family, range, "parameter", search)
            },
            |answer| {
                Ok(match answer {
                    Answer::Values(values) => {
                        Numbers(values).into_pyobject(py)?.into_any().unbind()
                    }
                    Answer::Value(value) => value.into_pyobject(py)?.into_any().unbind(),
                    Answer::Ranges(ranges) => {
                        Py::new(py, VibrationRanges::of_belt(py, ranges)?)?.into_any()
                    }
                })
            },
        )
    }
}

#[pymethods]
impl Along {
    /// Visits the family for the collector of cycles: it may hold its own search.
    fn __traverse__(&self, visit: PyVisit<'_>) -> Result<(), PyTraverseError> {
        visit.call(&self.family)?;
        visit.call(&self.progress)
    }

    /// Parameters at which steady sliding gains or loses stability.
    fn hopf(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.ask(py, Question::Border(Border::Hopf))
    }

    /// Parameters at which stick-slip appears or disappears.
    fn grazing(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.ask(py, Question::Border(Border::Grazing))
    }

    /// Parameters at which the largest velocity of a pure-slip cycle reaches the belt velocity.
    fn touching(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.ask(py, Question::Border(Border::Touching))
    }

    /// Parameters at which stick-slip begins to overshoot.
    fn overshoot(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.ask(py, Question::Border(Border::Overshoot))
    }

    /// Parameters at which an overshooting cycle ceases to stick.
    fn crossing(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.ask(py, Question::Border(Border::Crossing))
    }

    /// Parameters at which a stable and an unstable cycle meet and vanish.
    fn folds(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.ask(py, Question::Border(Border::Folds))
    }

    /// The attractors over the range.
    fn vibration_ranges(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.ask(py, Question::Ranges)
    }

    /// The value at which vibration begins or ends, if the systems at one end of the range vibrate
    /// and those at the other end do not; None otherwise.
    fn silence(&self, py: Python<'_>) -> PyResult<Py<PyAny>> {
        self.ask(py, Question::Silence)
    }

    fn __repr__(&self) -> String {
        format!("<Along from {} to {}>", short(self.low), short(self.high))
    }
}
