//! Jenkins elements and Iwan's joint: closed forms against each other, against quadrature, against
//! sliders followed one by one, against 25-digit cycles and for hostile input.

use approx::assert_abs_diff_eq;
use std::f64::consts::{PI, TAU};

use proptest::{prop_assert, prop_assert_eq};
use serde_json::Value;
use stick_slip::analysis::jenkins::{
    SymmetricResponse, backbone, first_harmonic, loop_area, masing,
};
use stick_slip::nalgebra::{Complex, DMatrix, DVector, Matrix2};
use stick_slip::{Error, Iwan4};

use crate::common::orbit::integrate;
use crate::common::property::for_all;
use crate::common::{Random, count, json, list, number, some, text};

/// ∫ between a and b, in pieces that end at the given places.
fn between(a: f64, b: f64, kinks: &[f64], f: impl Fn(f64) -> f64) -> f64 {
    let mut ends = vec![a];
    ends.extend(kinks.iter().filter(|&&x| a < x && x < b));
    ends.push(b);
    ends.sort_by(f64::total_cmp);
    let piece = |ends: &[f64]| integrate(ends[1] - ends[0], |x| f(ends[0] + x));
    ends.windows(2).map(piece).sum()
}

/// The forces of springs with sliders, each followed by itself: it is stretched, and slips at its
/// limit.
fn sliders(elements: &[(f64, f64)], displacements: &[f64]) -> Vec<f64> {
    let mut carried = vec![0.0; elements.len()];
    let mut last = 0.0;
    let step = |&x: &f64| {
        for (force, (stiffness, limit)) in carried.iter_mut().zip(elements) {
            *force = (*force + stiffness * (x - last)).clamp(-limit, *limit);
        }
        last = x;
        carried.iter().sum()
    };
    displacements.iter().map(step).collect()
}

fn polygon(elements: &[(f64, f64)], x: f64) -> f64 {
    elements.iter().map(|(k, f)| (k * x).clamp(-f, *f)).sum()
}

/// Energy per cycle of elements side by side.
fn dissipated(elements: &[(f64, f64)], amplitude: f64) -> f64 {
    let areas = elements.iter().map(|&(k, f)| loop_area(k, f, amplitude));
    areas.sum()
}

fn case(id: &str) -> Value {
    let all = json(include_str!("../data/joint_cycles.json"));
    let found = list(&all["cases"])
        .iter()
        .find(|case| text(&case["id"]) == id);
    found.unwrap().clone()
}

#[test]
fn the_loop_that_another_tool_prints() {
    let displacements = [0.0, 5.0, 3.5, 2.0, -5.0, -3.5, -2.0, 0.0];
    let expected = [0.0, 3.0, 0.0, -3.0, -3.0, 0.0, 3.0, 3.0];
    let forces = masing(|x| (2.0 * x).clamp(-3.0, 3.0), &displacements).unwrap();
    assert_eq!(forces, expected);
    assert_eq!(sliders(&[(2.0, 3.0)], &displacements), expected);
}

#[test]
fn masings_rules_are_sliders_side_by_side() {
    let mut random = Random::new(1);
    for _ in 0..300 {
        let count = 1 + random.bits() % 6;
        let element = |_| (random.logarithmic(0.1, 3.0), random.logarithmic(0.01, 3.0));
        let elements: Vec<(f64, f64)> = (0..count).map(element).collect();
        let size = random.logarithmic(0.03, 30.0);
        let mut displacements: Vec<f64> = (0..200).map(|_| random.uniform(-size, size)).collect();
        // Ends that are met again to the bit, the same place twice, and the origin.
        displacements[50] = displacements[20];
        displacements[51] = displacements[20];
        displacements[90] = -displacements[20];
        displacements[120] = 0.0;
        let forces = masing(|x| polygon(&elements, x), &displacements).unwrap();
        let scale: f64 = elements.iter().map(|(k, f)| f + k * size).sum();
        for (a, b) in forces.iter().zip(sliders(&elements, &displacements)) {
            assert!((a - b).abs() < 1e-13 * scale, "{elements:?}: {a} {b}");
        }
    }
}

#[test]
fn a_history_that_is_not_finite_has_no_forces() {
    assert_eq!(masing(|x| x, &[]), Some(vec![]));
    for bad in [f64::NAN, f64::INFINITY, -f64::INFINITY] {
        assert_eq!(masing(|x| x, &[0.0, 1.0, bad, 0.0]), None);
    }
    // No distance overflows.
    let far = masing(|x| x.clamp(-1.0, 1.0), &[f64::MAX, -f64::MAX, f64::MAX]);
    assert_eq!(far, Some(vec![1.0, -1.0, 1.0]));
}

