//! Random structures: nothing panics, hangs or is missed.

use approx::assert_abs_diff_eq;
use stick_slip::structure::State;
use stick_slip::{
    AnyContactLaw, Contact, Coulomb, Direction, Drive, Dwell, Element, Error, Event, EventKind,
    FrictionLaw, Integrator, LuGre, Mode, Polynomial, Rational, Segment, Stribeck, Structure,
    Trajectory,
};

use crate::common::simple::runge_kutta;
use crate::common::{Random, count, one_mass};
use crate::plain::{Plain, STOPS, Seen};
use crate::reading::Raised;

fn told_of(event: &Event<State>) -> Seen {
    let (letter, side) = match event.kind {
        EventKind::Stick => ('s', 0.0),
        EventKind::Release(direction) => ('r', direction.sign()),
        EventKind::Crossing(direction) => ('x', direction.sign()),
        EventKind::Open => ('o', 0.0),
        EventKind::Close => ('c', 0.0),
    };
    let number = match event.element {
        Element::Stop(stop) => STOPS + stop,
        _ => event.contact().unwrap(),
    };
    (event.time, number, letter, side)
}

pub(crate) fn told(motion: &Trajectory<State>) -> Vec<Seen> {
    motion.events().iter().map(told_of).collect()
}

/// The motion, as far as it goes; the contact that separates, and when.
pub(crate) fn simulate(
    plain: &Plain,
    start: &State,
    duration: f64,
) -> Result<(Trajectory<State>, Option<Seen>), Error> {
    let structure = plain.structure();
    let start = plain.state(start);
    match structure.simulate(start.clone(), duration) {
        Ok(motion) => Ok((motion, None)),
        Err(Error::Separation { contact, reached }) => {
            let motion = structure.simulate(start.clone(), reached.time * (1.0 - 1e-12))?;
            Ok((motion, Some((reached.time, contact, 'o', 0.0))))
        }
        Err(error) => Err(error),
    }
}

#[test]
fn motions_obey_the_law() {
    let mut random = Random::new(2026);
    let (mut events, mut separations, mut opened) = (0, 0, 0);
    let cases = count(150, 2000);
    for i in 0..cases {
        let plain = Plain::random(&mut random);
        let start = plain.start(&mut random);
        let about = || format!("{i}: {plain:?}\n{start:?}");
        let structure = plain.structure();
        let duration = 30.0;
        let (motion, separation) = simulate(&plain, &start, duration)
            .unwrap_or_else(|error| panic!("{error}\n{}", about()));
        separations += usize::from(separation.is_some());
        events += motion.events().len();
        let kinds = motion.events().iter().map(|event| event.kind);
        opened += kinds.filter(|kind| *kind == EventKind::Open).count();
        for pair in motion.events().windows(2) {
            assert!(pair[0].time <= pair[1].time, "{}", about());
        }
        for pair in motion.steps().windows(2) {
            assert_eq!(pair[0].end_time(), pair[1].start_time(), "{}", about());
            assert_eq!(
                pair[0].end_state().displacements,
                pair[1].state().displacements,
                "{}",
                about()
            );
        }
        for step in motion.steps() {
            for part in [0.1, 0.35, 0.6, 0.85] {
                let t = part * step.duration();
                let (time, state) = (step.start_time() + t, step.state_at(t));
                for (contact, mode) in structure.contacts().iter().zip(step.modes()) {
                    let i = contact.coordinate();
                    let r = state.velocities[i] - contact.belt_velocity().value(time);
                    let load = contact.load_at(time, &state.displacements);
                    match mode {
                        Mode::Stick => {
                            assert!(r.abs() < 1e-14, "stick: {r:e} at {time} {}", about());
                        }
                        Mode::Slip(Direction::Leading) => {
                            assert!(r > -1e-13, "{r:e} at {time} {}", about());
                        }
                        Mode::Slip(Direction::Lagging) => {
                            assert!(r < 1e-13, "{r:e} at {time} {}", about());
                        }
                        Mode::Open => {}
                    }
                    if *mode == Mode::Open {
                        assert!(load <= 1e-13, "open: {load:e} at {time} {}", about());
                    } else {
                        assert!(load > -1e-13, "closed: {load:e} at {time} {}", about());
                    }
                }
            }
        }
    }
    println!("{events} events, {separations} separations, {opened} openings");
    assert!(events > 10 * cases / 2 && separations > 0 && opened > 0);
}

