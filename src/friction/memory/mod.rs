//! Contact laws: friction that may depend on more than the sliding speed.

// | file | what is in it |
// |---|---|
// | `mod.rs` | `ContactLaw`, the trait of every contact law, and its arguments |
// | `directional.rs` | friction that depends on the direction of slip |
// | `freewheel.rs` | a contact that slips in one direction only |
// | `dwell.rs` | static friction that rises with the time in stick |
// | `bristle.rs` | LuGre's and Dahl's bristles |
// | `rate_state.rs` | rate-and-state friction |
// | `any.rs` | a contact law chosen at run time |
// | `object.rs` | a contact law as a trait object, for the engine |
// | `sliding.rs` | steady sliding of a contact with memory, linearised |
// | `check.rs` | checks of a law before it is used |
// | `read.rs` | serialization of these laws (feature `serde`) |

mod any;
mod bristle;
#[cfg(feature = "structures")]
mod check;
mod directional;
mod dwell;
mod freewheel;
#[cfg(feature = "structures")]
pub(crate) mod object;
mod rate_state;
#[cfg(feature = "serde")]
pub(crate) mod read;
#[cfg(feature = "structures")]
mod sliding;

pub use any::AnyContactLaw;
pub use bristle::{Dahl, LuGre};
#[cfg(feature = "structures")]
pub(crate) use check::validate;
pub use directional::Directional;
pub use dwell::Dwell;
pub use freewheel::Freewheel;
pub(crate) use rate_state::Evolution;
pub use rate_state::{RateState, RateState2};
#[cfg(feature = "structures")]
pub(crate) use sliding::{Input, Sliding};

use crate::friction::{AnyLaw, FrictionLaw, LawRef, Own};
use crate::scalar::Scalar;

/// Sliding of a contact at one instant. A [`ContactLaw`] gets this value in slip.
///
/// ```
/// use stick_slip::{ContactLaw, Coulomb, Slip};
///
/// let backward = Slip { speed: 0.1, direction: -1.0, piece: 0 };
/// assert_eq!(backward.velocity(), -0.1);
/// assert_eq!(Coulomb::new(0.4, 0.25)?.coefficient(backward, []), -0.25);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub struct Slip<S> {
    /// Sliding speed s = |r| ≥ 0, the size of the relative velocity.
    pub speed: S,
    /// Direction σ of slip, the sign of r: +1 or −1. At s = 0 it is the direction in which slip
    /// begins or continues.
    pub direction: f64,
    /// Index of the active piece of the law: the number of
    /// [breakpoints](ContactLaw::breakpoints) below s.
    pub piece: usize,
}

impl<S: Scalar> Slip<S> {
    /// Relative velocity r = σs.
    pub fn velocity(&self) -> S {
        self.speed * self.direction
    }
}

/// Stick or slip of a contact at one instant: an argument of [`ContactLaw::rates`].
///
/// ```
/// use stick_slip::{ContactLaw, Coulomb, Dahl, Dwell, Motion, Slip};
///
/// // The dwell clock runs in stick only; bristles bend in slip only.
/// let clock = Dwell::hyperbolic(Coulomb::new(0.4, 0.3)?, 0.6, 2.0)?;
/// let bristles = Dahl::new(0.4, 50.0)?;
/// let slip = Motion::Slip(Slip { speed: 0.1, direction: -1.0, piece: 0 });
/// let load = 5.0;
/// assert_eq!(clock.rates(Motion::Stick, load, [0.0]), [1.0]);
/// assert_eq!(clock.rates(slip, load, [0.0]), [0.0]);
/// assert_eq!(bristles.rates(Motion::Stick, load, [0.0]), [0.0]);
/// assert_eq!(bristles.rates(slip, load, [0.0]), [-0.1]);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy)]
pub enum Motion<S> {
    /// The surfaces move together.
    Stick,
    /// The surfaces slide.
    Slip(Slip<S>),
}

