//! What the integrator promises, one test for each promise, and the cases that general solvers get
//! wrong.
// Reference numbers keep the digits they were computed with.
#![allow(clippy::excessive_precision)]

use approx::assert_abs_diff_eq;
use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::formula::Formula;
use crate::common::simple::{Seen, Simple, told};
use crate::common::{
    Decay, Leine, Random, Table, count, exactly, friction_law, larger, on_belt, paper, ulp,
};
use stick_slip::{
    AnyLaw, Coulomb, Direction, Element, Error, Event, EventKind, Exponential, FrictionLaw,
    Integrator, MassOnBelt, Mode, Polynomial, Segment, State, Step, Trajectory,
};

const EPS: f64 = f64::EPSILON;

/// Asserts |actual − expected| ≤ allowed; a NaN fails.
#[track_caller]
fn assert_within(what: &str, actual: f64, expected: f64, allowed: f64) {
    let error = (actual - expected).abs();
    assert!(
        error <= allowed,
        "{what}: {actual:e}, not {expected:e}: off by {error:.2e}, allowed {allowed:.2e}"
    );
}

fn steps<L: FrictionLaw>(system: &MassOnBelt<L>, start: State, n: usize) -> Vec<Step> {
    let flow = Integrator::new().flow(system, start).unwrap();
    flow.take(n).collect::<Result<_, _>>().unwrap()
}

/// max(|u − ū|, |v|, |v_b|), by which tolerances are measured where nothing is stiff.
fn scale<L: FrictionLaw>(system: &MassOnBelt<L>, state: State) -> f64 {
    let equilibrium = system.equilibrium().map_or(0.0, |e| e.displacement);
    let deviation = state.displacement - equilibrium;
    deviation
        .abs()
        .max(state.velocity.abs())
        .max(system.belt_velocity().abs())
}

// -------------------------------------------------------------------------------------------------
// The eight promises
// -------------------------------------------------------------------------------------------------

/// Promise 1: a step is accepted only if the equation of motion holds inside it, so that terms
/// hidden behind an underflow are not missed. The flank of a Gaussian with v_s = 0.005 has no trace
/// in the power series at s = 1.
#[test]
fn promise_1_hidden_terms_are_not_missed() {
    let runs = count(300, 3000);
    const ALLOWED: f64 = 1e-7;
    let mut random = Random::new(1);
    let (mut wrong, mut worst, mut uncertainty, mut seen) = (0, 0.0_f64, 0.0_f64, 0);
    for run in 0..runs {
        let top = random.uniform(0.2, 0.8);
        let least = top * random.uniform(0.3, 0.95);
        let width = random.uniform(0.005, 0.05);
        let damping = random.uniform(0.0, 0.2);
        let load = random.logarithmic(0.2, 3.0);
        let belt = random.logarithmic(0.03, 1.0);
        let start = [random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)];
        let duration = random.uniform(2.0, 12.0);
        let system = on_belt(
            Exponential::new(top, least, width).unwrap(),
            belt,
            damping,
            load,
        );
        let motion = system
            .simulate(State::new(start[0], start[1]), duration)
            .unwrap();
        let seen_by_crate = told(motion.events());

        let formula = Formula::Exponential([top, least, width]);
        let reference = Simple::new(&formula, belt, damping, load);
        // So many steps while the speed changes by v_s: fine in the Gaussian, and short enough
        // outside not to jump across it.
        let difference = |fineness: f64| {
            let (events, [u, v]) = reference.run(start, duration, |[u, v]| {
                let largest = u.abs() + 2.0 * damping * v.abs() + load * top;
                let is_inside = (v - belt).abs() < 11.0 * width;
                let pieces = if is_inside { fineness } else { 1.0 };
                (width / (largest * pieces)).min(0.1 / fineness)
            });
            let kinds =
                |seen: &[Seen]| seen.iter().map(|seen| (seen.1, seen.2)).collect::<Vec<_>>();
            if kinds(&events) != kinds(&seen_by_crate) {
                return f64::INFINITY;
            }
            let times = std::iter::zip(&events, &seen_by_crate)
                // Where the mass sticks, the time of contact is ill-conditioned if it is shallow,
                // that of release is not.
                .filter(|(event, _)| event.1 != 's')
                .map(|(a, b)| (a.0 - b.0).abs());
            let (u, v) = (u - motion.last().displacement, v - motion.last().velocity);
            times.fold(u.abs().max(v.abs()), f64::max)
        };
        let error = difference(25.0);
        if error > ALLOWED || error.is_nan() {
            wrong += 1;
            println!("run {run}: off by {error:.1e}: {system:?}, {start:?}, duration {duration}");
        }
        worst = larger(worst, error);
        seen += motion.events().len();
        // The reference itself: steps of half the length leave the difference as it is.
        if run % 50 == 0 {
            uncertainty = uncertainty.max(difference(50.0));
        }
    }
    println!(
        "hidden terms: {wrong} of {runs} wrong, {seen} events; largest difference {worst:.1e}, \
         {uncertainty:.1e} with half the steps"
    );
    assert!(seen > runs);
    assert!(uncertainty <= 0.1 * ALLOWED, "{uncertainty:e}");
    assert_eq!(wrong, 0);
}

/// Grazing velocity of the paper's set to 25 digits; f64 rounds it by less than 3e-17.
const GRAZING: f64 = 0.3957902887978340118701080;

/// For d = 10⁻ᵏ, k = 3, 4, …, with v_b = GRAZING − d from the release point: time and displacement
/// of the contact, v_r' there, and time of the release after it. From a Taylor integration with 45
/// digits.
#[rustfmt::skip] // a row for each d
const SHALLOW: [(f64, f64, f64, f64); 13] = [
    (6.2682733985674600704, 0.3219962892668744307, 0.038524682, 6.3658560467391076272),
    (6.3363398275751922244, 0.3481444208443647879, 0.01228655, 6.3673907545847485600),
    (6.3577232533940805774, 0.3565267058245199006, 0.0038952653, 6.3675652425126604914),
    (6.3644686515645164721, 0.3591883036565240407, 0.0012327675, 6.3675833580474456899),
    (6.3665999907948212749, 0.3600310486616736047, 0.00038993246, 6.3675851907052267548),
    (6.3672738026337265287, 0.3602976549495508733, 0.00012331717, 6.3675853746385779027),
    (6.3674868628865502227, 0.3603819739372705881, 3.8997283e-5, 6.3675853930530254803),
    (6.3675542366758509804, 0.3604086390396097215, 1.2332121e-5, 6.3675853948951378922),
    (6.3675755419608027486, 0.3604170713525733079, 3.8997686e-6, 6.3675853950793702467),
    (6.3675822792656722029, 0.3604197379042212109, 1.2332161e-6, 6.3675853950977941498),
    (6.3675844097867604460, 0.3604205811429588050, 3.8997727e-7, 6.3675853950996365612),
    (6.3675850835165066703, 0.3604208477985677136, 1.2332165e-7, 6.3675853950998208030),
    (6.3675852965685414210, 0.3604209321224858844, 3.8997731e-8, 6.3675853950998392272),
];

friction_law! {
    /// Friction about one sliding speed that lies far from where the motion starts, in a law that
    /// is constant elsewhere: steps are long there. Told to the crate by breakpoints, or not.
    Bump { width, told }: 0.4,
    |s| (-((s - 0.6) / width).square()).exp() + 0.25,
    at [-7.0, 0.0, 7.0].map(|widths| 0.6 + widths * width).into_iter().filter(move |_| told == 1.0)
}

