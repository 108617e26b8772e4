//! Laws of force, and elements that place them in a structure.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use stick_slip::{Error, ForceElement, ForceLaw};

use crate::convert::{Direction, Numbers, Points, direction_text, float, shown};
use crate::drive::DriveArgument;
use crate::error::OrRaise;
use crate::traced::{TracedForce, pieces_of};

/// A law of force, for a `ForceElement`, the load of a `Contact` or the input of a `FirstOrder`:
/// `PolynomialSpring`, `Backlash`, `Pendulum`, `SnapThrough`, `VanDerPol`, `TabulatedForce`, or a
/// function of your own, recorded like a `Law`.
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
    pub force: Force,
    text: String,
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

impl PyForceLaw {
    /// How the law was made.
    pub fn text(&self) -> &str {
        &self.text
    }
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
            force: Force::Traced(law),
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
        with_force!(&self.force, law => {
            let piece = law.breakpoints().take_while(|point| *point <= position).count();
            law.force(position, velocity, piece)
        })
    }

    fn __repr__(&self) -> &str {
        &self.text
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

fn force(law: Result<Force, Error>, text: String) -> PyResult<PyForceLaw> {
    Ok(PyForceLaw {
        force: law.or_raise()?,
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
    pub element: ForceElement,
    text: String,
}

#[pymethods]
impl PyForceElement {
    #[new]
    #[pyo3(signature = (direction, law, *, factor = None))]
    fn new(
        direction: Direction,
        law: ForceLawArgument<'_>,
        factor: Option<DriveArgument<'_>>,
    ) -> PyResult<Self> {
        let law = law.0.get();
        let element = with_force!(law.force.clone(), law => ForceElement::along(&direction.0, law));
        let mut element = element.or_raise()?;
        let mut text = format!("{}, {}", direction_text(&direction.0), law.text);
        if let Some(factor) = factor {
            text += &format!(", factor={}", factor.text());
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
