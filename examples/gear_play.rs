//! A loose gear that rattles: play between the teeth, a mesh stiffness that varies as the teeth
//! pass, and a drag torque of oil and bearings.
//!
//! What to learn from it:
//!
//! * `Backlash` is a spring with play on both sides, and `with_factor` makes its stiffness vary in
//!   time;
//! * the coordinate is measured in a frame that turns with the driving gear. The housing moves
//!   backward in it, and its friction (a `Contact`) holds the teeth on one flank. The driving
//!   gear's unsteady speed is a force of inertia;
//! * while the teeth keep contact, the vibration is that of a linear spring of varying stiffness.
//!   The frequency at which they first separate is found by bisection with `orbit::settle`;
//! * with separation the spring is softer: the resonance curve bends to lower frequencies, and
//!   between two folds rattle and quiet running are both stable. Near twice the natural frequency
//!   the varying stiffness alone makes quiet running unstable, at a flip.
//!
//! ```text
//! x'' + 0.05 x' + (1 + 0.2 cos Ωt) B(x) = 0.05 cos Ωt − 0.1 sgn(x' + 5)
//! B(x): the part of x beyond ±1
//! ```
//!
//! Run it with `cargo run --release -p stick-slip-examples --example gear_play`.

use stick_slip::orbit::{self, Orbit, Period};
use stick_slip::structure::State;
use stick_slip::{Backlash, Contact, Coulomb, Drive, Error, ForceElement, Structure};

/// Half of the play.
const PLAY: f64 = 1.0;
/// The drag: the teeth are pressed together by it.
const DRAG: f64 = 0.1;

fn gear(frequency: f64) -> Result<Structure, Error> {
    let stiffness = Drive::harmonic(0.2, frequency, 0.0)?.with_constant(1.0)?;
    let teeth = ForceElement::new(0, Backlash::new(1.0, PLAY)?)?.with_factor(stiffness)?;
    let drag = Contact::new(0, Coulomb::new(DRAG, DRAG)?, 1.0)?.on_belt(-5.0);
    Structure::new(&[1.0])?
        .with_ground_damper(0, 0.05)?
        .with_force(0, Drive::harmonic(0.05, frequency, 0.0)?)?
        .with_element(teeth)?
        .with_contact(drag)
}

fn settled(frequency: f64) -> Result<Orbit<State>, Error> {
    let pressed = State::new(&[-PLAY - DRAG], &[0.0]);
    orbit::settle(&gear(frequency)?, &pressed, 400.0, Period::Driven(1))
}

/// How far the teeth separate at most; negative if they keep contact.
fn separation(orbit: &Orbit<State>) -> f64 {
    orbit.extremes(0).1 + PLAY
}

/// The share of a period without contact.
fn apart(orbit: &Orbit<State>) -> f64 {
    let samples = 2000;
    let positions = orbit.trajectory().sample(samples);
    let separate = positions.filter(|(_, state)| state.displacements[0] > -PLAY);
    separate.count() as f64 / samples as f64
}

fn main() -> Result<(), Error> {
    // From quiet running on: contact is lost first between these frequencies.
    let (mut quiet, mut rattles) = (0.3, 0.9);
    while rattles - quiet > 1e-12 {
        let middle = 0.5 * (quiet + rattles);
        if separation(&settled(middle)?) < 0.0 {
            quiet = middle;
        } else {
            rattles = middle;
        }
    }
    println!("the teeth first separate at Ω = {quiet:.9}\n");

    let frequency = 0.3;
    let branch = orbit::follow(gear, frequency, &settled(frequency)?, 0.3..2.0)?;
    println!("   Ω          amplitude    separation   share apart   largest multiplier");
    for point in branch
        .points
        .iter()
        .step_by(branch.points.len().div_ceil(24))
    {
        let orbit = &point.orbit;
        let largest = orbit.multipliers()[0].norm();
        println!(
            "  {:.7}  {:10.7}   {:10.7}     {:.3}        {largest:.6} {}",
            point.parameter,
            orbit.amplitude(0),
            separation(orbit),
            apart(orbit),
            if orbit.is_stable() { "" } else { "unstable" }
        );
    }
    println!();
    for found in &branch.bifurcations {
        println!("  {} at Ω = {:.10}", found.kind, found.parameter);
    }
    println!("the two ends: {:?}", branch.ends);
    Ok(())
}
