//! Edges at which searches once went wrong: ranges of some ulps, the border of a continuum, a belt
//! at rest, units in which squares overflow.

use crate::common::{Random, Table, TurnsNan, exactly, on_belt};
use approx::assert_abs_diff_eq;
use stick_slip::bifurcation::AttractorKind;
use stick_slip::limit_cycle::{self, Attractor};
use stick_slip::{
    AnyLaw, Coulomb, CycleKind, Error, EventKind, Exponential, FrictionLaw, LimitCycle, MassOnBelt,
    Mode, Polynomial, State, Stribeck, Tabulated, bifurcation,
};

#[test]
fn no_grazing_velocity_is_made_by_rounding() {
    fn search(law: impl FrictionLaw) {
        let system = MassOnBelt::new(law, 0.2).unwrap();
        let system = system.with_damping(0.05).unwrap();
        for start in [0.0, 1e-16, 1e-15] {
            for end in [1e-13, 1e-12, 1e-11, 1e-10, 1e-8] {
                let found = bifurcation::grazing_velocities(&system, start..end);
                assert_eq!(found, Ok(vec![]), "{start:e}..{end:e}");
            }
        }
    }
    search(Polynomial::new(0.4, 0.25, 0.5).unwrap());
    search(Stribeck::new(0.4, 0.25, 0.05, 1).unwrap());
    search(Exponential::new(0.4, 0.25, 0.5).unwrap());
}

/// A belt at rest, and no friction up to the speed 1/2: motions go on up to this amplitude.
#[test]
fn friction_that_begins_at_a_speed_leaves_a_family_on_a_belt_at_rest() {
    let law = Tabulated::piecewise_linear([(0.0, 0.0), (0.5, 0.0), (1.0, 0.3)]).unwrap();
    for (mu_s, max_amplitude) in [(0.0, Some(0.5)), (0.1, Some(0.5)), (0.6, None)] {
        let law = law.clone().with_static_coefficient(mu_s).unwrap();
        let system = MassOnBelt::new(law, 0.0).unwrap();
        let family = limit_cycle::find(&system).unwrap().continuum();
        assert_eq!(family.map(|family| family.max_amplitude), max_amplitude);
        for displacement in [0.05, 0.3, 2.0] {
            let start = State::new(displacement, 0.0);
            let attractor = limit_cycle::attractor(&system, start).unwrap();
            let goes_on = max_amplitude.is_some() && displacement > mu_s;
            let is_continuum = attractor == Attractor::Continuum;
            assert!(is_continuum || attractor == Attractor::Rest);
            assert_eq!(is_continuum, goes_on, "{mu_s} {displacement}");
            let motion = system.simulate(start, 2000.0).unwrap();
            let is_at_rest = motion.mode_at(2000.0) == Some(Mode::Stick);
            assert_eq!(is_at_rest, !goes_on, "{mu_s} {displacement}");
        }
    }
}

#[test]
fn hopf_velocities_are_looked_for_in_a_range_of_one_ulp() {
    let least = f64::from_bits(1);
    let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5).unwrap(), 0.2).unwrap();
    for end in [least, 2.0 * least, 1e-322, 1e-310] {
        assert_eq!(bifurcation::hopf_velocities(&system, 0.0..end), Ok(vec![]));
    }
    let system = system.with_damping(0.05).unwrap();
    let hopf = bifurcation::hopf_velocities(&system, 0.1..1.0).unwrap()[0];
    // The root is known to rounding, so it may lie beyond a range of one ulp.
    let found = bifurcation::hopf_velocities(&system, hopf..hopf.next_up()).unwrap();
    assert!(found.iter().all(|&root| root == hopf));
    let found = bifurcation::hopf_velocities(&system, hopf - 1e-9..hopf + 1e-9).unwrap();
    assert!(found.len() == 1 && (found[0] - hopf).abs() < 1e-15);
}

