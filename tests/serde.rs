//! Writing and reading back, and reading what a constructor would refuse (feature `serde`).

use serde::{Serialize, de::DeserializeOwned};
use serde_json::Value;
use stick_slip::bifurcation::{self, Criticality};
use stick_slip::limit_cycle::{Attractor, Continuum};
use stick_slip::nalgebra::DMatrix;
use stick_slip::{
    AnyContactLaw, AnyLaw, Backlash, Contact, Coulomb, CycleKind, CycleSet, Dahl, Direction,
    Directional, Drive, Dwell, Error, Event, EventKind, Exponential, FirstOrder, ForceElement,
    ForceLaw, Freewheel, FrictionLaw, Iwan4, LimitCycle, LuGre, MassOnBelt, Mode, Pendulum,
    Polynomial, PolynomialSpring, RateState, RateState2, Rational, Scalar, Scaled, Scaling,
    SnapThrough, Stability, State, Stop, Stribeck, Structure, Tabulated, TabulatedForce,
    TimeFunction, VanDerPol, limit_cycle, structure,
};

use stick_slip_tests_common::masses::PAD;
use stick_slip_tests_common::{on_belt, one_mass};

fn there_and_back<T: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug>(
    value: &T,
) -> String {
    let text = serde_json::to_string(value).unwrap();
    assert_eq!(&serde_json::from_str::<T>(&text).unwrap(), value, "{text}");
    text
}

fn refused<T: DeserializeOwned + std::fmt::Debug>(text: &str, why: &str) {
    let message = serde_json::from_str::<T>(text).unwrap_err().to_string();
    assert!(message.contains(why), "{message}");
}

/// Checks that the page `schema` lists every name in what is written.
fn names_are_listed(value: &Value) {
    match value {
        Value::Object(fields) => {
            for (name, value) in fields {
                let page = include_str!("../src/schema.rs");
                let is_listed = ["`", "\""]
                    .iter()
                    .any(|mark| page.contains(&format!("{mark}{name}{mark}")));
                assert!(is_listed, "{name}");
                names_are_listed(value);
            }
        }
        Value::Array(values) => values.iter().for_each(names_are_listed),
        _ => {}
    }
}

/// Texts of a type in rows, each with what its refusal says.
macro_rules! refuse {
    ($($read:ty: $text:expr, $why:expr;)*) => { $(refused::<$read>(&$text, $why);)* };
}

/// Values in rows that are read as they were written, some with their text.
macro_rules! there_and_back {
    ($($value:expr $(=> $text:expr)?;)*) => { $(
        let _text = there_and_back(&$value);
        $(assert_eq!(_text, $text);)?
    )* };
}

/// Texts of a type in rows, each with what is read.
macro_rules! read {
    ($($read:ty: $text:expr => $value:expr;)*) => { $(
        assert_eq!(serde_json::from_str::<$read>(&$text).unwrap(), $value);
    )* };
}

/// The text of Coulomb's law with these coefficients.
const COULOMB: &str = r#"{"static_coefficient":0.5,"kinetic_coefficient":0.3}"#;

fn table() -> Tabulated {
    Tabulated::new([(0.0, 0.4), (0.05, 0.36), (0.15, 0.31), (0.6, 0.25)]).unwrap()
}

fn brake() -> Scaling {
    Scaling::new(PAD).unwrap()
}

