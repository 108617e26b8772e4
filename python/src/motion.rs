//! `Motion`: the motion of a mass on a belt or of a structure.

use std::sync::Arc;

use numpy::ndarray::Array1;
use numpy::{IntoPyArray, PyArray1};
use pyo3::exceptions::{PyIndexError, PyTypeError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyBytes, PyIterator, PyList};
use stick_slip::bifurcation::Criticality;
use stick_slip::{Element, Ended, Event, EventKind, Mode, Structure, Trajectory, structure};

use crate::convert::{Count, Index, Numbers, Table, elementwise, number, short, vector, within};
use crate::error::{OrRaise, raised};
use crate::record::record;
use crate::state::Shown;
use crate::waiting::{Options, Waiting, options, work};

/// A motion of either kind of system.
#[derive(Clone)]
pub enum AnyMotion {
    Belt(Arc<Trajectory>),
    /// A motion with the structure that moves, for forces and energies.
    Structure(Arc<Trajectory<structure::State>>, Option<Arc<Structure>>),
}

/// Runs an expression with the trajectory of either kind.
macro_rules! with_motion {
    ($motion:expr, $trajectory:ident => $result:expr) => {
        match $motion {
            AnyMotion::Belt($trajectory) => $result,
            AnyMotion::Structure($trajectory, _) => $result,
        }
    };
}

/// An event without its state.
pub struct Happening {
    pub time: f64,
    pub element: Element,
    pub kind: EventKind,
}

impl<S> From<&Event<S>> for Happening {
    fn from(event: &Event<S>) -> Self {
        Self {
            time: event.time,
            element: event.element,
            kind: event.kind,
        }
    }
}

impl AnyMotion {
    pub fn events(&self) -> Vec<Happening> {
        with_motion!(self, motion => motion.events().iter().map(Happening::from).collect())
    }

    pub fn ended(&self) -> &Ended {
        with_motion!(self, motion => motion.ended())
    }

    fn start_time(&self) -> f64 {
        use stick_slip::Segment as _;
        with_motion!(self, motion => motion.steps().first().map_or(0.0, |step| step.start_time()))
    }

    fn mode_at(&self, contact: usize, time: f64) -> Option<Mode> {
        match self {
            Self::Belt(motion) => motion.mode_at(time),
            Self::Structure(motion, _) => motion.mode_at(contact, time),
        }
    }

    /// The number of contacts, unless there is no step that would have them.
    fn contacts(&self) -> Option<usize> {
        match self {
            Self::Belt(_) => Some(1),
            Self::Structure(motion, _) => motion.steps().first().map(|step| step.modes().len()),
        }
    }

    fn contact(&self, index: Index) -> PyResult<usize> {
        self.contacts()
            .map_or(Ok(index.0), |count| within(index, count, "contact"))
    }
}

/// The number of the contact of an event, or of its stop.
pub fn contact_and_stop(element: Element) -> [Option<usize>; 2] {
    match element {
        Element::Contact(contact) => [Some(contact), None],
        Element::Stop(stop) => [None, Some(stop)],
        _ => [None; 2],
    }
}

/// The name of a criticality.
pub fn criticality_name(criticality: Criticality) -> &'static str {
    match criticality {
        Criticality::Supercritical => "supercritical",
        Criticality::Subcritical => "subcritical",
        Criticality::Degenerate => "degenerate",
    }
}

/// The name of a kind of event without its direction, and the direction.
pub fn kind_name(kind: EventKind) -> (&'static str, i32) {
    match kind {
        EventKind::Stick => ("stick", 0),
        EventKind::Release(direction) => ("release", direction.sign() as i32),
        EventKind::Crossing(direction) => ("crossing", direction.sign() as i32),
        EventKind::Open => ("open", 0),
        EventKind::Close => ("close", 0),
    }
}

