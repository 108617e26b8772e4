//! Runs of a motion over a period, with its derivative.

use nalgebra::{DMatrix, DVector};

use super::super::flow_direction::{Along, Derivative};
use super::super::prescribed_modes::Hold;
use super::super::tangent::{TangentFlow, flow_at, flow_of};
use super::super::time_integration::modes_after;
use super::super::translation::translations;
use super::super::type_erased_system::GeneralForm;
use super::super::unslipped::{never_slips, slip_by_rounding, unslipped};
use super::{PeriodMap, longest_pause, state, vector};
use crate::clock::Clock;
use crate::error::Error;
use crate::friction::memory::Slip;
use crate::motion::{Integrator, Mode, Segment};
use crate::state::structure::State;
use crate::structure::Step;

impl GeneralForm<'_> {
    /// The motion from a state at time 0 over a duration, with its derivative with respect to that
    /// state.
    pub fn period_map(&self, start: &State, duration: f64) -> Result<PeriodMap, Error> {
        period_map(self, 0.0, start, duration)
    }
}

/// The period map over a duration from a state at a time.
pub(in crate::orbit) fn period_map(
    form: &GeneralForm<'_>,
    time: f64,
    start: &State,
    duration: f64,
) -> Result<PeriodMap, Error> {
    held_period_map(form, (time, start), duration, &[])
}

