//! Pseudo-arclength steps along a branch, and its ends.

use nalgebra::DVector;

use super::bifurcations::{Changes, FoundBifurcation, Signs};
use super::branch::{BifurcationKind, BranchEnd};
use super::branch_equations::{Curve, Solved};
use super::branch_predictor::{CurvePoint, LocalCurve};
use super::discontinuity::LARGE;
use super::event_sequence::Sequence;
use super::hopf_point::hopf_point;
use super::locus::tangential_end::tangential_end;
use super::lost_symmetry::{SYMMETRIC, departures};
use super::periodic_orbit::Closed;
use super::phase_condition::FrozenStart;
use crate::error::Error;
use crate::motion::Segment;
use crate::numerics::trace::{Chord, Plane, at_zero};

/// One half of a branch.
pub(super) struct Walk<'v, 'f> {
    pub(super) curve: &'v Curve<'f>,
    /// Scales of the unknowns of the first motion.
    pub(super) first_scale: DVector<f64>,
    pub(super) points: Vec<Left>,
    /// The point before the last one, with its tangent in units of the present scales; `None` if
    /// the curve may have a corner between the two.
    pub(super) before: Option<Solved>,
    pub(super) found: Vec<Change>,
    /// The points of the other half, if it is known.
    pub(super) other_half: &'v [Left],
    /// The signs of the test functions beside the first motion: those in the other half when the
    /// walk begins, then those in this half. At a bifurcation the first motion itself has none.
    pub(super) signs: Signs,
    /// True if the curve returned to its first motion: this half is the whole of it.
    pub(super) is_ring: bool,
}

/// A bifurcation: the number of points before it, except the first, its kind, its parameter and its
/// motion.
pub(super) type Change = (usize, BifurcationKind, f64, Closed);

/// A point that the walk has left behind: what ends and corners of the curve ask of it, and the
/// result. Its steps and matrices fill a hundred times as much.
pub(super) struct Left {
    y: DVector<f64>,
    begin: FrozenStart,
    sequence: Sequence,
    growth: f64,
    /// What it misses of each symmetry.
    departures: Vec<f64>,
    pub(super) parameter: f64,
    pub(super) closed: Closed,
}

impl Left {
    pub(super) fn new(curve: &Curve<'_>, solved: &Solved) -> Result<Self, Error> {
        Ok(Self {
            y: solved.y.clone(),
            begin: solved.begin.clone(),
            sequence: solved.sequence.clone(),
            growth: solved.trial.map.growth(),
            departures: departures(curve, solved),
            parameter: curve.parameter(&solved.y),
            closed: curve.closed(solved)?,
        })
    }
}

/// The longest step, in units of the range and of the sizes of the motion.
const LONGEST: f64 = 1.0 / 64.0;

/// The shortest step of a motion that magnifies nothing.
const SHORTEST: f64 = 1e-9;

/// The least cosine of the angle between the tangents at neighbouring points.
const STRAIGHT: f64 = 0.97;

/// Scales do not fall below this part of those of the first motion, so that a motion can shrink to
/// a point in a finite number of steps.
const LEAST_SIZE: f64 = 0.01;

/// A displacement or velocity counts in units of at most so many of its extents, so that a motion
/// far from the origin of its coordinates is followed in steps of its own size.
const MOST_EXTENTS: f64 = 8.0;

/// An extent below this part of the size is no measure of a distance: Newton's method reaches such
/// differences by rounding.
const STILL: f64 = 1e-9;

/// More Newton steps than this keep the next step along the curve from growing.
const MANY_STEPS: usize = 5;

/// Sizes, as parts of a shrinking motion, from which the Hopf point is extrapolated.
const HOPF_PARTS: [f64; 4] = [1.0, 0.5, 0.25, 0.125];

/// The error of this extrapolation, in units of the range, is less than this: the parameters of
/// motions that hardly grow are known to fewer digits than others, in a narrow range to 1e-6 of it.
const HOPF_ERROR: f64 = 1e-5;

/// The magnification of perturbations above which an arrival may be tangential, and the least ratio
/// to its value at an earlier point.
const GRAZING_GROWTH: f64 = 1e3;
const GRAZING_RISE: f64 = 0.3;

