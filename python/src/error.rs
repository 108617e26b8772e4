//! The errors of the crate as exceptions that carry its numbers, and exceptions back as errors.

use pyo3::import_exception;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use stick_slip::orbit::NotDifferentiable;
use stick_slip::structure::NotSliding;
use stick_slip::{Error, Reached};

use crate::convert::Numbers;
use crate::state::Shown;

import_exception!(stick_slip._errors, ParameterError);
import_exception!(stick_slip._errors, StickSlipError);

/// The crate's error inside of its exception: one that passes through a Python function goes back
/// to the crate as it was.
#[pyclass(frozen, name = "_Cause", module = "stick_slip._stick_slip")]
struct Cause(Error);

/// The exception of an error.
pub fn raised(error: Error) -> PyErr {
    Python::attach(|py| exception(py, error)).unwrap_or_else(|failure| failure)
}

/// The error of the crate that an exception carries.
pub fn carried(py: Python<'_>, exception: &PyErr) -> Option<Error> {
    let cause = exception.value(py).getattr("_cause").ok()?;
    let cause = cause.cast::<Cause>().ok()?;
    Some(cause.get().0.clone())
}

/// Results of the crate in functions of Python.
pub trait OrRaise<T> {
    fn or_raise(self) -> PyResult<T>;
}

impl<T> OrRaise<T> for Result<T, Error> {
    fn or_raise(self) -> PyResult<T> {
        self.map_err(raised)
    }
}

/// What the crate's messages name, and what it is called in Python.
const NAMES: [(&str, &str); 17] = [
    ("; for a simulation without an end use `flow`", ""),
    (", shorten the run, or use `flow`", ", or shorten the run"),
    ("`with_max_steps`", "`max_steps=`"),
    ("`with_max_events`", "`max_events=`"),
    ("with `simulate_until`", "by `until=`"),
    ("`steady_sliding_from`", "`near=`"),
    ("`with_least_speed`", "`least_speed=`"),
    ("`with_tangential_stiffness`", "`tangential_stiffness=`"),
    ("`Contact::with_normal_spring`", "`normal_spring=`"),
    ("`Contact::with_load_law`", "`load_laws=`"),
    (
        "`Stop::with_contact_stiffness(k, c)`",
        "`stiffness=` and `damping=`",
    ),
    (
        "`Structure::with_first_orders`",
        "`Structure.with_first_orders`",
    ),
    ("`Coulomb::new(μ, μ)`", "`Coulomb(μ, μ)`"),
    ("`Period::Free`", "`estimate=`"),
    ("`Period::Driven`", "`periods=`"),
    ("`f64::INFINITY`", "inf"),
    (
        "the pieces in `kinetic_on`",
        "a list of functions, one for each piece",
    ),
];

/// A message of the crate with the names of the package.
pub fn in_python(message: impl ToString) -> String {
    let message = message.to_string();
    NAMES
        .iter()
        .fold(message, |message, (name, here)| message.replace(name, here))
}

fn exception(py: Python<'_>, error: Error) -> PyResult<PyErr> {
    let fields = PyDict::new(py);
    describe(&error, &fields)?;
    let variant = name_of(&error);
    let message = in_python(&error);
    let is_argument = is_argument(&error);
    let cause = Cause(error).into_pyobject(py)?.unbind();
    let arguments = (message, variant, fields.unbind(), cause);
    Ok(if is_argument {
        ParameterError::new_err(arguments)
    } else {
        StickSlipError::new_err(arguments)
    })
}

/// True if an argument is at fault, and not a motion or a search.
fn is_argument(error: &Error) -> bool {
    match error {
        Error::InvalidParameter { .. }
        | Error::BadPoint { .. }
        | Error::InvalidState { .. }
        | Error::InvalidTolerance { .. }
        | Error::InvalidDuration { .. }
        | Error::StaticBelowKinetic { .. }
        | Error::BadBreakpoints { .. }
        | Error::BadElement { .. }
        | Error::NoSuchCoordinate { .. }
        | Error::NoSuchState { .. }
        | Error::RigidStop { .. }
        | Error::WrongSize { .. }
        | Error::NotSymmetric { .. }
        | Error::NotPositiveDefinite { .. }
        | Error::BadDirection { .. }
        | Error::LawNotConstant { .. }
        | Error::OverLimit { .. }
        | Error::BeltVelocityJumps { .. }
        | Error::NonFiniteFriction { reached: None, .. }
        | Error::NotAnalytic { reached: None, .. } => true,
        Error::At { source, .. } => is_argument(source),
        _ => false,
    }
}

