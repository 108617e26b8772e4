use crate::state::structure::State;

/// Where an integration stood when it could not go on.
///
/// ```
/// use stick_slip::{Error, Integrator, MassOnBelt, Polynomial, State};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?;
/// let short = Integrator::new().with_max_steps(5)?;
/// match short.simulate(&system, State::new(0.0, 0.0), 100.0) {
///     // Go on from there, or look at the motion up to there.
///     Err(Error::TooManySteps { reached, .. }) => {
///         let motion = system.simulate(State::new(0.0, 0.0), reached.time)?;
///         let apart = motion.last().displacement - reached.state.displacements[0];
///         assert!(apart.abs() < 1e-14);
///     }
///     other => panic!("{other:?}"),
/// }
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Reached {
    /// Time since the start of the integration, in the units of the system.
    pub time: f64,
    /// State of all masses at that time; of a [`MassOnBelt`](crate::MassOnBelt) the only one.
    pub state: State,
}

impl Reached {
    pub(crate) fn new(time: f64, state: impl Into<State>) -> Self {
        Self {
            time,
            state: state.into(),
        }
    }
}

impl std::fmt::Display for Reached {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "at time {:e}", self.time)?;
        match (&self.state.displacements[..], &self.state.velocities[..]) {
            ([u], [v]) => write!(f, " (u = {u:e}, v = {v:e})"),
            (q, v) => write!(f, " (q = {q:?}, v = {v:?})"),
        }
    }
}

/// " at time …", or nothing where no integration was under way.
fn during(reached: &Option<Reached>) -> String {
    reached
        .as_ref()
        .map_or_else(String::new, |reached| format!(" {reached}"))
}

