//! Lyapunov exponents and Poincaré sections.

use approx::assert_abs_diff_eq;
use stick_slip::nalgebra::Complex;
use stick_slip::orbit::{
    Oscillator, Passage, Period, lyapunov, lyapunov_with_spread, section, section_at,
    section_through, settle, shoot,
};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Direction, Drive, Error, EventKind, Exponential, FirstOrder, Integrator,
    MassOnBelt, RateState, Rational, Structure, System, Trajectory, limit_cycle,
};

use crate::common::{Random, on_belt, one_mass, paper, text};
use crate::reading::{remembering, structure};
use crate::references::{all, period, remembers, start};

/// K. Popp, P. Stelter, *Phil. Trans. R. Soc. Lond. A* 332 (1990) 89-105: a mass on a belt under a
/// harmonic force, with friction that falls and rises again.
fn popp_and_stelter(force: f64, frequency: f64) -> Structure {
    let law = Rational::new(0.3, 1.42)
        .and_then(|law| law.with_offset(0.1))
        .and_then(|law| law.with_quadratic(0.01))
        .unwrap();
    let contact = Contact::new(0, law, 1.0).unwrap().on_belt(0.2);
    let force = Drive::harmonic(force, frequency, 0.0).unwrap();
    one_mass([1.0, 0.0, 1.0], force, contact).unwrap()
}

/// ln |multiplier|/T of the largest multiplier, against the exponent.
fn compare<S: Oscillator + System<State = State>>(
    id: &str,
    system: &S,
    guess: &State,
    kind: Period,
) {
    let orbit = shoot(system, guess, kind).unwrap();
    if !orbit.is_stable() {
        return;
    }
    let expected = orbit.multipliers()[0].norm().ln() / orbit.period();
    let duration = 60.0 * orbit.period();
    let found = lyapunov_with_spread(system, &orbit.state(), orbit.period(), duration).unwrap();
    println!("{id}: {found:?}, {expected}");
    if expected == f64::NEG_INFINITY {
        assert_eq!((found.value, found.spread), (expected, 0.0), "{id}");
        return;
    }
    let apart = (found.value - expected).abs();
    assert!(
        apart <= 4.0 * found.spread + 1e-12,
        "{id}: {found:?}, {expected}"
    );
    // And the spread says something.
    assert!(
        found.spread < 0.05 * (1.0 + expected.abs()),
        "{id}: {found:?}"
    );
}

#[test]
fn exponents_of_stable_orbits_are_those_of_their_multipliers() {
    for case in all() {
        let id = text(&case["id"]);
        let contacts = case["system"]["contacts"].as_array().unwrap().len();
        if remembers(&case) {
            let system = remembering(&case["system"]);
            compare(id, &system, &start(&case, contacts), period(&case));
        } else {
            let system = structure(&case["system"], f64::NAN);
            compare(id, &system, &start(&case, contacts), period(&case));
        }
    }
}

