//! Any system, and families of systems: functions of Python that return one.

use std::cell::RefCell;
use std::collections::HashMap;

use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use stick_slip::{Error, Structure, structure};

use crate::belt::BeltArgument;
use crate::convert::{Numbers, shown};
use crate::error::raised;
use crate::state::Start;
use crate::structure::PyStructure;
use crate::waiting::Waiting;

/// Any system, as the searches for periodic motions take it: a `Structure` or a mass on a belt.
pub enum AnySystem<'py> {
    Structure(Bound<'py, PyStructure>),
    Belt(BeltArgument<'py>),
}

impl<'a, 'py> FromPyObject<'a, 'py> for AnySystem<'py> {
    type Error = PyErr;

    fn extract(object: Borrowed<'a, 'py, PyAny>) -> PyResult<Self> {
        if let Ok(structure) = object.cast::<PyStructure>() {
            return Ok(Self::Structure(structure.to_owned()));
        }
        object.extract().map(Self::Belt).map_err(|_| {
            PyTypeError::new_err(format!(
                "expected a Structure, a MassOnBelt or a PhysicalMassOnBelt, not {}",
                shown(&object)
            ))
        })
    }
}

impl AnySystem<'_> {
    pub fn structure(&self) -> Result<Structure, Error> {
        match self {
            Self::Structure(structure) => Ok((*structure.get().0).clone()),
            Self::Belt(belt) => belt.system().structure(),
        }
    }
}

/// A family of systems in Python. Each system is kept by the bits of its parameters, because
/// searches ask for some again when they are over.
pub struct Family<'w> {
    function: Py<PyAny>,
    waiting: &'w Waiting,
    systems: RefCell<HashMap<Vec<u64>, Result<Structure, Error>>>,
}

/// So many systems are kept; they are small, and no search asks for one of long ago.
const KEPT: usize = 4096;

impl<'w> Family<'w> {
    pub fn new(function: Py<PyAny>, waiting: &'w Waiting) -> Self {
        Self {
            function,
            waiting,
            systems: RefCell::default(),
        }
    }

    fn kept(
        &self,
        parameters: &[f64],
        system: impl FnOnce() -> Result<Structure, Error>,
    ) -> Result<Structure, Error> {
        let key: Vec<u64> = parameters.iter().map(|number| number.to_bits()).collect();
        if let Some(system) = self.systems.borrow().get(&key) {
            return system.clone();
        }
        let system = system();
        if !self.waiting.has_failed() {
            let mut systems = self.systems.borrow_mut();
            if systems.len() == KEPT {
                systems.clear();
            }
            systems.insert(key, system.clone());
        }
        system
    }

    pub fn of_one(&self, parameter: f64) -> Result<Structure, Error> {
        self.kept(&[parameter], || {
            self.waiting
                .call(|py| system_of(self.function.bind(py).call1((parameter,))?))
        })
    }

    pub fn of_two(&self, first: f64, second: f64) -> Result<Structure, Error> {
        self.kept(&[first, second], || {
            self.waiting
                .call(|py| system_of(self.function.bind(py).call1((first, second))?))
        })
    }

    pub fn of_many(&self, parameters: &[f64]) -> Result<Structure, Error> {
        self.kept(parameters, || {
            let numbers = Numbers(parameters.to_vec());
            self.waiting
                .call(|py| system_of(self.function.bind(py).call1((numbers,))?))
        })
    }

    /// A family of systems with their starts.
    pub fn with_start(&self, parameters: &[f64]) -> Result<(Structure, structure::State), Error> {
        self.waiting.call(|py| {
            let pair = self
                .function
                .bind(py)
                .call1((Numbers(parameters.to_vec()),))?;
            let (system, start) = pair.extract::<(Bound<'_, PyAny>, Start)>().map_err(|_| {
                PyTypeError::new_err("the function must return a pair (system, start)")
            })?;
            Ok((system_of(system)?, start.0))
        })
    }
}

fn system_of(object: Bound<'_, PyAny>) -> PyResult<Structure> {
    let system: AnySystem = object.extract()?;
    system.structure().map_err(raised)
}
