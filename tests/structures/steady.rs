//! Steady sliding: displacements, eigenvalues, flutter and Hopf points.

use approx::assert_abs_diff_eq;
use proptest::{prop_assert, prop_assert_eq};
use stick_slip::nalgebra::{Complex, DMatrix};
use stick_slip::structure::NotSliding;
use stick_slip::{
    AnyContactLaw, AnyLaw, Contact, Coulomb, Drive, Dwell, Error, Exponential, FrictionLaw, LuGre,
    Polynomial, Structure, structure as structures,
};

use crate::common::property::for_all;
use crate::common::{exactly, number, on_belt, one_mass, oscillator, text};
use crate::reading::{Raised, cases, structure};

fn bifurcations(kind: &str) -> Vec<serde_json::Value> {
    let mut all = cases(include_str!("../data/structure_bifurcations.json"));
    all.retain(|case| text(&case["type"]) == kind);
    all
}

/// The eigenvalue that is nearest to the imaginary axis, and oscillates.
fn marginal(structure: &Structure) -> Complex<f64> {
    let sliding = structure.steady_sliding().unwrap();
    let oscillating = sliding.eigenvalues.iter().filter(|value| value.im > 0.0);
    *oscillating
        .min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()))
        .unwrap()
}

#[test]
fn drill_strings_have_their_hopf_points() {
    let mut seen = 0;
    for case in bifurcations("hopf") {
        if case["system"].is_null() {
            continue;
        }
        seen += 1;
        let (value, omega) = (number(&case["value"]), number(&case["omega"]));
        let at = |velocity| marginal(&structure(&case["system"], velocity));
        let there = at(value);
        assert!(there.re.abs() < 2e-15, "{there}");
        assert!((there.im - omega).abs() < 4e-15, "{there} {omega}");
        // The real part goes through 0 there.
        assert!(at(value + 1e-6).re * at(value - 1e-6).re < 0.0);
    }
    assert_eq!(seen, 2);
}

/// Two unit masses with N = N0 + n1·q_1 on coordinate 0, as the reference file has them.
fn mode_coupling(case: &serde_json::Value, coefficient: f64) -> Structure {
    let value = |name: &str| number(&case[name]);
    let stiffness = [value("k11"), value("k12"), value("k21"), value("k22")];
    let law = Coulomb::new(coefficient, coefficient).unwrap();
    let contact = Contact::new(0, law, 10.0)
        .and_then(|contact| contact.with_load_gradient(1, value("n1")))
        .unwrap()
        .on_belt(0.3);
    Structure::new(&[1.0, 1.0])
        .and_then(|structure| structure.with_stiffness(DMatrix::from_row_slice(2, 2, &stiffness)))
        .and_then(|structure| structure.with_ground_damper(0, value("c1")))
        .and_then(|structure| structure.with_ground_damper(1, value("c2")))
        .and_then(|structure| structure.with_contact(contact))
        .unwrap()
}

#[test]
fn modes_merge_at_the_reference_coefficients() {
    let flutter = bifurcations("flutter");
    let [undamped] = exactly(&flutter);
    let (value, omega) = (number(&undamped["value"]), number(&undamped["omega"]));
    // Below: purely imaginary, to the bit. Above: growth as the root of the distance.
    let sliding = |case, coefficient| mode_coupling(case, coefficient).steady_sliding().unwrap();
    let below = sliding(undamped, value - 1e-6);
    assert!(below.eigenvalues.iter().all(|value| value.re == 0.0));
    assert!(!below.is_stable());
    let above = sliding(undamped, value + 1e-6);
    assert!(above.eigenvalues[0].re > 1e-4);
    assert_abs_diff_eq!(above.eigenvalues[0].im.abs(), omega, epsilon = 1e-6);

    let mut damped = bifurcations("hopf");
    damped.retain(|case| case["system"].is_null());
    let [damped] = exactly(&damped);
    let (value, omega) = (number(&damped["value"]), number(&damped["omega"]));
    let there = marginal(&mode_coupling(damped, value));
    assert!(
        there.re.abs() < 1e-14 && (there.im - omega).abs() < 1e-14,
        "{there}"
    );
    let stable = |coefficient| sliding(damped, coefficient).is_stable();
    assert!(stable(value - 1e-9) && !stable(value + 1e-9));
}

