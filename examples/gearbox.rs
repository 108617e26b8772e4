//! An automatic gearbox: a car held by its brake with the engine on, a start in first gear through
//! a freewheel, and a shift under load to second gear.
//!
//! What to learn from it:
//!
//! * a gear with a clutch is a contact along a direction: r = ω_in − i ω_out with the gear ratio i;
//! * at rest the brake and the resistance of the road hold the output shaft together. What each of
//!   them carries is not determined; `carried` returns the range. When they slip is determined;
//! * first gear has a freewheel instead of a clutch (`Freewheel`): it drives, and lets the output
//!   run ahead. So the shift needs no coordination: the clutch of second gear takes up the torque,
//!   the freewheel lets go at the instant at which its force is 0, and the torque never fails;
//! * all instants are events. Here they have closed forms: when the car moves, when the freewheel
//!   lets go, and when the clutch of second gear locks.
//!
//! ```text
//! J_in ω_in' = T − λ_1 − λ_2,   J_out ω_out' = i_1 λ_1 + i_2 λ_2 − brake − road
//! ```
//!
//! Run it with `cargo run --release -p stick-slip-examples --example gearbox`.

use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Direction, Drive, Error, Event, EventKind, Freewheel, Structure, Trajectory,
};

/// Moments of inertia of the engine and of the car, reduced to the output shaft, kg·m².
const ENGINE: f64 = 0.2;
const CAR: f64 = 60.0;
/// Torque of the engine and resistance of the road on the output shaft, N·m.
const TORQUE: f64 = 100.0;
const ROAD: f64 = 80.0;
/// Ratios of first and second gear.
const RATIOS: [f64; 2] = [3.6, 2.0];
/// Torque capacity of the brake on the output shaft, and of the clutch of second gear, N·m.
const BRAKE: f64 = 1000.0;
const CLUTCH: f64 = 300.0;

/// The brake is released between 1 s and 2 s, and the clutch closes between 6 s and 7 s.
fn gearbox() -> Result<Structure, Error> {
    let even = Coulomb::new(1.0, 1.0)?;
    let brake = Drive::profile(&[(1.0, BRAKE), (2.0, 0.0)])?;
    let clutch = Drive::profile(&[(6.0, 0.0), (7.0, CLUTCH)])?;
    let [first, second] = RATIOS.map(|ratio| [(0, 1.0), (1, -ratio)]);
    let freewheel = Freewheel::new(Coulomb::new(0.0, 0.0)?)?;
    Structure::new(&[ENGINE, CAR])?
        .with_force(0, TORQUE)?
        .with_contact(Contact::new(1, even, brake)?)?
        .with_contact(Contact::along(&first, freewheel, 1.0)?)?
        .with_contact(Contact::along(&second, even, clutch)?)?
        .with_contact(Contact::new(1, even, ROAD)?)
}

/// When the car moves, when first gear lets go, and when second gear locks.
fn closed_forms() -> [f64; 3] {
    let [i1, i2] = RATIOS;
    let drive = i1 * TORQUE - ROAD;
    // The capacity of the brake falls to what the road does not carry.
    let moves = 1.0 + (1.0 - drive / BRAKE);
    // In first gear, with the torque λ of the clutch: ω_out' = (drive − (i_1 − i_2) λ)/inertia, and
    // the freewheel carries T − λ − J_in i_1 ω_out'.
    let inertia = CAR + ENGINE * i1 * i1;
    let part = ENGINE * i1 / inertia;
    let torque = (TORQUE - part * drive) / (1.0 - part * (i1 - i2));
    let shift = torque / CLUTCH;
    // The momentum gained while the brake falls, in first gear, and while the clutch closes.
    let gained = 0.5 * BRAKE * (2.0 - moves) * (2.0 - moves) + drive * (4.0 + shift)
        - 0.5 * (i1 - i2) * CLUTCH * shift * shift;
    let speed = gained / inertia;
    // From there on the sliding speed is a quadratic polynomial of the time.
    let rate = (i1 - i2) * (drive - (i1 - i2) * torque) / inertia;
    let fall = CLUTCH * (1.0 / ENGINE + i2 * i2 / CAR);
    let slides = (rate + (rate * rate + 2.0 * fall * (i1 - i2) * speed).sqrt()) / fall;
    [moves, 6.0 + shift, 6.0 + shift + slides]
}

/// The first event of a contact of this kind.
fn of_kind(motion: &Trajectory<State>, contact: usize, kind: EventKind) -> Option<&Event<State>> {
    let mut events = motion.events().iter();
    events.find(|event| (event.contact(), event.kind) == (Some(contact), kind))
}

fn main() -> Result<(), Error> {
    let system = gearbox()?;
    let names = ["brake", "first gear", "second gear", "road"];
    println!("at rest, N·m:");
    for (name, carried) in names.iter().zip(system.carried(0.0, &State::at_rest(2))?) {
        let [least, most] = [carried.least, carried.most];
        println!("  {name:11}  from {least:6.1} to {most:6.1}");
    }
    let motion = system.simulate(State::at_rest(2), 12.0)?;
    println!("\nevents:");
    for event in motion.events() {
        let ([engine, car], Some(contact)) = (&event.state.velocities[..], event.contact()) else {
            continue;
        };
        println!(
            "  {:11.9} s  {:11}  {:18}  engine {engine:8.4} rad/s, output {car:8.4} rad/s",
            event.time,
            names[contact],
            event.kind.to_string()
        );
    }
    let kinds = [
        ("the car moves", 3, EventKind::Release(Direction::Leading)),
        (
            "first gear lets go",
            1,
            EventKind::Release(Direction::Lagging),
        ),
        ("second gear locks", 2, EventKind::Stick),
    ];
    println!("\n                        simulated        closed form");
    for ((what, contact, kind), expected) in kinds.into_iter().zip(closed_forms()) {
        if let Some(event) = of_kind(&motion, contact, kind) {
            println!("  {what:20}  {:.12}   {expected:.12}", event.time);
        }
    }
    Ok(())
}
