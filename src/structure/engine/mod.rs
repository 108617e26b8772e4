//! One step of a structure.
//!
//! A step is computed as follows. Expand all series order by order. Take the step size h from the
//! last coefficients of all series. Find the first sliding speed, stick band or load that reaches
//! zero within h. Check the defect of every slipping contact at this time and inside the step, and
//! accept or halve the step. Move the state to the end of the step, and set quantities that reach
//! zero exactly to 0. Decide the modes of the contacts with events. Return the step and its events
//! in the order of the contacts.
//!
//! | file | what is in it |
//! |---|---|
//! | `model.rs`, `sparse.rs` | data that are constant in a motion |
//! | `state.rs`, `stick_band_edge.rs` | the situation: data that change at events |
//! | `series.rs` | the data of one step; those of a coordinate `coordinate_series.rs`, of a contact `contact_series.rs`, of a force element `element_series.rs` |
//! | `fault.rs` | faults of laws |
//! | `expand.rs` | the power series of all coordinates, order by order |
//! | `contact_orders.rs`, `shared_contact_orders.rs` | an order of one contact, and of contacts that share coordinates |
//! | `simd_groups.rs`, `simd_recurrences.rs` | those of simple contacts and of force elements, four side by side: what a step begins with, and order by order |
//! | `single_slip.rs` | those of a coordinate that slips while all others are held |
//! | `coupling.rs`, `cholesky.rs` | the forces in several sticking contacts at once |
//! | `instant.rs` | forces and accelerations at any time within a step |
//! | `step_size.rs`, `rounding_scales.rs` | the length of a step, and the errors allowed in it |
//! | `convergence_radius.rs`, `time_scales.rs` | how far its series reach; its unit of time, and the rates at which velocities settle |
//! | `elastic.rs` | elastic contacts, and normal springs |
//! | `element_forces.rs`, `element_events.rs` | force elements and stops; where pieces of their laws meet |
//! | `first_order.rs`, `first_order_series.rs` | first-order states: their data, and their orders |
//! | `slow_manifold.rs`, `stiff_sliding_speeds.rs` | the slow manifold of stiff bristles, and of contacts stiff in the speed |
//! | `directions.rs` | the directions of such contacts |
//! | `implicit_euler.rs` | speeds that settle within the rounding of time, by the implicit Euler method |
//! | `events.rs` | the first events of a step |
//! | `defect.rs` | the defect of the series |
//! | `step_end.rs` | the state at the end of a step |
//! | `mode_constraints.rs` | the modes of all contacts, and the numbers of a state that they determine |
//! | `mode_decision.rs` | the modes of contacts after an event, one by one |
//! | `shared_mode_decision.rs` | the modes of contacts that share coordinates, together |
//! | `redundant_contacts.rs` | the ways in which contacts with dependent directions begin to slip |
//! | `least_norm_shares.rs` | what each of them carries |
//! | `complementarity.rs` | the programme for their forces and accelerations |
//! | `drift_correction.rs` | shared coordinates at the end of a step, from what contacts hold |

mod check_start;
pub(crate) mod cholesky;
mod complementarity;
pub(crate) mod contact_data;
mod contact_orders;
mod contact_series;
mod convergence_radius;
mod coordinate_series;
mod coupling;
mod defect;
pub(crate) mod directions;
mod drift_correction;
mod elastic;
pub(crate) mod element_data;
mod element_events;
mod element_forces;
mod element_series;
mod events;
mod expand;
mod fault;
pub(crate) mod first_order;
mod first_order_series;
mod implicit_euler;
pub(crate) mod instant;
mod least_norm_shares;
pub(super) mod limits;
pub(crate) mod mode_constraints;
mod mode_decision;
pub(crate) mod model;
mod redundant_contacts;
mod rounding_scales;
mod series;
mod shared_contact_orders;
mod shared_mode_decision;
mod simd_groups;
mod simd_recurrences;
mod single_slip;
pub(crate) mod slow_manifold;
pub(crate) mod sparse;
mod state;
mod step_end;
mod step_size;
mod stick_band_edge;
mod stiff_sliding_speeds;
mod time_scales;

use std::sync::Arc;

