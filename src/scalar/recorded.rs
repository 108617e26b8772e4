//! A number that records its operations. A function is run once, at its base value. Its power
//! series is computed from this record, by code that is the same for all functions: see `lanes.rs`.
//!
//! In each order k > 0, every operation of a law is a sum of products of earlier coefficients plus
//! a linear part, whose factors depend on the base values:
//!
//! ```text
//! c_k = f·Σ_{0<i<k} x_i y_{k−i} + α a_k + β b_k
//! ```
//!
//! As in `taylor.rs`, a coefficient is slope·s_k + rest, where s_k is the coefficient of the
//! function's argument; few operations have to wait for s_k. Further inputs, such as memory
//! variables, are known before s_k. The recurrences are those of
//! `operations.rs`. Only the numbers of rows and the kinds of sums depend on the function, so
//! motions of one law, or of several, that went the same way through their functions are computed
//! side by side.

use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::{Scalar, integral, power_by_squaring, root_beside_one, sealed};

/// The sum that an operation takes in order k, over the rows named.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Sum {
    Nothing,
    /// Σ x_i y_{k−i}, with a weight.
    Product(u16, u16, Weight),
    /// Σ x_i x_{k−i}; there is no b.
    Square(u16),
    /// Nothing: the result is k·α a_k.
    Weight,
}

/// The factor of a sum of products.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Weight {
    One,
    /// 1/k.
    Integral,
}

/// An operation without its numbers: the sum, and the rows a and b.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Operation {
    pub(crate) sum: Sum,
    pub(crate) rows: [u16; 2],
}

/// A noted operation.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Note {
    pub(crate) operation: Operation,
    /// f, α and β.
    pub(crate) factors: [f64; 3],
    /// The derivative of its result by the function's argument.
    pub(crate) slope: f64,
}

/// A result of a function: scale·row for k > 0.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Output {
    pub(crate) row: u16,
    pub(crate) scale: f64,
}

/// The row of every constant: 0.
const ZERO: u16 = 0;

/// The row of the function's argument.
pub(crate) const ARGUMENT: u16 = 1;

/// The row of the first of its further inputs; the operations follow, each with a row.
pub(crate) const INPUTS: u16 = 2;

/// The operations of a function, in their sequence.
#[derive(Debug, Clone, Default)]
pub(crate) struct Recorder {
    notes: RefCell<Vec<Note>>,
    /// The rates of the function's further inputs.
    rates: RefCell<Vec<Output>>,
    inputs: u16,
}

/// A number under way: a *view* of a row, so that adding, scaling and negating by constants need no
/// row of their own.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Recorded<'r> {
    recorder: &'r Recorder,
    row: u16,
    scale: f64,
    /// Coefficient of order 0.
    value: f64,
    /// Derivative by the function's argument.
    slope: f64,
}

impl Recorder {
    /// Takes notes of a function of an argument and so many further inputs, and of it alone.
    pub(crate) fn begin(&mut self, inputs: usize) -> &Self {
        self.notes.get_mut().clear();
        self.rates.get_mut().clear();
        // A law has far fewer variables than there are numbers of rows.
        self.inputs = inputs as u16;
        self
    }

    /// The argument, at its base value.
    pub(crate) fn argument(&self, value: f64) -> Recorded<'_> {
        self.variable(ARGUMENT, value, 1.0)
    }

    /// A further input, at its base value. Each of its coefficients is known before that of the
    /// argument.
    pub(crate) fn input(&self, number: usize, value: f64) -> Recorded<'_> {
        self.variable(INPUTS + number as u16, value, 0.0)
    }

    fn variable(&self, row: u16, value: f64, slope: f64) -> Recorded<'_> {
        Recorded {
            recorder: self,
            row,
            scale: 1.0,
            value,
            slope,
        }
    }

    /// Notes the rate of the next of the further inputs.
    pub(crate) fn give_rate(&self, rate: Recorded<'_>) {
        self.rates.borrow_mut().push(rate.output());
    }

    /// Number of the further inputs.
    pub(crate) fn inputs(&self) -> usize {
        usize::from(self.inputs)
    }

    pub(crate) fn notes(&mut self) -> &[Note] {
        self.notes.get_mut()
    }

    pub(crate) fn rates(&mut self) -> &[Output] {
        self.rates.get_mut()
    }
}

