//! Sums of products of coefficients, for series whose order is known at run time.
//!
//! Unrolled for each order, once for all laws and operations. Loops of run-time length take 1.5
//! times as long for a whole series: at these lengths their starts and ends cost more than their
//! sums, and vectors would span coefficients just stored one by one, and wait for them.

use std::cell::Cell;

use super::taylor::from_the_middle;
use super::{LONGEST, mul_add};

/// The coefficients that one operation has computed so far.
pub(super) type Row = [Cell<f64>; LONGEST];

/// `$sum(k, rows)`, with an order that the compiler knows for the orders of a motion's series;
/// higher ones are asked for by derivatives only. A function, not a closure: see `fused.rs`.
macro_rules! by_order {
    ($nothing:expr, $sum:path, $k:expr, $rows:expr) => {
        by_order!(
            $nothing, $sum, $k, $rows,
            2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25 26
        )
    };
    ($nothing:expr, $sum:path, $k:expr, $rows:expr, $($order:literal)*) => {
        match $k {
            0 | 1 => $nothing,
            $($order => $sum($order, $rows),)*
            k => $sum(k, $rows),
        }
    };
}
pub(super) use by_order;

/// Σ a_i·b_{k−i} for 0 < i < k.
#[inline(never)]
pub(super) fn inner_product(k: usize, a: &Row, b: &Row) -> f64 {
    by_order!(0.0, product, k, (a, b))
}

/// Σ a_i·a_{k−i} for 0 < i < k, at half the work of [`inner_product`].
#[inline(never)]
pub(super) fn inner_square(k: usize, a: &Row) -> f64 {
    by_order!(0.0, square, k, a)
}

/// The newest coefficients, of order k − 1, come last.
#[inline(always)]
fn product(k: usize, (a, b): (&Row, &Row)) -> f64 {
    let (a, b) = (|i: usize| a[i].get(), |i: usize| b[i].get());
    if k == 2 {
        return a(1) * b(1);
    }
    let low = from_the_middle(mul_add, k / 2, |i| (a(i), b(k - i)));
    let high = from_the_middle(mul_add, (k - 1) / 2, |i| (a(k - i), b(i)));
    mul_add(b(1), a(k - 1), mul_add(a(1), b(k - 1), low + high))
}

#[inline(always)]
fn square(k: usize, a: &Row) -> f64 {
    let a = |i: usize| a[i].get();
    if k == 2 {
        return a(1) * a(1);
    }
    let half = from_the_middle(mul_add, (k - 1) / 2, |i| (a(i), a(k - i)));
    let half = mul_add(a(1), a(k - 1), half);
    if k.is_multiple_of(2) {
        mul_add(a(k / 2), a(k / 2), 2.0 * half)
    } else {
        2.0 * half
    }
}
