//! The situation: data that change at events.

use super::cholesky::{Holding, Pivot};
use super::contact_data::ContactData;
use super::element_events::ElementState;
use super::limits::larger_finite;
use super::model::Model;
use super::redundant_contacts::Mechanism;
use super::series::Series;
use super::stick_band_edge::Edge;
use crate::clock::Clock;
use crate::error::{Error, Reached};
use crate::friction::memory::Slip;
use crate::friction::memory::object::LawObject;
use crate::motion::Mode;
use crate::scalar::mul_add;
use crate::state::Direction;
use crate::state::structure::State;

/// The coordinates and contacts at the start of a step.
#[derive(Debug, Clone)]
pub(super) struct Situation {
    pub(super) clock: Clock,
    pub(super) coordinates: Vec<Coordinate>,
    pub(super) contacts: Vec<ContactState>,
    pub(super) elements: Vec<ElementState>,
    /// The first-order states.
    pub(super) states: Vec<f64>,
    /// The shared contacts that stick, in the order of [`Model::shared`], and what holds them.
    pub(super) holding: Holding,
    /// The mechanisms of those that stick without a force of their own.
    pub(super) mechanisms: Vec<Mechanism>,
    /// The contacts that these guide.
    pub(super) guided: Vec<Guided>,
    /// The shared contacts that are closed; `None` if they are not known.
    pub(super) closed: Option<Closed>,
}

/// A contact whose slip or load depends on contacts that stick: the parts α in x = Σ α_c b_c of its
/// direction b, and of the gradient n of its load, where there are some. Its relative velocity, and
/// the rate of its load, are then those of the surfaces. Elastic contacts, and the slip of those
/// that never stick and are at rest: with the rounding of the forces that hold them, their sliders
/// would start and stop, and their velocities cross 0, again and again.
#[derive(Debug, Clone)]
pub(super) struct Guided {
    pub(super) contact: usize,
    pub(super) slip: Option<Vec<(usize, f64)>>,
    pub(super) load: Option<Vec<(usize, f64)>>,
}

/// The shared contacts that are closed.
#[derive(Debug, Clone)]
pub(super) struct Closed {
    /// The factor of these contacts; those that do not stick have a small compliance.
    pub(super) holding: Holding,
    /// A coordinate for each independent contact at rest: see [`Model::pivots`].
    pub(super) pivots: Vec<Pivot>,
    /// Contacts at rest without a coordinate, because they depend, exactly or nearly, on the
    /// contacts that have one.
    pub(super) left_out: Vec<usize>,
}

/// Displacement and velocity of a coordinate. If the coordinate has its own closed contact, its
/// velocity follows from the contact: see [`Situation::velocity`].
#[derive(Debug, Clone)]
pub(super) struct Coordinate {
    pub(super) displacement: f64,
    pub(super) velocity: f64,
}

/// One contact.
#[derive(Debug, Clone)]
pub(super) struct ContactState {
    pub(super) phase: Phase,
    /// The edge of the stick band; after a release, the edge from which the contact was released.
    pub(super) edge: Edge,
    /// The edge of the normal load.
    pub(super) load_edge: Edge,
    pub(super) entry: Entry,
    pub(super) memory: Vec<f64>,
    /// The memory when slip reached r = 0.
    pub(super) arrival_memory: Vec<f64>,
    /// μ_s at the start of the step, backward and forward; `None` for a law that never sticks.
    pub(super) limits: Option<[f64; 2]>,
    /// True if it sticks in a group of contacts with dependent directions: mechanisms decide when
    /// it slips, not its own force.
    pub(super) is_in_group: bool,
    /// True if the force of an elastic contact exceeded its limit after a jump of the load.
    pub(super) was_cut: bool,
    /// True if the contact is open and its memory still changes: it slips without a load.
    pub(super) is_lifted: bool,
}

/// The phase of a contact, with its data.
#[derive(Debug, Clone, Copy)]
pub(super) enum Phase {
    /// No load, no friction, and a memory that does not change.
    Open,
    /// r = 0 since a time, from a displacement b·q.
    Stick { since: Clock, from: f64 },
    /// r = σy.
    Slip {
        direction: Direction,
        /// y ≥ 0, the integrated variable. Its zeros are exact at any speed of the surface.
        speed: f64,
        /// dy/dt at the start of the step, if it is known more accurately than from the equation of
        /// motion: where slip begins.
        rate: Option<f64>,
        /// The piece of the law that holds.
        piece: usize,
    },
}

/// The origin of the phase of a contact at the start of a step.
#[derive(Debug, Clone, Copy)]
pub(super) enum Entry {
    /// The phase is that of the step before.
    Held,
    /// The contact has reached r = 0, from slip in a direction or by closing. If its force is
    /// within rounding of the edge of its band, it counts as on the edge.
    Arrived(Option<Direction>),
    /// The contact is on a breakpoint of its law, and the piece is decided.
    OnBreakpoint,
}

