//! Energies, and what acts along a motion: reference data, balances that close to rounding, and
//! Newton's equation.

use serde_json::Value;
use stick_slip::EnergyBudget;
use stick_slip::nalgebra::DVector;
use stick_slip::structure::State;
use stick_slip::{
    AnyContactLaw, Contact, Coulomb, Dahl, Drive, Error, Exponential, ForceElement, LuGre, Mode,
    PolynomialSpring, Segment, Structure, Trajectory,
};

use crate::common::{Random, Worst, count, forces, larger, list, oscillator, text};
use crate::plain::Plain;
use crate::random::simulate;
use crate::reading::{cases, numbers, structure};

/// Largest energy of the motion, with all that was turned over: what rounding is measured by.
fn size(system: &Structure, motion: &Trajectory<State>, budget: &EnergyBudget) -> f64 {
    let turned = [
        &budget.force_work,
        &budget.drive_work,
        &budget.belt_work,
        &budget.friction_loss,
        &budget.normal_work,
    ];
    let turned: f64 = turned.into_iter().flatten().map(|work| work.abs()).sum();
    let stored = motion.steps().iter().map(|step| {
        let state = step.state();
        let elastic = system
            .elastic_energy(step.start_time(), state)
            .unwrap_or(0.0);
        system.kinetic_energy(state).unwrap() + elastic.abs()
    });
    turned + budget.damper_loss.abs() + budget.circulation.abs() + stored.fold(0.0, f64::max)
}

/// The balance closes, with the energy of the ends; so does that of each rigid contact.
#[track_caller]
fn check(system: &Structure, motion: &Trajectory<State>, allowed: f64, about: &str) -> f64 {
    let budget = system.energy_budget(motion).unwrap();
    // Nothing at all may happen.
    let size = size(system, motion, &budget).max(f64::MIN_POSITIVE);
    let defect = budget.defect().abs() / size;
    assert!(
        defect <= allowed,
        "{about}: {defect:e} of {size}\n{budget:?}"
    );
    // What is stored is a function of the state.
    let energy = |time: f64, state: &State| {
        system.elastic_energy(time, state).unwrap() + system.kinetic_energy(state).unwrap()
    };
    let first = &motion.steps()[0];
    let end = motion.steps().last().map_or(0.0, Segment::end_time);
    let stored = energy(end, &motion.last()) - energy(first.start_time(), first.state());
    let missing = (budget.stored - stored).abs() / size;
    assert!(
        missing <= allowed,
        "{about}: {missing:e} {stored}\n{budget:?}"
    );
    for (c, contact) in system.contacts().iter().enumerate() {
        let (drive, belt) = (budget.drive_work[c], budget.belt_work[c]);
        let spring = contact.tangential_stiffness().map_or(0.0, |stiffness| {
            let elastic = |state: &State| {
                let before = system.contacts()[..c].iter();
                let place = before
                    .filter(|c| c.tangential_stiffness().is_some())
                    .count();
                0.5 * state.memory[place].powi(2) / stiffness
            };
            elastic(&motion.last()) - elastic(motion.steps()[0].state())
        });
        let missing = (drive - belt - budget.friction_loss[c] - spring).abs() / size;
        assert!(
            missing <= allowed,
            "{about}, contact {c}: {missing:e}\n{budget:?}"
        );
        assert!(
            budget.friction_loss[c] >= -allowed * size,
            "{about}: {budget:?}"
        );
    }
    defect
}

fn start(case: &Value) -> State {
    let value = &case["start"];
    let state = State::new(&numbers(&value["q"]), &numbers(&value["v"]));
    match value.get("T") {
        Some(carried) => state.with_memory(&numbers(carried)),
        None => state,
    }
}

/// The heat of elastic contacts in the reference data, computed with 60 digits.
#[test]
fn heat_of_elastic_contacts_is_that_of_the_reference() {
    let mut compared = 0;
    let files = [
        include_str!("../data/joint_trajectories.json"),
        include_str!("../data/stiff_joint_trajectories.json"),
    ];
    for case in files.into_iter().flat_map(cases) {
        let id = text(&case["id"]);
        let system = structure(&case["system"], f64::NAN);
        let end = crate::common::number(&case["t_end"]);
        let motion = system.simulate(start(&case), end).unwrap();
        let budget = system.energy_budget(&motion).unwrap();
        let expected = numbers(&case["dissipated"]);
        let mut worst = Worst::default();
        worst.meet_all(1.0, "heat", &budget.friction_loss, &expected);
        worst.assert(id, 1e-11);
        compared += expected.len();
    }
    assert_eq!(compared, 14 + 25);
}

