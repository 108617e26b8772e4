use super::ForceLaw;
use crate::error::Error;
use crate::scalar::Scalar;

/// Van der Pol's damper: it drives small vibrations and damps large ones, a model of flutter, of
/// vortices behind a cylinder, and of walking.
///
/// ```text
/// F(x, y) = (b x² − a) y
/// ```
///
/// F is the force at the position x and the velocity y. a is the negative damping at x = 0 and b
/// the nonlinear damping, in units of force per velocity and per velocity times position². With
/// weak damping a mass on a linear spring vibrates with the amplitude 2 √(a/b). The law has no
/// potential.
///
/// Source: van der Pol, *Philos. Mag.* 2 (1926) 978-992,
/// <https://doi.org/10.1080/14786442608564127>.
///
/// ```
/// use stick_slip::{ForceElement, ForceLaw, Structure, VanDerPol, structure::State};
///
/// let damper = VanDerPol::new(0.2, 0.5)?;
/// assert_eq!(damper.force(0.0, 3.0, 0), -0.2 * 3.0);
/// assert_eq!(damper.force(2.0, 3.0, 0), (0.5 * 4.0 - 0.2) * 3.0);
///
/// // x'' + (x² − 1) x' + x = 0: the limit cycle has the amplitude 2.008619860874843 and the period
/// // 6.663286859323130.
/// let element = ForceElement::new(0, VanDerPol::new(1.0, 1.0)?)?;
/// let mass = Structure::new(&[1.0])?.with_ground_spring(0, 1.0)?.with_element(element)?;
/// let start = State::new(&[2.008619860874843], &[0.0]);
/// let motion = mass.simulate(start.clone(), 6.663286859323130)?;
/// assert!((motion.last().displacements[0] - start.displacements[0]).abs() < 1e-14);
/// assert!(motion.last().velocities[0].abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::VanDerPol")
)]
pub struct VanDerPol {
    negative_damping: f64,
    nonlinear_damping: f64,
}

impl VanDerPol {
    /// Creates a damper with the negative damping a at x = 0 and the nonlinear damping b.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless both are finite.
    pub fn new(negative_damping: f64, nonlinear_damping: f64) -> Result<Self, Error> {
        for (name, value) in [
            ("negative_damping", negative_damping),
            ("nonlinear_damping", nonlinear_damping),
        ] {
            Error::check("VanDerPol", name, value, true, "damping of any size")?;
        }
        Ok(Self {
            negative_damping,
            nonlinear_damping,
        })
    }

    /// Negative damping a at x = 0, in units of force per velocity.
    pub fn negative_damping(&self) -> f64 {
        self.negative_damping
    }

    /// Nonlinear damping b, in units of force per velocity and position².
    pub fn nonlinear_damping(&self) -> f64 {
        self.nonlinear_damping
    }
}

impl ForceLaw for VanDerPol {
    #[inline(always)]
    fn force<S: Scalar>(&self, position: S, velocity: S, _: usize) -> S {
        (position.square() * self.nonlinear_damping - self.negative_damping) * velocity
    }
}
