//! The settings of a run, and the loop that collects its steps: up to a stop condition, an error or
//! the end of the duration, whichever comes first.

use super::sealed::{self, State as _};
use super::{Ended, Segment, System, SystemState, Trajectory};
use crate::error::Error;

/// A stop condition: called with each step, it returns the time of the end, or `None`.
pub(crate) type Stop<'s, Step> = &'s mut dyn FnMut(&Step) -> Option<f64>;

/// The steps of a motion, one after the other.
pub(crate) type Steps<'s, Step> = &'s mut dyn Iterator<Item = Result<Step, Error>>;

/// Settings of the integrator: tolerance and limits of work.
///
/// Each step of a slip phase is a Taylor series of order 26. Slip ends at the first root of the
/// polynomial of the sliding speed. Stick of a [`MassOnBelt`](crate::MassOnBelt) is computed by
/// closed formulas. The page [`guarantees`](crate::guarantees) states what this method promises.
///
/// ```
/// use stick_slip::{Integrator, MassOnBelt, Polynomial, State};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let fast = Integrator::new()
///     .with_tolerance(1e-6)?
///     .simulate(&system, State::new(0.0, 0.0), 50.0)?;
/// let exact = Integrator::new().simulate(&system, State::new(0.0, 0.0), 50.0)?;
/// assert_eq!(fast.events().len(), exact.events().len());
/// assert!((fast.events()[9].time - exact.events()[9].time).abs() < 1e-5);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "solver")]
#[doc(alias = "ode")]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrator {
    tolerance: f64,
    start_time: f64,
    max_steps: Option<usize>,
    max_events: Option<usize>,
}

impl Integrator {
    /// The default tolerance: 2⁻⁵², the relative spacing of numbers of type `f64`. In a simulation
    /// a smaller tolerance takes more steps and does not improve the result.
    pub const ROUND_OFF: f64 = f64::EPSILON;
    /// The least tolerance. The searches for limit cycles use this tolerance, because a cycle that
    /// is almost neutrally stable magnifies the error of a step.
    pub const MIN_TOLERANCE: f64 = 1e-16;
    /// The largest tolerance.
    pub const MAX_TOLERANCE: f64 = 1e-2;
    /// The default limit of steps, after which [`simulate`](Self::simulate) returns an error. One
    /// oscillation takes about ten steps.
    pub const DEFAULT_MAX_STEPS: usize = 100_000;

    /// Creates the default settings: a tolerance at round-off, at most
    /// [`DEFAULT_MAX_STEPS`](Self::DEFAULT_MAX_STEPS) steps in `simulate`, and no limit of steps in
    /// `flow`.
    pub const fn new() -> Self {
        Self {
            tolerance: Self::ROUND_OFF,
            start_time: 0.0,
            max_steps: None,
            max_events: None,
        }
    }

    /// Sets the relative tolerance: the error of a step in units of the scale of the motion. For a
    /// [`MassOnBelt`](crate::MassOnBelt) the scale is max(|u − ū|, |v|, |v_b|), where u and v are
    /// displacement and velocity, ū is the displacement of steady sliding, and v_b is the belt
    /// velocity. In a [`Structure`](crate::Structure) each coordinate has its own scale, formed
    /// from its velocity, its acceleration and the velocity of its belt.
    ///
    /// A slip phase of a `MassOnBelt` is stiff if its effective damping D = 2β + γ²·dμ̂/ds is large
    /// (β: damping ratio, γ²: friction load, μ̂: kinetic coefficient, s: sliding speed). The scale
    /// is then max(|v|, |v_b|, |v'|/|D|), and 1e-12 replaces any larger tolerance. The smaller
    /// tolerance costs few steps: see [`guarantees`](crate::guarantees#one-mass-on-a-belt).
    ///
    /// # Errors
    ///
    /// [`Error::InvalidTolerance`] unless 1e-16 ≤ tolerance ≤ 1e-2.
    pub fn with_tolerance(mut self, tolerance: f64) -> Result<Self, Error> {
        if !(Self::MIN_TOLERANCE..=Self::MAX_TOLERANCE).contains(&tolerance) {
            return Err(Error::InvalidTolerance {
                value: tolerance,
                min: Self::MIN_TOLERANCE,
                max: Self::MAX_TOLERANCE,
            });
        }
        self.tolerance = tolerance;
        Ok(self)
    }

    /// Sets the time at which the motion starts; 0 unless set.
    ///
    /// The drives of a [`Structure`](crate::Structure) are functions of time. Events and states
    /// have times on the same scale: the first state has the start time, not 0.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless the time is finite.
    pub fn with_start_time(mut self, time: f64) -> Result<Self, Error> {
        self.start_time = Error::check("Integrator", "start_time", time, true, "any time")?;
        Ok(self)
    }

