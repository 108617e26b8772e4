use crate::state::{Direction, State};

/// What the mass does on the belt.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Mode {
    /// It moves with the belt: v = v_b, to the bit.
    Stick,
    /// It slides, behind the belt or ahead of it.
    Slip(Direction),
    /// The normal load is gone, and friction with it; of a contact of a
    /// [`Structure`](crate::Structure) whose load varies in time.
    Open,
}

impl std::fmt::Display for Mode {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Stick => f.pad("stick"),
            Self::Slip(direction) => f.pad(&format!("slip ({direction})")),
            Self::Open => f.pad("open"),
        }
    }
}

/// What happens when the relative velocity is zero, or the load. A direction is that of the slip **after** the
/// event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum EventKind {
    /// Slip ends; the mass moves with the belt from now on.
    Stick,
    /// Stick ends: the contact can carry no more than γ²μ_s.
    Release(Direction),
    /// The relative velocity changes sign without sticking: the contact would have to carry more
    /// than γ²μ_s.
    Crossing(Direction),
    /// The normal load, given in time, falls to 0: no friction from now on.
    Open,
    /// The normal load comes back.
    Close,
}

impl EventKind {
    /// What the mass does from the event on. After a `Close` it sticks or slips, as the relative
    /// velocity says and not the kind of the event; here it is `Stick`.
    ///
    /// ```
    /// use stick_slip::{Direction, EventKind, Mode};
    /// assert_eq!(EventKind::Release(Direction::Lagging).mode(), Mode::Slip(Direction::Lagging));
    /// ```
    pub const fn mode(self) -> Mode {
        match self {
            Self::Stick | Self::Close => Mode::Stick,
            Self::Open => Mode::Open,
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
            Self::Open => f.pad("open"),
            Self::Close => f.pad("close"),
        }
    }
}

/// A change between stick and slip, or of the direction of slip.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Event<S = State> {
    /// Time since the start, in the units of the system: τ, dimensionless, for a
    /// [`MassOnBelt`](crate::MassOnBelt).
    pub time: f64,
    /// Number of the contact where it happens; 0 for a [`MassOnBelt`](crate::MassOnBelt), which
    /// has one.
    pub contact: usize,
    /// What happens.
    pub kind: EventKind,
    /// State at the event; the velocity at the contact is that of the belt, to the bit.
    pub state: S,
}

impl std::fmt::Display for Event {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            time, kind, state, ..
        } = self;
        write!(f, "{time:.9}  {kind:<20}  u = {:.9}", state.displacement)
    }
}
