use super::{AnyLaw, FrictionLaw, LawRef, Own};
use crate::error::Error;
use crate::numerics::interpolation::{Above, Cubic, Join, Names, checked_pieces};
use crate::scalar::Scalar;

/// A law through measured points, joined by monotone cubics (PCHIP) or by straight lines.
///
/// ```text
/// μ̂(s) = μ_i + d_i t + c_i t² + b_i t³,   t = s − s_i,   s_i ≤ s ≤ s_{i+1}
/// ```
///
/// μ̂(s) is the kinetic coefficient at the sliding speed s. The points are (s_i, μ_i); b_i, c_i and
/// d_i are the coefficients of the polynomial above point i. The friction coefficients μ_i are
/// dimensionless. Speeds are in the unit of velocity of the system ([`FrictionLaw`]). The law goes
/// through every point. It is monotone between two neighbouring points, so its values there lie
/// between the coefficients of these points, to rounding.
///
/// * [`Tabulated::new`] joins the points by cubics, so that the slope is continuous. The slope d_i
///   at an inner point i is the weighted harmonic mean of the slopes of the two chords that meet
///   there, or 0 if these slopes have opposite signs.
/// * [`Tabulated::piecewise_linear`] joins them by straight lines: b_i = c_i = 0, and d_i is the
///   slope of the chord. Tables of Modelica and Simscape and lists of points in papers usually have
///   this meaning.
///
/// The first point must be at s = 0, because slip begins and ends at s = 0, and the slope of the
/// law near s = 0 has a large effect on stick-slip. If your measurements do not reach such low
/// speeds, extrapolate them to s = 0, or use the static coefficient as the coefficient at s = 0.
///
/// Above the last point the coefficient is constant. The slope of the cubics at the last point is
/// therefore 0: between the last two points the law levels off. Measure up to the largest sliding
/// speed of the motion, which is often twice the belt velocity or more.
///
/// The static coefficient μ_s is μ̂(0), unless set by
/// [`with_static_coefficient`](Self::with_static_coefficient).
///
/// All points except the first are [breakpoints](FrictionLaw::breakpoints): the integrator ends a
/// step at each point that the motion passes. A few dozen points are enough. Average scattered
/// measurements before you use them as points, and reduce thousands of points to a few dozen.
///
/// Source: Fritsch and Carlson, *SIAM J. Numer. Anal.* 17 (1980) 238-246; slopes of Fritsch and
/// Butland, *SIAM J. Sci. Stat. Comput.* 5 (1984) 300-304, with the end formula of Moler,
/// *Numerical Computing with MATLAB* (SIAM 2004), section 3.6, at the first point.
///
/// ```
/// use stick_slip::{FrictionLaw, Tabulated};
///
/// let points = [(0.0, 0.4), (0.1, 0.33), (0.3, 0.27), (0.6, 0.25), (1.0, 0.26)];
/// let law = Tabulated::new(points)?;
/// assert_eq!(law.kinetic(0.3), 0.27);
/// assert!(law.kinetic(0.2) < 0.33 && law.kinetic(0.2) > 0.27);
/// assert_eq!(law.slope(0.6), 0.0); // the chords fall and rise here
/// assert_eq!(law.kinetic(5.0), 0.26);
/// assert_eq!(law.static_coefficient(), 0.4);
/// assert_eq!(law.breakpoints().count(), 4);
///
/// let lines = Tabulated::piecewise_linear(points)?;
/// assert!((lines.kinetic(0.2) - 0.3).abs() < 1e-16);
/// assert!((lines.slope(0.2) + 0.3).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::Tabulated")
)]
pub struct Tabulated {
    static_coefficient: f64,
    points: Vec<(f64, f64)>,
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "std::ops::Not::not"))]
    piecewise_linear: bool,
    /// Piece i holds from its start to the start of piece i + 1; the last piece has no end.
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    pieces: Vec<Cubic>,
}

impl Tabulated {
    /// Creates a law of monotone cubics through the points (s_i, μ_i). The speeds s_i ascend and
    /// begin with 0.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if there are fewer than two points; [`Error::BadPoint`], with
    /// the first point at fault, if a number is negative or not finite, if the first speed is not
    /// 0, if the speeds do not ascend strictly, or if a coefficient of a cubic overflows.
    pub fn new(points: impl IntoIterator<Item = (f64, f64)>) -> Result<Self, Error> {
        Self::joined(points.into_iter().collect(), Join::Cubics)
    }

    /// Creates a law of straight lines through the points (s_i, μ_i). The speeds s_i ascend and
    /// begin with 0.
    ///
    /// # Errors
    ///
    /// The errors of [`new`](Self::new).
    pub fn piecewise_linear(points: impl IntoIterator<Item = (f64, f64)>) -> Result<Self, Error> {
        Self::joined(points.into_iter().collect(), Join::Lines)
    }

    fn joined(points: Vec<(f64, f64)>, join: Join) -> Result<Self, Error> {
        let names = Names {
            of: "Tabulated",
            x: "speed",
            y: "coefficient",
        };
        let check = |index, (speed, coefficient)| {
            let allowed = "speed = 0 at the first point: add one there";
            Error::check(names.of, names.x, speed, index > 0 || speed == 0.0, allowed)?;
            let is_friction = coefficient >= 0.0;
            Error::check(
                names.of,
                names.y,
                coefficient,
                is_friction,
                "coefficient ≥ 0",
            )?;
            Ok(())
        };
        let pieces = checked_pieces(names, &points, (join, Above::Constant), check)?;
        Ok(Self {
            static_coefficient: points[0].1,
            points,
            piecewise_linear: join == Join::Lines,
            pieces,
        })
    }

    /// Sets the static coefficient μ_s, dimensionless.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] unless μ_s is finite and ≥ μ̂(0).
    pub fn with_static_coefficient(mut self, static_coefficient: f64) -> Result<Self, Error> {
        self.static_coefficient = Error::check(
            "Tabulated",
            "static_coefficient",
            static_coefficient,
            static_coefficient >= self.kinetic(0.0),
            "static_coefficient ≥ μ̂(0), the coefficient of the table at speed 0",
        )?;
        Ok(self)
    }

    /// The points (s_i, μ_i).
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points
    }

    /// Returns true if straight lines join the points.
    pub fn is_piecewise_linear(&self) -> bool {
        self.piecewise_linear
    }
}

impl FrictionLaw for Tabulated {
    fn static_coefficient(&self) -> f64 {
        self.static_coefficient
    }

    #[inline]
    fn kinetic<S: Scalar>(&self, speed: S) -> S {
        let value = speed.value();
        let started = self.pieces.partition_point(|piece| piece.start <= value);
        self.kinetic_on(started.saturating_sub(1), speed)
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        self.pieces.iter().skip(1).map(|piece| piece.start)
    }

    #[inline(always)]
    fn kinetic_on<S: Scalar>(&self, piece: usize, speed: S) -> S {
        match self.pieces.get(piece).or(self.pieces.last()) {
            Some(piece) => piece.at(speed),
            None => speed.constant(f64::NAN),
        }
    }

    #[inline(never)]
    fn erased(&self) -> LawRef<'_> {
        LawRef::of(self)
    }
    fn any(&self, _: Own) -> Option<AnyLaw> {
        Some(self.clone().into())
    }
}
