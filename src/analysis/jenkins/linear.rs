//! One mass on a spring and a damper: free motion, and the response from rest to e^{iωt} and to a
//! constant force, also at resonance, at critical damping and without a spring.
//!
//! ```text
//! m x'' + c x' + κ x = e^{σt},   λ1, λ2 the roots of mλ² + cλ + κ
//! x(0) = 0, x'(0) = 1, no force:   x = e[λ1, λ2]
//! from rest:                       x = e[λ1, λ2, σ]/m
//! ```
//!
//! e[…] are divided differences of λ ↦ e^{λt}: symmetric and entire, so that coinciding roots, or a
//! root equal to σ, are no special case.

use crate::numerics::sort::sort_by;
use num_complex::Complex;

/// m x'' + c x' + κ x, all finite, m > 0, c ≥ 0, κ ≥ 0.
#[derive(Debug, Clone, Copy)]
pub(super) struct Linear {
    mass: f64,
    /// The root of smaller modulus, and the other one.
    roots: [Complex<f64>; 2],
}

/// Displacement and velocity.
pub(super) type Motion<T> = [T; 2];

impl Linear {
    pub(super) fn new(mass: f64, damping: f64, stiffness: f64) -> Self {
        // Half the damping, twice, in place of c² − 4mκ: neither square can overflow first.
        let decay = 0.5 * damping / mass;
        let square = stiffness / mass;
        let frequency = square.sqrt();
        let difference = (decay - frequency) * (decay + frequency);
        let roots = if difference < 0.0 {
            let root = Complex::new(-decay, (-difference).sqrt());
            [root, root.conj()]
        } else {
            let fast = -(decay + difference.sqrt());
            let slow = if fast == 0.0 { 0.0 } else { square / fast };
            [slow.into(), fast.into()]
        };
        Self { mass, roots }
    }

    /// The roots λ of mλ² + cλ + κ.
    pub(super) fn roots(&self) -> [Complex<f64>; 2] {
        self.roots
    }

    /// The motion without a force from (1, 0) and from (0, 1), at a time t ≥ 0.
    pub(super) fn free(&self, time: f64) -> [Motion<f64>; 2] {
        let [slow, fast] = self.roots;
        let answer = first(slow * time, fast * time) * time;
        // With e[λ1, λ2] = S: x' = λ1 S + e^{λ2 t}, and from (1, 0) x = e^{λ1 t} − λ1 S.
        let kept = (slow * time).exp() - slow * answer;
        let rate = slow * answer + (fast * time).exp();
        let pull = -(slow * fast) * answer;
        [[kept.re, pull.re], [answer.re, rate.re]]
    }

    /// The motion from rest at a time t ≥ 0 under the force e^{σt}.
    pub(super) fn forced(&self, exponent: Complex<f64>, time: f64) -> Motion<Complex<f64>> {
        let mut exponents = [self.roots[0], self.roots[1], exponent];
        let scaled = exponents.map(|exponent| exponent * time);
        let displacement = second(scaled) * (time * time);
        // Of x' = σ_i e[σ_1, σ_2, σ_3] + e[the other two] the one without cancellation.
        sort_by(&mut exponents, |exponent| exponent.norm_sqr());
        let [least, a, b] = exponents;
        let velocity = least * displacement + first(a * time, b * time) * time;
        [displacement / self.mass, velocity / self.mass]
    }

    /// The motion from rest at a time t ≥ 0 under the force 1.
    pub(super) fn pushed(&self, time: f64) -> Motion<f64> {
        self.forced(Complex::ZERO, time).map(|number| number.re)
    }
}

/// Distance from which on a difference of two exponentials is divided by that of the exponents.
const APART: f64 = 1.0;

/// e[a, b] = (e^a − e^b)/(a − b), and e^a for a = b.
fn first(a: Complex<f64>, b: Complex<f64>) -> Complex<f64> {
    let half = (a - b) * 0.5;
    if 2.0 * half.norm() >= APART {
        return (a.exp() - b.exp()) / (a - b);
    }
    // e^{(a+b)/2} sinh(h)/h by its series, h = (a − b)/2.
    let square = half * half;
    let terms = (1..10).rev().map(f64::from);
    let quotient = terms.fold(Complex::<f64>::ONE, |sum, k| {
        sum * square / (2.0 * k * (2.0 * k + 1.0)) + 1.0
    });
    ((a + b) * 0.5).exp() * quotient
}

