//! Cycles under rate-and-state friction: those computed independently to 25 digits, seismic cycles
//! over many decades of the sliding speed, and the branch that begins at the Hopf point.

use serde_json::Value;
use stick_slip::orbit::{BranchEnd, Orbit, Passage, Period, follow, section_through, shoot};
use stick_slip::structure::State;
use stick_slip::{Contact, Error, Integrator, RateState, Structure};

use crate::common::{Worst, list, number, text};
use crate::reading::{cases, numbers, remembered, remembering};
use crate::references::period;

#[test]
fn cycles_have_the_reference_periods_extremes_and_multipliers() {
    let mut multipliers = 0;
    for case in cases(include_str!("../data/rate_state_cycles.json")) {
        let id = text(&case["id"]);
        let system = remembering(&case["system"]);
        let guess = remembered(&case, &case["start"]);
        let orbit = shoot(&system, &guess, period(&case)).unwrap();
        let mut worst = Worst::default();
        worst.meet("period", orbit.period(), number(&case["period"]));
        for i in 0..system.len() {
            let ((a, b), (c, d)) = (orbit.extremes(i), orbit.velocity_extremes(i));
            for (name, found) in [("q_min", a), ("q_max", b), ("v_min", c), ("v_max", d)] {
                worst.meet(name, found, numbers(&case[name])[i]);
            }
        }
        worst.assert(id, 1e-12);
        let mut worst = Worst::default();
        let expected = list(&case["multipliers"]).iter();
        for (found, expected) in std::iter::zip(orbit.multipliers(), expected) {
            worst.meet("re", found.re, number(&expected["re"]));
            worst.meet("im", found.im.abs(), number(&expected["im"]).abs());
            multipliers += 1;
        }
        worst.assert(id, 1e-10);
    }
    assert!(multipliers >= 2 + 2 + 3 + 4);
}

/// Passages of the load point's velocity, to the 25 digits computed independently; the speed at
/// passages has all its digits, down to 1e-13 m/s.
#[test]
fn sections_have_the_reference_times_and_states() {
    let (mut all, mut deep) = (0, 0);
    for case in cases(include_str!("../data/rate_state_cycles_of_one.json")) {
        if number(&case["system"]["mass"][0][0]) == 0.0 {
            continue;
        }
        let id = text(&case["id"]);
        let system = remembering(&case["system"]);
        let velocity = system.contacts()[0].belt_velocity().value(0.0);
        let start = of_one(&case);
        let mut found = section_through(&system, &start, 0, velocity);
        for section in list(&case["sections"]) {
            let rises = match text(&section["kind"]) {
                "faster" => true,
                "slower" => false,
                _ => continue,
            };
            let passage = found.next().unwrap().unwrap();
            assert_eq!(passage.rises, rises, "{id}");
            let [q, phi] = ["q", "phi"].map(|name| numbers(&section[name])[0]);
            let mut worst = Worst::default();
            let time = number(&section["t"]);
            worst.meet_within(1e-13 * time, "time", passage.time, time);
            worst.meet_within(1e-13 * q, "q", passage.state.displacements[0], q);
            worst.meet_within(2e-12, "φ", passage.state.memory[0], phi);
            let [(0, r)] = passage.state.sliding() else {
                panic!("{id}: {:?}", passage.state);
            };
            worst.meet_within(1e-13 * velocity, "r", r.abs(), velocity);
            worst.assert(id, 1.0);
            all += 1;
        }
        // And those of a value decades below, which is not reached by all, nor for ever.
        let end = number(&case["t_end"]);
        let low = 1e-4 * velocity;
        let passages = section_through(&system, &start, 0, low);
        let passages = passages.take_while(|passage| match passage {
            Ok(passage) => passage.time < end,
            Err(Error::TooManySteps { reached, .. }) if reached.time > end => false,
            Err(error) => panic!("{id}: {error}"),
        });
        let mut last = None;
        for passage in passages.map(Result::unwrap) {
            let [(0, r)] = passage.state.sliding() else {
                panic!("{id}: {:?}", passage.state);
            };
            assert!((r.abs() / low - 1.0).abs() < 1e-13, "{id}: {r:e}");
            assert_ne!(last.replace(passage.rises), Some(passage.rises), "{id}");
            deep += 1;
        }
    }
    assert!(all == 22 && deep >= 10, "{all} {deep}");
}

fn of_one(case: &Value) -> State {
    let start = &case["start"];
    State::new(&numbers(&start["q"]), &[0.0])
        .with_memory(&numbers(&start["phi"]))
        .with_sliding(0, numbers(&start["r"])[0])
}

/// A slider of the data over decades, at the end of a motion that has nearly become periodic.
fn seismic(id: &str, duration: f64) -> (Structure, State) {
    let cases = cases(include_str!("../data/rate_state_cycles_of_one.json"));
    let case = cases.iter().find(|case| text(&case["id"]) == id).unwrap();
    let system = remembering(&case["system"]);
    let motion = system.simulate(of_one(case), duration).unwrap();
    (system, motion.last())
}