/// A curve is normal to the parameter if the parameter's part in its tangent is at most this, and
/// the distance from a grazing point that may be the reason.
const UPRIGHT: f64 = 1e-3;

/// A tangential release is extrapolated from so many motions at most; the derivative of each is at
/// least this factor smaller than that of the next.
const RELEASE_MOTIONS: usize = 5;
const APART: f64 = 1.5;

/// Motions on one plane are the same if they are closer than this, in units of the scales.
const SAME: f64 = 1e-6;

/// Largest distance of a motion from the chord between its neighbours on a curve, as a part of the
/// chord: tangents at neighbouring points enclose 14 degrees at most.
const BESIDE_CHORD: f64 = 0.1;

/// Place of the last motion before a jump, as a part of the distance of the jump.
const BESIDE: f64 = 0.99;

/// If the acceleration at the start of an autonomous motion falls below this part of its former
/// value, the motion has stopped.
const AT_REST: f64 = 1e-6;

/// The outcome of a step.
enum Outcome {
    Next(CurvePoint, Vec<FoundBifurcation>),
    Last(CurvePoint, Vec<FoundBifurcation>),
    Jump(CurvePoint, Vec<FoundBifurcation>, BranchEnd),
    End(BranchEnd),
    Change(Vec<FoundBifurcation>, BranchEnd),
}

impl Walk<'_, '_> {
    /// The scales of the unknowns.
    pub(super) fn scale(&self, solved: &Solved) -> DVector<f64> {
        let mut scale = natural_scale(self.curve, solved);
        let last = scale.len() - 1;
        for (scale, first) in scale.iter_mut().zip(&self.first_scale).take(last) {
            *scale = scale.max(LEAST_SIZE * first);
        }
        scale
    }

    /// Walks from a point in the direction of its tangent, which is in units of the first scales.
    pub(super) fn run(&mut self, first: &Solved) -> Result<BranchEnd, Error> {
        let mut base = first.clone();
        let mut second = None;
        let (parameter, range) = (self.curve.parameter(&base.y), &self.curve.range);
        let rises = base.tangent[self.curve.unknowns() - 1] > 0.0;
        if parameter == if rises { range.end } else { range.start } {
            return Ok(BranchEnd::Range);
        }
        let mut scale = self.first_scale.clone();
        let mut signs = std::mem::replace(&mut self.signs, [0.0; 4]);
        let mut step = 0.25 * LONGEST;
        let mut is_known = false;
        for _ in 0..self.curve.work.most.1 {
            if self.curve.work.is_at_limit() {
                break;
            }
            let (outcome, next_step) = self.step(&base, &scale, step, &mut signs);
            if let (None, Outcome::Next(place, found) | Outcome::Last(place, found)) =
                (&second, &outcome)
            {
                self.signs = signs_beside(&base, &place.solved, found, signs);
            }
            let place = match outcome {
                Outcome::Next(place, found) => {
                    self.add(found)?;
                    place
                }
                Outcome::Last(place, found) => {
                    self.add(found)?;
                    self.leave(&place.solved)?;
                    return Ok(BranchEnd::Range);
                }
                Outcome::Jump(place, found, end) => {
                    self.add(found)?;
                    self.points.push(Left::new(self.curve, &place.solved)?);
                    return Ok(end);
                }
                Outcome::End(end) => return Ok(end),
                Outcome::Change(found, end) => {
                    self.add(found)?;
                    return Ok(end);
                }
            };
            step = next_step;
            let second = second.get_or_insert_with(|| place.solved.clone());
            if self.came_back([first, second], &base, &place.solved) {
                self.is_ring = true;
                return Ok(BranchEnd::Closed);
            }
            let was_known = std::mem::replace(&mut is_known, self.knows(&place.solved, &scale));
            if is_known && was_known {
                // The curve runs into itself.
                self.points.pop();
                return Ok(BranchEnd::Closed);
            }
            self.leave(&place.solved)?;
            let before = std::mem::replace(&mut base, place.solved);
            if let Some((moved, moved_scale)) = self.moved(&before, &base) {
                (base, scale, self.before) = (moved, moved_scale, None);
                continue;
            }
            let next_scale = self.scale(&base);
            let in_new_units = |mut solved: Solved| {
                solved.tangent.component_mul_assign(&scale);
                solved.tangent.component_div_assign(&next_scale);
                solved
            };
            base = in_new_units(base);
            base.tangent.normalize_mut();
            self.before = Some(in_new_units(before)).filter(|before| before.is_like(&base));
            scale = next_scale;
        }
        Ok(self.curve.end_at_limit(&base))
    }

