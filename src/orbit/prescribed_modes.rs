//! Held motions. A touch is a local minimum near 0 of the sliding speed s of a slipping contact, at
//! a time t*. A contact is held if its mode is prescribed past the touch instead of decided by the
//! sign of s.
//!
//! A held motion is a smooth function of g = s(t*). Past a touch the held contact continues to slip
//! for either sign of g, on the series of its step, which continue its law to small negative
//! speeds, perhaps after a stick of duration 0. At the tangential end of a branch it sticks from t*
//! on. Without holding, the motion depends on the time of arrival (the root of s), which varies
//! like √|g|. Held motions are real motions at g = 0, and past a touch also for g > 0.

use super::type_erased_system::GeneralForm;
use crate::error::Error;
use crate::motion::sealed::Part as _;
use crate::motion::step_control::reach;
use crate::motion::{EventKind, Integrator, Mode, Segment};
use crate::series::{PowerSeries, TERMS};
use crate::state::Direction;
use crate::state::structure::State;
use crate::structure::engine::contact_data::entry;
use crate::structure::engine::instant::{AtContact, Forces};
use crate::structure::{Flow, Step};

use std::ops::ControlFlow;

/// A contact that is held from a minimum of its sliding speed on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Hold {
    /// The place of this hold among the holds of one motion.
    pub(super) number: usize,
    pub(super) contact: usize,
    /// The direction in which it slips.
    pub(super) side: Direction,
    /// The approximate time since the start of the motion, and the largest distance from this time.
    pub(super) since: f64,
    pub(super) within: f64,
    pub(super) then: Then,
}

/// The motion of a held contact from the minimum of its sliding speed on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Then {
    Slips,
    /// The contact slips on after a stick of duration 0. The motion is that of a contact that
    /// slips, but perturbations lose their slip at the contact, as at the begin of any stick.
    SlipsAfterRest,
    Sticks,
}

/// A touch of a motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Touch {
    pub(super) hold: Hold,
    /// The sliding speed g, below 0 beyond the touch.
    pub(super) speed: f64,
    /// True if the derivative of the real motion is unbounded there.
    pub(super) is_unbounded: bool,
}

impl Hold {
    /// Returns this hold for a motion over a period that begins later.
    pub(super) fn later(self, by: f64, period: f64) -> Self {
        let since = (self.since - by).rem_euclid(period);
        Self { since, ..self }
    }

    /// Returns true if the contact may rest at the touch for no time: its static friction is not
    /// larger than the kinetic one, and nothing remembers the rest.
    pub(super) fn may_rest(&self, form: &GeneralForm<'_>, state: &State) -> bool {
        let remembers = !form.model.memory(self.contact).is_empty();
        !remembers && common_limit(form, self.contact, self.side, state).is_some()
    }

    /// The sliding speed along a step, if the contact slips there in its direction.
    pub(super) fn speeds(&self, step: &Step) -> Option<PowerSeries> {
        let slips = step.modes().get(self.contact) == Some(&Mode::Slip(self.side));
        slips.then(|| speeds(step, self.contact, self.side))
    }
}

/// The sliding speed of a contact along a step, in a direction.
pub(super) fn speeds(step: &Step, contact: usize, side: Direction) -> PowerSeries {
    let relative = step.relative_velocity(contact);
    relative.map_or(PowerSeries::ZERO, |relative| relative.scaled(side.sign()))
}