#[test]
fn what_does_not_slide_steadily_has_no_steady_sliding() {
    let contact = || Contact::new(0, Coulomb::new(0.4, 0.3).unwrap(), 1.0).unwrap();
    let sprung = || oscillator([1.0, 0.0, 1.0], 0.0).unwrap();
    let steady = |structure: Structure| structure.steady_sliding();
    let why = |structure: Structure| match structure.steady_sliding() {
        Err(Error::NoSteadySliding(reason)) => reason,
        other => panic!("{other:?}"),
    };
    assert!(steady(sprung().with_contact(contact().on_belt(0.2)).unwrap()).is_ok());
    // A surface at rest; a drive; no spring; a load that pulls.
    let at_rest = why(sprung().with_contact(contact()).unwrap());
    assert_eq!(at_rest, NotSliding::NoSpeed { contact: 0 });
    let shaken = contact().on_belt(Drive::sine(0.1, 1.0).unwrap());
    let driven = why(sprung().with_contact(shaken).unwrap());
    assert_eq!(driven, NotSliding::Driven);
    let free = Structure::new(&[1.0, 1.0])
        .and_then(|structure| structure.with_spring(0, 1, 2.0))
        .and_then(|structure| structure.with_contact(contact().on_belt(0.2)))
        .unwrap();
    assert_eq!(why(free), NotSliding::Singular);
    // As a whole free to turn, though springs join all and dampers hold it: no place of its own.
    let string = Structure::new(&[2.0, 1.0])
        .and_then(|s| s.with_spring(0, 1, 2.0)?.with_ground_damper(0, 0.5))
        .and_then(|s| s.with_contact(contact().on_belt(0.2)))
        .unwrap();
    assert_eq!(why(string.clone()), NotSliding::Singular);
    assert!(steady(string.with_ground_spring(0, 1e-3).unwrap()).is_ok());
    let lifted = contact().with_load_gradient(0, -10.0).unwrap().on_belt(0.2);
    let lifted = sprung()
        .with_force(0, 1.0)
        .and_then(|s| s.with_contact(lifted))
        .unwrap();
    // q = (1 + 0.3)/(1 + 3), N = 1 − 10q < 0
    let NotSliding::NoLoad { contact: 0, load } = why(lifted) else {
        panic!()
    };
    assert!((load - (1.0 - 10.0 * 1.3 / 4.0)).abs() < 1e-14, "{load}");
    // Without contacts: the rest position.
    let rest = sprung()
        .with_force(0, 0.5)
        .unwrap()
        .steady_sliding()
        .unwrap();
    assert_eq!(rest.displacements, [0.5]);
    assert_eq!(rest.eigenvalues[0], Complex::new(0.0, 1.0));
}

#[test]
fn a_hundred_masses_have_the_frequencies_of_a_chain() {
    let n = 100;
    let mut chain: Structure = Structure::new(&vec![2.0; n]).unwrap();
    for i in 0..n - 1 {
        chain = chain.with_spring(i, i + 1, 3.0).unwrap();
    }
    for i in [0, n - 1] {
        chain = chain.with_ground_spring(i, 3.0).unwrap();
    }
    for i in 0..n {
        chain = chain.with_ground_damper(i, 0.02).unwrap();
    }
    let sliding = chain.steady_sliding().unwrap();
    assert!(sliding.is_stable());
    let mut found: Vec<f64> = sliding.eigenvalues.iter().map(|value| value.im).collect();
    found.sort_by(f64::total_cmp);
    // Backward error of the Schur form: a few 2n·ε of the norm, 2√(k/m).
    let allowed = 4.0 * (2 * n) as f64 * f64::EPSILON * 2.0 * 1.5_f64.sqrt();
    for (k, found) in found[n..].iter().enumerate() {
        // ω_k = 2√(k/m) sin(kπ/(2(n + 1))), damped by c/(2m) each
        let angle = std::f64::consts::PI * (k + 1) as f64 / (2 * (n + 1)) as f64;
        let undamped = 2.0 * 1.5_f64.sqrt() * angle.sin();
        let expected = (undamped * undamped - 0.005 * 0.005).sqrt();
        assert!(
            (found - expected).abs() < allowed,
            "{k}: {found} {expected}"
        );
    }
}

