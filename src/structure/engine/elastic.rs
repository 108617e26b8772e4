//! The springs of contacts: elastic contacts, and normal springs that open.
//!
//! The force of a spring is a state variable, so it acts on the structure as a known force, order
//! by order before the coordinates: T of an elastic contact, and the reaction −d N of a normal
//! spring. An elastic contact constrains no coordinate and takes no part in common decisions.
//!
//! ```text
//! stick:  T' = k_t r           watched: h_σ = μN − σT, both σ
//! slip:   T = σ μN             watched: the speed of the slider, ζ_σ = σ r − μN'/k_t
//! ```
//!
//! Because h_σ' = −k_t ζ_σ, the first nonzero derivative of ζ_σ decides the mode of a contact at
//! its limit. A wrong mode of another contact changes r only two orders after the derivative that
//! decided this mode. Modes are therefore set in ascending order of the deciding derivative.

use super::cholesky::ROUNDING;
use super::contact_data::Entries;
use super::contact_series::{ContactSeries, StepMode};
use super::coordinate_series::CoordinateSeries;
use super::element_forces::{element_order, push};
use super::first_order_series::first_order_order;
use super::model::Model;
use super::rounding_scales::load_terms;
use super::series::Series;
use super::state::{Entry, Phase, Situation};
use super::stick_band_edge::{EDGE_ROUNDING, Edge, deciding, side_of};
use crate::series::{INTEGRAL, PowerSeries};
use crate::state::Direction;

/// Order k of the forces of all springs, force elements and first-order states, and k + 1 of what
/// springs carry and of the states.
pub(super) fn spring_order(model: &Model<'_>, series: &mut Series, k: usize) {
    for (&j, given) in std::iter::zip(&model.sprung, &series.given) {
        series.coordinates[j].force[k] = given[k];
    }
    element_order(model, series, k);
    for &c in &model.springs {
        let (contact, of) = (&model.contacts[c], &mut series.contacts[c]);
        match contact.tangential_stiffness {
            Some(stiffness) => {
                of.elastic_order(model, c, &series.coordinates, stiffness, k);
                for &(j, x) in contact.responses() {
                    series.coordinates[j].force[k] -= x * of.carried[k];
                }
            }
            None => of.load_order(contact, &series.coordinates, &series.elements, k),
        }
        if of.mode != StepMode::Open {
            for &(j, y) in &contact.reaction {
                series.coordinates[j].force[k] -= y * (of.load[k] / contact.compliance);
            }
        }
    }
    push(model, series, k);
    first_order_order(model, series, k);
    if k == 0 {
        note_sizes(model, series);
    }
}

/// Notes the sizes of the forces of all springs, elements and states at the start, for rounding
/// errors.
fn note_sizes(model: &Model<'_>, series: &mut Series) {
    let Series {
        contacts,
        elements,
        spring_sizes,
        states,
        ..
    } = series;
    spring_sizes.fill(0.0);
    let mut note = |entries: &[(usize, f64)], force: f64| {
        for (j, x) in entries {
            if let Ok(place) = model.sprung.binary_search(j) {
                spring_sizes[place] += (x * force).abs();
            }
        }
    };
    for (element, of) in std::iter::zip(&model.elements, elements) {
        for (i, response) in element.responses.iter().enumerate() {
            note(response, of.size(element, i));
        }
    }
    for (data, state) in std::iter::zip(&model.first_order, states) {
        note(&data.responses, state[0]);
    }
    for &c in &model.springs {
        let (contact, of) = (&model.contacts[c], &contacts[c]);
        if contact.is_elastic() {
            note(contact.responses(), of.carried[0]);
        }
        note(&contact.reaction, of.load[0] / contact.compliance);
    }
}

impl ContactSeries {
    /// Order k of r, and k + 1 of the load, of its limit and of T; in slip order k of the slider's
    /// speed.
    fn elastic_order(
        &mut self,
        model: &Model<'_>,
        c: usize,
        coordinates: &[CoordinateSeries],
        stiffness: f64,
        k: usize,
    ) {
        let contact = &model.contacts[c];
        // Where contacts that stick determine it, without the rounding of their forces.
        let velocity = |along: &Entries, guided: &Option<PowerSeries>| {
            let is_summed = |&&(j, _): &&(usize, f64)| guided.is_none() || model.owner[j].is_some();
            let terms = along.iter().filter(is_summed);
            let terms = terms.map(|&(j, x)| x * coordinates[j].motion.velocity(k));
            terms.sum::<f64>() + guided.as_ref().map_or(0.0, |guided| guided[k])
        };
        if k == 0 {
            self.load_order(contact, coordinates, &[], 0);
            self.set_bounds(0, self.load[0] * self.limits[0]);
            self.friction[0] = self.limits[0];
        }
        self.load_order(contact, coordinates, &[], k + 1);
        if self.guided_load.is_some() {
            let rate = velocity(&contact.load_gradient, &self.guided_load);
            self.load[k + 1] = self.drive_load[k + 1] + rate * INTEGRAL[k];
        }
        let bound = if self.load_varies {
            self.load[k + 1] * self.limits[0]
        } else {
            0.0
        };
        self.set_bounds(k + 1, bound);
        let velocity = velocity(&contact.direction, &self.guided) - self.surface[k];
        let carried = &mut self.memories[0];
        match self.mode {
            StepMode::Open => [carried[k], carried[k + 1]] = [0.0, 0.0],
            StepMode::Stick => carried[k + 1] = stiffness * velocity * INTEGRAL[k],
            StepMode::Slip => {
                if k == 0 {
                    carried[0] = self.side * self.bounds[0][0];
                }
                carried[k + 1] = self.side * bound;
                let speed = self.side * velocity - (k + 1) as f64 * bound / stiffness;
                // Zeros that the decision knows.
                let is_zero = match k {
                    0 => self.speeds[0] == 0.0,
                    1 => self.rate.is_some(),
                    _ => false,
                };
                self.speeds[k] = if is_zero { 0.0 } else { speed };
            }
        }
        (self.carried[k], self.carried[k + 1]) = (carried[k], carried[k + 1]);
    }

