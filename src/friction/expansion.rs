//! Power series of a law in the sliding speed.

use super::Values;
use crate::error::Error;

/// The first M coefficients of μ̂ as a power series in the sliding speed about `speed`.
pub(crate) fn taylor_coefficients<const M: usize>(law: &dyn Values, speed: f64) -> [f64; M] {
    taylor_coefficients_on(law, law.piece_above(speed), speed)
}

/// The first M coefficients of one piece of μ̂ as a power series about `speed`.
pub(crate) fn taylor_coefficients_on<const M: usize>(
    law: &dyn Values,
    piece: usize,
    speed: f64,
) -> [f64; M] {
    let mut coefficients = [f64::NAN; M];
    law.expand_on(piece, speed, &mut coefficients);
    coefficients
}

/// Checks that the law has a finite value and slope at `speed`.
pub(crate) fn finite_at(law: &dyn Values, speed: f64) -> Result<(), Error> {
    slope_on(law, law.piece_above(speed), speed).map(|_| ())
}

/// dμ̂/ds on one piece of the law.
pub(crate) fn slope_on(law: &dyn Values, piece: usize, speed: f64) -> Result<f64, Error> {
    let (value, slope) = law.value_and_slope(piece, speed);
    Error::check_friction(speed, value, slope)?;
    Ok(slope)
}
