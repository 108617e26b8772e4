//! A mass on a belt in SI units: the same motions and cycles as those of the dimensionless system,
//! each number converted.

use std::ops::Range;

use approx::{assert_abs_diff_eq, assert_relative_eq};
use stick_slip::bifurcation::Criticality;
use stick_slip::{
    Attractor, Ended, Error, Exponential, FrictionLaw, Integrator, LimitCycle, Physical,
    PhysicalMassOnBelt, Scaling, Search, Segment, State, Step, Stribeck, Structure, Tabulated,
    bifurcation, limit_cycle, structure,
};

use crate::common::masses::PAD;
use crate::common::{friction_law, refused};

fn law() -> Stribeck {
    Stribeck::new(0.4, 0.25, 0.1, 1).unwrap()
}

/// A range of velocities in m/s in the units of a scaling.
fn dimensionless(scaling: &Scaling, range: Range<f64>) -> Range<f64> {
    let unit = scaling.angular_frequency() * scaling.length();
    range.start / unit..range.end / unit
}

fn brake() -> PhysicalMassOnBelt<Stribeck> {
    PhysicalMassOnBelt::new(PAD, law()).unwrap()
}

#[test]
fn motions_fulfil_the_equation_in_newtons() {
    let motion = brake().simulate((1e-3, 0.0), 2.0).unwrap();
    assert_eq!(motion.duration(), 2.0);
    assert!(motion.state_at(2.0).is_some());
    let (dt, mut slipped) = (1e-5, 0);
    for (time, state, mode) in motion.sample_every(0.0137).unwrap().skip(1) {
        let at = |time: f64| motion.state_at(time).unwrap();
        let around = [at(time - dt), at(time + dt)];
        let same = motion.mode_at(time - dt) == motion.mode_at(time + dt);
        if mode == stick_slip::Mode::Stick || !same {
            continue;
        }
        let acceleration = (around[1].velocity - around[0].velocity) / (2.0 * dt);
        let relative = state.velocity - PAD.belt_velocity;
        let friction = PAD.normal_force * FrictionLaw::coefficient(&law(), relative);
        let sum = PAD.mass * acceleration
            + PAD.damping * state.velocity
            + PAD.stiffness * state.displacement
            + friction;
        assert!(sum.abs() < 1e-5, "{sum} N are missing at {time} s");
        slipped += 1;
    }
    assert!(slipped > 50);
}

enum Unit {
    Time,
    Length,
    Velocity,
    Acceleration,
    Energy,
}

/// The numbers of a cycle that have a unit.
fn measures(cycle: &LimitCycle) -> Vec<(f64, Unit)> {
    let energy = cycle.energy();
    let harmonics = cycle.harmonics(5).into_iter();
    let harmonics = harmonics.map(|c| (c.norm(), Unit::Length));
    let others = [
        (cycle.period(), Unit::Time),
        (cycle.stick_duration(), Unit::Time),
        (cycle.amplitude(), Unit::Length),
        (cycle.mean_displacement(), Unit::Length),
        (cycle.min_velocity(), Unit::Velocity),
        (cycle.max_sliding_speed(), Unit::Velocity),
        (cycle.rms_velocity(), Unit::Velocity),
        (cycle.rms_acceleration(), Unit::Acceleration),
        (cycle.peak_acceleration(), Unit::Acceleration),
        (energy.drive_work, Unit::Energy),
        (energy.damper_loss, Unit::Energy),
        (energy.friction_loss, Unit::Energy),
    ];
    others.into_iter().chain(harmonics).collect()
}

