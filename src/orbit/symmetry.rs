//! Symmetries in time that a motion has and its neighbours on a branch lack: where such a branch is
//! born, a step may leave it for the motions with the symmetry, which lie beside it.

use nalgebra::DVector;

use super::curve::{Curve, Solved};
use super::local_curve::{CurvePoint, LocalCurve};

/// Largest departure of a symmetric motion, in units of its extents.
const SYMMETRIC: f64 = 1e-7;

/// Distance of the neighbour that decides whether a whole piece of the curve is symmetric, as a
/// part of the piece.
const BESIDE: f64 = 0.1;

impl LocalCurve<'_, '_> {
    /// Returns true if a piece of the curve seems to lead from motions without a symmetry to
    /// motions with it.
    ///
    /// On one smooth piece all motions have a symmetry, or all but some single ones, such as that
    /// at a flip of others, through which the branch passes. A symmetric motion with a symmetric
    /// neighbour therefore lies on another curve.
    pub(super) fn gains_symmetry(&self, from: &CurvePoint, to: &CurvePoint) -> bool {
        let curve = self.curve;
        let [before, after] = [from, to].map(|place| departures(curve, &place.solved));
        let mut pairs = std::iter::zip(before, after).enumerate();
        let gained = pairs.find(|(_, (before, after))| *before > SYMMETRIC && *after <= SYMMETRIC);
        let Some((symmetry, _)) = gained else {
            return false;
        };
        let along = &to.solved.tangent;
        let back = -BESIDE * (to.distance - from.distance);
        let guess = &to.solved.y + along.component_mul(self.scale) * back;
        let plane = self.across(&to.solved, along, back);
        let beside = curve.solve(&guess, &to.solved, &plane);
        beside.is_ok_and(|beside| departures(curve, &beside)[symmetry] <= SYMMETRIC)
    }

    /// The largest departure of one side of a change of events from a symmetry that the other side
    /// has; 0 if there is none.
    pub(super) fn departure(&self, low: &CurvePoint, high: &CurvePoint) -> f64 {
        let [low, high] = [low, high].map(|side| departures(self.curve, &side.solved));
        let pairs = std::iter::zip(low, high);
        let gained = pairs.filter(|(low, high)| low.min(*high) <= SYMMETRIC);
        gained.fold(0.0, |largest, (low, high)| low.max(high).max(largest))
    }
}

/// What a motion misses of each symmetry, in units of its largest displacement and velocity: of
/// having a part of its period as its period, and of being its own mirror image half a period
/// later, x(t + T/2) = c − x(t).
fn departures(curve: &Curve<'_>, solved: &Solved) -> Vec<f64> {
    let (map, period, n) = (&solved.trial.map, solved.trial.period, curve.n);
    let units = map.largest(&map.extents());
    let at = |part: f64| {
        let state = map.vector_at(map.begins() + part * period)?;
        Some(DVector::from_fn(2 * n, |i, _| state[i] / units[i / n]))
    };
    let count = if curve.is_free() { 2 } else { curve.periods() };
    let parts = (2..=count).filter(|part| count.is_multiple_of(*part));
    let parts = parts.map(|part| Some(at(1.0 / part as f64)? - at(0.0)?));
    let mirrored = || Some(at(0.0)? - at(0.25)? + at(0.5)? - at(0.75)?);
    let missed = parts.chain([mirrored()]);
    missed
        .map(|missed| missed.map_or(0.0, |it| it.amax()))
        .collect()
}
