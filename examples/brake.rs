//! Creep groan of a vehicle's disc brake, in SI units throughout: the input is in kilograms,
//! newtons per metre and newtons; the results are in hertz, millimetres and watts.
//!
//! What to learn from it:
//!
//! * `PhysicalMassOnBelt` takes parameters in SI units and a law in m/s; all its results are in SI
//!   units;
//! * the damping at which steady sliding becomes stable is less than the damping that silences the
//!   brake: with a damping between these two values, a disturbance starts a groan that lasts for
//!   ever. The first value follows from the slope of the law, the second from the limit cycles;
//! * the speed also has two limits: `hopf_velocities` gives the speed at which steady sliding
//!   becomes stable, but the stick-slip motion exists up to a higher speed.
//!
//! The model is one mass: the pad with its caliper on the elastic suspension, pressed on a disc
//! that creeps.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example brake`.

use stick_slip::analysis::design::stabilizing_damping;
use stick_slip::{Error, LimitCycle, Physical, PhysicalMassOnBelt, Stribeck, bifurcation};

/// Friction falls from 0.45 to 0.35, within some 0.05 m/s; the exponent 1 is Tustin's law.
fn law() -> Result<Stribeck, Error> {
    Stribeck::new(0.45, 0.35, 0.05, 1)
}

fn main() -> Result<(), Error> {
    let parameters = Physical {
        mass: 4.0,           // kg
        stiffness: 1.0e6,    // N/m
        damping: 20.0,       // N·s/m
        normal_force: 800.0, // N
        belt_velocity: 0.03, // m/s, of the disc under the pad
    };
    let brake = PhysicalMassOnBelt::new(parameters, law()?)?;
    println!("brake: 4 kg on 1e6 N/m, 20 N·s/m, pressed with 800 N, disc at 0.03 m/s");
    let system = brake.dimensionless();
    println!("  natural frequency  {:8.3} Hz", brake.scaling().hertz(1.0));
    println!("  damping ratio      {:8.5}", system.damping());
    if let Some(steady) = brake.equilibrium() {
        let deflection = 1e3 * steady.displacement;
        println!(
            "  steady sliding     {deflection:8.3} mm deflection, {}",
            steady.stability
        );
    }

    println!("\nthe brake settles to:");
    for cycle in brake.cycles()?.stable() {
        describe(cycle);
    }

    // Damping. Steady sliding becomes stable at C1, but the stick-slip motion disappears only at
    // C2.
    let stable = stabilizing_damping(system).unwrap_or(0.0);
    let stable = brake.scaling().damping_constant(stable);
    let silent = brake.silencing_damping()?;
    println!("\ndamping constant above which, at this speed,");
    for (what, constant) in [
        ("steady sliding is stable", stable),
        ("no groan can last", silent),
    ] {
        println!("  {what:<26}  {constant:8.2} N·s/m");
    }
    for (what, factor) in [("1 % more than that", 1.01), ("1 % less", 0.99)] {
        let damped = Physical {
            damping: factor * silent,
            ..parameters
        };
        let cycles = PhysicalMassOnBelt::new(damped, law()?)?.cycles()?;
        let sounds = if cycles.is_empty() {
            "silent"
        } else {
            "groans"
        };
        println!("  with {what:<21}  {sounds}");
    }

    // Speed. The two limits for the brake's own damping.
    println!("\ndisc speed above which, with its own damping,");
    for velocity in brake.velocities(bifurcation::hopf_velocities, 0.0..2.0)? {
        println!("  steady sliding is stable    {velocity:8.4} m/s");
    }
    for velocity in brake.velocities(bifurcation::grazing_velocities, 0.01..2.0)? {
        println!("  no groan can last           {velocity:8.4} m/s");
    }
    Ok(())
}

fn describe(cycle: &LimitCycle) {
    println!("  {}", cycle.kind());
    println!("    frequency        {:8.3} Hz", 1.0 / cycle.period());
    println!(
        "    sticking         {:8.3} % of the time",
        100.0 * cycle.stick_duration() / cycle.period()
    );
    println!("    amplitude        {:8.4} mm", 1e3 * cycle.amplitude());
    println!(
        "    rms velocity     {:8.3} mm/s",
        1e3 * cycle.rms_velocity()
    );
    println!(
        "    peak acceleration{:8.3} m/s²",
        cycle.peak_acceleration()
    );
    println!(
        "    largest speed    {:8.4} m/s backwards",
        -cycle.min_velocity()
    );
    let heat = cycle.energy().friction_loss / cycle.period();
    println!("    heat in the pad  {heat:8.4} W");
}
