//! Serialization of periodic motions and attractors (feature `serde`): they are written but not
//! read, because they can be computed from a system.

use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use super::attractor::Attractor;
use super::periodic_orbit::Orbit;
use super::sweep::SweepPoint;
use crate::error::Error;
use crate::motion::SystemState;

impl<S: SystemState + Serialize> Serialize for Orbit<S> {
    fn serialize<T: Serializer>(&self, to: T) -> Result<T::Ok, T::Error> {
        let coordinates = 0..self.coordinates();
        let extremes = |of: fn(&Self, usize) -> (f64, f64)| -> Vec<(f64, f64)> {
            coordinates.clone().map(|i| of(self, i)).collect()
        };
        let multipliers = self.multipliers().iter();
        let multipliers: Vec<[f64; 2]> = multipliers.map(|m| [m.re, m.im]).collect();
        let mut text = to.serialize_struct("Orbit", 9)?;
        text.serialize_field("period", &self.period())?;
        text.serialize_field("is_stable", &self.is_stable())?;
        text.serialize_field("multipliers", &multipliers)?;
        let mean_velocities = coordinates.clone().map(|i| self.mean_velocity(i));
        let mean_velocities: Vec<f64> = mean_velocities.collect();
        text.serialize_field("mean_velocities", &mean_velocities)?;
        text.serialize_field("extremes", &extremes(Self::extremes))?;
        text.serialize_field("velocity_extremes", &extremes(Self::velocity_extremes))?;
        text.serialize_field("energy", self.energy())?;
        text.serialize_field("state", &self.state())?;
        text.serialize_field("events", self.events())?;
        text.end()
    }
}

impl<S: SystemState + Serialize> Serialize for Attractor<S> {
    fn serialize<T: Serializer>(&self, to: T) -> Result<T::Ok, T::Error> {
        let mut text = to.serialize_struct("Attractor", 2)?;
        text.serialize_field("kind", &self.kind())?;
        text.serialize_field("orbit", &self.orbit())?;
        text.end()
    }
}

impl<S: SystemState + Serialize> Serialize for SweepPoint<S> {
    fn serialize<T: Serializer>(&self, to: T) -> Result<T::Ok, T::Error> {
        let error = self.attractor.as_ref().err().map(ToString::to_string);
        let mut text = to.serialize_struct("SweepPoint", 3)?;
        text.serialize_field("parameter", &self.parameter)?;
        text.serialize_field("attractor", &self.attractor.as_ref().ok())?;
        text.serialize_field("error", &error)?;
        text.end()
    }
}

/// An error in words.
pub(super) fn in_words<T: Serializer>(error: &Error, to: T) -> Result<T::Ok, T::Error> {
    to.collect_str(error)
}
