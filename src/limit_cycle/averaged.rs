//! Growth of weakly perturbed motions by averaging: the change over one period is smaller than
//! rounding, but the averaged rate is accurate.
//!
//! A motion of velocity amplitude A ≤ v_b drifts at the rate
//!
//! ```text
//! A'/A = −½h1 − (2γ²/π) ∫₀^½π D(A cos ψ) sin²ψ dψ,
//! D(y) = ½[μ̂'(v_b − y) + μ̂'(v_b + y)] − μ̂'(v_b)
//! ```
//!
//! with h1 = 2β + γ²μ̂'(v_b). This is Eq. 12 of Farshidianfar and Noei Aghaee for any law,
//! integrated by parts, with the linear part taken out so that nothing cancels. The next order
//! vanishes, because opposite forces give the same motion in reversed time. Each of the two parts
//! therefore has a relative error of δ², where δ is the change of a motion within a radian.

use std::f64::consts::{FRAC_2_PI, FRAC_PI_2};
use std::ops::Range;

use crate::belt::Forward;
use crate::error::Error;
use crate::numerics::adaptive::gauss;
use crate::numerics::chebyshev::{Sample, sign_throughout};

/// Rounding error of the drift, in units of ε times its largest part.
const DRIFT_ROUNDING: f64 = 16.0;

/// The rate A'/A at a velocity amplitude A ≤ v_b, with a bound of its error.
fn drift(system: &Forward<'_>, amplitude: f64) -> Result<Sample, Error> {
    let (v_b, law) = (system.belt_velocity(), system.law());
    let at_rest = law.slope(v_b);
    let mut parts = |psi: f64| {
        let y = amplitude * psi.cos();
        let slopes = [law.slope((v_b - y).max(0.0)), law.slope(v_b + y)];
        let uneven = 0.5 * (slopes[0] + slopes[1]) - at_rest;
        let weight = psi.sin().powi(2);
        // Squares measure the sizes, because they are smooth where absolute values are not.
        Ok([
            uneven * weight,
            uneven * uneven * weight,
            0.5 * (slopes[0] * slopes[0] + slopes[1] * slopes[1]),
        ])
    };
    let mut mesh: Vec<f64> = amplitudes_at_breakpoints(system)
        .filter(|touching| *touching < amplitude)
        .map(|touching| (touching / amplitude).acos())
        .chain([0.0, FRAC_PI_2])
        .collect();
    mesh.sort_by(f64::total_cmp);
    mesh.dedup();
    let f: &mut dyn FnMut(f64) -> Result<[f64; 3], Error> = &mut parts;
    let [uneven, uneven_squared, slope_squared] = gauss(f, &mesh, 0.0)?.parts;
    let load = system.load();
    let linear = -0.5 * system.effective_damping(v_b);
    let value = linear - load * FRAC_2_PI * uneven;
    let size = linear.abs() + load * FRAC_2_PI * (uneven_squared * FRAC_PI_2).sqrt();
    let strength = 2.0 * system.damping() + load * (slope_squared * FRAC_2_PI).sqrt();
    let noise = DRIFT_ROUNDING * f64::EPSILON * strength + strength * strength * size;
    Ok(Sample { value, noise })
}

/// Velocity amplitudes above which a motion about the equilibrium reaches a breakpoint of the law.
fn amplitudes_at_breakpoints(system: &Forward<'_>) -> impl Iterator<Item = f64> {
    let v_b = system.belt_velocity();
    let distances = system.law().breakpoints().map(move |b| (b - v_b).abs());
    distances.filter(|distance| *distance > 0.0)
}

/// Returns true if a motion of this velocity amplitude grows; `None` if averaging does not decide.
pub(super) fn grows(system: &Forward<'_>, amplitude: f64) -> Result<Option<bool>, Error> {
    let Sample { value, noise } = drift(system, amplitude)?;
    Ok((value.abs() > noise).then_some(value > 0.0))
}

/// Returns true if all motions with an amplitude in a range grow, false if all decay; `None` if one
/// of them may be periodic.
pub(super) fn all_grow(system: &Forward<'_>, range: &Range<f64>) -> Result<Option<bool>, Error> {
    let mut ends: Vec<f64> = amplitudes_at_breakpoints(system)
        .filter(|touching| range.contains(touching))
        .chain([range.start, range.end])
        .collect();
    ends.sort_by(f64::total_cmp);
    let mut growing = None;
    for piece in ends.windows(2).filter(|piece| piece[0] < piece[1]) {
        let mut at = |amplitude: f64| drift(system, amplitude);
        let amplitude_at = |t: f64| piece[0] + (piece[1] - piece[0]) * t;
        match sign_throughout(&mut at, &amplitude_at)? {
            Some(grows) if growing.is_none_or(|growing| growing == grows) => growing = Some(grows),
            _ => return Ok(None),
        }
    }
    Ok(growing)
}

#[cfg(test)]
mod tests;
