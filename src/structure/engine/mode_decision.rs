//! The modes of contacts after an event.
//!
//! The force in a contact with its own coordinate is a function of q, v and t alone, so such
//! contacts are decided one by one. Contacts that share coordinates are decided together in
//! `shared_mode_decision.rs`. A contact exactly on the edge of its band is decided by rates, which
//! may depend on the modes of other contacts. It is first assumed to stick; all series are
//! expanded, and the sign of the first nonzero derivative decides. This is repeated until no mode
//! changes.

use super::contact_data::ContactData;
use super::coordinate_series::ALL;
use super::drift_correction::hold_left_out;
use super::elastic::{ask_again, cut, revise_elastic};
use super::element_forces::revise_pieces;
use super::expand::{expand, expand_further};
use super::model::Model;
use super::rounding_scales::{load_terms, terms};
use super::series::Series;
use super::shared_mode_decision::Decision;
use super::state::{Closed, ContactState, Disturbance, Entry, Phase, Situation};
use super::stick_band_edge::{EDGE_ROUNDING, Edge, leaving, side_of};
use crate::error::Error;
use crate::motion::Mode;
use crate::series::PowerSeries;
use crate::state::Direction;

/// Decides the modes, and expands the motion that follows. Shared contacts are decided again only
/// after a disturbance.
pub(super) fn decide(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &mut Series,
    disturbance: Disturbance,
) -> Result<(), Error> {
    // Contacts that begin to slip rest now, and not at the end of the next step.
    let contacts = &situation.contacts;
    let begins = |&c: &usize| contacts[c].rests() && !contacts[c].sticks();
    let changes =
        |_: &mut Closed| disturbance != Disturbance::None || model.shared.iter().any(begins);
    let closed = situation.closed.take_if(changes);
    decide_modes(model, situation, series, disturbance)?;
    let left_out = closed.map_or_else(Vec::new, |closed| closed.left_out);
    if hold_left_out(model, situation, series, &left_out) {
        let expanded = expand(model, situation, series, ALL);
        return expanded.map_err(|fault| fault.at(situation.reached(model, series)));
    }
    Ok(())
}

fn decide_modes(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &mut Series,
    disturbance: Disturbance,
) -> Result<(), Error> {
    let is_disturbed = disturbance != Disturbance::None;
    let may_jump = disturbance == Disturbance::Jump;
    cut(model, situation, series);
    let asks_shared = is_disturbed && !model.shared.is_empty();
    let mut decision = asks_shared.then(|| Decision::new(model, situation, series));
    if is_disturbed {
        open_unloaded(model, situation, series, &mut decision)?;
    }
    for c in 0..situation.contacts.len() {
        arrive(model, situation, c);
    }
    // Each round except the last changes a contact (its load, its band, or its piece of the law) or
    // the piece of an element.
    for _ in 0..=4 * (situation.contacts.len() + situation.elements.len()) {
        if let Some(decision) = &mut decision {
            decision.settle(model, situation, series)?;
        }
        let is_alone = decision.is_none() && model.springs.is_empty();
        let orders = if is_disturbed && is_alone { FEW } else { ALL };
        if let Err(fault) = expand(model, situation, series, orders) {
            return Err(fault.at(situation.reached(model, series)));
        }
        if revise(model, situation, series, &mut decision, may_jump)? {
            continue;
        }
        if orders == ALL {
            return Ok(());
        }
        expand_further(model, situation, series, orders);
        if !revise(model, situation, series, &mut decision, may_jump)? {
            return Ok(());
        }
    }
    match decision {
        None => Ok(()),
        Some(_) => Err(situation.undecided(model, series)),
    }
}

/// Number of orders that are computed before contacts are decided one by one. Nearly always the
/// sign of an early derivative decides, so the whole series of stick is not needed for a release.
const FEW: usize = 4;

