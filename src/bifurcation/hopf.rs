use std::ops::Range;

use super::along::{Along, Work, along_velocities};
use crate::belt::{Criticality, MassOnBelt};
use crate::error::Error;
use crate::friction::{AlongSlope, FarEnd, FrictionLaw};
use crate::numerics::scan::sign_changes;

/// Belt velocities v_b in `range`, ascending and dimensionless, at which the equilibrium loses or
/// regains stability.
///
/// At these velocities the damping of steady sliding, h1, changes its sign:
///
/// ```text
/// h1(v_b) = 2β + γ² dμ̂/ds(|v_b|)
/// ```
///
/// β is the damping ratio, γ² the friction load, and μ̂(s) the kinetic coefficient at the sliding
/// speed s.
///
/// The law is expanded in power series from one end of the range to the other. Each series is used
/// only within its radius of convergence, and is compared with the law at three points of its
/// interval. The roots of the series are isolated so that none is skipped. If h1 touches zero (to
/// rounding) and keeps its sign, stability does not change, and no velocity is returned. The
/// motions at v_b and −v_b are mirror images; both velocities are returned if both lie in the
/// range. A [breakpoint](FrictionLaw::breakpoints) at which h1 jumps to the other sign is returned.
/// If h1 is zero over a whole interval of velocities and has different signs on its two sides, the
/// end of the interval with the larger |v_b| is returned.
///
/// For the exponential law see the closed form
/// [`analysis::exponential::hopf_velocities`](crate::analysis::exponential::hopf_velocities).
///
/// Source: Farshidianfar and Noei Aghaee, Eqs. 10a and 14, for any law.
///
/// # Errors
///
/// * [`Error::InvalidParameter`] unless the range is finite and not empty;
/// * [`Error::InvalidParameter`] if the expansion of the law over the range takes more than 10⁴
///   power series;
/// * [`Error::NonFiniteFriction`] or [`Error::NotAnalytic`] if the law has no power series
///   somewhere in the range.
///
/// ```
/// use stick_slip::{Exponential, MassOnBelt, bifurcation};
///
/// let system = MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let hopf = bifurcation::hopf_velocities(&system, 0.0..10.0)?;
/// assert_eq!(hopf.len(), 2);
/// assert!((hopf[0] - 0.0858251835248284677).abs() < 1e-15);
/// assert!((hopf[1] - 0.738553461542470176).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "sweep")]
pub fn hopf_velocities<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    range: Range<f64>,
) -> Result<Vec<f64>, Error> {
    along_velocities(system, range).hopf()
}

impl<L: FrictionLaw> Along<'_, L> {
    /// Values of the parameter, ascending, at which the equilibrium loses or regains stability.
    ///
    /// A search by [`along_velocities`] works as in [`hopf_velocities`], by power series of the
    /// law. A search by [`along`](super::along()) has no such series: it computes the damping h1 of
    /// steady sliding, defined at [`hopf_velocities`], at single values of the parameter. The range
    /// is divided into 64 intervals, and each interval that may contain a sign change of h1 is
    /// divided further, into up to 2¹⁰ parts. A value at which h1 jumps to the opposite sign is
    /// also returned.
    ///
    /// # Errors
    ///
    /// In a search by [`along_velocities`], the errors of [`hopf_velocities`]. In a search by
    /// [`along`](super::along()), the errors of [`grazing`](Self::grazing).
    pub fn hopf(&self) -> Result<Vec<f64>, Error> {
        self.over_parts(&mut hopf)
    }
}

/// Adds the Hopf points in a part of the range.
pub(super) fn hopf(
    work: &Work<'_, '_>,
    part: &Range<f64>,
    found: &mut Vec<f64>,
) -> Result<(), Error> {
    match work.search.velocities_of {
        Some(system) => {
            let damping = AlongSlope {
                law: system.law(),
                constant: 2.0 * system.damping(),
                factor: system.load(),
            };
            let speeds = |range: Range<f64>, name, value| {
                let of = "bifurcation::along";
                damping.sign_changes(&range, FarEnd { of, name, value })
            };
            if part.start < 0.0 {
                // The mirror image. Its end belongs to the range, and is seen from beyond.
                let range = part.end.abs()..part.start.abs() * (1.0 + LOOK_BEYOND);
                let mirrored = speeds(range, "range.start", part.start)?;
                let velocities = mirrored.iter().rev().map(|speed| -speed);
                found.extend(velocities.filter(|v_b| part.contains(v_b)));
            } else {
                found.append(&mut speeds(part.clone(), "range.end", part.end)?);
            }
            Ok(())
        }
        None => sign_changes(&mut |value| relative_damping(work, value), part, found),
    }
}

/// Relative distance beyond a range of negative velocities up to which they are searched.
const LOOK_BEYOND: f64 = 1e-6;

/// h1 in units of the sizes of its terms, so that it is of order 1; `None` on a belt at rest and if
/// it has no terms.
fn relative_damping(work: &Work<'_, '_>, value: f64) -> Result<Option<f64>, Error> {
    let mut relative = None;
    work.with_system(value, &mut |system| {
        let speed = system.belt_velocity().abs();
        let slope = system.law().slope(speed);
        let coefficient = system.law().static_coefficient();
        let size = 2.0 * system.damping() + system.load() * (slope.abs() + coefficient);
        let damping = 2.0 * system.damping() + system.load() * slope;
        relative = (speed > 0.0 && size > 0.0).then(|| damping / size);
        Ok(())
    })?;
    Ok(relative)
}

/// Returns whether a pure-slip cycle born at the Hopf point, the belt velocity v_b, is stable
/// (supercritical) or unstable (subcritical). The sign of the third derivative d³μ̂/ds³(|v_b|) of
/// the kinetic coefficient μ̂(s) at the sliding speed s decides.
///
/// The function does not check that v_b is a Hopf point. If |v_b| is a breakpoint of the law, the
/// function uses the third derivative just above this breakpoint. If the damping h1 of steady
/// sliding (see [`hopf_velocities`]) jumps to the other sign at the breakpoint, this derivative
/// does not decide the stability. At a velocity of NaN no sign decides: `Degenerate`.
///
/// ```
/// use stick_slip::bifurcation::{Criticality, criticality, hopf_velocities};
/// use stick_slip::{Exponential, MassOnBelt};
///
/// let system = MassOnBelt::new(Exponential::new(0.6, 0.3, 0.4)?, 1.0)?.with_damping(0.01)?;
/// let hopf = hopf_velocities(&system, 0.0..5.0)?;
/// assert_eq!(criticality(&system, hopf[0]), Criticality::Supercritical);
/// assert_eq!(criticality(&system, hopf[1]), Criticality::Subcritical);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn criticality<L: FrictionLaw>(system: &MassOnBelt<L>, belt_velocity: f64) -> Criticality {
    let third = system.law().derivative(3, belt_velocity.abs());
    if third > 0.0 {
        Criticality::Supercritical
    } else if third < 0.0 {
        Criticality::Subcritical
    } else {
        Criticality::Degenerate
    }
}
