//! Hopf points of steady sliding in which joints stick: those of the structure in which a rigid
//! joint is a constraint (two masses are one), and an elastic joint a spring.

use std::f64::consts::TAU;

use stick_slip::bifurcation::{HopfLocus, hopf_locus};
use stick_slip::nalgebra::{Complex, DMatrix, DVector};
use stick_slip::orbit::{Branch, BranchEnd, SpecialKind, begin, follow};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Dwell, Error, Exponential, LuGre, Structure};

use crate::common::{Random, count};

const JOINT: f64 = 0.7;

/// The contact of mass 0 with the belt.
fn belt(velocity: f64) -> Result<Contact, Error> {
    Ok(Contact::new(0, Exponential::new(0.5, 0.25, 0.3)?, 1.0)?.on_belt(velocity))
}

/// Two masses, mass 0 on a belt, with springs and a damper.
fn two(velocity: f64, damping: f64) -> Result<Structure, Error> {
    Structure::new(&[1.0, 0.7])?
        .with_ground_spring(0, 1.0)?
        .with_spring(0, 1, 1.5)?
        .with_ground_damper(1, damping)?
        .with_contact(belt(velocity)?)
}

fn joint(limit: f64) -> Result<Contact, Error> {
    Contact::between(0, 1, Coulomb::new(0.5, 0.5)?, limit / 0.5)
}

/// One mass in the place of both.
fn tied(velocity: f64, damping: f64) -> Result<Structure, Error> {
    Structure::new(&[1.7])?
        .with_ground_spring(0, 1.0)?
        .with_ground_damper(0, damping)?
        .with_contact(belt(velocity)?)
}

/// A spring in the place of the joint.
fn sprung(velocity: f64, damping: f64) -> Result<Structure, Error> {
    two(velocity, damping)?.with_spring(0, 1, JOINT)
}

type Two<'f> = &'f dyn Fn(f64, f64) -> Result<Structure, Error>;

/// The branch that is born at a Hopf point near a velocity, and the Hopf point at its end.
fn branch(family: Two<'_>, near: f64) -> (Branch<State>, f64) {
    let family = |velocity: f64| family(velocity, 0.07);
    let born = begin(family, near).unwrap();
    let range = 0.5 * near..1.5 * near;
    let branch = follow(family, born.parameter, &born.orbit, range).unwrap();
    let hopf = branch.ends.iter().find_map(|end| match end {
        BranchEnd::Hopf { parameter } => Some(*parameter),
        _ => None,
    });
    let hopf = hopf.unwrap_or_else(|| panic!("{:?}", branch.ends));
    (branch, hopf)
}

/// The amplitude and the period of the motions with one velocity.
fn motions_at(family: Two<'_>, near: f64, velocity: f64) -> Vec<[f64; 2]> {
    let family = |velocity: f64| family(velocity, 0.07);
    let born = begin(family, near).unwrap();
    let range = born.parameter.min(velocity)..born.parameter.max(velocity);
    let branch = follow(family, born.parameter, &born.orbit, range).unwrap();
    let there = branch
        .points
        .iter()
        .filter(|point| point.parameter == velocity);
    there
        .map(|point| [point.orbit.amplitude(0), point.orbit.period()])
        .collect()
}

/// The same motions are born, and the same branch leads to them.
#[track_caller]
fn same_births(stuck: Two<'_>, free: Two<'_>) {
    let [(a, at), (b, expected)] = [branch(stuck, 0.6), branch(free, 0.6)];
    assert!((at - expected).abs() < 1e-12, "{at} {expected}");
    let [a, b] = [&a, &b].map(|branch| {
        let smallest = branch.points.iter().map(|point| point.orbit.amplitude(0));
        smallest.fold(f64::INFINITY, f64::min)
    });
    assert!(a < 1e-3 && b < 1e-3, "{a} {b}");
    for velocity in [0.65, 0.8] {
        let [a, b] = [stuck, free].map(|family| motions_at(family, 0.6, velocity));
        assert!(!a.is_empty() && a.len() == b.len(), "{a:?} {b:?}");
        for (a, b) in std::iter::zip(&a, &b) {
            for (a, b) in std::iter::zip(a, b) {
                // A period that hardly depends on the motion, and its multiplier near 1.
                assert!((a / b - 1.0).abs() < 1e-9, "{a} {b}");
            }
        }
    }
}

#[test]
fn a_rigid_joint_that_sticks_is_a_constraint() {
    let stuck = |v: f64, c: f64| two(v, c)?.with_contact(joint(5.0)?);
    same_births(&stuck, &tied);
}

#[test]
fn an_elastic_joint_that_sticks_is_a_spring() {
    let stuck =
        |v: f64, c: f64| two(v, c)?.with_contact(joint(5.0)?.with_tangential_stiffness(JOINT)?);
    same_births(&stuck, &sprung);
}

