//! What every friction law must satisfy, and what each of the crate's laws says of itself.

use crate::common::masses::PAD;
use crate::common::polynomials::Polynomials;
use crate::common::{Decay, friction_law, larger};
use approx::assert_abs_diff_eq;
use stick_slip::{
    AnyLaw, Coulomb, EventKind, Exponential, FrictionLaw, Integrator, MassOnBelt, Mode, Physical,
    Polynomial, Rational, Scaling, State, Step, Stribeck, Tabulated, Trajectory,
};

friction_law! {
    /// 1/(1 + δ s) written as a quotient, with a static coefficient above μ̂(0).
    Quotient: 0.5, |s| (s + 0.4) / (s.square() * 2.0 + s * 0.5 + 1.0)
}

/// Stiff enough a table to be unlike the laws it could be taken from, with a rise at its end.
fn measured() -> [(f64, f64); 6] {
    [
        (0.0, 0.4),
        (0.05, 0.36),
        (0.15, 0.31),
        (0.3, 0.27),
        (0.6, 0.25),
        (1.0, 0.26),
    ]
}

#[test]
fn every_law_conforms() {
    let polynomial = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    let tustin = Stribeck::new(0.4, 0.25, 0.5, 1).unwrap();
    let leine = Rational::new(0.4, 1.0).unwrap();
    let popp_stelter = leine
        .with_offset(0.2)
        .unwrap()
        .with_quadratic(0.02)
        .unwrap();
    let table = Tabulated::new(measured()).unwrap();
    let raised = table.clone().with_static_coefficient(0.45).unwrap();

    conforms("polynomial", &polynomial, 0.5);
    conforms(
        "exponential",
        &Exponential::new(0.4, 0.25, 0.5).unwrap(),
        0.5,
    );
    conforms("Coulomb", &Coulomb::new(0.4, 0.25).unwrap(), 0.5);
    for exponent in [1, 2, 3, 8] {
        let law = Stribeck::new(0.4, 0.25, 0.5, exponent).unwrap();
        let scale = 0.5 / f64::from(exponent);
        conforms(&format!("Stribeck {exponent}"), &law, scale);
        let law = law.with_viscous_coefficient(0.05).unwrap();
        conforms(&format!("Stribeck {exponent}, viscous"), &law, scale);
    }
    conforms("Leine", &leine, 0.5);
    conforms("Popp and Stelter", &popp_stelter, 0.5);
    conforms("table", &table, 0.1);
    conforms("table, μ_s raised", &raised, 0.1);
    let lines = Tabulated::piecewise_linear(measured()).unwrap();
    conforms("table of lines", &lines, 0.1);

    let all: [AnyLaw; 6] = [
        polynomial.into(),
        Exponential::new(0.4, 0.25, 0.5).unwrap().into(),
        Coulomb::new(0.4, 0.25).unwrap().into(),
        tustin.into(),
        popp_stelter.into(),
        table.clone().into(),
    ];
    for law in &all {
        conforms(&format!("{law:?}"), law, 0.1);
    }

    conforms("reference", &&polynomial, 0.5);
    conforms("reference to a table", &&table, 0.1);
    conforms("reference to any", &&AnyLaw::from(table.clone()), 0.1);

    // Laws in m/s, where 1 is 0.2 m/s.
    let brake = Scaling::new(PAD).unwrap();
    let in_metres = Polynomial::new(0.4, 0.25, 0.1).unwrap();
    conforms("scaled polynomial", &brake.law(in_metres), 0.5);
    let slower = measured().map(|(speed, mu)| (0.2 * speed, mu));
    conforms(
        "scaled table",
        &brake.law(Tabulated::new(slower).unwrap()),
        0.1,
    );
    conforms(
        "scaled any",
        &brake.law(AnyLaw::from(Tabulated::new(slower).unwrap())),
        0.1,
    );
    conforms("scaled reference", &brake.law(&in_metres), 0.5);

    conforms("own quotient", &Quotient, 0.3);
    let decay = Decay {
        static_coefficient: 0.4,
        kinetic_coefficient: 0.25,
        velocity: 0.3,
    };
    conforms("own decay", &decay, 0.3);
    let kinked = Polynomials::new(0.4, &[0.4, -0.6])
        .then(0.15, &[0.31, -0.2])
        .then(0.4, &[0.26, 0.1])
        .told();
    conforms("own kinked", &kinked, 0.1);
}

