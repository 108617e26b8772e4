//! A Taylor number whose order is a run-time value, for cold paths and for series of many coupled
//! quantities.
//!
//! The recurrences are those of `operations.rs`: one copy of a law serves every order. A function
//! is run once for every order k; run k computes the coefficients of t^k alone, from the rows that
//! the runs before left on the [`Tape`]. Coupled equations can therefore be advanced one order at a
//! time, each with its own tape.
//!
//! As in `operations.rs`, a coefficient is slope·s_k + rest, where s_k is the coefficient of the
//! input that is known last, the [variable](Run::variable). The critical path from one order to the
//! next is then as short as possible. Other inputs are contained in the rests.
//!
//! ```text
//! for k in 0..n {
//!     let m_k = tape.run(k, |run| law(run.variable(s_k)).coefficient());
//!     let s_{k+1} = …;                                      // from s_k, m_k and whatever else
//! }
//! ```
//!
//! [`coefficients`] is that loop for s = x + t, and [`expand`] for the speed of a motion.

mod operations;

use std::cell::Cell;

use super::products::Row;
use super::taylor::Composed;
use super::{Function, INLINE_ROWS, LONGEST, mul_add};

/// The results of one operation so far: its slope at order 0, and its coefficients.
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

/// The results of the operations of a function so far: one row each, in their sequence.
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
}

/// The first coefficients of f about x, at most [`LONGEST`]: f(x + t) = Σ f_k t^k.
pub(crate) fn coefficients(function: impl Function, x: f64, coefficients: &mut [f64]) {
    let terms = coefficients.len();
    let take = &mut |k: usize, _: f64, coefficient: f64, _: Composed| {
        coefficients[k] = coefficient;
        if k == 0 { 1.0 } else { 0.0 }
    };
    order_by_order(function, terms, x, take);
}

/// The work of [`expand`](super::expand) for `terms` ≤ [`LONGEST`] coefficients, with code that
/// serves every order.
pub(crate) fn expand(
    function: impl Function,
    terms: usize,
    speed: f64,
    mut next: impl FnMut(usize, f64, Composed) -> f64,
) -> (f64, f64) {
    let mut base = (f64::NAN, f64::NAN);
    let step = &mut |k: usize, newest: f64, _: f64, m: Composed| {
        if k == 0 {
            base = (m.rest, m.slope);
        }
        next(k, newest, m)
    };
    order_by_order(function, terms - 1, speed, step);
    base
}

/// The next coefficient of the argument.
type Next<'n> = dyn FnMut(usize, f64, f64, Composed) -> f64 + 'n;

/// Expands a function order by order: `next` is given the newest coefficient of the argument, and
/// that of the function, also as [`expand`](super::expand) gives it, and answers with the next one
/// of the argument. Compiled once for a function.
#[inline(never)]
fn order_by_order(function: impl Function, terms: usize, x: f64, next: &mut Next<'_>) {
    let mut tape = Tape::new();
    let mut newest = x;
    for k in 0..terms {
        let (coefficient, m) = tape.run(k, |run| {
            let m = function.at(run.variable(newest));
            let composed = Composed {
                slope: m.derivative(),
                rest: if k == 0 { m.value } else { m.rest },
                scale: m.scale,
            };
            (m.coefficient(), composed)
        });
        newest = next(k, newest, coefficient, m);
    }
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
}
