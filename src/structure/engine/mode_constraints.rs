//! The modes of all contacts, and the numbers of a state that they determine.
//!
//! Within a step the velocities and memory variables are polynomials of their own, so at most times
//! their values satisfy the conditions of stick and of sliders up to rounding errors only. A state
//! has these numbers from the conditions themselves: it is then a start in the same modes.

use std::sync::Arc;

use super::cholesky::Pivot;
use super::contact_data::{ContactData, Kinematics, load_at};
use super::model::Model;
use super::state::{ContactState, Situation};
use crate::clock::Clock;
use crate::drive::Drive;
use crate::motion::Mode;
use crate::series::PowerSeries;
use crate::state::Direction;
use crate::state::structure::State;

/// The modes of all contacts in a step; shared by steps in the same modes.
#[derive(Debug, Clone, Default)]
pub(crate) struct Modes {
    pub(crate) modes: Box<[Mode]>,
    /// The piece of the law of each stop.
    pub(crate) stops: Box<[usize]>,
    /// Coordinates with their own contact, which sticks to a surface of varying velocity.
    carried: Vec<(usize, Arc<Drive>)>,
    /// Other velocities that follow from contacts in stick, in this order.
    held: Vec<Pivot>,
    /// The contacts whose relative velocities are numbers of a state.
    pub(crate) sliding: Vec<usize>,
    kinematics: Arc<[Kinematics]>,
    limits: Vec<Limit>,
}

/// The limit μN of the force of an elastic contact.
#[derive(Debug, Clone)]
struct Limit {
    /// The place of the force among the memory variables.
    place: usize,
    /// The direction in which the slider moves, if it does.
    side: Option<Direction>,
    coefficient: f64,
    load: Arc<Drive>,
    gradient: Vec<(usize, f64)>,
}

/// The two values of a drive at a jump.
#[derive(Debug, Clone, Copy)]
pub(super) enum At {
    Before,
    After,
}

impl Modes {
    /// The modes of a situation.
    pub(super) fn of(model: &Model<'_>, situation: &Situation) -> Self {
        let modes = situation.contacts.iter().map(ContactState::mode);
        let stops = situation.elements[model.first_stop()..].iter();
        let mut all = Self {
            modes: modes.collect(),
            sliding: situation.sliding(model).map(|(c, _)| c).collect(),
            kinematics: Arc::clone(&model.kinematics),
            stops: stops.map(|stop| stop.piece).collect(),
            ..Self::default()
        };
        for (c, contact) in model.contacts.iter().enumerate() {
            match (model.owner_of(c), all.modes[c]) {
                _ if contact.is_elastic() => all.limits.extend(Limit::of(contact, all.modes[c])),
                // A polynomial that is constant has no rounding errors.
                (Some(i), Mode::Stick) if !contact.belt_velocity.is_constant() => {
                    all.carried.push((i, Arc::clone(&contact.belt_velocity)));
                }
                _ => {}
            }
        }
        let holding = &situation.holding.contacts;
        if !holding.is_empty() {
            all.held = model.pivots(holding);
        }
        all
    }

    /// The state of so many coordinates with these numbers.
    pub(crate) fn state(&self, coordinates: usize, numbers: &[f64]) -> State {
        let count = numbers.len().saturating_sub(self.sliding.len());
        let (others, sliding) = numbers.split_at(count);
        let sliding = std::iter::zip(self.sliding.iter().copied(), sliding.iter().copied());
        State::of_numbers(coordinates, others).sliding_at(sliding)
    }

    /// The relative velocity of a contact in a state of these modes at a time; NaN if there is no
    /// such contact.
    pub(crate) fn relative_velocity(&self, contact: usize, time: f64, state: &State) -> f64 {
        let (Some(mode), Some(of)) = (self.modes.get(contact), self.kinematics.get(contact)) else {
            return f64::NAN;
        };
        if *mode == Mode::Stick && !of.is_elastic {
            return 0.0;
        }
        match state.sliding().iter().find(|&&(c, _)| c == contact) {
            Some(&(_, relative_velocity)) => relative_velocity,
            None => {
                let along = of.direction.iter().map(|&(j, b)| b * state.velocities[j]);
                along.sum::<f64>() - of.belt_velocity.value(time)
            }
        }
    }

