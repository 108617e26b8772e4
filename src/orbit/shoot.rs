//! Shooting: Newton's method for fixed points of the period map.

use nalgebra::DVector;

use super::oscillator::Oscillator;
use super::period::Period;
use super::period_map::run;
use super::period_map::{self, CLOSED, SINGULAR, state, vector};
use super::periodic_orbit::Orbit;
use super::shooting_residual::TrialMotion;
use super::time_integration::reach;
use super::type_erased_system::{GeneralForm, Rhythm};
use crate::error::Error;
use crate::motion::sealed::State as _;
use crate::motion::{Mode, Segment};
use crate::numerics::bracket::root_between;
use crate::numerics::least_norm::{conserving, restoring};
use crate::search::Search;
use crate::state::structure::State;
use crate::structure::engine::check_sizes;

/// The problem of shooting: x(T) = x(0).
#[derive(Debug)]
struct Problem<'s> {
    form: &'s GeneralForm<'s>,
    guess: DVector<f64>,
    /// The phase condition of an autonomous motion: the normal of a plane through the guess.
    section: Option<DVector<f64>>,
    /// The given period or estimate.
    estimate: f64,
}

/// Limit of Newton steps; five to ten are usual.
const MOST_STEPS: usize = 60;

/// The smallest damping factor of a Newton step.
const LEAST_PART: f64 = 1.0 / 1024.0;

/// A closed motion that was found.
struct Found {
    motion: TrialMotion,
    /// Whether it conserves what the guess conserves; `None` if it is not one of a family.
    conserves: Option<bool>,
}

/// The number of parts of the estimate of a period in which a return is looked for.
const PARTS: usize = 256;

/// Limit of the moves along a family; they converge quadratically.
const MOST_RETURNS: usize = 12;

/// A conserved quantity counts as that of the guess if the motion lies within this distance along
/// its family, in units of the sizes and of the magnification by the motion.
const CONSERVED: f64 = 4.0 * f64::EPSILON;

/// A memory variable below this part of its size is 0 after a Newton step.
const ROUNDING: f64 = 1024.0 * f64::EPSILON;

/// A residual below this is none: a memory variable that decays may come nearer to 0 for ever.
const ZERO: f64 = f64::EPSILON * f64::EPSILON;

impl<'s> Problem<'s> {
    /// The problem for a guess, with the first trial.
    fn new(
        form: &'s GeneralForm<'s>,
        guess: &State,
        period: Period,
    ) -> Result<(Self, TrialMotion), Error> {
        let duration = period.duration(form.rhythm())?;
        let mut problem = Self {
            form,
            guess: vector(guess, form.order()),
            section: None,
            estimate: duration,
        };
        let trial = problem.trial(guess, duration)?;
        if let Period::Free(_) = period {
            let normal = trial.map.flow[0].clone();
            let length = normal.norm();
            if length == 0.0 {
                return Err(Error::AtRest);
            }
            problem.section = Some(normal / length);
        }
        Ok((problem, trial))
    }

    /// The motion over one period from a start.
    fn trial(&self, start: &State, period: f64) -> Result<TrialMotion, Error> {
        let map = self.form.period_map(start, period)?;
        Ok(TrialMotion::new(map, period))
    }

    /// The Newton step: increments of the start and of the period, and the largest of them in units
    /// of the sizes.
    fn step(&self, trial: &TrialMotion) -> Option<(DVector<f64>, f64, f64)> {
        let map = &trial.map;
        let (order, sizes) = (map.order(), map.sizes());
        let (matrix, mut right, unit) = map.equations(self.section.as_ref(), trial.period);
        if let Some(normal) = &self.section {
            let start = vector(&map.start, order);
            let largest = normal.component_mul(&sizes).amax();
            right[order] = -normal.dot(&(start - &self.guess)) / largest;
        }
        let mut solution = conserving(matrix, &right, SINGULAR, order)?;
        if self.section.is_some() {
            solution[order] /= unit;
        }
        let size = solution.amax();
        let change = solution.rows(0, order).component_mul(&sizes);
        let longer = self
            .section
            .as_ref()
            .map_or(0.0, |_| solution[order] * trial.period);
        size.is_finite().then_some((change, longer, size))
    }

