//! One mass on one belt of constant velocity: the planar system, and the engine that follows it.
//!
//! | file | what is in it |
//! |---|---|
//! | `system.rs` | [`MassOnBelt`]: parameters, forces, the stick band, what follows an arrival |
//! | `forward.rs` | [`Forward`]: a system whose belt moves forward, its law borrowed |
//! | `equilibrium.rs` | steady sliding and its stability |
//! | `slip_point.rs` | points of slip phases, and how each kind of slip begins |
//! | `expansion.rs` | the power series of a slip phase |
//! | `slow.rs` | the power series of the slow motion in a stiff slip phase (tried by `stepper.rs`; from which stiffness on: `motion/step_control.rs`) |
//! | `defect.rs` | whether a series holds between its coefficients, and where that is looked at |
//! | `breakpoints.rs` | pieces of the law, and where a step leaves one |
//! | `stepper.rs` | one Taylor step: begin, plan (explicit or slow), settle, land |
//! | `flow.rs` | the phase machine: which phase follows which |
//! | `step.rs` | [`Step`]: a stretch of motion as a value; how a stick phase becomes one |
//! | `read.rs`, `written.rs` | how a system is read, and an equilibrium written (feature `serde`) |

mod breakpoints;
mod defect;
mod equilibrium;
mod expansion;
mod flow;
mod forward;
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
pub(crate) use slip_point::{SlipPoint, Start};
pub use step::Step;
pub(crate) use stepper::{Advance, Stepper};
pub(crate) use system::Landing;
pub use system::MassOnBelt;
