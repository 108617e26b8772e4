//! Dry friction laws: `Law`, and the distribution `Iwan4` of joints.

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use stick_slip::{
    AnyLaw, Contact, Coulomb, Drive, Error, Exponential, FrictionLaw, MassOnBelt, Physical,
    PhysicalMassOnBelt, Polynomial, Rational, Scaled, Stribeck, Tabulated,
};

use crate::any_belt::Belt;
use crate::convert::{Points, Table, elementwise, shown};
use crate::error::{OrRaise, in_python};
use crate::made::{Made, Reduced};
use crate::traced::{Traced, pieces_of};

/// Runs an expression with the law of any kind, so that each keeps the crate's own code.
macro_rules! with_law {
    ($kind:expr, $law:ident => $result:expr) => {
        match $kind {
            $crate::law::Kind::Plain($crate::law::Plain::Named($law)) => $result,
            $crate::law::Kind::Plain($crate::law::Plain::Traced($law)) => $result,
            $crate::law::Kind::Scaled($law) => $result,
        }
    };
}

/// The same with a law in the units of its user.
macro_rules! with_plain_law {
    ($plain:expr, $law:ident => $result:expr) => {
        match $plain {
            $crate::law::Plain::Named($law) => $result,
            $crate::law::Plain::Traced($law) => $result,
        }
    };
}
pub(crate) use with_plain_law;

/// A law in the units of its user.
#[derive(Clone)]
pub enum Plain {
    /// A law of the crate.
    Named(AnyLaw),
    /// A function of a user.
    Traced(Traced),
}

/// Where a law comes from.
#[derive(Clone)]
pub enum Kind {
    Plain(Plain),
    /// A law of the crate over dimensionless speeds. A function of a user needs no type for that.
    Scaled(Scaled<AnyLaw>),
}

impl Kind {
    pub fn belt(
        &self,
        belt_velocity: f64,
        damping: f64,
        load: f64,
    ) -> Result<std::sync::Arc<dyn Belt>, Error> {
        with_law!(self, law => {
            let system = MassOnBelt::new(law.clone(), belt_velocity)?;
            Ok(std::sync::Arc::new(system.with_damping(damping)?.with_load(load)?))
        })
    }

    pub fn physical(&self, physical: Physical) -> Result<std::sync::Arc<dyn Belt>, Error> {
        with_plain_law!(self.plain()?, law => {
            Ok(std::sync::Arc::new(PhysicalMassOnBelt::new(physical, law.clone())?))
        })
    }

    pub fn contact(&self, direction: &[(usize, f64)], load: Drive) -> Result<Contact, Error> {
        with_law!(self, law => Contact::along(direction, law.clone(), load))
    }

    /// The law for what takes no dimensionless speeds.
    pub fn plain(&self) -> Result<&Plain, Error> {
        match self {
            Self::Plain(law) => Ok(law),
            Self::Scaled(law) => Err(Error::InvalidParameter {
                of: "Scaled",
                name: "velocity_unit",
                value: law.velocity_unit(),
                allowed: "the law of a MassOnBelt or of a Contact; elsewhere give the law that it \
                          scales",
            }),
        }
    }

    fn scaled(&self, velocity_unit: f64) -> Result<Self, Error> {
        Ok(match self.plain()? {
            Plain::Named(law) => Self::Scaled(Scaled::new(law.clone(), velocity_unit)?),
            Plain::Traced(law) => {
                // Checks the unit.
                Scaled::new(law, velocity_unit)?;
                Self::Plain(Plain::Traced(law.scaled(velocity_unit)))
            }
        })
    }
}

