//! A contact law as a trait object, for the engine of structures. The engine and the searches are
//! compiled once, for any law, and one structure can have contacts of different laws.
//!
//! Functions that return numbers get the memory as a function of the variable's number, because it
//! is computed on demand. A power series is computed one order per call.

use std::fmt;

use super::sliding::{Input, Sliding};
use super::{ContactLaw, Motion, NamedLaw, Slip, Variables};
use crate::friction::law_object::{Law, LawRef, Own};
use crate::scalar::Scalar;
use crate::scalar::dual::{Dual, Tangent};
use crate::scalar::jet::{Jet, Tape};
use crate::scalar::recorded::{Output, Recorder};
use crate::series::PowerSeries;

/// Memory variables by their numbers.
pub(crate) type Memory<'m> = &'m dyn Fn(usize) -> f64;

/// A contact law without its type. Every [`ContactLaw`] is one.
pub(crate) trait LawObject {
    /// Number of memory variables.
    fn memory(&self) -> usize;
    /// Speeds at which pieces of the law meet.
    fn breakpoints(&self) -> Vec<f64>;
    /// μ(r, z).
    fn coefficient(&self, slip: Slip<f64>, memory: Memory<'_>) -> f64;
    /// Replaces sliding speeds by μ(r, z), with direction and piece of `slip`; a speed below 0 by
    /// that at 0. The memory by the number of the speed, then by variable.
    fn values(&self, slip: Slip<()>, speeds: &mut [f64], memory: &dyn Fn(usize, usize) -> f64);
    /// μ_s(z) backward and forward; `None` for a law that never sticks, such as one without
    /// friction.
    fn limits(&self, memory: Memory<'_>) -> Option<[f64; 2]>;
    /// ∂μ_s/∂z_j of both; NaN for a law that never sticks.
    fn limit_slopes(&self, memory: &[f64], by: usize) -> [f64; 2];
    /// The change of variable j, from a memory of zeros, that changes μ_s or μ at r = 0 by 1;
    /// infinite if none does.
    fn memory_unit(&self, by: usize) -> f64;
    /// dz/dt under a load N: the number of each variable, and its rate.
    fn rates(
        &self,
        motion: Motion<f64>,
        load: f64,
        memory: Memory<'_>,
        take: &mut dyn FnMut(usize, f64),
    );
    /// See [`ContactLaw::creeps`].
    fn creeps(&self) -> bool;
    /// See [`ContactLaw::changes_while_open`].
    fn changes_while_open(&self) -> bool;
    /// The change of variable j that changes the friction of slip as a speed e times as high does:
    /// that of φ is a/b, whatever its value. 0 if there is none.
    fn unit_in_creep(&self, slip: Slip<f64>, memory: Memory<'_>, by: usize) -> f64;
    /// The memory after slip has ended in stick, or stick in slip.
    fn caught(&self, memory: &mut [f64]);
    /// Steady sliding under a load N; `None` if no memory is stationary.
    fn sliding(&self, slip: Slip<f64>, load: f64) -> Option<Sliding>;
    /// The law as one of the crate's own.
    fn named(&self) -> Option<NamedLaw>;
    /// The one coefficient of a law without memory for which μ_s = μ at every speed.
    fn constant(&self) -> Option<f64>;
    /// The law of slip in a direction without memory, for the series of one mass; then no memory
    /// changes in slip.
    fn dry_slip(&self, direction: f64) -> Option<&dyn Law>;

    /// The operations that give σμ in slip, then the rates of the memory, from the sliding speed
    /// and the memory, under a constant load N.
    fn record(
        &self,
        recorder: &mut Recorder,
        slip: Slip<f64>,
        load: f64,
        memory: Memory<'_>,
    ) -> Output;
    /// Coefficient k of σμ in slip, the slope ∂(σμ)/∂s at the start, and coefficient k of the rates
    /// of the memory. The speed is coefficient k of its series.
    fn slip_order(
        &self,
        tape: &mut Tape,
        k: usize,
        slip: Slip<f64>,
        memory: &mut MemoryOrder<'_>,
    ) -> (f64, f64);
    /// Coefficient k of μ_s in stick backward and forward, 0 for a law that never sticks, and of
    /// the rates.
    fn stick_order(&self, tape: &mut Tape, k: usize, memory: &mut MemoryOrder<'_>) -> [f64; 2];
    /// The series of the law along a motion under a load N, and of its derivative by one of its
    /// inputs.
    fn derivative(
        &self,
        motion: Motion<&PowerSeries>,
        load: &PowerSeries,
        memory: &[PowerSeries],
        by: Input,
    ) -> Derivative;
}

/// The series of a contact's memory, of which the law is given one order, and room for that order
/// of their rates.
pub(crate) struct MemoryOrder<'a> {
    /// Coefficient of the given order of the load N; not used without a memory.
    pub(crate) load: f64,
    pub(crate) series: &'a [PowerSeries],
    pub(crate) rates: &'a mut [f64],
}

/// Series of a law, and of its derivative by one input.
pub(crate) struct Derivative {
    /// μ in slip.
    pub(crate) coefficient: PowerSeries,
    /// The derivative of μ by the input.
    pub(crate) slope: PowerSeries,
    /// The derivatives of the rates of the memory.
    pub(crate) rates: Vec<PowerSeries>,
    /// True if the law depends on the input.
    pub(crate) depends: bool,
}

impl fmt::Debug for dyn LawObject + '_ {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.named() {
            Some(NamedLaw::Dry(law)) => law.fmt(f),
            Some(NamedLaw::Sided(law)) => law.fmt(f),
            Some(NamedLaw::Contact(law)) => law.fmt(f),
            Some(NamedLaw::TwoStates { rate_state }) => rate_state.fmt(f),
            None => f.write_str("a user's law"),
        }
    }
}