pub(crate) use check_start::check_sizes;
pub(super) use check_start::check_start;
use cholesky::ROUNDING;
use contact_series::ContactSeries;
use coordinate_series::ALL;
use element_forces::singular_force;
use events::{Firings, events_between, first_firings, go_through};
use expand::{expand, expand_drives};
use limits::larger_finite;
use mode_constraints::{At, Modes};
use mode_decision::{begin, decide, slide};
use model::Model;
use redundant_contacts::Mechanism;
use series::Series;
use state::{Disturbance, Phase, Situation};
use step_end::{AcceptedStep, land};
use step_size::{
    Control, LONGEST_STEP, SETTLED, is_finite, is_linear, plan_explicit, plan_memory, plan_shorter,
};
use stick_band_edge::{Edge, side_of};

use super::carried::Carried;
use super::mechanism;
use super::step::Step;
use super::trigger::{EventData, Trigger};
use crate::clock::Clock;
use crate::error::{Element, Error};
use crate::friction::memory::Motion;
use crate::motion::step_control::{self, Attempt};
use crate::motion::{Event, EventKind, Mode};
use crate::series::{PowerSeries, quarters};
use crate::state::Direction;
use crate::state::structure::State;

/// A structure in motion.
#[derive(Debug, Clone)]
pub(super) struct Engine<'s> {
    model: Model<'s>,
    situation: Situation,
    series: Series,
    control: Control,
    firings: Firings,
    /// The present modes of the contacts.
    modes: Arc<Modes>,
    /// Steps of no length, one after the other.
    idle: usize,
    /// The error that ends the motion.
    ending: Option<Error>,
}

impl<'s> Engine<'s> {
    /// The structure at its start, with the events at the start time.
    pub(super) fn start(
        model: Model<'s>,
        tolerance: f64,
        clock: Clock,
        start: &State,
    ) -> Result<(Self, Option<Step>), Error> {
        let mut engine = Self {
            situation: Situation::new(&model, clock, start),
            series: Series::new(&model, clock.time),
            control: Control::new(tolerance, &model),
            firings: Firings::default(),
            modes: Arc::default(),
            idle: 0,
            ending: None,
            model,
        };
        let Self {
            model,
            situation,
            series,
            ..
        } = &mut engine;
        for c in 0..model.contacts.len() {
            begin(model, situation, series, c)?;
        }
        if !start.sliding().is_empty() {
            slide(model, situation, series, start.sliding())?;
        }
        expand_drives(model, situation, series);
        let state = situation.state(model, series);
        let before = Arc::new(Modes::of(model, situation));
        decide(model, situation, series, Disturbance::Jump)?;
        // A start beyond the band slips at once, without an event; one on its edge, growing, is a
        // release.
        let mut events = events_between(&before, situation, &state);
        events.retain(|event| {
            let is_release = matches!(event.kind, EventKind::Release(_));
            // The force of an elastic contact at the start determines whether its slider moves.
            let is_at_edge = |c: usize| {
                situation.contacts[c].edge != Edge::Away && !model.contacts[c].is_elastic()
            };
            is_release && event.contact().is_some_and(is_at_edge)
        });
        engine.modes = Arc::new(Modes::of(model, situation));
        let first = (!events.is_empty()).then(|| {
            let ends: Vec<f64> = state.numbers().chain(state.numbers()).collect();
            let ends = (engine.model.len(), ends);
            let ending = (events, EventData::default());
            Step::new(clock, (0.0, clock), before, ends, Vec::new(), ending)
        });
        Ok((engine, first))
    }

