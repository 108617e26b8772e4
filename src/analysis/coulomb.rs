//! Closed forms for Coulomb's law: stick-slip, the limits of its existence, and free vibration.
//!
//! The law has the static coefficient μ_s and the kinetic coefficient μ_k. β is the damping ratio,
//! γ² the friction load and v_b the belt velocity.

use std::f64::consts::PI;

use super::dwell::{DwellOscillator, ExactCycle};
use super::slip_arc::{SMALL, tangential_angle};
use crate::belt::MassOnBelt;
use crate::friction::memory::Dwell;
use crate::friction::{Coulomb, FrictionLaw};
use crate::numerics::bracket::root_between;
use crate::state::State;

/// The slip phase at the belt velocity below which there is a stick-slip cycle.
///
/// This belt velocity is γ²(μ_s − μ_k)Λ, with the friction load γ², the static coefficient μ_s and
/// the kinetic coefficient μ_k. At the end of the slip phase the velocity of the mass reaches the
/// belt velocity tangentially. The duration s and the factor Λ depend on the damping ratio β alone.
///
/// ```text
/// e^{βs}[cos ω_d s − (β/ω_d) sin ω_d s] = 1,   π < ω_d s < 2π,   ω_d = √(1 − β²)
/// Λ = ω_d e^{−βs}/(−sin ω_d s)      ≈ 1/√(4πβ) for small β
/// ```
///
/// Source: the exact solution of the equation of slip, which is linear for Coulomb's law.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct TangentialSlip {
    /// Duration s of slip, dimensionless.
    pub duration: f64,
    /// Factor Λ, dimensionless: the belt velocity of this slip phase, divided by γ²(μ_s − μ_k).
    pub velocity_factor: f64,
}

/// The slip phase at the belt velocity below which there is a stick-slip cycle: its duration, and
/// the factor Λ of this belt velocity, γ²(μ_s − μ_k)Λ.
///
/// The argument is the damping ratio β. γ² is the friction load, μ_s the static and μ_k the kinetic
/// coefficient; [`TangentialSlip`] has the formulas. Exact to rounding. `None` unless 0 < β < 1.
///
/// ```
/// use stick_slip::analysis::coulomb::tangential_slip;
///
/// let slip = tangential_slip(0.01).unwrap();
/// assert!((slip.duration - 5.932286332296).abs() < 1e-12);
/// assert!((slip.velocity_factor - 2.739240416788).abs() < 1e-12);
/// assert_eq!(tangential_slip(1.0), None);
/// ```
pub fn tangential_slip(damping: f64) -> Option<TangentialSlip> {
    let theta = tangential_angle(damping)?;
    let frequency = ((1.0 - damping) * (1.0 + damping)).sqrt();
    let duration = (2.0 * PI - theta) / frequency;
    Some(TangentialSlip {
        duration,
        velocity_factor: frequency * (-damping * duration).exp() / theta.sin(),
    })
}

/// Belt velocity below which there is a stick-slip cycle, dimensionless. Exact.
///
/// This velocity is γ²(μ_s − μ_k)Λ(β), with the friction load γ², the static coefficient μ_s, the
/// kinetic coefficient μ_k, the damping ratio β, and the factor Λ that [`tangential_slip`]
/// computes. At every belt velocity v_b with 0 < |v_b| < γ²(μ_s − μ_k)Λ there is a stick-slip
/// cycle.
///
/// The result is infinite if β = 0 and μ_s > μ_k, and 0 (no stick-slip cycle) if β ≥ 1 or μ_s =
/// μ_k. The system's own belt velocity is ignored.
///
/// ```
/// use stick_slip::analysis::coulomb::largest_stick_slip_velocity;
/// use stick_slip::{Coulomb, MassOnBelt};
///
/// let system = MassOnBelt::new(Coulomb::new(0.4, 0.25)?, 0.2)?;
/// assert_eq!(largest_stick_slip_velocity(&system), f64::INFINITY);
/// let damped = system.with_damping(0.01)?;
/// assert!((largest_stick_slip_velocity(&damped) - 0.4108860625).abs() < 1e-10);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn largest_stick_slip_velocity(system: &MassOnBelt<Coulomb>) -> f64 {
    let jump = force_jump(system);
    if jump == 0.0 || system.damping() >= 1.0 {
        return 0.0;
    }
    tangential_slip(system.damping()).map_or(f64::INFINITY, |slip| jump * slip.velocity_factor)
}