/// The events up to a time, or up to where the motion cannot go on.
fn seen(structure: &Structure, start: &State, tolerance: f64, duration: f64) -> Vec<Seen> {
    let mut seen = Vec::new();
    let flow = Integrator::new()
        .with_tolerance(tolerance)
        .and_then(|integrator| integrator.flow(structure, start.clone()));
    for (n, step) in flow.into_iter().flatten().enumerate() {
        let step = match step {
            Ok(step) => step,
            Err(Error::Separation { .. }) => break,
            Err(error) => panic!("{error}\n{structure:?}\n{start:?}"),
        };
        assert!(n < 10000, "{structure:?}\n{start:?}");
        if step.end_time() > duration {
            break;
        }
        seen.extend(step.events().iter().map(told_of));
    }
    seen
}

/// A loose tolerance neither invents nor loses an event where the motion itself is sure of them:
/// where motions that start further apart than its errors have the same.
#[test]
fn a_loose_tolerance_sees_the_same_events() {
    let duration = 15.0;
    for tolerance in [1e-6, 1e-9, 1e-12] {
        let mut random = Random::new(77);
        let (mut compared, mut unsure) = (0, 0);
        let cases = count(60, 300);
        for i in 0..cases {
            let plain = match i % 3 {
                0 => Plain::shared(&mut random, false),
                _ => Plain::random(&mut random),
            };
            let start = plain.start_at_rest(&mut random);
            let structure = plain.structure();
            if structure.contacts().len() > structure.len() {
                continue; // Several may come to rest at once, by what holds them.
            }
            let usual = seen(&structure, &start, f64::EPSILON, duration);
            let same = |a: &Seen, b: &Seen| (a.1, a.2, a.3) == (b.1, b.2, b.3);
            // How many events the neighbours agree on, and how far theirs are apart.
            let mut sure = usual.len();
            let mut apart = vec![0.0_f64; usual.len()];
            for change in [-1e3, 1e3] {
                for j in 0..structure.len() {
                    let mut near = start.clone();
                    near.displacements[j] += change * tolerance;
                    let near = seen(&structure, &near, f64::EPSILON, duration);
                    let pairs = std::iter::zip(&near, &usual);
                    sure = sure.min(pairs.clone().take_while(|(a, b)| same(a, b)).count());
                    for (apart, (a, b)) in std::iter::zip(&mut apart, pairs) {
                        *apart = apart.max((a.0 - b.0).abs());
                    }
                }
            }
            let loose = seen(&structure, &start, tolerance, duration);
            for n in 0..sure {
                let about = || format!("{tolerance:e}, {i}, event {n}:\n{plain:?}\n{start:?}");
                let late = duration - usual[n].0 < 1e3 * tolerance + apart[n];
                let Some(event) = loose.get(n) else {
                    assert!(late, "{}", about());
                    break;
                };
                assert!(same(event, &usual[n]), "{}", about());
                let off = (event.0 - usual[n].0).abs();
                assert!(off <= 1e3 * tolerance + apart[n], "{off:e} {}", about());
            }
            compared += sure;
            unsure += usual.len() - sure;
        }
        println!("{tolerance:e}: {compared} events, {unsure} unsure");
        assert!(compared > 5 * cases && unsure < compared / 10);
    }
}

/// Events compared with those that the simple integrator sees.
#[derive(Default)]
pub(crate) struct Comparison {
    pub(crate) compared: usize,
    pub(crate) undecided: usize,
    worst: f64,
}

