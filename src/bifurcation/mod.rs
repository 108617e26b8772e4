//! Bifurcations: the belt velocities, loads, dampings or coefficients at which periodic motions
//! appear, disappear or change their kind.
//!
//! | function | what happens there |
//! |---|---|
//! | [`hopf_velocities`] | the equilibrium loses or regains stability, and a pure-slip cycle is born; [`criticality`] tells which |
//! | [`grazing_velocities`] | stick-slip appears or disappears: the motion from the release point comes back to the belt tangentially |
//! | [`touching_velocities`] | a pure-slip cycle touches the belt velocity, and appears or disappears |
//! | [`fold_velocities`] | a stable and an unstable pure-slip cycle meet |
//! | [`overshoot_velocities`] | the mass begins to overtake the belt before it sticks |
//! | [`crossing_velocities`] | the mass no longer sticks at all |
//! | [`vibration_ranges`] | what the mass can settle to becomes another; bistable ranges are named |
//! | [`silencing_damping`] | with this damping or more no vibration lasts, at one belt velocity |
//! | [`silencing_load`] | with this load or less no vibration lasts, at one belt velocity |
//!
//! Every velocity is a root of an exact function of the belt velocity, bracketed and refined to
//! round-off. The documentation of each function tells how densely it searches a range; a narrower
//! range is searched more closely. Negative velocities are searched as they are: they give the
//! mirror image.
//!
//! [`along`] searches any other parameter in the same ways: a load, a damping, a coefficient of the
//! law. Its methods, and those of [`along_velocities`], can be bounded and watched; what a search
//! costs stands at [`Along`].
//!
//! [`analysis`](crate::analysis) has closed forms of some of these velocities for some laws.
//!
//! [`diagram`] lists the equilibrium and all cycles for each of a list of belt velocities.
//!
//! | file | what is in it |
//! |---|---|
//! | `along.rs` | [`Along`]: the family of systems, the range, the bound of the work and the watcher |
//! | `contacts.rs` | grazing, overshoot, crossing: contacts of the motion from the release point; touching of pure-slip cycles; searched by `numerics/scan.rs` |
//! | `fold.rs` | folds of pure-slip cycles |
//! | `hopf.rs` | where stability changes, and which cycle is born there; belt velocities are found in `friction/along.rs` |
//! | `ranges.rs` | what can happen in which range |
//! | `silence.rs` | the least damping and the largest load with which nothing vibrates |
//! | `diagram.rs` | equilibrium and all cycles at each of a list of belt velocities |

mod along;
mod contacts;
mod diagram;
mod fold;
mod hopf;
mod ranges;
mod silence;

pub use along::{Along, Progress, along, along_velocities};
pub use contacts::{
    crossing_velocities, grazing_velocities, overshoot_velocities, touching_velocities,
};
#[cfg(feature = "rayon")]
pub use diagram::par_diagram;
pub use diagram::{DiagramPoint, diagram};
pub use fold::fold_velocities;
pub use hopf::{Criticality, criticality, hopf_velocities};
pub use ranges::{AttractorKind, VibrationRange, vibration_ranges};
pub use silence::{silencing_damping, silencing_load};