    fn add(&mut self, found: Vec<FoundBifurcation>) -> Result<(), Error> {
        let (curve, before) = (self.curve, self.points.len());
        for FoundBifurcation { kind, solved, .. } in found {
            let closed = curve.closed(&solved)?;
            self.found
                .push((before, kind, curve.parameter(&solved.y), closed));
        }
        Ok(())
    }

    fn leave(&mut self, solved: &Solved) -> Result<(), Error> {
        let left = Left::new(self.curve, solved)?;
        self.curve.work.watched.found(left.parameter);
        self.points.push(left);
        Ok(())
    }

    /// One step, shortened until it succeeds, and the length of the next one.
    fn step(
        &self,
        base: &Solved,
        scale: &DVector<f64>,
        longest: f64,
        signs: &mut Signs,
    ) -> (Outcome, f64) {
        let mut length = longest;
        let shortest = shortest_step(base);
        let here = CurvePoint {
            distance: 0.0,
            solved: base.clone(),
        };
        let view = LocalCurve {
            curve: self.curve,
            base,
            scale,
        };
        loop {
            let mut tried = *signs;
            match self.tried(&view, &here, length, &mut tried) {
                Ok(outcome) => {
                    *signs = tried;
                    let longer = match &outcome {
                        Outcome::Next(place, _) if place.solved.steps >= MANY_STEPS => length,
                        _ => 1.5 * length,
                    };
                    return (outcome, longer.min(LONGEST));
                }
                Err(_) if self.curve.work.watched.is_stopped() => {
                    return (Outcome::End(self.curve.end_at_limit(base)), length);
                }
                Err(error) if length <= shortest => {
                    return self.behind(&view, &here, shortest, signs, error);
                }
                Err(_) if self.curve.work.is_at_limit() => {
                    let end = self.grazing(base);
                    return (end.unwrap_or(Outcome::End(BranchEnd::Work)), length);
                }
                Err(_) => length *= 0.5,
            }
        }
    }

    /// The outcome if no step, however short, succeeds: a corner, or the end and its reason.
    fn behind(
        &self,
        view: &LocalCurve<'_, '_>,
        here: &CurvePoint,
        shortest: f64,
        signs: &mut Signs,
        error: Error,
    ) -> (Outcome, f64) {
        let mut end = self.grazing(view.base);
        // At a smaller distance a change of the events may be rounding.
        let distinct = SHORTEST * view.base.trial.map.growth();
        if end.is_none()
            && let Some(mut jump) = view.discontinuity(distinct)
        {
            if let BranchEnd::Discontinuity { parameter, .. } = &mut jump.end
                && let Some(exact) = self.tangential_release(view.base)
            {
                *parameter = exact;
            }
            if jump.size > LARGE {
                // The last motion lies nearer to the jump than the shortest step.
                let last = self.tried(view, here, BESIDE * jump.distance, signs);
                let outcome = match last {
                    Ok(Outcome::Next(place, found)) => Outcome::Jump(place, found, jump.end),
                    _ => Outcome::End(jump.end),
                };
                return (outcome, shortest);
            }
            end = Some(Outcome::End(jump.end));
        }
        if let Some((place, found)) = view.corner()
            && !self.knows(&place.solved, view.scale)
        {
            *signs = [0.0; 4];
            let length = view.apart(here, &place);
            let mut found = Vec::from_iter(found);
            let outcome = match self.birth(view, [here, &place], &mut found) {
                Some(birth) => Outcome::Change(found, birth),
                None => Outcome::Next(place, found),
            };
            return (outcome, length.min(LONGEST));
        }
        if self.curve.work.watched.is_stopped() {
            end = Some(Outcome::End(self.curve.end_at_limit(view.base)));
        }
        let parameter = self.curve.parameter(&view.base.y);
        let lost = Outcome::End(BranchEnd::Lost { parameter, error });
        (end.unwrap_or(lost), shortest)
    }

