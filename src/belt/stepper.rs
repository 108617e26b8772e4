//! Motion within a slip phase, one Taylor step at a time, forward or backward in time.

use std::cmp::Ordering;

use super::breakpoints::Breakpoints;
use super::model::Belt;
use crate::clock::Time;
use crate::error::{Error, Reached};
use crate::friction::slip_series::{Expander, Expansion, Known, SlipPoint};
use crate::motion::step_control::{
    self, Allowance, Attempt, FARTHEST, LONG, LOOSEST, SETTLING, STIFF,
};
use crate::series::{PowerSeries, TERMS, quarters};
use crate::state::State;

/// One Taylor step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Advance {
    /// Duration of the step; infinite exactly on an equilibrium.
    pub(crate) duration: f64,
    /// The point at its end.
    pub(crate) end: SlipPoint,
}

impl Advance {
    /// Returns true if the step ends in contact: at zero sliding speed.
    pub(crate) fn is_contact(&self) -> bool {
        self.end.speed == 0.0
    }
}

/// The accepted length of a step.
#[derive(Debug, Clone, Copy)]
struct AcceptedStep {
    duration: f64,
    /// Sliding speed at the end; at contact and at a breakpoint exact to the bit.
    end_speed: f64,
    /// Limit of the step after it.
    longest_next: f64,
}

/// The limits of a step.
#[derive(Debug, Clone, Copy)]
struct Plan {
    allowance: Allowance,
    /// The length that the coefficients allow.
    reach: f64,
    /// The least length of a step.
    least: f64,
    /// The time over which a defect acts on the motion: 1/D on a slow manifold, otherwise infinite.
    memory: f64,
}

/// Largest ratio of u − ū to the speeds of the motion at which u − ū is still used as the scale.
/// Let H be the mean of D between |v_b| and s; then v' = −(u − ū) − Hv. If neither H nor D exceeds
/// 32, v or v' is therefore at least 1/64 of u − ū.
const BEYOND: f64 = 64.0;

/// Computes Taylor steps within slip phases of one system, which is an argument of each call: see
/// `Machine` in `flow.rs`.
#[derive(Debug, Clone)]
pub(crate) struct Stepper {
    expander: Expander,
    breakpoints: Breakpoints,
    tolerance: f64,
    /// ū, from which the scale of the motion is measured.
    equilibrium: f64,
    /// Limit of the next step: twice the last one, if that had to be shorter than its coefficients
    /// allowed; otherwise infinite.
    longest: f64,
}

impl Stepper {
    pub(crate) fn new(system: &Belt<'_>, tolerance: f64) -> Self {
        Self {
            expander: Expander::new(),
            breakpoints: Breakpoints::new(system.law()),
            tolerance,
            equilibrium: system.equilibrium_displacement(),
            longest: f64::INFINITY,
        }
    }

    /// Number of series computed in the last step: its cost.
    pub(crate) fn passes(&self) -> usize {
        self.expander.passes
    }

    /// The sliding speed over the last step, in the time since its start; in backward time if the
    /// step was backward.
    #[inline]
    pub(crate) fn speed(&self) -> &PowerSeries {
        &self.expander.series.speed
    }

    /// The piece of the law that holds speeds just above this one, found by bisection.
    pub(crate) fn piece_above(&self, speed: f64) -> usize {
        self.breakpoints.piece_above(speed)
    }

    /// One step from `point`, up to contact or to a breakpoint of the law if one of them is
    /// reached. `elapsed` is the time since the motion began, for the step's least length and for
    /// errors.
    #[inline]
    pub(crate) fn advance(
        &mut self,
        system: &Belt<'_>,
        point: &SlipPoint,
        time: Time,
        elapsed: f64,
    ) -> Result<Advance, Error> {
        // A rate that is known is one of a motion that is not on the slow manifold.
        let may_be_slow = point.rate.is_none();
        let at_breakpoint;
        let (piece, point) = match self.breakpoints.piece(system, point, time) {
            (piece, None) => (piece, point),
            (piece, rate) => {
                at_breakpoint = SlipPoint { rate, ..*point };
                (piece, &at_breakpoint)
            }
        };
        self.expander.passes = 1;
        self.begin(system, point, piece, time, elapsed)?;
        if self.expander.series.speed[1] == 0.0 && self.expander.series.speed[2] == 0.0 {
            return Ok(Advance {
                duration: f64::INFINITY,
                end: *point,
            });
        }
        let plan = self.plan(system, point, may_be_slow, piece, time, elapsed)?;
        let settled = self.settle(system, point, piece, time, elapsed, &plan)?;
        self.longest = settled.longest_next;
        Ok(self.land(system, point, time, &settled))
    }

