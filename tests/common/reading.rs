//! Systems of the reference files.

use serde_json::Value;
use stick_slip::nalgebra::DMatrix;
use stick_slip::structure::State;
use stick_slip::{
    AnyContactLaw, AnyLaw, Contact, Coulomb, Directional, Drive, Dwell, Error, Exponential,
    Freewheel, FrictionLaw, LuGre, Polynomial, RateState, Rational, Scalar, Stop, Structure,
};

use crate::forces::element;
use crate::{json, list, number, text};

pub fn cases(file: &str) -> Vec<Value> {
    list(&json(file)["cases"]).to_vec()
}

/// Decimal strings as numbers.
pub fn numbers(value: &Value) -> Vec<f64> {
    list(value).iter().map(number).collect()
}

/// A decimal string, or the parameter of the case.
fn number_or(value: &Value, parameter: f64) -> f64 {
    match text(value) {
        "PARAM" => parameter,
        "-PARAM" => -parameter,
        _ => number(value),
    }
}

pub fn drive(value: &Value, parameter: f64) -> Drive {
    let number = |value: &Value| number_or(value, parameter);
    match text(&value["type"]) {
        "const" => number(&value["value"]).into(),
        "fourier" => {
            let mut sum = Drive::constant(number(&value["a0"]));
            for term in list(&value["terms"]) {
                let omega = number(&term["omega"]);
                sum = sum
                    .with_harmonic(number(&term["a"]), omega, 0.0)
                    .and_then(|sum| sum.with_sine(number(&term["b"]), omega))
                    .unwrap();
            }
            sum
        }
        "pwl" => {
            let points = std::iter::zip(numbers(&value["t"]), numbers(&value["values"]));
            Drive::profile(&points.collect::<Vec<_>>()).unwrap()
        }
        "steps" => {
            let (times, values) = (numbers(&value["t"]), numbers(&value["values"]));
            let mut points = vec![(times[0], values[0])];
            for (k, &time) in times.iter().enumerate().skip(1) {
                points.extend([(time, values[k - 1]), (time, values[k])]);
            }
            Drive::profile(&points).unwrap()
        }
        other => panic!("unknown drive {other}"),
    }
}

pub fn law(contact: &Value, parameter: f64) -> AnyLaw {
    if contact.get("kt").is_some() {
        let coefficient = number(&contact["mu"]);
        return Coulomb::new(coefficient, coefficient).unwrap().into();
    }
    let value = |name: &str| number_or(&contact["law_params"][name], parameter);
    match text(&contact["law"]) {
        "poly" => Polynomial::new(value("mus"), value("mum"), value("vm"))
            .unwrap()
            .into(),
        "exp" => Exponential::new(value("mus"), value("muk"), value("vs"))
            .unwrap()
            .into(),
        "coulomb" => Coulomb::new(value("mus"), value("muk")).unwrap().into(),
        // (μ_s − δ)/(1 + γs) + δ + ηs²
        "rational" => Rational::new(value("mus"), value("gamma"))
            .and_then(|law| law.with_offset(value("delta")))
            .and_then(|law| law.with_quadratic(value("eta")))
            .unwrap()
            .into(),
        other => panic!("unknown law {other}"),
    }
}

/// The system of a case, with a value of its parameter if it has one.
pub fn structure(system: &Value, parameter: f64) -> Structure {
    with_laws(
        system,
        |contact, direction, load| {
            let params = &contact["law_params"];
            match contact["law"].as_str() {
                Some("directional") => {
                    let side = |name: &str| {
                        let value = |which: &str| number(&params[name][which]);
                        Coulomb::new(value("mus"), value("muk"))
                    };
                    let law = Directional::new(side("forward")?, side("backward")?)?;
                    Contact::along(direction, law, load)
                }
                Some("freewheel") => {
                    let drag = number(&params["drag"]);
                    let law = Freewheel::new(Coulomb::new(drag, drag)?)?;
                    Contact::along(direction, law, load)
                }
                Some("rate_state") => Contact::along(direction, rate_state(contact), load),
                _ => Contact::along(direction, law(contact, parameter), load),
            }
        },
        parameter,
    )
}

/// A state of a case of rate-and-state friction. A contact without a state variable has a memory
/// without use.
pub fn remembered(case: &Value, value: &Value) -> State {
    let mut phi = numbers(&value["phi"]).into_iter();
    let contacts = list(&case["system"]["contacts"]).iter();
    let memory = contacts.map(|contact| match text(&contact["law"]) {
        "rate_state" => phi.next().unwrap(),
        _ => 0.0,
    });
    let memory: Vec<f64> = memory.collect();
    State::new(&numbers(&value["q"]), &numbers(&value["v"])).with_memory(&memory)
}

/// The system of a case whose contacts remember.
pub fn remembering(system: &Value) -> Structure {
    let made = |contact: &Value, direction: &[(usize, f64)], load| {
        Contact::along(direction, contact_law(contact), load)
    };
    with_laws(system, made, f64::NAN)
}

