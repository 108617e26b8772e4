//! Closed forms for the polynomial law: the damping and the belt velocity above which there is no
//! vibration.
//!
//! The law is that of Farshidianfar and Noei Aghaee, Eqs. 3-5. It falls from the static coefficient
//! μ_s to its least coefficient μ_m at the sliding speed v_m. β is the damping ratio, γ² the
//! friction load and v_b the belt velocity.

use super::PureSlip;
use crate::belt::MassOnBelt;
use crate::friction::{FrictionLaw, Polynomial};

/// Damping ratio above which there is no vibration at any belt velocity, dimensionless.
///
/// It is η/2 with η = (3/2)γ²(μ_s − μ_m)/v_m. γ² is the friction load, μ_s the static coefficient,
/// and μ_m the least coefficient, at the sliding speed v_m. At this damping ratio the damper
/// exactly balances the steepest fall of friction, which is at the sliding speed 0. The system's
/// own belt velocity v_b and damping ratio β are ignored.
///
/// The result is exact. With more damping the force 2βv + γ²μ(v − v_b) of damper and friction rises
/// with the velocity v of the mass, and every motion about the equilibrium loses energy. At exactly
/// β = η/2 there is no vibration either. The exception is μ_s = μ_m: η is 0, friction is constant,
/// and at β = 0 every small vibration lasts.
///
/// Source: Farshidianfar and Noei Aghaee, Eqs. 10a and 14.
///
/// ```
/// use stick_slip::analysis::polynomial::silencing_damping_everywhere;
/// use stick_slip::{MassOnBelt, Polynomial};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?;
/// assert!((silencing_damping_everywhere(&system) - 0.225).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "least_damping_everywhere")]
pub fn silencing_damping_everywhere(system: &MassOnBelt<Polynomial>) -> f64 {
    let law = system.law();
    let drop = law.static_coefficient() - law.minimum_coefficient();
    0.75 * system.load() * drop / law.minimum_velocity()
}

/// Belt velocity above which no vibration lasts, dimensionless.
///
/// Without damping and with constant friction it is ∞, because small vibrations then last at every
/// belt velocity. Otherwise it is v_b1 = v_m√(1 − 2β/η) if 2β < η, and 0 if 2β ≥ η. β is the
/// damping ratio, v_m the sliding speed of least friction, and η/2 the
/// [`silencing_damping_everywhere`]. `None` if a coefficient overflows. The system's own belt
/// velocity is ignored.
///
/// v_b1 is exactly the limit of stable steady sliding. No other motion lasts above v_b1 if friction
/// is weak compared with the spring.
///
/// Source: Farshidianfar and Noei Aghaee, after Eq. 15.
///
/// ```
/// use stick_slip::analysis::polynomial::quiet_velocity;
/// use stick_slip::{MassOnBelt, Polynomial};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// assert!((quiet_velocity(&system).unwrap() - 0.4409585518).abs() < 1e-10);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn quiet_velocity(system: &MassOnBelt<Polynomial>) -> Option<f64> {
    let law = system.law();
    if law.static_coefficient() == law.minimum_coefficient() && system.damping() == 0.0 {
        return Some(f64::INFINITY);
    }
    let v_m = law.minimum_velocity();
    let formulas = PureSlip::new(&system.with_belt_velocity(v_m).ok()?)?;
    Some(formulas.onset_velocity().unwrap_or(0.0))
}
