//! The analytic pieces of a law.

use super::FrictionLaw;
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

/// μ̂ and dμ̂/ds on one piece of the law, exact to rounding. Much faster than a longer series,
/// which counts because averaging and every equilibrium use it.
pub(crate) fn value_and_slope<L: FrictionLaw>(law: &L, piece: usize, speed: f64) -> (f64, f64) {
    let piece = Piece { law, index: piece };
    expand(piece, &mut Workspace::<2>::new(), speed, |_, _, _| 1.0)
}
