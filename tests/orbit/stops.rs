//! Periodic motions with stops: multipliers against differences, a touch on a branch, attractors.

use std::f64::consts::TAU;

use stick_slip::nalgebra::DMatrix;
use stick_slip::orbit::{self, AttractorKind, BifurcationKind, Period, sensitivities};
use stick_slip::structure::State;
use stick_slip::{Contact, Coulomb, Drive, Element, Error, EventKind, Segment, Stop, Structure};

use crate::common::orbit::monodromy;
use crate::common::{element_keys as keys, larger};

fn numbers(state: &State) -> Vec<f64> {
    [&state.displacements[..], &state.velocities].concat()
}

/// The derivative of a motion by its start, by central differences of fourth order; `None` if a
/// motion beside has other events.
fn by_differences(structure: &Structure, start: &State, duration: f64) -> Option<DMatrix<f64>> {
    const WIDTH: f64 = 1e-4;
    let n = start.displacements.len();
    let events = keys(&structure.simulate(start.clone(), duration).unwrap());
    let mut found = DMatrix::zeros(2 * n, 2 * n);
    for j in 0..2 * n {
        let at = |change: f64| {
            let mut beside = start.clone();
            match j.checked_sub(n) {
                None => beside.displacements[j] += change,
                Some(j) => beside.velocities[j] += change,
            }
            let motion = structure.simulate(beside, duration).unwrap();
            (keys(&motion) == events).then(|| numbers(&motion.last()))
        };
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|part| at(part * WIDTH));
        let (a, b, c, d) = (a?, b?, c?, d?);
        for i in 0..2 * n {
            found[(i, j)] = (a[i] - 8.0 * b[i] + 8.0 * c[i] - d[i]) / (12.0 * WIDTH);
        }
    }
    Some(found)
}

fn stop(made: Result<Stop, Error>, adhesive: bool, damping: f64) -> Stop {
    let made = made.and_then(|stop| stop.with_contact_stiffness(40.0, damping));
    if adhesive {
        made.unwrap().adhesive()
    } else {
        made.unwrap()
    }
}

/// Two masses: a stop of mass 0, one between the masses, perhaps friction under mass 1, which the
/// second stop sets free, or a joint between them.
fn masses(adhesive: bool, damping: f64, contact: usize) -> Structure {
    let even = Coulomb::new(0.5, 0.5).unwrap();
    let uneven = Coulomb::new(0.6, 0.4).unwrap();
    let structure = Structure::new(&[1.0, 1.5])
        .and_then(|s| s.with_ground_spring(0, 1.0)?.with_ground_damper(0, 0.05))
        .and_then(|s| {
            s.with_ground_spring(1, 1.3)?
                .with_force(0, Drive::sine(1.5, 1.1)?)
        })
        .and_then(|s| s.with_stop(stop(Stop::below(0, -0.4, 0.0), adhesive, damping)))
        .and_then(|s| s.with_stop(stop(Stop::between(0, 1, 0.3, 0.0), adhesive, damping)));
    let structure = match contact {
        0 => structure,
        1 => structure.and_then(|s| s.with_contact(Contact::new(1, even, 1.2)?)),
        2 => structure.and_then(|s| s.with_contact(Contact::new(1, uneven, 1.2)?)),
        _ => {
            // The ground and a joint to a third mass hold mass 1 together.
            let joint = Contact::along(&[(1, 1.0), (0, 0.25)], uneven, 2.0);
            structure.and_then(|s| s.with_contact(joint?))
        }
    };
    structure.unwrap()
}

/// The touch of a damped stop, the end of an adhesive one, and contacts that they release.
#[test]
fn saltation_at_stops_agrees_with_differences() {
    let (mut compared, mut released, mut worst) = (0, 0, 0.0_f64);
    for contact in 0..4 {
        for adhesive in [false, true] {
            for damping in [0.0, 1.5] {
                let structure = masses(adhesive, damping, contact);
                let starts = [(0.1, 4.3), (0.2, 5.9), (-0.1, 3.1), (-0.3, 7.1), (0.0, 2.2)];
                for (q, duration) in starts {
                    // Mass 1 slides first, so that motions beside have the same events.
                    let start = State::new(&[q, 0.03], &[0.3, 0.2]);
                    let motion = structure.simulate(start.clone(), duration).unwrap();
                    let Some(expected) = by_differences(&structure, &start, duration) else {
                        continue;
                    };
                    let (_, found) = monodromy(&structure, &start, duration).unwrap();
                    let size = expected.amax().max(1.0);
                    let apart = (&found - &expected).amax() / size;
                    worst = larger(worst, apart);
                    assert!(
                        apart < 1e-5,
                        "{contact} {adhesive} {damping} {q}: {apart:e}\n{found}{expected}{:?}",
                        keys(&motion)
                    );
                    let events = motion.events();
                    let is_release = |kind| matches!(kind, EventKind::Release(_));
                    let caused = events
                        .windows(2)
                        .filter(|pair| pair[0].time == pair[1].time && is_release(pair[1].kind));
                    released += caused.count();
                    compared += 1;
                }
            }
        }
    }
    println!("{compared} compared, {released} released by a stop, worst {worst:e}");
    assert!(compared >= 24 && released >= 3, "{compared} {released}");
}