/// The mass on its belt is the structure of one coordinate.
#[test]
fn one_mass_has_the_equilibrium_of_the_belt() {
    for_all(
        256,
        [-1.0..1.0, 1e-3..3.0, 0.0..1.5, 0.01..10.0, 0.0..3.0],
        |[side, speed, damping, load, kind]| {
            let belt_velocity = speed.copysign(side);
            let law: AnyLaw = match kind as u32 {
                0 => Polynomial::new(0.4, 0.25, 0.5).unwrap().into(),
                1 => Exponential::new(0.4, 0.25, 0.5).unwrap().into(),
                _ => Coulomb::new(0.4, 0.25).unwrap().into(),
            };
            let belt = on_belt(law, belt_velocity, damping, load);
            let expected = belt.equilibrium().unwrap();
            let found = Structure::from(&belt).steady_sliding().unwrap();
            prop_assert_eq!(&found.displacements, &[expected.displacement]);
            let h1 = -expected.jacobian[(1, 1)];
            for value in expected.eigenvalues {
                let nearest = found.eigenvalues.iter().map(|other| (other - value).norm());
                let nearest = nearest.fold(f64::INFINITY, f64::min);
                // Near h1 = ±2 both eigenvalues are nearly equal.
                let apart = (expected.eigenvalues[0] - expected.eigenvalues[1]).norm();
                let size = 1.0 + h1.abs();
                let allowed = (8.0 * f64::EPSILON * size * size / apart).min(4e-8 * size);
                prop_assert!(nearest <= allowed, "{} {:e} {:e}", value, nearest, allowed);
            }
            prop_assert_eq!(found.is_stable(), expected.is_stable());
            Ok(())
        },
    );
}

/// Another unit of time, mass and length gives the same, in those units.
#[test]
fn units_scale_the_result() {
    for_all(
        256,
        [
            0.2..3.0,
            0.2..3.0,
            0.2..3.0,
            0.2..3.0,
            0.01..0.5,
            0.01..0.5,
            0.1..5.0,
            0.1..5.0,
            -30.0..30.0,
            -30.0..30.0,
            -30.0..30.0,
        ],
        |[k1, k2, k3, k4, c1, c2, m1, m2, units @ ..]| {
            let (stiffness, damping, masses) = ([k1, k2, k3, k4], [c1, c2], [m1, m2]);
            let [m, t, l] = units.map(|power| 2.0_f64.powi(power.floor() as i32));
            let force = m * l / (t * t);
            let made = |m: f64, t: f64, l: f64, force: f64| {
                let law = Exponential::new(0.4, 0.25, 0.5 * l / t).unwrap();
                let contact = Contact::new(0, law, force)
                    .and_then(|c| c.with_load_gradient(1, 0.1 * force / l))
                    .unwrap()
                    .on_belt(0.3 * l / t);
                let k = DMatrix::from_row_slice(2, 2, &stiffness) + DMatrix::identity(2, 2) * 4.0;
                Structure::new(&masses.map(|mass| mass * m))
                    .and_then(|s| s.with_stiffness(k * (m / (t * t))))
                    .and_then(|s| s.with_ground_damper(0, damping[0] * m / t))
                    .and_then(|s| s.with_damper(0, 1, damping[1] * m / t))
                    .and_then(|s| s.with_contact(contact))
                    .unwrap()
                    .steady_sliding()
                    .unwrap()
            };
            let (one, other) = (made(1.0, 1.0, 1.0, 1.0), made(m, t, l, force));
            for (one, other) in one.displacements.iter().zip(other.displacements) {
                prop_assert!((one - other / l).abs() <= 1e-14 * one.abs().max(0.1));
            }
            for (one, other) in one.eigenvalues.iter().zip(other.eigenvalues) {
                prop_assert!((one - other * t).norm() <= 1e-12, "{} {}", one, other * t);
            }
            Ok(())
        },
    );
}

