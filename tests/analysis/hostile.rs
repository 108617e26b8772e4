//! Formulas of plain numbers, with every kind of bad number: no panic, no endless loop, no result
//! from a NaN, and none that is half a number.

use std::f64::consts::FRAC_2_PI;

use stick_slip::analysis::PureSlip;
use stick_slip::analysis::coulomb::tangential_slip;
use stick_slip::analysis::drill_string::TwoInertias;
use stick_slip::analysis::duffing::{friction_decay, period, response};
use stick_slip::analysis::dwell::{DwellOscillator, ExactCycle};
use stick_slip::analysis::fast_vibration::{mean_coefficient, onset_velocity};
use stick_slip::analysis::forced::{ForcedOscillator, no_stop_limit};
use stick_slip::analysis::jenkins::{
    SymmetricResponse, backbone, first_harmonic, loop_area, masing,
};
use stick_slip::analysis::mode_coupling::ModeCoupling;
use stick_slip::analysis::rate_state::{
    first_integral, healing, stress_drop, time_to_instability, velocity_step,
};
use stick_slip::{Coulomb, Drive, Dwell, Polynomial, RateState, TimeFunction};

use crate::common::{Random, count, on_belt};

/// A number as anyone may give it: an ordinary one as often as not.
fn bad(random: &mut Random) -> f64 {
    const BAD: [f64; 16] = [
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        0.0,
        -0.0,
        1.0,
        -1.0,
        5e-324,
        -5e-324,
        f64::MIN_POSITIVE,
        f64::EPSILON,
        f64::MAX,
        f64::MIN,
        1e154,
        1e-154,
        1e-300,
    ];
    if random.bits().is_multiple_of(2) {
        random.logarithmic(0.01, 100.0)
    } else {
        random.pick(&BAD)
    }
}

/// Draws of N numbers, and whether one of them is NaN.
fn draws<const N: usize>(seed: u64) -> impl Iterator<Item = ([f64; N], bool)> {
    let mut random = Random::new(seed);
    std::iter::repeat_with(move || {
        let numbers = std::array::from_fn(|_| bad(&mut random));
        (numbers, numbers.iter().any(|x| x.is_nan()))
    })
    .take(count(2_000, 40_000))
}

/// A result that exists has numbers in all its fields, and does not come from a NaN.
#[track_caller]
fn sound<const N: usize>(given: &[f64], result: Option<[f64; N]>) {
    let Some(result) = result else { return };
    assert!(!given.iter().any(|x| x.is_nan()), "{given:?}: {result:?}");
    assert!(result.iter().all(|x| !x.is_nan()), "{given:?}: {result:?}");
}

fn numbers(cycle: ExactCycle) -> [f64; 5] {
    let period = cycle.period();
    [
        period,
        cycle.belt_velocity,
        cycle.slip_duration,
        cycle.release_displacement,
        cycle.multiplier,
    ]
}

#[test]
fn springs_with_a_cubic_term() {
    for ([mass, stiffness, cubic, amplitude], _) in draws(1) {
        let given = [mass, stiffness, cubic, amplitude];
        let found = period(mass, stiffness, cubic, amplitude);
        sound(&given, found.map(|t| [t]));
        assert!(found.is_none_or(|t| t >= 0.0), "{given:?}: {found:?}");
    }
    for (given, is_nan) in draws(2) {
        let [m, k, c3, kinetic, fixed, start] = given;
        let Some(turns) = friction_decay(m, k, c3, kinetic, fixed, start) else {
            continue;
        };
        assert!(!is_nan, "{given:?}");
        let turns: Vec<_> = turns.take(50).collect();
        assert_eq!(turns[0], (0.0, start));
        for pair in turns.windows(2) {
            assert!(pair[1].0 >= pair[0].0, "{given:?}: {turns:?}");
            assert!(pair[1].1.abs() <= pair[0].1.abs(), "{given:?}: {turns:?}");
        }
    }
    for (given, is_nan) in draws(3) {
        let [m, c, k, c3, friction, force, omega] = given;
        let found = response(m, c, k, c3, friction, force, omega);
        assert!(found.is_empty() || !is_nan, "{given:?}");
        assert!(found.len() <= 3, "{given:?}");
        assert!(
            found.is_sorted_by(|a, b| a.amplitude <= b.amplitude),
            "{given:?}: {found:?}"
        );
    }
}

