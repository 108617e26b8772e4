//! Elastic contacts and normal springs: closed forms, the rigid limit, and random structures
//! against a scheme that knows neither modes nor events.

use std::f64::consts::PI;

use approx::{assert_abs_diff_eq, assert_relative_eq};
use stick_slip::nalgebra::{DMatrix, DVector};
use stick_slip::structure::State;
use stick_slip::{
    Contact, Coulomb, Direction, Drive, Error, Event, EventKind, Exponential, Integrator, LuGre,
    Mode, Segment, Structure,
};

use crate::common::{Random, assert_form, count, even, exactly, forces, larger, one_mass, refused};

/// The loop that a public tool prints for k_t = 2, F_s = 3: displacements 0, 5, 3.5, 2, −5, −3.5,
/// −2, 0 give forces 0, 3, 0, −3, −3, 0, 3, 3.
#[test]
fn a_printed_loop() {
    let way = [0.0, 5.0, 3.5, 2.0, -5.0, -3.5, -2.0, 0.0];
    let forces = [0.0, 3.0, 0.0, -3.0, -3.0, 0.0, 3.0, 3.0];
    let mut velocity = Vec::new();
    for (k, pair) in way.windows(2).enumerate() {
        let speed = pair[0] - pair[1];
        velocity.extend([(k as f64, speed), (k as f64 + 1.0, speed)]);
    }
    let element = Contact::new(0, even(0.5), 6.0)
        .and_then(|contact| contact.with_tangential_stiffness(2.0))
        .unwrap()
        .on_belt(Drive::profile(&velocity).unwrap());
    // A mass that does not move, seen from the surface.
    let structure = one_mass([1e30, 0.0, 0.0], 0.0, element).unwrap();
    let motion = structure.simulate(State::at_rest(1), 7.0).unwrap();
    for (k, force) in forces.iter().enumerate() {
        let found = motion.state_at(k as f64).unwrap();
        assert_abs_diff_eq!(found.memory[0], *force, epsilon = 1e-14);
    }
}

/// A normal spring and a gradient of the load on the coordinate along which the contact acts, which
/// never slips: q = −d N₀ (1 − cos ωt)/K with K = k + k_t + d (k_n d + n), ω² = K.
#[test]
fn a_normal_spring_and_a_gradient_of_one_coordinate_add() {
    for (d, n) in [(1.0, 0.5), (1.0, -0.5), (0.1, 0.5), (1.0, -3.0)] {
        let contact = Contact::new(0, even(100.0), 10.0)
            .and_then(|contact| contact.with_tangential_stiffness(5.0))
            .and_then(|contact| contact.with_normal_spring(&[(0, d)], 3.0))
            .and_then(|contact| contact.with_load_gradient(0, n))
            .unwrap();
        let structure = one_mass([1.0, 0.0, 2.0], 0.0, contact).unwrap();
        let motion = structure.simulate(State::at_rest(1), 5.0).unwrap();
        let stiffness: f64 = 7.0 + d * (3.0 * d + n);
        let expected = -d * 10.0 / stiffness * (1.0 - (5.0 * stiffness.sqrt()).cos());
        assert_abs_diff_eq!(motion.last().displacements[0], expected, epsilon = 1e-13);
        let budget = structure.energy_budget(&motion).unwrap();
        assert!(budget.defect().abs() < 1e-12, "{:e}", budget.defect());
    }
}

/// One mass on a spring and a Jenkins element, without damping, by its arcs in closed form: the
/// time and the displacement of each event, all in differences from the event before.
fn arcs(stiffness: f64, limit: f64, start: f64, most: usize) -> Vec<(f64, EventKind, f64)> {
    let (mut time, mut x, mut v, mut carried) = (0.0, start, 0.0, 0.0);
    let mut events = Vec::new();
    while events.len() < most {
        // Stick: y'' = −Ω² y − (x + T), y = x − x_s; T reaches its limit at y = (±F − T)/k_t.
        let omega = (1.0_f64 + stiffness).sqrt();
        let amplitude = (x + carried) / (omega * omega);
        let way = |t: f64| {
            -amplitude * 2.0 * (0.5 * omega * t).sin().powi(2) + v / omega * (omega * t).sin()
        };
        let speed = |t: f64| -amplitude * omega * (omega * t).sin() + v * (omega * t).cos();
        // The turn, where the way is farthest.
        let turn = (v / (amplitude * omega)).atan().rem_euclid(PI);
        let turn = if turn == 0.0 { PI } else { turn };
        let side = if way(turn / omega) >= 0.0 { 1.0 } else { -1.0 };
        let level = (side * limit - carried) / stiffness;
        if (way(turn / omega) - level) * side <= 0.0 {
            break;
        }
        let (mut low, mut high) = (0.0, turn / omega);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if (way(middle) - level) * side < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        time += high;
        (x, v, carried) = (x + level, speed(high), side * limit);
        let to = if side > 0.0 {
            Direction::Leading
        } else {
            Direction::Lagging
        };
        events.push((time, EventKind::Release(to), x));
        // Slip: x'' = −x − σF, up to the turn.
        let centre = -side * limit;
        let phase = (v / (x - centre)).atan().rem_euclid(PI);
        let radius = (x - centre).hypot(v);
        time += phase;
        (x, v) = (centre + side * radius, 0.0);
        events.push((time, EventKind::Stick, x));
    }
    events
}

