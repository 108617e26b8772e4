//! Physical units: round trips, independence of the length, and an integration in SI units that
//! knows nothing of the crate's.

use std::ops::Range;

use crate::common::orbit::integrate;
use crate::common::property::for_all;
use crate::common::simple::runge_kutta;
use proptest::prelude::*;
use stick_slip::{
    AnyLaw, Coulomb, Error, FrictionLaw, MassOnBelt, Physical, PhysicalMassOnBelt, Polynomial,
    Rational, Scaled, Scaling, State, Stribeck, Tabulated, Trajectory,
};

use crate::common::refused;

/// A brake pad: 0.5 kg, 20 kN/m (32 Hz), 50 N, 3 cm/s.
const PAD: Physical = Physical {
    mass: 0.5,
    stiffness: 2e4,
    damping: 10.0,
    normal_force: 50.0,
    belt_velocity: 0.03,
};

/// What makes parameters of any size: belt velocity, and exponents of ten of the mass, the
/// stiffness, the damping constant, the normal force, and a length.
const RANGES: [Range<f64>; 6] = [
    -10.0..10.0,
    -3.0..3.0,
    -1.0..9.0,
    -6.0..5.0,
    -3.0..6.0,
    -6.0..2.0,
];

fn parameters([belt_velocity, exponents @ ..]: [f64; 6]) -> (Physical, f64) {
    let [mass, stiffness, damping, normal_force, length] =
        exponents.map(|exponent| 10.0_f64.powf(exponent));
    let physical = Physical {
        mass,
        stiffness,
        damping,
        normal_force,
        belt_velocity,
    };
    (physical, length)
}

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 8.0 * f64::EPSILON * a.abs().max(b.abs())
}

#[test]
fn units_there_and_back() {
    let [a, b, c, d, e, f] = RANGES;
    for_all(256, [a, b, c, d, e, f, -1e3..1e3], |[numbers @ .., x]| {
        let (physical, length) = parameters(numbers);
        let scaling = Scaling::new(physical).unwrap();
        for scaling in [scaling, scaling.with_length(length).unwrap()] {
            let (rate, length) = (scaling.angular_frequency(), scaling.length());
            prop_assert!(close(scaling.seconds(rate * x), x));
            prop_assert!(close(scaling.metres(x / length), x));
            prop_assert!(close(scaling.metres_per_second(x / (rate * length)), x));
            prop_assert!(close(scaling.newtons(x / (physical.stiffness * length)), x));
            // A power is a force times a velocity, and an energy divided by a time.
            let energy = scaling.newtons(scaling.metres(x));
            let power = scaling.newtons(1.0) * scaling.metres_per_second(x);
            prop_assert!(close(energy / scaling.seconds(1.0), power));
            prop_assert!(close(
                scaling.hertz(x) * scaling.seconds(std::f64::consts::TAU),
                x
            ));
            prop_assert_eq!(scaling.physical(), physical);
        }
        Ok(())
    });
}

/// The dimensionless parameters say the same as the physical ones, whatever the length.
#[test]
fn parameters_there_and_back() {
    for_all(256, RANGES, |numbers| {
        let (physical, length) = parameters(numbers);
        let scaling = Scaling::new(physical).unwrap();
        prop_assert_eq!(
            scaling
                .system(Coulomb::new(0.4, 0.3).unwrap())
                .unwrap()
                .load(),
            1.0
        );
        let scaling = scaling.with_length(length).unwrap();
        prop_assert_eq!(scaling.length(), length);
        let system = scaling.system(Coulomb::new(0.4, 0.3).unwrap()).unwrap();
        let Physical {
            mass,
            stiffness,
            damping,
            normal_force,
            belt_velocity,
        } = physical;
        let omega = scaling.angular_frequency();
        prop_assert!(close(omega * omega * mass, stiffness));
        prop_assert!(close(
            2.0 * system.damping() * (stiffness * mass).sqrt(),
            damping
        ));
        prop_assert!(close(scaling.newtons(system.load()), normal_force));
        prop_assert!(close(scaling.damping_constant(system.damping()), damping));
        prop_assert!(close(
            scaling.metres_per_second(system.belt_velocity()),
            belt_velocity
        ));
        prop_assert!(close(system.law().velocity_unit(), omega * length));
        // Force of the spring and of the damper at a state.
        let stretched = 0.01 / length;
        prop_assert!(close(scaling.newtons(stretched), stiffness * 0.01));
        let drag = 2.0 * system.damping() * 0.3 / (omega * length);
        prop_assert!(close(scaling.newtons(drag), damping * 0.3));
        Ok(())
    });
}

