//! Where periodic motions appear, disappear, and change their kind, as the belt velocity varies.
//!
//! | function | what happens there |
//! |---|---|
//! | [`hopf_velocities`] | the equilibrium loses or regains stability, and a pure-slip cycle is born; [`criticality`] tells which |
//! | [`grazing_velocities`] | the motion from the release point comes back tangentially: stick-slip appears or disappears |
//! | [`fold_velocities`] | a stable and an unstable pure-slip cycle meet |
//! | [`overshoot_velocities`] | the mass begins to overtake the belt before it sticks |
//! | [`crossing_velocities`] | it no longer sticks at all |
//! | [`silencing_damping`] | over the damping, at one belt velocity: no vibration lasts from there on |
//!
//! Every velocity is a root of an exact function of the belt velocity, bracketed and refined to
//! round-off. How densely a range is searched is told with each function; a narrower range is
//! searched more closely.
//!
//! [`analysis`](crate::analysis) has closed forms for some laws and some of these.
//!
//! [`diagram`] puts equilibrium and all cycles together for a list of belt velocities.

mod diagram;
mod fold;
mod hopf;
mod scan;
mod silence;

#[cfg(feature = "rayon")]
pub use diagram::par_diagram;
pub use diagram::{DiagramPoint, diagram};
pub use fold::fold_velocities;
pub use hopf::{Criticality, criticality, hopf_velocities};
pub use silence::silencing_damping;

use std::ops::Range;

use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::limit_cycle::{Contacts, Tracer};
use scan::sign_changes;

/// Belt velocities in `range` at which stick-slip appears or disappears, ascending: the motion from
/// the release point comes back to the belt tangentially.
///
/// Where μ̂(0) = μ_s a pure-slip cycle touches the belt velocity there, and so it goes over into
/// stick-slip. Where μ̂(0) < μ_s (Coulomb) the stick-slip cycle dies alone.
///
/// The function followed is smooth through its roots: w²/(2v_b) for a contact with the relative
/// velocity's rate w, and V − v_b for a motion that turns back at a velocity maximum V below. The
/// range is divided into 64 intervals, and those in which a root may hide into up to 2¹⁰ more: a
/// range a thousand times wider than where the system vibrates may show nothing.
///
/// # Errors
///
/// [`Error::InvalidParameter`] unless the range is finite and not empty; else those of
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
pub fn grazing_velocities<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    range: Range<f64>,
) -> Result<Vec<f64>, Error> {
    over_belt_velocities(system, range, |contacts| Some(contacts.gap))
}

/// Belt velocities in `range` between plain stick-slip and overshoot, ascending: the first contact
/// after release lies at the far end of the stick band.
///
/// Searched as densely as in [`grazing_velocities`], and with the same errors.
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
    over_belt_velocities(system, range, |contacts| contacts.beyond_low)
}

/// Belt velocities in `range` between overshoot and crossing, ascending: after release and a
/// crossing the mass comes back exactly at the release point.
///
/// Searched as densely as in [`grazing_velocities`], and with the same errors.
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
    over_belt_velocities(system, range, |contacts| contacts.beyond_high)
}

/// Roots, over the belt velocity, of a function of the contacts after release.
fn over_belt_velocities<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    range: Range<f64>,
    function: impl Fn(Contacts) -> Option<f64>,
) -> Result<Vec<f64>, Error> {
    let range = positive(range)?;
    let system = system.moving_forward();
    sign_changes(
        |v_b| {
            if v_b == 0.0 {
                return Ok(None);
            }
            let system = system.with_belt_velocity(v_b)?;
            Ok(function(Tracer::new(&system).contacts()?))
        },
        &range,
    )
}

/// The part of a range of belt velocities that lies above 0.
fn positive(range: Range<f64>) -> Result<Range<f64>, Error> {
    Error::check("range.start", range.start, true, "start < end")?;
    let valid = range.end > range.start && range.end > 0.0;
    Error::check("range.end", range.end, valid, "start < end and end > 0")?;
    Ok(range.start.max(0.0)..range.end)
}
