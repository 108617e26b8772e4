//! Differences between motions of a family with the same events.
//!
//! If the order of events on one side of the parameter is another one than on the other side, the
//! motion on each side is smooth, and the derivative exists if both sides have the same.

use std::cell::RefCell;
use std::sync::Arc;

use nalgebra::DVector;

use super::neighbour::{Groups, Likeness, Neighbour, Run};
use crate::error::{Error, NotDifferentiable};

/// Motions at several values of one parameter, with their weights in the derivative.
#[derive(Debug, Clone)]
pub(super) struct Variation {
    parts: Vec<(f64, Arc<Run>)>,
    groups: Groups,
    likeness: Likeness,
    /// Events whose times have no derivative, although the states have one.
    pub(super) timeless: Vec<usize>,
}

/// Formulas of fourth order: places in units of the increment, and weights.
type Stencil = &'static [(f64, f64)];

const CENTRAL: Stencil = &[
    (-2.0, 1.0 / 12.0),
    (-1.0, -2.0 / 3.0),
    (1.0, 2.0 / 3.0),
    (2.0, -1.0 / 12.0),
];
const ONE_SIDED: Stencil = &[
    (0.0, -25.0 / 12.0),
    (1.0, 4.0),
    (2.0, -3.0),
    (3.0, 4.0 / 3.0),
    (4.0, -0.25),
];

/// The change of the motion, in units of its size, that the increment is to cause: about the fifth
/// root of ε.
const CHANGE: f64 = 1e-3;

/// Derivatives that agree to this part need no shorter increment.
const AGREE: f64 = 1e-11;

/// Derivatives that differ by more than this part differ not by rounding alone, and shorter
/// increments bring them nearer to each other at last.
const COARSE: f64 = 1e-7;

/// Derivatives that differ by more than this part, as at a jump, do not converge.
const DIVERGED: f64 = 1e-3;

/// Derivatives of both sides may differ by this many errors of the derivative.
const ERRORS: f64 = 16.0;

/// A change below this is too small to be measured.
const UNSEEN: f64 = 1e-9;

/// If a hundredth of a small parameter changes the motion by less than this, increments are those
/// of a parameter of size 1.
const SLIGHT: f64 = 1e-5;

/// The largest increment, in parts of the parameter, or of 1.
const LARGEST: f64 = 1e-2;

/// The first increment.
const FIRST: f64 = 1e-7;

/// The least increment.
const LEAST: f64 = 1e-11;

/// The rounding errors of a motion, in units of its size.
const ROUNDING: f64 = 8192.0 * f64::EPSILON;

/// Derivatives of both sides that differ by this part are different.
const APART: f64 = 1e-7;

/// The motions beside one, for changes of a parameter.
struct Beside<'b> {
    here: &'b Run,
    run: &'b dyn Fn(f64) -> Result<Run, Error>,
    /// The neighbours of one increment.
    found: RefCell<Vec<(f64, Option<Neighbour>)>>,
    /// The reason why the last was none.
    reason: RefCell<NotDifferentiable>,
}

impl Beside<'_> {
    fn at(&self, change: f64) -> Option<Neighbour> {
        let known = self.found.borrow();
        if let Some((_, found)) = known.iter().find(|known| known.0 == change) {
            return found.clone();
        }
        drop(known);
        let run = if change == 0.0 {
            Ok(self.here.clone())
        } else {
            (self.run)(change)
        };
        let found = match run.map(|run| Neighbour::of(self.here, run)) {
            Ok(Ok(found)) => Some(found),
            Ok(Err(time)) => {
                self.reason.replace(NotDifferentiable::Events { time });
                None
            }
            Err(error) => {
                self.reason
                    .replace(NotDifferentiable::NoMotion(Box::new(error)));
                None
            }
        };
        self.found.borrow_mut().push((change, found.clone()));
        found
    }

    /// The motions of a formula on a side.
    fn with(&self, stencil: Stencil, value: f64, step: f64) -> Option<Variation> {
        let parts = stencil.iter().map(|&(place, weight)| {
            // The increment as it is, in spite of rounding.
            let change = (value + place * step) - value;
            Some((weight / step, self.at(change)?))
        });
        let parts: Vec<(f64, Neighbour)> = parts.collect::<Option<_>>()?;
        let mut groups = Groups(vec![true; self.here.events.len() + 1]);
        let mut likeness = Likeness::Same;
        for (_, part) in &parts {
            groups.join(&part.groups);
            likeness = likeness.and(part.likeness);
        }
        let parts = parts.into_iter().map(|(weight, part)| (weight, part.run));
        Some(Variation {
            parts: parts.collect(),
            groups,
            likeness,
            timeless: Vec::new(),
        })
    }
}

