use std::ops::Range;

use super::positive;
use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::{AlongSlope, FrictionLaw};

/// Belt velocities v_b in `range`, ascending and dimensionless, at which the equilibrium loses or
/// regains stability: h1 changes its sign,
///
/// ```text
/// h1(v) = 2β + γ² dμ̂/ds(v).
/// ```
///
/// The law is expanded in power series from one end of the range to the other. Each series is used
/// as far as it converges, and checked in between; its roots are isolated so that none is skipped.
/// Where h1 touches zero to rounding and keeps its sign, stability does not change, and nothing is
/// reported. A [breakpoint](FrictionLaw::breakpoints) at which h1 jumps over zero is reported.
/// Where h1 is zero over a whole interval, the end of that interval is reported, if the signs
/// before and behind the interval differ.
///
/// For the exponential law there is the closed form
/// [`analysis::exponential::hopf_velocities`](crate::analysis::exponential::hopf_velocities).
///
/// Source: Farshidianfar and Noei Aghaee, Eqs. 10a and 14, for any law.
///
/// # Errors
///
/// [`Error::InvalidParameter`] unless the range is finite, not empty and holds positive velocities,
/// or if it is so long that the law takes more than 10⁴ power series; [`Error::NonFiniteFriction`]
/// or [`Error::NotAnalytic`] if the law has no power series somewhere in the range.
///
/// ```
/// use stick_slip::{Exponential, MassOnBelt, bifurcation};
///
/// let system = MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let hopf = bifurcation::hopf_velocities(&system, 0.0..10.0)?;
/// assert_eq!(hopf.len(), 2);
/// assert!((hopf[0] - 0.0858251835248284677).abs() < 1e-15);
/// assert!((hopf[1] - 0.738553461542470176).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "sweep")]
pub fn hopf_velocities<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    range: Range<f64>,
) -> Result<Vec<f64>, Error> {
    let damping = AlongSlope {
        law: system.law(),
        constant: 2.0 * system.damping(),
        factor: system.load(),
    };
    damping.sign_changes(&positive(range)?, "range.end")
}

/// Kind of a Hopf point: whether the pure-slip cycle that is born there is stable.
///
/// Source: the averaged equation A' = −½h1 A − (3/8)h3 A³ with h3 = γ² μ̂'''(v_b)/6 (Eq. 12 of
/// Farshidianfar and Noei Aghaee, for any law).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Criticality {
    /// A stable cycle surrounds the unstable equilibrium: μ̂'''(v_b) > 0.
    Supercritical,
    /// An unstable cycle surrounds the stable equilibrium: μ̂'''(v_b) < 0.
    Subcritical,
    /// The third derivative is zero, so that higher ones decide; or it is not a number.
    Degenerate,
}

impl std::fmt::Display for Criticality {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Supercritical => "supercritical",
            Self::Subcritical => "subcritical",
            Self::Degenerate => "degenerate",
        })
    }
}

/// Whether the Hopf point at the belt velocity v_b is super- or subcritical, from the sign of
/// μ̂'''(|v_b|).
///
/// Whether v_b is a Hopf point is not checked. At a breakpoint of the law, the piece above counts.
/// If h1 jumps over zero at the breakpoint, the third derivative tells nothing.
///
/// ```
/// use stick_slip::bifurcation::{Criticality, criticality, hopf_velocities};
/// use stick_slip::{Exponential, MassOnBelt};
///
/// let system = MassOnBelt::new(Exponential::new(0.6, 0.3, 0.4)?, 1.0)?.with_damping(0.01)?;
/// let hopf = hopf_velocities(&system, 0.0..5.0)?;
/// assert_eq!(criticality(&system, hopf[0]), Criticality::Supercritical);
/// assert_eq!(criticality(&system, hopf[1]), Criticality::Subcritical);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn criticality<L: FrictionLaw>(system: &MassOnBelt<L>, belt_velocity: f64) -> Criticality {
    let third = system.law().derivative(3, belt_velocity.abs());
    if third > 0.0 {
        Criticality::Supercritical
    } else if third < 0.0 {
        Criticality::Subcritical
    } else {
        Criticality::Degenerate
    }
}