/// e[a, b, c] = (e[a, b] − e[b, c])/(a − c), and its limits where arguments meet.
fn second([a, b, c]: [Complex<f64>; 3]) -> Complex<f64> {
    // The pair that lies farthest apart is divided by.
    let pairs = [(a, b, c), (b, c, a), (c, a, b)];
    let length = |(a, _, c): &(Complex<f64>, _, Complex<f64>)| (a - c).norm();
    let farthest = pairs
        .into_iter()
        .max_by(|p, q| length(p).total_cmp(&length(q)));
    let (a, b, c) = farthest.unwrap_or(pairs[0]);
    if (a - c).norm() >= APART {
        return (first(a, b) - first(b, c)) / (a - c);
    }
    // e^m Σ h_k/(k + 2)!, m the mean, h_k the complete homogeneous polynomials of the deviations.
    let mean = (a + b + c) / 3.0;
    let [x, y, z] = [a, b, c].map(|number| number - mean);
    let [mut of_one, mut of_two, mut of_three] = [Complex::<f64>::ONE; 3];
    let mut factorial = 0.5;
    let mut sum = Complex::new(factorial, 0.0);
    for k in 1..24 {
        of_one *= x;
        of_two = of_one + y * of_two;
        of_three = of_two + z * of_three;
        factorial /= f64::from(k + 2);
        sum += of_three * factorial;
    }
    mean.exp() * sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numerics::gauss::gauss_legendre;

    /// ∫ over the triangle of e^{ua + vb + wc}, u + v + w = 1 (Hermite and Genocchi).
    fn over_triangle([a, b, c]: [Complex<f64>; 3]) -> Complex<f64> {
        let inner = |u: f64, part: fn(&Complex<f64>) -> f64| {
            gauss_legendre(0.0, 1.0 - u, |v| {
                part(&(a * u + b * v + c * (1.0 - u - v)).exp())
            })
        };
        let real = gauss_legendre(0.0, 1.0, |u| inner(u, |z| z.re));
        Complex::new(real, gauss_legendre(0.0, 1.0, |u| inner(u, |z| z.im)))
    }

    #[test]
    fn divided_differences_are_their_integrals_wherever_arguments_meet() {
        let far = [
            Complex::new(-0.3, 2.0),
            Complex::new(-0.3, -2.0),
            Complex::new(0.0, 1.7),
        ];
        for spread in [3.0, 1.1, 0.9, 0.3, 1e-3, 1e-9, 1e-30, 0.0] {
            let [a, b, c] = far.map(|number| number * spread - 0.2);
            for arguments in [[a, b, c], [b, a, c], [a, a, c], [c, b, b], [a, a, a]] {
                let error = (second(arguments) - over_triangle(arguments)).norm();
                assert!(error < 2e-15, "{arguments:?}: {error:e}");
            }
        }
    }

    #[test]
    fn motions_solve_their_equation() {
        // (m, c, κ): weak and critical damping, strong damping, no spring, no damper, neither.
        let systems = [
            (1.3, 0.1, 2.0),
            (1.0, 2.0, 1.0),
            (0.01, 3.0, 0.5),
            (1.0, 0.4, 0.0),
            (2.0, 0.0, 2.0),
            (1.5, 0.0, 0.0),
        ];
        for (m, c, k) in systems {
            let linear = Linear::new(m, c, k);
            for exponent in [0.0, 1.0, 0.3] {
                let exponent = Complex::new(0.0, exponent);
                let force = |t: f64| (exponent * t).exp();
                for time in [1e-9, 0.1, 1.0, 3.0] {
                    // x(t) = ∫ S(s) e^{σ(t − s)} ds/m, in pieces that are short beside m/c.
                    let pieces = 120;
                    let width = time / f64::from(pieces);
                    for (i, found) in linear.forced(exponent, time).into_iter().enumerate() {
                        let sum = |part: fn(Complex<f64>) -> f64| -> f64 {
                            let piece = |j: i32| {
                                let start = f64::from(j) * width;
                                gauss_legendre(start, start + width, |s| {
                                    part(force(time - s) * linear.free(s)[1][i]) / m
                                })
                            };
                            (0..pieces).map(piece).sum()
                        };
                        let expected = Complex::new(sum(|z| z.re), sum(|z| z.im));
                        let error = (found - expected).norm() / sum(|z| z.norm());
                        assert!(error < 1e-14, "{m} {c} {k} {exponent} {time}: {error:e}");
                    }
                    // Two motions of half the time.
                    let [[x, v], [y, w]] = linear.free(0.5 * time);
                    let twice = [
                        [x * x + v * y, v * x + w * v],
                        [x * y + y * w, v * y + w * w],
                    ];
                    for (a, b) in twice
                        .iter()
                        .flatten()
                        .zip(linear.free(time).iter().flatten())
                    {
                        assert!(
                            (a - b).abs() < 1e-14 * (1.0 + b.abs()),
                            "{m} {c} {k} {time}"
                        );
                    }
                }
            }
        }
    }
}
