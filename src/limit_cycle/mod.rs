//! Periodic motions, exactly and without transients.
//!
//! The motion of the mass is a flow in the plane (u, v), and trajectories in a plane can't cross.
//! For v_b > 0 (v_b < 0 is its mirror image, and at v_b = 0 nothing is periodic but free vibration
//! without friction) every periodic motion is one of three:
//!
//! * it **sticks**, and then leaves stick at the release point: so it is found from the one or two
//!   slip arcs out of that point, and attracts with multiplier 0 ([`CycleKind::StickSlip`],
//!   [`CycleKind::Overshoot`]);
//! * it stays **behind the belt**, and then turns round the equilibrium: a fixed point of the map
//!   from one velocity maximum to the next ([`CycleKind::PureSlip`]);
//! * it **crosses** the belt velocity twice a period without sticking: a fixed point of the map
//!   from one downward crossing to the next ([`CycleKind::Crossing`]).
//!
//! Both maps are known with their derivatives, by the divergence of the flow: for a cycle that
//! never sticks
//!
//! ```text
//! multiplier = exp(−∮(2β + γ² dμ̂/ds) dτ) · Π v_r'(after)/v_r'(before) over its crossings.
//! ```
//!
//! # What is guaranteed
//!
//! [`stick_slip`] is complete: trajectories that can't cross leave no other possibility than those
//! that it tells apart. [`find`] divides the range of each map until the cubic through values and
//! slopes fits, and then keeps dividing wherever that cubic comes near a fixed point. It loses a
//! pair of cycles only if their peak velocities differ by less than 10⁻⁹ of the range, or if the
//! map turns twice inside an interval in which its cubic fits to 2 %. Pure-slip cycles with a peak
//! velocity below 10⁻⁴ v_b are not looked for, nor crossing cycles with forces above 16(γ²μ_s +
//! |v_b|). Cycles that double precision can't resolve, because neighbouring numbers lie on
//! different sides of them by far, are reported as [`unresolved`](CycleSet::unresolved).

mod arc;
mod basin;
mod cycle;
mod maps;
mod roots;
#[cfg(test)]
mod testing;
#[cfg(feature = "serde")]
mod written;

pub use basin::{Attractor, attractor};
pub use cycle::{CycleKind, EnergyBudget, LimitCycle};

use std::ops::Range;

use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::{FrictionLaw, has_no_kinetic_friction};
pub(crate) use arc::Tracer;
pub(crate) use maps::{Contacts, ReleaseFate};

/// The periodic motion through the release point, whatever its kind; `None` where the motion from
/// there never comes back to it, and at v_b = 0.
///
/// Costs one slip arc for plain stick-slip and two for overshoot.
///
/// # Errors
///
/// Those of [`Integrator::simulate`](crate::Integrator::simulate) that concern the law or the
/// length of steps.
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
pub fn stick_slip<L: FrictionLaw>(system: &MassOnBelt<L>) -> Result<Option<LimitCycle>, Error> {
    forward(system, |system| {
        let fate = Tracer::new(system).release_fate()?;
        Ok(through_release(system, fate))
    })
    .map(|cycle| cycle.flatten().map(|cycle| facing(system, cycle)))
}

/// All isolated periodic motions, stable and unstable, for any v_b.
///
/// # Errors
///
/// Those of [`Integrator::simulate`](crate::Integrator::simulate) that concern the law or the
/// length of steps.
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
pub fn find<L: FrictionLaw>(system: &MassOnBelt<L>) -> Result<CycleSet, Error> {
    let set = forward(system, |system| {
        let mut tracer = Tracer::new(system);
        let fate = tracer.release_fate()?;
        find_with(&mut tracer, &fate)
    })?;
    let Some(mut set) = set else {
        // A belt at rest: of undamped motions only those without friction go on.
        let frictionless = system.damping() == 0.0 && is_frictionless(system.law());
        return Ok(CycleSet {
            continuum: frictionless.then_some(Continuum::WITHOUT_FRICTION),
            ..CycleSet::default()
        });
    };
    set.cycles = set
        .cycles
        .into_iter()
        .map(|cycle| facing(system, cycle))
        .collect();
    Ok(set)
}

/// The cycles of a system moving forward, from the inside outwards.
fn find_with<L: FrictionLaw>(
    tracer: &mut Tracer<'_, L>,
    fate: &ReleaseFate,
) -> Result<CycleSet, Error> {
    let system = tracer.system();
    let mut set = CycleSet::default();
    if tracer.is_continuum()? {
        if is_frictionless(system.law()) {
            set.continuum = Some(Continuum::WITHOUT_FRICTION);
            return Ok(set);
        }
        let max_amplitude = system.belt_velocity();
        set.continuum = Some(Continuum { max_amplitude });
    } else {
        let mut peaks = tracer.pure_slip_peaks()?;
        if tracer.is_flat() && !peaks.unresolved.is_empty() {
            // Up to where the motion meets a speed at which friction does vary; inside it is
            // harmonic.
            let max_amplitude = peaks.unresolved.remove(0).end;
            set.continuum = Some(Continuum { max_amplitude });
        }
        set.unresolved = peaks.unresolved;
        for peak in peaks.roots {
            let (arc, multiplier) = tracer.pure_slip(peak)?;
            let cycle = LimitCycle::join(system, [arc], CycleKind::PureSlip, multiplier);
            set.cycles.push(cycle);
        }
    }
    set.cycles.extend(through_release(system, fate.clone()));
    let forces = tracer.crossing_forces(fate)?;
    let mut crossing = |force: f64| -> Result<Option<LimitCycle>, Error> {
        Ok(tracer.crossing(force)?.map(|(arcs, multiplier)| {
            LimitCycle::join(system, arcs, CycleKind::Crossing, multiplier)
        }))
    };
    for force in forces.roots {
        set.cycles.extend(crossing(force)?);
    }
    for range in forces.unresolved {
        if let (Some(inner), Some(outer)) = (crossing(range.start)?, crossing(range.end)?) {
            set.unresolved
                .push(inner.max_velocity()..outer.max_velocity());
        }
    }
    Ok(set)
}