/// Computes [`period_map`] with contacts held past touches.
pub(in crate::orbit) fn held_period_map(
    form: &GeneralForm<'_>,
    (time, start): (f64, &State),
    duration: f64,
    holds: &[Hold],
) -> Result<PeriodMap, Error> {
    let (n, order) = (form.len(), form.order());
    let settings = Integrator::new().with_max_steps(form.most_of_a_period())?;
    let end_time = time + duration;
    let identity = DMatrix::identity(order, order);
    let mut flow = TangentFlow::new(form, settings, (time, start), holds, identity)?;
    let mut steps: Vec<Step> = Vec::new();
    let (mut is_first, mut first_flow) = (true, None);
    // The derivative from the start to the cut, after which `flow.tangents` begin again, and the
    // flow at the cut.
    let mut head = (Derivative::identity(order), None);
    let mut along = Along::new(order);
    // Speeds of contacts that stick do not span many decades.
    let creeps = form.model.creeping.len() == form.contacts();
    let is_kept_apart = creeps && form.is_free() && holds.is_empty();
    let mut held = Vec::new();
    let mut dead = 0;
    let (mut modes, mut sticking) = (Vec::new(), Vec::new());
    while steps.last().is_none_or(|step| step.end_time() < end_time) {
        let Some(step) = flow.fetch(end_time) else {
            break;
        };
        let step = step?;
        // Within a phase nothing vanishes.
        if step.duration() > 0.0 && flow.is_finished() {
            // Where a contact creeps, a start whose speed is off by a rounding flows back at the
            // rate D. At the end it has settled, and a closed motion has the same flow there.
            let is_settled = !is_first || form.model.creeping.is_empty();
            let rates = is_settled.then(|| flow_of(&step, n));
            if let Some(rates) = rates.as_ref().filter(|_| is_kept_apart) {
                along.take(&mut flow.tangents, rates, step.state());
            }
            let rows = dead_rows(&flow.tangents);
            if step.modes() != &modes[..] {
                modes = step.modes().to_vec();
                sticking = held_by(form, &modes);
            }
            let dead_alone = |&(row, dead): &(usize, &bool)| *dead && !form.is_held(row);
            let now = rows.iter().enumerate().filter(dead_alone).count()
                + sticking.len()
                + forgetting(form, step.modes());
            if is_first || now > dead {
                let alive = rows.iter().map(|dead| f64::from(u8::from(!dead)));
                let alive = DMatrix::from_diagonal(&DVector::from_iterator(order, alive));
                let since = along.end(flow.replace(alive));
                head = (head.0.then(&since), rates.clone());
                (dead, held) = (now, sticking.clone());
            }
            if is_first {
                (is_first, first_flow) = (false, rates);
            }
        }
        flow.carry(&step)?;
        steps.push(step);
    }
    flow.finish()?;
    let Some(last) = steps.last() else {
        return Err(Error::InvalidDuration { value: duration });
    };
    let end = limited_end(form, last);
    let last_flow = flow_at(last, last.duration(), last.end_state().velocities);
    let (head, cut_flow) = head;
    let tail = along.end(flow.tangents.clone());
    let mut monodromy = head.then(&tail).with_flow(&last_flow);
    // Without what is along the flow at the cut, which no multiplier needs.
    let mut cycle = head.across * tail.across;
    let mut depends = flow.depends.clone();
    // The clock of a contact that never slips runs on, and only its limit follows.
    for c in (0..form.contacts()).filter(|&c| form.holds(c) && never_slips(&steps)(c)) {
        depends[form.model.memory(c)].fill(false);
    }
    for (j, depends) in depends.iter().enumerate() {
        if !depends {
            cycle.row_mut(2 * n + j).fill(0.0);
            cycle.column_mut(2 * n + j).fill(0.0);
        }
    }
    let end_modes = modes_after(last, || flow.fetch(f64::INFINITY))?;
    let translations = translations(form, never_slips(&steps));
    let [from, to] = [start, &end].map(|state| vector(state, order));
    let mut moved = &to - &from;
    let settled = |flow: Option<DVector<f64>>| flow.unwrap_or_else(|| last_flow.clone());
    let mut cut_flow = settled(cut_flow);
    let mut flows = [settled(first_flow), last_flow];
    for translation in &translations {
        translation.remove_from(moved.as_mut_slice());
        for flow in flows.iter_mut().chain([&mut cut_flow]) {
            translation.remove_from(flow.as_mut_slice());
        }
        if !translation.is_held {
            translation.remove_from_columns(&mut monodromy);
            translation.remove_from_columns(&mut cycle);
        }
    }
    let (translation, end) = if translations.is_empty() {
        (DVector::zeros(n), end)
    } else {
        let back = from + moved;
        ((to - &back).rows(0, n).into_owned(), state(&back, n))
    };
    let unslipped = unslipped(form, &steps, [start, &end]);
    let slip_by_rounding = slip_by_rounding(form, &steps, &translation);
    Ok(PeriodMap {
        translations,
        translation,
        slip_by_rounding,
        boosts: form.freedom().velocities.clone(),
        touching: (0..form.contacts())
            .filter(|&c| form.may_touch(c))
            .collect(),
        unslipped,
        touches: flow.touches().to_vec(),
        holds: holds.to_vec(),
        is_friction_even: is_friction_even(form, &steps),
        start: start.clone(),
        end_modes,
        monodromy,
        flow: flows,
        depends,
        memory_units: form.memory_units(),
        cycle: (cycle, cut_flow),
        held,
        end,
        steps,
    })
}

/// Returns true if the limits of stick and the friction of slip are the same in both directions, at
/// the starts of all steps. Laws with memory are not asked: their memory has directions, too.
fn is_friction_even(form: &GeneralForm<'_>, steps: &[Step]) -> bool {
    const ROUNDING: f64 = 1e-12;
    let is_same = |[a, b]: [f64; 2]| (a - b).abs() <= ROUNDING * a.abs().max(b.abs());
    let mut contacts = form.model.contacts.iter();
    contacts.all(|contact| {
        let [backward, forward] = [-1.0, 1.0].map(|direction| contact.law.dry_slip(direction));
        let is_one_law =
            matches!((backward, forward), (Some(a), Some(b)) if std::ptr::addr_eq(a, b));
        if is_one_law || contact.is_elastic() || !contact.memory.is_empty() {
            return true;
        }
        contact.law.limits(&|_| 0.0).is_none_or(is_same)
            && steps.iter().all(|step| {
                let (time, velocities) = (step.start_time(), &step.state().velocities);
                let surface = contact.belt_velocity.at(Clock::at(time));
                let relative = contact.sliding_velocity(|j| velocities[j], surface, time);
                let speed = relative.abs();
                let piece = contact.piece_above(speed);
                is_same([-1.0, 1.0].map(|direction| {
                    let slip = Slip {
                        speed,
                        direction,
                        piece,
                    };
                    direction * contact.law.coefficient(slip, &|_| 0.0)
                }))
            })
    })
}