/// What is held by a joint only: without the spring, and with a static force.
#[test]
fn a_joint_carries_what_nothing_else_carries() {
    let masses = |velocity: f64, damping: f64| {
        Structure::new(&[1.0, 0.7])?
            .with_ground_spring(0, 1.0)?
            .with_ground_damper(1, damping)?
            .with_force(1, 0.2)?
            .with_contact(belt(velocity)?)
    };
    let rigid = |v: f64, c: f64| masses(v, c)?.with_contact(joint(5.0)?);
    let pushed = |v: f64, c: f64| tied(v, c)?.with_force(0, 0.2);
    same_births(&rigid, &pushed);
    let elastic =
        |v: f64, c: f64| masses(v, c)?.with_contact(joint(5.0)?.with_tangential_stiffness(2.2)?);
    let spring = |v: f64, c: f64| masses(v, c)?.with_spring(0, 1, 2.2);
    same_births(&elastic, &spring);
}

/// The first motion is so small that the joint does not slip, and the branch goes on when it does.
#[test]
fn a_weak_joint_slips_further_along_the_branch() {
    for stiffness in [None, Some(JOINT)] {
        let weak = |v: f64, c: f64| {
            let joint = joint(0.02)?;
            two(v, c)?.with_contact(match stiffness {
                Some(stiffness) => joint.with_tangential_stiffness(stiffness)?,
                None => joint,
            })
        };
        let free: Two<'_> = if stiffness.is_some() { &sprung } else { &tied };
        let family = |velocity: f64| weak(velocity, 0.07);
        let born = begin(family, 0.6).unwrap();
        assert!(born.orbit.events().is_empty() && born.orbit.unslipped() == [1]);
        let (found, at) = branch(&weak, 0.6);
        let (_, expected) = branch(free, 0.6);
        assert!((at - expected).abs() < 1e-12, "{at} {expected}");
        let slips = found
            .points
            .iter()
            .filter(|point| point.orbit.unslipped().is_empty());
        let goes_on = slips.count() > 10;
        // Slip moves a rigid joint, in one direction, to where it sticks again.
        let ends = |end: &BranchEnd| matches!(end, BranchEnd::OneWaySlip { contact: 1, .. });
        assert_eq!(goes_on, stiffness.is_some());
        assert_eq!(found.ends.iter().any(ends), stiffness.is_none());
    }
}