    /// The start after a part of a Newton step. A contact that sticks at the end has the velocity
    /// of its belt to the bit.
    fn changed(&self, trial: &TrialMotion, change: &DVector<f64>, part: f64) -> State {
        let map = &trial.map;
        let mut start = vector(&map.start, map.order()) + change * part;
        // What only decays is 0 in a closed motion, and its own size is none to measure it by.
        let sizes = map.sizes();
        for row in 2 * self.form.len()..map.order() {
            if start[row].abs() <= ROUNDING * sizes[row] {
                start[row] = 0.0;
            }
        }
        let mut changed = state(&start, self.form.len());
        let (modes, before) = (map.end_modes(), &map.start.velocities);
        let keeps = |c: usize| part == 1.0 || self.form.is_at_rest(c, before, 0.0);
        self.form
            .put_in_modes(&mut changed, 0.0, &|c| match modes[c] {
                Mode::Stick if self.form.holds(c) && !keeps(c) => None,
                mode => Some(mode),
            });
        changed
    }

    /// The closed motion that conserves what the guess conserves, as far as closed motions do.
    ///
    /// Newton's method keeps what is linear in the state. Of any other conserved quantity it keeps
    /// the gradient at the closed motion only: the found motion is moved along its family until the
    /// guess lies across this gradient, and closed again.
    fn solve(&self, first: TrialMotion) -> Result<Found, Error> {
        let mut found = self.close(first)?;
        let mut missed = self.missed(&found);
        for _ in 0..MOST_RETURNS {
            let Some((back, longer)) = &missed else {
                break;
            };
            if back.amax() <= CONSERVED * found.map.growth() {
                break;
            }
            let start = self.changed(&found, &back.component_mul(&found.map.sizes()), 1.0);
            let nearer = self.trial(&start, found.period * (1.0 + longer));
            let nearer = nearer.and_then(|trial| self.close(trial));
            let Ok(nearer) = nearer else {
                break;
            };
            let still = self.missed(&nearer);
            let is_nearer = |(still, _): &(DVector<f64>, f64)| still.amax() <= 0.5 * back.amax();
            if !still.as_ref().is_some_and(is_nearer) {
                break;
            }
            (found, missed) = (nearer, still);
        }
        let conserves = missed.map(|(back, _)| back.amax() <= CLOSED * found.map.growth());
        Ok(Found {
            motion: found,
            conserves,
        })
    }

    /// The change of the start of a closed motion, along its family and in units of the sizes, with
    /// which it would conserve what the guess conserves, and the relative change of the period;
    /// `None` where there is no family.
    fn missed(&self, found: &TrialMotion) -> Option<(DVector<f64>, f64)> {
        let map = &found.map;
        let order = map.order();
        let (matrix, _, unit) = map.equations(self.section.as_ref(), found.period);
        let mut away = vector(&map.start, order) - &self.guess;
        map.kept().into_iter().for_each(|row| away[row] = 0.0);
        let back = restoring(matrix, &away.component_div(&map.sizes()), SINGULAR)?;
        Some(map.changes(back.column(0), unit))
    }

    /// The time, from a half to one and a half of the estimate, at which the motion from the guess
    /// of an autonomous one passes nearest to the guess.
    fn return_time(&self, first: &TrialMotion) -> Option<f64> {
        let normal = self.section.as_ref()?;
        let most = 1.5 * first.period;
        let map = self.form.period_map(&first.map.start, most).ok()?;
        let sizes = map.sizes();
        let away = |time: f64| {
            let step = map.steps.iter().find(|step| time <= step.end_time());
            let step = step.unwrap_or(&map.steps[map.steps.len() - 1]);
            let there = step.state_at(step.since_start(time).min(step.duration()));
            let mut away = vector(&there, map.order()) - &self.guess;
            map.untranslated(&mut away);
            away
        };
        let ahead = |time: f64| normal.dot(&away(time));
        let times = (0..=PARTS).map(|i| first.period * (0.5 + i as f64 / PARTS as f64));
        let times: Vec<f64> = times.collect();
        let passages = times.windows(2).filter_map(|pair| {
            let passes = ahead(pair[0]) < 0.0 && ahead(pair[1]) >= 0.0;
            passes.then(|| root_between(&mut |time| Ok(ahead(time)), pair[0], pair[1]).ok())?
        });
        let missed = |time: f64| away(time).component_div(&sizes).amax();
        let passages = passages.map(|time| (time, missed(time)));
        let nearest = passages.min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.map(|(time, _)| time)
    }

