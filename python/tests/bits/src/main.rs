//! Prints the bits of the reference motions: one line for each event and each state, and how long
//! some work takes. `tests/test_reference.py` compares them with those of Python.

use std::time::Instant;

use serde_json::{Value, json};
use stick_slip::structure::State;
use stick_slip::{
    Backlash, Contact, Directional, Drive, Element, Error, EventKind, FirstOrder, ForceElement,
    MassOnBelt, Physical, PhysicalMassOnBelt, Polynomial, PolynomialSpring, RateState, Stribeck,
    Structure, TabulatedForce, Trajectory, limit_cycle, orbit,
};
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

/// What the reference files do not have: first-order states, loads by a law, tables, a band brake.
fn elements() {
    let build = || -> Result<Structure, Error> {
        let load = PolynomialSpring::new(&[0.2, 0.0, 0.1])?;
        let belt = Contact::new(0, Stribeck::new(0.4, 0.25, 0.3, 1)?, 1.0)?.on_belt(0.3);
        let band = Directional::capstan(0.3, 0.2, 2.0)?;
        let table = TabulatedForce::new(&[(-1.0, -1.0), (0.0, 0.0), (1.0, 2.0)])?;
        let factor = Drive::harmonic(0.2, 0.7, 0.0)?.with_constant(1.0)?;
        let lag = FirstOrder::lag(0.5)?
            .with_velocity(1, 2.0)?
            .with_law(&[(0, 1.0)], Backlash::new(1.0, 0.1)?)?
            .with_force(0, -0.7)?;
        Structure::new(&[1.0, 2.0])?
            .with_ground_spring(0, 4.0)?
            .with_spring(0, 1, 3.0)?
            .with_ground_damper(1, 0.2)?
            .with_force(0, Drive::harmonic(0.3, 1.3, 0.2)?)?
            .with_contact(belt.with_load_law(&[(1, 1.0)], load)?)?
            .with_contact(Contact::new(1, band, 0.4)?)?
            .with_element(ForceElement::between(0, 1, table)?.with_factor(factor)?)?
            .with_first_order(lag)
    };
    let start = State::new(&[0.1, -0.2], &[0.3, 0.4]).with_memory(&[0.05]);
    let motion = build().unwrap().simulate(start, 30.0).unwrap();
    let states: Vec<Value> = (0..=30).map(|t| json!({ "t": t.to_string() })).collect();
    print(&motion, &json!({ "id": "elements", "states": states }));
}

/// A brake in SI units and without units: its numbers, cycles and ranges.
fn brake() {
    let pad = Physical {
        mass: 4.0,
        stiffness: 1.0e6,
        damping: 20.0,
        normal_force: 800.0,
        belt_velocity: 0.03,
    };
    let law = Stribeck::new(0.45, 0.35, 0.05, 1).unwrap();
    let brake = PhysicalMassOnBelt::new(pad, law).unwrap();
    let (system, scaling) = (brake.dimensionless(), brake.scaling());
    let numbers = [
        system.belt_velocity(),
        system.damping(),
        system.load(),
        system.law().velocity_unit(),
        scaling.length(),
        scaling.angular_frequency(),
    ];
    println!("case brake");
    println!("numbers {}", bits(&numbers));
    for cycle in limit_cycle::find(system).unwrap().iter() {
        let numbers = [cycle.period(), cycle.amplitude(), cycle.multiplier()];
        println!("cycle {}", bits(&numbers));
    }
    for range in brake.vibration_ranges(0.005..0.5).unwrap() {
        let borders = [range.velocities.start, range.velocities.end];
        println!("range {}", bits(&borders));
    }
}

/// Passages of the sliding speed of a fault, a contact that never sticks.
fn passages() {
    let build = || -> Result<Structure, Error> {
        let law = RateState::aging(0.6, 0.01, 0.015, 8e-3, 1e-6)?;
        Structure::new(&[3.90625e6])?
            .with_ground_spring(0, 1.5625e7)?
            .with_ground_damper(0, 4.6e6)?
            .with_force(0, 4.6e6 * 1e-9)?
            .with_contact(Contact::new(0, law, 5e7)?.on_belt(1e-9))
    };
    let (fault, start) = (build().unwrap(), State::new(&[1.92], &[0.0]));
    let start = start.with_memory(&[6.9]).with_sliding(0, -1.2e-9);
    println!("case passages");
    for passage in orbit::section_through(&fault, &start, 0, 1e-10)
        .skip(1)
        .take(5)
    {
        let passage = passage.unwrap();
        let State {
            displacements,
            velocities,
            memory,
            ..
        } = &passage.state;
        let sliding = passage.state.sliding()[0].1;
        let numbers = [
            &[passage.time][..],
            displacements,
            velocities,
            memory,
            &[sliding],
        ];
        println!("passage {} {}", passage.rises, bits(&numbers.concat()));
    }
}

/// The least time of nine runs, in seconds.
fn time<T>(name: &str, run: impl Fn() -> T) {
    let once = || {
        let begin = Instant::now();
        let result = run();
        let taken = begin.elapsed().as_secs_f64();
        std::hint::black_box(result);
        taken
    };
    let least = (0..9).map(|_| once()).fold(f64::INFINITY, f64::min);
    println!("time {name} {least}");
}

fn times() {
    let law = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    let system = MassOnBelt::new(law, 0.2)
        .and_then(|it| it.with_damping(0.05))
        .unwrap();
    let structure = Structure::from(&system);
    let run = || system.simulate((0.0, 0.0), 1000.0).unwrap();
    let run_structure = || structure.simulate(State::at_rest(1), 1000.0).unwrap();
    time("run", run);
    time("run of a structure", run_structure);
    time("cycles", || limit_cycle::find(&system).unwrap());
    let (motion, of_structure) = (run(), run_structure());
    let count = 100_000;
    let times = (0..count).map(|i| 1000.0 * f64::from(i) / f64::from(count));
    let times: Vec<f64> = times.collect();
    time("samples", || {
        let states: Vec<_> = motion.sample_at(&times).collect();
        assert_eq!(states.len(), times.len());
        states
    });
    time("samples of a structure", || {
        let states: Vec<_> = of_structure.sample_at(&times).collect();
        assert_eq!(states.len(), times.len());
        states
    });
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
    elements();
    brake();
    passages();
    times();
}
