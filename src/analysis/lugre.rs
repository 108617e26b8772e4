//! Bristles of [`LuGre`]: steady sliding, the small vibration of a mass on bristles, and passivity
//! (the bristles supply no energy).
//!
//! The equations of the bristles are z' = r − σ0|r|z/g(|r|) and μ = σ0 z + σ1 z' + σ2 r. z is the
//! deflection of the bristles, r the relative velocity, and μ the friction coefficient. g is the
//! kinetic coefficient of a dry law, σ0 the stiffness and σ1 the damping of the bristles, and σ2
//! the coefficient of viscous friction.
//!
//! Source: C. Canudas de Wit, H. Olsson, K. J. Åström, P. Lischinsky, *A new model for control of
//! systems with friction*, IEEE Trans. Automatic Control 40 (1995) 419-425, Eqs. 1-3; for passivity
//! N. Barahanov, R. Ortega, *Necessary and sufficient conditions for passivity of the LuGre
//! friction model*, IEEE Trans. Automatic Control 45 (2000) 830-832.

use crate::error::Error;
use crate::friction::memory::LuGre;
use crate::friction::{AlongSlope, FarEnd, FrictionLaw};

/// Steady sliding at a relative velocity r, with the rate at which a perturbation of the bristles
/// decays.
///
/// z is the deflection of the bristles, z' its time derivative, μ the friction coefficient, and
/// g(|r|) the dry law with the slope g'. σ0 is the stiffness of the bristles, and σ2 the
/// coefficient of viscous friction ([`LuGre`]).
///
/// ```text
/// z = sgn(r) g(|r|)/σ0,   μ = sgn(r) g(|r|) + σ2 r
/// perturbed:  ∂z'/∂r = |r| g'/g,   ∂z'/∂z = −σ0|r|/g
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SteadyBristles {
    /// Deflection z, in units of length.
    pub deflection: f64,
    /// Friction coefficient μ, dimensionless.
    pub coefficient: f64,
    /// Rate σ0|r|/g at which a perturbation of z decays, per unit of time. If this rate is much
    /// larger than the other rates of the system, the equations of motion are numerically stiff.
    pub rate: f64,
}

/// Deflection, coefficient and decay rate of the bristles in steady sliding at a relative velocity
/// r of either sign. Exact. `None` if r = 0, because any deflection is then in equilibrium, or if r
/// is not finite.
///
/// ```
/// use stick_slip::analysis::lugre::steady_bristles;
/// use stick_slip::{Coulomb, LuGre};
///
/// let law = LuGre::new(Coulomb::new(0.5, 0.4)?, 1e4, 10.0, 0.1)?;
/// let steady = steady_bristles(&law, -0.2).ok_or("at rest")?;
/// assert_eq!(steady.deflection, -0.4 / 1e4);
/// assert_eq!(steady.coefficient, -0.4 - 0.1 * 0.2);
/// assert_eq!(steady.rate, 1e4 * 0.2 / 0.4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn steady_bristles<L: FrictionLaw>(law: &LuGre<L>, velocity: f64) -> Option<SteadyBristles> {
    if velocity == 0.0 || !velocity.is_finite() {
        return None;
    }
    let coefficient = law.law().coefficient(velocity);
    Some(SteadyBristles {
        deflection: coefficient / law.stiffness(),
        coefficient: coefficient + law.viscous() * velocity,
        rate: law.stiffness() * (velocity / coefficient),
    })
}

/// The small vibration of a mass on bristles, with a spring and a damper.
///
/// m is the mass, k the stiffness of the spring, c the constant of the damper, N the normal load,
/// and x the displacement from the equilibrium. The bristles have the deflection z, the stiffness
/// σ0, the damping σ1 and the viscous coefficient σ2. x_0 is the displacement x at which they are
/// not deflected.
///
/// ```text
/// m x'' + (c + N(σ1 + σ2)) x' + (k + Nσ0) x = 0,   z = x − x_0
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ContactVibration {
    /// Angular frequency √((k + Nσ0)/m) without damping, in radians per unit of time.
    pub angular_frequency: f64,
    /// Damping ratio (c + N(σ1 + σ2))/(2√((k + Nσ0)m)), dimensionless.
    pub damping_ratio: f64,
}

