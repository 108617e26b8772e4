//! The state at the end of a step: what was integrated, and what reached zero, to the bit.

use super::drift_correction::{arrive_with_others, reconcile};
use super::elastic::land_springs;
use super::events::Firings;
use super::expand::expand_drives;
use super::mode_decision::set_phase;
use super::model::Model;
use super::series::Series;
use super::state::{Disturbance, Entry, Firing, Phase, Situation};
use super::stick_band_edge::Edge;
use crate::clock::Clock;
use crate::series::PowerSeries;

/// The accepted length of a step.
#[derive(Debug, Clone, Copy)]
pub(super) struct AcceptedStep {
    pub(super) duration: f64,
    /// The time where pieces of a drive meet, if the step ends there.
    pub(super) at_break: Option<f64>,
}

/// Moves the state to the end of the step, and sets the numbers that reached zero to the bit.
/// Returns what happened there.
pub(super) fn land(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &mut Series,
    firings: &mut Firings,
    settled: AcceptedStep,
) -> Disturbance {
    let (h, at_break) = (settled.duration, settled.at_break.is_some());
    for i in 0..model.len() {
        let way = h * situation.mean_velocity(model, series, i, h);
        let coordinate = &mut situation.coordinates[i];
        coordinate.displacement += way;
        if model.owner[i].is_none_or(|c| situation.contacts[c].phase_is_open()) {
            coordinate.velocity = series.coordinates[i].motion.at(h);
        }
    }
    situation.clock = match settled.at_break {
        Some(time) => Clock::at(time),
        None => situation.clock.after(h),
    };
    let passages = std::iter::zip(&mut situation.elements, &firings.passages);
    let mut jumps = at_break;
    for (element, (state, passage)) in std::iter::zip(&model.elements, passages) {
        if h > 0.0 || passage.is_some() {
            jumps |= state.land(element, *passage);
        }
    }
    let mut disturbance = if jumps {
        Disturbance::Jump
    } else {
        Disturbance::None
    };
    for (state, series) in std::iter::zip(&mut situation.states, &series.states) {
        *state = unless_subnormal(series.at(h));
    }
    let fires_alone = firings.contacts.iter().flatten().count() == 1;
    for (c, firing) in firings.contacts.iter_mut().enumerate() {
        let firing = firing.take().map(|(_, firing)| firing);
        let is_slow = series.contacts[c].settling > 0.0;
        series.contacts[c].relaxation = 0.0;
        series.contacts[c].settling = 0.0;
        // In all other cases nothing has changed for this contact since its mode was decided.
        if h > 0.0 || jumps || is_slow || firing.is_some() {
            let jumps = (jumps, !fires_alone && model.owner_of(c).is_none());
            let fired = land_contact(model, situation, series, c, firing, (settled, jumps));
            if fired && disturbance == Disturbance::None {
                disturbance = Disturbance::Event;
            }
        }
    }
    for (mechanism, firing) in std::iter::zip(&mut situation.mechanisms, &firings.mechanisms) {
        mechanism.edge = match firing {
            None if h == 0.0 && !jumps => mechanism.edge,
            _ if jumps => Edge::Away,
            Some((_, Firing::Bound(side))) => Edge::reached(Some(*side)),
            _ if mechanism.stays_along(model, series, h) => mechanism.edge,
            _ => Edge::Away,
        };
        if firing.is_some() && disturbance == Disturbance::None {
            disturbance = Disturbance::Event;
        }
    }
    expand_drives(model, situation, series);
    if let Some(time) = settled.at_break {
        slide_on(model, situation, series, time);
    }
    land_springs(model, situation, series, settled.at_break);
    if !model.shared.is_empty() {
        arrive_with_others(model, situation, series);
        reconcile(model, situation, series);
    }
    disturbance
}