/// Sets the fields of an error by name.
macro_rules! fields {
    ($into:ident: $($field:ident),*) => {{
        $($into.set_item(stringify!($field), $field.clone())?;)*
    }};
}

/// The numbers of an error.
fn describe(error: &Error, to: &Bound<'_, PyDict>) -> PyResult<()> {
    let py = to.py();
    match error {
        Error::InvalidParameter {
            of,
            name,
            value,
            allowed,
        } => {
            fields!(to: of, name, value, allowed);
        }
        Error::BadPoint {
            of,
            index,
            name,
            value,
            allowed,
        } => {
            fields!(to: of, index, name, value, allowed);
        }
        Error::InvalidState {
            displacement,
            velocity,
        } => {
            fields!(to: displacement, velocity);
        }
        Error::InvalidTolerance { value, min, max } => {
            fields!(to: value, min, max);
        }
        Error::InvalidDuration { value } => {
            fields!(to: value);
        }
        Error::StaticBelowKinetic {
            static_coefficient,
            kinetic_coefficient,
        } => {
            fields!(to: static_coefficient, kinetic_coefficient);
        }
        Error::NonFiniteFriction {
            speed,
            value,
            reached,
        } => {
            fields!(to: speed, value);
            reach(reached.as_ref(), to)?;
        }
        Error::NotAnalytic { speed, reached } => {
            fields!(to: speed);
            reach(reached.as_ref(), to)?;
        }
        Error::BadBreakpoints { index, value } => {
            fields!(to: index, value);
        }
        Error::NonFiniteLoad {
            contact,
            position,
            velocity,
            reached,
        } => {
            fields!(to: contact, position, velocity);
            reach(Some(reached), to)?;
        }
        Error::NotAnalyticLoad {
            contact,
            position,
            reached,
        } => {
            fields!(to: contact, position);
            reach(Some(reached), to)?;
        }
        Error::NonFiniteForce {
            element,
            position,
            velocity,
            value,
            reached,
        } => {
            fields!(to: element, position, velocity, value);
            reach(Some(reached), to)?;
        }
        Error::NotAnalyticForce {
            element,
            position,
            reached,
        } => {
            fields!(to: element, position);
            reach(Some(reached), to)?;
        }
        Error::NonFiniteRate {
            state,
            position,
            value,
            reached,
        } => {
            to.set_item("first_order", state)?;
            fields!(to: position, value);
            reach(Some(reached), to)?;
        }
        Error::NotAnalyticRate {
            state,
            position,
            reached,
        } => {
            to.set_item("first_order", state)?;
            fields!(to: position);
            reach(Some(reached), to)?;
        }
        Error::BadElement {
            element,
            value,
            allowed,
        } => {
            to.set_item("element", element.to_string())?;
            fields!(to: value, allowed);
        }
        Error::NoSuchCoordinate {
            element,
            coordinate,
            count,
        } => {
            to.set_item("element", element.to_string())?;
            fields!(to: coordinate, count);
        }
        Error::NoSuchState {
            element,
            state,
            count,
        } => {
            to.set_item("element", element.to_string())?;
            to.set_item("first_order", state)?;
            fields!(to: count);
        }
        Error::RigidStop { stop } => {
            fields!(to: stop);
        }
        Error::WrongSize {
            name,
            found,
            expected,
        } => {
            fields!(to: name, found, expected);
        }
        Error::NotSymmetric { row, column, .. } => {
            fields!(to: row, column);
        }
        Error::NotPositiveDefinite { row } => {
            fields!(to: row);
        }
        Error::BadDirection { direction } => {
            fields!(to: direction);
        }
        Error::NoSteadySliding(reason) => {
            to.set_item("reason", in_python(reason))?;
            not_sliding(reason, to)?;
        }
        Error::NoDerivative { parameter, reason } => {
            fields!(to: parameter);
            to.set_item("reason", in_python(reason))?;
            match reason {
                NotDifferentiable::Events { time } | NotDifferentiable::Order { time } => {
                    fields!(to: time);
                }
                NotDifferentiable::NoMotion(source) => {
                    to.set_item("source", exception(py, (**source).clone())?)?;
                }
                _ => {}
            }
        }
        Error::NoSwitch { kind } => {
            fields!(to: kind);
        }
        Error::TooManyMechanisms {
            contacts,
            subsets,
            most,
            reached,
        } => {
            fields!(to: contacts, subsets, most);
            reach(Some(reached), to)?;
        }
        Error::Jammed { contacts, reached } => {
            fields!(to: contacts);
            reach(Some(reached), to)?;
        }
        Error::WrongWay { contact, velocity } => {
            fields!(to: contact, velocity);
        }
        Error::LawNotConstant { coefficients } => {
            fields!(to: coefficients);
        }
        Error::OverLimit {
            contact,
            carried,
            limit,
        } => {
            fields!(to: contact, carried, limit);
        }
        Error::BeltVelocityJumps { coordinate, time } => {
            fields!(to: coordinate, time);
        }
        Error::StepUnderflow { step, reached } => {
            fields!(to: step);
            reach(Some(reached), to)?;
        }
        Error::TooManySteps { limit, reached } => {
            fields!(to: limit);
            reach(Some(reached), to)?;
        }
        Error::Separation { contact, reached } => {
            fields!(to: contact);
            reach(Some(reached), to)?;
        }
        Error::TooManyEvents { limit, reached } => {
            fields!(to: limit);
            reach(Some(reached), to)?;
        }
        Error::NotPeriodic {
            residual,
            period,
            start,
        } => {
            fields!(to: residual, period);
            to.set_item("start", Shown(start.clone()))?;
        }
        Error::Stopped {
            parameter,
            value,
            steps,
            found,
        } => {
            fields!(to: parameter, value, steps);
            to.set_item("found", Numbers(found.clone()))?;
        }
        Error::At {
            parameter,
            value,
            source,
        } => {
            fields!(to: parameter, value);
            to.set_item("source", exception(py, (**source).clone())?)?;
        }
        _ => {}
    }
    Ok(())
}

