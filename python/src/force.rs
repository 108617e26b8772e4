//! Laws of force, and elements that place them in a structure.

use std::collections::BTreeMap;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use stick_slip::{Error, ForceElement, ForceLaw};

use crate::convert::{Direction, Numbers, Points, Table, shown};
use crate::drive::DriveArgument;
use crate::error::OrRaise;
use crate::made::{Made, Reduced};
use crate::traced::{Field, TracedForce, pieces_of};

/// A law of force, for a `ForceElement`, the load of a `Contact` or the input of a `FirstOrder`:
/// `PolynomialSpring`, `Backlash`, `Pendulum`, `SnapThrough`, `VanDerPol`, `TabulatedForce`, or a
/// function of your own, recorded like a `Law`.
///
/// Args:
///     function: the force, a function of position and velocity along the element; with breakpoints
///         a list of functions, one for each piece, which must meet.
///     breakpoints: the positions, ascending, at which pieces meet.
///     potential: a function of the position whose slope is the force at rest, in units of energy;
///         a list with breakpoints. With it the work of the force is a difference, exact to
///         rounding, and part of the energy of the structure.
///
/// >>> from stick_slip import ForceLaw
/// >>> ForceLaw(lambda x, v: x + 0.2 * v**3).force(1.0, 2.0)
/// 2.6
#[pyclass(frozen, name = "ForceLaw", module = "stick_slip")]
pub struct PyForceLaw {
    pub force: Force,
    made: Made,
}

/// A law of force of any kind.
#[derive(Clone)]
pub enum Force {
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
            $crate::force::Force::PolynomialSpring($law) => $result,
            $crate::force::Force::Backlash($law) => $result,
            $crate::force::Force::Pendulum($law) => $result,
            $crate::force::Force::SnapThrough($law) => $result,
            $crate::force::Force::VanDerPol($law) => $result,
            $crate::force::Force::Tabulated($law) => $result,
            $crate::force::Force::Traced($law) => $result,
        }
    };
}
pub(crate) use with_force;

#[pymethods]
impl PyForceLaw {
    #[new]
    #[pyo3(signature = (function, *, breakpoints = Vec::new(), potential = None))]
    fn new(
        py: Python<'_>,
        function: &Bound<'_, PyAny>,
        breakpoints: Vec<f64>,
        potential: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let count = breakpoints.len();
        let (pieces, formulas) = pieces_of(py, function, count, &["x", "v"])?;
        let potential = potential.map(|potential| pieces_of(py, potential, count, &["x"]));
        let (potential, energies) = potential.transpose()?.unzip();
        let meet = (count > 0).then(|| breakpoints.clone());
        let made = Made::by(py, "ForceLaw", (formulas,))?
            .with_given(py, "breakpoints", meet)?
            .with_given(py, "potential", energies)?;
        let law = TracedForce {
            pieces: pieces.into(),
            potential: potential.map(Into::into),
            breakpoints: breakpoints.into(),
        };
        // Checks what every element checks of its law.
        ForceElement::new(0, law.clone()).or_raise()?;
        Ok(Self {
            force: Force::Traced(law),
            made,
        })
    }

    /// The force at a position and a velocity along the element, in units of force.
    ///
    /// >>> from stick_slip import PolynomialSpring
    /// >>> PolynomialSpring([1.0, 0.0, 0.7]).force(2.0)
    /// 7.6
    #[pyo3(signature = (position, velocity = 0.0))]
    fn force(&self, position: f64, velocity: f64) -> f64 {
        with_force!(&self.force, law => {
            let piece = law.breakpoints().take_while(|point| *point <= position).count();
            law.force(position, velocity, piece)
        })
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        self.made.text(py)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Reduced<'py> {
        self.made.reduced(py)
    }
}

/// A law of force as an argument.
pub struct ForceLawArgument<'py>(pub Bound<'py, PyForceLaw>);

impl<'a, 'py> FromPyObject<'a, 'py> for ForceLawArgument<'py> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let law = object.cast::<PyForceLaw>();
        law.map(|law| Self(law.to_owned())).map_err(|_| {
            PyTypeError::new_err(format!(
                "expected a law of force, not {}: PolynomialSpring([1.0]) and the like, or a \
                 function of your own as ForceLaw(function)",
                shown(&object)
            ))
        })
    }
}

