//! Steady sliding, held against small motions; and the damping that leaves no large ones.

use std::f64::consts::TAU;

use proptest::prelude::*;
use stick_slip::analysis::{PureSlip, design, exponential, polynomial};
use stick_slip::nalgebra::Complex;
use stick_slip::{Exponential, FrictionLaw, MassOnBelt, Polynomial, State};

use super::{Verdict, any_law, check, decades, or_zero, sign, system};

/// The distance u − ū and the velocity some time after a start, if nothing happens in between.
fn moved<L: FrictionLaw>(of: &MassOnBelt<L>, [z, v]: [f64; 2], time: f64) -> Option<[f64; 2]> {
    let rest = of.equilibrium()?.displacement;
    let motion = of.simulate(State::new(rest + z, v), time).unwrap();
    let end = motion.last();
    let uneventful = motion.events().is_empty();
    uneventful.then_some([end.displacement - rest, end.velocity])
}

/// How close a sliding speed lies to 0 or to a breakpoint.
fn margin<L: FrictionLaw>(of: &MassOnBelt<L>) -> f64 {
    let speed = of.belt_velocity().abs();
    let kinks = of.law().breakpoints().map(|b| (b - speed).abs());
    kinks.fold(speed, f64::min)
}

/// The map of small motions over some time, by central differences, has the trace and the
/// determinant that follow from the eigenvalues. Its error is of second order in the difference.
#[test]
fn eigenvalues() {
    let sizes = (or_zero(decades(1e-4, 10.0)), decades(1e-3, 30.0));
    let cases = (
        any_law(),
        decades(1e-2, 10.0),
        sign(),
        sizes,
        0.1..10.0,
        1..5_i32,
    );
    check(
        cases,
        |(law, speed, sign, (damping, load), time, k), bounds| {
            let system = system(law, sign * speed, damping, load);
            let equilibrium = system.equilibrium().unwrap();
            let [first, other] = equilibrium.eigenvalues;
            // No more than e³ times larger, or smaller.
            let time = f64::min(time, 6.0 / (first + other).re.abs());
            let grown = |rate: Complex<f64>| (rate * time).exp().re;
            let growth = 1.0 + grown(first.re.into()) + grown(other.re.into());
            let size = 2.0_f64.powi(-7) * margin(&system) / growth;
            let scale = speed + equilibrium.displacement.abs();
            let error = |square: f64| {
                let h = size * square.sqrt();
                let column = |z: f64, v: f64| {
                    let [to, from] = [h, -h].map(|h| moved(&system, [z * h, v * h], time));
                    to.zip(from)
                        .map(|([z, v], [x, w])| [(z - x) / (2.0 * h), (v - w) / (2.0 * h)])
                };
                let ([a, c], [b, d]) = column(1.0, 0.0).zip(column(0.0, 1.0))?;
                let trace = a + d - grown(first) - grown(other);
                let determinant = a * d - b * c - grown(first + other);
                let noise = f64::EPSILON * scale / h * growth;
                Some([(trace, noise), (determinant, noise * growth)])
            };
            let squares = [1.0, 0.25, 0.0625, 0.0625 * 0.25_f64.powi(k)];
            let errors: Option<Vec<_>> = squares.into_iter().map(error).collect();
            prop_assert!(errors.is_some(), "the motion is not small");
            let errors = errors.unwrap_or_default();
            for (i, name) in ["trace", "determinant"].into_iter().enumerate() {
                let errors: Vec<_> = errors.iter().map(|errors| errors[i]).collect();
                bounds.order(name, 1.0, |x| x, &squares, &errors)?;
            }
            Ok(())
        },
    );
}

/// ln of the factor by which the amplitude of small motions changes in a turn. The mean of a motion
/// and its mirror image, in the norm in which the linear motion is a spiral.
fn growth<L: FrictionLaw>(of: &MassOnBelt<L>, amplitude: f64) -> Option<f64> {
    let equilibrium = of.equilibrium()?;
    let h1 = -equilibrium.jacobian[(1, 1)];
    let turn = TAU / equilibrium.eigenvalues[0].im;
    let of_one = |amplitude: f64| {
        let [z, v] = moved(of, [amplitude, 0.0], turn)?;
        let square = (z * z + h1 * z * v + v * v) / (amplitude * amplitude);
        Some(0.25 * square.ln())
    };
    Some(of_one(amplitude)? + of_one(-amplitude)?)
}

fn grows<L: FrictionLaw>(of: &MassOnBelt<L>, amplitude: f64, expected: bool) -> Verdict {
    let rest = of.equilibrium();
    // Nodes do not turn.
    let turning = rest.filter(|rest| rest.eigenvalues[0].im > 0.3);
    prop_assume!(turning.is_some());
    let growth = growth(of, amplitude);
    // Displacements are rounded in parts of ū.
    let size = turning.map_or(0.0, |rest| rest.displacement.abs());
    let noise = 16.0 * f64::EPSILON * (1.0 + size / amplitude);
    prop_assume!(growth.is_none_or(|growth| growth.abs() > noise));
    prop_assert!(
        growth.is_some_and(|growth| (growth > 0.0) == expected),
        "{growth:?}"
    );
    Ok(())
}

