//! A loose gear between damped stops: how it rattles over the frequency.
//!
//! What to learn from it:
//!
//! * a `Stop` is a spring with a damper behind a gap; both flanks of a tooth are two of them;
//! * the coordinate is measured in a frame that turns with the driving gear. Its unsteady speed is
//!   a force of inertia, and the drag of oil presses the tooth on one flank;
//! * the tooth keeps its flank up to a frequency that `orbit::follow` finds as a grazing. There the
//!   least force of the linear vibration on the flank is 0;
//! * beyond, `orbit::sweep` finds the motion at each frequency, with its number of impacts and the
//!   heat in the teeth; irregular motions are common between periodic ones.
//!
//! ```text
//! x'' + 0.02 x' = −0.3 + A Ω² cos Ωt + stops at x = ±g (k = 4000, ζ = 0.5),   A = 0.05
//! ```
//!
//! Run it with `cargo run --release -p stick-slip-examples --example rattle`.

use std::f64::consts::TAU;

use stick_slip::orbit::{self, BifurcationKind, Period};
use stick_slip::structure::State;
use stick_slip::{Drive, Element, Error, EventKind, Stop, Structure};

/// Half of the play, and stiffness and damping ratio of the teeth.
const PLAY: f64 = 0.04;
const STIFFNESS: f64 = 4000.0;
const ZETA: f64 = 0.5;
/// Acceleration by the drag, its damping, and amplitude of the driving gear.
const DRAG: f64 = 0.3;
const OIL: f64 = 0.02;
const AMPLITUDE: f64 = 0.05;

fn damping() -> f64 {
    2.0 * ZETA * STIFFNESS.sqrt()
}

fn gear(frequency: f64) -> Result<Structure, Error> {
    let tooth = |flank: Stop| flank.with_contact_stiffness(STIFFNESS, damping());
    let inertia = AMPLITUDE * frequency * frequency;
    Structure::new(&[1.0])?
        .with_ground_damper(0, OIL)?
        .with_force(
            0,
            Drive::harmonic(inertia, frequency, 0.0)?.with_constant(-DRAG)?,
        )?
        .with_stop(tooth(Stop::above(0, PLAY, 0.0)?)?)?
        .with_stop(tooth(Stop::below(0, -PLAY, 0.0)?)?)
}

/// The least force on the flank, while the tooth stays there: that of a linear vibration.
fn least_force(frequency: f64) -> f64 {
    let inertia = AMPLITUDE * frequency * frequency;
    let flank = STIFFNESS.hypot(damping() * frequency);
    let all = (STIFFNESS - frequency * frequency).hypot((damping() + OIL) * frequency);
    DRAG - inertia * flank / all
}

/// The frequency at which the teeth part.
fn parts_at() -> f64 {
    let (mut low, mut high) = (1.0, 4.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        match least_force(middle) > 0.0 {
            true => low = middle,
            false => high = middle,
        }
    }
    low
}

fn main() -> Result<(), Error> {
    let pressed = State::new(&[-PLAY - DRAG / STIFFNESS], &[0.0]);
    let first = orbit::settle(&gear(2.0)?, &pressed, 20.0, Period::Driven(1))?;
    let branch = orbit::follow(gear, 2.0, &first, 2.0..2.5)?;
    let mut found = branch.bifurcations.iter();
    if let Some(grazing) = found.find(|found| found.kind == BifurcationKind::Grazing) {
        let (found, formula) = (grazing.parameter, parts_at());
        println!("the teeth first part at Ω = {found:.10}, by the formula {formula:.10}\n");
    }

    println!("   Ω    periods   impacts on the flanks   hardest impact   heat a period");
    let frequencies: Vec<f64> = (0..=12).map(|i| 2.25 + 0.25 * f64::from(i)).collect();
    let sweep = orbit::sweep(gear, &frequencies, &pressed)?;
    for point in &sweep.up {
        let attractor = point.attractor.as_ref().map_err(Clone::clone)?;
        let Some(orbit) = attractor.orbit() else {
            println!("  {:.2}   {:?}", point.parameter, attractor.kind());
            continue;
        };
        let periods = orbit.period() * point.parameter / TAU;
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
            "  {:.2}   {periods:4.0}      {:4} and {:4}          {:.6}        {heat:.6}",
            point.parameter,
            closings(1).count(),
            closings(0).count(),
            speeds.fold(0.0, f64::max)
        );
    }
    Ok(())
}