/// The least damping ratio β with which there is no stick-slip cycle at the system's belt velocity.
/// Dimensionless, exact.
///
/// If the static coefficient μ_s exceeds the kinetic coefficient μ_k, the result is the root of
/// γ²(μ_s − μ_k)Λ(β) = |v_b|, with the friction load γ², the belt velocity v_b, and the factor Λ
/// that [`tangential_slip`] computes. The root lies in 0 < β < 1. The result is 0 if the root is
/// too small for an `f64`, or if μ_s = μ_k, because there is then no stick-slip cycle with any
/// damping.
///
/// With this damping or more no vibration lasts. The exception is β = 0: without damping, small
/// vibrations about steady sliding last.
///
/// `None` if v_b = 0. The system's own β is ignored. For other laws see
/// [`bifurcation::silencing_damping`](crate::bifurcation::silencing_damping).
///
/// ```
/// use stick_slip::analysis::coulomb::{silencing_damping, largest_stick_slip_velocity};
/// use stick_slip::{Coulomb, MassOnBelt};
///
/// let system = MassOnBelt::new(Coulomb::new(0.4, 0.25)?, 0.5)?;
/// let damping = silencing_damping(&system).unwrap();
/// assert!((damping - 0.006875449).abs() < 1e-9);
/// assert!((largest_stick_slip_velocity(&system.with_damping(damping)?) - 0.5).abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "least_damping")]
pub fn silencing_damping(system: &MassOnBelt<Coulomb>) -> Option<f64> {
    let (jump, speed) = (force_jump(system), system.belt_velocity().abs());
    if speed == 0.0 {
        return None;
    }
    if jump == 0.0 {
        return Some(0.0);
    }
    let reciprocal_factor = jump / speed;
    let leading = reciprocal_factor / (4.0 * PI) * reciprocal_factor;
    if leading < SMALL {
        return Some(leading);
    }
    // 1/Λ rises from 0 at β = 0 to ∞ at β = 1.
    let reciprocal = |damping: f64| match tangential_slip(damping) {
        Some(slip) => slip.velocity_factor.recip().min(f64::MAX),
        None => damping * f64::MAX,
    };
    let mut residual = |damping: f64| Ok(reciprocal(damping) - reciprocal_factor);
    root_between(&mut residual, 0.0, 1.0).ok()
}

/// Damping ratio above which there is no vibration at any belt velocity. Dimensionless, exact.
///
/// It is 1 if the static coefficient μ_s exceeds the kinetic coefficient μ_k. It is 0 if μ_s = μ_k,
/// because vibrations then last only without damping. The system's own belt velocity and damping
/// are ignored.
///
/// ```
/// use stick_slip::analysis::coulomb::silencing_damping_everywhere;
/// use stick_slip::{Coulomb, MassOnBelt};
///
/// let system = MassOnBelt::new(Coulomb::new(0.4, 0.25)?, 0.5)?;
/// assert_eq!(silencing_damping_everywhere(&system), 1.0);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "least_damping_everywhere")]
pub fn silencing_damping_everywhere(system: &MassOnBelt<Coulomb>) -> f64 {
    if force_jump(system) > 0.0 { 1.0 } else { 0.0 }
}

/// Belt velocity above which no vibration lasts. Dimensionless, exact.
///
/// It is [`largest_stick_slip_velocity`] if the system is damped. Without damping it is ∞, because
/// small vibrations then last at every belt velocity. The system's own belt velocity is ignored.
///
/// ```
/// use stick_slip::analysis::coulomb::quiet_velocity;
/// use stick_slip::{Coulomb, MassOnBelt};
///
/// let system = MassOnBelt::new(Coulomb::new(0.4, 0.4)?, 0.5)?;
/// assert_eq!(quiet_velocity(&system), f64::INFINITY);
/// assert_eq!(quiet_velocity(&system.with_damping(1e-3)?), 0.0);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn quiet_velocity(system: &MassOnBelt<Coulomb>) -> f64 {
    if system.damping() == 0.0 {
        f64::INFINITY
    } else {
        largest_stick_slip_velocity(system)
    }
}

