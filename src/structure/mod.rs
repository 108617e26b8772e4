// | file | what is in it |
// |---|---|
// | `system.rs`, `matrices.rs` | `Structure`, the system for users; checks of its matrices |
// | `first_order.rs` | `FirstOrder`, a first-order state: an integral, a current, a filter |
// | `force_element.rs` | `ForceElement`, a nonlinear spring, damper or force of several coordinates |
// | `stop.rs` | `Stop`, a spring with a damper behind a gap |
// | `contact.rs`, `elastic.rs` | `Contact` and its checks; elastic contacts and normal springs |
// | `direction.rs` | checks of directions |
// | `engine` | one step of a motion |
// | `flow.rs`, `step.rs`, `sample.rs` | the motion step by step; `Step`; samples with forces |
// | `trigger.rs` | `EventData`, `Trigger`: the conditions of the events at the end of a step |
// | `carried.rs` | `Carried`: the friction force of a contact, or its range |
// | `mechanism.rs` | `Mechanism`: a way in which contacts at rest can begin to slip |
// | `energy.rs` | energies, work and heat |
// | `steady_sliding.rs`, `sliding_field` | steady sliding and its eigenvalues; the equations near it |
// | `steady_sliding.rs` | steady sliding at given velocities |
// | `equilibrium_newton.rs` | its displacements, by Newton's method where forces are nonlinear |
// | `freedom.rs` | directions in which a structure can be moved without any change of a force |
// | `stability_changes.rs` | stability of steady sliding while drives vary slowly |
// | `read.rs` | how structures are written and read (feature `serde`) |