/// On both sides of the belt's velocity, in stick, and on the belt where it cannot stick.
#[test]
fn forces_and_limits_are_those_of_newton() {
    let brake = brake();
    assert_eq!(brake.law(), &law());
    let [low, high] = brake.stick_limits();
    let release = brake.release_state().unwrap();
    assert_eq!(high, release.displacement);
    assert_relative_eq!(high - low, 2.0 * 20.0 * 0.4 / 5000.0);
    for velocity in [-0.3, 0.0, 0.049, 0.05, 0.051, 0.4] {
        for displacement in [-0.01, 0.0, 1e-3, 0.01] {
            let state = State::new(displacement, velocity);
            let force = brake.friction_force(state);
            let spring = PAD.stiffness * displacement + PAD.damping * velocity;
            let newton = (force - spring) / PAD.mass;
            assert_abs_diff_eq!(brake.acceleration(state), newton, epsilon = 1e-13);
            let relative = velocity - PAD.belt_velocity;
            let sticks = relative == 0.0 && (low..high).contains(&displacement);
            let expected = match relative {
                0.0 if sticks => spring,
                0.0 => PAD.normal_force * law().kinetic(0.0) * displacement.signum(),
                _ => -PAD.normal_force * law().coefficient(relative),
            };
            assert_relative_eq!(force, expected, max_relative = 1e-14);
        }
    }
}

#[test]
fn cycles_and_events_are_those_of_the_dimensionless_system() {
    let brake = brake();
    let scaling = *brake.scaling();
    assert_eq!(scaling, Scaling::new(PAD).unwrap());
    let system = brake.dimensionless();
    let (own, bare) = (brake.cycles().unwrap(), limit_cycle::find(system).unwrap());
    assert_eq!(own.len(), bare.len());
    for (si, plain) in own.iter().zip(&bare) {
        assert_eq!(si.kind(), plain.kind());
        assert_eq!(si.multiplier(), plain.multiplier());
        let pairs = measures(si).into_iter().zip(measures(plain));
        for ((number, _), (expected, unit)) in pairs {
            let unit = match unit {
                Unit::Time => scaling.seconds(1.0),
                Unit::Length => scaling.metres(1.0),
                Unit::Velocity => scaling.metres_per_second(1.0),
                Unit::Acceleration => scaling.angular_frequency().powi(2) * scaling.length(),
                Unit::Energy => scaling.newtons(scaling.metres(1.0)),
            };
            assert_relative_eq!(number, expected * unit, max_relative = 1e-13);
        }
        for (a, b) in si
            .trajectory()
            .events()
            .iter()
            .zip(plain.trajectory().events())
        {
            assert_eq!(a.kind, b.kind);
            assert_abs_diff_eq!(a.time, scaling.seconds(b.time), epsilon = 1e-15);
            assert_relative_eq!(
                a.state.displacement,
                scaling.metres(b.state.displacement),
                max_relative = 1e-14
            );
        }
    }
    let cycle = brake.stick_slip().unwrap().unwrap();
    assert_eq!(Some(&cycle), own.stable().next());
    // In stick the mass has the belt's velocity.
    let stuck = cycle.trajectory().state_at(cycle.period() - 1e-4).unwrap();
    assert_relative_eq!(stuck.velocity, PAD.belt_velocity, max_relative = 1e-15);

    let release = brake.release_state().unwrap();
    assert_relative_eq!(release.displacement, (20.0 * 0.4 - 4.0 * 0.05) / 5000.0);
    let steady = brake.equilibrium().unwrap();
    assert_relative_eq!(
        5000.0 * steady.displacement,
        20.0 * (0.25 + 0.15 * (-0.5_f64).exp())
    );
    // λ² + λ h/M + K/M = 0
    let lambda = steady.eigenvalues[0];
    let slope = -20.0 * 0.15 / 0.1 * (-0.5_f64).exp();
    let residual = lambda * lambda * 2.0 + lambda * (4.0 + slope) + 5000.0;
    assert!(residual.norm() < 1e-9, "{residual}");
    // ẍ = −(K/M) x − (h/M) ẋ
    assert_relative_eq!(steady.jacobian[(1, 0)], -2500.0);
    assert_relative_eq!(
        steady.jacobian[(1, 1)],
        -(4.0 + slope) / 2.0,
        max_relative = 1e-14
    );
}

