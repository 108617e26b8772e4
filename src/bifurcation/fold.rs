use std::ops::Range;

use super::along::{Along, Work, along_velocities};
use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::limit_cycle::PeakMap;
use crate::numerics::bracket::sign_change_between;
use crate::numerics::scan::{Look, Survey, scan};

/// Largest |growth| on the two sides of a fold. Where the growth is larger and still changes its
/// sign between neighbouring numbers, it jumps over zero, and no cycles meet.
const JUMP: f64 = 1e-9;

/// Farthest that a turning point may move from one belt velocity to the next, in units of the range
/// of peak velocities.
const FARTHEST_TURN: f64 = 0.1;

/// Belt velocities v_b in `range`, ascending and dimensionless, at which two pure-slip cycles, one
/// stable and one unstable, meet and vanish.
///
/// Let V be the peak velocity of a motion and P(V) its next one. At each belt velocity the growth
/// over one turn, P(V)/V − 1, is a function of V with turning points, found as roots of its exact
/// derivative. At a fold the growth at a turning point passes through zero, and the multiplier of
/// the cycle is 1. Turning points are followed over 64 intervals of the range. An interval in which
/// turning points come, go, move far or come near zero is divided into up to 2¹⁶ parts. Each
/// turning point is followed into the fold from both sides, so that every velocity returned is one
/// at which cycles meet.
///
/// Source: saddle-node bifurcations of maps, Guckenheimer and Holmes, *Nonlinear Oscillations,
/// Dynamical Systems, and Bifurcations of Vector Fields* (Springer 1983), section 3.5.
///
/// # Errors
///
/// Those of [`grazing_velocities`](super::grazing_velocities).
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
#[doc(alias = "sweep")]
#[doc(alias = "hysteresis")]
pub fn fold_velocities<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    range: Range<f64>,
) -> Result<Vec<f64>, Error> {
    along_velocities(system, range).folds()
}

impl<L: FrictionLaw> Along<'_, L> {
    /// Values of the parameter, ascending, at which two pure-slip cycles, one stable and one
    /// unstable, meet and vanish. See [`fold_velocities`].
    ///
    /// # Errors
    ///
    /// Those of [`grazing`](Self::grazing).
    pub fn folds(&self) -> Result<Vec<f64>, Error> {
        self.over_parts(&mut |work, part, found| folds(work, part, found))
    }
}

/// Adds the folds in a part of the range.
pub(super) fn folds<L: FrictionLaw>(
    work: &Work<'_, '_, L>,
    part: &Range<f64>,
    found: &mut Vec<f64>,
) -> Result<(), Error> {
    let mut outline = |value: f64| {
        let points = work.moving_at(value, &mut |tracer| PeakMap::of(tracer).outline())?;
        Ok(Outline {
            points: points.unwrap_or_default(),
        })
    };
    let mut folds = Folds {
        outline: &mut outline,
        found: Vec::new(),
    };
    let searched = scan(&mut folds, part);
    found.append(&mut folds.found);
    searched
}

/// Outline of the growth at one belt velocity: (peak velocity, growth) at both ends of the range of
/// peak velocities and at the turning points between them.
#[derive(Debug)]
struct Outline {
    points: Vec<(f64, f64)>,
}

impl Outline {
    /// Whether both outlines have as many maxima and minima, in the same order.
    fn is_like(&self, other: &Self) -> bool {
        let rises = |outline: &Self| {
            outline
                .points
                .get(1)
                .map(|next| next.1 > outline.points[0].1)
        };
        self.points.len() == other.points.len() && rises(self) == rises(other)
    }

    /// The turning points, each with its place in the range of peak velocities (from 0 to 1) and
    /// its growth.
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

/// The folds found so far, and the function that gives the outline at a belt velocity.
struct Folds<'f> {
    outline: &'f mut dyn FnMut(f64) -> Result<Outline, Error>,
    found: Vec<f64>,
}

impl Survey for Folds<'_> {
    type Sample = Outline;

    const HALVINGS: u32 = 16;

    fn sample(&mut self, v_b: f64) -> Result<Outline, Error> {
        (self.outline)(v_b)
    }

    fn look(
        &mut self,
        (low, a): &(f64, Outline),
        (high, b): &(f64, Outline),
        halvings: u32,
    ) -> Result<Look, Error> {
        let mut may_hide = !a.is_like(b) || a.at_ends() != b.at_ends();
        let mut crossed = Vec::new();
        if a.is_like(b) {
            for (i, (p, q)) in std::iter::zip(a.turns(), b.turns()).enumerate() {
                may_hide |= (p.0 - q.0).abs() > FARTHEST_TURN;
                if (p.1 > 0.0) != (q.1 > 0.0) {
                    crossed.push((i, p.1, q.1));
                } else {
                    may_hide |= p.1.abs().min(q.1.abs()) < (p.1 - q.1).abs();
                }
            }
        }
        if may_hide && halvings > 0 {
            return Ok(Look::Halve);
        }
        let mut folds = Vec::new();
        for (i, p, q) in &crossed {
            let mut growth = |v_b: f64| {
                let now = (self.outline)(v_b)?;
                let turn = now.is_like(a).then(|| now.turns().nth(*i)).flatten();
                Ok(turn.map(|turn| turn.1))
            };
            let change = sign_change_between(&mut growth, (*low, *p), (*high, *q))?;
            folds.extend(change.filter(|change| change.residual() <= JUMP));
        }
        if folds.len() < crossed.len() && halvings > 0 {
            // The turning points at the two ends are not the same ones after all.
            return Ok(Look::Halve);
        }
        let mut folds: Vec<f64> = folds.iter().map(|change| change.below).collect();
        folds.sort_by(f64::total_cmp);
        self.found.extend(folds);
        Ok(Look::Done)
    }
}

#[cfg(test)]
mod tests;
