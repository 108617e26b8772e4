//! Force elements: those of the reference files, and random ones.

use serde_json::Value;
use stick_slip::{
    Backlash, Drive, ForceElement, ForceField, Pendulum, PolynomialSpring, Scalar, SnapThrough,
    VanDerPol,
};

use crate::any_force::{AnyForce, CubicDamper, Magnet, Toda};
use crate::reading::{drive, numbers};
use crate::{Random, list, number, text};

/// F_i = k (x_0² + x_1²) x_i.
#[derive(Debug, Clone, Copy)]
pub struct QuarticPair(pub f64);

impl ForceField for QuarticPair {
    type Coordinates<S: Scalar> = [S; 2];

    fn forces<S: Scalar>(&self, [x, y]: [S; 2], _: [S; 2]) -> [S; 2] {
        let stiffness = (x.square() + y.square()) * self.0;
        [stiffness * x, stiffness * y]
    }

    fn potential<S: Scalar>(&self, [x, y]: [S; 2]) -> Option<S> {
        Some((x.square() + y.square()).square() * (0.25 * self.0))
    }
}

/// An element of any kind on some of n coordinates.
pub fn random(random: &mut Random, n: usize) -> ForceElement {
    let one = |random: &mut Random| (random.bits() % n as u64) as usize;
    let direction = |random: &mut Random| -> Vec<(usize, f64)> {
        match random.bits() % 3 {
            0 => vec![(one(random), random.sign())],
            _ => (0..n).map(|j| (j, random.uniform(-1.0, 1.0))).collect(),
        }
    };
    let kind = (random.bits() % (Random::FORCES as u64 + 1)) as usize;
    let element = if kind == Random::FORCES {
        let rows = [0, 1].map(|_| direction(random));
        let field = QuarticPair(random.uniform(0.2, 1.5));
        ForceElement::field(&[&rows[0], &rows[1]], field).unwrap()
    } else {
        let law = random.any_force(kind, 1.5, 1.0);
        law.element(&direction(random))
    };
    if !random.bits().is_multiple_of(3) {
        return element;
    }
    let factor = Drive::harmonic(random.uniform(0.1, 0.5), random.uniform(0.5, 2.0), 0.3);
    let factor = factor.and_then(|factor| factor.with_constant(1.0));
    element.with_factor(factor.unwrap()).unwrap()
}

/// A force element of a file.
pub fn element(given: &Value) -> ForceElement {
    let value = |name: &str| number(&given["law_params"][name]);
    let directions: Vec<Vec<(usize, f64)>> = list(&given["directions"])
        .iter()
        .map(|row| numbers(row).into_iter().enumerate().collect())
        .collect();
    let law = match text(&given["law"]) {
        "polynomial" => {
            let coefficients = numbers(&given["law_params"]["c"]);
            AnyForce::Polynomial(PolynomialSpring::new(&coefficients).unwrap())
        }
        "sine" => AnyForce::Pendulum(Pendulum::new(value("A"), value("l")).unwrap()),
        "snap" => {
            let law = SnapThrough::new(value("k"), value("L"), value("l"));
            AnyForce::SnapThrough(law.unwrap())
        }
        "exponential" => AnyForce::Toda(Toda {
            force: value("A"),
            length: value("l"),
        }),
        "van_der_pol" => AnyForce::VanDerPol(VanDerPol::new(value("a"), value("b")).unwrap()),
        "cubic_damper" => AnyForce::CubicDamper(CubicDamper(value("c"))),
        "magnet" => AnyForce::Magnet(Magnet {
            strength: value("A"),
            gap: value("g"),
        }),
        "gap" => AnyForce::Backlash(Backlash::new(value("k"), value("g")).unwrap()),
        "quartic_pair" => {
            let rows: Vec<_> = directions.iter().map(Vec::as_slice).collect();
            let element = ForceElement::field(&rows, QuarticPair(value("k4"))).unwrap();
            return with_factor(element, given);
        }
        other => panic!("unknown force {other}"),
    };
    with_factor(law.element(&directions[0]), given)
}

fn with_factor(element: ForceElement, given: &Value) -> ForceElement {
    match given.get("factor") {
        Some(factor) => element.with_factor(drive(factor, f64::NAN)).unwrap(),
        None => element,
    }
}
