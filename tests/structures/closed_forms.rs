//! Closed formulas against numbers that were derived and checked beforehand, and against each
//! other.

use approx::assert_abs_diff_eq;
use std::f64::consts::{PI, TAU};

use proptest::prop_assert;
use stick_slip::analysis::drill_string::TwoInertias;
use stick_slip::analysis::fast_vibration::{mean_coefficient, onset_velocity};
use stick_slip::analysis::forced::{ForcedOscillator, no_stop_limit};
use stick_slip::analysis::mode_coupling::ModeCoupling;
use stick_slip::{
    Contact, ContactLaw, Coulomb, Direction, Drive, Error, EventKind, FrictionLaw, Mode, Motion,
    Polynomial, Scalar, Slip, Structure, Tabulated, structure,
};

use crate::common::property::for_all;
use crate::common::{memory_stays, number, on_belt, one_mass, text};
use crate::reading::cases;

fn forced(angular_frequency: f64, damping: f64, friction: f64, force: f64) -> ForcedOscillator {
    ForcedOscillator {
        damping,
        angular_frequency,
        kinetic_friction: friction,
        static_friction: friction,
        force,
    }
}

#[test]
fn no_stop_limits() {
    for (omega, limit) in [
        (0.5, 1.0 / 3.0),
        (1.5, 0.646579087296),
        (2.0, 0.596284794000),
    ] {
        assert!(
            (no_stop_limit(omega).unwrap() - limit).abs() < 1e-12,
            "{omega}"
        );
    }
    let reference = cases(include_str!("../data/structure_bifurcations.json"));
    let onset = reference
        .iter()
        .find(|case| text(&case["type"]) == "stop_onset");
    let limit = number(&onset.unwrap()["value"]);
    assert_abs_diff_eq!(no_stop_limit(0.8).unwrap(), limit, epsilon = 1e-15);
    // Through resonance, where formulas divide by 0.
    let near = |offset: f64| no_stop_limit(1.0 + offset).unwrap();
    for offset in [1e-3, 1e-6, 1e-9, 1e-12, f64::EPSILON] {
        assert!(
            (near(offset) - near(0.0)).abs() < 2.0 * offset + 1e-15,
            "{offset}"
        );
        assert!(
            (near(-offset) - near(0.0)).abs() < 2.0 * offset + 1e-15,
            "{offset}"
        );
    }
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, f64::MAX, 1e-160] {
        assert_eq!(no_stop_limit(bad), None);
    }
}

#[test]
fn no_motion_without_stops_beyond_its_conditions() {
    let base = forced(0.8, 0.05, 0.3, 1.0);
    assert!(base.without_stops().is_some());
    // Static friction alone can stop it.
    let sticky = ForcedOscillator {
        static_friction: 2.0,
        ..base
    };
    assert_eq!(sticky.without_stops(), None);
    // Near a third of resonance friction excites the free vibration: the mass turns in between.
    assert!(forced(0.335, 0.0, 0.003, 1.0).without_stops().is_some());
    assert_eq!(forced(0.335, 0.0, 0.007, 1.0).without_stops(), None);
    // Resonance without damping or friction, and numbers out of range.
    assert_eq!(forced(1.0, 0.0, 0.0, 1.0).without_stops(), None);
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        assert_eq!(forced(bad, 0.05, 0.3, 1.0).without_stops(), None);
        assert_eq!(forced(0.8, bad, 0.3, 1.0).without_stops(), None);
        assert_eq!(forced(0.8, 0.05, bad, 1.0).without_stops(), None);
        assert_eq!(forced(0.8, 0.05, 0.3, bad).without_stops(), None);
    }
    assert_eq!(forced(0.8, 1.0, 0.3, 1.0).without_stops(), None);
}