impl<'r> Recorded<'r> {
    /// The result of a function.
    pub(crate) fn output(self) -> Output {
        Output {
            row: self.row,
            scale: self.scale,
        }
    }

    fn next_row(self) -> u16 {
        // The operations of a law are far fewer than there are numbers of rows.
        INPUTS + self.recorder.inputs + self.recorder.notes.borrow().len() as u16
    }

    /// Notes an operation: f and its sum, with α, β relative to the views a and b.
    #[inline]
    fn note(self, value: f64, (f, sum): (f64, Sum), a: (Self, f64), b: (Self, f64)) -> Self {
        let row = self.next_row();
        let factors = [f, a.1 * a.0.scale, b.1 * b.0.scale];
        let rows = [a.0.row, b.0.row];
        let operation = Operation { sum, rows };
        let mut notes = self.recorder.notes.borrow_mut();
        let slope = a.1 * a.0.slope + b.1 * b.0.slope;
        notes.push(Note {
            operation,
            factors,
            slope,
        });
        Self {
            row,
            scale: 1.0,
            value,
            slope,
            ..self
        }
    }

    /// Notes an operation on `a` alone.
    #[inline]
    fn note_of(self, value: f64, sum: (f64, Sum), factor: f64) -> Self {
        self.note(value, sum, (self, factor), (self.constant(0.0), 0.0))
    }

    /// The row of k·c_k, with which the recurrences of y' = f(y)·a' multiply.
    #[inline]
    fn weighted(self) -> u16 {
        self.note_of(0.0, (0.0, Sum::Weight), 1.0).row
    }

    /// b·y' = a', with the value of y.
    #[inline]
    fn divided_integral(self, b: Self, value: f64) -> Self {
        let weighted = self.next_row() + 1;
        let sum = (
            -b.scale / b.value,
            Sum::Product(weighted, b.row, Weight::Integral),
        );
        let y = self.note_of(value, sum, b.value.recip());
        y.weighted();
        y
    }

    /// S' = C·a', C' = −S·a'.
    fn sin_cos(self) -> (Self, Self) {
        let (sine, cosine) = self.value.sin_cos();
        let weighted = self.weighted();
        let row = self.next_row();
        let s = self.note_of(
            sine,
            (1.0, Sum::Product(weighted, row + 1, Weight::Integral)),
            cosine,
        );
        let c = self.note_of(
            cosine,
            (-1.0, Sum::Product(weighted, row, Weight::Integral)),
            -sine,
        );
        (s, c)
    }
}

impl sealed::Sealed for Recorded<'_> {}

