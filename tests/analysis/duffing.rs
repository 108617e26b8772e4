//! Duffing's oscillator: closed forms against motions of structures, the order of the errors of
//! first-harmonic theory, and hostile input.

use std::f64::consts::{PI, TAU};

use stick_slip::analysis::duffing::{Response, friction_decay, period, response};
use stick_slip::orbit::{self, Orbit, Period};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, EventKind, ForceElement, PolynomialSpring, Structure};

use crate::common::{Random, count, json, list, number, text};

/// A mass on a spring, k and c3 both in an element.
fn duffing(mass: f64, stiffness: f64, cubic: f64) -> Structure {
    let spring = PolynomialSpring::new(&[stiffness, 0.0, cubic]).unwrap();
    let element = ForceElement::new(0, spring).unwrap();
    Structure::new(&[mass])
        .unwrap()
        .with_element(element)
        .unwrap()
}

fn rubbing(structure: Structure, kinetic: f64, limit: f64) -> Structure {
    let law = Coulomb::new(limit, kinetic).unwrap();
    let contact = Contact::new(0, law, 1.0).unwrap();
    structure.with_contact(contact).unwrap()
}

/// k, c3 and A: hardening, softening, without a linear part, and a double well that the mass
/// leaves.
fn spring(random: &mut Random) -> [f64; 3] {
    let (size, amplitude) = (
        random.logarithmic(0.01, 100.0),
        random.logarithmic(0.01, 100.0),
    );
    // The smallest of k + c3A² and k + c3A²/2, in parts of k, is at least 0.05.
    let (stiffness, added) = match random.bits() % 4 {
        0 => (1.0, random.logarithmic(1e-3, 1e3)),
        1 => (1.0, -random.uniform(0.0, 0.95)),
        2 => (0.0, 1.0),
        _ => (-1.0, random.uniform(2.1, 10.0)),
    };
    [
        size * stiffness,
        size * added / (amplitude * amplitude),
        amplitude,
    ]
}

#[test]
fn periods_are_those_of_motions() {
    let mut random = Random::new(71);
    for _ in 0..count(100, 1000) {
        let [stiffness, cubic, amplitude] = spring(&mut random);
        let mass = random.logarithmic(0.01, 100.0);
        let found = period(mass, stiffness, cubic, amplitude).unwrap();
        let start = State::new(&[amplitude], &[0.0]);
        let motion = duffing(mass, stiffness, cubic).simulate(start, found);
        let motion = motion.unwrap();
        let last = motion.last();
        // A quarter of a period away the velocity is largest, and shows an error of the time.
        let quarter = motion.state_at(0.25 * found).unwrap();
        let unit = [
            last.displacements[0] / amplitude - 1.0,
            quarter.displacements[0] / amplitude,
        ];
        // Near a separatrix a perturbation is magnified up to 20 times.
        assert!(
            unit.iter().all(|error| error.abs() < 1e-13),
            "{mass} {stiffness} {cubic} {amplitude}: {unit:?}"
        );
    }
}

#[test]
fn decay_is_that_of_motions() {
    let mut random = Random::new(72);
    for _ in 0..count(60, 600) {
        let [stiffness, cubic, amplitude] = spring(&mut random);
        if stiffness < 0.0 {
            continue;
        }
        let force = (stiffness + cubic * amplitude * amplitude) * amplitude;
        let kinetic = force * random.logarithmic(0.02, 2.0);
        let limit = kinetic * random.uniform(1.0, 1.5);
        let (mass, start) = (random.logarithmic(0.01, 100.0), random.sign() * amplitude);
        let turns = friction_decay(mass, stiffness, cubic, kinetic, limit, start).unwrap();
        let turns: Vec<_> = turns.collect();
        assert_eq!(turns[0], (0.0, start));
        let (end, rest) = turns[turns.len() - 1];
        let structure = rubbing(duffing(mass, stiffness, cubic), kinetic, limit);
        let unit = (mass / (stiffness + cubic.abs() * amplitude * amplitude)).sqrt();
        let motion = structure.simulate(State::new(&[start], &[0.0]), end + 10.0 * unit);
        let motion = motion.unwrap();
        assert_eq!(motion.events().len(), turns.len() - 1);
        for (event, (time, turn)) in motion.events().iter().zip(&turns[1..]) {
            let is_last = *time == end;
            assert_eq!(event.kind == EventKind::Stick, is_last);
            // At a turning point of slow motion a time is known less well.
            assert!(
                (event.time - time).abs() < 1e-12 * (unit + time),
                "{event:?} {time}"
            );
            let apart = (event.state.displacements[0] - turn).abs();
            assert!(apart < 1e-13 * amplitude, "{event:?} {turn}");
        }
        assert!((motion.last().displacements[0] - rest).abs() < 1e-13 * amplitude);
    }
}

