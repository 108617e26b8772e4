//! Growth of a motion over one turn, as a sample for the searches.

use super::arc::Tracer;
use crate::numerics::with_slopes::Sample;

/// Rounding error of one turn, in units of ε times the size of the motion.
const TURN_ROUNDING: f64 = 32.0;

/// The growth next/x − 1 and its slope, for a map x → next(x) with this slope.
pub(super) fn relative_growth(tracer: &Tracer<'_>, x: f64, next: f64, slope: f64) -> Sample {
    Sample {
        x,
        value: next / x - 1.0,
        slope: (slope - next / x) / x,
        noise: TURN_ROUNDING * f64::EPSILON * (tracer.scale() + x) / x,
        work: tracer.work(),
    }
}