#[test]
fn balances_close_along_the_reference_motions() {
    let files = [
        include_str!("../data/driven_trajectories.json"),
        include_str!("../data/structure_trajectories.json"),
        include_str!("../data/contact_trajectories.json"),
        include_str!("../data/joint_trajectories.json"),
    ];
    let mut worst = 0.0_f64;
    for case in files.into_iter().flat_map(cases) {
        let contacts = list(&case["system"]["contacts"]);
        let remembers = |contact: &Value| contact.get("dwell").or(contact.get("bristle")).is_some();
        if contacts.iter().any(remembers) {
            continue;
        }
        let id = text(&case["id"]);
        let system = structure(&case["system"], f64::NAN);
        let end = crate::common::number(&case["t_end"]);
        let motion = match system.simulate(start(&case), end) {
            Ok(motion) => motion,
            Err(Error::Separation { reached, .. }) => {
                let before = reached.time * (1.0 - 1e-12);
                system.simulate(start(&case), before).unwrap()
            }
            Err(error) => panic!("{id}: {error}"),
        };
        worst = larger(worst, check(&system, &motion, 1e-13, id));
    }
    println!("{worst:e}");
}

#[test]
fn balances_close_along_random_motions() {
    let mut random = Random::new(77);
    let mut worst = 0.0_f64;
    for i in 0..count(40, 400) {
        let plain = if i % 2 == 0 {
            Plain::random(&mut random)
        } else {
            Plain::shared(&mut random, i % 4 == 1)
        };
        let start = plain.start(&mut random);
        let Ok((motion, _)) = simulate(&plain, &start, 30.0) else {
            continue;
        };
        let about = format!("{i}: {plain:?}\n{start:?}");
        worst = larger(worst, check(&plain.structure(), &motion, 2e-13, &about));
    }
    println!("{worst:e}");
}

/// Contacts that remember, a skew stiffness matrix, a load that jumps on an elastic contact with a
/// normal spring, and one that opens: everything at once.
fn everything() -> Structure {
    let law = || Exponential::new(0.4, 0.25, 0.3).unwrap();
    let load = Drive::profile(&[(0.0, 1.0), (7.3, 1.0), (7.3, 0.4), (20.0, 1.2)]).unwrap();
    let elastic = Contact::between(1, 2, Coulomb::new(0.3, 0.3).unwrap(), load)
        .and_then(|contact| contact.with_tangential_stiffness(3.0))
        .and_then(|contact| contact.with_normal_spring(&[(0, 1.0)], 0.8))
        .and_then(|contact| contact.with_load_gradient(2, 0.2))
        .unwrap();
    let opening = Contact::new(2, law(), Drive::harmonic(1.0, 0.7, 0.0).unwrap()).unwrap();
    let brush = Contact::new(1, LuGre::new(law(), 60.0, 0.1, 0.02).unwrap(), 0.5).unwrap();
    let dahl = Contact::new(0, Dahl::new(0.3, 40.0).unwrap(), 0.5).unwrap();
    let dry = Contact::new(0, AnyContactLaw::Dry(law()), 0.7).unwrap();
    let stiffness = stick_slip::nalgebra::DMatrix::from_row_slice(
        3,
        3,
        &[2.0, 0.4, 0.0, -0.6, 1.5, -0.3, 0.0, -0.3, 1.0],
    );
    let wind = Drive::sine(0.1, 0.9).unwrap();
    Structure::new(&[1.0, 0.7, 1.3])
        .and_then(|s| s.with_stiffness(stiffness)?.with_damper(0, 1, 0.1))
        .and_then(|s| s.with_ground_damper(2, 0.05)?.with_ground_damper(1, 0.1))
        .and_then(|s| s.with_force(2, Drive::harmonic(0.6, 1.1, 0.4)?))
        .and_then(|s| s.with_contact(elastic.on_belt(0.05)))
        .and_then(|s| s.with_contact(opening.on_belt(wind.with_constant(0.3)?)))
        .and_then(|s| s.with_contact(brush.on_belt(0.2))?.with_contact(dahl))
        .and_then(|s| s.with_contact(dry.on_belt(-0.2)))
        .unwrap()
}

