use super::{ContactLaw, Dahl, Dwell, LuGre, Motion, NamedLaw, RateState, Slip};
use crate::friction::FrictionLaw;
use crate::friction::law_object::{LawRef, Own};
use crate::scalar::Scalar;

/// A dry friction law or one of the crate's laws with memory, chosen at run time.
///
/// The enum has one memory variable, which a dry law does not use. (The contacts of one structure
/// may have laws of different types without this enum.)
///
/// ```
/// use stick_slip::{AnyContactLaw, AnyLaw, ContactLaw, Coulomb, Dahl, Slip};
///
/// let dry: AnyLaw = Coulomb::new(0.4, 0.25)?.into();
/// let laws = [AnyContactLaw::Dry(dry), Dahl::new(0.4, 50.0)?.into()];
/// let slip = Slip { speed: 0.1, direction: 1.0, piece: 0 };
/// let coefficients = laws.map(|law| law.coefficient(slip, [0.002]));
/// assert_eq!(coefficients, [0.25, 0.1]);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "lowercase"),
    serde(bound(
        serialize = "L: Clone + serde::Serialize",
        deserialize = "L: FrictionLaw + serde::Deserialize<'de>"
    ))
)]
#[non_exhaustive]
pub enum AnyContactLaw<L> {
    /// Dry friction, without memory.
    Dry(L),
    /// Static friction that rises with the time in stick.
    Dwell(Dwell<L>),
    /// Elastic bristles.
    Dahl(Dahl),
    /// Bristles whose friction in steady sliding follows a dry law.
    LuGre(LuGre<L>),
    /// Rate-and-state friction with one state variable.
    #[cfg_attr(feature = "serde", serde(rename = "rate_state"))]
    RateState(RateState),
}

macro_rules! from_law {
    ($($name:ident($law:ty))*) => {$(
        impl<L> From<$law> for AnyContactLaw<L> {
            fn from(law: $law) -> Self {
                Self::$name(law)
            }
        }
    )*};
}
from_law!(Dwell(Dwell<L>) Dahl(Dahl) LuGre(LuGre<L>) RateState(RateState));

/// Evaluates one expression with a dry law, another with the law of any other variant.
macro_rules! for_each {
    ($any:expr, dry $dry:pat => $of_dry:expr, $law:ident => $result:expr) => {
        match $any {
            AnyContactLaw::Dry($dry) => $of_dry,
            AnyContactLaw::Dwell($law) => $result,
            AnyContactLaw::Dahl($law) => $result,
            AnyContactLaw::LuGre($law) => $result,
            AnyContactLaw::RateState($law) => $result,
        }
    };
}

impl<L: FrictionLaw> ContactLaw for AnyContactLaw<L> {
    type Memory<S: Scalar> = [S; 1];

    #[inline]
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, memory: [S; 1]) -> S {
        for_each!(self,
            dry law => ContactLaw::coefficient(law, slip, []),
            law => law.coefficient(slip, memory))
    }

    #[inline]
    fn limit<S: Scalar>(&self, zero: S, memory: [S; 1]) -> Option<S> {
        for_each!(self, dry law => law.limit(zero, []), law => law.limit(zero, memory))
    }

    #[inline]
    fn rates<S: Scalar>(&self, motion: Motion<S>, load: S, memory: [S; 1]) -> [S; 1] {
        for_each!(self,
            dry _ => memory.map(|number| number.constant(0.0)),
            law => law.rates(motion, load, memory))
    }

    #[inline]
    fn coefficient_and_rates<S: Scalar>(
        &self,
        slip: Slip<S>,
        load: S,
        memory: [S; 1],
    ) -> (S, [S; 1]) {
        for_each!(self,
            dry law => {
                let coefficient = ContactLaw::coefficient(law, slip, []);
                (coefficient, self.rates(Motion::Slip(slip), load, memory))
            },
            law => law.coefficient_and_rates(slip, load, memory))
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        let law = match self {
            Self::Dry(law) => Some(law),
            Self::Dwell(law) => Some(law.law()),
            Self::LuGre(law) => Some(law.law()),
            Self::Dahl(_) | Self::RateState(_) => None,
        };
        law.into_iter().flat_map(FrictionLaw::breakpoints)
    }

    fn creeps(&self) -> bool {
        for_each!(self, dry _ => false, law => law.creeps())
    }

    fn changes_while_open(&self) -> bool {
        for_each!(self, dry _ => false, law => law.changes_while_open())
    }

    fn caught(&self, memory: [f64; 1]) -> [f64; 1] {
        for_each!(self, dry _ => memory, law => law.caught(memory))
    }

    fn named(&self) -> Option<NamedLaw> {
        for_each!(self,
            dry law => Some(NamedLaw::Contact(AnyContactLaw::Dry(law.any(Own)?))),
            law => law.named())
    }

    fn dry_slip(&self, direction: f64) -> Option<LawRef<'_>> {
        for_each!(self,
            dry law => law.dry_slip(direction),
            law => law.dry_slip(direction))
    }
}
