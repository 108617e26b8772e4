//! Two blades with a friction damper between them: the resonance peak over the damper's load, which
//! has an optimum.
//!
//! What to learn from it:
//!
//! * the damper is a contact between the two coordinates. It slips because the blades differ: their
//!   stiffnesses are 1 and 1.3;
//! * a damper with a small load slides and dissipates little; a damper with a large load locks the
//!   blades together and dissipates nothing. Both limits are linear resonances. At the best load
//!   between them the peak is less than a quarter as high;
//! * `orbit::settle` finds one forced motion, and `orbit::follow` the whole resonance curve,
//!   through all changes of stick and slip;
//! * `carried` gives the force in the locked damper. This force determines the load above which the
//!   damper never slips.
//!
//! ```text
//! q_i'' + 0.02 q_i' + k_i q_i = cos Ωt ∓ λ,   k = 1, 1.3,   damper force |λ| ≤ μN
//! ```
//!
//! J. H. Griffin, *Friction damping of resonant stresses in gas turbine engine airfoils*, J. Eng.
//! Power 102 (1980) 329-333, found such an optimum for one blade with a damper to the ground.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example blade_damper`.

use std::f64::consts::TAU;

use stick_slip::orbit::{self, Orbit, Period};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, Error, Structure};

const STIFFNESS: [f64; 2] = [1.0, 1.3];
const DAMPING: f64 = 0.02;
const FRICTION: f64 = 0.3;
/// Frequencies of the force.
const RANGE: std::ops::Range<f64> = 0.96..1.18;

/// The blades under a force of 1 each, with a damper under a load.
fn blades(load: f64, frequency: f64) -> Result<Structure, Error> {
    let mut blades = Structure::new(&[1.0, 1.0])?;
    for (i, stiffness) in STIFFNESS.into_iter().enumerate() {
        blades = blades
            .with_ground_spring(i, stiffness)?
            .with_ground_damper(i, DAMPING)?
            .with_force(i, Drive::harmonic(1.0, frequency, 0.0)?)?;
    }
    let law = Coulomb::new(FRICTION, FRICTION)?;
    blades.with_contact(Contact::between(0, 1, law, load)?)
}

/// Amplitude of the blade that moves most.
fn amplitude(orbit: &Orbit<State>) -> f64 {
    let ranges = [0, 1].map(|i| orbit.extremes(i));
    ranges
        .into_iter()
        .fold(0.0, |most, (low, high)| most.max(0.5 * (high - low)))
}

/// The highest peak of the resonance curve: its frequency and amplitude.
fn peak(load: f64) -> Result<(f64, f64), Error> {
    let middle = 1.07;
    let start = orbit::settle(
        &blades(load, middle)?,
        &State::at_rest(2),
        400.0,
        Period::Driven(1),
    )?;
    let curve = orbit::follow(|frequency| blades(load, frequency), middle, &start, RANGE)?;
    let points = curve.points.iter();
    let points = points.map(|point| (point.parameter, amplitude(&point.orbit)));
    Ok(points.fold((middle, 0.0), |highest, point| {
        if point.1 > highest.1 { point } else { highest }
    }))
}

/// The resonance of one linear oscillator of mass 1: its frequency and amplitude.
fn linear(stiffness: f64) -> (f64, f64) {
    let square = stiffness - 0.5 * DAMPING * DAMPING;
    let amplitude = 1.0 / (DAMPING * (stiffness - 0.25 * DAMPING * DAMPING).sqrt());
    (square.sqrt(), amplitude)
}

fn main() -> Result<(), Error> {
    // Without a damper the softer blade moves most. With a locked damper both blades move as one
    // blade with the mean stiffness.
    let free = linear(STIFFNESS[0]);
    let locked = linear(0.5 * (STIFFNESS[0] + STIFFNESS[1]));
    println!("  load     frequency   amplitude");
    println!("  0        {:9.4}   {:9.3}   linear", free.0, free.1);
    let mut peaks = Vec::new();
    for load in [0.01, 1.0, 2.0, 3.0, 4.0, 8.0, 15.0] {
        let (frequency, amplitude) = peak(load)?;
        println!("{load:5.2}      {frequency:9.4}   {amplitude:9.3}");
        peaks.push((frequency, amplitude));
    }
    println!("  ∞        {:9.4}   {:9.3}   linear", locked.0, locked.1);

    // Nearly no load: nearly the linear resonance.
    let (frequency, height) = peaks[0];
    assert!((frequency - free.0).abs() < 1e-3 && (height / free.1 - 1.0).abs() < 0.01);
    // One optimum between, far below both limits.
    let heights: Vec<f64> = peaks.iter().map(|peak| peak.1).collect();
    let turn = heights
        .iter()
        .position(|&height| heights.iter().all(|other| height <= *other));
    let turn = turn.unwrap_or(0);
    assert!(heights[..=turn].is_sorted_by(|a, b| a > b) && heights[turn..].is_sorted());
    assert!(4.0 * heights[turn] < free.1.min(locked.1));

    // Locked at resonance, both blades have the complex amplitude a + ib, and the force in the
    // damper comes from the difference of their stiffnesses.
    let (frequency, height) = locked;
    let [detuned, damped] = [0.5 * DAMPING * DAMPING, DAMPING * frequency];
    let norm = detuned * detuned + damped * damped;
    let state = State::new(&[detuned / norm; 2], &[frequency * damped / norm; 2]);
    let needed = 0.5 * (STIFFNESS[1] - STIFFNESS[0]) * height / FRICTION;
    println!("\nlocked at resonance from a load of {needed:.6} on");
    for (factor, slips) in [(1.0 + 1e-9, false), (1.0 - 1e-9, true)] {
        let motion =
            blades(factor * needed, frequency)?.simulate(state.clone(), TAU / frequency)?;
        assert_eq!(motion.events().is_empty(), !slips);
        if !slips {
            // Nothing but the resonance: it is back after a period.
            let [one, other] = [0, 1].map(|i| motion.last().displacements[i]);
            assert!((one - state.displacements[0]).abs() < 1e-12 * height && one == other);
        }
    }
    let carried = blades(needed, frequency)?.carried(0.0, &state)?[0].force;
    let stiffer = 0.5 * (STIFFNESS[1] - STIFFNESS[0]) * state.displacements[0];
    assert!((carried - stiffer).abs() < 1e-12);
    Ok(())
}
