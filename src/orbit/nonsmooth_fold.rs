//! Corners of a branch. At a change of the event sequence the branch can turn so sharply that
//! Newton's method does not reach its other piece. It can also turn back, as at a fold, but not
//! smoothly.

use nalgebra::DVector;

use super::bifurcations::{FoundBifurcation, JUMP};
use super::branch_equations::Solved;
use super::branch_predictor::{CurvePoint, LocalCurve};
use super::event_sequence::Sequence;
use super::shooting_residual::TrialMotion;

/// Distances from the corner, in parts of the range, at which a motion on the other piece is
/// searched.
const AWAY: [f64; 4] = [1e-4, 1e-3, 1e-5, 1e-2];

/// Distances from the corner, in units of the scales, at which motions are tried; some of them have
/// the events of the other piece.
const SIDES: [f64; 2] = [1e-6, 1e-4];

/// Guesses, as distances from the corner in units of the distance to the motion on the known piece.
/// Some of them lie beyond the border to the other piece.
const PARTS: [f64; 7] = [-1.0, 0.0, -4.0, 4.0, -16.0, 16.0, 1.0];

/// Limit of the motions on the way to a corner, and the parts of the way that are tried, down to
/// this distance.
const MOST_APPROACHES: usize = 64;
const NEARER: [f64; 2] = [0.875, 0.5];
const ROUNDING: f64 = 1e-14;

/// Largest ratio of the change of the state to that of the parameter.
const STEEP: f64 = 64.0;

impl LocalCurve<'_, '_> {
    /// A motion on the other piece of the curve, which begins at the last motion, and the corner.
    pub(super) fn corner(&self) -> Option<(CurvePoint, Option<FoundBifurcation>)> {
        let here = CurvePoint {
            distance: 0.0,
            solved: self.base.clone(),
        };
        let place = self.by_parameter(&here);
        let place = place.or_else(|| self.along_other_tangent(&here))?;
        let found = self.found(&place);
        Some((self.away_from(&here, place), found))
    }

    /// A motion on the other piece at a parameter near that of the last motion.
    fn by_parameter(&self, here: &CurvePoint) -> Option<CurvePoint> {
        let last = self.curve.unknowns() - 1;
        let along = self.base.tangent[last];
        for away in AWAY {
            let back = -away * along.signum();
            let back_along = &self.base.tangent * (back / along);
            let guess = &self.base.y + back_along.component_mul(self.scale);
            let Some(known) = self.beside(back, &guess) else {
                continue;
            };
            let way = &known.solved.y - &self.base.y;
            let tries = PARTS.iter().flat_map(|part| [(part, -back), (part, back)]);
            for (part, change) in tries {
                let Some(place) = self.beside(change, &(&self.base.y + &way * *part)) else {
                    continue;
                };
                let nearer = |guess: &DVector<f64>| self.beside(0.25 * change, guess);
                if self.is_other_piece(here, &place, away, nearer) {
                    return Some(place);
                }
            }
        }
        None
    }

    /// A motion on the other piece in the direction of the tangent of that piece, which may be
    /// nearly normal to the parameter. The tangent is that of the equations linearised at motions
    /// near the last one that have other events and are not closed.
    fn along_other_tangent(&self, here: &CurvePoint) -> Option<CurvePoint> {
        let unknowns = self.curve.unknowns();
        let sides = SIDES.iter().flat_map(|size| {
            (0..unknowns).flat_map(move |i| [(i, size * self.scale[i]), (i, -size * self.scale[i])])
        });
        let mut known = vec![self.base.sequence.clone()];
        for (i, change) in sides {
            let mut guess = self.base.y.clone();
            guess[i] += change;
            let Ok(trial) = self.curve.trial(&guess, &self.base.begin) else {
                continue;
            };
            let sequence = Sequence::of(&trial.map, trial.period);
            if known.iter().any(|known| known.is_like(&sequence)) {
                continue;
            }
            known.push(sequence);
            let Some(tangent) = self.tangent_at(&guess, &trial) else {
                continue;
            };
            for away in AWAY {
                for along in [tangent.clone(), -&tangent] {
                    let at = |away: f64| self.across_direction(self.base, &along, away);
                    let Some(place) = at(away) else {
                        continue;
                    };
                    if self.is_other_piece(here, &place, away, |_| at(0.25 * away)) {
                        return Some(place);
                    }
                }
            }
        }
        None
    }

    /// The tangent of the curve that the equations linearised at a motion have, which is not
    /// closed.
    fn tangent_at(&self, y: &DVector<f64>, trial: &TrialMotion) -> Option<DVector<f64>> {
        let curve = self.curve;
        let begin = &self.base.begin;
        let slope = curve.by_parameter(y, trial, begin);
        let (matrix, _) = curve.linearised(y, (trial, begin), &slope, self.scale);
        let svd = matrix.try_svd(false, true, f64::EPSILON, 1000 * curve.unknowns())?;
        Some(svd.v_t?.row(svd.singular_values.argmin().0).transpose())
    }

