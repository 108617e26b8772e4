//! Whether the series of a step hold between their coefficients: what is missing in the equations
//! of motion.

use super::engine::Engine;
use super::parts::Joint;
use crate::friction::memory::{ContactLaw, Motion, Slip};
use crate::motion::Mode;
use crate::motion::step_control::{Allowance, LONG, MOST_FOURS};
use crate::series::{PowerSeries, quarters};

impl Engine<'_> {
    /// Whether a step of length h leaves out no more than it may, at every contact that slips: at
    /// its quarters, about the places where the sliding speed is least, and, in a long step, at
    /// least every quarter of a radian. Coefficients alone miss what lies hidden behind an
    /// underflow, such as the flank of a narrow Gaussian.
    pub(super) fn defects_are_accepted(&self, h: f64) -> bool {
        let unit = self.unit;
        self.joints.iter().enumerate().all(|(c, joint)| {
            let Mode::Slip(direction) = joint.mode else {
                return true;
            };
            let speeds = &self.bodies[joint.body].speeds;
            let defects = self.model.laws.defects(c, joint, speeds, h, unit);
            self.allowances[joint.body].accepts(defects, h)
                && self.memory_is_accepted(c, direction.sign(), h)
        })
    }

    /// Whether a step of length h leaves out no more of what a contact remembers than it may, at
    /// its quarters.
    fn memory_is_accepted(&self, c: usize, direction: f64, h: f64) -> bool {
        let joint = &self.joints[c];
        if joint.memories.is_empty() {
            return true;
        }
        let (times, speeds) = (quarters(h), &self.bodies[joint.body].speeds);
        std::iter::zip(times, speeds.at_some(times)).all(|(time, speed)| {
            let slip = Slip {
                speed: speed.max(0.0),
                direction,
                piece: joint.piece,
            };
            let mut accepted = true;
            let mut take = |j: usize, rate: f64| {
                let series = &joint.memories[j];
                let scale = series[0].abs().max(series[1].abs() * h);
                let missing = (series.derivative().at(time) - rate).abs();
                let largest = rate.abs().max(series[1].abs());
                // What is missing on a slow motion moves it aside by as much divided by D.
                let (largest, h) = if joint.relaxation > 0.0 {
                    (joint.relaxation * scale, joint.relaxation.recip())
                } else {
                    (largest, h)
                };
                let allowance = Allowance::new(f64::EPSILON * scale, largest);
                accepted &= allowance.accepts([missing; 3], h);
            };
            let memory = &|j: usize| joint.memories[j].at(time);
            self.model
                .laws
                .rates(c, Motion::Slip(slip), memory, &mut take);
            accepted
        })
    }
}

impl Joint {
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
        if h > LONG * unit {
            let fours = (h / unit).ceil().min(MOST_FOURS);
            let part = 0.25 * h / fours;
            for i in 0..fours as usize {
                let start = i as f64 * 4.0 * part;
                between += look([0.5, 1.5, 2.5, 3.5].map(|place| start + place * part));
            }
        }
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
