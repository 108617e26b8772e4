//! Deserialization of a scaling (feature `serde`), through the checks of its constructor.

use super::Physical;
use crate::friction::read::read;

read! {
    Scaling { physical: Physical, #[serde(default)] length: Option<f64> } => {
        let scaling = Self::new(physical)?;
        // N/K unless given.
        match length {
            Some(length) => scaling.with_length(length),
            None => Ok(scaling),
        }
    };
}
