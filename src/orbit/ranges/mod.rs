//! The attractors over a range of a parameter, with the bifurcations between them.

mod found;
mod same_motion;

use std::cell::Cell;
use std::ops::Range;

pub use self::found::{Border, VibrationRange, VibrationRanges};
use self::same_motion::{extent, in_positions, is_on, is_one, is_same};
use super::attractor::{Attractor, kind_of};
use super::branch::{BifurcationKind, Branch, BranchEnd, BranchPoint};
use super::hopf::{Crossing, Standing, SteadyAlong, steady_along};
use super::oscillator::{Oscillator, Systems};
use super::periodic_orbit::Orbit;
use super::sweep::SweepPoint;
use crate::error::Error;
use crate::motion::sealed::State as _;
use crate::motion::{AttractorKind, SystemState};
use crate::numerics::bracket::border;
use crate::numerics::sort::sort_by;
use crate::search::Search;
use crate::state::structure::State;

/// Intervals of the range at whose ends the system is swept.
const SWEPT: usize = 16;

/// Intervals into which the range is divided in the search for changes of stability of steady
/// sliding.
const INTERVALS: usize = 256;

/// Borders that lie closer together, in parts of the range, are one.
const SAME: f64 = 1e-9;

/// The end of a branch is this near the exact Hopf point, or the border of the systems, at which
/// it ends, in parts of the range.
const NEAR: f64 = 1e-6;

/// Ranges wider than this part of the whole are searched once more where no attractor is known, or
/// one ends at a border; and so are those that are left, as often.
const WIDE: f64 = 1e-4;
const ROUNDS: usize = 3;

/// Motions below this part of the largest extent on a branch are the Hopf point near them: a fold
/// of such a motion lies A⁴ ~ 1e-12 of the range from it, less than rounding of the small motion.
const SMALL: f64 = 1e-3;

