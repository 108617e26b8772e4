//! Serialization of periodic motions, branches and sweeps (feature `serde`): they are written but
//! not read, because they can be computed from a system.

use serde::ser::SerializeStruct;
use serde::{Serialize, Serializer};

use super::attractor::Attractor;
use super::branch::{Bifurcation, Branch, BranchPoint};
use super::periodic_orbit::Orbit;
use super::sweep::{Sweep, SweepPoint};
use crate::motion::System;

impl<S: System> Serialize for Orbit<S>
where
    S::State: Serialize,
{
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

impl<S: System> Serialize for BranchPoint<S>
where
    S::State: Serialize,
{
    fn serialize<T: Serializer>(&self, to: T) -> Result<T::Ok, T::Error> {
        let mut text = to.serialize_struct("BranchPoint", 2)?;
        text.serialize_field("parameter", &self.parameter)?;
        text.serialize_field("orbit", &self.orbit)?;
        text.end()
    }
}

impl<S: System> Serialize for Bifurcation<S>
where
    S::State: Serialize,
{
    fn serialize<T: Serializer>(&self, to: T) -> Result<T::Ok, T::Error> {
        let mut text = to.serialize_struct("Bifurcation", 3)?;
        text.serialize_field("parameter", &self.parameter)?;
        text.serialize_field("kind", &self.kind.to_string())?;
        text.serialize_field("orbit", &self.orbit)?;
        text.end()
    }
}

impl<S: System> Serialize for Branch<S>
where
    S::State: Serialize,
{
    fn serialize<T: Serializer>(&self, to: T) -> Result<T::Ok, T::Error> {
        let ends = self.ends.each_ref().map(|end| format!("{end:?}"));
        let mut text = to.serialize_struct("Branch", 3)?;
        text.serialize_field("points", &self.points)?;
        text.serialize_field("bifurcations", &self.bifurcations)?;
        text.serialize_field("ends", &ends)?;
        text.end()
    }
}

impl<S: System> Serialize for Attractor<S>
where
    S::State: Serialize,
{
    fn serialize<T: Serializer>(&self, to: T) -> Result<T::Ok, T::Error> {
        let mut text = to.serialize_struct("Attractor", 2)?;
        text.serialize_field("kind", &self.kind())?;
        text.serialize_field("orbit", &self.orbit())?;
        text.end()
    }
}

impl<S: System> Serialize for SweepPoint<S>
where
    S::State: Serialize,
{
    fn serialize<T: Serializer>(&self, to: T) -> Result<T::Ok, T::Error> {
        let error = self.attractor.as_ref().err().map(ToString::to_string);
        let mut text = to.serialize_struct("SweepPoint", 3)?;
        text.serialize_field("parameter", &self.parameter)?;
        text.serialize_field("attractor", &self.attractor.as_ref().ok())?;
        text.serialize_field("error", &error)?;
        text.end()
    }
}

impl<S: System> Serialize for Sweep<S>
where
    S::State: Serialize,
{
    fn serialize<T: Serializer>(&self, to: T) -> Result<T::Ok, T::Error> {
        let mut text = to.serialize_struct("Sweep", 3)?;
        text.serialize_field("up", &self.up)?;
        text.serialize_field("down", &self.down)?;
        text.serialize_field("stopped", &self.stopped)?;
        text.end()
    }
}
