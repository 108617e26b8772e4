//! Gauss-Legendre quadrature.

/// Positive nodes and weights of the 16-point rule on −1 ≤ x ≤ 1.
const GAUSS: [(f64, f64); 8] = [
    (0.095_012_509_837_637_44, 0.189_450_610_455_068_5),
    (0.281_603_550_779_258_9, 0.182_603_415_044_923_6),
    (0.458_016_777_657_227_37, 0.169_156_519_395_002_54),
    (0.617_876_244_402_643_7, 0.149_595_988_816_576_73),
    (0.755_404_408_355_003, 0.124_628_971_255_533_87),
    (0.865_631_202_387_831_8, 0.095_158_511_682_492_78),
    (0.944_575_023_073_232_6, 0.062_253_523_938_647_894),
    (0.989_400_934_991_649_9, 0.027_152_459_411_754_096),
];

/// Nodes and weights of the 16-point rule on a ≤ x ≤ b. The rule is exact for polynomials of degree
/// 31, and exact to round-off for a function that is analytic within four half lengths of the
/// interval's middle, as every Taylor step is.
pub(crate) fn gauss_nodes(a: f64, b: f64) -> impl Iterator<Item = (f64, f64)> {
    gauss_fours(a, b)
        .into_iter()
        .flat_map(|(nodes, weights)| std::iter::zip(nodes, weights))
}

/// The [`gauss_nodes`] in fours, for functions that are cheaper to evaluate four at a time.
pub(crate) fn gauss_fours(a: f64, b: f64) -> [([f64; 4], [f64; 4]); 4] {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let four = |i: usize| {
        let [(x, p), (y, q)] = [GAUSS[2 * i], GAUSS[2 * i + 1]];
        (
            [-x, x, -y, y].map(|node| middle + half * node),
            [p, p, q, q].map(|weight| half * weight),
        )
    };
    [four(0), four(1), four(2), four(3)]
}

/// ∫ f from a to b by the [`gauss_nodes`].
pub(crate) fn gauss_legendre(a: f64, b: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    gauss_nodes(a, b).map(|(x, weight)| weight * f(x)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_exact_to_degree_31_and_no_further() {
        let error = |degree: i32| {
            let exact = 2_f64.powi(degree + 1) / f64::from(degree + 1);
            gauss_legendre(0.0, 2.0, |t| t.powi(degree)) / exact - 1.0
        };
        assert!((0..=31).all(|degree| error(degree).abs() < 1e-14));
        assert!(error(36).abs() > 1e-14);
    }
}
