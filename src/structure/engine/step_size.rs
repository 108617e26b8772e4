//! The length of a step, and the errors allowed in it.

use super::contact_series::ContactSeries;
use super::convergence_radius::{Reach, motion};
use super::model::Model;
use super::rounding_scales::{load_terms, terms};
use super::series::Series;
use super::state::{ContactState, Phase, Situation};
use super::stiff_sliding_speeds::Stiff;
use super::time_scales::{closings, settling, springiness, time_unit};
use crate::motion::step_control::{Allowance, FARTHEST, LOOSEST, STIFF, reach, root_of_ratio};
use crate::series::{PowerSeries, TERMS};

/// Largest time, in lengths of a step, over which the change of a velocity is used as its scale.
///
/// If springs are soft compared with friction, or absent, the change of a velocity extrapolated
/// over the time unit is far larger than the velocity before friction stops the mass. An error that
/// is small compared with this change could be as large as the velocity itself.
const BEYOND: f64 = 16.0;

/// The longest step: a number that can be halved, in any unit.
pub(super) const LONGEST_STEP: f64 = 4294967296.0;

/// Rounding of the terms of the equation of a stiff contact, in parts of ε, that its speed may have
/// as error: the forces balance to ε, the speed to ε N μ G/D.
const HOVER: f64 = 16.0;

/// A sliding speed, or else a memory, that relaxes at a rate D.
#[derive(Debug, Clone, Copy)]
pub(super) struct Relaxing {
    pub(super) contact: usize,
    pub(super) is_speed: bool,
    pub(super) rate: f64,
}

/// The data that control the lengths of steps and are passed from step to step.
#[derive(Debug, Clone)]
pub(super) struct Control {
    pub(super) tolerance: f64,
    /// Limit of the next step: twice the last one, if that had to be shorter than its coefficients
    /// allowed; otherwise infinite.
    pub(super) longest: f64,
    /// Number of steps until the slow manifold of stiff memories is tried again, and this number at
    /// the last trial without success.
    pub(super) steps_to_trial: u32,
    pub(super) pause: u32,
    /// The series of the last pass to the slow manifold.
    pub(super) pass_before: Vec<PowerSeries>,
    /// Room for what a trial begins with.
    pub(super) begun: Vec<Relaxing>,
    /// The contacts with slow speeds in the last trial.
    pub(super) stiff: Stiff,
    /// The errors that the last step left in the speeds of contacts, if they were slow.
    pub(super) errors_left: Vec<f64>,
    /// The errors of the step under way.
    pub(super) plan: Plan,
}

/// The errors that a step may have.
#[derive(Debug, Clone, Default)]
pub(super) struct Plan {
    pub(super) tolerance: f64,
    /// The time unit in which step lengths are measured.
    pub(super) unit: f64,
    /// What settles within this time need not be followed: it is less than rounding of time.
    pub(super) resolution: f64,
    /// The time over which the changes of velocities are used as their scales: the time unit, or
    /// that of the drives, or less if steps are a small part of it.
    within: f64,
    /// The allowances of each coordinate, and of each contact's relative velocity.
    pub(super) coordinates: Vec<Allowance>,
    pub(super) contacts: Vec<Allowance>,
    /// The allowances of the first-order states.
    pub(super) states: Vec<Allowance>,
    /// The size of the terms of the equation of each contact's relative velocity.
    pub(super) sizes: Vec<f64>,
    /// The size of the terms of each contact's load, if any has a law of its own.
    pub(super) loads: Vec<f64>,
    /// Rate at which a perturbation of each velocity decays.
    closings: Vec<f64>,
    /// Rate D at which each contact's sliding speed settles, if it is stiff; otherwise 0.
    pub(super) stiff: Vec<f64>,
    /// The least scale of each variable of the memory of contacts: its unit if the contact creeps,
    /// where its value may be 0 by the choice of a speed of reference; otherwise 0.
    pub(super) memory_units: Vec<f64>,
    /// Number of the last orders that no series has, because they overflow.
    pub(super) dropped: usize,
    /// True for each coordinate that its contacts leave no motion of its own, in a slow step;
    /// otherwise empty.
    pub(super) slaved: Vec<bool>,
    /// Scale of each velocity, and the size of the terms of its equation.
    scales: Vec<(f64, f64)>,
}