#[test]
fn any_stiffness_has_every_event() {
    let (limit, start) = (0.3, 5.0);
    for exponent in -2..=12 {
        let stiffness = 10.0_f64.powi(exponent);
        let expected = arcs(stiffness, limit, start, 14);
        let contact = Contact::new(0, even(0.3), 1.0).unwrap();
        let contact = contact.with_tangential_stiffness(stiffness).unwrap();
        let structure = one_mass([1.0, 0.0, 1.0], 0.0, contact).unwrap();
        let end = expected.last().map_or(20.0, |last| last.0 + 1e-9);
        let motion = structure
            .simulate(State::new(&[start], &[0.0]), end)
            .unwrap();
        let kinds: Vec<_> = expected.iter().map(|event| event.1).collect();
        let found: Vec<_> = motion.events().iter().map(|event| event.kind).collect();
        assert_eq!(found, kinds, "{stiffness}");
        for (event, (time, _, x)) in motion.events().iter().zip(&expected) {
            assert_relative_eq!(event.time, *time, max_relative = 1e-13);
            assert_abs_diff_eq!(event.state.displacements[0], *x, epsilon = 1e-12);
            // At its limit, to the bit.
            assert_eq!(event.state.memory[0].abs(), 0.3, "{stiffness}");
        }
        assert_eq!(expected.is_empty(), stiffness < 0.05, "{stiffness}");
    }
}

/// The difference from the rigid contact falls as 1/√k_t.
#[test]
fn the_rigid_limit_has_its_order() {
    let contact = Contact::new(0, even(0.4), 1.0).unwrap().on_belt(0.1);
    let with = |contact: Contact| {
        let force = Drive::harmonic(0.9, 0.7, 0.0).unwrap();
        one_mass([1.0, 0.1, 1.0], force, contact).unwrap()
    };
    let motion = |structure: &Structure| structure.simulate(State::at_rest(1), 30.0).unwrap();
    let rigid = motion(&with(contact.clone()));
    let apart = |stiffness: f64| {
        let elastic = contact
            .clone()
            .with_tangential_stiffness(stiffness)
            .unwrap();
        let elastic = motion(&with(elastic));
        let times = (1..300).map(|k| 0.1 * f64::from(k));
        let differences = times.map(|time| {
            let [one, other] = [&rigid, &elastic].map(|motion| motion.state_at(time).unwrap());
            (one.displacements[0] - other.displacements[0])
                .hypot(one.velocities[0] - other.velocities[0])
        });
        differences.fold(0.0, larger)
    };
    let found = [1e4, 1e6, 1e8].map(apart);
    for pair in found.windows(2) {
        let order = (pair[0] / pair[1]).log10() / 2.0;
        assert!((order - 0.5).abs() < 0.02, "{order}: {found:?}");
    }
}

/// A structure of elastic contacts, and what a simple scheme needs of it.
struct Drawn {
    structure: Structure,
    start: State,
}

fn drive(random: &mut Random, about: f64, amplitude: f64, may_jump: bool) -> Drive {
    let drive = Drive::constant(about);
    match random.bits() % 4 {
        0 => {
            let [frequency, phase] = [(0.3, 2.5), (0.0, 6.0)].map(|(a, b)| random.uniform(a, b));
            drive.with_harmonic(amplitude, frequency, phase).unwrap()
        }
        1 => {
            // Between steps of the simple scheme.
            let jump = random.uniform(1.0, 6.0).round();
            let [a, b, mut c] = [0.0; 3].map(|_| random.uniform(-amplitude, amplitude));
            if !may_jump {
                c = b;
            }
            drive
                .with_profile(&[(0.0, a), (jump, b), (jump, c), (8.0, a)])
                .unwrap()
        }
        _ => drive,
    }
}

/// Rigid contacts among them, loads that jump, and stiffnesses up to 1e12, if `mixed`.
fn draw(random: &mut Random, mixed: bool) -> Drawn {
    let n = 1 + (random.bits() % 3) as usize;
    let coupling = if random.bits().is_multiple_of(2) {
        0.0
    } else {
        random.uniform(-0.2, 0.2)
    };
    let masses: Vec<f64> = (0..n).map(|_| random.uniform(0.5, 2.0)).collect();
    let mass = |i: usize, j: usize| if i == j { masses[i] } else { coupling };
    let mut structure = Structure::with_mass_matrix(DMatrix::from_fn(n, n, mass)).unwrap();
    for i in 0..n {
        let force = drive(random, 0.0, 1.5, true);
        let [spring, damper, beside] =
            [(0.3, 2.0), (0.0, 0.2), (0.2, 2.0)].map(|(a, b)| random.uniform(a, b));
        structure = structure
            .with_ground_spring(i, spring)
            .and_then(|s| s.with_ground_damper(i, damper))
            .and_then(|s| s.with_force(i, force))
            .unwrap();
        if i > 0 {
            structure = structure.with_spring(i - 1, i, beside).unwrap();
        }
    }
    let mut memory = Vec::new();
    for _ in 0..1 + random.bits() % 4 {
        let i = (random.bits() % n as u64) as usize;
        let j = (random.bits() % n as u64) as usize;
        let about = random.uniform(0.3, 1.5);
        let varies = random.bits().is_multiple_of(3);
        let load = if varies {
            drive(random, about, 1.2, mixed)
        } else {
            about.into()
        };
        let law = even(random.uniform(0.1, 0.8));
        let made = if i == j {
            Contact::new(i, law, load)
        } else {
            Contact::along(&[(i, 1.0), (j, random.uniform(-1.5, -0.5))], law, load)
        };
        let mut contact = made.unwrap();
        let is_rigid = mixed && random.bits().is_multiple_of(3);
        if !is_rigid {
            let powers = if mixed { (-2.0, 12.0) } else { (-1.0, 2.0) };
            let stiffness = 10.0_f64.powf(random.uniform(powers.0, powers.1));
            contact = contact.with_tangential_stiffness(stiffness).unwrap();
            memory.push(0.0);
        }
        if random.bits().is_multiple_of(3) {
            let normal = (random.bits() % n as u64) as usize;
            let d = if random.bits().is_multiple_of(2) {
                1.0
            } else {
                -1.0
            };
            let stiffness = random.uniform(0.2, 2.0);
            contact = contact
                .with_normal_spring(&[(normal, d)], stiffness)
                .unwrap();
        }
        let w = random.uniform(-0.3, 0.3);
        let belt = if is_rigid {
            w.into()
        } else {
            drive(random, w, 0.5, true)
        };
        structure = structure.with_contact(contact.on_belt(belt)).unwrap();
    }
    let mut numbers = || -> Vec<f64> { (0..n).map(|_| random.uniform(-1.0, 1.0)).collect() };
    let start = State::new(&numbers(), &numbers()).with_memory(&memory);
    Drawn { structure, start }
}