/// Events as a structured array that pandas takes: see `Motion.events`.
pub fn events_array<'py>(py: Python<'py>, events: &[Happening]) -> PyResult<Bound<'py, PyAny>> {
    const LETTERS: usize = 8;
    let mut bytes = Vec::with_capacity(events.len() * (8 + 4 + 4 + 4 * LETTERS + 4));
    for event in events {
        let (name, direction) = kind_name(event.kind);
        bytes.extend(event.time.to_le_bytes());
        for number in contact_and_stop(event.element) {
            let number = number.map_or(-1, |number| number as i32);
            bytes.extend(number.to_le_bytes());
        }
        let letters = name
            .chars()
            .map(|letter| letter as u32)
            .chain(std::iter::repeat(0));
        bytes.extend(letters.take(LETTERS).flat_map(u32::to_le_bytes));
        bytes.extend(direction.to_le_bytes());
    }
    // Made once: a data type takes longer than the events of most motions.
    static DTYPE: PyOnceLock<Py<PyAny>> = PyOnceLock::new();
    let numpy = py.import("numpy")?;
    let dtype = DTYPE.get_or_try_init(py, || {
        let fields = [
            ("time", "<f8"),
            ("contact", "<i4"),
            ("stop", "<i4"),
            ("kind", "<U8"),
            ("direction", "<i4"),
        ];
        let fields = PyList::new(py, fields)?;
        PyResult::Ok(numpy.call_method1("dtype", (fields,))?.unbind())
    })?;
    numpy.call_method1("frombuffer", (PyBytes::new(py, &bytes), dtype.bind(py)))
}

/// The mode of a contact as a number: see `Motion.modes`.
fn mode_number(mode: Option<Mode>) -> i8 {
    match mode {
        Some(Mode::Stick) => 0,
        Some(Mode::Slip(direction)) => direction.sign() as i8,
        Some(Mode::Open) => 2,
        None => -128,
    }
}

/// The motion of a system from a start, exact to rounding between its events too.
///
/// Times, displacements and velocities have the units of the system: dimensionless for a
/// `MassOnBelt`, SI for a `PhysicalMassOnBelt`, those of the structure for a `Structure`.
///
/// >>> import numpy as np
/// >>> from stick_slip import MassOnBelt, Polynomial
/// >>> motion = MassOnBelt(Polynomial(0.4, 0.25, 0.5), 0.2).simulate((0.0, 0.0), 10.0)
/// >>> motion
/// <Motion from 0.0 to 10.0: 4 events, ended by duration>
/// >>> u, v = motion.sample(np.linspace(0, 10, 1001))
/// >>> motion.events["kind"]
/// array(['stick', 'release', 'stick', 'release'], dtype='<U8')
#[pyclass(frozen, name = "Motion", module = "stick_slip")]
pub struct PyMotion(pub AnyMotion);

#[pymethods]
impl PyMotion {
    /// The duration, in units of time.
    #[getter]
    fn duration(&self) -> f64 {
        with_motion!(&self.0, motion => motion.duration())
    }

    /// The time of the start.
    #[getter]
    fn start_time(&self) -> f64 {
        self.0.start_time()
    }

    /// The time of the end.
    #[getter]
    fn end_time(&self) -> f64 {
        self.0.start_time() + self.duration()
    }

