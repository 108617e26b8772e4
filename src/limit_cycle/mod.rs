//! Periodic motions of the mass on its belt, found exactly and without transients.
//!
//! The motion of the mass is a flow in the plane (u, v), and trajectories in a plane can't cross.
//! So for v_b > 0 every periodic motion is one of three kinds. (v_b < 0 is the mirror image; at
//! v_b = 0 only free vibration without friction is periodic.)
//!
//! * The motion **sticks**. Then it leaves stick at the release point: it is found from the one or
//!   two slip arcs out of that point, and it attracts with multiplier 0 ([`CycleKind::StickSlip`],
//!   [`CycleKind::Overshoot`]).
//! * The motion stays **behind the belt**. Then it turns round the equilibrium: it is a fixed point
//!   of the map from one velocity maximum to the next ([`CycleKind::PureSlip`]).
//! * The motion **crosses** the belt velocity twice a period and never sticks: it is a fixed point
//!   of the map from one downward crossing to the next ([`CycleKind::Crossing`]).
//!
//! The divergence of the flow gives the derivatives of both maps. For a cycle that never sticks
//!
//! ```text
//! multiplier = exp(−∮(2β + γ² dμ̂/ds) dτ) · Π v_r'(after)/v_r'(before) over its crossings.
//! ```
//!
//! # What is guaranteed
//!
//! [`stick_slip`] is complete: because trajectories can't cross, there are no other cases than
//! those that it tells apart. [`find`] divides the range of each map until the cubic through values
//! and slopes fits, and then keeps dividing wherever that cubic comes near a fixed point. It loses
//! a pair of cycles only if their peak velocities differ by less than 10⁻⁹ of the range, or if the
//! map turns twice inside an interval in which its cubic fits to 2 %. Pure-slip cycles with a peak
//! velocity below 10⁻⁴ v_b are not looked for, nor crossing cycles with forces above 16(γ²μ_s +
//! |v_b|). Some cycles repel so strongly that motions from two neighbouring numbers, one on each
//! side, end far away: double precision can't resolve these cycles, and their ranges are reported
//! as [`unresolved`](CycleSet::unresolved).
//!
//! One turn may change a motion by less than rounding does (weak friction, nearly no damping, a
//! belt far slower than γ²μ_s). Then its growth is taken from the averaged equation, Eq. 12 for any
//! law. The sign of this growth is certain if it exceeds what the next orders can add; where it is
//! not certain, the range is unresolved too.
//!
//! | file | what is in it |
//! |---|---|
//! | `find.rs` | [`find`], [`stick_slip`]: cycles of all three kinds |
//! | `basin.rs` | [`attractor`], [`basins`]: which cycle a start reaches |
//! | `arc.rs` | slip arcs, to the next place where the fate of the motion is decided |
//! | `release.rs` | what the motion from the release point does: cycles that stick |
//! | `peaks.rs` | the map of velocity maxima: pure-slip cycles (how close two may lie: `numerics/with_slopes.rs`) |
//! | `crossings.rs` | the map of downward crossings: crossing cycles |
//! | `growth.rs` | a map's growth over a turn as a sample |
//! | `averaged.rs` | growth by averaging, where a turn changes a motion by less than rounding does |
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
pub use find::{find, stick_slip};
pub(crate) use find::{find_all, find_moving};
pub use measures::EnergyBudget;
pub(crate) use peaks::PeakMap;
pub(crate) use release::Release;
pub use set::CycleSet;
