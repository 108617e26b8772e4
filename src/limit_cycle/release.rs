//! The motion from the release point: the slip arc with v < v_b that begins there and, if this arc
//! crosses the belt velocity, the next arc with v > v_b.

use super::arc::{Arc, Arrival, Tracer};
use super::cycle::{CycleKind, LimitCycle};
use super::growth;
use crate::belt::Landing;
use crate::error::Error;
use crate::friction::static_is_nan;
use crate::state::Direction;

/// Outcome of the motion from the release point. Trajectories in the plane cannot cross, so one
/// period decides: a motion that returns inside its start moves inwards for ever, and one that
/// returns outside moves outwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ReleaseFate {
    /// The motion moves inwards: its velocity has a maximum below v_b, or none, and it does not
    /// meet the belt in this period or in any later one. Or it is the outermost motion of a
    /// continuum.
    Inward,
    /// The motion returns to stick, after one arc or after a crossing and a second arc, and so to
    /// the release point.
    Stick,
    /// The motion moves outwards: it crosses twice, the second time beyond the release point, and
    /// does not stick in any later period.
    Outward,
}

/// The arcs from the release point. The second one is followed only if it is needed.
#[derive(Debug)]
pub(crate) struct Release {
    lagging: Arc,
    leading: Option<Arc>,
}

impl Release {
    /// Follows the first arc.
    pub(crate) fn follow(tracer: &mut Tracer<'_>) -> Result<Self, Error> {
        let [_, high] = tracer.system().stick_limits();
        Ok(Self {
            lagging: tracer.arc_leaving(high, Direction::Lagging)?,
            leading: None,
        })
    }

    /// The second arc, if the first one ends in a crossing.
    #[inline(never)]
    fn leading(&mut self, tracer: &mut Tracer<'_>) -> Result<Option<&Arc>, Error> {
        if self.leading.is_none()
            && let Arrival::Contact(contact) = self.lagging.arrival
            && let Landing::Crossing(side) = tracer.system().landing(contact, Direction::Lagging)
        {
            self.leading = Some(tracer.arc_leaving(contact, side)?);
        }
        Ok(self.leading.as_ref())
    }

    pub(crate) fn fate(&mut self, tracer: &mut Tracer<'_>) -> Result<ReleaseFate, Error> {
        let system = tracer.system();
        let Arrival::Contact(contact) = self.lagging.arrival else {
            return Ok(ReleaseFate::Inward);
        };
        if growth::stays_behind(tracer, &self.lagging)?.is_some() {
            // The motion comes back to the belt by rounding alone.
            return Ok(ReleaseFate::Inward);
        }
        match system.landing(contact, Direction::Lagging) {
            Landing::Stick => return Ok(ReleaseFate::Stick),
            // The motion comes round to the release point, and its contact does not last.
            Landing::Touch => return Ok(ReleaseFate::Inward),
            Landing::Crossing(_) => {}
        }
        let sticks = self
            .leading(tracer)?
            .is_some_and(|leading| match leading.arrival {
                Arrival::Contact(contact) => system.slides_at(contact).is_none(),
                _ => false,
            });
        Ok(if sticks {
            ReleaseFate::Stick
        } else {
            ReleaseFate::Outward
        })
    }

    /// The periodic motion through the release point, if the motion from there returns to stick.
    pub(super) fn into_cycle(
        mut self,
        tracer: &mut Tracer<'_>,
    ) -> Result<Option<LimitCycle>, Error> {
        if self.fate(tracer)? != ReleaseFate::Stick {
            return Ok(None);
        }
        let kind = match self.leading {
            None => CycleKind::StickSlip,
            Some(_) => CycleKind::Overshoot,
        };
        let mut arcs = vec![self.lagging];
        arcs.extend(self.leading);
        let cycle = LimitCycle::join(&tracer.system(), arcs, kind, 0.0);
        if cycle.period().is_nan() {
            return Err(static_is_nan());
        }
        // A release whose time overflows never comes.
        Ok(cycle.period().is_finite().then_some(cycle))
    }

    /// The overshoot beyond the belt velocity after the first arc, in units of v_b: see
    /// [`growth::overshoot`].
    pub(crate) fn overshoot(&self, tracer: &Tracer<'_>) -> Result<f64, Error> {
        growth::overshoot(tracer, &self.lagging)
    }

    /// Distance of the first contact beyond the lower end of the stick band, in units of v_b +
    /// γ²μ_s.
    pub(crate) fn beyond_low(&self, tracer: &Tracer<'_>) -> Option<f64> {
        let [low, _] = tracer.system().stick_limits();
        match self.lagging.arrival {
            Arrival::Contact(contact) => Some((low - contact) / tracer.scale()),
            _ => None,
        }
    }

    /// Distance of the second contact, after a crossing, beyond the release point, in units of
    /// v_b + γ²μ_s.
    pub(crate) fn beyond_high(&mut self, tracer: &mut Tracer<'_>) -> Result<Option<f64>, Error> {
        let [_, high] = tracer.system().stick_limits();
        Ok(match self.leading(tracer)?.map(|arc| arc.arrival) {
            Some(Arrival::Contact(contact)) => Some((contact - high) / tracer.scale()),
            _ => None,
        })
    }
}

#[cfg(test)]
mod tests;