#[test]
fn fast_vibration_on_the_set_of_the_paper() {
    let system = on_belt(Polynomial::new(0.4, 0.25, 0.5).unwrap(), 0.2, 0.05, 1.0);
    for (amplitude, velocity) in [
        (0.1, 0.4352521619),
        (0.2, 0.4176654695),
        (0.3, 0.3865804502),
    ] {
        let found = onset_velocity(&system, amplitude).unwrap();
        assert!((found - velocity).abs() < 1e-10, "{amplitude}");
        // There the mean slope of friction is −2β: averaged by hand over one fast period.
        let n = 64;
        let phases = (0..n).map(|k| 2.0 * PI * f64::from(k) / f64::from(n));
        let slopes = phases.map(|phase| system.law().slope(found + amplitude * phase.cos()));
        let mean = slopes.sum::<f64>() / f64::from(n);
        assert!((mean + 0.1).abs() < 1e-14, "{mean}");
    }
    for bad in [-0.1, f64::NAN, f64::INFINITY] {
        assert_eq!(onset_velocity(&system, bad), None);
    }
    // Coulomb: the mean of the sign over one period, by the times at which it changes.
    let law = Coulomb::new(0.4, 0.3).unwrap();
    for ratio in [-0.9, -0.3, 0.0, 0.5, 1.0] {
        let forward = PI - 2.0 * f64::acos(ratio).min(PI) + PI;
        let mean = 0.3 * (forward - PI) / PI;
        assert!((mean_coefficient(&law, 0.2 * ratio, 0.2) - mean).abs() < 1e-15);
    }
    assert_eq!(mean_coefficient(&law, 0.0, 0.0), 0.0);
}

const HAMBURG: ModeCoupling = ModeCoupling {
    masses: [1.0, 1.0],
    stiffness: [[2.0, 1.0], [1.0, 2.0]],
    normal_stiffness: 4.0 / 3.0,
    damping: [0.0, 0.0],
};

/// A structure for which a model holds.
fn coupled(model: &ModeCoupling, coefficient: f64) -> Structure {
    let contact = Contact::new(0, Coulomb::new(coefficient, coefficient).unwrap(), 100.0)
        .and_then(|contact| contact.with_load_gradient(1, model.normal_stiffness))
        .unwrap()
        .on_belt(1.0);
    let [[k11, k12], [k21, k22]] = model.stiffness;
    let matrix = stick_slip::nalgebra::DMatrix::from_row_slice(2, 2, &[k11, k12, k21, k22]);
    Structure::new(&model.masses)
        .and_then(|structure| structure.with_stiffness(matrix))
        .and_then(|structure| structure.with_ground_damper(0, model.damping[0]))
        .and_then(|structure| structure.with_ground_damper(1, model.damping[1]))
        .and_then(|structure| structure.with_contact(contact))
        .unwrap()
}

#[test]
fn mode_coupling_thresholds() {
    let threshold = |model: ModeCoupling| model.flutter().unwrap().coefficient;
    let uneven = ModeCoupling {
        stiffness: [[2.0, 1.0], [1.0, 2.5]],
        ..HAMBURG
    };
    for (model, expected) in [
        (HAMBURG, 0.75),
        (
            ModeCoupling {
                damping: [0.1, 0.05],
                ..HAMBURG
            },
            0.7575,
        ),
        (uneven, 0.796875),
        (
            ModeCoupling {
                damping: [0.1, 0.02],
                ..uneven
            },
            0.779667,
        ),
    ] {
        assert!((threshold(model) - expected).abs() < 5e-7, "{model:?}");
    }
    assert_eq!(
        ModeCoupling {
            normal_stiffness: -1.0,
            ..HAMBURG
        }
        .flutter(),
        None
    );
    assert_eq!(
        ModeCoupling {
            masses: [0.0, 1.0],
            ..HAMBURG
        }
        .flutter(),
        None
    );
    assert_eq!(
        ModeCoupling {
            damping: [f64::NAN, 0.0],
            ..HAMBURG
        }
        .flutter(),
        None
    );
}

#[test]
fn mode_coupling_thresholds_are_where_steady_sliding_flutters() {
    for_all(
        256,
        [
            0.3..3.0,
            0.3..3.0,
            1.0..3.0,
            1.0..3.0,
            0.2..0.8,
            0.2..0.8,
            0.3..2.0,
            0.01..0.3,
            0.01..0.3,
            0.0..1.0,
        ],
        |[m1, m2, k11, k22, k12, k21, normal_stiffness, c1, c2, damped]| {
            let (masses, stiffness) = ([m1, m2], [[k11, k12], [k21, k22]]);
            let damping = if damped < 0.5 { [0.0, 0.0] } else { [c1, c2] };
            let model = ModeCoupling {
                masses,
                stiffness,
                normal_stiffness,
                damping,
            };
            let Some(flutter) = model.flutter() else {
                return Ok(());
            };
            let growth = |factor: f64| {
                let sliding = coupled(&model, factor * flutter.coefficient).steady_sliding();
                sliding.map(|sliding| sliding.eigenvalues[0])
            };
            let (Ok(below), Ok(above)) = (growth(1.0 - 1e-5), growth(1.0 + 1e-5)) else {
                return Ok(()); // the load is gone there
            };
            prop_assert!(below.re <= 0.0 && above.re > 0.0, "{} {}", below, above);
            let error = (above.im.abs() - flutter.angular_frequency).abs();
            prop_assert!(error < 1e-3, "{} {:?}", above, flutter);
            Ok(())
        },
    );
}

