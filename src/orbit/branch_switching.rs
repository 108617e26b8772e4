//! Branch switching: from a flip to the motions of twice the period, from a pitchfork to the
//! motions without the symmetry.

use nalgebra::DVector;

use super::branch::{Bifurcation, BifurcationKind, BranchPoint};
use super::branch_equations::{Curve, Solved};
use super::branch_predictor::LocalCurve;
use super::follow::anchor;
use super::half_map::HalfMap;
use super::oscillator::Oscillator;
use super::period::Period;
use super::period_map::vector;
use super::periodic_orbit::Orbit;
use super::pseudo_arclength::natural_scale;
use super::shooting_residual::TrialMotion;
use crate::belt::Criticality;
use crate::error::Error;
use crate::motion::SystemState;
use crate::motion::sealed::State as _;
use crate::numerics::trace::Plane;
use crate::search::Search;
use crate::state::structure::State;

/// Distances from the bifurcation at which the other branch is met, in units of the sizes. The
/// equations are conditioned like their reciprocals.
const AWAY: [f64; 6] = [1e-2, 3e-3, 3e-2, 1e-3, 3e-4, 1e-4];

/// A branch leads to the bifurcation if, each time its distance is halved, that of the parameter
/// falls at least by this factor: on a smooth branch it is a quarter. Below a part of the range the
/// distance is rounding.
const HALVINGS: usize = 2;
const NEARER: f64 = 0.5;
const ROUNDING: f64 = 1e-9;

/// Distances in the parameter between motions that give the tangent, in units of the range.
const BESIDE: [f64; 2] = [1e-3, 1e-4];

/// The least part of its distance by which a motion found differs from its image under the map over
/// half the period.
const APART: f64 = 0.5;

impl<S: SystemState> Bifurcation<S> {
    /// A motion near a flip or a pitchfork, on the branch that is born there. Pass the motion to
    /// [`follow`](super::follow()) to compute this branch.
    ///
    /// `family` is the family that was followed. At a flip the new motion has twice the period. At
    /// a pitchfork the new motion lacks the symmetry; its mirror image is a second new motion. Let
    /// G be the map over half the period of the new motion. At a pitchfork, the reflection of
    /// [`BifurcationKind::Pitchfork`] follows, and is part of G. Let x0 be the start of the motion
    /// at the bifurcation, and w the eigenvector with G'w = −w of the Jacobian matrix G'. With a
    /// small amplitude ε, the start x of the new motion is sought near x0 + εw. The unknowns are
    /// those of [`follow`](super::follow()), and the motion is sought on a plane in their space
    /// that is parallel to the old branch. The equations are
    ///
    /// ```text
    /// G(G(x)) = x,    wᵀ(x − G(x))/wᵀw ≈ 2ε.
    /// ```
    ///
    /// The amplitudes |ε| = 10⁻², 3·10⁻³, 3·10⁻², 10⁻³, 3·10⁻⁴ and 10⁻⁴, relative to the size of
    /// the motion, are tried one after the other. The parameter differs from that of the
    /// bifurcation by an amount of order ε². Other branches of such motions may lie as near. A
    /// motion is therefore the result only if its branch leads to the bifurcation: at ε/2 and at
    /// ε/4 this difference falls at least by half each time. Between the bifurcation and the motion
    /// the events of the branch may change. [`criticality`](Self::criticality) returns the side on
    /// which the new motions exist.
    ///
    /// At the bifurcation the new branch turns back. At a flip it then runs through the same
    /// motions again, begun half a period later; at a pitchfork, through their mirror images.
    /// [`follow`](super::follow()) reports a [`BifurcationKind::Fold`] at this point. Where
    /// the branch meets the old motions at a change of the events, it ends with
    /// [`BranchEnd::Birth`](super::BranchEnd::Birth).
    ///
    /// Source: Kuznetsov, *Elements of Applied Bifurcation Theory*, section 10.2 (branch
    /// switching); J. W. Swift, K. Wiesenfeld, *Phys. Rev. Lett.* 52 (1984) 705 (symmetric
    /// motions).
    ///
    /// # Errors
    ///
    /// [`Error::NoSwitch`] for other kinds of bifurcation; [`Error::At`], with the parameter, if
    /// the family returns an error at this parameter, or if no motion of the new branch is found.
    ///
    /// ```
    /// use stick_slip::orbit::{self, BifurcationKind, Criticality, Period};
    /// use stick_slip::{Contact, Coulomb, Drive, Error, Structure, structure::State};
    ///
    /// // A mass on a belt under a harmonic force, over the amplitude of the force.
    /// let family = |force: f64| -> Result<Structure, Error> {
    ///     Structure::new(&[1.0])?
    ///         .with_ground_spring(0, 1.0)?
    ///         .with_ground_damper(0, 0.02)?
    ///         .with_force(0, Drive::harmonic(force, 0.72, 0.0)?)?
    ///         .with_contact(Contact::new(0, Coulomb::new(0.5, 0.3)?, 1.5)?.on_belt(0.1))
    /// };
    /// let start = State::new(&[0.3], &[0.0]);
    /// let orbit = orbit::settle(&family(0.3)?, &start, 400.0, Period::Driven(1))?;
    /// let branch = orbit::follow(family, 0.3, &orbit, 0.28..0.4)?;
    /// let mut found = branch.bifurcations.iter();
    /// let flip = found.find(|found| found.kind == BifurcationKind::Flip).unwrap();
    ///
    /// // Below the flip the old motion is stable, and the motion of twice the period is unstable.
    /// let doubled = flip.switch(family)?;
    /// assert_eq!(doubled.orbit.kind(), Period::Driven(2));
    /// assert!(doubled.parameter < flip.parameter && !doubled.orbit.is_stable());
    /// assert_eq!(flip.criticality(&doubled), Criticality::Subcritical);
    /// let branch = orbit::follow(family, doubled.parameter, &doubled.orbit, 0.28..0.4)?;
    /// assert!(branch.points.len() > 10);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    #[doc(alias = "period doubling")]
    #[doc(alias = "branch point")]
    pub fn switch<T: Oscillator<State = S>>(
        &self,
        family: impl Fn(f64) -> Result<T, Error>,
    ) -> Result<BranchPoint<S>, Error> {
        Search::new().switch(self, family)
    }

