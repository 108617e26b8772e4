//! Rate-and-state friction: motions computed independently to 25 digits, steady sliding, reversals,
//! and identities.

use serde_json::Value;
use stick_slip::structure::State;
use stick_slip::{
    AnyContactLaw, AnyLaw, Contact, ContactLaw, Coulomb, Drive, Error, EventKind, FrictionLaw,
    Integrator, MassOnBelt, Motion, RateState, RateState2, Scalar, Slip, Structure, Trajectory,
};

use crate::common::collocation::integrate;
use crate::common::{Random, Worst, apart, exactly, kind, list, number, refused, text};
use crate::reading::{cases, numbers, remembered as state, remembering};

type Made = fn(f64, f64, f64, f64, f64) -> Result<RateState, Error>;

/// The aging law and the slip law.
const LAWS: [Made; 2] = [RateState::aging, RateState::slip];

fn trajectories() -> Vec<Value> {
    cases(include_str!("../data/rate_state_trajectories.json"))
}

fn meet(worst: &mut Worst, what: &str, found: &State, expected: &State) {
    worst.meet_all(1.0, what, &found.displacements, &expected.displacements);
    worst.meet_all(1.0, what, &found.velocities, &expected.velocities);
    worst.meet_all(1.0, what, &found.memory, &expected.memory);
}

/// How many times larger than friction a spring's force is: where the end of the spring moves, and
/// not the surface, friction balances a difference, which has the rounding errors of its terms.
fn digits_lost(case: &Value) -> f64 {
    let system = &case["system"];
    let (1, Value::String(_)) = (
        list(&system["contacts"]).len(),
        &system["contacts"][0]["N0"],
    ) else {
        return 1.0;
    };
    let contact = &system["contacts"][0];
    let friction = number(&contact["law_params"]["f0"]) * number(&contact["N0"]);
    let forces = list(&case["states"]).iter().map(|state| {
        let stiffness = number(&list(&system["K"])[0][0]);
        (stiffness * number(&list(&state["q"])[0])).abs()
    });
    forces.fold(friction, f64::max) / friction
}

/// Errors at round-off, of a motion whose speeds have a relative error of f/a roundings, and by the
/// tolerance: the first is the largest that is met, at the default tolerance.
#[test]
fn motions_have_the_reference_events_and_states() {
    let (mut events, mut states) = (0, 0);
    for case in trajectories() {
        let id = text(&case["id"]);
        let system = remembering(&case["system"]);
        let start = state(&case, &case["start"]);
        let rounding = 3e-14 * digits_lost(&case);
        for (tolerance, allowed) in [(None, rounding), (Some(1e-12), 3e-11), (Some(1e-9), 1e-7)] {
            let mut integrator = Integrator::new();
            if let Some(tolerance) = tolerance {
                integrator = integrator.with_tolerance(tolerance).unwrap();
            }
            let end = number(&case["t_end"]);
            let motion = integrator.simulate(&system, start.clone(), end).unwrap();
            let mut worst = Worst::default();
            let expected = list(&case["events"]);
            let kinds: Vec<_> = expected
                .iter()
                .map(|event| kind(text(&event["kind"])))
                .collect();
            let found: Vec<_> = motion.events().iter().map(|event| event.kind).collect();
            assert_eq!(found, kinds, "{id}");
            for (event, expected) in std::iter::zip(motion.events(), expected) {
                assert_eq!(
                    event.contact().map(|c| c as u64),
                    expected["contact"].as_u64(),
                    "{id}"
                );
                worst.meet("time", event.time, number(&expected["t"]));
                meet(&mut worst, "event", &event.state, &state(&case, expected));
                events += 1;
            }
            for expected in list(&case["states"]) {
                let found = motion.state_at(number(&expected["t"])).unwrap();
                meet(&mut worst, "state", &found, &state(&case, expected));
                states += 1;
            }
            println!(
                "{id}: {} steps, {:e} ({})",
                motion.steps().len(),
                worst.0,
                worst.1
            );
            worst.assert(id, allowed);
        }
    }
    assert_eq!((events, states), (3 * 48, 3 * 40));
}

/// arsinh and logarithm, and exponentials that overflow.
#[test]
fn friction_has_every_digit_at_every_speed() {
    let slip = |speed: f64| Slip {
        speed,
        direction: 1.0,
        piece: 0,
    };
    for law in LAWS.map(|law| law(0.6, 0.01, 0.015, 1e-5, 1e-6).unwrap()) {
        for decade in -300..=300 {
            let v = 10_f64.powi(decade);
            let phi = law.memory_at(v);
            let expected = 0.6 - 0.005 * (v / 1e-6).ln();
            // In steady sliding at 10^300 m/s friction is below 0: then arsinh matters.
            if expected > 0.2 {
                let size = 0.6 + 0.025 * phi.abs();
                let off = (law.steady(v) - expected).abs();
                assert!(off <= 4e-16 * size, "{v:e}: {off:e}");
            }
            assert!((law.coefficient(slip(v), [phi]) - law.steady(v)).abs() <= 1e-15);
        }
        // a arsinh(x) near 0, where x = V/(2V₀) exp(f₀/a).
        let x = 1e-3_f64;
        let v = 2e-6 * (-60.0_f64).exp() * x;
        let found = law.coefficient(slip(v), [0.0]);
        assert!((found - 0.01 * x.asinh()).abs() < 1e-13 * found, "{found}");
        // Where the two formulas meet.
        let border = 1e-6 * (20.0_f64 - 60.0).exp();
        let [below, above] = [1.0 - 1e-14, 1.0 + 1e-14].map(|part| {
            let v = border * part;
            law.coefficient(slip(v), [0.0]) - 0.01 * ((v / 1e-6).ln() + 60.0)
        });
        assert!(
            below.abs() < 1e-16 && above.abs() < 1e-16,
            "{below:e} {above:e}"
        );
        assert_eq!(law.coefficient(slip(0.0), [0.0]), 0.0);
        let backward = Slip {
            direction: -1.0,
            ..slip(1e-7)
        };
        let forward = law.coefficient(slip(1e-7), [0.3]);
        assert_eq!(law.coefficient(backward, [0.3]), -forward);
    }
    // exp(f₀/a) overflows, in the law and in its slope at r = 0.
    for a in [1e-3, 8e-4, 1e-4, 1e-6] {
        for v0 in [1e-6, 1e-30, 1e30] {
            for made in LAWS {
                let law = made(0.6, a, 1.5 * a, 1e-5, v0).unwrap();
                assert!((law.steady(v0) - 0.6).abs() < 1e-15);
                assert!(Contact::new(0, law, 1.0).is_ok(), "{a} {v0}");
            }
        }
    }
}

