//! Two shafts and a clutch whose load rises, in SI units: the time of lock-up and the heat.
//!
//! What to learn from it:
//!
//! * a clutch is a contact between two coordinates. With the mean radius as the coefficient of its
//!   direction, the contact has a sliding speed in m/s and a load in newtons, and acts on the
//!   shafts as a torque;
//! * the load is a profile: it rises from 0 (open clutch) to the full clamp force;
//! * lock-up is an event, exact to rounding; so is the release of the clutch when the engine torque
//!   is too large;
//! * `carried` returns the force that the locked clutch transmits at any instant.
//!
//! ```text
//! J_1 ω_1' = T_e − T,   J_2 ω_2' = T − T_l,   T = μ n N(t) R   while it slips
//! ```
//!
//! Run it with `cargo run --release -p stick-slip-examples --example clutch`.

use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Direction, Drive, Error, EventKind, Structure};

/// Moments of inertia of the engine and of the car, reduced to the clutch, kg·m².
const INERTIAS: [f64; 2] = [0.25, 1.5];
/// Driving torque on the engine's shaft and resisting torque on the car's shaft, N·m.
const ENGINE: f64 = 120.0;
const ROAD: f64 = 30.0;
/// Speeds when the clutch begins to close, rad/s.
const START: [f64; 2] = [200.0, 20.0];

/// Mean radius in metres, number of faces, clamp force in newtons; static and kinetic coefficient.
const RADIUS: f64 = 0.12;
const FACES: f64 = 2.0;
const CLAMP: f64 = 4000.0;
const FRICTION: [f64; 2] = [0.36, 0.3];

/// The clutch closes within the given number of seconds. At 3 s the engine torque is four times as
/// large for 0.1 s.
fn shafts(closing: f64) -> Result<Structure, Error> {
    let load = Drive::profile(&[(0.0, 0.0), (closing, FACES * CLAMP)])?;
    let law = Coulomb::new(FRICTION[0], FRICTION[1])?;
    let clutch = Contact::along(&[(0, RADIUS), (1, -RADIUS)], law, load)?;
    let burst = [
        (3.0, 0.0),
        (3.0, 3.0 * ENGINE),
        (3.1, 3.0 * ENGINE),
        (3.1, 0.0),
    ];
    Structure::new(&INERTIAS)?
        .with_force(0, ENGINE)?
        .with_force(0, Drive::profile(&burst)?)?
        .with_force(1, -ROAD)?
        .with_contact(clutch)
}

/// Lock-up time and heat for a constant coefficient: the difference of speeds is a quadratic
/// polynomial of time while the clutch closes, and then linear in time.
fn closed_form(closing: f64) -> (f64, f64) {
    let softness = 1.0 / INERTIAS[0] + 1.0 / INERTIAS[1];
    let gain = ENGINE / INERTIAS[0] + ROAD / INERTIAS[1];
    let difference = START[0] - START[1];
    let torque = FRICTION[1] * FACES * CLAMP * RADIUS;
    let slope = torque / closing;
    // ∫ T dt and ∫ T (ω_1 − ω_2) dt up to a time at which the clutch still closes.
    let heat = |t: f64| {
        let speed = difference / 2.0 + gain * t / 3.0 - softness * slope * t * t / 8.0;
        slope * t * t * speed
    };
    let root = (gain * gain + 2.0 * softness * slope * difference).sqrt();
    let locked = (gain + root) / (softness * slope);
    if locked <= closing {
        return (locked, heat(locked));
    }
    let left = difference + gain * closing - softness * torque * closing / 2.0;
    let rest = left / (softness * torque - gain);
    (closing + rest, heat(closing) + torque * left * rest / 2.0)
}

/// Kinetic energy, and the work of the two outer torques since time 0.
fn energy(state: &State) -> [f64; 2] {
    let kinetic = |i: usize| 0.5 * INERTIAS[i] * state.velocities[i].powi(2);
    let [engine, car] = [0, 1].map(|i| state.displacements[i]);
    [kinetic(0) + kinetic(1), ENGINE * engine - ROAD * car]
}

fn main() -> Result<(), Error> {
    let start = State::new(&[0.0, 0.0], &START);
    println!("closing s   lock-up s   by the formula   heat J      by the formula   speed rad/s");
    for closing in [0.2, 0.5, 1.0, 1.5] {
        let motion = shafts(closing)?.simulate(start.clone(), 2.9)?;
        let sticks = motion.events().iter();
        let Some(lock_up) = sticks.clone().find(|event| event.kind == EventKind::Stick) else {
            continue;
        };
        // The initial energy plus the work is the kinetic energy plus the heat.
        let ([before, _], [after, work]) = (energy(&start), energy(&lock_up.state));
        let heat = before + work - after;
        let (time, warmth) = closed_form(closing);
        let speed = lock_up.state.velocities[0];
        println!(
            "  {closing:4.1}   {:12.9}   {time:12.9}   {heat:10.4}   {warmth:14.4}   {speed:10.4}",
            lock_up.time
        );
        assert!((lock_up.time - time).abs() < 1e-13);
        assert!((heat - warmth).abs() < 1e-11 * warmth);
        // The total momentum is its initial value plus the impulse of the outer torques.
        let momentum =
            |state: &State| INERTIAS[0] * state.velocities[0] + INERTIAS[1] * state.velocities[1];
        let given = (ENGINE - ROAD) * lock_up.time;
        assert!((momentum(&lock_up.state) - momentum(&start) - given).abs() < 1e-12 * given);
        assert!((speed - lock_up.state.velocities[1]).abs() < 1e-13 * speed);
    }

    let shafts = shafts(0.5)?;
    let motion = shafts.simulate(start, 5.0)?;
    println!("\nclosing in 0.5 s; from 3 to 3.1 s the engine torque is four times as large");
    for event in motion.events() {
        let [engine, car] = [0, 1].map(|i| event.state.velocities[i]);
        println!(
            "  {:12.9} s  {:<18}  engine {engine:8.3}  car {car:8.3} rad/s",
            event.time,
            event.kind.to_string()
        );
    }
    // The locked shafts accelerate together: the clutch transmits the torque that the car needs.
    let both = (ENGINE - ROAD) / (INERTIAS[0] + INERTIAS[1]);
    let needed = ROAD + INERTIAS[1] * both;
    let locked = motion.state_at(2.5).unwrap_or_else(|| motion.last());
    let torque = RADIUS * shafts.carried(2.5, &locked)?[0].force;
    println!(
        "torque in the locked clutch: {torque:.6} N·m, at most {:.1}",
        RADIUS * FACES * CLAMP * FRICTION[0]
    );
    assert!((torque - needed).abs() < 1e-12 * needed);
    let kinds: Vec<EventKind> = motion.events().iter().map(|event| event.kind).collect();
    let expected = [
        EventKind::Stick,
        EventKind::Release(Direction::Leading),
        EventKind::Stick,
    ];
    assert_eq!(kinds, expected);
    Ok(())
}