#[test]
fn loop_areas_enclose_what_masing_draws() {
    for_all(
        200,
        [0.1..10.0, 0.1..10.0, 1.0001..50.0],
        |[k_t, limit, part]| {
            let amplitude = part * limit / k_t;
            // The corners of the loop.
            let corner = amplitude - 2.0 * limit / k_t;
            let corners = [amplitude, corner, -amplitude, -corner, amplitude];
            let forces = masing(|x| (k_t * x).clamp(-limit, limit), &corners).unwrap();
            let pairs = corners.windows(2).zip(forces.windows(2));
            let area: f64 = pairs
                .map(|(x, force)| 0.5 * (force[0] + force[1]) * (x[1] - x[0]))
                .sum();
            let expected = loop_area(k_t, limit, amplitude);
            prop_assert!((area - expected).abs() < 1e-14 * 4.0 * limit * amplitude);
            // Below the limit nothing.
            prop_assert_eq!(loop_area(k_t, limit, 0.999 * limit / k_t), 0.0);
            prop_assert_eq!(loop_area(1.0, f64::MAX, k_t), 0.0);
            prop_assert_eq!(first_harmonic(k_t, f64::MAX, 1.0, 1.0), (k_t, 0.0, 0.0));
            Ok(())
        },
    );
}

#[test]
fn the_first_harmonic_is_that_of_the_loop() {
    for_all(
        300,
        [-1.0..1.0, -1.0..1.0, -2.0..8.0, -2.0..2.0],
        |[k_t, limit, part, omega]| {
            let [k_t, limit, omega] = [k_t, limit, omega].map(|x: f64| 10_f64.powf(x));
            let amplitude = (1.0 + 10_f64.powf(part)) * limit / k_t;
            let (stiffness, damping, loss) = first_harmonic(k_t, limit, amplitude, omega);
            prop_assert_eq!(loss, loop_area(k_t, limit, amplitude));
            // The half period after the turn at A: unloading until cos φ = 1 − 2F_s/(k_t A).
            let part = limit / (k_t * amplitude);
            let corner = 2.0 * part.sqrt().asin();
            let force = |phase: f64| {
                let fallen = 2.0 * amplitude * (0.5 * phase).sin().powi(2);
                (limit - k_t * fallen).max(-limit)
            };
            let of = |weight: fn(f64) -> f64| {
                2.0 / PI * between(0.0, PI, &[corner], |phase| weight(phase) * force(phase))
            };
            let [cosine, sine] = [of(f64::cos), of(f64::sin)];
            // T = k_eq A cos φ − c_eq ω A sin φ; the quadrature is off by rounding of F_s.
            let noise = 1e-14 * limit;
            prop_assert!((stiffness * amplitude - cosine).abs() < noise);
            prop_assert!((damping * omega * amplitude + sine).abs() < noise);
            let by_damper = PI * omega * damping * amplitude * amplitude;
            prop_assert!((by_damper / loss - 1.0).abs() < 1e-14 / (1.0 - part));
            Ok(())
        },
    );
}

#[test]
fn harmonics_have_their_limits() {
    // k_eq/k_t for A ≫ F_s/k_t: (16/3π)(F_s/k_t A)^{3/2} to the leading order.
    for part in [1e-8, 1e-12, 1e-100, 1e-200] {
        let (stiffness, ..) = first_harmonic(1.0, part, 1.0, 1.0);
        let leading = 16.0 / (3.0 * PI) * part * part.sqrt();
        assert!((stiffness / leading - 1.0).abs() < part + 1e-14, "{part}");
    }
    // Continuous where slip begins.
    for gap in [1e-3, 1e-8, 1e-15] {
        let (stiffness, damping, _) = first_harmonic(2.0, 2.0, 1.0 + gap, 1.0);
        assert!((0.0..4.0 * gap.powf(1.5) + 1e-15).contains(&(2.0 - stiffness)));
        assert!((0.0..6.0 * gap).contains(&damping));
    }
    assert_eq!(first_harmonic(2.0, 2.0, 1.0, 3.0), (2.0, 0.0, 0.0));
    assert_eq!(first_harmonic(2.0, 2.0, 1e-300, 3.0), (2.0, 0.0, 0.0));
    let bad = [f64::NAN, f64::INFINITY, -f64::INFINITY, 0.0, -0.0, -1.0];
    for i in 0..4 {
        for x in bad {
            let mut given = [1.0, 2.0, 3.0, 4.0];
            given[i] = x;
            let [a, b, c, d] = given;
            let (stiffness, damping, loss) = first_harmonic(a, b, c, d);
            assert!(stiffness.is_nan() && damping.is_nan() && loss.is_nan());
            assert_eq!(loop_area(a, b, c).is_nan(), i < 3);
            let refused = [
                backbone(x, 0.1, 1.0, a, b, c),
                backbone(1.0, 0.1, 1.0, a, b, c),
            ];
            assert_eq!(refused.map(|point| point.is_none()), [true, i < 3]);
        }
    }
    for x in [f64::NAN, f64::INFINITY, -1.0] {
        assert_eq!(backbone(1.0, x, 1.0, 1.0, 1.0, 2.0), None);
        assert_eq!(backbone(1.0, 0.1, x, 1.0, 1.0, 2.0), None);
    }
    assert!(backbone(1.0, 0.0, 0.0, 1.0, 1.0, 2.0).is_some());
}