/// Rates in slip, with no more roundings than the formulas have.
#[test]
fn state_variables_follow_their_law() {
    let rates = |law: RateState, v: f64, phi: f64| {
        let slip = Slip {
            speed: v,
            direction: -1.0,
            piece: 0,
        };
        let [rate] = law.rates(Motion::Slip(slip), 7.0, [phi]);
        let (_, [same]) = law.coefficient_and_rates(slip, 7.0, [phi]);
        assert_eq!(rate, same);
        rate
    };
    let [aging, slip] = LAWS.map(|law| law(0.6, 0.01, 0.015, 1e-5, 1e-6).unwrap());
    for (v, phi) in [(1e-6, 0.0), (3e-9, 5.0), (0.2, -9.0), (1e-20, 7.0)] {
        let expected = (1e-6 * f64::exp(-phi) - v) / 1e-5;
        assert!((rates(aging, v, phi) - expected).abs() <= 1e-15 * expected.abs());
        let expected = -v / 1e-5 * ((v / 1e-6_f64).ln() + phi);
        assert!((rates(slip, v, phi) - expected).abs() <= 1e-15 * expected.abs());
    }
    assert_eq!(aging.rates(Motion::Stick, 1.0, [0.0]), [1e-6 / 1e-5]);
    assert_eq!(slip.rates(Motion::Stick, 1.0, [0.0]), [0.0]);
    // The least speed matters below itself only.
    let above = slip.with_least_speed(1e-12).unwrap();
    assert_eq!(rates(above, 2e-12, 3.0), rates(slip, 2e-12, 3.0));
    let expected = -1e-13 / 1e-5 * (3.0 + 1e-6_f64.ln());
    assert!((rates(above, 1e-13, 3.0) - expected).abs() < 1e-15 * expected.abs());
    assert_eq!(rates(above, 0.0, 3.0), 0.0);
}

/// One mass on a spring, with a damper, on a belt.
fn slider<L>(law: L, [mass, damping, stiffness]: [f64; 3], load: f64, v: f64) -> Structure
where
    L: ContactLaw + Send + Sync + 'static,
{
    Structure::new(&[mass])
        .and_then(|slider| slider.with_ground_spring(0, stiffness))
        .and_then(|slider| slider.with_ground_damper(0, damping))
        .and_then(|slider| slider.with_contact(Contact::new(0, law, load)?.on_belt(v)))
        .unwrap()
}

/// The memory and the eigenvalues of steady sliding at speeds far from V₀, and the stiffness and
/// the frequency at which it becomes unstable. Both laws agree to first order.
#[test]
fn steady_sliding_is_unstable_below_the_critical_stiffness() {
    let mut random = Random::new(7);
    for _ in 0..200 {
        let a = random.logarithmic(1e-3, 0.02);
        let b = a * random.uniform(1.1, 2.0);
        let (d_c, v0) = (
            random.logarithmic(1e-6, 1e-2),
            random.logarithmic(1e-9, 1e-3),
        );
        let v = v0 * random.logarithmic(1e-12, 1e6);
        let load = random.logarithmic(1e-2, 1e8);
        // The damper that makes steady sliding stable with every spring, in parts.
        let damping = load * (b - a) / v * random.pick(&[0.0, 0.3, 0.9]);
        let mass = random.logarithmic(1e-6, 1e2) * load * d_c / (v * v);
        let laws = LAWS.map(|law| law(0.6, a, b, d_c, v0).unwrap());
        let stiffness = laws[0].critical_stiffness(load, v, mass, damping).unwrap();
        let frequency = laws[0].hopf_frequency(load, v, damping).unwrap();
        for law in laws {
            let again = law.critical_stiffness(load, v, mass, damping).unwrap();
            assert!((again / stiffness - 1.0).abs() < 1e-12);
            let eigenvalues = |part: f64| {
                let system = slider(law, [mass, damping, part * stiffness], load, v);
                let sliding = system.steady_sliding().unwrap();
                let held = load * law.steady(v) / (part * stiffness);
                assert!((sliding.displacements[0] / held - 1.0).abs() < 1e-13);
                sliding.eigenvalues
            };
            let at_border = eigenvalues(1.0);
            let [first, second, third] = exactly(&at_border);
            let oscillating: Vec<_> = [first, second, third]
                .into_iter()
                .filter(|s| s.im.abs() > 0.5 * frequency)
                .collect();
            let [one, other] = exactly(&oscillating);
            // The third is far larger, and its rounding counts.
            let size = at_border.iter().map(|s| s.norm()).fold(0.0, f64::max);
            let allowed = 1e-9 * frequency + 1e-13 * size;
            assert!(
                (one.im.abs() - frequency).abs() < allowed,
                "{one} {frequency}"
            );
            assert!(
                one.re.abs() < allowed && other.re.abs() < allowed,
                "{one} {frequency}"
            );
            if size < 1e4 * frequency {
                let largest = |part: f64| {
                    let found = eigenvalues(part);
                    found.iter().map(|s| s.re).fold(f64::NEG_INFINITY, f64::max)
                };
                assert!(largest(0.99) > 0.0 && largest(1.01) < 0.0);
            }
        }
    }
}

