use std::f64::consts::PI;

use num_complex::Complex;

use super::are_positive;
use super::linear::{Linear, Motion};
use crate::error::Error;
use crate::numerics::bracket::root_between;
use crate::numerics::chebyshev::{Sample, brackets, isolate};

/// The periodic motion of one mass m with a spring k, a damper c and a Jenkins element of force T
/// under a harmonic force, with two turning points in each period, at ±A. Exact to rounding.
///
/// ```text
/// m x'' + c x' + k x + T = P cos ωt,     T: spring k_t in series with a slider of the limit F_s
/// ```
///
/// If the slider moves, the motion consists of four linear arcs. During a time τ after the turning
/// point at A, the spring is unloaded and loaded in the other direction; then the slider moves
/// until the turning point at −A. The second half of the period is the mirror image. The fields
/// follow from one scalar equation for τ. If the slider does not move, the response is that of the
/// linear oscillator with the stiffness k + k_t.
///
/// ```
/// use stick_slip::analysis::jenkins::SymmetricResponse;
///
/// let response = SymmetricResponse::at(1.0, 0.02, 0.6, 0.4, 0.3, 0.4, 0.88).unwrap();
/// assert!((response.amplitude - 2.7324348064328656).abs() < 1e-14);
/// assert!((response.elastic_time - 1.2313904113621030).abs() < 1e-14);
/// assert!((response.multipliers[0].norm() - 0.6806503183330548).abs() < 1e-14);
/// assert_eq!(response.multipliers[2].norm(), 0.0);
///
/// // With the force amplitude P = 0.02 the slider does not move.
/// let linear = SymmetricResponse::at(1.0, 0.02, 0.6, 0.4, 0.3, 0.02, 0.88).unwrap();
/// assert!((linear.amplitude - 0.02 / (1.0_f64 - 0.7744).hypot(0.0176)).abs() < 1e-15);
/// ```
///
/// Source: T. K. Caughey, *Sinusoidal excitation of a system with bilinear hysteresis*, J. Appl.
/// Mech. 27 (1960) 640-643, for the first harmonic. Here the arcs are joined exactly.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct SymmetricResponse {
    /// Amplitude A, the largest displacement, in units of displacement.
    pub amplitude: f64,
    /// Time τ from a turning point until the slider moves, in units of time; half a period if the
    /// slider does not move at all.
    pub elastic_time: f64,
    /// Phase θ of the force at the turning point at A, in radians: the force is P cos(ωt + θ), with
    /// t counted from this turning point. At this point x = A, x' = 0, and T = F_s if the slider
    /// moves.
    pub phase: f64,
    /// Floquet multipliers of the map of (x, x', T) over one period, by descending modulus.
    /// Dimensionless. If the slider moves, one multiplier is 0. If the slider does not move, one
    /// multiplier is 1: it belongs to the residual force in the spring, which does not influence
    /// the vibration.
    pub multipliers: [Complex<f64>; 3],
}

impl SymmetricResponse {
    /// The response of a mass m with a damper c, a spring k and, in parallel, a Jenkins element
    /// (stiffness k_t, limit F_s), under a force of amplitude P and angular frequency ω. Any
    /// consistent units may be used.
    ///
    /// `None` in these cases:
    ///
    /// * the periodic motion has more than two turning points in each period; this happens far
    ///   below resonance, where the free vibration is superposed on a slow motion;
    /// * the motion is unbounded: c = 0, mω² = k and πP ≥ 4F_s;
    /// * the angular frequency of the free vibration in stick exceeds 5000ω;
    /// * m, k_t, F_s, P or ω is not positive, c or k is negative, or one of them is not finite;
    /// * a ratio of these parameters overflows.
    ///
    /// ```
    /// use stick_slip::analysis::jenkins::SymmetricResponse;
    ///
    /// // k = 0: under a small force the slider does not move, under a large force it does.
    /// let free = |force| SymmetricResponse::at(1.0, 0.0, 0.0, 1.0, 1.0, force, 0.5);
    /// assert!((free(0.3).unwrap().amplitude - 0.4).abs() < 1e-15);
    /// assert!(free(2.0).unwrap().amplitude > 4.0);
    /// ```
    pub fn at(
        mass: f64,
        damping: f64,
        stiffness: f64,
        tangential_stiffness: f64,
        limit: f64,
        force: f64,
        angular_frequency: f64,
    ) -> Option<Self> {
        let (k_t, omega) = (tangential_stiffness, angular_frequency);
        let in_range =
            are_positive(&[mass, k_t, limit, force, omega]) && damping >= 0.0 && stiffness >= 0.0;
        if !in_range {
            return None;
        }
        let forced = Forced {
            mass: mass * omega / k_t * omega,
            damping: damping * omega / k_t,
            stiffness: stiffness / k_t,
            force: force / limit,
        };
        let mut response = forced.response()?;
        response.amplitude *= limit / k_t;
        response.elastic_time /= omega;
        let numbers = [response.amplitude, response.elastic_time, response.phase];
        let is_finite = numbers.iter().all(|x| x.is_finite())
            && response.multipliers.iter().all(|m| m.norm().is_finite());
        is_finite.then_some(response)
    }
}

