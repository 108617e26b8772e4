//! The events that change at a motion: contacts that touch, arrivals at the limit of stick, events
//! at one time.

use super::super::period_map::PeriodMap;
use super::super::phase_condition::FrozenStart;
use super::super::prescribed_modes::{Hold, Then, minima_in_slip, minimum_behind, speeds};
use super::super::shooting_residual::TrialMotion;
use super::super::type_erased_system::GeneralForm;
use super::super::variational_equations::load_at_end;
use super::super::watched_event::{Mark, MarkKind};
use super::found::LocusKind;
use crate::error::Element;
use crate::motion::{Event, EventKind, Mode, Segment};
use crate::numerics::sort::sort_by;
use crate::series::PowerSeries;
use crate::state::Direction;
use crate::state::structure::State;
use crate::structure::Step;

/// A change of the events of a motion.
#[derive(Debug, Clone)]
pub(super) struct Change {
    pub(super) kind: LocusKind,
    pub(super) holds: Vec<Hold>,
    pub(super) marks: Vec<Mark>,
    /// The distance of the motion from the change, in units of its sizes.
    pub(super) size: f64,
}

impl Change {
    /// Returns true if the motion does not already hold or watch this change.
    pub(super) fn is_other(&self, holds: &[Hold], marks: &[Mark]) -> bool {
        let of_holds = self.holds.iter().all(|hold| {
            let mut known = holds.iter();
            !known.any(|known| known.contact == hold.contact && near(known.since, hold.since))
        });
        let of_marks = self.marks.iter().all(|mark| {
            let mut known = marks.iter();
            !known.any(|known| known.contact == mark.contact && near(known.since, mark.since))
        });
        of_holds && of_marks
    }

    /// Makes motions from a start hold and watch this change, too.
    pub(super) fn add_to(&self, begin: &mut FrozenStart) {
        let first = begin.holds.len();
        let holds = self.holds.iter().map(|hold| Hold {
            number: first + hold.number,
            ..*hold
        });
        begin.holds.extend(holds);
        begin.marks.extend(&self.marks);
    }

    /// The scalar that is 0 at the change, in a motion with so many holds before its own.
    pub(super) fn value(
        &self,
        form: &GeneralForm<'_>,
        map: &PeriodMap,
        holds: usize,
    ) -> Option<f64> {
        let sizes = map.sizes();
        if let LocusKind::Grazing { contact } = self.kind {
            let touch = map
                .touches
                .iter()
                .find(|touch| touch.hold.number == holds)?;
            let contact = &form.model.contacts[contact];
            return Some(touch.speed / contact.size_along(|j| sizes[form.len() + j]));
        }
        let found: Option<Vec<_>> = self
            .marks
            .iter()
            .map(|mark| mark.find(&map.steps))
            .collect();
        match (self.kind, &found?[..]) {
            (LocusKind::StopOnset { .. }, [(step, event, _), ..]) => margin(form, step, event),
            (LocusKind::Order { .. }, [a, b, ..]) => Some(a.2 - b.2),
            _ => None,
        }
    }
}

/// The margin of a crossing above the static limit, in units of friction: about −σR/(N μ_s) − 1,
/// with the μ_s against slip to the other side. It is negative for a stop.
pub(super) fn margin(form: &GeneralForm<'_>, step: &Step, event: &Event<State>) -> Option<f64> {
    let number = event.contact()?;
    let Some(Mode::Slip(side)) = step.modes().get(number) else {
        return None;
    };
    form.model.owner_of(number)?;
    let contact = &form.model.contacts[number];
    let memory = &event.state.memory[form.model.memory(number)];
    let (kinetic, limits) = contact.coefficients_at_rest(*side, memory);
    let limit = limits?[side.opposite().place()];
    let h = step.duration();
    let friction =
        load_at_end(&form.model, number, step)[0] * contact.compliance * (kinetic + limit);
    let rate = speeds(step, number, *side).slope_at(h);
    (friction > 0.0).then(|| -rate / friction - 1.0)
}

/// Returns true if two times are the same to rounding.
fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-6 * a.abs().max(b.abs())
}

/// Events are searched at most this part of the period away.
const WITHIN: f64 = 0.05;

/// A contact counts as stopped if it sticks for more than this part of the period.
const LASTS: f64 = 1e-3;