/// The characteristic equation has the root iω there, with two state variables and where arsinh
/// matters, too.
#[test]
fn critical_stiffness_is_a_root_of_the_characteristic_equation() {
    let mut random = Random::new(3);
    let mut found = 0;
    for _ in 0..500 {
        let a = random.logarithmic(1e-2, 1.0);
        let [b1, b2] = [-0.5, 2.0].map(|least| a * random.uniform(least, 3.0));
        let [d1, d2] = [(); 2].map(|()| random.logarithmic(1e-3, 1.0));
        let (v, load) = (random.logarithmic(1e-2, 1e2), random.logarithmic(0.1, 10.0));
        let f0 = random.pick(&[0.05, 0.6, 5.0]);
        let one = RateState::aging(f0, a, b1, d1, 1.0).unwrap();
        let law = one.with_second_state(b2, d2).unwrap();
        let mass = random.logarithmic(1e-3, 10.0);
        let damping = random.pick(&[0.0, 0.1]) * load * a / v;
        let Some(stiffness) = law.critical_stiffness(load, v, mass, damping) else {
            assert_eq!(law.hopf_frequency(load, v, damping), None);
            continue;
        };
        found += 1;
        let system = slider(law, [mass, damping, stiffness], load, v);
        let sliding = system.steady_sliding().unwrap();
        let real = sliding.eigenvalues.iter().filter(|s| s.im > 0.0);
        let least = real
            .map(|s| (s.re / s.norm()).abs())
            .fold(f64::INFINITY, f64::min);
        assert!(least < 1e-10, "{law:?} {least:e} {:?}", sliding.eigenvalues);
        let system = slider(law, [mass, damping, 1.01 * stiffness], load, v);
        let above = system.steady_sliding().unwrap().eigenvalues;
        let largest = above
            .iter()
            .map(|s| s.re / s.norm())
            .fold(f64::NEG_INFINITY, f64::max);
        // Where friction is near 0 nothing damps.
        assert!(
            largest < 1e-13,
            "{law:?} {load} {v} {mass} {damping} {above:?}"
        );
    }
    assert!(found > 300, "{found}");
}

/// V₀ → V₀eᶜ with f₀ → f₀ + (a − b)c and φ → φ + c is the same law.
#[test]
fn reference_speed_is_arbitrary() {
    for made in LAWS {
        let one = made(0.4, 0.1, 0.25, 0.08, 0.08).unwrap();
        let motions = [0.0, 1.5, -7.0].map(|c: f64| {
            let other = made(0.4 - 0.15 * c, 0.1, 0.25, 0.08, 0.08 * c.exp()).unwrap();
            let slip = |speed: f64| Slip {
                speed,
                direction: 1.0,
                piece: 0,
            };
            for (speed, phi) in [(1e-3, 0.3), (1e-9, 2.0), (4.0, -1.0)] {
                let [f, same] = [(one, phi), (other, phi + c)]
                    .map(|(law, phi)| law.coefficient(slip(speed), [phi]));
                assert!((f - same).abs() < 1e-14, "{f} {same}");
            }
            let start = State::new(&[0.3], &[0.02]).with_memory(&[0.1 + c]);
            slider(other, [1.0, 0.05, 1.4], 1.0, 0.08)
                .simulate(start, 9.0)
                .unwrap()
        });
        let [first, others @ ..] = motions.map(|motion: Trajectory<State>| motion.last());
        for last in others {
            assert!((last.displacements[0] - first.displacements[0]).abs() < 1e-13);
            assert!((last.velocities[0] - first.velocities[0]).abs() < 1e-13);
        }
    }
}

/// Two equal sliders on one coordinate are one slider with the sum of the loads; two equal state
/// variables are one with the sum of b.
#[test]
fn equal_parts_add_up() {
    let start = |memory: &[f64]| State::new(&[0.3], &[0.02]).with_memory(memory);
    for made in LAWS {
        let law = made(0.4, 0.1, 0.25, 0.08, 0.08).unwrap();
        let whole = slider(law, [1.0, 0.05, 1.4], 1.0, 0.08);
        let whole = whole.simulate(start(&[0.1]), 9.0).unwrap().last();
        let half = slider(law, [1.0, 0.05, 1.4], 0.5, 0.08);
        let contact = Contact::new(0, law, 0.5).unwrap().on_belt(0.08);
        let both = half.with_contact(contact).unwrap();
        let both = both.simulate(start(&[0.1, 0.1]), 9.0).unwrap().last();
        let part = made(0.4, 0.1, 0.1, 0.08, 0.08).unwrap();
        let two: RateState2 = part.with_second_state(0.15, 0.08).unwrap();
        let states = slider(two, [1.0, 0.05, 1.4], 1.0, 0.08);
        let states = states.simulate(start(&[0.1, 0.1]), 9.0).unwrap().last();
        for last in [both, states] {
            assert!((last.displacements[0] - whole.displacements[0]).abs() < 1e-13);
            assert!((last.memory[1] - whole.memory[0]).abs() < 1e-12);
        }
    }
}

