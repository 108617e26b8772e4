//! Motions that are born at Hopf points of steady sliding: amplitudes of the normal form.

use stick_slip::nalgebra::{Complex, DMatrix, DVector};
use stick_slip::orbit::{self, BifurcationKind, BranchEnd, Orbit, Search, begin, classify, follow};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Drive, Error, Exponential, ForceElement, LuGre, MassOnBelt, Polynomial,
    PolynomialSpring, Structure, bifurcation,
};

use crate::common::{count, exactly, list, number, one_mass, text};
use crate::loci::{curve, member};

/// A mass on a belt with the exponential law: A' = aA + cA³ with a = −(2β + μ̂'(v_b))/2, so that A²
/// = −a/c near the Hopf point.
#[test]
fn amplitudes_are_those_of_the_averaged_equation() {
    let case = curve("hbe");
    for point in list(&case["points"]) {
        let [velocity, damping] = ["PARAM1", "PARAM2"].map(|name| number(&point[name]));
        let family = |damping: f64| Ok(member(&case["system"], velocity, damping));
        let born = begin(family, 1.01 * damping).unwrap();
        let cubic = number(&point["cubic_coefficient"]);
        let stable = text(&point["criticality"]) == "supercritical";
        assert_eq!(born.orbit.is_stable(), stable, "{velocity}");
        assert!(born.orbit.events().is_empty());
        // On one side smaller and smaller, on the other up to stick.
        let range = 0.5 * damping..2.0 * damping;
        let branch = follow(family, born.parameter, &born.orbit, range).unwrap();
        let hopf = branch.ends.iter().find_map(|end| match end {
            BranchEnd::Hopf { parameter } => Some(*parameter),
            _ => None,
        });
        let error = hopf.unwrap() - damping;
        assert!(error.abs() < 1e-9, "{velocity}: {error:e}");
        let all = branch.points.iter().map(|point| {
            let amplitude = point.orbit.amplitude(0);
            let growth = -0.5 * (point.parameter - damping);
            (amplitude, -growth / (cubic * amplitude * amplitude))
        });
        // Of still smaller ones the growth rate c A² is known to fewer digits.
        let smallest = all
            .filter(|point| point.0 > 2e-4)
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .unwrap();
        println!("{velocity}: {smallest:?}");
        assert!((smallest.1 - 1.0).abs() < 1e-3, "{velocity}: {smallest:?}");
    }
}

/// A drill string of two inertias: Re s + ω l1 ε² = 0, with the coefficient of the reference.
#[test]
fn amplitudes_of_a_drill_string_are_those_of_the_normal_form() {
    let case = curve("hds");
    let points = list(&case["points"]);
    for point in points.iter().take(count(2, points.len())) {
        let [speed, load] = ["PARAM1", "PARAM2"].map(|name| number(&point[name]));
        let family = |load: f64| Ok(member(&case["system"], speed, load));
        let born = begin(family, 0.99 * load).unwrap();
        let frequency = number(&point["omega"]);
        let lyapunov = number(&point["first_lyapunov_coefficient"]);
        // (K + iωC − ω²M) q = 0 in its second row, without a contact.
        let system = family(load).unwrap();
        let (stiffness, damping) = (system.stiffness(), system.damping());
        let entry =
            |i: usize, j: usize| Complex::new(stiffness[(i, j)], frequency * damping[(i, j)]);
        let own = entry(1, 1) - Complex::from(frequency * frequency * system.masses()[1]);
        let q = [-own / entry(1, 0), Complex::from(1.0)];
        let length = q.iter().map(|q| q.norm_sqr()).sum::<f64>().sqrt();
        let length = length * (1.0 + frequency * frequency).sqrt();
        let branch = follow(family, born.parameter, &born.orbit, 0.8 * load..1.3 * load).unwrap();
        let ratios = branch.points.iter().map(|point| {
            let orbit = &point.orbit;
            let distance = orbit.amplitude(0) * length / (2.0 * q[0].norm());
            let steady = family(point.parameter).unwrap().steady_sliding().unwrap();
            let growth = steady.eigenvalues[0].re;
            (
                distance,
                -growth / (frequency * lyapunov * distance * distance),
            )
        });
        let smallest = ratios
            .filter(|point| point.0 > 3e-3)
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .unwrap();
        println!("{speed}: {smallest:?}");
        assert!((smallest.1 - 1.0).abs() < 1e-4, "{speed}: {smallest:?}");
        // Up to the belt: the motion touches it, and sticks.
        let grazes = |found: &orbit::Bifurcation<_>| found.kind == BifurcationKind::Grazing;
        assert!(
            speed > 0.42 || branch.bifurcations.iter().any(grazes),
            "{speed}"
        );
    }
}

