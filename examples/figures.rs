//! The figures of the source paper, and nine more, as SVG files and a page that shows them.
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
//! * `laws.rs`: friction laws on both sides of zero;
//! * `structures.rs`: the events of many contacts over time and place; eigenvalues of steady
//!   sliding over a parameter;
//! * `plot.rs` and what it uses: as much of plotters as a figure in print needs.
//!
//! Run it with `cargo run --release --example figures`; another folder than `target/figures` comes
//! after `--`. Two of the files are kept beside the source, for the README:
//! `cargo run --release --example figures -- FOLDER`, and copy them, to renew them.

use std::path::PathBuf;
use std::time::Instant;

use figures::{FIGURES, Result, escape};

#[path = "figures/mod.rs"]
mod figures;
#[cfg(test)]
#[path = "figures/tests.rs"]
mod tests;

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
