use super::{AnyLaw, FrictionLaw, LawRef};
use crate::error::Error;
use crate::scalar::Scalar;

/// A law through measured points: a monotone piecewise cubic (PCHIP).
///
/// ```text
/// μ̂(s) = μ_i + d_i t + c_i t² + b_i t³,   t = s − s_i,   s_i ≤ s ≤ s_{i+1}
/// ```
///
/// μ̂(s) is the kinetic coefficient at the sliding speed s. The points are (s_i, μ_i); b_i, c_i and
/// d_i are the coefficients of the cubic above point i. The friction coefficients μ_i are
/// dimensionless. Speeds are in the unit of velocity of the system ([`FrictionLaw`]). The law goes
/// through every point and has a continuous slope. It is monotone between two neighbouring points,
/// so its values there lie between the coefficients of these points. The slope d_i at an inner
/// point i is the weighted harmonic mean of the slopes of the two chords that meet there, or 0 if
/// these slopes have opposite signs.
///
/// The first point must be at s = 0, because slip begins and ends at s = 0, and the slope of the
/// law near s = 0 has a large effect on stick-slip. If your measurements do not reach such low
/// speeds, extrapolate them to s = 0, or use the static coefficient as the coefficient at s = 0.
///
/// Above the last point the coefficient is constant. The slope at the last point is therefore 0:
/// between the last two points the law levels off. Measure up to the largest sliding speed of the
/// motion, which is often twice the belt velocity or more.
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
/// let law = Tabulated::new([(0.0, 0.4), (0.1, 0.33), (0.3, 0.27), (0.6, 0.25), (1.0, 0.26)])?;
/// assert_eq!(law.kinetic(0.3), 0.27);
/// assert!(law.kinetic(0.2) < 0.33 && law.kinetic(0.2) > 0.27);
/// assert_eq!(law.slope(0.6), 0.0); // the chords fall and rise here
/// assert_eq!(law.kinetic(5.0), 0.26);
/// assert_eq!(law.static_coefficient(), 0.4);
/// assert_eq!(law.breakpoints().count(), 4);
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
    /// Piece i holds from its start to the start of piece i + 1; the last piece has no end.
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    pieces: Vec<Piece>,
}

/// The cubic Σ c_k (s − start)^k.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    start: f64,
    c: [f64; 4],
}

impl Tabulated {
    /// Creates a law through the points (s_i, μ_i). The speeds s_i ascend and begin with 0.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if there are fewer than two points; [`Error::BadPoint`], with
    /// the first point at fault, if a number is negative or not finite, if the first speed is not
    /// 0, if the speeds do not ascend strictly, or if a coefficient of a cubic overflows.
    pub fn new(points: impl IntoIterator<Item = (f64, f64)>) -> Result<Self, Error> {
        let points: Vec<_> = points.into_iter().collect();
        Error::check(
            "Tabulated",
            "points",
            points.len() as f64,
            points.len() >= 2,
            "points ≥ 2: the number of measured points",
        )?;
        let mut last = None;
        for (index, &(speed, coefficient)) in points.iter().enumerate() {
            let (in_order, allowed) = match last {
                None => (speed == 0.0, "speed = 0 at the first point: add one there"),
                Some(last) => (speed > last, "each speed greater than the one before"),
            };
            Error::check("Tabulated", "speed", speed, in_order, allowed)
                .and_then(|_| {
                    Error::check(
                        "Tabulated",
                        "coefficient",
                        coefficient,
                        coefficient >= 0.0,
                        "coefficient ≥ 0",
                    )
                })
                .map_err(|error| error.at_point(index))?;
            last = Some(speed);
        }
        let pieces = pieces(&points);
        for (index, piece) in pieces.iter().enumerate() {
            // A piece whose coefficients overflow is the fault of the point at its end.
            let next = (index + 1).min(points.len() - 1);
            Error::check(
                "Tabulated",
                "speed",
                points[next].0,
                piece.c.iter().all(|c| c.is_finite()),
                "so far from the speed before that the slopes between them do not overflow",
            )
            .map_err(|error| error.at_point(next))?;
        }
        Ok(Self {
            static_coefficient: points[0].1,
            points,
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
}

/// The cubics, and the constant above the last point.
fn pieces(points: &[(f64, f64)]) -> Vec<Piece> {
    let chords: Vec<Chord> = points.windows(2).map(Chord::new).collect();
    let first = match chords.as_slice() {
        [chord] => chord.slope,
        [chord, next, ..] => end_slope(*chord, *next),
        [] => return Vec::new(),
    };
    let inner = chords.windows(2).map(|pair| inner_slope(pair[0], pair[1]));
    let slopes = std::iter::once(first).chain(inner).chain([0.0]);
    let slopes: Vec<f64> = slopes.collect();

    let cubics = points.iter().zip(&chords).zip(slopes.windows(2));
    let cubics = cubics.map(|((&(start, value), chord), slopes)| {
        let (d0, d1) = (slopes[0], slopes[1]);
        let c2 = (3.0 * chord.slope - 2.0 * d0 - d1) / chord.length;
        let c3 = (d0 - 2.0 * chord.slope + d1) / chord.length / chord.length;
        Piece {
            start,
            c: [value, d0, c2, c3],
        }
    });
    let above = points.last().map(|&(start, value)| Piece {
        start,
        c: [value, 0.0, 0.0, 0.0],
    });
    cubics.chain(above).collect()
}

/// The straight line between two neighbouring points.
#[derive(Clone, Copy)]
struct Chord {
    length: f64,
    slope: f64,
}

impl Chord {
    fn new(ends: &[(f64, f64)]) -> Self {
        let length = ends[1].0 - ends[0].0;
        let slope = (ends[1].1 - ends[0].1) / length;
        Self { length, slope }
    }

    fn turns(self, next: Self) -> bool {
        self.slope == 0.0 || next.slope == 0.0 || self.slope.signum() != next.slope.signum()
    }
}

/// Slope at an inner point (Fritsch and Butland): (w1 + w2)/(w1/m1 + w2/m2), w1 = h1 + 2 h2, w2 = 2
/// h1 + h2.
fn inner_slope(before: Chord, after: Chord) -> f64 {
    if before.turns(after) {
        return 0.0;
    }
    let w1 = before.length + 2.0 * after.length;
    let w2 = 2.0 * before.length + after.length;
    (w1 + w2) / (w1 / before.slope + w2 / after.slope)
}

/// Slope at the first point: that of the parabola through three points, limited so that the cubic
/// stays monotone.
fn end_slope(chord: Chord, next: Chord) -> f64 {
    let (h1, h2) = (chord.length, next.length);
    let slope = ((2.0 * h1 + h2) * chord.slope - h1 * next.slope) / (h1 + h2);
    if slope * chord.slope.signum() <= 0.0 || chord.slope == 0.0 {
        0.0
    } else if chord.turns(next) && slope.abs() > 3.0 * chord.slope.abs() {
        3.0 * chord.slope
    } else {
        slope
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
        let Some(&Piece { start, c }) = self.pieces.get(piece).or(self.pieces.last()) else {
            return speed.constant(f64::NAN);
        };
        let t = speed - start;
        ((t * c[3] + c[2]) * t + c[1]) * t + c[0]
    }

    #[inline(never)]
    fn erased(&self) -> LawRef<'_> {
        LawRef::of(self)
    }
    fn any(&self) -> Option<AnyLaw> {
        Some(self.clone().into())
    }
}