    /// Returns true if a motion lies on a piece of the curve that was followed before, in either
    /// half: between two of its points, on one plane across their chord with it. The events of one
    /// of them are the same; the other may lie beyond a change.
    fn knows(&self, motion: &Solved, scale: &DVector<f64>) -> bool {
        let curve = self.curve;
        let parameter = curve.parameter(&motion.y);
        let pairs = self.points.windows(2).chain(self.other_half.windows(2));
        let mut pairs = pairs.filter(|pair| {
            let [low, high] = [&pair[0], &pair[1]].map(|point| point.parameter);
            let is_between = low.min(high) <= parameter && parameter <= low.max(high);
            let mut sequences = pair.iter().map(|point| &point.sequence);
            is_between && sequences.any(|sequence| sequence.is_like(&motion.sequence))
        });
        pairs.any(|pair| {
            // Begun in another of its periods a motion is another point of the curve.
            let begun = |point: &Left| {
                if curve.is_free() || point.begin.phase == motion.begin.phase {
                    return Some(point.y.clone());
                }
                let point = curve.guess_at(point.y.clone(), point.begin.clone()).ok()?;
                curve.seen(&point, &motion.begin).into_iter().next()
            };
            let (Some(low), Some(high)) = (begun(&pair[0]), begun(&pair[1])) else {
                return false;
            };
            let chord = Chord::new([&low, &high], scale);
            let (part, beside) = chord.place(&motion.y);
            if !((0.0..=1.0).contains(&part) && beside <= BESIDE_CHORD) {
                return false;
            }
            let plane = chord.plane_through(&motion.y);
            let found = curve.solve(&chord.at(part), motion, &plane);
            found.is_ok_and(|found| (found.y - &motion.y).component_div(scale).amax() <= SAME)
        })
    }

    /// The guess for a step: by the two-step formula of Adams and Bashforth from the tangents at
    /// the last two points, or on the tangent. What the equations do not determine stays as it is.
    fn predicted(&self, view: &LocalCurve<'_, '_>, length: f64) -> DVector<f64> {
        let (base, along) = (view.base, &view.base.tangent);
        let mut slope = base.tangent.clone();
        if let Some(before) = &self.before {
            let distance = along.dot(&(view.scaled(base) - view.scaled(before)));
            let slope_before = &before.tangent / along.dot(&before.tangent);
            if distance > 0.0 {
                slope += (&base.tangent - slope_before) * (0.5 * length / distance);
            }
        }
        &base.y + slope.component_mul(view.scale) * length
    }

    fn tried(
        &self,
        view: &LocalCurve<'_, '_>,
        here: &CurvePoint,
        length: f64,
        signs: &mut Signs,
    ) -> Result<Outcome, Error> {
        let (curve, base) = (self.curve, view.base);
        let guess = self.predicted(view, length);
        let parameter = curve.parameter(&guess);
        let range = &curve.range;
        let mut place = if (range.start..=range.end).contains(&parameter) {
            let plane = view.across(base, &base.tangent, length);
            let nearer = curve.nearer(guess.clone(), base, &plane);
            view.at(length, nearer.as_ref().unwrap_or(&guess), base)?
        } else {
            let end = parameter.clamp(range.start, range.end);
            let part = (end - curve.parameter(&base.y)) / (parameter - curve.parameter(&base.y));
            let guess = &base.y + (&guess - &base.y) * part;
            view.with_parameter(end, &guess, base)?
        };
        let parameter = curve.parameter(&place.solved.y);
        if !(range.start..=range.end).contains(&parameter) {
            let end = parameter.clamp(range.start, range.end);
            place = view.with_parameter(end, &place.solved.y, &place.solved)?;
        }
        let is_last = [range.start, range.end].contains(&curve.parameter(&place.solved.y));
        let turned = Curve::speed(&place.solved) / Curve::speed(base);
        // Rounding decides the parameter of a motion much smaller than the last one: it leads to
        // the Hopf point itself.
        let smallest = HOPF_PARTS[HOPF_PARTS.len() - 1];
        if turned <= smallest
            && let Some(end) = self.hopf(view, here, &place)
        {
            return Ok(end);
        }
        if turned < -AT_REST {
            return Err(curve.lost(&place.solved.y, &place.solved.trial));
        }
        if turned <= AT_REST {
            // Newton's method has converged to an equilibrium, which is periodic with any period.
            return Err(Error::AtRest.at("parameter", parameter));
        }
        let moved = view.scaled(&place.solved) - view.scaled(base);
        let direction = &base.tangent;
        // The force of an elastic contact that slips at the start follows its limit.
        let sideways = base
            .trial
            .map
            .without_idle(&moved - direction * place.distance);
        let straight = place.solved.tangent.dot(direction) >= STRAIGHT
            && sideways.norm() <= 0.5 * place.distance;
        // A curve may turn sharply where the events change.
        let same = base.is_like(&place.solved);
        let allowed = straight || (!same && sideways.norm() <= 2.0 * LONGEST);
        let map = &place.solved.trial.map;
        let stays = map.has_positions_of(&base.trial.map, view.scale);
        if !(allowed && stays && place.distance > 0.0) {
            return Err(curve.lost(&place.solved.y, &place.solved.trial));
        }
        let Changes {
            mut found,
            last_change,
        } = view.changes(here, &place, signs)?;
        if let Some(birth) = self.birth(view, [here, &place], &mut found) {
            return Ok(Outcome::Change(found, birth));
        }
        if is_last {
            return Ok(Outcome::Last(place, found));
        }
        // Nearer to a change of events Newton's method cannot tell its two sides apart, and a curve
        // that turns back there would seem to go on.
        let near = |change: f64| place.distance - change < shortest_step(&place.solved);
        if last_change.is_some_and(near) {
            return Err(curve.lost(&place.solved.y, &place.solved.trial));
        }
        Ok(Outcome::Next(place, found))
    }

