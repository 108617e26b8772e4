//! What is refused, with an error that names the element. Single numbers that no structure takes:
//! tests/contract/refusals.rs.

use crate::common::polynomials::Polynomials;
use crate::common::{message, refused};
use stick_slip::nalgebra::DMatrix;
use stick_slip::structure::{Element, State};
use stick_slip::{Contact, Coulomb, Dahl, Drive, Error, MassOnBelt, Structure};

fn law() -> Coulomb {
    Coulomb::new(0.4, 0.3).unwrap()
}

const NOT_FINITE: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

fn masses(n: usize) -> Structure {
    Structure::new(&vec![1.0; n]).unwrap()
}

/// The element and the number of a refusal.
#[track_caller]
fn element<T>(result: Result<T, Error>) -> (Element, f64) {
    refused!(result => Error::BadElement { element, value, .. }, (element, value))
}

#[test]
fn mass_matrices_are_symmetric_and_definite() {
    let made = |n: usize, entries: &[f64]| {
        Structure::with_mass_matrix(DMatrix::from_row_slice(n, entries.len() / n, entries))
    };
    for (rows, columns) in [(1, 2), (2, 1), (0, 3)] {
        let made = Structure::with_mass_matrix(DMatrix::from_element(rows, columns, 1.0));
        assert!(matches!(made, Err(Error::WrongSize { .. })), "{rows}");
    }
    let skew = made(2, &[1.0, 0.5, 0.4, 1.0]).unwrap_err();
    assert_eq!(skew, Error::NotSymmetric { row: 0, column: 1 });
    message(
        made(2, &[1.0, 0.5, 0.4, 1.0]),
        &["symmetric", "(0, 1)", "(1, 0)"],
    );
    // Rounding of ΦᵀMΦ is not meant.
    let rounded = made(2, &[1.0, 0.1 + 0.2, 0.3, 1.0]).unwrap();
    let mass = rounded.mass_matrix();
    assert_eq!(mass[(0, 1)], mass[(1, 0)]);
    // One coordinate that only moves with others has no mass of its own.
    for entries in [
        [1.0, 1.0, 1.0, 1.0],
        [1.0, 2.0, 2.0, 1.0],
        [1.0, 1.0, 1.0, 1.0 + 2.0 * f64::EPSILON],
    ] {
        let singular = made(2, &entries).unwrap_err();
        let expected = Error::NotPositiveDefinite { row: 1 };
        assert_eq!(singular, expected, "{entries:?}");
    }
    message(
        made(2, &[1.0, 2.0, 2.0, 1.0]),
        &["coordinate 1", "condensation"],
    );
    assert!(made(2, &[1e-9, 1.0, 1.0, 2e9]).is_ok());
    // A row that the factorisation cannot even compute.
    let tiny = [1e-320, 0.0, 1.0, 0.0, 1.0, 0.0, 1.0, 0.0, 1e300];
    assert_eq!(made(3, &tiny), Err(Error::NotPositiveDefinite { row: 2 }));
}

/// Matrices are dense: a number of coordinates beyond the bound is refused before they exist. (With
/// 200 000 coordinates one of them would take 320 GB.)
#[test]
fn the_number_of_coordinates_is_bounded() {
    let most = Structure::MAX_COORDINATES;
    for n in [most + 1, 200_000] {
        let refused = refused!(Structure::new(&vec![1.0; n]) =>
            Error::InvalidParameter { of, name, value, .. }, (of, name, value));
        assert_eq!(refused, ("Structure", "masses", n as f64));
        let parts = [&format!("masses = {n}")[..], "at most 4096", "modes"];
        message(Structure::new(&vec![1.0; n]), &parts);
    }
    // The masses themselves are not looked at first.
    message(Structure::new(&vec![-1.0; most + 1]), &["at most 4096"]);
    let mass = DMatrix::<f64>::zeros(most + 1, most + 1);
    message(Structure::with_mass_matrix(mass), &["at most 4096"]);
    assert_eq!(masses(most).len(), most);
}

/// Contacts that share a coordinate are coupled, each with each: their number is bounded, too.
#[test]
fn the_number_of_contacts_is_bounded() {
    let contact = Contact::new(0, law(), 1.0).unwrap();
    let many = |n: usize| masses(1).with_contacts(vec![contact.clone(); n]);
    let most = Structure::MAX_CONTACTS;
    assert_eq!(many(most).unwrap().contacts().len(), most);
    message(many(most + 1), &["contacts = 4097", "at most 4096", "one"]);
}