/// A law whose type is not known, so that what is asked of all laws is compiled once.
trait Known {
    fn static_coefficient(&self) -> f64;
    fn breakpoints(&self) -> Vec<f64>;
    fn kinetic(&self, speed: f64) -> f64;
    fn kinetic_on(&self, piece: usize, speed: f64) -> f64;
    fn coefficient(&self, relative_velocity: f64) -> f64;
    fn derivative(&self, order: usize, speed: f64) -> f64;
    fn slope(&self, speed: f64) -> f64;
    fn curvature(&self, speed: f64) -> f64;
    /// The motion from rest, on a belt of velocity [`BELT`].
    fn motion(&self, duration: f64) -> Trajectory;
}

const BELT: f64 = 0.2;
const DAMPING: f64 = 0.05;

struct Given<'l, L>(&'l L);

impl<L: FrictionLaw + Clone> Known for Given<'_, L> {
    fn static_coefficient(&self) -> f64 {
        self.0.static_coefficient()
    }
    fn breakpoints(&self) -> Vec<f64> {
        self.0.breakpoints().collect()
    }
    fn kinetic(&self, speed: f64) -> f64 {
        self.0.kinetic(speed)
    }
    fn kinetic_on(&self, piece: usize, speed: f64) -> f64 {
        self.0.kinetic_on(piece, speed)
    }
    fn coefficient(&self, relative_velocity: f64) -> f64 {
        self.0.coefficient(relative_velocity)
    }
    fn derivative(&self, order: usize, speed: f64) -> f64 {
        self.0.derivative(order, speed)
    }
    fn slope(&self, speed: f64) -> f64 {
        self.0.slope(speed)
    }
    fn curvature(&self, speed: f64) -> f64 {
        self.0.curvature(speed)
    }
    fn motion(&self, duration: f64) -> Trajectory {
        let system =
            MassOnBelt::new(self.0.clone(), BELT).and_then(|system| system.with_damping(DAMPING));
        let motion = system.and_then(|system| system.simulate(State::new(0.0, 0.0), duration));
        motion.unwrap()
    }
}

/// All that a law must satisfy, at speeds up to a few times `scale`, the speed over which it
/// changes.
fn conforms<L: FrictionLaw + Clone>(name: &str, law: &L, scale: f64) {
    known_conforms(name, &Given(law), scale);
}

fn known_conforms(name: &str, law: &dyn Known, scale: f64) {
    let mu_s = law.static_coefficient();
    assert!(mu_s.is_finite() && mu_s >= 0.0, "{name}");
    assert!(
        law.kinetic(0.0) <= mu_s * (1.0 + 4.0 * f64::EPSILON),
        "{name}"
    );
    is_odd(name, law);

    let breakpoints = law.breakpoints();
    assert!(breakpoints.is_sorted_by(|a, b| a < b), "{name}");
    assert!(breakpoints.iter().all(|&b| b > 0.0), "{name}");
    for (piece, &b) in breakpoints.iter().enumerate() {
        let (below, above) = (law.kinetic_on(piece, b), law.kinetic_on(piece + 1, b));
        assert!((below - above).abs() <= 1e-14 * mu_s, "{name} jumps at {b}");
        assert!(
            (law.kinetic(b) - above).abs() <= 1e-14 * mu_s,
            "{name} at {b}"
        );
    }

    let starts = std::iter::once(0.0).chain(breakpoints.iter().copied());
    for (piece, start) in starts.enumerate() {
        let end = breakpoints.get(piece).copied();
        let width = end.map_or(6.0 * scale, |end| end - start);
        let h = width.min(scale) / 40.0;
        for place in [0.0, 0.15, 0.31, 0.5, 0.78] {
            derivatives_agree(name, law, start + place * width, h, mu_s, start);
        }
    }
    moves_by_the_equation_of_motion(name, law);
}

