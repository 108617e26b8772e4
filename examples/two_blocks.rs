//! Two blocks on a belt, coupled by a spring: every stick and release of each block.
//!
//! What to learn from it:
//!
//! * masses, springs and contacts are added one by one. Contacts are numbered in the order of
//!   `with_contact`, and each event contains the number of its contact;
//! * `mode_at` gives the mode of each contact between events: here both blocks stick, one of them
//!   sticks, or none;
//! * this motion is stable: a small perturbation of the start remains small, as printed at the end.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example two_blocks`.

use stick_slip::structure::State;
use stick_slip::{Contact, Error, Mode, Rational, Structure, Trajectory};

/// Blocks of Galvanetto and Bishop, Int. J. Mech. Sci. 41 (1999) 683-695: μ = 1/(1 + 3s), loads 1
/// and 1.3, springs of 1 to the ground and one of 1.2 between.
fn blocks(belt: f64) -> Result<Structure, Error> {
    let law = Rational::new(1.0, 3.0)?;
    Structure::new(&[1.0, 1.0])?
        .with_ground_spring(0, 1.0)?
        .with_ground_spring(1, 1.0)?
        .with_spring(0, 1, 1.2)?
        .with_contact(Contact::new(0, law, 1.0)?.on_belt(belt))?
        .with_contact(Contact::new(1, law, 1.3)?.on_belt(belt))
}

/// Share of the time in which none, one or both blocks stick.
fn shares(motion: &Trajectory<State>) -> [f64; 3] {
    let mut shares = [0.0; 3];
    let times = 10_000;
    for (time, _) in motion.sample(times) {
        let stuck = (0..2).filter(|&contact| motion.mode_at(contact, time) == Some(Mode::Stick));
        shares[stuck.count()] += 1.0 / times as f64;
    }
    shares
}

fn main() -> Result<(), Error> {
    let system = blocks(0.17)?;
    let start = State::new(&[0.2, -0.4], &[0.0, 0.1]);
    let motion = system.simulate(start.clone(), 300.0)?;

    println!("the first events of two blocks on a belt of velocity 0.17");
    for event in motion.events().iter().take(8) {
        let [u, w] = [0, 1].map(|i| event.state.displacements[i]);
        let (time, contact, what) = (event.time, event.element, event.kind.to_string());
        println!("  {time:16.12}  {contact}  {what:<18}  at {u:9.6} and {w:9.6}");
    }

    println!("\nbelt    none sticks  one sticks  both stick   sliding");
    for belt in [0.05, 0.1, 0.17, 0.3, 0.6, 1.2] {
        let system = blocks(belt)?;
        let [none, one, both] = shares(&system.simulate(start.clone(), 300.0)?);
        let sliding = system.steady_sliding();
        let stable = sliding.is_ok_and(|sliding| sliding.is_stable());
        let sliding = if stable { "stable" } else { "unstable" };
        println!("{belt:4.2}  {none:11.3}  {one:10.3}  {both:10.3}   {sliding}");
    }

    // A change of 1e-9 at the start.
    let changed = State::new(&[0.2 + 1e-9, -0.4], &[0.0, 0.1]);
    let changed = system.simulate(changed, 300.0)?;
    println!("\na perturbation of 1e-9 at the start becomes");
    for time in [50.0, 100.0, 200.0, 300.0] {
        if let (Some(a), Some(b)) = (motion.state_at(time), changed.state_at(time)) {
            let apart = (a.displacements[0] - b.displacements[0]).abs();
            println!("  {apart:.1e} at time {time}");
        }
    }
    Ok(())
}
