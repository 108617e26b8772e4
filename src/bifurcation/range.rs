//! Ranges of belt velocities, and a system at one belt velocity.

use std::ops::Range;

use crate::belt::{Forward, MassOnBelt};
use crate::error::Error;
use crate::friction::FrictionLaw;

/// The part of a range of belt velocities that lies above 0.
pub(super) fn positive(range: Range<f64>) -> Result<Range<f64>, Error> {
    Error::check("range.start", range.start, true, "start < end")?;
    let valid = range.end > range.start && range.end > 0.0;
    Error::check("range.end", range.end, valid, "start < end and end > 0")?;
    Ok(range.start.max(0.0)..range.end)
}

/// Applies `find` to the system with the belt velocity v_b; `None` on a belt that stands still. An
/// error is given v_b.
pub(super) fn moving_at<'s, L: FrictionLaw, T>(
    system: MassOnBelt<&'s L>,
    v_b: f64,
    find: impl FnOnce(Forward<'s, L>) -> Result<T, Error>,
) -> Result<Option<T>, Error> {
    if v_b == 0.0 {
        return Ok(None);
    }
    let at_velocity = system.with_belt_velocity(v_b).map(Forward::of);
    at_velocity
        .and_then(|system| system.map(find).transpose())
        .map_err(|error| error.at("belt_velocity", v_b))
}
