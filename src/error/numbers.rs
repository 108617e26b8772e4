//! The text of numbers in messages.

/// A number as one would write it: with its power of ten only below 1e-4 and from 1e6 on.
pub(crate) struct Plain(pub(crate) f64);

impl std::fmt::Display for Plain {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let x = self.0;
        if x == 0.0 || !x.is_finite() || (1e-4..1e6).contains(&x.abs()) {
            write!(f, "{x}")
        } else {
            write!(f, "{x:e}")
        }
    }
}

/// A number to six digits, as one would write it.
pub(crate) struct Digits(pub(crate) f64);

impl std::fmt::Display for Digits {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let rounded = format!("{:.5e}", self.0).parse();
        Plain(rounded.unwrap_or(self.0)).fmt(f)
    }
}

/// The remedy in a message, for a number that is not allowed.
pub(super) fn instead(value: f64, allowed: &str) -> String {
    if value.is_finite() {
        format!(": {allowed}")
    } else {
        format!("; give a finite number: {allowed}")
    }
}

/// The part of a message that says why a law is not one constant: its μ_s and μ̂(0), or none.
pub(crate) struct Coefficients(pub(crate) Option<[f64; 2]>);

impl std::fmt::Display for Coefficients {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.0 {
            Some([limit, kinetic]) => {
                write!(
                    f,
                    "has μ_s = {} and μ̂(0) = {}, or varies with the speed or the direction",
                    Plain(limit),
                    Plain(kinetic)
                )
            }
            None => f.write_str(
                "never sticks: its friction at rest depends on its memory variables alone",
            ),
        }
    }
}
