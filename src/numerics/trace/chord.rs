//! The chord between two points of a curve, and other points beside it.

use nalgebra::DVector;

use super::Plane;

/// The chord between two points, in units of scales.
pub(crate) struct Chord<'p> {
    ends: [&'p DVector<f64>; 2],
    scale: &'p DVector<f64>,
    /// The difference of the ends, in units of the scales.
    pub(crate) step: DVector<f64>,
    /// Its direction.
    along: DVector<f64>,
}

impl<'p> Chord<'p> {
    pub(crate) fn new(ends: [&'p DVector<f64>; 2], scale: &'p DVector<f64>) -> Self {
        let step = (ends[1] - ends[0]).component_div(scale);
        Self {
            ends,
            scale,
            along: step.normalize(),
            step,
        }
    }

    /// The place of a point along the chord, from 0 to 1, and its distance from there, both as
    /// parts of the chord.
    pub(crate) fn place(&self, y: &DVector<f64>) -> (f64, f64) {
        let there = (y - self.ends[0]).component_div(self.scale);
        let length = self.step.norm_squared();
        let part = self.step.dot(&there) / length;
        let beside = &self.step * part - there;
        (part, (beside.norm_squared() / length).sqrt())
    }

    /// The point of the chord at a part of it.
    pub(crate) fn at(&self, part: f64) -> DVector<f64> {
        self.ends[0] * (1.0 - part) + self.ends[1] * part
    }

    /// The plane across the chord through a point.
    pub(crate) fn plane_through(&self, y: &DVector<f64>) -> Plane<'_> {
        Plane::beyond(y, 0.0, self.along.clone(), &self.along, self.scale)
    }

    /// Returns true if the chord passes a point within a tenth of its length, in a direction.
    pub(crate) fn passes(&self, y: &DVector<f64>, direction: &DVector<f64>) -> bool {
        let (part, beside) = self.place(y);
        (0.0..=1.0).contains(&part) && beside <= 0.1 && direction.dot(&self.step) > 0.0
    }
}