    /// Sets the largest number of steps of one run, for both `simulate` and `flow`.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] for 0.
    pub fn with_max_steps(mut self, max_steps: usize) -> Result<Self, Error> {
        Error::check(
            "Integrator",
            "max_steps",
            max_steps as f64,
            max_steps > 0,
            "max_steps > 0",
        )?;
        self.max_steps = Some(max_steps);
        Ok(self)
    }

    /// Sets the largest number of events of one run, for both `simulate` and `flow`. A run with
    /// more events than this number returns an error. (To end a motion **at** an event, see
    /// [`simulate_until`](Self::simulate_until).)
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] for 0.
    pub fn with_max_events(mut self, max_events: usize) -> Result<Self, Error> {
        Error::check(
            "Integrator",
            "max_events",
            max_events as f64,
            max_events > 0,
            "max_events > 0",
        )?;
        self.max_events = Some(max_events);
        Ok(self)
    }

    /// The motion from `start` over `duration`, both in the units of the system: dimensionless for
    /// a [`MassOnBelt`](crate::MassOnBelt).
    ///
    /// # Errors
    ///
    /// * [`Error::InvalidDuration`] unless `duration` is finite and ≥ 0;
    /// * [`Error::InvalidState`] if a displacement or a velocity of `start` is not finite. For a
    ///   [`MassOnBelt`](crate::MassOnBelt) also if max(|u − ū|, |v|, |v_b|) is below 1e-280, but
    ///   not 0, or above 1e300 (u and v: displacement and velocity of `start`, ū: displacement of
    ///   steady sliding, v_b: belt velocity);
    /// * if the integration fails, [`Error::NonFiniteFriction`], [`Error::NotAnalytic`],
    ///   [`Error::StepUnderflow`], [`Error::TooManySteps`] or [`Error::TooManyEvents`], with the
    ///   time and state reached;
    /// * [`Error::InvalidParameter`] if μ_s of a `MassOnBelt` turns NaN during the motion;
    /// * for a [`Structure`](crate::Structure) also [`Error::WrongSize`] if `start` does not have
    ///   the size of the structure, and [`Error::InvalidParameter`] if a memory variable of `start`
    ///   is not finite or makes a static coefficient negative, or if a relative velocity of `start`
    ///   is not finite or belongs to no rigid contact;
    /// * for contacts of a `Structure` also [`Error::OverLimit`], [`Error::Separation`],
    ///   [`Error::TooManyMechanisms`], [`Error::Jammed`] and [`Error::WrongWay`];
    /// * for other laws of a `Structure` [`Error::NonFiniteForce`] and [`Error::NotAnalyticForce`]
    ///   (force elements), [`Error::NonFiniteLoad`] and [`Error::NotAnalyticLoad`] (loads),
    ///   [`Error::NonFiniteRate`] and [`Error::NotAnalyticRate`] (first-order states).
    #[doc(alias = "integrate")]
    #[doc(alias = "solve")]
    pub fn simulate<S: System>(
        self,
        system: &S,
        start: impl Into<S::State>,
        duration: f64,
    ) -> Result<Trajectory<S::State>, Error> {
        let motion = self.run(system, start.into(), duration, None)?;
        match motion.ended() {
            Ended::Error(error) => Err(error.clone()),
            Ended::Duration | Ended::Stopped => Ok(motion),
        }
    }

    /// The motion from `start` until `stop` ends it, until `duration` is over, or until the
    /// integration fails. The result is the motion up to this end, unless the first step fails.
    /// [`Trajectory::ended`] returns the reason for the end.
    ///
    /// `stop` is called with each step, in order. It returns the time at which the motion shall
    /// end, between the start and the end time of this step, or `None` to continue. (A finite time
    /// outside the step is replaced by the nearer end of the step.) A motion that is stopped at the
    /// end of a step keeps the events at this end, and its last modes are those after them. To stop
    /// at a condition on the state, return the result of [`Segment::first_zero`]. To stop after a
    /// number of events or steps, count them in `stop`:
    ///
    /// ```
    /// use stick_slip::{Ended, Integrator, MassOnBelt, Polynomial, Segment, State};
    ///
    /// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
    /// let (start, integrator) = (State::new(0.0, 0.0), Integrator::new());
    ///
    /// // Up to the displacement 0.35, in stick.
    /// let motion = integrator.simulate_until(&system, start, 100.0, |step| {
    ///     step.first_zero(|state| state.displacement - 0.35)
    /// })?;
    /// assert_eq!(motion.ended(), &Ended::Stopped);
    /// assert!((motion.last().displacement - 0.35).abs() < 1e-16);
    /// assert_eq!(motion.events().len(), 1);
    ///
    /// // Up to the fifth event.
    /// let mut events = 0;
    /// let motion = integrator.simulate_until(&system, start, 100.0, |step| {
    ///     events += step.events().len();
    ///     (events == 5).then(|| step.end_time())
    /// })?;
    /// assert_eq!(motion.duration(), motion.events()[4].time);
    ///
    /// // The first hundred steps, which do not reach the end.
    /// let motion = integrator.with_max_steps(100)?
    ///     .simulate_until(&system, start, 1e6, |_| None)?;
    /// assert!(matches!(motion.ended(), Ended::Error(_)));
    /// assert_eq!(motion.steps().len(), 100);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// [`Error::InvalidDuration`] as in [`simulate`](Self::simulate); the errors of
    /// [`flow`](Self::flow); [`Error::InvalidParameter`] if `stop` returns NaN or an infinite time;
    /// and the error of a motion that fails in its first step. Any later error of the motion is
    /// stored in the result.
    #[doc(alias = "event")]
    #[doc(alias = "condition")]
    pub fn simulate_until<S: System>(
        self,
        system: &S,
        start: impl Into<S::State>,
        duration: f64,
        mut stop: impl FnMut(&<S::State as SystemState>::Step) -> Option<f64>,
    ) -> Result<Trajectory<S::State>, Error> {
        self.run(system, start.into(), duration, Some(&mut stop))
    }

    /// The motion over a duration, or until it is stopped or fails.
    fn run<S: System>(
        self,
        system: &S,
        start: S::State,
        duration: f64,
        stop: Option<Stop<'_, <S::State as SystemState>::Step>>,
    ) -> Result<Trajectory<S::State>, Error> {
        Error::check_duration(duration)?;
        let limited = Self {
            max_steps: Some(self.max_steps.unwrap_or(Self::DEFAULT_MAX_STEPS)),
            ..self
        };
        let mut steps = limited.flow(system, start)?;
        S::State::trajectory(&mut steps, self.start_time, duration, stop)
    }

    /// The motion from `start`, step by step: an unbounded iterator in constant memory.
    ///
    /// ```
    /// use stick_slip::{Integrator, MassOnBelt, Polynomial, State};
    ///
    /// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
    /// let mut sticks = 0;
    /// for step in Integrator::new().flow(&system, State::new(0.0, 0.0))? {
    ///     let step = step?;
    ///     sticks += usize::from(step.mode() == stick_slip::Mode::Stick);
    ///     if step.end_time() > 1000.0 {
    ///         break;
    ///     }
    /// }
    /// assert_eq!(sticks, 147);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    ///
    /// # Errors
    ///
    /// The errors of [`simulate`](Self::simulate) for a start that is not valid. Later errors are
    /// items of the iterator; after an error the iterator returns `None`.
    pub fn flow<S: System>(
        self,
        system: &S,
        start: impl Into<S::State>,
    ) -> Result<S::Flow<'_>, Error> {
        sealed::Flow::new(system, self, start.into())
    }

    pub(crate) fn tolerance(self) -> f64 {
        self.tolerance
    }

    pub(crate) fn start_time(self) -> f64 {
        self.start_time
    }

    pub(crate) fn max_steps(self) -> Option<usize> {
        self.max_steps
    }

    pub(crate) fn max_events(self) -> Option<usize> {
        self.max_events
    }
}