impl Control {
    pub(super) fn new(tolerance: f64, model: &Model<'_>) -> Self {
        Self {
            tolerance,
            longest: f64::INFINITY,
            steps_to_trial: 0,
            pause: 0,
            pass_before: Vec::with_capacity(model.len() + model.remembered()),
            begun: Vec::with_capacity(2 * model.contacts.len()),
            stiff: Stiff::default(),
            errors_left: Vec::new(),
            plan: Plan::default(),
        }
    }
}

impl Plan {
    /// Returns true if a contact is stiff in the sliding speed.
    pub(super) fn is_stiff(&self) -> bool {
        self.stiff.iter().any(|&rate| rate > 0.0)
    }

    /// True if orders that overflow are dropped: if a contact is stiff, or creeps.
    pub(super) fn may_drop(&self, model: &Model<'_>) -> bool {
        self.is_stiff() || !model.creeping.is_empty()
    }

    /// How much of a time a force on a coordinate has an effect: 1/D on a slow manifold.
    pub(super) fn lasting(&self, i: usize, time: f64) -> f64 {
        lasting(&self.slaved, &self.closings, i, time)
    }
}

fn lasting(slaved: &[bool], closings: &[f64], i: usize, time: f64) -> f64 {
    match slaved.get(i) {
        Some(true) => time.min(closings[i].recip()),
        _ => time,
    }
}

/// Decay times after which a deviation is rounding: e^{−40} = 4e-18.
pub(super) const SETTLED: f64 = 40.0;

/// Returns true if every velocity is constant, and every distance from a limit linear in time: no
/// series limits the step.
pub(super) fn is_linear(model: &Model<'_>, situation: &Situation, series: &Series) -> bool {
    let coordinates = 0..model.len();
    let contacts = std::iter::zip(&situation.contacts, &series.contacts);
    coordinates
        .into_iter()
        .all(|i| series.coordinates[i].motion.is_straight())
        && contacts
            .into_iter()
            .all(|(state, series)| match state.phase {
                Phase::Open => series.normal().is_linear(),
                Phase::Slip { .. } => {
                    let motion = [&series.speeds, &series.surface];
                    motion.iter().all(|c| c.is_constant()) && series.normal().is_linear()
                }
                Phase::Stick { .. } => {
                    let mut forces = [&series.carried, &series.load]
                        .into_iter()
                        .chain(&series.bounds);
                    series.surface.is_constant() && forces.all(|c| c.is_linear())
                }
            })
        && series.elements.iter().all(|of| !of.acts || of.rests())
        && series.states.iter().all(PowerSeries::is_constant)
}

/// Returns true if all coefficients of all series are finite.
pub(super) fn is_finite(situation: &Situation, series: &Series) -> bool {
    const LAST: usize = TERMS - 1;
    // 0 times what is not finite is no number.
    let mut sum = 0.0;
    for coordinate in &series.coordinates {
        let velocity = |k: usize| 0.0 * coordinate.motion.velocity(k);
        sum += velocity(LAST) + velocity(LAST - 1);
    }
    for state in &series.states {
        sum += 0.0 * state[LAST];
    }
    for (state, of) in std::iter::zip(&situation.contacts, &series.contacts) {
        for bound in &of.bounds {
            sum += 0.0 * bound[LAST - 1];
        }
        sum += 0.0 * of.normal()[LAST - 1];
        if state.sticks() {
            sum += 0.0 * of.carried[LAST - 1] + 0.0 * of.carried[LAST - 2];
        }
        for memory in &of.memories {
            sum += 0.0 * memory[LAST];
        }
    }
    sum == 0.0
}

