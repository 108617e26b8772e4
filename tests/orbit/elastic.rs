//! Branches and families of motions with elastic contacts.

use std::f64::consts::TAU;

use approx::assert_abs_diff_eq;
use serde_json::Value;
use stick_slip::orbit::{BifurcationKind, BranchEnd, Period, follow, lyapunov, settle, shoot};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Direction, Drive, Error, Integrator, Structure};

use crate::common::{exactly, number, one_mass, text};
use crate::reading::{cases, structure};
use crate::references::{period, start};

fn case(id: &str) -> Value {
    let cases = cases(include_str!("../data/joint_cycles.json"));
    cases
        .into_iter()
        .find(|case| text(&case["id"]) == id)
        .unwrap()
}

/// The system of a case, driven at another frequency.
fn at_frequency(case: &Value, frequency: f64) -> Structure {
    let mut system = case["system"].clone();
    for force in system["f"].as_array_mut().unwrap() {
        if force["type"] == "fourier" {
            for term in force["terms"].as_array_mut().unwrap() {
                term["omega"] = format!("{frequency:e}").into();
            }
        }
    }
    structure(&system, f64::NAN)
}

/// The resonance of a normal spring that opens leans over: from its unstable middle both folds are
/// found, and behind them both stable sides.
#[test]
fn a_resonance_is_followed_through_its_folds() {
    let case = case("jc_06");
    let length = number(&case["period"]);
    let frequency = TAU / length;
    let family = |frequency: f64| Ok::<_, Error>(at_frequency(&case, frequency));
    // The point of the file, carried to the end of its period of the drive.
    let time = number(&case["start"]["t"]).rem_euclid(length);
    let rest = Integrator::new()
        .with_start_time(time)
        .and_then(|i| i.simulate(&family(frequency)?, start(&case, 1), length - time))
        .unwrap();
    let orbit = shoot(&family(frequency).unwrap(), &rest.last(), period(&case)).unwrap();
    assert!(!orbit.is_stable());
    let branch = follow(family, frequency, &orbit, 1.15..1.45).unwrap();
    let folds: Vec<_> = branch
        .bifurcations
        .iter()
        .filter(|found| found.kind == BifurcationKind::Fold)
        .collect();
    let parameters: Vec<f64> = folds.iter().map(|fold| fold.parameter).collect();
    println!("folds at {parameters:?}");
    let [&low, &high] = exactly(&parameters);
    let (low, high) = (low.min(high), low.max(high));
    // The file says about 1.238 and 1.345, from a scan.
    assert!((low - 1.238).abs() < 1e-3 && (high - 1.345).abs() < 3e-3);
    for fold in folds {
        let nearest = fold.orbit.multipliers().iter().map(|m| (m - 1.0).norm());
        assert!(nearest.fold(f64::INFINITY, f64::min) < 1e-5);
    }
    // One motion outside the folds, three between them: two stable, with the unstable one there.
    let inside = branch
        .points
        .iter()
        .filter(|point| (low..high).contains(&point.parameter));
    let (stable, unstable): (Vec<_>, Vec<_>) = inside.partition(|point| point.orbit.is_stable());
    assert!(!stable.is_empty() && !unstable.is_empty());
    let ends = [branch.points.first(), branch.points.last()];
    assert!(
        ends.into_iter()
            .flatten()
            .all(|point| point.orbit.is_stable())
    );
}

fn oscillator(force: f64) -> Structure {
    let element = Contact::new(0, Coulomb::new(0.5, 0.5).unwrap(), 2.0)
        .and_then(|contact| contact.with_tangential_stiffness(3.0))
        .unwrap();
    let force = Drive::harmonic(force, 1.2, 0.0).unwrap();
    one_mass([1.0, 0.1, 1.0], force, element).unwrap()
}

