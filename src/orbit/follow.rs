//! Continuation of a periodic motion over a parameter.

use std::ops::Range;

use nalgebra::DVector;

use super::bifurcations::Signs;
use super::branch::{Bifurcation, Branch, BranchEnd, BranchPoint};
use super::branch_equations::{Curve, MOST_TRIALS, Solved};
use super::oscillator::{Oscillator, Systems, member};
use super::period::Period;
use super::periodic_orbit::{Closed, Orbit};
use super::phase_condition::FrozenStart;
use super::pseudo_arclength::{Change, Left, Walk, natural_scale};
use super::work::Work;
use crate::error::Error;
use crate::motion::sealed::State as _;
use crate::numerics::trace::Plane;
use crate::search::Search;
use crate::state::structure::State;

/// Follows a periodic motion over a parameter, in both directions and through folds, until the
/// branch ends or the parameter leaves the range.
///
/// `family` returns the system for a value of the parameter. The parameter may be anything that a
/// closure can set: a belt velocity, a load, a damper, a coefficient of a law, the frequency of a
/// force. `from` is a periodic motion of the system at the value `parameter`. This value lies in
/// the range, which includes both its ends. Newton's method may call `family` outside the range, at
/// most 1/64 of the range's width away from it.
///
/// The unknowns are the start x(0), the period T of an autonomous motion, and the parameter p. They
/// satisfy
///
/// ```text
/// x(T; x(0), p) − x(0) = 0.
/// ```
///
/// The start x(0) lies away from the events of the motion. A forced motion therefore starts at
/// another time of its period if an event comes near. An autonomous motion also satisfies a phase
/// condition: it starts at a turning point of one coordinate, or on a plane across the motion if
/// all turning points are near events. The curve of solutions is followed by pseudo-arclength
/// continuation: a step along the tangent, then Newton's method on a plane across the tangent.
/// Newton's method uses the exact derivative of the period map. The order of stick and slip is not
/// prescribed. If the events of two neighbouring motions differ, bisection locates the change of
/// events, to adjacent floating-point numbers or to the rounding error of the motions. The branch
/// then continues beyond the change.
///
/// Let s be the arclength and μ_i the [multipliers](Orbit::multipliers), without the multiplier 1
/// that every autonomous motion has. A test function changes its sign at a bifurcation:
///
/// * fold: dp/ds, or Π(1 − μ_i) where there is no pitchfork;
/// * pitchfork of a symmetric motion: Π(1 − μ_i), if the map of
///   [`BifurcationKind::Pitchfork`](super::BifurcationKind::Pitchfork) has the multiplier −1;
/// * flip: Π(1 + μ_i);
/// * Neimark-Sacker bifurcation, if a complex pair lies on the unit circle: Π(1 − μ_i μ_j) over all
///   pairs i < j.
///
/// Each bifurcation is then refined along the arclength. Newton's method corrects every motion that
/// is tried. Two bifurcations of the same kind within one step (at most 1/64 of the range) can be
/// missed. In a narrower range the steps are shorter. If a system has a continuum of periodic
/// motions, one multiplier is always 1, and Newton's method finds the motion of the continuum that
/// is nearest to its first guess.
///
/// In each direction the limits are 2048 points, 50 000 motions tried, and 10⁷ integration steps of
/// all these motions. [`Search`] sets other limits of points and steps, and accepts a watcher, a
/// function that can stop the search. The page of `Search` states the work of a branch. If a motion
/// is lost, the branch up to this motion is returned. [`Branch::ends`] gives the reason for each
/// end.
///
/// A motion can jump as the parameter passes a value. If the jump is less than 1e-3 of the motion's
/// size, and a neighbouring motion is found on the other side, the branch continues with the
/// neighbouring motion. Otherwise the branch ends with [`BranchEnd::Discontinuity`]. A contact that
/// does not slip keeps its position along the branch. If at some parameter it reaches its limit
/// force, and beyond slips in one direction only, the branch ends with [`BranchEnd::OneWaySlip`].
///
/// A branch does not run over its own motions again: where it meets itself, it ends with
/// [`BranchEnd::Closed`].
///
/// Sources: Kuznetsov, *Elements of Applied Bifurcation Theory*, chapter 10 (continuation, test
/// functions); Dankowicz and Schilder, *Recipes for Continuation*, chapters 9 and 17 (motions of
/// several segments); di Bernardo et al., *Piecewise-smooth Dynamical Systems* (changes of the
/// event sequence).
///
/// # Errors
///
/// * [`Error::InvalidParameter`] unless the range is finite, is not empty and contains the
///   parameter;
/// * [`Error::At`], with the parameter, if the family returns an error at this parameter, or if
///   `from` is not a motion of the system there; with [`Error::NoCommonPeriod`], if drives have a
///   common period at this parameter and none beside it;
/// * [`Error::At`], with the parameter, if `family`, or the computation of the [`Orbit`], returns
///   an error for a motion that was found.
///
/// ```
/// use stick_slip::orbit::{self, BifurcationKind, Period};
/// use stick_slip::{Contact, Coulomb, Drive, Error, Structure, structure::State};
///
/// // A mass on a belt under a harmonic force, over the frequency of the force.
/// let family = |frequency: f64| -> Result<Structure, Error> {
///     Structure::new(&[1.0])?
///         .with_ground_spring(0, 1.0)?
///         .with_ground_damper(0, 0.02)?
///         .with_force(0, Drive::harmonic(0.3, frequency, 0.0)?)?
///         .with_contact(Contact::new(0, Coulomb::new(0.5, 0.3)?, 1.5)?.on_belt(0.1))
/// };
/// let start = State::new(&[0.3], &[0.0]);
/// let orbit = orbit::settle(&family(0.78)?, &start, 400.0, Period::Driven(1))?;
/// let branch = orbit::follow(family, 0.78, &orbit, 0.7..0.8)?;
/// // Below this frequency the period doubles.
/// let flip = &branch.bifurcations[0];
/// assert_eq!(flip.kind, BifurcationKind::Flip);
/// assert!((flip.parameter - 0.7427147655161559115).abs() < 1e-12);
/// assert!((flip.orbit.multipliers()[0].re + 1.0).abs() < 1e-9);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "continuation")]
pub fn follow<S: Oscillator>(
    family: impl Fn(f64) -> Result<S, Error>,
    parameter: f64,
    from: &Orbit<S::State>,
    range: Range<f64>,
) -> Result<Branch<S::State>, Error> {
    Search::new().follow(family, parameter, from, range)
}

