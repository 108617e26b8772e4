//! The power series of all coordinates about one time, order by order.

use super::engine::Engine;
use super::model::Target;
use crate::drive::Drive;
use crate::friction::memory::{ContactLaw, Motion, Slip};
use crate::motion::Mode;
use crate::scalar::jet::Run;
use crate::scalar::{Scalar, mul_add};
use crate::series::{INTEGRAL, PowerSeries, TERMS};

/// A law that gives no number, or no series.
#[derive(Debug, Clone, Copy)]
pub(super) enum LawFault {
    NonFinite { speed: f64, value: f64 },
    NotAnalytic { speed: f64 },
}

impl<L: ContactLaw<Z>, const Z: usize> Engine<'_, L, Z> {
    /// The series of every drive that varies, from the time of the clock on.
    pub(super) fn expand_drives(&mut self) {
        let clock = self.clock;
        for &(target, drive) in &self.model.varying {
            let series = |drive: &Drive| drive.series(clock);
            match target {
                Target::Force(i) => {
                    self.bodies[i].force = series(drive).scaled(self.model.inverse_mass[i]);
                    self.bodies[i].is_driven = true;
                }
                Target::Surface(c) => {
                    let joint = &self.joints[c];
                    if joint.mode != Mode::Open {
                        self.bodies[joint.body()].surface = series(drive);
                        self.bodies[joint.body()].is_driven = true;
                    }
                }
                // With its part from displacements, order by order.
                Target::Load(c) => {
                    let joint = &mut self.joints[c];
                    joint.load = series(drive).scaled(self.model.inverse_mass[joint.body()]);
                    joint.drive_load = joint.load;
                }
            }
        }
    }

    /// The series of all coordinates. Order by order: first the law of every contact, from the
    /// sliding speeds of that order; then R of every coordinate, which gives the velocities of the
    /// next.
    pub(super) fn expand(&mut self) -> Result<(), LawFault> {
        let Self {
            model,
            bodies,
            joints,
            now,
            next,
            ..
        } = self;
        let (stiffness, damping) = (&model.stiffness, &model.damping);
        for (body, at) in bodies.iter_mut().zip(&mut *now) {
            body.speeds[0] = body.speed;
            body.resistance = 0.0;
            *at = Coefficients {
                displacement: body.displacement,
                velocity: body.velocity(),
            };
        }
        for (k, inverse) in INTEGRAL.into_iter().enumerate().take(TERMS - 1) {
            for joint in joints.iter_mut() {
                let i = joint.body();
                if joint.load_varies {
                    let gradient = joint.contact.load_gradient().iter();
                    let from_displacements: f64 =
                        gradient.map(|&(j, n)| n * now[j].displacement).sum();
                    joint.load[k] =
                        joint.drive_load[k] + from_displacements * model.inverse_mass[i];
                }
                match joint.mode {
                    Mode::Open => {}
                    Mode::Slip(direction) => {
                        let body = &mut bodies[i];
                        body.resistance = joint.slip_order(k, body.speeds[k], direction.sign());
                    }
                    Mode::Stick => joint.stick_order(k),
                }
            }
            let couplings = stiffness.rows().zip(damping.rows());
            let coefficients = now.iter().zip(&mut *next);
            for ((body, (&at, next)), (springs, dampers)) in
                bodies.iter_mut().zip(coefficients).zip(couplings)
            {
                let Coefficients {
                    displacement,
                    velocity,
                } = at;
                let mut carried = -dampers.0 * velocity - springs.0 * displacement;
                for &(j, a) in springs.1 {
                    carried -= a * now[j].displacement;
                }
                for &(j, a) in dampers.1 {
                    carried -= a * now[j].velocity;
                }
                let mut surface = 0.0;
                if body.is_driven {
                    surface = body.surface[k + 1];
                    carried += body.force[k] - (k + 1) as f64 * surface;
                } else if k == 0 {
                    carried += body.force[0];
                }
                body.carried[k] = carried;
                let equation = (body.side * carried - body.resistance) * inverse;
                let speed = match body.rate {
                    Some(rate) if k == 0 => rate,
                    _ => equation,
                };
                body.speeds[k + 1] = speed;
                *next = Coefficients {
                    displacement: velocity * inverse,
                    velocity: mul_add(body.side, speed, surface),
                };
            }
            std::mem::swap(now, next);
        }
        self.law_fault().map_or(Ok(()), Err)
    }

    /// The first law that gave no number, or no slope.
    fn law_fault(&self) -> Option<LawFault> {
        let slipping = self.joints.iter().filter(|j| j.direction().is_some());
        slipping.into_iter().find_map(|joint| {
            let body = &self.bodies[joint.body()];
            let (speed, value) = (body.speed, joint.friction[0]);
            if !value.is_finite() {
                Some(LawFault::NonFinite { speed, value })
            } else if !joint.friction[1].is_finite() && body.speeds[1].is_finite() {
                Some(LawFault::NotAnalytic { speed })
            } else {
                None
            }
        })
    }
}

