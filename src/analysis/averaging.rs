//! Averaging, for weak friction and any law: the slow growth and decay of a vibration, and the
//! limit cycles that it approaches.
//!
//! u is the displacement, τ the time, β the damping ratio, γ² the friction load and v_b the belt
//! velocity. μ(v_r) is the friction coefficient at the relative velocity v_r, and μ̂(s) = μ(s) the
//! kinetic coefficient at the sliding speed s. Let z = u − ū = A sin ψ and z' = A cos ψ, where ū is
//! the displacement of the equilibrium. The amplitude A drifts slowly. Its rate is (Eq. 12 of
//! Farshidianfar and Noei Aghaee, for any law)
//!
//! ```text
//! A' = −(1/2π) ∫₀^2π h(A cos ψ) cos ψ dψ,     h(y) = 2βy + γ²[μ(y − v_b) − μ(−v_b)]
//! ```
//!
//! The phase does not drift: ψ = ψ(0) + τ. The paper says that such integrals "are not analytically
//! solvable". This module computes them to round-off. Integration by parts avoids cancellation at
//! small A. By mirror symmetry the result depends on the speed w = |v_b| of the belt, but not on
//! its direction:
//!
//! ```text
//! A' = −βA − (γ²A/π) ∫₀^π μ̂'(|w − A cos ψ|) sin²ψ dψ − (2γ²/π) μ̂(0) sin θ
//! dA'/dA = −β − (γ²/π) ∫₀^π μ̂'(|w − A cos ψ|) cos²ψ dψ − (2γ²/π) μ̂(0) w²/(A³ sin θ)
//! ```
//!
//! μ̂' is the slope of the law at the given sliding speed, and the angle θ follows from cos θ =
//! w/A. The terms with sin θ come from the jump of the friction force when the mass overtakes the
//! belt; they are absent for A ≤ w. If A ≤ w and all sliding speeds lie on one piece of the law,
//! the integrand is smooth and periodic, and the trapezoidal rule is used. Otherwise Gauss-Legendre
//! quadrature is used on panels that end at ψ = θ and where the sliding speed passes a breakpoint.
//!
//! The amplitude A and the period 2π have errors O(ε²), where ε is the size of friction and damping
//! compared with the spring ([`analysis`](super)). Averaging describes only motions that never
//! stick: see [`AveragedCycle::is_valid`].

use std::f64::consts::PI;

use crate::belt::{Belt, MassOnBelt};
use crate::error::Error;
use crate::friction::{FrictionLaw, Values, slope_on};
use crate::numerics::adaptive::{Integral, gauss, graded, trapezoid};
use crate::numerics::bracket::root_between;
use crate::numerics::chebyshev::{Sample, brackets, isolate};

/// Drift dA/dτ, with the time τ, of the amplitude A ≥ 0 of a vibration. Dimensionless.
///
/// The page [`averaging`](self) has the formula, which holds for any law and any belt velocity v_b.
/// The error is O(ε²), with ε of [`analysis`](super), but O(ε^{3/2}) at A = |v_b|.
///
/// For Coulomb's law on a belt at rest, without damping, the drift is −2γ²μ_k/π, with the friction
/// load γ² and the kinetic coefficient μ_k. The amplitude therefore falls by 4γ²μ_k in each cycle.
///
/// Source: Farshidianfar and Noei Aghaee, Eq. 12, corrected: the printed right sides are not
/// averaged over a cycle.
///
/// # Errors
///
/// * [`Error::InvalidParameter`] if A is negative or not finite, or if |v_b| + A, γ²·dμ̂/ds or A'
///   overflows;
/// * [`Error::NonFiniteFriction`] or [`Error::NotAnalytic`] if the law has no finite value or no
///   finite slope at a speed up to |v_b| + A.
///
/// ```
/// use stick_slip::analysis::averaging::drift;
/// use stick_slip::{Coulomb, MassOnBelt, Polynomial};
///
/// // −½ h1 A − (3/8) h3 A³ with h1 = −0.278, h3 = 0.6
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// assert!((drift(&system, 0.1)? - (0.139 * 0.1 - 0.225 * 0.001)).abs() < 1e-16);
///
/// let resting = MassOnBelt::new(Coulomb::new(0.4, 0.25)?, 0.0)?;
/// assert!((drift(&resting, 3.0)? * std::f64::consts::TAU + 4.0 * 0.25).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn drift<L: FrictionLaw>(system: &MassOnBelt<L>, amplitude: f64) -> Result<f64, Error> {
    let system = system.belt();
    let drift = SlowFlow::at(&system, amplitude, 0.0)?.drift(amplitude);
    in_range(&system, drift)
}

