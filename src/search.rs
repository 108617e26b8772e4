//! The bound of the work of a search, and its watcher: of periodic motions of any system, and of
//! the belt along a parameter.

use std::cell::Cell;
use std::fmt;
use std::ops::ControlFlow;

use crate::error::Error;
use crate::motion::Integrator;

/// Limit of steps of all the motions of one search: seconds for one mass.
pub(crate) const MOST_STEPS_OF_A_SEARCH: usize = 10 * Integrator::DEFAULT_MAX_STEPS;

/// Steps after which the watcher of a search is called again.
pub(crate) const LOOK_EVERY: usize = 1000;

/// A search with bounds of its work and a watcher, a function that can stop the search. The methods
/// of `Search` have the names of the functions of [`orbit`](crate::orbit) and return the same
/// results. Searches of a mass on a belt along a parameter take a `Search` by
/// [`Along::with_search`](crate::bifurcation::Along::with_search), whose page states their cost.
///
/// # Cost
///
/// In a search of [`orbit`](crate::orbit) the unit of work is an integration step, which takes a
/// few microseconds per mass. An oscillation takes about ten steps, more if many contacts have
/// events. Most searches also compute the derivative of the motion with respect to its start. For a
/// few masses, a motion with its derivative takes two to three and a half times as long as the
/// motion alone. For 20 masses, it takes four to eight times as long.
///
/// | search | work |
/// |---|---|
/// | [`settle`](Self::settle) | the transient, then [`shoot`](Self::shoot) |
/// | [`shoot`](Self::shoot) | five to ten motions over a period, each with its derivative |
/// | [`classify`](Self::classify) | the motion until it repeats itself, at most about an eighth of the bound of steps, and some searches by [`shoot`](Self::shoot) |
/// | [`sweep`](Self::sweep) | [`classify`](Self::classify) twice for each value |
/// | [`vibration_ranges`](Self::vibration_ranges) | a [`sweep`](Self::sweep) of 17 values, and [`follow`](Self::follow) for each branch |
/// | [`begin`](Self::begin), [`switch`](Self::switch) | some tens of motions with derivatives |
/// | [`lyapunov_with_spread`](Self::lyapunov_with_spread) | two to three times the work of the motion alone: for three masses, about 13 s at the limit of 10⁶ steps |
/// | [`sensitivities`](Self::sensitivities) | about twenty motions for each parameter; some more if events of several contacts happen at the same instant |
/// | [`orbit_sensitivities`](Self::orbit_sensitivities) | twice as many motions over a period |
/// | [`locus`](Self::locus) | for each point, three to five steps of Newton's method; each step takes about ten motions with derivatives |
/// | [`locus`](Self::locus) of grazings, onsets of stops or simultaneous events | the same steps; each takes one motion without derivative for each unknown |
/// | [`follow`](Self::follow) | at least 65 points over the range, each with one or two motions with derivatives and some without; some tens of motions for each bifurcation; about a hundred motions for each change of the events |
///
/// A branch of one mass therefore takes a fraction of a second, and a branch of a drill string of
/// 20 inertias about ten seconds. Ranges with many bifurcations, and motions with long periods,
/// take minutes. A watcher shows the progress, and can stop the search:
///
/// ```
/// use std::ops::ControlFlow::{Break, Continue};
/// use std::time::{Duration, Instant};
/// use stick_slip::orbit::{BranchEnd, Period, Search};
/// use stick_slip::{MassOnBelt, Polynomial};
///
/// let law = Polynomial::new(0.4, 0.25, 0.5)?;
/// let family = |belt_velocity: f64| MassOnBelt::new(law, belt_velocity)?.with_damping(0.05);
/// let (system, begin) = (family(0.2)?, Instant::now());
///
/// // Stop after a minute.
/// let search = Search::new().watched(|_| {
///     if begin.elapsed() < Duration::from_secs(60) { Continue(()) } else { Break(()) }
/// });
/// let orbit = search.shoot(&system, &(0.1, 0.2).into(), Period::Free(7.0))?;
/// let branch = search.follow(family, 0.2, &orbit, 0.05..0.5)?;
/// assert_eq!(branch.ends[0], BranchEnd::Range);
///
/// // A search that is stopped keeps what it has found.
/// let ten = Search::new().watched(|progress| {
///     if progress.points < 10 { Continue(()) } else { Break(()) }
/// });
/// let part = ten.follow(family, 0.2, &orbit, 0.05..0.5)?;
/// assert_eq!(part.points.len(), 11); // with the first
/// assert!(matches!(part.ends[1], BranchEnd::Stopped { .. }));
/// let whole: Vec<f64> = branch.points.iter().map(|point| point.parameter).collect();
/// assert!(part.points.iter().all(|point| whole.contains(&point.parameter)));
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[must_use]
#[derive(Default)]
pub struct Search<'w> {
    max_steps: Option<usize>,
    max_points: Option<usize>,
    watch: Option<Box<Watcher<'w>>>,
}

