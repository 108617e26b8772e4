//! The attractor that a motion reaches.

use std::collections::{BTreeMap, VecDeque};

use nalgebra::DVector;

use super::oscillator::Oscillator;
use super::period::Period;
use super::period_map::vector;
use super::periodic_orbit::Orbit;
use super::shoot;
use super::shooting_residual::TrialMotion;
use super::translation::Turning;
use super::type_erased_system::{GeneralForm, Rhythm};
use crate::error::{Element, Error, Reached};
use crate::motion::sealed::State as _;
use crate::motion::{AttractorKind, EventKind, Integrator, Mode, Segment, SystemState};
use crate::search::Search;
use crate::state::Direction;
use crate::state::structure::State;
use crate::structure::{Flow, Step};

/// The attractor that a motion reaches: see [`classify`].
#[derive(Debug, Clone)]
#[non_exhaustive]
pub enum Attractor<S: SystemState> {
    /// Every mass is at rest, and every contact sticks for ever. In a system that can be
    /// [translated](super#motions-that-are-translated), masses may move at constant velocities.
    Rest,
    /// Every mass is at rest, and contacts slide steadily. In a system that can be
    /// [translated](super#motions-that-are-translated), masses may move at constant velocities.
    SteadySliding,
    /// A periodic motion in which no contact alternates between stick and slip.
    PureSlip(Box<Orbit<S>>),
    /// A periodic motion in which at least one contact alternates between stick and slip.
    StickSlip(Box<Orbit<S>>),
    /// No periodic motion was found in 1.3·10⁵ steps (more if a [`Search`] allows more). Only
    /// motions that close after at most 16 returns are searched; [`classify`] defines these
    /// returns. The motion is chaotic or quasi-periodic, or a transient decays very slowly.
    /// [`lyapunov`](super::lyapunov()) identifies chaos.
    Irregular,
}

impl<S: SystemState> Attractor<S> {
    /// The kind of the attractor.
    pub fn kind(&self) -> AttractorKind {
        match self {
            Self::Rest => AttractorKind::Rest,
            Self::SteadySliding => AttractorKind::SteadySliding,
            Self::PureSlip(_) => AttractorKind::PureSlip,
            Self::StickSlip(_) => AttractorKind::StickSlip,
            Self::Irregular => AttractorKind::Irregular,
        }
    }

    /// The periodic motion; `None` if the attractor is not a periodic motion.
    pub fn orbit(&self) -> Option<&Orbit<S>> {
        match self {
            Self::PureSlip(orbit) | Self::StickSlip(orbit) => Some(orbit),
            Self::Rest | Self::SteadySliding | Self::Irregular => None,
        }
    }
}

