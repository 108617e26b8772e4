//! The slow manifold of stiff bristles, or of any memory of one variable, and whether a motion has
//! reached it; that of contacts that are stiff in the sliding speed is computed in
//! `stiff_sliding_speeds.rs`.
//!
//! In sustained slip the memory of a contact relaxes at a rate D = −∂z'/∂z far above the rates of
//! the masses. The length of an explicit step is then about 10/D, even if the motion is slow,
//! because the recurrence for the coefficients z_k amplifies a deviation of z_0 by D^k/k!. The
//! coefficients of the slow manifold are the solution that is not amplified, the minimal solution
//! of the recurrence (see `belt/slow_manifold.rs`, where friction itself is stiff). Here the
//! recurrence is solved for z_k instead of z_{k+1}, order by order together with the equations of
//! the masses, in passes that begin with z_k = 0 for k > 0:
//!
//! ```text
//! z_k ← z_k + [rate_k(z_0 … z_k) − (k + 1) z_{k+1}]/D,    z_{k+1} of the pass before
//! ```
//!
//! Each pass adds one more term of the expansion in 1/D: at order k it multiplies the error by (k +
//! 1)/(D·R), where R is the radius of convergence. If explicit steps are short, five to ten passes
//! suffice. They are faster than Newton's method for all coefficients at once, because they need no
//! matrix, and because masses, other contacts and drives are expanded by the usual code. The
//! coefficient z_26 is taken to be 0.
//!
//! Measured for LuGre's bristles on a mass that slides over a belt, for 8 units of time: 20 to 26
//! steps for σ0 from 1e3 to 1e12. Explicit integration takes 1421 steps for 1e3, 142365 for 1e5,
//! and 1411886 for 1e6, with rounding errors of 4e-12. Both methods agree within 1.1e-14 for values
//! of σ0 with some thousands of explicit steps.
//!
//! Near stick z and r vibrate together at √(Nσ0/m) until the vibration has decayed. Both are
//! followed explicitly, by about √(Nσ0/m)/10 steps per unit of time.

use super::coordinate_series::ALL;
use super::expand::{expand, expand_slow};
use super::model::Model;
use super::series::Series;
use super::state::{Phase, Situation};
use super::step_size::{Control, LONGEST_STEP, Relaxing, SETTLED, plan_explicit, plan_reach};
use super::stiff_sliding_speeds::Stiff;
use crate::friction::memory::object::LawObject;
use crate::friction::memory::{Motion, Slip};
use crate::motion::step_control::{EXPLICIT, SETTLING};
use crate::series::{PowerSeries, TERMS};

/// Limit of passes.
pub(crate) const MOST_PASSES: usize = 12;

/// Distance from the slow manifold, and change in the last pass, in units of the error of a step,
/// that count as 0.
pub(crate) const CLOSE: f64 = 8.0;

/// Relative distance of a speed from the slow manifold at which it may still settle within the
/// resolution of time.
const NEAR: f64 = 0.5;

/// Part of the reach within which changes count.
pub(crate) const INNER: f64 = 0.8;

/// Least ratio of the reach of the slow series to the explicit one that is worth its passes.
const WORTH: f64 = 10.0;

/// Least such ratio for sliding speeds: explicit steps are 10/D long there, whatever the tolerance.
const WORTH_OF_SPEEDS: f64 = 3.0;

/// Least ratio for one group of memories, after which the next group is tried.
const LONGER: f64 = 1.5;

/// Sliding speeds whose rates D differ by less than this factor are tried together: one of them
/// alone would leave the step nearly as short as it is.
const ALIKE: f64 = 16.0;

/// Most steps before the slow manifold of memories is tried again.
const LONGEST_PAUSE: u32 = 256;

