use super::arc::{Arc, Arrival};
use crate::belt::{Belt, Landing, Step};
use crate::clock::Clock;
use crate::error::Digits;
use crate::motion::{AttractorKind, Ended, EventKind, Mode, Trajectory};
use crate::state::{Direction, State, Units};

/// Kinds of periodic motion.
///
/// Farshidianfar and Noei Aghaee describe the first two kinds in sections 4.1.1 and 4.1.2.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum CycleKind {
    /// The mass never reaches the belt velocity.
    PureSlip,
    /// Slip slower than the belt alternates with stick. [`stick_slip`](super::stick_slip) finds a
    /// cycle of this kind or of the kind [`Overshoot`](Self::Overshoot).
    StickSlip,
    /// Each period consists of slip slower than the belt, a crossing of the belt velocity, slip
    /// faster than the belt, and stick.
    Overshoot,
    /// The mass crosses the belt velocity twice a period and never sticks.
    Crossing,
}

impl std::fmt::Display for CycleKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::PureSlip => "pure slip",
            Self::StickSlip => "stick-slip",
            Self::Overshoot => "overshoot",
            Self::Crossing => "crossing",
        })
    }
}

impl From<CycleKind> for AttractorKind {
    fn from(kind: CycleKind) -> Self {
        match kind {
            CycleKind::PureSlip => Self::PureSlip,
            CycleKind::StickSlip => Self::StickSlip,
            CycleKind::Overshoot => Self::Overshoot,
            CycleKind::Crossing => Self::Crossing,
        }
    }
}

/// A periodic motion, exact to rounding.
///
/// A `LimitCycle` contains the power series of one period. Extremes are roots of these series, and
/// integrals are quadratures of them, not sums over samples. u is the displacement, v the velocity,
/// v_b the belt velocity and τ the time. All quantities are dimensionless; in a cycle returned by a
/// [`PhysicalMassOnBelt`](crate::PhysicalMassOnBelt) they are in SI units.
///
/// ```
/// use stick_slip::{CycleKind, MassOnBelt, Polynomial, State, limit_cycle};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let cycle = limit_cycle::stick_slip(&system)?.unwrap();
/// assert_eq!(cycle.kind(), CycleKind::StickSlip);
/// // It starts at the release point, u = γ²μ_s − 2βv_b; stick removes every perturbation.
/// assert_eq!(cycle.state(), State::new(0.38, 0.2));
/// assert!(cycle.is_stable() && cycle.multiplier() == 0.0);
/// assert!((cycle.period() - 6.799421444472157605).abs() < 1e-14);
/// assert!((cycle.stick_duration() - 1.629558444940023627).abs() < 4e-15);
/// assert_eq!(cycle.leading_duration(), 0.0); // it stays behind the belt
/// assert!((cycle.amplitude() - 0.2862087190457751).abs() < 1e-15);
/// assert!((cycle.max_displacement() - 0.5664694667237887836).abs() < 1e-15);
/// assert!((cycle.min_displacement() + 0.005947971367761).abs() < 1e-15);
/// // Less than the displacement of steady sliding, 0.3148.
/// assert!((cycle.mean_displacement() - 0.289051936827857).abs() < 1e-15);
/// assert_eq!(cycle.max_velocity(), 0.2); // that of the belt, in stick
/// assert!((cycle.min_velocity() + 0.2860955341421674).abs() < 1e-15);
/// assert!((cycle.energy().damper_loss - 0.02314806731453380).abs() < 1e-16);
///
/// // On a faster belt the mass always slips; in another, undamped system it overtakes the belt.
/// let slipping = limit_cycle::find(&system.with_belt_velocity(0.4071)?)?;
/// assert!((slipping[0].multiplier() - 0.71180185776301).abs() < 1e-13);
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.1, 1.0)?, 0.5)?.with_load(0.15)?;
/// let crossing = limit_cycle::find(&system)?;
/// assert!((crossing[0].leading_duration() - 0.6653454328).abs() < 1e-10);
/// # Ok::<(), stick_slip::Error>(())
/// ```
///
/// The feature `serde` writes the numbers and events of a cycle, for other programs. A cycle cannot
/// be read back: store the system instead, and find the cycle again.
#[derive(Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(into = "super::written::WrittenCycle")
)]
pub struct LimitCycle {
    pub(super) steps: Vec<Step>,
    pub(super) kind: CycleKind,
    pub(super) multiplier: f64,
    pub(super) damping: f64,
    /// The units of the steps.
    pub(super) units: Units,
}

