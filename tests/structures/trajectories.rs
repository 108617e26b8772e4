//! Motions computed independently to 25 digits: every event of every contact, and the states and
//! modes between.

use serde_json::Value;
use std::panic::AssertUnwindSafe;

use stick_slip::structure::State;
use stick_slip::{
    Direction, Element, Error, Event, EventKind, Integrator, Mode, Structure, Trajectory,
};

use crate::common::{Worst, kind, larger, list, number, text};
use crate::reading::{cases, numbers, structure};

/// Error promised for every time, displacement and velocity, in units of max(1, |value|).
const ACCURACY: f64 = 1e-13;

fn state(value: &Value) -> State {
    let state = State::new(&numbers(&value["q"]), &numbers(&value["v"]));
    match value.get("T") {
        Some(carried) => state.with_memory(&numbers(carried)),
        None => state,
    }
}

/// Cases of dry friction, rigid and elastic; the contacts of the others remember something else.
fn dry_cases() -> Vec<Value> {
    let mut all = cases(include_str!("../data/driven_trajectories.json"));
    all.extend(cases(include_str!("../data/structure_trajectories.json")));
    all.extend(cases(include_str!("../data/contact_trajectories.json")));
    all.extend(cases(include_str!("../data/joint_trajectories.json")));
    let limits = cases(include_str!("../data/limits_trajectories.json"));
    // Dependent contacts, ties, and limits by direction.
    let is_dry = |case: &Value| case["gap"].as_u64().is_some_and(|gap| gap <= 3);
    all.extend(limits.into_iter().filter(is_dry));
    all.retain(|case| {
        let contacts = list(&case["system"]["contacts"]);
        let remembers = |contact: &Value| contact.get("dwell").or(contact.get("bristle")).is_some();
        !contacts.iter().any(remembers)
    });
    all
}

/// Elastic contacts with k_t from 1e4 to 1e12.
fn stiff_cases() -> Vec<Value> {
    cases(include_str!("../data/stiff_joint_trajectories.json"))
}

/// Cases with force elements.
fn force_cases() -> Vec<Value> {
    cases(include_str!("../data/force_trajectories.json"))
}

/// The motion of a case; where a load falls to 0, up to there, with what the error says.
fn simulate(
    system: &Structure,
    start: State,
    end: f64,
    tolerance: f64,
) -> (Trajectory<State>, Option<Event<State>>) {
    let integrator = Integrator::new().with_tolerance(tolerance).unwrap();
    match integrator.simulate(system, start.clone(), end) {
        Ok(motion) => (motion, None),
        Err(Error::Separation { contact, reached }) => {
            // What follows the last step is not part of the motion.
            let before = reached.time * (1.0 - 1e-12);
            let motion = integrator.simulate(system, start, before).unwrap();
            let separation = Event {
                time: reached.time,
                element: Element::Contact(contact),
                kind: EventKind::Open,
                state: reached.state,
            };
            (motion, Some(separation))
        }
        Err(error) => panic!("{error}"),
    }
}

/// How far the problem itself magnifies what is changed at the start: the largest change of any
/// number of the motion up to a time, for a change of 1 at the start.
fn magnification(system: &Structure, start: &State, end: f64) -> impl Fn(f64) -> f64 + use<> {
    const CHANGE: f64 = 1e-9;
    let (motion, _) = simulate(system, start.clone(), end, f64::EPSILON);
    let mut grown: Vec<(f64, f64)> = vec![];
    for i in 0..system.len() {
        let mut changed = start.clone();
        changed.displacements[i] += CHANGE;
        let (other, _) = simulate(system, changed, end, f64::EPSILON);
        for (a, b) in motion.events().iter().zip(other.events()) {
            let apart = [&a.state.displacements, &a.state.velocities]
                .into_iter()
                .zip([&b.state.displacements, &b.state.velocities])
                .flat_map(|(a, b)| a.iter().zip(b))
                .map(|(a, b)| (a - b).abs())
                .fold((a.time - b.time).abs(), larger);
            grown.push((a.time, apart / CHANGE));
        }
    }
    move |time| {
        // An event of the motion may come a rounding error after that of the reference.
        let before = grown.iter().filter(|(at, _)| *at <= time * (1.0 + 1e-9));
        before.fold(1.0, |largest, (_, factor)| factor.max(largest))
    }
}