#[test]
fn decay_is_that_of_the_reference() {
    let all = json(include_str!("../data/force_trajectories.json"));
    let mut cases = list(&all["cases"]).iter();
    let case = cases.find(|case| text(&case["family"]) == "duffing_coulomb_free");
    let events = list(&case.unwrap()["events"]);
    let turns = friction_decay(1.0, 1.0, 0.7, 0.2, 0.3, 2.0).unwrap();
    let turns: Vec<_> = turns.skip(1).collect();
    assert_eq!(turns.len(), events.len());
    for ((time, turn), event) in turns.into_iter().zip(events) {
        // Nine roundings of the displacement, which the slow last swings magnify in the time.
        assert!((time - number(&event["t"])).abs() < 2e-14);
        assert!((turn - number(&event["q"][0])).abs() < 4e-15);
    }
}

/// Without a cubic term every swing is the half period of a linear spring.
#[test]
fn a_linear_spring_loses_the_same_in_each_swing() {
    let turns = friction_decay(4.0, 9.0, 0.0, 0.9, 0.9, 1.0).unwrap();
    let expected = [1.0, -0.8, 0.6, -0.4, 0.2, 0.0];
    let turns: Vec<_> = turns.collect();
    assert_eq!(turns.len(), expected.len());
    for (i, ((time, turn), expected)) in turns.into_iter().zip(expected).enumerate() {
        assert!((turn - expected).abs() < 1e-15);
        assert!((time - i as f64 * PI * 2.0 / 3.0).abs() < 4e-15);
    }
    assert!((period(4.0, 9.0, 0.0, 1.0).unwrap() - TAU * 2.0 / 3.0).abs() < 1e-15);
}

/// m, c, k, c3, F_k, P and ω.
type Numbers = [f64; 7];

fn amplitudes([m, c, k, c3, friction, force, frequency]: Numbers) -> Vec<Response> {
    response(m, c, k, c3, friction, force, frequency)
}

/// The periodic motion near an amplitude of the theory.
fn motion([m, c, k, c3, friction, force, frequency]: Numbers, amplitude: f64) -> Orbit<State> {
    let elastic = (k + 0.75 * c3 * amplitude * amplitude - m * frequency * frequency) * amplitude;
    let resisting = c * frequency * amplitude + 4.0 / PI * friction;
    let lag = resisting.atan2(elastic);
    let guess = State::new(
        &[amplitude * lag.cos()],
        &[amplitude * frequency * lag.sin()],
    );
    let structure = duffing(m, k, c3)
        .with_ground_damper(0, c)
        .and_then(|structure| {
            structure.with_force(0, Drive::harmonic(force, frequency, 0.0).unwrap())
        });
    let structure = rubbing(structure.unwrap(), friction, friction);
    orbit::shoot(&structure, &guess, Period::Driven(1)).unwrap()
}

/// The error of the only amplitude, the third harmonic, and the estimates of both.
fn errors(numbers: Numbers) -> [f64; 4] {
    let [found] = amplitudes(numbers)[..] else {
        panic!("{numbers:?}")
    };
    let harmonics = motion(numbers, found.amplitude).harmonics(0, 3);
    let error = (harmonics[0].norm() - found.amplitude).abs();
    [
        error,
        harmonics[2].norm(),
        found.error,
        found.third_harmonic,
    ]
}

