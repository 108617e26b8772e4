//! The power series of all coordinates about one time, order by order.

use std::ops::Range;

use super::engine::Engine;
use super::model::{Model, Target};
use super::parts::{Body, Joint};
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

impl Engine<'_> {
    /// The series of every drive that varies, from the time of the clock on.
    pub(super) fn expand_drives(&mut self) {
        for &target in &self.model.varying {
            let series = self.model.drive(target).series(self.clock);
            match target {
                Target::Force(i) => {
                    self.bodies[i].force = series.scaled(self.model.inverse_mass[i]);
                    self.bodies[i].is_driven = true;
                }
                Target::Surface(c) => {
                    let joint = &self.joints[c];
                    if joint.mode != Mode::Open {
                        self.bodies[joint.body].surface = series;
                        self.bodies[joint.body].is_driven = true;
                    }
                }
                // With its part from displacements, order by order.
                Target::Load(c) => {
                    let joint = &mut self.joints[c];
                    joint.load = series.scaled(self.model.inverse_mass[joint.body]);
                    joint.drive_load = joint.load;
                }
            }
        }
    }

    /// The series of all coordinates. Order by order, of every coordinate: first the law of its
    /// contact, from the sliding speed of that order; then R, which gives the velocity of the next.
    ///
    /// Order k of a coordinate needs order k of those that act on it, no more. So where masses act
    /// on near ones alone, some masses are brought to the last order before the next ones are
    /// begun: all that one reads and writes lies in the processor's nearest memory. With every
    /// order the masses in work are shifted, to those of which all neighbours are ready.
    pub(super) fn expand(&mut self) -> Result<(), LawFault> {
        for (body, course) in self.bodies.iter_mut().zip(&mut self.courses) {
            body.speeds[0] = body.speed;
            course.start(body.displacement, body.velocity());
        }
        let Self {
            model,
            bodies,
            joints,
            courses,
            ..
        } = self;
        model.laws.expand(model, bodies, joints, courses);
        self.law_fault().map_or(Ok(()), Err)
    }

    /// The first law that gave no number, or no slope.
    fn law_fault(&self) -> Option<LawFault> {
        let slipping = self.joints.iter().filter(|j| j.direction().is_some());
        slipping.into_iter().find_map(|joint| {
            let body = &self.bodies[joint.body];
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

/// All orders of all coordinates.
#[inline(always)]
pub(super) fn expand<L: ContactLaw<Z>, const Z: usize>(
    laws: &[&L],
    model: &Model<'_>,
    bodies: &mut [Body],
    joints: &mut [Joint],
    courses: &mut [Course],
) {
    const LAST: usize = TERMS - 1;
    let (n, shift) = (bodies.len(), model.bandwidth);
    let (laws, courses) = (&laws[..joints.len()], &mut courses[..n]);
    for start in (0..n + LAST * shift).step_by(AT_A_TIME) {
        for k in 0..LAST {
            let place = |i: usize| i.saturating_sub(k * shift).min(n);
            let coordinates = place(start)..place(start + AT_A_TIME);
            order(laws, model, bodies, joints, courses, k, coordinates);
        }
    }
}

/// Order k + 1 of the velocities of some coordinates.
#[inline(always)]
fn order<L: ContactLaw<Z>, const Z: usize>(
    laws: &[&L],
    model: &Model<'_>,
    bodies: &mut [Body],
    joints: &mut [Joint],
    courses: &mut [Course],
    k: usize,
    coordinates: Range<usize>,
) {
    let (stiffness, damping) = (&model.stiffness, &model.damping);
    for i in coordinates {
        let body = &mut bodies[i];
        let mut resistance = 0.0;
        if let Some(c) = body.contact {
            let (law, joint) = (laws[c], &mut joints[c]);
            if joint.load_varies {
                let gradient = model.contacts[c].load_gradient.iter();
                let from_displacements: f64 =
                    gradient.map(|&(j, n)| n * courses[j].displacement(k)).sum();
                joint.load[k] = joint.drive_load[k] + from_displacements * model.inverse_mass[i];
            }
            match joint.mode {
                Mode::Open => {}
                Mode::Slip(side) => {
                    resistance = joint.slip_order(law, k, body.speeds[k], side.sign());
                }
                Mode::Stick => joint.stick_order(law, k),
            }
        }
        let own = &courses[i];
        let ((spring, springs), (damper, dampers)) = (stiffness.row(i), damping.row(i));
        let mut carried = -damper * own.velocity(k) - spring * own.displacement(k);
        for &(j, a) in springs {
            carried -= a * courses[j].displacement(k);
        }
        for &(j, a) in dampers {
            carried -= a * courses[j].velocity(k);
        }
        let mut surface = 0.0;
        if body.is_driven {
            surface = body.surface[k + 1];
            carried += body.force[k] - (k + 1) as f64 * surface;
        } else if k == 0 {
            carried += body.force[0];
        }
        body.carried[k] = carried;
        let equation = (body.side * carried - resistance) * INTEGRAL[k];
        let speed = match body.rate {
            Some(rate) if k == 0 => rate,
            _ => equation,
        };
        body.speeds[k + 1] = speed;
        courses[i].set_velocity(k + 1, mul_add(body.side, speed, surface));
    }
}
/// How many masses of a long chain are brought from order to order together.
const AT_A_TIME: usize = 32;

/// The series of one displacement q: its value, then the coefficients of the velocity v = q', so
/// that number k is q_0 or k q_k.
#[derive(Debug, Clone)]
pub(crate) struct Course([f64; TERMS + 1]);

impl Course {
    pub(super) const ZERO: Self = Self([0.0; TERMS + 1]);

    fn start(&mut self, displacement: f64, velocity: f64) {
        [self.0[0], self.0[1]] = [displacement, velocity];
    }

    #[inline(always)]
    fn displacement(&self, k: usize) -> f64 {
        const WEIGHTS: [f64; TERMS + 1] = {
            let mut weights = [1.0; TERMS + 1];
            let mut k = 1;
            while k <= TERMS {
                weights[k] = INTEGRAL[k - 1];
                k += 1;
            }
            weights
        };
        self.0[k] * WEIGHTS[k]
    }

    #[inline(always)]
    fn velocity(&self, k: usize) -> f64 {
        self.0[k + 1]
    }

    #[inline(always)]
    fn set_velocity(&mut self, k: usize, coefficient: f64) {
        self.0[k + 1] = coefficient;
    }

    /// The series of v.
    pub(super) fn velocities(&self) -> PowerSeries {
        PowerSeries::from_fn(|k| self.velocity(k))
    }
}

impl Joint {
    /// Coefficient k of Nσμ/m in slip, and k + 1 of the memory; on the slow motion k of the memory,
    /// from k + 1 of the pass before.
    #[inline(always)]
    fn slip_order<L: ContactLaw<Z>, const Z: usize>(
        &mut self,
        law: &L,
        k: usize,
        speed: f64,
        direction: f64,
    ) -> f64 {
        let relaxes = Z == 1 && self.relaxation > 0.0;
        if Z > 0 && k == 0 && !relaxes {
            self.remember();
        }
        // Where the memory relaxes the law runs twice: for the memory, then with it. The call
        // stands in one place, so that the law is inlined once.
        let mut corrects = relaxes;
        let coefficient = loop {
            let (coefficient, slope, rates) = self.run_law(law, k, speed, direction);
            self.slope = slope;
            if !corrects {
                if Z > 0 && !relaxes {
                    self.set_memories(k, rates);
                }
                break coefficient;
            }
            corrects = false;
            for (series, rate) in std::iter::zip(&mut self.memories, rates) {
                let correction = (rate - (k + 1) as f64 * series[k + 1]) / self.relaxation;
                // What rounds to and fro would change the later coefficients for ever.
                if correction.abs() > 2.0 * f64::EPSILON * series[k].abs() {
                    series[k] += correction;
                }
            }
        };
        self.friction[k] = coefficient;
        if self.load_varies {
            (0..=k).map(|l| self.load[l] * self.friction[k - l]).sum()
        } else {
            self.load[0] * coefficient
        }
    }

    /// Coefficient k of σμ, the slope ∂(σμ)/∂s at the start, and coefficient k of the rates of the
    /// memory in slip.
    #[inline(always)]
    fn run_law<L: ContactLaw<Z>, const Z: usize>(
        &mut self,
        law: &L,
        k: usize,
        speed: f64,
        direction: f64,
    ) -> (f64, f64, [f64; Z]) {
        let (piece, memories) = (self.piece, &self.memories);
        self.tape.run(k, |run| {
            let slip = Slip {
                speed: run.variable(speed),
                direction,
                piece,
            };
            let memory = inputs(run, memories, k);
            let coefficient = law.coefficient(slip, memory) * direction;
            let rates = law.rates(Motion::Slip(slip), memory);
            let rates = rates.map(|rate| rate.coefficient());
            (coefficient.coefficient(), coefficient.derivative(), rates)
        })
    }

    /// Coefficient k of the bound N μ_s/m in stick, and k + 1 of the memory.
    #[inline]
    fn stick_order<L: ContactLaw<Z>, const Z: usize>(&mut self, law: &L, k: usize) {
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
        for (series, memory) in std::iter::zip(&mut self.memories, &self.memory) {
            series[0] = *memory;
        }
    }

    #[inline(always)]
    fn set_memories<const Z: usize>(&mut self, k: usize, rates: [f64; Z]) {
        for (series, rate) in std::iter::zip(&mut self.memories, rates) {
            series[k + 1] = rate * INTEGRAL[k];
        }
    }
}

#[inline(always)]
fn inputs<'r, const Z: usize>(
    run: &'r Run<'_>,
    memories: &[PowerSeries],
    k: usize,
) -> [crate::scalar::jet::Jet<'r>; Z] {
    std::array::from_fn(|j| run.input(memories[j][k]))
}
