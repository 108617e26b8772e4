//! Friction-induced vibration, computed to round-off.
//!
//! For a mass on a moving belt the crate finds every stick (the belt catches the mass), every
//! release (the belt lets it go), every crossing (the mass passes the belt's velocity without
//! sticking), every limit cycle, and the belt velocities at which cycles appear. The friction law
//! can be any that you can write as a function. The motion of several masses, with friction on
//! belts and between the masses, under forces and on belts that vary in time, is followed as
//! exactly, and their [periodic motions](orbit) are found from a guess.
//!
//! ```
//! use stick_slip::{MassOnBelt, Polynomial, State, limit_cycle};
//!
//! // μ_s, the least coefficient and the sliding speed at which it lies; v_b; β; γ² = 1.
//! let law = Polynomial::new(0.4, 0.25, 0.5)?;
//! let system = MassOnBelt::new(law, 0.2)?.with_damping(0.05)?;
//!
//! // From rest: carried along by the belt, released, caught again.
//! let motion = system.simulate(State::new(0.0, 0.0), 10.0)?;
//! let kinds: Vec<String> = motion.events().iter().map(|event| event.kind.to_string()).collect();
//! assert_eq!(kinds, ["stick", "release (lagging)", "stick", "release (lagging)"]);
//!
//! // The motion it settles to, without a transient.
//! let cycle = limit_cycle::stick_slip(&system)?.ok_or("no stick-slip")?;
//! assert!((cycle.period() - 6.799421444472158).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Which function do I need?
//!
//! | question | answer |
//! |---|---|
//! | how the mass moves from a given start, and when it sticks | [`MassOnBelt::simulate`], then [`Trajectory::events`], [`state_at`](Trajectory::state_at), [`sample`](Trajectory::sample) |
//! | how the mass moves, without an end and in constant memory | [`Integrator::flow`] |
//! | how the mass moves until something happens | [`Integrator::simulate_until`] |
//! | how the mass moves, with a looser tolerance or more steps | [`Integrator::with_tolerance`], [`Integrator::with_max_steps`] |
//! | everything that the mass can settle to | [`limit_cycle::find`] |
//! | the stick-slip motion alone | [`limit_cycle::stick_slip`] |
//! | what the mass settles to from a given start | [`limit_cycle::attractor`]; from many, [`limit_cycle::basins`] |
//! | period, extremes, accelerations, harmonics, energies of a periodic motion | [`LimitCycle`] |
//! | whether steady sliding is stable | [`MassOnBelt::equilibrium`] |
//! | the belt velocity at which steady sliding becomes stable | [`bifurcation::hopf_velocities`], [`bifurcation::criticality`] |
//! | the belt velocity at which stick-slip appears or disappears | [`bifurcation::grazing_velocities`] |
//! | the belt velocity at which a pure-slip cycle touches the belt velocity, and appears or disappears | [`bifurcation::touching_velocities`] |
//! | the belt velocity at which a cycle changes its kind | [`bifurcation::overshoot_velocities`], [`bifurcation::crossing_velocities`] |
//! | the belt velocity at which a stable and an unstable cycle meet and vanish | [`bifurcation::fold_velocities`] |
//! | all cycles over a range of belt velocities, for a picture | [`bifurcation::diagram`] |
//! | what can happen at which belt velocity, bistable ranges too | [`bifurcation::vibration_ranges`] |
//! | the load, the damping or the coefficient of a law at which any of this happens | [`bifurcation::along`] |
//! | under how much load the mass stays quiet | [`bifurcation::silencing_load`] |
//! | how much damping keeps the mass quiet | [`bifurcation::silencing_damping`]; at every belt velocity, [`analysis::design`] |
//! | the formulas of the source paper, and better ones | [`analysis::PureSlip`], [`analysis::StickSlip`], [`analysis::averaging`]; [where the paper is wrong](analysis#where-the-source-paper-is-wrong) |
//! | how several masses move, with forces and belts that vary in time | [`Structure`], [`Contact`], [`Drive`] |
//! | how masses rub on each other: clutch, bolted joint, blade damper, pad on a disc | [`Contact::between`], [`Contact::along`]; the force in it: [`Structure::carried`] |
//! | a reduced finite-element model, with a full mass matrix | [`Structure::with_mass_matrix`], [`Contact::along`] its mode shapes |
//! | whether several masses slide steadily, or flutter | [`Structure::steady_sliding`] |
//! | a periodic motion of any system, with its multipliers | [`orbit::shoot`], [`orbit::settle`] |
//! | how a periodic motion changes over any parameter | [`orbit::follow`] |
//! | whether a motion is chaotic | [`orbit::lyapunov`], [`orbit::section`] |
//! | how to work in kilograms, newtons, metres and hertz | [`PhysicalMassOnBelt`], [`Scaling`]; a [`Structure`] takes any consistent units |
//! | a friction law of my own | [`FrictionLaw`], [`Scalar`]; whether it is in order: [`check_law`] |
//! | measured points as a law | [`Tabulated`] |
//! | static friction that rises at rest, bristles | [`Dwell`], [`Dahl`], [`LuGre`] in a [`Structure`] |
//! | a law chosen at run time | [`AnyLaw`], [`AnyContactLaw`]; contacts of one structure may have different laws without them |
//!
//! # The mass on its belt
//!
//! ```text
//!  ▌ spring  ┌──────┐
//!  ▌─/\/\/\──┤      │──▶ u
//!  ▌──[▭]────┤ mass │
//!  ▌ damper  └──────┘
//!      ────────────────────▶ v_b, belt
//!
//! slip:   u'' + 2βu' + u + γ²μ(v_r) = 0,  v_r = u' − v_b
//! stick:  u' = v_b,  u'' = 0,  as long as |u + 2βv_b| ≤ γ²μ_s
//! ```
//!
//! The belt drags the mass along by friction, until the spring is stretched so far that the mass
//! slips back. Where friction falls with the sliding speed, the slipping mass takes up energy from
//! the belt, and steady sliding gives way to vibration: brakes groan, doors creak, bows sound.
//!
//! All quantities are dimensionless: u displacement, v = u' velocity, τ time, β ≥ 0 damping ratio,
//! γ² > 0 friction load, v_b belt velocity of either sign or zero, v_r = v − v_b relative velocity,
//! s = |v_r| sliding speed. [`PhysicalMassOnBelt`] takes and gives kilograms, metres and newtons;
//! [`Scaling`] converts them.
//!
//! A [`FrictionLaw`] consists of a static coefficient μ_s and a function μ̂(s) for s ≥ 0, the
//! kinetic coefficient. μ̂(0) is its limit for s → 0, and at most μ_s. The law is odd in the
//! relative velocity: μ(v_r) = sgn(v_r)·μ̂(|v_r|).
//!
//! "Amplitude" has several meanings:
//!
//! | where | what it is |
//! |---|---|
//! | [`LimitCycle::amplitude`] | half the distance between the largest and the least displacement |
//! | [`limit_cycle::Continuum`] | the amplitude in this same sense, of the largest motion of a family of periodic motions |
//! | [`analysis::PureSlip::amplitude`] | A0 of the source paper, Eq. 15: the amplitude of both displacement and velocity, to first order |
//! | [`analysis::StickSlip::amplitude`] | A1 of the source paper, Eq. 18: the amplitude of a slip arc to which friction gives no energy |
//! | [`analysis::averaging`] | the amplitude of the harmonic motion that is averaged over |
//! | [`LimitCycle::harmonics`] | the complex amplitudes of the displacement, one for each harmonic |
//! | [`Drive::harmonic`] | the largest value of one harmonic |
//!
//! # Conventions at zero relative velocity
//!
//! In stick the contact has to carry the force F = u + 2βv_b. The largest force that it can carry
//! is F_s = γ²μ_s. The band of forces in which the mass sticks is half open, so that exactly one
//! thing follows from every state:
//!
//! * v_b > 0: −F_s ≤ F < F_s. At F = F_s the mass is released.
//! * v_b < 0: −F_s < F ≤ F_s, the mirror image.
//! * v_b = 0: −F_s ≤ F ≤ F_s.
//!
//! | situation | what happens |
//! |---|---|
//! | stick, v_b > 0: F grows at the rate v_b and reaches F_s | [`Release`](EventKind::Release), slip with v_r < 0 (lagging); u = F_s − 2βv_b, v = v_b |
//! | stick, v_b < 0: F reaches −F_s | `Release`, slip with v_r > 0 (leading) |
//! | stick, v_b = 0 | the mass rests for ever |
//! | slip, v_r reaches 0, F in the band | [`Stick`](EventKind::Stick), also where γ²μ̂(0) < \|F\|: static friction holds |
//! | slip, v_r reaches 0, F outside the band | [`Crossing`](EventKind::Crossing): slip goes on with the other sign. This holds too if leading slip ends exactly at the open end of the band |
//! | slip, v_r touches 0 tangentially at the open end, from lagging | no event, slip goes on |
//! | start with v_r = 0, F in the band | the mass sticks; no event at time 0 |
//! | start with v_r = 0, F outside the band | the mass slips at once, with the sign of −F; no event at time 0 |
//! | start at the release point, within 4 ulps of the largest term of its formula | `Release` at time 0, reported |
//!
//! (An ulp is the distance between two neighbouring numbers of type `f64`.)
//!
//! [`MassOnBelt::stick_limits`] gives the ends of the band as displacements u; every decision uses
//! these two numbers. [`MassOnBelt::release_state`] gives the release point.
//!
//! # What the integrator promises
//!
//! 1. **Steps.** A slip phase is followed by Taylor series of order 26. The defect of a series is
//!    what is missing in the equation of motion when the series is put in. A step is accepted when
//!    its defect is small at a quarter, a half and three quarters of the step, at its end, and near
//!    the place where the mass comes closest to the belt's velocity. So no term is missed because
//!    it rounds to nothing where the step starts, as exp(−400) does in a law with a narrow Stribeck
//!    velocity. In a step longer than one radian the defect is checked at every quarter of a
//!    radian. This finds a bump exp(−(s/w)²) of the law at any other speed if w is at least a
//!    fortieth of the motion's velocity amplitude. Name the place of a narrower bump as a
//!    [breakpoint](FrictionLaw::breakpoints). Where friction or the damper rises so steeply with
//!    the sliding speed that the motion creeps, with D = 2β + γ²·dμ̂/ds large, a step is the power
//!    series of the creep itself. The number of steps then does not grow with D. Such a step may
//!    start up to eight errors beside the end of the step before.
//! 2. **Contacts** are roots of the sliding speed's own polynomial. They are isolated so that none
//!    is skipped, and refined to the last bit. A shallow contact, in and out within one step, is
//!    found too.
//! 3. **Starts of slip.** At the start of slip v_r has a root that is known, simple or double. This
//!    root is divided out. There is no epsilon, no cooldown and no least duration.
//! 4. **Stick** has closed formulas, and v equals v_b to the bit.
//! 5. **Order.** States are continuous. Event times never decrease, and they increase strictly if
//!    the phase between two events is longer than an ulp of the time. The same call gives the same
//!    bits on the same kind of processor.
//! 6. **Large numbers.** The integrated variable is v_r and not v, so that contact is exact for
//!    large v_b. Time is summed together with its rounding errors: after 10⁵ cycles an event comes
//!    at its multiple of the period, to 4 ulps of the time.
//! 7. **Tolerance** is relative to the motion's own scale, max(|u − ū|, |v|, |v_b|), with ū the
//!    displacement of steady sliding. So a change of units only scales the result. Where the law is
//!    so steep that ū lies far beyond all that happens, and where a motion creeps, the scale is
//!    max(|v|, |v_b|, |v'|/max(1, D)): what the motion does, and is about to do.
//! 8. **Errors.** A motion that cannot be followed further ends in an [`Error`] with the time and
//!    the state reached. It does not panic or hang.
//!
//! Each promise has a test that is named for it. Another method computed 22 motions with 25 digits;
//! their events and states are met within 1e-13·max(1, |value|). Double precision itself, with
//! ε = 2.2e-16, sets two limits: the time of a contact near grazing is known to about ε/|v_r'|, and
//! motions with v_b below 2e-5·γ²μ_s to about ε·γ²μ_s/v_b.
//!
//! # What is guaranteed of cycles
//!
//! [`limit_cycle::stick_slip`] is complete: if there is a cycle that sticks, it is found.
//! [`limit_cycle::find`] can miss a pair of cycles that lie very close together; its page says
//! [how close](limit_cycle#what-is-guaranteed). Each function of [`bifurcation`] says how densely
//! it searches a range of belt velocities.
//!
//! # Limits
//!
//! * **All cycles of one mass only.** Every limit cycle is found for one mass on a belt of constant
//!   velocity, because its motions lie in a plane and cannot cross each other. Periodic motions of
//!   a [`Structure`] are found from a guess: see [`orbit`].
//! * **Memory in structures only.** The law of a [`MassOnBelt`] depends on the relative velocity
//!   alone. A contact of a [`Structure`] may remember ([`Dwell`], [`Dahl`], [`LuGre`], or a
//!   [`ContactLaw`] of your own), and a belt enters a structure by `Structure::from`.
//! * **Contacts that share masses.** They decide together which of them stick: uniquely where
//!   static and kinetic coefficients are equal, otherwise
//!   [by a rule](Structure#contacts-that-share-masses). Contacts with linearly dependent directions
//!   must not come to rest together ([`Error::Undetermined`]).
//! * **Stiffness.** One mass on a belt is followed even where the system is stiff (large β or
//!   γ²·dμ̂/ds, as for the cubic law far above its minimum), up to D = 2β + γ²·dμ̂/ds of about
//!   1e20. Far beyond, numbers overflow. A [`Structure`] is followed by such series where
//!   bristles, or another memory of one number, are stiff, whatever their stiffness (tried up to σ0
//!   = 1e12); else by explicit steps, which become short where it is stiff. What cannot be followed
//!   ends in [`Error::StepUnderflow`] or [`Error::TooManySteps`].
//! * **Analytic laws.** A law is analytic, at s = 0 too, or it is so in pieces that meet at
//!   [breakpoints](FrictionLaw::breakpoints).
//! * **Narrow bumps.** A bump in the law that is narrower than
//!   [steps are checked for](#what-the-integrator-promises) has to be named as a breakpoint.
//!
//! # Features
//!
//! No feature is on by default.
//!
//! * `serde`: writes and reads laws, systems, structures, scalings, states and events; writes
//!   equilibria, cycles and diagrams, which follow from a system. `schema` lists the names.
//! * `rayon`: adds `bifurcation::par_diagram`, which computes the [diagram](bifurcation::diagram)
//!   on all cores, with the same results bit for bit.
#![forbid(unsafe_code)]

