//! The number types on which a friction law is evaluated: `f64`, two kinds of Taylor coefficients,
//! whole power series, and any of these with a derivative.

// | file | what is in it |
// |---|---|
// | `mod.rs` | `Scalar`: what a law may do with a number |
// | `taylor.rs`, `operations.rs` | Taylor coefficients whose order is part of the type: the fastest, for one mass on its belt (the order itself: `series::TERMS`) |
// | `view.rs` | operators that both kinds of Taylor coefficients have alike |
// | `fused.rs` | with which instructions they are computed, where that is chosen at run time |
// | `dual.rs` | any of the numbers with its derivative along one direction |
// | `recorded.rs`, `lanes.rs` | notes of what a law does with a number, and the Taylor coefficients of four laws side by side by these notes: code that knows no law, for many masses |
// | `../series/number.rs` | a whole power series as a number, where all inputs are known beforehand |
// | `jet.rs`, `jet/operations.rs`, `products.rs` | Taylor coefficients whose order is chosen at run time: small code, for many coupled series and for cold paths |

pub(crate) mod dual;
pub(crate) mod fused;
pub(crate) mod jet;
pub(crate) mod lanes;
mod operations;
mod products;
pub(crate) mod recorded;
mod taylor;
#[cfg(test)]
mod tests;
mod view;

pub(crate) use taylor::{Composed, LONGEST, Workspace, expand};

use std::ops::{Add, Div, Mul, Neg, Sub};

/// The number of rows of a series' workspace that are kept in place. Laws seldom need more, and a
/// constant index into an array costs no bounds check.
const INLINE_ROWS: usize = 8;

pub(crate) mod sealed {
    pub trait Sealed {}
}

/// A number type with which a friction law can be evaluated.
///
/// Write a law once with the operations of this trait. The crate then computes from it the law's
/// values, its derivatives and its power series along a motion. `f64` and the crate's own Taylor
/// coefficients implement the trait. The trait is sealed: no other type can implement it.
///
/// The other operand of `+`, `-`, `*` and `/` is a number of the same type, or an `f64` on the
/// **right**, as in `speed * 3.0 + 1.0`. Rust does not allow an `f64` on the left of a generic
/// number s = `speed`, so write `speed.recip()` or `speed.constant(1.0) / speed` for 1/s, and
/// `speed * 0.1` for 0.1·s. With an `f64` on the left the compiler says "cannot multiply `{float}`
/// by `S`":
///
/// ```compile_fail,E0277
/// # use stick_slip::Scalar;
/// fn kinetic<S: Scalar>(speed: S) -> S {
///     0.1 * speed
/// }
/// ```
///
/// # Rules for a law
///
/// * **Branches.** The **base value** ([`value`](Self::value)) of a number is the number itself for
///   an `f64`, and the constant term of a power series. The same base value must always give the
///   same sequence of operations: a branch may depend on the base value, but not on anything that
///   changes from call to call, such as a counter or a random number. For example,
///   `if speed.value() > 5.0 { … } else { … }` is allowed if both branches compute the same
///   function up to rounding, for example if one of them avoids an overflow. If two different
///   functions meet at a speed, they are pieces of the law, and this speed has to be returned as a
///   [breakpoint](crate::FrictionLaw::breakpoints).
/// * **Smoothness.** The law must be analytic (it has a power series) at every speed that a motion
///   reaches, s = 0 included, except at its [breakpoints](crate::FrictionLaw::breakpoints).
///   [`sqrt`](Self::sqrt), [`ln`](Self::ln) and a non-integral [`powf`](Self::powf) are not
///   analytic if their argument is 0. Their use at such a speed ends in
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
#[diagnostic::on_unimplemented(
    message = "a friction law cannot be evaluated on `{Self}`",
    note = "give the speed as an `f64`, as in `law.kinetic(0.5)`"
)]
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
    /// The constant c as a number of this type. Only the type of `self` is used, not its value.
    fn constant(self, c: f64) -> Self;
    /// The base value: for an `f64` the number itself, for a series the coefficient of order 0.
    ///
    /// A law may branch on the base value, and on nothing else. A law that calls `value` is
    /// evaluated for one motion at a time; laws that do not call it may be evaluated for several
    /// motions at once.
    fn value(self) -> f64;
    /// The reciprocal 1/x.
    fn recip(self) -> Self;
    /// The square x².
    fn square(self) -> Self;
    /// The exponential eˣ.
    fn exp(self) -> Self;
    /// The natural logarithm ln x; analytic for x > 0.
    fn ln(self) -> Self;
    /// The square root √x; analytic for x > 0.
    fn sqrt(self) -> Self;
    /// The power xⁿ for an integer n, by repeated products. Its power series is also exact at x
    /// = 0.
    fn powi(self, exponent: i32) -> Self;
    /// The power xᵖ. For an integer p the result is that of [`powi`](Self::powi). Any other power
    /// is analytic for x > 0.
    fn powf(self, exponent: f64) -> Self;
    /// The hyperbolic tangent tanh x.
    fn tanh(self) -> Self;
    /// The arctangent arctan x.
    fn atan(self) -> Self;
    /// The inverse hyperbolic sine arsinh x = ln(x + √(x² + 1)).
    fn asinh(self) -> Self;
    /// The sine sin x.
    fn sin(self) -> Self;
    /// The cosine cos x.
    fn cos(self) -> Self;
    /// The absolute value |x|, by the sign of the base value. If the base value is 0, the result is
    /// x.
    ///
    /// A kink at a speed c > 0, as in `(speed - c).abs()`, must be returned as a
    /// [breakpoint](crate::FrictionLaw::breakpoints).
    fn abs(self) -> Self;
}