/// Changes the modes that contradict the series; returns true if any mode has changed.
fn revise(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &mut Series,
    decision: &mut Option<Decision>,
    may_jump: bool,
) -> Result<bool, Error> {
    let mut changed = revise_pieces(model, situation, series);
    for c in 0..situation.contacts.len() {
        let change = series.contacts[c].load_varies && revise_load(model, situation, series, c)?;
        // If a load jumps, the force of a spring jumps with it.
        let is_asked = || model.is_shared(c) || model.springs.binary_search(&c).is_ok();
        if change && !model.shared.is_empty() && is_asked() {
            situation.closed = None;
            let new = || Decision::new(model, situation, series);
            decision.get_or_insert_with(new).restart();
        }
        changed |= change;
    }
    if changed {
        // A spring that opens or closes changes the force that others carry.
        return Ok(true);
    }
    for c in 0..situation.contacts.len() {
        changed |= revise_mode(model, situation, series, c, may_jump);
    }
    changed |= Decision::turn_back(model, situation, series);
    changed |= revise_elastic(model, situation, series);
    match decision {
        None => Ok(changed),
        Some(decision) if changed => {
            decision.ask_rates_again();
            Ok(true)
        }
        Some(decision) => decision.revise(model, situation, series),
    }
}

/// A contact that has reached r = 0 is assumed to stick until its force shows that it does not.
fn arrive(model: &Model<'_>, situation: &mut Situation, c: usize) {
    if !situation.contacts[c].has_arrived() {
        return;
    }
    let contact = &model.contacts[c];
    let displacement = situation.displacement_along(contact);
    let (clock, state) = (situation.clock, &mut situation.contacts[c]);
    if contact.is_elastic() {
        if !state.sticks() {
            ask_again(situation, c);
        }
        return;
    }
    if let Phase::Slip { direction, .. } = state.phase {
        state.entry = Entry::Arrived(Some(direction));
        if state.limits_by(contact.law).is_some() {
            state.arrival_memory.clone_from(&state.memory);
            contact.law.caught(&mut state.memory);
        }
    }
    state.limits = state.limits_by(contact.law);
    state.phase = Phase::Stick {
        since: clock,
        from: displacement,
    };
}

/// An open contact closes: it slips if there is a relative velocity.
///
/// # Errors
///
/// [`Error::WrongWay`] if it cannot slip in this direction.
pub(super) fn close(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &mut Series,
    c: usize,
) -> Result<(), Error> {
    let contact = &model.contacts[c];
    let drive = &contact.belt_velocity;
    series.contacts[c].surface = if drive.is_constant() {
        PowerSeries::of(drive.value(0.0))
    } else {
        drive.series(situation.clock)
    };
    if contact.is_elastic() {
        ask_again(situation, c);
        return Ok(());
    }
    let surface = &series.contacts[c].surface;
    let velocity = |j: usize| situation.velocity(model, series, j);
    let time = situation.clock.time;
    let state = &situation.contacts[c];
    let relative = if state.is_lifted {
        state.relative()
    } else {
        contact.sliding_velocity(velocity, [surface[0], surface[1]], time)
    };
    let state = &mut situation.contacts[c];
    state.is_lifted = false;
    state.limits = state.limits_by(contact.law);
    check_way(situation, c, relative)?;
    set_phase(model, situation, c, relative);
    Ok(())
}

/// The phase of a contact at the start of a motion.
///
/// # Errors
///
/// Those of [`close`].
pub(super) fn begin(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &mut Series,
    c: usize,
) -> Result<(), Error> {
    let displacement = |j: usize| situation.coordinates[j].displacement;
    let velocity = |j: usize| situation.velocity(model, series, j);
    let load = || model.load_at(c, situation.clock.time, displacement, velocity);
    // One that slips in one direction only has no force without a load: it is open, and closes if
    // the load rises.
    if model.contacts[c].is_one_way() && load() <= 0.0 {
        return Ok(());
    }
    close(model, situation, series, c)
}