    /// The series from `point`.
    #[inline(always)]
    fn begin(
        &mut self,
        system: &Belt<'_>,
        point: &SlipPoint,
        piece: usize,
        time: Time,
        elapsed: f64,
    ) -> Result<(), Error> {
        let expansion = Expansion {
            expander: &mut self.expander,
            piece,
            equation: &system.equation(point.direction),
            from: point,
            time,
            known: Known::Nothing,
        };
        let expanded = system.law().expand_slip(expansion);
        expanded.map_err(|error| error.reached_at(Reached::new(elapsed, point.state(system))))
    }

    /// The limits of the step from here.
    #[inline(always)]
    fn plan(
        &mut self,
        system: &Belt<'_>,
        point: &SlipPoint,
        may_be_slow: bool,
        piece: usize,
        time: Time,
        elapsed: f64,
    ) -> Result<Plan, Error> {
        let (series, speed) = (&self.expander.series, &self.expander.series.speed);
        let state = point.state(system);
        let overflows = !(speed[TERMS - 1].is_finite() && speed[TERMS - 2].is_finite());
        if overflows || series.decay.abs() > STIFF {
            return self.stiff_plan(system, point, may_be_slow, piece, time, elapsed);
        }
        let error = self.tolerance * self.scale(system, point, state, time);
        let allowance = Allowance::new(error, series.largest_term(system, state));
        Ok(Plan {
            allowance,
            reach: allowance.reach(speed),
            least: f64::EPSILON * elapsed,
            memory: f64::INFINITY,
        })
    }

    /// The limits of a step in which the motion tends to a slow manifold, or leaves it, much faster
    /// than it oscillates, or in which the series overflows; here the series of the slow manifold
    /// may replace the explicit one.
    #[inline(never)]
    fn stiff_plan(
        &mut self,
        system: &Belt<'_>,
        point: &SlipPoint,
        may_be_slow: bool,
        piece: usize,
        time: Time,
        elapsed: f64,
    ) -> Result<Plan, Error> {
        let state = point.state(system);
        let order = self.expander.series.truncate();
        if order < 2 {
            let reached = Reached::new(elapsed, state);
            return Err(Error::StepUnderflow { step: 0.0, reached });
        }
        let closing = time.sign() * self.expander.series.decay;
        let largest_term = self.expander.series.largest_term(system, state);
        let error = if closing.abs() > STIFF {
            // Or what rounding of the forces shifts the motion by.
            let rounding = f64::EPSILON * largest_term / closing.abs();
            let tolerance = self.tolerance.min(LOOSEST);
            (tolerance * self.scale_here(system, state, closing.abs())).max(rounding)
        } else {
            self.tolerance * self.scale(system, point, state, time)
        };
        let allowance = Allowance::new(error, largest_term);
        let reach = allowance.reach_of(&self.expander.series.speed, order, FARTHEST);
        let mut plan = Plan {
            allowance,
            reach,
            least: f64::EPSILON * elapsed,
            memory: f64::INFINITY,
        };
        // Time is a sum of two numbers.
        if closing > STIFF || (time == Time::Backward && closing < -STIFF) {
            plan.least *= f64::EPSILON;
        } else if closing < -STIFF {
            // A jump after a long creep: each step changes the speed.
            let speed = &self.expander.series.speed;
            plan.least = plan.least.min(f64::EPSILON * speed[0] / speed[1].abs());
        }
        let is_impossible = reach <= plan.least;
        let has_come = is_impossible || order < TERMS - 1 || closing * reach > SETTLING;
        if closing > STIFF && has_come && may_be_slow {
            let limits = self.breakpoints.limits(piece);
            let mut allowance = allowance;
            if is_impossible {
                // A long step before has ended on the manifold within some roundings of the forces.
                let rounding = f64::EPSILON * largest_term / closing;
                allowance.error = allowance.error.max(4.0 * rounding);
            }
            let explicit = self.expander.series;
            let slow = explicit.slow(piece, system, &mut self.expander, point, time, &allowance);
            let slow = slow.filter(|(slow, _)| limits.contain(slow.speed[0]) || point.speed > 0.0);
            self.expander.series = match slow {
                Some((mut slow, reach)) => {
                    if !limits.contain(slow.speed[0]) {
                        // The same to rounding, and on the piece.
                        slow.speed[0] = point.speed;
                    }
                    plan.reach = reach;
                    plan.memory = closing.recip();
                    slow
                }
                None => explicit,
            };
        }
        Ok(plan)
    }

