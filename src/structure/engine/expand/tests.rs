use nalgebra::DMatrix;

use super::super::Engine;
use super::super::coordinate_series::ALL;
use super::{
    Model, Series, Situation, StepMode, all_of, expand, shared_order, slips_alone, spring_order,
    start,
};
use crate::clock::Clock;
use crate::drive::Drive;
use crate::force::{Backlash, ForceField, Pendulum, PolynomialSpring, VanDerPol};
use crate::friction::memory::{Dahl, Dwell, LuGre};
use crate::friction::{AnyLaw, Coulomb, Exponential, Polynomial, Rational, Stribeck, Tabulated};
use crate::scalar::Scalar;
use crate::series::PowerSeries;
use crate::state::structure::State;
use crate::structure::{Contact, ForceElement, Stop, Structure};

fn law(number: usize) -> AnyLaw {
    match number % 6 {
        0 => Exponential::new(0.4, 0.25, 0.5).unwrap().into(),
        1 => Polynomial::new(0.4, 0.25, 1.5).unwrap().into(),
        2 => Coulomb::new(0.4, 0.3).unwrap().into(),
        3 => Rational::new(0.4, 1.0).unwrap().into(),
        4 => Stribeck::new(0.5, 0.3, 0.4, 2).unwrap().into(),
        _ => {
            let points = [(0.0, 0.4), (0.7, 0.2), (1.5, 0.3)];
            Tabulated::new(points).unwrap().into()
        }
    }
}

/// Masses on belts, every sixth without one, each sprung and damped against neighbours near and
/// far. Those named are fast; others have the velocity of their belt, and stick. If they are driven
/// then some by forces, and some by belts, that vary.
fn structure(n: usize, is_driven: bool, is_fast: impl Fn(usize) -> bool) -> (Structure, State) {
    let masses: Vec<f64> = (0..n).map(|i| 1.0 + 0.25 * (i % 3) as f64).collect();
    let mut structure = Structure::new(&masses).unwrap();
    let mut velocities = vec![0.0; n];
    for i in 0..n {
        let ground = structure.with_ground_spring(i, 1.0 + 0.1 * i as f64);
        structure = ground.unwrap().with_ground_damper(i, 0.05).unwrap();
        for j in [i + 1, i + 3].into_iter().filter(|&j| j < n) {
            let springs = structure.with_spring(i, j, 0.3).unwrap();
            structure = springs.with_damper(i, j, 0.02).unwrap();
        }
        if is_driven && i % 3 == 1 {
            let force = Drive::sine(0.5, 1.3).unwrap();
            structure = structure.with_force(i, force).unwrap();
        }
        let belt = 0.3 + 0.05 * i as f64;
        velocities[i] = belt;
        if is_fast(i) {
            velocities[i] += [0.6, -0.8][i % 2];
        }
        if n < 6 || i % 6 != 5 {
            let mut surface = Drive::constant(belt);
            if is_driven && i % 4 == 1 {
                surface = Drive::sine(0.1, 2.0).unwrap().with_constant(belt).unwrap();
            }
            let contact = Contact::new(i, law(i), 4.0).unwrap().on_belt(surface);
            structure = structure.with_contact(contact).unwrap();
        }
    }
    let displacements: Vec<f64> = (0..n).map(|i| 0.2 * (1.7 * i as f64).sin()).collect();
    (structure, State::new(&displacements, &velocities))
}

/// Largest difference of two series in a step of length h, in parts of the largest term of either.
fn difference(h: f64, a: impl Fn(usize) -> f64, b: impl Fn(usize) -> f64, orders: usize) -> f64 {
    let (mut difference, mut size) = (0.0_f64, f64::MIN_POSITIVE);
    for k in 0..orders {
        let [a, b] = [a(k), b(k)].map(|c| c * h.powi(k as i32));
        difference = difference.max((a - b).abs());
        size = size.max(a.abs()).max(b.abs());
    }
    difference / size
}