/// A slider that never moves: the residual force is what it was at the start.
#[test]
fn sliders_that_never_move_keep_their_place() {
    let system = oscillator(0.2);
    for residual in [0.0, 0.3, -0.5] {
        let start = State::at_rest(1).with_memory(&[residual]);
        let orbit = shoot(&system, &start, Period::Driven(1)).unwrap();
        assert_eq!(orbit.unslipped(), [0]);
        assert_eq!(orbit.multipliers().len(), 2);
        // About its own centre, that of the carried force too.
        assert!(orbit.is_stable() && orbit.is_symmetric());
        let state = orbit.state();
        let place = state.displacements[0] - state.memory[0] / 3.0;
        assert!((place + residual / 3.0).abs() < 1e-14, "{place}");
        // (K + k_t) x + … = −k_t z: the mean.
        let (low, high) = orbit.extremes(0);
        assert!((0.5 * (low + high) + residual / 4.0).abs() < 1e-13);
    }
    let slips = settle(
        &oscillator(2.0),
        &State::at_rest(1),
        200.0,
        Period::Driven(1),
    )
    .unwrap();
    assert_eq!((slips.unslipped(), slips.multipliers().len()), (&[][..], 3));
}

/// Along a branch a slider that never moves keeps its place, wherever in its period a motion
/// starts: the mean displacement under a constant force is that of both springs.
#[test]
fn sliders_keep_their_place_along_a_branch() {
    for (constant, phase) in [(0.8, 0.0), (-0.8, 2.0), (0.3, 4.0)] {
        let family = |amplitude: f64| {
            let force = Drive::harmonic(amplitude, 1.2, phase)?.with_constant(constant)?;
            oscillator(0.0).with_force(0, force)
        };
        // Spring 1, element 3; its force has the amplitude 1.17 under a force of amplitude 1.
        let rest = constant / 4.0;
        let start = State::new(&[rest], &[0.0]).with_memory(&[3.0 * rest]);
        let orbit = shoot(&family(0.05).unwrap(), &start, Period::Driven(1)).unwrap();
        let branch = follow(family, 0.05, &orbit, 0.01..0.3).unwrap();
        assert_eq!(branch.ends, [BranchEnd::Range, BranchEnd::Range]);
        assert!(branch.points.len() > 20);
        for point in &branch.points {
            let (low, high) = point.orbit.extremes(0);
            // Each point of the branch adds its rounding.
            let apart = 0.5 * (low + high) - rest;
            assert!(apart.abs() < 1e-12, "{constant}: {apart:e}");
            assert_eq!(point.orbit.unslipped(), [0]);
        }
    }
}

