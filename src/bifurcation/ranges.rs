use std::ops::Range;

use super::along::{Along, RangeSearch, Work, along_velocities};
use super::fold::folds;
use super::grazing::all_changes;
use super::hopf::hopf;
use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::{FrictionLaw, is_constant_on};
use crate::limit_cycle::{Tracer, find_moving};
use crate::motion::AttractorKind;
use crate::numerics::scan::INTERVALS;

/// The attractors over a range of belt velocities. The result is a list of intervals. Within one
/// interval the attractors are the same; in neighbouring intervals they differ.
///
/// The range is cut at six kinds of velocities. At a [Hopf](super::hopf_velocities) velocity steady
/// sliding changes its stability, at a [grazing](super::grazing_velocities) velocity stick-slip
/// appears or disappears, and at a [touching](super::touching_velocities) velocity a pure-slip
/// cycle touches the belt velocity. At an [overshoot](super::overshoot_velocities) or
/// [crossing](super::crossing_velocities) velocity a cycle changes its kind, and at a
/// [fold](super::fold_velocities) two cycles meet and vanish. The range is also cut where a
/// [continuum](crate::limit_cycle::Continuum) begins or ends. Between two neighbouring cuts,
/// [`find`](crate::limit_cycle::find) is called at three velocities. If the attractors at these
/// velocities differ, the border between them is found by bisection, to 10⁻¹² of the velocity.
/// (Such borders are the folds of cycles that cross the belt velocity, which
/// [`fold_velocities`](super::fold_velocities) does not find.) Borders are merged if their relative
/// distance is less than 10⁻¹². The belt velocity 0 is also a border, because the mass then comes
/// to rest.
///
/// Just beyond a supercritical Hopf velocity the new cycle is too small for `find`. The attractors
/// of this interval are therefore taken from velocities farther from the Hopf velocity.
///
/// Each of the six searches divides the range into 64 intervals. Two changes that undo each other
/// within one of these intervals can be missed, for example two folds between which a pair of
/// cycles exists. A narrower range is searched more densely.
///
/// The cost is that of the six searches, and of three calls of `find` between two neighbouring
/// cuts. If two cuts are closer than a 64th of the range, grazing, touching, overshoot and crossing
/// velocities are searched once more between them. [`Along::vibration_ranges`] searches along any
/// parameter, and accepts a bound of the work and a watcher (a function that can stop the search).
///
/// # Errors
///
/// The errors of [`hopf_velocities`](super::hopf_velocities) and
/// [`grazing_velocities`](super::grazing_velocities).
///
/// ```
/// use stick_slip::bifurcation::{AttractorKind, vibration_ranges};
/// use stick_slip::{Exponential, MassOnBelt};
///
/// let system = MassOnBelt::new(Exponential::new(0.6, 0.3, 0.4)?, 1.0)?.with_damping(0.01)?;
/// let ranges = vibration_ranges(&system, 0.05..4.0)?;
/// let bistable: Vec<_> = ranges.iter().filter(|range| range.is_bistable()).collect();
/// // Both are stable between the upper Hopf velocity and the fold or grazing that ends stick-slip.
/// let (sliding, stick_slip) = (AttractorKind::SteadySliding, AttractorKind::StickSlip);
/// assert_eq!(bistable[0].attractors, [sliding, stick_slip]);
/// assert!(bistable[0].velocities.contains(&1.0));
/// // At larger velocities steady sliding is the only attractor.
/// assert_eq!(ranges.last().unwrap().attractors, [sliding]);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "sweep")]
#[doc(alias = "hysteresis")]
#[doc(alias = "squeal")]
pub fn vibration_ranges<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    range: Range<f64>,
) -> Result<Vec<VibrationRange>, Error> {
    along_velocities(system, range).vibration_ranges()
}

/// An interval of belt velocities with the same attractors throughout, for a mass on a belt.
/// Returned by [`vibration_ranges`], which calls [`limit_cycle::find`](crate::limit_cycle::find())
/// at each velocity that it tries.
///
/// For any other system use [`orbit::VibrationRange`](crate::orbit::VibrationRange), which also
/// contains the reason for each border.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct VibrationRange {
    /// Belt velocities, dimensionless. After a search [`along`](super::along()) another parameter
    /// they are values of this parameter, in its own units.
    pub velocities: Range<f64>,
    /// The attractors, from the inside outwards in the plane of displacement and velocity. Empty if
    /// a motion can grow without bound, or if double precision cannot resolve the attractors.
    pub attractors: Vec<AttractorKind>,
}

