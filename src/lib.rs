//! Friction-induced vibration, computed to round-off.
//!
//! For a mass on a moving belt the crate finds every event: stick (slip ends, the mass moves with
//! the belt), release (slip onset) and crossing (the relative velocity changes its sign without
//! stick). Within [stated limits](limit_cycle#what-is-guaranteed) it finds every limit cycle, and
//! the belt velocities at which cycles appear. The friction law can be any analytic or piecewise
//! analytic function. Motions of several masses are computed with equal accuracy. Friction may act
//! on belts and between masses; forces and belt velocities may vary in time. The [periodic
//! motions](orbit) of several masses are found from a guess, by simulation, or from a Hopf point.
//!
//! ```
//! use stick_slip::{MassOnBelt, Polynomial, State, limit_cycle};
//!
//! // μ_s, the least coefficient and its sliding speed; v_b; β. The friction load γ² is 1.
//! let law = Polynomial::new(0.4, 0.25, 0.5)?;
//! let system = MassOnBelt::new(law, 0.2)?.with_damping(0.05)?;
//!
//! // From rest: the mass sticks, is released, and sticks again.
//! let motion = system.simulate(State::new(0.0, 0.0), 10.0)?;
//! let kinds: Vec<String> = motion.events().iter().map(|event| event.kind.to_string()).collect();
//! assert_eq!(kinds, ["stick", "release (lagging)", "stick", "release (lagging)"]);
//!
//! // The limit cycle of this motion, computed without its transient.
//! let cycle = limit_cycle::stick_slip(&system)?.ok_or("no stick-slip")?;
//! assert!((cycle.period() - 6.799421444472158).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Which function do I need?
//!
//! | question | answer |
//! |---|---|
//! | **One mass on a belt** | |
//! | how the mass moves from a given start, and when it sticks | [`MassOnBelt::simulate`], then [`Trajectory::events`], [`state_at`](Trajectory::state_at), [`sample`](Trajectory::sample) |
//! | all limit cycles, stable and unstable | [`limit_cycle::find`] |
//! | the stick-slip cycle alone | [`limit_cycle::stick_slip`] |
//! | the attractor reached from a given start | [`limit_cycle::attractor`]; from many, [`limit_cycle::basins`] |
//! | stability of steady sliding | [`MassOnBelt::equilibrium`] |
//! | the belt velocity at which steady sliding gains or loses stability | [`bifurcation::hopf_velocities`], [`bifurcation::criticality`] |
//! | the belt velocity at which stick-slip appears or disappears | [`bifurcation::grazing_velocities`] |
//! | the belt velocity at which a pure-slip cycle appears or disappears because its largest velocity reaches that of the belt | [`bifurcation::touching_velocities`] |
//! | the belt velocity at which a cycle changes its kind | [`bifurcation::overshoot_velocities`], [`bifurcation::crossing_velocities`] |
//! | the belt velocity at which a stable and an unstable cycle meet and vanish | [`bifurcation::fold_velocities`] |
//! | all cycles over a range of belt velocities, for a picture | [`bifurcation::diagram`] |
//! | the attractors over a range of belt velocities, bistable ranges included | [`bifurcation::vibration_ranges`] |
//! | the load, damping or law coefficient at which one of these changes happens | [`bifurcation::along`] |
//! | the load at which vibration begins | [`bifurcation::silencing_load`] |
//! | the stiffness at which vibration ends | [`bifurcation::silencing_stiffness`] |
//! | the least damping without vibration | [`bifurcation::silencing_damping`]; at every belt velocity, [`analysis::design`] |
//! | the formulas of Farshidianfar and Noei Aghaee (the source paper), and more accurate ones | [`analysis::PureSlip`], [`analysis::StickSlip`], [`analysis::averaging`]; errors of the paper: [list](analysis#where-the-source-paper-is-wrong) |
//! | a belt that speeds up, slows down or reverses | [`Contact::on_belt`] with [`Drive::profile`] |
//! | **Several masses** | |
//! | how several masses move, with forces and belts that vary in time | [`Structure`], [`Contact`], [`Drive`] |
//! | friction between masses: clutch, bolted joint, blade damper, pad on a disc | [`Contact::between`], [`Contact::along`]; its force: [`Structure::carried`] |
//! | which contacts at rest slip next, together, and at which load | [`Structure::mechanisms`] |
//! | a reduced finite-element model, with a full mass matrix | [`Structure::with_mass_matrix`]; contacts along its mode shapes: [`Contact::along`] |
//! | friction forces, loads and accelerations along a motion; work and heat of every part | [`Structure::samples`], [`Structure::energy_budget`] |
//! | steady sliding of several masses, its stability, flutter | [`Structure::steady_sliding`]; of a slipping clutch or turning shafts: [`Structure::steady_sliding_at`] |
//! | where steady sliding becomes unstable along a speed profile | [`Structure::stability_changes`] |
//! | torsion | use moments of inertia as masses, radians as the unit of length, N·m as the unit of force |
//! | **Loads, forces and drives** | |
//! | a chirp, a shock, a window or any other function of time as a force, load or belt velocity | [`Drive::function`] with a [`TimeFunction`] |
//! | a hard or soft spring (Duffing) | [`PolynomialSpring`], or a [`TabulatedForce`] of measured points, in a [`ForceElement`]; formulas in [`analysis::duffing`] |
//! | a pendulum | [`Pendulum`]; its pivot is at rest |
//! | gear play, backlash | [`Backlash`] |
//! | a stop, an impact, a loose gear with damping | [`Stop`], a spring and a damper that act while a gap is closed; in place of a rigid stop: [rigid stops](Stop#rigid-stops) |
//! | a gap | surfaces that touch only after a displacement: [`Contact::with_normal_spring`] with a load ≤ 0; without friction: [`Stop`], [`Backlash`] |
//! | an oblique spring | [`SnapThrough`], with its change of direction; along a fixed direction [`ForceElement::along`]; one that presses a contact: [`Contact::with_load_law`] |
//! | a stiffness that varies in time (gear mesh, Mathieu's equation) | [`ForceElement::with_factor`], with the law [`PolynomialSpring`] of one coefficient |
//! | a controller | integral action (PID), a motor's current, an actuator, a filter: [`FirstOrder`]; proportional feedback: [`Structure::with_stiffness`] and [`Structure::with_damping`], with matrices that need not be symmetric; nonlinear feedback: your own [`ForceField`], or a law in a [`FirstOrder`]; delays are not available |
//! | a Maxwell damper, a viscoelastic mount | [`FirstOrder::lag`] |
//! | a nonlinear damper, or any other force of displacements and velocities | [`VanDerPol`], or your own [`ForceLaw`] or [`ForceField`] |
//! | a normal load that varies | a [`Drive`] in time, [`Contact::with_load_gradient`], [`Contact::with_normal_spring`] if the surfaces separate, [`Contact::with_load_law`] for any other load: a bead on a ring, an oblique spring |
//! | a mass or a base whose displacement d(t) is prescribed | leave out its coordinate: a spring and a damper to it exert the force k d + c d', [`Structure::with_force`]; friction on it: [`Contact::on_belt`] with the velocity d' |
//! | an incline, or a constant force | one mass: a constant force F shifts the displacement by F/K (K: stiffness of the spring) and has no other effect; an incline also reduces the normal force. Several masses: [`Structure::with_force`] |
//! | **Laws of friction** | |
//! | a friction law of my own | [`FrictionLaw`], [`Scalar`]; checked by [`check_law`] |
//! | measured points as a law | [`Tabulated`] |
//! | static friction that rises with the time in stick, bristles | [`Dwell`], [`Dahl`], [`LuGre`] in a [`Structure`] |
//! | rate-and-state friction, earthquakes, laboratory sliders | [`RateState`] in a [`Structure`]; formulas in [`analysis::rate_state`]; a fit of a, b and D_c: the example `rate_state_lab` |
//! | a law chosen at run time | [`AnyLaw`], [`AnyContactLaw`] (not needed for different laws in one structure) |
//! | joints that deform elastically before they slide | [`Contact::with_tangential_stiffness`], [`Contact::in_parallel`] with [`Iwan4`]; formulas in [`analysis::jenkins`] |
//! | friction that depends on the direction: scaled skin, crawlers, hair, nap | [`Directional`] of two laws, or your own [`ContactLaw`] with [`limits`](ContactLaw::limits); a [`FrictionLaw`] is odd in the relative velocity |
//! | a rope or a band around a drum (capstan, band brake) | [`Directional::capstan`] |
//! | a freewheel, a one-way clutch, a backstop, blocks that never slide back (Burridge-Knopoff) | [`Contact::freewheel`], also with drag; along any direction: [`Freewheel`] |
//! | **Periodic motions of any system** | |
//! | period, extremes, accelerations, harmonics, energies of a periodic motion | [`LimitCycle`], [`orbit::Orbit`] |
//! | a periodic motion of any system, with its Floquet multipliers | [`orbit::shoot`], [`orbit::settle`] |
//! | how a periodic motion changes with any parameter | [`orbit::follow`] |
//! | the load or the speed at which a structure begins and ceases to vibrate, with hysteresis | [`orbit::vibration_ranges`] |
//! | the motion that is born where steady sliding becomes unstable | [`orbit::begin`] |
//! | the motions that are born where a period doubles, or a symmetric motion loses its symmetry | [`orbit::Bifurcation::switch`] |
//! | the attractor of any system from a start, or as a parameter rises and falls | [`orbit::classify`], [`orbit::sweep`] |
//! | chaos: the largest Lyapunov exponent, Poincaré sections | [`orbit::lyapunov`], [`orbit::section`] |
//! | **Runs and data** | |
//! | how the mass moves, without a time limit and in constant memory | [`Integrator::flow`] |
//! | how the mass moves, with a looser tolerance or more steps | [`Integrator::with_tolerance`], [`Integrator::with_max_steps`] |
//! | how the mass moves until a given condition holds | [`Integrator::simulate_until`] |
//! | how to work in kilograms, newtons, metres and hertz | [`PhysicalMassOnBelt`], [`Scaling`]; a [`Structure`] takes any consistent units |
//! | samples at 48 kHz, each with its mode, stick or slip | [`Trajectory::sample_every`]; with forces and accelerations, for example for a sound file: [`Structure::samples`] |
//! | bounding, watching or stopping a search | [`Search`]; the results found so far are kept |
//! | many systems on all cores | systems and results can be shared between threads: call any function from several threads |
//! | cancelling a run | [`Integrator::simulate_until`], or stop taking steps from [`Integrator::flow`] |
//! | what is promised, and which test checks it | [`guarantees`] |
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
//! s = |v_r| sliding speed. [`PhysicalMassOnBelt`] takes and returns numbers in kilograms, metres
//! and newtons. [`Scaling`] converts between SI units and dimensionless numbers.
//!
//! A [`FrictionLaw`] consists of a static coefficient μ_s and a kinetic coefficient μ̂(s). The
//! limit μ̂(0) for s → 0 must not exceed μ_s. The law is odd in the relative velocity: μ(v_r) =
//! sgn(v_r)·μ̂(|v_r|).
//!
//! "Amplitude" has several meanings:
//!
//! | where | what it is |
//! |---|---|
//! | [`LimitCycle::amplitude`] | half the distance between the largest and the least displacement |
//! | [`limit_cycle::Continuum`] | half the range of displacements, for the largest motion of a family of periodic motions |
//! | [`analysis::PureSlip::amplitude`] | A0 of the source paper, Eq. 15: the amplitude of both displacement and velocity, to first order |
//! | [`analysis::StickSlip::amplitude`] | A1 of the source paper, Eq. 18: the amplitude of a slip arc that gains no energy from friction |
//! | [`analysis::averaging`] | the amplitude of the harmonic motion that the method of averaging assumes |
//! | [`LimitCycle::harmonics`] | the complex amplitudes of the displacement, one for each harmonic |
//! | [`Drive::harmonic`] | the largest value of one harmonic |
//!
//! # What is guaranteed
//!
//! * **Events** are never missed and never fire twice: each time at which v_r reaches 0 is an
//!   isolated root of a polynomial in time, refined to the last bit.
//! * **Stick** has closed formulas, and the velocity is v_b to the bit.
//! * **Uniqueness.** From every state with v_r = 0 exactly one motion follows. In stick the contact
//!   transmits the force F = u + 2βv_b, and for v_b > 0 the mass sticks while −γ²μ_s ≤ F < γ²μ_s;
//!   at F = γ²μ_s it is released.
//! * **Accuracy.** The tolerance is relative to the scale of the motion. By default it is
//!   round-off. The results agree with 22 reference motions, computed with 25 digits, within
//!   1e-13·max(1, |value|).
//! * **Repeatability.** The same call gives the same bits on the same kind of processor.
//! * **Errors.** A run that cannot continue returns a typed [`Error`] with the time and state
//!   reached. It does not panic or hang.
//! * **Completeness.** [`limit_cycle::stick_slip`] misses no cycle that sticks.
//!   [`limit_cycle::find`] may miss very small or very large cycles without stick, and pairs of
//!   cycles close together, and it reports the ranges that it cannot resolve: its page states the
//!   exact [limits](limit_cycle#what-is-guaranteed). Each function of [`bifurcation`] says how
//!   densely it searches.
//!
//! The page [`guarantees`] states each promise exactly, with the test that checks it, and the
//! [conventions at zero relative velocity](guarantees#conventions-at-zero-relative-velocity).
//!
//! # Limits
//!
//! * **Completeness for one mass only.** Completeness is guaranteed for a single mass on a belt of
//!   constant velocity, because its motions lie in a plane and cannot cross each other. The
//!   searches for periodic motions of a [`Structure`] can miss some: see [`orbit`].
//! * **Memory in structures only.** The law of a [`MassOnBelt`] depends on the relative velocity
//!   alone. A contact of a [`Structure`] may have memory variables ([`Dwell`], [`Dahl`], [`LuGre`],
//!   [`RateState`], or a [`ContactLaw`] of your own), and `Structure::from` converts a mass on a
//!   belt to a structure.
//! * **Contacts that share masses.** Stick or slip is decided for all of them together. The
//!   decision is unique if static and kinetic coefficients are equal; otherwise it follows [a
//!   rule](Structure#contacts-that-share-masses). Contacts with linearly dependent directions may
//!   rest together: when they slip is determined, though what each of them carries is not
//!   ([`structure::Carried`]).
//! * **Not available:** a mass matrix that depends on displacements (double pendulums, linkages);
//!   delays (regenerative chatter); friction whose direction turns in a plane; rigid impacts;
//!   forces that jump at a displacement, except that of a damped [`Stop`].
//! * **Stiffness.** Let D = 2β + γ²·dμ̂/ds. For a mass on a belt a large D (strong damping, or
//!   steep friction as in the cubic law far above its minimum) does not increase the number of
//!   steps, up to D of about 1e20. In structures neither steep friction nor the stiffness of one
//!   memory variable, such as bristles, increases the number of steps in slip (tried up to a slope
//!   of 1e15 and a bristle stiffness σ0 = 1e12). Other stiffness shortens the explicit steps;
//!   extreme stiffness ends in [`Error::StepUnderflow`] or [`Error::TooManySteps`].
//! * **Analytic laws.** A law must be analytic, also at s = 0, or piecewise analytic with
//!   [breakpoints](FrictionLaw::breakpoints) where the pieces meet.
//! * **Narrow features.** Declare a breakpoint at any feature of a law narrower than 1/40 of the
//!   velocity amplitude. A [`TimeFunction`] states the width of its narrowest feature by
//!   [`timescale`](TimeFunction::timescale).
//!
//! # Features
//!
//! `structures` and `orbits` are on by default. Without them there is one mass on a belt, with all
//! its searches and formulas, and `nalgebra` is not needed: `default-features = false`.
//!
//! * `structures`: adds [`structure`], [`Structure`], [`Contact`], [`ForceElement`], [`Stop`],
//!   [`FirstOrder`] and [`Drive`].
//! * `orbits`: adds [`orbit`] and [`bifurcation::hopf_locus`], and turns on `structures`.
//! * `serde`: writes and reads laws, systems, structures, scalings, states and events; writes, but
//!   does not read, results such as equilibria, cycles, diagrams, periodic motions and samples.
//!   `schema` lists the names.
//! * `rayon`: adds `bifurcation::par_diagram`, which computes the [diagram](bifurcation::diagram)
//!   on all cores, with the same results bit for bit.
#![deny(unsafe_code)]
// Without structures, some of what they share with the belt is not in use, and pages name what is
// not there.
#![cfg_attr(
    not(feature = "orbits"),
    allow(
        dead_code,
        unreachable_pub,
        unused_imports,
        rustdoc::broken_intra_doc_links
    )
)]
// docs.rs marks the items that a feature adds.
#![cfg_attr(docsrs, feature(doc_cfg))]

