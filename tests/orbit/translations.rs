//! Motions that are periodic up to a translation: shafts that nothing holds.

use stick_slip::nalgebra::{self, DMatrix, DVector};
use stick_slip::orbit::{
    self, Bifurcation, BifurcationKind, BranchEnd, LocusKind, Orbit, Period, classify, follow,
    orbit_sensitivities, settle, shoot,
};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, Error, EventKind, Exponential, Polynomial, Structure};

use crate::common::{exactly, one_mass, oscillator};

/// Inertias of a shaft with a clutch between them, its spring and damper.
const INERTIAS: [f64; 2] = [1.3, 0.7];
const SPRING: f64 = 2.0;
const DAMPER: f64 = 0.05;
const TORQUE: f64 = 1.5;
const FREQUENCY: f64 = 1.1;

fn law() -> Exponential {
    Exponential::new(0.3, 0.15, 0.5).unwrap()
}

/// A shaft whose ends rub on each other, driven at one end; nothing else touches it.
fn clutch() -> Result<Structure, Error> {
    Structure::new(&INERTIAS)?
        .with_spring(0, 1, SPRING)?
        .with_damper(0, 1, DAMPER)?
        .with_force(0, Drive::harmonic(TORQUE, FREQUENCY, 0.0)?)?
        .with_contact(Contact::between(0, 1, law(), 1.0)?)
}

/// The same for the twist q_0 − q_1 alone: reduced mass and force.
fn twist() -> Result<Structure, Error> {
    let [a, b] = INERTIAS;
    let force = Drive::harmonic(TORQUE * b / (a + b), FREQUENCY, 0.0)?;
    let contact = Contact::new(0, law(), 1.0)?;
    one_mass([a * b / (a + b), DAMPER, SPRING], force, contact)
}

/// The centre of mass is a free particle, the twist an oscillator of its own.
#[test]
fn a_free_shaft_is_its_twist_and_its_centre_of_mass() {
    let [a, b] = INERTIAS;
    let mean = 7.0;
    let start = State::new(&[0.5, 0.5], &[mean, mean]);
    let orbit = settle(&clutch().unwrap(), &start, 300.0, Period::Driven(1)).unwrap();
    let alone = settle(
        &twist().unwrap(),
        &State::at_rest(1),
        300.0,
        Period::Driven(1),
    )
    .unwrap();
    println!("{orbit:?}\n{alone:?}");
    // Of four multipliers two are 1: of the place, and of the mean velocity.
    assert_eq!(orbit.multipliers().len(), 2);
    for (found, known) in std::iter::zip(orbit.multipliers(), alone.multipliers()) {
        assert!((found - known).norm() < 1e-12, "{found} {known}");
    }
    assert!(orbit.is_stable() && !orbit.events().is_empty());
    for (found, known) in std::iter::zip(orbit.events(), alone.events()) {
        assert_eq!(found.kind, known.kind);
        assert!((found.time - known.time).abs() < 1e-12);
    }
    // A torque p cos Ωt: the velocity of the centre is its start and p/(mΩ) sin Ωt.
    let period = orbit.period();
    let begun = orbit.state();
    let centre = |numbers: &[f64]| (a * numbers[0] + b * numbers[1]) / (a + b);
    let drift = centre(&begun.velocities);
    assert!((drift - mean).abs() < 1e-10);
    for i in 0..2 {
        let error = orbit.mean_velocity(i) - drift;
        assert!(error.abs() < 1e-12, "{error:e}");
    }
    assert_eq!(alone.mean_velocity(0), 0.0);
    for k in 0..=10 {
        let time = 0.1 * f64::from(k) * period;
        let state = orbit.trajectory().state_at(time).unwrap();
        let single = alone.trajectory().state_at(time).unwrap();
        let found = centre(&state.displacements);
        let swing = TORQUE / ((a + b) * FREQUENCY * FREQUENCY);
        let known =
            centre(&begun.displacements) + drift * time + swing * (1.0 - (FREQUENCY * time).cos());
        assert!((found - known).abs() < 1e-11, "{found} {known}");
        let twist = state.displacements[0] - state.displacements[1];
        assert!((twist - single.displacements[0]).abs() < 1e-12);
    }
    // Displacements without the mean velocity: the amplitude of the shaft does not count its turns.
    assert!(orbit.amplitude(0) < 1.0 && orbit.amplitude(1) < 1.0);
    let harmonic = orbit.harmonics(0, 1)[0];
    let velocity = orbit.velocity_harmonics(0, 1)[0];
    assert!((velocity.norm() / harmonic.norm() - FREQUENCY).abs() < 1e-12);
}

