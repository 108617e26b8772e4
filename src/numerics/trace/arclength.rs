//! Pseudo-arclength steps along a curve inside a rectangle of two parameters, its special points
//! and its ends.

use nalgebra::DVector;

use super::super::bracket::Bracket;
use super::chord::Chord;
use super::zero::nearest_to_zero;
use super::{Equations, Plane, Point, at_zero, solve};
use crate::error::Error;
use crate::numerics::sort::sort_by;

/// A curve in one direction from its first point, which is not repeated.
#[derive(Debug)]
pub(crate) struct Half<V> {
    pub(crate) points: Vec<Point<V>>,
    /// The special points, each with its test and the number of the point before it; the first
    /// point of the curve is number 0.
    pub(crate) special: Vec<(usize, usize, Point<V>)>,
    pub(crate) end: End,
}

impl<V> Half<V> {
    fn empty(end: End) -> Self {
        Self {
            points: Vec::new(),
            special: Vec::new(),
            end,
        }
    }
}

/// The reason why a curve ends.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum End {
    /// The curve reaches a side of the rectangle.
    Ranges,
    /// The curve returns to its first point.
    Closed,
    /// The curve ends at a special point.
    Special,
    /// The solution shrinks to nothing at these parameters.
    Vanishes([f64; 2]),
    /// The work allowed is done.
    Work,
    /// Steps become ever shorter.
    Crawls,
    /// Newton's method does not converge, however short the step.
    Lost(Error),
}

/// The longest and the shortest step, in units of the scales.
const LONGEST: f64 = 1.0 / 64.0;

const SHORTEST: f64 = 1e-9;

/// A curve crawls if the sum of this number of steps is at most this length.
const MANY_POINTS: usize = 128;

const CRAWL: f64 = 1e-3;

/// The least cosine of the angle between the tangents at neighbouring points.
const STRAIGHT: f64 = 0.97;

/// More Newton steps than this keep the next step along the curve from growing.
const MANY_STEPS: usize = 5;

/// A change of the form of the equations is enclosed to this width, and the curve is connected if
/// the points on both sides are at most this far apart.
const GAP: f64 = 1e-9;

const JUMP: f64 = 1e-4;

/// A test at a special point is below this part of its values on both sides.
const ZERO: f64 = 1e-6;

/// The points of a curve near one of them, by planes across the tangent there.
struct LocalCurve<'v, E: Equations> {
    equations: &'v E,
    base: &'v Point<E::Value>,
}

/// A point, and its distance along the tangent of the last one.
struct TracePoint<V> {
    distance: f64,
    point: Point<V>,
}

impl<V: Clone> Clone for TracePoint<V> {
    fn clone(&self) -> Self {
        let point = self.point.clone();
        Self { point, ..*self }
    }
}