#[test]
fn drill_strings_lose_stability_at_the_critical_slope() {
    for_all(
        256,
        [0.3..10.0, 0.3..10.0, 0.1..10.0, 0.05..20.0],
        |[upper, lower, stiffness, damping]| {
            let model = TwoInertias {
                upper,
                lower,
                stiffness,
                damping,
            };
            let critical = model.critical_slope().unwrap();
            // A contact of linear friction is a damper; the whole is held by a weak spring.
            let growth = |slope: f64| {
                let string: Structure = Structure::new(&[upper, lower])
                    .and_then(|s| s.with_spring(0, 1, stiffness))
                    .and_then(|s| s.with_ground_spring(0, 1e-9))
                    .and_then(|s| s.with_ground_damper(0, damping))
                    .and_then(|s| s.with_ground_damper(1, slope))
                    .unwrap();
                string.steady_sliding().unwrap().eigenvalues[0].re
            };
            prop_assert!(growth(critical * (1.0 - 1e-4)) < 0.0, "{}", critical);
            prop_assert!(growth(critical * (1.0 + 1e-4)) > 0.0, "{}", critical);
            prop_assert!(model.is_stable(critical * (1.0 - 1e-9)));
            prop_assert!(!model.is_stable(critical * (1.0 + 1e-9)));
            Ok(())
        },
    );
}

/// In units of any size, powers of two, the numbers are the same to the bit.
#[test]
fn formulas_do_not_depend_on_units() {
    let string = |unit: f64| TwoInertias {
        upper: 2000.0 * unit,
        lower: 400.0 * unit,
        stiffness: 500.0 * unit,
        damping: 300.0 * unit,
    };
    let critical = string(1.0).critical_slope().unwrap();
    let vibration = |unit: f64| {
        let oscillator = ForcedOscillator {
            damping: 0.05,
            angular_frequency: 0.8,
            kinetic_friction: 0.3 * unit,
            static_friction: 0.3 * unit,
            force: unit,
        };
        oscillator.without_stops().unwrap().amplitude()
    };
    for exponent in [-480, -240, -80, 80, 240, 480] {
        let rate = 2_f64.powi(exponent);
        let found = string(rate).critical_slope().unwrap();
        assert_eq!(found, rate * critical, "{exponent}");
        assert_eq!(vibration(rate * rate), rate * rate * vibration(1.0));
        assert!(string(rate).is_stable(0.999 * found) && !string(rate).is_stable(1.001 * found));
        for damping in [[0.0, 0.0], [0.1, 0.05]] {
            let own = ModeCoupling { damping, ..HAMBURG };
            let model = ModeCoupling {
                stiffness: own.stiffness.map(|row| row.map(|k| k * rate * rate)),
                normal_stiffness: own.normal_stiffness * rate * rate,
                damping: damping.map(|c| c * rate),
                ..own
            };
            let (own, found) = (own.flutter().unwrap(), model.flutter().unwrap());
            assert_eq!(found.coefficient, own.coefficient, "{exponent}");
            assert_eq!(found.angular_frequency, rate * own.angular_frequency);
        }
    }
}

#[test]
fn the_best_damper_allows_the_steepest_friction_nearly() {
    let string = |damping| TwoInertias {
        upper: 50.0,
        lower: 1.0,
        stiffness: 2.0,
        damping,
    };
    let best = string(1.0).best_damper();
    let allowed = |factor: f64| -string(factor * best).critical_slope().unwrap();
    assert!(allowed(1.0) > allowed(0.9) && allowed(1.0) > allowed(1.1));
}