impl Comparison {
    /// The events of one motion, as far as the simple integrator is sure of itself: with twice the
    /// step it sees the same, but for a `u`, where it cannot go on.
    pub(crate) fn add(
        &mut self,
        found: &[Seen],
        [coarse, fine]: [&[Seen]; 2],
        duration: f64,
        motion: &str,
    ) {
        for n in 0..coarse.len().max(fine.len()).max(found.len()) {
            let about = || format!("event {n}:\n{found:?}\n{fine:?}\n{motion}");
            let (Some(a), Some(b)) = (coarse.get(n), fine.get(n)) else {
                if coarse.len() == fine.len() {
                    // One more: only at the very end.
                    assert!(found[n].0 > duration - 1e-3, "{}", about());
                } else {
                    self.undecided += 1;
                }
                break;
            };
            let same = |a: &Seen, b: &Seen| (a.1, a.2, a.3) == (b.1, b.2, b.3);
            if !same(a, b) || (a.0 - b.0).abs() > 1e-3 || b.2 == 'u' {
                self.undecided += 1;
                break;
            }
            let Some(event) = found.get(n) else {
                assert!(b.0 > duration - 1e-3, "{}", about());
                break;
            };
            assert!(same(event, b), "{}", about());
            // Its error is less than what halving the step has changed, or where a kink of a law
            // is stepped over, of order h².
            let allowed = 4.0 * (a.0 - b.0).abs() + 1e-4;
            assert!((event.0 - b.0).abs() < allowed, "{}", about());
            self.worst = self.worst.max((event.0 - b.0).abs());
            self.compared += 1;
        }
    }
}

impl std::fmt::Display for Comparison {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self {
            compared,
            undecided,
            worst,
        } = self;
        write!(
            f,
            "{compared} events, {undecided} undecided motions, worst difference {worst:.1e}"
        )
    }
}

/// The same events as the simple integrator sees, where that is sure of itself.
#[test]
fn a_simple_integrator_sees_the_same_events() {
    let mut random = Random::new(500);
    let mut all = Comparison::default();
    let cases = count(15, 100);
    for i in 0..cases {
        let plain = Plain::random(&mut random);
        let start = plain.start(&mut random);
        let duration = 15.0;
        const STEP: f64 = 4e-3;
        let [coarse, fine] = [2.0 * STEP, STEP].map(|h| plain.events(&start, duration, h));
        let motion = format!("{i}:\n{plain:?}\n{start:?}");
        // Every contact has a coordinate to itself, and decides.
        assert!(fine.iter().all(|seen| seen.2 != 'u'), "{fine:?}\n{motion}");
        let (trajectory, separation) = simulate(&plain, &start, duration).unwrap();
        let mut found = told(&trajectory);
        found.extend(separation);
        all.add(&found, [&coarse, &fine], duration, &motion);
    }
    println!("{all}");
    assert!(all.compared > 5 * cases, "{all}");
    assert!(all.undecided * 10 < cases, "{all}");
}

/// The same with force elements of all kinds.
#[test]
fn a_simple_integrator_sees_the_same_events_with_force_elements() {
    compare_with(502, Plain::with_elements);
}

/// The same with stops, some of them adhesive or without damper; and with stops, force elements and
/// first-order states.
#[test]
fn a_simple_integrator_sees_the_same_events_with_stops() {
    let all = |plain: Plain, random: &mut Random| {
        let plain = plain.with_elements(random).with_stops(random);
        plain.with_states(random)
    };
    for found in [compare_with(503, Plain::with_stops), compare_with(504, all)] {
        let of_stops = found.iter().filter(|seen| seen.1 >= STOPS).count();
        assert!(of_stops > 3 * compared_with(), "{of_stops}");
    }
}

/// The same with first-order states, and with elements beside them.
#[test]
fn a_simple_integrator_sees_the_same_events_with_first_order_states() {
    compare_with(515, |plain, random| match random.bits().is_multiple_of(3) {
        true => plain.with_elements(random).with_states(random),
        false => plain.with_states(random),
    });
}