#[test]
fn exponents_of_a_belt() {
    // Pure slip, on its only cycle.
    let system = paper(0.4071);
    let cycle = limit_cycle::find(&system).unwrap()[0].clone();
    let expected = cycle.multiplier().ln() / cycle.period();
    let found = lyapunov_with_spread(&system, &cycle.state(), 10.0, 600.0).unwrap();
    assert!(
        (found.value - expected).abs() <= 4.0 * found.spread,
        "{found:?} {expected}"
    );
    assert_eq!(
        lyapunov(&system, &cycle.state(), 10.0, 600.0),
        Ok(found.value)
    );
    // In stick all that is beside the motion is gone.
    let found = lyapunov_with_spread(&paper(0.2), &(0.0, 0.0).into(), 0.0, 100.0).unwrap();
    assert_eq!((found.value, found.spread), (f64::NEG_INFINITY, 0.0));
    // At rest for ever: another displacement in the band stays another one. So says the formula,
    // and so the family of the same mass under a force that does not move it.
    let rest = MassOnBelt::new(Coulomb::new(0.4, 0.3).unwrap(), 0.0).unwrap();
    let found = lyapunov_with_spread(&rest, &(0.1, 0.0).into(), 0.0, 10.0).unwrap();
    assert_eq!((found.value, found.spread), (0.0, 0.0));
    let held = Structure::from(&rest).with_force(0, Drive::sine(0.1, 1.0).unwrap());
    let (held, start) = (held.unwrap(), State::new(&[0.1], &[0.0]));
    let rests = shoot(&held, &start, Period::Driven(1)).unwrap();
    assert_eq!(
        (rests.unslipped(), rests.state()),
        (&[0][..], start.clone())
    );
    assert_eq!(rests.multipliers(), [Complex::new(0.0, 0.0)]);
    let found = lyapunov_with_spread(&held, &start, 0.0, 10.0).unwrap();
    assert_eq!((found.value, found.spread), (0.0, 0.0));
    // Exactly on steady sliding: eigenvalues −β ± i√(1 − β²).
    let sliding = on_belt(Coulomb::new(0.25, 0.25).unwrap(), 0.5, 0.125, 1.0);
    let found = lyapunov_with_spread(&sliding, &(0.25, 0.0).into(), 0.0, 1e4).unwrap();
    println!("{found:?}");
    assert!(
        (found.value + 0.125).abs() <= 4.0 * found.spread,
        "{found:?}"
    );
    assert!(found.spread < 1e-3);
}

/// Where a motion has settled, what is left of it is rounding, and a shift along it decays like any
/// perturbation: the exponent is the largest real part −β or −β + √(β² − 1).
#[test]
fn exponents_of_motions_that_settle_are_those_of_the_eigenvalues() {
    for (damping, expected) in [(0.05, -0.05), (0.2, -0.2), (0.4, -0.4), (1.25, -0.5)] {
        let system = on_belt(Coulomb::new(0.3, 0.3).unwrap(), 1.0, damping, 1.0);
        let found = lyapunov_with_spread(&system, &(0.5, 0.1).into(), 500.0, 1000.0).unwrap();
        println!("{damping}: {found:?}");
        assert!(
            (found.value - expected).abs() < 1e-3,
            "{damping}: {found:?}"
        );
        assert!(found.spread < 1e-3, "{damping}: {found:?}");
    }
}

/// A duration may be shorter than a step, and begin inside one: the mean of the exponents of
/// neighbouring durations is that of the whole.
#[test]
fn neighbouring_durations_add_up() {
    let system = paper(0.4071);
    let start = (0.3, 0.1).into();
    let of = |transient, duration| lyapunov(&system, &start, transient, duration).unwrap();
    let whole = of(40.0, 8.0);
    let parts: Vec<f64> = (0..64)
        .map(|i| of(40.0 + f64::from(i) / 8.0, 0.125))
        .collect();
    assert!(parts.iter().any(|part| (part - whole).abs() > 0.01));
    let mean = parts.iter().sum::<f64>() / 64.0;
    assert!((mean - whole).abs() < 1e-13, "{mean} {whole}");
}

/// The spread is the standard error of a mean of 16 parts. On steady sliding, one step of any
/// length, each part alone is a shorter run after a longer transient.
#[test]
fn the_spread_is_the_standard_error_of_sixteen_parts() {
    let system = on_belt(Coulomb::new(0.25, 0.25).unwrap(), 0.5, 0.125, 1.0);
    let (start, part) = ((0.25, 0.0).into(), 1.75);
    let found = lyapunov_with_spread(&system, &start, 0.0, 16.0 * part).unwrap();
    let of = |i: u32| lyapunov(&system, &start, f64::from(i) * part, part).unwrap();
    let parts: Vec<f64> = (0..16).map(of).collect();
    let mean = parts.iter().sum::<f64>() / 16.0;
    let squares: f64 = parts.iter().map(|x| (x - mean).powi(2)).sum();
    let error = (squares / (16.0 * 15.0)).sqrt();
    assert!((found.value - mean).abs() < 1e-13, "{found:?} {mean}");
    assert!(
        error > 0.01 && (found.spread / error - 1.0).abs() < 1e-11,
        "{found:?} {error}"
    );
}