/// Moreau's catching-up: T ← clip(T + k_t Δx, ±μN) at the midpoints of steps of position Verlet.
fn catch_up(drawn: &Drawn, duration: f64, steps: usize) -> State {
    let Drawn { structure, start } = drawn;
    let (n, h) = (structure.len(), duration / steps as f64);
    let inverse = structure.mass_matrix().into_owned().try_inverse().unwrap();
    let damping = &inverse * structure.damping() * (0.5 * h);
    let forward = DMatrix::identity(n, n) - &damping;
    let back = (DMatrix::identity(n, n) + &damping).try_inverse().unwrap();
    let mut q = DVector::from_column_slice(&start.displacements);
    let mut v = DVector::from_column_slice(&start.velocities);
    let mut carried = start.memory.clone();
    let mut stretch = |q: &DVector<f64>, moved: &DVector<f64>, time: f64, h: f64| {
        // Forces on the structure after a part of the way.
        let mut force = DVector::zeros(n);
        for (contact, carried) in structure.contacts().iter().zip(&mut carried) {
            let along: f64 = contact.direction().iter().map(|&(j, b)| b * moved[j]).sum();
            // Drives jump between steps, in the middle of a way from midpoint to midpoint.
            let [before, after] = [0.75, 0.25].map(|back| time - back * h);
            let belt = contact.belt_velocity();
            let belt = 0.5 * h * (belt.value(before) + belt.value(after));
            let load = contact.load_at(time, q.as_slice()).max(0.0);
            let limit = load * contact_coefficient(contact);
            let stiffness = contact.tangential_stiffness().unwrap();
            *carried = (*carried + stiffness * (along - belt)).clamp(-limit, limit);
            for &(j, b) in contact.direction() {
                force[j] -= b * *carried;
            }
            for &(j, d) in contact.normal_spring().map_or(&[][..], |(d, _)| d) {
                force[j] -= d * load;
            }
        }
        (force, carried.clone())
    };
    let mut last = q.clone();
    for k in 0..steps {
        let middle = &q + &v * (0.5 * h);
        let time = (k as f64 + 0.5) * h;
        let (mut force, _) = stretch(
            &middle,
            &(&middle - &last),
            time,
            if k == 0 { 0.5 * h } else { h },
        );
        for (j, f) in structure.forces().iter().enumerate() {
            force[j] += f.value(time);
        }
        force -= structure.stiffness() * &middle;
        v = &back * (&forward * &v + &inverse * force * h);
        q = &middle + &v * (0.5 * h);
        last = middle;
    }
    let (_, carried) = stretch(&q, &(&q - &last), duration, 0.5 * h);
    State::new(q.as_slice(), v.as_slice()).with_memory(&carried)
}

fn contact_coefficient(contact: &Contact) -> f64 {
    // All laws here are Coulomb's with one coefficient, which a contact shows in its text.
    let text = format!("{contact:?}");
    let after = text.split("static_coefficient: ").nth(1).unwrap();
    let number: String = after.chars().take_while(|c| !",} ".contains(*c)).collect();
    number.parse().unwrap()
}

#[test]
fn a_scheme_without_events_comes_to_the_same_states() {
    let mut random = Random::new(91);
    let (mut worst, mut events) = (0.0_f64, 0);
    let cases = count(4, 40);
    for i in 0..cases {
        let drawn = draw(&mut random, false);
        let duration = 8.0;
        let motion = match drawn.structure.simulate(drawn.start.clone(), duration) {
            Err(Error::OverLimit { .. }) => continue,
            motion => motion.unwrap(),
        };
        events += motion.events().len();
        let apart = |steps: usize| {
            let state = catch_up(&drawn, duration, steps);
            let found = motion.last();
            let pairs = [
                (&found.displacements, &state.displacements),
                (&found.velocities, &state.velocities),
            ];
            let differences = pairs.into_iter().flat_map(|(a, b)| a.iter().zip(b));
            differences.fold(0.0_f64, |largest, (a, b)| largest.max((a - b).abs()))
        };
        let mut found = apart(8_000);
        let first = found;
        // Of first order where a load comes back over a contact that sticks.
        for steps in [64_000, 512_000, 4_096_000] {
            if found > 1e-5 {
                found = apart(steps);
            }
        }
        assert!(
            found < 1e-5,
            "{i}: {first:e}, {found:e}: {:?} {:?}",
            drawn.structure,
            drawn.start
        );
        worst = larger(worst, found);
    }
    println!("{events} events, {worst:.1e}");
    assert!(events > 8 * cases, "{events}");
}

