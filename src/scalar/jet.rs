//! A Taylor number whose order is a run-time value, for cold paths and for series of many coupled
//! quantities.
//!
//! The recurrences are those of `operations.rs`, with loops in place of unrolled orders: one copy
//! of a law serves every order. A function is run once for every order k; run k computes the
//! coefficients of t^k alone, from the rows that the runs before left on the [`Tape`]. So equations
//! that are coupled can be advanced one order at a time, each with a tape of its own.
//!
//! ```text
//! for k in 0..n {
//!     let m_k = tape.run(k, |run| law(run.input(s_k)).coefficient());
//!     let s_{k+1} = …;                                      // from s_k, m_k and whatever else
//! }
//! ```
//!
//! [`coefficients`] and [`Tape::compose`] are that loop where the inner series is known.

use std::cell::Cell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::products::{Row, inner_product, inner_square};
use super::{Function, LONGEST, Scalar, mul_add, sealed};

fn zero() -> Row {
    std::array::from_fn(|_| Cell::new(0.0))
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
    /// Grown in the first run, never after.
    rows: Vec<Row>,
    /// The row of every constant; and where operations write that find no row yet. A run that
    /// needed it is repeated with enough rows.
    zero: Row,
    scratch: Row,
}

/// One run of a function: all coefficients of one order.
#[derive(Debug)]
pub(crate) struct Run<'t> {
    tape: &'t Tape,
    next: Cell<usize>,
    order: usize,
}

/// Coefficient of t^k of a power series, k the order of its run.
///
/// A *view* of a row: c_k = scale·row_k for k ≥ 1, so that adding, scaling and negating by
/// constants need no row of their own.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Jet<'r> {
    run: &'r Run<'r>,
    row: &'r Row,
    scale: f64,
    /// Coefficient of order 0, of the view.
    value: f64,
    /// Coefficient of order k, of the view; meaningless for k = 0.
    newest: f64,
}

impl Tape {
    pub(crate) fn new() -> Self {
        Self {
            rows: Vec::new(),
            zero: zero(),
            scratch: zero(),
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
            };
            let result = function(&run);
            let rows = run.next.get();
            if order > 0 || rows <= self.rows.len() {
                return result;
            }
            self.rows.resize_with(rows, zero);
        }
    }

    /// The coefficients of f(s(t)) from those of s(t), as many as both slices hold, at most
    /// [`LONGEST`].
    pub(crate) fn compose(&mut self, function: impl Function, inner: &[f64], outer: &mut [f64]) {
        for (k, (s, f)) in std::iter::zip(inner, outer).take(LONGEST).enumerate() {
            *f = self.run(k, |run| function.at(run.input(*s)).coefficient());
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
    /// The next input, by its coefficient of this run's order.
    #[inline(always)]
    pub(crate) fn input(&self, coefficient: f64) -> Jet<'_> {
        self.set(self.claim(), coefficient)
    }

    #[inline(always)]
    fn claim(&self) -> &Row {
        let index = self.next.get();
        self.next.set(index + 1);
        self.tape.rows.get(index).unwrap_or(&self.tape.scratch)
    }

    /// A view of a row, with its newest coefficient put in.
    #[inline(always)]
    fn set<'r>(&'r self, row: &'r Row, coefficient: f64) -> Jet<'r> {
        // Orders are below LONGEST: see `Tape::run`.
        if let Some(newest) = row.get(self.order) {
            newest.set(coefficient);
        }
        Jet {
            run: self,
            row,
            scale: 1.0,
            value: row[0].get(),
            newest: coefficient,
        }
    }
}

impl<'r> Jet<'r> {
    /// The coefficient itself.
    #[inline(always)]
    pub(crate) fn coefficient(self) -> f64 {
        if self.order() == 0 {
            self.value
        } else {
            self.newest
        }
    }

    #[inline(always)]
    fn order(self) -> usize {
        self.run.order
    }

    /// The result of an operation: in run 0 its value, in every later run its newest coefficient,
    /// which may read the row that the operation wrote before.
    #[inline(always)]
    fn operation(
        self,
        row: &'r Row,
        value: impl FnOnce() -> f64,
        newest: impl FnOnce(usize) -> f64,
    ) -> Self {
        let coefficient = match self.order() {
            0 => value(),
            k => newest(k),
        };
        self.run.set(row, coefficient)
    }

