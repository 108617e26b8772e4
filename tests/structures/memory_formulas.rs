//! Closed formulas for contacts that remember, against motions and reference data.

use serde_json::Value;
use stick_slip::analysis::coulomb;
use stick_slip::analysis::dwell::DwellOscillator;
use stick_slip::analysis::lugre::{contact_vibration, passive_viscosity, steady_bristles};
use stick_slip::structure::State;
use stick_slip::{
    AnyLaw, Contact, ContactLaw, Coulomb, Dwell, EventKind, Exponential, FrictionLaw, LuGre,
    MassOnBelt, Motion, Polynomial, Slip, Tabulated,
};

use crate::common::{assert_met, dwelling, larger, list, number, one_mass, text};
use crate::reading::cases;

/// The same oscillator in the units of nobody.
fn oscillator(law: Dwell<Coulomb>, damping_ratio: f64) -> DwellOscillator {
    let (mass, stiffness) = (2.0, 18.0);
    DwellOscillator {
        law,
        mass,
        stiffness,
        damping: 2.0 * damping_ratio * f64::sqrt(mass * stiffness),
        load: 7.0,
    }
}

/// Laws of each form, with and without a jump from kinetic to static friction.
fn laws() -> Vec<Dwell<Coulomb>> {
    let mut laws = Vec::new();
    for jump in [0.0, 0.05] {
        let law = Coulomb::new(0.3 + jump, 0.3).unwrap();
        laws.push(Dwell::hyperbolic(law, 0.6, 0.7).unwrap());
        laws.push(Dwell::exponential(law, 0.6, 0.7).unwrap());
        laws.push(Dwell::logarithmic(law, 0.04, 0.1).unwrap());
    }
    laws
}

/// W with W e^W = x, on the upper branch or the lower one, by Newton's method on its logarithm.
fn lambert(x: f64, lower: bool) -> f64 {
    let mut w = if lower { (-x).ln() - 2.0 } else { -1e-3 };
    for _ in 0..200 {
        w -= (w + (w / x).ln()) / (1.0 + w.recip());
    }
    w
}

/// θ* without damping, by the formulas of the module's page.
fn rest_by_formula(of: &DwellOscillator, index: usize, velocity: f64) -> f64 {
    let jump = of.load * (of.law.static_coefficient(0.0) - 0.3);
    let slope = of.stiffness * velocity;
    match index % 3 {
        0 => {
            let rise = of.load * (0.6 - of.law.static_coefficient(0.0));
            // (F_0 + ΔF θ/(θ + θ_c)) = kvθ/2
            let (time, half) = (0.7, 0.5 * slope);
            let b = jump + rise - half * time;
            let root = (b * b + 4.0 * half * jump * time).sqrt();
            (b + root) / (2.0 * half)
        }
        1 => {
            let rise = of.load * (0.6 - of.law.static_coefficient(0.0));
            let (q, a) = (slope * 0.7 / (2.0 * rise), 1.0 + jump / rise);
            0.7 * (a / q + lambert(-(-a / q).exp() / q, false))
        }
        _ => {
            let rate = of.load * 0.04;
            let (q, a) = (slope * 0.1 / (2.0 * rate), jump / rate);
            -0.1 * (1.0 + lambert(-q * (-q - a).exp(), true) / q)
        }
    }
}

