//! A corner of the curve: where the events change, it can turn so sharply that Newton's method does
//! not come to its other piece by itself, or turn back, as at a fold, but at once.

use nalgebra::DVector;

use super::changes::{Found, Place, View};

/// How far from the corner, in parts of the range, a motion on the other piece is looked for.
const AWAY: [f64; 4] = [1e-4, 1e-3, 1e-5, 1e-2];

/// From the corner, in units of the way to the motion on the known piece: where to start. The other
/// piece lies across a border that some of these cross.
const PARTS: [f64; 7] = [-1.0, 0.0, -4.0, 4.0, -16.0, 16.0, 1.0];

/// How much farther than the parameter the state may change.
const STEEP: f64 = 64.0;

impl View<'_, '_> {
    /// A motion on another piece of the curve that begins where the last motion lies, and that
    /// place.
    pub(super) fn corner(&self) -> Option<(Place, Found)> {
        let here = Place {
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
                    return Some((self.away_from(&here, place.clone()), self.found(&place)));
                }
            }
        }
        None
    }

    /// The motion at a parameter beside that of the last one, in units of the range.
    fn beside(&self, change: f64, guess: &DVector<f64>) -> Option<Place> {
        let curve = self.curve;
        let parameter = curve.parameter(&self.base.y) + change * curve.width();
        let inside = (curve.range.start..=curve.range.end).contains(&parameter);
        let place = inside.then(|| self.with_parameter(parameter, guess, self.base))?;
        place.ok()
    }

    /// Whether a motion has other events than the last one, and leads to it as the parameter comes
    /// back.
    fn is_other_piece(&self, here: &Place, place: &Place, (change, away): (f64, f64)) -> bool {
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

    /// With the tangent that leads away from the corner.
    fn away_from(&self, here: &Place, mut place: Place) -> Place {
        let moved = self.scaled(&place.solved) - self.scaled(&here.solved);
        if place.solved.tangent.dot(&moved) < 0.0 {
            place.solved.tangent.neg_mut();
        }
        place
    }

    fn found(&self, place: &Place) -> Found {
        Found {
            distance: 0.0,
            kind: self.base.sequence.change(&place.solved.sequence),
            solved: self.base.clone(),
        }
    }
}
