//! Stops with spring and damper: closed forms, identities, what is refused.

use approx::assert_abs_diff_eq;
use stick_slip::structure::{NotSliding, State};
use stick_slip::{
    Backlash, Contact, Coulomb, Drive, Element, Error, Event, EventKind, FirstOrder, ForceElement,
    Integrator, PolynomialSpring, Segment, Stop, Structure, Trajectory,
};

use crate::common::{Random, assert_message, count, element_keys as keys, larger, message};
use crate::plain::Plain;

fn stop(made: Result<Stop, Error>, stiffness: f64, damping: f64) -> Stop {
    made.and_then(|stop| stop.with_contact_stiffness(stiffness, damping))
        .unwrap()
}

fn free(stop: Stop) -> Structure {
    let mass = Structure::new(&[1.0]).unwrap();
    mass.with_stop(stop).unwrap()
}

/// Rebounds of a free mass, to 25 digits: theory of the damped oscillator.
#[test]
fn a_free_mass_rebounds_as_the_formulas_say() {
    let stiffness = 400.0_f64;
    for (zeta, adhesive, restitution) in [
        (0.3, false, 0.4509754528931284822070546),
        (1.0, false, (-2.0_f64).exp()),
        (0.3, true, 0.3723261049265864049046985),
        (0.0, false, 1.0),
    ] {
        let damping = 2.0 * zeta * stiffness.sqrt();
        let above = stop(Stop::above(0, 0.5, 0.0), stiffness, damping);
        let above = if adhesive { above.adhesive() } else { above };
        let motion = free(above)
            .simulate(State::new(&[0.0], &[2.0]), 2.0)
            .unwrap();
        let [close, open] = motion.events() else {
            panic!("{motion:?}")
        };
        let both = [
            (Element::Stop(0), EventKind::Close),
            (Element::Stop(0), EventKind::Open),
        ];
        assert_eq!(keys(&motion), both);
        assert_eq!(close.time, 0.25);
        assert_abs_diff_eq!(
            -motion.last().velocities[0] / 2.0,
            restitution,
            epsilon = 2e-14
        );
        let omega = (stiffness * (1.0 - zeta * zeta)).sqrt();
        let lasts = match (zeta, adhesive) {
            (1.0, _) => 2.0 / stiffness.sqrt(),
            (_, true) => std::f64::consts::PI / omega,
            _ => 2.0 * f64::acos(zeta) / omega,
        };
        assert_abs_diff_eq!(open.time - close.time, lasts, epsilon = 1e-14);
        // An adhesive stop opens at δ = 0, and so does one without damper.
        let depth = open.state.displacements[0] - 0.5;
        let is_late = adhesive || zeta == 0.0;
        assert_eq!(depth.abs() < 1e-14, is_late, "{depth}");
    }
    // Strongly damped: e = exp(−2ζ acosh ζ/√(ζ² − 1)).
    let zeta = 2.5_f64;
    let strong = stop(Stop::below(0, -0.5, 1.0), 100.0, 20.0 * zeta);
    let motion = free(strong)
        .simulate(State::new(&[0.0], &[-1.0]), 2.0)
        .unwrap();
    let expected = (-2.0 * zeta * zeta.acosh() / (zeta * zeta - 1.0).sqrt()).exp();
    assert_abs_diff_eq!(motion.last().velocities[0], expected, epsilon = 1e-14);
}

/// A shaken mass on a spring with friction, between two stops along a direction.
fn shaken(sign: f64, stops: impl FnOnce(Structure) -> Structure) -> Structure {
    let ground = Contact::new(0, Coulomb::new(0.3, 0.2).unwrap(), 0.4).unwrap();
    let structure = Structure::new(&[1.0, 2.0])
        .and_then(|s| s.with_ground_spring(0, 0.5)?.with_ground_spring(1, 3.0))
        .and_then(|s| s.with_spring(0, 1, 0.7)?.with_ground_damper(1, 0.1))
        .and_then(|s| {
            s.with_force(0, Drive::sine(2.0 * sign, 1.3)?)?
                .with_contact(ground)
        })
        .unwrap();
    stops(structure)
}