/// Refuses slip in the direction in which a contact cannot slip.
fn check_way(situation: &Situation, c: usize, relative: f64) -> Result<(), Error> {
    match (Direction::of(relative), situation.contacts[c].limits) {
        (Some(side), Some(limits)) if limits[side.place()] == f64::INFINITY => {
            Err(Error::WrongWay {
                contact: c,
                velocity: relative,
            })
        }
        _ => Ok(()),
    }
}

/// The phase of a closed contact with this relative velocity.
pub(super) fn set_phase(model: &Model<'_>, situation: &mut Situation, c: usize, relative: f64) {
    let contact = &model.contacts[c];
    let from = situation.displacement_along(contact);
    let since = situation.clock;
    let state = &mut situation.contacts[c];
    (state.entry, state.phase) = match Direction::of(relative) {
        None => (Entry::Arrived(None), Phase::Stick { since, from }),
        Some(direction) => {
            let speed = relative.abs();
            let slip = Phase::Slip {
                direction,
                speed,
                rate: None,
                piece: contact.piece_above(speed),
            };
            (Entry::Held, slip)
        }
    };
}

/// Gives contacts at the start of a motion these relative velocities, and changes the velocities of
/// the coordinates accordingly. Others go on to stick where their directions allow it.
pub(super) fn slide(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &mut Series,
    given: &[(usize, f64)],
) -> Result<(), Error> {
    /// Contacts that share masses cannot have any relative velocities if their directions depend.
    const ROUNDING: f64 = 1e-9;
    for &(c, relative) in given {
        check_way(situation, c, relative)?;
        set_phase(model, situation, c, relative);
    }
    let place = |c: usize| given.binary_search_by_key(&c, |&(c, _)| c);
    // Not one that passes r = 0 without limits.
    let sticks = |&c: &usize| {
        let state = &situation.contacts[c];
        place(c).is_err() && state.sticks() && state.limits.is_some()
    };
    let sticking: Vec<usize> = model.shared.iter().copied().filter(sticks).collect();
    let shared = given.iter().map(|&(c, _)| c);
    let shared = shared.filter(|&c| model.is_shared(c));
    let holding = model.independent(shared.chain(sticking.iter().copied()).collect(), &|_| 0.0);
    let relative_to = |c: usize| {
        let relative = place(c).map_or(0.0, |place| given[place].1);
        relative + series.contacts[c].surface[0]
    };
    let along = |situation: &Situation, c: usize| {
        let velocity = |j: usize| situation.coordinates[j].velocity;
        model.contacts[c].along(velocity)
    };
    let corrections = model.corrections(&holding, &|c| along(situation, c) - relative_to(c));
    for (j, correction) in corrections {
        situation.coordinates[j].velocity -= correction;
    }
    let is_met = |c: usize| {
        let size = model.contacts[c].size_along(|j| situation.coordinates[j].velocity);
        let apart = (along(situation, c) - relative_to(c)).abs();
        apart <= ROUNDING * (size + relative_to(c).abs())
    };
    for &(c, relative) in given.iter().filter(|&&(c, _)| model.is_shared(c)) {
        let allowed = "what the relative velocities of contacts with dependent directions allow";
        Error::check("State", "sliding", relative, is_met(c), allowed)?;
    }
    let is_set = |&c: &usize| place(c).is_ok() || sticking.contains(&c) && is_met(c);
    let others: Vec<usize> = (0..model.contacts.len()).filter(|c| !is_set(c)).collect();
    for c in others {
        begin(model, situation, series, c)?;
    }
    Ok(())
}

/// The contact loses its load: there is no friction.
fn open(model: &Model<'_>, situation: &mut Situation, series: &mut Series, c: usize) {
    if let Some(i) = model.owner_of(c) {
        situation.coordinates[i].velocity = situation.velocity(model, series, i);
    }
    let state = &mut situation.contacts[c];
    state.entry = Entry::Held;
    // The end of stick changes the memory of a law; an elastic contact loses its force.
    if model.contacts[c].is_elastic() {
        state.memory[0] = 0.0;
    } else if state.sticks() {
        model.contacts[c].law.caught(&mut state.memory);
    }
    if model.contacts[c].law.changes_while_open() {
        (state.is_lifted, state.limits) = (true, None);
        return;
    }
    series.contacts[c].hold_memory(&state.memory);
    state.phase = Phase::Open;
}

