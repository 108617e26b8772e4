//! Writing and reading back, and reading what a constructor would refuse (feature `serde`).

use serde::{Serialize, de::DeserializeOwned};
use stick_slip::bifurcation::{self, Criticality, DiagramPoint};
use stick_slip::limit_cycle::{Attractor, Continuum};
use stick_slip::{
    AnyLaw, Coulomb, CycleKind, CycleSet, Direction, EnergyBudget, Equilibrium, Event, EventKind,
    Exponential, LimitCycle, MassOnBelt, Mode, Physical, Polynomial, Rational, Scaled, Scaling,
    Stability, State, Stribeck, Tabulated, limit_cycle,
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

fn polynomial(belt_velocity: f64, damping: f64, load: f64) -> MassOnBelt<Polynomial> {
    MassOnBelt::new(Polynomial::new(0.38, 0.22, 0.55).unwrap(), belt_velocity)
        .and_then(|system| system.with_damping(damping))
        .and_then(|system| system.with_load(load))
        .unwrap()
}

/// Cycles of every kind, stable and unstable, on belts of both directions.
fn cycles() -> Vec<LimitCycle> {
    let exponential = Exponential::new(0.6, 0.3, 0.4).unwrap();
    let bistable = MassOnBelt::new(exponential, 1.0)
        .and_then(|system| system.with_damping(0.01))
        .unwrap();
    let table = Tabulated::new([
        (0.0, 0.4),
        (0.1, 0.33),
        (0.3, 0.27),
        (0.6, 0.25),
        (1.0, 0.26),
    ]);
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
fn cycles_there_and_back() {
    let cycles = cycles();
    for kind in [
        CycleKind::PureSlip,
        CycleKind::StickSlip,
        CycleKind::Overshoot,
        CycleKind::Crossing,
    ] {
        let count = cycles.iter().filter(|cycle| cycle.kind() == kind).count();
        assert!(count >= 2, "{kind}: {count}");
        there_and_back(&kind);
    }
    assert!(cycles.iter().any(|cycle| !cycle.is_stable()));
    for cycle in &cycles {
        let text = there_and_back(cycle);
        // Its numbers are there for other programs.
        let read: serde_json::Value = serde_json::from_str(&text).unwrap();
        assert_eq!(read["period"], cycle.period());
        assert_eq!(read["amplitude"], cycle.amplitude());
        assert_eq!(read["multiplier"], cycle.multiplier());
    }
    there_and_back::<EnergyBudget>(&cycles[0].energy());
    there_and_back(&Attractor::Rest);
    there_and_back(&Attractor::Cycle(cycles[0].clone()));
    there_and_back(&Criticality::Subcritical);
    let max_amplitude = 0.2;
    there_and_back(&Continuum { max_amplitude });
    let max_amplitude = f64::INFINITY;
    there_and_back(&Continuum { max_amplitude });
}

#[test]
fn diagrams_there_and_back() {
    let velocities: Vec<f64> = (0..60).map(|i| 0.01 * f64::from(i)).collect();
    let system = polynomial(0.3, 0.05, 1.0);
    let points: Vec<DiagramPoint> = bifurcation::diagram(&system, velocities)
        .collect::<Result<_, _>>()
        .unwrap();
    there_and_back(&points);
    let flat = MassOnBelt::new(Coulomb::new(0.4, 0.25).unwrap(), 0.2).unwrap();
    there_and_back::<CycleSet>(&limit_cycle::find(&flat).unwrap());
    let hidden = limit_cycle::find(&polynomial(0.3, 0.0, 1e-20)).unwrap();
    assert!(!hidden.unresolved().is_empty());
    there_and_back::<CycleSet>(&hidden);
    for v_b in [0.01, 0.2, 0.55, 3.0] {
        there_and_back::<Equilibrium>(&polynomial(v_b, 0.3, 5.0).equilibrium().unwrap());
    }
    there_and_back(&Stability::Center);
    refused::<Equilibrium>(
        r#"{"displacement":0.3,"effective_damping":0.1,"stability":"UnstableFocus"}"#,
        "effective_damping",
    );
}

/// Every number that a JSON text holds, one at a time, as another.
fn tampered(
    value: &serde_json::Value,
    change: &dyn Fn(f64) -> serde_json::Value,
) -> Vec<serde_json::Value> {
    use serde_json::Value;
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
fn cycles_that_are_none_are_refused() {
    let read = serde_json::from_value::<LimitCycle>;
    for cycle in cycles() {
        let written = serde_json::to_value(&cycle).unwrap();
        let kind = cycle.kind();
        // A number replaced by nothing is no number.
        for wrong in tampered(&written, &|_| serde_json::Value::Null) {
            assert!(read(wrong).is_err(), "{kind}");
        }
        // A number replaced by one that is far from it: refused, unless the motion hardly changes,
        // as by the last terms of a short step.
        let changed = tampered(&written, &|x| (2.0 * x + 0.7).into());
        let count = changed.len();
        let mut accepted = 0;
        for wrong in changed {
            if let Ok(other) = read(wrong) {
                accepted += 1;
                assert!((other.period() - cycle.period()).abs() < 1e-6);
                assert!((other.amplitude() - cycle.amplitude()).abs() < 1e-6);
                assert_eq!(other.is_stable(), cycle.is_stable());
                let [a, b] = [&other, &cycle].map(|cycle| cycle.energy().damper_loss);
                assert!((a - b).abs() < 1e-6);
                let [a, b] = [other.trajectory(), cycle.trajectory()];
                for ((_, a), (_, b)) in std::iter::zip(a.sample(1000), b.sample(1000)) {
                    assert!((a.displacement - b.displacement).abs() < 1e-6);
                    assert!((a.velocity - b.velocity).abs() < 1e-6);
                }
            }
        }
        println!("{kind}: {accepted} of {count} changes accepted");
        assert!(accepted < count);

        let with = |key: &str, value: serde_json::Value| {
            let mut wrong = written.clone();
            wrong[key] = value;
            read(wrong).unwrap_err().to_string()
        };
        assert!(with("multiplier", (cycle.multiplier() + 0.01).into()).contains("multiplier"));
        assert!(with("period", (cycle.period() * 1.001).into()).contains("period"));
        assert!(with("belt_velocity", 0.0.into()).contains("belt_velocity"));
        assert!(with("damping", (-0.1).into()).contains("damping"));
        assert!(with("steps", serde_json::json!([])).contains("steps"));
        assert!(with("colour", 1.into()).contains("unknown field"));
        let other = if kind == CycleKind::PureSlip {
            "StickSlip"
        } else {
            "PureSlip"
        };
        assert!(with("kind", other.into()).contains("kind"));
        // One step less: it no longer closes.
        let steps = written["steps"].as_array().unwrap();
        if steps.len() > 1 {
            let error = with("steps", steps[1..].into());
            assert!(error.contains("is not allowed"), "{error}");
        }
    }
    // Cycles lie one inside the other.
    let cycles = cycles();
    let set = |order: [usize; 2]| {
        let cycles = order.map(|i| serde_json::to_value(&cycles[i]).unwrap());
        serde_json::json!({"cycles": cycles, "continuum": null, "unresolved": []})
    };
    let [inner, outer] = if cycles[0].amplitude() < cycles[1].amplitude() {
        [0, 1]
    } else {
        [1, 0]
    };
    assert!(serde_json::from_value::<CycleSet>(set([inner, outer])).is_ok());
    let error = serde_json::from_value::<CycleSet>(set([outer, inner])).unwrap_err();
    assert!(error.to_string().contains("ascending"), "{error}");
}

/// Each change is consistent in itself; only where two steps meet does it show.
#[test]
fn steps_that_do_not_meet_are_refused() {
    let cycle = limit_cycle::stick_slip(&polynomial(0.3, 0.02, 1.0)).unwrap();
    let written = serde_json::to_value(cycle.unwrap()).unwrap();
    let refusal = |change: &dyn Fn(&mut Vec<serde_json::Value>)| {
        let mut wrong = written.clone();
        change(wrong["steps"].as_array_mut().unwrap());
        let read = serde_json::from_value::<LimitCycle>(wrong);
        read.unwrap_err().to_string()
    };
    let add = |number: &mut serde_json::Value, change: f64| {
        *number = (number.as_f64().unwrap() + change).into();
    };
    // The second step starts faster than the first ends, at the same place.
    let error = refusal(&|steps| {
        assert!(steps[1]["duration"].as_f64().unwrap() < 1.0);
        add(&mut steps[1]["state"]["velocity"], 1e-6);
        add(&mut steps[1]["speed"][0], -1e-6);
    });
    assert!(error.contains("the end of the step before"), "{error}");
    // A release, as at the end of stick, between two steps of one slip phase.
    let error = refusal(&|steps| {
        steps[0]["event"] = steps[steps.len() - 1]["event"].clone();
        steps[0]["event"]["time"] = steps[0]["duration"].clone();
        steps[0]["event"]["state"] = steps[1]["state"].clone();
    });
    assert!(error.contains("an event where the mode changes"), "{error}");
}

/// What a cycle holds twice may differ by 1e-8 of the motion's size, and not by more: of its
/// period; of |u| + amplitude + |v_b|; and of the square of that times the period.
#[test]
fn numbers_of_a_cycle_agree_within_a_hundred_millionth() {
    let read = serde_json::from_value::<LimitCycle>;
    let scaled = [(0.013, 0.2), (4.0, 150.0)].map(|(v_b, load)| {
        let coulomb = Coulomb::new(0.4, 0.25).unwrap();
        let system = MassOnBelt::new(coulomb, v_b)
            .and_then(|system| system.with_load(load))
            .and_then(|system| system.with_damping(0.01));
        limit_cycle::stick_slip(&system.unwrap()).unwrap().unwrap()
    });
    for cycle in cycles().into_iter().step_by(3).chain(scaled) {
        let written = serde_json::to_value(&cycle).unwrap();
        let (v_b, period) = (
            written["belt_velocity"].as_f64().unwrap().abs(),
            cycle.period(),
        );
        let size = cycle.max_displacement().abs() + cycle.amplitude() + v_b;
        let work = size * size * period;
        // The logarithm of a multiplier, from second derivatives, agrees within a thousandth.
        let logarithm = cycle.multiplier().ln();
        for (part, accepted) in [(0.4, true), (-0.4, true), (2.5, false), (-2.5, false)] {
            if logarithm.is_finite() {
                let mut changed = written.clone();
                let wrong = logarithm + part * 1e-3 * (1.0 + logarithm.abs());
                changed["multiplier"] = wrong.exp().into();
                assert_eq!(read(changed).is_ok(), accepted, "{logarithm} {part}");
            }
        }
        let event = cycle.trajectory().events().first().map(|event| event.time);
        let speed = written["steps"][0]["state"]["velocity"]
            .as_f64()
            .unwrap()
            .abs()
            + v_b;
        let ended = written["steps"].as_array().unwrap();
        let ended = ended.iter().position(|step| !step["event"].is_null());
        let ended = format!("/steps/{}/event/time", ended.unwrap_or(0));
        for (pointer, size) in [
            ("/period", period),
            ("/stick_duration", period),
            ("/amplitude", size),
            ("/mean_displacement", size),
            ("/max_velocity", size),
            ("/min_velocity", size),
            ("/energy/drive_work", work),
            ("/energy/belt_work", work),
            ("/energy/damper_loss", work),
            ("/energy/friction_loss", work),
            ("/steps/0/state/displacement", size),
            ("/steps/0/state/velocity", speed),
            (&ended, event.unwrap_or(0.0)),
        ] {
            for (part, accepted) in [(0.4, true), (-0.4, true), (2.5, false), (-2.5, false)] {
                let mut changed = written.clone();
                let Some(number) = changed.pointer_mut(pointer) else {
                    assert_eq!(event, None, "{pointer}");
                    continue;
                };
                *number = (number.as_f64().unwrap() + part * 1e-8 * size).into();
                let result = read(changed);
                assert_eq!(
                    result.is_ok(),
                    accepted,
                    "{pointer} {part}: {:?}",
                    result.err()
                );
            }
        }
    }
}
