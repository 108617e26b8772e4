//! Sliding speeds that settle within the rounding of time.
//!
//! Where the sliding speed of a creeping contact is far from the balance of forces, at a reversal
//! or where a surface stops, its rate D may be so large that steps of 1/D are below the resolution
//! of the clock, or coefficients D^k overflow. What the speed does within that resolution h need
//! not be followed: it moves monotonically to the balance, and as
//!
//! ```text
//! s' = F(s),   F(s_0) = s_1,   F(s) = s_1 − N G [μ(s) − μ(s_0)] − c (s − s_0)
//! ```
//!
//! has a decreasing F, it passes the solution of s = s_0 + h F(s), the implicit Euler method,
//! before the time h. It has settled if it comes close to the balance in h/2 and e^{−Dh/2} is
//! rounding. Where F(0) is negative, slip turns back: at the time −s_0/F(0) at the latest.

use super::model::Model;
use super::plan::Plan;
use super::series::Series;
use super::state::{Phase, Situation};
use crate::friction::memory::{Motion, Slip};

/// Decay times after which a deviation is rounding: e^{−40} = 4e-18.
const SETTLED: f64 = 40.0;

/// Halvings of a range of logarithms of speeds to its rounding.
const HALVINGS: usize = 80;

/// Relative changes in the meantime that count as rounding.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The increment of a difference, relative to a speed: half the digits are enough.
const PART: f64 = 1.0 / (1 << 26) as f64;

/// The speed of contact c after the resolution of time, if nothing else in the motion changes by
/// more than rounding.
pub(super) fn speed_after(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    plan: &Plan,
    c: usize,
) -> Option<f64> {
    let (contact, state, of) = (
        &model.contacts[c],
        &situation.contacts[c],
        &series.contacts[c],
    );
    let Phase::Slip { speed, .. } = state.phase else {
        return None;
    };
    if !contact.law.creeps() || contact.is_elastic() {
        return None;
    }
    let (slip, memory) = (state.slip(speed)?, |j: usize| state.memory[j]);
    let at = |speed: f64| Slip { speed, ..slip };
    let friction = |s: f64| of.load[0] * (contact.law.coefficient(at(s), &memory) * slip.direction);
    // Beside friction that is as steep, the dampers of shared coordinates are rounding.
    let owner = model.owner_of(c);
    let damping = owner.map_or(0.0, |i| model.damping.row(i).0);
    let braking = friction(speed);
    let rate = |s: f64| of.speeds[1] - (friction(s) - braking) - damping * (s - speed);
    // The solution of s = s_0 + h F(s), or of F(s) = 0, by halving the range of ln s.
    let solution = |inverse: f64| {
        let is_below = |s: f64| rate(s) > (s - speed) * inverse;
        let far = speed.max(speed + of.speeds[1] * plan.unit);
        let [mut low, mut high] = [f64::MIN_POSITIVE, far];
        if !is_below(low) || is_below(high) {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = low.sqrt() * high.sqrt();
            if is_below(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        Some(high)
    };
    // The time within which the memory changes by no more than rounding at a speed.
    let load = of.load[0] / contact.compliance;
    let memory_lasts = |s: f64| {
        let mut time = f64::INFINITY;
        let take = &mut |j: usize, rate: f64| {
            let unit = contact.law.unit_in_creep(at(s), &memory, j).max(1.0);
            time = time.min(ROUNDING * unit / rate.abs());
        };
        contact.law.rates(Motion::Slip(at(s)), load, &memory, take);
        time
    };
    let resolution = f64::EPSILON * situation.clock.time.abs().max(plan.unit);
    let resolution = resolution.min(memory_lasts(speed));
    // D s, with the force a load carries by its direct effect.
    let direct = |s: f64| (rate(s * (1.0 - PART)) - rate(s * (1.0 + PART))) / (2.0 * PART);
    let (end, time) = if rate(0.0) < 0.0 {
        let longest = -speed / rate(0.0);
        (longest <= resolution).then_some((0.0, longest))?
    } else {
        let half = 0.5 * resolution;
        let there = solution(half.recip())?;
        let settles = |balance: &f64| {
            direct(*balance) * half > SETTLED * balance && (there / balance).ln().abs() < 1.0
        };
        let end = solution(0.0).filter(settles).unwrap_or(there);
        (end, resolution)
    };
    // The way is less than rounding in terms of the forces that change the speed.
    let fastest = speed.max(end);
    let force = direct(end).max(rate(end).abs());
    let is_still = fastest * time <= ROUNDING * force * plan.unit * plan.unit;
    (is_still && time <= memory_lasts(end) && end != speed).then_some(end)
}
