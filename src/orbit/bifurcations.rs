//! Bifurcations between two points of a branch.

use num_complex::Complex;

use super::branch::BifurcationKind;
use super::branch_equations::{FINE, Solved};
use super::branch_predictor::{CurvePoint, LocalCurve};
use super::event_change_bracket::Sides;
use super::multipliers::tests;
use super::period_map::CLOSED;
use crate::error::Error;
use crate::numerics::bracket::Bracket;
use crate::numerics::sort::sort_by;
use crate::numerics::trace::nearest_to_zero;

/// A bifurcation.
pub(super) struct FoundBifurcation {
    pub(super) distance: f64,
    pub(super) kind: BifurcationKind,
    pub(super) solved: Solved,
}

/// The bifurcations between two points.
pub(super) struct Changes {
    /// The bifurcations, in order.
    pub(super) found: Vec<FoundBifurcation>,
    /// The distance of the last change of events, if there is one.
    pub(super) last_change: Option<f64>,
}

/// Limit of changes of the event sequence within one step.
const MOST_CHANGES: usize = 16;

/// Halvings of an interval of the curve: down to neighbouring numbers.
const MOST_HALVINGS: usize = 100;

/// Largest distance, in units of the scales, of the motions on the two sides of a change of the
/// event sequence when the interval between them is closed.
pub(super) const JUMP: f64 = 1e-4;

/// The two sides of a change come nearer to each other at least like the square root of the
/// interval between them. The curve jumps if their distance has not fallen to this part while the
/// interval narrowed by this factor.
const NEARER: f64 = 0.5;
const NARROWER: f64 = 64.0;

/// An interval that could not be closed counts as closed below this width. Where slips to and fro
/// began at a distance d before, a multiplier is 1 − O(d): below √ε rounding decides the position
/// of the contact, and no motion is found.
const GAP: f64 = 1e-6;

/// Factors of a test function below this are rounding: it has no sign.
const ROUNDING: f64 = 1e-9;

/// Largest distance of a multiplier from its value at the bifurcation.
const MULTIPLIER: f64 = 1e-6;

/// Test functions, which change sign at a fold (two: the direction of the parameter, and the
/// product of all 1 − μ), a flip (the product of all 1 + μ) and a Neimark-Sacker bifurcation (that
/// of all 1 − μμ').
pub(super) type Signs = [f64; 4];

/// The factor by which the motion at a place magnifies perturbations.
fn growth(place: &CurvePoint) -> f64 {
    place.solved.trial.map.growth()
}

/// Returns true if two places differ only by rounding errors of the motions. In a symmetric motion,
/// or with equal masses, several events change at one place.
fn is_same(low: &CurvePoint, high: &CurvePoint) -> bool {
    high.distance - low.distance <= CLOSED * growth(low).max(growth(high))
}

/// The change of events between its two sides, with the motion on the smoother side; `None` if the
/// events of both sides are equal.
fn change(low: &CurvePoint, high: &CurvePoint) -> Option<FoundBifurcation> {
    let [before, after] = [low, high].map(|place| &place.solved.sequence);
    if before.is_like(after) {
        return None;
    }
    let kind = before.change(after);
    let smoother = if growth(high) < growth(low) {
        high
    } else {
        low
    };
    Some(FoundBifurcation {
        distance: smoother.distance,
        kind,
        solved: smoother.solved.clone(),
    })
}