fn with_laws(
    system: &Value,
    contact_of: impl Fn(&Value, &[(usize, f64)], Drive) -> Result<Contact, Error>,
    parameter: f64,
) -> Structure {
    let matrix = |name: &str| {
        let rows: Vec<Vec<f64>> = list(&system[name]).iter().map(numbers).collect();
        DMatrix::from_fn(rows.len(), rows.len(), |i, j| rows[i][j])
    };
    let masses = if system["mass"].is_null() {
        Structure::new(&numbers(&system["m"]))
    } else {
        Structure::with_mass_matrix(matrix("mass"))
    };
    let mut structure = masses
        .and_then(|structure| structure.with_stiffness(matrix("K")))
        .and_then(|structure| structure.with_damping(matrix("C")))
        .unwrap();
    for (i, force) in list(&system["f"]).iter().enumerate() {
        structure = structure.with_force(i, drive(force, parameter)).unwrap();
    }
    for (i, contact) in list(&system["contacts"]).iter().enumerate() {
        if contact.is_null() {
            continue;
        }
        let load: Drive = match &contact["N0"] {
            load @ Value::Object(_) => drive(load, parameter),
            load => number(load).into(),
        };
        let direction: Vec<(usize, f64)> = match &contact["direction"] {
            Value::Null => vec![(i, 1.0)],
            row => numbers(row).into_iter().enumerate().collect(),
        };
        let mut made = contact_of(contact, &direction, load)
            .unwrap()
            .on_belt(drive(&contact["w"], parameter));
        let gradients = contact.get("n").map(numbers).unwrap_or_default();
        if let Some(stiffness) = contact.get("kt") {
            made = made.with_tangential_stiffness(number(stiffness)).unwrap();
        }
        if let Some(row) = contact.get("reaction") {
            let row: Vec<(usize, f64)> = numbers(row).into_iter().enumerate().collect();
            let (j, d) = row.iter().find(|(_, d)| *d != 0.0).unwrap();
            made = made.with_normal_spring(&row, gradients[*j] / d).unwrap();
        } else {
            for (j, gradient) in gradients.into_iter().enumerate() {
                made = made.with_load_gradient(j, gradient).unwrap();
            }
        }
        structure = structure.with_contact(made).unwrap();
    }
    for force in system.get("forces").map(list).unwrap_or_default() {
        structure = structure.with_element(element(force)).unwrap();
    }
    for given in system.get("kv_stops").map(list).unwrap_or_default() {
        let direction: Vec<_> = numbers(&given["direction"])
            .into_iter()
            .enumerate()
            .collect();
        let stop = Stop::along(&direction, number(&given["gap"]), 0.0)
            .and_then(|stop| stop.with_contact_stiffness(number(&given["k"]), number(&given["c"])))
            .unwrap();
        let stop = match text(&given["kind"]) {
            "max" => stop,
            "adhesive" => stop.adhesive(),
            other => panic!("unknown stop {other}"),
        };
        structure = structure.with_stop(stop).unwrap();
    }
    structure
}

/// Any law, with a static coefficient of its own if it has to be.
#[derive(Debug, Clone)]
pub struct Raised {
    pub law: AnyLaw,
    pub static_coefficient: f64,
}

impl FrictionLaw for Raised {
    fn static_coefficient(&self) -> f64 {
        self.static_coefficient
    }
    #[inline(always)]
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        self.law.kinetic(speed)
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        FrictionLaw::breakpoints(&self.law)
    }
    #[inline(always)]
    fn kinetic_on<S: Scalar>(&self, piece: usize, speed: S) -> S {
        self.law.kinetic_on(piece, speed)
    }
}

impl<L: Into<AnyLaw>> From<L> for Raised {
    fn from(law: L) -> Self {
        let law = law.into();
        let static_coefficient = law.static_coefficient();
        Self {
            law,
            static_coefficient,
        }
    }
}

/// A rate-and-state law.
pub fn rate_state(contact: &Value) -> RateState {
    let parameters = &contact["law_params"];
    let [f0, a, b, d_c, v0] = ["f0", "a", "b", "dc", "v0"].map(|name| number(&parameters[name]));
    let law = match text(&parameters["evolution"]) {
        "aging" => RateState::aging(f0, a, b, d_c, v0),
        _ => RateState::slip(f0, a, b, d_c, v0),
    };
    law.unwrap()
}

fn contact_law(contact: &Value) -> AnyContactLaw<Raised> {
    if text(&contact["law"]) == "rate_state" {
        return rate_state(contact).into();
    }
    let (dwell, bristle) = (&contact["dwell"], &contact["bristle"]);
    let value = |name: &str| number(&dwell[name]);
    if !dwell.is_null() {
        let law = match text(&contact["law"]) {
            "coulomb" => {
                let kinetic = number(&contact["law_params"]["muk"]);
                Coulomb::new(kinetic, kinetic).unwrap().into()
            }
            _ => law(contact, f64::NAN),
        };
        let raised = Raised {
            law,
            static_coefficient: value("mu_0"),
        };
        let time = value("theta_c");
        let made = match text(&dwell["form"]) {
            "exponential" => Dwell::exponential(raised, value("mu_inf"), time),
            "hyperbolic" => Dwell::hyperbolic(raised, value("mu_inf"), time),
            _ => Dwell::logarithmic(raised, value("B"), time),
        };
        return made.unwrap().into();
    }
    let raised = Raised::from(law(contact, f64::NAN));
    if bristle.is_null() {
        return AnyContactLaw::Dry(raised);
    }
    let [stiffness, damping, viscous] =
        ["sigma0", "sigma1", "sigma2"].map(|name| number(&bristle[name]));
    LuGre::new(raised, stiffness, damping, viscous)
        .unwrap()
        .into()
}
