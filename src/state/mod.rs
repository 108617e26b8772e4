//! Where masses are, and which way they slide. Nothing here knows a system.
//!
//! | file | what is in it |
//! |---|---|
//! | `mod.rs` | [`State`] of one mass, [`Direction`] |
//! | `structure.rs` | the state of several masses |

pub(crate) mod structure;

/// Displacement u and velocity v = du/dτ of the mass, both dimensionless.
///
/// ```
/// use stick_slip::State;
///
/// let state = State::new(0.3, -0.1);
/// assert_eq!(state.velocity, -0.1);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
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
    /// The state (u, v).
    pub const fn new(displacement: f64, velocity: f64) -> Self {
        Self {
            displacement,
            velocity,
        }
    }

    /// (−u, −v).
    pub(crate) const fn mirrored(self) -> Self {
        Self::new(-self.displacement, -self.velocity)
    }
}

/// Which way the mass slides on the belt: the sign of the relative velocity v_r = v − v_b. The
/// names are those of a belt that moves forward; on one with v_b < 0 a mass that lags behind it has
/// v_r > 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Direction {
    /// v_r < 0.
    Lagging,
    /// v_r > 0.
    Leading,
}

impl Direction {
    /// The direction of slip with a relative velocity; `None` where that is 0.
    pub(crate) fn of(relative_velocity: f64) -> Option<Self> {
        if relative_velocity < 0.0 {
            Some(Self::Lagging)
        } else if relative_velocity > 0.0 {
            Some(Self::Leading)
        } else {
            None
        }
    }

    /// σ = sgn v_r: −1 lagging, +1 leading.
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
