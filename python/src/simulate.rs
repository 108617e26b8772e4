//! Motions from a start: settings, stop conditions, Ctrl-C.

use pyo3::prelude::*;
use stick_slip::{Error, Integrator, Segment};

use crate::waiting::Waiting;

/// Steps after which a motion looks for a signal.
const LOOK_EVERY: usize = 1000;

/// How a motion is computed.
pub struct Settings {
    pub tolerance: Option<f64>,
    pub max_steps: Option<usize>,
    pub max_events: Option<usize>,
    pub start_time: f64,
    pub until: Option<Py<PyAny>>,
}

impl Settings {
    pub fn integrator(&self) -> Result<Integrator, Error> {
        let mut integrator = Integrator::new().with_start_time(self.start_time)?;
        if let Some(tolerance) = self.tolerance {
            integrator = integrator.with_tolerance(tolerance)?;
        }
        if let Some(steps) = self.max_steps {
            integrator = integrator.with_max_steps(steps)?;
        }
        if let Some(events) = self.max_events {
            integrator = integrator.with_max_events(events)?;
        }
        Ok(integrator)
    }

    /// The stop condition of a run: a signal or an exception, or the first zero of `until`.
    pub fn stop<'s, P: Segment>(
        &'s self,
        waiting: &'s Waiting,
        call: impl for<'py> Fn(&Bound<'py, PyAny>, &P::State) -> PyResult<Bound<'py, PyAny>> + 's,
    ) -> impl FnMut(&P) -> Option<f64> + 's {
        let mut steps = 0;
        move |step: &P| {
            steps += 1;
            if steps % LOOK_EVERY == 0 && waiting.is_interrupted() {
                return Some(step.end_time());
            }
            let until = self.until.as_ref()?;
            let value = |at: &P::State| {
                let answer = waiting.call(|py| call(until.bind(py), at)?.extract::<f64>());
                answer.unwrap_or(f64::NAN)
            };
            let zero = step.first_zero(value);
            if waiting.has_failed() {
                Some(step.end_time())
            } else {
                zero
            }
        }
    }
}