/// The attractor that the motion from a start at time 0 reaches: rest, steady sliding, a periodic
/// motion with or without stick, or none of these.
///
/// The motion is simulated until it stands still, or until its state nearly repeats after 1 to 16
/// returns. Returns are the events of one kind, the turning points of one coordinate, or, if drives
/// vary, the times at which their phases are the same. [`shoot`] starts from the state at a return
/// and finds the periodic motion to rounding. This motion is the result if it is stable and its
/// state differs from the simulated one by at most 5 % of the extent of the motion. (An unstable
/// motion is the result only if the simulated motion already repeats itself to 10⁻⁹ of its extent.)
/// Otherwise the simulation continues. The result is therefore the attractor of this start; other
/// starts may reach other attractors.
///
/// If no drive varies, the motion counts as steady sliding or rest if two conditions hold for at
/// least 256 steps. First, no event happens. Second, no velocity is larger than 10⁻⁶ of the largest
/// velocity of a mass or a belt so far. If masses can be displaced together without changing any
/// force (see [translations](super#motions-that-are-translated)), velocities may have any size, but
/// none may vary by more than 10⁻⁶ of the largest. If drives vary, no event may happen over a
/// period and at least 256 steps, and all velocities must be rounding errors. (Drives may also move
/// masses by shorter and shorter slips, which never cease: shakedown. These masses count as at rest
/// where [`shoot`] finds them at rest, if the distance of the motion from there falls in each
/// period, and by a quarter or more in each doubling of the time.) A contact slides steadily if it
/// slips all the time. A start exactly on an unstable equilibrium, or on an unstable periodic
/// motion, stays there: perturb the start.
///
/// The work is at most 1.3·10⁵ steps of the motion (about 10⁴ oscillations), and 8·10⁵ steps of
/// searches by [`shoot`]; a motion that needs more counts as irregular. If the transient is longer,
/// as with little damping and very different frequencies, use a [`Search`] with a larger bound. A
/// `Search` also accepts a watcher, a function that can stop it. For one mass on a belt,
/// [`limit_cycle::attractor`](crate::limit_cycle::attractor) finds the attractor without
/// simulation.
///
/// # Errors
///
/// [`Error::NoCommonPeriod`] if the drives vary without a common period; the errors of
/// [`Integrator::simulate`].
///
/// ```
/// use stick_slip::orbit::{AttractorKind, classify};
/// use stick_slip::{Contact, Error, Rational, Structure, structure::State};
///
/// // Two blocks on a belt, coupled by a spring.
/// let blocks = |belt: f64| -> Result<Structure, Error> {
///     let mut blocks = Structure::new(&[1.0, 1.0])?.with_spring(0, 1, 1.2)?;
///     for (i, load) in [(0, 1.0), (1, 1.3)] {
///         let contact = Contact::new(i, Rational::new(1.0, 3.0)?, load)?.on_belt(belt);
///         blocks = blocks.with_ground_spring(i, 1.0)?.with_ground_damper(i, 0.1)?;
///         blocks = blocks.with_contact(contact)?;
///     }
///     Ok(blocks)
/// };
/// let start = State::new(&[0.7, 0.0], &[0.2, -0.2]);
/// let slow = classify(&blocks(0.5)?, &start)?;
/// assert_eq!(slow.kind(), AttractorKind::StickSlip);
/// assert!((slow.orbit().unwrap().period() - 3.8260641332796215).abs() < 1e-13);
/// assert_eq!(classify(&blocks(6.0)?, &start)?.kind(), AttractorKind::SteadySliding);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "attractor")]
#[doc(alias = "basin")]
pub fn classify<S: Oscillator>(system: &S, start: &S::State) -> Result<Attractor<S::State>, Error> {
    Search::new().classify(system, start)
}

impl Search<'_> {
    /// Calls the function [`classify`] with the bound and the watcher of this search. If the bound
    /// is 2ᵏ times the default, 10⁶ steps, the motion is simulated over 2ᵏ·1.3·10⁵ steps before it
    /// counts as irregular.
    ///
    /// # Errors
    ///
    /// The errors of [`classify`]; [`Error::TooManySteps`] if a bound below the default is reached;
    /// [`Error::Stopped`] if the watcher stops the search.
    pub fn classify<S: Oscillator>(
        &self,
        system: &S,
        start: &S::State,
    ) -> Result<Attractor<S::State>, Error> {
        let watched = self.watch("time");
        let form = system.form().within(self.steps(), &watched);
        let found = settled(system, &form, &start.general());
        watched.check()?;
        Ok(found?.0)
    }
}

/// Steps after which a motion is first tested; each time twice as many as before.
const FIRST_STEPS: usize = 256;

/// Number of tests within the default bound.
const LOOKS: u32 = 9;

/// Number of tests within a bound. Each takes as many steps of the motion as all before.
fn looks(most: usize) -> u32 {
    LOOKS
        + (most / Search::DEFAULT_MAX_STEPS)
            .checked_ilog2()
            .unwrap_or(0)
}

/// A search may take as many steps as so many motions over the period, or this number if that is
/// more: six to eight motions are usual, thirty near a continuum. The period is at most half of the
/// motion since the last test, so that all searches take less than six times its steps.
const MOTIONS: f64 = 12.0;
const FEW_STEPS: usize = 1024;