    /// One step; afterwards the engine is at its end.
    pub(super) fn step(&mut self) -> Result<Step, Error> {
        if let Some(error) = self.ending.take() {
            return Err(error);
        }
        let n = self.model.len();
        let numbers = 2 * n + self.model.remembered() + self.model.creeping.len();
        let mut ends = Vec::with_capacity(2 * numbers);
        let (start, modes) = (self.situation.clock, Arc::clone(&self.modes));
        self.situation.add_to(&mut ends, &self.model, &self.series);
        modes.put_at_end(start.time, At::After, n, &mut ends);
        let settled = match self.settle() {
            Ok(settled) if !self.is_below_resolution(&settled) => settled,
            Ok(settled) => self.leap().unwrap_or(settled),
            Err(error) => self.leap().ok_or(error)?,
        };
        let series = self.emitted();
        if settled.duration.is_infinite() {
            let span = (settled.duration, start.after(settled.duration));
            ends.extend_from_within(..);
            let ending = (Vec::new(), EventData::default());
            return Ok(Step::new(start, span, modes, (n, ends), series, ending));
        }
        self.idle = if settled.duration > 0.0 {
            0
        } else {
            self.idle + 1
        };
        if self.idle > 4 * (self.situation.contacts.len() + 2) {
            return Err(self.situation.undecided(&self.model, &self.series));
        }
        let Self {
            model,
            situation,
            series: next,
            firings,
            modes: now,
            ending: error,
            ..
        } = self;
        let disturbance = land(model, situation, next, firings, settled);
        let triggers = triggers(model, situation, next, settled.duration);
        let half = ends.len();
        situation.add_to(&mut ends, model, next);
        let (at_end, time) = (&mut ends[half..], situation.clock.time);
        modes.put_at_end(time, At::Before, n, at_end);
        let span = (settled.duration, situation.clock);
        let mut events = Vec::new();
        match decide(model, situation, next, disturbance) {
            Ok(()) if situation.is_in(&now.modes, &now.stops) => {}
            Ok(()) => {
                let after = Arc::new(Modes::of(model, situation));
                after.carry(time, &mut at_end[n..2 * n]);
                let end = modes.state(n, at_end);
                events = events_between(now, situation, &end);
                *now = after;
            }
            // The step is valid; the error concerns the motion after its end.
            Err(found) => *error = Some(found),
        }
        let after = self.after(&events, triggers);
        let ending = (events, after);
        Ok(Step::new(start, span, modes, (n, ends), series, ending))
    }

    /// The step's duration, up to the first event of a contact.
    fn settle(&mut self) -> Result<AcceptedStep, Error> {
        let (break_time, to_break) = self.next_break();
        let Self {
            model,
            situation,
            series,
            control,
            firings,
            ..
        } = self;
        let (model, situation) = (&*model, &*situation);
        let settled = |duration: f64| AcceptedStep {
            duration,
            at_break: break_time.filter(|_| duration >= to_break),
        };
        if is_linear(model, situation, series) {
            return self.settle_linear(to_break).map(settled);
        }
        let is_finite = is_finite(situation, series);
        let (tolerance, plan) = (control.tolerance, &mut control.plan);
        let explicit = plan_explicit(model, situation, series, tolerance, plan);
        let is_stiff = plan.is_stiff();
        if !(is_finite || plan.may_drop(model)) {
            return Err(self.underflow(0.0));
        }
        let reach = slow_manifold::relax(model, situation, series, control, explicit);
        // Time is a sum of two numbers.
        let resolution = if is_stiff { f64::EPSILON } else { 1.0 };
        let elapsed = resolution * situation.clock.time.abs();
        // If nothing limits the step, the motion is a polynomial, and valid at any time.
        let farthest = LONGEST_STEP.min(model.foresight(situation.clock));
        let cut = reach.min(control.longest).min(farthest);
        let is_long_enough =
            |h| h >= to_break || h > f64::EPSILON * elapsed && h >= f64::MIN_POSITIVE;
        let Control {
            plan, tolerance, ..
        } = &mut *control;
        let found = step_control::settle(cut.min(to_break), is_long_enough, |h| {
            let Ok(end) = first_firings(model, situation, series, [h, to_break], firings) else {
                return Attempt::TooCurved;
            };
            // Behind a break of a drive other forces act.
            let is_taken = plan_shorter(model, situation, series, *tolerance, end, plan)
                && defect::functions_are_accepted(model, situation, *tolerance, end)
                && defect::is_accepted(model, situation, series, plan, end)
                && (end >= to_break || go_through(model, situation, series, plan, firings));
            if is_taken {
                Attempt::Taken(end)
            } else {
                Attempt::Inexact(end)
            }
        });
        let (duration, h) = match found {
            Ok(found) => found,
            Err(h) => return Err(self.underflow(h)),
        };
        let is_cut = h < cut.min(to_break) || control.longest < reach;
        control.longest = if is_cut { 2.0 * h } else { f64::INFINITY };
        Ok(settled(duration))
    }

    /// True for a step that a contact makes shorter than the resolution of time, within which it
    /// would settle.
    fn is_below_resolution(&self, settled: &AcceptedStep) -> bool {
        let (plan, mut fired) = (&self.control.plan, self.firings.contacts.iter());
        let mut contacts = std::iter::zip(&plan.stiff, &self.series.contacts);
        settled.duration < plan.resolution
            && contacts.any(|(rate, of)| of.settling == 0.0 && rate * plan.resolution > SETTLED)
            && settled.at_break.is_none()
            && (self.idle > 0 || !fired.any(Option::is_some))
    }

