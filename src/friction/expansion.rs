//! Pieces of a law, and their power series in the sliding speed.

use super::{FrictionLaw, Values};
use crate::error::Error;
use crate::scalar::{Function, Scalar, Workspace, expand};

/// One analytic piece of a law, by its number.
#[derive(Debug)]
pub(crate) struct Piece<'l, L> {
    pub(crate) law: &'l L,
    pub(crate) index: usize,
}

impl<L> Clone for Piece<'_, L> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<L> Copy for Piece<'_, L> {}

impl<L: FrictionLaw> Function for Piece<'_, L> {
    #[inline(always)]
    fn at<S: Scalar>(self, speed: S) -> S {
        self.law.kinetic_on(self.index, speed)
    }
}

/// The piece of a law with these breakpoints that holds speeds just above `speed`.
pub(crate) fn piece_above(breakpoints: impl Iterator<Item = f64>, speed: f64) -> usize {
    breakpoints.take_while(|&b| b <= speed).count()
}

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

/// μ̂ and dμ̂/ds on one piece of the law, exact to rounding. Much faster than a longer series,
/// which counts because averaging and every equilibrium use it.
pub(crate) fn value_and_slope<L: FrictionLaw>(law: &L, piece: usize, speed: f64) -> (f64, f64) {
    let piece = Piece { law, index: piece };
    expand(piece, &mut Workspace::<2>::new(), speed, |_, _, _| 1.0)
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
