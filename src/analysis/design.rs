//! Design against vibration: the least damping for stable steady sliding, and the belt velocity
//! above which no vibration lasts.
//!
//! **Stabilizing** damping makes steady sliding stable. With **silencing** damping, or more, no
//! vibration lasts. (The exception is silencing damping 0 with constant friction: without damping,
//! small vibrations then last.) Stable steady sliding is not always enough: a stick-slip motion may
//! also exist, and lasts for ever once a disturbance has started it.
//!
//! | Question | any law | polynomial, exponential, Coulomb |
//! |---|---|---|
//! | least damping for stable steady sliding at one belt velocity | [`stabilizing_damping`] | |
//! | least damping without vibration at one belt velocity | [`silencing_damping`](crate::bifurcation::silencing_damping) | [`coulomb::silencing_damping`] |
//! | least damping for stable steady sliding over a range of belt velocities | [`stabilizing_damping_over`] | |
//! | least damping without vibration at any belt velocity | | [`polynomial`], [`exponential`], [`coulomb`]`::silencing_damping_everywhere` |
//! | belt velocity above which no vibration lasts | | [`polynomial`], [`exponential`], [`coulomb`]`::quiet_velocity` |
//!
//! [`polynomial`]: super::polynomial
//! [`exponential`]: super::exponential
//! [`coulomb`]: super::coulomb
//! [`coulomb::silencing_damping`]: super::coulomb::silencing_damping

use std::ops::Range;

use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::{AlongSlope, FarEnd, FrictionLaw};

/// Damping ratio above which steady sliding at the system's belt velocity is stable. Dimensionless,
/// exact.
///
/// It is max(0, −½γ² dμ̂/ds), with the friction load γ² and the slope dμ̂/ds of the law at the
/// sliding speed |v_b|, the speed of the belt. `None` if v_b = 0. The system's own damping ratio β
/// is ignored.
///
/// With more damping, small disturbances decay. Large disturbances need not. With the exponential
/// law, and with a law with μ_s > μ̂(0) such as Coulomb's, a stick-slip vibration may exist
/// although steady sliding is stable. (μ_s is the static coefficient, and μ̂(0) the kinetic
/// coefficient at the sliding speed 0.) With the polynomial law large disturbances decay, too, if
/// friction is weak compared with the spring.
///
/// Source: Farshidianfar and Noei Aghaee, Eq. 14: the eigenvalues of steady sliding have negative
/// real parts if 2β + γ² dμ̂/ds > 0.
///
/// ```
/// use stick_slip::analysis::design::stabilizing_damping;
/// use stick_slip::{MassOnBelt, Polynomial, Stability};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?;
/// let damping = stabilizing_damping(&system).unwrap();
/// assert!((damping - 0.189).abs() < 1e-15);
/// let damped = system.with_damping(damping + 1e-6)?;
/// assert_eq!(damped.equilibrium().unwrap().stability, Stability::StableFocus);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "least_damping")]
pub fn stabilizing_damping<L: FrictionLaw>(system: &MassOnBelt<L>) -> Option<f64> {
    let speed = system.belt_velocity().abs();
    (speed > 0.0).then(|| (-0.5 * system.load() * system.law().slope(speed)).max(0.0))
}

/// Damping ratio above which steady sliding is stable at every belt velocity in a range.
/// Dimensionless, exact to rounding.
///
/// It is ½γ² times the largest −dμ̂/ds in this range, or 0 if the law does not fall there. (γ² is
/// the friction load, dμ̂/ds the slope of the law.) The system's own belt velocity and damping are
/// ignored.
///
/// The law is expanded in power series from one end of the range to the other. Each series is used
/// only within its radius of convergence, and is compared with the law at three points of its
/// interval. The steepest fall is the least dμ̂/ds at the ends of the intervals, at the
/// breakpoints, and at all minima of dμ̂/ds. Root isolation of each series finds all minima.
///
/// # Errors
///
/// * [`Error::InvalidParameter`] unless 0 ≤ start < end and both are finite, or if the expansion of
///   the law over the range takes more than 10⁴ power series;
/// * [`Error::NonFiniteFriction`] or [`Error::NotAnalytic`] if the law has no finite value or no
///   power series at a speed in the range.
///
/// ```
/// use stick_slip::analysis::design::stabilizing_damping_over;
/// use stick_slip::{Exponential, MassOnBelt};
///
/// let system = MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, 0.2)?;
/// let damping = stabilizing_damping_over(&system, 0.0..2.0)?;
/// assert!((damping - 0.3 / (2.0 * std::f64::consts::E).sqrt()).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "least_damping_over")]
pub fn stabilizing_damping_over<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    velocities: Range<f64>,
) -> Result<f64, Error> {
    let (start, end) = (velocities.start, velocities.end);
    Error::check(
        "design::stabilizing_damping_over",
        "velocities.start",
        start,
        start >= 0.0,
        "0 ≤ velocities.start",
    )?;
    Error::check(
        "design::stabilizing_damping_over",
        "velocities.end",
        end,
        end > start,
        "velocities.end > velocities.start",
    )?;
    let slope = AlongSlope {
        law: system.law(),
        constant: 0.0,
        factor: 1.0,
    };
    let far = FarEnd {
        of: "design::stabilizing_damping_over",
        name: "velocities.end",
        value: end,
    };
    let steepest = -slope.least(velocities, far)?;
    Ok(0.5 * system.load() * steepest.max(0.0))
}
