//! What users rely on: names, signatures, traits, the README. Its figures are judged by tests of
//! the example that draws them.

mod api;
mod belt;
mod cycles;
mod house;
mod readme;
mod refusals;