/// The series of the slow manifold in place of the explicit ones, if a memory or a sliding speed is
/// stiff, the motion has reached that manifold, and the series reach further than `explicit`.
/// Returns the reach of the series in use.
pub(super) fn relax(
    model: &Model<'_>,
    situation: &Situation,
    series: &mut Series,
    control: &mut Control,
    explicit: f64,
) -> f64 {
    let mut contacts = std::iter::zip(&series.contacts, &model.contacts);
    let has_memories =
        contacts.any(|(contact, data)| contact.memories.len() == 1 && !data.is_elastic());
    let waits = has_memories && control.steps_to_trial > 0;
    if waits {
        control.steps_to_trial -= 1;
    }
    let stiffest = control.plan.stiff.iter().copied().fold(0.0, f64::max);
    if stiffest == 0.0 && (waits || !has_memories) {
        control.errors_left.clear();
        return explicit;
    }
    let mut slow = Slow {
        model,
        situation,
        series,
        control,
        explicit,
        with_memories: !waits,
    };
    let trial = slow.trial();
    let worth = slow.worth();
    let settles = series.contacts.iter().any(|of| of.settling > 0.0);
    let relaxes = series.contacts.iter().any(|of| of.relaxation > 0.0);
    let is_taken = trial.best >= worth * explicit && (settles || relaxes);
    if trial.of_memories {
        control.pause = match is_taken && relaxes {
            true => 0,
            false => (2 * control.pause).clamp(1, LONGEST_PAUSE),
        };
        control.steps_to_trial = control.pause;
    }
    control.errors_left.clear();
    if is_taken {
        let errors = std::iter::zip(&series.contacts, &control.plan.contacts);
        let left = errors.map(|(of, allowance)| match of.settling {
            0.0 => 0.0,
            _ => allowance.error,
        });
        control.errors_left.extend(left);
        return trial.best;
    }
    if trial.of_memories || trial.of_speeds {
        series.forget_slow();
        // This is the expansion as it was before, so it has no fault.
        let _ = expand(model, situation, series, ALL);
        let (tolerance, plan) = (control.tolerance, &mut control.plan);
        plan_explicit(model, situation, series, tolerance, plan);
    }
    explicit
}

/// A trial of the slow manifold.
struct Slow<'a, 's> {
    model: &'a Model<'s>,
    situation: &'a Situation,
    series: &'a mut Series,
    control: &'a mut Control,
    /// The reach of the explicit series.
    explicit: f64,
    /// Whether memories may be slow.
    with_memories: bool,
}

/// What came of a trial.
#[derive(Default)]
struct Trial {
    /// The time up to which the series found can be used.
    best: f64,
    /// Whether memories, or sliding speeds, were tried.
    of_memories: bool,
    of_speeds: bool,
}

impl Slow<'_, '_> {
    /// Tries what relaxes well within the reach of the explicit series, then what relaxes within
    /// that of the slow ones.
    fn trial(&mut self) -> Trial {
        let mut trial = Trial {
            best: self.explicit,
            ..Trial::default()
        };
        // After the stiffest contacts, the next stiffest may limit the step.
        let mut begun = std::mem::take(&mut self.control.begun);
        loop {
            begun.clear();
            self.relaxing(trial.best, &mut |of| begun.push(of));
            if begun.is_empty() {
                break;
            }
            self.mark(&begun, |of| of.rate);
            trial.of_memories |= begun.iter().any(|of| !of.is_speed);
            trial.of_speeds |= begun.iter().any(|of| of.is_speed);
            if let Some(slow) = self.slow_series(trial.best) {
                trial.best = slow;
                continue;
            }
            self.mark(&begun, |_| 0.0);
            // The same as before.
            let mut contacts = self.series.contacts.iter();
            if contacts.any(|of| of.relaxation > 0.0 || of.settling > 0.0) {
                trial.best = self.slow_series(0.0).unwrap_or(self.explicit);
            }
            break;
        }
        self.control.begun = begun;
        trial
    }

    /// The rates of what is slow from now on.
    fn mark(&mut self, all: &[Relaxing], rate: impl Fn(&Relaxing) -> f64) {
        for of in all {
            let contact = &mut self.series.contacts[of.contact];
            let slow = if of.is_speed {
                &mut contact.settling
            } else {
                &mut contact.relaxation
            };
            *slow = rate(of);
        }
    }

    /// Visits the speeds and the memories that relax well within `reach` and are not slow yet.
    fn relaxing(&self, reach: f64, visit: &mut dyn FnMut(Relaxing)) {
        let plan = &self.control.plan;
        let waiting = std::iter::zip(&self.series.contacts, &plan.stiff);
        let waiting = waiting.filter(|(contact, _)| contact.settling == 0.0);
        let stiffest = waiting.fold(0.0, |most, (_, &rate)| f64::max(most, rate));
        // Of a few orders only the reach is shorter.
        let reach = match plan.dropped {
            0 => reach,
            _ => (ALIKE * reach).max(EXPLICIT / stiffest),
        };
        let slowest = if stiffest * reach > SETTLING {
            stiffest / ALIKE
        } else {
            f64::INFINITY
        };
        // Contacts on one mass settle at the sum of their rates.
        let shared = self.model.shared.iter().map(|&c| plan.stiff[c]);
        let shared: Vec<f64> = shared.filter(|&rate| rate > 0.0).collect();
        let together = |c: usize| {
            let own = plan.stiff[c];
            let others = shared.iter().filter(|&&rate| rate < ALIKE * own);
            match self.model.is_shared(c) {
                true => others.sum(),
                false => own,
            }
        };
        for (c, contact) in self.series.contacts.iter().enumerate() {
            // Several variables of one contact may be stiff together.
            let state = &self.situation.contacts[c];
            let Phase::Slip { speed, rate, .. } = state.phase else {
                continue;
            };
            if self.model.contacts[c].is_elastic() {
                continue;
            }
            let settling = plan.stiff[c];
            let begins = settling > slowest || together(c) * reach > SETTLING;
            if begins && contact.settling == 0.0 && rate.is_none() {
                visit(Relaxing {
                    contact: c,
                    is_speed: true,
                    rate: settling,
                });
            }
            if let (true, [memory], Some(slip), 0.0) = (
                self.with_memories,
                &state.memory[..],
                state.slip(speed),
                contact.relaxation,
            ) {
                let data = &self.model.contacts[c];
                let load = contact.load[0] / data.compliance;
                let rate = relaxation(data.law, (slip, load), *memory);
                if rate * reach > SETTLING {
                    visit(Relaxing {
                        contact: c,
                        is_speed: false,
                        rate,
                    });
                }
            }
        }
    }