    /// Why the motion ended: "duration", "stopped" (by `until`) or "error".
    #[getter]
    fn ended(&self) -> &'static str {
        match self.0.ended() {
            Ended::Duration => "duration",
            Ended::Stopped => "stopped",
            _ => "error",
        }
    }

    /// The number of integration steps.
    #[getter]
    fn steps(&self) -> usize {
        with_motion!(&self.0, motion => motion.steps().len())
    }

    /// The number of contacts; 0 in a motion without a step.
    #[getter]
    fn contacts(&self) -> usize {
        self.0.contacts().unwrap_or(0)
    }

    /// The events as a structured array with the fields time, contact (its number; -1 for an event
    /// of a stop), stop (its number; -1 for an event of a contact), kind ("stick", "release",
    /// "crossing", "open" or "close") and direction (of slip after the event: -1 or +1, otherwise
    /// 0). `pandas.DataFrame(motion.events)` makes a table of it.
    #[getter]
    fn events<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        events_array(py, &self.0.events())
    }

    /// The state at the end: two numbers (u, v) for a mass on a belt, two arrays for a structure.
    #[getter]
    fn last<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        match &self.0 {
            AnyMotion::Belt(motion) => {
                let state = motion.last();
                Ok((state.displacement, state.velocity)
                    .into_pyobject(py)?
                    .into_any())
            }
            AnyMotion::Structure(motion, _) => {
                let state = motion.last();
                let pair = (Numbers(state.displacements), Numbers(state.velocities));
                Ok(pair.into_pyobject(py)?.into_any())
            }
        }
    }

    /// The whole state at a time, from which a motion goes on with the same bits: two numbers
    /// (u, v) for a mass on a belt, a `State` for a structure. None outside of the motion.
    ///
    /// Args:
    ///     time: in units of time; the end of the motion if it is None.
    ///
    /// >>> from stick_slip import Contact, Coulomb, Dwell, Structure
    /// >>> law = Dwell(Coulomb(0.3, 0.2), limit=0.5, time=2.0)
    /// >>> block = (Structure([1.0]).with_ground_spring(0, 1.0)
    /// ...     .with_contact(Contact(0, law, 1.0, belt_velocity=0.1)))
    /// >>> first = block.simulate(([0.0], [0.1], [0.0]), 2.0)
    /// >>> first.state_at()       # the memory variable is the time in stick
    /// State(displacements=array([0.2]), velocities=array([0.1]), memory=array([2.]), sliding={})
    /// >>> then = block.simulate(first.state_at(), 5.0, start_time=first.end_time)
    #[pyo3(signature = (time = None))]
    fn state_at<'py>(
        &self,
        py: Python<'py>,
        time: Option<f64>,
    ) -> PyResult<Option<Bound<'py, PyAny>>> {
        Ok(match &self.0 {
            AnyMotion::Belt(motion) => {
                let state = time.map_or_else(|| Some(motion.last()), |time| motion.state_at(time));
                let pair = state.map(|it| (it.displacement, it.velocity).into_pyobject(py));
                pair.transpose()?.map(Bound::into_any)
            }
            AnyMotion::Structure(motion, _) => {
                let state = time.map_or_else(|| Some(motion.last()), |time| motion.state_at(time));
                state.map(|it| Shown(it).into_pyobject(py)).transpose()?
            }
        })
    }

    /// Displacements and velocities at given times; nan outside of the motion.
    ///
    /// Args:
    ///     times: a number or a one-dimensional array, in units of time.
    ///
    /// Returns:
    ///     Two arrays (u, v): of shape (n,) for a mass on a belt, (n, coordinates) for a structure.
    ///     For one number the first axis is missing.
    ///
    /// >>> from stick_slip import Coulomb, MassOnBelt
    /// >>> motion = MassOnBelt(Coulomb(0.4, 0.25), 0.5).simulate((0.0, 0.5), 1.5)
    /// >>> motion.sample([0.25, 0.5, 99.0])
    /// (array([0.125, 0.25 ,   nan]), array([0.5, 0.5, nan]))
    /// >>> motion.sample(0.25)
    /// (0.125, 0.5)
    fn sample<'py>(&self, times: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = times.py();
        if let Some(time) = number(times) {
            return self.sample_one(py, time);
        }
        let times = times_of(times)?;
        match &self.0 {
            AnyMotion::Belt(motion) => {
                let (u, v) = py.detach(|| sample_belt(motion, &times));
                Ok((Numbers(u), Numbers(v)).into_pyobject(py)?.into_any())
            }
            AnyMotion::Structure(motion, _) => {
                let pair = py.detach(|| {
                    sample_structure(motion, &times, |state| {
                        [&state.displacements, &state.velocities]
                    })
                });
                Ok(pair.into_pyobject(py)?.into_any())
            }
        }
    }

    /// The memory variables at given times, in an array of shape (n, variables); nan outside of the
    /// motion. The variables of contact 0 come first, first-order states last.
    fn sample_memory<'py>(&self, times: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        let py = times.py();
        let times = times_of(times)?;
        let AnyMotion::Structure(motion, _) = &self.0 else {
            let mut none = Table::new(0);
            times.iter().for_each(|_| none.push(&[]));
            return Ok(none.into_pyobject(py)?.into_any());
        };
        let [memory] = py.detach(|| sample_structure(motion, &times, |state| [&state.memory]));
        Ok(memory.into_pyobject(py)?.into_any())
    }

    /// The relative velocity of a contact of a structure at given times, in units of velocity: with
    /// all its digits also where the contact creeps (`RateState`), 0 in stick, nan outside of the
    /// motion.
    ///
    /// Args:
    ///     times: a number or an array, in units of time.
    ///     contact: its number.
    ///
    /// >>> from stick_slip import Contact, Coulomb, Structure
    /// >>> contact = Contact(0, Coulomb(0.4, 0.4), 10.0, belt_velocity=0.5)
    /// >>> motion = Structure([2.0]).with_contact(contact).simulate(([0.0], [0.0]), 1.0)
    /// >>> motion.sliding_velocity([0.125, 0.5])
    /// array([-0.25,  0.  ])
    #[pyo3(signature = (times, contact = Index(0)), text_signature = "($self, times, contact=0)")]
    fn sliding_velocity<'py>(
        &self,
        times: &Bound<'py, PyAny>,
        contact: Index,
    ) -> PyResult<Bound<'py, PyAny>> {
        let AnyMotion::Structure(motion, _) = &self.0 else {
            return Err(PyTypeError::new_err(
                "sliding velocities are those of a Structure: simulate system.structure()",
            ));
        };
        let contact = self.0.contact(contact)?;
        elementwise(times, |time| motion.sliding_velocity(contact, time))
    }

    /// The mode of a contact at a time: "stick", "slip" or "open"; None outside of the motion. At
    /// an event the mode after it.
    #[pyo3(signature = (time, contact = Index(0)), text_signature = "($self, time, contact=0)")]
    fn mode_at(&self, time: f64, contact: Index) -> PyResult<Option<&'static str>> {
        let mode = self.0.mode_at(self.0.contact(contact)?, time);
        Ok(mode.map(|mode| match mode {
            Mode::Stick => "stick",
            Mode::Slip(_) => "slip",
            Mode::Open => "open",
        }))
    }

    /// The mode of a contact at given times, as int8: 0 in stick, -1 and +1 in slip with negative
    /// and positive relative velocity, 2 if open, -128 outside of the motion.
    #[pyo3(signature = (times, contact = Index(0)), text_signature = "($self, times, contact=0)")]
    fn modes<'py>(
        &self,
        times: &Bound<'py, PyAny>,
        contact: Index,
    ) -> PyResult<Bound<'py, PyArray1<i8>>> {
        let times_ = times_of(times)?;
        let contact = self.0.contact(contact)?;
        let mode = |time: &f64| mode_number(self.0.mode_at(contact, *time));
        let modes: Array1<i8> = times_.iter().map(mode).collect();
        Ok(modes.into_pyarray(times.py()))
    }

    /// Samples of a structure at equal intervals with forces, loads and accelerations.
    ///
    /// Args:
    ///     interval: in units of time, > 0.
    ///
    /// >>> from stick_slip import Contact, Coulomb, Structure
    /// >>> block = (Structure([2.0]).with_ground_spring(0, 50.0)
    /// ...     .with_contact(Contact(0, Coulomb(0.4, 0.3), 20.0, belt_velocity=0.1)))
    /// >>> samples = block.simulate(([0.0], [0.0]), 2.0).samples(0.5)
    /// >>> samples.friction[:, 0]
    /// array([-6.        , -2.41647214, -4.91647214, -7.41647214, -6.        ])
    fn samples(&self, py: Python<'_>, interval: f64) -> PyResult<Py<PyAny>> {
        let (motion, structure) = self.of_structure("samples with forces")?;
        // The crate refuses other intervals.
        if interval > 0.0 {
            Count::checked(motion.duration() / interval, "samples")?;
        }
        let run = |waiting: &Waiting, _: &Options| {
            let samples = structure.samples(motion, interval)?;
            waiting.items(samples.map(Ok), 0, usize::MAX)
        };
        work(py, options(None, None, None), run, |found| {
            Ok(Py::new(py, Samples::of(found))?.into_any())
        })
    }

    /// Work and heat of every part of a structure over the motion.
    fn energy_budget(&self, py: Python<'_>) -> PyResult<EnergyBudget> {
        let (motion, structure) = self.of_structure("energies")?;
        py.detach(|| structure.energy_budget(motion))
            .or_raise()
            .map(EnergyBudget::from)
    }

    /// Draws displacements over time, with the times in stick marked. Needs matplotlib.
    ///
    /// Args:
    ///     ax: the axes to draw into; new ones if it is None.
    ///     coordinates: those to draw; all if it is None.
    ///     contact: whose stick is marked; None for no marks.
    ///     points: number of points of each curve.
    ///
    /// Returns:
    ///     The axes.
    #[pyo3(signature = (ax = None, *, coordinates = None, contact = Some(0), points = 2000))]
    fn plot<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<Bound<'py, PyAny>>,
        coordinates: Option<Vec<usize>>,
        contact: Option<usize>,
        points: usize,
    ) -> PyResult<Bound<'py, PyAny>> {
        let plots = slf.py().import("stick_slip._plot")?;
        plots.call_method1("motion", (slf, ax, coordinates, contact, points))
    }

    /// Draws velocity over displacement, with stick marked. Needs matplotlib.
    ///
    /// Args:
    ///     ax: the axes to draw into; new ones if it is None.
    ///     coordinate: the coordinate of a structure.
    ///     contact: whose stick is marked; None for no marks.
    ///     points: number of points of the curve.
    ///
    /// Returns:
    ///     The axes.
    #[pyo3(signature = (ax = None, *, coordinate = 0, contact = Some(0), points = 2000))]
    fn plot_phase<'py>(
        slf: &Bound<'py, Self>,
        ax: Option<Bound<'py, PyAny>>,
        coordinate: usize,
        contact: Option<usize>,
        points: usize,
    ) -> PyResult<Bound<'py, PyAny>> {
        let plots = slf.py().import("stick_slip._plot")?;
        plots.call_method1("phase", (slf, ax, coordinate, contact, points))
    }

    fn __repr__(&self) -> String {
        format!(
            "<Motion from {} to {}: {} events, ended by {}>",
            short(self.start_time()),
            short(self.end_time()),
            self.0.events().len(),
            self.ended()
        )
    }
}