    /// Damped Newton's method: a step that would increase the residual is shortened.
    fn close(&self, first: TrialMotion) -> Result<TrialMotion, Error> {
        let mut best = first;
        for _ in 0..MOST_STEPS {
            if best.residual <= ZERO {
                return self.returned(best, None);
            }
            let Some((change, longer, size)) = self.step(&best) else {
                break;
            };
            let growth = best.map.growth();
            let closed = best.residual <= CLOSED * growth && size <= CLOSED.sqrt();
            let most = 0.5 * best.period / longer.abs();
            let mut part = most.min(1.0);
            let found = loop {
                let start = self.changed(&best, &change, part);
                let tried = self.trial(&start, best.period + part * longer);
                let enough = (1.0 - 0.25 * part) * best.residual;
                match tried {
                    Ok(tried) if tried.map.miss_after(&best.map) < enough => break Some(tried),
                    _ if closed || part <= LEAST_PART => break None,
                    _ => part *= 0.5,
                }
            };
            match found {
                Some(found) => best = found,
                None if closed => {
                    let change = change.component_div(&best.map.sizes());
                    return self.returned(best, Some(&change));
                }
                None => break,
            }
        }
        Err(self.failure(&best))
    }

    /// A closed motion, if it leaves its start and returns; `step` is the last Newton step.
    fn returned(
        &self,
        found: TrialMotion,
        step: Option<&DVector<f64>>,
    ) -> Result<TrialMotion, Error> {
        if self.section.is_none() || found.returns(step) {
            let found = match period_map::released(self.form, &found.map) {
                Some(start) => self.trial(&start, found.period)?,
                None => found,
            };
            // A start with nearly the belt's velocity can slip although the end sticks.
            let apart = run::begun_apart(self.form, &found.map, found.period)?;
            return match apart {
                Some(apart) if !apart.is_nearly_closed() => {
                    Err(TrialMotion::new(apart, found.period).not_periodic())
                }
                _ => Ok(found),
            };
        }
        Err(self.failure(&found))
    }

    /// The error for a trial that is no periodic motion: an autonomous one may be at rest.
    fn failure(&self, trial: &TrialMotion) -> Error {
        let sizes = trial.map.sizes();
        let moved = trial.map.flow[0].component_div(&sizes).amax() * self.estimate;
        if self.section.is_some() && moved <= CLOSED.sqrt() {
            Error::AtRest
        } else {
            trial.not_periodic()
        }
    }
}

