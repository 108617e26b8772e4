//! Friction-induced vibration, to round-off: every stick, release and crossing of a mass on a
//! moving belt, every limit cycle, and the belt velocities at which they appear, for any friction
//! law that can be written as a function. Several masses, with forces and belts that vary in time,
//! are followed as exactly.
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
//! | the same without an end, in constant memory | [`Integrator::flow`] |
//! | with a looser tolerance, or more steps | [`Integrator::with_tolerance`], [`Integrator::with_max_steps`] |
//! | everything that it can settle to | [`limit_cycle::find`] |
//! | the stick-slip motion alone | [`limit_cycle::stick_slip`] |
//! | which of them it settles to from a given start | [`limit_cycle::attractor`]; from many, [`limit_cycle::basins`] |
//! | period, extremes, harmonics, energies of a periodic motion | [`LimitCycle`] |
//! | whether steady sliding is stable | [`MassOnBelt::equilibrium`] |
//! | the belt velocity at which steady sliding becomes stable | [`bifurcation::hopf_velocities`], [`bifurcation::criticality`] |
//! | the one at which stick-slip appears or disappears | [`bifurcation::grazing_velocities`] |
//! | those at which a cycle changes its kind | [`bifurcation::overshoot_velocities`], [`bifurcation::crossing_velocities`], [`bifurcation::fold_velocities`] |
//! | a picture over the belt velocity | [`bifurcation::diagram`] |
//! | how much damping keeps it quiet | [`bifurcation::silencing_damping`]; at every belt velocity, [`analysis::design`] |
//! | the formulas of the source paper, and better ones | [`analysis::PureSlip`], [`analysis::StickSlip`], [`analysis::averaging`]; [where the paper is wrong](analysis#where-the-source-paper-is-wrong) |
//! | several masses, forces and belts that vary in time | [`Structure`], [`Contact`], [`Drive`] |
//! | whether several masses slide steadily, or flutter | [`Structure::steady_sliding`] |
//! | kilograms, newtons, metres, hertz | [`Scaling`]; a [`Structure`] takes any consistent units |
//! | a friction law of my own | [`FrictionLaw`], [`Scalar`] |
//! | measured points as a law | [`Tabulated`] |
//! | a law chosen at run time | [`AnyLaw`] |
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
//! Friction drags the mass along until the spring is stretched so far that it slips. Where friction
//! falls with the sliding speed, the slipping mass takes up energy, and steady sliding gives way to
//! vibration: brakes groan, doors creak, bows sound.
//!
//! All quantities are dimensionless: u displacement, v = u' velocity, τ time, β ≥ 0 damping ratio,
//! γ² > 0 friction load, v_b belt velocity of either sign or zero, v_r = v − v_b relative velocity,
//! s = |v_r| sliding speed. [`Scaling`] leads from kilograms, metres and newtons to them and back.
//!
//! A [`FrictionLaw`] is a static coefficient μ_s and a function μ̂(s) for s ≥ 0. Its value at s = 0
//! is the limit from above, and μ̂(0) ≤ μ_s. The law is odd in the relative velocity:
//! μ(v_r) = sgn(v_r)·μ̂(|v_r|).
//!
//! "Amplitude" has several meanings:
//!
//! | where | what it is |
//! |---|---|
//! | [`LimitCycle::amplitude`] | half the distance between the largest and the least displacement |
//! | [`limit_cycle::Continuum`] | the same, of the largest motion of a family |
//! | [`analysis::PureSlip::amplitude`] | A0 of the source paper, Eq. 15: of displacement and velocity, to first order |
//! | [`analysis::StickSlip::amplitude`] | A1 of the source paper, Eq. 18: of an arc to which friction gives no energy |
//! | [`analysis::averaging`] | of the harmonic motion that is averaged over |
//! | [`LimitCycle::harmonics`] | complex amplitudes of the displacement, one for each harmonic |
//! | [`Drive::harmonic`] | the largest value of one harmonic |
//!
//! # Conventions at zero relative velocity
//!
//! The contact has to carry the force F = u + 2βv_b in stick; the most that it can is F_s = γ²μ_s.
//! The band of forces in which the mass sticks is half open, so that every state has one fate:
//! −F_s ≤ F < F_s for v_b > 0 (at F = F_s the mass is released), mirrored for v_b < 0, closed for
//! v_b = 0.
//!
//! | situation | what happens |
//! |---|---|
//! | stick, v_b > 0: F grows at the rate v_b and reaches F_s | [`Release`](EventKind::Release), slip with v_r < 0 (lagging); u = F_s − 2βv_b, v = v_b |
//! | stick, v_b < 0: F reaches −F_s | `Release`, slip with v_r > 0 (leading) |
//! | stick, v_b = 0 | rests for ever |
//! | slip, v_r reaches 0, F in the band | [`Stick`](EventKind::Stick), also where γ²μ̂(0) < \|F\|: static friction holds |
//! | slip, v_r reaches 0, F outside the band | [`Crossing`](EventKind::Crossing): slip goes on with the other sign. An arrival from leading exactly at the open end of the band is one too |
//! | slip, v_r touches 0 tangentially at the open end, from lagging | no event, slip goes on |
//! | start with v_r = 0, F in the band | in stick; no event at time 0 |
//! | start with v_r = 0, F outside the band | slips at once with the sign of −F; no event at time 0 |
//! | start at the release point, to 4 ulps of the largest term | `Release` at time 0, reported |
//!
//! [`MassOnBelt::stick_limits`] gives the ends of the band in u, as every decision uses them, and
//! [`MassOnBelt::release_state`] the release point.
//!
//! # What the integrator promises
//!
//! 1. **Steps.** A slip phase is followed by Taylor series of order 26. A step is accepted when the
//!    defect of the series, what is missing in the equation of motion, is small at its end (the
//!    contact, if there is one), at a quarter, a half and three quarters of it, and about the place
//!    where the mass comes closest to the belt's velocity. Terms hidden behind exp(−400), as in a
//!    law with a narrow Stribeck velocity, are not missed. A step longer than one radian is looked
//!    at every quarter of a radian: a bump exp(−(s/w)²) at some other speed is seen for w down to a
//!    fortieth of the motion's velocity amplitude. Name the place of a narrower one as a
//!    [breakpoint](FrictionLaw::breakpoints).
//! 2. **Contacts** are roots of the sliding speed's own polynomial, isolated so that none is
//!    skipped, and refined to the last bit. A shallow contact, in and out within one step, is
//!    found.
//! 3. **Starts of slip.** The known root of v_r at the start is divided out, simple or double.
//!    There is no epsilon, no cooldown and no least duration.
//! 4. **Stick** is closed-form, and there v is v_b to the bit.
//! 5. **Order.** States are continuous. Event times never decrease, and increase strictly where a
//!    phase is longer than an ulp of the time. The same call gives the same bits.
//! 6. **Large numbers.** v_r and not v is integrated, so that contact is exact for large v_b; time
//!    is summed with its rounding errors: after 10⁵ cycles an event comes at its multiple of the
//!    period, to 4 ulps of the time.
//! 7. **Tolerance** is relative to the motion's own scale, max(|u − ū|, |v|, |v_b|): a change of
//!    units scales the result. (Where a law is so steep that ū lies far beyond all that happens,
//!    that scale is large too, and the result less exact than it could be.)
//! 8. **Errors.** What cannot go on is an [`Error`] with the time and the state reached, not a
//!    panic and not a hang.
//!
//! Each has a test named for it. The events and states of 22 motions that were computed with 25
//! digits by another method are met within 1e-13·max(1, |value|). What double precision itself
//! limits: the time of a contact near grazing, about ε/|v_r'| with ε = 2.2e-16; motions for v_b
//! below 2e-5·γ²μ_s, about ε·γ²μ_s/v_b.
//!
//! # What is guaranteed of cycles
//!
//! [`limit_cycle::stick_slip`] is complete. [`limit_cycle::find`] can lose pairs of cycles that lie
//! closer together than it looks; [how close](limit_cycle#what-is-guaranteed) is stated there, and
//! so is, with each function of [`bifurcation`], how densely a range is searched.
//!
//! # Limits
//!
//! * All cycles are found of one mass on a belt of constant velocity only: there motions are
//!   planar, and cannot cross. Of a [`Structure`] motions are followed.
//! * No memory in the law: μ depends on the relative velocity alone (no rate-and-state, LuGre or
//!   bristle model).
//! * The method is explicit. A stiff system (large γ²·dμ̂/ds, the cubic law far above its minimum)
//!   ends in [`Error::StepUnderflow`] or [`Error::TooManySteps`], whose messages name stiffness.
//! * The law is analytic, at s = 0 too, or piecewise so with
//!   [breakpoints](FrictionLaw::breakpoints).
//!
//! # Features
//!
//! None is on by default.
//!
//! * `serde`: laws, systems, scalings, states and events are written and read; equilibria, cycles
//!   and diagrams, which follow from them, are written. `schema` lists the names.
//! * `rayon`: `bifurcation::par_diagram`, the [diagram](bifurcation::diagram) on all cores, with
//!   the same results bit for bit.
#![forbid(unsafe_code)]

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
pub use friction::memory::{AnyContactLaw, ContactLaw, Dahl, Dwell, LuGre, Motion, Slip};
pub use friction::{
    AnyLaw, Coulomb, Exponential, FrictionLaw, Polynomial, Rational, Scaled, Stribeck, Tabulated,
};
pub use limit_cycle::{CycleKind, CycleSet, EnergyBudget, LimitCycle};
pub use motion::{Event, EventKind, Integrator, Mode, Segment, System, SystemState, Trajectory};
pub use nalgebra;
pub use scalar::Scalar;
pub use scaling::{Physical, Scaling};
pub use state::{Direction, State};
pub use structure::{Contact, Structure};

/// The program of the README, compiled as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