/// δq' = δv, and with the bristles of `LuGre` as the theory has them about steady sliding:
/// ∂z'/∂v = V g'/g, ∂z'/∂z = −σ0 V/g.
#[test]
fn bristles_have_an_eigenvalue_of_their_own() {
    let g = AnyLaw::from(Exponential::new(0.5, 0.3, 0.4).unwrap());
    let [stiffness, damping, viscous] = [40.0, 0.3, 0.02];
    let law = LuGre::new(g.clone(), stiffness, damping, viscous).unwrap();
    for (speed, mass, spring, ground, load) in [
        (0.2, 1.5, 3.0, 0.1, 2.0),
        (-0.05, 0.2, 8.0, 0.3, 1.0),
        (1.3, 4.0, 0.5, 0.02, 6.0),
    ] {
        let contact = Contact::new(0, law.clone(), load).unwrap().on_belt(speed);
        let one = one_mass([mass, ground, spring], 0.0, contact).unwrap();
        let sliding = one.steady_sliding().unwrap();
        let v = f64::abs(speed);
        let (g0, slope) = (g.kinetic(v), g.slope(v));
        let held = load * (g0 + viscous * v) * speed.signum() / spring;
        assert_abs_diff_eq!(sliding.displacements[0], held, epsilon = 4e-15 * held.abs());
        let (by_velocity, by_z) = (v * slope / g0, -stiffness * v / g0);
        // The matrix [[0, 1, 0], [−k/m, −a, −b], [0, p, q]] by its invariants.
        let a = (ground + load * (damping * by_velocity + viscous)) / mass;
        let b = load * (stiffness + damping * by_z) / mass;
        let k = spring / mass;
        let [&x, &y, &z] = exactly(&sliding.eigenvalues);
        let found = [x + y + z, x * y + y * z + z * x, x * y * z];
        let expected = [by_z - a, k - a * by_z + b * by_velocity, k * by_z];
        for (found, expected) in std::iter::zip(found, expected) {
            assert!(
                (found - expected).norm() < 1e-12 * expected.abs().max(1.0),
                "{speed}"
            );
        }
    }
}

/// Small motions of a chain go as its slowest eigenvalues say.
#[test]
fn small_motions_with_memory_have_the_eigenvalues() {
    let dry = Raised::from(Coulomb::new(0.4, 0.4).unwrap());
    let bristles = LuGre::new(dry.clone(), 25.0, 0.2, 0.05).unwrap();
    let laws = [bristles.into(), AnyContactLaw::Dry(dry)];
    let mut pair = Structure::new(&[1.0, 2.0])
        .and_then(|s| s.with_ground_spring(0, 1.0)?.with_spring(0, 1, 1.0))
        .and_then(|s| s.with_ground_damper(0, 0.1)?.with_ground_damper(1, 3.0))
        .unwrap();
    for (i, law) in laws.into_iter().enumerate() {
        let contact = Contact::new(i, law, 1.0).unwrap().on_belt(2.0);
        pair = pair.with_contact(contact).unwrap();
    }
    let sliding = pair.steady_sliding().unwrap();
    assert_eq!(sliding.eigenvalues.len(), 6);
    assert_eq!(sliding.eigenvalues[5].re, f64::NEG_INFINITY);
    assert!(sliding.is_stable());
    let mut q = sliding.displacements.clone();
    q[0] += 1e-3;
    let start = structures::State::new(&q, &[0.0, 0.0]).with_memory(&[-0.4 / 25.0, 0.0]);
    let (first, apart) = (4.0, 0.7);
    let motion = pair.simulate(start, first + 5.0 * apart).unwrap();
    // Of five finite eigenvalues: their characteristic polynomial is 0 on six samples.
    let sample = |k: usize| {
        let state = motion.state_at(first + apart * k as f64).unwrap();
        state.displacements[0] - sliding.displacements[0]
    };
    let mut polynomial = vec![Complex::new(1.0, 0.0)];
    for value in &sliding.eigenvalues[..5] {
        let root = (value * apart).exp();
        polynomial.push(Complex::new(0.0, 0.0));
        for i in (1..polynomial.len()).rev() {
            let above = polynomial[i - 1];
            polynomial[i] -= root * above;
        }
    }
    let (mut sum, mut size) = (Complex::new(0.0, 0.0), 0.0_f64);
    for (i, factor) in polynomial.iter().enumerate() {
        let term = factor * sample(5 - i);
        sum += term;
        size = size.max(term.norm());
    }
    // μ̂ is constant: what is not linear is |r|z alone, of the order of the square.
    assert!(sum.norm() < 3e-3 * size, "{sum} {size:e}");
}

#[test]
fn a_clock_of_rest_is_forgotten() {
    let dry = AnyLaw::from(Exponential::new(0.4, 0.3, 0.5).unwrap());
    let one = |speed: f64| {
        let law = Dwell::exponential(dry.clone(), 0.6, 1.0).unwrap();
        let remembers = Contact::new(0, law, 1.0).unwrap();
        [remembers, Contact::new(0, dry.clone(), 1.0).unwrap()].map(|contact| {
            let one = one_mass([1.0, 0.0, 1.0], 0.0, contact.on_belt(speed));
            one.unwrap().steady_sliding().unwrap()
        })
    };
    let [found, expected] = one(0.3);
    assert_eq!(found.displacements, expected.displacements);
    assert_eq!(found.eigenvalues[..2], expected.eigenvalues[..]);
    assert_eq!(found.eigenvalues[2], Complex::new(f64::NEG_INFINITY, 0.0));
    assert!(!found.is_stable());
}