/// The memory variables of a contact: an array `[S; Z]` of any length Z. No other type can
/// implement this trait.
pub trait Variables<S>: sealed::Sealed + Copy + AsRef<[S]> + AsMut<[S]> {
    /// Number of variables.
    const COUNT: usize;
    /// Creates the memory variables: variable number j is `value(j)`.
    fn from_fn(value: impl FnMut(usize) -> S) -> Self;
}

mod sealed {
    pub trait Sealed {}
    impl<S, const Z: usize> Sealed for [S; Z] {}
}

impl<S: Copy, const Z: usize> Variables<S> for [S; Z] {
    const COUNT: usize = Z;

    #[inline(always)]
    fn from_fn(value: impl FnMut(usize) -> S) -> Self {
        std::array::from_fn(value)
    }
}

/// A law of the crate, for serialization and comparison of contacts. Not exported.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(untagged))]
pub enum NamedLaw {
    /// A law without memory variables.
    Dry(AnyLaw),
    /// One that depends on the direction of slip, without memory variables.
    Sided(SidedLaw),
    /// A law with one memory variable, which a dry law does not use.
    Contact(AnyContactLaw<AnyLaw>),
    /// A rate-and-state law with two memory variables.
    TwoStates {
        /// The law, under its name.
        rate_state: RateState2,
    },
}

/// A law of the crate that depends on the direction of slip. Not exported.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(rename_all = "lowercase")
)]
pub enum SidedLaw {
    /// Two laws.
    Directional(Directional<AnyLaw, AnyLaw>),
    /// The law of the drag.
    Freewheel(Freewheel<AnyLaw>),
}

/// The friction law of a contact, with or without memory.
///
/// ```text
/// slip:   friction  λ = N·μ(r, z),         z' = rates(r, N, z)
/// stick:  −N·μ_s⁻(z) ≤ λ ≤ N·μ_s⁺(z),      z' = rates(N, z)
/// ```
///
/// N is the normal load, λ the friction force, μ the friction coefficient, and μ_s⁺ and μ_s⁻ the
/// static coefficients against slip forward and backward; most laws have one μ_s for both. z are
/// the memory variables; [`rates`](Self::rates) returns their rates z'. r = σs is the relative
/// velocity, with the direction of slip σ = ±1 and the sliding speed s. A positive λ opposes a
/// positive r. Every [`FrictionLaw`] is also a contact law, without memory: μ(r) = σμ̂(s), with its
/// kinetic coefficient μ̂(s) and its own μ_s. [`Directional`] combines two of them, one for each
/// direction.
///
/// The functions are generic over the number type, by the rules of [`Scalar`]. The law may branch
/// on the direction of slip, and on the numbers that [`Scalar::value`] returns for its arguments.
///
/// If friction depends on the direction of slip, write [`limits`](Self::limits), too: otherwise the
/// contact sticks up to the same force in both directions.
///
/// [`Contact::new`](crate::Contact::new) checks the law in both directions, with a memory of zeros,
/// under the load at time 0. At speed 0, the static coefficient of each direction must be at least
/// |μ|, and friction must oppose slip. The law must be continuous at its breakpoints and, if it
/// never sticks, at r = 0.
///
/// ```
/// use stick_slip::{Contact, ContactLaw, Drive, Motion, Scalar, Slip, Structure, structure::State};
///
/// /// Brake fade: friction heats the surfaces, and their temperature z lowers μ from 0.5 to 0.3.
/// struct Fade {
///     heat_capacity: f64,
/// }
///
/// impl ContactLaw for Fade {
///     type Memory<S: Scalar> = [S; 1];
///     fn coefficient<S: Scalar>(&self, slip: Slip<S>, [z]: [S; 1]) -> S {
///         ((-z).exp() * 0.2 + 0.3) * slip.direction
///     }
///     fn limit<S: Scalar>(&self, _: S, [z]: [S; 1]) -> Option<S> {
///         Some((-z).exp() * 0.2 + 0.3)
///     }
///     fn rates<S: Scalar>(&self, motion: Motion<S>, load: S, memory: [S; 1]) -> [S; 1] {
///         match motion {
///             Motion::Stick => memory.map(|z| z.constant(0.0)),
///             // The power of friction, N μ r.
///             Motion::Slip(slip) => {
///                 let power = load * self.coefficient(slip, memory) * slip.velocity();
///                 [power / self.heat_capacity]
///             }
///         }
///     }
///     fn breakpoints(&self) -> impl Iterator<Item = f64> {
///         std::iter::empty()
///     }
///     fn caught(&self, memory: [f64; 1]) -> [f64; 1] {
///         memory
///     }
/// }
///
/// let load = Drive::constant(1.0).with_harmonic(0.5, 3.0, 0.0)?;
/// let pad = Contact::new(0, Fade { heat_capacity: 4.0 }, load)?;
/// let block = Structure::new(&[1.0])?.with_contact(pad)?;
/// let motion = block.simulate(State::new(&[0.0], &[2.0]), 20.0)?;
/// // At rest the energy v²/2 = 2 of the block has become heat.
/// assert!((motion.last().memory[0] - 2.0 / 4.0).abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not the law of a contact",
    label = "neither `FrictionLaw` nor `ContactLaw`",
    note = "a closure cannot be a law, because a law is evaluated on power series, too; write \
            `struct MyLaw;` and `impl FrictionLaw for MyLaw`, or `impl ContactLaw for MyLaw` \
            if the law has memory variables"
)]
pub trait ContactLaw: Sized {
    /// The memory variables: an array `[S; Z]`, where Z is their number.
    type Memory<S: Scalar>: Variables<S>;

