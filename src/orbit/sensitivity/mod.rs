//! Derivatives with respect to parameters: of motions, of the times of events, and of periodic
//! motions.

mod differences;
mod neighbour;

use std::cell::{Cell, RefCell};

use nalgebra::{DMatrix, DVector};

use self::differences::Variation;
use self::neighbour::Run;
use super::oscillator::{FamilyMember, Oscillator, member};
use super::period::Period;
use super::period_map::SINGULAR;
use super::period_map::run::period_map;
use super::period_map::{PeriodMap, longest_pause, state, vector};
use super::periodic_orbit::Orbit;
use super::type_erased_system::GeneralForm;
#[cfg(doc)]
use crate::error::NotDifferentiable;
use crate::error::{Element, Error};
use crate::motion::sealed::State as _;
use crate::motion::{Event, EventKind, Segment};
use crate::numerics::least_norm::least_norm;
use crate::search::{Search, Watched};
use crate::state::structure::State;

/// A motion with its derivatives with respect to parameters; returned by [`sensitivities`].
#[derive(Debug, Clone)]
pub struct Sensitivities {
    here: Run,
    variations: Vec<Variation>,
    begin: f64,
    order: usize,
}

/// An event with the derivatives of its time; see [`Sensitivities::events`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct EventSensitivity {
    /// The time of the event, in units of time.
    pub time: f64,
    /// The element at which the event happens.
    pub element: Element,
    /// The kind of event.
    pub kind: EventKind,
    /// The derivative ∂t/∂p of the time with respect to each parameter p, in units of time per unit
    /// of the parameter. NaN if only the states have a derivative, for one of two reasons. Another
    /// contact has an event at the same instant, and the time of this event depends on which of
    /// them happens first. Or the contact only just sticks or slips, and the time changes like the
    /// square root of the change of the parameter.
    pub by_parameters: Vec<f64>,
}

/// A periodic motion with its derivatives with respect to parameters; returned by
/// [`orbit_sensitivities`].
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct OrbitSensitivities {
    /// The derivative ∂T/∂p of the period T with respect to each parameter p.
    pub period: Vec<f64>,
    /// The motion over one period with its derivatives. The motion begins between two events, at
    /// the first of [`Sensitivities::times`]. The beginning may lie later on the orbit than
    /// [`Orbit::state`]. For an autonomous motion times are counted from the beginning, and the
    /// derivative of the state at the beginning is normal to the flow.
    pub motion: Sensitivities,
}

/// The motion for values of the parameters, at least up to a given number of events.
type Runs<'r> = dyn Fn(&[f64], usize) -> Result<Run, Error> + 'r;

impl Sensitivities {
    /// The times at which the motion begins and ends, in units of time.
    pub fn times(&self) -> [f64; 2] {
        [self.begin, self.here.end]
    }

    /// The state at a time; `None` if the time lies outside the motion or is NaN.
    pub fn state_at(&self, time: f64) -> Option<State> {
        let inside = (self.begin..=self.here.end).contains(&time);
        inside.then(|| self.here.state_at(self.here.passed(time), time))?
    }

    /// The derivatives of the state at a time. The matrix has a row for each displacement, then for
    /// each velocity, then for each memory variable. It has a column for each parameter. Entries
    /// are in units of the variable per unit of the parameter. The result is `None` if the time
    /// lies outside the motion or is NaN.
    ///
    /// The derivative is taken at a fixed time. The derivative of a velocity jumps at an event; at
    /// the time of the event the result is the derivative just before the jump. If several contacts
    /// have events at this instant, it is the derivative just before the first of them.
    pub fn at(&self, time: f64) -> Option<DMatrix<f64>> {
        if !(self.begin..=self.here.end).contains(&time) {
            return None;
        }
        let columns = self.variations.iter().map(|by| by.at(&self.here, time));
        let columns: Vec<DVector<f64>> = columns.collect::<Option<_>>()?;
        if columns.is_empty() {
            return Some(DMatrix::zeros(self.order, 0));
        }
        Some(DMatrix::from_columns(&columns))
    }