/// The words about a load that is not positive say what describes a gap, and those about too many
/// dependent contacts in stick what can replace them.
#[test]
fn remedies_fit_gaps_and_dependent_contacts() {
    for load in [0.0, -2.5, f64::NAN] {
        let gap = Contact::new(0, law(), load).and_then(|c| masses(1).with_contact(c));
        message(
            gap.map(drop),
            &["load > 0", "gap", "`Contact::with_normal_spring`"],
        );
    }
    // Ten masses on the ground, each joined to the next: C(19, 9) sets.
    let ground = (0..10).map(|i| Contact::new(i, law(), 1.0).unwrap());
    let joints = (0..9).map(|i| Contact::between(i, i + 1, law(), 1.0).unwrap());
    let chain = masses(10).with_contacts(ground.chain(joints)).unwrap();
    let stuck = chain.simulate(State::at_rest(10), 1.0);
    let Err(Error::TooManyMechanisms {
        contacts,
        subsets: 92378,
        most: 10_000,
        reached,
    }) = &stuck
    else {
        panic!("{stuck:?}")
    };
    assert!(contacts.iter().copied().eq(0..19), "{contacts:?}");
    assert_eq!(reached.time, 0.0);
    let remedies = ["`with_tangential_stiffness`", "sum of their limits"];
    message(stuck, &remedies);
}

#[test]
fn directions_have_different_coordinates_and_numbers_that_are_not_0() {
    let bad: [&[(usize, f64)]; 7] = [
        &[],
        &[(0, 0.0)],
        &[(0, 0.0), (1, -0.0)],
        &[(0, 1.0), (0, -1.0)],
        &[(1, 1.0), (0, 1.0), (1, 0.0)],
        &[(0, 1.0), (1, f64::NAN)],
        &[(0, f64::INFINITY)],
    ];
    for direction in bad {
        let made = Contact::along(direction, law(), 1.0);
        let said = refused!(&made => Error::BadDirection { direction }, direction);
        // NaN is not equal to itself.
        assert_eq!(format!("{said:?}"), format!("{direction:?}"));
        message(made, &["the direction", "at least one pair"]);
    }
    let one = Contact::between(3, 3, law(), 1.0);
    let direction = refused!(one => Error::BadDirection { direction }, direction);
    assert_eq!(direction, [(3, 1.0), (3, -1.0)]);
    // Zeros are left out, and the order does not matter.
    let contact = Contact::along(&[(2, 1.0), (1, 0.0), (0, -2.0)], law(), 1.0).unwrap();
    assert_eq!(contact.direction(), [(0, -2.0), (2, 1.0)]);
    assert_eq!(contact.coordinate(), 2);
    for (i, j) in [(7, 0), (0, 7)] {
        let far = masses(2).with_contact(Contact::between(i, j, law(), 1.0).unwrap());
        let element = refused!(far =>
            Error::NoSuchCoordinate { element, coordinate: 7, count: 2 }, element);
        assert_eq!(element, Element::Contact(0));
    }
}

/// b may have any unit, but where b²/m is no normal number its digits are lost.
#[test]
fn directions_keep_their_digits() {
    let ends = |b: f64| {
        let joint = Contact::along(&[(0, b), (1, -b)], law(), 1.0 / b)?;
        let pair = masses(2).with_ground_spring(0, 1.0)?.with_contact(joint)?;
        let motion = pair.simulate(State::new(&[1.0, 0.0], &[0.5, 0.0]), 20.0)?;
        Ok(motion.last().displacements)
    };
    let expected = ends(1.0).unwrap();
    for b in [1e-140, 1e-100, 1e100, 1e140] {
        for (found, expected) in std::iter::zip(ends(b).unwrap(), &expected) {
            assert!((found - expected).abs() < 1e-13, "{b:e}: {found}");
        }
    }
    for b in [1e-300, 1e-160, 1e160, 1e300] {
        assert_eq!(element(ends(b)).0, Element::Contact(0));
        message(ends(b), &["contact 0", "Σ b_j²/m_j", "unit"]);
    }
    for mass in [1e-320, 1e-300] {
        let contact = Contact::new(0, law(), 1.0).unwrap();
        let light = Structure::new(&[mass]).unwrap().with_contact(contact);
        assert_eq!(element(light).0, Element::Contact(0));
    }
}