fn is_odd(name: &str, law: &dyn Known) {
    for speed in [1e-300, 1e-9, 0.1, 0.3, 0.77, 2.0] {
        let [forward, backward] = [speed, -speed].map(|v| law.coefficient(v));
        assert_eq!(forward, -backward, "{name} at {speed}");
        assert_eq!(forward, law.kinetic(speed), "{name} at {speed}");
    }
    assert_eq!(law.coefficient(0.0), 0.0, "{name}");
    assert_eq!(law.coefficient(-0.0), 0.0, "{name}");
}

/// Derivatives against differences of the coefficient, and each order against differences of the
/// one below.
fn derivatives_agree(name: &str, law: &dyn Known, s: f64, h: f64, mu_s: f64, start: f64) {
    let at = |n| law.derivative(n, s);
    // powi of f64 and the products of the series may round differently.
    assert!(
        (at(0) - law.kinetic(s)).abs() <= 4.0 * f64::EPSILON * mu_s,
        "{name} at {s}"
    );
    assert_eq!(at(1), law.slope(s), "{name} at {s}");
    assert_eq!(at(2), law.curvature(s), "{name} at {s}");
    assert!(at(31).is_nan(), "{name}: only 31 orders");

    // Nine points around s, or above it where the piece begins.
    let first = ((start - s) / h).ceil().clamp(-4.0, 0.0);
    let nodes: [f64; 9] = std::array::from_fn(|i| (first + i as f64) * h);
    for n in 1..=6 {
        // The size of a derivative of this order, for the errors of differences.
        let size = mu_s * (1..=n).map(|k| k as f64).product::<f64>() / (40.0 * h).powi(n as i32);
        let by_values = || {
            let weights = difference_weights(n, &nodes);
            sum(weights, nodes, |t| law.kinetic(s + t))
        };
        let by_last_order = || {
            let weights = difference_weights(1, &nodes);
            sum(weights, nodes, |t| law.derivative(n - 1, s + t))
        };
        if n <= 3 {
            let error = (at(n) - by_values()).abs() / size;
            assert!(
                error < 1e-7,
                "{name}: order {n} at {s} is off by {error:e} from values"
            );
        }
        let error = (at(n) - by_last_order()).abs() / size.max(at(n).abs());
        assert!(error < 1e-6, "{name}: order {n} at {s} is off by {error:e}");
    }
}

fn sum(weights: [f64; 9], nodes: [f64; 9], f: impl Fn(f64) -> f64) -> f64 {
    std::iter::zip(weights, nodes).map(|(w, t)| w * f(t)).sum()
}

/// Weights of the n-th derivative at 0 from values at the nodes (Fornberg, Math. Comp. 51 (1988)
/// 699-706).
fn difference_weights(n: usize, nodes: &[f64; 9]) -> [f64; 9] {
    let mut weights = vec![[0.0; 9]; n + 1];
    weights[0][0] = 1.0;
    let mut c1 = 1.0;
    for i in 1..nodes.len() {
        let mut c2 = 1.0;
        for j in 0..i {
            let c3 = nodes[i] - nodes[j];
            c2 *= c3;
            for k in (0..=n.min(i)).rev() {
                let lower = if k > 0 { weights[k - 1] } else { [0.0; 9] };
                if j == i - 1 {
                    weights[k][i] =
                        c1 * (k as f64 * lower[i - 1] - nodes[i - 1] * weights[k][i - 1]) / c2;
                }
                weights[k][j] = (nodes[i] * weights[k][j] - k as f64 * lower[j]) / c3;
            }
        }
        c1 = c2;
    }
    weights[n]
}

