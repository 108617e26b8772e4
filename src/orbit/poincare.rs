//! Poincaré sections: the states of a motion once in each period, at each event of one kind, or
//! where the sliding speed of a contact passes a value.

use std::collections::VecDeque;
use std::fmt;

use super::oscillator::Oscillator;
use crate::error::{Error, Reached};
use crate::motion::sealed::{Part as _, State as _};
use crate::motion::{Event, EventKind, Integrator, Segment, SystemState};
use crate::series::PowerSeries;

/// Steps without an item after which a section returns an error.
const PATIENCE: usize = Integrator::DEFAULT_MAX_STEPS;

/// The steps of a motion, and the number of steps since the last item.
struct Steps<'s, S: Oscillator + 's> {
    /// The steps, or the error of the start until it is returned.
    flow: Result<S::Flow<'s>, Option<Error>>,
    count: usize,
}

impl<'s, S: Oscillator> Steps<'s, S> {
    fn new(system: &'s S, start: &S::State, checked: Result<f64, Error>) -> Self {
        let flow = checked.and_then(|_| Integrator::new().flow(system, start.clone()));
        Self {
            flow: flow.map_err(Some),
            count: 0,
        }
    }

    /// The next step; an error ends the motion.
    fn next(&mut self) -> Option<Result<<S::State as SystemState>::Step, Error>> {
        let flow = match &mut self.flow {
            Ok(flow) => flow,
            Err(error) => return error.take().map(Err),
        };
        let step = match flow.next()? {
            Ok(step) => step,
            Err(error) => {
                self.flow = Err(None);
                return Some(Err(error));
            }
        };
        self.count += 1;
        if self.count > PATIENCE {
            self.flow = Err(None);
            return Some(Err(Error::TooManySteps {
                limit: PATIENCE,
                reached: Reached::new(step.end_time(), step.end_state().general()),
            }));
        }
        Some(Ok(step))
    }
}

/// The states of a motion once in each period; returned by [`section`].
pub struct Section<'s, S: Oscillator + 's> {
    steps: Steps<'s, S>,
    step: Option<<S::State as SystemState>::Step>,
    period: f64,
    /// Number of the next state.
    number: u64,
}

/// Poincaré section of the motion from a start at time 0: the states at the times T, 2T, 3T, …,
/// with a given period T. The iterator is unbounded and takes constant memory.
///
/// The k-th time is the exact product kT, so the phase of a drive is still exact after 10⁶ periods.
///
/// If the period or the start is not valid, the only item is the error.
///
/// # Errors
///
/// An item is [`Error::InvalidParameter`] unless T is positive and finite, [`Error::TooManySteps`]
/// if a period takes more than 10⁵ steps, or an error of [`Integrator::flow`]. After an error the
/// iterator returns `None`.
///
/// ```
/// use stick_slip::orbit;
/// use stick_slip::structure::State;
/// use stick_slip::{Contact, Coulomb, Drive, Structure};
///
/// // x'' + 0.1 x' + x = cos 0.8 t − 0.3 sgn x'.
/// let block = Structure::new(&[1.0])?
///     .with_ground_spring(0, 1.0)?
///     .with_ground_damper(0, 0.1)?
///     .with_force(0, Drive::harmonic(1.0, 0.8, 0.0)?)?
///     .with_contact(Contact::new(0, Coulomb::new(0.3, 0.3)?, 1.0)?)?;
/// let period = block.period().ok_or("not driven")?;
/// let states = orbit::section(&block, &State::at_rest(1), period);
/// let places: Vec<f64> = states
///     .take(60)
///     .map(|state| Ok(state?.displacements[0]))
///     .collect::<Result<_, stick_slip::Error>>()?;
/// // One point: the motion has become periodic.
/// assert!((places[59] - places[58]).abs() < 1e-14);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[doc(alias = "Poincaré")]
#[doc(alias = "Poincare")]
#[doc(alias = "stroboscopic map")]
pub fn section<'s, S: Oscillator>(system: &'s S, start: &S::State, period: f64) -> Section<'s, S> {
    let checked = Error::check(
        "orbit::section",
        "period",
        period,
        period > 0.0,
        "period > 0",
    );
    Section {
        steps: Steps::new(system, start, checked),
        step: None,
        period,
        number: 1,
    }
}

impl<S: Oscillator> Iterator for Section<'_, S> {
    type Item = Result<S::State, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        let count = self.number as f64;
        let time = count * self.period;
        let rest = count.mul_add(self.period, -time);
        loop {
            if let Some(step) = &self.step
                && time <= step.end_time()
            {
                self.number += 1;
                self.steps.count = 0;
                let since = step.since_start(time) + rest;
                return Some(Ok(step.state_at(since.clamp(0.0, step.duration()))));
            }
            match self.steps.next()? {
                Ok(step) => self.step = Some(step),
                Err(error) => return Some(Err(error)),
            }
        }
    }
}

