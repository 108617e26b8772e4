//! A forced oscillator with dry friction on a surface at rest: Den Hartog's motion without stops. A
//! stop is a time in which friction holds the mass at rest.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

use crate::error::Error;
use crate::numerics::bracket::root_between;
use crate::numerics::chebyshev::{Sample, brackets, isolate};

/// A mass on a spring, a damper and a dry surface at rest, with a harmonic force.
///
/// ```text
/// x'' + 2ζx' + x = p cos(Ωt + θ) − F sgn x'        m = k = 1
/// ```
///
/// For a mass m, a stiffness k and a damping constant c the unit of time is 1/ω0 with ω0 = √(k/m),
/// so Ω is in units of ω0, and ζ = c/(2√(km)). F is the kinetic friction, F_s the largest static
/// friction, and p the amplitude of the harmonic force, all in a common unit; θ is a phase. The
/// unit of displacement is that of force divided by k.
///
/// ```
/// use stick_slip::analysis::forced::ForcedOscillator;
///
/// let oscillator = ForcedOscillator {
///     damping: 0.05,
///     angular_frequency: 0.8,
///     kinetic_friction: 0.3,
///     static_friction: 0.3,
///     force: 1.0,
/// };
/// let motion = oscillator.without_stops().unwrap();
/// assert!((motion.amplitude() - 2.346871967422).abs() < 1e-12);
/// assert!((motion.period() - std::f64::consts::TAU / 0.8).abs() < 1e-15);
/// // The mass moves from one turning point to the other in half a period.
/// let (x, v) = motion.at(0.0);
/// assert!((x - motion.amplitude()).abs() < 1e-14 && v.abs() < 1e-14);
/// let (x, _) = motion.at(0.5 * motion.period());
/// assert!((x + motion.amplitude()).abs() < 1e-14);
/// // Below resonance the force leads the displacement by less than a quarter of a period.
/// assert!(motion.phase() > 0.0 && motion.phase() < std::f64::consts::FRAC_PI_2);
///
/// // With more friction the mass stops for a while at each turning point.
/// let rough = ForcedOscillator { kinetic_friction: 0.9, static_friction: 0.9, ..oscillator };
/// assert_eq!(rough.without_stops(), None);
/// ```
///
/// Source: J. P. Den Hartog, *Forced vibrations with combined Coulomb and viscous friction*, Trans.
/// ASME 53 (1931), APM-53-9, 107-115.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ForcedOscillator {
    /// Damping ratio ζ, 0 ≤ ζ < 1, dimensionless.
    pub damping: f64,
    /// Angular frequency Ω > 0 of the force, in units of the natural frequency ω0.
    pub angular_frequency: f64,
    /// Kinetic friction force F = μ_k N ≥ 0, in the common unit of force.
    pub kinetic_friction: f64,
    /// Largest static friction force F_s = μ_s N ≥ F, in the common unit of force.
    pub static_friction: f64,
    /// Amplitude p > 0 of the harmonic force, in the common unit of force.
    pub force: f64,
}

/// The periodic motion of a [`ForcedOscillator`] with two turning points in each period, at x = ±A,
/// and without stops: the mass does not stay at rest at a turning point. Exact.
///
/// On the half period that follows the largest displacement x is
///
/// ```text
/// x = e^{−ζt}(C cos qt + D sin qt) + F + P cos Ωt − S sin Ωt,    q = √(1 − ζ²)
/// ```
///
/// C, D, P and S are constants; the remaining symbols are those of [`ForcedOscillator`]. The second
/// half of the period is the mirror image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WithoutStops {
    oscillator: ForcedOscillator,
    /// C and D in `free`, P and S in `forced`.
    free: [f64; 2],
    forced: [f64; 2],
    /// Phase of the force at the largest displacement.
    phase: f64,
    amplitude: f64,
}