#[test]
fn velocities_and_diagrams_are_in_metres_per_second() {
    let brake = brake();
    let scaling = brake.scaling();
    for search in [
        bifurcation::hopf_velocities,
        bifurcation::grazing_velocities,
    ] {
        let found = brake.velocities(search, 0.01..1.0).unwrap();
        let bare = search(brake.dimensionless(), dimensionless(scaling, 0.01..1.0));
        let bare = bare.unwrap();
        assert!(!bare.is_empty() && found.len() == bare.len());
        for (found, bare) in found.iter().zip(bare) {
            assert_relative_eq!(*found, scaling.metres_per_second(bare));
        }
    }
    // μ̂'''(V) = −(μ_s − μ_c) exp(−V/v_s)/v_s³
    assert_eq!(brake.criticality(-0.3), Criticality::Subcritical);
    let points: Vec<_> = brake.diagram([0.05, 0.1, f64::NAN]).collect();
    #[cfg(feature = "rayon")]
    for (shared, point) in brake
        .par_diagram(&[0.05, 0.1, f64::NAN])
        .iter()
        .zip(&points)
    {
        assert_eq!(format!("{shared:?}"), format!("{point:?}"));
    }
    let [Ok(first), Ok(second), Err(_)] = &points[..] else {
        panic!("{points:?}")
    };
    assert_eq!((first.belt_velocity, second.belt_velocity), (0.05, 0.1));
    let cycle = brake.stick_slip().unwrap().unwrap();
    assert_relative_eq!(
        first.cycles[0].period(),
        cycle.period(),
        max_relative = 1e-13
    );
}

#[test]
fn what_silences_the_brake_is_in_si_units() {
    let brake = brake();
    let (scaling, system) = (brake.scaling(), brake.dimensionless());
    let damping = bifurcation::silencing_damping(system).unwrap();
    assert_relative_eq!(
        brake.silencing_damping().unwrap(),
        2.0 * damping * (PAD.stiffness * PAD.mass).sqrt(),
        max_relative = 1e-14
    );
    // γ² = 1 stands for the force that it has.
    let load = bifurcation::silencing_load(system).unwrap();
    let force = brake.silencing_load().unwrap();
    assert_relative_eq!(force, load * PAD.normal_force, max_relative = 1e-14);

    let ranges = brake.vibration_ranges(0.01..1.0).unwrap();
    let bare = bifurcation::vibration_ranges(system, dimensionless(scaling, 0.01..1.0));
    for (si, plain) in ranges.iter().zip(bare.unwrap()) {
        assert_eq!(si.attractors, plain.attractors);
        assert_relative_eq!(si.velocities.end, 0.2 * plain.velocities.end);
    }
    assert!(ranges.iter().any(|range| range.vibrates()));
    // Beyond the largest border nothing vibrates.
    assert!(!ranges.last().unwrap().vibrates());
}

#[test]
fn errors_are_in_si_units() {
    // A table whose breakpoint lies at 0.1 m/s and jumps nowhere; a bad start and a bad duration.
    let law = Tabulated::new([(0.0, 0.4), (0.1, 0.3), (0.3, 0.25)]).unwrap();
    let brake = PhysicalMassOnBelt::new(PAD, law).unwrap();
    let bad = brake.simulate((0.0, 0.0), -2.0).unwrap_err();
    let Error::InvalidDuration { value, .. } = bad else {
        panic!("{bad}")
    };
    assert_relative_eq!(value, -2.0);
    let few = Integrator::new().with_max_steps(5).unwrap();
    let error = brake.simulate_with(few, (0.0, 0.0), 10.0).unwrap_err();
    let Error::TooManySteps { reached, .. } = error else {
        panic!("{error}")
    };
    let motion = brake.simulate((0.0, 0.0), reached.time).unwrap();
    let there: State = motion.last();
    assert_relative_eq!(
        there.displacement,
        reached.state.displacements[0],
        max_relative = 1e-12
    );
    assert_relative_eq!(there.velocity, reached.state.velocities[0], epsilon = 1e-13);

    for wrong in [
        Physical { mass: 0.0, ..PAD },
        Physical {
            normal_force: f64::NAN,
            ..PAD
        },
    ] {
        refused!(PhysicalMassOnBelt::new(wrong, law_of(0.4)) => Error::InvalidParameter { .. });
    }
}

