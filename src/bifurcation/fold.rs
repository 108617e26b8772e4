use std::ops::Range;

use super::along::{Along, Work, along_velocities};
use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::limit_cycle::PeakMap;
use crate::numerics::bracket::{SignChange, sign_change_between};
use crate::numerics::roots_with_slopes::Sample;
use crate::numerics::scan::{Refinement, Survey, scan};

/// Largest |growth| on the two sides of a fold. A larger growth that changes its sign between
/// neighbouring numbers jumps over zero, and no cycles meet.
const JUMP: f64 = 1e-9;

/// Largest distance by which a turning point may move from one belt velocity to the next, in units
/// of the range of peak velocities.
const FARTHEST_TURN: f64 = 0.1;

/// Distance on both sides of a turning point, in the same units, within which it is searched again.
const NEAR_TURN: f64 = 1e-3;

/// Largest growth that can reach zero within an interval, in units of the change of the growth
/// across it.
const REACH: f64 = 2.0;

/// Largest growth that can reach zero and turn back within half an interval: eight times that of a
/// parabola. The unit is the difference of the growth in the middle from the mean of both ends.
const REACH_OF_BEND: f64 = 2.0;

/// A lower bound of the same growth, in units of the change across the half interval: the
/// difference in the middle is 0 for a function that is odd about the middle.
const LEAST_BEND: f64 = 0.25;

/// Belt velocities v_b in `range`, ascending and dimensionless, at which two pure-slip cycles, one
/// stable and one unstable, meet and vanish.
///
/// Let V be a maximum of the velocity in a motion, and P(V) the next maximum. The growth over one
/// period is g(V) = P(V)/V − 1; it is zero for a cycle. At each belt velocity the extrema of g lie
/// at the roots of the exact derivative of g. At a fold one of these extrema is zero, and the
/// multiplier of the cycle is 1.
///
/// The range is divided into 64 intervals. For nine values of V, g is computed at both ends of an
/// interval; let c be the largest change of g from one end to the other. An extremum of g is
/// followed through the interval only if its absolute value is less than 2c. An interval is divided
/// further, into up to 2¹⁶ parts, if extrema of g appear, disappear or move far in it, or if an
/// extremum may reach zero between the two ends. Each zero of an extremum is enclosed between two
/// neighbouring `f64` numbers. At both numbers |g| must be at most 10⁻⁹; otherwise g jumps over
/// zero, and the velocity is not returned.
///
/// Source: saddle-node bifurcations of maps, Guckenheimer and Holmes, *Nonlinear Oscillations,
/// Dynamical Systems, and Bifurcations of Vector Fields* (Springer 1983), section 3.5.
///
/// # Errors
///
/// The errors of [`grazing_velocities`](super::grazing_velocities).
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
    /// The errors of [`grazing`](Self::grazing).
    pub fn folds(&self) -> Result<Vec<f64>, Error> {
        self.over_parts(&mut |work, part, found| folds(work, part, found).map(drop))
    }
}

/// Adds the folds in a part of the range. Returns the narrowest intervals with a change that is not
/// a fold in double precision, for example if the growth at a turning point jumps over zero.
pub(super) fn folds(
    work: &Work<'_, '_>,
    part: &Range<f64>,
    found: &mut Vec<f64>,
) -> Result<Vec<Range<f64>>, Error> {
    let mut folds = Folds {
        growths: work,
        found: Vec::new(),
        doubtful: Vec::new(),
    };
    let searched = scan(&mut folds, part);
    found.append(&mut folds.found);
    searched.map(|()| folds.doubtful)
}

/// The growth of motions in slip over one period, at any value of the parameter.
trait Growths {
    /// A coarse outline of the growth.
    fn survey(&self, value: f64) -> Result<Outline, Error>;

    /// Refines an outline, so that it has all turning points at which the growth is within `reach`
    /// of zero.
    fn sharpen(&self, value: f64, outline: &mut Outline, reach: f64) -> Result<(), Error>;