/// The attractors of a system over a range of a parameter: the ranges of steady sliding, of
/// vibration, and of hysteresis, with the critical values between these ranges. In a range of
/// hysteresis there are several attractors, and the past of the motion decides between them.
///
/// `family` returns the system for a value of the parameter. Three searches find periodic motions.
/// One is a [`sweep`](super::sweep()) from rest over 17 equidistant values, upward and downward.
/// Another starts from rest at each of these values. The third searches 256 equal intervals for
/// Hopf points of steady sliding, at which motions [begin](super::begin()); two Hopf points in one
/// interval can be missed. Each motion found that lies on no known
/// branch is [followed](super::follow()) in both directions, through folds, to the ends of its
/// branch. The end of stick-slip is therefore the fold or grazing itself, not the last value at
/// which a simulation showed stick. The branches also contain motions that no simulation from
/// steady sliding reaches.
///
/// A motion that lies on two branches counts once. The motions of a family in which contacts that
/// never slip have different positions count as one. Masses at rest on a branch count as steady
/// sliding or rest, also if drives vary; such motions that differ only in the forces of joints
/// count as one. Bifurcations are exact to about 1e-10 of the range, like those of
/// [`follow`](super::follow()). Hopf points in [`VibrationRange::parameters`] are exact to
/// rounding, because they follow from the eigenvalues of steady sliding. Parameters at which the
/// family returns an error belong to no range; the ranges next to them end with
/// [`Border::NoSystem`]. What any of the searches reaches is reported. Attractors that none of them
/// reaches are missed: another start may lead to another attractor.
///
/// In steady sliding a contact slides if its surface moves; any other contact, such as a joint
/// between masses, sticks, and its force may have any value within its limit. Steady sliding counts
/// where its eigenvalues have no positive real part, as [`Structure::steady_sliding_at`] computes
/// them for masses at rest. (If a load depends on displacements, they are those of the equilibrium
/// in which joints carry only forces that springs cannot carry.) If no contact slides, the
/// equilibrium is [`AttractorKind::Rest`].
///
/// An attractor that a search reaches, and that neither a branch nor these eigenvalues explain, is
/// entered for the whole range around the value: for example chaos ([`AttractorKind::Irregular`]),
/// or a motion whose branch cannot be followed. Steady sliding or rest is also entered between
/// neighbouring values at which it is reached: for example masses at rest under a drive, or a shaft
/// that turns.
///
/// In each range wider than 10⁻⁴ of the whole, further motions are tried at its middle, in up to
/// three rounds: from rest if no attractor is known there, and from the last motion of each stable
/// part of a branch that ends at a border of the range. If no branch explains such a motion, only
/// its kind is entered.
///
/// All starts from rest have displacements and states of 0. A controller whose set point is far
/// from there starts far from its steady state; measure displacements from the set point.
///
/// The work is 17 motions upward, downward and from rest, and one [`follow`](super::follow()) for
/// each branch: seconds for a few masses, tens of seconds for a dozen masses, minutes where a
/// branch folds hundreds of times.
/// [`Search::vibration_ranges`] sets a bound of the work, and accepts a watcher, a function that
/// can stop the search. For a mass on a belt of constant velocity,
/// [`bifurcation::vibration_ranges`](crate::bifurcation::vibration_ranges) is faster, and calls
/// [`limit_cycle::find`](crate::limit_cycle::find()) at each velocity that it tries.
///
/// # Errors
///
/// [`Error::InvalidParameter`] unless the range is finite and not empty; [`Error::At`], with the
/// parameter, if the family returns an error at the start of the range.
///
/// [`Structure::steady_sliding_at`]: crate::Structure::steady_sliding_at
///
/// ```
/// use stick_slip::orbit::{self, AttractorKind, BifurcationKind, Border};
/// use stick_slip::{Contact, Error, Exponential, Structure};
///
/// // A mass on a belt, over the velocity of the belt.
/// let law = Exponential::new(0.4, 0.25, 0.5)?;
/// let mass = |velocity: f64| -> Result<Structure, Error> {
///     Structure::new(&[1.0])?
///         .with_ground_spring(0, 1.0)?
///         .with_ground_damper(0, 0.1)?
///         .with_contact(Contact::new(0, law, 1.0)?.on_belt(velocity))
/// };
/// let found = orbit::vibration_ranges(mass, 0.2..1.0)?;
/// let [vibrates, sticks, slips, quiet] = &found.ranges[..] else { panic!() };
/// assert_eq!(vibrates.attractors, [AttractorKind::StickSlip]);
/// // Hysteresis lasts from the Hopf point to the fold; between them stick-slip ends at a grazing.
/// assert_eq!(sticks.attractors, [AttractorKind::SteadySliding, AttractorKind::StickSlip]);
/// assert_eq!(slips.attractors, [AttractorKind::SteadySliding, AttractorKind::PureSlip]);
/// assert_eq!(quiet.attractors, [AttractorKind::SteadySliding]);
/// let kinds = [BifurcationKind::Grazing, BifurcationKind::Fold];
/// let [grazing, fold] = kinds.map(Border::Bifurcation);
/// assert_eq!(sticks.borders, [Border::Hopf, grazing]);
/// assert_eq!(slips.borders, [grazing, fold]);
/// assert!((sticks.parameters.start - 0.738553461542470176).abs() < 1e-14);
/// assert!((slips.parameters.end - 0.81909955091672).abs() < 1e-12);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "critical value")]
#[doc(alias = "hysteresis")]
pub fn vibration_ranges<S: Oscillator>(
    family: impl Fn(f64) -> Result<S, Error>,
    range: Range<f64>,
) -> Result<VibrationRanges<S::State>, Error> {
    Search::new().vibration_ranges(family, range)
}

