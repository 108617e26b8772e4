//! How much work is how much precision, beside the integrators that a user could pick instead?
//!
//! ```sh
//! RUSTFLAGS="-C target-cpu=native" cargo bench --manifest-path benches/peers/Cargo.toml
//! ```
//!
//! One mass from rest, with two laws, and two blocks joined by a spring, over 1000 units of time:
//! some 150 cycles of slip and stick, with every event. Each solver writes its event times into the
//! same list; their largest error is taken against 25-digit references. Then the times are taken
//! in turn, one run of every solver a round, and the table gives for each the least and the median
//! time per cycle, and the ratio of the least to that of Dop853 of `ode_solvers`, which varies less
//! between machines than times do. Criterion's report of the same runs follows.
//!
//! The columns are the peers' absolute and relative tolerances 1e-9, 1e-12 and 1e-14. This crate
//! joins each with the loosest of 1e-8, 5e-9, 2e-9, 1e-9, … with which its worst error stays within
//! a bound. For one mass the bounds are 2e-9, 4e-12 and 2e-13, what heyoka, a compiling Taylor
//! integrator in C++, reaches in the same places; for two blocks they are the errors of Dop853.
//!
//! What the peers are given: one phase after the other in u and v − v_b, a compensated clock, no
//! output beyond what they insist on, and for the events the best that each has; each file says
//! what. Of one mass they integrate slip only, stick is in closed form.

mod blocks;
mod dop853;
mod phases;
mod rkv989e;
mod set;
mod tsit45;

use std::hint::black_box;
use std::time::{Duration, Instant};

use blocks::Blocks;
use criterion::{BenchmarkId, Criterion, Throughput};
use phases::Slip;
use set::{DURATION, Set};
use stick_slip::{FrictionLaw, Integrator, MassOnBelt, Segment, Structure, System};

/// Tolerances of the peers.
const TOLERANCES: [f64; 3] = [1e-9, 1e-12, 1e-14];

/// The largest error of this crate beside them, for one mass.
const BOUNDS: [f64; 3] = [2e-9, 4e-12, 2e-13];

/// The place of the solver in a column to which the others are compared.
const YARDSTICK: usize = 1;

const ROUNDS: usize = 60;

/// A run from the start, which adds its events to a list.
type Run<'s> = Box<dyn FnMut(&mut Vec<f64>) + 's>;

/// Dop853, rkv989e and tsit45 with one tolerance.
type Peers<'s> = [Run<'s>; 3];

/// One solver with one setting.
struct Contender<'s> {
    solver: &'static str,
    tolerance: f64,
    run: Run<'s>,
}

fn main() {
    let mut criterion = Criterion::default()
        .sample_size(10)
        .warm_up_time(Duration::from_millis(200))
        .measurement_time(Duration::from_millis(500))
        .configure_from_args();
    one_mass(&mut criterion, &set::polynomial());
    one_mass(&mut criterion, &set::exponential());
    two_blocks(&mut criterion, &set::two_blocks(), set::laws_of_blocks());
    criterion.final_summary();
}

fn one_mass<L: FrictionLaw + Copy + 'static>(criterion: &mut Criterion, set: &Set<MassOnBelt<L>>) {
    let slip = Slip::new(set);
    compare(criterion, set, Some(BOUNDS), |tolerance| {
        let mut dop853 = dop853::contact(slip, tolerance);
        let mut rkv989e = rkv989e::contact(slip, tolerance);
        let mut tsit45 = tsit45::contact(slip, tolerance);
        [
            Box::new(move |events| phases::run(set, events, &mut dop853)),
            Box::new(move |events| phases::run(set, events, &mut rkv989e)),
            Box::new(move |events| phases::run(set, events, &mut tsit45)),
        ]
    });
}

fn two_blocks<L: FrictionLaw + Copy + 'static>(
    criterion: &mut Criterion,
    set: &Set<Structure>,
    laws: [L; 2],
) {
    let blocks = Blocks::new(&set.system, laws);
    compare(criterion, set, None, |tolerance| {
        let mut dop853 = dop853::end(tolerance);
        let mut rkv989e = rkv989e::end(tolerance);
        let mut tsit45 = tsit45::end(blocks, tolerance);
        [
            Box::new(move |events| blocks::run(set, blocks, events, &mut dop853)),
            Box::new(move |events| blocks::run(set, blocks, events, &mut rkv989e)),
            Box::new(move |events| blocks::run(set, blocks, events, &mut tsit45)),
        ]
    });
}