/// The period map of the same closed motion with another start, if the start is so near to an event
/// that rounding decides on which side of the event the end lies; otherwise `None`.
pub(in crate::orbit) fn begun_apart(
    form: &GeneralForm<'_>,
    map: &PeriodMap,
    period: f64,
) -> Result<Option<PeriodMap>, Error> {
    /// Part of the period within which an event is near.
    const NEAR: f64 = 1e-6;
    let events = map.steps.iter().flat_map(Segment::events);
    let mut times = events.map(|event| event.time);
    let near = NEAR * period..(1.0 - NEAR) * period;
    let is_near = |time: f64| !near.contains(&(time - map.begins()));
    if !times.any(is_near) && map.first_modes() == Some(&map.end_modes[..]) {
        return Ok(None);
    }
    let time = longest_pause(map, map.begins(), map.begins() + period);
    let step = map.steps.iter().find(|step| step.end_time() > time);
    let Some(step) = step else {
        return Ok(None);
    };
    let mut state = step.state_at(step.since_start(time));
    form.put_in_modes(&mut state, time, &|c| Some(step.modes()[c]));
    let holds = map.holds_later(time - map.begins(), period);
    held_period_map(form, (time, &state), period, &holds).map(Some)
}

/// Perturbations of the start of a motion, carried on to a time.
pub(in crate::orbit) fn carried(
    form: &GeneralForm<'_>,
    map: &PeriodMap,
    tangents: DMatrix<f64>,
    time: f64,
) -> Result<DMatrix<f64>, Error> {
    let settings = Integrator::new().with_max_steps(form.most_of_a_period())?;
    let start = (map.begins(), &map.start);
    let mut flow = TangentFlow::new(form, settings, start, &[], tangents)?;
    while let Some(step) = flow.fetch(time) {
        let step = step?;
        flow.carry(&step)?;
        if step.end_time() >= time {
            break;
        }
    }
    flow.finish()?;
    Ok(flow.tangents)
}

/// The independent directions of sticking contacts that share coordinates, as rows for states.
fn held_by(form: &GeneralForm<'_>, modes: &[Mode]) -> Vec<DVector<f64>> {
    let holding = form.model.holding(&|c| modes[c] == Mode::Stick);
    let rows = holding.contacts.iter().map(|&c| {
        let mut row = DVector::zeros(form.order());
        for &(j, b) in form.model.contacts[c].direction.iter() {
            row[form.len() + j] = b;
        }
        row
    });
    rows.collect()
}

/// The number of elastic contacts that do not stick: their forces do not depend on their past.
fn forgetting(form: &GeneralForm<'_>, modes: &[Mode]) -> usize {
    let elastic = (0..form.contacts()).filter(|&c| !form.holds(c));
    elastic.filter(|&c| modes[c] != Mode::Stick).count()
}

/// True for each row that is all zero, so that perturbations of this coordinate have vanished.
fn dead_rows(matrix: &DMatrix<f64>) -> Vec<bool> {
    let rows = matrix.row_iter();
    rows.map(|row| row.iter().all(|x| *x == 0.0)).collect()
}

/// The state after the events at the end of a step: an elastic contact whose load falls by a jump
/// carries no more than its new limit.
fn limited_end(form: &GeneralForm<'_>, step: &Step) -> State {
    let mut end = step.end_state();
    let time = step.end_time();
    for &(c, side) in &step.after().limited {
        let limit = form.model.contacts[c].limit_at(time, |j| end.displacements[j]);
        end.memory[form.model.memory(c).start] = side.sign() * limit;
    }
    end
}
