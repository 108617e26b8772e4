//! Friction under a fast vibration along the surface: its mean over a period of this vibration acts
//! on the slow motion.
//!
//! If a belt vibrates at a frequency Ω far above the natural frequencies of the system, a fast
//! relative velocity w cos Ωt is added to the slow relative velocity v. The mean of the friction
//! coefficient over one period 2π/Ω then acts on the slow motion. All formulas are dimensionless
//! and hold in the limit Ω → ∞. The means below are those of Coulomb's law with the kinetic
//! coefficient μ_k, and of the cubic law [`Polynomial`] with the static coefficient μ_s and the
//! coefficients k1 and k3.
//!
//! ```text
//! Coulomb:   μ_k (2/π) arcsin(v/w)  for |v| < w        no jump at v = 0, and no stick
//! cubic:     μ_s − k1 v + k3(v³ + (3/2) v w²)  for v > w
//! ```
//!
//! Source: J. J. Thomsen, *Using fast vibrations to quench friction-induced oscillations*, J. Sound
//! Vib. 228 (1999) 1079-1102.

use std::f64::consts::FRAC_2_PI;

use super::PureSlip;
use crate::belt::MassOnBelt;
use crate::friction::{Coulomb, Polynomial};

/// Mean friction coefficient of Coulomb's law under a fast vibration, dimensionless.
///
/// v is the slow relative velocity, w ≥ 0 the velocity amplitude of the vibration, and μ_k the
/// kinetic coefficient. The mean is μ_k(2/π) arcsin(v/w) for |v| < w, and μ_k sgn v for |v| ≥ w.
/// This is the limit of a vibration of infinitely high frequency. NaN if v is NaN, and unless
/// w ≥ 0.
///
/// ```
/// use stick_slip::Coulomb;
/// use stick_slip::analysis::fast_vibration::mean_coefficient;
///
/// let law = Coulomb::new(0.4, 0.3)?;
/// assert!((mean_coefficient(&law, 0.1, 0.2) - 0.1).abs() < 1e-16); // arcsin ½ = π/6
/// assert_eq!(mean_coefficient(&law, -0.5, 0.2), -0.3);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn mean_coefficient(law: &Coulomb, velocity: f64, amplitude: f64) -> f64 {
    if velocity.is_nan() || amplitude.is_nan() || amplitude < 0.0 {
        return f64::NAN;
    }
    let kinetic = law.kinetic_coefficient();
    if velocity.abs() < amplitude {
        kinetic * FRAC_2_PI * (velocity / amplitude).asin()
    } else if velocity == 0.0 {
        0.0
    } else {
        kinetic.copysign(velocity)
    }
}

/// Belt velocity v above which steady sliding is stable under a fast vibration, for the cubic law.
/// Dimensionless.
///
/// v² = v_m²(1 − 2β/η) − w²/2. w ≥ 0 is the velocity amplitude of the vibration, β the damping
/// ratio, v_m the sliding speed of least friction, and [`η`](PureSlip::eta) the rate at which the
/// friction force falls at the sliding speed 0. This is the limit of a vibration of infinitely high
/// frequency.
///
/// The formula holds for v > w. If it gives no v > w, steady sliding is stable at every belt
/// velocity above w, and the result is `None`. `None` also if w is negative or NaN. The system's
/// own belt velocity is ignored. For w = 0 the result is
/// [`PureSlip::onset_velocity`](super::PureSlip::onset_velocity).
///
/// ```
/// use stick_slip::analysis::fast_vibration::onset_velocity;
/// use stick_slip::{MassOnBelt, Polynomial};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// assert!((onset_velocity(&system, 0.2).unwrap() - 0.4176654695).abs() < 1e-10);
/// assert_eq!(onset_velocity(&system, 0.4), None); // 0.34 < w
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn onset_velocity(system: &MassOnBelt<Polynomial>, amplitude: f64) -> Option<f64> {
    if amplitude.is_nan() || amplitude < 0.0 {
        return None;
    }
    // `PureSlip` needs a v_b that is not 0; the onset velocity does not depend on it.
    let moving = system
        .with_belt_velocity(system.law().minimum_velocity())
        .ok()?;
    let still = PureSlip::new(&moving)?.onset_velocity()?;
    let velocity = (still * still - 0.5 * amplitude * amplitude).sqrt();
    (velocity > amplitude).then_some(velocity)
}