friction_law! {
    /// Friction until the pad slides faster than 1 m/s, where it is not defined.
    Ends: 0.4,
    |s| (s * -10.0).exp() * 0.15 + if s.value() > 1.0 { f64::NAN } else { 0.25 }
}

#[test]
fn motions_end_where_they_shall_in_si_units() {
    let brake = brake();
    let whole = brake.simulate((0.0, 0.0), 2.0).unwrap();
    let until = |integrator: Integrator, stop: &mut dyn FnMut(&Step) -> Option<f64>| {
        let motion = brake.simulate_until(integrator, (0.0, 0.0), 2.0, stop);
        motion.unwrap()
    };
    // After n events, the last one among them.
    for n in [1, 2, 5, 8] {
        let mut left = n;
        let motion = until(Integrator::new(), &mut |step| {
            left -= step.events().len();
            (left == 0).then(|| step.end_time())
        });
        assert_eq!(
            (motion.ended(), motion.events()),
            (&Ended::Stopped, &whole.events()[..n])
        );
        assert_relative_eq!(
            motion.duration(),
            whole.events()[n - 1].time,
            max_relative = 1e-15
        );
    }
    // At a condition, in metres and metres per second, in slip and in stick.
    let conditions: [fn(&State) -> f64; 3] = [
        |state| state.displacement - 1.5e-3,
        |state| state.velocity + 0.02,
        |state| state.displacement - 1e-3 - 1e-2 * state.velocity,
    ];
    for condition in conditions {
        let motion = until(Integrator::new(), &mut |step| step.first_zero(condition));
        assert_eq!(motion.ended(), &Ended::Stopped);
        assert!(
            condition(&motion.last()).abs() < 1e-16,
            "{}",
            condition(&motion.last())
        );
        let there = whole.state_at(motion.duration()).unwrap();
        assert_relative_eq!(
            there.displacement,
            motion.last().displacement,
            epsilon = 1e-17
        );
    }
    // At a limit of steps, with the motion up to there and an error in seconds.
    let few = Integrator::new().with_max_steps(30).unwrap();
    let motion = until(few, &mut |_| None);
    let Ended::Error(Error::TooManySteps { limit: 30, reached }) = motion.ended() else {
        panic!("{motion:?}")
    };
    assert_relative_eq!(reached.time, motion.duration(), max_relative = 1e-15);
    assert_relative_eq!(
        reached.state.displacements[0],
        motion.last().displacement,
        max_relative = 1e-14
    );
    assert_eq!(motion.steps(), &whole.steps()[..30]);
    // Nowhere: as without a condition.
    assert_eq!(until(Integrator::new(), &mut |_| None), whole);
}

/// Coefficients of time to the 26th power have ω0²⁶ in them.
#[test]
fn frequencies_are_those_of_which_powers_are_numbers() {
    let of = |mass: f64| {
        let pad = Physical {
            mass,
            damping: PAD.damping * (mass / PAD.mass).sqrt(),
            belt_velocity: PAD.belt_velocity * (PAD.mass / mass).sqrt(),
            ..PAD
        };
        PhysicalMassOnBelt::new(pad, law_of(0.4))
    };
    for mass in [1e-50, 1e-22, 1e29, 1e50] {
        let found = of(mass);
        let Err(Error::InvalidParameter { name, value, .. }) = found else {
            panic!("{mass}: {found:?}")
        };
        assert_eq!((name, value), ("stiffness", PAD.stiffness), "{mass}");
    }
    for mass in [1e-15, 1.0, 1e20] {
        let brake = of(mass).unwrap();
        let seconds = brake.scaling().seconds(30.0);
        let start = (1e-3, 0.0);
        let motion = brake.simulate(start, seconds).unwrap();
        let same = (start.0 / brake.scaling().length(), 0.0);
        let same = brake.dimensionless().simulate(same, 30.0).unwrap();
        for part in [0.013, 0.4, 1.0] {
            let here = motion.state_at(part * seconds).unwrap().displacement;
            let there = same.state_at(part * 30.0).unwrap().displacement;
            let there = brake.scaling().metres(there);
            assert_relative_eq!(here, there, max_relative = 1e-12);
        }
    }
}

