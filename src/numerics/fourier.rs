//! Fourier coefficients of a function that is known piece by piece, all of them in a time in
//! proportion to their number.

use num_complex::Complex;

use super::gauss::gauss_nodes;

/// Nodes of a piece, and Legendre polynomials by which it is expressed.
const NODES: usize = 16;
/// Largest κ, half the radians of a harmonic in a piece, for which the nodes resolve the harmonic
/// itself: the error of the rule for e^{−iκx} is below 10⁻²⁴.
const RESOLVED: f64 = 4.0;

/// The integrals ∫ f e^{−ikωt} dt for k = 1, …, n.
pub(crate) struct Fourier {
    omega: f64,
    integrals: Vec<Complex<f64>>,
}

impl Fourier {
    pub(crate) fn new(omega: f64, n: usize) -> Self {
        let integrals = vec![Complex::ZERO; n];
        Self { omega, integrals }
    }

    /// Adds a piece of duration h from a time on. The function takes the time since then, and is
    /// analytic as the [`gauss_nodes`] need it.
    ///
    /// With x from −1 to 1 on the piece, f = Σ c_l P_l(x), and
    /// ∫ P_l e^{−iκx} dx = 2(−i)^l j_l(κ). The spherical Bessel functions j_l follow from j_0 and
    /// j_1 upwards: what that magnifies, for l > κ, is less than what the c_l fall.
    pub(crate) fn add(&mut self, start: f64, h: f64, f: &dyn Fn(f64) -> f64) {
        let middle = start + 0.5 * h;
        let mut nodes = [[0.0; 2]; NODES];
        let mut legendre = [0.0; NODES];
        for (node, (x, weight)) in nodes.iter_mut().zip(gauss_nodes(-1.0, 1.0)) {
            let value = 0.5 * weight * f(0.5 * h * (1.0 + x));
            *node = [x, value];
            // (l + 1) P_{l+1} = (2l + 1) x P_l − l P_{l−1}
            let (mut before, mut p) = (0.0, 1.0);
            for (l, coefficient) in legendre.iter_mut().enumerate() {
                let (l, odd) = (l as f64, (2 * l + 1) as f64);
                *coefficient += odd * value * p;
                (before, p) = (p, (odd * x * p - l * before) / (l + 1.0));
            }
        }
        // The signs of (−i)^l.
        for (l, coefficient) in legendre.iter_mut().enumerate() {
            if l % 4 > 1 {
                *coefficient = -*coefficient;
            }
        }
        for (k, integral) in self.integrals.iter_mut().enumerate() {
            let frequency = (k + 1) as f64 * self.omega;
            let kappa = 0.5 * h * frequency;
            let mut mean = Complex::<f64>::ZERO;
            if kappa < RESOLVED {
                for [x, value] in nodes {
                    mean += value * Complex::cis(-kappa * x);
                }
            } else {
                let (sine, cosine) = kappa.sin_cos();
                let (mut before, mut bessel) = (cosine / kappa, sine / kappa);
                for (l, pair) in legendre.chunks_exact(2).enumerate() {
                    let factor = (4 * l + 1) as f64 / kappa;
                    let odd = factor * bessel - before;
                    mean += Complex::new(pair[0] * bessel, -pair[1] * odd);
                    let factor = (4 * l + 3) as f64 / kappa;
                    (before, bessel) = (odd, factor * odd - bessel);
                }
            }
            *integral += mean * Complex::cis(-frequency * middle) * h;
        }
    }

    /// The complex amplitudes of the harmonics of a function of period 2π/ω, in this unit.
    pub(crate) fn amplitudes(self, unit: f64) -> Vec<Complex<f64>> {
        let of_integral = self.omega / std::f64::consts::PI;
        let integrals = self.integrals.into_iter();
        integrals
            .map(|integral| integral * of_integral * unit)
            .collect()
    }
}

/// The complex amplitudes of a derivative: (ikω)^times those of the function, for k = 1, ….
pub(crate) fn differentiated(
    mut amplitudes: Vec<Complex<f64>>,
    omega: f64,
    times: i32,
) -> Vec<Complex<f64>> {
    for (k, amplitude) in (1..).zip(&mut amplitudes) {
        *amplitude *= Complex::new(0.0, f64::from(k) * omega).powi(times);
    }
    amplitudes
}

#[cfg(test)]
mod tests {
    use super::*;

    /// B_m(x) = −m! Σ e^{2πikx}/(2πik)^m over k ≠ 0: a sawtooth, and its integrals, whose harmonics
    /// fall off as k^{−m}.
    #[test]
    fn harmonics_are_those_of_bernoullis_polynomials() {
        let polynomials: [fn(f64) -> f64; 4] = [
            |x| x - 0.5,
            |x| x * (x - 1.0) + 1.0 / 6.0,
            |x| x * (x - 0.5) * (x - 1.0),
            |x| (x * (x - 1.0)).powi(2) - 1.0 / 30.0,
        ];
        let n = 3000;
        for (m, polynomial) in (1..).zip(polynomials) {
            // In pieces of any length: from 10⁻⁶ of the period to nearly all of it.
            for ends in [
                &[0.0, 1.0][..],
                &[0.0, 1e-6, 0.05, 0.3, 0.95, 1.0],
                &[0.0, 0.5, 1.0],
            ] {
                let mut fourier = Fourier::new(std::f64::consts::TAU, n);
                for end in ends.windows(2) {
                    let of_piece = |t: f64| polynomial(end[0] + t);
                    fourier.add(end[0], end[1] - end[0], &of_piece);
                }
                let factorial: f64 = (1..=m).map(f64::from).product();
                for (k, found) in (1..).zip(fourier.amplitudes(1.0)) {
                    let wave = Complex::new(0.0, std::f64::consts::TAU * f64::from(k));
                    let expected = -2.0 * factorial / wave.powi(m);
                    let error = (found - expected).norm();
                    assert!(error < 2e-15, "{m} {ends:?} {k}: {error:e}");
                }
            }
        }
    }
}