/// The slope of the characteristic of a motor: torque over velocity.
const DRIVE: f64 = 20.0;

/// A drill string of inertias that a motor turns against friction at the other end.
fn string(inertias: usize, torque: f64, ground: f64) -> Result<Structure, Error> {
    let mut string = Structure::new(&vec![0.5; inertias])?;
    for i in 1..inertias {
        string = string
            .with_spring(i - 1, i, 3.0)?
            .with_damper(i - 1, i, 0.02)?;
    }
    // The ground moves at a velocity, in a frame that moves at its negative.
    let law = Exponential::new(0.8, 0.4, 0.5)?;
    string
        .with_ground_damper(inertias - 1, DRIVE)?
        .with_force(inertias - 1, Drive::constant(torque + DRIVE * ground))?
        .with_contact(Contact::new(0, law, 1.0)?.on_belt(ground))
}

fn turning(inertias: usize, torque: f64) -> Orbit<State> {
    let start = State::new(&vec![0.0; inertias], &vec![0.5; inertias]);
    let system = string(inertias, torque, 0.0).unwrap();
    let attractor = classify(&system, &start).unwrap();
    println!("{attractor:?}");
    attractor.orbit().unwrap().clone()
}

/// An autonomous motion that is translated is periodic in the frame that moves with it.
#[test]
fn a_string_that_turns_is_periodic_in_its_own_frame() {
    for (inertias, torque) in [(2, 10.6), (3, 10.6), (6, 10.8)] {
        let orbit = turning(inertias, torque);
        let mean = orbit.mean_velocity(0);
        println!("{inertias} {mean} {orbit:?} {:?}", orbit.multipliers());
        assert!(orbit.stick_duration(0) > 0.0 && mean > 0.1 && orbit.is_stable());
        assert_eq!(orbit.multipliers().len(), 2 * inertias - 2);
        for i in 1..inertias {
            assert!((orbit.mean_velocity(i) - mean).abs() < 1e-12 * mean);
        }
        let still = string(inertias, torque, -mean).unwrap();
        let mut state = orbit.state();
        state.velocities.iter_mut().for_each(|v| *v -= mean);
        let other = shoot(&still, &state, Period::Free(orbit.period())).unwrap();
        assert!((other.period() - orbit.period()).abs() < 1e-11);
        assert!(other.mean_velocity(0).abs() < 1e-12);
        for (a, b) in std::iter::zip(orbit.multipliers(), other.multipliers()) {
            assert!((a - b).norm() < 1e-9, "{a} {b}");
        }
        for i in 0..inertias {
            let [a, b] = [&orbit, &other].map(|orbit| orbit.amplitude(i));
            assert!((a - b).abs() < 1e-11, "{a} {b}");
        }
    }
}