    /// The motion on the plane across a direction, at a distance from a point.
    fn across_direction(
        &self,
        from: &Solved,
        along: &DVector<f64>,
        distance: f64,
    ) -> Option<CurvePoint> {
        let plane = self.across(from, along, distance);
        let guess = &from.y + along.component_mul(self.scale) * distance;
        let solved = self.curve.solve(&guess, from, &plane).ok()?;
        let range = &self.curve.range;
        (range.start..=range.end)
            .contains(&self.curve.parameter(&solved.y))
            .then_some(CurvePoint { distance, solved })
    }

    /// The motion at a parameter near that of the last one, in units of the range.
    fn beside(&self, change: f64, guess: &DVector<f64>) -> Option<CurvePoint> {
        let curve = self.curve;
        let parameter = curve.parameter(&self.base.y) + change * curve.width();
        let inside = (curve.range.start..=curve.range.end).contains(&parameter);
        let place = inside.then(|| self.with_parameter(parameter, guess, self.base))?;
        place.ok()
    }

    /// Returns true if a motion at a distance has other events than the last motion, but converges
    /// to it as the distance decreases. `nearer` finds the motion at a quarter of the distance from
    /// a guess.
    fn is_other_piece(
        &self,
        here: &CurvePoint,
        place: &CurvePoint,
        away: f64,
        nearer: impl Fn(&DVector<f64>) -> Option<CurvePoint>,
    ) -> bool {
        let apart = self.apart(here, place);
        let is_far = apart > STEEP * away || self.departure(here, place) > JUMP;
        if place.solved.is_like(self.base) || is_far {
            return false;
        }
        let guess = &self.base.y * 0.75 + &place.solved.y * 0.25;
        nearer(&guess).is_some_and(|nearer| {
            nearer.solved.is_like(&place.solved) && self.apart(here, &nearer) <= 0.6 * apart
        })
    }

    /// The place with the tangent that leads away from the corner.
    fn away_from(&self, here: &CurvePoint, mut place: CurvePoint) -> CurvePoint {
        let moved = self.scaled(&place.solved) - self.scaled(&here.solved);
        if place.solved.tangent.dot(&moved) < 0.0 {
            place.solved.tangent.neg_mut();
        }
        place
    }

    fn found(&self, place: &CurvePoint) -> Option<FoundBifurcation> {
        let (before, after) = (&self.base.sequence, &place.solved.sequence);
        (!before.is_like(after)).then(|| FoundBifurcation {
            distance: 0.0,
            kind: before.change(after),
            solved: self.at_corner(&place.solved),
        })
    }

    /// The motion at the corner, on the smoother piece, given a point on the other one.
    ///
    /// Near the corner both pieces are nearly straight, so the corner is the intersection of their
    /// tangents.
    fn at_corner(&self, other: &Solved) -> Solved {
        let mut pieces = [self.base.clone(), other.clone()];
        let mut distances = [0.0, f64::INFINITY];
        for _ in 0..MOST_APPROACHES {
            let ways = self.meeting(&pieces);
            distances = ways.map(f64::abs);
            let farther = usize::from(distances[1] > distances[0]);
            if distances[farther].is_nan() || distances[farther] <= ROUNDING {
                break;
            }
            let mut nearer = NEARER
                .iter()
                .filter_map(|part| self.on_piece(&pieces[farther], part * ways[farther]));
            match nearer.next() {
                Some(nearer) => pieces[farther] = nearer,
                None => break,
            }
        }
        let [own, other] = pieces;
        let growth = |solved: &Solved| solved.trial.map.growth();
        if distances[1] <= distances[0].max(ROUNDING) && growth(&other) < growth(&own) {
            other
        } else {
            own
        }
    }

    /// The ways along the tangents at two points to where they meet, or come nearest to each other.
    fn meeting(&self, points: &[Solved; 2]) -> [f64; 2] {
        let [own, other] = points.each_ref().map(|point| &point.tangent);
        let apart = self.scaled(&points[1]) - self.scaled(&points[0]);
        let cosine = own.dot(other);
        let way = (apart.dot(own) - cosine * apart.dot(other)) / (1.0 - cosine * cosine);
        [way, cosine * way - apart.dot(other)]
    }

    /// The motion on the piece of another point, a way along its tangent.
    fn on_piece(&self, of: &Solved, way: f64) -> Option<Solved> {
        let solved = self.across_direction(of, &of.tangent, way)?.solved;
        solved.sequence.is_like(&of.sequence).then_some(solved)
    }
}
