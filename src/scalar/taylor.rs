//! One coefficient of a Taylor series, as a number that a friction law can be evaluated on.
//!
//! A law is run once for every order k of the series. In run k each operation of the law computes
//! only its own k-th coefficient. For that it reads the rows of coefficients that it and its
//! operands wrote in the runs before. The row of an operation is found by the operation's position
//! in the sequence of operations, which is the same in every run. The recurrences are the classical
//! ones (Griewank and Walther, *Evaluating Derivatives*, 2nd ed., SIAM 2008, ch. 13; Jorba and Zou,
//! *Experimental Mathematics* 14 (2005) 99-117).
//!
//! Two things make this fast. Order and length are const generics, so that every instance of a law
//! has one call site, is inlined, and has constants for row indices. And chains are short: the k-th
//! coefficient (k ≥ 1) of every operation is `slope·s_k + rest`, where the slope belongs to order 0
//! and the rest consists of older coefficients. So from one order to the next the critical path is
//! a few multiply-adds, whatever the law.

use std::cell::Cell;

use super::fused::mul_add;
use super::{Function, INLINE_ROWS};

/// The coefficients that one operation has computed so far.
#[derive(Debug, Clone)]
pub(super) struct Row<const M: usize> {
    /// The derivative of the operation with respect to s at the base point. Every later coefficient
    /// is slope·s_k + rest.
    slope: Cell<f64>,
    pub(super) c: [Cell<f64>; M],
}

impl<const M: usize> Row<M> {
    #[inline(always)]
    fn zero() -> Self {
        Self {
            slope: Cell::new(0.0),
            c: std::array::from_fn(|_| Cell::new(0.0)),
        }
    }
}

/// Working memory for series of M coefficients: row 0 for the sliding speed, then one row for each
/// operation of the law.
#[derive(Debug, Clone)]
pub(crate) struct Workspace<const M: usize> {
    inline: [Row<M>; INLINE_ROWS],
    /// More rows for longer laws. The vector grows when a law is first expanded, and never after.
    spill: Vec<Row<M>>,
    /// The row for operations that find no row yet. The run is then repeated with enough rows.
    scratch: Row<M>,
}

impl<const M: usize> Workspace<M> {
    // Inlined, because then the rows of a series of two terms stay in registers.
    #[inline(always)]
    pub(crate) fn new() -> Self {
        Self {
            inline: std::array::from_fn(|_| Row::zero()),
            spill: Vec::new(),
            scratch: Row::zero(),
        }
    }

    #[inline(always)]
    fn row(&self, index: usize) -> &Row<M> {
        if index < INLINE_ROWS {
            &self.inline[index]
        } else {
            self.spill.get(index - INLINE_ROWS).unwrap_or(&self.scratch)
        }
    }

    /// Sets coefficient k of the sliding speed's own series.
    #[inline(always)]
    fn set_speed(&self, k: usize, coefficient: f64) {
        self.inline[0].c[k].set(coefficient);
    }
}

/// One run of a law: the rows, the operation counter, and the newest coefficient s_K of the sliding
/// speed.
#[derive(Debug)]
pub(crate) struct Run<'w, const M: usize> {
    workspace: &'w Workspace<M>,
    next: Cell<usize>,
    newest: f64,
}

impl<'w, const M: usize> Run<'w, M> {
    #[inline(always)]
    pub(super) fn claim(&self) -> &'w Row<M> {
        let index = self.next.get();
        self.next.set(index + 1);
        self.workspace.row(index)
    }
}

/// Coefficient K of a power series of M coefficients, as a number.
///
/// The number is a *view* of a row: c_k = scale·row_k for k ≥ 1. So sums and products with
/// constants, and negations, need no row of their own.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Taylor<'r, const K: usize, const M: usize> {
    pub(super) run: &'r Run<'r, M>,
    pub(super) row: &'r Row<M>,
    pub(super) scale: f64,
    /// The coefficient of order 0, of the view.
    pub(super) value: f64,
    /// The derivative of the **row** with respect to the sliding speed at the base point.
    pub(super) slope: f64,
    /// The part row_K − slope·s_K, which consists of older coefficients; meaningless for K = 0.
    ///
    /// The rest is not scaled: a factor is then multiplied with the scale first, and only then with
    /// the rest, which is ready late.
    pub(super) rest: f64,
}