/// A friction law without memory: the friction coefficient as a function of the sliding speed.
///
/// A law of your own is a function of the speed, written with +, -, *, /, ** and numpy's exp, log,
/// sqrt, tanh, arctan, sin, cos, abs, square and reciprocal. It is called once, with a symbol, and
/// recorded; the crate then differentiates it exactly. It must be analytic from speed 0 on.
///
/// Stick is exact, so give the coefficient of slip itself, without the regularization that solvers
/// of smooth equations need: 0.3, not 0.3 tanh(v/1e-3).
///
/// Args:
///     function: the kinetic coefficient as a function of the sliding speed (>= 0, in the units
///         of the system: dimensionless, or m/s). With breakpoints a list of functions, one for
///         each piece, from the lowest speeds on.
///     static: the static coefficient, at least the kinetic one at speed 0; dimensionless.
///     breakpoints: the speeds, ascending, at which the pieces meet.
///
/// Raises:
///     TypeError: if the function branches on the speed, compares it, or uses a function that
///         cannot be recorded.
///     ParameterError: if the static coefficient is below the kinetic one at speed 0.
///
/// >>> import numpy as np
/// >>> from stick_slip import Law
/// >>> law = Law(lambda s: 0.3 + 0.2 * np.exp(-s / 0.1), static=0.55)
/// >>> round(law.kinetic(0.1), 15)
/// 0.373575888234288
/// >>> law.slope(0.0)
/// -2.0
/// >>> flat = Law([lambda s: 0.4 - 0.1 * s, lambda s: 0.3 + 0 * s], static=0.4, breakpoints=[1.0])
/// >>> flat.kinetic([0.5, 2.0])
/// array([0.35, 0.3 ])
#[pyclass(frozen, name = "Law", module = "stick_slip")]
pub struct PyLaw {
    pub kind: Kind,
    made: Made,
}

impl PyLaw {
    fn named(py: Python<'_>, law: Result<impl Into<AnyLaw>, Error>) -> PyResult<Self> {
        let law = law.or_raise()?.into();
        Ok(Self {
            made: made(py, &law)?,
            kind: Kind::Plain(Plain::Named(law)),
        })
    }
}

#[pymethods]
impl PyLaw {
    #[new]
    #[pyo3(signature = (function, *, r#static, breakpoints = Vec::new()))]
    fn new(
        py: Python<'_>,
        function: &Bound<'_, PyAny>,
        r#static: f64,
        breakpoints: Vec<f64>,
    ) -> PyResult<Self> {
        let (pieces, formulas) = pieces_of(py, function, breakpoints.len(), &["s"])?;
        let meet = (!breakpoints.is_empty()).then(|| breakpoints.clone());
        let made = Made::by(py, "Law", (formulas,))?
            .with(py, "static", r#static)?
            .with_given(py, "breakpoints", meet)?;
        let law = Traced::new(r#static, pieces, breakpoints);
        law.check().or_raise()?;
        Ok(Self {
            kind: Kind::Plain(Plain::Traced(law)),
            made,
        })
    }

    /// The static coefficient, dimensionless: friction in stick is at most this times the load.
    #[getter]
    fn static_coefficient(&self) -> f64 {
        with_law!(&self.kind, law => law.static_coefficient())
    }

    /// The speeds at which pieces of the law meet.
    #[getter]
    fn breakpoints(&self) -> Vec<f64> {
        with_law!(&self.kind, law => law.breakpoints().collect())
    }

    /// The kinetic coefficient at sliding speeds >= 0; dimensionless.
    ///
    /// Args:
    ///     speed: a number or an array, in the units of the system.
    ///
    /// >>> from stick_slip import Polynomial
    /// >>> Polynomial(0.4, 0.25, 0.5).kinetic([0.0, 0.5])
    /// array([0.4 , 0.25])
    fn kinetic<'py>(&self, speed: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        with_law!(&self.kind, law => elementwise(speed, |speed| law.kinetic(speed)))
    }

    /// The derivative of the kinetic coefficient by the speed, above a breakpoint if at one.
    ///
    /// >>> from stick_slip import Polynomial
    /// >>> Polynomial(0.4, 0.25, 0.5).slope(0.0)
    /// -0.45000000000000007
    fn slope<'py>(&self, speed: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        with_law!(&self.kind, law => elementwise(speed, |speed| law.slope(speed)))
    }

