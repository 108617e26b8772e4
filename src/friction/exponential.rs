use super::check::{check_kinetic, check_static};
use super::{AnyLaw, FrictionLaw, LawRef, Own};
use crate::error::Error;
use crate::scalar::Scalar;

/// The Gaussian Stribeck law, which falls from μ_s towards μ_k and never rises. It is constant if
/// μ_k = μ_s.
///
/// ```text
/// μ̂(s) = μ_k + (μ_s − μ_k) exp(−(s/v_s)²)
/// ```
///
/// μ̂(s) is the kinetic coefficient at the sliding speed s, μ_s the static coefficient, μ_k the
/// kinetic coefficient at high speeds, and v_s the Stribeck velocity. Coefficients are
/// dimensionless. Speeds are in the unit of velocity of the system
/// ([`FrictionLaw`](crate::FrictionLaw)). Many papers use the name "exponential law" for a law with
/// exp(−s/v_s); that law is [`Stribeck`](crate::Stribeck) with the exponent 1.
///
/// Source: Farshidianfar and Noei Aghaee, *Analytical Approaches for Friction Induced Vibration and
/// Stability Analysis*, Eq. 6. (Their abstract says that this law "first drops off and then
/// raises"; in fact the law never rises.)
///
/// ```
/// use stick_slip::{Exponential, FrictionLaw};
///
/// let law = Exponential::new(0.4, 0.25, 0.5)?;
/// assert!((law.kinetic(0.5) - (0.25 + 0.15 * (-1.0_f64).exp())).abs() < 1e-16);
/// assert_eq!(law.slope(0.0), 0.0);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "Stribeck")]
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::Exponential")
)]
pub struct Exponential {
    static_coefficient: f64,
    kinetic_coefficient: f64,
    stribeck_velocity: f64,
    /// −1/v_s², the factor in the exponent.
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    rate: f64,
}

/// The largest v_s: friction falls to μ_k before the square of the sliding speed overflows.
const LARGEST: f64 = 1e150;

impl Exponential {
    /// Creates a law with static coefficient μ_s, kinetic coefficient μ_k and Stribeck velocity
    /// v_s.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless all are finite, 0 ≤ μ_k ≤ μ_s, 0 < v_s ≤ 1e150, and
    /// 1/v_s² does not overflow.
    pub fn new(
        static_coefficient: f64,
        kinetic_coefficient: f64,
        stribeck_velocity: f64,
    ) -> Result<Self, Error> {
        check_static("Exponential", static_coefficient)?;
        check_kinetic("Exponential", static_coefficient, kinetic_coefficient)?;
        let rate = -stribeck_velocity.powi(-2);
        Error::check(
            "Exponential",
            "stribeck_velocity",
            stribeck_velocity,
            0.0 < stribeck_velocity && stribeck_velocity <= LARGEST && rate.is_finite(),
            "0 < stribeck_velocity ≤ 1e150, and not so small that 1/v_s² overflows",
        )?;
        Ok(Self {
            static_coefficient,
            kinetic_coefficient,
            stribeck_velocity,
            rate,
        })
    }

    /// Kinetic coefficient μ_k far above the Stribeck velocity, dimensionless.
    pub fn kinetic_coefficient(&self) -> f64 {
        self.kinetic_coefficient
    }

    /// Stribeck velocity v_s, in the unit of velocity.
    pub fn stribeck_velocity(&self) -> f64 {
        self.stribeck_velocity
    }
}

impl FrictionLaw for Exponential {
    fn static_coefficient(&self) -> f64 {
        self.static_coefficient
    }

    #[inline(always)]
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        (speed.square() * self.rate).exp() * (self.static_coefficient - self.kinetic_coefficient)
            + self.kinetic_coefficient
    }

    #[inline(never)]
    fn erased(&self) -> LawRef<'_> {
        LawRef::of(self)
    }
    fn any(&self, _: Own) -> Option<AnyLaw> {
        Some((*self).into())
    }
}