/// What holds along every step, of elastic contacts and rigid ones in one structure.
#[test]
fn motions_of_elastic_contacts_obey_the_law() {
    let mut random = Random::new(92);
    let (mut events, mut motions) = (0, 0);
    let cases = count(30, 600);
    for i in 0..cases {
        let Drawn { structure, start } = draw(&mut random, true);
        let about = || format!("{i}: {structure:?}\n{start:?}");
        let flow = match Integrator::new().flow(&structure, start.clone()) {
            Err(Error::OverLimit { .. }) => continue,
            flow => flow.unwrap_or_else(|error| panic!("{error}\n{}", about())),
        };
        motions += 1;
        // A stiff spring that sticks vibrates so fast that a whole motion would take 10⁷ steps.
        for step in flow.take(400) {
            let step = step.unwrap_or_else(|error| panic!("{error}\n{}", about()));
            events += step.events().len();
            if step.start_time() > 20.0 || step.duration() > 1e3 {
                break;
            }
            if step.duration() == 0.0 {
                continue;
            }
            for part in [1e-3, 0.35, 0.6, 0.999] {
                let t = part * step.duration();
                let (time, state) = (step.start_time() + t, step.state_at(t));
                let along = |row: &[(usize, f64)]| -> f64 {
                    row.iter().map(|&(j, b)| b * state.velocities[j]).sum()
                };
                let mut place = 0;
                for (c, contact) in structure.contacts().iter().enumerate() {
                    let load = contact.load_at(time, &state.displacements);
                    let size = 1e-11 * (1.0 + load.abs());
                    let Some(stiffness) = contact.tangential_stiffness() else {
                        let is_open = step.modes()[c] == Mode::Open;
                        assert!(if is_open { load <= size } else { load >= -size });
                        continue;
                    };
                    let carried = state.memory[place];
                    place += 1;
                    let limit = load * contact_coefficient(contact);
                    let holds = match step.modes()[c] {
                        Mode::Open => load <= size && carried == 0.0,
                        Mode::Stick => carried.abs() <= limit + size,
                        Mode::Slip(side) => {
                            // ζ = σ r − μN'/k_t ≥ 0
                            let spring = contact.normal_spring();
                            let pressed = spring.map_or(0.0, |(d, k)| k * along(d));
                            let rate = contact.load().slope(time) + pressed;
                            let r =
                                along(contact.direction()) - contact.belt_velocity().value(time);
                            let fallen = contact_coefficient(contact) * rate / stiffness;
                            let slider = side.sign() * r - fallen;
                            (carried - side.sign() * limit).abs() <= size
                                && slider >= -1e-13 * (1.0 + fallen.abs())
                        }
                    };
                    assert!(holds, "contact {c} at {time} {}", about());
                }
            }
        }
    }
    println!("{motions} motions, {events} events");
    assert!(events > 5 * cases, "{events}");
}

#[test]
fn bad_elastic_contacts_are_refused() {
    let contact = || Contact::new(0, even(0.3), 2.0).unwrap();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for refused in [
            contact().with_tangential_stiffness(bad).unwrap_err(),
            contact().with_normal_spring(&[(0, 1.0)], bad).unwrap_err(),
            contact()
                .in_parallel(&[(1.0, 0.5), (1.0, bad)])
                .unwrap_err(),
            contact().in_parallel(&[(bad, 0.5)]).unwrap_err(),
        ] {
            assert!(
                matches!(refused, Error::InvalidParameter { .. }),
                "{bad}: {refused}"
            );
            assert_form(&refused.to_string());
        }
    }
    refused!(contact().in_parallel(&[(1.0, f64::MAX)]) => Error::InvalidParameter { .. });
    for direction in [
        &[][..],
        &[(0, 0.0)],
        &[(0, f64::NAN)],
        &[(1, 1.0), (1, 2.0)],
    ] {
        refused!(contact().with_normal_spring(direction, 1.0) => Error::BadDirection { .. });
    }
    // Not one constant: static friction, a law that falls, a memory.
    let falls = Exponential::new(0.4, 0.2, 0.1).unwrap();
    let bristles = LuGre::new(falls, 10.0, 0.1, 0.0).unwrap();
    let refused = [
        (
            Contact::new(0, Coulomb::new(0.4, 0.3).unwrap(), 1.0),
            Some([0.4, 0.3]),
            "has μ_s = 0.4 and μ̂(0) = 0.3, or varies with the speed",
        ),
        (
            Contact::new(0, falls, 1.0),
            Some([0.4, 0.4]),
            "has μ_s = 0.4 and μ̂(0) = 0.4, or varies with the speed",
        ),
        (
            Contact::new(0, bristles, 1.0),
            None,
            "never sticks: its friction at rest depends on its memory variables alone",
        ),
    ];
    for (contact, expected, says) in refused {
        let error = contact.unwrap().with_tangential_stiffness(1.0).unwrap_err();
        let coefficients = expected;
        assert_eq!(error, Error::LawNotConstant { coefficients });
        assert!(error.to_string().contains(says), "{error}");
        assert_form(&error.to_string());
    }
    let elastic = contact().with_tangential_stiffness(5.0).unwrap();
    let structure = one_mass([1.0, 0.0, 0.0], 0.0, elastic).unwrap();
    let start = |carried: f64| State::at_rest(1).with_memory(&[carried]);
    assert!(structure.simulate(start(-0.6), 1.0).is_ok());
    for bad in [0.601, -0.7, f64::MAX] {
        let error = structure.simulate(start(bad), 1.0).unwrap_err();
        let expected = Error::OverLimit {
            contact: 0,
            carried: bad,
            limit: 0.6,
        };
        assert_eq!(error, expected);
        assert_form(&error.to_string());
        assert_eq!(structure.carried(0.0, &start(bad)), Err(expected));
    }
    for bad in [f64::NAN, f64::INFINITY] {
        assert!(structure.simulate(start(bad), 1.0).is_err());
    }
    // An elastic contact at rest has a continuum of equilibria.
    let still = structure.with_ground_spring(0, 1.0).unwrap();
    assert_form(&still.steady_sliding().unwrap_err().to_string());
    // A coordinate that is not there.
    let spring = contact().with_normal_spring(&[(3, 1.0)], 1.0).unwrap();
    // The parts of a gradient that is 0 there, too.
    let cancelled = spring.clone().with_load_gradient(3, -1.0).unwrap();
    for contact in [spring, cancelled] {
        let found = Structure::new(&[1.0]).unwrap().with_contact(contact);
        refused!(found => Error::NoSuchCoordinate { coordinate: 3, .. });
    }
}

