//! Slip arcs: parts of a slip phase, up to contact or to a maximum of the velocity.

use std::ops::ControlFlow;

use crate::belt::{Advance, Forward, Stability, Step, Stepper};
use crate::clock::{Clock, Time};
use crate::error::{Error, Reached};
use crate::friction::slip_series::SlipPoint;
use crate::motion::Integrator;
use crate::numerics::gauss::gauss_legendre;
use crate::series::{PowerSeries, quarters};
use crate::state::{Direction, State};

/// The end of a slip arc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Arrival {
    /// Contact, v = v_b, at this displacement.
    Contact(f64),
    /// A maximum of the velocity, below v_b.
    Maximum(SlipPoint),
    /// No end: the motion settles at the equilibrium.
    Equilibrium,
    /// No end: the motion, followed backwards, grows beyond [`FARTHEST`].
    Far,
    /// No arc: the start is on the belt, and slip does not begin there.
    Held,
}

/// Follows slip arcs of one system to round-off.
pub(crate) struct Tracer<'s> {
    system: Forward<'s>,
    stepper: Stepper,
    /// The direction of time in which the equilibrium attracts, if there is one.
    attracts: Option<Time>,
    /// Distance within which the motion, in that direction of time, tends to the equilibrium.
    settled: f64,
    /// max(1, |h1|), by which u − ū is divided to compare it with a velocity.
    stiffness: f64,
    /// Distance within which a motion is at the equilibrium to rounding.
    rounding: f64,
    equilibrium: f64,
    /// |v_b| + γ²μ_s, the unit of distances.
    scale: f64,
    /// Steps taken so far.
    work: usize,
}

/// A slip arc: its steps and its end.
#[derive(Debug, Clone)]
pub(crate) struct Arc {
    pub(crate) steps: Vec<Step>,
    pub(crate) arrival: Arrival,
    /// ds/dτ at the arc's start, in the direction of time in which the arc was followed.
    pub(crate) start_rate: f64,
    /// ds/dτ at the arc's end.
    pub(crate) end_rate: f64,
}

/// Fraction of v_b within which the motion near the equilibrium is linear.
const SETTLED: f64 = 1e-9;

/// Distance from the equilibrium, in units of ε(ū + v_b), at which rounding can keep a motion.
const ROUNDING: f64 = 16.0;

impl Arc {
    /// Reverses an arc that was followed backwards to the state `end`, so that it runs forwards in
    /// time: each series c(t) becomes c(h − t), and the last step comes first.
    pub(crate) fn reversed(self, end: State) -> Self {
        let mut start = end;
        let turned = self.steps.into_iter().rev().map(|mut step| {
            // Backwards, the step began where it now ends, which is where the next step begins.
            std::mem::swap(&mut step.state, &mut start);
            step.speed.reflect(step.duration);
            step
        });
        Self {
            steps: turned.collect(),
            ..self
        }
    }
}

/// Distance, or force of the damper, in units of |v_b| + γ²μ_s, beyond which no cycle is searched
/// and no motion is followed backwards.
///
/// Friction feeds the mass only while 0 < v < v_b, and the averaged cycles of every law have
/// amplitudes below 2|v_b|. If the law rises fast enough, a motion followed backwards grows to
/// infinity in finite time.
pub(crate) const FARTHEST: f64 = 16.0;

/// Limit of steps of one arc. An oscillation takes about ten, a creep to a node a hundred.
const MOST_STEPS: usize = Integrator::DEFAULT_MAX_STEPS;

