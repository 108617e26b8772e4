//! Errors from checks, and errors that get their place.

use std::ops::Range;

use super::{Element, Error, Reached};

impl Error {
    /// Wraps this error in an [`Error::At`], with the value of the parameter at which it happened.
    pub(crate) fn at(self, parameter: &'static str, value: f64) -> Self {
        // A stop is no failure of the system there.
        if matches!(self, Self::Stopped { .. }) {
            return self;
        }
        Self::At {
            parameter,
            value,
            source: Box::new(self),
        }
    }

    /// [`at`](Self::at) with both parameters of a search over two.
    pub(crate) fn at_pair(self, [first, second]: [f64; 2]) -> Self {
        self.at("second parameter", second)
            .at("first parameter", first)
    }

    /// Checks that a range is finite and not empty. `names` are those of its ends.
    pub(crate) fn check_range(
        of: &'static str,
        names: [&'static str; 2],
        range: &Range<f64>,
    ) -> Result<(), Self> {
        let Range { start, end } = *range;
        Self::check(of, names[0], start, true, "start < end")?;
        Self::check(of, names[1], end, end > start, "start < end").map(drop)
    }

    /// Returns `value` if it is finite and `in_range`, otherwise [`Error::InvalidParameter`]. `of`
    /// is the type or the function whose parameter it is, as users write it.
    pub(crate) fn check(
        of: &'static str,
        name: &'static str,
        value: f64,
        in_range: bool,
        allowed: &'static str,
    ) -> Result<f64, Self> {
        if value.is_finite() && in_range {
            Ok(value)
        } else {
            Err(Self::InvalidParameter {
                of,
                name,
                value,
                allowed,
            })
        }
    }

    /// Checks that a duration is finite and not negative.
    pub(crate) fn check_duration(value: f64) -> Result<(), Self> {
        if value >= 0.0 && value.is_finite() {
            Ok(())
        } else {
            Err(Self::InvalidDuration { value })
        }
    }

    /// An invalid parameter as that of an element of a structure; any other error as it is.
    pub(crate) fn of_element(self, element: Element) -> Self {
        match self {
            Self::InvalidParameter { value, allowed, .. } => Self::BadElement {
                element,
                value,
                allowed,
            },
            other => other,
        }
    }

    /// Checks that a law has a finite value and slope at a speed.
    pub(crate) fn check_friction(speed: f64, value: f64, slope: f64) -> Result<(), Self> {
        let reached = None;
        if !value.is_finite() {
            Err(Self::NonFiniteFriction {
                speed,
                value,
                reached,
            })
        } else if !slope.is_finite() {
            Err(Self::NotAnalytic { speed, reached })
        } else {
            Ok(())
        }
    }

    /// An invalid parameter as that of a point of a table; any other error as it is.
    pub(crate) fn at_point(self, index: usize) -> Self {
        match self {
            Self::InvalidParameter {
                of,
                name,
                value,
                allowed,
            } => Self::BadPoint {
                of,
                index,
                name,
                value,
                allowed,
            },
            other => other,
        }
    }

    /// Adds the place at which the integration stood, if this error is one of the law.
    pub(crate) fn reached_at(self, at: Reached) -> Self {
        match self {
            Self::NonFiniteFriction { speed, value, .. } => Self::NonFiniteFriction {
                speed,
                value,
                reached: Some(at),
            },
            Self::NotAnalytic { speed, .. } => Self::NotAnalytic {
                speed,
                reached: Some(at),
            },
            other => other,
        }
    }
}