/// Single numbers: tests/contract/refusals.rs.
/// Displacements and velocities that overflow in the units of the system.
#[test]
fn accelerations_in_si_units_are_numbers_at_any_state() {
    let of = |normal_force: f64, damping: f64| {
        let physical = Physical {
            mass: 1.0,
            stiffness: 1.0,
            damping,
            normal_force,
            belt_velocity: 0.0,
        };
        let law = Stribeck::new(0.4, 0.25, 0.5, 1).unwrap();
        PhysicalMassOnBelt::new(physical, law).unwrap()
    };
    let light = of(1e-200, 1.0);
    // Spring and damper of one size: −X − X'.
    for (displacement, velocity, expected) in [
        (1e200, 1e200, -2e200),
        (1e200, -1e200, 0.0),
        (-1e299, 3e298, 7e298),
        (f64::MAX, f64::MAX, f64::NEG_INFINITY),
        (f64::MAX, -f64::MAX, 0.0),
    ] {
        let found = light.acceleration((displacement, velocity));
        let apart = (found - expected).abs();
        assert!(
            found == expected || apart <= 1e-15 * f64::abs(displacement),
            "{found}"
        );
    }
    // The belt does not feel the unit of length.
    assert_eq!(light.friction_force((1.0, 1e200)), -1e-200 * 0.25);
    let viscous = light.law().with_viscous_coefficient(0.2).unwrap();
    let viscous = PhysicalMassOnBelt::new(light.physical(), viscous).unwrap();
    for velocity in [1e200, -1e200] {
        assert_eq!(
            viscous.friction_force((1.0, velocity)),
            -1e-200 * (0.2 * velocity)
        );
    }
    for normal_force in [1e-300, 1e-200, 1.0, 1e16, 1e200] {
        let system = of(normal_force, 0.1);
        for x in [0.0, 1e-300, 1e10, 1e299, f64::MAX] {
            for v in [0.0, 1e-300, 1e10, 1e299, f64::MAX] {
                for state in [(x, v), (x, -v), (-x, v), (-x, -v)] {
                    let numbers = [system.acceleration(state), system.friction_force(state)];
                    assert!(numbers.iter().all(|x| !x.is_nan()), "{state:?} {numbers:?}");
                }
            }
        }
    }
}

#[test]
fn a_scaling_keeps_its_numbers_normal() {
    let light = Physical {
        normal_force: 1e-310,
        ..PAD
    };
    let damped = Physical {
        damping: 5e-324,
        ..PAD
    };
    for physical in [light, damped] {
        refused!(Scaling::new(physical) => Error::InvalidParameter { name: "length", .. });
    }
}

/// Laws in m/s.
fn laws() -> Vec<AnyLaw> {
    let table = [
        (0.0, 0.4),
        (0.01, 0.36),
        (0.03, 0.3),
        (0.06, 0.27),
        (0.1, 0.28),
    ];
    let viscous = Stribeck::new(0.4, 0.25, 0.05, 1).unwrap();
    vec![
        Polynomial::new(0.4, 0.25, 0.075).unwrap().into(),
        viscous.with_viscous_coefficient(0.2).unwrap().into(),
        Rational::new(0.4, 10.0).unwrap().into(),
        Coulomb::new(0.4, 0.3).unwrap().into(),
        Tabulated::new(table).unwrap().into(),
    ]
}

/// The motion from rest at X = 0 for half a second (16 oscillations).
fn from_rest<'l>(
    scaling: &Scaling,
    law: &'l AnyLaw,
) -> (MassOnBelt<Scaled<&'l AnyLaw>>, Trajectory) {
    let system = scaling.system(law).unwrap();
    let motion = system
        .simulate(State::new(0.0, 0.0), 0.5 * scaling.angular_frequency())
        .unwrap();
    (system, motion)
}

