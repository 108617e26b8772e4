//! The power series of all coordinates about one time, order by order.

use std::ops::Range;

use super::contact_series::{ContactSeries, StepMode};
use super::coordinate_series::{ALL, CoordinateSeries, DisplacementSeries, Role};
use super::elastic::spring_order;
use super::element_forces::{force_fault, watch};
use super::fault::{Fault, FaultyLaw};
use super::model::{Model, Target};
use super::series::Series;
use super::shared_contact_orders::{is_delicate, pull, shared_order};
use super::simd_recurrences::Waves;
use super::single_slip::{expand_alone, slips_alone};
use super::state::{Phase, Situation};
use super::stick_band_edge::Edge;
use super::stiff_sliding_speeds::Stiff;
use crate::force::stop::CLOSED;
use crate::series::{INTEGRAL, PowerSeries, TERMS};

/// The series of every drive that varies, from the time of the clock on.
pub(super) fn expand_drives(model: &Model<'_>, situation: &Situation, series: &mut Series) {
    let clock = situation.clock;
    let mut forces_vary = false;
    for &target in &model.varying {
        match target {
            Target::Force(_) => forces_vary = true,
            Target::Surface(c) => {
                series.contacts[c].surface = model.drive(target).series(clock);
            }
            // Its part from displacements is added order by order.
            Target::Load(c) => {
                let load = model.drive(target).series(clock);
                let contact = &mut series.contacts[c];
                contact.drive_load = load.scaled(model.contacts[c].compliance);
                *contact.normal_mut() = contact.drive_load;
            }
            Target::Factor(e) => series.elements[e].factor = model.drive(target).series(clock),
            Target::Rate(state) => {
                let scale = model.first_order[state].scale;
                series.inputs[state] = model.drive(target).series(clock).scaled(scale);
            }
        }
    }
    if !forces_vary {
        return;
    }
    let driven = |i: &usize| model.is_driven[*i];
    for i in (0..model.len()).filter(driven) {
        series.coordinates[i].force = PowerSeries::ZERO;
    }
    // M⁻¹ is symmetric: the rows of a force are its columns.
    for (j, force) in model.forces.iter().enumerate() {
        let force = match force.is_constant() {
            true if force.value(0.0) == 0.0 => continue,
            true => PowerSeries::of(force.value(0.0)),
            false => force.series(clock),
        };
        let (diagonal, beside) = model.inverse_mass.row(j);
        if beside.is_empty() {
            if model.is_driven[j] {
                series.coordinates[j].force = force.scaled(diagonal);
            }
            continue;
        }
        for &(i, a) in std::iter::once(&(j, diagonal)).chain(beside) {
            if model.is_driven[i] {
                series.coordinates[i].force.add(a, &force);
            }
        }
    }
    for (given, &j) in std::iter::zip(&mut series.given, &model.sprung) {
        if model.is_driven[j] {
            *given = series.coordinates[j].force;
        }
    }
}

/// Computes the first `orders` orders of all series (at most [`ALL`]). In each order the law of a
/// coordinate's contact is evaluated first, with the sliding speed of this order. The forces
/// follow, and give the velocity of the next order.
///
/// Order k of a coordinate needs only order k of the coordinates that act on it. If masses act on
/// near masses only, a group of masses is therefore expanded to the last order before the next
/// group begins, so that the data of a group stay in the processor's cache. In each order the
/// group is shifted to masses whose neighbours are complete. Contacts that share coordinates, and
/// springs of contacts, force elements and first-order states, couple all masses: each order is
/// then computed for all masses at once.
///
/// Simple cases are computed by faster code, with the same result to rounding: `single_slip.rs`
/// computes a single coordinate that slips while all others are held, `simd_groups.rs` several
/// ones. Without the first a whole run takes 1.4 times as many instructions for one mass on a belt,
/// and 1.05 times for two; without the second 1.4 times for two masses, and 1.6 to 1.7 times for 4
/// and 16. The slow manifolds and delicate edges need each order for itself.
///
/// # Errors
///
/// The first law that gave no number, or no slope.
pub(super) fn expand(
    model: &Model<'_>,
    situation: &Situation,
    series: &mut Series,
    orders: usize,
) -> Result<(), Fault> {
    if orders < ALL {
        // Orders that are not computed now must not keep the values of the step before.
        for of in &mut series.contacts {
            (of.speeds, of.carried) = (PowerSeries::ZERO, PowerSeries::ZERO);
            of.clear_bounds();
            if of.load_varies {
                *of.normal_mut() = PowerSeries::ZERO;
            }
        }
        for of in series.elements.iter_mut() {
            let motion = of.positions.iter_mut().chain(&mut of.velocities);
            motion.for_each(|series| *series = PowerSeries::ZERO);
        }
    }
    start(model, situation, series);
    all_orders(model, situation, series, 0..orders);
    law_fault(model, situation, series).map_or(Ok(()), Err)
}

