//! The curve near one of its points, and the points on it.

use nalgebra::DVector;

use super::branch_equations::{Curve, Solved};
use crate::error::Error;
use crate::numerics::trace::Plane;

/// A point of the curve, and its distance along the tangent of the last one.
#[derive(Clone)]
pub(super) struct CurvePoint {
    pub(super) distance: f64,
    pub(super) solved: Solved,
}

/// The curve near its last point, as a function of the distance along the tangent at this point.
pub(super) struct LocalCurve<'v, 'f> {
    pub(super) curve: &'v Curve<'f>,
    pub(super) base: &'v Solved,
    pub(super) scale: &'v DVector<f64>,
}

impl LocalCurve<'_, '_> {
    /// The point of the curve on the plane at a distance.
    pub(super) fn at(
        &self,
        distance: f64,
        guess: &DVector<f64>,
        near: &Solved,
    ) -> Result<CurvePoint, Error> {
        let plane = self.across(self.base, &self.base.tangent, distance);
        let solved = self.curve.solve(guess, near, &plane)?;
        Ok(CurvePoint { distance, solved })
    }

    /// The plane across a direction, at a distance from a point.
    pub(super) fn across<'a>(
        &'a self,
        from: &Solved,
        along: &'a DVector<f64>,
        distance: f64,
    ) -> Plane<'a> {
        Plane::beyond(&from.y, distance, along.clone(), along, self.scale)
    }

    /// The point at which the parameter has a value.
    pub(super) fn with_parameter(
        &self,
        parameter: f64,
        guess: &DVector<f64>,
        near: &Solved,
    ) -> Result<CurvePoint, Error> {
        let last = self.curve.unknowns() - 1;
        let mut guess = guess.clone();
        guess[last] = parameter;
        let plane = Plane::with_value(last, parameter, &self.base.tangent, self.scale);
        let mut solved = self.curve.solve(&guess, near, &plane)?;
        solved.y[last] = parameter;
        let moved = self.scaled(&solved) - self.scaled(self.base);
        Ok(CurvePoint {
            distance: self.base.tangent.dot(&moved),
            solved,
        })
    }

    pub(super) fn scaled(&self, solved: &Solved) -> DVector<f64> {
        solved.y.component_div(self.scale)
    }

    /// The distance between two points, in units of the scales.
    pub(super) fn apart(&self, a: &CurvePoint, b: &CurvePoint) -> f64 {
        (self.scaled(&a.solved) - self.scaled(&b.solved)).amax()
    }

    /// The point at a distance between two others.
    pub(super) fn between(
        &self,
        low: &CurvePoint,
        high: &CurvePoint,
        distance: f64,
    ) -> Result<CurvePoint, Error> {
        let part = (distance - low.distance) / (high.distance - low.distance);
        let guess = &low.solved.y * (1.0 - part) + &high.solved.y * part;
        let near = if part < 0.5 { low } else { high };
        let plane = self.across(self.base, &self.base.tangent, distance);
        // Of linear interpolation.
        let error = self.apart(low, high).powi(2);
        let solved = self.curve.newton(&guess, error, &near.solved, &plane)?;
        Ok(CurvePoint { distance, solved })
    }
}