impl<L: ContactLaw> LawObject for L {
    fn memory(&self) -> usize {
        L::Memory::<f64>::COUNT
    }

    fn breakpoints(&self) -> Vec<f64> {
        ContactLaw::breakpoints(self).collect()
    }

    fn coefficient(&self, slip: Slip<f64>, memory: Memory<'_>) -> f64 {
        ContactLaw::coefficient(self, slip, Variables::from_fn(memory))
    }

    fn values(&self, slip: Slip<()>, speeds: &mut [f64], memory: &dyn Fn(usize, usize) -> f64) {
        for (i, value) in speeds.iter_mut().enumerate() {
            let slip = Slip {
                // The same as `f64::max`, but faster.
                speed: if *value > 0.0 { *value } else { 0.0 },
                direction: slip.direction,
                piece: slip.piece,
            };
            *value = ContactLaw::coefficient(self, slip, Variables::from_fn(|j| memory(i, j)));
        }
    }

    fn limits(&self, memory: Memory<'_>) -> Option<[f64; 2]> {
        let limits = ContactLaw::limits(self, 0.0, Variables::from_fn(memory));
        // Without friction nothing sticks.
        limits.filter(|_| ContactLaw::constant(self, Own) != Some(0.0))
    }

    fn limit_slopes(&self, memory: &[f64], by: usize) -> [f64; 2] {
        let inputs = along::<L, _>(|j| memory[j], Input::Memory(by));
        let limits = ContactLaw::limits(self, Dual::along(0.0, 0.0), inputs);
        limits.map_or([f64::NAN; 2], |limits| limits.map(Dual::derivative))
    }

    fn memory_unit(&self, by: usize) -> f64 {
        let inputs = along::<L, _>(|_| 0.0, Input::Memory(by));
        let limits = ContactLaw::limits(self, Dual::along(0.0, 0.0), inputs);
        let limits = limits.map_or([0.0; 2], |limits| limits.map(Dual::derivative));
        let coefficients = [-1.0, 1.0].map(|direction| {
            let slip = Slip {
                speed: Dual::along(0.0, 0.0),
                direction,
                piece: 0,
            };
            ContactLaw::coefficient(self, slip, inputs).derivative()
        });
        let slopes = limits.into_iter().chain(coefficients);
        slopes.map(f64::abs).fold(0.0, f64::max).recip()
    }

    fn rates(
        &self,
        motion: Motion<f64>,
        load: f64,
        memory: Memory<'_>,
        take: &mut dyn FnMut(usize, f64),
    ) {
        let rates = ContactLaw::rates(self, motion, load, Variables::from_fn(memory));
        for (j, rate) in rates.as_ref().iter().enumerate() {
            take(j, *rate);
        }
    }

    fn creeps(&self) -> bool {
        ContactLaw::creeps(self)
    }

    fn changes_while_open(&self) -> bool {
        ContactLaw::changes_while_open(self)
    }

    fn unit_in_creep(&self, slip: Slip<f64>, memory: Memory<'_>, by: usize) -> f64 {
        let slope = |by: Input| {
            let component = if by == Input::Speed { 1.0 } else { 0.0 };
            let slip = Slip {
                speed: Dual::along(slip.speed, component),
                direction: slip.direction,
                piece: slip.piece,
            };
            ContactLaw::coefficient(self, slip, along::<L, _>(memory, by)).derivative()
        };
        let unit = (slip.speed * slope(Input::Speed) / slope(Input::Memory(by))).abs();
        if unit.is_finite() { unit } else { 0.0 }
    }

    fn caught(&self, memory: &mut [f64]) {
        let caught = ContactLaw::caught(self, Variables::from_fn(|j| memory[j]));
        memory.copy_from_slice(caught.as_ref());
    }

    fn sliding(&self, slip: Slip<f64>, load: f64) -> Option<Sliding> {
        Sliding::of(self, slip, load)
    }

