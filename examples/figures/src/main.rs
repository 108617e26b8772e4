//! The figures of the source paper, and eleven more, as SVG files and a page that shows them.
//!
//! What to learn from it:
//!
//! * `motion.rs`: a trajectory drawn from its steps, with stick and slip apart; the exact limit
//!   cycle over it;
//! * `amplitude.rs`: branches from `bifurcation::diagram`, with belt velocities that crowd at the
//!   exact borders, where amplitudes change like square roots; the paper's formulas and better ones
//!   over them;
//! * `regimes.rs`: a map whose borders are computed, not sampled: what takes a grid of simulations
//!   elsewhere is a handful of curves here;
//! * `resonance.rs`: branches of periodic motions followed through folds by `orbit::follow`;
//! * `chaos.rs`: a Poincaré section and the largest Lyapunov exponent over a parameter;
//! * `errors.rs`: a formula is as good as the order of its error, seen as a slope;
//! * `memory.rs`: closed forms for rising static friction under motions that have settled; bristles
//!   beside the dry friction that is their limit;
//! * `joint.rs`: exact resonance curves of a mass on a spring with a slider, beside first-harmonic
//!   theory;
//! * `beam.rs`: sweeps that take minutes, read from the file that the example `bolted_beam` writes;
//! * `laws.rs`: friction laws on both sides of zero;
//! * `structures.rs`: the events of many contacts over time and place; eigenvalues of steady
//!   sliding over a parameter;
//! * `plot.rs` and what it uses: as much of plotters as a figure in print needs.
//!
//! Run it with `cargo run --release -p stick-slip-figures`; another folder than `target/figures`
//! comes after `--`. One of the files is kept in this folder, for the README, and five in
//! `src/figures` of the crate, for its pages: to renew them, draw them and copy them.

mod amplitude;
mod beam;
// The model and its sweeps, with what else the example prints.
#[allow(dead_code)]
#[path = "../../bolted_beam.rs"]
mod bolted_beam;
mod chaos;
mod clip;
mod errors;
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
const FIGURES: [(&str, Draw); 17] = [
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
