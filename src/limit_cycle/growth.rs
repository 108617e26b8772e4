//! Growth of a motion over one period, as a sample for the searches.

use super::arc::{Arc, Arrival, Tracer};
use super::averaged;
use super::continuum::{flat_amplitude, is_flat};
use crate::error::Error;
use crate::numerics::roots_with_slopes::Sample;

/// Rounding error of one period, in units of ε times the size of the motion.
const PERIOD_ROUNDING: f64 = 32.0;

/// The growth next/x − 1 and its slope, for a map x → next(x) of forces, with this slope.
pub(super) fn relative_growth(tracer: &Tracer<'_>, x: f64, next: f64, slope: f64) -> Sample {
    growth_beside(tracer, tracer.scale(), [x, next], slope)
}

/// [`relative_growth`] for a map of velocities.
pub(super) fn velocity_growth(tracer: &Tracer<'_>, x: f64, next: f64, slope: f64) -> Sample {
    growth_beside(tracer, tracer.velocity_scale(), [x, next], slope)
}

/// The growth of a quantity that has the rounding errors of others of this size, too.
fn growth_beside(tracer: &Tracer<'_>, size: f64, [x, next]: [f64; 2], slope: f64) -> Sample {
    Sample {
        x,
        value: next / x - 1.0,
        slope: (slope - next / x) / x,
        noise: PERIOD_ROUNDING * f64::EPSILON * (size + x) / x,
        work: tracer.work(),
    }
}

/// The overshoot of a motion that leaves the belt with the arc `arc` beyond the belt velocity
/// after one period, in units of v_b: w²/(2v_b²) if it meets the belt, with the rate w of the
/// relative velocity at contact; V/v_b − 1 if it has a velocity maximum V below; −1 if there is no
/// maximum.
///
/// It is not positive if [`stays_behind`] corrects it.
pub(super) fn overshoot(tracer: &Tracer<'_>, arc: &Arc) -> Result<f64, Error> {
    Ok(stays_behind(tracer, arc)?.unwrap_or(computed_overshoot(tracer, arc)))
}

/// The overshoot of a motion that does not overshoot, though rounding may bring it back to the
/// belt: 0 for the outermost motion of a continuum, which touches the belt velocity in every
/// period; negative for a motion that averaging shows to shrink. `None` for any other.
pub(super) fn stays_behind(tracer: &Tracer<'_>, arc: &Arc) -> Result<Option<f64>, Error> {
    let system = tracer.system();
    let v_b = system.belt_velocity();
    let overshoot = computed_overshoot(tracer, arc);
    // A motion that leaves the belt tangentially is one of velocity amplitude v_b.
    let growth = velocity_growth(tracer, v_b, v_b * (1.0 + overshoot), 1.0);
    if arc.start_rate != 0.0 || !growth.vanishes() {
        return Ok(None);
    }
    Ok(match averaged::grows(&system, v_b)? {
        Some(false) => Some(overshoot.min(0.0)),
        None if is_flat(&system) && flat_amplitude(&system) >= v_b => Some(0.0),
        _ => None,
    })
}

fn computed_overshoot(tracer: &Tracer<'_>, arc: &Arc) -> f64 {
    let v_b = tracer.system().belt_velocity();
    match arc.arrival {
        Arrival::Contact(_) => 0.5 * (arc.end_rate / v_b).powi(2),
        Arrival::Maximum(point) => -point.speed / v_b,
        Arrival::Equilibrium | Arrival::Far | Arrival::Held => -1.0,
    }
}