/// A belt by itself and as a structure begin with the same motion, on either side of 0.
#[test]
fn a_belt_is_a_structure() {
    let belt = |velocity: f64| {
        MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, velocity)?.with_damping(0.05)
    };
    let structure = |velocity: f64| Ok(Structure::from(&belt(velocity)?));
    let exact = bifurcation::hopf_velocities(&belt(0.2).unwrap(), 0.0..2.0).unwrap();
    assert_eq!(exact.len(), 2);
    for hopf in exact {
        let near = 1.001 * hopf;
        let [a, b] = [
            begin(belt, near).unwrap().parameter,
            begin(structure, near).unwrap().parameter,
        ];
        assert_eq!(a, b);
        assert!((a - hopf).abs() < 0.05 * hopf, "{a} {hopf}");
    }
}

/// Bristles: the motion has the frequency of the critical pair.
#[test]
fn bristles_begin_to_vibrate() {
    let family = |damping: f64| {
        let law = LuGre::new(Exponential::new(0.4, 0.25, 0.1)?, 100.0, 0.5, 0.1)?;
        let contact = Contact::new(0, law, 1.0)?.on_belt(0.1);
        one_mass([1.0, damping, 1.0], 0.0, contact)
    };
    let loci = bifurcation::hopf_locus(
        |p, q| {
            let law = LuGre::new(Exponential::new(0.4, 0.25, 0.1)?, 100.0, 0.5, 0.1)?;
            one_mass([1.0, q, 1.0], 0.0, Contact::new(0, law, 1.0)?.on_belt(p))
        },
        [0.1..0.2, 0.0..1.5],
    )
    .unwrap();
    let mut points = loci.iter().flat_map(|locus| &locus.points);
    let there = points.find(|point| point.parameters[0] == 0.1).unwrap();
    let hopf = there.parameters[1];
    let born = begin(family, hopf).unwrap();
    assert!(
        (born.parameter - hopf).abs() < 0.1 * hopf,
        "{} {hopf}",
        born.parameter
    );
    let frequency = std::f64::consts::TAU / born.orbit.period();
    assert!((frequency - there.frequency).abs() < 0.05 * there.frequency);
    let stable = there.first_lyapunov_coefficient < 0.0;
    assert_eq!(born.orbit.is_stable(), stable);
}

/// Where friction is linear up to stick all motions exist at the Hopf point alone, up to that which
/// touches the belt.
#[test]
fn a_continuum_is_named_by_its_parameter() {
    // Flutter by mode coupling at μ = 0.7575.
    let brake = |coefficient: f64| {
        Structure::new(&[1.0, 1.0])?
            .with_stiffness(DMatrix::from_row_slice(2, 2, &[2.0, 1.0, 1.0, 2.0]))?
            .with_damping(DMatrix::from_diagonal(&DVector::from_column_slice(&[
                0.1, 0.05,
            ])))?
            .with_contact(
                Contact::new(0, Coulomb::new(coefficient, coefficient)?, 10.0)?
                    .with_load_gradient(1, 4.0 / 3.0)?
                    .on_belt(1.0),
            )
    };
    let born = begin(brake, 0.75).unwrap();
    assert!((born.parameter - 0.7575).abs() < 1e-12);
    assert!((born.orbit.multipliers()[0].re - 1.0).abs() < 1e-9);
    let branch = follow(brake, born.parameter, &born.orbit, 0.7..0.8).unwrap();
    // All of the same period, at one value.
    assert!(branch.points.len() > 2);
    for point in &branch.points {
        assert!(
            (point.parameter - 0.7575).abs() < 1e-9,
            "{}",
            point.parameter
        );
        assert!((point.orbit.period() / born.orbit.period() - 1.0).abs() < 1e-8);
    }
}

