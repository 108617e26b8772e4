//! Random structures whose contacts share coordinates: nothing panics, hangs or is missed.

use stick_slip::{AnyLaw, Error, FrictionLaw, Integrator, Mode, Segment};

use crate::common::{Random, count, larger};
use crate::plain::{Plain, Seen};
use crate::random::{Comparison, simulate, told};
use crate::work::Work;

/// Laws of contacts and of motion along every step.
#[test]
fn motions_of_joints_obey_the_law() {
    let mut random = Random::new(77);
    let (mut events, mut ended, mut worst) = (0, 0, 0.0_f64);
    let cases = count(40, 600);
    for i in 0..cases {
        let plain = Plain::shared(&mut random, i % 3 == 0);
        let start = plain.start_at_rest(&mut random);
        let structure = plain.structure();
        let laws: Vec<AnyLaw> = plain.contacts.iter().map(|c| c.law.clone()).collect();
        let work = Work::new(&structure, &laws);
        let about = || format!("{i}: {plain:?}\n{start:?}");
        let flow = match Integrator::new().flow(&structure, start.clone()) {
            Err(Error::Separation { .. }) => continue,
            flow => flow.unwrap(),
        };
        let mut largest = 1.0_f64;
        let mut steps = 0;
        for step in flow {
            let step = match step {
                Ok(step) => step,
                Err(Error::Separation { .. }) => {
                    ended += 1;
                    break;
                }
                Err(error) => panic!("{error}\n{}", about()),
            };
            steps += 1;
            assert!(steps < 5000, "{}", about());
            events += step.events().len();
            let numbers = step
                .state()
                .displacements
                .iter()
                .chain(&step.state().velocities);
            largest = numbers.fold(largest, |largest, x| largest.max(x.abs()));
            if step.start_time() > 20.0 || step.duration() > 1e3 {
                break;
            }
            if step.duration() == 0.0 {
                continue;
            }
            let allowed = 1e-10 * largest * largest;
            for part in [1e-3, 0.35, 0.6, 0.999] {
                let t = part * step.duration();
                let (time, state) = (step.start_time() + t, step.state_at(t));
                let carried = work.carried(time, &state, step.modes());
                let is_determined = work.is_determined(step.modes());
                let v = stick_slip::nalgebra::DVector::from_column_slice(&state.velocities);
                for (c, contact) in structure.contacts().iter().enumerate() {
                    let belt = contact.belt_velocity().value(time);
                    let r = plain.contacts[c].direction.dot(&v) - belt;
                    let load = contact.load_at(time, &state.displacements);
                    let holds = match step.modes()[c] {
                        Mode::Open => load <= allowed,
                        Mode::Slip(direction) => {
                            direction.sign() * r >= -allowed && load >= -allowed
                        }
                        Mode::Stick => {
                            let most = load * laws[c].static_coefficient();
                            let is_within = carried[c].abs() <= most + 100.0 * allowed;
                            r.abs() <= allowed && (is_within || !is_determined)
                        }
                    };
                    assert!(holds, "contact {c} at {time}: {r:e} {load:e} {}", about());
                }
            }
            let missing = work.missing(&step);
            let part = missing.part(1e-12);
            worst = larger(worst, part);
            let time = step.start_time();
            assert!(part < 1e-12, "{missing:?} at {time} {}", about());
        }
    }
    println!("{events} events, {ended} ended early, energy to {worst:.1e}");
    assert!(events > 4 * cases, "{events}");
}

/// The same events as the simple integrator sees, where that is sure of itself.
#[test]
fn a_simple_integrator_sees_the_same_events_of_joints() {
    let mut random = Random::new(501);
    let mut all = Comparison::default();
    let (mut ambiguous, mut at_rest, mut dependent) = (0, 0, 0);
    let cases = count(20, 40);
    for i in 0..cases {
        let (plain, start) = loop {
            let plain = Plain::shared(&mut random, false);
            let start = plain.start_at_rest(&mut random);
            if plain.is_clear(&start) {
                break (plain, start);
            }
            ambiguous += 1;
        };
        at_rest += usize::from(plain.resting(&start) > 1);
        let duration = 8.0;
        const STEP: f64 = 4e-3;
        // What is at rest within rounding may come to rest a moment later.
        let later = |mut events: Vec<Seen>| {
            events.retain(|event| event.0 > 1e-10 || event.2 == 'u');
            events
        };
        let [coarse, fine] = [2.0 * STEP, STEP].map(|h| later(plain.events(&start, duration, h)));
        // The simple integrator knows no contacts at rest with dependent directions.
        let (motion, end) = simulate(&plain, &start, duration).unwrap();
        if fine.iter().chain(&coarse).any(|seen| seen.2 == 'u') {
            dependent += 1;
            continue;
        }
        let mut found = later(told(&motion));
        found.extend(end);
        let motion = format!("{i}:\n{plain:?}\n{start:?}");
        all.add(&found, [&coarse, &fine], duration, &motion);
    }
    println!("{all}; {at_rest} with several at rest, {ambiguous} ambiguous starts");
    println!("{dependent} with dependent contacts at rest");
    assert!(at_rest * 5 > cases, "{at_rest}");
    assert!(all.compared > 3 * cases, "{all}");
    assert!(all.undecided * 5 < cases, "{all}");
}