impl ForcedOscillator {
    /// The symmetric motion with two turning points in each period, at ±A, and without stops: the
    /// mass does not stay at rest at a turning point.
    ///
    /// Its amplitude is A:
    ///
    /// ```text
    /// A = −GF + √(p²Q² − H²F²),   Q = 1/√((1−Ω²)² + (2ζΩ)²),   q = √(1−ζ²),  a = πζ/Ω,  b = πq/Ω
    /// G = (sinh a − (ζ/q) sin b)/(cosh a + cos b),    H = sin b/(Ωq(cosh a + cos b))
    /// ```
    ///
    /// `None` if the root is not real, or if the mass would turn back between ±A. `None` also if
    /// the mass would stop at ±A, because the spring and the harmonic force together do not exceed
    /// F_s there. At resonance without damping, and if a field is out of its range, the result is
    /// `None`, too.
    pub fn without_stops(&self) -> Option<WithoutStops> {
        let &Self {
            damping: zeta,
            angular_frequency: omega,
            kinetic_friction: friction,
            static_friction,
            force,
        } = self;
        let in_range = (0.0..1.0).contains(&zeta)
            && omega > 0.0
            && friction >= 0.0
            && static_friction >= friction
            && force > 0.0;
        if !in_range {
            return None;
        }
        // Written with E = e^{−a} in place of sinh and cosh, which overflow for small Ω, and with
        // half of b, because 1 + E cos b nearly vanishes where b is an odd multiple of π.
        let root = ((1.0 - zeta) * (1.0 + zeta)).sqrt();
        let decay = (-PI * zeta / omega).exp();
        let lost = -(-PI * zeta / omega).exp_m1();
        let (half_sine, half_cosine) = (FRAC_PI_2 * root / omega).sin_cos();
        let sine = 2.0 * half_sine * half_cosine;
        let rest = 2.0 * decay * half_cosine * half_cosine;
        let turned = lost + rest;
        let skew = decay * sine * zeta / root;
        let size = lost * lost + 2.0 * rest;
        let free_cosine = -2.0 * friction * (turned - skew) / size;
        let forced_sine = -2.0 * friction * decay * sine / (root * size) / omega;
        let free_sine = (omega * forced_sine + zeta * free_cosine) / root;

        let (stiff, damped) = ((1.0 - omega) * (1.0 + omega), 2.0 * zeta * omega);
        let response = force / stiff.hypot(damped);
        // NaN where it is not real. No product over- or underflows.
        let forced_cosine = (response - forced_sine).sqrt() * (response + forced_sine).sqrt();
        let amplitude = free_cosine + friction + forced_cosine;
        // p cos θ and p sin θ, from the response that they cause.
        let in_phase = stiff * forced_cosine - damped * forced_sine;
        let behind = stiff * forced_sine + damped * forced_cosine;
        let motion = WithoutStops {
            oscillator: *self,
            free: [free_cosine, free_sine],
            forced: [forced_cosine, forced_sine],
            phase: behind.atan2(in_phase),
            amplitude,
        };
        let turns = amplitude.is_finite() && in_phase - amplitude < -static_friction;
        (turns && motion.falls_throughout()?).then_some(motion)
    }
}

impl WithoutStops {
    /// Largest displacement A, in the unit of force divided by k.
    pub fn amplitude(&self) -> f64 {
        self.amplitude
    }

    /// Phase θ of the force at the largest displacement, in radians: the force is p cos(Ωt + θ),
    /// with t counted from the largest displacement.
    pub fn phase(&self) -> f64 {
        self.phase
    }

    /// Period 2π/Ω, in units of 1/ω0.
    pub fn period(&self) -> f64 {
        2.0 * self.half_period()
    }

    /// Displacement and velocity at a finite time after the largest displacement, in
    /// [`ForcedOscillator`]'s units.
    pub fn at(&self, time: f64) -> (f64, f64) {
        let half = self.half_period();
        // The remainder is exact, however many periods have passed.
        let time = time.rem_euclid(self.period());
        let (sign, since) = if time < half {
            (1.0, time)
        } else {
            (-1.0, time - half)
        };
        let [x, v] = self.on_half(since);
        (sign * x, sign * v)
    }

    fn half_period(&self) -> f64 {
        PI / self.oscillator.angular_frequency
    }

    /// Displacement and velocity on the half period that falls.
    fn on_half(&self, time: f64) -> [f64; 2] {
        let &ForcedOscillator {
            damping: zeta,
            angular_frequency: omega,
            kinetic_friction: friction,
            ..
        } = &self.oscillator;
        let root = ((1.0 - zeta) * (1.0 + zeta)).sqrt();
        let ([c, d], [p, s]) = (self.free, self.forced);
        let decay = (-zeta * time).exp();
        let (sine, cosine) = (root * time).sin_cos();
        let (forced_sine, forced_cosine) = (omega * time).sin_cos();
        let free = decay * (c * cosine + d * sine);
        let free_rate = decay * ((root * d - zeta * c) * cosine - (root * c + zeta * d) * sine);
        [
            free + friction + p * forced_cosine - s * forced_sine,
            free_rate - omega * (p * forced_sine + s * forced_cosine),
        ]
    }

