//! The equations of motion linearised along one step: how friction follows the velocity and the
//! memory of its contact, as power series in time.

use std::fmt;

use crate::friction::memory::{ContactLaw, Motion, Slip};
use crate::friction::piece_above;
use crate::motion::{Mode, Segment};
use crate::scalar::dual::{Dual, Tangent};
use crate::scalar::jet::{Jet, Run, Tape};
use crate::scalar::{Scalar, mul_add};
use crate::series::{INTEGRAL, PowerSeries, TERMS};
use crate::state::structure::State;
use crate::structure::Step;
use crate::structure::laws::Typed;
use crate::structure::model::{Model, Support};

use super::oscillator::Form;

/// What the tangents ask of the laws of all contacts.
pub(super) trait LawDerivatives {
    /// The law of a contact along a motion, and its derivative by one of its inputs: the sliding
    /// speed, or number j of the memory.
    fn derivative(
        &self,
        contact: usize,
        motion: Motion<&PowerSeries>,
        memories: &[PowerSeries],
        by: Option<usize>,
        tape: &mut Tape,
    ) -> Derivative;
    /// ∂μ_s/∂z_j; NaN for a law that never sticks.
    fn limit_slope(&self, contact: usize, memory: &[f64], by: usize) -> f64;
}

/// Series of a law, and of its derivative by one input.
pub(super) struct Derivative {
    /// μ in slip.
    coefficient: PowerSeries,
    /// Its derivative.
    slope: PowerSeries,
    /// Those of the rates of the memory.
    rates: Vec<PowerSeries>,
    /// Whether anything depends on the input.
    depends: bool,
}

impl fmt::Debug for dyn LawDerivatives + '_ {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("LawDerivatives")
    }
}

/// The derivatives at one contact.
#[derive(Debug, Clone)]
pub(super) struct Joint {
    /// Its coordinate.
    pub(super) body: usize,
    pub(super) is_stuck: bool,
    /// ∂(Nμ/m)/∂v, then ∂(Nμ/m)/∂z_j; none unless it slips.
    pub(super) friction: Vec<PowerSeries>,
    /// μ/m and the gradient of the load; none unless it slips under a load that follows
    /// displacements.
    pub(super) by_load: Option<(PowerSeries, Vec<(usize, f64)>)>,
    /// ∂z_j'/∂v, then ∂z_j'/∂z_l: a row for each j.
    pub(super) rates: Vec<Vec<PowerSeries>>,
    /// Whether the law depends on z_j in this mode.
    pub(super) depends: Vec<bool>,
}

impl Joint {
    /// The same later.
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

/// The joints of a step of positive length.
pub(super) fn joints(form: &Form<'_>, step: &Step, tape: &mut Tape) -> Vec<Joint> {
    let (model, count) = (&form.model, form.model.laws.memory());
    let contacts = model.contacts.iter().enumerate();
    contacts
        .map(|(number, contact)| {
            let first = model.len() + number * count;
            let along = Along {
                model,
                laws: &*form.laws,
                number,
                contact,
                inverse_mass: model.masses[contact.coordinate].recip(),
                step,
                memories: step.series().get(first..).unwrap_or(&[]),
                tape,
            };
            along.joint(step.modes()[number])
        })
        .collect()
}

/// A contact along a step.
struct Along<'a> {
    model: &'a Model<'a>,
    laws: &'a dyn LawDerivatives,
    number: usize,
    contact: &'a Support<'a>,
    inverse_mass: f64,
    step: &'a Step,
    memories: &'a [PowerSeries],
    tape: &'a mut Tape,
}

impl Along<'_> {
    fn joint(mut self, mode: Mode) -> Joint {
        let count = self.model.laws.memory();
        let mut joint = Joint {
            body: self.contact.coordinate,
            is_stuck: mode == Mode::Stick,
            friction: Vec::new(),
            by_load: None,
            rates: vec![Vec::new(); count],
            depends: vec![false; count],
        };
        match mode {
            Mode::Open => {}
            Mode::Stick => self.stick(&mut joint),
            Mode::Slip(side) => self.slip(&mut joint, side.sign()),
        }
        joint
    }

    /// The derivative by one input, whose rates are noted.
    fn derivative(
        &mut self,
        joint: &mut Joint,
        motion: Motion<&PowerSeries>,
        by: Option<usize>,
    ) -> Derivative {
        let (laws, memories) = (self.laws, self.memories);
        let derivative = laws.derivative(self.number, motion, memories, by, self.tape);
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
        let step = self.step;
        let velocities = step.series();
        let Some(velocity) = velocities.get(joint.body) else {
            return;
        };
        let surface = self.contact.belt_velocity.series(step.clock());
        let speeds = PowerSeries::from_fn(|k| direction * (velocity[k] - surface[k]));
        let middle = speeds.at(0.5 * step.duration());
        let breakpoints = self.model.laws.breakpoints(self.number).into_iter();
        let load = self.load(step.state());
        let motion = Motion::Slip(Slip {
            speed: &speeds,
            direction,
            piece: piece_above(breakpoints, middle),
        });
        let by_speed = self.derivative(joint, motion, None);
        joint.friction.push(product(&load, &by_speed.slope));
        if !self.contact.load_gradient.is_empty() {
            let gradient = self.contact.load_gradient.to_vec();
            joint.by_load = Some((by_speed.coefficient.scaled(self.inverse_mass), gradient));
        }
        for j in 0..joint.rates.len() {
            let by_memory = self.derivative(joint, motion, Some(j));
            joint.friction.push(product(&load, &by_memory.slope));
        }
    }

    /// N/m.
    fn load(&self, start: &State) -> PowerSeries {
        let mut load = self.contact.load.series(self.step.clock());
        for &(j, gradient) in self.contact.load_gradient {
            load[0] += gradient * start.displacements[j];
            let velocity = &self.step.series()[j];
            for k in 1..TERMS {
                load[k] = mul_add(gradient, velocity[k - 1] * INTEGRAL[k - 1], load[k]);
            }
        }
        load.scaled(self.inverse_mass)
    }
}