/// Forces, lengths and times in other units: the same motion, to rounding.
#[test]
fn units_are_arbitrary() {
    for made in LAWS {
        let last = |[force, length, time]: [f64; 3]| {
            let speed = length / time;
            let law = made(0.4, 0.1, 0.25, 0.08 * length, 0.08 * speed).unwrap();
            let per_length = force / length;
            let numbers = [
                per_length * time * time,
                0.05 * per_length * time,
                1.4 * per_length,
            ];
            let start = State::new(&[0.3 * length], &[0.02 * speed]).with_memory(&[0.1]);
            let system = slider(law, numbers, force, 0.08 * speed);
            let state = system.simulate(start, 9.0 * time).unwrap().last();
            [
                state.displacements[0] / length,
                state.velocities[0] / speed,
                state.memory[0],
            ]
        };
        let expected = last([1.0; 3]);
        for units in [
            [3e7, 1.0, 1.0],
            [1.0, 7e-6, 1.0],
            [1.0, 1.0, 3e8],
            [5e3, 2e-5, 9e-4],
        ] {
            for (found, expected) in std::iter::zip(last(units), expected) {
                assert!(
                    (found - expected).abs() < 1e-12,
                    "{units:?}: {found} {expected}"
                );
            }
        }
    }
}

/// a arsinh(e^{f₀/a} s/(2V₀)), which passes 0 with a slope of 5e15.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Arsinh;

impl FrictionLaw for Arsinh {
    fn static_coefficient(&self) -> f64 {
        0.0
    }
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        (speed * (40.0_f64.exp() / 0.16)).asinh() * 0.01
    }
}

/// With b = 0 the memory has no effect: the law is one of the speed, by the engine of a mass on a
/// belt, too.
#[test]
fn without_its_memory_it_is_a_law_of_the_speed() {
    let law = RateState::aging(0.4, 0.01, 0.0, 0.08, 0.08).unwrap();
    let system = slider(law, [1.0, 0.1, 1.0], 1.0, 0.5);
    let start = State::new(&[0.7], &[0.02]).with_memory(&[0.1]);
    let found = system.simulate(start, 9.0).unwrap();
    let belt = MassOnBelt::new(Arsinh, 0.5).and_then(|belt| belt.with_damping(0.05));
    let start = stick_slip::State::new(0.7, 0.02);
    let expected = belt.unwrap().simulate(start, 9.0).unwrap();
    for k in 0..=90 {
        let time = 0.1 * f64::from(k);
        let (found, expected) = (found.state_at(time), expected.state_at(time));
        let (found, expected) = (found.unwrap(), expected.unwrap());
        let off = (found.displacements[0] - expected.displacement)
            .abs()
            .max((found.velocities[0] - expected.velocity).abs());
        assert!(off < 1e-13, "{time}: {off:e}");
    }
}

/// As a = b falls to 0, friction tends to Coulomb's, in proportion to a: in slip in one direction.
#[test]
fn without_rate_and_state_it_is_coulombs() {
    let last = |system: Structure, start: State| system.simulate(start, 9.0).unwrap().last();
    let start = State::new(&[0.7], &[0.02]);
    let coulomb = slider(Coulomb::new(0.4, 0.4).unwrap(), [1.0, 0.1, 1.0], 1.0, 0.8);
    let expected = last(coulomb, start.clone());
    for made in LAWS {
        let off = [1e-3, 1e-5, 1e-7].map(|a| {
            let law = made(0.4, a, a, 0.08, 0.08).unwrap();
            let system = slider(law, [1.0, 0.1, 1.0], 1.0, 0.8);
            let found = last(system, start.clone().with_memory(&[0.1]));
            (found.displacements[0] - expected.displacements[0]).abs() / a
        });
        assert!(off[0] > 1e-2 && off[0] < 10.0, "{off:?}");
        assert!((off[1] / off[2] - 1.0).abs() < 1e-3, "{off:?}");
    }
}

/// A law of one's own around one of the crate's, and one chosen at run time, move the same way.
#[test]
fn laws_chosen_at_run_time_are_the_same() {
    let law = RateState::aging(0.4, 0.1, 0.25, 0.08, 0.08).unwrap();
    let any: AnyContactLaw<AnyLaw> = law.into();
    let start = State::new(&[0.3], &[0.02]).with_memory(&[0.1]);
    let own = slider(law, [1.0, 0.05, 1.4], 1.0, 0.08);
    let chosen = slider(any.clone(), [1.0, 0.05, 1.4], 1.0, 0.08);
    assert_eq!(own, chosen);
    let [own, chosen] = [own, chosen].map(|s| s.simulate(start.clone(), 9.0).unwrap().last());
    assert_eq!(own, chosen);
    let elastic = Contact::new(0, any, 1.0)
        .unwrap()
        .with_tangential_stiffness(1.0);
    refused!(elastic => Error::LawNotConstant { .. });
    let coulomb = Coulomb::new(0.4, 0.4).unwrap();
    assert_ne!(
        Contact::new(0, law, 1.0).unwrap(),
        Contact::new(0, coulomb, 1.0).unwrap()
    );
}

