//! A positioning axis under PID control against stiction: it hunts, and the integral gain decides
//! how fast and how far.
//!
//! What to learn from it:
//!
//! * a `FirstOrder` integrator with the displacement as input is the integral of a controller. Its
//!   value is the last number of a state, and counts in eigenvalues and multipliers;
//! * while the mass sticks, the integral grows until it overcomes static friction. Kinetic friction
//!   is less, so the mass slips past its target: a limit cycle, the longer the smaller the gain;
//! * without an integral the mass rests off its target; with any gain it hunts. A small gain has
//!   another motion beside it: from farther away the mass creeps to its target without a stop;
//! * beyond K_i = K_p K_d/m (Routh) the control loop itself is unstable. Friction still bounds
//!   small motions, and hunting goes on there; large motions grow;
//! * hunting ends at a larger gain, where the mass no longer stops at its turning points. There the
//!   limit cycle meets an unstable one without stick, and beyond it all motions grow.
//!   `orbit::follow` finds this gain.
//!
//! ```text
//! m x'' = −K_p x − K_i ∫x dt − K_d x' − friction,   static friction 75 N, kinetic friction 50 N
//! ```
//!
//! Run it with `cargo run --release -p stick-slip-examples --example servo`.

use std::error::Error;

use stick_slip::orbit::{self, Attractor, Orbit};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, FirstOrder, Structure};

/// N/m, N s/m and kg.
const PROPORTIONAL: f64 = 100.0;
const DERIVATIVE: f64 = 20.0;
const MASS: f64 = 1.0;

/// The control loop without friction.
fn controlled(integral_gain: f64) -> Result<Structure, stick_slip::Error> {
    let integral = FirstOrder::integrator()
        .with_displacement(0, 1.0)?
        .with_force(0, -integral_gain)?;
    Structure::new(&[MASS])?
        .with_ground_spring(0, PROPORTIONAL)?
        .with_ground_damper(0, DERIVATIVE)?
        .with_first_order(integral)
}

/// The axis, which slides on a guide that is loaded by 100 N.
fn axis(integral_gain: f64) -> Result<Structure, stick_slip::Error> {
    let guide = Contact::new(0, Coulomb::new(0.75, 0.5)?, 100.0)?;
    controlled(integral_gain)?.with_contact(guide)
}

/// The limit cycle that follows from a distance off the target.
fn hunting(integral_gain: f64, distance: f64) -> Result<Orbit<State>, Box<dyn Error>> {
    let start = State::new(&[distance], &[0.0]);
    match orbit::classify(&axis(integral_gain)?, &start)? {
        Attractor::StickSlip(cycle) => Ok(*cycle),
        other => Err(format!("no hunting at K_i = {integral_gain}: {}", other.kind()).into()),
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("    K_i      period     amplitude   share of stick   largest multiplier");
    for gain in [50.0, 100.0, 200.0, 500.0, 1000.0, 1500.0, 1900.0] {
        let cycle = hunting(gain, 0.12)?;
        let share = cycle.stick_duration(0) / cycle.period();
        let (period, amplitude) = (cycle.period(), cycle.amplitude(0));
        let multiplier = cycle.multipliers()[0].norm();
        println!(
            "  {gain:6.0}  {period:10.6}  {amplitude:.10}      {share:.4}          {multiplier:.6}"
        );
    }

    let cycle = hunting(500.0, 0.12)?;
    let found = orbit::orbit_sensitivities(|p| axis(p[0]), &[500.0], &cycle)?;
    let slope = found.period[0];
    println!("\nat K_i = 500 the period changes by {slope:.8} s per N/(m s)");

    // The gain at which an eigenvalue of the loop enters the right half-plane.
    let [mut low, mut high] = [1.0, 1e4];
    while high - low > 1e-12 * high {
        let middle = 0.5 * (low + high);
        if controlled(middle)?.steady_sliding()?.is_stable() {
            low = middle;
        } else {
            high = middle;
        }
    }
    println!("the loop becomes unstable at K_i = {low:.8}");

    // Along the branch of hunting, to its end and back on the unstable limit cycle.
    let cycle = hunting(2300.0, 0.12)?;
    let branch = orbit::follow(axis, 2300.0, &cycle, 2200.0..3000.0)?;
    let end = branch.bifurcations.first().ok_or("hunting does not end")?;
    let (period, amplitude) = (end.orbit.period(), end.orbit.amplitude(0));
    println!("hunting ends at K_i = {:.6}:", end.parameter);
    println!("  period {period:.6}, amplitude {amplitude:.6}");
    for gain in [2390.0, 2420.0] {
        let motion = axis(gain)?.simulate(State::new(&[1.0], &[0.0]), 60.0)?;
        let late = motion.events().iter().filter(|event| event.time > 50.0);
        let largest = late.map(|event| event.state.displacements[0]);
        let largest = largest.fold(0.0, f64::max);
        println!("  K_i = {gain}: from 1 m to {largest:.4} m after 60 s");
    }

    // The smallest gain, from farther away.
    let motion = axis(50.0)?.simulate(State::new(&[0.3], &[0.0]), 40.0)?;
    let (events, last) = (motion.events().len(), motion.last());
    let left = last.displacements[0];
    println!("from 0.3 m, K_i = 50: {events} event, after 40 s {left:.2e} m are left");
    Ok(())
}
