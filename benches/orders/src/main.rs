//! What does one Taylor step cost by order, how far does it reach, and which order is the best at
//! which error?
//!
//! ```sh
//! RUSTFLAGS="-C target-cpu=native" benches/orders/run
//! ```
//!
//! The motions of the bench `peers`: two laws from rest over 1000 units of time, every event
//! against 25 digits. Each order takes part with the loosest tolerance with which, and with every
//! tighter one, its worst error stays within a bound; so times are compared at equal error.
//!
//! # What was found
//!
//! Time per cycle of the polynomial law in units of order 26, native build on a Zen 5 core, and the
//! time of a step:
//!
//! ```text
//! order          14     17     20     23     26     29
//! 1e-4         0.76   0.82   0.93   0.85   1      1.20
//! 1e-6         0.80   0.91   0.90   0.86   1      1.02
//! 1e-8         1.06   1.01   1.03   0.98   1      1.20
//! 1e-10        1.29   1.17   1.12   0.98   1      1.21
//! 1e-12        1.52   1.28   1.16   1.06   1      1.20
//! 2e-13        1.60    -     1.04   1.06   1      1.07
//! a step       0.49   0.65   0.74   0.84   1      1.22
//! ```
//!
//! Steps come in whole numbers a cycle, 4 to 8 at order 26, so a ratio may be off by a step. A
//! lower order for looser tolerances would save up to a quarter there and double what is compiled
//! for each law; there is one order.

// The peers use more of it.
#[allow(dead_code)]
#[path = "../../peers/src/set.rs"]
mod set;

use std::hint::black_box;
use std::time::{Duration, Instant};

// For `set`, which measures errors with the crate as it is.
extern crate order26 as stick_slip;

use set::{DURATION, REST, Set};
use stick_slip::{FrictionLaw, MassOnBelt};

/// Largest errors of an event time.
const BOUNDS: [f64; 6] = [1e-4, 1e-6, 1e-8, 1e-10, 1e-12, 2e-13];

const ROUNDS: usize = 40;

/// A system, by its parameters.
#[derive(Clone, Copy)]
struct Motion {
    law: Law,
    belt_velocity: f64,
    damping: f64,
}

/// What a law is made of.
#[derive(Clone, Copy)]
enum Law {
    Polynomial([f64; 3]),
    Exponential([f64; 3]),
}

/// One variant of the crate.
#[derive(Clone, Copy)]
struct Variant {
    order: usize,
    /// Runs from rest, adds the events to a list, and returns the number of slip steps.
    run: fn(Motion, f64, &mut Vec<f64>) -> usize,
}

macro_rules! variants {
    ($($name:ident $order:literal)*) => {
        $(mod $name {
            use super::{DURATION, Law, Motion, REST};
            use $name::{
                Error, Exponential, FrictionLaw, Integrator, MassOnBelt, Mode, Polynomial, State,
            };

            pub fn run(motion: Motion, tolerance: f64, events: &mut Vec<f64>) -> usize {
                match motion.law {
                    Law::Polynomial([a, b, c]) => {
                        on_belt(Polynomial::new(a, b, c), motion, tolerance, events)
                    }
                    Law::Exponential([a, b, c]) => {
                        on_belt(Exponential::new(a, b, c), motion, tolerance, events)
                    }
                }
            }

            fn on_belt<L: FrictionLaw>(
                law: Result<L, Error>,
                motion: Motion,
                tolerance: f64,
                events: &mut Vec<f64>,
            ) -> usize {
                let system = law
                    .and_then(|law| MassOnBelt::new(law, motion.belt_velocity))
                    .and_then(|system| system.with_damping(motion.damping))
                    .expect("valid parameters");
                let rest = State::new(REST.displacement, REST.velocity);
                let flow = Integrator::new()
                    .with_tolerance(tolerance)
                    .and_then(|integrator| integrator.flow(&system, rest))
                    .expect("valid settings");
                let mut steps = 0;
                for step in flow {
                    let step = step.expect("the motion goes on");
                    if step.end_time() >= DURATION {
                        break;
                    }
                    steps += usize::from(step.mode() != Mode::Stick);
                    events.extend(step.event().map(|event| event.time));
                }
                steps
            }
        })*
        const VARIANTS: &[Variant] = &[$(Variant { order: $order, run: $name::run }),*];
    };
}