fn is_frictionless<L: FrictionLaw>(law: &L) -> bool {
    law.static_coefficient() == 0.0 && has_no_kinetic_friction(law)
}

/// A cycle of the system moving forward as one of the system itself.
fn facing<L: FrictionLaw>(system: &MassOnBelt<L>, cycle: LimitCycle) -> LimitCycle {
    if system.belt_velocity() < 0.0 {
        cycle.mirrored()
    } else {
        cycle
    }
}

fn through_release<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    fate: ReleaseFate,
) -> Option<LimitCycle> {
    let ReleaseFate::Stick { arcs } = fate else {
        return None;
    };
    let kind = match arcs[..] {
        [_] => CycleKind::StickSlip,
        _ => CycleKind::Overshoot,
    };
    Some(LimitCycle::join(system, arcs, kind, 0.0))
}

/// What a function finds for the system with its belt moving forward, where v_b ≠ 0.
fn forward<L: FrictionLaw, T>(
    system: &MassOnBelt<L>,
    find: impl FnOnce(&MassOnBelt<&L>) -> Result<T, Error>,
) -> Result<Option<T>, Error> {
    if system.belt_velocity() == 0.0 {
        return Ok(None);
    }
    find(&system.moving_forward()).map(Some)
}

/// The periodic motions of a system, by ascending amplitude.
///
/// ```
/// use stick_slip::{MassOnBelt, Polynomial, limit_cycle};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.4071)?.with_damping(0.05)?;
/// let cycles = limit_cycle::find(&system)?;
/// assert_eq!(cycles.len(), 1);
/// let cycle = cycles.stable().next().unwrap();
/// assert!((cycle.max_velocity() - 0.3436099223332305314).abs() < 1e-14);
/// assert!((cycle.multiplier() - 0.7118018577630064207).abs() < 1e-13);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct CycleSet {
    cycles: Vec<LimitCycle>,
    continuum: Option<Continuum>,
    unresolved: Vec<Range<f64>>,
}

impl CycleSet {
    /// The isolated cycles, by ascending amplitude. They lie one inside the other.
    pub fn iter(&self) -> std::slice::Iter<'_, LimitCycle> {
        self.cycles.iter()
    }

    /// The stable ones.
    pub fn stable(&self) -> impl Iterator<Item = &LimitCycle> {
        self.iter().filter(|cycle| cycle.is_stable())
    }

    /// How many isolated cycles there are.
    pub fn len(&self) -> usize {
        self.cycles.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.cycles.is_empty()
    }

    /// The family of periodic motions round the equilibrium, if every small motion is periodic.
    pub fn continuum(&self) -> Option<Continuum> {
        self.continuum
    }

    /// Peak velocities (largest v in the direction of the belt, dimensionless) between which double
    /// precision can't resolve whether there are cycles, and which: either the motion from one end
    /// of a narrow range dies and that from the other end grows, by far (one unstable cycle, or an
    /// odd number); or over the whole range a turn changes a motion by no more than rounding does.
    pub fn unresolved(&self) -> &[Range<f64>] {
        &self.unresolved
    }
}

impl<'s> IntoIterator for &'s CycleSet {
    type Item = &'s LimitCycle;
    type IntoIter = std::slice::Iter<'s, LimitCycle>;
    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}

/// A family of periodic motions that fills a disc round the equilibrium: without damping, friction
/// that does not depend on the speed (Coulomb, or μ_s = μ_m) neither feeds nor damps them.
///
/// ```
/// use stick_slip::{Coulomb, MassOnBelt, limit_cycle};
///
/// let cycles = limit_cycle::find(&MassOnBelt::new(Coulomb::new(0.4, 0.25)?, 0.2)?)?;
/// assert_eq!(cycles.continuum().unwrap().max_amplitude, 0.2);
/// assert_eq!(cycles.len(), 1); // and the stick-slip cycle round it
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Continuum {
    /// Amplitude of the largest of them, dimensionless: |v_b|, where it touches the belt velocity;
    /// less, where friction is constant only up to a breakpoint of the law; infinite without
    /// friction.
    #[cfg_attr(feature = "serde", serde(serialize_with = "written::infinite_as_none"))]
    pub max_amplitude: f64,
}

impl Continuum {
    const WITHOUT_FRICTION: Self = Self {
        max_amplitude: f64::INFINITY,
    };
}
