//! Your own friction law: with two functions, the whole crate works with it.
//!
//! What to learn from it:
//!
//! * `kinetic` is written once, generic over the number type. From this function the crate computes
//!   exact slopes and power series along a motion, so no derivative is written by hand;
//! * constants stand on the right of an operator (`speed / s0 + 1.0`), because Rust does not allow
//!   an `f64` on the left of a generic number;
//! * your law has the same functions as a built-in law: events, limit cycles, bifurcation
//!   velocities.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example custom_law`.

use stick_slip::{FrictionLaw, MassOnBelt, Scalar, State, bifurcation, limit_cycle};

/// Friction that falls with the logarithm of the speed, as measured between rocks: μ̂(s) = μ_s − b
/// ln(1 + s/s0).
struct Logarithmic {
    static_coefficient: f64,
    rate: f64,
    cutoff: f64,
}

impl FrictionLaw for Logarithmic {
    fn static_coefficient(&self) -> f64 {
        self.static_coefficient
    }
    #[inline(always)]
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        -(speed / self.cutoff + 1.0).ln() * self.rate + self.static_coefficient
    }
}

fn main() -> Result<(), stick_slip::Error> {
    let law = Logarithmic {
        static_coefficient: 0.6,
        rate: 0.03,
        cutoff: 0.02,
    };
    println!("law: μ̂(s) = 0.6 − 0.03 ln(1 + s/0.02)");
    println!("{:>6}  {:>12}  {:>12}", "s", "μ̂(s)", "dμ̂/ds");
    for speed in [0.0, 0.01, 0.1, 0.5] {
        println!(
            "{speed:6}  {:12.9}  {:12.9}",
            law.kinetic(speed),
            law.slope(speed)
        );
    }

    let system = MassOnBelt::new(law, 0.1)?.with_damping(0.05)?;
    println!("\nfrom rest on a belt with v_b = 0.1, damping ratio 0.05:");
    for event in system.simulate(State::new(0.0, 0.0), 20.0)?.events() {
        println!("  {event}");
    }

    println!("\nperiodic motions there:");
    for cycle in &limit_cycle::find(&system)? {
        println!(
            "  {}, period {:.9}, amplitude {:.9}, {}",
            cycle.kind(),
            cycle.period(),
            cycle.amplitude(),
            if cycle.is_stable() {
                "stable"
            } else {
                "unstable"
            }
        );
    }

    // 2β + γ² dμ̂/ds = 0 at v_b = γ²b/(2β) − s0 = 0.28.
    println!("\nbelt velocities above which");
    for velocity in bifurcation::hopf_velocities(&system, 0.0..2.0)? {
        println!("  steady sliding is stable:  {velocity:.9}  (by hand: 0.28)");
    }
    for velocity in bifurcation::grazing_velocities(&system, 0.01..2.0)? {
        println!("  nothing sticks:            {velocity:.9}");
    }
    println!("Between the two, steady sliding and stick-slip are both stable.");
    Ok(())
}
