//! The variational equations along one step: the derivatives of friction by the velocity and the
//! memory of its contact, as power series in time.

use super::coefficient::{Coefficient, product};
use super::elements::ElementDerivatives;
use crate::friction::memory::object::Derivative;
use crate::friction::memory::{Input, Motion, Slip};
use crate::motion::sealed::Part as _;
use crate::motion::{Mode, Segment};
use crate::scalar::mul_add;
use crate::series::{INTEGRAL, PowerSeries, TERMS};
use crate::state::structure::State;
use crate::structure::Step;
use crate::structure::engine::cholesky::Holding;
use crate::structure::engine::contact_data::ContactData;
use crate::structure::engine::model::Model;

/// The coefficients of the variational equations along one step.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Linear {
    /// The derivatives, by the number of the contact.
    pub(super) contacts: Vec<ContactDerivatives>,
    /// The derivatives of force elements.
    pub(super) elements: Vec<ElementDerivatives>,
    /// The coordinates whose own contact sticks.
    pub(super) stuck: Vec<usize>,
    pub(super) holding: Holding,
}

impl Holding {
    /// Projects out the velocities that move a sticking contact: coefficient k of several
    /// perturbations.
    pub(super) fn project<const W: usize, const T: usize>(
        &self,
        model: &Model<'_>,
        velocities: &mut [[[f64; W]; T]],
        k: usize,
    ) {
        let contact = |c: &usize| (&model.contacts[*c], model.contacts[*c].compliance.sqrt());
        let parts = self.contacts.iter().map(contact).map(|(contact, root)| {
            let mut part = [0.0; W];
            for &(j, b) in contact.direction.iter() {
                for (part, velocity) in std::iter::zip(&mut part, velocities[j][k]) {
                    *part += b / root * velocity;
                }
            }
            part
        });
        let mut parts: Vec<_> = parts.collect();
        self.factor.solve_all(&mut parts);
        for ((contact, root), part) in self.contacts.iter().map(contact).zip(parts) {
            for &(j, x) in contact.responses() {
                for (velocity, part) in std::iter::zip(&mut velocities[j][k], part) {
                    *velocity -= x * root * part;
                }
            }
        }
    }
}

/// The derivatives at one contact.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ContactDerivatives {
    /// True if anything depends on r.
    pub(super) takes_slip: bool,
    /// True if its normal spring acts.
    pub(super) reacts: bool,
    /// ∂(Nμ)/∂r, then ∂(Nμ)/∂z_j, multiplied by G_cc; none unless it slips.
    pub(super) friction: Vec<Coefficient>,
    /// μ multiplied by G_cc; none unless it slips under a load that follows displacements.
    pub(super) by_load: Option<Coefficient>,
    /// ∂z_j'/∂r, then ∂z_j'/∂z_l: a row for each j.
    pub(super) rates: Vec<Vec<Coefficient>>,
    /// ∂z_j'/∂N; none under a load that does not follow displacements.
    pub(super) rates_by_load: Vec<Coefficient>,
    /// True for each memory variable z_j on which the law depends in this mode.
    pub(super) depends: Vec<bool>,
}

impl ContactDerivatives {
    /// Returns true if perturbations change the friction force.
    pub(super) fn acts(&self) -> bool {
        !self.friction.is_empty() || self.by_load.is_some()
    }

    fn is_constant(&self) -> bool {
        let own = self.friction.iter().chain(&self.by_load);
        let rates = self.rates.iter().flatten().chain(&self.rates_by_load);
        own.chain(rates).all(Coefficient::is_constant)
    }

    /// Returns true if perturbations of the load change anything.
    pub(super) fn takes_load(&self) -> bool {
        self.reacts || self.by_load.is_some() || !self.rates_by_load.is_empty()
    }
}