#[test]
fn no_cycle_is_made_by_rounding_at_the_border_of_a_continuum() {
    let law = Tabulated::new([(0.0, 0.5), (0.2, 0.45), (0.4, 0.4)]).unwrap();
    let mut random = 1_u64;
    for case in 0..40 {
        // The load of the first case made a cycle of multiplier 1 + 7e-11.
        random = random
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        let load = match case {
            0 => 0.135_889_639_229_022_2,
            _ => 0.02 + 0.5 * (random >> 11) as f64 * 2_f64.powi(-53),
        };
        let system = on_belt(&law, 1.1, 0.0, load);
        let cycles = limit_cycle::find(&system).unwrap();
        // Motions are harmonic up to the one that touches the speed 0.4.
        let border = cycles.continuum().unwrap().max_amplitude;
        assert!((border - 0.7).abs() < 1e-15, "{load}: {border}");
        let slipping = |cycle: &&LimitCycle| cycle.kind() == CycleKind::PureSlip;
        assert_eq!(cycles.iter().filter(slipping).count(), 0, "{load}");
    }
}

/// Without static friction above the kinetic one, the motion from the release point is the border
/// of the continuum. It comes back to the belt by rounding, or just does not.
#[test]
fn the_border_of_a_continuum_is_no_cycle() {
    let check = |law: AnyLaw, v_b: f64, load: f64| {
        let system = MassOnBelt::new(&law, v_b).unwrap();
        let system = system.with_load(load).unwrap();
        let about = format!("{system:?}");
        let cycles = limit_cycle::find(&system).unwrap();
        assert!(cycles.is_empty(), "{about}: {cycles:?}");
        assert_eq!(cycles.continuum().unwrap().max_amplitude, v_b, "{about}");
        assert_eq!(limit_cycle::stick_slip(&system), Ok(None), "{about}");
        let [_, high] = system.stick_limits();
        for start in [State::new(high, v_b), State::new(0.9 * high, v_b)] {
            let reached = limit_cycle::attractor(&system, start).unwrap();
            assert_eq!(reached, Attractor::Continuum, "{about}");
        }
        let range = 0.01 * v_b..3.0 * v_b;
        for search in [
            bifurcation::grazing_velocities,
            bifurcation::touching_velocities,
            bifurcation::overshoot_velocities,
            bifurcation::crossing_velocities,
        ] {
            assert_eq!(search(&system, range.clone()), Ok(vec![]), "{about}");
        }
        let ranges = bifurcation::vibration_ranges(&system, range.clone()).unwrap();
        let [only] = exactly(&ranges);
        assert_eq!(only.velocities, range);
        assert_eq!(only.attractors, [AttractorKind::Continuum]);
        // A continuum is a vibration, under whatever load.
        assert!(only.vibrates());
        assert_eq!(bifurcation::silencing_load(&system), Ok(0.0), "{about}");
        let loads = bifurcation::along(|load| system.with_load(load), 0.1 * load..10.0 * load);
        assert_eq!(loads.silence(), Ok(None), "{about}");
        assert_eq!(loads.vibration_ranges().unwrap().len(), 1, "{about}");
    };
    let one = 0.286_034_524_096_909_3;
    for load in [0.1, 0.2, 0.3, 0.5, 1.0, 2.0, 3.0] {
        let law = Coulomb::new(one, one).unwrap();
        check(law.into(), 0.348_294_879_674_908_74, load);
    }
    let mut random = Random::new(2801);
    for i in 0..40 {
        let top = random.uniform(0.05, 1.5);
        let law: AnyLaw = match i % 4 {
            0 => Coulomb::new(top, top).unwrap().into(),
            1 => Polynomial::new(top, top, 0.3).unwrap().into(),
            2 => Stribeck::new(top, top, 0.3, 1).unwrap().into(),
            _ => Tabulated::new([(0.0, top), (0.2, top), (0.5, top)])
                .unwrap()
                .into(),
        };
        let v_b = random.logarithmic(1e-4, 10.0);
        check(law, v_b, random.logarithmic(0.01, 10.0));
    }
    // Without friction nothing but damping silences.
    let free = MassOnBelt::new(Coulomb::new(0.0, 0.0).unwrap(), 0.3).unwrap();
    assert_eq!(bifurcation::silencing_load(&free), Ok(0.0));
    let damped = free.with_damping(0.01).unwrap();
    assert_eq!(bifurcation::silencing_load(&damped), Ok(f64::INFINITY));
}

