use approx::assert_abs_diff_eq;
use num_bigint::BigInt;
use proptest::prelude::*;

use super::*;
use crate::scalar::Scalar;
use std::f64::consts::{PI, TAU};

/// π in hexadecimal, without the point.
const PI_HEX: &[u8] = b"3243F6A8885A308D313198A2E03707344A4093822299F31D0082EFA98EC4E6C89\
452821E638D01377BE5466CF34E90C6";
const PI_SHIFT: u32 = 4 * (PI_HEX.len() as u32 - 1);

/// sin and cos of Ω·(time + offset), the phase reduced in exact arithmetic.
fn exact_sin_cos(frequency: f64, times: &[f64]) -> (f64, f64) {
    /// Fixed point: no factor of these tests is below 2⁻³⁰⁰ in its last bit.
    const SHIFT: u32 = 600;
    let fixed = |x: f64| -> BigInt {
        if x == 0.0 {
            return BigInt::ZERO;
        }
        let bits = x.abs().to_bits();
        let exponent = ((bits >> 52) as i64).max(1) - 1075;
        let mantissa = (bits & ((1 << 52) - 1)) | (u64::from(bits >> 52 > 0) << 52);
        let shift = exponent + 300;
        assert!(shift >= 0, "{x:e}");
        let size = BigInt::from(mantissa) << shift as u32;
        if x < 0.0 { -size } else { size }
    };
    let time: BigInt = times.iter().map(|&t| fixed(t)).sum();
    let phase = fixed(frequency) * time;
    let pi = BigInt::parse_bytes(PI_HEX, 16).unwrap() << (SHIFT - PI_SHIFT);
    let turn: BigInt = &pi * 2;
    let mut rest = phase % &turn;
    if rest < BigInt::ZERO {
        rest += &turn;
    }
    // Quadrants by reflection, so that sine and cosine are good relatively too.
    let quadrant: BigInt = (&rest * 2 + &pi / 2) / &pi;
    let centre = &pi * &quadrant / 2;
    let small: BigInt = rest - centre;
    let small: BigInt = small >> (SHIFT - 200);
    let radians = small.to_string().parse::<f64>().unwrap() / 2_f64.powi(200);
    let (sine, cosine) = radians.sin_cos();
    let quadrant: BigInt = quadrant % 4;
    match quadrant.to_string().as_str() {
        "0" => (sine, cosine),
        "1" => (cosine, -sine),
        "2" => (-sine, -cosine),
        _ => (-cosine, sine),
    }
}

#[test]
fn a_sine_is_zero_at_time_0_to_the_bit() {
    for (amplitude, frequency) in [(0.3, 0.7), (-1e200, 1e-200), (5e-324, 1e100), (1e-3, 3e18)] {
        let sine = Drive::sine(amplitude, frequency).unwrap();
        assert_eq!(sine.value(0.0), 0.0);
        assert_eq!(sine.slope(0.0), amplitude * frequency);
    }
}

#[test]
fn phases_are_exact_after_a_billion_periods() {
    for frequency in [0.55, 1.0, 2.0_f64.sqrt(), 7.3e-3, 3.7e4] {
        let drive = Drive::harmonic(0.7, frequency, 0.0)
            .and_then(|drive| drive.with_sine(0.3, frequency))
            .unwrap();
        for periods in [
            0.0,
            0.25,
            1.0,
            1e3,
            1e6,
            1e6 + 0.25,
            1e9,
            1e9 + 0.5,
            1e12,
            1e15,
        ] {
            for offset in [0.0, 1e-3, -0.4] {
                let time = periods * (TAU / frequency);
                let step = 1e-3 + offset / frequency;
                let clock = Clock::at(time).after(step);
                let (sine, cosine) = exact_sin_cos(frequency, &[time, step]);
                let [value, slope] = drive.at(clock);
                let exact = 0.7 * cosine + 0.3 * sine;
                let exact_slope = frequency * (0.3 * cosine - 0.7 * sine);
                // The clock itself is good to ε² of the time.
                let clock_error = 2_f64.powi(-105) * time * frequency;
                let allowed = 4e-16 + clock_error;
                assert!(
                    (value - exact).abs() <= allowed,
                    "{frequency} {periods}: {value} {exact}"
                );
                assert_abs_diff_eq!(slope, exact_slope, epsilon = allowed * frequency);
            }
        }
    }
}