#[test]
fn jenkins_elements() {
    for (given, is_nan) in draws(4) {
        let [k_t, limit, amplitude, omega] = given;
        assert!(!is_nan || first_harmonic(k_t, limit, amplitude, omega).0.is_nan());
        let area = loop_area(k_t, limit, amplitude);
        let is_allowed = given[..3].iter().all(|&x| x > 0.0 && x.is_finite());
        assert_eq!(area.is_nan(), !is_allowed, "{given:?}: {area}");
        assert!(area.is_nan() || area >= 0.0, "{given:?}: {area}");
    }
    for (given, _) in draws(5) {
        let [m, c, k, k_t, limit, amplitude] = given;
        let found = backbone(m, c, k, k_t, limit, amplitude);
        let found = found.map(|point| [point.angular_frequency, point.damping_ratio]);
        sound(&given, found);
    }
    for (given, _) in draws(6) {
        let [m, c, k, k_t, limit, force, omega] = given;
        let found = SymmetricResponse::at(m, c, k, k_t, limit, force, omega);
        let found = found.map(|at| [at.amplitude, at.elastic_time, at.phase]);
        sound(&given, found);
    }
    for (history, _) in draws::<6>(7) {
        let found = masing(|x: f64| x.clamp(-1.0, 1.0), &history);
        assert_eq!(
            found.is_some(),
            history.iter().all(|x| x.is_finite()),
            "{history:?}"
        );
        let found = found.map(|forces| -> [f64; 6] { forces.try_into().unwrap() });
        sound(&history, found);
    }
}

#[test]
fn strings_modes_and_forced_vibration() {
    for (given, is_nan) in draws(8) {
        let [upper, lower, stiffness, damping, slope] = given;
        let string = TwoInertias {
            upper,
            lower,
            stiffness,
            damping,
        };
        let found = string.critical_slope();
        sound(&given[..4], found.map(|x| [x]));
        assert!(found.is_none_or(|x| x <= 0.0), "{given:?}: {found:?}");
        assert!(!(is_nan && string.is_stable(slope)), "{given:?}");
        let are_positive = given[..3].iter().all(|&x| x > 0.0);
        let best = string.best_damper();
        assert!(are_positive || best.is_nan(), "{given:?}: {best}");
    }
    for (given, _) in draws(9) {
        let [m1, m2, k11, k12, k21, k22, k3, c1, c2] = given;
        let model = ModeCoupling {
            masses: [m1, m2],
            stiffness: [[k11, k12], [k21, k22]],
            normal_stiffness: k3,
            damping: [c1, c2],
        };
        let found = model
            .flutter()
            .map(|at| [at.coefficient, at.angular_frequency]);
        sound(&given, found);
    }
    for (given, _) in draws(10) {
        let [damping, angular_frequency, kinetic, fixed, force] = given;
        let oscillator = ForcedOscillator {
            damping,
            angular_frequency,
            kinetic_friction: kinetic,
            static_friction: fixed,
            force,
        };
        let found = oscillator.without_stops().map(|motion| {
            let (x, v) = motion.at(0.3 * motion.period());
            [motion.amplitude(), motion.phase(), motion.period(), x, v]
        });
        sound(&given, found);
        let limit = no_stop_limit(angular_frequency);
        sound(&given[1..2], limit.map(|x| [x]));
    }
}

