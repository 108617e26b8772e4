//! The variational equations along one step: the derivatives of friction by the velocity and the
//! memory of its contact, as power series in time.

use crate::friction::memory::object::Derivative;
use crate::friction::memory::{Motion, Slip};
use crate::friction::piece_above;
use crate::motion::{Mode, Segment};
use crate::scalar::jet::Tape;
use crate::scalar::mul_add;
use crate::series::{INTEGRAL, PowerSeries, TERMS};
use crate::state::structure::State;
use crate::structure::Step;
use crate::structure::engine::factor::Holding;
use crate::structure::engine::model::{ContactData, Model};

/// The coefficients of the variational equations along one step.
#[derive(Debug, Clone)]
pub(super) struct Linear {
    /// The derivatives, by the number of the contact.
    pub(super) joints: Vec<Joint>,
    pub(super) holding: Holding,
}

impl Holding {
    /// The holding contacts for these modes. (Contacts that stick together are independent.)
    pub(super) fn of(model: &Model<'_>, modes: &[Mode]) -> Self {
        let shared = model.shared.iter().copied();
        let contacts: Vec<usize> = shared.filter(|&c| modes[c] == Mode::Stick).collect();
        match model.factor(&contacts) {
            Ok(factor) => Self { contacts, factor },
            Err(_) => {
                debug_assert!(false, "contacts that stick together are independent");
                Self::default()
            }
        }
    }

    /// Projects out the velocities that move a sticking contact.
    pub(super) fn project(&self, model: &Model<'_>, velocities: &mut [f64]) {
        let along = |c: usize| model.contacts[c].along(|j| velocities[j]);
        for (j, correction) in model.corrections(self, along) {
            velocities[j] -= correction;
        }
    }
}

/// The derivatives at one contact.
#[derive(Debug, Clone)]
pub(super) struct Joint {
    pub(super) is_stuck: bool,
    /// Whether its normal spring acts.
    pub(super) is_closed: bool,
    /// ∂(Nμ)/∂r, then ∂(Nμ)/∂z_j, multiplied by G_cc; none unless it slips.
    pub(super) friction: Vec<PowerSeries>,
    /// μ multiplied by G_cc, and the gradient of the load; none unless it slips under a load that
    /// follows displacements.
    pub(super) by_load: Option<(PowerSeries, Vec<(usize, f64)>)>,
    /// ∂z_j'/∂r, then ∂z_j'/∂z_l: a row for each j.
    pub(super) rates: Vec<Vec<PowerSeries>>,
    /// For each memory variable z_j: true if the law depends on it in this mode.
    pub(super) depends: Vec<bool>,
}

impl Joint {
    /// The same coefficients, as series about a later time.
    pub(super) fn shifted(&self, time: f64) -> Self {
        let shift = |series: &[PowerSeries]| -> Vec<_> {
            series.iter().map(|series| series.shifted(time)).collect()
        };
        Self {
            friction: shift(&self.friction),
            by_load: self
                .by_load
                .as_ref()
                .map(|(series, gradient)| (series.shifted(time), gradient.clone())),
            rates: self.rates.iter().map(|row| shift(row)).collect(),
            depends: self.depends.clone(),
            ..*self
        }
    }
}

impl Linear {
    /// The coefficients along a step of positive length.
    pub(super) fn of(model: &Model<'_>, step: &Step, tape: &mut Tape) -> Self {
        let contacts = model.contacts.iter().enumerate();
        let joints = contacts.map(|(number, contact)| {
            let variables = model.memory(number);
            let variables = model.len() + variables.start..model.len() + variables.end;
            let along = Along {
                contact,
                step,
                memories: step.series().get(variables).unwrap_or(&[]),
                tape,
            };
            along.joint(step.modes()[number])
        });
        Self {
            joints: joints.collect(),
            holding: Holding::of(model, step.modes()),
        }
    }

    /// The same coefficients, as series about a later time.
    pub(super) fn shifted(&self, time: f64) -> Self {
        Self {
            joints: self
                .joints
                .iter()
                .map(|joint| joint.shifted(time))
                .collect(),
            holding: self.holding.clone(),
        }
    }
}

/// A contact along a step.
struct Along<'a> {
    contact: &'a ContactData<'a>,
    step: &'a Step,
    memories: &'a [PowerSeries],
    tape: &'a mut Tape,
}