#[test]
fn a_balance_with_every_kind_of_part_closes() {
    let system = everything();
    let motion = system
        .simulate(State::new(&[0.5, 0.0, -0.3], &[0.1; 3]), 30.0)
        .unwrap();
    assert!(motion.events().len() > 20, "{}", motion.events().len());
    let budget = system.energy_budget(&motion).unwrap();
    println!("{budget:?} {:e}", budget.defect());
    assert!(budget.defect().abs() < 1e-13 * size(&system, &motion, &budget));
    for part in [
        budget.circulation,
        budget.normal_work[0],
        budget.damper_loss,
        budget.friction_loss[0],
        budget.force_work[2],
    ] {
        assert!(part.abs() > 1e-3, "{budget:?}");
    }
    // A looser tolerance is seen.
    let loose = stick_slip::Integrator::new().with_tolerance(1e-3).unwrap();
    let smooth = oscillator([1.0, 0.1, 1.0], Drive::harmonic(1.0, 0.8, 0.0).unwrap()).unwrap();
    let defect = |integrator: stick_slip::Integrator| {
        let motion = integrator
            .simulate(&smooth, State::at_rest(1), 30.0)
            .unwrap();
        smooth.energy_budget(&motion).unwrap().defect().abs()
    };
    let (exact, about) = (defect(stick_slip::Integrator::new()), defect(loose));
    assert!(
        exact < 1e-13 && about > 1e-9 && about < 1e-2,
        "{exact:e} {about:e}"
    );
}

/// A spring that becomes five times as stiff at t = 1: up to there the energy is that of the start,
/// and beyond it has risen by four times the energy of the spring.
#[test]
fn a_budget_that_ends_at_a_jump_ends_before_it() {
    let stiffness = Drive::profile(&[(1.0, 1.0), (1.0, 5.0)]).unwrap();
    let spring = PolynomialSpring::new(&[1.0]).unwrap();
    let mass = ForceElement::new(0, spring)
        .and_then(|spring| spring.with_factor(stiffness))
        .and_then(|spring| Structure::new(&[1.0])?.with_element(spring))
        .unwrap();
    let stored = |duration: f64| {
        let start = State::new(&[1.0], &[0.0]);
        let motion = mass.simulate(start, duration).unwrap();
        let budget = mass.energy_budget(&motion).unwrap();
        assert!(budget.defect().abs() < 1e-15, "{budget:?}");
        budget.stored
    };
    let risen = 2.0 * 1.0_f64.cos().powi(2);
    assert!(stored(1.0).abs() < 1e-15);
    assert!((stored(1.5) - risen).abs() < 1e-15);
}

