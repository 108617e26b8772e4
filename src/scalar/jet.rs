//! A Taylor number whose order is a run-time value, for cold paths and for series of many coupled
//! quantities.
//!
//! The recurrences are those of `operations.rs`: one copy of a law serves every order. A function
//! is run once for every order k; run k computes the coefficients of t^k alone, from the rows that
//! the runs before left on the [`Tape`]. So equations that are coupled can be advanced one order at
//! a time, each with a tape of its own.
//!
//! As there, a coefficient is slope·s_k + rest, s_k that of the one input which comes last, the
//! [variable](Run::variable): from one order to the next the critical path is then as short as it
//! can be. Other inputs enter by their rests.
//!
//! ```text
//! for k in 0..n {
//!     let m_k = tape.run(k, |run| law(run.variable(s_k)).coefficient());
//!     let s_{k+1} = …;                                      // from s_k, m_k and whatever else
//! }
//! ```
//!
//! [`coefficients`] and [`Tape::compose`] are that loop where the inner series is known.

use std::cell::Cell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::products::{Row, inner_product, inner_square};
use super::{Function, INLINE_ROWS, LONGEST, Scalar, mul_add, sealed};

/// What one operation has computed so far: its slope at order 0, and its coefficients.
#[derive(Debug, Clone)]
struct Line {
    slope: Cell<f64>,
    c: Row,
}

impl Line {
    fn zero() -> Self {
        Self {
            slope: Cell::new(0.0),
            c: std::array::from_fn(|_| Cell::new(0.0)),
        }
    }
}

/// 1/k, by which the recurrences of y' = f(y)·a' divide.
const INVERSE: [f64; LONGEST] = {
    let mut inverse = [0.0; LONGEST];
    let mut k = 1;
    while k < LONGEST {
        inverse[k] = 1.0 / k as f64;
        k += 1;
    }
    inverse
};

/// What the operations of a function have computed so far: one row each, in their sequence.
#[derive(Debug, Clone)]
pub(crate) struct Tape {
    inline: [Line; INLINE_ROWS],
    /// More rows for longer functions. Grown in the first run, never after.
    spill: Vec<Line>,
    /// The row of every constant; and where operations write that find no row yet. A run that
    /// needed it is repeated with enough rows.
    zero: Line,
    scratch: Line,
}

/// One run of a function: all coefficients of one order.
#[derive(Debug)]
pub(crate) struct Run<'t> {
    tape: &'t Tape,
    next: Cell<usize>,
    order: usize,
    /// s_k of the variable.
    newest: Cell<f64>,
}

/// Coefficient of t^k of a power series, k the order of its run.
///
/// A *view* of a row: c_k = scale·row_k for k ≥ 1, so that adding, scaling and negating by
/// constants need no row of their own.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Jet<'r> {
    run: &'r Run<'r>,
    row: &'r Line,
    scale: f64,
    /// Coefficient of order 0, of the view.
    value: f64,
    /// Derivative of the **row** with respect to the variable at the base point.
    slope: f64,
    /// row_k − slope·s_k; meaningless for k = 0.
    rest: f64,
}

impl Tape {
    pub(crate) fn new() -> Self {
        Self {
            inline: std::array::from_fn(|_| Line::zero()),
            spill: Vec::new(),
            zero: Line::zero(),
            scratch: Line::zero(),
        }
    }

    /// Run number `order` < [`LONGEST`] of a function, which makes its inputs with [`Run::input`],
    /// the same ones in the same sequence every time. Runs 0 to `order` − 1 come before.
    #[inline(always)]
    pub(crate) fn run<R>(&mut self, order: usize, mut function: impl FnMut(&Run<'_>) -> R) -> R {
        loop {
            let run = Run {
                tape: self,
                next: Cell::new(0),
                order,
                newest: Cell::new(0.0),
            };
            let result = function(&run);
            let rows = run.next.get();
            if order > 0 || rows <= INLINE_ROWS + self.spill.len() {
                return result;
            }
            self.spill.resize_with(rows - INLINE_ROWS, Line::zero);
        }
    }

    /// The coefficients of f(s(t)) from those of s(t), as many as both slices hold, at most
    /// [`LONGEST`].
    pub(crate) fn compose(&mut self, function: impl Function, inner: &[f64], outer: &mut [f64]) {
        for (k, (s, f)) in std::iter::zip(inner, outer).take(LONGEST).enumerate() {
            *f = self.run(k, |run| function.at(run.variable(*s)).coefficient());
        }
    }
}

/// The coefficients of f about x: f(x + t) = Σ f_k t^k, M ≤ [`LONGEST`] of them.
pub(crate) fn coefficients<const M: usize>(function: impl Function, x: f64) -> [f64; M] {
    let mut inner = [0.0; M];
    for (s, start) in std::iter::zip(&mut inner, [x, 1.0]) {
        *s = start;
    }
    let mut outer = [f64::NAN; M];
    Tape::new().compose(function, &inner, &mut outer);
    outer
}

impl Run<'_> {
    /// The variable, by its coefficient of this run's order: one input at most, before all
    /// operations.
    #[inline(always)]
    pub(crate) fn variable(&self, coefficient: f64) -> Jet<'_> {
        self.newest.set(coefficient);
        self.line(coefficient, 1.0, 0.0)
    }

    /// Another input.
    #[inline(always)]
    pub(crate) fn input(&self, coefficient: f64) -> Jet<'_> {
        self.line(coefficient, 0.0, coefficient)
    }

    #[inline(always)]
    fn line(&self, coefficient: f64, slope: f64, rest: f64) -> Jet<'_> {
        let row = self.claim();
        self.set(row, coefficient);
        Jet {
            run: self,
            row,
            scale: 1.0,
            value: row.c[0].get(),
            slope,
            rest,
        }
    }

    #[inline(always)]
    fn claim(&self) -> &Line {
        let index = self.next.get();
        self.next.set(index + 1);
        let Tape {
            inline,
            spill,
            scratch,
            ..
        } = self.tape;
        if index < INLINE_ROWS {
            &inline[index]
        } else {
            spill.get(index - INLINE_ROWS).unwrap_or(scratch)
        }
    }

    #[inline(always)]
    fn set(&self, row: &Line, coefficient: f64) {
        // Orders are below LONGEST, a power of two: see `Tape::run`.
        row.c[self.order % LONGEST].set(coefficient);
    }
}