/// A mass that a harmonic force moves to and fro.
fn shaken_system(law: RateState) -> Structure {
    let force = Drive::harmonic(0.9, 0.9, 0.0).unwrap();
    let system = slider(law, [1.0, 0.1, 1.0], 0.5, 0.0);
    system.with_force(0, force).unwrap()
}

fn shaken(law: RateState) -> Result<Trajectory<State>, Error> {
    let start = State::new(&[0.0], &[0.3]).with_memory(&[0.0]);
    shaken_system(law).simulate(start, 20.0)
}

/// The slip law passes r = 0 with a least speed, of any size far below that of the motion.
#[test]
fn slip_law_reverses_with_a_least_speed_only() {
    let law = RateState::slip(0.4, 0.12, 0.16, 0.15, 0.2).unwrap();
    match shaken(law).unwrap_err() {
        Error::NotAnalytic {
            speed,
            reached: Some(reached),
        } => {
            assert_eq!(speed, 0.0);
            assert_eq!(reached.state.velocities, [0.0]);
        }
        error => panic!("{error}"),
    }
    let motions = [1e-9, 1e-12, 1e-20, 1e-30, 1e-200].map(|part| {
        let motion = shaken(law.with_least_speed(0.2 * part).unwrap()).unwrap();
        println!("{part:e}: {} steps", motion.steps().len());
        motion
    });
    let [first, others @ ..] = motions;
    assert_eq!(first.events().len(), 6);
    for motion in others {
        assert!(motion.steps().len() < 1000);
        for (event, same) in std::iter::zip(first.events(), motion.events()) {
            assert!((event.time - same.time).abs() < 1e-12 && event.kind == same.kind);
        }
        let [found, expected] = [&motion, &first].map(Trajectory::last);
        assert!((found.displacements[0] - expected.displacements[0]).abs() < 1e-12);
        assert!((found.memory[0] - expected.memory[0]).abs() < 1e-12);
    }
}

/// A slider of 20 kg that creeps beside a plate of 1e-7 m/s.
fn creeping() -> (Structure, State) {
    let law = RateState::aging(0.6, 0.01, 0.015, 1e-5, 1e-6).unwrap();
    let system = slider(law, [20.0, 0.0, 2e5], 5e3, 1e-7);
    // v of the start is wrong: r wins.
    let start = State::new(&[0.0157], &[0.3]).with_memory(&[7.0]);
    (system, start.with_sliding(0, -1.5e-10))
}

/// m r' = −kq − Nμ with all its digits, while the speed settles within 1e-10 s.
#[test]
fn creeping_speeds_keep_all_their_digits() {
    let (system, start) = creeping();
    let law = RateState::aging(0.6, 0.01, 0.015, 1e-5, 1e-6).unwrap();
    let motion = system.simulate(start, 2e-10).unwrap();
    assert_eq!(motion.sliding_velocity(0, 0.0), -1.5e-10);
    assert_eq!(motion.state_at(0.0).unwrap().velocities, [1e-7 - 1.5e-10]);
    let acceleration = |r: f64| {
        let slip = Slip {
            speed: -r,
            direction: -1.0,
            piece: 0,
        };
        (-2e5 * 0.0157 - 5e3 * law.coefficient(slip, [7.0])) / 20.0
    };
    let (steps, mut r) = (20_000, -1.5e-10);
    let h = 2e-10 / f64::from(steps);
    for step in 0..steps {
        if step % 5000 == 0 {
            let time = h * f64::from(step);
            let found = motion.sliding_velocity(0, time);
            assert!((found / r - 1.0).abs() < 1e-11, "{time:e}: {found:e} {r:e}");
            let state = motion.state_at(time).unwrap();
            assert_eq!(state.sliding(), [(0, found)]);
        }
        let k1 = acceleration(r);
        let k2 = acceleration(r + h / 2.0 * k1);
        let k3 = acceleration(r + h / 2.0 * k2);
        let k4 = acceleration(r + h * k3);
        r += h / 6.0 * (k1 + 2.0 * (k2 + k3) + k4);
    }
    assert!((motion.last().sliding()[0].1 / r - 1.0).abs() < 1e-11);
    assert!(r < -2e-10, "{r:e}");
}

/// A motion goes on from any of its states as it went before.
#[test]
fn motions_go_on_with_the_digits_of_their_states() {
    let (system, start) = creeping();
    let whole = system.simulate(start, 2e-10).unwrap();
    for time in [1e-11, 4e-11, 1.1e-10] {
        let state = whole.state_at(time).unwrap();
        let from = Integrator::new().with_start_time(time).unwrap();
        let rest = from.simulate(&system, state.clone(), 2e-10 - time).unwrap();
        let [found, expected] = [&rest, &whole].map(|motion| motion.last().sliding()[0].1);
        assert!(
            (found / expected - 1.0).abs() < 1e-11,
            "{found:e} {expected:e}"
        );
        // Without the number it has lost digits.
        let without = State::new(&state.displacements, &state.velocities);
        let without = without.with_memory(&state.memory);
        let lost = from
            .simulate(&system, without, 0.0)
            .unwrap()
            .sliding_velocity(0, time);
        let kept = whole.sliding_velocity(0, time);
        assert!(lost != kept && (lost / kept - 1.0).abs() < 1e-3);
    }
    // Events have it, too: 0 at a crossing.
    let law = RateState::aging(0.4, 0.12, 0.16, 0.15, 0.2).unwrap();
    let motion = shaken(law).unwrap();
    assert!(!motion.events().is_empty());
    for event in motion.events() {
        assert_eq!(event.state.sliding(), [(0, 0.0)]);
        let from = Integrator::new().with_start_time(event.time).unwrap();
        let system = shaken_system(law);
        let rest = from
            .simulate(&system, event.state.clone(), 20.0 - event.time)
            .unwrap();
        let [found, expected] = [&rest, &motion].map(Trajectory::last);
        assert!((found.displacements[0] - expected.displacements[0]).abs() < 1e-12);
    }
    for (time, state, _) in motion.sample_every(0.1).unwrap() {
        assert_eq!(state.sliding(), [(0, motion.sliding_velocity(0, time))]);
        assert!((state.sliding()[0].1 - state.velocities[0]).abs() < 1e-14);
    }
}

