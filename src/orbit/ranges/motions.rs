//! Comparison of motions, and of branches of them.

use super::super::branch::{Branch, BranchPoint};
use super::super::found::Orbit;
use super::super::oscillator::Oscillator;

/// The largest difference of the periods and extremes of one motion that was found twice.
const ONE: f64 = 1e-6;

/// The largest distance of a motion from a branch to which it belongs, as a part of its extent.
const ON_BRANCH: f64 = 1e-2;

/// The least and the largest displacements of a motion.
fn extremes<S: Oscillator>(orbit: &Orbit<S>) -> Vec<(f64, f64)> {
    let count = S::general(&orbit.state()).displacements.len();
    (0..count).map(|i| orbit.extremes(i)).collect()
}

/// The largest extent of a motion.
pub(super) fn extent<S: Oscillator>(orbit: &Orbit<S>) -> f64 {
    let extents = extremes(orbit).into_iter();
    extents
        .map(|(least, most)| most - least)
        .fold(0.0, f64::max)
}

/// Returns true if a period is another one or a multiple of it, or the other way round: the same
/// motion may be found over several of its periods.
fn fits(period: f64, other: f64, error: f64) -> bool {
    let ratio = (period / other).max(other / period);
    (ratio - ratio.round()).abs() <= error
}

/// Returns true if two motions of one system are the same.
pub(super) fn is_one<S: Oscillator>(a: &Orbit<S>, b: &Orbit<S>) -> bool {
    let most = ONE * extent(a).max(extent(b));
    let pairs = std::iter::zip(extremes(a), extremes(b));
    fits(a.period(), b.period(), ONE)
        && pairs
            .into_iter()
            .all(|(a, b)| (a.0 - b.0).abs() <= most && (a.1 - b.1).abs() <= most)
}

/// Returns true if a motion belongs to a branch: its numbers lie between those of neighbouring
/// points.
pub(super) fn is_on<S: Oscillator>(branch: &Branch<S>, parameter: f64, orbit: &Orbit<S>) -> bool {
    let numbers = |orbit: &Orbit<S>| -> Vec<f64> {
        let extremes = extremes(orbit).into_iter();
        extremes.flat_map(|(least, most)| [least, most]).collect()
    };
    let (own, extent) = (numbers(orbit), extent(orbit));
    branch.points.windows(2).any(|pair| {
        let [a, b] = [0, 1].map(|i: usize| &pair[i] as &BranchPoint<S>);
        let part = (parameter - a.parameter) / (b.parameter - a.parameter);
        (0.0..=1.0).contains(&part)
            && {
                let period = a.orbit.period() * (1.0 - part) + b.orbit.period() * part;
                fits(orbit.period(), period, ON_BRANCH)
            }
            && {
                let pairs = std::iter::zip(numbers(&a.orbit), numbers(&b.orbit));
                pairs.zip(&own).all(|((a, b), own)| {
                    let apart = (a * (1.0 - part) + b * part - own).abs();
                    apart <= ON_BRANCH * extent + 0.1 * (a - b).abs()
                })
            }
    })
}

/// Returns true if most of some motions of a branch belong to another one.
pub(super) fn is_same<S: Oscillator>(known: &Branch<S>, branch: &Branch<S>) -> bool {
    const TRIED: usize = 9;
    let count = branch.points.len();
    let tried = (0..TRIED).filter_map(|i| branch.points.get(count * (i + 1) / (TRIED + 1)));
    let same = tried.filter(|point| is_on(known, point.parameter, &point.orbit));
    2 * same.count() > TRIED
}
