use super::numbers::Plain;
use crate::state::structure::State;

/// The time and the state at which an integration could not continue.
///
/// ```
/// use stick_slip::{Error, Integrator, MassOnBelt, Polynomial, State};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?;
/// let short = Integrator::new().with_max_steps(5)?;
/// match short.simulate(&system, State::new(0.0, 0.0), 100.0) {
///     // Continue from there, or inspect the motion up to there.
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
#[non_exhaustive]
pub struct Reached {
    /// Time reached, in the units of the system, counted like the times of events.
    pub time: f64,
    /// State of all masses at that time. A [`MassOnBelt`](crate::MassOnBelt) has one mass.
    pub state: State,
}

impl Reached {
    #[cold]
    pub(crate) fn new(time: f64, state: impl Into<State>) -> Self {
        Self {
            time,
            state: state.into(),
        }
    }
}

impl Reached {
    /// Returns true if the state is so large that squares in the equations overflow.
    pub(super) fn overflows(&self) -> bool {
        const LARGEST: f64 = 1e150;
        let State {
            displacements,
            velocities,
            memory,
            ..
        } = &self.state;
        let mut numbers = displacements.iter().chain(velocities).chain(memory);
        numbers.any(|x| x.is_nan() || x.abs() > LARGEST)
    }
}

impl std::fmt::Display for Reached {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "at time {}", Plain(self.time))?;
        match (&self.state.displacements[..], &self.state.velocities[..]) {
            ([u], [v]) => write!(f, " (u = {}, v = {})", Plain(*u), Plain(*v)),
            (q, v) => write!(f, " (q = {q:?}, v = {v:?})"),
        }
    }
}

/// The words " at time …" for a message; none if no integration was under way.
pub(super) fn during(reached: &Option<Reached>) -> String {
    reached
        .as_ref()
        .map_or_else(String::new, |reached| format!(" {reached}"))
}