/// Cubic term, damping and friction of order ε: away from resonance the error is of order ε²; at
/// resonance, where a force of order ε causes a motion of order 1, of order ε, and so where the
/// third harmonic is in resonance, which is then of order 1.
#[test]
fn errors_of_the_response_have_their_order() {
    let away = |e: f64| [1.0, e, 1.0, e, 0.3 * e, 0.6, 0.6];
    let near = |e: f64| {
        [
            1.0,
            0.2 * e,
            1.0,
            e,
            0.1 * e,
            0.6 * e,
            (1.0 + 0.9 * e).sqrt(),
        ]
    };
    let in_thirds = |e: f64| {
        let e = 0.05 * e;
        [1.0, 0.5 * e, 1.0, e, 0.1 * e, 0.3, 1.0 / 3.0]
    };
    let cases: [&dyn Fn(f64) -> Numbers; 3] = [&away, &near, &in_thirds];
    let ratios = [[4.0, 2.0], [2.0, 2.0], [2.0, 1.0]];
    for (case, [ratio, of_third]) in cases.into_iter().zip(ratios) {
        let found = [0.02, 0.01, 0.005].map(|e| errors(case(e)));
        for pair in found.windows(2) {
            let [error, third, ..] = [0, 1].map(|i| pair[0][i] / pair[1][i]);
            assert!((error / ratio - 1.0).abs() < 0.1, "{ratio}: {found:?}");
            assert!((third / of_third - 1.0).abs() < 0.1, "{ratio}: {found:?}");
        }
        // Where the third harmonic is large, what it does to the rest of the motion counts, too.
        if of_third == 1.0 {
            continue;
        }
        for [error, third, estimate, third_estimate] in found {
            assert!(
                (third / third_estimate - 1.0).abs() < 0.1,
                "{ratio}: {found:?}"
            );
            assert!(
                (0.2..1.5).contains(&(error / estimate)),
                "{ratio}: {found:?}"
            );
        }
    }
}

/// Both stable motions of one system, and the unstable one between them.
#[test]
fn three_amplitudes_are_three_motions() {
    let numbers = [1.0, 0.05, 1.0, 0.5, 0.1, 0.6, 1.4];
    let found = amplitudes(numbers);
    assert_eq!(found.len(), 3);
    // The reference has 25 digits.
    let largest = [
        Some(0.7800000614541620505),
        None,
        Some(1.859433928115326367581073),
    ];
    for ((of, largest), is_stable) in found.iter().zip(largest).zip([true, false, true]) {
        let motion = motion(numbers, of.amplitude);
        assert_eq!(motion.is_stable(), is_stable);
        let first = motion.harmonics(0, 1)[0].norm();
        assert!((first - of.amplitude).abs() < of.error, "{first} {of:?}");
        let (_, high) = motion.extremes(0);
        let allowed = of.error + 1.1 * of.third_harmonic;
        assert!((high - of.amplitude).abs() < allowed, "{high} {of:?}");
        assert!(largest.is_none_or(|largest: f64| (high - largest).abs() < 1e-13));
    }
}

/// The left-hand side of the balance of first harmonics, its square root.
fn needed([m, c, k, c3, friction, _, frequency]: Numbers, amplitude: f64) -> f64 {
    let elastic = k + 0.75 * c3 * amplitude * amplitude - m * frequency * frequency;
    (elastic * amplitude).hypot(c * frequency * amplitude + 4.0 / PI * friction)
}

#[test]
fn no_amplitude_is_missed() {
    let mut random = Random::new(73);
    let mut counts = [0; 4];
    for _ in 0..count(400, 4000) {
        let size = random.logarithmic(1e-3, 1e3);
        let numbers = [
            random.logarithmic(0.1, 10.0),
            random.pick(&[0.0, 1.0]) * random.logarithmic(1e-3, 1.0),
            random.uniform(-1.0, 2.0),
            random.sign() * random.logarithmic(1e-2, 10.0) / (size * size),
            random.pick(&[0.0, 1.0]) * random.logarithmic(1e-3, 1.0) * size,
            random.logarithmic(1e-2, 10.0) * size,
            random.logarithmic(0.1, 10.0),
        ];
        let found = amplitudes(numbers);
        let force = numbers[5];
        for of in &found {
            // A rounding error of A changes the force by its slope.
            let step = 4.0 * f64::EPSILON * of.amplitude;
            let sides = [-step, step].map(|step| needed(numbers, of.amplitude + step) - force);
            let rounding =
                8.0 * f64::EPSILON * (force + numbers[0] * numbers[6].powi(2) * of.amplitude);
            assert!(
                sides[0] * sides[1] <= 0.0 || sides[0].abs() < rounding,
                "{numbers:?}"
            );
        }
        // Sign changes on a fine grid. Two amplitudes in one interval are seen by the search alone.
        let grid = |i: i32| size * 10_f64.powf(f64::from(i) * 1e-3);
        let is_beyond = |i: i32| needed(numbers, grid(i)) > force;
        let seen = (-8000..8000)
            .filter(|&i| is_beyond(i) != is_beyond(i + 1))
            .count();
        assert!(
            found.len() == seen || found.len() == seen + 2,
            "{numbers:?}: {found:?}, {seen}"
        );
        assert!(found.is_sorted_by(|a, b| a.amplitude < b.amplitude));
        counts[found.len()] += 1;
    }
    assert!(counts[1] > 100 && counts[3] > 20, "{counts:?}");
}

