//! Cycles and bifurcations in cases with a known answer, and in hard ones.

use crate::common::polynomials::Polynomials;
use crate::common::{Random, count, exactly, friction_law, on_belt, paper, some};
use approx::assert_abs_diff_eq;
use stick_slip::analysis::averaging;
use stick_slip::bifurcation::{grazing_velocities, hopf_velocities};
use stick_slip::limit_cycle::{self, Attractor, attractor};
use stick_slip::{
    Coulomb, CycleKind, Exponential, FrictionLaw, LimitCycle, MassOnBelt, Polynomial, State,
    Tabulated,
};

/// The cycle costs its one slip arc: nothing is integrated before or beside it.
#[test]
fn stick_slip_takes_one_arc() {
    let cycle = limit_cycle::stick_slip(&paper(0.2)).unwrap().unwrap();
    // Nine Taylor steps, the stick phase, and what follows at the time T itself.
    let trajectory = cycle.trajectory();
    let steps = trajectory.steps();
    assert_eq!(steps.len(), 9 + 1 + 1);
    assert_eq!((steps[10].duration(), steps[10].event()), (0.0, None));
}

#[test]
fn exponential_law_has_no_cycle_below_its_lower_hopf_velocity() {
    let mut random = Random::new(11);
    let mut checked = 0;
    for _ in 0..200 {
        let static_coefficient = random.uniform(0.2, 0.8);
        let kinetic_coefficient = static_coefficient * random.uniform(0.2, 0.9);
        let law = Exponential::new(
            static_coefficient,
            kinetic_coefficient,
            random.logarithmic(0.05, 2.0),
        )
        .unwrap();
        let system = on_belt(
            law,
            1.0,
            random.logarithmic(0.003, 0.3),
            random.logarithmic(0.1, 5.0),
        );
        let Some(low) = hopf_velocities(&system, 0.0..20.0)
            .unwrap()
            .first()
            .copied()
        else {
            continue;
        };
        let below = low * random.uniform(0.05, 0.98);
        let cycles = limit_cycle::find(&system.with_belt_velocity(below).unwrap()).unwrap();
        assert!(
            cycles.is_empty() && cycles.unresolved().is_empty(),
            "{system:?} at {below}"
        );
        checked += 1;
    }
    assert!(checked > 100, "{checked}");
}

/// Two cycles whose peak velocities differ by 10⁻³, close to the fold where they meet.
#[test]
fn two_cycles_near_a_fold_are_told_apart() {
    let fold = 1.457_823_592_457_963_3;
    let system = on_belt(Exponential::new(0.4, 0.3, 1.0).unwrap(), 1.0, 0.02, 1.0);
    let pair = |distance: f64| {
        let at = system.with_belt_velocity(fold - distance).unwrap();
        limit_cycle::find(&at).unwrap()
    };
    // The distance of the peaks goes with the square root of that from the fold.
    let wide = pair(1e-4);
    let gap = |set: &limit_cycle::CycleSet| {
        let peaks: Vec<f64> = set.iter().map(|cycle| cycle.max_velocity()).collect();
        assert_eq!(peaks.len(), 2, "{peaks:?} {:?}", set.unresolved());
        peaks[1] - peaks[0]
    };
    let distance = 1e-4 * (1e-3 / gap(&wide)).powi(2);
    let near = pair(distance);
    assert!((gap(&near) - 1e-3).abs() < 1e-5, "{}", gap(&near));
    let multipliers: Vec<f64> = near.iter().map(|cycle| cycle.multiplier()).collect();
    assert!(
        multipliers[0] > 1.0 && multipliers[1] < 1.0,
        "{multipliers:?}"
    );
    assert!(pair(-1e-9).is_empty());
}