/// The name of the variant, with which its text for programmers begins.
fn name_of(error: &Error) -> String {
    let text = format!("{error:?}");
    text.chars()
        .take_while(char::is_ascii_alphanumeric)
        .collect()
}

fn not_sliding(reason: &NotSliding, to: &Bound<'_, PyDict>) -> PyResult<()> {
    match reason {
        NotSliding::NoSpeed { contact }
        | NotSliding::Continuum { contact }
        | NotSliding::NoSteadyMemory { contact } => fields!(to: contact),
        NotSliding::NoLoad { contact, load } => fields!(to: contact, load),
        NotSliding::Deforms { coordinate } => fields!(to: coordinate),
        NotSliding::Grows { state, rate } => fields!(to: state, rate),
        NotSliding::WrongWay { contact, velocity } => fields!(to: contact, velocity),
        NotSliding::OverLimit {
            contact,
            force,
            limit,
        } => fields!(to: contact, force, limit),
        NotSliding::NotFound { residual, load } => fields!(to: residual, load),
        NotSliding::AtBreakpoint { element, position } => {
            let element = element.to_string();
            fields!(to: element, position)
        }
        NotSliding::LoadAtBreakpoint { contact, position } => fields!(to: contact, position),
        _ => {}
    }
    Ok(())
}

/// The time and the state that a motion had reached.
fn reach(reached: Option<&Reached>, to: &Bound<'_, PyDict>) -> PyResult<()> {
    if let Some(reached) = reached {
        to.set_item("time", reached.time)?;
        to.set_item("state", Shown(reached.state.clone()))?;
    }
    Ok(())
}
