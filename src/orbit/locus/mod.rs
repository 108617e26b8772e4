//! Curves of bifurcations in two parameters.

mod bordered;
mod change;
mod curve_of_motions;
mod directions;
mod event_equations;
pub(super) mod found;
mod motions;
mod smooth_equations;
mod special;
pub(super) mod tangential_end;

use std::cell::Cell;
use std::ops::Range;

use nalgebra::DVector;

use self::change::{Change, arrivals, sequence, touch};
use self::curve_of_motions::CurveOfMotions;
use self::directions::{both_ways, first_point};
use self::event_equations::EventCurve;
use self::found::{Locus, LocusKind, LocusPoint, SpecialPoint};
use self::motions::Motions;
use self::smooth_equations::{Smooth, SmoothCurve};
use super::branch::{Bifurcation, BifurcationKind};
use super::oscillator::{Oscillator, SystemsOfTwo, member};
use super::period::Period;
use super::period_map::vector;
use super::periodic_orbit::Orbit;
use super::phase_condition::FrozenStart;
use super::prescribed_modes::Touch;
use super::shooting_residual::TrialMotion;
use crate::error::{Element, Error};
use crate::motion::EventKind;
use crate::motion::sealed::State as _;
use crate::numerics::trace::{Point, check_ranges};
use crate::search::Search;

