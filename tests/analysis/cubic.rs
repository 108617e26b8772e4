//! Every cubic law: one type for all tests that write one.

use stick_slip::{FrictionLaw, Polynomial, Scalar};

/// μ̂(s) = a + b x + c x² + d x³ with the distance x of the sliding speed from a centre, and with a
/// static coefficient of its own.
#[derive(Clone, Copy)]
pub(crate) struct Cubic {
    pub(crate) static_coefficient: f64,
    pub(crate) centre: f64,
    pub(crate) c: [f64; 4],
}

impl Cubic {
    /// Without a jump at s = 0.
    pub(crate) fn new(centre: f64, c: [f64; 4]) -> Self {
        let law = Self {
            static_coefficient: f64::NAN,
            centre,
            c,
        };
        let static_coefficient = law.kinetic(0.0);
        Self {
            static_coefficient,
            ..law
        }
    }
}

impl FrictionLaw for Cubic {
    fn static_coefficient(&self) -> f64 {
        self.static_coefficient
    }
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        let [a, b, c, d] = self.c;
        let x = speed - self.centre;
        ((x * d + c) * x + b) * x + a
    }
}

/// The coefficients of the polynomial law about a speed.
pub(crate) fn coefficients(law: &Polynomial, speed: f64) -> [f64; 4] {
    [(0, 1.0), (1, 1.0), (2, 2.0), (3, 6.0)]
        .map(|(n, factorial)| law.derivative(n, speed) / factorial)
}
