//! States of structures: starts, and results.

use std::collections::BTreeMap;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stick_slip::structure;

use crate::convert::{Index, Numbers, shown};

/// The state of a structure: two to four entries (displacements, velocities, memory, sliding). The
/// first three are numbers or arrays, the last one a dict of relative velocities of contacts.
#[derive(Clone)]
pub struct Start(pub structure::State);

impl<'a, 'py> FromPyObject<'a, 'py> for Start {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        let bad = || {
            PyTypeError::new_err(format!(
                "a start is a pair (displacements, velocities), with memory variables as a third \
                 array and a dict {{contact: relative velocity}} as a fourth entry if there are \
                 any, not {}",
                shown(&object)
            ))
        };
        let mut parts: Vec<Bound<'_, PyAny>> = object.extract().map_err(|_| bad())?;
        let sliding = if parts.len() == 4 { parts.pop() } else { None };
        let numbers: Vec<Numbers> = parts
            .iter()
            .map(|part| part.extract())
            .collect::<PyResult<_>>()
            .map_err(|_| bad())?;
        let mut state = match &numbers[..] {
            [q, v] => structure::State::new(&q.0, &v.0),
            [q, v, memory] => structure::State::new(&q.0, &v.0).with_memory(&memory.0),
            _ => return Err(bad()),
        };
        if let Some(sliding) = sliding {
            let sliding = sliding.cast::<PyDict>().map_err(|_| bad())?;
            let sliding: Vec<(Index, f64)> = sliding.items().extract()?;
            for (Index(contact), velocity) in sliding {
                state = state.with_sliding(contact, velocity);
            }
        }
        Ok(Self(state))
    }
}

/// A state that becomes the named tuple `State` of Python.
#[derive(Clone, Debug)]
pub struct Shown(pub structure::State);

impl<'py> IntoPyObject<'py> for Shown {
    type Target = PyAny;
    type Output = Bound<'py, PyAny>;
    type Error = PyErr;

    fn into_pyobject(self, py: Python<'py>) -> PyResult<Self::Output> {
        let sliding: BTreeMap<usize, f64> = self.0.sliding().iter().copied().collect();
        let numbers = [self.0.displacements, self.0.velocities, self.0.memory].map(Numbers);
        let [displacements, velocities, memory] = numbers;
        let class = py.import("stick_slip._state")?.getattr("State")?;
        class.call1((displacements, velocities, memory, sliding))
    }
}