    /// The series of the slow manifold, and how far they reach: further than `shorter` by
    /// [`LONGER`]. `None` also if they are not worth taking.
    fn slow_series(&mut self, shorter: f64) -> Option<f64> {
        let contacts = std::iter::zip(&mut self.series.contacts, &self.situation.contacts);
        for (contact, state) in contacts.filter(|(contact, _)| contact.relaxation > 0.0) {
            contact.hold_memory(&state.memory);
        }
        if self.slow_speeds().next().is_some() {
            self.control.stiff = Stiff::of(self.model, self.situation, self.series);
            self.control.plan.slaved = self.control.stiff.slaved(self.model);
        } else {
            self.control.stiff = Stiff::default();
        }
        self.expand()?;
        let mut before = std::mem::take(&mut self.control.pass_before);
        let found = self.passes(shorter, &mut before);
        self.control.pass_before = before;
        found
    }

    fn expand(&mut self) -> Option<()> {
        let stiff = &mut self.control.stiff;
        if !stiff.is_active() {
            self.control.plan.dropped = 0;
            return expand(self.model, self.situation, self.series, ALL).ok();
        }
        expand_slow(self.model, self.situation, self.series, stiff).then_some(())?;
        // The series of other stiff contacts, which have not settled, may overflow.
        self.control.plan.dropped = self.series.truncate();
        stiff.end_pass(self.series);
        Some(())
    }

    /// The least ratio of the reach to the explicit one at which the series are taken.
    fn worth(&self) -> f64 {
        match self.slow_speeds().next() {
            Some(_) => WORTH_OF_SPEEDS,
            None => WORTH,
        }
    }

    /// Passes until the series do not change any more.
    fn passes(&mut self, shorter: f64, before: &mut Vec<PowerSeries>) -> Option<f64> {
        for pass in 1..MOST_PASSES {
            before.clear();
            before.extend(self.unknowns().map(|(series, _)| series));
            self.expand()?;
            let Control {
                tolerance, plan, ..
            } = &mut *self.control;
            let tolerance = *tolerance;
            let reach = plan_reach(self.model, self.situation, self.series, tolerance, plan);
            let others = self.model.len() + self.slow_speeds().count();
            let slow = std::iter::zip(self.slow_memories(), &before[others..]);
            let mut may_have_come = slow.into_iter().all(|((series, memory), before)| {
                let moved = 4.0 * (series[0] - before[0]).abs();
                (series[0] - memory).abs() <= moved + CLOSE * tolerance * memory.abs()
            });
            let slow = std::iter::zip(self.slow_speeds(), &before[self.model.len()..]);
            for (c, before) in slow {
                let (series, state) = (&self.series.contacts[c], &self.situation.contacts[c]);
                let now = series.speeds[0];
                let left = self.control.errors_left.get(c).copied().unwrap_or(0.0);
                let mut error = CLOSE * self.control.plan.contacts[c].error.max(left);
                if series.settling * self.control.plan.resolution > SETTLED {
                    error = error.max(NEAR * state.speed());
                }
                let moved = 4.0 * (now - before[0]).abs();
                let [missing, missed] = self.control.stiff.missing(c);
                let moved = moved + 4.0 * (missing - missed).abs();
                may_have_come &= (now - state.speed()).abs() + missing <= moved + error;
            }
            if !may_have_come || reach < LONGER * shorter {
                return None;
            }
            // The reach hardly changes after the first passes, the last digits need ten.
            if reach < self.worth() * self.explicit {
                let mut is_vain = true;
                self.relaxing(reach, &mut |_| is_vain = false);
                if is_vain {
                    return None;
                }
            }
            let settles_within = |reach: f64| {
                let mut changes = std::iter::zip(self.unknowns(), &*before);
                changes.all(|((now, error), before)| {
                    let mut power = 1.0;
                    let mut change = 0.0;
                    for k in 0..TERMS - 1 {
                        change += (now[k] - before[k]).abs() * power;
                        power *= INNER * reach.min(LONGEST_STEP);
                    }
                    change <= CLOSE * error
                })
            };
            if settles_within(reach) {
                return self.is_on_pieces().then_some(reach);
            }
            // Rounding errors of the coefficients change in every pass. They limit the reach.
            if pass + 1 == MOST_PASSES {
                let shorter = LONGER * shorter;
                let reaches = (1..=10).map(|k| reach * 0.5_f64.powi(k));
                let mut reaches = reaches.take_while(|&reach| reach >= shorter);
                let found = reaches.find(|&reach| settles_within(reach))?;
                return self.is_on_pieces().then_some(found);
            }
        }
        None
    }