    /// Returns true if x' < 0 on the open half period; `None` if that cannot be decided.
    fn falls_throughout(&self) -> Option<bool> {
        let size = self.free.iter().chain(&self.forced).map(|c| c.abs());
        let rate = 1.0 + self.oscillator.angular_frequency;
        let noise = 16.0 * f64::EPSILON * rate * rate * size.sum::<f64>();
        let mut velocity = |time: f64| -> Result<Sample, Error> {
            let value = self.on_half(time)[1];
            Ok(Sample { value, noise })
        };
        let nodes = isolate(&mut velocity, &|t| t * self.half_period()).ok()?;
        let rises = nodes.iter().any(|node| node.sample.value > noise);
        Some(!rises && brackets(&nodes).is_empty())
    }
}

/// Largest ratio of friction to force with which an undamped oscillator moves without stops. A stop
/// is a rest of some duration at a turning point. Dimensionless, exact.
///
/// The ratio is F/p, with the symbols of [`ForcedOscillator`]; damping is ζ = 0, and static
/// friction equals kinetic friction, F_s = F. The argument is the angular frequency Ω of the force,
/// in units of the natural frequency. `None` unless Ω is positive and finite, and Ω² neither
/// overflows nor underflows.
///
/// ```text
/// √(V²/(U² + (S/Ω²)²)),   V = 1/(1 − Ω²),   U = sin(π/Ω)/(Ω(1 + cos(π/Ω)))
/// S = sup over 0 < τ < π of [Ω sin(τ/Ω) + UΩ²(cos τ − cos(τ/Ω))]/sin τ
/// ```
///
/// Source: Den Hartog 1931, as for [`ForcedOscillator`], in the limit of motion without stops.
///
/// ```
/// use stick_slip::analysis::forced::no_stop_limit;
///
/// assert!((no_stop_limit(0.5).unwrap() - 1.0 / 3.0).abs() < 1e-15);
/// assert!((no_stop_limit(1.5).unwrap() - 0.646579087296).abs() < 1e-12);
/// assert_eq!(no_stop_limit(1.0), Some(std::f64::consts::FRAC_PI_4));
/// ```
pub fn no_stop_limit(angular_frequency: f64) -> Option<f64> {
    let omega = angular_frequency;
    if !(omega * omega).is_normal() || omega < 0.0 {
        return None;
    }
    if omega == 1.0 {
        return Some(FRAC_PI_4);
    }
    // U = tan(π/(2Ω))/Ω, and U/V in a form without 0·∞ near Ω = 1.
    let turn = FRAC_PI_2 * (omega - 1.0) / omega;
    let tangent = turn.tan().recip();
    let u = tangent / omega;
    let u_over_v = -(omega - 1.0) * (omega + 1.0) * u;
    let s = largest_slope(omega, u)?;
    let s_over_v = (1.0 - omega) * (1.0 + omega) * s / (omega * omega);
    Some(u_over_v.hypot(s_over_v).recip())
}

/// The supremum S of [`no_stop_limit`]: the quotient is 1 at τ = 0 and −1 at τ = π.
fn largest_slope(omega: f64, u: f64) -> Option<f64> {
    // The numerator n of the quotient, and its slope n'.
    let numerator = |tau: f64| {
        let (sine, cosine) = (tau / omega).sin_cos();
        let [sum, difference] = [1.0 + 1.0 / omega, 1.0 - 1.0 / omega].map(|f| 0.5 * tau * f);
        let gap = -2.0 * sum.sin() * difference.sin();
        [
            omega * sine + u * omega * omega * gap,
            cosine + u * omega * omega * (sine / omega - tau.sin()),
        ]
    };
    // Zero where n/sin τ is stationary.
    let stationary = |tau: f64| {
        let [n, slope] = numerator(tau);
        let (sine, cosine) = tau.sin_cos();
        slope * sine - n * cosine
    };
    let size = 1.0 + omega + u.abs() * (omega * omega + omega);
    let noise = 16.0 * f64::EPSILON * (1.0 + omega.recip()) * size;
    let mut sample = |tau: f64| -> Result<Sample, Error> {
        let value = stationary(tau);
        Ok(Sample { value, noise })
    };
    let nodes = isolate(&mut sample, &|t| t * PI).ok()?;
    let mut largest = 1.0_f64;
    for [a, b] in brackets(&nodes) {
        let tau = root_between(&mut |tau| Ok(stationary(tau)), a, b).ok()?;
        largest = largest.max(numerator(tau)[0] / tau.sin());
    }
    Some(largest)
}