/// The same with loads of all kinds.
#[test]
fn a_simple_integrator_sees_the_same_events_with_load_laws() {
    let found = compare_with(503, Plain::with_load_laws);
    for letter in ['o', 'c'] {
        let seen = found.iter().filter(|seen| seen.2 == letter).count();
        assert!(seen > compared_with() / 4, "{seen} of {letter}");
    }
}

/// Number of structures that [`compare_with`] compares.
fn compared_with() -> usize {
    count(15, 300)
}

/// Compares the events of random structures with some additions; returns those of the crate.
fn compare_with(seed: u64, add: impl Fn(Plain, &mut Random) -> Plain) -> Vec<Seen> {
    let mut random = Random::new(seed);
    let mut all = Comparison::default();
    let mut events = Vec::new();
    let (mut tried, cases) = (0, compared_with());
    while tried < cases {
        let is_shared = random.bits().is_multiple_of(2);
        let plain = match is_shared {
            false => Plain::random(&mut random),
            true => Plain::shared(&mut random, false),
        };
        let plain = add(plain, &mut random);
        let start = plain.start(&mut random);
        if is_shared && !plain.is_clear(&start) {
            continue;
        }
        tried += 1;
        let duration = 10.0;
        const STEP: f64 = 4e-3;
        let [coarse, fine] = [2.0 * STEP, STEP].map(|h| plain.events(&start, duration, h));
        let motion = format!("{tried}:\n{plain:?}\n{start:?}");
        let (trajectory, end) =
            simulate(&plain, &start, duration).unwrap_or_else(|error| panic!("{error}\n{motion}"));
        // The simple integrator knows no contacts at rest with dependent directions.
        if fine.iter().chain(&coarse).any(|seen| seen.2 == 'u') {
            continue;
        }
        let mut found = told(&trajectory);
        found.extend(end);
        all.add(&found, [&coarse, &fine], duration, &motion);
        events.append(&mut found);
    }
    println!("{all}");
    assert!(all.compared > 3 * cases, "{all}");
    assert!(all.undecided * 5 < cases, "{all}");
    events
}

/// A limit of steps ends what does not end by itself.
#[test]
fn limits_of_work_hold() {
    let mut random = Random::new(3);
    for _ in 0..50 {
        let plain = Plain::random(&mut random);
        let start = plain.start(&mut random);
        let integrator = Integrator::new().with_max_steps(5).unwrap();
        match integrator.simulate(&plain.structure(), start, 1e6) {
            Ok(_) | Err(Error::TooManySteps { limit: 5, .. } | Error::Separation { .. }) => {}
            other => panic!("{other:?}"),
        }
    }
}

/// A load that opens for a while and comes back over a mass that rests: both bounds of the stick
/// band begin where the mass is, within rounding of the load.
#[test]
fn a_load_comes_back_over_a_mass_at_rest() {
    let law = Coulomb::new(0.5, 0.3).unwrap();
    let mut closings = 0;
    for n in 0..40 {
        let load = Drive::harmonic(0.3, 2.642581354465535, -0.04 + 0.1 * f64::from(n))
            .and_then(|load| load.with_harmonic(-0.14, 0.303785835640825, 2.56))
            .and_then(|load| load.with_sine(0.33, 0.392939285640369))
            .and_then(|load| load.with_constant(0.08))
            .unwrap();
        let force = 0.01 * f64::from(n % 4);
        let contact = Contact::new(0, law, load).unwrap();
        let structure = one_mass([0.4, 0.3, 0.5], force, contact).unwrap();
        let motion = structure
            .simulate(State::new(&[0.9], &[0.0]), 500.0)
            .unwrap();
        let kinds = motion.events().iter().map(|event| event.kind);
        closings += kinds.filter(|kind| *kind == EventKind::Close).count();
        let rest = motion.last().displacements[0] - 0.02 * f64::from(n % 4);
        assert!(rest.abs() < 1e-3, "{n}: {rest:e}");
        assert!(
            motion.steps().len() < 20_000,
            "{n}: {}",
            motion.steps().len()
        );
    }
    assert!(closings > 2000, "{closings}");
}

