// | file | what is in it |
// |---|---|
// | `find.rs` | `find`, `stick_slip`: cycles of all three kinds |
// | `basin.rs` | `attractor`, `basins`: the attractor of a start |
// | `arc.rs` | slip arcs, up to contact or a velocity maximum |
// | `release.rs` | the motion from the release point: cycles that stick |
// | `peaks.rs` | the map of velocity maxima: pure-slip cycles (how close two may lie: `numerics/roots_with_slopes.rs`) |
// | `crossings.rs` | the map of downward crossings: crossing cycles |
// | `growth.rs` | the growth of a map over one period, as a sample |
// | `averaged.rs` | growth by averaging, if one period changes a motion by less than rounding does |
// | `continuum.rs` | families of periodic motions |
// | `set.rs` | `CycleSet`: the nested cycles of a system |
// | `cycle.rs` | `LimitCycle`, `CycleKind`: arcs joined to one period |
// | `measures.rs` | extremes, harmonics and energies of a cycle |
// | `written.rs` | serialization of cycles (feature `serde`) |

//! Limit cycles of one mass on its belt, found exactly and without transients.
//!
//! ```
//! use stick_slip::limit_cycle::{self, Attractor};
//! use stick_slip::{CycleKind, Exponential, MassOnBelt, State};
//!
//! let law = Exponential::new(0.6, 0.3, 0.4)?;
//! let system = MassOnBelt::new(law, 1.0)?.with_damping(0.01)?;
//!
//! // Every limit cycle: an unstable pure-slip cycle inside a stable stick-slip cycle.
//! let cycles = limit_cycle::find(&system)?;
//! let [inner, outer] = cycles.as_slice() else { panic!() };
//! assert_eq!((inner.kind(), inner.is_stable()), (CycleKind::PureSlip, false));
//! assert_eq!((outer.kind(), outer.is_stable()), (CycleKind::StickSlip, true));
//! assert!((outer.period() - 6.44421345231177).abs() < 1e-13);
//! assert!((outer.amplitude() - 1.19163699374785).abs() < 1e-13);
//! assert!((outer.stick_duration() - 0.99824663777958).abs() < 1e-13);
//!
//! // Steady sliding is stable, but a larger perturbation leads to stick-slip.
//! let reached = |v| limit_cycle::attractor(&system, State::new(0.31, v));
//! assert_eq!(reached(0.0)?, Attractor::Equilibrium);
//! assert!(matches!(reached(0.9)?, Attractor::Cycle(cycle) if cycle == *outer));
//! # Ok::<(), stick_slip::Error>(())
//! ```
//!
#![doc = include_str!("../figures/bistability.svg")]
//!
//! *Cycles of the law of this program over the belt velocity; dashed cycles are unstable. (a) At
//! velocities above the Hopf point, steady sliding and stick-slip are both stable. An unstable
//! cycle lies between them; it meets stick-slip at a grazing, where both end. (b) With more
//! damping, stick-slip changes into pure slip, which ends in a fold.*
//!
//! | question | answer |
//! |---|---|
//! | all limit cycles, stable and unstable, within [stated limits](#what-is-guaranteed) | [`find`] |
//! | the stick-slip cycle alone | [`stick_slip`] |
//! | the attractor reached from one start, or from many | [`attractor`], [`basins`](basins()) |
//! | period, extremes, harmonics, energies, trajectory of a cycle | [`LimitCycle`] |
//! | the velocities at which cycles appear and disappear | [`bifurcation`](crate::bifurcation) |
//!
//! # Kinds of cycles
//!
//! The motion of the mass is a flow in the plane of displacement u and velocity v, and trajectories
//! in a plane cannot cross. At a belt velocity v_b > 0 every periodic motion is therefore of one of
//! three kinds. (The motions for v_b < 0 are mirror images. At v_b = 0 only free vibration with
//! neither damping nor kinetic friction is periodic.)
//!
//! * The motion **sticks**. Stick ends at the release point. From this point one slip arc leads
//!   back to stick or, if the mass overtakes the belt, two successive slip arcs do. The motion is
//!   stable, with Floquet multiplier 0 ([`CycleKind::StickSlip`], [`CycleKind::Overshoot`]).
//! * The motion stays **slower than the belt** and encircles the equilibrium. Its velocity maximum
//!   is a fixed point of the map from one velocity maximum to the next ([`CycleKind::PureSlip`]).
//! * The motion **crosses** the belt velocity twice a period and never sticks. Its downward
//!   crossing is a fixed point of the map from one downward crossing to the next
//!   ([`CycleKind::Crossing`]).
//!
//! The divergence of the flow gives the derivatives of both maps. β is the damping ratio, γ² the
//! friction load, and μ̂(s) the kinetic coefficient at the sliding speed s. v_r = v − v_b is the
//! relative velocity. Its rate v_r' is taken just before and just after each crossing of the belt
//! velocity. The Floquet multiplier of a cycle that never sticks is
//!
//! ```text
//! exp(−∮(2β + γ² dμ̂/ds) dτ) · Π v_r'(after)/v_r'(before)   (Π: over all crossings)
//! ```
//!
//! # What is guaranteed
//!
//! [`stick_slip`] is complete: because trajectories cannot cross, the cases that it distinguishes
//! are all possible cases. [`find`] searches for zeros of the growth over one period, P(x)/x − 1,
//! for each of the two maps P. x is the peak velocity or, for crossing cycles, the contact force at
//! the downward crossing. The range of x is divided until the cubic through values and slopes of
//! the growth fits, and divided further wherever that cubic comes near zero. A pair of cycles is
//! lost only if their values of x differ by less than 10⁻⁹ of the range, or if the growth has two
//! extrema inside an interval in which its cubic fits to 2 %. Two kinds of cycles are not searched
//! for: pure-slip cycles with a peak velocity below 10⁻⁴ v_b, and crossing cycles with x above
//! 16(γ²μ_s + |v_b|), where μ_s is the static coefficient. Some unstable cycles repel so strongly
//! that a motion from the floating-point number next to the cycle is far from the cycle after one
//! period. Double precision cannot resolve these cycles, and their ranges are reported as
//! [`unresolved`](CycleSet::unresolved).
//!
//! A motion may change over one period by less than the rounding error. This happens under weak
//! friction with nearly no damping, or on a belt whose speed is far below γ²μ_s. The growth of such
//! a motion is taken from the equation of [`averaging`](crate::analysis::averaging). The sign of
//! this growth is certain if the growth exceeds the bound of the higher-order terms. Otherwise the
//! range of x is also reported as unresolved. [`guarantees`](crate::guarantees#completeness) names
//! the tests.

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
pub(crate) use peaks::PeakMap;
pub(crate) use release::Release;
pub use set::CycleSet;