/// Opens contacts whose load is below 0, or 0 and falling, before the decision of the others: they
/// hold nothing. The value of a load does not depend on modes, nor does its rate unless it depends
/// on velocities; then all series decide.
fn open_unloaded(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &mut Series,
    decision: &mut Option<Decision>,
) -> Result<(), Error> {
    for c in 0..situation.contacts.len() {
        let contact = &model.contacts[c];
        if !series.contacts[c].load_varies {
            continue;
        }
        let displacement = |j: usize| situation.coordinates[j].displacement;
        let velocity = |j: usize| situation.velocity(model, series, j);
        let mut value = contact.displacement_load(displacement);
        let mut rate = contact.displacement_load(velocity);
        for law in model.load_laws(c) {
            let factor = law.factor.value(situation.clock.time);
            value += factor * law.forces(&displacement, &velocity, None)[0];
            rate += law.rate_by_positions(factor, &displacement, &velocity);
        }
        let rounding = EDGE_ROUNDING * f64::EPSILON * load_terms(model, situation, series, c);
        let of = &mut series.contacts[c];
        let mut load = of.drive_load;
        load[0] += value * contact.compliance;
        let falls = if rate.is_nan() {
            false
        } else {
            load[1] += rate * contact.compliance;
            load[0] <= rounding && load[1] < 0.0
        };
        *of.normal_mut() = load;
        if (falls || load[0] < -rounding)
            && revise_load(model, situation, series, c)?
            && let Some(decision) = decision
        {
            decision.restart();
        }
    }
    Ok(())
}

/// Opens or closes a contact according to its load, which varies; returns true if anything has
/// changed.
fn revise_load(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &mut Series,
    c: usize,
) -> Result<bool, Error> {
    let of = &series.contacts[c];
    let terms = load_terms(model, situation, series, c);
    let rounding = EDGE_ROUNDING * f64::EPSILON * terms;
    let state = &mut situation.contacts[c];
    let load = of.normal();
    let is_on_edge = state.load_edge != Edge::Away || load[0].abs() <= rounding;
    let sign = if is_on_edge {
        let (edge, sign) = leaving(load, terms, None);
        state.load_edge = edge;
        // A load that stays 0 gives no friction.
        if sign == 0.0 { -1.0 } else { sign }
    } else {
        load[0]
    };
    match (state.mode(), sign < 0.0) {
        (Mode::Open, false) => {
            close(model, situation, series, c)?;
            arrive(model, situation, c);
            Ok(true)
        }
        (Mode::Stick | Mode::Slip(_), true) => {
            let contact = &model.contacts[c];
            if !contact.may_open() {
                let reached = situation.reached(model, series);
                return Err(Error::Separation {
                    contact: c,
                    reached,
                });
            }
            open(model, situation, series, c);
            Ok(true)
        }
        _ => Ok(false),
    }
}

/// Releases a contact that cannot stick, and puts one that slides onto its piece of the law;
/// returns true if anything has changed.
fn revise_mode(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &Series,
    c: usize,
    may_jump: bool,
) -> bool {
    let (contact, of) = (&model.contacts[c], &series.contacts[c]);
    let state = &mut situation.contacts[c];
    match state.phase {
        Phase::Open => false,
        Phase::Slip { .. } => state.revise_piece(contact, &of.speeds),
        Phase::Stick { .. } => {
            let Some(i) = model.owner_of(c) else {
                return false;
            };
            if state.limits.is_some() {
                return revise_stick(model, situation, series, [c, i], may_jump);
            }
            // Its law alone gives the force at r = 0, the same on both sides.
            let coefficient = state.coefficient_at_rest(contact.law, Direction::Leading);
            let rate = of.carried[0] - of.load[0] * coefficient;
            let direction = side_of(if rate == 0.0 { state.back() } else { rate });
            state.pass_through(direction);
            true
        }
    }
}