/// Computes the remaining orders, after [`expand`] has computed the first.
pub(super) fn expand_further(
    model: &Model<'_>,
    situation: &Situation,
    series: &mut Series,
    first: usize,
) {
    all_orders(model, situation, series, first..ALL);
}

/// One pass to the slow manifold on which some contacts are, in place of [`expand`]. Returns false
/// if there is none.
pub(super) fn expand_slow(
    model: &Model<'_>,
    situation: &Situation,
    series: &mut Series,
    stiff: &mut Stiff,
) -> bool {
    start(model, situation, series);
    let is_delicate = is_delicate(model, situation);
    let found = (0..ALL).all(|k| {
        let mut evaluate = |series: &mut Series| {
            for coordinate in &mut series.coordinates {
                coordinate.motion.begin_order(k);
            }
            spring_order(model, series, k);
            all_of(model, series, k, 0..model.len());
            shared_order(model, situation, series, k, is_delicate);
        };
        stiff.order(model, situation, series, k, &mut evaluate)
    });
    found && law_fault(model, situation, series).is_none()
}

fn all_orders(model: &Model<'_>, situation: &Situation, series: &mut Series, orders: Range<usize>) {
    let n = model.len();
    let is_pushed = series.is_pushed();
    let are_unsprung =
        model.shared.is_empty() && model.springs.is_empty() && model.first_order.is_empty();
    let are_apart = are_unsprung && !is_pushed;
    if are_unsprung
        && orders.end == ALL
        && let Some([i, c]) = slips_alone(model, series)
    {
        if orders.start == 0 {
            all_of(model, series, 0, 0..i);
            all_of(model, series, 0, i + 1..n);
        }
        if expand_alone(model, series, [i, c]) {
            watch(model, series, orders);
            return;
        }
        if orders.start == 0 {
            // Order 0 is computed anew below.
            start(model, situation, series);
        }
    }
    let is_delicate = !are_apart && is_delicate(model, situation);
    let is_grouped = |(c, of): (usize, &ContactSeries)| match of.mode {
        _ if model.contacts[c].is_elastic() => {
            let state = &situation.contacts[c];
            let are_away = state.edge == Edge::Away && state.load_edge == Edge::Away;
            of.guided.is_none() && of.guided_load.is_none() && are_away
        }
        StepMode::Stick => of.memories.is_empty() && !model.is_shared(c),
        StepMode::Slip | StepMode::Open => true,
    };
    let are_grouped = orders.end == ALL
        && series.groups.is_some()
        && !is_delicate
        && series.contacts.iter().enumerate().all(is_grouped);
    if are_grouped {
        if orders.start == 0 {
            all_of(model, series, 0, 0..n);
            if !are_apart {
                shared_order(model, situation, series, 0, false);
            }
        }
        expand_groups(model, series);
        watch(model, series, orders);
        return;
    }
    if are_apart {
        let waves = Waves::new(n, AT_A_TIME, model.bandwidth);
        for start in waves.starts(orders.len()) {
            for k in orders.clone() {
                all_of(model, series, k, waves.places(start, k - orders.start));
            }
        }
        watch(model, series, orders);
    } else {
        let has_springs = !(model.springs.is_empty()
            && model.elements.is_empty()
            && model.first_order.is_empty());
        for k in orders {
            if k > 0 && has_springs {
                spring_order(model, series, k);
            }
            all_of(model, series, k, 0..n);
            shared_order(model, situation, series, k, is_delicate);
        }
    }
}