    /// The friction coefficient with its sign at a relative velocity of any sign; 0 at 0.
    ///
    /// >>> from stick_slip import Coulomb
    /// >>> Coulomb(0.4, 0.25).coefficient(-1.0)
    /// -0.25
    fn coefficient<'py>(&self, velocity: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        with_law!(&self.kind, law => elementwise(velocity, |v| law.coefficient(v)))
    }

    /// The n-th derivative of the kinetic coefficient at a speed; nan for n > 30.
    ///
    /// >>> from stick_slip import Polynomial
    /// >>> round(Polynomial(0.4, 0.25, 0.5).derivative(3, 0.1), 14)
    /// 3.6
    fn derivative(&self, n: usize, speed: f64) -> f64 {
        with_law!(&self.kind, law => law.derivative(n, speed))
    }

    /// Looks for faults of the law between two speeds: jumps, kinks, values that are negative or
    /// not finite, narrow features. Returns their descriptions; an empty list if there are none.
    ///
    /// >>> import numpy as np
    /// >>> from stick_slip import Law
    /// >>> [kink] = Law(lambda s: 0.3 + 0.1 * np.abs(s - 1), static=0.5).check(0.0, 3.0)
    /// >>> kink.startswith("kink at speed 1.0")
    /// True
    fn check(&self, low: f64, high: f64) -> PyResult<Vec<String>> {
        let faults = with_law!(&self.kind, law => stick_slip::check_law(law, low..high));
        Ok(faults.or_raise()?.iter().map(in_python).collect())
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        self.made.text(py)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Reduced<'py> {
        self.made.reduced(py)
    }
}

/// A dry law as an argument.
pub struct LawArgument<'py>(pub Bound<'py, PyLaw>);

impl<'a, 'py> FromPyObject<'a, 'py> for LawArgument<'py> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        object.cast::<PyLaw>().map(|law| Self(law.to_owned())).map_err(|_| {
            PyTypeError::new_err(format!(
                "expected a friction law, not {}: Coulomb(0.4, 0.3) and the like, or a function of \
                 your own as Law(function, static=0.4); a ContactLaw is for contacts only",
                shown(&object)
            ))
        })
    }
}

/// How a law of the crate is made.
fn made(py: Python<'_>, law: &AnyLaw) -> PyResult<Made> {
    match law {
        AnyLaw::Coulomb(law) => {
            let numbers = (law.static_coefficient(), law.kinetic_coefficient());
            Made::by(py, "Coulomb", numbers)
        }
        AnyLaw::Exponential(law) => {
            let numbers = (
                law.static_coefficient(),
                law.kinetic_coefficient(),
                law.stribeck_velocity(),
            );
            Made::by(py, "Exponential", numbers)
        }
        AnyLaw::Polynomial(law) => {
            let numbers = (
                law.static_coefficient(),
                law.minimum_coefficient(),
                law.minimum_velocity(),
            );
            Made::by(py, "Polynomial", numbers)
        }
        AnyLaw::Rational(law) => Made::by(py, "Rational", (law.static_coefficient(), law.decay()))?
            .with(py, "offset", law.offset())?
            .with(py, "quadratic", law.quadratic()),
        AnyLaw::Stribeck(law) => {
            let numbers = (
                law.static_coefficient(),
                law.coulomb_coefficient(),
                law.stribeck_velocity(),
                law.exponent(),
            );
            let viscous = law.viscous_coefficient();
            Made::by(py, "Stribeck", numbers)?.with(py, "viscous_coefficient", viscous)
        }
        AnyLaw::Tabulated(law) => {
            let straight = law.is_piecewise_linear().then_some(true);
            Made::by(py, "Tabulated", (Table::of_pairs(law.points()),))?
                .with(py, "static_coefficient", law.static_coefficient())?
                .with_given(py, "piecewise_linear", straight)
        }
        _ => Err(PyTypeError::new_err("this law is not known here")),
    }
}

/// A constant kinetic coefficient: Coulomb's law with a static coefficient of its own.
///
/// Args:
///     static_coefficient: dimensionless, >= kinetic_coefficient.
///     kinetic_coefficient: dimensionless, >= 0.
///
/// >>> from stick_slip import Coulomb
/// >>> Coulomb(0.4, 0.25)
/// Coulomb(0.4, 0.25)
#[pyfunction(name = "Coulomb")]
pub fn coulomb(
    py: Python<'_>,
    static_coefficient: f64,
    kinetic_coefficient: f64,
) -> PyResult<PyLaw> {
    PyLaw::named(py, Coulomb::new(static_coefficient, kinetic_coefficient))
}