impl<E: Equations> LocalCurve<'_, E> {
    fn here(&self) -> TracePoint<E::Value> {
        TracePoint {
            distance: 0.0,
            point: self.base.clone(),
        }
    }

    fn at(
        &self,
        distance: f64,
        guess: &DVector<f64>,
        near: &E::Value,
    ) -> Result<TracePoint<E::Value>, Error> {
        let base = self.base;
        let (along, scale) = (&base.tangent, &base.scale);
        let plane = Plane::beyond(&base.y, distance, along.clone(), along, scale);
        let point = solve(self.equations, guess, near, &plane)?;
        Ok(TracePoint { distance, point })
    }

    fn between(
        &self,
        low: &TracePoint<E::Value>,
        high: &TracePoint<E::Value>,
        distance: f64,
    ) -> Result<TracePoint<E::Value>, Error> {
        let part = (distance - low.distance) / (high.distance - low.distance);
        let guess = &low.point.y * (1.0 - part) + &high.point.y * part;
        let near = if part < 0.5 { low } else { high };
        self.at(distance, &guess, &near.point.value)
    }

    /// The point at which a parameter has a value.
    fn with_parameter(
        &self,
        which: usize,
        value: f64,
        guess: &DVector<f64>,
        near: &E::Value,
    ) -> Result<TracePoint<E::Value>, Error> {
        let (base, place) = (self.base, self.equations.parameters()[which]);
        let mut guess = guess.clone();
        guess[place] = value;
        let plane = Plane::with_value(place, value, &base.tangent, &base.scale);
        let mut point = solve(self.equations, &guess, near, &plane)?;
        point.y[place] = value;
        let moved = (&point.y - &base.y).component_div(&base.scale);
        Ok(TracePoint {
            distance: base.tangent.dot(&moved),
            point,
        })
    }

    /// The first parameter that is outside its range on the way to y, the side that it passes, and
    /// the part of the way up to there.
    fn outside(&self, y: &DVector<f64>) -> Option<(usize, f64, f64)> {
        let (places, ranges) = (self.equations.parameters(), self.equations.ranges());
        let passed = [0, 1].into_iter().filter_map(|which| {
            let (from, to) = (self.base.y[places[which]], y[places[which]]);
            let side = to.clamp(ranges[which].start, ranges[which].end);
            (side != to).then(|| (which, side, (side - from) / (to - from)))
        });
        passed.min_by(|a, b| a.2.total_cmp(&b.2))
    }

    /// The next point at about a distance, and whether it lies on a side of the rectangle.
    fn next(&self, length: f64) -> Result<(TracePoint<E::Value>, bool), Error> {
        let base = self.base;
        let guess = &base.y + base.tangent.component_mul(&base.scale) * length;
        let mut place = None;
        let mut outside = self.outside(&guess);
        if outside.is_none() {
            let found = self.at(length, &guess, &base.value)?;
            outside = self.outside(&found.point.y);
            place = Some(found);
        }
        // Both, at a corner.
        for _ in 0..2 {
            let Some((which, side, part)) = outside else {
                break;
            };
            let (guess, near) = match &place {
                Some(place) => (place.point.y.clone(), &place.point.value),
                None => (&base.y + (&guess - &base.y) * part, &base.value),
            };
            let found = self.with_parameter(which, side, &guess, near)?;
            outside = self.outside(&found.point.y);
            place = Some(found);
        }
        let place = place.ok_or_else(|| self.equations.lost(&base.y, &base.value))?;
        let (y, places) = (&place.point.y, self.equations.parameters());
        let ranges = self.equations.ranges().iter();
        let is_last = std::iter::zip(places, ranges)
            .any(|(i, range)| y[i] <= range.start || y[i] >= range.end);
        let moved = (y - &base.y).component_div(&base.scale);
        let sideways = &moved - &base.tangent * place.distance;
        let straight = place.point.tangent.dot(&base.tangent) >= STRAIGHT
            && sideways.norm() <= 0.5 * place.distance;
        if straight && place.distance > 0.0 && outside.is_none() {
            Ok((place, is_last))
        } else {
            Err(self.equations.lost(y, &place.point.value))
        }
    }

    /// Encloses a change of the form of the equations; an error unless the curve is connected
    /// there.
    fn connect(
        &self,
        mut low: TracePoint<E::Value>,
        mut high: TracePoint<E::Value>,
    ) -> Result<(), Error> {
        let first = low.point.value.clone();
        while high.distance - low.distance > GAP {
            let middle = 0.5 * (low.distance + high.distance);
            let place = self.between(&low, &high, middle)?;
            if self.equations.is_like(&first, &place.point.value) {
                low = place;
            } else {
                high = place;
            }
        }
        let apart = (&low.point.y - &high.point.y).component_div(&self.base.scale);
        if apart.amax() <= JUMP {
            Ok(())
        } else {
            Err(self.equations.lost(&high.point.y, &high.point.value))
        }
    }

    /// The zero of a test between two places; `None` if it changes its sign without one.
    fn sign_change(
        &self,
        from: &TracePoint<E::Value>,
        to: &TracePoint<E::Value>,
        test: usize,
        values: [f64; 2],
    ) -> Result<Option<TracePoint<E::Value>>, Error> {
        let nearest = nearest_to_zero(
            Bracket::new((from.distance, values[0]), (to.distance, values[1])),
            [from.clone(), to.clone()],
            |low, high, distance| self.between(low, high, distance),
            |place| self.equations.tests(&place.point)[test],
            |low, high| {
                let apart = (&low.point.y - &high.point.y).component_div(&self.base.scale);
                apart.amax() <= f64::EPSILON || high.distance - low.distance <= f64::EPSILON
            },
        )?;
        let size = values[0].abs().max(values[1].abs());
        let zero = nearest.filter(|(value, _)| *value <= ZERO * size);
        Ok(zero.map(|(_, place)| place))
    }
}

/// The outcome of a step: the next point, whether it is the last one, and the special points on the
/// way; or the parameters at which the solution vanishes.
enum Step<V> {
    Next(TracePoint<V>, bool, Vec<Special<V>>),
    Vanishes([f64; 2]),
}