/// The time up to which the last terms of all series stay below the error allowed; notes the error
/// allowed for each coordinate and contact in the plan.
pub(super) fn plan_reach(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    tolerance: f64,
    plan: &mut Plan,
) -> f64 {
    let n = model.len();
    plan.tolerance = tolerance;
    closings(model, situation, series, &mut plan.closings);
    plan.loads.clear();
    if model.pressing() > 0 {
        plan.loads.extend(
            (0..model.contacts.len())
                .map(|c| load_terms(model, situation, series, c) / model.contacts[c].compliance),
        );
    }
    let scales = &mut plan.scales;
    scales.clear();
    scales.extend((0..n).map(|i| (0.0, terms(model, situation, series, i))));
    for (c, contact) in model.contacts.iter().enumerate() {
        let of = &series.contacts[c];
        let force = match situation.contacts[c].phase {
            Phase::Open => continue,
            Phase::Slip { .. } => of.load[0] * of.friction[0],
            // The forces of springs are among the terms.
            _ if contact.is_elastic() => continue,
            // Shared contacts act on each other.
            Phase::Stick { .. } if model.is_shared(c) => of.carried[0],
            Phase::Stick { .. } => continue,
        };
        if let Some(i) = model.owner_of(c) {
            scales[i].1 += force.abs();
            continue;
        }
        for &(j, x) in contact.responses() {
            scales[j].1 += (x * force).abs();
        }
    }
    plan.unit = time_unit(model, situation, series, scales);
    plan.resolution = 0.5 * f64::EPSILON * situation.clock.time.abs().max(plan.unit);
    plan.stiff.clear();
    for (c, state) in situation.contacts.iter().enumerate() {
        let rate = settling(model, situation, series, c);
        let is_stiff = rate * plan.unit > STIFF
            && plan.unit.is_finite()
            && rate * rate
                > 4.0 * springiness(&model.contacts[c], (state, &series.contacts[c]), rate);
        plan.stiff.push(if is_stiff { rate } else { 0.0 });
    }
    plan.memory_units.clear();
    plan.memory_units.resize(model.remembered(), 0.0);
    for &c in &model.creeping {
        let state = &situation.contacts[c];
        let Some(slip) = state.slip(state.speed()) else {
            continue;
        };
        let (law, memory) = (model.contacts[c].law, |j: usize| state.memory[j]);
        for (j, unit) in plan.memory_units[model.memory(c)].iter_mut().enumerate() {
            *unit = law.unit_in_creep(slip, &memory, j);
        }
    }
    if series.contacts.iter().all(|of| of.settling == 0.0) {
        plan.slaved.clear();
    } else {
        let damped = |i: usize| match plan.slaved[i] {
            true => plan.closings[i],
            false => 0.0,
        };
        let tangents = |e: usize| &series.elements[e].tangents[..];
        let mode = |c: usize| situation.contacts[c].mode();
        plan.unit = model.slow_time_unit(damped, mode, tangents);
    }
    // A velocity that a drive changes has its size after one radian of the drive.
    let mut within = plan.unit.min(model.drive_unit);
    loop {
        let farthest = plan_within(model, situation, series, tolerance, within, plan);
        let shorter = BEYOND * farthest;
        if shorter < 0.5 * within {
            within = shorter;
        } else {
            return farthest;
        }
    }
}

/// The time up to which explicit series reach. If a contact is stiff or creeps, orders that
/// overflow are dropped, and without nearly all orders the series reach nowhere.
pub(super) fn plan_explicit(
    model: &Model<'_>,
    situation: &Situation,
    series: &mut Series,
    tolerance: f64,
    plan: &mut Plan,
) -> f64 {
    /// Most orders that a step may do without.
    const MOST_DROPPED: usize = TERMS - 6;
    plan.dropped = 0;
    let reach = plan_reach(model, situation, series, tolerance, plan);
    if plan.is_stiff() || plan.may_drop(model) && !is_finite(situation, series) {
        plan.dropped = series.truncate();
    }
    match plan.dropped {
        0 => reach,
        dropped => {
            let reach = plan_reach(model, situation, series, tolerance, plan);
            if dropped > MOST_DROPPED { 0.0 } else { reach }
        }
    }
}

/// Limits the allowed errors to those of a step of this length; returns true if the series still
/// reach so far. Events may end a step long before the series do.
pub(super) fn plan_shorter(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    tolerance: f64,
    h: f64,
    plan: &mut Plan,
) -> bool {
    let within = BEYOND * h;
    within >= plan.within || plan_within(model, situation, series, tolerance, within, plan) >= h
}