#[test]
fn a_clock_stepped_through_a_million_periods_keeps_the_phase() {
    let frequency = 1.3;
    let drive = Drive::sine(1.0, frequency).unwrap();
    let step = 0.1;
    let mut clock = Clock::default();
    let steps = 50_000_000_u32;
    for _ in 0..steps {
        clock = clock.after(step);
    }
    // steps·0.1, exact in two numbers.
    let high = f64::from(steps) * step;
    let low = f64::from(steps).mul_add(step, -high);
    let (sine, _) = exact_sin_cos(frequency, &[high, low]);
    let value = drive.at(clock)[0];
    assert!((value - sine).abs() < 5e-16, "{value} {sine}");
    // The rounded time alone is far off: the test would notice.
    assert!((drive.value(high) - sine).abs() > 1e-11);
}

#[test]
fn series_continue_values_and_slopes() {
    let drive = Drive::constant(0.3)
        .with_harmonic(0.5, 1.3, 0.4)
        .and_then(|drive| drive.with_sine(-0.2, 3.1))
        .and_then(|drive| drive.with_profile(&[(0.0, 0.0), (4.0, 1.0), (4.0, 0.5), (6.0, 0.5)]))
        .unwrap();
    for (start, end) in [(0.0, 0.9), (1.5, 2.5), (4.0, 5.0), (5.0, 5.9), (6.0, 7.0)] {
        let series = drive.series(Clock::at(start));
        for t in [0.0, 0.3 * (end - start), end - start] {
            let [value, slope] = [drive.value(start + t), drive.slope(start + t)];
            assert!((series.at(t) - value).abs() < 3e-15, "{start} + {t}");
            assert!(
                (series.derivative().at(t) - slope).abs() < 1e-14,
                "{start} + {t}"
            );
        }
    }
}

#[test]
fn a_step_ends_where_pieces_meet_and_goes_on_with_the_next() {
    let points = [(1.0, 0.0), (2.0, 1.0), (2.0, 0.5), (3.0, 0.5), (4.0, -1.0)];
    let drive = Drive::profile(&points).unwrap();
    assert_eq!(drive.first_jump(), Some(2.0));
    let mut breaks = vec![];
    let mut clock = Clock::at(-10.0);
    while let Some(time) = drive.next_break(clock) {
        breaks.push(time);
        clock = Clock::at(time);
    }
    assert_eq!(breaks, [1.0, 2.0, 3.0, 4.0]);
    let piece = |time| drive.at(Clock::at(time));
    assert_eq!(piece(1.0), [0.0, 1.0]);
    assert_eq!(piece(2.0), [0.5, 0.0]);
    assert_eq!(piece(3.0), [0.5, -1.5]);
    assert_eq!(piece(4.0), [-1.0, 0.0]);
    assert_eq!(drive.value(2.0_f64.next_down()), 1.0 - f64::EPSILON);
    // Within an ulp of the kink the remainder of the clock decides.
    let just_before = Clock::at(3.0).after(-1e-17);
    assert_eq!(drive.next_break(just_before), Some(3.0));
    assert_eq!(drive.at(just_before)[1], 0.0);
    assert_eq!(drive.at(Clock::at(3.0).after(1e-17))[1], -1.5);
}

#[test]
fn integrals_are_closed() {
    let drive = Drive::constant(0.3)
        .with_harmonic(0.5, 1.3, 0.4)
        .and_then(|drive| drive.with_sine(-0.2, 3.1))
        .and_then(|drive| drive.with_profile(&[(0.0, 0.0), (4.0, 1.0), (4.0, 0.5), (6.0, 0.5)]))
        .unwrap();
    let mut total = 0.0;
    for (from, to) in [
        (-1.0, -0.5),
        (-0.5, 0.7),
        (0.7, 4.0),
        (4.0, 4.1),
        (4.1, 6.0),
        (6.0, 9.0),
    ] {
        let parts = 64;
        let quadrature: f64 = (0..parts)
            .map(|i| {
                let at = |i: usize| from + (to - from) * i as f64 / parts as f64;
                crate::numerics::gauss::gauss_legendre(at(i), at(i + 1), |t| drive.value(t))
            })
            .sum();
        let closed = drive.integral(Clock::at(from), Clock::at(to));
        // Panels that hold a kink are not integrated exactly; kinks are at ends here.
        assert!(
            (closed - quadrature).abs() < 1e-3,
            "{from} {to}: {closed} {quadrature}"
        );
        total += closed;
    }
    let whole = drive.integral(Clock::at(-1.0), Clock::at(9.0));
    assert!((whole - total).abs() < 3e-15, "{whole} {total}");

    // Over 10⁶ periods of a sine and a bit: only the bit is left.
    let sine = Drive::sine(1.0, 1.3).unwrap();
    let time = 1e6 * TAU / 1.3;
    let (_, cosine) = exact_sin_cos(1.3, &[time]);
    let closed = sine.integral(Clock::at(0.0), Clock::at(time));
    assert_abs_diff_eq!(closed, (1.0 - cosine) / 1.3, epsilon = 4e-16);
}

