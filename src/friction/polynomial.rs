use super::check::check_static;
use super::{AnyLaw, FrictionLaw, LawRef, Own};
use crate::error::Error;
use crate::scalar::Scalar;

/// The cubic law of Panovko and Gubanova, with a minimum μ_m at the sliding speed v_m.
///
/// ```text
/// μ̂(s) = μ_s − k1 s + k3 s³,   k1 = (3/2)(μ_s − μ_m)/v_m,   k3 = (1/2)(μ_s − μ_m)/v_m³
/// ```
///
/// μ̂(s) is the kinetic coefficient at the sliding speed s, and μ_s the static coefficient.
/// Coefficients are dimensionless. Speeds are in the unit of velocity of the system
/// ([`FrictionLaw`](crate::FrictionLaw)). The coefficient falls from μ_s at s = 0 to μ_m at s =
/// v_m, and rises without bound at higher speeds. If μ_m = μ_s, it is constant.
///
/// Source: Farshidianfar and Noei Aghaee, *Analytical Approaches for Friction Induced Vibration and
/// Stability Analysis*, Eqs. 3-5; Thomsen and Fidlin, *Int. J. Non-Linear Mech.* 38 (2003) 389-403.
///
/// ```
/// use stick_slip::{FrictionLaw, Polynomial};
///
/// let law = Polynomial::new(0.4, 0.25, 0.5)?;
/// assert_eq!(law.kinetic(0.0), 0.4);
/// assert!((law.kinetic(0.5) - 0.25).abs() < 1e-16);
/// assert!(law.slope(0.5).abs() < 1e-16);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::Polynomial")
)]
pub struct Polynomial {
    static_coefficient: f64,
    minimum_coefficient: f64,
    minimum_velocity: f64,
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    k1: f64,
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    k3: f64,
}

impl Polynomial {
    /// Creates a law with static coefficient μ_s, least coefficient μ_m, and the sliding speed v_m
    /// at the minimum.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless all are finite, 0 ≤ μ_m ≤ μ_s, v_m > 0, and k1 and k3
    /// neither overflow nor underflow.
    pub fn new(
        static_coefficient: f64,
        minimum_coefficient: f64,
        minimum_velocity: f64,
    ) -> Result<Self, Error> {
        let (mu_s, mu_m, v_m) = (static_coefficient, minimum_coefficient, minimum_velocity);
        check_static("Polynomial", mu_s)?;
        Error::check(
            "Polynomial",
            "minimum_coefficient",
            mu_m,
            (0.0..=mu_s).contains(&mu_m),
            "0 ≤ minimum_coefficient ≤ static_coefficient",
        )?;
        let k1 = 1.5 * (mu_s - mu_m) / v_m;
        let k3 = 0.5 * (mu_s - mu_m) / v_m / v_m / v_m;
        let in_range = [k1, k3].iter().all(|k| k.is_normal()) || mu_m == mu_s;
        Error::check(
            "Polynomial",
            "minimum_velocity",
            v_m,
            v_m > 0.0 && in_range,
            "minimum_velocity > 0, and (μ_s − μ_m)/v_m³ within the range of f64",
        )?;
        Ok(Self {
            static_coefficient,
            minimum_coefficient,
            minimum_velocity,
            k1,
            k3,
        })
    }

    /// Least kinetic coefficient μ_m, dimensionless.
    pub fn minimum_coefficient(&self) -> f64 {
        self.minimum_coefficient
    }

    /// Sliding speed v_m of the least coefficient, in the unit of velocity.
    pub fn minimum_velocity(&self) -> f64 {
        self.minimum_velocity
    }
}

impl FrictionLaw for Polynomial {
    fn static_coefficient(&self) -> f64 {
        self.static_coefficient
    }

    #[inline(always)]
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        (speed.square() * self.k3 - self.k1) * speed + self.static_coefficient
    }

    #[inline(never)]
    fn erased(&self) -> LawRef<'_> {
        LawRef::of(self)
    }
    fn any(&self, _: Own) -> Option<AnyLaw> {
        Some((*self).into())
    }
}
