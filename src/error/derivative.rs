//! The reasons why a motion has no derivative with respect to a parameter.

use super::Error;
use super::numbers::Plain;

/// The reason why a motion has no derivative with respect to a parameter.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum NotDifferentiable {
    /// Neighbouring motions on both sides of the parameter have other events, however small the
    /// increment: for example, a contact only just sticks, or the relative velocity of a slipping
    /// contact only just reaches 0.
    Events {
        /// The time of the first event that no neighbouring motion has, in units of time.
        time: f64,
    },
    /// Several contacts have events at the same instant. Neighbouring motions have these events in
    /// different orders, and the derivatives of both sides of the parameter differ.
    Order {
        /// The time of the first of these events, in units of time.
        time: f64,
    },
    /// The family jumps or has a kink at the parameter: difference quotients from shorter and
    /// shorter increments do not come closer to each other, or those of both sides differ.
    Kink,
    /// No motion exists on either side of the parameter: the family returns an error, or the motion
    /// ends in one.
    NoMotion(Box<Error>),
}

impl std::fmt::Display for NotDifferentiable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Events { time } => write!(
                f,
                "from the time {} on, neighbouring motions on both sides have other events, as at \
                 grazing; choose another value of the parameter, or a shorter duration",
                Plain(*time)
            ),
            Self::Order { time } => write!(
                f,
                "at the time {}, several contacts have events, which neighbouring motions have in \
                 different orders, and the derivatives of both sides differ; choose another value \
                 of the parameter, or a shorter duration",
                Plain(*time)
            ),
            Self::Kink => f.write_str(
                "difference quotients from shorter and shorter increments, or those of both \
                 sides, differ: the family jumps or has a kink there; choose another value of the \
                 parameter",
            ),
            Self::NoMotion(error) => write!(
                f,
                "there are no neighbouring motions on either side; choose another value of the \
                 parameter ({error})"
            ),
        }
    }
}
