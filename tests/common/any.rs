//! Random systems of every law: those of the crate, and the tests' own.

use stick_slip::{
    AnyLaw, Coulomb, Exponential, FrictionLaw, MassOnBelt, Polynomial, Rational, Scalar, Stribeck,
    Tabulated,
};

use crate::laws::Wave;
use crate::{Decay, Leine, Random, Table, on_belt};

/// Any law of the crate or of the tests.
#[derive(Debug, Clone, PartialEq)]
pub enum Any {
    Crate(AnyLaw),
    Leine(Leine),
    Decay(Decay),
    Table(Table),
    Wave(Wave),
}

impl FrictionLaw for Any {
    fn static_coefficient(&self) -> f64 {
        match self {
            Self::Crate(law) => law.static_coefficient(),
            Self::Leine(law) => law.static_coefficient(),
            Self::Decay(law) => law.static_coefficient(),
            Self::Table(law) => law.static_coefficient(),
            Self::Wave(law) => law.static_coefficient(),
        }
    }
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        match self {
            Self::Crate(law) => law.kinetic(speed),
            Self::Leine(law) => law.kinetic(speed),
            Self::Decay(law) => law.kinetic(speed),
            Self::Table(law) => law.kinetic(speed),
            Self::Wave(law) => law.kinetic(speed),
        }
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        let all: Vec<f64> = match self {
            Self::Crate(law) => law.breakpoints().collect(),
            Self::Table(law) => law.breakpoints().collect(),
            _ => Vec::new(),
        };
        all.into_iter()
    }
    fn kinetic_on<S: Scalar>(&self, piece: usize, speed: S) -> S {
        match self {
            Self::Crate(law) => law.kinetic_on(piece, speed),
            Self::Table(law) => law.kinetic_on(piece, speed),
            other => other.kinetic(speed),
        }
    }
}

impl Any {
    /// How many kinds [`of_kind`](Self::of_kind) knows.
    pub const KINDS: usize = 10;

    /// A law of one kind: from μ_s = top down to a part `least` of it over a speed `width`; then it
    /// rises by a `part` of its fall, if it can. A rational law rises by as much times `quadratic`,
    /// with the square of the speed.
    pub fn of_kind(kind: usize, [top, least, width, part]: [f64; 4], quadratic: f64) -> Self {
        let least = least * top;
        let rise = part * (top - least);
        let law: AnyLaw = match kind {
            0 => Polynomial::new(top, least, width).unwrap().into(),
            1 => Exponential::new(top, least, width).unwrap().into(),
            2 => Coulomb::new(top, least).unwrap().into(),
            3 => Rational::new(top, 1.0 / width)
                .and_then(|law| law.with_offset(least))
                .and_then(|law| law.with_quadratic(quadratic * rise / (width * width)))
                .unwrap()
                .into(),
            4 => Stribeck::new(top, least, width, 1 + (part * 4.0) as u32)
                .and_then(|law| law.with_viscous_coefficient(0.05 * rise / width))
                .unwrap()
                .into(),
            5 => {
                let middle = (0.4 * width, least + part * (top - least));
                let end = (3.0 * width, least + 0.5 * rise);
                Tabulated::new([(0.0, top), middle, (width, least), end])
                    .and_then(|law| law.with_static_coefficient((1.0 + part) * top))
                    .unwrap()
                    .into()
            }
            6 => {
                return Self::Leine(Leine {
                    static_coefficient: top,
                    decay: 1.0 / width,
                });
            }
            7 => {
                return Self::Decay(Decay {
                    static_coefficient: top,
                    kinetic_coefficient: least,
                    velocity: width,
                });
            }
            8 => {
                return Self::Table(Table {
                    static_coefficient: (1.0 + part) * top,
                    points: vec![
                        (0.0, top),
                        (width, least),
                        (2.0 * width, least + rise),
                        (3.0 * width, least + 1.1 * rise),
                    ],
                });
            }
            _ => {
                return Self::Wave(Wave {
                    static_coefficient: top,
                    fall: top - least,
                    height: 0.1 * part * top,
                    number: 1.0 / width,
                });
            }
        };
        Self::Crate(law)
    }
}

/// A rational law of all its terms.
pub fn rational(top: f64, decay: f64, offset: f64, quadratic: f64) -> AnyLaw {
    Rational::new(top, decay)
        .and_then(|law| law.with_offset(offset)?.with_quadratic(quadratic))
        .unwrap()
        .into()
}