    /// A step at the end of which contacts whose steps would be too short have the speeds that they
    /// reach within the resolution of time. `None` if there are none.
    #[cold]
    fn leap(&mut self) -> Option<AcceptedStep> {
        let (break_time, to_break) = self.next_break();
        let Self {
            model,
            situation,
            series,
            control,
            firings,
            ..
        } = self;
        let is_slow = |of: &ContactSeries| of.settling > 0.0 || of.relaxation > 0.0;
        // Rates off the slow manifold are those of the explicit series.
        let slow = series.contacts.iter().any(is_slow).then(|| series.clone());
        if slow.is_some() {
            series.forget_slow();
            // This is the expansion before that of the slow manifold, so it has no fault.
            let _ = expand(model, situation, series, ALL);
        }
        let found =
            implicit_euler::leap(model, situation, series, &control.plan, to_break, firings);
        let Some(duration) = found else {
            if let Some(slow) = slow {
                *series = slow;
            }
            return None;
        };
        control.longest = f64::INFINITY;
        Some(AcceptedStep {
            duration,
            at_break: break_time.filter(|_| duration >= to_break),
        })
    }

    /// The step's duration if all velocities are constant and all loads linear in time. No series
    /// limits the step then, but memory variables change, and may reach other parts of their laws.
    fn settle_linear(&mut self, to_break: f64) -> Result<f64, Error> {
        let Self {
            model,
            situation,
            series,
            control,
            firings,
            ..
        } = self;
        let by_memory = plan_memory(model, situation, series, control);
        let longest = by_memory.min(model.foresight(situation.clock));
        let elapsed = situation.clock.time.abs();
        let is_long_enough =
            |h| h >= to_break.min(longest) || h > f64::EPSILON * elapsed && h >= f64::MIN_POSITIVE;
        let plan = &control.plan;
        let found = step_control::settle(to_break.min(longest), is_long_enough, |h| {
            // Roots of straight lines need no isolation.
            let found = first_firings(model, situation, series, [h, to_break], firings);
            let end = found.unwrap_or(h);
            let is_exact = defect::functions_are_accepted(model, situation, control.tolerance, end)
                && (by_memory.is_infinite()
                    || defect::is_accepted(model, situation, series, plan, end));
            if is_exact {
                Attempt::Taken(end)
            } else {
                Attempt::Inexact(end)
            }
        });
        found
            .map(|(duration, _)| duration)
            .map_err(|h| self.underflow(h))
    }

    /// The next time at which pieces of a drive meet, as a time and as a duration from now.
    fn next_break(&self) -> (Option<f64>, f64) {
        let clock = self.situation.clock;
        let drives = self.model.varying.iter();
        let times = drives.filter_map(|&at| self.model.drive(at).next_break(clock));
        let time = times.min_by(f64::total_cmp);
        let duration = time.map_or(f64::INFINITY, |time| clock.until(time).max(0.0));
        (time, duration)
    }

    /// Data about the events for the tangent flow.
    fn after(&self, events: &[Event<State>], triggers: Vec<Trigger>) -> EventData {
        let is_forced = |event: &Event<State>| {
            let contact = event.contact()?;
            let is_release = matches!(event.kind, EventKind::Release(_));
            let is_own = self.model.owner_of(contact).is_some();
            let is_forced = self.situation.contacts[contact].edge == Edge::Away;
            (is_release && is_own && is_forced).then_some(contact)
        };
        let limited = self.model.springs.iter().filter_map(|&c| {
            let state = &self.situation.contacts[c];
            match state.phase {
                _ if !self.model.contacts[c].is_elastic() => None,
                Phase::Slip { direction, .. } => Some((c, direction)),
                _ if state.was_cut => Some((c, side_of(state.memory[0]))),
                _ => None,
            }
        });
        let mut elements = events.iter().map(|event| event.element);
        let may_jump = |element: Element| match element {
            Element::Contact(contact) => {
                self.model.is_shared(contact) || self.model.contacts[contact].is_one_way()
            }
            Element::Stop(stop) => {
                let law = self.model.stops()[stop].stop;
                law.is_some_and(|law| law.damping != 0.0)
            }
            _ => false,
        };
        let rates = if elements.any(may_jump) {
            self.acceleration()
        } else {
            Vec::new()
        };
        EventData {
            forced: events.iter().filter_map(is_forced).collect(),
            rates,
            triggers,
            limited: limited.collect(),
        }
    }

