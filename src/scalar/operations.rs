//! The operations of the Taylor coefficient: a recurrence for each.
//!
//! Each gives, in run 0, the value and the slope of its result, and in run K ≥ 1 the rest of its
//! K-th coefficient.

use std::ops::{Add, Div, Mul};

use super::fused::mul_add;
use super::taylor::{Taylor, inner_product, inner_square};
use super::view::view_operators;
use super::{Scalar, integral, power_by_squaring, root_beside_one, sealed};

impl<const K: usize, const M: usize> sealed::Sealed for Taylor<'_, K, M> {}

impl<const K: usize, const M: usize> Scalar for Taylor<'_, K, M> {
    #[inline(always)]
    fn constant(self, c: f64) -> Self {
        Self {
            scale: 0.0,
            value: c,
            slope: 0.0,
            rest: 0.0,
            ..self
        }
    }

    #[inline(always)]
    fn value(self) -> f64 {
        self.value
    }

    /// q·b = 1.
    #[inline(always)]
    fn recip(self) -> Self {
        let (b, q) = (self, self.run.claim());
        self.operation(
            q,
            || (b.value.recip(), -b.derivative() / (b.value * b.value)),
            || {
                let factor = -q.c[0].get() * b.scale;
                let older = inner_product::<K, M>(q, b.row, factor, 0.0);
                mul_add(factor * q.c[0].get(), b.rest, older)
            },
        )
    }

    #[inline(always)]
    fn square(self) -> Self {
        let a = self;
        self.operation(
            self.run.claim(),
            || (a.value * a.value, 2.0 * a.value * a.derivative()),
            || {
                let older = 2.0 * a.value * a.scale * a.rest;
                inner_square::<K, M>(a.row, a.scale * a.scale, older)
            },
        )
    }

    /// y' = y·a'.
    #[inline(always)]
    fn exp(self) -> Self {
        let (a, weighted, y) = (self, self.weighted(), self.run.claim());
        self.operation(
            y,
            || (a.value.exp(), a.value.exp() * a.derivative()),
            || {
                let older = inner_product::<K, M>(weighted, y, Self::INVERSE, 0.0);
                mul_add(y.c[0].get() * a.scale, a.rest, older)
            },
        )
    }

    /// a·y' = a'.
    #[inline(always)]
    fn ln(self) -> Self {
        let (a, y, weighted) = (self, self.run.claim(), self.run.claim());
        let y = self.operation(
            y,
            || (a.value.ln(), a.derivative() / a.value),
            || {
                let factor = a.scale / a.value;
                let older = inner_product::<K, M>(weighted, a.row, -Self::INVERSE * factor, 0.0);
                mul_add(factor, a.rest, older)
            },
        );
        if K > 0 {
            weighted.c[K].set(K as f64 * y.newest());
        }
        y
    }

    /// y·y = a.
    #[inline(always)]
    fn sqrt(self) -> Self {
        let (a, y) = (self, self.run.claim());
        self.operation(
            y,
            || (a.value.sqrt(), a.derivative() / (2.0 * a.value.sqrt())),
            || {
                let factor = 0.5 / y.c[0].get();
                inner_square::<K, M>(y, -factor, factor * a.scale * a.rest)
            },
        )
    }

    #[inline(always)]
    fn powi(self, exponent: i32) -> Self {
        power_by_squaring(self, exponent)
    }

    /// a·y' = p·y·a'.
    #[inline(always)]
    fn powf(self, exponent: f64) -> Self {
        if let Some(exponent) = integral(exponent) {
            return self.powi(exponent);
        }
        let p = exponent;
        let (a, weighted, y) = (self, self.weighted(), self.run.claim());
        self.operation(
            y,
            || {
                let value = a.value.powf(p);
                (value, p * value / a.value * a.derivative())
            },
            || {
                let by_weight = (p + 1.0) * Self::INVERSE / a.value;
                let by_value = -a.scale / a.value;
                let older = inner_product::<K, M>(weighted, y, by_weight, 0.0);
                let older = inner_product::<K, M>(a.row, y, by_value, older);
                mul_add(-p * y.c[0].get() * by_value, a.rest, older)
            },
        )
    }

    /// y' = g·a', g = 1 − y².
    #[inline(always)]
    fn tanh(self) -> Self {
        let (a, weighted, y, g) = (self, self.weighted(), self.run.claim(), self.run.claim());
        let y = self.operation(
            y,
            || {
                let derivative = a.value.cosh().powi(-2);
                g.c[0].set(derivative);
                (a.value.tanh(), derivative * a.derivative())
            },
            || {
                let older = inner_product::<K, M>(weighted, g, Self::INVERSE, 0.0);
                mul_add(g.c[0].get() * a.scale, a.rest, older)
            },
        );
        if K > 0 {
            let square = inner_square::<K, M>(y.row, 1.0, 2.0 * y.value * y.newest());
            g.c[K].set(-square);
        }
        y
    }

    /// b·y' = a', b = 1 + a².
    #[inline(always)]
    fn atan(self) -> Self {
        self.divided_integral(self.square() + 1.0, f64::atan)
    }

    /// b·y' = a', b = √(1 + a²).
    #[inline(always)]
    fn asinh(self) -> Self {
        self.divided_integral(root_beside_one(self), f64::asinh)
    }

    #[inline(always)]
    fn sin(self) -> Self {
        self.sin_cos().0
    }

    #[inline(always)]
    fn cos(self) -> Self {
        self.sin_cos().1
    }

    #[inline(always)]
    fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }
}

