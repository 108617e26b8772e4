//! What is integrated: systems, and when their events come, to 25 digits.

use stick_slip::{
    Contact, Exponential, MassOnBelt, Polynomial, State, Structure, System, structure,
};

/// Time that is simulated.
pub const DURATION: f64 = 1000.0;

/// Where one mass starts.
pub const REST: State = State::new(0.0, 0.0);

/// A system, where it starts, and its events from there.
pub struct Set<S: System> {
    pub name: &'static str,
    pub system: S,
    pub start: S::State,
    pub reference: Reference,
}

/// When the events come: some once, then the same again and again.
pub struct Reference {
    once: Vec<i128>,
    first_cycle: Vec<i128>,
    period: i128,
}

/// Times are integers in units of 1e-24, so that sums of them are exact.
const UNIT: i128 = 10_i128.pow(24);

/// The set of the paper's Fig. 5; its times are those of the crate's reference data.
pub fn polynomial() -> Set<MassOnBelt<Polynomial>> {
    Set {
        name: "polynomial law",
        system: Polynomial::new(0.4, 0.25, 0.5)
            .and_then(|law| MassOnBelt::new(law, 0.2))
            .and_then(|system| system.with_damping(0.05))
            .expect("the paper's parameters are valid"),
        start: REST,
        reference: Reference::from_rest(
            [
                613_882_489_595_888_486_866_486,
                2_207_698_831_593_030_388_312_598,
            ],
            5_169_862_999_532_133_977_881_022,
            1_629_558_444_940_023_626_973_190,
        ),
    }
}

/// The exponential law on a slower belt; times by a Taylor series of order 60 in 60 decimal digits,
/// a program that gives all 25 digits of the times above as well.
pub fn exponential() -> Set<MassOnBelt<Exponential>> {
    Set {
        name: "exponential law",
        system: Exponential::new(0.4, 0.25, 0.3)
            .and_then(|law| MassOnBelt::new(law, 0.1))
            .and_then(|system| system.with_damping(0.05))
            .expect("the parameters are valid"),
        start: REST,
        reference: Reference::from_rest(
            [
                259_546_552_706_689_462_038_792,
                4_029_375_158_732_130_050_586_544,
            ],
            5_364_331_180_894_494_271_688_715,
            1_411_134_237_040_001_811_239_473,
        ),
    }
}

/// Two blocks with exponential laws, on the limit cycle that attracts them: each sticks and is let
/// go once a period, the one while the other slips. That the start is rounded puts the events off
/// by less than 1e-15. Start and times are those of the crate's reference data.
pub fn two_blocks() -> Set<Structure> {
    let laws = laws_of_blocks();
    let system = || {
        Structure::new(&[1.0, 1.0])?
            .with_ground_spring(0, 1.0)?
            .with_ground_spring(1, 1.0)?
            .with_ground_damper(0, 0.05)?
            .with_ground_damper(1, 0.05)?
            .with_spring(0, 1, 0.5)?
            .with_contact(Contact::new(0, laws[0], 1.0)?.on_belt(0.15))?
            .with_contact(Contact::new(1, laws[1], 1.4)?.on_belt(0.15))
    };
    Set {
        name: "two blocks, exponential law",
        system: system().expect("the parameters are valid"),
        start: structure::State::new(
            &[0.523_660_590_383_745_1, 0.233_890_518_299_209_98],
            &[0.140_353_859_793_521_73, -0.132_503_073_222_260_2],
        ),
        reference: Reference {
            once: Vec::new(),
            first_cycle: vec![
                508_293_215_527_993_490_415_401,
                2_547_609_415_828_917_893_598_680,
                3_392_906_458_578_959_572_403_559,
                5_504_332_522_897_116_729_048_316,
            ],
            period: 5_750_688_912_863_576_733_684_439,
        },
    }
}

/// The laws of the two blocks.
pub fn laws_of_blocks() -> [Exponential; 2] {
    [(0.6, 0.3, 0.2), (0.5, 0.25, 0.3)].map(|(top, low, speed)| {
        Exponential::new(top, low, speed).expect("the parameters are valid")
    })
}

impl Reference {
    /// One mass from rest: its first contact and release, then slip and stick in turn. Every
    /// release is from the same state.
    fn from_rest(first: [i128; 2], slip: i128, stick: i128) -> Self {
        let [_, release] = first;
        let period = slip + stick;
        Self {
            once: first.to_vec(),
            first_cycle: vec![release + slip, release + period],
            period,
        }
    }

    /// Cycles in [`DURATION`], for times per cycle.
    pub fn cycles(&self) -> f64 {
        (DURATION / (self.period as f64 / UNIT as f64)).floor()
    }

    /// Largest error of event times.
    ///
    /// # Panics
    ///
    /// If events are missing or too many.
    pub fn worst_error(&self, events: &[f64]) -> f64 {
        let end = DURATION as i128 * UNIT;
        let again = (0..).flat_map(|cycle| {
            let first_cycle = self.first_cycle.iter();
            first_cycle.map(move |&time| time + cycle * self.period)
        });
        let once = self.once.iter().copied();
        let exact: Vec<i128> = once.chain(again).take_while(|&time| time < end).collect();
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