#[test]
fn the_backbone_is_where_the_force_is_in_quadrature() {
    let (m, c, k, k_t, limit) = (1.3, 0.02, 0.6, 0.4, 0.3);
    for amplitude in [0.2, 0.76, 1.0, 3.0, 100.0] {
        let point = backbone(m, c, k, k_t, limit, amplitude).unwrap();
        let omega = point.angular_frequency;
        let (added, damper, loss) = first_harmonic(k_t, limit, amplitude, omega);
        assert_abs_diff_eq!(k + added, m * omega * omega, epsilon = 1e-15);
        // The energy per cycle is 4πζ times that of the spring.
        let energy = 0.5 * m * (omega * amplitude).powi(2);
        let total = loss + PI * c * omega * amplitude * amplitude;
        assert!((point.damping_ratio - total / (4.0 * PI * energy)).abs() < 1e-15);
        assert!((2.0 * m * omega * point.damping_ratio - c - damper).abs() < 1e-15);
    }
}

#[test]
fn the_exact_response_is_the_25_digit_cycle() {
    let case = case("jc_01");
    let response = SymmetricResponse::at(1.0, 0.02, 0.6, 0.4, 0.3, 0.4, 0.88).unwrap();
    let near = |a: f64, b: f64, what: &str| assert!((a - b).abs() < 2e-15, "{what}: {a}, not {b}");
    near(
        0.25 * response.amplitude,
        0.25 * number(&case["q_max"][0]),
        "A",
    );
    let events = list(&case["events"]);
    let [stick, release] = [1, 2].map(|i| number(&events[i]["t"]));
    near(response.elastic_time, release - stick, "τ");
    for (found, given) in response.multipliers.iter().zip(list(&case["multipliers"])) {
        near(found.re, number(&given["re"]), "multiplier");
        near(found.im, number(&given["im"]), "multiplier");
    }
    let loss = loop_area(0.4, 0.3, response.amplitude);
    near(loss, number(&case["dissipated"][0]), "D");
    // The turn at A lies in the same phase of the force.
    let phase = (0.88 * stick).rem_euclid(TAU);
    near(response.phase.rem_euclid(TAU), phase, "θ");
}

/// (x, v, cos, sin, 1) after a time, under the force a cos ωt + b sin ωt + d and the stiffness κ.
fn flow([m, c, kappa, omega]: [f64; 4], [a, b, d]: [f64; 3], time: f64) -> DMatrix<f64> {
    let rows = [
        [0.0, 1.0, 0.0, 0.0, 0.0],
        [-kappa / m, -c / m, a / m, b / m, d / m],
        [0.0, 0.0, 0.0, -omega, 0.0],
        [0.0, 0.0, omega, 0.0, 0.0],
        [0.0; 5],
    ];
    // In units of the force, in which no entry is large.
    let unit = |i: usize| {
        if i < 2 {
            a.abs() + b.abs() + d.abs() + 1.0
        } else {
            1.0
        }
    };
    let matrix = DMatrix::from_fn(5, 5, |i, j| rows[i][j] * unit(j) / unit(i) * time);
    let flow = exponential(&matrix);
    DMatrix::from_fn(5, 5, |i, j| flow[(i, j)] * unit(i) / unit(j))
}

/// The matrix exponential: the power series of a part of the matrix, squared.
fn exponential(matrix: &DMatrix<f64>) -> DMatrix<f64> {
    let halvings = matrix.norm().max(1.0).log2().ceil() as i32 + 4;
    let part = matrix * (-f64::from(halvings)).exp2();
    let identity = DMatrix::identity(matrix.nrows(), matrix.ncols());
    // Horner's scheme: 1/20! is below the rounding errors.
    let mut sum = identity.clone();
    for k in (1..=20).rev() {
        sum = &identity + &part * sum / f64::from(k);
    }
    for _ in 0..halvings {
        sum = &sum * &sum;
    }
    sum
}

