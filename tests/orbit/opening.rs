//! Contacts whose load falls to 0 and comes back: they close in stick or in slip, and it does not
//! matter where the period begins.

use std::f64::consts::{FRAC_PI_2, TAU};

use stick_slip::orbit::{Branch, BranchEnd, Orbit, Period, follow, settle, shoot};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, Error, Structure};

use crate::common::{Random, count, one_mass, some};

/// A mass under a force and a load that both go as a sine, begun at a phase of them.
fn lifting(frequency: f64, phase: f64) -> Result<Structure, Error> {
    let load = Drive::harmonic(1.0, frequency, phase - FRAC_PI_2)?;
    let contact = Contact::new(0, Coulomb::new(0.4, 0.3)?, load)?.on_belt(0.7);
    let force = Drive::harmonic(0.5, frequency, phase)?;
    one_mass([1.0, 0.2, 1.0], force, contact)
}

type Found = Branch<State>;

fn branch(phase: f64, range: std::ops::Range<f64>) -> Found {
    let family = |frequency: f64| lifting(frequency, phase);
    let start = State::at_rest(1);
    let orbit = settle(&family(1.3).unwrap(), &start, 400.0, Period::Driven(1)).unwrap();
    follow(family, 1.3, &orbit, range).unwrap()
}

fn kinds(orbit: &Orbit<State>) -> Vec<String> {
    let kinds = orbit.events().iter().map(|event| event.kind.to_string());
    let mut kinds: Vec<String> = kinds.collect();
    kinds.sort();
    kinds
}

/// Two branches over one range, of systems whose periods begin at different phases.
fn same(about: &str, one: &Found, other: &Found) {
    for ends in std::iter::zip(&one.ends, &other.ends) {
        match ends {
            (BranchEnd::Range, BranchEnd::Range) => {}
            (
                BranchEnd::Discontinuity {
                    parameter: a,
                    contact: i,
                    ..
                },
                BranchEnd::Discontinuity {
                    parameter: b,
                    contact: j,
                    ..
                },
            ) => assert!(i == j && (a - b).abs() < 1e-12, "{about}: {ends:?}"),
            _ => panic!("{about}: {ends:?}"),
        }
    }
    let of = |branch: &Found| -> Vec<_> {
        let found = branch.bifurcations.iter();
        found.map(|found| (found.kind, found.parameter)).collect()
    };
    assert_eq!(of(one).len(), of(other).len(), "{about}");
    for (a, b) in std::iter::zip(of(one), of(other)) {
        // Where a crossing becomes a stop, both motions exist over 2e-5 of the frequency.
        assert!(
            a.0 == b.0 && (a.1 - b.1).abs() < 2e-5,
            "{about}: {a:?} {b:?}"
        );
    }
    // A jump is approached to within the shortest step.
    let is_whole = one.ends == [BranchEnd::Range, BranchEnd::Range];
    let (near, alike) = if is_whole {
        (1e-11, 1e-10)
    } else {
        (1e-6, 1e-4)
    };
    let ends =
        |branch: &Found| [0, branch.points.len() - 1].map(|i| branch.points[i].orbit.clone());
    for (a, b) in std::iter::zip(ends(one), ends(other)) {
        assert_eq!(kinds(&a), kinds(&b), "{about}");
        assert!(kinds(&a).contains(&"close".into()), "{about}");
        let ((a0, a1), (b0, b1)) = (a.extremes(0), b.extremes(0));
        assert!((a0 - b0).abs() < near && (a1 - b1).abs() < near, "{about}");
        for (a, b) in std::iter::zip(a.multipliers(), b.multipliers()) {
            assert!((a - b).norm() < alike, "{about}: {a} {b}");
        }
    }
}

/// At phases 0 and 2π the contact closes, in slip, exactly where the period begins; at π it opens.
#[test]
fn a_branch_does_not_depend_on_where_its_period_begins() {
    let expected = branch(1.0, 1.2..1.4);
    assert_eq!(expected.ends, [BranchEnd::Range, BranchEnd::Range]);
    let phases = [0.0, 0.5 * TAU, TAU, 0.1, FRAC_PI_2, 3.5];
    for phase in some(3, phases) {
        same(&format!("{phase}"), &branch(phase, 1.2..1.4), &expected);
    }
}

/// What has closed at the end of the transient, or of the period, keeps its own velocity.
#[test]
fn a_mass_that_slips_when_its_contact_closes_keeps_its_velocity() {
    let period = Period::Driven(1);
    let system = |phase: f64| lifting(1.3, phase).unwrap();
    let later = settle(&system(1.0), &State::at_rest(1), 400.0, period).unwrap();
    // 2π − 1 after phase 1.
    let closes = later.trajectory().state_at((TAU - 1.0) / 1.3).unwrap();
    assert!(closes.velocities[0] < 0.6, "{closes:?}");
    let guesses = [
        closes.clone(),
        State::new(&[0.0], &[0.0]),
        State::new(&[0.5], &[0.7]),
    ];
    for guess in guesses {
        for found in [
            shoot(&system(0.0), &guess, period).unwrap(),
            settle(&system(0.0), &guess, 20.0 * TAU / 1.3, period).unwrap(),
        ] {
            let apart = [
                found.state().displacements[0] - closes.displacements[0],
                found.state().velocities[0] - closes.velocities[0],
            ];
            assert!(apart.iter().all(|x| x.abs() < 1e-12), "{apart:?}");
            assert_eq!(kinds(&found), kinds(&later));
        }
    }
}

