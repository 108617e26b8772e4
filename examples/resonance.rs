//! The resonance curve of an oscillator that sticks: its periodic motions are followed over the
//! frequency of the force and through folds, to unstable motions that simulations do not reach.
//!
//! What to learn from it:
//!
//! * `orbit::settle` finds one periodic motion from a simulation, and `orbit::follow` finds all
//!   motions connected with it. The order of stick and slip is not prescribed: if it changes along
//!   the branch, the change is found, reported and passed;
//! * between two folds there are several motions at one frequency, and some of them are unstable;
//! * every fold, flip and change of the events is returned with its exact frequency, and a branch
//!   contains the reasons for its ends.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example resonance`.

use stick_slip::orbit::{self, Period};
use stick_slip::structure::State;
use stick_slip::{Contact, Drive, Error, EventKind, Polynomial, Structure};

/// A mass on a belt, and a force that varies in time: x'' + 0.06 x' + x = 0.2 cos Ωt − 0.9 μ(v_r).
fn oscillator(frequency: f64) -> Result<Structure, Error> {
    let law = Polynomial::new(0.55, 0.3, 0.7)?;
    Structure::new(&[1.0])?
        .with_ground_spring(0, 1.0)?
        .with_ground_damper(0, 0.06)?
        .with_force(0, Drive::harmonic(0.2, frequency, 0.0)?)?
        .with_contact(Contact::new(0, law, 0.9)?.on_belt(0.25))
}

fn main() -> Result<(), Error> {
    let frequency = 0.9;
    let system = oscillator(frequency)?;
    let start = orbit::settle(&system, &State::at_rest(1), 400.0, Period::Driven(1))?;
    let branch = orbit::follow(oscillator, frequency, &start, 0.5..2.0)?;

    println!("   Ω          amplitude     largest multiplier   stops per period");
    let every = branch.points.len().div_ceil(40);
    for point in branch.points.iter().step_by(every) {
        let (low, high) = point.orbit.extremes(0);
        let largest = point.orbit.multipliers().first().map_or(0.0, |m| m.norm());
        let events = point.orbit.events().iter();
        let stops = events.filter(|event| event.kind == EventKind::Stick);
        println!(
            "  {:.7}  {:.9}  {largest:12.6} {:8}  {:4}",
            point.parameter,
            0.5 * (high - low),
            if point.orbit.is_stable() {
                "stable"
            } else {
                ""
            },
            stops.count()
        );
    }
    println!("\nbifurcations and changes of the events on the branch:");
    for bifurcation in &branch.bifurcations {
        println!(
            "  {:<16} at Ω = {:.12}",
            bifurcation.kind.to_string(),
            bifurcation.parameter
        );
    }
    println!(
        "\nthe two ends: {:?}\n              {:?}",
        branch.ends[0], branch.ends[1]
    );
    Ok(())
}