/// The friction of a contact reaches its limit once in each period: it slips there until it has
/// moved so far that it only touches the limit. The motions without slip with one position of the
/// contact end where they reach it.
#[test]
fn a_slip_that_nothing_takes_back_ends_a_branch() {
    // T under a force of amplitude 1 while the slider stays: spring 1, element 3.
    let factor = 3.0 / f64::hypot(4.0 - 1.2 * 1.2, 0.1 * 1.2);
    for (constant, residual, direction) in [
        (0.8, 0.0, Direction::Leading),
        (-0.8, 0.0, Direction::Lagging),
        (0.3, 0.4, Direction::Leading),
        (0.0, -0.3, Direction::Lagging),
    ] {
        let family = |amplitude: f64| {
            let force = Drive::harmonic(amplitude, 1.2, 0.3)?.with_constant(constant)?;
            oscillator(0.0).with_force(0, force)
        };
        // The slider at −residual/3: T = 3x + residual, x = (constant − residual)/4 in the mean.
        let rest = 0.25 * (constant - residual);
        let mean = 3.0 * rest + residual;
        let start = State::new(&[rest], &[0.0]).with_memory(&[mean]);
        let orbit = shoot(&family(0.05).unwrap(), &start, Period::Driven(1)).unwrap();
        let end = (1.0 - mean.abs()) / factor;
        let branch = follow(family, 0.05, &orbit, 0.01..1.5).unwrap();
        let BranchEnd::OneWaySlip {
            parameter,
            contact: 0,
            direction: found,
        } = branch.ends[1]
        else {
            panic!("{constant}: {:?}", branch.ends)
        };
        assert_eq!((&branch.ends[0], found), (&BranchEnd::Range, direction));
        assert_abs_diff_eq!(parameter, end, epsilon = 1e-12);
        // No motion of the branch has moved its slider.
        for point in &branch.points {
            assert_eq!(
                (point.orbit.unslipped(), point.orbit.events().len()),
                (&[0][..], 0)
            );
            let (low, high) = point.orbit.extremes(0);
            assert_abs_diff_eq!(0.5 * (low + high), rest, epsilon = 1e-12);
        }
        let last = branch.points.last().unwrap();
        assert!(last.parameter < parameter && parameter - last.parameter < 1e-8);

        // Beyond, the slider comes to rest where the force touches its limit, up to the amplitude
        // 1/factor, at which it touches both.
        let beyond = 0.5 * (end + 1.0 / factor);
        let system = family(beyond).unwrap();
        let settled = settle(&system, &last.orbit.state(), 4000.0, Period::Driven(1)).unwrap();
        assert_eq!(settled.unslipped(), [0]);
        let state = settled.state();
        let (low, high) = settled.extremes(0);
        let place = state.displacements[0] - state.memory[0] / 3.0;
        let force = 3.0 * (0.5 * (low + high) - place);
        assert!(force.abs() <= 1.0 - beyond * factor + 1e-12, "{force}");
        assert!(force.abs() < mean.abs() && force * mean > 0.0, "{force}");
        let branch = follow(family, beyond, &settled, 0.01..1.5).unwrap();
        assert_eq!(branch.ends[0], BranchEnd::Range);
        assert!(matches!(branch.ends[1], BranchEnd::OneWaySlip { .. }));
    }
}

/// The same of a rigid contact under a mass that a vibrating one pulls at.
#[test]
fn a_rigid_contact_that_slips_one_way_ends_a_branch() {
    let family = |constant: f64, amplitude: f64| {
        Structure::new(&[1.0, 0.7])?
            .with_ground_spring(0, 1.0)?
            .with_spring(0, 1, 1.0)?
            .with_ground_damper(1, 0.1)?
            .with_force(1, Drive::harmonic(amplitude, 1.2, 0.4)?)?
            .with_force(0, constant)?
            .with_contact(Contact::new(0, Coulomb::new(0.5, 0.5)?, 2.0)?)
    };
    for (constant, expected) in [(0.8, Direction::Leading), (-0.7, Direction::Lagging)] {
        let family = |amplitude: f64| family(constant, amplitude);
        let start = State::at_rest(2);
        let orbit = shoot(&family(0.01).unwrap(), &start, Period::Driven(1)).unwrap();
        let branch = follow(family, 0.01, &orbit, 0.005..0.5).unwrap();
        let BranchEnd::OneWaySlip {
            parameter,
            contact: 0,
            direction,
        } = branch.ends[1]
        else {
            panic!("{constant}: {:?}", branch.ends)
        };
        assert_eq!(direction, expected);
        // The second mass on its spring.
        let factor = 1.0 / f64::hypot(1.0 - 0.7 * 1.2 * 1.2, 0.1 * 1.2);
        assert_abs_diff_eq!(parameter, (1.0 - constant.abs()) / factor, epsilon = 1e-12);
    }
}

/// A force that is largest at the start of the period: beyond the end the contact slips from the
/// first instant, without an event of its own.
#[test]
fn a_contact_that_slips_one_way_from_the_start_ends_a_branch() {
    let family = |load: f64| {
        let force = Drive::harmonic(0.3, 1.2, 0.0)?.with_constant(0.4)?;
        let contact = Contact::new(0, Coulomb::new(0.5, 0.5)?, load)?;
        one_mass([1.0, 0.1, 1.0], force, contact)
    };
    let orbit = shoot(&family(2.0).unwrap(), &State::at_rest(1), Period::Driven(1)).unwrap();
    let branch = follow(family, 2.0, &orbit, 1.0..3.0).unwrap();
    let BranchEnd::OneWaySlip {
        parameter,
        contact: 0,
        direction: Direction::Leading,
    } = branch.ends[0]
    else {
        panic!("{:?}", branch.ends)
    };
    assert_abs_diff_eq!(parameter, (0.3 + 0.4) / 0.5, epsilon = 1e-12);
    assert_eq!(branch.ends[1], BranchEnd::Range);
}

