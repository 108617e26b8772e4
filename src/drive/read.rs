//! Deserialization of drives (feature `serde`) through the checks of their constructors.

use std::fmt;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Error as _, MapAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::{Drive, Harmonic};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Sum {
    #[serde(default)]
    constant: f64,
    #[serde(default)]
    harmonics: Vec<Harmonic>,
    #[serde(default)]
    profiles: Vec<Vec<(f64, f64)>>,
}

impl<'de> Deserialize<'de> for Drive {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NumberOrSum)
    }
}

/// By hand, for an untagged enum would lose what is wrong in a map.
struct NumberOrSum;

impl<'de> Visitor<'de> for NumberOrSum {
    type Value = Drive;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a drive: a number, or a map of `constant`, `harmonics`, `profiles`")
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<Drive, E> {
        Drive::read(value, &[], &[]).map_err(E::custom)
    }

    fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<Drive, E> {
        self.visit_f64(value as f64)
    }

    fn visit_u64<E: serde::de::Error>(self, value: u64) -> Result<Drive, E> {
        self.visit_f64(value as f64)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Drive, A::Error> {
        let sum = Sum::deserialize(MapAccessDeserializer::new(map))?;
        Drive::read(sum.constant, &sum.harmonics, &sum.profiles).map_err(A::Error::custom)
    }
}
