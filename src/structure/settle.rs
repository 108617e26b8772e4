//! How far the series of a step are used, and what ends it.

use super::engine::{Engine, Settled};
use super::parts::{Body, Edge, Firing, Joint};
use crate::error::Error;
use crate::friction::memory::Slip;
use crate::motion::Mode;
use crate::motion::step_control::{Allowance, FARTHEST, reach};
use crate::series::{PowerSeries, TERMS, TooCurved, Watch, quarters};
use crate::state::Direction;

/// Ulps of the time by which events of several contacts may lie apart that end a step together:
/// rounding alone can part those of mirrored masses so far.
const TOGETHER: f64 = 4.0;

/// A number that can be halved; in any unit.
const LONGEST_STEP: f64 = 4294967296.0;

impl Engine<'_> {
    /// The step's duration, up to the first watch that reaches zero; which contacts it is that end
    /// it is left with them.
    pub(super) fn settle(&mut self) -> Result<Settled, Error> {
        let (break_time, to_break) = self.next_break();
        if self.is_linear() {
            return self.settle_linear(break_time, to_break);
        }
        if !self.is_finite() {
            return Err(self.underflow(0.0));
        }
        let explicit = self.reach();
        let reach = self.relax(explicit);
        let elapsed = self.clock.time.abs();
        // A motion that nothing gives a length is a polynomial, and good at any time.
        let cut = reach.min(self.longest).min(LONGEST_STEP);
        let mut h = cut.min(to_break);
        let duration = loop {
            if !(h >= to_break || h > f64::EPSILON * elapsed && h >= f64::MIN_POSITIVE) {
                return Err(self.underflow(h));
            }
            let Ok(end) = self.first_firing(h, to_break) else {
                h *= 0.5;
                continue;
            };
            if self.defects_are_accepted(end) {
                break end;
            }
            h = 0.5 * end;
        };
        let is_cut = h < cut.min(to_break) || self.longest < reach;
        self.longest = if is_cut { 2.0 * h } else { f64::INFINITY };
        Ok(Settled {
            duration,
            at_break: break_time.filter(|_| duration >= to_break),
        })
    }

    /// The same where all velocities are constant and all loads straight lines: no series limits
    /// the step, but what contacts remember goes on, and may show more of their laws.
    fn settle_linear(&mut self, break_time: Option<f64>, to_break: f64) -> Result<Settled, Error> {
        let longest = self.longest_remembered();
        let mut h = to_break.min(longest);
        let duration = loop {
            // Roots of straight lines need no isolation.
            let end = self.first_firing(h, to_break).unwrap_or(h);
            if longest.is_infinite() || self.defects_are_accepted(end) {
                break end;
            }
            h = 0.5 * end;
            if h.is_nan() || h <= f64::EPSILON * self.clock.time.abs() || h < f64::MIN_POSITIVE {
                return Err(self.underflow(h));
            }
        };
        Ok(Settled {
            duration,
            at_break: break_time.filter(|_| duration >= to_break),
        })
    }

    /// How long a step may be in which nothing but the memory of contacts changes: until it has
    /// changed by its own size, and longer where the structure's own times are.
    fn longest_remembered(&mut self) -> f64 {
        let changing = |joint: &Joint| {
            let rate = |series: &PowerSeries| (series[0] / series[1]).abs();
            let memories = joint.memories.iter().filter(|series| !series.is_constant());
            memories.map(rate).reduce(f64::min)
        };
        let closed = self.joints.iter().filter(|joint| joint.mode != Mode::Open);
        let Some(least) = closed.filter_map(changing).reduce(f64::min) else {
            return f64::INFINITY;
        };
        self.reach();
        least.max(FARTHEST * self.unit)
    }

    /// Where pieces of a drive meet next, as a time and as a duration from now.
    fn next_break(&self) -> (Option<f64>, f64) {
        let drives = self.model.varying.iter();
        let times = drives.filter_map(|&at| self.model.drive(at).next_break(self.clock));
        let time = times.min_by(f64::total_cmp);
        let duration = time.map_or(f64::INFINITY, |time| self.clock.until(time).max(0.0));
        (time, duration)
    }

    /// Whether every velocity is constant, and every distance from a limit linear in time.
    fn is_linear(&self) -> bool {
        self.bodies
            .iter()
            .all(|body| body.speeds.is_constant() && body.surface.is_constant())
            && self.joints.iter().all(|joint| match joint.mode {
                Mode::Stick => {
                    let body = &self.bodies[joint.body];
                    body.carried.is_linear() && joint.bound.is_linear() && joint.load.is_linear()
                }
                _ => joint.load.is_linear(),
            })
    }

    /// The model's time unit; where nothing is elastic and nothing damps, the time in which
    /// forces change by their own size, or else would change a velocity so.
    fn time_unit(&self, scales: &[(f64, f64)]) -> f64 {
        if self.model.time_unit.is_finite() {
            return self.model.time_unit;
        }
        let least = |times: &mut dyn Iterator<Item = f64>| {
            times
                .filter(|&time| time > 0.0)
                .fold(f64::INFINITY, f64::min)
        };
        let forces = std::iter::zip(&self.bodies, scales);
        let mut changing = forces.flat_map(|(body, &(_, terms))| {
            (1..4).map(move |k| (terms / body.carried[k].abs()).powf(1.0 / k as f64))
        });
        let changing = least(&mut changing);
        if changing.is_finite() {
            return changing;
        }
        let velocities = std::iter::zip(&self.bodies, scales);
        least(
            &mut velocities.map(|(body, &(_, terms))| {
                body.velocity().abs().max(body.surface[0].abs()) / terms
            }),
        )
    }

    /// Whether all series could be computed to their ends.
    fn is_finite(&self) -> bool {
        const LAST: usize = TERMS - 1;
        let of_bodies = self.bodies.iter().flat_map(|body| {
            let [v, r] = [&body.speeds, &body.carried];
            [v[LAST], v[LAST - 1], r[LAST - 1], r[LAST - 2]]
        });
        let of_joints = self.joints.iter().flat_map(|joint| {
            let memories = joint.memories.iter().map(|series| series[LAST]);
            memories.chain([joint.bound[LAST - 1], joint.load[LAST - 1]])
        });
        of_bodies.chain(of_joints).all(f64::is_finite)
    }

    /// How far the last coefficients of all series stay below the error allowed; what each
    /// coordinate is allowed is noted.
    pub(super) fn reach(&mut self) -> f64 {
        let mut allowances = std::mem::take(&mut self.allowances);
        allowances.clear();
        // A mass that does not move yet is judged by how others will move it.
        let mut energy = 0.0_f64;
        let mut scales = std::mem::take(&mut self.scales);
        scales.clear();
        scales.extend((0..self.bodies.len()).map(|i| (0.0, self.terms(i))));
        for joint in &self.joints {
            let i = joint.body;
            if joint.direction().is_some() {
                scales[i].1 += (joint.load[0] * joint.friction[0]).abs();
            }
        }
        self.unit = self.time_unit(&scales);
        let unit = self.unit;
        for (i, (scale, _)) in scales.iter_mut().enumerate() {
            let body = &self.bodies[i];
            let closing = self.closing(i);
            let unit = if closing * unit > 1.0 {
                closing.recip()
            } else {
                unit
            };
            let rate = body.speeds[1].abs().max(unit * body.speeds[2].abs());
            let by_rate = if unit.is_finite() { unit * rate } else { 0.0 };
            *scale = body
                .velocity()
                .abs()
                .max(body.surface[0].abs())
                .max(by_rate);
            energy = energy.max(*scale / self.model.inverse_mass[i].sqrt());
        }
        self.scales = scales;
        let mut farthest = FARTHEST * unit;
        for (i, &(own, terms)) in self.scales.iter().enumerate() {
            let body = &self.bodies[i];
            let shared = energy * self.model.inverse_mass[i].sqrt();
            let scale = if own < shared {
                own.max(shared.min(body.speeds.largest_change(unit)))
            } else {
                own
            };
            let allowance = Allowance::new(self.tolerance * scale, terms);
            for series in [&body.speeds, &body.surface] {
                farthest = farthest.min(reach_of(allowance.error, series, TERMS - 1));
            }
            allowances.push(allowance);
        }
        for (c, joint) in self.joints.iter().enumerate() {
            let body = &self.bodies[joint.body];
            if joint.mode == Mode::Stick {
                // The last coefficient of R needs that of the velocities, and is not there.
                let error = f64::EPSILON * joint.bound[0].abs().max(self.scales[joint.body].1);
                farthest = farthest.min(reach_of(error, &body.carried, TERMS - 2));
                farthest = farthest.min(reach_of(error, &joint.bound, TERMS - 2));
            }
            if joint.load_varies {
                let error = f64::EPSILON * self.load_terms(c);
                farthest = farthest.min(reach_of(error, &joint.load, TERMS - 2));
            }
            for (series, memory) in std::iter::zip(&joint.memories, &joint.memory) {
                let scale = memory.abs().max(series[1].abs() * farthest.min(f64::MAX));
                farthest = farthest.min(reach_of(f64::EPSILON * scale, series, TERMS - 1));
            }
        }
        self.allowances = allowances;
        farthest
    }

    /// The rate at which a deviation of the sliding speed of a coordinate dies out; 0 unless it
    /// slips.
    fn closing(&self, i: usize) -> f64 {
        let joint = self.bodies[i].contact.map(|c| &self.joints[c]);
        let slipping = joint.filter(|joint| joint.direction().is_some());
        slipping.map_or(0.0, |joint| {
            self.model.damping.row(i).0 + joint.load[0] * joint.slope
        })
    }

    /// The first time in (0, h] at which a contact has to be looked at, or h. Within rounding of a
    /// break it is that: what a contact comes to where pieces of a drive meet, the later piece
    /// decides on.
    fn first_firing(&mut self, h: f64, to_break: f64) -> Result<f64, TooCurved> {
        let elapsed = self.clock.time.abs();
        let slack = |end: f64| TOGETHER * f64::EPSILON * (elapsed + end);
        let mut end = h;
        for joint in &mut self.joints {
            let limit = if end < h { h.min(end + slack(end)) } else { h };
            let body = &self.bodies[joint.body];
            joint.firing = joint.first_firing(body, limit)?;
            if let Some((time, _)) = joint.firing {
                end = end.min(time);
            }
        }
        for joint in &mut self.joints {
            joint.firing = joint.firing.filter(|&(time, _)| time <= end + slack(end));
        }
        if to_break <= end + slack(end) {
            end = end.max(to_break);
        }
        Ok(end)
    }

    /// The law's own failure if it gave no number where the motion goes, else a step too short.
    #[cold]
    fn underflow(&self, step: f64) -> Error {
        let reached = self.reached();
        for (c, joint) in self.joints.iter().enumerate() {
            let Some(direction) = joint.direction() else {
                continue;
            };
            for t in quarters(2.0 * step) {
                let speed = self.bodies[joint.body].speeds.at(t);
                let slip = Slip {
                    speed: speed.max(0.0),
                    direction: direction.sign(),
                    piece: joint.piece,
                };
                let memory = &|j: usize| joint.memories[j].at(t);
                let value = self.model.laws.coefficient(c, slip, memory) * slip.direction;
                if speed.is_finite() && !value.is_finite() {
                    return Error::NonFiniteFriction {
                        speed,
                        value,
                        reached: Some(reached),
                    };
                }
            }
        }
        Error::StepUnderflow { step, reached }
    }
}

