//! What changes at events, and what lives for a step.

use super::expand::CoordinateSeries;
use super::factor::Factor;
use super::model::{ContactData, Model};
use crate::clock::Clock;
use crate::error::Reached;
use crate::friction::memory::Slip;
use crate::friction::memory::object::LawObject;
use crate::motion::Mode;
use crate::scalar::jet::Tape;
use crate::series::PowerSeries;
use crate::state::Direction;
use crate::state::structure::State;

/// The coordinates and contacts at the start of a step.
#[derive(Debug, Clone)]
pub(super) struct Situation {
    pub(super) clock: Clock,
    pub(super) coordinates: Vec<Coordinate>,
    pub(super) contacts: Vec<ContactState>,
    /// The shared contacts that stick, in the order of [`Model::shared`], and what holds them.
    pub(super) holding: Holding,
    /// Those that are closed, as far as they are independent; none if that is not known.
    pub(super) closed: Option<Holding>,
}

/// A set of shared contacts whose directions are independent.
#[derive(Debug, Clone, Default)]
pub(super) struct Holding {
    pub(super) contacts: Vec<usize>,
    pub(super) factor: Factor,
}

/// Displacement and velocity of a coordinate. While a contact of its own holds it the velocity is
/// that contact's: see [`Situation::velocity`].
#[derive(Debug, Clone)]
pub(super) struct Coordinate {
    pub(super) displacement: f64,
    pub(super) velocity: f64,
}

/// One contact.
#[derive(Debug, Clone)]
pub(super) struct ContactState {
    pub(super) phase: Phase,
    /// Of the stick band; after a release still that from which the contact was released.
    pub(super) edge: Edge,
    /// Of the normal load.
    pub(super) load_edge: Edge,
    pub(super) entry: Entry,
    pub(super) memory: Vec<f64>,
    /// The memory as slip came to r = 0.
    pub(super) arrival_memory: Vec<f64>,
    /// μ_s at the start of the step; `None` for a law that never sticks.
    pub(super) limit: Option<f64>,
}

/// What a contact does, with what belongs to it.
#[derive(Debug, Clone, Copy)]
pub(super) enum Phase {
    /// No load, no friction.
    Open,
    /// r = 0 since a time, from a displacement b·q.
    Stick { since: Clock, from: f64 },
    /// r = σy.
    Slip {
        direction: Direction,
        /// y ≥ 0: what is integrated, so that contact is exact however fast the surface moves.
        speed: f64,
        /// dy/dt at the start of the step, where it is known better than the equation of motion
        /// gives it: where slip begins.
        rate: Option<f64>,
        /// Which piece of the law holds.
        piece: usize,
    },
}

/// How a contact came to what it does at the start of a step.
#[derive(Debug, Clone, Copy)]
pub(super) enum Entry {
    /// As before.
    Held,
    /// It has come to r = 0, from slip in a direction or by closing: on the edge of its band within
    /// rounding counts as on it.
    Arrived(Option<Direction>),
    /// It stands on a breakpoint of its law, and the piece is decided.
    OnBreakpoint,
}

/// What is known of a contact at the bound of its stick band, or of its load.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Edge {
    /// Away from it, as far as is known.
    #[default]
    Away,
    /// On it, to the bit.
    On(Option<Direction>),
    /// On it, and its rate is 0: it was touched.
    Touched(Option<Direction>),
}

/// Why a contact ends a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Firing {
    /// The sliding speed is 0.
    Arrival,
    /// The sliding speed is at a breakpoint of the law, of this number, and rising or not.
    Breakpoint(usize, bool),
    /// The load carried is the largest, in this direction.
    Bound(Direction),
    /// The normal load is 0.
    Load,
}

/// The power series of a step.
#[derive(Debug, Clone)]
pub(super) struct Series {
    pub(super) coordinates: Vec<CoordinateSeries>,
    pub(super) contacts: Vec<ContactSeries>,
    /// Room for one order of the shared coordinates and contacts.
    pub(super) rates: Vec<f64>,
    pub(super) unheld: Vec<f64>,
    pub(super) held: Vec<f64>,
}

