//! Stick-slip of a drill string, in SI units: kilograms, newtons, metres and seconds.
//!
//! What to learn from it:
//!
//! * a structure takes any consistent units. Here coordinates are angles in radians, "masses" are
//!   moments of inertia in kg·m², stiffnesses are N·m per radian, and friction is a torque: the
//!   normal load of the contact times the lever arm of the bit;
//! * the coordinates rotate with the rotary table, so the rock is a belt that moves backwards;
//! * `steady_sliding` shows the speeds at which the string can rotate steadily. At lower speeds the
//!   bit stops and breaks free again, and then rotates several times faster than the table.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example drill_string`.

use std::f64::consts::TAU;

use stick_slip::analysis::drill_string::TwoInertias;
use stick_slip::structure::State;
use stick_slip::{Contact, Error, EventKind, FrictionLaw, Stribeck, Structure};

/// The bit with its collars, and the drive with its table, kg·m².
const BIT: f64 = 374.0;
const TABLE: f64 = 2122.0;
/// The pipe, N·m per radian, and its damping, N·m·s.
const PIPE: f64 = 473.0;
const PIPE_DAMPING: f64 = 23.2;
/// Stiffness and damping with which the drive holds the table, N·m per radian and N·m·s.
const DRIVE: f64 = 4000.0;
const DRIVE_DAMPING: f64 = 425.0;
/// Weight on bit in newtons, times the radius in metres at which the rock force acts.
const WEIGHT: f64 = 120e3;
const RADIUS: f64 = 0.1;

/// Rock: 0.8 at rest, 0.4 when it is cut, falling within about 1 rad/s.
fn rock() -> Result<Stribeck, Error> {
    Stribeck::new(0.8, 0.4, 1.0, 1)
}

/// The string in the frame of a table that rotates at a speed in rad/s. Coordinate 0 is the bit,
/// coordinate 1 the table.
fn string(speed: f64) -> Result<Structure, Error> {
    let contact = Contact::new(0, rock()?, WEIGHT * RADIUS)?.on_belt(-speed);
    Structure::new(&[BIT, TABLE])?
        .with_spring(0, 1, PIPE)?
        .with_damper(0, 1, PIPE_DAMPING)?
        .with_ground_spring(1, DRIVE)?
        .with_ground_damper(1, DRIVE_DAMPING)?
        .with_contact(contact)
}

fn main() -> Result<(), Error> {
    println!("drill string: bit {BIT} kg·m², table {TABLE} kg·m², pipe {PIPE} N·m/rad");
    println!("\n  rpm   steady turning   growth 1/s   bit stops   fastest rad/s");
    for rpm in [30.0, 50.0, 70.0, 90.0, 110.0] {
        let speed = rpm * TAU / 60.0;
        let string = string(speed)?;
        let (steady, growth) = match string.steady_sliding() {
            Ok(steady) => {
                let kind = if steady.is_stable() {
                    "stable"
                } else {
                    "unstable"
                };
                (kind, steady.eigenvalues[0].re)
            }
            Err(_) => ("none", f64::NAN),
        };
        // A disturbance: all parts rotate with the table, but the bit is at rest on the rock.
        let start = State::new(&[0.0, 0.0], &[-speed, 0.0]);
        let motion = string.simulate(start, 120.0)?;
        let late = motion.events().iter().filter(|event| event.time > 60.0);
        let stops = late.filter(|event| event.kind == EventKind::Stick).count();
        // In the fixed frame: the speed of the table is added.
        let speeds = motion.sample(6000).skip(3000);
        let fastest = speeds.map(|(_, state)| speed + state.velocities[0]);
        let fastest = fastest.fold(0.0, f64::max);
        println!("  {rpm:3}   {steady:<14}   {growth:10.4}   {stops:6} in a minute {fastest:8.3}");
    }

    // The twist of the pipe when the bit breaks free, in turns.
    let speed = 50.0 * TAU / 60.0;
    let motion = string(speed)?.simulate(State::new(&[0.0, 0.0], &[-speed, 0.0]), 20.0)?;
    println!("\nat 50 rpm");
    for event in motion.events().iter().take(6) {
        let twist = (event.state.displacements[1] - event.state.displacements[0]) / TAU;
        println!(
            "  {:8.4} s  {:<20}  pipe twisted by {twist:.4} turns",
            event.time, event.kind
        );
    }

    // The formula for two inertias alone, without the spring of the drive and the damping of the
    // pipe.
    let inertias = TwoInertias {
        upper: TABLE,
        lower: BIT,
        stiffness: PIPE,
        damping: DRIVE_DAMPING,
    };
    let torque_slope = |speed: f64| rock().map(|law| WEIGHT * RADIUS * law.slope(speed));
    if let Some(critical) = inertias.critical_slope() {
        println!(
            "\nwith an undamped pipe and no spring in the drive, steady turning is stable if \
             friction falls\nby less than {:.2} N·m·s; it falls",
            -critical
        );
        for rpm in [50.0, 110.0] {
            println!(
                "  by {:8.2} N·m·s at {rpm} rpm",
                -torque_slope(rpm * TAU / 60.0)?
            );
        }
    }
    println!(
        "a drive with a damping of {:.0} N·m·s would damp most",
        inertias.best_damper()
    );
    Ok(())
}
