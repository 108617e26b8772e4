//! Basins of attraction as a picture: which starts end in steady sliding, and which in stick-slip.
//!
//! What to learn from it:
//!
//! * `basins` finds the cycles once. For each start it then computes a few slip arcs only, not the
//!   whole transient;
//! * the unstable cycle is the border between the two basins.
//!
//! The picture is a PGM file, which most image viewers can show. Run it with
//! `cargo run --release -p stick-slip-examples --example basin > basin.pgm`.

use stick_slip::limit_cycle::{Attractor, basins};
use stick_slip::{Error, MassOnBelt, State, Stribeck};

/// Points across and down.
const SIZE: [usize; 2] = [400, 300];

fn main() -> Result<(), Error> {
    // μ̂ = 0.5 + 0.5 e^(−2s), and a belt fast enough for steady sliding to be stable.
    let law = Stribeck::new(1.0, 0.5, 0.5, 1)?;
    let system = MassOnBelt::new(law, 1.5)?.with_damping(0.05)?;
    let basins = basins(&system)?;
    for cycle in basins.cycles() {
        let stability = if cycle.is_stable() {
            "stable"
        } else {
            "unstable"
        };
        eprintln!(
            "{stability} {}: amplitude {:.4}",
            cycle.kind(),
            cycle.amplitude()
        );
    }
    // u from −2 to 2, v from 2 at the top to −1.
    let [width, height] = SIZE;
    println!("P2 {width} {height} 2");
    let mut sliding = 0;
    for row in 0..height {
        let v = 2.0 - 3.0 * (row as f64 + 0.5) / height as f64;
        for column in 0..width {
            let u = -2.0 + 4.0 * (column as f64 + 0.5) / width as f64;
            let grey = match basins.attractor(State::new(u, v))? {
                Attractor::Equilibrium => {
                    sliding += 1;
                    2
                }
                Attractor::Cycle(_) => 0,
                _ => 1,
            };
            print!("{grey} ");
        }
        println!();
    }
    let share = 100.0 * f64::from(sliding) / (width * height) as f64;
    eprintln!("{share:.1} % of the starts end in steady sliding");
    Ok(())
}
