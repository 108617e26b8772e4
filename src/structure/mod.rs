//! Several masses on springs and dampers, driven in time, with friction on belts and between them.

mod contact;
pub(crate) mod engine;
mod flow;
#[cfg(feature = "serde")]
mod read;
mod steady;
mod step;
mod system;

pub use contact::Contact;
pub use flow::Flow;
pub use steady::SteadySliding;
pub use step::Step;
pub use system::Structure;

pub use crate::error::{Element, NotSliding};
pub use crate::state::structure::State;