/// The curve through a bifurcation, in two parameters of the system.
///
/// `family` returns the system for values of the two parameters, which may be anything that a
/// closure can set. `at` is a bifurcation over the first parameter, found by
/// [`follow`](super::follow). `second` is the value of the second parameter at which `follow` found
/// this bifurcation. Both values lie in the given ranges. Newton's method may call `family` outside
/// a range, at most 1/64 of the range's width away from it.
///
/// The start x, the period T of an autonomous motion and the two parameters p and q satisfy
///
/// ```text
/// P(x, T; p, q) − x = 0,    g(x, T; p, q) = 0,
/// ```
///
/// where P is the period map, and g is a scalar that is 0 at the bifurcation:
///
/// | [`BifurcationKind`] | [`LocusKind`] | g |
/// |---|---|---|
/// | fold, flip, Neimark-Sacker | of the same name | a scalar computed from a bordered matrix; 0 if a multiplier is 1 (fold) or −1 (flip), or if a pair of multipliers is exp(±iθ) |
/// | grazing, within a branch or [at its end](super::BranchEnd::Grazing) | [`Grazing`](LocusKind::Grazing) | the extremum near 0 of the relative velocity of the contact; the contact slips before the extremum, and slips or sticks after it |
/// | pitchfork | of the same name | a scalar computed from a bordered matrix; 0 if a multiplier of the map G is −1 |
/// | change of events: at an instant of zero relative velocity, a contact sticks on one side of the curve and not on the other (onset of stops, that is, of phases of stick) | [`StopOnset`](LocusKind::StopOnset) | \|R\| − N μ_s at the instant of zero relative velocity, with the force R that the contact needs to stick, the load N and the static coefficient μ_s |
/// | change of events: two contacts have events at the same time | [`Order`](LocusKind::Order) | the time between two events of two contacts |
///
/// For a pitchfork, G(x) = x replaces the first equation. G is the map over half a period, followed
/// by a reflection: see [`BifurcationKind::Pitchfork`].
///
/// The curve is followed by pseudo-arclength continuation, also through cusps. The monodromy matrix
/// is exact. The derivatives of g, and the derivatives with respect to parameters, are differences
/// between motions with the same events. These differences influence only the convergence of
/// Newton's method: the parameters that it finds are exact to the rounding error of the period map.
/// This error grows near events that become tangential.
///
/// Special points are zeros of test functions along the curve:
///
/// | curve | special points |
/// |---|---|
/// | fold | [`Cusp`](super::SpecialKind::Cusp), 1:1 resonance, fold-flip, fold-Neimark-Sacker; at an end of the curve [`FoldGrazing`](super::SpecialKind::FoldGrazing) |
/// | flip | 1:2 resonance, fold-flip, flip-Neimark-Sacker |
/// | Neimark-Sacker | 1:1 and 1:2 resonances, at which the curve ends; 1:3 and 1:4 resonances; fold-Neimark-Sacker, flip-Neimark-Sacker, double Neimark-Sacker |
/// | pitchfork | 1:1 resonance, fold-pitchfork, pitchfork-Neimark-Sacker |
/// | grazing | fold-grazing |
/// | grazing, onset of stops, order | at an end of the curve [`DoubleGrazing`](super::SpecialKind::DoubleGrazing) |
///
/// Two zeros of the same test function within a step (at most 1/64 of the ranges) can be missed.
/// The coefficients of normal forms are not computed. Generalised flips, Chenciner points, and
/// points at which a pitchfork turns subcritical are therefore not found.
///
/// If the period map is smooth at a change of the events, a curve of folds, flips or Neimark-Sacker
/// bifurcations continues beyond the change; otherwise it ends with
/// [`LocusEnd::Jump`](super::LocusEnd::Jump). A curve of grazings, onsets of stops or event orders
/// ends with `Jump` at every change of the events. On a curve of grazings, the instant of grazing
/// can approach another event of the same contact, such as a release. The steps then become ever
/// shorter, and the curve ends with [`LocusEnd::Crawls`](super::LocusEnd::Crawls). Where the
/// instant falls onto the turning point of a motion at the onset of stops, both curves end at one
/// point: that of grazings with `Crawls`, that of onsets with `Jump`, or with
/// [`LocusEnd::Lost`](super::LocusEnd::Lost) if a multiplier is 1 there, as without damping at half
/// of the natural frequency (Den Hartog's oscillator). A curve of folds that meets a curve of
/// grazings ends there with `Jump`, and its last special point is
/// [`FoldGrazing`](super::SpecialKind::FoldGrazing). This holds if, on the side of the folds, the
/// contact slips past the touch or sticks there for a time that shrinks to 0. If it sticks for a
/// longer time at the touch, if its law has a memory, or if its static friction is larger than its
/// kinetic friction at speed 0, the curve can end with `Crawls` or with
/// [`LocusEnd::Lost`](super::LocusEnd::Lost). A curve of an autonomous motion that shrinks to a
/// point ends with [`LocusEnd::Hopf`](super::LocusEnd::Hopf). The parameters of this end are
/// extrapolated, with an error of about 1e-8 of the ranges, and 1e-7 if the system drifts.
///
/// For five changes of events no curve can be computed:
///
/// * a sticking contact reaches its limit tangentially;
/// * a [`Stop`](crate::Stop) is touched;
/// * a load falls to 0 and opens a contact;
/// * a drive jumps;
/// * a contact that shares its coordinate begins to stick (an onset of stops).
///
/// A contact does not share its coordinate i if four conditions hold: the contact is rigid, it is
/// created by `Contact::new(i, ..)`, coordinate i has no second rigid contact, and the mass matrix
/// does not couple coordinate i to others.
///
/// If the motions at a grazing are [ends of branches](super::BranchEnd::Grazing), the derivative of
/// the period map is unbounded there: the first multiplier is infinite, and the others are NaN.
///
/// Each step of Newton's method takes about ten motions. The limits in each direction are 2048
/// points, 2·10⁵ motions tried and 2·10⁷ integration steps. [`Search`] sets other limits of points
/// and steps, and accepts a watcher, a function that can stop the search.
///
/// Sources: Govaerts, *Numerical Methods for Bifurcations of Dynamical Equilibria*, chapters 3 and
/// 4 (bordered matrices); Kuznetsov, *Elements of Applied Bifurcation Theory*, chapters 9 and 10;
/// di Bernardo, Budd, Champneys and Kowalczyk, *Piecewise-smooth Dynamical Systems*, chapters 8 and
/// 9 (events).
///
/// # Errors
///
/// * [`Error::InvalidParameter`] unless the ranges are finite, are not empty and contain the values
///   of both parameters at the bifurcation;
/// * [`Error::At`], with the parameters, if the family returns an error at these values, or if no
///   such bifurcation is found there;
/// * [`Error::At`] with [`Error::NotSmooth`], if the change of events has no row in the first
///   table.
///
/// ```
/// use stick_slip::orbit::{self, BifurcationKind, LocusEnd, Period};
/// use stick_slip::{Contact, Coulomb, Drive, Error, Structure, structure::State};
///
/// // A mass on a belt under a harmonic force, over frequency and amplitude of the force.
/// let family = |frequency: f64, force: f64| -> Result<Structure, Error> {
///     Structure::new(&[1.0])?
///         .with_ground_spring(0, 1.0)?
///         .with_ground_damper(0, 0.02)?
///         .with_force(0, Drive::harmonic(force, frequency, 0.0)?)?
///         .with_contact(Contact::new(0, Coulomb::new(0.5, 0.3)?, 1.5)?.on_belt(0.1))
/// };
/// let start = State::new(&[0.3], &[0.0]);
/// let motion = orbit::settle(&family(0.78, 0.3)?, &start, 400.0, Period::Driven(1))?;
/// let branch = orbit::follow(|frequency| family(frequency, 0.3), 0.78, &motion, 0.7..0.8)?;
/// let flip = &branch.bifurcations[0];
///
/// // The period doubles along a curve, which leaves the ranges at the frequency 0.72.
/// let locus = orbit::locus(family, flip, 0.3, [0.72..0.9, 0.1..0.5])?;
/// assert_eq!(locus.ends, [LocusEnd::Ranges, LocusEnd::Ranges]);
/// for point in &locus.points {
///     assert!((point.orbit.multipliers()[0].re + 1.0).abs() < 1e-10);
/// }
/// let end = locus.points.iter().find(|point| point.parameters[0] == 0.72).unwrap();
/// assert!((end.parameters[1] - 0.3444628189675873).abs() < 1e-13);
/// # Ok::<(), stick_slip::Error>(())
/// ```
///
/// With mass 1, stiffness 1 and damping c, the pure-slip motion under a harmonic force of frequency
/// Ω first reaches the belt velocity v_b at the force amplitude v_b √((1 − Ω²)² + (cΩ)²)/Ω:
///
/// ```
/// use stick_slip::orbit::{self, LocusKind, Period};
/// use stick_slip::{Contact, Coulomb, Drive, Error, Structure, structure::State};
///
/// let family = |frequency: f64, force: f64| -> Result<Structure, Error> {
///     Structure::new(&[1.0])?
///         .with_ground_spring(0, 1.0)?
///         .with_ground_damper(0, 0.06)?
///         .with_force(0, Drive::harmonic(force, frequency, 0.0)?)?
///         .with_contact(Contact::new(0, Coulomb::new(0.4, 0.4)?, 1.0)?.on_belt(0.35))
/// };
/// let system = family(0.6, 0.25)?;
/// let motion = orbit::settle(&system, &State::at_rest(1), 600.0, Period::Driven(1))?;
/// let branch = orbit::follow(|frequency| family(frequency, 0.25), 0.6, &motion, 0.6..0.8)?;
/// let touch = &branch.bifurcations[0];
/// let locus = orbit::locus(family, touch, 0.25, [0.5..2.0, 0.01..0.6])?;
/// assert_eq!(locus.kind, LocusKind::Grazing { contact: 0 });
/// for point in &locus.points {
///     let [frequency, force] = point.parameters;
///     let detuning = 1.0 - frequency * frequency;
///     let known = 0.35 * detuning.hypot(0.06 * frequency) / frequency;
///     assert!((force - known).abs() < 1e-13);
/// }
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "continuation")]
#[doc(alias = "codimension two")]
pub fn locus<S: Oscillator>(
    family: impl Fn(f64, f64) -> Result<S, Error>,
    at: &Bifurcation<S::State>,
    second: f64,
    ranges: [Range<f64>; 2],
) -> Result<Locus<S::State>, Error> {
    Search::new().locus(family, at, second, ranges)
}