impl<'r> Jet<'r> {
    /// The coefficient itself.
    #[inline(always)]
    pub(crate) fn coefficient(self) -> f64 {
        if self.order() == 0 {
            self.value
        } else {
            self.newest()
        }
    }

    #[inline(always)]
    fn order(self) -> usize {
        self.run.order
    }

    /// The coefficient of order k ≥ 1.
    #[inline(always)]
    fn newest(self) -> f64 {
        self.scale * mul_add(self.slope, self.run.newest.get(), self.rest)
    }

    /// Derivative of the view with respect to the variable, at the base point.
    #[inline(always)]
    pub(crate) fn derivative(self) -> f64 {
        self.scale * self.slope
    }

    /// The result of an operation: in run 0 its value and slope, in every later run its rest, which
    /// may read the row that the operation wrote before.
    #[inline(always)]
    fn operation(
        self,
        row: &'r Line,
        base: impl FnOnce() -> (f64, f64),
        rest: impl FnOnce(usize) -> f64,
    ) -> Self {
        let (value, slope, rest) = match self.order() {
            0 => {
                let (value, slope) = base();
                row.slope.set(slope);
                row.c[0].set(value);
                (value, slope, 0.0)
            }
            k => {
                let (slope, rest) = (row.slope.get(), rest(k));
                self.run
                    .set(row, mul_add(slope, self.run.newest.get(), rest));
                (row.c[0].get(), slope, rest)
            }
        };
        Self {
            run: self.run,
            row,
            scale: 1.0,
            value,
            slope,
            rest,
        }
    }

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
            self.run.set(row, self.order() as f64 * self.newest());
        }
    }

    /// aⁿ, by squaring.
    #[inline]
    fn power(self, exponent: u32) -> Self {
        let Some(top) = exponent.checked_ilog2() else {
            return self.constant(1.0);
        };
        let mut power = self;
        for bit in (0..top).rev() {
            power = power.square();
            if exponent >> bit & 1 == 1 {
                power = power * self;
            }
        }
        power
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
        if exponent < 0 {
            // Not the other way round: the recurrence of the reciprocal of a high power loses
            // digits.
            return self.recip().power(exponent.unsigned_abs());
        }
        self.power(exponent.unsigned_abs())
    }

    /// a·y' = p·y·a'.
    #[inline]
    fn powf(self, exponent: f64) -> Self {
        let p = exponent;
        if p.fract() == 0.0 && p.abs() <= f64::from(i32::MAX) {
            return self.powi(p as i32);
        }
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
        let (a, b) = (self, self.square() + 1.0);
        let (y, weighted) = (self.run.claim(), self.run.claim());
        let y = self.operation(
            y,
            || (a.value.atan(), a.derivative() / b.value),
            |k| {
                let older = inner_product(k, &weighted.c, &b.row.c) * INVERSE[k];
                (a.scale * a.rest - older) / b.value
            },
        );
        y.write_weighted(weighted);
        y
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

impl Neg for Jet<'_> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self * -1.0
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

impl Sub for Jet<'_> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
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

impl Add<f64> for Jet<'_> {
    type Output = Self;
    #[inline(always)]
    fn add(self, c: f64) -> Self {
        Self {
            value: self.value + c,
            ..self
        }
    }
}

impl Sub<f64> for Jet<'_> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, c: f64) -> Self {
        self + -c
    }
}

impl Mul<f64> for Jet<'_> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, c: f64) -> Self {
        Self {
            scale: self.scale * c,
            value: self.value * c,
            ..self
        }
    }
}

impl Div<f64> for Jet<'_> {
    type Output = Self;
    #[inline(always)]
    fn div(self, c: f64) -> Self {
        Self {
            scale: self.scale / c,
            value: self.value / c,
            ..self
        }
    }
}