/// The Gaussian Stribeck law mu_k + (mu_s - mu_k) exp(-(s/v_s)^2).
///
/// Args:
///     static_coefficient: mu_s, dimensionless, also the kinetic coefficient at speed 0.
///     kinetic_coefficient: mu_k, dimensionless, at large speeds.
///     stribeck_velocity: v_s, in units of velocity, > 0.
///
/// >>> from stick_slip import Exponential
/// >>> round(Exponential(0.4, 0.25, 0.5).kinetic(0.5), 15)
/// 0.305181916175716
#[pyfunction(name = "Exponential")]
pub fn exponential(
    py: Python<'_>,
    static_coefficient: f64,
    kinetic_coefficient: f64,
    stribeck_velocity: f64,
) -> PyResult<PyLaw> {
    let law = Exponential::new(static_coefficient, kinetic_coefficient, stribeck_velocity);
    PyLaw::named(py, law)
}

/// The cubic law, with its least coefficient at one speed.
///
/// Args:
///     static_coefficient: dimensionless, also the kinetic coefficient at speed 0.
///     minimum_coefficient: the least kinetic coefficient, dimensionless.
///     minimum_velocity: its speed, in units of velocity, > 0.
///
/// >>> from stick_slip import Polynomial
/// >>> Polynomial(0.4, 0.25, 0.5).kinetic(0.5)
/// 0.25
#[pyfunction(name = "Polynomial")]
pub fn polynomial(
    py: Python<'_>,
    static_coefficient: f64,
    minimum_coefficient: f64,
    minimum_velocity: f64,
) -> PyResult<PyLaw> {
    let law = Polynomial::new(static_coefficient, minimum_coefficient, minimum_velocity);
    PyLaw::named(py, law)
}

/// The hyperbolic law (mu_s - c)/(1 + decay s) + c + quadratic s^2.
///
/// Args:
///     static_coefficient: mu_s, dimensionless.
///     decay: per unit of velocity, >= 0.
///     offset: c, dimensionless.
///     quadratic: per unit of velocity squared, >= 0.
///
/// >>> from stick_slip import Rational
/// >>> Rational(1.0, 3.0).kinetic(1.0)
/// 0.25
#[pyfunction(name = "Rational")]
#[pyo3(signature = (static_coefficient, decay, offset = 0.0, quadratic = 0.0))]
pub fn rational(
    py: Python<'_>,
    static_coefficient: f64,
    decay: f64,
    offset: f64,
    quadratic: f64,
) -> PyResult<PyLaw> {
    let law = Rational::new(static_coefficient, decay)
        .and_then(|law| law.with_offset(offset)?.with_quadratic(quadratic));
    PyLaw::named(py, law)
}

/// The Stribeck law mu_c + (mu_s - mu_c) exp(-(s/v_s)^n) + viscous s.
///
/// Args:
///     static_coefficient: mu_s, dimensionless.
///     coulomb_coefficient: mu_c, dimensionless, at large speeds.
///     stribeck_velocity: v_s, in units of velocity, > 0.
///     exponent: n, an integer >= 1.
///     viscous_coefficient: per unit of velocity, >= 0.
///
/// >>> from stick_slip import Stribeck
/// >>> Stribeck(0.4, 0.25, 0.5, 1).kinetic(0.0)
/// 0.4
#[pyfunction(name = "Stribeck")]
#[pyo3(signature = (
    static_coefficient,
    coulomb_coefficient,
    stribeck_velocity,
    exponent,
    viscous_coefficient = 0.0
))]
pub fn stribeck(
    py: Python<'_>,
    static_coefficient: f64,
    coulomb_coefficient: f64,
    stribeck_velocity: f64,
    exponent: u32,
    viscous_coefficient: f64,
) -> PyResult<PyLaw> {
    let law = Stribeck::new(
        static_coefficient,
        coulomb_coefficient,
        stribeck_velocity,
        exponent,
    )
    .and_then(|law| law.with_viscous_coefficient(viscous_coefficient));
    PyLaw::named(py, law)
}

/// Measured points, joined by monotone cubic pieces, or by straight lines.
///
/// Args:
///     points: pairs (speed, coefficient) with ascending speeds, the first one 0; or an array of
///         two columns.
///     static_coefficient: dimensionless; the coefficient of the first point if it is None.
///     piecewise_linear: join the points by straight lines.
///
/// >>> from stick_slip import Tabulated
/// >>> law = Tabulated([(0.0, 0.4), (0.5, 0.3), (1.0, 0.25)], static_coefficient=0.45)
/// >>> law.kinetic(0.5), law.static_coefficient
/// (0.3, 0.45)
#[pyfunction(name = "Tabulated")]
#[pyo3(signature = (points, static_coefficient = None, piecewise_linear = false))]
pub fn tabulated(
    py: Python<'_>,
    points: Points,
    static_coefficient: Option<f64>,
    piecewise_linear: bool,
) -> PyResult<PyLaw> {
    let Points(points) = points;
    let law = if piecewise_linear {
        Tabulated::piecewise_linear(points)
    } else {
        Tabulated::new(points)
    };
    let law = law.and_then(|law| match static_coefficient {
        Some(coefficient) => law.with_static_coefficient(coefficient),
        None => Ok(law),
    });
    PyLaw::named(py, law)
}