    /// The events, with the derivatives of their times.
    pub fn events(&self) -> Vec<EventSensitivity> {
        let events = self.here.events.iter().enumerate();
        let by = |number: usize| {
            let time = move |run: &Run| {
                let time = run.events.get(number)?.time;
                Some(DVector::from_element(1, time))
            };
            let slope = |by: &Variation| {
                let found = (!by.timeless.contains(&number)).then(|| by.derivative(time));
                found.flatten().map_or(f64::NAN, |slope| slope[0])
            };
            self.variations.iter().map(slope).collect()
        };
        let event = |(number, event): (usize, &Event<State>)| EventSensitivity {
            time: event.time,
            element: event.element,
            kind: event.kind,
            by_parameters: by(number),
        };
        events.map(event).collect()
    }

    fn of(
        parameters: &[f64],
        begin: f64,
        order: usize,
        (run, work): (&Runs<'_>, &Work<'_>),
    ) -> Result<Self, Error> {
        let here = run(parameters, 0)?;
        // Each contact that sticks at the start may come to rest there in a neighbouring motion.
        let count = here.events.len() + here.sticking();
        let variations = (0..parameters.len()).map(|parameter| {
            let beside = |change: f64| {
                let mut parameters = parameters.to_vec();
                parameters[parameter] += change;
                let beside = run(&parameters, count)?;
                check_order(beside.order(), order)?;
                Ok(beside)
            };
            let found = Variation::of(&here, parameters[parameter], &beside);
            work.check()?;
            found.map_err(|reason| Error::NoDerivative { parameter, reason })
        });
        Ok(Self {
            variations: variations.collect::<Result<_, _>>()?,
            here,
            begin,
            order,
        })
    }
}

/// The work of all motions of one search.
struct Work<'w> {
    most: usize,
    watched: Watched<'w>,
    taken: Cell<usize>,
    /// The error of the motion that has reached the bound.
    ended: RefCell<Option<Error>>,
}

impl<'w> Work<'w> {
    fn new(search: &'w Search<'_>) -> Self {
        Self {
            most: search.steps_over_a_parameter(),
            watched: search.watch("time"),
            taken: Cell::new(0),
            ended: RefCell::new(None),
        }
    }