/// Both stops of a play.
fn both([above, below]: [f64; 2], stiffness: f64, damping: f64) -> [Stop; 2] {
    [
        stop(Stop::above(0, above, 0.0), stiffness, damping),
        stop(Stop::below(0, below, 0.0), stiffness, damping),
    ]
}

fn of_contacts(motion: &Trajectory<State>) -> Vec<&Event<State>> {
    let events = motion.events().iter();
    events.filter(|event| event.contact().is_some()).collect()
}

#[test]
fn two_stops_without_damper_are_backlash() {
    let [above, below] = both([0.4, -0.4], 80.0, 0.0);
    let stops = shaken(1.0, |s| {
        s.with_stop(above).unwrap().with_stop(below).unwrap()
    });
    let play = shaken(1.0, |s| {
        let play = Backlash::new(80.0, 0.4).unwrap();
        s.with_element(ForceElement::new(0, play).unwrap()).unwrap()
    });
    let [one, other] = [stops, play].map(|s| s.simulate(State::at_rest(2), 20.0).unwrap());
    let [events, expected] = [&one, &other].map(of_contacts);
    assert!(one.events().len() > events.len() + 10 && events.len() == expected.len());
    for (a, b) in events.iter().zip(&expected) {
        assert_eq!((a.element, a.kind), (b.element, b.kind));
        assert_abs_diff_eq!(a.time, b.time, epsilon = 1e-12);
    }
    for (a, b) in one.last().velocities.iter().zip(other.last().velocities) {
        assert_abs_diff_eq!(*a, b, epsilon = 1e-11);
    }
}

/// A mirrored structure has the mirrored motion, to the bit; stops in another order, and in other
/// units, the same.
#[test]
fn mirrored_permuted_and_in_other_units() {
    let at = |gaps: [f64; 2]| both(gaps, 80.0, 3.0);
    let run = |structure: Structure| structure.simulate(State::at_rest(2), 20.0).unwrap();
    let [above, below] = at([0.4, -0.3]);
    let motion = run(shaken(1.0, |s| {
        s.with_stop(above.clone())
            .unwrap()
            .with_stop(below.clone())
            .unwrap()
    }));
    let [mirrored_below, mirrored_above] = at([0.3, -0.4]);
    let mirrored = run(shaken(-1.0, |s| {
        let first = s.with_stop(mirrored_above).unwrap();
        first.with_stop(mirrored_below).unwrap()
    }));
    let permuted = run(shaken(1.0, |s| {
        s.with_stop(below).unwrap().with_stop(above).unwrap()
    }));
    assert!(motion.events().len() > 20);
    assert_eq!(motion.events().len(), mirrored.events().len());
    for (a, b) in motion.events().iter().zip(mirrored.events()) {
        assert_eq!((a.time, a.element), (b.time, b.element));
        assert_eq!(a.state.velocities[1], -b.state.velocities[1]);
    }
    let other = |element: Element| match element {
        Element::Stop(k) => Element::Stop(1 - k),
        other => other,
    };
    for (a, b) in motion.events().iter().zip(permuted.events()) {
        assert_eq!((a.element, a.kind), (other(b.element), b.kind));
        assert_abs_diff_eq!(a.time, b.time, epsilon = 1e-12);
    }
    // Lengths in units of 2⁻⁴, times of 2⁻²: velocities of 2⁻².
    let scaled = |gap: f64| 16.0 * gap;
    let (k, c) = (80.0 / 16.0, 3.0 / 4.0);
    let law = Coulomb::new(0.3, 0.2).unwrap();
    let units = Structure::new(&[1.0, 2.0])
        .and_then(|s| {
            s.with_ground_spring(0, 0.5 / 16.0)?
                .with_ground_spring(1, 3.0 / 16.0)
        })
        .and_then(|s| {
            s.with_spring(0, 1, 0.7 / 16.0)?
                .with_ground_damper(1, 0.1 / 4.0)
        })
        .and_then(|s| s.with_force(0, Drive::sine(2.0, 1.3 / 4.0)?))
        .and_then(|s| s.with_contact(Contact::new(0, law, 0.4)?))
        .and_then(|s| s.with_stop(stop(Stop::above(0, scaled(0.4), 0.0), k, c)))
        .and_then(|s| s.with_stop(stop(Stop::below(0, scaled(-0.3), 0.0), k, c)))
        .unwrap();
    let units = units.simulate(State::at_rest(2), 80.0).unwrap();
    assert_eq!(keys(&motion), keys(&units));
    for (a, b) in motion.events().iter().zip(units.events()) {
        assert_abs_diff_eq!(4.0 * a.time, b.time, epsilon = 1e-12);
        let [a, b] = [a, b].map(|event| event.state.displacements[0]);
        assert_abs_diff_eq!(16.0 * a, b, epsilon = 1e-12);
    }
}

