//! Slip arcs: from a point of a slip phase to the next place where something is decided.

use std::ops::ControlFlow;

use crate::belt::{Advance, Forward, SlipPoint, Stability, Step, Stepper};
use crate::clock::{Clock, Time};
use crate::error::{Error, Reached};
use crate::friction::FrictionLaw;
use crate::motion::Integrator;
use crate::numerics::gauss::gauss_legendre;
use crate::series::{PowerSeries, quarters};
use crate::state::{Direction, State};

/// Where a slip arc ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Arrival {
    /// On the belt, v = v_b, at this displacement.
    Contact(f64),
    /// At a maximum of the velocity, below v_b.
    Maximum(SlipPoint),
    /// Nowhere: it settles at the equilibrium.
    Equilibrium,
    /// Nowhere: followed backwards, it grows beyond [`FARTHEST`].
    Far,
    /// Nowhere: on the belt, where slip does not begin.
    Held,
}

/// Follows slip arcs of one system to round-off.
#[derive(Debug)]
pub(crate) struct Tracer<'s, L> {
    system: Forward<'s, L>,
    stepper: Stepper<'s, L>,
    /// The direction of time in which the equilibrium attracts, if it does in one.
    attracts: Option<Time>,
    /// Distance within which it then has the motion for good.
    settled: f64,
    /// max(1, |h1|).
    stiffness: f64,
    /// Distance within which a motion is at the equilibrium to rounding.
    rounding: f64,
    equilibrium: f64,
    /// |v_b| + γ²μ_s, by which distances are measured.
    scale: f64,
    /// Steps taken so far.
    work: usize,
}

/// A slip arc: its steps and its end.
#[derive(Debug, Clone)]
pub(crate) struct Arc {
    pub(crate) steps: Vec<Step>,
    pub(crate) arrival: Arrival,
    /// ds/dτ at its start, in the direction of time that it was followed in.
    pub(crate) start_rate: f64,
    /// ds/dτ at its end.
    pub(crate) end_rate: f64,
}

/// Fraction of v_b within which the motion near the equilibrium is linear.
const SETTLED: f64 = 1e-9;

/// Distance from the equilibrium, in units of ε(ū + v_b), at which rounding can keep a motion.
const ROUNDING: f64 = 16.0;

impl Arc {
    /// An arc that was followed backwards to the state `end`, as the same arc forwards: each series
    /// c(t) as c(h − t), the last first.
    pub(crate) fn reversed(mut self, end: State) -> Self {
        let mut start = end;
        for step in self.steps.iter_mut().rev() {
            // It began, backwards, where it now ends, and that is where the next one begins.
            std::mem::swap(&mut step.state, &mut start);
            step.speed = step.speed.reflected(step.duration);
        }
        self.steps.reverse();
        self
    }
}

/// Distance, in units of |v_b| + γ²μ_s, beyond which no cycle is looked for, and a motion is not
/// followed backwards.
///
/// Friction feeds the mass only where 0 < v < v_b; the averaged cycles of every law have amplitudes
/// below 2|v_b|. Backwards, a law that rises fast enough lets a motion grow to infinity in finite
/// time.
pub(crate) const FARTHEST: f64 = 16.0;

/// Most steps of one arc. An oscillation takes about ten, a slow motion to a node a hundred.
const MOST_STEPS: usize = Integrator::DEFAULT_MAX_STEPS;

impl<'s, L: FrictionLaw> Tracer<'s, L> {
    pub(crate) fn new(system: Forward<'s, L>) -> Self {
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
            stepper: Stepper::new(*system, Integrator::MIN_TOLERANCE),
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

    pub(crate) fn system(&self) -> Forward<'s, L> {
        self.system
    }

    /// Steps taken so far.
    pub(crate) fn work(&self) -> usize {
        self.work
    }