    /// Sets both limits of an elastic contact, which are the same.
    fn set_bounds(&mut self, k: usize, bound: f64) {
        for series in &mut self.bounds {
            series[k] = bound;
        }
    }

    /// The first two orders of r while the slider is at rest, and of the slider's speed in slip,
    /// after order 0 of all velocities; and the first three of the load.
    pub(super) fn first_speeds(
        &mut self,
        model: &Model<'_>,
        c: usize,
        coordinates: &[CoordinateSeries],
        stiffness: f64,
    ) -> [f64; 2] {
        self.elastic_order(model, c, coordinates, stiffness, 1);
        if self.mode == StepMode::Slip {
            return [self.speeds[0], self.speeds[1]];
        }
        let contact = &model.contacts[c];
        let velocity = |k: usize| contact.along(|j| coordinates[j].motion.velocity(k));
        [0, 1].map(|k| velocity(k) - self.surface[k])
    }
}

/// The force of an elastic contact at its limit, σμN, with exactly the bits of the series that
/// begins there.
pub(super) fn force_at_limit(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    c: usize,
    side: Direction,
) -> f64 {
    let (contact, of) = (&model.contacts[c], &series.contacts[c]);
    let load = if of.load_varies {
        let displacement = |j: usize| situation.coordinates[j].displacement;
        of.drive_load[0] + contact.displacement_load(displacement)
    } else {
        of.load[0]
    };
    side.sign() * (load * contact.constant_coefficient())
}

/// Restarts the decision of an elastic contact: at a start, where it closes, where its slider
/// stopped, and at a break of a drive.
pub(super) fn ask_again(situation: &mut Situation, c: usize) {
    let (since, state) = (situation.clock, &mut situation.contacts[c]);
    state.entry = match (state.phase, state.entry) {
        (Phase::Slip { direction, .. }, Entry::Arrived(_)) => Entry::Arrived(Some(direction)),
        _ => Entry::Arrived(None),
    };
    state.phase = Phase::Stick { since, from: 0.0 };
}

/// A contact at its limit whose slider starts, and the first order at which it does.
struct Start {
    contact: usize,
    side: Direction,
    order: usize,
    speed: f64,
}

/// Stops the sliders of elastic contacts that slip although contacts that stick hold both sides at
/// one velocity; returns true if there are any. The step before has found the end of that slip
/// within its errors only, and the speed of such a slider is 0 ever after.
fn stop_held(model: &Model<'_>, situation: &mut Situation, series: &Series) -> bool {
    let mut changed = false;
    for &c in &model.springs {
        let (contact, of) = (&model.contacts[c], &series.contacts[c]);
        let Phase::Slip { speed, .. } = situation.contacts[c].phase else {
            continue;
        };
        let is_held = contact
            .direction
            .iter()
            .all(|&(j, _)| match model.owner[j] {
                Some(owner) => situation.contacts[owner].sticks(),
                None => of.guided.is_some(),
            });
        let Some(stiffness) = contact
            .tangential_stiffness
            .filter(|_| is_held && speed > 0.0)
        else {
            continue;
        };
        let velocity = |j: usize| series.coordinates[j].motion.velocity(0);
        let terms = contact.size_along(velocity) + of.surface[0].abs();
        if of.speeds[0].abs() <= ROUNDING * (terms + (of.bounds[0][1] / stiffness).abs()) {
            situation.contacts[c].entry = Entry::Arrived(None);
            ask_again(situation, c);
            changed = true;
        }
    }
    changed
}

