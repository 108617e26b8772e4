//! What does a simulated cycle cost: by law, by tolerance, with no contact in sight, and step by
//! step?
//!
//! `cycle`: slip and stick of the stick-slip motion, through `flow`, at round-off. `custom` is the
//! cubic of `polynomial`, written here as a user would write it: a law of one's own is to cost what
//! a built-in one does, within a twentieth. The ratios between laws that are printed first are from
//! runs in turn; β = 0.05 and γ² = 1 everywhere.
//!
//! `tolerance`: the cycle of the polynomial law again.
//!
//! `watching`: one period of pure slip, in which no contact comes and each step has to make sure of
//! that: far from the belt's velocity, where a bound of the series settles it, and near it, where
//! the shape of the sliding speed has to be looked at. A cycle of `cycle` slips for 5.2 of its 6.8
//! units of time, these for all of their 6.3.
//!
//! `step`: one Taylor step of the slip phases of the same cycles. There is one order, 26,
//! compared with others at `TERMS` in `src/series/mod.rs`.
//!
//! # Where the time of a step goes
//!
//! Clock cycles on a Zen 5 core, polynomial law, native build, 670 in all: the series 430; the
//! defect at four places 75; the bound that says that no contact comes 35; the rest is waiting:
//! step length from the last coefficients, speed and displacement at the end from the step length,
//! and only then the next series.
//!
//! * It is latency, not arithmetic: replacing multiply-adds by fewer, or halving the loads, changed
//!   nothing; 4 cycles more on the way from one coefficient to the next cost 110 a step. So what
//!   arrives last goes in last: the friction's share after the spring's and the damper's, 25.
//! * The length of the next step by whole numbers, without a division: 20.
//! * Copies cost most. A point copied as a whole just after it was stored in parts waits until the
//!   stores have left the core: 90 cycles a step.
//! * Sums of products from the middle outwards, in two chains instead of three: nothing in a native
//!   build, 15 % in the default one.
//! * Four chains instead of two when the speed is evaluated: 3 %. Nine instead of three for the
//!   displacement: nothing.
//! * A contact takes 400 cycles, three passes of Newton's method.
//! * The closest approach of a step by the contact finder, which would isolate it, instead of a few
//!   passes of Newton's method: 4 % more a step, 9 % in pure slip.
//! * A default build asks the processor for fused multiply-adds (`src/scalar/fused.rs`), for the
//!   series alone, and takes 1.05 to 1.1 times as long as a native one. Without that it took 1.26
//!   times as long: one half because a sum and a product are two instructions, the other because
//!   these then overwrite one of their operands, which has to be copied before.
//! * For this the series and the rows it is computed from have to lie in one object, and the law
//!   has to be one of two references that are handed over: else the compiler cannot know that they
//!   do not overlap, loads anew what it has stored, and a third of the gain is left.
//! * The law behind a trait object, which a step asks twice, instead of as a type: 1 %. It was 4 %
//!   as long as the phase that follows a step was handed on as a value, and the step copied twice.
//! * The same source varies by 4 % with where the compiler puts it; less than that was not pursued.
//!   The same program takes a fifth to a third longer while a neighbour is busy on the same core,
//!   for fractions of a second: least times of many compare, means do not.

use std::hint::black_box;
use std::time::{Duration, Instant};

use criterion::{
    BenchmarkGroup, Criterion, criterion_group, criterion_main, measurement::WallTime,
};
use stick_slip::{
    Coulomb, Exponential, Flow, FrictionLaw, Integrator, MassOnBelt, Mode, Polynomial, Rational,
    Scalar, State, Stribeck, Tabulated, limit_cycle,
};

/// The cubic law as a user's own.
#[derive(Clone, Copy)]
struct Cubic {
    static_coefficient: f64,
    k1: f64,
    k3: f64,
}

impl FrictionLaw for Cubic {
    fn static_coefficient(&self) -> f64 {
        self.static_coefficient
    }
    #[inline(always)]
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        (speed.square() * self.k3 - self.k1) * speed + self.static_coefficient
    }
}

const CUBIC: Cubic = Cubic {
    static_coefficient: 0.4,
    k1: 0.45,
    k3: 0.6,
};

/// The law on a belt, with the damping of the paper's Fig. 5.
fn on_belt<L: FrictionLaw>(law: Result<L, stick_slip::Error>, belt_velocity: f64) -> MassOnBelt<L> {
    law.and_then(|law| MassOnBelt::new(law, belt_velocity))
        .and_then(|system| system.with_damping(0.05))
        .expect("valid parameters")
}

/// The set of the paper's Fig. 5.
fn paper(belt_velocity: f64) -> MassOnBelt<Polynomial> {
    on_belt(Polynomial::new(0.4, 0.25, 0.5), belt_velocity)
}

/// The paper's law, measured at eleven speeds.
fn measured() -> Result<Tabulated, stick_slip::Error> {
    let law = Polynomial::new(0.4, 0.25, 0.5)?;
    Tabulated::new((0..=10).map(|i| {
        let speed = 0.1 * f64::from(i);
        (speed, law.kinetic(speed))
    }))
}

/// The motion of a system of which the compiler knows no number.
fn flow<L: FrictionLaw>(system: &MassOnBelt<L>, start: State, tolerance: f64) -> Flow<'_, L> {
    Integrator::new()
        .with_tolerance(tolerance)
        .and_then(|integrator| integrator.flow(black_box(system), black_box(start)))
        .expect("valid settings")
}

