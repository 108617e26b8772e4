//! Periodic motions, exactly and without transients.
//!
//! The motion of the mass is a flow in the plane (u, v), and trajectories in a plane can't cross.
//! For v_b > 0 (v_b < 0 is its mirror image, and at v_b = 0 nothing is periodic but free vibration
//! without friction) every periodic motion is one of three:
//!
//! * it **sticks**, and then leaves stick at the release point: so it is found from the one or two
//!   slip arcs out of that point, and attracts with multiplier 0 ([`CycleKind::StickSlip`],
//!   [`CycleKind::Overshoot`]);
//! * it stays **behind the belt**, and then turns round the equilibrium: a fixed point of the map
//!   from one velocity maximum to the next ([`CycleKind::PureSlip`]);
//! * it **crosses** the belt velocity twice a period without sticking: a fixed point of the map
//!   from one downward crossing to the next ([`CycleKind::Crossing`]).
//!
//! Both maps are known with their derivatives, by the divergence of the flow: for a cycle that
//! never sticks
//!
//! ```text
//! multiplier = exp(−∮(2β + γ² dμ̂/ds) dτ) · Π v_r'(after)/v_r'(before) over its crossings.
//! ```
//!
//! # What is guaranteed
//!
//! [`stick_slip`] is complete: trajectories that can't cross leave no other possibility than those
//! that it tells apart. [`find`] divides the range of each map until the cubic through values and
//! slopes fits, and then keeps dividing wherever that cubic comes near a fixed point. It loses a
//! pair of cycles only if their peak velocities differ by less than 10⁻⁹ of the range, or if the
//! map turns twice inside an interval in which its cubic fits to 2 %. Pure-slip cycles with a peak
//! velocity below 10⁻⁴ v_b are not looked for, nor crossing cycles with forces above 16(γ²μ_s +
//! |v_b|). Cycles that double precision can't resolve, because neighbouring numbers lie on
//! different sides of them by far, are reported as [`unresolved`](CycleSet::unresolved).
//!
//! Where a turn changes a motion by less than rounding does (weak friction, nearly no damping, a
//! belt far slower than γ²μ_s), its growth is taken from the averaged equation, Eq. 12 for any law,
//! whose sign is certain where it exceeds what the next orders can add. Where it is not certain,
//! that range is unresolved too.
//!
//! | file | what is in it |
//! |---|---|
//! | `find.rs` | [`find`], [`stick_slip`]: the three kinds put together |
//! | `basin.rs` | [`attractor`], [`basins`]: which of them a start reaches |
//! | `arc.rs` | slip arcs, to the next place where something is decided |
//! | `release.rs` | what the motion from the release point does: cycles that stick |
//! | `peaks.rs` | the map of velocity maxima: pure-slip cycles |
//! | `crossings.rs` | the map of downward crossings: crossing cycles |
//! | `growth.rs` | a map's growth over a turn as a sample |
//! | `averaged.rs` | the growth of small changes, where rounding hides it over a turn |
//! | `continuum.rs` | families of periodic motions |
//! | `set.rs` | [`CycleSet`]: the nested cycles of a system |
//! | `cycle.rs` | [`LimitCycle`], [`CycleKind`]: arcs joined to one period |
//! | `measures.rs` | extremes, harmonics and energies ([`EnergyBudget`]) of a cycle |
//! | `written.rs` | how cycles are written (feature `serde`) |

mod arc;
mod averaged;
mod basin;
mod continuum;
mod crossings;
mod cycle;
mod find;
mod growth;
mod measures;
mod peaks;
mod release;
mod set;
#[cfg(test)]
mod testing;
#[cfg(feature = "serde")]
mod written;

pub(crate) use arc::Tracer;
pub use basin::{Attractor, Basins, attractor, basins};
pub use continuum::Continuum;
pub(crate) use continuum::is_frictionless;
pub use cycle::{CycleKind, LimitCycle};
pub(crate) use find::find_borrowed;
pub use find::{find, stick_slip};
pub use measures::EnergyBudget;
pub(crate) use peaks::PeakMap;
pub(crate) use release::Release;
pub use set::CycleSet;
