//! What users rely on: traits, texts, errors, the README. Its figures are judged by tests of the
//! package that draws them, its names by every other test, which uses them.

mod api;
mod house;
mod readme;
mod refusals;