#[test]
fn cycles_without_damping_have_the_closed_forms() {
    let mut tried = 0;
    for (index, law) in laws().into_iter().enumerate() {
        let of = oscillator(law, 0.0);
        let omega = 3.0;
        let critical = of.critical_velocity().unwrap();
        assert_eq!(critical.is_infinite(), index >= 3);
        let largest = critical.min(2.0);
        for part in [0.3, 0.6, 0.9, 0.99] {
            let velocity = part * largest;
            let Some(cycle) = of.stick_slip(velocity) else {
                // Only where the mass swings past the belt.
                let theta = rest_by_formula(&of, index, velocity);
                let back = 0.5 * of.stiffness * velocity * theta - 7.0 * 0.3;
                assert!(back > 7.0 * law.static_coefficient(0.0), "{index} {part}");
                continue;
            };
            tried += 1;
            let theta = rest_by_formula(&of, index, velocity);
            // F_s' is nearly kv/2 just below the critical velocity.
            let allowed = if part > 0.95 { 1e-11 } else { 1e-12 };
            assert_met("θ*", cycle.stick_duration / theta, 1.0, allowed);
            let z = 0.5 * velocity * theta;
            let slip = 2.0 / omega * (std::f64::consts::PI - (omega * z / velocity).atan());
            assert_met("slip", cycle.slip_duration, slip, 1e-12);
            let center = 7.0 * 0.3 / 18.0;
            assert_met("release", cycle.release_displacement, center + z, 1e-12);
            assert_met("contact", cycle.contact_displacement, center - z, 1e-12);
            assert_met(
                "amplitude",
                cycle.amplitude,
                z.hypot(velocity / omega),
                1e-12,
            );
            let fastest = velocity + velocity.hypot(omega * z);
            assert_met("speed", cycle.max_sliding_speed, fastest, 1e-12);
            let rate = of.load * law.static_rate(theta);
            let multiplier = rate / (18.0 * velocity - rate);
            assert_met("multiplier", cycle.multiplier, multiplier, 1e-11);
            assert!(cycle.is_stable());
        }
        // Gao's criterion.
        if critical.is_finite() {
            let rate = 2.0 * 7.0 * law.static_rate(0.0) / 18.0;
            assert_met("critical velocity", critical, rate, 1e-15);
            assert_eq!(of.stick_slip(critical * (1.0 + 1e-12)), None);
            assert!(
                of.stick_slip(critical * (1.0 - 1e-6))
                    .unwrap()
                    .stick_duration
                    < 1e-5
            );
        }
        assert_eq!((of.fold(), of.grazing_velocity()), (None, None));
    }
    assert!(tried >= 18, "{tried}");
}

#[test]
fn reference_cycles_and_folds() {
    let (mut cycles, mut folds) = (0, 0);
    for case in cases(include_str!("../data/dwell_cycles.json")) {
        let contact = &case["system"]["contacts"][0];
        if text(&contact["law"]) != "coulomb" {
            continue;
        }
        let dwell = &contact["dwell"];
        let value = |name: &str| number(&dwell[name]);
        let kinetic = number(&contact["law_params"]["muk"]);
        let law = Coulomb::new(value("mu_0"), kinetic).unwrap();
        let time = value("theta_c");
        let law = match text(&dwell["form"]) {
            "exponential" => Dwell::exponential(law, value("mu_inf"), time),
            "hyperbolic" => Dwell::hyperbolic(law, value("mu_inf"), time),
            _ => Dwell::logarithmic(law, value("B"), time),
        };
        let entry = |name: &str| number(&list(&list(&case["system"][name])[0])[0]);
        let of = DwellOscillator {
            law: law.unwrap(),
            mass: 1.0,
            stiffness: entry("K"),
            damping: entry("C"),
            load: number(&contact["N0"]),
        };
        let meet = |name: &str, actual: f64| {
            let what = format!("{}, {name}", text(&case["id"]));
            assert_met(&what, actual, number(&case[name]), 1e-13);
        };
        if case.get("v_fold").is_some_and(Value::is_string) {
            let fold = of.fold().unwrap();
            meet("v_fold", fold.belt_velocity);
            meet("v_graze", of.grazing_velocity().unwrap());
            // The fold is flat: its place is good to the root of rounding.
            let stuck = number(&case["stick_time_at_fold"]);
            assert_met("stick", fold.stick_duration, stuck, 1e-12);
            assert_met("multiplier", fold.multiplier, 1.0, 1e-11);
            folds += 1;
            continue;
        }
        let v = number(&case["v_b"]);
        let stable = case["stable"].as_bool().unwrap();
        let cycle = if stable {
            of.stick_slip(v)
        } else {
            of.unstable_stick_slip(v)
        };
        let cycle = cycle.unwrap();
        meet("period", cycle.period());
        meet("stick_time", cycle.stick_duration);
        meet("slip_time", cycle.slip_duration);
        meet("u_release", cycle.release_displacement);
        meet("u_contact", cycle.contact_displacement);
        meet("multiplier", cycle.multiplier);
        let range = ["q_max", "q_min"].map(|name| number(&list(&case[name])[0]));
        assert_met(
            "amplitude",
            cycle.amplitude,
            0.5 * (range[0] - range[1]),
            1e-13,
        );
        let fastest = v - number(&list(&case["v_min"])[0]);
        assert_met("speed", cycle.max_sliding_speed, fastest, 1e-13);
        cycles += 1;
    }
    assert_eq!((cycles, folds), (11, 3));
}