/// The exponent and its standard error, per unit of time, are the same numbers in other units of
/// time, of length, and of a first-order state. Powers of two change no digit of a motion.
#[test]
fn exponents_do_not_depend_on_units() {
    let found = |[time, length, of_state]: [i32; 3]| {
        let [t, l, z] = [time, length, of_state].map(|power| 2_f64.powi(power));
        let (stiffness, force, velocity) = (1.0 / (t * t), l / (t * t), l / t);
        // z' = (x − z)/0.7.
        let lag = FirstOrder::lag(0.7 * t)
            .and_then(|lag| {
                lag.with_displacement(0, z / l)?
                    .with_force(0, 0.2 * force / z)
            })
            .unwrap();
        let contact = |i: usize, fall: f64, load: f64, belt: f64| {
            let law = Exponential::new(0.4, 0.25, fall * velocity).unwrap();
            let contact = Contact::new(i, law, load * force).unwrap();
            contact.on_belt(belt * velocity)
        };
        let system = Structure::new(&[1.0, 1.0])
            .and_then(|pair| pair.with_ground_spring(0, stiffness))
            .and_then(|pair| pair.with_spring(0, 1, 0.7 * stiffness))
            .and_then(|pair| pair.with_ground_spring(1, 0.9 * stiffness))
            .and_then(|pair| pair.with_ground_damper(0, 0.02 / t))
            .and_then(|pair| pair.with_ground_damper(1, 0.02 / t))
            .and_then(|pair| pair.with_first_order(lag))
            .and_then(|pair| pair.with_contact(contact(0, 0.5, 1.0, 0.4)))
            .and_then(|pair| pair.with_contact(contact(1, 0.6, 0.7, 0.45)))
            .unwrap();
        let start = State::new(&[0.1 * l, 0.0], &[0.0, 0.1 * velocity]).with_memory(&[0.0]);
        let found = lyapunov_with_spread(&system, &start, 300.0 * t, 600.0 * t).unwrap();
        [found.value * t, found.spread * t]
    };
    let [value, spread] = found([0, 0, 0]);
    assert!(value.abs() < 0.1 && spread < 0.01, "{value} {spread}");
    for units in [
        [-30, 0, 0],
        [10, 0, 0],
        [0, -20, 0],
        [0, 0, 60],
        [0, 0, -60],
        [-30, 20, 60],
    ] {
        let other = found(units);
        println!("{units:?}: {other:?}");
        assert!(
            (other[0] - value).abs() < 1e-9,
            "{units:?}: {other:?} {value}"
        );
        assert!(
            (other[1] - spread).abs() < 1e-9,
            "{units:?}: {other:?} {spread}"
        );
    }
}

/// Growth by two motions side by side, once a period of the drive: no tangents.
fn growth_of_two(system: &Structure, start: State, periods: usize) -> f64 {
    const APART: f64 = 1e-8;
    let step = system.period().unwrap();
    let at = |number: usize| {
        Integrator::new()
            .with_start_time(number as f64 * step)
            .unwrap()
    };
    let mut one = start;
    let mut other = one.clone();
    other.displacements[0] += APART;
    let mut sum = 0.0;
    for number in 0..periods {
        one = at(number).simulate(system, one, step).unwrap().last();
        other = at(number).simulate(system, other, step).unwrap().last();
        let dq = other.displacements[0] - one.displacements[0];
        let dv = other.velocities[0] - one.velocities[0];
        let apart = dq.hypot(dv);
        sum += (apart / APART).ln();
        // Where both stick the velocities are those of the belt, to the bit.
        other.displacements[0] = one.displacements[0] + dq * (APART / apart);
        other.velocities[0] = one.velocities[0] + dv * (APART / apart);
    }
    sum / (periods as f64 * step)
}