/// The result of one increment.
enum Slope {
    /// Motions on both sides, or on one.
    Of(Variation),
    /// The derivatives of both sides differ by these numbers: of displacements, velocities and
    /// memory variables. The time of the events.
    Differs([f64; 3], f64),
    /// No motion has the same events.
    None,
}

impl Variation {
    /// Motions beside another one with the same events. `value` is the parameter, and `run` makes
    /// the motion for a change of it.
    pub(super) fn of(
        here: &Run,
        value: f64,
        run: &dyn Fn(f64) -> Result<Run, Error>,
    ) -> Result<Self, NotDifferentiable> {
        /// Increments after which derivatives will not come closer.
        const TRIED: usize = 3;
        let stays = |differences: &[[f64; 3]]| {
            let count = differences.len();
            let before = count.checked_sub(TRIED + 1).map(|i| differences[i]);
            before.is_some_and(|before| {
                std::iter::zip(differences[count - 1], before).any(|(by, before)| by > 0.5 * before)
            })
        };
        // A parameter that is 0 tells nothing of its unit; nor does one of which parts underflow.
        let mut has_no_unit = value.abs() < f64::MIN_POSITIVE;
        let [mut least, first, mut most] = if has_no_unit {
            [1e-60, FIRST, 1e60]
        } else {
            [LEAST, FIRST, LARGEST].map(|part| part * value.abs())
        };
        let beside = Beside {
            here,
            run,
            found: RefCell::new(Vec::new()),
            reason: RefCell::new(NotDifferentiable::Events { time: here.begin }),
        };
        // The increment that changes the motion as much as it may.
        let mut step = first;
        let mut is_bounded = most >= LARGEST;
        let mut is_refused = false;
        loop {
            let sides = [step, -step].into_iter();
            let change = sides
                .filter_map(|change| {
                    let found = beside.at(change)?;
                    here.apart(&found.run, &found.groups)
                })
                .next();
            beside.found.borrow_mut().clear();
            match change {
                Some(change) if change < UNSEEN && 100.0 * step < most => step *= 100.0,
                // The increment vanishes in the numbers that it is added to, and one that does not
                // changes the events.
                Some(change) if change < ROUNDING && is_refused => {
                    return Err(beside.reason.into_inner());
                }
                Some(change) if !is_bounded && change * most < SLIGHT * step => {
                    (most, is_bounded, has_no_unit) = (LARGEST, true, true);
                }
                Some(change) => {
                    step = (step * CHANGE / change.max(UNSEEN * UNSEEN)).min(most);
                    if has_no_unit {
                        least = LEAST / CHANGE * step;
                    }
                    break;
                }
                None if step < least => return Err(beside.reason.into_inner()),
                None => {
                    (most, is_bounded, is_refused) = (step, true, true);
                    step *= 0.1;
                }
            }
        }
        // Shorter ones, as long as that brings derivatives nearer to each other: a motion may bend
        // more than its size says, and rounding grows with every reduction.
        let mut best: Option<Candidate> = None;
        let mut last: Option<DVector<f64>> = None;
        let mut apart: Vec<[f64; 3]> = Vec::new();
        let mut rough: Vec<[f64; 3]> = Vec::new();
        while step >= least {
            let slope = Self::with_step(value, step, &beside);
            beside.found.borrow_mut().clear();
            let increment = step;
            step *= 0.25;
            let found = match slope {
                Slope::Of(found) => found,
                Slope::Differs(by, time) => {
                    apart.push(by);
                    if stays(&apart) {
                        return Err(NotDifferentiable::Order { time });
                    }
                    continue;
                }
                Slope::None => continue,
            };
            let Some(probe) = found.derivative(|run| run.probe(here, &found.groups)) else {
                continue;
            };
            let Some(before) = last.replace(probe.clone()) else {
                continue;
            };
            let found = Candidate {
                error: &probe - before,
                step: increment,
                probe,
                found,
            };
            let roughness = found.roughness(here);
            if roughness != [0.0; 3] {
                rough.push(roughness);
                if stays(&rough) {
                    return Err(NotDifferentiable::Kink);
                }
                continue;
            }
            let found = found.judged(here);
            let (error, size) = (found.error.amax(), found.probe.amax());
            let least = best.as_ref().map(|best| best.error.amax());
            let rank = |of: &Candidate| (of.found.timeless.len(), of.error.amax());
            if best.as_ref().is_none_or(|best| rank(&found) < rank(best)) {
                best = Some(found);
            }
            let is_rising = |least: f64| error > 0.5 * least && least <= COARSE * size;
            if error <= AGREE * size || least.is_some_and(is_rising) {
                break;
            }
        }
        match best {
            Some(best) => Ok(best.found),
            None if rough.is_empty() => Err(beside.reason.into_inner()),
            None => Err(NotDifferentiable::Kink),
        }
    }