/// Why a law, a system or an integration was refused or could not go on.
///
/// Every variant carries the numbers that a caller needs to decide what to do, dimensionless but
/// for the arguments of [`Scaling`](crate::Scaling); the message names the remedy.
///
/// | variant | when | what to do |
/// |---|---|---|
/// | [`InvalidParameter`](Self::InvalidParameter) | a constructor, a `with_` method, or a range of belt velocities | give a number in the range named |
/// | [`BadPoint`](Self::BadPoint) | [`Tabulated::new`](crate::Tabulated::new) | correct or leave out that point |
/// | [`InvalidState`](Self::InvalidState) | a start is not finite, or extremely large or small | check it; choose another unit of length |
/// | [`InvalidTolerance`](Self::InvalidTolerance) | [`Integrator::with_tolerance`](crate::Integrator::with_tolerance) | stay within the limits named |
/// | [`InvalidDuration`](Self::InvalidDuration) | `simulate` | give a finite duration ≥ 0, or use `flow` |
/// | [`StaticBelowKinetic`](Self::StaticBelowKinetic) | [`MassOnBelt::new`](crate::MassOnBelt::new), a law with μ̂(0) > μ_s | raise μ_s or lower μ̂(0) |
/// | [`NonFiniteFriction`](Self::NonFiniteFriction) | a law gives NaN or ±∞ at a speed that is needed | define it there, or keep the motion away |
/// | [`NotAnalytic`](Self::NotAnalytic) | a law has a value but no power series at a speed | use integral powers there, or name a breakpoint |
/// | [`BadBreakpoints`](Self::BadBreakpoints) | `MassOnBelt::new`, a law with breakpoints | sort them; make the law continuous |
/// | [`StepUnderflow`](Self::StepUnderflow) | a motion: stiffness, or a kink or jump of the law that is not named | name the breakpoint; reduce γ²·dμ̂/ds; start nearer |
/// | [`TooManySteps`](Self::TooManySteps) | a motion or a search for cycles: stiffness, or a very long run | `with_max_steps`, or as above |
/// | [`TooManyEvents`](Self::TooManyEvents) | a run with `with_max_events` | raise the limit, or use `flow` |
/// | [`At`](Self::At) | a search over belt velocities, or over the damping | see the error inside; search beside that value |
///
/// A `main` that returns `Result<(), Error>` shows the variant and its fields, by `Debug`; print
/// the error with `{error}` to show the message.
///
/// ```
/// use stick_slip::{Error, Polynomial};
///
/// let error = Polynomial::new(0.4, 0.5, 0.5).unwrap_err();
/// assert_eq!(
///     error,
///     Error::InvalidParameter {
///         name: "minimum_coefficient",
///         value: 0.5,
///         allowed: "0 ≤ minimum_coefficient ≤ static_coefficient",
///     }
/// );
/// assert_eq!(
///     error.to_string(),
///     "minimum_coefficient = 5e-1 is not allowed; give a finite number: 0 ≤ minimum_coefficient ≤ static_coefficient"
/// );
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A parameter of a law, a system or the integrator is outside its range, infinite or NaN.
    #[error("{name} = {value:e} is not allowed; give a finite number: {allowed}")]
    InvalidParameter {
        /// The parameter, by its name in the constructor.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// The range that it must lie in.
        allowed: &'static str,
    },

    /// A point of a table is not allowed.
    #[error(
        "point {index} of the table, counted from 0: {name} = {value:e} is not allowed; give a finite number: {allowed}"
    )]
    BadPoint {
        /// Position of the point, from 0.
        index: usize,
        /// Which of its two numbers: `speed` or `coefficient`.
        name: &'static str,
        /// The number that was given.
        value: f64,
        /// The range that it must lie in.
        allowed: &'static str,
    },

    /// A start state has an infinite or NaN component, or is so large or so small that the
    /// equations overflow or underflow.
    #[error(
        "the state u = {displacement:e}, v = {velocity:e} is not finite, or it overflows or underflows; choose a unit of length that makes it a number of ordinary size"
    )]
    InvalidState {
        /// Displacement u that was given.
        displacement: f64,
        /// Velocity v that was given.
        velocity: f64,
    },

    /// A relative tolerance is outside its range or NaN.
    #[error(
        "the tolerance {value:e} is not allowed; give a number with {min:e} ≤ tolerance ≤ {max:e}"
    )]
    InvalidTolerance {
        /// The value that was given.
        value: f64,
        /// The least tolerance, a little below round-off.
        min: f64,
        /// The largest tolerance.
        max: f64,
    },

    /// A duration is negative, infinite or NaN.
    #[error(
        "the duration {value:e} is not allowed; give a finite number ≥ 0, or use `flow` to go on without an end"
    )]
    InvalidDuration {
        /// The value that was given.
        value: f64,
    },

    /// The law's kinetic coefficient at zero speed exceeds its static coefficient by more than a
    /// few ulps.
    #[error(
        "the static coefficient {static_coefficient:e} is below the kinetic coefficient at zero speed, {kinetic_coefficient:e}; raise μ_s or lower μ̂(0)"
    )]
    StaticBelowKinetic {
        /// μ_s of the law.
        static_coefficient: f64,
        /// μ̂(0) of the law.
        kinetic_coefficient: f64,
    },

    /// The law returned an infinite or NaN coefficient.
    #[error(
        "the friction law gives {value} at sliding speed {speed:e}{}; define it for every speed the motion reaches, or start closer to the belt velocity",
        during(reached)
    )]
    NonFiniteFriction {
        /// Sliding speed s ≥ 0.
        speed: f64,
        /// What the law returned there.
        value: f64,
        /// Where the integration stood; `None` if nothing was integrated, as when a system is made.
        reached: Option<Reached>,
    },

    /// The law has a value but no power series at a speed, as √s at s = 0.
    #[error(
        "the friction law is not analytic at sliding speed {speed:e}{}; use integral powers of the speed there, or name the speed as a breakpoint and give the pieces",
        during(reached)
    )]
    NotAnalytic {
        /// Sliding speed s ≥ 0.
        speed: f64,
        /// Where the integration stood; `None` if nothing was integrated, as when a system is made.
        reached: Option<Reached>,
    },

    /// The law's breakpoints are not finite, positive and strictly ascending, or the law jumps at
    /// one.
    #[error(
        "breakpoint {index} of the friction law, {value:e}, is not allowed; breakpoints are finite, positive, strictly ascending, and the law is continuous there"
    )]
    BadBreakpoints {
        /// Position of the first bad breakpoint, from 0.
        index: usize,
        /// Its value.
        value: f64,
    },

    /// The step became too short to move the clock.
    #[error(
        "the step fell to {step:e} {reached}: the system is too stiff for an explicit method (large γ²·dμ̂/ds), or the law has a kink that is not named as a breakpoint"
    )]
    StepUnderflow {
        /// Length of the last step tried.
        step: f64,
        /// Where the integration stood.
        reached: Reached,
    },

    /// The limit of steps was reached.
    #[error(
        "{limit} steps were not enough {reached}; in a simulation raise the limit with `with_max_steps`, shorten the run, or use `flow`. Steps far below 0.1 mean a stiff system (large γ²·dμ̂/ds), or a law with a jump or kink that is not named as a breakpoint"
    )]
    TooManySteps {
        /// The limit in force.
        limit: usize,
        /// Where the integration stood.
        reached: Reached,
    },

    /// The limit of events was reached.
    #[error(
        "{limit} events were not enough {reached}; raise the limit with `with_max_events`, shorten the run, or use `flow`"
    )]
    TooManyEvents {
        /// The limit in force.
        limit: usize,
        /// Where the integration stood.
        reached: Reached,
    },

    /// A search over a parameter could not go on at one value of it: the error inside says why, and
    /// what to do. A range that leaves the value out is searched as before.
    #[error("at {parameter} = {value:e}: {source}")]
    At {
        /// The parameter, by its name: `belt_velocity`, `damping`.
        parameter: &'static str,
        /// Its value.
        value: f64,
        /// What happened there.
        source: Box<Self>,
    },
}

impl Error {
    /// The same error, with the value of the parameter at which it happened.
    pub(crate) fn at(self, parameter: &'static str, value: f64) -> Self {
        Self::At {
            parameter,
            value,
            source: Box::new(self),
        }
    }

    /// `value` if it lies in the range, else [`Error::InvalidParameter`]; NaN lies in none.
    pub(crate) fn check(
        name: &'static str,
        value: f64,
        in_range: bool,
        allowed: &'static str,
    ) -> Result<f64, Self> {
        if value.is_finite() && in_range {
            Ok(value)
        } else {
            Err(Self::InvalidParameter {
                name,
                value,
                allowed,
            })
        }
    }

    /// The same error, as that of a point of a table.
    pub(crate) fn at_point(self, index: usize) -> Self {
        match self {
            Self::InvalidParameter {
                name,
                value,
                allowed,
            } => Self::BadPoint {
                index,
                name,
                value,
                allowed,
            },
            other => other,
        }
    }

    /// The same error, with the place where the integration stood.
    pub(crate) fn reached_at(self, at: Reached) -> Self {
        match self {
            Self::NonFiniteFriction { speed, value, .. } => Self::NonFiniteFriction {
                speed,
                value,
                reached: Some(at),
            },
            Self::NotAnalytic { speed, .. } => Self::NotAnalytic {
                speed,
                reached: Some(at),
            },
            other => other,
        }
    }
}