/// A response by the exponentials of its two arcs: how far it is from closing after half a period,
/// and its multipliers.
fn by_exponentials(
    [m, c, k, k_t, limit, force, omega]: [f64; 7],
    response: &SymmetricResponse,
) -> (f64, [Complex<f64>; 2]) {
    let amplitude = response.amplitude;
    let [a, b] = [force * response.phase.cos(), -force * response.phase.sin()];
    let elastic = [a, b, k_t * amplitude - limit];
    let stick = flow([m, c, k + k_t, omega], elastic, response.elastic_time);
    let rest = PI / omega - response.elastic_time;
    let slip = flow([m, c, k, omega], [a, b, limit], rest);
    let start = DVector::from_row_slice(&[amplitude, 0.0, 1.0, 0.0, 1.0]);
    let release = &stick * start;
    let end = &slip * &release;
    let apart = [
        release[0] - amplitude + 2.0 * limit / k_t,
        end[0] + amplitude,
        end[1] / omega,
    ];
    let apart = apart.into_iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    // The first column: by δx the spring begins to relax elsewhere.
    let column = |j: usize| [stick[(0, j)], stick[(1, j)]];
    let pushed = flow(
        [m, c, k + k_t, omega],
        [0.0, 0.0, k_t],
        response.elastic_time,
    );
    let [x, v] = [pushed[(0, 4)], pushed[(1, 4)]];
    let elastic = Matrix2::new(
        column(0)[0] + x,
        column(1)[0],
        column(0)[1] + v,
        column(1)[1],
    );
    let free = Matrix2::new(slip[(0, 0)], slip[(0, 1)], slip[(1, 0)], slip[(1, 1)]);
    let half = free * elastic;
    let (trace, determinant) = (half.trace(), half.determinant());
    let root = Complex::from(0.25 * trace * trace - determinant).sqrt();
    (
        apart,
        [root, -root].map(|root| (root + 0.5 * trace).powi(2)),
    )
}

#[test]
fn exact_responses_close_and_have_their_multipliers() {
    let mut random = Random::new(2);
    let mut slipping = 0;
    let cases = count(400, 2000);
    for _ in 0..cases {
        let m = random.logarithmic(0.3, 3.0);
        let c = random.pick(&[0.0, 1.0, 1.0]) * random.logarithmic(1e-3, 3.0);
        let k = random.pick(&[0.0, 1.0, 1.0, 1.0]) * random.logarithmic(0.1, 10.0);
        let k_t = random.logarithmic(0.03, 30.0);
        let limit = random.logarithmic(0.01, 100.0);
        let force = limit * random.logarithmic(0.1, 100.0);
        let omega = ((k + k_t) / m).sqrt() * random.logarithmic(0.4, 3.0);
        let given = [m, c, k, k_t, limit, force, omega];
        let Some(response) = SymmetricResponse::at(m, c, k, k_t, limit, force, omega) else {
            continue;
        };
        let amplitude = response.amplitude;
        if response.elastic_time == PI / omega {
            assert!(k_t * amplitude <= limit * (1.0 + 1e-15));
            continue;
        }
        slipping += 1;
        let (apart, multipliers) = by_exponentials(given, &response);
        // Close to resonance without damping a small change of the force moves A far.
        let static_shift = force / (k + k_t);
        let size = amplitude * (1.0 + amplitude / static_shift);
        assert!(apart < 1e-12 * size, "{given:?}: {apart:e} {response:?}");
        let [a, b, zero] = response.multipliers;
        assert_eq!(zero.norm(), 0.0);
        assert!(
            a.norm() >= b.norm() && a.norm() < 1.0 + 1e-9,
            "{given:?}: {a} {b}"
        );
        // By their sum and product, which are smooth where they meet.
        let [p, q] = multipliers;
        assert!(
            (a + b - p - q).norm() < 1e-11,
            "{given:?}: {a} {b}, not {p} {q}"
        );
        assert!((a * b - p * q).norm() < 1e-11, "{given:?}");
    }
    assert!(5 * slipping > 2 * cases, "{slipping}");
}

