//! The call that made an object: its text, and how another process makes the object again.

use std::sync::Arc;

use numpy::{PyUntypedArray, PyUntypedArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList, PyTuple};

/// Arrays with more rows are shown by their number.
const MOST_ROWS: usize = 8;

/// A function of the package with its arguments, and methods called on what it returned.
pub struct Made {
    function: &'static str,
    arguments: Py<PyTuple>,
    keywords: Py<PyDict>,
    then: Vec<Arc<Method>>,
}

struct Method {
    name: &'static str,
    arguments: Py<PyTuple>,
}

/// What `__reduce__` returns.
pub type Reduced<'py> = PyResult<Bound<'py, PyTuple>>;

/// A tuple of arguments.
pub trait Arguments<'py>:
    IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error: Into<PyErr>>
{
}

impl<'py, T> Arguments<'py> for T where
    T: IntoPyObject<'py, Target = PyTuple, Output = Bound<'py, PyTuple>, Error: Into<PyErr>>
{
}

impl Made {
    /// A call of `stick_slip.<function>`.
    pub fn by<'py>(
        py: Python<'py>,
        function: &'static str,
        arguments: impl Arguments<'py>,
    ) -> PyResult<Self> {
        Ok(Self {
            function,
            arguments: arguments.into_pyobject(py).map_err(Into::into)?.unbind(),
            keywords: PyDict::new(py).unbind(),
            then: Vec::new(),
        })
    }

    /// Adds a keyword argument.
    pub fn with<'py>(
        self,
        py: Python<'py>,
        name: &str,
        value: impl IntoPyObject<'py>,
    ) -> PyResult<Self> {
        self.keywords.bind(py).set_item(name, value)?;
        Ok(self)
    }

    /// Adds a keyword argument if it is given.
    pub fn with_given<'py>(
        self,
        py: Python<'py>,
        name: &str,
        value: Option<impl IntoPyObject<'py>>,
    ) -> PyResult<Self> {
        match value {
            Some(value) => self.with(py, name, value),
            None => Ok(self),
        }
    }

    /// This call, and then that of a method.
    pub fn then<'py>(
        &self,
        py: Python<'py>,
        name: &'static str,
        arguments: impl Arguments<'py>,
    ) -> PyResult<Self> {
        let arguments = arguments.into_pyobject(py).map_err(Into::into)?.unbind();
        let mut then = self.then.clone();
        then.push(Arc::new(Method { name, arguments }));
        Ok(Self {
            function: self.function,
            arguments: self.arguments.clone_ref(py),
            keywords: self.keywords.clone_ref(py),
            then,
        })
    }

    /// The call as Python writes it.
    pub fn text(&self, py: Python<'_>) -> PyResult<String> {
        let mut parts = texts(self.arguments.bind(py))?;
        for (name, value) in self.keywords.bind(py) {
            parts.push(format!("{name}={}", shown(&value)?));
        }
        let mut text = format!("{}({})", self.function, parts.join(", "));
        for method in &self.then {
            let arguments = texts(method.arguments.bind(py))?.join(", ");
            text += &match method.name {
                "__getitem__" => format!("[{arguments}]"),
                name => format!(".{name}({arguments})"),
            };
        }
        Ok(text)
    }

    /// The call for `pickle` and `copy`.
    pub fn reduced<'py>(&self, py: Python<'py>) -> Reduced<'py> {
        let make = py.import("stick_slip._made")?.getattr("made")?;
        let then = PyList::empty(py);
        for method in &self.then {
            then.append((method.name, &method.arguments))?;
        }
        let call = (self.function, &self.arguments, &self.keywords, then);
        (make, call).into_pyobject(py)
    }
}

fn texts(arguments: &Bound<'_, PyTuple>) -> PyResult<Vec<String>> {
    arguments.iter().map(|value| shown(&value)).collect()
}

/// An argument as Python writes it.
fn shown(value: &Bound<'_, PyAny>) -> PyResult<String> {
    let Ok(array) = value.cast::<PyUntypedArray>() else {
        return Ok(value.repr()?.to_string());
    };
    match array.shape().first() {
        Some(&rows) if rows > MOST_ROWS => Ok(format!("<{rows} points>")),
        _ => Ok(value.call_method0("tolist")?.repr()?.to_string()),
    }
}
