//! A number with its derivative along one direction, over any other number: over `f64` a slope,
//! over a Taylor number the power series of the slope along a motion.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::{Scalar, integral, root_beside_one, sealed};

/// A value and its tangent.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Dual<S> {
    pub(crate) value: S,
    pub(crate) tangent: Tangent<S>,
}

/// A derivative. One that is the same at all times is told apart, so that no operation is spent on
/// it. Which of the two it is depends on the function alone, never on values.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Tangent<S> {
    Constant(f64),
    Varying(S),
}

use Tangent::{Constant, Varying};

impl<S: Scalar> Dual<S> {
    /// An input that the direction has this constant component for.
    pub(crate) fn along(value: S, component: f64) -> Self {
        Self {
            value,
            tangent: Constant(component),
        }
    }

    /// The derivative of the number, as a number that may vary.
    pub(crate) fn derivative(self) -> S {
        match self.tangent {
            Constant(c) => self.value.constant(c),
            Varying(t) => t,
        }
    }

    /// A function of this number, with its value and its slope. The slope is not computed where the
    /// tangent is 0 for certain.
    #[inline(always)]
    fn with(self, value: S, slope: impl FnOnce() -> S) -> Self {
        let tangent = match self.tangent {
            Constant(0.0) => Constant(0.0),
            Constant(c) => Varying(slope() * c),
            Varying(t) => Varying(slope() * t),
        };
        Self { value, tangent }
    }
}

impl<S: Scalar> Tangent<S> {
    #[inline(always)]
    fn scaled(self, factor: f64) -> Self {
        match self {
            Constant(c) => Constant(c * factor),
            Varying(t) => Varying(t * factor),
        }
    }

    /// Multiplies the tangent by a number that varies.
    #[inline(always)]
    fn times(self, number: S) -> Self {
        match self {
            Constant(0.0) => self,
            Constant(c) => Varying(number * c),
            Varying(t) => Varying(t * number),
        }
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        match (self, other) {
            (Constant(a), Constant(b)) => Constant(a + b),
            (Constant(0.0), t) | (t, Constant(0.0)) => t,
            (Constant(c), Varying(t)) | (Varying(t), Constant(c)) => Varying(t + c),
            (Varying(a), Varying(b)) => Varying(a + b),
        }
    }
}

impl<S: sealed::Sealed> sealed::Sealed for Dual<S> {}

impl<S: Scalar> Scalar for Dual<S> {
    #[inline(always)]
    fn constant(self, c: f64) -> Self {
        Self::along(self.value.constant(c), 0.0)
    }
    #[inline(always)]
    fn value(self) -> f64 {
        self.value.value()
    }
    #[inline]
    fn recip(self) -> Self {
        let y = self.value.recip();
        self.with(y, || -y.square())
    }
    #[inline]
    fn square(self) -> Self {
        self.with(self.value.square(), || self.value * 2.0)
    }
    #[inline]
    fn exp(self) -> Self {
        let y = self.value.exp();
        self.with(y, || y)
    }
    #[inline]
    fn ln(self) -> Self {
        self.with(self.value.ln(), || self.value.recip())
    }
    #[inline]
    fn sqrt(self) -> Self {
        let y = self.value.sqrt();
        self.with(y, || y.recip() * 0.5)
    }
    #[inline]
    fn powi(self, exponent: i32) -> Self {
        let slope = || match exponent {
            0 => self.value.constant(0.0),
            // x^(i32::MIN − 1) does not exist.
            p => self.value.powi(p.saturating_sub(1)) * f64::from(p),
        };
        self.with(self.value.powi(exponent), slope)
    }
    #[inline]
    fn powf(self, exponent: f64) -> Self {
        if let Some(exponent) = integral(exponent) {
            return self.powi(exponent);
        }
        self.with(self.value.powf(exponent), || {
            self.value.powf(exponent - 1.0) * exponent
        })
    }
    #[inline]
    fn tanh(self) -> Self {
        let y = self.value.tanh();
        self.with(y, || -y.square() + 1.0)
    }
    #[inline]
    fn atan(self) -> Self {
        self.with(self.value.atan(), || (self.value.square() + 1.0).recip())
    }
    #[inline]
    fn asinh(self) -> Self {
        self.with(self.value.asinh(), || root_beside_one(self.value).recip())
    }
    #[inline]
    fn sin(self) -> Self {
        self.with(self.value.sin(), || self.value.cos())
    }
    #[inline]
    fn cos(self) -> Self {
        self.with(self.value.cos(), || -self.value.sin())
    }
    #[inline(always)]
    fn abs(self) -> Self {
        if self.value() < 0.0 { -self } else { self }
    }
}

impl<S: Scalar> Neg for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            tangent: self.tangent.scaled(-1.0),
        }
    }
}

impl<S: Scalar> Add for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            tangent: self.tangent.plus(other.tangent),
        }
    }
}

impl<S: Scalar> Sub for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<S: Scalar> Mul for Dual<S> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let (left, right) = (
            self.tangent.times(other.value),
            other.tangent.times(self.value),
        );
        Self {
            value: self.value * other.value,
            tangent: left.plus(right),
        }
    }
}

impl<S: Scalar> Div for Dual<S> {
    type Output = Self;
    /// q' = (a' − q b')/b.
    #[inline]
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        let numerator = self
            .tangent
            .plus(other.tangent.times(quotient).scaled(-1.0));
        let tangent = match numerator {
            Constant(0.0) => numerator,
            Constant(c) => Varying(other.value.recip() * c),
            Varying(t) => Varying(t / other.value),
        };
        Self {
            value: quotient,
            tangent,
        }
    }
}

impl<S: Scalar> Add<f64> for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn add(self, c: f64) -> Self {
        Self {
            value: self.value + c,
            ..self
        }
    }
}

impl<S: Scalar> Sub<f64> for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, c: f64) -> Self {
        self + -c
    }
}

impl<S: Scalar> Mul<f64> for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, c: f64) -> Self {
        Self {
            value: self.value * c,
            tangent: self.tangent.scaled(c),
        }
    }
}

impl<S: Scalar> Div<f64> for Dual<S> {
    type Output = Self;
    #[inline(always)]
    fn div(self, c: f64) -> Self {
        self * (1.0 / c)
    }
}