#[test]
fn common_periods_are_the_least() {
    let period = |frequencies: &[f64]| {
        let mut drive = Drive::constant(1.0);
        for &frequency in frequencies {
            drive = drive.with_sine(1.0, frequency).unwrap();
        }
        drive.period()
    };
    assert_eq!(period(&[]), None);
    assert_eq!(period(&[2.0]), Some(PI));
    assert_eq!(period(&[1.65, 0.55]), Some(TAU / 0.55));
    assert_eq!(period(&[2.0, 3.0]), Some(TAU));
    assert_eq!(period(&[0.3, 0.2, 0.5]), Some(TAU * 2.0 / 0.2));
    assert_eq!(period(&[1.0, 1.001]), Some(TAU * 1000.0));
    assert_eq!(period(&[1.0, 1.0 + 1.0 / 1001.0]), None);
    assert_eq!(period(&[1.0, 2.0_f64.sqrt()]), None);
    // Together with another drive, and none beside a profile.
    let [a, b] = [2.0, 3.0].map(|frequency| Drive::sine(1.0, frequency).unwrap());
    assert_eq!(common_period([&a, &b, &Drive::constant(3.0)]), Some(TAU));
    let ramp = Drive::profile(&[(0.0, 0.0), (1.0, 1.0)]).unwrap();
    assert_eq!(common_period([&a, &ramp]), None);
    let flat = Drive::profile(&[(0.0, 0.4), (1.0, 0.4)]).unwrap();
    assert_eq!(flat, Drive::constant(0.4));
}

#[test]
fn terms_of_one_frequency_are_one_term_and_may_cancel() {
    let drive = Drive::sine(0.4, 2.0)
        .and_then(|drive| drive.with_sine(-0.4, 2.0))
        .unwrap();
    assert!(drive.is_constant());
    assert_eq!(drive, Drive::from(0.0));
    assert!(Drive::sine(0.0, 1.0).unwrap().is_constant());
    let either = |first, second| {
        Drive::sine(0.4, first)
            .and_then(|drive| drive.with_sine(0.4, second))
            .unwrap()
    };
    assert_eq!(either(1.0, 2.0), either(2.0, 1.0));
}

#[test]
fn sums_and_slopes_that_overflow_and_points_out_of_order_are_refused() {
    assert!(Drive::constant(f64::MAX).with_constant(f64::MAX).is_err());
    let largest = Drive::sine(f64::MAX, 1.0).unwrap();
    assert!(largest.with_sine(f64::MAX, 1.0).is_err());
    assert!(Drive::sine(1e200, 1e150).is_err());
    let steep = Drive::sine(1e150, 1e158).unwrap();
    let steep = steep.with_harmonic(1e150, 1e157, 1.0).unwrap();
    for time in [0.0, 1.0, -1e100, 1e150] {
        assert!(steep.value(time).abs() < 2e150 && steep.slope(time).is_finite());
    }
    // Beyond the largest number there is no phase.
    assert!(steep.value(1e151).is_nan() && steep.slope(1e151).is_nan());
    let refused = |points: &[(f64, f64)]| Drive::profile(points).unwrap_err();
    let at = |points: &[(f64, f64)]| match refused(points) {
        Error::BadPoint { index, name, .. } => (index, name),
        other => panic!("{other:?}"),
    };
    assert_eq!(at(&[(0.0, 1.0), (1.0, 2.0), (0.5, 0.0)]), (2, "time"));
    assert_eq!(at(&[(0.0, 1.0), (0.0, 2.0), (0.0, 0.0)]), (2, "time"));
    assert_eq!(at(&[(0.0, -1e308), (1.0, 1e308)]), (1, "time"));
    assert_eq!(at(&[(-1e308, 0.0), (1e308, 1.0)]), (1, "time"));
    assert_eq!(at(&[(0.0, 0.0), (1e-300, 1e10)]), (1, "time"));
}

