//! Symmetries in time that a motion has and its neighbours on a branch lack: where such a branch is
//! born, a step may leave it for the motions with the symmetry, which lie beside it.

use nalgebra::DVector;

use super::bifurcations::{FoundBifurcation, JUMP};
use super::branch::BifurcationKind;
use super::branch_equations::{Curve, Solved};
use super::branch_predictor::{CurvePoint, LocalCurve};
use super::half_map::{Balance, HalfMap};
use super::period_map::vector;

/// Largest departure of a symmetric motion, in units of its extents.
pub(super) const SYMMETRIC: f64 = 1e-7;

/// What a motion with a symmetry misses of it at most, as a part of what others miss. Near a Hopf
/// point all motions become mirror images of themselves as they shrink, but in proportion.
const VANISHING: f64 = 1e-3;

/// Distance of the neighbour that decides whether a whole piece of the curve is symmetric, as a
/// part of the piece.
const BESIDE: f64 = 0.1;

/// Largest residual of the mirror image of a motion, as a part of what it misses of the symmetry,
/// if the system has the symmetry.
const MIRRORED: f64 = 1e-3;

impl LocalCurve<'_, '_> {
    /// The number of a symmetry that a piece of the curve seems to gain: it leads from motions
    /// without it to motions with it. `lacks` is one of the former, the first point or one before.
    ///
    /// On one smooth piece all motions have a symmetry, or single ones, such as that at a flip of
    /// others, through which the branch passes. A symmetric motion with a symmetric neighbour
    /// therefore lies on another curve, or beyond a change of events.
    pub(super) fn gained_symmetry(
        &self,
        lacks: &Solved,
        (from, to): (&CurvePoint, &CurvePoint),
    ) -> Option<usize> {
        let curve = self.curve;
        let [before, after] = [lacks, &to.solved].map(|motion| departures(curve, motion));
        let vanishes = |missed: f64, before: f64| missed <= SYMMETRIC.min(VANISHING * before);
        let mut pairs = std::iter::zip(&before, &after);
        let gained =
            pairs.position(|(&before, &after)| before > SYMMETRIC && vanishes(after, before))?;
        let along = &to.solved.tangent;
        let back = -BESIDE * (to.distance - from.distance);
        let guess = &to.solved.y + along.component_mul(self.scale) * back;
        let plane = self.across(&to.solved, along, back);
        let beside = curve.solve(&guess, &to.solved, &plane).ok()?;
        vanishes(departures(curve, &beside)[gained], before[gained]).then_some(gained)
    }

    /// The number of the change of events, of those found between two points, at which the motions
    /// of the branch meet their images under a symmetry, and motions with the symmetry. `lacks` is
    /// a motion of the branch, the first of these points or one before.
    pub(super) fn birth(
        &self,
        (from, to): (&CurvePoint, &CurvePoint),
        lacks: &Solved,
        found: &[FoundBifurcation],
    ) -> Option<usize> {
        let changes = [BifurcationKind::Grazing, BifurcationKind::Sequence];
        let is_change = |found: &FoundBifurcation| changes.contains(&found.kind);
        if !found.iter().any(is_change) {
            return None;
        }
        let gained = self.gained_symmetry(lacks, (from, to))?;
        let before = departures(self.curve, lacks);
        let birth = found.iter().position(|found| {
            is_change(found) && departures(self.curve, &found.solved)[gained] <= JUMP
        })?;
        // All systems of the family have the symmetries in time.
        let is_in_time = gained + 1 < before.len();
        let is_mirrored = |missed: f64| missed <= MIRRORED * before[gained];
        (is_in_time || self.mirrored(lacks, to).is_some_and(is_mirrored)).then_some(birth)
    }

    /// The largest departure of a motion from a symmetry that another one has; 0 if there is none.
    pub(super) fn departure(&self, motion: &CurvePoint, other: &CurvePoint) -> f64 {
        let [own, others] = [motion, other].map(|place| departures(self.curve, &place.solved));
        let pairs = std::iter::zip(own, others);
        let pairs = pairs.filter(|(_, other)| *other <= SYMMETRIC);
        pairs.fold(0.0, |largest, (own, _)| own.max(largest))
    }

    /// The residual of the mirror image of a motion, from a symmetric motion near it.
    fn mirrored(&self, motion: &Solved, symmetric: &CurvePoint) -> Option<f64> {
        let curve = self.curve;
        let (Solved { y, begin, .. }, there) = (motion, &symmetric.solved);
        let half_map = HalfMap::of_symmetric(&there.trial.map, there.trial.period)?;
        let balance = |y: &DVector<f64>| {
            let balance = curve.with(y, |form, period| Ok(Balance::of(form, period)));
            balance.ok()
        };
        let half_map = half_map.moved(&balance(&there.y)?, &balance(y)?)?;
        let (half, _) = curve.motion(y, begin, 0.5).ok()?;
        let mut image = y.clone();
        let start = vector(&half_map.applied(half).end, curve.order);
        image.rows_mut(0, curve.order).copy_from(&start);
        Some(curve.trial(&image, begin).ok()?.residual)
    }
}

/// What a motion misses of each symmetry, in units of its largest displacement and velocity: of
/// having a part of its period as its period, and of being its own mirror image half a period
/// later, x(t + T/2) = c − x(t).
pub(super) fn departures(curve: &Curve<'_>, solved: &Solved) -> Vec<f64> {
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