/// The derivative of the map over a period, of displacement and memory of a start on the manifold,
/// by central differences of simulations.
fn differences(system: &Structure, orbit: &Orbit<State>) -> [[f64; 2]; 2] {
    let integrator = Integrator::new();
    let start = orbit.state();
    let end = |change: [f64; 2]| {
        let q = start.displacements[0] * (1.0 + change[0]);
        let phi = start.memory[0] + change[1];
        let state = State::new(&[q], &start.velocities).with_memory(&[phi]);
        let end = integrator
            .simulate(system, state, orbit.period())
            .unwrap()
            .last();
        [end.displacements[0] / start.displacements[0], end.memory[0]]
    };
    let step = 1e-5;
    [[step, 0.0], [0.0, step]].map(|change| {
        let [more, less] = [end(change), end(change.map(|x| -x))];
        [0, 1].map(|i| (more[i] - less[i]) / (2.0 * step))
    })
}

/// Newton's method finds the cycle from a state between two quakes, where the speed is 1e-15 m/s; a
/// perturbation of the speed has vanished at once. In a quake perturbations along the motion grow
/// by the ratio of the speeds, 4e8, and with them the errors of the others.
#[test]
fn seismic_cycles_close_and_have_the_multipliers_of_differences() {
    // The period, found with the period of the data's last cycle as the guess.
    for (id, duration, guess, decades) in [
        ("rs_01", 1.5e9, 5.8e8, 14.0),
        ("rs_02", 1.3e9, 5.29e8, 10.0),
        ("rs_03", 900.0, 740.0, 14.0),
        ("rs_04", 400.0, 40.0, 6.0),
    ] {
        let (system, start) = seismic(id, duration);
        let orbit = shoot(&system, &start, Period::Free(guess)).unwrap();
        let motion = system
            .simulate(orbit.state().clone(), 2.0 * orbit.period())
            .unwrap();
        let [after, later] = [1.0, 2.0].map(|k| motion.state_at(k * orbit.period()).unwrap());
        for end in [after, later] {
            let apart = (end.displacements[0] / orbit.state().displacements[0] - 1.0).abs();
            assert!(apart < 1e-13, "{id}: {apart:e}");
            let apart = (end.memory[0] - orbit.state().memory[0]).abs();
            assert!(apart < 1e-12, "{id}: {apart:e}");
        }
        // ∮ V dt = V_p T is the return of q. The speeds span decades.
        let velocity = system.contacts()[0].belt_velocity().value(0.0);
        let speeds = (0..4000).map(|k| {
            let time = orbit.period() * f64::from(k) / 4000.0;
            motion.sliding_velocity(0, time).abs()
        });
        let least = speeds.fold(f64::INFINITY, f64::min);
        let largest = velocity - orbit.velocity_extremes(0).0;
        assert!(
            (largest / least).log10() > decades,
            "{id}: {least:e} {largest:e}"
        );
        // The plate works against friction alone, but for the waves that a damper radiates.
        let energy = orbit.energy();
        let size = energy.friction_loss[0];
        assert!(energy.defect().abs() < 1e-12 * size, "{id}: {energy:?}");
        assert!(energy.stored.abs() < 1e-11 * size, "{id}: {energy:?}");
        let [[a, b], [c, d]] = differences(&system, &orbit);
        let [first, stiff] = orbit.multipliers() else {
            panic!("{id}: {:?}", orbit.multipliers());
        };
        // One multiplier is 1: det M = μ, tr M = 1 + μ.
        assert!(
            (a + d - 1.0 - first.re).abs() < 1e-4,
            "{id}: {first} {a} {d}"
        );
        assert!((a * d - b * c - first.re).abs() < 1e-4, "{id}: {first}");
        assert!(first.im == 0.0 && stiff.norm() < 1e-15, "{id}: {stiff}");
    }
}