/// How fast the forces of stiff contacts change: the spring of a stuck contact vibrates with
/// ω = √(k_t b·M⁻¹b) and amplitudes up to μN. The roundings of each unit of time shift its phase.
fn fastest_change(case: &Value, system: &Structure) -> f64 {
    let inverse = system.mass_matrix().into_owned().try_inverse().unwrap();
    let changes = std::iter::zip(list(&case["system"]["contacts"]), system.contacts());
    let changes = changes.filter_map(|(given, contact)| {
        let stiffness = contact.tangential_stiffness().filter(|k| *k >= 1e4)?;
        let row = contact.direction();
        let compliance: f64 = row
            .iter()
            .flat_map(|&(i, a)| row.iter().map(move |&(j, b)| (i, j, a * b)))
            .map(|(i, j, product)| product * inverse[(i, j)])
            .sum();
        Some((stiffness * compliance).sqrt() * number(&given["mu"]) * number(&given["N0"]))
    });
    changes.fold(0.0, larger)
}

#[test]
fn motions_have_the_reference_events_and_states() {
    // Roundings on the way, as if each were made at the start.
    let compared = motions_are_right(dry_cases(), f64::EPSILON, 8.0 * f64::EPSILON);
    assert_eq!(compared, (EVENTS, STATES));
}

/// No event is lost, and none is added, up to k_t = 1e12.
#[test]
fn stiff_contacts_have_the_reference_events_and_states() {
    let compared = motions_are_right(stiff_cases(), f64::EPSILON, 8.0 * f64::EPSILON);
    assert_eq!(compared, (STIFF_EVENTS, STIFF_STATES));
}

/// Stops with spring and damper, each beside friction on the same coordinate.
#[test]
fn stops_have_the_reference_events_and_states() {
    for tolerance in [f64::EPSILON, 1e-12, 1e-9] {
        let mut all = cases(include_str!("../data/limits_trajectories.json"));
        all.retain(|case| case["system"].get("kv_stops").is_some());
        let at_start = if tolerance > f64::EPSILON {
            1000.0
        } else {
            8.0
        } * tolerance;
        let compared = motions_are_right(all, tolerance, at_start);
        assert_eq!(compared, (STOP_EVENTS, STOP_STATES));
    }
}

/// Motions under forces that are not linear in displacements and velocities.
#[test]
fn nonlinear_forces_have_the_reference_events_and_states() {
    let compared = motions_are_right(force_cases(), f64::EPSILON, 8.0 * f64::EPSILON);
    assert_eq!(compared, (FORCE_EVENTS, FORCE_STATES));
}

/// A tolerance is the error of the last term of a step, relative to the motion. The errors of some
/// dozen steps add up, and a vibration may grow: the largest error met is 790 times the tolerance.
#[test]
fn loose_tolerances_have_the_reference_events_and_states() {
    for tolerance in [1e-12, 1e-9, 1e-6] {
        let compared = motions_are_right(dry_cases(), tolerance, 1000.0 * tolerance);
        assert_eq!(compared, (EVENTS, STATES));
        let compared = motions_are_right(force_cases(), tolerance, 1000.0 * tolerance);
        assert_eq!(compared, (FORCE_EVENTS, FORCE_STATES));
    }
}