/// Starts the sliders of elastic contacts beyond their limits, and stops those that are held;
/// returns true if there are any.
pub(super) fn revise_elastic(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &Series,
) -> bool {
    let mut changed = stop_held(model, situation, series);
    let mut starts: Vec<Start> = Vec::new();
    for &c in &model.springs {
        let Some(stiffness) = model.contacts[c].tangential_stiffness else {
            continue;
        };
        if !situation.contacts[c].sticks() {
            continue;
        }
        find_edge(model, situation, series, c);
        let (state, of) = (&mut situation.contacts[c], &series.contacts[c]);
        let Edge::On(at, _) = state.edge else {
            continue;
        };
        // ζ_σ = 0 where a slider has stopped. Zeros found while other contacts had other modes no
        // longer count.
        let has_stopped = matches!(state.entry, Entry::Arrived(Some(_)));
        let known = Edge::On(at, if has_stopped { 2 } else { 1 });
        state.edge = known;
        for side in [Direction::Lagging, Direction::Leading] {
            if at.is_some_and(|at| at != side) {
                continue;
            }
            let Some((order, d)) = deciding(&known.distance(of, side), of.bounds[0][0]) else {
                continue;
            };
            if d >= 0.0 {
                state.edge = at.map_or(known, |_| Edge::On(at, order));
                continue;
            }
            let speed = if order == 1 { -d / stiffness } else { 0.0 };
            starts.push(Start {
                contact: c,
                side,
                order,
                speed,
            });
        }
    }
    let first = starts.iter().map(|start| start.order).min();
    for start in starts {
        if first.is_none_or(|first| start.order > first + 1) {
            continue;
        }
        let carried = force_at_limit(model, situation, series, start.contact, start.side);
        let state = &mut situation.contacts[start.contact];
        state.memory[0] = carried;
        state.entry = Entry::Held;
        state.phase = Phase::Slip {
            direction: start.side,
            speed: start.speed,
            rate: (start.order > 2).then_some(0.0),
            piece: 0,
        };
        changed = true;
    }
    changed
}

/// Finds the edge of its band on which an elastic contact that sticks is, if any.
fn find_edge(model: &Model<'_>, situation: &mut Situation, series: &Series, c: usize) {
    let of = &series.contacts[c];
    let (bound, carried) = (of.bounds[0][0], of.carried[0]);
    let size = load_terms(model, situation, series, c) * of.limits[0];
    let rounding = EDGE_ROUNDING * f64::EPSILON * (size + carried.abs());
    let state = &mut situation.contacts[c];
    if state.edge != Edge::Away {
        return;
    }
    let beyond = carried.abs() - bound;
    let is_fresh = state.has_arrived();
    // The load is 0 within the tolerance.
    let begins = state.load_edge != Edge::Away;
    state.edge = match state.entry {
        // ζ_σ = 0, where T = σμN.
        Entry::Arrived(Some(from)) => Edge::reached(Some(from)),
        // No band yet, for the load begins: on both of its bounds.
        _ if is_fresh && (begins || bound.max(carried.abs()) <= rounding) => Edge::reached(None),
        // Also where another contact has held it there: rounding is no distance that could be left.
        _ if beyond >= -rounding => Edge::reached(Some(side_of(carried))),
        _ => Edge::Away,
    };
}

/// Sets the forces of elastic contacts at the end of a step; forces at their limit are set exactly.
/// At a break of a drive the modes are decided again; where the load jumps, a force at the limit
/// remains that of the step.
pub(super) fn land_springs(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &Series,
    at_break: Option<f64>,
) {
    for &c in &model.springs {
        let (contact, state) = (&model.contacts[c], &situation.contacts[c]);
        if !contact.is_elastic() || state.phase_is_open() {
            continue;
        }
        let at_limit = match (state.phase, state.edge) {
            (Phase::Slip { direction, .. }, _) => Some(direction),
            (Phase::Stick { .. }, Edge::On(side, _)) => side,
            _ => None,
        };
        let jumps = at_break.is_some_and(|time| contact.load.jumps_at(time));
        if let Some(side) = at_limit.filter(|_| !jumps) {
            let carried = force_at_limit(model, situation, series, c, side);
            situation.contacts[c].memory[0] = carried;
        }
        if at_break.is_some() {
            situation.contacts[c].entry = Entry::Held;
            ask_again(situation, c);
        }
    }
}

/// Limits the forces of elastic contacts after their loads have jumped, before any decision.
pub(super) fn cut(model: &Model<'_>, situation: &mut Situation, series: &Series) {
    for &c in &model.springs {
        let contact = &model.contacts[c];
        let state = &mut situation.contacts[c];
        state.was_cut = false;
        if !(contact.is_elastic() && state.sticks() && state.has_arrived()) {
            continue;
        }
        let carried = state.memory[0];
        let most = force_at_limit(model, situation, series, c, Direction::Leading).max(0.0);
        let size = load_terms(model, situation, series, c) + carried.abs();
        if carried.abs() > most + EDGE_ROUNDING * f64::EPSILON * size {
            let state = &mut situation.contacts[c];
            state.memory[0] = carried.signum() * most;
            state.was_cut = true;
        }
    }
}
