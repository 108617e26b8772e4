//! The resonance curve of an oscillator with dry friction, compared with Den Hartog's formula.
//!
//! What to learn from it:
//!
//! * a drive is a function of time: here a harmonic force;
//! * Den Hartog's formula of 1931 is exact as long as the mass never stops between two turning
//!   points. If the mass stops, the formula has no solution (`None`), and the motion is simulated;
//! * without damping, friction bounds the amplitude at resonance only if it exceeds π/4 of the
//!   force.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example forced`.

use stick_slip::analysis::forced::{ForcedOscillator, no_stop_limit};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, Error, EventKind, Structure};

const FRICTION: f64 = 0.4;
const DAMPING: f64 = 0.02;

/// x'' + 2ζx' + x = cos Ωt − F sgn x', as a structure.
fn oscillator(frequency: f64) -> Result<Structure, Error> {
    Structure::new(&[1.0])?
        .with_ground_spring(0, 1.0)?
        .with_ground_damper(0, 2.0 * DAMPING)?
        .with_force(0, Drive::harmonic(1.0, frequency, 0.0)?)?
        .with_contact(Contact::new(0, Coulomb::new(FRICTION, FRICTION)?, 1.0)?)
}

fn main() -> Result<(), Error> {
    println!("friction {FRICTION} of the force, damping ratio {DAMPING}\n");
    println!("   Ω    no-stop limit   Den Hartog's A   simulated A      stops per period");
    for frequency in [
        0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 1.0, 1.1, 1.25, 1.5, 2.0, 3.0,
    ] {
        let formula = ForcedOscillator {
            damping: DAMPING,
            angular_frequency: frequency,
            kinetic_friction: FRICTION,
            static_friction: FRICTION,
            force: 1.0,
        };
        let exact = formula.without_stops().map(|motion| motion.amplitude());
        let exact = exact.map_or("-".to_owned(), |amplitude| format!("{amplitude:.12}"));

        let system = oscillator(frequency)?;
        let period = system.period().unwrap_or(f64::NAN);
        // A time in which the free vibration decays, and then ten periods.
        let transient = 1500.0;
        let motion = system.simulate(State::at_rest(1), transient + 10.0 * period)?;
        let late = || {
            motion
                .events()
                .iter()
                .filter(|event| event.time > transient)
        };
        // The extremes are at rest: at a turning point or a stop.
        let amplitude = late()
            .map(|event| event.state.displacements[0].abs())
            .fold(0.0, f64::max);
        let stops = late()
            .filter(|event| event.kind == EventKind::Stick)
            .count();
        let limit = no_stop_limit(frequency).unwrap_or(f64::NAN);
        let stops = stops as f64 / 10.0;
        println!("  {frequency:4.2}  {limit:12.6}    {exact:>14}   {amplitude:.12}   {stops:4.1}");
    }
    println!("\nThe limit is that of F/p without damping; above it the mass stops at both ends.");
    Ok(())
}