/// Largest number of returns after which a motion may repeat itself, and the least number of
/// returns needed to judge that.
const MOST_RETURNS: usize = 16;
const LEAST_RETURNS: usize = 6;

/// Number of returns whose states are kept.
const KEPT: usize = 2 * MOST_RETURNS + 1;

/// Velocities below this part of the largest count as those of a mass at rest.
const AT_REST: f64 = 1e-6;

/// Largest distance between a motion and its return, in units of its extent, from which a periodic
/// motion is searched; that motion lies at most so far away.
const NEAR: f64 = 0.05;

/// A motion that returns to within less is periodic, stable or not: one of a continuum.
const CLOSED: f64 = 1e-9;

/// Largest difference of two motions that are one, in parts of their extent.
const SAME: f64 = 1e-6;

/// Drives move a mass towards its rest by ever shorter slips, which never cease, if its distance
/// falls to this part or less each time the motion takes twice as long. It falls to
/// 2^(−1/(p − 1)) if the slip in a period is proportional to the power p of the distance: to a half
/// where the drive has a smooth maximum (p = 2), to 0.71 where it has a corner (p = 3).
const DECAYS: f64 = 0.75;

/// Number of tests in succession in which this is seen.
const SHORTER: usize = 3;

/// Velocities of coordinates that stand still, in parts of what forces and displacements could
/// give them in a period.
const STILL: f64 = 1e-12;

/// The attractor that a motion reaches, and a state there, at the beginning of a period of the
/// drives.
pub(super) fn settled<S: Oscillator>(
    system: &S,
    form: &GeneralForm<'_>,
    start: &State,
) -> Result<(Attractor<S::State>, State), Error> {
    let period = match form.rhythm() {
        Rhythm::Periodic(period) => Some(period),
        Rhythm::Constant => None,
        Rhythm::Aperiodic => return Err(Error::NoCommonPeriod),
    };
    let mut flow = Flow::new(Integrator::new(), form.model.clone(), start)?;
    let mut fastest = fastest_surface(form);
    let mut largest_states = vec![0.0; form.model.first_order.len()];
    let (mut turning, mut number) = (0, 1);
    let mut last = start.clone();
    let mut tested = Vec::new();
    let mut end = 0.0;
    for look in 0..looks(form.most()) {
        let begin = end;
        let mut seen = Recurrence::new(form, turning);
        let steps = FIRST_STEPS << look;
        for _ in 0..steps {
            let Some(step) = flow.next().transpose()? else {
                break;
            };
            form.count(&|| Reached::new(step.start_time(), step.state().clone()))?;
            if step.duration().is_infinite() {
                let kind = at_rest(&slipping(step.modes()));
                return Ok((kind, form.put_back(step.state(), start)));
            }
            end = step.end_time();
            seen.add((form, start), &step, period, &mut number);
        }
        fastest = seen.velocities().map(size).fold(fastest, f64::max);
        if let Some((_, state)) = seen.latest(period) {
            last = state.clone();
        }
        tested.push(last.clone());
        let slow = match period {
            None => AT_REST * fastest,
            Some(period) => still(form, seen.displacement(), period),
        };
        let states_rest = seen.states_rest(&mut largest_states);
        let rests = states_rest && seen.velocities().all(|range| speed(form, range) <= slow);
        let is_long_enough = period.is_none() || seen.strobes.len() > 1;
        if rests && seen.events.is_empty() && is_long_enough {
            return Ok((at_rest(&seen.slides), last));
        }
        let (kept, kind) = match period {
            Some(_) => (Some(&seen.strobes), None),
            None => (seen.section(), Some(())),
        };
        if let Some(returns) = kept.filter(|kept| kept.len() >= LEAST_RETURNS)
            && let Some((count, missed)) = repeats(&seen, returns)
        {
            let (time, guess) = &returns[returns.len() - 1 - count];
            let estimate = returns[returns.len() - 1].0 - time;
            let period = kind.map_or(Period::Driven(count), |()| Period::Free(estimate));
            let most = MOTIONS * steps as f64 * (estimate / (end - begin));
            let found = form.within_steps((most as usize).max(FEW_STEPS), || {
                let found = shoot::search(form, guess, period)?;
                Ok::<_, Error>(over_own_period(form, found, period))
            });
            if let Ok((found, period)) = found
                && let Some(orbit) =
                    accepted(system, form, found, period, (&seen, guess, missed, &tested))?
            {
                let state = orbit.state().general();
                return Ok((named(form, orbit), state));
            }
        }
        turning = seen.largest();
    }
    Ok((Attractor::Irregular, last))
}