/// Friction with the nap of a surface, and against it.
#[derive(Debug, Clone, Copy)]
struct Nap {
    forward: f64,
    backward: f64,
    at_rest: f64,
}

impl ContactLaw for Nap {
    type Memory<S: Scalar> = [S; 0];
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, _: [S; 0]) -> S {
        let forward = slip.direction > 0.0;
        let coefficient = if forward {
            self.forward
        } else {
            -self.backward
        };
        slip.speed.constant(coefficient)
    }
    fn limit<S: Scalar>(&self, zero: S, _: [S; 0]) -> Option<S> {
        Some(zero.constant(self.at_rest))
    }
    fn rates<S: Scalar>(&self, _: Motion<S>, _: S, memory: [S; 0]) -> [S; 0] {
        memory
    }
    memory_stays!(0);
}

/// A free vibration dies out by half swings about N μ/k, on the side of the direction that it has.
#[test]
fn friction_may_depend_on_the_direction() {
    let law = Nap {
        forward: 0.05,
        backward: 0.2,
        at_rest: 0.25,
    };
    let (load, stiffness, mass) = (3.0, 2.0, 0.5);
    let contact = Contact::new(0, law, load).unwrap();
    let block = one_mass([mass, 0.0, stiffness], 0.0, contact).unwrap();
    let half = PI * (mass / stiffness).sqrt();
    let start = 4.1;
    let motion = block
        .simulate(structure::State::new(&[start], &[0.0]), 20.0)
        .unwrap();
    let (mut turn, mut time, mut swings) = (start, 0.0, 0);
    let reach = load * law.at_rest / stiffness;
    for event in motion.events() {
        let moving_back = swings % 2 == 0;
        let coefficient = if moving_back {
            law.backward
        } else {
            -law.forward
        };
        turn = 2.0 * load * coefficient / stiffness - turn;
        time += half;
        swings += 1;
        assert!((event.time - time).abs() < 1e-13, "{event:?}");
        assert!(
            (event.state.displacements[0] - turn).abs() < 1e-13,
            "{event:?}"
        );
        let stays = turn.abs() <= reach;
        assert_eq!(event.kind == EventKind::Stick, stays);
    }
    // It rests where it first comes within the reach of static friction.
    assert!(turn.abs() <= reach);
    assert_eq!(
        motion.last().displacements[0],
        motion.events()[swings - 1].state.displacements[0]
    );
    assert_eq!(swings, 10);
}

/// A clutch is let go for a while: no friction in between.
#[test]
fn a_load_that_falls_to_zero_opens_the_contact() -> Result<(), Error> {
    let load = Drive::profile(&[(0.0, 1.0), (10.0, -1.0), (30.0, -1.0), (40.0, 1.0)])?;
    let contact = Contact::new(0, Coulomb::new(0.4, 0.3)?, load)?.on_belt(0.1);
    let structure = one_mass([1.0, 0.0, 1.0], 0.0, contact)?;
    let motion = structure.simulate(structure::State::new(&[0.0], &[0.1]), 60.0)?;
    let kind = |wanted: EventKind| motion.events().iter().find(|event| event.kind == wanted);
    let (open, close) = (
        kind(EventKind::Open).unwrap(),
        kind(EventKind::Close).unwrap(),
    );
    // 1 − t/5 = 0 and −1 + (t − 30)/5 = 0
    assert!((open.time - 5.0).abs() < 1e-14 && (close.time - 35.0).abs() < 1e-13);
    assert_eq!(motion.mode_at(0, 20.0), Some(Mode::Open));
    // Free vibration in between.
    let (q, v) = (open.state.displacements[0], open.state.velocities[0]);
    let t = 20.0 - open.time;
    let free = q * t.cos() + v * t.sin();
    assert!((motion.state_at(20.0).unwrap().displacements[0] - free).abs() < 1e-14);
    // It has slipped by then, and does so again afterwards.
    assert!(matches!(
        motion.mode_at(0, 4.99),
        Some(Mode::Slip(Direction::Lagging | Direction::Leading))
    ));
    assert_ne!(motion.mode_at(0, 36.0), Some(Mode::Open));
    Ok(())
}