    /// The state, with the memory of the contacts and the first-order states.
    pub(super) fn state(&self) -> State {
        self.situation.state(&self.model, &self.series)
    }

    pub(super) fn clock(&self) -> Clock {
        self.situation.clock
    }

    /// The force in each contact, in units of force: λ_c, 0 where open.
    pub(super) fn carried(&self) -> Vec<Carried> {
        let Self {
            model,
            situation,
            series,
            ..
        } = self;
        let contacts = std::iter::zip(&situation.contacts, &series.contacts);
        let forces = contacts.map(|(state, of)| match state.phase {
            Phase::Open => 0.0,
            Phase::Stick { .. } => of.carried[0],
            Phase::Slip { direction, .. } => direction.sign() * of.load[0] * of.friction[0],
        });
        let scaled = std::iter::zip(forces, &model.contacts);
        let scaled = scaled.map(|(force, contact)| Carried::of(force / contact.compliance));
        let mut all: Vec<Carried> = scaled.collect();
        if situation.mechanisms.is_empty() {
            return all;
        }
        let sticks = model.shared.iter().copied();
        let sticks = sticks.filter(|&c| situation.contacts[c].sticks());
        let root = |c: usize| model.contacts[c].compliance.sqrt();
        let force = |c: usize| series.contacts[c].carried[0] / root(c);
        let bounds = |c: usize| {
            let bounds = series.contacts[c].bounds.each_ref();
            bounds.map(|bound| bound[0] / root(c))
        };
        for (c, force) in model.resting(sticks.collect()).shares(force, bounds) {
            let [backward, forward] = bounds(c);
            let [least, most] = [-backward, forward].map(|bound| bound / root(c));
            let force = force / root(c);
            all[c] = Carried { force, least, most };
        }
        for mechanism in &situation.mechanisms {
            for (c, range) in mechanism.ranges(force, bounds) {
                let [least, most] = range.map(|bound| bound / root(c));
                all[c].restrict(least, most);
            }
        }
        all
    }

    /// The ways in which rigid contacts in stick can begin to slip.
    pub(super) fn mechanisms(&self) -> Vec<mechanism::Mechanism> {
        let (model, situation) = (&self.model, &self.situation);
        let compliance = |c: usize| model.contacts[c].compliance;
        let groups = situation.mechanisms.iter().map(|mechanism| {
            let parts = mechanism.parts.iter();
            let slips = parts.map(|&(c, part)| (c, part * compliance(c).sqrt()));
            let mut slips: Vec<(usize, f64)> = slips.collect();
            slips.sort_unstable_by_key(|&(c, _)| c);
            let unit = slips.first().map_or(1.0, |&(_, slip)| slip);
            slips
                .into_iter()
                .map(|(c, slip)| (c, slip / unit))
                .collect()
        });
        let alone = (0..model.contacts.len()).filter(|&c| {
            let state = &situation.contacts[c];
            state.sticks() && !state.is_in_group && !model.contacts[c].is_elastic()
        });
        let mut all: Vec<Vec<(usize, f64)>> = alone.map(|c| vec![(c, 1.0)]).chain(groups).collect();
        all.sort_unstable_by(|a, b| a.iter().map(|at| at.0).cmp(b.iter().map(|at| at.0)));
        let sides = [Direction::Leading, Direction::Lagging];
        let to_sides = all.iter().flat_map(|slips| {
            sides.map(|side| {
                let (mut power, mut resistance) = (0.0, 0.0);
                let slips = slips.iter().map(|&(c, slip)| (c, side.sign() * slip));
                let contacts: Vec<(usize, f64)> = slips.collect();
                for &(c, slip) in &contacts {
                    let of = &self.series.contacts[c];
                    power += slip * (of.carried[0] / compliance(c));
                    resistance += slip.abs() * (of.bound(side_of(slip))[0] / compliance(c));
                }
                mechanism::Mechanism {
                    contacts,
                    power,
                    resistance,
                }
            })
        });
        let is_possible = |it: &mechanism::Mechanism| it.resistance != f64::INFINITY;
        to_sides.filter(is_possible).collect()
    }

    /// v' of each coordinate.
    pub(super) fn acceleration(&self) -> Vec<f64> {
        let coordinates = self.series.coordinates.iter();
        coordinates
            .map(|coordinate| coordinate.motion.velocity(1))
            .collect()
    }