#[test]
fn what_is_carried_is_asked_in_a_state_at_a_time() {
    let joint = Contact::between(0, 1, law(), 1.0).unwrap();
    let pair = masses(2).with_contact(joint).unwrap();
    for bad in NOT_FINITE {
        let start = State::new(&[0.0, bad], &[0.0, 0.0]);
        assert!(pair.carried(0.0, &start).is_err());
        assert!(
            pair.acceleration(0.0, &State::new(&[0.0; 2], &[bad, 0.0]))
                .is_err()
        );
    }
    for n in [0, 1, 3] {
        let state = State::at_rest(n);
        let simulated = pair.simulate(state.clone(), 1.0).map(|_| ()).unwrap_err();
        assert_eq!(pair.carried(0.0, &state), Err(simulated.clone()));
        assert_eq!(pair.acceleration(0.0, &state), Err(simulated));
    }
}

#[test]
fn springs_and_dampers_connect_coordinates_that_exist() {
    let missing = Error::NoSuchCoordinate {
        element: Element::Stiffness(0, 2),
        coordinate: 2,
        count: 2,
    };
    assert_eq!(masses(2).with_spring(0, 2, 1.0), Err(missing));
    message(
        masses(2).with_damper(5, 0, 1.0),
        &["damping (5, 0)", "no coordinate 5", "the 2"],
    );
    assert!(masses(2).with_ground_spring(usize::MAX, 1.0).is_err());
    assert!(masses(2).with_ground_damper(2, 1.0).is_err());
    // Both ends on one coordinate.
    assert_eq!(
        element(masses(2).with_spring(1, 1, 3.0)),
        (Element::Stiffness(1, 1), 3.0)
    );
    assert_eq!(
        element(masses(2).with_damper(0, 0, 3.0)),
        (Element::Damping(0, 0), 3.0)
    );
    // A sum that overflows.
    let huge = masses(2).with_ground_spring(0, f64::MAX).unwrap();
    assert_eq!(
        element(huge.with_spring(0, 1, f64::MAX)).0,
        Element::Stiffness(0, 1)
    );
    // Negative ones are allowed.
    let negative = masses(2).with_spring(0, 1, -2.0).unwrap();
    assert_eq!(negative.stiffness()[(0, 0)], -2.0);
    assert_eq!(negative.stiffness()[(1, 0)], 2.0);
}

#[test]
fn matrices_fit() {
    for (rows, columns) in [(2, 3), (3, 2), (0, 0), (4, 4)] {
        let matrix = DMatrix::zeros(rows, columns);
        let sizes = refused!(masses(3).with_stiffness(matrix.clone()) =>
            Error::WrongSize { found, expected, .. }, [found, expected]);
        assert_ne!(sizes[0], sizes[1]);
        message(
            masses(3).with_damping(matrix),
            &["damping matrix", "3 are needed"],
        );
    }
}

#[test]
fn forces_act_on_coordinates_that_exist_and_add_up_to_finite_ones() {
    message(
        masses(2).with_force(2, 1.0),
        &["force on coordinate 2", "no coordinate 2"],
    );
    let huge = masses(1).with_force(0, f64::MAX).unwrap();
    assert_eq!(element(huge.with_force(0, f64::MAX)).0, Element::Force(0));
    let large = Drive::sine(f64::MAX, 1.0).unwrap();
    let once = masses(1).with_force(0, large.clone()).unwrap();
    assert_eq!(element(once.with_force(0, large)).0, Element::Force(0));
}

#[test]
fn loads_that_vary_may_fall_to_zero_and_gradients_add_up() {
    // One that is given in time may fall to 0.
    let clutch = Drive::profile(&[(0.0, 1.0), (1.0, -0.5), (2.0, 1.0)]).unwrap();
    assert!(Contact::new(0, law(), clutch).is_ok());
    let contact = || Contact::new(0, law(), 1.0).unwrap();
    let steep = contact().with_load_gradient(0, f64::MAX).unwrap();
    assert!(steep.with_load_gradient(0, f64::MAX).is_err());
    // What adds up to 0 is not there.
    let level = contact()
        .with_load_gradient(1, 2.0)
        .and_then(|contact| contact.with_load_gradient(1, -2.0))
        .unwrap();
    assert_eq!(level.load_gradient(), []);
    assert!(masses(1).with_contact(level).is_ok());
}

#[test]
fn contacts_have_coordinates_of_the_structure() {
    let contact = |coordinate| Contact::new(coordinate, law(), 1.0).unwrap();
    // A coordinate may have several.
    let twice = masses(3)
        .with_contact(contact(2))
        .and_then(|structure| structure.with_contact(contact(2)));
    assert_eq!(twice.unwrap().contacts().len(), 2);
    let between = Contact::between(1, 4, law(), 1.0).unwrap();
    message(
        masses(2).with_contact(between),
        &["contact 0", "no coordinate 4"],
    );
    message(
        masses(2).with_contact(contact(2)),
        &["contact 0", "no coordinate 2"],
    );
    let far = contact(0).with_load_gradient(7, 1.0).unwrap();
    message(
        masses(2).with_contact(far),
        &["contact 0", "no coordinate 7"],
    );
}

