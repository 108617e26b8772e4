//! Serialization of cycles (feature `serde`).
//!
//! Cycles are written but not read. A cycle follows from its system, which can be read, and
//! computing it again takes less time than reading. Numbers from a file might also contradict the
//! law.

use serde::{Serialize, Serializer};

use super::{CycleKind, LimitCycle};
use crate::motion::{EnergyBudget, Event};
use crate::state::State;

/// The numbers and events of a cycle in their written form.
#[derive(Serialize)]
pub(super) struct WrittenCycle {
    kind: CycleKind,
    belt_velocity: f64,
    damping: f64,
    multiplier: f64,
    period: f64,
    stick_duration: f64,
    amplitude: f64,
    mean_displacement: f64,
    max_velocity: f64,
    min_velocity: f64,
    energy: EnergyBudget<f64>,
    state: State,
    events: Vec<Event>,
}

impl From<LimitCycle> for WrittenCycle {
    fn from(cycle: LimitCycle) -> Self {
        Self {
            kind: cycle.kind,
            belt_velocity: cycle.belt_velocity(),
            damping: cycle.damping,
            multiplier: cycle.multiplier,
            period: cycle.period(),
            stick_duration: cycle.stick_duration(),
            amplitude: cycle.amplitude(),
            mean_displacement: cycle.mean_displacement(),
            max_velocity: cycle.max_velocity(),
            min_velocity: cycle.min_velocity(),
            energy: cycle.energy(),
            state: cycle.state(),
            events: cycle.trajectory().events().to_vec(),
        }
    }
}

/// Writes ∞ as none, because some formats have no infinite numbers.
pub(super) fn infinite_as_none<S: Serializer>(x: &f64, to: S) -> Result<S::Ok, S::Error> {
    x.is_finite().then_some(*x).serialize(to)
}
