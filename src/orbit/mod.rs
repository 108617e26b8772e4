// | file | what is in it |
// |---|---|
// | `type_erased_system.rs` | a system without the type of its laws, for all searches |
// | `oscillator.rs` | `Oscillator`: the systems that the searches take |
// | `period.rs`, `shooting_residual.rs` | `Period`; one trial of a search |
// | `translation.rs` | translations that no force depends on, up to which motions are periodic |
// | `coefficient.rs`, `variational_equations.rs`, `elements.rs` | coefficients of the variational equations along one step, as power series; those of force elements |
// | `perturbation_series.rs` | power series of several perturbations, side by side |
// | `stiff_perturbations.rs` | those of a motion on a slow manifold |
// | `tangent.rs` | the tangent flow: the variational equations along a trajectory |
// | `constant_coefficient_flow.rs` | steps with the same constant coefficients, which one matrix exponential carries |
// | `saltation.rs` | saltation matrices of events: one formula for all |
// | `flow_direction.rs` | perturbations along an autonomous motion that creeps, kept apart from all others |
// | `period_map.rs`, `period_map/run.rs` | the period map with its derivative, the monodromy matrix; runs that compute it |
// | `time_integration.rs` | motions over a duration without derivatives |
// | `course.rs` | the motion of a result, computed again when it is asked for |
// | `unslipped.rs` | contacts that never slip, or by rounding only, which make a motion one of a family |
// | `family.rs` | the directions of a continuous family of motions |
// | `multipliers.rs` | the eigenvalues of the monodromy matrix |
// | `shoot.rs` | `shoot`, `settle`: Newton's method for the fixed points of the map |
// | `written.rs` | serialization of the results (feature `serde`) |
// | `attractor.rs`, `sweep.rs` | what a motion settles to; the same as a parameter rises and falls |
// | `ranges` | `vibration_ranges`: the attractors over a range of a parameter: the search (`mod.rs`), whether motions are the same (`same_motion.rs`), the results (`found.rs`) |
// | `periodic_orbit.rs` | `Orbit`: a periodic motion with its events, extremes and multipliers |
// | `measures.rs` | the extremes, means and energies of an `Orbit`, from its steps |
// | `follow.rs` | `follow`: continuation of a motion over a parameter |
// | `branch.rs` | `Branch`: the result of `follow` |
// | `branch_equations.rs` | the equations with the parameter as one more unknown; Newton's method across the curve |
// | `branch_predictor.rs` | the curve near one of its points |
// | `pseudo_arclength.rs` | steps along the curve, and its ends |
// | `work.rs` | the motions tried along a curve, counted and bounded |
// | `bifurcations.rs` | bifurcations between two points of the curve: folds, flips, tori, changes of the event sequence |
// | `event_change_bracket.rs` | the two sides of a change of events, brought together in few motions |
// | `nonsmooth_fold.rs` | branches that turn back at a change of the event sequence |
// | `half_map.rs` | symmetric motions: the map over half a period |
// | `pitchfork.rs` | pitchforks of symmetric motions |
// | `branch_switching.rs` | `Bifurcation::switch`: the branch that crosses at a flip or a pitchfork |
// | `lost_symmetry.rs` | symmetries in time that motions beside a branch have, and its motions lack |
// | `phase_condition.rs` | where motions start: away from events, and the phase condition of autonomous ones |
// | `prescribed_modes.rs`, `watched_event.rs` | motions with a contact held past a touch, which are smooth there; events that are watched |
// | `hopf.rs` | steady sliding along a parameter; `begin`: the motions born at a Hopf point |
// | `hopf_point.rs` | the eigenvalues of steady sliding; the Hopf point near a value of the parameter |
// | `discontinuity.rs` | motions that jump at a change of the event sequence, which ends the branch |
// | `locus` | curves of bifurcations in two parameters: the search (`mod.rs`, `directions.rs`), what all curves are (`curve_of_motions.rs`), the motions (`motions.rs`), folds, flips, pitchforks and tori (`smooth_equations.rs`), their scalars (`bordered.rs`) and special points (`special.rs`), changes of events (`event_equations.rs`, which one: `change.rs`), the tangential end of a branch (`tangential_end.rs`), the results (`found.rs`) |
// | `event_sequence.rs` | the events of a period as a cyclic sequence |
// | `poincare.rs` | `section`, `section_at`, `section_through`: Poincaré sections |
// | `sensitivity` | `sensitivities`, `orbit_sensitivities`: derivatives by parameters (`mod.rs`), from differences (`differences.rs`) between motions with the same events, in any order if they happen at one instant (`neighbour.rs`) |
// | `lyapunov.rs` | `lyapunov`: the largest Lyapunov exponent |

