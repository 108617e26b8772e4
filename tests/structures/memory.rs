//! Contacts that remember: static friction that rises at rest, and bristles.

use approx::assert_abs_diff_eq;
use serde_json::Value;
use stick_slip::nalgebra::DMatrix;
use stick_slip::structure::State;
use stick_slip::{
    AnyContactLaw, AnyLaw, Contact, ContactLaw, Coulomb, Dahl, Drive, Dwell, Error, EventKind,
    Exponential, FrictionLaw, Integrator, LuGre, Mode, Motion, Rational, Scalar, Segment, Slip,
    Structure, Tabulated,
};

use crate::common::{
    Random, Worst, at_least, exactly, kind, larger, list, memory_stays, number, one_mass, refused,
    text,
};
use crate::reading::{Raised, cases, numbers, remembering};

#[test]
fn motions_have_the_reference_events_and_states() {
    let mut all = cases(include_str!("../data/dwell_trajectories.json"));
    all.extend(cases(include_str!("../data/bristle_trajectories.json")));
    let structures = cases(include_str!("../data/structure_trajectories.json"));
    let both = structures.into_iter();
    all.extend(both.filter(|case| text(&case["family"]) == "dwell_and_bristle"));
    assert_eq!(all.len(), 21);
    let (mut events, mut worst) = (0, Worst::default());
    for case in all {
        let id = text(&case["id"]);
        let system = remembering(&case["system"]);
        let deflections = |value: &Value| match value.get("z") {
            Some(z) if !z.is_null() => numbers(z),
            _ => vec![0.0; system.contacts().len()],
        };
        let start = State::new(&numbers(&case["start"]["q"]), &numbers(&case["start"]["v"]))
            .with_memory(&deflections(&case["start"]));
        let many = Integrator::new().with_max_steps(1_000_000).unwrap();
        let motion = many
            .simulate(&system, start, number(&case["t_end"]))
            .unwrap();
        let expected = list(&case["events"]);
        assert_eq!(motion.events().len(), expected.len(), "{id}");
        let what = |quantity: &str| format!("{id}, {quantity}");
        for (actual, expected) in motion.events().iter().zip(expected) {
            events += 1;
            let coordinate = system.contacts()[actual.contact().unwrap()].coordinate();
            assert_eq!(
                expected["contact"].as_u64(),
                Some(coordinate as u64),
                "{id}"
            );
            let kind = kind(text(&expected["kind"]));
            assert_eq!(actual.kind, kind, "{id}");
            worst.meet(&what("time"), actual.time, number(&expected["t"]));
            let (q, v) = (&actual.state.displacements, &actual.state.velocities);
            worst.meet_all(1.0, &what("q"), q, &numbers(&expected["q"]));
            worst.meet_all(1.0, &what("v"), v, &numbers(&expected["v"]));
            // The clock of rest, just before.
            if let (EventKind::Release(_), Some(theta)) = (kind, expected.get("theta"))
                && list(&case["system"]["contacts"])[coordinate]
                    .get("dwell")
                    .is_some()
            {
                let clock = actual.state.memory[actual.contact().unwrap()];
                worst.meet(&what("θ"), clock, number(theta));
            }
        }
        for expected in list(&case["states"]) {
            let state = motion.state_at(number(&expected["t"])).unwrap();
            let (q, v) = (&state.displacements, &state.velocities);
            worst.meet_all(1.0, &what("q of a state"), q, &numbers(&expected["q"]));
            worst.meet_all(1.0, &what("v of a state"), v, &numbers(&expected["v"]));
        }
    }
    assert_eq!(events, 686);
    worst.assert("memory", 1e-13);
}

