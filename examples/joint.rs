//! One mass on a Jenkins element, a spring in series with a dry slider: exact resonance curves at
//! five forces, compared with first-harmonic theory.
//!
//! What to learn from it:
//!
//! * `SymmetricResponse::at` gives the exact steady-state motion in closed form, except for one
//!   scalar equation that is solved numerically: amplitude, phase and multipliers, in a fraction of
//!   a millisecond for each point;
//! * `backbone` gives frequency and damping over amplitude by first-harmonic theory. The peaks lie
//!   near the backbone. On the flanks of the curves the amplitudes of this theory have errors of up
//!   to some per cent;
//! * friction damps most at about 2.5 times the amplitude at which slip begins; without slip it
//!   does not damp;
//! * `orbit::follow` finds the same curve from the equations of motion alone, without the
//!   assumptions that the motion is symmetric and consists of four arcs.
//!
//! ```text
//! x'' + 0.02 x' + 0.6 x + T = P cos ωt,    T: spring 0.4, slider of limit 0.3
//! ```
//!
//! Run it with `cargo run --release -p stick-slip-examples --example joint`.

use stick_slip::analysis::jenkins::{SymmetricResponse, backbone, first_harmonic};
use stick_slip::orbit::{self, Period};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, Error, Structure};

const MASS: f64 = 1.0;
const DAMPING: f64 = 0.02;
const STIFFNESS: f64 = 0.6;
/// Spring and limit of the element.
const TANGENTIAL: f64 = 0.4;
const LIMIT: f64 = 0.3;
const FORCES: [f64; 5] = [0.01, 0.05, 0.15, 0.3, 0.45];
/// Frequencies of the force.
const RANGE: std::ops::Range<f64> = 0.7..1.15;

fn exact(force: f64, frequency: f64) -> Option<SymmetricResponse> {
    SymmetricResponse::at(
        MASS, DAMPING, STIFFNESS, TANGENTIAL, LIMIT, force, frequency,
    )
}

/// The force that gives an amplitude at a frequency, by first-harmonic theory.
fn harmonic_force(amplitude: f64, frequency: f64) -> f64 {
    let (stiffness, damping, _) = first_harmonic(TANGENTIAL, LIMIT, amplitude, frequency);
    let elastic = STIFFNESS + stiffness - MASS * frequency * frequency;
    amplitude * elastic.hypot((DAMPING + damping) * frequency)
}

/// The amplitude by first-harmonic theory: the force rises with the amplitude.
fn harmonic_amplitude(force: f64, frequency: f64) -> f64 {
    let (mut low, mut high) = (0.0_f64, 1e6_f64);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        if harmonic_force(middle, frequency) < force {
            low = middle;
        } else {
            high = middle;
        }
    }
    low
}

/// The largest amplitude of a resonance curve and its frequency, by golden section.
fn peak(amplitude: impl Fn(f64) -> f64) -> (f64, f64) {
    let ratio = 0.5 * (5.0_f64.sqrt() - 1.0);
    let (mut low, mut high) = (RANGE.start, RANGE.end);
    for _ in 0..60 {
        let [left, right] = [high - ratio * (high - low), low + ratio * (high - low)];
        if amplitude(left) > amplitude(right) {
            high = right;
        } else {
            low = left;
        }
    }
    let frequency = 0.5 * (low + high);
    (frequency, amplitude(frequency))
}

/// The same mass as a structure with an elastic contact.
fn structure(force: f64, frequency: f64) -> Result<Structure, Error> {
    let element = Contact::new(0, Coulomb::new(1.0, 1.0)?, LIMIT)?;
    Structure::new(&[MASS])?
        .with_ground_spring(0, STIFFNESS)?
        .with_ground_damper(0, DAMPING)?
        .with_force(0, Drive::harmonic(force, frequency, 0.0)?)?
        .with_contact(element.with_tangential_stiffness(TANGENTIAL)?)
}

