//! A loose gear between damped stops: how it rattles over the frequency.
//!
//! What to learn from it:
//!
//! * a `Stop` is a spring with a damper behind a gap; both flanks of a tooth are two of them;
//! * the coordinate is measured in a frame that turns with the driving gear. Its unsteady speed is
//!   a force of inertia, and the drag of oil presses the tooth on one flank;
//! * the gear rests on that flank up to the frequency at which its inertia exceeds the drag: the
//!   first rattle, exact to rounding by a formula;
//! * beyond, `orbit::sweep` finds the motion at each frequency, with its number of impacts and the
//!   heat in the teeth; irregular motions are common between periodic ones.
//!
//! ```text
//! x'' + 0.02 x' = −0.3 + A Ω² cos Ωt + stops at x = ±0.5 (k = 4000, ζ = 0.3),   A = 0.05
//! ```
//!
//! Run it with `cargo run --release -p stick-slip-examples --example rattle`.

use stick_slip::structure::State;
use stick_slip::{Drive, Element, Error, EventKind, Stop, Structure, orbit};

/// Half of the play, and stiffness and damping ratio of the teeth.
const PLAY: f64 = 0.5;
const STIFFNESS: f64 = 4000.0;
const ZETA: f64 = 0.3;
/// Acceleration by the drag, and amplitude of the driving gear.
const DRAG: f64 = 0.3;
const AMPLITUDE: f64 = 0.05;

fn gear(frequency: f64) -> Result<Structure, Error> {
    let damping = 2.0 * ZETA * STIFFNESS.sqrt();
    let tooth = |flank: Stop| flank.with_contact_stiffness(STIFFNESS, damping);
    let inertia = AMPLITUDE * frequency * frequency;
    Structure::new(&[1.0])?
        .with_ground_damper(0, 0.02)?
        .with_force(
            0,
            Drive::harmonic(inertia, frequency, 0.0)?.with_constant(-DRAG)?,
        )?
        .with_stop(tooth(Stop::above(0, PLAY, 0.0)?)?)?
        .with_stop(tooth(Stop::below(0, -PLAY, 0.0)?)?)
}

fn main() -> Result<(), Error> {
    // The tooth lifts where the inertia exceeds the drag, but for the spring's own vibration.
    println!("rigid teeth part at Ω = {:.6}\n", (DRAG / AMPLITUDE).sqrt());

    let pressed = State::new(&[-PLAY - DRAG / STIFFNESS], &[0.0]);
    let frequencies: Vec<f64> = (0..=18).map(|i| 2.0 + 0.25 * f64::from(i)).collect();
    let sweep = orbit::sweep(gear, &frequencies, &pressed)?;
    println!(
        "   Ω     periods   impacts on the flanks   hardest impact   heat of the teeth, a period"
    );
    for point in &sweep.up {
        let attractor = point.attractor.as_ref().map_err(Clone::clone)?;
        let Some(orbit) = attractor.orbit() else {
            println!("  {:.2}   {:?}", point.parameter, attractor.kind());
            continue;
        };
        let periods = orbit.period() * point.parameter / std::f64::consts::TAU;
        let closings = |stop: usize| {
            let events = orbit.events().iter();
            events.filter(move |event| {
                (event.element, event.kind) == (Element::Stop(stop), EventKind::Close)
            })
        };
        let speeds = closings(0)
            .chain(closings(1))
            .map(|event| event.state.velocities[0].abs());
        let heat = orbit.energy().stop_loss.iter().sum::<f64>() / periods;
        println!(
            "  {:.2}   {periods:4.0}      {:4} and {:4}           {:.6}         {heat:.6}",
            point.parameter,
            closings(1).count(),
            closings(0).count(),
            speeds.fold(0.0, f64::max)
        );
    }
    Ok(())
}