/// The curve from a point against its tangent, and along it; if it is closed, along it only.
pub(crate) fn both_ways<E: Equations>(
    equations: &E,
    first: &Point<E::Value>,
) -> [Half<E::Value>; 2] {
    let up = trace(equations, first);
    let mut back = first.clone();
    back.tangent.neg_mut();
    let down = match up.end {
        End::Closed => Half::empty(End::Closed),
        _ => trace(equations, &back),
    };
    [down, up]
}

/// The points of a curve, and its special points, each with its test.
type Points<V> = (Vec<Point<V>>, Vec<(usize, Point<V>)>);

/// Joins both halves of a curve, in order from one end to the other.
pub(crate) fn joined<V: Clone>([down, up]: [Half<V>; 2], first: &Point<V>) -> Points<V> {
    let points = down.points.into_iter().rev();
    let points = points.chain([first.clone()]).chain(up.points);
    let special = down.special.into_iter().rev().chain(up.special);
    let special = special.map(|(test, _, point)| (test, point));
    (points.collect(), special.collect())
}

/// Follows a curve from a point in the direction of its tangent.
fn trace<E: Equations>(equations: &E, first: &Point<E::Value>) -> Half<E::Value> {
    equations.begin_again();
    let mut half = Half::empty(End::Work);
    let mut base = first.clone();
    let mut signs = signs_of(equations, first);
    let mut length = 0.25 * LONGEST;
    let mut lengths: Vec<f64> = Vec::new();
    if leaves(equations, first) {
        half.end = End::Ranges;
        return half;
    }
    while half.points.len() < equations.most_points() && !equations.is_at_limit() {
        let view = LocalCurve {
            equations,
            base: &base,
        };
        let (place, is_last, special) = loop {
            let found = view.next(length).and_then(|(place, is_last)| {
                if turns(equations, &base, &place.point) {
                    let vanishes = vanishes(equations, first, &half.points);
                    let lost = || equations.lost(&base.y, &base.value);
                    return Ok(Step::Vanishes(vanishes.ok_or_else(lost)?));
                }
                if !equations.is_like(&base.value, &place.point.value) {
                    view.connect(view.here(), place.clone())?;
                }
                let special = special_points(&view, &place, &signs)?;
                Ok(Step::Next(place, is_last, special))
            });
            match found {
                Ok(Step::Next(place, is_last, special)) => break (place, is_last, special),
                Ok(Step::Vanishes(parameters)) => {
                    half.end = End::Vanishes(parameters);
                    return half;
                }
                Err(_) if equations.is_at_limit() => return half,
                Err(error) if length <= SHORTEST => {
                    half.end = End::Lost(error);
                    return half;
                }
                Err(_) => length *= 0.5,
            }
        };
        if place.point.steps < MANY_STEPS {
            length = (1.5 * length).min(LONGEST);
        }
        for (test, place) in special {
            half.special
                .push((test, half.points.len(), place.point.clone()));
            if equations.ends_at(test) {
                half.points.push(place.point);
                half.end = End::Special;
                return half;
            }
        }
        for (sign, now) in signs.iter_mut().zip(signs_of(equations, &place.point)) {
            if now != 0.0 {
                *sign = now;
            }
        }
        if half.points.len() >= 3 {
            let way = Chord::new([&base.y, &place.point.y], &base.scale);
            let direction = first.tangent.component_mul(&first.scale);
            if way.passes(&first.y, &direction.component_div(&base.scale)) {
                half.end = End::Closed;
                return half;
            }
        }
        lengths.push(place.distance);
        half.points.push(place.point.clone());
        equations.found(&place.point);
        if is_last {
            half.end = End::Ranges;
            return half;
        }
        let last = lengths.len().checked_sub(MANY_POINTS);
        if last.is_some_and(|first| lengths[first..].iter().sum::<f64>() < CRAWL) {
            half.end = End::Crawls;
            return half;
        }
        base = place.point;
        let scale = equations.scale(&base.y, &base.value);
        base.tangent.component_mul_assign(&base.scale);
        base.tangent.component_div_assign(&scale);
        base.tangent.normalize_mut();
        base.scale = scale;
        if let Some(moved) = moved(equations, &base) {
            base = moved;
        }
    }
    half
}