impl Scalar for Recorded<'_> {
    #[inline]
    fn constant(self, c: f64) -> Self {
        Self {
            row: ZERO,
            scale: 1.0,
            value: c,
            slope: 0.0,
            ..self
        }
    }

    #[inline]
    fn value(self) -> f64 {
        self.value
    }

    /// q·b = 1.
    #[inline]
    fn recip(self) -> Self {
        let q = self.value.recip();
        let sum = Sum::Product(self.next_row(), self.row, Weight::One);
        self.note_of(q, (-q * self.scale, sum), -q * q)
    }

    #[inline]
    fn square(self) -> Self {
        let sum = (self.scale * self.scale, Sum::Square(self.row));
        self.note_of(self.value * self.value, sum, 2.0 * self.value)
    }

    /// y' = y·a'.
    #[inline]
    fn exp(self) -> Self {
        let (y, weighted) = (self.value.exp(), self.weighted());
        let sum = Sum::Product(weighted, self.next_row(), Weight::Integral);
        self.note_of(y, (1.0, sum), y)
    }

    /// a·y' = a'.
    #[inline]
    fn ln(self) -> Self {
        let weighted = self.next_row() + 1;
        let sum = (
            -self.scale / self.value,
            Sum::Product(weighted, self.row, Weight::Integral),
        );
        let y = self.note_of(self.value.ln(), sum, self.value.recip());
        y.weighted();
        y
    }

    /// y·y = a.
    #[inline]
    fn sqrt(self) -> Self {
        let y = self.value.sqrt();
        let half = 0.5 / y;
        self.note_of(y, (-half, Sum::Square(self.next_row())), half)
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
        let (a, p) = (self, exponent);
        let value = a.value.powf(p);
        let (weighted, y) = (a.weighted(), a.next_row() + 1);
        let zero = (a.constant(0.0), 0.0);
        let by_value = (-a.scale / a.value, Sum::Product(a.row, y, Weight::One));
        let by_value = a.note(0.0, by_value, zero, zero);
        let by_weight = (
            (p + 1.0) / a.value,
            Sum::Product(weighted, y, Weight::Integral),
        );
        a.note(value, by_weight, (a, p * value / a.value), (by_value, 1.0))
    }

    /// y' = g·a', g = 1 − y².
    #[inline]
    fn tanh(self) -> Self {
        let g = self.value.cosh().powi(-2);
        let weighted = self.weighted();
        let sum = Sum::Product(weighted, self.next_row() + 1, Weight::Integral);
        let y = self.note_of(self.value.tanh(), (1.0, sum), g);
        y.note_of(g, (-1.0, Sum::Square(y.row)), -2.0 * y.value);
        y
    }

    /// b·y' = a', b = 1 + a².
    #[inline]
    fn atan(self) -> Self {
        self.divided_integral(self.square() + 1.0, self.value.atan())
    }

    /// b·y' = a', b = √(1 + a²).
    #[inline]
    fn asinh(self) -> Self {
        self.divided_integral(root_beside_one(self), self.value.asinh())
    }

    #[inline]
    fn sin(self) -> Self {
        self.sin_cos().0
    }

    #[inline]
    fn cos(self) -> Self {
        self.sin_cos().1
    }

    #[inline]
    fn abs(self) -> Self {
        if self.value < 0.0 { -self } else { self }
    }
}

impl Neg for Recorded<'_> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self * -1.0
    }
}

impl Add for Recorded<'_> {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        let value = self.value + other.value;
        self.note(value, (0.0, Sum::Nothing), (self, 1.0), (other, 1.0))
    }
}

impl Sub for Recorded<'_> {
    type Output = Self;
    #[inline]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Recorded<'_> {
    type Output = Self;
    #[inline]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self, other);
        let sum = (a.scale * b.scale, Sum::Product(a.row, b.row, Weight::One));
        self.note(a.value * b.value, sum, (a, b.value), (b, a.value))
    }
}

impl Div for Recorded<'_> {
    type Output = Self;
    /// q·b = a.
    #[inline]
    fn div(self, other: Self) -> Self {
        let (a, b) = (self, other);
        let q = a.value / b.value;
        let sum = (
            -b.scale / b.value,
            Sum::Product(self.next_row(), b.row, Weight::One),
        );
        self.note(q, sum, (a, b.value.recip()), (b, -q / b.value))
    }
}

impl Add<f64> for Recorded<'_> {
    type Output = Self;
    #[inline]
    fn add(self, c: f64) -> Self {
        Self {
            value: self.value + c,
            ..self
        }
    }
}

impl Sub<f64> for Recorded<'_> {
    type Output = Self;
    #[inline]
    fn sub(self, c: f64) -> Self {
        self + -c
    }
}

impl Mul<f64> for Recorded<'_> {
    type Output = Self;
    #[inline]
    fn mul(self, c: f64) -> Self {
        Self {
            scale: self.scale * c,
            value: self.value * c,
            slope: self.slope * c,
            ..self
        }
    }
}

impl Div<f64> for Recorded<'_> {
    type Output = Self;
    #[inline]
    fn div(self, c: f64) -> Self {
        Self {
            scale: self.scale / c,
            value: self.value / c,
            slope: self.slope / c,
            ..self
        }
    }
}