/// Computes all orders after the first of simple contacts, four side by side.
fn expand_groups(model: &Model<'_>, series: &mut Series) {
    // Without the forces of springs, which are added below.
    for (&j, given) in std::iter::zip(&model.sprung, &series.given) {
        let force = &mut series.coordinates[j].force;
        for k in 1..TERMS {
            force[k] = given[k];
        }
    }
    let Series {
        coordinates,
        contacts,
        elements,
        given,
        groups: Some(groups),
        ..
    } = series
    else {
        return;
    };
    groups.clear();
    for (i, coordinate) in coordinates.iter().enumerate() {
        let motion = &coordinate.motion;
        let numbers = [
            motion.displacement(0),
            motion.velocity(0),
            motion.velocity(1),
        ];
        groups.start(i, numbers);
        match model.owner[i] {
            Some(c) if contacts[c].mode == StepMode::Slip => {
                groups.slip(i, &model.contacts[c], &contacts[c]);
            }
            Some(_) => {}
            None => groups.free(i),
        }
        if model.is_driven[i] {
            let surface = model.owner[i].map(|c| &contacts[c].surface);
            groups.drive(i, &coordinate.force, surface);
        }
    }
    for (place, c) in model.unowned().enumerate() {
        let number = groups.number_of_unowned(place);
        let (contact, of) = (&model.contacts[c], &mut contacts[c]);
        match contact.tangential_stiffness {
            Some(stiffness) => {
                let speeds = of.first_speeds(model, c, coordinates, stiffness);
                let [stiffness, side] = match of.mode {
                    StepMode::Open => [0.0, 0.0],
                    StepMode::Stick => [stiffness, 1.0],
                    StepMode::Slip => [0.0, of.side],
                };
                groups.spring(number, [stiffness, side], speeds);
                if of.load_varies {
                    groups.press(place, contact, of);
                }
            }
            None => groups.slip(number, contact, of),
        }
        if !contact.belt_velocity.is_constant() {
            groups.drive(number, &PowerSeries::ZERO, Some(&of.surface));
        }
    }
    for place in 0..groups.forces() {
        let [e, _] = groups.force(place);
        if elements[e].acts {
            groups.push(place, &model.elements[e], &elements[e]);
        }
    }
    groups.expand();
    for place in 0..groups.forces() {
        let [e, i] = groups.force(place);
        if elements[e].acts {
            let found = groups.member(groups.number_of_force(place));
            found.give_element(&mut elements[e], i);
        }
    }
    for (i, coordinate) in coordinates.iter_mut().enumerate() {
        let found = groups.member(i);
        if let Some(c) = model.owner[i] {
            let of = &mut contacts[c];
            found.give_carried(&mut of.carried);
            match of.mode {
                StepMode::Slip => found.give_slip(of),
                _ => of.speeds = PowerSeries::ZERO,
            }
        }
        if !matches!(coordinate.role, Role::Held(_)) {
            found.give_motion(&mut coordinate.motion);
        }
    }
    for (place, c) in model.unowned().enumerate() {
        let found = groups.member(groups.number_of_unowned(place));
        let of = &mut contacts[c];
        if model.contacts[c].is_elastic() {
            found.give_spring(of);
        } else {
            found.give_slip(of);
        }
    }
    for (&j, given) in std::iter::zip(&model.sprung, given) {
        groups
            .member(j)
            .give_force(given, &mut coordinates[j].force);
    }
}

/// Number of masses of a long chain in a group.
const AT_A_TIME: usize = 16;