#[test]
fn stabilizing_damping() {
    let cases = (
        any_law(),
        decades(1e-2, 10.0),
        sign(),
        decades(1e-3, 1.0),
        decades(1e-5, 0.3),
    );
    check(cases, |(law, speed, sign, load, beside), _| {
        let system = system(law, sign * speed, 0.0, load);
        let damping = design::stabilizing_damping(&system).unwrap();
        // So small that the cubic term of the law does not count beside the difference.
        let amplitude = 1e-3 * beside.sqrt() * margin(&system);
        prop_assume!(damping + beside < 0.9);
        grows(
            &system.clone().with_damping(damping + beside).unwrap(),
            amplitude,
            false,
        )?;
        // A law that rises needs none.
        if damping > beside {
            grows(
                &system.with_damping(damping - beside).unwrap(),
                amplitude,
                true,
            )?;
        }
        Ok(())
    });
}

/// v_b1 of the polynomial law, and both Hopf velocities of the exponential one.
#[test]
fn hopf_velocities() {
    let law = (decades(0.01, 10.0), 0.0..0.99, decades(0.01, 10.0));
    let cases = (
        law,
        sign(),
        decades(1e-3, 1.0),
        0.001..0.9,
        decades(1e-5, 0.1),
    );
    check(
        cases,
        |((top, least, width), sign, steepness, part, beside), _| {
            let least = least * top;
            let amplitude = |velocity: f64| 1e-3 * beside.sqrt() * velocity;
            let beyond = |velocity: f64| [1.0 - beside, 1.0 + beside].map(|f| sign * f * velocity);

            let law = Polynomial::new(top, least, width).unwrap();
            let load = steepness * width / (1.5 * (top - least));
            let system = system(law, sign * width, 0.5 * part * steepness, load);
            let onset = PureSlip::new(&system).unwrap().onset_velocity().unwrap();
            prop_assert_eq!(polynomial::quiet_velocity(&system), Some(onset));
            for (velocity, grow) in beyond(onset).into_iter().zip([true, false]) {
                grows(
                    &system.with_belt_velocity(velocity).unwrap(),
                    amplitude(onset),
                    grow,
                )?;
            }

            let law = Exponential::new(top, least, width).unwrap();
            let bare = super::system(law, sign * width, 0.0, load);
            let damping = part * exponential::silencing_damping_everywhere(&bare);
            let system = bare.with_damping(damping).unwrap();
            let [low, high] = exponential::hopf_velocities(&system)
                .unwrap()
                .map(|(velocity, _)| velocity);
            for (hopf, grow) in [(low, [false, true]), (high, [true, false])] {
                for (velocity, grow) in beyond(hopf).into_iter().zip(grow) {
                    grows(
                        &system.with_belt_velocity(velocity).unwrap(),
                        amplitude(hopf),
                        grow,
                    )?;
                }
            }
            Ok(())
        },
    );
}

/// With the damping that silences everywhere every motion loses energy all the time, large ones
/// too; with less there are belt velocities at which small ones grow.
#[test]
fn silencing_damping() {
    fn silenced<L: FrictionLaw>(
        system: MassOnBelt<L>,
        silencing: f64,
        (steepest, beside): (f64, f64),
        [z, v]: [f64; 2],
    ) -> Verdict {
        let quiet = system.with_damping(silencing * (1.0 + beside)).unwrap();
        let rest = quiet.equilibrium().unwrap().displacement;
        let (speed, force) = (quiet.belt_velocity().abs(), quiet.stick_limits()[1]);
        let size = speed + force.abs();
        let motion = quiet
            .simulate(State::new(rest + z * size, v * size), 20.0)
            .unwrap();
        let energy = |u: f64, v: f64| 0.5 * ((u - rest).powi(2) + v * v);
        let mut before = f64::INFINITY;
        for (
            time,
            State {
                displacement,
                velocity,
            },
        ) in motion.sample(200)
        {
            let now = energy(displacement, velocity);
            prop_assert!(
                now <= before + 1e-13 * size * size,
                "{time}: {now} {before}"
            );
            before = now;
        }
        let loud = quiet.with_damping(silencing * (1.0 - beside)).unwrap();
        let loud = loud.with_belt_velocity(steepest).unwrap();
        grows(&loud, 1e-3 * beside.sqrt() * steepest, true)
    }
    let law = (decades(0.01, 10.0), 0.0..0.99, decades(0.01, 10.0));
    let place = [-3.0..3.0, -3.0..3.0];
    let cases = (
        law,
        sign(),
        decades(1e-2, 100.0),
        decades(1e-3, 1.0),
        decades(1e-4, 0.5),
        place,
    );
    check(
        cases,
        |((top, least, width), sign, ratio, load, beside, place), _| {
            let (least, velocity, load) = (least * top, sign * ratio * width, load * width / top);
            let polynomial = system(
                Polynomial::new(top, least, width).unwrap(),
                velocity,
                0.0,
                load,
            );
            let damping = polynomial::silencing_damping_everywhere(&polynomial);
            // Its fall is steepest at rest.
            let steepest = 0.1 * beside.sqrt() * width;
            silenced(polynomial, damping, (steepest, beside), place)?;
            let exponential = system(
                Exponential::new(top, least, width).unwrap(),
                velocity,
                0.0,
                load,
            );
            let damping = exponential::silencing_damping_everywhere(&exponential);
            let steepest = width * 0.5_f64.sqrt();
            silenced(exponential, damping, (steepest, beside), place)
        },
    );
}
