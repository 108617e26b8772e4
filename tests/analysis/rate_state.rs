//! Formulas of rate-and-state friction, against integrations of the law's own rates.

use stick_slip::analysis::rate_state::{
    first_integral, healing, stress_drop, time_to_instability, velocity_step,
};
use stick_slip::{ContactLaw, Error, Motion, RateState, Slip};

use crate::common::Random;

type Made = fn(f64, f64, f64, f64, f64) -> Result<RateState, Error>;

/// The aging law and the slip law.
const LAWS: [Made; 2] = [RateState::aging, RateState::slip];

fn sliding(speed: f64) -> Slip<f64> {
    Slip {
        speed,
        direction: 1.0,
        piece: 0,
    }
}

fn rate(law: &RateState, v: f64, phi: f64) -> f64 {
    law.rates(Motion::Slip(sliding(v)), 1.0, [phi])[0]
}

/// Classical Runge-Kutta steps from x = 0.
fn integrate<const N: usize>(
    f: impl Fn([f64; N]) -> [f64; N],
    start: [f64; N],
    h: f64,
    steps: usize,
) -> [f64; N] {
    let plus = |y: [f64; N], h: f64, d: [f64; N]| std::array::from_fn(|i| y[i] + h * d[i]);
    (0..steps).fold(start, |y, _| {
        let k1 = f(y);
        let k2 = f(plus(y, h / 2.0, k1));
        let k3 = f(plus(y, h / 2.0, k2));
        let k4 = f(plus(y, h, k3));
        std::array::from_fn(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]))
    })
}

/// The speed falls by up to 17 decades at once: the direct effect, and nothing of the state yet.
#[test]
fn velocity_steps_down_are_exact() {
    for law in LAWS.map(|law| law(0.6, 0.01, 0.015, 1e-5, 1e-6).unwrap()) {
        for v2 in [1e-3, 1e-12, 1e-14, 1e-16, 1e-17] {
            let expected = law.coefficient(sliding(v2), [law.memory_at(1.0)]);
            let found = velocity_step(&law, 1.0, v2, 0.0);
            assert!((found - expected).abs() < 1e-15, "{v2}: {found} {expected}");
        }
    }
}

#[test]
fn velocity_steps_follow_the_rates_of_the_law() {
    let mut random = Random::new(1);
    for _ in 0..30 {
        let (a, b) = (
            random.logarithmic(1e-3, 0.02),
            random.logarithmic(1e-3, 0.02),
        );
        let (d_c, v0) = (
            random.logarithmic(1e-6, 1e-2),
            random.logarithmic(1e-9, 1e-3),
        );
        let [v1, v2] = [(); 2].map(|()| v0 * random.logarithmic(0.1, 10.0));
        for law in LAWS.map(|law| law(0.6, a, b, d_c, v0).unwrap()) {
            let slip = d_c * random.uniform(0.1, 2.0);
            let steps = 20_000;
            // At first the state may relax over a hundredth of D_c.
            let start = [law.memory_at(v1)];
            let by_slip = |[phi]: [f64; 1]| [rate(&law, v2, phi) / v2];
            let [phi] = integrate(by_slip, start, slip / steps as f64, steps);
            let expected = law.coefficient(sliding(v2), [phi]);
            let found = velocity_step(&law, v1, v2, slip);
            assert!(
                (found - expected).abs() < 1e-8 * b,
                "{law:?} {v1} {v2}: {found} {expected}"
            );
            assert!(
                (velocity_step(&law, v1, v2, 0.0) - law.steady(v1) - a * (v2 / v1).ln()).abs()
                    < 1e-14
            );
            assert!((velocity_step(&law, v1, v2, 800.0 * d_c) - law.steady(v2)).abs() < 1e-14);
            assert!((velocity_step(&law, v1, v1, slip) - law.steady(v1)).abs() < 1e-14);
        }
    }
    // With two state variables the steps add up.
    let law = RateState::slip(0.6, 0.01, 0.012, 1e-5, 1e-6).unwrap();
    let both = law.with_second_state(0.004, 1e-4).unwrap();
    let second = RateState::slip(0.0, 0.01, 0.004, 1e-4, 1e-6).unwrap();
    for slip in [0.0, 1e-6, 3e-5, 2e-4] {
        let of_states =
            |law: &RateState| velocity_step(law, 1e-6, 1e-4, slip) - 0.01 * 100_f64.ln();
        let expected = 0.01 * 100_f64.ln() + of_states(&law) + of_states(&second);
        // arsinh is no logarithm for f₀ = 0.
        let found = velocity_step(&both, 1e-6, 1e-4, slip);
        assert!((found - expected).abs() < 2e-4, "{found} {expected}");
    }
    assert!(velocity_step(&law, -1e-6, 1e-6, 1e-6).is_nan());
}

