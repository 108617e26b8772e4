//! The number types a friction law is evaluated on: `f64`, and two Taylor coefficients.
//!
//! | file | what is in it |
//! |---|---|
//! | `mod.rs` | [`Scalar`]: what a law may do with a number |
//! | `taylor.rs`, `operations.rs` | order in the type: the fastest, for one mass on its belt (the order itself: `series::TERMS`) |
//! | `jet.rs`, `products.rs` | order at run time: small code, many coupled series, cold paths |

pub(crate) mod jet;
mod operations;
mod products;
mod taylor;
#[cfg(test)]
mod tests;

pub(crate) use taylor::{LONGEST, Workspace, expand};

use std::ops::{Add, Div, Mul, Neg, Sub};

mod sealed {
    pub trait Sealed {}
}

/// A number that a friction law can be evaluated on.
///
/// `f64` and the crate's own Taylor coefficients implement it, and no other type can: the trait is
/// sealed. Write a law once with these operations and the crate gets its values, its
/// derivatives and its power series along a motion.
///
/// Arithmetic works with `Self` and with `f64` on the **right** (`speed * 3.0 + 1.0`); Rust does
/// not allow an `f64` on the left of a generic number, so write `speed.constant(1.0) / speed` or
/// `speed.recip()`.
///
/// # Rules for a law
///
/// * The sequence of operations may depend on the **base value** ([`value`](Self::value)) only, and
///   on nothing that changes from call to call. `if speed.value() > 5.0 { … } else { … }` is
///   allowed where both branches are the same function to rounding, as where one of them avoids an
///   overflow. Two functions that meet at a speed are pieces, and the speed is a
///   [breakpoint](crate::FrictionLaw::breakpoints).
/// * The law must be analytic at every speed it is used at, s = 0 included, or name its
///   [breakpoints](crate::FrictionLaw::breakpoints). [`sqrt`](Self::sqrt), [`ln`](Self::ln) and a
///   non-integral [`powf`](Self::powf) of a number that is 0 are not, and end in
///   [`Error::NotAnalytic`](crate::Error::NotAnalytic) or
///   [`Error::NonFiniteFriction`](crate::Error::NonFiniteFriction).
///
/// # Example
///
/// ```
/// use stick_slip::Scalar;
///
/// /// μ̂(s) = 0.2 + 0.1/(1 + 3s), with `f64` on the right only.
/// fn kinetic<S: Scalar>(speed: S) -> S {
///     (speed * 3.0 + 1.0).recip() * 0.1 + 0.2
/// }
/// assert_eq!(kinetic(0.0), 0.1 + 0.2);
/// assert_eq!(kinetic(3.0), 0.2 + 0.1 / 10.0);
/// ```
pub trait Scalar:
    sealed::Sealed
    + Copy
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// The constant c as a number of this type. `self` serves only to find the type.
    fn constant(self, c: f64) -> Self;
    /// The base value: the number itself for `f64`, the coefficient of order 0 of a series. Branch
    /// on this alone.
    ///
    /// A number stands for one motion, so that there is one base value. A law that asks for it is
    /// evaluated for one motion at a time, also where others could be evaluated for several at
    /// once.
    fn value(self) -> f64;
    /// 1/x.
    fn recip(self) -> Self;
    /// x².
    fn square(self) -> Self;
    /// eˣ.
    fn exp(self) -> Self;
    /// Natural logarithm ln x; analytic for x > 0.
    fn ln(self) -> Self;
    /// √x; analytic for x > 0.
    fn sqrt(self) -> Self;
    /// xⁿ by repeated products, so exact in its coefficients at x = 0 too.
    fn powi(self, exponent: i32) -> Self;
    /// xᵖ. An integral p is [`powi`](Self::powi); any other is analytic for x > 0.
    fn powf(self, exponent: f64) -> Self;
    /// tanh x.
    fn tanh(self) -> Self;
    /// arctan x.
    fn atan(self) -> Self;
    /// sin x.
    fn sin(self) -> Self;
    /// cos x.
    fn cos(self) -> Self;
    /// |x|, by the sign of the base value; at 0 the branch of positive x.
    ///
    /// A kink at a speed c > 0, as in `(speed - c).abs()`, must be named as a
    /// [breakpoint](crate::FrictionLaw::breakpoints).
    fn abs(self) -> Self;
}

/// A function of one number, written once for every type of number: what a series is composed
/// with.
pub(crate) trait Function: Copy {
    /// Its value at x.
    fn at<S: Scalar>(self, x: S) -> S;
}

impl sealed::Sealed for f64 {}

impl Scalar for f64 {
    #[inline]
    fn constant(self, c: f64) -> Self {
        c
    }
    #[inline]
    fn value(self) -> f64 {
        self
    }
    #[inline]
    fn recip(self) -> Self {
        self.recip()
    }
    #[inline]
    fn square(self) -> Self {
        self * self
    }
    #[inline]
    fn exp(self) -> Self {
        self.exp()
    }
    #[inline]
    fn ln(self) -> Self {
        self.ln()
    }
    #[inline]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline]
    fn powi(self, exponent: i32) -> Self {
        self.powi(exponent)
    }
    #[inline]
    fn powf(self, exponent: f64) -> Self {
        self.powf(exponent)
    }
    #[inline]
    fn tanh(self) -> Self {
        self.tanh()
    }
    #[inline]
    fn atan(self) -> Self {
        self.atan()
    }
    #[inline]
    fn sin(self) -> Self {
        self.sin()
    }
    #[inline]
    fn cos(self) -> Self {
        self.cos()
    }
    #[inline]
    fn abs(self) -> Self {
        self.abs()
    }
}

/// a·b + c, fused only where the target has the instruction: elsewhere `f64::mul_add` is a slow
/// library call.
#[inline(always)]
pub(crate) fn mul_add(a: f64, b: f64, c: f64) -> f64 {
    if cfg!(target_feature = "fma") {
        a.mul_add(b, c)
    } else {
        a * b + c
    }
}