impl Linear {
    /// The coefficients along a step of positive length.
    pub(super) fn of(model: &Model<'_>, step: &Step) -> Self {
        let sticks = |c: usize| step.modes()[c] == Mode::Stick;
        let is_held = |i: &usize| model.owner[*i].is_some_and(sticks);
        let without = Self {
            contacts: Vec::new(),
            elements: Vec::new(),
            stuck: (0..model.len()).filter(is_held).collect(),
            holding: model.holding(&sticks),
        };
        without.along(model, step)
    }

    /// The coefficients as series about a later time of the step. Their own series may converge
    /// over less than the step, and do not give them there.
    pub(super) fn later(&self, model: &Model<'_>, step: &Step, since: f64) -> Self {
        let rest = step.clone().from(since);
        self.clone().along(model, &rest)
    }

    fn along(self, model: &Model<'_>, step: &Step) -> Self {
        let contacts = model.contacts.iter().enumerate();
        let contacts = contacts.map(|(number, contact)| {
            let variables = &contact.memory;
            let variables = model.len() + variables.start..model.len() + variables.end;
            let along = ContactAlong {
                number,
                contact,
                step,
                memories: step.series().get(variables).unwrap_or(&[]),
                model,
            };
            along.joint(step.modes()[number])
        });
        let elements = 0..model.elements.len();
        Self {
            contacts: contacts.collect(),
            elements: elements
                .map(|e| ElementDerivatives::of(model, e, step))
                .collect(),
            ..self
        }
    }

    pub(super) fn is_constant(&self) -> bool {
        self.contacts.iter().all(ContactDerivatives::is_constant)
            && self.elements.iter().all(ElementDerivatives::is_constant)
    }
}

/// A contact along a step.
struct ContactAlong<'a> {
    number: usize,
    contact: &'a ContactData<'a>,
    step: &'a Step,
    memories: &'a [PowerSeries],
    model: &'a Model<'a>,
}

