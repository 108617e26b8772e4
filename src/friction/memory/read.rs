//! Serialization of contact laws with memory (feature `serde`): by the arguments of their
//! constructors, and through the checks of these.

use serde::{Deserialize, Serialize};

use super::dwell::Rise;
use crate::error::Error;
use crate::friction::FrictionLaw;

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Directional<F, B> {
    forward: F,
    backward: B,
}

impl<F, B> From<super::Directional<F, B>> for Directional<F, B> {
    fn from(law: super::Directional<F, B>) -> Self {
        Self {
            forward: law.forward,
            backward: law.backward,
        }
    }
}

impl<F: FrictionLaw, B: FrictionLaw> TryFrom<Directional<F, B>> for super::Directional<F, B> {
    type Error = Error;
    fn try_from(read: Directional<F, B>) -> Result<Self, Error> {
        Self::new(read.forward, read.backward)
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Freewheel<L> {
    drag: L,
}

impl<L: FrictionLaw> TryFrom<Freewheel<L>> for super::Freewheel<L> {
    type Error = Error;
    fn try_from(read: Freewheel<L>) -> Result<Self, Error> {
        Self::new(read.drag)
    }
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct LuGre<L> {
    law: L,
    stiffness: f64,
    #[serde(default)]
    damping: f64,
    #[serde(default)]
    viscous: f64,
}

impl<L: FrictionLaw> TryFrom<LuGre<L>> for super::LuGre<L> {
    type Error = Error;
    fn try_from(read: LuGre<L>) -> Result<Self, Error> {
        Self::new(read.law, read.stiffness, read.damping, read.viscous)
    }
}
