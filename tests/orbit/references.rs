//! Orbits computed independently to 25 digits: period, a point, events, extremes and multipliers.

use serde_json::Value;
use stick_slip::orbit::{Orbit, Oscillator, Period, shoot};
use stick_slip::structure::State;
use stick_slip::{Event, EventKind, Integrator, System};

use crate::common::{Random, Worst, kind, larger, list, number, text};
use crate::reading::{cases, numbers, remembering, structure};

/// Error promised for every number, in units of max(1, |value|).
const ACCURACY: f64 = 1e-12;

pub(crate) fn remembers(case: &Value) -> bool {
    let contacts = list(&case["system"]["contacts"]);
    let remembers = |contact: &Value| contact.get("dwell").or(contact.get("bristle")).is_some();
    contacts.iter().any(remembers)
}

pub(crate) fn all() -> Vec<Value> {
    let mut all = cases(include_str!("../data/driven_cycles.json"));
    all.extend(cases(include_str!("../data/structure_cycles.json")));
    all.extend(cases(include_str!("../data/dwell_cycles.json")));
    all.extend(cases(include_str!("../data/bristle_cycles.json")));
    all.extend(cases(include_str!("../data/contact_cycles.json")));
    all.extend(cases(include_str!("../data/joint_cycles.json")));
    all.extend(cases(include_str!("../data/force_cycles.json")));
    all.retain(|case| case.get("multipliers").is_some());
    all
}

pub(crate) fn period(case: &Value) -> Period {
    match case.get("drive_periods") {
        Some(count) => Period::Driven(count.as_u64().unwrap() as usize),
        None => Period::Free(number(&case["period"])),
    }
}

/// The start, with what its contacts remember.
pub(crate) fn start(case: &Value, contacts: usize) -> State {
    let start = &case["start"];
    let mut memory = vec![0.0; contacts];
    if let Some(z) = start.get("z").or(start.get("T")) {
        memory = numbers(z);
    } else if remembers(case) {
        // In stick, since when.
        for (contact, mode) in list(&start["modes"]).iter().enumerate() {
            let events = list(&case["events"]).iter();
            let mut own = events.filter(|event| event["contact"] == contact);
            if mode == 0 {
                let release = own.next().unwrap();
                memory[contact] = number(&release["theta"]) - number(&release["t"]);
            }
        }
    }
    let state = State::new(&numbers(&start["q"]), &numbers(&start["v"]));
    if remembers(case) || start.get("T").is_some() {
        state.with_memory(&memory)
    } else {
        state
    }
}

fn compare(case: &Value, orbit: &Orbit<State>, coordinates: &[usize]) -> Worst {
    let id = text(&case["id"]);
    let mut worst = Worst::default();
    worst.meet("period", orbit.period(), number(&case["period"]));
    for i in 0..numbers(&case["q_min"]).len() {
        let ((a, b), (c, d)) = (orbit.extremes(i), orbit.velocity_extremes(i));
        for (name, found) in [("q_min", a), ("q_max", b), ("v_min", c), ("v_max", d)] {
            worst.meet(name, found, numbers(&case[name])[i]);
        }
    }
    // A free motion may begin elsewhere.
    let expected = list(&case["events"]);
    let events = orbit.events();
    assert_eq!(
        events.len(),
        expected.len(),
        "{id}: {:?}",
        events.iter().map(|e| e.kind).collect::<Vec<_>>()
    );
    let fits = |shift: usize| {
        let turned = events.iter().cycle().skip(shift);
        turned.zip(expected).all(|(event, expected)| {
            event.kind == kind(text(&expected["kind"]))
                && expected["contact"] == coordinates[event.contact().unwrap()]
        })
    };
    let distance = |shift: usize| {
        let turned = events.iter().cycle().skip(shift);
        let parts = turned.zip(expected).flat_map(|(event, expected)| {
            std::iter::zip(event.state.displacements.clone(), numbers(&expected["q"]))
        });
        parts
            .map(|(a, b): (f64, f64)| (a - b).abs())
            .fold(0.0, larger)
    };
    let shifts = (0..events.len()).filter(|&shift| fits(shift));
    let shift = shifts.min_by(|a, b| distance(*a).total_cmp(&distance(*b)));
    let shift = if events.is_empty() {
        0
    } else {
        shift.unwrap_or_else(|| panic!("{id}: {events:?}"))
    };
    let turned: Vec<&Event<State>> = events
        .iter()
        .cycle()
        .skip(shift)
        .take(events.len())
        .collect();
    for (event, expected) in turned.iter().zip(expected) {
        let since = (event.time - turned[0].time).rem_euclid(orbit.period());
        let expected_since = number(&expected["t"]) - number(&list(&case["events"])[0]["t"]);
        // Simultaneous ones may lie on either side of 0.
        let since = if (since - orbit.period()).abs() < 1e-9 {
            since - orbit.period()
        } else {
            since
        };
        worst.meet("time", since, expected_since);
        let (q, v) = (&event.state.displacements, &event.state.velocities);
        worst.meet_all(1.0, "q of an event", q, &numbers(&expected["q"]));
        worst.meet_all(1.0, "v of an event", v, &numbers(&expected["v"]));
        if let (Some(theta), EventKind::Release(_), true) =
            (expected.get("theta"), event.kind, remembers(case))
        {
            worst.meet(
                "θ",
                event.state.memory[event.contact().unwrap()],
                number(theta),
            );
        }
    }
    let mut expected: Vec<[f64; 2]> = list(&case["multipliers"])
        .iter()
        .map(|m| [number(&m["re"]), number(&m["im"])])
        .collect();
    let free = usize::from(case.get("drive_periods").is_none());
    let memory = orbit.state().memory.len();
    let count = 2 * orbit.state().displacements.len() + memory - free;
    assert_eq!(orbit.multipliers().len(), count, "{id}");
    // The file leaves out those of clocks that stand.
    expected.resize(count, [0.0; 2]);
    let zeros = case["zero_multipliers"].as_u64().unwrap() as usize;
    let found_zeros = orbit
        .multipliers()
        .iter()
        .filter(|m| m.norm() == 0.0)
        .count();
    assert!(found_zeros >= zeros, "{id}: {:?}", orbit.multipliers());
    let mut left = orbit.multipliers().to_vec();
    for [re, im] in expected {
        let nearest = (0..left.len())
            .min_by(|&a, &b| {
                let to = |i: usize| (left[i].re - re).hypot(left[i].im - im);
                to(a).total_cmp(&to(b))
            })
            .unwrap();
        let found = left.swap_remove(nearest);
        worst.meet("multiplier", found.re, re);
        worst.meet("multiplier, im", found.im, im);
    }
    assert_eq!(orbit.is_stable(), case["stable"].as_bool().unwrap(), "{id}");
    worst
}