impl Search<'_> {
    /// The attractors over a range of a parameter: [`vibration_ranges`], within the bounds of this
    /// search.
    ///
    /// A search that is stopped returns what it has found so far, and [`VibrationRanges::stopped`]
    /// says so. If the search is stopped, or a branch ends with
    /// [`BranchEnd::Work`](super::BranchEnd::Work), attractors may be missing from the ranges, and
    /// a motion may count twice.
    ///
    /// # Errors
    ///
    /// The errors of [`vibration_ranges`].
    pub fn vibration_ranges<S: Oscillator>(
        &self,
        family: impl Fn(f64) -> Result<S, Error>,
        range: Range<f64>,
    ) -> Result<VibrationRanges<S::State>, Error> {
        self.ranges_of(&family, range)
    }

    /// Computes [`vibration_ranges`](Self::vibration_ranges), compiled once for all functions that
    /// give such systems.
    fn ranges_of<S: Oscillator>(
        &self,
        family: &Systems<'_, S>,
        range: Range<f64>,
    ) -> Result<VibrationRanges<S::State>, Error> {
        let names = ["range.start", "range.end"];
        Error::check_range("orbit::vibration_ranges", names, &range)?;
        let Range { start, end } = range;
        let stopped = Cell::new(None);
        let search = self.noting(&stopped);
        let places = |count: usize| -> Vec<f64> {
            let parts = (0..=count).map(|i| i as f64 / count as f64);
            parts
                .map(|part| start * (1.0 - part) + end * part)
                .collect()
        };
        let first = family(start).map_err(|error| error.at("parameter", start))?;
        let rest = State::at_rest(first.form().len());
        let sweep = search.sweep(family, &places(SWEPT), &S::State::of_general(&rest))?;
        let steady = steady_along(family, &places(INTERVALS));
        let systems = systems(family, &places(INTERVALS));
        let at_rest = |parameter: f64| (parameter, rest.clone());
        let starts: Vec<_> = places(SWEPT)[1..].iter().copied().map(at_rest).collect();
        let mut probes = search.reached_from(family, &starts);
        let mut branches: Vec<Branch<S::State>> = Vec::new();
        let swept = sweep.up.iter().chain(&sweep.down).chain(&probes);
        let swept = swept.filter_map(|point| {
            let orbit = point.attractor.as_ref().ok().and_then(Attractor::orbit)?;
            Some((point.parameter, orbit))
        });
        for (parameter, orbit) in swept {
            search.follow_new(family, (parameter, orbit), &(start..end), &mut branches);
        }
        for crossing in steady.crossings.iter().filter(|at| at.frequency > 0.0) {
            if let Ok(born) = search.begin(family, crossing.parameter)
                && (start..=end).contains(&born.parameter)
            {
                let born = (born.parameter, &born.orbit);
                search.follow_new(family, born, &(start..end), &mut branches);
            }
        }
        let known = Known {
            crossings: &steady.crossings,
            systems: &systems,
            near: NEAR * (end - start),
        };
        let mut round = 0;
        loop {
            let mut stretches = steady_stretches(&steady, start..end);
            for branch in &branches {
                search.add_stretches(family, branch, &known, &mut stretches);
            }
            let differ = |parameter: f64, stretches: Vec<&Stretch<'_, S::State>>| {
                search.different(family, parameter, stretches)
            };
            let evidence = |point: &SweepPoint<S::State>| match &point.attractor {
                Ok(Attractor::Rest | Attractor::SteadySliding) => {
                    let system = family(point.parameter).ok();
                    match system.and_then(|system| Standing::of(&system.form())) {
                        // Near a change of its stability a sweep takes an equilibrium that repels
                        // for an attractor.
                        Some(known) if known.repels() => Evidence::None,
                        Some(known) if known.is_only_one() => Evidence::Here,
                        // Under a drive, or with joints in one of many positions.
                        _ => Evidence::Lasting,
                    }
                }
                Ok(_) => Evidence::Here,
                Err(_) => Evidence::None,
            };
            let points: Vec<_> = sweep.up.iter().chain(&sweep.down).chain(&probes).collect();
            let ranges = ranges(&stretches, &points, &systems, start..end, differ, evidence);
            let starts = ranges.iter().flat_map(|found| {
                let part = &found.parameters;
                let middle = 0.5 * (part.start + part.end);
                let is_wide = part.end - part.start > WIDE * (end - start);
                let is_new = probes.iter().all(|point| point.parameter != middle);
                let mut states = Vec::new();
                if is_wide && is_new {
                    states = ending(&stretches, part, SAME * (end - start));
                    states.extend(found.attractors.is_empty().then(|| rest.clone()));
                }
                states.into_iter().map(move |state| (middle, state))
            });
            let starts: Vec<(f64, State)> = starts.collect();
            if starts.is_empty() || round == ROUNDS || stopped.get().is_some() {
                return Ok(VibrationRanges {
                    ranges,
                    branches,
                    sweep,
                    probes,
                    stopped: stopped.get(),
                });
            }
            let tried = search.reached_from(family, &starts);
            for point in &tried {
                if let Some(orbit) = point.attractor.as_ref().ok().and_then(Attractor::orbit) {
                    let found = (point.parameter, orbit);
                    search.follow_new(family, found, &(start..end), &mut branches);
                }
            }
            probes.extend(tried);
            round += 1;
        }
    }

    /// Follows a motion, unless it lies on a known branch.
    fn follow_new<S: Oscillator>(
        &self,
        family: &Systems<'_, S>,
        (parameter, orbit): (f64, &Orbit<S::State>),
        range: &Range<f64>,
        branches: &mut Vec<Branch<S::State>>,
    ) {
        let Ok(system) = family(parameter) else {
            return;
        };
        let form = system.form();
        let mut known = branches.iter();
        if !known.any(|branch| is_on(&form, branch, parameter, orbit))
            && let Ok(branch) = self.follow(family, parameter, orbit, range.clone())
            && !branches.iter().any(|known| is_same(&form, known, &branch))
        {
            branches.push(branch);
        }
    }

    /// Adds the parts of a branch on which its motions are attractors.
    fn add_stretches<'b, S: Oscillator>(
        &self,
        family: &Systems<'_, S>,
        branch: &'b Branch<S::State>,
        known: &Known<'_>,
        stretches: &mut Vec<Stretch<'b, S::State>>,
    ) {
        let mut points: Vec<&BranchPoint<S::State>> = branch.points.iter().collect();
        let (Some(first), Some(last)) = (branch.points.first(), branch.points.last()) else {
            return;
        };
        let end = |end: &BranchEnd, last: f64| match end {
            BranchEnd::Range | BranchEnd::Closed => (last, Border::Range),
            BranchEnd::Hopf { parameter } => {
                (known.hopf(*parameter).unwrap_or(*parameter), Border::Hopf)
            }
            BranchEnd::Grazing { parameter } | BranchEnd::OneWaySlip { parameter, .. } => {
                (*parameter, Border::Bifurcation(BifurcationKind::Grazing))
            }
            BranchEnd::Birth { parameter } => {
                (*parameter, Border::Bifurcation(BifurcationKind::Sequence))
            }
            BranchEnd::Discontinuity { parameter, .. } => (*parameter, Border::Discontinuity),
            BranchEnd::Lost { parameter, .. } => match known.end_of_systems(*parameter) {
                Some(border) => (border, Border::NoSystem),
                None => (last, Border::Unknown),
            },
            _ => (last, Border::Unknown),
        };
        let extents = points.iter().map(|point| extent(&point.orbit));
        let largest = extents.fold(0.0, f64::max);
        // The first number of a piece is that of its first point.
        let between = branch.bifurcations.iter().map(|found| {
            let hopf = known.hopf(found.parameter);
            let border = match hopf.filter(|_| extent(&found.orbit) <= SMALL * largest) {
                Some(hopf) => (hopf, Border::Hopf),
                None => (found.parameter, Border::Bifurcation(found.kind)),
            };
            (found.behind + 1, border, Some(found))
        });
        let mut cuts: Vec<_> = between.collect();
        if let (BranchEnd::Closed, Some(&(behind, border, found))) = (&branch.ends[1], cuts.first())
        {
            // The place at which a closed branch was begun is no end.
            points.rotate_left(behind);
            cuts.iter_mut().for_each(|cut| cut.0 -= behind);
            cuts.push((points.len(), border, found));
        } else {
            cuts.insert(0, (0, end(&branch.ends[0], first.parameter), None));
            cuts.push((points.len(), end(&branch.ends[1], last.parameter), None));
        }
        for pair in cuts.windows(2) {
            let [(from, low, found), (to, high, next)] = &pair else {
                continue;
            };
            let inside = &points[*from..*to];
            let motions: Vec<(f64, &Orbit<S::State>)> = if inside.is_empty() {
                let ends = [found, next].into_iter().flatten();
                ends.map(|found| (found.parameter, &found.orbit)).collect()
            } else {
                inside.iter().map(|p| (p.parameter, &p.orbit)).collect()
            };
            let attractor = match inside.get(inside.len() / 2) {
                Some(point) => {
                    let system = family(point.parameter);
                    system
                        .ok()
                        .and_then(|system| attracts(&system, &point.orbit))
                }
                // Two bifurcations between neighbouring points.
                None => self.between(family, &motions, 0.5 * (low.0 + high.0)),
            };
            let Some(kind) = attractor else {
                continue;
            };
            let (low, high) = if low.0 <= high.0 {
                (low, high)
            } else {
                (high, low)
            };
            stretches.push(Stretch {
                kind,
                parameters: low.0..high.0,
                borders: [low.1, high.1],
                motions,
            });
        }
    }

    /// The attractor between the motions of neighbouring bifurcations: near a fold there
    /// are two, and the one between is more like both ends.
    fn between<S: Oscillator>(
        &self,
        family: &Systems<'_, S>,
        ends: &[(f64, &Orbit<S::State>)],
        parameter: f64,
    ) -> Option<AttractorKind> {
        let system = family(parameter).ok()?;
        let sizes = ends.iter().map(|end| extent(end.1)).sum::<f64>();
        let off = |motion: &Orbit<S::State>| (extent(motion) - sizes / ends.len() as f64).abs();
        let found = ends.iter().filter_map(|(_, end)| {
            let motion = self.shoot(&system, &end.state(), end.kind());
            motion.ok()
        });
        attracts(&system, &found.min_by(|a, b| off(a).total_cmp(&off(b)))?)
    }

    /// The attractors of some stretches whose motions differ at a value of the parameter: branches
    /// that were found from different starts may overlap.
    fn different<S: Oscillator>(
        &self,
        family: &Systems<'_, S>,
        parameter: f64,
        stretches: Vec<&Stretch<'_, S::State>>,
    ) -> Vec<AttractorKind> {
        let periodic = stretches.iter().filter(|found| !found.motions.is_empty());
        let system = match periodic.count() {
            0 | 1 => None,
            _ => family(parameter).ok(),
        };
        let motion = |stretch: &Stretch<'_, S::State>| {
            let system = system.as_ref()?;
            let found = self.motion_at(family, stretch, parameter)?;
            (attracts(system, &found) == Some(stretch.kind)).then_some(found)
        };
        let mut motions: Vec<(AttractorKind, Orbit<S::State>)> = Vec::new();
        let mut kinds = Vec::new();
        for stretch in stretches {
            // Masses at rest are one attractor, whatever joints carry.
            let rests = matches!(
                stretch.kind,
                AttractorKind::Rest | AttractorKind::SteadySliding
            );
            if rests && kinds.contains(&stretch.kind) {
                continue;
            }
            let found = motion(stretch);
            let is_known = |found: &Orbit<S::State>| {
                let alike = motions.iter().filter(|known| known.0 == stretch.kind);
                let mut alike = alike.map(|known| &known.1);
                system.as_ref().is_some_and(|system| {
                    alike.any(|known| {
                        is_one(system, known, found) || self.is_member(system, known, found)
                    })
                })
            };
            if !found.as_ref().is_some_and(is_known) {
                motions.extend(found.map(|found| (stretch.kind, found)));
                kinds.push(stretch.kind);
            }
        }
        kinds
    }

    /// Returns true if a motion is a member of the continuous family of another one, in which
    /// contacts that never slip have other positions.
    fn is_member<S: Oscillator>(
        &self,
        system: &S,
        of: &Orbit<S::State>,
        motion: &Orbit<S::State>,
    ) -> bool {
        let start = in_positions(&system.form(), of, motion);
        let moved = start.and_then(|start| self.shoot(system, &start, of.kind()).ok());
        moved.is_some_and(|moved| is_one(system, &moved, motion))
    }

    /// The motion of a stretch at a value of the parameter, from its nearest one: in shorter and
    /// shorter steps, until each motion lies near the last.
    fn motion_at<S: Oscillator>(
        &self,
        family: &Systems<'_, S>,
        stretch: &Stretch<'_, S::State>,
        parameter: f64,
    ) -> Option<Orbit<S::State>> {
        /// The shortest step, as a part of the first one; the largest change of an extent in one.
        const SHORTEST: f64 = 1.0 / 64.0;
        const NEAR: f64 = 0.1;
        let off = |motion: &&(f64, &Orbit<S::State>)| (motion.0 - parameter).abs();
        let nearest = stretch
            .motions
            .iter()
            .min_by(|a, b| off(a).total_cmp(&off(b)))?;
        let (mut at, mut motion) = (nearest.0, nearest.1.clone());
        let whole = parameter - at;
        let mut part: f64 = 1.0;
        let mut done: f64 = 0.0;
        while done < 1.0 {
            let next = (done + part).min(1.0);
            let to = nearest.0 + next * whole;
            let to = if next == 1.0 { parameter } else { to };
            let found =
                family(to).and_then(|system| self.shoot(&system, &motion.state(), motion.kind()));
            let size = extent(&motion);
            match found {
                Ok(found) if (extent(&found) - size).abs() <= NEAR * size => {
                    (at, motion, done) = (to, found, next);
                }
                _ if part <= SHORTEST => return None,
                _ => part *= 0.5,
            }
        }
        (at == parameter || whole == 0.0).then_some(motion)
    }
}

