//! The figures. `amplitude`, `chaos`, `errors`, `laws`, `memory`, `motion`, `regimes`, `resonance`
//! and `structures` draw them; the other modules are for what they look like.

mod amplitude;
mod chaos;
mod clip;
mod errors;
mod laws;
mod memory;
mod motion;
mod plot;
mod regimes;
mod resonance;
mod structures;
mod style;
mod svg;
mod typeset;

pub(crate) use svg::{Figure, Result};
pub(crate) use typeset::escape;

type Draw = fn() -> Result<Figure>;

/// Name of the file, and what draws it.
pub(crate) const FIGURES: [(&str, Draw); 15] = [
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
    ("chain", structures::chain),
    ("mode_coupling", structures::mode_coupling),
    ("resonance", resonance::resonance),
    ("chaos", chaos::chaos),
];
