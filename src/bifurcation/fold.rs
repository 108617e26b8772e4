use std::ops::Range;

use super::positive;
use super::scan::root_between;
use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::limit_cycle::Tracer;

/// Belt velocities that a range is first divided into.
const INTERVALS: usize = 64;

/// Halvings of an interval in which something may be hidden.
const DEPTH: u32 = 16;

/// A growth that is larger than this on one side of a number and has the other sign at the next one
/// has jumped over zero: no cycles meet there.
const JUMP: f64 = 1e-9;

/// Farthest that a turning point moves from one belt velocity to the next, in units of the range of
/// peak velocities.
const FARTHEST: f64 = 0.1;

/// Belt velocities in `range`, ascending, at which two pure-slip cycles, one stable and one
/// unstable, meet and vanish.
///
/// At each belt velocity the growth of a motion over one turn, P(V)/V − 1 as a function of its peak
/// velocity V, has turning points, where its exact derivative is zero; a fold is where the growth
/// at a turning point passes through zero, and there the multiplier is 1. Turning points are
/// followed over 64 belt velocities, and where they come, go or move fast, or come near zero, over
/// up to 2¹⁶ times as many. Each is followed into the fold, from both sides, so that none is
/// returned at which no cycles meet.
///
/// # Errors
///
/// As [`grazing_velocities`](super::grazing_velocities).
///
/// ```
/// use stick_slip::{Exponential, MassOnBelt, bifurcation};
///
/// let system = MassOnBelt::new(Exponential::new(0.4, 0.3, 1.0)?, 1.4)?.with_damping(0.02)?;
/// let folds = bifurcation::fold_velocities(&system, 1.3..1.6)?;
/// assert_eq!(folds.len(), 1);
/// assert!((folds[0] - 1.457823592457963272).abs() < 1e-13);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn fold_velocities<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    range: Range<f64>,
) -> Result<Vec<f64>, Error> {
    let range = positive(range)?;
    let system = system.moving_forward();
    let outline = |v_b: f64| -> Result<Outline, Error> {
        let points = if v_b == 0.0 {
            Vec::new()
        } else {
            Tracer::new(&system.with_belt_velocity(v_b)?).outline()?
        };
        Ok(Outline { v_b, points })
    };
    let mut folds = Vec::new();
    let width = (range.end - range.start) / INTERVALS as f64;
    let mut left = outline(range.start)?;
    for i in 1..=INTERVALS {
        let v_b = if i == INTERVALS {
            range.end
        } else {
            range.start + width * i as f64
        };
        let right = outline(v_b)?;
        divide(&outline, &left, &right, DEPTH, &mut folds)?;
        left = right;
    }
    Ok(folds)
}

/// The growth at one belt velocity: (peak velocity, growth) at the ends of the range of peak
/// velocities and at the turning points between.
#[derive(Debug)]
struct Outline {
    v_b: f64,
    points: Vec<(f64, f64)>,
}

impl Outline {
    /// Whether as many maxima and minima come in the same order.
    fn is_like(&self, other: &Self) -> bool {
        let rises = |outline: &Self| {
            outline
                .points
                .get(1)
                .map(|next| next.1 > outline.points[0].1)
        };
        self.points.len() == other.points.len() && rises(self) == rises(other)
    }

    /// Turning points: place in the range of peak velocities, from 0 to 1, and growth.
    fn turns(&self) -> impl Iterator<Item = (f64, f64)> {
        let first = self.points.first().map_or(0.0, |point| point.0);
        let last = self.points.last().map_or(1.0, |point| point.0);
        let inner = self.points.get(1..self.points.len().saturating_sub(1));
        let inner = inner.unwrap_or_default();
        inner
            .iter()
            .map(move |(peak, growth)| ((peak - first) / (last - first), *growth))
    }

    /// Whether the growth is positive at the ends of the range of peak velocities.
    fn at_ends(&self) -> [bool; 2] {
        [self.points.first(), self.points.last()].map(|end| end.is_some_and(|end| end.1 > 0.0))
    }
}

fn divide(
    outline: &impl Fn(f64) -> Result<Outline, Error>,
    a: &Outline,
    b: &Outline,
    depth: u32,
    folds: &mut Vec<f64>,
) -> Result<(), Error> {
    let mut suspicious = !a.is_like(b) || a.at_ends() != b.at_ends();
    let mut crossed = Vec::new();
    if a.is_like(b) {
        for (i, (p, q)) in std::iter::zip(a.turns(), b.turns()).enumerate() {
            suspicious |= (p.0 - q.0).abs() > FARTHEST;
            if (p.1 > 0.0) != (q.1 > 0.0) {
                crossed.push((i, p.1, q.1));
            } else {
                suspicious |= p.1.abs().min(q.1.abs()) < (p.1 - q.1).abs();
            }
        }
    }
    if !suspicious || depth == 0 {
        let mut roots = Vec::new();
        for (i, p, q) in &crossed {
            let mut growth = |v_b: f64| {
                let at = outline(v_b)?;
                let turn = at.is_like(a).then(|| at.turns().nth(*i)).flatten();
                Ok(turn.map(|turn| turn.1))
            };
            let root = root_between(&mut growth, (a.v_b, *p), (b.v_b, *q))?;
            roots.extend(root.filter(|root| root.1 <= JUMP).map(|root| root.0));
        }
        if roots.len() == crossed.len() || depth == 0 {
            roots.sort_by(f64::total_cmp);
            folds.extend(roots);
            return Ok(());
        }
        // Not the same turning points after all.
    }
    let middle = outline(0.5 * (a.v_b + b.v_b))?;
    divide(outline, a, &middle, depth - 1, folds)?;
    divide(outline, &middle, b, depth - 1, folds)
}

#[cfg(test)]
mod tests;