/// Steady motion of one mass by small steps, each exact but for the force of the element, which is
/// Moreau's: stretched, then cut to its limit. Half the range of displacements, and turns a period;
/// `None` if it has not settled.
fn settled([m, c, k, k_t, limit, force, omega]: [f64; 7]) -> Option<(f64, usize)> {
    const STEPS: usize = 4000;
    let period = TAU / omega;
    let h = period / STEPS as f64;
    let (mut x, mut v, mut carried) = (0.0_f64, 0.0_f64, 0.0_f64);
    // Implicit midpoint rule: with x̄ = x + h v̄/2, v̄ the mean velocity.
    let mut period_from = |turn: usize| {
        let (mut least, mut most, mut turns) = (x, x, 0);
        for i in 0..STEPS {
            let phase = TAU * (i as f64 + 0.5) / STEPS as f64 + TAU * turn as f64;
            let pull = force * phase.cos() - k * x;
            let mean = |element: f64, added: f64| {
                (2.0 * m * v / h + pull - element) / (2.0 * m / h + c + 0.5 * h * (k + added))
            };
            // The mean of the force over the step, in stick or in slip.
            let stuck = mean(carried, k_t);
            let next = (carried + k_t * h * stuck).clamp(-limit, limit);
            let speed = if next == carried + k_t * h * stuck {
                stuck
            } else {
                mean(0.5 * (carried + next), 0.0)
            };
            carried = next;
            x += h * speed;
            let before = v;
            v = 2.0 * speed - v;
            turns += usize::from(before * v < 0.0);
            (least, most) = (least.min(x), most.max(x));
        }
        (0.5 * (most - least), turns)
    };
    let mut last = (0.0, 0);
    for turn in 0..3000 {
        let now = period_from(turn);
        if turn > 20 && (now.0 - last.0).abs() < 1e-9 * now.0 && now.1 == last.1 {
            return Some(now);
        }
        last = now;
    }
    None
}

#[test]
fn there_is_a_response_exactly_where_the_motion_turns_twice() {
    let mut random = Random::new(3);
    let mut counts = [0; 2];
    for _ in 0..60 {
        let m = random.logarithmic(0.3, 3.0);
        let k = random.logarithmic(0.1, 3.0);
        let k_t = random.logarithmic(0.3, 10.0);
        let limit = random.logarithmic(0.1, 10.0);
        let force = limit * random.logarithmic(1.0, 10.0);
        let natural = (k / m).sqrt();
        let omega = natural * random.logarithmic(0.1, 2.0);
        let c = m * natural * random.logarithmic(0.02, 1.0);
        let given = [m, c, k, k_t, limit, force, omega];
        let Some((amplitude, turns)) = settled(given) else {
            continue;
        };
        let response = SymmetricResponse::at(m, c, k, k_t, limit, force, omega);
        counts[usize::from(turns == 2)] += 1;
        assert_eq!(
            response.is_some(),
            turns == 2,
            "{given:?}: {turns} turns, {response:?}"
        );
        if let Some(response) = response {
            // The step is 1/4000 of the period.
            let error = response.amplitude / amplitude - 1.0;
            assert!(error.abs() < 1e-4, "{given:?}: {error:e}");
        }
    }
    assert!(counts.iter().all(|&count| count > 10), "{counts:?}");
}

#[test]
fn more_force_moves_the_mass_farther() {
    let at = |force: f64, omega: f64| SymmetricResponse::at(1.0, 0.02, 0.6, 0.4, 0.3, force, omega);
    let omegas = count(4, 60);
    for i in 0..omegas {
        let omega = 0.3 + 1.8 * i as f64 / omegas as f64;
        let threshold = (1.0 - omega * omega).hypot(0.02 * omega) * 0.75;
        // Continuous where slip begins: the next number already slips.
        let [below, above] = [threshold.next_down(), threshold * (1.0 + 4e-16)];
        let [below, above] = [below, above].map(|force| at(force, omega).unwrap());
        assert!(
            (above.amplitude / below.amplitude - 1.0).abs() < 1e-12,
            "{omega}"
        );
        assert!((above.phase - below.phase).abs() < 1e-7, "{omega}");
        let mut last = below;
        for j in 1..400 {
            let Some(next) = at(threshold * 1.05_f64.powi(j), omega) else {
                assert!(omega < 0.5, "{omega} {j}");
                continue;
            };
            assert!(
                next.amplitude > last.amplitude,
                "{omega} {j}: {next:?} {last:?}"
            );
            assert!(next.elastic_time < last.elastic_time, "{omega} {j}");
            last = next;
        }
    }
}

#[test]
fn a_large_force_leaves_the_element_behind() {
    for omega in [0.5, 0.7, 0.9, 2.0] {
        let impedance = Complex::new(0.6 - omega * omega, 0.02 * omega);
        for force in [1e4, 1e8, 1e12] {
            let response = SymmetricResponse::at(1.0, 0.02, 0.6, 0.4, 0.3, force, omega).unwrap();
            // The element's first harmonic is at most 4 F_s/π.
            let bound = 4.0 / PI * 0.3 / impedance.norm() + 1e-9 * force;
            assert!((response.amplitude - force / impedance.norm()).abs() < bound);
            let limit = Complex::new(0.0, -TAU / omega * (0.6 - 1e-4_f64).sqrt()).exp();
            let limit = limit * (-0.02 * PI / omega).exp();
            let [a, b, _] = response.multipliers;
            assert!((a + b - 2.0 * limit.re).norm() < 10.0 / force.sqrt());
        }
    }
    // At resonance without damping the element alone takes up energy, up to 4F_s a length.
    let undamped = |force: f64| SymmetricResponse::at(1.0, 0.0, 1.0, 1.0, 1.0, force, 1.0);
    for part in [0.9, 0.99, 0.999] {
        let force = part * 4.0 / PI;
        let response = undamped(force).unwrap();
        let (stiffness, damping, _) = first_harmonic(1.0, 1.0, response.amplitude, 1.0);
        let harmonic = response.amplitude * stiffness.hypot(damping);
        assert!(
            (harmonic / force - 1.0).abs() < 0.01,
            "{part}: {harmonic} {response:?}"
        );
    }
    assert_eq!(undamped(1.0001 * 4.0 / PI), None);
}

