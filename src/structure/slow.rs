//! The slow motion of stiff bristles, or of any memory of one number.
//!
//! Where a contact slips far, its memory relaxes at a rate D = −∂z'/∂z far above the rates of the
//! masses, and an explicit step ends after about 10/D whatever happens there: the recurrence for
//! the coefficients z_k amplifies a deviation of z_0 by D^k/k!. The slow motion's own coefficients
//! are those that it does not amplify, its minimal solution: see `belt/slow.rs`, where friction
//! itself is stiff. Here the equation is read the other way round, order by order with those of
//! the masses, in passes that begin with z_k = 0 for k > 0:
//!
//! ```text
//! z_k ← z_k + [rate_k(z_0 … z_k) − (k + 1) z_{k+1}]/D,    z_{k+1} of the pass before
//! ```
//!
//! Each pass brings in one more term of the expansion in 1/D: at order k it leaves (k + 1)/(D·R) of
//! the error, R the radius of convergence. So five to ten passes do where explicit steps are short,
//! and they are quicker than Newton's method on all coefficients at once: no matrix, and masses,
//! other contacts and drives are expanded as always. The coefficient z_26 is taken to be 0.
//!
//! Measured: LuGre's bristles on a mass that slides over a belt, 8 units of time, σ0 from 1e3 to
//! 1e12: 20 to 26 steps; explicitly 1421 for 1e3, 142365 for 1e5, 1411886 for 1e6, and 4e-12 of
//! rounding errors there. Both methods agree within 1.1e-14 where explicit steps are still some
//! thousands.
//!
//! In near-stick it is another matter: there z and r swing together at √(Nσ0/m), until that is
//! damped. Both are followed explicitly, by about √(Nσ0/m)/10 steps per unit of time.

use super::engine::Engine;
use super::laws::Laws;
use super::parts::Joint;
use crate::friction::memory::{Motion, Slip};
use crate::motion::Mode;
use crate::motion::step_control::SETTLING;
use crate::series::{PowerSeries, TERMS};

/// Passes after which the slow motion is given up.
const MOST_PASSES: usize = 12;

/// Distance from the slow motion, and change in the last pass, in errors of a step, that count as
/// none.
const CLOSE: f64 = 8.0;

/// Part of the reach within which changes count.
const INNER: f64 = 0.8;

/// How many times further than the explicit step the slow one has to go to be worth its passes.
const WORTH: f64 = 10.0;

/// The same for one memory, where others may be next.
const LONGER: f64 = 1.5;

/// Most steps that are made before the slow motion is tried again.
const LONGEST_PAUSE: u32 = 256;

