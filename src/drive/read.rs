//! Deserialization of drives (feature `serde`) through the checks of their constructors.

use serde::Deserialize;

use super::Harmonic;
use crate::error::Error;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Drive {
    #[serde(default)]
    constant: f64,
    #[serde(default)]
    harmonics: Vec<Harmonic>,
    #[serde(default)]
    profiles: Vec<Vec<(f64, f64)>>,
}

impl TryFrom<Drive> for super::Drive {
    type Error = Error;
    fn try_from(read: Drive) -> Result<Self, Error> {
        Self::read(read.constant, &read.harmonics, &read.profiles)
    }
}