#[test]
fn units_do_not_matter() {
    for_all(
        200,
        [
            -1.0..1.0,
            0.0..1.0,
            0.1..2.0,
            0.1..2.0,
            0.5..20.0,
            0.3..2.0,
            -40.0..40.0,
            -40.0..40.0,
        ],
        |[mass, c, k, k_t, force, omega, time, length]| {
            // Powers of two change no digit.
            let mass = mass.exp2();
            let [time, length] = [time, length].map(|power| power.round().exp2());
            let (per_time, unit) = (time.recip(), length);
            let plain = SymmetricResponse::at(mass, c, k, k_t, 1.0, force, omega);
            let scaled = SymmetricResponse::at(
                mass,
                c * per_time,
                k * per_time * per_time,
                k_t * per_time * per_time,
                unit * per_time * per_time,
                force * unit * per_time * per_time,
                omega * per_time,
            );
            prop_assert_eq!(plain.is_some(), scaled.is_some());
            if let (Some(plain), Some(scaled)) = (plain, scaled) {
                prop_assert_eq!(scaled.amplitude, plain.amplitude * unit);
                prop_assert_eq!(scaled.elastic_time, plain.elastic_time * time);
                prop_assert_eq!(scaled.phase, plain.phase);
                prop_assert_eq!(scaled.multipliers, plain.multipliers);
            }
            Ok(())
        },
    );
}

#[test]
fn whatever_is_given_ends_in_finite_numbers_or_none() {
    let plain = [1.0, 0.02, 0.6, 0.4, 0.3, 0.4, 0.88];
    let at = |[m, c, k, k_t, limit, force, omega]: [f64; 7]| {
        SymmetricResponse::at(m, c, k, k_t, limit, force, omega)
    };
    let bad = [f64::NAN, f64::INFINITY, -f64::INFINITY, -1.0, -5e-324];
    let strange = [5e-324, 1e30, 1e-5, f64::MAX, 1e5, 1e-30, 1e-200];
    let strange = || some(4, strange);
    for i in 0..7 {
        for x in bad {
            let mut given = plain;
            given[i] = x;
            assert_eq!(at(given), None);
        }
        let mut given = plain;
        given[i] = 0.0;
        assert_eq!(at(given).is_some(), [1, 2].contains(&i));
        for j in i..7 {
            for x in strange() {
                for y in strange() {
                    let mut given = plain;
                    (given[i], given[j]) = (x, y);
                    let Some(response) = at(given) else { continue };
                    let numbers = [response.amplitude, response.elastic_time, response.phase];
                    let moduli = response.multipliers.map(|m| m.norm());
                    assert!(numbers.iter().chain(&moduli).all(|x| x.is_finite()));
                    let in_range = response.amplitude >= 0.0
                        && response.elastic_time >= 0.0
                        && moduli.iter().all(|&size| size < 1.0 + 1e-9);
                    assert!(in_range, "{given:?}: {response:?}");
                }
            }
        }
    }
}

fn joints() -> impl Iterator<Item = Iwan4> {
    let mut random = Random::new(4);
    (0..200).map(move |_| {
        let (slip_force, stiffness) =
            (random.logarithmic(0.1, 10.0), random.logarithmic(0.1, 10.0));
        let exponent = random.pick(&[0.0, 1.0, 1.0]) * random.uniform(-0.9, 0.0);
        let ratio = random.pick(&[0.0, 1.0, 1.0]) * random.logarithmic(1e-3, 1e3);
        Iwan4::new(slip_force, stiffness, exponent, ratio).unwrap()
    })
}

/// F_S, K_T, χ, β, φ_max, and R φ_max^{χ+1} from the definition of β, by ∫φρ dφ = F_S.
fn density(joint: &Iwan4) -> [f64; 4] {
    let (chi, beta) = (joint.exponent(), joint.ratio());
    let longest = joint.largest_break_free();
    // F_S = R φ^{χ+2}/(χ+2) + S φ,   S = β R φ^{χ+1}/(χ+1)
    let weight = joint.slip_force() / longest / (1.0 / (chi + 2.0) + beta / (chi + 1.0));
    [chi, longest, weight, beta * weight / (chi + 1.0)]
}