/// The motion over its own period, if a motion of several returns repeats one of fewer. A motion
/// that approaches it from alternating sides is nearest to itself after two returns.
fn over_own_period(
    form: &GeneralForm<'_>,
    found: TrialMotion,
    period: Period,
) -> (TrialMotion, Period) {
    let (map, start) = (&found.map, vector(&found.map.start, form.order()));
    let sizes = map.sizes();
    let extent = map.largest(&map.extents().component_div(&sizes));
    let is_start = |state: DVector<f64>| {
        let mut apart = state - &start;
        map.untranslated(&mut apart);
        let apart = map.largest(&apart.component_div(&sizes));
        let mut pairs = std::iter::zip(apart, extent);
        pairs.all(|(apart, extent)| apart <= SAME * extent)
    };
    for parts in (2..=MOST_RETURNS).rev() {
        let time = found.period / parts as f64;
        let shorter = match period {
            Period::Driven(count) if count % parts == 0 => Period::Driven(count / parts),
            Period::Driven(_) => continue,
            Period::Free(_) => Period::Free(time),
        };
        if !map.vector_at(time).is_some_and(is_start) {
            continue;
        }
        if let Ok(part) = shoot::search(form, &map.start, shorter)
            && (part.period - time).abs() <= SAME * time
            && is_start(vector(&part.map.start, form.order()))
        {
            return (part, shorter);
        }
    }
    (found, period)
}

/// The velocity that rounding may give to coordinates that stand still, with displacements of a
/// size, in a time.
fn still(form: &GeneralForm<'_>, displacement: f64, time: f64) -> f64 {
    let rows = form.model.inverse_mass.rows().enumerate();
    let accelerations = rows.map(|(i, (own, beside))| {
        let size = |j: usize, a: f64| a.abs() * form.model.forces[j].size();
        let others = beside.iter().map(|&(j, a)| size(j, a));
        size(i, own) + others.sum::<f64>()
    });
    let acceleration = accelerations.fold(0.0, f64::max);
    STILL * (displacement / time).max(acceleration * time)
}

/// Returns true if every coordinate stands still over a motion, or moves at a constant velocity
/// where nothing depends on it, up to rounding. A contact whose force touches its limit may slip
/// less than a displacement is rounded, but at a speed that is no rounding error.
fn stands<S: SystemState>(form: &GeneralForm<'_>, orbit: &Orbit<S>) -> bool {
    let displacements = (0..form.len()).map(|i| size(orbit.extremes(i)));
    let displacement = displacements.fold(0.0, f64::max);
    let still = still(form, displacement, orbit.period());
    (0..form.len()).all(|i| {
        let (least, most) = orbit.extremes(i);
        speed(form, orbit.velocity_extremes(i)) <= still || most - least <= still * orbit.period()
    })
}

/// The largest size of a number in a range.
fn size((least, largest): (f64, f64)) -> f64 {
    largest.max(-least)
}

/// The distance from rest of a coordinate whose velocity is in a range: the largest size of its
/// velocity or, where masses may move at constant velocities, the change of it.
fn speed(form: &GeneralForm<'_>, (least, largest): (f64, f64)) -> f64 {
    if form.freedom().displacements.is_empty() {
        size((least, largest))
    } else {
        largest - least
    }
}