/// Calls a function with each minimum of the sliding speed of a contact within slip: the step, the
/// time since its start, the direction of slip and the speed along the step. The steps are those of
/// a closed motion, of which the end and the start are one.
pub(super) fn minima_in_slip(
    steps: &[Step],
    contact: usize,
    take: &mut dyn FnMut(&Step, f64, Direction, &PowerSeries),
) {
    /// After a release the speed rises from 0, with a slope of 0 to rounding: for this part of the
    /// period such a rise is no minimum.
    const ROUNDING: f64 = 1e-9;
    let period: f64 = steps.iter().map(Segment::duration).sum();
    let slip = |step: &Step| match step.modes()[contact] {
        Mode::Slip(side) => Some((side, speeds(step, contact, side))),
        _ => None,
    };
    let falling = |step: &Step| {
        let (side, speeds) = slip(step)?;
        Some((side, speeds.slope_at(step.duration()) < 0.0))
    };
    let lasting = |step: &&Step| step.duration() > 0.0 && !step.series().is_empty();
    // The direction before a step, and whether the speed falls there.
    let mut before = steps.iter().rfind(lasting).and_then(falling);
    for step in steps.iter().filter(|step| !step.series().is_empty()) {
        let Some((side, speeds)) = slip(step).filter(|_| step.duration() > 0.0) else {
            before = None;
            continue;
        };
        if before == Some((side, true)) && speeds[1] >= 0.0 {
            take(step, 0.0, side, &speeds);
        }
        let slope = speeds.derivative();
        slope.sign_changes(step.duration(), &mut |t, rises| {
            if rises && (before.is_some() || t > ROUNDING * period) {
                take(step, t, side, &speeds);
            }
        });
        before = falling(step);
    }
}

/// The static coefficient of a contact against slip to a side, if it equals the kinetic one at
/// speed 0.
fn common_limit(
    form: &GeneralForm<'_>,
    contact: usize,
    side: Direction,
    state: &State,
) -> Option<f64> {
    /// Largest relative difference of equal coefficients.
    const SAME: f64 = 1e-9;
    let memory = &state.memory[form.model.memory(contact)];
    let (kinetic, limits) = form.model.contacts[contact].coefficients_at_rest(side, memory);
    let limit = limits.map(|limits| limits[side.place()]);
    limit.filter(|limit| (limit - kinetic).abs() <= SAME * limit.abs())
}

/// The time of the minimum of a speed that falls at a time, behind that time.
pub(super) fn minimum_behind(speeds: &PowerSeries, from: f64) -> Option<f64> {
    const MOST_STEPS: usize = 40;
    let slope = speeds.derivative();
    let mut time = from;
    for _ in 0..MOST_STEPS {
        let step = -slope.at(time) / slope.slope_at(time);
        let next = time + step;
        if !(next.is_finite() && slope.slope_at(time) > 0.0) {
            return None;
        }
        if next == time || step.abs() <= f64::EPSILON * time {
            break;
        }
        time = next.max(from);
    }
    Some(time)
}

/// The time up to which the series of a step hold to rounding, or nearly so.
fn reach_of(step: &Step, n: usize) -> f64 {
    /// A little beyond, rounding grows by two digits.
    const BEYOND: f64 = 1.2;
    let ends = [step.state().clone(), step.end_state()];
    let velocities = ends.iter().flat_map(|state| &state.velocities);
    let size = velocities.fold(0.0, |size: f64, v| size.max(v.abs()));
    let series = step.series().iter().enumerate();
    let reached = series.map(|(i, series)| {
        let size = if i < n {
            size
        } else {
            series.largest_change(step.duration())
        };
        let last = &series.coefficients()[TERMS - 2..];
        if last.iter().all(|c| *c == 0.0) {
            return f64::INFINITY;
        }
        reach(f64::EPSILON * size, series, TERMS - 1)
    });
    BEYOND * reached.fold(f64::INFINITY, f64::min)
}

/// The steps of a motion with contacts held.
#[derive(Debug)]
pub(super) struct HeldFlow<'s> {
    form: &'s GeneralForm<'s>,
    settings: Integrator,
    flow: Flow<'s>,
    start_time: f64,
    /// The holds to come, each with the slope of its speed at the end of the last step.
    holds: Vec<(Hold, f64)>,
    pub(super) touches: Vec<Touch>,
    /// A contact that has come to rest for no time at the start of the last step.
    pub(super) touched: Option<usize>,
    /// The rest of a step that was divided at the touch of a contact.
    rest: Option<(usize, Step)>,
    /// Number of steps begun anew.
    renewed: usize,
}

/// Limit of steps begun anew, nearer to a touch, in one motion.
const MOST_RENEWED: usize = 16;

