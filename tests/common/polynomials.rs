//! Laws as data. Each type of law has a power series of its own to compile; one type that is told
//! its formula serves many tests.

use stick_slip::{FrictionLaw, Polynomial, Scalar};

/// A polynomial of the sliding speed, or one for each range of speeds.
#[derive(Debug, Clone, PartialEq)]
pub struct Polynomials {
    static_coefficient: f64,
    parts: Vec<Part>,
    /// Whether the speeds at which parts meet are named as breakpoints.
    told: bool,
}

/// Σ c_k (s − about)^k, from a speed on.
#[derive(Debug, Clone, PartialEq)]
struct Part {
    from: f64,
    about: f64,
    coefficients: Vec<f64>,
}

impl Polynomials {
    /// Σ c_k s^k, or the first of several parts.
    pub fn new(static_coefficient: f64, coefficients: &[f64]) -> Self {
        Self::about(0.0, static_coefficient, coefficients)
    }

    /// Σ c_k (s − about)^k.
    pub fn about(about: f64, static_coefficient: f64, coefficients: &[f64]) -> Self {
        let first = Part {
            from: 0.0,
            about,
            coefficients: coefficients.to_vec(),
        };
        Self {
            static_coefficient,
            parts: vec![first],
            told: false,
        }
    }

    /// The same, with the static coefficient that leaves no jump at s = 0.
    pub fn without_jump(about: f64, coefficients: &[f64]) -> Self {
        let law = Self::about(about, f64::NAN, coefficients);
        Self {
            static_coefficient: law.kinetic(0.0),
            ..law
        }
    }

    /// Adds one more part, Σ c_k (s − from)^k from this speed on.
    pub fn then(mut self, from: f64, coefficients: &[f64]) -> Self {
        self.parts.push(Part {
            from,
            about: from,
            coefficients: coefficients.to_vec(),
        });
        self
    }

    /// Names its breakpoints.
    pub fn told(self) -> Self {
        Self { told: true, ..self }
    }

    fn part<S: Scalar>(&self, part: usize, speed: S) -> S {
        let Part {
            about,
            coefficients,
            ..
        } = &self.parts[part];
        let x = speed - *about;
        match coefficients[..] {
            [] => speed.constant(0.0),
            [value] => speed.constant(value),
            [ref lower @ .., next, highest] => lower
                .iter()
                .rfold(x * highest + next, |sum, &c| sum * x + c),
        }
    }
}

impl FrictionLaw for Polynomials {
    fn static_coefficient(&self) -> f64 {
        self.static_coefficient
    }
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        let above = |part: &&Part| part.from <= speed.value();
        self.part(self.parts[1..].iter().take_while(above).count(), speed)
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        let named = if self.told { &self.parts[1..] } else { &[] };
        named.iter().map(|part| part.from)
    }
    fn kinetic_on<S: Scalar>(&self, piece: usize, speed: S) -> S {
        if self.told {
            self.part(piece, speed)
        } else {
            self.kinetic(speed)
        }
    }
}

/// The coefficients of the polynomial law about a speed.
pub fn coefficients(law: &Polynomial, speed: f64) -> [f64; 4] {
    [(0, 1.0), (1, 1.0), (2, 2.0), (3, 6.0)]
        .map(|(n, factorial)| law.derivative(n, speed) / factorial)
}
