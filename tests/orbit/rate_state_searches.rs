//! Searches under rate-and-state friction: attractors, Hopf points, curves of them, and derivatives
//! by the coefficients, against closed forms and identities.

use stick_slip::bifurcation::hopf_locus;
use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::orbit::{
    AttractorKind, BranchEnd, Orbit, Period, begin, classify, follow, orbit_sensitivities,
    section_through, sensitivities, settle, shoot, sweep,
};
use stick_slip::structure::State;
use stick_slip::{Contact, Drive, Error, RateState, Structure};

use crate::common::simple::runge_kutta;

/// A fault by the square metre.
#[derive(Clone, Copy)]
struct Fault {
    /// f₀, a, b, D_c, V₀.
    law: [f64; 5],
    load: f64,
    stiffness: f64,
    mass: f64,
    /// The damping by radiated waves.
    radiation: f64,
    plate: f64,
}

const FAULT: Fault = Fault {
    law: [0.6, 0.01, 0.015, 0.008, 1e-6],
    load: 5e7,
    stiffness: 1.5625e7,
    mass: 3.90625e6,
    radiation: 4.6e6,
    plate: 1e-9,
};

impl Fault {
    fn aging(&self) -> Result<RateState, Error> {
        let [f0, a, b, d_c, v0] = self.law;
        RateState::aging(f0, a, b, d_c, v0)
    }

    fn structure(&self) -> Result<Structure, Error> {
        Structure::new(&[self.mass])?
            .with_ground_spring(0, self.stiffness)?
            .with_ground_damper(0, self.radiation)?
            .with_force(0, self.radiation * self.plate)?
            .with_contact(Contact::new(0, self.aging()?, self.load)?.on_belt(self.plate))
    }

    fn critical(&self) -> f64 {
        let law = self.aging().unwrap();
        let [load, plate] = [self.load, self.plate];
        let critical = law.critical_stiffness(load, plate, self.mass, self.radiation);
        critical.unwrap()
    }

    fn frequency(&self) -> f64 {
        let law = self.aging().unwrap();
        law.hopf_frequency(self.load, self.plate, self.radiation)
            .unwrap()
    }

    /// Steady sliding, with the state off by a part of e.
    fn disturbed(&self, by: f64) -> State {
        let law = self.aging().unwrap();
        let held = self.load * law.steady(self.plate) / self.stiffness;
        let phi = law.memory_at(self.plate) + by;
        State::new(&[held], &[0.0]).with_memory(&[phi])
    }
}

#[test]
fn attractors_are_quakes_or_steady_sliding() {
    let fault = FAULT.structure().unwrap();
    let quakes = classify(&fault, &FAULT.disturbed(0.2)).unwrap();
    assert_eq!(quakes.kind(), AttractorKind::PureSlip);
    let period = quakes.orbit().unwrap().period();
    let passages = section_through(&fault, &FAULT.disturbed(0.2), 0, 1e-10);
    let rises = passages.map(Result::unwrap).filter(|passage| passage.rises);
    // One multiplier is 0.04.
    let times: Vec<f64> = rises.skip(12).take(2).map(|passage| passage.time).collect();
    assert!(
        ((times[1] - times[0]) / period - 1.0).abs() < 1e-12,
        "{times:?} {period}"
    );
    let stiff = Fault {
        stiffness: 1.3 * FAULT.critical(),
        ..FAULT
    };
    let creeps = classify(&stiff.structure().unwrap(), &stiff.disturbed(0.2)).unwrap();
    assert_eq!(creeps.kind(), AttractorKind::SteadySliding);
}