impl ContactAlong<'_> {
    fn joint(self, mode: Mode) -> ContactDerivatives {
        let count = self.contact.memory.len();
        let mut joint = ContactDerivatives {
            takes_slip: false,
            reacts: mode != Mode::Open && !self.contact.reaction.is_empty(),
            friction: Vec::new(),
            by_load: None,
            rates: vec![Vec::new(); count],
            rates_by_load: Vec::new(),
            depends: vec![false; count],
        };
        match mode {
            Mode::Open if self.contact.law.changes_while_open() => self.slip(&mut joint, mode),
            Mode::Open => {}
            _ if self.contact.is_elastic() => self.elastic(&mut joint, mode),
            Mode::Stick => self.stick(&mut joint),
            Mode::Slip(_) => self.slip(&mut joint, mode),
        }
        let is_given = |row: &Vec<Coefficient>| row.first().is_some_and(|first| first.terms > 0);
        joint.takes_slip = is_given(&joint.friction) || joint.rates.iter().any(is_given);
        joint
    }

    /// δT' = k_t δr with the force δT in stick; in slip the force σμ n·δq, to which
    /// `TangentFlow::limit_elastic` sets δT.
    fn elastic(&self, joint: &mut ContactDerivatives, mode: Mode) {
        let constant = |value: f64| Coefficient::from(PowerSeries::of(value));
        match mode {
            Mode::Slip(side) => {
                let coefficient = side.sign() * self.contact.constant_coefficient();
                joint.by_load = Some(constant(coefficient));
            }
            Mode::Stick | Mode::Open => {
                let stiffness = self.contact.tangential_stiffness.unwrap_or(0.0);
                joint.friction = vec![constant(0.0), constant(1.0)];
                joint.rates = vec![vec![constant(stiffness), constant(0.0)]];
                joint.depends = vec![true];
            }
        }
    }

    /// The derivative by one input; the derivatives of the rates are stored.
    fn derivative(
        &self,
        joint: &mut ContactDerivatives,
        (motion, load): (Motion<&PowerSeries>, &PowerSeries),
        by: Input,
    ) -> Derivative {
        let derivative = self.contact.law.derivative(motion, load, self.memories, by);
        if let Input::Memory(j) = by {
            joint.depends[j] |= derivative.depends;
        }
        let rates = derivative.rates.iter().map(|rate| Coefficient::from(*rate));
        if by == Input::Load {
            joint.rates_by_load = rates.collect();
        } else {
            for (row, rate) in std::iter::zip(&mut joint.rates, rates) {
                row.push(rate);
            }
        }
        derivative
    }

    /// The derivatives of the rates of the memory by the load, if it follows displacements.
    fn by_load(
        &self,
        joint: &mut ContactDerivatives,
        (motion, load): (Motion<&PowerSeries>, &PowerSeries),
    ) {
        if joint.rates.is_empty() || !self.contact.load_follows() {
            return;
        }
        if !self.derivative(joint, (motion, load), Input::Load).depends {
            joint.rates_by_load.clear();
        }
    }

    fn stick(&self, joint: &mut ContactDerivatives) {
        for row in &mut joint.rates {
            row.push(PowerSeries::ZERO.into());
        }
        if joint.rates.is_empty() {
            return;
        }
        let load = self.load(self.step.state());
        let motion = (Motion::Stick, &load);
        for j in 0..joint.rates.len() {
            self.derivative(joint, motion, Input::Memory(j));
        }
        self.by_load(joint, motion);
    }

    /// In slip, and for a memory that changes while the contact is open: then without a load.
    fn slip(&self, joint: &mut ContactDerivatives, mode: Mode) {
        let (step, contact) = (self.step, self.contact);
        let Some(relative) = step.relative_velocity(self.number) else {
            return;
        };
        let middle = relative.at(0.5 * step.duration());
        let (direction, load) = match mode {
            Mode::Slip(side) => (side.sign(), self.load(step.state())),
            _ => (1_f64.copysign(middle), PowerSeries::ZERO),
        };
        let speeds = relative.scaled(direction);
        let motion = Motion::Slip(Slip {
            speed: &speeds,
            direction,
            piece: contact.piece_above(direction * middle),
        });
        let given = (motion, &load);
        let load = load.scaled(contact.compliance);
        let by_speed = self.derivative(joint, given, Input::Speed);
        joint.friction.push(product(&load, &by_speed.slope).into());
        let follows = mode != Mode::Open && contact.load_follows();
        if follows {
            joint.by_load = Some(by_speed.coefficient.scaled(contact.compliance).into());
        }
        for j in 0..joint.rates.len() {
            let by_memory = self.derivative(joint, given, Input::Memory(j));
            joint.friction.push(product(&load, &by_memory.slope).into());
        }
        if follows {
            self.by_load(joint, given);
        }
    }

    /// The series of N.
    fn load(&self, start: &State) -> PowerSeries {
        let mut load = self.contact.load.series(self.step.clock());
        for &(j, gradient) in &self.contact.load_gradient {
            load[0] += gradient * start.displacements[j];
            let velocity = &self.step.series()[j];
            for k in 1..TERMS {
                load[k] = mul_add(gradient, velocity[k - 1] * INTEGRAL[k - 1], load[k]);
            }
        }
        for law in self.contact.load_laws.clone() {
            load.add(
                1.0,
                &ElementDerivatives::forces(self.model, law, self.step)[0],
            );
        }
        load
    }
}

/// The load N of a contact at the end of a step, and its rate.
pub(super) fn load_at_end(model: &Model<'_>, c: usize, step: &Step) -> [f64; 2] {
    let (contact, h) = (&model.contacts[c], step.duration());
    let (given, state) = (contact.load.series(step.clock()), step.end_state());
    let mut load = [
        given.at(h) + contact.displacement_load(|j| state.displacements[j]),
        given.slope_at(h) + contact.displacement_load(|j| state.velocities[j]),
    ];
    for law in contact.load_laws.clone() {
        let force = ElementDerivatives::forces(model, law, step)[0];
        load[0] += force.at(h);
        load[1] += force.slope_at(h);
    }
    load
}