    /// |v_b| + γ²μ_s.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// The arc from `start`, forward or backward in time, to contact or to the next maximum of the
    /// velocity after it.
    ///
    /// A leading mass has v > v_b > 0, so u grows until it comes back to the belt: its arcs end in
    /// contact.
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
        let mut watch = PeakWatch::new(v_b);
        loop {
            let Advance {
                mut duration,
                end,
                speed: &speed,
            } = self.stepper.advance(&point, time, clock.time)?;
            let is_contact = end.speed == 0.0;
            let maximum = match point.direction {
                Direction::Lagging => watch.maximum(&speed, duration, steps.last()),
                Direction::Leading => None,
            };
            if let Some(t) = maximum {
                duration = t;
            }
            let state = point.state(&self.system);
            let step = Step::slip(clock, duration, point.direction, state, speed, v_b);
            clock = clock.after(duration);
            steps.push(step);
            self.work += 1;
            let arrival = if maximum.is_some() {
                Some(Arrival::Maximum(SlipPoint {
                    displacement: self.stepper.displacement(&point, time, duration),
                    speed: speed.at(duration),
                    // Exactly: that is what makes it a maximum.
                    rate: Some(0.0),
                    ..end
                }))
            } else if duration.is_infinite() || self.has_settled(&end, time) {
                Some(Arrival::Equilibrium)
            } else if is_contact {
                Some(Arrival::Contact(end.displacement))
            } else if time == Time::Backward && end.speed > FARTHEST * self.scale {
                Some(Arrival::Far)
            } else {
                None
            };
            if let Some(arrival) = arrival {
                return Ok(Arc {
                    arrival,
                    start_rate: steps.first().map_or(0.0, |step| step.speed[1]),
                    end_rate: steps.last().map_or(0.0, rate_at_end),
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

    /// Whether a motion from the belt leaves it: the sliding speed grows, at its rate s', or, where
    /// that is zero, because s'' = −σv_b there.
    fn slips(&self, start: &SlipPoint, time: Time) -> bool {
        let sigma = start.direction.sign();
        let rate = start.rate.unwrap_or_else(|| {
            let system = &self.system;
            let force = start.displacement + system.carried_force();
            -time.sign() * (sigma * force + system.load() * system.law().kinetic(0.0))
        });
        rate > 0.0 || (rate == 0.0 && start.direction == Direction::Lagging)
    }

    /// Whether a motion is at the equilibrium for good, or to rounding. Where the equilibrium
    /// attracts strongly, u − ū counts by the speed that it causes: u − ū = −h1 v on the slow
    /// motion of a node, and what is not linear is so in the speed.
    fn has_settled(&self, point: &SlipPoint, time: Time) -> bool {
        let State {
            displacement,
            velocity,
        } = point.state(&self.system);
        let deviation = (displacement - self.equilibrium).abs();
        if self.attracts == Some(time) {
            let distance = (deviation / self.stiffness).max(velocity.abs());
            distance < self.rounding.max(self.settled)
        } else {
            deviation.max(velocity.abs()) < self.rounding
        }
    }

    /// How much an arc between two places on the belt, followed in this direction of time,
    /// stretches distances there: |du_end/du_start| in forward time.
    pub(crate) fn stretch(&self, arc: &Arc, time: Time) -> f64 {
        let (start, end) = match time {
            Time::Forward => (arc.start_rate, arc.end_rate),
            Time::Backward => (arc.end_rate, arc.start_rate),
        };
        (start / end).abs() * (-self.contraction(arc)).exp()
    }

    /// The arc from the belt at displacement u, where slip in a direction begins.
    pub(crate) fn arc_leaving(&mut self, u: f64, direction: Direction) -> Result<Arc, Error> {
        self.arc(
            SlipPoint::leaving(&self.system, u, direction),
            Time::Forward,
        )
    }

    /// The arc that ends on the belt at displacement u, where slip in a direction ends, followed
    /// backwards.
    pub(crate) fn arc_arriving(&mut self, u: f64, direction: Direction) -> Result<Arc, Error> {
        self.arc(SlipPoint::arriving(u, direction), Time::Backward)
    }

    /// The arc from where the velocity behind the belt has the maximum V.
    pub(crate) fn arc_from_peak(&mut self, peak: f64, time: Time) -> Result<Arc, Error> {
        self.arc(SlipPoint::at_maximum(&self.system, peak), time)
    }

    /// ∫(2β + γ² dμ̂/ds) dτ over an arc: how fast the flow contracts areas, integrated.
    pub(crate) fn contraction(&self, arc: &Arc) -> f64 {
        let system = self.system();
        let integrand = |step: &Step, t: f64| system.effective_damping(step.speed.at(t).max(0.0));
        arc.steps
            .iter()
            .map(|step| gauss_legendre(0.0, step.duration, |t| integrand(step, t)))
            .sum()
    }
}

/// ds/dτ at the end of a step.
fn rate_at_end(step: &Step) -> f64 {
    step.speed.derivative().at(step.duration)
}

/// Watches for the first maximum of the velocity on an arc behind the belt.
#[derive(Debug, Clone)]
struct PeakWatch {
    v_b: f64,
    /// Whether a maximum can come: v grew at the start, or after a minimum, which lies at v < 0
    /// because v'' = −v there. Near the slow motion of a stiff system rounding makes v' change its
    /// sign in between.
    has_grown: bool,
}

impl PeakWatch {
    fn new(v_b: f64) -> Self {
        Self {
            v_b,
            has_grown: false,
        }
    }

    /// When the velocity has its maximum within a step, which follows on `before`.
    fn maximum(&mut self, speed: &PowerSeries, h: f64, before: Option<&Step>) -> Option<f64> {
        self.has_grown |= (before.is_none() && speed[1] < 0.0) || speed[0] > self.v_b;
        if self.has_grown && speed[1] >= 0.0 && before.is_some_and(|step| rate_at_end(step) < 0.0) {
            // Between two steps, where rounding may put it before the one and after the other.
            Some(0.0)
        } else if self.may_come(speed, h) {
            self.first_inside(speed, h)
        } else {
            None
        }
    }

    /// Whether a maximum may lie in (0, h): only after the velocity grew, or was negative, and
    /// where it is positive. It keeps its sign for about half a turn, longer than a quarter of any
    /// step.
    fn may_come(&self, speed: &PowerSeries, h: f64) -> bool {
        let speeds = speed.at_four(quarters(h));
        let negative = |s: &f64| *s > self.v_b;
        let all_negative = negative(&speed[0]) && speeds.iter().all(negative);
        (self.has_grown || speeds.iter().any(negative)) && !all_negative
    }

    /// First time in (0, h) at which the velocity has a maximum: the sliding speed has a minimum,
    /// and v has grown, which it does from where the speed has a maximum above v_b.
    fn first_inside(&mut self, speed: &PowerSeries, h: f64) -> Option<f64> {
        let mut rate = speed.derivative();
        if rate[0] == 0.0 {
            // An extremum at the start is divided out: it is known.
            rate = rate.without_root(1);
        }
        let mut minimum = None;
        if h.is_finite() {
            let _ = rate.sign_changes(h, &mut |t, rising| {
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
