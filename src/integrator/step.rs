use super::polynomial::{Polynomial, TERMS, evaluate, mean};
use crate::{Direction, State};

/// What the mass does on the belt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum Mode {
    /// It moves with the belt: v = v_b, to the bit.
    Stick,
    /// It slides, behind the belt or ahead of it.
    Slip(Direction),
}

impl std::fmt::Display for Mode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Stick => f.pad("stick"),
            Self::Slip(direction) => f.pad(&format!("slip ({direction})")),
        }
    }
}

/// What happens when the relative velocity is zero. A direction is that of the slip **after** the
/// event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum EventKind {
    /// Slip ends; the mass moves with the belt from now on.
    Stick,
    /// Stick ends: the contact can carry no more than γ²μ_s.
    Release(Direction),
    /// The relative velocity changes sign without sticking: the contact would have to carry more
    /// than γ²μ_s.
    Crossing(Direction),
}

impl EventKind {
    /// What the mass does from the event on.
    ///
    /// ```
    /// use stick_slip::{Direction, EventKind, Mode};
    /// assert_eq!(EventKind::Release(Direction::Lagging).mode(), Mode::Slip(Direction::Lagging));
    /// ```
    pub const fn mode(self) -> Mode {
        match self {
            Self::Stick => Mode::Stick,
            Self::Release(direction) | Self::Crossing(direction) => Mode::Slip(direction),
        }
    }
}

impl std::fmt::Display for EventKind {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Stick => f.pad("stick"),
            Self::Release(direction) => f.pad(&format!("release ({direction})")),
            Self::Crossing(direction) => f.pad(&format!("crossing ({direction})")),
        }
    }
}

/// A change between stick and slip, or of the direction of slip.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Event {
    /// Time τ since the start, dimensionless.
    pub time: f64,
    /// What happens.
    pub kind: EventKind,
    /// State at the event; its velocity is v_b to the bit.
    pub state: State,
}

impl std::fmt::Display for Event {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { time, kind, state } = self;
        write!(f, "{time:.9}  {kind:<20}  u = {:.9}", state.displacement)
    }
}

/// Time as a sum of two numbers, so that 10⁶ steps lose nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Clock {
    /// The time, rounded.
    pub(crate) time: f64,
    /// What rounding took away.
    remainder: f64,
}

impl Clock {
    /// The time a duration later (Knuth's two-sum).
    #[inline(always)]
    pub(crate) fn after(self, duration: f64) -> Self {
        let step = duration + self.remainder;
        let time = self.time + step;
        let taken = time - self.time;
        let remainder = (self.time - (time - taken)) + (step - taken);
        Self { time, remainder }
    }

    /// Time from here to `time`.
    #[inline(always)]
    pub(crate) fn until(self, time: f64) -> f64 {
        (time - self.time) - self.remainder
    }
}

/// A stretch of motion without an event inside: a stick phase, or one Taylor step of a slip phase.
///
/// A value on its own: it holds the power series of the motion, good to the integrator's tolerance
/// over its [`duration`](Self::duration). In the time t since its start
///
/// ```text
/// v(t) = v(0) + σ(s(t) − s(0)),   u(t) = u(0) + ∫ v,   s(t) = Σ s_k t^k the sliding speed |v − v_b|.
/// ```
///
/// ```
/// use stick_slip::{Integrator, MassOnBelt, Mode, Polynomial, State};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let mut flow = Integrator::new().flow(&system, State::new(0.1, 0.2))?;
/// let stick = flow.next().unwrap()?;
/// assert_eq!(stick.mode(), Mode::Stick);
/// assert!((stick.duration() - (0.38 - 0.1) / 0.2).abs() < 1e-15);
/// assert_eq!(stick.state_at(1.0), State::new(0.1 + 0.2, 0.2));
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    pub(crate) start: Clock,
    pub(crate) duration: f64,
    pub(crate) mode: Mode,
    pub(crate) state: State,
    /// Series of the sliding speed; zero in stick.
    pub(crate) speed: Polynomial,
    pub(crate) event: Option<Event>,
    pub(crate) belt_velocity: f64,
}

impl Step {
    pub(crate) const AT_REST_ON_BELT: Polynomial = [0.0; TERMS];

    /// Time τ at which it starts, dimensionless.
    pub fn start_time(&self) -> f64 {
        self.start.time
    }

    /// Time τ at which it ends, dimensionless; infinite for a rest that lasts for ever.
    pub fn end_time(&self) -> f64 {
        self.start.after(self.duration).time
    }

    /// How long it lasts, dimensionless; infinite for a rest that lasts for ever.
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// What the mass does.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// State at its start.
    pub fn state(&self) -> State {
        self.state
    }

    /// State at a finite time t after its **start**, 0 ≤ t ≤ [`duration`](Self::duration); beyond,
    /// the series is not to be trusted.
    pub fn state_at(&self, t: f64) -> State {
        let State {
            displacement,
            velocity,
        } = self.state;
        match self.mode {
            _ if t == 0.0 || self.is_rest() => self.state,
            Mode::Stick => State::new(displacement + velocity * t, velocity),
            Mode::Slip(direction) => {
                let mean_velocity = self.belt_velocity + direction.sign() * mean(&self.speed, t);
                State::new(
                    displacement + mean_velocity * t,
                    self.belt_velocity + direction.sign() * evaluate(&self.speed, t),
                )
            }
        }
    }

    /// Whether nothing moves: exactly on the equilibrium, or in stick on a belt that stands still.
    fn is_rest(&self) -> bool {
        self.state.velocity == 0.0 && self.speed[1] == 0.0 && self.speed[2] == 0.0
    }

    /// The event that ends it, if one does.
    pub fn event(&self) -> Option<Event> {
        self.event
    }

    /// σ, the sign of v_r; 0 in stick.
    pub(crate) fn sigma(&self) -> f64 {
        self.direction().map_or(0.0, Direction::sign)
    }

    /// The direction of slip; `None` in stick.
    pub(crate) fn direction(&self) -> Option<Direction> {
        match self.mode {
            Mode::Slip(direction) => Some(direction),
            Mode::Stick => None,
        }
    }

    /// The same motion seen in a mirror: (u, v, v_b) → (−u, −v, −v_b).
    pub(crate) fn mirrored(&self) -> Self {
        let kind = |kind| match kind {
            EventKind::Stick => EventKind::Stick,
            EventKind::Release(direction) => EventKind::Release(direction.opposite()),
            EventKind::Crossing(direction) => EventKind::Crossing(direction.opposite()),
        };
        Self {
            mode: self
                .direction()
                .map_or(Mode::Stick, |direction| Mode::Slip(direction.opposite())),
            state: self.state.mirrored(),
            belt_velocity: -self.belt_velocity,
            event: self.event.map(|event| Event {
                kind: kind(event.kind),
                state: event.state.mirrored(),
                ..event
            }),
            ..*self
        }
    }

    /// State at its end; at an event the event's own.
    pub(crate) fn end_state(&self) -> State {
        match self.event {
            Some(event) => event.state,
            None => self.state_at(self.duration),
        }
    }

    /// The part of it that lies before `time`, which it does not reach itself.
    pub(crate) fn until(self, time: f64) -> Self {
        Self {
            duration: self.start.until(time).clamp(0.0, self.duration),
            event: None,
            ..self
        }
    }
}