/// How far a series may be used; as far as one likes where it ends before its last terms, even if
/// no error is allowed because nothing moves.
fn reach_of(error: f64, c: &PowerSeries, n: usize) -> f64 {
    if c[n] == 0.0 && c[n - 1] == 0.0 {
        f64::INFINITY
    } else {
        reach(error, c, n)
    }
}

impl Joint {
    /// The first time in (0, h] at which it has to be looked at, and why.
    fn first_firing(&self, body: &Body, h: f64) -> Result<Option<(f64, Firing)>, TooCurved> {
        let of_load = self.load_firing(h)?;
        let of_motion = match self.mode {
            Mode::Open => None,
            Mode::Stick => self.bound_firing(body, h)?,
            Mode::Slip(_) => self.speed_firing(&body.speeds, h)?,
        };
        Ok(match (of_load, of_motion) {
            (Some(load), Some(motion)) if motion.0 < load.0 => Some(motion),
            (load, motion) => load.or(motion),
        })
    }

    /// The normal load falls to 0, or comes back.
    fn load_firing(&self, h: f64) -> Result<Option<(f64, Firing)>, TooCurved> {
        if !self.load_varies {
            return Ok(None);
        }
        let sign = if self.mode == Mode::Open { -1.0 } else { 1.0 };
        let mut load = self.load.scaled(sign);
        for k in 0..self.load_edge.known() {
            load[k] = 0.0;
        }
        first(&load, h, Firing::Load)
    }