/// The events of one kind at one contact of a motion; returned by [`section_at`].
pub struct EventSection<'s, S: Oscillator + 's> {
    steps: Steps<'s, S>,
    contact: usize,
    kind: EventKind,
}

/// Every event of one kind at one contact, in the motion from a start at time 0: a Poincaré section
/// for autonomous motions. Each event is computed when the iterator reaches it, in constant memory.
///
/// The iterator ends if the motion reaches an equilibrium and stays there.
///
/// # Errors
///
/// An item is [`Error::InvalidParameter`] if the contact does not exist, [`Error::TooManySteps`] if
/// 10⁵ steps contain no such event, or an error of [`Integrator::flow`]. After an error the
/// iterator returns `None`.
///
/// ```
/// use stick_slip::{EventKind, MassOnBelt, Polynomial, orbit};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let mut sticks = orbit::section_at(&system, &(0.0, 0.0).into(), 0, EventKind::Stick).skip(3);
/// let (one, next) = (sticks.next().unwrap()?, sticks.next().unwrap()?);
/// assert!((next.time - one.time - 6.799421444472158).abs() < 1e-13);
/// assert!((next.state.displacement - 0.05408831101199527).abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn section_at<'s, S: Oscillator>(
    system: &'s S,
    start: &S::State,
    contact: usize,
    kind: EventKind,
) -> EventSection<'s, S> {
    EventSection {
        steps: Steps::new(system, start, exists(system, "orbit::section_at", contact)),
        contact,
        kind,
    }
}

/// The number of a contact, unless the system has no such contact.
fn exists(system: &impl Oscillator, of: &'static str, contact: usize) -> Result<f64, Error> {
    let exists = contact < system.form().model.contacts.len();
    let allowed = "a contact of the system";
    Error::check(of, "contact", contact as f64, exists, allowed)
}

impl<S: Oscillator> Iterator for EventSection<'_, S> {
    type Item = Result<Event<S::State>, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            let step = match self.steps.next()? {
                Ok(step) => step,
                Err(error) => return Some(Err(error)),
            };
            let mut events = step.events().iter();
            let found = events
                .find(|event| event.contact() == Some(self.contact) && event.kind == self.kind);
            if let Some(event) = found {
                self.steps.count = 0;
                return Some(Ok(event.with_state(event.state.clone())));
            }
        }
    }
}

/// A passage of the sliding speed of a contact through a value: an item of [`section_through`].
#[derive(Debug, Clone, PartialEq)]
pub struct Passage<S> {
    /// Time of the passage, in the units of the system.
    pub time: f64,
    /// State at this time.
    pub state: S,
    /// True if the contact becomes faster.
    pub rises: bool,
}

/// The passages of the sliding speed of a contact through a value; returned by [`section_through`].
pub struct SpeedSection<'s, S: Oscillator + 's> {
    steps: Steps<'s, S>,
    contact: usize,
    speed: f64,
    /// Whether the contact was faster at the end of the last step.
    was_faster: Option<bool>,
    /// Passages of the last step.
    passages: VecDeque<Passage<S::State>>,
}

