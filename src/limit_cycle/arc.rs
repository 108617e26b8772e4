//! Slip arcs: from a point of a slip phase to the next place where something is decided.

use std::ops::ControlFlow;

use crate::friction::FrictionLaw;
use crate::integrator::{
    Advance, Clock, Mode, Polynomial, SlipPoint, Step, Stepper, TERMS, Time, derivative, evaluate,
    sign_changes,
};
use crate::quadrature::gauss_legendre;
use crate::{Error, Integrator, MassOnBelt, Reached, State};

/// Where a slip arc ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Arrival {
    /// On the belt, v = v_b, at this displacement.
    Contact(f64),
    /// At a maximum of the velocity, below v_b.
    Maximum(SlipPoint),
    /// Nowhere: it settles at a node without turning round it.
    Equilibrium,
    /// Nowhere: followed backwards, it grows beyond [`FAR`].
    Far,
}

/// Follows slip arcs of one system, v_b > 0, to round-off.
#[derive(Debug, Clone)]
pub(crate) struct Tracer<'s, L> {
    stepper: Stepper<'s, L>,
    /// Distance within which a node has the motion for good; 0 for a focus, round which it turns for ever.
    settled: f64,
    equilibrium: f64,
    /// |v_b| + γ²μ_s, by which distances are measured.
    scale: f64,
}

/// A slip arc: its steps and its end.
#[derive(Debug, Clone)]
pub(crate) struct Arc {
    pub(crate) steps: Vec<Step>,
    pub(crate) arrival: Arrival,
    /// ds/dτ at its start and at its end.
    pub(crate) rates: [f64; 2],
}

/// Fraction of v_b within which the motion near a node is linear, so that it cannot turn any more.
const SETTLED: f64 = 1e-9;

/// Sliding speed, in units of |v_b| + γ²μ_s, beyond which a motion is not followed backwards. Laws that rise fast enough let it grow to
/// infinity in finite time.
pub(crate) const FAR: f64 = 1e4;

impl<'s, L: FrictionLaw> Tracer<'s, L> {
    pub(crate) fn new(system: &'s MassOnBelt<L>) -> Self {
        let node = system
            .equilibrium()
            .is_some_and(|equilibrium| equilibrium.eigenvalues[0].im == 0.0);
        Self {
            stepper: Stepper::new(system, Integrator::MIN_TOLERANCE),
            settled: if node {
                SETTLED * system.belt_velocity().abs()
            } else {
                0.0
            },
            equilibrium: system.equilibrium_displacement(),
            scale: system.belt_velocity().abs() + system.load() * system.law().static_coefficient(),
        }
    }

    pub(crate) fn system(&self) -> &'s MassOnBelt<L> {
        self.stepper.system()
    }

    /// |v_b| + γ²μ_s.
    pub(crate) fn scale(&self) -> f64 {
        self.scale
    }

    /// The arc from `start`, forward or backward in time, to contact or to the next maximum of the velocity after it.
    ///
    /// A leading mass has v > v_b > 0, so u grows until it comes back to the belt: its arcs end in contact.
    pub(crate) fn arc(&mut self, start: SlipPoint, time: Time) -> Result<Arc, Error> {
        let mut point = start;
        let mut clock = Clock::default();
        let mut steps = Vec::with_capacity(16);
        let mut rates = None;
        loop {
            let advance = self.stepper.advance(&point, time, clock.time)?;
            let Advance { mut duration, end } = advance;
            let speed = *self.stepper.speed();
            let [first, last] = rates.unwrap_or([speed[1], 0.0]);
            // Between two steps as well, where rounding may put it before the one and after the other.
            let maximum = if last < 0.0 && speed[1] >= 0.0 {
                Some(0.0)
            } else {
                next_maximum(&speed, duration)
            };
            if let Some(t) = maximum {
                duration = t;
            }
            rates = Some([first, evaluate(&derivative(&speed), duration)]);
            let step = Step {
                start: clock,
                duration,
                mode: Mode::Slip(point.direction),
                state: self.stepper.state(&point),
                speed,
                event: None,
                belt_velocity: self.system().belt_velocity(),
            };
            clock = clock.after(duration);
            steps.push(step);
            let arrival = if maximum.is_some() {
                Some(Arrival::Maximum(SlipPoint {
                    displacement: self.stepper.displacement(&point, time, duration),
                    speed: evaluate(&speed, duration),
                    // Exactly: that is what makes it a maximum.
                    rate: Some(0.0),
                    ..end
                }))
            } else if duration.is_infinite() || self.has_settled(&end) {
                Some(Arrival::Equilibrium)
            } else if advance.is_contact() {
                Some(Arrival::Contact(end.displacement))
            } else if time == Time::Backward && end.speed > FAR * self.scale {
                Some(Arrival::Far)
            } else {
                None
            };
            if let Some(arrival) = arrival {
                return Ok(Arc {
                    steps,
                    arrival,
                    rates: rates.unwrap_or_default(),
                });
            }
            if steps.len() >= Integrator::DEFAULT_MAX_STEPS {
                let limit = Integrator::DEFAULT_MAX_STEPS;
                let reached = Reached {
                    time: clock.time,
                    state: self.stepper.state(&end),
                };
                return Err(Error::TooManySteps { limit, reached });
            }
            point = end;
        }
    }

    fn has_settled(&self, point: &SlipPoint) -> bool {
        let State {
            displacement,
            velocity,
        } = self.stepper.state(point);
        (displacement - self.equilibrium).abs().max(velocity.abs()) < self.settled
    }

    /// ∫(2β + γ² dμ̂/ds) dτ over an arc: how fast the flow contracts areas, integrated.
    pub(crate) fn contraction(&self, arc: &Arc) -> f64 {
        let system = self.system();
        let integrand = |step: &Step, t: f64| {
            let speed = evaluate(&step.speed, t).max(0.0);
            2.0 * system.damping() + system.load() * system.law().slope(speed)
        };
        arc.steps
            .iter()
            .map(|step| gauss_legendre(0.0, step.duration, |t| integrand(step, t)))
            .sum()
    }
}

/// First time in (0, h) at which the sliding speed has a minimum.
fn next_maximum(speed: &Polynomial, h: f64) -> Option<f64> {
    let mut rate = derivative(speed);
    if rate[0] == 0.0 {
        // An extremum at the start is divided out: it is known.
        rate.copy_within(1.., 0);
        rate[TERMS - 1] = 0.0;
    }
    let mut minimum = None;
    if h.is_finite() {
        let _ = sign_changes(&rate, h, &mut |t, rising| {
            if rising {
                minimum = Some(t);
                return ControlFlow::Break(());
            }
            ControlFlow::Continue(())
        });
    }
    minimum
}