    /// Calls a function on one system, whose steps are counted.
    fn with<T>(
        &self,
        form: GeneralForm<'_>,
        find: impl FnOnce(&GeneralForm<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let form = form
            .within(self.most, &self.watched)
            .after(self.taken.get());
        let found = find(&form);
        self.taken.set(form.taken());
        if let (Err(error), true) = (&found, form.taken() >= self.most) {
            self.ended.borrow_mut().get_or_insert(error.clone());
        }
        found
    }

    /// The error if the bound is reached, or if the search was stopped.
    fn check(&self) -> Result<(), Error> {
        self.watched.check()?;
        self.ended.borrow().clone().map_or(Ok(()), Err)
    }
}

/// The motion of a family of systems over a duration, with its derivatives with respect to all
/// parameters: those of the state at any time, and those of the times of events.
///
/// `family` returns the system and its start at time 0 for values of the parameters. Parameters may
/// be anything that a closure can set: coefficients of a law, loads, stiffnesses, belt velocities,
/// the start itself.
///
/// Derivatives continue through sticks, releases and crossings, because neighbouring motions have
/// the same events at slightly different times. The power series of the neighbouring motion is
/// continued between the two times of an event. Both motions are then compared in the same modes,
/// and their difference has no jump. (Where a contact that [creeps](crate::ContactLaw::creeps)
/// changes its direction, no series reaches beyond the event: motions are compared at one time
/// since their own events.) The derivatives are difference quotients with an error of fourth order
/// in the increment; each motion is exact to rounding. The first increment of the parameter changes
/// the motion by about a thousandth of the motion's size. The increment is then divided by 4 again
/// and again, as long as the derivatives from two successive increments come closer to each other.
/// The error is about 1e-11 of the largest derivative, and below 1e-10 for all reference motions of
/// the tests. It is larger if the motion hardly depends on the parameter: its own rounding errors,
/// divided by the increment, then count. It is at most a thousandth, or the result is an error. The
/// difference is one-sided if the family returns an error on one side of the parameter, or if the
/// motion has other events there.
///
/// Several contacts may have events at the same instant: elements in parallel, symmetric masses,
/// or a contact that slips because another one sticks. In neighbouring motions these events happen
/// at the same instant, too, or one after another. If their order changes with the sign of the
/// increment, the derivatives of both sides are computed. The derivative exists if they agree (to
/// about 1e-7 of the largest derivative of displacements, of velocities and of memory variables),
/// and is their mean. The derivative with respect to the velocity of a mass that sticks at the
/// start is that of the motion after the mass has come to rest.
///
/// The work is about twenty motions for each parameter. [`Search::sensitivities`] takes a bound of
/// the work, and a watcher.
///
/// # Errors
///
/// * [`Error::InvalidDuration`] unless the duration is positive and finite;
/// * [`Error::InvalidParameter`] unless all parameters are finite;
/// * [`Error::NoDerivative`], with the number of the parameter and the reason
///   ([`NotDifferentiable`]): the motion has other events on both sides of the parameter, however
///   small the increment (as at grazing); the derivatives of both sides differ because events at
///   the same instant follow in another order; the family jumps or has a kink at the parameter; or
///   the family returns an error on both sides;
/// * [`Error::TooManySteps`] after 10⁷ steps of all motions;
/// * the errors of the family, and those of [`Integrator::simulate`](crate::Integrator::simulate).
///
/// ```
/// use stick_slip::orbit::sensitivities;
/// use stick_slip::structure::State;
/// use stick_slip::{Contact, Coulomb, Error, Structure};
///
/// // A block that slides until it stops: q = v0 t − μ g t²/2.
/// let family = |p: &[f64]| -> Result<(Structure, State), Error> {
///     let contact = Contact::new(0, Coulomb::new(p[0], p[0])?, 9.81 * p[1])?;
///     let block = Structure::new(&[p[1]])?.with_contact(contact)?;
///     Ok((block, State::new(&[0.0], &[p[2]])))
/// };
/// let [mu, mass, speed] = [0.3, 2.0, 1.5];
/// let found = sensitivities(family, &[mu, mass, speed], 1.0)?;
///
/// // The block stops after t = v0/(μ g), independent of its mass.
/// let [stop] = &found.events()[..] else { panic!() };
/// let time = speed / (mu * 9.81);
/// assert!((stop.time - time).abs() < 1e-15);
/// for (slope, expected) in stop.by_parameters.iter().zip([-time / mu, 0.0, time / speed]) {
///     assert!((slope - expected).abs() < 1e-10);
/// }
/// // The block slides over the distance v0²/(2 μ g).
/// let rest = found.at(1.0).unwrap();
/// assert!((rest[(0, 0)] + speed * speed / (2.0 * mu * mu * 9.81)).abs() < 1e-10);
/// assert_eq!(rest[(1, 0)], 0.0);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "gradient")]
#[doc(alias = "Jacobian")]
#[doc(alias = "fit")]
pub fn sensitivities<S: Oscillator>(
    family: impl Fn(&[f64]) -> Result<(S, S::State), Error>,
    parameters: &[f64],
    duration: f64,
) -> Result<Sensitivities, Error> {
    Search::new().sensitivities(family, parameters, duration)
}

/// A periodic motion of a family of systems, with its derivatives with respect to all parameters:
/// those of the period, of the state at any time, and of the times of events.
///
/// `family` returns the system for values of the parameters, and `orbit` is its motion for
/// `parameters`. The derivatives ∂x/∂p of the start and ∂T/∂p of the period follow from the exact
/// monodromy matrix M by
///
/// ```text
/// (M − 1) ∂x/∂p + x'(T) ∂T/∂p = −∂P/∂p,
/// ```
///
/// where P is the period map. For an autonomous motion ∂x/∂p is normal to the flow at the start. If
/// the motion belongs to a continuum, the solution ∂x/∂p of least norm is taken.
///
/// # Errors
///
/// The errors of [`sensitivities`]; [`Error::NotPeriodic`] if `orbit` is not a motion of the family
/// at `parameters`.
///
/// ```
/// use stick_slip::orbit::{self, Period};
/// use stick_slip::{Contact, Coulomb, Error, Structure, structure::State};
///
/// // Undamped stick-slip on a belt: T = 2z/v + (2/ω)(π − atan(ωz/v)), z = (μ_s − μ_k)N/k.
/// let family = |p: &[f64]| -> Result<Structure, Error> {
///     Structure::new(&[1.0])?
///         .with_ground_spring(0, 1.0)?
///         .with_contact(Contact::new(0, Coulomb::new(p[0], 0.3)?, 1.0)?.on_belt(p[1]))
/// };
/// let [mu_s, v]: [f64; 2] = [0.5, 0.2];
/// let start = State::new(&[0.5], &[0.2]);
/// let orbit = orbit::settle(&family(&[mu_s, v])?, &start, 0.0, Period::Free(6.5))?;
/// let found = orbit::orbit_sensitivities(family, &[mu_s, v], &orbit)?;
///
/// let z = mu_s - 0.3;
/// let slip = 2.0 * v / (v * v + z * z);
/// assert!((found.period[0] - (2.0 / v - slip)).abs() < 1e-9);
/// assert!((found.period[1] - (-2.0 * z / (v * v) + slip * z / v)).abs() < 1e-9);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn orbit_sensitivities<S: Oscillator>(
    family: impl Fn(&[f64]) -> Result<S, Error>,
    parameters: &[f64],
    orbit: &Orbit<S::State>,
) -> Result<OrbitSensitivities, Error> {
    Search::new().orbit_sensitivities(family, parameters, orbit)
}