impl LimitCycle {
    /// Joins arcs of slip, and a stick phase up to `release` if the last one ends in stick.
    pub(super) fn join(
        system: &Belt<'_>,
        arcs: Vec<Arc>,
        kind: CycleKind,
        multiplier: f64,
    ) -> Self {
        let mut steps = Vec::new();
        for mut arc in arcs {
            if let Arrival::Contact(displacement) = arc.arrival
                && let Some(last) = arc.steps.last_mut()
                && let Some(from) = last.direction()
            {
                let at = State::new(displacement, system.belt_velocity());
                match system.landing(displacement, from) {
                    Landing::Crossing(side) => {
                        *last = last.ended_by(EventKind::Crossing(side), at);
                    }
                    Landing::Stick => {
                        *last = last.ended_by(EventKind::Stick, at);
                        let stick = Step::stick(Clock::default(), displacement, system);
                        arc.steps.push(stick);
                    }
                    Landing::Touch => {}
                }
            }
            if steps.is_empty() {
                steps = arc.steps;
            } else {
                steps.append(&mut arc.steps);
            }
        }
        // Start, period and belt velocity are those of steps.
        debug_assert!(!steps.is_empty());
        let mut clock = Clock::default();
        for step in &mut steps {
            *step = step.starting_at(clock);
            clock = clock.after(step.duration);
        }
        Self {
            steps,
            kind,
            multiplier,
            damping: system.damping(),
            units: Units::DIMENSIONLESS,
        }
    }

    /// Converts this dimensionless motion to other units.
    pub(crate) fn in_units(mut self, units: Units) -> Self {
        for step in &mut self.steps {
            *step = step.in_units(units);
        }
        Self { units, ..self }
    }

    /// Replaces the motion by its mirror image: (u, v, v_b) → (−u, −v, −v_b).
    pub(super) fn mirror(&mut self) {
        for step in &mut self.steps {
            *step = step.mirrored();
        }
    }

    /// Kind of the motion.
    pub fn kind(&self) -> CycleKind {
        self.kind
    }

    /// The state (u, v) at which [`trajectory`](Self::trajectory) starts, dimensionless. For a
    /// cycle that sticks it is the release point; for a pure-slip cycle, the point of largest
    /// velocity in the direction of the belt; for a crossing cycle, the downward crossing (v/v_b
    /// falls below 1).
    pub fn state(&self) -> State {
        self.steps
            .first()
            .map_or(State::new(f64::NAN, f64::NAN), Step::state)
    }

    /// Period T, dimensionless.
    pub fn period(&self) -> f64 {
        self.steps.last().map_or(0.0, Step::end_time)
    }

