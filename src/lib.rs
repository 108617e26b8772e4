//! Friction-induced vibration of a mass on a moving belt: every stick, release and crossing, every
//! limit cycle, and the belt velocities at which they appear, to round-off, for any friction law
//! that can be written as a function.
//!
//! ```text
//!  ▌ spring  ┌──────┐
//!  ▌─/\/\/\──┤      │──▶ u
//!  ▌──[▭]────┤ mass │
//!  ▌ damper  └──────┘
//!      ────────────────────▶ v_b, belt
//!
//! slip:   u'' + 2βu' + u + γ²μ(v_r) = 0,  v_r = u' − v_b             (Eq. 1)
//! stick:  u' = v_b,  u'' = 0,  as long as |u + 2βv_b| ≤ γ²μ_s        (Eq. 2, corrected)
//! ```
//!
//! ```
//! use stick_slip::{EventKind, MassOnBelt, Polynomial, State, limit_cycle};
//!
//! // μ_s, the least coefficient, and the sliding speed at which it lies; v_b; β. The set of the paper's Fig. 5.
//! let law = Polynomial::new(0.4, 0.25, 0.5)?;
//! let system = MassOnBelt::new(law, 0.2)?.with_damping(0.05)?;
//!
//! // From rest: carried along by the belt, released, caught again.
//! let motion = system.simulate(State::new(0.0, 0.0), 10.0)?;
//! let kinds: Vec<String> = motion.events().iter().map(|event| event.kind.to_string()).collect();
//! assert_eq!(kinds, ["stick", "release (lagging)", "stick", "release (lagging)"]);
//! let [_, release, ..] = motion.events() else { unreachable!() };
//! assert_eq!(release.state, State::new(0.4 - 2.0 * 0.05 * 0.2, 0.2)); // u = γ²μ_s − 2βv_b, v = v_b
//!
//! // The motion it settles to, without a transient.
//! let cycle = limit_cycle::stick_slip(&system)?.ok_or("no stick-slip")?;
//! assert!((cycle.period() - 6.799421444472158).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # The model
//!
//! A mass on a spring and a damper lies on a belt that moves at the velocity v_b. Friction drags it
//! along until the spring is stretched so far that it slips; where friction falls with the sliding
//! speed, the slipping mass takes up energy, and steady sliding gives way to vibration: brakes
//! groan, doors creak, bows sound.
//!
//! All quantities are dimensionless: u displacement, v = u' velocity, τ time, β ≥ 0 damping ratio,
//! γ² > 0 friction load, v_b belt velocity of either sign or zero, v_r = v − v_b relative velocity,
//! s = |v_r| sliding speed. [`Scaling`] leads from kilograms, metres and newtons to them and back.
//!
//! A [`FrictionLaw`] is a static coefficient μ_s and a function μ̂(s) for s ≥ 0, with μ̂(0) ≤ μ_s,
//! the limit from above. The law is odd in the relative velocity: μ(v_r) = sgn(v_r)·μ̂(|v_r|).
//!
//! # Conventions at zero relative velocity
//!
//! F = u + 2βv_b is the force that the contact has to carry in stick, F_s = γ²μ_s the most that it
//! can. The stick band is half open, so that every state has one fate: −F_s ≤ F < F_s for v_b > 0
//! (at F = F_s the mass is released), mirrored for v_b < 0, closed for v_b = 0.
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
//! * No forcing: the spring, the damper, and friction on a belt of constant velocity.
//! * One mass: the motion is planar, and the search for cycles relies on that.
//! * No memory in the law: μ depends on the relative velocity alone (no rate-and-state, LuGre or
//!   bristle model).
//! * The method is explicit. A stiff system (large γ²·dμ̂/ds, the cubic law far above its minimum)
//!   ends in [`Error::StepUnderflow`] or [`Error::TooManySteps`], whose messages name stiffness.
//! * The law is analytic, at s = 0 too, or piecewise so with
//!   [breakpoints](FrictionLaw::breakpoints).
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
//! | which of them it settles to from a given start | [`limit_cycle::attractor`] |
//! | period, extremes, harmonics, energies of a periodic motion | [`LimitCycle`] |
//! | whether steady sliding is stable | [`MassOnBelt::equilibrium`] |
//! | the belt velocity at which steady sliding becomes stable | [`bifurcation::hopf_velocities`], [`bifurcation::criticality`] |
//! | the one at which stick-slip appears or disappears | [`bifurcation::grazing_velocities`] |
//! | those at which a cycle changes its kind | [`bifurcation::overshoot_velocities`], [`bifurcation::crossing_velocities`], [`bifurcation::fold_velocities`] |
//! | a picture over the belt velocity | [`bifurcation::diagram`] |
//! | how much damping keeps it quiet | [`bifurcation::silencing_damping`]; at every belt velocity, [`analysis::design`] |
//! | the formulas of the paper, and better ones | [`analysis::PureSlip`], [`analysis::StickSlip`], [`analysis::averaging`] |
//! | kilograms, newtons, metres, hertz | [`Scaling`] |
//! | a friction law of my own | [`FrictionLaw`], [`Scalar`] |
//! | measured points as a law | [`Tabulated`] |
//! | a law chosen at run time | [`AnyLaw`] |
//!
//! # Where the source paper is wrong
//!
//! "Eq. n" is an equation of A. Farshidianfar and N. Noei Aghaee, *Analytical Approaches for
//! Friction Induced Vibration and Stability Analysis*, which follows J. J. Thomsen and A. Fidlin,
//! *Int. J. Non-Linear Mech.* 38 (2003) 389-403. "Eq. n, corrected" is one that it prints wrongly;
//! tests show that the printed formulas fail.
//!
//! | where | printed | correct |
//! |---|---|---|
//! | Eq. 2 | 2βv_b + u ≤ μ_s | \|2βv_b + u\| ≤ γ²μ_s |
//! | Eq. 7 | γ²μ(v_r) | γ²μ(v_b) |
//! | after Eq. 10 | ε ≪ 0 | 0 < ε ≪ 1 |
//! | Eq. 10b | h2 = −η(v_b/v_m)² | h2 = −ηv_b/v_m² |
//! | section 4.1.1 | ż < 0, ż ≤ 0 | v_r < 0, v_r ≤ 0 |
//! | Eq. 13 | A0 = √(−(3/4) h1/h3) | A0 = √(−(4/3) h1/h3) |
//! | after Eq. 15 | v_b0 = √(4/3) v_b1 | v_b0 = √(4/5) v_b1 |
//! | after Eq. 15 | stick-slip beyond v_b0 … v_b1 | stick-slip below v_b0; steady sliding above v_b1 |
//! | Eqs. 16-18 | A1 is the stick-slip amplitude | A1 is that of the arc to which friction gives no energy; see [`analysis::StickSlip`] |
//! | section 3.2, abstract | Eq. 6 falls, then rises | it never rises; steady sliding is stable again on a slow belt |
//! | Fig. 3 | the concavity changes at v_s | at v_s/√2 |
//! | section 4.2 | the integrals cannot be solved | [`analysis::averaging`] computes them to round-off |
//!
//! # Features
//!
//! None is on by default.
//!
//! * `serde`: laws, systems, scalings, states, events, cycles, equilibria and the points of a
//!   diagram implement `Serialize` and `Deserialize`; what is read passes the checks of the
//!   constructors. A motion is made again from its system and start. (With `serde_json`, its
//!   feature `float_roundtrip` gives every number back to the bit.)
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
#[cfg(feature = "serde")]
mod raw;
mod scalar;
mod scaling;
mod series;
mod state;
pub mod structure;

pub use belt::{Equilibrium, Flow, MassOnBelt, Stability, Step};
pub use drive::Drive;
pub use error::{Error, Reached};
pub use friction::memory::{ContactLaw, Motion, Slip};
pub use friction::{
    AnyLaw, Coulomb, Exponential, FrictionLaw, Polynomial, Rational, Stribeck, Tabulated,
};
pub use limit_cycle::{CycleKind, CycleSet, EnergyBudget, LimitCycle};
pub use motion::{Event, EventKind, Integrator, Mode, Segment, System, SystemState, Trajectory};
pub use nalgebra;
pub use scalar::Scalar;
pub use scaling::{Physical, Scaled, Scaling};
pub use state::{Direction, State};
pub use structure::{Contact, Structure};

/// The program of the README, compiled as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