/// The numbers that a user gave come back to the bit, also those that overflow on the way.
#[test]
fn errors_hold_what_was_given() {
    let brake = brake();
    for start in [
        (f64::NAN, 0.1),
        (0.1, f64::INFINITY),
        (1e308, 0.3),
        (0.3, -1e308),
    ] {
        let Err(Error::InvalidState {
            displacement,
            velocity,
        }) = brake.simulate(start, 1.0)
        else {
            panic!("{start:?}")
        };
        let bits = |(a, b): (f64, f64)| (a.to_bits(), b.to_bits());
        assert_eq!(bits((displacement, velocity)), bits(start));
    }
    for seconds in [f64::NAN, f64::INFINITY, -0.3, 1e308] {
        let Err(Error::InvalidDuration { value, .. }) = brake.simulate((0.0, 0.0), seconds) else {
            panic!("{seconds}")
        };
        assert_eq!(value.to_bits(), seconds.to_bits());
    }
    let searches: [&dyn Fn(Range<f64>) -> Error; 3] = [
        &|range| {
            let found = brake.velocities(bifurcation::hopf_velocities, range);
            found.unwrap_err()
        },
        &|range| {
            let found = brake.velocities(bifurcation::fold_velocities, range);
            found.unwrap_err()
        },
        &|range| brake.vibration_ranges(range).unwrap_err(),
    ];
    let bad = [
        (0.3..0.1, "range.end", 0.1),
        (0.3..0.3, "range.end", 0.3),
        (0.3..f64::INFINITY, "range.end", f64::INFINITY),
        (f64::NAN..0.3, "range.start", f64::NAN),
        (f64::NEG_INFINITY..0.3, "range.start", f64::NEG_INFINITY),
    ];
    for search in searches {
        for (range, end, given) in bad.clone() {
            let error = search(range);
            let Error::InvalidParameter { name, value, .. } = error else {
                panic!("{error}")
            };
            assert_eq!((name, value.to_bits()), (end, given.to_bits()));
            let text = error.to_string();
            assert!(
                text.starts_with("PhysicalMassOnBelt (SI units): range."),
                "{text}"
            );
        }
    }
    for velocity in [f64::NAN, f64::NEG_INFINITY, 1e308] {
        let error = brake.diagram([velocity]).next().unwrap().unwrap_err();
        let Error::InvalidParameter { name, value, .. } = error else {
            panic!("{error}")
        };
        assert_eq!(
            (name, value.to_bits()),
            ("belt_velocity", velocity.to_bits())
        );
    }
}