impl Search<'_> {
    /// Calls the function [`follow`] with the bounds and the watcher of this search.
    ///
    /// # Errors
    ///
    /// The errors of [`follow`]; [`Error::Stopped`] if the watcher stops the search before the
    /// first motion.
    pub fn follow<S: Oscillator>(
        &self,
        family: impl Fn(f64) -> Result<S, Error>,
        parameter: f64,
        from: &Orbit<S::State>,
        range: Range<f64>,
    ) -> Result<Branch<S::State>, Error> {
        let start = (from.state().general(), from.period());
        let found = self.over(&family, from.kind(), range.clone(), |curve| {
            search(curve, parameter, start)
        })?;
        found.branch(&family, range)
    }

    /// Uses the curve of the periodic motions of a family.
    pub(super) fn over<S: Oscillator, T>(
        &self,
        family: &Systems<'_, S>,
        kind: Period,
        range: Range<f64>,
        using: impl FnOnce(Curve<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let watched = self.watch("parameter");
        using(Curve {
            family: &|parameter| member(family(parameter)),
            kind,
            range,
            n: 0,
            order: 0,
            mobilities: Vec::new(),
            work: Work::new(MOST_TRIALS, self.of_branch(), &watched),
        })
    }
}

/// The results, each with its parameter.
struct Results {
    points: Vec<(f64, Closed)>,
    changes: Vec<Change>,
    ends: [BranchEnd; 2],
}

impl Results {
    /// The branch in the states of its systems.
    fn branch<S: Oscillator>(
        self,
        family: &Systems<'_, S>,
        range: Range<f64>,
    ) -> Result<Branch<S::State>, Error> {
        let orbit = |parameter: f64, closed: Closed| {
            let orbit = family(parameter).and_then(|system| closed.orbit(&system));
            orbit.map_err(|error| error.at("parameter", parameter))
        };
        let points = self.points.into_iter().map(|(parameter, closed)| {
            let orbit = orbit(parameter, closed)?;
            Ok(BranchPoint { parameter, orbit })
        });
        let points = points.collect::<Result<_, Error>>()?;
        let changes = self.changes.into_iter();
        let bifurcations = changes.map(|(behind, kind, parameter, closed)| {
            let orbit = orbit(parameter, closed)?;
            Ok(Bifurcation {
                parameter,
                kind,
                orbit,
                behind,
                range: range.clone(),
            })
        });
        Ok(Branch {
            bifurcations: bifurcations.collect::<Result<_, Error>>()?,
            points,
            ends: self.ends,
        })
    }
}

