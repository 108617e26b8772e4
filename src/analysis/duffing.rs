//! One mass on a hardening or softening spring (Duffing's oscillator): the period of free
//! vibration, its decay by dry friction, and the response to a harmonic force.
//!
//! ```text
//! m x'' + c x' + k x + c3 x³ + F = P cos ωt,    slip: F = F_k sgn x',  stick: |F| ≤ F_s
//! ```
//!
//! x is the displacement, m the mass, c the damping constant, k and c3 the coefficients of the
//! spring (c3 > 0 hardening, c3 < 0 softening), F_k the kinetic and F_s the largest static
//! friction, and P and ω the amplitude and angular frequency of the force. Any consistent units may
//! be used. A [`PolynomialSpring`](crate::PolynomialSpring) is this spring in a
//! [`Structure`](crate::Structure).
//!
//! Sources: I. Kovacic, M. J. Brennan (eds.), *The Duffing Equation: Nonlinear Oscillators and
//! their Behaviour*, Wiley, 2011; P. F. Byrd, M. D. Friedman, *Handbook of Elliptic Integrals for
//! Engineers and Scientists*, 2nd ed., Springer, 1971, integral 259.00; NIST Digital Library of
//! Mathematical Functions, <https://dlmf.nist.gov/19.8>, part (i).

use std::f64::consts::PI;

use crate::numerics::bracket::root_between;

/// Period of free vibration between −A and A, without damping and friction.
///
/// ```text
/// T = 2π√m/AGM(√(k + c3A²/2), √(k + c3A²))
/// ```
///
/// AGM is the arithmetic-geometric mean, m the mass, and A the amplitude. It is the elliptic
/// integral 4K/√((k + c3A²)/m) in another form, exact to rounding for any sign of k and c3, and
/// tends to 2π√(m/k) for small A. `None` unless m and A are positive, k + c3A² and k + c3A²/2 are
/// positive (the motion passes 0 and turns at ±A), and all are finite.
///
/// ```
/// use stick_slip::analysis::duffing::period;
///
/// let exact = 3.603712656168182309250034; // k = 1, c3 = 0.7, A = 2
/// assert!((period(1.0, 1.0, 0.7, 2.0).unwrap() - exact).abs() < 1e-15);
/// // F = x³ from x = 1: Γ(1/4)²/√π
/// assert!((period(1.0, 0.0, 1.0, 1.0).unwrap() - 7.416298709205487673735401).abs() < 1e-15);
/// // A softening spring of 1 and −0.1 has no force any more at √10.
/// assert_eq!(period(1.0, 1.0, -0.1, 10.0_f64.sqrt() + 1e-9), None);
/// ```
pub fn period(mass: f64, stiffness: f64, cubic: f64, amplitude: f64) -> Option<f64> {
    let is_in_range = mass > 0.0 && amplitude > 0.0 && amplitude.is_finite();
    let (spring, stiff) = Spring::in_units_of(amplitude, stiffness, cubic);
    let period = mass.sqrt() / stiff.sqrt() * (2.0 * spring.swing(1.0, -1.0));
    (is_in_range && spring.turns() && period.is_finite()).then_some(period)
}