// The floors, from the ground up. No module imports one above its own.
//
// | file or folder | what is in it |
// |---|---|
// | `state`, `clock.rs` | states and directions; time as a sum of two numbers |
// | `error.rs` | every error with its message; where errors get their place, parameter and units |
// | `scalar` | the numbers that a law is evaluated on, and their recurrences |
// | `series`, `numerics` | power series and their roots; brackets, scans, quadrature |
// | `drive`, `friction` | functions of time; friction laws, their checks, contacts that remember |
// | `motion` | what both engines share: settings, step control, events, trajectories |
// | `belt` | one mass on a belt: system and engine |
// | `structure` | several masses and contacts: system and engine |
// | `orbit` | periodic motions of any system, from a guess |
// | `limit_cycle`, `analysis` | all cycles of the belt; closed formulas |
// | `scaling.rs` | conversion between SI units and dimensionless numbers |
// | `bifurcation` | searches of the belt along a parameter |
// | `physical.rs` | the belt in SI units throughout: the whole road, on top of `scaling.rs` |
// | `schema.rs` | the names under which things are written |

pub mod analysis;
mod belt;
pub mod bifurcation;
mod clock;
mod drive;
mod error;
mod friction;
pub mod limit_cycle;
mod motion;
mod numerics;
pub mod orbit;
mod physical;
mod scalar;
mod scaling;
#[cfg(feature = "serde")]
pub mod schema;
mod series;
mod state;
pub mod structure;

pub use belt::{Equilibrium, Flow, MassOnBelt, Stability, Step};
pub use drive::Drive;
pub use error::{Error, Reached};
pub use friction::memory::{
    AnyContactLaw, ContactLaw, Dahl, Dwell, LuGre, Motion, Slip, Variables,
};
pub use friction::{
    AnyLaw, Coulomb, Exponential, FrictionLaw, LawFault, Polynomial, Rational, Scaled, Stribeck,
    Tabulated, check_law,
};
#[doc(hidden)]
pub use friction::{LawRef, LawVisitor};
pub use limit_cycle::{
    Attractor, Basins, Continuum, CycleKind, CycleSet, EnergyBudget, LimitCycle,
};
pub use motion::{
    Ended, Event, EventKind, Integrator, Mode, Segment, System, SystemState, Trajectory,
};
pub use nalgebra;
pub use physical::PhysicalMassOnBelt;
pub use scalar::Scalar;
pub use scaling::{Physical, Scaling};
pub use state::{Direction, State};
pub use structure::{Contact, Structure};

/// Compiles the program of the README as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