impl Search<'_> {
    /// Calls the function [`locus`] with the bounds and the watcher of this search.
    ///
    /// # Errors
    ///
    /// The errors of [`locus`]; [`Error::Stopped`] if the watcher stops the search before the first
    /// point.
    pub fn locus<S: Oscillator>(
        &self,
        family: impl Fn(f64, f64) -> Result<S, Error>,
        at: &Bifurcation<S::State>,
        second: f64,
        ranges: [Range<f64>; 2],
    ) -> Result<Locus<S::State>, Error> {
        self.locus_of(&family, at, second, ranges)
    }

    /// Computes [`locus`](Self::locus), compiled once for all functions that give such systems.
    fn locus_of<S: Oscillator>(
        &self,
        family: &SystemsOfTwo<'_, S>,
        at: &Bifurcation<S::State>,
        second: f64,
        ranges: [Range<f64>; 2],
    ) -> Result<Locus<S::State>, Error> {
        let of = "orbit::locus";
        check_ranges(of, &ranges)?;
        let inside = "inside its range";
        let values = [(at.parameter, "at.parameter"), (second, "second")];
        for ((value, name), range) in values.into_iter().zip(&ranges) {
            let is_inside = (range.start..=range.end).contains(&value);
            Error::check(of, name, value, is_inside, inside)?;
        }
        let members = |first: f64, second: f64| member(family(first, second));
        let place = |error: Error| error.at_pair([at.parameter, second]);
        let system = family(at.parameter, second).map_err(place)?;
        let form = system.form();
        let watched = self.watch("parameter");
        let start = vector(&at.orbit.state().general(), form.order());
        let mut motions = Motions::new(
            &members,
            at.orbit.kind(),
            [0, 1].map(|i: usize| ranges[i].end - ranges[i].start),
            [form.len(), form.order()],
            (self.of_locus(), &watched),
        );
        let period = at.orbit.period();
        let smooth = match at.kind {
            BifurcationKind::Fold => Smooth::Fold,
            BifurcationKind::Flip => Smooth::Flip,
            BifurcationKind::NeimarkSacker => Smooth::Torus,
            BifurcationKind::Pitchfork => {
                let y = motions.at(&start, period, [at.parameter, second]);
                let trial = motions.trial(&y, &FrozenStart::at_zero())?;
                motions.close_by_half(&y, &trial)?;
                Smooth::Flip
            }
            BifurcationKind::Grazing | BifurcationKind::Sequence => {
                let events = at.orbit.events().iter();
                let events: Vec<_> = events.map(|e| (e.time, e.element, e.kind)).collect();
                let y = motions.at(&start, period, [at.parameter, second]);
                let begun = away(&motions, y)?;
                let change = changing(&motions, &begun, at.kind, &events)?;
                let (y, begin) = begun;
                let curve = EventCurve {
                    motions,
                    kind: change.kind,
                    ranges,
                    growth: Cell::new(1.0),
                };
                let begin = FrozenStart {
                    holds: change.holds,
                    marks: change.marks,
                    ..begin
                };
                let (y, near) = curve.begin(&y, &begin)?;
                return found(family, at.orbit.kind(), change.kind, &curve, (&y, &near));
            }
        };
        let kind = match smooth {
            Smooth::Fold => LocusKind::Fold,
            Smooth::Flip if motions.half.is_some() => LocusKind::Pitchfork,
            Smooth::Flip => LocusKind::Flip,
            Smooth::Torus => LocusKind::NeimarkSacker,
        };
        let curve = SmoothCurve {
            motions,
            kind: smooth,
            ranges,
        };
        let parameters = [at.parameter, second];
        let multipliers = at.orbit.multipliers();
        let (y, near) = curve.begin(&start, period, parameters, multipliers)?;
        found(family, at.orbit.kind(), kind, &curve, (&y, &near))
    }
}

