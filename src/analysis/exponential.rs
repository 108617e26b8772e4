//! Closed forms for the exponential law: the belt velocities at which steady sliding changes its
//! stability, and the damping that ends all vibration.
//!
//! The law is μ̂(s) = μ_k + (μ_s − μ_k)e^{−(s/v_s)²} (Farshidianfar and Noei Aghaee, Eq. 6), with
//! the static coefficient μ_s, the kinetic coefficient μ_k, the Stribeck velocity v_s and the
//! sliding speed s. β is the damping ratio, γ² the friction load and v_b the belt velocity.

use std::f64::consts::{E, FRAC_1_SQRT_2, SQRT_2};

use crate::belt::{Criticality, MassOnBelt};
use crate::friction::{Exponential, FrictionLaw};
use crate::numerics::bracket::root_between;

/// The two belt velocities v_low < v_high, dimensionless, between which steady sliding is unstable,
/// each with the type of the Hopf bifurcation.
///
/// One root v of the following equation lies below v_s/√2, and one above:
///
/// ```text
/// x e^{−x²} = c,   x = v/v_s,   c = β v_s/(γ²(μ_s − μ_k))
/// ```
///
/// β is the damping ratio, γ² the friction load, μ_s the static coefficient, μ_k the kinetic
/// coefficient at high speeds, and v_s the Stribeck velocity. The roots are exact to rounding,
/// except near c = 1/√(2e) (e: Euler's number), where both are ill-conditioned. The system's own
/// belt velocity is ignored.
///
/// `None` if c ≥ 1/√(2e), because steady sliding is then stable at every belt velocity. `None` also
/// if β = 0: steady sliding is then unstable at every belt velocity or, if friction is constant
/// (μ_s = μ_k), neutrally stable at every belt velocity.
///
/// For any law see [`bifurcation::hopf_velocities`](crate::bifurcation::hopf_velocities).
///
/// A Hopf point is supercritical below √(3/2) v_s, where the third derivative of the law is
/// positive: a small stable cycle exists where steady sliding is unstable. Above, a small unstable
/// cycle exists where steady sliding is stable, and a disturbance larger than this cycle leads to a
/// large vibration.
///
/// The Hopf point at v_low is always supercritical. Farshidianfar and Noei Aghaee say that this law
/// behaves "almost similar" to the polynomial law. This is wrong. The polynomial law rises at
/// speeds above its minimum, and the exponential law never rises. At the sliding speed 0 the slope
/// of the exponential law is 0, and that of the polynomial law is negative. With small damping,
/// steady sliding on a very slow belt is therefore stable with the exponential law and unstable
/// with the polynomial law.
///
/// Source: Farshidianfar and Noei Aghaee, Eqs. 6 and 14; the sign of the cubic term of the
/// [averaged equation](super::averaging) for the amplitude.
///
/// ```
/// use stick_slip::analysis::exponential::hopf_velocities;
/// use stick_slip::bifurcation::Criticality;
/// use stick_slip::{Exponential, MassOnBelt};
///
/// let system = MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let [low, high] = hopf_velocities(&system).unwrap();
/// assert!((low.0 - 0.0858251835248).abs() < 1e-13);
/// assert!((high.0 - 0.7385534615425).abs() < 1e-13);
/// assert_eq!((low.1, high.1), (Criticality::Supercritical, Criticality::Subcritical));
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn hopf_velocities(system: &MassOnBelt<Exponential>) -> Option<[(f64, Criticality); 2]> {
    let law = system.law();
    let drop = law.static_coefficient() - law.kinetic_coefficient();
    let c = system.damping() / system.load() / drop * law.stribeck_velocity();
    // The largest value of x e^{−x²}, at x = 1/√2.
    let largest = FRAC_1_SQRT_2 * (-0.5_f64).exp();
    if !(c > 0.0 && c < largest) {
        return None;
    }
    // Each root is sought in a form that keeps its relative accuracy for small c.
    let low = root_between(&mut |x| Ok(x - c * (x * x).exp()), c, FRAC_1_SQRT_2).ok()?;
    // x² = ln(x/c) ≤ x + ln(1/c)
    let bound = 0.5 + (0.25 - c.ln()).sqrt();
    let high = root_between(&mut |x| Ok(x * x - (x / c).ln()), FRAC_1_SQRT_2, bound).ok()?;
    Some([low, high].map(|x| {
        let criticality = if x < 1.5_f64.sqrt() {
            Criticality::Supercritical
        } else {
            Criticality::Subcritical
        };
        (x * law.stribeck_velocity(), criticality)
    }))
}

/// Damping ratio above which there is no vibration at any belt velocity, dimensionless.
///
/// It is γ²(μ_s − μ_k)/(v_s √(2e)), with the friction load γ², the static coefficient μ_s, the
/// kinetic coefficient μ_k at high speeds, the Stribeck velocity v_s and Euler's number e. At this
/// damping ratio the damper exactly balances the steepest fall of friction, which is at the sliding
/// speed v_s/√2. The system's own belt velocity v_b and damping ratio β are ignored.
///
/// The result is exact. With more damping the force 2βv + γ²μ(v − v_b) of damper and friction rises
/// with the velocity v of the mass, and every motion about the equilibrium loses energy. At exactly
/// this damping ratio there is no vibration either. The exception is μ_s = μ_k: the result is 0,
/// friction is constant, and at β = 0 every small vibration lasts.
///
/// Source: Farshidianfar and Noei Aghaee, Eqs. 6 and 14.
///
/// ```
/// use stick_slip::analysis::exponential::silencing_damping_everywhere;
/// use stick_slip::{Exponential, MassOnBelt};
///
/// let system = MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, 0.2)?;
/// let damping = 0.3 / (2.0 * std::f64::consts::E).sqrt();
/// assert!((silencing_damping_everywhere(&system) - damping).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "least_damping_everywhere")]
pub fn silencing_damping_everywhere(system: &MassOnBelt<Exponential>) -> f64 {
    let law = system.law();
    let drop = law.static_coefficient() - law.kinetic_coefficient();
    system.load() * drop / law.stribeck_velocity() / (SQRT_2 * E.sqrt())
}

/// Belt velocity above which no vibration lasts, dimensionless.
///
/// It is ∞ if the damping ratio β is 0, and 0 if β > 0 is at least
/// [`silencing_damping_everywhere`]. In between the result is `None`: no formula is known. The
/// larger of the [`hopf_velocities`] is not the answer, because stick-slip vibration can last where
/// steady sliding is stable. The system's own belt velocity is ignored.
///
/// ```
/// use stick_slip::analysis::exponential::quiet_velocity;
/// use stick_slip::{Exponential, MassOnBelt};
///
/// let system = MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, 0.2)?;
/// assert_eq!(quiet_velocity(&system), Some(f64::INFINITY));
/// assert_eq!(quiet_velocity(&system.with_damping(0.1)?), None);
/// assert_eq!(quiet_velocity(&system.with_damping(0.2)?), Some(0.0));
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn quiet_velocity(system: &MassOnBelt<Exponential>) -> Option<f64> {
    if system.damping() == 0.0 {
        Some(f64::INFINITY)
    } else if system.damping() < silencing_damping_everywhere(system) {
        None
    } else {
        Some(0.0)
    }
}
