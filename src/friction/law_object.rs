//! A friction law as a trait object, for the engines. Engines and searches are compiled once, for
//! any law, and each law once, for all of them.
//!
//! The values of a law are in a separate trait, because the series along a motion are most of a
//! law's code.

use super::slip_series::Expansion;
use super::{FrictionLaw, Piece, piece_above, value_and_slope};
use crate::error::Error;
use crate::scalar::jet;

/// The values of a friction law. Every [`FrictionLaw`] has them.
pub(crate) trait Values {
    /// [`FrictionLaw::static_coefficient`].
    fn static_coefficient(&self) -> f64;
    /// [`FrictionLaw::kinetic`].
    fn kinetic(&self, speed: f64) -> f64;
    /// [`FrictionLaw::kinetic_on`].
    fn kinetic_on(&self, piece: usize, speed: f64) -> f64;
    /// [`FrictionLaw::kinetic_on`] at four speeds.
    fn at_four(&self, piece: usize, speeds: [f64; 4]) -> [f64; 4];
    /// [`FrictionLaw::breakpoints`].
    fn breakpoints(&self) -> Box<dyn Iterator<Item = f64> + '_>;
    /// The piece that holds speeds just above this one.
    fn piece_above(&self, speed: f64) -> usize;
    /// [`FrictionLaw::coefficient`].
    fn coefficient(&self, relative_velocity: f64) -> f64;
    /// [`FrictionLaw::slope`].
    fn slope(&self, speed: f64) -> f64;
    /// μ̂ and dμ̂/ds on one piece.
    fn value_and_slope(&self, piece: usize, speed: f64) -> (f64, f64);
    /// The first coefficients of one piece as a power series about `speed`.
    fn expand_on(&self, piece: usize, speed: f64, coefficients: &mut [f64]);
}

/// A friction law for the engines. Every [`FrictionLaw`] is one.
///
/// A call through a reference costs some nanoseconds, so frequent requests of a step are combined:
/// the values at four speeds, and a whole power series.
pub(crate) trait Law: Values {
    /// The series of a slip phase.
    fn expand_slip(&self, expansion: Expansion<'_>) -> Result<(), Error>;
}

impl<L: FrictionLaw> Values for L {
    fn static_coefficient(&self) -> f64 {
        FrictionLaw::static_coefficient(self)
    }

    fn kinetic(&self, speed: f64) -> f64 {
        FrictionLaw::kinetic(self, speed)
    }

    fn kinetic_on(&self, piece: usize, speed: f64) -> f64 {
        FrictionLaw::kinetic_on(self, piece, speed)
    }

    fn at_four(&self, piece: usize, speeds: [f64; 4]) -> [f64; 4] {
        let [a, b, c, d] = speeds;
        let at = |speed: f64| FrictionLaw::kinetic_on(self, piece, speed);
        [at(a), at(b), at(c), at(d)]
    }

    fn breakpoints(&self) -> Box<dyn Iterator<Item = f64> + '_> {
        Box::new(FrictionLaw::breakpoints(self))
    }

    fn piece_above(&self, speed: f64) -> usize {
        piece_above(FrictionLaw::breakpoints(self), speed)
    }

    fn coefficient(&self, relative_velocity: f64) -> f64 {
        FrictionLaw::coefficient(self, relative_velocity)
    }

    fn slope(&self, speed: f64) -> f64 {
        FrictionLaw::slope(self, speed)
    }

    fn value_and_slope(&self, piece: usize, speed: f64) -> (f64, f64) {
        value_and_slope(self, piece, speed)
    }

    fn expand_on(&self, piece: usize, speed: f64, coefficients: &mut [f64]) {
        let piece = Piece {
            law: self,
            index: piece,
        };
        jet::coefficients(piece, speed, coefficients);
    }
}

impl<L: FrictionLaw> Law for L {
    fn expand_slip(&self, expansion: Expansion<'_>) -> Result<(), Error> {
        self.give_to(expansion)
    }
}

/// A law as a trait object. See [`FrictionLaw::erased`]. Not exported.
#[derive(Clone, Copy)]
pub struct LawRef<'l>(&'l dyn Law);

impl<'l> LawRef<'l> {
    pub(crate) fn of(law: &'l impl FrictionLaw) -> Self {
        Self(law)
    }

    pub(crate) fn law(self) -> &'l dyn Law {
        self.0
    }
}

/// An argument of the methods of laws that only this crate calls and overrides: its type is not
/// exported.
#[derive(Debug, Clone, Copy)]
pub struct Own;
