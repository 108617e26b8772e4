//! Periodic motions of any system, exact to rounding: found from a guess, with all their Floquet
//! multipliers; Poincaré sections; the largest Lyapunov exponent.
//!
//! ```
//! use stick_slip::orbit::{self, Period};
//! use stick_slip::structure::State;
//! use stick_slip::{Contact, Drive, Polynomial, Structure};
//!
//! // A mass on a belt under a harmonic force.
//! let contact = Contact::new(0, Polynomial::new(0.4, 0.25, 0.5)?, 1.0)?.on_belt(0.2);
//! let forced = Structure::new(&[1.0])?
//!     .with_ground_spring(0, 1.0)?
//!     .with_ground_damper(0, 0.1)?
//!     .with_force(0, Drive::harmonic(0.15, 0.8, 0.0)?)?
//!     .with_contact(contact)?;
//!
//! // Follow it for a while, then find the motion of the force's period that it tends to.
//! let orbit = orbit::settle(&forced, &State::at_rest(1), 100.0, Period::Driven(1))?;
//! let kinds: Vec<String> = orbit.events().iter().map(|event| event.kind.to_string()).collect();
//! assert_eq!(kinds, ["release (lagging)", "stick"]);
//! assert!((orbit.extremes(0).1 - 0.5884147960427818).abs() < 1e-14);
//!
//! // It sticks: one multiplier is 0.
//! let [first, second] = orbit.multipliers() else { panic!() };
//! assert!((first.re - 0.09088860389457677).abs() < 1e-13);
//! assert_eq!(second.norm(), 0.0);
//! assert!(orbit.is_stable());
//! # Ok::<(), stick_slip::Error>(())
//! ```
//!
//! # Which search for which system
//!
//! | system and question | search | what it promises |
//! |---|---|---|
//! | [`MassOnBelt`](crate::MassOnBelt): every periodic motion | [`limit_cycle::find`](crate::limit_cycle::find) | complete, but for [pairs that lie very close together](crate::limit_cycle#what-is-guaranteed) |
//! | `MassOnBelt`: what a start leads to | [`limit_cycle::attractor`](crate::limit_cycle::attractor), [`basins`](crate::limit_cycle::basins()) | complete, likewise |
//! | `MassOnBelt`: where motions appear and vanish | [`bifurcation`](crate::bifurcation) | as dense as each function says |
//! | any system: the motion near a guess, stable or not | [`shoot`] | one motion, exact to rounding, or a typed error |
//! | any system: what a start settles to | [`settle`] | likewise |
//! | any system: how a motion changes over a parameter, where it bifurcates, and where it ends | [`follow`] | what is connected with it, but for two bifurcations of one kind within a step |
//! | any system: whether a motion is periodic at all | [`section`], [`section_at`] | a picture |
//! | any system: whether a motion is chaotic | [`lyapunov`], [`lyapunov_with_spread`] | a mean with its standard error |
//!
//! The motions of one mass on a belt of constant velocity lie in a plane and cannot cross each
//! other: so a search can be complete. With a force, a second mass or a memory they can, and a
//! search follows its guess. Which motions there are, only guesses can tell: start [`settle`] from
//! many places, and look at sections. For a belt both ways give the same numbers.
//!
//! One call of [`shoot`], [`settle`] or [`lyapunov`] takes at most 10⁶ steps in all: about 10⁵
//! oscillations, seconds for a few masses. Beyond, it ends in
//! [`Error::TooManySteps`](crate::Error::TooManySteps), with the time and state reached. A branch
//! has [a bound of its own](follow).
//!
//! # Free and driven
//!
//! A structure with a drive that varies has motions of n periods of its drives,
//! [`Period::Driven`], and their state is that at time 0. Where all drives are constant a motion
//! may begin anywhere on itself, and its period is unknown: [`Period::Free`]. The state is then on
//! the section through the guess normal to the flow there. Where all masses stick to belts that
//! move, the flow is the belts' motion; a guess in mid-stick is as good as any, but a
//! [`Dwell`](crate::Dwell) contact needs the time since which it sticks in its memory.
//!
//! A motion that repeats itself up to a translation, as that of a drill string which turns on and
//! on, is periodic in the frame that moves with it: let the ground be what turns at the mean
//! velocity, and the belts move at its negative.
//!
//! # Multipliers
//!
//! The monodromy matrix is the derivative of the state after a period with respect to the state
//! before. Between events it follows the equations of motion linearised along the motion, by power
//! series on the same steps, with the derivatives of every law from the law as it is written; at
//! events a saltation matrix jumps (see the source, `saltation.rs`). Its eigenvalues are the
//! Floquet multipliers μ: a small disturbance is multiplied by μ in each period.
//!
//! * Stick forgets the velocity: at least as many multipliers are 0, to the bit, as contacts stick
//!   at one time. Static friction that rises at rest remembers when it stuck, and so a motion that
//!   sticks may have none.
//! * A free motion has the multiplier 1, of a shift along itself. It is left out.
//! * Numbers of the memory on which nothing depends have the multiplier 0.
//! * Where a motion is one of a continuous family another multiplier is 1, and the motion nearest
//!   the guess is found.
//!
//! Where a motion only touches an event (grazing), or where several events happen at one instant,
//! the map has no derivative; what is given there is that of the events in the order of the
//! contacts.
//!
//! Source: for saltation, R. I. Leine, H. Nijmeijer, *Dynamics and Bifurcations of Non-Smooth
//! Mechanical Systems*, Springer 2004, ch. 7.
//!
//! # Files
//!
//! | file | what is in it |
//! |---|---|
//! | `form.rs` | a system as the searches see it |
//! | `period.rs`, `trial.rs` | [`Period`]; a start that is tried |
//! | `oscillator.rs` | [`Oscillator`]: what the searches need of a system, without the type of its laws |
//! | `linear.rs` | the equations linearised along one step: derivatives of the laws as power series |
//! | `tangent.rs` | the tangent flow: small changes, carried along by the steps of the motion |
//! | `saltation.rs` | what events do to small changes: one formula for all |
//! | `map.rs` | the map over one period, with its derivative |
//! | `multipliers.rs` | the eigenvalues of that derivative |
//! | `shoot.rs` | [`shoot`], [`settle`]: Newton's method for the fixed points of the map |
//! | `found.rs` | [`Orbit`]: a periodic motion and what it is like |
//! | `follow.rs` | [`follow`]: a motion followed over a parameter |
//! | `branch.rs` | [`Branch`]: what is found so |
//! | `curve.rs` | the equations with the parameter as one more unknown; Newton's method across the curve |
//! | `walk.rs` | steps along the curve, and where it ends |
//! | `changes.rs` | what happens between two points of the curve: folds, flips, tori, other events |
//! | `corner.rs` | where the curve turns back as the events change |
//! | `jump.rs` | where the motion itself jumps as the events change, and the curve ends |
//! | `sequence.rs` | the events of a period as a cyclic sequence |
//! | `section.rs` | [`section`], [`section_at`]: Poincaré sections |
//! | `lyapunov.rs` | [`lyapunov`]: the largest Lyapunov exponent |

mod branch;
mod changes;
mod corner;
mod curve;
mod follow;
mod form;
mod found;
mod jump;
mod linear;
mod lyapunov;
mod map;
mod multipliers;
mod oscillator;
mod period;
mod saltation;
mod section;
mod sequence;
mod shoot;
mod tangent;
mod trial;
mod walk;

pub use branch::{Bifurcation, BifurcationKind, Branch, BranchEnd, BranchPoint};
pub use follow::follow;
pub use found::Orbit;
pub use lyapunov::{LyapunovExponent, lyapunov, lyapunov_with_spread};
pub use oscillator::Oscillator;
pub use period::Period;
pub use section::{EventSection, Section, section, section_at};
pub use shoot::{settle, shoot};
