use std::ops::Index;

use num_complex::Complex;

use crate::error::Digits;
use crate::state::Units;

/// Steady sliding, in which the mass stands still (v = 0) on the moving belt, and its linear
/// stability.
///
/// ```text
/// ū = sgn(v_b)·γ²μ̂(|v_b|)                        (Eq. 7, corrected: the paper has μ(v_r))
/// J = [0 1; −1 −h1],   h1 = 2β + γ² dμ̂/ds at |v_b|  (Eq. 10a, for any law)
/// λ = (−h1 ± √(h1² − 4))/2                         (Eq. 14)
/// ```
///
/// β is the damping ratio, γ² the friction load, v_b the belt velocity, and μ̂(s) the kinetic
/// coefficient at the sliding speed s. J is the Jacobian of displacement and velocity, h1 the
/// damping of small motions, and λ are the eigenvalues. All quantities are dimensionless. If |v_b|
/// is a breakpoint of the law, slope and stability are those of the piece above |v_b|, and apply to
/// motions with sliding speeds above |v_b|. The stability of motions that pass the breakpoint
/// depends on both slopes.
///
/// Source: Farshidianfar and Noei Aghaee, *Analytical Approaches for Friction Induced Vibration and
/// Stability Analysis*.
///
/// ```
/// use stick_slip::{MassOnBelt, Polynomial, Stability};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let equilibrium = system.equilibrium().unwrap();
/// assert!((equilibrium.displacement - 0.3148).abs() < 1e-15);
/// assert!((equilibrium.eigenvalues[0].re - 0.139).abs() < 1e-15);
/// assert_eq!(equilibrium.stability, Stability::UnstableFocus);
/// assert!(!equilibrium.is_stable());
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(into = "super::written::Equilibrium")
)]
#[non_exhaustive]
pub struct Equilibrium {
    /// Displacement ū of the mass, dimensionless.
    pub displacement: f64,
    /// Jacobian J of the map (u, v) ↦ (u', v') of displacement u and velocity v, dimensionless.
    pub jacobian: Jacobian,
    /// Eigenvalues λ of J, dimensionless (in units of the natural frequency ω0). The eigenvalue
    /// with the + sign in Eq. 14 is the first.
    pub eigenvalues: [Complex<f64>; 2],
    /// The stability that follows from the eigenvalues.
    pub stability: Stability,
}

/// A Jacobian matrix; `jacobian[(i, j)]` is the derivative of rate i by variable j, from 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jacobian([[f64; 2]; 2]);

impl Index<(usize, usize)> for Jacobian {
    type Output = f64;

    fn index(&self, (row, column): (usize, usize)) -> &f64 {
        &self.0[row][column]
    }
}

impl Equilibrium {
    /// The equilibrium at ū with h1 = `damping`.
    pub(crate) fn new(displacement: f64, damping: f64) -> Self {
        Self {
            displacement,
            jacobian: Jacobian([[0.0, 1.0], [-1.0, -damping]]),
            eigenvalues: eigenvalues(damping),
            stability: Stability::of(damping),
        }
    }

    /// Converts this equilibrium of a dimensionless system to other units.
    pub(crate) fn in_units(&self, units: Units) -> Self {
        let rate = units.rate;
        Self {
            displacement: self.displacement * units.length,
            jacobian: Jacobian([[0.0, 1.0], [-rate * rate, rate * self.jacobian[(1, 1)]]]),
            eigenvalues: self.eigenvalues.map(|eigenvalue| eigenvalue * rate),
            stability: self.stability,
        }
    }

    /// Returns true if small perturbations decay, that is, both eigenvalues have a negative real
    /// part. For a centre it returns false.
    pub fn is_stable(&self) -> bool {
        matches!(
            self.stability,
            Stability::StableFocus | Stability::StableNode
        )
    }
}

/// Displays stability, displacement and eigenvalues in one line.
///
/// ```
/// use stick_slip::{MassOnBelt, Polynomial};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// assert_eq!(
///     system.equilibrium().unwrap().to_string(),
///     "unstable focus: u = 0.3148, λ = 0.139 ± 0.990292i"
/// );
/// # Ok::<(), stick_slip::Error>(())
/// ```
impl std::fmt::Display for Equilibrium {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let (stability, u) = (self.stability, Digits(self.displacement));
        let [first, second] = self.eigenvalues;
        let [re, im, other] = [first.re, first.im, second.re].map(Digits);
        write!(f, "{stability}: u = {u}, λ = ")?;
        if first.im == 0.0 {
            write!(f, "{re} and {other}")
        } else {
            write!(f, "{re} ± {im}i")
        }
    }
}

/// The stability of an equilibrium, from the damping h1 of [`Equilibrium`] alone.
///
/// Source: Farshidianfar and Noei Aghaee, Eq. 14.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Stability {
    /// 0 < h1 < 2: decaying oscillations.
    StableFocus,
    /// h1 ≥ 2: perturbations decay without oscillation. At h1 = 2 the node is degenerate.
    StableNode,
    /// h1 = 0 exactly: the linear system oscillates undamped, and nonlinear terms decide the
    /// stability.
    Center,
    /// −2 < h1 < 0: growing oscillations.
    UnstableFocus,
    /// h1 ≤ −2: perturbations grow without oscillation. At h1 = −2 the node is degenerate.
    UnstableNode,
}

impl Stability {
    fn of(h1: f64) -> Self {
        if h1 >= 2.0 {
            Self::StableNode
        } else if h1 > 0.0 {
            Self::StableFocus
        } else if h1 == 0.0 {
            Self::Center
        } else if h1 > -2.0 {
            Self::UnstableFocus
        } else {
            Self::UnstableNode
        }
    }
}

impl std::fmt::Display for Stability {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::StableFocus => "stable focus",
            Self::StableNode => "stable node",
            Self::Center => "centre",
            Self::UnstableFocus => "unstable focus",
            Self::UnstableNode => "unstable node",
        })
    }
}

/// The roots of λ² + h1 λ + 1 = 0, Eq. 14. The root of larger magnitude is computed without
/// cancellation, the other one from λ1 λ2 = 1.
fn eigenvalues(h1: f64) -> [Complex<f64>; 2] {
    let root = (h1 - 2.0).abs().sqrt() * (h1 + 2.0).abs().sqrt();
    if h1.abs() < 2.0 {
        [root, -root].map(|root| Complex::new(-0.5 * h1, 0.5 * root))
    } else {
        let large = -0.5 * (h1 + root.copysign(h1));
        let (plus, minus) = if h1 > 0.0 {
            (large.recip(), large)
        } else {
            (large, large.recip())
        };
        [plus, minus].map(Complex::from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvalues_have_no_cancellation() {
        for h1 in [
            -1e200, -1e9, -3.0, -2.0, -1e-9, 0.0, 0.5, 2.0, 2.5, 1e9, 1e200,
        ] {
            let [a, b] = eigenvalues(h1);
            let (sum, product) = (a + b, a * b);
            assert!(
                (sum.re + h1).abs() <= 2.0 * f64::EPSILON * h1.abs(),
                "{h1}: {a} {b}"
            );
            assert!(
                (product.re - 1.0).abs() <= 4.0 * f64::EPSILON,
                "{h1}: {a} {b}"
            );
            assert_eq!((sum.im, product.im), (0.0, 0.0));
            assert!(a.re > b.re || a.im >= b.im, "the + sign first: {a} {b}");
        }
        // Root of smaller magnitude, −1e-9 − 1e-27: the textbook formula loses all its digits.
        assert_eq!(eigenvalues(1e9)[0].re, -1e-9);
    }
}
