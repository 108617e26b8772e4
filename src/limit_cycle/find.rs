//! The search for all cycles of a mass on a belt: its maps, their order and range, and the cases of
//! a belt at rest, of no friction and of a continuum.

use super::arc::Tracer;
use super::continuum::{Continuum, flat_amplitude, is_flat, is_frictionless};
use super::crossings::CrossingMap;
use super::cycle::{CycleKind, LimitCycle};
use super::peaks::{PeakMap, SMALLEST_PEAK};
use super::release::Release;
use super::set::CycleSet;
use crate::belt::{Belt, Forward, MassOnBelt};
use crate::error::Error;
use crate::friction::FrictionLaw;

/// The periodic motion through the [release point](MassOnBelt::release_state). `None` if the motion
/// from the release point never returns to it, or if the belt is at rest.
///
/// Its [`kind`](LimitCycle::kind) is [`CycleKind::StickSlip`] or, if the mass overtakes the belt
/// before it sticks, [`CycleKind::Overshoot`]. The search computes one slip arc for the first kind
/// and two for the second. [`analysis::StickSlip`](crate::analysis::StickSlip) has approximate
/// closed formulas for the first kind.
///
/// # Errors
///
/// [`Error::NonFiniteFriction`], [`Error::NotAnalytic`], [`Error::StepUnderflow`] and
/// [`Error::TooManySteps`], as in [`Integrator::simulate`](crate::Integrator::simulate).
///
/// ```
/// use stick_slip::{CycleKind, Exponential, MassOnBelt, limit_cycle};
///
/// let law = Exponential::new(0.4, 0.25, 0.5)?;
/// let system = MassOnBelt::new(law, 0.2)?.with_damping(0.05)?;
/// let cycle = limit_cycle::stick_slip(&system)?.unwrap();
/// assert_eq!(cycle.kind(), CycleKind::StickSlip);
/// assert!((cycle.period() - 6.430323266948723979).abs() < 1e-14);
/// // At small belt velocities this law lets the mass slide steadily.
/// assert_eq!(limit_cycle::stick_slip(&system.with_belt_velocity(0.05)?)?, None);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "release point")]
#[doc(alias = "squeal")]
pub fn stick_slip<L: FrictionLaw>(system: &MassOnBelt<L>) -> Result<Option<LimitCycle>, Error> {
    stick_slip_of(system.belt())
}

fn stick_slip_of(system: Belt<'_>) -> Result<Option<LimitCycle>, Error> {
    let Some(forward) = Forward::of(system) else {
        return Ok(None);
    };
    let mut tracer = Tracer::new(forward);
    let mut cycle = Release::follow(&mut tracer)?.into_cycle(&mut tracer)?;
    if system.belt_velocity() < 0.0 {
        cycle.iter_mut().for_each(LimitCycle::mirror);
    }
    Ok(cycle)
}

/// The periodic motions of a system, stable and unstable, for any belt velocity: all isolated
/// cycles within [stated limits](crate::limit_cycle#what-is-guaranteed), a continuous family if
/// there is one, and the ranges that are not resolved.
///
/// Source: return maps between a planar flow's crossings of a line (Guckenheimer and Holmes,
/// *Nonlinear Oscillations, Dynamical Systems, and Bifurcations of Vector Fields*, Springer 1983,
/// section 1.5).
///
/// # Errors
///
/// [`Error::NonFiniteFriction`], [`Error::NotAnalytic`], [`Error::StepUnderflow`] and
/// [`Error::TooManySteps`], as in [`Integrator::simulate`](crate::Integrator::simulate).
///
/// ```
/// use stick_slip::{CycleKind, Exponential, MassOnBelt, limit_cycle};
///
/// // A stable equilibrium and stick-slip side by side, an unstable cycle between them.
/// let law = Exponential::new(0.6, 0.3, 0.4)?;
/// let system = MassOnBelt::new(law, 1.0)?.with_damping(0.01)?;
/// let cycles = limit_cycle::find(&system)?;
/// assert!(system.equilibrium().unwrap().is_stable());
/// let [inner, outer] = cycles.iter().collect::<Vec<_>>()[..] else { panic!() };
/// assert_eq!((inner.kind(), inner.is_stable()), (CycleKind::PureSlip, false));
/// assert!((inner.multiplier() - 1.098130594669941836).abs() < 1e-12);
/// assert_eq!((outer.kind(), outer.is_stable()), (CycleKind::StickSlip, true));
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "Poincaré")]
#[doc(alias = "Poincare")]
#[doc(alias = "limit cycles")]
#[doc(alias = "shooting")]
pub fn find<L: FrictionLaw>(system: &MassOnBelt<L>) -> Result<CycleSet, Error> {
    find_all(system.belt())
}

