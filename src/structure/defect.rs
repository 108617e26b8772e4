//! Whether the series of a step hold between their coefficients: what is missing in the equations
//! of motion.

use super::engine::Engine;
use super::parts::Joint;
use crate::friction::memory::{ContactLaw, Motion, Slip};
use crate::motion::Mode;
use crate::motion::step_control::{Allowance, LONG, MOST_FOURS};
use crate::series::quarters;

impl<L: ContactLaw<Z>, const Z: usize> Engine<'_, L, Z> {
    /// Whether a step of length h leaves out no more than it may, at every contact that slips: at
    /// its quarters, about the places where the sliding speed is least, and, in a long step, at
    /// least every quarter of a radian. Coefficients alone miss what lies hidden behind an
    /// underflow, such as the flank of a narrow Gaussian.
    pub(super) fn defects_are_accepted(&self, h: f64) -> bool {
        let unit = self.unit;
        self.joints.iter().all(|joint| {
            let Mode::Slip(direction) = joint.mode else {
                return true;
            };
            let body = &self.bodies[joint.body()];
            let times = quarters(h);
            let speeds = body.speeds.at_four(times);
            let at_quarters = joint.defect(times, speeds);
            let mut at_minima = 0.0;
            body.speeds.about_minima(h, speeds, &mut |times| {
                at_minima += joint.defect(times, body.speeds.at_four(times));
            });
            let mut between = 0.0;
            if h > LONG * unit {
                let fours = (h / unit).ceil().min(MOST_FOURS);
                let part = 0.25 * h / fours;
                for i in 0..fours as usize {
                    let start = i as f64 * 4.0 * part;
                    let times = [0.5, 1.5, 2.5, 3.5].map(|place| start + place * part);
                    between += joint.defect(times, body.speeds.at_four(times));
                }
            }
            self.allowances[joint.body()].accepts([at_quarters, at_minima, between], h)
                && joint.memory_is_accepted(direction.sign(), speeds, h)
        })
    }
}

impl<L: ContactLaw<Z>, const Z: usize> Joint<'_, L, Z> {
    /// Largest N/m·|μ(s(t)) − μ(t)| at four times, where s(t) has the values `speeds`: the defect
    /// of the series, up to terms as small as its last.
    #[inline(always)]
    fn defect(&self, times: [f64; 4], speeds: [f64; 4]) -> f64 {
        let friction = self.friction.at_four(times);
        let mut largest = 0.0;
        for i in 0..4 {
            let Some(value) = self.coefficient_at(speeds[i], times[i]) else {
                continue;
            };
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

    /// σμ at a time of the step with this sliding speed, by the law itself; `None` unless it slips.
    #[inline(always)]
    pub(super) fn coefficient_at(&self, speed: f64, time: f64) -> Option<f64> {
        let Mode::Slip(direction) = self.mode else {
            return None;
        };
        let direction = direction.sign();
        let slip = Slip {
            speed: speed.max(0.0),
            direction,
            piece: self.piece,
        };
        let memory = std::array::from_fn(|j| self.memories[j].at(time));
        let law = self.contact.law();
        let coefficient = law.coefficient(slip, memory) * direction;
        Some(coefficient)
    }

    /// Whether a step of length h leaves out no more of what the contact remembers than it may, at
    /// its quarters.
    fn memory_is_accepted(&self, direction: f64, speeds: [f64; 4], h: f64) -> bool {
        std::iter::zip(quarters(h), speeds).all(|(time, speed)| {
            let memory = std::array::from_fn(|j| self.memories[j].at(time));
            let slip = Slip {
                speed: speed.max(0.0),
                direction,
                piece: self.piece,
            };
            let rates = self.contact.law().rates(Motion::Slip(slip), memory);
            std::iter::zip(&self.memories, rates).all(|(series, rate)| {
                let scale = series[0].abs().max(series[1].abs() * h);
                let missing = (series.derivative().at(time) - rate).abs();
                let largest = rate.abs().max(series[1].abs());
                // What is missing on a slow motion moves it aside by as much divided by D.
                let (largest, h) = if self.relaxation > 0.0 {
                    (self.relaxation * scale, self.relaxation.recip())
                } else {
                    (largest, h)
                };
                let allowance = Allowance::new(f64::EPSILON * scale, largest);
                allowance.accepts([missing; 3], h)
            })
        })
    }
}
