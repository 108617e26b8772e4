//! A mass on a belt, held by a spring that hardens: limit cycles over the belt velocity, and the
//! velocities between which it vibrates, beside those of a linear spring.
//!
//! What to learn from it:
//!
//! * a `ForceElement` with a `PolynomialSpring` adds a cubic term to the spring; everything else
//!   (events, periodic motions, bifurcations) is as without it;
//! * the belt velocity at which steady sliding becomes stable depends on damping and on the slope
//!   of the friction law, not on the spring: all springs have the same one, v = ½ ln 3;
//! * beyond it stick-slip and steady sliding are both stable. Stick-slip ends by grazing, where the
//!   branch loses its stability and turns back. The hard spring changes this velocity little;
//! * friction stretches the spring, so the hard spring is stiffer about steady sliding: it vibrates
//!   faster, and less. The eigenvalues of steady sliding give the period of small vibrations.
//!
//! ```text
//! x'' + 0.1 x' + x + c3 x³ = −μ(x' − v),   μ = 0.25 + 0.15 exp(−s/0.5)
//! ```
//!
//! Run it with `cargo run --release -p stick-slip-examples --example duffing_brake`.

use std::f64::consts::TAU;
use std::ops::Range;

use stick_slip::orbit::{self, Orbit, Period};
use stick_slip::structure::State;
use stick_slip::{Contact, Error, ForceElement, PolynomialSpring, Stribeck, Structure};

const VELOCITIES: Range<f64> = 0.1..1.0;

fn brake(cubic: f64, velocity: f64) -> Result<Structure, Error> {
    let law = Stribeck::new(0.4, 0.25, 0.5, 1)?;
    let spring = PolynomialSpring::new(&[1.0, 0.0, cubic])?;
    Structure::new(&[1.0])?
        .with_ground_damper(0, 0.1)?
        .with_element(ForceElement::new(0, spring)?)?
        .with_contact(Contact::new(0, law, 1.0)?.on_belt(velocity))
}

/// The period of small vibrations about steady sliding.
fn small(brake: &Structure) -> Result<f64, Error> {
    let fastest = brake.steady_sliding()?.eigenvalues.into_iter();
    Ok(TAU / fastest.fold(0.0, |most, eigenvalue| eigenvalue.im.abs().max(most)))
}

/// The stick-slip motion that the mass settles to from rest.
fn groan(cubic: f64, velocity: f64) -> Result<Orbit<State>, Error> {
    let brake = brake(cubic, velocity)?;
    let period = Period::Free(small(&brake)?);
    orbit::settle(&brake, &State::at_rest(1), 200.0, period)
}

fn main() -> Result<(), Error> {
    for cubic in [0.0, 1.0, 2.0] {
        println!("c3 = {cubic}");
        println!("   v      period    of small vibration   amplitude   share of stick");
        for velocity in [0.1, 0.2, 0.3, 0.4, 0.5] {
            let cycle = groan(cubic, velocity)?;
            let amplitude = cycle.amplitude(0);
            let small = small(&brake(cubic, velocity)?)?;
            let share = cycle.stick_duration(0) / cycle.period();
            let period = cycle.period();
            println!(
                "  {velocity:.2}  {period:.8}      {small:.6}        {amplitude:.8}    {share:.4}"
            );
        }

        let start = groan(cubic, 0.2)?;
        let branch = orbit::follow(|v| brake(cubic, v), 0.2, &start, VELOCITIES)?;
        for found in &branch.bifurcations {
            println!("  {} at v = {:.10}", found.kind, found.parameter);
        }

        println!("  ends of the branch: {:?}", branch.ends);

        let ranges = orbit::vibration_ranges(|v| brake(cubic, v), VELOCITIES)?;
        for range in &ranges.ranges {
            let kinds: Vec<String> = range.attractors.iter().map(ToString::to_string).collect();
            let Range { start, end } = range.parameters;
            println!("  {start:.8} to {end:.8}: {}", kinds.join(", "));
        }
        println!();
    }
    Ok(())
}