/// Friction varies near rest only, on a thirtieth of the belt velocity, where the law has no
/// breakpoint: only the largest motions in slip come there.
#[test]
fn a_continuum_ends_where_friction_begins_to_vary() {
    let law = Stribeck::new(
        0.5989457980316475,
        0.5204567851502142,
        0.019205374450379963,
        2,
    );
    let system = on_belt(law.unwrap(), 1.2739152266588256, 0.0, 0.09003223711963569);
    let v_b = system.belt_velocity();
    let border = limit_cycle::find(&system).unwrap().continuum().unwrap();
    let part = border.max_amplitude / v_b;
    assert!(0.85 < part && part < 0.98, "{part}");
    // The largest velocity one turn later, and what the attractor is.
    for (part, grows) in [(0.5, false), (part - 0.01, false), (0.98, true)] {
        let peak = part * v_b;
        let force = system.load() * system.law().kinetic(v_b - peak);
        let start = State::new(force, peak);
        let motion = system.simulate(start, 9.0).unwrap();
        let later = motion.sample(20_000).filter(|(time, _)| *time > 4.0);
        let next = later.map(|(_, state)| state.velocity).fold(0.0, f64::max);
        assert_eq!(next / peak - 1.0 > 1e-6, grows, "{part}: {}", next / peak);
        let reached = limit_cycle::attractor(&system, start).unwrap();
        assert_eq!(reached != Attractor::Continuum, grows, "{part}: {reached}");
    }
}

/// A table whose last piece is flat. Beyond the last point a continuum exists, however small; round
/// it, friction damps.
#[test]
fn a_continuum_begins_where_the_belt_passes_a_breakpoint() {
    let law = Tabulated::new([(0.0, 0.5), (0.15, 0.4), (0.3, 0.42), (0.7, 0.45)]).unwrap();
    let system = on_belt(&law, 0.9, 0.0, 3.0);
    let ranges = bifurcation::vibration_ranges(&system, 0.4..2.0).unwrap();
    let [below, beyond] = exactly(&ranges);
    assert_abs_diff_eq!(below.velocities.end, 0.7, epsilon = 1e-11);
    assert_eq!(below.attractors[0], AttractorKind::SteadySliding);
    assert_eq!(beyond.attractors[0], AttractorKind::Continuum);
    for excess in [1e-12, 1e-9, 1e-6, 1e-4, 1e-2, 0.2] {
        let system = system.with_belt_velocity(0.7 + excess).unwrap();
        let found = limit_cycle::find(&system).unwrap().continuum();
        let amplitude = found.unwrap().max_amplitude;
        assert!((amplitude - excess).abs() < 1e-15, "{excess}: {amplitude}");
        // A motion that is larger shrinks to the continuum.
        let equilibrium = system.equilibrium().unwrap().displacement;
        let start = State::new(equilibrium, excess + 0.1);
        let end = system.simulate(start, 6.0).unwrap().last();
        let size = |state: State| (state.displacement - equilibrium).hypot(state.velocity);
        assert!(size(end) < size(start));
        let reached = limit_cycle::attractor(&system, start).unwrap();
        assert_eq!(reached, Attractor::Continuum, "{excess}");
    }
}