// The floors, from the ground up. No module imports one above its own.
//
// | file or folder | what is in it |
// |---|---|
// | `state`, `clock.rs` | states and directions; time as a sum of two numbers |
// | `error.rs` | every error with its message; where errors get their place, parameter and units |
// | `scalar` | the numbers that a law is evaluated on, and their recurrences |
// | `series`, `numerics` | power series and their roots; brackets, scans, quadrature |
// | `drive`, `friction` | functions of time; friction laws, their checks, contact laws with memory |
// | `force` | laws of nonlinear springs, dampers and forces |
// | `motion` | what both engines share: settings, step control, events, trajectories |
// | `search.rs` | `Search`: the bounds and the watcher of a search |
// | `belt` | one mass on a belt: system and engine |
// | `structure` | several masses and contacts: system and engine |
// | `orbit` | periodic motions of any system, from a guess |
// | `limit_cycle`, `analysis` | all cycles of the belt; closed formulas |
// | `scaling.rs` | conversion between SI units and dimensionless numbers |
// | `bifurcation` | searches of the belt along a parameter |
// | `physical.rs` | the belt in SI units throughout, on top of `scaling.rs` |
// | `guarantees.rs` | a page for users: each promise with its test |
// | `schema.rs` | the names under which things are written |

pub mod analysis;
mod belt;
pub mod bifurcation;
mod clock;
#[cfg(feature = "structures")]
mod drive;
mod error;
#[cfg(feature = "structures")]
mod force;
mod friction;
pub mod guarantees;
pub mod limit_cycle;
mod motion;
mod numerics;
#[cfg(feature = "orbits")]
pub mod orbit;
mod physical;
mod scalar;
mod scaling;
#[cfg(feature = "serde")]
pub mod schema;
mod search;
mod series;
mod state;
#[cfg(feature = "structures")]
pub mod structure;

