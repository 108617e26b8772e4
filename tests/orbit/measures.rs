//! Measures of periodic motions: those of a belt against the complete search, energies against
//! reference data and against each other, a linear motion in closed form.

use std::f64::consts::TAU;

use stick_slip::orbit::{Orbit, Period, settle, shoot};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Drive, EnergyBudget, Error, Exponential, ForceElement, FrictionLaw,
    Integrator, MassOnBelt, PolynomialSpring, Scalar, Structure, TimeFunction, limit_cycle,
};

use crate::common::{Worst, assert_met, list, number, paper, text};
use crate::reading::{cases, numbers, structure};
use crate::references::{all, period, remembers, start};

/// Every number of a cycle by the same name.
fn compare<L: FrictionLaw>(system: &MassOnBelt<L>) -> usize {
    let cycles = limit_cycle::find(system).unwrap();
    for cycle in &cycles {
        let orbit = shoot(system, &cycle.state(), Period::Free(cycle.period())).unwrap();
        let mut worst = Worst::default();
        let (energy, of_cycle) = (orbit.energy(), cycle.energy());
        for (what, found, expected) in [
            ("frequency", orbit.frequency(), cycle.frequency()),
            ("amplitude", orbit.amplitude(0), cycle.amplitude()),
            (
                "mean",
                orbit.mean_displacement(0),
                cycle.mean_displacement(),
            ),
            ("rms velocity", orbit.rms_velocity(0), cycle.rms_velocity()),
            (
                "rms acceleration",
                orbit.rms_acceleration(0),
                cycle.rms_acceleration(),
            ),
            (
                "peak",
                orbit.peak_acceleration(0),
                cycle.peak_acceleration(),
            ),
            ("stick", orbit.stick_duration(0), cycle.stick_duration()),
            (
                "speed",
                orbit.max_sliding_speed(0),
                cycle.max_sliding_speed(),
            ),
            ("drive work", energy.drive_work[0], of_cycle.drive_work),
            ("belt work", energy.belt_work[0], of_cycle.belt_work),
            ("damper loss", energy.damper_loss, of_cycle.damper_loss),
            (
                "friction loss",
                energy.friction_loss[0],
                of_cycle.friction_loss,
            ),
        ] {
            worst.meet(what, found, expected);
        }
        for (found, expected) in [
            (orbit.harmonics(0, 5), cycle.harmonics(5)),
            (orbit.velocity_harmonics(0, 5), cycle.velocity_harmonics(5)),
            (
                orbit.acceleration_harmonics(0, 5),
                cycle.acceleration_harmonics(5),
            ),
        ] {
            assert_eq!(found.len(), 5);
            for (found, expected) in found.iter().zip(expected) {
                worst.meet("harmonic", found.norm(), expected.norm());
            }
        }
        worst.assert("cycle", 1e-12);
    }
    cycles.len()
}

#[test]
fn measures_of_a_belt_are_those_of_its_cycle() {
    let mut compared = compare(&paper(0.2)) + compare(&paper(0.4071));
    let law = Exponential::new(0.6, 0.3, 0.4).unwrap();
    for (velocity, damping) in [(1.0, 0.01), (-0.5, 0.05), (0.05, 0.3)] {
        let system = MassOnBelt::new(law, velocity).unwrap();
        compared += compare(&system.with_damping(damping).unwrap());
    }
    assert!(compared >= 5, "{compared}");
}

#[test]
fn energies_of_the_reference_orbits_close() {
    let mut compared = 0;
    for case in all() {
        if remembers(&case) {
            continue;
        }
        let id = text(&case["id"]);
        let contacts = list(&case["system"]["contacts"]).len();
        let system = structure(&case["system"], f64::NAN);
        let orbit = shoot(&system, &start(&case, contacts), period(&case)).unwrap();
        let energy = orbit.energy();
        let size = energy.damper_loss.abs()
            + energy.friction_loss.iter().sum::<f64>()
            + energy.force_work.iter().map(|work| work.abs()).sum::<f64>();
        // The motion closes to rounding.
        assert!(
            energy.stored.abs() < 1e-12 * size.max(1.0),
            "{id}: {energy:?}"
        );
        assert!(
            energy.defect().abs() < 1e-13 * size.max(1.0),
            "{id}: {energy:?}"
        );
        for (c, loss) in energy.friction_loss.iter().enumerate() {
            let supplied = energy.drive_work[c] - energy.belt_work[c];
            assert_met(id, supplied, *loss, 1e-12);
        }
        compared += 1;
    }
    assert!(compared > 8, "{compared}");
}