/// Nothing moves yet, and what will is 0 at first: a surface, a force, a load.
#[test]
fn motions_begin_from_rest() {
    let sine = || Drive::sine(0.7, 1.3).unwrap();
    let contact = |load: Drive| {
        let contact = Contact::new(0, even(0.4), load).unwrap();
        contact.with_tangential_stiffness(3.0).unwrap()
    };
    let mass = || Structure::new(&[1.0]).and_then(|mass| mass.with_ground_spring(0, 1.0));
    let on = |contact: Contact| mass().and_then(|mass| mass.with_contact(contact)).unwrap();
    let surface = on(contact(1.0.into()).on_belt(sine()));
    let force = on(contact(1.0.into())).with_force(0, sine()).unwrap();
    let load = on(contact(sine()).on_belt(0.5));
    let free = one_mass([1.0, 0.0, 0.0], 0.0, contact(1.0.into()).on_belt(sine())).unwrap();
    let still = on(contact(1.0.into()));
    let events = [surface, force, load, free, still].map(|structure| {
        let motion = structure.simulate(State::at_rest(1), 30.0).unwrap();
        motion.events().len()
    });
    assert_eq!(events[4], 0);
    assert!(events[..4].iter().all(|count| *count > 5), "{events:?}");
}

/// Elastic contacts whose directions depend on each other, together with a rigid one.
#[test]
fn parallel_elements_share_what_they_carry() {
    let pair = |elastic: bool| {
        let contact = Contact::between(0, 1, even(0.5), 2.0).unwrap();
        let contacts = if elastic {
            contact.in_parallel(&[(3.0, 0.5), (1.0, 0.5)]).unwrap()
        } else {
            vec![contact.clone(), contact]
        };
        Structure::new(&[1.0, 1.0])
            .and_then(|s| s.with_force(0, 0.2))
            .and_then(|s| s.with_ground_spring(0, 1.0))
            .and_then(|s| s.with_ground_spring(1, 1.0))
            .and_then(|s| s.with_contacts(contacts))
            .unwrap()
    };
    let rigid = pair(false).simulate(State::at_rest(2), 5.0).unwrap();
    assert!(rigid.events().is_empty());
    let motion = pair(true).simulate(State::at_rest(2), 5.0).unwrap();
    let carried = &motion.last().memory;
    assert_relative_eq!(carried[0], 3.0 * carried[1], max_relative = 1e-13);
    assert_eq!(
        forces(&pair(true).carried(5.0, &motion.last()).unwrap()),
        *carried
    );
}

/// A block that rests is pushed by a force, while a spring beside it is open, or opens because its
/// load falls: an open spring does not pull, whichever contact is numbered first.
#[test]
fn an_open_spring_does_not_pull_what_starts_to_slip() {
    let (force, mass, friction) = (1.0, 0.8, 0.3);
    let ground = || Contact::new(0, even(friction), 1.0).unwrap();
    // The load jumps below 0 at the time 1, or is below it from the beginning.
    for begin in [0.0, 1.0] {
        for side in [1.0, -1.0] {
            let load = Drive::profile(&[(begin, 0.1), (begin, -2.0)]).unwrap();
            let push = Drive::profile(&[(begin, 0.0), (begin, force)]).unwrap();
            let spring = Contact::new(1, even(0.2), load)
                .and_then(|contact| contact.with_normal_spring(&[(0, side)], 0.5))
                .unwrap();
            for first in [true, false] {
                let [a, b] = if first {
                    [ground(), spring.clone()]
                } else {
                    [spring.clone(), ground()]
                };
                let block = Structure::new(&[mass, 1.0])
                    .and_then(|s| {
                        s.with_force(0, push.clone())?
                            .with_contact(a)?
                            .with_contact(b)
                    })
                    .unwrap();
                let motion = block.simulate(State::at_rest(2), begin + 1.0).unwrap();
                let velocity = (force - friction) / mass;
                assert_abs_diff_eq!(motion.last().velocities[0], velocity, epsilon = 1e-14);
                assert_abs_diff_eq!(
                    motion.last().displacements[0],
                    0.5 * velocity,
                    epsilon = 1e-14
                );
                let defect = block.energy_budget(&motion).unwrap().defect();
                assert_abs_diff_eq!(defect, 0.0, epsilon = 1e-14);
            }
        }
    }
}

