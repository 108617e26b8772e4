//! The equations of motion linearised along one step: how friction follows the velocity and the
//! memory of its contact, as power series in time.

use crate::friction::memory::{ContactLaw, Motion, Slip};
use crate::friction::piece_above;
use crate::motion::{Mode, Segment};
use crate::scalar::dual::{Dual, Tangent};
use crate::scalar::jet::{Jet, Run, Tape};
use crate::scalar::{Scalar, mul_add};
use crate::series::{INTEGRAL, PowerSeries, TERMS};
use crate::state::structure::State;
use crate::structure::{Contact, Step, Structure};

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
pub(super) fn joints<L: ContactLaw<Z>, const Z: usize>(
    structure: &Structure<L, Z>,
    step: &Step,
    tape: &mut Tape,
) -> Vec<Joint> {
    let contacts = structure.contacts().iter().enumerate();
    contacts
        .map(|(c, contact)| {
            let memories = step.series().get(structure.len() + c * Z..).unwrap_or(&[]);
            let along = Along {
                contact,
                inverse_mass: structure.masses()[contact.coordinate()].recip(),
                step,
                memories,
                tape,
            };
            along.joint(step.modes()[c])
        })
        .collect()
}

/// A contact along a step.
struct Along<'a, L, const Z: usize> {
    contact: &'a Contact<L, Z>,
    inverse_mass: f64,
    step: &'a Step,
    memories: &'a [PowerSeries],
    tape: &'a mut Tape,
}

impl<L: ContactLaw<Z>, const Z: usize> Along<'_, L, Z> {
    fn joint(mut self, mode: Mode) -> Joint {
        let mut joint = Joint {
            body: self.contact.coordinate(),
            is_stuck: mode == Mode::Stick,
            friction: Vec::new(),
            by_load: None,
            rates: vec![Vec::new(); Z],
            depends: vec![false; Z],
        };
        match mode {
            Mode::Open => {}
            Mode::Stick => self.stick(&mut joint),
            Mode::Slip(side) => self.slip(&mut joint, side.sign()),
        }
        joint
    }

    fn stick(&mut self, joint: &mut Joint) {
        if Z == 0 {
            return;
        }
        let (law, memories) = (self.contact.law(), self.memories);
        for row in &mut joint.rates {
            row.push(PowerSeries::ZERO);
        }
        for along in 0..Z {
            let mut columns = [PowerSeries::ZERO; Z];
            for k in 0..TERMS {
                let (rates, depends) = self.tape.run(k, |run| {
                    let memory = inputs::<Z>(run, memories, k, along);
                    let zero = memory[0].constant(0.0);
                    let limit = law.limit(zero, memory).map(|limit| limit.tangent);
                    let depends = limit.is_some_and(|t| !matches!(t, Tangent::Constant(0.0)));
                    let rates = law.rates(Motion::Stick, memory);
                    (rates.map(|rate| tangent(rate, k)), depends)
                });
                joint.depends[along] |= depends || rates.iter().any(|rate| *rate != 0.0);
                for (column, rate) in columns.iter_mut().zip(rates) {
                    column[k] = rate;
                }
            }
            for (row, column) in joint.rates.iter_mut().zip(columns) {
                row.push(column);
            }
        }
    }

    fn slip(&mut self, joint: &mut Joint, direction: f64) {
        let step = self.step;
        let velocities = step.series();
        let Some(velocity) = velocities.get(joint.body) else {
            return;
        };
        let surface = self.contact.belt_velocity().series(step.clock());
        let speeds = PowerSeries::from_fn(|k| direction * (velocity[k] - surface[k]));
        let middle = speeds.at(0.5 * step.duration());
        let (law, memories) = (self.contact.law(), self.memories);
        let piece = piece_above(law.breakpoints(), middle);
        let load = self.load(step.state());
        for along in 0..=Z {
            let mut friction = PowerSeries::ZERO;
            let mut coefficients = PowerSeries::ZERO;
            let mut columns = [PowerSeries::ZERO; Z];
            for k in 0..TERMS {
                let (coefficient, slope, rates) = self.tape.run(k, |run| {
                    let component = if along == 0 { direction } else { 0.0 };
                    let slip = Slip {
                        speed: Dual::along(run.variable(speeds[k]), component),
                        direction,
                        piece,
                    };
                    let memory = inputs::<Z>(run, memories, k, along.wrapping_sub(1));
                    let coefficient = law.coefficient(slip, memory);
                    let rates = law.rates(Motion::Slip(slip), memory);
                    (
                        coefficient.value.coefficient(),
                        tangent(coefficient, k),
                        rates.map(|rate| tangent(rate, k)),
                    )
                });
                (coefficients[k], friction[k]) = (coefficient, slope);
                if let Some(j) = along.checked_sub(1) {
                    joint.depends[j] |= slope != 0.0 || rates.iter().any(|rate| *rate != 0.0);
                }
                for (column, rate) in columns.iter_mut().zip(rates) {
                    column[k] = rate;
                }
            }
            joint.friction.push(product(&load, &friction));
            for (row, column) in joint.rates.iter_mut().zip(columns) {
                row.push(column);
            }
            if along == 0 && !self.contact.load_gradient().is_empty() {
                let gradient = self.contact.load_gradient().to_vec();
                joint.by_load = Some((coefficients.scaled(self.inverse_mass), gradient));
            }
        }
    }

    /// N/m.
    fn load(&self, start: &State) -> PowerSeries {
        let mut load = self.contact.load().series(self.step.clock());
        for &(j, gradient) in self.contact.load_gradient() {
            load[0] += gradient * start.displacements[j];
            let velocity = &self.step.series()[j];
            for k in 1..TERMS {
                load[k] = mul_add(gradient, velocity[k - 1] * INTEGRAL[k - 1], load[k]);
            }
        }
        load.scaled(self.inverse_mass)
    }
}

/// The memory as inputs of a law, with the tangent 1 for number `along`.
#[inline(always)]
fn inputs<'r, const Z: usize>(
    run: &'r Run<'_>,
    memories: &[PowerSeries],
    k: usize,
    along: usize,
) -> [Dual<Jet<'r>>; Z] {
    std::array::from_fn(|j| {
        let component = if j == along { 1.0 } else { 0.0 };
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
