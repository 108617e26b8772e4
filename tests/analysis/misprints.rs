//! What the source paper prints wrongly: contradicted by the formulas, and (`numerics_…`) by the
//! exact motions.

use crate::common::polynomials::{Polynomials, coefficients};
use crate::common::{exactly, on_belt, paper};
use approx::assert_abs_diff_eq;
use stick_slip::analysis::averaging::{cycles, drift};
use stick_slip::analysis::{PureSlip, Regime, StickSlip, equilibrium, regime};
use stick_slip::{CycleKind, EventKind, Exponential, FrictionLaw, Polynomial};
use stick_slip::{LimitCycle, Stability, State, bifurcation, limit_cycle};

#[test]
fn misprint_eq_2_stick_condition_has_gamma_squared_and_two_sides() {
    let system = paper(0.2).with_load(2.0).unwrap();
    let [low, high] = system.stick_limits();
    // Printed: 2βv_b + u ≤ μ_s. At its limit the mass is well inside the band, and far below it,
    // outside.
    let printed = 0.4 - 2.0 * 0.05 * 0.2;
    assert!(low < printed && printed < high);
    assert_eq!(system.acceleration(State::new(printed, 0.2)), 0.0);
    assert!(system.acceleration(State::new(-3.0, 0.2)) > 0.0);
}

#[test]
fn misprint_eq_7_equilibrium_is_friction_at_the_belt_velocity() {
    let system = paper(0.2);
    let displacement = equilibrium(&system).unwrap().displacement;
    assert_eq!(displacement, system.load() * system.law().coefficient(0.2));
    assert_eq!(system.acceleration(State::new(displacement, 0.0)), 0.0);
    // Printed: ū = γ²μ(v_r). At rest v_r = −v_b, which is the opposite sign.
    let printed = system.load() * system.law().coefficient(0.0 - 0.2);
    assert!(system.acceleration(State::new(printed, 0.0)) > 0.6);
}

#[test]
fn misprint_eq_10b_h2_has_one_power_of_the_belt_velocity() {
    let system = paper(0.4);
    let formulas = PureSlip::new(&system).unwrap();
    // h(y) at y = ±0.1, from the law itself; the even part is h2 y².
    let h = |y: f64| {
        let mu = |v_r: f64| system.law().coefficient(v_r);
        2.0 * system.damping() * y + system.load() * (mu(y - 0.4) - mu(-0.4))
    };
    let even = 0.5 * (h(0.1) + h(-0.1)) / 0.01;
    assert_abs_diff_eq!(formulas.h2(), even, epsilon = 1e-13);
    let printed = -formulas.eta() * (0.4_f64 / 0.5).powi(2);
    assert!((printed - even).abs() > 0.4);
    for y in [-0.3, -0.1, 0.2, 0.399] {
        let cubic = ((formulas.h3() * y + formulas.h2()) * y + formulas.h1()) * y;
        assert_abs_diff_eq!(cubic, h(y), epsilon = 1e-15);
    }
}

#[test]
fn misprint_section_4_1_1_pure_slip_is_a_condition_on_the_relative_velocity() {
    // Printed: ż < 0 all the time. The velocity of a periodic motion has both signs; it stays below
    // v_b.
    let cycle = PureSlip::new(&paper(0.4)).unwrap().fourth_order().unwrap();
    assert!(cycle.v_min < 0.0 && 0.0 < cycle.v_max && cycle.v_max < 0.4);
}

#[test]
fn misprint_eq_13_amplitude_has_4_over_3() {
    let system = paper(0.42);
    let formulas = PureSlip::new(&system).unwrap();
    let ratio = -formulas.h1() / formulas.h3();
    let (corrected, printed) = ((4.0 / 3.0 * ratio).sqrt(), (0.75 * ratio).sqrt());
    assert_abs_diff_eq!(formulas.amplitude().unwrap(), corrected, epsilon = 1e-15);
    // The averaged motion neither grows nor decays at the one, and grows at the other.
    assert!(drift(&system, corrected).unwrap().abs() < 1e-17);
    assert!(drift(&system, printed).unwrap() > 1e-3);
}

#[test]
fn misprint_v_b0_is_below_v_b1() {
    let formulas = PureSlip::new(&paper(0.4)).unwrap();
    let (v_b0, v_b1) = (
        formulas.stick_velocity().unwrap(),
        formulas.onset_velocity().unwrap(),
    );
    assert!(
        (4.0_f64 / 3.0).sqrt() * v_b1 > v_b1,
        "printed: above the onset of vibration"
    );
    assert!(v_b0 < v_b1);
    // At v_b0 the averaged motion just reaches the belt; between the two it does not.
    let touching = PureSlip::new(&paper(v_b0)).unwrap();
    assert_abs_diff_eq!(touching.amplitude().unwrap(), v_b0, epsilon = 1e-15);
    assert!(formulas.is_valid(), "Fig. 4, v_b = 0.4, is pure slip");
    // The better grazing velocity lies where the formula for its error says: relative O(q²) above
    // v_b0.
    let q = 0.8 * formulas.eta() * (v_b1 / 0.5).powi(2);
    let shift = formulas.grazing_velocity().unwrap() / v_b0 - 1.0;
    assert_abs_diff_eq!(shift / (q * q), 3461.0 / 76800.0, epsilon = 1e-12);
}

