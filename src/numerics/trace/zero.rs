//! The zero of a test function on a curve.

use super::super::bracket::Bracket;
use crate::error::Error;

/// Limit of the points tried: down to neighbouring numbers.
const MOST_POINTS: usize = 100;

/// The point, of those tried between two others, at which a test is nearest to 0, with the size of
/// its value there; `None` if there is no number between the two.
///
/// `bracket` holds the distances of the two points and the values of the test there. `between`
/// returns the point at a distance between two others; `is_closed` tells when two points are one.
pub(crate) fn nearest_to_zero<P: Clone>(
    mut bracket: Bracket,
    [mut low, mut high]: [P; 2],
    between: impl Fn(&P, &P, f64) -> Result<P, Error>,
    test: impl Fn(&P) -> f64,
    is_closed: impl Fn(&P, &P) -> bool,
) -> Result<Option<(f64, P)>, Error> {
    let rises = bracket.sign_change().values[1] > 0.0;
    let mut best: Option<(f64, P)> = None;
    for _ in 0..MOST_POINTS {
        let Some(distance) = bracket.next_place() else {
            break;
        };
        let point = between(&low, &high, distance)?;
        let value = test(&point);
        bracket.narrow(distance, value);
        if best.as_ref().is_none_or(|best| value.abs() < best.0) {
            best = Some((value.abs(), point.clone()));
        }
        if (value > 0.0) == rises {
            high = point;
        } else {
            low = point;
        }
        if value == 0.0 || is_closed(&low, &high) {
            break;
        }
    }
    Ok(best)
}
