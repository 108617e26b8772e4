//! A belt that starts, holds its velocity and stops: the times at which the mass begins to vibrate.
//!
//! What to learn from it:
//!
//! * a profile is a list of points (time, value), joined by straight lines. Before the first and
//!   after the last point it is constant. The ends of a ramp are kinks, at which a step ends
//!   exactly;
//! * a kink can end stick: the contact must also transmit the inertial force;
//! * the same belt velocity gives different motions when the belt speeds up and when it slows down;
//! * vibration begins long after steady sliding has become unstable, and later if disturbances are
//!   smaller. Simulations of slow profiles should therefore include the disturbances of the
//!   machine.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example speed_profile`.

use stick_slip::structure::State;
use stick_slip::{Contact, Drive, Error, EventKind, Exponential, Structure};

fn main() -> Result<(), Error> {
    // Ramp up in 150 units of time, hold for 50, ramp down in 150; then the belt rests.
    let belt = Drive::profile(&[(0.0, 0.0), (150.0, 0.9), (200.0, 0.9), (350.0, 0.0)])?;
    let law = Exponential::new(0.4, 0.25, 0.5)?;
    let system = Structure::new(&[1.0])?
        .with_ground_spring(0, 1.0)?
        .with_ground_damper(0, 0.1)?
        .with_contact(Contact::new(0, law, 1.0)?.on_belt(belt.clone()))?;
    let motion = system.simulate(State::at_rest(1), 400.0)?;

    println!("belt velocity and peak-to-peak displacement, every 25 units of time\n");
    println!("  time    belt   peak to peak  sticks");
    for start in (0..400).step_by(25) {
        let (start, end) = (f64::from(start), f64::from(start) + 25.0);
        let times = (0..500).map(|k| start + 0.05 * f64::from(k));
        let (low, high) = motion
            .sample_at(times)
            .map(|(_, state)| state.displacements[0])
            .fold((f64::MAX, f64::MIN), |(low, high), u| {
                (low.min(u), high.max(u))
            });
        let within = motion
            .events()
            .iter()
            .filter(|event| (start..end).contains(&event.time));
        let sticks = within
            .filter(|event| event.kind == EventKind::Stick)
            .count();
        let velocity = belt.value(0.5 * (start + end));
        println!(
            "  {start:4}  {velocity:6.3}   {:12.6}  {sticks:6}",
            high - low
        );
    }

    // Changes of stability of steady sliding; vibration begins later than these, both on the way up
    // and on the way down.
    println!("\ntime and belt velocity at which steady sliding at constant belt velocity");
    for change in system.stability_changes(0.0..400.0)? {
        let becomes = if change.becomes_stable {
            "stable"
        } else {
            "unstable"
        };
        let velocity = belt.value(change.time);
        println!("  {:8.3}  {velocity:6.4}  becomes {becomes}", change.time);
    }

    // The delay depends on the disturbance.
    println!("\ntime of the first stick on a belt that slows down from 1.2 to 0.4 within 4000");
    let slow = Drive::profile(&[(0.0, 1.2), (4000.0, 0.4)])?;
    let slowing = |disturbance: f64| {
        Structure::new(&[1.0])?
            .with_ground_spring(0, 1.0)?
            .with_ground_damper(0, 0.1)?
            .with_force(0, Drive::sine(disturbance, 1.0)?)?
            .with_contact(Contact::new(0, law, 1.0)?.on_belt(slow.clone()))
    };
    for disturbance in [1e-2, 1e-3, 1e-6, 1e-9, 0.0] {
        let motion = slowing(disturbance)?.simulate(State::new(&[0.26], &[0.0]), 4000.0)?;
        let mut events = motion.events().iter();
        let stick = events.find(|event| event.kind == EventKind::Stick);
        let time = stick.map_or(f64::NAN, |event| event.time);
        println!("  disturbed by {disturbance:5.0e} of the load: {time:7.1}");
    }
    for change in slowing(0.0)?.stability_changes(0.0..4000.0)? {
        println!("  unstable since: {:22.1}", change.time);
    }

    let mut sticks = motion
        .events()
        .iter()
        .filter(|event| event.kind == EventKind::Stick);
    if let (Some(first), Some(last)) = (sticks.next(), sticks.next_back()) {
        let [up, down] = [first, last].map(|event| belt.value(event.time));
        println!("\nfirst stick at belt velocity {up:.6}, last at {down:.6}");
    }
    println!("at the end: u = {:.12}", motion.last().displacements[0]);
    Ok(())
}