    /// Series of all velocities, then of the memory and of first-order states, then of the relative
    /// velocities that are numbers of a state.
    fn emitted(&self) -> Vec<PowerSeries> {
        let mut series = Vec::with_capacity(self.model.len() + self.model.remembered());
        let coordinates = self.series.coordinates.iter();
        series.extend(coordinates.map(|coordinate| coordinate.motion.velocities()));
        if self.model.remembered() > 0 {
            let contacts = self.series.contacts.iter();
            series.extend(contacts.flat_map(|contact| &contact.memories));
            series.extend(&self.series.states);
        }
        for (c, _) in self.situation.sliding(&self.model) {
            let of = &self.series.contacts[c];
            series.push(of.speeds.scaled(of.side));
        }
        series
    }

    /// The error of the law if it returned no number on the motion, otherwise a step underflow.
    #[cold]
    fn underflow(&self, step: f64) -> Error {
        let reached = self.situation.reached(&self.model, &self.series);
        for (c, contact) in self.model.contacts.iter().enumerate() {
            let (state, of) = (&self.situation.contacts[c], &self.series.contacts[c]);
            if contact.is_elastic() || state.mode() == Mode::Open {
                continue;
            }
            // The start first: where its numbers are not finite, neither are the series.
            let start = (state.speed(), of.load[0], state.memory.clone());
            let along = quarters(2.0 * step).map(|t| {
                let memory = of.memories.iter().map(|z| z.at(t));
                (of.speeds.at(t), of.load.at(t), memory.collect())
            });
            for (speed, load, memory) in std::iter::once(start).chain(along) {
                let memory: &Vec<f64> = &memory;
                let slip = state.slip(speed.max(0.0));
                let at = &|j: usize| memory[j];
                let (motion, value) = match slip {
                    Some(slip) => {
                        let value = contact.law.coefficient(slip, at) * slip.direction;
                        (Motion::Slip(slip), value)
                    }
                    None => {
                        let limits = contact.law.limits(at).unwrap_or([0.0; 2]);
                        (Motion::Stick, larger_finite(limits))
                    }
                };
                let mut numbers = vec![value];
                let take = &mut |_, rate| numbers.push(rate);
                contact
                    .law
                    .rates(motion, load / contact.compliance, at, take);
                let given = memory.iter().chain([&speed, &load]);
                if given.into_iter().all(|x| x.is_finite())
                    && let Some(&value) = numbers.iter().find(|x| !x.is_finite())
                {
                    let speed = slip.map_or(0.0, |_| speed);
                    let reached = Some(reached);
                    return Error::NonFiniteFriction {
                        speed,
                        value,
                        reached,
                    };
                }
            }
        }
        match singular_force(&self.model, &self.series) {
            Some(fault) => fault.at(reached),
            None => Error::StepUnderflow { step, reached },
        }
    }
}

/// The shared contacts that came to rest or to a bound of their bands at the end of a step of
/// length h, of which these are the series. A contact that others held at rest in the step did not
/// come to rest.
fn triggers(model: &Model<'_>, situation: &Situation, series: &Series, h: f64) -> Vec<Trigger> {
    let has_moved = |c: usize| {
        let (contact, of) = (&model.contacts[c], &series.contacts[c]);
        let velocity = |j: usize| series.coordinates[j].motion.velocity(0);
        let size = contact.size_along(velocity) + of.surface[0].abs();
        of.speeds.at(0.5 * h).abs() > ROUNDING * size
    };
    let trigger = |&c: &usize| {
        let state = &situation.contacts[c];
        match state.edge {
            Edge::On(Some(side), _) => {
                let distance = Edge::Away.distance(&series.contacts[c], side);
                let rate = -distance.derivative().at(h);
                Some(Trigger::Bound(vec![(c, side.sign())], rate))
            }
            _ => {
                let passes = matches!(state.phase, Phase::Slip { speed: 0.0, .. });
                ((passes || state.has_arrived()) && has_moved(c)).then_some(Trigger::Rest(c))
            }
        }
    };
    let of_mechanism = |mechanism: &Mechanism| {
        let Edge::On(Some(side), _) = mechanism.edge else {
            return None;
        };
        let distance = mechanism.distance(model, series, side);
        let rate = -distance.derivative().at(h);
        Some(Trigger::Bound(mechanism.weights(model, side), rate))
    };
    let contacts = model.shared.iter().filter_map(trigger);
    let mechanisms = situation.mechanisms.iter().filter_map(of_mechanism);
    contacts.chain(mechanisms).collect()
}