impl PyMotion {
    /// The motion with its structure.
    fn of_structure(&self, what: &str) -> PyResult<(&Trajectory<structure::State>, &Structure)> {
        Err(PyTypeError::new_err(match &self.0 {
            AnyMotion::Structure(motion, Some(structure)) => return Ok((motion, structure)),
            AnyMotion::Structure(_, None) => format!(
                "the motions of a branch do not keep their systems, which {what} need: simulate \
                 family(point.parameter) from point.orbit.state; Orbit.energy is known"
            ),
            AnyMotion::Belt(_) => {
                format!("{what} are those of a Structure: simulate system.structure()")
            }
        }))
    }

    fn sample_one<'py>(&self, py: Python<'py>, time: f64) -> PyResult<Bound<'py, PyAny>> {
        match &self.0 {
            AnyMotion::Belt(motion) => {
                let state = motion.state_at(time);
                let pair = state.map_or((f64::NAN, f64::NAN), |it| (it.displacement, it.velocity));
                Ok(pair.into_pyobject(py)?.into_any())
            }
            AnyMotion::Structure(motion, _) => {
                let state = motion.state_at(time).unwrap_or_else(|| {
                    let nan = vec![f64::NAN; motion.last().displacements.len()];
                    structure::State::new(&nan, &nan)
                });
                let pair = (Numbers(state.displacements), Numbers(state.velocities));
                Ok(pair.into_pyobject(py)?.into_any())
            }
        }
    }
}