/// The facts that are known exactly without the branches.
struct Known<'k> {
    crossings: &'k [Crossing],
    systems: &'k [Range<f64>],
    /// Values closer together than this are the same point.
    near: f64,
}

impl Known<'_> {
    /// The Hopf point near a value.
    fn hopf(&self, near: f64) -> Option<f64> {
        let hopf = self.crossings.iter().filter(|at| at.frequency > 0.0);
        let mut places = hopf.map(|at| at.parameter);
        places.find(|at| (at - near).abs() <= self.near)
    }

    /// The border of the systems near a value.
    fn end_of_systems(&self, near: f64) -> Option<f64> {
        let mut places = self
            .systems
            .iter()
            .flat_map(|range| [range.start, range.end]);
        places.find(|at| (at - near).abs() <= self.near)
    }
}

/// The ranges in which a family has systems, from its values at places and bisection between them.
fn systems<S>(family: &Systems<'_, S>, places: &[f64]) -> Vec<Range<f64>> {
    let mut found: Vec<Range<f64>> = Vec::new();
    let mut start = None;
    let known = places.iter().map(|&place| (place, family(place).is_ok()));
    let known: Vec<(f64, bool)> = known.collect();
    for pair in known.windows(2) {
        let [(low, is_low), (high, is_high)] = [pair[0], pair[1]];
        if is_low {
            start.get_or_insert(low);
        }
        if is_low == is_high {
            continue;
        }
        let [_, high] = border(low, high, |place| family(place).is_ok() == is_low);
        match start.take() {
            Some(start) => found.push(start..high),
            None => start = Some(high),
        }
    }
    if let (Some(start), Some(&last)) = (start, places.last())
        && start < last
    {
        found.push(start..last);
    }
    found
}

