//! Searches along a parameter: the family of systems and the range.

use std::fmt::{self, Debug, Formatter};
use std::ops::Range;

use crate::belt::{Belt, Forward, MassOnBelt};
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::limit_cycle::Tracer;
use crate::search::{Search, Watched};

/// The search of a family of systems along a parameter: a load, a damping, a coefficient of the
/// law, a belt velocity, or any other number.
///
/// `family` returns the system for a value of the parameter. The system should be continuous in the
/// parameter, except at a few values. The range may contain negative values; no symmetry about 0 is
/// assumed. The methods of [`Along`] run the searches.
///
/// ```
/// use stick_slip::{Error, Exponential, MassOnBelt, bifurcation};
///
/// // At which load does steady sliding become unstable, and at which does stick-slip appear?
/// let law = Exponential::new(0.4, 0.25, 0.5)?;
/// let brake = |load: f64| MassOnBelt::new(law, 0.4)?.with_damping(0.05)?.with_load(load);
/// let search = bifurcation::along(brake, 0.01..2.0).named("load");
/// let [hopf] = search.hopf()?[..] else { panic!() };
/// // 2β + γ² dμ̂/ds = 0, with dμ̂/ds = −1.2 v_b exp(−4 v_b²)
/// let expected = 0.1 / (1.2 * 0.4 * (-0.64_f64).exp());
/// assert!((hopf - expected).abs() < 4e-16);
/// let [grazing] = search.grazing()?[..] else { panic!() };
/// assert!(grazing > 0.0 && grazing < 2.0);
/// # Ok::<(), Error>(())
/// ```
#[doc(alias = "sweep")]
#[doc(alias = "continuation")]
pub fn along<'f, L: FrictionLaw>(
    family: impl Fn(f64) -> Result<MassOnBelt<L>, Error> + 'f,
    range: Range<f64>,
) -> Along<'f, L> {
    Along::of(Family::Systems(Box::new(family)), range, "parameter")
}

/// A search over the belt velocity of one system, for Hopf points, grazings, folds and other
/// changes of its motions. The methods of [`Along`] return the same results as
/// [`hopf_velocities`](super::hopf_velocities), [`grazing_velocities`](super::grazing_velocities)
/// and the other functions for belt velocities. [`Along`] can also bound the work and be watched.
/// The system's own belt velocity is ignored.
///
/// A range with velocities of both signs is searched in two parts, below and above 0.
///
/// ```
/// use stick_slip::{MassOnBelt, Polynomial, bifurcation};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let grazing = bifurcation::along_velocities(&system, -0.5..0.5).grazing()?;
/// assert_eq!(grazing.len(), 2);
/// assert!((grazing[0] + grazing[1]).abs() < 1e-15);
/// assert_eq!(grazing[1], bifurcation::grazing_velocities(&system, 0.0..0.5)?[0]);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn along_velocities<L: FrictionLaw>(system: &MassOnBelt<L>, range: Range<f64>) -> Along<'_, L> {
    Along::of(Family::Velocities(system), range, "belt_velocity")
}

/// A search along a parameter, returned by [`along`] and [`along_velocities`]. Values of the
/// parameter are in its own units.
///
/// # Cost
///
/// The unit of work is one step of a slip phase, which takes about a microsecond. If friction is
/// stiff, Newton's method computes the power series of a step several times, and each computation
/// counts as one step. An oscillation takes about ten steps, and two more for each breakpoint of
/// the law that it passes.
///
/// A search computes 65 systems, and some tens more for each value that is found. For each system
/// [`hopf`](Self::hopf) takes no steps. [`grazing`](Self::grazing), [`touching`](Self::touching)
/// and [`overshoot`](Self::overshoot) compute one slip arc, and [`crossing`](Self::crossing)
/// computes two. [`folds`](Self::folds) computes some ten oscillations for a smooth law, and up to
/// a hundred for a table of scattered points. [`vibration_ranges`](Self::vibration_ranges) runs all
/// these six searches.
///
/// A million steps take one to two seconds. For example, the folds for a table of n widely
/// scattered points take about 200 n² steps: a second for 60 points, and half a minute to a minute
/// for 400 points. For 400 points the default bound of the work must be raised.
///
/// A search stops if the number of steps reaches its bound, or if its watcher, a function of yours,
/// stops it. [`with_search`](Self::with_search) sets both; the default bound is
/// [`Search::DEFAULT_MAX_BRANCH_STEPS`]. Bound and watcher are checked before each system; one
/// system takes at most about 2·10⁵ steps. A search that stops returns [`Error::Stopped`] with the
/// value reached and the results below this value, so no result is lost. After this error, raise
/// the bound, smooth a table of scattered points, or search the rest of the range.
pub struct Along<'f, L> {
    family: Family<'f, L>,
    range: Range<f64>,
    parameter: &'static str,
    search: Search<'f>,
}