/// A stop that is never reached changes no bit.
#[test]
fn a_stop_out_of_reach_changes_nothing() {
    let mut random = Random::new(77);
    let mut compared = 0;
    for i in 0..count(40, 400) {
        let plain = match i % 2 {
            0 => Plain::random(&mut random),
            _ => Plain::shared(&mut random, false),
        };
        let start = plain.start(&mut random);
        if i % 2 == 1 && !plain.is_clear(&start) {
            continue;
        }
        let without = plain.structure();
        let far = stop(Stop::above(0, 1e9, 0.0), 50.0, 2.0);
        let with = without.clone().with_stop(far).unwrap();
        let [one, other] = [without, with].map(|structure| {
            let flow = Integrator::new().flow(&structure, start.clone()).unwrap();
            let steps = flow.take(300).map_while(Result::ok);
            // A mass that its belt carries comes there in the end.
            steps
                .take_while(|step| step.end_time() < 1e8)
                .map(|step| (step.end_time(), step.end_state()))
                .collect::<Vec<_>>()
        });
        assert_eq!(one, other, "{i}: {plain:?}\n{start:?}");
        compared += one.len();
    }
    assert!(compared > 1000, "{compared}");
}

/// A random structure with stops.
fn any(random: &mut Random) -> Option<(Structure, State)> {
    let plain = match random.bits().is_multiple_of(2) {
        true => Plain::random(random),
        false => Plain::shared(random, false),
    };
    let plain = plain.with_stops(random);
    let start = plain.start(random);
    plain.is_clear(&start).then(|| (plain.structure(), start))
}

/// The energy balance holds, the dampers of stops turn energy into heat only, and the forces of
/// samples are those of the law.
#[test]
fn energies_and_samples_of_stops() {
    let mut random = Random::new(78);
    let (mut heats, mut pressed) = (0, 0);
    for i in 0..count(60, 600) {
        let Some((structure, start)) = any(&mut random) else {
            continue;
        };
        let Ok(motion) = structure.simulate(start, 10.0) else {
            continue;
        };
        let budget = structure.energy_budget(&motion).unwrap();
        let size = budget.friction_loss.iter().sum::<f64>() + budget.damper_loss + 1.0;
        assert!(budget.defect().abs() < 1e-10 * size, "{i}: {budget:?}");
        for (loss, stop) in budget.stop_loss.iter().zip(structure.stops()) {
            let (_, damping) = stop.contact_stiffness().unwrap();
            assert!(
                *loss >= -1e-14 && (damping > 0.0 || loss.abs() < 1e-12),
                "{i}: {loss}"
            );
            heats += usize::from(*loss > 1e-3);
        }
        for sample in structure.samples(&motion, 0.0371).unwrap() {
            for (force, stop) in sample.stop_forces.iter().zip(structure.stops()) {
                let along =
                    |x: &[f64]| -> f64 { stop.direction().iter().map(|&(j, d)| d * x[j]).sum() };
                let depth = -(stop.gap() + along(&sample.state.displacements));
                let (stiffness, damping) = stop.contact_stiffness().unwrap();
                let pressure = stiffness * depth - damping * along(&sample.state.velocities);
                let expected = match stop.is_adhesive() || pressure > 0.0 {
                    true if depth > 0.0 => pressure,
                    _ => 0.0,
                };
                if depth.abs() > 1e-9 {
                    assert_abs_diff_eq!(*force, expected, epsilon = 1e-10);
                    pressed += usize::from(*force > 0.0);
                }
            }
        }
    }
    assert!(heats > 20 && pressed > 300, "{heats} {pressed}");
}