#[test]
fn a_cycle_round_a_continuum_is_kept() {
    // Flat from 0.4 to 0.6; above, friction rises and damps, below, it falls and feeds.
    let points = [(0.0, 0.5), (0.4, 0.4), (0.6, 0.4), (0.9, 0.45)];
    let system = MassOnBelt::new(Tabulated::new(points).unwrap(), 0.55).unwrap();
    let cycles = limit_cycle::find(&system.with_load(0.13).unwrap()).unwrap();
    assert!((cycles.continuum().unwrap().max_amplitude - 0.05).abs() < 1e-15);
    let [&inner, &outer] = exactly(&cycles.iter().collect::<Vec<_>>());
    assert_eq!(
        (inner.kind(), inner.is_stable()),
        (CycleKind::PureSlip, false)
    );
    assert_abs_diff_eq!(inner.multiplier(), 1.061_624_813_772_26, epsilon = 1e-9);
    assert_eq!(
        (outer.kind(), outer.is_stable()),
        (CycleKind::StickSlip, true)
    );
}

#[test]
fn no_continuum_about_a_breakpoint_beyond_which_friction_varies() {
    let law = Tabulated::new([(0.0, 0.5), (0.4, 0.4)]).unwrap();
    let system = on_belt(law, 0.4, 0.0, 0.13);
    assert_eq!(limit_cycle::find(&system).unwrap().continuum(), None);
}

#[test]
fn cycles_and_basins_agree_on_a_belt_at_rest_without_kinetic_friction() {
    let continuum = |law: Coulomb, damping: f64| {
        let system = MassOnBelt::new(law, 0.0).unwrap();
        let system = system.with_damping(damping).unwrap();
        let found = limit_cycle::find(&system).unwrap().continuum();
        let reached = limit_cycle::attractor(&system, State::new(2.0, 0.0)).unwrap();
        assert_eq!(found.is_some(), reached == Attractor::Continuum);
        found.map(|continuum| continuum.max_amplitude)
    };
    assert_eq!(
        continuum(Coulomb::new(0.4, 0.0).unwrap(), 0.0),
        Some(f64::INFINITY)
    );
    assert_eq!(
        continuum(Coulomb::new(0.0, 0.0).unwrap(), 0.0),
        Some(f64::INFINITY)
    );
    assert_eq!(continuum(Coulomb::new(0.4, 0.0).unwrap(), 0.1), None);
    assert_eq!(continuum(Coulomb::new(0.4, 0.1).unwrap(), 0.0), None);
}

#[test]
fn energies_beyond_the_largest_number_are_infinite_and_never_nan() {
    let cycle = |unit: f64, damping: f64| {
        let law = Coulomb::new(0.4, 0.25).unwrap();
        let system = MassOnBelt::new(law, 0.1 * unit).unwrap();
        let system = system.with_load(unit).unwrap();
        limit_cycle::stick_slip(&system.with_damping(damping).unwrap())
            .unwrap()
            .unwrap()
    };
    for damping in [0.0, 0.01] {
        let one = cycle(1.0, damping);
        let scaled = |unit: f64, value: f64| value * unit * unit;
        for unit in [
            2_f64.powi(400),
            2_f64.powi(511),
            2_f64.powi(754),
            2_f64.powi(960),
        ] {
            let large = cycle(unit, damping);
            let (energy, expected) = (large.energy(), one.energy());
            let pairs = [
                (energy.drive_work, expected.drive_work),
                (energy.belt_work, expected.belt_work),
                (energy.damper_loss, expected.damper_loss),
                (energy.friction_loss, expected.friction_loss),
            ];
            for (large, small) in pairs {
                let expected = scaled(unit, small);
                let same = large == expected || (large / expected - 1.0).abs() < 1e-12;
                assert!(same, "{unit:e}: {large:e}, {expected:e}");
            }
            let rms = large.rms_velocity() / unit;
            assert_abs_diff_eq!(rms / one.rms_velocity(), 1.0, epsilon = 1e-14);
        }
    }
}

#[test]
fn no_cycle_holds_a_static_coefficient_that_has_turned_nan() {
    for good in 1..40 {
        let law = TurnsNan::after(good);
        let Ok(system) = MassOnBelt::new(law, 0.2) else {
            continue;
        };
        match limit_cycle::stick_slip(&system) {
            Ok(cycle) => {
                assert_abs_diff_eq!(cycle.unwrap().period(), 6.985871959728993, epsilon = 1e-12);
            }
            Err(Error::InvalidParameter { name, value, .. }) => {
                assert!(name == "static_coefficient" && value.is_nan());
            }
            // Slip cannot start from a release point that is not a number.
            Err(error) => assert!(matches!(error, Error::StepUnderflow { .. }), "{error:?}"),
        }
    }
}

