//! Numbers beside what they should be.

/// The largest error met so far, in units of max(1, |value|) times what is allowed, and of what. A
/// NaN is larger than all.
#[derive(Debug, Clone, Default)]
pub struct Worst(pub f64, pub String);

impl Worst {
    pub fn meet(&mut self, what: &str, actual: f64, expected: f64) {
        self.meet_within(1.0, what, actual, expected);
    }

    pub fn meet_within(&mut self, allowed: f64, what: &str, actual: f64, expected: f64) {
        let error = (actual - expected).abs() / (allowed * expected.abs().max(1.0));
        if error.is_nan() || error > self.0 {
            *self = Self(error, format!("{what}: {actual:e}, not {expected:e}"));
        }
    }

    /// As many numbers as expected.
    pub fn meet_all(&mut self, allowed: f64, what: &str, actual: &[f64], expected: &[f64]) {
        assert_eq!(actual.len(), expected.len(), "{what}");
        for (actual, expected) in actual.iter().zip(expected) {
            self.meet_within(allowed, what, *actual, *expected);
        }
    }

    /// Returns true if no error is larger than this, and none is NaN.
    pub fn is_within(&self, allowed: f64) -> bool {
        self.0 <= allowed
    }

    #[track_caller]
    pub fn assert(&self, about: &str, allowed: f64) {
        println!("{about}: {:.1e} ({})", self.0, self.1);
        assert!(
            self.is_within(allowed),
            "{about}: {:.1e}, {}",
            self.0,
            self.1
        );
    }
}

/// Asserts that an error is within max(1, |expected|) times what is allowed.
#[track_caller]
pub fn assert_met(what: &str, actual: f64, expected: f64, allowed: f64) {
    let mut worst = Worst::default();
    worst.meet(what, actual, expected);
    assert!(
        worst.is_within(allowed),
        "{}: off by {:.1e}",
        worst.1,
        worst.0
    );
}