/// The stick-slip cycle, with or without damping. Exact.
///
/// With damping, one equation is solved numerically, to rounding.
///
/// Without damping, the durations and the largest sliding speed are as follows. F = γ²(μ_s − μ_k),
/// with the friction load γ², the static coefficient μ_s and the kinetic coefficient μ_k; v_b is
/// the belt velocity and v the velocity of the mass. All quantities are dimensionless.
///
/// ```text
/// stick 2F/|v_b|,   slip 2(π − atan(F/|v_b|)),   max |v − v_b| = |v_b| + √(v_b² + F²)
/// ```
///
/// `None` if there is no stick-slip cycle: if v_b = 0, if μ_s = μ_k, if the damping ratio is at
/// least 1, or if |v_b| is at least [`largest_stick_slip_velocity`]. `None` also if stick lasts
/// longer than about 10¹⁵⁰. The Floquet multiplier is 0.
///
/// Source: the exact solution of the equations of stick and slip, which are linear for this law.
///
/// ```
/// use stick_slip::analysis::coulomb::stick_slip;
/// use stick_slip::{Coulomb, MassOnBelt, limit_cycle};
///
/// let system = MassOnBelt::new(Coulomb::new(0.4, 0.25)?, 0.1)?;
/// let cycle = stick_slip(&system).ok_or("no stick-slip")?;
/// assert!((cycle.stick_duration - 2.0 * (0.4 - 0.25) / 0.1).abs() < 1e-15);
/// assert!((cycle.max_sliding_speed - (0.1 + 0.0325_f64.sqrt())).abs() < 1e-16);
///
/// let damped = system.with_damping(0.05)?;
/// let formula = stick_slip(&damped).ok_or("no stick-slip")?;
/// let followed = limit_cycle::stick_slip(&damped)?.ok_or("no stick-slip")?;
/// assert!((formula.period() - followed.period()).abs() < 1e-13);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn stick_slip(system: &MassOnBelt<Coulomb>) -> Option<ExactCycle> {
    let law = system.law();
    let without_rise = Dwell::logarithmic(*law, 0.0, 1.0).ok()?;
    let oscillator = DwellOscillator {
        law: without_rise,
        mass: 1.0,
        stiffness: 1.0,
        damping: 2.0 * system.damping(),
        load: system.load(),
    };
    oscillator.stick_slip(system.belt_velocity())
}

fn force_jump(system: &MassOnBelt<Coulomb>) -> f64 {
    let law = system.law();
    system.load() * (law.static_coefficient() - law.kinetic_coefficient())
}

/// Undamped free vibration on a belt at rest, until static friction holds the mass.
///
/// γ² is the friction load, μ_k the kinetic and μ_s the static coefficient, and u the displacement.
/// The amplitude falls by 4γ²μ_k in each cycle. From one turning point to the next the mass takes
/// the time π. This is half a period of a harmonic motion whose centre is −γ²μ_k if the mass moves
/// forward, and γ²μ_k if it moves backward. The turning points are u_n = (−1)ⁿ·sgn(u_0)·(|u_0| −
/// 2nγ²μ_k), n = 0, 1, …. The mass comes to rest at the first turning point with |u| ≤ γ²μ_s.
/// Dimensionless, exact.
///
/// ```
/// use stick_slip::analysis::coulomb::FreeVibration;
/// use stick_slip::{Coulomb, MassOnBelt, State};
///
/// // The example FrictionOscillator of the library Siconos (siconos-tutorials): γ²μ = 1
/// let system = MassOnBelt::new(Coulomb::new(1.0, 1.0)?, 0.0)?;
/// let motion = FreeVibration::new(&system, State::new(12.0, 6.0)).unwrap();
/// let turns: Vec<f64> = motion.turning_points().map(|(_, displacement)| displacement).collect();
/// let expected = [13.31782, -11.31782, 9.31782, -7.31782, 5.31782, -3.31782, 1.31782, 0.68218];
/// assert_eq!(turns.len(), expected.len());
/// assert!(turns.iter().zip(expected).all(|(turn, expected)| (turn - expected).abs() < 1e-5));
/// assert_eq!(motion.rest_position(), turns.last().copied());
/// assert_eq!(motion.amplitude_loss(), 4.0);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FreeVibration {
    /// Friction force γ²μ_k in slip.
    kinetic: f64,
    /// Largest friction force γ²μ_s in stick.
    largest: f64,
    /// Time of the first turning point.
    time: f64,
    displacement: f64,
}