/// The heat in a stop is the kinetic energy that a free mass loses.
#[test]
fn the_heat_of_a_stop_is_what_a_free_mass_loses() {
    for (stiffness, damping, adhesive) in [
        (400.0_f64, 12.0, false),
        (400.0, 12.0, true),
        (1e8, 3e4, false),
        (400.0, 100.0, false),
        (400.0, 0.0, false),
    ] {
        let above = stop(Stop::above(0, 0.5, 0.0), stiffness, damping);
        let above = if adhesive { above.adhesive() } else { above };
        let mass = free(above);
        let motion = mass.simulate(State::new(&[0.0], &[2.0]), 1.5).unwrap();
        let budget = mass.energy_budget(&motion).unwrap();
        let end = motion.last();
        // The spring has relaxed without a force.
        assert!(end.displacements[0] < 0.5, "{end:?}");
        let lost = 2.0 - 0.5 * end.velocities[0].powi(2);
        // A displacement of 0.5 is rounded: that of its force works over the depth 2/√(k/m).
        let rounding = 1e-13 + f64::EPSILON * stiffness.sqrt();
        assert_abs_diff_eq!(budget.stop_loss[0], lost, epsilon = rounding);
        assert_abs_diff_eq!(budget.defect(), 0.0, epsilon = rounding);
        assert_eq!(damping > 0.0, lost > 0.1, "{lost}");
    }
}

/// Stops stand behind force elements and the laws of first-order states: each keeps its number.
#[test]
fn stops_beside_force_elements_and_first_order_states() {
    let cubic = || PolynomialSpring::new(&[1.0, 0.0, 2.0]).unwrap();
    let state = FirstOrder::lag(0.5)
        .and_then(|state| state.with_displacement(0, 1.0))
        .and_then(|state| state.with_law_of_state(0, PolynomialSpring::new(&[-1.0, 0.0, -2.0])?))
        .and_then(|state| state.with_law(&[(0, 1.0)], cubic()))
        .and_then(|state| state.with_force(0, -0.3))
        .unwrap();
    let make = |stops: &[Stop]| {
        let mut structure = Structure::new(&[1.0])
            .and_then(|s| s.with_force(0, Drive::sine(4.0, 1.3)?))
            .and_then(|s| s.with_element(ForceElement::new(0, cubic())?))
            .and_then(|s| s.with_first_order(state.clone()))
            .unwrap();
        for stop in stops {
            structure = structure.with_stop(stop.clone()).unwrap();
        }
        structure
    };
    let far = stop(Stop::below(0, -9.0, 0.0), 50.0, 2.0);
    let near = stop(Stop::above(0, 0.5, 0.0), 50.0, 2.0);
    let start = State::at_rest(1).with_memory(&[0.2]);
    let run = |structure: &Structure| structure.simulate(start.clone(), 12.0).unwrap();
    let [without, with] = [make(&[]), make(std::slice::from_ref(&far))].map(|s| run(&s));
    assert_eq!(with.events().len(), 0);
    for i in 0..=24 {
        let time = 0.5 * f64::from(i);
        let [a, b] = [&without, &with].map(|motion| motion.state_at(time).unwrap());
        assert_abs_diff_eq!(a.displacements[0], b.displacements[0], epsilon = 1e-13);
        assert_abs_diff_eq!(a.memory[0], b.memory[0], epsilon = 1e-13);
    }
    let both = make(&[far, near]);
    let motion = run(&both);
    let closes = (Element::Stop(1), EventKind::Close);
    assert!(keys(&motion).iter().filter(|key| **key == closes).count() > 2);
    let budget = both.energy_budget(&motion).unwrap();
    assert_eq!((budget.stop_loss.len(), budget.element_work.len()), (2, 1));
    assert!(budget.stop_loss[0] == 0.0 && budget.stop_loss[1] > 0.1);
    assert!(budget.defect().abs() < 1e-12, "{budget:?}");
    for sample in both.samples(&motion, 0.1).unwrap() {
        let q = sample.state.displacements[0];
        let spring = q + 2.0 * q.powi(3);
        assert_abs_diff_eq!(sample.element_forces[0][0], spring, epsilon = 1e-12);
        let driven = 4.0 * (1.3 * sample.time).sin() - 0.3 * sample.state.memory[0];
        let expected = driven - spring - sample.stop_forces[1];
        assert_eq!(sample.stop_forces[0], 0.0);
        assert_abs_diff_eq!(sample.accelerations[0], expected, epsilon = 1e-11);
    }
}