/// The rate at which the speed settles is up to 1e30 times the frequency.
#[test]
fn eigenvalues_are_those_of_the_characteristic_equation() {
    for decade in -18..=-4 {
        let fault = Fault {
            plate: 10_f64.powi(decade),
            ..FAULT
        };
        for part in [0.9, 1.0, 1.1] {
            let stiffness = part * fault.critical();
            let fault = Fault { stiffness, ..fault };
            let found = fault.structure().unwrap().steady_sliding().unwrap();
            let [_, a, b, d_c, _] = fault.law;
            let rate = fault.plate / d_c;
            let direct = fault.radiation + fault.load * a / fault.plate;
            let weakening = fault.load * (b - a) / d_c;
            // m s³ + (mλ + η + Na/V) s² + (ηλ + k − N(b − a)/D_c) s + kλ.
            let terms = [
                fault.mass,
                fault.mass * rate + direct,
                fault.radiation * rate + stiffness - weakening,
                stiffness * rate,
            ];
            for s in &found.eigenvalues {
                let value = terms.iter().fold((s * 0.0, 0.0), |(sum, size), &term| {
                    (sum * s + term, size * s.norm() + term.abs())
                });
                // The third coefficient is a difference.
                assert!(value.0.norm() < 1e-13 * value.1, "{decade}, {part}: {s}");
            }
            let oscillating = found.eigenvalues.iter().filter(|s| s.im > 0.0);
            let [slow] = oscillating.collect::<Vec<_>>()[..] else {
                panic!("{:?}", found.eigenvalues);
            };
            if part == 1.0 {
                assert!(slow.re.abs() < 1e-13 * slow.im, "{decade}: {slow}");
                assert!((slow.im / fault.frequency() - 1.0).abs() < 1e-13, "{slow}");
            } else {
                assert_eq!(slow.re > 0.0, part < 1.0, "{decade}, {part}: {slow}");
                assert_eq!(found.is_stable(), part > 1.0);
            }
        }
    }
}

/// The Hopf points of a fault in the plane of speed and stiffness, over twelve decades of the
/// speed.
#[test]
fn curves_of_hopf_points_are_the_critical_stiffness_over_decades() {
    let at = |decade: f64| Fault {
        plate: 10_f64.powf(decade),
        ..FAULT
    };
    let family = |decade: f64, part: f64| {
        let fault = at(decade);
        let stiffness = part * FAULT.critical();
        Fault { stiffness, ..fault }.structure()
    };
    let [curve] = &hopf_locus(family, [-15.0..-3.0, 0.3..2.0]).unwrap()[..] else {
        panic!("one curve");
    };
    let decades = curve.points.iter().map(|point| point.parameters[0]);
    let [low, high] = [f64::min, f64::max].map(|f| decades.clone().reduce(f).unwrap());
    // Radiation stabilises fast sliding.
    assert!(low == -15.0 && high > -4.0, "{low} {high}");
    for point in &curve.points {
        let [decade, part] = point.parameters;
        let expected = at(decade).critical() / FAULT.critical();
        assert!((part / expected - 1.0).abs() < 1e-11, "{decade}: {part}");
        let frequency = point.frequency / at(decade).frequency();
        assert!((frequency - 1.0).abs() < 1e-11, "{decade}: {frequency}");
    }
}

/// Over nine decades of the plate's velocity, and so of the period.
#[test]
fn motions_are_born_at_the_critical_stiffness_at_any_speed() {
    for decade in -12..=-4 {
        let fault = Fault {
            plate: 10_f64.powi(decade),
            ..FAULT
        };
        let (critical, frequency) = (fault.critical(), fault.frequency());
        let family = |stiffness: f64| Fault { stiffness, ..fault }.structure();
        let born = begin(family, 1.01 * critical).unwrap();
        let part = born.parameter / critical;
        // Radiation makes the point supercritical.
        assert!(
            (0.9..1.0).contains(&part) && born.orbit.is_stable(),
            "{decade}: {part}"
        );
        let turns = born.orbit.period() * frequency / std::f64::consts::TAU;
        assert!((turns - 1.0).abs() < 0.1, "{decade}: {turns}");
    }
}

/// The cycle of the fault, from where it becomes slow after a quake.
fn cycle() -> Orbit<State> {
    let fault = FAULT.structure().unwrap();
    let slower = section_through(&fault, &FAULT.disturbed(0.5), 0, 1e-12)
        .map(Result::unwrap)
        .filter(|passage| !passage.rises)
        .nth(4);
    let (state, guess) = (slower.unwrap().state, Period::Free(5.8e8));
    shoot(&fault, &state, guess).unwrap()
}

#[test]
fn a_transient_settles_on_the_cycle() {
    let period = cycle().period();
    let fault = FAULT.structure().unwrap();
    let start = FAULT.disturbed(0.5);
    let settled = settle(&fault, &start, 12.3 * period, Period::Free(period)).unwrap();
    let apart = settled.period() / period - 1.0;
    assert!(apart.abs() < 1e-12, "{apart:e}");
}

