//! One mass on one belt of constant velocity: the planar system and its engine.

// | file | what is in it |
// |---|---|
// | `system.rs` | `MassOnBelt`, the system for users |
// | `model.rs` | `Belt`, for the engines: forces, the stick band, the outcome of an arrival |
// | `forward.rs` | `Forward`: a system whose belt moves forward |
// | `equilibrium.rs` | steady sliding and its stability |
// | `slip_point.rs` | how each kind of slip begins (the power series of slip: `friction/slip_series.rs`) |
// | `slow_manifold.rs` | the power series of the slow manifold in a stiff slip phase (tried by `stepper.rs`; from which stiffness on: `motion/step_control.rs`) |
// | `defect.rs` | the residual of the equation of motion, and where it is checked |
// | `breakpoints.rs` | pieces of the law, and where a step leaves one |
// | `stepper.rs` | one Taylor step: begin, plan (explicit or slow), settle, land |
// | `flow.rs` | the sequence of stick and slip phases: which phase follows which |
// | `step.rs` | `Step`: a part of a motion; how a stick phase becomes one |
// | `read.rs`, `written.rs` | how a system is read, and an equilibrium written (feature `serde`) |

mod breakpoints;
mod criticality;
mod defect;
mod equilibrium;
mod flow;
mod forward;
mod model;
#[cfg(feature = "serde")]
mod read;
mod slip_point;
mod slow_manifold;
mod step;
mod stepper;
mod system;
#[cfg(feature = "serde")]
mod written;

pub use criticality::Criticality;
pub use equilibrium::{Equilibrium, Jacobian, Stability};
pub use flow::Flow;
pub(crate) use forward::Forward;
pub(crate) use model::{Belt, Landing};
pub(crate) use slip_point::Start;
pub use step::Step;
pub(crate) use stepper::{Advance, Stepper};
pub use system::MassOnBelt;