#[test]
fn iwans_joint_is_the_integral_of_its_sliders() {
    for joint in joints() {
        let [chi, longest, weight, at_end] = density(&joint);
        // K_T = ∫ρ dφ
        let stiffness = weight / (chi + 1.0) + at_end;
        assert!(
            (stiffness / joint.stiffness() - 1.0).abs() < 1e-14,
            "{joint:?}"
        );
        // ∫ f ρ dφ with φ = φ_max r^p, in which the integrands are smooth at 0.
        let power = (8.0 / (chi + 1.0)).ceil();
        let over = |f: &dyn Fn(f64) -> f64, kink: f64| {
            let inner = |r: f64| {
                let density = weight * power * r.powf(power * (chi + 1.0) - 1.0);
                density * f(longest * r.powf(power))
            };
            let kink = (kink / longest).powf(power.recip());
            between(0.0, 1.0, &[kink, 0.5 * kink], inner) + at_end * f(longest)
        };
        for part in [1e-3, 0.03, 0.4, 0.97, 1.0, 1.3, 20.0] {
            let u = part * longest;
            let force = over(&|phi| u.min(phi), u);
            let found = joint.backbone(u);
            assert!(
                (found - force).abs() < 1e-12 * joint.slip_force(),
                "{joint:?} {part}"
            );
            assert_eq!(joint.backbone(-u), -found);
            let area = over(&|phi| 4.0 * phi * (u - phi).max(0.0), u);
            let loss = joint.dissipation(u);
            let size = 4.0 * joint.slip_force() * u;
            assert!((loss - area).abs() < 1e-12 * size, "{joint:?} {part}");
            // Masing: 8∫F − 4A F(A).
            let backbone = |x: f64| joint.backbone(x);
            let inner = between(0.0, u, &[longest, 0.1 * longest, 1e-3 * longest], backbone);
            let masing = 8.0 * inner - 4.0 * u * found;
            assert!(
                (loss - masing).abs() < 1e-5 * size,
                "{joint:?} {part}: {loss} {masing}"
            );
        }
        assert_eq!(joint.backbone(0.0), 0.0);
        assert_eq!(joint.dissipation(0.0), 0.0);
        assert_eq!(joint.backbone(longest), joint.slip_force());
        // Small amplitudes.
        let ratio = joint.dissipation(1e-5 * longest) / joint.dissipation(1e-6 * longest);
        assert!((ratio.log10() - chi - 3.0).abs() < 1e-13, "{joint:?}");
        let slope = joint.backbone(1e-9 * longest) / (1e-9 * longest);
        let reached = 1e-9_f64.powf(chi + 1.0);
        assert!(
            (slope / joint.stiffness() - 1.0).abs() < reached + 1e-15,
            "{joint:?}"
        );
    }
}

#[test]
fn elements_are_tangents_with_the_stiffness_and_the_force_of_the_joint() {
    let mut random = Random::new(5);
    for joint in joints() {
        let grid = random.uniform(0.2, 0.9);
        let n = 1 + (random.bits() % 12) as usize;
        let elements = joint.elements(n, grid).unwrap();
        assert_eq!(elements.len(), n + usize::from(joint.ratio() > 0.0));
        assert!(elements.iter().all(|&(k, limit)| k > 0.0 && limit > 0.0));
        let stiffness: f64 = elements.iter().map(|e| e.0).sum();
        let force: f64 = elements.iter().map(|e| e.1).sum();
        assert_abs_diff_eq!(stiffness / joint.stiffness(), 1.0, epsilon = 1e-14);
        assert_abs_diff_eq!(force / joint.slip_force(), 1.0, epsilon = 1e-14);
        let longest = joint.largest_break_free();
        let small = 1e-14 * joint.slip_force();
        for i in 1..=n {
            let end = longest * grid.powi((n - i) as i32);
            let (exact, found) = (joint.backbone(end), polygon(&elements, end));
            assert!((exact - found).abs() < small, "{joint:?} {i} of {n}");
            // Break-free displacements lie in their intervals, in ascending order.
            let (k, limit) = elements[i - 1];
            let lower = if i == 1 { 0.0 } else { end * grid };
            assert!(lower < limit / k && limit / k < end, "{joint:?}");
            // Too much by 4(∫φ²ρ − Σ limit²/k).
            let excess = dissipated(&elements, end) - joint.dissipation(end);
            let most = 2.0 * joint.slip_force() * end;
            assert!((-small * end..most).contains(&excess), "{joint:?}");
        }
        for j in 0..100 {
            let u = longest * 0.012 * f64::from(j);
            assert!(
                polygon(&elements, u) > joint.backbone(u) - small,
                "{joint:?}"
            );
        }
        let (k, limit) = elements[0];
        assert_eq!(dissipated(&elements, 0.999 * limit / k), 0.0);
    }
    // The ratios of the losses where an interval ends.
    for (chi, grid, expected) in [(-0.1, 0.5, 1.068), (-0.5, 0.4, 1.092)] {
        let joint = Iwan4::new(3.0, 2.0, chi, 0.1).unwrap();
        let elements = joint.elements(24, grid).unwrap();
        for i in 0..12 {
            let end = joint.largest_break_free() * grid.powi(i);
            let ratio = dissipated(&elements, end) / joint.dissipation(end);
            assert!((ratio - expected).abs() < 5e-4, "{chi}: {ratio}");
        }
    }
}