/// Free vibration with dry friction and without damping: times and displacements of the turning
/// points, beginning with the start at rest, (0, A).
///
/// From a turning point q to the next, −σb with σ = sgn q and a = |q|, the mass takes the time T:
///
/// ```text
/// c3(a² + b²)(a − b)/4 + k(a − b)/2 = F_k
/// T = π√(m/2)/AGM(√(RS), ½√(k + ¾c3(a − b)² + 2RS))
/// R² = k/2 + c3(3a² − 2ab + b²)/4,   S² = k/2 + c3(a² − 2ab + 3b²)/4
/// ```
///
/// The first equation says that the energy of the spring falls by the work of friction, F_k(a + b).
/// b < 0 is a turning point on the same side of 0. The last point is the position of rest: the
/// first point with |kq + c3q³| ≤ F_s. The iterator does not end if the mass never comes to rest,
/// as without friction. Exact; each point has the rounding errors of its predecessors.
///
/// `None` unless m > 0, k ≥ 0, F_s ≥ F_k ≥ 0, k + c3A² > 0, and all are finite. A may have either
/// sign.
///
/// ```
/// use stick_slip::analysis::duffing::friction_decay;
///
/// let turns: Vec<_> = friction_decay(1.0, 1.0, 0.7, 0.2, 0.3, 2.0).unwrap().collect();
/// assert_eq!(turns.len(), 10);
/// assert_eq!(turns[0], (0.0, 2.0));
/// let (time, place) = turns[1];
/// assert!((time - 1.833785850644122670715418).abs() < 1e-15);
/// assert!((place + 1.890435302421613144919983).abs() < 1e-15);
/// let (time, rest) = turns[9];
/// assert!((time - 20.51800251660914522608970).abs() < 1e-13);
/// assert!((rest + 0.2731430534395801674532629).abs() < 1e-14);
/// ```
#[doc(alias = "coulomb")]
pub fn friction_decay(
    mass: f64,
    stiffness: f64,
    cubic: f64,
    kinetic_friction: f64,
    static_friction: f64,
    start: f64,
) -> Option<impl Iterator<Item = (f64, f64)> + use<>> {
    let (spring, stiff) = Spring::in_units_of(start, stiffness, cubic);
    let unit = mass.sqrt() / stiff.sqrt();
    let is_in_range = mass > 0.0
        && unit.is_finite()
        && stiffness >= 0.0
        && kinetic_friction >= 0.0
        && static_friction >= kinetic_friction
        && static_friction.is_finite()
        && start.is_finite()
        && spring.turns();
    // Forces, displacements and times in units of the force at A, of A and of √(m/(k + c3A²)).
    let [kinetic, most] = [kinetic_friction, static_friction].map(|f| f / stiff / start.abs());
    let next = move |&(time, turn): &(f64, f64)| {
        if spring.force(turn).abs() <= most {
            return None;
        }
        let a = turn.abs();
        let b = spring.next_turn(a, kinetic);
        Some((time + spring.swing(a, -b), -turn.signum() * b))
    };
    let turns = is_in_range.then(|| std::iter::successors(Some((0.0, 1.0)), next));
    turns.map(|turns| turns.map(move |(time, turn)| (unit * time, start * turn)))
}

/// An amplitude of the response to a harmonic force, by first-harmonic theory.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Response {
    /// Amplitude A of the first harmonic of x, in units of displacement.
    pub amplitude: f64,
    /// Estimate of the amplitude of the third harmonic, in units of displacement. Its order,
    /// relative to A, is c3A²/k + F_k/(kA), unless the third harmonic is in resonance, mω² ≈ k/9.
    /// The largest displacement differs from A by as much, if no other odd harmonic is in resonance
    /// either.
    pub third_harmonic: f64,
    /// Estimate of the error of A, in units of displacement: the third harmonic's contribution to
    /// the balance of forces, divided by dP/dA. Away from resonance, that of the third harmonic
    /// too, its order, relative to A, is (c3A²/k)² + (F_k/(kA))². It is larger near resonance, and
    /// infinite at a fold.
    pub error: f64,
}

