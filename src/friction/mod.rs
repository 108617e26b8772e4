//! Friction laws: the friction coefficient as a function of the sliding speed.

// | file | what is in it |
// |---|---|
// | `mod.rs` | `FrictionLaw`, the trait of every law; implement it for a law of your own |
// | `coulomb.rs`, `exponential.rs`, `polynomial.rs`, `rational.rs`, `stribeck.rs` | the laws with a formula |
// | `tabulated.rs` | measured points |
// | `any.rs` | a law chosen at run time |
// | `memory/` | contact laws with memory |
// | `scaled.rs` | a law given over speeds in metres per second |
// | `law_object.rs` | a law as a trait object, for the engines |
// | `piece.rs` | one analytic piece of a law |
// | `expansion.rs` | power series of a law's pieces at one speed |
// | `slip_series.rs` | the power series of a mass that slides on a law |
// | `slope_zeros.rs` | a law as a chain of power series over a range of speeds: sign changes and least value of its slope |
// | `check.rs` | checks of a law before it is used; whether it is constant |
// | `iwan.rs` | Segalman's distribution of springs and sliders |
// | `inspect.rs`, `fault.rs` | `check_law`: faults of a law over a range of speeds, and their texts |
// | `read.rs` | how laws are read (feature `serde`) |

mod any;
pub(crate) mod check;
mod coulomb;
mod expansion;
mod exponential;
mod fault;
mod inspect;
mod iwan;
mod law_object;
pub(crate) mod memory;
mod piece;
mod polynomial;
mod rational;
#[cfg(feature = "serde")]
pub(crate) mod read;
mod scaled;
pub(crate) mod slip_series;
mod slope_zeros;
mod stribeck;
mod tabulated;

pub use any::AnyLaw;
pub use coulomb::Coulomb;
pub use exponential::Exponential;
pub use fault::LawFault;
pub use inspect::check_law;
pub use iwan::Iwan4;
pub use polynomial::Polynomial;
pub use rational::Rational;
pub use scaled::Scaled;
pub use stribeck::Stribeck;
pub use tabulated::Tabulated;

pub(crate) use check::{
    frictionless_speed, is_constant_near, is_constant_on, static_is_nan, validate,
};
pub(crate) use expansion::{finite_at, slope_on, taylor_coefficients, taylor_coefficients_on};
pub(crate) use law_object::{Law, LawRef, Own, Values};
pub(crate) use piece::{Piece, piece_above, value_and_slope};
pub(crate) use slope_zeros::{AlongSlope, FarEnd};

use crate::scalar::Scalar;

/// A function that takes a law of any type. See [`FrictionLaw::give_to`]. Not exported.
pub trait LawVisitor {
    /// The result.
    type Output;

    /// Calls the function.
    fn visit<L: FrictionLaw>(self, law: &L) -> Self::Output;

    /// Calls the function for a law that is seldom used: less code, which takes longer.
    #[inline(always)]
    fn visit_seldom<L: FrictionLaw>(self, law: &L) -> Self::Output
    where
        Self: Sized,
    {
        self.visit(law)
    }
}

/// Order of the highest derivative that is computed.
const HIGHEST: usize = 30;

