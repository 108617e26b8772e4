//! Faults of laws at the start of a step.

use crate::error::{Error, Reached};

/// A law that returns NaN, an infinity or no series.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fault {
    pub(super) law: FaultyLaw,
    /// The sliding speed of a friction law, the position of a force law along its first direction.
    pub(super) place: f64,
    /// The number that is not finite; `None` if there is no series.
    pub(super) value: Option<f64>,
}

/// What the law gives, with the number of its owner.
#[derive(Debug, Clone, Copy)]
pub(super) enum FaultyLaw {
    Friction,
    /// The force of an element, with the velocity along its first direction.
    Force(usize, f64),
    /// A part of the load of a contact, with this velocity.
    Load(usize, f64),
    /// A part of the rate of a first-order state.
    Rate(usize),
}

impl Fault {
    /// The error for this fault.
    pub(super) fn at(self, reached: Reached) -> Error {
        let position = self.place;
        match (self.law, self.value) {
            (FaultyLaw::Friction, Some(value)) => Error::NonFiniteFriction {
                speed: position,
                value,
                reached: Some(reached),
            },
            (FaultyLaw::Friction, None) => Error::NotAnalytic {
                speed: position,
                reached: Some(reached),
            },
            (FaultyLaw::Force(element, velocity), Some(value)) => Error::NonFiniteForce {
                element,
                position,
                velocity,
                value,
                reached,
            },
            (FaultyLaw::Force(element, _), None) => Error::NotAnalyticForce {
                element,
                position,
                reached,
            },
            (FaultyLaw::Load(contact, velocity), Some(_)) => Error::NonFiniteLoad {
                contact,
                position,
                velocity,
                reached,
            },
            (FaultyLaw::Load(contact, _), None) => Error::NotAnalyticLoad {
                contact,
                position,
                reached,
            },
            (FaultyLaw::Rate(state), Some(value)) => Error::NonFiniteRate {
                state,
                position,
                value,
                reached,
            },
            (FaultyLaw::Rate(state), None) => Error::NotAnalyticRate {
                state,
                position,
                reached,
            },
        }
    }
}