/// Asserts that series agree in a step of length h.
fn assert_agree(h: f64, found: &Series, expected: &Series) {
    let assert_close = |of: &dyn Fn(&Series, usize) -> f64, orders: usize, name: &str| {
        let difference = difference(h, |k| of(found, k), |k| of(expected, k), orders);
        assert!(difference < 1e-14, "{name}: {difference}");
    };
    for i in 0..found.coordinates.len() {
        let velocity = |of: &Series, k: usize| of.coordinates[i].motion.velocity(k);
        assert_close(&velocity, ALL + 1, "v");
        assert_close(&|of, k| of.coordinates[i].force[k], ALL, "force");
    }
    for c in 0..found.contacts.len() {
        if found.contacts[c].mode == StepMode::Stick {
            assert_close(&|of, k| of.contacts[c].carried[k], ALL, "carried");
        }
        if found.contacts[c].mode == StepMode::Slip {
            assert_close(&|of, k| of.contacts[c].speeds[k], ALL + 1, "y");
            assert_close(&|of, k| of.contacts[c].friction[k], ALL, "friction");
        }
        if found.contacts[c].load_varies {
            assert_close(&|of, k| of.contacts[c].load[k], ALL + 1, "N");
            assert_close(&|of, k| of.contacts[c].bounds[0][k], ALL + 1, "bound");
        }
        for j in 0..found.contacts[c].memories.len() {
            assert_close(&|of, k| of.contacts[c].memories[j][k], ALL + 1, "z");
        }
    }
    for e in 0..found.elements.len() {
        for i in 0..found.elements[e].positions.len() {
            assert_close(&|of, k| of.elements[e].positions[i][k], ALL, "x");
            assert_close(
                &|of, k| of.elements[e].velocities[i][k],
                ALL,
                "y of an element",
            );
            if found.elements[e].acts {
                assert_close(&|of, k| of.elements[e].forces[i][k], ALL, "F");
            }
        }
    }
}

fn expand_generally(model: &Model<'_>, situation: &Situation, series: &mut Series) {
    for of in &mut series.contacts {
        // Nothing of another way remains.
        (of.speeds, of.carried) = (PowerSeries::ZERO, PowerSeries::ZERO);
    }
    start(model, situation, series);
    for k in 0..ALL {
        if k > 0 {
            spring_order(model, series, k);
        }
        all_of(model, series, k, 0..model.len());
        shared_order(model, situation, series, k, false);
    }
}

#[test]
fn simple_motions_have_the_series_of_the_general_way() {
    let (mut slipping_alone, mut driven_alone) = (0, 0);
    for n in [1, 2, 3, 4, 5, 9, 16, 17, 40] {
        for fast in 0..n {
            for [others, is_driven] in [[false, false], [true, false], [false, true], [true, true]]
            {
                let is_fast = |i: usize| i == fast || others && i % 3 != fast % 3;
                let (structure, start_state) = structure(n, is_driven, is_fast);
                let model = structure.model();
                let clock = Clock::at(0.0);
                let (engine, _) = Engine::start(model, f64::EPSILON, clock, &start_state).unwrap();
                let alone = slips_alone(&engine.model, &engine.series);
                slipping_alone += usize::from(alone.is_some());
                let is_driven = alone.is_some_and(|[i, _]| engine.model.is_driven[i]);
                driven_alone += usize::from(is_driven);
                let mut general = engine.series.clone();
                expand_generally(&engine.model, &engine.situation, &mut general);
                assert_agree(0.3, &engine.series, &general);
            }
        }
    }
    assert!(slipping_alone > 10, "{slipping_alone}");
    assert!(driven_alone > 2, "{driven_alone}");
}

/// LuGre's bristles, Dahl's, a dwell clock, and none, in turn.
fn contact_with_memory(i: usize) -> Contact {
    let law = Exponential::new(0.4, 0.25, 0.5).unwrap();
    let contact = match i % 4 {
        0 => Contact::new(i, LuGre::new(law, 20.0 + i as f64, 0.5, 0.02).unwrap(), 4.0),
        1 => Contact::new(i, Dahl::new(0.4, 30.0).unwrap(), 4.0),
        2 => Contact::new(i, Dwell::exponential(law, 0.6, 1.0).unwrap(), 4.0),
        _ => Contact::new(i, law, 4.0),
    };
    contact.unwrap().on_belt(0.3 + 0.05 * i as f64)
}

