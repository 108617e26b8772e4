//! Closed forms: Den Hartog's symmetric motions and Csernák's continuum.

use std::f64::consts::PI;

use stick_slip::nalgebra::{Complex, Matrix2, Vector2};
use stick_slip::orbit::{Orbit, Period, settle, shoot};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, Structure};

use crate::common::one_mass;

/// x'' + 2ζx' + x = p cos Ωt − F sgn x'.
fn forced(frequency: f64, damping: f64, friction: f64, force: f64) -> Structure {
    let contact = Contact::new(0, Coulomb::new(friction, friction).unwrap(), 1.0).unwrap();
    let force = Drive::harmonic(force, frequency, 0.0).unwrap();
    one_mass([1.0, 2.0 * damping, 1.0], force, contact).unwrap()
}

/// Amplitude and multipliers of the symmetric motion without stops (J. P. Den Hartog, *Trans. ASME*
/// 53 (1931) 107-115): of half a period the map is −S Φ, Φ the free vibration and S the stretch of
/// velocities at a turn.
fn den_hartog(w: f64, z: f64, friction: f64, force: f64) -> (f64, [Complex<f64>; 2]) {
    let q = (1.0 - z * z).sqrt();
    let (a, b) = (PI * z / w, PI * q / w);
    let below = a.cosh() + b.cos();
    let (g, h) = (
        (a.sinh() - z / q * b.sin()) / below,
        b.sin() / (w * q * below),
    );
    let amplification = 1.0 / ((1.0 - w * w).powi(2) + (2.0 * z * w).powi(2)).sqrt();
    let forced = force * amplification;
    let amplitude = -g * friction + (forced * forced - (h * friction).powi(2)).sqrt();
    // C + E(Cc + Ds) + 2F = 0, −ζC + qD = ΩS, E[(−ζC + qD)c − (ζD + qC)s] + ΩS = 0.
    let (e, c, s) = ((-a).exp(), b.cos(), b.sin());
    let matrix = Matrix2::new(
        1.0 + e * c,
        e * s,
        -z + e * (-z * c - q * s),
        q + e * (q * c - z * s),
    );
    let solution = matrix
        .lu()
        .solve(&Vector2::new(-2.0 * friction, 0.0))
        .unwrap();
    let (big_c, big_d) = (solution[0], solution[1]);
    let sine = (-z * big_c + q * big_d) / w;
    let cosine = (forced * forced - sine * sine).sqrt();
    // x'' behind the maximum; before it friction acts the other way.
    let after = (z * z - q * q) * big_c - 2.0 * z * q * big_d - w * w * cosine;
    let stretch = after / (after - 2.0 * friction);
    let free = Matrix2::new(
        e * (c + z / q * s),
        e * s / q,
        -e * s / q,
        e * (c - z / q * s),
    );
    let half = Matrix2::new(1.0, 0.0, 0.0, stretch) * free;
    let (trace, determinant) = (half.trace(), half.determinant());
    let root = Complex::new(trace * trace / 4.0 - determinant, 0.0).sqrt();
    (
        amplitude,
        [root, -root].map(|root| (root + trace / 2.0).powi(2)),
    )
}

fn amplitude(orbit: &Orbit<State>) -> f64 {
    let (least, largest) = orbit.extremes(0);
    0.5 * (largest - least)
}

#[test]
fn den_hartogs_motions_have_his_amplitude_and_multipliers() {
    let cases = [
        (0.8, 0.05, 0.3, 2.346871967422),
        (1.5, 0.0, 0.3, 0.721110255093),
        (2.0, 0.0, 0.5, 0.220479275922),
        (0.8, 0.05, 0.5, f64::NAN),
        (1.3, 0.1, 0.2, f64::NAN),
    ];
    for (frequency, damping, friction, printed) in cases {
        let system = forced(frequency, damping, friction, 1.0);
        let start = State::new(&[0.0], &[0.0]);
        let orbit = settle(&system, &start, 300.0, Period::Driven(1)).unwrap();
        let (expected, multipliers) = den_hartog(frequency, damping, friction, 1.0);
        assert!(
            printed.is_nan() || (expected - printed).abs() < 1e-12,
            "{expected}"
        );
        let error = (amplitude(&orbit) - expected).abs();
        let found = orbit.multipliers();
        let [one, other] = multipliers;
        let straight = (found[0] - one).norm().max((found[1] - other).norm());
        let crossed = (found[0] - other).norm().max((found[1] - one).norm());
        let apart = straight.min(crossed);
        println!("{frequency} {damping} {friction}: {error:.1e} {apart:.1e} {found:?}");
        assert!(error < 1e-12 && apart < 1e-12, "{error} {apart}");
    }
    let system = forced(0.8, 0.05, 0.3, 1.0);
    let orbit = settle(&system, &State::at_rest(1), 100.0, Period::Driven(1)).unwrap();
    let multiplier = orbit.multipliers()[0];
    assert!((multiplier.re - 0.0330654).abs() < 1e-7 && (multiplier.im - 0.4475517).abs() < 1e-7);
}

/// G. Csernák, G. Stépán, S. W. Shaw, *Nonlinear Dynamics* 50 (2007) 93-109: at half the natural
/// frequency, and without damping, the motions without stops are a continuum.
#[test]
fn the_continuum_at_half_the_natural_frequency() {
    for friction in [0.05, 0.15, 0.3] {
        let system = forced(0.5, 0.0, friction, 1.0);
        let mut seen = Vec::new();
        for aside in [-0.03, 0.0, 0.03] {
            // The motion without friction is 4/3 cos Ωt.
            let guess = State::new(&[4.0 / 3.0 + aside], &[0.0]);
            let orbit = shoot(&system, &guess, Period::Driven(1)).unwrap();
            let (least, largest) = orbit.extremes(0);
            let multiplier = orbit.multipliers()[0];
            println!("{friction}: {least} {largest} {:?}", orbit.multipliers());
            assert_eq!(orbit.events().len(), 2, "no stops");
            assert!(
                (largest - least - 8.0 / 3.0).abs() < 1e-9,
                "{}",
                largest - least
            );
            assert!((multiplier - 1.0).norm() < 1e-9, "{multiplier}");
            assert!(!orbit.multipliers()[1].is_nan());
            seen.push(least);
        }
        // Each is the one nearest its guess.
        assert!(
            seen[0] < seen[1] - 0.01 && seen[1] < seen[2] - 0.01,
            "{seen:?}"
        );
    }
}