#[test]
fn misprint_after_eq_15_beyond_v_b1_nothing_vibrates() {
    for v_b in [0.4410, 0.6, 3.0] {
        let system = paper(v_b);
        assert_eq!(regime(&system), Regime::Equilibrium);
        assert!(equilibrium(&system).unwrap().is_stable());
        assert!(PureSlip::new(&system).unwrap().amplitude().is_none());
        assert!(cycles(&system).unwrap().is_empty());
    }
}

#[test]
fn misprint_eqs_16_to_18_arc_has_no_energy_input() {
    // The arc meets the belt at −κv_b; slip gains W1 v_b² meanwhile, so it must meet it much
    // farther out.
    let formulas = StickSlip::new(&paper(0.2)).unwrap();
    let second = formulas.second_order().unwrap();
    assert!(second.growth > 1.0);
    assert!(second.return_angle > 3.0 * formulas.kappa().atan());
}

#[test]
fn misprint_eq_6_never_rises_and_slow_belts_are_quiet() {
    let law = Exponential::new(0.4, 0.25, 0.5).unwrap();
    assert!((1..3000).all(|k| law.slope(1e-3 * f64::from(k)) < 0.0));
    let stability = |v_b: f64| {
        let system = on_belt(law, v_b, 0.05, 1.0);
        equilibrium(&system).unwrap().stability
    };
    assert_eq!(stability(0.05), Stability::StableFocus);
    assert_eq!(
        equilibrium(&paper(0.05)).unwrap().stability,
        Stability::UnstableFocus
    );
}

#[test]
fn numerics_eq_2_mass_is_released_at_gamma_squared_mu_s() {
    for load in [0.5, 2.0] {
        let system = paper(0.2).with_load(load).unwrap();
        let [low, _] = system.stick_limits();
        let motion = system.simulate(State::new(low, 0.2), 30.0).unwrap();
        let release = motion.events()[0];
        assert!(matches!(release.kind, EventKind::Release(_)));
        let force = release.state.displacement + 2.0 * 0.05 * 0.2;
        assert_abs_diff_eq!(force, load * 0.4, epsilon = 1e-14);
        // Printed: 2βv_b + u ≤ μ_s.
        assert!((force - 0.4).abs() > 0.1);
    }
    // Printed without a lower limit: but far below the band a mass that moves with the belt
    // overtakes it at once.
    let motion = paper(0.2).simulate(State::new(-3.0, 0.2), 0.1).unwrap();
    assert!(motion.events().is_empty());
    assert!(motion.last().velocity > 0.3);
}

#[test]
fn numerics_eq_7_steady_sliding_stays_where_friction_at_the_belt_velocity_puts_it() {
    let system = paper(0.46);
    let friction = system.load() * system.law().coefficient(0.46);
    let drift = |displacement: f64| {
        let last = system
            .simulate(State::new(displacement, 0.0), 20.0)
            .unwrap()
            .last();
        (last.displacement - displacement).hypot(last.velocity)
    };
    assert!(drift(friction) < 1e-14);
    // Printed: ū = γ²μ(v_r), with v_r = −v_b at rest. The mass leaves that place for good.
    assert!(drift(-friction) > 0.2);
    let settled = system.simulate(State::new(-friction, 0.0), 2000.0).unwrap();
    assert_abs_diff_eq!(settled.last().displacement, friction, epsilon = 1e-10);
}

#[test]
fn numerics_eq_10b_mean_displacement_tells_h2() {
    let system = paper(0.42);
    let formulas = PureSlip::new(&system).unwrap();
    let printed_h2 = -formulas.eta() * (0.42_f64 / 0.5).powi(2);
    // The law whose expansion at v_b has the system's h1 and h3, and the printed h2.
    let mut expansion = coefficients(system.law(), 0.42);
    expansion[2] -= printed_h2 - formulas.h2();
    let printed = on_belt(Polynomials::without_jump(0.42, &expansion), 0.42, 0.05, 1.0);
    // Time mean of z, −A h2 A/2 + O(ε³): of the motion itself, and of one that has the printed h2.
    let mean = |cycle: &LimitCycle, rest: f64| cycle.mean_displacement() - rest;
    let rest = equilibrium(&system).unwrap().displacement;
    let exact = mean(
        limit_cycle::find(&system).unwrap().iter().next().unwrap(),
        rest,
    );
    let other = mean(
        limit_cycle::find(&printed).unwrap().iter().next().unwrap(),
        rest,
    );
    let by_h2 = |h2: f64| -0.5 * formulas.amplitude().unwrap().powi(2) * h2;
    assert_abs_diff_eq!(exact / by_h2(formulas.h2()), 1.0, epsilon = 0.02);
    assert_abs_diff_eq!(other / by_h2(printed_h2), 1.0, epsilon = 0.02);
    assert!(exact > 2.0 * by_h2(printed_h2));
}