/// The series at one contact. All forces are accelerations of r: multiplied by G_cc.
#[derive(Debug, Clone)]
pub(super) struct ContactSeries {
    /// y.
    pub(super) speeds: PowerSeries,
    /// w.
    pub(super) surface: PowerSeries,
    /// What the contact carries in stick. One with a coordinate to itself: in slip what it would.
    pub(super) carried: PowerSeries,
    /// N μ_s; without terms beyond the first for a constant load and a law without memory.
    pub(super) bound: PowerSeries,
    /// N.
    pub(super) load: PowerSeries,
    /// Its part that is given in time.
    pub(super) drive_load: PowerSeries,
    /// Whether N is not the same at all times.
    pub(super) load_varies: bool,
    /// σμ in slip.
    pub(super) friction: PowerSeries,
    /// Its derivative by the sliding speed, at the start of the step.
    pub(super) slope: f64,
    /// μ_s, if the law has a memory.
    pub(super) limits: PowerSeries,
    pub(super) memories: Vec<PowerSeries>,
    /// One order of the rates of the memory.
    pub(super) rates: Vec<f64>,
    /// D, at which the memory relaxes, where its series is that of the slow manifold; else 0.
    pub(super) relaxation: f64,
    pub(super) tape: Tape,
}

impl Situation {
    /// Not yet decided.
    pub(super) fn new(model: &Model<'_>, clock: Clock, start: &State) -> Self {
        let coordinates = std::iter::zip(&start.displacements, &start.velocities);
        let coordinates = coordinates.map(|(&displacement, &velocity)| Coordinate {
            displacement,
            velocity,
        });
        let contacts = model.contacts.iter().enumerate().map(|(c, contact)| {
            let variable = |j: usize| start.memory.get(j).copied().unwrap_or(0.0);
            let memory: Vec<f64> = model.memory(c).map(variable).collect();
            ContactState {
                phase: Phase::Open,
                edge: Edge::Away,
                load_edge: Edge::Away,
                entry: Entry::Held,
                limit: contact.law.limit(&|j| memory[j]),
                arrival_memory: memory.clone(),
                memory,
            }
        });
        Self {
            clock,
            coordinates: coordinates.collect(),
            contacts: contacts.collect(),
            holding: Holding::default(),
            closed: None,
        }
    }

    /// v_i: that of a surface with a contact of the coordinate's own, w + σy.
    pub(super) fn velocity(&self, model: &Model<'_>, series: &Series, i: usize) -> f64 {
        let Some(c) = model.owner[i] else {
            return self.coordinates[i].velocity;
        };
        match self.contacts[c].phase {
            Phase::Open => self.coordinates[i].velocity,
            Phase::Stick { .. } => series.contacts[c].surface[0],
            Phase::Slip {
                direction, speed, ..
            } => series.contacts[c].surface[0] + direction.sign() * speed,
        }
    }

    /// b·q.
    pub(super) fn displacement_along(&self, contact: &ContactData<'_>) -> f64 {
        contact.along(|j| self.coordinates[j].displacement)
    }

    /// The state, with the memory of the contacts.
    pub(super) fn state(&self, model: &Model<'_>, series: &Series) -> State {
        let mut memory = Vec::with_capacity(model.remembered());
        memory.extend(self.contacts.iter().flat_map(|contact| &contact.memory));
        let velocities = 0..self.coordinates.len();
        State {
            displacements: self.coordinates.iter().map(|q| q.displacement).collect(),
            velocities: velocities
                .map(|i| self.velocity(model, series, i))
                .collect(),
            memory,
        }
    }

    pub(super) fn modes(&self) -> Vec<Mode> {
        self.contacts.iter().map(ContactState::mode).collect()
    }

    pub(super) fn reached(&self, model: &Model<'_>, series: &Series) -> Reached {
        Reached::new(self.clock.time, self.state(model, series))
    }
}

impl ContactState {
    pub(super) fn mode(&self) -> Mode {
        match self.phase {
            Phase::Open => Mode::Open,
            Phase::Stick { .. } => Mode::Stick,
            Phase::Slip { direction, .. } => Mode::Slip(direction),
        }
    }

    pub(super) fn sticks(&self) -> bool {
        matches!(self.phase, Phase::Stick { .. })
    }

    pub(super) fn phase_is_open(&self) -> bool {
        matches!(self.phase, Phase::Open)
    }

    /// What its law is given in slip, with another speed.
    pub(super) fn slip<S>(&self, speed: S) -> Option<Slip<S>> {
        match self.phase {
            Phase::Slip {
                direction, piece, ..
            } => Some(Slip {
                speed,
                direction: direction.sign(),
                piece,
            }),
            Phase::Open | Phase::Stick { .. } => None,
        }
    }

