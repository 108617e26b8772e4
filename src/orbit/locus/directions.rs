//! A curve in both directions from its first point, and the points at which it ends.

use nalgebra::DVector;

use super::CurveOfMotions;
use super::change::{sequence, touch};
use super::found::{LocusEnd, SpecialKind};
use crate::error::Error;
use crate::numerics::trace::{self, Equations, Plane, Point, trace};

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

/// The point just after the last point of a curve at which another change of events happens: there
/// both conditions hold, in a motion with held contacts.
fn meets<'f, E: CurveOfMotions<'f>>(
    curve: &E,
    last: &Point<E::Value>,
) -> Option<(SpecialKind, Point<E::Value>)> {
    /// Limit of steps of the secant method, and the farthest point.
    const MOST_STEPS: usize = 12;
    const FAR: f64 = 1e-4;
    let motions = curve.motions();
    let (trial, begin) = E::motion(&last.value);
    let change = motions.with(motions.parameters(&last.y), |form| {
        let (map, period) = (&trial.map, trial.period);
        let touch = touch(form, map, period, Some(false));
        let touch = touch.filter(|touch| touch.is_other(begin) && touch.size <= FAR);
        let arrival =
            || sequence(form, map, period).filter(|own| own.is_other(begin) && own.size <= FAR);
        Ok(touch.or_else(arrival))
    });
    let change = change.ok()??;
    let kind = curve.kind_with(&change)?;
    let near = curve.holding(&last.value, &change);
    let at = |distance: f64| {
        let (along, scale) = (&last.tangent, &last.scale);
        let guess = &last.y + along.component_mul(scale) * distance;
        let plane = Plane::beyond(&last.y, distance, along.clone(), along, scale);
        let point = trace::solve(curve, &guess, &near, &plane).ok()?;
        let trial = E::motion(&point.value).0;
        let size = motions.with(motions.parameters(&point.y), |form| {
            Ok(change.value(form, &trial.map, begin.holds.len()))
        });
        Some((distance, size.ok()??, point))
    };
    let mut before = at(0.0)?;
    let mut now = at(change.size.clamp(1e-10, FAR))?;
    for _ in 0..MOST_STEPS {
        let next = now.0 - now.1 * (now.0 - before.0) / (now.1 - before.1);
        if !(next.is_finite() && next.abs() <= FAR) || (next - now.0).abs() <= f64::EPSILON {
            break;
        }
        before = std::mem::replace(&mut now, at(next)?);
    }
    (now.1.abs() <= ZERO).then_some((kind, now.2))
}

/// A second condition holds if it is 0 to rounding.
const ZERO: f64 = 1e-12;

/// The curve in both directions from a point.
pub(super) fn both_ways<'f, E: CurveOfMotions<'f>>(
    curve: &E,
    first: &Point<E::Value>,
) -> BothDirections<E::Value> {
    let motions = curve.motions();
    let walk = |first: &Point<E::Value>| {
        motions.begin_again();
        trace(curve, first)
    };
    let end = |half: &trace::Half<E::Value>| {
        let last = half.points.last().unwrap_or(first);
        let parameters = motions.parameters(&last.y);
        match half.end {
            trace::End::Work if motions.watched.is_stopped() => LocusEnd::Stopped { parameters },
            trace::End::Lost(_) | trace::End::Crawls if curve.jumps_behind(last) => LocusEnd::Jump,
            _ => LocusEnd::of(half.end.clone(), parameters),
        }
    };
    let up = walk(first);
    let mut back = first.clone();
    back.tangent.neg_mut();
    let down = if up.end == trace::End::Closed {
        trace::Half {
            points: Vec::new(),
            special: Vec::new(),
            end: trace::End::Closed,
        }
    } else {
        walk(&back)
    };
    let ends = [end(&down), end(&up)];
    let [before, after] = std::array::from_fn(|side| {
        let last = [&down, &up][side].points.last().unwrap_or(first);
        let may_meet = matches!(ends[side], LocusEnd::Jump | LocusEnd::Crawls { .. });
        may_meet.then(|| meets(curve, last))?
    });
    let special = down.special.into_iter().rev().chain(up.special);
    let special =
        special.filter_map(|(test, _, point)| Some((curve.special(test, &point)?, point)));
    let special = before.into_iter().chain(special).chain(after).collect();
    let mut points = down.points;
    points.reverse();
    points.push(first.clone());
    points.extend(up.points);
    (points, special, ends)
}
