//! Contact laws: friction that may depend on more than the sliding speed.

mod any;
mod bristle;
mod check;
mod dwell;
mod sliding;

pub use any::AnyContactLaw;
pub use bristle::{Dahl, LuGre};
pub(crate) use check::validate;
pub use dwell::Dwell;
pub(crate) use sliding::Sliding;

use crate::friction::FrictionLaw;
use crate::scalar::Scalar;

/// Sliding of a contact: what its law is told while it slips.
#[derive(Debug, Clone, Copy)]
pub struct Slip<S> {
    /// Sliding speed s = |r| ≥ 0, the size of the relative velocity.
    pub speed: S,
    /// Direction σ of slip, the sign of r: +1 or −1. At s = 0 the direction in which the motion
    /// goes on.
    pub direction: f64,
    /// Number of the piece of the law that holds, which is the number of
    /// [breakpoints](ContactLaw::breakpoints) below s.
    pub piece: usize,
}

impl<S: Scalar> Slip<S> {
    /// Relative velocity r = σs.
    pub fn velocity(&self) -> S {
        self.speed * self.direction
    }
}

/// State of motion of a contact, stick or slip, as its law is told.
#[derive(Debug, Clone, Copy)]
pub enum Motion<S> {
    /// The surfaces move together.
    Stick,
    /// The surfaces slide.
    Slip(Slip<S>),
}

/// The friction law of a contact, with a memory of `Z` numbers.
///
/// ```text
/// slip:   force on the mass −N·μ(r, z),  z' = rates
/// stick:  |force| ≤ N·μ_s(z),            z' = rates
/// ```
///
/// N is the normal load, r = σs the relative velocity, z the memory. Every [`FrictionLaw`] is a
/// contact law without memory: μ(r) = σμ̂(s), and μ_s is its static coefficient.
///
/// The functions are generic over the number type, by the rules of [`Scalar`]; the law may branch
/// on the direction of slip and on the base values.
pub trait ContactLaw<const Z: usize>: Sized {
    /// Friction coefficient μ(r, z), dimensionless. The friction force on the mass is −N·μ, so the
    /// coefficient is positive where that force is negative.
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, memory: [S; Z]) -> S;

    /// Static coefficient μ_s(z), dimensionless: the contact sticks while it carries at most N·μ_s.
    /// `None` for a contact that never sticks. `zero` serves to make constants:
    /// `zero.constant(0.4)`.
    fn limit<S: Scalar>(&self, zero: S, memory: [S; Z]) -> Option<S>;

    /// Rates of change dz/dt of the memory.
    fn rates<S: Scalar>(&self, motion: Motion<S>, memory: [S; Z]) -> [S; Z];

    /// Sliding speeds at which pieces of the law meet: finitely many, ascending, positive. See
    /// [`FrictionLaw::breakpoints`].
    fn breakpoints(&self) -> impl Iterator<Item = f64>;

    /// The memory after slip has ended in stick, or stick in slip, given the memory before. The
    /// event itself still shows the memory before.
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