/// η = 15: the pure-slip cycle grows from nothing to the belt within a few ulps of the belt
/// velocity.
#[test]
fn canard_like_growth_is_resolved_or_told() {
    let law = Polynomial::new(1.2, 0.2, 0.1).unwrap();
    let system = on_belt(law, 0.05, 0.05, 1.0);
    let hopf = hopf_velocities(&system, 0.0..0.2).unwrap()[0];
    let grazing = grazing_velocities(&system, 0.05..hopf * (1.0 + 1e-9)).unwrap();
    assert_eq!(grazing.len(), 1, "{grazing:?}");
    for part in [
        1.0 - 1e-6,
        1.0 - 1e-12,
        1.0,
        1.0 + 1e-15,
        1.0 + 1e-12,
        1.0 + 1e-6,
    ] {
        let at = system.with_belt_velocity(grazing[0] * part).unwrap();
        let set = limit_cycle::find(&at).unwrap();
        assert!(set.len() + set.unresolved().len() >= 1, "{part}");
        for cycle in &set {
            let (start, end) = (cycle.state(), cycle.trajectory().last());
            assert!(
                (start.displacement - end.displacement).abs() < 1e-6,
                "{part}"
            );
        }
    }
}

#[test]
fn hard_parameters_give_an_answer() {
    for v_b in [1e-9, 1e-6, -1e-6, 0.2, -0.2, 1e3] {
        for load in [1e-6, 1e-3, 1.0, 1e3] {
            for (mu_s, mu_k) in [(0.4, 0.25), (0.4, 0.4), (0.0, 0.0)] {
                let system = on_belt(Coulomb::new(mu_s, mu_k).unwrap(), v_b, 0.0, load);
                let set = limit_cycle::find(&system).unwrap();
                // Without damping and with constant friction every small motion is periodic.
                assert!(set.continuum().is_some(), "{v_b} {load} {mu_s}");
            }
            let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5).unwrap(), v_b)
                .and_then(|system| system.with_load(load));
            let stable = system
                .and_then(|system| limit_cycle::find(&system))
                .map(|set| set.stable().count());
            let error_is_typed = stable.is_err() && v_b == 1e3;
            assert!(stable.is_ok() || error_is_typed, "{v_b} {load}: {stable:?}");
        }
    }
    assert!(limit_cycle::find(&paper(0.0)).unwrap().is_empty());
}

/// The rows of the case table of `attractor`.
#[test]
fn basins_follow_their_table() {
    let reached = |system: &MassOnBelt<Exponential>, u: f64, v: f64| {
        attractor(system, State::new(u, v)).unwrap()
    };
    let bistable = on_belt(Exponential::new(0.6, 0.3, 0.4).unwrap(), 1.0, 0.01, 1.0);
    let centre = bistable.equilibrium().unwrap().displacement;
    let is_stick_slip = |found: Attractor| match found {
        Attractor::Cycle(cycle) => cycle.kind() == CycleKind::StickSlip,
        _ => false,
    };
    // In stick, behind the belt on both sides of the unstable cycle, above the belt velocity, far
    // out.
    assert!(is_stick_slip(reached(&bistable, 0.1, 1.0)));
    assert_eq!(reached(&bistable, centre, 0.30), Attractor::Equilibrium);
    assert!(is_stick_slip(reached(&bistable, centre, 0.32)));
    assert!(is_stick_slip(reached(&bistable, 0.0, 1.5)));
    assert!(is_stick_slip(reached(&bistable, 3.0, 5.0)));
    // On the unstable cycle.
    let cycles = limit_cycle::find(&bistable).unwrap();
    let unstable = cycles.iter().find(|cycle| !cycle.is_stable()).unwrap();
    let State {
        displacement,
        velocity,
    } = unstable.state();
    assert!(matches!(
        reached(&bistable, displacement, velocity),
        Attractor::Separatrix(_)
    ));
    // The mirror image.
    let mirror = bistable.with_belt_velocity(-1.0).unwrap();
    assert_eq!(reached(&mirror, -centre, -0.30), Attractor::Equilibrium);
    assert!(is_stick_slip(reached(&mirror, -centre, -0.32)));
    // A node, and a belt at rest.
    let node = bistable.with_damping(3.0).unwrap();
    assert_eq!(reached(&node, 1.0, -1.0), Attractor::Equilibrium);
    let still = bistable.with_belt_velocity(0.0).unwrap();
    assert_eq!(reached(&still, 3.0, 1.0), Attractor::Rest);
    // A crossing cycle, from inside and from outside.
    let crossing = on_belt(Polynomial::new(0.4, 0.25, 0.5).unwrap(), 0.25, 0.0004, 0.01);
    for start in [
        State::new(0.0, 0.25),
        State::new(0.0, 0.0),
        State::new(2.0, 0.0),
    ] {
        let found = attractor(&crossing, start).unwrap();
        assert!(matches!(found, Attractor::Cycle(cycle) if cycle.kind() == CycleKind::Crossing));
    }
    let free = MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), 0.2).unwrap();
    assert_eq!(
        attractor(&free, State::new(0.25, 0.1)).unwrap(),
        Attractor::Continuum
    );
}