/// Slope dA'/dA of the [`drift`] A' at the amplitude A ≥ 0, dimensionless: the growth rate of a
/// perturbation of the amplitude.
///
/// The error is O(ε²), with ε of [`analysis`](super), at amplitudes at which the least and the
/// largest velocity of the mass are neither the belt velocity v_b nor a velocity whose sliding
/// speed is a breakpoint of the law. If v_b is not 0, and the kinetic coefficient μ̂(0) at the
/// sliding speed 0 is positive, the slope tends to −∞ as A falls to |v_b|.
///
/// # Errors
///
/// The errors of [`drift`].
///
/// ```
/// use stick_slip::analysis::averaging::drift_slope;
/// use stick_slip::{MassOnBelt, Polynomial};
///
/// // −½ h1 − (9/8) h3 A²
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// assert!((drift_slope(&system, 0.1)? - (0.139 - 0.675 * 0.01)).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn drift_slope<L: FrictionLaw>(system: &MassOnBelt<L>, amplitude: f64) -> Result<f64, Error> {
    Ok(SlowFlow::at(&system.belt(), amplitude, 0.0)?.slope)
}

/// The slow flow at one amplitude, in parts.
struct SlowFlow {
    /// Growth rate A'/A without the part of the jump.
    rate: f64,
    /// Part of the jump, (2γ²/π) μ̂(0) sin θ; 0 for A ≤ w.
    jump: f64,
    /// Slope dA'/dA.
    slope: f64,
    /// Rounding error of `rate`.
    noise: f64,
}

impl SlowFlow {
    /// The slow flow at an amplitude. `steepest` is the largest slope of the law, which bounds the
    /// rounding errors of all slopes; 0 if it is not known.
    fn at(system: &Belt<'_>, amplitude: f64, steepest: f64) -> Result<Self, Error> {
        let belt_speed = system.belt_velocity().abs();
        Error::check(
            "averaging",
            "amplitude",
            amplitude,
            amplitude >= 0.0 && (belt_speed + amplitude).is_finite(),
            "amplitude ≥ 0, and |v_b| + amplitude finite",
        )?;
        let load = system.load() / PI;
        let mean = slope_integrals(system.law(), belt_speed, amplitude, steepest)?;
        let [rate, mut slope] = mean.parts.map(|mean| -system.damping() - load * mean);
        let mut jump = 0.0;
        if amplitude > belt_speed {
            let cosine = belt_speed / amplitude;
            let sine = sine_of_crossing(belt_speed, amplitude);
            jump = 2.0 * load * system.law().kinetic(0.0);
            slope -= jump * (cosine * cosine / sine / amplitude);
            jump *= sine;
        }
        let size = system.damping() + system.load() * mean.peak.max(steepest);
        for number in [rate, jump, slope, size] {
            in_range(system, number)?;
        }
        Ok(Self {
            rate,
            jump,
            slope,
            noise: 16.0 * f64::EPSILON * size,
        })
    }

    fn drift(&self, amplitude: f64) -> f64 {
        amplitude * self.rate - self.jump
    }

    /// The growth rate A'/A, whose roots are the cycles. It is regular at A = 0, with the value
    /// −h1/2.
    fn growth_rate(&self, amplitude: f64) -> Sample {
        let jump = if self.jump > 0.0 {
            self.jump / amplitude
        } else {
            0.0
        };
        Sample {
            value: self.rate - jump,
            // The last term is the effect of rounding A itself, which is largest near A = |v_b|.
            noise: self.noise + 16.0 * f64::EPSILON * jump + 4.0 * f64::EPSILON * self.slope.abs(),
        }
    }
}

/// Returns a term of the slow flow if it does not overflow.
fn in_range(system: &Belt<'_>, term: f64) -> Result<f64, Error> {
    let allowed = "γ²·max abs(dμ̂/ds), and the drift divided by the amplitude, finite";
    Error::check(
        "averaging",
        "load",
        system.load(),
        term.is_finite(),
        allowed,
    )?;
    Ok(term)
}

