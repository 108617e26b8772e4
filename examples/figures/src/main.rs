//! Draws the figures of the source paper, and twelve more, as SVG files and as a page that shows
//! them.
//!
//! What to learn from it:
//!
//! * `motion.rs`: a trajectory drawn from its steps, with stick and slip in different styles, and
//!   the exact limit cycle;
//! * `amplitude.rs`: branches from `bifurcation::diagram`, compared with the paper's formulas and
//!   more accurate formulas. The belt velocities are densest at the exact borders, where amplitudes
//!   change like square roots;
//! * `regimes.rs`: a map of attractors whose borders are computed curves, not the result of a grid
//!   of simulations;
//! * `resonance.rs`: branches of periodic motions followed through folds by `orbit::follow`;
//! * `chaos.rs`: a Poincaré section and the largest Lyapunov exponent over a parameter;
//! * `errors.rs`: the order of the error of each formula, visible as a slope;
//! * `memory.rs`: closed forms for rising static friction, compared with settled motions; bristles,
//!   compared with dry friction, which is their limit;
//! * `joint.rs`: exact resonance curves of a mass on a spring with a slider, compared with
//!   first-harmonic theory;
//! * `beam.rs`: curves that take minutes, read from the file that the example `bolted_beam` writes;
//! * `fault.rs`: the speed of a fault over 15 decades, from the cycle that the example `earthquake`
//!   finds;
//! * `laws.rs`: friction laws on both sides of zero;
//! * `structures.rs`: the events of many contacts over time and place; eigenvalues of steady
//!   sliding over a parameter;
//! * `plot.rs` and the files that it uses: the parts of plotters that a printed figure needs.
//!
//! Run it with `cargo run --release -p stick-slip-figures`; to write to another folder than
//! `target/figures`, add its name after `--`. One of the files is kept in this folder for the
//! README, and six in `src/figures` of the crate for its pages. To renew them, draw them and copy
//! them.

mod amplitude;
mod beam;
// The model and its sweeps, with what else the example prints.
#[allow(dead_code)]
#[path = "../../bolted_beam.rs"]
mod bolted_beam;
mod chaos;
mod clip;
// The cycle, with what else the example prints.
#[allow(dead_code)]
#[path = "../../earthquake.rs"]
mod earthquake;
mod errors;
mod fault;
mod joint;
mod laws;
mod memory;
mod motion;
mod plot;
mod regimes;
mod resonance;
mod structures;
mod style;
mod svg;
#[cfg(test)]
mod tests;
mod typeset;

use std::path::PathBuf;
use std::time::Instant;

use svg::{Figure, Result};
use typeset::escape;

type Draw = fn() -> Result<Figure>;

/// Name of the file, and what draws it.
const FIGURES: [(&str, Draw); 18] = [
    ("fig2_polynomial_law", laws::polynomial),
    ("fig3_exponential_law", laws::exponential),
    ("fig4_pure_slip", motion::fig4),
    ("fig5_stick_slip", motion::fig5),
    ("fig6_amplitude", amplitude::fig6),
    ("fig7_exponential_stick_slip", motion::fig7),
    ("regimes", regimes::regimes),
    ("bistability", amplitude::bistability),
    ("errors", errors::errors),
    ("dwell", memory::dwell),
    ("lugre", memory::lugre),
    ("joint", joint::joint),
    ("bolted_beam", beam::beam),
    ("fault", fault::fault),
    ("chain", structures::chain),
    ("mode_coupling", structures::mode_coupling),
    ("resonance", resonance::resonance),
    ("chaos", chaos::chaos),
];

fn main() -> Result<()> {
    let folder = std::env::args_os().nth(1).map(PathBuf::from);
    let folder = folder.unwrap_or_else(|| PathBuf::from("target/figures"));
    std::fs::create_dir_all(&folder)?;
    let mut page =
        String::from("<!DOCTYPE html>\n<meta charset=\"utf-8\">\n<title>stick-slip</title>\n");
    for (name, draw) in FIGURES {
        let start = Instant::now();
        let figure = draw()?;
        let file = format!("{name}.svg");
        std::fs::write(folder.join(&file), figure.svg)?;
        eprintln!("{file:<32} {:.1} s", start.elapsed().as_secs_f64());
        let caption = escape(&figure.caption);
        page.push_str(&format!(
            "<figure><img src=\"{file}\" alt=\"\"><figcaption>{caption}</figcaption></figure>\n"
        ));
    }
    let path = folder.join("index.html");
    std::fs::write(&path, page)?;
    println!("{}", path.display());
    Ok(())
}