/// The release state, from which the motion comes back to it.
fn release<L: FrictionLaw>(system: &MassOnBelt<L>) -> State {
    let cycle = limit_cycle::stick_slip(system).ok().flatten();
    cycle.expect("a stick-slip cycle").state()
}

/// Something to be timed, once a call.
type Work<'s> = (String, Box<dyn FnMut() + 's>);

/// One slip and one stick phase of the motion from release.
fn cycle<L: FrictionLaw>(
    name: impl Into<String>,
    system: &MassOnBelt<L>,
    tolerance: f64,
) -> Work<'_> {
    let mut flow = flow(system, release(system), tolerance);
    let work = move || {
        let end = flow
            .by_ref()
            .filter(|step| matches!(step, Ok(step) if step.event().is_some()))
            .nth(1);
        black_box(&end);
    };
    (name.into(), Box::new(work))
}

/// Least times of all in turn, as ratios to the first: what Criterion measures one after the other
/// does not compare to within a twentieth on a busy machine.
fn print_ratios(title: &str, works: &mut [Work<'_>]) {
    const ROUNDS: usize = 1000;
    const CALLS: u32 = 50;
    let mut least = vec![Duration::MAX; works.len()];
    for _ in 0..ROUNDS {
        for ((_, work), least) in works.iter_mut().zip(&mut least) {
            let start = Instant::now();
            (0..CALLS).for_each(|_| work());
            *least = start.elapsed().min(*least);
        }
    }
    println!("\n{title}, least of {ROUNDS} in turn");
    for ((name, _), time) in works.iter().zip(&least) {
        let microseconds = 1e6 * time.as_secs_f64() / f64::from(CALLS);
        let ratio = time.as_secs_f64() / least[0].as_secs_f64();
        println!("{name:12}{microseconds:>8.3} µs{ratio:>8.3}");
    }
    println!();
}

/// The ratios first, then a report of each.
fn compare(criterion: &mut Criterion, title: &str, mut works: Vec<Work<'_>>) {
    print_ratios(title, &mut works);
    let mut group = criterion.benchmark_group(title);
    for (name, work) in &mut works {
        group.bench_function(name.as_str(), |bencher| bencher.iter(&mut *work));
    }
    group.finish();
}

/// One step of slip: the time of whole cycles over the number of their slip steps. Stick, a closed
/// formula, is in it.
fn step<L: FrictionLaw>(
    group: &mut BenchmarkGroup<'_, WallTime>,
    name: &str,
    system: &MassOnBelt<L>,
) {
    let mut flow = flow(system, release(system), Integrator::ROUND_OFF);
    group.bench_function(name, |bencher| {
        bencher.iter_custom(|steps| {
            let start = Instant::now();
            flow.by_ref()
                .filter(|step| matches!(step, Ok(step) if step.mode() != Mode::Stick))
                .take(steps.try_into().unwrap_or(usize::MAX))
                .for_each(|step| {
                    black_box(&step);
                });
            start.elapsed()
        });
    });
}

/// One period of the pure-slip cycle at a belt velocity.
fn watching(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, belt_velocity: f64) {
    let system = paper(belt_velocity);
    let cycles = limit_cycle::find(&system).expect("a quiet search");
    let cycle = cycles.stable().next().expect("a pure-slip cycle");
    assert_eq!(cycle.kind(), stick_slip::CycleKind::PureSlip);
    group.bench_function(name, |bencher| {
        bencher.iter_custom(|periods| {
            let end = cycle.period() * periods as f64;
            let start = Instant::now();
            flow(&system, cycle.state(), Integrator::ROUND_OFF)
                .take_while(|step| matches!(step, Ok(step) if step.end_time() < end))
                .for_each(|step| {
                    black_box(&step);
                });
            start.elapsed()
        });
    });
}

fn integrator(criterion: &mut Criterion) {
    let polynomial = paper(0.2);
    let custom = on_belt(Ok(CUBIC), 0.2);
    let exponential = on_belt(Exponential::new(0.4, 0.25, 0.3), 0.1);
    let stribeck = on_belt(Stribeck::new(0.4, 0.25, 0.3, 1), 0.1);
    let rational = on_belt(Rational::new(0.4, 3.0), 0.1);
    let tabulated = on_belt(measured(), 0.2);
    let coulomb = on_belt(Coulomb::new(0.4, 0.25), 0.1);
    let round_off = Integrator::ROUND_OFF;

    let laws = vec![
        cycle("polynomial", &polynomial, round_off),
        cycle("custom", &custom, round_off),
        cycle("exponential", &exponential, round_off),
        cycle("Stribeck", &stribeck, round_off),
        cycle("rational", &rational, round_off),
        cycle("tabulated", &tabulated, round_off),
        cycle("Coulomb", &coulomb, round_off),
    ];
    compare(criterion, "cycle", laws);

    let tolerances = [round_off, 1e-12, 1e-9, 1e-6]
        .map(|tolerance| cycle(format!("{tolerance:e}"), &polynomial, tolerance));
    compare(criterion, "tolerance", tolerances.into());

    let mut group = criterion.benchmark_group("watching");
    watching(&mut group, "far", 0.435);
    watching(&mut group, "near", 0.4071);
    group.finish();

    let mut group = criterion.benchmark_group("step");
    step(&mut group, "polynomial", &polynomial);
    step(&mut group, "custom", &custom);
    step(&mut group, "exponential", &exponential);
    step(&mut group, "Stribeck", &stribeck);
    step(&mut group, "rational", &rational);
    step(&mut group, "tabulated", &tabulated);
    step(&mut group, "Coulomb", &coulomb);
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    targets = integrator
}
criterion_main!(benches);