/// Heat of elastic contacts over a periodic motion, known to 25 digits.
#[test]
fn heat_per_period_is_that_of_the_reference() {
    let mut compared = 0;
    for case in cases(include_str!("../data/joint_cycles.json")) {
        let id = text(&case["id"]);
        let system = structure(&case["system"], f64::NAN);
        let at = &case["start"];
        let start = State::new(&numbers(&at["q"]), &numbers(&at["v"]));
        let start = start.with_memory(&numbers(&at["T"]));
        let motion = Integrator::new()
            .with_start_time(number(&at["t"]))
            .and_then(|from| from.simulate(&system, start, number(&case["period"])))
            .unwrap();
        let expected = numbers(&case["dissipated"]);
        let losses = system.energy_budget(&motion).unwrap().friction_loss;
        for (found, expected) in losses.iter().zip(expected) {
            assert_met(id, *found, expected, 1e-12);
            compared += 1;
        }
    }
    assert!(compared > 3, "{compared}");
}

/// m x'' + c x' + k x = F cos ωt, with a contact that never slips on a mass apart.
#[test]
fn a_linear_motion_has_one_harmonic() {
    let (m, c, k, force, omega) = (2.0, 0.3, 5.0, 0.7, 1.3);
    let contact = Contact::new(1, Coulomb::new(0.4, 0.3).unwrap(), 1.0).unwrap();
    let system = Structure::new(&[m, 1.0])
        .and_then(|s| s.with_ground_spring(0, k)?.with_ground_damper(0, c))
        .and_then(|s| s.with_force(0, Drive::harmonic(force, omega, 0.0)?))
        .and_then(|s| s.with_contact(contact.on_belt(0.2)))
        .and_then(|s| s.with_ground_spring(1, 1.0))
        .unwrap();
    // The second mass slides steadily, at 0.3.
    let start = State::new(&[0.1, 0.3], &[0.0, 0.0]);
    let orbit = shoot(&system, &start, Period::Driven(1)).unwrap();
    let amplitude = force / (k - m * omega * omega).hypot(c * omega);
    let rms = amplitude * omega / 2.0_f64.sqrt();
    let loss = 0.5 * c * (omega * amplitude).powi(2) * orbit.period();
    let heat = 0.3 * 0.2 * orbit.period();
    // x = Re(a e^{iωt}), a = F/(k − mω² + icω).
    let phase = -(c * omega).atan2(k - m * omega * omega);
    let harmonics = orbit.harmonics(0, 4);
    for (what, found, expected) in [
        ("amplitude", orbit.amplitude(0), amplitude),
        ("mean", orbit.mean_displacement(0), 0.0),
        ("mean of the other", orbit.mean_displacement(1), 0.3),
        ("rms", orbit.rms_velocity(0), rms),
        (
            "peak",
            orbit.peak_acceleration(0),
            amplitude * omega * omega,
        ),
        ("speed", orbit.max_sliding_speed(0), 0.2),
        ("first", harmonics[0].norm(), amplitude),
        ("phase", harmonics[0].arg(), phase),
        ("loss", orbit.energy().damper_loss, loss),
        ("work", orbit.energy().force_work[0], loss),
        ("heat", orbit.energy().friction_loss[0], heat),
    ] {
        assert_met(what, found, expected, 1e-14);
    }
    for harmonic in &harmonics[1..] {
        assert!(harmonic.norm() < 1e-15);
    }
}