/// Amplitudes of the response to a harmonic force, ascending: up to three, by first-harmonic
/// theory.
///
/// ```text
/// (k + ¾c3A² − mω²)²A² + (cωA + 4F_k/π)² = P²
/// ```
///
/// m is the mass, c the damping constant, k and c3 the coefficients of the spring, F_k the kinetic
/// friction, and P and ω the amplitude and angular frequency of the force. The equation is solved
/// to rounding; the errors of the theory are estimated in [`Response`]. Of three motions the middle
/// one is unstable. The theory applies to motions without stick: at the turning points the force of
/// the spring and the harmonic force together must exceed the static friction.
///
/// The list is empty if there is no such motion, as for P ≤ 4F_k/π, and unless m, P and ω are
/// positive, c ≥ 0, F_k ≥ 0, and all are finite.
///
/// ```
/// use stick_slip::analysis::duffing::response;
///
/// // m = 1, c = 0.05, k = 1, c3 = 0.5, F_k = 0.1, P = 0.6, ω = 1.4
/// let [low, middle, high] = response(1.0, 0.05, 1.0, 0.5, 0.1, 0.6, 1.4)[..] else { panic!() };
/// assert!((low.amplitude - 0.783).abs() < 1e-3); // exact: 0.780 at most
/// assert!((high.amplitude - 1.831).abs() < 1e-3); // exact: 1.859 at most
/// assert!(low.amplitude < middle.amplitude && middle.amplitude < high.amplitude);
/// assert!(high.third_harmonic < 0.06 && high.error < 0.06);
/// ```
///
/// Source: A. H. Nayfeh, D. T. Mook, *Nonlinear Oscillations*, Wiley, 1979, chapter 4; the friction
/// term: J. P. Den Hartog, *Forced vibrations with combined Coulomb and viscous friction*, Trans.
/// ASME 53 (1931), APM-53-9, 107-115.
#[doc(alias = "harmonic_balance")]
pub fn response(
    mass: f64,
    damping: f64,
    stiffness: f64,
    cubic: f64,
    friction: f64,
    force: f64,
    angular_frequency: f64,
) -> Vec<Response> {
    let given = [mass, damping, stiffness, cubic, friction, force];
    let is_in_range = given.iter().all(|x| x.is_finite())
        && angular_frequency.is_finite()
        && [mass, force, angular_frequency].iter().all(|&x| x > 0.0)
        && damping >= 0.0
        && friction >= 0.0;
    if !is_in_range {
        return Vec::new();
    }
    let inertia = mass * angular_frequency * angular_frequency;
    let balance = Balance {
        net: stiffness - inertia,
        cubic: 0.75 * cubic,
        drag: damping * angular_frequency,
        friction: 4.0 / PI * friction,
    };
    let of = |amplitude: f64| {
        let square = amplitude * amplitude;
        let stiff = stiffness + 1.5 * cubic * square - 9.0 * inertia;
        let driven = (0.25 * cubic * square * amplitude).hypot(balance.friction / 3.0);
        let third_harmonic = driven / stiff.hypot(3.0 * balance.drag);
        let unbalanced = balance.cubic.abs() * square + 3.0 * balance.friction / amplitude;
        let slope = balance.slope(amplitude) / force;
        Response {
            amplitude,
            third_harmonic,
            error: third_harmonic * (unbalanced / slope).abs(),
        }
    };
    balance.amplitudes(force).into_iter().map(of).collect()
}

/// A spring, in units of an amplitude and of its stiffness k + c3A² there: k + c3 = 1, and no
/// square overflows.
#[derive(Debug, Clone, Copy)]
struct Spring {
    stiffness: f64,
    cubic: f64,
}

impl Spring {
    /// The spring in units of an amplitude A, and k + c3A².
    fn in_units_of(amplitude: f64, stiffness: f64, cubic: f64) -> (Self, f64) {
        let added = cubic * amplitude * amplitude;
        let unit = stiffness + added;
        let spring = Self {
            stiffness: stiffness / unit,
            cubic: added / unit,
        };
        (spring, unit)
    }

    fn force(&self, x: f64) -> f64 {
        (self.stiffness + self.cubic * x * x) * x
    }

    /// Returns true if a mass at rest at ±1 swings through 0 and, without friction, back.
    fn turns(&self) -> bool {
        self.stiffness + 0.5 * self.cubic > 0.0 && self.cubic.is_finite()
    }

    /// b, the turning point after a on the other side.
    fn next_turn(&self, a: f64, friction: f64) -> f64 {
        // In the unknown a − b, of which a small value has no rounding error.
        let mut residual = |loss: f64| {
            let b = a - loss;
            let mean = 0.5 * self.stiffness + 0.25 * self.cubic * (a * a + b * b);
            Ok(loss * mean - friction)
        };
        // At 0 it is −F_k, and at 2a the force of the spring exceeds F_k.
        a - root_between(&mut residual, 0.0, 2.0 * a).unwrap_or(0.0)
    }