/// A dry friction law: the static coefficient, and the kinetic coefficient μ̂(s) at sliding speed
/// s = |v_r| ≥ 0.
///
/// v is the velocity of the mass, v_b the velocity of the belt, and v_r = v − v_b the relative
/// velocity. The friction coefficient is odd in the relative velocity: μ(v_r) = sgn(v_r)·μ̂(|v_r|).
/// Coefficients are dimensionless. All speeds, also those that are parameters of a law, are
/// dimensionless for a [`MassOnBelt`](crate::MassOnBelt), in m/s for a
/// [`PhysicalMassOnBelt`](crate::PhysicalMassOnBelt), and in the units of the structure for a
/// [`Structure`](crate::Structure).
///
/// # What to write
///
/// A law needs two functions, [`static_coefficient`](Self::static_coefficient) and
/// [`kinetic`](Self::kinetic). `kinetic` is generic over the number type, so the crate can compute
/// its exact derivatives and its power series along a motion. You write no derivative by hand.
/// [`Scalar`] states the rules for writing `kinetic`.
///
/// ```
/// use stick_slip::{FrictionLaw, MassOnBelt, Scalar, State};
///
/// /// Leine et al., Nonlinear Dynamics 16 (1998) 41-54: μ̂(s) = μ_s/(1 + δ s).
/// struct Leine {
///     static_coefficient: f64,
///     decay: f64,
/// }
///
/// impl FrictionLaw for Leine {
///     fn static_coefficient(&self) -> f64 {
///         self.static_coefficient
///     }
///     #[inline(always)]
///     fn kinetic<S: Scalar>(&self, speed: S) -> S {
///         (speed * self.decay + 1.0).recip() * self.static_coefficient
///     }
/// }
///
/// let law = Leine { static_coefficient: 1.0, decay: 3.0 };
/// assert_eq!(law.slope(0.0), -3.0);
///
/// let motion = MassOnBelt::new(law, 0.2)?.simulate(State::new(0.0, 0.0), 30.0)?;
/// let events = motion.events();
/// let period = events[4].time - events[2].time;
/// assert!((period - 12.0010312948).abs() < 1e-9);
/// # Ok::<(), stick_slip::Error>(())
/// ```
///
/// Mark `kinetic`, and every function that it calls, as `#[inline(always)]`; for a law of several
/// pieces mark `kinetic_on`. Your law is then as fast as the crate's laws. Without the attribute,
/// or with `#[inline]`, a step may take three times as long in a build for all x86-64 processors:
/// code that is not inlined calls a library function for each fused multiply-add.
///
/// # Piecewise laws
///
/// A piecewise analytic law (a table, a law with kinks) must be continuous. Its
/// [`breakpoints`](Self::breakpoints) are the speeds at which pieces meet, and
/// [`kinetic_on`](Self::kinetic_on) evaluates one piece. Piece i lies between breakpoint i−1 and
/// breakpoint i; piece 0 begins at s = 0. The integrator ends a step exactly at a breakpoint, and
/// then evaluates the piece on the other side by its number. `kinetic_on` therefore need not
/// compare the speed with a breakpoint. Every piece is also evaluated slightly outside its
/// interval.
///
/// # What a law must not do
///
/// A law must be a pure function: the same result for the same speed, and always the same
/// breakpoints and μ_s. It must not panic. If the law returns NaN or ±∞ at a speed that the motion
/// reaches, the motion ends in a typed error. The law must satisfy 0 ≤ μ̂(0) ≤ μ_s, up to rounding,
/// with the static coefficient μ_s.
///
/// Checks of these rules:
///
/// | fault of the law | detected by |
/// |---|---|
/// | μ_s < μ̂(0); μ_s or μ̂(0) negative or not finite; a law that is not finite at s = 0 | [`MassOnBelt::new`](crate::MassOnBelt::new) |
/// | breakpoints that do not ascend; a jump at a breakpoint | [`MassOnBelt::new`](crate::MassOnBelt::new) |
/// | μ_s that becomes NaN later | the next stick phase, as an error |
/// | NaN, ±∞ or an infinite slope at a speed at which a step evaluates the law | the step, as an error |
/// | a jump or kink that is not declared | usually the step: the step is shortened until its series fits the law on both sides, or returns an error |
/// | an undeclared jump between two speeds at which steps evaluate the law | nothing: the motion has an error of the size of the jump |
/// | a feature, or an interval of NaN, narrower than the distance between the speeds at which a step evaluates the law (at least four in each step) | [`check_law`] only |
/// | μ̂ < 0 at a speed above 0 | [`check_law`] only: motions are computed with the negative coefficient, so friction drives the mass |
/// | breakpoints that change | nothing: the motion follows one version of the law, or ends in an error |
///
/// Steps evaluate the law at some speeds only; [`check_law`] searches a whole range of speeds.
#[diagnostic::on_unimplemented(
    message = "`{Self}` is not a friction law",
    label = "no `FrictionLaw`",
    note = "a closure cannot be a law, because a law is evaluated on power series, too; write \
            `struct MyLaw;` and `impl FrictionLaw for MyLaw`, with `static_coefficient` and \
            `kinetic`, or give points to `Tabulated::new`"
)]
pub trait FrictionLaw: Sized {
    /// Static coefficient μ_s, dimensionless: the mass sticks while the size of the contact force
    /// is at most μ_s times the normal load.
    fn static_coefficient(&self) -> f64;

    /// Kinetic coefficient μ̂(s) at sliding speed s ≥ 0, dimensionless; at s = 0 the limit from
    /// above.
    fn kinetic<S: Scalar>(&self, speed: S) -> S;