/// A law over dimensionless speeds, mu(velocity_unit s): that of a brake's `dimensionless`.
///
/// Args:
///     law: over speeds in units of velocity.
///     velocity_unit: the speed that corresponds to the dimensionless speed 1, > 0.
///
/// >>> from stick_slip import Polynomial, Scaled
/// >>> law = Scaled(Polynomial(0.4, 0.25, 0.5), 2.0)
/// >>> law.kinetic(0.25)
/// 0.25
#[pyfunction(name = "Scaled")]
pub fn scaled(py: Python<'_>, law: LawArgument<'_>, velocity_unit: f64) -> PyResult<PyLaw> {
    let kind = law.0.get().kind.scaled(velocity_unit).or_raise()?;
    let made = Made::by(py, "Scaled", (law.0, velocity_unit))?;
    Ok(PyLaw { kind, made })
}

/// Segalman's distribution of springs and sliders (four-parameter Iwan model), for
/// `Contact.in_parallel`.
///
/// Args:
///     slip_force: at which the whole joint slides, in units of force.
///     stiffness: of the joint at small forces, force per displacement.
///     exponent: chi, between -1 and 0 (not included).
///     ratio: beta >= 0, of the elements that slide at the same displacement.
///
/// >>> from stick_slip import Iwan4
/// >>> joint = Iwan4(100.0, 1e6, -0.5, 0.3)
/// >>> len(joint.elements(20, 0.8))
/// 21
#[pyclass(frozen, module = "stick_slip")]
pub struct Iwan4(pub stick_slip::Iwan4);

#[pymethods]
impl Iwan4 {
    #[new]
    fn new(slip_force: f64, stiffness: f64, exponent: f64, ratio: f64) -> PyResult<Self> {
        stick_slip::Iwan4::new(slip_force, stiffness, exponent, ratio)
            .or_raise()
            .map(Self)
    }

    /// The force at which the whole joint slides, in units of force.
    #[getter]
    fn slip_force(&self) -> f64 {
        self.0.slip_force()
    }

    /// Stiffness at small forces, force per displacement.
    #[getter]
    fn stiffness(&self) -> f64 {
        self.0.stiffness()
    }

    /// The exponent chi of the distribution.
    #[getter]
    fn exponent(&self) -> f64 {
        self.0.exponent()
    }

    /// The ratio beta.
    #[getter]
    fn ratio(&self) -> f64 {
        self.0.ratio()
    }

    /// The displacement at which the last elements slide, in units of displacement.
    #[getter]
    fn largest_break_free(&self) -> f64 {
        self.0.largest_break_free()
    }

    /// The force at first loading to a displacement; a number or an array.
    fn backbone<'py>(&self, displacement: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        elementwise(displacement, |x| self.0.backbone(x))
    }

    /// The heat of a cycle of an amplitude, force times displacement; a number or an array.
    fn dissipation<'py>(&self, amplitude: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        elementwise(amplitude, |x| self.0.dissipation(x))
    }

    /// Elements as pairs (stiffness, limit), for `Contact.in_parallel`: n of widths that grow by
    /// 1/grid from one to the next (0 < grid < 1), and one more if ratio > 0.
    fn elements(&self, n: usize, grid: f64) -> PyResult<Vec<(f64, f64)>> {
        self.0.elements(n, grid).or_raise()
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        self.made(py)?.text(py)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Reduced<'py> {
        self.made(py)?.reduced(py)
    }
}

impl Iwan4 {
    fn made(&self, py: Python<'_>) -> PyResult<Made> {
        let Self(joint) = self;
        let numbers = (
            joint.slip_force(),
            joint.stiffness(),
            joint.exponent(),
            joint.ratio(),
        );
        Made::by(py, "Iwan4", numbers)
    }
}