    /// The end at a change of events at which the branch is born, if there is one between two
    /// places, and only what is found up to there.
    ///
    /// So near its birth the first of these places may have the symmetry to rounding that motions
    /// before it lack.
    fn birth(
        &self,
        view: &LocalCurve<'_, '_>,
        [here, place]: [&CurvePoint; 2],
        found: &mut Vec<FoundBifurcation>,
    ) -> Option<BranchEnd> {
        let base = &here.solved;
        let birth = view.birth((here, place), base, found).or_else(|| {
            let own = departures(self.curve, base).into_iter().enumerate();
            let mut hidden = own.filter(|(_, missed)| *missed <= SYMMETRIC);
            hidden.find_map(|(symmetry, _)| {
                let before = self.points.iter().rev();
                let mut alike = before.take_while(|point| point.sequence.is_like(&base.sequence));
                let lacks = alike.find(|point| point.departures[symmetry] > SYMMETRIC)?;
                let lacks = self.curve.guess_at(lacks.y.clone(), lacks.begin.clone());
                view.birth((here, place), &lacks.ok()?, found)
            })
        })?;
        found.truncate(birth + 1);
        let parameter = self.curve.parameter(&found[birth].solved.y);
        Some(BranchEnd::Birth { parameter })
    }

    /// The Hopf point between two places, or just beyond them, if the motion shrinks to a point
    /// there.
    ///
    /// The parameter is an even analytic function of the acceleration at the start: its value at 0
    /// is that of the polynomial through four smaller motions. It leads to the zero of the growth
    /// rate of steady sliding, which must confirm a point beyond the places.
    fn hopf(
        &self,
        view: &LocalCurve<'_, '_>,
        here: &CurvePoint,
        beyond: &CurvePoint,
    ) -> Option<Outcome> {
        /// Places in a step at which the velocity is evaluated: a step may take half a period.
        const PLACES: u32 = 8;
        let curve = view.curve;
        let turn = |place: &CurvePoint| Curve::speed(&place.solved);
        // The largest velocity itself, because the sizes do not fall below rounding of the
        // displacements.
        let speed = |place: &CurvePoint| {
            let condition = place.solved.begin.condition.as_ref()?;
            let turning = condition.turning.as_ref()?;
            let states = place.solved.trial.map.steps.iter().flat_map(|step| {
                let times =
                    (1..=PLACES).map(|i| step.duration() * (f64::from(i) / f64::from(PLACES)));
                times.map(|time| step.state_at(time))
            });
            let speeds = states.map(|state| turning.of_velocities(|j| state.velocities[j]).abs());
            Some(speeds.fold(0.0, f64::max))
        };
        let whole = turn(here);
        let mut near = here.clone();
        let slope = (turn(beyond) - whole) / beyond.distance;
        let mut known: Vec<[f64; 2]> = Vec::new();
        for part in HOPF_PARTS {
            let distance = (part - 1.0) * whole / slope;
            if distance > 0.0 {
                near = view.between(&near, beyond, distance).ok()?;
            }
            // If a motion shrinks, its turning point and its velocity shrink in proportion; if only
            // the turning point moves, they do not.
            let in_proportion = (turn(&near) / whole / part - 1.0).abs() < 0.3;
            if !(in_proportion && speed(&near)? < 2.0 * part * speed(here)?) {
                return None;
            }
            known.push([turn(&near).powi(2), curve.parameter(&near.solved.y)]);
        }
        let extrapolated = at_zero(&mut known);
        let unit = curve.width();
        let exact = hopf_point(&|value| curve.spectrum(value), extrapolated, unit).ok();
        let exact = exact.map(|(exact, _)| exact);
        let exact = exact.filter(|exact| (exact - extrapolated).abs() <= HOPF_ERROR * unit);
        let parameter = exact.or((turn(beyond) < 0.0).then_some(extrapolated))?;
        Some(Outcome::End(BranchEnd::Hopf { parameter }))
    }