#[test]
fn promise_1_features_passed_in_a_long_step_are_seen() {
    for width in [0.05, 0.04, 0.03, 0.025, 0.02] {
        for start in 0..40 {
            let start = State::new(0.25, 0.7 + 0.01 * f64::from(start));
            let [seen, told] = [0.0, 1.0].map(|told| {
                let system = MassOnBelt::new(Bump { width, told }, 1.0).unwrap();
                system.simulate(start, 3.0).unwrap().last()
            });
            let apart = (seen.displacement - told.displacement).abs();
            assert!(apart < 1e-11, "{width} {start:?}: {seen:?} {told:?}");
        }
    }
}

/// Promise 2: a contact is found however shallow, in and out within one step, and none is invented.
#[test]
fn promise_2_shallow_grazing_contacts_are_found() {
    for (k, &(time, displacement, rate, release_time)) in std::iter::zip(3.., &SHALLOW) {
        let d = 10.0_f64.powi(-k);
        let system = paper(GRAZING - d);
        let start = system.release_state().unwrap();
        let motion = system.simulate(start, 7.0).unwrap();
        let [&first, &stick, &release] = exactly(motion.events());
        assert_eq!(first.time, 0.0);
        assert_eq!(stick.kind, EventKind::Stick, "d = {d:e}");
        assert_eq!(
            release.kind,
            EventKind::Release(Direction::Lagging),
            "d = {d:e}"
        );
        // f64 cannot hold v_b to better than EPS/8, nor μ_s, k1, k3: that moves the contact by
        // about EPS/rate.
        let allowed = 1e-12 + 4.0 * EPS / rate;
        assert_within(&format!("contact at d = {d:e}"), stick.time, time, allowed);
        assert_within(
            "its displacement",
            stick.state.displacement,
            displacement,
            allowed,
        );
        assert_within(
            &format!("release at d = {d:e}"),
            release.time,
            release_time,
            4e-15,
        );
        assert_eq!(release.state, start);

        let beyond = paper(GRAZING + d);
        let motion = beyond
            .simulate(beyond.release_state().unwrap(), 200.0)
            .unwrap();
        assert_eq!(
            motion.events().len(),
            1,
            "d = {d:e}: only the release at time 0: {:?}",
            motion.events()
        );
    }
}

/// The same with a law whose motion is a circle: u = c + r cos τ, v = −r sin τ, which overtakes the
/// belt if r > v_b.
#[test]
fn promise_2_shallow_contacts_of_a_circle() {
    let (v_b, centre) = (0.5, 0.25);
    let system = MassOnBelt::new(Coulomb::new(0.5, centre).unwrap(), v_b).unwrap();
    for k in 2..=48 {
        let depth = 0.5_f64.powi(k);
        let motion = |r: f64| system.simulate(State::new(centre + r, 0.0), 20.0).unwrap();
        let inside = motion(v_b - depth);
        assert_eq!(inside.events(), [], "depth -2^-{k}");
        let events = motion(v_b + depth).events().to_vec();
        assert!(!events.is_empty(), "depth 2^-{k}");
        let rate = (depth * (2.0 * v_b + depth)).sqrt();
        let time = PI + v_b.atan2(rate);
        assert_within(
            &format!("depth 2^-{k}"),
            events[0].time,
            time,
            4e-15 + 4.0 * EPS / rate,
        );
        assert_eq!(events[0].kind, EventKind::Stick);
        // Stick from u = c − √(r² − v_b²) to 0.5.
        let released = time + (0.5 - (centre - rate)) / v_b;
        assert_within("release", events[1].time, released, 1e-14);
    }
}

/// Promise 3: the known root at the start of a phase is divided out: no event repeats itself, none
/// is skipped, and the acceleration just after release is exactly −γ²(μ_s − μ̂(0)).
#[test]
fn promise_3_phase_starts_need_no_epsilon() {
    // μ̂(0) = μ_s: v_r = −v_b τ²/2 + …, for belt velocities of any size.
    for exponent in -40..=10 {
        let v_b = 2.0_f64.powi(exponent);
        let system = paper(v_b);
        let events = system
            .simulate(system.release_state().unwrap(), 1.0)
            .unwrap();
        assert_eq!(
            events.events().len(),
            1,
            "v_b = 2^{exponent}: {:?}",
            events.events()
        );
        let [_, &slip] = exactly(&steps(&system, system.release_state().unwrap(), 2));
        let t = 2.0_f64.powi(-20);
        let relative = (slip.state_at(t).velocity - v_b) / v_b;
        assert_within("-t²/2", relative, -0.5 * t * t, 4.0 * EPS + t * t * t);
    }
    // μ̂(0) < μ_s: v_r = −γ²(μ_s − μ_k) τ + ….
    let jump = on_belt(Coulomb::new(0.4, 0.25).unwrap(), 1e-3, 0.0, 2.0);
    let [&stick, &slip] = exactly(&steps(&jump, jump.release_state().unwrap(), 2));
    assert_eq!((stick.mode(), stick.duration()), (Mode::Stick, 0.0));
    let t = 2.0_f64.powi(-30);
    assert_within("-0.3 t", (slip.state_at(t).velocity - 1e-3) / t, -0.3, 1e-9);

    // A start an ulp beyond either end of the band slips at once, in the direction of −F; an ulp
    // inside it sticks.
    for system in [paper(0.2), paper(1e-3)] {
        let [low, high] = system.stick_limits();
        let v_b = system.belt_velocity();
        let start = |u: f64| system.simulate(State::new(u, v_b), 0.5).unwrap();
        let far_above = start(high + 1e-9);
        assert_eq!(far_above.mode_at(0.0), Some(Mode::Slip(Direction::Lagging)));
        assert_eq!(far_above.events(), []);
        let below = start(low.next_down());
        assert_eq!(below.mode_at(0.0), Some(Mode::Slip(Direction::Leading)));
        // Carried back into the band within ulps of time: one contact, then stick.
        assert_eq!(below.events()[0].kind, EventKind::Stick);
        assert!(below.events()[0].time < 1e-11, "{:?}", below.events());
        for inside in [low, low.next_up()] {
            assert_eq!(start(inside).mode_at(0.0), Some(Mode::Stick));
        }
        assert_eq!(
            start(low).events().len(),
            start(low.next_up()).events().len()
        );
    }
}

