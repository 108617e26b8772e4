//! Analytic formulas, against the exact motions.

#[path = "../common/mod.rs"]
mod common;

mod averaging;
mod formulas;
mod jenkins;
mod misprints;
mod motions;
mod orders;
mod properties;
