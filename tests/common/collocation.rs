//! Smooth equations y' = f(t, y) by Radau IIA of order 9, with steps of one length: an integrator
//! that shares nothing with the crate.

use crate::radau::{STAGES, weights};

/// y at the end of so many steps.
pub fn integrate(
    rates: &dyn Fn(f64, &[f64]) -> Vec<f64>,
    start: &[f64],
    [begin, end]: [f64; 2],
    steps: usize,
) -> Vec<f64> {
    let weights = weights();
    let h = (end - begin) / steps as f64;
    let mut y = start.to_vec();
    for step in 0..steps {
        let t = begin + h * step as f64;
        let mut slopes = vec![rates(t, &y); STAGES];
        // The stages by fixed-point iteration: steps are short.
        loop {
            let next = weights.map(|row| {
                let place = |i: usize| (0..STAGES).map(|j| row[j] * slopes[j][i]).sum::<f64>();
                let stage: Vec<f64> = (0..y.len()).map(|i| y[i] + h * place(i)).collect();
                rates(t + h * row.iter().sum::<f64>(), &stage)
            });
            let moved = std::iter::zip(next.iter().flatten(), slopes.iter().flatten());
            let moved = moved.fold(0.0, |most: f64, (a, b)| {
                most.max((a - b).abs() / (1.0 + b.abs()))
            });
            slopes = next.to_vec();
            assert!(!moved.is_nan(), "{t} {y:?}");
            if moved < 1e-15 {
                break;
            }
        }
        let last = weights[STAGES - 1];
        for (i, y) in y.iter_mut().enumerate() {
            *y += h * (0..STAGES).map(|j| last[j] * slopes[j][i]).sum::<f64>();
        }
    }
    y
}
