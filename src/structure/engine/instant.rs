//! Forces and accelerations at any time within a step, from its series and its modes.

use super::cholesky::Holding;
use super::contact_data::{ContactData, Site};
use super::limits::limit_force;
use super::model::Model;
use super::redundant_contacts::Resting;
use crate::clock::Clock;
use crate::drive::Drive;
use crate::friction::memory::Slip;
use crate::motion::sealed::Part as _;
use crate::motion::{Mode, Segment};
use crate::state::Direction;
use crate::state::structure::State;
use crate::structure::Step;

/// Forces during a step of positive length.
pub(crate) struct Forces<'a, 's> {
    model: &'a Model<'s>,
    step: &'a Step,
    resting: Resting,
}

/// Forces and accelerations at one time.
#[derive(Debug, Clone)]
pub(crate) struct Instant {
    pub(crate) state: State,
    /// v' of each coordinate.
    pub(crate) accelerations: Vec<f64>,
    /// f of each coordinate.
    pub(crate) forces: Vec<f64>,
    /// Force elements, then stops.
    pub(crate) elements: Vec<AtElement>,
    pub(crate) contacts: Vec<AtContact>,
}

/// The force of a force element or a stop.
#[derive(Debug, Clone)]
pub(crate) struct AtElement {
    /// D and D'.
    pub(crate) factor: [f64; 2],
    /// F_i.
    pub(crate) forces: Vec<f64>,
}

/// Forces at one contact: 0 while it is open, except for velocities.
#[derive(Debug, Clone, Default)]
pub(crate) struct AtContact {
    /// N.
    pub(crate) load: f64,
    /// λ, or T of an elastic contact.
    pub(crate) carried: f64,
    /// b·v and w.
    pub(crate) velocity: f64,
    pub(crate) surface: f64,
    /// r, with all its digits where the contact creeps.
    pub(crate) relative: f64,
    /// w'.
    pub(crate) surface_rate: f64,
    /// The parts of the load that have laws.
    laws: Vec<AtElement>,
}

impl AtElement {
    /// D F_i.
    pub(crate) fn scaled(&self) -> Vec<f64> {
        self.forces
            .iter()
            .map(|force| self.factor[0] * force)
            .collect()
    }
}

impl<'a, 's> Forces<'a, 's> {
    pub(crate) fn of(model: &'a Model<'s>, step: &'a Step) -> Self {
        let shared = model.shared.iter().copied();
        let sticks = shared.filter(|&c| step.modes()[c] == Mode::Stick);
        Self {
            resting: model.resting(sticks.collect()),
            model,
            step,
        }
    }

    /// Forces at a time t after the start of the step.
    pub(crate) fn at(&self, t: f64) -> Instant {
        let clock = self.step.clock().after(t);
        self.with(self.step.state_at(t), &|drive| drive.at(clock))
    }

    /// Forces at a time of the step.
    pub(crate) fn at_time(&self, time: f64) -> Instant {
        let state = self.step.state_at_time(time);
        self.with(state, &|drive| drive.at(Clock::at(time)))
    }

    /// Forces at a time t after the start of the step with the drives of this step, which may jump
    /// at its end.
    pub(crate) fn before(&self, t: f64) -> Instant {
        self.beside(t, self.step.state_at(t))
    }

    /// [`before`](Self::before) in another state.
    pub(crate) fn beside(&self, t: f64, state: State) -> Instant {
        let clock = self.step.clock();
        self.with(state, &|drive| {
            let series = drive.series(clock);
            [series.at(t), series.slope_at(t)]
        })
    }

    /// Forces in a state, with value and slope of each drive.
    fn with(&self, state: State, drive: &dyn Fn(&Drive) -> [f64; 2]) -> Instant {
        let (model, step) = (self.model, self.step);
        let (q, v) = (&state.displacements, &state.velocities);
        let forces = model.forces.iter().map(|force| drive(force)[0]);
        let forces: Vec<f64> = forces.collect();
        let coordinates = 0..model.len();
        let free = coordinates.map(|i| {
            let driven = model.acceleration_by(i, |j| forces[j]);
            driven + model.restoring(i, [q[i], v[i]], |j| q[j], |j| v[j])
        });
        let mut accelerations: Vec<f64> = free.collect();
        let states = std::iter::zip(&model.first_order, 0..);
        for (data, number) in states {
            let value = model.position(&state, model.len() + number);
            for &(j, x) in &data.responses {
                accelerations[j] += x * value;
            }
        }
        let stops = model.force_elements().len();
        let elements = model.forces_and_stops().enumerate().map(|(e, element)| {
            let factor = drive(&element.factor);
            let piece = e.checked_sub(stops).map(|stop| step.stops()[stop]);
            let forces = element.forces(&|j| q[j], &|j| v[j], piece);
            for (force, response) in std::iter::zip(&forces, &element.responses) {
                for &(j, x) in response {
                    accelerations[j] -= x * (factor[0] * force);
                }
            }
            AtElement { factor, forces }
        });
        let elements: Vec<AtElement> = elements.collect();
        let numbers = model.contacts.iter().enumerate();
        let mut contacts: Vec<AtContact> = numbers
            .map(|(c, contact)| {
                let memory = &state.memory[model.memory(c)];
                let [surface, surface_rate] = drive(&contact.belt_velocity);
                let velocity = contact.along(|j| v[j]);
                let own = state.sliding().iter().find(|(number, _)| *number == c);
                let mut at = AtContact {
                    velocity,
                    surface,
                    relative: own.map_or(velocity - surface, |(_, relative)| *relative),
                    surface_rate,
                    ..AtContact::default()
                };
                let mode = step.modes()[c];
                if mode != Mode::Open {
                    at.load = drive(&contact.load)[0] + contact.displacement_load(|j| q[j]);
                    let laws = model.load_laws(c).iter().map(|law| AtElement {
                        factor: drive(&law.factor),
                        forces: law.forces(&|j| q[j], &|j| v[j], None),
                    });
                    at.laws = laws.collect();
                    for law in &at.laws {
                        at.load += law.factor[0] * law.forces[0];
                    }
                    at.carried = known(contact, &at, mode, memory);
                }
                at
            })
            .collect();
        for (contact, at) in std::iter::zip(&model.contacts, &contacts) {
            let push = contact.compliance * at.carried;
            let responses = contact.responses().iter().map(|&(j, x)| (j, x * push));
            let reaction = contact.reaction.iter().map(|&(j, y)| (j, y * at.load));
            for (j, change) in responses.chain(reaction) {
                accelerations[j] -= change;
            }
        }
        self.hold(&mut accelerations, &mut contacts);
        self.share(&state, &mut contacts);
        Instant {
            state,
            accelerations,
            forces,
            elements,
            contacts,
        }
    }