/// A rigid joint that sticks keeps a slider beside it at rest, also where its spring is at the
/// limit: the relative velocity of the two masses is mere rounding.
#[test]
fn a_slider_at_its_limit_rests_beside_a_joint_that_holds() {
    let mut random = Random::new(91);
    for i in 0..count(12, 100) {
        let mut uniform = |low, high| random.uniform(low, high);
        let masses = [0; 2].map(|_| uniform(0.5, 2.0));
        let (spring, damper) = (uniform(0.5, 2.0), uniform(0.05, 0.2));
        let force = Drive::harmonic(uniform(0.1, 0.5), uniform(0.5, 3.0), 0.3).unwrap();
        let (load, stiffness) = (uniform(0.5, 2.0), uniform(5.0, 50.0));
        let pair = Structure::new(&masses)
            .and_then(|s| {
                s.with_ground_spring(0, spring)?
                    .with_ground_damper(1, damper)
            })
            .and_then(|s| s.with_spring(0, 1, 0.7)?.with_force(0, force))
            .and_then(|s| {
                let elastic = Contact::between(0, 1, even(0.3), load)?;
                s.with_contact(elastic.with_tangential_stiffness(stiffness)?)
            })
            .and_then(|s| s.with_contact(Contact::between(0, 1, even(0.5), 40.0)?))
            .unwrap();
        let velocity = uniform(-1.0, 1.0);
        let start = State::new(&[uniform(-1.0, 1.0), 0.1], &[velocity; 2]);
        let start = start.with_memory(&[0.3 * load]);
        for tolerance in [1e-6, 1e-9, f64::EPSILON] {
            let integrator = Integrator::new().with_tolerance(tolerance).unwrap();
            let motion = integrator.simulate(&pair, start.clone(), 30.0).unwrap();
            assert!(
                motion.events().is_empty(),
                "{i}, {tolerance:e}: {:?}",
                motion.events()
            );
        }
    }
}

/// A slider at its limit beside masses that stick, one to the other and this one to the ground: its
/// force and its load are constant, also if the load depends on where they are, while another mass
/// vibrates for ever.
#[test]
fn a_slider_whose_load_depends_on_masses_at_rest_rests_with_them() {
    let mut random = Random::new(92);
    let mut at_limit = 0;
    for i in 0..count(12, 100) {
        let mut uniform = |low, high| random.uniform(low, high);
        let springs = [uniform(0.3, 1.0), uniform(0.5, 1.5)];
        let masses = [uniform(0.5, 2.0), uniform(0.5, 2.0), 0.5, 1.0];
        let start = State::new(
            &[uniform(-0.4, 0.0), 0.0, 0.3, 0.0],
            &[uniform(0.3, 1.0), 0.0, 0.0, 0.0],
        );
        let between = |other: usize| Contact::between(0, other, even(0.4), 0.6);
        let sliders = [
            between(1).and_then(|it| it.with_normal_spring(&[(0, -0.7)], 1.5)),
            between(1).and_then(|it| it.with_load_gradient(0, -0.6)),
            between(1).and_then(|it| it.with_load_gradient(0, 0.6)),
            Contact::new(0, even(0.4), 0.6).and_then(|it| it.with_load_gradient(0, -0.5)),
            // With a mass that a contact of its own holds.
            between(3).and_then(|it| it.with_load_gradient(0, -0.5)?.with_load_gradient(3, 0.3)),
        ];
        for (kind, slider) in sliders.into_iter().enumerate() {
            let structure = Structure::new(&masses)
                .and_then(|s| {
                    s.with_ground_spring(0, springs[0])?
                        .with_spring(0, 1, springs[1])
                })
                .and_then(|s| s.with_spring(1, 2, 0.2)?.with_ground_spring(2, 2.0))
                .and_then(|s| s.with_contact(Contact::new(1, even(0.9), 2.0)?))
                .and_then(|s| s.with_contact(Contact::between(0, 1, even(0.3), 1.6)?))
                .and_then(|s| s.with_contact(Contact::new(3, even(0.5), 3.0)?))
                .and_then(|s| s.with_contact(slider?.with_tangential_stiffness(19.0)?))
                .unwrap();
            let motion = structure.simulate(start.clone(), 50.0);
            let motion = motion.unwrap_or_else(|error| panic!("{i}, {kind}: {error}"));
            let is_of_joint = |event: &&Event<State>| event.contact() == Some(1);
            let last = motion.events().iter().rfind(is_of_joint).unwrap();
            assert_eq!(last.kind, EventKind::Stick);
            let late = motion
                .events()
                .iter()
                .filter(|event| event.time > last.time + 1e-6);
            assert_eq!(late.count(), 0, "{i}, {kind}: {:?}", motion.events());
            let carried = motion.last().memory[0];
            assert_abs_diff_eq!(carried, last.state.memory[0], epsilon = 1e-12);
            let gradient = [-1.05, -0.6, 0.6, -0.5, -0.5][kind];
            let limit = 0.4 * (0.6 + gradient * motion.last().displacements[0]);
            at_limit += usize::from(carried.abs() > limit * (1.0 - 1e-12));
        }
    }
    println!("{at_limit} at the limit");
    assert!(at_limit > 10);
}