    /// Returns the side of the bifurcation on which the new motions exist. The bifurcation is
    /// supercritical if the old motion is unstable on this side, and subcritical if the old motion
    /// is stable. `born` is one of the new motions, found by [`switch`](Self::switch).
    ///
    /// The result is degenerate if the multipliers do not determine the side, for example if other
    /// multipliers lie near the unit circle.
    pub fn criticality(&self, born: &BranchPoint<S>) -> Criticality {
        let to = match self.kind {
            BifurcationKind::Flip => -1.0,
            _ => 1.0,
        };
        let unstable = |orbit: &Orbit<S>| {
            let multipliers = orbit.multipliers().iter();
            multipliers.filter(|m| m.norm() > 1.0).count()
        };
        let own = self.orbit.multipliers().iter();
        let own = own.min_by(|a, b| (*a - to).norm().total_cmp(&(*b - to).norm()));
        let own = own.is_some_and(|own| own.norm() > 1.0);
        let others = unstable(&self.orbit) - usize::from(own);
        match unstable(&born.orbit).checked_sub(others) {
            Some(0) => Criticality::Supercritical,
            Some(1) => Criticality::Subcritical,
            _ => Criticality::Degenerate,
        }
    }
}

impl Search<'_> {
    /// Calls the function [`Bifurcation::switch`] with the watcher of this search.
    ///
    /// # Errors
    ///
    /// The errors of [`Bifurcation::switch`]; [`Error::Stopped`] if the watcher stops the search.
    pub fn switch<S: Oscillator>(
        &self,
        from: &Bifurcation<S::State>,
        family: impl Fn(f64) -> Result<S, Error>,
    ) -> Result<BranchPoint<S::State>, Error> {
        let (is_symmetric, kind) = match (from.kind, from.orbit.kind()) {
            (BifurcationKind::Pitchfork, kind) => (true, kind),
            (BifurcationKind::Flip, Period::Driven(count)) => (false, Period::Driven(2 * count)),
            (BifurcationKind::Flip, Period::Free(period)) => (false, Period::Free(2.0 * period)),
            (kind, _) => return Err(Error::NoSwitch { kind: kind.name() }),
        };
        let period = from.orbit.period() * if is_symmetric { 1.0 } else { 2.0 };
        let start = from.orbit.state().general();
        let (parameter, trial) = self.over(&family, kind, from.range.clone(), |curve| {
            other_branch(curve, &start, (period, from.parameter), is_symmetric)
        })?;
        BranchPoint::of(&family, parameter, trial, kind)
    }
}