/// Relative velocities of contacts that share masses: the velocities follow with the least change
/// of kinetic energy.
#[test]
fn velocities_follow_from_given_relative_velocities() {
    let law = RateState::aging(0.6, 0.01, 0.015, 1e-5, 1e-6).unwrap();
    let between = |b: f64| {
        let joint = Contact::along(&[(0, 1.0), (1, b)], law, 1.0)
            .unwrap()
            .on_belt(0.25);
        Structure::new(&[1.0, 3.0])
            .unwrap()
            .with_contact(joint)
            .unwrap()
    };
    let start = State::new(&[0.0, 0.0], &[0.5, 1.0]);
    let velocities = |system: &Structure, start: &State| {
        let motion = system.simulate(start.clone(), 0.0);
        motion.map(|motion| motion.last().velocities)
    };
    // r = v_0 − v_1 − 0.25 was −0.75; a change of 0.75 + 1e-3 in the parts 3 : 1.
    let found = velocities(&between(-1.0), &start.clone().with_sliding(0, 1e-3)).unwrap();
    assert!((found[0] - 0.5 - 0.75 * 0.751).abs() < 1e-15, "{found:?}");
    assert!((found[1] - 1.0 + 0.25 * 0.751).abs() < 1e-15, "{found:?}");
    // An ordinary contact beside it gets the velocity that follows.
    let coulomb = Contact::new(0, Coulomb::new(0.4, 0.3).unwrap(), 1.0).unwrap();
    let both = between(-1.0).with_contact(coulomb).unwrap();
    let given = start.clone().with_sliding(0, 1e-3);
    let motion = both.simulate(given, 0.0).unwrap();
    assert!((motion.sliding_velocity(1, 0.0) - 0.5 - 0.75 * 0.751).abs() < 1e-15);
    assert_eq!(motion.sliding_velocity(0, 0.0), 1e-3);
    assert_eq!(motion.last().sliding(), [(0, 1e-3)]);
    // r = 0 is stick for a law that sticks.
    let carried = both
        .carried(0.0, &start.clone().with_sliding(1, 0.0))
        .unwrap();
    assert!(carried[1].force.abs() < 0.4);

    let refuse = |system: &Structure, start: State, name: &str, value: f64| match system
        .simulate(start, 1.0)
        .unwrap_err()
    {
        Error::InvalidParameter {
            of: "State",
            name: found,
            value: given,
            ..
        } => {
            assert!(
                found == name && given.to_bits() == value.to_bits(),
                "{found} {given}"
            );
        }
        error => panic!("{error}"),
    };
    for (contact, r, name, value) in [
        (2, 0.1, "contact of sliding", 2.0),
        (0, f64::INFINITY, "sliding", f64::INFINITY),
        (1, f64::NAN, "sliding", f64::NAN),
    ] {
        refuse(&both, start.clone().with_sliding(contact, r), name, value);
    }
    let elastic = Contact::new(0, Coulomb::new(0.4, 0.4).unwrap(), 1.0).unwrap();
    let elastic = elastic.with_tangential_stiffness(10.0).unwrap();
    let elastic = between(-1.0).with_contact(elastic).unwrap();
    refuse(
        &elastic,
        start.clone().with_sliding(1, 0.1),
        "contact of sliding",
        1.0,
    );
    // Parallel clutches slide at one speed.
    let clutch = Contact::between(0, 1, Coulomb::new(0.4, 0.3).unwrap(), 1.0).unwrap();
    let parallel = between(-1.0).with_contact(clutch.on_belt(0.25)).unwrap();
    let same = start.clone().with_sliding(0, 0.1).with_sliding(1, 0.1);
    assert!(parallel.simulate(same, 0.0).is_ok());
    let other = start.with_sliding(1, 0.2).with_sliding(0, 0.1);
    assert!(matches!(
        parallel.simulate(other, 0.0),
        Err(Error::InvalidParameter {
            of: "State",
            name: "sliding",
            ..
        })
    ));
}