impl<'s> Tracer<'s> {
    pub(crate) fn new(system: Forward<'s>) -> Self {
        let equilibrium = system.equilibrium_displacement();
        let attracts = system
            .equilibrium()
            .and_then(|equilibrium| match equilibrium.stability {
                Stability::StableFocus | Stability::StableNode => Some(Time::Forward),
                Stability::UnstableFocus | Stability::UnstableNode => Some(Time::Backward),
                Stability::Center => None,
            });
        Self {
            system,
            stepper: Stepper::new(&system, Integrator::MIN_TOLERANCE),
            attracts,
            settled: SETTLED * system.belt_velocity().abs(),
            rounding: ROUNDING * f64::EPSILON * (equilibrium.abs() + system.belt_velocity().abs()),
            equilibrium,
            stiffness: system
                .effective_damping(system.belt_velocity())
                .abs()
                .max(1.0),
            scale: system.belt_velocity().abs() + system.load() * system.law().static_coefficient(),
            work: 0,
        }
    }

    pub(crate) fn system(&self) -> Forward<'s> {
        self.system
    }

    /// Steps taken so far.
    pub(crate) fn work(&self) -> usize {
        self.work
    }

    /// The unit of distances, |v_b| + γ²μ_s.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// Returns true if the equilibrium attracts in this direction of time.
    pub(crate) fn attracts(&self, time: Time) -> bool {
        self.attracts == Some(time)
    }

    /// The unit of the velocities that rounding errors of forces cause: a force F moves a motion
    /// that settles strongly by F/h1.
    pub(crate) fn velocity_scale(&self) -> f64 {
        if self.attracts(Time::Forward) {
            self.scale / self.stiffness
        } else {
            self.scale
        }
    }

    /// The arc from `start`, forward or backward in time, to contact or to the next maximum of the
    /// velocity after it.
    ///
    /// Arcs with v > v_b > 0 end in contact: u grows until the spring brings the mass back to the
    /// belt.
    pub(crate) fn arc(&mut self, start: SlipPoint, time: Time) -> Result<Arc, Error> {
        if start.speed == 0.0 && !self.slips(&start, time) {
            return Ok(Arc {
                steps: Vec::new(),
                arrival: Arrival::Held,
                start_rate: 0.0,
                end_rate: 0.0,
            });
        }
        let v_b = self.system.belt_velocity();
        let mut point = start;
        let mut clock = Clock::default();
        let mut steps: Vec<Step> = Vec::with_capacity(16);
        let mut watch = PeakDetector::new(v_b);
        let mut shift = 0.0;
        loop {
            let Advance { mut duration, end } =
                self.stepper
                    .advance(&self.system, &point, time, clock.time)?;
            let speed = *self.stepper.speed();
            let is_contact = end.speed == 0.0;
            let maximum = match point.direction {
                Direction::Lagging => watch.maximum(&speed, duration, steps.last()),
                Direction::Leading => None,
            };
            if is_contact && point.direction == Direction::Lagging && watch.has_only_fallen() {
                shift = self.shift(&end).max(2.0 * shift);
                point = SlipPoint {
                    displacement: end.displacement + time.sign() * shift,
                    rate: Some(shift),
                    ..end
                };
                continue;
            }
            if let Some(t) = maximum {
                duration = t;
            }
            let state = point.state(&self.system);
            let step = Step::slip(clock, duration, point.direction, state, &speed, v_b, None);
            clock = clock.after(duration);
            steps.push(step);
            self.work += self.stepper.passes();
            let arrival = if maximum.is_some() {
                Some(self.maximum(&point, time, &speed, duration))
            } else if duration.is_infinite() || self.has_settled(&end, time) {
                Some(Arrival::Equilibrium)
            } else if is_contact {
                Some(Arrival::Contact(end.displacement))
            } else if time == Time::Backward && self.is_far(&end) {
                Some(Arrival::Far)
            } else {
                None
            };
            if let Some(arrival) = arrival {
                debug_assert!(!steps.is_empty());
                return Ok(Arc {
                    arrival,
                    start_rate: steps[0].speed[1],
                    end_rate: rate_at_end(&steps[steps.len() - 1]),
                    steps,
                });
            }
            if steps.len() >= MOST_STEPS {
                let limit = MOST_STEPS;
                let reached = Reached::new(clock.time, end.state(&self.system));
                return Err(Error::TooManySteps { limit, reached });
            }
            point = end;
        }
    }

    /// Distance by which a motion whose velocity falls is moved on if it returns to the belt before
    /// its velocity was negative. No motion does: while v > 0, v cannot turn to grow, because
    /// v'' = −v where v' = 0. The force that moves the mass away from the belt was less than the
    /// rounding errors of its terms.
    fn shift(&self, contact: &SlipPoint) -> f64 {
        let size = contact.displacement.abs() + self.scale + self.system.carried_force();
        (ROUNDING * f64::EPSILON * size).max(f64::MIN_POSITIVE)
    }

    /// The maximum of the velocity, a time t after the start of the last step.
    #[inline(never)]
    fn maximum(&self, start: &SlipPoint, time: Time, speed: &PowerSeries, t: f64) -> Arrival {
        Arrival::Maximum(SlipPoint {
            displacement: self.stepper.displacement(&self.system, start, time, t),
            speed: speed.at(t),
            // Exactly 0, by the definition of a maximum.
            rate: Some(0.0),
            ..*start
        })
    }

    /// Returns true if no cycle reaches this sliding speed: where v is least, u = 2β|v| + γ²μ̂.
    fn is_far(&self, point: &SlipPoint) -> bool {
        let by_damper = point.speed - self.system.belt_velocity();
        let least = FARTHEST * self.scale;
        point.speed > least || 2.0 * self.system.damping() * by_damper > least
    }

    /// Returns true if a motion that starts on the belt leaves it: the sliding speed grows because
    /// its rate s' is positive or, where s' = 0, because s'' = −σv_b is.
    fn slips(&self, start: &SlipPoint, time: Time) -> bool {
        let sigma = start.direction.sign();
        let rate = start.rate.unwrap_or_else(|| {
            let system = &self.system;
            let force = start.displacement + system.carried_force();
            -time.sign() * (sigma * force + system.load() * system.law().kinetic(0.0))
        });
        rate > 0.0 || (rate == 0.0 && start.direction == Direction::Lagging)
    }

    /// Returns true if a motion tends to the equilibrium, or is there to rounding. If the
    /// equilibrium attracts strongly, u − ū is measured by the speed that it causes: on the slow
    /// manifold of a node u − ū = −h1 v, and the motion is linear as long as the speed is small.
    fn has_settled(&self, point: &SlipPoint, time: Time) -> bool {
        let State {
            displacement,
            velocity,
        } = point.state(&self.system);
        let deviation = (displacement - self.equilibrium).abs();
        if self.attracts(time) {
            let distance = (deviation / self.stiffness).max(velocity.abs());
            distance < (self.rounding / self.stiffness).max(self.settled)
        } else {
            deviation.max(velocity.abs()) < self.rounding
        }
    }

    /// Factor by which an arc between two contacts stretches distances: |du_end/du_start| in
    /// forward time. `time` is the direction in which the arc was followed.
    pub(crate) fn stretch(&self, arc: &Arc, time: Time) -> f64 {
        let (start, end) = match time {
            Time::Forward => (arc.start_rate, arc.end_rate),
            Time::Backward => (arc.end_rate, arc.start_rate),
        };
        (start / end).abs() * (-self.contraction(arc)).exp()
    }

    /// The arc that leaves the belt at displacement u, with slip in this direction.
    pub(crate) fn arc_leaving(&mut self, u: f64, direction: Direction) -> Result<Arc, Error> {
        self.arc(
            SlipPoint::leaving(&self.system, u, direction),
            Time::Forward,
        )
    }

    /// The arc that arrives on the belt at displacement u, after slip in this direction; followed
    /// backwards.
    pub(crate) fn arc_arriving(&mut self, u: f64, direction: Direction) -> Result<Arc, Error> {
        self.arc(SlipPoint::arriving(u, direction), Time::Backward)
    }

    /// The arc from a velocity maximum V < v_b.
    pub(crate) fn arc_from_peak(&mut self, peak: f64, time: Time) -> Result<Arc, Error> {
        self.arc(SlipPoint::at_maximum(&self.system, peak), time)
    }

    /// Contraction of areas by the flow along an arc: the logarithm ∫(2β + γ² dμ̂/ds) dτ.
    pub(crate) fn contraction(&self, arc: &Arc) -> f64 {
        let (damping, load) = (2.0 * self.system.damping(), self.system.load());
        let over_step = |step: &Step| {
            // A step lies on one piece of the law.
            let middle = step.speed.at(0.5 * step.duration);
            let piece = self.stepper.piece_above(middle);
            gauss_legendre(0.0, step.duration, |t| {
                let speed = step.speed.at(t).max(0.0);
                damping + load * self.system.law().value_and_slope(piece, speed).1
            })
        };
        arc.steps.iter().map(over_step).sum()
    }
}

