//! Poincaré sections: the states of a motion once in each period, or at each event of one kind.

use std::fmt;

use super::oscillator::Oscillator;
use crate::error::{Error, Reached};
use crate::motion::sealed::State as _;
use crate::motion::{Event, EventKind, Integrator, Segment, SystemState};

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
    let exists = contact < system.form().model.contacts.len();
    let checked = Error::check(
        "orbit::section_at",
        "contact",
        contact as f64,
        exists,
        "a contact of the system",
    );
    EventSection {
        steps: Steps::new(system, start, checked),
        contact,
        kind,
    }
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