/// A clock that a start in mid-stick brings along makes the rest of the motion the same.
#[test]
fn a_motion_goes_on_from_its_own_clock() {
    let law = Dwell::exponential(Coulomb::new(0.3, 0.3).unwrap(), 0.6, 2.0).unwrap();
    let contact = Contact::new(0, law, 1.0).unwrap().on_belt(0.1);
    let block = one_mass([1.0, 0.0, 1.0], 0.0, contact).unwrap();
    let motion = block.simulate(State::new(&[0.0], &[0.0]), 20.0).unwrap();
    let [stick, release] = at_least(motion.events());
    let middle = 0.5 * (stick.time + release.time);
    let state = motion.state_at(middle).unwrap();
    assert_abs_diff_eq!(state.memory[0], (middle - stick.time), epsilon = 1e-15);
    let again = block.simulate(state.clone(), 20.0).unwrap();
    assert!((again.events()[0].time + middle - release.time).abs() < 1e-14);
    // Without it the contact would have to begin anew.
    let fresh = State::new(&state.displacements, &state.velocities);
    let fresh = block.simulate(fresh, 20.0).unwrap();
    assert!(fresh.events()[0].time + middle < release.time - 0.1);
}

/// P. Dupont, V. Hayward, B. Armstrong, F. Altpeter, *IEEE Trans. Automatic Control* 47 (2002)
/// 787-792: bristles that are elastic up to a break-away deflection, and then flow.
struct ElastoPlastic {
    coefficient: f64,
    stiffness: f64,
    /// Part of the largest deflection up to which the bristle is purely elastic.
    elastic: f64,
}

impl ContactLaw for ElastoPlastic {
    type Memory<S: Scalar> = [S; 1];
    fn coefficient<S: Scalar>(&self, _: Slip<S>, [z]: [S; 1]) -> S {
        z * self.stiffness
    }
    fn limit<S: Scalar>(&self, _: S, _: [S; 1]) -> Option<S> {
        None
    }
    fn rates<S: Scalar>(&self, motion: Motion<S>, _: S, [z]: [S; 1]) -> [S; 1] {
        let Motion::Slip(slip) = motion else {
            return [z.constant(0.0)];
        };
        let part = z * (slip.direction * self.stiffness / self.coefficient);
        // Flow only in the direction of the deflection.
        let flow = (part - self.elastic) / (1.0 - self.elastic);
        let flow = if part.value() < self.elastic {
            flow * 0.0
        } else {
            flow
        };
        [slip.velocity() * (-flow + 1.0)]
    }
    memory_stays!(1);
}

/// Below the break-away deflection a mass on such bristles is a mass on a spring: no drift.
#[test]
fn a_law_of_ones_own() {
    let law = ElastoPlastic {
        coefficient: 0.5,
        stiffness: 4.0,
        elastic: 0.8,
    };
    let block = one_mass([1.0, 0.0, 0.0], 0.0, Contact::new(0, law, 1.0).unwrap()).unwrap();
    let start = State::new(&[0.0], &[0.1]).with_memory(&[0.0]);
    let motion = block.simulate(start, 100.0).unwrap();
    for (t, state) in motion.sample(50) {
        assert!((state.displacements[0] - 0.05 * (2.0 * t).sin()).abs() < 1e-14);
        assert_abs_diff_eq!(state.memory[0], state.displacements[0], epsilon = 1e-14);
    }
}

/// A law that can be spoilt in one place.
#[derive(Clone, Copy)]
struct Spoilt {
    limit: Option<f64>,
    /// Forward and backward.
    coefficients: [f64; 2],
    /// The rates in stick, forward and backward.
    rates: [f64; 3],
    /// The jump of the law at speed 1, backward.
    jump: f64,
}

impl ContactLaw for Spoilt {
    type Memory<S: Scalar> = [S; 1];
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, _: [S; 1]) -> S {
        let backward = slip.direction < 0.0;
        let jump = if backward && slip.piece > 0 {
            self.jump
        } else {
            0.0
        };
        slip.speed
            .constant(self.coefficients[usize::from(backward)] + jump)
    }
    fn limit<S: Scalar>(&self, zero: S, _: [S; 1]) -> Option<S> {
        self.limit.map(|limit| zero.constant(limit))
    }
    fn rates<S: Scalar>(&self, motion: Motion<S>, _: S, [z]: [S; 1]) -> [S; 1] {
        [z.constant(match motion {
            Motion::Stick => self.rates[0],
            Motion::Slip(slip) => self.rates[1 + usize::from(slip.direction < 0.0)],
        })]
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        std::iter::once(1.0)
    }
    fn caught(&self, memory: [f64; 1]) -> [f64; 1] {
        memory
    }
}