    /// Sliding speeds at which the pieces of a piecewise law meet: finitely many, ascending,
    /// positive. An analytic law needs no breakpoints. However, if it has a very narrow feature
    /// away from s = 0, return the centre and the ends of the feature, so that no step misses it.
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        std::iter::empty()
    }

    /// Kinetic coefficient of one piece of the law, dimensionless. Pieces are numbered from 0. The
    /// formula of each piece must also be valid slightly beyond the ends of the piece (analytic
    /// continuation). An analytic law has one piece.
    #[inline(always)]
    fn kinetic_on<S: Scalar>(&self, _piece: usize, speed: S) -> S {
        self.kinetic(speed)
    }

    /// Calls a visitor with the law. A choice of laws passes the chosen law, and a reference passes
    /// the law that it refers to. [`Scaled`] needs this function: otherwise the series of a scaled
    /// choice would hold all laws in one piece of code.
    #[doc(hidden)]
    #[inline(always)]
    fn give_to<V: LawVisitor>(&self, visitor: V) -> V::Output {
        visitor.visit(self)
    }

    /// The law as a trait object for the engines. Each of the crate's laws has its own copy of this
    /// function, never inlined: its motion is then compiled with the crate, not again in every
    /// program.
    #[doc(hidden)]
    fn erased(&self) -> LawRef<'_> {
        LawRef::of(self)
    }

    /// The law as a value of [`AnyLaw`], which is used to write and compare it; `None` for a user's
    /// law.
    #[doc(hidden)]
    fn any(&self, _: Own) -> Option<AnyLaw> {
        None
    }

    /// The coefficient of a constant law, μ_s = μ̂(s) at every speed; `None` if the law is not
    /// constant, or if this is not known.
    #[doc(hidden)]
    fn constant(&self, _: Own) -> Option<f64> {
        None
    }

    /// Friction coefficient μ(v_r) = sgn(v_r)·μ̂(|v_r|), dimensionless, at a relative velocity v_r
    /// of either sign; 0 at v_r = 0.
    ///
    /// ```
    /// use stick_slip::{Coulomb, FrictionLaw};
    ///
    /// let law = Coulomb::new(0.4, 0.25)?;
    /// assert_eq!(law.coefficient(-0.1), -0.25);
    /// assert_eq!(law.coefficient(0.0), 0.0);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    fn coefficient(&self, relative_velocity: f64) -> f64 {
        if relative_velocity == 0.0 {
            0.0
        } else {
            self.kinetic(relative_velocity.abs()) * relative_velocity.signum()
        }
    }

    /// Slope dμ̂/ds at sliding speed s, in units of 1/speed, exact to rounding; at a breakpoint,
    /// the slope of the piece above it.
    ///
    /// ```
    /// use stick_slip::{FrictionLaw, Polynomial};
    ///
    /// // −k1 + 3 k3 s²  (Eqs. 3-5)
    /// let law = Polynomial::new(0.4, 0.25, 0.5)?;
    /// assert!((law.slope(0.2) - (-0.45 + 3.0 * 0.6 * 0.04)).abs() < 1e-16);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    fn slope(&self, speed: f64) -> f64 {
        value_and_slope(self, piece_above(self.breakpoints(), speed), speed).1
    }

    /// Second derivative d²μ̂/ds² at sliding speed s, in units of 1/speed², exact to rounding; at
    /// a breakpoint, the derivative of the piece above it.
    ///
    /// ```
    /// use stick_slip::{FrictionLaw, Polynomial};
    ///
    /// // 6 k3 s  (Eqs. 3-5)
    /// let law = Polynomial::new(0.4, 0.25, 0.5)?;
    /// assert!((law.curvature(0.2) - 6.0 * 0.6 * 0.2).abs() < 1e-15);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    fn curvature(&self, speed: f64) -> f64 {
        2.0 * taylor_coefficients::<3>(self, speed)[2]
    }

    /// Derivative of order n of μ̂ at sliding speed s, in units of 1/speedⁿ, exact to rounding;
    /// at a breakpoint, the derivative of the piece above it. NaN for n > 30.
    ///
    /// ```
    /// use stick_slip::{Exponential, FrictionLaw};
    ///
    /// // d⁴/ds⁴ exp(−s²) = 12 at s = 0
    /// let law = Exponential::new(1.25, 0.25, 1.0)?;
    /// assert!((law.derivative(4, 0.0) - 12.0).abs() < 1e-14);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    fn derivative(&self, n: usize, speed: f64) -> f64 {
        match n {
            1 => self.slope(speed),
            0..=HIGHEST => {
                let factorial: f64 = (1..=n).map(|k| k as f64).product();
                taylor_coefficients::<{ HIGHEST + 1 }>(self, speed)[n] * factorial
            }
            _ => f64::NAN,
        }
    }
}

impl<L: FrictionLaw> FrictionLaw for &L {
    fn static_coefficient(&self) -> f64 {
        (**self).static_coefficient()
    }
    #[inline(always)]
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        (**self).kinetic(speed)
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        (**self).breakpoints()
    }
    #[inline(always)]
    fn kinetic_on<S: Scalar>(&self, piece: usize, speed: S) -> S {
        (**self).kinetic_on(piece, speed)
    }
    #[inline(always)]
    fn give_to<V: LawVisitor>(&self, visitor: V) -> V::Output {
        (**self).give_to(visitor)
    }
    fn erased(&self) -> LawRef<'_> {
        (**self).erased()
    }
    fn any(&self, own: Own) -> Option<AnyLaw> {
        (**self).any(own)
    }
    fn constant(&self, own: Own) -> Option<f64> {
        (**self).constant(own)
    }
    // These forward to the law itself: the defaults would be compiled once more for the reference.
    fn coefficient(&self, relative_velocity: f64) -> f64 {
        (**self).coefficient(relative_velocity)
    }
    fn slope(&self, speed: f64) -> f64 {
        (**self).slope(speed)
    }
    fn curvature(&self, speed: f64) -> f64 {
        (**self).curvature(speed)
    }
    fn derivative(&self, n: usize, speed: f64) -> f64 {
        (**self).derivative(n, speed)
    }
}