/// The systems of a search, one for each value of the parameter.
enum Family<'f, L> {
    /// One system at any belt velocity.
    Velocities(&'f MassOnBelt<L>),
    Systems(Box<dyn Fn(f64) -> Result<MassOnBelt<L>, Error> + 'f>),
}

impl<'f, L: FrictionLaw> Along<'f, L> {
    fn of(family: Family<'f, L>, range: Range<f64>, parameter: &'static str) -> Self {
        Self {
            family,
            range,
            parameter,
            search: Search::new(),
        }
    }

    /// Sets the name of the parameter. Errors contain this name.
    #[must_use]
    pub fn named(self, parameter: &'static str) -> Self {
        Self { parameter, ..self }
    }

    /// Sets the bound of the work and the watcher: those of `search`.
    ///
    /// ```
    /// use std::ops::ControlFlow::{Break, Continue};
    /// use stick_slip::{Error, MassOnBelt, Polynomial, Search, bifurcation};
    ///
    /// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
    /// let along = || bifurcation::along_velocities(&system, 0.01..0.5);
    /// match along().with_search(Search::new().with_max_steps(700)?).grazing() {
    ///     // The velocity 0.3958 is among those that were found before the search was stopped.
    ///     Err(Error::Stopped { value, steps, found, .. }) => {
    ///         assert!(value < 0.5 && steps >= 700);
    ///         assert_eq!(found.len(), 1);
    ///     }
    ///     other => panic!("{other:?}"),
    /// }
    /// // A watcher that stops the search at the velocity 0.25.
    /// let half = Search::new().watched(|progress| {
    ///     if progress.value < 0.25 { Continue(()) } else { Break(()) }
    /// });
    /// match along().with_search(half).grazing() {
    ///     Err(Error::Stopped { value, found, .. }) => assert!(value >= 0.25 && found.is_empty()),
    ///     other => panic!("{other:?}"),
    /// }
    /// # Ok::<(), Error>(())
    /// ```
    #[must_use]
    pub fn with_search(self, search: Search<'f>) -> Self {
        Self { search, ..self }
    }

    /// Runs a search without the type of the law: see [`RangeSearch`].
    pub(super) fn search<T>(
        &self,
        search: impl FnOnce(&RangeSearch<'_>) -> Result<T, Error>,
    ) -> Result<T, Error> {
        let systems = |value: f64, look: &mut Visit<'_>| self.show(value, look);
        search(&RangeSearch {
            systems: &systems,
            velocities_of: match &self.family {
                Family::Velocities(system) => Some(system.belt()),
                Family::Systems(_) => None,
            },
            range: self.range.clone(),
            parameter: self.parameter,
            search: &self.search,
        })
    }

    /// Searches the parts of the range: see [`RangeSearch::over_parts`].
    #[inline(never)]
    pub(super) fn over_parts(&self, part: &mut SearchPart<'_>) -> Result<Vec<f64>, Error> {
        self.search(|search| search.over_parts(part))
    }

    /// Shows the system at a value of the parameter.
    fn show(&self, value: f64, look: &mut Visit<'_>) -> Result<(), Error> {
        match &self.family {
            Family::Velocities(system) => system.belt().with_belt_velocity(value).and_then(look),
            Family::Systems(family) => family(value).and_then(|system| look(system.belt())),
        }
    }
}

/// A function called with a system.
pub(crate) type Visit<'l> = dyn FnMut(Belt<'_>) -> Result<(), Error> + 'l;

/// An [`Along`] of any law.
pub(super) struct RangeSearch<'f> {
    /// Shows the system at a value of the parameter.
    systems: &'f dyn Fn(f64, &mut Visit<'_>) -> Result<(), Error>,
    /// The system, if the parameter is the velocity of its belt.
    pub(super) velocities_of: Option<Belt<'f>>,
    range: Range<f64>,
    parameter: &'static str,
    search: &'f Search<'f>,
}