//! Several masses with springs, dampers and forces, and with friction on belts and between masses.
//!
//! ```
//! use stick_slip::orbit::{self, Period};
//! use stick_slip::structure::State;
//! use stick_slip::{Contact, Coulomb, Drive, Element, EventKind, Exponential, Structure};
//!
//! // Mass 0 rubs on a belt, a force shakes mass 1; a spring and a friction joint couple them.
//! let belt = Contact::new(0, Exponential::new(0.4, 0.25, 0.3)?, 1.0)?.on_belt(0.2);
//! let joint = Contact::between(0, 1, Coulomb::new(0.3, 0.2)?, 0.5)?;
//! let blocks = Structure::new(&[1.0, 1.0])?
//!     .with_ground_spring(0, 1.0)?
//!     .with_ground_damper(0, 0.1)?
//!     .with_spring(0, 1, 1.2)?
//!     .with_force(1, Drive::harmonic(0.5, 0.8, 0.0)?)?
//!     .with_contact(belt)?
//!     .with_contact(joint)?;
//!
//! // The motion from rest, with every event: the joint slips when mass 0 sticks to the belt.
//! let motion = blocks.simulate(State::at_rest(2), 50.0)?;
//! let [stick, release, ..] = motion.events() else { panic!() };
//! assert_eq!((stick.element, stick.kind), (Element::Contact(0), EventKind::Stick));
//! assert_eq!(release.element, Element::Contact(1));
//! assert_eq!(release.kind.to_string(), "release (lagging)");
//! assert!((stick.time - 0.474696005111476).abs() < 1e-14);
//! assert_eq!(release.time, stick.time);
//! assert_eq!(motion.last().velocities[0], 0.2);
//!
//! // The periodic motion that follows has the period of the force and 7 events, and is stable.
//! let orbit = orbit::settle(&blocks, &State::at_rest(2), 200.0, Period::Driven(1))?;
//! assert_eq!(orbit.events().len(), 7);
//! assert!((orbit.extremes(1).1 - 0.97596429903251).abs() < 1e-12);
//! assert!((orbit.multipliers()[0].norm() - 0.676730557953).abs() < 1e-10);
//! # Ok::<(), stick_slip::Error>(())
//! ```
//!
#![doc = include_str!("../figures/mode_coupling.svg")]
//!
//! *Small motions of a brake about steady sliding: frequencies and growth rates as functions of the
//! friction coefficient μ, computed by [`Structure::steady_sliding`]. Without dampers two modes
//! merge at μ = 0.75, and one of them grows at larger μ. With dampers growth begins at μ = 0.7575.*
//!
//! | question | answer |
//! |---|---|
//! | which masses, springs, dampers and forces | [`Structure`], its methods `with_…`; full matrices by [`with_mass_matrix`](Structure::with_mass_matrix), [`with_stiffness`](Structure::with_stiffness), [`with_damping`](Structure::with_damping) |
//! | where friction acts, with which friction law and normal load | [`Contact`]: on a belt or the ground, between two coordinates, along any direction |
//! | friction by direction, freewheels, ropes around a drum | [`Directional`](crate::Directional), [`Contact::freewheel`] |
//! | elastic joints, normal springs that open | [`Contact::with_tangential_stiffness`], [`Contact::with_normal_spring`] |
//! | a hard spring, pendulum, gear play, snap-through, nonlinear damper | [`ForceElement`], with a law of the crate ([`PolynomialSpring`](crate::PolynomialSpring), [`Pendulum`](crate::Pendulum), [`Backlash`](crate::Backlash), [`SnapThrough`](crate::SnapThrough), [`VanDerPol`](crate::VanDerPol), [`TabulatedForce`](crate::TabulatedForce)) or your own [`ForceLaw`](crate::ForceLaw) |
//! | a stop, impacts, a loose gear with damping | [`Stop`], with spring and damper; for a rigid stop see [its page](Stop#rigid-stops) |
//! | a stiffness that varies in time: gear mesh, Mathieu's equation | [`ForceElement::with_factor`] |
//! | a controller | proportional: [`with_stiffness`](Structure::with_stiffness), [`with_damping`](Structure::with_damping), with unsymmetric matrices; with an integral or a filter: [`FirstOrder`]; nonlinear: a [`ForceField`](crate::ForceField) of what it measures |
//! | a motor's current, an actuator, a Maxwell damper | [`FirstOrder`] |
//! | a force, load or belt velocity that varies in time | [`Drive`](crate::Drive); a chirp, a shock or a window: [`Drive::function`](crate::Drive::function) |
//! | the motion from a start, with all events | [`Structure::simulate`] |
//! | a motion with a tolerance, a stop condition, or in constant memory | [`Integrator`](crate::Integrator) |
//! | friction forces and accelerations in a state | [`Structure::carried`], [`Structure::acceleration`]; sampled along a motion: [`Structure::samples`] |
//! | which contacts at rest can slip next, together, and how much is left | [`Structure::mechanisms`] |
//! | energies; work and heat of every force, contact and damper along a motion | [`Structure::energy_budget`], [`Structure::kinetic_energy`], [`Structure::elastic_energy`] |
//! | steady sliding, its eigenvalues, flutter | [`Structure::steady_sliding`]; at given velocities, with joints that stick, without rigid-body modes: [`Structure::steady_sliding_at`] |
//! | where steady sliding becomes unstable along a speed profile, and why vibration begins later | [`Structure::stability_changes`] |
//! | periodic motions, multipliers, bifurcations, chaos | [`orbit`](crate::orbit) |
//!
//! The equations, and what they do not cover, are on the page of
//! [`Structure`](Structure#what-is-not-covered).
//!
//! Stiffnesses and damping constants may be negative. With a negative damping constant, or with a
//! damping matrix whose symmetric part has a negative eigenvalue, motions can grow without bound.
//! This is not an error: the linear terms of an aerodynamic force or of a follower force may have
//! this sign. When you fit a damping constant, bound it from below by 0. (The damping of a
//! [`MassOnBelt`](crate::MassOnBelt), and that of a [`Physical`](crate::Physical) system, must not
//! be negative.)
//!
//! # Frames that move at a varying speed
//!
//! Coordinates may be measured in a frame that rotates (or travels) with the velocity Ω(t), for
//! example in the frame of the rotary table of a drill string. Displacements then stay small. Let
//! e_i be 1 for each coordinate that is measured in the frame and 0 for the others, M the mass
//! matrix, and b the direction of a contact. The equations of motion keep their form, with these
//! additions:
//!
//! | in the frame | add |
//! |---|---|
//! | inertia | a force −(M e)_i Ω'(t) on each coordinate i |
//! | a damper c between rotating coordinate i and a part that does not rotate | the damper to the ground, and a force −c Ω(t) on coordinate i |
//! | a contact with a part that does not rotate, or with a surface of velocity w | a surface of velocity w(t) − (b·e) Ω(t) |
//! | springs, dampers and contacts between rotating coordinates (b·e = 0) | nothing |
//! | a spring or damper between a rotating coordinate and the frame itself | that spring or damper, to the ground |
//!
//! ```
//! use stick_slip::{Contact, Coulomb, Drive, Structure, structure::State};
//!
//! // A bit of 400 kg m² on a pipe of 800 N m/rad. The rotary table speeds up from 6 rad/s to
//! // 12 rad/s between 10 s and 40 s: Ω' = 0.2 rad/s². The mud around the bit brakes the bit.
//! let (inertia, pipe, mud, rock) = (400.0, 800.0, 300.0, 500.0);
//! let table = |factor: f64| Drive::profile(&[(10.0, factor * 6.0), (40.0, factor * 12.0)]);
//! let speeds_up = [(10.0, 0.0), (10.0, -inertia * 0.2), (40.0, -inertia * 0.2), (40.0, 0.0)];
//! let bit = Structure::new(&[inertia])?
//!     .with_ground_spring(0, pipe)? // to the table
//!     .with_ground_damper(0, mud)?
//!     .with_force(0, Drive::profile(&speeds_up)?)?
//!     .with_force(0, table(-mud)?)?
//!     .with_contact(Contact::new(0, Coulomb::new(0.5, 0.5)?, rock)?.on_belt(table(-1.0)?))?;
//! let motion = bit.simulate(State::at_rest(1), 80.0)?;
//!
//! // Rock and mud twist the pipe, and so does the bit's inertia while the table speeds up.
//! let twist = |time| -motion.state_at(time).unwrap().displacements[0];
//! let steady = |speed: f64| (0.5 * rock + mud * speed) / pipe;
//! assert!((twist(10.0) - steady(6.0)).abs() < 1e-1);
//! assert!((twist(80.0) - steady(12.0)).abs() < 1e-5);
//! let behind = mud * 0.2 / pipe; // the lag of the bit behind the ramp, in rad/s
//! let expected = steady(12.0) + inertia * 0.2 / pipe - mud * behind / pipe;
//! assert!((twist(40.0) - expected).abs() < 1e-4);
//! # Ok::<(), stick_slip::Error>(())
//! ```
//!
//! The state and the step of a structure are [`State`] and [`Step`] of this module. The state and
//! the step of one mass on a belt are [`crate::State`] and [`crate::Step`]. Any consistent units
//! may be used.

mod carried;
mod contact;
mod direction;
mod elastic;
mod energy;
pub(crate) mod engine;
mod equilibrium_newton;
mod first_order;
mod flow;
mod force_element;
pub(crate) mod freedom;
mod matrices;
mod mechanism;
#[cfg(feature = "serde")]
mod read;
mod sample;
pub(crate) mod sliding_field;
mod stability_changes;
mod steady_sliding;
mod step;
mod stop;
mod system;
mod trigger;

pub use carried::Carried;
pub use contact::Contact;
pub(crate) use energy::Energies;
pub use first_order::FirstOrder;
pub use flow::Flow;
pub use force_element::ForceElement;
pub use mechanism::Mechanism;
pub use sample::Sample;
pub use stability_changes::StabilityChange;
pub use steady_sliding::SteadySliding;
pub use step::Step;
pub use stop::Stop;
pub use system::Structure;
pub(crate) use trigger::Trigger;

pub use crate::error::{Element, NotSliding};
pub use crate::state::structure::State;
