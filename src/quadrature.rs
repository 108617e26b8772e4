//! Gauss-Legendre quadrature.

/// Positive nodes and weights of the 12-point rule on [−1, 1].
const RULE: [(f64, f64); 6] = [
    (0.981560634246719251, 0.0471753363865118272),
    (0.904117256370474857, 0.106939325995318431),
    (0.769902674194304687, 0.160078328543346226),
    (0.587317954286617447, 0.203167426723065922),
    (0.367831498998180194, 0.233492536538354809),
    (0.125233408511468915, 0.249147045813402785),
];

/// ∫ f from a to b by 12 points: exact for polynomials of degree 23, and to round-off for a function that is analytic up to four
/// times the interval's half length from its middle, as every Taylor step is.
pub(crate) fn gauss_legendre(a: f64, b: f64, mut f: impl FnMut(f64) -> f64) -> f64 {
    let (middle, half) = (0.5 * (a + b), 0.5 * (b - a));
    let sum: f64 = RULE
        .iter()
        .map(|&(node, weight)| weight * (f(middle - half * node) + f(middle + half * node)))
        .sum();
    half * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn is_exact_for_degree_23_and_not_24() {
        let error = |n: i32| gauss_legendre(0.0, 2.0, |t| t.powi(n)) * f64::from(n + 1) / 2f64.powi(n + 1) - 1.0;
        assert!((0..=23).all(|n| error(n).abs() < 1e-14));
        assert!(error(24).abs() > 1e-14);
    }
}
