//! Changes of the contacts of the motion from the release point, and velocities at which pure-slip
//! cycles touch the belt velocity.

use std::ops::Range;

use super::along::{Along, Work, along_velocities};
use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::limit_cycle::{PeakMap, Release, Tracer};
use crate::numerics::scan::sign_changes;
use crate::state::Direction;

/// Belt velocities v_b in `range`, ascending and dimensionless, at which stick-slip appears or
/// disappears. At such a v_b, the velocity of the mass after release reaches the belt velocity
/// again tangentially, without crossing it.
///
/// The law has the static coefficient μ_s and the kinetic coefficient μ̂(s) at the sliding speed s.
/// If μ̂(0) = μ_s, a pure-slip cycle touches the belt velocity at this v_b and becomes stick-slip.
/// If μ̂(0) < μ_s, as for Coulomb's law, the stick-slip cycle disappears, and no pure-slip cycle
/// takes its place. Pure-slip cycles then touch the belt velocity at other values of v_b, the
/// [`touching_velocities`].
///
/// The velocities are the roots of a function of v_b that is smooth at each root. The function is
/// positive, w²/(2v_b²), if the mass reaches the belt velocity again after release; w is the
/// acceleration of the mass at this instant. The function is negative, V/v_b − 1, if the velocity
/// of the mass has a maximum V below v_b. The motions at v_b and −v_b are mirror images; both
/// velocities are returned if both lie in the range.
///
/// The range is divided into 64 intervals. Each interval that may contain a root is divided
/// further, into up to 2¹⁰ parts. If the range is a thousand times wider than the part in which the
/// system vibrates, a root may be missed: use a narrower range. Velocities below 64 ε γ²μ_s are not
/// searched, with the friction load γ² and ε = 2⁻⁵². At these velocities a motion of size v_b is
/// smaller than the rounding errors of the displacement.
///
/// Source: sliding bifurcations, di Bernardo, Budd, Champneys and Kowalczyk, *Piecewise-smooth
/// Dynamical Systems* (Springer 2008), chapter 8.
///
/// # Errors
///
/// * [`Error::InvalidParameter`] unless the range is finite and not empty;
/// * [`Error::At`], with the belt velocity and one of the errors of
///   [`limit_cycle::find`](crate::limit_cycle::find);
/// * [`Error::Stopped`] after
///   [`Search::DEFAULT_MAX_BRANCH_STEPS`](crate::Search::DEFAULT_MAX_BRANCH_STEPS).
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
    along_velocities(system, range).grazing()
}

/// Belt velocities in `range`, ascending and dimensionless, at which plain stick-slip changes into
/// overshoot, or overshoot into plain stick-slip (see
/// [`CycleKind`](crate::limit_cycle::CycleKind)). At such a velocity v_b, the mass returns to the
/// belt velocity after release exactly at one end of the stick band: the end opposite to the
/// release point. (The stick band is the range of displacements at which the mass can stick; stick
/// ends at the release point.)
///
/// The range is searched in the same way as in [`grazing_velocities`].
///
/// # Errors
///
/// The errors of [`grazing_velocities`].
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
    along_velocities(system, range).overshoot()
}

/// Belt velocities in `range`, ascending and dimensionless, at which overshoot changes into
/// crossing, or crossing into overshoot (see [`CycleKind`](crate::limit_cycle::CycleKind)). At such
/// a velocity v_b, the mass overtakes the belt after release. When its velocity has fallen to v_b
/// again, the mass is exactly at the displacement at which stick ended.
///
/// The range is searched in the same way as in [`grazing_velocities`].
///
/// # Errors
///
/// The errors of [`grazing_velocities`].
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
    along_velocities(system, range).crossing()
}

/// Belt velocities in `range`, ascending and dimensionless, at which a pure-slip cycle touches the
/// belt velocity: the largest velocity of the cycle in the direction of the belt is v_b. On one
/// side of such a v_b the cycle, stable or not, stays slower than the belt. On the other side this
/// cycle does not exist, because the mass would reach the belt velocity and stick.
///
/// The law has the static coefficient μ_s and the kinetic coefficient μ̂(s) at the sliding speed s.
/// If μ̂(0) = μ_s, the results are the [`grazing_velocities`]. If μ̂(0) < μ_s, the cycle touches
/// the belt velocity at a displacement at which the mass can stick. If a stick-slip cycle exists
/// beside this pure-slip cycle, it does not change at this v_b.
///
/// The velocities are the roots of the function described at [`grazing_velocities`]. That function
/// is computed for the motion from the release point; here it is computed for the motion that
/// starts with a velocity maximum v_b. The range is searched in the same way.
///
/// Source: grazing bifurcations of limit cycles, di Bernardo, Budd, Champneys and Kowalczyk,
/// *Piecewise-smooth Dynamical Systems* (Springer 2008), chapters 7 and 8.
///
/// # Errors
///
/// The errors of [`grazing_velocities`].
///
/// ```
/// use stick_slip::{CycleKind, MassOnBelt, Tabulated, bifurcation, limit_cycle};
///
/// // Friction falls to a minimum at the speed 0.4; μ_s = 0.5 is larger than μ̂(0) = 0.4.
/// let law = Tabulated::new([(0.0, 0.4), (0.4, 0.25), (1.0, 0.5)])?;
/// let law = law.with_static_coefficient(0.5)?;
/// let system = MassOnBelt::new(&law, 0.3)?.with_damping(0.02)?;
/// let [touching] = bifurcation::touching_velocities(&system, 0.1..1.0)?[..] else { panic!() };
/// assert!((touching - 0.3516064051358391).abs() < 1e-13);
/// let slips = |v_b: f64| -> Result<bool, stick_slip::Error> {
///     let cycles = limit_cycle::find(&system.with_belt_velocity(v_b)?)?;
///     Ok(cycles.iter().any(|cycle| cycle.kind() == CycleKind::PureSlip))
/// };
/// assert!(!slips(touching - 1e-9)? && slips(touching + 1e-9)?);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "sweep")]
#[doc(alias = "grazing")]
pub fn touching_velocities<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    range: Range<f64>,
) -> Result<Vec<f64>, Error> {
    along_velocities(system, range).touching()
}

