//! Friction laws: the coefficient as a function of the sliding speed.

mod any;
mod coulomb;
mod exponential;
pub(crate) mod memory;
mod polynomial;
mod rational;
mod stribeck;
mod tabulated;

pub use any::AnyLaw;
pub use coulomb::Coulomb;
pub use exponential::Exponential;
pub use polynomial::Polynomial;
pub use rational::Rational;
pub use stribeck::Stribeck;
pub use tabulated::Tabulated;

use crate::error::Error;
use crate::scalar::{Function, LONGEST, Scalar, Workspace, expand};

/// A dry friction law: the static coefficient, and the kinetic coefficient μ̂(s) at sliding speed s
/// = |v_r| ≥ 0.
///
/// The full law is odd in the relative velocity v_r = v − v_b: μ(v_r) = sgn(v_r)·μ̂(|v_r|). All
/// coefficients and speeds are dimensionless.
///
/// # What to write
///
/// Two functions. [`kinetic`](Self::kinetic) is generic over the number type, so that the crate can
/// take its power series along a motion and its exact derivatives; nothing else is ever
/// differentiated by hand. The rules for it are those of [`Scalar`].
///
/// ```
/// use stick_slip::{FrictionLaw, MassOnBelt, Scalar, State};
///
/// /// Leine et al., Nonlinear Dynamics 16 (1998) 41-54: μ̂(s) = μ_s/(1 + δ s).
/// struct Leine {
///     static_coefficient: f64,
///     decay: f64,
/// }
///
/// impl FrictionLaw for Leine {
///     fn static_coefficient(&self) -> f64 {
///         self.static_coefficient
///     }
///     #[inline]
///     fn kinetic<S: Scalar>(&self, speed: S) -> S {
///         (speed * self.decay + 1.0).recip() * self.static_coefficient
///     }
/// }
///
/// let law = Leine { static_coefficient: 1.0, decay: 3.0 };
/// assert_eq!(law.slope(0.0), -3.0);
///
/// let motion = MassOnBelt::new(law, 0.2)?.simulate(State::new(0.0, 0.0), 30.0)?;
/// let events = motion.events();
/// let period = events[4].time - events[2].time;
/// assert!((period - 12.0010312948).abs() < 1e-9);
/// # Ok::<(), stick_slip::Error>(())
/// ```
///
/// Mark `kinetic` as `#[inline]`: the compiler then puts it into the integrator, and a law of your
/// own runs as fast as one of the crate's. Without the attribute it may stay a call for each order
/// of each series, at about 1.5 times the cost.
///
/// # Piecewise laws
///
/// A law that is analytic only piece by piece (a table, a kink) must be continuous. It names the
/// speeds where pieces meet in [`breakpoints`](Self::breakpoints) and gives piece i, for breakpoint
/// i−1 ≤ s ≤ breakpoint i, in [`kinetic_on`](Self::kinetic_on). The integrator ends a step exactly
/// at a breakpoint and says which piece comes next, so a law never has to decide by comparing a
/// speed that lies on one. Every piece is also evaluated a little outside its interval.
///
/// # What a law must not do
///
/// Give different results for the same speed; panic; return NaN or ±∞ at a speed that the motion
/// reaches (a typed error, not a wrong result). It must hold μ̂(0) ≤ μ_s, to a few ulps;
/// [`MassOnBelt::new`](crate::MassOnBelt::new) checks that.
pub trait FrictionLaw: Sized {
    /// Static coefficient μ_s: the mass sticks while the contact carries at most γ²μ_s.
    /// Dimensionless.
    fn static_coefficient(&self) -> f64;

    /// Kinetic coefficient μ̂(s) at sliding speed s ≥ 0; at s = 0 its limit from above.
    /// Dimensionless.
    fn kinetic<S: Scalar>(&self, speed: S) -> S;