#[test]
fn numerics_eq_13_amplitude_is_that_of_4_over_3() {
    // A small load, so that averaging is good to 1e-4.
    let system = paper(0.42)
        .with_load(0.05)
        .and_then(|system| system.with_damping(0.0025))
        .unwrap();
    let formulas = PureSlip::new(&system).unwrap();
    let cycles = limit_cycle::find(&system).unwrap();
    let exact = cycles.iter().next().unwrap().amplitude();
    let ratio = -formulas.h1() / formulas.h3();
    assert_abs_diff_eq!((4.0 / 3.0 * ratio).sqrt() / exact, 1.0, epsilon = 1e-4);
    // Printed: 3/4 for 4/3, which is √(9/16) of it.
    assert_abs_diff_eq!((0.75 * ratio).sqrt() / exact, 0.75, epsilon = 1e-4);
}

#[test]
fn numerics_v_b0_is_where_the_exact_cycle_grazes_the_belt() {
    let formulas = PureSlip::new(&paper(0.4)).unwrap();
    let v_b1 = formulas.onset_velocity().unwrap();
    let printed = (4.0_f64 / 3.0).sqrt() * v_b1;
    assert!(printed > v_b1);
    let grazing = bifurcation::grazing_velocities(&paper(0.4), 0.01..1.2 * printed).unwrap();
    let [&exact] = exactly(&grazing);
    assert!(
        exact < v_b1,
        "the cycle touches the belt below the onset, and nowhere above"
    );
    // Corrected: relative error (3461/76800) q² + O(q⁴).
    let corrected = 0.8_f64.sqrt() * v_b1;
    let q = 0.8 * formulas.eta() * (v_b1 / 0.5).powi(2);
    let shift = exact / corrected - 1.0;
    assert!(
        (shift / (q * q) - 3461.0 / 76800.0).abs() < 0.1 * q * q,
        "{shift}"
    );
    // Printed as a border of stick-slip, it would make Fig. 4 (v_b = 0.4) stick.
    let cycles = limit_cycle::find(&paper(0.4)).unwrap();
    assert!(
        cycles
            .iter()
            .all(|cycle| cycle.kind() == CycleKind::PureSlip)
    );
}

#[test]
fn numerics_after_eq_15_sticking_is_below_the_range_and_quiet_above_it() {
    let formulas = PureSlip::new(&paper(0.4)).unwrap();
    let v_b1 = formulas.onset_velocity().unwrap();
    // Printed: stick-slip "beyond this range".
    for v_b in [v_b1 * 1.001, 0.5, 0.6, 1.0, 3.0] {
        let system = paper(v_b);
        assert!(equilibrium(&system).unwrap().is_stable());
        assert!(limit_cycle::find(&system).unwrap().is_empty(), "{v_b}");
        assert_eq!(limit_cycle::stick_slip(&system).unwrap(), None);
    }
    for v_b in [0.05, 0.2, 0.39] {
        let cycle = limit_cycle::stick_slip(&paper(v_b)).unwrap().unwrap();
        assert_eq!(cycle.kind(), CycleKind::StickSlip);
    }
}

#[test]
fn numerics_eqs_16_to_18_amplitude_is_off_by_the_order_of_epsilon() {
    // Fig. 5 itself: a quarter too small.
    let exact = limit_cycle::stick_slip(&paper(0.2)).unwrap().unwrap();
    let printed = StickSlip::new(&paper(0.2)).unwrap();
    assert!(exact.amplitude() > 1.3 * printed.amplitude());
    assert!(exact.stick_duration() > 2.0 * printed.stick_duration());
    // For weak friction the gap to A1 is W1 v_b/2 in half the range, ε = 1/16, 1/32, 1/64 (μ_s and
    // μ_m raised: plain stick-slip).
    let relative_gap = |epsilon: f64| {
        let system = on_belt(
            Polynomial::new(100.4, 100.25, 0.5).unwrap(),
            0.2,
            0.05 * epsilon,
            epsilon,
        );
        let exact = limit_cycle::stick_slip(&system).unwrap().unwrap();
        let formulas = StickSlip::new(&system).unwrap();
        let growth = formulas.first_order().unwrap().growth;
        (exact.amplitude() - formulas.amplitude()) / (0.5 * growth * 0.2)
    };
    let gaps = [16.0, 32.0, 64.0].map(|n: f64| (relative_gap(n.recip()) - 1.0).abs());
    assert!(gaps[0] < 0.1, "{gaps:?}");
    assert!(
        gaps[1] < 0.6 * gaps[0] && gaps[2] < 0.6 * gaps[1],
        "{gaps:?}"
    );
}