/// Compares motions, with an error as if that of the start were `at_start`; how many events and
/// states they have.
fn motions_are_right(all: Vec<Value>, tolerance: f64, at_start: f64) -> (usize, usize) {
    let (mut events, mut states) = (0, 0);
    let mut failures = vec![];
    for case in all {
        let id = text(&case["id"]);
        let system = structure(&case["system"], f64::NAN);
        let ends_early = !case["ends"].is_null();
        let end = number(&case["t_end"]) + if ends_early { 1.0 } else { 0.0 };
        let start = state(&case["start"]);
        let run = std::panic::catch_unwind(AssertUnwindSafe(|| {
            let magnified = magnification(&system, &start, end);
            (simulate(&system, start, end, tolerance), magnified)
        }));
        let Ok(((motion, separation), magnified)) = run else {
            failures.push(format!("{id}: ended early"));
            continue;
        };
        let allowed = |time: f64| ACCURACY + at_start * magnified(time);
        let change = fastest_change(&case, &system);
        let vibrating = |time: f64| at_start * magnified(time) * time.max(1.0) * change;
        let allowed_force = |time: f64| allowed(time) + vibrating(time);
        let mut worst = Worst::default();
        let expected = list(&case["events"]);
        let mut actual = motion.events().to_vec();
        let mut kinds: Vec<_> = expected.iter().map(|event| text(&event["kind"])).collect();
        if let Some("separation") = kinds.last().copied() {
            kinds.pop();
            let separation = separation.unwrap_or_else(|| panic!("{id}: did not separate"));
            let contact = expected[kinds.len()]["contact"].as_u64();
            assert_eq!(Some(separation.contact().unwrap() as u64), contact, "{id}");
            actual.push(separation);
        }
        let order: Vec<_> = kinds.iter().map(|name| kind(name)).collect();
        let found: Vec<_> = actual[..actual.len().min(order.len())]
            .iter()
            .map(|event| event.kind)
            .collect();
        if actual.len() != expected.len() || found != order {
            failures.push(format!(
                "{id}: {} events, not {}",
                actual.len(),
                expected.len()
            ));
        }
        for (n, (actual, expected)) in actual.iter().zip(expected).enumerate() {
            let what = |quantity: &str| format!("{id}, event {n}: {quantity}");
            let numbered = |name: &str| expected[name].as_u64().map(|found| found as usize);
            let stop = numbered("kv_stop").map(Element::Stop);
            if Some(actual.element) != stop.or(numbered("contact").map(Element::Contact)) {
                failures.push(what("element"));
                break;
            }
            let time = number(&expected["t"]);
            // An error of the force delays a release by its ratio to the rate of the force.
            let late = match (change > 0.0, actual.kind) {
                (true, EventKind::Release(_)) => {
                    let stiffness =
                        system.contacts()[actual.contact().unwrap()].tangential_stiffness();
                    vibrating(time) / (stiffness.unwrap() * number(&expected["rate"]))
                }
                _ => 0.0,
            };
            let allowed = allowed(time) + late;
            worst.meet_within(allowed, &what("time"), actual.time, time);
            let at = state(expected);
            let (q, v) = (&actual.state.displacements, &actual.state.velocities);
            worst.meet_all(allowed, &what("q"), q, &at.displacements);
            worst.meet_all(allowed, &what("v"), v, &at.velocities);
            // Where a drive breaks they have what is carried after it.
            if expected.get("at_break").is_none() {
                let (carried, allowed) = (&actual.state.memory, allowed_force(time));
                worst.meet_all(allowed, &what("T"), carried, &at.memory);
            }
            events += 1;
        }
        for expected in list(&case["states"]) {
            let time = number(&expected["t"]);
            let (Some(actual), at) = (motion.state_at(time), state(expected)) else {
                continue; // the end, of a motion that separates
            };
            let what = |quantity: &str| format!("{id}, time {time}: {quantity}");
            let allowed = allowed(time);
            worst.meet_all(
                allowed,
                &what("q"),
                &actual.displacements,
                &at.displacements,
            );
            worst.meet_all(allowed, &what("v"), &actual.velocities, &at.velocities);
            worst.meet_all(allowed_force(time), &what("T"), &actual.memory, &at.memory);
            for (i, mode) in list(&expected["modes"]).iter().enumerate() {
                // By coordinate, or, where contacts have directions, by contact.
                let contact = match &case["system"]["mass"] {
                    Value::Null => system.contacts().iter().position(|c| c.coordinate() == i),
                    _ => Some(i),
                };
                let expected = mode.as_i64().map(|sign| match sign {
                    0 => Mode::Stick,
                    1 => Mode::Slip(Direction::Leading),
                    2 => Mode::Open,
                    _ => Mode::Slip(Direction::Lagging),
                });
                let actual = contact.and_then(|contact| motion.mode_at(contact, time));
                if actual != expected {
                    failures.push(what(&format!("mode of {i}: {actual:?}, not {expected:?}")));
                }
            }
            states += 1;
        }
        println!(
            "{id}, {tolerance:e}: {:.2} of what is allowed ({:.1e} at the end) ({})",
            worst.0,
            allowed(end),
            worst.1
        );
        if !worst.is_within(1.0) {
            failures.push(format!("{id}: {:.2} times ({})", worst.0, worst.1));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
    (events, states)
}

/// Events and states in the files, so that an empty one does not pass, but for those of contacts
/// with memory; a motion that separates has no state at its end.
const EVENTS: usize = 1666;
const STATES: usize = 273;
const FORCE_EVENTS: usize = 277;
const FORCE_STATES: usize = 55;
const STOP_EVENTS: usize = 61;
const STOP_STATES: usize = 8;
const STIFF_EVENTS: usize = 652;
const STIFF_STATES: usize = 80;

/// The same motion, step by step and from another start time.
#[test]
fn a_motion_goes_on_from_any_of_its_states() {
    for case in dry_cases().into_iter().chain(stiff_cases()) {
        let id = text(&case["id"]);
        let system = structure(&case["system"], f64::NAN);
        let [.., middle, last] = list(&case["states"]) else {
            panic!("{id}: states")
        };
        let (from, to) = (number(&middle["t"]), number(&last["t"]));
        if !case["ends"].is_null() {
            continue;
        }
        let motion = Integrator::new()
            .with_start_time(from)
            .and_then(|integrator| integrator.simulate(&system, state(middle), to - from))
            .unwrap();
        let at = state(last);
        let found = motion.last();
        for (found, expected) in found.displacements.iter().zip(at.displacements) {
            assert!((found - expected).abs() < 1e-10, "{id}: {found} {expected}");
        }
        for event in motion.events() {
            assert!(event.time >= from && event.time <= to, "{id}");
        }
    }
}
