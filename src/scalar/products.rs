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

/// `$sum::<k>` for k from 2 to the last order; 0 for k < 2.
macro_rules! by_order {
    ($k:expr, $sum:ident $rows:tt) => {
        by_order!($k, $sum $rows 2 3 4 5 6 7 8 9 10 11 12 13 14 15 16 17 18 19 20 21 22 23 24 25
            26 27 28 29 30 31)
    };
    ($k:expr, $sum:ident $rows:tt $($order:literal)*) => {
        match $k {
            $($order => $sum::<$order> $rows,)*
            _ => 0.0,
        }
    };
}

/// Σ a_i·b_{k−i} for 0 < i < k.
#[inline(never)]
pub(super) fn inner_product(k: usize, a: &Row, b: &Row) -> f64 {
    by_order!(k, product(a, b))
}

/// Σ a_i·a_{k−i} for 0 < i < k, at half the work of [`inner_product`].
#[inline(never)]
pub(super) fn inner_square(k: usize, a: &Row) -> f64 {
    by_order!(k, square(a))
}

/// The newest coefficients, of order K − 1, come last.
#[inline(always)]
fn product<const K: usize>(a: &Row, b: &Row) -> f64 {
    let (a, b) = (|i: usize| a[i].get(), |i: usize| b[i].get());
    if K == 2 {
        return a(1) * b(1);
    }
    let low = from_the_middle(K / 2, |i| (a(i), b(K - i)));
    let high = from_the_middle((K - 1) / 2, |i| (a(K - i), b(i)));
    mul_add(b(1), a(K - 1), mul_add(a(1), b(K - 1), low + high))
}

#[inline(always)]
fn square<const K: usize>(a: &Row) -> f64 {
    let a = |i: usize| a[i].get();
    if K == 2 {
        return a(1) * a(1);
    }
    let half = from_the_middle((K - 1) / 2, |i| (a(i), a(K - i)));
    let half = mul_add(a(1), a(K - 1), half);
    if K.is_multiple_of(2) {
        mul_add(a(K / 2), a(K / 2), 2.0 * half)
    } else {
        2.0 * half
    }
}