    /// μ_s at the start of the step, 0 for a law that never sticks.
    pub(super) fn static_coefficient(&self) -> f64 {
        self.limit.unwrap_or(0.0)
    }

    pub(super) fn has_arrived(&self) -> bool {
        matches!(self.entry, Entry::Arrived(_))
    }

    /// μ at the start of slip in a direction, signed as r.
    pub(super) fn start_coefficient(&self, law: &dyn LawObject, side: Direction) -> f64 {
        let slip = Slip {
            speed: 0.0,
            direction: side.sign(),
            piece: 0,
        };
        law.coefficient(slip, &|j| self.memory[j])
    }

    /// A contact whose law never sticks goes on through r = 0.
    pub(super) fn pass_through(&mut self, direction: Direction) {
        if let Entry::Arrived(Some(_)) = self.entry {
            self.memory.clone_from(&self.arrival_memory);
        }
        self.phase = Phase::Slip {
            direction,
            speed: 0.0,
            rate: None,
            piece: 0,
        };
    }

    /// Slip begins at r = 0, from stick or on the way through.
    pub(super) fn begin_slip(&mut self, law: &dyn LawObject, side: Direction, rate: Option<f64>) {
        match self.entry {
            Entry::Arrived(Some(_)) => self.memory.clone_from(&self.arrival_memory),
            _ => law.caught(&mut self.memory),
        }
        self.phase = Phase::Slip {
            direction: side,
            speed: 0.0,
            rate,
            piece: 0,
        };
    }
}

impl Edge {
    /// How many coefficients of the distance from the bound are 0.
    pub(super) fn known(self) -> usize {
        match self {
            Self::Away => 0,
            Self::On(_) => 1,
            Self::Touched(_) => 2,
        }
    }

    /// Whether it is at the bound on this side.
    fn is_at(self, side: Direction) -> bool {
        match self {
            Self::On(at) | Self::Touched(at) => at.is_none_or(|at| at == side),
            Self::Away => false,
        }
    }
}

impl Series {
    pub(super) fn new(model: &Model<'_>, time: f64) -> Self {
        let constant = |value: f64| {
            let mut series = PowerSeries::ZERO;
            series[0] = value;
            series
        };
        let contacts = model.contacts.iter().map(|contact| {
            let load = constant(contact.load.value(time) * contact.compliance);
            let count = contact.memory();
            ContactSeries {
                speeds: PowerSeries::ZERO,
                surface: constant(contact.belt_velocity.value(time)),
                carried: PowerSeries::ZERO,
                bound: PowerSeries::ZERO,
                load,
                drive_load: load,
                load_varies: !contact.load.is_constant() || !contact.load_gradient.is_empty(),
                friction: PowerSeries::ZERO,
                slope: 0.0,
                limits: PowerSeries::ZERO,
                memories: vec![PowerSeries::ZERO; count],
                rates: vec![0.0; count],
                relaxation: 0.0,
                tape: Tape::new(),
            }
        });
        let coordinates = (0..model.len()).map(|i| {
            let force = model.acceleration_by(i, |j| model.forces[j].value(time));
            CoordinateSeries::new(constant(force))
        });
        Self {
            coordinates: coordinates.collect(),
            contacts: contacts.collect(),
            rates: vec![0.0; model.len()],
            unheld: vec![0.0; model.len()],
            held: Vec::with_capacity(model.shared.len()),
        }
    }

    /// The velocity of coordinate i over the step.
    pub(super) fn velocities(&self, i: usize) -> PowerSeries {
        self.coordinates[i].course.velocities()
    }
}

impl ContactSeries {
    /// N μ_s ∓ ℓ, with the zeros that are known.
    pub(super) fn distance(&self, edge: Edge, side: Direction) -> PowerSeries {
        let (bound, carried) = (&self.bound, &self.carried);
        let mut distance = PowerSeries::from_fn(|k| bound[k] - side.sign() * carried[k]);
        if edge.is_at(side) {
            for k in 0..edge.known() {
                distance[k] = 0.0;
            }
        }
        distance
    }

    /// The memory stays as it is.
    pub(super) fn hold_memory(&mut self, memory: &[f64]) {
        for (series, memory) in std::iter::zip(&mut self.memories, memory) {
            *series = PowerSeries::ZERO;
            series[0] = *memory;
        }
    }
}
