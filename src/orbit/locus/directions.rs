//! A curve in both directions from its first point, and the points at which it ends.

use nalgebra::{DMatrix, DVector};

use super::change::{Change, sequence, touch};
use super::curve_of_motions::CurveOfMotions;
use super::found::{LocusEnd, SpecialKind};
use crate::error::Error;
use crate::numerics::least_norm::least_norm_by_rows;
use crate::numerics::trace::{self, Equations, Plane, Point};

/// The first point, with the second parameter as given; at a turn of the curve, with the tangent
/// across it.
pub(super) fn first_point<E: Equations>(
    curve: &E,
    y: &DVector<f64>,
    near: &E::Value,
) -> Result<Point<E::Value>, Error> {
    let scale = curve.scale(y, near);
    let [first, second] = curve.parameters();
    let mut along = DVector::from_element(y.len(), 0.001);
    along[first] = 1.0;
    along[second] = 1.0;
    let plane = Plane::with_value(second, y[second], &along, &scale);
    let mut point = trace::solve(curve, y, near, &plane)?;
    point.y[second] = y[second];
    Ok(point)
}

pub(super) type BothDirections<V> = (Vec<Point<V>>, Vec<(SpecialKind, Point<V>)>, [LocusEnd; 2]);

/// The point near the last point of a curve at which another change of events happens: there both
/// conditions hold, in a motion with held contacts. Newton's method solves them together, because
/// the curve can be tangent to that of the change.
fn meets<'f, E: CurveOfMotions<'f>>(
    curve: &E,
    last: &Point<E::Value>,
) -> Option<(SpecialKind, Point<E::Value>)> {
    /// The largest distance from the change, and from the last point, in units of the scales.
    const NEAR: f64 = 1e-4;
    const AWAY: f64 = 1e-3;
    let motions = curve.motions();
    let (trial, begin) = E::motion(&last.value);
    let found = motions.with(motions.parameters(&last.y), |form| {
        let (map, period) = (&trial.map, trial.period);
        let is_near =
            |change: &Change| change.is_other(&begin.holds, &begin.marks) && change.size <= NEAR;
        let touch = touch(form, map, period, Some(false)).filter(is_near);
        let change = touch.or_else(|| sequence(form, map, period).filter(is_near));
        Ok(change.and_then(|change| Some((curve.kind_with(form, trial, &change)?, change))))
    });
    let (kind, change) = found.ok()??;
    let number = begin.holds.len();
    let near = curve.holding(&last.value, &change);
    let begin = E::motion(&near).1;
    let residual = |y: &DVector<f64>| -> Result<DVector<f64>, Error> {
        let mut y = y.clone();
        let value = curve.value(&mut y, &near)?;
        let trial = motions.trial(&y, begin)?;
        let distance = motions.with(motions.parameters(&y), |form| {
            Ok(change.value(form, &trial.map, number))
        });
        let distance = distance?.ok_or_else(|| curve.lost(&y, &value))?;
        let residual = curve.residual(&y, &value);
        let rows = residual.len();
        Ok(residual.insert_row(rows, distance))
    };
    let mut y = common_zero(residual, &last.y, &last.scale, AWAY).ok()??;
    let value = curve.value(&mut y, &near).ok()?;
    let mut point = last.clone();
    point.value = curve.complete(&y, value).ok()?;
    point.y = y;
    Some((kind, point))
}

/// The zero of functions near a guess, at most so far away, by Newton's method with differences.
fn common_zero(
    of: impl Fn(&DVector<f64>) -> Result<DVector<f64>, Error>,
    guess: &DVector<f64>,
    scale: &DVector<f64>,
    away: f64,
) -> Result<Option<DVector<f64>>, Error> {
    /// Limit of steps; the increment for differences; steps below this size are rounding.
    const MOST_STEPS: usize = 16;
    const PART: f64 = 1e-6;
    const ROUNDING: f64 = 1e-12;
    /// Singular values below this part of the largest count as 0.
    const SINGULAR: f64 = 1e-12;
    let mut y = guess.clone();
    let mut before = f64::INFINITY;
    for _ in 0..MOST_STEPS {
        let right = -of(&y)?;
        let mut jacobian = DMatrix::zeros(right.len(), y.len());
        for j in 0..y.len() {
            let [mut low, mut high] = [y.clone(), y.clone()];
            low[j] -= PART * scale[j];
            high[j] += PART * scale[j];
            let apart = (high[j] - low[j]) / scale[j];
            jacobian.set_column(j, &((of(&high)? - of(&low)?) / apart));
        }
        let Some(step) = least_norm_by_rows(jacobian, &right, SINGULAR) else {
            return Ok(None);
        };
        let size = step.amax();
        y += step.component_mul(scale);
        let is_near = (&y - guess).component_div(scale).amax() <= away;
        if !is_near || size <= ROUNDING && size >= 0.1 * before {
            return Ok(is_near.then_some(y));
        }
        before = size;
    }
    Ok(None)
}

/// The curve in both directions from a point.
pub(super) fn both_ways<'f, E: CurveOfMotions<'f>>(
    curve: &E,
    first: &Point<E::Value>,
) -> BothDirections<E::Value> {
    let motions = curve.motions();
    let end = |half: &trace::Half<E::Value>| {
        let last = half.points.last().unwrap_or(first);
        let parameters = motions.parameters(&last.y);
        match half.end {
            trace::End::Work if motions.work.watched.is_stopped() => {
                LocusEnd::Stopped { parameters }
            }
            trace::End::Lost(_) | trace::End::Crawls if curve.jumps_behind(last) => LocusEnd::Jump,
            _ => LocusEnd::of(half.end.clone(), parameters),
        }
    };
    let mut halves = trace::both_ways(curve, first);
    let mut ends = [0, 1].map(|side| end(&halves[side]));
    let [before, after] = std::array::from_fn(|side| {
        let half = &mut halves[side];
        let last = half.points.last().unwrap_or(first);
        let (kind, point) = match ends[side] {
            LocusEnd::Jump | LocusEnd::Crawls { .. } | LocusEnd::Lost { .. } => meets(curve, last)?,
            _ => return None,
        };
        ends[side] = LocusEnd::Jump;
        half.points.push(point.clone());
        Some((kind, point))
    });
    let (points, special) = trace::joined(halves, first);
    let special = special.into_iter();
    let special = special.filter_map(|(test, point)| Some((curve.special(test, &point)?, point)));
    let special = before.into_iter().chain(special).chain(after).collect();
    (points, special, ends)
}