/// Each mass pushed by the one before it alone, in a ring of six: s⁶ = ±1 for √(−s²) and for s, on
/// which the QR method by itself does not move.
#[test]
fn a_ring_of_masses_has_roots_of_unity() {
    let ring = DMatrix::from_fn(6, 6, |i, j| f64::from(u8::from(i == (j + 1) % 6)));
    let undamped: Structure = Structure::new(&[1.0; 6])
        .and_then(|structure| structure.with_stiffness(ring))
        .unwrap();
    let found = undamped.steady_sliding().unwrap().eigenvalues;
    assert_eq!(found.len(), 12);
    for s in &found {
        assert!(((s * s).powu(6) - 1.0).norm() < 1e-12, "{found:?}");
    }
    // As blocks of the matrix of first order: s³ = −1 for each of two masses in turn.
    let turn = DMatrix::from_row_slice(3, 3, &[0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0]);
    let damped: Structure = Structure::new(&[1.0; 3])
        .and_then(|structure| structure.with_stiffness(turn))
        .and_then(|structure| structure.with_damping(DMatrix::identity(3, 3) * 1e-300))
        .unwrap();
    let found = damped.steady_sliding().unwrap().eigenvalues;
    for s in &found {
        assert!(((s * s).powu(3) + 1.0).norm() < 1e-12, "{found:?}");
    }
}

/// Along a belt that slows down and speeds up again, stability changes at the Hopf velocities.
#[test]
fn stability_changes_where_the_belt_passes_its_hopf_velocities() {
    let law = stick_slip::Exponential::new(0.4, 0.25, 0.5).unwrap();
    let mass = stick_slip::MassOnBelt::new(law, 1.0).and_then(|mass| mass.with_damping(0.05));
    let hopf = stick_slip::bifurcation::hopf_velocities(&mass.unwrap(), 0.01..1.5).unwrap();
    let [&low, &high] = exactly(&hopf);
    let belt = Drive::profile(&[(0.0, 1.5), (100.0, 0.0), (150.0, -1.5)]).unwrap();
    let contact = Contact::new(0, law, 1.0).unwrap().on_belt(belt);
    let system = one_mass([1.0, 0.1, 1.0], 0.0, contact).unwrap();
    let found = system.stability_changes(-10.0..200.0).unwrap();
    let slow = |velocity: f64| 100.0 * (1.5 - velocity) / 1.5;
    let fast = |velocity: f64| 100.0 + 50.0 * velocity / 1.5;
    let expected = [
        (slow(high), false),
        (slow(low), true),
        (fast(low), false),
        (fast(high), true),
    ];
    assert_eq!(found.len(), expected.len(), "{found:?}");
    for (found, (time, becomes_stable)) in std::iter::zip(found, expected) {
        assert!((found.time - time).abs() < 1e-11, "{found:?} {time}");
        assert_eq!(found.becomes_stable, becomes_stable);
        assert_abs_diff_eq!(found.frequency, 1.0, epsilon = 1e-12);
    }
    for (start, end) in [
        (0.0, 0.0),
        (1.0, 0.0),
        (f64::NAN, 1.0),
        (0.0, f64::INFINITY),
    ] {
        assert!(system.stability_changes(start..end).is_err());
    }
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(system.frozen(bad).is_err());
    }
    // The phase of a harmonic overflows.
    let fast = Drive::sine(1e-200, 1e300).unwrap();
    let fast = Structure::new(&[1.0]).and_then(|mass| mass.with_force(0, fast));
    let error = fast.unwrap().stability_changes(0.0..1e10).unwrap_err();
    assert!(matches!(error, Error::BadElement { .. }), "{error}");
}

/// A contact whose load vanishes is open: steady sliding goes on, and only the damper is left.
#[test]
fn stability_changes_where_a_load_vanishes() {
    let load = Drive::profile(&[(10.0, 1.0), (10.0, 0.0)]).unwrap();
    let law = Exponential::new(0.4, 0.25, 0.5).unwrap();
    let contact = Contact::new(0, law, load).unwrap().on_belt(0.4);
    let system = one_mass([1.0, 0.1, 1.0], 0.0, contact).unwrap();
    let found = system.stability_changes(0.0..20.0).unwrap();
    let [change] = exactly(&found);
    assert!(change.becomes_stable);
    assert_abs_diff_eq!(change.time, 10.0, epsilon = 1e-14);
}
