//! The tangential end of a branch: a point on the curve of grazing motions.

use std::cell::Cell;

use nalgebra::DVector;

use super::super::branch_equations::{Curve, Solved};
use super::super::phase_condition::FrozenStart;
use super::super::shooting_residual::TrialMotion;
use super::change::touch;
use super::event_equations::{EventCurve, Held};
use super::motions::Motions;
use crate::numerics::trace::{self, Equations, Plane};

/// The parameter at which an arrival of a motion becomes tangential, after which a contact sticks,
/// and the motion there: Newton's method from a motion near the end of its branch. `None` if there
/// is none.
pub(in crate::orbit) fn tangential_end(
    curve: &Curve<'_>,
    base: &Solved,
) -> Option<(f64, TrialMotion, FrozenStart)> {
    let members = |first: f64, _: f64| (curve.family)(first);
    let bounds = (curve.work.most, curve.work.watched);
    let size = [curve.n, curve.order];
    let motions = Motions::new(&members, curve.kind, [curve.width(), 1.0], size, bounds);
    let own = motions.own();
    let mut y = base.y.clone().insert_row(own + 1, 0.0);
    let (map, period) = (&base.trial.map, base.trial.period);
    let found = motions.with(motions.parameters(&y), |form| {
        Ok(touch(form, map, period, Some(true)))
    });
    let change = found.ok()??;
    let begin = FrozenStart {
        holds: change.holds,
        ..base.begin.clone()
    };
    let events = EventCurve {
        motions,
        kind: change.kind,
        ranges: [curve.range.clone(), -1.0..1.0],
        growth: Cell::new(1.0),
    };
    let (begun, near) = events.begin(&y, &begin).ok()?;
    y = begun;
    let scale = events.scale(&y, &near);
    let along = DVector::from_element(own + 2, 1.0);
    let plane = Plane::with_value(own + 1, 0.0, &along, &scale);
    let point = trace::solve(&events, &y, &near, &plane).ok()?;
    let Held { trial, begin, .. } = point.value;
    Some((events.motions.parameters(&point.y)[0], trial, begin))
}