    /// Friction coefficient μ(r, z), dimensionless. The friction λ = N·μ acts on the mass as the
    /// force −λ: friction with a positive μ opposes a positive r.
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, memory: Self::Memory<S>) -> S;

    /// Static coefficient μ_s(z), dimensionless: the contact sticks while the size of its force is
    /// at most N·μ_s, in both directions. `None` for a contact that never sticks. The argument
    /// `zero` is the number 0 of type `S`: `zero.constant(0.4)` is the constant 0.4 of this type.
    ///
    /// If you write [`limits`](Self::limits), this function is not called.
    fn limit<S: Scalar>(&self, zero: S, memory: Self::Memory<S>) -> Option<S>;

    /// Static coefficients against slip backward and forward, `[μ_s⁻(z), μ_s⁺(z)]`, dimensionless:
    /// the contact sticks while −N·μ_s⁻ ≤ λ ≤ N·μ_s⁺. `None` for a contact that never sticks.
    ///
    /// By default both are [`limit`](Self::limit). Write this function if friction depends on the
    /// direction of slip. One of the two may be infinite: the contact never slips in this
    /// direction, and the coefficient there does not matter. See [`Freewheel`].
    #[inline(always)]
    fn limits<S: Scalar>(&self, zero: S, memory: Self::Memory<S>) -> Option<[S; 2]> {
        self.limit(zero, memory).map(|limit| [limit; 2])
    }

    /// Rates of change dz/dt of the memory variables, per unit of time. `load` is the normal load
    /// N, in units of force: frictional heat N·μ|r|, for example, drives the temperature of a
    /// contact. While the contact is open its memory stays as it is, unless the law
    /// [changes while open](Self::changes_while_open).
    fn rates<S: Scalar>(
        &self,
        motion: Motion<S>,
        load: S,
        memory: Self::Memory<S>,
    ) -> Self::Memory<S>;

    /// Sliding speeds at which pieces of the law meet, in units of velocity: finitely many,
    /// ascending, positive. See [`FrictionLaw::breakpoints`].
    fn breakpoints(&self) -> impl Iterator<Item = f64>;

    /// The memory just after a stick or release event, as a function of the memory just before the
    /// event. The state stored in the event contains the memory just before the event.
    fn caught(&self, memory: Self::Memory<f64>) -> Self::Memory<f64>;

    /// Returns true if the memory also changes while the contact is open: with its
    /// [`rates`](Self::rates) in slip under the load 0. Asperities age and heat flows away without
    /// a load, too; bristles that touch nothing stay as they are. These rates must be continuous
    /// where r changes its sign.
    ///
    /// ```
    /// use stick_slip::{Contact, Drive, RateState, Structure, structure::State};
    ///
    /// // A block at rest, lifted at t = 1: asperities age all the while, by φ' = (V₀/D_c) e^−φ, so
    /// // φ = ln(1 + t V₀/D_c).
    /// let law = RateState::aging(0.6, 0.01, 0.015, 0.3, 0.1)?;
    /// let load = Drive::profile(&[(0.0, 1.0), (2.0, -1.0)])?;
    /// let block = Structure::new(&[1.0])?
    ///     .with_ground_spring(0, 1.0)?
    ///     .with_contact(Contact::new(0, law, load)?)?;
    /// let motion = block.simulate(State::at_rest(1).with_memory(&[0.0]), 6.0)?;
    /// assert!((motion.last().memory[0] - 3.0_f64.ln()).abs() < 1e-13);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    fn changes_while_open(&self) -> bool {
        false
    }

    /// Returns true if a contact with this law may creep far more slowly than its surface moves,
    /// with friction that depends on every digit of its speed, such as on ln |r|. The states of a
    /// motion then contain the relative velocity as a number of its own
    /// ([`sliding`](crate::structure::State::sliding)).
    fn creeps(&self) -> bool {
        false
    }

    /// The coefficient and the rates in slip. Write this function if both have operations in
    /// common.
    #[inline(always)]
    fn coefficient_and_rates<S: Scalar>(
        &self,
        slip: Slip<S>,
        load: S,
        memory: Self::Memory<S>,
    ) -> (S, Self::Memory<S>) {
        let coefficient = self.coefficient(slip, memory);
        (coefficient, self.rates(Motion::Slip(slip), load, memory))
    }

    /// The law as one of the laws of this crate, for serialization and comparison; `None` for a
    /// user's law.
    #[doc(hidden)]
    fn named(&self) -> Option<NamedLaw> {
        None
    }

    /// The coefficient of a constant law without memory, μ_s = μ at every speed; `None` for any
    /// other law.
    #[doc(hidden)]
    fn constant(&self, _: Own) -> Option<f64> {
        None
    }

    /// The friction in slip in a direction (±1), in the form used by the engine of one mass, with
    /// the same pieces; `None` if it depends on memory variables, or if these change in slip.
    #[doc(hidden)]
    fn dry_slip(&self, _direction: f64) -> Option<LawRef<'_>> {
        None
    }
}

impl<L: FrictionLaw> ContactLaw for L {
    type Memory<S: Scalar> = [S; 0];

    #[inline(always)]
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, _: [S; 0]) -> S {
        self.kinetic_on(slip.piece, slip.speed) * slip.direction
    }

    #[inline(always)]
    fn limit<S: Scalar>(&self, zero: S, _: [S; 0]) -> Option<S> {
        Some(zero.constant(self.static_coefficient()))
    }

    #[inline(always)]
    fn rates<S: Scalar>(&self, _: Motion<S>, _: S, memory: [S; 0]) -> [S; 0] {
        memory
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        FrictionLaw::breakpoints(self)
    }

    fn caught(&self, memory: [f64; 0]) -> [f64; 0] {
        memory
    }

    fn named(&self) -> Option<NamedLaw> {
        FrictionLaw::any(self, Own).map(NamedLaw::Dry)
    }

    fn constant(&self, own: Own) -> Option<f64> {
        FrictionLaw::constant(self, own)
    }

    fn dry_slip(&self, _: f64) -> Option<LawRef<'_>> {
        Some(self.erased())
    }
}