/// The sum start + factor·Σ a_i·b_{K−i} for 0 < i < K: the part of a Cauchy product that holds no
/// coefficient of order K.
///
/// The newest coefficients, of order K − 1, come last, and all that they are multiplied with is
/// ready by then.
#[inline(always)]
pub(super) fn inner_product<const K: usize, const M: usize>(
    a: &Row<M>,
    b: &Row<M>,
    factor: f64,
    start: f64,
) -> f64 {
    let (a, b) = (|i: usize| a.c[i].get(), |i: usize| b.c[i].get());
    match K {
        0 | 1 => start,
        2 => mul_add(factor * a(1), b(1), start),
        _ => {
            let low = from_the_middle(mul_add, K / 2, |i| (a(i), b(K - i)));
            let high = from_the_middle(mul_add, (K - 1) / 2, |i| (a(K - i), b(i)));
            let start = mul_add(factor, low + high, start);
            let start = mul_add(factor * a(1), b(K - 1), start);
            mul_add(factor * b(1), a(K - 1), start)
        }
    }
}

/// The sum start + factor·Σ a_i·a_{K−i} for 0 < i < K, at half the work of [`inner_product`].
#[inline(always)]
pub(super) fn inner_square<const K: usize, const M: usize>(
    a: &Row<M>,
    factor: f64,
    start: f64,
) -> f64 {
    let a = |i: usize| a.c[i].get();
    match K {
        0 | 1 => start,
        2 => mul_add(factor * a(1), a(1), start),
        _ => {
            let half = from_the_middle(mul_add, (K - 1) / 2, |i| (a(i), a(K - i)));
            let start = mul_add(2.0 * factor, half, start);
            let start = if K.is_multiple_of(2) {
                mul_add(factor * a(K / 2), a(K / 2), start)
            } else {
                start
            };
            mul_add(2.0 * factor * a(1), a(K - 1), start)
        }
    }
}

/// The sum Σ x_i·y_i for i = first, first − 1, …, 2, in this order.
///
/// In this order the oldest coefficients come first, and the one chain of additions waits for new
/// coefficients only at its end. More chains, or another order, are slower on targets that cannot
/// fuse: there the compiler vectorises them, with loads that span coefficients which have just been
/// written one by one, and these loads stall.
#[inline(always)]
pub(super) fn from_the_middle(
    mul_add: impl Fn(f64, f64, f64) -> f64,
    first: usize,
    factors: impl Fn(usize) -> (f64, f64),
) -> f64 {
    if first < 2 {
        return 0.0;
    }
    let (x, y) = factors(first);
    // The sum begins with a product, not with 0: the compiler may not drop an addition to 0.
    let mut sum = x * y;
    let mut i = first - 1;
    while i >= 2 {
        let (x, y) = factors(i);
        sum = mul_add(x, y, sum);
        i -= 1;
    }
    sum
}