#[test]
fn contact_laws_are_checked_in_both_directions() {
    let good = Spoilt {
        limit: Some(0.4),
        coefficients: [0.3, -0.4],
        rates: [0.0; 3],
        jump: 0.0,
    };
    let made = |law: Spoilt| Contact::new(0, law, 1.0).map(drop);
    assert_eq!(made(good), Ok(()));
    let refused = |law: Spoilt, expected: &str| match made(law) {
        Err(Error::InvalidParameter { name, .. }) => assert_eq!(name, expected),
        other => panic!("{other:?}"),
    };
    for bad in [f64::NAN, f64::INFINITY, -0.1] {
        refused(
            Spoilt {
                limit: Some(bad),
                ..good
            },
            "static_coefficient",
        );
    }
    for (coefficients, kinetic) in [([0.41, -0.3], 0.41), ([0.3, -0.41], 0.41)] {
        let expected = Error::StaticBelowKinetic {
            static_coefficient: 0.4,
            kinetic_coefficient: kinetic,
        };
        assert_eq!(
            made(Spoilt {
                coefficients,
                ..good
            }),
            Err(expected)
        );
    }
    for coefficients in [
        [0.3, f64::NAN],
        [f64::INFINITY, -0.3],
        [0.3, f64::NEG_INFINITY],
    ] {
        let result = made(Spoilt {
            coefficients,
            ..good
        });
        refused!(result => Error::NonFiniteFriction { speed: 0.0, .. });
    }
    // The sign of the direction was forgotten.
    let name = "coefficient backward at speed 0";
    refused(
        Spoilt {
            coefficients: [0.3, 0.3],
            ..good
        },
        name,
    );
    refused(
        Spoilt {
            coefficients: [-0.3, -0.3],
            ..good
        },
        name,
    );
    // One that never sticks may not jump at r = 0.
    let never = Spoilt {
        limit: None,
        ..good
    };
    refused(never, name);
    assert_eq!(
        made(Spoilt {
            coefficients: [0.0; 2],
            ..never
        }),
        Ok(())
    );
    assert_eq!(
        made(Spoilt {
            coefficients: [0.1; 2],
            ..never
        }),
        Ok(())
    );
    for i in 0..3 {
        for bad in [f64::NAN, f64::INFINITY] {
            let mut rates = [0.0; 3];
            rates[i] = bad;
            refused(Spoilt { rates, ..good }, "rate");
        }
    }
    let broken = Err(Error::BadBreakpoints {
        index: 0,
        value: 1.0,
    });
    assert_eq!(made(Spoilt { jump: 1e-6, ..good }), broken);
    assert_eq!(
        made(Spoilt {
            jump: f64::NAN,
            ..good
        }),
        broken
    );
}

/// A step that does not know of a kink is only shorter there, which no result shows.
#[test]
fn contact_laws_pass_on_where_their_law_bends() {
    let law = Tabulated::new([(0.0, 0.4), (0.1, 0.3), (0.5, 0.25), (1.0, 0.3)]).unwrap();
    let kinks: Vec<f64> = FrictionLaw::breakpoints(&law).collect();
    assert!(kinks.len() > 1, "{kinks:?}");
    fn named(law: &impl ContactLaw) -> Vec<f64> {
        law.breakpoints().collect()
    }
    let dwell = Dwell::exponential(law.clone(), 0.5, 2.0).unwrap();
    let lugre = LuGre::new(law.clone(), 100.0, 1.0, 0.0).unwrap();
    let dahl = Dahl::new(0.4, 100.0).unwrap();
    assert_eq!(named(&law), kinks);
    assert_eq!(named(&dwell), kinks);
    assert_eq!(named(&lugre), kinks);
    assert!(named(&dahl).is_empty());
    assert_eq!(named(&AnyContactLaw::from(dwell)), kinks);
    assert_eq!(named(&AnyContactLaw::from(lugre)), kinks);
}