/// Touches of one size belong to one change, as in a symmetric motion.
const ALIKE: f64 = 1e-6;
const ROUNDING: f64 = 1e-9;

/// The minimum of a sliding speed.
#[derive(Debug, Clone, Copy)]
struct Minimum {
    contact: usize,
    side: Direction,
    since: f64,
    /// The sliding speed there, in units of the size of the velocity.
    speed: f64,
    /// The time for which the contact sticks from there on.
    rests: f64,
}

/// The nearest touch of a motion, of those after which a contact sticks if `sticks` is true, and of
/// the others if it is false.
pub(super) fn touch(
    form: &GeneralForm<'_>,
    map: &PeriodMap,
    period: f64,
    sticks: Option<bool>,
) -> Option<Change> {
    let all = minima(form, map, period);
    let lasts = |minimum: &Minimum| minimum.rests > LASTS * period;
    let mut near: Vec<_> = all
        .iter()
        .filter(|minimum| sticks.is_none_or(|sticks| lasts(minimum) == sticks))
        .collect();
    sort_by(&mut near, |minimum| minimum.speed.abs());
    let least = **near.first()?;
    near.retain(|minimum| {
        let apart = (minimum.speed - least.speed).abs();
        lasts(minimum) == lasts(&least) && apart <= ALIKE * least.speed.abs() + ROUNDING
    });
    let holds = near.iter().enumerate().map(|(number, minimum)| Hold {
        number,
        contact: minimum.contact,
        side: minimum.side,
        since: minimum.since,
        within: within(
            minimum.since,
            all.iter()
                .filter(|other| other.contact == minimum.contact)
                .map(|other| other.since),
            period,
        ),
        then: match minimum.rests {
            _ if lasts(minimum) => Then::Sticks,
            0.0 => Then::Slips,
            _ => Then::SlipsAfterRest,
        },
    });
    Some(Change {
        kind: LocusKind::Grazing {
            contact: least.contact,
        },
        holds: holds.collect(),
        marks: Vec::new(),
        size: least.speed.abs(),
    })
}

/// The distance from a time within which an event is searched, if others of its kind happen at the
/// given times.
fn within(since: f64, others: impl Iterator<Item = f64>, period: f64) -> f64 {
    let away = others.map(|other| {
        let later = (other - since).rem_euclid(period);
        later.min(period - later)
    });
    let away = away.filter(|away| *away > 1e-6 * period);
    0.4 * away.fold(WITHIN * period / 0.4, f64::min)
}

/// The minima of all sliding speeds, and those that an arrival cuts off. A contact that creeps
/// touches nothing: it passes through 0 smoothly.
fn minima(form: &GeneralForm<'_>, map: &PeriodMap, period: f64) -> Vec<Minimum> {
    let begins = map.steps.first().map_or(0.0, Segment::start_time);
    let sizes = map.sizes();
    let mut minima = Vec::new();
    for contact in (0..form.contacts()).filter(|&c| form.may_touch(c)) {
        let size = form.model.contacts[contact].size_along(|j| sizes[form.len() + j]);
        let mut note = |step: &Step, t: f64, side: Direction, speeds: &PowerSeries, rests: f64| {
            minima.push(Minimum {
                contact,
                side,
                since: step.start_time() + t - begins,
                speed: speeds.at(t) / size,
                rests,
            });
        };
        minima_in_slip(&map.steps, contact, &mut |step, t, side, speeds| {
            note(step, t, side, speeds, 0.0);
        });
        for step in map.steps.iter().filter(|step| !step.series().is_empty()) {
            let (Mode::Slip(side), true) = (step.modes()[contact], step.duration() > 0.0) else {
                continue;
            };
            let speeds = speeds(step, contact, side);
            let mut events = step.events().iter();
            if let Some(event) = events.find(|event| event.contact() == Some(contact))
                && speeds.slope_at(step.duration()) < 0.0
                && let Some(t) = minimum_behind(&speeds, step.duration())
                && t - step.duration() <= WITHIN * period
            {
                note(step, t, side, &speeds, rest_of(map, event, period));
            }
        }
    }
    minima
}

