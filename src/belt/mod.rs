//! One mass on one belt of constant velocity: the planar system and its engine.

// | file | what is in it |
// |---|---|
// | `system.rs` | `MassOnBelt`: what users see of a system |
// | `model.rs` | `Belt`: what the engines see; forces, the stick band, what follows an arrival |
// | `forward.rs` | `Forward`: a system whose belt moves forward |
// | `equilibrium.rs` | steady sliding and its stability |
// | `slip_point.rs` | how each kind of slip begins (the power series of slip: `friction/slip.rs`) |
// | `slow.rs` | the power series of the slow motion in a stiff slip phase (tried by `stepper.rs`; from which stiffness on: `motion/step_control.rs`) |
// | `defect.rs` | whether a series holds between its coefficients, and where that is looked at |
// | `breakpoints.rs` | pieces of the law, and where a step leaves one |
// | `stepper.rs` | one Taylor step: begin, plan (explicit or slow), settle, land |
// | `flow.rs` | the phase machine: which phase follows which |
// | `step.rs` | `Step`: a stretch of motion as a value; how a stick phase becomes one |
// | `read.rs`, `written.rs` | how a system is read, and an equilibrium written (feature `serde`) |

mod breakpoints;
mod defect;
mod equilibrium;
mod flow;
mod forward;
mod model;
#[cfg(feature = "serde")]
mod read;
mod slip_point;
mod slow;
mod step;
mod stepper;
mod system;
#[cfg(feature = "serde")]
mod written;

pub use equilibrium::{Equilibrium, Stability};
pub use flow::Flow;
pub(crate) use forward::Forward;
pub(crate) use model::{Belt, Landing};
pub(crate) use slip_point::Start;
pub use step::Step;
pub(crate) use stepper::{Advance, Stepper};
pub use system::MassOnBelt;