/// A law whose static coefficient is below its kinetic one is refused where the contact is made,
/// wherever it is wrapped.
#[test]
fn limits_below_the_kinetic_coefficient_are_refused() {
    let law = || Raised {
        law: Coulomb::new(0.4, 0.4).unwrap().into(),
        static_coefficient: 0.3,
    };
    let expected = Err(Error::StaticBelowKinetic {
        static_coefficient: 0.3,
        kinetic_coefficient: 0.4,
    });
    let dwell = Dwell::exponential(law(), 0.6, 1.0).unwrap();
    assert_eq!(Contact::new(0, dwell.clone(), 1.0).map(drop), expected);
    let any: AnyContactLaw<Raised> = dwell.into();
    assert_eq!(Contact::new(0, any, 1.0).map(drop), expected);
    assert_eq!(
        Contact::new(0, AnyContactLaw::Dry(law()), 1.0).map(drop),
        expected
    );
    // Bristles have no static coefficient.
    assert!(Contact::new(0, LuGre::new(law(), 10.0, 0.0, 0.0).unwrap(), 1.0).is_ok());
}

#[test]
fn memories_at_the_start_are_checked() {
    let law = Dwell::hyperbolic(Coulomb::new(0.4, 0.3).unwrap(), 0.6, 2.0).unwrap();
    let block = one_mass([1.0, 0.0, 0.0], 0.0, Contact::new(0, law, 1.0).unwrap()).unwrap();
    let result = |memory: &[f64]| {
        let start = State::new(&[0.0], &[1.0]).with_memory(memory);
        block.simulate(start, 1.0).map(drop)
    };
    assert_eq!(result(&[]), Ok(()));
    assert_eq!(result(&[0.7]), Ok(()));
    for (bad, expected) in [
        (f64::NAN, "memory"),
        (f64::INFINITY, "memory"),
        // A clock before its beginning.
        (-2.0, "static_coefficient"),
        (-1.9, "static_coefficient"),
    ] {
        match result(&[bad]) {
            Err(Error::InvalidParameter { name, .. }) => assert_eq!(name, expected),
            other => panic!("{bad}: {other:?}"),
        }
    }
    refused!(result(&[0.0, 0.0]) => Error::WrongSize { name: "memory", .. });
}

/// A memory that becomes infinite at time 1.
struct Exploding;

impl ContactLaw for Exploding {
    type Memory<S: Scalar> = [S; 1];
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, [z]: [S; 1]) -> S {
        z.constant(0.1 * slip.direction)
    }
    fn limit<S: Scalar>(&self, zero: S, _: [S; 1]) -> Option<S> {
        Some(zero.constant(0.1))
    }
    fn rates<S: Scalar>(&self, _: Motion<S>, _: S, [z]: [S; 1]) -> [S; 1] {
        [z.square()]
    }
    memory_stays!(1);
}

#[test]
fn memories_that_fail_end_the_motion() {
    let contact = Contact::new(0, Exploding, 1.0).unwrap();
    let block = one_mass([1.0, 0.0, 0.0], 0.0, contact).unwrap();
    let start = State::new(&[0.0], &[1.0]).with_memory(&[1.0]);
    match block.simulate(start, 2.0) {
        Err(Error::StepUnderflow { reached, .. } | Error::TooManySteps { reached, .. }) => {
            assert!((reached.time - 1.0).abs() < 1e-10, "{reached}");
        }
        other => panic!("{other:?}"),
    }
}

/// Canudas de Wit et al. 1995, Table I: m = 1, pulled over the ground by a spring of stiffness 2
/// whose end moves at 0.1. It sticks and slips; the integrator needs thousands of steps, not
/// millions.
#[test]
fn the_first_example_of_lugre() {
    let law = Exponential::new(1.5, 1.0, 0.001).unwrap();
    let law = LuGre::new(AnyLaw::from(law), 1e5, 1e5_f64.sqrt(), 0.4).unwrap();
    // In the frame of the pulling end the ground moves backward.
    let contact = Contact::new(0, law, 1.0).unwrap().on_belt(-0.1);
    let block = one_mass([1.0, 0.0, 2.0], 0.0, contact).unwrap();
    let start = State::new(&[0.0], &[-0.1]).with_memory(&[0.0]);
    let many = Integrator::new().with_max_steps(2_000_000).unwrap();
    let mut steps = 0;
    let mut slips = 0;
    for step in many.flow(&block, start).unwrap() {
        let step = step.unwrap();
        steps += 1;
        let (from, to) = (step.state().velocities[0], step.end_state().velocities[0]);
        slips += usize::from(from < 0.0 && to >= 0.0);
        if step.end_time() >= 40.0 {
            break;
        }
    }
    println!("{steps} steps, {slips} slips");
    assert!(slips >= 3);
}

