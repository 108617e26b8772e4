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

/// The velocity of a surface in a state, for [`relative_velocity`].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Surface {
    pub(crate) velocity: f64,
    /// Sum of the sizes of the terms of the velocity.
    pub(crate) size: f64,
    /// The acceleration, times the time.
    pub(crate) drift: f64,
}

/// The relative velocity r = Σ b_j v_j − w of a state with these products b_j v_j; 0 if it is
/// within its rounding error.
///
/// The state of a contact that sticks was rounded, so its r is rarely 0 to the bit. Let S be the
/// sum of the sizes of all terms. The n products and n sums have rounding errors of half an ulp
/// each, together at most (n + 1) ε S/2, and so have the velocities themselves, in which a step
/// has put w and the other velocities together. Two conversions of units add 2 ε S. The time is
/// known to its rounding error, too, in which the velocity of the surface changes.
pub(crate) fn relative_velocity(products: impl Iterator<Item = f64>, surface: Surface) -> f64 {
    let (mut sum, mut size, mut roundings) = (0.0, surface.size, 3.0);
    for product in products {
        sum += product;
        size += product.abs();
        roundings += 1.0;
    }
    let relative: f64 = sum - surface.velocity;
    // In this order nothing overflows.
    let rounding = f64::EPSILON * roundings * size + f64::EPSILON * surface.drift.abs();
    if relative.is_finite() && relative.abs() <= rounding {
        0.0
    } else {
        relative
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

    /// The place of a direction in a pair of values backward and forward.
    #[cfg(feature = "structures")]
    pub(crate) const fn place(self) -> usize {
        match self {
            Self::Lagging => 0,
            Self::Leading => 1,
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