    /// The growth at the turning point between two points of the range of peak velocities; `None`
    /// if the slopes there do not show one.
    fn turn(&self, value: f64, places: [f64; 2], is_maximum: bool) -> Result<Option<f64>, Error>;
}

impl Growths for Work<'_, '_> {
    fn survey(&self, value: f64) -> Result<Outline, Error> {
        let seen = self.moving_at(value, &mut |tracer| PeakMap::of(tracer).survey())?;
        let seen = seen.unwrap_or_default();
        Ok(Outline {
            surveyed: seen.iter().map(|sample| sample.value).collect(),
            seen,
            points: Vec::new(),
            reach: -1.0,
            bend: f64::INFINITY,
        })
    }

    fn sharpen(&self, value: f64, outline: &mut Outline, reach: f64) -> Result<(), Error> {
        if outline.reach < reach {
            let seen = &mut outline.seen;
            let points = self.moving_at(value, &mut |tracer| {
                PeakMap::of(tracer).outline(seen, reach)
            })?;
            (outline.points, outline.reach) = (points.unwrap_or_default(), reach);
        }
        Ok(())
    }

    fn turn(&self, value: f64, places: [f64; 2], is_maximum: bool) -> Result<Option<f64>, Error> {
        let turn = self.moving_at(value, &mut |tracer| {
            PeakMap::of(tracer).turn(places, is_maximum)
        })?;
        Ok(turn.flatten())
    }
}

/// Outline of the growth at one value of the parameter.
#[derive(Debug)]
struct Outline {
    /// The growth at the points of the coarse outline.
    surveyed: Vec<f64>,
    /// The known samples of the growth, by ascending peak velocity.
    seen: Vec<Sample>,
    /// (peak velocity, growth) at both ends of the range of peak velocities and at the turning
    /// points between them.
    points: Vec<(f64, f64)>,
    /// Growth up to which the turning points are exact.
    reach: f64,
    /// The difference of the growth in the middle of an interval from the mean of both ends, for
    /// the last halved interval that this outline bounds or halves; infinite before a halving.
    bend: f64,
}

impl Outline {
    /// The change of the growth from one outline to another at the points of a survey; infinite
    /// without a survey.
    fn change(&self, other: &Self) -> f64 {
        if self.surveyed.is_empty() {
            return f64::INFINITY;
        }
        let pairs = std::iter::zip(&self.surveyed, &other.surveyed);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    /// The largest difference of the growth from the mean of two other outlines, at the points of a
    /// survey; infinite if one has no survey.
    fn bend_between(&self, a: &Self, b: &Self) -> f64 {
        let all = [self, a, b].map(|outline| &outline.surveyed[..]);
        if all.iter().any(|surveyed| surveyed.is_empty()) {
            return f64::INFINITY;
        }
        let [middle, a, b] = all;
        let bend = |i: usize| (middle[i] - 0.5 * (a[i] + b[i])).abs();
        (0..middle.len()).map(bend).fold(0.0, f64::max)
    }

    /// The signs of the growth at the two ends of the range of peak velocities: true if positive.
    fn at_ends(&self) -> [bool; 2] {
        let of_points = [self.points.first(), self.points.last()].map(|end| end.map(|end| end.1));
        let of_survey = [self.surveyed.first(), self.surveyed.last()].map(|end| end.copied());
        [0, 1].map(|i| {
            of_survey[i]
                .or(of_points[i])
                .is_some_and(|growth| growth > 0.0)
        })
    }

    fn is_empty(&self) -> bool {
        self.seen.is_empty() && self.points.is_empty()
    }

    /// The outline cut off at `reach`.
    fn within(&self, reach: f64) -> Window {
        let clamped = |(peak, growth): &(f64, f64)| (*peak, growth.clamp(-reach, reach));
        let mut points: Vec<_> = self.points.iter().map(clamped).collect();
        // Neighbours whose growth is beyond `reach` are no turning points.
        while points.len() > 2
            && let Some(i) = points.windows(2).position(|pair| pair[0].1 == pair[1].1)
        {
            let last = points.len() - 1;
            points.drain(i.max(1)..(i + 2).min(last));
        }
        Window(points)
    }
}

/// The part of an outline within reach of zero, in the same form.
#[derive(Debug)]
struct Window(Vec<(f64, f64)>);

impl Window {
    /// Returns true if both have as many maxima and minima, in the same order.
    fn is_like(&self, other: &Self) -> bool {
        self.0.len() == other.0.len() && self.rises() == other.rises()
    }

