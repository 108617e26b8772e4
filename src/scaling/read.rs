//! Deserialisation of a scaling (feature `serde`), through the checks of its constructor.

use serde::Deserialize;

use super::Physical;
use crate::error::Error;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Scaling {
    physical: Physical,
    /// N/K unless given.
    #[serde(default)]
    length: Option<f64>,
}

impl TryFrom<Scaling> for super::Scaling {
    type Error = Error;
    fn try_from(Scaling { physical, length }: Scaling) -> Result<Self, Error> {
        let scaling = Self::new(physical)?;
        match length {
            Some(length) => scaling.with_length(length),
            None => Ok(scaling),
        }
    }
}