/// The sine of θ, where cos θ = |v_b|/A < 1, without cancellation.
fn sine_of_crossing(belt_speed: f64, amplitude: f64) -> f64 {
    let cosine = belt_speed / amplitude;
    ((amplitude - belt_speed) / amplitude * (1.0 + cosine)).sqrt()
}

/// The integrals ∫₀^π μ̂'(|w − A cos ψ|) sin²ψ dψ and ∫₀^π μ̂'(|w − A cos ψ|) cos²ψ dψ.
fn slope_integrals(
    law: &dyn Values,
    w: f64,
    amplitude: f64,
    steepest: f64,
) -> Result<Integral<2>, Error> {
    let speed_at = |psi: f64| (w - amplitude * psi.cos()).abs();
    let weighted = |piece: usize, psi: f64| {
        let slope = slope_on(law, piece, speed_at(psi))?;
        Ok([slope * psi.sin().powi(2), slope * psi.cos().powi(2)])
    };
    // Angles ψ at which the speed |w − A cos ψ| is a breakpoint, or vanishes.
    let mut splits = vec![0.0, PI];
    let kinks = law.breakpoints().flat_map(|b| [w - b, w + b]);
    splits.extend(
        kinks
            .filter(|y| y.abs() < amplitude)
            .map(|y| (y / amplitude).acos()),
    );
    // The angle of the least speed. At slow speeds a law may have features of any scale.
    let slowest = (w / amplitude).min(1.0).acos();
    if amplitude > w {
        splits.push(slowest);
    }
    splits.sort_by(f64::total_cmp);

    if splits.len() == 2 {
        let piece = law.piece_above(speed_at(0.5 * PI));
        if let Some(integral) = trapezoid(|psi| weighted(piece, psi))? {
            return Ok(integral);
        }
    }
    let mut total = Integral::ZERO;
    for ends in splits.windows(2).filter(|ends| ends[0] < ends[1]) {
        let piece = law.piece_above(speed_at(0.5 * (ends[0] + ends[1])));
        let f = |psi| weighted(piece, psi);
        let panels = if ends.contains(&slowest) {
            gauss(f, &graded(ends[0], ends[1]), steepest)
        } else {
            gauss(f, ends, steepest)
        };
        total = total.merged(&panels?);
    }
    Ok(total)
}

/// A cycle of the averaged equation: an amplitude A > 0 at which the [`drift`] A' is 0.
///
/// The displacement from the equilibrium is A sin ψ, and the period 2π. v_b is the belt velocity,
/// γ² the friction load, μ_s the static coefficient, and μ̂(0) the kinetic coefficient at the
/// sliding speed 0. All quantities are dimensionless. Errors are O(ε²), with ε of
/// [`analysis`](super), in the amplitude (half the range of displacements, or the largest velocity)
/// and in the period, and O(ε³) in the multiplier. The error of the mean displacement is O(ε),
/// because the exact motion is not centred on the equilibrium.
///
/// Source: Farshidianfar and Noei Aghaee, Eqs. 12 and 13 (corrected: 4/3 replaces the printed 3/4),
/// extended to any law and to cycles in which the mass overtakes the belt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AveragedCycle {
    amplitude: f64,
    drift_slope: f64,
    half_leading_duration: f64,
    is_valid: bool,
}

impl AveragedCycle {
    /// Amplitude A of displacement and velocity, dimensionless. Error O(ε²).
    pub fn amplitude(&self) -> f64 {
        self.amplitude
    }

    /// Slope dA'/dA of the drift at the cycle, dimensionless: the growth rate of perturbations.
    /// Error O(ε³).
    pub fn drift_slope(&self) -> f64 {
        self.drift_slope
    }

    /// Floquet multiplier exp(2π dA'/dA) for one cycle, dimensionless. Error O(ε³).
    pub fn multiplier(&self) -> f64 {
        (2.0 * PI * self.drift_slope).exp()
    }

    /// Returns true if neighbouring motions approach the cycle: dA'/dA < 0.
    pub fn is_stable(&self) -> bool {
        self.drift_slope < 0.0
    }