    /// A row of k·c_k, the coefficients that the same recurrences multiply with.
    #[inline(always)]
    fn weighted(self) -> &'r Row {
        let row = self.run.claim();
        self.write_weighted(row);
        row
    }

    #[inline(always)]
    fn write_weighted(self, row: &Row) {
        self.run.set(row, self.order() as f64 * self.newest);
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
        let sine = self.operation(
            s,
            || a.value.sin(),
            |k| {
                let older = inner_product(k, weighted, c) * INVERSE[k];
                mul_add(c[0].get(), a.newest, older)
            },
        );
        let cosine = self.operation(
            c,
            || a.value.cos(),
            |k| {
                let older = inner_product(k, weighted, s) * INVERSE[k];
                -mul_add(s[0].get(), a.newest, older)
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
            value: c,
            newest: 0.0,
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
            || b.value.recip(),
            |k| {
                let start = q[0].get();
                let older = inner_product(k, q, b.row) * b.scale;
                -start * mul_add(start, b.newest, older)
            },
        )
    }

    #[inline]
    fn square(self) -> Self {
        let a = self;
        self.operation(
            self.run.claim(),
            || a.value * a.value,
            |k| {
                let older = inner_square(k, a.row) * (a.scale * a.scale);
                mul_add(2.0 * a.value, a.newest, older)
            },
        )
    }

    /// y' = y·a'.
    #[inline]
    fn exp(self) -> Self {
        let (a, weighted, y) = (self, self.weighted(), self.run.claim());
        self.operation(
            y,
            || a.value.exp(),
            |k| {
                let older = inner_product(k, weighted, y) * INVERSE[k];
                mul_add(y[0].get(), a.newest, older)
            },
        )
    }

    /// a·y' = a'.
    #[inline]
    fn ln(self) -> Self {
        let (a, y, weighted) = (self, self.run.claim(), self.run.claim());
        let y = self.operation(
            y,
            || a.value.ln(),
            |k| {
                let older = inner_product(k, weighted, a.row) * a.scale * INVERSE[k];
                (a.newest - older) / a.value
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
            || a.value.sqrt(),
            |k| (a.newest - inner_square(k, y)) / (2.0 * y[0].get()),
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
            || a.value.powf(p),
            |k| {
                let by_weight = inner_product(k, weighted, y) * ((p + 1.0) * INVERSE[k]);
                let by_value = inner_product(k, a.row, y) * a.scale;
                mul_add(p * y[0].get(), a.newest, by_weight - by_value) / a.value
            },
        )
    }

    /// y' = g·a', g = 1 − y².
    #[inline]
    fn tanh(self) -> Self {
        let (a, weighted, y, g) = (self, self.weighted(), self.run.claim(), self.run.claim());
        let y = self.operation(
            y,
            || a.value.tanh(),
            |k| {
                let older = inner_product(k, weighted, g) * INVERSE[k];
                mul_add(g[0].get(), a.newest, older)
            },
        );
        y.operation(
            g,
            || a.value.cosh().powi(-2),
            |k| -mul_add(2.0 * y.value, y.newest, inner_square(k, y.row)),
        );
        y
    }

    /// b·y' = a', b = 1 + a².
    #[inline]
    fn atan(self) -> Self {
        let (a, b) = (self, self.square() + 1.0);
        let (y, weighted) = (self.run.claim(), self.run.claim());
        let y = self.operation(
            y,
            || a.value.atan(),
            |k| {
                let older = inner_product(k, weighted, b.row) * INVERSE[k];
                (a.newest - older) / b.value
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
            || a.value + b.value,
            |_| a.newest + b.newest,
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
            || a.value * b.value,
            |k| {
                let older = inner_product(k, a.row, b.row) * (a.scale * b.scale);
                mul_add(a.value, b.newest, mul_add(b.value, a.newest, older))
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
            || a.value / b.value,
            |k| {
                let older = inner_product(k, q, b.row) * b.scale;
                (a.newest - mul_add(q[0].get(), b.newest, older)) / b.value
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
            newest: self.newest * c,
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
            newest: self.newest / c,
            ..self
        }
    }
}