    /// Speeds at which the pieces of the law meet: finitely many, ascending, positive. None for an
    /// analytic law; but one that has a very narrow feature away from s = 0 should name its place
    /// and its ends, so that no step passes over it.
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        std::iter::empty()
    }

    /// Piece number `piece` of the law, continued analytically beyond its ends. An analytic law has
    /// one piece.
    #[inline(always)]
    fn kinetic_on<S: Scalar>(&self, _piece: usize, speed: S) -> S {
        self.kinetic(speed)
    }

    /// Friction coefficient μ(v_r) = sgn(v_r)·μ̂(|v_r|) at a relative velocity of either sign; 0 at
    /// 0.
    ///
    /// ```
    /// use stick_slip::{Coulomb, FrictionLaw};
    ///
    /// let law = Coulomb::new(0.4, 0.25)?;
    /// assert_eq!(law.coefficient(-0.1), -0.25);
    /// assert_eq!(law.coefficient(0.0), 0.0);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    fn coefficient(&self, relative_velocity: f64) -> f64 {
        if relative_velocity == 0.0 {
            0.0
        } else {
            self.kinetic(relative_velocity.abs()) * relative_velocity.signum()
        }
    }

    /// dμ̂/ds at sliding speed s, exact to rounding; at a breakpoint the slope of the piece above.
    ///
    /// ```
    /// use stick_slip::{FrictionLaw, Polynomial};
    ///
    /// // −k1 + 3 k3 s²  (Eqs. 3-5)
    /// let law = Polynomial::new(0.4, 0.25, 0.5)?;
    /// assert!((law.slope(0.2) - (-0.45 + 3.0 * 0.6 * 0.04)).abs() < 1e-16);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    fn slope(&self, speed: f64) -> f64 {
        taylor_coefficients::<2, _>(&self, speed)[1]
    }

    /// d²μ̂/ds² at sliding speed s, exact to rounding; at a breakpoint that of the piece above.
    ///
    /// ```
    /// use stick_slip::{FrictionLaw, Polynomial};
    ///
    /// // 6 k3 s  (Eqs. 3-5)
    /// let law = Polynomial::new(0.4, 0.25, 0.5)?;
    /// assert!((law.curvature(0.2) - 6.0 * 0.6 * 0.2).abs() < 1e-15);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    fn curvature(&self, speed: f64) -> f64 {
        2.0 * taylor_coefficients::<4, _>(&self, speed)[2]
    }

    /// n-th derivative of μ̂ at sliding speed s, exact to rounding; at a breakpoint that of the
    /// piece above. NaN for n > 30.
    ///
    /// ```
    /// use stick_slip::{Exponential, FrictionLaw};
    ///
    /// // d⁴/ds⁴ exp(−s²) = 12 at s = 0
    /// let law = Exponential::new(1.25, 0.25, 1.0)?;
    /// assert!((law.derivative(4, 0.0) - 12.0).abs() < 1e-14);
    /// # Ok::<(), stick_slip::Error>(())
    /// ```
    fn derivative(&self, n: usize, speed: f64) -> f64 {
        let factorial: f64 = (1..=n.min(LONGEST)).map(|k| k as f64).product();
        taylor_coefficients::<LONGEST, _>(&self, speed)
            .get(n)
            .map_or(f64::NAN, |coefficient| coefficient * factorial)
    }
}

impl<L: FrictionLaw> FrictionLaw for &L {
    fn static_coefficient(&self) -> f64 {
        (**self).static_coefficient()
    }
    #[inline(always)]
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        (**self).kinetic(speed)
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        (**self).breakpoints()
    }
    #[inline(always)]
    fn kinetic_on<S: Scalar>(&self, piece: usize, speed: S) -> S {
        (**self).kinetic_on(piece, speed)
    }
}

/// One analytic piece of a law, by its number.
#[derive(Debug)]
pub(crate) struct Piece<'l, L> {
    pub(crate) law: &'l L,
    pub(crate) index: usize,
}

impl<L> Clone for Piece<'_, L> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<L> Copy for Piece<'_, L> {}

impl<L: FrictionLaw> Function for Piece<'_, L> {
    #[inline(always)]
    fn at<S: Scalar>(self, speed: S) -> S {
        self.law.kinetic_on(self.index, speed)
    }
}

/// The piece that holds speeds just above `speed`.
pub(crate) fn piece_above<L: FrictionLaw>(law: &L, speed: f64) -> usize {
    law.breakpoints().take_while(|&b| b <= speed).count()
}