/// What a contact remembers stays while it has no load, but rest has ended.
#[test]
fn a_contact_without_load_keeps_its_bristles_and_forgets_its_rest() {
    let load = || Drive::constant(0.5).with_harmonic(1.0, 1.0, 0.0).unwrap();
    let block = |law: AnyContactLaw<Raised>| {
        let contact = Contact::new(0, law, load()).unwrap().on_belt(0.1);
        one_mass([1.0, 0.0, 1.0], 0.0, contact).unwrap()
    };
    let bristles = block(Dahl::new(0.4, 20.0).unwrap().into());
    let motion = bristles.simulate(State::new(&[0.3], &[0.0]), 40.0).unwrap();
    let mut open: Option<f64> = None;
    let mut seen = 0;
    for event in motion.events() {
        match event.kind {
            EventKind::Open => open = Some(event.state.memory[0]),
            EventKind::Close => {
                assert_eq!(open, Some(event.state.memory[0]));
                seen += 1;
            }
            _ => {}
        }
    }
    assert!(seen >= 6, "{seen}");
    let dry: AnyLaw = Coulomb::new(0.9, 0.9).unwrap().into();
    let law = Dwell::exponential(dry, 1.0, 2.0).unwrap();
    // Carried along by the belt: nothing pulls at it, with a load or without.
    let points = [(2.0, 1.0), (2.0, -0.5), (3.0, -0.5), (3.0, 1.0)];
    let contact = Contact::new(0, law, Drive::profile(&points).unwrap()).unwrap();
    let carried = one_mass([1.0, 0.0, 0.0], 0.0, contact.on_belt(0.1)).unwrap();
    let motion = carried.simulate(State::new(&[0.0], &[0.1]), 6.0).unwrap();
    let [open, close] = exactly(motion.events());
    assert_eq!((open.kind, close.kind), (EventKind::Open, EventKind::Close));
    assert_eq!((open.state.memory[0], close.state.memory[0]), (2.0, 0.0));
    // From there on the clock runs anew.
    assert_abs_diff_eq!(motion.last().memory[0], 3.0, epsilon = 1e-14);
}

/// A mass on bristles, and beside it a mass on a dry contact, coupled to it, on one belt.
struct Pair {
    stiffness: [f64; 2],
    damping: [f64; 2],
    coupling: f64,
    belt: f64,
    limit: f64,
    system: Structure,
}

impl Pair {
    fn random(random: &mut Random) -> Self {
        let stiffness = [(); 2].map(|()| random.uniform(0.4, 2.0));
        let damping = [(); 2].map(|()| random.uniform(0.01, 0.25));
        let coupling = random.uniform(0.3, 2.0);
        let belt = random.logarithmic(0.05, 0.5);
        let (bristle, load) = (random.logarithmic(1e2, 1e5), random.uniform(0.3, 1.5));
        let (static_, normal) = (random.uniform(0.2, 0.6), random.uniform(0.3, 1.5));
        let law = Exponential::new(0.6, 0.4, 0.3).unwrap();
        let rough = LuGre::new(law, bristle, random.uniform(0.0, 0.5), 0.04).unwrap();
        let dry = Coulomb::new(static_, 0.8 * static_).unwrap();
        let mut system = Structure::new(&[1.5, 0.7])
            .and_then(|s| s.with_spring(0, 1, coupling))
            .and_then(|s| s.with_contact(Contact::new(0, rough, load)?.on_belt(belt)))
            .and_then(|s| s.with_contact(Contact::new(1, dry, normal)?.on_belt(belt)))
            .unwrap();
        for i in 0..2 {
            system = system
                .with_ground_spring(i, stiffness[i])
                .and_then(|s| s.with_ground_damper(i, damping[i]))
                .unwrap();
        }
        Self {
            stiffness,
            damping,
            coupling,
            belt,
            limit: normal * static_,
            system,
        }
    }
}