impl VibrationRange {
    /// Returns true if there are two or more attractors. The start then decides to which motion the
    /// mass settles.
    pub fn is_bistable(&self) -> bool {
        self.attractors.len() > 1
    }

    /// Returns true if a vibration can last. This is the case if an attractor is a continuum or a
    /// cycle. It is also the case if the list of attractors is empty, because a motion can then
    /// grow without bound, or double precision cannot resolve the attractors.
    pub fn vibrates(&self) -> bool {
        self.attractors != [AttractorKind::SteadySliding]
    }
}

impl<L: FrictionLaw> Along<'_, L> {
    /// The attractors over a range of the parameter. See [`vibration_ranges`].
    ///
    /// # Errors
    ///
    /// The errors of [`hopf`](Self::hopf) and [`grazing`](Self::grazing). [`Error::Stopped`]
    /// contains the borders found so far.
    ///
    /// ```
    /// use stick_slip::{Exponential, MassOnBelt, bifurcation};
    ///
    /// // Under which load does the mass vibrate?
    /// let law = Exponential::new(0.4, 0.25, 0.5)?;
    /// let loaded = |load: f64| MassOnBelt::new(law, 0.6)?.with_damping(0.05)?.with_load(load);
    /// let ranges = bifurcation::along(loaded, 0.1..2.0).vibration_ranges()?;
    /// let vibrating = ranges.iter().find(|range| range.vibrates()).unwrap();
    /// let silent = bifurcation::silencing_load(&loaded(1.0)?)?;
    /// assert!((vibrating.velocities.start - silent).abs() < 1e-11);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn vibration_ranges(&self) -> Result<Vec<VibrationRange>, Error> {
        self.search(|search| search.vibration_ranges())
    }
}

impl RangeSearch<'_> {
    fn vibration_ranges(&self) -> Result<Vec<VibrationRange>, Error> {
        let mut ranges = Vec::new();
        self.over_parts(&mut |work, part, found| {
            hopf(work, part, found)?;
            all_changes(work, part, found)?;
            let doubtful = folds(work, part, found)?;
            let doubtful = doubtful.iter().flat_map(|range| [range.start, range.end]);
            let doubtful: Vec<f64> = doubtful.collect();
            let mut borders = vec![part.start, part.end];
            borders.extend(found.iter().filter(|border| part.contains(border)));
            borders.extend(flat_borders(work, part));
            look_closer(work, part, &mut borders)?;
            for ends in borders.windows(2) {
                let interval = ends[0]..ends[1];
                let places = places(&interval, &doubtful);
                let attractors = &mut |value| attractors(work, value);
                add_interval(attractors, &interval, &places, &mut ranges)?;
            }
            join_narrow(&mut ranges);
            Ok(())
        })?;
        Ok(ranges)
    }
}

/// Adds the borders for which a search of the whole part is too coarse: between two borders that
/// are closer than its first grid points, the contacts may change, too. Sorts the borders.
fn look_closer(
    work: &Work<'_, '_>,
    part: &Range<f64>,
    borders: &mut Vec<f64>,
) -> Result<(), Error> {
    borders.sort_by(f64::total_cmp);
    borders.dedup();
    let coarse = (part.end - part.start) / INTERVALS as f64;
    let intervals = borders.windows(2).map(|ends| ends[0]..ends[1]);
    let close = intervals.filter(|ends| ends.end - ends.start < coarse && !is_narrow(ends));
    for interval in close.collect::<Vec<_>>() {
        let Range { start, end } = interval;
        let mut between = Vec::new();
        all_changes(work, &interval, &mut between)?;
        between.retain(|&border| !is_narrow(&(start..border)) && !is_narrow(&(border..end)));
        if !between.is_empty() {
            between.extend([start, end]);
            look_closer(work, &interval, &mut between)?;
            borders.append(&mut between);
        }
    }
    borders.sort_by(f64::total_cmp);
    borders.dedup();
    Ok(())
}

/// Belt velocities in a part of the range at which a continuum begins or ends: without damping,
/// those at which friction begins to vary. Steady sliding need not lose its stability there.
fn flat_borders(work: &Work<'_, '_>, part: &Range<f64>) -> Vec<f64> {
    let Some(system) = work.search.velocities_of.filter(|of| of.damping() == 0.0) else {
        return Vec::new();
    };
    let law = system.law();
    let is_flat = |piece: usize, end: f64| is_constant_on(law, piece, end);
    let borders = law.breakpoints().enumerate();
    let borders = borders.filter(|&(i, speed)| is_flat(i, speed) != is_flat(i + 1, speed));
    let side = if part.start < 0.0 { -1.0 } else { 1.0 };
    let velocities = borders.map(|(_, speed)| side * speed);
    velocities.filter(|v_b| part.contains(v_b)).collect()
}

