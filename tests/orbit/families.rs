//! Continuous families of periodic motions: the member found conserves what its start conserves,
//! and the motion says that it is one of a family, and in which directions.

use std::f64::consts::TAU;

use stick_slip::orbit::{AttractorKind, Orbit, Period, classify, settle, shoot};
use stick_slip::structure::State;
use stick_slip::{
    Contact, ContactLaw, Coulomb, Drive, Error, ForceElement, MassOnBelt, Motion, PolynomialSpring,
    Scalar, Slip, Structure,
};

use crate::common::{at_least, exactly, larger, memory_stays, one_mass};

/// Inertias of very different size that rub on each other; nothing else touches them.
const INERTIAS: [f64; 3] = [1.0, 7.0, 0.2];

/// Forces without a mean act on each.
fn free() -> Result<Structure, Error> {
    let law = || Coulomb::new(0.3, 0.2);
    Structure::new(&INERTIAS)?
        .with_spring(0, 1, 2.0)?
        .with_spring(1, 2, 0.5)?
        .with_damper(0, 1, 0.1)?
        .with_damper(1, 2, 0.1)?
        .with_force(0, Drive::harmonic(1.5, 1.1, 0.3)?)?
        .with_force(2, Drive::harmonic(0.5, 1.1, 1.0)?)?
        .with_contact(Contact::between(0, 1, law()?, 1.0)?)?
        .with_contact(Contact::between(1, 2, law()?, 0.3)?)
}

fn momentum(state: &State) -> f64 {
    let terms = std::iter::zip(INERTIAS, &state.velocities);
    terms.map(|(m, v)| m * v).sum()
}

/// The state at the end of one period, from a start perturbed along a direction, minus its start.
fn missed(system: &Structure, orbit: &Orbit<State>, direction: &State, by: f64) -> Vec<f64> {
    let numbers = |state: &State| -> Vec<f64> {
        [&state.displacements[..], &state.velocities, &state.memory].concat()
    };
    let parts = std::iter::zip(numbers(&orbit.state()), numbers(direction));
    let start: Vec<f64> = parts.map(|(x, d)| x + by * d).collect();
    let n = system.len();
    let moved = State::new(&start[..n], &start[n..2 * n]).with_memory(&start[2 * n..]);
    let end = system.simulate(moved, orbit.period()).unwrap().last();
    let pairs = std::iter::zip(numbers(&end), start);
    pairs.map(|(end, start)| end - start).collect()
}

#[test]
fn momentum_is_that_of_the_start() {
    let system = free().unwrap();
    // From states far from any closed motion, after transients too short to settle.
    let starts = [
        [2.0, -0.4, 5.0],
        [-3.0, 1.0, 0.0],
        [0.0, 0.0, 0.0],
        [4.0, 4.0, -9.0],
    ];
    for velocities in starts {
        let start = State::new(&[0.3, -0.2, 0.1], &velocities);
        for transient in [0.0, 11.0, 60.0] {
            let found = settle(&system, &start, transient, Period::Driven(1)).unwrap();
            let apart = momentum(&found.state()) - momentum(&start);
            // The forces have no mean over whole periods. The rounding of displacements up to 200
            // acts on springs of 2 for 60 units of time.
            assert!(apart.abs() < 1e-11, "{velocities:?} {transient}: {apart:e}");
            let [direction] = exactly(found.families());
            // A velocity of the whole; displacements do not follow.
            let [&first] = at_least(&direction.velocities);
            for v in &direction.velocities {
                assert!((v - first).abs() < 1e-10 * first.abs(), "{direction:?}");
            }
            assert_eq!(found.multipliers().len(), 4);
        }
    }
}

/// Friction that depends on the place: the memory is the way slid, z' = r. On the ground z − q is
/// conserved, and each value of it has a motion of its own.
#[derive(Debug, Clone, Copy)]
struct Worn;

impl Worn {
    fn number<S: Scalar>(z: S) -> S {
        ((z - 0.2) * (z - 0.2) + 1.0).recip() * 0.3 + 0.1
    }
}

