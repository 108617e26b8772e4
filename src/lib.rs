//! Friction-induced vibration of a mass on a moving belt.
#![forbid(unsafe_code)]

pub mod analysis;
pub mod bifurcation;
mod error;
mod friction;
mod integrator;
pub mod limit_cycle;
mod quadrature;
#[cfg(feature = "serde")]
mod raw;
mod scalar;
mod scaling;
mod system;

pub use error::{Error, Reached};
pub use friction::{
    AnyLaw, Coulomb, Exponential, FrictionLaw, Polynomial, Rational, Stribeck, Tabulated,
};
pub use integrator::{Event, EventKind, Flow, Integrator, Mode, Step, Trajectory};
pub use limit_cycle::{CycleKind, CycleSet, EnergyBudget, LimitCycle};
pub use nalgebra;
pub use scalar::Scalar;
pub use scaling::{Physical, Scaled, Scaling};
pub use system::{Direction, Equilibrium, MassOnBelt, Stability, State};