/// A stable and an unstable motion in slip on both sides of a kink of the law: the growth of a turn
/// comes to zero there and goes back, between places from which a cubic through its values and
/// slopes stays away from zero.
#[test]
fn a_pair_of_cycles_next_to_a_kink_of_the_law_is_found() {
    let points = [
        (0.0, 0.4409123819239009),
        (0.11053013362325875, 0.14137466064153786),
        (0.23036859106901936, 0.19505697152416687),
        (0.33634809059134346, 0.1581827750929254),
        (1.3363480905913434, 0.1581827750929254),
    ];
    let law = Table {
        static_coefficient: 0.6172773346934612,
        points: points.to_vec(),
    };
    let system = on_belt(law, 0.7354248506634508, 0.0004575217668656442, 1.0);
    let kink = system.belt_velocity() - points[1].0;
    for i in 0..=20 {
        let load = 0.2 + 0.001 * f64::from(i);
        let system = system.clone().with_load(load).unwrap();
        let cycles = limit_cycle::find(&system).unwrap();
        let pure: Vec<&LimitCycle> = cycles
            .iter()
            .filter(|cycle| cycle.kind() == CycleKind::PureSlip)
            .collect();
        let [&least, &inner, &outer] = exactly(&pure);
        assert!(!least.is_stable() && inner.is_stable() && !outer.is_stable());
        assert!(inner.max_velocity() < kink && kink < outer.max_velocity());
        assert!(outer.max_velocity() < 1.02 * inner.max_velocity());
    }
}

/// A stable and an unstable motion in slip next to the fold in which they vanish, of a table: its
/// second derivative jumps where the motions meet its points, so that a cubic predicts the growth
/// of a turn less well than between them.
#[test]
fn a_pair_of_cycles_next_to_a_fold_of_a_table_is_found() {
    let points = [
        (0.0, 0.4026066032437917),
        (0.027709746912635468, 0.4160709368406813),
        (0.09142599421312214, 0.4231363877540457),
        (0.1057707706838141, 0.4124098258736963),
        (0.128064514231338, 0.49886851239935676),
        (0.15995011469032516, 0.2901495153492498),
        (0.23882899917577555, 0.34423449337757206),
        (0.2691316687267816, 0.45845944650919945),
    ];
    let law = Tabulated::new(points)
        .and_then(|law| law.with_static_coefficient(0.5801904365623219))
        .unwrap();
    let system = MassOnBelt::new(law, 0.06)
        .and_then(|system| system.with_damping(0.0011310187397595818))
        .and_then(|system| system.with_load(0.2286018036832159))
        .unwrap();
    let [&fold] = exactly(&bifurcation::fold_velocities(&system, 0.06..0.07).unwrap());
    let peaks = |v_b: f64| -> Vec<(bool, f64)> {
        let cycles = limit_cycle::find(&system.clone().with_belt_velocity(v_b).unwrap()).unwrap();
        let cycles = cycles.iter();
        let cycles = cycles.map(|cycle| (cycle.is_stable(), cycle.max_velocity()));
        cycles.collect()
    };
    let parted = |distance: f64| -> f64 {
        assert_eq!(peaks(fold * (1.0 - distance)), []);
        let [(false, inner), (true, outer)] = peaks(fold * (1.0 + distance))[..] else {
            panic!("{distance:e}")
        };
        (outer - inner) / distance.sqrt()
    };
    // The peak velocities part with the root of the distance, to first order in that root.
    let constant = parted(1e-4);
    for i in 5..=10 {
        let parted = parted(10.0_f64.powi(-i));
        assert!((parted / constant - 1.0).abs() < 1e-3, "{i}: {parted}");
    }
}