/// Without bounds, this crate's errors are to be within those of Dop853.
fn compare<'s, S: System>(
    criterion: &mut Criterion,
    set: &'s Set<S>,
    bounds: Option<[f64; 3]>,
    peers: impl Fn(f64) -> Peers<'s>,
) {
    let mut columns = [0, 1, 2].map(|place| {
        let tolerance = TOLERANCES[place];
        let [mut dop853, rkv989e, tsit45] = peers(tolerance);
        let bound = bounds.map_or_else(|| worst_error(set, &mut dop853), |bounds| bounds[place]);
        let within = loosest(set, bound);
        [
            Contender {
                solver: "stick-slip",
                tolerance: within,
                run: Box::new(move |events| stick_slip(set, within, events)),
            },
            Contender {
                solver: "ode_solvers, Dop853",
                tolerance,
                run: dop853,
            },
            Contender {
                solver: "differential-equations, rkv989e",
                tolerance,
                run: rkv989e,
            },
            Contender {
                solver: "diffsol, tsit45",
                tolerance,
                run: tsit45,
            },
        ]
    });
    print_table(set, &mut columns);
    report(criterion, set, &mut columns);
}

/// This crate, as a user would do it.
fn stick_slip<S: System>(set: &Set<S>, tolerance: f64, events: &mut Vec<f64>) {
    let flow = Integrator::new()
        .with_tolerance(tolerance)
        .and_then(|integrator| integrator.flow(&set.system, set.start.clone()))
        .expect("valid settings");
    for step in flow {
        let step = step.expect("the motion goes on");
        if step.end_time() >= DURATION {
            break;
        }
        events.extend(step.events().iter().map(|event| event.time));
    }
}

fn worst_error<S: System>(set: &Set<S>, run: &mut dyn FnMut(&mut Vec<f64>)) -> f64 {
    let mut events = Vec::new();
    run(&mut events);
    set.reference.worst_error(&events)
}

/// The largest of 1e-8, 5e-9, 2e-9, 1e-9, … with which this crate's events are within `bound`, or
/// round-off.
fn loosest<S: System>(set: &Set<S>, bound: f64) -> f64 {
    (8..16)
        .flat_map(|e| {
            [
                format!("1e-{e}"),
                format!("5e-{}", e + 1),
                format!("2e-{}", e + 1),
            ]
        })
        .map(|decimal| decimal.parse().expect("a number"))
        .chain([Integrator::ROUND_OFF])
        .find(|&tolerance| {
            worst_error(set, &mut |events| stick_slip(set, tolerance, events)) <= bound
        })
        .expect("round-off is within all bounds")
}

fn print_table<S: System>(set: &Set<S>, columns: &mut [[Contender<'_>; 4]; 3]) {
    let mut events = Vec::new();
    let mut times = [const { [const { Vec::new() }; 4] }; 3];
    for _ in 0..ROUNDS {
        for (column, times) in columns.iter_mut().zip(&mut times) {
            for (contender, times) in column.iter_mut().zip(times) {
                // Once to warm up: the solver before has left its own code and tables in the
                // caches.
                let mut last = 0.0;
                for _ in 0..2 {
                    events.clear();
                    let start = Instant::now();
                    (contender.run)(&mut events);
                    last = start.elapsed().as_secs_f64();
                    black_box(&events);
                }
                times.push(last);
            }
        }
    }
    let build = if cfg!(target_feature = "fma") {
        "with fused multiply-add"
    } else {
        "default target"
    };
    println!(
        "\n{}, {} cycles, {build}\n{:34}{:>8}{:>13}{:>9}{:>9}{:>8}",
        set.name,
        set.reference.cycles(),
        "µs a cycle",
        "setting",
        "worst error",
        "least",
        "median",
        "ratio",
    );
    let per_cycle = |time: f64| 1e6 * time / set.reference.cycles();
    for (column, times) in columns.iter_mut().zip(&mut times) {
        println!();
        for times in &mut *times {
            times.sort_by(f64::total_cmp);
        }
        for (contender, own) in column.iter_mut().zip(&*times) {
            println!(
                "{:34}{:>8e}{:>13.1e}{:>9.2}{:>9.2}{:>8.3}",
                contender.solver,
                contender.tolerance,
                worst_error(set, &mut contender.run),
                per_cycle(own[0]),
                per_cycle(own[ROUNDS / 2]),
                own[0] / times[YARDSTICK][0],
            );
        }
    }
    println!();
}

fn report<S: System>(
    criterion: &mut Criterion,
    set: &Set<S>,
    columns: &mut [[Contender<'_>; 4]; 3],
) {
    let mut group = criterion.benchmark_group(set.name);
    // So that cycles per second are reported too.
    group.throughput(Throughput::Elements(set.reference.cycles() as u64));
    for contender in columns.iter_mut().flatten() {
        let name = BenchmarkId::new(contender.solver, format!("{:e}", contender.tolerance));
        group.bench_function(name, |bencher| {
            let mut events = Vec::new();
            bencher.iter(|| {
                events.clear();
                (contender.run)(&mut events);
            });
        });
    }
    group.finish();
}
