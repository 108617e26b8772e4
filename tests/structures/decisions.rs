//! What contacts at rest do at once: against all patterns of modes, tried one by one.

use approx::assert_abs_diff_eq;
use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Directional, Error, Freewheel, Integrator, Mode, Segment, Structure,
};

use crate::common::{Random, count, forces};
use crate::naive::{Pattern, Question, is_definite, on_side};

/// A structure of n masses at rest with k contacts under constant forces, and what it has to
/// decide.
fn drawn(
    random: &mut Random,
    [n, k]: [usize; 2],
    [falls, are_alike, is_sided]: [bool; 3],
) -> (Structure, Question) {
    let part = DMatrix::from_fn(n, n, |_, _| random.uniform(-0.7, 0.7));
    let masses = DMatrix::from_fn(n, n, |i, j| {
        if i == j {
            random.uniform(0.5, 2.0)
        } else {
            0.0
        }
    });
    let mass = masses + &part * part.transpose();
    let mut structure = Structure::with_mass_matrix(mass.clone()).unwrap();
    let mut forces = DVector::zeros(n);
    for i in 0..n {
        forces[i] = random.uniform(-2.0, 2.0);
        structure = structure.with_force(i, forces[i]).unwrap();
    }
    let mut rows = DMatrix::zeros(k, n);
    let (mut limits, mut kinetic) = (vec![], vec![]);
    for c in 0..k {
        let direction: Vec<(usize, f64)> = if are_alike {
            (0..n).map(|j| (j, random.uniform(0.2, 1.2))).collect()
        } else if random.bits().is_multiple_of(2) && n > 1 {
            let i = (random.bits() % n as u64) as usize;
            vec![(i, 1.0), ((i + 1) % n, -1.0)]
        } else {
            (0..n).map(|j| (j, random.uniform(-1.0, 1.0))).collect()
        };
        for &(j, b) in &direction {
            rows[(c, j)] = b;
        }
        let mut coefficients = || {
            let limit = random.uniform(0.3, 0.9);
            let part = if falls {
                random.uniform(0.4, 0.95)
            } else {
                1.0
            };
            [limit, part * limit]
        };
        let forward = coefficients();
        let backward = if is_sided { coefficients() } else { forward };
        let load = if are_alike {
            random.logarithmic(0.01, 1.0)
        } else {
            random.uniform(0.3, 2.0)
        };
        limits.push([load * backward[0], load * forward[0]]);
        kinetic.push([load * backward[1], load * forward[1]]);
        let [back, front] = [backward, forward].map(|[s, k]| Coulomb::new(s, k).unwrap());
        let contact = match random_side(random, is_sided) {
            Some(true) => {
                (limits[c][1], kinetic[c][1]) = (f64::INFINITY, f64::INFINITY);
                Contact::along(&direction, Freewheel::new(back).unwrap(), load)
            }
            Some(false) => Contact::along(&direction, Directional::new(front, back).unwrap(), load),
            None => Contact::along(&direction, front, load),
        };
        structure = structure.with_contact(contact.unwrap()).unwrap();
    }
    let inverse = mass.try_inverse().unwrap();
    let question = Question {
        compliance: &rows * &inverse * rows.transpose(),
        free: &rows * inverse * forces,
        limits,
        kinetic,
    };
    (structure, question)
}

/// True for a freewheel, false for limits that differ; `None` if both are the same.
fn random_side(random: &mut Random, is_sided: bool) -> Option<bool> {
    is_sided.then(|| random.bits().is_multiple_of(4))
}

/// What the crate decides.
fn decided(structure: &Structure) -> Pattern {
    let start = State::at_rest(structure.len());
    let mut flow = Integrator::new().flow(structure, start).unwrap();
    let step = flow.find(|step| step.as_ref().unwrap().duration() > 0.0);
    pattern_of(step.unwrap().unwrap().modes())
}

/// The modes of contacts as a pattern.
pub(crate) fn pattern_of(modes: &[Mode]) -> Pattern {
    let sign = |mode: &Mode| match mode {
        Mode::Slip(direction) => direction.sign() as i8,
        _ => 0,
    };
    modes.iter().map(sign).collect()
}

