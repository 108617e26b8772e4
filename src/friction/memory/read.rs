//! Serialization of contact laws with memory (feature `serde`): by the arguments of their
//! constructors, and through the checks of these.

use serde::{Deserialize, Serialize};

use super::dwell::Rise;
use super::rate_state::Evolution;
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::friction::read::read;

read! {
    Directional<F, B> { forward: F, backward: B } => Self::new(forward, backward);
    Freewheel<L> { drag: L } => Self::new(drag);
    LuGre<L> {
        law: L, stiffness: f64, #[serde(default)] damping: f64, #[serde(default)] viscous: f64
    } => Self::new(law, stiffness, damping, viscous);
}

#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Dwell<L> {
    Exponential(Limited<L>),
    Hyperbolic(Limited<L>),
    Logarithmic(Unlimited<L>),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Limited<L> {
    law: L,
    limit: f64,
    time: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Unlimited<L> {
    law: L,
    rate: f64,
    time: f64,
}

impl<L> From<super::Dwell<L>> for Dwell<L> {
    fn from(super::Dwell { law, form, time }: super::Dwell<L>) -> Self {
        match form {
            Rise::Exponential(limit) => Self::Exponential(Limited { law, limit, time }),
            Rise::Hyperbolic(limit) => Self::Hyperbolic(Limited { law, limit, time }),
            Rise::Logarithmic(rate) => Self::Logarithmic(Unlimited { law, rate, time }),
        }
    }
}

impl<L: FrictionLaw> TryFrom<Dwell<L>> for super::Dwell<L> {
    type Error = Error;
    fn try_from(read: Dwell<L>) -> Result<Self, Error> {
        match read {
            Dwell::Exponential(Limited { law, limit, time }) => Self::exponential(law, limit, time),
            Dwell::Hyperbolic(Limited { law, limit, time }) => Self::hyperbolic(law, limit, time),
            Dwell::Logarithmic(Unlimited { law, rate, time }) => Self::logarithmic(law, rate, time),
        }
    }
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Dahl {
    coefficient: f64,
    stiffness: f64,
}

impl From<super::Dahl> for Dahl {
    fn from(law: super::Dahl) -> Self {
        Self {
            coefficient: law.kinetic_coefficient(),
            stiffness: law.stiffness(),
        }
    }
}

impl TryFrom<Dahl> for super::Dahl {
    type Error = Error;
    fn try_from(read: Dahl) -> Result<Self, Error> {
        Self::new(read.coefficient, read.stiffness)
    }
}

/// A rate-and-state law with one state variable or with two.
#[derive(Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum RateState {
    Aging(Numbers),
    Slip(Numbers),
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Numbers {
    f0: f64,
    a: f64,
    b: f64,
    d_c: f64,
    v0: f64,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    b2: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    d_c2: Option<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    v_m: Option<f64>,
}

/// A law that is read.
pub(crate) enum AnyStates {
    One(super::RateState),
    Two(super::RateState2),
}

impl TryFrom<RateState> for AnyStates {
    type Error = Error;
    fn try_from(read: RateState) -> Result<Self, Error> {
        let (evolution, numbers) = match read {
            RateState::Aging(numbers) => (Evolution::Aging, numbers),
            RateState::Slip(numbers) => (Evolution::Slip, numbers),
        };
        let Numbers {
            f0, a, b, d_c, v0, ..
        } = numbers;
        let mut law = super::RateState::new(evolution, f0, a, b, d_c, v0)?;
        if let Some(v_m) = numbers.v_m {
            law = law.with_least_speed(v_m)?;
        }
        // One number without the other is refused as a NaN.
        Ok(match (numbers.b2, numbers.d_c2) {
            (None, None) => Self::One(law),
            (b2, d_c2) => {
                let [b2, d_c2] = [b2, d_c2].map(|number| number.unwrap_or(f64::NAN));
                Self::Two(law.with_second_state(b2, d_c2)?)
            }
        })
    }
}

impl<const STATES: usize> From<super::RateState<STATES>> for RateState {
    fn from(law: super::RateState<STATES>) -> Self {
        let [first, second] = [0, 1].map(|i| law.states.get(i));
        let numbers = Numbers {
            f0: law.f0,
            a: law.a,
            b: first.map_or(f64::NAN, |state| state.b),
            d_c: first.map_or(f64::NAN, |state| state.d_c),
            v0: law.v0,
            b2: second.map(|state| state.b),
            d_c2: second.map(|state| state.d_c),
            v_m: (law.least_speed > 0.0).then_some(law.least_speed),
        };
        match law.evolution {
            Evolution::Aging => Self::Aging(numbers),
            Evolution::Slip => Self::Slip(numbers),
        }
    }
}

impl<const STATES: usize> TryFrom<RateState> for super::RateState<STATES> {
    type Error = Error;
    fn try_from(read: RateState) -> Result<Self, Error> {
        let (law, states) = match AnyStates::try_from(read)? {
            AnyStates::One(law) => (law, law.states.to_vec()),
            AnyStates::Two(law) => (law.of_states([law.states[0]]), law.states.to_vec()),
        };
        let found = states.len();
        let states = states.try_into().map_err(|_| Error::WrongSize {
            name: "state variables of a rate-and-state law",
            found,
            expected: STATES,
        })?;
        Ok(law.of_states(states))
    }
}
