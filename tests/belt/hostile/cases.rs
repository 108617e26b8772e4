//! Systems and starts that look for trouble: every law, parameters over many decades, starts on and
//! an ulp beside every boundary.

use crate::common::on_belt;
use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::{Config, FileFailurePersistence, RngSeed, TestRunner};
use stick_slip::{Error, FrictionLaw, Integrator, MassOnBelt, Mode, State, Step};

use crate::common::any::Any;

/// A motion to be followed.
#[derive(Debug, Clone)]
pub(crate) struct Case {
    pub(crate) system: MassOnBelt<Any>,
    pub(crate) start: State,
    pub(crate) duration: f64,
}

/// Steps after which a motion is given up: stiff systems need any number.
pub(crate) const MOST_STEPS: usize = 3000;

impl Case {
    /// The steps up to the end, and the error that came instead of the end.
    pub(crate) fn run(&self) -> (Vec<Step>, Option<Error>) {
        let mut steps = Vec::new();
        let integrator = Integrator::new().with_max_steps(MOST_STEPS).unwrap();
        let flow = match integrator.flow(&self.system, self.start) {
            Ok(flow) => flow,
            Err(error) => return (steps, Some(error)),
        };
        for step in flow {
            match step {
                Ok(step) => steps.push(step),
                Err(error) => return (steps, Some(error)),
            }
            if steps.last().is_some_and(|s| s.end_time() > self.duration) {
                break;
            }
        }
        (steps, None)
    }

    /// (u, v, v_b) → (−u, −v, −v_b).
    pub(crate) fn mirrored(&self) -> Self {
        let Self {
            system,
            start,
            duration,
        } = self.clone();
        let v_b = -system.belt_velocity();
        Self {
            system: system.with_belt_velocity(v_b).unwrap(),
            start: State::new(-start.displacement, -start.velocity),
            duration,
        }
    }

    /// max(|u − ū|, |v|, |v_b|): the size of the motion, by which tolerances are measured where
    /// nothing is stiff and ū not far beyond all that happens.
    pub(crate) fn scale(&self, state: State) -> f64 {
        let v_b = self.system.belt_velocity();
        let centre = self.system.load() * self.system.law().coefficient(v_b);
        (state.displacement - centre)
            .abs()
            .max(state.velocity.abs())
            .max(v_b.abs())
    }
}

/// The power series of the sliding speed over a step.
pub(crate) fn series(step: &Step) -> Vec<f64> {
    step.speed_coefficients().to_vec()
}

/// Σ |c_k| h^k: the size of a series over a step, by which its rounding errors are measured.
pub(crate) fn magnitude(series: &[f64], h: f64) -> f64 {
    series.iter().rev().fold(0.0, |sum, c| sum * h + c.abs())
}

/// Σ c_k t^k.
pub(crate) fn value(series: &[f64], t: f64) -> f64 {
    series.iter().rev().fold(0.0, |sum, c| sum * t + c)
}

/// The σ of a slip step.
pub(crate) fn sigma(step: &Step) -> Option<f64> {
    match step.mode() {
        Mode::Stick | Mode::Open => None,
        Mode::Slip(direction) => Some(direction.sign()),
    }
}

/// Uniform in the logarithm.
fn decades(low: f64, high: f64) -> impl Strategy<Value = f64> + Clone {
    (low.log10()..high.log10()).prop_map(|x: f64| 10.0_f64.powf(x))
}

/// A number between 0 and 1, the ends often.
fn part() -> impl Strategy<Value = f64> + Clone {
    prop_oneof![1 => Just(0.0), 1 => Just(1.0), 6 => 0.0..1.0]
}

fn law() -> impl Strategy<Value = Any> {
    let sizes = (decades(1e-2, 10.0), part(), decades(1e-4, 1e2), part());
    (select(vec![0, 1, 2, 3, 4, 4, 5, 6, 7, 8, 9]), sizes).prop_map(
        |(kind, (top, least, width, part))| Any::of_kind(kind, [top, least, width, part], 0.01),
    )
}

fn system() -> impl Strategy<Value = MassOnBelt<Any>> {
    let belt_velocity = prop_oneof![
        1 => Just(0.0),
        9 => (decades(1e-9, 1e3), select(vec![1.0, -1.0])).prop_map(|(v_b, sign)| sign * v_b),
    ];
    let damping = prop_oneof![1 => Just(0.0), 6 => decades(1e-6, 10.0)];
    (law(), belt_velocity, damping, decades(1e-6, 1e4))
        .prop_map(|(law, v_b, damping, load)| on_belt(law, v_b, damping, load))
}

/// So many ulps beside x.
fn beside(x: f64, ulps: i32) -> f64 {
    (0..ulps.abs()).fold(x, |x, _| if ulps > 0 { x.next_up() } else { x.next_down() })
}

/// Where a start lies: see [`start`].
type Place = (usize, [f64; 2], f64, [i32; 2]);

fn start(system: &MassOnBelt<Any>, (kind, [x, y], far, ulps): Place) -> State {
    let v_b = system.belt_velocity();
    let [low, high] = system.stick_limits();
    let size = v_b.abs() + system.load() * system.law().static_coefficient();
    let centre = system.load() * system.law().coefficient(v_b);
    let near = |u: f64, v: f64| State::new(beside(u, ulps[0]), beside(v, ulps[1]));
    let breakpoint = system.law().breakpoints().next().unwrap_or(v_b);
    match kind {
        // On the ends of the stick band, the release point among them.
        0 => near(low, v_b),
        1 => near(high, v_b),
        // As fast as the belt.
        2 => near(x * size, v_b),
        // On the equilibrium, and near it.
        3 => near(centre, 0.0),
        4 => State::new(centre + 1e-3 * x * v_b, 1e-3 * y * v_b),
        // Far outside.
        5 => State::new(far * x * size, far * y * size),
        // On a breakpoint of the law, above or below the belt.
        6 => near(x * size, v_b + y.signum() * breakpoint),
        _ => State::new(x * size, y * size),
    }
}

/// Every system, every start.
pub(crate) fn case() -> impl Strategy<Value = Case> {
    let place = (
        0..10_usize,
        [-1.0..1.0, -1.0..1.0],
        decades(1.0, 1e3),
        [-2..3, -2..3],
    );
    (system(), place, decades(1e-2, 30.0)).prop_map(|(system, place, duration)| Case {
        start: start(&system, place),
        system,
        duration,
    })
}

/// Runs a property on so many cases: the same ones in every run, others with `PROPTEST_RNG_SEED`,
/// more with `PROPTEST_CASES`.
pub(crate) fn check(cases: usize, property: impl Fn(Case) -> Result<(), TestCaseError>) {
    // One runner is compiled, not one for each property.
    run(cases, &property);
}

fn run(cases: usize, property: &dyn Fn(Case) -> Result<(), TestCaseError>) {
    let mut config = Config {
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct(
            "proptest-regressions/hostile.txt",
        ))),
        max_shrink_iters: 2000,
        ..Config::default()
    };
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = cases as u32;
    }
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(1);
    }
    if let Err(error) = TestRunner::new(config).run(&case(), property) {
        panic!("{error}");
    }
}
