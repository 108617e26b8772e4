use super::check::{check_kinetic, check_static};
use super::{AnyLaw, FrictionLaw, LawRef, Own};
use crate::error::Error;
use crate::scalar::Scalar;

/// Coulomb's law: a constant kinetic coefficient, and a static coefficient that may be larger.
///
/// ```text
/// μ̂(s) = μ_k
/// ```
///
/// The kinetic coefficient μ̂(s) is μ_k at every sliding speed s, and μ_s is the static
/// coefficient; both are dimensionless. If μ_s > μ_k, the friction force jumps at the start of
/// slip. This jump alone can maintain stick-slip.
///
/// Source: C. A. de Coulomb, *Théorie des machines simples* (1785); Popp and Stelter, *Phil. Trans.
/// R. Soc. A* 332 (1990) 89-105.
///
/// ```
/// use stick_slip::{Coulomb, FrictionLaw};
///
/// let law = Coulomb::new(0.4, 0.25)?;
/// assert_eq!(law.static_coefficient(), 0.4);
/// assert_eq!(law.kinetic(3.0), 0.25);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::Coulomb")
)]
pub struct Coulomb {
    static_coefficient: f64,
    kinetic_coefficient: f64,
}

impl Coulomb {
    /// Creates a law with static coefficient μ_s and kinetic coefficient μ_k, both dimensionless.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless both are finite and 0 ≤ μ_k ≤ μ_s.
    pub fn new(static_coefficient: f64, kinetic_coefficient: f64) -> Result<Self, Error> {
        check_static("Coulomb", static_coefficient)?;
        check_kinetic("Coulomb", static_coefficient, kinetic_coefficient)?;
        Ok(Self {
            static_coefficient,
            kinetic_coefficient,
        })
    }

    /// Kinetic coefficient μ_k, dimensionless.
    pub fn kinetic_coefficient(&self) -> f64 {
        self.kinetic_coefficient
    }
}

impl FrictionLaw for Coulomb {
    fn static_coefficient(&self) -> f64 {
        self.static_coefficient
    }

    #[inline(always)]
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        speed.constant(self.kinetic_coefficient)
    }

    #[inline(never)]
    fn erased(&self) -> LawRef<'_> {
        LawRef::of(self)
    }
    fn any(&self, _: Own) -> Option<AnyLaw> {
        Some((*self).into())
    }

    fn constant(&self, _: Own) -> Option<f64> {
        (self.static_coefficient == self.kinetic_coefficient).then_some(self.kinetic_coefficient)
    }
}