#[test]
fn decisions_are_those_of_all_patterns_tried() {
    decisions_are_right(Random::new(4), false, count(60, 300));
}

/// The same of limits that differ by direction, and of freewheels.
#[test]
fn decisions_of_limits_by_direction_are_those_of_all_patterns_tried() {
    decisions_are_right(Random::new(52), true, count(120, 1000));
}

fn decisions_are_right(mut random: Random, is_sided: bool, cases: usize) {
    let random = &mut random;
    let (mut tried, mut several, mut unclear) = (0, 0, 0);
    while tried < cases {
        let k = 2 + (random.bits() % 4) as usize;
        let falls = random.bits().is_multiple_of(2);
        let n = k + (random.bits() % 2) as usize;
        let (structure, question) = drawn(random, [n, k], [falls, false, is_sided]);
        if !is_definite(&question.compliance) {
            continue;
        }
        let (expected, clear) = question.fastest_first().unwrap();
        if clear < 1e-9 {
            unclear += 1;
            continue;
        }
        let found = decided(&structure);
        let consistent = question.consistent();
        assert_eq!(found, expected, "{structure:?} {question:?} {consistent:?}");
        assert!(consistent.contains(&found), "{structure:?} {consistent:?}");
        if falls {
            several += usize::from(consistent.len() > 1);
        } else {
            assert_eq!(consistent.len(), 1, "{structure:?} {consistent:?}");
        }
        // Forces and accelerations at that instant are those of the pattern.
        let state = State::at_rest(structure.len());
        let carried = DVector::from_vec(forces(&structure.carried(0.0, &state).unwrap()));
        let pull = &question.free - &question.compliance * &carried;
        for c in 0..k {
            let (force, limit) = (carried[c], question.limits[c]);
            match found[c] {
                0 => {
                    let limit = on_side(limit, if force > 0.0 { 1 } else { -1 });
                    assert!(force.abs() <= limit * (1.0 + 1e-12) && pull[c].abs() < 1e-11);
                }
                side => {
                    let kinetic = f64::from(side) * on_side(question.kinetic[c], side);
                    assert_abs_diff_eq!(force, kinetic, epsilon = 1e-14 * on_side(limit, side));
                    assert!(f64::from(side) * pull[c] > 0.0);
                }
            }
        }
        tried += 1;
    }
    println!("{tried} decisions, {several} with several answers, {unclear} too close to call");
    assert!(several * 20 > tried && unclear * 100 < tried);
}

/// Two to three times as many contacts as masses, in directions that are much alike, for which
/// pivoting takes many rounds: each force is at its limit against the acceleration of its contact,
/// or there is none.
#[test]
fn more_contacts_than_masses_come_to_a_decision() {
    let mut random = Random::new(28);
    let (mut decided, mut undetermined) = (0, 0);
    for case in 0..count(300, 5000) {
        // Seven masses take a hundred times as long as five.
        let more = if case % 20 == 0 { 5 } else { 3 };
        let n = 3 + (random.bits() % more) as usize;
        let k = 2 * n + (random.bits() % n as u64) as usize;
        let (structure, question) = drawn(&mut random, [n, k], [false, true, false]);
        let state = State::at_rest(n);
        let carried = match structure.carried(0.0, &state) {
            Err(Error::TooManyMechanisms { contacts, .. }) if contacts.len() == k => continue,
            carried => carried.unwrap(),
        };
        undetermined += usize::from(carried.iter().any(|carried| !carried.is_determined()));
        let carried = DVector::from_vec(forces(&carried));
        let pull = &question.free - &question.compliance * &carried;
        for c in 0..k {
            let (force, [limit, _]) = (carried[c], question.limits[c]);
            assert!(force.abs() <= limit * (1.0 + 1e-12), "{structure:?}");
            let works = pull[c].abs() <= 1e-10 || (force - limit * pull[c].signum()).abs() < 1e-12;
            assert!(works, "{force} {limit} {}: {structure:?}", pull[c]);
        }
        decided += 1;
    }
    println!("{decided} decided, {undetermined} with forces that are not determined");
    assert!(decided > 4 * undetermined && undetermined > 0);
}
