//! A corner of the branch: at a change of the event sequence it can turn so sharply that Newton's
//! method does not reach its other piece, or turn back at once, as a fold does smoothly.

use nalgebra::DVector;

use super::changes::{CurvePoint, CurveView, FoundBifurcation};
use super::curve::Solved;

/// Distances from the corner, in parts of the range, at which a motion on the other piece is
/// searched.
const AWAY: [f64; 4] = [1e-4, 1e-3, 1e-5, 1e-2];

/// Guesses, as distances from the corner in units of the distance to the motion on the known piece.
/// The other piece lies across a border that some of them cross.
const PARTS: [f64; 7] = [-1.0, 0.0, -4.0, 4.0, -16.0, 16.0, 1.0];

/// Limit of the motions on the way to a corner, each at this part of the distance of the one
/// before on its piece, down to this part of the range.
const MOST_APPROACHES: usize = 64;
const NEARER: f64 = 0.125;
const ROUNDING: f64 = 1e-14;

/// Largest ratio of the change of the state to that of the parameter.
const STEEP: f64 = 64.0;

impl CurveView<'_, '_> {
    /// A motion on the other piece of the curve, which begins at the last motion, and the corner.
    pub(super) fn corner(&self) -> Option<(CurvePoint, FoundBifurcation)> {
        let here = CurvePoint {
            distance: 0.0,
            solved: self.base.clone(),
        };
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
                if self.is_other_piece(&here, &place, (change, away)) {
                    let found = self.found(&place);
                    return Some((self.away_from(&here, place), found));
                }
            }
        }
        None
    }

    /// The motion at a parameter near that of the last one, in units of the range.
    fn beside(&self, change: f64, guess: &DVector<f64>) -> Option<CurvePoint> {
        let curve = self.curve;
        let parameter = curve.parameter(&self.base.y) + change * curve.width();
        let inside = (curve.range.start..=curve.range.end).contains(&parameter);
        let place = inside.then(|| self.with_parameter(parameter, guess, self.base))?;
        place.ok()
    }

    /// Returns true if a motion has other events than the last one, and tends to it as the
    /// parameter returns.
    fn is_other_piece(
        &self,
        here: &CurvePoint,
        place: &CurvePoint,
        (change, away): (f64, f64),
    ) -> bool {
        let apart = self.apart(here, place);
        if place.solved.sequence.is_like(&self.base.sequence) || apart > STEEP * away {
            return false;
        }
        let guess = &self.base.y * 0.75 + &place.solved.y * 0.25;
        let nearer = self.beside(0.25 * change, &guess);
        nearer.is_some_and(|nearer| {
            nearer.solved.sequence.is_like(&place.solved.sequence)
                && self.apart(here, &nearer) <= 0.6 * apart
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

    fn found(&self, place: &CurvePoint) -> FoundBifurcation {
        FoundBifurcation {
            distance: 0.0,
            kind: self.base.sequence.change(&place.solved.sequence),
            solved: self.at_corner(&place.solved),
        }
    }

    /// The motion at the corner, on the smoother piece, given a point on the other one.
    ///
    /// Near to it both pieces are nearly straight: the corner is where the tangents to them meet.
    fn at_corner(&self, other: &Solved) -> Solved {
        let curve = self.curve;
        let mut pieces = [self.base.clone(), other.clone()];
        for _ in 0..MOST_APPROACHES {
            let Some(corner) = self.meeting(&pieces) else {
                break;
            };
            let apart = pieces
                .each_ref()
                .map(|piece| curve.parameter(&piece.y) - corner);
            let farther = usize::from(apart[1].abs() > apart[0].abs());
            if apart[farther].abs() <= ROUNDING * curve.width() {
                break;
            }
            let next = corner + NEARER * apart[farther];
            match self.on_piece(&pieces[farther], next) {
                Some(nearer) => pieces[farther] = nearer,
                None => break,
            }
        }
        let growth = |solved: &Solved| solved.trial.map.growth();
        let [own, other] = pieces;
        if growth(&other) < growth(&own) {
            other
        } else {
            own
        }
    }

    /// The derivatives of the unknowns by the parameter along the curve.
    fn slopes(&self, solved: &Solved) -> DVector<f64> {
        let slopes = solved.tangent.component_mul(self.scale);
        &slopes / slopes[slopes.len() - 1]
    }

    /// The parameter at which the tangents at two points meet, or come nearest to each other.
    fn meeting(&self, points: &[Solved; 2]) -> Option<f64> {
        let measured = |y: DVector<f64>| self.curve.measured(&y.component_div(self.scale));
        let slopes = points.each_ref().map(|point| self.slopes(point));
        let [own, other] = points
            .each_ref()
            .map(|point| self.curve.parameter(&point.y));
        let apart = &points[1].y + &slopes[1] * (own - other) - &points[0].y;
        let rate = measured(&slopes[0] - &slopes[1]);
        let corner = own + rate.dot(&measured(apart)) / rate.norm_squared();
        corner.is_finite().then_some(corner)
    }

    /// The motion at a parameter on the piece of another point.
    fn on_piece(&self, of: &Solved, parameter: f64) -> Option<Solved> {
        let change = parameter - self.curve.parameter(&of.y);
        let guess = &of.y + self.slopes(of) * change;
        let solved = self.with_parameter(parameter, &guess, of).ok()?.solved;
        solved.sequence.is_like(&of.sequence).then_some(solved)
    }
}