    /// Returns true if the growth rises from the first point to the second; `None` without two
    /// points.
    fn rises(&self) -> Option<bool> {
        self.0.get(1).map(|next| next.1 > self.0[0].1)
    }

    /// The turning points, each with its place in the range of peak velocities (from 0 to 1) and
    /// its growth.
    fn turns(&self) -> impl Iterator<Item = (f64, f64)> {
        let first = self.0.first().map_or(0.0, |point| point.0);
        let last = self.0.last().map_or(1.0, |point| point.0);
        let inner = self.0.get(1..self.0.len().saturating_sub(1));
        let inner = inner.unwrap_or_default();
        inner
            .iter()
            .map(move |(peak, growth)| ((peak - first) / (last - first), *growth))
    }

    /// The places of neighbouring points between which the growth passes through zero.
    fn zeros(&self) -> Vec<[f64; 2]> {
        let last = self.0.last().copied().into_iter();
        let inner = self.turns().chain(last.map(|end| (1.0, end.1)));
        let mut zeros = Vec::new();
        let mut before = (0.0, self.0.first().is_some_and(|end| end.1 > 0.0));
        for (place, growth) in inner {
            let positive = growth > 0.0;
            if positive != before.1 {
                zeros.push([before.0, place]);
            }
            before = (place, positive);
        }
        zeros
    }

    /// Returns true if the growth has as many zeros as in another window, and these may lie at the
    /// same places.
    fn may_have_zeros_of(&self, other: &Self) -> bool {
        let (a, b) = (self.zeros(), other.zeros());
        let meet = |(a, b): (&[f64; 2], &[f64; 2])| a[0] < b[1] && b[0] < a[1];
        a.len() == b.len() && std::iter::zip(&a, &b).all(meet)
    }
}

/// The folds found so far, and the growth to be searched.
struct Folds<'f> {
    growths: &'f dyn Growths,
    found: Vec<f64>,
    /// Intervals that would have to be halved further, but cannot.
    doubtful: Vec<Range<f64>>,
}

/// A turning point whose growth changes its sign: its number, its places and its growths.
#[derive(Debug, Clone, Copy)]
struct Crossed {
    index: usize,
    ends: [(f64, f64); 2],
}

impl Folds<'_> {
    /// Requests that an interval be halved, and records it as doubtful if it cannot be.
    fn halve(&mut self, [low, high]: [f64; 2], halvings: u32) -> Refinement {
        if halvings == 0 {
            match self.doubtful.last_mut() {
                Some(last) if last.end == low => last.end = high,
                _ => self.doubtful.push(low..high),
            }
        }
        Refinement::Halve
    }

    /// The fold between two values of the parameter at which a turning point passes zero; `None`
    /// if it is not the same turning point throughout.
    fn fold(
        &self,
        [low, high]: [f64; 2],
        window: &Window,
        reach: f64,
        crossed: &Crossed,
    ) -> Result<Option<f64>, Error> {
        let [p, q] = crossed.ends;
        let margin = (0.5 * (p.0 - q.0).abs()).max(NEAR_TURN);
        let (first, last) = (p.0.min(q.0) - margin, p.0.max(q.0) + margin);
        let places = [first.max(0.0), last.min(1.0)];
        let is_maximum = window
            .rises()
            .is_some_and(|rises| rises == crossed.index.is_multiple_of(2));
        let mut growth = |value: f64| {
            let turn = self.growths.turn(value, places, is_maximum)?;
            if turn.is_some() {
                return Ok(turn);
            }
            let mut outline = self.growths.survey(value)?;
            self.growths.sharpen(value, &mut outline, reach)?;
            let now = outline.within(reach);
            let turn = now.is_like(window).then(|| now.turns().nth(crossed.index));
            Ok(turn.flatten().map(|turn| turn.1))
        };
        let change = sign_change_between(&mut growth, (low, p.1), (high, q.1))?;
        let is_passed = |change: &SignChange| change.residual() <= JUMP;
        Ok(change.filter(is_passed).map(|change| change.below))
    }
}