impl ContactLaw for Worn {
    type Memory<S: Scalar> = [S; 1];
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, [z]: [S; 1]) -> S {
        Self::number(z) * slip.direction
    }
    fn limit<S: Scalar>(&self, _: S, [z]: [S; 1]) -> Option<S> {
        Some(Self::number(z))
    }
    fn rates<S: Scalar>(&self, motion: Motion<S>, _: S, [z]: [S; 1]) -> [S; 1] {
        match motion {
            Motion::Stick => [z.constant(0.0)],
            Motion::Slip(slip) => [slip.velocity()],
        }
    }
    memory_stays!(1);
}

fn worn() -> Result<Structure, Error> {
    let force = Drive::harmonic(0.7, 0.6, 0.0)?;
    one_mass([1.0, 0.1, 1.0], force, Contact::new(0, Worn, 1.0)?)
}

#[test]
fn a_memory_minus_a_displacement_is_that_of_the_start() {
    let system = worn().unwrap();
    let offset = |state: &State| state.memory[0] - state.displacements[0];
    let mut means = Vec::new();
    for (q, z) in [(0.0, 0.0), (0.3, -0.5), (-0.4, 0.8), (0.1, 2.0)] {
        let start = State::new(&[q], &[0.0]).with_memory(&[z]);
        for transient in [0.0, 15.0, 150.0] {
            let Ok(found) = settle(&system, &start, transient, Period::Driven(1)) else {
                // Newton's method may need a transient.
                assert!(transient < 100.0);
                continue;
            };
            let apart = offset(&found.state()) - (z - q);
            assert!(apart.abs() < 1e-14, "{q} {z} {transient}: {apart:e}");
            let [direction] = exactly(found.families());
            assert!(offset(direction).abs() > 0.1, "{direction:?}");
            // Neighbours in this direction are closed to the square of the distance.
            for by in [1e-4, 1e-5] {
                let missed = missed(&system, &found, direction, by);
                let most = missed.iter().map(|x| x.abs()).fold(0.0, larger);
                assert!(most < 30.0 * by * by, "{by:e}: {missed:?}");
            }
            // The multiplier 1 is listed, and the member is stable.
            let [first, second, _] = exactly(found.multipliers());
            assert!((first - 1.0).norm() < 1e-12 && second.norm() < 0.99);
            assert!(found.is_stable(), "{:?}", found.multipliers());
            means.push(found.extremes(0).1);
        }
        // The attractor that `classify` finds is this member, too.
        let attractor = classify(&system, &start).unwrap();
        assert_ne!(attractor.kind(), AttractorKind::Irregular);
        let orbit = attractor.orbit().unwrap();
        assert_eq!(orbit.families().len(), 1);
        assert!((offset(&orbit.state()) - (z - q)).abs() < 1e-13);
    }
    means.sort_by(f64::total_cmp);
    assert!(means[means.len() - 1] - means[0] > 1e-3, "{means:?}");
}

/// A mass without friction beside one that rubs: its drift is that of its start. Without any
/// conserved quantity, or at a limit cycle, there is no family.
#[test]
fn a_frictionless_drift_is_that_of_the_start() {
    let system = |brake: f64| {
        let contact = Contact::new(0, Coulomb::new(0.4, 0.3)?, 1.0)?;
        Structure::new(&[1.0, 0.05])?
            .with_ground_spring(0, 1.0)?
            .with_ground_damper(1, brake)?
            .with_force(0, Drive::harmonic(1.0, 0.8, 0.0)?)?
            .with_force(1, Drive::harmonic(0.3, 0.8, 0.4)?)?
            .with_contact(contact)
    };
    let start = State::new(&[0.5, 0.0], &[0.4, -1.7]);
    let free = system(0.0).unwrap();
    for transient in [0.0, 30.0] {
        let found = settle(&free, &start, transient, Period::Driven(1)).unwrap();
        assert!((found.state().velocities[1] + 1.7).abs() < 1e-13);
        let [direction] = exactly(found.families());
        assert_eq!(direction.velocities[0], 0.0);
        assert!(direction.velocities[1] > 0.0);
    }
    let braked = system(0.1).unwrap();
    let found = shoot(&braked, &start, Period::Driven(1)).unwrap();
    assert!(found.families().is_empty());
}

