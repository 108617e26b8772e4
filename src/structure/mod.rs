//! Several masses on springs and dampers, driven in time, with friction contacts.
//!
//! | file | what is in it |
//! |---|---|
//! | `contact.rs` | [`Contact`]: where, which law, its normal load and the belt under it |
//! | `system.rs` | [`Structure`]: masses, springs, dampers, forces and contacts |
//! | `steady.rs` | [`SteadySliding`]: all masses at rest on moving belts, and how motions near it go |
//! | `sparse.rs` | a matrix without its zeros |

mod contact;
mod sparse;
mod steady;
mod system;

pub use contact::Contact;
pub use steady::SteadySliding;
pub use system::Structure;

pub use crate::error::Element;
pub use crate::state::structure::State;