fn law_fault(model: &Model<'_>, situation: &Situation, series: &Series) -> Option<Fault> {
    let fault = |place: f64, value: Option<f64>| Fault {
        law: FaultyLaw::Friction,
        place,
        value,
    };
    let mut contacts = std::iter::zip(&situation.contacts, &series.contacts);
    let of_friction = contacts.find_map(|(state, series)| {
        // The law gives the memory after an event.
        if let Some(value) = state.memory.iter().find(|z| !z.is_finite()) {
            return Some(fault(state.speed(), Some(*value)));
        }
        let Phase::Slip { speed, .. } = state.phase else {
            return None;
        };
        let value = series.friction[0];
        if !value.is_finite() {
            return Some(fault(speed, Some(value)));
        }
        // A rate of the memory without a power series acts one order later.
        let is_singular =
            |k: usize| !series.friction[k].is_finite() && series.speeds[k].is_finite();
        (is_singular(1) || is_singular(2)).then(|| fault(speed, None))
    });
    of_friction.or_else(|| force_fault(model, series))
}

/// Order 0 of the unknowns, and the mode of every contact.
fn start(model: &Model<'_>, situation: &Situation, series: &mut Series) {
    for i in 0..model.len() {
        let velocity = situation.velocity(model, series, i);
        let displacement = situation.coordinates[i].displacement;
        let role = role(model, situation, series, i);
        let coordinate = &mut series.coordinates[i];
        if let (Role::Held(c), true) = (role, role != coordinate.role) {
            // These series are not computed again.
            coordinate.motion = DisplacementSeries::ZERO;
            let of = &mut series.contacts[c];
            of.speeds = PowerSeries::ZERO;
            of.clear_bounds();
        }
        coordinate.role = role;
        coordinate.motion.start(displacement, velocity);
    }
    for (of, state) in std::iter::zip(&mut series.contacts, &situation.contacts) {
        (of.rate, of.limits) = (None, state.limits.unwrap_or([0.0; 2]));
        of.lift(state.is_lifted);
        (of.mode, of.side, of.speeds[0]) = match state.phase {
            Phase::Open => (StepMode::Open, 1.0, 0.0),
            Phase::Stick { .. } => (StepMode::Stick, 0.0, 0.0),
            Phase::Slip {
                direction,
                speed,
                rate,
                piece,
            } => {
                (of.piece, of.rate) = (piece, rate);
                (StepMode::Slip, direction.sign(), speed)
            }
        };
        if of.mode != StepMode::Open && of.relaxation == 0.0 {
            for (series, memory) in std::iter::zip(&mut of.memories, &state.memory) {
                series[0] = *memory;
            }
        }
    }
    for (of, state) in std::iter::zip(&mut series.elements, &situation.elements) {
        of.piece = state.piece;
    }
    for (of, value) in std::iter::zip(&mut series.states, &situation.states) {
        of[0] = *value;
    }
    let stops = &mut series.elements[model.first_stop()..];
    let has_stops = !stops.is_empty();
    for of in stops {
        of.acts = of.piece == CLOSED;
    }
    if has_stops && !series.is_pushed() {
        for (&j, given) in std::iter::zip(&model.sprung, &series.given) {
            series.coordinates[j].force = *given;
        }
    }
    for &c in model.springs.iter().chain(&model.shared) {
        let of = &mut series.contacts[c];
        (of.guided, of.guided_load) = (None, None);
    }
    for guided in &situation.guided {
        let velocity = |parts: &Vec<(usize, f64)>| {
            let mut velocity = PowerSeries::ZERO;
            for &(held_by, part) in parts {
                velocity.add(part, &series.contacts[held_by].surface);
            }
            velocity
        };
        let [slip, load] = [&guided.slip, &guided.load].map(|x| x.as_ref().map(velocity));
        let of = &mut series.contacts[guided.contact];
        (of.guided, of.guided_load) = (slip, load);
    }
    spring_order(model, series, 0);
}

/// The role of a coordinate in the step that begins.
fn role(model: &Model<'_>, situation: &Situation, series: &Series, i: usize) -> Role {
    let Some(c) = model.owner[i] else {
        return Role::Other;
    };
    let of = &series.contacts[c];
    let is_pushed = model.is_driven[i] || is_pushed(model, situation, i);
    let is_simple = of.memories.is_empty() && !of.load_varies && !is_pushed;
    match situation.contacts[c].phase {
        Phase::Stick { .. } if is_simple => Role::Held(c),
        Phase::Slip { .. } if is_simple => Role::Slips(c),
        _ => Role::Other,
    }
}