/// A contact that never slips makes a family with one direction: the position of its slider.
#[test]
fn a_contact_that_never_slips_makes_a_family() {
    let joint = Contact::between(0, 1, Coulomb::new(0.5, 0.5).unwrap(), 10.0).unwrap();
    let joint = joint.with_tangential_stiffness(3.0).unwrap();
    let stuck = Structure::new(&[1.0, 1.0])
        .and_then(|s| s.with_ground_spring(0, 1.0)?.with_ground_spring(1, 2.0))
        .and_then(|s| s.with_ground_damper(0, 0.2)?.with_contact(joint))
        .and_then(|s| s.with_force(1, Drive::harmonic(0.3, 0.7, 0.0)?))
        .unwrap();
    let start = State::at_rest(2).with_memory(&[0.8]);
    let found = settle(&stuck, &start, 200.0, Period::Driven(1)).unwrap();
    assert_eq!(found.unslipped(), [0]);
    let [direction] = exactly(found.families());
    let by = 1e-3;
    let missed = missed(&stuck, &found, direction, by);
    // The motion is linear: neighbours are closed.
    assert!(missed.iter().all(|x| x.abs() < 1e-13), "{missed:?}");
    let slider = |s: &State| s.memory[0] - 3.0 * (s.displacements[0] - s.displacements[1]);
    assert!((slider(&found.state()) - 0.8).abs() < 1e-13);
    assert!(slider(direction).abs() > 0.1);
}

/// A mass on its spring that strikes another spring, without friction or damping, beside a damped
/// one: its energy is conserved, and the period changes along the family.
#[test]
fn motions_of_any_energy_are_a_family() {
    let pad = Contact::new(1, Coulomb::new(0.0, 0.0).unwrap(), 1.0).unwrap();
    let pad = pad.with_normal_spring(&[(0, 1.0)], 4.0).unwrap();
    let bounces = Structure::new(&[1.0, 1.0])
        .and_then(|s| s.with_ground_spring(0, 1.0)?.with_ground_spring(1, 1.0))
        .and_then(|s| s.with_ground_damper(1, 0.5)?.with_contact(pad.on_belt(0.3)))
        .unwrap();
    // q'' = −q − N, N = max(0, 1 + 4q): about −1/5 with the frequency √5, beyond −1/4 with 1.
    let period = |largest: f64| {
        let (amplitude, fast) = (largest + 0.2, 5.0_f64.sqrt());
        let closed = (-0.05 / amplitude).acos() / fast;
        let speed = fast * (amplitude * amplitude - 0.05 * 0.05).sqrt();
        let open = std::f64::consts::PI - 2.0 * (0.25 / speed).atan();
        2.0 * closed + open
    };
    let energy = |s: &State| {
        let (q, v) = (s.displacements[0], s.velocities[0]);
        let load = (1.0 + 4.0 * q).max(0.0);
        0.5 * (v * v + q * q) + load * load / 8.0
    };
    let start = State::new(&[1.0, 0.4], &[0.0, 0.0]);
    let found = settle(&bounces, &start, 150.0, Period::Free(4.3)).unwrap();
    // The damped mass has come to rest; the energy is that of the start.
    let apart = energy(&found.state()) - energy(&start);
    assert!(apart.abs() < 1e-13, "{apart:e}");
    let largest = found.extremes(0).1;
    assert!((found.period() - period(largest)).abs() < 1e-12);
    let [direction] = exactly(found.families());
    // To another energy, while the damped mass stays at rest.
    let moved = |by: f64| {
        let (s, d) = (found.state(), direction);
        let [q, v] = [
            s.displacements[0] + by * d.displacements[0],
            s.velocities[0] + by * d.velocities[0],
        ];
        energy(&State::new(&[q, 0.0], &[v, 0.0]))
    };
    assert!((moved(1e-4) - moved(-1e-4)).abs() > 1e-5);
    assert!(direction.displacements[1].abs() + direction.velocities[1].abs() < 1e-9);
    // The shift along the motion has no multiplier, the energy has the multiplier 1.
    assert_eq!(found.multipliers().len(), 3);
    assert!((found.multipliers()[0] - 1.0).norm() < 1e-9);
    assert!(found.is_stable());
}

/// The energy of a mass on the spring x + x³.
fn hardening(q: f64, v: f64) -> f64 {
    0.5 * (v * v + q * q) + 0.25 * q.powi(4)
}