impl<const K: usize, const M: usize> Taylor<'_, K, M> {
    /// b·y' = a', where y is a function of a.
    #[inline(always)]
    fn divided_integral(self, b: Self, function: impl Fn(f64) -> f64) -> Self {
        let a = self;
        let (y, weighted) = (self.run.claim(), self.run.claim());
        let y = self.operation(
            y,
            || (function(a.value), a.derivative() / b.value),
            || {
                let factor = -Self::INVERSE * b.scale / b.value;
                let older = inner_product::<K, M>(weighted, b.row, factor, 0.0);
                mul_add(a.scale / b.value, a.rest, older)
            },
        );
        if K > 0 {
            weighted.c[K].set(K as f64 * y.newest());
        }
        y
    }

    /// S' = C·a', C' = −S·a'.
    #[inline(always)]
    fn sin_cos(self) -> (Self, Self) {
        let (a, weighted, s, c) = (self, self.weighted(), self.run.claim(), self.run.claim());
        let base = || a.value.sin_cos();
        (
            self.operation(
                s,
                || (base().0, base().1 * a.derivative()),
                || {
                    let older = inner_product::<K, M>(weighted, c, Self::INVERSE, 0.0);
                    mul_add(c.c[0].get() * a.scale, a.rest, older)
                },
            ),
            self.operation(
                c,
                || (base().1, -base().0 * a.derivative()),
                || {
                    let older = inner_product::<K, M>(weighted, s, -Self::INVERSE, 0.0);
                    mul_add(-s.c[0].get() * a.scale, a.rest, older)
                },
            ),
        )
    }
}

impl<const K: usize, const M: usize> Add for Taylor<'_, K, M> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (a, b) = (self, other);
        self.operation(
            self.run.claim(),
            || (a.value + b.value, a.derivative() + b.derivative()),
            || mul_add(a.scale, a.rest, b.scale * b.rest),
        )
    }
}

impl<const K: usize, const M: usize> Mul for Taylor<'_, K, M> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self, other);
        self.operation(
            self.run.claim(),
            || {
                let slope = a.value * b.derivative() + b.value * a.derivative();
                (a.value * b.value, slope)
            },
            || {
                let start = a.value * b.scale * b.rest;
                let older = inner_product::<K, M>(a.row, b.row, a.scale * b.scale, start);
                mul_add(b.value * a.scale, a.rest, older)
            },
        )
    }
}

impl<const K: usize, const M: usize> Div for Taylor<'_, K, M> {
    type Output = Self;
    /// q·b = a.
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let (a, b, q) = (self, other, self.run.claim());
        self.operation(
            q,
            || {
                let value = a.value / b.value;
                (value, (a.derivative() - value * b.derivative()) / b.value)
            },
            || {
                let factor = -b.scale / b.value;
                let start = a.scale / b.value * a.rest;
                let older = inner_product::<K, M>(q, b.row, factor, start);
                mul_add(factor * q.c[0].get(), b.rest, older)
            },
        )
    }
}

view_operators!(['r, const K: usize, const M: usize] Taylor<'r, K, M>);
