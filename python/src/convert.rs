//! Arguments and results: arrays, starts, directions, indices.

use numpy::ndarray::{Array2, ArrayView2};
use numpy::{
    AllowTypeChange, Complex64, IntoPyArray, PyArray1, PyArray2, PyArrayDyn, PyArrayLike1,
    PyArrayLike2, PyUntypedArray, PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyIndexError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stick_slip::nalgebra;

/// Numbers that become a one-dimensional array in Python.
#[derive(Clone, Debug)]
pub struct Numbers(pub Vec<f64>);

impl<'py> IntoPyObject<'py> for Numbers {
    type Target = PyArray1<f64>;
    type Output = Bound<'py, Self::Target>;
    type Error = std::convert::Infallible;

    fn into_pyobject(self, py: Python<'py>) -> Result<Self::Output, Self::Error> {
        Ok(self.0.into_pyarray(py))
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for Numbers {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Some(number) = number(&object) {
            return Ok(Self(vec![number]));
        }
        vector(&object).map(Self).ok_or_else(|| {
            PyTypeError::new_err(format!(
                "expected a number or a one-dimensional array of numbers, not {}",
                shown(&object)
            ))
        })
    }
}

/// The object as an array of real numbers. Conversion alone would take complex numbers without
/// their imaginary parts, texts, and None as nan.
fn numbers_of<'py>(object: &Bound<'py, PyAny>) -> Option<Bound<'py, PyAny>> {
    if object.cast::<PyArrayDyn<f64>>().is_ok() {
        return Some(object.clone());
    }
    let numpy = object.py().import("numpy").ok()?;
    let array = numpy.call_method1("asarray", (object,)).ok()?;
    let kind = array.getattr("dtype").ok()?.getattr("kind").ok()?;
    let is_real = ["b", "i", "u", "f"].contains(&kind.extract::<String>().ok()?.as_str());
    is_real.then_some(array)
}

/// The numbers of a one-dimensional array.
pub fn vector(object: &Bound<'_, PyAny>) -> Option<Vec<f64>> {
    let numbers = numbers_of(object)?;
    let array = numbers.extract::<PyArrayLike1<'_, f64, AllowTypeChange>>();
    Some(array.ok()?.as_array().to_vec())
}

/// A two-dimensional array.
fn table<'py>(object: &Bound<'py, PyAny>) -> Option<PyArrayLike2<'py, f64, AllowTypeChange>> {
    numbers_of(object)?.extract().ok()
}

/// Complex numbers that become an array.
#[derive(Clone, Debug)]
pub struct ComplexNumbers(pub Vec<Complex64>);

impl<'py> IntoPyObject<'py> for ComplexNumbers {
    type Target = PyArray1<Complex64>;
    type Output = Bound<'py, Self::Target>;
    type Error = std::convert::Infallible;

    fn into_pyobject(self, py: Python<'py>) -> Result<Self::Output, Self::Error> {
        Ok(self.0.into_pyarray(py))
    }
}

/// Rows of equal length that become a two-dimensional array.
#[derive(Clone, Debug)]
pub struct Table {
    rows: usize,
    columns: usize,
    numbers: Vec<f64>,
}

impl Table {
    pub fn new(columns: usize) -> Self {
        Self {
            rows: 0,
            columns,
            numbers: Vec::new(),
        }
    }

    pub fn with_rows(rows: usize, columns: usize) -> Self {
        Self {
            rows: 0,
            columns,
            numbers: Vec::with_capacity(rows * columns),
        }
    }

    pub fn push(&mut self, row: &[f64]) {
        self.numbers.extend_from_slice(row);
        self.rows += 1;
    }

    pub fn push_nan(&mut self) {
        self.numbers
            .extend(std::iter::repeat_n(f64::NAN, self.columns));
        self.rows += 1;
    }

    pub fn of_pairs(pairs: &[(f64, f64)]) -> Self {
        let mut table = Self::with_rows(pairs.len(), 2);
        for (first, second) in pairs {
            table.push(&[*first, *second]);
        }
        table
    }