/// A stick phase may last 10³⁰⁰ units of time.
#[test]
fn the_slowest_cycles_have_finite_numbers() {
    let system = on_belt(Coulomb::new(0.3, 1e-10).unwrap(), 1e-300, 0.02, 1.0);
    let cycle = limit_cycle::stick_slip(&system).unwrap().unwrap();
    let energy = cycle.energy();
    assert!(cycle.period() > 1e299 && cycle.mean_displacement().is_finite());
    assert!(energy.drive_work.is_finite() && energy.friction_loss.is_finite());
}

#[test]
fn the_families_of_motions_without_friction_and_with_constant_friction() {
    let family = |static_coefficient: f64, kinetic_coefficient: f64| {
        let coulomb = Coulomb::new(static_coefficient, kinetic_coefficient).unwrap();
        let cycles = limit_cycle::find(&MassOnBelt::new(coulomb, 0.2).unwrap()).unwrap();
        cycles.continuum().unwrap().max_amplitude
    };
    assert_eq!(family(0.0, 0.0), f64::INFINITY);
    assert_eq!(family(0.4, 0.4), 0.2);
    assert_eq!(family(0.4, 0.1), 0.2);
    assert_eq!(family(0.4, 0.0), 0.2);
    // None up to the sliding speed 1, and some beyond: not all motions are periodic.
    let table = Tabulated::new([(0.0, 0.0), (1.0, 0.0), (2.0, 0.1)]).unwrap();
    let cycles = limit_cycle::find(&MassOnBelt::new(table, 0.2).unwrap()).unwrap();
    assert_eq!(cycles.continuum().unwrap().max_amplitude, 0.2);
}

/// On either side of a pure-slip cycle that attracts.
#[test]
fn motions_inside_and_outside_of_a_cycle_end_on_it() {
    let system = paper(0.4071);
    let friction = |v: f64| system.law().kinetic(system.belt_velocity() - v);
    let cycle = limit_cycle::find(&system)
        .unwrap()
        .stable()
        .next()
        .cloned()
        .unwrap();
    assert_eq!(cycle.kind(), CycleKind::PureSlip);
    for part in [1e-3, 0.1, 0.9, 0.999, 1.0, 1.001, 1.1] {
        // Where its velocity is greatest.
        let v = part * cycle.max_velocity();
        let start = State::new(friction(v) - 2.0 * system.damping() * v, v);
        let end = attractor(&system, start).unwrap();
        assert_eq!(end, Attractor::Cycle(cycle.clone()), "{part}");
    }
}

/// Of three cycles of pure slip, each within the next, the one in the middle repels; what is
/// released from stick comes in to the outermost.
#[test]
fn motions_between_pure_slip_cycles_end_on_their_neighbours() {
    for unit in [1.0, 1.0 / 16.0] {
        let system = on_belt(nested(unit), unit, 0.0, unit);
        let cycles = limit_cycle::find(&system).unwrap();
        let [&inner, &middle, &outer] = exactly(&cycles.iter().collect::<Vec<_>>());
        assert!(inner.is_stable() && !middle.is_stable() && outer.is_stable());
        let peaks = [inner, middle, outer].map(LimitCycle::max_velocity);
        for (peak, square) in std::iter::zip(peaks, [0.1_f64, 0.3, 0.6]) {
            let averaged = square.sqrt() * unit;
            assert_abs_diff_eq!(peak, averaged, epsilon = 1e-3 * averaged);
        }
        let from = |velocity: f64| {
            let displacement = unit * system.law().kinetic(unit - velocity);
            attractor(&system, State::new(displacement, velocity)).unwrap()
        };
        for (velocity, end) in [
            (0.01 * unit, inner),
            (0.5 * (peaks[0] + peaks[1]), inner),
            (peaks[1] * (1.0 - 1e-10), inner),
            (peaks[1] * (1.0 + 1e-10), outer),
            (0.5 * (peaks[1] + peaks[2]), outer),
            (0.95 * unit, outer),
        ] {
            assert_eq!(from(velocity), Attractor::Cycle(end.clone()), "{velocity}");
        }
        assert_eq!(from(peaks[1]), Attractor::Separatrix(middle.clone()));
        let stuck = State::new(0.0, unit);
        let end = attractor(&system, stuck).unwrap();
        assert_eq!(end, Attractor::Cycle(outer.clone()));
    }
}