/// A mass on a hardening spring without damping: each start belongs to a periodic motion, which is
/// found with its energy, however wrong the estimate of the period is.
#[test]
fn the_energy_of_an_undamped_mass_is_that_of_the_start() {
    let spring = PolynomialSpring::new(&[1.0, 0.0, 1.0]).unwrap();
    let system = Structure::new(&[1.0])
        .and_then(|s| s.with_element(ForceElement::new(0, spring)?))
        .unwrap();
    for (q, v) in [(1.0, 0.0), (0.6, -0.9), (0.0, 2.0), (-0.2, 0.1)] {
        let start = State::new(&[q], &[v]);
        // A quarter of the period is twice the time from 0 at which the velocity is 0, by the mean
        // of arithmetic and geometric means: T = 2π/(M √(1 + a²)), modulus² m = a²/(2(1 + a²)).
        let energy = hardening(q, v);
        let square = (1.0 + 4.0 * energy).sqrt() - 1.0;
        let (mut a, mut g) = (1.0, (1.0 - square / (2.0 * (1.0 + square))).sqrt());
        for _ in 0..8 {
            (a, g) = (0.5 * (a + g), (a * g).sqrt());
        }
        let period = TAU / (a * (1.0 + square).sqrt());
        for part in [0.8, 0.97, 1.0, 1.2] {
            let found = shoot(&system, &start, Period::Free(part * period)).unwrap();
            let (q, v) = (found.state().displacements[0], found.state().velocities[0]);
            let apart = hardening(q, v) - energy;
            assert!(apart.abs() < 1e-14 * (1.0 + energy), "{part}: {apart:e}");
            assert!((found.period() - period).abs() < 1e-13 * period);
            assert_eq!(found.families().len(), 1);
        }
    }
}

/// Constant friction on a belt that is never reached: the motion is that of an undamped spring
/// about another place.
#[test]
fn the_amplitude_of_slip_without_damping_is_that_of_the_start() {
    let system = MassOnBelt::new(Coulomb::new(0.4, 0.3).unwrap(), 2.0).unwrap();
    for (q, v) in [(0.5, 0.3), (1.2, -1.0), (0.3, 1.5)] {
        let found = shoot(&system, &stick_slip::State::new(q, v), Period::Free(6.0)).unwrap();
        assert!((found.period() - TAU).abs() < 1e-13);
        let amplitude = (q - 0.3f64).hypot(v);
        let apart = found.amplitude(0) - amplitude;
        assert!(
            apart.abs() < 1e-14 * (1.0 + amplitude),
            "{q} {v}: {apart:e}"
        );
    }
}

/// A damper of friction that has stopped: the mass that it held back goes on for ever, with the
/// energy that is left.
#[test]
fn energy_that_friction_left_is_kept() {
    let spring = PolynomialSpring::new(&[1.0, 0.0, 1.0]).unwrap();
    let coupling = PolynomialSpring::new(&[0.2, 0.0, 0.4]).unwrap();
    let system = Structure::new(&[1.0, 0.5])
        .and_then(|s| s.with_element(ForceElement::new(0, spring)?))
        .and_then(|s| s.with_element(ForceElement::between(0, 1, coupling)?))
        .and_then(|s| s.with_contact(Contact::new(1, Coulomb::new(0.6, 0.4)?, 1.0)?))
        .unwrap();
    let start = State::new(&[2.0, 0.0], &[0.0, 0.5]);
    let transient = 80.0;
    let settled = system.simulate(start.clone(), transient).unwrap().last();
    let energy = |state: &State| {
        let (q, p) = (state.displacements[0], state.displacements[1]);
        hardening(q, state.velocities[0]) + 0.1 * (q - p).powi(2) + 0.1 * (q - p).powi(4)
    };
    for period in [3.0, 4.0] {
        let found = settle(&system, &start, transient, Period::Free(period)).unwrap();
        assert_eq!(found.unslipped(), [0]);
        let apart = energy(&found.state()) - energy(&settled);
        assert!(apart.abs() < 1e-13, "{apart:e}");
        let kept = found.state().displacements[1] - settled.displacements[1];
        assert_eq!(kept, 0.0);
    }
}