/// Promise 4: stick is closed-form, and in stick the velocity is v_b to the bit.
#[test]
fn promise_4_stick_is_closed_form() {
    let mut random = Random::new(4);
    let mut seen = 0;
    for _ in 0..300 {
        let system = random.system();
        let start = State::new(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
        let v_b = system.belt_velocity();
        let release = system.release_state().unwrap();
        let motion = system.simulate(start, 30.0).unwrap();
        for (step, next) in std::iter::zip(motion.steps(), &motion.steps()[1..]) {
            if step.mode() != Mode::Stick {
                continue;
            }
            seen += 1;
            let u = step.state().displacement;
            assert_eq!(step.state().velocity, v_b);
            // To an ulp of the terms of the division.
            let duration = (release.displacement - u) / v_b;
            assert_within("duration", step.duration(), duration, 0.0);
            assert_eq!(next.state(), release);
            for i in 0..=10 {
                let t = step.duration() * f64::from(i) / 10.0;
                let state = step.state_at(t);
                assert_eq!(state.velocity.to_bits(), v_b.to_bits());
                assert_within(
                    "u + v_b t",
                    state.displacement,
                    u + v_b * t,
                    EPS * release.displacement.abs().max(u.abs()),
                );
                let time = step.start_time() + t;
                if motion.mode_at(time) == Some(Mode::Stick) {
                    assert_eq!(
                        motion.state_at(time).unwrap().velocity.to_bits(),
                        v_b.to_bits()
                    );
                }
            }
        }
        for event in motion.events() {
            assert_eq!(event.state.velocity.to_bits(), v_b.to_bits());
        }
    }
    assert!(seen > 200, "{seen} stick phases");
}

/// Promise 5: states are continuous, times never decrease and strictly increase over a phase longer
/// than their ulp, and the same call gives the same bits.
#[test]
fn promise_5_motion_is_continuous_and_ordered_and_repeatable() {
    let mut random = Random::new(5);
    let mut worst = 0.0_f64;
    for _ in 0..300 {
        let system = random.system();
        let start = State::new(random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0));
        let motion = system.simulate(start, 40.0).unwrap();
        assert_eq!(motion.steps()[0].state(), start);
        assert_eq!(motion.steps()[0].start_time(), 0.0);
        for (step, next) in std::iter::zip(motion.steps(), &motion.steps()[1..]) {
            assert_eq!(step.end_time(), next.start_time());
            assert!(step.duration() >= 0.0);
            if step.duration() > ulp(step.end_time()) {
                assert!(next.start_time() > step.start_time());
            }
            let (end, begin) = (step.state_at(step.duration()), next.state());
            let gap = (end.displacement - begin.displacement)
                .abs()
                .max((end.velocity - begin.velocity).abs());
            let scale = scale(&system, begin).max(begin.displacement.abs());
            worst = larger(worst, gap / scale);
            assert!(gap <= 1e-14 * scale, "{gap:e} at {step:?}");
            match step.event() {
                Some(event) => {
                    assert_eq!((event.time, event.state), (step.end_time(), begin));
                    assert_eq!(event.kind.mode(), next.mode());
                    assert_ne!(step.mode(), next.mode());
                }
                None => assert_eq!(step.mode(), next.mode()),
            }
        }
        assert!(motion.events().is_sorted_by(|a, b| a.time <= b.time));
        // The same call, the same bits; flow is simulate, step by step.
        assert_eq!(system.simulate(start, 40.0).unwrap(), motion);
        let flow = steps(&system, start, motion.steps().len() - 1);
        assert_eq!(flow, motion.steps()[..flow.len()]);
    }
    println!("continuity: largest gap {worst:.1e} of the scale");
}

/// Promise 6, first half: v_r is the variable, so contact is exact to the last bits however large
/// the belt velocity.
#[test]
fn promise_6_contact_is_exact_for_large_belt_velocities() {
    let mut random = Random::new(6);
    let mut worst = 0.0_f64;
    for _ in 0..2000 {
        // Coulomb without damping: s = 2v_b sin²(τ/2) + s_0 cos τ + (u_0 − γ²μ_k) sin τ, lagging.
        let v_b = random.logarithmic(1.0, 1e12);
        let friction = v_b * random.uniform(1.0, 10.0);
        let system = on_belt(Coulomb::new(1.0, 1.0).unwrap(), v_b, 0.0, friction);
        let velocity = v_b - v_b * random.logarithmic(1e-12, 1e-3);
        let speed = v_b - velocity;
        assert!(speed > 0.0);
        let u = random.uniform(-0.5, 0.5) * friction;
        let pull = u - friction;
        let s = |t: f64| 2.0 * v_b * (0.5 * t).sin().powi(2) + speed * t.cos() + pull * t.sin();
        let rate = |t: f64| v_b * t.sin() - speed * t.sin() + pull * t.cos();
        let mut time = -speed / pull;
        for _ in 0..20 {
            time -= s(time) / rate(time);
        }
        let event = system
            .simulate(State::new(u, velocity), 1.0)
            .unwrap()
            .events()[0];
        assert_eq!(event.kind, EventKind::Stick);
        worst = larger(worst, (event.time / time - 1.0).abs());
    }
    println!(
        "large belt velocities: contact time off by {:.1} EPS at most",
        worst / EPS
    );
    assert!(worst <= 8.0 * EPS, "{worst:e}");
}

/// Arc durations of the paper's Fig. 5 set to 25 digits.
const SLIP: f64 = 5.169862999532133977881022;
const STICK: f64 = 1.629558444940023626973190;

/// Promise 6, second half: time stays good over 10⁵ cycles, 7·10⁵ units.
#[test]
fn promise_6_time_does_not_drift_over_a_hundred_thousand_cycles() {
    const CYCLES: usize = 100_000;
    let system = paper(0.2);
    let flow = Integrator::new()
        .flow(&system, system.release_state().unwrap())
        .unwrap();
    let mut period = f64::NAN;
    let (mut slip, mut n, mut worst) = (f64::NAN, 0_usize, 0.0_f64);
    for event in flow.filter_map(|step| step.unwrap().event()) {
        match n {
            0 => assert_eq!(event.time, 0.0),
            1 => {
                slip = event.time;
                assert_within("slip", slip, SLIP, 4e-15);
            }
            2 => {
                period = event.time;
                assert_within("stick", period - slip, STICK, 4e-15);
            }
            _ => (),
        }
        let expected_kind = match n % 2 {
            0 => EventKind::Release(Direction::Lagging),
            _ => EventKind::Stick,
        };
        assert_eq!(event.kind, expected_kind);
        if n > 2 {
            let phase = if n % 2 == 1 { slip } else { 0.0 };
            let expected = (n / 2) as f64 * period + phase;
            worst = larger(worst, (event.time - expected).abs() / ulp(event.time));
            assert!(
                worst <= 4.0,
                "event {n}: {} is {worst} ulp off {expected}",
                event.time
            );
        }
        n += 1;
        if n > 2 * CYCLES {
            break;
        }
    }
    println!("10^5 cycles: {worst:.2} ulp off a multiple of the period at most");
}

/// Events and states of one motion in other units: u, v, v_b and the law's speeds times `length`,
/// the forces too.
fn scaled(length: f64, tolerance: f64) -> (Trajectory, Trajectory) {
    let motion = |length: f64| {
        let law = Polynomial::new(0.4, 0.25, 0.5 * length).unwrap();
        let system = on_belt(law, 0.2 * length, 0.05, length);
        Integrator::new()
            .with_tolerance(tolerance)
            .and_then(|integrator| {
                integrator.simulate(&system, State::new(0.3 * length, -1.1 * length), 50.0)
            })
            .unwrap()
    };
    (motion(1.0), motion(length))
}

/// Promise 7: tolerance is relative to the motion's own scale: other units, the same motion. A
/// power of two changes no bit.
#[test]
fn promise_7_scaling_the_units_scales_the_result() {
    for tolerance in [1e-4, 1e-9, 1e-16] {
        for exponent in [-100, -30, -1, 1, 30, 100] {
            let length = 2.0_f64.powi(exponent);
            let (motion, other) = scaled(length, tolerance);
            assert_eq!(motion.steps().len(), other.steps().len());
            for (a, b) in std::iter::zip(motion.steps(), other.steps()) {
                assert_eq!(
                    (a.start_time(), a.duration(), a.mode()),
                    (b.start_time(), b.duration(), b.mode())
                );
                assert_eq!(a.state().displacement * length, b.state().displacement);
                assert_eq!(a.state().velocity * length, b.state().velocity);
            }
        }
        for length in [1e-8, 0.3, 7.0, 1e8] {
            let (motion, other) = scaled(length, tolerance);
            assert_eq!(motion.events().len(), other.events().len());
            let allowed = 1e-12 + 100.0 * tolerance;
            for (a, b) in std::iter::zip(motion.events(), other.events()) {
                assert_eq!(a.kind, b.kind);
                assert_within("time", b.time, a.time, allowed);
                assert_within(
                    "u",
                    b.state.displacement / length,
                    a.state.displacement,
                    allowed,
                );
            }
        }
    }
}