    /// The motions for one increment: on both sides if their derivatives agree, or on one if the
    /// events of the other side are others.
    fn with_step(value: f64, step: f64, beside: &Beside<'_>) -> Slope {
        let central = beside.with(CENTRAL, value, step);
        if let Some(found) = central.filter(|found| found.likeness == Likeness::Same) {
            return Slope::Of(found);
        }
        let sides = [step, -step].map(|step| beside.with(ONE_SIDED, value, step));
        match sides {
            [Some(up), Some(down)] => {
                let Some((timeless, apart)) = up.apart_from(&down, beside.here, step) else {
                    return Slope::None;
                };
                if apart == [0.0; 3] {
                    return Slope::Of(up.and(down, timeless));
                }
                match (up.likeness, down.likeness) {
                    (Likeness::Same, Likeness::Crossed(_)) => Slope::Of(up),
                    (Likeness::Crossed(_), Likeness::Same) => Slope::Of(down),
                    // Shorter increments may leave the order as it is.
                    (Likeness::Crossed(time), _) | (_, Likeness::Crossed(time)) => {
                        beside.reason.replace(NotDifferentiable::Order { time });
                        Slope::None
                    }
                    (Likeness::Parted(time), _) | (_, Likeness::Parted(time)) => {
                        Slope::Differs(apart, time)
                    }
                    _ => Slope::None,
                }
            }
            [Some(one), None] | [None, Some(one)] => match one.likeness {
                Likeness::Crossed(_) => Slope::None,
                _ => Slope::Of(one),
            },
            [None, None] => Slope::None,
        }
    }

    /// The mean of the derivatives of both sides.
    fn and(mut self, other: Self, timeless: Vec<usize>) -> Self {
        self.timeless = timeless;
        self.groups.join(&other.groups);
        self.parts.extend(other.parts);
        self.parts.iter_mut().for_each(|part| part.0 *= 0.5);
        self
    }

    /// The events whose times have other derivatives on another side, for an increment; and by how
    /// much the derivatives of displacements, velocities and memory variables differ.
    fn apart_from(&self, other: &Self, here: &Run, step: f64) -> Option<(Vec<usize>, [f64; 3])> {
        let mut groups = self.groups.clone();
        groups.join(&other.groups);
        let probe = |of: &Self| of.derivative(|run| run.probe(here, &groups));
        let (a, b) = (probe(self)?, probe(other)?);
        let apart = here.kinds().map(|(kind, size)| {
            let [a, b] = [&a, &b].map(|of| of.rows_range(kind.clone()));
            let least = APART * a.amax().max(b.amax()) + ROUNDING * size / step;
            (a - b).map(|apart| {
                if apart.abs() <= least {
                    0.0
                } else {
                    apart.abs()
                }
            })
        });
        let [times, states @ ..] = apart;
        let timeless = times.iter().enumerate();
        let timeless = timeless.filter(|(_, apart)| **apart != 0.0).map(|(i, _)| i);
        Some((timeless.collect(), states.map(|apart| apart.amax())))
    }

