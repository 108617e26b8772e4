//! The map from one downward crossing of the belt velocity to the next. Its fixed points are the
//! cycles that cross the belt velocity and never stick.

use super::arc::{Arc, Arrival, FARTHEST, Tracer};
use super::cycle::{CycleKind, LimitCycle};
use super::growth::relative_growth;
use super::release::ReleaseFate;
use crate::clock::Time;
use crate::error::Error;
use crate::numerics::roots_with_slopes::{Roots, Sample, roots_between};
use crate::state::Direction;

/// The map F → C(F) from the force F = u + 2βv_b at a downward crossing to the force at the next
/// one.
pub(super) struct CrossingMap<'t, 's> {
    tracer: &'t mut Tracer<'s>,
}

impl<'t, 's> CrossingMap<'t, 's> {
    pub(super) fn of(tracer: &'t mut Tracer<'s>) -> Self {
        Self { tracer }
    }

    /// The two arcs, first with v < v_b, then with v > v_b, of a motion that crosses the belt
    /// velocity downwards at a force F, and the force at which the second one returns to the belt.
    /// `None` if the motion sticks or moves inwards after the first arc.
    fn one_period(&mut self, force: f64) -> Result<Option<([Arc; 2], f64)>, Error> {
        let system = self.tracer.system();
        let carried = system.carried_force();
        let lagging = self
            .tracer
            .arc_leaving(force - carried, Direction::Lagging)?;
        let Arrival::Contact(contact) = lagging.arrival else {
            return Ok(None);
        };
        if system.slides_at(contact) != Some(Direction::Leading) {
            return Ok(None);
        }
        let leading = self.tracer.arc_leaving(contact, Direction::Leading)?;
        Ok(match leading.arrival {
            Arrival::Contact(contact) => Some(([lagging, leading], contact + carried)),
            _ => None,
        })
    }

    /// The growth over one period, C(F)/F − 1, and its slope. C is the force at the next downward
    /// crossing, or F_s, the force at release, if the motion does not cross again.
    pub(super) fn growth(&mut self, force: f64) -> Result<Sample, Error> {
        let release = self.tracer.system().largest_friction();
        Ok(match self.one_period(force)? {
            Some((arcs, next)) if next >= release => {
                let rates = [&arcs[0], &arcs[1]].map(|arc| arc.end_rate);
                self.growth_to(force, next, self.stretch(&arcs), rates)
            }
            _ => relative_growth(self.tracer, force, release, 0.0),
        })
    }

    /// The growth from a force to the next. `rates` are the rates of the relative velocity at the
    /// contacts: a shift in time or velocity moves a contact by v_b/rate times as much, and the
    /// noise grows accordingly.
    fn growth_to(&self, force: f64, next: f64, slope: f64, rates: [f64; 2]) -> Sample {
        let slowest = rates[0].abs().min(rates[1].abs());
        let steepest = self.tracer.system().belt_velocity() / slowest;
        let sample = relative_growth(self.tracer, force, next, slope);
        Sample {
            noise: sample.noise * (1.0 + steepest),
            ..sample
        }
    }

    /// dC/dF over the arcs of a period.
    fn stretch(&self, arcs: &[Arc; 2]) -> f64 {
        let stretch = arcs
            .iter()
            .map(|arc| self.tracer.stretch(arc, Time::Forward));
        stretch.product()
    }

    /// Returns true if a motion that crosses downwards at the force F grows over the next period;
    /// `None` if rounding hides it.
    pub(super) fn grows(&mut self, force: f64) -> Result<Option<bool>, Error> {
        self.growth(force).map(Sample::grows)
    }