    /// Time per cycle during which the mass is faster than the belt, dimensionless: 2θ with cos θ =
    /// |v_b|/A, or 0 if A ≤ |v_b|. Error O(ε²).
    pub fn leading_duration(&self) -> f64 {
        2.0 * self.half_leading_duration
    }

    /// Returns true if the motion never sticks, so that averaging describes it: if A ≤ |v_b|, or if
    /// A sin θ > γ²(μ_s + μ̂(0)) with cos θ = |v_b|/A. Under the second condition the mass
    /// overtakes the belt and does not stick: when both velocities are equal again, static friction
    /// cannot balance the spring. Otherwise the motion sticks: see [`StickSlip`](super::StickSlip).
    /// The load γ² above which the second condition fails has a relative error O(ε).
    pub fn is_valid(&self) -> bool {
        self.is_valid
    }
}

/// Returns all cycles of the averaged equation, stable and unstable, by ascending amplitude,
/// including cycles in which the mass overtakes the belt.
///
/// The averaged equation does not contain the static coefficient μ_s. A stick-slip cycle that
/// exists only because μ_s exceeds the kinetic coefficient μ̂(0) at the sliding speed 0, as for
/// Coulomb's law, is therefore not included.
///
/// # What "all" means
///
/// v_b is the belt velocity, β the damping ratio, γ² the friction load, and μ̂(s) the kinetic
/// coefficient at the sliding speed s. Every averaged cycle of a law with μ̂ ≥ 0 has an amplitude A
/// < 2|v_b|. (Friction supplies energy only while the velocity of the mass is between 0 and that of
/// the belt, at sliding speeds below |v_b|. If A ≥ 2|v_b|, the mass reaches each of these sliding
/// speeds also while it is faster than the belt. Friction then dissipates more energy than it
/// supplies.) The search covers 0 < A < 2|v_b|. Let A_i be the amplitudes at which the largest or
/// the least velocity of the mass is the belt velocity, or a velocity whose sliding speed is a
/// breakpoint of the law. Between two successive A_i, the growth rate A'/A, with the [`drift`] A',
/// is interpolated by Chebyshev polynomials to round-off. The intervals are divided until A'/A has
/// no root or is monotone on each. No cycle is missed, except
///
/// * a pair of cycles near a fold, if A'/A between their amplitudes is smaller than its rounding
///   error, at most 10⁻¹⁴(β + γ²·max abs(dμ̂/ds)). Near folds of the exponential law a pair may be
///   missed if its amplitudes differ by less than about 10⁻⁶|v_b|;
/// * a cycle caused by a feature of the law's slope that is narrower than about 3·10⁻⁴|v_b| in
///   sliding speed (low speeds are sampled more densely).
///
/// If A' is 0 within rounding on a whole interval (Coulomb's law without damping: 0 < A ≤ |v_b|),
/// the cycles in this interval are not isolated and are not listed. If v_b = 0, the list is empty.
///
/// The rounding error of an amplitude is that of A'/A, typically 10⁻¹⁶(β + γ²·max abs(dμ̂/ds)),
/// divided by the derivative of A'/A with respect to A.
///
/// Source: Farshidianfar and Noei Aghaee, Eqs. 12 and 13 (corrected), for any law. For the orders
/// of error in ε see [`AveragedCycle`].
///
/// # Errors
///
/// * [`Error::NonFiniteFriction`] or [`Error::NotAnalytic`] if the law has no finite value or no
///   finite slope at a speed up to 3|v_b|;
/// * [`Error::InvalidParameter`] if 3|v_b|, γ²·dμ̂/ds or A'/A overflows.
///
/// ```
/// use stick_slip::analysis::averaging;
/// use stick_slip::{Exponential, MassOnBelt, Polynomial};
///
/// // A0 of Eq. 15
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.42)?.with_damping(0.05)?;
/// let cycles = averaging::cycles(&system)?;
/// assert_eq!(cycles.len(), 1);
/// assert!((cycles[0].amplitude() - 0.2686592223947985).abs() < 1e-15);
/// assert!((cycles[0].multiplier() - 0.8153988827558230).abs() < 1e-15);
///
/// // Below its fold at v_b = 1.4578 the exponential law has a stable and an unstable cycle.
/// let law = Exponential::new(0.4, 0.3, 1.0)?;
/// let system = MassOnBelt::new(law, 1.45)?.with_damping(0.01)?.with_load(0.5)?;
/// let cycles = averaging::cycles(&system)?;
/// assert_eq!(cycles.iter().map(|cycle| cycle.is_stable()).collect::<Vec<_>>(), [false, true]);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn cycles<L: FrictionLaw>(system: &MassOnBelt<L>) -> Result<Vec<AveragedCycle>, Error> {
    cycles_of(&system.belt())
}