    /// The derivative of the state at a time.
    pub(super) fn at(&self, here: &Run, time: f64) -> Option<DVector<f64>> {
        let passed = self.groups.before(here.passed(time));
        let Some(event) = self.smooth_beside(here, time) else {
            return self.derivative(|run| run.vector_at(passed, time));
        };
        // At one time before or after the event of each motion: x(t + Δt) − x' Δt.
        let of = |run: &Run| run.events[event].time;
        let moved = self.derivative(|run| run.vector_at(passed, time + (of(run) - of(here))))?;
        let later = self.derivative(|run| Some(DVector::from_element(1, of(run))))?;
        Some(moved - here.rates_at(passed, time)? * later[0])
    }

    /// The smooth event that lies on both sides of a time in these motions.
    fn smooth_beside(&self, here: &Run, time: f64) -> Option<usize> {
        let smooth = (0..here.events.len()).filter(|&event| here.is_smooth(event));
        let mut smooth = smooth.filter(|event| !self.timeless.contains(event));
        smooth.find(|&event| {
            let now = here.events[event].time;
            let later = self
                .parts
                .iter()
                .map(|(_, run)| run.events[event].time - now);
            let farthest = later.clone().fold(0.0, |most: f64, by| most.max(by.abs()));
            let mut inside = later.map(|by| (here.begin..=here.end).contains(&(time + by)));
            (time - now).abs() <= farthest && inside.all(|is_inside| is_inside)
        })
    }

    /// The difference of the derivatives of both sides, by formulas of second order with the
    /// motions of the central formula; `None` if there is only one side.
    fn kink(&self, here: &Run, step: f64) -> Option<DVector<f64>> {
        let [far_down, down, up, far_up] = &self.parts[..] else {
            return None;
        };
        let at = |run: &Run| run.probe(here, &self.groups);
        let near = at(&down.1)? + at(&up.1)?;
        let far = at(&far_down.1)? + at(&far_up.1)?;
        Some((near * 4.0 - far - at(here)? * 6.0) / (2.0 * step))
    }

    /// The derivative of a quantity of the motions.
    pub(super) fn derivative(
        &self,
        of: impl Fn(&Run) -> Option<DVector<f64>>,
    ) -> Option<DVector<f64>> {
        // The weights sum to 0: what does not change has the derivative 0 to the bit.
        let first = of(&self.parts.first()?.1)?;
        let mut sum = &first * 0.0;
        for (weight, run) in &self.parts {
            sum += (of(run)? - &first) * *weight;
        }
        Some(sum)
    }
}

/// A derivative, and its difference from that of an increment four times as large.
struct Candidate {
    found: Variation,
    step: f64,
    probe: DVector<f64>,
    error: DVector<f64>,
}

impl Candidate {
    /// Events whose times do not converge have none: a stop that only just happens begins and ends
    /// at times that change with the root of the parameter. The error is that of the others.
    fn judged(mut self, here: &Run) -> Self {
        let [(times, size), ..] = here.kinds();
        let largest = self.probe.rows_range(times.clone()).amax();
        let most = DIVERGED * largest + ROUNDING * size / self.step;
        let timeless = &mut self.found.timeless;
        for time in times {
            if self.error[time].abs() > most && !timeless.contains(&time) {
                timeless.push(time);
            }
        }
        for &time in timeless.iter() {
            [self.error[time], self.probe[time]] = [0.0; 2];
        }
        self
    }

    /// The differences of the derivatives of displacements, velocities and memory variables between
    /// the increments, or between both sides; 0 for a smooth family.
    fn roughness(&self, here: &Run) -> [f64; 3] {
        let kink = self.found.kink(here, self.step);
        let [_, states @ ..] = here.kinds();
        states.map(|(kind, size)| {
            let of = |numbers: &DVector<f64>| numbers.rows_range(kind.clone()).amax();
            let (largest, error) = (of(&self.probe), of(&self.error));
            let kink = kink.as_ref().map_or(0.0, of);
            let rounding = ROUNDING * size / self.step;
            let converges = error <= DIVERGED * largest + rounding;
            if converges && kink <= APART * largest + rounding + ERRORS * error {
                0.0
            } else {
                kink.max(error)
            }
        })
    }
}
