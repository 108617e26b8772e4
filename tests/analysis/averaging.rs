//! Averaging against closed forms, against its own definition, and against a scan for cycles.

use approx::assert_abs_diff_eq;
use std::f64::consts::{PI, TAU};

use crate::common::property::for_all;
use crate::common::{
    Counted, Decay, Ends, Leine, Random, Table, count, friction_law, on_belt, paper, refused, some,
};
use crate::properties::{RANGES, system};
use proptest::{prop_assert, prop_assert_eq};
use stick_slip::analysis::PureSlip;
use stick_slip::analysis::averaging::{AveragedCycle, cycles, drift, drift_slope};
use stick_slip::{Coulomb, Error, Exponential, FrictionLaw, MassOnBelt, Polynomial};

/// −(1/2π)∫ h(A cos ψ) cos ψ dψ as it stands in Eq. 12, by the midpoint rule with n points.
fn by_definition<L: FrictionLaw>(system: &MassOnBelt<L>, amplitude: f64, n: u32) -> f64 {
    let v_b = system.belt_velocity();
    let mean: f64 = (0..n)
        .map(|j| {
            let cosine = (TAU * (f64::from(j) + 0.5) / f64::from(n)).cos();
            let y = amplitude * cosine;
            let friction = system.law().coefficient(y - v_b) - system.law().coefficient(-v_b);
            (2.0 * system.damping() * y + system.load() * friction) * cosine
        })
        .sum();
    -mean / f64::from(n)
}

#[test]
fn drift_is_its_definition_for_any_law() {
    fn check<L: FrictionLaw>(law: L) {
        let system = on_belt(&law, -0.3, 0.03, 1.7);
        let kinked = law.breakpoints().next().is_some();
        for amplitude in [1e-3, 0.05, 0.15, 0.29, 0.31, 0.6, 2.0] {
            let value = drift(&system, amplitude).unwrap();
            let n = 200_000;
            // The midpoint rule converges at once on smooth integrands, else like n⁻² at kinks and
            // n⁻¹ at the jump.
            let tolerance = if amplitude > 0.3 {
                1e-5
            } else if kinked {
                1e-9
            } else {
                1e-14
            };
            let expected = by_definition(&system, amplitude, n);
            assert!(
                (value - expected).abs() < tolerance,
                "{amplitude}: {value} {expected}"
            );
        }
    }
    check(Coulomb::new(0.4, 0.25).unwrap());
    check(Exponential::new(0.4, 0.25, 0.2).unwrap());
    check(Leine {
        static_coefficient: 0.4,
        decay: 3.0,
    });
    check(Decay {
        static_coefficient: 0.4,
        kinetic_coefficient: 0.2,
        velocity: 0.1,
    });
    check(Table {
        static_coefficient: 0.5,
        points: vec![(0.0, 0.45), (0.1, 0.3), (0.25, 0.28), (1.0, 0.4)],
    });
}

#[test]
fn coulomb_drift_has_a_closed_form() {
    // −βA, and above |v_b| the jump.
    let system = on_belt(Coulomb::new(0.4, 0.25).unwrap(), 0.3, 0.03, 1.0);
    for amplitude in [0.0, 1e-9, 0.1, 0.3] {
        assert_eq!(drift(&system, amplitude).unwrap(), -0.03 * amplitude);
    }
    for amplitude in [0.3_f64.next_up(), 0.3000001, 0.5, 40.0] {
        let sine = ((amplitude - 0.3) * (amplitude + 0.3)).sqrt() / amplitude;
        let expected = -0.03 * amplitude - 2.0 * 0.25 / PI * sine;
        assert!((drift(&system, amplitude).unwrap() / expected - 1.0).abs() < 1e-15);
    }
    assert!(cycles(&system).unwrap().is_empty());
    // Without damping every orbit that does not reach the belt is periodic: no isolated cycle.
    assert!(
        cycles(&system.with_damping(0.0).unwrap())
            .unwrap()
            .is_empty()
    );
}