    /// Returns true if all sliding speeds are on the pieces of their laws that hold.
    fn is_on_pieces(&self) -> bool {
        let mut contacts = 0..self.model.contacts.len();
        contacts.all(|c| {
            let Phase::Slip { speed, piece, .. } = self.situation.contacts[c].phase else {
                return true;
            };
            let (now, breakpoints) = (
                self.series.contacts[c].speeds[0],
                &self.model.contacts[c].breakpoints,
            );
            let low = piece.checked_sub(1).map_or(0.0, |below| breakpoints[below]);
            let high = breakpoints.get(piece).copied().unwrap_or(f64::INFINITY);
            now == speed || low < now && now < high
        })
    }

    /// The unknowns, each with the error allowed: velocities of coordinates, or their sliding
    /// speeds, then the sliding speeds that settle and the memories that relax.
    fn unknowns(&self) -> impl Iterator<Item = (PowerSeries, f64)> {
        let velocities = (0..self.model.len()).map(|i| {
            let owner = self.model.owner[i];
            let slipping =
                owner.filter(|&c| matches!(self.situation.contacts[c].phase, Phase::Slip { .. }));
            let series = match slipping {
                Some(c) => self.series.contacts[c].speeds,
                None => self.series.velocities(i),
            };
            // Known only after the first plan.
            let plan = &self.control.plan;
            let error = match plan.slaved.get(i) {
                // It follows from the speeds.
                Some(true) => f64::INFINITY,
                _ => plan.coordinates.get(i).map_or(0.0, |of| of.error),
            };
            (series, error)
        });
        let (memories, tolerance) = (self.slow_memories(), self.control.tolerance);
        let speeds = self.slow_speeds().map(|c| {
            let allowance = self.control.plan.contacts.get(c);
            let error = allowance.map_or(0.0, |allowance| allowance.error);
            (self.series.contacts[c].speeds, error)
        });
        let memories = memories.map(move |(z, _)| (*z, tolerance * z[0].abs()));
        velocities.chain(speeds).chain(memories)
    }

    /// The contacts whose sliding speeds settle.
    fn slow_speeds(&self) -> impl Iterator<Item = usize> {
        let contacts = self.series.contacts.iter().enumerate();
        contacts.filter_map(|(c, of)| (of.settling > 0.0).then_some(c))
    }

    /// The memories that relax, and their values at the start of the step.
    fn slow_memories(&self) -> impl Iterator<Item = (&PowerSeries, f64)> {
        let contacts = std::iter::zip(&self.series.contacts, &self.situation.contacts);
        let slow = contacts.filter(|(contact, _)| contact.relaxation > 0.0);
        slow.flat_map(|(contact, state)| {
            std::iter::zip(&contact.memories, state.memory.iter().copied())
        })
    }
}

/// D at a memory of one variable under a load, or 0 where it does not relax by itself.
pub(super) fn relaxation(law: &dyn LawObject, (slip, load): (Slip<f64>, f64), memory: f64) -> f64 {
    /// The increment relative to the memory: the difference has half the digits, which is enough.
    const PART: f64 = 1.0 / (1 << 26) as f64;
    if memory == 0.0 {
        return 0.0;
    }
    let rate = |factor: f64| {
        let mut rate = 0.0;
        let take = &mut |_, now| rate = now;
        law.rates(Motion::Slip(slip), load, &|_| memory * factor, take);
        rate
    };
    (rate(1.0) - rate(1.0 + PART)) / (PART * memory)
}