/// Multipliers against the map over a period by difference quotients, with the 1 of the translation
/// and that of a shift along the motion.
#[test]
fn multipliers_are_those_of_neighbouring_motions() {
    let orbit = turning(3, 10.6);
    let system = string(3, 10.6, 0.0).unwrap();
    // Begin in the middle of the slip phase.
    let events = orbit.events();
    let slips = events
        .iter()
        .position(|event| event.kind != EventKind::Stick)
        .unwrap();
    let begin = events[slips].time % orbit.period();
    let slip = orbit.period() - orbit.stick_duration(0);
    let begun = system
        .simulate(orbit.state(), begin + 0.5 * slip)
        .unwrap()
        .last();
    let end = |i: usize, change: f64| {
        let mut start = begun.clone();
        match i {
            0..3 => start.displacements[i] += change,
            _ => start.velocities[i - 3] += change,
        }
        let end = system.simulate(start, orbit.period()).unwrap().last();
        [end.displacements, end.velocities].concat()
    };
    const CHANGE: f64 = 1e-5;
    let columns = (0..6).map(|i| {
        let [low, high] = [-CHANGE, CHANGE].map(|change| DVector::from_vec(end(i, change)));
        (high - low) / (2.0 * CHANGE)
    });
    let matrix = DMatrix::from_columns(&columns.collect::<Vec<_>>());
    let mut quotients: Vec<_> = matrix.complex_eigenvalues().iter().copied().collect();
    println!("{quotients:?} {:?}", orbit.multipliers());
    let one = nalgebra::Complex::new(1.0, 0.0);
    for known in [one, one].iter().chain(orbit.multipliers()) {
        let off = |found: &nalgebra::Complex<f64>| (found - known).norm();
        let nearest = (0..quotients.len())
            .min_by(|&i, &j| off(&quotients[i]).total_cmp(&off(&quotients[j])))
            .unwrap();
        let nearest = quotients.remove(nearest);
        assert!((nearest - known).norm() < 1e-6, "{nearest} {known}");
    }
    assert!(quotients.is_empty());
}

/// A branch of such motions, to where they end.
#[test]
fn branches_of_translated_motions_are_followed() {
    let orbit = turning(3, 10.6);
    let family = |torque: f64| string(3, torque, 0.0);
    let branch = follow(family, 10.6, &orbit, 8.0..40.0).unwrap();
    for found in &branch.bifurcations {
        println!(
            "{:?} {} {:?}",
            found.kind,
            found.parameter,
            found.orbit.multipliers()
        );
    }
    println!("{} {:?}", branch.points.len(), branch.ends);
    // It shrinks to steady turning at one end, after its stop has gone.
    assert!(matches!(branch.ends[1], BranchEnd::Hopf { .. }));
    assert_eq!(branch.bifurcations[0].kind, BifurcationKind::Grazing);
    for point in &branch.points {
        let orbit = &point.orbit;
        // The mean torque vanishes: drive, damper and friction.
        let system = family(point.parameter).unwrap();
        let found = shoot(&system, &orbit.state(), orbit.kind()).unwrap();
        assert!((found.period() - orbit.period()).abs() < 1e-9);
        assert!((found.mean_velocity(1) - orbit.mean_velocity(1)).abs() < 1e-9);
        let energy = orbit.energy();
        let heat = energy.damper_loss + energy.friction_loss.iter().sum::<f64>();
        let work = energy.force_work.iter().sum::<f64>();
        assert!((work - heat).abs() < 1e-11 * work.abs(), "{work} {heat}");
        assert!(
            (work - point.parameter * orbit.mean_velocity(2) * orbit.period()).abs() < 1e-11 * work
        );
    }
}

/// Where a motion starts along its translation is arbitrary, and stays that of the guess.
#[test]
fn the_place_of_the_guess_is_kept() {
    let orbit = turning(3, 10.6);
    let system = string(3, 10.6, 0.0).unwrap();
    for shift in [-50.0, 0.3, 1e3] {
        let mut guess = orbit.state();
        guess.displacements.iter_mut().for_each(|x| *x += shift);
        let found = shoot(&system, &guess, orbit.kind()).unwrap();
        let error = found.state().displacements[0] - orbit.state().displacements[0] - shift;
        assert!(error.abs() < 1e-12 * (1.0 + shift.abs()), "{error:e}");
        assert!((found.period() - orbit.period()).abs() < 1e-11);
    }
}

