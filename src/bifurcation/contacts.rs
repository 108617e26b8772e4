//! Belt velocities at which the contacts of the motion from the release point change.

use std::ops::Range;

use super::range::{moving_at, positive};
use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::limit_cycle::{Release, Tracer};
use crate::numerics::scan::sign_changes;

/// Belt velocities v_b in `range`, ascending and dimensionless, at which stick-slip appears or
/// disappears: the motion from the release point comes back to the belt tangentially.
///
/// For a law with μ̂(0) = μ_s a pure-slip cycle touches the belt velocity at this v_b and becomes
/// stick-slip. For a law with μ̂(0) < μ_s (Coulomb) the stick-slip cycle disappears, and no
/// pure-slip cycle takes its place.
///
/// The velocities are the roots of a function of v_b that is smooth through them: w²/(2v_b²) if the
/// motion meets the belt, where w is the rate of the relative velocity at contact; V/v_b − 1 if it
/// turns back below, at a velocity maximum V. The range is divided into 64 intervals, and each in
/// which a root may hide into up to 2¹⁰ parts. If the range is a thousand times wider than the part
/// in which the system vibrates, nothing may be found: take a narrower one.
///
/// # Errors
///
/// [`Error::InvalidParameter`] unless the range is finite, not empty and holds positive velocities;
/// else [`Error::At`], with the belt velocity and one of the errors of
/// [`limit_cycle::find`](crate::limit_cycle::find).
///
/// ```
/// use stick_slip::{MassOnBelt, Polynomial, bifurcation};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let grazing = bifurcation::grazing_velocities(&system, 0.01..0.5)?;
/// assert_eq!(grazing.len(), 1);
/// assert!((grazing[0] - 0.395790288797834012).abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "sweep")]
#[doc(alias = "hysteresis")]
pub fn grazing_velocities<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    range: Range<f64>,
) -> Result<Vec<f64>, Error> {
    over_belt_velocities(system, range, &|release, tracer| {
        Ok(Some(release.overshoot(tracer)))
    })
}

/// Belt velocities in `range`, ascending and dimensionless, at which plain stick-slip changes into
/// overshoot or back: the first contact after release lies at the far end of the stick band.
///
/// The range is searched as densely as by [`grazing_velocities`].
///
/// # Errors
///
/// Those of [`grazing_velocities`].
///
/// ```
/// use stick_slip::{MassOnBelt, Polynomial, bifurcation};
///
/// let law = Polynomial::new(0.38, 0.22, 0.55)?;
/// let system = MassOnBelt::new(law, 0.2)?.with_damping(0.004)?.with_load(0.1)?;
/// let overshoot = bifurcation::overshoot_velocities(&system, 0.05..0.3)?;
/// assert!((overshoot[0] - 0.1660231185729933121).abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn overshoot_velocities<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    range: Range<f64>,
) -> Result<Vec<f64>, Error> {
    over_belt_velocities(system, range, &|release, tracer| {
        Ok(release.beyond_low(tracer))
    })
}

/// Belt velocities in `range`, ascending and dimensionless, at which overshoot changes into
/// crossing or back: after release and a crossing the mass comes back to the belt exactly at the
/// release point.
///
/// The range is searched as densely as by [`grazing_velocities`].
///
/// # Errors
///
/// Those of [`grazing_velocities`].
///
/// ```
/// use stick_slip::{CycleKind, MassOnBelt, Polynomial, bifurcation, limit_cycle};
///
/// let law = Polynomial::new(0.38, 0.22, 0.55)?;
/// let system = MassOnBelt::new(law, 0.2)?.with_damping(0.001)?.with_load(0.03)?;
/// let crossing = bifurcation::crossing_velocities(&system, 0.05..0.3)?[0];
/// let kind = |v_b: f64| -> Result<_, stick_slip::Error> {
///     let cycles = limit_cycle::find(&system.with_belt_velocity(v_b)?)?;
///     Ok(cycles.stable().next().unwrap().kind())
/// };
/// assert_eq!(kind(crossing - 1e-3)?, CycleKind::Overshoot);
/// assert_eq!(kind(crossing + 1e-3)?, CycleKind::Crossing);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn crossing_velocities<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    range: Range<f64>,
) -> Result<Vec<f64>, Error> {
    over_belt_velocities(system, range, &|release, tracer| {
        release.beyond_high(tracer)
    })
}

/// A number computed from the arcs out of the release point.
type Number<'s, L> = dyn Fn(&mut Release, &mut Tracer<'s, L>) -> Result<Option<f64>, Error>;

/// Belt velocities in a range at which such a number changes its sign.
fn over_belt_velocities<'s, L: FrictionLaw>(
    system: &'s MassOnBelt<L>,
    range: Range<f64>,
    number: &Number<'s, L>,
) -> Result<Vec<f64>, Error> {
    let range = positive(range)?;
    let system = system.by_reference();
    let mut at_velocity = |v_b: f64| {
        let found = moving_at(system, v_b, |system| {
            let mut tracer = Tracer::new(system);
            let mut release = Release::follow(&mut tracer)?;
            number(&mut release, &mut tracer)
        })?;
        Ok(found.flatten())
    };
    sign_changes(&mut at_velocity, &range)
}

#[cfg(test)]
mod tests;