/// The start of a motion, away from its events if it is one of time 0 of the drives. That of an
/// autonomous motion is so already.
fn away(motions: &Motions<'_>, y: DVector<f64>) -> Result<(DVector<f64>, FrozenStart), Error> {
    let begin = FrozenStart::at_zero();
    if motions.is_free() {
        return Ok((y, begin));
    }
    let trial = motions.trial(&y, &begin)?;
    motions.begun(&y, &trial, &begin)
}

/// The change of events at a motion, with its own events since time 0: time, element and kind.
fn changing(
    motions: &Motions<'_>,
    (y, begin): &(DVector<f64>, FrozenStart),
    kind: BifurcationKind,
    events: &[(f64, Element, EventKind)],
) -> Result<Change, Error> {
    /// The largest distance of the motion from the change, in units of its sizes.
    const NEAR: f64 = 1e-4;
    let parameters = motions.parameters(y);
    let at = |error: Error| error.at_pair(parameters);
    let search = |trial: &TrialMotion, sticks: Option<bool>| {
        motions.with(parameters, |form| {
            Ok(match kind {
                BifurcationKind::Sequence => sequence(form, &trial.map, trial.period),
                _ => touch(form, &trial.map, trial.period, sticks),
            })
        })
    };
    let trial = motions.trial(y, begin)?;
    let since = begin.phase * trial.period;
    if kind == BifurcationKind::Grazing {
        // At the end of a branch the motion is caught where rounding may let it pass.
        for hold in motions.with(parameters, |form| Ok(arrivals(form, &trial, events)))? {
            let begin = FrozenStart {
                holds: vec![hold.later(since, trial.period)],
                ..begin.clone()
            };
            let caught = motions.trial(y, &begin)?;
            let Some(Touch { hold, speed, .. }) = caught.map.touches.first().copied() else {
                continue;
            };
            let size = motions.with(parameters, |form| {
                let contact = &form.model.contacts[hold.contact];
                let sizes = caught.map.sizes();
                Ok(contact.size_along(|j| sizes[motions.n + j]))
            })?;
            if speed.abs() <= NEAR * size && caught.residual <= NEAR {
                let contact = hold.contact;
                return Ok(Change {
                    kind: LocusKind::Grazing { contact },
                    holds: vec![hold],
                    marks: Vec::new(),
                    size: speed.abs() / size,
                });
            }
        }
    }
    let change = search(&trial, Some(false))?;
    change
        .filter(|change| change.size <= NEAR)
        .ok_or_else(|| at(Error::NotSmooth))
}