/// Quakes below the critical stiffness, creep above it: radiation makes the Hopf point
/// supercritical, without hysteresis.
#[test]
fn sweeps_change_at_the_critical_stiffness() {
    let parts = [0.5, 0.8, 1.1, 1.4];
    let critical = FAULT.critical();
    let family = |part: f64| {
        let stiffness = part * critical;
        Fault { stiffness, ..FAULT }.structure()
    };
    let sweep = sweep(family, &parts, &FAULT.disturbed(0.2)).unwrap();
    for points in [&sweep.up, &sweep.down] {
        for point in points {
            let expected = if point.parameter < 1.0 {
                AttractorKind::PureSlip
            } else {
                AttractorKind::SteadySliding
            };
            assert_eq!(point.kind(), Some(expected), "{}", point.parameter);
        }
    }
}

/// The cycle shrinks as the load falls, to the load at which the stiffness is critical.
#[test]
fn a_cycle_ends_at_the_critical_load() {
    let family = |load: f64| Fault { load, ..FAULT }.structure();
    let [mut low, mut high] = [0.0, FAULT.load];
    loop {
        let load = 0.5 * (low + high);
        if load <= low || load >= high {
            break;
        }
        let is_stable = Fault { load, ..FAULT }.critical() < FAULT.stiffness;
        *(if is_stable { &mut low } else { &mut high }) = load;
    }
    let branch = follow(family, FAULT.load, &cycle(), 0.9 * low..1.01 * FAULT.load).unwrap();
    let hopf = branch.ends.iter().find_map(|end| match end {
        BranchEnd::Hopf { parameter } => Some(*parameter),
        _ => None,
    });
    let Some(found) = hopf else {
        panic!("{:?}", branch.ends);
    };
    assert!((found / low - 1.0).abs() < 1e-11, "{found} {low}");
}

/// The recurrence time has the derivatives that its units leave it, and those of differences.
#[test]
fn recurrence_times_have_derivatives() {
    let orbit = cycle();
    let of = |p: &[f64]| Fault {
        law: [p[0], p[1], p[2], p[3], p[4]],
        load: p[5],
        stiffness: p[6],
        mass: p[7],
        radiation: p[8],
        plate: p[9],
    };
    let [f0, a, b, d_c, v0] = FAULT.law;
    let Fault {
        load,
        stiffness,
        mass,
        radiation,
        plate,
        ..
    } = FAULT;
    let values = [f0, a, b, d_c, v0, load, stiffness, mass, radiation, plate];
    let found = orbit_sensitivities(|p: &[f64]| of(p).structure(), &values, &orbit).unwrap();
    // p ∂T/∂p, in units of T.
    let parts: Vec<f64> = std::iter::zip(&found.period, values)
        .map(|(slope, value)| slope * value / orbit.period())
        .collect();
    let [
        by_f0,
        by_a,
        by_b,
        by_d_c,
        by_v0,
        by_load,
        by_k,
        by_m,
        by_eta,
        by_plate,
    ] = parts[..]
    else {
        unreachable!("ten parameters");
    };
    let identities = [
        // All forces in another unit, all lengths, and all times.
        by_load + by_k + by_m + by_eta,
        by_d_c + by_v0 + by_plate - by_k - by_m - by_eta,
        by_eta + 2.0 * by_m - by_v0 - by_plate - 1.0,
        // Where friction is a logarithm, f₀ moves the spring only, and V₀ is arbitrary.
        by_f0,
        by_v0,
    ];
    // States of a quake change a billion times faster than the fault creeps.
    for (number, off) in identities.into_iter().enumerate() {
        assert!(off.abs() < 1e-6, "identity {number}: {off:e} of {parts:?}");
    }
    let period = |values: [f64; 10]| {
        let system = of(&values).structure().unwrap();
        shoot(&system, &orbit.state(), Period::Free(orbit.period()))
            .unwrap()
            .period()
    };
    for (place, found) in [(1, by_a), (2, by_b)] {
        let part = 1e-5;
        let [less, more] = [1.0 - part, 1.0 + part].map(|factor| {
            let mut values = values;
            values[place] *= factor;
            period(values)
        });
        let expected = (more - less) / (2.0 * part * orbit.period());
        assert!(
            (found / expected - 1.0).abs() < 1e-6,
            "{place}: {found} {expected}"
        );
    }
}

/// Spring force over load at a time of a velocity step from 1 to 10 µm/s at 1
/// s: without inertia the balance of forces is explicit, V = V₀ exp((kq/N − f₀ − bφ)/a).
fn stepped(p: &[f64], time: f64) -> f64 {
    const STEPS: u32 = 4000;
    let plate = |t: f64| if t < 1.0 { 1e-6 } else { 1e-5 };
    let rates = |t: f64, [friction, phi]: [f64; 2]| {
        let speed = 1e-6 * ((friction - 0.6 - p[1] * phi) / p[0]).exp();
        let phi_rate = (1e-6 * f64::exp(-phi) - speed) / p[2];
        [1e3 * (plate(t) - speed), phi_rate]
    };
    // Each step within one of the two speeds.
    let h = (time - 1.0) / f64::from(STEPS);
    let steps = 0..STEPS;
    steps.fold([0.6, 0.0], |x, _| runge_kutta(2.0, x, h, rates))[0]
}