/// The reason why a contact ends a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Firing {
    /// The sliding speed is 0.
    Arrival,
    /// The sliding speed is at a breakpoint of the law, of this number, and rising or not.
    Breakpoint(usize, bool),
    /// The force has reached its limit in this direction.
    Bound(Direction),
    /// The normal load is 0.
    Load,
}

/// The disturbance at the end of a step, or at the start of the motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Disturbance {
    None,
    /// An event of a contact: all forces that do not depend on modes are continuous.
    Event,
    /// The motion starts, or pieces of a drive meet: forces may jump.
    Jump,
}

impl Situation {
    /// The situation at a start, with modes that are not yet decided.
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
                limits: contact.law.limits(&|j| memory[j]),
                is_in_group: false,
                was_cut: false,
                is_lifted: false,
                arrival_memory: memory.clone(),
                memory,
            }
        });
        let elements = model.elements.iter().map(|element| {
            // The velocity of a first-order state counts as 0.
            let velocity = |j: usize| start.velocities.get(j).copied().unwrap_or(0.0);
            ElementState::at(element, clock.time, |j| model.position(start, j), velocity)
        });
        let states = 0..model.first_order.len();
        let states = states.map(|state| model.position(start, model.len() + state));
        Self {
            clock,
            coordinates: coordinates.collect(),
            contacts: contacts.collect(),
            elements: elements.collect(),
            states: states.collect(),
            holding: Holding::default(),
            mechanisms: Vec::new(),
            guided: Vec::new(),
            closed: None,
        }
    }

    /// v_i; it is w + σy if the coordinate has its own contact.
    #[inline]
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

    /// Mean of a velocity over [0, t]; of w + σy by its parts.
    pub(super) fn mean_velocity(
        &self,
        model: &Model<'_>,
        series: &Series,
        i: usize,
        t: f64,
    ) -> f64 {
        let owner = model.owner[i].map(|c| (self.contacts[c].phase, &series.contacts[c]));
        let Some((phase @ (Phase::Stick { .. } | Phase::Slip { .. }), of)) = owner else {
            return series.velocities(i).mean(t);
        };
        let surface = if model.is_driven[i] {
            of.surface.mean(t)
        } else {
            of.surface[0]
        };
        match phase {
            Phase::Slip { direction, .. } => mul_add(direction.sign(), of.speeds.mean(t), surface),
            _ => surface,
        }
    }

    /// b·q.
    pub(super) fn displacement_along(&self, contact: &ContactData<'_>) -> f64 {
        contact.along(|j| self.coordinates[j].displacement)
    }

    /// The contacts whose relative velocities are numbers of a state, with these.
    pub(super) fn sliding(&self, model: &Model<'_>) -> impl Iterator<Item = (usize, f64)> {
        model
            .creeping
            .iter()
            .filter(|&&c| !self.contacts[c].phase_is_open())
            // Never −0. In stick until it is decided to which side it slips.
            .map(|&c| (c, self.contacts[c].relative() + 0.0))
    }

    /// The state, with the memory of the contacts and the first-order states.
    pub(super) fn state(&self, model: &Model<'_>, series: &Series) -> State {
        let mut memory = Vec::with_capacity(model.remembered());
        if model.remembered() > 0 {
            memory.extend(self.contacts.iter().flat_map(|contact| &contact.memory));
            memory.extend(&self.states);
        }
        let velocities = 0..self.coordinates.len();
        let displacements = self.coordinates.iter().map(|q| q.displacement);
        let velocities = velocities.map(|i| self.velocity(model, series, i));
        let parts = [displacements.collect(), velocities.collect(), memory];
        State::of_parts(parts).sliding_at(self.sliding(model))
    }

    /// Adds all numbers of the state to a list: see [`state`](Self::state).
    pub(super) fn add_to(&self, list: &mut Vec<f64>, model: &Model<'_>, series: &Series) {
        list.extend(self.coordinates.iter().map(|q| q.displacement));
        let velocities = 0..self.coordinates.len();
        list.extend(velocities.map(|i| self.velocity(model, series, i)));
        if model.remembered() > 0 {
            list.extend(self.contacts.iter().flat_map(|contact| &contact.memory));
            list.extend(&self.states);
        }
        list.extend(self.sliding(model).map(|(_, r)| r));
    }

    /// Returns true if these are the modes of all contacts, and the pieces of all stops.
    pub(super) fn is_in(&self, modes: &[Mode], stops: &[usize]) -> bool {
        let mut modes = std::iter::zip(&self.contacts, modes);
        let mut pieces = std::iter::zip(self.stops(stops.len()), stops);
        modes.all(|(contact, mode)| contact.mode() == *mode)
            && pieces.all(|(stop, piece)| stop.piece == *piece)
    }

    /// The stops, which are so many.
    pub(super) fn stops(&self, count: usize) -> &[ElementState] {
        &self.elements[self.elements.len() - count..]
    }

    /// The error if the modes of contacts cannot be decided.
    pub(super) fn undecided(&self, model: &Model<'_>, series: &Series) -> Error {
        let (step, reached) = (0.0, self.reached(model, series));
        Error::StepUnderflow { step, reached }
    }

    pub(super) fn reached(&self, model: &Model<'_>, series: &Series) -> Reached {
        Reached::new(self.clock.time, self.state(model, series))
    }
}

