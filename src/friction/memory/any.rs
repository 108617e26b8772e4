use super::{ContactLaw, Dahl, Dwell, LuGre, Motion, Slip};
use crate::friction::FrictionLaw;
use crate::scalar::Scalar;

/// Dry friction or one of the crate's laws with memory, for different contacts in one structure.
///
/// Every contact then has one memory variable; that of a dry law stays what it is.
///
/// ```
/// use stick_slip::{AnyContactLaw, AnyLaw, Contact, Coulomb, Dahl, Structure};
///
/// let dry: AnyLaw = Coulomb::new(0.4, 0.25)?.into();
/// let two = Structure::new(&[1.0, 1.0])?
///     .with_spring(0, 1, 1.0)?
///     .with_contact(Contact::new(0, AnyContactLaw::Dry(dry), 1.0)?)?
///     .with_contact(Contact::new(1, Dahl::new(0.4, 50.0)?.into(), 1.0)?)?;
/// assert_eq!(two.contacts().len(), 2);
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
    /// No memory.
    Dry(L),
    /// Static friction that rises at rest.
    Dwell(Dwell<L>),
    /// Elastic bristles.
    Dahl(Dahl),
    /// Bristles with a law of sliding.
    LuGre(LuGre<L>),
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

impl<L: FrictionLaw> ContactLaw<1> for AnyContactLaw<L> {
    #[inline]
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, memory: [S; 1]) -> S {
        match self {
            Self::Dry(law) => ContactLaw::<0>::coefficient(law, slip, []),
            Self::Dwell(law) => law.coefficient(slip, memory),
            Self::Dahl(law) => law.coefficient(slip, memory),
            Self::LuGre(law) => law.coefficient(slip, memory),
        }
    }

    #[inline]
    fn limit<S: Scalar>(&self, zero: S, memory: [S; 1]) -> Option<S> {
        match self {
            Self::Dry(law) => law.limit(zero, []),
            Self::Dwell(law) => law.limit(zero, memory),
            Self::Dahl(law) => law.limit(zero, memory),
            Self::LuGre(law) => law.limit(zero, memory),
        }
    }

    #[inline]
    fn rates<S: Scalar>(&self, motion: Motion<S>, memory: [S; 1]) -> [S; 1] {
        match self {
            Self::Dry(_) => memory.map(|number| number.constant(0.0)),
            Self::Dwell(law) => law.rates(motion, memory),
            Self::Dahl(law) => law.rates(motion, memory),
            Self::LuGre(law) => law.rates(motion, memory),
        }
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        let law = match self {
            Self::Dry(law) => Some(law),
            Self::Dwell(law) => Some(law.law()),
            Self::LuGre(law) => Some(law.law()),
            Self::Dahl(_) => None,
        };
        law.into_iter().flat_map(FrictionLaw::breakpoints)
    }

    fn caught(&self, memory: [f64; 1]) -> [f64; 1] {
        match self {
            Self::Dwell(law) => law.caught(memory),
            _ => memory,
        }
    }
}