impl Default for Integrator {
    fn default() -> Self {
        Self::new()
    }
}

/// The motion of these steps over a duration, or until it is stopped or fails.
pub(crate) fn trajectory<S: SystemState>(
    all: Steps<'_, S::Step>,
    start_time: f64,
    duration: f64,
    mut stop: Option<Stop<'_, S::Step>>,
) -> Result<Trajectory<S>, Error> {
    let mut end = start_time + duration;
    let mut steps: Vec<S::Step> = Vec::new();
    let mut reached = start_time;
    let mut ended = Ended::Duration;
    for step in all {
        let step = match step {
            Ok(step) => step,
            // The motion up to the end is complete: the step that failed lies beyond it.
            Err(_) if !steps.is_empty() && reached == end => break,
            Err(error) if steps.is_empty() => return Err(error),
            Err(error) => {
                ended = Ended::Error(error);
                break;
            }
        };
        // Pushed at once: a step is long, and copies cost time.
        let is_last = step.end_time() > end;
        if is_last {
            reached = end;
            steps.push(step.until(end));
        } else {
            reached = step.end_time();
            steps.push(step);
        }
        let asked = match (&mut stop, steps.last()) {
            (Some(stop), Some(step)) => stop(step).map(|time| (step, time)),
            _ => None,
        };
        if let Some((step, time)) = asked {
            let allowed = "a time in the step, or `None`; NaN may come from a function whose zero \
                           was searched";
            Error::check("Integrator", "stop time", time, true, allowed)?;
            reached = time.max(step.start_time()).min(step.end_time());
            ended = Ended::Stopped;
            // The modes after an event are those of the step that follows.
            if reached == step.end_time() {
                (end, stop) = (reached, None);
            } else {
                let cut = steps.pop().map(|step| step.until(reached));
                steps.extend(cut);
                break;
            }
        }
        if is_last {
            break;
        }
    }
    let duration = match ended {
        Ended::Duration => duration,
        Ended::Stopped | Ended::Error(_) => reached - start_time,
    };
    Ok(Trajectory::new(steps, start_time, duration, ended))
}