/// [`find`] for any law.
pub(crate) fn find_all(system: Belt<'_>) -> Result<CycleSet, Error> {
    let Some(forward) = Forward::of(system) else {
        return Ok(of_belt_at_rest(system));
    };
    let mut set = find_moving(&mut Tracer::new(forward))?;
    if system.belt_velocity() < 0.0 {
        set.mirror();
    }
    Ok(set)
}

/// [`find`] for a system whose belt moves forward.
#[inline(never)]
pub(crate) fn find_moving(tracer: &mut Tracer<'_>) -> Result<CycleSet, Error> {
    let release = Release::follow(tracer)?;
    nested_cycles(tracer, release)
}

/// The periodic motions on a belt at rest: a family or none.
pub(super) fn of_belt_at_rest(system: Belt<'_>) -> CycleSet {
    CycleSet {
        continuum: Continuum::at_rest(system),
        ..CycleSet::default()
    }
}

/// The cycles of a system whose belt moves forward, from the inside outwards.
pub(super) fn nested_cycles(
    tracer: &mut Tracer<'_>,
    mut release: Release,
) -> Result<CycleSet, Error> {
    let mut set = CycleSet::default();
    if !add_pure_slip(tracer, &mut set)? {
        return Ok(set);
    }
    let fate = release.fate(tracer)?;
    set.add(release.into_cycle(tracer)?);
    let mut crossings = CrossingMap::of(tracer);
    let forces = crossings.roots(fate)?;
    for &force in &forces.roots {
        set.add(crossings.cycle(force)?);
    }
    for range in &forces.unresolved {
        let ends = [crossings.cycle(range.start)?, crossings.cycle(range.end)?];
        if let [Some(inner), Some(outer)] = ends {
            set.unresolved
                .push(inner.max_velocity()..outer.max_velocity());
        }
    }
    Ok(set)
}

/// Adds the periodic motions in slip. Returns false without friction, because there are then no
/// others.
fn add_pure_slip(tracer: &mut Tracer<'_>, set: &mut CycleSet) -> Result<bool, Error> {
    let system = tracer.system();
    let mut peaks = PeakMap::of(tracer);
    if peaks.is_continuum()? {
        if is_frictionless(system.law()) {
            set.continuum = Some(Continuum::WITHOUT_FRICTION);
            return Ok(false);
        }
        let max_amplitude = system.belt_velocity();
        set.continuum = Some(Continuum { max_amplitude });
        return Ok(true);
    }
    let mut found = peaks.roots()?;
    if is_flat(&system) {
        // Motions are harmonic up to the amplitude at which they meet a speed where friction
        // varies.
        let smallest = SMALLEST_PEAK * system.belt_velocity();
        let mut hidden = smallest;
        if let Some(first) = found.unresolved.first()
            && first.start <= smallest
        {
            hidden = found.unresolved.remove(0).end;
        }
        let max_amplitude = flat_amplitude(&system).min(hidden);
        set.continuum = Some(Continuum { max_amplitude });
        // Just outside the continuum growth sets in gently, and rounding may give it both signs.
        for root in std::mem::take(&mut found.roots) {
            let between = 0.5 * (max_amplitude + root);
            if max_amplitude < root && !peaks.growth(between)?.vanishes() {
                found.roots.push(root);
            }
        }
    }
    set.unresolved = found.unresolved;
    for &peak in &found.roots {
        let (arc, multiplier) = peaks.cycle(peak)?;
        let cycle = LimitCycle::join(&system, vec![arc], CycleKind::PureSlip, multiplier);
        set.cycles.push(cycle);
    }
    Ok(true)
}

#[cfg(test)]
mod tests;