/// Beside the logarithm arsinh adds a e^{−2μ/a}, to first order.
#[test]
fn steady_friction_is_logarithmic_to_the_stated_error() {
    let mut random = Random::new(3);
    for _ in 0..100 {
        let (a, ratio) = (random.logarithmic(1e-3, 1.0), random.uniform(2.0, 9.0));
        let b = a * random.uniform(0.1, 2.0);
        let law = RateState::aging(ratio * a, a, b, 1e-5, 1e-6).unwrap();
        let speed = 1e-6 * random.uniform(0.8, 1.2);
        let logarithmic = ratio * a + (a - b) * (speed / 1e-6).ln();
        let stated = a * (-2.0 * logarithmic / a).exp();
        let error = law.steady(speed) - logarithmic;
        assert!(
            (0.9 * stated - 1e-15..=stated + 1e-15).contains(&error),
            "{law:?}: {error:e} {stated:e}"
        );
    }
}

#[test]
fn steps_of_the_slip_law_are_symmetric() {
    let [aging, slip] = LAWS.map(|law| law(0.6, 0.01, 0.015, 1e-5, 1e-6).unwrap());
    let asymmetry = |law: &RateState| {
        let up = velocity_step(law, 1e-6, 1e-5, 1e-5) - law.steady(1e-5);
        let down = velocity_step(law, 1e-5, 1e-6, 1e-5) - law.steady(1e-6);
        up + down
    };
    assert!(asymmetry(&slip).abs() < 1e-15);
    assert!(asymmetry(&aging) > 1e-3);
}

#[test]
fn holds_heal_by_the_rates_at_rest() {
    let law = RateState::aging(0.6, 0.01, 0.015, 1e-5, 1e-6).unwrap();
    let at_rest = |[phi]: [f64; 1]| [law.rates(Motion::Stick, 1.0, [phi])[0]];
    for hold in [1.0, 10.0, 200.0] {
        let [phi] = integrate(at_rest, [0.0], hold / 1e4, 10_000);
        assert!((healing(&law, hold) - 0.015 * phi).abs() < 1e-13);
    }
    let two = law.with_second_state(0.004, 1e-4).unwrap();
    let expected = healing(&law, 100.0) + 0.004 * 2_f64.ln();
    assert!((healing(&two, 100.0) - expected).abs() < 1e-16);
    let slip = RateState::slip(0.6, 0.01, 0.015, 1e-5, 1e-6).unwrap();
    assert_eq!((healing(&slip, 1e9), healing(&law, 0.0)), (0.0, 0.0));
}

/// The time until the speed has grown by e³⁶, or has its maximum, by the balance of forces without
/// inertia, N(aV'/V + bφ') = τ' − kV, over the slip.
fn time_to_the_largest_speed(
    law: &RateState,
    [load, stiffness, load_rate]: [f64; 3],
    [v, phi]: [f64; 2],
) -> f64 {
    let sliding = |speed: f64, phi: f64| law.coefficient(sliding(speed), [phi]);
    // The coefficients a and b, far from rest.
    let a = (sliding(4.0 * v, phi) - sliding(2.0 * v, phi)) / 2_f64.ln();
    let b = sliding(v, phi + 1.0) - sliding(v, phi);
    let by_slip = |[_, ln_v, phi]: [f64; 3]| {
        let v = ln_v.exp();
        let healing = rate(law, v, phi);
        [
            1.0 / v,
            ((load_rate / v - stiffness) / load - b * healing / v) / a,
            healing / v,
        ]
    };
    let mut at = [0.0, v.ln(), phi];
    while at[1] < v.ln() + 36.0 {
        let [_, faster, healing] = by_slip(at);
        if faster <= 0.0 {
            break;
        }
        at = integrate(by_slip, at, 0.02 / (faster + healing.abs()), 1);
    }
    at[0]
}

