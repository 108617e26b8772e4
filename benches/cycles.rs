//! What does an exact answer cost, beside simulating one period of the same motion?
//!
//! The set of the paper's Figs. 5 and 6: polynomial law, β = 0.05, γ² = 1; `simulated period` is
//! one slip and one stick phase at round-off through `flow`. Divide the others by it.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use stick_slip::limit_cycle::Attractor;
use stick_slip::{Integrator, MassOnBelt, Polynomial, State, Stribeck, bifurcation, limit_cycle};

fn paper() -> MassOnBelt<Polynomial> {
    Polynomial::new(0.4, 0.25, 0.5)
        .and_then(|law| MassOnBelt::new(law, 0.2))
        .and_then(|system| system.with_damping(0.05))
        .expect("the paper's parameters are valid")
}

fn cycles(criterion: &mut Criterion) {
    let system = paper();
    let mut group = criterion.benchmark_group("cycles");

    let start = system.release_state().expect("the belt moves");
    let mut flow = Integrator::new()
        .flow(&system, start)
        .expect("finite start");
    group.bench_function("simulated period", |bencher| {
        bencher.iter(|| {
            flow.by_ref()
                .filter(|step| matches!(step, Ok(step) if step.event().is_some()))
                .nth(1)
        });
    });
    group.bench_function("stick_slip", |bencher| {
        bencher.iter(|| limit_cycle::stick_slip(black_box(&system)));
    });
    group.bench_function("stick_slip, extremes and energies", |bencher| {
        bencher.iter(|| {
            let cycle = limit_cycle::stick_slip(black_box(&system)).ok().flatten();
            cycle.map(|cycle| (cycle.amplitude(), cycle.min_velocity(), cycle.energy()))
        });
    });
    group.bench_function("find", |bencher| {
        bencher.iter(|| limit_cycle::find(black_box(&system)));
    });
    let velocities: Vec<f64> = (0..1000).map(|i| 0.0005 * (f64::from(i) + 0.5)).collect();
    group.sample_size(20);
    group.bench_function("diagram of 1000 belt velocities", |bencher| {
        bencher.iter(|| {
            bifurcation::diagram(&system, &velocities)
                .filter(Result::is_ok)
                .count()
        });
    });
    #[cfg(feature = "rayon")]
    group.bench_function("diagram of 1000 belt velocities, all cores", |bencher| {
        bencher.iter(|| bifurcation::par_diagram(&system, &velocities).len());
    });
    group.finish();
}

/// Where 800 starts end, beside one period of the same system: μ̂ = 0.5 + 0.5 e^(−2s), β = 0.05,
/// v_b = 1.5, starts in [−2, 2] × [0, 2].
fn basins(criterion: &mut Criterion) {
    let system = Stribeck::new(1.0, 0.5, 0.5, 1)
        .and_then(|law| MassOnBelt::new(law, 1.5))
        .and_then(|system| system.with_damping(0.05))
        .expect("valid parameters");
    let mut group = criterion.benchmark_group("basins");
    let start = system.release_state().expect("the belt moves");
    let mut flow = Integrator::new()
        .flow(&system, start)
        .expect("finite start");
    group.bench_function("simulated period", |bencher| {
        bencher.iter(|| {
            flow.by_ref()
                .filter(|step| matches!(step, Ok(step) if step.event().is_some()))
                .nth(1)
        });
    });
    group.bench_function("basins", |bencher| {
        bencher
            .iter(|| limit_cycle::basins(black_box(&system)).map(|basins| basins.cycles().len()));
    });
    let basins = limit_cycle::basins(&system).expect("a quiet search");
    let grid = |i: i32, j: i32| State::new(-2.0 + 0.1 * f64::from(i), 0.1 * f64::from(j));
    group.bench_function("800 starts", |bencher| {
        bencher.iter(|| {
            let starts = (0..40).flat_map(|i| (0..20).map(move |j| grid(i, j)));
            starts
                .filter(|&start| basins.attractor(start) == Ok(Attractor::Equilibrium))
                .count()
        });
    });
    group.finish();
}

criterion_group!(benches, cycles, basins);
criterion_main!(benches);
