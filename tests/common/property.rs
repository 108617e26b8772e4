//! Properties over random numbers. `proptest` is compiled once for all of a program.

use std::ops::Range;
use std::panic::Location;

use proptest::test_runner::{Config, TestCaseResult, TestRunner};

/// Checks a property for so many draws of N numbers, each uniform in its range. A draw that fails
/// is made as simple as it can be.
#[track_caller]
pub fn for_all<const N: usize>(
    cases: usize,
    ranges: [Range<f64>; N],
    property: impl Fn([f64; N]) -> TestCaseResult,
) {
    let file = Location::caller().file();
    check(file, cases, &Vec::from(ranges), &|numbers| {
        property(numbers.try_into().unwrap())
    });
}

fn check(
    file: &'static str,
    cases: usize,
    ranges: &Vec<Range<f64>>,
    property: &dyn Fn(Vec<f64>) -> TestCaseResult,
) {
    let config = Config {
        cases: cases as u32,
        source_file: Some(file),
        ..Config::default()
    };
    let checked = TestRunner::new(config).run(ranges, property);
    checked.unwrap_or_else(|error| panic!("{error}"));
}
