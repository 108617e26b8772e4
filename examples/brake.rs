//! Creep groan of a vehicle's disc brake, in physical units: kilograms, newtons per metre, newtons
//! in; hertz, millimetres, watts out.
//!
//! What to learn from it:
//!
//! * `Scaling` takes physical parameters, and a law given in m/s, to the dimensionless system and
//!   its results back to SI units;
//! * the damping at which steady sliding becomes stable is not the damping that silences the brake:
//!   in between a knock starts a groan that goes on for ever. The first comes from the slope of the
//!   law, the second from the limit cycles;
//! * the same with the speed: `hopf_velocities` says where steady sliding becomes stable, the
//!   stick-slip motion lasts longer.
//!
//! The model is one mass: the pad with its caliper on the elastic suspension, pressed on a disc
//! that creeps.
//!
//! Run it with `cargo run --release --example brake`.

use stick_slip::analysis::design::stabilizing_damping;
use stick_slip::{Error, LimitCycle, Physical, Scaling, Stribeck, bifurcation, limit_cycle};

/// Friction falls from 0.45 to 0.35, within some 0.05 m/s; the exponent 1 is Tustin's law.
fn law() -> Result<Stribeck, Error> {
    Stribeck::new(0.45, 0.35, 0.05, 1)
}

fn main() -> Result<(), Error> {
    let brake = Physical {
        mass: 4.0,           // kg
        stiffness: 1.0e6,    // N/m
        damping: 20.0,       // N·s/m
        normal_force: 800.0, // N
        belt_velocity: 0.03, // m/s, of the disc under the pad
    };
    let scaling = Scaling::new(brake)?;
    let system = scaling.system(law()?)?;
    println!("brake: 4 kg on 1e6 N/m, 20 N·s/m, pressed with 800 N, disc at 0.03 m/s");
    println!("  natural frequency  {:8.3} Hz", scaling.hertz(1.0));
    println!("  damping ratio      {:8.5}", system.damping());
    if let Some(steady) = system.equilibrium() {
        let deflection = 1e3 * scaling.metres(steady.displacement);
        println!(
            "  steady sliding     {deflection:8.3} mm deflection, {}",
            steady.stability
        );
    }

    println!("\nit settles to:");
    for cycle in limit_cycle::find(&system)?.stable() {
        describe(&scaling, cycle);
    }

    // Damping. Steady sliding becomes stable at C1, and the stick-slip motion dies at C2 only.
    let stable = stabilizing_damping(&system).unwrap_or(0.0);
    let silent = bifurcation::silencing_damping(&system)?;
    println!("\ndamping constant above which, at this speed,");
    for (what, damping) in [
        ("steady sliding is stable", stable),
        ("no groan can last", silent),
    ] {
        let constant = scaling.damping_constant(damping);
        println!("  {what:<26}  {constant:8.2} N·s/m");
    }
    for (what, factor) in [("1 % more than that", 1.01), ("1 % less", 0.99)] {
        let cycles = limit_cycle::find(&system.with_damping(factor * silent)?)?;
        let sounds = if cycles.is_empty() {
            "silent"
        } else {
            "groans"
        };
        println!("  with {what:<21}  {sounds}");
    }

    // Speed. The same two limits, with the damping that the brake has.
    let fast = scaling.dimensionless_velocity(2.0);
    println!("\ndisc speed above which, with its own damping,");
    for velocity in bifurcation::hopf_velocities(&system, 0.0..fast)? {
        println!(
            "  steady sliding is stable    {:8.4} m/s",
            scaling.metres_per_second(velocity)
        );
    }
    for velocity in bifurcation::grazing_velocities(&system, 0.1..fast)? {
        println!(
            "  no groan can last           {:8.4} m/s",
            scaling.metres_per_second(velocity)
        );
    }
    Ok(())
}

fn describe(scaling: &Scaling, cycle: &LimitCycle) {
    let heat = scaling.watts(cycle.energy().friction_loss / cycle.period());
    println!("  {}", cycle.kind());
    println!(
        "    frequency        {:8.3} Hz",
        scaling.hertz(cycle.frequency())
    );
    println!(
        "    sticking         {:8.3} % of the time",
        100.0 * cycle.stick_duration() / cycle.period()
    );
    println!(
        "    amplitude        {:8.4} mm",
        1e3 * scaling.metres(cycle.amplitude())
    );
    println!(
        "    largest speed    {:8.4} m/s backwards",
        -scaling.metres_per_second(cycle.min_velocity())
    );
    println!("    heat in the pad  {heat:8.4} W");
}
