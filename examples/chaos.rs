//! From a regular to a chaotic motion: the Poincaré section of a forced stick-slip oscillator, once
//! in each period of the force, with the largest Lyapunov exponent.
//!
//! What to learn from it:
//!
//! * `orbit::section` is an unbounded iterator: memory use does not grow with the length of the
//!   motion;
//! * the exponent is computed from the variational equations, not from two simulations. The
//!   exponent distinguishes a periodic motion (below 0) from chaos (above 0 by more than its
//!   spread) and from a torus (0). If the exponent is `−∞`, perturbations vanish in finite time:
//!   the mass sticks;
//! * threads can share systems: here each thread computes a part of the range.
//!
//! Run it with `cargo run --release -p stick-slip-examples --example chaos`.

use stick_slip::orbit::{self, LyapunovExponent};
use stick_slip::structure::State;
use stick_slip::{Contact, Drive, Error, Polynomial, Structure};

const FORCES: usize = 48;
const TRANSIENT: usize = 300;
const SAMPLES: usize = 200;

const FREQUENCY: f64 = 1.15;

/// A mass on a belt, and a force that varies in time:
/// x'' + 0.06 x' + x = p cos 1.15t − 0.9 μ(v_r).
fn oscillator(force: f64) -> Result<Structure, Error> {
    let law = Polynomial::new(0.55, 0.3, 0.7)?;
    Structure::new(&[1.0])?
        .with_ground_spring(0, 1.0)?
        .with_ground_damper(0, 0.06)?
        .with_force(0, Drive::harmonic(force, FREQUENCY, 0.0)?)?
        .with_contact(Contact::new(0, law, 0.9)?.on_belt(0.25))
}

struct Row {
    force: f64,
    /// Displacements once a period.
    section: Vec<f64>,
    exponent: LyapunovExponent,
}

fn row(force: f64) -> Result<Row, Error> {
    let system = oscillator(force)?;
    let period = std::f64::consts::TAU / FREQUENCY;
    let start = State::at_rest(1);
    let section = orbit::section(&system, &start, period);
    let section = section.skip(TRANSIENT).take(SAMPLES);
    let section = section.map(|state| Ok(state?.displacements[0]));
    let section = section.collect::<Result<_, Error>>()?;
    let transient = TRANSIENT as f64 * period;
    let duration = 5.0 * SAMPLES as f64 * period;
    let exponent = orbit::lyapunov_with_spread(&system, &start, transient, duration)?;
    Ok(Row {
        force,
        section,
        exponent,
    })
}

/// How many different states a section holds, up to a thousandth.
fn different(section: &[f64]) -> usize {
    let mut sorted = section.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted.dedup_by(|a, b| (*a - *b).abs() < 1e-3);
    sorted.len()
}

fn main() -> Result<(), Error> {
    let force = |i: usize| 0.07 + 0.05 * i as f64 / (FORCES - 1) as f64;
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let rows: Vec<Result<Row, Error>> = std::thread::scope(|scope| {
        let part = |first: usize| move || (first..FORCES).step_by(threads);
        let workers: Vec<_> = (0..threads)
            .map(|first| {
                let places = part(first);
                scope.spawn(move || places().map(|i| row(force(i))).collect::<Vec<_>>())
            })
            .collect();
        let done = workers.into_iter().map(|worker| worker.join());
        done.flat_map(|rows| rows.unwrap_or_default()).collect()
    });
    let mut rows = rows.into_iter().collect::<Result<Vec<_>, _>>()?;
    rows.sort_by(|a, b| a.force.total_cmp(&b.force));
    println!("   p        exponent     states   from       to");
    for row in rows {
        let least = row.section.iter().copied().fold(f64::INFINITY, f64::min);
        let most = row
            .section
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max);
        println!(
            "  {:.5}  {:10.6}   {:6}   {least:9.6}  {most:9.6}  {}",
            row.force,
            row.exponent.value,
            different(&row.section),
            if row.exponent.value > 4.0 * row.exponent.spread {
                "chaotic"
            } else {
                ""
            }
        );
    }
    Ok(())
}