/// Where the surface jumps, the mass goes on with its velocity: as from a new start.
#[test]
fn surfaces_may_jump() {
    for made in LAWS {
        let law = made(0.4, 0.1, 0.25, 0.08, 0.08).unwrap();
        let law = law.with_least_speed(1e-30).unwrap();
        let belt = Drive::profile(&[
            (0.0, 0.08),
            (3.0, 0.08),
            (3.0, -0.2),
            (5.0, -0.2),
            (5.0, 0.3),
        ]);
        let contact = |w: Drive| Contact::new(0, law, 1.0).unwrap().on_belt(w);
        let joint = |w: Drive| Contact::between(0, 1, law, 0.3).unwrap().on_belt(w);
        let chain = |w: Drive, joint_of: Drive| {
            Structure::new(&[1.0, 2.0])
                .and_then(|s| s.with_ground_spring(0, 1.4)?.with_spring(0, 1, 0.5))
                .and_then(|s| s.with_contact(contact(w))?.with_contact(joint(joint_of)))
                .unwrap()
        };
        let start = State::new(&[0.3, 0.1], &[0.02, 0.0]).with_memory(&[0.1, 0.0]);
        let belt = belt.unwrap();
        let whole = chain(belt.clone(), belt)
            .simulate(start.clone(), 8.0)
            .unwrap();
        let mut state = start;
        for (from, to, w) in [(0.0, 3.0, 0.08), (3.0, 5.0, -0.2), (5.0, 8.0, 0.3)] {
            let part = Integrator::new().with_start_time(from).unwrap();
            let system = chain(w.into(), w.into());
            state = part.simulate(&system, state, to - from).unwrap().last();
            // Without the relative velocities, which jump.
            state = State::new(&state.displacements, &state.velocities).with_memory(&state.memory);
        }
        let off = apart(&whole.last(), &state);
        assert!(off < 1e-13, "{off:e}");
        let [before, after] = [3.0 - 1e-9, 3.0].map(|time| whole.sliding_velocity(0, time));
        assert!((after - before - 0.28).abs() < 1e-8, "{before} {after}");
    }
    let coulomb = Contact::new(0, Coulomb::new(0.4, 0.3).unwrap(), 1.0).unwrap();
    let jump = Drive::profile(&[(0.0, 0.1), (0.0, 0.2)]).unwrap();
    let refused = Structure::new(&[1.0])
        .unwrap()
        .with_contact(coulomb.on_belt(jump));
    assert!(matches!(refused, Err(Error::BeltVelocityJumps { .. })));
}

/// A law of one state variable or of two after a velocity step, without its type.
fn stepped(case: &Value) -> Structure {
    let [f0, a] = ["f0", "a"].map(|name| number(&case[name]));
    let (b, d_c) = (numbers(&case["b"]), numbers(&case["d_c"]));
    let made: Made = match text(&case["law"]) {
        "aging" => RateState::aging,
        _ => RateState::slip,
    };
    let one = made(f0, a, b[0], d_c[0], 1.0).unwrap();
    let load_point = Drive::profile(&[(0.0, 1.0), (10.0, 1.0), (10.0, 10.0), (40.0, 10.0)]);
    let contact = match (b.get(1), d_c.get(1)) {
        (Some(&b), Some(&d_c)) => Contact::new(0, one.with_second_state(b, d_c).unwrap(), 1.0),
        _ => Contact::new(0, one, 1.0),
    };
    // Motions change in proportion to the mass.
    Structure::new(&[1e-14])
        .and_then(|slider| slider.with_ground_spring(0, number(&case["k"])))
        .and_then(|slider| slider.with_contact(contact?.on_belt(load_point?)))
        .unwrap()
}

/// Velocity steps that a published program has frozen, to its 8 decimals: `rsfmodel`, by J. R.
/// Leeman.
#[test]
fn velocity_steps_are_those_of_rsfmodel() {
    let mut all = 0;
    for case in cases(include_str!("../data/rate_state_steps.json")) {
        let id = text(&case["id"]);
        let system = stepped(&case);
        let (stiffness, d_c) = (number(&case["k"]), numbers(&case["d_c"]));
        let start = State::new(&[number(&case["f0"]) / stiffness], &[0.0])
            .with_memory(&vec![0.0; d_c.len()])
            .with_sliding(0, -1.0);
        let motion = system.simulate(start, 40.0).unwrap();
        let states: Vec<Vec<f64>> = list(&case["states"]).iter().map(numbers).collect();
        let mut worst = Worst::default();
        let rows = std::iter::zip(numbers(&case["friction"]), numbers(&case["speed"]));
        for (i, (friction, speed)) in rows.enumerate() {
            // The step itself is after the number at its time.
            let time = i as f64 - if i == 10 { 1e-9 } else { 0.0 };
            let state = motion.state_at(time).unwrap();
            worst.meet("friction", stiffness * state.displacements[0], friction);
            worst.meet("speed", motion.sliding_velocity(0, time).abs(), speed);
            for (j, d_c) in d_c.iter().enumerate() {
                worst.meet("state", d_c * state.memory[j].exp(), states[j][i]);
            }
            all += 2 + d_c.len();
        }
        worst.assert(id, 1e-8);
    }
    assert_eq!(all, 41 * (3 + 3 + 4 + 4));
}