/// The band closes with the load: a force that is rounding does not leave it before, and one that
/// grows does.
#[test]
fn a_band_that_closes_with_its_load_is_left_where_the_force_reaches_it() -> Result<(), Error> {
    let load = Drive::profile(&[(0.0, 1.0), (10.0, -1.0)])?;
    let contact = Contact::new(0, Coulomb::new(0.4, 0.3)?, load)?;
    let structure = one_mass([1.0, 0.0, 1.0], 0.0, contact)?;
    let motion = structure.simulate(structure::State::new(&[2e-16], &[0.0]), 9.0)?;
    let kinds: Vec<EventKind> = motion.events().iter().map(|event| event.kind).collect();
    assert_eq!(kinds, [EventKind::Open]);
    // Carried by the belt: q = vt, k q = μ_s (N − γq).
    let [limit, stiffness, slope, speed] = [0.4, 1.5, 0.5, 0.1];
    let contact = Contact::new(0, Coulomb::new(limit, 0.3)?, 1.0)?
        .on_belt(speed)
        .with_load_gradient(0, -slope)?;
    let structure = one_mass([1.0, 0.0, stiffness], 0.0, contact)?;
    let motion = structure.simulate(structure::State::new(&[0.0], &[speed]), 5.0)?;
    let release = &motion.events()[0];
    let expected = limit / ((stiffness + limit * slope) * speed);
    assert_eq!(release.kind, EventKind::Release(Direction::Lagging));
    assert_abs_diff_eq!(release.time, expected, epsilon = 1e-14);
    Ok(())
}

#[test]
fn a_load_that_springs_lift_ends_the_motion() -> Result<(), Error> {
    let contact = Contact::new(0, Coulomb::new(0.4, 0.3)?, 1.0)?
        .on_belt(0.1)
        .with_load_gradient(1, -1.0)?;
    let structure = Structure::new(&[1.0, 1.0])?
        .with_ground_spring(0, 1.0)?
        .with_ground_spring(1, 1.0)?
        .with_contact(contact)?;
    // q_1 = 2 sin t: the load 1 − q_1 is gone at t = π/6.
    let start = || structure::State::new(&[0.0, 0.0], &[0.0, 2.0]);
    let Err(Error::Separation { contact, reached }) = structure.simulate(start(), 5.0) else {
        panic!("it separates")
    };
    assert_eq!(contact, 0);
    assert_abs_diff_eq!(reached.time, TAU / 12.0, epsilon = 1e-15);
    assert_abs_diff_eq!(reached.state.displacements[1], 1.0, epsilon = 1e-15);
    // Up to there it is a motion like any other.
    assert!(structure.simulate(start(), 0.5).is_ok());
    Ok(())
}

/// A mass of 1 under 25 sin(πt/2), with friction v + 5 + 10 exp(−2v) from a table of 50 points up
/// to v = 12 (example `Friction` of the Modelica Standard Library). With straight lines the motion
/// is exponentials and sines on each piece, joined with 30 digits.
#[test]
fn a_table_of_lines_moves_as_its_closed_form() {
    let points = (0..50).map(|i| 12.0 * f64::from(i) / 49.0);
    let points: Vec<_> = points
        .map(|v| (v, v + 5.0 + 10.0 * (-2.0 * v).exp()))
        .collect();
    let turn = |law: Tabulated| {
        let mass = Structure::new(&[1.0])
            .and_then(|s| s.with_force(0, Drive::harmonic(25.0, PI / 2.0, -PI / 2.0)?))
            .and_then(|s| s.with_contact(Contact::new(0, law, 1.0)?))
            .unwrap();
        let motion = mass.simulate(structure::State::at_rest(1), 3.0).unwrap();
        let end = &motion.events()[1];
        (end.time, end.state.displacements[0])
    };
    let lines = turn(Tabulated::piecewise_linear(points.iter().copied()).unwrap());
    // 100 steps, each with rounding errors of the size of the distance.
    assert_abs_diff_eq!(lines.0, 2.442232522576342681681, epsilon = 1e-14);
    assert_abs_diff_eq!(lines.1, 13.417810591487087236250854, epsilon = 1e-13);
    // Cubics follow the curve below the lines, as the slope of friction rises.
    let cubics = turn(Tabulated::new(points).unwrap());
    assert!((cubics.1 - 13.450723).abs() < 1e-6, "{cubics:?}");
}