fn force(law: Result<Force, Error>, made: PyResult<Made>) -> PyResult<PyForceLaw> {
    Ok(PyForceLaw {
        force: law.or_raise()?,
        made: made?,
    })
}

/// A spring with the force c_0 x + c_1 x^2 + c_2 x^3 + ...; [k, 0, k3] is Duffing's.
///
/// Args:
///     coefficients: force per displacement, per displacement squared, and so on.
#[pyfunction(name = "PolynomialSpring")]
pub fn polynomial_spring(py: Python<'_>, coefficients: Numbers) -> PyResult<PyForceLaw> {
    let law = stick_slip::PolynomialSpring::new(&coefficients.0).map(Force::PolynomialSpring);
    force(law, Made::by(py, "PolynomialSpring", (coefficients,)))
}

/// A spring with play: no force while |x| <= gap.
///
/// Args:
///     stiffness: force per displacement beyond the gap, of any sign.
///     gap: in units of displacement, >= 0.
#[pyfunction(name = "Backlash")]
pub fn backlash(py: Python<'_>, stiffness: f64, gap: f64) -> PyResult<PyForceLaw> {
    let law = stick_slip::Backlash::new(stiffness, gap).map(Force::Backlash);
    force(law, Made::by(py, "Backlash", (stiffness, gap)))
}

/// A pendulum with its pivot at rest: the force moment sin(x/length).
///
/// Args:
///     moment: the weight, in units of force.
///     length: of the pendulum, in units of displacement; 1 for angles.
#[pyfunction(name = "Pendulum")]
pub fn pendulum(py: Python<'_>, moment: f64, length: f64) -> PyResult<PyForceLaw> {
    let law = stick_slip::Pendulum::new(moment, length).map(Force::Pendulum);
    force(law, Made::by(py, "Pendulum", (moment, length)))
}

/// An oblique spring that snaps through.
///
/// Args:
///     stiffness: force per displacement.
///     free_length: in units of displacement.
///     span: its horizontal distance, in units of displacement.
#[pyfunction(name = "SnapThrough")]
pub fn snap_through(
    py: Python<'_>,
    stiffness: f64,
    free_length: f64,
    span: f64,
) -> PyResult<PyForceLaw> {
    let law = stick_slip::SnapThrough::new(stiffness, free_length, span).map(Force::SnapThrough);
    force(
        law,
        Made::by(py, "SnapThrough", (stiffness, free_length, span)),
    )
}

/// Van der Pol's damper: the force (-negative + nonlinear x^2) y.
///
/// Args:
///     negative_damping: force per velocity.
///     nonlinear_damping: force per velocity and displacement squared.
#[pyfunction(name = "VanDerPol")]
pub fn van_der_pol(
    py: Python<'_>,
    negative_damping: f64,
    nonlinear_damping: f64,
) -> PyResult<PyForceLaw> {
    let law = stick_slip::VanDerPol::new(negative_damping, nonlinear_damping);
    let made = Made::by(py, "VanDerPol", (negative_damping, nonlinear_damping));
    force(law.map(Force::VanDerPol), made)
}

/// Measured points (position, force), joined by monotone cubic pieces or straight lines.
///
/// Args:
///     points: pairs with ascending positions, or an array of two columns.
///     piecewise_linear: join the points by straight lines.
#[pyfunction(name = "TabulatedForce")]
#[pyo3(signature = (points, piecewise_linear = false))]
pub fn tabulated_force(
    py: Python<'_>,
    points: Points,
    piecewise_linear: bool,
) -> PyResult<PyForceLaw> {
    let law = if piecewise_linear {
        stick_slip::TabulatedForce::piecewise_linear(&points.0)
    } else {
        stick_slip::TabulatedForce::new(&points.0)
    };
    let straight = piecewise_linear.then_some(true);
    let made = Made::by(py, "TabulatedForce", (Table::of_pairs(&points.0),))
        .and_then(|made| made.with_given(py, "piecewise_linear", straight));
    force(law.map(Force::Tabulated), made)
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
    pub element: ForceElement,
    made: Made,
}