/// The small vibration of a mass m on bristles, with a spring k, a damper c and a load N.
///
/// The formulas of [`ContactVibration`] hold in the limit of displacements that are small compared
/// with the deflection of the bristles in steady sliding. Any consistent units may be used.
///
/// `None` unless m and N are positive, k ≥ 0 and c ≥ 0, all finite.
///
/// ```
/// use stick_slip::analysis::lugre::contact_vibration;
/// use stick_slip::{Exponential, LuGre};
///
/// // Canudas de Wit et al., Table I: σ1 = √σ0 gives a mass of 1 kg a damping ratio near ½.
/// let law = LuGre::new(Exponential::new(1.5, 1.0, 0.001)?, 1e5, 1e5_f64.sqrt(), 0.4)?;
/// let vibration = contact_vibration(&law, 1.0, 1.0, 0.0, 0.0).ok_or("bad mass")?;
/// assert!((vibration.angular_frequency - 316.2277660168379).abs() < 1e-12);
/// assert!((vibration.damping_ratio - 0.5006324555320337).abs() < 1e-15);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn contact_vibration<L: FrictionLaw>(
    law: &LuGre<L>,
    mass: f64,
    load: f64,
    stiffness: f64,
    damping: f64,
) -> Option<ContactVibration> {
    let total = stiffness + load * law.stiffness();
    let damper = damping + load * (law.damping() + law.viscous());
    let in_range = mass > 0.0 && load > 0.0 && stiffness >= 0.0 && damping >= 0.0;
    let vibration = ContactVibration {
        angular_frequency: (total / mass).sqrt(),
        damping_ratio: 0.5 * damper / (total.sqrt() * mass.sqrt()),
    };
    let ContactVibration {
        angular_frequency,
        damping_ratio,
    } = vibration;
    let numbers = [mass, load, stiffness, angular_frequency, damping_ratio];
    let is_finite = numbers.iter().all(|number| number.is_finite());
    (in_range && is_finite).then_some(vibration)
}

/// The least viscous coefficient with which the bristles are passive at all sliding speeds up to
/// `max_speed`.
///
/// Passive bristles supply no energy: they return at most the energy N·σ0 z²/2 that they have
/// stored, with the normal load N, the stiffness σ0 and the deflection z. With the damping σ1 of
/// the bristles and the friction law g the condition for the viscous coefficient σ2 is
///
/// ```text
/// σ2 ≥ σ1 (g_max − g_min)/g_min,   g_max and g_min over 0 ≤ speed ≤ max_speed
/// ```
///
/// For a law that falls from the static coefficient μ_s to the kinetic coefficient μ_k this is the
/// condition of Barahanov and Ortega, σ2 ≥ σ1(μ_s − μ_k)/μ_k. If the speed is not limited, the
/// condition is also necessary: with a smaller σ2, bristles can supply energy to a mass. The law's
/// own σ2 is ignored; the result has the unit of σ1.
///
/// # Errors
///
/// * [`Error::InvalidParameter`] unless `max_speed` is positive and finite, g is positive at all
///   speeds up to `max_speed`, and the expansion of g over this range takes at most 10⁴ power
///   series;
/// * [`Error::NonFiniteFriction`] or [`Error::NotAnalytic`] if the law has no finite value or no
///   power series at a speed in this range.
///
/// ```
/// use stick_slip::analysis::lugre::passive_viscosity;
/// use stick_slip::{Exponential, LuGre};
///
/// let law = LuGre::new(Exponential::new(1.5, 1.0, 0.001)?, 1e5, 1e5_f64.sqrt(), 0.4)?;
/// let least = passive_viscosity(&law, 0.1)?;
/// // The law of Canudas de Wit et al., Table I, is not passive: σ2 = 158 s/m would be needed.
/// assert!((least - 0.5 * 1e5_f64.sqrt()).abs() < 1e-12);
/// assert!(law.viscous() < least);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn passive_viscosity<L: FrictionLaw>(law: &LuGre<L>, max_speed: f64) -> Result<f64, Error> {
    Error::check(
        "lugre::passive_viscosity",
        "max_speed",
        max_speed,
        max_speed > 0.0,
        "max_speed > 0",
    )?;
    let g = law.law();
    let slope = AlongSlope {
        law: g,
        constant: 0.0,
        factor: 1.0,
    };
    // A turning point below the least speed of the search is a speed of 0.
    let least_speed = f64::EPSILON * max_speed;
    let far = FarEnd {
        of: "lugre::passive_viscosity",
        name: "max_speed",
        value: max_speed,
    };
    let turns = slope.sign_changes(&(least_speed..max_speed), far)?;
    let speeds = turns.into_iter().chain([0.0, max_speed]);
    let (mut lowest, mut highest) = (f64::INFINITY, 0.0_f64);
    for speed in speeds {
        let value = g.kinetic(speed);
        let allowed = "a range of speeds in which g is positive";
        Error::check(
            "lugre::passive_viscosity",
            "max_speed",
            max_speed,
            value > 0.0,
            allowed,
        )?;
        (lowest, highest) = (lowest.min(value), highest.max(value));
    }
    Ok(law.damping() * (highest - lowest) / lowest)
}
