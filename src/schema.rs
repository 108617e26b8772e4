//! The written form of all types that the feature `serde` writes and reads, with JSON as the
//! example.
//!
//! Laws, systems with their parts, scalings, states, events, and the enums so marked in the table
//! are **written and read**. Reading calls the constructors, with the same checks and error
//! messages. An unknown field is an error.
//!
//! Equilibria, cycles, sets of cycles, periodic motions, branches, sweeps, attractors, samples,
//! energies and points of a diagram are **written only**, for other programs. These results follow
//! from a system: to get them back, read the system and compute them again.
//!
//! A struct is written as a map from the names of its fields, all in `snake_case`, to their values.
//! An enum is written as the name of its variant in `snake_case`, alone or as the only key of a
//! map. Optional fields may be missing when they are read; the default value is in parentheses. [a,
//! b] is a list of two entries. A [`MassOnBelt`](crate::MassOnBelt) with its law and results is
//! dimensionless. A [`Structure`](crate::Structure) with its parts and results is in its own units.
//! [`Physical`](crate::Physical), [`Scaling`](crate::Scaling), [`Scaled`](crate::Scaled) and
//! results of a [`PhysicalMassOnBelt`](crate::PhysicalMassOnBelt) are in SI units, except the
//! `damping` of a cycle, which is always the ratio β. To write a `PhysicalMassOnBelt`, write its
//! `Physical` and its law.
//!
//! | type | fields | read |
//! |---|---|---|
//! | [`Coulomb`](crate::Coulomb) | `static_coefficient`, `kinetic_coefficient` | yes |
//! | [`Exponential`](crate::Exponential) | `static_coefficient`, `kinetic_coefficient`, `stribeck_velocity` | yes |
//! | [`Polynomial`](crate::Polynomial) | `static_coefficient`, `minimum_coefficient`, `minimum_velocity` | yes |
//! | [`Stribeck`](crate::Stribeck) | `static_coefficient`, `coulomb_coefficient`, `stribeck_velocity`, `exponent`; optional: `viscous_coefficient` (0) | yes |
//! | [`Rational`](crate::Rational) | `static_coefficient`, `decay`; optional: `offset` (0), `quadratic` (0) | yes |
//! | [`Tabulated`](crate::Tabulated) | `points`: a list of [speed, coefficient]; optional: `static_coefficient` (that of the first point), `piecewise_linear` (false) | yes |
//! | [`AnyLaw`](crate::AnyLaw) | `coulomb`, `exponential`, `polynomial`, `stribeck`, `rational` or `tabulated`, with that law | yes |
//! | [`Directional`](crate::Directional) | `forward`, `backward`: laws | yes |
//! | [`Freewheel`](crate::Freewheel) | `drag`: a law | yes |
//! | [`Dwell`](crate::Dwell) | `exponential` or `hyperbolic`, with `law`, `limit`, `time`; or `logarithmic`, with `law`, `rate`, `time` | yes |
//! | [`Dahl`](crate::Dahl) | `coefficient`, `stiffness` | yes |
//! | [`LuGre`](crate::LuGre) | `law`, `stiffness`; optional: `damping` (0), `viscous` (0) | yes |
//! | [`RateState`](crate::RateState) | `aging` or `slip`, with `f0`, `a`, `b`, `d_c`, `v0`; optional: `v_m` (none); [`RateState2`](crate::RateState2) also with `b2`, `d_c2` | yes |
//! | [`AnyContactLaw`](crate::AnyContactLaw) | `dry`, `dwell`, `dahl`, `lugre` or `rate_state`, with that law | yes |
//! | [`PolynomialSpring`](crate::PolynomialSpring) | `coefficients`: a list | yes |
//! | [`Pendulum`](crate::Pendulum) | `moment`, `length` | yes |
//! | [`Backlash`](crate::Backlash) | `stiffness`, `gap` | yes |
//! | [`SnapThrough`](crate::SnapThrough) | `stiffness`, `free_length`, `span` | yes |
//! | [`VanDerPol`](crate::VanDerPol) | `negative_damping`, `nonlinear_damping` | yes |
//! | [`TabulatedForce`](crate::TabulatedForce) | `points`: a list of [position, force]; optional: `piecewise_linear` (false) | yes |
//! | [`Iwan4`](crate::Iwan4) | `slip_force`, `stiffness`, `exponent`, `ratio` | yes |
//! | [`Scaled`](crate::Scaled) | `law`, `velocity_unit` (m/s) | yes |
//! | [`Physical`](crate::Physical) | `mass`, `stiffness`, `damping`, `normal_force`, `belt_velocity`, in SI units | yes |
//! | [`Scaling`](crate::Scaling) | `physical`; optional: `length` (`normal_force`/`stiffness`) | yes |
//! | [`MassOnBelt`](crate::MassOnBelt) | `law`, `belt_velocity`; optional: `damping` (0), `load` (1) | yes |
//! | [`State`](crate::State) | `displacement`, `velocity` | yes |
//! | [`structure::State`](crate::structure::State) | `displacements`, `velocities`; optional: `memory`, and `sliding` as a list of [contact, relative velocity] (empty lists) | yes |
//! | [`Drive`](crate::Drive) | a number if it is constant (only read); or a map, all optional: `constant` (0); `harmonics` (none): a list of maps with `angular_frequency`, `cosine` and `sine`; `profiles` (none): a list of profiles, each a list of [time, value]; a drive with a function of your own is not written | yes |
//! | [`Contact`](crate::Contact) | `coordinate`; `law`: a map from the name of the law to the law, see below; `load`: a drive; optional: the fields of the next row | yes |
//! | `Contact`, continued | optional: `direction` (`coordinate` with the coefficient 1): a list of [coordinate, coefficient]; `load_gradient` (none): a list of [coordinate, force per displacement]; `load_laws` (none): a list of `ForceElement`; `belt_velocity` (0): a drive; `tangential_stiffness` (none); `normal_spring` (none): [direction, stiffness], with the direction as above | yes |
//! | [`Structure`](crate::Structure) | `masses`, or `mass_matrix`: a list of rows; optional: `stiffness` and `damping` (0): lists of rows; `forces` (0): a drive for each coordinate; `contacts`, `elements`, `stops`, `first_orders` (none) | yes |
//! | [`ForceElement`](crate::ForceElement) | `direction`: a list of [coordinate, coefficient]; `law`: a map from the name of the law to the law, see below; optional: `factor` (1): a drive | yes |
//! | [`Stop`](crate::Stop) | `direction`: a list of [coordinate, coefficient]; `gap`; `contact_stiffness`: [stiffness, damping]; optional: `restitution` (0), `adhesive` (false) | yes |
//! | [`FirstOrder`](crate::FirstOrder) | all optional: `time_constant` (an integrator); `displacements`, `velocities`, `states`, `forces` (none): lists of [number, gain]; `drive` (0): a drive; `laws` (none): a list of maps with `law`, a map as in the row before, and `of`: `{"direction": [[coordinate, coefficient], …]}` or `{"state": number}` | yes |
//! | [`Event`](crate::Event) | `time`, `element`: `{"contact": 0}` or `{"stop": 0}`, by its number; `kind`, `state` | yes |
//! | [`EventKind`](crate::EventKind) | `stick`, `open`, `close`; with the direction: `release`, `crossing` | yes |
//! | [`Mode`](crate::Mode) | `stick`, `open`, or `slip` with the direction | yes |
//! | [`Direction`](crate::Direction) | `lagging`, `leading` | yes |
//! | [`CycleKind`](crate::CycleKind) | `pure_slip`, `stick_slip`, `overshoot`, `crossing` | yes |
//! | [`Stability`](crate::Stability) | `stable_focus`, `stable_node`, `center`, `unstable_focus`, `unstable_node` | yes |
//! | [`Criticality`](crate::bifurcation::Criticality) | `supercritical`, `subcritical`, `degenerate` | yes |
//! | [`Equilibrium`](crate::Equilibrium) | `displacement`, `effective_damping`, `stability` | no |
//! | [`LimitCycle`](crate::LimitCycle) | `kind`, `belt_velocity`, `damping`, `multiplier`, `period`, `stick_duration`, `amplitude`, `mean_displacement`, `max_velocity`, `min_velocity`, `energy`, `state` (its start), `events` | no |
//! | [`CycleSet`](crate::CycleSet) | `cycles`, `continuum`, `unresolved`: a list of `start`, `end` | no |
//! | [`Continuum`](crate::limit_cycle::Continuum) | `max_amplitude`, `null` for ∞ | no |
//! | [`Attractor`](crate::limit_cycle::Attractor) | `rest`, `equilibrium`, `continuum`, `unbounded`, `unresolved`, or `cycle` or `separatrix` with the cycle | no |
//! | [`VibrationRange`](crate::bifurcation::VibrationRange) | `velocities`: `start`, `end`; `attractors` | no |
//! | [`structure::Sample`](crate::structure::Sample) | `time`, `state`, `modes`, `accelerations`, `friction`, `loads`, `element_forces`, `stop_forces` | no |
//! | [`Carried`](crate::structure::Carried) | `force`, `least`, `most` | no |
//! | [`Mechanism`](crate::structure::Mechanism) | `contacts`: a list of [number, relative velocity]; `power`, `resistance` | no |
//! | [`EnergyBudget`](crate::EnergyBudget) | `stored`, `force_work`, `drive_work`, `belt_work`, `friction_loss`, `normal_work`, `element_work`, `first_order_work`, `stop_loss`, `damper_loss`, `circulation`; lists, or numbers of a cycle of one mass | no |
//! | [`StabilityChange`](crate::structure::StabilityChange) | `time`, `becomes_stable`, `frequency` | no |
//! | [`Orbit`](crate::orbit::Orbit) | `period`, `is_stable`, `multipliers`: a list of [re, im]; `mean_velocities`; `extremes`, `velocity_extremes`: [least, largest] of each coordinate; `energy`, `state` (its start), `events` | no |
//! | [`Branch`](crate::orbit::Branch) | `points`: a list of maps with the fields `parameter`, `orbit`; `bifurcations`: a list of maps with the fields `parameter`, `kind`, `orbit`; `ends`: a list of two | no |
//! | [`BifurcationKind`](crate::orbit::BifurcationKind) | `fold`, `flip`, `pitchfork`, `neimark_sacker`, `grazing`, `sequence` | no |
//! | [`BranchEnd`](crate::orbit::BranchEnd) | `range`, `closed`, `work`; with the fields of the variant: `hopf`, `grazing`, `discontinuity`, `one_way_slip`, `birth`, `stopped`, `lost` (its `error` in words) | no |
//! | [`orbit::Attractor`](crate::orbit::Attractor) | `kind`, `orbit`: `null` if the attractor is not periodic | no |
//! | [`AttractorKind`](crate::AttractorKind) | `rest`, `steady_sliding`, `continuum`, `pure_slip`, `stick_slip`, `overshoot`, `crossing`, `irregular` | no |
//! | [`orbit::VibrationRange`](crate::orbit::VibrationRange) | `parameters` as `start` and `end`, `attractors`, `borders` | no |
//! | [`Border`](crate::orbit::Border) | `range`, `hopf`, `divergence`, `no_steady_sliding`, `no_system`, `discontinuity`, `unknown`, or `bifurcation` with its kind | no |
//! | [`Sweep`](crate::orbit::Sweep) | `up`, `down`: lists of maps with the fields `parameter`, `attractor`, `error` (in words); `stopped` | no |
//! | [`orbit::Change`](crate::orbit::Change) | `between`: a list of the two values of the parameter; `from`; `to` | no |
//! | [`DiagramPoint`](crate::bifurcation::DiagramPoint) | `belt_velocity`, `equilibrium`, `cycles` | no |
//!
//! The law of a contact is written under its name: `coulomb`, `exponential`, `polynomial`,
//! `rational`, `stribeck`, `tabulated`, `directional`, `freewheel`, `dwell`, `dahl`, `lugre` or
//! `rate_state`, or `dry` for an [`AnyContactLaw`](crate::AnyContactLaw) without memory. The law of
//! a force element is written under its name: `polynomial_spring`, `pendulum`, `backlash`,
//! `snap_through`, `van_der_pol` or `tabulated_force`. Your own law has no name, so writing its
//! contact or its force element is an error. Write the parameters of the law separately, and add
//! the contact or the element to the structure after reading.
//!
//! ```
//! use stick_slip::nalgebra::DMatrix;
//! use stick_slip::{Contact, Coulomb, Structure};
//!
//! let mass = DMatrix::from_row_slice(2, 2, &[2.0, 0.5, 0.5, 1.0]);
//! let joint = Contact::between(0, 1, Coulomb::new(0.4, 0.25)?, 3.0)?;
//! let structure = Structure::with_mass_matrix(mass)?.with_contact(joint)?;
//! let text = serde_json::to_value(&structure)?;
//! assert_eq!(text["mass_matrix"], serde_json::json!([[2.0, 0.5], [0.5, 1.0]]));
//! let contact = &text["contacts"][0];
//! assert_eq!(contact["direction"], serde_json::json!([[0, 1.0], [1, -1.0]]));
//! assert_eq!(contact["law"]["coulomb"]["static_coefficient"], 0.4);
//! assert_eq!(serde_json::from_value::<Structure>(text)?, structure);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A motion is neither written nor read: write its system, its start and its duration, and simulate
//! it again.
//!
//! ```
//! use stick_slip::{AnyLaw, Event, MassOnBelt, State};
//!
//! let system: MassOnBelt<AnyLaw> = serde_json::from_str(
//!     r#"{
//!         "law": {"stribeck": {
//!             "static_coefficient": 0.4, "coulomb_coefficient": 0.25,
//!             "stribeck_velocity": 0.1, "exponent": 1
//!         }},
//!         "belt_velocity": 0.2
//!     }"#,
//! )?;
//! let motion = system.simulate(State::new(0.0, 0.0), 10.0)?;
//! let text = serde_json::to_value(motion.events())?;
//! assert_eq!(text[1]["kind"], serde_json::json!({"release": "lagging"}));
//! let events: Vec<Event> = serde_json::from_value(text)?;
//! assert_eq!(events, motion.events());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! With the feature `float_roundtrip` of `serde_json`, every number is read back exactly. JSON has
//! no ∞ and no NaN; `serde_json` writes both as `null`. Three kinds of numbers can be affected: the
//! `max_amplitude` of a [`Continuum`](crate::limit_cycle::Continuum), energies that overflow, and
//! the `multipliers` at a [grazing that ends a branch](crate::orbit::BranchEnd::Grazing).