/// Two shafts that only a contact connects have two translations, geared ones another direction.
#[test]
fn translations_are_found_whatever_their_number_and_direction() {
    let law = Coulomb::new(0.4, 0.3).unwrap();
    // Nothing connects the masses but friction: both displacements are free.
    let pair = Structure::new(&[1.0, 2.0])
        .and_then(|pair| pair.with_force(0, Drive::harmonic(1.0, 1.3, 0.0)?))
        .and_then(|pair| pair.with_contact(Contact::between(0, 1, law, 1.0)?))
        .and_then(|pair| pair.with_contact(Contact::new(1, law, 0.5)?.on_belt(1.0)))
        .unwrap();
    let start = State::new(&[0.0, 0.0], &[1.0, 1.0]);
    let orbit = settle(&pair, &start, 200.0, Period::Driven(1)).unwrap();
    println!(
        "{orbit:?} {:?} {}",
        orbit.unslipped(),
        orbit.mean_velocity(0)
    );
    assert_eq!(orbit.multipliers().len() + orbit.unslipped().len(), 2);
    assert!(orbit.is_stable());
    // Gears: a spring holds q_0 − 3 q_1.
    let ratio = 3.0;
    let stiffness = [2.0, -2.0 * ratio, -2.0 * ratio, 2.0 * ratio * ratio];
    let geared = |damping: f64| {
        Structure::new(&[1.0, 0.2])?
            .with_stiffness(DMatrix::from_row_slice(2, 2, &stiffness))?
            .with_ground_damper(0, damping)?
            .with_force(0, Drive::harmonic(1.0, 0.9, 0.0)?)?
            .with_contact(Contact::new(1, law, 0.2)?.on_belt(2.0))
    };
    let orbit = settle(
        &geared(0.1).unwrap(),
        &State::at_rest(2),
        300.0,
        Period::Driven(1),
    )
    .unwrap();
    println!("{orbit:?} {}", orbit.mean_velocity(0));
    assert_eq!(orbit.multipliers().len(), 3);
    assert!((orbit.mean_velocity(0) / orbit.mean_velocity(1) - ratio).abs() < 1e-12);
    assert!(orbit.mean_velocity(0) > 0.01);
}

/// A contact that never slips may hold what could be translated: it is one multiplier, not two.
#[test]
fn a_contact_that_never_slips_holds_a_translation() {
    let law = Coulomb::new(0.4, 0.4).unwrap();
    for (belt, elastic) in [(0.0, false), (2.0, false), (0.0, true), (2.0, true)] {
        let mut hold = Contact::new(0, law, 100.0).unwrap().on_belt(belt);
        if elastic {
            hold = hold.with_tangential_stiffness(5.0).unwrap();
        }
        let shaft = Structure::new(&[1.0, 1.0])
            .and_then(|shaft| shaft.with_spring(0, 1, 2.0))
            .and_then(|shaft| shaft.with_damper(0, 1, 0.2))
            .and_then(|shaft| shaft.with_force(1, Drive::harmonic(0.6, 1.1, 0.0)?))
            .and_then(|shaft| shaft.with_contact(hold))
            .and_then(|shaft| shaft.with_contact(Contact::new(1, law, 0.5)?.on_belt(belt)))
            .unwrap();
        let start = State::new(&[0.0, 0.0], &[belt, belt]);
        let orbit = settle(&shaft, &start, 300.0, Period::Driven(1)).unwrap();
        println!("{belt} {elastic} {orbit:?} {:?}", orbit.unslipped());
        assert_eq!(orbit.unslipped(), [0]);
        let order = if elastic { 5 } else { 4 };
        assert_eq!(orbit.multipliers().len(), order - 1);
        assert!(orbit.is_stable());
        for i in 0..2 {
            assert!((orbit.mean_velocity(i) - belt).abs() < 1e-12);
        }
    }
}