/// The reach of the series if velocities are measured by their change in the time `within`.
fn plan_within(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    tolerance: f64,
    within: f64,
    plan: &mut Plan,
) -> f64 {
    let reaches = Reach {
        tolerance,
        has_gaps: series.is_pushed() || !model.functions.is_empty(),
        dropped: plan.dropped,
    };
    plan.within = within;
    let scales = &mut plan.scales;
    // For a mass at rest, the scale is the velocity that other masses will give it.
    let mut energy = 0.0_f64;
    for (i, (scale, _)) in scales.iter_mut().enumerate() {
        let closing = plan.closings[i];
        let time = if closing * within > 1.0 {
            closing.recip()
        } else {
            within
        };
        let motion = motion(model, situation, series, i);
        let rate = motion.speed(1).abs().max(time * motion.speed(2).abs());
        let by_rate = if time.is_finite() { time * rate } else { 0.0 };
        let velocity = series.coordinates[i].motion.velocity(0);
        *scale = velocity.abs().max(motion.surface(0).abs()).max(by_rate);
        energy = energy.max(*scale / model.mobility[i]);
    }
    let mut farthest = FARTHEST * plan.unit;
    plan.coordinates.clear();
    for (i, &(own, terms)) in scales.iter().enumerate() {
        if let Some(c) = model.owner[i].filter(|&c| plan.stiff[c] > 0.0) {
            let of = &series.contacts[c];
            let state = &situation.contacts[c];
            let error = stiff_error(tolerance, (state, of), (plan.stiff[c], terms), within);
            farthest = farthest.min(reaches.of(error, &of.speeds, TERMS - 1));
            farthest = farthest.min(reaches.of(tolerance * own, &of.surface, TERMS - 1));
            plan.coordinates.push(Allowance::new(error, terms));
            continue;
        }
        let motion = motion(model, situation, series, i);
        let shared = energy * model.mobility[i];
        let scale = if own < shared {
            own.max(shared.min(motion.largest_change(within)))
        } else {
            unless_zero(own, within, |time| motion.largest_change(time))
        };
        let mut error = tolerance * scale;
        if model.shared_coordinates.binary_search(&i).is_ok() && within.is_finite() {
            // Where contacts hold a coordinate, the rounding errors of the forces on it remain.
            let lasting = lasting(&plan.slaved, &plan.closings, i, within);
            error = error.max(f64::EPSILON * lasting * terms);
        }
        let allowance = Allowance::new(error, terms);
        farthest = farthest.min(motion.reach(reaches, allowance.error));
        plan.coordinates.push(allowance);
    }
    plan.states.clear();
    for (data, of) in std::iter::zip(&model.first_order, &series.states) {
        let scale = state_scale(of, within);
        let terms = data.rate_size(|j| &series.coordinates[j].motion, &series.states);
        let allowance = Allowance::new(tolerance * scale, terms);
        farthest = farthest.min(reaches.of(allowance.error, of, TERMS - 1));
        plan.states.push(allowance);
    }
    plan.contacts.clear();
    plan.sizes.clear();
    for (c, contact) in model.contacts.iter().enumerate() {
        let (state, of) = (&situation.contacts[c], &series.contacts[c]);
        if let Some(stiffness) = contact.tangential_stiffness {
            let velocity = contact.size_along(|j| plan.scales[j].0) + contact.belt_velocity.size();
            let by_motion = if plan.unit.is_finite() {
                stiffness * velocity * plan.unit
            } else {
                0.0
            };
            let scale = state.memory[0].abs().max(by_motion);
            farthest = farthest.min(reaches.of(tolerance * scale, &of.carried, TERMS - 1));
            if let Phase::Slip { .. } = state.phase {
                // At present no force depends on the surface's velocity, but the stop of the slider
                // will.
                let error = tolerance * velocity.max(of.speeds[0].abs());
                farthest = farthest.min(reaches.of(error, &of.speeds, TERMS - 2));
            }
            if of.load_varies {
                let error = tolerance * load_terms(model, situation, series, c);
                farthest = farthest.min(reaches.of(error, &of.load, TERMS - 1));
            }
            plan.contacts.push(Allowance::new(0.0, 0.0));
            plan.sizes.push(0.0);
            continue;
        }
        let owner = model.owner_of(c);
        let mut size = match owner {
            Some(i) => plan.scales[i].1,
            None => contact.size_along(|j| plan.scales[j].1),
        };
        if state.sticks() && of.load_varies {
            // The present stick band is not used as the scale, because it may have just opened.
            size = size.max(load_terms(model, situation, series, c) * state.static_coefficient());
        }
        let allowance = match owner {
            Some(i) => plan.coordinates[i],
            None if plan.stiff[c] > 0.0 => {
                let error = stiff_error(tolerance, (state, of), (plan.stiff[c], size), within);
                Allowance::new(error, size)
            }
            None => {
                let of_masses = contact.size_along(|j| plan.coordinates[j].error);
                let rate = of.speeds[1].abs().max(within * of.speeds[2].abs());
                let by_rate = if within.is_finite() {
                    within * rate
                } else {
                    0.0
                };
                let scale = of.speeds[0].abs().max(of.surface[0].abs()).max(by_rate);
                Allowance::new(of_masses.max(tolerance * scale), size)
            }
        };
        if let (Phase::Slip { .. }, None) = (state.phase, owner) {
            farthest = farthest.min(reaches.of(allowance.error, &of.speeds, TERMS - 1));
        }
        if state.sticks() {
            // The last coefficient of the force would need one more coefficient of the velocities.
            let error = tolerance * of.largest_bound().max(size);
            farthest = farthest.min(reaches.of(error, &of.carried, TERMS - 2));
            for bound in &of.bounds {
                farthest = farthest.min(reaches.of(error, bound, TERMS - 2));
            }
        }
        if of.load_varies {
            let error = tolerance * load_terms(model, situation, series, c);
            farthest = farthest.min(reaches.of(error, of.normal(), TERMS - 2));
        }
        let units = &plan.memory_units[model.memory(c)];
        let variables = std::iter::zip(&of.memories, &state.memory);
        for ((series, memory), unit) in std::iter::zip(variables, units) {
            let scale = memory_scale(*memory, series, *unit, farthest.min(f64::MAX));
            farthest = farthest.min(reaches.of(tolerance * scale, series, TERMS - 1));
        }
        plan.contacts.push(allowance);
        plan.sizes.push(size);
    }
    farthest
}

