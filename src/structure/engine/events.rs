//! Events that end a step: the first times at which sliding speeds, stick bands and loads reach 0,
//! and the list of the events there.

use super::contact_series::ContactSeries;
use super::element_events::{Passage, first_passage};
use super::mode_constraints::Modes;
use super::model::Model;
use super::series::Series;
use super::state::{ContactState, Firing, Phase, Situation};
use super::step_size::Plan;
use super::stick_band_edge::Edge;
use crate::error::Element;
use crate::force::stop::CLOSED;
use crate::motion::{Event, EventKind, Mode};
use crate::series::{EventDistance, PowerSeries, TooCurved};
use crate::state::Direction;
use crate::state::structure::State;

/// Largest distance, in ulps of the time, between events of several contacts that end a step
/// together: rounding can separate the events of mirrored masses by this distance.
const TOGETHER: f64 = 4.0;

/// The events that end a step.
#[derive(Debug, Clone, Default)]
pub(super) struct Firings {
    /// Time and reason with which each contact ends the step, if it does.
    pub(super) contacts: Vec<Option<(f64, Firing)>>,
    /// Time and reason with which each mechanism ends the step, if it does.
    pub(super) mechanisms: Vec<Option<(f64, Firing)>>,
    /// The border that each element passes at the end of the step, if it does.
    pub(super) passages: Vec<Option<Passage>>,
}

/// The first time in (0, h] of an event, or h; stores the contacts of the event. An event within
/// rounding of a break of a drive is attributed to the break: the next piece of the drive decides
/// what happens.
pub(super) fn first_firings(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    [h, to_break]: [f64; 2],
    firings: &mut Firings,
) -> Result<f64, TooCurved> {
    let elapsed = situation.clock.time.abs();
    let slack = |end: f64| TOGETHER * f64::EPSILON * (elapsed + end);
    // Beyond the first event only those within rounding of it count.
    let limit = |end: f64| if end < h { h.min(end + slack(end)) } else { h };
    let mut end = h;
    firings.contacts.clear();
    firings.mechanisms.clear();
    firings.passages.clear();
    for (c, contact) in model.contacts.iter().enumerate() {
        let (state, series) = (&situation.contacts[c], &series.contacts[c]);
        let firing = first_firing(state, series, &contact.breakpoints, limit(end), slack)?;
        if let Some((time, _)) = firing {
            end = end.min(time);
        }
        firings.contacts.push(firing);
    }
    for mechanism in &situation.mechanisms {
        let distance = |side| mechanism.distance(model, series, side);
        let firing = bound_firing(distance, limit(end))?;
        if let Some((time, _)) = firing {
            end = end.min(time);
        }
        firings.mechanisms.push(firing);
    }
    let elements = std::iter::zip(&situation.elements, &series.elements);
    for (element, (state, of)) in std::iter::zip(&model.elements, elements) {
        let passage = first_passage(element, state, of, limit(end))?;
        if let Some(passage) = passage {
            end = end.min(passage.time);
        }
        firings.passages.push(passage);
    }
    for firing in firings.contacts.iter_mut().chain(&mut firings.mechanisms) {
        *firing = firing.filter(|&(time, _)| time <= end + slack(end));
    }
    for passage in &mut firings.passages {
        *passage = passage.filter(|passage| passage.time <= end + slack(end));
    }
    if end < h && to_break <= end + slack(end) {
        end = end.max(to_break);
    }
    Ok(end)
}

/// The first event of a contact in (0, h], and its time. A band that closes with its load is not
/// left before that.
fn first_firing(
    state: &ContactState,
    series: &ContactSeries,
    breakpoints: &[f64],
    h: f64,
    slack: impl Fn(f64) -> f64,
) -> Result<Option<(f64, Firing)>, TooCurved> {
    let of_load = load_firing(state, series, h)?;
    let of_motion = match state.phase {
        Phase::Open => None,
        Phase::Stick { .. } if state.is_in_group => None,
        Phase::Stick { .. } if stays_inside(state, series, h) => None,
        Phase::Stick { .. } => bound_firing(|side| state.edge.distance(series, side), h)?,
        Phase::Slip { piece, .. } => speed_firing(&series.speeds, breakpoints, piece, h)?,
    };
    Ok(match (of_load, of_motion) {
        (Some(load), Some(motion)) if motion.0 < load.0 - slack(load.0) => Some(motion),
        (load, motion) => load.or(motion),
    })
}