/// A mass that stands still with its belt is caught when the load comes back: it sticks.
#[test]
fn a_contact_may_close_in_stick() {
    let system = |phase: f64| -> Result<Structure, Error> {
        let load = Drive::harmonic(1.0, 2.0, phase)?;
        Structure::new(&[1.0, 1.0])?
            .with_ground_spring(0, 1.0)?
            .with_ground_damper(0, 0.1)?
            .with_ground_damper(1, 0.1)?
            .with_force(0, Drive::harmonic(0.3, 2.0, phase)?)?
            .with_contact(Contact::new(0, Coulomb::new(0.4, 0.3)?, 1.0)?.on_belt(0.1))?
            .with_contact(Contact::new(1, Coulomb::new(0.4, 0.3)?, load)?)
    };
    let start = State::new(&[0.3, 0.2], &[0.0, 0.0]);
    for phase in [-FRAC_PI_2, 0.3] {
        let system = system(phase).unwrap();
        let orbit = settle(&system, &start, 200.0, Period::Driven(1)).unwrap();
        let of_second = orbit
            .events()
            .iter()
            .filter(|event| event.contact().unwrap() == 1);
        let kinds: Vec<String> = of_second.map(|event| event.kind.to_string()).collect();
        assert_eq!(kinds.len(), 2, "{phase}: {kinds:?}");
        assert_eq!(orbit.velocity_extremes(1), (0.0, 0.0));
    }
}

/// Masses in a row, each with a contact whose load falls to 0 for a part of the period, all drives
/// begun at a phase.
fn random_lifting(random: &mut Random) -> impl Fn(f64, f64) -> Result<Structure, Error> + use<> {
    let n = 1 + (random.bits() % 2) as usize;
    let mut of_masses = Vec::new();
    for _ in 0..n {
        let (loss, angle) = (random.uniform(0.0, 0.6), random.uniform(0.0, TAU));
        of_masses.push((
            [random.uniform(0.5, 2.0), random.uniform(0.1, 0.4)],
            [loss, if of_masses.is_empty() { 0.0 } else { angle }],
            [random.uniform(0.2, 0.8), random.uniform(0.0, TAU)],
            [random.uniform(0.3, 0.6), random.uniform(0.7, 1.0)],
            random.uniform(-0.8, 0.8),
        ));
    }
    let coupling = random.uniform(0.1, 0.8);
    move |frequency: f64, phase: f64| {
        let mut structure = Structure::new(&vec![1.0; n])?;
        for (i, numbers) in of_masses.iter().enumerate() {
            let ([spring, damper], [mean, angle], [force, at], [limit, part], belt) = *numbers;
            // The first closes at phase 0: mean + sin = 0, rising.
            let begin = phase + angle - f64::asin(mean) - FRAC_PI_2;
            let load = Drive::harmonic(1.0, frequency, begin)?.with_constant(mean)?;
            let law = Coulomb::new(limit, part * limit)?;
            structure = structure
                .with_ground_spring(i, spring)?
                .with_ground_damper(i, damper)?
                .with_force(i, Drive::harmonic(force, frequency, phase + at)?)?
                .with_contact(Contact::new(i, law, load)?.on_belt(belt))?;
        }
        if n > 1 {
            structure = structure.with_spring(0, 1, coupling)?;
        }
        Ok(structure)
    }
}

#[test]
fn branches_of_random_contacts_that_open_do_not_depend_on_the_phase() {
    let mut random = Random::new(28);
    let (mut compared, mut changes, mut jumps) = (0, 0, 0);
    let cases = count(4, 15);
    for i in 0..cases {
        let system = random_lifting(&mut random);
        let frequency = random.uniform(0.7, 1.6);
        let found = [0.0, 2.5].map(|phase| {
            let family = |frequency: f64| system(frequency, phase);
            let begin = family(frequency).unwrap();
            let start = State::at_rest(begin.masses().len());
            let orbit = settle(&begin, &start, 300.0, Period::Driven(1)).ok()?;
            let range = 0.95 * frequency..1.05 * frequency;
            Some(follow(family, frequency, &orbit, range).unwrap())
        });
        let [Some(a), Some(b)] = found else {
            continue;
        };
        same(&format!("{i}"), &a, &b);
        compared += 1;
        changes += a.bifurcations.len();
        jumps += a
            .ends
            .iter()
            .filter(|end| **end != BranchEnd::Range)
            .count();
    }
    println!("{compared} branches, {changes} changes, {jumps} jumps");
    assert!(5 * compared > 4 * cases && 3 * changes > cases && jumps >= count(0, 1));
}
