//! Radau IIA with five stages (order 9): the weights of an implicit method for stiff equations, and
//! the elimination that its Newton steps need.
//!
//! Source: E. Hairer, G. Wanner, *Solving Ordinary Differential Equations II*, 2nd ed., Springer
//! 1996, section IV.5.

pub const STAGES: usize = 5;

pub type Stages = [f64; STAGES];
pub type Matrix = [Stages; STAGES];

/// P_n(x).
fn legendre(n: usize, x: f64) -> f64 {
    let (mut last, mut p) = (1.0, x);
    for k in 2..=n {
        let k = k as f64;
        (last, p) = (p, ((2.0 * k - 1.0) * x * p - (k - 1.0) * last) / k);
    }
    p
}

/// The weights a_ij of the method.
pub fn weights() -> Matrix {
    // The nodes c are the roots of P_5(x) − P_4(x), x = 2c − 1; the last is 1.
    let f = |x: f64| legendre(STAGES, x) - legendre(STAGES - 1, x);
    let mut nodes = [1.0; STAGES];
    let mut found = 0;
    let cells = 1000;
    for i in 0..cells {
        let [mut a, mut b] = [i, i + 1].map(|i| 2.0 * f64::from(i) / f64::from(cells) - 1.0);
        if i + 1 == cells || f(a) * f(b) > 0.0 {
            continue;
        }
        while b.next_down() > a {
            let middle = 0.5 * (a + b);
            if middle <= a || middle >= b {
                break;
            }
            if f(a) * f(middle) <= 0.0 {
                b = middle;
            } else {
                a = middle;
            }
        }
        nodes[found] = 0.5 + 0.5 * a;
        found += 1;
    }
    assert_eq!(found, STAGES - 1);
    // a_ij = ∫ from 0 to c_i of the polynomial that is 1 at c_j and 0 at the other nodes.
    let mut a = [[0.0; STAGES]; STAGES];
    for j in 0..STAGES {
        let mut c = [0.0; STAGES];
        c[0] = 1.0;
        let mut degree = 0;
        for m in (0..STAGES).filter(|m| *m != j) {
            degree += 1;
            let scale = 1.0 / (nodes[j] - nodes[m]);
            for k in (0..=degree).rev() {
                let lower = if k > 0 { c[k - 1] } else { 0.0 };
                c[k] = scale * (lower - nodes[m] * c[k]);
            }
        }
        for (row, node) in std::iter::zip(&mut a, nodes) {
            let term = |k: usize| c[k] * node.powi(k as i32 + 1) / (k + 1) as f64;
            row[j] = (0..STAGES).map(term).sum();
        }
    }
    a
}

/// The state after a step of length h from y, with these slopes at its stages.
pub fn end<const N: usize>(
    a: &Matrix,
    y: &[f64; N],
    h: f64,
    slopes: &[[f64; N]; STAGES],
) -> [f64; N] {
    stage(a, y, h, slopes, STAGES - 1)
}

fn stage<const N: usize>(
    a: &Matrix,
    y: &[f64; N],
    h: f64,
    slopes: &[[f64; N]; STAGES],
    i: usize,
) -> [f64; N] {
    std::array::from_fn(|n| {
        let sum = (0..STAGES).map(|j| a[i][j] * slopes[j][n]);
        y[n] + h * sum.sum::<f64>()
    })
}

/// Newton's corrections of the slopes of such a step. For the derivatives of the rates each number
/// is moved by an increment, of the state at a stage and of its place.
pub fn corrections<const N: usize>(
    a: &Matrix,
    rates: &dyn Fn(&[f64; N]) -> [f64; N],
    increment: &dyn Fn(&[f64; N], usize) -> f64,
    (y, h): (&[f64; N], f64),
    slopes: &[[f64; N]; STAGES],
) -> [[f64; N]; STAGES] {
    let of = |at: &[f64]| -> [f64; N] { at.try_into().unwrap() };
    let found = newton(
        a,
        &|at, rate| rate.copy_from_slice(&rates(&of(at))),
        &|at, by| increment(&of(at), by),
        (y, h),
        slopes.as_flattened(),
    );
    std::array::from_fn(|i| std::array::from_fn(|n| found[N * i + n]))
}

/// The same for any size: compiled here, with the level of this package.
fn newton(
    a: &Matrix,
    rates: &dyn Fn(&[f64], &mut [f64]),
    increment: &dyn Fn(&[f64], usize) -> f64,
    (y, h): (&[f64], f64),
    slopes: &[f64],
) -> Vec<f64> {
    let size = y.len();
    let all = size * STAGES;
    let (mut matrix, mut right) = (vec![0.0; all * all], vec![0.0; all]);
    let [mut at, mut here, mut there] = [(); 3].map(|()| vec![0.0; size]);
    for i in 0..STAGES {
        for n in 0..size {
            let sum: f64 = (0..STAGES).map(|j| a[i][j] * slopes[size * j + n]).sum();
            at[n] = y[n] + h * sum;
        }
        rates(&at, &mut here);
        for (n, rate) in here.iter().enumerate() {
            let row = size * i + n;
            right[row] = rate - slopes[row];
            matrix[all * row + row] += 1.0;
        }
        for by in 0..size {
            let place = at[by];
            at[by] += increment(&at, by);
            let change = at[by] - place;
            rates(&at, &mut there);
            at[by] = place;
            for n in 0..size {
                let slope = (there[n] - here[n]) / change;
                for j in 0..STAGES {
                    matrix[all * (size * i + n) + size * j + by] -= h * a[i][j] * slope;
                }
            }
        }
    }
    let mut rows: Vec<&mut [f64]> = matrix.chunks_mut(all).collect();
    eliminate(&mut rows, &mut right);
    right
}

/// Solves a linear system by elimination with pivots.
pub fn solve<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> [f64; N] {
    let mut rows: Vec<&mut [f64]> = a.iter_mut().map(|row| &mut row[..]).collect();
    eliminate(&mut rows, &mut b);
    b
}

/// Elimination for any size.
fn eliminate(a: &mut [&mut [f64]], b: &mut [f64]) {
    let n = b.len();
    for k in 0..n {
        let largest = (k..n).max_by(|&i, &j| a[i][k].abs().total_cmp(&a[j][k].abs()));
        let pivot = largest.unwrap();
        a.swap(k, pivot);
        b.swap(k, pivot);
        for i in k + 1..n {
            let factor = a[i][k] / a[k][k];
            let (above, below) = a.split_at_mut(i);
            for (x, y) in std::iter::zip(&mut below[0][k..], &above[k][k..]) {
                *x -= factor * y;
            }
            b[i] -= factor * b[k];
        }
    }
    for k in (0..n).rev() {
        for j in k + 1..n {
            b[k] -= a[k][j] * b[j];
        }
        b[k] /= a[k][k];
    }
}