impl<'f> RangeSearch<'f> {
    /// A search of a family at values of its own choice.
    pub(super) fn of(
        systems: &'f dyn Fn(f64, &mut Visit<'_>) -> Result<(), Error>,
        parameter: &'static str,
        search: &'f Search<'f>,
    ) -> Self {
        Self {
            systems,
            velocities_of: None,
            range: 0.0..f64::INFINITY,
            parameter,
            search,
        }
    }

    /// The range, if it is finite and not empty.
    pub(super) fn whole(&self) -> Result<Range<f64>, Error> {
        let names = ["range.start", "range.end"];
        Error::check_range("bifurcation::along", names, &self.range)?;
        Ok(self.range.clone())
    }

    /// The parts of the range that are searched, ascending: the belt moves differently on the two
    /// sides of v_b = 0.
    pub(super) fn parts(&self) -> Result<Vec<Range<f64>>, Error> {
        let Range { start, end } = self.whole()?;
        let is_split = self.velocities_of.is_some() && start < 0.0 && end > 0.0;
        Ok(if is_split {
            vec![start..0.0, 0.0..end]
        } else {
            vec![start..end]
        })
    }

    /// Searches the parts of the range one after the other, with one work counter. A search adds
    /// its results to the list, so that they are kept when it is stopped.
    pub(super) fn over_parts(&self, search: &mut SearchPart<'_>) -> Result<Vec<f64>, Error> {
        let work = Work::of(self);
        let mut found = Vec::new();
        for part in self.parts()? {
            if let Err(mut error) = search(&work, &part, &mut found) {
                if let Error::Stopped { found: values, .. } = &mut error {
                    found.sort_by(f64::total_cmp);
                    *values = found;
                }
                return Err(error);
            }
        }
        Ok(found)
    }
}

/// The search of one part of a range.
pub(super) type SearchPart<'s> =
    dyn FnMut(&Work<'_, '_>, &Range<f64>, &mut Vec<f64>) -> Result<(), Error> + 's;

/// The work of a search so far.
pub(super) struct Work<'a, 'f> {
    pub(super) search: &'a RangeSearch<'f>,
    watched: Watched<'a>,
}

impl<'a, 'f> Work<'a, 'f> {
    pub(super) fn of(search: &'a RangeSearch<'f>) -> Self {
        Self {
            search,
            watched: search.search.watch(search.parameter),
        }
    }

    /// Calls `look` with the system at a value of the parameter. An error gets the value.
    pub(super) fn with_system(&self, value: f64, look: &mut Visit<'_>) -> Result<(), Error> {
        let most = self.search.search.steps_over_a_parameter();
        self.watched.begin(value, most)?;
        (self.search.systems)(value, look).map_err(|error| error.at(self.search.parameter, value))
    }

    /// The result of `look` for the system at a value of the parameter, with its belt moving
    /// forward; `None` if the belt stands still.
    pub(super) fn moving_at<T>(
        &self,
        value: f64,
        look: &mut dyn FnMut(&mut Tracer<'_>) -> Result<T, Error>,
    ) -> Result<Option<T>, Error> {
        let mut found = None;
        self.with_tracer(value, &mut |tracer| {
            found = Some(look(tracer)?);
            Ok(())
        })?;
        Ok(found)
    }

    /// Gives the tracer of the system at a value to a function; compiled once for all result types.
    fn with_tracer(
        &self,
        value: f64,
        look: &mut dyn FnMut(&mut Tracer<'_>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        self.with_system(value, &mut |system| {
            let Some(forward) = Forward::of(system) else {
                return Ok(());
            };
            let mut tracer = Tracer::new(forward);
            let looked = look(&mut tracer);
            self.watched.add(tracer.work());
            looked
        })
    }
}

impl<L> Debug for Along<'_, L> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.debug_struct("Along")
            .field("parameter", &self.parameter)
            .field("range", &self.range)
            .field("search", &self.search)
            .finish_non_exhaustive()
    }
}