    /// Angular frequency ω = 2π/T, dimensionless; ω = 1 is the natural frequency of the undamped
    /// mass on its spring. [`Scaling::hertz`](crate::Scaling::hertz) converts it to hertz.
    ///
    /// ```
    /// use stick_slip::{MassOnBelt, Polynomial, limit_cycle};
    ///
    /// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
    /// let cycle = limit_cycle::stick_slip(&system)?.unwrap();
    /// // Stick lowers the frequency.
    /// assert!((cycle.frequency() - 0.924076).abs() < 1e-6);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn frequency(&self) -> f64 {
        std::f64::consts::TAU / self.period()
    }

    /// Frequency 1/T, per unit of time: in hertz in a cycle of a
    /// [`PhysicalMassOnBelt`](crate::PhysicalMassOnBelt).
    pub fn hertz(&self) -> f64 {
        1.0 / self.period()
    }

    /// Time in stick per period, dimensionless.
    pub fn stick_duration(&self) -> f64 {
        self.time_in(|mode| mode == Mode::Stick)
    }

    /// Time per period in which the mass is faster than the belt, v/v_b > 1; dimensionless.
    pub fn leading_duration(&self) -> f64 {
        let ahead = if self.belt_velocity() > 0.0 {
            Direction::Leading
        } else {
            Direction::Lagging
        };
        self.time_in(|mode| mode == Mode::Slip(ahead))
    }

    fn time_in(&self, counts: impl Fn(Mode) -> bool) -> f64 {
        let steps = self.steps.iter().filter(|step| counts(step.mode()));
        Clock::sum(steps.map(|step| step.duration))
    }

    pub(super) fn belt_velocity(&self) -> f64 {
        self.steps.first().map_or(0.0, |step| step.belt_velocity)
    }

    /// Amplitude of the displacement, (u_max − u_min)/2, dimensionless.
    pub fn amplitude(&self) -> f64 {
        let [min, max] = self.displacements();
        0.5 * (max - min)
    }

    /// Largest displacement u_max, dimensionless.
    pub fn max_displacement(&self) -> f64 {
        self.displacements()[1]
    }

    /// Least displacement u_min, dimensionless.
    pub fn min_displacement(&self) -> f64 {
        self.displacements()[0]
    }

    /// Largest velocity v_max, dimensionless.
    pub fn max_velocity(&self) -> f64 {
        self.velocities()[1]
    }

    /// Least velocity v_min, dimensionless.
    pub fn min_velocity(&self) -> f64 {
        self.velocities()[0]
    }

    /// Floquet multiplier, dimensionless: the factor by which a small perturbation changes over one
    /// period. The page [`limit_cycle`](crate::limit_cycle) gives the formula for a cycle without
    /// stick. For a cycle that sticks the multiplier is 0, because every stick phase ends at the
    /// same release point.
    #[doc(alias = "Floquet")]
    #[doc(alias = "Lyapunov")]
    #[doc(alias = "stability")]
    pub fn multiplier(&self) -> f64 {
        self.multiplier
    }

    /// Returns true if the cycle attracts: its multiplier is less than 1.
    pub fn is_stable(&self) -> bool {
        self.multiplier < 1.0
    }

    /// The motion over one period, which begins at [`state`](Self::state). The last step of the
    /// motion has the duration 0 and contains the mode at the time T itself.
    ///
    /// ```
    /// use stick_slip::{MassOnBelt, Polynomial, limit_cycle};
    ///
    /// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
    /// let cycle = limit_cycle::stick_slip(&system)?.unwrap();
    /// let motion = cycle.trajectory();
    /// assert_eq!(motion.duration(), cycle.period());
    /// assert_eq!(motion.last(), cycle.state()); // it closes
    /// let kinds = motion.events().iter().map(|event| event.kind.to_string());
    /// let kinds: Vec<String> = kinds.collect();
    /// assert_eq!(kinds, ["stick", "release (lagging)"]);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    pub fn trajectory(&self) -> Trajectory {
        let mut steps = self.steps.clone();
        if let (Some(first), Some(last)) = (self.steps.first(), self.steps.last()) {
            // A step of duration 0 gives the mode of motion at the time T itself.
            let start = last.start.after(last.duration);
            steps.push(first.start_at(start));
        }
        Trajectory::new(steps, 0.0, self.period(), Ended::Duration)
    }
}

/// Displays kind, period, amplitude and multiplier in one line.
///
/// ```
/// use stick_slip::{MassOnBelt, Polynomial, limit_cycle};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let cycle = limit_cycle::stick_slip(&system)?.unwrap();
/// assert_eq!(cycle.to_string(), "stick-slip: T = 6.79942, amplitude = 0.286209, stable");
/// # Ok::<(), stick_slip::Error>(())
/// ```
impl std::fmt::Display for LimitCycle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let [period, amplitude] = [self.period(), self.amplitude()].map(Digits);
        let stable = if self.is_stable() {
            "stable"
        } else {
            "unstable"
        };
        let kind = self.kind;
        write!(f, "{kind}: T = {period}, amplitude = {amplitude}, {stable}")
    }
}

/// Shows the measures, without the steps, which are long.
impl std::fmt::Debug for LimitCycle {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LimitCycle")
            .field("kind", &self.kind)
            .field("period", &self.period())
            .field("amplitude", &self.amplitude())
            .field("multiplier", &self.multiplier)
            .field("state", &self.state())
            .field("steps", &self.steps.len())
            .finish_non_exhaustive()
    }
}