#[test]
fn memories_have_the_series_of_the_general_way() {
    for n in [1, 2, 3, 4, 5, 9, 17] {
        for slow in [None, Some(0), Some(1), Some(4)] {
            let mut structure = Structure::new(&vec![1.0; n]).unwrap();
            for i in 0..n {
                let ground = structure.with_ground_spring(i, 1.0 + 0.1 * i as f64);
                structure = ground
                    .unwrap()
                    .with_contact(contact_with_memory(i))
                    .unwrap();
                if i > 0 {
                    structure = structure.with_spring(i - 1, i, 0.3).unwrap();
                }
            }
            let velocities: Vec<f64> = (0..n).map(|i| [1.5, -0.7][i % 2]).collect();
            let state = State::new(&vec![0.2; n], &velocities);
            let (mut engine, _) =
                Engine::start(structure.model(), f64::EPSILON, Clock::at(0.0), &state).unwrap();
            let mut general = engine.series.clone();
            let Engine {
                model,
                situation,
                series,
                ..
            } = &mut engine;
            // Passes to a slow manifold.
            if let Some(c) = slow.filter(|&c| c < n) {
                for series in [&mut *series, &mut general] {
                    series.contacts[c].relaxation = 40.0;
                    series.contacts[c].hold_memory(&situation.contacts[c].memory);
                }
            }
            for _ in 0..4 {
                expand(model, situation, series, ALL).unwrap();
                expand_generally(model, situation, &mut general);
                assert_agree(0.02, series, &general);
            }
        }
    }
}

/// Masses coupled by springs and by their mass matrix, on belts or on each other, some driven; all
/// contacts slip.
#[test]
fn shared_contacts_have_the_series_of_the_general_way() {
    let mut compared = 0;
    for n in [2, 3, 4, 5, 8, 9, 17] {
        for [full_mass, between, is_driven] in [
            [true, false, false],
            [false, true, false],
            [true, true, true],
            [false, true, true],
        ] {
            let mass = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
                0 => 1.0 + 0.1 * i as f64,
                1 if full_mass && i.min(j) % 3 < 2 => 0.2,
                _ => 0.0,
            });
            let mut structure = Structure::with_mass_matrix(mass).unwrap();
            for i in 0..n {
                structure = structure
                    .with_ground_spring(i, 1.0 + 0.1 * i as f64)
                    .unwrap();
                if i > 0 {
                    structure = structure.with_spring(i - 1, i, 0.3).unwrap();
                    structure = structure.with_damper(i - 1, i, 0.02).unwrap();
                }
                if is_driven && i % 3 == 1 {
                    structure = structure
                        .with_force(i, Drive::sine(0.5, 1.3).unwrap())
                        .unwrap();
                }
                let contact = if between && i % 2 == 1 {
                    Contact::between(i, i - 1, law(i), 0.7).unwrap()
                } else {
                    let surface = Drive::sine(if is_driven { 0.1 } else { 0.0 }, 2.0).unwrap();
                    contact_with_memory(i).on_belt(surface.with_constant(0.3).unwrap())
                };
                structure = structure.with_contact(contact).unwrap();
            }
            let velocities: Vec<f64> = (0..n).map(|i| [1.5, -0.7][i % 2]).collect();
            let state = State::new(&vec![0.2; n], &velocities);
            let clock = Clock::at(0.0);
            let (engine, _) =
                Engine::start(structure.model(), f64::EPSILON, clock, &state).unwrap();
            let is_shared = |c: usize| engine.model.is_shared(c);
            compared += (0..n).filter(|&c| is_shared(c)).count();
            let mut general = engine.series.clone();
            expand_generally(&engine.model, &engine.situation, &mut general);
            assert_agree(0.02, &engine.series, &general);
        }
    }
    assert!(compared > 100, "{compared}");
}