#[test]
fn table_drift_has_a_closed_form() {
    // ∫ sin²ψ dψ = (ψ − sin ψ cos ψ)/2 on each straight piece, ∫ cos²ψ dψ = (ψ + sin ψ cos ψ)/2.
    let law = Table {
        static_coefficient: 0.5,
        points: vec![(0.0, 0.45), (0.1, 0.3), (0.25, 0.28), (1.0, 0.4)],
    };
    let (w, beta, load) = (0.3, 0.02, 0.9);
    let system = on_belt(&law, w, beta, load);
    for amplitude in [
        0.02, 0.05, 0.15, 0.2, 0.25, 0.299, 0.301, 0.39, 0.41, 0.56, 0.8,
    ] {
        let mut splits = vec![0.0, PI];
        for y in [w, w - 0.1, w + 0.1, w - 0.25, w + 0.25] {
            if amplitude > f64::abs(y) {
                splits.push((y / amplitude).acos());
            }
        }
        splits.sort_by(f64::total_cmp);
        let (mut sine, mut cosine) = (0.0, 0.0);
        for ends in splits.windows(2) {
            let [a, b] = [ends[0], ends[1]];
            let speed = (w - amplitude * (0.5 * (a + b)).cos()).abs();
            let (_, _, slope) = law.line(law.piece(speed));
            let product = |psi: f64| psi.sin() * psi.cos();
            sine += 0.5 * slope * ((b - a) - (product(b) - product(a)));
            cosine += 0.5 * slope * ((b - a) + (product(b) - product(a)));
        }
        let jump = 2.0 * load / PI * 0.45;
        let s = (w / amplitude).min(1.0).acos();
        let expected = -beta * amplitude - load / PI * amplitude * sine - jump * s.sin();
        assert!(
            (drift(&system, amplitude).unwrap() - expected).abs() < 1e-15,
            "{amplitude}"
        );
        let steepening = if amplitude > w {
            jump * w * w / (amplitude.powi(3) * s.sin())
        } else {
            0.0
        };
        let expected = -beta - load / PI * cosine - steepening;
        assert!(
            (drift_slope(&system, amplitude).unwrap() / expected - 1.0).abs() < 1e-13,
            "{amplitude}"
        );
    }
}

#[test]
fn laws_with_long_flat_parts_and_narrow_features_are_resolved() {
    // Far above the Stribeck velocity and just at the belt: exp(−(s/v_s)²) from 1 to 0 in a
    // thousandth of the range.
    for stribeck in some(1, [0.01, 0.1, 0.001]) {
        let system = MassOnBelt::new(Exponential::new(0.4, 0.3, stribeck).unwrap(), 1.0).unwrap();
        for amplitude in [0.99, 1.0, 1.01, 1.5] {
            let value = drift(&system, amplitude).unwrap();
            let expected = by_definition(&system, amplitude, 1_000_000);
            let tolerance = if amplitude > 1.0 { 1e-6 } else { 1e-13 };
            assert!(
                (value - expected).abs() < tolerance,
                "{stribeck} {amplitude}: {value} {expected}"
            );
        }
    }
}

#[test]
fn cycles_near_their_birth() {
    // A0 = 2√(v_b1² − v_b²) from small to touching, and none beyond.
    let onset = PureSlip::new(&paper(0.4))
        .unwrap()
        .onset_velocity()
        .unwrap();
    for distance in [1e-12, 1e-9, 1e-6, 1e-3, 0.04] {
        let system = paper(onset - distance);
        let expected = PureSlip::new(&system).unwrap().amplitude().unwrap();
        let found = cycles(&system).unwrap();
        assert_eq!(found.len(), 1, "{distance}");
        // A0² carries the rounding of h1.
        let error = (found[0].amplitude() - expected).abs() * expected;
        assert!(error < 1e-15, "{distance}: {error}");
    }
    assert!(cycles(&paper(onset + 1e-12)).unwrap().is_empty());
}

#[test]
fn a_fold_is_followed_until_both_cycles_meet() {
    // Exponential law above its upper Hopf velocity: an unstable and a stable cycle that meet at a
    // fold.
    let law = Exponential::new(0.4, 0.3, 1.0).unwrap();
    let at = |v_b: f64| on_belt(law, v_b, 0.01, 0.5);
    let (mut two, mut none) = (1.45, 1.47);
    while none - two > 1e-13 {
        let middle = 0.5 * (two + none);
        match cycles(&at(middle)).unwrap().len() {
            2 => two = middle,
            0 => none = middle,
            other => panic!("{other} cycles at {middle}"),
        }
    }
    // The exact fold at this load is at 1.457833217; averaging is O(ε²) away.
    assert!((two - 1.457833217465865).abs() < 2e-5, "{two}");
    let pair = cycles(&at(two)).unwrap();
    assert_abs_diff_eq!(pair[0].amplitude(), pair[1].amplitude(), epsilon = 1e-5);
    assert!((pair[0].multiplier() - 1.0).abs() < 1e-6 && (pair[1].multiplier() - 1.0).abs() < 1e-6);
}

