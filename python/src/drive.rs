//! `Drive`: functions of time.

use std::sync::Arc;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use stick_slip::{Drive, Error};

use crate::convert::{Points, Table, elementwise, float};
use crate::error::OrRaise;
use crate::made::{Made, Reduced};
use crate::traced::{TracedTime, pieces_of};

/// One term of a drive.
#[derive(Clone)]
enum Term {
    Constant(f64),
    Harmonic(f64, f64, f64),
    Sine(f64, f64),
    Profile(Vec<(f64, f64)>),
    Function(TracedTime, Arc<Made>),
}

impl Term {
    fn add(&self, drive: Drive) -> Result<Drive, Error> {
        match self {
            Self::Constant(value) => drive.with_constant(*value),
            Self::Harmonic(amplitude, frequency, phase) => {
                drive.with_harmonic(*amplitude, *frequency, *phase)
            }
            Self::Sine(amplitude, frequency) => drive.with_sine(*amplitude, *frequency),
            Self::Profile(points) => drive.with_profile(points),
            Self::Function(function, _) => drive.with_function(function.clone()),
        }
    }

    fn made(&self, py: Python<'_>) -> PyResult<Arc<Made>> {
        let made = match self {
            Self::Constant(value) => Made::by(py, "Drive.constant", (*value,)),
            Self::Harmonic(amplitude, frequency, phase) => {
                Made::by(py, "Drive.harmonic", (*amplitude, *frequency))?.with(py, "phase", *phase)
            }
            Self::Sine(amplitude, frequency) => {
                Made::by(py, "Drive.sine", (*amplitude, *frequency))
            }
            Self::Profile(points) => Made::by(py, "Drive.profile", (Table::of_pairs(points),)),
            Self::Function(_, made) => return Ok(made.clone()),
        };
        made.map(Arc::new)
    }

    fn text(&self, py: Python<'_>) -> PyResult<String> {
        match self {
            Self::Constant(value) => Ok(float(*value)),
            term => term.made(py)?.text(py),
        }
    }
}

/// A function of time: a force, a load or the velocity of a belt. The sum of constants, harmonics,
/// profiles and functions of your own; wherever a drive is taken, a number is too.
///
/// >>> from stick_slip import Drive
/// >>> force = 2.0 + Drive.harmonic(0.5, 3.0)
/// >>> force(0.0)
/// 2.5
/// >>> force
/// Drive.harmonic(0.5, 3.0, phase=0.0) + 2.0
#[pyclass(frozen, name = "Drive", module = "stick_slip")]
pub struct PyDrive {
    pub drive: Drive,
    terms: Vec<Term>,
}

impl PyDrive {
    fn of(terms: Vec<Term>) -> PyResult<Self> {
        let drive = terms
            .iter()
            .try_fold(Drive::constant(0.0), |drive, term| term.add(drive));
        Ok(Self {
            drive: drive.or_raise()?,
            terms,
        })
    }
}

#[pymethods]
impl PyDrive {
    /// A constant, in the units of what is driven.
    #[staticmethod]
    fn constant(value: f64) -> PyResult<Self> {
        Self::of(vec![Term::Constant(value)])
    }

    /// amplitude * cos(omega * t + phase).
    ///
    /// Args:
    ///     amplitude: in the units of what is driven.
    ///     omega: the angular frequency, in radians per unit of time, > 0.
    ///     phase: in radians.
    #[staticmethod]
    #[pyo3(signature = (amplitude, omega, phase = 0.0))]
    fn harmonic(amplitude: f64, omega: f64, phase: f64) -> PyResult<Self> {
        Self::of(vec![Term::Harmonic(amplitude, omega, phase)])
    }

    /// amplitude * sin(omega * t), which is 0 at t = 0 to the bit.
    #[staticmethod]
    fn sine(amplitude: f64, omega: f64) -> PyResult<Self> {
        Self::of(vec![Term::Sine(amplitude, omega)])
    }

    /// Straight lines between points (time, value), constant before and after them. Two points of
    /// one time are a jump.
    ///
    /// >>> from stick_slip import Drive
    /// >>> Drive.profile([(1.0, 0.0), (2.0, 4.0)])([0.0, 1.5, 9.0])
    /// array([0., 2., 4.])
    #[staticmethod]
    fn profile(points: Points) -> PyResult<Self> {
        Self::of(vec![Term::Profile(points.0)])
    }