/// The system in units of 1/ω, F_s and F_s/k_t: half a period is π, and the element has stiffness
/// and limit 1.
#[derive(Debug, Clone, Copy)]
struct Forced {
    mass: f64,
    damping: f64,
    stiffness: f64,
    force: f64,
}

/// A candidate: two arcs of half a period under the force a cos t + b sin t.
#[derive(Debug, Clone, Copy)]
struct Arcs {
    amplitude: f64,
    /// a − ib.
    force: Complex<f64>,
    /// Time τ of the elastic arc.
    elastic_time: f64,
    /// State at its end.
    release: Motion<f64>,
}

/// Rows of three equations.
type Matrix = [[f64; 3]; 3];

/// A determinant, and the sum of the moduli of its terms.
#[derive(Debug, Clone, Copy)]
struct Determinant {
    value: f64,
    size: f64,
}

/// A velocity over time, with its rounding error.
type Velocity<'v> = dyn FnMut(f64) -> Result<Sample, Error> + 'v;

/// Shortest elastic arc, in radians of the force: A is about 4F_s/(k_t τ²) there.
const SHORTEST: f64 = 1e-100;

/// Largest angular frequency of the free vibration in stick, in units of ω. At higher frequencies
/// the roots are too many to be separated.
const MOST_OSCILLATIONS: f64 = 5000.0;

/// ω = 1.
const FREQUENCY: Complex<f64> = Complex::I;

/// A value that has overflowed.
const UNKNOWN: Sample = Sample {
    value: 0.0,
    noise: f64::INFINITY,
};

/// Rounding error of a determinant relative to its size, and of a velocity to that of its terms.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

impl Forced {
    fn response(&self) -> Option<SymmetricResponse> {
        let numbers = [self.mass, self.damping, self.stiffness, self.force];
        let is_finite = numbers.iter().all(|x| x.is_finite());
        if !(is_finite && self.mass > 0.0 && self.force > 0.0) {
            return None;
        }
        let [stick, _] = self.oscillators();
        if stick.roots()[0].im > MOST_OSCILLATIONS {
            return None;
        }
        // At this resonance the element takes up 4F_s a length and no more.
        let undamped = self.damping == 0.0 && self.mass == self.stiffness;
        if undamped && PI * self.force >= 4.0 {
            return None;
        }
        let impedance = Complex::new(1.0 + self.stiffness - self.mass, self.damping);
        if self.force <= impedance.norm() {
            return Some(self.linear(impedance));
        }
        // From τ = π, where the slider hardly moves, to τ = 0, where A is infinite; a force has at
        // most one motion that is valid.
        let mut end = PI;
        while end > SHORTEST {
            let start = 0.25 * end;
            if let Some(arcs) = self.between(start, end)? {
                return Some(self.slipping(&arcs));
            }
            end = start;
        }
        None
    }

    /// The oscillator in stick, and in slip.
    fn oscillators(&self) -> [Linear; 2] {
        [1.0, 0.0].map(|k_t| Linear::new(self.mass, self.damping, self.stiffness + k_t))
    }

    /// The response without slip.
    fn linear(&self, impedance: Complex<f64>) -> SymmetricResponse {
        let [stick, _] = self.oscillators();
        let [a, b] = stick.roots().map(|root| (root * (2.0 * PI)).exp());
        SymmetricResponse {
            amplitude: self.force / impedance.norm(),
            elastic_time: PI,
            phase: impedance.arg(),
            multipliers: [Complex::ONE, a, b],
        }
    }

