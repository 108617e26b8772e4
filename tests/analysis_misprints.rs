//! What the source paper prints wrongly, as far as it can be contradicted without a motion: one test for each.

mod common;

use common::paper;
use stick_slip::analysis::averaging::{cycles, drift};
use stick_slip::analysis::{PureSlip, Regime, StickSlip, equilibrium, regime};
use stick_slip::{Exponential, FrictionLaw, MassOnBelt, Stability, State};

#[test]
fn misprint_eq_2_stick_condition_has_gamma_squared_and_two_sides() {
    let system = paper(0.2).with_load(2.0).unwrap();
    let [low, high] = system.stick_limits();
    // Printed: 2βv_b + u ≤ μ_s. At its limit the mass is well inside the band, and far below it, outside.
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
    assert!((formulas.h2() - even).abs() < 1e-13);
    let printed = -formulas.eta() * (0.4_f64 / 0.5).powi(2);
    assert!((printed - even).abs() > 0.4);
    for y in [-0.3, -0.1, 0.2, 0.399] {
        let cubic = ((formulas.h3() * y + formulas.h2()) * y + formulas.h1()) * y;
        assert!((cubic - h(y)).abs() < 1e-15);
    }
}

#[test]
fn misprint_section_4_1_1_pure_slip_is_a_condition_on_the_relative_velocity() {
    // Printed: ż < 0 all the time. The velocity of a periodic motion has both signs; it stays below v_b.
    let cycle = PureSlip::new(&paper(0.4)).unwrap().fourth_order().unwrap();
    assert!(cycle.v_min < 0.0 && 0.0 < cycle.v_max && cycle.v_max < 0.4);
}

#[test]
fn misprint_eq_13_amplitude_has_4_over_3() {
    let system = paper(0.42);
    let formulas = PureSlip::new(&system).unwrap();
    let ratio = -formulas.h1() / formulas.h3();
    let (corrected, printed) = ((4.0 / 3.0 * ratio).sqrt(), (0.75 * ratio).sqrt());
    assert!((formulas.amplitude().unwrap() - corrected).abs() < 1e-15);
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
    assert!((touching.amplitude().unwrap() - v_b0).abs() < 1e-15);
    assert!(formulas.is_valid(), "Fig. 4, v_b = 0.4, is pure slip");
    // The better grazing velocity lies where the formula for its error says: relative O(q²) above v_b0.
    let q = 0.8 * formulas.eta() * (v_b1 / 0.5).powi(2);
    let shift = formulas.grazing_velocity().unwrap() / v_b0 - 1.0;
    assert!((shift / (q * q) - 3461.0 / 76800.0).abs() < 1e-12);
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
    // The arc meets the belt at −κv_b; slip gains W1 v_b² meanwhile, so it must meet it much farther out.
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
        let system = MassOnBelt::new(law, v_b)
            .unwrap()
            .with_damping(0.05)
            .unwrap();
        equilibrium(&system).unwrap().stability
    };
    assert_eq!(stability(0.05), Stability::StableFocus);
    assert_eq!(
        equilibrium(&paper(0.05)).unwrap().stability,
        Stability::UnstableFocus
    );
}