/// Damping only lowers A'/A, so that a fold lies at its maximum over A, and a little less damping
/// makes a pair of cycles as close as one likes.
#[test]
fn pairs_near_folds_are_found_as_close_as_is_promised() {
    let mut folds = 0;
    for (mu_k, v_b, load) in [
        (0.3, 1.3, 0.5),
        (0.3, 1.45, 0.5),
        (0.25, 1.6, 1.0),
        (0.1, 1.8, 0.2),
        (0.35, 1.5, 3.0),
        (0.2, 2.0, 0.01),
    ] {
        let law = Exponential::new(0.4, mu_k, 1.0).unwrap();
        let system = on_belt(law, v_b, 0.0, load);
        let rate = |amplitude: f64| drift(&system, amplitude).unwrap() / amplitude;
        // The largest on a grid, and the maximum about it.
        let grid = (1..400).map(|i| v_b * 0.0025 * f64::from(i));
        let top = grid.max_by(|a, b| rate(*a).total_cmp(&rate(*b))).unwrap();
        let (mut low, mut high) = (top - 0.0025 * v_b, top + 0.0025 * v_b);
        // A'/A rises where dA'/dA is larger than it.
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if drift_slope(&system, middle).unwrap() > rate(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        let peak = 0.5 * (low + high);
        let h = 0.01 * v_b;
        let curvature = (rate(peak - h) - 2.0 * rate(peak) + rate(peak + h)) / (h * h);
        assert!(rate(peak) > 0.0 && curvature < 0.0 && peak < 0.98 * v_b);
        folds += 1;
        let speeds = (0..1000).map(|i| 0.005 * f64::from(i));
        let steepest = speeds.map(|s| law.slope(s).abs()).fold(0.0, f64::max);
        let promised = 1e-14 * (rate(peak) + load * steepest);
        for times in [1.0, 10.0, 1e3, 1e5] {
            // How far A'/A rises above zero between the two.
            let depth = times * promised;
            let distance = (-8.0 * depth / curvature).sqrt() / v_b;
            assert!(times > 1.0 || distance < 1e-6, "{v_b} {load}: {distance}");
            let near = system.with_damping(rate(peak) - depth).unwrap();
            let pair = cycles(&near).unwrap();
            assert_eq!(pair.len(), 2, "{v_b} {load}: {distance}");
            let apart = (pair[1].amplitude() - pair[0].amplitude()) / v_b;
            // As far as rounding of A'/A lets the distance be known.
            assert!((apart / distance - 1.0).abs() < 0.5, "{apart} {distance}");
            assert!(!pair[0].is_stable() && pair[1].is_stable());
        }
        let beyond = system.with_damping(rate(peak) * (1.0 + 1e-12)).unwrap();
        assert!(cycles(&beyond).unwrap().is_empty());
    }
    assert_eq!(folds, 6);
}

#[test]
fn many_cycles_are_all_found() {
    friction_law! {
        /// A slope that changes its sign many times.
        Wavy: 1.0, |s| (s * 40.0).cos() * 0.05 + 0.5
    }
    for v_b in some(1, [0.5, 1.0, 2.0]) {
        let system = on_belt(Wavy, v_b, 0.001, 1.0);
        let found = cycles(&system).unwrap();
        assert!(found.len() >= 6);
        assert_eq!(found.len(), scan(&system, 2000));
        assert!(
            found
                .windows(2)
                .all(|pair| pair[0].is_stable() != pair[1].is_stable())
        );
    }
}

/// Friction falls, rises and falls again, so that there are several cycles below the belt velocity.
fn saw() -> Table {
    Table {
        static_coefficient: 0.5,
        points: vec![
            (0.0, 0.5),
            (0.1, 0.3),
            (0.2, 0.5),
            (0.35, 0.2),
            (0.5, 0.6),
            (0.52, 0.55),
            (1.0, 0.2),
            (2.0, 0.9),
        ],
    }
}

#[test]
fn cycles_of_a_law_with_kinks_are_all_found() {
    let law = saw();
    let mut most = 0;
    for k in [1, 3, 5, 6, 8, 11] {
        let system = on_belt(&law, 0.09 * f64::from(k), 0.004, 1.0);
        let count = cycles(&system).unwrap().len();
        assert_eq!(count, scan(&system, 300), "{k}");
        most = most.max(count);
    }
    assert!(most >= 3, "{most}");
}

#[test]
fn averaged_crossing_cycles_know_when_they_would_stick() {
    // Fig. 5 set: the exact motion never sticks below ε2 = 0.0260202; by averaging Q
    // v_b²/(16γ⁴μ_s²) = 0.0255.
    let found = |epsilon: f64| {
        let system = paper(0.2)
            .with_damping(0.05 * epsilon)
            .unwrap()
            .with_load(epsilon)
            .unwrap();
        cycles(&system).unwrap()[0]
    };
    assert!(found(0.025).is_valid() && !found(0.0265).is_valid() && !found(1.0).is_valid());
}

/// Changes of sign of the drift, at n amplitudes up to 3|v_b|.
fn scan<L: FrictionLaw>(system: &MassOnBelt<L>, n: u32) -> usize {
    let step = 3.0 * system.belt_velocity().abs() / f64::from(n);
    let signs: Vec<bool> = (1..=n)
        .map(|k| drift(system, step * f64::from(k)).unwrap() > 0.0)
        .collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

#[test]
fn no_cycle_of_ordinary_systems_is_missed() {
    let mut random = Random::new(4);
    let (mut found, mut most) = (0, 0);
    for _ in 0..24 {
        let system = random.system();
        let count = cycles(&system).unwrap().len();
        assert_eq!(count, scan(&system, 150), "{system:?}");
        found += count;
        most = most.max(count);
    }
    assert!(found >= 8 && most >= 1, "{found} {most}");
}

#[test]
fn laws_that_end_are_errors() {
    let system = MassOnBelt::new(Ends, 0.5).unwrap();
    assert!(drift(&system, 0.2).is_ok());
    assert!(
        matches!(drift(&system, 0.4), Err(Error::NonFiniteFriction { speed, .. }) if speed > 0.8)
    );
    assert!(cycles(&system).is_err());
}

#[test]
fn amplitudes_do_not_depend_on_the_size_of_the_friction() {
    // The slow flow is linear in β and γ²: a factor 2ⁿ changes no bit of the amplitudes, however
    // weak it is.
    fn check<L: FrictionLaw>(law: L, v_b: f64, damping: f64, count: usize) {
        let found = |factor: f64| {
            let system = on_belt(&law, v_b, factor * damping, 0.5 * factor);
            let cycles = cycles(&system).unwrap();
            let scaled = |cycle: &AveragedCycle| (cycle.amplitude(), cycle.drift_slope() / factor);
            cycles.iter().map(scaled).collect::<Vec<_>>()
        };
        let expected = found(1.0);
        assert_eq!(expected.len(), count);
        assert_eq!(found(0.5_f64.powi(60)), expected);
    }
    let polynomial = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    check(polynomial, 0.42, 0.025, 1);
    check(polynomial, 0.2, 0.025, 1);
    check(Exponential::new(0.4, 0.3, 1.0).unwrap(), 1.45, 0.01, 2);
    check(saw(), 0.45, 0.004, 2);
    // Nor on how it is shared between μ̂ and γ²: the product alone counts.
    for v_b in [0.2, 0.42] {
        let found = |factor: f64| {
            let law = Polynomial::new(0.15 * factor, 0.0, 0.5).unwrap();
            let system = on_belt(law, v_b, 0.05, 1.0 / factor);
            cycles(&system).unwrap()
        };
        assert_eq!(found(1.0).len(), 1);
        assert_eq!(found(0.5_f64.powi(40)), found(1.0));
    }
}

#[test]
fn a_straight_law_that_the_damper_balances_has_no_isolated_cycle() {
    // 2β = −γ²μ̂' at every speed: A' = 0 for all A ≤ |v_b| but for rounding, and the jump takes
    // over above.
    for k in [1, 2, 5, 11, 23, 40] {
        let (slope, load, w) = (
            0.013 * f64::from(k),
            0.7 + 0.1 * f64::from(k),
            0.031 * f64::from(k),
        );
        let law = Table {
            static_coefficient: 2.0,
            points: vec![(0.0, 2.0), (1.0, 2.0 - slope)],
        };
        let system = on_belt(law, w, 0.5 * load * slope, load);
        assert!(drift(&system, w).unwrap().abs() < 1e-15 * load * w);
        assert!(drift(&system, 1.1 * w).unwrap() < -0.1 * load);
        assert!(cycles(&system).unwrap().is_empty(), "{k}");
    }
}

#[test]
fn the_drift_is_smooth_up_to_the_amplitude_at_which_the_mass_touches_the_belt() {
    // −½h1 − (9/8)h3 A², also at A = |v_b|, and −∞ from there on.
    let (system, formulas) = (paper(0.3), PureSlip::new(&paper(0.3)).unwrap());
    let expected = -0.5 * formulas.h1() - 1.125 * formulas.h3() * 0.09;
    for amplitude in [0.3_f64.next_down(), 0.3] {
        let slope = drift_slope(&system, amplitude).unwrap();
        assert!((slope - expected).abs() < 1e-14, "{slope} {expected}");
    }
    assert!(drift_slope(&system, 0.3_f64.next_up()).unwrap() < -1e6);
    // Where |v_b| + A overflows, no speed is left to look at.
    let fast = MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), 1e308).unwrap();
    assert!(drift(&fast, 7e307).is_ok());
    refused!(drift(&fast, 1e308) => Error::InvalidParameter { .. });
}