    /// The three equations for A, a and b, linear for given τ: force −1 at τ, displacement −A and
    /// velocity 0 at π.
    fn equations(&self, elastic_time: f64) -> (Matrix, [f64; 3]) {
        let [stick, slip] = self.oscillators();
        // On the elastic arc with y = x − A: m y'' + c y' + (k + 1) y = a cos t + b sin t − 1 − kA.
        let [answer, rate] = stick.forced(FREQUENCY, elastic_time);
        let [given, given_rate] = stick.pushed(elastic_time);
        let k = self.stiffness;
        // In the order of the unknowns, then what does not depend on them.
        let y = [-k * given, answer.re, answer.im, -given];
        let v = [-k * given_rate, rate.re, rate.im, -given_rate];
        // The second arc starts at A − 2 with that velocity, under the force 1.
        let rest = PI - elastic_time;
        let [from_place, from_speed] = slip.free(rest);
        let phase = (FREQUENCY * elastic_time).exp();
        let on = slip.forced(FREQUENCY, rest).map(|number| number * phase);
        let on_given = slip.pushed(rest);
        let end: [[f64; 4]; 2] = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let by_force = [0.0, on[i].re, on[i].im, on_given[i]][j];
                let by_place = [1.0, 0.0, 0.0, -2.0][j];
                from_place[i] * by_place + from_speed[i] * v[j] + by_force
            })
        });
        let [x_end, v_end] = end;
        let matrix = [
            [y[0], y[1], y[2]],
            [x_end[0] + 1.0, x_end[1], x_end[2]],
            [v_end[0], v_end[1], v_end[2]],
        ];
        (matrix, [-2.0 - y[3], -x_end[3], -v_end[3]])
    }

    /// The determinants of Cramer's rule: that of the equations, and those whose ratios to it are
    /// A, a and b.
    fn determinants(&self, elastic_time: f64) -> [Determinant; 4] {
        let (matrix, right) = self.equations(elastic_time);
        std::array::from_fn(|i| {
            let mut replaced = matrix;
            if let Some(column) = i.checked_sub(1) {
                for (row, right) in std::iter::zip(&mut replaced, right) {
                    row[column] = right;
                }
            }
            Determinant::of(&replaced)
        })
    }

    /// |(a, b)|² − P² times the square of the determinant, in units of 1 + P²: zero where a motion
    /// may be, and an entire function of τ.
    fn residual(&self, elastic_time: f64) -> Sample {
        let unit = self.force.hypot(1.0);
        let [all, _, a, b] = self.determinants(elastic_time);
        let parts = [(a, 1.0 / unit), (b, 1.0 / unit), (all, self.force / unit)];
        let [(a, a_noise), (b, b_noise), (c, c_noise)] = parts.map(|(determinant, factor)| {
            let value = determinant.value * factor;
            let noise = determinant.size * factor * ROUNDING;
            (value, noise * (2.0 * value.abs() + noise))
        });
        let value = a * a + b * b - c * c;
        if elastic_time == PI {
            // The linear response of amplitude 1 needs less force than there is.
            let value = value.min(-f64::MIN_POSITIVE);
            return Sample { value, noise: 0.0 };
        }
        let noise = a_noise + b_noise + c_noise;
        if value.is_finite() && noise.is_finite() {
            Sample { value, noise }
        } else {
            UNKNOWN
        }
    }

    /// The motion with start ≤ τ ≤ end. `None` if the search fails, `Some(None)` if there is none.
    fn between(&self, start: f64, end: f64) -> Option<Option<Arcs>> {
        let mut residual = |time: f64| -> Result<Sample, Error> { Ok(self.residual(time)) };
        // Exact at both ends.
        let time = |t: f64| {
            if t == 1.0 {
                end
            } else {
                start + (end - start) * t
            }
        };
        let nodes = isolate(&mut residual, &time).ok()?;
        for [a, b] in brackets(&nodes).into_iter().rev() {
            let root = root_between(&mut |time| Ok(self.residual(time).value), a, b).ok()?;
            let arcs = self.arcs(root);
            if arcs.is_some_and(|arcs| self.is_valid(&arcs)) {
                return Some(arcs);
            }
        }
        Some(None)
    }

    /// The arcs with a given τ. `None` if they are not determined.
    fn arcs(&self, elastic_time: f64) -> Option<Arcs> {
        let [all, amplitude, a, b] = self.determinants(elastic_time);
        let [amplitude, a, b] = [amplitude, a, b].map(|part| part.value / all.value);
        let force = Complex::new(a, -b);
        let [stick, _] = self.oscillators();
        let given = -1.0 - self.stiffness * amplitude;
        let release = self.under(&stick, force, given, elastic_time)[1];
        let arcs = Arcs {
            amplitude,
            force,
            elastic_time,
            release: [amplitude - 2.0, release],
        };
        (amplitude.is_finite() && force.norm().is_finite()).then_some(arcs)
    }

    /// The motion of an oscillator from rest under Re(force·e^{it}) and a constant force.
    fn under(
        &self,
        oscillator: &Linear,
        force: Complex<f64>,
        given: f64,
        time: f64,
    ) -> Motion<f64> {
        let [x, v] = oscillator.forced(FREQUENCY, time);
        let [y, w] = oscillator.pushed(time);
        [(force * x).re + given * y, (force * v).re + given * w]
    }

    /// Returns true if the velocity is negative on the open half period: the slider then moves in
    /// the second arc, and in no other.
    fn is_valid(&self, arcs: &Arcs) -> bool {
        let &Arcs {
            amplitude,
            force,
            elastic_time,
            release,
        } = arcs;
        let given = -1.0 - self.stiffness * amplitude;
        let leaves = force.re + given < 0.0;
        if !(leaves && amplitude >= 1.0 - ROUNDING) {
            return false;
        }
        let [stick, slip] = self.oscillators();
        let size = (force.norm() + 1.0 + self.stiffness * amplitude) * PI / self.mass;
        let noise = ROUNDING * size;
        let mut in_stick = |time: f64| -> Result<Sample, Error> {
            let value = self.under(&stick, force, given, time)[1];
            Ok(Sample { value, noise })
        };
        let turned = force * (FREQUENCY * elastic_time).exp();
        let mut in_slip = |time: f64| -> Result<Sample, Error> {
            let [from_place, from_speed] = slip.free(time).map(|motion| motion[1]);
            let kept = from_place * release[0] + from_speed * release[1];
            let value = kept + self.under(&slip, turned, 1.0, time)[1];
            Ok(Sample { value, noise })
        };
        let rest = PI - elastic_time;
        let mut fastest = 0.0_f64;
        let mut falls = |velocity: &mut Velocity<'_>, duration: f64| {
            // Nearly all candidates rise somewhere on a coarse grid.
            let mut rises = (1..32).map(|i| velocity(duration * f64::from(i) / 32.0));
            if rises.any(|sample| sample.is_ok_and(|sample| sample.value > noise)) {
                return false;
            }
            let Ok(nodes) = isolate(velocity, &|t| t * duration) else {
                return false;
            };
            let values = nodes.iter().map(|node| node.sample.value);
            fastest = values.clone().fold(fastest, |least, v| least.min(v));
            brackets(&nodes).is_empty() && !values.clone().any(|value| value > noise)
        };
        falls(&mut in_stick, elastic_time) && falls(&mut in_slip, rest) && -fastest > 1e3 * noise
    }

    fn slipping(&self, arcs: &Arcs) -> SymmetricResponse {
        let [stick, slip] = self.oscillators();
        // A perturbation (δx, δv) of a turn: the spring relaxes from F_s wherever the turn is.
        let [[a, b], [c, d]] = stick.free(arcs.elastic_time);
        let [x, v] = stick.pushed(arcs.elastic_time);
        let elastic = [[a + x, b + v], [c, d]];
        let free = slip.free(PI - arcs.elastic_time);
        let through = |[x, v]: Motion<f64>| [0, 1].map(|i| free[0][i] * x + free[1][i] * v);
        let [[a, b], [c, d]] = elastic.map(through);
        let (half, product) = (0.5 * (a + d), a * d - b * c);
        let discriminant = half * half - product;
        let [large, small] = if discriminant < 0.0 {
            // Squared, the first has the positive imaginary part.
            let pair = Complex::new(half, (-discriminant).sqrt().copysign(half));
            [pair, pair.conj()]
        } else {
            // The smaller root follows from the larger one without cancellation.
            let large = half + discriminant.sqrt().copysign(half);
            let small = if large == 0.0 { 0.0 } else { product / large };
            [large.into(), small.into()]
        };
        SymmetricResponse {
            amplitude: arcs.amplitude,
            elastic_time: arcs.elastic_time,
            phase: arcs.force.arg(),
            multipliers: [large * large, small * small, Complex::ZERO],
        }
    }
}

impl Determinant {
    fn of(matrix: &Matrix) -> Self {
        let minor = |i: usize, j: usize| {
            let [p, q] = [matrix[1][i] * matrix[2][j], matrix[1][j] * matrix[2][i]];
            (p - q, p.abs() + q.abs())
        };
        let terms = [(0, 1, 2), (1, 2, 0), (2, 0, 1)].map(|(column, i, j)| {
            let (value, size) = minor(i, j);
            let factor = matrix[0][column];
            (factor * value, factor.abs() * size)
        });
        Self {
            value: terms.iter().map(|term| term.0).sum(),
            size: terms.iter().map(|term| term.1).sum(),
        }
    }
}