/// Above the critical velocity, or above the fold, the motion stops sticking; below it goes on.
#[test]
fn critical_velocities_are_bracketed_by_motions() {
    for (index, law) in laws().into_iter().enumerate() {
        for damping in [0.0, 0.01, 0.1] {
            let of = oscillator(law, damping);
            let critical = match of.critical_velocity() {
                Some(velocity) => velocity,
                None => of.fold().unwrap().belt_velocity,
            };
            if critical.is_infinite() {
                continue;
            }
            let stuck = |part: f64| {
                let v = part * critical;
                let near = of.stick_slip(0.999 * critical).unwrap();
                // From a larger swing than that of the cycle, by far.
                let start = State::new(&[near.release_displacement + 0.2 * near.amplitude], &[v]);
                let motion = dwelling(&of, v).simulate(start, 3000.0).unwrap();
                let released = motion.events().iter().rev();
                let last = released
                    .into_iter()
                    .find(|event| matches!(event.kind, EventKind::Release(_)));
                let last = last.map_or((0.0, 0.0), |event| (event.time, event.state.memory[0]));
                if last.0 > 2900.0 { last.1 } else { 0.0 }
            };
            let cycle = of.stick_slip(0.99 * critical).unwrap();
            assert_met("stuck", stuck(0.99), cycle.stick_duration, 1e-9);
            let above = stuck(1.02);
            // Without damping each stick is shorter than the last one by a part, until the contact
            // is a touch, whose length is the root of rounding.
            let vanished = 1e-4 * cycle.stick_duration;
            assert!(above <= vanished, "{index} {damping}: {above}");
        }
    }
}

#[test]
fn a_static_coefficient_that_does_not_rise_has_no_cycle() {
    for (kinetic, v) in [(0.4, 0.1), (0.25, 0.0)] {
        let belt = MassOnBelt::new(Coulomb::new(0.4, kinetic).unwrap(), v).unwrap();
        assert!(coulomb::stick_slip(&belt).is_none());
    }
}