#[test]
fn what_is_not_periodic_up_to_a_translation_is_refused() {
    // A force with a mean value accelerates what nothing holds.
    let pushed = clutch().unwrap();
    let pushed = pushed.with_force(1, Drive::constant(0.1)).unwrap();
    let start = State::at_rest(2);
    let error = shoot(&pushed, &start, Period::Driven(1)).unwrap_err();
    assert!(matches!(error, Error::NotPeriodic { .. }), "{error}");
    // A shaft that turns steadily is at rest in its frame.
    let steady = string(2, 60.0, 0.0).unwrap();
    let start = State::new(&[0.0, 0.0], &[1.0, 1.0]);
    let error = settle(&steady, &start, 1000.0, Period::Free(3.0)).unwrap_err();
    assert!(matches!(error, Error::AtRest), "{error}");
    let kind = classify(&steady, &start).unwrap().kind();
    assert_eq!(kind, orbit::AttractorKind::SteadySliding);
    // A weak spring holds a shaft: it has no mean velocity.
    let held = clutch().unwrap().with_ground_spring(1, 1e-3).unwrap();
    let start = State::at_rest(2);
    let orbit = shoot(&held, &start, Period::Driven(1)).unwrap();
    assert_eq!(orbit.mean_velocity(0), 0.0);
    assert_eq!(orbit.multipliers().len(), 4);
}

/// The Lyapunov exponent of a stable motion is that of its largest multiplier, not the 0 of its
/// translation.
#[test]
fn the_lyapunov_exponent_leaves_the_translation_out() {
    let law = Polynomial::new(0.3, 0.0, 0.1).unwrap();
    let shaft = Structure::new(&[1.0, 1.0])
        .and_then(|shaft| shaft.with_spring(0, 1, 2.0))
        .and_then(|shaft| shaft.with_damper(0, 1, 0.2))
        .and_then(|shaft| shaft.with_ground_damper(0, 0.3))
        .and_then(|shaft| shaft.with_force(0, Drive::harmonic(0.6, 1.1, 0.0)?))
        .and_then(|shaft| shaft.with_contact(Contact::new(1, law, 0.5)?.on_belt(3.0)))
        .unwrap();
    let start = State::at_rest(2);
    let orbit = settle(&shaft, &start, 300.0, Period::Driven(1)).unwrap();
    println!("{orbit:?}");
    let known = orbit.multipliers()[0].norm().ln() / orbit.period();
    let found = orbit::lyapunov(&shaft, &start, 300.0, 1000.0).unwrap();
    assert!(
        known < -0.01 && (found - known).abs() < 2e-3,
        "{found} {known}"
    );
}

/// A shaft of two equal inertias that nothing holds, driven at one end, and its twist alone: they
/// have the same symmetric stick-slip.
fn symmetric([frequency, torque]: [f64; 2], is_free: bool) -> Result<Structure, Error> {
    let (system, contact, torque) = if is_free {
        let shaft = Structure::new(&[2.0; 2])?
            .with_spring(0, 1, 1.0)?
            .with_damper(0, 1, 0.02)?;
        let contact = Contact::between(0, 1, Coulomb::new(0.6, 0.3)?, 0.6)?;
        (shaft, contact, 2.0 * torque)
    } else {
        let twist = oscillator([1.0, 0.02, 1.0], 0.0)?;
        let contact = Contact::new(0, Coulomb::new(0.6, 0.3)?, 0.6)?;
        (twist, contact, torque)
    };
    system
        .with_force(0, Drive::harmonic(torque, frequency, 0.0)?)?
        .with_contact(contact)
}