/// A number computed from slip arcs that start on the belt.
type Number = fn(&mut Tracer<'_>) -> Result<Option<f64>, Error>;

impl<L: FrictionLaw> Along<'_, L> {
    /// Values of the parameter, ascending, at which stick-slip appears or disappears. See
    /// [`grazing_velocities`].
    ///
    /// # Errors
    ///
    /// The errors of [`grazing_velocities`]; [`Error::Stopped`] also if the watcher stops the
    /// search.
    pub fn grazing(&self) -> Result<Vec<f64>, Error> {
        self.over_parts(&mut |work, part, found| changes(work, part, overshoot, found))
    }

    /// Values of the parameter, ascending, at which a pure-slip cycle touches the belt velocity.
    /// See [`touching_velocities`].
    ///
    /// # Errors
    ///
    /// The errors of [`grazing`](Self::grazing).
    pub fn touching(&self) -> Result<Vec<f64>, Error> {
        self.over_parts(&mut |work, part, found| changes(work, part, touching, found))
    }

    /// Values of the parameter, ascending, at which plain stick-slip changes into overshoot or
    /// overshoot into plain stick-slip. See [`overshoot_velocities`].
    ///
    /// # Errors
    ///
    /// The errors of [`grazing`](Self::grazing).
    pub fn overshoot(&self) -> Result<Vec<f64>, Error> {
        self.over_parts(&mut |work, part, found| changes(work, part, beyond_low, found))
    }

    /// Values of the parameter, ascending, at which overshoot changes into crossing or crossing
    /// into overshoot. See [`crossing_velocities`].
    ///
    /// # Errors
    ///
    /// The errors of [`grazing`](Self::grazing).
    pub fn crossing(&self) -> Result<Vec<f64>, Error> {
        self.over_parts(&mut |work, part, found| changes(work, part, beyond_high, found))
    }
}

fn overshoot(tracer: &mut Tracer<'_>) -> Result<Option<f64>, Error> {
    Release::follow(tracer)?.overshoot(tracer).map(Some)
}

fn beyond_low(tracer: &mut Tracer<'_>) -> Result<Option<f64>, Error> {
    Ok(Release::follow(tracer)?.beyond_low(tracer))
}

fn beyond_high(tracer: &mut Tracer<'_>) -> Result<Option<f64>, Error> {
    Release::follow(tracer)?.beyond_high(tracer)
}

/// Searches the motion that touches the belt velocity. If friction does not jump at the release, it
/// is the motion from the release point.
fn touching(tracer: &mut Tracer<'_>) -> Result<Option<f64>, Error> {
    match touching_beside_release(tracer)? {
        None => overshoot(tracer),
        overshoot => Ok(overshoot),
    }
}

/// `None` where the motion that touches the belt velocity is that from the release point.
fn touching_beside_release(tracer: &mut Tracer<'_>) -> Result<Option<f64>, Error> {
    let system = tracer.system();
    let [_, high] = system.stick_limits();
    if system.slip_rate(high, Direction::Lagging) == 0.0 {
        return Ok(None);
    }
    PeakMap::of(tracer).overshoot().map(Some)
}

/// Adds the values of the parameter at which the contacts of the motion from the release point
/// change, of all three kinds, and those at which pure-slip cycles touch the belt velocity.
pub(super) fn all_changes(
    work: &Work<'_, '_>,
    part: &Range<f64>,
    found: &mut Vec<f64>,
) -> Result<(), Error> {
    let numbers: [Number; 4] = [overshoot, beyond_low, beyond_high, touching_beside_release];
    numbers
        .into_iter()
        .try_for_each(|number| changes(work, part, number, found))
}

/// Adds the values of the parameter at which such a number changes its sign.
fn changes(
    work: &Work<'_, '_>,
    part: &Range<f64>,
    number: Number,
    found: &mut Vec<f64>,
) -> Result<(), Error> {
    let mut at = |value: f64| {
        let number = work.moving_at(value, &mut |tracer| {
            if tracer.system().belt_velocity() <= LOST * tracer.scale() {
                return Ok(None);
            }
            number(tracer)
        })?;
        Ok(number.flatten())
    };
    sign_changes(&mut at, part, found)
}

/// Belt velocity, in units of v_b + γ²μ_s, up to which a motion from the release point is lost in
/// the rounding of u: it moves by some v_b only.
const LOST: f64 = 64.0 * f64::EPSILON;

#[cfg(test)]
mod tests;
