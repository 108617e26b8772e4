//! Limit cycles and bifurcations.

#[path = "../common/mod.rs"]
mod common;

mod along;
mod bifurcations;
mod brute_force;
mod cases;
mod cycles;
mod faults;
mod folds;
mod maps;
mod measures;
mod properties;
mod stiff;