/// Slope of friction about the sliding speed 1, in units of speed: with no damping, motions round
/// it of amplitude A grow over a turn by about −π (A² − 0.1)(A² − 0.3)(A² − 0.6)/100.
fn nested(unit: f64) -> Polynomials {
    // The mean of cos²ᵏ over a turn is 1/2, 3/8, 5/16, 35/128.
    let [x, x3, x5, x7] = [-0.018, 0.27 / 3.0 * 4.0, -8.0 / 5.0, 64.0 / 35.0];
    let mut coefficients = [40.0, x, 0.0, x3, 0.0, x5, 0.0, x7];
    for (power, c) in (0..).zip(&mut coefficients) {
        *c *= 0.01 / unit.powi(power);
    }
    Polynomials::about(unit, 0.5, &coefficients)
}

friction_law! {
    /// Friction about two sliding speeds only: at 0.1 it brakes more than it drives on a belt of
    /// velocity 1, at 0.8 it drives until the mass overtakes the belt by as much.
    Bumps { unit }: 0.01,
    |s| {
        let bump = |at: f64, width: f64| (-((s / unit - at) / width).square()).exp();
        bump(0.1, 0.02) * 0.15 + bump(0.8, 0.1) * 0.3
    }
}

/// Of three cycles that cross the belt velocity, each within the next, the one in the middle
/// repels: motions end on its neighbours.
#[test]
fn motions_between_crossing_cycles_end_on_their_neighbours() {
    let cases = [(1.0, 0.0), (1.0 / 1024.0, 1e-5)];
    for (unit, damping) in some(1, cases) {
        let system = on_belt(Bumps { unit }, unit, damping, 0.02 * unit);
        let cycles = limit_cycle::find(&system).unwrap();
        let crossing: Vec<_> = cycles
            .iter()
            .filter(|cycle| cycle.kind() == CycleKind::Crossing)
            .collect();
        let [&inner, &middle, &outer] = exactly(&crossing);
        assert!(inner.is_stable() && !middle.is_stable() && outer.is_stable());
        let place = |cycle: &LimitCycle| cycle.state().displacement;
        let from = |displacement: f64| attractor(&system, State::new(displacement, unit)).unwrap();
        for (start, end) in [
            (0.001 * place(inner) + 0.999 * place(middle), inner),
            (place(middle) * (1.0 - 1e-9), inner),
            (place(middle) * (1.0 + 1e-9), outer),
            (0.999 * place(middle) + 0.001 * place(outer), outer),
            (place(outer), outer),
            (1.5 * place(outer), outer),
        ] {
            assert_eq!(from(start), Attractor::Cycle(end.clone()), "{start}");
        }
        assert_eq!(from(place(middle)), Attractor::Separatrix(middle.clone()));
    }
}

/// Friction that rounding hides, without damping: whether the motions are periodic can't be told,
/// and is not called a family.
#[test]
fn friction_below_rounding_is_unresolved() {
    let law = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    let system = on_belt(law, 0.2, 0.0, 1e-20);
    let cycles = limit_cycle::find(&system).unwrap();
    assert_eq!(cycles.continuum(), None);
    let [range] = exactly(cycles.unresolved());
    for displacement in [0.01, 0.1, 1.0] {
        let end = attractor(&system, State::new(displacement, 0.0)).unwrap();
        assert_eq!(end, Attractor::Unresolved, "{displacement}");
    }
    assert!(0.0 < range.start && range.start < 1e-3, "{range:?}");
    assert!((range.end - 0.2).abs() < 1e-14, "{range:?}");
}

