//! Curves in two parameters: Newton's method across a curve, and pseudo-arclength steps along it
//! inside a rectangle of the parameters.
//!
//! The unknowns y are those of the equations and, among them, the two parameters. The equations may
//! be more than the unknowns less one, if they are consistent: steps of Newton's method solve them
//! by least squares.

mod arclength;
mod chord;
mod zero;

use std::ops::Range;

use nalgebra::{DMatrix, DVector};

pub(crate) use self::arclength::{End, Half, both_ways, joined};
pub(crate) use self::chord::Chord;
pub(crate) use self::zero::nearest_to_zero;
use super::least_norm::least_norm_by_rows;
use crate::error::Error;

/// Equations whose solutions form a curve.
pub(crate) trait Equations {
    /// The result of a computation at one y.
    type Value: Clone;

    /// The places of the two parameters among the unknowns.
    fn parameters(&self) -> [usize; 2];

    /// The ranges of the two parameters.
    fn ranges(&self) -> &[Range<f64>; 2];

    /// Computes the value at y, given the value at a near point of the curve. It may set unknowns
    /// that have to be exact.
    fn value(&self, y: &mut DVector<f64>, near: &Self::Value) -> Result<Self::Value, Error>;

    /// The residuals, each in units of its size.
    fn residual(&self, y: &DVector<f64>, value: &Self::Value) -> DVector<f64>;

    /// The derivatives of the residuals, each column in units of the scale of its unknown.
    fn jacobian(
        &self,
        y: &DVector<f64>,
        value: &Self::Value,
        scale: &DVector<f64>,
    ) -> Result<DMatrix<f64>, Error>;

    /// The largest residual of a solution: rounding, as far as the equations magnify it.
    fn rounding(&self, value: &Self::Value) -> f64;

    /// Completes the value of a solution, or refuses it.
    fn complete(&self, y: &DVector<f64>, value: Self::Value) -> Result<Self::Value, Error>;

    /// The scales of the unknowns.
    fn scale(&self, y: &DVector<f64>, value: &Self::Value) -> DVector<f64>;

    /// Returns true if the equations have the same form at both points. Otherwise the change in
    /// between is enclosed, and the curve continues if it is connected there.
    fn is_like(&self, _: &Self::Value, _: &Self::Value) -> bool {
        true
    }

    /// Other unknowns for the same point, if those in use have become unsuitable.
    fn moved(&self, _: &Point<Self::Value>) -> Option<(DVector<f64>, Self::Value)> {
        None
    }

    /// The size of a solution that can shrink to nothing, with the sign that it has beyond, and the
    /// number of the measure.
    fn size(&self, _: &Self::Value) -> Option<(usize, f64)> {
        None
    }

    /// Functions that change sign at special points of the curve; 0 or NaN has no sign.
    fn tests(&self, point: &Point<Self::Value>) -> Vec<f64>;

    /// Returns true if the kind of the curve ends at a zero of this test.
    fn ends_at(&self, test: usize) -> bool;

    /// Called before the curve is followed in either direction.
    fn begin_again(&self) {}

    /// Returns true if the work allowed is done.
    fn is_at_limit(&self) -> bool;

    /// Limit of points in one direction.
    fn most_points(&self) -> usize {
        2048
    }

    /// Called with each point that is found, except the first.
    fn found(&self, _: &Point<Self::Value>) {}

    /// The error if no solution was found near here.
    fn lost(&self, y: &DVector<f64>, value: &Self::Value) -> Error;
}

/// A point of a curve.
#[derive(Debug, Clone)]
pub(crate) struct Point<V> {
    pub(crate) y: DVector<f64>,
    pub(crate) value: V,
    pub(crate) scale: DVector<f64>,
    /// The unit tangent, in units of the scale.
    pub(crate) tangent: DVector<f64>,
    /// Number of Newton steps.
    steps: usize,
}

/// A plane: normal·(y/scale) = value.
#[derive(Debug)]
pub(crate) struct Plane<'p> {
    pub(crate) scale: &'p DVector<f64>,
    pub(crate) normal: DVector<f64>,
    pub(crate) value: f64,
    /// A direction in which the tangent is to point.
    pub(crate) along: &'p DVector<f64>,
}

impl<'p> Plane<'p> {
    /// The plane with a normal, at a distance from a point.
    pub(crate) fn beyond(
        y: &DVector<f64>,
        distance: f64,
        normal: DVector<f64>,
        along: &'p DVector<f64>,
        scale: &'p DVector<f64>,
    ) -> Self {
        Self {
            value: normal.dot(&y.component_div(scale)) + distance,
            scale,
            normal,
            along,
        }
    }

    /// The plane on which one unknown has a value.
    pub(crate) fn with_value(
        place: usize,
        value: f64,
        along: &'p DVector<f64>,
        scale: &'p DVector<f64>,
    ) -> Self {
        let mut normal = DVector::zeros(scale.len());
        normal[place] = 1.0;
        Self {
            value: value / scale[place],
            scale,
            normal,
            along,
        }
    }

    /// The distance of the plane from a point, along the normal.
    pub(crate) fn missed_by(&self, y: &DVector<f64>) -> f64 {
        self.value - self.normal.dot(&y.component_div(self.scale))
    }
}

