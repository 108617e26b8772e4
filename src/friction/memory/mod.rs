//! Contact laws: friction that may depend on more than the sliding speed.

mod any;
mod bristle;
mod check;
mod dwell;

pub use any::AnyContactLaw;
pub use bristle::{Dahl, LuGre};
pub(crate) use check::validate;
pub use dwell::Dwell;

use crate::friction::FrictionLaw;
use crate::scalar::Scalar;

/// Slip of a contact, as its law sees it.
#[derive(Debug, Clone, Copy)]
pub struct Slip<S> {
    /// Sliding speed s = |r| ≥ 0, the size of the relative velocity.
    pub speed: S,
    /// σ, the sign of r: +1 or −1. At s = 0 the side on which the motion goes on.
    pub direction: f64,
    /// The piece of the law that holds: the number of [breakpoints](ContactLaw::breakpoints) below.
    pub piece: usize,
}

impl<S: Scalar> Slip<S> {
    /// r = σs, the relative velocity.
    pub fn velocity(&self) -> S {
        self.speed * self.direction
    }
}

/// What a contact does, as its law sees it.
#[derive(Debug, Clone, Copy)]
pub enum Motion<S> {
    /// The surfaces move together.
    Stick,
    /// They slide.
    Slip(Slip<S>),
}

/// The law of a contact: dry friction, with `Z` numbers that it remembers.
///
/// ```text
/// slip:   force on the mass −N·μ(r, z),  z' = rates
/// stick:  |force| ≤ N·μ_s(z),            z' = rates
/// ```
///
/// N is the normal load, r = σs the relative velocity, z the memory. Every [`FrictionLaw`] is a
/// contact law without memory, with μ(r) = σμ̂(s) and its static coefficient as the limit.
///
/// The functions are generic over the number type, by the rules of [`Scalar`]; the law may branch
/// on the direction of slip and on the base values.
pub trait ContactLaw<const Z: usize>: Sized {
    /// Friction coefficient μ(r, z), with the sign of the force that it resists: positive where
    /// the force on the mass is negative. Dimensionless.
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, memory: [S; Z]) -> S;

    /// Static coefficient μ_s(z): the contact sticks while it carries at most N·μ_s. `None` for a
    /// contact that never sticks. Dimensionless. `zero` serves to make constants:
    /// `zero.constant(0.4)`.
    fn limit<S: Scalar>(&self, zero: S, memory: [S; Z]) -> Option<S>;

    /// dz/dt.
    fn rates<S: Scalar>(&self, motion: Motion<S>, memory: [S; Z]) -> [S; Z];

    /// Sliding speeds at which pieces of the law meet: finitely many, ascending, positive. See
    /// [`FrictionLaw::breakpoints`].
    fn breakpoints(&self) -> impl Iterator<Item = f64>;

    /// What the memory is after slip has ended in stick, or stick in slip. The event itself still
    /// shows what it was.
    fn caught(&self, memory: [f64; Z]) -> [f64; Z];
}

impl<L: FrictionLaw> ContactLaw<0> for L {
    #[inline(always)]
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, _: [S; 0]) -> S {
        self.kinetic_on(slip.piece, slip.speed) * slip.direction
    }

    #[inline(always)]
    fn limit<S: Scalar>(&self, zero: S, _: [S; 0]) -> Option<S> {
        Some(zero.constant(self.static_coefficient()))
    }

    #[inline(always)]
    fn rates<S: Scalar>(&self, _: Motion<S>, memory: [S; 0]) -> [S; 0] {
        memory
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        FrictionLaw::breakpoints(self)
    }

    fn caught(&self, memory: [f64; 0]) -> [f64; 0] {
        memory
    }
}