/// The largest velocity of a surface.
pub(super) fn fastest_surface(form: &GeneralForm<'_>) -> f64 {
    let contacts = form.model.contacts.iter();
    let surfaces = contacts.map(|contact| contact.belt_velocity.size());
    surfaces.fold(0.0, f64::max)
}

/// The equilibrium in which these contacts slide.
fn at_rest<S: SystemState>(slides: &[bool]) -> Attractor<S> {
    if slides.contains(&true) {
        Attractor::SteadySliding
    } else {
        Attractor::Rest
    }
}

/// The contacts that slip in a step.
fn slipping(modes: &[Mode]) -> Vec<bool> {
    let slips = modes.iter().map(|mode| matches!(mode, Mode::Slip(_)));
    slips.collect()
}

/// Leaves the contacts that also slip in another step: a contact slides steadily if it never
/// sticks. At rest it may slip for an instant, by a distance that is rounding, while a drive brings
/// its force to the limit.
fn retain_slipping(slides: &mut Vec<bool>, modes: &[Mode]) {
    let slips = slipping(modes);
    if slides.is_empty() {
        *slides = slips;
    } else {
        let pairs = std::iter::zip(slides, slips);
        pairs.for_each(|(slides, slips)| *slides &= slips);
    }
}

/// A periodic motion as an attractor.
fn named<S: SystemState>(form: &GeneralForm<'_>, orbit: Orbit<S>) -> Attractor<S> {
    match kind_of(form, &orbit) {
        AttractorKind::Rest => Attractor::Rest,
        AttractorKind::SteadySliding => Attractor::SteadySliding,
        AttractorKind::StickSlip => Attractor::StickSlip(Box::new(orbit)),
        _ => Attractor::PureSlip(Box::new(orbit)),
    }
}

/// The kind of a periodic motion: at rest, with stick or without.
pub(super) fn kind_of<S: SystemState>(form: &GeneralForm<'_>, orbit: &Orbit<S>) -> AttractorKind {
    if stands(form, orbit) {
        let start = orbit.state().general();
        let flow = Flow::new(Integrator::new(), form.model.clone(), &start);
        let steps = flow.into_iter().flatten().map_while(Result::ok);
        let steps = steps.take_while(|step| step.start_time() < orbit.period());
        let mut slides = Vec::new();
        let steps = steps.filter(|step| step.duration() > 0.0);
        steps.for_each(|step| retain_slipping(&mut slides, step.modes()));
        return at_rest::<S>(&slides).kind();
    }
    if orbit.alternates() {
        AttractorKind::StickSlip
    } else {
        AttractorKind::PureSlip
    }
}

/// The motion that was found, if it attracts and lies near the guess; or if masses are at rest in
/// it, and the motion approaches it from test to test.
fn accepted<S: Oscillator>(
    system: &S,
    form: &GeneralForm<'_>,
    found: TrialMotion,
    period: Period,
    (seen, guess, missed, tested): (&Recurrence, &State, f64, &[State]),
) -> Result<Option<Orbit<S::State>>, Error> {
    let is_near = seen.apart(&found.map.start, guess) <= NEAR;
    let decays = seen.decays_to(&found.map.start, tested);
    if !(is_near || decays) {
        return Ok(None);
    }
    let orbit = Orbit::new(system, form, found, period)?;
    let attracts = orbit.is_stable() && !orbit.is_one_of_many();
    let is_end = is_near && (attracts || missed <= CLOSED) || decays && stands(form, &orbit);
    Ok(is_end.then_some(orbit))
}

/// The number of returns after which a motion repeats itself, and its distance from itself then.
fn repeats(seen: &Recurrence, returns: &Returns) -> Option<(usize, f64)> {
    let last = returns.len() - 1;
    let most = MOST_RETURNS.min(last / 2);
    let misses = (1..=most).map(|count| {
        let pairs = [last, last - 1].map(|i| seen.apart(&returns[i].1, &returns[i - count].1));
        (count, pairs[0].max(pairs[1]))
    });
    let misses: Vec<(usize, f64)> = misses.collect();
    let least = misses.iter().map(|miss| miss.1).fold(NEAR, f64::min);
    // The first that is not much worse than the best.
    misses
        .into_iter()
        .find(|&(_, miss)| miss <= 2.0 * least + CLOSED && miss <= NEAR)
}