#[test]
fn cycles_of_ordinary_laws_take_few_looks_at_the_law() {
    // An amplitude takes 129 looks below |v_b|, and above it 2·12 panels with 48 each; a breakpoint
    // that is not counted with, or a piece that is not smooth, takes many times more.
    fn check<L: FrictionLaw>(law: L, v_b: f64, most: usize) {
        let asked = Default::default();
        let counted = Counted { law, asked: &asked };
        let system = on_belt(counted, v_b, 0.01, 1.0);
        cycles(&system).unwrap();
        assert!(asked[0].get() < most, "{v_b}: {asked:?}");
    }
    check(Coulomb::new(0.4, 0.25).unwrap(), 0.3, 50_000);
    check(Polynomial::new(0.4, 0.25, 0.5).unwrap(), 0.42, 160_000);
    check(Polynomial::new(0.4, 0.25, 0.5).unwrap(), 0.2, 160_000);
    check(saw(), 0.15, 380_000);
    check(saw(), 0.45, 650_000);
}

/// The growth rate of a law that falls within a small part of the belt velocity is as small as
/// exp(−w²/v_s²) at small amplitudes, but it has one sign there.
#[test]
fn a_growth_rate_over_hundreds_of_decades_needs_few_places() {
    let cases = [(0.2, 1e-4), (0.2, 1e-3), (3.0, 1e-3)];
    for (w, narrow) in some(1, cases) {
        let asked = Default::default();
        let law = Exponential::new(0.4, 0.0, narrow).unwrap();
        let law = Counted { law, asked: &asked };
        let found = cycles(&MassOnBelt::new(law, w).unwrap()).unwrap();
        assert_eq!(found.len(), 1);
        let amplitude = found[0].amplitude();
        assert!(w < amplitude && amplitude < w + narrow, "{amplitude}");
        // Without the logarithm of the rate it takes 1223 to 1345 pieces.
        assert!(asked[0].get() < 6_000_000, "{asked:?}");
    }
}