/// Coefficients of the order in work of one coordinate.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Coefficients {
    displacement: f64,
    velocity: f64,
}

impl<L: ContactLaw<Z>, const Z: usize> super::parts::Joint<'_, L, Z> {
    /// Coefficient k of Nσμ/m in slip, and k + 1 of the memory.
    #[inline]
    fn slip_order(&mut self, k: usize, speed: f64, direction: f64) -> f64 {
        let (law, piece) = (self.contact.law(), self.piece);
        if k == 0 {
            self.remember();
        }
        let memories = &self.memories;
        let (coefficient, rates) = self.tape.run(k, |run| {
            let slip = Slip {
                speed: run.variable(speed),
                direction,
                piece,
            };
            let memory = inputs(run, memories, k);
            let coefficient = law.coefficient(slip, memory).coefficient() * direction;
            let rates = law.rates(Motion::Slip(slip), memory);
            (coefficient, rates.map(|rate| rate.coefficient()))
        });
        self.set_memories(k, rates);
        self.friction[k] = coefficient;
        if self.load_varies {
            (0..=k).map(|l| self.load[l] * self.friction[k - l]).sum()
        } else {
            self.load[0] * coefficient
        }
    }

    /// Coefficient k of the bound N μ_s/m in stick, and k + 1 of the memory.
    #[inline]
    fn stick_order(&mut self, k: usize) {
        let law = self.contact.law();
        if Z == 0 {
            // μ_s is a constant.
            self.bound[k] = if k == 0 || self.load_varies {
                self.load[k] * self.static_coefficient()
            } else {
                0.0
            };
            return;
        }
        if k == 0 {
            self.remember();
        }
        let memories = &self.memories;
        let (limit, rates) = self.tape.run(k, |run| {
            let memory = inputs(run, memories, k);
            let zero = memory[0].constant(0.0);
            let limit = law.limit(zero, memory).map(|limit| limit.coefficient());
            let rates = law.rates(Motion::Stick, memory);
            (limit, rates.map(|rate| rate.coefficient()))
        });
        self.limits[k] = limit.unwrap_or(0.0);
        self.bound[k] = (0..=k).map(|l| self.load[l] * self.limits[k - l]).sum();
        self.set_memories(k, rates);
    }

    fn remember(&mut self) {
        for (series, memory) in std::iter::zip(&mut self.memories, self.memory) {
            series[0] = memory;
        }
    }

    #[inline(always)]
    fn set_memories(&mut self, k: usize, rates: [f64; Z]) {
        for (series, rate) in std::iter::zip(&mut self.memories, rates) {
            series[k + 1] = rate * INTEGRAL[k];
        }
    }
}

#[inline(always)]
fn inputs<'r, const Z: usize>(
    run: &'r Run<'_>,
    memories: &[PowerSeries; Z],
    k: usize,
) -> [crate::scalar::jet::Jet<'r>; Z] {
    std::array::from_fn(|j| run.input(memories[j][k]))
}
