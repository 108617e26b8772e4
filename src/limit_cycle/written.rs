//! How cycles are written (feature `serde`).
//!
//! Cycles are written and not read: a cycle follows from its system, which is read, and is made
//! again from it in less time than reading takes. What could be read would be numbers that no law
//! vouches for.

use serde::{Serialize, Serializer};

use super::{CycleKind, EnergyBudget, LimitCycle};
use crate::motion::Event;
use crate::state::State;

/// The numbers of a cycle.
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
    energy: EnergyBudget,
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

/// ∞ as nothing: some formats have no infinite numbers.
pub(super) fn infinite_as_none<S: Serializer>(x: &f64, to: S) -> Result<S::Ok, S::Error> {
    x.is_finite().then_some(*x).serialize(to)
}