/// What a dry contact carries in stick stays within its limit while the mass beside it slips on
/// bristles; the force follows from displacements alone.
#[test]
fn a_contact_sticks_no_longer_than_its_limit_beside_bristles() {
    let mut random = Random::new(5511);
    let (mut steps, mut releases, mut worst) = (0, 0, 0.0_f64);
    for _ in 0..60 {
        let pair = Pair::random(&mut random);
        let start = State::new(&[0.1, 0.2], &[0.1, 0.0]);
        let motion = Integrator::new()
            .with_max_steps(4000)
            .and_then(|integrator| integrator.simulate(&pair.system, start, 20.0));
        // The stiffest take too many steps.
        let Ok(motion) = motion else { continue };
        let own = motion
            .events()
            .iter()
            .filter(|event| event.contact().unwrap() == 1);
        releases += own
            .filter(|event| matches!(event.kind, EventKind::Release(_)))
            .count();
        for step in motion.steps() {
            if step.modes()[1] != Mode::Stick {
                continue;
            }
            steps += 1;
            for part in 0..=16 {
                let state = step.state_at(step.duration().min(20.0) * f64::from(part) / 16.0);
                let [q, other] = [state.displacements[1], state.displacements[0]];
                let force = pair.coupling * (other - q)
                    - pair.stiffness[1] * q
                    - pair.damping[1] * pair.belt;
                worst = larger(worst, force.abs() / pair.limit - 1.0);
            }
        }
    }
    println!("{steps} steps, {releases} releases, {worst:.1e}");
    assert!(steps > 1000 && releases > 40, "{steps} {releases}");
    assert!(worst < 1e-12, "{worst:e}");
}

/// The release beside bristles, against fixed steps of a method of fourth order: with 10⁻⁵ they
/// give the time 0.564188985587.
#[test]
fn a_release_beside_bristles_has_its_time() {
    let matrix = |numbers: [f64; 4]| DMatrix::from_row_slice(2, 2, &numbers);
    let bristles = Exponential::new(0.6433945996151641, 0.38603675976909846, 0.35892312703830653)
        .and_then(|law| {
            LuGre::new(
                law,
                2550.65271038457,
                0.2589231270383065,
                0.04011085550556919,
            )
        });
    let dry = Rational::new(0.22094986044699774, 0.5238636793768404).unwrap();
    let belt = 0.0892105680853651;
    let system = Structure::new(&[1.5265963447822655, 0.6692772550650781])
        .and_then(|s| {
            let coupling = -1.0308090275716788;
            s.with_stiffness(matrix([
                1.8205092892778103,
                coupling,
                coupling,
                1.6963184755062573,
            ]))
        })
        .and_then(|s| {
            let coupling = -0.06561791722866464;
            s.with_damping(matrix([
                0.23694176414942064,
                coupling,
                coupling,
                0.25528723073262183,
            ]))
        })
        .and_then(|s| s.with_contact(Contact::new(0, bristles?, 1.2899909199243536)?.on_belt(belt)))
        .and_then(|s| s.with_contact(Contact::new(1, dry, 1.4963213065056482)?.on_belt(belt)))
        .unwrap();
    let start = State::new(
        &[0.741580032474483, 0.6153765248200187],
        &[0.08964277669000022, 0.08888461636027331],
    )
    .with_memory(&[-0.00024918701684675755]);
    let motion = system.simulate(start, 0.7).unwrap();
    let mut events = motion.events().iter();
    let release = events.find(|event| matches!(event.kind, EventKind::Release(_)));
    let release = release.unwrap();
    assert_eq!(release.contact().unwrap(), 1);
    assert_abs_diff_eq!(release.time, 0.564188985587, epsilon = 2e-9);
    assert_abs_diff_eq!(motion.last().velocities[1], 0.088396784998, epsilon = 2e-12);
}