/// Openings and closings of a contact of a mass on a spring.
fn changes_of_load(load: Drive, unit: f64, mass: f64, duration: f64) -> Vec<(f64, EventKind)> {
    let law = Coulomb::new(0.4, 0.3).unwrap();
    let contact = Contact::new(0, law, load).unwrap().on_belt(0.3);
    let structure = one_mass([mass, 0.0, unit], 0.0, contact).unwrap();
    let start = State::new(&[0.1], &[0.0]);
    let motion = structure.simulate(start, duration).unwrap();
    let events = motion.events().iter();
    let of_load = events.filter(|e| matches!(e.kind, EventKind::Open | EventKind::Close));
    of_load.map(|event| (event.time, event.kind)).collect()
}

/// From above or from below, at the minimum of a sine or of its fourth power, where pieces of a
/// profile meet, or at the start: in whatever units, a touch is no event. What goes beyond 0 by
/// more than rounding is two.
#[test]
fn a_load_that_touches_zero_does_not_open_or_close() {
    for i in 0..100 {
        let unit = 1e-3 * 1.7_f64.powi(i % 20);
        let omega = 0.3 * 1.13_f64.powi(i % 17);
        let phase = 0.2 + 0.37 * f64::from(i);
        let changes = |load: Result<Drive, Error>| {
            let mass = 0.1 * 1.3_f64.powi(i % 13);
            changes_of_load(load.unwrap(), unit, mass, 60.0 / omega)
        };
        for side in [unit, -unit] {
            let sine = Drive::harmonic(unit, omega, phase).and_then(|d| d.with_constant(side));
            // cos⁴
            let flat = Drive::harmonic(0.5 * side, omega, phase)
                .and_then(|d| d.with_harmonic(0.125 * side, 2.0 * omega, 2.0 * phase))
                .and_then(|d| d.with_constant(0.375 * side));
            let (first, second) = (7.0 / omega, 13.1 / omega);
            let kinked = Drive::profile(&[
                (0.0, side),
                (first, 0.0),
                (11.0 / omega, side),
                (second, 0.0),
                (17.0 / omega, 2.0 * side),
            ]);
            let at_start = Drive::harmonic(-side, omega, 0.0).and_then(|d| d.with_constant(side));
            for load in [sine, flat, kinked, at_start] {
                let found = changes(load);
                assert_eq!(found, [], "{i} {side}");
            }
            // A dip of 1e-12 lasts for √8e-12 of a radian.
            let dip = Drive::harmonic(unit, omega, phase)
                .and_then(|d| d.with_constant(side * (1.0 - 1e-12)));
            let found = changes(dip);
            assert!(found.len() >= 18 && found.len() % 2 == 0, "{}", found.len());
            for pair in found.chunks(2) {
                let gap = omega * (pair[1].0 - pair[0].0);
                assert!((gap - 8e-12_f64.sqrt()).abs() < 1e-8, "{gap:e}");
            }
        }
        // To 0 and back by a jump, down by one and back: the value behind it decides.
        let jumps = Drive::profile(&[
            (0.0, unit),
            (2.0, 0.0),
            (2.0, unit),
            (4.0, 0.0),
            (4.0, -unit),
        ]);
        let found = changes(jumps);
        assert!(matches!(found[..], [(4.0, EventKind::Open)]), "{found:?}");
    }
}

