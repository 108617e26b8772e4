//! `Stop`: springs with dampers behind a gap.

use std::collections::BTreeMap;

use pyo3::prelude::*;
use stick_slip::{Error, Stop};

use crate::convert::{Direction, Index};
use crate::error::OrRaise;
use crate::made::{Made, Reduced};

/// A stop with a gap: a buffer, the teeth of a loose gear, a wall of rubber. It is a spring with a
/// damper that acts only while the gap is closed.
///
/// The gap is g = gap + d.q, the depth -g. While the depth is positive, the force +d F acts on the
/// coordinates, with F = stiffness * depth + damping * depth', but never below 0. An adhesive stop
/// pulls until the depth is 0.
///
/// `Stop.above`, `Stop.below` and `Stop.between` make the usual directions; both sides of a play
/// are two stops. Events are "close" and "open", with the number of the stop. Rigid impacts are not
/// available: a mass m rebounds with the restitution exp(-2 z acos(z)/sqrt(1 - z^2)), where z =
/// damping/(2 sqrt(stiffness m)) < 1, so take a stiff stop with that damping.
///
/// Args:
///     direction: d, along which the gap widens. A coordinate, a dict {coordinate: coefficient} or
///         pairs; dimensionless.
///     gap: at q = 0, in units of displacement; of any sign.
///     stiffness: of the closed stop, force per displacement, > 0.
///     damping: of the closed stop, force per velocity, >= 0.
///     adhesive: True if the stop pulls at the end of a contact.
///
/// >>> import math
/// >>> from stick_slip import Stop, Structure
/// >>> stop = Stop.above(0, 1.0, stiffness=1e4, damping=60.0)
/// >>> stop
/// Stop({0: -1.0}, 1.0, stiffness=10000.0, damping=60.0)
/// >>> motion = Structure([1.0]).with_stop(stop).simulate(([0.0], [1.0]), 2.0)
/// >>> motion.events[["time", "stop", "kind"]][0]
/// np.void((1.0, 0, 'close'), dtype=...)
/// >>> q, v = motion.last
/// >>> restitution = math.exp(-0.6 * math.acos(0.3) / math.sqrt(1 - 0.3**2))
/// >>> bool(abs(v[0] + restitution) < 1e-14)
/// True
#[pyclass(frozen, name = "Stop", module = "stick_slip")]
pub struct PyStop {
    pub stop: Stop,
}

impl PyStop {
    fn of(
        stop: Result<Stop, Error>,
        stiffness: f64,
        damping: f64,
        adhesive: bool,
    ) -> PyResult<Self> {
        let stop = stop
            .and_then(|stop| stop.with_contact_stiffness(stiffness, damping))
            .or_raise()?;
        Ok(Self {
            stop: if adhesive { stop.adhesive() } else { stop },
        })
    }

    fn made(&self, py: Python<'_>) -> PyResult<Made> {
        let adhesive = self.stop.is_adhesive().then_some(true);
        let direction = Direction(self.stop.direction().to_vec());
        Made::by(py, "Stop", (&direction, self.stop.gap()))?
            .with(py, "stiffness", self.stiffness())?
            .with(py, "damping", self.damping())?
            .with_given(py, "adhesive", adhesive)
    }
}

/// Stops of this package are not rigid, so that it is unused.
const RESTITUTION: f64 = 0.0;

#[pymethods]
impl PyStop {
    #[new]
    #[pyo3(signature = (direction, gap, *, stiffness, damping = 0.0, adhesive = false))]
    fn new(
        direction: Direction,
        gap: f64,
        stiffness: f64,
        damping: f64,
        adhesive: bool,
    ) -> PyResult<Self> {
        let stop = Stop::along(&direction.0, gap, RESTITUTION);
        Self::of(stop, stiffness, damping, adhesive)
    }

    /// A stop that keeps coordinate i below a position, in units of displacement.
    #[staticmethod]
    #[pyo3(signature = (i, position, *, stiffness, damping = 0.0, adhesive = false))]
    fn above(
        i: Index,
        position: f64,
        stiffness: f64,
        damping: f64,
        adhesive: bool,
    ) -> PyResult<Self> {
        let stop = Stop::above(i.0, position, RESTITUTION);
        Self::of(stop, stiffness, damping, adhesive)
    }

    /// A stop that keeps coordinate i above a position, in units of displacement.
    #[staticmethod]
    #[pyo3(signature = (i, position, *, stiffness, damping = 0.0, adhesive = false))]
    fn below(
        i: Index,
        position: f64,
        stiffness: f64,
        damping: f64,
        adhesive: bool,
    ) -> PyResult<Self> {
        let stop = Stop::below(i.0, position, RESTITUTION);
        Self::of(stop, stiffness, damping, adhesive)
    }

    /// A stop where coordinate i hits coordinate j from below: the gap is gap + q_j - q_i.
    ///
    /// A gear with a play of 0.02 to either side of another one, along the line of action:
    ///
    /// >>> from stick_slip import Stop
    /// >>> flanks = [Stop.between(i, 1 - i, 0.02, stiffness=1e6, damping=50.0) for i in (0, 1)]
    #[staticmethod]
    #[pyo3(signature = (i, j, gap, *, stiffness, damping = 0.0, adhesive = false))]
    fn between(
        i: Index,
        j: Index,
        gap: f64,
        stiffness: f64,
        damping: f64,
        adhesive: bool,
    ) -> PyResult<Self> {
        let stop = Stop::between(i.0, j.0, gap, RESTITUTION);
        Self::of(stop, stiffness, damping, adhesive)
    }

    /// The direction d, a dict {coordinate: coefficient}.
    #[getter]
    fn direction(&self) -> BTreeMap<usize, f64> {
        self.stop.direction().iter().copied().collect()
    }

    /// The gap at q = 0, in units of displacement.
    #[getter]
    fn gap(&self) -> f64 {
        self.stop.gap()
    }

    /// The stiffness of the closed stop, force per displacement.
    #[getter]
    fn stiffness(&self) -> f64 {
        self.stop.contact_stiffness().unwrap_or_default().0
    }

    /// The damping of the closed stop, force per velocity.
    #[getter]
    fn damping(&self) -> f64 {
        self.stop.contact_stiffness().unwrap_or_default().1
    }

    /// True if the stop pulls at the end of a contact.
    #[getter]
    fn is_adhesive(&self) -> bool {
        self.stop.is_adhesive()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        self.made(py)?.text(py)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Reduced<'py> {
        self.made(py)?.reduced(py)
    }
}
