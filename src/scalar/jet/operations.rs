//! The operations of a Taylor number whose order is a run-time value: the recurrences of
//! `scalar/operations.rs`, one order in each run.

use std::ops::{Add, Div, Mul};

use super::{Jet, Line};
use crate::scalar::products::{inner_product, inner_square};
use crate::scalar::view::view_operators;
use crate::scalar::{
    INVERSE, LONGEST, Scalar, integral, mul_add, power_by_squaring, root_beside_one, sealed,
};

/// k, which is quicker to look up than to convert.
const ORDER: [f64; LONGEST] = {
    let mut order = [0.0; LONGEST];
    let mut k = 0;
    while k < LONGEST {
        order[k] = k as f64;
        k += 1;
    }
    order
};

impl<'r> Jet<'r> {
    /// A row of k·c_k, the coefficients that the recurrences of y' = f(y)·a' multiply with.
    #[inline(always)]
    fn weighted(self) -> &'r Line {
        let row = self.run.claim();
        self.write_weighted(row);
        row
    }

    #[inline(always)]
    fn write_weighted(self, row: &Line) {
        if self.order() > 0 {
            self.run
                .set(row, ORDER[self.order() % LONGEST] * self.newest());
        }
    }

    /// b·y' = a', where y is a function of a.
    #[inline(always)]
    fn divided_integral(self, b: Self, function: impl Fn(f64) -> f64) -> Self {
        let a = self;
        let (y, weighted) = (self.run.claim(), self.run.claim());
        let y = self.operation(
            y,
            || (function(a.value), a.derivative() / b.value),
            |k| {
                let older = inner_product(k, &weighted.c, &b.row.c) * INVERSE[k];
                (a.scale * a.rest - b.scale * older) / b.value
            },
        );
        y.write_weighted(weighted);
        y
    }

    /// S' = C·a', C' = −S·a'.
    #[inline]
    fn sin_cos(self) -> (Self, Self) {
        let (a, weighted, s, c) = (self, self.weighted(), self.run.claim(), self.run.claim());
        let base = || a.value.sin_cos();
        let sine = self.operation(
            s,
            || (base().0, base().1 * a.derivative()),
            |k| {
                let older = inner_product(k, &weighted.c, &c.c) * INVERSE[k];
                mul_add(c.c[0].get() * a.scale, a.rest, older)
            },
        );
        let cosine = self.operation(
            c,
            || (base().1, -base().0 * a.derivative()),
            |k| {
                let older = inner_product(k, &weighted.c, &s.c) * INVERSE[k];
                -mul_add(s.c[0].get() * a.scale, a.rest, older)
            },
        );
        (sine, cosine)
    }
}

impl sealed::Sealed for Jet<'_> {}