impl Search<'_> {
    /// Calls the function [`sensitivities`] with the bound and the watcher of this search. The
    /// progress shows the time of the motion that is being computed.
    ///
    /// # Errors
    ///
    /// The errors of [`sensitivities`]; [`Error::Stopped`] if the watcher stops the search.
    pub fn sensitivities<S: Oscillator>(
        &self,
        family: impl Fn(&[f64]) -> Result<(S, S::State), Error>,
        parameters: &[f64],
        duration: f64,
    ) -> Result<Sensitivities, Error> {
        if !(duration > 0.0 && duration.is_finite()) {
            return Err(Error::InvalidDuration { value: duration });
        }
        check(parameters)?;
        let work = Work::new(self);
        let run = |parameters: &[f64], expected: usize| {
            let (system, start) = family(parameters)?;
            let start = start.general();
            work.with(system.form(), |form| {
                Run::of(form, (0.0, &start), duration, expected)
            })
        };
        let order = family(parameters)?.0.form().order();
        Sensitivities::of(parameters, 0.0, order, (&run, &work))
    }

    /// Calls the function [`orbit_sensitivities`] with the bound and the watcher of this search.
    ///
    /// # Errors
    ///
    /// The errors of [`orbit_sensitivities`]; [`Error::Stopped`] if the watcher stops the search.
    pub fn orbit_sensitivities<S: Oscillator>(
        &self,
        family: impl Fn(&[f64]) -> Result<S, Error>,
        parameters: &[f64],
        orbit: &Orbit<S::State>,
    ) -> Result<OrbitSensitivities, Error> {
        let family = |parameters: &[f64]| member(family(parameters));
        let (start, kind) = (orbit.state().general(), orbit.kind());
        of_orbit(self, &family, parameters, (&start, orbit.period(), kind))
    }
}

/// The systems of a family for values of its parameters.
type Members<'f> = dyn Fn(&[f64]) -> Result<Box<dyn FamilyMember + 'f>, Error> + 'f;

