//! Parts of a structure that errors name, and the reasons why one has no steady sliding.

use super::numbers::Plain;

/// An element of a system, identified by numbers counted from 0. An [`Error`](crate::Error) and an
/// [`Event`](crate::Event) name the element concerned.
#[allow(clippy::enum_variant_names)] // as the type is called
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum Element {
    /// A mass, by its coordinate.
    Mass(usize),
    /// An entry of the mass matrix, by row and column.
    MassMatrix(usize, usize),
    /// An entry of the stiffness matrix, by row and column; or a spring, by the coordinates at its
    /// two ends. A spring to the ground has the same coordinate twice.
    Stiffness(usize, usize),
    /// An entry of the damping matrix, by row and column; or a damper, by the coordinates at its
    /// two ends. A damper to the ground has the same coordinate twice.
    Damping(usize, usize),
    /// The force on a coordinate, by the coordinate.
    Force(usize),
    /// A [stop](crate::structure::Stop), by its number.
    Stop(usize),
    /// A contact, by its number; 0 for a [`MassOnBelt`](crate::MassOnBelt), which has only one.
    Contact(usize),
    /// A [force element](crate::ForceElement), by its number.
    ForceElement(usize),
    /// A [first-order state](crate::FirstOrder), by its number.
    FirstOrder(usize),
}

impl Element {
    /// The number of a contact; `None` for another element.
    pub(crate) const fn contact(self) -> Option<usize> {
        match self {
            Self::Contact(contact) => Some(contact),
            _ => None,
        }
    }
}

impl std::fmt::Display for Element {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Mass(i) => write!(f, "mass {i}"),
            Self::MassMatrix(i, j) => write!(f, "mass matrix ({i}, {j})"),
            Self::Stiffness(i, j) => write!(f, "stiffness ({i}, {j})"),
            Self::Damping(i, j) => write!(f, "damping ({i}, {j})"),
            Self::Force(i) => write!(f, "force on coordinate {i}"),
            Self::Stop(i) => write!(f, "stop {i}"),
            Self::Contact(i) => write!(f, "contact {i}"),
            Self::ForceElement(i) => write!(f, "force element {i}"),
            Self::FirstOrder(i) => write!(f, "first-order state {i}"),
        }
    }
}

/// The reason why a [`Structure`](crate::Structure) has no steady sliding.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum NotSliding {
    /// A drive varies in time.
    Driven,
    /// The surfaces of a contact do not move relative to each other when all masses are at rest.
    NoSpeed {
        /// Number of the contact.
        contact: usize,
    },
    /// The normal load of a contact is not positive in steady sliding, and the contact cannot count
    /// as open: either its load depends on displacements and is exactly 0, or it has a load
    /// gradient, but neither a normal spring nor a load law.
    NoLoad {
        /// Number of the contact.
        contact: usize,
        /// The normal load of this contact, in units of force.
        load: f64,
    },
    /// The surfaces of an elastic contact do not move relative to each other when all masses are at
    /// rest. The contact can then transmit any force up to its limit, so the equilibria form a
    /// continuum.
    Continuum {
        /// Number of the contact.
        contact: usize,
    },
    /// The memory variables of a contact have no stationary values.
    NoSteadyMemory {
        /// Number of the contact.
        contact: usize,
    },
    /// The given velocities are not those of a rigid-body motion: they change the force of a
    /// spring, or a load.
    Deforms {
        /// The first coordinate whose velocity changes such a force.
        coordinate: usize,
    },
    /// A first-order state that integrates velocities grows at the given velocities.
    Grows {
        /// Number of the state.
        state: usize,
        /// The rate of the state, in its units per unit of time.
        rate: f64,
    },
    /// A freewheel, or another contact with an infinite limit, would slip in the direction in which
    /// it cannot: see [`Error::WrongWay`](crate::Error::WrongWay).
    WrongWay {
        /// Number of the contact.
        contact: usize,
        /// Relative velocity of the contact.
        velocity: f64,
    },
    /// A contact does not slip at the given velocities, but balance requires a force above its
    /// limit.
    OverLimit {
        /// Number of the contact.
        contact: usize,
        /// The size of the force that balance requires.
        force: f64,
        /// The limit of the force in stick, with memory variables of 0.
        limit: f64,
    },
    /// No equilibrium was found from the given displacements: there may be none, as for a magnet
    /// that pulls too strongly, or it is far away. Start closer to it:
    /// [`Structure::steady_sliding_from`](crate::Structure::steady_sliding_from).
    NotFound {
        /// Largest unbalanced acceleration of a coordinate where the search ended.
        residual: f64,
        /// The part of the load, from 0 to 1, up to which an equilibrium was found.
        load: f64,
    },
    /// The position of a force element is exactly on a breakpoint of its law, or a stop just
    /// touches, so that the stiffness differs on both sides.
    AtBreakpoint {
        /// The force element or the stop.
        element: Element,
        /// The position x.
        position: f64,
    },
    /// The position of a [load law](crate::Contact::with_load_law) is exactly on a breakpoint of
    /// the law, so that the slope of the load differs on both sides.
    LoadAtBreakpoint {
        /// Number of the contact.
        contact: usize,
        /// The position x.
        position: f64,
    },
    /// The stiffness matrix, including the terms that friction adds to it, is singular.
    Singular,
    /// A force, or a displacement or acceleration of steady sliding, overflows.
    Overflow,
    /// The eigenvalues could not be computed.
    Eigenvalues,
}