#[test]
fn elements_have_25_digits() {
    let case = case("jc_04");
    let elements = Iwan4::new(3.0, 2.0, -0.1, 0.1)
        .unwrap()
        .elements(3, 0.5)
        .unwrap();
    let contacts = list(&case["system"]["contacts"]);
    assert_eq!(elements.len(), contacts.len());
    for ((stiffness, limit), contact) in elements.into_iter().zip(contacts) {
        assert_abs_diff_eq!(stiffness / number(&contact["kt"]), 1.0, epsilon = 1e-15);
        assert_abs_diff_eq!(limit / number(&contact["N0"]), 1.0, epsilon = 1e-15);
    }
}

#[test]
fn joints_have_their_limits() {
    // All sliders at φ_max: one Jenkins element.
    let one = Iwan4::new(3.0, 2.0, -0.5, 1e300).unwrap();
    assert_abs_diff_eq!(one.largest_break_free(), 1.5, epsilon = 1e-15);
    assert_abs_diff_eq!(one.backbone(1.0), 2.0, epsilon = 1e-15);
    assert!((one.dissipation(4.0) - loop_area(2.0, 3.0, 4.0)).abs() < 1e-14);
    // An exponent near −1 makes a joint that slips at any displacement: slip of the logarithm.
    let sharp = Iwan4::new(1.0, 1.0, (-1.0_f64).next_up(), 0.0).unwrap();
    let longest = sharp.largest_break_free();
    for part in [1e-3_f64, 0.1, 0.5] {
        let leading = part * (1.0 - part.ln());
        assert_abs_diff_eq!(sharp.backbone(part * longest), leading, epsilon = 1e-14);
    }
    // Uniform: F = K_T u − R u²/2.
    let uniform = Iwan4::new(1.0, 2.0, 0.0, 0.0).unwrap();
    assert_eq!(uniform.largest_break_free(), 1.0);
    assert_abs_diff_eq!(uniform.backbone(0.25), (0.5 - 0.0625), epsilon = 1e-16);
    assert_abs_diff_eq!(uniform.dissipation(0.5), 8.0 * 0.125 / 6.0, epsilon = 1e-16);

    assert!(uniform.backbone(f64::NAN).is_nan());
    assert_eq!(uniform.backbone(-f64::INFINITY), -1.0);
    assert!(uniform.dissipation(f64::NAN).is_nan() && uniform.dissipation(-1.0).is_nan());
    assert_eq!(uniform.dissipation(f64::INFINITY), f64::INFINITY);
    assert_eq!(uniform.backbone(5e-324), 1e-323);
    // D(φ_max) = (4/3) F_S φ_max for χ = β = 0, also where 4F_S overflows; beyond the largest
    // number D is infinite.
    let strong = Iwan4::new(f64::MAX, f64::MAX, 0.0, 0.0).unwrap();
    let longest = strong.largest_break_free();
    assert_eq!(longest, 2.0);
    assert_eq!(strong.dissipation(longest), f64::INFINITY);
    let strong = Iwan4::new(f64::MAX, 2.0 * f64::MAX.sqrt(), 0.0, 0.0);
    assert_eq!(strong.unwrap().dissipation(0.0), 0.0);
    let short = Iwan4::new(f64::MAX, f64::MAX, 0.0, 0.0)
        .unwrap()
        .dissipation(0.125);
    assert_abs_diff_eq!(short / f64::MAX, 0.125_f64.powi(3) / 3.0, epsilon = 1e-18);
    let refused = |n: usize, grid: f64| match uniform.elements(n, grid) {
        Err(Error::InvalidParameter { name, .. }) => name,
        other => panic!("{other:?}"),
    };
    assert_eq!(refused(0, 0.5), "n");
    assert_eq!(refused(usize::MAX, 0.5), "n");
    assert_eq!(refused(1200, 0.5), "grid"); // 2^−1200
    assert_eq!(uniform.elements(100_000, 0.9999).unwrap().len(), 100_000);
}
