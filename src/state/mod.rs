//! States of masses, and directions of sliding.

// | file | what is in it |
// |---|---|
// | `mod.rs` | `State` of one mass, `Direction` |
// | `structure.rs` | the state of several masses |
// | `units.rs` | the units in which a dimensionless motion is measured |

pub(crate) mod structure;
mod units;

pub(crate) use units::Units;

/// The state of one mass: displacement u and velocity v = du/dτ with the time τ, both dimensionless
/// (in m and m/s for a [`PhysicalMassOnBelt`](crate::PhysicalMassOnBelt)).
///
/// ```
/// use stick_slip::State;
///
/// let state = State::new(0.3, -0.1);
/// assert_eq!(state.velocity, -0.1);
/// assert_eq!(State::from((0.3, -0.1)), state);
/// assert_eq!(State::from([0.3, -0.1]), state);
/// assert_eq!(State::default(), State::new(0.0, 0.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct State {
    /// Displacement u from the position where the spring is unstressed, dimensionless.
    pub displacement: f64,
    /// Velocity v = du/dτ, dimensionless.
    pub velocity: f64,
}

impl State {
    /// Creates the state (u, v).
    pub const fn new(displacement: f64, velocity: f64) -> Self {
        Self {
            displacement,
            velocity,
        }
    }

    /// The mirror image (−u, −v).
    pub(crate) const fn mirrored(self) -> Self {
        Self::new(-self.displacement, -self.velocity)
    }
}

impl From<(f64, f64)> for State {
    fn from((displacement, velocity): (f64, f64)) -> Self {
        Self::new(displacement, velocity)
    }
}

impl From<[f64; 2]> for State {
    fn from([displacement, velocity]: [f64; 2]) -> Self {
        Self::new(displacement, velocity)
    }
}

/// The direction in which the mass slides on the belt: the sign of the relative velocity v_r = v −
/// v_b, with the velocity v of the mass and v_b of the belt. For a [`Contact`](crate::Contact) it
/// is the sign of the contact's relative velocity r.
///
/// The names describe a belt that moves forward. On a belt that moves backward (v_b < 0), a mass
/// that moves backward more slowly than the belt is [`Leading`](Self::Leading), and so is a mass
/// that moves forward.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Direction {
    /// v_r < 0: on a belt that moves forward, the mass is slower than the belt.
    Lagging,
    /// v_r > 0: on a belt that moves forward, the mass is faster than the belt.
    Leading,
}

impl Direction {
    /// The direction of slip with this relative velocity; `None` if it is 0.
    pub(crate) fn of(relative_velocity: f64) -> Option<Self> {
        if relative_velocity < 0.0 {
            Some(Self::Lagging)
        } else if relative_velocity > 0.0 {
            Some(Self::Leading)
        } else {
            None
        }
    }

    /// The sign σ of v_r: −1 for lagging, +1 for leading.
    ///
    /// ```
    /// assert_eq!(stick_slip::Direction::Lagging.sign(), -1.0);
    /// ```
    pub const fn sign(self) -> f64 {
        match self {
            Self::Lagging => -1.0,
            Self::Leading => 1.0,
        }
    }

    /// The other direction.
    ///
    /// ```
    /// use stick_slip::Direction;
    /// assert_eq!(Direction::Lagging.opposite(), Direction::Leading);
    /// ```
    pub const fn opposite(self) -> Self {
        match self {
            Self::Lagging => Self::Leading,
            Self::Leading => Self::Lagging,
        }
    }
}

impl std::fmt::Display for Direction {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Lagging => "lagging",
            Self::Leading => "leading",
        })
    }
}