/// Numbers at the ends of their range end in a motion or in an error, in bounded time.
#[test]
fn extreme_stops_end_in_a_motion_or_an_error() {
    let sizes = [5e-324, 1e-300, 1e-9, 1.0, 1e9, 1e300, f64::MAX];
    let integrator = Integrator::new().with_max_steps(2000).unwrap();
    let (mut motions, mut errors) = (0, 0);
    for stiffness in sizes {
        for damping in sizes.into_iter().chain([0.0]) {
            for gap in [0.0, -1.0, 1.0, 1e300, -1e300] {
                for adhesive in [false, true] {
                    let made = stop(Stop::above(0, gap, 0.0), stiffness, damping);
                    let made = if adhesive { made.adhesive() } else { made };
                    let mass = free(made);
                    let start = State::new(&[0.0], &[1.0]);
                    match integrator.simulate(&mass, start, 3.0) {
                        Ok(motion) => {
                            let end = motion.last();
                            assert!(end.displacements[0].is_finite(), "{mass:?}: {end:?}");
                            motions += 1;
                        }
                        Err(error) => {
                            let words = error.to_string();
                            assert!(words.len() > 20, "{mass:?}: {words}");
                            errors += 1;
                        }
                    }
                }
            }
        }
    }
    println!("{motions} motions, {errors} errors");
    assert!(motions > 200 && errors > 0, "{motions} {errors}");
}

/// Elastic contacts, and one with a normal spring that opens: a stop out of reach changes nothing,
/// and two without damper are backlash.
#[test]
fn stops_beside_elastic_contacts() {
    let law = || Coulomb::new(0.3, 0.3).unwrap();
    let make = |add: &dyn Fn(Structure) -> Structure| {
        let slider = Contact::new(1, law(), 0.8).and_then(|c| c.with_tangential_stiffness(30.0));
        let pad = Contact::new(2, law(), 0.5).and_then(|c| c.with_normal_spring(&[(0, 1.0)], 2.0));
        let structure = Structure::new(&[1.0, 2.0, 1.5])
            .and_then(|s| s.with_ground_spring(0, 0.5)?.with_ground_spring(1, 3.0))
            .and_then(|s| s.with_spring(0, 1, 0.7)?.with_spring(1, 2, 1.1))
            .and_then(|s| s.with_force(0, Drive::sine(2.0, 1.3)?))
            .and_then(|s| s.with_contact(slider?)?.with_contact(pad?))
            .unwrap();
        let structure = add(structure);
        let motion = structure.simulate(State::at_rest(3), 15.0).unwrap();
        (structure.energy_budget(&motion).unwrap(), motion)
    };
    let (_, without) = make(&|s| s);
    assert!(without.events().len() > 10);
    let far = stop(Stop::above(0, 1e9, 0.0), 50.0, 2.0);
    let (_, with) = make(&|s| s.with_stop(far.clone()).unwrap());
    assert_eq!(keys(&without), keys(&with));
    for (a, b) in without.events().iter().zip(with.events()) {
        assert_abs_diff_eq!(a.time, b.time, epsilon = 1e-12);
    }
    let add = |gap: f64, damping: f64| {
        move |s: Structure| {
            let [above, below] = both([gap, -gap], 80.0, damping);
            s.with_stop(above).unwrap().with_stop(below).unwrap()
        }
    };
    let (budget, damped) = make(&add(0.4, 3.0));
    assert!(
        budget.defect().abs() < 1e-12 && budget.stop_loss[0] > 0.1,
        "{budget:?}"
    );
    assert!(damped.events().len() > 20);
    let (_, stops) = make(&add(0.4, 0.0));
    let (_, play) = make(&|s| {
        let play = Backlash::new(80.0, 0.4).unwrap();
        s.with_element(ForceElement::new(0, play).unwrap()).unwrap()
    });
    let [events, expected] = [&stops, &play].map(of_contacts);
    assert!(stops.events().len() > events.len() + 4 && events.len() == expected.len());
    for (a, b) in events.iter().zip(&expected) {
        assert_eq!((a.element, a.kind), (b.element, b.kind));
        assert_abs_diff_eq!(a.time, b.time, epsilon = 1e-11);
    }
}

