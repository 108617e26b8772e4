//! Motions of one mass on its belt: every step, event and error.

#[path = "../common/mod.rs"]
mod common;

mod broken_laws;
mod check_law;
mod errors;
mod hostile;
mod independent;
mod integrator;
mod laws;
mod physical;
mod radau;
mod reference;
mod scaling;
mod stiff;
mod stop;
mod sweep;
