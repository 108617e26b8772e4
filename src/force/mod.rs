//! Laws of nonlinear springs and dampers, and of forces that depend on several coordinates.

// | file | what is in it |
// |---|---|
// | `mod.rs` | `ForceLaw` of one direction, `ForceField` of several: the traits of every law |
// | `polynomial_spring.rs`, `pendulum.rs`, `backlash.rs`, `snap_through.rs`, `van_der_pol.rs` | the laws with a formula |
// | `tabulated_force.rs` | measured points |
// | `stop.rs` | a stop with spring and damper, for `structure::Stop` |
// | `named.rs`, `read.rs` | any of these laws; how they are read (feature `serde`) |
// | `object.rs` | a law as a trait object, for the engine |
// | `check.rs` | checks of a law before it is used |

mod backlash;
mod check;
mod named;
pub(crate) mod object;
mod pendulum;
mod polynomial_spring;
#[cfg(feature = "serde")]
mod read;
mod snap_through;
pub(crate) mod stop;
mod tabulated_force;
mod van_der_pol;

pub use backlash::Backlash;
pub use pendulum::Pendulum;
pub use polynomial_spring::PolynomialSpring;
pub use snap_through::SnapThrough;
pub use tabulated_force::TabulatedForce;
pub use van_der_pol::VanDerPol;

pub(crate) use check::validate;
#[cfg(feature = "serde")]
pub(crate) use named::NamedForce;
pub(crate) use named::SharedForce;

use crate::friction::memory::Variables;
use crate::scalar::Scalar;

/// A force that depends on one position and its velocity: a nonlinear spring or damper.
///
/// ```text
/// force on the structure  −a F(x, y),   x = a·q,   y = a·v
/// ```
///
/// x is the position along the direction a of a [`ForceElement`](crate::ForceElement), y the
/// velocity. Positions, velocities and forces have the units of the structure. A positive F pulls
/// towards smaller x: F = kx is a linear spring.
///
/// The functions are generic over the number type, by the rules of [`Scalar`]. A law must be
/// analytic (have a power series) at every position that a motion reaches, except at its
/// [breakpoints](Self::breakpoints), and continuous everywhere. It may not jump: a force that jumps
/// with the sign of the velocity is friction, a [`Contact`](crate::Contact).
///
/// ```
/// use stick_slip::{ForceElement, ForceLaw, Scalar, Structure, structure::State};
///
/// /// A spring that can be pulled, but not pushed: a rope of stiffness k.
/// struct Rope(f64);
///
/// impl ForceLaw for Rope {
///     fn force<S: Scalar>(&self, position: S, _: S, piece: usize) -> S {
///         if piece == 0 { position.constant(0.0) } else { position * self.0 }
///     }
///     fn potential<S: Scalar>(&self, position: S, piece: usize) -> Option<S> {
///         Some(self.force(position, position, piece) * position * 0.5)
///     }
///     fn breakpoints(&self) -> impl Iterator<Item = f64> {
///         [0.0].into_iter()
///     }
/// }
///
/// // A mass of 1 flies into a rope of stiffness 4, and back: half an oscillation of frequency 2.
/// let mass = Structure::new(&[1.0])?.with_element(ForceElement::new(0, Rope(4.0))?)?;
/// let motion = mass.simulate(State::new(&[-1.0], &[1.0]), 6.0)?;
/// let back = motion.state_at(1.0 + std::f64::consts::FRAC_PI_2).unwrap();
/// assert!(back.displacements[0].abs() < 1e-15 && (back.velocities[0] + 1.0).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not the law of a force of one direction",
    note = "a closure cannot be a law, because a law is evaluated on power series, too; write \
            `struct MyLaw;` and `impl ForceLaw for MyLaw`"
)]
pub trait ForceLaw: Sized {
    /// Force F(x, y). `piece` is the number of [breakpoints](Self::breakpoints) below x.
    fn force<S: Scalar>(&self, position: S, velocity: S, piece: usize) -> S;

    /// Potential U(x) with dU/dx = F(x, 0), in units of energy; `None` for a law without one.
    ///
    /// With a potential the work of the force is a difference of U, exact to rounding, and U is
    /// part of the energy of the structure.
    fn potential<S: Scalar>(&self, position: S, piece: usize) -> Option<S> {
        let _ = (position, piece);
        None
    }

    /// Positions at which pieces of the law meet: finitely many, ascending, of any sign. F is
    /// continuous there, its slope may jump.
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        std::iter::empty()
    }
}

/// Forces that depend on several positions and their velocities, such as those of a potential
/// U(x_1 … x_m).
///
/// ```text
/// force on the structure  −Σ a_i F_i(x, y),   x_i = a_i·q,   y_i = a_i·v
/// ```
///
/// The directions a_i are those of [`ForceElement::field`](crate::ForceElement::field). The rules
/// are those of [`ForceLaw`]; fields have no breakpoints.
///
/// ```
/// use stick_slip::{ForceElement, ForceField, Scalar, Structure, structure::State};
///
/// /// A spring that stretches in the plane: F_i = k (x_0² + x_1²) x_i.
/// struct Whirl(f64);
///
/// impl ForceField for Whirl {
///     type Coordinates<S: Scalar> = [S; 2];
///     fn forces<S: Scalar>(&self, [x, y]: [S; 2], _: [S; 2]) -> [S; 2] {
///         let stiffness = (x.square() + y.square()) * self.0;
///         [stiffness * x, stiffness * y]
///     }
///     fn potential<S: Scalar>(&self, [x, y]: [S; 2]) -> Option<S> {
///         Some((x.square() + y.square()).square() * (0.25 * self.0))
///     }
/// }
///
/// // A circular whirl of radius 1 has the frequency √k.
/// let directions: [&[(usize, f64)]; 2] = [&[(0, 1.0)], &[(1, 1.0)]];
/// let rotor = Structure::new(&[1.0, 1.0])?
///     .with_element(ForceElement::field(&directions, Whirl(4.0))?)?;
/// let motion = rotor.simulate(State::new(&[1.0, 0.0], &[0.0, 2.0]), std::f64::consts::PI)?;
/// assert!((motion.last().displacements[0] - 1.0).abs() < 1e-14);
/// assert!(motion.last().displacements[1].abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub trait ForceField: Sized {
    /// The positions, velocities and forces: an array `[S; m]`, where m is the number of
    /// directions.
    type Coordinates<S: Scalar>: Variables<S>;

    /// Forces F_i(x, y).
    fn forces<S: Scalar>(
        &self,
        positions: Self::Coordinates<S>,
        velocities: Self::Coordinates<S>,
    ) -> Self::Coordinates<S>;

    /// Potential U(x) with ∂U/∂x_i = F_i(x, 0), in units of energy; `None` for a field without one.
    fn potential<S: Scalar>(&self, positions: Self::Coordinates<S>) -> Option<S> {
        let _ = positions;
        None
    }
}