impl<'r, const K: usize, const M: usize> Taylor<'r, K, M> {
    /// The result of an operation. Run 0 computes its value and slope, every later run its rest,
    /// which may read the row that the operation wrote before.
    #[inline(always)]
    pub(super) fn operation(
        self,
        row: &'r Row<M>,
        base: impl FnOnce() -> (f64, f64),
        rest: impl FnOnce() -> f64,
    ) -> Self {
        let (value, slope, rest) = if K == 0 {
            let (value, slope) = base();
            row.c[0].set(value);
            row.slope.set(slope);
            (value, slope, 0.0)
        } else {
            let (value, slope, rest) = (row.c[0].get(), row.slope.get(), rest());
            row.c[K].set(mul_add(slope, self.run.newest, rest));
            (value, slope, rest)
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

    /// The derivative of the view with respect to the sliding speed.
    #[inline(always)]
    pub(super) fn derivative(self) -> f64 {
        self.scale * self.slope
    }

    /// The coefficient of order K itself.
    #[inline(always)]
    pub(super) fn newest(self) -> f64 {
        self.scale * mul_add(self.slope, self.run.newest, self.rest)
    }

    /// A row of the products k·c_k, with which the recurrences of y' = f(y)·a' multiply.
    #[inline(always)]
    pub(super) fn weighted(self) -> &'r Row<M> {
        let row = self.run.claim();
        if K > 0 {
            row.c[K].set(K as f64 * self.newest());
        }
        row
    }

    /// The factor 1/K of these recurrences.
    pub(super) const INVERSE: f64 = 1.0 / K as f64;
}

/// A coefficient m_k of the friction law's series, into which the newest coefficient s_k of the
/// speed's series is still to be put.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Composed {
    /// The slope dμ̂/ds at s_0, the same for every k.
    pub(crate) slope: f64,
    /// The value m_0 for k = 0; for k ≥ 1 the rest in m_k = slope·s_k + scale·rest.
    pub(crate) rest: f64,
    /// The scale in m_k = slope·s_k + scale·rest, the same for every k.
    pub(crate) scale: f64,
}

/// Run K of a function: the coefficient of order K, and the number of rows that the run used.
#[inline(always)]
fn run<const K: usize, const M: usize, F: Function>(
    function: F,
    workspace: &Workspace<M>,
    newest: f64,
) -> (Composed, usize) {
    let run = Run {
        workspace,
        next: Cell::new(1),
        newest,
    };
    let row = workspace.row(0);
    let speed = Taylor::<K, M> {
        run: &run,
        row,
        scale: 1.0,
        value: row.c[0].get(),
        slope: 1.0,
        rest: 0.0,
    };
    let m = function.at(speed);
    let composed = Composed {
        slope: m.derivative(),
        rest: if K == 0 { m.value } else { m.rest },
        scale: m.scale,
    };
    (composed, run.next.get())
}

/// Largest number of coefficients of a series: 32, for order 31.
pub(crate) const LONGEST: usize = 32;

/// Expands s(t) = Σ s_k t^k together with m(t) = μ̂(s(t)), to M ≤ [`LONGEST`] coefficients of s,
/// and returns the law's value and slope at s_0.
///
/// `next(k, s_k, m_k)` has to return s_{k+1} from the newest coefficients of s and of the law. If
/// value or slope is not finite, nothing more is expanded.
#[inline(always)]
pub(crate) fn expand<const M: usize, F: Function>(
    function: F,
    workspace: &mut Workspace<M>,
    speed: f64,
    mut next: impl FnMut(usize, f64, Composed) -> f64,
) -> (f64, f64) {
    workspace.set_speed(0, speed);
    let (mut base, rows) = run::<0, M, F>(function, workspace, speed);
    if rows > INLINE_ROWS + workspace.spill.len() {
        workspace.spill.resize(rows - INLINE_ROWS, Row::zero());
        base = run::<0, M, F>(function, workspace, speed).0;
    }
    let (value, slope) = (base.rest, base.slope);
    if !(value.is_finite() && slope.is_finite()) {
        return (value, slope);
    }
    let mut newest = next(0, speed, base);
    workspace.set_speed(1, newest);
    // Asked as a constant: else all orders are compiled for every law, and removed again.
    macro_rules! orders {
        ($($k:literal)*) => {$(
            if const { $k + 1 < M } {
                let (coefficient, _) = run::<$k, M, F>(function, workspace, newest);
                newest = next($k, newest, coefficient);
                workspace.set_speed($k + 1, newest);
            }
        )*};
    }
    orders!(1 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26 27 28 29 30);
    let _ = newest;
    (value, slope)
}