    /// Time from rest at a to the next turning point, x < a.
    ///
    /// v² is (2/m)(a − q)(q − x)Q(q) at the place q, with a quadratic Q: a complete elliptic
    /// integral.
    fn swing(&self, a: f64, x: f64) -> f64 {
        let cubic = 0.25 * self.cubic;
        // Q at the place q, one of the two ends.
        let at = |q: f64| {
            let sum = a + x + q;
            let squares = a * a + x * x + q * q + sum * sum;
            (0.5 * (self.stiffness + cubic * squares)).sqrt()
        };
        let product = at(a) * at(x);
        let sum = a + x;
        let other = 0.5 * (self.stiffness + 3.0 * cubic * sum * sum + 2.0 * product).sqrt();
        0.5_f64.sqrt() * PI / arithmetic_geometric_mean(product.sqrt(), other)
    }
}

/// The terms of the balance of first harmonics.
#[derive(Debug, Clone, Copy)]
struct Balance {
    /// k − mω².
    net: f64,
    /// ¾c3.
    cubic: f64,
    /// cω.
    drag: f64,
    /// 4F_k/π.
    friction: f64,
}

impl Balance {
    /// The amplitude of the force that maintains the amplitude A.
    fn force(&self, amplitude: f64) -> f64 {
        let elastic = (self.net + self.cubic * amplitude * amplitude) * amplitude;
        elastic.hypot(self.drag * amplitude + self.friction)
    }

    /// The derivative of this force by A, times the force.
    fn slope(&self, amplitude: f64) -> f64 {
        let added = self.cubic * amplitude * amplitude;
        let elastic = (self.net + added) * (self.net + 3.0 * added) * amplitude;
        elastic + self.drag * (self.drag * amplitude + self.friction)
    }

    /// The amplitudes that a force maintains, ascending.
    fn amplitudes(&self, force: f64) -> Vec<f64> {
        // The slope, a polynomial of degree 5, rises or falls throughout between these points.
        let root = ((7.0 * self.net * self.net - 5.0 * self.drag * self.drag) / 3.0).sqrt();
        let bends = [-root, root].map(|root| (root - 2.0 * self.net) / (5.0 * self.cubic));
        let mut points: Vec<f64> = bends.map(f64::sqrt).to_vec();
        points.retain(|x| x.is_finite());
        points.push(0.0);
        points.sort_by(f64::total_cmp);
        // Beyond the last amplitude the force rises for ever.
        let scales = [
            force / self.net.abs(),
            (force / self.cubic.abs()).cbrt(),
            force / self.drag,
        ];
        let smallest = scales.into_iter().fold(f64::MAX, f64::min);
        let mut last = points.iter().fold(smallest, |last, x| last.max(*x));
        last = last.max(f64::MIN_POSITIVE);
        while last.is_finite() && !(self.force(last) > force && self.slope(last) > 0.0) {
            last *= 2.0;
        }
        if !last.is_finite() {
            return Vec::new();
        }
        points.push(last);
        let mut monotonic = vec![0.0];
        monotonic.extend(roots(&|x| self.slope(x), &points));
        monotonic.push(last);
        let mut found = roots(&|x| self.force(x) - force, &monotonic);
        // The smallest numbers have no sign change but at 0.
        found.retain(|amplitude| *amplitude > 0.0);
        found
    }
}

/// The roots of a function that rises or falls throughout between neighbouring points.
fn roots(f: &dyn Fn(f64) -> f64, points: &[f64]) -> Vec<f64> {
    let pieces = points.windows(2);
    let changing = pieces.filter(|ends| (f(ends[0]) < 0.0) != (f(ends[1]) < 0.0));
    let found = changing.map(|ends| root_between(&mut |x| Ok(f(x)), ends[0], ends[1]));
    found.filter_map(Result::ok).collect()
}

/// The common limit of a' = (a + b)/2, b' = √(ab).
fn arithmetic_geometric_mean(mut a: f64, mut b: f64) -> f64 {
    while (a - b).abs() > 4.0 * f64::EPSILON * a {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    0.5 * (a + b)
}