impl ContactState {
    pub(super) fn mode(&self) -> Mode {
        match self.phase {
            _ if self.is_lifted => Mode::Open,
            Phase::Open => Mode::Open,
            Phase::Stick { .. } => Mode::Stick,
            Phase::Slip { direction, .. } => Mode::Slip(direction),
        }
    }

    /// μ_s under the present memory; `None` where it cannot stick.
    pub(super) fn limits_by(&self, law: &dyn LawObject) -> Option<[f64; 2]> {
        if self.is_lifted {
            return None;
        }
        law.limits(&|j| self.memory[j])
    }

    pub(super) fn sticks(&self) -> bool {
        matches!(self.phase, Phase::Stick { .. })
    }

    /// Returns true if r = 0: in stick, or at an instant at which slip begins or changes its
    /// direction.
    pub(super) fn rests(&self) -> bool {
        match self.phase {
            Phase::Stick { .. } => true,
            Phase::Slip { speed, .. } => speed == 0.0,
            Phase::Open => false,
        }
    }

    pub(super) fn phase_is_open(&self) -> bool {
        matches!(self.phase, Phase::Open)
    }

    /// The argument of its law in slip, with another speed.
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

    /// The sliding speed at the start of the step; 0 unless the contact slips.
    pub(super) fn speed(&self) -> f64 {
        match self.phase {
            Phase::Slip { speed, .. } => speed,
            Phase::Open | Phase::Stick { .. } => 0.0,
        }
    }

    /// r at the start of the step; 0 unless the contact slips.
    pub(super) fn relative(&self) -> f64 {
        match self.phase {
            Phase::Slip {
                direction, speed, ..
            } => direction.sign() * speed,
            Phase::Open | Phase::Stick { .. } => 0.0,
        }
    }

    /// The larger finite μ_s at the start of the step, 0 for a law that never sticks.
    pub(super) fn static_coefficient(&self) -> f64 {
        self.limits.map_or(0.0, larger_finite)
    }

    pub(super) fn has_arrived(&self) -> bool {
        matches!(self.entry, Entry::Arrived(_))
    }

    /// Sets the memory with which slip begins: as it was when the contact came to r = 0, or what
    /// the law makes of that of stick.
    fn remember_for_slip(&mut self, law: &dyn LawObject) {
        match self.entry {
            _ if self.limits.is_none() => {}
            Entry::Arrived(Some(_)) => self.memory.clone_from(&self.arrival_memory),
            _ => law.caught(&mut self.memory),
        }
    }

    /// μ at r = 0 in a direction with the present memory, signed as r.
    pub(super) fn coefficient_at_rest(&self, law: &dyn LawObject, side: Direction) -> f64 {
        let slip = Slip {
            speed: 0.0,
            direction: side.sign(),
            piece: 0,
        };
        law.coefficient(slip, &|j| self.memory[j])
    }

    /// μ at the start of slip in a direction, signed as r.
    pub(super) fn start_coefficient(&self, law: &dyn LawObject, side: Direction) -> f64 {
        let mut slipping = self.clone();
        slipping.remember_for_slip(law);
        slipping.coefficient_at_rest(law, side)
    }

    /// A contact that never sticks passes through r = 0.
    pub(super) fn pass_through(&mut self, direction: Direction) {
        self.phase = Phase::Slip {
            direction,
            speed: 0.0,
            rate: None,
            piece: 0,
        };
    }

    /// Slip begins at r = 0, from stick or on the way through, at a rate that may depend on μ
    /// there.
    pub(super) fn begin_slip(
        &mut self,
        law: &dyn LawObject,
        side: Direction,
        rate: impl FnOnce(f64) -> f64,
    ) {
        self.remember_for_slip(law);
        let coefficient = self.coefficient_at_rest(law, side);
        self.phase = Phase::Slip {
            direction: side,
            speed: 0.0,
            rate: Some(rate(coefficient)),
            piece: 0,
        };
    }
}
