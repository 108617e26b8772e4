//! Prints the bits of the reference motions: one line for each event and each state, and how long
//! it takes to sample a motion. `tests/test_reference.py` compares them with those of Python.

use std::time::Instant;

use serde_json::Value;
use stick_slip::structure::State;
use stick_slip::{Element, EventKind, MassOnBelt, Polynomial, Structure, Trajectory, limit_cycle};
use stick_slip_tests_common::reading::{cases, numbers, remembering, structure};
use stick_slip_tests_common::{list, number, system_of};

fn bits(numbers: &[f64]) -> String {
    let words = numbers
        .iter()
        .map(|number| format!("{:016x}", number.to_bits()));
    words.collect::<Vec<_>>().join(" ")
}

/// The name of a kind of event, as Python has it.
fn name(kind: EventKind) -> &'static str {
    match kind {
        EventKind::Stick => "stick",
        EventKind::Release(_) => "release",
        EventKind::Crossing(_) => "crossing",
        EventKind::Open => "open",
        EventKind::Close => "close",
    }
}

fn belts() {
    for case in cases(include_str!("../../../../tests/data/trajectories.json")) {
        let start = &case["start"];
        // Other starts are named by their place in the band of stick.
        if start.get("u").is_none() || start.get("v").is_none() {
            continue;
        }
        let states = list(&case["states"]);
        let end = states.last().map_or(0.0, |state| number(&state["t"]));
        let start = (number(&start["u"]), number(&start["v"]));
        let motion = system_of(&case).simulate(start, end).unwrap();
        println!("case {}", case["id"]);
        for event in motion.events() {
            println!("event {} {}", name(event.kind), bits(&[event.time]));
        }
        for state in states {
            let state = motion.state_at(number(&state["t"])).unwrap();
            println!("state {}", bits(&[state.displacement, state.velocity]));
        }
    }
}

fn cycles() {
    for case in cases(include_str!("../../../../tests/data/cycles.json")) {
        println!("case {}", case["id"]);
        for cycle in limit_cycle::find(&system_of(&case)).unwrap().iter() {
            let numbers = [
                cycle.period(),
                cycle.amplitude(),
                cycle.multiplier(),
                cycle.min_velocity(),
                cycle.energy().drive_work,
            ];
            println!("cycle {}", bits(&numbers));
        }
    }
}

fn print(motion: &Trajectory<State>, case: &Value) {
    println!("case {}", case["id"]);
    for event in motion.events() {
        let number = match event.element {
            Element::Stop(stop) => stop,
            _ => event.contact().unwrap(),
        };
        println!(
            "event {} {number} {}",
            name(event.kind),
            bits(&[event.time])
        );
    }
    for state in list(&case["states"]) {
        let state = motion.state_at(number(&state["t"])).unwrap();
        let numbers = [state.displacements, state.velocities, state.memory].concat();
        println!("state {}", bits(&numbers));
    }
}

fn structures(file: &str, system: impl Fn(&Value) -> Structure) {
    for case in cases(file) {
        // Rigid impacts are not available.
        if case["system"].get("stops").is_some() {
            continue;
        }
        let start = &case["start"];
        let mut state = State::new(&numbers(&start["q"]), &numbers(&start["v"]));
        for memory in ["T", "z", "phi"] {
            if let Some(memory) = start.get(memory) {
                state = state.with_memory(&numbers(memory));
            }
        }
        // A motion that ends with a separation is left out on both sides.
        if let Ok(motion) = system(&case["system"]).simulate(state, number(&case["t_end"])) {
            print(&motion, &case);
        }
    }
}

fn time_of_a_sample() {
    let law = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    let system = MassOnBelt::new(law, 0.2)
        .and_then(|it| it.with_damping(0.05))
        .unwrap();
    let motion = system.simulate((0.0, 0.0), 1000.0).unwrap();
    let count = 100_000;
    let times: Vec<f64> = (0..count)
        .map(|i| 1000.0 * f64::from(i) / f64::from(count))
        .collect();
    let run = || {
        let begin = Instant::now();
        let states: Vec<_> = motion.sample_at(&times).collect();
        let taken = begin.elapsed().as_secs_f64();
        assert_eq!(states.len(), times.len());
        taken
    };
    let least = (0..9).map(|_| run()).fold(f64::INFINITY, f64::min);
    println!("sample {least}");
}

fn main() {
    belts();
    cycles();
    let plain = |system: &Value| structure(system, f64::NAN);
    structures(
        include_str!("../../../../tests/data/driven_trajectories.json"),
        plain,
    );
    // A dry law has its own type, as in Python: the last bits depend on it.
    let either = |system: &Value| {
        let is_dry = |contact: &Value| contact["dwell"].is_null() && contact["bristle"].is_null();
        let dry = list(&system["contacts"]).iter().all(is_dry);
        if dry {
            plain(system)
        } else {
            remembering(system)
        }
    };
    structures(
        include_str!("../../../../tests/data/structure_trajectories.json"),
        either,
    );
    structures(
        include_str!("../../../../tests/data/contact_trajectories.json"),
        plain,
    );
    structures(
        include_str!("../../../../tests/data/joint_trajectories.json"),
        plain,
    );
    structures(
        include_str!("../../../../tests/data/bristle_trajectories.json"),
        remembering,
    );
    structures(
        include_str!("../../../../tests/data/dwell_trajectories.json"),
        remembering,
    );
    structures(
        include_str!("../../../../tests/data/limits_trajectories.json"),
        plain,
    );
    structures(
        include_str!("../../../../tests/data/force_trajectories.json"),
        plain,
    );
    structures(
        include_str!("../../../../tests/data/rate_state_trajectories.json"),
        plain,
    );
    time_of_a_sample();
}
