use super::{Segment, System, SystemState, Trajectory};
use crate::error::Error;

/// Settings of the integrator: tolerance and limits of work.
///
/// Each step of a slip phase is a Taylor series of order 26. Contact is the first root of the
/// sliding speed's own polynomial. Stick has closed formulas. The
/// [crate page](crate#what-the-integrator-promises) says what this method promises.
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
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Integrator {
    tolerance: f64,
    start_time: f64,
    max_steps: Option<usize>,
    max_events: Option<usize>,
}

impl Integrator {
    /// The default tolerance: 2⁻⁵², the relative rounding error of a number. In a simulation a
    /// smaller tolerance takes more steps and gains nothing.
    pub const ROUND_OFF: f64 = f64::EPSILON;
    /// The least tolerance. The searches for limit cycles use it, because a cycle that is almost
    /// neutrally stable magnifies what a step leaves out.
    pub const MIN_TOLERANCE: f64 = 1e-16;
    /// The largest tolerance.
    pub const MAX_TOLERANCE: f64 = 1e-2;
    /// The default limit of steps, after which [`simulate`](Self::simulate) gives up. One
    /// oscillation takes about ten steps.
    pub const DEFAULT_MAX_STEPS: usize = 100_000;

    /// The default settings: a tolerance at round-off, and at most
    /// [`DEFAULT_MAX_STEPS`](Self::DEFAULT_MAX_STEPS) steps in `simulate`, without a limit in
    /// `flow`.
    pub const fn new() -> Self {
        Self {
            tolerance: Self::ROUND_OFF,
            start_time: 0.0,
            max_steps: None,
            max_events: None,
        }
    }

    /// Sets the relative tolerance: the error of a step in units of the motion's own scale,
    /// max(|u − ū|, |v|, |v_b|).
    ///
    /// In stiff systems the scale is max(|v|, |v_b|, |v'|/D): see the
    /// [crate page](crate#what-the-integrator-promises).
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
    /// The drives of a [`Structure`](crate::Structure) are functions of this time. The times of
    /// events and states count from the same zero as the drives do, not from the start.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless the time is finite.
    pub fn with_start_time(mut self, time: f64) -> Result<Self, Error> {
        self.start_time = Error::check("start_time", time, true, "any time")?;
        Ok(self)
    }

    /// Sets the largest number of steps of one run, for both `simulate` and `flow`.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] for 0.
    pub fn with_max_steps(mut self, max_steps: usize) -> Result<Self, Error> {
        Error::check(
            "max_steps",
            max_steps as f64,
            max_steps > 0,
            "max_steps > 0",
        )?;
        self.max_steps = Some(max_steps);
        Ok(self)
    }

    /// Sets the largest number of events of one run, for both `simulate` and `flow`. A run that
    /// would go on after more events than this ends in an error.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] for 0.
    pub fn with_max_events(mut self, max_events: usize) -> Result<Self, Error> {
        Error::check(
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
    /// * [`Error::InvalidState`] unless `start` is finite and, for a
    ///   [`MassOnBelt`](crate::MassOnBelt), the scale of the motion, max(|u − ū|, |v|, |v_b|), is 0
    ///   or from 1e-280 to 1e300;
    /// * if the motion cannot be followed further, [`Error::NonFiniteFriction`],
    ///   [`Error::NotAnalytic`], [`Error::StepUnderflow`], [`Error::TooManySteps`] or
    ///   [`Error::TooManyEvents`], with the time and state reached;
    /// * for a [`Structure`](crate::Structure) also [`Error::WrongSize`], if `start` does not have
    ///   its size; [`Error::InvalidParameter`], if a number of its memory is not finite or makes a
    ///   static coefficient negative; and [`Error::Separation`].
    pub fn simulate<S: System>(
        self,
        system: &S,
        start: impl Into<S::State>,
        duration: f64,
    ) -> Result<Trajectory<S::State>, Error> {
        if !(duration >= 0.0 && duration.is_finite()) {
            return Err(Error::InvalidDuration { value: duration });
        }
        let limited = Self {
            max_steps: Some(self.max_steps.unwrap_or(Self::DEFAULT_MAX_STEPS)),
            ..self
        };
        let end = self.start_time + duration;
        let mut steps: Vec<<S::State as SystemState>::Step> = Vec::new();
        for step in limited.flow(system, start)? {
            let step = match step {
                Ok(step) => step,
                // The motion up to the end is complete; what failed lies beyond.
                Err(_) if steps.last().is_some_and(|last| last.end_time() == end) => break,
                Err(error) => return Err(error),
            };
            if step.end_time() > end {
                steps.push(step.until(end));
                break;
            }
            steps.push(step);
        }
        Ok(Trajectory::new(steps, self.start_time, duration))
    }

    /// The motion from `start`, step by step and without an end, in constant memory.
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
    /// [`Error::InvalidState`] and [`Error::WrongSize`] as in [`simulate`](Self::simulate). The
    /// errors of a motion that cannot be followed further are items; after an error comes `None`.
    pub fn flow<S: System>(
        self,
        system: &S,
        start: impl Into<S::State>,
    ) -> Result<S::Flow<'_>, Error> {
        system.flow(self, start.into())
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