/// Releases a contact with a coordinate to itself whose force exceeds its limit; returns true if it
/// does.
fn revise_stick(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &Series,
    [c, i]: [usize; 2],
    may_jump: bool,
) -> bool {
    let (contact, of) = (&model.contacts[c], &series.contacts[c]);
    let state = &situation.contacts[c];
    let carried = of.carried[0];
    let is_known = state.edge != Edge::Away;
    let is_fresh = state.has_arrived();
    let excess = |side: Direction| side.sign() * carried - of.bound(side)[0];
    let side = match state.edge {
        Edge::On(Some(side), _) => side,
        _ => {
            let side = side_of(carried);
            let is_nearer = excess(side.opposite()) > excess(side);
            if is_nearer { side.opposite() } else { side }
        }
    };
    let beyond = excess(side);
    if !(is_fresh || is_known || beyond >= 0.0) {
        return false;
    }
    let force = model.acceleration_by(i, |j| model.forces[j].size()).abs();
    let load_terms = load_terms(model, situation, series, c);
    let terms = terms(model, situation, series, i) + force;
    let state = &mut situation.contacts[c];
    // The terms of the load are the scale, not the load itself, which may have just risen from 0.
    let terms = terms + load_terms * state.static_coefficient();
    let rounding = EDGE_ROUNDING * f64::EPSILON * terms;
    let mut release = None;
    if is_fresh && of.has_no_band(carried, rounding) {
        // No band yet, for the load begins: on both of its bounds.
        state.edge = Edge::reached(None);
        let rates = [side, side.opposite()].map(|side| (side, Edge::leaving(of, side).1));
        let out = rates.into_iter().find(|(_, sign)| *sign < 0.0);
        release = out.map(|(side, _)| (side, 0.0));
    } else {
        // A contact that stuck before has passed its bound only within the errors of the last step.
        if beyond > rounding && !is_known && (is_fresh || may_jump) {
            release = Some((side, beyond));
        } else if is_known || beyond >= 0.0 || (is_fresh && beyond >= -rounding) {
            let (edge, sign) = Edge::leaving(of, side);
            state.edge = edge;
            release = (sign < 0.0).then_some((side, 0.0));
        }
    }
    let Some((side, beyond)) = release else {
        return false;
    };
    // μ̂(0) may exceed μ_s by an ulp.
    let surplus = |coefficient: f64| of.bound(side)[0] - of.load[0] * side.sign() * coefficient;
    let rate = |coefficient: f64| beyond + surplus(coefficient).max(0.0);
    state.begin_slip(contact.law, side, rate);
    state.entry = Entry::Held;
    true
}

impl ContactState {
    /// The direction opposite to that of an arrival; +1 without one.
    fn back(&self) -> f64 {
        match self.entry {
            Entry::Arrived(Some(from)) => -from.sign(),
            _ => 1.0,
        }
    }

    /// The first nonzero derivative of the motion decides on the piece at a breakpoint.
    fn revise_piece(&mut self, contact: &ContactData<'_>, speeds: &PowerSeries) -> bool {
        let Phase::Slip { piece, .. } = &mut self.phase else {
            return false;
        };
        let above = contact.piece_above(speeds[0]);
        if above == 0 || contact.breakpoints[above - 1] != speeds[0] {
            let changed = *piece != above;
            *piece = above;
            return changed;
        }
        let mut rest = *speeds;
        rest[0] = 0.0;
        let chosen = above - usize::from(rest.first_nonzero().is_some_and(|c| c < 0.0));
        let changed = *piece != chosen && !matches!(self.entry, Entry::OnBreakpoint);
        if changed {
            // Once: both pieces give the same rate.
            *piece = chosen;
            self.entry = Entry::OnBreakpoint;
        }
        changed
    }
}