type Watcher<'w> = dyn Fn(&Progress) -> ControlFlow<()> + 'w;

/// The progress of a search. See [`Search::watched`].
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct Progress {
    /// Value of the parameter that is being tried, in its own units, in a search along a parameter.
    /// Time that the motion has reached, in units of time, in a search on one system.
    pub value: f64,
    /// Value of the second parameter in a search over two parameters ([`locus`](Search::locus));
    /// otherwise `None`.
    pub second: Option<f64>,
    /// Number of motions found so far, not counting the first motion; 0 in a search on one system.
    /// In a search by [`Along`](crate::bifurcation::Along): number of systems searched so far.
    pub points: usize,
    /// Number of steps so far, the unit of the work.
    pub steps: usize,
}

impl<'w> Search<'w> {
    /// The default bound of the work on one system: 10⁶ steps, which take seconds for one mass.
    pub const DEFAULT_MAX_STEPS: usize = MOST_STEPS_OF_A_SEARCH;
    /// The default bound of the work of a search over one parameter: 10⁷ steps. It applies to
    /// [`follow`](Self::follow) in each direction, to [`sensitivities`](Self::sensitivities) and
    /// [`orbit_sensitivities`](Self::orbit_sensitivities), and to the searches of
    /// [`bifurcation`](crate::bifurcation) over a range, a damping or a load, which take ten to
    /// twenty seconds for so many steps.
    pub const DEFAULT_MAX_BRANCH_STEPS: usize = 10 * MOST_STEPS_OF_A_SEARCH;
    /// The default bound of the work of [`locus`](Self::locus) in each direction: 2·10⁷ steps.
    pub const DEFAULT_MAX_LOCUS_STEPS: usize = 20 * MOST_STEPS_OF_A_SEARCH;
    /// The default bound of the points of [`follow`](Self::follow) and [`locus`](Self::locus) in
    /// each direction.
    pub const DEFAULT_MAX_POINTS: usize = 2048;

    /// Creates a search with the default bounds and without a watcher.
    pub fn new() -> Self {
        Self::default()
    }

    /// Bounds the steps of each search. If the bound is reached, a branch ends with
    /// [`BranchEnd::Work`](crate::orbit::BranchEnd::Work), and a locus ends with
    /// [`LocusEnd::Work`](crate::orbit::LocusEnd::Work). A search by
    /// [`Along`](crate::bifurcation::Along) returns [`Error::Stopped`]. A search on one system
    /// returns [`Error::TooManySteps`], or, if Newton's method has begun, [`Error::NotPeriodic`].
    ///
    /// The defaults are [`DEFAULT_MAX_STEPS`](Self::DEFAULT_MAX_STEPS) on one system,
    /// [`DEFAULT_MAX_BRANCH_STEPS`](Self::DEFAULT_MAX_BRANCH_STEPS) over one parameter, and
    /// [`DEFAULT_MAX_LOCUS_STEPS`](Self::DEFAULT_MAX_LOCUS_STEPS) for a locus. In a search on one
    /// system, a single motion over a period may take a tenth of the bound, at least 10⁵ steps, but
    /// never more than the bound. On a branch or a locus, a single motion may take 10⁵ steps. The
    /// bound does not apply to [`begin`](Self::begin) and [`switch`](Self::switch), which compute
    /// some hundred motions at most.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] for 0.
    pub fn with_max_steps(self, max_steps: usize) -> Result<Self, Error> {
        let max_steps = Some(positive("max_steps", max_steps, "max_steps > 0")?);
        Ok(Self { max_steps, ..self })
    }

    /// Bounds the points of a branch or a locus in each direction.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] for 0.
    pub fn with_max_points(self, max_points: usize) -> Result<Self, Error> {
        let max_points = Some(positive("max_points", max_points, "max_points > 0")?);
        Ok(Self { max_points, ..self })
    }

    /// Sets the watcher, a function that shows the progress or stops the search by returning
    /// [`ControlFlow::Break`]. The function is called every 1000 steps. A search along a parameter
    /// also calls it before each motion that is tried and after each motion that is found. A search
    /// by [`Along`](crate::bifurcation::Along) calls it before each system only.
    ///
    /// A branch or a locus that is stopped contains the motions found so far, and ends with
    /// [`BranchEnd::Stopped`](crate::orbit::BranchEnd::Stopped) or
    /// [`LocusEnd::Stopped`](crate::orbit::LocusEnd::Stopped). [`sweep`](Self::sweep) and
    /// [`vibration_ranges`](Self::vibration_ranges) return the results so far. Any other search
    /// returns [`Error::Stopped`].
    pub fn watched(self, watch: impl Fn(&Progress) -> ControlFlow<()> + 'w) -> Self {
        Self {
            watch: Some(Box::new(watch)),
            ..self
        }
    }