/// Masses joined by elastic contacts and by springs, some on rigid contacts, some coupled by their
/// mass matrix, some pressed by normal springs or by loads that vary, in forced motions in which
/// sliders start and stop.
#[test]
fn elastic_contacts_have_the_series_of_the_general_way() {
    let [mut at_rest, mut slipping, mut yielding, mut open] = [0; 4];
    let ways = [
        [false, false, false],
        [true, false, false],
        [false, true, false],
        [false, false, true],
        [true, false, true],
        [false, true, true],
    ];
    for n in [1, 2, 3, 4, 5, 8, 9] {
        for [full_mass, with_rigid, is_pressed] in ways {
            let mass = DMatrix::from_fn(n, n, |i, j| match i.abs_diff(j) {
                0 => 1.0 + 0.1 * i as f64,
                1 if full_mass => 0.2,
                _ => 0.0,
            });
            let mut structure = Structure::with_mass_matrix(mass).unwrap();
            for i in 0..n {
                let force = Drive::sine(1.0 + 0.3 * i as f64, 1.3).unwrap();
                let mut load = Drive::constant(1.0);
                if is_pressed && i % 4 == 1 {
                    load = Drive::sine(0.5, 0.9).unwrap().with_constant(1.0).unwrap();
                }
                let joint = if i % 3 == 2 {
                    Contact::between(i, i - 1, Coulomb::new(0.4, 0.4).unwrap(), load)
                } else {
                    Contact::new(i, Coulomb::new(0.5, 0.5).unwrap(), load)
                };
                let into: Vec<_> = [(i, 0.4), (i + 1, -0.6)].into_iter().take(n - i).collect();
                let joint = match is_pressed && i % 2 == 0 {
                    true => joint.and_then(|joint| joint.with_normal_spring(&into, 1.5)),
                    false => joint,
                };
                let joint = joint
                    .and_then(|joint| joint.with_tangential_stiffness(3.0 + i as f64))
                    .unwrap()
                    .on_belt(Drive::sine(if i % 2 == 1 { 0.2 } else { 0.0 }, 2.0).unwrap());
                structure = structure
                    .with_ground_spring(i, 1.0 + 0.1 * i as f64)
                    .and_then(|structure| structure.with_force(i, force))
                    .and_then(|structure| structure.with_contact(joint))
                    .unwrap();
                if i > 0 {
                    structure = structure.with_spring(i - 1, i, 0.3).unwrap();
                }
                if with_rigid && i % 2 == 0 {
                    let contact = Contact::new(i, law(i), 0.3).unwrap().on_belt(0.1);
                    structure = structure.with_contact(contact).unwrap();
                }
            }
            let (model, clock) = (structure.model(), Clock::at(0.0));
            let state = State::at_rest(n);
            let (mut engine, _) = Engine::start(model, f64::EPSILON, clock, &state).unwrap();
            assert!(engine.series.groups.is_some());
            for _ in 0..60 {
                engine.step().unwrap();
                for (c, of) in engine.series.contacts.iter().enumerate() {
                    let is_elastic = engine.model.contacts[c].is_elastic();
                    at_rest += usize::from(is_elastic && of.mode == StepMode::Stick);
                    let slips = is_elastic && of.mode == StepMode::Slip;
                    slipping += usize::from(slips);
                    yielding += usize::from(slips && of.load_varies);
                    open += usize::from(is_elastic && of.mode == StepMode::Open);
                }
                let mut general = engine.series.clone();
                expand_generally(&engine.model, &engine.situation, &mut general);
                assert_agree(0.02, &engine.series, &general);
            }
        }
    }
    println!("{at_rest} {slipping} {yielding} {open}");
    assert!(at_rest > 1000 && slipping > 1000 && yielding > 1000 && open > 100);
}

/// Forces of the potential x²y²/2, and a damper.
struct Well;

impl ForceField for Well {
    type Coordinates<S: Scalar> = [S; 2];

    fn forces<S: Scalar>(&self, [x, y]: [S; 2], [u, _]: [S; 2]) -> [S; 2] {
        [x * y.square() + u * 0.05, y * x.square()]
    }
}