/// The periodic motion near a guess, by shooting: Newton's method with the exact derivative of the
/// period map.
///
/// The motion need not be stable. Let x be the state and T the period. The residual x(T) − x(0)
/// falls to rounding, of the order of 1e-15 of the size of each component. Newton steps that would
/// increase the residual are shortened. The sequence of events is not prescribed: it may differ
/// from trial to trial.
///
/// Closed motions can form a continuous family ([`Orbit::families`]). If the motion conserves a
/// quantity that is linear in the state and that distinguishes the members, the result conserves
/// the value of the guess, to rounding. Such quantities are a momentum, the velocity of a mass that
/// no friction brakes, or a memory variable minus a displacement. Any other conserved quantity,
/// such as the energy of an undamped part, is conserved to rounding if the guess lies on a closed
/// motion. (Once all other parts have settled, this holds for every state of an undamped part with
/// one coordinate.) Otherwise the quantity differs by the square of the distance of the guess from
/// the closed motions. In this case, and if no motion is found, the search is repeated with another
/// estimate of the period: the time, between a half and one and a half of the given estimate, at
/// which the motion from the guess returns nearest to the guess. Motions that grow or decay by less
/// than 1e-11 per period count as members of a family.
///
/// An autonomous motion must leave its start and return. The residual must therefore also be small
/// relative to the extent of the motion, however small this extent is. This excludes two false
/// solutions: an equilibrium, which has every number as a period, and a period near 0, after which
/// no motion has left its start.
///
/// The guess is a state at time 0 of the drives; for an autonomous motion it is any state near the
/// motion. If the guess contains a force of an elastic contact above the limit force, the limit
/// force is used. If the estimate of the period is near twice the period, the result is the motion
/// over two periods. (The guess of an autonomous motion may lie exactly at an event at which the
/// flow jumps. If no motion is found from there, the search is repeated from a state between
/// events.)
///
/// # Errors
///
/// * [`Error::NoCommonPeriod`] for [`Period::Driven`], if the drives have no common period or none
///   of them varies; [`Error::NotFree`] for [`Period::Free`], if a drive varies;
/// * [`Error::InvalidParameter`] for `Period::Driven(0)`, and for `Period::Free` unless the
///   estimate is positive and finite;
/// * [`Error::AtRest`] in the search for an autonomous motion, if the guess is an equilibrium, or
///   if the search ends in one;
/// * [`Error::NotPeriodic`] if Newton's method does not converge, or reaches the bound of the work.
///   The error contains the best start tried and its residual. The bound is 10⁶ steps in total, for
///   all motions that are tried and for the transient of [`settle`];
/// * [`Error::TooManySteps`], with the time and state reached, if the motion from the guess takes
///   more than 10⁵ steps over the period;
/// * the other errors of [`Integrator::simulate`](crate::Integrator::simulate) for the motion from
///   the guess.
///
/// ```
/// use stick_slip::orbit::{self, Period};
/// use stick_slip::{Exponential, MassOnBelt, limit_cycle};
///
/// // A stable equilibrium, stick-slip, and an unstable motion between them.
/// let system = MassOnBelt::new(Exponential::new(0.6, 0.3, 0.4)?, 1.0)?.with_damping(0.01)?;
/// let orbit = orbit::shoot(&system, &(0.3, 0.6).into(), Period::Free(6.28))?;
/// let [multiplier] = orbit.multipliers() else { panic!() };
/// assert!((multiplier.re - 1.0981305946699447).abs() < 1e-12);
/// assert!(!orbit.is_stable());
///
/// // For a belt, the complete search finds the same motion.
/// let cycles = limit_cycle::find(&system)?;
/// let cycle = cycles.unstable().next().unwrap();
/// assert!((orbit.period() - cycle.period()).abs() < 1e-13);
/// # Ok::<(), stick_slip::Error>(())
/// ```
///
/// [`Search`] sets a bound of the work, and accepts a watcher, a function that can stop the search.
#[doc(alias = "solve")]
#[doc(alias = "Newton")]
pub fn shoot<S: Oscillator>(
    system: &S,
    guess: &S::State,
    period: Period,
) -> Result<Orbit<S::State>, Error> {
    Search::new().shoot(system, guess, period)
}

impl Search<'_> {
    /// Calls the function [`shoot`] with the bound and the watcher of this search.
    ///
    /// # Errors
    ///
    /// The errors of [`shoot`]; [`Error::Stopped`] if the watcher stops the search.
    pub fn shoot<S: Oscillator>(
        &self,
        system: &S,
        guess: &S::State,
        period: Period,
    ) -> Result<Orbit<S::State>, Error> {
        self.found(system, period, |form| {
            search(form, &guess.general(), period)
        })
    }

    /// Calls the function [`settle`] with the bound and the watcher of this search.
    ///
    /// # Errors
    ///
    /// The errors of [`settle`]; [`Error::Stopped`] if the watcher stops the search.
    pub fn settle<S: Oscillator>(
        &self,
        system: &S,
        start: &S::State,
        transient: f64,
        period: Period,
    ) -> Result<Orbit<S::State>, Error> {
        self.found(system, period, |form| {
            let guess = transient_end(form, &start.general(), transient, period)?;
            search(form, &guess, period)
        })
    }

    /// The motion that a search finds.
    fn found<S: Oscillator>(
        &self,
        system: &S,
        period: Period,
        search: impl FnOnce(&GeneralForm<'_>) -> Result<TrialMotion, Error>,
    ) -> Result<Orbit<S::State>, Error> {
        let watched = self.watch("time");
        let form = system.form().within(self.steps(), &watched);
        let found = search(&form);
        watched.check()?;
        Orbit::new(system, &form, found?, period)
    }
}

