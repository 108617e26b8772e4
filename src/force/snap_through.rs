use super::ForceLaw;
use crate::error::Error;
use crate::scalar::Scalar;

/// A linear spring at an angle to the motion, which snaps through the position in which it is
/// perpendicular to the motion: a shallow arch, a truss of two bars, a vibration isolator of low
/// stiffness.
///
/// ```text
/// F(x) = k x (1 − L/r),   r = √(x² + l²),   U(x) = ½ k (r − L)²
/// ```
///
/// F is the force at the position x, and U its potential, the energy of the spring. One end of the
/// spring moves along a line; the other end is fixed at the distance l from this line, its span. r
/// is the length of the spring, L its free length and k its stiffness. For two equal springs on
/// both sides of the line, k is the sum of their stiffnesses.
///
/// For L > l the position x = 0 is unstable, and the spring is relaxed at x = ±√(L² − l²). Between
/// these two positions the force is at most k (L^(2/3) − l^(2/3))^(3/2) in size, at
/// x² = (L l²)^(2/3) − l². For L < l the spring is stretched and hardens.
///
/// Source: Cao, Wiercigroch, Pavlovskaia, Grebogi and Thompson, *Phys. Rev. E* 74 (2006) 046218.
///
/// ```
/// use stick_slip::{ForceLaw, SnapThrough};
///
/// let arch = SnapThrough::new(2.0, 1.25, 1.0)?;
/// assert_eq!(arch.force(0.75, 0.0, 0), 0.0); // relaxed: 0.75² + 1² = 1.25²
/// assert_eq!(arch.potential(0.0, 0), Some(0.0625)); // ½·2·(1 − 1.25)²
/// let most = (1.25_f64.powf(2.0 / 3.0) - 1.0).sqrt(); // the place, and the cube root of F/k
/// assert!((arch.force(most, 0.0, 0) + 2.0 * most.powi(3)).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "von Mises truss")]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::SnapThrough")
)]
pub struct SnapThrough {
    stiffness: f64,
    free_length: f64,
    span: f64,
}

impl SnapThrough {
    /// Creates a spring of stiffness k and free length L, at the distance l from the line of motion
    /// (its span).
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless all are finite, L ≥ 0, l > 0, and l² and k L/l neither
    /// overflow nor underflow.
    pub fn new(stiffness: f64, free_length: f64, span: f64) -> Result<Self, Error> {
        let of = "SnapThrough";
        Error::check(of, "stiffness", stiffness, true, "a stiffness of any size")?;
        let is_length = free_length >= 0.0;
        Error::check(of, "free_length", free_length, is_length, "free_length ≥ 0")?;
        let slope = stiffness * (free_length / span);
        let has_slope = slope.is_normal() || stiffness == 0.0 || free_length == 0.0;
        let in_range = (span * span).is_normal() && has_slope;
        let allowed = "span > 0, and span² and stiffness·free_length/span within the range of f64";
        Error::check(of, "span", span, span > 0.0 && in_range, allowed)?;
        Ok(Self {
            stiffness,
            free_length,
            span,
        })
    }

    /// Stiffness k, in units of force per position.
    pub fn stiffness(&self) -> f64 {
        self.stiffness
    }

    /// Free length L, in units of position.
    pub fn free_length(&self) -> f64 {
        self.free_length
    }

    /// Span l, in units of position.
    pub fn span(&self) -> f64 {
        self.span
    }

    /// The length r.
    #[inline(always)]
    fn length<S: Scalar>(&self, position: S) -> S {
        (position.square() + self.span * self.span).sqrt()
    }
}

impl ForceLaw for SnapThrough {
    #[inline(always)]
    fn force<S: Scalar>(&self, position: S, _: S, _: usize) -> S {
        let length = self.length(position);
        (length - self.free_length) / length * position * self.stiffness
    }

    fn potential<S: Scalar>(&self, position: S, _: usize) -> Option<S> {
        let stretch = self.length(position) - self.free_length;
        Some(stretch.square() * (0.5 * self.stiffness))
    }
}