impl<'s> HeldFlow<'s> {
    pub(super) fn new(
        form: &'s GeneralForm<'s>,
        settings: Integrator,
        start_time: f64,
        start: &State,
        holds: &[Hold],
    ) -> Result<Self, Error> {
        let settings = settings.with_start_time(start_time)?;
        Ok(Self {
            form,
            settings,
            flow: Flow::new(settings, form.model.clone(), start)?,
            start_time,
            holds: holds.iter().map(|hold| (*hold, 0.0)).collect(),
            touches: Vec::new(),
            touched: None,
            rest: None,
            renewed: 0,
        })
    }

    /// Begins anew at the end of a step, with the modes of its contacts, of which one sticks.
    fn begin_at_end(&mut self, step: &Step, sticks: Option<Hold>) -> Result<State, Error> {
        let (time, mut state) = (step.end_time(), step.end_state());
        let rests = |c: usize| sticks.is_some_and(|hold| hold.contact == c);
        let mode = |c: usize| {
            if rests(c) {
                Mode::Stick
            } else {
                step.modes()[c]
            }
        };
        self.form.put_in_modes(&mut state, time, &|c| Some(mode(c)));
        if let Some(hold) = sticks {
            self.put_on_limit(&mut state, step, hold);
        }
        let mut start = state.clone();
        if let Some(hold) = sticks {
            let memory = self.form.model.memory(hold.contact);
            let law = self.form.model.contacts[hold.contact].law;
            law.caught(&mut start.memory[memory]);
        }
        let settings = self.settings.with_start_time(time)?;
        self.flow = Flow::new(settings, self.form.model.clone(), &start)?;
        Ok(state)
    }

    /// Notes a touch at a time of a step.
    fn note(&mut self, place: usize, time: f64, speed: f64) -> Hold {
        let (hold, _) = self.holds.remove(place);
        let since = time - self.start_time;
        let hold = Hold { since, ..hold };
        let model = &self.form.model;
        let remembers = !model.memory(hold.contact).is_empty();
        let is_unbounded =
            hold.then == Then::Sticks && (remembers || model.owner_of(hold.contact).is_none());
        self.touches.push(Touch {
            hold,
            speed,
            is_unbounded,
        });
        hold
    }

    /// The step, past the touches within it and at its end.
    fn held(&mut self, mut step: Step) -> Result<Step, Error> {
        let mut place = 0;
        while place < self.holds.len() {
            let (hold, falling) = self.holds[place];
            let Some(speeds) = hold.speeds(&step) else {
                self.holds[place].1 = 0.0;
                place += 1;
                continue;
            };
            self.holds[place].1 = speeds.slope_at(step.duration());
            let near = |t: f64| {
                let since = step.start_time() + t - self.start_time;
                (since - hold.since).abs() <= hold.within
            };
            let mut found = (falling < 0.0 && speeds[1] >= 0.0 && near(0.0)).then_some(0.0);
            if found.is_none() {
                let slope = speeds.derivative();
                let _ = slope.search_sign_changes(step.duration(), &mut |t, rises| {
                    if rises && near(t) {
                        found = Some(t);
                        return ControlFlow::Break(());
                    }
                    ControlFlow::Continue(())
                });
            }
            if let Some(t) = found {
                let hold = self.note(place, step.start_time() + t, speeds.at(t));
                match hold.then {
                    Then::Sticks => return self.caught(step.lasting(t), hold),
                    Then::SlipsAfterRest => return Ok(self.divided(step, t, hold)),
                    Then::Slips => continue,
                }
            }
            let mut events = step.events().iter();
            let ends = |kind| matches!(kind, EventKind::Stick | EventKind::Crossing(_));
            let arrives =
                events.any(|event| event.contact() == Some(hold.contact) && ends(event.kind));
            if arrives
                && near(step.duration())
                && let Some(t) = minimum_behind(&speeds, step.duration())
                && near(t)
            {
                let past = match hold.then {
                    Then::Sticks => t,
                    Then::Slips | Then::SlipsAfterRest => self.past(&step, &hold, t),
                };
                if past > reach_of(&step, self.form.len()) && self.renewed < MOST_RENEWED {
                    self.renewed += 1;
                    let back = (2.0 * step.duration() - past).max(0.5 * step.duration());
                    step = step.lasting(back);
                    self.begin_at_end(&step, None)?;
                    self.holds[place].1 = speeds.slope_at(back);
                    return Ok(step);
                }
                let hold = self.note(place, step.start_time() + t, speeds.at(t));
                if hold.then == Then::Sticks {
                    return self.caught(step.lasting(t), hold);
                }
                step = step.lasting(past);
                self.begin_at_end(&step, None)?;
                return Ok(match hold.then {
                    Then::SlipsAfterRest => self.divided(step, t, hold),
                    _ => step,
                });
            }
            place += 1;
        }
        Ok(step)
    }

