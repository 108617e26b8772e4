//! Steady sliding and stick-slip coexist: the same machine is silent or vibrates, depending on its
//! start.
//!
//! What to learn from it:
//!
//! * a system with a general law can have several attractors. `limit_cycle::find` returns all
//!   cycles, including the unstable cycle between the attractors. `limit_cycle::attractor` returns
//!   the attractor of a start without simulating the whole transient;
//! * a simulation shows only one attractor, and settles slowly if it starts near the unstable
//!   cycle;
//! * `bifurcation` gives the range of belt velocities in which both attractors exist, and
//!   `bifurcation::diagram` gives all cycles over the belt velocity.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example bistability`.

use stick_slip::limit_cycle::{Attractor, attractor};
use stick_slip::{CycleSet, Error, Exponential, MassOnBelt, State};
use stick_slip::{bifurcation, limit_cycle};

fn main() -> Result<(), Error> {
    let law = Exponential::new(0.6, 0.3, 0.4)?;
    let system = MassOnBelt::new(law, 1.0)?.with_damping(0.01)?;
    println!("exponential law, μ_s = 0.6, μ_k = 0.3, v_s = 0.4; β = 0.01, γ² = 1, v_b = 1");

    let Some(equilibrium) = system.equilibrium() else {
        return Ok(());
    };
    let rest = equilibrium.displacement;
    println!("\nlasting motions, from the inside outwards:");
    println!(
        "  {:<14} {:>12} {:>12} {:>12}",
        "", "amplitude", "v_max", "multiplier"
    );
    println!(
        "  {:<14} {:12.9} {:12.9} {:>12}  {}",
        "steady sliding", 0.0, 0.0, "", equilibrium.stability
    );
    for cycle in &limit_cycle::find(&system)? {
        println!(
            "  {:<14} {:12.9} {:12.9} {:12.9}  {}",
            cycle.kind().to_string(),
            cycle.amplitude(),
            cycle.max_velocity(),
            cycle.multiplier(),
            if cycle.is_stable() {
                "stable"
            } else {
                "unstable"
            }
        );
    }

    println!(
        "\nan impulse gives the sliding mass the velocity v; its largest displacement from steady \
         sliding"
    );
    println!("in the first and in the last of 100 oscillations, and the motion that it reaches:");
    println!("  {:>8}  {:>9}  {:>9}  settles to", "v", "first", "last");
    for knock in [0.1, 0.3, 0.311, 0.3115, 0.32, 0.5] {
        let start = State::new(rest, knock);
        let settles_to = match attractor(&system, start)? {
            Attractor::Equilibrium => "steady sliding".to_string(),
            Attractor::Cycle(cycle) => cycle.kind().to_string(),
            other => format!("{other:?}"),
        };
        let turn = std::f64::consts::TAU;
        let motion = system.simulate(start, 100.0 * turn)?;
        let displacement = |from: f64| {
            let times = (0..1000).map(|i| from + turn * f64::from(i) / 1000.0);
            let states = times.filter_map(|time| motion.state_at(time));
            states.fold(0.0, |largest: f64, state| {
                largest.max((state.displacement - rest).abs())
            })
        };
        let (first, last) = (displacement(0.0), displacement(99.0 * turn));
        println!("  {knock:8}  {first:9.6}  {last:9.6}  {settles_to}");
    }

    println!("\nbelt velocities:");
    for velocity in bifurcation::hopf_velocities(&system, 0.0..5.0)? {
        let criticality = bifurcation::criticality(&system, velocity);
        println!("  steady sliding changes its stability at   {velocity:.9}  ({criticality:?})");
    }
    for velocity in bifurcation::grazing_velocities(&system, 0.0..5.0)? {
        println!("  stick-slip appears or disappears at       {velocity:.9}");
    }

    println!("\namplitudes over the belt velocity:");
    println!(
        "  {:>5}  {:<15}  {:>14}  {:>12}",
        "v_b", "steady sliding", "unstable cycle", "stable cycle"
    );
    let velocities = (1..=16).map(|i| 0.25 * f64::from(i));
    for point in bifurcation::diagram(&system, velocities) {
        let point = point?;
        let stability = point.equilibrium.map_or(String::new(), |equilibrium| {
            equilibrium.stability.to_string()
        });
        let unstable = amplitude(&point.cycles, false);
        let sticking = amplitude(&point.cycles, true);
        println!(
            "  {:5.2}  {stability:<15}  {unstable:>14}  {sticking:>12}",
            point.belt_velocity
        );
    }
    Ok(())
}

/// Amplitude of the innermost cycle that is stable, or unstable; a dash if there is none.
fn amplitude(cycles: &CycleSet, stable: bool) -> String {
    let cycle = cycles.iter().find(|cycle| cycle.is_stable() == stable);
    cycle.map_or("-".into(), |cycle| format!("{:.9}", cycle.amplitude()))
}
