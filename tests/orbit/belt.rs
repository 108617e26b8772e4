//! A mass on a belt: the same numbers as by the search for limit cycles, which knows nothing of
//! shooting.

use serde_json::Value;
use stick_slip::orbit::{Orbit, Period, settle, shoot};
use stick_slip::{
    AnyLaw, CycleSet, Error, Exponential, LimitCycle, MassOnBelt, State, limit_cycle,
};

use crate::common::{Random, Worst, count, exactly, number, on_belt, refused, system_of, text};
use crate::reading::cases;

const ACCURACY: f64 = 1e-12;

fn compare(orbit: &Orbit<stick_slip::State>, cycle: &LimitCycle) -> Worst {
    let mut worst = Worst::default();
    let (least, largest) = orbit.extremes(0);
    let (slowest, fastest) = orbit.velocity_extremes(0);
    let [multiplier] = exactly(orbit.multipliers());
    for (what, actual, expected) in [
        ("period", orbit.period(), cycle.period()),
        ("u_min", least, cycle.min_displacement()),
        ("u_max", largest, cycle.max_displacement()),
        ("v_min", slowest, cycle.min_velocity()),
        ("v_max", fastest, cycle.max_velocity()),
        ("multiplier", multiplier.re, cycle.multiplier()),
        ("imaginary part", multiplier.im, 0.0),
    ] {
        worst.meet(what, actual, expected);
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
                        if !worst.is_within(ACCURACY) {
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
    let mut worst = Worst::default();
    for (name, actual) in [
        ("period", orbit.period()),
        ("u_min", orbit.extremes(0).0),
        ("u_max", orbit.extremes(0).1),
        ("v_min", orbit.velocity_extremes(0).0),
        ("u_contact", orbit.state().displacement),
    ] {
        worst.meet(name, actual, number(&expected[name]));
    }
    println!("{} file: {:.1e} {}", text(&case["id"]), worst.0, worst.1);
    if !worst.is_within(ACCURACY) {
        failures.push(format!("{}: {worst:?}", text(&case["id"])));
    }
}

/// Whether a motion is a cycle of the complete search, run through once or several times, or one of
/// a continuum.
fn is_known(orbit: &Orbit<stick_slip::State>, cycles: &CycleSet) -> bool {
    let (least, largest) = orbit.extremes(0);
    let is = |cycle: &LimitCycle| {
        let times = (orbit.period() / cycle.period()).round().max(1.0);
        let size = cycle.max_displacement() - cycle.min_displacement();
        let near = |a: f64, b: f64, scale: f64| (a - b).abs() < 1e-7 * scale;
        near(orbit.period(), times * cycle.period(), cycle.period())
            && near(least, cycle.min_displacement(), size)
            && near(largest, cycle.max_displacement(), size)
    };
    let inside = cycles
        .continuum()
        .is_some_and(|family| 0.5 * (largest - least) <= family.max_amplitude);
    inside || cycles.iter().any(is)
}

/// Guesses of any kind, few of them near a motion: a search may fail, but finds nothing that is
/// not there.
#[test]
fn what_is_found_is_a_cycle_that_the_complete_search_has() {
    let mut random = Random::new(2);
    let (mut found, mut at_rest, mut not_periodic) = (0, 0, 0);
    for i in 0..count(10, 30) * Random::KINDS {
        let system = random.any_system(i % Random::KINDS);
        let v_b = system.belt_velocity().abs();
        let wide = v_b + 0.5 * system.load();
        let guess = State::new(
            random.uniform(-1.5, 1.5) * wide,
            random.uniform(-2.0, 1.5) * v_b,
        );
        let estimate = random.pick(&[2.0, 4.0, 6.3, 6.3, 12.6]) * random.uniform(0.8, 1.2);
        let period = Period::Free(estimate);
        let transient = random.pick(&[20.0, 100.0, 300.0]);
        let cycles = limit_cycle::find(&system).unwrap();
        for orbit in [
            shoot(&system, &guess, period),
            settle(&system, &guess, transient, period),
        ] {
            match orbit {
                Ok(orbit) => {
                    let about = || format!("{i}: {system:?}, {guess:?}, {estimate}: {orbit:?}");
                    assert!(is_known(&orbit, &cycles), "{}", about());
                    found += 1;
                }
                Err(Error::AtRest) => at_rest += 1,
                Err(Error::NotPeriodic { .. }) => not_periodic += 1,
                Err(error) => panic!("{i}: {error}"),
            }
        }
    }
    println!("{found} found, {at_rest} at rest, {not_periodic} not periodic");
    assert!(
        found > count(40, 120) && at_rest > count(2, 20),
        "{found} {at_rest}"
    );
}

/// x(T) = x(0) is true of any T at a state of rest, and of T = 0 everywhere.
#[test]
fn neither_rest_nor_no_time_is_a_motion() {
    let law = Exponential::new(0.4, 0.25, 0.5).unwrap();
    let system = on_belt(law, 1.5, 0.1, 1.0);
    assert!(limit_cycle::find(&system).unwrap().is_empty());
    let settled = settle(&system, &(0.0, 0.0).into(), 300.0, Period::Free(6.3));
    assert_eq!(settled.map(|_| ()), Err(Error::AtRest));
    refused!(shoot(&system, &(0.5, 0.3).into(), Period::Free(2.0)) => Error::NotPeriodic { .. });
    let found = shoot(&system, &(0.5, 0.3).into(), Period::Free(1e-12)).map(|_| ());
    assert!(found.is_err());
}
