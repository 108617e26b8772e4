use crate::state::{Direction, State};

/// The mode of a contact: stick, slip or open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Mode {
    /// The mass moves with the belt: v = v_b, to the bit.
    Stick,
    /// The mass slides, in this direction.
    Slip(Direction),
    /// There is no normal load, and no friction. Only a contact of a
    /// [`Structure`](crate::Structure) can be open, if its load varies in time or comes from [a
    /// normal spring of its own](crate::Contact::with_normal_spring).
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

/// The kind of an event, at which the relative velocity or the normal load is zero.
///
/// A direction is that of the slip **after** the event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum EventKind {
    /// Slip ends: the contact sticks, and the mass moves with the belt.
    Stick,
    /// Stick ends (slip onset): the force in stick exceeds the largest static friction, γ²μ_s.
    Release(Direction),
    /// The relative velocity changes its sign, and the mass does not stick: the force in stick
    /// would exceed γ²μ_s.
    Crossing(Direction),
    /// The normal load falls below 0: no friction from now on. A load that only touches 0 is no
    /// event: see [`Contact`](crate::Contact).
    Open,
    /// The normal load rises above 0 again: friction acts again.
    Close,
}

impl EventKind {
    /// The mode of the contact after the event.
    ///
    /// After a `Close` the contact sticks or slips, by its relative velocity, which is not part of
    /// the kind of the event. This function then returns `Stick`.
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

/// An event of a motion: a change between stick and slip or of the direction of slip, or a contact
/// that opens or closes.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct Event<S = State> {
    /// Time of the event, in the units of the system: τ, dimensionless, for a
    /// [`MassOnBelt`](crate::MassOnBelt).
    pub time: f64,
    /// Number of the contact at which the event happens; 0 for a
    /// [`MassOnBelt`](crate::MassOnBelt), which has only one.
    pub contact: usize,
    /// The kind of the event.
    pub kind: EventKind,
    /// State at the event. If the mass sticks, is released or crosses, the velocity at the contact
    /// is that of the belt, to the bit; a contact may open or close at any velocity.
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