/// The paper's cubic law.
pub fn cubic(top: f64, least: f64, velocity: f64) -> AnyLaw {
    Polynomial::new(top, least, velocity).unwrap().into()
}

impl Random {
    /// How many kinds [`any_law`](Self::any_law) knows.
    pub const KINDS: usize = 11;

    /// A law of one kind, with μ_s in [0.2, 0.8); it falls to 0.3 to 1 of that, and most may rise
    /// again.
    pub fn any_law(&mut self, kind: usize) -> Any {
        let top = self.uniform(0.2, 0.8);
        let least = top * self.uniform(0.3, 1.0);
        let width = self.uniform(0.1, 1.0);
        let law: AnyLaw = match kind {
            0 => Polynomial::new(top, least, self.uniform(0.3, 1.5))
                .unwrap()
                .into(),
            1 => Exponential::new(top, least, width).unwrap().into(),
            2 => Coulomb::new(top, least).unwrap().into(),
            3 => Rational::new(top, self.uniform(0.2, 5.0))
                .and_then(|law| law.with_offset(0.7 * least))
                .and_then(|law| law.with_quadratic(self.uniform(0.0, 0.05)))
                .unwrap()
                .into(),
            4 => {
                let exponent = self.pick(&[1, 2, 3, 4]);
                Stribeck::new(top, least, width, exponent)
                    .and_then(|law| law.with_viscous_coefficient(self.uniform(0.0, 0.05)))
                    .unwrap()
                    .into()
            }
            5 | 6 => {
                let middle = (0.4 * width, least + self.uniform(0.2, 0.7) * (top - least));
                let end = (3.0 * width, least + self.uniform(0.0, 0.5) * (top - least));
                let points = [(0.0, top), middle, (width, least), end];
                // Straight lines, and static friction above the kinetic one, in every second.
                let (law, raised) = if kind == 5 {
                    (Tabulated::new(points), 1.0)
                } else {
                    let lines = Tabulated::piecewise_linear(points);
                    (lines, self.uniform(1.0, 1.5))
                };
                law.and_then(|law| law.with_static_coefficient(raised * top))
                    .unwrap()
                    .into()
            }
            7 => {
                return Any::Leine(Leine {
                    static_coefficient: top,
                    decay: self.uniform(0.2, 5.0),
                });
            }
            8 => {
                return Any::Decay(Decay {
                    static_coefficient: top,
                    kinetic_coefficient: least,
                    velocity: width,
                });
            }
            9 => {
                let rise = self.uniform(0.0, 0.5) * (top - least);
                return Any::Table(Table {
                    static_coefficient: self.pick(&[1.0, 1.2]) * top,
                    points: vec![
                        (0.0, top),
                        (width, least),
                        (2.0 * width, least + rise),
                        (3.0 * width, least + 1.1 * rise),
                    ],
                });
            }
            _ => {
                return Any::Wave(Wave {
                    static_coefficient: top,
                    fall: top - least,
                    height: self.uniform(0.0, 0.1) * top,
                    number: self.uniform(1.0, 12.0),
                });
            }
        };
        Any::Crate(law)
    }

    /// A system with a law of one kind: 0.03 ≤ |v_b| < 2 with either sign, β = 0 or 10⁻⁴ ≤ β < 0.4,
    /// 0.01 ≤ γ² < 5.
    pub fn any_system(&mut self, kind: usize) -> MassOnBelt<Any> {
        let law = self.any_law(kind);
        let belt_velocity = self.sign() * self.logarithmic(0.03, 2.0);
        let damping = if self.bits().is_multiple_of(8) {
            0.0
        } else {
            self.logarithmic(1e-4, 0.4)
        };
        on_belt(law, belt_velocity, damping, self.logarithmic(0.01, 5.0))
    }
}

/// Random systems, so many of each law, with what to say of one that fails.
pub fn systems(seed: u64, of_each: usize) -> impl Iterator<Item = (String, MassOnBelt<Any>)> {
    let mut random = Random::new(seed);
    (0..of_each * Random::KINDS).map(move |i| {
        let system = random.any_system(i % Random::KINDS);
        (format!("system {i}: {system:?}"), system)
    })
}
