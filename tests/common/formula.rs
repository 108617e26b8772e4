//! Friction laws once more, in plain numbers: what integrators know of them that share no code with
//! the crate.

use stick_slip::{AnyLaw, Coulomb, Exponential, Polynomial, Stribeck, Tabulated};

use crate::Table;
use crate::any::Any;
use crate::laws::Wave;

/// A law by its formula.
#[derive(Debug, Clone)]
pub enum Formula {
    /// μ_s, μ_m, v_m.
    Polynomial([f64; 3]),
    /// μ_s, μ_k, v_s.
    Exponential([f64; 3]),
    /// μ_s, μ_k.
    Coulomb([f64; 2]),
    /// μ_s, v, δ, η: (μ_s − δ)/(1 + s/v) + δ + η s².
    Rational([f64; 4]),
    /// μ_s, μ_c, v_s, viscous coefficient, and the exponent.
    Stribeck([f64; 4], i32),
    /// Speeds, coefficients and slopes, joined by cubics; the static coefficient.
    Points(Vec<[f64; 3]>, f64),
    /// Speeds and coefficients, joined by straight lines and continued by the last.
    Lines(Vec<(f64, f64)>),
    /// μ_s, d, a, k: μ_s − d s/(1 + s) + a (cos ks − 1).
    Wave([f64; 4]),
}

impl Formula {
    pub fn at(&self, s: f64) -> f64 {
        match self {
            Self::Polynomial([top, least, width]) => {
                let x = s / width;
                top - 1.5 * (top - least) * (x - x * x * x / 3.0)
            }
            Self::Exponential([top, least, width]) => {
                least + (top - least) * (-(s / width) * (s / width)).exp()
            }
            Self::Coulomb([_, least]) => *least,
            Self::Rational([top, width, least, rise]) => {
                (top - least) * width / (width + s) + least + rise * s * s
            }
            Self::Stribeck([top, least, width, viscous], exponent) => {
                least + (top - least) * (-(s / width).powi(*exponent)).exp() + viscous * s
            }
            Self::Points(points, _) => {
                let i = points.iter().take_while(|point| point[0] <= s).count();
                let [a, b] = match (points.get(i - 1), points.get(i)) {
                    (Some(a), Some(b)) => [a, b],
                    (Some(last), None) => return last[1],
                    _ => unreachable!(),
                };
                let (h, t) = (b[0] - a[0], (s - a[0]) / (b[0] - a[0]));
                let r = 1.0 - t;
                (1.0 + 2.0 * t) * r * r * a[1]
                    + t * r * r * h * a[2]
                    + t * t * (3.0 - 2.0 * t) * b[1]
                    - t * t * r * h * b[2]
            }
            Self::Lines(points) => {
                let passed = points
                    .iter()
                    .skip(1)
                    .take_while(|point| point.0 <= s)
                    .count();
                let i = passed.min(points.len() - 2);
                let ((s0, c0), (s1, c1)) = (points[i], points[i + 1]);
                c0 + (s - s0) * (c1 - c0) / (s1 - s0)
            }
            Self::Wave([top, fall, height, number]) => {
                top - fall * s / (1.0 + s) + height * ((number * s).cos() - 1.0)
            }
        }
    }

    pub fn static_coefficient(&self) -> f64 {
        match self {
            Self::Polynomial([top, ..])
            | Self::Exponential([top, ..])
            | Self::Coulomb([top, ..])
            | Self::Rational([top, ..])
            | Self::Stribeck([top, ..], _)
            | Self::Points(_, top)
            | Self::Wave([top, ..]) => *top,
            Self::Lines(points) => points[0].1,
        }
    }

    /// The law itself.
    pub fn law(&self) -> Any {
        let law: AnyLaw = match *self {
            Self::Polynomial([top, least, width]) => {
                Polynomial::new(top, least, width).unwrap().into()
            }
            Self::Exponential([top, least, width]) => {
                Exponential::new(top, least, width).unwrap().into()
            }
            Self::Coulomb([top, least]) => Coulomb::new(top, least).unwrap().into(),
            Self::Rational([top, width, least, rise]) => {
                crate::any::rational(top, 1.0 / width, least, rise)
            }
            Self::Stribeck([top, least, width, viscous], exponent) => {
                Stribeck::new(top, least, width, exponent as u32)
                    .and_then(|law| law.with_viscous_coefficient(viscous))
                    .unwrap()
                    .into()
            }
            Self::Points(ref points, top) => {
                Tabulated::new(points.iter().map(|point| (point[0], point[1])))
                    .and_then(|law| law.with_static_coefficient(top))
                    .unwrap()
                    .into()
            }
            Self::Lines(ref points) => {
                return Any::Table(Table {
                    static_coefficient: points[0].1,
                    points: points.clone(),
                });
            }
            Self::Wave([static_coefficient, fall, height, number]) => {
                return Any::Wave(Wave {
                    static_coefficient,
                    fall,
                    height,
                    number,
                });
            }
        };
        Any::Crate(law)
    }
}