impl LocalCurve<'_, '_> {
    /// The bifurcations between two points. `signs` are the last ones known.
    ///
    /// Returns an error if no connection between the two points is found.
    pub(super) fn changes(
        &self,
        first: &CurvePoint,
        last: &CurvePoint,
        signs: &mut Signs,
    ) -> Result<Changes, Error> {
        let mut found = Vec::new();
        let mut from = first.clone();
        // The two sides of the last change of events, which may be the same change as the next.
        let mut sides: Option<(CurvePoint, CurvePoint)> = None;
        let mut last_change = None;
        for _ in 0..MOST_CHANGES {
            if from.solved.sequence.is_like(&last.solved.sequence) {
                found.extend(sides.and_then(|(low, high)| change(&low, &high)));
                self.smooth(&from, last, signs, &mut found)?;
                return Ok(Changes { found, last_change });
            }
            let (low, high) = self.change_of_events(&from, last)?;
            sides = match sides.take() {
                Some((first, second)) if is_same(&second, &low) => Some((first, high.clone())),
                sides => {
                    found.extend(sides.and_then(|(low, high)| change(&low, &high)));
                    self.smooth(&from, &low, signs, &mut found)?;
                    Some((low, high.clone()))
                }
            };
            *signs = [0.0; 4];
            last_change = Some(high.distance);
            from = high;
        }
        Err(self.lost(last))
    }

    fn lost(&self, place: &CurvePoint) -> Error {
        self.curve.lost(&place.solved.y, &place.solved.trial)
    }

    /// The two sides of the first change of the event sequence between two points.
    fn change_of_events(
        &self,
        first: &CurvePoint,
        last: &CurvePoint,
    ) -> Result<(CurvePoint, CurvePoint), Error> {
        /// Parts of the interval to try if nothing is found at the first place.
        const PARTS: [f64; 5] = [0.5, 0.25, 0.75, 0.0625, 0.9375];
        let mut sides = Sides::new(first, last);
        let mut wide = (last.distance - first.distance, self.apart(first, last));
        for _ in 0..MOST_HALVINGS {
            let (low, high) = (sides.low.distance, sides.high.distance);
            let width = high - low;
            if width <= FINE {
                break;
            }
            let parts = PARTS.iter().map(|part| low + part * width);
            let places: Vec<f64> = sides.next_place().into_iter().chain(parts).collect();
            let mut lost = None;
            let mut tried = places.into_iter().filter_map(|distance| {
                let inside = low < distance && distance < high;
                match inside.then(|| self.between(&sides.low, &sides.high, distance))? {
                    Ok(place) => Some(place),
                    Err(error) => {
                        lost = Some(error);
                        None
                    }
                }
            });
            let Some(place) = tried.next() else {
                match lost {
                    Some(error) if width > GAP => return Err(error),
                    _ => break,
                }
            };
            let is_low = place.solved.sequence.is_like(&first.solved.sequence);
            sides.narrow(place, is_low);
            let width = sides.high.distance - sides.low.distance;
            if width <= wide.0 / NARROWER {
                let apart = self.apart(&sides.low, &sides.high);
                if apart > JUMP.max(NEARER * wide.1) {
                    return Err(self.lost(&sides.high));
                }
                wide = (width, apart);
            }
        }
        let Sides { low, high, .. } = sides;
        let departure = self.departure(&low, &high).max(self.departure(&high, &low));
        if self.apart(&low, &high).max(departure) > JUMP || self.pass_by(&low, &high) {
            return Err(self.lost(&high));
        }
        Ok((low, high))
    }

    /// Returns true if two close points lie on pieces of the curve that do not meet between them,
    /// because one of the pieces continues beyond the other point.
    ///
    /// If a curve turns back at a change of the events, both of its pieces cross every plane before
    /// the corner, and Newton's method can converge to the wrong piece.
    fn pass_by(&self, low: &CurvePoint, high: &CurvePoint) -> bool {
        /// Part of the distance between the points by which a piece is followed.
        const BEYOND: f64 = 0.01;
        let rounding = CLOSED * growth(low).max(growth(high));
        let apart = self.apart(low, high);
        if apart <= rounding {
            return false;
        }
        let reach = (2.0 * (high.distance - low.distance)).max(BEYOND * apart);
        let goes_on = |from: &CurvePoint, reach: f64| {
            let along = reach / self.base.tangent.dot(&from.solved.tangent);
            let guess = &from.solved.y + from.solved.tangent.component_mul(self.scale) * along;
            let beyond = self.at(from.distance + reach, &guess, &from.solved);
            beyond.is_ok_and(|beyond| {
                beyond.solved.sequence.is_like(&from.solved.sequence)
                    && self.apart(&beyond, from) <= 0.5 * apart
            })
        };
        let reach = reach.max(rounding);
        goes_on(low, reach) || goes_on(high, -reach)
    }

