//! Attractors of motions, compared with simulation.

use super::*;
use crate::friction::{Coulomb, Stribeck};
use crate::numerics::testing::some;

#[test]
fn basins_are_those_of_the_attractor_and_of_long_simulations() {
    let law = Stribeck::new(1.0, 0.5, 0.5, 1).unwrap();
    for v_b in some(1, [-1.5, 1.5]) {
        let system = MassOnBelt::new(law, v_b)
            .unwrap()
            .with_damping(0.05)
            .unwrap();
        let basins = basins(&system).unwrap();
        assert_eq!(basins.cycles(), &super::super::find(&system).unwrap());
        let mut slide = 0;
        for (i, j) in (0..9).flat_map(|i| (0..5).map(move |j| (i, j))) {
            let u = -2.0 + 0.5 * f64::from(i) + 0.013;
            let start = State::new(u, v_b.signum() * (0.5 * f64::from(j) + 0.017));
            let reached = basins.attractor(start).unwrap();
            assert_eq!(attractor(&system, start).unwrap(), reached);
            // After 400 units of time every transient is over, and steady sliding is at rest.
            let end = system.simulate(start, 400.0).unwrap().last();
            let rests = end.velocity.abs() < 1e-3;
            assert_eq!(reached == Attractor::Equilibrium, rests, "{start:?}");
            slide += usize::from(rests);
        }
        assert!((5..40).contains(&slide), "{slide}");
    }
}

#[test]
fn a_start_that_is_not_finite_is_refused() {
    let system = MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), 0.2).unwrap();
    let basins = basins(&system).unwrap();
    for start in [State::new(f64::NAN, 0.0), State::new(0.0, f64::INFINITY)] {
        assert!(matches!(
            basins.attractor(start),
            Err(Error::InvalidState { .. })
        ));
    }
}

#[test]
fn where_rounding_hides_the_growth_of_a_motion_averaging_tells_where_it_ends() {
    for (damping, reached) in [(1e-18, Attractor::Equilibrium), (0.0, Attractor::Continuum)] {
        let system = MassOnBelt::new(Coulomb::new(0.4, 0.4).unwrap(), 0.2).unwrap();
        let system = system.with_damping(damping).unwrap();
        let rest = system.equilibrium().unwrap().displacement;
        for velocity in [1e-6, 0.1, 0.199] {
            assert_eq!(
                attractor(&system, State::new(rest, velocity)).unwrap(),
                reached
            );
        }
    }
}

#[test]
fn a_start_costs_at_most_four_simulated_periods() {
    // μ̂ = 0.5 + 0.5 e^(−2s), starts in [−2, 2] × [0, 2].
    let law = Stribeck::new(1.0, 0.5, 0.5, 1).unwrap();
    let system = MassOnBelt::new(law, 1.5)
        .unwrap()
        .with_damping(0.05)
        .unwrap();
    let basins = basins(&system).unwrap();
    let stick_slip = basins.cycles().stable().next().unwrap();
    let period = system
        .simulate(stick_slip.state(), stick_slip.period())
        .unwrap();
    let (nest, forward) = (&basins.nest, Forward::of(system.belt()).unwrap());
    let mut tracer = Tracer::new(forward);
    let mut starts = 0;
    for (i, j) in (0..40).flat_map(|i| (0..20).map(move |j| (i, j))) {
        let start = State::new(-2.0 + 0.1 * f64::from(i), 0.1 * f64::from(j));
        nest.reached_from(nest.bounds.as_ref().unwrap(), &mut tracer, start)
            .unwrap();
        starts += 1;
    }
    // Counted in Taylor steps, which take nearly all of the time.
    let steps = period.steps().len();
    assert!(
        tracer.work() <= 4 * steps * starts,
        "{} {steps}",
        tracer.work() / starts
    );
}
