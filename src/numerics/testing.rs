//! Shared by unit tests.

/// Number of cases: a few in a usual run, all with the variable `FULL=1`, n times all with
/// `FULL=n`.
pub(crate) fn count(few: usize, all: usize) -> usize {
    match std::env::var("FULL") {
        Ok(times) => all * times.parse::<usize>().expect("FULL: a whole number"),
        Err(_) => few,
    }
}

/// The first few of some cases, or all of them.
pub(crate) fn some<T, const N: usize>(few: usize, cases: [T; N]) -> impl Iterator<Item = T> {
    cases.into_iter().take(count(few, N))
}

/// Numbers in −1 ≤ y < 1 without any order.
pub(crate) fn rough(x: f64) -> f64 {
    let mixed = x.to_bits().wrapping_mul(0x9e37_79b9_7f4a_7c15);
    ((mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9) >> 11) as f64 * 0.5_f64.powi(52)
        - 1.0
}
