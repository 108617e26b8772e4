//! Closed forms for the exponential law (Gaussian Stribeck), Eq. 6.

use std::f64::consts::FRAC_1_SQRT_2;

use super::roots::refine;
use crate::belt::MassOnBelt;
use crate::friction::{Exponential, FrictionLaw};

/// A belt velocity at which steady sliding gains or loses stability, and what happens there.
///
/// Source: 2β + γ²μ̂'(v) = 0, Eq. 14; the cubic term of the averaged flow, −γ²μ̂'''(v)A³/16, says
/// which way the cycle goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HopfPoint {
    velocity: f64,
    is_supercritical: bool,
}

impl HopfPoint {
    /// Belt velocity |v_b|, dimensionless. Exact.
    pub fn velocity(&self) -> f64 {
        self.velocity
    }

    /// Whether a small stable cycle is born on the unstable side (μ̂''' > 0, which is v < √(3/2)
    /// v_s). If not, a small unstable one lies on the stable side, and a disturbance beyond it
    /// leads to a large vibration. Exact.
    pub fn is_supercritical(&self) -> bool {
        self.is_supercritical
    }
}

/// The two belt velocities v_low < v_high between which steady sliding is unstable: the roots of
///
/// ```text
/// x e^{−x²} = c,   x = v/v_s,   c = β v_s/(γ²(μ_s − μ_k))
/// ```
///
/// on either side of x = 1/√2. Dimensionless, exact to rounding (near c = 1/√(2e) both roots are
/// ill-conditioned). `None` where c ≥ 1/√(2e): steady sliding is stable at every belt velocity; and
/// where c = 0 (β = 0): unstable at every belt velocity. The system's own v_b is ignored. For any
/// law: [`bifurcation::hopf_velocities`](crate::bifurcation::hopf_velocities).
///
/// The low one is always supercritical. The paper says that this law behaves "almost similar" to
/// the polynomial one: it does not, for it never rises, and on a slow belt sliding is stable.
///
/// Source: Eqs. 6 and 14.
///
/// ```
/// use stick_slip::analysis::exponential::hopf_velocities;
/// use stick_slip::{Exponential, MassOnBelt};
///
/// let system = MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let [low, high] = hopf_velocities(&system).unwrap();
/// assert!((low.velocity() - 0.0858251835248).abs() < 1e-13);
/// assert!((high.velocity() - 0.7385534615425).abs() < 1e-13);
/// assert!(low.is_supercritical() && !high.is_supercritical());
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn hopf_velocities(system: &MassOnBelt<Exponential>) -> Option<[HopfPoint; 2]> {
    let law = system.law();
    let drop = law.static_coefficient() - law.kinetic_coefficient();
    let c = system.damping() / system.load() / drop * law.stribeck_velocity();
    // The largest value of x e^{−x²}, at x = 1/√2.
    let largest = FRAC_1_SQRT_2 * (-0.5_f64).exp();
    if !(c > 0.0 && c < largest) {
        return None;
    }
    // Each branch in a form that keeps its relative accuracy for small c.
    let low = refine(c, FRAC_1_SQRT_2, |x| Ok(x - c * (x * x).exp())).ok()?;
    // x² = ln(x/c) ≤ x + ln(1/c)
    let bound = 0.5 + (0.25 - c.ln()).sqrt();
    let high = refine(FRAC_1_SQRT_2, bound, |x| Ok(x * x - (x / c).ln())).ok()?;
    Some([low, high].map(|x| HopfPoint {
        velocity: x * law.stribeck_velocity(),
        is_supercritical: x < 1.5_f64.sqrt(),
    }))
}