    /// Folds, flips and tori between two points with the same events.
    fn smooth(
        &self,
        from: &CurvePoint,
        to: &CurvePoint,
        signs: &mut Signs,
        found: &mut Vec<FoundBifurcation>,
    ) -> Result<(), Error> {
        if self.gained_symmetry(&from.solved, (from, to)).is_some() {
            return Err(self.lost(to));
        }
        let [begin, end] = [from, to].map(|place| self.tests(&place.solved, ROUNDING));
        let first = found.len();
        for (test, sign) in signs.iter_mut().enumerate() {
            // A test function without a sign keeps its last sign. Two values without a sign in
            // succession mean a continuum.
            let (carried, before) = match begin[test] {
                0.0 => (0.0, *sign),
                value => (value, value),
            };
            *sign = match end[test] {
                0.0 => carried,
                value => value,
            };
            if before * *sign >= 0.0 || from.distance >= to.distance {
                continue;
            }
            let bracket = Bracket::new((from.distance, before), (to.distance, *sign));
            let turned = found[first..]
                .iter()
                .any(|found| found.kind == BifurcationKind::Fold);
            if test == 1
                && !turned
                && let Some(place) = self.pitchfork(from, to, begin[test] == 0.0)
            {
                found.push(FoundBifurcation {
                    distance: place.distance,
                    kind: BifurcationKind::Pitchfork,
                    solved: place.solved,
                });
                continue;
            }
            let place = self.sign_change(from, to, bracket, test)?;
            let multipliers = &place.solved.multipliers;
            let near = |to: f64| multipliers.iter().any(|m| (m - to).norm() < MULTIPLIER);
            let on_circle = |m: &Complex<f64>| m.im != 0.0 && (m.norm() - 1.0).abs() < MULTIPLIER;
            let last = self.curve.unknowns() - 1;
            let turns = place.solved.tangent[last].abs() < MULTIPLIER.sqrt();
            let kind = match test {
                0 if turns => BifurcationKind::Fold,
                1 if near(1.0) && !turned => BifurcationKind::Fold,
                2 if near(-1.0) => BifurcationKind::Flip,
                3 if multipliers.iter().any(on_circle) => BifurcationKind::NeimarkSacker,
                _ => continue,
            };
            found.push(FoundBifurcation {
                distance: place.distance,
                kind,
                solved: place.solved,
            });
        }
        sort_by(&mut found[first..], |change| change.distance);
        Ok(())
    }

    /// The zero of a test function between two places.
    fn sign_change(
        &self,
        from: &CurvePoint,
        to: &CurvePoint,
        bracket: Bracket,
        test: usize,
    ) -> Result<CurvePoint, Error> {
        let nearest = nearest_to_zero(
            bracket,
            [from.clone(), to.clone()],
            |low, high, distance| self.between(low, high, distance),
            |place| self.tests(&place.solved, 0.0)[test],
            |low, high| self.apart(low, high) <= f64::EPSILON,
        )?;
        Ok(nearest.map_or_else(|| to.clone(), |(_, place)| place))
    }

    /// The test functions; 0 where rounding, of this size, could give them any sign.
    fn tests(&self, solved: &Solved, rounding: f64) -> Signs {
        let along = solved.tangent[self.curve.unknowns() - 1];
        let along = if along.abs() < rounding { 0.0 } else { along };
        let [folds, flips, tori] = tests(&solved.multipliers, rounding);
        [along, folds, flips, tori]
    }
}