    /// A function of time of your own, such as a chirp or a shock: recorded like a `Law`.
    ///
    /// Args:
    ///     function: of the time; with breakpoints a list of functions, one for each piece.
    ///     size: the largest value, or an estimate of it.
    ///     timescale: the shortest time in which the function changes noticeably: 1/omega of a
    ///         harmonic, the width of a bump; inf for a polynomial.
    ///     breakpoints: the times, ascending, at which pieces meet.
    ///     period: if the function has one; times then count from the start of each period.
    ///
    /// >>> import numpy as np
    /// >>> from stick_slip import Drive
    /// >>> chirp = Drive.function(lambda t: np.cos(0.01 * t**2), size=1.0, timescale=0.5)
    /// >>> chirp(10.0) == np.cos(1.0)
    /// np.True_
    #[staticmethod]
    #[pyo3(signature = (function, *, size, timescale, breakpoints = Vec::new(), period = None))]
    fn function(
        py: Python<'_>,
        function: &Bound<'_, PyAny>,
        size: f64,
        timescale: f64,
        breakpoints: Vec<f64>,
        period: Option<f64>,
    ) -> PyResult<Self> {
        let (pieces, formulas) = pieces_of(py, function, breakpoints.len(), &["t"])?;
        let meet = (!breakpoints.is_empty()).then(|| breakpoints.clone());
        let made = Made::by(py, "Drive.function", (formulas,))?
            .with(py, "size", size)?
            .with(py, "timescale", timescale)?
            .with_given(py, "breakpoints", meet)?
            .with_given(py, "period", period)?;
        let function = TracedTime {
            pieces: pieces.into(),
            breakpoints: breakpoints.into(),
            size,
            timescale,
            period,
        };
        Self::of(vec![Term::Function(function, Arc::new(made))])
    }

    /// The value at a time, or at an array of times.
    fn __call__<'py>(&self, time: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        elementwise(time, |time| self.drive.value(time))
    }

    /// The derivative by time, after a kink or jump if at one.
    fn slope<'py>(&self, time: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        elementwise(time, |time| self.drive.slope(time))
    }

    /// The period, in units of time; None for a constant, a profile, or frequencies without a
    /// common period.
    #[getter]
    fn period(&self) -> Option<f64> {
        self.drive.period()
    }

    fn __add__(&self, other: DriveArgument<'_>) -> PyResult<Self> {
        let mut terms = self.terms.clone();
        match other {
            DriveArgument::Drive(other) => terms.extend_from_slice(&other.get().terms),
            DriveArgument::Number(value) => terms.push(Term::Constant(value)),
        }
        Self::of(terms)
    }

    fn __radd__(&self, other: f64) -> PyResult<Self> {
        self.__add__(DriveArgument::Number(other))
    }

    fn __repr__(&self, py: Python<'_>) -> PyResult<String> {
        let texts = self.terms.iter().map(|term| term.text(py));
        Ok(texts.collect::<PyResult<Vec<_>>>()?.join(" + "))
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> Reduced<'py> {
        let [first, rest @ ..] = &self.terms[..] else {
            return Made::by(py, "Drive.constant", (0.0,))?.reduced(py);
        };
        let mut made = first.made(py)?;
        for term in rest {
            let term = Self::of(vec![term.clone()])?;
            made = Arc::new(made.then(py, "__add__", (term,))?);
        }
        made.reduced(py)
    }
}

/// A drive, or a number for a constant one.
pub enum DriveArgument<'py> {
    Drive(Bound<'py, PyDrive>),
    Number(f64),
}

impl<'a, 'py> FromPyObject<'a, 'py> for DriveArgument<'py> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(drive) = object.cast::<PyDrive>() {
            return Ok(Self::Drive(drive.to_owned()));
        }
        object.extract().map(Self::Number).map_err(|_| {
            PyTypeError::new_err(
                "expected a number or a Drive, such as Drive.harmonic(1.0, 2.0); a function of \
                 time of your own is Drive.function(f, size=..., timescale=...)",
            )
        })
    }
}

impl DriveArgument<'_> {
    pub fn drive(&self) -> Drive {
        match self {
            Self::Drive(drive) => drive.get().drive.clone(),
            Self::Number(value) => Drive::constant(*value),
        }
    }
}

impl<'py> IntoPyObject<'py> for &DriveArgument<'py> {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Self::Output> {
        match self {
            DriveArgument::Drive(drive) => Ok(drive.clone().into_any()),
            DriveArgument::Number(value) => Ok(value.into_pyobject(py)?.into_any()),
        }
    }
}