    /// The least force from which a motion crosses downwards again, for a system in which the
    /// motion from the release point does not; found by following the motion that arrives at an end
    /// of the stick band backwards.
    pub(super) fn least(&mut self) -> Result<Option<Sample>, Error> {
        let carried = self.tracer.system().carried_force();
        let [low, high] = self.tracer.system().stick_limits();
        if low == high {
            // Without static friction this motion touches the belt velocity from behind at the
            // release point, and crosses with no force.
            let lagging = self.tracer.arc_arriving(high, Direction::Lagging)?;
            return Ok(match lagging.arrival {
                Arrival::Contact(start) => {
                    Some(relative_growth(self.tracer, start + carried, 0.0, 0.0))
                }
                _ => None,
            });
        }
        let leading = self.tracer.arc_arriving(high, Direction::Leading)?;
        let (contact, leading, time) = match leading.arrival {
            Arrival::Contact(contact) if contact < low => (contact, leading, Time::Backward),
            Arrival::Contact(_) => {
                let from_low = self.tracer.arc_leaving(low, Direction::Leading)?;
                if from_low.arrival == Arrival::Held {
                    // The arc begins below the low end of the band, but by less than rounding.
                    (low, leading, Time::Backward)
                } else {
                    (low, from_low, Time::Forward)
                }
            }
            // Every leading motion ends in stick, from however far it comes.
            _ => return Ok(None),
        };
        let (next, leading_rate) = match (time, leading.arrival) {
            (Time::Forward, Arrival::Contact(next)) => (next + carried, leading.end_rate),
            (Time::Forward, _) => (high + carried, leading.end_rate),
            (Time::Backward, _) => (high + carried, leading.start_rate),
        };
        let lagging = self.tracer.arc_arriving(contact, Direction::Lagging)?;
        let Arrival::Contact(start) = lagging.arrival else {
            return Ok(None);
        };
        let tracer = &self.tracer;
        let slope = tracer.stretch(&leading, time) * tracer.stretch(&lagging, Time::Backward);
        let rates = [leading_rate, lagging.start_rate];
        Ok(Some(self.growth_to(start + carried, next, slope, rates)))
    }

    /// Forces at the downward crossings of the periodic motions that cross the belt velocity twice
    /// a period.
    ///
    /// The force is doubled until it reaches [`FARTHEST`], or until the motions from two
    /// consecutive forces, both beyond every breakpoint of the law, shrink.
    pub(super) fn roots(&mut self, fate: ReleaseFate) -> Result<Roots, Error> {
        let system = self.tracer.system();
        let release = system.largest_friction();
        let start = match fate {
            // Without static friction F = 0 at release, and relative growth has no meaning. The
            // search begins at the next crossing, because no cycle lies between the two.
            ReleaseFate::Outward if release == 0.0 => match self.one_period(release)? {
                Some((_, next)) if next > 0.0 => Some(self.growth(next)?),
                _ => None,
            },
            ReleaseFate::Outward => Some(self.growth(release)?),
            _ => self.least()?,
        };
        let Some(mut low) = start.filter(|start| start.x > 0.0) else {
            return Ok(Roots::default());
        };
        let last_breakpoint = system.law().breakpoints().last().unwrap_or(0.0);
        let beyond = 2.0 * (system.belt_velocity() + last_breakpoint);
        let mut roots = Roots::default();
        let mut shrinks = 0;
        while shrinks < 2 && low.x < FARTHEST * (release + system.belt_velocity()) {
            let high = self.growth((2.0 * low.x).max(low.x + system.belt_velocity()))?;
            roots_between(
                &mut |force| self.growth(force),
                &|_, _| None,
                low,
                high,
                &mut roots,
            )?;
            shrinks = if high.value < 0.0 && high.x > beyond {
                shrinks + 1
            } else {
                0
            };
            low = high;
        }
        Ok(roots)
    }

    /// The periodic motion that crosses the belt velocity downwards at a force F.
    pub(super) fn cycle(&mut self, force: f64) -> Result<Option<LimitCycle>, Error> {
        Ok(self.one_period(force)?.map(|(arcs, _)| {
            let multiplier = self.stretch(&arcs);
            let system = self.tracer.system();
            LimitCycle::join(&system, arcs.into(), CycleKind::Crossing, multiplier)
        }))
    }
}

#[cfg(test)]
mod tests;