/// A break of a drive that does not act on a slider does not stop it, at any tolerance: its force
/// and its limit are integrated apart, and differ by the errors of both.
#[test]
fn a_break_elsewhere_is_no_event_of_a_slider() {
    let joint = Contact::new(0, even(0.5), 1.0)
        .and_then(|joint| joint.with_tangential_stiffness(10.0))
        .and_then(|joint| joint.on_belt(2.0).with_normal_spring(&[(0, -1.0)], 0.3))
        .unwrap();
    let force = Drive::profile(&[(2.85, 0.0), (10.0, 1.0)]).unwrap();
    let structure = Structure::new(&[1.0, 1.0])
        .and_then(|structure| structure.with_ground_spring(0, 1.0))
        .and_then(|structure| structure.with_contact(joint))
        .and_then(|structure| structure.with_force(1, force))
        .unwrap();
    let start = State::new(&[0.0, 0.0], &[0.5, 0.0]);
    for tolerance in [Integrator::ROUND_OFF, 1e-12, 1e-9, 1e-6, 1e-4] {
        let integrator = Integrator::new().with_tolerance(tolerance).unwrap();
        let motion = integrator.simulate(&structure, start.clone(), 5.0).unwrap();
        let kinds: Vec<EventKind> = motion.events().iter().map(|event| event.kind).collect();
        assert_eq!(
            kinds,
            [EventKind::Release(Direction::Lagging)],
            "{tolerance:e}"
        );
    }
}

/// A slider stops with the rigid contact that holds both its sides, at any tolerance.
#[test]
fn sliders_stop_with_the_contacts_that_hold_them() {
    let law = || Exponential::new(0.4, 0.2, 0.3).unwrap();
    let pairs = [
        [
            Contact::between(0, 1, law(), 3.0),
            Contact::between(0, 1, even(0.4), 0.5),
        ],
        [Contact::new(0, law(), 3.0), Contact::new(0, even(0.4), 0.5)],
    ];
    for pair in pairs {
        let [rigid, elastic] = pair.map(Result::unwrap);
        let elastic = elastic.with_tangential_stiffness(5.0).unwrap();
        let structure = Structure::new(&[1.0, 2.0])
            .and_then(|structure| structure.with_ground_spring(0, 0.1))
            .and_then(|structure| structure.with_ground_spring(1, 0.1))
            .and_then(|structure| structure.with_contact(rigid))
            .and_then(|structure| structure.with_contact(elastic))
            .unwrap();
        let start = State::new(&[0.0, 0.0], &[0.5, 0.0]);
        let mut first = None;
        for tolerance in [Integrator::ROUND_OFF, 1e-12, 1e-11, 1e-10, 1e-9, 1e-7, 1e-5] {
            let integrator = Integrator::new().with_tolerance(tolerance).unwrap();
            let motion = integrator
                .simulate(&structure, start.clone(), 20.0)
                .unwrap();
            let stop = |contact: usize| {
                let events = motion.events();
                let mut own = events
                    .iter()
                    .filter(|event| event.contact().unwrap() == contact);
                let stop = own.find(|event| event.kind == EventKind::Stick);
                stop.unwrap().time
            };
            let exact = *first.get_or_insert(stop(0));
            // The errors of all steps before, divided by the deceleration at the stop.
            for time in [stop(0), stop(1)] {
                assert!(
                    (time - exact).abs() <= 100.0 * tolerance,
                    "{tolerance:e}: {time}"
                );
            }
        }
    }
}

/// Three masses with these contacts; K by rows, C by its diagonal.
fn three_masses(
    masses: [f64; 3],
    stiffness: &[f64; 9],
    damping: [f64; 3],
    contacts: [Contact; 3],
) -> Structure {
    let damping = DMatrix::from_diagonal(&DVector::from_row_slice(&damping));
    let structure = Structure::new(&masses)
        .and_then(|structure| structure.with_stiffness(DMatrix::from_row_slice(3, 3, stiffness)))
        .and_then(|structure| structure.with_damping(damping));
    let with_contact = |structure: Structure, contact| structure.with_contact(contact);
    contacts
        .into_iter()
        .try_fold(structure.unwrap(), with_contact)
        .unwrap()
}