/// Coefficients of μ̂ as a power series in the sliding speed about `speed`; those from order M − 1
/// on are not computed (order 1 always is).
pub(crate) fn taylor_coefficients<const M: usize, L: FrictionLaw>(law: &L, speed: f64) -> [f64; M] {
    taylor_coefficients_on(law, piece_above(law, speed), speed)
}

/// The same for one piece of the law.
pub(crate) fn taylor_coefficients_on<const M: usize, L: FrictionLaw>(
    law: &L,
    piece: usize,
    speed: f64,
) -> [f64; M] {
    let mut series = [f64::NAN; M];
    (series[0], series[1]) = expand(
        Piece { law, index: piece },
        &mut Workspace::<M>::new(),
        speed,
        |k, _, m| {
            if k >= 2 {
                series[k] = m.scale * m.rest;
            }
            // s = s_0 + t
            if k == 0 { 1.0 } else { 0.0 }
        },
    );
    series
}

/// Checks what the trait asks of a law and a system relies on: μ_s finite and ≥ μ̂(0), breakpoints
/// in order, the law continuous.
pub(crate) fn validate<L: FrictionLaw>(law: &L) -> Result<(), Error> {
    let static_coefficient = law.static_coefficient();
    Error::check(
        "static_coefficient",
        static_coefficient,
        static_coefficient >= 0.0,
        "static_coefficient ≥ 0",
    )?;
    let kinetic_coefficient = law.kinetic(0.0);
    finite_at(law, 0.0)?;
    if kinetic_coefficient > static_coefficient * (1.0 + 8.0 * f64::EPSILON) {
        return Err(Error::StaticBelowKinetic {
            static_coefficient,
            kinetic_coefficient,
        });
    }
    let mut last = 0.0;
    for (index, value) in law.breakpoints().enumerate() {
        let (below, above) = (
            law.kinetic_on(index, value),
            law.kinetic_on(index + 1, value),
        );
        let scale = static_coefficient.max(below.abs());
        let continuous = (below - above).abs() <= JUMP * scale;
        if !(value.is_finite() && value > last && continuous) {
            return Err(Error::BadBreakpoints { index, value });
        }
        last = value;
    }
    Ok(())
}

/// Largest relative jump at a breakpoint that counts as rounding.
pub(crate) const JUMP: f64 = 1e-12;

/// The law has a finite value and slope at `speed`.
pub(crate) fn finite_at<L: FrictionLaw>(law: &L, speed: f64) -> Result<(), Error> {
    slope_on(law, piece_above(law, speed), speed).map(|_| ())
}

/// dμ̂/ds on one piece of the law.
pub(crate) fn slope_on<L: FrictionLaw>(law: &L, piece: usize, speed: f64) -> Result<f64, Error> {
    let [value, slope] = taylor_coefficients_on::<2, _>(law, piece, speed);
    if !value.is_finite() {
        Err(Error::NonFiniteFriction {
            speed,
            value,
            reached: None,
        })
    } else if !slope.is_finite() {
        Err(Error::NotAnalytic {
            speed,
            reached: None,
        })
    } else {
        Ok(slope)
    }
}

/// Whether friction does not depend on the sliding speed near this one: all derivatives of the law
/// are zero.
pub(crate) fn is_constant_near<L: FrictionLaw>(law: &L, speed: f64) -> bool {
    is_constant(&taylor_coefficients(law, speed))
}

/// Whether there is no kinetic friction at any speed: on each piece the law and all its derivatives
/// are zero.
pub(crate) fn has_no_kinetic_friction<L: FrictionLaw>(law: &L) -> bool {
    let starts = std::iter::once(0.0).chain(law.breakpoints());
    starts.enumerate().all(|(piece, speed)| {
        let series = taylor_coefficients_on(law, piece, speed);
        series[0] == 0.0 && is_constant(&series)
    })
}

/// The last coefficient is not computed.
fn is_constant(series: &[f64; LONGEST]) -> bool {
    series[1..LONGEST - 1].iter().all(|&c| c == 0.0)
}