/// By the coefficients that a laboratory fits, beside differences of another method.
#[test]
fn velocity_steps_have_the_derivatives_of_differences() {
    let load = 1e4;
    let family = |p: &[f64]| -> Result<(Structure, State), Error> {
        let law = RateState::aging(0.6, p[0], p[1], p[2], 1e-6)?;
        let plate = Drive::profile(&[(0.0, 1e-6), (1.0, 1e-6), (1.0, 1e-5), (9.0, 1e-5)])?;
        let system = Structure::new(&[1e-8])?
            .with_ground_spring(0, 1e3 * load)?
            .with_contact(Contact::new(0, law, load)?.on_belt(plate))?;
        let start = State::new(&[0.6e-3], &[0.0]).with_memory(&[0.0]);
        Ok((system, start.with_sliding(0, -1e-6)))
    };
    let values = [0.01, 0.015, 1e-5];
    let found = sensitivities(family, &values, 6.0).unwrap();
    for time in [1.3, 1.8, 2.5, 4.0, 6.0] {
        let slopes = found.at(time).unwrap();
        for j in 0..values.len() {
            let part = 1e-4;
            let at = |factor: f64| {
                let mut values = values;
                values[j] *= factor;
                stepped(&values, time)
            };
            let difference = |part: f64| (at(1.0 + part) - at(1.0 - part)) / (2.0 * part);
            let expected = (4.0 * difference(part) - difference(2.0 * part)) / 3.0;
            let slope = 1e3 * slopes[(0, j)] * values[j];
            assert!(
                (slope - expected).abs() < 1e-9,
                "{time}, {j}: {slope} {expected}"
            );
        }
    }
}

/// The rate at which the speed of a slider settles falls by decades within the step that begins at
/// a reversal.
#[test]
fn a_slider_that_reverses_has_the_multipliers_of_differences() {
    let law = RateState::aging(0.3, 0.0719, 0.1259, 0.0107, 0.3078).unwrap();
    let system = Structure::new(&[1.0])
        .and_then(|s| s.with_ground_spring(0, 1.0)?.with_ground_damper(0, 0.1))
        .and_then(|s| s.with_force(0, Drive::harmonic(1.2431, 0.3530, 0.0)?))
        .and_then(|s| s.with_contact(Contact::new(0, law, 0.6)?))
        .unwrap();
    let start = State::new(&[0.2], &[0.0]).with_memory(&[0.5]);
    let orbit = settle(&system, &start, 100.0, Period::Driven(1)).unwrap();
    let numbers =
        |state: &State| vec![state.displacements[0], state.velocities[0], state.memory[0]];
    let motion = system
        .simulate(orbit.state().clone(), orbit.period())
        .unwrap();
    for (begin, end) in std::iter::zip(numbers(&orbit.state()), numbers(&motion.last())) {
        assert!(
            (begin - end).abs() < 1e-11 * (1.0 + begin.abs()),
            "{begin} {end}"
        );
    }
    let after = |by: [f64; 3]| {
        let start = orbit.state();
        let [q, v, phi] = by;
        let start = State::new(&[start.displacements[0] + q], &[start.velocities[0] + v])
            .with_memory(&[start.memory[0] + phi]);
        DVector::from_vec(numbers(
            &system.simulate(start, orbit.period()).unwrap().last(),
        ))
    };
    let columns = [[1e-5, 0.0, 0.0], [0.0, 1e-6, 0.0], [0.0, 0.0, 1e-5]].map(|by: [f64; 3]| {
        let apart = |part: f64| after(by.map(|x| part * x)) - after(by.map(|x| -part * x));
        (apart(1.0) * 8.0 - apart(2.0)) / (12.0 * by.iter().sum::<f64>())
    });
    let derivative = DMatrix::from_columns(&columns);
    let mut expected: Vec<_> = derivative.complex_eigenvalues().iter().copied().collect();
    expected.sort_by(|a, b| b.norm().total_cmp(&a.norm()));
    for (found, expected) in std::iter::zip(orbit.multipliers(), expected) {
        assert!((found - expected).norm() < 1e-7, "{found} {expected}");
    }
}