/// A free mass whose contact opens from 1 to 3, under a force that reverses its sliding: with the
/// aging law θ' = 1 − Vθ/D_c is linear, with the slip law ln(V/V₀) + φ decays at constant V.
#[test]
fn state_variables_change_while_a_contact_is_open() {
    let load = || Drive::profile(&[(0.0, 1.0), (1.0, 0.0), (2.0, -1.0), (3.0, 0.0), (4.0, 1.0)]);
    let block = |law: RateState, force: f64| {
        let contact = Contact::new(0, law, load().unwrap()).unwrap().on_belt(0.7);
        Structure::new(&[2.0])
            .and_then(|block| block.with_force(0, force)?.with_contact(contact))
            .unwrap()
    };
    let at = |block: &Structure, start: State| {
        let motion = block.simulate(start, 4.0).unwrap();
        let [open, close] = [EventKind::Open, EventKind::Close].map(|what| {
            let mut events = motion.events().iter();
            let found = events.find(|event| event.kind == what).unwrap();
            (found.time, found.state.clone())
        });
        assert_eq!(open.0, 1.0);
        assert!((close.0 - 3.0).abs() < 1e-15);
        [open.1, close.1]
    };
    let [aging, slip] = LAWS.map(|law| law(0.4, 0.02, 0.03, 0.8, 0.05).unwrap());
    let start = State::new(&[0.0], &[1.5]).with_memory(&[-1.0]);
    // Constant speeds.
    let [open, close] = at(&block(slip, 0.0), start.clone());
    let v = open.velocities[0] - 0.7;
    let level = (v / 0.05).ln();
    let expected = -level + (open.memory[0] + level) * (-2.0 * v / 0.8).exp();
    assert!(
        (close.memory[0] - expected).abs() < 1e-14,
        "{close:?} {expected}"
    );
    let [open, close] = at(&block(aging, 0.0), start.clone());
    let v = open.velocities[0] - 0.7;
    let theta = |phi: f64| 0.8 / 0.05 * phi.exp();
    let expected = 0.8 / v + (theta(open.memory[0]) - 0.8 / v) * (-2.0 * v / 0.8).exp();
    assert!((theta(close.memory[0]) / expected - 1.0).abs() < 1e-14);
    // r = r₁ − a(t − 1) passes 0: the integral of V from s to the end, by pieces.
    let [open, close] = at(&block(aging, -1.2), start);
    let (r, a) = (open.velocities[0] - 0.7, 0.6);
    assert!(0.05 < r && r < 1.1, "{r}");
    let way = |t: f64| {
        let turn = r / a;
        let along = |t: f64| r * t - 0.5 * a * t * t;
        if t < turn {
            along(t)
        } else {
            2.0 * along(turn) - along(t)
        }
    };
    // θ' = 1 − Vθ/D_c: θ₂ = θ₁ e^{−x(2)/D_c} + ∫ e^{−(x(2) − x(s))/D_c} ds, smooth on each side.
    let decayed = |s: f64| (-(way(2.0) - way(s)) / 0.8).exp();
    let grown = |from: f64, to: f64| {
        let rates = |s: f64, _: &[f64]| vec![decayed(s)];
        integrate(&rates, &[0.0], [from, to], 40)[0]
    };
    let healed = grown(0.0, r / a) + grown(r / a, 2.0);
    let expected = theta(open.memory[0]) * decayed(0.0) + healed;
    let found = theta(close.memory[0]);
    assert!((found / expected - 1.0).abs() < 1e-14, "{found} {expected}");
    // A state in the gap is a start of the same motion.
    let system = block(aging, -1.2);
    let whole = system
        .simulate(State::new(&[0.0], &[1.5]).with_memory(&[-1.0]), 4.0)
        .unwrap();
    for t in [1.0, 1.5, 1.0 + r / a, 2.5, 2.99] {
        let from = Integrator::new().with_start_time(t).unwrap();
        let rest = from
            .simulate(&system, whole.state_at(t).unwrap(), 4.0 - t)
            .unwrap();
        let (found, expected) = (rest.last(), whole.last());
        assert!((found.memory[0] - expected.memory[0]).abs() < 1e-13, "{t}");
        assert!(
            (found.velocities[0] - expected.velocities[0]).abs() < 1e-14,
            "{t}"
        );
    }
}

/// At rest φ = φ₀ + ln(1 + t/t₀) with t₀ = D_c e^{φ₀}/V₀, for as long as one likes; with a spring,
/// without one, and beside a mass that moves.
#[test]
fn a_contact_at_rest_heals_by_the_logarithm() {
    for (d_c, v0) in [(0.3, 0.1), (1e-5, 1e-6), (1.0, 1.0)] {
        let law = RateState::aging(0.6, 0.01, 0.015, d_c, v0).unwrap();
        let contact = || Contact::new(0, law, 2.0).unwrap();
        let alone = Structure::new(&[1.0]).unwrap();
        let sprung = alone.clone().with_ground_spring(0, 1e-3).unwrap();
        let pair = Structure::new(&[1.0, 1.0]).unwrap();
        for (system, moving) in [(alone, None), (sprung, None), (pair, Some(1.0))] {
            let system = system.with_contact(contact()).unwrap();
            for phi in [0.0, -6.0, -3.0, 3.0] {
                let unit = d_c / v0 * f64::exp(phi);
                let velocities: Vec<f64> = [0.0].into_iter().chain(moving).collect();
                let start = State::new(&vec![0.0; system.len()], &velocities);
                let start = start.with_memory(&[phi]);
                let motion = system.simulate(start, 1e6 * unit).unwrap();
                for part in [0.3, 1.0, 3.0, 10.0, 1e3, 1e6] {
                    let found = motion.state_at(part * unit).unwrap().memory[0];
                    let expected = phi + f64::ln_1p(part);
                    let allowed = 1e-13 * expected.abs().max(1.0);
                    assert!(
                        (found - expected).abs() < allowed,
                        "{system:?} {phi} {part}: {found} {expected}"
                    );
                }
                assert!(motion.steps().len() < 200, "{}", motion.steps().len());
            }
        }
    }
}
