//! Formulas against numerics, as properties: each draws systems, and holds a family of `analysis`
//! against cycles that were found, or motions that were followed.
//!
//! | formulas | property |
//! |---|---|
//! | eigenvalues of steady sliding (any law) | [`small::eigenvalues`] |
//! | `stabilizing_damping` (any law) | [`small::stabilizing_damping`] |
//! | v_b1, `exponential::hopf_velocities` | [`small::hopf_velocities`] |
//! | `silencing_damping_everywhere`: polynomial, exponential | [`small::silencing_damping`] |
//! | A0, extremes, period, multiplier, harmonics: first to fourth order | [`weak::pure_slip`] |
//! | slow transient, Eq. 12 | [`weak::slow_transient`] |
//! | A1, T, stick and slip (Eqs. 16-18); first and second order | [`weak::stick_slip`] |
//! | `averaging::drift` (any law) | [`weak::averaged_drift`] |
//! | `averaging::cycles` (any law) | [`weak::averaged_cycles`] |
//! | `averaging::cycles` that overtake the belt: all fields | [`weak::averaged_crossing_cycles`] |
//! | `coulomb::stick_slip`, `largest_stick_slip_velocity` | [`exact::coulomb_cycles`] |
//! | `coulomb::silencing_damping` | [`exact::coulomb_silence`] |
//! | `coulomb::FreeVibration` | [`exact::free_vibration`] |
//! | `dwell`: both cycles, multipliers, fold, Gao's criterion | [`exact::dwell_cycles`] |
//! | `forced`: Den Hartog's motion without stops | [`exact::den_hartog`] |
//! | `forced::no_stop_limit` | [`exact::no_stop_limits`], [`exact::nearly_stopping`] |
//!
//! An error that is stated as O(xᵖ) is g(x)·xᵖ with a smooth g. Three values of g bound what the
//! parabola through them can become on the way to x = 0, by a factor that follows from their
//! places alone; a fourth, much smaller x has to keep to it. An error of lower order would have
//! grown, beside xᵖ, by a power of the distance. No constant is fitted to what was measured.
//!
//! Cases are the same in every run, others with `PROPTEST_RNG_SEED`; those that failed once are
//! kept in `tests/proptest-regressions`. `--nocapture` prints the largest part of each bound that
//! was used.

mod exact;
mod small;
mod weak;

use crate::common::{count, on_belt};
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::fmt::{Debug, Formatter};
use std::rc::Rc;

use proptest::prelude::*;
use proptest::sample::select;
use proptest::test_runner::{Config, FileFailurePersistence, RngSeed, TestRunner};
use stick_slip::{FrictionLaw, MassOnBelt};

use crate::common::any::Any;

type Verdict = Result<(), TestCaseError>;

/// How often each bound was looked at, and the largest part of it that was used.
#[derive(Default)]
struct Bounds(RefCell<BTreeMap<String, (u32, f64)>>);

impl Bounds {
    fn hold(&self, name: &str, error: f64, allowed: f64) -> Verdict {
        let used = error.abs() / allowed;
        let mut rows = self.0.borrow_mut();
        let row = rows.entry(name.to_owned()).or_default();
        *row = (row.0 + 1, row.1.max(used));
        prop_assert!(used <= 1.0, "{name}: {error:e}, allowed {allowed:e}");
        Ok(())
    }

    /// An error O(xᵖ) at four descending sizes x, each with its rounding error. The parabola is one
    /// in `node(x)`.
    fn order(
        &self,
        name: &str,
        p: f64,
        node: fn(f64) -> f64,
        sizes: &[f64],
        errors: &[(f64, f64)],
    ) -> Verdict {
        let [.., last] = *sizes else { unreachable!() };
        let nodes: Vec<f64> = sizes[..3].iter().map(|&x| node(x)).collect();
        let largest = errors[..3]
            .iter()
            .zip(sizes)
            .map(|((e, _), x)| e.abs() / x.powf(p));
        let bound = reach(&nodes) * largest.fold(0.0, f64::max);
        let (error, noise) = errors[3];
        self.hold(name, error, bound * last.powf(p) + 1e2 * noise)
    }
}

