//! Pieces of a law, and their power series in the sliding speed.

use super::FrictionLaw;
use crate::error::Error;
use crate::scalar::{Function, Scalar, Workspace, expand, jet};

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

/// The first M coefficients of μ̂ as a power series in the sliding speed about `speed`. The code
/// that computes them does not depend on M and is compiled once for each law.
pub(crate) fn taylor_coefficients<const M: usize, L: FrictionLaw>(law: &L, speed: f64) -> [f64; M] {
    taylor_coefficients_on(law, piece_above(law.breakpoints(), speed), speed)
}

/// The first M coefficients of one piece of μ̂ as a power series about `speed`.
pub(crate) fn taylor_coefficients_on<const M: usize, L: FrictionLaw>(
    law: &L,
    piece: usize,
    speed: f64,
) -> [f64; M] {
    jet::coefficients(Piece { law, index: piece }, speed)
}

/// μ̂ and dμ̂/ds on one piece of the law, exact to rounding. Much faster than a longer series,
/// which counts because averaging and every equilibrium use it.
pub(crate) fn value_and_slope<L: FrictionLaw>(law: &L, piece: usize, speed: f64) -> (f64, f64) {
    let piece = Piece { law, index: piece };
    expand(piece, &mut Workspace::<2>::new(), speed, |_, _, _| 1.0)
}

/// Checks that the law has a finite value and slope at `speed`.
pub(crate) fn finite_at<L: FrictionLaw>(law: &L, speed: f64) -> Result<(), Error> {
    slope_on(law, piece_above(law.breakpoints(), speed), speed).map(|_| ())
}

/// dμ̂/ds on one piece of the law.
#[inline(never)]
pub(crate) fn slope_on<L: FrictionLaw>(law: &L, piece: usize, speed: f64) -> Result<f64, Error> {
    let (value, slope) = value_and_slope(law, piece, speed);
    Error::check_friction(speed, value, slope)?;
    Ok(slope)
}