/// The curve with its motions, from a guess.
fn found<'f, S: Oscillator, E: CurveOfMotions<'f>>(
    family: &SystemsOfTwo<'_, S>,
    period: Period,
    kind: LocusKind,
    curve: &E,
    (y, near): (&DVector<f64>, &E::Value),
) -> Result<Locus<S::State>, Error> {
    let motions = curve.motions();
    let first = first_point(curve, y, near)?;
    let (points, special, ends) = both_ways(curve, &first);
    let orbit = |point: &Point<E::Value>| {
        let parameters = motions.parameters(&point.y);
        let find = || {
            let (trial, _) = E::motion(&point.value);
            let system = family(parameters[0], parameters[1])?;
            Orbit::new(&system, &system.form(), trial.clone(), period)
        };
        find().map_err(|error: Error| error.at_pair(parameters))
    };
    let points = points.iter().map(|point| {
        Ok(LocusPoint {
            parameters: motions.parameters(&point.y),
            orbit: orbit(point)?,
        })
    });
    let points = points.collect::<Result<_, Error>>()?;
    let special = special.iter().map(|(kind, point)| {
        Ok(SpecialPoint {
            kind: *kind,
            parameters: motions.parameters(&point.y),
            orbit: orbit(point)?,
        })
    });
    Ok(Locus {
        kind,
        points,
        special: special.collect::<Result<_, Error>>()?,
        ends,
    })
}