/// A motion continues from any of its states: from its events, from unloaded stops too.
#[test]
fn motions_continue_from_their_states() {
    let mut random = Random::new(79);
    let mut compared = 0;
    for i in 0..count(40, 400) {
        let Some((structure, start)) = any(&mut random) else {
            continue;
        };
        let end = 6.0;
        let Ok(motion) = structure.simulate(start, end) else {
            continue;
        };
        let of_stops = motion
            .events()
            .iter()
            .filter(|event| event.contact().is_none());
        let times: Vec<f64> = of_stops.map(|event| event.time).take(6).collect();
        for (n, &time) in times.iter().enumerate() {
            // At an event, and shortly after: an opened stop may then be unloaded.
            let from = if n % 2 == 0 {
                time
            } else {
                (time + 1e-3).min(end)
            };
            let state = motion.state_at(from).unwrap();
            let again = Integrator::new()
                .with_start_time(from)
                .and_then(|integrator| integrator.simulate(&structure, state, end - from))
                .unwrap();
            let later = |motion: &Trajectory<State>| -> Vec<_> {
                let events = motion.events().iter();
                let events = events.filter(|event| event.time > from + 1e-9);
                events.map(|event| (event.element, event.kind)).collect()
            };
            let (a, b) = (again.last(), motion.last());
            let apart = a.displacements.iter().zip(&b.displacements);
            let apart = apart.map(|(a, b)| (a - b).abs()).fold(0.0, larger);
            // Motions may be sensitive; then they part.
            if apart < 1e-8 {
                assert_eq!(later(&again), later(&motion), "{i} from {from}");
                compared += 1;
            }
            let first = again
                .events()
                .iter()
                .filter(|event| event.contact().is_none());
            let too_early = first.filter(|event| event.time <= from + 1e-12).count();
            assert_eq!(too_early, 0, "{i} from {from}: {structure:?}");
        }
    }
    assert!(compared > 60, "{compared}");
}

/// A stop that just touches at rest, that is pressed from its contact on, and that is pulled away.
#[test]
fn stops_at_rest() {
    for damping in [0.0, 2.0] {
        let mass = |force: Drive| {
            let above = stop(Stop::above(0, 0.0, 0.0), 10.0, damping);
            Structure::new(&[1.0])
                .and_then(|s| s.with_force(0, force)?.with_stop(above))
                .unwrap()
        };
        let rest = mass(Drive::constant(0.0));
        let motion = rest.simulate(State::at_rest(1), 1e6).unwrap();
        assert_eq!(
            (motion.events().len(), motion.last()),
            (0, State::at_rest(1))
        );
        // At rest until t = 1.
        let push = |size: f64| Drive::profile(&[(0.0, 0.0), (1.0, 0.0), (2.0, size)]).unwrap();
        let pressed = mass(push(1.0)).simulate(State::at_rest(1), 1.5).unwrap();
        assert!(keys(&pressed).len() <= 1, "{:?}", keys(&pressed));
        assert!(pressed.last().displacements[0] > 1e-3);
        let pulled = mass(push(-1.0)).simulate(State::at_rest(1), 1.5).unwrap();
        assert_abs_diff_eq!(
            pulled.last().displacements[0],
            -0.125 / 6.0,
            epsilon = 1e-15
        );
    }
}