/// The law drives a mass: from rest it sticks, is released and goes on, and satisfies its equation.
fn moves_by_the_equation_of_motion(name: &str, law: &dyn Known) {
    let motion = law.motion(30.0);
    let kinds: Vec<EventKind> = motion.events().iter().map(|event| event.kind).collect();
    assert_eq!(kinds.first(), Some(&EventKind::Stick), "{name}");
    assert!(kinds.len() >= 2, "{name}: {kinds:?}");

    let mut slips = 0;
    for step in motion.steps() {
        match step.mode() {
            Mode::Stick => assert_eq!(step.state().velocity, BELT, "{name}"),
            Mode::Slip(_) => {
                slips += 1;
                satisfies(name, law, step);
            }
            Mode::Open => panic!("{name}: a belt's contact does not open"),
        }
    }
    assert!(slips > 5, "{name}");
    // A state at the end of one step is that at the start of the next.
    for pair in motion.steps().windows(2) {
        let (end, start) = (pair[0].state_at(pair[0].duration()), pair[1].state());
        assert!(
            (end.displacement - start.displacement).abs() < 1e-14,
            "{name}"
        );
        assert!((end.velocity - start.velocity).abs() < 1e-14, "{name}");
    }
}

/// u' = v and u'' + 2β u' + u + γ²μ(u' − v_b) = 0 at three places of the step, the derivatives by
/// differences of nine states.
fn satisfies(name: &str, law: &dyn Known, step: &Step) {
    let duration = step.duration();
    let h = (duration / 8.0).min(0.0075);
    let nodes: [f64; 9] = std::array::from_fn(|i| (i as f64 - 4.0) * h);
    let weights = difference_weights(1, &nodes);
    for middle in [4.0 * h, 0.5 * duration, duration - 4.0 * h] {
        let state = step.state_at(middle);
        let u_dot = sum(weights, nodes, |t| step.state_at(middle + t).displacement);
        let v_dot = sum(weights, nodes, |t| step.state_at(middle + t).velocity);
        let friction = law.coefficient(state.velocity - BELT);
        let force = 2.0 * DAMPING * state.velocity + state.displacement + friction;

        // What rounding of the states makes of their differences.
        let allowed = 4.0 * f64::EPSILON / h;
        let (first, second) = ((u_dot - state.velocity).abs(), (v_dot + force).abs());
        let at = step.start_time() + middle;
        assert!(
            first < allowed,
            "{name} at {at}: u' off by {first:e}, h = {h}"
        );
        assert!(
            second < allowed,
            "{name} at {at}: v' off by {second:e}, h = {h}"
        );
    }
}

#[test]
fn stribeck_has_the_values_of_its_formula() {
    for exponent in [1, 2, 3, 7] {
        let law = Stribeck::new(0.5, 0.2, 0.25, exponent).unwrap();
        let law = law.with_viscous_coefficient(0.125).unwrap();
        for s in [0.0, 0.1, 0.25, 0.3, 1.0] {
            let power = f64::powf(s / 0.25, f64::from(exponent));
            let expected = 0.2 + 0.3 * (-power).exp() + 0.125 * s;
            assert!(
                (law.kinetic(s) - expected).abs() < 1e-15,
                "{exponent} at {s}"
            );
        }
    }
}

#[test]
fn stribeck_with_exponent_2_is_the_exponential_law() {
    let stribeck = Stribeck::new(0.4, 0.25, 0.3, 2).unwrap();
    let exponential = Exponential::new(0.4, 0.25, 0.3).unwrap();
    for i in 0..50 {
        let s = 0.03 * f64::from(i);
        for (n, size) in [1.0, 1.0, 20.0, 400.0].into_iter().enumerate() {
            let (a, b) = (stribeck.derivative(n, s), exponential.derivative(n, s));
            assert!((a - b).abs() < 1e-15 * size, "order {n} at {s}: {a} {b}");
        }
    }
}

/// (s/v_s)^δ overflows far before a speed does.
#[test]
fn stribeck_is_finite_far_above_its_velocity() {
    for exponent in [1, 2, 3, 20, 400, (1 << 31) - 1] {
        let law = Stribeck::new(0.4, 0.25, 1e-3, exponent).unwrap();
        for speed in [1e-4, 0.99e-3, 1.01e-3, 0.1, 1.0, 1e6, 1e60] {
            let (mu, slope) = (law.kinetic(speed), law.slope(speed));
            assert!(
                (0.25..=0.4 + 1e-16).contains(&mu),
                "{exponent}: {mu} at {speed}"
            );
            assert!(
                slope <= 0.0 && slope.is_finite(),
                "{exponent}: {slope} at {speed}"
            );
            if speed > 1.0 {
                assert_eq!((mu, slope), (0.25, 0.0));
            }
        }
        MassOnBelt::new(law, 0.2).unwrap();
    }
}