/// Every passage of the sliding speed |r| of a contact through a value V > 0, in the motion from a
/// start at time 0: a Poincaré section also where a contact never sticks, as under
/// [`RateState`](crate::RateState) friction.
///
/// r is the relative velocity of the contact, and V is in units of velocity. The speed passes V in
/// both directions ([`Passage::rises`]); neither a start at V nor a touch counts. Passages are
/// isolated roots of power series, exact to the last bit, and none is missed. Where r jumps with a
/// belt velocity, it may jump through V. (r = 0 is an event: see [`section_at`].)
///
/// Each passage is computed when the iterator reaches it, in constant memory. The iterator ends if
/// the motion reaches an equilibrium and stays there.
///
/// # Errors
///
/// An item is [`Error::InvalidParameter`] if the contact does not exist or unless V is positive and
/// finite, [`Error::TooManySteps`] if 10⁵ steps contain no passage, or an error of
/// [`Integrator::flow`]. After an error the iterator returns `None`.
///
/// ```
/// use stick_slip::orbit::{self, Period};
/// use stick_slip::{Contact, RateState, Structure, structure::State};
///
/// // Earthquakes of a fault, by the square metre.
/// let (plate, radiation) = (1e-9, 4.6e6);
/// let law = RateState::aging(0.6, 0.01, 0.015, 8e-3, 1e-6)?;
/// let fault = Structure::new(&[3.90625e6])?
///     .with_ground_spring(0, 1.5625e7)?
///     .with_ground_damper(0, radiation)?
///     .with_force(0, radiation * plate)?
///     .with_contact(Contact::new(0, law, 5e7)?.on_belt(plate))?;
/// let start = State::new(&[1.92], &[0.0]).with_memory(&[6.9]).with_sliding(0, -1.2e-9);
///
/// // The third and fourth time at which the fault becomes slower than 1e-10 m/s.
/// let passages = orbit::section_through(&fault, &start, 0, 1e-10);
/// let mut slower = passages.filter(|passage| passage.as_ref().is_ok_and(|p| !p.rises)).skip(2);
/// let (one, next) = (slower.next().unwrap()?, slower.next().unwrap()?);
/// let orbit = orbit::shoot(&fault, &one.state, Period::Free(next.time - one.time))?;
/// assert!((orbit.period() / 5.81267700583e8 - 1.0).abs() < 1e-11);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "threshold")]
pub fn section_through<'s, S: Oscillator>(
    system: &'s S,
    start: &S::State,
    contact: usize,
    speed: f64,
) -> SpeedSection<'s, S> {
    const OF: &str = "orbit::section_through";
    let checked = exists(system, OF, contact);
    let checked = checked.and_then(|_| Error::check(OF, "speed", speed, speed > 0.0, "speed > 0"));
    SpeedSection {
        steps: Steps::new(system, start, checked),
        contact,
        speed,
        was_faster: None,
        passages: VecDeque::new(),
    }
}

/// The times since the start of a step at which |r| passes a value, and `true` where it rises.
fn passages(relative: &PowerSeries, speed: f64, h: f64) -> Vec<(f64, bool)> {
    let mut passages = Vec::new();
    // In equilibrium nothing changes.
    if h.is_finite() {
        for side in [1.0, -1.0] {
            let beyond = relative.scaled(side).minus(speed);
            beyond.sign_changes(h, &mut |t, rises| {
                passages.push((t, rises));
            });
        }
        passages.sort_by(|(one, _), (other, _)| one.total_cmp(other));
    }
    passages
}

impl<S: Oscillator> SpeedSection<'_, S> {
    /// Adds the passages of a step.
    fn meet(&mut self, step: &<S::State as SystemState>::Step) {
        /// A part of the speed by which two steps may differ where they meet.
        const ROUNDING: f64 = 1e-9;
        let Some(relative) = step.relative_velocity(self.contact) else {
            return;
        };
        let mut passages = passages(&relative, self.speed, step.duration());
        let beyond = |t: f64| relative.at(t).abs() - self.speed;
        let is_near = |t: f64| beyond(t).abs() <= ROUNDING * self.speed;
        let starts_faster = match passages.first() {
            Some((_, rises)) => !rises,
            None => {
                let middle = 0.5 * step.duration();
                let middle = if middle.is_finite() { middle } else { 0.0 };
                // At V, as at a start, rounding has no side.
                if is_near(middle) {
                    return;
                }
                beyond(middle) > 0.0
            }
        };
        let ends_faster = passages.last().map_or(starts_faster, |last| last.1);
        if self.was_faster != Some(starts_faster) {
            // A passage near the end of the last step, or a start, may be seen again.
            match passages.first() {
                Some(&(t, _)) if is_near(0.0) && is_near(0.5 * t) => _ = passages.remove(0),
                _ if self.was_faster.is_some() => passages.insert(0, (0.0, starts_faster)),
                _ => (),
            }
        }
        self.was_faster = Some(ends_faster);
        self.passages
            .extend(passages.into_iter().map(|(t, rises)| Passage {
                time: (step.start_time() + t).min(step.end_time()),
                state: step.state_at(t),
                rises,
            }));
    }
}

impl<S: Oscillator> Iterator for SpeedSection<'_, S> {
    type Item = Result<Passage<S::State>, Error>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(passage) = self.passages.pop_front() {
                self.steps.count = 0;
                return Some(Ok(passage));
            }
            match self.steps.next()? {
                Ok(step) => self.meet(&step),
                Err(error) => return Some(Err(error)),
            }
        }
    }
}

impl<S: Oscillator> fmt::Debug for Section<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Section")
            .field("period", &self.period)
            .field("number", &self.number)
            .finish_non_exhaustive()
    }
}

impl<S: Oscillator> fmt::Debug for EventSection<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("EventSection")
            .field("contact", &self.contact)
            .field("kind", &self.kind)
            .finish_non_exhaustive()
    }
}

impl<S: Oscillator> fmt::Debug for SpeedSection<'_, S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SpeedSection")
            .field("contact", &self.contact)
            .field("speed", &self.speed)
            .finish_non_exhaustive()
    }
}