/// Promise 8: what cannot go on is an error with the time and state reached, and nothing after it;
/// never a panic or a hang. Every variant has its own test elsewhere.
#[test]
fn promise_8_what_cannot_go_on_is_an_error_with_time_and_state() {
    // So stiff at the start that no step moves the clock further: the cubic, far away.
    let stiff = paper(0.2);
    let mut flow = Integrator::new()
        .flow(&stiff, State::new(0.0, 1e160))
        .unwrap();
    let error = flow
        .by_ref()
        .take(100_000)
        .find_map(Result::err)
        .expect("the motion cannot be followed");
    let reached = match error {
        Error::StepUnderflow { reached, .. } => reached,
        Error::NonFiniteFriction { reached, .. } => reached.expect("an integration was under way"),
        other => panic!("{other}"),
    };
    assert_eq!(reached.state.velocities, [1e160]);
    assert!(flow.next().is_none());
    assert!(flow.next().is_none());

    let limited = Integrator::new().with_max_events(7).unwrap();
    let system = paper(0.2);
    let events: Vec<_> = limited
        .flow(&system, State::new(0.0, 0.0))
        .unwrap()
        .filter(|step| step.as_ref().map_or(true, |step| step.event().is_some()))
        .collect();
    let Some((Err(Error::TooManyEvents { limit: 7, reached }), before)) = events.split_last()
    else {
        panic!("{events:?}")
    };
    // A run that goes on after more than seven.
    assert_eq!(before.len(), 8);
    assert!(reached.time >= before[7].as_ref().unwrap().end_time());
}

// -------------------------------------------------------------------------------------------------
// Published and closed-form motions
// -------------------------------------------------------------------------------------------------

/// Largest displacement between two times: where v = 0, found by bisection of the dense output.
fn largest_displacement(motion: &Trajectory, from: f64, to: f64) -> f64 {
    const SAMPLES: usize = 2000;
    let state = |time: f64| motion.state_at(time).unwrap();
    let time = |i: usize| from + (to - from) * i as f64 / SAMPLES as f64;
    let mut largest = f64::NEG_INFINITY;
    for i in 0..SAMPLES {
        let (mut a, mut b) = (time(i), time(i + 1));
        if state(a).velocity > 0.0 && state(b).velocity <= 0.0 {
            for _ in 0..60 {
                let middle = 0.5 * (a + b);
                if state(middle).velocity > 0.0 {
                    a = middle;
                } else {
                    b = middle;
                }
            }
            largest = largest.max(state(a).displacement);
        }
    }
    largest
}

/// Leine et al. 1998, written by a user: largest displacement by ifdiff's example "stickslip",
/// period by a 25-digit computation.
#[test]
fn leine_oscillator_has_the_published_amplitude_and_period() {
    let law = Leine {
        static_coefficient: 1.0,
        decay: 3.0,
    };
    let system = MassOnBelt::new(law, 0.2).unwrap();
    let motion = system.simulate(State::new(0.0, 0.0), 40.0).unwrap();
    let releases: Vec<f64> = motion
        .events()
        .iter()
        .filter(|event| event.kind == EventKind::Release(Direction::Lagging))
        .map(|event| event.time)
        .collect();
    assert_within("period", releases[1] - releases[0], 12.0010312948, 1e-9);
    let largest = largest_displacement(&motion, releases[0], releases[1]);
    assert_within("largest displacement", largest, 1.133944669704, 1e-8);
    println!(
        "Leine: period {:.13}, largest displacement {largest:.13}",
        releases[1] - releases[0]
    );
}

/// Siconos' FrictionOscillator, and the exact law of free vibration: each half turn shifts the
/// amplitude by 2γ²μ_k.
#[test]
fn free_vibration_of_coulomb_falls_by_4_mu_a_cycle_until_it_rests() {
    let system = MassOnBelt::new(Coulomb::new(1.0, 1.0).unwrap(), 0.0).unwrap();
    let motion = system.simulate(State::new(12.0, 6.0), 100.0).unwrap();
    let events = motion.events();
    let published = [
        13.3178, -11.3177, 9.3179, -7.3179, 5.3179, -3.3179, 1.3180, 0.682,
    ];
    assert_eq!(
        events.len(),
        published.len() - 1 + usize::from(events.len() == published.len())
    );
    // u = −1 + 13 cos τ + 6 sin τ until the first turning point at amplitude √205 − 1.
    let amplitude = 205.0_f64.sqrt() - 1.0;
    let first = 6.0_f64.atan2(13.0);
    let (mut sign, mut worst) = (1.0, 0.0_f64);
    for (n, event) in events.iter().enumerate() {
        let exact = sign * (amplitude - 2.0 * n as f64);
        let time = first + n as f64 * PI;
        worst = worst
            .max((event.state.displacement - exact).abs())
            .max((event.time - time).abs());
        // Their step is 0.01.
        assert_within(
            "Siconos",
            event.state.displacement.abs(),
            f64::abs(published[n]),
            2e-4,
        );
        assert_eq!(event.state.velocity, 0.0);
        sign = -sign;
    }
    println!("free vibration: worst error {worst:.1e}");
    assert!(worst <= 2e-14, "{worst:e}");
    assert_eq!(events.last().unwrap().kind, EventKind::Stick);
    assert_within("rest", motion.last().displacement.abs(), 0.68217894, 1e-8);
    assert_eq!(motion.last(), events.last().unwrap().state);
    assert_eq!(motion.mode_at(100.0), Some(Mode::Stick));
}

// -------------------------------------------------------------------------------------------------
// Tolerance
// -------------------------------------------------------------------------------------------------

/// Largest error of states and event times over one period from the release point, in units of the
/// scale of the motion.
fn error_over_a_period<L: FrictionLaw>(system: &MassOnBelt<L>, tolerance: f64) -> f64 {
    let start = system.release_state().unwrap();
    let exact = system.simulate(start, 100.0).unwrap();
    let period = exact.events()[2].time;
    let coarse = Integrator::new()
        .with_tolerance(tolerance)
        .and_then(|integrator| integrator.simulate(system, start, period + 1.0))
        .unwrap();
    let mut largest = 0.0_f64;
    for i in 0..=500 {
        let time = period * f64::from(i) / 500.0;
        largest = largest.max(scale(system, exact.state_at(time).unwrap()));
    }
    let mut error = 0.0_f64;
    for i in 0..=500 {
        let time = period * f64::from(i) / 500.0;
        let (a, b) = (
            exact.state_at(time).unwrap(),
            coarse.state_at(time).unwrap(),
        );
        error = error
            .max((a.displacement - b.displacement).abs())
            .max((a.velocity - b.velocity).abs());
    }
    for (a, b) in std::iter::zip(exact.events(), coarse.events()) {
        assert_eq!(a.kind, b.kind);
        error = larger(
            error,
            (a.time - b.time).abs() * system.belt_velocity().abs(),
        );
    }
    error / largest
}

/// The error over a period is within a factor 100 of the tolerance asked for, from 1e-4 to
/// round-off.
#[test]
fn requested_tolerance_is_met() {
    let exponential = on_belt(Exponential::new(0.4, 0.25, 0.5).unwrap(), 0.2, 0.05, 1.0);
    let leine = MassOnBelt::new(
        Leine {
            static_coefficient: 1.0,
            decay: 3.0,
        },
        0.2,
    )
    .unwrap();
    let decay = Decay {
        static_coefficient: 0.6,
        kinetic_coefficient: 0.3,
        velocity: 0.1,
    };
    let decay = on_belt(decay, 0.3, 0.02, 1.0);
    println!("tolerance  polynomial  exponential  rational  exp(-s)");
    // The motion compared with is that at 1e-16, which the reference data vouch for.
    for exponent in 4..=15 {
        let tolerance = 10.0_f64.powi(-exponent);
        let errors = [
            error_over_a_period(&paper(0.2), tolerance),
            error_over_a_period(&exponential, tolerance),
            error_over_a_period(&leine, tolerance),
            error_over_a_period(&decay, tolerance),
        ];
        println!(
            "1e-{exponent:02}  {}",
            errors.map(|error| format!("{error:11.1e}")).concat()
        );
        for error in errors {
            assert!(
                error <= 100.0 * tolerance,
                "{error:e} at tolerance {tolerance:e}"
            );
        }
    }
}