/// Returns true if a closed stop pushes a coordinate.
fn is_pushed(model: &Model<'_>, situation: &Situation, i: usize) -> bool {
    let elements = std::iter::zip(&model.elements, &situation.elements);
    let mut stops = elements.skip(model.first_stop());
    stops.any(|(element, state)| {
        let response = &element.responses[0];
        state.piece == CLOSED && response.binary_search_by_key(&i, |&(j, _)| j).is_ok()
    })
}

/// Order k + 1 of the velocities of some coordinates, without the forces of shared contacts.
fn all_of(model: &Model<'_>, series: &mut Series, k: usize, range: Range<usize>) {
    // Tells the compiler which coefficients there are.
    let k = k.min(ALL - 1);
    for i in range {
        let (coordinates, contacts) = (&mut series.coordinates[..], &mut series.contacts);
        let rate = free_rate(model, coordinates, i, k);
        let coordinate = &mut coordinates[i];
        match coordinate.role {
            Role::Held(c) if k > 0 => contacts[c].carried[k] = rate,
            Role::Slips(c) if k > 0 => {
                let of = &mut contacts[c];
                of.carried[k] = rate;
                let coefficient = of.law_order(&model.contacts[c], k);
                let speed = (of.side * rate - of.load[0] * coefficient) * INTEGRAL[k];
                of.speeds[k + 1] = speed;
                coordinate.motion.set_velocity(k + 1, of.side * speed);
            }
            _ => order(model, series, k, i, rate),
        }
    }
}

/// Computes order k of a coordinate of any kind.
#[inline(never)]
fn order(model: &Model<'_>, series: &mut Series, k: usize, i: usize, rate: f64) {
    let Series {
        coordinates,
        contacts,
        elements,
        rates,
        ..
    } = series;
    let is_driven = model.is_driven[i];
    let given = coordinates[i].force[k];
    let velocity = match model.owner[i] {
        None => {
            rates[i] = rate + given;
            rates[i] * INTEGRAL[k]
        }
        Some(c) => {
            let (contact, of) = (&model.contacts[c], &mut contacts[c]);
            if of.load_varies {
                of.load_order(contact, coordinates, elements, k);
            }
            let surface = if is_driven && of.mode != StepMode::Open {
                of.surface[k + 1]
            } else {
                0.0
            };
            of.carried[k] = rate + (given - (k + 1) as f64 * surface);
            of.order(contact, k, surface)
        }
    };
    coordinates[i].motion.set_velocity(k + 1, velocity);
}

/// (−M⁻¹K q − M⁻¹C v)_i of order k, the newest order of the coordinate.
#[inline(always)]
fn free_rate(model: &Model<'_>, coordinates: &[CoordinateSeries], i: usize, k: usize) -> f64 {
    let motion = |j: usize| &coordinates[j].motion;
    let own = [motion(i).displacement(k), motion(i).newest_velocity()];
    let displacement = |j: usize| motion(j).displacement(k);
    let velocity = |j: usize| motion(j).velocity(k);
    model.restoring(i, own, displacement, velocity)
}

/// Stores b·a⁰ − w' of each shared contact at the start: its relative acceleration without the
/// forces of sticking contacts, but with the friction of slipping contacts.
pub(super) fn free_accelerations(model: &Model<'_>, situation: &Situation, series: &mut Series) {
    start(model, situation, series);
    for &j in &model.shared_coordinates {
        let force = series.coordinates[j].force[0];
        series.rates[j] = free_rate(model, &series.coordinates, j, 0) + force;
    }
    for &c in &model.shared {
        series.friction_order(model, c, 0);
    }
    for &c in &model.shared {
        series.contacts[c].free = pull(&model.contacts[c], series, c, 0);
    }
}

#[cfg(test)]
mod tests;