    /// The accepted length of the step: up to the first exit from the piece of the law, or as far
    /// as planned, halved until the defect is accepted.
    #[inline(always)]
    fn settle(
        &self,
        system: &Belt<'_>,
        point: &SlipPoint,
        piece: usize,
        time: Time,
        elapsed: f64,
        plan: &Plan,
    ) -> Result<AcceptedStep, Error> {
        let (series, speed) = (&self.expander.series, &self.expander.series.speed);
        let limits = self.breakpoints.limits(piece);
        let is_long_enough = |h: f64| h > plan.least && h >= f64::MIN_POSITIVE;
        let attempt = |h: f64| {
            let speeds = speed.at_four(quarters(h));
            let Ok(exit) = limits.first_exit(speed, h, speeds) else {
                return Attempt::TooCurved;
            };
            let (end, speeds, end_speed) = match exit {
                None => (h, speeds, speeds[3]),
                Some((t, limit)) => (t, speed.at_some(quarters(t)), limit),
            };
            let between = if end > LONG {
                series.defect_in_between(system, piece, end)
            } else {
                0.0
            };
            let defects = [
                system.defect(piece, series.friction.at_four(quarters(end)), speeds),
                series.defect_at_minimum(system, piece, end, speeds),
                between,
            ];
            if plan.allowance.accepts(defects, end.min(plan.memory)) {
                // If the tolerance is large compared with the changes of s, a series may have a
                // root that the motion does not have, and the step would end at its start again and
                // again.
                let leaves = exit.is_none_or(|(t, limit)| {
                    let rate = self.rate_after(system, point, piece, time, t, limit);
                    let inwards = if limits.is_low(limit) { rate } else { -rate };
                    plan.allowance.is_rounding(inwards)
                });
                if leaves {
                    return Attempt::Taken((end, end_speed));
                }
            }
            Attempt::Inexact(end)
        };
        let longest = plan.reach.min(self.longest);
        let ((duration, end_speed), h) = step_control::settle(longest, is_long_enough, attempt)
            .map_err(|h| {
                let reached = Reached::new(elapsed, point.state(system));
                self.underflow(system, piece, h, reached)
            })?;
        Ok(AcceptedStep {
            duration,
            end_speed,
            longest_next: if h < plan.reach {
                2.0 * h
            } else {
                f64::INFINITY
            },
        })
    }

    /// The rate ds/dt by the equation of motion, a time t after the start of the last step, at the
    /// sliding speed reached there.
    #[inline(never)]
    fn rate_after(
        &self,
        system: &Belt<'_>,
        from: &SlipPoint,
        piece: usize,
        time: Time,
        t: f64,
        speed: f64,
    ) -> f64 {
        let sigma = from.direction.sign();
        let velocity = system.belt_velocity() + sigma * speed;
        let damper = 2.0 * system.damping() * velocity;
        let force = sigma * (self.displacement(system, from, time, t) + damper);
        time.sign() * (-force - system.load() * system.law().kinetic_on(piece, speed))
    }