proptest! {
    #[test]
    fn profiles_go_through_their_points_and_are_straight_between(
        steps in prop::collection::vec((1e-3..10.0_f64, -5.0..5.0_f64), 2..8),
        start in -20.0..20.0_f64,
        inside in 0.0..1.0_f64,
    ) {
        let mut time = start;
        let points: Vec<_> = steps.iter().map(|&(step, value)| {
            time += step;
            (time, value)
        }).collect();
        let drive = Drive::profile(&points).unwrap();
        for &(time, value) in &points {
            prop_assert_eq!(drive.value(time), value);
        }
        for pair in points.windows(2) {
            let [(t0, v0), (t1, v1)] = [pair[0], pair[1]];
            let t = t0 + inside * (t1 - t0);
            let expected = v0 + (v1 - v0) * ((t - t0) / (t1 - t0));
            prop_assert!((drive.value(t) - expected).abs() < 1e-13);
        }
        prop_assert_eq!(drive.value(start - 1.0), points[0].1);
        prop_assert_eq!(drive.value(time + 1.0), points[points.len() - 1].1);
    }

    #[test]
    fn parts_of_an_integral_add_up(
        amplitude in -2.0..2.0_f64,
        frequency in 0.01..50.0_f64,
        phase in -10.0..10.0_f64,
        (from, middle, to) in (-50.0..50.0_f64, 0.0..20.0_f64, 0.0..20.0_f64),
    ) {
        let drive = Drive::harmonic(amplitude, frequency, phase)
            .and_then(|drive| {
                drive.with_profile(&[(-3.0, 0.2), (0.0, 1.0), (0.0, 0.0), (9.0, -1.0)])
            })
            .unwrap();
        let start = Clock::at(from);
        let [half, end] = [start.after(middle), start.after(middle).after(to)];
        let sum = drive.integral(start, half) + drive.integral(half, end);
        let whole = drive.integral(start, end);
        let size = 1.0 + amplitude.abs() / frequency + 50.0;
        prop_assert!((sum - whole).abs() < 8.0 * f64::EPSILON * size, "{} {}", sum, whole);
    }
}

/// A Gaussian bump every 2.5, and 0.5 more from 2 to 2.5.
struct Train;

impl TimeFunction for Train {
    fn value<S: Scalar>(&self, time: S, piece: usize) -> S {
        let bump = (-((time - 1.0) / 0.1).square()).exp();
        if piece == 0 { bump } else { bump + 0.5 }
    }
    fn size(&self) -> f64 {
        1.0
    }
    fn timescale(&self, _: usize) -> f64 {
        0.1
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        std::iter::once(2.0)
    }
    fn period(&self) -> Option<f64> {
        Some(2.5)
    }
}

#[test]
fn a_function_repeats_its_pieces_in_both_directions_of_time() {
    let drive = Drive::constant(0.2).with_function(Train).unwrap();
    assert_eq!(
        drive.breaks_in(-3.0, 5.0),
        [-2.5, -0.5, 0.0, 2.0, 2.5, 4.5, 5.0]
    );
    for (time, before, after) in [(-0.5, 0.2, 0.7), (0.0, 0.7, 0.2), (2.0, 0.2, 0.7)] {
        assert_abs_diff_eq!(drive.just_before(time), before, epsilon = 1e-16);
        assert_abs_diff_eq!(drive.value(time), after, epsilon = 1e-16);
        assert!(drive.jumps_at(time));
    }
    assert!(!drive.jumps_at(1.0));
    assert_eq!(drive.first_jump(), Some(0.0));
    assert_eq!((drive.size(), drive.period()), (1.2, Some(2.5)));
    // After 10⁹ periods the phase is that of the first.
    let late = Clock::at(2.5e9).after(1.03);
    assert_abs_diff_eq!(drive.at(late)[0], drive.value(1.03), epsilon = 1e-15);
    // A bump that touches the ends of a period by less than 1e-40.
    let area = 0.2 * 2.5 + 0.5 * 0.5 + 0.1 * PI.sqrt();
    let [from, to] = [Clock::at(0.3), Clock::at(0.3).after(2.5e3)];
    assert_abs_diff_eq!(drive.integral(from, to), 1e3 * area, epsilon = 1e-12);
    let doubled = drive.scaled(2.0).plus(&drive).unwrap();
    assert_abs_diff_eq!(doubled.value(1.0), 3.0 * 1.2, epsilon = 1e-15);
    assert_eq!(doubled.size(), 0.6 + 3.0);
    // The common period with a harmonic.
    let harmonic = Drive::sine(1.0, TAU / 7.5).unwrap();
    let common = common_period([&drive, &harmonic]).unwrap();
    assert_abs_diff_eq!(common, 7.5, epsilon = 1e-14);
}

#[test]
fn a_function_is_its_series_at_late_times_too() {
    let drive = Drive::function(Train).unwrap();
    for start in [0.9, 1e4 + 0.9] {
        let clock = Clock::at(start).after(1e-14);
        let series = drive.series(clock);
        for t in [0.0, 0.01, 0.03] {
            assert_abs_diff_eq!(series.at(t), drive.at(clock.after(t))[0], epsilon = 1e-14);
            let slope = drive.at(clock.after(t))[1];
            assert_abs_diff_eq!(series.slope_at(t), slope, epsilon = 1e-12);
        }
        let [defect, size] = drive.defects(clock, 0.03).next().unwrap();
        assert!(defect < 1e-14 && size == 1.0);
        // A step over the bump that follows is seen.
        let far = Clock::at(start - 0.85);
        assert!(drive.defects(far, 1.5).next().unwrap()[0] > 0.5);
    }
}