#[test]
fn rational_has_the_values_of_its_formula() {
    for (mu_s, decay, offset, quadratic) in [
        (0.4, 3.0, 0.0, 0.0),
        (0.4, 3.0, 0.15, 0.0),
        (0.4, 3.0, 0.15, 0.02),
        (1.0, 0.5, 0.0, 0.3),
    ] {
        let law = Rational::new(mu_s, decay)
            .and_then(|law| law.with_offset(offset)?.with_quadratic(quadratic))
            .unwrap();
        for s in [0.0, 1e-3, 0.2, 1.0, 7.0] {
            let expected = (mu_s - offset) / (1.0 + decay * s) + offset + quadratic * s * s;
            assert!(
                (law.kinetic(s) / expected - 1.0).abs() < 4e-16,
                "{law:?} {s}"
            );
            let slope = -(mu_s - offset) * decay / (1.0 + decay * s).powi(2) + 2.0 * quadratic * s;
            assert!((law.slope(s) - slope).abs() < 4e-15, "{law:?} {s}");
        }
    }
}

#[test]
fn table_goes_through_its_points_and_between_them_only_as_they_do() {
    let noisy = [
        (0.0, 0.40),
        (0.02, 0.41),
        (0.1, 0.28),
        (0.11, 0.28),
        (0.5, 0.2801),
        (0.51, 0.25),
        (0.9, 0.0),
        (1.0, 0.3),
    ];
    for points in [measured().to_vec(), noisy.to_vec(), noisy[..2].to_vec()] {
        let law = Tabulated::new(points.iter().copied()).unwrap();
        for pair in points.windows(2) {
            let ((s0, mu0), (s1, mu1)) = (pair[0], pair[1]);
            assert_eq!(law.kinetic(s0), mu0);
            let mut last = mu0;
            for i in 1..=100 {
                let mu = law.kinetic(s0 + (s1 - s0) * f64::from(i) / 100.0);
                assert!(
                    (mu - last) * (mu1 - mu0).signum() >= -1e-16,
                    "{mu} after {last}"
                );
                assert!(
                    (mu - mu0) * (mu - mu1) <= 1e-16,
                    "{mu} is not between {mu0} and {mu1}"
                );
                last = mu;
            }
        }
        // The slope is continuous too.
        for (piece, b) in law.breakpoints().enumerate() {
            let [below, above] = [-1.0, 1.0].map(|side| {
                let (h, near) = (1e-7 * b, |t: f64| {
                    law.kinetic_on(piece + usize::from(side > 0.0), b + side * t)
                });
                (near(h) - near(0.0)) / (side * h)
            });
            assert!(
                (below - above).abs() < 1e-4 * (1.0 + above.abs()),
                "at {b}: {below} {above}"
            );
        }
    }
}

/// PCHIP slopes by hand, for unequal intervals.
#[test]
fn table_has_the_slopes_of_pchip() {
    let law = Tabulated::new([(0.0, 0.5), (1.0, 0.3), (3.0, 0.2), (4.0, 0.2)]).unwrap();
    // Chords −0.2, −0.05, 0 of lengths 1, 2, 1.
    assert_abs_diff_eq!(law.slope(0.0), (-(4.0 * 0.2) + 0.05) / 3.0, epsilon = 1e-16);
    assert!((law.slope(1.0) - 9.0 / (5.0 / -0.2 + 4.0 / -0.05)).abs() < 1e-16);
    assert_eq!(law.slope(3.0), 0.0);
    assert_eq!(law.slope(4.0), 0.0);

    // A first chord much flatter than the second: the parabola would rise.
    let late = Tabulated::new([(0.0, 0.5), (1.0, 0.49), (2.0, 0.1)]).unwrap();
    assert_eq!(late.slope(0.0), 0.0);
    // And where the second turns, the slope is at most three times the chord's.
    let turning = Tabulated::new([(0.0, 0.5), (1.0, 0.49), (2.0, 0.9)]).unwrap();
    assert!((turning.slope(0.0) + 0.03).abs() < 1e-15);
    // Less where the second turns a little: chords −0.1 and 0.05.
    let little = Tabulated::new([(0.0, 0.5), (1.0, 0.4), (2.0, 0.45)]).unwrap();
    assert!((little.slope(0.0) + 0.175).abs() < 1e-15);
}

