//! What is integrated: two systems from rest, and when their events come, to 25 digits.

use stick_slip::{Exponential, FrictionLaw, MassOnBelt, Polynomial, State};

/// Time that is simulated.
pub const DURATION: f64 = 1000.0;

/// Every motion starts from rest.
pub const REST: State = State::new(0.0, 0.0);

/// A system, and its events from rest.
#[derive(Clone, Copy)]
pub struct Set<L> {
    pub name: &'static str,
    pub system: MassOnBelt<L>,
    reference: Reference,
}

/// The first contact and release, then slip and stick in turn: every release is from the same
/// state.
#[derive(Clone, Copy)]
struct Reference {
    first_stick: i128,
    first_release: i128,
    slip: i128,
    stick: i128,
}

/// Times are integers in units of 1e-24, so that sums of them are exact.
const UNIT: i128 = 10_i128.pow(24);

/// The set of the paper's Fig. 5; its times are those of the crate's reference data.
pub fn polynomial() -> Set<Polynomial> {
    Set {
        name: "polynomial",
        system: Polynomial::new(0.4, 0.25, 0.5)
            .and_then(|law| MassOnBelt::new(law, 0.2))
            .and_then(|system| system.with_damping(0.05))
            .expect("the paper's parameters are valid"),
        reference: Reference {
            first_stick: 613_882_489_595_888_486_866_486,
            first_release: 2_207_698_831_593_030_388_312_598,
            slip: 5_169_862_999_532_133_977_881_022,
            stick: 1_629_558_444_940_023_626_973_190,
        },
    }
}

/// The exponential law on a slower belt; times by a Taylor series of order 60 in 60 decimal digits,
/// a program that gives all 25 digits of the times above as well.
pub fn exponential() -> Set<Exponential> {
    Set {
        name: "exponential",
        system: Exponential::new(0.4, 0.25, 0.3)
            .and_then(|law| MassOnBelt::new(law, 0.1))
            .and_then(|system| system.with_damping(0.05))
            .expect("the parameters are valid"),
        reference: Reference {
            first_stick: 259_546_552_706_689_462_038_792,
            first_release: 4_029_375_158_732_130_050_586_544,
            slip: 5_364_331_180_894_494_271_688_715,
            stick: 1_411_134_237_040_001_811_239_473,
        },
    }
}

impl<L: FrictionLaw> Set<L> {
    /// Cycles in [`DURATION`], for times per cycle.
    pub fn cycles(&self) -> f64 {
        let Reference { slip, stick, .. } = self.reference;
        (DURATION / ((slip + stick) as f64 / UNIT as f64)).floor()
    }

    /// Largest error of event times: sticks and releases in turn.
    ///
    /// # Panics
    ///
    /// If events are missing or too many.
    pub fn worst_error(&self, events: &[f64]) -> f64 {
        let Reference {
            first_stick,
            first_release,
            slip,
            stick,
        } = self.reference;
        let end = DURATION as i128 * UNIT;
        let period = slip + stick;
        let exact: Vec<i128> = (0..)
            .map(|cycle| cycle * period)
            .flat_map(|cycle| {
                // The phases from rest are shorter, those from the first release on repeat.
                let next = if cycle == 0 {
                    first_stick
                } else {
                    first_release + cycle - stick
                };
                [next, first_release + cycle]
            })
            .take_while(|&time| time < end)
            .collect();
        assert_eq!(events.len(), exact.len(), "number of events");
        events
            .iter()
            .zip(&exact)
            .map(|(&time, &exact)| {
                // Whole and fraction apart: the first difference is exact.
                ((time - (exact / UNIT) as f64) - (exact % UNIT) as f64 / UNIT as f64).abs()
            })
            .fold(0.0, f64::max)
    }
}