/// Expresses a point in other unknowns, if these are needed. Only the parameters still determine
/// the direction.
fn moved<E: Equations>(equations: &E, point: &Point<E::Value>) -> Option<Point<E::Value>> {
    let (y, value) = equations.moved(point)?;
    let scale = equations.scale(&y, &value);
    let mut along = DVector::zeros(y.len());
    for i in equations.parameters() {
        along[i] = point.tangent[i] * point.scale[i] / scale[i];
    }
    let along = along.try_normalize(0.0)?;
    let plane = Plane::beyond(&y, 0.0, along.clone(), &along, &scale);
    solve(equations, &y, &value, &plane).ok()
}

/// A test and the place of its zero.
type Special<V> = (usize, TracePoint<V>);

/// The special points between the last point and the next one, in order.
fn special_points<E: Equations>(
    view: &LocalCurve<'_, E>,
    to: &TracePoint<E::Value>,
    before: &[f64],
) -> Result<Vec<Special<E::Value>>, Error> {
    let from = view.here();
    let [begin, end] = [&from, to].map(|place| view.equations.tests(&place.point));
    let mut found = Vec::new();
    for (test, sign) in before.iter().enumerate() {
        let now = end[test];
        if sign * now >= 0.0 || now.is_nan() {
            continue;
        }
        // A value without a sign at the last point is a zero there.
        let low = if begin[test] * sign > 0.0 {
            begin[test]
        } else {
            *sign * f64::MIN_POSITIVE
        };
        if let Some(place) = view.sign_change(&from, to, test, [low, now])? {
            found.push((test, place));
        }
    }
    sort_by(&mut found, |special| special.1.distance);
    Ok(found)
}

/// Returns true if a solution has shrunk to nothing between two points.
fn turns<E: Equations>(equations: &E, from: &Point<E::Value>, to: &Point<E::Value>) -> bool {
    match (equations.size(&from.value), equations.size(&to.value)) {
        (Some((a, from)), Some((b, to))) => a == b && from * to <= 0.0,
        _ => false,
    }
}

/// The parameters after the last point at which the solution shrinks to nothing. They are even
/// functions of its size, extrapolated by polynomials through earlier points. Rounding errors grow
/// as the solution shrinks; truncation errors grow with its size. The two polynomials that agree
/// best are used.
fn vanishes<E: Equations>(
    equations: &E,
    first: &Point<E::Value>,
    points: &[Point<E::Value>],
) -> Option<[f64; 2]> {
    /// Points of one polynomial, and the least ratio of neighbouring sizes.
    const POINTS: usize = 6;
    const RATIO: f64 = 1.3;
    let mut measure = None;
    let mut known: [Vec<[f64; 2]>; 2] = [Vec::new(), Vec::new()];
    for point in points.iter().rev().chain([first]) {
        let (which, size) = equations.size(&point.value)?;
        if *measure.get_or_insert(which) != which {
            break;
        }
        let last = known[0].last().map_or(0.0, |last: &[f64; 2]| last[0]);
        if size.powi(2) >= RATIO.powi(2) * last {
            for (known, i) in known.iter_mut().zip(equations.parameters()) {
                known.push([size.powi(2), point.y[i]]);
            }
        }
    }
    let values = |known: &[[f64; 2]]| -> Vec<f64> {
        let windows = known.windows(POINTS);
        windows
            .map(|window| at_zero(&mut window.to_vec()))
            .collect()
    };
    let [a, b] = known.map(|known| values(&known));
    let apart = |i: usize| {
        let [x, y] = [&a, &b].map(|values| values[i + 1] - values[i]);
        let [p, q] = equations.parameters().map(|place| first.scale[place]);
        (x / p).hypot(y / q)
    };
    let best = (0..a.len().checked_sub(1)?).min_by(|&i, &j| apart(i).total_cmp(&apart(j)))?;
    Some([a[best], b[best]])
}

/// The signs of the tests; 0 for one without.
fn signs_of<E: Equations>(equations: &E, point: &Point<E::Value>) -> Vec<f64> {
    let sign = |value: f64| {
        if value == 0.0 || value.is_nan() {
            0.0
        } else {
            value.signum()
        }
    };
    equations.tests(point).into_iter().map(sign).collect()
}

/// Returns true if the tangent at a point leads out of the rectangle.
fn leaves<E: Equations>(equations: &E, point: &Point<E::Value>) -> bool {
    let parameters = equations.parameters().into_iter();
    parameters.zip(equations.ranges()).any(|(i, range)| {
        let (y, along) = (point.y[i], point.tangent[i]);
        (y <= range.start && along < 0.0) || (y >= range.end && along > 0.0)
    })
}