/// ds/dτ at the end of a step.
fn rate_at_end(step: &Step) -> f64 {
    step.speed.derivative().at(step.duration)
}

/// Detects the first maximum of the velocity on an arc with v < v_b.
#[derive(Debug, Clone)]
struct PeakDetector {
    v_b: f64,
    /// True if a maximum can follow: v has grown, from the start or since a minimum. A true minimum
    /// lies at v < 0, because v'' = −v there; near the slow manifold of a stiff system rounding can
    /// change the sign of v' elsewhere.
    has_grown: bool,
    /// True if v was negative.
    was_behind: bool,
}

impl PeakDetector {
    fn new(v_b: f64) -> Self {
        Self {
            v_b,
            has_grown: false,
            was_behind: false,
        }
    }

    /// Returns true if v has been positive and has not grown, except by rounding.
    fn has_only_fallen(&self) -> bool {
        !self.has_grown && !self.was_behind
    }

    /// The time of the velocity's maximum within a step, which follows the step `before`.
    fn maximum(&mut self, speed: &PowerSeries, h: f64, before: Option<&Step>) -> Option<f64> {
        self.has_grown |= (before.is_none() && speed[1] < 0.0) || speed[0] > self.v_b;
        if self.has_grown && speed[1] >= 0.0 && before.is_some_and(|step| rate_at_end(step) < 0.0) {
            // The maximum lies where two steps meet, and rounding may put it outside both.
            Some(0.0)
        } else if self.may_come(speed, h) {
            self.first_inside(speed, h)
        } else {
            None
        }
    }