/// Limit of Newton steps; three or four are usual.
const MOST_STEPS: usize = 16;

/// The unknowns of a solution are exact to this, in units of their scales.
const EXACT: f64 = 1e-12;

/// The last step to a solution is below this size.
const COARSE: f64 = 1e-5;

/// A step below this size keeps the derivatives of the one before. The tangent is found from them:
/// its error is of this size, and special points are its zeros.
const KEEPS: f64 = 1e-9;

/// Newton's method keeps old derivatives while each step is at most this part of the one before.
const CONTRACTION: f64 = 0.01;

/// Steps below this size are rounding.
const FINE: f64 = 1e-14;

/// Newton's method may leave a range by this part of its width: beyond, the equations may have no
/// meaning.
const BEYOND: f64 = 1.0 / 64.0;

/// Singular values below this part of the largest count as 0.
const SINGULAR: f64 = 1e-12;

/// Checks that ranges of two parameters are finite and not empty.
pub(crate) fn check_ranges(of: &'static str, ranges: &[Range<f64>; 2]) -> Result<(), Error> {
    let names = [
        ["ranges[0].start", "ranges[0].end"],
        ["ranges[1].start", "ranges[1].end"],
    ];
    for (range, names) in std::iter::zip(ranges, names) {
        Error::check_range(of, names, range)?;
    }
    Ok(())
}

/// The value at 0 of the polynomial through points, by Neville's scheme.
pub(crate) fn at_zero(known: &mut [[f64; 2]]) -> f64 {
    for level in 1..known.len() {
        for i in 0..known.len() - level {
            let ([a, low], [b, _]) = (known[i], known[i + level]);
            known[i][1] = (a * known[i + 1][1] - b * low) / (a - b);
        }
    }
    known[0][1]
}

/// The rows of the equations, and one more below.
fn with_row(jacobian: &DMatrix<f64>, row: &DVector<f64>) -> DMatrix<f64> {
    let rows = jacobian.nrows();
    let mut matrix = jacobian.clone().insert_row(rows, 0.0);
    matrix.row_mut(rows).copy_from(&row.transpose());
    matrix
}

/// Returns true if a parameter lies in its range or little outside.
pub(crate) fn is_in_or_near(range: &Range<f64>, parameter: f64) -> bool {
    let margin = BEYOND * (range.end - range.start);
    (range.start - margin..=range.end + margin).contains(&parameter)
}

/// The point of the curve on a plane, near a guess, by Newton's method.
pub(crate) fn solve<E: Equations>(
    equations: &E,
    guess: &DVector<f64>,
    near: &E::Value,
    plane: &Plane<'_>,
) -> Result<Point<E::Value>, Error> {
    let mut y = guess.clone();
    let mut known: Option<DMatrix<f64>> = None;
    let mut before = f64::INFINITY;
    let mut contracts = true;
    let mut steps = 0;
    loop {
        let value = equations.value(&mut y, near)?;
        let residual = equations.residual(&y, &value);
        let jacobian = match &mut known {
            Some(known) if before < KEEPS && contracts => known,
            known => known.insert(equations.jacobian(&y, &value, plane.scale)?),
        };
        let rows = residual.len();
        let mut right = (-&residual).insert_row(rows, 0.0);
        right[rows] = plane.missed_by(&y);
        let Some(change) = least_norm_by_rows(with_row(jacobian, &plane.normal), &right, SINGULAR)
        else {
            return Err(equations.lost(&y, &value));
        };
        let size = change.amax();
        // A residual has the rounding errors of the unknowns, magnified by its derivatives.
        let rounding = equations.rounding(&value);
        let mut rows_and_residuals = std::iter::zip(jacobian.row_iter(), &residual);
        let is_small = size <= COARSE
            && rows_and_residuals
                .all(|(row, residual)| residual.abs() <= rounding.max(EXACT * row.amax()));
        if size <= FINE || (is_small && size >= 0.5 * before) {
            let mut right = DVector::zeros(rows + 1);
            right[rows] = 1.0;
            let tangent = least_norm_by_rows(with_row(jacobian, plane.along), &right, SINGULAR);
            let tangent = tangent.filter(|tangent| tangent.norm() > 0.0);
            let Some(tangent) = tangent.filter(|_| is_small) else {
                return Err(equations.lost(&y, &value));
            };
            return Ok(Point {
                value: equations.complete(&y, value)?,
                y,
                scale: plane.scale.clone(),
                tangent: tangent.normalize(),
                steps,
            });
        }
        steps += 1;
        let falls = steps <= 2 || size <= 2.0 * before;
        if !(size <= 1.0 && falls && steps < MOST_STEPS) {
            return Err(equations.lost(&y, &value));
        }
        contracts = size <= CONTRACTION * before;
        before = size;
        let next = &y + change.component_mul(plane.scale);
        let mut parameters = std::iter::zip(equations.parameters(), equations.ranges());
        if !parameters.all(|(place, range)| is_in_or_near(range, next[place])) {
            return Err(equations.lost(&y, &value));
        }
        y = next;
    }
}