#[test]
fn belts_do_not_jump() {
    let on_belt = |belt: Drive| {
        let contact = Contact::new(1, law(), 1.0).unwrap().on_belt(belt);
        masses(2).with_contact(contact)
    };
    let jump = Drive::profile(&[(0.0, 0.0), (3.0, 0.1), (3.0, 0.2), (4.0, 0.2)]).unwrap();
    let expected = Error::BeltVelocityJumps {
        coordinate: 1,
        time: 3.0,
    };
    assert_eq!(on_belt(jump.clone()), Err(expected));
    message(on_belt(jump.clone()), &["coordinate 1", "time 3", "ramp"]);
    // A point given twice is none, and a force may jump.
    let twice = Drive::profile(&[(0.0, 0.0), (3.0, 0.1), (3.0, 0.1), (4.0, 0.2)]).unwrap();
    assert!(on_belt(twice).is_ok());
    assert!(masses(1).with_force(0, jump).is_ok());
}

#[test]
fn laws_are_checked_as_for_a_mass_on_a_belt() {
    for (static_coefficient, kinetic) in [
        (0.3, 0.4),
        (0.4, -0.1),
        (f64::NAN, 0.3),
        (-0.1, -0.2),
        (0.3, f64::NAN),
        (0.3, f64::NEG_INFINITY),
        (f64::INFINITY, 0.3),
    ] {
        let law = Polynomials::new(static_coefficient, &[kinetic]);
        let belt = MassOnBelt::new(law.clone(), 0.0).map(drop).unwrap_err();
        let refused = Contact::new(0, law, 1.0).map(drop).unwrap_err();
        // NaN is not equal to itself.
        assert_eq!(format!("{refused:?}"), format!("{belt:?}"));
    }
    assert!(Contact::new(0, Polynomials::new(0.4, &[0.4]), 1.0).is_ok());
}

#[test]
fn a_motion_that_flies_away_is_said_to() {
    let pushed = |stiffness: f64, damping: f64| {
        let contact = Contact::new(0, law(), 1.0)?.on_belt(0.2);
        masses(1)
            .with_ground_spring(0, stiffness)?
            .with_ground_damper(0, damping)?
            .with_contact(contact)
    };
    let start = || State::new(&[3.0], &[0.0]);
    for (stiffness, damping) in [(-1.0, 0.0), (1.0, -0.5)] {
        let found = pushed(stiffness, damping).unwrap().simulate(start(), 1e5);
        message(found, &["at time", "beyond the largest numbers"]);
    }
    let found = pushed(1.0, 0.5).unwrap().simulate(start(), 1e5);
    assert!(found.is_ok());
}

/// A stiffness beside which a step has no length is named among the causes, with the remedy.
#[test]
fn a_stiffness_without_bound_is_named() {
    for stiffness in [1e100, 1e200, 1e300] {
        let contact = Contact::new(0, Coulomb::new(0.4, 0.4).unwrap(), 1.0).unwrap();
        let contact = contact.with_tangential_stiffness(stiffness).unwrap();
        let system = masses(1).with_ground_spring(0, 1.0).unwrap();
        let system = system.with_contact(contact.on_belt(0.2)).unwrap();
        let found = system.simulate(State::at_rest(1), 10.0);
        message(found, &["at time", "stiff", "rigid contact"]);
    }
}

#[test]
fn counts_are_said_in_words_that_fit_them() {
    let bristles = || Contact::new(0, Dahl::new(0.4, 100.0)?, 1.0);
    let two = masses(1)
        .with_contact(bristles().unwrap())
        .and_then(|s| s.with_contact(bristles()?))
        .unwrap();
    let start = State::at_rest(1).with_memory(&[0.0]);
    message(two.simulate(start, 1.0), &["memory: 1 given; 2 are needed"]);
}

#[test]
fn accelerations_that_overflow_are_errors() {
    let light = Structure::new(&[1.0, 1e-310]).and_then(|s| s.with_ground_spring(1, 0.5));
    let found = light
        .unwrap()
        .acceleration(0.0, &State::new(&[0.0, -0.3], &[0.0, 0.6]));
    let expected = Error::InvalidState {
        displacement: -0.3,
        velocity: 0.6,
    };
    assert_eq!(found, Err(expected));
}