#[test]
fn oscillators_out_of_range_have_no_answer() {
    let good = oscillator(laws()[0], 0.02);
    let none = |of: DwellOscillator| {
        assert_eq!(of.critical_velocity(), None);
        assert_eq!(
            (of.stick_slip(0.1), of.unstable_stick_slip(0.1)),
            (None, None)
        );
        assert_eq!((of.fold(), of.grazing_velocity()), (None, None));
    };
    for bad in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
        none(DwellOscillator { mass: bad, ..good });
        none(DwellOscillator {
            stiffness: bad,
            ..good
        });
        none(DwellOscillator { load: bad, ..good });
    }
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        none(DwellOscillator {
            damping: bad,
            ..good
        });
    }
    none(oscillator(laws()[0], 1.0));
    for bad in [f64::NAN, f64::INFINITY, 0.0, 1e300, f64::NEG_INFINITY] {
        assert_eq!(good.stick_slip(bad), None, "{bad}");
        assert_eq!(good.unstable_stick_slip(bad), None, "{bad}");
    }
    // A rise so fast that a rest in units of its time overflows.
    let kinetic = Coulomb::new(0.3, 0.3).unwrap();
    let risen = |law: Dwell<Coulomb>| [law.static_coefficient(1e10), law.static_rate(1e10)];
    let fast = 5e-324;
    let hyperbolic = Dwell::hyperbolic(kinetic, 0.6, fast).unwrap();
    assert_eq!(risen(hyperbolic), [0.6, 0.0]);
    let exponential = Dwell::exponential(kinetic, 0.6, fast).unwrap();
    assert_eq!(risen(exponential), [0.6, 0.0]);
    let logarithmic = Dwell::logarithmic(kinetic, 0.01, fast).unwrap();
    let expected = 0.3 + 0.01 * (10.0 * 10.0_f64.ln() - fast.ln());
    assert_met("log", risen(logarithmic)[0], expected, 1e-14);
    let grazing = oscillator(hyperbolic, 0.1).grazing_velocity();
    assert!(grazing.is_none_or(f64::is_finite));
    // As slow as one likes.
    let slow = good.stick_slip(1e-12).unwrap();
    assert_met(
        "rest",
        slow.stick_duration * 1e-12 * 18.0,
        7.0 * 0.6 + 0.0,
        1.0,
    );
}

fn bristles() -> LuGre<AnyLaw> {
    let law = AnyLaw::from(Exponential::new(0.4, 0.25, 0.5).unwrap());
    LuGre::new(law, 100.0, 0.5, 0.02).unwrap()
}

/// On a damped enough mass steady sliding is reached, and there friction and deflection are known.
#[test]
fn bristles_in_steady_sliding() {
    for v in [0.9, -0.9, 2.0] {
        let law = bristles();
        let contact = Contact::new(0, law.clone(), 3.0).unwrap().on_belt(v);
        let block = one_mass([1.5, 2.5, 2.0], 0.0, contact).unwrap();
        let end = block.simulate(State::at_rest(1), 120.0).unwrap().last();
        let steady = steady_bristles(&law, -v).unwrap();
        assert_met("z", end.memory[0] * 1e3, steady.deflection * 1e3, 1e-12);
        assert_met(
            "q",
            end.displacements[0],
            -3.0 * steady.coefficient / 2.0,
            1e-12,
        );
        // The rate by which a deviation of z alone dies out, and its answer to the velocity.
        let rate = |r: f64, z: f64| {
            let slip = Slip {
                speed: r.abs(),
                direction: r.signum(),
                piece: 0,
            };
            law.rates(Motion::Slip(slip), 1.0, [z])[0]
        };
        let d = 1e-6 * steady.deflection;
        let dies = (rate(-v, steady.deflection + d) - rate(-v, steady.deflection - d)) / (2.0 * d);
        assert_met("rate", -dies / steady.rate, 1.0, 1e-9);
        let h = 1e-5;
        let answer =
            (rate(-v + h, steady.deflection) - rate(-v - h, steady.deflection)) / (2.0 * h);
        let g = law.law();
        let expected = v.abs() * g.slope(v.abs()) / g.kinetic(v.abs());
        assert_met("answer", answer, expected, 1e-9);
    }
    for bad in [0.0, f64::NAN, f64::INFINITY] {
        assert_eq!(steady_bristles(&bristles(), bad), None);
    }
}