/// Measured points of a smooth law, ever denser: the error falls as h³ at least where the law is
/// monotone.
#[test]
fn table_converges_to_the_law_it_was_taken_from() {
    let law = Stribeck::new(0.4, 0.25, 0.5, 1).unwrap();
    let error = |n: u32| {
        let points = (0..=n).map(|i| f64::from(i) / f64::from(n));
        let table = Tabulated::new(points.map(|s| (s, law.kinetic(s)))).unwrap();
        // Up to the last interval, where the table levels off.
        let last = 1.0 - 1.0 / f64::from(n);
        (0..1000)
            .map(|i| last * f64::from(i) / 1000.0)
            .map(|s| (table.kinetic(s) - law.kinetic(s)).abs())
            .fold(0.0, larger)
    };
    let errors = [8, 16, 32, 64].map(error);
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1]).log2() > 2.7, "{errors:?}");
    }
    assert!(errors[3] < 1e-6, "{errors:?}");
}

#[test]
fn table_of_lines_has_the_values_and_slopes_of_its_chords() {
    let law = Tabulated::piecewise_linear(measured()).unwrap();
    for (piece, pair) in measured().windows(2).enumerate() {
        let ((s0, mu0), (s1, mu1)) = (pair[0], pair[1]);
        for part in [0.0, 0.25, 0.5, 0.75] {
            let s = s0 + part * (s1 - s0);
            assert_abs_diff_eq!(law.kinetic(s), mu0 + part * (mu1 - mu0), epsilon = 1e-16);
            assert_eq!(law.slope(s), (mu1 - mu0) / (s1 - s0));
            assert_eq!((law.curvature(s), law.derivative(3, s)), (0.0, 0.0));
        }
        // From below too.
        assert_abs_diff_eq!(law.kinetic_on(piece, s1), mu1, epsilon = 1e-16);
    }
    assert!(law.is_piecewise_linear());
    assert!(!Tabulated::new(measured()).unwrap().is_piecewise_linear());
}

#[test]
fn table_is_constant_above_its_last_point() {
    for law in [Tabulated::new, Tabulated::piecewise_linear] {
        let law = law(measured()).unwrap();
        for speed in [1.0, 1.0 + f64::EPSILON, 2.0, 1e300] {
            assert_eq!((law.kinetic(speed), law.slope(speed)), (0.26, 0.0));
        }
        assert!(law.kinetic(f64::NAN).is_nan());
        assert_eq!(law.points(), measured());
        assert_eq!(law.clone().with_static_coefficient(0.4).unwrap(), law);
    }
}

