//! Periodic motions of any system.
//!
//! | file | what is in it |
//! |---|---|
//! | `oscillator.rs` | [`Oscillator`]: what the searches need of a system |
//! | `linear.rs` | the equations linearised along one step: derivatives of the laws as power series |
//! | `tangent.rs` | the tangent flow: small changes, carried along by the steps of the motion |
//! | `saltation.rs` | what events do to small changes: one formula for all |
//! | `map.rs` | the map over one period, with its derivative |
//! | `multipliers.rs` | the eigenvalues of that derivative |
//! | `shoot.rs` | [`shoot`], [`settle`]: Newton's method for the fixed points of the map |
//! | `found.rs` | [`Orbit`]: a periodic motion and what it is like |
//! | `section.rs` | [`section`], [`section_at`]: Poincaré sections |
//! | `lyapunov.rs` | [`lyapunov`]: the largest Lyapunov exponent |

mod found;
mod linear;
mod lyapunov;
mod map;
mod multipliers;
mod oscillator;
mod saltation;
mod section;
mod shoot;
mod tangent;

pub use found::Orbit;
pub use lyapunov::{LyapunovExponent, lyapunov, lyapunov_with_spread};
pub use oscillator::Oscillator;
pub use section::{EventSection, Section, section, section_at};
pub use shoot::{Period, settle, shoot};