    /// The accepted step, with the point at its end.
    #[inline(always)]
    fn land(
        &self,
        system: &Belt<'_>,
        point: &SlipPoint,
        time: Time,
        settled: &AcceptedStep,
    ) -> Advance {
        Advance {
            duration: settled.duration,
            end: SlipPoint {
                displacement: self.displacement_inline(system, point, time, settled.duration),
                speed: settled.end_speed,
                rate: None,
                ..*point
            },
        }
    }

    /// The scale of the tolerance: max(|u − ū|, |v|, |v_b|); if the law is so steep that ū lies far
    /// beyond the motion, the scale of the motion without ū.
    #[inline(always)]
    fn scale(&self, system: &Belt<'_>, point: &SlipPoint, state: State, time: Time) -> f64 {
        let deviation = (state.displacement - self.equilibrium).abs();
        let v_b = system.belt_velocity();
        let speed = state.velocity.abs().max(v_b.abs());
        if deviation <= BEYOND * speed {
            deviation.max(speed)
        } else {
            self.scale_far_out(system, deviation, point, state, time)
        }
    }

    #[inline(never)]
    fn scale_far_out(
        &self,
        system: &Belt<'_>,
        deviation: f64,
        point: &SlipPoint,
        state: State,
        time: Time,
    ) -> f64 {
        // Where the law changes within a small part of a radian, v changes by v' times the step.
        let reach = step_control::reach(
            self.tolerance * deviation,
            &self.expander.series.speed,
            TERMS - 1,
        );
        if BEYOND * reach < 1.0 {
            return self.scale_here(system, state, (BEYOND * reach).recip());
        }
        let here = self.scale_here(
            system,
            state,
            (time.sign() * self.expander.series.decay).max(1.0),
        );
        // Friction on the equilibrium's side of the belt has another sign than beyond it; on a belt
        // at rest ū is 0, halfway between the two.
        let leads = point.direction.sign() * system.belt_velocity();
        let jump = match leads.partial_cmp(&0.0) {
            Some(Ordering::Greater) => 2.0 * system.largest_friction(),
            Some(Ordering::Equal) => system.largest_friction(),
            _ => 0.0,
        };
        if deviation <= BEYOND * here + jump {
            deviation
        } else {
            here
        }
    }

    /// The scale without ū, max(|v|, |v_b|, |v'|/D), with D the rate at which the motion tends to a
    /// slow manifold, or leaves it.
    fn scale_here(&self, system: &Belt<'_>, state: State, rate: f64) -> f64 {
        let v_b = system.belt_velocity();
        let change = self.expander.series.speed[1].abs() / rate;
        state.velocity.abs().max(v_b.abs()).max(change)
    }

    /// Displacement at a time t after the start of the last step, from `start`.
    #[inline(never)]
    pub(crate) fn displacement(
        &self,
        system: &Belt<'_>,
        start: &SlipPoint,
        time: Time,
        t: f64,
    ) -> f64 {
        self.displacement_inline(system, start, time, t)
    }

    /// Computes [`displacement`](Self::displacement), inlined where speed counts.
    #[inline(always)]
    fn displacement_inline(&self, system: &Belt<'_>, start: &SlipPoint, time: Time, t: f64) -> f64 {
        let mean_speed = self.expander.series.speed.mean(t);
        let mean_velocity = system.belt_velocity() + start.direction.sign() * mean_speed;
        start.displacement + time.sign() * mean_velocity * t
    }

    /// The error of the law if it returned no number on the motion, otherwise a step underflow.
    #[cold]
    fn underflow(&self, system: &Belt<'_>, piece: usize, step: f64, reached: Reached) -> Error {
        let law = system.law();
        let speeds = self.expander.series.speed.at_some(quarters(2.0 * step));
        let failure = speeds
            .into_iter()
            .map(|s| (s, law.kinetic_on(piece, s.max(0.0))))
            .find(|(s, value)| s.is_finite() && !value.is_finite());
        match failure {
            Some((speed, value)) => Error::NonFiniteFriction {
                speed,
                value,
                reached: Some(reached),
            },
            None => Error::StepUnderflow { step, reached },
        }
    }
}

#[cfg(test)]
mod tests;