/// A mass with neither spring nor damper carries nothing: its band and its load vanish together.
#[test]
fn a_load_opens_over_a_mass_that_carries_nothing() {
    let load = Drive::harmonic(1.0, 1.0, 0.0).unwrap();
    let load = load.with_constant(0.5).unwrap();
    let opens = 2.0 * std::f64::consts::FRAC_PI_3;
    let turn = std::f64::consts::TAU;
    let times = [opens, turn - opens, turn + opens, 2.0 * turn - opens];
    for belt in [0.1, 0.0, -3.0] {
        let dry = Raised::from(Coulomb::new(0.9, 0.9).unwrap());
        let dwell = Dwell::exponential(dry.clone(), 1.0, 2.0).unwrap();
        let contacts = [AnyContactLaw::Dry(dry), dwell.into()];
        for law in contacts {
            let contact = Contact::new(0, law, load.clone()).unwrap();
            let block = one_mass([1.0, 0.0, 0.0], 0.0, contact.on_belt(belt)).unwrap();
            let motion = block.simulate(State::new(&[0.0], &[belt]), 14.0).unwrap();
            let kinds: Vec<EventKind> = motion.events().iter().map(|e| e.kind).collect();
            use EventKind::{Close, Open};
            assert_eq!(kinds, [Open, Close, Open, Close], "{belt}");
            for (event, time) in std::iter::zip(motion.events(), times) {
                assert_abs_diff_eq!(event.time, time, epsilon = 4.0 * f64::EPSILON * time);
                assert_eq!(event.state.velocities, [belt]);
            }
        }
    }
}

/// The velocity of one mass in slip on a belt, by fixed Runge-Kutta steps. `force` is on the mass.
fn in_slip(start: [f64; 2], duration: f64, mass: f64, force: impl Fn(f64, [f64; 2]) -> f64) -> f64 {
    let n = 20_000;
    let h = duration / f64::from(n);
    let mut x = start;
    for i in 0..n {
        let rates = |t: f64, x: [f64; 2]| [x[1], force(t, x) / mass];
        x = runge_kutta(f64::from(i) * h, x, h, rates);
    }
    x[1]
}

/// Nothing is elastic and nothing damps, and the load begins at 0: what a step may miss is measured
/// by the friction that comes.
#[test]
fn a_load_that_begins_at_zero_says_what_it_will_be() {
    let law = Polynomial::new(0.49, 0.22, 0.98).unwrap();
    for i in 0..40 {
        let (omega, mass) = (1.5 + 0.02 * f64::from(i), 0.4 + 0.05 * f64::from(i % 7));
        // Open at first; where it closes the load is 0 but for rounding.
        let phase = 0.3 + 0.03 * f64::from(i);
        let least = 0.2 * phase.cos();
        let drive = Drive::harmonic(0.2, omega, -phase - 0.5)
            .and_then(|load| load.with_constant(-least))
            .unwrap();
        let block = one_mass([mass, 0.0, 0.0], 0.0, Contact::new(0, law, drive).unwrap()).unwrap();
        let (closes, closed) = (0.5 / omega, 1.9 * phase / omega);
        let start = State::new(&[0.0], &[0.7]);
        let motion = block.simulate(start, closes + closed).unwrap();
        let load = |t: f64| 0.2 * (omega * t - phase).cos() - least;
        let force = |t: f64, [_, v]: [f64; 2]| -load(t) * law.kinetic(v);
        let expected = in_slip([0.0, 0.7], closed, mass, force);
        let error = motion.last().velocities[0] - expected;
        assert!(error.abs() < 1e-13, "{i}: {error:e}");
    }
}