#[test]
fn what_there_is_not_is_nan() {
    let orbit: Orbit<_> = shoot(&paper(0.2), &(0.1, 0.2).into(), Period::Free(7.0)).unwrap();
    for number in [
        orbit.amplitude(1),
        orbit.mean_displacement(1),
        orbit.rms_velocity(1),
        orbit.rms_acceleration(1),
        orbit.peak_acceleration(1),
        orbit.extremes(1).0,
        orbit.acceleration_extremes(1).1,
        orbit.stick_duration(1),
        orbit.max_sliding_speed(1),
    ] {
        assert!(number.is_nan());
    }
    assert!(orbit.harmonics(1, 3).is_empty() && orbit.harmonics(0, 0).is_empty());
}

/// A factor or a load that is one number in one half of a period and another one in the other half.
struct Square {
    values: [f64; 2],
    period: f64,
    begin: f64,
}

impl TimeFunction for Square {
    fn value<S: Scalar>(&self, time: S, piece: usize) -> S {
        time.constant(self.values[usize::from(piece != 1)])
    }

    fn size(&self) -> f64 {
        self.values[0].max(self.values[1])
    }

    fn timescale(&self, _: usize) -> f64 {
        f64::INFINITY
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        [self.begin, self.begin + 0.5 * self.period].into_iter()
    }

    fn period(&self) -> Option<f64> {
        Some(self.period)
    }
}

/// Work and heat over a period do not depend on where it begins, not even if a factor or a load
/// jumps there.
#[test]
fn jumps_at_the_start_of_a_period_count() {
    const PERIOD: f64 = 5.0;
    const RATE: f64 = TAU / PERIOD;
    let drive = |values, begin| {
        Drive::function(Square {
            values,
            period: PERIOD,
            begin,
        })
    };
    let energy = |which: usize, begin: f64| {
        let force = Drive::harmonic(0.9, RATE, 2.3 - RATE * begin)?.with_constant(0.3)?;
        let system = Structure::new(&[1.0, 1.0])?
            .with_ground_spring(0, 1.0)?
            .with_ground_damper(0, 0.2)?
            .with_ground_spring(1, 1.0)?
            .with_ground_damper(1, 0.2)?
            .with_force(0, force)?;
        let law = Coulomb::new(0.5, 0.3)?;
        let system = match which {
            0 => {
                let element = ForceElement::new(0, PolynomialSpring::new(&[1.0])?)?;
                system.with_element(element.with_factor(drive([0.2, 0.6], begin)?)?)?
            }
            1 => {
                let contact = Contact::new(0, law, drive([1.0, 0.3], begin)?)?;
                system.with_contact(contact.with_normal_spring(&[(1, 1.0)], 2.0)?)?
            }
            _ => {
                // The load jumps up, or down, where the period begins.
                let loads = [[1.0, 0.3], [0.3, 1.0]][which - 2];
                let contact = Contact::new(0, Coulomb::new(0.5, 0.5)?, drive(loads, begin)?)?;
                system.with_contact(contact.with_tangential_stiffness(4.0)?)?
            }
        };
        let orbit = settle(&system, &State::at_rest(2), 300.0, Period::Driven(1))?;
        Ok::<_, Error>(orbit.energy().clone())
    };
    for which in 0..4 {
        let [seam, inside] = [0.0, 0.7].map(|begin| energy(which, begin).unwrap());
        for energy in [&seam, &inside] {
            assert!(energy.stored.abs() < 1e-13, "{which}: {energy:?}");
            assert!(energy.defect().abs() < 1e-13, "{which}: {energy:?}");
        }
        let all = |energy: &EnergyBudget| {
            let alone = [energy.damper_loss, energy.force_work[0]];
            let parts = [
                &energy.friction_loss,
                &energy.normal_work,
                &energy.element_work,
            ];
            alone
                .into_iter()
                .chain(parts.into_iter().flatten().copied())
                .collect::<Vec<f64>>()
        };
        for (found, expected) in std::iter::zip(all(&seam), all(&inside)) {
            assert!(
                (found - expected).abs() < 1e-12,
                "{which}: {found} {expected}"
            );
        }
    }
}