    /// What it carries comes to one of its limits.
    fn bound_firing(&self, body: &Body, h: f64) -> Result<Option<(f64, Firing)>, TooCurved> {
        let carried = &body.carried;
        if self.edge == Edge::Away
            && self.bound.is_constant()
            && carried.stays_within(self.bound[0], h)
        {
            return Ok(None);
        }
        let mut found: Option<(f64, Firing)> = None;
        for side in [Direction::Lagging, Direction::Leading] {
            let distance = self.distance(carried, side);
            let h = found.map_or(h, |(time, _)| time);
            found = first(&distance, h, Firing::Bound(side))?.or(found);
        }
        Ok(found)
    }

    /// The sliding speed comes to 0, or to a breakpoint of the law.
    fn speed_firing(
        &self,
        speeds: &PowerSeries,
        h: f64,
    ) -> Result<Option<(f64, Firing)>, TooCurved> {
        if speeds.is_constant() {
            return Ok(None);
        }
        let low = match self.piece.checked_sub(1) {
            // The usual case, kept short.
            None if speeds[0] > 0.0 => {
                let root = speeds.first_root(h, speeds.at_four(quarters(h)))?;
                root.map(|time| (time, Firing::Arrival))
            }
            None => first(speeds, h, Firing::Arrival)?,
            Some(below) => {
                let distance = speeds.minus(self.breakpoints[below]);
                first(&distance, h, Firing::Breakpoint(below, false))?
            }
        };
        let Some(&level) = self.breakpoints.get(self.piece) else {
            return Ok(low);
        };
        let h = low.map_or(h, |(time, _)| time);
        let distance = speeds.minus(level).scaled(-1.0);
        Ok(first(&distance, h, Firing::Breakpoint(self.piece, true))?.or(low))
    }
}

/// When a distance is 0 first.
fn first(
    distance: &PowerSeries,
    h: f64,
    firing: Firing,
) -> Result<Option<(f64, Firing)>, TooCurved> {
    let Some(watch) = Watch::new(distance) else {
        return Ok(None);
    };
    Ok(watch.first_zero(h)?.map(|time| (time, firing)))
}