/// The rebound of a free mass by stiffness, damping, gap and velocity: e = exp(−2ζ acos ζ/√(1−ζ²)),
/// after the contact time 2 acos ζ/ω_d.
#[test]
fn sensitivities_of_a_rebound_are_those_of_its_closed_form() {
    let parameters = [400.0, 12.0, 0.5, 2.0];
    let family = |p: &[f64]| {
        let above = Stop::above(0, p[2], 0.0)?.with_contact_stiffness(p[0], p[1])?;
        let mass = Structure::new(&[1.0])?.with_stop(above)?;
        Ok((mass, State::new(&[0.0], &[p[3]])))
    };
    // The time at which it opens, and the velocity then.
    let rebound = |p: &[f64]| {
        let zeta = 0.5 * p[1] / p[0].sqrt();
        let root = (1.0 - zeta * zeta).sqrt();
        let lasts = 2.0 * zeta.acos() / (p[0].sqrt() * root);
        let part = (-2.0 * zeta * zeta.acos() / root).exp();
        [p[2] / p[3] + lasts, -p[3] * part]
    };
    let found = sensitivities(family, &parameters, 1.0).unwrap();
    let [close, open] = &found.events()[..] else {
        panic!()
    };
    assert_eq!(
        [(close.element, close.kind), (open.element, open.kind)],
        [EventKind::Close, EventKind::Open].map(|kind| (Element::Stop(0), kind))
    );
    let end = found.at(1.0).unwrap();
    for j in 0..parameters.len() {
        let h = 1e-3 * parameters[j];
        let at = |part: f64| {
            let mut beside = parameters;
            beside[j] += part * h;
            rebound(&beside)
        };
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(at);
        let slope = |k: usize| (a[k] - 8.0 * b[k] + 8.0 * c[k] - d[k]) / (12.0 * h);
        let [time, velocity] = [slope(0), slope(1)];
        assert!((open.by_parameters[j] - time).abs() < 1e-9, "{j}");
        assert!((end[(1, j)] - velocity).abs() < 1e-9, "{j}");
    }
}

/// A mass on a spring, shaken; a stop above its amplitude over most of the range of frequencies.
fn shaken(frequency: f64) -> Result<Structure, Error> {
    behind(frequency, 1.0)
}

/// The same with a gap.
fn behind(frequency: f64, gap: f64) -> Result<Structure, Error> {
    let above = Stop::above(0, gap, 0.0)?.with_contact_stiffness(20.0, 0.6)?;
    Structure::new(&[1.0])?
        .with_ground_spring(0, 1.0)?
        .with_ground_damper(0, 0.2)?
        .with_force(0, Drive::sine(0.4, frequency)?)?
        .with_stop(above)
}

/// The branch touches the stop where the linear amplitude is the gap: F²= (1 − Ω²)² + (0.2 Ω)².
#[test]
fn a_touch_on_a_branch_is_a_grazing() {
    let start = State::at_rest(1);
    let first = orbit::settle(&shaken(0.5).unwrap(), &start, 200.0, Period::Driven(1)).unwrap();
    assert!(first.events().is_empty());
    let branch = orbit::follow(shaken, 0.5, &first, 0.4..0.9).unwrap();
    let grazing: Vec<_> = branch
        .bifurcations
        .iter()
        .filter(|found| found.kind == BifurcationKind::Grazing)
        .collect();
    let [grazing] = &grazing[..] else {
        panic!("{:?}", branch.bifurcations)
    };
    // x = Ω²: (1 − x)² + 0.04 x = 0.16
    let x = 0.98 - (0.98_f64.powi(2) - 0.84).sqrt();
    assert!(
        (grazing.parameter - x.sqrt()).abs() < 1e-9,
        "{}",
        grazing.parameter
    );
    // Over the gap it could be followed, but this is not covered.
    let mut error = orbit::locus(behind, grazing, 1.0, [0.4..0.9, 0.5..1.5]).unwrap_err();
    while let Error::At { source, .. } = error {
        error = *source;
    }
    assert_eq!(error, Error::NotSmooth);
    let last = branch.points.last().unwrap();
    let both = [
        (Element::Stop(0), EventKind::Close),
        (Element::Stop(0), EventKind::Open),
    ];
    let found: Vec<_> = last
        .orbit
        .events()
        .iter()
        .map(|e| (e.element, e.kind))
        .collect();
    assert_eq!(found, both);
    assert!(last.orbit.is_stable());
    // Its multipliers are those of the motion's derivative.
    let system = shaken(last.parameter).unwrap();
    let period = TAU / last.parameter;
    let expected = by_differences(&system, &last.orbit.state(), period).unwrap();
    let product = last
        .orbit
        .multipliers()
        .iter()
        .product::<stick_slip::num_complex::Complex<f64>>();
    assert!(
        (product.re - expected.determinant()).abs() < 1e-6,
        "{product}"
    );
    let energy = last.orbit.energy();
    assert!(energy.defect().abs() < 1e-12 && energy.stop_loss[0] > 1e-4);
}

#[test]
fn attractors_with_stops() {
    let attractor = orbit::classify(&shaken(0.9).unwrap(), &State::at_rest(1)).unwrap();
    assert_eq!(attractor.kind(), AttractorKind::PureSlip);
    let orbit = attractor.orbit().unwrap();
    assert_eq!(orbit.events().len(), 2);
    let steps = orbit.trajectory().steps().to_vec();
    let deepest = steps.iter().map(|step| step.end_state().displacements[0]);
    assert!(deepest.fold(0.0, f64::max) > 1.0);
}