//! Periodic motions of any system ([`MassOnBelt`](crate::MassOnBelt) or
//! [`Structure`](crate::Structure)), with all their Floquet multipliers. Each motion is found from
//! a guess, a state near the motion, and is exact to rounding. The module also computes branches of
//! periodic motions over a parameter, Poincaré sections, and the largest Lyapunov exponent.
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
//! // Simulate a transient, then find the periodic motion. Its period is that of the force.
//! let orbit = orbit::settle(&forced, &State::at_rest(1), 100.0, Period::Driven(1))?;
//! let kinds: Vec<String> = orbit.events().iter().map(|event| event.kind.to_string()).collect();
//! assert_eq!(kinds, ["release (lagging)", "stick"]);
//! assert!((orbit.extremes(0).1 - 0.5884147960427818).abs() < 1e-14);
//!
//! // The mass sticks, so one multiplier is 0.
//! let [first, second] = orbit.multipliers() else { panic!() };
//! assert!((first.re - 0.09088860389457677).abs() < 1e-13);
//! assert_eq!(second.norm(), 0.0);
//! assert!(orbit.is_stable());
//! # Ok::<(), stick_slip::Error>(())
//! ```
//!
#![doc = include_str!("../figures/resonance.svg")]
//!
//! *Amplitude of a mass on a belt over the frequency of the force, computed by [`follow`]. Dashed
//! lines are unstable motions; rings are folds.*
//!
//! # Which search for which system
//!
//! | system and question | search | what it promises |
//! |---|---|---|
//! | [`MassOnBelt`](crate::MassOnBelt): every periodic motion | [`limit_cycle::find`](crate::limit_cycle::find) | every motion, within [stated limits](crate::limit_cycle#what-is-guaranteed) |
//! | `MassOnBelt`: the attractor reached from a start | [`limit_cycle::attractor`](crate::limit_cycle::attractor), [`basins`](crate::limit_cycle::basins()) | the attractor, within these limits |
//! | `MassOnBelt`: parameters at which motions appear and vanish | [`bifurcation`](crate::bifurcation) | each function states how densely it searches |
//! | any system: the motion near a guess, stable or not | [`shoot`] | one motion, exact to rounding, or a typed error |
//! | any system: the periodic motion after a transient from a start | [`settle`] | one motion, exact to rounding, or a typed error |
//! | any system: the attractor that a start reaches, and its kind | [`classify`] | the attractor of that start |
//! | any system: attractors as a parameter rises and falls, with hysteresis | [`sweep`] | the attractors reached; each motion starts from the last state of the motion before |
//! | any system: a branch of motions over a parameter, its bifurcations and its ends | [`follow`] | the connected branch; two bifurcations of the same kind within a step can be missed |
//! | any system: the attractors over a range, with the critical values between them | [`vibration_ranges`] | the attractors on branches that a sweep, motions from rest or Hopf points reach |
//! | any system: the motion that is born at a Hopf point of steady sliding | [`begin`] | one small motion |
//! | any system: the branch that is born at a flip or a pitchfork | [`Bifurcation::switch`] | one motion on this branch |
//! | any system: the curve of a bifurcation over two parameters | [`locus`] | the connected curve; two special points of the same kind within a step can be missed |
//! | any system: derivatives of a motion with respect to parameters, for fits | [`sensitivities`], [`orbit_sensitivities`] | an error of about 1e-11 of the largest derivative, or a typed error |
//! | any system: Poincaré sections | [`section`], [`section_at`], [`section_through`] | the points of one motion |
//! | any system: the largest Lyapunov exponent, positive in chaos | [`lyapunov`], [`lyapunov_with_spread`] | a mean with its standard error |
//!
//! The motions of one mass on a belt of constant velocity lie in the phase plane and cannot cross
//! each other, so a search can be complete. With a varying force, a second mass or a memory
//! variable, the motions do not lie in a plane, and a search returns one motion near its guess. To
//! explore such a system, start [`settle`] from many states and plot sections. For a mass on a
//! belt, `limit_cycle` and `orbit` give the same numbers.
//!
//! One call of [`shoot`], [`settle`] or [`lyapunov`] takes at most 10⁶ integration steps, which are
//! 10⁴ to 10⁵ oscillations. These steps take seconds for one mass and 10 to 20 s for three masses.
//! A call that needs more steps returns a typed error. The page of [`follow`] states the bound for
//! a branch. [`Search`] sets other bounds. It also accepts a watcher, a function that can stop the
//! search. The page of `Search` states the cost of each search.
//!
//! # Autonomous and forced motions
//!
//! A [`Drive`](crate::Drive) is a force, a load or a belt velocity as a function of time. If a
//! drive of a structure varies in time, the motion is forced. Its period is n common periods of the
//! drives ([`Period::Driven`]), and its start is the state at time 0. If all drives are constant,
//! the system is autonomous: the motion may begin anywhere on its orbit, and its period is unknown
//! ([`Period::Free`]). A phase condition then fixes the start: the start lies on the plane through
//! the guess, normal to the flow x' at the guess (x: state). The guess may lie in a stick phase. If
//! the contact that sticks is a [`Dwell`](crate::Dwell) contact, its memory variable in the guess
//! must be the time since the beginning of stick.
//!
//! # Motions that are translated
//!
//! A shaft that turns, or a chain of masses that no spring holds to the ground, can be displaced as
//! a whole without changing any force. With the stiffness matrix K of the
//! [`Structure`](crate::Structure), there is then a direction e with K e = 0, and no normal load
//! depends on displacements along e. Let q be the displacements and v the velocities. Motions of
//! this system can be periodic up to a translation φ e with a number φ:
//!
//! ```text
//! q(T) = q(0) + φ e,    v(T) = v(0),
//! ```
//!
//! The search finds φ together with the motion. The mean velocity is φ e/T
//! ([`Orbit::mean_velocity`]). All searches detect the directions e themselves. There may be
//! several directions, for example if only contacts and dampers connect several shafts. The
//! position of the start along e is that of the guess. If C e = 0 for the damping matrix C, and b·e
//! = 0 for the direction b of each contact, no force depends on the velocity along e either. The
//! mean velocity is then that of the motion from the guess, because the momentum is conserved.
//!
//! ```
//! use stick_slip::orbit::{self, Period};
//! use stick_slip::{Contact, Drive, Exponential, Structure, structure::State};
//!
//! // A shaft of two inertias, free to turn, with a motor at one end and friction at the other.
//! let shaft = Structure::new(&[1.0, 0.5])?
//!     .with_spring(0, 1, 4.0)?
//!     .with_force(0, Drive::constant(10.6))?
//!     .with_ground_damper(0, 20.0)?
//!     .with_contact(Contact::new(1, Exponential::new(0.8, 0.4, 0.5)?, 1.0)?)?;
//! let start = State::new(&[0.0, 0.0], &[0.5, 0.5]);
//! let orbit = orbit::settle(&shaft, &start, 200.0, Period::Free(3.0))?;
//! assert!((orbit.mean_velocity(0) - 0.5).abs() < 0.05);
//! // In each period the shaft turns by the angle φ, and the torque does the work 10.6 φ.
//! let angle = orbit.mean_velocity(0) * orbit.period();
//! assert!((orbit.energy().force_work[0] - 10.6 * angle).abs() < 1e-13 * 10.6 * angle);
//! # Ok::<(), stick_slip::Error>(())
//! ```
//!
//! The motion is periodic in the frame that moves at the mean velocity Ω. In this frame a surface
//! of velocity w has the velocity w − Ω. The page
//! [`structure`](crate::structure#frames-that-move-at-a-varying-speed) lists what else the
//! equations of motion contain in such a frame.
//!
//! # Multipliers
//!
//! The period map leads from the state at the start of a period to the state at its end. Its
//! derivative is the monodromy matrix. Between events this matrix solves the variational equations,
//! by power series with the exact derivatives of every law. At each event it is multiplied by a
//! saltation matrix. The eigenvalues of the monodromy matrix are the Floquet multipliers μ: a small
//! perturbation along an eigenvector is multiplied by μ in each period.
//!
//! * In stick the perturbation of the velocity vanishes: if k contacts stick at the same time, at
//!   least k multipliers are exactly 0. An exception is static friction that rises during stick:
//!   its memory variable contains the duration of stick, and the motion may have no multiplier 0.
//! * An autonomous motion has a multiplier 1, because a shift of its start along the orbit neither
//!   grows nor decays. [`Orbit::multipliers`] does not contain this multiplier.
//! * A [translation](#motions-that-are-translated) has the multiplier 1. A velocity along e on
//!   which no force depends has the multiplier 1, too. [`Orbit::multipliers`] does not contain
//!   these multipliers either.
//! * A memory variable that does not influence the motion has the multiplier 0.
//! * If a contact never slips, or if the motion conserves a quantity, the motion belongs to a
//!   continuous family. [`Orbit::families`] lists its directions, [`Orbit::unslipped`] the contacts
//!   that never slip. [`Orbit::multipliers`] does not contain the multipliers 1 of these contacts,
//!   but those of other families. The member that a search finds conserves the momentum, the energy
//!   and the like of its start: see [`shoot`].
//!
//! The period map has no derivative at grazing. If several contacts have events at the same
//! instant, it has a derivative if their order does not matter. This holds for elements in
//! parallel, for a contact that slips because another one sticks, and for masses that stop or slip
//! at the same instant and are connected by springs only. It does not hold if one event changes the
//! time of another: for example, a mass that slips pulls on another one by a damper. For
//! simultaneous events, the delay of each event is computed from the perturbation and the flow just
//! before all of them. The matrix is then the derivative, if a derivative exists.
//!
//! Source of the saltation matrices: R. I. Leine, H. Nijmeijer, *Dynamics and Bifurcations of
//! Non-Smooth Mechanical Systems*, Springer 2004, ch. 7.

