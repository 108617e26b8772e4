//! Curves of bifurcations in two parameters.

mod bordered;
pub(super) mod found;
mod motions;
mod smooth;

use std::ops::Range;

use nalgebra::DVector;

use self::found::{Locus, LocusEnd, LocusKind, LocusPoint, SpecialKind, SpecialPoint};
use self::motions::Motions;
use self::smooth::{Motion, Smooth, SmoothCurve};
use super::branch::{Bifurcation, BifurcationKind};
use super::curve::Member;
use super::found::Orbit;
use super::map::vector;
use super::oscillator::Oscillator;
use crate::error::Error;
use crate::numerics::trace::{self, Equations, Plane, Point, check_ranges, trace};

/// The curve through a bifurcation, in two parameters of the system.
///
/// `family` returns the system for values of the two parameters, which may be anything that a
/// closure can set. `at` is a bifurcation over the first parameter, as [`follow`](super::follow)
/// finds it, and `second` the value of the second parameter at which it was found. Both lie in
/// their ranges.
///
/// The start x, the period T of an autonomous motion and both parameters p, q satisfy
///
/// ```text
/// P(x, T; p, q) − x = 0,    g(x, T; p, q) = 0,
/// ```
///
/// P the period map, g a scalar that is 0 exactly where a multiplier is 1 (fold), −1 (flip), or a
/// pair is exp(±iθ) (Neimark-Sacker): that of a bordered matrix. The curve is followed by
/// pseudo-arclength continuation, also through cusps. The monodromy matrix is exact; its
/// derivatives are differences between motions with the same events. They determine the steps of
/// Newton's method, not its result: parameters are exact to the rounding of the map, which it
/// magnifies near events that become tangential.
///
/// Special points are zeros of test functions along the curve:
///
/// | curve | special points |
/// |---|---|
/// | fold | [`Cusp`](SpecialKind::Cusp), 1:1 resonance, fold-flip, fold-Neimark-Sacker |
/// | flip | 1:2 resonance, fold-flip, flip-Neimark-Sacker |
/// | Neimark-Sacker | resonances 1:1 and 1:2, at which the curve ends, 1:3 and 1:4; fold-, flip- and double Neimark-Sacker |
///
/// Two zeros of one test within a step (1/64 of the ranges at most) can be missed. The coefficients
/// of normal forms (generalised flip, Chenciner) are not computed.
///
/// A curve keeps the kind of its bifurcation only while the events of the motion stay the same, or
/// the map stays smooth where they change. Elsewhere it ends with [`LocusEnd::Jump`]. A curve of an
/// autonomous motion that shrinks to a point ends with [`LocusEnd::Hopf`], good to about 1e-8 of
/// the ranges, by extrapolation.
///
/// Work: about ten motions for each step of Newton's method; at most 2048 points, 2·10⁵ motions and
/// 2·10⁷ of their steps in each direction.
///
/// Sources: Govaerts, *Numerical Methods for Bifurcations of Dynamical Equilibria*, chapters 3 and
/// 4; Kuznetsov, *Elements of Applied Bifurcation Theory*, chapters 9 and 10.
///
/// # Errors
///
/// [`Error::InvalidParameter`] unless the ranges are finite and not empty and hold the two values;
/// [`Error::NotSmooth`] for a change of events ([`BifurcationKind::Grazing`],
/// [`BifurcationKind::Sequence`]); [`Error::At`], with the parameters, if the family has no system
/// there, or no such bifurcation is found there (as for a fold that is a pitchfork of a symmetric
/// system).
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
/// // The period doubles along a curve, up to frequency 0.72 on one side.
/// let locus = orbit::locus(family, flip, 0.3, [0.72..0.9, 0.1..0.5])?;
/// assert_eq!(locus.ends, [LocusEnd::Ranges, LocusEnd::Ranges]);
/// for point in &locus.points {
///     assert!((point.orbit.multipliers()[0].re + 1.0).abs() < 1e-10);
/// }
/// let end = locus.points.iter().find(|point| point.parameters[0] == 0.72).unwrap();
/// assert!((end.parameters[1] - 0.3444628189675873).abs() < 1e-13);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "continuation")]
#[doc(alias = "codimension two")]
pub fn locus<S: Oscillator>(
    family: impl Fn(f64, f64) -> Result<S, Error>,
    at: &Bifurcation<S>,
    second: f64,
    ranges: [Range<f64>; 2],
) -> Result<Locus<S>, Error> {
    let of = "orbit::locus";
    check_ranges(of, &ranges)?;
    let inside = "inside its range";
    let values = [(at.parameter, "at.parameter"), (second, "second")];
    for ((value, name), range) in values.into_iter().zip(&ranges) {
        let is_inside = (range.start..=range.end).contains(&value);
        Error::check(of, name, value, is_inside, inside)?;
    }
    let members = |first: f64, second: f64| -> Result<Box<dyn Member + '_>, Error> {
        Ok(Box::new(family(first, second)?))
    };
    let (kind, smooth) = match at.kind {
        BifurcationKind::Fold => (LocusKind::Fold, Smooth::Fold),
        BifurcationKind::Flip => (LocusKind::Flip, Smooth::Flip),
        BifurcationKind::NeimarkSacker => (LocusKind::NeimarkSacker, Smooth::Torus),
        BifurcationKind::Pitchfork | BifurcationKind::Grazing | BifurcationKind::Sequence => {
            return Err(Error::NotSmooth);
        }
    };
    let system = family(at.parameter, second)?;
    let form = system.form();
    let widths = [0, 1].map(|i: usize| ranges[i].end - ranges[i].start);
    let start = vector(&S::general(&at.orbit.state()), form.order());
    let curve = SmoothCurve {
        motions: Motions::new(&members, at.orbit.kind(), widths, &form),
        kind: smooth,
        ranges,
    };
    let parameters = [at.parameter, second];
    let multipliers = at.orbit.multipliers();
    let (y, near) = curve.begin(&start, at.orbit.period(), parameters, multipliers)?;
    let first = first_point(&curve, &y, &near)?;
    let (points, special, ends) = both_ways(&curve, &first);

    let orbit = |point: &Point<Motion>| {
        let [first, second] = curve.motions.parameters(&point.y);
        let find = || {
            let value = &point.value;
            let trial = curve
                .motions
                .since_zero(&point.y, &value.trial, &value.begin)?;
            let system = family(first, second)?;
            Orbit::new(&system, &system.form(), trial, at.orbit.kind())
        };
        find().map_err(|error: Error| {
            error
                .at("second parameter", second)
                .at("first parameter", first)
        })
    };
    let points = points.iter().map(|point| {
        Ok(LocusPoint {
            parameters: curve.motions.parameters(&point.y),
            orbit: orbit(point)?,
        })
    });
    let points = points.collect::<Result<_, Error>>()?;
    let special = special.iter().map(|(kind, point)| {
        Ok(SpecialPoint {
            kind: *kind,
            parameters: curve.motions.parameters(&point.y),
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

/// The first point, with the second parameter as given; at a turn of the curve, with the tangent
/// across it.
fn first_point(
    curve: &SmoothCurve<'_>,
    y: &DVector<f64>,
    near: &Motion,
) -> Result<Point<Motion>, Error> {
    let scale = curve.scale(y, near);
    let [first, second] = curve.parameters();
    let mut normal = DVector::zeros(y.len());
    normal[second] = 1.0;
    let mut along = DVector::from_element(y.len(), 0.001);
    along[first] = 1.0;
    along[second] = 1.0;
    let plane = Plane {
        scale: &scale,
        value: y[second] / scale[second],
        normal,
        along: &along,
    };
    let mut point = trace::solve(curve, y, near, &plane)?;
    point.y[second] = y[second];
    Ok(point)
}

type Parts = (
    Vec<Point<Motion>>,
    Vec<(SpecialKind, Point<Motion>)>,
    [LocusEnd; 2],
);

/// The curve in both directions from a point.
fn both_ways(curve: &SmoothCurve<'_>, first: &Point<Motion>) -> Parts {
    let walk = |first: &Point<Motion>| {
        curve.motions.begin_again();
        trace(curve, first)
    };
    let end = |half: &trace::Half<Motion>| {
        let last = half.points.last().unwrap_or(first);
        if let (trace::End::Lost(_), true) = (&half.end, curve.jumps_behind(last)) {
            return LocusEnd::Jump;
        }
        LocusEnd::of(half.end.clone(), curve.motions.parameters(&last.y))
    };
    let up = walk(first);
    let mut back = first.clone();
    back.tangent.neg_mut();
    let down = if up.end == trace::End::Closed {
        trace::Half {
            points: Vec::new(),
            special: Vec::new(),
            end: trace::End::Closed,
        }
    } else {
        walk(&back)
    };
    let ends = [end(&down), end(&up)];
    let special = down.special.into_iter().rev().chain(up.special);
    let special =
        special.filter_map(|(test, _, point)| Some((curve.special(test, &point)?, point)));
    let special = special.collect();
    let mut points = down.points;
    points.reverse();
    points.push(first.clone());
    points.extend(up.points);
    (points, special, ends)
}
