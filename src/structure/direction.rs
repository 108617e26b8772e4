//! Directions of contacts, springs and force elements.

use crate::error::Error;
use crate::numerics::sort::sort_by;

/// The first coordinate of a direction, and its entries by ascending coordinate, without zeros.
pub(super) fn checked_direction(
    given: &[(usize, f64)],
) -> Result<(usize, Vec<(usize, f64)>), Error> {
    let mut direction = given.to_vec();
    sort_by(&mut direction, |&(j, _)| j as f64);
    let is_named_twice = direction.windows(2).any(|pair| pair[0].0 == pair[1].0);
    let is_finite = direction.iter().all(|(_, b)| b.is_finite());
    direction.retain(|&(_, b)| b != 0.0);
    match (
        given.first(),
        direction.is_empty() || is_named_twice || !is_finite,
    ) {
        (Some(&(coordinate, _)), false) => Ok((coordinate, direction)),
        _ => Err(Error::BadDirection {
            direction: given.to_vec(),
        }),
    }
}