/// Continuation in both directions from a motion, given by its start and its period.
fn search(
    mut curve: Curve<'_>,
    parameter: f64,
    (start, period): (State, f64),
) -> Result<Results, Error> {
    let (name, range) = ("orbit::follow", &curve.range);
    Error::check_range(name, ["range.start", "range.end"], range)?;
    let inside = (range.start..=range.end).contains(&parameter);
    Error::check(name, "parameter", parameter, inside, "inside the range")?;
    let guess = anchor(&mut curve, parameter, &start, period)?;
    walks(&curve, &guess)
}

/// Sets the sizes of a curve to those of a motion, given by its start and its period; returns the
/// motion with a start away from events, as a guess.
pub(super) fn anchor(
    curve: &mut Curve<'_>,
    parameter: f64,
    start: &State,
    period: f64,
) -> Result<Solved, Error> {
    let at = |error: Error| error.at("parameter", parameter);
    let system = (curve.family)(parameter).map_err(at)?;
    let form = system.form();
    (curve.n, curve.order) = (form.len(), form.order());
    curve.weigh(&form);
    curve.check_common_period(parameter)?;
    let map = form.period_map(start, period).map_err(at)?;
    let old = FrozenStart::at_zero();
    let (start, begin) = FrozenStart::away(&map, period, &old, curve.is_free()).map_err(at)?;
    curve.guess(&start, (period, parameter), begin)
}

/// Continuation in both directions from a motion near the curve.
fn walks(curve: &Curve<'_>, guess: &Solved) -> Result<Results, Error> {
    let first = first(curve, guess)?;
    let first_scale = natural_scale(curve, &first);
    let walk = |direction: f64, other_half: &[Left], signs: Signs| -> Result<_, Error> {
        curve.work.begin_again();
        let mut walk = Walk {
            curve,
            first_scale: first_scale.clone(),
            points: Vec::new(),
            before: None,
            found: Vec::new(),
            other_half,
            signs,
            is_ring: false,
        };
        let mut first = first.clone();
        first.tangent *= direction;
        let end = walk.run(&first)?;
        Ok(((walk.points, walk.found, end), walk.is_ring, walk.signs))
    };
    let ((up, found_up, end_up), is_ring, [along, folds, flips, tori]) = walk(1.0, &[], [0.0; 4])?;
    let (mut points, mut changes, end_down) = if is_ring {
        (Vec::new(), Vec::new(), BranchEnd::Closed)
    } else {
        // In this direction the parameter falls.
        walk(-1.0, &up, [-along, folds, flips, tori])?.0
    };
    points.reverse();
    changes.reverse();
    let below = points.len();
    for change in &mut changes {
        change.0 = below.saturating_sub(change.0 + 1);
    }
    points.push(Left::new(curve, &first)?);
    points.extend(up);
    let points = points.into_iter();
    let points = points.map(|left| (left.parameter, left.closed)).collect();
    let found_up = found_up.into_iter();
    changes.extend(
        found_up.map(|(before, kind, parameter, orbit)| (below + before, kind, parameter, orbit)),
    );
    Ok(Results {
        points,
        changes,
        ends: [end_down, end_up],
    })
}

/// The first point, with the tangent there, towards larger parameters.
fn first(curve: &Curve<'_>, guess: &Solved) -> Result<Solved, Error> {
    let parameter = curve.parameter(&guess.y);
    if !guess.trial.map.is_nearly_closed() {
        return Err(curve.lost(&guess.y, &guess.trial));
    }
    let scale = natural_scale(curve, guess);
    let last = curve.unknowns() - 1;
    // Along the parameter, but at a fold along the others.
    let along = DVector::from_fn(last + 1, |i, _| if i == last { 1.0 } else { 0.001 });
    let plane = Plane::with_value(last, parameter, &along, &scale);
    let mut first = curve.solve(&guess.y, guess, &plane)?;
    first.y[last] = parameter;
    if first.tangent[last] < 0.0 {
        first.tangent.neg_mut();
    }
    Ok(first)
}
