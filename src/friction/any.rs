use super::{
    Coulomb, Exponential, FrictionLaw, LawRef, LawVisitor, Own, Polynomial, Rational, Stribeck,
    Tabulated,
};
use crate::scalar::Scalar;

/// Any of the crate's friction laws, chosen at run time.
///
/// The functions of [`FrictionLaw`] are generic, so a law cannot be a trait object. This enum is a
/// law itself, and returns exactly the numbers of the law that it contains. To choose among your
/// own laws, write a similar enum. Its functions `static_coefficient` and `kinetic` contain a
/// `match`. If one of the laws is piecewise, write `breakpoints` and `kinetic_on` in the same way.
/// Contacts of one [`Structure`](crate::Structure) may have different laws without this enum.
///
/// ```
/// use stick_slip::{AnyLaw, Coulomb, FrictionLaw, MassOnBelt, Polynomial, Rational, State};
///
/// let laws: [AnyLaw; 3] = [
///     Polynomial::new(0.4, 0.25, 0.5)?.into(),
///     Coulomb::new(0.4, 0.25)?.into(),
///     Rational::new(0.4, 1.0)?.into(),
/// ];
/// let mut first_sticks = Vec::new();
/// for law in &laws {
///     let motion = MassOnBelt::new(law, 0.2)?.simulate(State::new(0.0, 0.0), 5.0)?;
///     first_sticks.push(motion.events()[0].time);
/// }
/// // With Coulomb's law v = μ_k sin τ until v reaches v_b.
/// assert!((first_sticks[1] - (0.2_f64 / 0.25).asin()).abs() < 1e-15);
/// assert!(first_sticks[0] < first_sticks[1] && first_sticks[2] < first_sticks[1]);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum AnyLaw {
    /// A constant kinetic coefficient.
    Coulomb(Coulomb),
    /// The Gaussian Stribeck law.
    Exponential(Exponential),
    /// The cubic law.
    Polynomial(Polynomial),
    /// The hyperbolic law.
    Rational(Rational),
    /// The Stribeck law with exponent and viscous term.
    Stribeck(Stribeck),
    /// Measured points.
    Tabulated(Tabulated),
}

macro_rules! from_law {
    ($($law:ident)*) => {$(
        impl From<$law> for AnyLaw {
            fn from(law: $law) -> Self {
                Self::$law(law)
            }
        }
    )*};
}
from_law!(Coulomb Exponential Polynomial Rational Stribeck Tabulated);

/// Evaluates one expression with the law of any variant.
macro_rules! for_each {
    ($any:expr, $law:ident => $result:expr) => {
        match $any {
            AnyLaw::Coulomb($law) => $result,
            AnyLaw::Exponential($law) => $result,
            AnyLaw::Polynomial($law) => $result,
            AnyLaw::Rational($law) => $result,
            AnyLaw::Stribeck($law) => $result,
            AnyLaw::Tabulated($law) => $result,
        }
    };
}

impl FrictionLaw for AnyLaw {
    fn static_coefficient(&self) -> f64 {
        for_each!(self, law => law.static_coefficient())
    }

    #[inline(always)]
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        for_each!(self, law => law.kinetic(speed))
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        // `Tabulated` is the only piecewise law.
        let table = match self {
            Self::Tabulated(table) => Some(table),
            _ => None,
        };
        table.into_iter().flat_map(Tabulated::breakpoints)
    }

    #[inline(always)]
    fn kinetic_on<S: Scalar>(&self, piece: usize, speed: S) -> S {
        for_each!(self, law => law.kinetic_on(piece, speed))
    }

    fn give_to<V: LawVisitor>(&self, visitor: V) -> V::Output {
        for_each!(self, law => law.give_to(visitor))
    }

    fn erased(&self) -> LawRef<'_> {
        for_each!(self, law => law.erased())
    }

    fn any(&self, _: Own) -> Option<AnyLaw> {
        Some(self.clone())
    }

    fn constant(&self, own: Own) -> Option<f64> {
        for_each!(self, law => law.constant(own))
    }
}