    /// Returns this search, which also notes the value of the parameter at which its watcher stops
    /// it.
    pub(crate) fn noting<'s>(&'s self, stopped: &'s Cell<Option<f64>>) -> Search<'s> {
        let search = Search {
            max_steps: self.max_steps,
            max_points: self.max_points,
            watch: None,
        };
        let Some(watch) = &self.watch else {
            return search;
        };
        search.watched(move |progress| {
            let flow = watch(progress);
            if flow.is_break() {
                stopped.set(stopped.get().or(Some(progress.value)));
            }
            flow
        })
    }

    /// The bound of the steps on one system.
    pub(crate) fn steps(&self) -> usize {
        self.max_steps.unwrap_or(Self::DEFAULT_MAX_STEPS)
    }

    /// The bound of the steps of all motions over one parameter.
    pub(crate) fn steps_over_a_parameter(&self) -> usize {
        self.max_steps.unwrap_or(Self::DEFAULT_MAX_BRANCH_STEPS)
    }

    /// The bounds of a branch in each direction: steps and points.
    pub(crate) fn of_branch(&self) -> (usize, usize) {
        (
            self.steps_over_a_parameter(),
            self.max_points.unwrap_or(Self::DEFAULT_MAX_POINTS),
        )
    }

    /// The bounds of a curve in two parameters in each direction: steps and points.
    pub(crate) fn of_locus(&self) -> (usize, usize) {
        (
            self.max_steps.unwrap_or(Self::DEFAULT_MAX_LOCUS_STEPS),
            self.max_points.unwrap_or(Self::DEFAULT_MAX_POINTS),
        )
    }

    /// The watch over one search: on one system with the parameter `time`.
    pub(crate) fn watch(&self, parameter: &'static str) -> Watched<'_> {
        Watched {
            watch: self.watch.as_deref(),
            parameter,
            value: Cell::new(None),
            second: Cell::new(None),
            points: Cell::new(0),
            steps: Cell::new(0),
            stopped: Cell::new(None),
        }
    }
}

fn positive(name: &'static str, count: usize, allowed: &'static str) -> Result<usize, Error> {
    Error::check("Search", name, count as f64, count > 0, allowed)?;
    Ok(count)
}

impl fmt::Debug for Search<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Search")
            .field("max_steps", &self.max_steps)
            .field("max_points", &self.max_points)
            .field("watched", &self.watch.is_some())
            .finish()
    }
}

/// The progress of one search, and whether it was stopped.
pub(crate) struct Watched<'w> {
    watch: Option<&'w Watcher<'w>>,
    parameter: &'static str,
    /// The value of the parameter at hand; on one system `None`.
    value: Cell<Option<f64>>,
    second: Cell<Option<f64>>,
    points: Cell<usize>,
    /// Steps of the motions before the one at hand.
    steps: Cell<usize>,
    /// The value at which it was stopped.
    stopped: Cell<Option<Progress>>,
}

impl Watched<'_> {
    /// Another value of the parameter is at hand.
    pub(crate) fn at(&self, value: f64) {
        self.value.set(Some(value));
    }

    /// Other values of two parameters are at hand.
    pub(crate) fn at_pair(&self, first: f64, second: f64) {
        self.value.set(Some(first));
        self.second.set(Some(second));
    }

    /// Counts one more motion, found at a value of the parameter.
    pub(crate) fn found(&self, value: f64) {
        self.at(value);
        self.points.set(self.points.get() + 1);
        self.look(value, 0);
    }

    /// Counts the steps of a motion that has ended.
    pub(crate) fn add(&self, steps: usize) {
        self.steps.set(self.steps.get().saturating_add(steps));
    }

    /// Counts a system of a search along a parameter, unless the watcher or a bound of the steps
    /// stops the search before it.
    pub(crate) fn begin(&self, value: f64, most: usize) -> Result<(), Error> {
        self.at(value);
        let progress = self.progress(value, 0);
        if progress.steps >= most {
            self.stopped.set(Some(progress));
        } else {
            self.look(value, 0);
        }
        self.points.set(progress.points + 1);
        self.check()
    }

    pub(crate) fn is_stopped(&self) -> bool {
        self.stopped.get().is_some()
    }

    /// Shows the progress, after so many steps of the motion at hand, which has reached a time.
    pub(crate) fn look(&self, time: f64, steps: usize) {
        let progress = self.progress(time, steps);
        if self.watch.is_some_and(|watch| watch(&progress).is_break()) {
            self.stopped.set(Some(progress));
        }
    }

    fn progress(&self, time: f64, steps: usize) -> Progress {
        Progress {
            value: self.value.get().unwrap_or(time),
            second: self.second.get(),
            points: self.points.get(),
            steps: self.steps.get().saturating_add(steps),
        }
    }

    /// The error if the search was stopped.
    pub(crate) fn check(&self) -> Result<(), Error> {
        match self.stopped.get() {
            None => Ok(()),
            Some(Progress { value, steps, .. }) => Err(Error::Stopped {
                parameter: self.parameter,
                value,
                steps,
                found: Vec::new(),
            }),
        }
    }
}

impl fmt::Debug for Watched<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Watched")
            .field("stopped", &self.stopped)
            .finish_non_exhaustive()
    }
}
