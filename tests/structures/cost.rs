//! What a motion costs: the number of its steps, for each way in which a step is expanded
//! (`src/structure/engine/expand.rs`). The numbers are exact, so that a change of the cost is seen.

use stick_slip::structure::{ForceElement, State};
use stick_slip::{
    Contact, Coulomb, Dahl, Drive, Dwell, Error, Exponential, LuGre, Pendulum, Polynomial,
    Structure,
};

use crate::common::one_mass;

/// A contact of coordinate i on the belt.
fn contact(i: usize, load: impl Into<Drive>) -> Result<Contact, Error> {
    let law = Polynomial::new(0.4, 0.25, 0.5)?;
    Ok(Contact::new(i, law, load)?.on_belt(0.2))
}

/// Masses in a row, each on its contact.
fn row(n: usize) -> Result<Structure, Error> {
    (0..n).try_fold(Structure::new(&vec![1.0; n])?, |row, i| {
        let row = row.with_ground_spring(i, 1.0 + 0.1 * i as f64)?;
        let row = row.with_ground_damper(i, 0.05)?;
        row.with_spring(i, (i + 1) % n, 0.5)?
            .with_contact(contact(i, 1.0)?)
    })
}

/// A name, a system, and the numbers of steps and of events.
type Case = (&'static str, Structure, [usize; 2]);

fn structures() -> Result<Vec<Case>, Error> {
    let sprung = |contact: Contact| one_mass([1.0, 0.1, 1.0], 0.0, contact.on_belt(0.2));
    // A driven mass beside one on its contact.
    let beside = |driven: Contact| {
        let force = Drive::harmonic(0.3, 0.7, 0.0)?;
        let pair = Structure::new(&[1.0, 1.0])?.with_spring(0, 1, 0.5)?;
        pair.with_ground_spring(0, 1.0)?
            .with_force(0, force)?
            .with_contacts([contact(1, 1.0)?, driven])
    };
    let coulomb = Coulomb::new(0.4, 0.25)?;
    let joint = Contact::between(0, 1, Coulomb::new(0.3, 0.3)?, 0.5)?;
    let elastic = joint.clone().with_tangential_stiffness(5.0)?;
    let pressed = contact(0, 1.0)?.with_normal_spring(&[(1, 1.0)], 0.5)?;
    let follower = contact(0, 1.0)?.with_load_gradient(1, 0.1)?;
    let varying = Drive::harmonic(0.3, 0.9, 0.0)?.with_constant(1.0)?;
    let held = Contact::new(0, coulomb, 9.0)?;
    let clock = Contact::new(0, Dwell::exponential(coulomb, 0.6, 2.0)?, 1.0)?;
    let soft = Contact::new(0, Dahl::new(0.4, 10.0)?, 1.0)?;
    let stiff = LuGre::new(Exponential::new(0.4, 0.25, 0.1)?, 1e5, 300.0, 0.0)?;
    let nonlinear = ForceElement::new(0, Pendulum::new(0.5, 1.0)?)?;
    Ok(vec![
        ("one that slips alone", sprung(contact(0, 1.0)?)?, [66, 16]),
        ("beside one that is held", beside(held)?, [51, 10]),
        ("a group of two", beside(contact(0, 1.0)?)?, [104, 28]),
        ("a group of four", row(4)?, [132, 56]),
        ("three groups", row(9)?, [238, 186]),
        ("a joint", beside(joint)?, [67, 35]),
        ("an elastic joint", beside(elastic)?, [87, 37]),
        ("a load in time", beside(contact(0, varying)?)?, [99, 26]),
        ("a load of another mass", beside(follower)?, [101, 28]),
        ("a normal spring", beside(pressed)?, [99, 23]),
        (
            "a nonlinear spring",
            row(4)?.with_element(nonlinear)?,
            [142, 62],
        ),
        ("a clock of rest", sprung(clock)?, [23, 15]),
        ("soft bristles", sprung(soft)?, [40, 2]),
        (
            "stiff bristles",
            sprung(Contact::new(0, stiff, 1.0)?)?,
            [850, 32],
        ),
        (
            "constant velocities",
            Structure::new(&[1.0])?.with_contact(contact(0, 1.0)?)?,
            [2, 1],
        ),
    ])
}

#[test]
fn each_way_to_expand_a_step_takes_its_number_of_steps() {
    let mut found = Vec::new();
    let mut expected = Vec::new();
    for (name, structure, steps_and_events) in structures().unwrap() {
        let start = State::at_rest(structure.len());
        let motion = structure.simulate(start, 50.0).unwrap();
        found.push((name, [motion.steps().len(), motion.events().len()]));
        expected.push((name, steps_and_events));
    }
    assert_eq!(found, expected);
}
