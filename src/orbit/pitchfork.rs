//! Pitchforks: where a symmetric motion loses its symmetry.

use nalgebra::DVector;

use super::branch_equations::{Solved, solution};
use super::branch_predictor::{CurvePoint, LocalCurve};
use super::half_map::{Balance, HalfMap, inverting};
use super::period_map::{CLOSED, vector};
use crate::numerics::bracket::Bracket;

/// Limit of Newton steps; three or four are usual.
const MOST_STEPS: usize = 12;

impl LocalCurve<'_, '_> {
    /// The pitchfork between two symmetric motions whose multipliers pass 1, if there is one;
    /// `is_first` if the multiplier of the first one is 1 to rounding.
    ///
    /// At a pitchfork the equations of `follow` are singular, but those of the half-period map G
    /// are not: a symmetric motion is a fixed point of G, and det(G' + 1) changes its sign at a
    /// pitchfork.
    pub(super) fn pitchfork(
        &self,
        from: &CurvePoint,
        to: &CurvePoint,
        is_first: bool,
    ) -> Option<CurvePoint> {
        if is_first {
            // Its determinant has no sign.
            let Solved {
                y, begin, trial, ..
            } = &from.solved;
            let half_map = HalfMap::of_symmetric(&trial.map, trial.period)?;
            let (half, _) = self.curve.motion(y, begin, 0.5).ok()?;
            let inverted = half_map.inverted(&half, &trial.map.sizes());
            return inverted.map(|_| from.clone());
        }
        let ends = [from, to].map(|place| {
            let (map, period) = (&place.solved.trial.map, place.solved.trial.period);
            let symmetric = HalfMap::of_symmetric(map, period);
            let y = &place.solved.y;
            let balance = self
                .curve
                .with(y, |form, period| Ok(Balance::of(form, period)));
            let held = (symmetric?, balance.ok()?);
            let motion = self.symmetric(&held, y, from)?;
            Some((self.curve.parameter(y), motion, held))
        });
        let [Some(mut low), Some(mut high)] = ends else {
            return None;
        };
        if low.0 > high.0 {
            std::mem::swap(&mut low, &mut high);
        }
        let values = [&low, &high].map(|end| (end.0, end.1.determinant));
        if !(values[0].0 < values[1].0 && values[0].1 * values[1].1 < 0.0) {
            return None;
        }
        let mut bracket = Bracket::new(values[0], values[1]);
        let mut best = low.1.clone();
        while let Some(parameter) = bracket.next_place() {
            let part = (parameter - low.0) / (high.0 - low.0);
            let mut guess = &low.1.y * (1.0 - part) + &high.1.y * part;
            guess[self.curve.unknowns() - 1] = parameter;
            best = self.symmetric(&low.2, &guess, from)?;
            bracket.narrow(parameter, best.determinant);
            if best.determinant == 0.0 {
                break;
            }
        }
        let curve = self.curve;
        let start = best.y.rows(0, curve.order).into_owned();
        let motion = (best.period, curve.parameter(&best.y));
        let solved = curve.guess(&start, motion, from.solved.begin.clone());
        let solved = solved.ok()?;
        let moved = self.scaled(&solved) - self.scaled(self.base);
        Some(CurvePoint {
            distance: self.base.tangent.dot(&moved),
            solved,
        })
    }

    /// The symmetric motion at the parameter of a guess, from the half-period map of another
    /// symmetric motion and the forces that determine its centre.
    fn symmetric(
        &self,
        (half_map, balance): &(HalfMap, Balance),
        guess: &DVector<f64>,
        near: &CurvePoint,
    ) -> Option<Symmetric> {
        let (curve, mut y) = (self.curve, guess.clone());
        let (order, begin) = (curve.order, &near.solved.begin);
        let own = curve.unknowns() - 1;
        let mut before = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            let (half, period) = curve.motion(&y, begin, 0.5).ok()?;
            let here = curve.with(&y, |form, period| Ok(Balance::of(form, period)));
            let image = half_map.moved(balance, &here.ok()?)?.applied(half);
            y.rows_mut(0, order).copy_from(&vector(&image.start, order));
            let sizes = image.sizes();
            let (mut matrix, mut right) = image.closing(&sizes, own);
            if let Some(condition) = &begin.condition {
                image.close_by_period(&mut matrix, period);
                for j in 0..order {
                    matrix[(order, j)] = condition.normal[j] * sizes[j];
                }
                right[order] = -condition.missed_by(&vector(&image.start, order));
            }
            let change = solution(&matrix, &right)?;
            let size = change.amax();
            if size <= f64::EPSILON || (size <= CLOSED.sqrt() && size >= 0.5 * before) {
                return Some(Symmetric {
                    determinant: inverting(&image, &sizes).determinant(),
                    period,
                    y,
                });
            }
            before = size;
            for (i, change) in change.iter().enumerate() {
                y[i] += change * if i < order { sizes[i] } else { period };
            }
        }
        None
    }
}

/// A symmetric motion: a point of the curve.
#[derive(Clone)]
struct Symmetric {
    y: DVector<f64>,
    period: f64,
    /// det(G' + 1).
    determinant: f64,
}