    /// Adds the forces of rigid contacts in stick, which keep r' at 0.
    fn hold(&self, accelerations: &mut [f64], contacts: &mut [AtContact]) {
        let model = self.model;
        for (c, contact) in model.contacts.iter().enumerate() {
            if let (Site::Own(i), Mode::Stick) = (&contact.site, self.step.modes()[c]) {
                let rate = contacts[c].surface_rate;
                contacts[c].carried = (accelerations[*i] - rate) / contact.compliance;
                accelerations[*i] = rate;
            }
        }
        let Holding {
            contacts: sticking,
            factor,
        } = &self.resting.holding;
        let root = |c: usize| model.contacts[c].compliance.sqrt();
        let apart = |c: usize| {
            let along = model.contacts[c].along(|j| accelerations[j]);
            (along - contacts[c].surface_rate) / root(c)
        };
        let mut parts: Vec<f64> = sticking.iter().map(|&c| apart(c)).collect();
        factor.solve(&mut parts);
        for (&c, part) in std::iter::zip(sticking, parts) {
            contacts[c].carried = part / root(c);
            for &(j, x) in model.contacts[c].responses() {
                accelerations[j] -= x * (part * root(c));
            }
        }
    }

    /// Shares the forces that contacts with dependent directions carry together.
    fn share(&self, state: &State, contacts: &mut [AtContact]) {
        let root = |c: usize| self.model.contacts[c].compliance.sqrt();
        let bounds = |c: usize| {
            let memory = &state.memory[self.model.memory(c)];
            let limits = self.model.contacts[c].law.limits(&|j| memory[j]);
            let load = contacts[c].load.max(0.0);
            let bounds = limits.unwrap_or([0.0; 2]);
            bounds.map(|limit| limit_force(load, limit) * root(c))
        };
        let force = |c: usize| contacts[c].carried * root(c);
        for (c, share) in self.resting.shares(force, bounds) {
            contacts[c].carried = share / root(c);
        }
    }
}

/// The force of a contact that is open, elastic or slips; 0 where a rigid one sticks.
fn known(contact: &ContactData<'_>, at: &AtContact, mode: Mode, memory: &[f64]) -> f64 {
    match mode {
        _ if contact.tangential_stiffness.is_some() => memory[0],
        Mode::Open | Mode::Stick => 0.0,
        Mode::Slip(side) => at.load * friction(contact, side, at.relative, &|j| memory[j]),
    }
}

/// μ of a rigid contact that slips in a direction.
fn friction(
    contact: &ContactData<'_>,
    side: Direction,
    relative: f64,
    memory: &dyn Fn(usize) -> f64,
) -> f64 {
    let direction = side.sign();
    let speed = (direction * relative).max(0.0);
    let slip = Slip {
        speed,
        direction,
        piece: contact.piece_above(speed),
    };
    contact.law.coefficient(slip, memory)
}

impl Instant {
    /// N' of a closed contact.
    pub(crate) fn load_rate(&self, model: &Model<'_>, c: usize, time: Clock) -> f64 {
        let (q, v) = (&self.state.displacements, &self.state.velocities);
        let contact = &model.contacts[c];
        let linear = contact.load.at(time)[1] + contact.displacement_load(|j| v[j]);
        let laws = std::iter::zip(model.load_laws(c), &self.contacts[c].laws);
        laws.fold(linear, |sum, (law, at)| {
            let tangent = law.tangent(q, v);
            let [factor, change] = at.factor;
            let rates = [v, &self.accelerations].map(|x| law.along(&|j| x[j])[0]);
            let parts = std::iter::zip(&tangent.slopes, rates);
            let change = change * at.forces[0];
            sum + change + factor * parts.map(|(slope, rate)| slope[0] * rate).sum::<f64>()
        })
    }
}