/// Slopes and rates near the ends of f64 are computed or refused, in few evaluations.
#[test]
fn laws_at_the_ends_of_f64_are_computed_or_refused() {
    let mut refused = 0;
    let mut computed = 0;
    for top in [1e-300, 1e150, 1e300, 1e307, 5e307, 1.7e308] {
        for (least, width) in [(0.0, 0.5), (0.5 * top, 0.01), (0.5 * top, 1e3), (top, 1.0)] {
            for w in some(1, [0.2, 1e-5, 3.0]) {
                let asked = Default::default();
                let Ok(law) = Exponential::new(top, least, width) else {
                    continue;
                };
                let Ok(system) = MassOnBelt::new(Counted { law, asked: &asked }, w) else {
                    continue;
                };
                match cycles(&system) {
                    Ok(found) => {
                        computed += 1;
                        for cycle in found {
                            let numbers = [cycle.amplitude(), cycle.drift_slope()];
                            assert!(numbers.iter().all(|x| x.is_finite()), "{cycle:?}");
                        }
                    }
                    Err(Error::InvalidParameter { name: "load", .. }) => refused += 1,
                    // The slope of the law itself overflows.
                    Err(Error::NotAnalytic { .. }) => {}
                    Err(error) => panic!("{error:?}"),
                }
                let drift = drift(&system, 1.5 * w).unwrap_or(0.0);
                assert!(drift.is_finite());
                assert!(
                    asked[0].get() < 6_000_000,
                    "{top} {least} {width} {w}: {asked:?}"
                );
            }
        }
    }
    assert!(
        refused > 0 && computed > count(7, 20),
        "{refused} {computed}"
    );
}