/// How many times larger than at its nodes a parabola can be between them and 0: Lebesgue's
/// constant, Σᵢ Πⱼ xⱼ/|xⱼ − xᵢ|.
fn reach(nodes: &[f64]) -> f64 {
    let weight = |&x: &f64| -> f64 {
        let others = nodes.iter().filter(|&&other| other != x);
        others.map(|other| other / (other - x).abs()).product()
    };
    nodes.iter().map(weight).sum()
}

/// Runs a property on 64 cases, or on 256.
fn check<S: Strategy + 'static>(
    cases: S,
    property: impl Fn(S::Value, &Bounds) -> Verdict + 'static,
) {
    check_some(count(64, 256), cases, property);
}

/// Runs a property. Every bound has to have been looked at in a quarter of the cases.
fn check_some<S: Strategy + 'static>(
    count: usize,
    cases: S,
    property: impl Fn(S::Value, &Bounds) -> Verdict + 'static,
) {
    let property = Rc::new(property);
    let case = move |values: S::Value| {
        let property = Rc::clone(&property);
        Case {
            values: format!("{values:?}"),
            holds: Box::new(move |bounds| property(values, bounds)),
        }
    };
    run(count, &cases.prop_map(case).boxed());
}

/// A property with the values to be tried: of one type, so that one runner is compiled.
struct Case {
    values: String,
    holds: Box<dyn FnOnce(&Bounds) -> Verdict>,
}

impl Debug for Case {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.values)
    }
}

fn run(count: usize, cases: &BoxedStrategy<Case>) {
    let mut config = Config {
        failure_persistence: Some(Box::new(FileFailurePersistence::Direct(
            "proptest-regressions/motions.txt",
        ))),
        max_shrink_iters: 2000,
        max_global_rejects: 10_000,
        ..Config::default()
    };
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = count as u32;
    }
    if config.rng_seed == RngSeed::Random {
        config.rng_seed = RngSeed::Fixed(1);
    }
    let (bounds, least) = (Bounds::default(), config.cases / 4);
    let outcome = TestRunner::new(config).run(cases, |case| (case.holds)(&bounds));
    for (name, (looks, used)) in bounds.0.borrow().iter() {
        println!("{name:<45} {looks:6} {used:9.2e}");
    }
    if let Err(error) = outcome {
        panic!("{error}");
    }
    let rows = bounds.0.borrow();
    assert!(rows.values().all(|&(looks, _)| looks >= least), "{rows:?}");
}

// Boxed, so that few types of strategies are compiled.

/// Uniform in the logarithm.
fn decades(low: f64, high: f64) -> BoxedStrategy<f64> {
    let exponents = low.log10()..high.log10();
    exponents.prop_map(|x: f64| 10.0_f64.powf(x)).boxed()
}

fn sign() -> BoxedStrategy<f64> {
    select(vec![1.0, -1.0]).boxed()
}

/// 0 in one case of eight.
fn or_zero(values: BoxedStrategy<f64>) -> BoxedStrategy<f64> {
    prop_oneof![1 => Just(0.0), 7 => values].boxed()
}

/// Any law of the crate or of the tests, with features 0.1 to 1 wide in speed.
fn any_law() -> BoxedStrategy<Any> {
    let sizes = (0.1..1.0, 0.0..1.0, 0.1..1.0, 0.0..1.0);
    let law =
        |(kind, (top, least, width, part))| Any::of_kind(kind, [top, least, width, part], 0.0);
    (0..Any::KINDS, sizes).prop_map(law).boxed()
}

fn system<L: FrictionLaw>(law: L, velocity: f64, damping: f64, load: f64) -> MassOnBelt<L> {
    on_belt(law, velocity, damping, load)
}
