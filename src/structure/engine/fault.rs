//! Faults of laws at the start of a step.

use crate::error::{Error, Reached};

/// The fault of a law that returns NaN, an infinity or no series.
#[derive(Debug, Clone, Copy)]
pub(super) enum LawFault {
    NonFinite {
        speed: f64,
        value: f64,
    },
    NotAnalytic {
        speed: f64,
    },
    /// The force of an element, or a part of the load of contact `pressed`, is not finite.
    NonFiniteForce {
        element: usize,
        pressed: Option<usize>,
        position: f64,
        velocity: f64,
        value: f64,
    },
    NotAnalyticForce {
        element: usize,
        pressed: Option<usize>,
        position: f64,
    },
    /// The rate from the law of a first-order state is not finite.
    NonFiniteRate {
        state: usize,
        position: f64,
        value: f64,
    },
    NotAnalyticRate {
        state: usize,
        position: f64,
    },
}

impl LawFault {
    /// The fault of the law of a first-order state, if the element's law is one.
    pub(super) fn in_rate_of(self, state: Option<usize>) -> Self {
        match (state, self) {
            (
                Some(state),
                Self::NonFiniteForce {
                    position, value, ..
                },
            ) => Self::NonFiniteRate {
                state,
                position,
                value,
            },
            (Some(state), Self::NotAnalyticForce { position, .. }) => {
                Self::NotAnalyticRate { state, position }
            }
            (_, fault) => fault,
        }
    }

    /// The error for this fault.
    pub(super) fn at(self, reached: Reached) -> Error {
        match self {
            Self::NonFinite { speed, value } => Error::NonFiniteFriction {
                speed,
                value,
                reached: Some(reached),
            },
            Self::NotAnalytic { speed } => Error::NotAnalytic {
                speed,
                reached: Some(reached),
            },
            Self::NonFiniteForce {
                element,
                pressed: None,
                position,
                velocity,
                value,
            } => Error::NonFiniteForce {
                element,
                position,
                velocity,
                value,
                reached,
            },
            Self::NonFiniteForce {
                pressed: Some(contact),
                position,
                velocity,
                ..
            } => Error::NonFiniteLoad {
                contact,
                position,
                velocity,
                reached,
            },
            Self::NotAnalyticForce {
                element,
                pressed: None,
                position,
            } => Error::NotAnalyticForce {
                element,
                position,
                reached,
            },
            Self::NotAnalyticForce {
                pressed: Some(contact),
                position,
                ..
            } => Error::NotAnalyticLoad {
                contact,
                position,
                reached,
            },
            Self::NonFiniteRate {
                state,
                position,
                value,
            } => Error::NonFiniteRate {
                state,
                position,
                value,
                reached,
            },
            Self::NotAnalyticRate { state, position } => Error::NotAnalyticRate {
                state,
                position,
                reached,
            },
        }
    }
}