pub use belt::{Equilibrium, Flow, Jacobian, MassOnBelt, Stability, Step};
#[cfg(feature = "structures")]
pub use drive::{Drive, TimeFunction};
pub use error::{Element, Error, Reached};
#[cfg(feature = "structures")]
pub use force::{
    Backlash, ForceField, ForceLaw, Pendulum, PolynomialSpring, SnapThrough, TabulatedForce,
    VanDerPol,
};
pub use friction::memory::{
    AnyContactLaw, ContactLaw, Dahl, Directional, Dwell, Freewheel, LuGre, Motion, RateState,
    RateState2, Slip, Variables,
};
pub use friction::{
    AnyLaw, Coulomb, Exponential, FrictionLaw, Iwan4, LawFault, Polynomial, Rational, Scaled,
    Stribeck, Tabulated, check_law,
};
pub use limit_cycle::{Attractor, Basins, Continuum, CycleKind, CycleSet, LimitCycle};
pub use motion::{
    AttractorKind, Ended, EnergyBudget, Event, EventKind, Integrator, Mode, Segment, System,
    SystemState, Trajectory,
};
#[cfg(feature = "structures")]
pub use nalgebra;
pub use num_complex;
pub use physical::PhysicalMassOnBelt;
pub use scalar::Scalar;
pub use scaling::{Physical, Scaling};
pub use search::{Progress, Search};
pub use state::{Direction, State};
#[cfg(feature = "structures")]
pub use structure::{Contact, FirstOrder, ForceElement, Stop, Structure};

/// Compiles the program of the README as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
