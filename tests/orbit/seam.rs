//! Where a period begins does not matter, not even exactly at an event.

use std::f64::consts::TAU;

use stick_slip::nalgebra::Complex;
use stick_slip::orbit::{Orbit, Oscillator, Period, shoot};
use stick_slip::structure::State;
use stick_slip::{EventKind, System};

use crate::common::text;
use crate::reading::{remembering, structure};
use crate::references::{all, period, remembers, start};

/// The largest distance of a multiplier from its partner.
fn apart(found: &[Complex<f64>], expected: &[Complex<f64>]) -> f64 {
    assert_eq!(found.len(), expected.len());
    let mut left = found.to_vec();
    let mut largest = 0.0_f64;
    for m in expected {
        let nearest = (0..left.len())
            .min_by(|&a, &b| (left[a] - m).norm().total_cmp(&(left[b] - m).norm()))
            .unwrap();
        largest = largest.max((left.swap_remove(nearest) - m).norm());
    }
    largest
}

fn kinds(orbit: &Orbit<impl System<State = State>>) -> Vec<(usize, String)> {
    let mut kinds: Vec<_> = orbit
        .events()
        .iter()
        .map(|event| (event.contact, event.kind.to_string()))
        .collect();
    kinds.sort();
    kinds
}

fn same<S: Oscillator + System<State = State>>(about: &str, one: &Orbit<S>, other: &Orbit<S>) {
    let difference = apart(other.multipliers(), one.multipliers());
    assert!(
        difference < 1e-11,
        "{about}: {:?}, not {:?}",
        other.multipliers(),
        one.multipliers()
    );
    let zeros = |orbit: &Orbit<S>| {
        orbit
            .multipliers()
            .iter()
            .filter(|m| m.norm() == 0.0)
            .count()
    };
    assert_eq!(zeros(one), zeros(other), "{about}");
    assert_eq!(kinds(one), kinds(other), "{about}: {:?}", other.events());
    assert!(
        (one.period() - other.period()).abs() < 1e-12 * one.period(),
        "{about}"
    );
    for i in 0..one.state().displacements.len() {
        let ((a, b), (c, d)) = (one.extremes(i), other.extremes(i));
        assert!(
            (a - c).abs() < 1e-11 && (b - d).abs() < 1e-11,
            "{about}: {a} {b} {c} {d}"
        );
    }
    let events = other.events();
    assert!(
        events
            .iter()
            .all(|event| event.time > 0.0 && event.time <= other.period()),
        "{about}"
    );
    assert!(
        events.windows(2).all(|pair| pair[0].time <= pair[1].time),
        "{about}"
    );
}

/// A free motion, begun at each of its events and between them.
fn free<S: Oscillator + System<State = State>>(id: &str, system: &S, guess: &State) -> usize {
    let Period::Free(_) = period(
        &all()
            .into_iter()
            .find(|case| text(&case["id"]) == id)
            .unwrap(),
    ) else {
        return 0;
    };
    let orbit = shoot(system, guess, Period::Free(period_of(id))).unwrap();
    let mut begun = 0;
    for (number, event) in orbit.events().iter().enumerate() {
        let mut state = event.state.clone();
        if event.kind == EventKind::Stick
            && let Some(next) = orbit.trajectory().state_at(event.time.next_up())
        {
            // The clock of rest begins.
            state.memory = next.memory;
        }
        let other = shoot(system, &state, Period::Free(orbit.period()))
            .unwrap_or_else(|error| panic!("{id}, event {number}: {error}"));
        same(
            &format!("{id}, event {number} ({})", event.kind),
            &orbit,
            &other,
        );
        begun += 1;
    }
    for part in 0..4 {
        let time = (0.11 + 0.24 * f64::from(part)) * orbit.period();
        let state = orbit.trajectory().state_at(time).unwrap();
        let other = shoot(system, &state, Period::Free(orbit.period()))
            .unwrap_or_else(|error| panic!("{id}, {time}: {error}"));
        same(&format!("{id}, {time}"), &orbit, &other);
    }
    begun
}

fn period_of(id: &str) -> f64 {
    let case = all()
        .into_iter()
        .find(|case| text(&case["id"]) == id)
        .unwrap();
    match period(&case) {
        Period::Free(period) => period,
        Period::Driven(_) => f64::NAN,
    }
}

#[test]
fn free_motions_begin_anywhere() {
    let mut begun = 0;
    for case in all() {
        let id = text(&case["id"]);
        // Near-stick of bristles: tens of thousands of steps for nothing else.
        if id.starts_with("brc") {
            continue;
        }
        let contacts = case["system"]["contacts"].as_array().unwrap().len();
        let guess = start(&case, contacts);
        begun += if remembers(&case) {
            free(id, &remembering(&case["system"]), &guess)
        } else {
            free(id, &structure(&case["system"], f64::NAN), &guess)
        };
    }
    println!("{begun} events");
    assert!(begun > 80, "{begun}");
}

/// Every drive of a case, a time later.
fn later(case: &serde_json::Value, time: f64) -> serde_json::Value {
    let mut case = case.clone();
    let turn = |drive: &mut serde_json::Value| {
        if drive["type"] != "fourier" {
            return;
        }
        for term in drive["terms"].as_array_mut().unwrap() {
            let value = |name: &str| crate::common::number(&term[name]);
            let (omega, a, b) = (value("omega"), value("a"), value("b"));
            let (sine, cosine) = (omega * time).rem_euclid(TAU).sin_cos();
            let [a, b] = [a * cosine + b * sine, b * cosine - a * sine];
            term["a"] = format!("{a:e}").into();
            term["b"] = format!("{b:e}").into();
        }
    };
    let system = &mut case["system"];
    system["f"]
        .as_array_mut()
        .unwrap()
        .iter_mut()
        .for_each(turn);
    for contact in system["contacts"].as_array_mut().unwrap() {
        if !contact.is_null() {
            turn(&mut contact["w"]);
            if contact["N0"].is_object() {
                turn(&mut contact["N0"]);
            }
        }
    }
    case
}

fn driven<S: Oscillator + System<State = State>>(
    case: &serde_json::Value,
    system: impl Fn(&serde_json::Value) -> S,
    contacts: usize,
) -> usize {
    let id = text(&case["id"]);
    let Period::Driven(count) = period(case) else {
        return 0;
    };
    let orbit = shoot(
        &system(&case["system"]),
        &start(case, contacts),
        Period::Driven(count),
    )
    .unwrap();
    for (number, event) in orbit.events().iter().enumerate() {
        let turned = system(&later(case, event.time)["system"]);
        let mut state = event.state.clone();
        if event.kind == EventKind::Stick
            && let Some(next) = orbit.trajectory().state_at(event.time.next_up())
        {
            state.memory = next.memory;
        }
        let other = shoot(&turned, &state, Period::Driven(count))
            .unwrap_or_else(|error| panic!("{id}, event {number}: {error}"));
        same(
            &format!("{id}, event {number} ({})", event.kind),
            &orbit,
            &other,
        );
    }
    orbit.events().len()
}

#[test]
fn driven_motions_may_have_an_event_at_time_0() {
    let mut begun = 0;
    for case in all() {
        let contacts = case["system"]["contacts"].as_array().unwrap().len();
        begun += if remembers(&case) {
            driven(&case, remembering, contacts)
        } else {
            driven(&case, |system| structure(system, f64::NAN), contacts)
        };
    }
    println!("{begun} events");
    assert!(begun > 30, "{begun}");
}