/// The attractors at a value of the parameter.
fn attractors(work: &Work<'_, '_>, value: f64) -> Result<Vec<AttractorKind>, Error> {
    let attractors = work.moving_at(value, &mut |tracer: &mut Tracer<'_>| {
        let cycles = find_moving(tracer)?;
        let equilibrium = tracer.system().equilibrium();
        let is_stable = equilibrium.is_some_and(|equilibrium| equilibrium.is_stable());
        let stable = cycles.stable().map(|cycle| cycle.kind());
        Ok(is_stable
            .then_some(AttractorKind::SteadySliding)
            .into_iter()
            .chain(cycles.continuum().map(|_| AttractorKind::Continuum))
            .chain(stable.map(AttractorKind::from))
            .collect())
    })?;
    Ok(attractors.unwrap_or_default())
}

/// The points at which an interval is searched: away from its ends, near which cycles are small,
/// and on both sides of doubtful values.
fn places(interval: &Range<f64>, doubtful: &[f64]) -> Vec<f64> {
    let inside = |place: &f64| interval.start < *place && *place < interval.end;
    let mut places: Vec<f64> = [1.0 / 16.0, 0.5, 15.0 / 16.0]
        .map(|place| interval.start + place * (interval.end - interval.start))
        .into_iter()
        .chain(doubtful.iter().copied().filter(inside))
        .collect();
    places.sort_by(f64::total_cmp);
    places.dedup();
    places
}

/// Width, relative to the parameter, to which a border is bisected.
const NARROWEST: f64 = 1e-12;

type Attractors<'a> = dyn FnMut(f64) -> Result<Vec<AttractorKind>, Error> + 'a;

/// Adds an interval in which no search has found a border, cut where its attractors differ.
fn add_interval(
    attractors: &mut Attractors,
    interval: &Range<f64>,
    places: &[f64],
    ranges: &mut Vec<VibrationRange>,
) -> Result<(), Error> {
    let mut at = |value: f64| Ok::<_, Error>((value, attractors(value)?));
    let all: Result<Vec<_>, Error> = places.iter().rev().map(|place| at(*place)).collect();
    let mut todo = all?;
    let Some(mut left) = todo.pop() else {
        return Ok(());
    };
    let mut start = interval.start;
    while let Some(right) = todo.pop() {
        let middle = 0.5 * (left.0 + right.0);
        if left.1 == right.1 {
            left = right;
        } else if is_narrow(&(left.0..right.0)) || !(left.0 < middle && middle < right.0) {
            add(start..middle, left.1, ranges);
            (start, left) = (middle, right);
        } else {
            todo.push(right);
            todo.push(at(middle)?);
        }
    }
    add(start..interval.end, left.1, ranges);
    Ok(())
}

/// Merges ranges as narrow as rounding with their neighbours: two searches for the same border need
/// not return the same number.
fn join_narrow(ranges: &mut Vec<VibrationRange>) {
    let mut joined: Vec<VibrationRange> = Vec::new();
    for mut range in ranges.drain(..) {
        if let Some(last) = joined.pop_if(|last| is_narrow(&last.velocities)) {
            range.velocities.start = last.velocities.start;
        }
        add(range.velocities, range.attractors, &mut joined);
    }
    if joined.len() > 1
        && let Some(last) = joined.pop_if(|last| is_narrow(&last.velocities))
        && let Some(before) = joined.last_mut()
    {
        before.velocities.end = last.velocities.end;
    }
    *ranges = joined;
}

fn is_narrow(Range { start, end }: &Range<f64>) -> bool {
    end - start <= NARROWEST * start.abs().max(end.abs())
}

/// Adds a range, or extends the last one if it has the same attractors.
fn add(velocities: Range<f64>, attractors: Vec<AttractorKind>, ranges: &mut Vec<VibrationRange>) {
    match ranges.last_mut() {
        Some(last)
            if last.attractors == attractors && last.velocities.end == velocities.start
                // The motion of the belt turns round.
                && velocities.start != 0.0 =>
        {
            last.velocities.end = velocities.end;
        }
        _ => ranges.push(VibrationRange {
            velocities,
            attractors,
        }),
    }
}