#[test]
fn numerics_eq_6_is_not_almost_similar_to_eq_3() {
    let law = Exponential::new(0.4, 0.25, 0.5).unwrap();
    let system = |v_b: f64| on_belt(law, v_b, 0.05, 1.0);
    // Printed: it "first drops off and then raises". A rise would damp, and without a damper too;
    // but it drives at every speed.
    for v_b in [0.6, 1.0, 1.5] {
        let undamped = system(v_b).with_damping(0.0).unwrap();
        assert!(!equilibrium(&undamped).unwrap().is_stable(), "{v_b}");
        let polynomial = paper(v_b).with_damping(0.0).unwrap();
        assert!(equilibrium(&polynomial).unwrap().is_stable(), "{v_b}");
    }
    // Its equilibrium is stable again on a slow belt, where nothing vibrates; that of Eq. 3 is not.
    let hopf = bifurcation::hopf_velocities(&system(0.2), 0.001..1.0).unwrap();
    assert_eq!(hopf.len(), 2);
    assert_eq!(
        bifurcation::hopf_velocities(&paper(0.2), 0.001..1.0)
            .unwrap()
            .len(),
        1
    );
    assert!(limit_cycle::find(&system(0.05)).unwrap().is_empty());
    assert_eq!(limit_cycle::find(&paper(0.05)).unwrap().len(), 1);
}

#[test]
fn numerics_section_4_2_integrals_are_computed_to_round_off() {
    // Printed: for the exponential law the "integrals are not analytically solvable". They are
    // known to all digits that a double has: here against 10⁶ points of the midpoint rule.
    let exponential = on_belt(Exponential::new(0.4, 0.25, 0.5).unwrap(), 0.4, 0.05, 1.0);
    let brute = |amplitude: f64| {
        let n = 1_000_000;
        let term = |k: u32| {
            let cosine = (std::f64::consts::TAU * (f64::from(k) + 0.5) / f64::from(n)).cos();
            let speed = 0.4 - amplitude * cosine;
            (2.0 * 0.05 * amplitude * cosine - exponential.law().coefficient(speed)) * cosine
        };
        -(0..n).map(term).sum::<f64>() / f64::from(n)
    };
    for amplitude in [0.1, 0.3, 0.399] {
        assert!((drift(&exponential, amplitude).unwrap() - brute(amplitude)).abs() < 1e-14);
    }
    let polynomial = paper(0.4);
    let formulas = PureSlip::new(&polynomial).unwrap();
    for amplitude in [0.1, 0.3, 0.399] {
        let closed = -0.5 * formulas.h1() * amplitude - 0.375 * formulas.h3() * amplitude.powi(3);
        assert!((drift(&polynomial, amplitude).unwrap() - closed).abs() < 1e-16);
    }
    // And they predict the exact cycle of weak friction, with the error O(ε²) of averaging.
    let error = |epsilon: f64| {
        let weak = exponential
            .with_belt_velocity(0.4)
            .and_then(|system| system.with_damping(0.12 * epsilon))
            .and_then(|system| system.with_load(epsilon))
            .unwrap();
        let averaged = cycles(&weak).unwrap();
        let exact = limit_cycle::find(&weak).unwrap();
        let [averaged, exact] = [
            averaged[0].amplitude(),
            exact.iter().next().unwrap().amplitude(),
        ];
        (averaged / exact - 1.0).abs()
    };
    let errors = [0.25, 0.125, 0.0625].map(error);
    assert!(
        errors[2] < 1e-3 && (errors[1] / errors[2]).log2() > 1.9,
        "{errors:?}"
    );
}

#[test]
fn misprint_fig_3_concavity_changes_at_the_stribeck_velocity_over_root_two() {
    let (v_s, law) = (0.5, Exponential::new(0.4, 0.25, 0.5).unwrap());
    let turn = v_s * std::f64::consts::FRAC_1_SQRT_2;
    assert!(law.curvature(turn).abs() < 1e-14);
    assert!(law.curvature(0.99 * turn) < -1e-3 && law.curvature(1.01 * turn) > 1e-3);
    // Printed: at v_s, where the curve has long been convex.
    assert!(law.curvature(v_s) > 0.4);
}
