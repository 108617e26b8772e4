//! What does an estimate cost, beside the exact answers of the bench `cycles`?
//!
//! The set of the paper's Fig. 5, with pure slip at v_b = 0.42, and the exponential law at v_b =
//! 0.1. A formula is closed (tens of nanoseconds), or has an equation to solve or an integral in it
//! (microseconds); averaging searches all amplitudes for its cycles.

use std::hint::black_box;
use std::time::Duration;

use criterion::{Criterion, criterion_group, criterion_main};
use stick_slip::analysis::{PureSlip, StickSlip, averaging, design, equilibrium, regime};
use stick_slip::{Exponential, FrictionLaw, MassOnBelt, Polynomial};

fn on_belt<L: FrictionLaw>(law: Result<L, stick_slip::Error>, belt_velocity: f64) -> MassOnBelt<L> {
    law.and_then(|law| MassOnBelt::new(law, belt_velocity))
        .and_then(|system| system.with_damping(0.05))
        .expect("valid parameters")
}

fn formulas(criterion: &mut Criterion) {
    let slow = on_belt(Polynomial::new(0.4, 0.25, 0.5), 0.2);
    let fast = on_belt(Polynomial::new(0.4, 0.25, 0.5), 0.42);
    let exponential = on_belt(Exponential::new(0.4, 0.25, 0.3), 0.1);

    let mut group = criterion.benchmark_group("formulas");
    group.bench_function("equilibrium", |bencher| {
        bencher.iter(|| equilibrium(black_box(&slow)));
    });
    group.bench_function("regime", |bencher| {
        bencher.iter(|| regime(black_box(&slow)));
    });
    group.bench_function("pure slip, fourth order", |bencher| {
        bencher
            .iter(|| PureSlip::new(black_box(&fast)).and_then(|formulas| formulas.fourth_order()));
    });
    group.bench_function("stick-slip, second order", |bencher| {
        bencher
            .iter(|| StickSlip::new(black_box(&slow)).and_then(|formulas| formulas.second_order()));
    });
    group.bench_function("stick-slip, any law", |bencher| {
        bencher.iter(|| StickSlip::new(black_box(&exponential)).map(|formulas| formulas.period()));
    });
    group.bench_function("least damping over a range", |bencher| {
        bencher.iter(|| design::stabilizing_damping_over(black_box(&exponential), 0.0..2.0));
    });
    group.finish();

    let mut group = criterion.benchmark_group("averaging");
    group.bench_function("drift, polynomial", |bencher| {
        bencher.iter(|| averaging::drift(black_box(&fast), 0.3));
    });
    group.bench_function("drift, exponential", |bencher| {
        bencher.iter(|| averaging::drift(black_box(&exponential), 0.3));
    });
    group.bench_function("cycles, polynomial", |bencher| {
        bencher.iter(|| averaging::cycles(black_box(&fast)));
    });
    group.bench_function("cycles, exponential", |bencher| {
        bencher.iter(|| averaging::cycles(black_box(&exponential)));
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default()
        .warm_up_time(Duration::from_millis(500))
        .measurement_time(Duration::from_secs(2));
    targets = formulas
}
criterion_main!(benches);
