//! One slider under rate-and-state friction, over five to fifteen decades of the sliding speed:
//! passages, peaks and states computed independently to 25 digits.

use serde_json::{Value, json};
use stick_slip::structure::State;
use stick_slip::structure::Step;
use stick_slip::{Integrator, Segment, Structure, Trajectory};

use crate::common::{Worst, list, number, text};
use crate::reading::{cases, numbers, remembering};

const CASES: &str = include_str!("../data/rate_state_cycles_of_one.json");

/// The slider of a case, in place of one without inertia that with a mass > 0, if there is one; and
/// the velocity of its load point.
fn slider(case: &Value, mass: f64) -> (Option<Structure>, f64) {
    let mut system = case["system"].clone();
    let velocity = number(&system["contacts"][0]["w"]["value"]);
    let is_light = number(&system["mass"][0][0]) == 0.0;
    if is_light {
        system["mass"] = json!([[format!("{mass:e}")]]);
    }
    let exists = !is_light || mass > 0.0;
    (exists.then(|| remembering(&system)), velocity)
}

fn start(case: &Value) -> State {
    let start = &case["start"];
    let memory = numbers(&start["phi"]);
    let speed = numbers(&start["r"])[0];
    let state = State::new(&numbers(&start["q"]), &[0.0]);
    state.with_memory(&memory).with_sliding(0, speed)
}

/// The times at which the sliding speed passes a threshold, and true where it rises.
fn passages(motion: &Trajectory<State>, threshold: f64) -> Vec<(f64, bool)> {
    /// Each part has one passage at most.
    const PARTS: usize = 16;
    let above = |t: f64| -motion.sliding_velocity(0, t) > threshold;
    let mut found = Vec::new();
    for step in motion.steps() {
        let place = |k: usize| step.start_time() + step.duration() * k as f64 / PARTS as f64;
        for k in 0..PARTS {
            let [mut low, mut high] = [place(k), place(k + 1)];
            let rises = above(high);
            if above(low) == rises {
                continue;
            }
            loop {
                let middle = low + 0.5 * (high - low);
                if middle <= low || middle >= high {
                    break;
                }
                let end = if above(middle) == rises {
                    &mut high
                } else {
                    &mut low
                };
                *end = middle;
            }
            found.push((high, rises));
        }
    }
    found
}

fn motion(system: &Structure, case: &Value, tolerance: f64) -> Trajectory<State> {
    Integrator::new()
        .with_tolerance(tolerance)
        .and_then(|integrator| integrator.simulate(system, start(case), number(&case["t_end"])))
        .unwrap()
}

/// The passages of the load point's velocity.
fn expected_passages(case: &Value) -> Vec<(f64, bool)> {
    let kind = |section: &Value| match text(&section["kind"]) {
        "faster" => Some(true),
        "slower" => Some(false),
        _ => None,
    };
    let sections = list(&case["sections"]).iter();
    let passages = sections.filter_map(|section| Some((number(&section["t"]), kind(section)?)));
    passages.collect()
}

/// At the default tolerance the speed has a relative error of some f/a = 60 to 75 roundings at
/// each time of a motion over decades; at others the tolerance, magnified by the instability.
#[test]
fn motions_have_the_reference_passages_and_states() {
    let (mut all, mut cycles) = (0, 0);
    for case in cases(CASES) {
        let (system, velocity) = slider(&case, f64::NAN);
        let Some(system) = system else {
            continue;
        };
        let id = text(&case["id"]);
        let levels = [(1e-6, 1e-5), (1e-9, 2e-9), (1e-12, 2e-12), (1e-14, 1e-13)];
        for (place, (tolerance, allowed)) in levels.into_iter().enumerate() {
            let about = &format!("{id} {tolerance:e}");
            let motion = motion(&system, &case, tolerance);
            let (found, expected) = (passages(&motion, velocity), expected_passages(&case));
            let mut worst = Worst::default();
            assert_eq!(found.len(), expected.len(), "{about}");
            for (found, expected) in std::iter::zip(&found, &expected) {
                assert_eq!(found.1, expected.1, "{about}");
                worst.meet_within(allowed * expected.0, "passage", found.0, expected.0);
                all += 1;
            }
            for state in list(&case["states"]) {
                let time = number(&state["t"]);
                let there = motion.state_at(time).unwrap();
                let [q, r, phi] = ["q", "r", "phi"].map(|name| numbers(&state[name])[0]);
                worst.meet_within(allowed * q, "q", there.displacements[0], q);
                // Velocity and memory change by their sizes over a small part of a cycle.
                let speed = motion.sliding_velocity(0, time);
                worst.meet_within(20.0 * allowed * r.abs(), "r", speed, r);
                worst.meet_within(20.0 * allowed, "φ", there.memory[0], phi);
            }
            worst.assert(about, 1.0);
            // The number of steps of a cycle that a trial with the same series took.
            let most = match id {
                "rs_01" => [97, 132, 178, 178],
                "rs_02" => [86, 118, 163, 163],
                _ => continue,
            };
            let faster = found.iter().filter(|(_, rises)| *rises);
            let times: Vec<f64> = faster.map(|(time, _)| *time).collect();
            for period in times.windows(2) {
                let is_within = |step: &&Step| (period[0]..period[1]).contains(&step.end_time());
                let steps = motion.steps().iter().filter(is_within).count();
                assert!(10 * steps <= 13 * most[place], "{about}: {steps} steps");
                cycles += 1;
            }
        }
    }
    assert_eq!((all, cycles), (4 * 22, 4 * 4));
}

/// Without inertia a small mass is taken: periods tend to those without it in proportion to it.
#[test]
fn periods_without_inertia_are_the_limit_of_small_masses() {
    let cases = cases(CASES);
    let case = cases.iter().find(|case| text(&case["id"]) == "rs_05");
    let case = case.unwrap();
    let expected = numbers(&case["periods"])[1];
    let [damping, stiffness] = ["C", "K"].map(|name| numbers(&case["system"][name][0])[0]);
    let mass = 1e-6 * damping * damping / stiffness;
    let [large, small, least] = [mass, 0.01 * mass, 1e-8].map(|mass| {
        let (system, velocity) = slider(case, mass);
        let motion = motion(&system.unwrap(), case, 1e-14);
        let passages = passages(&motion, velocity);
        let faster: Vec<_> = passages.iter().filter(|(_, rises)| *rises).collect();
        let [.., one, other] = faster[..] else {
            panic!("{faster:?}");
        };
        (other.0 - one.0) / expected - 1.0
    });
    assert!(least.abs() < 1e-14, "{least:e}");
    assert!((large.abs() - 5e-8).abs() < 5e-9, "{large:e}");
    assert!((large / small - 100.0).abs() < 0.1, "{large:e} {small:e}");
}