fn check<S: Oscillator + System<State = State>>(
    case: &Value,
    system: &S,
    contacts: &[usize],
) -> [Worst; 2] {
    let id = text(&case["id"]);
    let mut exact = start(case, contacts.len());
    // Of a driven motion at its time of the drives, in their last period.
    let mut time = number(&case["start"]["t"]);
    let length = number(&case["period"]);
    if time > length {
        time = time.rem_euclid(length);
        let integrator = Integrator::new().with_start_time(time).unwrap();
        let rest = integrator.simulate(system, exact.clone(), length - time);
        exact = rest.unwrap().last();
        time = 0.0;
    }
    let orbit = shoot(system, &exact, period(case)).unwrap_or_else(|error| panic!("{id}: {error}"));
    let mut first = compare(case, &orbit, contacts);
    let found = orbit.trajectory().state_at(time).unwrap();
    first.meet_all(
        1.0,
        "q of the start",
        &found.displacements,
        &exact.displacements,
    );
    first.meet_all(1.0, "v of the start", &found.velocities, &exact.velocities);
    // From beside it.
    let mut random = Random::new(11);
    let mut beside = exact.clone();
    let parts = beside
        .displacements
        .iter_mut()
        .chain(&mut beside.velocities);
    for x in parts {
        *x += 1e-3 * random.uniform(-1.0, 1.0);
    }
    let estimate = match period(case) {
        Period::Free(period) => Period::Free(period * 1.001),
        driven => driven,
    };
    let orbit =
        shoot(system, &beside, estimate).unwrap_or_else(|error| panic!("{id}, beside: {error}"));
    [first, compare(case, &orbit, contacts)]
}

#[test]
fn orbits_have_the_reference_numbers() {
    let mut failures = vec![];
    let mut count = 0;
    for case in all() {
        let id = text(&case["id"]).to_owned();
        let run = std::panic::catch_unwind(|| {
            if remembers(&case) {
                let system = remembering(&case["system"]);
                let contacts: Vec<_> = system.contacts().iter().map(|c| c.coordinate()).collect();
                check(&case, &system, &contacts)
            } else {
                let system = structure(&case["system"], f64::NAN);
                // By coordinate, or, where contacts have directions, by contact.
                let contacts = system.contacts().iter().enumerate();
                let is_by_contact = !case["system"]["mass"].is_null();
                let contacts: Vec<_> = contacts
                    .map(|(c, contact)| {
                        if is_by_contact {
                            c
                        } else {
                            contact.coordinate()
                        }
                    })
                    .collect();
                check(&case, &system, &contacts)
            }
        });
        let Ok([exact, beside]) = run else {
            failures.push(id);
            continue;
        };
        count += 1;
        println!(
            "{id}: {:.1e} ({}); from beside {:.1e} ({})",
            exact.0, exact.1, beside.0, beside.1
        );
        if !(exact.is_within(ACCURACY) && beside.is_within(ACCURACY)) {
            failures.push(id);
        }
    }
    assert!(failures.is_empty(), "{failures:?}");
    assert_eq!(count, 62);
}
