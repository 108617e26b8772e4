use super::ForceLaw;
use crate::error::Error;
use crate::scalar::Scalar;

/// A spring whose force is a polynomial of the position, such as the spring of Duffing's equation.
///
/// ```text
/// F(x) = c_1 x + c_2 x² + … + c_n x^n,   U(x) = c_1 x²/2 + c_2 x³/3 + … + c_n x^(n+1)/(n + 1)
/// ```
///
/// F is the force at the position x, U its potential, and c_i is in units of force per position^i.
/// Without even powers the spring is symmetric. With c_1 > 0 and c_3 > 0 it hardens, with c_3 < 0
/// it softens, and with c_1 < 0 < c_3 it has two stable equilibria besides x = 0 (a buckled beam).
///
/// Source: NIST Digital Library of Mathematical Functions, <https://dlmf.nist.gov/22.19>, part (ii),
/// for free vibration; Kovacic and Brennan, *The Duffing Equation* (Wiley 2011).
///
/// ```
/// use stick_slip::{ForceElement, ForceLaw, PolynomialSpring, Structure, structure::State};
///
/// let spring = PolynomialSpring::new(&[1.0, 0.0, 0.5])?;
/// assert_eq!(spring.force(2.0, 0.0, 0), 1.0 * 2.0 + 0.5 * 8.0);
/// assert_eq!(spring.potential(2.0, 0), Some(0.5 * 4.0 + 0.125 * 16.0));
///
/// // Free vibration on F = x³ from x = 1: the period is Γ(1/4)²/√π.
/// let element = ForceElement::new(0, PolynomialSpring::new(&[0.0, 0.0, 1.0])?)?;
/// let mass = Structure::new(&[1.0])?.with_element(element)?;
/// let motion = mass.simulate(State::new(&[1.0], &[0.0]), 7.416298709205487673735401)?;
/// assert!((motion.last().displacements[0] - 1.0).abs() < 1e-14);
/// assert!(motion.last().velocities[0].abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "Duffing")]
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::PolynomialSpring")
)]
pub struct PolynomialSpring {
    coefficients: Vec<f64>,
}

impl PolynomialSpring {
    /// Creates a spring with the coefficients c_1, c_2, … of x, x², …
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if there is no coefficient, or for the first that is not finite.
    pub fn new(coefficients: &[f64]) -> Result<Self, Error> {
        let (of, count) = ("PolynomialSpring", coefficients.len());
        let allowed = "coefficients ≥ 1: the number of coefficients; 0 is a spring without force";
        Error::check(of, "coefficients", count as f64, count >= 1, allowed)?;
        for &c in coefficients {
            Error::check(of, "coefficient", c, true, "each coefficient of any size")?;
        }
        Ok(Self {
            coefficients: coefficients.to_vec(),
        })
    }

    /// The coefficients c_1, c_2, …, in units of force per position, per position², …
    pub fn coefficients(&self) -> &[f64] {
        &self.coefficients
    }
}

impl ForceLaw for PolynomialSpring {
    #[inline(always)]
    fn force<S: Scalar>(&self, position: S, _: S, _: usize) -> S {
        horner(position, self.coefficients.iter().copied())
    }

    fn potential<S: Scalar>(&self, position: S, _: usize) -> Option<S> {
        let coefficients = self.coefficients.iter().enumerate();
        let integrals = coefficients.map(|(i, &c)| c / (i + 2) as f64);
        Some(horner(position, integrals) * position)
    }
}

/// c_1 x + c_2 x² + …
#[inline(always)]
fn horner<S: Scalar>(x: S, coefficients: impl DoubleEndedIterator<Item = f64>) -> S {
    let mut descending = coefficients.rev();
    // A product with a number costs less than one with a constant series.
    let mut sum = x * descending.next().unwrap_or(0.0);
    // A fold is not always inlined.
    for c in descending {
        sum = (sum + c) * x;
    }
    sum
}
