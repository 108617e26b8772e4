//! The laws of the force elements of the reference files.

use serde_json::Value;
use stick_slip::{Drive, ForceElement, ForceField, ForceLaw, Scalar};

use crate::reading::{drive, numbers};
use crate::{Random, list, number, text};

/// A law of one direction.
#[derive(Debug, Clone)]
pub enum Force {
    /// Σ c_i x^i from i = 1 on.
    Polynomial(Vec<f64>),
    /// A sin(x/l).
    Sine([f64; 2]),
    /// k x (1 − L/√(x² + l²)).
    Snap([f64; 3]),
    /// A (e^{x/l} − 1).
    Exponential([f64; 2]),
    /// (b x² − a) y.
    VanDerPol([f64; 2]),
    /// c y³.
    CubicDamper(f64),
    /// −A/(g − x)².
    Magnet([f64; 2]),
    /// k times the part of x beyond ±g.
    Gap([f64; 2]),
}

impl ForceLaw for Force {
    fn force<S: Scalar>(&self, x: S, y: S, piece: usize) -> S {
        match self {
            Self::Polynomial(c) => {
                let terms = c.iter().rev();
                terms.fold(x.constant(0.0), |sum, c| (sum + *c) * x)
            }
            Self::Sine([a, l]) => (x / *l).sin() * *a,
            Self::Snap([k, length, l]) => {
                let stretched = (x.square() + l * l).sqrt();
                (-stretched.recip() * *length + 1.0) * x * *k
            }
            Self::Exponential([a, l]) => ((x / *l).exp() - 1.0) * *a,
            Self::VanDerPol([a, b]) => (x.square() * *b - *a) * y,
            Self::CubicDamper(c) => y.powi(3) * *c,
            Self::Magnet([a, g]) => -(-x + *g).square().recip() * *a,
            Self::Gap([k, g]) => match piece {
                0 => (x + *g) * *k,
                1 => x.constant(0.0),
                _ => (x - *g) * *k,
            },
        }
    }

    fn potential<S: Scalar>(&self, x: S, piece: usize) -> Option<S> {
        Some(match self {
            Self::Polynomial(c) => {
                let terms = c.iter().enumerate().rev();
                let sum = terms.fold(x.constant(0.0), |sum, (i, c)| sum * x + *c / (i + 2) as f64);
                sum * x.square()
            }
            Self::Sine([a, l]) => -((x / *l).cos() - 1.0) * (a * l),
            Self::Snap([k, length, l]) => {
                let stretched = (x.square() + l * l).sqrt();
                (x.square() * 0.5 - stretched * *length) * *k
            }
            Self::Exponential([a, l]) => ((x / *l).exp() * *l - x) * *a,
            Self::VanDerPol(_) | Self::CubicDamper(_) => return None,
            Self::Magnet([a, g]) => -(-x + *g).recip() * *a,
            Self::Gap([k, g]) => match piece {
                0 => (x + *g).square() * (0.5 * k),
                1 => x.constant(0.0),
                _ => (x - *g).square() * (0.5 * k),
            },
        })
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        let gap = match self {
            Self::Gap([_, g]) => Some([-g, *g]),
            _ => None,
        };
        gap.into_iter().flatten()
    }
}

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
    let size = random.uniform(0.2, 1.5);
    let length = random.uniform(0.3, 1.5);
    let one = |random: &mut Random| (random.bits() % n as u64) as usize;
    let direction = |random: &mut Random| -> Vec<(usize, f64)> {
        match random.bits() % 3 {
            0 => vec![(one(random), random.sign())],
            _ => (0..n).map(|j| (j, random.uniform(-1.0, 1.0))).collect(),
        }
    };
    let law = match random.bits() % 9 {
        0 => {
            let rows = [0, 1].map(|_| direction(random));
            let field = QuarticPair(size);
            return ForceElement::field(&[&rows[0], &rows[1]], field).unwrap();
        }
        1 => Force::Sine([size, length]),
        2 => Force::Snap([size, length, random.uniform(0.3, 1.0)]),
        3 => Force::Exponential([size, length]),
        4 => Force::VanDerPol([random.uniform(0.0, 0.3), size]),
        5 => Force::CubicDamper(0.2 * size),
        6 => Force::Magnet([0.05 * size, 4.0]),
        7 => Force::Gap([size, 0.5 * length]),
        _ => Force::Polynomial(vec![0.0, random.uniform(-0.2, 0.2), size]),
    };
    let element = ForceElement::along(&direction(random), law).unwrap();
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
        "polynomial" => Force::Polynomial(numbers(&given["law_params"]["c"])),
        "sine" => Force::Sine([value("A"), value("l")]),
        "snap" => Force::Snap([value("k"), value("L"), value("l")]),
        "exponential" => Force::Exponential([value("A"), value("l")]),
        "van_der_pol" => Force::VanDerPol([value("a"), value("b")]),
        "cubic_damper" => Force::CubicDamper(value("c")),
        "magnet" => Force::Magnet([value("A"), value("g")]),
        "gap" => Force::Gap([value("k"), value("g")]),
        "quartic_pair" => {
            let rows: Vec<_> = directions.iter().map(Vec::as_slice).collect();
            let element = ForceElement::field(&rows, QuarticPair(value("k4"))).unwrap();
            return with_factor(element, given);
        }
        other => panic!("unknown force {other}"),
    };
    with_factor(ForceElement::along(&directions[0], law).unwrap(), given)
}

fn with_factor(element: ForceElement, given: &Value) -> ForceElement {
    match given.get("factor") {
        Some(factor) => element.with_factor(drive(factor, f64::NAN)).unwrap(),
        None => element,
    }
}
