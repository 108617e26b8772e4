//! A mass on a belt: the same numbers as by the search for limit cycles, which knows nothing of
//! shooting.

use serde_json::Value;
use stick_slip::orbit::{Orbit, Period, shoot};
use stick_slip::{AnyLaw, LimitCycle, MassOnBelt, State, limit_cycle};

use crate::common::{number, system_of, text};
use crate::reading::cases;

const ACCURACY: f64 = 1e-12;

fn meet(worst: &mut (f64, String), what: &str, actual: f64, expected: f64) {
    let error = (actual - expected).abs() / expected.abs().max(1.0);
    if error.is_nan() || error > worst.0 {
        *worst = (error, format!("{what}: {actual:e}, not {expected:e}"));
    }
}

fn compare(orbit: &Orbit<MassOnBelt<AnyLaw>>, cycle: &LimitCycle) -> (f64, String) {
    let mut worst = (0.0, String::new());
    let (least, largest) = orbit.extremes(0);
    let (slowest, fastest) = orbit.velocity_extremes(0);
    let [multiplier] = orbit.multipliers() else {
        panic!("{:?}", orbit.multipliers())
    };
    for (what, actual, expected) in [
        ("period", orbit.period(), cycle.period()),
        ("u_min", least, cycle.min_displacement()),
        ("u_max", largest, cycle.max_displacement()),
        ("v_min", slowest, cycle.min_velocity()),
        ("v_max", fastest, cycle.max_velocity()),
        ("multiplier", multiplier.re, cycle.multiplier()),
        ("imaginary part", multiplier.im, 0.0),
    ] {
        meet(&mut worst, what, actual, expected);
    }
    if cycle.stick_duration() > 0.0 {
        assert_eq!((multiplier.re, multiplier.im), (0.0, 0.0));
    }
    assert_eq!(orbit.is_stable(), cycle.is_stable());
    let kinds = |events: &[stick_slip::Event]| -> Vec<_> {
        let mut kinds: Vec<_> = events.iter().map(|event| event.kind.to_string()).collect();
        kinds.sort();
        kinds
    };
    let of_cycle = cycle.trajectory();
    let of_cycle: Vec<_> = of_cycle
        .events()
        .iter()
        .filter(|e| e.time > 0.0)
        .copied()
        .collect();
    assert_eq!(
        kinds(orbit.events()),
        kinds(&of_cycle),
        "{:?}",
        cycle.kind()
    );
    worst
}

#[test]
fn the_reference_cycles_come_out() {
    let mut failures = vec![];
    let mut count = 0;
    for case in cases(include_str!("../data/cycles.json")) {
        let id = text(&case["id"]);
        let system = system_of(&case);
        let cycles = limit_cycle::find(&system).unwrap();
        for cycle in &cycles {
            count += 1;
            let (start, middle) = (
                cycle.state(),
                cycle.trajectory().state_at(0.4 * cycle.period()),
            );
            let middle = middle.unwrap();
            let beside = State::new(middle.displacement + 1e-4, middle.velocity - 1e-4);
            for (which, guess, part) in [("start", start, 1.0), ("beside", beside, 1.001)] {
                match shoot(&system, &guess, Period::Free(part * cycle.period())) {
                    Ok(orbit) => {
                        let worst = compare(&orbit, cycle);
                        println!(
                            "{id} {:?} {which}: {:.1e} ({})",
                            cycle.kind(),
                            worst.0,
                            worst.1
                        );
                        if worst.0.is_nan() || worst.0 > ACCURACY {
                            failures.push(format!("{id} {which}: {} {}", worst.0, worst.1));
                        }
                    }
                    Err(error) => {
                        failures.push(format!("{id} {:?} {which}: {error}", cycle.kind()));
                    }
                }
            }
        }
        against_file(&case, &system, &mut failures);
    }
    assert!(failures.is_empty(), "{failures:#?}");
    assert!(count > 35, "{count}");
}

/// The numbers of the file itself.
fn against_file(case: &Value, system: &MassOnBelt<AnyLaw>, failures: &mut Vec<String>) {
    if case["type"] != "stick_slip" {
        return;
    }
    let expected = &case["cycle"];
    let start = State::new(number(&expected["u_contact"]), system.belt_velocity());
    let orbit = shoot(system, &start, Period::Free(number(&expected["period"]))).unwrap();
    let mut worst = (0.0, String::new());
    for (name, actual) in [
        ("period", orbit.period()),
        ("u_min", orbit.extremes(0).0),
        ("u_max", orbit.extremes(0).1),
        ("v_min", orbit.velocity_extremes(0).0),
        ("u_contact", orbit.state().displacement),
    ] {
        meet(&mut worst, name, actual, number(&expected[name]));
    }
    println!("{} file: {:.1e} {}", text(&case["id"]), worst.0, worst.1);
    if worst.0.is_nan() || worst.0 > ACCURACY {
        failures.push(format!("{}: {worst:?}", text(&case["id"])));
    }
}
