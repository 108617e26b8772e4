//! Sliding speeds that settle within the rounding of time.
//!
//! Where the sliding speed of a creeping contact is far from the balance of forces, at a reversal
//! or where a surface stops, its rate D may be so large that steps of 1/D are below the resolution
//! of the clock, or coefficients D^k overflow. What the speeds do within that resolution need not
//! be followed: they end as the implicit Euler method says. Where friction has become steep in
//! other directions, the search for its solution goes on along these.

use super::events::Firings;
use super::implicit::{ImplicitStep, Velocities};
use super::model::Model;
use super::modes_after::set_phase;
use super::plan::Plan;
use super::series::Series;
use super::state::{Firing, Situation};
use crate::series::PowerSeries;
use crate::state::Direction;

/// Choices of independent directions: those of steep friction.
const CHOICES: usize = 12;

/// A step of the length of the resolution of time, at most to a break of a drive: contacts in slip
/// get the speeds that they reach within it, if nothing else in the motion changes by more than
/// rounding. Its series are those speeds; one that turns back arrives at r = 0. Returns its length,
/// or `None` if no speed changes.
pub(super) fn leap(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &mut Series,
    plan: &Plan,
    to_break: f64,
    firings: &mut Firings,
) -> Option<f64> {
    let (step, ends, duration) = found(model, situation, series, plan, to_break)?;
    // By how much implicit changes differ from r' h.
    let rates = std::iter::zip(&ends.changes, &step.rates);
    let changes: Vec<f64> = rates
        .map(|(change, rate)| change - rate * duration)
        .collect();
    let ImplicitStep {
        directions, slips, ..
    } = step;
    let motions = series.coordinates.iter().map(|of| &of.motion);
    let accelerations: Vec<f64> = motions.map(|motion| motion.velocity(1)).collect();
    series.keep(1);
    for (i, acceleration) in accelerations.into_iter().enumerate() {
        let change = changes.iter().enumerate();
        let change = change.map(|(k, change)| change * directions.column(k)[i]);
        let motion = &mut series.coordinates[i].motion;
        motion.set_velocity(0, motion.velocity(0) + change.sum::<f64>());
        motion.set_velocity(1, acceleration);
    }
    *firings = Firings::default();
    firings.contacts.resize(model.contacts.len(), None);
    for slip in slips {
        let (c, end) = (slip.contact, slip.relative(&ends.relative));
        let before = situation.contacts[c].relative();
        let of = &mut series.contacts[c];
        if end == before {
            continue;
        }
        match Direction::of(end) {
            Some(direction) => {
                set_phase(model, situation, c, end);
                (of.side, of.speeds) = (direction.sign(), PowerSeries::of(end.abs()));
            }
            None => {
                of.speeds[1] = -of.speeds[0] / duration;
                firings.contacts[c] = Some((duration, Firing::Arrival));
            }
        }
    }
    Some(duration)
}

/// The contacts in slip, their velocities after the resolution of time, and that time.
fn found<'a, 's>(
    model: &'a Model<'s>,
    situation: &'a Situation,
    series: &'a Series,
    plan: &Plan,
    to_break: f64,
) -> Option<(ImplicitStep<'a, 's>, Velocities, f64)> {
    let start: Vec<f64> = situation.contacts.iter().map(|of| of.relative()).collect();
    let mut from = start.clone();
    let slopes = series.contacts.iter().map(|of| of.slope.abs());
    let mut slopes: Vec<f64> = slopes.collect();
    for _ in 0..CHOICES {
        let step = ImplicitStep::new(model, situation, series, &slopes)?;
        let ends = step.ends(plan, to_break, &from);
        let last = match &ends {
            Ok((ends, _)) => &ends.relative,
            Err(last) => last.as_ref()?,
        };
        for slip in &step.slips {
            from[slip.contact] = slip.relative(last);
        }
        // Friction that holds a contact at rest is no function of r.
        let stops = |c: usize| {
            let may_stick = situation.contacts[c].limits.is_some() && start[c] != 0.0;
            let arrives = match &ends {
                Ok(_) => from[c] * start[c] < 0.0,
                Err(_) => start[c].abs() <= plan.resolution * plan.sizes[c],
            };
            may_stick && arrives
        };
        let stop = step.slips.iter().map(|slip| slip.contact);
        let stop: Vec<usize> = stop.filter(|&c| stops(c)).collect();
        match ends {
            Ok((ends, duration)) if stop.is_empty() => {
                return Some((step, ends, duration));
            }
            Ok(_) => {}
            Err(_) => slopes = step.slopes(&from),
        }
        for c in stop {
            slopes[c] = f64::INFINITY;
        }
    }
    None
}