    /// Returns true if a maximum may lie in (0, h): only if the velocity is positive, after it has
    /// grown or was negative. Values at the quarters of the step suffice, because v keeps its sign
    /// for about half a period, longer than a quarter of any step.
    fn may_come(&mut self, speed: &PowerSeries, h: f64) -> bool {
        let speeds = speed.at_some(quarters(h));
        let negative = |s: &f64| *s > self.v_b;
        let all_negative = negative(&speed[0]) && speeds.iter().all(negative);
        let any_negative = speeds.iter().any(negative);
        self.was_behind |= any_negative;
        (self.has_grown || any_negative) && !all_negative
    }

    /// The first time in (0, h) at which the velocity has a maximum: the sliding speed has a
    /// minimum, and v has grown before. v begins to grow where the sliding speed has a maximum
    /// above v_b.
    fn first_inside(&mut self, speed: &PowerSeries, h: f64) -> Option<f64> {
        let mut rate = speed.derivative();
        if rate[0] == 0.0 {
            // A known extremum at the start is divided out.
            rate = rate.without_root(1);
        }
        let mut minimum = None;
        if h.is_finite() {
            let _ = rate.search_sign_changes(h, &mut |t, rising| {
                if rising && self.has_grown {
                    minimum = Some(t);
                    return ControlFlow::Break(());
                }
                self.has_grown |= !rising && speed.at(t) > self.v_b;
                ControlFlow::Continue(())
            });
        }
        minimum
    }
}

#[cfg(test)]
mod tests;