    /// Returns true if the derivative of the map is large at a point, and smaller before it.
    fn magnifies_more(&self, base: &Solved) -> bool {
        let last = base.trial.map.growth();
        let mut before = self.points.iter().rev().map(|point| point.growth);
        last >= GRAZING_GROWTH && before.any(|before| before < GRAZING_RISE * last)
    }

    /// The parameter behind a point at which a release becomes tangential, if there is one.
    ///
    /// There the derivative of the map grows like 1/ρ, with the rate ρ at which the force in stick
    /// reaches its limit. The motion is a smooth function of ρ, whose polynomial through the last
    /// motions has a value at ρ = 0. The tangent of the curve does not show this place: along it
    /// the force keeps to its limit to first order.
    fn tangential_release(&self, base: &Solved) -> Option<f64> {
        if !self.magnifies_more(base) {
            return None;
        }
        let growth = base.trial.map.growth();
        let mut known = vec![[growth.recip(), self.curve.parameter(&base.y)]];
        let points = self.points.iter().rev();
        let alike = points.take_while(|point| point.sequence.is_like(&base.sequence));
        for point in alike.map(|point| [point.growth.recip(), point.parameter]) {
            let nearest = known[known.len() - 1];
            if point[0] >= APART * nearest[0] && known.len() < RELEASE_MOTIONS {
                known.push(point);
            }
        }
        let count = known.len();
        if count < 3 {
            return None;
        }
        let [rough, exact] = [count - 1, count].map(|n| at_zero(&mut known[..n].to_vec()));
        let [_, last] = known[0];
        ((exact - rough).abs() <= 0.1 * (exact - last).abs()).then_some(exact)
    }

    /// The grazing point at which the curve ends behind a point, if there is one.
    ///
    /// As an arrival at the belt becomes tangential, the derivative of the map grows like 1/ρ, ρ
    /// the rate of the relative velocity at arrival. It does not grow where nothing depends on the
    /// time of the arrival but a memory of it. This varies like the square root of the distance:
    /// the curve becomes normal to the parameter.
    fn grazing(&self, base: &Solved) -> Option<Outcome> {
        let is_upright = base.tangent[self.curve.unknowns() - 1].abs() <= UPRIGHT;
        if !(is_upright || self.magnifies_more(base)) {
            return None;
        }
        let (parameter, trial, begin) = tangential_end(self.curve, base)?;
        let apart = (parameter - self.curve.parameter(&base.y)).abs();
        if is_upright && apart > UPRIGHT * self.curve.width() {
            return None;
        }
        let mut solved = base.clone();
        (solved.trial, solved.begin) = (trial, begin);
        let last = self.curve.unknowns() - 1;
        solved.y[last] = parameter;
        let found = FoundBifurcation {
            distance: 0.0,
            kind: BifurcationKind::Grazing,
            solved,
        };
        Some(Outcome::Change(
            vec![found],
            BranchEnd::Grazing { parameter },
        ))
    }