    /// The series of the relative velocity of a contact in a step, from its start and the series of
    /// all velocities and of the relative velocities that are numbers of a state; `None` if there
    /// is no such contact.
    pub(crate) fn relative_series(
        &self,
        contact: usize,
        start: Clock,
        [velocities, sliding]: [&[PowerSeries]; 2],
    ) -> Option<PowerSeries> {
        let (mode, of) = (self.modes.get(contact)?, self.kinematics.get(contact)?);
        if *mode == Mode::Stick && !of.is_elastic {
            return Some(PowerSeries::ZERO);
        }
        let given = self.sliding.iter().position(|&c| c == contact);
        if let Some(given) = given.and_then(|place| sliding.get(place)) {
            return Some(*given);
        }
        let surface = of.belt_velocity.series(start);
        let along = |k: usize| of.direction.iter().map(move |&(j, b)| b * velocities[j][k]);
        Some(PowerSeries::from_fn(|k| along(k).sum::<f64>() - surface[k]))
    }

    /// Sets the numbers of a state at a time that the modes determine: the velocities of stuck
    /// coordinates, the forces of sliders that move, and within the step the forces of others to
    /// their limits at most. A step that is continued beyond its event passes the limit.
    pub(crate) fn put(
        &self,
        (time, is_within): (f64, bool),
        displacements: &[f64],
        velocities: &mut [f64],
        memory: &mut [f64],
    ) {
        self.carry(time, velocities);
        let surface = |c: usize| self.kinematics[c].belt_velocity.value(time);
        for pivot in &self.held {
            velocities[pivot.coordinate] = pivot.velocity(surface, |j| velocities[j]);
        }
        self.limit((time, is_within), At::Before, displacements, memory);
    }

    /// Sets the numbers that depend on the time, at an end of a step. The engine has set all
    /// others: its clock is finer than the time of a state.
    pub(super) fn put_at_end(&self, time: f64, at: At, coordinates: usize, numbers: &mut [f64]) {
        let (displacements, others) = numbers.split_at_mut(coordinates);
        let (velocities, memory) = others.split_at_mut(coordinates);
        self.carry(time, velocities);
        self.limit((time, true), at, displacements, memory);
    }

    /// Sets the velocities of coordinates with their own contact in stick.
    pub(super) fn carry(&self, time: f64, velocities: &mut [f64]) {
        for (i, surface) in &self.carried {
            velocities[*i] = surface.value(time);
        }
    }

    fn limit(
        &self,
        (time, is_within): (f64, bool),
        at: At,
        displacements: &[f64],
        memory: &mut [f64],
    ) {
        for limit in &self.limits {
            if let Some(carried) = memory.get_mut(limit.place) {
                let most = limit.at(time, at, displacements);
                *carried = match limit.side {
                    None if is_within => carried.clamp(-most, most),
                    None => *carried,
                    Some(side) => side.sign() * most,
                };
            }
        }
    }
}

impl Limit {
    fn of(contact: &ContactData<'_>, mode: Mode) -> Option<Self> {
        let side = match mode {
            Mode::Open => return None,
            Mode::Stick => None,
            Mode::Slip(side) => Some(side),
        };
        Some(Self {
            place: contact.memory.start,
            side,
            coefficient: contact.constant_coefficient(),
            load: Arc::clone(&contact.load),
            gradient: contact.load_gradient.clone(),
        })
    }

    fn at(&self, time: f64, at: At, displacements: &[f64]) -> f64 {
        let given = match at {
            At::Before => self.load.just_before(time),
            At::After => self.load.value(time),
        };
        let load = load_at(given, &self.gradient, |j| displacements[j]);
        (self.coefficient * load).max(0.0)
    }
}