impl FreeVibration {
    /// The motion from a state at time 0. `None` unless the belt is at rest, the system is
    /// undamped, and the state is finite.
    pub fn new(system: &MassOnBelt<Coulomb>, start: State) -> Option<Self> {
        let kinetic = system.load() * system.law().kinetic_coefficient();
        let State {
            displacement,
            velocity,
        } = start;
        let (time, first) = if velocity == 0.0 {
            (0.0, displacement)
        } else {
            // z = u + σγ²μ_k moves on a circle: σz = R cos(τ − τ_1) has its maximum at the turning
            // point, τ_1.
            let sign = velocity.signum();
            let offset = sign * displacement + kinetic;
            let radius = offset.hypot(velocity);
            (velocity.abs().atan2(offset), sign * (radius - kinetic))
        };
        let applies = system.belt_velocity() == 0.0 && system.damping() == 0.0;
        (applies && first.is_finite()).then_some(Self {
            kinetic,
            largest: system.load() * system.law().static_coefficient(),
            time,
            displacement: first,
        })
    }

    /// Loss of amplitude in each full cycle, 4γ²μ_k, dimensionless. Exact.
    pub fn amplitude_loss(&self) -> f64 {
        4.0 * self.kinetic
    }

    /// Times and displacements of the turning points; the last point is the position of rest.
    /// Dimensionless, exact. A start with v = 0 is the first turning point. The iterator does not
    /// end if μ_k = 0 and |u| > γ²μ_s at the first turning point.
    pub fn turning_points(&self) -> impl Iterator<Item = (f64, f64)> + use<> {
        let motion = *self;
        let last = motion.swings();
        (0..)
            .take_while(move |&n| last.is_none_or(|last| n <= last))
            .map(move |n| (motion.time + PI * n as f64, motion.turn(n)))
    }

    /// Displacement at which the mass comes to rest, dimensionless, exact. `None` if the mass never
    /// comes to rest, which requires μ_k = 0, or if it takes more than 2⁵³ half cycles to come to
    /// rest.
    pub fn rest_position(&self) -> Option<f64> {
        self.swings().map(|n| self.turn(n))
    }

    /// Time at which the mass comes to rest, dimensionless, exact. `None` if
    /// [`rest_position`](Self::rest_position) is `None`.
    pub fn rest_time(&self) -> Option<f64> {
        self.swings().map(|n| self.time + PI * n as f64)
    }

    /// Displacement of turning point n, counted from 0.
    fn turn(&self, n: u64) -> f64 {
        let side = if n.is_multiple_of(2) { 1.0 } else { -1.0 };
        side * self.displacement.signum()
            * (self.displacement.abs() - 2.0 * self.kinetic * n as f64)
    }

    /// Number of half swings from the first turning point to rest.
    fn swings(&self) -> Option<u64> {
        let excess = self.displacement.abs() - self.largest;
        if excess <= 0.0 {
            return Some(0);
        }
        let swings = (excess / (2.0 * self.kinetic)).ceil();
        if swings.is_nan() || swings > MOST_SWINGS {
            return None;
        }
        // The quotient is rounded, so the comparison with the stick band decides.
        let swings = swings as u64;
        let earlier = swings.saturating_sub(1);
        Some(
            [earlier, swings]
                .into_iter()
                .find(|&n| self.turn(n).abs() <= self.largest)
                .unwrap_or(swings + 1),
        )
    }
}

/// Most half swings that an `f64` counts without rounding.
const MOST_SWINGS: f64 = (1_u64 << 53) as f64;