fn cycles_of(system: &Belt<'_>) -> Result<Vec<AveragedCycle>, Error> {
    let w = system.belt_velocity().abs();
    if w == 0.0 {
        return Ok(Vec::new());
    }
    let steepest = steepest_at_breakpoints(system.law(), 3.0 * w)?;
    let mut growth_rate = |amplitude: f64| {
        let sample = SlowFlow::at(system, amplitude, steepest)?.growth_rate(amplitude);
        in_range(system, sample.value)?;
        in_range(system, sample.noise)?;
        Ok(sample)
    };
    let mut nodes = Vec::new();
    for ends in touching_amplitudes(system.law(), w).windows(2) {
        let ([start, end], from_rest) = ([ends[0], ends[1]], ends[0] == 0.0);
        // A² = start² + (end² − start²) t². From A = 0 on, t takes the place of t², because A'/A is
        // a function of A² there. In units of w nothing overflows.
        let amplitude_at = |t: f64| {
            let x = if from_rest { t } else { t * t };
            if t == 1.0 {
                return w * end;
            }
            w * (start * start + (end - start) * (end + start) * x).sqrt()
        };
        nodes.extend(isolate(&mut growth_rate, &amplitude_at)?);
    }
    brackets(&nodes)
        .into_iter()
        .map(|[low, high]| {
            let amplitude = root_between(&mut |a| Ok(growth_rate(a)?.value), low, high)?;
            describe(system, amplitude)
        })
        .collect()
}

/// The largest |dμ̂/ds| at the law's breakpoints up to a speed; 0 without breakpoints.
///
/// If a motion barely reaches a piece of the law, it covers a part as narrow as rounding errors.
/// The rounding errors of slopes there depend on the size of the slopes on the whole piece.
fn steepest_at_breakpoints(law: &dyn Values, fastest: f64) -> Result<f64, Error> {
    let mut steepest = 0.0_f64;
    for (piece, speed) in law
        .breakpoints()
        .enumerate()
        .take_while(|(_, b)| *b < fastest)
    {
        for piece in [piece, piece + 1] {
            steepest = steepest.max(slope_on(law, piece, speed)?.abs());
        }
    }
    Ok(steepest)
}

/// Amplitudes in units of w, from 0 to 2, at which the motion first touches the belt or a
/// breakpoint of the law.
fn touching_amplitudes(law: &dyn Values, w: f64) -> Vec<f64> {
    let touching = law
        .breakpoints()
        .map(|b| b / w)
        .flat_map(|b| [(1.0 - b).abs(), 1.0 + b]);
    let mut amplitudes: Vec<f64> = touching
        .filter(|a| (f64::EPSILON..2.0).contains(a))
        .chain([0.0, 1.0, 2.0])
        .collect();
    amplitudes.sort_by(f64::total_cmp);
    amplitudes.dedup();
    amplitudes
}

fn describe(system: &Belt<'_>, amplitude: f64) -> Result<AveragedCycle, Error> {
    let (law, w) = (system.law(), system.belt_velocity().abs());
    let drift_slope = SlowFlow::at(system, amplitude, 0.0)?.slope;
    let mut cycle = AveragedCycle {
        amplitude,
        drift_slope,
        half_leading_duration: 0.0,
        is_valid: true,
    };
    if amplitude > w {
        let sine = sine_of_crossing(w, amplitude);
        cycle.half_leading_duration = sine.atan2(w / amplitude);
        // While the mass leads, u covers a range of 2A sin θ, centred where the acceleration is 0:
        // F = −γ²μ̂(0). This range must end beyond F = γ²μ_s.
        cycle.is_valid =
            amplitude * sine > system.load() * (law.static_coefficient() + law.kinetic(0.0));
    }
    Ok(cycle)
}