#[test]
fn a_chaotic_motion_has_a_positive_exponent() {
    let system = popp_and_stelter(0.1, 0.75);
    let start = State::at_rest(1);
    let found = lyapunov_with_spread(&system, &start, 300.0, 5000.0).unwrap();
    assert!(found.value > 10.0 * found.spread, "{found:?}");
    let begin = section(&system, &start, system.period().unwrap());
    let begin = begin.into_iter().nth(40).unwrap().unwrap();
    let other = growth_of_two(&system, begin, 600);
    println!("{found:?}, by two motions {other}");
    assert!(
        (other - found.value).abs() < 6.0 * found.spread,
        "{found:?} {other}"
    );
    // No motion has come back.
    let states: Vec<State> = section(&system, &start, system.period().unwrap())
        .skip(100)
        .take(200)
        .map(Result::unwrap)
        .collect();
    let mut places: Vec<f64> = states.iter().map(|state| state.displacements[0]).collect();
    places.sort_by(f64::total_cmp);
    places.dedup_by(|a, b| (*a - *b).abs() < 1e-6);
    assert!(places.len() > 150, "{}", places.len());
}

#[test]
fn a_section_of_a_periodic_motion_is_a_point() {
    for case in all() {
        let id = text(&case["id"]);
        let Period::Driven(count) = period(&case) else {
            continue;
        };
        if remembers(&case) {
            continue;
        }
        let system = structure(&case["system"], f64::NAN);
        let guess = start(&case, 1);
        let orbit = settle(&system, &guess, 0.0, Period::Driven(count)).unwrap();
        if !orbit.is_stable() {
            continue;
        }
        let expected = orbit.state();
        let states: Vec<_> = section(&system, &expected, orbit.period())
            .take(300)
            .collect();
        assert_eq!(states.len(), 300);
        // The rounding of the period adds up, at most half an ulp each time.
        let late = 300.0 * 0.5 * f64::EPSILON * orbit.period();
        for state in states {
            let state = state.unwrap();
            for (i, (a, b)) in
                std::iter::zip(&state.displacements, &expected.displacements).enumerate()
            {
                let (slowest, fastest) = orbit.velocity_extremes(i);
                let allowed = 1e-13 + late * fastest.max(-slowest);
                assert!((a - b).abs() < allowed, "{id}: {a} {b}");
            }
        }
    }
}

#[test]
fn phases_are_kept_for_ever() {
    // A mass carried along by a belt that swings: q = sin Ωt, to the bit of the phase.
    let frequency = 0.7310585;
    let contact = Contact::new(0, Coulomb::new(10.0, 1.0).unwrap(), 1.0)
        .unwrap()
        .on_belt(Drive::harmonic(frequency, frequency, 0.0).unwrap());
    let system = one_mass([1.0, 0.0, 0.0], 0.0, contact).unwrap();
    let start = State::new(&[0.0], &[frequency]);
    let period = 0.25 * system.period().unwrap();
    let last = section(&system, &start, period)
        .nth(99_999)
        .unwrap()
        .unwrap();
    assert!(last.displacements[0].abs() < 1e-10, "{last:?}");
}

#[test]
fn events_are_a_section_too() {
    let system = paper(0.2);
    let release = EventKind::Release(Direction::Lagging);
    let times: Vec<f64> = section_at(&system, &(0.0, 0.0).into(), 0, release)
        .take(50)
        .map(|event| event.unwrap().time)
        .collect();
    let period = limit_cycle::stick_slip(&system).unwrap().unwrap().period();
    for pair in times.windows(2) {
        assert_abs_diff_eq!(pair[1] - pair[0], period, epsilon = 1e-12);
    }
    // Ends where the motion ends.
    let rest = MassOnBelt::new(Coulomb::new(0.4, 0.3).unwrap(), 0.0).unwrap();
    assert_eq!(section_at(&rest, &(0.1, 0.5).into(), 0, release).count(), 0);
    // And says so where nothing comes: steady sliding for ever.
    let slides = paper(0.45);
    let mut none = section_at(&slides, &(0.4, 0.0).into(), 0, release);
    let found = none.next();
    assert!(
        matches!(
            found,
            None | Some(Err(stick_slip::Error::TooManySteps { .. }))
        ),
        "{found:?}"
    );
    assert_eq!(none.next(), None);
}

