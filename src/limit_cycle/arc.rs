//! Slip arcs: from a point of a slip phase to the next place where something is decided.

use std::ops::ControlFlow;

use crate::belt::{Advance, SlipPoint, Step, Stepper};
use crate::belt::{MassOnBelt, Stability};
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
    /// Nowhere: followed backwards, it grows beyond [`FAR`].
    Far,
}

/// Follows slip arcs of one system, v_b > 0, to round-off.
#[derive(Debug, Clone)]
pub(crate) struct Tracer<'s, L> {
    system: &'s MassOnBelt<&'s L>,
    stepper: Stepper<'s, L>,
    /// The direction of time in which the equilibrium attracts, if it does in one.
    attracts: Option<Time>,
    /// Distance within which it then has the motion for good.
    settled: f64,
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
    /// ds/dτ at its start and at its end.
    pub(crate) rates: [f64; 2],
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
pub(crate) const FAR: f64 = 16.0;

/// Most steps of one arc. An oscillation takes about ten; on the slow branch of a stiff system
/// (γ²μ̂' of 1000) it may be ten thousand.
const MOST_STEPS: usize = Integrator::DEFAULT_MAX_STEPS;

impl<'s, L: FrictionLaw> Tracer<'s, L> {
    pub(crate) fn new(system: &'s MassOnBelt<&'s L>) -> Self {
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
            scale: system.belt_velocity().abs() + system.load() * system.law().static_coefficient(),
            work: 0,
        }
    }

    pub(crate) fn system(&self) -> &'s MassOnBelt<&'s L> {
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
        let mut point = start;
        let mut clock = Clock::default();
        let mut steps: Vec<Step> = Vec::with_capacity(16);
        // Whether a maximum of v can come: if v grows at the start, or after a minimum, which lies
        // at v < 0 because v'' = −v there. Near the slow motion of a stiff system rounding makes v'
        // change its sign in between.
        let mut grows = false;
        loop {
            let advance = self.stepper.advance(&point, time, clock.time)?;
            let Advance {
                mut duration,
                end,
                speed: &speed,
            } = advance;
            let is_contact = advance.is_contact();
            let first = steps.first().map_or(speed[1], |step| step.speed[1]);
            let behind = point.direction == Direction::Lagging;
            let v_b = self.system().belt_velocity();
            grows |= behind && (first < 0.0 || point.speed > v_b);
            let maximum = if grows
                && speed[1] >= 0.0
                && steps.last().is_some_and(|step| rate_at_end(step) < 0.0)
            {
                // Between two steps, where rounding may put it before the one and after the other.
                Some(0.0)
            } else if behind && may_turn(&speed, duration, v_b, grows) {
                next_maximum(&speed, duration, v_b, &mut grows)
            } else {
                None
            };
            if let Some(t) = maximum {
                duration = t;
            }
            let state = point.state(self.system);
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
            } else if time == Time::Backward && end.speed > FAR * self.scale {
                Some(Arrival::Far)
            } else {
                None
            };
            if let Some(arrival) = arrival {
                let last = steps.last().map_or(first, rate_at_end);
                return Ok(Arc {
                    steps,
                    arrival,
                    rates: [first, last],
                });
            }
            if steps.len() >= MOST_STEPS {
                let limit = MOST_STEPS;
                let reached = Reached::new(clock.time, end.state(self.system));
                return Err(Error::TooManySteps { limit, reached });
            }
            point = end;
        }
    }

    fn has_settled(&self, point: &SlipPoint, time: Time) -> bool {
        let State {
            displacement,
            velocity,
        } = point.state(self.system);
        let distance = (displacement - self.equilibrium).abs().max(velocity.abs());
        distance < self.rounding || (self.attracts == Some(time) && distance < self.settled)
    }

    /// ∫(2β + γ² dμ̂/ds) dτ over an arc: how fast the flow contracts areas, integrated.
    pub(crate) fn contraction(&self, arc: &Arc) -> f64 {
        let system = self.system();
        let integrand = |step: &Step, t: f64| {
            let speed = step.speed.at(t).max(0.0);
            2.0 * system.damping() + system.load() * system.law().slope(speed)
        };
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

/// Whether the velocity of a lagging motion may have a maximum in (0, h): only after it grew, or
/// was negative, and where it is positive. It keeps its sign for about half a turn, longer than a
/// quarter of any step.
fn may_turn(speed: &PowerSeries, h: f64, v_b: f64, grows: bool) -> bool {
    let speeds = speed.at_four(quarters(h));
    let negative = |s: &f64| *s > v_b;
    (grows || speeds.iter().any(negative)) && !(negative(&speed[0]) && speeds.iter().all(negative))
}

/// First time in (0, h) at which the velocity of a lagging motion has a maximum: the sliding speed
/// has a minimum, and `grows`, which is set where the speed has a maximum above v_b.
fn next_maximum(speed: &PowerSeries, h: f64, v_b: f64, grows: &mut bool) -> Option<f64> {
    let mut rate = speed.derivative();
    if rate[0] == 0.0 {
        // An extremum at the start is divided out: it is known.
        rate = rate.without_root(1);
    }
    let mut minimum = None;
    if h.is_finite() {
        let _ = rate.sign_changes(h, &mut |t, rising| {
            if rising && *grows {
                minimum = Some(t);
                return ControlFlow::Break(());
            }
            *grows |= !rising && speed.at(t) > v_b;
            ControlFlow::Continue(())
        });
    }
    minimum
}

#[cfg(test)]
mod tests;