impl<L: ContactLaw<Z>, const Z: usize> LawDerivatives for Typed<'_, L, Z> {
    fn derivative(
        &self,
        contact: usize,
        motion: Motion<&PowerSeries>,
        memories: &[PowerSeries],
        by: Option<usize>,
        tape: &mut Tape,
    ) -> Derivative {
        let law = self.0[contact];
        let mut found = Derivative {
            coefficient: PowerSeries::ZERO,
            slope: PowerSeries::ZERO,
            rates: vec![PowerSeries::ZERO; Z],
            depends: false,
        };
        for k in 0..TERMS {
            let rates = tape.run(k, |run| match motion {
                Motion::Slip(slip) => {
                    let component = if by.is_none() { slip.direction } else { 0.0 };
                    let slip = Slip {
                        speed: Dual::along(run.variable(slip.speed[k]), component),
                        direction: slip.direction,
                        piece: slip.piece,
                    };
                    let memory = inputs::<Z>(run, memories, k, by);
                    let coefficient = law.coefficient(slip, memory);
                    found.coefficient[k] = coefficient.value.coefficient();
                    found.slope[k] = tangent(coefficient, k);
                    law.rates(Motion::Slip(slip), memory)
                        .map(|rate| tangent(rate, k))
                }
                Motion::Stick => {
                    let memory = inputs::<Z>(run, memories, k, by);
                    let Some(number) = memory.first() else {
                        return [0.0; Z];
                    };
                    let limit = law.limit(number.constant(0.0), memory);
                    found.depends |=
                        limit.is_some_and(|limit| !matches!(limit.tangent, Tangent::Constant(0.0)));
                    law.rates(Motion::Stick, memory)
                        .map(|rate| tangent(rate, k))
                }
            });
            found.depends |= found.slope[k] != 0.0 || rates.iter().any(|rate| *rate != 0.0);
            for (series, rate) in found.rates.iter_mut().zip(rates) {
                series[k] = rate;
            }
        }
        found
    }

    fn limit_slope(&self, contact: usize, memory: &[f64], by: usize) -> f64 {
        let inputs = std::array::from_fn(|j| {
            let component = if j == by { 1.0 } else { 0.0 };
            Dual::along(memory[j], component)
        });
        let limit = self.0[contact].limit(Dual::along(0.0, 0.0), inputs);
        match limit.map(|limit| limit.tangent) {
            Some(Tangent::Constant(slope) | Tangent::Varying(slope)) => slope,
            None => f64::NAN,
        }
    }
}

/// The memory as inputs of a law, with the tangent 1 for number `by`.
#[inline(always)]
fn inputs<'r, const Z: usize>(
    run: &'r Run<'_>,
    memories: &[PowerSeries],
    k: usize,
    by: Option<usize>,
) -> [Dual<Jet<'r>>; Z] {
    std::array::from_fn(|j| {
        let component = if by == Some(j) { 1.0 } else { 0.0 };
        Dual::along(run.input(memories[j][k]), component)
    })
}

/// Coefficient k of a tangent.
#[inline(always)]
fn tangent(number: Dual<Jet<'_>>, k: usize) -> f64 {
    match number.tangent {
        Tangent::Varying(tangent) => tangent.coefficient(),
        Tangent::Constant(c) if k == 0 => c,
        Tangent::Constant(_) => 0.0,
    }
}

/// The series of a product.
fn product(a: &PowerSeries, b: &PowerSeries) -> PowerSeries {
    if a.is_constant() {
        return b.scaled(a[0]);
    }
    PowerSeries::from_fn(|k| (0..=k).map(|l| a[l] * b[k - l]).sum())
}
