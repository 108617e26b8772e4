use crate::state::structure::State;

mod context;
mod derivative;
mod numbers;
mod reached;
mod structure;
mod units;

pub use derivative::NotDifferentiable;
use numbers::instead;
pub(crate) use numbers::{Coefficients, Digits, Plain};
pub use reached::Reached;
use reached::during;
pub use structure::{Element, NotSliding};

/// The reason why a law, a system or a start state is not valid, or why a motion or a search could
/// not continue.
///
/// Every variant contains the numbers that a caller needs to decide what to do, and its message
/// names the remedy. The numbers have the units of the type whose method was called: they are
/// dimensionless for a [`MassOnBelt`](crate::MassOnBelt), in SI units for
/// [`Scaling::new`](crate::Scaling::new) and a [`PhysicalMassOnBelt`](crate::PhysicalMassOnBelt),
/// and in the units of the structure for a [`Structure`](crate::Structure).
///
/// | met by | variants |
/// |---|---|
/// | constructors of laws and of a [`MassOnBelt`](crate::MassOnBelt) | [`InvalidParameter`](Self::InvalidParameter), [`BadPoint`](Self::BadPoint), [`StaticBelowKinetic`](Self::StaticBelowKinetic), [`NonFiniteFriction`](Self::NonFiniteFriction), [`NotAnalytic`](Self::NotAnalytic), [`BadBreakpoints`](Self::BadBreakpoints) |
/// | every motion, and the settings of an [`Integrator`](crate::Integrator) | [`InvalidParameter`](Self::InvalidParameter), [`InvalidState`](Self::InvalidState), [`InvalidTolerance`](Self::InvalidTolerance), [`InvalidDuration`](Self::InvalidDuration), [`NonFiniteFriction`](Self::NonFiniteFriction), [`NotAnalytic`](Self::NotAnalytic), [`StepUnderflow`](Self::StepUnderflow), [`TooManySteps`](Self::TooManySteps), [`TooManyEvents`](Self::TooManyEvents) |
/// | constructors of a [`Structure`](crate::Structure) and of its parts | [`InvalidParameter`](Self::InvalidParameter), [`BadPoint`](Self::BadPoint), [`BadBreakpoints`](Self::BadBreakpoints), [`BadElement`](Self::BadElement), [`NoSuchCoordinate`](Self::NoSuchCoordinate), [`NoSuchState`](Self::NoSuchState), [`WrongSize`](Self::WrongSize), [`NotSymmetric`](Self::NotSymmetric), [`NotPositiveDefinite`](Self::NotPositiveDefinite), [`BadDirection`](Self::BadDirection), [`RigidStop`](Self::RigidStop), [`LawNotConstant`](Self::LawNotConstant), [`BeltVelocityJumps`](Self::BeltVelocityJumps) |
/// | motions of a [`Structure`](crate::Structure), and its steady sliding | [`WrongSize`](Self::WrongSize), [`OverLimit`](Self::OverLimit), [`Separation`](Self::Separation), [`TooManyMechanisms`](Self::TooManyMechanisms), [`Jammed`](Self::Jammed), [`WrongWay`](Self::WrongWay), [`NoSteadySliding`](Self::NoSteadySliding), [`NonFiniteForce`](Self::NonFiniteForce), [`NotAnalyticForce`](Self::NotAnalyticForce), [`NonFiniteLoad`](Self::NonFiniteLoad), [`NotAnalyticLoad`](Self::NotAnalyticLoad), [`NonFiniteRate`](Self::NonFiniteRate), [`NotAnalyticRate`](Self::NotAnalyticRate) |
/// | searches along a parameter | [`At`](Self::At), [`Stopped`](Self::Stopped) |
/// | searches of [`orbit`](crate::orbit) | [`NotPeriodic`](Self::NotPeriodic), [`NoCommonPeriod`](Self::NoCommonPeriod), [`NotFree`](Self::NotFree), [`AtRest`](Self::AtRest), [`NoHopfPoint`](Self::NoHopfPoint), [`NoSwitch`](Self::NoSwitch), [`NotSmooth`](Self::NotSmooth), [`NoDerivative`](Self::NoDerivative) |
///
/// To show the message, print the error with `{error}`. A `main` that returns `Result<(), Error>`
/// prints the variant and its fields instead, by `Debug`.
///
/// ```
/// use stick_slip::{Error, Polynomial};
///
/// let error = Polynomial::new(0.4, 0.5, 0.5).unwrap_err();
/// assert_eq!(
///     error,
///     Error::InvalidParameter {
///         of: "Polynomial",
///         name: "minimum_coefficient",
///         value: 0.5,
///         allowed: "0 ≤ minimum_coefficient ≤ static_coefficient",
///     }
/// );
/// assert_eq!(
///     error.to_string(),
///     "Polynomial: minimum_coefficient = 0.5 is not allowed: \
///      0 ≤ minimum_coefficient ≤ static_coefficient"
/// );
/// ```
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A parameter of a law, a system, the integrator or a search is outside its range, infinite or
    /// NaN.
    #[error("{of}: {name} = {} is not allowed{}", Plain(*value), instead(*value, allowed))]
    InvalidParameter {
        /// The type or function that refused the value, for example `Stribeck`.
        of: &'static str,
        /// The parameter's name in the constructor.
        name: &'static str,
        /// The value that was given.
        value: f64,
        /// The range in which the value must lie.
        allowed: &'static str,
    },

    /// A point of a table ([`Tabulated::new`](crate::Tabulated::new),
    /// [`TabulatedForce::new`](crate::TabulatedForce::new)) or of a profile
    /// ([`Drive::profile`](crate::Drive::profile)) is not allowed.
    #[error(
        "{of}: point {index}, counted from 0: {name} = {} is not allowed{}",
        Plain(*value),
        instead(*value, allowed)
    )]
    BadPoint {
        /// The type that refused the point: `Tabulated`, `TabulatedForce` or `Drive`.
        of: &'static str,
        /// Number of the point, counted from 0.
        index: usize,
        /// The number at fault: `speed` or `coefficient` of a friction table, `position` or `force`
        /// of a force table, `time` or `value` of a drive.
        name: &'static str,
        /// The number that was given.
        value: f64,
        /// The range in which the value must lie.
        allowed: &'static str,
    },

    /// A start state has an infinite or NaN component, or is so large or so small that the
    /// equations overflow or underflow. This error is also returned if the energy of a state
    /// overflows.
    #[error(
        "the state u = {}, v = {} {}",
        Plain(*displacement),
        Plain(*velocity),
        if displacement.is_finite() && velocity.is_finite() {
            "overflows or underflows in the equations; choose a unit of length in which both \
             numbers are of ordinary size"
        } else {
            "is not finite; give two finite numbers"
        }
    )]
    InvalidState {
        /// Displacement u that was given.
        displacement: f64,
        /// Velocity v that was given.
        velocity: f64,
    },

    /// A relative tolerance is outside its range or NaN:
    /// [`Integrator::with_tolerance`](crate::Integrator::with_tolerance).
    #[error(
        "Integrator: tolerance = {} is not allowed; give a number with \
         {min:e} ≤ tolerance ≤ {max:e}",
        Plain(*value)
    )]
    InvalidTolerance {
        /// The value that was given.
        value: f64,
        /// The least tolerance allowed, slightly below round-off.
        min: f64,
        /// The largest tolerance allowed.
        max: f64,
    },

    /// A duration is negative, infinite or NaN, or is 0 in a function that computes a mean over the
    /// duration.
    #[error(
        "duration = {} is not allowed{}; for a simulation without an end use `flow`",
        Plain(*value),
        // 0 is refused only where something is a mean over the duration.
        instead(*value, if *value == 0.0 { "duration > 0" } else { "duration ≥ 0" })
    )]
    InvalidDuration {
        /// The value that was given.
        value: f64,
    },

    /// The law's kinetic coefficient at zero speed, μ̂(0), exceeds its static coefficient μ_s by
    /// more than a few ulps.
    #[error(
        "the static coefficient {} is below the kinetic coefficient at zero speed, {}; raise μ_s \
         or lower μ̂(0)",
        Plain(*static_coefficient),
        Plain(*kinetic_coefficient)
    )]
    StaticBelowKinetic {
        /// μ_s of the law.
        static_coefficient: f64,
        /// μ̂(0) of the law.
        kinetic_coefficient: f64,
    },

    /// The law returned an infinite or NaN number: a coefficient, the rate of a memory variable, or
    /// a memory variable after an event.
    #[error(
        "the friction law gives {value} at sliding speed {}{}; define the law for every speed \
         that the motion reaches, or start closer to the belt velocity",
        Plain(*speed),
        during(reached)
    )]
    NonFiniteFriction {
        /// Sliding speed s ≥ 0; 0 in stick.
        speed: f64,
        /// The number that the law returned at this speed.
        value: f64,
        /// The time and state reached; `None` if the error arose before the integration, for
        /// example in a constructor.
        reached: Option<Reached>,
    },

    /// The law has a value but no power series at a sliding speed s, for example √s at s = 0.
    #[error(
        "the friction law is not analytic at sliding speed {}{}; use integer powers of the \
         speed there, or declare the speed as a breakpoint and define the pieces; give the slip \
         law a least speed with `with_least_speed`, and start a state φ of rate-and-state friction \
         between -100 and 250",
        Plain(*speed),
        during(reached)
    )]
    NotAnalytic {
        /// Sliding speed s ≥ 0.
        speed: f64,
        /// The time and state reached; `None` if the error arose before the integration, for
        /// example in a constructor.
        reached: Option<Reached>,
    },

    /// A breakpoint of the law is infinite, NaN or not positive, does not exceed the breakpoint
    /// before it, or is a speed at which the law jumps.
    #[error(
        "breakpoint {index} of the law (counted from 0), {}, is not allowed; breakpoints must be \
         finite and strictly ascending, those of a friction law positive, and the law continuous \
         there",
        Plain(*value)
    )]
    BadBreakpoints {
        /// Number of the first such breakpoint, counted from 0.
        index: usize,
        /// The value of this breakpoint.
        value: f64,
    },

    /// A [`ForceLaw`](crate::ForceLaw) or [`ForceField`](crate::ForceField) returned NaN or ±∞ on a
    /// motion, or grows without bound there: the motion runs into a pole of the force.
    #[error(
        "force element {element} gives {value} at position {} and velocity {} {reached}; define \
         the force at every position that the motion reaches, or stop the motion before a pole",
        Plain(*position),
        Plain(*velocity)
    )]
    NonFiniteForce {
        /// Number of the element, counted from 0.
        element: usize,
        /// Position x along its first direction.
        position: f64,
        /// Velocity y along this direction.
        velocity: f64,
        /// The force, in units of force: NaN, infinite, or the large value that was reached.
        value: f64,
        /// The time and state reached.
        reached: Reached,
    },

    /// A [`ForceLaw`](crate::ForceLaw) or [`ForceField`](crate::ForceField) has no power series at
    /// a position that the motion reaches, such as x^(3/2) at x = 0.
    #[error(
        "force element {element} is not analytic at position {} {reached}; use integer powers \
         there, or declare the position as a breakpoint and define the pieces by functions that \
         are analytic on both sides of it, for example through points",
        Plain(*position)
    )]
    NotAnalyticForce {
        /// Number of the element, counted from 0.
        element: usize,
        /// Position x along its first direction.
        position: f64,
        /// The time and state reached.
        reached: Reached,
    },

    /// A law in the rate of a [first-order state](crate::FirstOrder) returned NaN or ±∞ on a
    /// motion, or grows without bound there.
    #[error(
        "the law of first-order state {state} gives {value} at {} {reached}; define it at every \
         value that the motion reaches, or stop the motion before a pole",
        Plain(*position)
    )]
    NonFiniteRate {
        /// Number of the state, counted from 0.
        state: usize,
        /// The input x of the law.
        position: f64,
        /// The rate: NaN, infinite, or the large value that was reached.
        value: f64,
        /// The time and state reached.
        reached: Reached,
    },

    /// A law in the rate of a [first-order state](crate::FirstOrder) has no power series at a value
    /// that the motion reaches, such as √x at x = 0.
    #[error(
        "the law of first-order state {state} is not analytic at {} {reached}; use integer powers \
         there, or declare the value as a breakpoint and define the pieces by functions that are \
         analytic on both sides of it",
        Plain(*position)
    )]
    NotAnalyticRate {
        /// Number of the state, counted from 0.
        state: usize,
        /// The input x of the law.
        position: f64,
        /// The time and state reached.
        reached: Reached,
    },

    /// A [load law](crate::Contact::with_load_law) returned NaN or ±∞ on a motion, or grows without
    /// bound there: the motion runs into a pole of the load.
    #[error(
        "a load law of contact {contact} gives no finite number, or grows without bound, at \
         position {} and velocity {} {reached}; define the load at every position that the motion \
         reaches, or stop the motion before a pole",
        Plain(*position),
        Plain(*velocity)
    )]
    NonFiniteLoad {
        /// Number of the contact, counted from 0.
        contact: usize,
        /// Position x along the direction of the law.
        position: f64,
        /// Velocity y along this direction.
        velocity: f64,
        /// The time and state reached.
        reached: Reached,
    },

    /// A [load law](crate::Contact::with_load_law) has no power series at a position that the
    /// motion reaches, such as x^(3/2) at x = 0.
    #[error(
        "a load law of contact {contact} is not analytic at position {} {reached}; use integer \
         powers there, or declare the position as a breakpoint and define the pieces by functions \
         that are analytic on both sides of it, for example through points",
        Plain(*position)
    )]
    NotAnalyticLoad {
        /// Number of the contact, counted from 0.
        contact: usize,
        /// Position x along the direction of the law.
        position: f64,
        /// The time and state reached.
        reached: Reached,
    },

    /// A mass, stiffness, damping, force or contact of a structure is outside its range, infinite
    /// or NaN.
    #[error(
        "Structure: {element} = {} is not allowed{}",
        Plain(*value),
        instead(*value, allowed)
    )]
    BadElement {
        /// The element of the structure.
        element: Element,
        /// The value that was given.
        value: f64,
        /// The range in which the value must lie.
        allowed: &'static str,
    },

    /// An element is attached to a coordinate that the structure does not have.
    #[error(
        "Structure: {element}: there is no coordinate {coordinate}; the {count} coordinates are \
         counted from 0"
    )]
    NoSuchCoordinate {
        /// The element of the structure.
        element: Element,
        /// The coordinate that was given.
        coordinate: usize,
        /// Number of coordinates.
        count: usize,
    },

    /// A first-order state reads one that does not exist.
    #[error(
        "{element}: there is no first-order state {state}; there are {count}, numbered from 0; add \
         states that read each other together, by `Structure::with_first_orders`"
    )]
    NoSuchState {
        /// The element of the structure.
        element: Element,
        /// The number of the state that was given.
        state: usize,
        /// Number of first-order states.
        count: usize,
    },

    /// A matrix or a start does not have the size of the structure.
    #[error("{name}: {found} given; {expected} are needed")]
    WrongSize {
        /// Name of the things counted, for example `rows of the stiffness matrix`.
        name: &'static str,
        /// The number given.
        found: usize,
        /// The number needed.
        expected: usize,
    },

    /// No function returns this error: a coordinate may have several contacts.
    #[error("coordinate {coordinate} has contact {contact} already")]
    CoordinateTaken {
        /// The coordinate, counted from 0.
        coordinate: usize,
        /// The contact that the coordinate already has, counted from 0.
        contact: usize,
    },

    /// A mass matrix is not symmetric:
    /// [`Structure::with_mass_matrix`](crate::Structure::with_mass_matrix).
    #[error(
        "the mass matrix is not symmetric: its entries ({row}, {column}) and ({column}, {row}) \
         differ by more than rounding; give (M + Mᵀ)/2"
    )]
    NotSymmetric {
        /// Row of the entry above the diagonal, counted from 0.
        row: usize,
        /// Column of this entry, counted from 0.
        column: usize,
    },

    /// A mass matrix is not positive definite: some motion would have a kinetic energy ≤ 0.
    #[error(
        "the mass matrix is not positive definite: coordinate {row}, together with those before \
         it, can move with a kinetic energy ≤ 0; eliminate massless coordinates first (static \
         condensation)"
    )]
    NotPositiveDefinite {
        /// The first row, counted from 0, whose pivot in Cholesky's factorisation is not positive.
        row: usize,
    },

    /// The direction of a contact, a force element or a stop is not valid: each coordinate must
    /// occur only once, and the coefficients must be finite and not all 0.
    #[error(
        "the direction {direction:?} of a contact, force element or stop is not allowed: give at \
         least one pair (coordinate, b) with finite b ≠ 0, and each coordinate only once"
    )]
    BadDirection {
        /// The direction that was given.
        direction: Vec<(usize, f64)>,
    },

    /// A structure has no [steady sliding](crate::Structure::steady_sliding). The error contains
    /// the reason.
    #[error("no steady sliding: {0}")]
    NoSteadySliding(NotSliding),

    /// A motion has no derivative with respect to a parameter. The error contains the reason.
    #[error("no derivative with respect to parameter {parameter}, counted from 0: {reason}")]
    NoDerivative {
        /// The number of the parameter, counted from 0.
        parameter: usize,
        /// The reason.
        reason: NotDifferentiable,
    },

    /// A curve was requested for a change of events that [`orbit::locus`](crate::orbit::locus)
    /// cannot follow. That search follows grazings of a slipping contact, onsets of stops, and
    /// changes of the order of events of two contacts. (At an onset of stops a contact begins to
    /// stick at an instant at which its relative velocity only passed through 0.)
    #[error(
        "no curve of this bifurcation can be followed: no grazing of a slipping contact, no onset \
         of a stop and no two simultaneous events are near; give a bifurcation of one of these \
         kinds, or a fold, flip, pitchfork or Neimark-Sacker bifurcation"
    )]
    NotSmooth,

    /// A branch was requested at a bifurcation at which no other branch of periodic motions crosses
    /// ([`Bifurcation::switch`](crate::orbit::Bifurcation::switch)).
    #[error(
        "no other branch of periodic motions crosses at a bifurcation of the kind {kind}; switch \
         at a flip or a pitchfork"
    )]
    NoSwitch {
        /// The kind of the bifurcation.
        kind: &'static str,
    },

    /// No Hopf point of steady sliding is near the given value of the parameter: no pair of
    /// eigenvalues crosses the imaginary axis.
    #[error(
        "no Hopf point is near the given value of the parameter: no pair of eigenvalues crosses \
         the imaginary axis; give a value closer to a Hopf point"
    )]
    NoHopfPoint,

    /// A stop has no contact stiffness: rigid stops are not available.
    #[error(
        "stop {stop} is rigid, and rigid impacts are not available: give its stiffness and damping \
         by `Stop::with_contact_stiffness(k, c)`; the page of `Stop` says which damping has the \
         rebound of a restitution"
    )]
    RigidStop {
        /// The number that the stop would have.
        stop: usize,
    },

    /// Too many contacts with linearly dependent directions are at rest at the same time. The ways
    /// in which some of them can begin to slip are found by trying sets of them.
    #[error(
        "contacts {contacts:?} stick {reached}, and their directions are linearly dependent: how \
         they can begin to slip would be found by trying {subsets} sets of them, more than {most}; \
         replace contacts of the same direction by one contact with the sum of their limits, or \
         make some of them elastic by `with_tangential_stiffness`"
    )]
    TooManyMechanisms {
        /// The numbers of these contacts, ascending.
        contacts: Vec<usize>,
        /// The number of sets to try.
        subsets: usize,
        /// The largest number of sets that are tried.
        most: usize,
        /// The time and state reached; boxed, because the other numbers are many.
        reached: Box<Reached>,
    },

    /// Freewheels, or other contacts with an infinite limit, would have to move with surfaces that
    /// part: no finite force and no finite acceleration exists.
    #[error(
        "contacts {contacts:?} jam {reached}: each of them slips in one direction only, and their \
         surfaces move so that all would have to slip the other way; turn one of them round, or \
         give it a finite limit by `Directional`"
    )]
    Jammed {
        /// The numbers of these contacts.
        contacts: Vec<usize>,
        /// The time and state reached.
        reached: Reached,
    },

    /// A freewheel, or another contact with an infinite limit, moves in the direction in which it
    /// cannot slip, at a start or when it closes.
    #[error(
        "contact {contact} closes with the relative velocity {}, in the direction in which it \
         cannot slip; start at rest or in the other direction, or turn it round by exchanging its \
         coordinates",
        Plain(*velocity)
    )]
    WrongWay {
        /// Number of the contact.
        contact: usize,
        /// The relative velocity r, in units of velocity.
        velocity: f64,
    },

    /// The law of an elastic contact is not constant
    /// ([`Contact::with_tangential_stiffness`](crate::Contact::with_tangential_stiffness)). The
    /// displacement of the slider would not be determined when slip starts.
    #[error(
        "an elastic contact needs one coefficient of friction at all speeds, and this law {}; give \
         `Coulomb::new(μ, μ)`, or give the slider a mass: a coordinate of its own, with a spring \
         of stiffness k_t to the structure and a rigid contact with this law",
        Coefficients(*coefficients)
    )]
    LawNotConstant {
        /// μ_s and μ̂(0), dimensionless: the larger μ_s and the smaller μ̂(0) of both directions;
        /// `None` for a law that never sticks, such as a bristle model: its friction at rest
        /// depends on its memory variables alone.
        coefficients: Option<[f64; 2]>,
    },

    /// The force of an elastic contact in the start state exceeds the limit force μN of its slider
    /// (coefficient μ, normal load N) by more than 10⁻¹² of the terms of μN. A smaller excess is
    /// rounding, as in a state after many periods of a load, and the limit is taken instead.
    #[error(
        "elastic contact {contact} cannot carry {} at the start: its limit force μN is {} there; \
         start with a smaller force",
        Plain(*carried),
        Plain(*limit)
    )]
    OverLimit {
        /// Number of the contact.
        contact: usize,
        /// The force T that was given, in units of force.
        carried: f64,
        /// The limit force μN, in units of force.
        limit: f64,
    },

    /// The velocity of a belt jumps at a rigid contact that may stick. A sticking mass would need
    /// an infinite force to follow the jump.
    #[error(
        "the velocity of the belt under coordinate {coordinate} jumps at time {}; replace the \
         jump by a steep ramp",
        Plain(*time)
    )]
    BeltVelocityJumps {
        /// The coordinate of the contact, counted from 0.
        coordinate: usize,
        /// The time of the first jump.
        time: f64,
    },

    /// A step became so short that the time no longer changes, or the power series of a step
    /// overflows. The causes are a motion that grows without bound, an undeclared kink or jump of
    /// the law, or a slope γ²·dμ̂/ds of friction beyond the order of 1e20 (γ²: load, μ̂: kinetic
    /// coefficient, s: sliding speed). In a structure, another cause is a stiffness with a natural
    /// frequency of the order of 1e12 per unit of time or more.
    #[error(
        "the step size fell to {} {reached}: {}",
        Plain(*step),
        if reached.overflows() {
            "the motion grows beyond the largest numbers; if this is not intended, look for a \
             negative stiffness or damping, or for friction that feeds the motion; otherwise end \
             the run earlier with `simulate_until`"
        } else {
            "the law has a jump or kink there that is not declared as a breakpoint, or the system \
             is too stiff: γ²·dμ̂/ds exceeds about 1e20, or in a structure a spring, a bristle or \
             the tangential spring of a contact is too stiff; lower this stiffness, or use a \
             rigid contact; under rate-and-state friction the speed settles, or the state heals, \
             faster than the clock resolves: start with a smaller |φ|, below 100, or near the \
             balance of forces"
        }
    )]
    StepUnderflow {
        /// Length of the last step tried, in units of time.
        step: f64,
        /// The time and state reached.
        reached: Reached,
    },

    /// The largest number of steps was reached before the end of the motion.
    #[error(
        "the limit of {limit} steps was reached {reached}; in a simulation raise the limit with \
         `with_max_steps`, shorten the run, or use `flow`. Hundreds of steps in an oscillation \
         indicate a jump or kink of the law that is not declared as a breakpoint, or a stiff \
         structure"
    )]
    TooManySteps {
        /// The limit that was reached.
        limit: usize,
        /// The time and state reached.
        reached: Reached,
    },

    /// A normal load that depends on displacements fell to 0.
    ///
    /// The surfaces separate. The stiffness matrix is no longer valid, because it contains the
    /// normal spring. (A load that depends on time alone may fall to 0, with the event
    /// [`EventKind::Open`](crate::EventKind::Open).)
    #[error(
        "contact {contact} separates {reached}: its normal load falls to 0; end the motion here, \
         or press the surfaces together with a larger load"
    )]
    Separation {
        /// Number of the contact.
        contact: usize,
        /// The time and state reached.
        reached: Reached,
    },

    /// The largest number of events was reached before the end of the motion.
    #[error(
        "the limit of {limit} events was reached {reached}; raise the limit with \
         `with_max_events`, shorten the run, or use `flow`"
    )]
    TooManyEvents {
        /// The limit that was reached.
        limit: usize,
        /// The time and state reached.
        reached: Reached,
    },

    /// A motion with the common period of the drives was requested, but the drives have no common
    /// period.
    #[error(
        "the drives have no common period: all are constant, or their frequencies are \
         incommensurate, or one is a profile; for an autonomous motion give `Period::Free`, \
         otherwise make the frequencies commensurate"
    )]
    NoCommonPeriod,

    /// An autonomous motion ([`Period::Free`](crate::orbit::Period::Free)) was requested, but a
    /// drive of the system varies in time.
    #[error("a drive varies in time, so no motion is autonomous; give `Period::Driven`")]
    NotFree,

    /// A search for an autonomous periodic motion began at an equilibrium, or reached an
    /// equilibrium.
    #[error(
        "the search is at an equilibrium, which is not a periodic motion; give a guess on the \
         periodic motion, for example the end of a transient"
    )]
    AtRest,

    /// Newton's method did not converge to a periodic motion.
    #[error(
        "no periodic motion was found near the guess: the best start tried is q = {:?}, v = {:?}; \
         after the period {} a state variable differs from its start by {} of its size; give a \
         guess closer to the motion, for example by `settle` with a longer transient, or a better \
         period",
        start.displacements,
        start.velocities,
        Plain(*period),
        Plain(*residual)
    )]
    NotPeriodic {
        /// Largest difference of a state variable between the start and the end of the period, in
        /// units of the largest absolute value of this variable.
        residual: f64,
        /// The period, in units of time.
        period: f64,
        /// The best start that was tried.
        start: State,
    },

    /// A search along a parameter was stopped by its watcher, a function set by the caller, or at
    /// its largest number of steps. The largest number is
    /// [`Search::DEFAULT_MAX_BRANCH_STEPS`](crate::Search::DEFAULT_MAX_BRANCH_STEPS), unless
    /// [`Search::with_max_steps`](crate::Search::with_max_steps) sets another number. If the
    /// watcher stopped a search of [`orbit`](crate::orbit) on one system, `parameter` is `time`.
    #[error(
        "the search along {parameter} was stopped at {} after {steps} steps, with {} values \
         found; raise the limit with `with_max_steps`, or continue from there",
        Plain(*value),
        found.len()
    )]
    Stopped {
        /// The name of the parameter.
        parameter: &'static str,
        /// The value of the parameter to be searched next. All values well below `value` have been
        /// searched.
        value: f64,
        /// The number of steps taken in slip phases.
        steps: usize,
        /// The values found so far, in ascending order.
        found: Vec<f64>,
    },

    /// A search over a parameter failed at one value of this parameter.
    ///
    /// The contained error gives the reason and the remedy. A range without this value can still be
    /// searched.
    #[error("at {parameter} = {}: {source}", Plain(*value))]
    At {
        /// The name of the parameter: `belt_velocity`, `damping`, `load`, or the name given to
        /// [`Along::named`](crate::bifurcation::Along::named). In errors of [`orbit`](crate::orbit)
        /// the name is `parameter`; in errors of [`orbit::locus`](crate::orbit::locus) it is `first
        /// parameter` or `second parameter`. In errors of a
        /// [`PhysicalMassOnBelt`](crate::PhysicalMassOnBelt) it is `belt_velocity`, `damping` or
        /// `normal_force`, in SI units.
        parameter: &'static str,
        /// The value of the parameter.
        value: f64,
        /// The error at this value.
        source: Box<Self>,
    },
}