/// Friction is constant to within 1e-5 of the belt velocity, less than any cycle that is looked
/// for, and varies beyond.
#[test]
fn a_narrow_flat_part_of_a_law_is_a_narrow_family() {
    let law = Tabulated::new([(0.0, 0.5), (0.99999, 0.4), (1.00001, 0.4), (2.0, 0.35)]);
    let system = MassOnBelt::new(law.unwrap(), 1.0).unwrap();
    let cycles = limit_cycle::find(&system).unwrap();
    let amplitude = cycles.continuum().unwrap().max_amplitude;
    assert!((amplitude - 1e-5).abs() < 1e-15, "{amplitude}");
    assert!(cycles.unresolved().is_empty(), "{:?}", cycles.unresolved());
}

#[test]
fn what_is_released_may_come_to_rest_or_move_on_as_it_is() {
    let from_stick = |system: &MassOnBelt<Coulomb>| {
        attractor(system, State::new(0.0, system.belt_velocity())).unwrap()
    };
    let constant = MassOnBelt::new(Coulomb::new(0.4, 0.4).unwrap(), 0.2).unwrap();
    assert_eq!(from_stick(&constant), Attractor::Continuum);
    assert_eq!(
        from_stick(&constant.with_damping(0.01).unwrap()),
        Attractor::Equilibrium
    );
    let sliding = paper(0.46);
    let end = attractor(&sliding, State::new(0.0, 0.46)).unwrap();
    assert_eq!(end, Attractor::Equilibrium);
}

friction_law! {
    /// No static friction, and kinetic friction that rises with the sliding speed and falls again,
    /// as of a lubricated contact: μ_s = 0 is a law like any.
    Lubricated { static_coefficient }: static_coefficient,
    |s| s * 0.5 * (s.square() * -2.0).exp() + s * 0.01 + static_coefficient
}

#[test]
fn cycles_without_static_friction() {
    let [none, least] = [0.0, 1e-300]
        .map(|static_coefficient| on_belt(Lubricated { static_coefficient }, 1.0, 0.002, 1.0));
    let found = [&none, &least].map(|system| limit_cycle::find(system).unwrap());
    for cycles in &found {
        assert_eq!(cycles.len(), 1);
        let cycle = cycles.stable().next().unwrap();
        assert_eq!(cycle.kind(), CycleKind::Crossing);
        // It is the motion after a long time.
        let motion = none.simulate(cycle.state(), 20.0 * cycle.period()).unwrap();
        let end = motion.last();
        assert!((end.displacement - cycle.state().displacement).abs() < 1e-12);
    }
    let [a, b] = found.each_ref().map(|cycles| cycles.iter().next().unwrap());
    assert_abs_diff_eq!(a.period(), b.period(), epsilon = 1e-13);
    assert_abs_diff_eq!(a.amplitude(), b.amplitude(), epsilon = 1e-13);
    for start in [0.1, 3.0] {
        let end = attractor(&none, State::new(start, 0.0)).unwrap();
        assert_eq!(end, Attractor::Cycle(a.clone()), "{start}");
    }
}

/// As many cycles as averaging finds, and near them: none, one of pure slip or crossing, or a
/// repelling one within.
#[test]
fn cycles_without_static_friction_are_those_that_averaging_finds() {
    let law = Lubricated {
        static_coefficient: 0.0,
    };
    let mut counts = [0; 3];
    let belts = [0.3, 0.8, 1.5, 0.1, 0.5, 0.6, 1.0, 3.0];
    for v_b in some(3, belts) {
        for damping in [0.0, 0.002, 0.02, 0.1, 0.3] {
            let system = on_belt(law, v_b, damping, 1.0);
            let averaged = averaging::cycles(&system).unwrap();
            let found = limit_cycle::find(&system).unwrap();
            assert!(found.unresolved().is_empty(), "{v_b} {damping}");
            assert_eq!(found.len(), averaged.len(), "{v_b} {damping}");
            for (cycle, averaged) in std::iter::zip(&found, &averaged) {
                let apart = cycle.max_velocity() / averaged.amplitude() - 1.0;
                assert!(apart.abs() < 0.01, "{v_b} {damping}: {apart}");
                assert_eq!(cycle.is_stable(), averaged.is_stable());
            }
            counts[found.len()] += 1;
        }
    }
    let enough = count(1, 2);
    assert!(counts.iter().all(|&n| n >= enough), "{counts:?}");
}

