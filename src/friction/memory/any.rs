use super::{ContactLaw, Dahl, Dwell, LuGre, Motion, NamedLaw, RateState, Slip};
use crate::friction::FrictionLaw;
use crate::friction::law::{LawRef, Own};
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

impl<L> From<Dwell<L>> for AnyContactLaw<L> {
    fn from(law: Dwell<L>) -> Self {
        Self::Dwell(law)
    }
}

impl<L> From<Dahl> for AnyContactLaw<L> {
    fn from(law: Dahl) -> Self {
        Self::Dahl(law)
    }
}

impl<L> From<LuGre<L>> for AnyContactLaw<L> {
    fn from(law: LuGre<L>) -> Self {
        Self::LuGre(law)
    }
}

impl<L> From<RateState> for AnyContactLaw<L> {
    fn from(law: RateState) -> Self {
        Self::RateState(law)
    }
}

impl<L: FrictionLaw> ContactLaw for AnyContactLaw<L> {
    type Memory<S: Scalar> = [S; 1];

    #[inline]
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, memory: [S; 1]) -> S {
        match self {
            Self::Dry(law) => ContactLaw::coefficient(law, slip, []),
            Self::Dwell(law) => law.coefficient(slip, memory),
            Self::Dahl(law) => law.coefficient(slip, memory),
            Self::LuGre(law) => law.coefficient(slip, memory),
            Self::RateState(law) => law.coefficient(slip, memory),
        }
    }

    #[inline]
    fn limit<S: Scalar>(&self, zero: S, memory: [S; 1]) -> Option<S> {
        match self {
            Self::Dry(law) => law.limit(zero, []),
            Self::Dwell(law) => law.limit(zero, memory),
            Self::Dahl(law) => law.limit(zero, memory),
            Self::LuGre(law) => law.limit(zero, memory),
            Self::RateState(law) => law.limit(zero, memory),
        }
    }

    #[inline]
    fn rates<S: Scalar>(&self, motion: Motion<S>, load: S, memory: [S; 1]) -> [S; 1] {
        match self {
            Self::Dry(_) => memory.map(|number| number.constant(0.0)),
            Self::Dwell(law) => law.rates(motion, load, memory),
            Self::Dahl(law) => law.rates(motion, load, memory),
            Self::LuGre(law) => law.rates(motion, load, memory),
            Self::RateState(law) => law.rates(motion, load, memory),
        }
    }

    #[inline]
    fn coefficient_and_rates<S: Scalar>(
        &self,
        slip: Slip<S>,
        load: S,
        memory: [S; 1],
    ) -> (S, [S; 1]) {
        match self {
            Self::Dahl(law) => law.coefficient_and_rates(slip, load, memory),
            Self::LuGre(law) => law.coefficient_and_rates(slip, load, memory),
            Self::RateState(law) => law.coefficient_and_rates(slip, load, memory),
            Self::Dry(_) | Self::Dwell(_) => {
                let coefficient = self.coefficient(slip, memory);
                (coefficient, self.rates(Motion::Slip(slip), load, memory))
            }
        }
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
        matches!(self, Self::RateState(_))
    }

    fn caught(&self, memory: [f64; 1]) -> [f64; 1] {
        match self {
            Self::Dwell(law) => law.caught(memory),
            _ => memory,
        }
    }

    fn named(&self) -> Option<NamedLaw> {
        match self {
            Self::Dry(law) => Some(NamedLaw::Contact(AnyContactLaw::Dry(law.any(Own)?))),
            Self::Dwell(law) => law.named(),
            Self::Dahl(law) => law.named(),
            Self::LuGre(law) => law.named(),
            Self::RateState(law) => law.named(),
        }
    }

    fn dry_slip(&self, direction: f64) -> Option<LawRef<'_>> {
        match self {
            Self::Dry(law) => law.dry_slip(direction),
            Self::Dwell(law) => law.dry_slip(direction),
            Self::Dahl(_) | Self::LuGre(_) | Self::RateState(_) => None,
        }
    }
}