// -------------------------------------------------------------------------------------------------
// Laws with breakpoints
// -------------------------------------------------------------------------------------------------

/// The exact motion under a piecewise linear law: on each piece a damped oscillation in closed
/// form.
struct Exact<'a> {
    system: &'a MassOnBelt<Table>,
    time: f64,
    state: State,
    /// σ in slip, with the piece of the law; `None` in stick.
    slip: Option<(f64, usize)>,
    events: Vec<Event>,
}

/// u and v of a damped oscillation about `centre` after a time t.
fn oscillation(decay: f64, centre: f64, start: State, t: f64) -> State {
    let half = 0.5 * decay;
    let frequency = (1.0 - half * half).sqrt();
    let (sin, cos) = (frequency * t).sin_cos();
    let a = start.displacement - centre;
    let b = (start.velocity + half * a) / frequency;
    let fade = (-half * t).exp();
    State::new(
        centre + fade * (a * cos + b * sin),
        fade * (start.velocity * cos - (a + half * start.velocity) / frequency * sin),
    )
}

impl<'a> Exact<'a> {
    fn new(system: &'a MassOnBelt<Table>, start: State) -> Self {
        let v_r = start.velocity - system.belt_velocity();
        let table = system.law();
        let mut slip = None;
        if v_r != 0.0 {
            let mut piece = table.piece(v_r.abs());
            if piece > 0 && table.points[piece].0 == v_r.abs() {
                let rate = v_r.signum() * system.acceleration(start);
                let rising = rate > 0.0 || (rate == 0.0 && v_r.signum() * start.velocity < 0.0);
                piece -= usize::from(!rising);
            }
            slip = Some((v_r.signum(), piece));
        }
        Self {
            system,
            time: 0.0,
            state: start,
            slip,
            events: Vec::new(),
        }
    }

    /// 2β + γ²m and the centre of the oscillation on a piece with μ̂ = c + m(s − s_0).
    fn oscillator(&self, sigma: f64, piece: usize) -> (f64, f64) {
        let (c, s0, slope) = self.system.law().line(piece);
        let load = self.system.load();
        let decay = 2.0 * self.system.damping() + load * slope;
        let centre = load * (slope * self.system.belt_velocity() - sigma * (c - slope * s0));
        (decay, centre)
    }

    /// State after a time t on the present piece.
    fn after(&self, t: f64) -> State {
        match self.slip {
            None => State::new(
                self.state.displacement + self.state.velocity * t,
                self.state.velocity,
            ),
            Some((sigma, piece)) => {
                let (decay, centre) = self.oscillator(sigma, piece);
                oscillation(decay, centre, self.state, t)
            }
        }
    }

    /// The first time in (0, longest] at which s leaves the present piece, and the limit it
    /// reaches.
    fn exit(&self, sigma: f64, piece: usize, longest: f64) -> Option<(f64, f64)> {
        let points = &self.system.law().points;
        let (low, high) = (points[piece].0, points[piece + 1].0);
        let high = if piece + 2 == points.len() {
            f64::INFINITY
        } else {
            high
        };
        let v_b = self.system.belt_velocity();
        let speed = |t: f64| sigma * (self.after(t).velocity - v_b);
        let (decay, centre) = self.oscillator(sigma, piece);
        let rate = |t: f64| {
            let State {
                displacement,
                velocity,
            } = self.after(t);
            sigma * (centre - displacement - decay * velocity)
        };
        let outside = |t: f64| {
            let s = speed(t);
            (s <= low).then_some(low).or((s >= high).then_some(high))
        };
        const H: f64 = 1e-3;
        let mut a = 0.0;
        while a < longest {
            let b = (a + H).min(longest);
            let mut end = outside(b).map(|limit| (b, limit));
            if end.is_none() && rate(a) * rate(b) < 0.0 {
                // In and out between two samples: look at the extremum.
                let (mut x, mut y) = (a, b);
                for _ in 0..60 {
                    let middle = 0.5 * (x + y);
                    if rate(a) * rate(middle) > 0.0 {
                        x = middle;
                    } else {
                        y = middle;
                    }
                }
                end = outside(x).filter(|_| x > 1e-9).map(|limit| (x, limit));
            }
            if let Some((end, limit)) = end {
                let (mut x, mut y) = (a.max(1e-12), end);
                for _ in 0..80 {
                    let middle = 0.5 * (x + y);
                    if outside(middle).is_none() {
                        x = middle;
                    } else {
                        y = middle;
                    }
                }
                return Some((y, limit));
            }
            a = b;
        }
        None
    }

    fn run(&mut self, duration: f64) {
        let v_b = self.system.belt_velocity();
        let release = self.system.release_state().unwrap();
        let [low, high] = self.system.stick_limits();
        while self.time < duration {
            let left = duration - self.time;
            let Some((sigma, piece)) = self.slip else {
                let stick = (release.displacement - self.state.displacement) / v_b;
                if stick > left {
                    (self.state, self.time) = (self.after(left), duration);
                    return;
                }
                self.time += stick;
                self.state = release;
                self.slip = Some((-v_b.signum(), 0));
                let direction = if v_b > 0.0 {
                    Direction::Lagging
                } else {
                    Direction::Leading
                };
                self.event(EventKind::Release(direction));
                continue;
            };
            let Some((t, limit)) = self.exit(sigma, piece, left) else {
                (self.state, self.time) = (self.after(left), duration);
                return;
            };
            let u = self.after(t).displacement;
            self.time += t;
            self.state = State::new(u, v_b + sigma * limit);
            if limit > 0.0 {
                let points = &self.system.law().points;
                let up = limit == points[piece + 1].0;
                self.slip = Some((sigma, if up { piece + 1 } else { piece - 1 }));
            } else if low < u && u < high {
                self.slip = None;
                self.event(EventKind::Stick);
            } else {
                self.slip = Some((-sigma, 0));
                let direction = if sigma > 0.0 {
                    Direction::Lagging
                } else {
                    Direction::Leading
                };
                self.event(EventKind::Crossing(direction));
            }
        }
    }

    fn event(&mut self, kind: EventKind) {
        let (time, state) = (self.time, self.state);
        self.events.push(Event {
            time,
            element: Element::Contact(0),
            kind,
            state,
        });
    }
}

/// Compares a motion with the exact one: events and the last state. Returns the largest difference.
#[track_caller]
fn compare_with_exact(system: &MassOnBelt<Table>, start: State, duration: f64) -> f64 {
    let motion = system.simulate(start, duration).unwrap();
    let mut exact = Exact::new(system, start);
    exact.run(duration);
    let kinds = |events: &[Event]| events.iter().map(|event| event.kind).collect::<Vec<_>>();
    assert_eq!(
        kinds(motion.events()),
        kinds(&exact.events),
        "{system:?} {start:?}"
    );
    let mut worst = (motion.last().displacement - exact.state.displacement)
        .abs()
        .max((motion.last().velocity - exact.state.velocity).abs());
    for (a, b) in std::iter::zip(motion.events(), &exact.events) {
        worst = worst
            .max((a.time - b.time).abs())
            .max((a.state.displacement - b.state.displacement).abs());
    }
    worst
}

/// A table with falls and rises, on dyadic speeds so that starts on them are exact.
fn table() -> Table {
    Table {
        static_coefficient: 0.5,
        points: vec![
            (0.0, 0.45),
            (0.125, 0.3),
            (0.375, 0.25),
            (0.75, 0.35),
            (1.0, 0.2),
            (2.0, 0.6),
        ],
    }
}

fn table_system(v_b: f64) -> MassOnBelt<Table> {
    on_belt(table(), v_b, 0.03, 0.75)
}

