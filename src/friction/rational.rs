use super::check::check_static;
use super::{AnyLaw, FrictionLaw, LawRef, Own};
use crate::error::Error;
use crate::scalar::Scalar;

/// The hyperbolic law of Leine, and the law of Popp and Stelter, which adds an offset and a
/// quadratic term.
///
/// ```text
/// μ̂(s) = μ_s/(1 + δ s)                              (Leine)
/// μ̂(s) = (μ_s − μ_o)/(1 + δ s) + μ_o + η s²         (after Popp and Stelter)
/// ```
///
/// μ̂(s) is the kinetic coefficient at the sliding speed s, μ_s the static coefficient, δ the
/// decay, μ_o the offset, and η the coefficient of the quadratic term. Coefficients are
/// dimensionless. Speeds are in the unit of velocity of the system
/// ([`FrictionLaw`](crate::FrictionLaw)); δ is in 1/speed, and η in 1/speed². Leine's law falls
/// towards zero. The law with an offset falls towards μ_o and, for η > 0, rises again. At s = 0 the
/// slope is −δ(μ_s − μ_o), with μ_o = 0 for Leine's law.
///
/// Source: Leine, van Campen, de Kraker and van den Steen, *Nonlinear Dynamics* 16 (1998) 41-54;
/// Popp and Stelter, *Phil. Trans. R. Soc. A* 332 (1990) 89-105.
///
/// ```
/// use stick_slip::{FrictionLaw, Rational};
///
/// let leine = Rational::new(1.0, 3.0)?;
/// assert_eq!(leine.kinetic(1.0), 0.25);
/// assert_eq!(leine.slope(0.0), -3.0);
///
/// let popp_stelter = Rational::new(0.4, 3.0)?.with_offset(0.2)?.with_quadratic(0.01)?;
/// assert!((popp_stelter.kinetic(1.0) - (0.2 / 4.0 + 0.2 + 0.01)).abs() < 1e-16);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::Rational")
)]
pub struct Rational {
    static_coefficient: f64,
    decay: f64,
    offset: f64,
    quadratic: f64,
}

impl Rational {
    /// Creates Leine's law with static coefficient μ_s and decay δ, without an offset and without a
    /// quadratic term.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless both are finite and ≥ 0.
    pub fn new(static_coefficient: f64, decay: f64) -> Result<Self, Error> {
        check_static("Rational", static_coefficient)?;
        Error::check("Rational", "decay", decay, decay >= 0.0, "decay ≥ 0")?;
        Ok(Self {
            static_coefficient,
            decay,
            offset: 0.0,
            quadratic: 0.0,
        })
    }

    /// Sets the offset μ_o, dimensionless, to which the hyperbola falls at large speeds.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless 0 ≤ μ_o ≤ μ_s.
    pub fn with_offset(mut self, offset: f64) -> Result<Self, Error> {
        self.offset = Error::check(
            "Rational",
            "offset",
            offset,
            (0.0..=self.static_coefficient).contains(&offset),
            "0 ≤ offset ≤ static_coefficient",
        )?;
        Ok(self)
    }

    /// Sets the coefficient η of the quadratic term, in 1/speed².
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless η is finite and ≥ 0.
    pub fn with_quadratic(mut self, quadratic: f64) -> Result<Self, Error> {
        self.quadratic = Error::check(
            "Rational",
            "quadratic",
            quadratic,
            quadratic >= 0.0,
            "quadratic ≥ 0",
        )?;
        Ok(self)
    }

    /// Decay δ, in 1/speed: the hyperbola has fallen by half at s = 1/δ.
    pub fn decay(&self) -> f64 {
        self.decay
    }

    /// Offset μ_o, dimensionless; 0 unless set.
    pub fn offset(&self) -> f64 {
        self.offset
    }

    /// Coefficient η of the quadratic term, in 1/speed²; 0 unless set.
    pub fn quadratic(&self) -> f64 {
        self.quadratic
    }
}

impl FrictionLaw for Rational {
    fn static_coefficient(&self) -> f64 {
        self.static_coefficient
    }

    #[inline(always)]
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        let falling = (speed * self.decay + 1.0).recip() * (self.static_coefficient - self.offset)
            + self.offset;
        if self.quadratic == 0.0 {
            falling
        } else {
            falling + speed.square() * self.quadratic
        }
    }

    #[inline(never)]
    fn erased(&self) -> LawRef<'_> {
        LawRef::of(self)
    }
    fn any(&self, _: Own) -> Option<AnyLaw> {
        Some((*self).into())
    }
}
