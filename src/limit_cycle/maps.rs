//! The two return maps of the planar flow, for v_b > 0, and their fixed points.

use super::arc::{Arc, Arrival, FAR, Tracer};
use super::roots::{Found, Sample, outline_between, roots_between};
use crate::belt::SlipPoint;
use crate::clock::Time;
use crate::error::Error;
use crate::friction::{FrictionLaw, is_constant_near};
use crate::state::Direction;

/// Where the arc out of the release point leads. Trajectories in the plane can't cross, so one turn
/// decides: a motion that returns inside of its start can only go on inwards, one that returns
/// outside only outwards.
#[derive(Debug, Clone)]
pub(crate) enum ReleaseFate {
    /// The velocity has a maximum V below v_b, or none: no contact, on this turn or any later one.
    Inward { peak: Option<f64> },
    /// Back in stick, and so back to the release point: after one arc, or after a crossing and a
    /// leading arc.
    Stick { arcs: Vec<Arc> },
    /// Two crossings, the second one beyond the release point: no stick on any later turn either.
    Outward,
}

impl<L: FrictionLaw> Tracer<'_, L> {
    /// Follows the arcs from the release point until they stick, cross outwards, or turn inwards.
    pub(crate) fn release_fate(&mut self) -> Result<ReleaseFate, Error> {
        let [_, high] = self.system().stick_limits();
        let lagging = self.arc(
            SlipPoint::leaving(self.system(), high, Direction::Lagging),
            Time::Forward,
        )?;
        let Arrival::Contact(contact) = lagging.arrival else {
            let v_b = self.system().belt_velocity();
            let peak = match lagging.arrival {
                Arrival::Maximum(point) => Some(v_b - point.speed),
                _ => None,
            };
            return Ok(ReleaseFate::Inward { peak });
        };
        if self.system().slides_at(contact).is_none() {
            return Ok(ReleaseFate::Stick {
                arcs: vec![lagging],
            });
        }
        let leading = self.arc(
            SlipPoint::leaving(self.system(), contact, Direction::Leading),
            Time::Forward,
        )?;
        match leading.arrival {
            Arrival::Contact(contact) if self.system().slides_at(contact).is_none() => {
                Ok(ReleaseFate::Stick {
                    arcs: vec![lagging, leading],
                })
            }
            _ => Ok(ReleaseFate::Outward),
        }
    }

    /// P(V)/V − 1 and its slope, where P(V) is the next velocity maximum of a motion in slip whose
    /// velocity has a maximum V.
    ///
    /// P'(V) = (V/P)·exp(−∮(2β + γ² dμ̂/ds) dτ). A motion that meets the belt instead counts as one
    /// that grows, and one that settles at a node as one that dies.
    fn growth(&mut self, peak: f64) -> Result<Sample, Error> {
        let v_b = self.system().belt_velocity();
        let arc = self.arc(SlipPoint::at_maximum(self.system(), peak), Time::Forward)?;
        let (next, slope) = match arc.arrival {
            Arrival::Maximum(point) => {
                let next = v_b - point.speed;
                (next, peak / next * (-self.contraction(&arc)).exp())
            }
            Arrival::Contact(_) | Arrival::Far => (2.0 * v_b, 0.0),
            Arrival::Equilibrium => (0.0, 0.0),
        };
        Ok(self.relative_growth(peak, next, slope))
    }

    /// The motion that grazes the belt, followed backwards to the velocity maximum before: the
    /// largest from which a motion returns without meeting the belt. At v_b, if every motion
    /// returns; `None`, if none does.
    fn largest_peak(&mut self) -> Result<Option<Sample>, Error> {
        let v_b = self.system().belt_velocity();
        let grazing = self.arc(SlipPoint::at_maximum(self.system(), v_b), Time::Backward)?;
        match grazing.arrival {
            Arrival::Maximum(point) => {
                let peak = v_b - point.speed;
                let slope = peak / v_b * (-self.contraction(&grazing)).exp();
                Ok(Some(self.relative_growth(peak, v_b, slope)))
            }
            Arrival::Contact(_) | Arrival::Far => self.growth(v_b).map(Some),
            Arrival::Equilibrium => Ok(None),
        }
    }

    /// Between the smallest velocity maximum that is searched and the largest one.
    fn range_of_peaks(&mut self) -> Result<Option<[Sample; 2]>, Error> {
        let v_b = self.system().belt_velocity();
        let smallest = self.growth(SMALLEST_PEAK * v_b)?;
        if smallest.x * (1.0 + smallest.value) > v_b {
            // It meets the belt, and so does every motion round it.
            return Ok(None);
        }
        let largest = self.largest_peak()?;
        Ok(largest
            .filter(|largest| largest.x > smallest.x)
            .map(|largest| [smallest, largest]))
    }

    /// The sample at x of a map x → next(x), as a relative growth.
    fn relative_growth(&self, x: f64, next: f64, slope: f64) -> Sample {
        Sample {
            x,
            value: next / x - 1.0,
            slope: (slope - next / x) / x,
            noise: TURN_ROUNDING * f64::EPSILON * (self.scale() + x) / x,
            work: self.work(),
        }
    }

    /// The same for a map of forces at the belt, over arcs that meet it at certain rates of the
    /// relative velocity: v_b/rate is how far a shift in time or velocity moves the place of
    /// contact.
    fn relative_growth_of_force(&self, x: f64, next: f64, slope: f64, rates: [f64; 2]) -> Sample {
        let steepest = self.system().belt_velocity() / rates[0].abs().min(rates[1].abs());
        let sample = self.relative_growth(x, next, slope);
        Sample {
            noise: sample.noise * (1.0 + steepest),
            ..sample
        }
    }

    /// Whether small motions are periodic: there is no damping, and friction does not depend on the
    /// speed near v_b.
    pub(crate) fn is_flat(&self) -> bool {
        let (system, v_b) = (self.system(), self.system().belt_velocity());
        system.damping() == 0.0 && is_constant_near(system.law(), v_b)
    }

    /// Whether every motion in slip is periodic: it [`is_flat`](Self::is_flat), and none grows or
    /// shrinks.
    pub(crate) fn is_continuum(&mut self) -> Result<bool, Error> {
        if !self.is_flat() {
            return Ok(false);
        }
        let v_b = self.system().belt_velocity();
        for part in [0.9, 0.1, 0.7, 0.3, 0.5] {
            if !self.growth(part * v_b)?.vanishes() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Velocity maxima V of the periodic motions in slip.
    pub(crate) fn pure_slip_peaks(&mut self) -> Result<Found, Error> {
        let mut found = Found::default();
        if let Some([smallest, largest]) = self.range_of_peaks()? {
            roots_between(&mut |peak| self.growth(peak), smallest, largest, &mut found)?;
        }
        Ok(found)
    }

    /// The periodic motion in slip whose velocity has the maximum V, and its Floquet multiplier.
    ///
    /// An unstable one is followed backwards, where it attracts: forwards it would grow away from
    /// itself, and not close.
    pub(crate) fn pure_slip(&mut self, peak: f64) -> Result<(Arc, f64), Error> {
        let arc = self.arc(SlipPoint::at_maximum(self.system(), peak), Time::Forward)?;
        let multiplier = (-self.contraction(&arc)).exp();
        if multiplier > 1.0 {
            let backward = self.arc(SlipPoint::at_maximum(self.system(), peak), Time::Backward)?;
            if let Arrival::Maximum(point) = backward.arrival {
                let multiplier = (-self.contraction(&backward)).exp();
                return Ok((backward.reversed(point.state(self.system())), multiplier));
            }
        }
        Ok((arc, multiplier))
    }

    /// How much an arc between two places on the belt stretches distances there: |du_end/du_start|
    /// in forward time.
    fn stretch(&self, arc: &Arc, time: Time) -> f64 {
        let [first, last] = arc.rates;
        let (start, end) = match time {
            Time::Forward => (first, last),
            Time::Backward => (last, first),
        };
        (start / end).abs() * (-self.contraction(arc)).exp()
    }

    /// The two arcs, lagging and leading, of a motion that crosses the belt velocity downwards at a
    /// force F = u + 2βv_b, and where it comes back to the belt; `None` if it sticks or turns
    /// inwards after the first.
    fn crossing_arcs(&mut self, force: f64) -> Result<Option<([Arc; 2], f64)>, Error> {
        let offset = self.system().carried_force();
        let lagging = self.arc(
            SlipPoint::leaving(self.system(), force - offset, Direction::Lagging),
            Time::Forward,
        )?;
        let Arrival::Contact(contact) = lagging.arrival else {
            return Ok(None);
        };
        if self.system().slides_at(contact) != Some(Direction::Leading) {
            return Ok(None);
        }
        let leading = self.arc(
            SlipPoint::leaving(self.system(), contact, Direction::Leading),
            Time::Forward,
        )?;
        Ok(match leading.arrival {
            Arrival::Contact(contact) => Some(([lagging, leading], contact + offset)),
            _ => None,
        })
    }

    /// C(F)/F − 1 and its slope, where C is the force at the next downward crossing; F_s, the force
    /// at release, for a motion that does not cross again.
    fn crossing_growth(&mut self, force: f64) -> Result<Sample, Error> {
        let release = self.system().largest_friction();
        Ok(match self.crossing_arcs(force)? {
            Some((arcs, next)) if next >= release => {
                let stretch = arcs.iter().map(|arc| self.stretch(arc, Time::Forward));
                let rates = [&arcs[0], &arcs[1]].map(|arc| arc.rates[1]);
                self.relative_growth_of_force(force, next, stretch.product(), rates)
            }
            _ => self.relative_growth(force, release, 0.0),
        })
    }

    /// The least force from which a motion crosses downwards again, for a motion released from
    /// stick that does not: the one that comes back to an end of the stick band, followed
    /// backwards.
    fn least_crossing(&mut self) -> Result<Option<Sample>, Error> {
        let offset = self.system().carried_force();
        let [low, high] = self.system().stick_limits();
        let arriving = SlipPoint::arriving;
        if low == high {
            // Without static friction it touches the belt's velocity at the release point, from
            // behind, and crosses with no force.
            let lagging = self.arc(arriving(high, Direction::Lagging), Time::Backward)?;
            return Ok(match lagging.arrival {
                Arrival::Contact(start) => Some(self.relative_growth(start + offset, 0.0, 0.0)),
                _ => None,
            });
        }
        let leading = self.arc(arriving(high, Direction::Leading), Time::Backward)?;
        let (contact, leading, time) = match leading.arrival {
            Arrival::Contact(contact) if contact < low => (contact, leading, Time::Backward),
            Arrival::Contact(_) => {
                let leading = self.arc(
                    SlipPoint::leaving(self.system(), low, Direction::Leading),
                    Time::Forward,
                )?;
                (low, leading, Time::Forward)
            }
            // From however far it comes, a leading motion ends in stick.
            _ => return Ok(None),
        };
        let next = match (time, leading.arrival) {
            (Time::Forward, Arrival::Contact(next)) => next + offset,
            _ => high + offset,
        };
        let lagging = self.arc(arriving(contact, Direction::Lagging), Time::Backward)?;
        let Arrival::Contact(start) = lagging.arrival else {
            return Ok(None);
        };
        let slope = self.stretch(&leading, time) * self.stretch(&lagging, Time::Backward);
        let rates = [
            leading.rates[usize::from(time == Time::Forward)],
            lagging.rates[0],
        ];
        let sample = self.relative_growth_of_force(start + offset, next, slope, rates);
        Ok(Some(sample))
    }

    /// The growth over one turn as a function of the peak velocity, in outline: (peak, growth) at
    /// the ends of the range and at the turning points between. Empty if every motion in slip meets
    /// the belt, or none returns, or each is periodic.
    pub(crate) fn outline(&mut self) -> Result<Vec<(f64, f64)>, Error> {
        if self.is_continuum()? {
            return Ok(Vec::new());
        }
        let Some([smallest, largest]) = self.range_of_peaks()? else {
            return Ok(Vec::new());
        };
        let outline = outline_between(&mut |peak| self.growth(peak), smallest, largest)?;
        Ok(outline.iter().map(|turn| (turn.x, turn.value)).collect())
    }

    /// What the arcs from the release point do at the belt, as numbers that pass through zero where
    /// their kind changes.
    pub(crate) fn contacts(&mut self) -> Result<Contacts, Error> {
        let v_b = self.system().belt_velocity();
        let [low, high] = self.system().stick_limits();
        let lagging = self.arc(
            SlipPoint::leaving(self.system(), high, Direction::Lagging),
            Time::Forward,
        )?;
        let mut contacts = Contacts {
            gap: match lagging.arrival {
                Arrival::Contact(_) => 0.5 * (lagging.rates[1] / v_b).powi(2),
                Arrival::Maximum(point) => -point.speed / v_b,
                Arrival::Equilibrium | Arrival::Far => -1.0,
            },
            beyond_low: None,
            beyond_high: None,
        };
        if let Arrival::Contact(contact) = lagging.arrival {
            contacts.beyond_low = Some((low - contact) / self.scale());
            if contact < low {
                let leading = self.arc(
                    SlipPoint::leaving(self.system(), contact, Direction::Leading),
                    Time::Forward,
                )?;
                if let Arrival::Contact(contact) = leading.arrival {
                    contacts.beyond_high = Some((contact - high) / self.scale());
                }
            }
        }
        Ok(contacts)
    }

    /// Whether a motion with the velocity maximum V grows over the next turn; `None` if rounding
    /// hides it.
    pub(crate) fn grows_from_peak(&mut self, peak: f64) -> Result<Option<bool>, Error> {
        self.growth(peak).map(Sample::grows)
    }

    /// The same for a motion that crosses downwards at the force F.
    pub(crate) fn grows_from_crossing(&mut self, force: f64) -> Result<Option<bool>, Error> {
        self.crossing_growth(force).map(Sample::grows)
    }

    /// Forces F = u + 2βv_b at the downward crossings of the periodic motions that cross the belt
    /// velocity twice a period.
    ///
    /// It is doubled until motions from it shrink twice running, beyond every breakpoint of the
    /// law, or until it is [`FAR`].
    pub(crate) fn crossing_forces(&mut self, fate: &ReleaseFate) -> Result<Found, Error> {
        let system = self.system();
        let release = system.largest_friction();
        let start = match fate {
            // Without static friction relative growth has no meaning at release; no cycle lies
            // between that motion's crossings.
            ReleaseFate::Outward if release == 0.0 => match self.crossing_arcs(release)? {
                Some((_, next)) if next > 0.0 => Some(self.crossing_growth(next)?),
                _ => None,
            },
            ReleaseFate::Outward => Some(self.crossing_growth(release)?),
            _ => self.least_crossing()?,
        };
        let Some(mut low) = start.filter(|start| start.x > 0.0) else {
            return Ok(Found::default());
        };
        let last_breakpoint = system.law().breakpoints().last().unwrap_or(0.0);
        let beyond = 2.0 * (system.belt_velocity() + last_breakpoint);
        let mut found = Found::default();
        let mut shrinks = 0;
        while shrinks < 2 && low.x < FAR * (release + system.belt_velocity()) {
            let high = self.crossing_growth((2.0 * low.x).max(low.x + system.belt_velocity()))?;
            roots_between(
                &mut |force| self.crossing_growth(force),
                low,
                high,
                &mut found,
            )?;
            shrinks = if high.value < 0.0 && high.x > beyond {
                shrinks + 1
            } else {
                0
            };
            low = high;
        }
        Ok(found)
    }

    /// The periodic motion that crosses the belt velocity downwards at a force F, and its Floquet
    /// multiplier.
    pub(crate) fn crossing(&mut self, force: f64) -> Result<Option<([Arc; 2], f64)>, Error> {
        Ok(self.crossing_arcs(force)?.map(|(arcs, _)| {
            let stretch = arcs.iter().map(|arc| self.stretch(arc, Time::Forward));
            let multiplier = stretch.product();
            (arcs, multiplier)
        }))
    }
}

/// See [`Tracer::contacts`].
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Contacts {
    /// How far the motion from the release point would overshoot the belt velocity, in units of
    /// v_b; negative where it turns back below.
    pub(crate) gap: f64,
    /// Distance of its first contact beyond the lower end of the stick band, in units of v_b +
    /// γ²μ_s.
    pub(crate) beyond_low: Option<f64>,
    /// Distance of its second contact, after a crossing, beyond the release point, in the same
    /// units.
    pub(crate) beyond_high: Option<f64>,
}

/// Rounding error of one turn, in units of ε times the size of the motion.
const TURN_ROUNDING: f64 = 32.0;

/// Smallest velocity maximum searched for, in units of v_b: below it rounding hides how a motion
/// grows over a turn.
const SMALLEST_PEAK: f64 = 1e-4;

#[cfg(test)]
mod tests;