/// Next to the Hopf velocity v_h the cubic law has a cycle of the velocity amplitude
/// 2√(v_h² − v_b²), by averaging. One period changes the motions about it by some ten times the
/// rounding error.
#[test]
fn a_small_cycle_that_rounding_moves_is_found() {
    let law = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    let system = MassOnBelt::new(law, 0.4)
        .and_then(|system| system.with_damping(0.0025))
        .and_then(|system| system.with_load(0.05))
        .unwrap();
    let [&hopf] = exactly(&bifurcation::hopf_velocities(&system, 0.3..0.5).unwrap());
    for i in 0..30 {
        let distance = 3e-9 * 1.2_f64.powi(i);
        let v_b = hopf * (1.0 - distance);
        let cycles = limit_cycle::find(&system.with_belt_velocity(v_b).unwrap()).unwrap();
        let [cycle] = exactly(cycles.as_slice());
        assert!(cycle.is_stable() && cycle.kind() == CycleKind::PureSlip);
        // The noise of the growth, 32 ε (γ²μ_s + v_b)/V, over its slope, 2π |h1|: 7 % at the first.
        let amplitude = 2.0 * (hopf * hopf - v_b * v_b).sqrt();
        assert!(
            (cycle.max_velocity() / amplitude - 1.0).abs() < 0.07,
            "{distance:e}"
        );
    }
}

/// On so slow a belt the mass sticks for longer than any number: it does not vibrate.
#[test]
fn a_stick_phase_whose_time_overflows_is_in_no_cycle() {
    let law = Coulomb::new(0.6, 0.2).unwrap();
    for v_b in [f64::from_bits(1), -f64::from_bits(1), 1e-310] {
        let system = on_belt(&law, v_b, 0.12, 0.2);
        assert_eq!(limit_cycle::stick_slip(&system), Ok(None));
        let cycles = limit_cycle::find(&system).unwrap();
        assert_eq!(cycles.len(), 0, "{v_b:e}: {cycles:?}");
        let found = limit_cycle::attractor(&system, State::new(0.0, v_b));
        assert!(found.is_ok(), "{found:?}");
    }
    let cycles = limit_cycle::find(&on_belt(
        &Coulomb::new(0.6, 0.2).unwrap(),
        1e-300,
        0.12,
        0.2,
    ));
    let cycles = cycles.unwrap();
    let [&cycle] = exactly(&cycles.iter().collect::<Vec<_>>());
    assert!(cycle.period().is_finite() && cycle.rms_velocity() > 0.0);
}

/// The belt carries the mass along whether it was caught before its velocity was negative or not.
#[test]
fn a_start_and_the_stick_that_it_comes_to_have_one_attractor() {
    fn search(law: impl FrictionLaw, v_b: f64, damping: f64) -> usize {
        let system = MassOnBelt::new(law, v_b).unwrap();
        let system = system.with_damping(damping).unwrap();
        let basins = limit_cycle::basins(&system).unwrap();
        let mut caught = 0;
        for i in 0..30 {
            for j in -3..12 {
                let start = State::new(0.04 * f64::from(i) - 0.3, 0.083 * v_b * f64::from(j));
                let motion = system.simulate(start, 8.0).unwrap();
                let [event, ..] = motion.events() else {
                    continue;
                };
                if event.kind == EventKind::Stick {
                    let attractors = [start, event.state].map(|start| basins.attractor(start));
                    let [expected, found] = attractors.map(Result::unwrap);
                    assert_eq!(expected, found, "{start:?} {event:?}");
                    caught += 1;
                }
            }
        }
        caught
    }
    let caught = [
        search(Coulomb::new(0.4, 0.25).unwrap(), 0.2, 0.02),
        search(Coulomb::new(0.4, 0.1).unwrap(), 0.5, 0.0019),
        search(Exponential::new(0.4, 0.25, 0.5).unwrap(), 0.2, 0.05),
    ];
    assert!(caught.iter().all(|count| *count > 50), "{caught:?}");
}