/// Random structures of three coordinates with a joint in any direction, rigid or elastic, with or
/// without a normal spring: each point of the curve is a Hopf point of the constrained structure,
/// with its other eigenvalues, and the same motion is born.
#[test]
fn curves_are_those_of_the_constrained_structure() {
    let mut random = Random::new(417);
    let mut found = 0;
    for case in 0..count(4, 24) {
        let mut some = |from: f64, to: f64| random.uniform(from, to);
        let masses = DMatrix::from_diagonal(&DVector::from_fn(3, |_, _| some(0.5, 2.0)));
        let mut symmetric = |own: f64, beside: f64| {
            let part = DMatrix::from_fn(3, 3, |i, j| match i == j {
                true => some(0.5, 1.0) * own,
                false => some(-0.5, 0.5) * beside,
            });
            &part * part.transpose()
        };
        let stiffness = symmetric(1.5, 1.0);
        let damping = symmetric(0.15, 0.05);
        let way = DVector::from_column_slice(&[some(-1.0, 1.0), some(-1.0, 1.0), 1.0]);
        let press = (case % 3 == 0).then(|| {
            let press = DVector::from_column_slice(&[some(-0.1, 0.1), some(-0.1, 0.1), 0.0]);
            (press, some(0.1, 1.0))
        });
        let elastic = (case % 2 == 0).then(|| some(0.3, 2.0));
        let bristles = case % 5 == 0;
        let law = [some(0.4, 0.7), some(0.1, 0.3), some(0.2, 0.5)];
        // Coordinates x = Z y.
        let basis = match elastic {
            Some(_) => DMatrix::identity(3, 3),
            None => DMatrix::from_row_slice(3, 2, &[1.0, 0.0, 0.0, 1.0, -way[0], -way[1]]),
        };
        let rubbed = |rows: &DMatrix<f64>, velocity: f64| -> Result<Contact, Error> {
            let direction: Vec<(usize, f64)> = (0..rows.ncols())
                .map(|j| (j, rows[(0, j)]))
                .filter(|(_, b)| *b != 0.0)
                .collect();
            let [limit, fall, speed] = law;
            let law = Exponential::new(limit, limit - fall, speed)?;
            let contact = match bristles {
                true => Contact::along(&direction, LuGre::new(law, 200.0, 0.5, 0.0)?, 1.0)?,
                false => Contact::along(&direction, law, 1.0)?,
            };
            Ok(contact.on_belt(velocity))
        };
        let stuck = |velocity: f64, factor: f64| {
            let entries = |x: &DVector<f64>| -> Vec<(usize, f64)> {
                let entries = x.iter().copied().enumerate();
                entries.filter(|(_, b)| *b != 0.0).collect()
            };
            let law = Coulomb::new(0.5, 0.5)?;
            let mut joint = match (elastic, case % 4) {
                (None, 3) => {
                    let law = Dwell::hyperbolic(Exponential::new(0.6, 0.5, 0.3)?, 0.8, 1.0)?;
                    Contact::along(&entries(&way), law, 100.0)?
                }
                _ => Contact::along(&entries(&way), law, 100.0)?,
            };
            if let Some(stiffness) = elastic {
                joint = joint.with_tangential_stiffness(stiffness)?;
            }
            if let Some((press, stiffness)) = &press {
                joint = joint.with_normal_spring(&entries(press), *stiffness)?;
            }
            Structure::with_mass_matrix(masses.clone())?
                .with_stiffness(stiffness.clone())?
                .with_damping(&damping * factor)?
                .with_contact(rubbed(&DMatrix::identity(3, 3), velocity)?)?
                .with_contact(joint)
        };
        let mut whole = stiffness.clone();
        if let Some(stiffness) = elastic {
            whole += &way * way.transpose() * stiffness;
        }
        if let Some((press, stiffness)) = &press {
            whole += press * press.transpose() * *stiffness;
        }
        let reduced = |matrix: &DMatrix<f64>| {
            let reduced = basis.transpose() * matrix * &basis;
            (&reduced + reduced.transpose()) * 0.5
        };
        let free = |velocity: f64, factor: f64| {
            Structure::with_mass_matrix(reduced(&masses))?
                .with_stiffness(reduced(&whole))?
                .with_damping(reduced(&(&damping * factor)))?
                .with_contact(rubbed(&basis, velocity)?)
        };
        let ranges = || [0.1..0.6, 0.2..5.0];
        let [a, b] = [&stuck as Two<'_>, &free].map(|family| hopf_locus(family, ranges()).unwrap());
        assert_eq!(a.len(), b.len(), "{case}");
        for (a, b) in std::iter::zip(&a, &b) {
            for point in &a.points {
                let [velocity, factor] = point.parameters;
                let sliding = free(velocity, factor).unwrap().steady_sliding().unwrap();
                let mut values = sliding.eigenvalues;
                values.retain(|value| value.im >= 0.0);
                let off =
                    |value: &Complex<f64>| (value - Complex::new(0.0, point.frequency)).norm();
                let nearest = values.iter().map(off).fold(f64::INFINITY, f64::min);
                // Of a matrix whose bristles settle at the rate 1e4.
                assert!(nearest < 1e-9, "{case}: {nearest:e}");
                values.retain(|value| off(value) > nearest);
                let others = values.iter().map(|value| value.re);
                let expected = others.fold(f64::NEG_INFINITY, f64::max);
                let error = point.largest_other - expected;
                assert!(error.abs() < 1e-9, "{case}: {error:e}");
            }
            let special = |locus: &HopfLocus| {
                let special = locus.special.iter();
                let special = special.map(|special| (special.kind, special.point.parameters));
                special.collect::<Vec<(SpecialKind, [f64; 2])>>()
            };
            let [a, b] = [special(a), special(b)];
            assert_eq!(a.len(), b.len(), "{case}");
            for ((kind, at), (expected, place)) in std::iter::zip(a, b) {
                assert_eq!(kind, expected, "{case}");
                // The place of a turn is the zero of a tangent from differences.
                let apart = (at[0] - place[0]).hypot(at[1] - place[1]);
                assert!(apart < 1e-7, "{case}: {kind:?} {apart:e}");
            }
            found += 1;
        }
        let Some(point) = a.first().map(|locus| &locus.points[locus.points.len() / 2]) else {
            continue;
        };
        let [velocity, factor] = point.parameters;
        let [a, b] = [&stuck as Two<'_>, &free]
            .map(|family| begin(|factor: f64| family(velocity, factor), factor).unwrap());
        assert_eq!(a.orbit.is_stable(), b.orbit.is_stable(), "{case}");
        for born in [a, b] {
            let turns = born.orbit.period() * point.frequency / TAU;
            assert!((turns - 1.0).abs() < 0.01, "{case}: {turns}");
            assert!((born.parameter / factor - 1.0).abs() < 0.2, "{case}");
        }
    }
    assert!(found > 2, "{found}");
}
