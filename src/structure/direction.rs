//! Directions of contacts, springs and force elements, and other lists of numbers by coordinate.

use crate::error::{Element, Error};
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

/// Checks that the coordinates of an element are among the first `count`.
pub(super) fn check_coordinates(
    element: Element,
    mut coordinates: impl Iterator<Item = usize>,
    count: usize,
) -> Result<(), Error> {
    match coordinates.find(|&coordinate| coordinate >= count) {
        None => Ok(()),
        Some(coordinate) => Err(Error::NoSuchCoordinate {
            element,
            coordinate,
            count,
        }),
    }
}

/// Adds a number to that of a coordinate in a list by ascending coordinate, which has no zeros.
/// Returns the sum.
pub(super) fn add_entry(entries: &mut Vec<(usize, f64)>, coordinate: usize, number: f64) -> f64 {
    let place = entries.partition_point(|&(other, _)| other < coordinate);
    let is_new = entries.get(place).is_none_or(|entry| entry.0 != coordinate);
    if is_new {
        entries.insert(place, (coordinate, 0.0));
    }
    let sum = entries[place].1 + number;
    if sum == 0.0 {
        entries.remove(place);
    } else {
        entries[place].1 = sum;
    }
    sum
}