#[test]
fn breakpoints_are_crossed_upwards_and_downwards() {
    let mut random = Random::new(21);
    let (mut worst, mut events) = (0.0_f64, 0);
    for _ in 0..200 {
        let system = table_system(random.sign() * random.logarithmic(0.1, 1.0));
        let start = State::new(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
        worst = larger(worst, compare_with_exact(&system, start, 15.0));
        events += system.simulate(start, 15.0).unwrap().events().len();
    }
    println!("breakpoints crossed: {events} events, largest difference {worst:.1e}");
    assert!(events > 200);
    // Steps of 1e-3 in `Exact` decide nothing here: it bisects closed forms.
    assert!(worst <= 1e-12, "{worst:e}");
}

#[test]
fn breakpoints_are_started_on() {
    let mut worst = (0.0_f64, String::new());
    for v_b in [0.25, -0.25, 0.2, -0.7] {
        let system = table_system(v_b);
        for breakpoint in table().breakpoints() {
            for sigma in [-1.0, 1.0] {
                // Speeding up and slowing down, and turning round there: u where the acceleration
                // is zero, and some ulps beside.
                let v = v_b + sigma * breakpoint;
                let turning = system.acceleration(State::new(0.0, v));
                let near = (-8..=8).map(|n| turning + f64::from(n) * 0.5 * ulp(turning));
                for u in near.chain([-1.5, -0.3, 0.2, 0.9]) {
                    let start = State::new(u, v);
                    let difference = compare_with_exact(&system, start, 4.0);
                    if difference > worst.0 {
                        worst = (difference, format!("v_b = {v_b}, {start:?}"));
                    }
                }
            }
        }
    }
    println!("breakpoints started on: largest difference {:.1e}", worst.0);
    assert!(worst.0 <= 1e-12, "{:.1e} for {}", worst.0, worst.1);
}

#[test]
fn breakpoints_are_grazed() {
    let system = table_system(0.25);
    let mut worst = 0.0_f64;
    for (n, breakpoint) in table().breakpoints().enumerate() {
        for sigma in [-1.0, 1.0] {
            for (piece, side) in [(n, -1.0), (n + 1, 1.0)] {
                for depth in [
                    1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 1e-15, 0.0, -1e-12, -1e-6, -1e-3,
                ] {
                    // The turning point of v on the far side of the breakpoint by `depth`, run back
                    // on this piece.
                    let v = 0.25 + sigma * (breakpoint - side * depth);
                    let frame = Exact {
                        slip: Some((sigma, piece)),
                        ..Exact::new(&system, State::new(0.0, v))
                    };
                    let (decay, centre) = frame.oscillator(sigma, piece);
                    let turning = State::new(centre - decay * v, v);
                    // s'' = −σv must bend away from the breakpoint.
                    if side * -sigma * v <= 0.0 {
                        continue;
                    }
                    let start = oscillation(decay, centre, turning, -0.1);
                    worst = larger(worst, compare_with_exact(&system, start, 2.0));
                }
            }
        }
    }
    println!("breakpoints grazed: largest difference {worst:.1e}");
    assert!(worst <= 1e-12, "{worst:e}");
}

/// A table whose points lie on a straight line is that line: breakpoints change nothing but the
/// steps.
#[test]
fn breakpoints_of_a_straight_line_change_nothing() {
    let line = |speeds: &[f64]| Table {
        static_coefficient: 0.5,
        points: speeds.iter().map(|&s| (s, 0.5 - 0.125 * s)).collect(),
    };
    let mut random = Random::new(23);
    for _ in 0..100 {
        let v_b = random.uniform(0.1, 1.0);
        let plain = MassOnBelt::new(line(&[0.0, 4.0]), v_b).unwrap();
        let kinked = MassOnBelt::new(line(&[0.0, 0.25, 0.5, 0.75, 1.5, 2.0, 4.0]), v_b).unwrap();
        let start = State::new(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
        let [a, b] = [&plain, &kinked].map(|system| system.simulate(start, 20.0).unwrap());
        assert_eq!(a.events().len(), b.events().len());
        for (a, b) in std::iter::zip(a.events(), b.events()) {
            assert_eq!(a.kind, b.kind);
            assert_within("time", b.time, a.time, 1e-12);
        }
        for (time, state) in a.sample(50) {
            let other = b.state_at(time).unwrap();
            assert_within("u", other.displacement, state.displacement, 1e-12);
            assert_within("v", other.velocity, state.velocity, 1e-12);
        }
    }
}

// -------------------------------------------------------------------------------------------------
// Starts and ends
// -------------------------------------------------------------------------------------------------

/// Ways to write u = ±γ²μ_s − 2βv_b.
fn release_by_hand(system: &MassOnBelt<AnyLaw>) -> [f64; 6] {
    let (load, beta, v_b) = (system.load(), system.damping(), system.belt_velocity());
    let mu = system.law().static_coefficient() * v_b.signum();
    [
        load * mu - 2.0 * beta * v_b,
        mu * load - beta * (2.0 * v_b),
        -(v_b * beta * 2.0) + load * mu,
        -2.0 * beta * v_b + mu * load,
        load.mul_add(mu, -(2.0 * (beta * v_b))),
        (-2.0 * beta).mul_add(v_b, mu * load),
    ]
}

/// The release state, computed by the system or by hand, releases at time 0, and the next event is
/// the same to round-off.
#[test]
fn release_state_releases_at_time_zero() {
    let systems = count(1000, 10_000);
    let mut random = Random::new(31);
    let (mut worst, mut different, mut compared, mut grazing) = (0.0_f64, 0, 0, 0);
    for n in 0..systems {
        let system = random.system();
        let v_b = system.belt_velocity();
        let release = system.release_state().unwrap();
        let expected = EventKind::Release(if v_b > 0.0 {
            Direction::Lagging
        } else {
            Direction::Leading
        });
        let start = |u: f64| {
            let mut flow = Integrator::new().flow(&system, State::new(u, v_b)).unwrap();
            let first = flow.next().unwrap().unwrap();
            let event = first
                .event()
                .unwrap_or_else(|| panic!("system {n} {system:?}: no event for u = {u}"));
            assert_eq!(
                (event.time, event.kind),
                (0.0, expected),
                "system {n}: u = {u}"
            );
            assert_eq!(event.state, State::new(u, v_b));
            flow.take(200)
                .map(Result::unwrap)
                .take_while(|step| step.start_time() < 30.0)
                .find_map(|step| step.event())
        };
        let next = start(release.displacement);
        for u in release_by_hand(&system) {
            different += usize::from(u != release.displacement);
            let other = start(u);
            let (Some(a), Some(b)) = (next, other) else {
                assert_eq!(
                    next.is_some(),
                    other.is_some(),
                    "system {n}: {next:?} {other:?}"
                );
                continue;
            };
            assert_eq!(a.kind, b.kind, "system {n}");
            // A contact moves with the start by its own condition: by 1/|v_r'| before it.
            let before = system.acceleration(State::new(a.state.displacement, v_b * (1.0 - 1e-9)));
            if before.abs() < 1e-3 {
                grazing += 1;
                continue;
            }
            compared += 1;
            let size = a
                .state
                .displacement
                .abs()
                .max(release.displacement.abs())
                .max(v_b.abs());
            worst = larger(
                worst,
                (a.time - b.time).abs() * before.abs().min(1.0) / size,
            );
        }
    }
    println!(
        "release by hand: {different} of {} written differently in bits; next event off by \
         {worst:.1e} at most; {compared} compared, {grazing} nearly grazing",
        6 * systems
    );
    assert!(different > systems / 10);
    assert!(compared > systems);
    assert!(worst <= 1e-13, "{worst:e}");
}

/// Both ends of the half-open band, for belts that run forward and backward.
#[test]
fn ends_of_the_stick_band_are_half_open() {
    for v_b in [0.2, -0.2] {
        let system = paper(v_b);
        let release = system.release_state().unwrap();
        let [low, high] = system.stick_limits();
        let (closed, open) = if v_b > 0.0 { (low, high) } else { (high, low) };
        assert_eq!(open, release.displacement);
        let at_closed = system.simulate(State::new(closed, v_b), 10.0).unwrap();
        assert_eq!(at_closed.mode_at(0.0), Some(Mode::Stick));
        assert_within(
            "the whole band",
            at_closed.events()[0].time,
            (open - closed) / v_b,
            0.0,
        );
    }
    // v_b = 0: closed at both ends, rest for ever.
    let system = paper(0.0);
    for u in [-0.4, 0.4, 0.0, -0.0] {
        let motion = system.simulate(State::new(u, 0.0), 1e6).unwrap();
        assert_eq!(
            (motion.events(), motion.last()),
            (&[][..], State::new(u, 0.0))
        );
    }
    for u in [0.4_f64.next_up(), -(0.4_f64.next_up())] {
        let motion = system.simulate(State::new(u, 0.0), 1.0).unwrap();
        let direction = if u > 0.0 {
            Direction::Lagging
        } else {
            Direction::Leading
        };
        assert_eq!(motion.mode_at(0.0), Some(Mode::Slip(direction)));
    }
}

/// An ulp outside the band of a belt at rest, the force on a mass is no larger than its rounding.
/// It rests, or it slides towards the band: it never moves away from it.
#[test]
fn beside_the_band_of_a_belt_at_rest_no_mass_moves_outwards() {
    for load in [0.011, 1.0, 7.3, 1e4] {
        for damping in [0.05, 1.0, 5.0, 10.0] {
            let system = on_belt(Polynomial::new(0.4, 0.25, 0.5).unwrap(), 0.0, damping, load);
            let [low, high] = system.stick_limits();
            for start in [high.next_up(), low.next_down()] {
                let flow = Integrator::new().flow(&system, State::new(start, 0.0));
                for step in flow.unwrap().take(200) {
                    let end = step.unwrap().end_state();
                    assert!(
                        end.displacement.abs() <= start.abs(),
                        "{load} {damping}: from {start:e} to {end:?}"
                    );
                }
            }
        }
    }
}

/// Arriving from leading exactly at the open end of the band is a crossing.
#[test]
fn arrival_at_the_open_end_from_leading_is_a_crossing() {
    // Coulomb without damping, leading: u = −1/4 + r sin τ, v = r cos τ; at τ = 0, v = r. Contact
    // where r cos τ = v_b, at u = −1/4 + √(r² − v_b²). With v_b = 3/8, √ = 1/2 and r = 5/8: u = 1/4
    // = γ²μ_s exactly.
    let system = MassOnBelt::new(Coulomb::new(0.25, 0.25).unwrap(), 0.375).unwrap();
    let motion = system.simulate(State::new(-0.25, 0.625), 1.5).unwrap();
    let event = motion.events()[0];
    assert_within("time", event.time, (0.6_f64).acos(), 4.0 * EPS);
    assert_within("u", event.state.displacement, 0.25, EPS);
    // Rounding may put the arrival an ulp inside the band; then it sticks for no time and is
    // released at once.
    let kinds: Vec<EventKind> = motion.events().iter().map(|event| event.kind).collect();
    let lagging = Direction::Lagging;
    if event.state.displacement >= 0.25 {
        assert_eq!(kinds, [EventKind::Crossing(lagging)]);
    } else {
        assert_eq!(kinds, [EventKind::Stick, EventKind::Release(lagging)]);
    }
    assert_eq!(motion.mode_at(1.5), Some(Mode::Slip(lagging)));
}

/// Asserts that two states differ by no more than the motion within a few ulps of the time.
#[track_caller]
fn assert_near<L: FrictionLaw>(system: &MassOnBelt<L>, time: f64, actual: State, expected: State) {
    let rate = expected.displacement.abs()
        + (1.0 + 2.0 * system.damping()) * expected.velocity.abs()
        + system.load() * system.law().static_coefficient();
    let allowed = 4.0 * (ulp(time) + EPS) * rate;
    assert_within("u", actual.displacement, expected.displacement, allowed);
    assert_within("v", actual.velocity, expected.velocity, allowed);
}

#[test]
fn an_event_at_the_end_is_reported() {
    let mut random = Random::new(41);
    let mut seen = 0;
    for _ in 0..100 {
        let system = random.system();
        let start = State::new(random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0));
        let all = system.simulate(start, 30.0).unwrap();
        for (n, event) in all.events().iter().enumerate().take(6) {
            let until = |duration: f64| system.simulate(start, duration).unwrap();
            let exactly = until(event.time);
            assert_eq!(exactly.duration(), event.time);
            // Events of the same time, if a stick phase has no length, are all there.
            assert!(exactly.events().len() > n, "{event:?} missing");
            assert_eq!(exactly.events(), &all.events()[..exactly.events().len()]);
            let last = exactly.events().last().unwrap().state;
            assert_near(&system, event.time, exactly.last(), last);
            assert_eq!(exactly.state_at(event.time), Some(exactly.last()));
            assert_eq!(
                exactly.mode_at(event.time),
                Some(exactly.events().last().unwrap().kind.mode())
            );
            if event.time > 0.0 {
                assert!(until(event.time.next_down()).events().len() <= n);
            }
            seen += 1;
        }
    }
    assert!(seen > 200, "{seen}");
}

/// What comes after the end of the run is no error of it, even where the run ends with a step.
#[test]
fn a_motion_up_to_where_an_error_was_reached_is_none() {
    friction_law! { Logarithm: 0.4, |s| (-s + 1.0).ln() * 0.1 + 0.4 }
    let system = MassOnBelt::new(Logarithm, 0.2).unwrap();
    let start = State::new(1.2, 0.0);
    let Error::NonFiniteFriction {
        reached: Some(reached),
        ..
    } = system.simulate(start, 10.0).unwrap_err()
    else {
        panic!()
    };
    let motion = system.simulate(start, reached.time).unwrap();
    assert_eq!(reached.state, motion.last().into());
    assert!(system.simulate(start, reached.time.next_up()).is_err());
    // One stick phase of 0.8, and a limit of one step.
    let sticking = paper(0.5);
    let start = State::new(-0.05, 0.5);
    let one = Integrator::new().with_max_steps(1).unwrap();
    let whole = one.simulate(&sticking, start, 0.8).unwrap();
    assert_eq!(whole.events().len(), 1);
    assert!(one.simulate(&sticking, start, 0.9).is_err());
}

/// Times of samples: equidistant, from the start to the end and not beyond.
#[test]
fn samples_end_with_the_motion() {
    let system = paper(0.2);
    for i in 1..=40 {
        let duration = 0.1 * f64::from(i);
        let motion = system.simulate(State::new(0.0, 0.0), duration).unwrap();
        for n in 2..40 {
            let samples: Vec<_> = motion.sample(n).collect();
            assert_eq!(
                samples[n - 1],
                (duration, motion.state_at(duration).unwrap())
            );
            for (i, (time, state)) in samples.iter().enumerate() {
                let expected = duration * i as f64 / (n - 1) as f64;
                assert_abs_diff_eq!(*time, expected, epsilon = ulp(duration));
                assert_eq!(motion.state_at(*time), Some(*state));
            }
        }
    }
}

#[test]
fn zero_duration_is_an_empty_motion_with_its_start() {
    let system = paper(0.2);
    let release = system.release_state().unwrap();
    for start in [
        State::new(0.0, 0.0),
        State::new(0.1, 0.2),
        State::new(5.0, 0.2),
        release,
    ] {
        let motion = system.simulate(start, 0.0).unwrap();
        assert_eq!(motion.duration(), 0.0);
        assert_eq!((motion.last(), motion.state_at(0.0)), (start, Some(start)));
        assert!(motion.mode_at(0.0).is_some());
        assert_eq!(motion.sample(3).collect::<Vec<_>>(), vec![(0.0, start); 3]);
        assert_eq!(motion.sample(0).count(), 0);
        assert_eq!(motion.state_at(f64::MIN_POSITIVE), None);
        assert_eq!(motion.state_at(-0.0), Some(start));
        let released = usize::from(start == release);
        assert_eq!(motion.events().len(), released);
    }
    assert_eq!(
        system
            .simulate(State::new(0.0, 0.0), -0.0)
            .unwrap()
            .events(),
        []
    );
}

#[test]
fn dense_output_is_defined_exactly_on_the_duration() {
    let system = paper(0.2);
    let motion = system.simulate(State::new(0.0, 0.0), 20.0).unwrap();
    for time in [
        -1e-300,
        20.0_f64.next_up(),
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
    ] {
        assert_eq!(
            (motion.state_at(time), motion.mode_at(time)),
            (None, None),
            "{time}"
        );
    }
    assert_eq!(motion.state_at(20.0), Some(motion.last()));
    // At an event: its state, and the mode from then on.
    for event in motion.events() {
        let state = motion.state_at(event.time).unwrap();
        assert_near(&system, event.time, state, event.state);
        assert_eq!(motion.mode_at(event.time), Some(event.kind.mode()));
    }
    // du/dτ = v, by central differences.
    for i in 1..400 {
        let (time, h) = (0.05 * f64::from(i), 1e-5);
        if time + h > 20.0 {
            continue;
        }
        let u = |t: f64| motion.state_at(t).unwrap().displacement;
        let slope = (u(time + h) - u(time - h)) / (2.0 * h);
        assert_within(
            "du/dτ",
            motion.state_at(time).unwrap().velocity,
            slope,
            1e-9,
        );
    }
}

/// Rest is one last step without an end, in stick on a belt at rest and exactly on an equilibrium.
#[test]
fn rest_is_one_last_step_of_infinite_duration() {
    let still = MassOnBelt::new(Coulomb::new(0.5, 0.25).unwrap(), 0.0).unwrap();
    let rest = steps(&still, State::new(0.3, 0.0), 10);
    assert_eq!(rest.len(), 1);
    assert_eq!(
        (rest[0].mode(), rest[0].duration()),
        (Mode::Stick, f64::INFINITY)
    );
    assert_eq!(rest[0].state_at(1e9), State::new(0.3, 0.0));
    let moving = MassOnBelt::new(Coulomb::new(0.5, 0.25).unwrap(), 1.0).unwrap();
    let rest = steps(&moving, State::new(0.25, 0.0), 10);
    assert_eq!(rest.len(), 1);
    assert_eq!(
        (rest[0].mode(), rest[0].duration()),
        (Mode::Slip(Direction::Lagging), f64::INFINITY)
    );
    assert_eq!(rest[0].state_at(1e9), State::new(0.25, 0.0));
    // Simulated, it lasts as long as asked.
    let motion = moving.simulate(State::new(0.25, 0.0), 1e300).unwrap();
    assert_eq!(
        (motion.duration(), motion.last()),
        (1e300, State::new(0.25, 0.0))
    );
    // A slip without friction turns for ever.
    let free = MassOnBelt::new(Coulomb::new(0.0, 0.0).unwrap(), 3.0).unwrap();
    let motion = free.simulate(State::new(1.0, 0.0), 100.0).unwrap();
    assert_eq!(motion.events(), []);
    assert_within("cos", motion.last().displacement, 100.0_f64.cos(), 1e-14);
    let quarter = free.simulate(State::new(1.0, 0.0), FRAC_PI_2).unwrap();
    assert_within("sin", quarter.last().velocity, -1.0, 2.0 * EPS);
}

/// The force on the mass and its acceleration: in slip, in stick, and on the belt beyond what the
/// contact can carry.
#[test]
fn forces_in_slip_in_stick_and_just_after_release() {
    for v_b in [0.5, -0.5] {
        let system = on_belt(Coulomb::new(0.5, 0.25).unwrap(), v_b, 0.125, 4.0);
        // γ²μ_s = 2, γ²μ_k = 1, 2βv_b = ±0.125.
        let on_belt = |displacement| State::new(displacement, v_b);
        let drag = 0.25 * v_b;
        let forces = |state| (system.friction_force(state), system.acceleration(state));
        assert_eq!(
            forces(State::new(0.3, v_b - 1.0)),
            (1.0, 1.0 - 0.3 - 0.25 * (v_b - 1.0))
        );
        assert_eq!(
            forces(State::new(0.3, v_b + 1.0)),
            (-1.0, -1.0 - 0.3 - 0.25 * (v_b + 1.0))
        );
        for inside in [-1.75, 0.0, 0.5, 1.75] {
            assert_eq!(forces(on_belt(inside)), (inside + drag, 0.0));
        }
        assert_eq!(forces(on_belt(3.0)), (1.0, 1.0 - 3.0 - drag));
        assert_eq!(forces(on_belt(-3.0)), (-1.0, -1.0 + 3.0 - drag));
        // At the ends of the stick band: released where the belt drags the mass out of it, held
        // where it drags it in.
        let [low, high] = system.stick_limits();
        let (held, released) = if v_b > 0.0 { (low, high) } else { (high, low) };
        assert_eq!(forces(on_belt(held)), (held + drag, 0.0));
        let kinetic = v_b.signum();
        assert_eq!(
            forces(on_belt(released)),
            (kinetic, kinetic - released - drag)
        );
    }
    // A belt at rest holds it at both ends.
    let resting = MassOnBelt::new(Coulomb::new(0.5, 0.25).unwrap(), 0.0).unwrap();
    for end in [-0.5, 0.5] {
        assert_eq!(resting.friction_force(State::new(end, 0.0)), end);
    }
}

/// Large forces that balance each other leave rounding errors, which are no reason for short steps.
#[test]
fn rounding_of_large_terms_is_no_defect() {
    let law = Exponential::new(0.4, 0.25, 0.1).unwrap();
    let system = on_belt(law, 3.0, 0.0, 1e5);
    // Friction is flat so far from the belt: a free oscillation of amplitude 0.5 about ū ≈ 25 000.
    let start = State::new(system.equilibrium().unwrap().displacement + 0.5, 0.0);
    let steps = Integrator::new()
        .flow(&system, start)
        .unwrap()
        .map(Result::unwrap)
        .take_while(|step| step.start_time() < 10.0 * std::f64::consts::TAU)
        .count();
    assert!(steps < 120, "{steps}");
}

/// On either side of the release point, as close as it can be written.
#[test]
fn starts_beside_the_release_point_are_released_at_once() {
    for (load, v_b) in [
        (1.0, 0.2_f64),
        (1.0, -0.2),
        (7.3, 0.9),
        (0.011, 0.003),
        (250.0, -4.0),
    ] {
        let law = Polynomial::new(0.4, 0.25, 0.5 * v_b.abs() / 0.2).unwrap();
        let system = on_belt(law, v_b, 0.01, load);
        let release = system.release_state().unwrap();
        let events = |start| system.simulate(start, 30.0).unwrap().events().to_vec();
        let expected = events(release);
        let u = release.displacement;
        for displacement in [u.next_up(), u.next_down()] {
            let found = events(State::new(displacement, v_b));
            assert_eq!(found.len(), expected.len(), "{load} {v_b}");
            for (a, b) in found.iter().zip(&expected) {
                assert_eq!(a.kind, b.kind);
                assert!((a.time - b.time).abs() < 1e-12, "{load} {v_b}: {a} {b}");
            }
            assert_eq!(found[0].time, 0.0);
        }
    }
}