    pub fn of(matrix: &nalgebra::DMatrix<f64>) -> Self {
        let mut table = Self::with_rows(matrix.nrows(), matrix.ncols());
        for i in 0..matrix.nrows() {
            let row: Vec<f64> = (0..matrix.ncols()).map(|j| matrix[(i, j)]).collect();
            table.push(&row);
        }
        table
    }
}

impl<'py> IntoPyObject<'py> for Table {
    type Target = PyArray2<f64>;
    type Output = Bound<'py, Self::Target>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Self::Output> {
        let array = Array2::from_shape_vec((self.rows, self.columns), self.numbers);
        let array = array.map_err(|error| PyValueError::new_err(error.to_string()))?;
        Ok(array.into_pyarray(py))
    }
}

/// A square matrix of Python as one of the crate.
pub struct Matrix(pub nalgebra::DMatrix<f64>);

impl<'a, 'py> FromPyObject<'a, 'py> for Matrix {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let array = table(&object).ok_or_else(|| {
            PyTypeError::new_err(format!(
                "expected a two-dimensional array of numbers, not {}",
                shown(&object)
            ))
        })?;
        let array: ArrayView2<'_, f64> = array.as_array();
        let (rows, columns) = array.dim();
        let entry = |i, j| array[(i, j)];
        Ok(Self(nalgebra::DMatrix::from_fn(rows, columns, entry)))
    }
}

/// A number counted from 0: of a coordinate, a contact, an element of a sequence.
#[derive(Clone, Copy, Debug)]
pub struct Index(pub usize);

impl<'a, 'py> FromPyObject<'a, 'py> for Index {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let number: i64 = object.extract()?;
        usize::try_from(number).map(Self).map_err(|_| {
            PyIndexError::new_err(format!(
                "{number} is not allowed: coordinates and contacts are counted from 0"
            ))
        })
    }
}

/// The number if there is such an item; otherwise the crate answers nothing, or panics.
pub fn within(index: Index, count: usize, what: &str) -> PyResult<usize> {
    if index.0 < count {
        return Ok(index.0);
    }
    Err(PyIndexError::new_err(format!(
        "no {what} {}: there are {count}, counted from 0",
        index.0
    )))
}

/// How many results a call may return: more would not fit into the memory.
const MOST: usize = 10_000_000;

/// A number of results.
pub struct Count(pub usize);

impl Count {
    /// The number, unless it is too large; `what` names the results.
    pub fn checked(count: f64, what: &str) -> PyResult<()> {
        if count <= MOST as f64 {
            return Ok(());
        }
        Err(PyValueError::new_err(format!(
            "{count:e} {what} are too many for one call: at most {MOST}"
        )))
    }
}

impl<'a, 'py> FromPyObject<'a, 'py> for Count {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let count: usize = object.extract()?;
        Self::checked(count as f64, "results").map(|()| Self(count))
    }
}

/// A direction: a coordinate, a mapping, or pairs of a coordinate and its coefficient.
#[derive(Clone, Debug)]
pub struct Direction(pub Vec<(usize, f64)>);

impl<'a, 'py> FromPyObject<'a, 'py> for Direction {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(number) = object.extract::<i64>() {
            let Index(coordinate) = number.into_pyobject(object.py())?.extract()?;
            return Ok(Self(vec![(coordinate, 1.0)]));
        }
        let pairs: Vec<(Index, f64)> = if let Ok(mapping) = object.cast::<PyDict>() {
            mapping.items().extract()?
        } else {
            object.extract().map_err(|error: PyErr| {
                if error.is_instance_of::<PyIndexError>(object.py()) {
                    return error;
                }
                PyTypeError::new_err(format!(
                    "a direction is a coordinate, a dict {{coordinate: coefficient}} or a list of \
                     pairs (coordinate, coefficient), not {}",
                    shown(&object)
                ))
            })?
        };
        let pairs = pairs.into_iter().map(|(Index(i), factor)| (i, factor));
        Ok(Self(pairs.collect()))
    }
}

impl<'py> IntoPyObject<'py> for &Direction {
    type Target = PyDict;
    type Output = Bound<'py, PyDict>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Self::Output> {
        let direction = PyDict::new(py);
        for (number, coefficient) in &self.0 {
            direction.set_item(number, coefficient)?;
        }
        Ok(direction)
    }
}