/// The passages up to a time.
fn passages<S: Oscillator<State = State>>(
    system: &S,
    start: &State,
    (contact, speed): (usize, f64),
    end: f64,
) -> Vec<Passage<State>> {
    section_through(system, start, contact, speed)
        .map(Result::unwrap)
        .take_while(|passage| passage.time <= end)
        .collect()
}

/// Whether a contact is faster than a speed at equidistant times, as often as this changes.
fn seen(motion: &Trajectory<State>, (contact, speed): (usize, f64)) -> Vec<(f64, bool)> {
    const PLACES: u32 = 20_000;
    let place = |k: u32| motion.duration() * f64::from(k) / f64::from(PLACES);
    let is_faster = |t: f64| motion.sliding_velocity(contact, t).abs() > speed;
    let changes = (1..=PLACES).filter_map(|k| {
        let [before, now] = [place(k - 1), place(k)].map(is_faster);
        (before != now).then_some((place(k), now))
    });
    changes.collect()
}

/// Two blocks that stick, slip and overtake their belts: both directions of slip, and steps of all
/// modes. Samples, which may overlook two passages, see the same.
#[test]
fn speeds_pass_a_value_where_samples_see_it() {
    let mut random = Random::new(5);
    let mut all = 0;
    for _ in 0..20 {
        let contact = |i: usize, random: &mut Random| {
            let law = Rational::new(random.uniform(0.6, 1.0), random.uniform(1.0, 4.0)).unwrap();
            let contact = Contact::new(i, law, random.uniform(0.5, 1.5)).unwrap();
            contact.on_belt(random.uniform(-0.3, 0.3))
        };
        let contacts = [0, 1].map(|i| contact(i, &mut random));
        let system = Structure::new(&[1.0, 1.3])
            .and_then(|pair| pair.with_ground_spring(0, 1.0)?.with_ground_spring(1, 0.7))
            .and_then(|pair| pair.with_spring(0, 1, random.uniform(0.2, 2.0)))
            .and_then(|pair| pair.with_contacts(contacts))
            .unwrap();
        let start = State::new(&[random.uniform(-2.0, 2.0), 1.0], &[0.4, -0.9]);
        let motion = system.simulate(start.clone(), 40.0).unwrap();
        for contact in [0, 1] {
            let threshold = (contact, random.logarithmic(1e-3, 0.5));
            let found = passages(&system, &start, threshold, motion.duration());
            let seen = seen(&motion, threshold);
            let apart = motion.duration() / 1e4;
            // What samples see are passages; between two of them another pair may hide.
            let mut pair = 0;
            for (time, rises) in &seen {
                let place = found[pair..].iter().position(|passage| {
                    passage.rises == *rises && (passage.time - time).abs() <= apart
                });
                let place = place.unwrap_or_else(|| panic!("{threshold:?}: {time} {rises}"));
                assert!(place.is_multiple_of(2), "{threshold:?}: {time}");
                pair += place + 1;
            }
            assert!((found.len() - pair).is_multiple_of(2));
            for passage in &found {
                let speed = motion.sliding_velocity(contact, passage.time).abs();
                assert!(
                    (speed - threshold.1).abs() < 1e-14,
                    "{threshold:?}: {speed}"
                );
                let state = motion.state_at(passage.time).unwrap();
                assert!((state.displacements[0] - passage.state.displacements[0]).abs() < 1e-14);
                all += 1;
            }
            for pair in found.windows(2) {
                let [one, next] = [&pair[0], &pair[1]];
                assert!(one.rises != next.rises && one.time < next.time);
                // A start at a passage does not count: the next one is the first.
                let again = section_through(&system, &one.state, contact, threshold.1).next();
                let again = again.unwrap().unwrap();
                assert!(
                    (one.time + again.time - next.time).abs() < 1e-9,
                    "{again:?} {next:?}"
                );
                assert_eq!(again.rises, next.rises);
            }
        }
    }
    assert!(all > 300, "{all}");
}

