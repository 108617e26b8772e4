//! Cycles and bifurcations in cases with a known answer, and in hard ones.

mod common;

use common::{Random, paper};
use stick_slip::analysis::coulomb;
use stick_slip::bifurcation::{grazing_velocities, hopf_velocities};
use stick_slip::limit_cycle::{self, Attractor, attractor};
use stick_slip::{
    Coulomb, CycleKind, Exponential, FrictionLaw, LimitCycle, MassOnBelt, Polynomial, Scalar, State,
};

/// The cycle costs its one slip arc: nothing is integrated before or beside it.
#[test]
fn stick_slip_takes_one_arc() {
    let cycle = limit_cycle::stick_slip(&paper(0.2)).unwrap().unwrap();
    // Nine Taylor steps, the stick phase, and what follows at the time T itself.
    assert_eq!(cycle.trajectory().steps().len(), 9 + 1 + 1);
}

#[test]
fn coulomb_ends_where_its_closed_form_says() {
    for beta in [1e-4, 1e-3, 0.01, 0.03, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9] {
        let system = MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), 1.0)
            .and_then(|system| system.with_damping(beta))
            .unwrap();
        let exact = coulomb::largest_stick_slip_velocity(&system);
        let found = grazing_velocities(&system, 0.0..2.0 * exact).unwrap();
        assert_eq!(found.len(), 1, "β = {beta}: {found:?}");
        assert!(
            (found[0] - exact).abs() <= 1e-12 * exact.max(1.0),
            "β = {beta}: {} {exact}",
            found[0]
        );
    }
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
        let system = MassOnBelt::new(law, 1.0)
            .and_then(|system| system.with_damping(random.logarithmic(0.003, 0.3)))
            .and_then(|system| system.with_load(random.logarithmic(0.1, 5.0)))
            .unwrap();
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
    let system = MassOnBelt::new(Exponential::new(0.4, 0.3, 1.0).unwrap(), 1.0)
        .and_then(|system| system.with_damping(0.02))
        .unwrap();
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

/// η = 15: the pure-slip cycle grows from nothing to the belt within a few ulps of the belt velocity.
#[test]
fn canard_like_growth_is_resolved_or_told() {
    let law = Polynomial::new(1.2, 0.2, 0.1).unwrap();
    let system = MassOnBelt::new(law, 0.05)
        .and_then(|system| system.with_damping(0.05))
        .unwrap();
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
                let system = MassOnBelt::new(Coulomb::new(mu_s, mu_k).unwrap(), v_b)
                    .and_then(|system| system.with_load(load))
                    .unwrap();
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
    let bistable = MassOnBelt::new(Exponential::new(0.6, 0.3, 0.4).unwrap(), 1.0)
        .and_then(|system| system.with_damping(0.01))
        .unwrap();
    let centre = bistable.equilibrium().unwrap().displacement;
    let is_stick_slip = |found: Attractor| matches!(found, Attractor::Cycle(cycle) if cycle.kind() == CycleKind::StickSlip);
    // In stick, behind the belt on both sides of the unstable cycle, above the belt velocity, far out.
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
    let crossing = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5).unwrap(), 0.25)
        .and_then(|system| system.with_damping(0.0004))
        .and_then(|system| system.with_load(0.01))
        .unwrap();
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
    let system = MassOnBelt::new(Coulomb::new(0.3, 1e-10).unwrap(), 1e-300)
        .and_then(|system| system.with_damping(0.02))
        .unwrap();
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

/// Friction about two sliding speeds only: at 0.1 it brakes more than it drives on a belt of velocity 1, at 0.8 it drives until the mass
/// overtakes the belt by as much.
#[derive(Debug, Clone, Copy)]
struct Bumps;

impl FrictionLaw for Bumps {
    fn static_coefficient(&self) -> f64 {
        0.01
    }
    fn kinetic<S: Scalar>(&self, s: S) -> S {
        let near = (-((s - 0.1) / 0.02).square()).exp() * 0.15;
        let far = (-((s - 0.8) / 0.1).square()).exp() * 0.3;
        near + far
    }
}

/// Of three cycles that cross the belt velocity, each within the next, the one in the middle repels: motions end on its neighbours.
#[test]
fn motions_between_crossing_cycles_end_on_their_neighbours() {
    let system = MassOnBelt::new(Bumps, 1.0)
        .and_then(|system| system.with_load(0.02))
        .unwrap();
    let cycles = limit_cycle::find(&system).unwrap();
    let crossing: Vec<_> = cycles
        .iter()
        .filter(|cycle| cycle.kind() == CycleKind::Crossing)
        .collect();
    let [inner, middle, outer] = crossing[..] else {
        panic!("{} crossing cycles", crossing.len())
    };
    assert!(inner.is_stable() && !middle.is_stable() && outer.is_stable());
    let place = |cycle: &LimitCycle| cycle.state().displacement;
    let from = |displacement: f64| attractor(&system, State::new(displacement, 1.0)).unwrap();
    let inside = 0.001 * place(inner) + 0.999 * place(middle);
    assert_eq!(from(inside), Attractor::Cycle(inner.clone()));
    let outside = 0.999 * place(middle) + 0.001 * place(outer);
    assert_eq!(from(outside), Attractor::Cycle(outer.clone()));
    assert_eq!(from(1.5 * place(outer)), Attractor::Cycle(outer.clone()));
    assert_eq!(from(place(outer)), Attractor::Cycle(outer.clone()));
    assert_eq!(from(place(middle)), Attractor::Separatrix(middle.clone()));
}