fn main() -> Result<(), Error> {
    let onset = LIMIT / TANGENTIAL;
    println!("peaks of the resonance curves; slip begins at the amplitude {onset:.2}");
    println!("         exact                      first harmonic             its largest");
    println!("  P      frequency   amplitude      frequency   amplitude      error on the curve");
    let mut errors = Vec::new();
    for force in FORCES {
        let of = |frequency| exact(force, frequency).map_or(f64::NAN, |found| found.amplitude);
        let found = peak(of);
        let harmonic = peak(|frequency| harmonic_amplitude(force, frequency));
        let error = (0..=450).map(|i| {
            let frequency = RANGE.start + 1e-3 * f64::from(i);
            (harmonic_amplitude(force, frequency) / of(frequency) - 1.0).abs()
        });
        let error = error.fold(0.0, f64::max);
        println!(
            "  {force:4.2}   {:.6}    {:9.6}      {:.6}    {:9.6}      {:5.2} %",
            found.0,
            found.1,
            harmonic.0,
            harmonic.1,
            100.0 * error
        );
        errors.push(error);
        // The backbone at the peak: in first-harmonic theory ω is the frequency of the conservative
        // system, up to the square of the damping ratio.
        let point = backbone(MASS, DAMPING, STIFFNESS, TANGENTIAL, LIMIT, harmonic.1);
        let point = point.expect("positive parameters");
        let shift = (harmonic.0 / point.angular_frequency - 1.0).abs();
        assert!(shift < 2.0 * point.damping_ratio.powi(2).max(1e-8));
    }
    // Without slip, both theories give the linear response.
    assert!(errors[0] < 1e-12 && errors[1..].iter().all(|error| (1e-4..0.2).contains(error)));

    println!("\nbackbone: amplitude, frequency, damping ratio");
    let mut most = (0.0, 0.0);
    for i in 0..=60 {
        let amplitude = 0.5 * 10_f64.powf(f64::from(i) / 60.0);
        let point = backbone(MASS, DAMPING, STIFFNESS, TANGENTIAL, LIMIT, amplitude);
        let Some(point) = point else { continue };
        if i % 6 == 0 {
            let (frequency, ratio) = (point.angular_frequency, point.damping_ratio);
            println!("  {amplitude:9.6}   {frequency:.6}   {ratio:.6}");
        }
        if point.damping_ratio > most.1 {
            most = (amplitude, point.damping_ratio);
        }
    }
    println!("most damping at the amplitude {:.3}: {:.4}", most.0, most.1);
    assert!((2.0..3.0).contains(&(most.0 * TANGENTIAL / LIMIT)));

    // The same curve from the equations of motion.
    let (force, middle) = (0.15, 0.9);
    let system = structure(force, middle)?;
    let start = orbit::settle(&system, &State::at_rest(1), 400.0, Period::Driven(1))?;
    let curve = orbit::follow(
        |frequency| structure(force, frequency),
        middle,
        &start,
        RANGE,
    )?;
    let mut worst = [0.0_f64; 2];
    for point in &curve.points {
        let Some(found) = exact(force, point.parameter) else {
            panic!("no symmetric motion at {}", point.parameter)
        };
        let (low, high) = point.orbit.extremes(0);
        worst[0] = worst[0].max((0.5 * (high - low) / found.amplitude - 1.0).abs());
        // If the slider never moves, the multiplier 1 is left out.
        let all = found.multipliers.iter();
        let own = all.filter(|multiplier| multiplier.re != 1.0);
        let size = |m: &stick_slip::nalgebra::Complex<f64>| m.norm();
        let largest = [
            own.map(size).fold(0.0, f64::max),
            size(&point.orbit.multipliers()[0]),
        ];
        worst[1] = worst[1].max((largest[0] - largest[1]).abs());
    }
    println!(
        "\nP = {force}: {} orbits along the curve; differences {:.0e} of the amplitude, \
         {:.0e} of the multipliers",
        curve.points.len(),
        worst[0],
        worst[1]
    );
    for bifurcation in &curve.bifurcations {
        println!("  {} at ω = {:.9}", bifurcation.kind, bifurcation.parameter);
    }
    assert!(worst[0] < 1e-11 && worst[1] < 1e-6);
    Ok(())
}