/// A slider that slips at the start of the period carries its limit, which follows the load: this
/// is no motion of the branch sideways. Slip all the time shifts the mean displacement by the limit
/// and nothing else.
#[test]
fn the_limit_of_a_slider_follows_the_load() {
    for (belt, amplitude, sticks) in [(0.5, 0.2, false), (0.1, 0.6, true)] {
        let family = |load: f64| {
            let contact = Contact::new(0, Coulomb::new(0.5, 0.5)?, load)?.on_belt(belt);
            let force = Drive::harmonic(amplitude, 0.5, 0.3)?;
            let contact = contact.with_tangential_stiffness(8.0)?;
            one_mass([1.0, 0.1, 1.0], force, contact)
        };
        let start = State::new(&[0.5], &[0.0]).with_memory(&[-0.5]);
        let orbit = settle(&family(1.0).unwrap(), &start, 300.0, Period::Driven(1)).unwrap();
        let branch = follow(family, 1.0, &orbit, 0.6..1.4).unwrap();
        assert_eq!(branch.ends, [BranchEnd::Range, BranchEnd::Range]);
        for point in &branch.points {
            let limit = 0.5 * point.parameter;
            assert_eq!(point.orbit.events().is_empty(), !sticks);
            if !sticks {
                assert_eq!(point.orbit.state().memory, [-limit]);
                let (low, high) = point.orbit.extremes(0);
                let factor = f64::hypot(1.0 - 0.25, 0.1 * 0.5).recip();
                assert_abs_diff_eq!(0.5 * (low + high), limit, epsilon = 1e-12);
                assert_abs_diff_eq!(0.5 * (high - low), amplitude * factor, epsilon = 1e-12);
            }
        }
    }
}

/// The end is as near in newtons and micrometres, where derivatives of forces are large numbers.
#[test]
fn the_end_of_a_branch_does_not_depend_on_units() {
    let (length, force) = (1e-6, 1e2);
    let stiffness = force / length;
    let family = |amplitude: f64| {
        let drive = Drive::harmonic(force * amplitude, 1.2, 0.3)?.with_constant(0.8 * force)?;
        let contact = Contact::new(0, Coulomb::new(0.5, 0.5)?, 2.0 * force)?;
        let contact = contact.with_tangential_stiffness(3.0 * stiffness)?;
        one_mass([stiffness, 0.1 * stiffness, stiffness], drive, contact)
    };
    let start = State::new(&[0.2 * length], &[0.0]).with_memory(&[0.6 * force]);
    let orbit = shoot(&family(0.05).unwrap(), &start, Period::Driven(1)).unwrap();
    let branch = follow(family, 0.05, &orbit, 0.01..1.5).unwrap();
    let BranchEnd::OneWaySlip { parameter, .. } = branch.ends[1] else {
        panic!("{:?}", branch.ends)
    };
    let end = 0.4 * f64::hypot(4.0 - 1.2 * 1.2, 0.1 * 1.2) / 3.0;
    assert_abs_diff_eq!(parameter, end, epsilon = 1e-12);
    let last = branch.points.last().unwrap();
    assert!(parameter - last.parameter < 1e-8);
}

/// The exponent of a motion is that of its multipliers.
#[test]
fn exponents_are_those_of_the_multipliers() {
    let system = oscillator(2.0);
    let orbit = settle(&system, &State::at_rest(1), 200.0, Period::Driven(1)).unwrap();
    let expected = orbit.multipliers()[0].norm().ln() / orbit.period();
    let found = lyapunov(&system, &orbit.state(), 50.0, 800.0 * orbit.period()).unwrap();
    assert!((found - expected).abs() < 1e-3, "{found:?} {expected}");
}