    /// Returns true if the curve has returned to its first motion, in the direction in which it
    /// left. A motion over several periods of the drives may return with another of them first.
    fn came_back(&self, [first, second]: [&Solved; 2], base: &Solved, next: &Solved) -> bool {
        if self.points.len() < 3 {
            return false;
        }
        let way = Chord::new([&base.y, &next.y], &self.first_scale);
        let seen = |solved| self.curve.seen(solved, &base.begin);
        let seconds = seen(second);
        seen(first).iter().any(|point| {
            let left = |second: &DVector<f64>| (second - point).component_div(&self.first_scale);
            let ways = seconds.iter().map(left);
            let nearest = ways.min_by(|a, b| a.norm().total_cmp(&b.norm()));
            nearest.is_some_and(|left| way.passes(point, &left))
        })
    }

    /// Gives the motion another start, and the scales there, if an event has come near its start,
    /// or it hardly passes the phase condition any more. The way from the point before it
    /// determines the direction.
    fn moved(&self, before: &Solved, base: &Solved) -> Option<(Solved, DVector<f64>)> {
        let (curve, trial) = (self.curve, &base.trial);
        let (start, begin) = base.begin.moved(&trial.map, trial.period)?;
        let guess = curve.guess(&start, (trial.period, curve.parameter(&base.y)), begin);
        let guess = guess.ok()?;
        let scale = self.scale(&guess);
        let ways = curve.seen(before, &guess.begin).into_iter();
        let ways = ways.map(|from| (&guess.y - from).component_div(&scale));
        let way = ways.min_by(|a, b| a.norm().total_cmp(&b.norm()))?;
        let along = way.try_normalize(0.0)?;
        let plane = Plane::beyond(&guess.y, 0.0, along.clone(), &along, &scale);
        let solved = curve.solve(&guess.y, &guess, &plane).ok()?;
        Some((solved, scale))
    }
}

/// The signs of the test functions beside the first motion, from those after the first step: none
/// if the events change in between. A fold found in this step changes two of them, and the other
/// half must not find it again.
fn signs_beside(first: &Solved, next: &Solved, found: &[FoundBifurcation], signs: Signs) -> Signs {
    let [along, folds, flips, tori] = signs;
    if !first.is_like(next) {
        return [0.0; 4];
    }
    let is_fold = |found: &FoundBifurcation| found.kind == BifurcationKind::Fold;
    if found.iter().any(is_fold) {
        return [0.0, 0.0, flips, tori];
    }
    [along, folds, flips, tori]
}

/// The shortest step from a point. The map magnifies rounding errors, so points at a much smaller
/// distance cannot be distinguished.
fn shortest_step(solved: &Solved) -> f64 {
    SHORTEST * solved.trial.map.growth().sqrt()
}

/// The scales of the unknowns at a point: those of its state, its period and the range. In these
/// units a coordinate counts by its share of the energy. Coordinates that hardly move, such as
/// higher modes of a beam, change much from motion to motion and are not a good measure of the
/// distance.
pub(super) fn natural_scale(curve: &Curve<'_>, solved: &Solved) -> DVector<f64> {
    let map = &solved.trial.map;
    let (extents, sizes) = (map.extents(), map.sizes());
    let (n, unknowns, mobilities) = (curve.n, curve.unknowns(), &curve.mobilities);
    // Displacements, velocities and forces of the energy of the largest one.
    let of_kind = |first: usize, mobility: f64| {
        let largest = |numbers: &DVector<f64>| {
            let of = |j: usize| numbers[first + j] * (mobility / mobilities[j]);
            (0..n).map(of).fold(0.0, f64::max)
        };
        match (largest(&sizes), largest(&extents)) {
            (size, extent) if extent <= STILL * size => size,
            (size, extent) => size.min(MOST_EXTENTS * extent),
        }
    };
    DVector::from_fn(unknowns, |i, _| match i {
        i if i < n => of_kind(0, mobilities[i]),
        i if i < 2 * n => of_kind(n, mobilities[i - n]),
        i if i < curve.order => match mobilities[i - n] {
            0.0 => sizes[i],
            mobility => sizes[i].max(of_kind(n, mobility)),
        },
        i if i + 1 < unknowns => solved.trial.period,
        _ => curve.width(),
    })
}
