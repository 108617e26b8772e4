//! Whether the series of a step hold between their coefficients: what is missing in the equations
//! of motion.

use super::engine::Engine;
use super::parts::Joint;
use crate::friction::memory::{ContactLaw, Motion, Slip};
use crate::motion::Mode;
use crate::motion::step_control::{Allowance, LONG, MOST_FOURS};
use crate::series::{PowerSeries, quarters};

/// Ratio of the distances from the place where a contact is slowest at which it is looked at.
///
/// A law that changes about some slow speed has still the values of rest at a quarter of it, or,
/// where the speed falls like the square of the distance, at a sixteenth.
const NEARER: f64 = 0.25;

/// The first of these distances, in parts of the step.
const FIRST: f64 = 0.0625;

impl Engine<'_> {
    /// Whether a step of length h leaves out no more than it may, at every contact that slips: at
    /// its quarters, about the places where the sliding speed is least, and, in a long step, at
    /// least every quarter of a radian. Coefficients alone miss what lies hidden behind an
    /// underflow, such as the flank of a narrow Gaussian.
    pub(super) fn defects_are_accepted(&self, h: f64) -> bool {
        let unit = self.unit;
        self.joints.iter().enumerate().all(|(c, joint)| {
            if let Mode::Slip(_) = joint.mode {
                let speeds = &self.bodies[joint.body].speeds;
                let defects = self.model.laws.defects(c, joint, speeds, h, unit);
                if !self.allowances[joint.body].accepts(defects, h) {
                    return false;
                }
            }
            joint.memories.is_empty() || joint.mode == Mode::Open || self.memory_is_accepted(c, h)
        })
    }

    /// Whether a step of length h leaves out no more of what a contact remembers than it may, in
    /// the same places, and in slip in others that close in on those where it is slowest.
    fn memory_is_accepted(&self, c: usize, h: f64) -> bool {
        let joint = &self.joints[c];
        let holds = |times| self.memory_holds(c, times, [h; 4], h);
        let mut accepted = holds(quarters(h));
        in_between(h, self.unit, &mut |times| {
            accepted = accepted && holds(times);
        });
        if let (true, Mode::Slip(_)) = (accepted, joint.mode) {
            let speeds = &self.bodies[joint.body].speeds;
            let at_quarters = speeds.at_some(quarters(h));
            speeds.about_minima(h, at_quarters, &mut |times| {
                accepted = accepted && holds(times) && self.holds_towards(c, times[1], h);
            });
            if at_quarters[3] < 0.5 * at_quarters[2] {
                accepted = accepted && self.holds_towards(c, h, h);
            }
        }
        accepted
    }

    /// Whether the series of a contact that slips hold closer and closer to a place where it is
    /// slowest.
    ///
    /// What a contact remembers mostly changes in proportion to the sliding speed. So the very
    /// place where that is 0 shows nothing of what the law does at slow speeds, nor does a place
    /// where it is far above them; what is missed in between stays in the memory.
    fn holds_towards(&self, c: usize, slowest: f64, h: f64) -> bool {
        let joint = &self.joints[c];
        let speeds = &self.bodies[joint.body].speeds;
        let least = speeds.at(slowest);
        let (sides, ratio) = if slowest < h {
            ([-1.0, 1.0, -NEARER, NEARER], NEARER.powi(2))
        } else {
            ([0, 1, 2, 3].map(|k| -NEARER.powi(k)), NEARER.powi(4))
        };
        let mut distance = FIRST * h;
        while distance > f64::EPSILON * h {
            let times = sides.map(|side| (slowest + side * distance).clamp(0.0, h));
            let lasting = sides.map(|side: f64| side.abs() * distance / NEARER);
            if !(self.memory_holds(c, times, lasting, h) && self.friction_holds(c, times, lasting))
            {
                return false;
            }
            // Nearer, it is as fast, or there is no time left to miss anything in.
            let is_as_fast = speeds.at(times[3]) <= 2.0 * least;
            if is_as_fast || !self.counts(c, slowest, times[3], lasting[3], h) {
                return true;
            }
            distance *= ratio;
        }
        true
    }

    /// Whether the series of what a contact remembers, and of the limit of its stick band, leave
    /// out no more than they may at four times of a step of length h, each of which stands for
    /// what lasts so long.
    fn memory_holds(&self, c: usize, times: [f64; 4], lasting: [f64; 4], h: f64) -> bool {
        let (joint, laws) = (&self.joints[c], &*self.model.laws);
        let motions = joint.motions_at(&self.bodies[joint.body].speeds, times);
        let mut accepted = true;
        if joint.mode == Mode::Stick {
            let scale = joint.bound[0].abs().max(self.scales[joint.body].1);
            let allowance = Allowance::new(f64::EPSILON * scale, scale);
            let (loads, bounds) = (joint.loads_at(times), joint.bound.at_some(times));
            for i in 0..4 {
                let limit = laws.limit(c, &|j| joint.memories[j].at(times[i]));
                let missing = limit.map_or(0.0, |limit| (limit * loads[i] - bounds[i]).abs());
                accepted &= allowance.accepts([missing; 3], 1.0);
            }
        }
        for i in 0..4 {
            let memory = &|j: usize| joint.memories[j].at(times[i]);
            // What is missing on a slow motion moves it aside by as much divided by D.
            let relaxation = match motions[i] {
                Motion::Slip(slip) if joint.relaxation > 0.0 => {
                    joint.relaxation_at(laws, c, slip, memory(0)).max(0.0)
                }
                _ => 0.0,
            };
            let lasting = lasting[i].min(relaxation.recip());
            let mut take = |j: usize, rate: f64| {
                let series = &joint.memories[j];
                let scale = joint.memory_scale(j, h);
                let largest = rate.abs().max(series[1].abs()).max(relaxation * scale);
                let missing = (series.slope_at(times[i]) - rate).abs();
                let allowance = Allowance::new(f64::EPSILON * scale, largest);
                accepted &= allowance.accepts([missing; 3], lasting);
            };
            laws.rates(c, motions[i], memory, &mut take);
        }
        accepted
    }

    /// The same of the series of its friction in slip.
    fn friction_holds(&self, c: usize, times: [f64; 4], lasting: [f64; 4]) -> bool {
        let joint = &self.joints[c];
        let motions = joint.motions_at(&self.bodies[joint.body].speeds, times);
        let (loads, friction) = (joint.loads_at(times), joint.friction.at_some(times));
        (0..4).all(|i| {
            let Motion::Slip(slip) = motions[i] else {
                return true;
            };
            let memory = &|j: usize| joint.memories[j].at(times[i]);
            let value = self.model.laws.coefficient(c, slip, memory) * slip.direction;
            let missing = (loads[i] * (value - friction[i])).abs();
            self.allowances[joint.body].accepts([missing; 3], lasting[i])
        })
    }

    /// Whether more could be missing than may be from a time on towards the place where a contact
    /// is slowest, if all is missing that depends on its speed.
    ///
    /// Where a memory has come to rest its rate is 0 at any speed; with twice the memory it is not.
    fn counts(&self, c: usize, slowest: f64, time: f64, lasting: f64, h: f64) -> bool {
        let (joint, laws) = (&self.joints[c], &*self.model.laws);
        let times = [time, slowest, slowest, slowest];
        let motions = joint.motions_at(&self.bodies[joint.body].speeds, times);
        let [Motion::Slip(here), Motion::Slip(there), ..] = motions else {
            return false;
        };
        let mut counts = false;
        for factor in [1.0, 2.0] {
            let memory = &|j: usize| factor * joint.memories[j].at(time);
            laws.rates(c, Motion::Slip(here), memory, &mut |j, rate| {
                let allowance = Allowance::new(f64::EPSILON * joint.memory_scale(j, h), 0.0);
                let all = rate.abs() + joint.memories[j].slope_at(time).abs();
                counts |= !allowance.accepts([all; 3], lasting);
            });
            let [value, at_slowest] = [here, there].map(|slip| laws.coefficient(c, slip, memory));
            let all = joint.load.at(time) * (value - at_slowest);
            counts |= !self.allowances[joint.body].accepts([all.abs(); 3], lasting);
        }
        counts
    }
}