/// A pitchfork of a motion that may be translated, and its curve over two parameters, are those of
/// the twist.
#[test]
fn pitchforks_of_a_free_shaft_are_those_of_its_twist() {
    const BEGIN: [f64; 2] = [0.36, 0.9];
    let found = [true, false].map(|is_free| {
        let family = |p: [f64; 2]| symmetric(p, is_free);
        let over = |frequency: f64| family([frequency, BEGIN[1]]);
        let system = over(BEGIN[0]).unwrap();
        let start = State::at_rest(if is_free { 2 } else { 1 });
        let orbit = settle(&system, &start, 400.0, Period::Driven(1)).unwrap();
        assert!(orbit.is_symmetric(), "{orbit:?}");
        let branch = follow(over, BEGIN[0], &orbit, BEGIN[0]..0.375).unwrap();
        for found in &branch.bifurcations {
            println!("{is_free} {:?} {}", found.kind, found.parameter);
        }
        let pitchfork: Vec<Bifurcation<State>> = branch
            .bifurcations
            .into_iter()
            .filter(|found| found.kind == BifurcationKind::Pitchfork)
            .collect();
        let [pitchfork] = exactly(&pitchfork);
        let both = |frequency: f64, torque: f64| family([frequency, torque]);
        let ranges = [0.3..0.5, 0.85..1.0];
        let locus = orbit::locus(both, pitchfork, BEGIN[1], ranges).unwrap();
        assert_eq!(locus.kind, LocusKind::Pitchfork);
        assert!(locus.points.len() >= 3);
        for point in &locus.points {
            assert!(point.orbit.is_symmetric());
            let multiplier = point.orbit.multipliers()[0];
            assert!((multiplier - 1.0).norm() < 1e-10, "{multiplier}");
        }
        // The torques at the ends of the range are given: the frequencies there are to be found.
        let ends = [0.85, 1.0].map(|torque| {
            let mut points = locus.points.iter();
            let end = points.find(|point| point.parameters[1] == torque);
            let end = end.unwrap_or_else(|| panic!("{:?}", locus.ends));
            end.parameters[0]
        });
        [pitchfork.parameter, ends[0], ends[1]]
    });
    println!("{found:?}");
    for (free, twist) in std::iter::zip(found[0], found[1]) {
        assert!((free - twist).abs() < 1e-11, "{free} {twist}");
    }
}

/// The derivatives by parameters are those of the twist, or difference quotients.
#[test]
fn sensitivities_of_translated_motions_are_difference_quotients() {
    // A driven shaft that also turns: its events are those of its twist, which does not turn.
    let parameters = [0.4, 0.9];
    let found = [true, false].map(|is_free| {
        let family = |p: &[f64]| symmetric([p[0], p[1]], is_free);
        let system = family(&parameters).unwrap();
        let start = match is_free {
            true => State::new(&[0.0; 2], &[3.0; 2]),
            false => State::at_rest(1),
        };
        let orbit = settle(&system, &start, 400.0, Period::Driven(1)).unwrap();
        if is_free {
            assert!((orbit.mean_velocity(0) - 3.0).abs() < 1e-9);
        }
        orbit_sensitivities(family, &parameters, &orbit).unwrap()
    });
    let events = found.each_ref().map(|found| found.motion.events());
    assert!(events[0].len() >= 4 && events[0].len() == events[1].len());
    for (free, twist) in std::iter::zip(&events[0], &events[1]) {
        assert_eq!(free.kind, twist.kind);
        assert!((free.time - twist.time).abs() < 1e-10);
        for (a, b) in std::iter::zip(&free.by_parameters, &twist.by_parameters) {
            assert!((a - b).abs() < 1e-7 * (1.0 + b.abs()), "{a} {b}");
        }
    }
    // An autonomous one: its period over the torque and the ground's velocity, on which a motion
    // that is translated does not depend but for its friction.
    let family = |p: &[f64]| string(3, p[0], p[1]);
    let parameters = [10.6, 0.01];
    let guess = turning(3, 10.6);
    let shot = |p: &[f64]| {
        let estimate = Period::Free(guess.period());
        shoot(&family(p).unwrap(), &guess.state(), estimate).unwrap()
    };
    let found = orbit_sensitivities(family, &parameters, &shot(&parameters)).unwrap();
    for j in 0..2 {
        const STEP: f64 = 1e-5;
        let [low, high] = [-STEP, STEP].map(|change| {
            let mut beside = parameters;
            beside[j] += change;
            shot(&beside).period()
        });
        let slope = (high - low) / (2.0 * STEP);
        let error = found.period[j] - slope;
        println!("{j}: {slope} {error:e}");
        assert!(
            error.abs() < 1e-7 * (1.0 + slope.abs()),
            "{slope} {error:e}"
        );
    }
}