/// A range in which one attractor exists.
struct Stretch<'b, S: SystemState> {
    kind: AttractorKind,
    parameters: Range<f64>,
    borders: [Border; 2],
    /// Periodic motions, with their parameters.
    motions: Vec<(f64, &'b Orbit<S>)>,
}

/// What an attractor at one value says about the range around it.
#[derive(Clone, Copy, PartialEq)]
enum Evidence {
    /// Nothing.
    None,
    /// It exists in the range that contains the value.
    Here,
    /// It also lasts from one value to the next, whatever else changes between them.
    Lasting,
}

/// The kind of a motion of a system, if it attracts.
fn attracts<S: Oscillator>(system: &S, orbit: &Orbit<S::State>) -> Option<AttractorKind> {
    orbit.is_stable().then(|| kind_of(&system.form(), orbit))
}

/// The ranges in which steady sliding is stable.
fn steady_stretches<'b, S: SystemState>(
    steady: &SteadyAlong,
    range: Range<f64>,
) -> Vec<Stretch<'b, S>> {
    let border = |at: f64| {
        let mut crossings = steady.crossings.iter();
        match crossings.find(|crossing| crossing.parameter == at) {
            Some(crossing) if crossing.frequency > 0.0 => Border::Hopf,
            Some(_) => Border::Divergence,
            None if at == range.start || at == range.end => Border::Range,
            None => Border::NoSteadySliding,
        }
    };
    let stable = steady.stable.iter();
    let stretches = stable.map(|(stable, kind)| Stretch {
        kind: *kind,
        parameters: stable.clone(),
        borders: [border(stable.start), border(stable.end)],
        motions: Vec::new(),
    });
    stretches.collect()
}