#[test]
fn what_has_no_hopf_point_is_refused() {
    let family = |velocity: f64| {
        MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, velocity)?.with_damping(0.05)
    };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let error = begin(family, bad).unwrap_err();
        assert!(matches!(error, Error::InvalidParameter { .. }), "{error}");
    }
    // A belt at rest, and far from any Hopf point.
    assert!(matches!(begin(family, 0.0).unwrap_err(), Error::At { .. }));
    let overdamped = |velocity: f64| {
        MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, velocity)?.with_damping(0.9)
    };
    let error = begin(overdamped, 0.5).unwrap_err();
    assert!(error.to_string().contains("no Hopf point"), "{error}");
    // A force that varies: nothing slides steadily.
    let driven = |force: f64| {
        Structure::from(&family(0.5)?).with_force(0, Drive::harmonic(force, 1.0, 0.0)?)
    };
    let error = begin(driven, 0.1).unwrap_err();
    assert!(error.to_string().contains("steady sliding"), "{error}");
    let refuses = |_: f64| -> Result<Structure, Error> { Err(Error::NotFree) };
    assert!(
        begin(refuses, 0.1)
            .unwrap_err()
            .to_string()
            .contains("parameter")
    );
}

/// Springs whose squares overflow, or vanish beside the others: the search ends.
#[test]
fn very_stiff_and_very_soft_springs_end_in_an_answer() {
    for stiffness in [1e200, 1e160, 1e-160, 1e-200, 1e-300] {
        let family = |damping: f64| {
            let law = Exponential::new(0.4, 0.25, 0.5)?;
            Structure::new(&[1.0, 1.0])?
                .with_ground_spring(0, 1.0)?
                .with_spring(0, 1, stiffness)?
                .with_ground_damper(0, damping)?
                .with_contact(Contact::new(1, law, 1.0)?.on_belt(0.5))
        };
        let found = begin(family, 0.1).map(|born| born.parameter);
        assert!(
            found.clone().is_ok_and(f64::is_finite) || found.is_err(),
            "{stiffness:e}"
        );
        let ranges = orbit::Search::new()
            .with_max_steps(1000)
            .unwrap()
            .vibration_ranges(family, 0.1..0.2);
        assert!(ranges.is_ok(), "{stiffness:e}");
    }
}