fn times_of(times: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    vector(times).ok_or_else(|| {
        PyTypeError::new_err("times are a number or a one-dimensional array of numbers")
    })
}

fn sample_belt(motion: &Trajectory, times: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let state = |time: &f64| {
        motion
            .state_at(*time)
            .map_or((f64::NAN, f64::NAN), |it| (it.displacement, it.velocity))
    };
    times.iter().map(state).unzip()
}

/// Some of the numbers of the state at each time.
fn sample_structure<const N: usize>(
    motion: &Trajectory<structure::State>,
    times: &[f64],
    of: impl Fn(&structure::State) -> [&Vec<f64>; N],
) -> [Table; N] {
    let last = motion.last();
    let mut tables = of(&last).map(|numbers| Table::with_rows(times.len(), numbers.len()));
    for time in times {
        match motion.state_at(*time) {
            Some(state) => {
                for (table, numbers) in tables.iter_mut().zip(of(&state)) {
                    table.push(numbers);
                }
            }
            None => tables.iter_mut().for_each(Table::push_nan),
        }
    }
    tables
}

record! {
    /// Samples of a structure at equal intervals: see `Motion.samples`. Each is an array whose
    /// first axis is the time.
    Samples {
        /// The times, in units of time.
        time: Numbers,
        /// Displacements, shape (n, coordinates).
        displacements: Table,
        /// Velocities, shape (n, coordinates).
        velocities: Table,
        /// Memory variables of the contacts, then first-order states, shape (n, variables).
        memory: Table,
        /// Accelerations, in units of velocity per time, shape (n, coordinates).
        accelerations: Table,
        /// The mode of each contact, shape (n, contacts), as numbers: see `Motion.modes`.
        modes: Table,
        /// The friction force of each contact, in units of force, shape (n, contacts).
        friction: Table,
        /// The normal load of each contact, in units of force, shape (n, contacts).
        loads: Table,
        /// The forces of the force elements, in units of force, one column for each direction.
        element_forces: Table,
        /// The force of each stop, in units of force, shape (n, stops).
        stop_forces: Table,
    }
    fn __len__(&self) -> usize {
        self.time.0.len()
    }
}

