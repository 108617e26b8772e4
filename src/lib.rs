//! Friction-induced vibration of a mass on a moving belt.
#![warn(missing_docs)]

mod error;
mod friction;
mod integrator;
mod scalar;
mod system;

pub use error::{Error, Reached};
pub use friction::{Coulomb, Exponential, FrictionLaw, Polynomial};
pub use integrator::{Event, EventKind, Flow, Integrator, Mode, Step, Trajectory};
pub use nalgebra;
pub use scalar::Scalar;
pub use system::{Direction, Equilibrium, MassOnBelt, Stability, State};
