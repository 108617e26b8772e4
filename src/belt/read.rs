//! Deserialization of a system (feature `serde`) through the checks of its constructors.

use serde::Deserialize;

use crate::error::Error;
use crate::friction::FrictionLaw;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct MassOnBelt<L> {
    law: L,
    belt_velocity: f64,
    #[serde(default)]
    damping: f64,
    #[serde(default = "one")]
    load: f64,
}

fn one() -> f64 {
    1.0
}

impl<L: FrictionLaw> TryFrom<MassOnBelt<L>> for super::MassOnBelt<L> {
    type Error = Error;
    fn try_from(read: MassOnBelt<L>) -> Result<Self, Error> {
        Self::new(read.law, read.belt_velocity)?
            .with_damping(read.damping)?
            .with_load(read.load)
    }
}