/// A rigid contact that is released beside a slider at its limit, on the same two masses: rounding
/// of the force is no distance from the limit.
#[test]
fn a_slider_held_at_its_limit_is_released_with_its_holder() {
    let stiffness = [
        1.9158405058072625,
        -1.596678084769775,
        0.0,
        -1.596678084769775,
        2.768145355743032,
        -0.17022985088942297,
        0.0,
        -0.17022985088942297,
        1.6808540255535818,
    ];
    let damping = [
        0.04366652240181486,
        0.01042215565688992,
        0.03380512367949702,
    ];
    let law = |a, b, c| Exponential::new(a, b, c).unwrap();
    let holder = law(0.4132656755642574, 0.2895548477248733, 0.1662644320868514);
    let holder = Contact::between(0, 1, holder, 1.8113406186404621).unwrap();
    let other = law(0.3297513935984516, 0.3078386924671961, 0.22593420356619381);
    let other = Contact::new(1, other, 3.2526925072141215).unwrap();
    let slider = even(0.34208079315993467);
    let slider = Contact::between(0, 1, slider, 0.316666460838668)
        .and_then(|slider| slider.with_tangential_stiffness(1.6015094389488542))
        .unwrap();
    let masses = [0.3002754503385648, 2.6912855534323405, 1.8554886585844865];
    let contacts = [
        holder.on_belt(-0.390625),
        other.on_belt(-0.03125),
        slider.on_belt(-0.390625),
    ];
    let structure = three_masses(masses, &stiffness, damping, contacts);
    let start = State::new(
        &[
            0.10085934734081081,
            -0.04327601674367221,
            -0.3426413581396299,
        ],
        &[
            -0.0900608584257383,
            -0.8627127752195352,
            -0.8534401161638245,
        ],
    );
    for tolerance in [Integrator::ROUND_OFF, 1e-12, 1e-9] {
        let integrator = Integrator::new().with_tolerance(tolerance).unwrap();
        let motion = integrator.simulate(&structure, start.clone(), 6.0).unwrap();
        assert!(motion.steps().len() < 100, "{tolerance:e}");
        let late = motion.events().iter().filter(|event| event.time > 4.3);
        let releases = late.filter(|event| matches!(event.kind, EventKind::Release(_)));
        let times: Vec<_> = releases
            .map(|event| (event.contact().unwrap(), event.time))
            .collect();
        let [(0, time), (2, follows), ..] = times[..] else {
            panic!("{tolerance:e}: {times:?}");
        };
        // The force leaves its limit like the cube of the time: at a root of rounding.
        assert!(
            (time - 4.368790592).abs() < 1e-5 && (follows - time).abs() < 1e-4,
            "{times:?}"
        );
    }
}

/// A rigid contact that is released beside a slider at its limit, against the slider: the force
/// leaves its limit inwards, like the cube of the time, below a rate that is rounding.
#[test]
fn a_slider_at_its_limit_follows_a_release_away_from_it() {
    let stiffness = [
        0.251479039587716,
        -0.13454860141031622,
        0.0,
        -0.13454860141031622,
        2.971490888156166,
        -1.721381068830274,
        0.0,
        -1.721381068830274,
        2.33617803613515,
    ];
    let damping = [
        0.09534328712801023,
        0.010516933183188493,
        0.0372234831951358,
    ];
    let [law, other] = [
        (0.2517837611277179, 0.20629491420095078, 0.08938463133025852),
        (0.2619347185088628, 0.17980208304910145, 0.27844063109876555),
    ]
    .map(|(a, b, c)| Exponential::new(a, b, c).unwrap());
    let holder = Contact::between(0, 1, law, 2.0369043293876534).unwrap();
    let other = Contact::new(1, other, 3.421100214505022).unwrap();
    let tangential = 12.753911310667279;
    let slider = Contact::along(
        &[(0, 0.5), (1, -0.5)],
        even(0.46401581208136344),
        0.24350193840412676,
    )
    .and_then(|slider| slider.with_tangential_stiffness(tangential))
    .unwrap();
    let masses = [1.1127855827847113, 1.0865701672297055, 1.0642399331322963];
    let contacts = [holder, other.on_belt(0.265625), slider];
    let structure = three_masses(masses, &stiffness, damping, contacts);
    let start = State::new(
        &[
            0.3076160454771374,
            -0.12487132978025606,
            0.12200027081020837,
        ],
        &[0.7042202501052828, -0.27554694673495583, 0.9231543582271],
    );
    for tolerance in [Integrator::ROUND_OFF, 1e-12, 1e-9] {
        let integrator = Integrator::new().with_tolerance(tolerance).unwrap();
        let motion = integrator.simulate(&structure, start.clone(), 4.5).unwrap();
        assert!(motion.steps().len() < 100, "{tolerance:e}");
        let late = motion.events().iter().filter(|event| event.time > 4.0);
        let [&release] = exactly(&late.collect::<Vec<_>>());
        assert_eq!(release.contact().unwrap(), 0, "{tolerance:e}");
        assert_eq!(release.kind, EventKind::Release(Direction::Lagging));
        assert!(
            (release.time - 4.0350067371).abs() < 1e-8,
            "{}",
            release.time
        );
        let gap = |state: &State| state.displacements[0] - state.displacements[1];
        let moved = gap(&motion.last()) - gap(&release.state);
        let limit = 0.46401581208136344 * 0.24350193840412676;
        let expected = limit + tangential * 0.5 * moved;
        let carried = motion.last().memory[0];
        assert!(
            moved < -1e-4 && (carried - expected).abs() < 1e-9,
            "{carried} {expected}"
        );
    }
}

/// Rest lasts as long as asked.
#[test]
fn rest_lasts_for_any_duration() {
    let contact = Contact::new(0, Coulomb::new(0.3, 0.2).unwrap(), 1.0).unwrap();
    let structure = one_mass([1.0, 0.0, 0.0], 0.0, contact).unwrap();
    for duration in [1e10, 1e102, 1e103, 1e200, f64::MAX] {
        let motion = structure
            .simulate(State::new(&[0.1], &[0.0]), duration)
            .unwrap();
        assert_eq!(motion.last(), State::new(&[0.1], &[0.0]), "{duration:e}");
    }
    let free = Structure::new(&[1.0]).unwrap();
    let motion = free.simulate(State::new(&[0.1], &[2.0]), 1e150).unwrap();
    assert_eq!(motion.last(), State::new(&[2e150], &[2.0]));
}