/// Calls `look` with places in a step that is longer than a unit of time, four at a time, at least
/// every quarter of that unit.
fn in_between(h: f64, unit: f64, look: &mut dyn FnMut([f64; 4])) {
    if h > LONG * unit {
        let fours = (h / unit).ceil().min(MOST_FOURS);
        let part = 0.25 * h / fours;
        for i in 0..fours as usize {
            let start = i as f64 * 4.0 * part;
            look([0.5, 1.5, 2.5, 3.5].map(|place| start + place * part));
        }
    }
}

impl Joint {
    /// What it does at four times of the step.
    fn motions_at(&self, speeds: &PowerSeries, times: [f64; 4]) -> [Motion<f64>; 4] {
        match self.mode {
            Mode::Slip(direction) => speeds.at_some(times).map(|speed| {
                Motion::Slip(Slip {
                    speed: speed.max(0.0),
                    direction: direction.sign(),
                    piece: self.piece,
                })
            }),
            Mode::Stick | Mode::Open => [Motion::Stick; 4],
        }
    }

    /// N/m at four times of the step.
    fn loads_at(&self, times: [f64; 4]) -> [f64; 4] {
        if self.load_varies {
            self.load.at_some(times)
        } else {
            [self.load[0]; 4]
        }
    }

    /// What errors of a number of the memory are measured by, in a step of length h.
    fn memory_scale(&self, j: usize, h: f64) -> f64 {
        let series = &self.memories[j];
        series[0].abs().max(series[1].abs() * h)
    }

