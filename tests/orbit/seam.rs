//! Where a period begins does not matter, not even exactly at an event.

use std::f64::consts::TAU;

use stick_slip::nalgebra::Complex;
use stick_slip::orbit::{
    BifurcationKind, BranchEnd, Orbit, Oscillator, Period, follow, settle, shoot,
};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Drive, Dwell, Error, EventKind, Exponential, LuGre, Structure, System,
};

use crate::common::{count, larger, some, text};
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
        largest = larger(largest, (left.swap_remove(nearest) - m).norm());
    }
    largest
}

fn kinds(orbit: &Orbit<State>) -> Vec<(usize, String)> {
    let mut kinds: Vec<_> = orbit
        .events()
        .iter()
        .map(|event| (event.contact().unwrap(), event.kind.to_string()))
        .collect();
    kinds.sort();
    kinds
}

fn same(about: &str, one: &Orbit<State>, other: &Orbit<State>) {
    let difference = apart(other.multipliers(), one.multipliers());
    assert!(
        difference < 1e-11,
        "{about}: {:?}, not {:?}",
        other.multipliers(),
        one.multipliers()
    );
    let zeros = |orbit: &Orbit<State>| {
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

/// Two masses under a force of a phase, each on the ground or on a belt.
fn with_phase(contacts: &[Contact], phase: f64) -> Result<Structure, Error> {
    let mut system = Structure::new(&[1.0, 0.7])?
        .with_ground_spring(0, 1.0)?
        .with_ground_damper(0, 0.1)?
        .with_spring(0, 1, 1.3)?
        .with_ground_damper(1, 0.05)?
        .with_force(0, Drive::harmonic(0.8, 0.5, phase)?)?;
    for contact in contacts {
        system = system.with_contact(contact.clone())?;
    }
    Ok(system)
}

/// Along a branch over the phase of the force every event passes the start of the period, and
/// nothing else changes.
#[test]
fn events_pass_the_start_along_a_branch() {
    let dry = Coulomb::new(0.3, 0.3).unwrap();
    let on = |contact: Result<Contact, Error>| contact.unwrap();
    let sets = [
        vec![on(Contact::new(0, Coulomb::new(0.5, 0.3).unwrap(), 0.6))],
        vec![on(
            Contact::new(0, dry, 0.6).and_then(|c| c.with_tangential_stiffness(5.0))
        )],
        vec![on(Contact::new(
            0,
            Dwell::exponential(dry, 0.5, 1.0).unwrap(),
            0.6,
        ))],
        vec![on(Contact::new(
            1,
            Dwell::hyperbolic(dry, 0.5, 1.0).unwrap(),
            1.0,
        ))],
        vec![on(Contact::new(
            0,
            Dwell::logarithmic(dry, 0.05, 0.1).unwrap(),
            0.6,
        ))],
        vec![
            on(Contact::new(
                0,
                Dwell::exponential(dry, 0.5, 1.0).unwrap(),
                0.6,
            ))
            .on_belt(0.2),
        ],
        vec![
            on(Contact::new(
                0,
                Dwell::exponential(dry, 0.5, 1.0).unwrap(),
                0.4,
            )),
            on(Contact::new(
                1,
                Exponential::new(0.5, 0.3, 0.5).unwrap(),
                0.5,
            ))
            .on_belt(0.3),
        ],
        vec![
            on(Contact::new(
                0,
                Dwell::exponential(dry, 0.4, 1.0).unwrap(),
                0.5,
            )),
            on(Contact::new(
                1,
                Dwell::hyperbolic(dry, 0.4, 0.5).unwrap(),
                0.5,
            )),
        ],
        vec![on(LuGre::new(
            Exponential::new(0.5, 0.3, 0.5).unwrap(),
            20.0,
            0.3,
            0.02,
        )
        .and_then(|law| Contact::new(0, law, 0.6)))],
    ];
    for (number, contacts) in sets.iter().enumerate().take(count(3, 9)) {
        let family = |phase: f64| with_phase(contacts, phase);
        let start = State::new(&[0.5, 0.2], &[0.0, 0.1]);
        let first = settle(&family(1.0).unwrap(), &start, 400.0, Period::Driven(1)).unwrap();
        let branch = follow(family, 1.0, &first, 0.0..TAU).unwrap();
        assert!(!first.events().is_empty(), "{number}");
        assert_eq!(
            branch.ends,
            [BranchEnd::Range, BranchEnd::Range],
            "{number}"
        );
        assert_eq!(
            branch.bifurcations.len(),
            0,
            "{number}: {:?}",
            branch.bifurcations
        );
        for point in &branch.points {
            same(
                &format!("{number}, phase {}", point.parameter),
                &first,
                &point.orbit,
            );
        }
    }
}

/// Three masses under a force of a frequency and a phase, with a contact on a belt and one on the
/// ground, whose static friction rises at rest.
fn with_clocks(frequency: f64, phase: f64) -> Result<Structure, Error> {
    let carried = Dwell::exponential(Coulomb::new(0.3, 0.3)?, 0.72, 1.5)?;
    let resting = Dwell::exponential(Coulomb::new(0.39, 0.39)?, 0.79, 1.7)?;
    Structure::new(&[1.25, 0.84, 1.24])?
        .with_ground_spring(0, 0.86)?
        .with_ground_spring(1, 1.66)?
        .with_ground_spring(2, 1.22)?
        .with_spring(0, 1, 0.575)?
        .with_spring(1, 2, 1.76)?
        .with_ground_damper(0, 0.12)?
        .with_ground_damper(1, 0.145)?
        .with_ground_damper(2, 0.13)?
        .with_force(0, Drive::harmonic(0.625, frequency, phase)?)?
        .with_force(2, 0.349)?
        .with_contact(Contact::new(0, carried, 0.95)?.on_belt(0.478))?
        .with_contact(Contact::new(1, resting, 1.116)?)
}

/// A branch does not depend on where the period begins, not even where its motions are unstable and
/// the release of a contact with a clock of rest passes the start: there the clock at the start
/// jumps from 0 to the whole rest.
#[test]
fn branches_do_not_depend_on_the_start_of_the_period() {
    let begin = State::new(&[0.3; 3], &[0.1; 3]);
    let at = with_clocks(0.77, 0.3).unwrap();
    let settled = settle(&at, &begin, 400.0, Period::Driven(1)).unwrap();
    let mut expected: Vec<(BifurcationKind, f64)> = Vec::new();
    let parts = [0.0, 0.45, 0.9, 0.15, 0.3, 0.6, 0.75];
    for part in some(2, parts) {
        let phase = 0.3 + TAU * part;
        let state = settled.trajectory().state_at(part * settled.period());
        let system = with_clocks(0.77, phase).unwrap();
        let first = shoot(&system, &state.unwrap(), Period::Driven(1)).unwrap();
        let family = |frequency: f64| with_clocks(frequency, phase);
        let branch = follow(family, 0.77, &first, 0.72..0.78).unwrap();
        assert_eq!(branch.ends, [BranchEnd::Range, BranchEnd::Range], "{part}");
        let found = branch.bifurcations.iter();
        let found: Vec<_> = found.map(|at| (at.kind, at.parameter)).collect();
        if expected.is_empty() {
            expected = found.clone();
        }
        assert_eq!(found.len(), 6, "{part}: {found:?}");
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!(found.0, expected.0, "{part}");
            // The derivative of the map is about 50, and rounding errors are 1e-15.
            assert!(
                (found.1 - expected.1).abs() < 1e-12,
                "{part}: {found:?} {expected:?}"
            );
        }
    }
}
