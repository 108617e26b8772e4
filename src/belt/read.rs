//! Deserialization of a system (feature `serde`) through the checks of its constructors.

use crate::friction::read::read;

read! {
    MassOnBelt<L> {
        law: L, belt_velocity: f64,
        #[serde(default)] damping: f64, #[serde(default = "one")] load: f64
    } => Self::new(law, belt_velocity)?.with_damping(damping)?.with_load(load);
}

fn one() -> f64 {
    1.0
}