    /// The defects of a step of length h with these sliding speeds: at its quarters, about the
    /// places where the speed is least, and between them in a long step.
    #[inline(always)]
    pub(super) fn defects<L: ContactLaw<Z>, const Z: usize>(
        &self,
        law: &L,
        speeds: &PowerSeries,
        h: f64,
        unit: f64,
    ) -> [f64; 3] {
        let times = quarters(h);
        let at_times = speeds.at_four(times);
        let at_quarters = self.defect(law, times, at_times);
        // Compiled once for the other two.
        let look: &dyn Fn([f64; 4]) -> f64 =
            &|times| self.defect(law, times, speeds.at_four(times));
        let mut at_minima = 0.0;
        speeds.about_minima(h, at_times, &mut |times| at_minima += look(times));
        let mut between = 0.0;
        in_between(h, unit, &mut |times| between += look(times));
        [at_quarters, at_minima, between]
    }

    /// Largest N/m·|μ(s(t)) − μ(t)| at four times, where s(t) has the values `speeds`: the defect
    /// of the series, up to terms as small as its last.
    #[inline(always)]
    fn defect<L: ContactLaw<Z>, const Z: usize>(
        &self,
        law: &L,
        times: [f64; 4],
        speeds: [f64; 4],
    ) -> f64 {
        let Mode::Slip(direction) = self.mode else {
            return 0.0;
        };
        let direction = direction.sign();
        let friction = self.friction.at_four(times);
        let mut largest = 0.0;
        for i in 0..4 {
            let slip = Slip {
                speed: speeds[i].max(0.0),
                direction,
                piece: self.piece,
            };
            let memory = std::array::from_fn(|j| self.memories[j].at(times[i]));
            let value = law.coefficient(slip, memory) * direction;
            let mut difference = (value - friction[i]).abs();
            if self.load_varies {
                difference *= self.load.at(times[i]).abs();
            }
            // Not f64::max, which would drop a NaN.
            largest = if largest >= difference {
                largest
            } else {
                difference + 0.0 * largest
            };
        }
        if self.load_varies {
            largest
        } else {
            self.load[0].abs() * largest
        }
    }
}