/// The size of a first-order state: its value, or its change in a time by its first derivatives, of
/// which a motion from rest leaves the first two 0.
fn state_scale(state: &PowerSeries, within: f64) -> f64 {
    let by_rate = |k: i32| match within.is_finite() {
        true => state[k as usize].abs() * within.powi(k),
        false => 0.0,
    };
    let scale = (1..=3).map(by_rate).fold(state[0].abs(), f64::max);
    unless_zero(scale, within, |time| state.largest_change(time))
}

/// A scale, or the change in a time of a quantity that begins with a higher power of the time.
fn unless_zero(scale: f64, time: f64, change: impl Fn(f64) -> f64) -> f64 {
    match scale == 0.0 && time.is_finite() {
        true => change(time),
        false => scale,
    }
}

/// The scale of a variable of the memory over a time: its size, its change or its unit.
pub(super) fn memory_scale(value: f64, series: &PowerSeries, unit: f64, time: f64) -> f64 {
    let scale = value.abs().max(series[1].abs() * time).max(unit);
    unless_zero(scale, time, |time| series.largest_change(time))
}

/// The error of a sliding speed that settles at the rate D, under forces of the size `terms`:
/// relative to the speed, because it is known to all its digits where the contact creeps, far more
/// slowly than its surface moves. If the speed is about 0 the scale is its change: until it has
/// settled, or in a slow step over the step.
fn stiff_error(
    tolerance: f64,
    (state, of): (&ContactState, &ContactSeries),
    (rate, terms): (f64, f64),
    within: f64,
) -> f64 {
    let time = if of.settling > 0.0 {
        within / BEYOND
    } else {
        rate.recip().min(within)
    };
    let change = of.speeds[1].abs();
    let by_rate = if time.is_finite() { time * change } else { 0.0 };
    // A law with pieces, or with a stick band, has to be met at their ends.
    let tolerance = match state.limits {
        Some(_) => tolerance.min(LOOSEST),
        None => tolerance,
    };
    let error = tolerance * of.speeds[0].abs().max(by_rate);
    error.max(HOVER * f64::EPSILON * terms / rate)
}

/// The length of a step in which only the memory of contacts changes: as far as the series of the
/// memory reach. One that is linear may change by its own size, and more if the structure's own
/// times are longer. Notes the errors allowed in the plan.
pub(super) fn plan_memory(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    control: &mut Control,
) -> f64 {
    let contacts = std::iter::zip(&situation.contacts, &series.contacts);
    let closed = contacts.filter(|(state, _)| !state.phase_is_open());
    let memories = closed.flat_map(|(_, of)| &of.memories);
    let changing = memories.filter(|memory| !memory.is_constant());
    let mut changing = changing.peekable();
    if changing.peek().is_none() {
        return f64::INFINITY;
    }
    let (tolerance, plan) = (control.tolerance, &mut control.plan);
    plan_reach(model, situation, series, tolerance, plan);
    let reach = |memory: &PowerSeries| {
        const LAST: usize = TERMS - 1;
        let own = (memory[0] / memory[1]).abs();
        if memory.is_linear() {
            own.max(FARTHEST * plan.unit)
        } else if memory[LAST] == 0.0 && memory[LAST - 1] == 0.0 {
            own
        } else {
            // Its size is also what it changes by within its radius of convergence.
            let rate = memory[1].abs();
            let by = |n: usize| root_of_ratio(rate, memory[n].abs(), n - 1);
            let size = memory[0].abs().max(rate * by(LAST).min(by(LAST - 1)));
            reach(tolerance * size, memory, LAST)
        }
    };
    changing.map(reach).fold(f64::INFINITY, f64::min)
}