/// Two equal inertias on dampers to the ground drift under constant torques. Their relative motion
/// is that of one mass on a spring and a damper, under half the alternating torque, with the same
/// contact. This motion is plainly periodic, and has the same curves in two parameters.
mod loci {
    use std::f64::consts::TAU;

    use super::*;
    use stick_slip::Stribeck;
    use stick_slip::orbit::{Locus, LocusEnd, SpecialKind, locus};

    /// The mean velocity of the shaft.
    const DRIFT: f64 = 0.3;

    /// The shaft, and the mass in its place, with a spring, a damper, a contact and the amplitude
    /// and frequency of a force.
    fn shaft(
        [spring, damper]: [f64; 2],
        contact: Contact,
        [force, frequency]: [f64; 2],
    ) -> Result<Structure, Error> {
        let bearing = 0.3 * damper;
        let drift = || Drive::harmonic(0.0, 1.0, 0.0)?.with_constant(bearing * DRIFT);
        let torque = match force {
            0.0 => drift()?,
            force => {
                Drive::harmonic(2.0 * force, frequency, 0.0)?.with_constant(bearing * DRIFT)?
            }
        };
        Structure::new(&[2.0, 2.0])?
            .with_ground_damper(0, bearing)?
            .with_ground_damper(1, bearing)?
            .with_spring(0, 1, spring)?
            .with_damper(0, 1, damper - 0.5 * bearing)?
            .with_force(0, torque)?
            .with_force(1, drift()?)?
            .with_contact(contact)
    }

    fn mass(
        [spring, damper]: [f64; 2],
        contact: Contact,
        [force, frequency]: [f64; 2],
    ) -> Result<Structure, Error> {
        let force = match force {
            0.0 => Drive::constant(0.0),
            force => Drive::harmonic(force, frequency, 0.0)?,
        };
        one_mass([1.0, damper, spring], force, contact)
    }

    /// The bifurcations of a kind in a branch, in the order of the parameter.
    fn of_kind(
        family: impl Fn(f64, f64) -> Result<Structure, Error>,
        kind: BifurcationKind,
        (start, second): (f64, f64),
        motion: &Orbit<State>,
        range: std::ops::Range<f64>,
    ) -> Vec<Bifurcation<State>> {
        let branch = follow(|first| family(first, second), start, motion, range).unwrap();
        let mut found = branch.bifurcations;
        found.retain(|found| found.kind == kind);
        found.sort_by(|a, b| a.parameter.total_cmp(&b.parameter));
        found
    }

    /// The special points and the ends of a curve, in the order of the first parameter.
    fn marks(locus: &Locus<State>) -> Vec<([f64; 2], String)> {
        let special = locus.special.iter();
        let special = special.map(|point| (point.parameters, point.kind.to_string()));
        let last = [0, locus.points.len() - 1];
        let ends = std::iter::zip(&locus.ends, last).map(|(end, i)| match end {
            LocusEnd::Hopf { parameters } => (*parameters, "Hopf".to_string()),
            LocusEnd::Ranges | LocusEnd::Jump => (locus.points[i].parameters, format!("{end:?}")),
            _ => panic!("{:?}", locus.ends),
        });
        let mut marks: Vec<_> = special.chain(ends).collect();
        marks.sort_by(|a, b| a.1.cmp(&b.1).then(a.0[0].total_cmp(&b.0[0])));
        marks
    }

    /// Asserts that two curves are the same.
    fn assert_same(a: &Locus<State>, b: &Locus<State>) {
        assert_eq!(a.kind, b.kind);
        let [a, b] = [a, b].map(marks);
        assert_eq!(a.len(), b.len(), "{a:?} {b:?}");
        for ((found, kind), (known, other)) in std::iter::zip(a, b) {
            assert_eq!(kind, other);
            // Cusps are computed from differences. Hopf points are extrapolated from small motions:
            // rounding beside a drift, which does not shrink, is larger.
            let accuracy = match &kind[..] {
                "cusp" => 1e-9,
                "Hopf" => 3e-7,
                _ => 1e-11,
            };
            for (found, known) in std::iter::zip(found, known) {
                let error = (found / known - 1.0).abs();
                assert!(error < accuracy, "{kind}: {found} {known}");
            }
        }
    }