fn of_orbit(
    search: &Search<'_>,
    family: &Members<'_>,
    parameters: &[f64],
    (start_of_orbit, period, kind): (&State, f64, Period),
) -> Result<OrbitSensitivities, Error> {
    check(parameters)?;
    let work = Work::new(search);
    let system = family(parameters)?;
    let (order, n) = (system.form().order(), system.form().len());
    let is_free = matches!(kind, Period::Free(_));
    let whole = work.with(system.form(), |form| {
        form.period_map(start_of_orbit, period)
    })?;
    if !whole.is_nearly_closed() {
        return Err(whole.not_periodic(period));
    }
    // Begin away from events.
    let begin = if whole.events().next().is_some() {
        longest_pause(&whole, 0.0, period)
    } else {
        0.0
    };
    let step = whole.steps.iter().find(|step| step.end_time() > begin);
    let Some(step) = step else {
        return Err(Error::InvalidDuration { value: period });
    };
    let start = vector(&step.state_at(step.since_start(begin)), order);
    let (phase, base) = (begin / period, if is_free { 0.0 } else { begin });

    // A motion of the family, from a start that follows the parameters.
    let run = |slopes: &DMatrix<f64>, to: &[f64], expected: usize| {
        let system = family(to)?;
        work.with(system.form(), |form| {
            check_order(form.order(), order)?;
            let duration = match kind {
                Period::Free(_) => period,
                driven @ Period::Driven(_) => driven.duration(form.rhythm())?,
            };
            let begin = if is_free { 0.0 } else { phase * duration };
            let changes = std::iter::zip(to, parameters).map(|(to, from)| to - from);
            let changes = DVector::from_iterator(to.len(), changes);
            let mut start = state(&(&start + slopes * changes), n);
            form.put_in_modes(&mut start, begin, &|c| step.modes().get(c).copied());
            Run::of(form, (begin, &start), duration, expected)
        })
    };
    let mut slopes = DMatrix::zeros(order, parameters.len());
    let of = |slopes: &DMatrix<f64>| {
        let run = |to: &[f64], expected: usize| run(slopes, to, expected);
        Sensitivities::of(parameters, base, order, (&run, &work))
    };
    let fixed = of(&slopes)?;
    let map = work.with(system.form(), |form| {
        period_map(form, base, &fixed.here.start, period)
    })?;
    let periods = fixed.close(&map, is_free, &mut slopes);
    let periods = periods.ok_or_else(|| map.not_periodic(period))?;
    Ok(OrbitSensitivities {
        period: periods,
        motion: of(&slopes)?,
    })
}

fn check(parameters: &[f64]) -> Result<(), Error> {
    for value in parameters {
        Error::check(
            "orbit::sensitivities",
            "parameter",
            *value,
            true,
            "a number",
        )?;
    }
    Ok(())
}

/// Refuses a system whose states have another number of entries than those of the motion.
fn check_order(found: usize, expected: usize) -> Result<(), Error> {
    if found == expected {
        return Ok(());
    }
    Err(Error::WrongSize {
        name: "entries of a state of the family",
        found,
        expected,
    })
}

impl Sensitivities {
    /// Computes the derivatives of the start with which the motions stay closed. Returns the
    /// derivatives of the period.
    fn close(&self, map: &PeriodMap, is_free: bool, slopes: &mut DMatrix<f64>) -> Option<Vec<f64>> {
        let (order, sizes) = (self.order, map.sizes());
        let period = self.here.end - self.begin;
        let (matrix, _, unit) = map.equations(is_free.then_some(&map.flow[0]), period);
        let count = self.here.events.len();
        let kept = map.kept();
        let mut periods = Vec::new();
        for (number, by) in self.variations.iter().enumerate() {
            let mut missed = by.derivative(|run| run.missed(count))?;
            map.untranslated(&mut missed);
            kept.iter().for_each(|&i| missed[i] = 0.0);
            let right = -missed
                .component_div(&sizes)
                .resize_vertically(matrix.nrows(), 0.0);
            let solution = least_norm(matrix.clone(), &right, SINGULAR)?;
            let own = solution.rows(0, order).component_mul(&sizes);
            slopes.column_mut(number).copy_from(&own);
            let duration = |run: &Run| Some(DVector::from_element(1, run.duration));
            periods.push(if is_free {
                solution[order] / unit * period
            } else {
                by.derivative(duration)?[0]
            });
        }
        Some(periods)
    }
}
