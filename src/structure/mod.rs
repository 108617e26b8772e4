//! Several masses on springs and dampers, driven in time, with friction contacts.
//!
//! | file | what is in it |
//! |---|---|
//! | `contact.rs` | [`Contact`]: where, which law, its normal load and the belt under it |
//! | `read.rs` | how structures are written and read (feature `serde`) |
//! | `system.rs` | [`Structure`]: masses, springs, dampers, forces and contacts |
//! | `steady.rs` | [`SteadySliding`]: all masses at rest on moving belts, and how motions near it go |
//! | `sparse.rs` | a matrix without its zeros |
//! | `engine.rs` | one step of a motion, as a paragraph; the state, its start |
//! | `model.rs`, `parts.rs` | what is constant; what is known of each coordinate and contact |
//! | `laws.rs` | the laws of all contacts behind one trait object |
//! | `expansion.rs` | the power series of all coordinates, order by order |
//! | `settle.rs` | how long a step is, and which events end it at one time |
//! | `slow.rs` | the slow motion of stiff bristles |
//! | `defect.rs` | whether the series hold between their coefficients |
//! | `decide.rs` | which contacts slip, stick or open after an event |
//! | `flow.rs`, `step.rs` | steps one after the other, as values |

mod contact;
mod decide;
mod defect;
mod engine;
mod expansion;
mod flow;
pub(crate) mod laws;
pub(crate) mod model;
mod parts;
#[cfg(feature = "serde")]
mod read;
mod settle;
mod slow;
pub(crate) mod sparse;
mod steady;
mod step;
mod system;

pub use contact::Contact;
pub use flow::Flow;
pub use steady::SteadySliding;
pub use step::Step;
pub use system::Structure;

pub use crate::error::Element;
pub use crate::state::structure::State;