/// A closed motion near a guess; if the guess lies at an event, the search starts between events.
pub(super) fn search(
    form: &GeneralForm<'_>,
    guess: &State,
    period: Period,
) -> Result<TrialMotion, Error> {
    check_sizes(&form.model, guess)?;
    let mut guess = guess.clone();
    // A guess may carry more than an elastic contact can.
    form.put_in_modes(&mut guess, 0.0, &|_| None);
    let guess = &guess;
    let found = find(form, guess, period);
    let may_be_family = match &found {
        Ok(found) => found.conserves == Some(false),
        Err(error) => matches!(error, Error::NotPeriodic { .. } | Error::AtRest),
    };
    if !may_be_family {
        return found.map(|found| found.motion);
    }
    let (problem, first) = Problem::new(form, guess, period)?;
    // Without damping, Newton's method may go far along the family, or leave it: the center is
    // closed for each period.
    if let Some(period) = problem.return_time(&first)
        && let Ok(nearer) = find(form, guess, Period::Free(period))
        && nearer.conserves == Some(true)
    {
        return Ok(nearer.motion);
    }
    let Err(failure @ Error::NotPeriodic { .. }) = found else {
        return found.map(|found| found.motion);
    };
    // Where the flow jumps at the guess, an event, Newton's method may find no way. A free motion
    // can begin elsewhere.
    let apart = problem.section.as_ref();
    let apart = apart.map(|_| run::begun_apart(form, &first.map, first.period));
    match apart.transpose()?.flatten() {
        Some(apart) => find(form, &apart.start, period).map(|found| found.motion),
        None => Err(failure),
    }
}

/// A closed motion near a guess.
fn find(form: &GeneralForm<'_>, guess: &State, period: Period) -> Result<Found, Error> {
    let (problem, first) = Problem::new(form, guess, period)?;
    problem.solve(first)
}

/// Simulates a transient from a start at time 0, then finds the periodic motion near the state
/// reached.
///
/// The length of the transient is in units of time. For a forced motion it is rounded up to whole
/// periods of the drives. A long transient costs little: if [`shoot`] fails, make the transient
/// longer. In a continuous family of motions, the result has the conserved quantities of the start;
/// the page of [`shoot`] states how accurately.
///
/// # Errors
///
/// * [`Error::InvalidDuration`] unless the transient is finite and ≥ 0;
/// * [`Error::TooManySteps`], with the time and state reached, if the transient takes more than 10⁶
///   steps (10⁴ to 10⁵ oscillations): continue from that state;
/// * the errors of [`shoot`], and those of [`Integrator::simulate`](crate::Integrator::simulate)
///   for the transient.
///
/// ```
/// use stick_slip::orbit::{self, Period};
/// use stick_slip::structure::State;
/// use stick_slip::{Contact, Rational, Structure};
///
/// // Two blocks on a belt, coupled by a spring (U. Galvanetto, S. R. Bishop, 1999).
/// let law = Rational::new(1.0, 3.0)?;
/// let mut blocks = Structure::new(&[1.0, 1.0])?.with_spring(0, 1, 1.2)?;
/// for (i, load) in [(0, 1.0), (1, 1.3)] {
///     blocks = blocks
///         .with_ground_spring(i, 1.0)?
///         .with_ground_damper(i, 0.1)?
///         .with_contact(Contact::new(i, law, load)?.on_belt(0.5))?;
/// }
/// let start = State::new(&[0.7, 0.0], &[0.2, -0.2]);
/// let orbit = orbit::settle(&blocks, &start, 60.0, Period::Free(3.8))?;
/// assert!((orbit.period() - 3.8260641332796215).abs() < 1e-13);
/// // The blocks never stick both at once: one multiplier is 0, and the multiplier 1 is left out.
/// let [first, second, third] = orbit.multipliers() else { panic!() };
/// assert!((first.re + 0.5992727325568236).abs() < 1e-12 && *second == first.conj());
/// assert_eq!(third.norm(), 0.0);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn settle<S: Oscillator>(
    system: &S,
    start: &S::State,
    transient: f64,
    period: Period,
) -> Result<Orbit<S::State>, Error> {
    Search::new().settle(system, start, transient, period)
}

/// The state after a transient. Contacts that stick there get the velocity of their belts at time
/// 0.
fn transient_end(
    form: &GeneralForm<'_>,
    start: &State,
    transient: f64,
    period: Period,
) -> Result<State, Error> {
    Error::check_duration(transient)?;
    let duration = match (period, form.rhythm()) {
        (Period::Driven(_), Rhythm::Periodic(period)) => (transient / period).ceil() * period,
        _ => transient,
    };
    let (mut reached, modes) = reach(form, start, duration)?;
    reached = form.put_back(&reached, start);
    form.put_in_modes(&mut reached, 0.0, &|c| Some(modes[c]));
    Ok(reached)
}
