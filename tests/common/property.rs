//! Properties of random numbers, by one runner of proptest's: a runner is compiled for each type of
//! random thing.

use proptest::array::uniform9;
use proptest::test_runner::{Config, FileFailurePersistence, TestCaseError, TestRunner};

/// Numbers between 0 and 1, of which a property uses as many as it needs.
pub(crate) type Numbers = [f64; 9];

/// The number so far between two others.
pub(crate) fn between(low: f64, high: f64, part: f64) -> f64 {
    low + (high - low) * part
}

/// The same in the logarithm.
pub(crate) fn decades(low: f64, high: f64, part: f64) -> f64 {
    between(low.ln(), high.ln(), part).exp()
}

/// Tries a property on random numbers.
pub(crate) fn check(property: impl Fn(Numbers) -> Result<(), TestCaseError>) {
    run(&property);
}

fn run(property: &dyn Fn(Numbers) -> Result<(), TestCaseError>) {
    let config = Config {
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct(
            "proptest-regressions/numbers.txt",
        ))),
        ..Config::default()
    };
    let result = TestRunner::new(config).run(&uniform9(0.0..1.0_f64), property);
    result.unwrap_or_else(|error| panic!("{error}"));
}