impl Survey for Folds<'_> {
    type Sample = Outline;

    const HALVINGS: u32 = 16;

    fn sample(&mut self, value: f64) -> Result<Outline, Error> {
        self.growths.survey(value)
    }

    fn middle(
        &mut self,
        value: f64,
        left: &mut Outline,
        right: &mut Outline,
    ) -> Result<Outline, Error> {
        let mut middle = self.sample(value)?;
        let bend = middle.bend_between(left, right);
        for outline in [&mut middle, left, right] {
            outline.bend = bend;
        }
        Ok(middle)
    }

    fn examine(
        &mut self,
        (low, a): &mut (f64, Outline),
        (high, b): &mut (f64, Outline),
        halvings: u32,
    ) -> Result<Refinement, Error> {
        let ends = [*low, *high];
        if a.is_empty() || b.is_empty() {
            let alike = a.is_empty() && b.is_empty();
            return Ok(if alike {
                Refinement::Done
            } else {
                self.halve(ends, halvings)
            });
        }
        if a.at_ends() != b.at_ends() && halvings > 0 {
            // The cycle that appears at an end may meet another close by.
            return Ok(Refinement::Halve);
        }
        let change = a.change(b);
        let reach = REACH * change;
        self.growths.sharpen(*low, a, reach)?;
        self.growths.sharpen(*high, b, reach)?;
        let near = REACH_OF_BEND * a.bend.max(b.bend);
        let near = near.max(LEAST_BEND * change).min(reach);
        let (a, b) = (a.within(reach), b.within(reach));
        let mut may_hide = false;
        let mut crossed = Vec::new();
        if a.is_like(&b) {
            for (index, (p, q)) in std::iter::zip(a.turns(), b.turns()).enumerate() {
                let is_exact = p.1.abs() < reach && q.1.abs() < reach;
                may_hide |= is_exact && (p.0 - q.0).abs() > FARTHEST_TURN;
                if (p.1 > 0.0) != (q.1 > 0.0) {
                    let ends = [p, q];
                    crossed.push(Crossed { index, ends });
                } else {
                    may_hide |= p.1.abs().min(q.1.abs()) < (p.1 - q.1).abs().min(near);
                }
            }
        } else {
            let are_far = |window: &Window| window.turns().all(|turn| turn.1.abs() >= near);
            may_hide = !(a.may_have_zeros_of(&b) && are_far(&a) && are_far(&b));
        }
        if may_hide && halvings > 0 {
            return Ok(Refinement::Halve);
        }
        let mut folds = Vec::new();
        for crossed in &crossed {
            folds.extend(self.fold(ends, &a, reach, crossed)?);
        }
        let all = folds.len() == crossed.len();
        if !all && halvings > 0 {
            // The turning points at the two ends are not the same ones after all.
            return Ok(Refinement::Halve);
        }
        folds.sort_by(f64::total_cmp);
        self.found.extend(folds);
        Ok(if may_hide || !all {
            self.halve(ends, halvings)
        } else {
            Refinement::Done
        })
    }
}

#[cfg(test)]
mod tests;