/// Friction rises at the end of a step, below speeds that its quarters do not show, where the load
/// falls to 0: the end alone shows it, where it does no work.
#[test]
fn a_load_that_ends_at_zero_hides_no_friction_before() {
    let law = Stribeck::new(0.62, 0.54, 0.05, 3).unwrap();
    let opens = 0.4734;
    let points = [(0.0, 0.13 * opens), (opens, 0.0), (2.0, -0.1)];
    for i in 0..40 {
        let start = [-0.226, -0.84 + 0.005 * f64::from(i)];
        let drive = Drive::profile(&points).unwrap();
        let contact = Contact::new(0, law, drive).unwrap();
        let block = one_mass([0.319, 0.0, 1.24], 0.0, contact).unwrap();
        let motion = block
            .simulate(State::new(&start[..1], &start[1..]), opens)
            .unwrap();
        let force =
            |t: f64, [q, v]: [f64; 2]| -1.24 * q + 0.13 * (opens - t) * law.kinetic(v.abs());
        let expected = in_slip(start, opens, 0.319, force);
        let error = motion.last().velocities[0] - expected;
        println!("{i}: {error:e} {:?}", motion.last().velocities);
        assert!(error.abs() < 1e-11, "{i}: {error:e}");
    }
}

/// A mass that swings on its bristles alone, about a constant force, and comes to rest: its time
/// is that of the bristles, whatever its velocity is just now.
#[test]
fn a_mass_on_nothing_but_bristles_comes_to_rest() {
    for i in (0..40).step_by(40 / count(8, 40).min(40)) {
        let force = -0.078 + 0.004 * f64::from(i);
        let law = Rational::new(0.7, 1.44).unwrap();
        let bristles = LuGre::new(law, 50.0, 0.3, 0.0).unwrap();
        let contact = Contact::new(0, bristles, 1.5).unwrap();
        let block = one_mass([0.58, 0.0, 0.0], force, contact).unwrap();
        let motion = block.simulate(State::new(&[0.0], &[0.0]), 400.0).unwrap();
        assert!(motion.last().velocities[0].abs() < 1e-6 * force.abs());
        let carried = 1.5 * 50.0 * motion.last().memory[0];
        assert_abs_diff_eq!(carried, force, epsilon = 1e-5 * force.abs() + 1e-15);
    }
}

/// The band of a contact that has just closed is 0, and what it carries, too.
#[test]
fn a_contact_closes_over_a_mass_that_carries_nothing() {
    let law = Polynomial::new(0.45, 0.25, 0.42).unwrap();
    for i in 0..40 {
        let dwell = Dwell::logarithmic(law, 0.18, 9.6 - 0.1 * f64::from(i)).unwrap();
        let load = Drive::harmonic(0.264, 0.2757 + 0.003 * f64::from(i), 0.0)
            .and_then(|load| {
                load.with_harmonic(0.138, 3.927, 1.447)?
                    .with_constant(0.0975)
            })
            .unwrap();
        let block = one_mass([2.9, 0.0, 0.0], 0.0, Contact::new(0, dwell, load).unwrap()).unwrap();
        let motion = block.simulate(State::new(&[0.29], &[0.0]), 60.0).unwrap();
        let kinds = motion.events().iter().map(|event| event.kind);
        assert!(kinds.filter(|kind| *kind == EventKind::Close).count() > 2);
        assert_eq!(motion.last().displacements, [0.29]);
    }
}

/// A block that nothing else holds, carried by a belt whose velocity passes through 0.
#[test]
fn a_block_carried_through_rest_goes_on() {
    let law = Stribeck::new(0.76, 0.73, 0.44, 2).unwrap();
    let points = [
        (0.5497448121129739, -0.13112231010044195),
        (5.576877347621124, 0.20067051459492435),
        (7.39145999192632, -0.3644233547835716),
        (9.877518764820078, 0.008358557795293708),
        (14.77873049736227, -0.0807517827790033),
    ];
    let belt = Drive::constant(-0.0656318433331462);
    let belt = belt.with_profile(&points).unwrap();
    let start = State::new(&[0.5524540620537817], &[belt.value(0.0)]);
    let contact = Contact::new(0, law, 0.44572098356106116).unwrap();
    let contact = contact.on_belt(belt.clone());
    let block = one_mass([0.5952527497282494, 0.0, 0.0], 0.0, contact).unwrap();
    let motion = block.simulate(start, 20.0).unwrap();
    assert!((motion.last().velocities[0] - belt.value(20.0)).abs() < 1e-13);
}