/// Contacts that never stick slide on where the velocity of their surface jumps: that of the
/// coordinates does not.
fn slide_on(model: &Model<'_>, situation: &mut Situation, series: &Series, time: f64) {
    for (c, contact) in model.contacts.iter().enumerate() {
        let state = &situation.contacts[c];
        if let Phase::Slip {
            direction, speed, ..
        } = state.phase
            && !contact.is_elastic()
            && contact.belt_velocity.jumps_at(time)
        {
            let jump = series.contacts[c].surface[0] - contact.belt_velocity.just_before(time);
            set_phase(model, situation, c, direction.sign() * speed - jump);
        }
    }
}

/// What decays ends at 0: subnormal numbers have too few digits for a series.
fn unless_subnormal(x: f64) -> f64 {
    if x.is_subnormal() { 0.0 } else { x }
}

/// Returns true if a sliding speed that is 0 at the end of a step does not only touch it. Where r'
/// is continuous, the series decide: on a slow manifold r' by the balance of forces is rounding.
fn goes_on(speeds: &PowerSeries, h: f64) -> bool {
    /// A slope of this part of the sizes of its terms is that of a touch.
    const CLEAR: f64 = 1e-6;
    let slope = speeds.derivative();
    let sizes = PowerSeries::from_fn(|k| slope[k].abs());
    slope.at(h) < -CLEAR * sizes.at(h)
}

/// Moves one contact, and the coordinate that it holds, to the end of the step. Returns true if the
/// contact has an event.
fn land_contact(
    model: &Model<'_>,
    situation: &mut Situation,
    series: &Series,
    c: usize,
    mut firing: Option<Firing>,
    (settled, (jumps, may_be_pushed)): (AcceptedStep, (bool, bool)),
) -> bool {
    let (contact, h) = (&model.contacts[c], settled.duration);
    let (state, of) = (&mut situation.contacts[c], &series.contacts[c]);
    for (memory, series) in std::iter::zip(&mut state.memory, &of.memories) {
        *memory = unless_subnormal(series.at(h));
    }
    let stays = !jumps && of.stays_along(state.edge, h);
    let edge = if stays { state.edge } else { Edge::Away };
    (state.edge, state.load_edge) = (edge, Edge::Away);
    state.entry = Entry::Held;
    // Neither another force nor its own law at r = 0 changes r'.
    let is_smooth = !(jumps || may_be_pushed) && state.limits.is_none();
    if let Phase::Slip {
        direction,
        speed,
        rate,
        piece,
    } = &mut state.phase
    {
        (*speed, *rate) = (of.speeds.at(h), None);
        if firing.is_none() && *speed <= 0.0 {
            firing = Some(Firing::Arrival);
        }
        match firing {
            Some(Firing::Arrival) if is_smooth && goes_on(&of.speeds, h) => {
                (*direction, *speed, *piece) = (direction.opposite(), 0.0, 0);
            }
            Some(Firing::Arrival) => (*speed, state.entry) = (0.0, Entry::Arrived(None)),
            Some(Firing::Breakpoint(number, rising)) => {
                *speed = contact.breakpoints[number];
                *piece = number + usize::from(rising);
            }
            _ => {}
        }
    }
    match firing {
        // Behind a break of a drive they may have jumped; where a stop closes, the forces that
        // rigid contacts carry have.
        Some(Firing::Bound(_) | Firing::Load) if settled.at_break.is_some() => {}
        Some(Firing::Bound(_)) if jumps && !contact.is_elastic() => {}
        Some(Firing::Bound(side)) => state.edge = Edge::reached(Some(side)),
        Some(Firing::Load) => state.load_edge = Edge::reached(None),
        _ => {}
    }
    let (phase, owned) = (state.phase, model.owner_of(c));
    let has_functions = contact.belt_velocity.has_functions();
    if let Phase::Stick { since, from } = phase
        && (owned.is_some() || has_functions)
    {
        let from = from + contact.belt_velocity.integral(since, situation.clock);
        if has_functions {
            // No quadrature from the start of stick at every step.
            let since = situation.clock;
            situation.contacts[c].phase = Phase::Stick { since, from };
        }
        if let Some(i) = owned {
            situation.coordinates[i].displacement = from;
        }
    }
    firing.is_some()
}
