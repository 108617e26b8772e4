//! Formulas: closed forms and averaging, each with its source and the order of its error.
//!
//! Nothing here integrates the equations of motion, so the formulas and the exact motions of the
//! rest of the crate are independent of each other. Orders of error are in ε for (γ², β) → (εγ²,
//! εβ): friction and damping that are weak beside the spring. "Eq. n" is an equation of
//! Farshidianfar and Noei Aghaee, *Analytical Approaches for Friction Induced Vibration and
//! Stability Analysis*; "Eq. n, corrected" is one that they print wrongly, and the doc says how.
//!
//! | Question | Answer |
//! |---|---|
//! | where the mass can stand still on the moving belt, and whether it stays there | [`equilibrium`] |
//! | vibration that never sticks, polynomial law | [`PureSlip`], [`PureSlipCycle`], [`Transient`] |
//! | vibration that sticks, any law | [`StickSlip`], [`StickSlipCycle`] |
//! | weak friction, any law: slow growth and decay, all cycles | [`averaging`] |
//! | which of them happens | [`regime`] |
//! | how much damping, or which belt velocity, keeps it quiet | [`design`] |
//! | Coulomb's and the exponential law | [`coulomb`], [`exponential`] |
//! | a harmonic force on a mass with dry friction: amplitude, and when it stops | [`forced`] |
//! | a belt that oscillates, as a force | [`oscillating_belt`] |
//! | friction under fast vibration | [`fast_vibration`] |
//! | flutter by mode coupling | [`mode_coupling`] |
//! | two inertias with friction at the far one | [`drill_string`] |
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

pub mod averaging;
pub mod coulomb;
pub mod design;
pub mod drill_string;
pub mod exponential;
pub mod fast_vibration;
pub mod forced;
pub mod mode_coupling;
pub mod oscillating_belt;
mod pure_slip;

mod regime;
mod roots;
mod stick_slip;
mod transient;

pub use pure_slip::{PureSlip, PureSlipCycle};
pub use regime::{Regime, regime};
pub use stick_slip::{StickSlip, StickSlipCycle};
pub use transient::Transient;

use crate::belt::{Equilibrium, MassOnBelt};
use crate::friction::FrictionLaw;

/// The steady sliding state, in which the mass stands still on the moving belt: Eq. 7 (corrected),
/// Eq. 10a for any law, and Eq. 14. `None` at v_b = 0. Exact.
///
/// The same as [`MassOnBelt::equilibrium`].
///
/// ```
/// use stick_slip::{MassOnBelt, Polynomial, Stability, analysis};
///
/// // Above v_b1 = 0.441 the mass slides steadily.
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.46)?.with_damping(0.05)?;
/// let equilibrium = analysis::equilibrium(&system).unwrap();
/// assert_eq!(equilibrium.stability, Stability::StableFocus);
/// assert!((equilibrium.jacobian[(1, 1)] + 0.03088).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn equilibrium<L: FrictionLaw>(system: &MassOnBelt<L>) -> Option<Equilibrium> {
    system.equilibrium()
}