#[test]
fn polynomial_law_has_closed_forms() {
    let [a, b, c, d, e, f] = RANGES;
    for_all(48, [a, b, c, d, e, f, 0.0..2.5], |[numbers @ .., reach]| {
        let system = system(numbers);
        let [static_coefficient, _, minimum_velocity, .., load] = numbers;
        let w = system.belt_velocity();
        let formulas = PureSlip::new(&system).unwrap();
        let amplitude: f64 = reach * w;
        let (h1, h3) = (formulas.h1(), formulas.h3());
        // A' = −½h1A − (3/8)h3A³ − (2γ²μ_s/π) sin s: Eq. 3 continues through v_r = 0 but for
        // the jump.
        let jump = 2.0 * load * static_coefficient / PI;
        // √(1 − w²/A²), to the last digits near A = w too.
        let sine = ((amplitude - w).max(0.0) * (amplitude + w)).sqrt() / amplitude;
        let crossing = amplitude > w && sine > 0.0;
        let loss = if crossing { jump * sine } else { 0.0 };
        let expected = -0.5 * h1 * amplitude - 0.375 * h3 * amplitude.powi(3) - loss;
        let value = drift(&system, amplitude).unwrap();
        let tolerance = 1e-13 * expected.abs().max(1.0);
        prop_assert!(
            (value - expected).abs() <= tolerance,
            "{} {}",
            value,
            expected
        );
        let steepening = if crossing {
            jump * w * w / (amplitude.powi(3) * sine)
        } else {
            0.0
        };
        let expected = -0.5 * h1 - 1.125 * h3 * amplitude * amplitude - steepening;
        let value = drift_slope(&system, amplitude).unwrap();
        let tolerance = 1e-13 * expected.abs().max(1.0);
        prop_assert!(
            (value - expected).abs() <= tolerance,
            "{} {}",
            value,
            expected
        );

        // At most one cycle: A0 if it does not reach the belt, else one that overtakes it.
        let found = cycles(&system).unwrap();
        prop_assert_eq!(found.len(), usize::from(h1 < 0.0));
        for cycle in found {
            prop_assert!(cycle.is_stable() && cycle.amplitude() < 2.0 * w);
            if formulas.is_valid() {
                let a0 = formulas.amplitude().unwrap();
                // The amplitude carries the rounding of h1, h1 ∝ A0².
                let tolerance = 1e-13 * (1.0 + 1e-2 * (minimum_velocity / a0).powi(2));
                prop_assert!((cycle.amplitude() / a0 - 1.0).abs() < tolerance);
                prop_assert!((cycle.drift_slope() - h1).abs() < 1e-13);
                prop_assert_eq!(cycle.leading_duration(), 0.0);
                prop_assert!(cycle.is_valid());
            } else {
                let amplitude = cycle.amplitude();
                prop_assert!(amplitude > w * (1.0 - 1e-13));
                // Just above w the drift may fall by 1e-12 from one amplitude to the next number.
                let ulp = amplitude.next_up() - amplitude;
                let tolerance = 1e-13 + cycle.drift_slope().abs() * ulp;
                prop_assert!(drift(&system, amplitude).unwrap().abs() < tolerance);
                let meeting = (0.5 * cycle.leading_duration()).cos() * amplitude;
                prop_assert!((meeting / w - 1.0).abs() < 1e-14);
            }
        }
        Ok(())
    });
}