mod attractor;
mod bifurcations;
mod branch;
mod branch_equations;
mod branch_predictor;
mod branch_switching;
mod coefficient;
mod constant_coefficient_flow;
mod course;
mod discontinuity;
mod elements;
mod event_change_bracket;
mod event_sequence;
mod family;
mod flow_direction;
mod follow;
mod half_map;
mod hopf;
mod hopf_point;
mod locus;
mod lost_symmetry;
mod lyapunov;
mod measures;
mod multipliers;
mod nonsmooth_fold;
mod oscillator;
mod period;
mod period_map;
mod periodic_orbit;
mod perturbation_series;
mod phase_condition;
mod pitchfork;
mod poincare;
mod prescribed_modes;
mod pseudo_arclength;
mod ranges;
mod saltation;
mod sensitivity;
mod shoot;
mod shooting_residual;
mod springs;
mod stiff_perturbations;
mod sweep;
mod tangent;
mod time_integration;
mod translation;
mod type_erased_system;
mod unslipped;
mod variational_equations;
mod watched_event;
mod work;
#[cfg(feature = "serde")]
mod written;

pub use crate::belt::Criticality;
pub use attractor::{Attractor, classify};
pub use branch::{Bifurcation, BifurcationKind, Branch, BranchEnd, BranchPoint};
pub use follow::follow;
pub use hopf::begin;
pub use locus::found::{Locus, LocusEnd, LocusKind, LocusPoint, SpecialKind, SpecialPoint};
pub use locus::locus;
pub use lyapunov::{LyapunovExponent, lyapunov, lyapunov_with_spread};
pub use oscillator::Oscillator;
pub(crate) use oscillator::{FamilyOfTwo, member};
pub use period::Period;
pub use periodic_orbit::Orbit;
pub use poincare::{
    EventSection, Passage, Section, SpeedSection, section, section_at, section_through,
};
pub use ranges::{Border, VibrationRange, VibrationRanges, vibration_ranges};
pub use sensitivity::{
    EventSensitivity, OrbitSensitivities, Sensitivities, orbit_sensitivities, sensitivities,
};
pub use shoot::{settle, shoot};
pub use sweep::{Change, Sweep, SweepPoint, sweep};

pub use crate::error::NotDifferentiable;
pub use crate::motion::AttractorKind;
pub use crate::search::{Progress, Search};