/// Perturbations along the motion grow by 4e8 in a quake, and hide no other. On the line on which
/// the fault becomes slower than the plate, on the slow manifold, a cycle is a fixed point of a map
/// of φ to φ: its derivative, by motions alone, is the multiplier.
#[test]
fn multipliers_of_quakes_are_those_of_return_maps() {
    for (id, duration, guess) in [("rs_01", 1.5e9, 5.8e8), ("rs_02", 1.3e9, 5.29e8)] {
        let (system, start) = seismic(id, duration);
        let orbit = shoot(&system, &start, Period::Free(guess)).unwrap();
        let contact = &system.contacts()[0];
        let (velocity, load) = (
            contact.belt_velocity().value(0.0),
            contact.load().value(0.0),
        );
        let slower = |start: &State| {
            let mut passages = section_through(&system, start, 0, velocity).map(Result::unwrap);
            // A start that is nearly on the manifold may pass the line at once.
            let later = |passage: &Passage<State>| passage.time > 0.1 * orbit.period();
            passages
                .find(|passage| !passage.rises && later(passage))
                .unwrap()
                .state
        };
        let here = slower(&orbit.state());
        let stiffness = 1.5625e7;
        let next = |change: f64| {
            // N b = 7.5e5: the balance of forces at this speed.
            let q = here.displacements[0] + 0.015 * load * change / stiffness;
            let state = State::new(&[q], &[0.0]).with_memory(&[here.memory[0] + change]);
            slower(&state.with_sliding(0, -velocity)).memory[0]
        };
        assert!((next(0.0) - here.memory[0]).abs() < 1e-11);
        let step = 0.05;
        let weights = [0.75, -0.15, 1.0 / 60.0];
        let differences = weights.iter().enumerate().map(|(k, weight)| {
            let change = step * (k as f64 + 1.0);
            weight * (next(change) - next(-change)) / step
        });
        let expected: f64 = differences.sum();
        let [multiplier, stiff] = orbit.multipliers() else {
            panic!("{id}: {:?}", orbit.multipliers());
        };
        println!("{id}: {multiplier} {expected} {stiff}");
        assert!(
            (multiplier - expected).norm() < 1e-9,
            "{id}: {multiplier} {expected}"
        );
    }
}

/// The spring-block cycle that the published program QDYN has frozen in its tests (Y. Luo and
/// others, `test/stickslip.py`, results `5ba3c6b008`): 15 periods between the times at which
/// friction rises through 0.5, 0.55, 0.6 and 0.65, interpolated in its 7 digits, have the mean
/// 585.48391(1). QDYN has no inertia, and a logarithm where the crate has arsinh.
#[test]
fn a_cycle_has_the_period_of_qdyn() {
    let (stress, modulus, plate) = (5e6, 2e10, 1e-6);
    let (stiffness, radiation) = (modulus / 10.0, modulus / (2.0 * 3000.0));
    let law = RateState::aging(0.6, 0.01, 0.025, 1e-5, 1e-6).unwrap();
    let periods = [1e-7, 1e-9].map(|part| {
        let mass = part * radiation * radiation / stiffness;
        let block = Structure::new(&[mass])
            .and_then(|block| block.with_ground_spring(0, stiffness))
            .and_then(|block| block.with_ground_damper(0, radiation))
            .and_then(|block| block.with_force(0, radiation * plate))
            .and_then(|block| block.with_contact(Contact::new(0, law, stress)?.on_belt(plate)))
            .unwrap();
        let start = State::new(&[0.63 * stress / stiffness], &[0.0])
            .with_memory(&[0.0])
            .with_sliding(0, -0.9 * plate);
        // Where the block becomes slow after a quake.
        let slow = section_through(&block, &start, 0, 0.1 * plate).map(Result::unwrap);
        let slow: Vec<_> = slow
            .filter(|passage| !passage.rises)
            .skip(2)
            .take(2)
            .collect();
        let guess = Period::Free(slow[1].time - slow[0].time);
        shoot(&block, &slow[1].state, guess).unwrap().period()
    });
    let [heavier, light] = periods;
    assert!((light - 585.48391).abs() < 3e-5, "{light}");
    assert!((heavier / light - 1.0).abs() < 1e-7, "{heavier} {light}");
}

/// In units of N, D_c and V_p; with the damping of radiation the Hopf point is supercritical: the
/// cycle shrinks to it where the stiffness reaches the critical one.
#[test]
fn a_cycle_shrinks_to_steady_sliding_at_the_critical_stiffness() {
    let law = RateState::aging(0.6, 0.01, 0.015, 1.0, 1e-3).unwrap();
    let (mass, damping) = (1e-4, 1e-3);
    let family = |stiffness: f64| -> Result<Structure, Error> {
        Structure::new(&[mass])?
            .with_ground_spring(0, stiffness)?
            .with_ground_damper(0, damping)?
            .with_force(0, damping)?
            .with_contact(Contact::new(0, law, 1.0)?.on_belt(1.0))
    };
    let critical = law.critical_stiffness(1.0, 1.0, mass, damping).unwrap();
    let frequency = law.hopf_frequency(1.0, 1.0, damping).unwrap();
    let stiffness = 0.97 * critical;
    let system = family(stiffness).unwrap();
    let phi = law.memory_at(1.0);
    let start = State::new(&[1.05 * law.steady(1.0) / stiffness], &[0.0]).with_memory(&[phi]);
    let late = system.simulate(start, 4000.0).unwrap().last();
    let orbit = shoot(
        &system,
        &late,
        Period::Free(std::f64::consts::TAU / frequency),
    )
    .unwrap();
    assert!(orbit.is_stable());
    let branch = follow(family, stiffness, &orbit, 0.9 * critical..1.02 * critical).unwrap();
    let [BranchEnd::Range, BranchEnd::Hopf { parameter }] = branch.ends else {
        panic!("{:?}", branch.ends);
    };
    assert!(
        (parameter / critical - 1.0).abs() < 1e-12,
        "{parameter} {critical}"
    );
}