/// Between the passages of a belt's limit cycle lies half of what its closed form gives.
#[test]
fn speeds_of_a_belt_pass_a_value() {
    // Coulomb friction, slip of an undamped mass: s = A |sin(t − t₀)| with the belt at rest.
    let system = MassOnBelt::new(Coulomb::new(0.3, 0.3).unwrap(), 0.0).unwrap();
    let found = section_through(&system, &(5.0, 0.0).into(), 0, 1.0);
    let found: Vec<Passage<_>> = found.map(Result::unwrap).collect();
    let expected = (0..).map_while(|half| {
        // The amplitude falls by 2μ in each half of a cycle.
        let amplitude = 4.7 - 0.6 * f64::from(half);
        let since = std::f64::consts::PI * f64::from(half);
        (amplitude > 1.0).then(|| {
            let angle = f64::asin(1.0 / amplitude);
            [
                (since + angle, true),
                (since + std::f64::consts::PI - angle, false),
            ]
        })
    });
    let expected: Vec<_> = expected.flatten().collect();
    assert_eq!(found.len(), expected.len());
    assert_eq!(expected.len(), 14);
    for (found, (time, rises)) in std::iter::zip(found, expected) {
        assert!((found.time - time).abs() < 1e-13, "{found:?} {time}");
        assert_eq!(found.rises, rises);
        assert!((found.state.velocity.abs() - 1.0).abs() < 1e-14);
    }
    // A touch and a start are no passages.
    let free = MassOnBelt::new(Coulomb::new(0.4, 0.0).unwrap(), 0.0).unwrap();
    let count = |speed: f64| {
        let found = section_through(&free, &(0.0, 0.5).into(), 0, speed);
        found.take(4).collect::<Result<Vec<_>, Error>>()
    };
    let [first, ..] = &count(0.25).unwrap()[..] else {
        panic!("no passage");
    };
    assert!((first.time - std::f64::consts::FRAC_PI_3).abs() < 1e-14 && !first.rises);
    assert!(matches!(
        count(0.5 + 1e-12),
        Err(Error::TooManySteps { .. })
    ));
}

/// Where the surface jumps, the speed jumps through the value.
#[test]
fn a_speed_may_jump_through_a_value() {
    let surface = Drive::profile(&[(0.0, 0.1), (2.0, 0.1), (2.0, 1.0), (4.0, 1.0), (4.0, 0.1)]);
    let law = RateState::aging(0.4, 0.12, 0.1, 0.3, 0.2).unwrap();
    let contact = Contact::new(0, law, 1.0).unwrap().on_belt(surface.unwrap());
    let system = one_mass([1.0, 0.0, 1.0], 0.0, contact).unwrap();
    let start = State::new(&[0.4], &[0.0]).with_memory(&[0.5]);
    // The motion settles: in the end there are no more passages.
    let found: Vec<_> = section_through(&system, &start, 0, 0.6)
        .map_while(Result::ok)
        .collect();
    let jumps: Vec<_> = found
        .iter()
        .filter(|p| p.time == 2.0 || p.time == 4.0)
        .collect();
    assert_eq!(jumps[0].time, 2.0);
    assert!(jumps[0].rises, "{jumps:?}");
    for pair in found.windows(2) {
        assert!(pair[0].rises != pair[1].rises && pair[0].time < pair[1].time);
    }
}