/// However fast and however far, the force and the acceleration are numbers, or infinite where they
/// overflow.
#[test]
fn forces_are_numbers_at_any_state() {
    let table = || Tabulated::new([(0.0, 0.4), (0.5, 0.3), (1.0, 0.35)]).unwrap();
    let stribeck = |exponent: u32| {
        let law = Stribeck::new(0.4, 0.25, 0.5, exponent).unwrap();
        law.with_viscous_coefficient(0.1).unwrap()
    };
    let rational = Rational::new(0.4, 1.0).unwrap();
    let laws: Vec<AnyLaw> = vec![
        Polynomial::new(0.4, 0.25, 0.5).unwrap().into(),
        Polynomial::new(0.4, 0.25, 1e100).unwrap().into(),
        Exponential::new(0.4, 0.25, 0.5).unwrap().into(),
        Exponential::new(0.4, 0.25, 1e150).unwrap().into(),
        Coulomb::new(0.4, 0.25).unwrap().into(),
        rational.into(),
        rational.with_quadratic(0.1).unwrap().into(),
        stribeck(1).into(),
        stribeck(2).into(),
        stribeck(3).into(),
        table().into(),
    ];
    let sizes = [5e-324, 1e-200, 1e-154, 1.0, 1e154, 1e200, 1e300, f64::MAX];
    for law in laws {
        let system = MassOnBelt::new(law.clone(), 0.2).unwrap();
        let system = system.with_damping(0.05).unwrap();
        for (velocity, displacement) in sizes.iter().flat_map(|&v| sizes.map(|u| (v, u))) {
            for (u, v) in [(displacement, velocity), (-displacement, velocity)] {
                for state in [State::new(u, v), State::new(u, -v)] {
                    let numbers = [system.friction_force(state), system.acceleration(state)];
                    assert!(numbers.iter().all(|x| !x.is_nan()), "{law:?} {state:?}");
                    let opposes = numbers[0] * (state.velocity - 0.2) <= 0.0;
                    assert!(opposes, "{law:?} {state:?}");
                }
            }
        }
    }
    // 0 times a square that overflows.
    let flat = Polynomial::new(0.4, 0.4, 0.5).unwrap();
    assert_eq!(flat.kinetic(1e153), 0.4);
    assert!(flat.kinetic(1e155).is_nan());
    // Up to the largest v_s, friction falls to μ_k before anything overflows.
    let wide = Exponential::new(0.4, 0.25, 1e150).unwrap();
    assert!((wide.kinetic(1e150) - (0.25 + 0.15 * (-1.0_f64).exp())).abs() < 1e-16);
    assert_eq!(wide.kinetic(1e154), 0.25);
}

/// Every number that is refused: tests/contract/refusals.rs.
#[test]
fn borders_are_allowed() {
    Stribeck::new(0.0, 0.0, f64::MIN_POSITIVE, (1 << 31) - 1).unwrap();
    assert_eq!(Rational::new(0.4, 0.0).unwrap().kinetic(9.0), 0.4);
    Polynomial::new(0.4, 0.4, 0.5).unwrap();
    Coulomb::new(0.0, 0.0).unwrap();
    for tolerance in [Integrator::MIN_TOLERANCE, Integrator::MAX_TOLERANCE, 1e-9] {
        Integrator::new().with_tolerance(tolerance).unwrap();
    }
    let still = Physical {
        damping: 0.0,
        belt_velocity: 0.0,
        ..PAD
    };
    Scaling::new(still).unwrap();
}

/// The enum is the law inside, to the bit, in values, pieces and motion.
#[test]
fn any_law_is_the_law_inside() {
    fn same<L: FrictionLaw + Into<AnyLaw> + Clone>(law: L) {
        let any: AnyLaw = law.clone().into();
        assert_eq!(any.static_coefficient(), law.static_coefficient());
        assert!(any.breakpoints().eq(law.breakpoints()));
        for s in [0.0, 0.03, 0.2, 0.7, 3.0] {
            assert_eq!(any.kinetic(s), law.kinetic(s));
            assert_eq!(any.kinetic_on(1, s), law.kinetic_on(1, s));
        }
        let [a, b] = [
            MassOnBelt::new(any, 0.2)
                .unwrap()
                .simulate(State::new(0.0, 0.0), 20.0),
            MassOnBelt::new(law, 0.2)
                .unwrap()
                .simulate(State::new(0.0, 0.0), 20.0),
        ];
        assert_eq!(a, b);
    }
    same(Coulomb::new(0.4, 0.25).unwrap());
    same(Exponential::new(0.4, 0.25, 0.5).unwrap());
    same(Polynomial::new(0.4, 0.25, 0.5).unwrap());
    same(Rational::new(0.4, 1.0).unwrap());
    same(Stribeck::new(0.4, 0.25, 0.5, 3).unwrap());
    same(Tabulated::new(measured()).unwrap());
}