/// Pairs of numbers: the points of a table or of a profile, as pairs or as an array of two columns.
pub struct Points(pub Vec<(f64, f64)>);

impl<'a, 'py> FromPyObject<'a, 'py> for Points {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let pairs = table(&object).filter(|array| array.as_array().ncols() == 2);
        let pairs = pairs.ok_or_else(|| {
            PyTypeError::new_err(format!(
                "expected pairs of numbers, as in [(0, 0.4), (1, 0.3)], not {}",
                shown(&object)
            ))
        })?;
        let pairs = pairs.as_array();
        Ok(Self(
            pairs
                .rows()
                .into_iter()
                .map(|row| (row[0], row[1]))
                .collect(),
        ))
    }
}

/// The start of a mass on a belt.
#[derive(Clone, Copy)]
pub struct BeltStart(pub stick_slip::State);

impl<'a, 'py> FromPyObject<'a, 'py> for BeltStart {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok((u, v)) = object.extract::<(f64, f64)>() {
            return Ok(Self(stick_slip::State::new(u, v)));
        }
        match object
            .extract::<Numbers>()
            .map(|numbers| numbers.0)
            .as_deref()
        {
            Ok(&[u, v]) => Ok(Self(stick_slip::State::new(u, v))),
            _ => Err(PyTypeError::new_err(format!(
                "a start is a pair (displacement, velocity), not {}",
                shown(&object)
            ))),
        }
    }
}

/// The text of an object in a message, at most a line.
pub fn shown(object: &Borrowed<'_, '_, PyAny>) -> String {
    let text = object
        .repr()
        .map(|text| text.to_string())
        .unwrap_or_default();
    let kind = object
        .get_type()
        .name()
        .map(|name| name.to_string())
        .unwrap_or_default();
    let text: String = text.chars().take(60).collect();
    format!("{text} ({kind})")
}

/// The number that an object is. An array of one number is an array.
pub fn number(object: &Bound<'_, PyAny>) -> Option<f64> {
    let array = object.cast::<PyUntypedArray>();
    if array.is_ok_and(|array| array.ndim() > 0) {
        return None;
    }
    object.extract().ok()
}

/// Evaluates a function of one number for a number or for an array of any shape.
pub fn elementwise<'py>(
    argument: &Bound<'py, PyAny>,
    function: impl Fn(f64) -> f64,
) -> PyResult<Bound<'py, PyAny>> {
    let py = argument.py();
    if let Some(number) = number(argument) {
        return Ok(function(number).into_pyobject(py)?.into_any());
    }
    let numbers = numbers_of(argument).ok_or_else(|| {
        PyTypeError::new_err(format!(
            "expected a number or an array of numbers, not {}",
            shown(&argument.as_borrowed())
        ))
    })?;
    let array = numbers.extract::<numpy::PyArrayLikeDyn<'_, f64, AllowTypeChange>>()?;
    let result = array.as_array().mapv(function);
    let result: Bound<'py, PyArrayDyn<f64>> = result.into_pyarray(py);
    Ok(result.into_any())
}

/// A float as Python writes it.
pub fn float(number: f64) -> String {
    if number.is_nan() {
        "nan".to_owned()
    } else if number.is_infinite() {
        if number > 0.0 { "inf" } else { "-inf" }.to_owned()
    } else {
        exponent(&format!("{number:?}"))
    }
}

/// A float in few characters, for lines that are read and not computed with.
pub fn short(number: f64) -> String {
    let text = float(number);
    if text.len() <= 10 {
        return text;
    }
    let size = number.abs();
    if (1e-3..1e5).contains(&size) {
        format!("{number:.6}")
    } else {
        exponent(&format!("{number:.5e}"))
    }
}

/// The text of a float with its exponent as Python writes it: a sign and two digits at least.
fn exponent(text: &str) -> String {
    match text.split_once('e') {
        Some((mantissa, power)) if power.starts_with('-') => {
            format!("{mantissa}e-{:0>2}", &power[1..])
        }
        Some((mantissa, power)) => format!("{mantissa}e+{power:0>2}"),
        None => text.to_owned(),
    }
}