/// Steady sliding against a closed stop, and exactly at the touch.
#[test]
fn steady_sliding_against_a_stop() {
    let block = |gap: f64| {
        let belt = Contact::new(0, Coulomb::new(0.4, 0.4).unwrap(), 1.0).unwrap();
        Structure::new(&[2.0])
            .and_then(|s| s.with_ground_spring(0, 0.5)?.with_ground_damper(0, 0.2))
            .and_then(|s| s.with_contact(belt.on_belt(1.0)))
            .and_then(|s| s.with_stop(stop(Stop::above(0, gap, 0.0), 4.5, 1.8)))
            .unwrap()
    };
    // 0.4 = 0.5 q + 4.5 (q − 0.3)
    let sliding = block(0.3).steady_sliding().unwrap();
    assert_abs_diff_eq!(sliding.displacements[0], 1.75 / 5.0, epsilon = 1e-15);
    // 2 s² + 2 s + 5 = 0
    assert_abs_diff_eq!(sliding.eigenvalues[0].re, -0.5, epsilon = 1e-14);
    assert_abs_diff_eq!(sliding.eigenvalues[0].im.abs(), 1.5, epsilon = 1e-14);
    let open = block(1.0).steady_sliding().unwrap();
    assert_abs_diff_eq!(open.displacements[0], 0.8, epsilon = 1e-15);
    assert_abs_diff_eq!(open.eigenvalues[0].re, -0.05, epsilon = 1e-14);
    match block(0.8).steady_sliding() {
        Err(Error::NoSteadySliding(NotSliding::AtBreakpoint { element, .. })) => {
            assert_eq!(element, Element::Stop(0));
        }
        other => panic!("{other:?}"),
    }
}

/// A gap of any size between two masses: the first hits the second, which carries its impulse on.
#[test]
fn two_masses_collide() {
    let structure = Structure::new(&[1.0, 1.0])
        .and_then(|s| s.with_stop(stop(Stop::between(0, 1, 0.5, 0.0), 1e6, 0.0)))
        .unwrap();
    let motion = structure
        .simulate(State::new(&[0.0, 0.0], &[1.0, 0.0]), 1.0)
        .unwrap();
    assert_abs_diff_eq!(motion.events()[0].time, 0.5, epsilon = 1e-15);
    assert_abs_diff_eq!(motion.last().velocities[0], 0.0, epsilon = 1e-12);
    assert_abs_diff_eq!(motion.last().velocities[1], 1.0, epsilon = 1e-12);
}

#[test]
fn stops_say_what_they_are() {
    let made = stop(Stop::between(2, 0, 0.5, 0.7), 3.0, 0.25);
    assert_eq!(made.direction(), [(0, 1.0), (2, -1.0)]);
    assert_eq!((made.gap(), made.restitution()), (0.5, 0.7));
    assert_eq!(made.contact_stiffness(), Some((3.0, 0.25)));
    assert!(!made.is_adhesive() && made.clone().adhesive().is_adhesive());
    assert_ne!(made, made.clone().adhesive());
    assert_eq!(Stop::above(1, 2.0, 0.0).unwrap().direction(), [(1, -1.0)]);
    assert_eq!(Stop::below(1, 2.0, 0.0).unwrap().gap(), -2.0);
    assert_eq!(Stop::above(1, 2.0, 0.0).unwrap().contact_stiffness(), None);
    let structure = Structure::new(&[1.0; 3])
        .unwrap()
        .with_stop(made.clone())
        .unwrap();
    assert_eq!(structure.stops(), std::slice::from_ref(&made));
    assert_eq!(structure.frozen(1.0).unwrap(), structure);
    assert!(format!("{made:?}").contains("gap: 0.5"));
}