/// The normal load falls to 0, or rises above it again.
fn load_firing(
    state: &ContactState,
    series: &ContactSeries,
    h: f64,
) -> Result<Option<(f64, Firing)>, TooCurved> {
    if !series.load_varies {
        return Ok(None);
    }
    let sign = if state.mode() == Mode::Open {
        -1.0
    } else {
        1.0
    };
    let mut load = series.normal().scaled(sign);
    for k in 0..state.load_edge.known() {
        load[k] = 0.0;
    }
    first(&load, h, Firing::Load)
}

/// Returns true if the force in a sticking contact surely stays within its limits.
fn stays_inside(state: &ContactState, series: &ContactSeries, h: f64) -> bool {
    let [backward, forward] = &series.bounds;
    let is_constant = backward.is_constant() && forward.is_constant();
    let least = backward[0].min(forward[0]);
    state.edge == Edge::Away && is_constant && series.carried.stays_within(least, h)
}

/// The first of the two distances from its bounds that reaches 0.
fn bound_firing(
    distance: impl Fn(Direction) -> PowerSeries,
    h: f64,
) -> Result<Option<(f64, Firing)>, TooCurved> {
    let mut found: Option<(f64, Firing)> = None;
    for side in [Direction::Lagging, Direction::Leading] {
        // Both over the whole step: the last bits of a root depend on the interval.
        let firing = first(&distance(side), h, Firing::Bound(side))?;
        let is_first = |&(time, _): &(f64, Firing)| found.is_none_or(|(other, _)| time <= other);
        found = firing.filter(is_first).or(found);
    }
    Ok(found)
}

/// The sliding speed reaches 0, or a breakpoint of the law.
fn speed_firing(
    speeds: &PowerSeries,
    breakpoints: &[f64],
    piece: usize,
    h: f64,
) -> Result<Option<(f64, Firing)>, TooCurved> {
    if speeds.is_constant() {
        return Ok(None);
    }
    let low = match piece.checked_sub(1) {
        // The usual case, kept short.
        None if speeds[0] > 0.0 => {
            let (values, curvature) = speeds.survey(h);
            let root = speeds.first_root_by(h, values, curvature)?;
            root.map(|time| (time, Firing::Arrival))
        }
        None => first(speeds, h, Firing::Arrival)?,
        Some(below) => {
            let distance = speeds.minus(breakpoints[below]);
            first(&distance, h, Firing::Breakpoint(below, false))?
        }
    };
    let Some(&level) = breakpoints.get(piece) else {
        return Ok(low);
    };
    let h = low.map_or(h, |(time, _)| time);
    let distance = speeds.minus(level).scaled(-1.0);
    Ok(first(&distance, h, Firing::Breakpoint(piece, true))?.or(low))
}

/// The first time at which a distance is 0; an infinite one never is.
fn first(
    distance: &PowerSeries,
    h: f64,
    firing: Firing,
) -> Result<Option<(f64, Firing)>, TooCurved> {
    if distance[0] == f64::INFINITY {
        return Ok(None);
    }
    let Some(positive) = EventDistance::new(distance) else {
        return Ok(None);
    };
    Ok(positive.first_zero(h)?.map(|time| (time, firing)))
}

/// Returns true if sliding speeds that reach 0, or a breakpoint of a law, continue beyond it by the
/// equation of motion.
///
/// If the tolerance is large compared with the changes of a speed, a series may have a root that
/// the motion does not have. Without this check the step would end at its start again and again.
pub(super) fn go_through(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    plan: &Plan,
    firings: &Firings,
) -> bool {
    firings.contacts.iter().enumerate().all(|(c, firing)| {
        let contact = &model.contacts[c];
        if contact.is_elastic() {
            return true;
        }
        let (time, speed, inward) = match *firing {
            Some((time, Firing::Arrival)) => (time, 0.0, 1.0),
            Some((time, Firing::Breakpoint(number, rising))) => (
                time,
                contact.breakpoints[number],
                if rising { -1.0 } else { 1.0 },
            ),
            _ => return true,
        };
        let rate = inward * rate_at(model, situation, series, c, time, speed);
        plan.contacts[c].is_rounding(rate)
    })
}