impl Samples {
    fn of(found: Vec<structure::Sample>) -> Self {
        let table = |of: &dyn Fn(&structure::Sample) -> Vec<f64>| {
            let mut table = Table::new(found.first().map_or(0, |sample| of(sample).len()));
            for sample in &found {
                table.push(&of(sample));
            }
            table
        };
        let number = |mode: &Mode| f64::from(mode_number(Some(*mode)));
        Self {
            time: Numbers(found.iter().map(|sample| sample.time).collect()),
            displacements: table(&|sample| sample.state.displacements.clone()),
            velocities: table(&|sample| sample.state.velocities.clone()),
            memory: table(&|sample| sample.state.memory.clone()),
            accelerations: table(&|sample| sample.accelerations.clone()),
            modes: table(&|sample| sample.modes.iter().map(number).collect()),
            friction: table(&|sample| sample.friction.clone()),
            loads: table(&|sample| sample.loads.clone()),
            element_forces: table(&|sample| sample.element_forces.concat()),
            stop_forces: table(&|sample| sample.stop_forces.clone()),
        }
    }
}

record! {
    /// Work and heat over a motion, in units of force times displacement. Entries of arrays belong
    /// to coordinates, contacts, force elements or stops.
    EnergyBudget {
        /// The energy at the end minus the energy at the start.
        stored: f64,
        /// Work of the force on each coordinate.
        force_work: Numbers,
        /// Work of the drive that moves the surface of each contact.
        drive_work: Numbers,
        /// Work of the friction of each contact on the coordinates.
        belt_work: Numbers,
        /// Heat in each contact.
        friction_loss: Numbers,
        /// Work of the moving base of each normal spring.
        normal_work: Numbers,
        /// Work of each force element beyond its potential.
        element_work: Numbers,
        /// Work of the forces of each first-order state.
        first_order_work: Numbers,
        /// Heat in each stop.
        stop_loss: Numbers,
        /// Heat in all dampers.
        damper_loss: f64,
        /// Work of the skew-symmetric part of the stiffness matrix.
        circulation: f64,
        /// Residual of the balance; rounding errors with the default tolerance.
        defect: f64,
    }
}

impl From<stick_slip::EnergyBudget> for EnergyBudget {
    fn from(energy: stick_slip::EnergyBudget) -> Self {
        Self {
            stored: energy.stored,
            force_work: Numbers(energy.force_work.clone()),
            drive_work: Numbers(energy.drive_work.clone()),
            belt_work: Numbers(energy.belt_work.clone()),
            friction_loss: Numbers(energy.friction_loss.clone()),
            normal_work: Numbers(energy.normal_work.clone()),
            element_work: Numbers(energy.element_work.clone()),
            first_order_work: Numbers(energy.first_order_work.clone()),
            stop_loss: Numbers(energy.stop_loss.clone()),
            damper_loss: energy.damper_loss,
            circulation: energy.circulation,
            defect: energy.defect(),
        }
    }
}

/// An error with which a motion ended: the exception carries the motion up to there.
pub fn ended_well(py: Python<'_>, motion: AnyMotion) -> PyResult<PyMotion> {
    let Ended::Error(error) = motion.ended() else {
        return Ok(PyMotion(motion));
    };
    let exception = raised(error.clone());
    exception
        .value(py)
        .setattr("found", PyMotion(motion).into_pyobject(py)?)?;
    Err(exception)
}

/// An element of a sequence of Python, counted from the end if the index is negative.
pub fn entry<T: Clone>(items: &[T], index: isize) -> PyResult<T> {
    let count = items.len() as isize;
    let place = if index < 0 { index + count } else { index };
    let item = usize::try_from(place)
        .ok()
        .and_then(|place| items.get(place));
    item.cloned()
        .ok_or_else(|| PyIndexError::new_err(format!("no element {index} of {count}")))
}

/// An iterator over items, as that of a list.
pub fn iterator<'py, T: IntoPyObject<'py>>(
    py: Python<'py>,
    items: Vec<T>,
) -> PyResult<Bound<'py, PyIterator>> {
    PyList::new(py, items)?.try_iter()
}