/// States of the last periodic motions of other ranges that end at a border of this one, if no
/// attractor begins there that may continue them.
fn ending<S: SystemState>(
    stretches: &[Stretch<'_, S>],
    range: &Range<f64>,
    near: f64,
) -> Vec<State> {
    let ending_at = |border: f64, side: usize| {
        let of = move |stretch: &&Stretch<'_, S>| {
            let Range { start, end } = stretch.parameters;
            ([start, end][side] - border).abs() <= near
        };
        stretches.iter().filter(of)
    };
    let sides = [(range.start, 1), (range.end, 0)].into_iter();
    let lost = sides.filter(|&(border, side)| ending_at(border, 1 - side).next().is_none());
    let motions = lost.flat_map(|(border, side)| {
        let off = move |motion: &&(f64, &Orbit<S>)| (motion.0 - border).abs();
        ending_at(border, side).filter_map(move |stretch| {
            let motions = stretch.motions.iter();
            motions.min_by(|a, b| off(a).total_cmp(&off(b)))
        })
    });
    motions.map(|(_, orbit)| orbit.state().general()).collect()
}

/// The ranges between all borders, those with the same attractors as one.
fn ranges<'b, S: SystemState>(
    stretches: &[Stretch<'b, S>],
    points: &[&SweepPoint<S>],
    systems: &[Range<f64>],
    range: Range<f64>,
    different: impl Fn(f64, Vec<&Stretch<'b, S>>) -> Vec<AttractorKind>,
    evidence: impl Fn(&SweepPoint<S>) -> Evidence,
) -> Vec<VibrationRange> {
    let width = range.end - range.start;
    let borders = stretches.iter().flat_map(|stretch| {
        let Range { start, end } = stretch.parameters;
        [(start, stretch.borders[0]), (end, stretch.borders[1])]
    });
    let ends = systems.iter().flat_map(|part| [part.start, part.end]);
    let borders = borders.chain(ends.map(|end| (end, Border::NoSystem)));
    let inside = |at: f64| range.start + SAME * width < at && at < range.end - SAME * width;
    let mut borders: Vec<(f64, Border)> = borders.filter(|border| inside(border.0)).collect();
    borders.push((range.start, Border::Range));
    borders.push((range.end, Border::Range));
    sort_by(&mut borders, |border| border.0);
    // The facts that are known exactly, without the branches, come first.
    let rank = |border: Border| match border {
        Border::Range => 3,
        Border::NoSystem => 2,
        Border::Hopf => 1,
        _ => 0,
    };
    borders.dedup_by(|a, b| {
        let is_same = a.0 - b.0 <= SAME * width;
        if is_same && rank(a.1) > rank(b.1) {
            *b = *a;
        }
        is_same
    });
    let points: Vec<_> = points
        .iter()
        .map(|point| (*point, evidence(point)))
        .collect();
    // An attractor that lasts is found at the nearest values on both sides.
    let lasts = |kind: AttractorKind, start: f64, end: f64| {
        let values = || points.iter().map(|(point, _)| point.parameter);
        let below = values()
            .filter(|at| *at <= start)
            .fold(f64::NEG_INFINITY, f64::max);
        let above = values()
            .filter(|at| *at >= end)
            .fold(f64::INFINITY, f64::min);
        [below, above].into_iter().all(|at| {
            let mut there = points.iter().filter(|(point, _)| point.parameter == at);
            there.any(|(point, of)| point.kind() == Some(kind) && *of == Evidence::Lasting)
        })
    };
    let mut found: Vec<VibrationRange> = Vec::new();
    for pair in borders.windows(2) {
        let (start, end) = (pair[0].0, pair[1].0);
        let middle = 0.5 * (start + end);
        let exists = |part: &Range<f64>| part.start <= middle && middle < part.end;
        if !systems.iter().any(exists) {
            continue;
        }
        let there = stretches.iter().filter(|stretch| {
            let Range { start, end } = stretch.parameters;
            start < middle && middle < end
        });
        let mut attractors = different(middle, there.collect());
        // Attractors of the sweep that nothing above explains. A point on a border says little
        // about the range beside it.
        for (point, evidence) in &points {
            let is_inside = start < point.parameter && point.parameter < end;
            let is_on_border = point.parameter == start || point.parameter == end;
            let Some(kind) = point.kind().filter(|kind| !attractors.contains(kind)) else {
                continue;
            };
            let is_there = match evidence {
                Evidence::None => false,
                Evidence::Here => is_inside || is_on_border && kind == AttractorKind::Irregular,
                Evidence::Lasting => is_inside || lasts(kind, start, end),
            };
            if is_there {
                attractors.push(kind);
            }
        }
        attractors.sort();
        match found.last_mut() {
            Some(last) if last.attractors == attractors && last.parameters.end == start => {
                last.parameters.end = end;
                last.borders[1] = pair[1].1;
            }
            _ => found.push(VibrationRange {
                parameters: start..end,
                attractors,
                borders: [pair[0].1, pair[1].1],
            }),
        }
    }
    found
}
