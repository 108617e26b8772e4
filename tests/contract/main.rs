//! What users rely on: names, signatures, traits, the README and its figures.

mod api;
mod belt;
mod cycles;
mod figures;
mod house;
mod readme;
mod refusals;