/// The time for which a contact sticks from an event on.
fn rest_of(map: &PeriodMap, event: &Event<State>, period: f64) -> f64 {
    if event.kind != EventKind::Stick {
        return 0.0;
    }
    let others = map.events().map(|(other, _)| other);
    let others = others.filter(|other| other.element == event.element && other.kind != event.kind);
    let later = others.map(|other| (other.time - event.time).rem_euclid(period));
    later.fold(period, f64::min)
}

/// The nearest change of an arrival from a crossing into a stop, or of the order of two events.
pub(super) fn sequence(form: &GeneralForm<'_>, map: &PeriodMap, period: f64) -> Option<Change> {
    let begins = map.steps.first().map_or(0.0, Segment::start_time);
    let steps = map.steps.iter();
    let events = steps.flat_map(|step| step.events().iter().map(move |event| (step, event)));
    let events = events.filter(|(_, event)| event.time > begins);
    let events = events.filter_map(|(step, event)| Some((step, event, event.contact()?)));
    let events: Vec<_> = events.collect();
    let mark = |(event, contact): (&Event<State>, usize), kind: MarkKind| Mark {
        contact,
        kind,
        since: event.time - begins,
        within: within(
            event.time,
            events
                .iter()
                .filter(|(_, _, other)| *other == contact)
                .map(|(_, other, _)| other.time),
            period,
        ),
    };
    let arrivals = events.iter().filter_map(|&(step, event, contact)| {
        let margin = margin(form, step, event)?;
        let Mode::Slip(side) = step.modes()[contact] else {
            return None;
        };
        Some((
            contact,
            margin,
            mark((event, contact), MarkKind::Arrival(side)),
        ))
    });
    let mut arrivals: Vec<_> = arrivals.collect();
    sort_by(&mut arrivals, |arrival| arrival.1.abs());
    let stops = arrivals.first().copied().map(|(contact, least, _)| {
        let alike = arrivals.iter().filter(|(_, margin, _)| {
            (margin.abs() - least.abs()).abs() <= ALIKE * least.abs() + ROUNDING
        });
        Change {
            kind: LocusKind::StopOnset { contact },
            holds: Vec::new(),
            marks: alike.map(|arrival| arrival.2).collect(),
            size: least.abs(),
        }
    });
    let pairs = events.iter().enumerate();
    let pairs = pairs.flat_map(|(i, &(_, a, c))| {
        let before = events[..i].iter();
        before.map(move |&(_, b, d)| ((a, c), (b, d)))
    });
    let orders = pairs.filter(|(a, b)| a.1 != b.1).map(|(a, b)| {
        let (a, b) = if a.1 < b.1 { (a, b) } else { (b, a) };
        Change {
            kind: LocusKind::Order {
                contacts: [a.1, b.1],
            },
            holds: Vec::new(),
            marks: [a, b]
                .map(|event| mark(event, MarkKind::Event(event.0.kind)))
                .into(),
            size: (a.0.time - b.0.time).abs() / period,
        }
    });
    stops
        .into_iter()
        .chain(orders)
        .min_by(|a, b| a.size.total_cmp(&b.size))
}

/// The arrivals of a motion after which a contact sticks, by its events: time, element and kind.
/// They may be missing in the motion from its start.
pub(super) fn arrivals(
    form: &GeneralForm<'_>,
    trial: &TrialMotion,
    events: &[(f64, Element, EventKind)],
) -> Vec<Hold> {
    let period = trial.period;
    let mut holds = Vec::new();
    for contact in (0..form.contacts()).filter(|&c| form.holds(c)) {
        let own = events
            .iter()
            .filter(|event| event.1 == Element::Contact(contact));
        let own: Vec<_> = own.copied().collect();
        for (i, (time, _, kind)) in own.iter().enumerate() {
            let [before, after] = [i + own.len() - 1, i + 1].map(|i| own[i % own.len()]);
            let (EventKind::Stick, EventKind::Release(side) | EventKind::Crossing(side)) =
                (kind, before.2)
            else {
                continue;
            };
            if (after.0 - time).rem_euclid(period) > LASTS * period {
                holds.push(Hold {
                    number: 0,
                    contact,
                    side,
                    since: *time,
                    within: within(*time, own.iter().map(|event| event.0), period),
                    then: Then::Sticks,
                });
            }
        }
    }
    holds
}
