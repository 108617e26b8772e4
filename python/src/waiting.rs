//! Long work: without the interpreter's lock, with Ctrl-C, callbacks and their exceptions.

use std::cell::{Cell, RefCell};
use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use pyo3::prelude::*;
use stick_slip::{Error, Search};

use crate::convert::{Numbers, short};
use crate::error::{OrRaise, carried};

/// Signals are looked for at most so often: each look may have to wait for the interpreter's lock.
const LOOK_EVERY: Duration = Duration::from_millis(50);

/// The progress of a search, given to the function `progress`.
#[pyclass(frozen, get_all, module = "stick_slip")]
pub struct Progress {
    /// The value being tried, in a search along a parameter; in a search on one system the time
    /// that the motion has reached, in units of time.
    pub value: f64,
    /// The second parameter of a search over two, otherwise None.
    pub second: Option<f64>,
    /// Number of motions found so far, without the first; 0 in a search on one system.
    pub points: usize,
    /// Number of integration steps so far, the unit of the work.
    pub steps: usize,
}

#[pymethods]
impl Progress {
    fn __repr__(&self) -> String {
        let Self {
            value,
            points,
            steps,
            ..
        } = self;
        format!(
            "Progress(value={}, points={points}, steps={steps})",
            short(*value)
        )
    }
}

impl From<stick_slip::Progress> for Progress {
    fn from(now: stick_slip::Progress) -> Self {
        Self {
            value: now.value,
            second: now.second,
            points: now.points,
            steps: now.steps,
        }
    }
}

/// The bounds and the callback of a search.
pub struct Options {
    max_steps: Option<usize>,
    max_points: Option<usize>,
    progress: Option<Py<PyAny>>,
    /// The unit of the values that the crate reports.
    unit: f64,
}

pub fn options(
    max_steps: Option<usize>,
    max_points: Option<usize>,
    progress: Option<Py<PyAny>>,
) -> Options {
    Options {
        max_steps,
        max_points,
        progress,
        unit: 1.0,
    }
}

impl Options {
    /// Adapts the progress of a search whose values are in other units than those of its caller.
    pub fn in_units_of(self, unit: f64) -> Self {
        Self { unit, ..self }
    }
}

/// What a search waits for beside its work: the first exception of a callback, or a signal.
pub struct Waiting {
    exception: RefCell<Option<PyErr>>,
    looked: Cell<Instant>,
}

/// The error that ends a search in which Python raised an exception.
fn interrupted() -> Error {
    Error::Stopped {
        parameter: "exception",
        value: 0.0,
        steps: 0,
        found: Vec::new(),
    }
}

impl Waiting {
    pub fn new() -> Self {
        Self {
            exception: RefCell::new(None),
            looked: Cell::new(Instant::now()),
        }
    }

    pub fn has_failed(&self) -> bool {
        self.exception.borrow().is_some()
    }

    /// The exception to be raised now that the work has ended.
    pub fn into_exception(self) -> Option<PyErr> {
        self.exception.into_inner()
    }

    fn fail(&self, exception: PyErr) {
        self.exception.borrow_mut().get_or_insert(exception);
    }

    /// Looks for a signal, at most every `LOOK_EVERY`. True if the work has to end.
    pub fn is_interrupted(&self) -> bool {
        if self.has_failed() {
            return true;
        }
        if self.looked.get().elapsed() < LOOK_EVERY {
            return false;
        }
        self.looked.set(Instant::now());
        if let Err(exception) = Python::attach(|py| py.check_signals()) {
            self.fail(exception);
        }
        self.has_failed()
    }

    /// Calls Python, unless an exception waits already. An error of the crate that Python raised
    /// goes back as it was; any other exception ends the search, and is raised after it.
    pub fn call<T>(&self, call: impl FnOnce(Python<'_>) -> PyResult<T>) -> Result<T, Error> {
        if self.has_failed() {
            return Err(interrupted());
        }
        Python::attach(|py| {
            call(py).map_err(|exception| {
                carried(py, &exception).unwrap_or_else(|| {
                    self.fail(exception);
                    interrupted()
                })
            })
        })
    }

    /// So many items after those that are skipped, up to a signal.
    pub fn items<T>(
        &self,
        items: impl Iterator<Item = Result<T, Error>>,
        skip: usize,
        count: usize,
    ) -> Result<Vec<T>, Error> {
        let mut found = Vec::new();
        for (number, item) in items.take(skip.saturating_add(count)).enumerate() {
            if self.is_interrupted() {
                break;
            }
            let item = item?;
            if number >= skip {
                found.push(item);
            }
        }
        Ok(found)
    }

    /// A search with these bounds, which calls `progress` and ends at a signal.
    pub fn search<'s>(&'s self, options: &'s Options) -> Result<Search<'s>, Error> {
        let mut search = Search::new();
        if let Some(steps) = options.max_steps {
            search = search.with_max_steps(steps)?;
        }
        if let Some(points) = options.max_points {
            search = search.with_max_points(points)?;
        }
        Ok(search.watched(move |now| {
            let now = Progress::from(*now);
            let value = now.value * options.unit;
            if self.goes_on(options, Progress { value, ..now }) {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            }
        }))
    }

    /// Looks for a signal and reports the progress. False if the work has to end.
    pub fn goes_on(&self, options: &Options, now: Progress) -> bool {
        !self.is_interrupted()
            && options
                .progress
                .as_ref()
                .is_none_or(|progress| self.report(progress, now))
    }

    /// Tells Python about the progress. It goes on unless the function returns False.
    fn report(&self, progress: &Py<PyAny>, now: Progress) -> bool {
        let call = |py: Python<'_>| {
            let answer = progress.bind(py).call1((now,))?;
            Ok(!answer.is(pyo3::types::PyBool::new(py, false).as_any()))
        };
        match Python::attach(call) {
            Ok(goes_on) => goes_on,
            Err(exception) => {
                self.fail(exception);
                false
            }
        }
    }
}

/// Does long work without the interpreter's lock. `present` makes of what was found an object for
/// Python, which an exception carries as `found`.
pub fn work<T: Send>(
    py: Python<'_>,
    options: Options,
    run: impl FnOnce(&Waiting, &Options) -> Result<T, Error> + Send,
    present: impl FnOnce(T) -> PyResult<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    let (result, exception) = py.detach(|| {
        let waiting = Waiting::new();
        let result = run(&waiting, &options);
        (result, waiting.into_exception())
    });
    let Some(exception) = exception else {
        return present(result.or_raise()?);
    };
    let found = match result {
        Ok(found) => present(found)?,
        Err(Error::Stopped { found, .. }) => Numbers(found).into_pyobject(py)?.into_any().unbind(),
        Err(_) => py.None(),
    };
    exception.value(py).setattr("found", found)?;
    Err(exception)
}

/// Runs a search with its bounds and its callback.
pub fn search<T: Send>(
    py: Python<'_>,
    options: Options,
    run: impl FnOnce(Search<'_>, &Waiting) -> Result<T, Error> + Send,
    present: impl FnOnce(T) -> PyResult<Py<PyAny>>,
) -> PyResult<Py<PyAny>> {
    let run = |waiting: &Waiting, options: &Options| run(waiting.search(options)?, waiting);
    work(py, options, run, present)
}