#[test]
fn bad_stops_are_refused() {
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        message(Stop::above(0, bad, 0.0), &["Stop", "q_max"]);
        message(Stop::below(0, bad, 0.0), &["Stop", "q_min"]);
        message(Stop::between(0, 1, bad, 0.0), &["Stop", "gap"]);
        message(Stop::along(&[(0, bad)], 0.0, 0.0), &["direction"]);
        message(
            Stop::above(0, 1.0, bad),
            &["restitution", "0 ≤ restitution ≤ 1"],
        );
        let made = || Stop::above(0, 1.0, 0.0).unwrap();
        message(made().with_contact_stiffness(bad, 0.0), &["stiffness > 0"]);
        message(made().with_contact_stiffness(1.0, bad), &["damping ≥ 0"]);
    }
    for bad in [-0.1, 1.1] {
        message(
            Stop::above(0, 1.0, bad),
            &["restitution", "0 ≤ restitution ≤ 1"],
        );
    }
    message(Stop::between(1, 1, 1.0, 0.0), &["direction"]);
    message(Stop::along(&[], 1.0, 0.0), &["direction"]);
    let made = Stop::above(0, 1.0, 0.5).unwrap();
    message(
        made.clone().with_contact_stiffness(0.0, 0.0),
        &["stiffness > 0"],
    );
    message(
        made.clone().with_contact_stiffness(1.0, -1.0),
        &["damping ≥ 0"],
    );
    let mass = || Structure::new(&[1.0]).unwrap();
    let error = mass().with_stop(made).unwrap_err();
    assert_eq!(error, Error::RigidStop { stop: 0 });
    assert_message(&error, &["stop 0", "with_contact_stiffness(k, c)"]);
    let far = stop(Stop::above(3, 1.0, 0.0), 1.0, 0.0);
    message(mass().with_stop(far), &["stop 0", "coordinate 3"]);
    // A motion of another structure.
    let motion = mass().simulate(State::at_rest(1), 1.0).unwrap();
    let with = mass()
        .with_stop(stop(Stop::above(0, 1.0, 0.0), 1.0, 0.0))
        .unwrap();
    message(with.energy_budget(&motion), &["stops: 0 given; 1"]);
}

/// An impact costs a few steps, whatever the stiffness: with the flights before and after it.
#[test]
fn the_cost_of_an_impact_does_not_grow_with_the_stiffness() {
    for zeta in [0.0, 0.2, 0.7, 1.0, 3.0] {
        let steps = [1e4, 1e8, 1e12].map(|stiffness: f64| {
            let damping = 2.0 * zeta * stiffness.sqrt();
            let motion = free(stop(Stop::above(0, 1.0, 0.0), stiffness, damping))
                .simulate(State::new(&[0.0], &[1.0]), 2.0)
                .unwrap();
            assert_eq!(motion.events().len(), 2);
            motion.steps().len()
        });
        println!("ζ = {zeta}: {steps:?} steps");
        assert!(steps.iter().all(|count| *count <= 8), "{steps:?}");
    }
    // Pressed and shaken: in proportion to √k.
    let steps = [1e4, 1e6].map(|stiffness: f64| {
        let structure = Structure::new(&[1.0])
            .and_then(|s| s.with_force(0, Drive::sine(0.5, 1.0)?.with_constant(1.0)?))
            .and_then(|s| s.with_stop(stop(Stop::above(0, 0.0, 0.0), stiffness, 0.1)))
            .unwrap();
        let start = State::new(&[1.0 / stiffness], &[0.0]);
        let motion = structure.simulate(start, 10.0).unwrap();
        motion.steps().len()
    });
    println!("pressed: {steps:?} steps");
    let ratio = steps[1] as f64 / steps[0] as f64;
    assert!((5.0..15.0).contains(&ratio), "{steps:?}");
}

/// A stop that is closed stores ½kδ², as the budget of a motion says.
#[test]
fn the_elastic_energy_contains_that_of_stops() {
    let stop = stop(Stop::along(&[(0, -1.0)], 0.5, 0.0), 200.0, 0.0);
    let system = Structure::new(&[2.0]).unwrap();
    let system = system.with_ground_spring(0, 3.0).unwrap();
    let system = system.with_stop(stop).unwrap();
    let energy = |x: f64| system.elastic_energy(0.0, &State::new(&[x], &[0.0]));
    assert_eq!(energy(0.5).unwrap(), 0.375);
    let pressed = energy(0.6).unwrap();
    assert!((pressed - (0.54 + 1.0)).abs() < 1e-14, "{pressed}");
    // Without dampers the energy is constant, before, during and after the impact.
    let motion = system.simulate(State::new(&[0.0], &[4.0]), 2.0).unwrap();
    let mut closed = 0;
    for i in 0..=200 {
        let (time, state) = (0.01 * f64::from(i), motion.state_at(0.01 * f64::from(i)));
        let state = state.unwrap();
        closed += usize::from(state.displacements[0] > 0.5);
        let elastic = system.elastic_energy(time, &state).unwrap();
        let kinetic = system.kinetic_energy(&state).unwrap();
        assert!((elastic + kinetic - 16.0).abs() < 1e-12, "{time}");
    }
    assert!(closed > 10, "{closed}");
}
