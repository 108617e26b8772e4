use crate::error::Element;
use crate::state::{Direction, State};

/// The mode of a contact: stick, slip or open.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Mode {
    /// The surfaces move together: the velocity of a mass on a belt equals the belt velocity bit
    /// for bit. In an elastic contact, a spring in series with a slider, the slider sticks.
    Stick,
    /// The surfaces slide on each other, in this direction.
    Slip(Direction),
    /// The contact is open: there is no normal load and no friction. Only a contact of a
    /// [`Structure`](crate::Structure) can open: if its load varies in time, or if it has a [normal
    /// spring](crate::Contact::with_normal_spring) or a [load law](crate::Contact::with_load_law).
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

/// The kind of an [`Event`]: stick, release or crossing of a contact; opening or closing of a
/// contact or of a [stop](crate::Stop).
///
/// The direction of an event is the direction of slip **after** the event.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum EventKind {
    /// Slip ends, and the contact sticks.
    Stick,
    /// Stick ends (slip onset): the stick force reaches the static limit, the normal load times the
    /// static coefficient.
    Release(Direction),
    /// The relative velocity changes its sign, and the contact does not stick: the force in stick
    /// would exceed the static limit, or the law has no stick.
    Crossing(Direction),
    /// The normal load of a contact falls below 0, or falls to 0 and stays 0. The friction force is
    /// then 0. A load that only touches 0 is no event: see [`Contact`](crate::Contact). A stop
    /// opens when its force ends.
    Open,
    /// The normal load of a contact rises above 0 again, and friction acts again. A stop closes
    /// when its force begins.
    Close,
}

impl EventKind {
    /// The mode of the contact after the event; `Stick` for every `Close`.
    ///
    /// After a `Close` event the contact sticks or slips, depending on its relative velocity. The
    /// kind of the event does not contain this velocity.
    /// [`Trajectory::mode_at`](crate::Trajectory::mode_at) returns the true mode.
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

/// An event of a motion: a contact sticks, begins to slip, reverses its direction of slip, opens or
/// closes.
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
    /// The element at which the event happens. A [`MassOnBelt`](crate::MassOnBelt) has only one,
    /// `Element::Contact(0)`.
    pub element: Element,
    /// The kind of the event.
    pub kind: EventKind,
    /// State at the event. At a stick, a release or a crossing of a mass on a belt, the velocity of
    /// the mass equals the belt velocity bit for bit. A contact may open or close at any velocity,
    /// and the slider of an elastic contact may stick or slip at any velocity of the mass.
    pub state: S,
}

impl<S> Event<S> {
    /// The number of the contact at which the event happens; `None` for another element.
    ///
    /// ```
    /// use stick_slip::{Element, Event, EventKind, State};
    ///
    /// let (time, element, state) = (1.0, Element::Contact(2), State::new(0.0, 0.1));
    /// let event = Event { time, element, kind: EventKind::Stick, state };
    /// assert_eq!(event.contact(), Some(2));
    /// ```
    pub const fn contact(&self) -> Option<usize> {
        self.element.contact()
    }

    /// Returns this event with another state.
    pub(crate) fn with_state<T>(&self, state: T) -> Event<T> {
        Event {
            time: self.time,
            element: self.element,
            kind: self.kind,
            state,
        }
    }
}

impl std::fmt::Display for Event {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            time, kind, state, ..
        } = self;
        write!(f, "{time:.9}  {kind:<20}  u = {:.9}", state.displacement)
    }
}
