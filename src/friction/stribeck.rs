use super::check::check_static;
use super::{AnyLaw, FrictionLaw, LawRef, LawVisitor, Own};
use crate::error::Error;
use crate::scalar::Scalar;

/// The Stribeck law, which falls from μ_s towards the Coulomb coefficient μ_c and rises again by a
/// viscous term.
///
/// ```text
/// μ̂(s) = μ_c + (μ_s − μ_c) exp(−(s/v_s)^δ) + k_v s
/// ```
///
/// μ̂(s) is the kinetic coefficient at the sliding speed s, μ_s the static coefficient, v_s the
/// Stribeck velocity, δ the exponent, and k_v the viscous coefficient. Coefficients are
/// dimensionless. Speeds are in the unit of velocity of the system
/// ([`FrictionLaw`](crate::FrictionLaw)); k_v is in 1/speed. δ = 1 gives Tustin's law, which many
/// papers call "the exponential law". δ = 2 gives the Gaussian law of Armstrong-Hélouvry; without a
/// viscous term this is the crate's [`Exponential`](crate::Exponential). A motion with δ > 4 takes
/// two to four times as long as one with δ ≤ 4.
///
/// The exponent must be a whole number. Bo and Pavelescu found ½ ≤ δ ≤ 1 in their measurements.
/// However, a law with a fractional δ has no power series at s = 0, where slip begins. (For δ = ½
/// even the slope is infinite there.) Use [`Tabulated`](crate::Tabulated) for such a curve.
///
/// Source: Bo and Pavelescu, *Wear* 82 (1982) 277-289; Armstrong-Hélouvry, Dupont and Canudas de
/// Wit, *Automatica* 30 (1994) 1083-1138.
///
/// ```
/// use stick_slip::{FrictionLaw, Stribeck};
///
/// let law = Stribeck::new(0.4, 0.25, 0.5, 1)?.with_viscous_coefficient(0.02)?;
/// assert_eq!(law.kinetic(0.0), 0.4);
/// assert!((law.kinetic(1.0) - (0.25 + 0.15 * (-2.0_f64).exp() + 0.02)).abs() < 1e-16);
/// // −(μ_s − μ_c)/v_s + k_v: with δ = 1 the fall is steepest at s = 0
/// assert!((law.slope(0.0) - (-0.3 + 0.02)).abs() < 1e-16);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::Stribeck")
)]
pub struct Stribeck {
    static_coefficient: f64,
    coulomb_coefficient: f64,
    stribeck_velocity: f64,
    exponent: u32,
    viscous_coefficient: f64,
    /// 1/v_s.
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    rate: f64,
}

/// Exponent beyond which the exponential term is left out: exp(−x) and all its derivatives are zero
/// in `f64` for any larger x.
const UNDERFLOW: f64 = 1000.0;

impl Stribeck {
    /// Creates a law with static coefficient μ_s, Coulomb coefficient μ_c, Stribeck velocity v_s
    /// and exponent δ, without a viscous term.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless all are finite, 0 ≤ μ_c ≤ μ_s, v_s > 0, 1/v_s does not
    /// overflow, and 1 ≤ δ < 2³¹.
    pub fn new(
        static_coefficient: f64,
        coulomb_coefficient: f64,
        stribeck_velocity: f64,
        exponent: u32,
    ) -> Result<Self, Error> {
        check_static("Stribeck", static_coefficient)?;
        Error::check(
            "Stribeck",
            "coulomb_coefficient",
            coulomb_coefficient,
            (0.0..=static_coefficient).contains(&coulomb_coefficient),
            "0 ≤ coulomb_coefficient ≤ static_coefficient",
        )?;
        let rate = stribeck_velocity.recip();
        Error::check(
            "Stribeck",
            "stribeck_velocity",
            stribeck_velocity,
            stribeck_velocity > 0.0 && rate.is_finite(),
            "stribeck_velocity > 0, and not so small that 1/v_s overflows",
        )?;
        Error::check(
            "Stribeck",
            "exponent",
            f64::from(exponent),
            (1..1 << 31).contains(&exponent),
            "1 ≤ exponent < 2³¹",
        )?;
        Ok(Self {
            static_coefficient,
            coulomb_coefficient,
            stribeck_velocity,
            exponent,
            viscous_coefficient: 0.0,
            rate,
        })
    }

    /// Sets the viscous coefficient k_v, in 1/speed.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless k_v is finite and ≥ 0.
    pub fn with_viscous_coefficient(mut self, viscous_coefficient: f64) -> Result<Self, Error> {
        self.viscous_coefficient = Error::check(
            "Stribeck",
            "viscous_coefficient",
            viscous_coefficient,
            viscous_coefficient >= 0.0,
            "viscous_coefficient ≥ 0",
        )?;
        Ok(self)
    }

    /// Coulomb coefficient μ_c, dimensionless.
    pub fn coulomb_coefficient(&self) -> f64 {
        self.coulomb_coefficient
    }

    /// Stribeck velocity v_s, in the unit of velocity.
    pub fn stribeck_velocity(&self) -> f64 {
        self.stribeck_velocity
    }

    /// Exponent δ, a whole number.
    pub fn exponent(&self) -> u32 {
        self.exponent
    }

    /// Viscous coefficient k_v, in 1/speed; 0 unless set.
    pub fn viscous_coefficient(&self) -> f64 {
        self.viscous_coefficient
    }
}

impl Stribeck {
    #[inline(always)]
    fn with_exponent<S: Scalar>(&self, exponent: i32, speed: S) -> S {
        let ratio = speed * self.rate;
        let fall = match exponent {
            1 => (-ratio).exp(),
            2 => (-ratio.square()).exp(),
            // For a large δ, (s/v_s)^δ overflows, and 0·∞ would give no slope.
            n if ratio.value().powi(n) > UNDERFLOW => speed.constant(0.0),
            n => (-ratio.powi(n)).exp(),
        };
        let falling =
            fall * (self.static_coefficient - self.coulomb_coefficient) + self.coulomb_coefficient;
        if self.viscous_coefficient == 0.0 {
            falling
        } else {
            falling + speed * self.viscous_coefficient
        }
    }
}

/// The law with an exponent that the compiler knows.
struct WithExponent<'l, const EXPONENT: i32>(&'l Stribeck);

impl<const EXPONENT: i32> FrictionLaw for WithExponent<'_, EXPONENT> {
    fn static_coefficient(&self) -> f64 {
        self.0.static_coefficient
    }

    #[inline(always)]
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        self.0.with_exponent(EXPONENT, speed)
    }
}

impl FrictionLaw for Stribeck {
    fn static_coefficient(&self) -> f64 {
        self.static_coefficient
    }

    #[inline(always)]
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        self.with_exponent(self.exponent as i32, speed)
    }

    /// The series of usual exponents are compiled for each; one code for all exponents would take
    /// longer to compile than all other laws together.
    #[inline(always)]
    fn give_to<V: LawVisitor>(&self, visitor: V) -> V::Output {
        match self.exponent {
            1 => visitor.visit(&WithExponent::<1>(self)),
            2 => visitor.visit(&WithExponent::<2>(self)),
            3 => visitor.visit(&WithExponent::<3>(self)),
            4 => visitor.visit(&WithExponent::<4>(self)),
            _ => visitor.visit_seldom(self),
        }
    }

    #[inline(never)]
    fn erased(&self) -> LawRef<'_> {
        LawRef::of(self)
    }
    fn any(&self, _: Own) -> Option<AnyLaw> {
        Some((*self).into())
    }
}