    fn named(&self) -> Option<NamedLaw> {
        ContactLaw::named(self)
    }

    fn constant(&self) -> Option<f64> {
        ContactLaw::constant(self, Own)
    }

    fn dry_slip(&self, direction: f64) -> Option<&dyn Law> {
        ContactLaw::dry_slip(self, direction).map(LawRef::law)
    }

    fn record(
        &self,
        recorder: &mut Recorder,
        slip: Slip<f64>,
        load: f64,
        memory: Memory<'_>,
    ) -> Output {
        let recorder = recorder.begin(L::Memory::<f64>::COUNT);
        let slip = Slip {
            speed: recorder.argument(slip.speed),
            direction: slip.direction,
            piece: slip.piece,
        };
        let memory = Variables::from_fn(|j| recorder.input(j, memory(j)));
        let load = slip.speed.constant(load);
        let (coefficient, rates) = self.coefficient_and_rates(slip, load, memory);
        for rate in rates.as_ref() {
            recorder.give_rate(*rate);
        }
        (coefficient * slip.direction).output()
    }

    fn slip_order(
        &self,
        tape: &mut Tape,
        k: usize,
        slip: Slip<f64>,
        memory: &mut MemoryOrder<'_>,
    ) -> (f64, f64) {
        let MemoryOrder {
            load,
            series,
            rates,
        } = memory;
        tape.run(k, |run| {
            let slip = Slip {
                speed: run.variable(slip.speed),
                direction: slip.direction,
                piece: slip.piece,
            };
            let memory: L::Memory<Jet<'_>> = Variables::from_fn(|j| run.input(series[j][k]));
            let load = if L::Memory::<f64>::COUNT > 0 {
                run.input(*load)
            } else {
                slip.speed
            };
            let (coefficient, found) = self.coefficient_and_rates(slip, load, memory);
            let coefficient = coefficient * slip.direction;
            for (rate, found) in std::iter::zip(&mut **rates, found.as_ref()) {
                *rate = found.coefficient();
            }
            (coefficient.coefficient(), coefficient.derivative())
        })
    }

    fn stick_order(&self, tape: &mut Tape, k: usize, memory: &mut MemoryOrder<'_>) -> [f64; 2] {
        let MemoryOrder {
            load,
            series,
            rates,
        } = memory;
        tape.run(k, |run| {
            let zero = run.input(0.0);
            let memory: L::Memory<Jet<'_>> = Variables::from_fn(|j| run.input(series[j][k]));
            let load = run.input(*load);
            let limits = ContactLaw::limits(self, zero, memory);
            let found = ContactLaw::rates(self, Motion::Stick, load, memory);
            for (rate, found) in std::iter::zip(&mut **rates, found.as_ref()) {
                *rate = found.coefficient();
            }
            limits.map_or([0.0; 2], |limits| limits.map(|limit| limit.coefficient()))
        })
    }

    fn derivative(
        &self,
        motion: Motion<&PowerSeries>,
        load: &PowerSeries,
        memory: &[PowerSeries],
        by: Input,
    ) -> Derivative {
        let memory = along::<L, _>(|j| memory[j], by);
        let load = Dual::along(*load, if by == Input::Load { 1.0 } else { 0.0 });
        let nothing = Dual::along(PowerSeries::ZERO, 0.0);
        let (coefficient, limit_depends, rates) = match motion {
            Motion::Slip(slip) => {
                let component = if by == Input::Speed {
                    slip.direction
                } else {
                    0.0
                };
                let slip = Slip {
                    speed: Dual::along(*slip.speed, component),
                    direction: slip.direction,
                    piece: slip.piece,
                };
                let (coefficient, rates) = self.coefficient_and_rates(slip, load, memory);
                (coefficient, false, rates)
            }
            Motion::Stick => {
                let limits = ContactLaw::limits(self, nothing, memory);
                let mut limits = limits.iter().flatten();
                let depends = limits.any(|limit| !matches!(limit.tangent, Tangent::Constant(0.0)));
                let rates = ContactLaw::rates(self, Motion::Stick, load, memory);
                (nothing, depends, rates)
            }
        };
        let slope = coefficient.derivative();
        let rates = rates.as_ref().iter().map(|rate| rate.derivative());
        let rates: Vec<_> = rates.collect();
        let varies = |series: &PowerSeries| series.first_nonzero().is_some();
        Derivative {
            coefficient: coefficient.value,
            depends: limit_depends || varies(&slope) || rates.iter().any(varies),
            slope,
            rates,
        }
    }
}

/// A memory as inputs of a law, with the tangent 1 for the input `by` if it is one of them.
fn along<L: ContactLaw, S: Scalar>(memory: impl Fn(usize) -> S, by: Input) -> L::Memory<Dual<S>> {
    Variables::from_fn(|j| {
        let component = if by == Input::Memory(j) { 1.0 } else { 0.0 };
        Dual::along(memory(j), component)
    })
}