/// The Hopf point of a pad on a normal spring, whose reaction acts on masses other than 1: the
/// branch from it shrinks to the belt velocity at which the eigenvalues of `steady_sliding`, which
/// is computed elsewhere, cross the axis.
#[test]
fn a_normal_spring_acts_on_the_steady_sliding_at_a_birth() -> Result<(), Error> {
    let family = |velocity: f64| {
        let contact = Contact::new(0, Exponential::new(0.6, 0.3, 0.5)?, 0.7)?.on_belt(velocity);
        Structure::new(&[1.3, 0.6])?
            .with_spring(0, 1, 0.4)?
            .with_ground_spring(0, 1.0)?
            .with_ground_damper(0, 0.1)?
            .with_ground_spring(1, 0.9)?
            .with_ground_damper(1, 0.2)?
            .with_force(1, 0.3)?
            .with_contact(contact.with_normal_spring(&[(1, -1.0)], 0.8)?)
    };
    let growth = |velocity: f64| {
        let steady = family(velocity).unwrap().steady_sliding().unwrap();
        let parts = steady.eigenvalues.iter().map(|value| value.re);
        parts.fold(f64::NEG_INFINITY, f64::max)
    };
    let (mut low, mut high) = (0.2, 3.0);
    assert!(growth(low) > 0.0 && growth(high) < 0.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if growth(middle) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    let born = begin(family, 1.01 * low)?;
    let branch = follow(family, born.parameter, &born.orbit, 0.5 * low..2.0 * low)?;
    let hopf = branch.ends.iter().find_map(|end| match end {
        BranchEnd::Hopf { parameter } => Some(*parameter),
        _ => None,
    });
    assert!((hopf.unwrap() - low).abs() < 1e-12, "{hopf:?} {low}");
    Ok(())
}

/// A branch ends at its Hopf point without a fold before it: rounding decides the parameter of
/// motions so small that it differs from that point by less. The Hopf point is that of c + N μ̂' =
/// 0.
#[test]
fn a_branch_that_shrinks_to_a_hopf_point_has_no_fold_there() {
    let ([stat, kinetic, speed], damping, load) = (
        [0.4957115421832068, 0.39223666432756826, 0.5458899997215975],
        0.05023185467838512,
        0.41721097908445376,
    );
    let family = |velocity: f64| {
        let law = Exponential::new(stat, kinetic, speed)?;
        let spring = PolynomialSpring::new(&[0.0, 0.0, 0.07823012643827945])?;
        let contact = Contact::new(0, law, load)?.on_belt(velocity);
        one_mass(
            [0.6496481426742486, damping, 1.8090080857856021],
            0.0,
            contact,
        )?
        .with_element(ForceElement::new(0, spring)?)
    };
    let first = 0.2300024209803972;
    let start = classify(&family(first).unwrap(), &State::at_rest(1)).unwrap();
    let branch = follow(family, first, start.orbit().unwrap(), 0.02..2.0).unwrap();
    let kinds = branch.bifurcations.iter().map(|found| found.kind);
    assert!(
        kinds.eq([BifurcationKind::Grazing; 2]),
        "{:?}",
        branch.bifurcations
    );
    let ends = [&branch.points[0], &branch.points[branch.points.len() - 1]];
    for (end, last) in std::iter::zip(&branch.ends, ends) {
        let BranchEnd::Hopf { parameter } = *end else {
            panic!("{end:?}")
        };
        let part = parameter / speed;
        let slope = -2.0 * (stat - kinetic) * part / speed * (-part * part).exp();
        assert!((damping + load * slope).abs() < 1e-13, "{parameter}");
        assert!(last.orbit.amplitude(0) > 1e-6 && last.orbit.is_stable());
        assert!((last.parameter - parameter).abs() < 1e-8, "{parameter}");
    }
}

/// A doubled branch that meets its primary where a touch of the belt begins is born there. Its last
/// steps before the touch are so short that the two halves of its period differ by rounding only.
#[test]
fn a_doubled_branch_is_born_where_it_meets_its_primary() {
    let family = |velocity: f64| {
        let law = Polynomial::new(0.4277808316488936, 0.2955734512019033, 0.3869495016458745)?;
        let spring = PolynomialSpring::new(&[0.0, 0.0, 0.06348880085020334])?;
        Structure::new(&[0.6289048991531904, 0.9170946840408104])?
            .with_ground_spring(0, 0.8121334472895735)?
            .with_ground_spring(1, 0.8106663206874578)?
            .with_ground_damper(0, 0.16753836124937854)?
            .with_ground_damper(1, 0.09228577258819005)?
            .with_spring(0, 1, 1.1749087061336052)?
            .with_damper(0, 1, 0.01674837515002987)?
            .with_element(ForceElement::new(1, spring)?)?
            .with_contact(Contact::new(0, law, 1.4818171315163187)?.on_belt(velocity))
    };
    let first = 0.25076514219946044;
    let start = classify(&family(first).unwrap(), &State::at_rest(2)).unwrap();
    let search = Search::new().with_max_points(300).unwrap();
    let branch = search.follow(family, first, start.orbit().unwrap(), 0.2..0.4);
    let branch = branch.unwrap();
    let births = branch.ends.iter().filter_map(|end| match end {
        BranchEnd::Birth { parameter } => Some(*parameter),
        _ => None,
    });
    let births: Vec<f64> = births.collect();
    let [&birth] = exactly(&births);
    assert!((birth - 0.2844016757).abs() < 1e-9, "{birth}");
    let halves = |orbit: &Orbit<State>| {
        let half = orbit.trajectory().state_at(0.5 * orbit.period()).unwrap();
        (half.displacements[0] - orbit.state().displacements[0]).abs()
            + (half.velocities[0] - orbit.state().velocities[0]).abs()
    };
    for point in &branch.points {
        let (apart, away) = (halves(&point.orbit), (point.parameter - birth).abs());
        assert!(apart > 1e-3 * away, "{}: {apart:e}", point.parameter);
    }
    let there = branch.bifurcations.iter();
    let there: Vec<_> = there.filter(|found| found.parameter == birth).collect();
    let [there] = exactly(&there);
    assert_eq!(there.kind, BifurcationKind::Grazing);
    assert!(halves(&there.orbit) < 1e-7);
}