/// Samples against the engine at an instant, against Newton's equation, and against sums over many
/// samples.
#[test]
fn samples_hold_what_acts() {
    let system = everything();
    let motion = system
        .simulate(State::new(&[0.5, 0.0, -0.3], &[0.1; 3]), 30.0)
        .unwrap();
    let mut compared = 0;
    for sample in system.samples(&motion, 0.0137).unwrap() {
        let state = &sample.state;
        assert_eq!(Some(state), motion.state_at(sample.time).as_ref());
        for (c, mode) in sample.modes.iter().enumerate() {
            assert_eq!(Some(*mode), motion.mode_at(c, sample.time));
            assert_eq!(*mode == Mode::Open, sample.loads[c] == 0.0);
        }
        let vector = |x: &[f64]| DVector::from_column_slice(x);
        let mut rest = system.mass_matrix().as_ref() * vector(&sample.accelerations)
            + system.damping() * vector(&state.velocities)
            + system.stiffness() * vector(&state.displacements);
        for (c, contact) in system.contacts().iter().enumerate() {
            for &(j, b) in contact.direction() {
                rest[j] += b * sample.friction[c];
            }
            if let Some((direction, _)) = contact.normal_spring() {
                for &(j, d) in direction {
                    rest[j] += d * sample.loads[c];
                }
            }
        }
        for (j, force) in system.forces().iter().enumerate() {
            rest[j] -= force.value(sample.time);
        }
        assert!(rest.amax() < 1e-13, "{}: {rest}", sample.time);
        // Not beside events, where the engine may decide otherwise, and not where a belt of varying
        // velocity carries a mass along: rounding of its velocity alone is slip to the engine.
        if sample.modes[1] == Mode::Stick {
            continue;
        }
        let near = |event: &stick_slip::Event<State>| (event.time - sample.time).abs() < 1e-6;
        if motion.events().iter().any(near) {
            continue;
        }
        let carried = forces(&system.carried(sample.time, state).unwrap());
        let acceleration = system.acceleration(sample.time, state).unwrap();
        for (found, expected) in [
            (&sample.friction, carried),
            (&sample.accelerations, acceleration),
        ] {
            for (found, expected) in std::iter::zip(found, expected) {
                assert!((found - expected).abs() < 1e-12, "{sample:?} {expected}");
            }
        }
        compared += 1;
    }
    assert!(compared > 1000, "{compared}");

    // Work as sums over samples, to the order of the midpoint rule.
    let interval = 1e-4;
    let budget = system.energy_budget(&motion).unwrap();
    let mut sums = vec![0.0; system.contacts().len()];
    for sample in system.samples(&motion, interval).unwrap() {
        for (c, contact) in system.contacts().iter().enumerate() {
            let along = contact.direction().iter();
            let velocity: f64 = along.map(|&(j, b)| b * sample.state.velocities[j]).sum();
            sums[c] -= interval * sample.friction[c] * velocity;
        }
    }
    for (sum, work) in std::iter::zip(sums, &budget.belt_work) {
        assert!((sum - work).abs() < 1e-3, "{sum} {work}");
    }
}

#[test]
fn motions_of_other_structures_are_refused() {
    let one = Structure::new(&[1.0]).unwrap();
    let motion = one.simulate(State::at_rest(1), 1.0).unwrap();
    let law = Coulomb::new(0.4, 0.3).unwrap();
    let rubbed = one
        .clone()
        .with_contact(Contact::new(0, law, 1.0).unwrap())
        .unwrap();
    let bristles = Contact::new(0, Dahl::new(0.4, 10.0).unwrap(), 1.0).unwrap();
    let brushed = one.clone().with_contact(bristles).unwrap();
    let of_rubbed = rubbed.simulate(State::at_rest(1), 1.0).unwrap();
    for (system, motion, name) in [
        (
            &Structure::new(&[1.0, 1.0]).unwrap(),
            &motion,
            "displacements",
        ),
        (&rubbed, &motion, "contacts"),
        (&brushed, &of_rubbed, "memory"),
    ] {
        let found = system.energy_budget(motion);
        assert!(
            matches!(found, Err(Error::WrongSize { name: other, .. }) if other == name),
            "{found:?}"
        );
        assert!(system.samples(motion, 0.1).map(|_| ()).is_err());
    }
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(one.samples(&motion, bad).map(|_| ()).is_err());
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let state = State::new(&[bad], &[0.0]);
        assert!(one.elastic_energy(0.0, &state).is_err());
        assert!(one.kinetic_energy(&state).is_err());
        assert!(one.elastic_energy(bad, &State::at_rest(1)).is_err());
    }
    // A motion of no length.
    let none = one.simulate(State::at_rest(1), 0.0).unwrap();
    assert_eq!(one.energy_budget(&none).unwrap().stored, 0.0);
    assert_eq!(one.samples(&none, 1.0).unwrap().count(), 1);
}

/// A motion whose squares overflow is computed; its energies are refused.
#[test]
fn energies_that_overflow_are_refused() {
    let one = Structure::new(&[1.0]).unwrap();
    let one = one.with_ground_spring(0, 1.0).unwrap();
    let far = State::new(&[1e200], &[2e200]);
    let refused = |found: Result<f64, Error>| {
        let is_refused = matches!(
            found,
            Err(Error::InvalidState { displacement, velocity })
                if displacement.abs().max(velocity.abs()) > 1e199
        );
        assert!(is_refused, "{found:?}");
    };
    refused(one.kinetic_energy(&far));
    refused(one.elastic_energy(0.0, &far));
    let motion = one.simulate(far, 1.0).unwrap();
    refused(one.energy_budget(&motion).map(|budget| budget.stored));
}
