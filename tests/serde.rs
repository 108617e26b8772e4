//! Writing and reading back, and reading what a constructor would refuse (feature `serde`).

use serde::{Serialize, de::DeserializeOwned};
use stick_slip::{
    AnyLaw, Coulomb, Direction, Event, EventKind, Exponential, MassOnBelt, Mode, Physical,
    Polynomial, Rational, Scaled, Scaling, State, Stribeck, Tabulated,
};

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

fn table() -> Tabulated {
    Tabulated::new([(0.0, 0.4), (0.05, 0.36), (0.15, 0.31), (0.6, 0.25)]).unwrap()
}

fn brake() -> Scaling {
    Scaling::new(Physical {
        mass: 2.0,
        stiffness: 5000.0,
        damping: 4.0,
        normal_force: 20.0,
        belt_velocity: 0.05,
    })
    .unwrap()
}

#[test]
fn laws_there_and_back() {
    let text = there_and_back(&Polynomial::new(0.4, 0.25, 0.1 + 0.2).unwrap());
    // Parameters only, and to the bit.
    assert_eq!(
        text,
        r#"{"static_coefficient":0.4,"minimum_coefficient":0.25,"minimum_velocity":0.30000000000000004}"#
    );
    there_and_back(&Coulomb::new(0.4, 0.25).unwrap());
    there_and_back(&Exponential::new(0.4, 0.25, 0.5).unwrap());
    let stribeck = Stribeck::new(0.4, 0.25, 0.3, 1).unwrap();
    there_and_back(&stribeck.with_viscous_coefficient(0.01).unwrap());
    let rational = Rational::new(0.4, 3.0).unwrap();
    there_and_back(
        &rational
            .with_offset(0.1)
            .unwrap()
            .with_quadratic(0.01)
            .unwrap(),
    );
    there_and_back(&table());
    there_and_back(&table().with_static_coefficient(0.5).unwrap());
    let text = there_and_back(&AnyLaw::from(Coulomb::new(0.4, 0.25).unwrap()));
    assert_eq!(
        text,
        r#"{"coulomb":{"static_coefficient":0.4,"kinetic_coefficient":0.25}}"#
    );
    there_and_back(&AnyLaw::from(table()));
    there_and_back(&brake().law(table()));
}

#[test]
fn the_rest_there_and_back() {
    there_and_back(&brake());
    there_and_back(&brake().with_length(0.1).unwrap());
    there_and_back(&brake().system(AnyLaw::from(table())).unwrap());
    let law = Polynomial::new(0.4, 0.25, 0.5).unwrap();
    let system = MassOnBelt::new(law, -0.2)
        .unwrap()
        .with_damping(0.05)
        .unwrap();
    there_and_back(&system.with_load(2.0).unwrap());
    there_and_back(&State::new(0.1 + 0.2, -1.0 / 3.0));
    there_and_back(&Mode::Stick);
    there_and_back(&Mode::Slip(Direction::Leading));
    let events = system.simulate(State::new(0.0, 0.0), 20.0).unwrap();
    assert!(events.events().len() > 2);
    there_and_back::<Vec<Event>>(&events.events().to_vec());
    there_and_back(&EventKind::Crossing(Direction::Lagging));
}

#[test]
fn what_may_be_left_out() {
    let law: Stribeck = serde_json::from_str(
        r#"{"static_coefficient":0.4,"coulomb_coefficient":0.25,"stribeck_velocity":0.3,"exponent":1}"#,
    )
    .unwrap();
    assert_eq!(law, Stribeck::new(0.4, 0.25, 0.3, 1).unwrap());
    let law: Rational = serde_json::from_str(r#"{"static_coefficient":0.4,"decay":3}"#).unwrap();
    assert_eq!(law, Rational::new(0.4, 3.0).unwrap());
    let system: MassOnBelt<AnyLaw> = serde_json::from_str(
        r#"{"law":{"tabulated":{"points":[[0,0.4],[0.05,0.36],[0.15,0.31],[0.6,0.25]]}},"belt_velocity":0.2}"#,
    )
    .unwrap();
    assert_eq!(system, MassOnBelt::new(table().into(), 0.2).unwrap());
    let scaling: Scaling = serde_json::from_str(
        r#"{"physical":{"mass":2,"stiffness":5000,"damping":4,"normal_force":20,"belt_velocity":0.05}}"#,
    )
    .unwrap();
    assert_eq!(scaling, brake());
}

#[test]
fn reading_checks_what_constructors_check() {
    refused::<Polynomial>(
        r#"{"static_coefficient":0.4,"minimum_coefficient":0.5,"minimum_velocity":0.5}"#,
        "minimum_coefficient = 5e-1 is not allowed",
    );
    refused::<Coulomb>(
        r#"{"static_coefficient":-1,"kinetic_coefficient":0}"#,
        "static_coefficient",
    );
    refused::<Exponential>(
        r#"{"static_coefficient":0.4,"kinetic_coefficient":0.2,"stribeck_velocity":0}"#,
        "stribeck_velocity",
    );
    let stribeck = |exponent: &str| {
        format!(
            r#"{{"static_coefficient":0.4,"coulomb_coefficient":0.2,"stribeck_velocity":0.1,"exponent":{exponent}}}"#
        )
    };
    refused::<Stribeck>(&stribeck("0"), "exponent = 0e0 is not allowed");
    refused::<Stribeck>(&stribeck("0.5"), "invalid type: floating point");
    refused::<AnyLaw>(&format!(r#"{{"stribeck":{}}}"#, stribeck("0")), "exponent");
    refused::<Rational>(
        r#"{"static_coefficient":0.4,"decay":1,"offset":0.5}"#,
        "offset",
    );
    refused::<Rational>(
        r#"{"static_coefficient":0.4,"decay":1,"ofset":0.1}"#,
        "unknown field",
    );
    refused::<Tabulated>(r#"{"points":[[0,0.4],[0,0.3]]}"#, "speed");
    refused::<Tabulated>(
        r#"{"points":[[0,0.4],[1,0.3]],"static_coefficient":0.3}"#,
        "static_coefficient",
    );
    let law = r#"{"static_coefficient":0.4,"kinetic_coefficient":0.25}"#;
    refused::<MassOnBelt<Coulomb>>(
        &format!(r#"{{"law":{law},"belt_velocity":1,"load":0}}"#),
        "load",
    );
    refused::<MassOnBelt<Coulomb>>(
        &format!(r#"{{"law":{law},"belt_velocity":1,"damping":-1}}"#),
        "damping",
    );
    refused::<Scaled<Coulomb>>(
        &format!(r#"{{"law":{law},"velocity_unit":0}}"#),
        "velocity_unit",
    );
    refused::<Scaling>(
        r#"{"physical":{"mass":0,"stiffness":5000,"damping":4,"normal_force":20,"belt_velocity":0.05}}"#,
        "mass",
    );
}
