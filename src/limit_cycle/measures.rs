//! Extremes of a cycle, as roots of its power series, and integrals over it.

use std::ops::ControlFlow;

use super::cycle::LimitCycle;
use crate::belt::Step;
use crate::numerics::gauss::gauss_fours;
use crate::series::PowerSeries;
use crate::state::State;

impl LimitCycle {
    /// ∮u dτ.
    pub(super) fn integral_of_displacement(&self) -> f64 {
        let over = |step: &Step| {
            let h = step.duration;
            let slipped = step.direction().map_or(0.0, |direction| {
                // ∫∫s = h² Σ s_k h^k/((k + 1)(k + 2))
                let twice = PowerSeries::from_fn(|k| step.speed[k] / ((k + 1) * (k + 2)) as f64);
                direction.sign() * twice.at(h)
            });
            (step.state.displacement + (0.5 * step.belt_velocity + slipped) * h) * h
        };
        self.steps.iter().map(over).sum()
    }

    /// ∮v² dτ.
    pub(super) fn integral_of_squared_velocity(&self) -> f64 {
        let over = |step: &Step| {
            let v_b = step.belt_velocity;
            let Some(direction) = step.direction() else {
                return v_b * v_b * step.duration;
            };
            let velocity = |s: f64| v_b + direction.sign() * s;
            let four = |(times, weights): ([f64; 4], [f64; 4])| {
                let speeds = step.speed.at_four(times);
                std::iter::zip(weights, speeds)
                    .map(|(weight, s)| weight * velocity(s) * velocity(s))
                    .sum::<f64>()
            };
            gauss_fours(0.0, step.duration)
                .map(four)
                .iter()
                .sum::<f64>()
        };
        self.steps.iter().map(over).sum()
    }

    /// Least and largest displacement: at the ends of steps, or where v changes sign.
    pub(super) fn displacements(&self) -> [f64; 2] {
        self.extremes(
            |state| state.displacement,
            |step| {
                let mut velocity = step.speed.scaled(step.sigma());
                velocity[0] += step.belt_velocity;
                velocity
            },
        )
    }

    /// Least and largest velocity: at the ends of steps, or where s' changes sign.
    pub(super) fn velocities(&self) -> [f64; 2] {
        self.extremes(|state| state.velocity, |step| step.speed.derivative())
    }

    fn extremes(
        &self,
        quantity: impl Fn(State) -> f64,
        rate: impl Fn(&Step) -> PowerSeries,
    ) -> [f64; 2] {
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        let mut include = |state: State| {
            let value = quantity(state);
            range = [range[0].min(value), range[1].max(value)];
        };
        for step in &self.steps {
            include(step.state());
            if step.direction().is_some() {
                let _ = rate(step).sign_changes(step.duration, &mut |t, _| {
                    include(step.state_at(t));
                    ControlFlow::Continue(())
                });
            }
        }
        range
    }
}