/// A motion on the branch that crosses at a bifurcation, and its parameter. The motion there is
/// given by its start, and by its period on the other branch.
fn other_branch(
    mut curve: Curve<'_>,
    start: &State,
    (period, parameter): (f64, f64),
    is_symmetric: bool,
) -> Result<(f64, TrialMotion), Error> {
    let mut here = anchor(&mut curve, parameter, start, period)?;
    let lost = |here: &Solved| curve.lost(&here.y, &here.trial);
    let (map, order, last) = (&here.trial.map, curve.order, curve.unknowns() - 1);
    let sizes = map.sizes();
    let (half, _) = curve.motion(&here.y, &here.begin, 0.5)?;
    let half_map = if is_symmetric {
        let found = HalfMap::of_symmetric(map, here.trial.period);
        found.ok_or_else(|| lost(&here))?
    } else {
        HalfMap::of_doubled(order)
    };
    let inverted = half_map.inverted(&half, &sizes);
    let inverted = inverted.ok_or_else(|| lost(&here))?;
    let mut across = DVector::zeros(last + 1);
    across.rows_mut(0, order).copy_from(&inverted);
    if let Some(condition) = &here.begin.condition {
        // Projected on the section, along the motion.
        let flow = &map.flow[0];
        let [part, rate] = [&inverted, flow].map(|vector| condition.speed(vector));
        across.rows_mut(0, order).axpy(-part / rate, flow, 1.0);
    }
    let scale = natural_scale(&curve, &here);
    let scaled = |y: &DVector<f64>| y.component_div(&scale);
    here.tangent = DVector::from_fn(last + 1, |i, _| if i == last { 1.0 } else { 0.001 });
    let tangent = tangent(&curve, &here, &scale).ok_or_else(|| lost(&here))?;
    let direction = scaled(&across);
    let normal = &direction - &tangent * tangent.dot(&direction);
    let slope = normal.dot(&direction);
    let origin = normal.dot(&scaled(&here.y));
    let mut failure = lost(&here);
    // The motion of the other branch at a distance; `None` if the motion found is of the old one.
    let met = |away: f64, guess: &DVector<f64>| -> Result<Option<Solved>, Error> {
        let plane = Plane {
            scale: &scale,
            normal: &normal / slope,
            value: origin / slope + away,
            along: &direction,
        };
        let found = curve.solve(guess, &here, &plane)?;
        let (half, _) = curve.motion(&found.y, &found.begin, 0.5)?;
        let start = vector(&half.start, order);
        let image = vector(&half_map.applied(half).end, order);
        let missed = (start - image).component_div(&sizes);
        let weights = inverted.component_div(&sizes);
        let missed = missed.dot(&weights) / weights.norm_squared();
        Ok((missed.abs() >= APART * 2.0 * away.abs()).then_some(found))
    };
    let apart = |found: &Solved| (curve.parameter(&found.y) - parameter).abs();
    // Other branches of such motions may lie as near.
    let leads_here = |found: &Solved, away: f64| {
        let (mut away, mut farther) = (away, found.clone());
        (0..HALVINGS).all(|_| {
            away *= 0.5;
            let mut guess = &here.y + (&farther.y - &here.y) * 0.5;
            guess[last] = parameter + 0.25 * (curve.parameter(&farther.y) - parameter);
            let Ok(Some(nearer)) = met(away, &guess) else {
                return false;
            };
            let is_nearer = apart(&nearer) <= NEARER * apart(&farther);
            let is_rounding = apart(&nearer) <= ROUNDING * curve.width();
            farther = nearer;
            is_nearer || is_rounding
        })
    };
    for away in AWAY.iter().flat_map(|away| [*away, -away]) {
        match met(away, &(&here.y + &across * away)) {
            Ok(Some(found)) if leads_here(&found, away) => {
                return Ok((curve.parameter(&found.y), found.trial));
            }
            Ok(_) => {}
            Err(error) => failure = error,
        }
    }
    Err(failure)
}

/// The tangent of the old branch at a point, in units of the scales: at the bifurcation itself its
/// equations are singular.
fn tangent(curve: &Curve<'_>, here: &Solved, scale: &DVector<f64>) -> Option<DVector<f64>> {
    let view = LocalCurve {
        curve,
        base: here,
        scale,
    };
    let parameter = curve.parameter(&here.y);
    let mut tangents = BESIDE.iter().filter_map(|beside| {
        let change = beside * curve.width();
        let at =
            |parameter: f64| Some(view.with_parameter(parameter, &here.y, here).ok()?.solved.y);
        let (low, high) = (at(parameter - change), at(parameter + change));
        let way = match (low, high) {
            (Some(low), Some(high)) => high - low,
            (Some(low), None) => &here.y - low,
            (None, Some(high)) => high - &here.y,
            (None, None) => return None,
        };
        Some(way.component_div(scale).normalize())
    });
    tangents.next()
}