    #[test]
    #[ignore = "a full count: sixteen long curves; the next test has shorter ones"]
    fn of_a_forced_shaft_are_those_of_its_relative_motion() {
        let law = || Stribeck::new(0.5, 0.25, 0.3, 2).unwrap();
        let relative = |hertz: f64, force: f64| {
            let contact = Contact::new(0, law(), 30.0)?.on_belt(0.25);
            mass([1e4, 6.0], contact, [force, TAU * hertz])
        };
        let whole = |hertz: f64, force: f64| {
            let contact = Contact::between(0, 1, law(), 30.0)?.on_belt(0.25);
            shaft([1e4, 6.0], contact, [force, TAU * hertz])
        };
        let (hertz, force) = (17.0, 8.0);
        let start = State::at_rest(1);
        let period = Period::Driven(1);
        let plain = settle(&relative(hertz, force).unwrap(), &start, 10.0, period).unwrap();
        let start = State::new(&[0.0; 2], &[DRIFT; 2]);
        let drifts = settle(&whole(hertz, force).unwrap(), &start, 10.0, period).unwrap();
        let ranges = [8.0..30.0, 0.05..40.0];
        for kind in [BifurcationKind::Fold, BifurcationKind::Grazing] {
            let at = (hertz, force);
            let known = of_kind(relative, kind, at, &plain, 8.0..30.0);
            let found = of_kind(whole, kind, at, &drifts, 8.0..30.0);
            assert_eq!([known.len(), found.len()], [2, 2]);
            for (known, found) in std::iter::zip(&known, &found) {
                let known = locus(relative, known, force, ranges.clone()).unwrap();
                let found = locus(whole, found, force, ranges.clone()).unwrap();
                assert_same(&found, &known);
            }
        }
    }

    #[test]
    fn of_a_shaft_that_vibrates_by_itself_are_those_of_its_relative_motion() {
        let law = || Exponential::new(0.4, 0.25, 0.5).unwrap();
        let relative = |belt: f64, damper: f64| {
            let contact = Contact::new(0, law(), 1.0)?.on_belt(belt);
            mass([1.0, damper], contact, [0.0, 0.0])
        };
        let whole = |belt: f64, damper: f64| {
            let contact = Contact::between(0, 1, law(), 1.0)?.on_belt(belt);
            shaft([1.0, damper], contact, [0.0, 0.0])
        };
        // A pure-slip cycle near a fold.
        let (belt, damper, place) = (0.7703842327935547, 0.109738820315199, 0.8778922296352182);
        let period = Period::Free(6.2915);
        let start = State::new(&[place], &[0.0]);
        let plain = shoot(&relative(belt, damper).unwrap(), &start, period).unwrap();
        let start = State::new(&[0.5 * place, -0.5 * place], &[DRIFT; 2]);
        let drifts = shoot(&whole(belt, damper).unwrap(), &start, period).unwrap();
        assert!((drifts.mean_velocity(0) - DRIFT).abs() < 1e-12);
        for kind in [BifurcationKind::Fold, BifurcationKind::Grazing] {
            let at = (belt, damper);
            let known = of_kind(relative, kind, at, &plain, 0.5..1.6);
            let found = of_kind(whole, kind, at, &drifts, 0.5..1.6);
            let (known, found) = (known.last().unwrap(), found.last().unwrap());
            let ranges = [0.5..1.6, 0.03..0.2];
            let known = locus(relative, known, damper, ranges.clone()).unwrap();
            let found = locus(whole, found, damper, ranges).unwrap();
            if kind == BifurcationKind::Fold {
                let mut special = found.special.iter();
                assert!(special.any(|point| point.kind == SpecialKind::FoldGrazing));
            }
            assert_same(&found, &known);
        }
    }
}
