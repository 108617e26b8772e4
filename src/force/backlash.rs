use super::ForceLaw;
use crate::error::Error;
use crate::scalar::Scalar;

/// A spring with play on both sides: the mesh of two gears, a coupling with clearance, a mass
/// between two elastic stops.
///
/// ```text
/// F(x) = k (x − g) for x > g,   k (x + g) for x < −g,   0 between;   U(x) = F(x)²/(2k)
/// ```
///
/// F is the force at the position x, U its potential, k the stiffness, and g ≥ 0 half of the play.
/// The positions ±g are [breakpoints](ForceLaw::breakpoints). With g = 0 it is the linear spring of
/// stiffness k.
///
/// With a damper in each flank it is a pair of [stops](crate::Stop).
///
/// Source: Kahraman and Singh, *J. Sound Vib.* 142 (1990) 49-75; Theodossiades and Natsiavas, *J.
/// Sound Vib.* 229 (2000) 287-310.
///
/// ```
/// use stick_slip::{Backlash, ForceElement, ForceLaw, Structure, structure::State};
///
/// let stops = Backlash::new(3.0, 0.5)?;
/// assert_eq!(stops.force(1.0, 0.0, 2), 1.5);
/// assert_eq!(stops.force(0.2, 0.0, 1), 0.0);
/// assert_eq!(stops.breakpoints().collect::<Vec<_>>(), [-0.5, 0.5]);
///
/// // Free vibration of amplitude 1 on a spring of stiffness 1 between these stops. With the energy
/// // E = 1/2 + (3/2)(1/2)² a quarter of the period lasts asin(1/2/√(2E)) up to the stop, and
/// // atan2(v, ω(1/2 − x_e))/ω beyond, with v² = 2E − 1/4, ω² = 4 and the centre x_e = 3/8.
/// let mass = Structure::new(&[1.0])?
///     .with_ground_spring(0, 1.0)?
///     .with_element(ForceElement::new(0, stops)?)?;
/// let motion = mass.simulate(State::new(&[1.0], &[0.0]), 4.289263558629854269960580)?;
/// assert!((motion.last().displacements[0] - 1.0).abs() < 1e-14);
/// assert!(motion.last().velocities[0].abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::Backlash")
)]
pub struct Backlash {
    stiffness: f64,
    gap: f64,
}

impl Backlash {
    /// Creates a spring of stiffness k beyond the gap g on each side of 0.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless both are finite and g ≥ 0.
    pub fn new(stiffness: f64, gap: f64) -> Result<Self, Error> {
        let of = "Backlash";
        Error::check(of, "stiffness", stiffness, true, "a stiffness of any size")?;
        Error::check(of, "gap", gap, gap >= 0.0, "gap ≥ 0")?;
        Ok(Self { stiffness, gap })
    }

    /// Stiffness k beyond the gap, in units of force per position.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// The gap g on each side of 0, in units of position.
    pub fn gap(&self) -> f64 {
        self.gap
    }

    /// The part of x beyond the gap.
    #[inline(always)]
    fn beyond<S: Scalar>(&self, position: S, piece: usize) -> S {
        match piece {
            _ if self.gap == 0.0 => position,
            0 => position + self.gap,
            1 => position.constant(0.0),
            _ => position - self.gap,
        }
    }
}

impl ForceLaw for Backlash {
    #[inline(always)]
    fn force<S: Scalar>(&self, position: S, _: S, piece: usize) -> S {
        self.beyond(position, piece) * self.stiffness
    }

    fn potential<S: Scalar>(&self, position: S, piece: usize) -> Option<S> {
        Some(self.beyond(position, piece).square() * (0.5 * self.stiffness))
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        let both = (self.gap > 0.0).then_some([-self.gap, self.gap]);
        both.into_iter().flatten()
    }
}