impl PyForceElement {
    fn of(
        py: Python<'_>,
        element: Result<ForceElement, Error>,
        made: Made,
        factor: Option<DriveArgument<'_>>,
    ) -> PyResult<Self> {
        let mut element = element.or_raise()?;
        let made = made.with_given(py, "factor", factor.as_ref())?;
        if let Some(factor) = factor {
            element = element.with_factor(factor.drive()).or_raise()?;
        }
        Ok(Self { element, made })
    }
}

#[pymethods]
impl PyForceElement {
    #[new]
    #[pyo3(signature = (direction, law, *, factor = None))]
    fn new(
        py: Python<'_>,
        direction: Direction,
        law: ForceLawArgument<'_>,
        factor: Option<DriveArgument<'_>>,
    ) -> PyResult<Self> {
        let kind = law.0.get().force.clone();
        let element = with_force!(kind, law => ForceElement::along(&direction.0, law));
        let made = Made::by(py, "ForceElement", (&direction, law.0))?;
        Self::of(py, element, made, factor)
    }

    /// Forces that depend on positions and velocities along several directions: a coupled spring,
    /// a nonlinear controller, a force of one coordinate that acts on another.
    ///
    /// The force on the structure is -sum of a_i F_i(x, v), with x_i = a_i.q and v_i = a_i.q'.
    ///
    /// Args:
    ///     directions: two, three or four directions a_i, each as in `ForceElement`.
    ///     forces: a function of (x, v), two tuples with an entry for each direction, that returns
    ///         the force F_i for each; recorded once, like a `Law`. Without branches.
    ///     potential: a function of x with the slopes F_i(x, 0), in units of energy; with it the
    ///         work of the forces is a difference, exact to rounding.
    ///     factor: by which the forces are multiplied: a number or a Drive.
    ///
    /// A spring that stretches in the plane, on which a mass whirls in a circle of radius 1 with
    /// the angular frequency sqrt(4):
    ///
    /// >>> import math
    /// >>> from stick_slip import ForceElement, Structure
    /// >>> def forces(x, v):
    /// ...     stiffness = 4.0 * (x[0] ** 2 + x[1] ** 2)
    /// ...     return stiffness * x[0], stiffness * x[1]
    /// >>> spring = ForceElement.field(
    /// ...     [0, 1], forces, potential=lambda x: (x[0] ** 2 + x[1] ** 2) ** 2)
    /// >>> rotor = Structure([1.0, 1.0]).with_element(spring)
    /// >>> q, v = rotor.simulate(([1.0, 0.0], [0.0, 2.0]), math.pi).last
    /// >>> bool(abs(q[0] - 1.0) < 1e-14 and abs(q[1]) < 1e-14)
    /// True
    #[staticmethod]
    #[pyo3(signature = (directions, forces, *, potential = None, factor = None))]
    fn field(
        py: Python<'_>,
        directions: Vec<Direction>,
        forces: &Bound<'_, PyAny>,
        potential: Option<&Bound<'_, PyAny>>,
        factor: Option<DriveArgument<'_>>,
    ) -> PyResult<Self> {
        let along: Vec<&[(usize, f64)]> = directions.iter().map(|it| &it.0[..]).collect();
        let field = Field::of(along.len(), forces, potential)?;
        let element = field.element(&along);
        let directions: Vec<&Direction> = directions.iter().collect();
        let made = Made::by(py, "ForceElement.field", (directions, field.formulas))?.with_given(
            py,
            "potential",
            field.energy,
        )?;
        Self::of(py, element, made, factor)
    }

    /// The directions, a dict {coordinate: coefficient} for each.
    #[getter]
    fn directions(&self) -> Vec<BTreeMap<usize, f64>> {
        let directions = self.element.directions().iter();
        directions.map(|it| it.iter().copied().collect()).collect()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        self.made.text(py)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Reduced<'py> {
        self.made.reduced(py)
    }
}
