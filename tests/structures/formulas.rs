//! Closed formulas against motions.

use crate::common::{on_belt, one_mass};
use std::f64::consts::{FRAC_2_PI, PI, TAU};

use stick_slip::analysis::fast_vibration::{mean_coefficient, onset_velocity};
use stick_slip::analysis::mode_coupling::ModeCoupling;
use stick_slip::nalgebra::DMatrix;
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, FrictionLaw, Polynomial, Structure, Trajectory};

/// Largest distance of any coordinate from a place, between two times.
fn distance(motion: &Trajectory<State>, place: &[f64], from: f64, to: f64) -> f64 {
    let times = (0..2000).map(|k| from + (to - from) * f64::from(k) / 2000.0);
    motion
        .sample_at(times)
        .flat_map(|(_, state)| {
            let apart = state.displacements.into_iter().zip(place);
            apart
                .map(|(q, place)| (q - place).abs())
                .collect::<Vec<_>>()
        })
        .fold(0.0, f64::max)
}

/// Growth rate of a small disturbance of steady sliding, from the motion alone.
fn growth(structure: &Structure, late: f64) -> f64 {
    let place = structure.steady_sliding().unwrap().displacements;
    let mut start = State::new(&place, &vec![0.0; place.len()]);
    for (i, q) in start.displacements.iter_mut().enumerate() {
        *q += 1e-7 * (1.0 + i as f64);
    }
    let window = 100.0;
    let motion = structure.simulate(start, late + window).unwrap();
    assert!(motion.events().is_empty());
    // Twice the same number of slow beats apart.
    let [early, late_size] = [0.5 * late, late].map(|t| distance(&motion, &place, t, t + window));
    (late_size / early).ln() / (0.5 * late)
}

#[test]
fn flutter_grows_beyond_the_threshold_of_mode_coupling() {
    for damping in [[0.1, 0.05], [0.1, 0.02]] {
        let model = ModeCoupling {
            masses: [1.0, 1.0],
            stiffness: [[2.0, 1.0], [1.0, 2.5]],
            normal_stiffness: 4.0 / 3.0,
            damping,
        };
        let flutter = model.flutter().unwrap();
        let brake = |factor: f64| {
            let coefficient = factor * flutter.coefficient;
            let law = Coulomb::new(coefficient, coefficient).unwrap();
            let contact = Contact::new(0, law, 10.0)
                .and_then(|contact| contact.with_load_gradient(1, 4.0 / 3.0))
                .unwrap()
                .on_belt(5.0);
            let stiffness = DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.5]);
            Structure::new(&[1.0, 1.0])
                .and_then(|s| s.with_stiffness(stiffness))
                .and_then(|s| {
                    s.with_ground_damper(0, damping[0])?
                        .with_ground_damper(1, damping[1])
                })
                .and_then(|s| s.with_contact(contact))
                .unwrap()
        };
        for factor in [0.98, 1.0, 1.02] {
            let structure = brake(factor);
            let expected = structure.steady_sliding().unwrap().eigenvalues[0].re;
            let found = growth(&structure, 600.0);
            // The largest distance in a window lies up to half a swing from its ends.
            let allowed = expected.abs() * PI / flutter.angular_frequency / 300.0 + 1e-6;
            assert!(
                (found - expected).abs() < allowed,
                "{damping:?} {factor}: {found} {expected}"
            );
            assert!((expected - 0.0).abs() < 1e-14 || (factor - 1.0) * expected > 0.0);
        }
    }
}

/// A mass on a belt that creeps and shakes fast.
fn shaken<L: FrictionLaw + Send + Sync + 'static>(
    law: L,
    velocity: f64,
    amplitude: f64,
    damping: f64,
    omega: f64,
) -> Structure {
    let belt = Drive::harmonic(amplitude, omega, 0.0)
        .and_then(|belt| belt.with_constant(velocity))
        .unwrap();
    let contact = Contact::new(0, law, 1.0).unwrap().on_belt(belt);
    one_mass([1.0, damping, 1.0], 0.0, contact).unwrap()
}

#[test]
fn fast_vibration_makes_dry_friction_viscous() {
    let (kinetic, amplitude) = (0.3, 0.2);
    let law = Coulomb::new(kinetic, kinetic).unwrap();
    for velocity in [0.02, 0.1, 0.15] {
        let expected = mean_coefficient(&law, velocity, amplitude);
        assert!(expected < kinetic && expected > kinetic * FRAC_2_PI * velocity / amplitude);
        let mut errors = vec![];
        for omega in [50.0, 100.0] {
            let structure = shaken(law, velocity, amplitude, 0.5, omega);
            let motion = structure.simulate(State::at_rest(1), 60.0).unwrap();
            // Mean over whole periods, after the transient.
            let periods = (10.0 * omega / TAU).floor() * TAU / omega;
            let n = 4000;
            let times = (0..n).map(|k| 60.0 - periods * (f64::from(k) + 0.5) / f64::from(n));
            let sum: f64 = motion
                .sample_at(times)
                .map(|(_, state)| state.displacements[0])
                .sum();
            errors.push((sum / f64::from(n) - expected).abs());
        }
        // The limit for Ω → ∞.
        assert!(
            errors[0] < 0.01 && errors[1] < 0.6 * errors[0] + 1e-5,
            "{velocity}: {errors:?}"
        );
    }
}

#[test]
fn fast_vibration_quenches_above_the_onset() {
    let law = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    let system = on_belt(law, 0.2, 0.05, 1.0);
    let amplitude = 0.2;
    let onset = onset_velocity(&system, amplitude).unwrap();
    for (factor, grows) in [(0.98, true), (1.02, false)] {
        let structure = shaken(law, factor * onset, amplitude, 0.1, 60.0);
        // The place about which the slow motion swings: friction averaged over the fast motion.
        let velocity = factor * onset;
        let phases = (0..64).map(|k| (TAU * f64::from(k) / 64.0).cos());
        let place = phases
            .map(|c| law.kinetic(velocity + amplitude * c))
            .sum::<f64>()
            / 64.0;
        let start = State::new(&[place + 0.05], &[0.0]);
        let motion = structure.simulate(start, 320.0).unwrap();
        let early = distance(&motion, &[place], 20.0, 40.0);
        let late = distance(&motion, &[place], 300.0, 320.0);
        assert_eq!(late > early, grows, "{factor}: {early} {late}");
    }
}