/// States at the returns of a motion, with their times.
type Returns = VecDeque<(f64, State)>;

fn keep(returns: &mut Returns, time: f64, state: State) {
    if returns.len() == KEPT {
        returns.pop_front();
    }
    returns.push_back((time, state));
}

/// The part of a motion since the last test.
struct Recurrence {
    /// Least and largest of each displacement, put back, then of each velocity.
    ranges: Vec<(f64, f64)>,
    /// Least and largest value of each first-order state on which anything depends, by its memory
    /// variable.
    states: Vec<(usize, (f64, f64))>,
    /// For each contact, true if it slips in all steps.
    slides: Vec<bool>,
    /// States at events, by element and kind, and how many there were.
    events: BTreeMap<(Element, u8), (usize, Returns)>,
    /// States at the largest displacements of one coordinate.
    turning: Turning,
    turns: (usize, Returns),
    /// States at the beginnings of periods of the drives.
    strobes: Returns,
    latest: Option<(f64, State)>,
}

impl Recurrence {
    fn new(form: &GeneralForm<'_>, turning: usize) -> Self {
        const NONE: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);
        let states = form.model.first_order.iter().enumerate();
        let acting = states.filter(|(_, state)| state.acts);
        let acting = acting.map(|(number, _)| form.model.state_place(number));
        Self {
            ranges: vec![NONE; 2 * form.len()],
            states: acting.map(|place| (place, NONE)).collect(),
            slides: Vec::new(),
            events: BTreeMap::new(),
            turning: form.turning(turning),
            turns: (0, Returns::new()),
            strobes: Returns::new(),
            latest: None,
        }
    }

    /// Adds a step, put back to the place of a start. `number` counts the periods of the drives.
    fn add(
        &mut self,
        (form, start): (&GeneralForm<'_>, &State),
        step: &Step,
        period: Option<f64>,
        number: &mut u64,
    ) {
        let back = |state: &State| form.put_back(state, start);
        // A slip may begin and end at rest within one step.
        let middle = step.state_at(0.5 * step.duration());
        for state in [step.state(), &middle, &step.end_state()].map(back) {
            let numbers = state.displacements.iter().chain(&state.velocities);
            for ((least, largest), x) in std::iter::zip(&mut self.ranges, numbers) {
                (*least, *largest) = (least.min(*x), largest.max(*x));
            }
            for (place, (least, largest)) in &mut self.states {
                let x = state.memory.get(*place).copied().unwrap_or(0.0);
                (*least, *largest) = (least.min(x), largest.max(x));
            }
        }
        retain_slipping(&mut self.slides, step.modes());
        if let Some(period) = period {
            // A step may be longer than any number of periods; only the last states are kept.
            let end = step.end_time();
            let last = (end / period).ceil() as u64;
            for n in (*number).max(last.saturating_sub(KEPT as u64))..=last {
                let time = n as f64 * period;
                if time >= end {
                    break;
                }
                let mut state = back(&step.state_at(step.since_start(time)));
                form.put_in_modes(&mut state, 0.0, &|c| Some(step.modes()[c]));
                keep(&mut self.strobes, time, state);
                *number = n.saturating_add(1);
            }
        } else if let Some(velocity) = self.turning.series(step) {
            velocity.sign_changes(step.duration(), &mut |t, rises| {
                if !rises {
                    self.turns.0 += 1;
                    let state = back(&step.state_at(t));
                    keep(&mut self.turns.1, step.start_time() + t, state);
                }
            });
        }
        for event in step.events() {
            let key = (event.element, rank(event.kind));
            let (count, returns) = self.events.entry(key).or_default();
            *count += 1;
            keep(returns, event.time, back(&event.state));
        }
        self.latest = Some((step.end_time(), back(&step.end_state())));
    }

    /// The largest size of a displacement.
    fn displacement(&self) -> f64 {
        let displacements = self.ranges[..self.ranges.len() / 2].iter();
        displacements.copied().map(size).fold(0.0, f64::max)
    }

    /// Returns true if first-order states are constant, compared with the largest sizes so far:
    /// masses stick for as long as the integral of a controller grows.
    fn states_rest(&self, largest: &mut [f64]) -> bool {
        let mut rest = true;
        for ((_, range), largest) in std::iter::zip(&self.states, largest) {
            *largest = largest.max(size(*range));
            rest &= range.1 - range.0 <= AT_REST * *largest;
        }
        rest
    }

    /// Least and largest of each velocity.
    fn velocities(&self) -> impl Iterator<Item = (f64, f64)> {
        self.ranges[self.ranges.len() / 2..].iter().copied()
    }

    /// The coordinate whose velocity varies most.
    fn largest(&self) -> usize {
        let velocities = self.velocities().enumerate();
        let spread = |range: (f64, f64)| range.1 - range.0;
        let largest = velocities.max_by(|a, b| spread(a.1).total_cmp(&spread(b.1)));
        largest.map_or(0, |(i, _)| i)
    }

    /// The last state, at the beginning of a period of the drives if there are any.
    fn latest(&self, period: Option<f64>) -> Option<&(f64, State)> {
        match period {
            Some(_) => self.strobes.back(),
            None => self.latest.as_ref(),
        }
    }

    /// The returns to the event, or the turning point, that happens most rarely but often enough.
    fn section(&self) -> Option<&Returns> {
        let events = self.events.values().chain([&self.turns]);
        let often = events.filter(|(count, _)| *count >= LEAST_RETURNS);
        often
            .min_by_key(|(count, _)| *count)
            .map(|(_, returns)| returns)
    }

    /// Returns true if the states at the last tests, and at the last beginnings of periods of the
    /// drives, come ever nearer to a state.
    fn decays_to(&self, rest: &State, tested: &[State]) -> bool {
        let away = |state: &State| self.apart(state, rest);
        let returns = self.strobes.iter().map(|(_, state)| away(state));
        let returns: Vec<f64> = returns.collect();
        let tests: Vec<f64> = tested.iter().rev().take(SHORTER).map(away).collect();
        tests.len() == SHORTER
            && tests.windows(2).all(|pair| pair[0] <= DECAYS * pair[1])
            && returns.windows(2).all(|pair| pair[1] <= pair[0])
    }

    /// The largest difference of displacements and velocities, in units of their ranges.
    fn apart(&self, a: &State, b: &State) -> f64 {
        let n = self.ranges.len() / 2;
        let vector = |state: &State| {
            let numbers = state.displacements.iter().chain(&state.velocities);
            DVector::from_iterator(2 * n, numbers.copied())
        };
        let apart = (vector(a) - vector(b)).abs();
        let ranges = self.ranges.iter().map(|range| range.1 - range.0);
        let mut ranges: Vec<f64> = ranges.collect();
        for part in ranges.chunks_mut(n) {
            // Coordinates that hardly move are measured by those that do.
            let largest = part.iter().copied().fold(0.0, f64::max);
            for range in part {
                *range = range.max(1e-3 * largest);
            }
        }
        let parts = std::iter::zip(apart.iter(), ranges);
        let parts = parts.map(|(apart, range)| if *apart == 0.0 { 0.0 } else { apart / range });
        parts.fold(0.0, f64::max)
    }
}

/// A number for each kind of event.
fn rank(kind: EventKind) -> u8 {
    let side = |direction: Direction| u8::from(direction == Direction::Leading);
    match kind {
        EventKind::Stick => 0,
        EventKind::Open => 1,
        EventKind::Close => 2,
        EventKind::Release(direction) => 3 + side(direction),
        EventKind::Crossing(direction) => 5 + side(direction),
    }
}