    /// The part of a step up to a touch. The rest is the next step.
    fn divided(&mut self, step: Step, touch: f64, hold: Hold) -> Step {
        if touch <= 0.0 {
            self.touched = Some(hold.contact);
            return step;
        }
        self.rest = Some((hold.contact, step.clone().from(touch)));
        step.lasting(touch)
    }

    /// The step at whose end a contact sticks.
    fn caught(&mut self, step: Step, hold: Hold) -> Result<Step, Error> {
        let state = self.begin_at_end(&step, Some(hold))?;
        Ok(step.coming_to_rest(hold.contact, state))
    }

    /// Sets the force of a contact that came to rest to its static limit, if this limit equals the
    /// kinetic friction at speed 0. The force of the held motion differs from the limit by about g
    /// in either direction.
    ///
    /// After this time the force stays below the limit; otherwise the real contact would not stick
    /// either.
    fn put_on_limit(&self, state: &mut State, step: &Step, hold: Hold) {
        let model = &self.form.model;
        let contact = &model.contacts[hold.contact];
        let Some(limit) = common_limit(self.form, hold.contact, hold.side, state) else {
            return;
        };
        let Some(i) = model.owner_of(hold.contact) else {
            return;
        };
        let at = Forces::of(model, step).beside(step.duration(), state.clone());
        let AtContact {
            load,
            carried,
            surface_rate,
            ..
        } = at.contacts[hold.contact];
        let friction = hold.side.sign() * limit * load;
        let rate = at.accelerations[i] + contact.compliance * (carried - friction);
        let beyond = rate - surface_rate;
        let gradient = entry(&contact.load_gradient, i);
        let by_load = hold.side.sign() * limit * gradient * contact.compliance;
        let mut stiffness = model.stiffness.row(i).0 + by_load;
        for (e, element) in model.forces_and_stops().enumerate() {
            let tangent = element.tangent(&state.displacements, &state.velocities);
            let slopes = std::iter::zip(&*element.directions, &tangent.slopes);
            for (direction, slopes) in slopes {
                for (response, slope) in std::iter::zip(&element.responses, slopes) {
                    let push = at.elements[e].factor[0] * entry(response, i);
                    stiffness += push * entry(direction, i) * slope;
                }
            }
        }
        for (contact, mode) in std::iter::zip(&model.contacts, step.modes()) {
            if *mode != Mode::Open {
                stiffness += entry(&contact.reaction, i) * entry(&contact.load_gradient, i);
            }
        }
        if stiffness != 0.0 {
            state.displacements[i] += beyond / stiffness;
        }
    }

    /// A time of a step behind a touch at a time of it, when the contact slips again as before.
    fn past(&self, step: &Step, hold: &Hold, touch: f64) -> f64 {
        let speeds = speeds(step, hold.contact, hold.side);
        let below = touch - step.duration();
        let times = [2.0, 3.0, 4.0].map(|part| touch + part * below);
        let mut slips = times.into_iter().filter(|t| speeds.at(*t) > 0.0);
        slips.next().unwrap_or(times[2])
    }
}

impl Iterator for HeldFlow<'_> {
    type Item = Result<Step, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let (contact, step) = self.rest.take().unzip();
        self.touched = contact;
        let step = step.map_or_else(|| self.flow.next(), |step| Some(Ok(step)))?;
        if self.holds.is_empty() {
            return Some(step);
        }
        Some(step.and_then(|step| {
            if step.duration() > 0.0 && !step.series().is_empty() {
                self.held(step)
            } else {
                Ok(step)
            }
        }))
    }
}