impl Engine<'_> {
    /// The series of the slow motion in place of the explicit ones, if a memory is stiff, the
    /// motion has come to the slow one, and it can be used further than `explicit`; the reach of
    /// whichever it is.
    pub(super) fn relax(&mut self, explicit: f64) -> f64 {
        // Several numbers of one contact may be stiff together.
        if self.model.laws.memory() != 1 {
            return explicit;
        }
        if self.steps_to_trial > 0 {
            self.steps_to_trial -= 1;
            return explicit;
        }
        let mut best = explicit;
        let mut is_tried = false;
        // Where the stiffest memories do not limit the step any more, the next ones may.
        while self.begins_to_relax(best) {
            is_tried = true;
            if let Some(slow) = self.slow_series(best) {
                best = slow;
                continue;
            }
            for joint in self.joints.iter_mut().filter(|joint| joint.relaxes_anew) {
                joint.relaxation = 0.0;
            }
            // The same as before.
            if self.joints.iter().any(|joint| joint.relaxation > 0.0) {
                best = self.slow_series(0.0).unwrap_or(explicit);
            }
            break;
        }
        if best >= WORTH * explicit {
            self.pause = 0;
        } else if is_tried {
            self.pause = (2 * self.pause).clamp(1, LONGEST_PAUSE);
            self.steps_to_trial = self.pause;
            for joint in &mut self.joints {
                joint.relaxation = 0.0;
            }
            // As it was, without a fault.
            let _ = self.expand();
            best = self.reach();
        }
        best
    }

    /// Begins to treat as slow the memories that relax well within `reach`, and marks which are
    /// new; whether there are any.
    fn begins_to_relax(&mut self, reach: f64) -> bool {
        let mut found = false;
        for (c, joint) in self.joints.iter_mut().enumerate() {
            joint.relaxes_anew = false;
            if let (0.0, Mode::Slip(direction)) = (joint.relaxation, joint.mode) {
                let slip = Slip {
                    speed: self.bodies[joint.body].speed,
                    direction: direction.sign(),
                    piece: joint.piece,
                };
                let rate = joint.relaxation_at(&*self.model.laws, c, slip, joint.memory[0]);
                if rate * reach > SETTLING {
                    (joint.relaxation, joint.relaxes_anew) = (rate, true);
                    found = true;
                }
            }
        }
        found
    }

    /// The series of the slow motion, and how far they reach: further than `shorter` by
    /// [`LONGER`].
    fn slow_series(&mut self, shorter: f64) -> Option<f64> {
        for joint in self.joints.iter_mut().filter(|j| j.relaxation > 0.0) {
            for (series, memory) in std::iter::zip(&mut joint.memories, &joint.memory) {
                *series = PowerSeries::ZERO;
                series[0] = *memory;
            }
        }
        self.expand().ok()?;
        let mut before = std::mem::take(&mut self.pass_before);
        let found = self.slow_passes(shorter, &mut before);
        self.pass_before = before;
        found
    }

    /// Passes until the series do not change any more.
    fn slow_passes(&mut self, shorter: f64, before: &mut Vec<PowerSeries>) -> Option<f64> {
        for _ in 1..MOST_PASSES {
            before.clear();
            before.extend(self.unknowns());
            self.expand().ok()?;
            let reach = self.reach();
            let may_have_come = std::iter::zip(self.slow_memories(), &before[self.bodies.len()..])
                .all(|((series, memory), before)| {
                    let moved = 4.0 * (series[0] - before[0]).abs();
                    (series[0] - memory).abs() <= moved + CLOSE * f64::EPSILON * memory.abs()
                });
            if !may_have_come || reach < LONGER * shorter {
                return None;
            }
            let errors = self.allowances.iter().map(|allowance| allowance.error);
            let memories = self.slow_memories();
            let errors = errors.chain(memories.map(|(z, _)| f64::EPSILON * z[0].abs()));
            let changes = std::iter::zip(self.unknowns(), &*before);
            let is_settled = changes.zip(errors).all(|((now, before), error)| {
                let mut power = 1.0;
                let mut change = 0.0;
                for k in 0..TERMS - 1 {
                    change += (now[k] - before[k]).abs() * power;
                    power *= INNER * reach;
                }
                change <= CLOSE * error
            });
            if is_settled {
                return Some(reach);
            }
        }
        None
    }

    /// What is sought: sliding speeds, and the memories that relax.
    fn unknowns(&self) -> impl Iterator<Item = &PowerSeries> {
        let speeds = self.bodies.iter().map(|body| &body.speeds);
        speeds.chain(self.slow_memories().map(|(series, _)| series))
    }

    /// The memories that relax, and what they are.
    fn slow_memories(&self) -> impl Iterator<Item = (&PowerSeries, f64)> {
        let joints = self.joints.iter().filter(|joint| joint.relaxation > 0.0);
        joints.flat_map(|joint| std::iter::zip(&joint.memories, joint.memory.iter().copied()))
    }
}

impl Joint {
    /// D at a memory, or 0 where it does not relax by itself.
    pub(super) fn relaxation_at(
        &self,
        laws: &dyn Laws,
        number: usize,
        slip: Slip<f64>,
        memory: f64,
    ) -> f64 {
        /// Of the memory: a difference so large loses half the digits, as many as are needed.
        const PART: f64 = 1.0 / (1 << 26) as f64;
        if memory == 0.0 {
            return 0.0;
        }
        let rate = |factor: f64| {
            let mut rate = 0.0;
            let take = &mut |_, now| rate = now;
            laws.rates(number, Motion::Slip(slip), &|_| memory * factor, take);
            rate
        };
        (rate(1.0) - rate(1.0 + PART)) / (PART * memory)
    }
}