#[test]
fn laws_there_and_back() {
    let coulomb = Coulomb::new(0.5, 0.3).unwrap();
    let stribeck = Stribeck::new(0.4, 0.25, 0.3, 1).unwrap();
    let rational = Rational::new(0.4, 3.0).unwrap().with_offset(0.1).unwrap();
    there_and_back! {
        // Parameters only, and to the bit.
        Polynomial::new(0.4, 0.25, 0.1 + 0.2).unwrap() => concat!(
            r#"{"static_coefficient":0.4,"minimum_coefficient":0.25,"#,
            r#""minimum_velocity":0.30000000000000004}"#,
        );
        coulomb => COULOMB;
        Exponential::new(0.4, 0.25, 0.5).unwrap();
        stribeck.with_viscous_coefficient(0.01).unwrap();
        rational.with_quadratic(0.01).unwrap();
        table();
        table().with_static_coefficient(0.5).unwrap();
        Tabulated::piecewise_linear([(0.0, 0.4), (0.5, 0.3)]).unwrap()
            => concat!(
                r#"{"static_coefficient":0.4,"points":[[0.0,0.4],[0.5,0.3]],"#,
                r#""piecewise_linear":true}"#,
            );
        AnyLaw::from(coulomb) => format!(r#"{{"coulomb":{COULOMB}}}"#);
        AnyLaw::from(table());
        brake().law(table());
    }
}

/// A contact law of each kind.
fn contact_laws() -> Vec<AnyContactLaw<AnyLaw>> {
    let law = || AnyLaw::from(Polynomial::new(0.4, 0.25, 0.1 + 0.2).unwrap());
    vec![
        AnyContactLaw::Dry(law()),
        Dwell::exponential(law(), 0.7, 1.0 / 3.0).unwrap().into(),
        Dwell::hyperbolic(law(), 0.1 + 0.6, 2.0).unwrap().into(),
        Dwell::logarithmic(law(), 0.05, 2.0).unwrap().into(),
        Dahl::new(0.1 + 0.2, 1e3).unwrap().into(),
        LuGre::new(law(), 1e3, 2.0, 1.0 / 3.0).unwrap().into(),
        RateState::aging(0.6, 0.1, 0.1 + 0.2, 1e-1, 0.05)
            .unwrap()
            .into(),
    ]
}

#[test]
fn contact_laws_there_and_back() {
    for law in contact_laws() {
        let text = there_and_back(&law);
        // To the bit, whatever a constructor makes of it.
        let again: AnyContactLaw<AnyLaw> = serde_json::from_str(&text).unwrap();
        assert_eq!(serde_json::to_string(&again).unwrap(), text);
    }
    let law = Coulomb::new(0.5, 0.3).unwrap();
    let of = |rest: &str| format!(r#"{{"law":{COULOMB},{rest}}}"#);
    let lugre = LuGre::new(law, 50.0, 1.0, 0.1).unwrap();
    let text = of(r#""stiffness":50.0,"damping":1.0,"viscous":0.1"#);
    there_and_back! {
        Dwell::hyperbolic(law, 0.7, 2.0).unwrap()
            => format!(r#"{{"hyperbolic":{}}}"#, of(r#""limit":0.7,"time":2.0"#));
        Dwell::logarithmic(law, 0.1, 2.0).unwrap()
            => format!(r#"{{"logarithmic":{}}}"#, of(r#""rate":0.1,"time":2.0"#));
        Dahl::new(0.4, 50.0).unwrap() => r#"{"coefficient":0.4,"stiffness":50.0}"#;
        lugre => text;
        AnyContactLaw::from(lugre) => format!(r#"{{"lugre":{text}}}"#);
        RateState::slip(0.6, 0.01, 0.02, 0.5, 0.25).unwrap().with_least_speed(0.125).unwrap()
            => r#"{"slip":{"f0":0.6,"a":0.01,"b":0.02,"d_c":0.5,"v0":0.25,"v_m":0.125}}"#;
        RateState::aging(0.6, 0.01, 0.02, 0.5, 0.25).unwrap().with_second_state(0.5, 2.0).unwrap()
            => r#"{"aging":{"f0":0.6,"a":0.01,"b":0.02,"d_c":0.5,"v0":0.25,"b2":0.5,"d_c2":2.0}}"#;
    }
    let sided = Directional::new(law, Coulomb::new(0.7, 0.6).unwrap()).unwrap();
    there_and_back! {
        sided.clone() => format!(
            r#"{{"forward":{COULOMB},"backward":{}}}"#,
            r#"{"static_coefficient":0.7,"kinetic_coefficient":0.6}"#
        );
        Freewheel::new(law).unwrap() => format!(r#"{{"drag":{COULOMB}}}"#);
    }
    let contacts = [
        Contact::new(0, sided, 1.0),
        Contact::freewheel(0, 1),
        Contact::freewheel(0, 1).and_then(|c| c.on_belt(0.3).with_drag(table(), 2.0)),
    ];
    for contact in contacts {
        there_and_back(&contact.unwrap());
    }
    // What may be left out.
    read! { LuGre<Coulomb>: of(r#""stiffness":50"#) => LuGre::new(law, 50.0, 0.0, 0.0).unwrap(); }
}

#[test]
fn reading_contact_laws_checks_what_constructors_check() {
    let of = |rest: &str| format!(r#"{{"law":{COULOMB},{rest}}}"#);
    let dwell = |form: &str, rest: &str| format!(r#"{{"{form}":{}}}"#, of(rest));
    let rate_state = |rest: &str| format!(r#"{{"aging":{{"f0":0.6,"a":0.01,"v0":1,{rest}}}}}"#);
    for form in ["exponential", "hyperbolic"] {
        refuse! {
            Dwell<Coulomb>: dwell(form, r#""limit":0.4,"time":1"#), "limit = 0.4 is not allowed";
            Dwell<Coulomb>: dwell(form, r#""limit":0.6,"time":0"#), "time";
            Dwell<Coulomb>: dwell(form, r#""rate":0.6,"time":1"#), "unknown field";
        }
    }
    refuse! {
        Dwell<Coulomb>: dwell("logarithmic", r#""rate":-1,"time":1"#), "rate";
        Dwell<Coulomb>: dwell("linear", r#""rate":1,"time":1"#), "unknown variant";
        Dahl: r#"{"coefficient":0,"stiffness":1}"#, "coefficient = 0";
        Dahl: r#"{"coefficient":1,"stiffness":-1}"#, "stiffness = -1";
        Dahl: r#"{"coefficient":1,"stiffness":1,"damping":1}"#, "unknown field";
        LuGre<Coulomb>: of(r#""stiffness":0"#), "stiffness";
        LuGre<Coulomb>: of(r#""stiffness":1,"damping":-1"#), "damping";
        LuGre<Coulomb>: of(r#""stiffness":1,"viscous":-1"#), "viscous";
        LuGre<Coulomb>: of(r#""stiffness":1,"sigma2":1"#), "unknown field";
        RateState: rate_state(r#""b":0.02"#), "missing field `d_c`";
        RateState: rate_state(r#""b":0.02,"d_c":-1"#), "d_c = -1";
        RateState: rate_state(r#""b":0.02,"d_c":1,"v_m":0"#), "v_m = 0";
        RateState: rate_state(r#""b":0.02,"d_c":1,"theta":1"#), "unknown field";
        RateState: rate_state(r#""b":0.02,"d_c":1,"b2":1"#), "d_c2 = NaN";
        RateState: rate_state(r#""b":0.02,"d_c":1,"b2":1,"d_c2":1"#), "2 given; 1 are needed";
        RateState2: rate_state(r#""b":0.02,"d_c":1"#), "1 given; 2 are needed";
        AnyContactLaw<Coulomb>: r#"{"lu_gre":{}}"#, "unknown variant";
    }
}

/// A force law of each kind of the crate, with its text in an element.
fn elements() -> Vec<(ForceElement, &'static str)> {
    fn of<L: ForceLaw + Send + Sync + 'static>(law: Result<L, Error>) -> ForceElement {
        ForceElement::new(0, law.unwrap()).unwrap()
    }
    let points = [(-1.0, -2.5), (0.0, 0.0), (1.5, 1.0)];
    vec![
        (
            of(PolynomialSpring::new(&[1.0, 0.0, 0.7])),
            r#""polynomial_spring":{"coefficients":[1.0,0.0,0.7]}"#,
        ),
        (
            of(Pendulum::new(0.1 + 0.2, 1.0)),
            r#""pendulum":{"moment":0.30000000000000004,"length":1.0}"#,
        ),
        (
            of(Backlash::new(3.0, 0.5)),
            r#""backlash":{"stiffness":3.0,"gap":0.5}"#,
        ),
        (
            of(SnapThrough::new(2.0, 1.25, 1.0)),
            r#""snap_through":{"stiffness":2.0,"free_length":1.25,"span":1.0}"#,
        ),
        (
            of(VanDerPol::new(0.2, 0.5)),
            r#""van_der_pol":{"negative_damping":0.2,"nonlinear_damping":0.5}"#,
        ),
        (
            of(TabulatedForce::new(&points)),
            r#""tabulated_force":{"points":[[-1.0,-2.5],[0.0,0.0],[1.5,1.0]]}"#,
        ),
        (
            of(TabulatedForce::piecewise_linear(&points)),
            r#""tabulated_force":{"points":[[-1.0,-2.5],[0.0,0.0],[1.5,1.0]],"#,
        ),
    ]
}

#[test]
fn force_elements_there_and_back() {
    let mass = || Structure::new(&[1.0]).unwrap();
    for (element, expected) in elements() {
        let text = there_and_back(&element);
        assert!(text.contains(expected), "{text}");
        let structure = mass().with_element(element).unwrap();
        let text = there_and_back(&structure);
        assert!(
            text.contains(r#""elements":[{"direction":[[0,1.0]],"law":{""#),
            "{text}"
        );
        let read: Structure = serde_json::from_str(&text).unwrap();
        let start = structure::State::new(&[0.3], &[1.0]);
        let [one, other] = [structure, read].map(|s| s.simulate(start.clone(), 5.0).unwrap());
        assert_eq!(one.last(), other.last());
    }
    // Without elements nothing is written of them.
    let text = there_and_back(&mass());
    assert!(!text.contains("elements"), "{text}");
    // A direction, and a factor.
    let spring = PolynomialSpring::new(&[1.0]).unwrap();
    let oblique = ForceElement::along(&[(2, 0.6), (0, -0.8)], spring)
        .and_then(|element| element.with_factor(Drive::harmonic(0.5, 2.0, 0.0)?))
        .unwrap();
    there_and_back(&oblique);
    let read: ForceElement = serde_json::from_str(
        r#"{"direction":[[0,1]],"law":{"polynomial_spring":{"coefficients":[1]}}}"#,
    )
    .unwrap();
    let spring = PolynomialSpring::new(&[1.0]).unwrap();
    assert_eq!(read, ForceElement::new(0, spring).unwrap());
}

#[test]
fn reading_force_elements_checks_what_constructors_check() {
    let element = |law: &str| format!(r#"{{"direction":[[0,1]],"law":{{{law}}}}}"#);
    refuse! {
        ForceElement: element(r#""backlash":{"stiffness":1,"gap":-1}"#), "gap = -1 is not allowed";
        ForceElement: element(r#""backlash":{"stiffness":1}"#), "missing field `gap`";
        ForceElement: element(r#""pendulum":{"moment":1,"length":0}"#), "length = 0";
        ForceElement: element(r#""pendulum":{"moment":1,"length":1,"g":9}"#), "unknown field";
        ForceElement: element(r#""polynomial_spring":{"coefficients":[]}"#), "coefficients = 0";
        ForceElement: element(r#""snap_through":{"stiffness":1,"free_length":1,"span":-1}"#),
            "span = -1";
        ForceElement: element(r#""tabulated_force":{"points":[[0,0],[0,1]]}"#), "point 1";
        ForceElement: element(r#""toda":{"stiffness":1}"#), "unknown variant";
        ForceElement: r#"{"direction":[],"law":{"pendulum":{"moment":1,"length":1}}}"#, "direction";
        Structure: r#"{"masses":[1],"elements":[
            {"direction":[[1,1]],"law":{"pendulum":{"moment":1,"length":1}}}]}"#,
            "force element 0";
    }
}

#[test]
fn first_order_states_there_and_back() {
    let integral = FirstOrder::integrator()
        .with_displacement(0, 1.0)
        .and_then(|s| s.with_force(0, -0.5))
        .unwrap();
    let saturating = PolynomialSpring::new(&[1.0, 0.0, -0.5]).unwrap();
    let lag = FirstOrder::lag(0.25)
        .and_then(|s| s.with_velocity(0, 2.0))
        .and_then(|s| s.with_state(0, 0.1))
        .and_then(|s| s.with_drive(Drive::sine(0.5, 2.0)?))
        .and_then(|s| s.with_law(&[(0, 1.0)], saturating.clone()))
        .and_then(|s| s.with_law_of_state(1, saturating))
        .and_then(|s| s.with_force(0, 0.3))
        .unwrap();
    let text = there_and_back(&integral);
    assert!(
        text.starts_with(r#"{"displacements":[[0,1.0]],"drive":"#),
        "{text}"
    );
    let text = there_and_back(&lag);
    for part in [
        r#""time_constant":0.25"#,
        r#""of":{"direction":[[0,1.0]]},"law":{"polynomial_spring":"#,
        r#""of":{"state":1}"#,
    ] {
        assert!(text.contains(part), "{text}");
    }
    let structure = Structure::new(&[1.0])
        .and_then(|s| s.with_first_orders([integral, lag]))
        .unwrap();
    let text = there_and_back(&structure);
    let read: Structure = serde_json::from_str(&text).unwrap();
    let start = structure::State::new(&[0.3], &[1.0]).with_memory(&[0.1, -0.2]);
    let [one, other] = [structure, read].map(|s| s.simulate(start.clone(), 5.0).unwrap());
    assert_eq!(one.last(), other.last());
    // Without states nothing is written of them.
    let text = there_and_back(&Structure::new(&[1.0]).unwrap());
    assert!(!text.contains("first_orders"), "{text}");
    refuse! {
        FirstOrder: r#"{"time_constant":0}"#, "time_constant = 0";
        FirstOrder: r#"{"time":1}"#, "unknown field";
        FirstOrder: r#"{"laws":[{"of":{"direction":[]},
            "law":{"pendulum":{"moment":1,"length":1}}}]}"#, "direction";
        Structure: r#"{"masses":[1],"first_orders":[{"states":[[1,1]]}]}"#, "first-order state 0";
        Structure: r#"{"masses":[1],"first_orders":[{"forces":[[1,1]]}]}"#, "first-order state 0";
    }
}

#[test]
fn force_laws_of_a_user_are_not_written() {
    struct Toda;
    impl ForceLaw for Toda {
        fn force<S: Scalar>(&self, position: S, _: S, _: usize) -> S {
            position.exp() - 1.0
        }
    }
    let structure = Structure::new(&[1.0])
        .and_then(|s| s.with_element(ForceElement::new(0, Toda)?))
        .unwrap();
    let message = serde_json::to_string(&structure).unwrap_err().to_string();
    for part in [
        "force element",
        "user's own law",
        "add the contact, the element or the state",
    ] {
        assert!(message.contains(part), "{message}");
    }
}

/// Structures whose contacts remember, with the events of their motions.
#[test]
fn structures_that_remember_there_and_back() {
    for law in contact_laws() {
        let contact = |i: usize| Contact::new(i, law.clone(), 1.0).map(|c| c.on_belt(0.1));
        let blocks = Structure::new(&[1.0, 2.0])
            .and_then(|s| s.with_ground_spring(0, 1.0)?.with_spring(0, 1, 1.0 / 3.0))
            .and_then(|s| s.with_contact(contact(0)?)?.with_contact(contact(1)?))
            .unwrap();
        there_and_back(&blocks.contacts()[1]);
        let text = there_and_back(&blocks);
        let read: Structure = serde_json::from_str(&text).unwrap();
        let start = structure::State::new(&[0.3, 0.0], &[0.0, 0.1]).with_memory(&[0.0, 1e-5]);
        there_and_back(&start);
        let motion = blocks.simulate(start.clone(), 20.0).unwrap();
        assert!(motion.events().len() > 2, "{text}");
        there_and_back::<Vec<Event<structure::State>>>(&motion.events().to_vec());
        assert_eq!(
            read.simulate(start, 20.0).unwrap().events(),
            motion.events()
        );
    }
}

#[test]
fn the_rest_there_and_back() {
    let system = polynomial(-0.2, 0.05, 2.0);
    let events = system.simulate(State::new(0.0, 0.0), 20.0).unwrap();
    assert!(events.events().len() > 2);
    there_and_back! {
        brake();
        brake().with_length(0.1).unwrap();
        brake().system(AnyLaw::from(table())).unwrap();
        system;
        State::new(0.1 + 0.2, -1.0 / 3.0);
        structure::State::new(&[0.1, 0.2], &[-0.3, 0.0]).with_memory(&[0.5]);
        events.events().to_vec();
    }
}

#[test]
fn what_may_be_left_out() {
    read! {
        Stribeck: concat!(
            r#"{"static_coefficient":0.4,"coulomb_coefficient":0.25,"stribeck_velocity":0.3,"#,
            r#""exponent":1}"#,
        ) => Stribeck::new(0.4, 0.25, 0.3, 1).unwrap();
        Rational: r#"{"static_coefficient":0.4,"decay":3}"# => Rational::new(0.4, 3.0).unwrap();
        MassOnBelt<AnyLaw>: concat!(
            r#"{"law":{"tabulated":{"points":[[0,0.4],[0.05,0.36],[0.15,0.31],[0.6,0.25]]}},"#,
            r#""belt_velocity":0.2}"#,
        ) => MassOnBelt::new(table().into(), 0.2).unwrap();
        Scaling: concat!(
            r#"{"physical":{"mass":2,"stiffness":5000,"damping":4,"normal_force":20,"#,
            r#""belt_velocity":0.05}}"#,
        ) => brake();
        structure::State: r#"{"displacements":[0.1],"velocities":[0]}"#
            => structure::State::new(&[0.1], &[0.0]);
        Drive: "5" => Drive::constant(5.0);
        Drive: "-0.25" => Drive::constant(-0.25);
        Drive: "-3" => Drive::constant(-3.0);
        Drive: "{}" => Drive::constant(0.0);
    }
}

#[test]
fn reading_checks_what_constructors_check() {
    let stribeck = |exponent: &str| {
        format!(
            concat!(
                r#"{{"static_coefficient":0.4,"coulomb_coefficient":0.2,"#,
                r#""stribeck_velocity":0.1,"exponent":{exponent}}}"#,
            ),
            exponent = exponent,
        )
    };
    let on_belt = |rest: &str| format!(r#"{{"law":{COULOMB},{rest}}}"#);
    refuse! {
        Polynomial: concat!(
            r#"{"static_coefficient":0.4,"minimum_coefficient":0.5,"#,
            r#""minimum_velocity":0.5}"#,
        ), "minimum_coefficient = 0.5 is not allowed";
        Coulomb: r#"{"static_coefficient":-1,"kinetic_coefficient":0}"#, "static_coefficient";
        Exponential: concat!(
            r#"{"static_coefficient":0.4,"kinetic_coefficient":0.2,"#,
            r#""stribeck_velocity":0}"#,
        ), "stribeck_velocity";
        Iwan4: r#"{"slip_force":3,"stiffness":2,"exponent":-1,"ratio":0.1}"#,
            "exponent = -1 is not allowed";
        Stribeck: stribeck("0"), "exponent = 0 is not allowed";
        Stribeck: stribeck("0.5"), "invalid type: floating point";
        AnyLaw: format!(r#"{{"stribeck":{}}}"#, stribeck("0")), "exponent";
        Rational: r#"{"static_coefficient":0.4,"decay":1,"offset":0.5}"#, "offset";
        Rational: r#"{"static_coefficient":0.4,"decay":1,"ofset":0.1}"#, "unknown field";
        Tabulated: r#"{"points":[[0,0.4],[0,0.3]]}"#, "speed";
        Tabulated: r#"{"points":[[0,0.4],[1,0.3]],"static_coefficient":0.3}"#, "static_coefficient";
        Drive: r#"{"constant":1,"harmonic":[]}"#, "unknown field";
        Drive: r#""5""#, "a drive: a number, or a map of `constant`, `harmonics`, `profiles`";
        Drive: "null", "a drive: a number, or a map of";
        Drive: "1e999", "number out of range";
        Drive: r#"{"profiles":[[[0,1],[0,2],[0,3]]]}"#, "time";
        MassOnBelt<Coulomb>: on_belt(r#""belt_velocity":1,"load":0"#), "load";
        MassOnBelt<Coulomb>: on_belt(r#""belt_velocity":1,"damping":-1"#), "damping";
        Scaled<Coulomb>: on_belt(r#""velocity_unit":0"#), "velocity_unit";
        Scaling: concat!(
            r#"{"physical":{"mass":0,"stiffness":5000,"damping":4,"normal_force":20,"#,
            r#""belt_velocity":0.05}}"#,
        ), "mass";
    }
}

fn polynomial(belt_velocity: f64, damping: f64, load: f64) -> MassOnBelt<Polynomial> {
    let law = Polynomial::new(0.38, 0.22, 0.55).unwrap();
    on_belt(law, belt_velocity, damping, load)
}

/// Cycles of every kind, stable and unstable, on belts of both directions.
fn cycles() -> Vec<LimitCycle> {
    let exponential = Exponential::new(0.6, 0.3, 0.4).unwrap();
    let bistable = on_belt(exponential, 1.0, 0.01, 1.0);
    let points = [
        (0.0, 0.4),
        (0.1, 0.33),
        (0.3, 0.27),
        (0.6, 0.25),
        (1.0, 0.26),
    ];
    let table = Tabulated::new(points);
    let table = MassOnBelt::new(table.unwrap(), 0.2).unwrap();
    let mut cycles = Vec::new();
    for sign in [1.0, -1.0] {
        let mut add = |set: CycleSet| cycles.extend(set.iter().cloned());
        add(limit_cycle::find(&bistable.with_belt_velocity(sign).unwrap()).unwrap());
        add(limit_cycle::find(&table.clone().with_belt_velocity(0.2 * sign).unwrap()).unwrap());
        for (v_b, damping, load) in [
            (0.3, 0.02, 1.0),
            (0.45, 0.05, 1.0),
            (0.19, 0.004, 0.1),
            (0.3, 0.001, 0.03),
        ] {
            add(limit_cycle::find(&polynomial(sign * v_b, damping, load)).unwrap());
        }
    }
    cycles
}

#[test]
fn kinds_there_and_back() {
    let (lagging, leading) = (Direction::Lagging, Direction::Leading);
    there_and_back! {
        CycleKind::PureSlip => r#""pure_slip""#;
        CycleKind::StickSlip => r#""stick_slip""#;
        CycleKind::Overshoot => r#""overshoot""#;
        CycleKind::Crossing => r#""crossing""#;
        Stability::StableFocus => r#""stable_focus""#;
        Stability::StableNode => r#""stable_node""#;
        Stability::Center => r#""center""#;
        Stability::UnstableFocus => r#""unstable_focus""#;
        Stability::UnstableNode => r#""unstable_node""#;
        Criticality::Supercritical => r#""supercritical""#;
        Criticality::Subcritical => r#""subcritical""#;
        Criticality::Degenerate => r#""degenerate""#;
        EventKind::Stick => r#""stick""#;
        EventKind::Release(lagging) => r#"{"release":"lagging"}"#;
        EventKind::Release(leading) => r#"{"release":"leading"}"#;
        EventKind::Crossing(lagging) => r#"{"crossing":"lagging"}"#;
        Mode::Stick => r#""stick""#;
        Mode::Slip(leading) => r#"{"slip":"leading"}"#;
    }
    refuse! {
        CycleKind: r#""PureSlip""#, "unknown variant";
        EventKind: r#"{"stick":"lagging"}"#, "expected unit";
        EventKind: r#""release""#, "newtype variant";
        Mode: r#"{"slip":"sideways"}"#, "unknown variant";
    }
}

/// A document of each type that is read.
fn documents() -> Vec<(Value, Read)> {
    fn document<T>(value: T) -> (Value, Read)
    where
        T: Serialize + DeserializeOwned + PartialEq + std::fmt::Debug,
    {
        // What was read is written again as it was: nothing is lost, nothing is added.
        let read = |value| {
            let read = serde_json::from_value::<T>(value).map_err(|error| error.to_string())?;
            Ok(serde_json::to_value(read).unwrap())
        };
        (serde_json::to_value(value).unwrap(), read)
    }
    let polynomial = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    let stribeck = Stribeck::new(0.4, 0.25, 0.3, 1).and_then(|l| l.with_viscous_coefficient(0.01));
    let rational = Rational::new(0.4, 3.0).and_then(|law| law.with_offset(0.1));
    let system = MassOnBelt::new(AnyLaw::from(table()), -0.2);
    let system = system.and_then(|system| system.with_damping(0.05));
    let motion = system.clone().unwrap();
    let motion = motion.simulate(State::new(0.0, 0.0), 20.0).unwrap();
    let memory = structure::State::new(&[0.1, 0.2], &[0.3, -0.4]).with_memory(&[1.5]);
    let sliding = memory.clone().with_sliding(3, -1e-12);
    let laws = contact_laws().into_iter().map(document);
    laws.chain([
        document(Coulomb::new(0.4, 0.25).unwrap()),
        document(Iwan4::new(3.0, 2.0, -0.1, 0.1).unwrap()),
        document(Exponential::new(0.4, 0.25, 0.5).unwrap()),
        document(polynomial),
        document(stribeck.unwrap()),
        document(rational.unwrap()),
        document(table().with_static_coefficient(0.5).unwrap()),
        document(AnyLaw::from(polynomial)),
        document(brake().law(table())),
        document(brake().physical()),
        document(brake().with_length(0.1).unwrap()),
        document(system.unwrap()),
        document(State::new(0.1 + 0.2, -1.0 / 3.0)),
        document(memory),
        document(sliding),
        document(motion.events()[1]),
        document(LuGre::new(polynomial, 10.0, 1.0, 0.5).unwrap()),
        document(Dahl::new(0.4, 10.0).unwrap()),
        document(Dwell::exponential(polynomial, 0.6, 2.0).unwrap()),
    ])
    .collect()
}

type Read = fn(Value) -> Result<Value, String>;

#[test]
fn whatever_is_read_is_complete_and_nothing_else() {
    for (document, read) in documents() {
        assert_eq!(read(document.clone()).as_ref(), Ok(&document));
        names_are_listed(&document);
        let fields = document.as_object().unwrap();
        let mut more = document.clone();
        more["colour"] = 1.into();
        let error = read(more).unwrap_err();
        let told = ["unknown field", "single key"];
        assert!(told.iter().any(|told| error.contains(told)), "{error}");
        for name in fields.keys() {
            assert_eq!(*name, name.to_lowercase(), "{document}");
            // Left out: refused, or one of the fields that have a default.
            let mut less = fields.clone();
            less.remove(name);
            let optional = [
                "viscous_coefficient",
                "offset",
                "quadratic",
                "length",
                "damping",
                "load",
                "memory",
                "sliding",
                "viscous",
            ];
            let is_optional = optional.contains(&name.as_str())
                || (name == "static_coefficient" && fields.contains_key("points"));
            // The damper of the physical parameters is none of them.
            let is_optional = is_optional && !fields.contains_key("mass");
            assert_eq!(read(less.into()).is_ok(), is_optional, "{document}: {name}");
        }
        // A number replaced by nothing, by text, or by one that no `f64` holds.
        for wrong in [Value::Null, "0.1".into(), serde_json::json!([0.1])] {
            for document in tampered(&document, &|_| wrong.clone()) {
                let left_out = wrong.is_null() && read(document.clone()).is_ok();
                // Only what may be left out may be nothing.
                let optional = [
                    "/length",
                    "/static_coefficient",
                    "/law/static_coefficient",
                    "/law/tabulated/static_coefficient",
                ];
                let is_nothing = |at: &&str| document.pointer(at).is_some_and(Value::is_null);
                assert!(
                    read(document.clone()).is_err() || left_out && optional.iter().any(is_nothing),
                    "{document}"
                );
            }
        }
    }
}

/// Numbers that are read reach the constructors: whatever was changed, the result is one that a
/// constructor gives, or it is refused.
#[test]
fn tampered_numbers_are_read_as_they_are_or_refused() {
    for (document, read) in documents() {
        let (mut read_as_is, mut refused) = (0, 0);
        for x in [-1.0, 0.0, 1e-310, 7.5, 1e300, -1e300] {
            for changed in tampered(&document, &|_| x.into()) {
                match read(changed.clone()) {
                    Ok(again) => {
                        // −1.0 may be written for −1.
                        assert_eq!(again, changed);
                        read_as_is += 1;
                    }
                    Err(error) => {
                        let told = ["not allowed", "invalid type", "invalid value", "below the"];
                        assert!(told.iter().any(|told| error.contains(told)), "{error}");
                        refused += 1;
                    }
                }
            }
        }
        assert!(read_as_is > 0, "{document}: {refused} refused");
    }
}

/// Every number that a JSON text holds, one at a time, as another.
fn tampered(value: &Value, change: &dyn Fn(f64) -> Value) -> Vec<Value> {
    match value {
        Value::Number(number) => vec![change(number.as_f64().unwrap())],
        Value::Array(items) => (0..items.len())
            .flat_map(|i| {
                tampered(&items[i], change).into_iter().map(move |item| {
                    let mut items = items.clone();
                    items[i] = item;
                    Value::Array(items)
                })
            })
            .collect(),
        Value::Object(fields) => fields
            .iter()
            .flat_map(|(key, field)| {
                tampered(field, change).into_iter().map(move |field| {
                    let mut fields = fields.clone();
                    fields[key] = field;
                    Value::Object(fields)
                })
            })
            .collect(),
        _ => Vec::new(),
    }
}

#[test]
fn what_follows_from_a_system_is_written() {
    let cycles = cycles();
    for kind in [
        CycleKind::PureSlip,
        CycleKind::StickSlip,
        CycleKind::Overshoot,
        CycleKind::Crossing,
    ] {
        let count = cycles.iter().filter(|cycle| cycle.kind() == kind).count();
        assert!(count >= 2, "{kind}: {count}");
    }
    assert!(cycles.iter().any(|cycle| !cycle.is_stable()));
    for cycle in &cycles {
        let written = serde_json::to_value(cycle).unwrap();
        let energy = cycle.energy();
        for (pointer, number) in [
            ("/multiplier", cycle.multiplier()),
            ("/period", cycle.period()),
            ("/stick_duration", cycle.stick_duration()),
            ("/amplitude", cycle.amplitude()),
            ("/mean_displacement", cycle.mean_displacement()),
            ("/max_velocity", cycle.max_velocity()),
            ("/min_velocity", cycle.min_velocity()),
            ("/energy/drive_work", energy.drive_work),
            ("/energy/belt_work", energy.belt_work),
            ("/energy/damper_loss", energy.damper_loss),
            ("/energy/friction_loss", energy.friction_loss),
            ("/state/displacement", cycle.state().displacement),
            ("/state/velocity", cycle.state().velocity),
        ] {
            assert_eq!(written.pointer(pointer), Some(&number.into()), "{pointer}");
        }
        assert_eq!(written["kind"], serde_json::to_value(cycle.kind()).unwrap());
        // Its events can be read, and so can its start: the motion is made again from them.
        let events: Vec<Event> = serde_json::from_value(written["events"].clone()).unwrap();
        assert_eq!(events, cycle.trajectory().events());
        let start: State = serde_json::from_value(written["state"].clone()).unwrap();
        assert_eq!(start, cycle.state());
    }

    let system = polynomial(0.3, 0.05, 1.0);
    let points = bifurcation::diagram(&system, (0..60).map(|i| 0.01 * f64::from(i)));
    for point in points {
        let point = point.unwrap();
        let written = serde_json::to_value(&point).unwrap();
        assert_eq!(written["belt_velocity"], point.belt_velocity);
        let equilibrium = &written["equilibrium"];
        assert_eq!(equilibrium.is_null(), point.belt_velocity == 0.0);
        if let Some(expected) = point.equilibrium {
            assert_eq!(equilibrium["displacement"], expected.displacement);
            assert_eq!(equilibrium["effective_damping"], -expected.jacobian[(1, 1)]);
            let stability: Stability =
                serde_json::from_value(equilibrium["stability"].clone()).unwrap();
            assert_eq!(stability, expected.stability);
        }
        let set = written["cycles"]["cycles"].as_array().unwrap();
        assert_eq!(set.len(), point.cycles.len());
    }

    let flat = MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), 0.2).unwrap();
    let written = serde_json::to_value(limit_cycle::find(&flat).unwrap()).unwrap();
    assert_eq!(written["continuum"]["max_amplitude"], 0.2);
    assert_eq!(written["unresolved"], serde_json::json!([]));
    // JSON has no ∞.
    let max_amplitude = f64::INFINITY;
    let written = serde_json::to_value(Continuum { max_amplitude }).unwrap();
    assert_eq!(written, serde_json::json!({"max_amplitude": null}));
    let hidden = limit_cycle::find(&polynomial(0.3, 0.0, 1e-20)).unwrap();
    let written = serde_json::to_value(&hidden).unwrap();
    assert_eq!(
        written["unresolved"][0]["start"],
        hidden.unresolved()[0].start
    );

    for (attractor, text) in [
        (Attractor::Rest, "rest"),
        (Attractor::Equilibrium, "equilibrium"),
        (Attractor::Continuum, "continuum"),
        (Attractor::Unbounded, "unbounded"),
        (Attractor::Unresolved, "unresolved"),
    ] {
        assert_eq!(serde_json::to_value(attractor).unwrap(), text);
    }
    let attractor = Attractor::Separatrix(cycles[0].clone());
    let written = serde_json::to_value(attractor).unwrap();
    assert_eq!(written["separatrix"]["period"], cycles[0].period());
}

/// Two masses, one contact, drives of every kind.
fn blocks() -> Structure {
    let force = Drive::harmonic(0.1 + 0.2, 1.3, 0.7)
        .and_then(|drive| drive.with_sine(0.2, 2.6)?.with_constant(-0.1))
        .unwrap();
    let belt = Drive::profile(&[(0.0, 0.0), (1.0, 0.2), (3.0, 0.1)]).unwrap();
    let load = Drive::profile(&[(1.0, 1.0), (1.0, 0.0), (2.0, 1.0)]).unwrap();
    let contact = Contact::new(1, table(), load).unwrap().on_belt(belt);
    Structure::new(&[1.0, 1.0 / 3.0])
        .and_then(|s| s.with_spring(0, 1, 0.7)?.with_ground_spring(0, 1.0))
        .and_then(|s| s.with_ground_damper(1, 0.1)?.with_force(0, force))
        .and_then(|s| s.with_contact(contact.with_load_gradient(0, 0.1)?))
        .unwrap()
}

/// A short text cannot ask for matrices that fill the memory.
#[test]
fn structures_of_too_many_masses_are_not_read() {
    let many = |n: usize, number: &str| vec![number; n].join(",");
    let text = format!(r#"{{"masses":[{}]}}"#, many(100_000, "1"));
    refused::<Structure>(
        &text,
        "masses = 100000 is not allowed: at least 1 and at most 4096",
    );
    let text = format!(r#"{{"mass_matrix":[{}]}}"#, many(100_000, "[]"));
    refused::<Structure>(&text, "at most 4096");
}

#[test]
fn structures_there_and_back() {
    let text = there_and_back(&Drive::sine(0.4, 0.7).unwrap());
    assert_eq!(
        text,
        concat!(
            r#"{"constant":0.0,"harmonics":[{"angular_frequency":0.7,"cosine":0.0,"#,
            r#""sine":0.4}],"profiles":[]}"#,
        )
    );
    there_and_back(&Drive::profile(&[(0.0, 1.0), (2.0, 1.0), (2.0, 3.0)]).unwrap());
    let text = there_and_back(&blocks());
    assert!(
        text.contains(r#""stiffness":[[1.7,-0.7],[-0.7,0.7]]"#),
        "{text}"
    );
    there_and_back(&blocks().contacts()[0]);
    let read: Structure = serde_json::from_str(concat!(
        r#"{"masses":[2],"contacts":[{"coordinate":0,"law":{"coulomb":{"#,
        r#""static_coefficient":0.4,"kinetic_coefficient":0.3}},"load":{"constant":5}}]}"#,
    ))
    .unwrap();
    let contact = Contact::new(0, Coulomb::new(0.4, 0.3).unwrap(), 5.0).unwrap();
    let expected = Structure::new(&[2.0]).and_then(|s| s.with_contact(contact));
    assert_eq!(read, expected.unwrap());
}

/// A mass matrix, a joint, a lever, and laws of different kinds.
#[test]
fn joints_and_mass_matrices_there_and_back() {
    let mass = DMatrix::from_row_slice(3, 3, &[2.0, 0.5, 0.0, 0.5, 1.0, 0.1, 0.0, 0.1, 1.0 / 3.0]);
    let coulomb = Coulomb::new(0.4, 0.25).unwrap();
    let dwell = Dwell::hyperbolic(table(), 0.6, 2.0).unwrap();
    let bristles = LuGre::new(coulomb, 1e3, 2.0, 0.1).unwrap();
    let dry = AnyContactLaw::Dry(AnyLaw::from(coulomb));
    let aging = RateState::aging(0.6, 0.01, 0.015, 1e-5, 1e-6).unwrap();
    let two_states = aging.with_second_state(0.004, 1e-4).unwrap();
    let structure = Structure::with_mass_matrix(mass)
        .and_then(|s| s.with_contact(Contact::between(2, 0, coulomb, 3.0)?.on_belt(0.1)))
        .and_then(|s| s.with_contact(Contact::along(&[(1, 0.1 + 0.2), (2, -1.0)], dwell, 1.0)?))
        .and_then(|s| s.with_contact(Contact::new(0, bristles, 1.0)?))
        .and_then(|s| s.with_contact(Contact::new(0, Dahl::new(0.4, 50.0)?, 1.0)?))
        .and_then(|s| s.with_contact(Contact::new(1, dry, 1.0)?))
        .and_then(|s| s.with_contact(Contact::new(1, aging, 1.0)?))
        .and_then(|s| s.with_contact(Contact::new(1, two_states, 1.0)?))
        .unwrap();
    let text = there_and_back(&structure);
    for part in [
        r#"{"mass_matrix":[[2.0,0.5,0.0],[0.5,1.0,0.1],"#,
        r#""coordinate":2,"direction":[[0,-1.0],[2,1.0]],"law":{"coulomb":"#,
        r#""direction":[[1,0.30000000000000004],[2,-1.0]],"law":{"dwell":"#,
        r#"{"coordinate":0,"law":{"lugre":"#,
        r#"{"coordinate":0,"law":{"dahl":"#,
        r#"{"coordinate":1,"law":{"dry":"#,
    ] {
        assert!(text.contains(part), "{part} in {text}");
    }
    let read: Structure = serde_json::from_str(&text).unwrap();
    assert_eq!(read.contacts()[0].coordinate(), 2);
}

#[test]
fn a_users_own_law_is_not_written() {
    struct Own;
    impl FrictionLaw for Own {
        fn static_coefficient(&self) -> f64 {
            0.4
        }
        fn kinetic<S: Scalar>(&self, speed: S) -> S {
            speed.constant(0.3)
        }
    }
    let contact = Contact::new(0, Own, 1.0).unwrap();
    let message = serde_json::to_string(&contact).unwrap_err().to_string();
    assert!(message.contains("a user's own law"), "{message}");
}

#[test]
fn a_users_own_function_of_time_is_not_written() {
    struct Own;
    impl TimeFunction for Own {
        fn value<S: Scalar>(&self, time: S, _: usize) -> S {
            time.sin()
        }
        fn size(&self) -> f64 {
            1.0
        }
        fn timescale(&self, _: usize) -> f64 {
            1.0
        }
    }
    let drive = Drive::function(Own).unwrap();
    let message = serde_json::to_string(&drive).unwrap_err().to_string();
    assert!(
        message.contains("`Drive::with_function` after reading"),
        "{message}"
    );
}

/// A load law is written as a force element; one at an elastic contact, and a gap that nothing
/// closes, are refused.
#[test]
fn load_laws_are_written() {
    let spring = PolynomialSpring::new(&[0.5, 0.25]).unwrap();
    let contact = Contact::new(0, Coulomb::new(0.4, 0.3).unwrap(), 0.0)
        .and_then(|c| c.with_load_law(&[(0, 1.0)], spring))
        .unwrap();
    let text = there_and_back(
        &Structure::new(&[1.0])
            .unwrap()
            .with_contact(contact)
            .unwrap(),
    );
    assert!(
        text.contains(r#""load_laws":[{"direction":[[0,1.0]]"#),
        "{text}"
    );
    let elastic = text.replace(
        r#""load_laws""#,
        r#""tangential_stiffness":1.0,"load_laws""#,
    );
    assert_ne!(elastic, text);
    assert!(serde_json::from_str::<Structure>(&elastic).is_err());
}

/// The factor of a load law that is read may vary: it is one of the drives. With N = 1 + D k x and
/// x = N μ in steady sliding, damping c holds vibration while N |μ'| < c.
#[test]
fn a_load_law_that_is_read_may_vary_in_time() {
    let (k, speed, damping) = (0.5, 0.4, 0.3);
    let law = Exponential::new(0.4, 0.25, 0.5).unwrap();
    let spring = PolynomialSpring::new(&[k]).unwrap();
    let block = Contact::new(0, law, 1.0)
        .and_then(|contact| contact.on_belt(speed).with_load_law(&[(0, 1.0)], spring))
        .and_then(|contact| Structure::new(&[1.0])?.with_contact(contact))
        .and_then(|block| {
            block
                .with_ground_spring(0, 1.0)?
                .with_ground_damper(0, damping)
        })
        .unwrap();
    let with_factor = |factor: Drive| -> Structure {
        let mut text = serde_json::to_value(&block).unwrap();
        text["contacts"][0]["load_laws"][0]["factor"] = serde_json::to_value(factor).unwrap();
        serde_json::from_value(text).unwrap()
    };
    let shaken = with_factor(Drive::harmonic(0.5, 2.0, 0.0).unwrap());
    assert_eq!(shaken.period(), Some(std::f64::consts::PI));

    // D rises from 0 to 4 in 10 units of time.
    let decay = 0.15 * (-(speed / 0.5_f64).powi(2)).exp();
    let (coefficient, slope) = (0.25 + decay, decay * 2.0 * speed / 0.25);
    let limit = (1.0 - slope / damping) / (k * coefficient);
    let rising = with_factor(Drive::profile(&[(0.0, 0.0), (10.0, 4.0)]).unwrap());
    let then = rising.frozen(5.0).unwrap();
    assert_eq!(
        then.contacts()[0].load_laws()[0].factor(),
        &Drive::constant(2.0)
    );
    let changes = rising.stability_changes(0.0..10.0).unwrap();
    assert_eq!(changes.len(), 1, "{changes:?}");
    assert!(!changes[0].becomes_stable);
    // A few roundings, times 1/(1 − slope/damping) = 6.
    assert!(
        (changes[0].time - 2.5 * limit).abs() < 1e-13,
        "{changes:?} {limit}"
    );
}

#[test]
fn what_is_diagonal_is_written_as_masses() {
    let law = Coulomb::new(0.4, 0.3).unwrap();
    let mass = DMatrix::from_row_slice(2, 2, &[1.0, 0.25, 0.25, 3.0]);
    // Named by the coordinate that was given first.
    let lever = Contact::along(&[(1, 0.5), (0, -2.0)], law, 1.0).unwrap();
    let full = Structure::with_mass_matrix(mass)
        .and_then(|s| s.with_contact(Contact::between(1, 0, law, 2.0)?))
        .and_then(|s| {
            s.with_contact(lever)?
                .with_contact(Contact::new(0, law, 1.0)?)
        })
        .unwrap();
    let text = there_and_back(&full);
    for part in [
        r#""mass_matrix":[[1.0,0.25],[0.25,3.0]]"#,
        r#""direction":[[0,-1.0],[1,1.0]]"#,
        r#""direction":[[0,-2.0],[1,0.5]]"#,
    ] {
        assert!(text.contains(part), "{part}: {text}");
    }
    assert_eq!(text.matches("direction").count(), 2, "{text}");
    let read: Structure = serde_json::from_str(&text).unwrap();
    let coordinates = read.contacts().iter().map(Contact::coordinate);
    assert_eq!(coordinates.collect::<Vec<_>>(), [1, 1, 0]);
    // What is diagonal is written as it always was.
    let diagonal = Structure::with_mass_matrix(DMatrix::identity(2, 2)).unwrap();
    let text = there_and_back(&diagonal);
    assert!(text.contains(r#""masses":[1.0,1.0]"#) && !text.contains("matrix"));
    for (text, why) in [
        (r#"{"mass_matrix":[[1,2],[2,1]]}"#, "not positive definite"),
        (r#"{"mass_matrix":[[1,0.5],[0.4,1]]}"#, "not symmetric"),
        (
            r#"{"mass_matrix":[[1,0.5],[0.5]]}"#,
            "numbers in a row of the mass matrix: 1 given",
        ),
        (
            r#"{"mass_matrix":[[1]],"masses":[1]}"#,
            "masses beside a mass matrix",
        ),
    ] {
        refused::<Structure>(text, why);
    }
    let law = r#"{"coulomb":{"static_coefficient":0.4,"kinetic_coefficient":0.3}}"#;
    for direction in ["[[0,0]]", "[[0,1],[0,2]]"] {
        let text = format!(
            r#"{{"coordinate":0,"direction":{direction},"law":{law},"load":{{"constant":1}}}}"#
        );
        refused::<Contact>(&text, "direction");
    }
}

#[test]
fn reading_structures_checks_what_constructors_check() {
    refuse! {
        Structure: r#"{"masses":[1,-1]}"#, "mass 1";
        Structure: r#"{"masses":[]}"#, "masses";
        Structure: r#"{"masses":[1],"stiffness":[[1,2]]}"#,
            "numbers in a row of the stiffness matrix: 2 given";
        Structure: r#"{"masses":[1],"damping":[[1],[2]]}"#, "damping matrix: 2 given";
        Structure: r#"{"masses":[1],"forces":[{},{}]}"#, "forces: 2 given";
        Structure: r#"{"masses":[1],"springs":[]}"#, "springs";
        Drive: r#"{"harmonics":[{"angular_frequency":-1,"cosine":1,"sine":0}]}"#,
            "angular_frequency";
        Drive: r#"{"profiles":[[[0,1],[-1,2]]]}"#, "point 1";
        Drive: r#"{"profiles":[[]]}"#, "points";
    }
    let law = r#"{"coulomb":{"static_coefficient":0.4,"kinetic_coefficient":0.3}}"#;
    let contact =
        |load: &str| format!(r#"{{"coordinate":1,"law":{law},"load":{{"constant":{load}}}}}"#);
    refuse! {
        Contact: contact("0"), "load";
        Structure: format!(r#"{{"masses":[1],"contacts":[{}]}}"#, contact("1")), "no coordinate 1";
    }
}

/// What follows from a structure is written for other programs.
#[test]
fn samples_orbits_branches_and_sweeps_are_written() {
    use stick_slip::orbit::{self, Period};
    let family = |belt: f64| {
        let law = Coulomb::new(0.4, 0.25)?;
        let contact = Contact::new(0, law, 1.0)?.on_belt(belt);
        one_mass([1.0, 0.05, 1.0], 0.0, contact)
    };
    let system = family(0.1).unwrap();
    let start = structure::State::at_rest(1);
    let orbit = orbit::settle(&system, &start, 50.0, Period::Free(7.0)).unwrap();
    let value = serde_json::to_value(&orbit).unwrap();
    names_are_listed(&value);
    assert_eq!(value["period"].as_f64(), Some(orbit.period()));
    assert_eq!(value["is_stable"], true);
    assert_eq!(value["multipliers"], serde_json::json!([[0.0, 0.0]]));
    assert_eq!(value["mean_velocities"], serde_json::json!([0.0]));
    assert_eq!(value["extremes"][0][1].as_f64(), Some(orbit.extremes(0).1));
    assert_eq!(
        value["events"].as_array().unwrap().len(),
        orbit.events().len()
    );
    let heat = &value["energy"]["friction_loss"][0];
    assert_eq!(heat.as_f64(), Some(orbit.energy().friction_loss[0]));

    let branch = orbit::follow(family, 0.1, &orbit, 0.09..0.11).unwrap();
    let value = serde_json::to_value(&branch).unwrap();
    assert_eq!(
        value["points"].as_array().unwrap().len(),
        branch.points.len()
    );
    assert_eq!(value["points"][0]["parameter"], 0.09);
    assert_eq!(value["ends"], serde_json::json!(["range", "range"]));
    let error = stick_slip::Error::AtRest;
    let text = serde_json::json!({"lost": {"parameter": 0.2, "error": error.to_string()}});
    let parameter = 0.2;
    let end = orbit::BranchEnd::Lost { parameter, error };
    assert_eq!(serde_json::to_value(end).unwrap(), text);
    let end = orbit::BranchEnd::Birth { parameter };
    names_are_listed(&serde_json::to_value(end).unwrap());
    let kind = orbit::BifurcationKind::NeimarkSacker;
    assert_eq!(serde_json::to_value(kind).unwrap(), "neimark_sacker");

    let sweep = orbit::sweep(family, &[0.1, 0.101], &start).unwrap();
    let value = serde_json::to_value(&sweep).unwrap();
    assert_eq!(value["up"][1]["attractor"]["kind"], "stick_slip");
    assert!(value["up"][1]["attractor"]["orbit"]["period"].is_f64());
    assert!(value["down"][0]["error"].is_null() && value["stopped"].is_null());

    let motion = system.simulate(start, 2.0).unwrap();
    let samples: Vec<_> = system.samples(&motion, 0.5).unwrap().collect();
    let value = serde_json::to_value(&samples).unwrap();
    names_are_listed(&value);
    let state = samples[2].state.clone();
    let carried = system.carried(1.0, &state).unwrap();
    let mechanisms = system.mechanisms(1.0, &state).unwrap();
    names_are_listed(&serde_json::to_value((carried, mechanisms)).unwrap());
    assert_eq!(value.as_array().unwrap().len(), 5);
    assert_eq!(value[2]["time"], 1.0);
    assert_eq!(value[2]["loads"], serde_json::json!([1.0]));
    assert_eq!(
        value[2]["state"]["velocities"][0].as_f64(),
        Some(samples[2].state.velocities[0])
    );
}

/// Stops, and the events of a motion that closes one.
#[test]
fn stops_there_and_back() {
    let stop = Stop::above(1, 0.5, 0.25)
        .and_then(|stop| stop.with_contact_stiffness(40.0, 1.5))
        .unwrap();
    let plain = r#"{"direction":[[1,-1.0]],"gap":0.5,"restitution":0.25,"#.to_owned();
    let stiff = format!(r#"{plain}"contact_stiffness":[40.0,1.5]"#);
    there_and_back! {
        stop => format!("{stiff}}}");
        stop.clone().adhesive() => format!(r#"{stiff},"adhesive":true}}"#);
    }
    let structure = Structure::new(&[1.0, 2.0])
        .and_then(|s| s.with_stop(stop))
        .unwrap();
    let text = there_and_back(&structure);
    assert!(text.contains(r#""stops":[{"#), "{text}");
    let start = structure::State::new(&[0.0, 0.0], &[0.0, 1.0]);
    let events = structure.simulate(start, 1.0).unwrap().events().to_vec();
    let text = there_and_back(&events);
    assert!(
        text.contains(r#""element":{"stop":0},"kind":"close""#),
        "{text}"
    );
    refuse! {
        Stop: format!(r#"{plain}"contact_stiffness":[-1,0]}}"#), "stiffness > 0";
        Stop: r#"{"direction":[[0,1]],"gap":1,"restitution":2}"#, "0 ≤ restitution ≤ 1";
        Structure: r#"{"masses":[1],"stops":[{"direction":[[0,1]],"gap":1}]}"#, "stop 0 is rigid";
    }
}