/// A function of one number, written once for every type of number. Series are composed with it.
pub(crate) trait Function: Copy {
    /// The value of the function at x.
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
    fn asinh(self) -> Self {
        self.asinh()
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

/// True if every processor of the target has an instruction for the fused multiply-add. For others
/// `f64::mul_add` is a slow library call.
const FUSED: bool = cfg!(any(target_feature = "fma", target_arch = "aarch64"));

/// The sum a·b + c, fused only if the target has the instruction for it.
#[inline(always)]
pub(crate) fn mul_add(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// 1/k, by which the recurrences of y' = f(y)·a' divide; 0 for k = 0.
pub(crate) const INVERSE: [f64; LONGEST] = {
    let mut inverse = [0.0; LONGEST];
    let mut k = 1;
    while k < LONGEST {
        inverse[k] = 1.0 / k as f64;
        k += 1;
    }
    inverse
};

/// √(x² + 1), by which the derivative of x is divided in that of arsinh x. It is |x| where x² might
/// overflow.
#[inline(always)]
pub(crate) fn root_beside_one<S: Scalar>(x: S) -> S {
    /// 1/(2x²) is a quarter of the rounding error of 1.
    const LARGE: f64 = (1_u64 << 28) as f64;
    if x.value().abs() < LARGE {
        (x.square() + 1.0).sqrt()
    } else {
        x.abs()
    }
}

/// xⁿ by squaring: every step is an operation with a recurrence of its own.
#[inline(always)]
pub(crate) fn power_by_squaring<S: Scalar>(x: S, exponent: i32) -> S {
    // Not the other way round: the recurrence of the reciprocal of a high power loses digits.
    let base = if exponent < 0 { x.recip() } else { x };
    let exponent = exponent.unsigned_abs();
    let Some(top) = exponent.checked_ilog2() else {
        return x.constant(1.0);
    };
    let mut power = base;
    for bit in (0..top).rev() {
        power = power.square();
        if exponent >> bit & 1 == 1 {
            power = power * base;
        }
    }
    power
}

/// The exponent as an integer, if it is one for which xᵖ is a product.
#[inline(always)]
pub(crate) fn integral(exponent: f64) -> Option<i32> {
    let is_integral = exponent.fract() == 0.0 && exponent.abs() <= f64::from(i32::MAX);
    is_integral.then_some(exponent as i32)
}