variants! { order14 14 order17 17 order20 20 order23 23 order26 26 order29 29 }

fn main() {
    let set = set::polynomial();
    let law = set.system.law();
    let law = Law::Polynomial([
        law.static_coefficient(),
        law.minimum_coefficient(),
        law.minimum_velocity(),
    ]);
    compare(law, &set);
    let set = set::exponential();
    let law = set.system.law();
    let law = Law::Exponential([
        law.static_coefficient(),
        law.kinetic_coefficient(),
        law.stribeck_velocity(),
    ]);
    compare(law, &set);
}

/// A variant with the tolerance that it takes for a bound.
struct Contender {
    variant: Variant,
    tolerance: f64,
    least: Duration,
}

fn compare<L: FrictionLaw>(law: Law, set: &Set<MassOnBelt<L>>) {
    let motion = Motion {
        law,
        belt_velocity: set.system.belt_velocity(),
        damping: set.system.damping(),
    };
    for bound in BOUNDS {
        let mut contenders: Vec<_> = VARIANTS
            .iter()
            .filter_map(|&variant| {
                let tolerance = loosest(variant, motion, set, bound)?;
                let least = Duration::MAX;
                Some(Contender {
                    variant,
                    tolerance,
                    least,
                })
            })
            .collect();
        let mut events = Vec::new();
        for _ in 0..ROUNDS {
            for contender in &mut contenders {
                // Once to warm up.
                for _ in 0..2 {
                    events.clear();
                    let start = Instant::now();
                    black_box((contender.variant.run)(
                        motion,
                        contender.tolerance,
                        &mut events,
                    ));
                    contender.least = contender.least.min(start.elapsed());
                }
            }
        }
        print_table(motion, set, bound, &contenders);
    }
}

/// The loosest of 1/2, 1/4, 1/8, …, ε with which, and with all tighter ones, the events are within
/// `bound`; none where rounding is larger.
fn loosest<L: FrictionLaw>(
    variant: Variant,
    motion: Motion,
    set: &Set<MassOnBelt<L>>,
    bound: f64,
) -> Option<f64> {
    let mut events = Vec::new();
    (1..=52)
        .rev()
        .map(|bits| 0.5_f64.powi(bits))
        .take_while(|&tolerance| {
            events.clear();
            (variant.run)(motion, tolerance, &mut events);
            set.reference.worst_error(&events) <= bound
        })
        .last()
}

fn print_table<L: FrictionLaw>(
    motion: Motion,
    set: &Set<MassOnBelt<L>>,
    bound: f64,
    contenders: &[Contender],
) {
    let yardstick = contenders
        .iter()
        .find(|contender| contender.variant.order == 26)
        .expect("the order that the crate has");
    println!(
        "\n{} law, errors within {bound:e}\n{:>5}{:>11}{:>14}{:>11}{:>12}{:>7}",
        set.name, "order", "tolerance", "steps a cycle", "ns a step", "µs a cycle", "ratio"
    );
    for Contender {
        variant,
        tolerance,
        least,
    } in contenders
    {
        let steps = (variant.run)(motion, *tolerance, &mut Vec::new()) as f64;
        let seconds = least.as_secs_f64();
        println!(
            "{:>5}{tolerance:>11.1e}{:>14.2}{:>11.0}{:>12.2}{:>7.2}",
            variant.order,
            steps / set.reference.cycles(),
            1e9 * seconds / steps,
            1e6 * seconds / set.reference.cycles(),
            seconds / yardstick.least.as_secs_f64(),
        );
    }
}