#[test]
fn what_is_out_of_range_has_no_result() {
    let bad = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];
    let replaced = |numbers: &[f64], i: usize, value: f64| {
        let mut numbers = numbers.to_vec();
        numbers[i] = value;
        numbers
    };
    for value in bad {
        for i in 0..4 {
            let given = replaced(&[1.0, 1.0, 0.5, 2.0], i, value);
            assert_eq!(
                period(given[0], given[1], given[2], given[3]),
                None,
                "{given:?}"
            );
        }
        for i in 0..6 {
            let g = replaced(&[1.0, 1.0, 0.5, 0.1, 0.2, 2.0], i, value);
            let decay = friction_decay(g[0], g[1], g[2], g[3], g[4], g[5]);
            assert!(decay.is_none(), "{g:?}");
        }
        for i in 0..7 {
            let given = replaced(&[1.0, 0.1, 1.0, 0.5, 0.1, 0.6, 1.4], i, value);
            let given = <Numbers>::try_from(given).unwrap();
            assert!(amplitudes(given).is_empty(), "{given:?}");
        }
    }
    // In a well beside 0; beyond the largest force of a softening spring; no mass; no amplitude.
    for [m, k, c3, a] in [
        [1.0, -1.0, 1.0, 1.4],
        [1.0, 1.0, -1.0, 1.0],
        [0.0, 1.0, 1.0, 1.0],
        [1.0, 1.0, 1.0, 0.0],
        [1.0, 0.0, 0.0, 1.0],
    ] {
        assert_eq!(period(m, k, c3, a), None);
    }
    for [m, k, c3, kinetic, limit, a] in [
        [1.0, -1.0, 1.0, 0.1, 0.1, 5.0],
        [1.0, 1.0, -1.0, 0.1, 0.1, 1.0],
        [1.0, 1.0, 1.0, 0.2, 0.1, 1.0],
        [1.0, 1.0, 1.0, -0.1, 0.1, 1.0],
        [0.0, 1.0, 1.0, 0.1, 0.1, 1.0],
    ] {
        assert!(friction_decay(m, k, c3, kinetic, limit, a).is_none());
    }
    // A force that friction withstands; resonance without resistance.
    assert!(amplitudes([1.0, 0.1, 1.0, 0.5, 0.1, 0.4 / PI, 1.4]).is_empty());
    assert!(amplitudes([1.0, 0.0, 1.0, 0.0, 0.0, 1.0, 1.0]).is_empty());
    assert_eq!(
        amplitudes([1.0, 0.0, 1.0, 1.0, 0.0, 0.75, 1.0])[0].amplitude,
        1.0
    );
    // Held at once; never at rest.
    let mut held = friction_decay(1.0, 1.0, 1.0, 3.0, 3.0, 1.0).unwrap();
    assert_eq!([held.next(), held.next()], [Some((0.0, 1.0)), None]);
    let mut free = friction_decay(1.0, 1.0, 1.0, 0.0, 0.0, 1.0).unwrap();
    let (time, turn) = free.nth(1000).unwrap();
    assert_eq!(turn, 1.0);
    let exact = 500.0 * period(1.0, 1.0, 1.0, 1.0).unwrap();
    assert!((time - exact).abs() < 1e-12 * exact);
}

/// Any magnitudes of which products of four neither overflow nor underflow: results, or none,
/// within a bounded time.
#[test]
fn any_magnitude_has_an_end() {
    let mut random = Random::new(74);
    for _ in 0..count(2000, 20_000) {
        let numbers: Numbers = std::array::from_fn(|_| random.logarithmic(1e-60, 1e60));
        for sign in [-1.0, 1.0] {
            let [m, c, k, c3, friction, force, frequency] = numbers;
            let found = amplitudes([m, c, sign * k, -sign * c3, friction, force, frequency]);
            let are_positive = found.iter().all(|of| of.amplitude > 0.0);
            assert!(
                found.len() <= 3 && are_positive,
                "{numbers:?} {sign}: {found:?}"
            );
            let _ = period(m, k, sign * c3, force);
            if let Some(turns) = friction_decay(m, k, sign * c3, friction, 2.0 * friction, force) {
                assert!(
                    turns
                        .take(10)
                        .all(|(time, turn)| time >= 0.0 && turn.abs() <= force)
                );
            }
        }
    }
}