/// The parameter at which a search failed or was stopped is in SI units, and so is what lies
/// inside.
#[test]
fn errors_of_searches_are_in_si_units() {
    let fast = Physical {
        belt_velocity: 0.7,
        ..PAD
    };
    let brake = PhysicalMassOnBelt::new(fast, Ends).unwrap();
    let beyond = |source: &Error| match source {
        Error::NonFiniteFriction { speed, reached, .. } => {
            assert!((1.0..1.5).contains(speed), "{speed} m/s");
            reached.clone()
        }
        other => panic!("{other}"),
    };
    // The law fails within the motion, where the belt is fast enough.
    let error = brake.cycles().unwrap_err();
    let reached = beyond(&error).unwrap();
    assert!(
        reached.time > 1e-3 && reached.time < 1.0,
        "{} s",
        reached.time
    );
    assert!(reached.state.displacements[0].abs() < 0.1);
    let simulated = brake.simulate((0.02, -0.5), 1.0).unwrap_err();
    let reached = beyond(&simulated).unwrap();
    assert_eq!(reached.time, 0.0);
    assert_relative_eq!(reached.state.displacements[0], 0.02);
    assert_relative_eq!(reached.state.velocities[0], -0.5);

    let at = |error: Error| match error {
        Error::At {
            parameter,
            value,
            source,
        } => {
            beyond(&source);
            (parameter, value)
        }
        other => panic!("{other}"),
    };
    let searched = brake.velocities(bifurcation::grazing_velocities, 0.3..0.9);
    let (parameter, velocity) = at(searched.unwrap_err());
    assert!(parameter == "belt_velocity" && (0.3..0.9).contains(&velocity));
    let (parameter, velocity) = at(brake.vibration_ranges(0.3..0.9).unwrap_err());
    assert!(parameter == "belt_velocity" && (0.3..0.9).contains(&velocity));
    let failed = brake.diagram([0.7]).next().unwrap().unwrap_err();
    assert_eq!(at(failed), ("belt_velocity", 0.7));
    // Dampings are tried from where steady sliding changes its stability, loads from
    // (1 + β)|v_b|/μ_s.
    let slope = -10.0 * 0.15 * (-7.0_f64).exp();
    let (parameter, damping) = at(brake.silencing_damping().unwrap_err());
    assert_eq!(parameter, "damping");
    assert_relative_eq!(damping, -PAD.normal_force * slope, max_relative = 1e-7);
    let (parameter, force) = at(brake.silencing_load().unwrap_err());
    assert_eq!(parameter, "normal_force");
    assert_relative_eq!(force, 100.0 * 0.7 * 1.02 / 0.4, max_relative = 1e-14);

    // A search with a bound, of a parameter that is called as its user likes.
    let bounded = |steps: usize, name: &'static str| {
        let error = self::brake().velocities(
            |system, range| {
                let search = bifurcation::along_velocities(system, range).named(name);
                search
                    .with_search(Search::new().with_max_steps(steps)?)
                    .grazing()
            },
            -0.5..0.5,
        );
        match error.unwrap_err() {
            Error::Stopped {
                parameter,
                value,
                found,
                ..
            } => {
                assert_eq!(parameter, name);
                (value, found)
            }
            other => panic!("{other}"),
        }
    };
    let whole = self::brake().velocities(bifurcation::grazing_velocities, 0.0..0.5);
    let grazing = whole.unwrap()[0];
    for name in ["belt_velocity", "V"] {
        let (value, found) = bounded(10, name);
        assert!((-0.5..0.0).contains(&value) && found.is_empty(), "{value}");
        let (value, found) = bounded(1500, name);
        assert!(value > -grazing && value < 0.5, "{value}");
        assert_relative_eq!(found[0], -grazing, max_relative = 1e-12);
    }
}

fn law_of(coefficient: f64) -> Stribeck {
    Stribeck::new(coefficient, 0.25, 0.1, 1).unwrap()
}

/// What one number stands for does not change what the system does: the same brake with time in
/// milliseconds, or turning.
#[test]
fn other_consistent_units_give_the_same_motion() {
    // N/mm, kg → t, mm, N, mm/s
    let in_mm = Physical {
        mass: 2e-3,
        stiffness: 5.0,
        damping: 4e-3,
        normal_force: 20.0,
        belt_velocity: 50.0,
    };
    let small = PhysicalMassOnBelt::new(in_mm, Stribeck::new(0.4, 0.25, 100.0, 1).unwrap());
    let small = small.unwrap();
    let (a, b) = (
        brake().stick_slip().unwrap().unwrap(),
        small.stick_slip().unwrap().unwrap(),
    );
    assert_relative_eq!(a.period(), b.period(), max_relative = 1e-13);
    assert_relative_eq!(1e3 * a.amplitude(), b.amplitude(), max_relative = 1e-13);
    // N mm
    assert_relative_eq!(
        1e3 * a.energy().friction_loss,
        b.energy().friction_loss,
        max_relative = 1e-12
    );
}