impl std::fmt::Display for NotSliding {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Driven => f.write_str("a drive varies in time; make all drives constant"),
            Self::NoSpeed { contact } => write!(
                f,
                "contact {contact} does not slide when all masses are at rest; give its surface a \
                 velocity"
            ),
            Self::NoLoad { contact, load } => write!(
                f,
                "contact {contact} has the normal load {} in steady sliding; make the load \
                 positive",
                Plain(*load)
            ),
            Self::Continuum { contact } => write!(
                f,
                "elastic contact {contact} does not slide when all masses are at rest, and then \
                 carries any force up to its limit: the equilibria form a continuum; simulate to \
                 one of them, or give the surface of the contact a velocity"
            ),
            Self::NoSteadyMemory { contact } => write!(
                f,
                "the memory variables of contact {contact} have no constant values in steady \
                 sliding"
            ),
            Self::Deforms { coordinate } => write!(
                f,
                "the velocities are not those of a rigid-body motion: that of coordinate \
                 {coordinate} changes the force of a spring or a load; give the same velocity to \
                 coordinates that springs connect, and 0 to those held by the ground"
            ),
            Self::Grows { state, rate } => write!(
                f,
                "first-order state {state} grows at the rate {} at these velocities, and no \
                 displacement changes that; give velocities at which it is constant",
                Plain(*rate)
            ),
            Self::WrongWay { contact, velocity } => write!(
                f,
                "contact {contact} would slip at the velocity {}, in the direction in which it \
                 cannot; give other velocities, or turn it round",
                Plain(*velocity)
            ),
            Self::OverLimit {
                contact,
                force,
                limit,
            } => write!(
                f,
                "contact {contact} does not slip at these velocities, but balance requires the \
                 force {}, and its limit is {}; give it a slip speed, or reduce the forces",
                Plain(*force),
                Plain(*limit)
            ),
            Self::NotFound { residual, load } => write!(
                f,
                "no equilibrium was found, up to {} of the load; a residual acceleration of {} is \
                 left; there may be none, or it is far away: give displacements near it to \
                 `steady_sliding_from`",
                Plain(*load),
                Plain(*residual)
            ),
            Self::AtBreakpoint { element, position } => write!(
                f,
                "{element} is on a breakpoint of its law, at {}: its stiffness differs on both \
                 sides; change a load slightly",
                Plain(*position)
            ),
            Self::LoadAtBreakpoint { contact, position } => write!(
                f,
                "a load law of contact {contact} is on a breakpoint, at {}: the slope of the load \
                 differs on both sides; change a load slightly",
                Plain(*position)
            ),
            Self::Singular => f.write_str(
                "the stiffness matrix is singular; restrain the rigid-body modes, for example by \
                 a spring to the ground in a frame that moves with the masses",
            ),
            Self::Overflow => f.write_str(
                "a force, a displacement or an acceleration overflows; choose other units of \
                 length and of time",
            ),
            Self::Eigenvalues => f.write_str(
                "the eigenvalues could not be computed; check the sizes of the matrix entries",
            ),
        }
    }
}
