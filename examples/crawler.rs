//! A capsule that crawls: two bodies on a surface that is smoother forward than backward, pushed
//! apart and together by a drive inside.
//!
//! What to learn from it:
//!
//! * `Directional` is a friction law for each direction, such as that of scales, hair or inclined
//!   bristles; everything else (events, periodic motions, energies) is as with other laws;
//! * the drive inside is a pair of opposite forces: only friction moves the centre of mass;
//! * the motion is periodic up to a translation. `orbit::settle` finds it, with its multipliers,
//!   and `Orbit::mean_velocity` is the speed of the crawler;
//! * with equal friction in both directions the crawler stays where it is.
//!
//! ```text
//! x_1'' + k (x_1 − x_2) + c (x_1' − x_2') =  F sin Ωt − friction_1
//! x_2'' + k (x_2 − x_1) + c (x_2' − x_1') = −F sin Ωt − friction_2
//! ```
//!
//! Run it with `cargo run --release -p stick-slip-examples --example crawler`.

use stick_slip::orbit::{self, Orbit, Period};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Directional, Drive, Error, Structure};

/// The spring and the damper between the bodies, the force of the drive, the weight of a body.
const SPRING: f64 = 4.0;
const DAMPER: f64 = 0.1;
const FORCE: f64 = 2.5;
const WEIGHT: f64 = 2.0;

/// Static and kinetic coefficients.
const FORWARD: [f64; 2] = [0.3, 0.2];
const BACKWARD: [f64; 2] = [0.7, 0.6];

fn crawler(frequency: f64, backward: [f64; 2]) -> Result<Structure, Error> {
    let law = |[fixed, sliding]: [f64; 2]| Coulomb::new(fixed, sliding);
    let sole = Directional::new(law(FORWARD)?, law(backward)?)?;
    let push = |force: f64| Drive::constant(0.0).with_sine(force, frequency);
    Structure::new(&[1.0, 1.0])?
        .with_spring(0, 1, SPRING)?
        .with_damper(0, 1, DAMPER)?
        .with_force(0, push(FORCE)?)?
        .with_force(1, push(-FORCE)?)?
        .with_contact(Contact::new(0, sole.clone(), WEIGHT)?)?
        .with_contact(Contact::new(1, sole, WEIGHT)?)
}

/// The periodic motion after a transient from rest, of one or two periods of the drive.
fn gait(frequency: f64, backward: [f64; 2]) -> Result<Orbit<State>, Error> {
    let system = crawler(frequency, backward)?;
    let settle = |count| orbit::settle(&system, &State::at_rest(2), 400.0, Period::Driven(count));
    settle(1).or_else(|_| settle(2))
}

fn main() -> Result<(), Error> {
    println!("   Ω      speed     way per period   heat per way   slips per period   multiplier");
    let mut best: Option<(f64, f64)> = None;
    for step in 0..=20 {
        let frequency = 1.0 + 0.2 * f64::from(step);
        let Ok(orbit) = gait(frequency, BACKWARD) else {
            println!("  {frequency:.1}    no motion of one or two periods of the drive");
            continue;
        };
        let speed = orbit.mean_velocity(0);
        let way = speed * orbit.period();
        let heat: f64 = orbit.energy().friction_loss.iter().sum();
        let slips = orbit.slips(0) + orbit.slips(1);
        let multiplier = orbit.multipliers().first().map_or(0.0, |m| m.norm());
        let loss = heat / way.abs();
        println!(
            "  {frequency:.1}  {speed:10.7}   {way:12.7}   {loss:12.4}   {slips:10}           \
             {multiplier:.6}"
        );
        if best.is_none_or(|(_, fastest)| speed > fastest) {
            best = Some((frequency, speed));
        }
    }
    let resonance = (2.0 * SPRING).sqrt();
    if let Some((frequency, speed)) = best {
        println!(
            "\nfastest at Ω = {frequency:.1}: {speed:.7}; the bodies resonate at {resonance:.3}"
        );
        let equal = gait(frequency, FORWARD)?;
        println!(
            "with equal friction in both directions: {:.1e}",
            equal.mean_velocity(0)
        );
        // The centre of mass is moved by friction alone.
        let orbit = gait(frequency, BACKWARD)?;
        let system = crawler(frequency, BACKWARD)?;
        let samples = system.samples(orbit.trajectory(), orbit.period() / 10_000.0)?;
        let samples: Vec<_> = samples.collect();
        let forces = samples
            .iter()
            .map(|sample| sample.friction.iter().sum::<f64>());
        let mean = forces.sum::<f64>() / samples.len() as f64;
        println!(
            "mean friction over a period: {mean:.1e}, of the largest {:.1}",
            2.0 * WEIGHT * BACKWARD[0]
        );
    }
    Ok(())
}