#[test]
fn nothing_physical_depends_on_the_length() {
    let usual = Scaling::new(PAD).unwrap();
    for law in &laws() {
        let (_, motion) = from_rest(&usual, law);
        assert!(motion.events().len() >= 10, "{law:?}");
        for length in [1.0, 1e-3, 0.37e-4] {
            let other = usual.with_length(length).unwrap();
            let (_, same) = from_rest(&other, law);
            assert_eq!(motion.events().len(), same.events().len());
            for (a, b) in std::iter::zip(motion.events(), same.events()) {
                assert_eq!(a.kind, b.kind);
                let (t, t_same) = (usual.seconds(a.time), other.seconds(b.time));
                assert!((t - t_same).abs() < 1e-14, "{law:?}: {t} {t_same}");
                let x = usual.metres(a.state.displacement);
                let x_same = other.metres(b.state.displacement);
                // Of a millimetre.
                assert!((x - x_same).abs() < 1e-16, "{law:?}: {x} {x_same}");
            }
            for ((_, a), (_, b)) in std::iter::zip(motion.sample(50), same.sample(50)) {
                let (v, v_same) = (
                    usual.metres_per_second(a.velocity),
                    other.metres_per_second(b.velocity),
                );
                assert!((v - v_same).abs() < 2e-14, "{law:?}: {v} {v_same}");
            }
        }
    }
}

/// M X'' = −C X' − K X − N μ(X' − V), by the classical Runge-Kutta method with steps of a
/// microsecond.
fn slip_in_si_units(law: &AnyLaw, start: [f64; 2], seconds: f64) -> [f64; 2] {
    let Physical {
        mass,
        stiffness,
        damping,
        normal_force,
        belt_velocity,
    } = PAD;
    let rate = |[x, v]: [f64; 2]| {
        let sliding = v - belt_velocity;
        let friction = normal_force * law.kinetic(sliding.abs()) * sliding.signum();
        [v, -(damping * v + stiffness * x + friction) / mass]
    };
    let steps = (seconds / 1e-6).ceil();
    let h = seconds / steps;
    let mut y = start;
    for _ in 0..steps as usize {
        y = runge_kutta(0.0, y, h, |_, y| rate(y));
    }
    y
}

#[test]
fn motion_agrees_with_an_integration_in_si_units() {
    for length in [2.5e-3, 0.1] {
        let scaling = Scaling::new(PAD).unwrap().with_length(length).unwrap();
        for law in &laws() {
            let system = scaling.system(law).unwrap();
            // Pulled forward by 2 mm and let go: 10 ms of slip.
            let start = State::new(2e-3 / length, 0.0);
            let motion = system
                .simulate(start, 0.01 * scaling.angular_frequency())
                .unwrap();
            assert_eq!(motion.events(), []);
            for part in [0.3, 0.7, 1.0] {
                let time = part * motion.duration();
                let state = motion.state_at(time).unwrap();
                let [x, v] = slip_in_si_units(law, [2e-3, 0.0], scaling.seconds(time));
                let (x_error, v_error) = (
                    scaling.metres(state.displacement) - x,
                    scaling.metres_per_second(state.velocity) - v,
                );
                // Of 2 mm and 0.3 m/s. The curvature of a table jumps, which costs Runge-Kutta its
                // order there.
                assert!(
                    x_error.abs() < 1e-15,
                    "{law:?} at {time}: X off by {x_error:e} m"
                );
                assert!(
                    v_error.abs() < 1e-13,
                    "{law:?} at {time}: X' off by {v_error:e} m/s"
                );
            }
        }
    }
}

/// Work of the spring, the damper and friction is the change of kinetic energy, in joules, over
/// events and all.
#[test]
fn energy_balances_in_joules() {
    let scaling = Scaling::new(PAD).unwrap();
    let Physical {
        mass,
        stiffness,
        damping,
        ..
    } = PAD;
    for law in &laws() {
        let (system, motion) = from_rest(&scaling, law);
        let energy = |state: State| {
            let (x, v) = (
                scaling.metres(state.displacement),
                scaling.metres_per_second(state.velocity),
            );
            0.5 * mass * v * v + 0.5 * stiffness * x * x
        };
        let power = |state: State| {
            let v = scaling.metres_per_second(state.velocity);
            (scaling.newtons(system.friction_force(state)) - damping * v) * v
        };
        let mut work = 0.0;
        for step in motion.steps() {
            work += integrate(step.duration(), |t| power(step.state_at(t)));
        }
        let work = scaling.seconds(work);
        let change = energy(motion.last()) - energy(State::new(0.0, 0.0));
        // Joules; the spring holds 0.01 J at release.
        assert!((work - change).abs() < 1e-14, "{law:?}: {work} {change}");
    }
}