/// Exact symmetry of units: basins in SI units are those of the dimensionless system, start by
/// start, and their cycles are those that `cycles` returns.
#[test]
fn basins_are_those_of_the_dimensionless_system() {
    let pad = Physical {
        mass: 2.0,
        stiffness: 5000.0,
        damping: 2.0,
        normal_force: 20.0,
        belt_velocity: 0.2,
    };
    let brake = PhysicalMassOnBelt::new(pad, Exponential::new(0.6, 0.3, 0.08).unwrap()).unwrap();
    let basins = brake.basins().unwrap();
    assert_eq!(basins.cycles(), &brake.cycles().unwrap());
    let plain = limit_cycle::basins(brake.dimensionless()).unwrap();
    let steady = brake.equilibrium().unwrap().displacement;
    let mut reached = [0; 2];
    for i in 0..40 {
        let start = State::new(
            steady + 1e-4 * f64::from(i % 8),
            0.004 * f64::from(i) - 0.08,
        );
        let expected = plain.attractor(State::new(
            start.displacement / brake.scaling().length(),
            dimensionless(brake.scaling(), start.velocity..1.0).start,
        ));
        let found = basins.attractor(start).unwrap();
        assert_eq!(found, brake.attractor(start).unwrap());
        match (found, expected.unwrap()) {
            (Attractor::Equilibrium, Attractor::Equilibrium) => reached[0] += 1,
            (Attractor::Cycle(found), Attractor::Cycle(expected)) => {
                reached[1] += 1;
                let period = brake.scaling().seconds(expected.period());
                assert_relative_eq!(found.period(), period, max_relative = 1e-15);
            }
            (found, expected) => panic!("{found} is not {expected}"),
        }
    }
    assert!(reached[0] > 3 && reached[1] > 3, "{reached:?}");
    let bad = basins.attractor((0.001, f64::NAN));
    assert!(matches!(bad, Err(Error::InvalidState { displacement, .. }) if displacement == 0.001));
}

/// The structure in SI units moves as the mass on its belt does, and rubs away as much energy as
/// the limit cycle does per period.
#[test]
fn the_structure_of_a_brake_is_in_si_units() {
    let brake = brake();
    let structure = Structure::try_from(&brake).unwrap();
    let cycle = brake.stick_slip().unwrap().unwrap();
    let State {
        displacement,
        velocity,
    } = cycle.state();
    let start = structure::State::new(&[displacement], &[velocity]);
    let motion = structure.simulate(start, cycle.period()).unwrap();
    let end = motion.last();
    assert_relative_eq!(end.displacements[0], displacement, max_relative = 1e-12);
    let loss = structure.energy_budget(&motion).unwrap().friction_loss[0];
    assert_relative_eq!(loss, cycle.energy().friction_loss, max_relative = 1e-12);
}

/// A light block that is pressed on its belt.
fn under_load(normal_force: f64) -> PhysicalMassOnBelt<Exponential> {
    let physical = Physical {
        mass: 1.0,
        stiffness: 1e4,
        damping: 1.0,
        normal_force,
        belt_velocity: 0.1,
    };
    PhysicalMassOnBelt::new(physical, Exponential::new(0.4, 0.25, 0.1).unwrap()).unwrap()
}

/// A load of 10¹² or 10¹⁶ newtons: the cycle is one of relaxation, whose period grows like the
/// load.
#[test]
fn the_largest_loads_have_their_cycle() {
    let period_per_newton = [1e12, 1e16].map(|normal_force| {
        let block = under_load(normal_force);
        // It is carried along from rest on the belt.
        let end = block.simulate((0.0, 0.1), 1.0).unwrap().last();
        assert!((end.displacement - 0.1).abs() < 1e-15, "{end:?}");
        block.stick_slip().unwrap().unwrap().period() / normal_force
    });
    let [less, more] = period_per_newton;
    // What does not grow with the load is 1e-10 of the smaller period.
    assert!((less / more - 1.0).abs() < 2e-10, "{less} {more}");
}

/// Vibration ends where steady sliding becomes stable, at a damping of 3/e s/m times the load.
/// Under 10¹² newtons the mass takes steps of 10⁻⁹ s after it has crept for a year.
#[test]
fn the_largest_loads_are_silenced() {
    for normal_force in [1e4, 1e8, 1e10, 1e12] {
        let silent = under_load(normal_force).silencing_damping().unwrap();
        let stable = 2.0 * 0.15 / 0.1 * (-1.0_f64).exp() * normal_force;
        // Motions beside the border differ by the root of their rounding errors, 1.5e-8.
        let beside = silent / stable - 1.0;
        assert!(
            (-1e-15..1e-7).contains(&beside),
            "{normal_force} {beside:e}"
        );
    }
}