impl Scalar for Jet<'_> {
    #[inline(always)]
    fn constant(self, c: f64) -> Self {
        Self {
            row: &self.run.tape.zero,
            scale: 1.0,
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
    #[inline]
    fn recip(self) -> Self {
        let (b, q) = (self, self.run.claim());
        self.operation(
            q,
            || (b.value.recip(), -b.derivative() / (b.value * b.value)),
            |k| {
                let factor = -q.c[0].get() * b.scale;
                let older = inner_product(k, &q.c, &b.row.c) * factor;
                mul_add(factor * q.c[0].get(), b.rest, older)
            },
        )
    }

    #[inline]
    fn square(self) -> Self {
        let a = self;
        self.operation(
            self.run.claim(),
            || (a.value * a.value, 2.0 * a.value * a.derivative()),
            |k| {
                let older = inner_square(k, &a.row.c) * (a.scale * a.scale);
                mul_add(2.0 * a.value * a.scale, a.rest, older)
            },
        )
    }

    /// y' = y·a'.
    #[inline]
    fn exp(self) -> Self {
        let (a, weighted, y) = (self, self.weighted(), self.run.claim());
        self.operation(
            y,
            || (a.value.exp(), a.value.exp() * a.derivative()),
            |k| {
                let older = inner_product(k, &weighted.c, &y.c) * INVERSE[k];
                mul_add(y.c[0].get() * a.scale, a.rest, older)
            },
        )
    }

    /// a·y' = a'.
    #[inline]
    fn ln(self) -> Self {
        let (a, y, weighted) = (self, self.run.claim(), self.run.claim());
        let y = self.operation(
            y,
            || (a.value.ln(), a.derivative() / a.value),
            |k| {
                let older = inner_product(k, &weighted.c, &a.row.c) * INVERSE[k];
                a.scale / a.value * (a.rest - older)
            },
        );
        y.write_weighted(weighted);
        y
    }

    /// y·y = a.
    #[inline]
    fn sqrt(self) -> Self {
        let (a, y) = (self, self.run.claim());
        self.operation(
            y,
            || (a.value.sqrt(), a.derivative() / (2.0 * a.value.sqrt())),
            |k| 0.5 / y.c[0].get() * (a.scale * a.rest - inner_square(k, &y.c)),
        )
    }

    #[inline]
    fn powi(self, exponent: i32) -> Self {
        power_by_squaring(self, exponent)
    }

    /// a·y' = p·y·a'.
    #[inline]
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
            |k| {
                let by_weight = inner_product(k, &weighted.c, &y.c) * ((p + 1.0) * INVERSE[k]);
                let by_value = inner_product(k, &a.row.c, &y.c) * a.scale;
                let newest = p * y.c[0].get() * a.scale;
                mul_add(newest, a.rest, by_weight - by_value) / a.value
            },
        )
    }

    /// y' = g·a', g = 1 − y².
    #[inline]
    fn tanh(self) -> Self {
        let (a, weighted, y, g) = (self, self.weighted(), self.run.claim(), self.run.claim());
        let y = self.operation(
            y,
            || {
                let derivative = a.value.cosh().powi(-2);
                g.c[0].set(derivative);
                (a.value.tanh(), derivative * a.derivative())
            },
            |k| {
                let older = inner_product(k, &weighted.c, &g.c) * INVERSE[k];
                mul_add(g.c[0].get() * a.scale, a.rest, older)
            },
        );
        if self.order() > 0 {
            let square = inner_square(self.order(), &y.row.c);
            self.run.set(g, -mul_add(2.0 * y.value, y.newest(), square));
        }
        y
    }

    /// b·y' = a', b = 1 + a².
    #[inline]
    fn atan(self) -> Self {
        self.divided_integral(self.square() + 1.0, f64::atan)
    }

    /// b·y' = a', b = √(1 + a²).
    #[inline]
    fn asinh(self) -> Self {
        self.divided_integral(root_beside_one(self), f64::asinh)
    }

    #[inline]
    fn sin(self) -> Self {
        self.sin_cos().0
    }

    #[inline]
    fn cos(self) -> Self {
        self.sin_cos().1
    }

    #[inline(always)]
    fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }
}

impl Add for Jet<'_> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let (a, b) = (self, other);
        self.operation(
            self.run.claim(),
            || (a.value + b.value, a.derivative() + b.derivative()),
            |_| mul_add(a.scale, a.rest, b.scale * b.rest),
        )
    }
}

impl Mul for Jet<'_> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self, other);
        self.operation(
            self.run.claim(),
            || {
                let slope = a.value * b.derivative() + b.value * a.derivative();
                (a.value * b.value, slope)
            },
            |k| {
                let older = inner_product(k, &a.row.c, &b.row.c) * (a.scale * b.scale);
                let older = mul_add(a.value * b.scale, b.rest, older);
                mul_add(b.value * a.scale, a.rest, older)
            },
        )
    }
}

impl Div for Jet<'_> {
    type Output = Self;
    /// q·b = a.
    #[inline]
    fn div(self, other: Self) -> Self {
        let (a, b, q) = (self, other, self.run.claim());
        self.operation(
            q,
            || {
                let value = a.value / b.value;
                (value, (a.derivative() - value * b.derivative()) / b.value)
            },
            |k| {
                let older = inner_product(k, &q.c, &b.row.c);
                let known = mul_add(q.c[0].get(), b.rest, older) * b.scale;
                mul_add(a.scale, a.rest, -known) / b.value
            },
        )
    }
}

view_operators!(['r] Jet<'r>);