/// dy/dt of a contact that slips, by the equation of motion, at a time of the step and a speed
/// reached there.
fn rate_at(
    model: &Model<'_>,
    situation: &Situation,
    series: &Series,
    c: usize,
    time: f64,
    speed: f64,
) -> f64 {
    let (contact, of) = (&model.contacts[c], &series.contacts[c]);
    let Some(slip) = situation.contacts[c].slip(speed) else {
        return f64::NAN;
    };
    let friction = |of: &ContactSeries, coefficient: f64| {
        let load = if of.load_varies {
            of.load.at(time)
        } else {
            of.load[0]
        };
        load * coefficient
    };
    let memory = &|j: usize| of.memories[j].at(time);
    let own = friction(of, slip.direction * contact.law.coefficient(slip, memory));
    let displacement = |j: usize| {
        let way = time * situation.mean_velocity(model, series, j, time);
        situation.coordinates[j].displacement + way
    };
    let velocity = |j: usize| series.coordinates[j].motion.at(time);
    let free = |i: usize| {
        let own = [displacement(i), velocity(i)];
        series.coordinates[i].force.at(time) + model.restoring(i, own, displacement, velocity)
    };
    // The accelerations that other contacts cause on the coordinates of a shared contact.
    let others = |j: usize| {
        let others = model.shared.iter().filter(|&&d| d != c);
        let of_others = others.map(|&d| {
            let of = &series.contacts[d];
            let response = model.contacts[d].response(j);
            match situation.contacts[d].phase {
                Phase::Open => 0.0,
                _ if response == 0.0 => 0.0,
                Phase::Slip { direction, .. } => {
                    response * direction.sign() * friction(of, of.friction.at(time))
                }
                Phase::Stick { .. } => response * of.carried.at(time),
            }
        });
        of_others.sum::<f64>()
    };
    let pull = contact.along(|j| free(j) - others(j)) - of.surface.slope_at(time);
    slip.direction * pull - own
}

/// The events that lead from the modes before to those of now: those of the stops, which may cause
/// others, and then those of the contacts.
pub(super) fn events_between(
    before: &Modes,
    situation: &Situation,
    state: &State,
) -> Vec<Event<State>> {
    let stops = std::iter::zip(&before.stops, situation.stops(before.stops.len())).enumerate();
    let stops = stops.filter_map(|(number, (&before, now))| {
        let kind = match (before == CLOSED, now.piece == CLOSED) {
            (false, true) => EventKind::Close,
            (true, false) => EventKind::Open,
            _ => return None,
        };
        Some((Element::Stop(number), kind))
    });
    let contacts = std::iter::zip(&before.modes, &situation.contacts).enumerate();
    let contacts = contacts.filter_map(|(number, (&before, now))| {
        Some((Element::Contact(number), kind_of(before, now.mode())?))
    });
    let kinds = stops.chain(contacts);
    let mut events = Vec::with_capacity(kinds.clone().count());
    events.extend(kinds.map(|(element, kind)| Event {
        time: situation.clock.time,
        element,
        kind,
        state: state.clone(),
    }));
    events
}

/// The event that leads from one mode to another.
fn kind_of(before: Mode, after: Mode) -> Option<EventKind> {
    match (before, after) {
        (Mode::Open, Mode::Open) | (Mode::Stick, Mode::Stick) => None,
        (_, Mode::Open) => Some(EventKind::Open),
        (Mode::Open, _) => Some(EventKind::Close),
        (Mode::Stick, Mode::Slip(side)) => Some(EventKind::Release(side)),
        (Mode::Slip(_), Mode::Stick) => Some(EventKind::Stick),
        (Mode::Slip(from), Mode::Slip(to)) => (from != to).then_some(EventKind::Crossing(to)),
    }
}