/// Every motion of a mass without friction and damping is periodic, on any belt and of any size.
#[test]
fn motions_without_friction_are_periodic() {
    for v_b in [0.2, -0.2, 0.0] {
        let free = MassOnBelt::new(Coulomb::new(0.0, 0.0).unwrap(), v_b).unwrap();
        let family = limit_cycle::find(&free).unwrap().continuum().unwrap();
        assert_eq!(family.max_amplitude, f64::INFINITY);
        for (u, v) in [(0.1, 0.0), (2.0, 0.0), (3.0, 0.1), (0.0, 0.5), (0.0, 30.0)] {
            let end = attractor(&free, State::new(u, v)).unwrap();
            assert_eq!(end, Attractor::Continuum, "{v_b}: {u} {v}");
        }
        let damped = free.with_damping(0.1).unwrap();
        assert_eq!(limit_cycle::find(&damped).unwrap().continuum(), None);
    }
    // Static friction alone, on a belt at rest: it holds what turns inside the band.
    let held = MassOnBelt::new(Coulomb::new(0.4, 0.0).unwrap(), 0.0).unwrap();
    let from = |system: &MassOnBelt<Coulomb>, u| attractor(system, State::new(u, 0.0)).unwrap();
    assert_eq!(from(&held, 0.39), Attractor::Rest);
    assert_eq!(from(&held, 5.0), Attractor::Continuum);
    assert_eq!(
        from(&held.with_damping(1e-3).unwrap(), 5.0),
        Attractor::Rest
    );
    let braked = MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), 0.0).unwrap();
    assert_eq!(from(&braked, 5.0), Attractor::Rest);
}

/// Friction that varies with the fifth power of v_r + v_b damps small motions by less than
/// rounding; they are no family.
#[test]
fn friction_that_varies_slowly_is_no_family() {
    let fifth = Polynomials::about(0.5, 0.4, &[0.3, 0.0, 0.0, 0.0, 0.0, 1.0]);
    let system = MassOnBelt::new(fifth, 0.5).unwrap();
    let cycles = limit_cycle::find(&system).unwrap();
    assert_eq!(cycles.continuum(), None);
    // The slope is never negative: every motion dies, the small ones by less than rounding a turn.
    assert!(cycles.is_empty() && cycles.unresolved().is_empty());
    for deviation in [1e-4, 0.1, 0.3] {
        let start = State::new(0.3 + deviation, 0.0);
        assert_eq!(attractor(&system, start).unwrap(), Attractor::Equilibrium);
    }
}

/// Motions so near the equilibrium that rounding hides how they grow leave it if it is unstable.
#[test]
fn motions_near_the_equilibrium_end_as_it_says() {
    for velocity in [1e-9, 1e-12, 1e-15] {
        let from = |v_b: f64| {
            let system = paper(v_b);
            let place = system.law().kinetic(v_b - velocity) - 2.0 * system.damping() * velocity;
            attractor(&system, State::new(place, velocity)).unwrap()
        };
        // Steady sliding becomes stable at 0.44096.
        assert!(matches!(from(0.43), Attractor::Cycle(_)), "{velocity}");
        assert_eq!(from(0.45), Attractor::Equilibrium, "{velocity}");
    }
}

/// Where rounding hides how a motion near a cycle grows, it is on the cycle: a stable one, of
/// multiplier just below 1.
#[test]
fn motions_within_rounding_of_a_nearly_neutral_cycle_are_on_it() {
    let system = paper(0.4409);
    let cycles = limit_cycle::find(&system).unwrap();
    let cycle = cycles.stable().next().unwrap();
    let attraction = 1.0 - cycle.multiplier();
    assert!(attraction < 1e-3, "{attraction}");
    for part in [-1e-9, -1e-10, -1e-11, 1e-11, 1e-10, 1e-9] {
        let velocity = cycle.state().velocity * (1.0 + part);
        let start = State::new(cycle.state().displacement, velocity);
        let end = attractor(&system, start).unwrap();
        assert_eq!(end, Attractor::Cycle(cycle.clone()), "{part}");
    }
}