/// The relative error has the order that is stated, below the critical stiffness and above.
#[test]
fn self_acceleration_takes_the_time_of_the_formula() {
    let mut random = Random::new(2);
    let mut orders = [0; 3];
    for _ in 0..60 {
        let (a, b) = (random.uniform(0.002, 0.02), random.uniform(0.002, 0.02));
        let (d_c, v) = (
            random.logarithmic(1e-6, 1e-2),
            random.logarithmic(1e-9, 1e-3),
        );
        let law = RateState::aging(0.6, a, b, d_c, random.logarithmic(0.1, 10.0) * v).unwrap();
        let load = random.logarithmic(1e3, 1e8);
        // H D_c
        let growth = random.uniform(0.05, 1.0) * b;
        let stiffness = load * (b - growth) / d_c;
        let load_rate = random.pick(&[-0.2, 0.0, 0.1, 10.0]) * growth / d_c * load * v;
        let p = if growth < a {
            growth / (a - growth)
        } else {
            2.0
        };
        // Where p is 1 the order is reached late, and where it is small.
        if (0.7..1.5).contains(&p) || p < 0.2 {
            continue;
        }
        let found = time_to_instability(&law, load, stiffness, v, load_rate).unwrap();
        let error = |distance: f64| {
            let start = [v, law.memory_at(v) + distance.ln()];
            (found / time_to_the_largest_speed(&law, [load, stiffness, load_rate], start) - 1.0)
                .abs()
        };
        let order = (error(1e5) / error(1e8)).log10() / 3.0;
        let stated = p.min(1.0);
        assert!(
            (order - stated).abs() < 0.1,
            "{law:?} {stiffness} {load} {load_rate}: {order} {stated}"
        );
        orders[usize::from(growth < a) + usize::from(p < 1.0)] += 1;
    }
    assert!(orders.iter().all(|&count| count > 5), "{orders:?}");
    let (load, stiffness, v) = (5e6, 5e9, 1e-9);
    let law = RateState::aging(0.6, 0.01, 0.015, 1e-5, 1e-6).unwrap();
    let slip = RateState::slip(0.6, 0.01, 0.015, 1e-5, 1e-6).unwrap();
    assert_eq!(time_to_instability(&slip, load, stiffness, v, 0.0), None);
    // Above the stiffness Nb/D_c nothing accelerates.
    assert_eq!(time_to_instability(&law, load, 7.6e9, v, 0.0), None);
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(
            time_to_instability(&law, load, stiffness, wrong, 1.0),
            None,
            "{wrong}"
        );
    }
}

/// Constant along motions of both laws at the critical stiffness, by the same balance of forces.
#[test]
fn first_integrals_are_constant() {
    let (a, b, d_c, v_p) = (0.01, 0.015, 1e-5, 2e-7);
    for law in LAWS.map(|law| law(0.6, a, b, d_c, 1e-6).unwrap()) {
        let in_time = |[ln_v, phi]: [f64; 2]| {
            let v = f64::exp(ln_v);
            let phi_rate = rate(&law, v, phi);
            let critical = (b - a) / d_c;
            [(critical * (v_p - v) - b * phi_rate) / a, phi_rate]
        };
        for above in [-0.4, 0.3, 0.6] {
            let mut at = [v_p.ln() + above, law.memory_at(v_p)];
            let first = first_integral(&law, v_p, at[0].exp(), at[1]).unwrap();
            let steady = first_integral(&law, v_p, v_p, law.memory_at(v_p)).unwrap();
            assert!(first > steady + 1e-4);
            let mut fastest = 0.0_f64;
            // Three oscillations of the period 2π(D_c/V)√(a/(b − a)).
            for _ in 0..30 {
                at = integrate(in_time, at, 45.0 * d_c / v_p / 3e4, 1000);
                fastest = fastest.max(at[0].exp() / v_p);
                let now = first_integral(&law, v_p, at[0].exp(), at[1]).unwrap();
                assert!((now - first).abs() < 1e-11, "{above}: {now} {first}");
            }
            assert!(fastest > 1.2);
        }
    }
    // Beyond the border of run-away.
    let slip = RateState::slip(0.6, a, b, d_c, 1e-6).unwrap();
    assert_eq!(
        first_integral(&slip, v_p, 1e3 * v_p, slip.memory_at(v_p)),
        None
    );
    assert_eq!(first_integral(&slip, v_p, -v_p, 0.0), None);
}

#[test]
fn stress_drops_are_the_fall_of_steady_friction() {
    let law = RateState::slip(0.6, 0.01, 0.015, 1e-5, 1e-6).unwrap();
    let drop = stress_drop(&law, 2.0, 1e-9, 1e-2);
    assert!((drop - 2.0 * (law.steady(1e-9) - law.steady(1e-2))).abs() < 1e-15);
    let two = law.with_second_state(-0.003, 1e-4).unwrap();
    let drop = stress_drop(&two, 2.0, 1e-9, 1e-2);
    assert!((drop - 2.0 * (two.steady(1e-9) - two.steady(1e-2))).abs() < 1e-15);
}