#[test]
fn bristles_that_hold_a_mass() {
    let law = bristles();
    let (m, n, k, c) = (1.5, 3.0, 2.0, 0.3);
    let block = one_mass([m, c, k], 0.0, Contact::new(0, law.clone(), n).unwrap()).unwrap();
    let vibration = contact_vibration(&law, m, n, k, c).unwrap();
    let (omega, zeta) = (vibration.angular_frequency, vibration.damping_ratio);
    let damped = omega * (1.0 - zeta * zeta).sqrt();
    // So small that the bristles do not slide: by |z|σ0/g in each swing.
    let size = 1e-15;
    let start = State::new(&[size], &[0.0]).with_memory(&[size]);
    let motion = block.simulate(start, 3.0).unwrap();
    for (t, state) in motion.sample(40) {
        let swing = (damped * t).cos() + zeta * omega / damped * (damped * t).sin();
        let expected = (-zeta * omega * t).exp() * swing;
        let q = state.displacements[0] / size;
        assert!((q - expected).abs() < 1e-11, "{t}: {q} {expected}");
    }
    for bad in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
        assert_eq!(contact_vibration(&law, bad, n, k, c), None);
        assert_eq!(contact_vibration(&law, m, bad, k, c), None);
    }
    for bad in [f64::NAN, f64::INFINITY, -1.0] {
        assert_eq!(contact_vibration(&law, m, n, bad, c), None);
        assert_eq!(contact_vibration(&law, m, n, k, bad), None);
    }
}

/// Least power that goes into bristles and is not stored in them, over all speeds and deflections.
fn least_loss(law: &LuGre<AnyLaw>, max_speed: f64) -> f64 {
    let speeds = (1..=400).map(|i| max_speed * f64::from(i) / 400.0);
    let highest = speeds
        .clone()
        .map(|s| law.law().kinetic(s))
        .fold(0.0, larger);
    let largest = highest.max(law.law().kinetic(0.0)) / law.stiffness();
    let mut least = f64::INFINITY;
    for speed in speeds {
        for part in -100..=100 {
            let z = largest * f64::from(part) / 100.0;
            let slip = Slip {
                speed,
                direction: 1.0,
                piece: 0,
            };
            let given = law.coefficient(slip, [z]) * speed;
            let [rate] = law.rates(Motion::Slip(slip), 1.0, [z]);
            least = least.min(given - law.stiffness() * z * rate);
        }
    }
    least
}

fn passive(law: &AnyLaw, max_speed: f64) -> f64 {
    let made = |viscous: f64| LuGre::new(law.clone(), 50.0, 3.0, viscous).unwrap();
    let least = passive_viscosity(&made(0.0), max_speed).unwrap();
    assert!(least_loss(&made(1.0001 * least), max_speed) >= 0.0);
    // Necessary, too, where high speeds are reached.
    let sharp = least_loss(&made(0.9 * least), max_speed) < 0.0;
    assert_eq!(sharp, max_speed > 10.0);
    least
}

#[test]
fn bristles_are_passive_with_enough_viscosity() {
    let exponential = passive(&Exponential::new(0.4, 0.25, 0.1).unwrap().into(), 20.0);
    assert_met("exponential", exponential, 3.0 * 0.15 / 0.25, 1e-13);
    // The minimum lies inside, and the law rises beyond its static coefficient.
    let law = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    assert_met("cubic", passive(&law.into(), 0.6), 3.0 * 0.15 / 0.25, 1e-12);
    let highest = law.kinetic(1.2);
    assert_met(
        "cubic",
        passive(&law.into(), 1.2),
        3.0 * (highest - 0.25) / 0.25,
        1e-12,
    );
    let table = Tabulated::new([(0.0, 0.4), (0.2, 0.2), (0.5, 0.3)]).unwrap();
    let least = passive_viscosity(&LuGre::new(table, 1.0, 1.0, 0.0).unwrap(), 0.4).unwrap();
    assert_met("table", least, 1.0, 1e-12);
    let flat = LuGre::new(Coulomb::new(0.4, 0.4).unwrap(), 1.0, 1.0, 0.0).unwrap();
    assert_eq!(passive_viscosity(&flat, 1.0), Ok(0.0));
    for bad in [f64::NAN, f64::INFINITY, -1.0, 0.0] {
        assert!(passive_viscosity(&flat, bad).is_err());
    }
}