/// Masses on belts with force elements to the ground and between neighbours, along several
/// directions, and stops that open and close.
#[test]
fn force_elements_have_the_series_of_the_general_way() {
    let [mut pushed, mut closed] = [0; 2];
    for n in [1, 2, 3, 5, 9] {
        for with_stops in [false, true] {
            let (mut structure, start_state) = structure(n, true, |i| i % 2 == 0);
            for i in 0..n {
                let near = if i > 0 { i - 1 } else { n - 1 };
                let element = match i % 5 {
                    0 => ForceElement::new(i, PolynomialSpring::new(&[0.3, 0.2, 0.5]).unwrap()),
                    1 => ForceElement::between(i, near, Pendulum::new(0.5, 1.0).unwrap()),
                    2 => ForceElement::new(i, Backlash::new(1.5, 0.1).unwrap()),
                    3 => ForceElement::field(&[&[(i, 1.0)], &[(near, 0.7), (i, -0.2)]], Well),
                    _ => ForceElement::new(i, VanDerPol::new(0.4, 0.3).unwrap()),
                };
                structure = structure.with_element(element.unwrap()).unwrap();
                if with_stops && i % 2 == 0 {
                    let stop = Stop::above(i, 0.2, 0.0).unwrap();
                    let stop = stop.with_contact_stiffness(3.0, 0.1).unwrap();
                    structure = structure.with_stop(stop).unwrap();
                }
            }
            let (model, clock) = (structure.model(), Clock::at(0.0));
            let (mut engine, _) = Engine::start(model, f64::EPSILON, clock, &start_state).unwrap();
            for _ in 0..60 {
                engine.step().unwrap();
                pushed += usize::from(engine.series.is_pushed());
                let stops = &engine.series.elements[engine.model.first_stop()..];
                closed += usize::from(stops.iter().any(|of| of.acts));
                let mut general = engine.series.clone();
                expand_generally(&engine.model, &engine.situation, &mut general);
                assert_agree(0.02, &engine.series, &general);
            }
        }
    }
    println!("{pushed} {closed}");
    assert!(pushed > 400 && closed > 30, "{pushed} {closed}");
}

/// A coordinate that slips alone beside others at rest, under each kind of element, factors that
/// vary, a stop and drives.
#[test]
fn elements_of_a_coordinate_that_slips_alone_have_the_series_of_the_general_way() {
    let [mut alone, mut closed] = [0; 2];
    for n in 1..5 {
        for case in 0..10 {
            let (is_driven, kind) = (case < 5, case % 5);
            let (mut structure, start_state) = structure(n, is_driven, |i| i == 0);
            let along: &[(usize, f64)] = &[(0, 0.7)];
            let element = match kind {
                0 => ForceElement::new(0, PolynomialSpring::new(&[0.3, 0.2, 0.5]).unwrap()),
                1 => ForceElement::along(along, Pendulum::new(0.5, 1.0).unwrap()),
                2 => ForceElement::new(0, Backlash::new(1.5, 0.1).unwrap()),
                3 => ForceElement::field(&[&[(0, 1.0)], along], Well),
                _ => ForceElement::new(0, VanDerPol::new(0.4, 0.3).unwrap()),
            };
            let mut element = element.unwrap();
            if is_driven {
                let factor = Drive::sine(0.5, 1.7).unwrap().with_constant(1.0).unwrap();
                element = element.with_factor(factor).unwrap();
            }
            let stop = Stop::above(0, 0.2, 0.0).unwrap();
            let stop = stop.with_contact_stiffness(3.0, 0.1).unwrap();
            structure = structure.with_element(element).unwrap();
            structure = structure.with_stop(stop).unwrap();
            let (model, clock) = (structure.model(), Clock::at(0.0));
            let (mut engine, _) = Engine::start(model, f64::EPSILON, clock, &start_state).unwrap();
            for _ in 0..40 {
                engine.step().unwrap();
                let is_alone = slips_alone(&engine.model, &engine.series).is_some();
                alone += usize::from(is_alone);
                let stop = &engine.series.elements[engine.model.first_stop()];
                closed += usize::from(is_alone && stop.acts);
                let mut general = engine.series.clone();
                expand_generally(&engine.model, &engine.situation, &mut general);
                assert_agree(0.02, &engine.series, &general);
            }
        }
    }
    println!("{alone} {closed}");
    assert!(alone > 400 && closed > 30, "{alone} {closed}");
}
