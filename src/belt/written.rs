//! Serialization of an equilibrium (feature `serde`).
//!
//! An equilibrium is written but not read. To get it back, read its system and compute it again.

use serde::Serialize;

use super::Stability;

#[derive(Serialize)]
pub(super) struct Equilibrium {
    displacement: f64,
    /// h1.
    effective_damping: f64,
    stability: Stability,
}

impl From<super::Equilibrium> for Equilibrium {
    fn from(equilibrium: super::Equilibrium) -> Self {
        Self {
            displacement: equilibrium.displacement,
            effective_damping: -equilibrium.jacobian[(1, 1)],
            stability: equilibrium.stability,
        }
    }
}