#[test]
fn stick_slip_with_dwell_and_of_coulomb() {
    let law = Coulomb::new(0.5, 0.4).unwrap();
    for (given, _) in draws(11) {
        let [mass, stiffness, damping, load, velocity, most, time] = given;
        let Ok(law) = Dwell::exponential(law, most, time) else {
            continue;
        };
        let oscillator = DwellOscillator {
            law,
            mass,
            stiffness,
            damping,
            load,
        };
        let fields = &given[..4];
        for cycle in [
            oscillator.stick_slip(velocity),
            oscillator.unstable_stick_slip(velocity),
        ] {
            sound(&given[..5], cycle.map(numbers));
        }
        sound(fields, oscillator.fold().map(numbers));
        let speeds = [
            oscillator.critical_velocity(),
            oscillator.grazing_velocity(),
        ];
        for speed in speeds.into_iter().flatten() {
            sound(fields, Some([speed]));
        }
    }
    for (given, _) in draws(12) {
        let [damping, velocity, amplitude] = given;
        let found = tangential_slip(damping).map(|slip| [slip.duration, slip.velocity_factor]);
        sound(&given[..1], found);
        assert_eq!(found.is_some(), damping > 0.0 && damping < 1.0, "{damping}");
        let mean = mean_coefficient(&law, velocity, amplitude);
        let is_allowed = !velocity.is_nan() && amplitude >= 0.0;
        assert_eq!(mean.is_nan(), !is_allowed, "{given:?}: {mean}");
        if is_allowed {
            assert!(
                mean.abs() <= 0.4 * (1.0 + f64::EPSILON),
                "{given:?}: {mean}"
            );
            assert!(
                mean == 0.0 || mean.signum() == velocity.signum(),
                "{given:?}: {mean}"
            );
        }
        let cubic = on_belt(Polynomial::new(0.4, 0.25, 0.5).unwrap(), 0.2, 0.05, 1.0);
        let found = onset_velocity(&cubic, amplitude);
        sound(&given[2..], found.map(|x| [x]));
        let formulas = PureSlip::new(&cubic).unwrap();
        if let Ok(transient) = formulas.transient(velocity, damping) {
            let found = transient.amplitude(amplitude).map(|x| [x]);
            sound(&given, found);
            let found = transient
                .state(amplitude)
                .map(|s| [s.displacement, s.velocity]);
            sound(&given, found);
        }
    }
    // A quarter of the swing is below half the velocity amplitude: arcsin ½ is a third of π/2.
    let third = mean_coefficient(&law, 0.1, 0.2);
    assert!((third - 0.4 * FRAC_2_PI * 0.5_f64.asin()).abs() < 1e-16);
}

#[test]
fn rate_and_state_friction() {
    let aging = RateState::aging(0.6, 0.01, 0.015, 1e-5, 1e-6).unwrap();
    let slip = RateState::slip(0.6, 0.01, 0.015, 1e-5, 1e-6).unwrap();
    for (given, _) in draws(14) {
        let [v1, v2, distance, load, stiffness, rate] = given;
        let are_speeds = [v1, v2].iter().all(|&v| v > 0.0 && v.is_finite());
        for law in [&aging, &slip] {
            let step = velocity_step(law, v1, v2, distance);
            assert!(are_speeds || step.is_nan(), "{given:?}: {step}");
            let drop = stress_drop(law, load, v1, v2);
            assert!(are_speeds || drop.is_nan(), "{given:?}: {drop}");
            let healed = healing(law, distance);
            let is_allowed = distance >= 0.0;
            assert_eq!(healed.is_nan(), !is_allowed, "{given:?}: {healed}");
            let time = time_to_instability(law, load, stiffness, v1, rate);
            let of = [v1, load, stiffness, rate];
            sound(&of, time.map(|t| [t]));
            assert!(time.is_none_or(|t| t >= 0.0), "{given:?}: {time:?}");
            let first = first_integral(law, v1, v2, distance);
            sound(&given[..3], first.map(|h| [h]));
        }
    }
}

/// A function of time that oscillates at any rate.
#[derive(Debug, Clone, Copy)]
struct Tone(f64);

impl TimeFunction for Tone {
    fn value<S: stick_slip::Scalar>(&self, time: S, _piece: usize) -> S {
        (time * self.0).sin()
    }

    fn size(&self) -> f64 {
        1.0
    }

    fn timescale(&self, _piece: usize) -> f64 {
        self.0.abs().recip()
    }
}

#[test]
fn drives() {
    for (given, _) in draws(13) {
        let [constant, amplitude, omega, phase, from, to, time, tempo] = given;
        let mut drives = vec![Drive::constant(constant)];
        drives.extend(Drive::harmonic(amplitude, omega, phase));
        drives.extend(Drive::profile(&[(from, constant), (to, amplitude)]));
        drives.extend(Drive::function(Tone(tempo)));
        let all = drives.iter().cloned();
        let sums: Vec<_> = all.flat_map(|d| d.with_sine(amplitude, omega)).collect();
        for drive in drives.iter().chain(&sums) {
            // At any time at all there is a value, or NaN, and no panic.
            let (value, slope) = (drive.value(time), drive.slope(time));
            let phase_is_finite = (omega * time).is_finite() && (tempo * time).is_finite();
            if time.is_finite() && phase_is_finite && constant.is_finite() {
                assert!(!value.is_nan(), "{given:?}: {drive:?}");
                assert!(!slope.is_nan(), "{given:?}: {drive:?}");
            }
            assert!(
                drive.period().is_none_or(|t| t > 0.0),
                "{given:?}: {drive:?}"
            );
        }
    }
}
