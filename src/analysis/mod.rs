//! Formulas: closed forms and averaging, each with its source and the order of its error.
//!
//! ```
//! use stick_slip::analysis::{PureSlip, Regime, StickSlip, regime};
//! use stick_slip::{MassOnBelt, Polynomial};
//!
//! let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.42)?.with_damping(0.05)?;
//! assert_eq!(regime(&system), Regime::PureSlip);
//! let cycle = PureSlip::new(&system).and_then(|formulas| formulas.fourth_order()).unwrap();
//! assert!((cycle.period - 6.32748385).abs() < 1e-8); // exact: 6.32749178
//!
//! let slower = system.with_belt_velocity(0.2)?;
//! assert_eq!(regime(&slower), Regime::StickSlip);
//! let cycle = StickSlip::new(&slower).and_then(|formulas| formulas.second_order()).unwrap();
//! assert!((cycle.v_min + 0.2893).abs() < 1e-4); // exact: −0.2861
//! # Ok::<(), stick_slip::Error>(())
//! ```
//!
#![doc = include_str!("../figures/errors.svg")]
//!
//! *Difference between the formulas and the exact cycle, for the friction load γ² = ε and the
//! damping ratio β = 0.05ε. The slope of a line is the order of the error. (a) Cycles without
//! stick. (b) Stick-slip.*
//!
//! Symbols are those of the [crate page](crate#the-mass-on-its-belt) and of [`PureSlip`]. No
//! function of this module integrates the equations of motion, so the formulas are an independent
//! check of the computed motions. O(εⁿ) is the order of an error as friction and damping become
//! weak compared with the spring: (γ², β) → (εγ², εβ), ε → 0. "Eq. n", if no other source is named,
//! is an equation of A. Farshidianfar and N. Noei Aghaee, *Analytical Approaches for Friction
//! Induced Vibration and Stability Analysis*. "Eq. n, corrected" is an equation that is printed
//! wrongly in the paper; the table below lists the corrections.
//!
//! | Question | Answer |
//! |---|---|
//! | steady sliding of a mass on a belt, and its stability | [`MassOnBelt::equilibrium`](crate::MassOnBelt::equilibrium) |
//! | vibration that never sticks, polynomial law | [`PureSlip`], [`PureSlipCycle`], [`Transient`] |
//! | vibration that sticks | any law: [`StickSlip`]; a cubic law, more accurately: [`StickSlipCycle`] |
//! | weak friction, any law: slow growth and decay, cycles that do not stick | [`averaging`] |
//! | which motion the mass settles to, polynomial law | [`regime`] |
//! | the damping, or the belt velocity, above which there is no vibration | [`design`] |
//! | closed forms for Coulomb's, the exponential or the polynomial law | [`coulomb`], [`exponential`], [`polynomial`] |
//! | a harmonic force on a mass with dry friction: amplitude, and the condition for motion without stick | [`forced`] |
//! | a spring in series with a dry slider: first harmonic, hysteresis, exact response of one mass | [`jenkins`]; many in parallel: [`Iwan4`](crate::Iwan4) |
//! | static friction that rises during stick: cycles, and the condition for their existence | [`dwell`] |
//! | bristles: steady sliding, small vibration of a mass, passivity | [`lugre`] |
//! | rate-and-state friction: velocity steps, holds, time to instability, stress drop | [`rate_state`] |
//! | friction under fast vibration | [`fast_vibration`] |
//! | flutter by mode coupling | [`mode_coupling`] |
//! | a hardening or softening spring: period, decay by dry friction, response to a harmonic force | [`duffing`] |
//! | two inertias on a shaft, with friction at one of them | [`drill_string`] |
//!
//! # Where the source paper is wrong
//!
//! The paper of Farshidianfar and Noei Aghaee follows J. J. Thomsen and A. Fidlin, *Analytical
//! approximations for stick-slip vibration amplitudes*, Int. J. Non-Linear Mech. 38 (2003) 389-403.
//! The following formulas and statements of the paper are wrong as printed; tests show that the
//! printed formulas fail.
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
//! | after Eq. 15 | stick-slip outside v_b0 < v_b < v_b1 | stick-slip below v_b0; steady sliding above v_b1 |
//! | Eqs. 16-18 | A1 is the stick-slip amplitude | A1 is the amplitude of a slip arc that gains no energy from friction; see [`StickSlip`] |
//! | section 3.2, abstract | μ of Eq. 6 falls, then rises | μ falls at all speeds; with damping, steady sliding is stable again on a slow belt |
//! | Fig. 3 | the concavity changes at v_s | it changes at v_s/√2 |
//! | section 4.2 | the integrals cannot be solved | [`averaging`] computes them to round-off |

pub mod averaging;
pub mod coulomb;
pub mod design;
pub mod drill_string;
pub mod duffing;
pub mod dwell;
pub mod exponential;
pub mod fast_vibration;
pub mod forced;
pub mod jenkins;
pub mod lugre;
pub mod mode_coupling;
pub mod polynomial;
mod pure_slip;
pub mod rate_state;
mod regime;
mod slip_arc;
mod stick_slip;
mod transient;

pub use pure_slip::{PureSlip, PureSlipCycle};
pub use regime::{Regime, regime};
pub use stick_slip::{StickSlip, StickSlipCycle};
pub use transient::Transient;

use crate::belt::{Equilibrium, MassOnBelt};
use crate::friction::FrictionLaw;

/// The equilibrium of a system; use [`MassOnBelt::equilibrium`].
#[doc(hidden)]
pub fn equilibrium<L: FrictionLaw>(system: &MassOnBelt<L>) -> Option<Equilibrium> {
    system.equilibrium()
}