impl Along<'_> {
    fn joint(mut self, mode: Mode) -> Joint {
        let count = self.contact.memory();
        let mut joint = Joint {
            is_stuck: mode == Mode::Stick,
            is_closed: mode != Mode::Open,
            friction: Vec::new(),
            by_load: None,
            rates: vec![Vec::new(); count],
            depends: vec![false; count],
        };
        match mode {
            Mode::Open => {}
            _ if self.contact.is_elastic() => self.elastic(&mut joint, mode),
            Mode::Stick => self.stick(&mut joint),
            Mode::Slip(side) => self.slip(&mut joint, side.sign()),
        }
        joint
    }

    /// δT' = k_t δr and the force δT; in slip the force σμ n·δq, with which δT goes: see
    /// `TangentFlow::limit_elastic`.
    fn elastic(&self, joint: &mut Joint, mode: Mode) {
        let constant = |value: f64| PowerSeries::from_fn(|k| if k == 0 { value } else { 0.0 });
        joint.is_stuck = false;
        match mode {
            Mode::Slip(side) => {
                let coefficient = side.sign() * self.contact.constant_coefficient();
                joint.by_load = Some((constant(coefficient), self.contact.load_gradient.clone()));
            }
            Mode::Stick | Mode::Open => {
                let stiffness = self.contact.tangential_stiffness.unwrap_or(0.0);
                joint.friction = vec![PowerSeries::ZERO, constant(1.0)];
                joint.rates = vec![vec![constant(stiffness), PowerSeries::ZERO]];
                joint.depends = vec![true];
            }
        }
    }

    /// The derivative by one input; the derivatives of the rates are stored.
    fn derivative(
        &mut self,
        joint: &mut Joint,
        motion: Motion<&PowerSeries>,
        by: Option<usize>,
    ) -> Derivative {
        let derivative = self
            .contact
            .law
            .derivative(motion, self.memories, by, self.tape);
        if let Some(j) = by {
            joint.depends[j] |= derivative.depends;
        }
        for (row, rate) in joint.rates.iter_mut().zip(&derivative.rates) {
            row.push(*rate);
        }
        derivative
    }

    fn stick(&mut self, joint: &mut Joint) {
        for row in &mut joint.rates {
            row.push(PowerSeries::ZERO);
        }
        for j in 0..joint.rates.len() {
            self.derivative(joint, Motion::Stick, Some(j));
        }
    }

    fn slip(&mut self, joint: &mut Joint, direction: f64) {
        let (step, contact) = (self.step, self.contact);
        let velocities = step.series();
        if velocities.is_empty() {
            return;
        }
        let surface = contact.belt_velocity.series(step.clock());
        let relative = |k: usize| contact.along(|j| velocities[j][k]) - surface[k];
        let speeds = PowerSeries::from_fn(|k| direction * relative(k));
        let middle = speeds.at(0.5 * step.duration());
        let load = self.load(step.state());
        let motion = Motion::Slip(Slip {
            speed: &speeds,
            direction,
            piece: piece_above(contact.breakpoints.iter().copied(), middle),
        });
        let by_speed = self.derivative(joint, motion, None);
        joint.friction.push(product(&load, &by_speed.slope));
        if !contact.load_gradient.is_empty() {
            let gradient = contact.load_gradient.to_vec();
            joint.by_load = Some((by_speed.coefficient.scaled(contact.compliance), gradient));
        }
        for j in 0..joint.rates.len() {
            let by_memory = self.derivative(joint, motion, Some(j));
            joint.friction.push(product(&load, &by_memory.slope));
        }
    }

    /// The series of N G_cc.
    fn load(&self, start: &State) -> PowerSeries {
        let mut load = self.contact.load.series(self.step.clock());
        for &(j, gradient) in &self.contact.load_gradient {
            load[0] += gradient * start.displacements[j];
            let velocity = &self.step.series()[j];
            for k in 1..TERMS {
                load[k] = mul_add(gradient, velocity[k - 1] * INTEGRAL[k - 1], load[k]);
            }
        }
        load.scaled(self.contact.compliance)
    }
}

/// The series of a product.
fn product(a: &PowerSeries, b: &PowerSeries) -> PowerSeries {
    if a.is_constant() {
        return b.scaled(a[0]);
    }
    PowerSeries::from_fn(|k| (0..=k).map(|l| a[l] * b[k - l]).sum())
}
