//! What is measured on a vibrating machine: rms and peak values, spectra; against each other and
//! against samples.

use crate::common::on_belt;
use proptest::prelude::*;
use stick_slip::nalgebra::Complex;
use stick_slip::{Coulomb, Exponential, LimitCycle, MassOnBelt, Mode, Polynomial, limit_cycle};

fn cycles() -> Vec<LimitCycle> {
    let mut all = Vec::new();
    for (v_b, damping) in [
        (0.2, 0.05),
        (0.41, 0.05),
        (0.05, 0.05),
        (0.1, 0.0),
        (-0.3, 0.02),
    ] {
        let law = Polynomial::new(0.4, 0.25, 0.5).unwrap();
        let system = on_belt(law, v_b, damping, 1.0);
        all.extend(limit_cycle::find(&system).unwrap());
    }
    let law = Exponential::new(0.6, 0.3, 0.4).unwrap();
    let system = on_belt(law, 1.0, 0.01, 1.0);
    all.extend(limit_cycle::find(&system).unwrap());
    assert!(all.len() >= 7);
    all
}

/// A cycle whose displacements and period are so large that their product overflows.
#[test]
fn harmonics_of_a_long_cycle_are_numbers() {
    let law = Coulomb::new(1.35, 0.95).unwrap();
    let system = on_belt(law, 0.01, 0.0, 1e263);
    for cycle in &limit_cycle::find(&system).unwrap() {
        assert!(cycle.period() * cycle.amplitude() == f64::INFINITY);
        let mean = cycle.mean_displacement();
        assert!((cycle.min_displacement()..cycle.max_displacement()).contains(&mean));
        for amplitude in cycle.harmonics(3) {
            assert!(amplitude.norm() <= 2.0 * cycle.amplitude(), "{amplitude}");
        }
    }
}

/// The mean square of a sum of harmonics: half the sum of the squares of their amplitudes.
fn power(harmonics: &[Complex<f64>]) -> f64 {
    0.5 * harmonics.iter().map(|a| a.norm_sqr()).sum::<f64>()
}

#[test]
fn parseval_holds_for_velocity_and_acceleration() {
    for cycle in cycles() {
        // The mean of both is 0 over a period. What is left out falls off as n⁻³ and n⁻¹.
        let n = 60;
        let smooth = cycle.stick_duration() == 0.0 && cycle.leading_duration() == 0.0;
        let (v, a) = (cycle.velocity_harmonics(n), cycle.acceleration_harmonics(n));
        let missing_v = 1.0 - power(&v) / cycle.rms_velocity().powi(2);
        let missing_a = 1.0 - power(&a) / cycle.rms_acceleration().powi(2);
        let (small_v, small_a) = if smooth { (1e-13, 1e-12) } else { (1e-5, 0.02) };
        // What is missing is not negative but for rounding.
        assert!(
            (-1e-13..small_v).contains(&missing_v),
            "{cycle}: {missing_v:e}"
        );
        assert!(
            (-1e-12..small_a).contains(&missing_a),
            "{cycle}: {missing_a:e}"
        );
        if !smooth {
            // And it falls off as it must.
            let half = 1.0 - power(&a[..n / 2]) / cycle.rms_acceleration().powi(2);
            let order = (half / missing_a).log2();
            assert!(order > 0.7, "{cycle}: {order}");
        }
    }
}

#[test]
fn rms_and_peak_accelerations_are_those_of_samples() {
    for cycle in cycles() {
        let motion = cycle.trajectory();
        let n = 200_000;
        let (mut squares, mut peak, mut fastest) = (0.0, 0.0_f64, 0.0_f64);
        let step = cycle.period() / f64::from(n);
        let belt = motion
            .steps()
            .iter()
            .find(|step| step.mode() == Mode::Stick);
        let mut last = motion.state_at(0.0).unwrap().velocity;
        for i in 1..=n {
            let state = motion
                .state_at(step * f64::from(i))
                .unwrap_or_else(|| motion.last());
            let acceleration = (state.velocity - last) / step;
            last = state.velocity;
            squares += acceleration * acceleration / f64::from(n);
            peak = peak.max(acceleration.abs());
            if let Some(belt) = belt {
                fastest = fastest.max((state.velocity - belt.state().velocity).abs());
            }
        }
        assert!(
            (squares.sqrt() / cycle.rms_acceleration() - 1.0).abs() < 1e-4,
            "{cycle}"
        );
        assert!(
            (peak / cycle.peak_acceleration() - 1.0).abs() < 1e-4,
            "{cycle}"
        );
        if belt.is_some() {
            assert!(
                (fastest / cycle.max_sliding_speed() - 1.0).abs() < 1e-7,
                "{cycle}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// Parseval once more, for any stick-slip cycle; and no harmonic exceeds what the rms value
    /// allows.
    #[test]
    fn spectra_and_rms_values_agree(v_b in 0.02..0.4_f64, damping in 0.0..0.1_f64) {
        let law = Polynomial::new(0.4, 0.25, 0.5).unwrap();
        let system = on_belt(law, v_b, damping, 1.0);
        let Some(cycle) = limit_cycle::stick_slip(&system).unwrap() else { return Ok(()) };
        let v = cycle.velocity_harmonics(24);
        prop_assert!((power(&v) / cycle.rms_velocity().powi(2) - 1.0).abs() < 1e-2);
        for (a, b) in v.iter().zip(cycle.harmonics(24)).skip(1) {
            prop_assert!(a.norm() <= 2.0_f64.sqrt() * cycle.rms_velocity());
            prop_assert!(b.norm() <= a.norm() / cycle.frequency());
        }
        prop_assert!(cycle.peak_acceleration() >= cycle.rms_acceleration());
    }
}

/// Two laws with different static coefficients have the same period and amplitude; the time in
/// stick tells them apart.
#[test]
fn period_and_amplitude_do_not_settle_a_law() {
    let vibration = |[static_coefficient, velocity]: [f64; 2]| {
        let law = Polynomial::new(static_coefficient, 0.25, velocity).unwrap();
        let system = MassOnBelt::new(law, 0.2).unwrap();
        let cycle = limit_cycle::stick_slip(&system.with_damping(0.05).unwrap());
        let cycle = cycle.unwrap().unwrap();
        ([cycle.period(), cycle.amplitude()], cycle.stick_duration())
    };
    let (wanted, stick) = vibration([0.43, 0.62]);
    let mut other = [0.4623, 0.3379];
    for _ in 0..8 {
        let (now, _) = vibration(other);
        let columns = [0, 1].map(|i| {
            let mut shifted = other;
            shifted[i] += 1e-6;
            let (above, _) = vibration(shifted);
            [0, 1].map(|k| (above[k] - now[k]) / 1e-6)
        });
        let [[a, c], [b, d]] = columns;
        let missing = [0, 1].map(|k| wanted[k] - now[k]);
        let determinant = a * d - b * c;
        other[0] += (d * missing[0] - b * missing[1]) / determinant;
        other[1] += (a * missing[1] - c * missing[0]) / determinant;
    }
    assert!(
        (other[0] - 0.4623).abs() < 1e-4 && (other[1] - 0.3379).abs() < 1e-4,
        "{other:?}"
    );
    let (found, other_stick) = vibration(other);
    for (found, wanted) in found.iter().zip(wanted) {
        assert!((found - wanted).abs() < 1e-13, "{found} {wanted}");
    }
    assert!((stick - other_stick).abs() > 0.06, "{stick} {other_stick}");
}
