//! The eigenvalues of steady sliding, and where a pair of them crosses the imaginary axis.

use num_complex::Complex;

use super::type_erased_system::GeneralForm;
use crate::error::Error;
use crate::structure::sliding_field::SlidingField;
use crate::structure::sliding_field::spectrum::Spectrum;

/// The largest real part, in units of the frequency, of a pair on the imaginary axis.
const ROUNDING: f64 = 1e-10;

/// The largest growth rate, in units of the frequency, of a pair near a Hopf point.
const NEAR: f64 = 0.2;

/// First increment of a parameter, as a part of its size.
const INCREMENT: f64 = 1e-6;

/// Limit of steps of the secant method; five or six are usual.
const MOST_STEPS: usize = 40;

/// The eigenvalues of steady sliding.
pub(super) fn spectrum(form: &GeneralForm<'_>) -> Result<Spectrum, Error> {
    let found = SlidingField::standing(form.model())?.eigenvalues();
    found
        .map(|(spectrum, _)| spectrum)
        .ok_or(Error::NoHopfPoint)
}

/// The Hopf point near a value of the parameter, with its frequency.
pub(super) fn hopf_point(
    spectrum_at: &dyn Fn(f64) -> Result<Vec<Complex<f64>>, Error>,
    near: f64,
    unit: f64,
) -> Result<(f64, f64), Error> {
    let none = || Error::NoHopfPoint.at("parameter", near);
    // The eigenvalue nearest another one.
    let nearest = |parameter: f64, to: Option<Complex<f64>>| {
        let values = spectrum_at(parameter)?;
        let off = |value: &Complex<f64>| match to {
            Some(to) => (value - to).norm(),
            None => (value.re / value.im).abs(),
        };
        let oscillating = values.into_iter().filter(|value| value.im > 0.0);
        let nearest = oscillating.min_by(|a, b| off(a).total_cmp(&off(b)));
        nearest.ok_or_else(none)
    };
    let first = nearest(near, None)?;
    if first.re.abs() > NEAR * first.im {
        return Err(none());
    }
    let mut last = (near, first);
    let mut next = near + INCREMENT * unit;
    // Of stiff contacts an eigenvalue may have a rounding error at which no step ends.
    let mut best = last;
    for _ in 0..MOST_STEPS {
        let value = nearest(next, Some(last.1))?;
        if value.re.abs() < best.1.re.abs() {
            best = (next, value);
        }
        let step = -value.re * (next - last.0) / (value.re - last.1.re);
        let is_done =
            value.re.abs() <= f64::EPSILON * value.im || step.abs() <= f64::EPSILON * next.abs();
        if is_done || !(step.is_finite() && (next + step - near).abs() <= unit) {
            break;
        }
        last = (next, value);
        next += step;
    }
    let (parameter, value) = best;
    if value.re.abs() > ROUNDING * value.im {
        return Err(none());
    }
    Ok((parameter, value.im))
}
