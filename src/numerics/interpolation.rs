//! Curves through the points of a table: straight lines, or monotone cubics (PCHIP), between
//! neighbouring points.
//!
//! Source: Fritsch and Carlson, *SIAM J. Numer. Anal.* 17 (1980) 238-246; slopes of Fritsch and
//! Butland, *SIAM J. Sci. Stat. Comput.* 5 (1984) 300-304, with the end formula of Moler,
//! *Numerical Computing with MATLAB* (SIAM 2004), section 3.6.

use crate::error::Error;
use crate::scalar::Scalar;

/// The names that messages give to a table and to the two numbers of its points.
#[derive(Clone, Copy)]
pub(crate) struct Names {
    pub(crate) of: &'static str,
    pub(crate) x: &'static str,
    pub(crate) y: &'static str,
}

/// The curve between neighbouring points.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Join {
    Cubics,
    Lines,
}

/// The curve above the last point.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Above {
    /// Cubics reach the last point with the slope 0.
    Constant,
    /// A straight line continues with the slope at the last point.
    Line,
}

/// The polynomial Σ c_k (x − start)^k.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Cubic {
    pub(crate) start: f64,
    pub(crate) c: [f64; 4],
}

impl Cubic {
    pub(crate) fn line((start, value): (f64, f64), slope: f64) -> Self {
        Self {
            start,
            c: [value, slope, 0.0, 0.0],
        }
    }

    /// The cubic between two points with these slopes there.
    fn between(start: (f64, f64), chord: Chord, [d0, d1]: [f64; 2]) -> Self {
        let c2 = (3.0 * chord.slope - 2.0 * d0 - d1) / chord.length;
        let c3 = (d0 - 2.0 * chord.slope + d1) / chord.length / chord.length;
        Self {
            start: start.0,
            c: [start.1, d0, c2, c3],
        }
    }

    #[inline(always)]
    pub(crate) fn at<S: Scalar>(&self, x: S) -> S {
        let Self { start, c } = *self;
        let t = x - start;
        ((t * c[3] + c[2]) * t + c[1]) * t + c[0]
    }
}

/// The piece above each of the points, of which there are at least two.
pub(crate) fn pieces(points: &[(f64, f64)], join: Join, above: Above) -> Vec<Cubic> {
    let chords: Vec<Chord> = points.windows(2).map(Chord::new).collect();
    let (Some(&first), Some(&last), Some(&end)) = (chords.first(), chords.last(), points.last())
    else {
        return Vec::new();
    };
    let mut pieces = Vec::with_capacity(points.len());
    let last_slope = match join {
        Join::Lines => {
            let lines = std::iter::zip(points, &chords);
            pieces.extend(lines.map(|(&point, chord)| Cubic::line(point, chord.slope)));
            last.slope
        }
        Join::Cubics => {
            let inner = chords.windows(2).map(|pair| inner_slope(pair[0], pair[1]));
            let first = end_slope(first, chords.get(1));
            let last = match above {
                Above::Constant => 0.0,
                Above::Line => end_slope(last, chords.iter().rev().nth(1)),
            };
            let slopes: Vec<f64> = std::iter::once(first).chain(inner).chain([last]).collect();
            let cubics = std::iter::zip(points, &chords).zip(slopes.windows(2));
            pieces.extend(
                cubics.map(|((&point, &chord), d)| Cubic::between(point, chord, [d[0], d[1]])),
            );
            last
        }
    };
    let above = match above {
        Above::Constant => 0.0,
        Above::Line => last_slope,
    };
    pieces.push(Cubic::line(end, above));
    pieces
}

/// The [`pieces`] of a table. `check` refuses points by rules of its own.
///
/// # Errors
///
/// [`Error::InvalidParameter`] if there are fewer than two points; [`Error::BadPoint`] with the
/// first point at fault: a number that is not finite, an x that does not ascend, an error of
/// `check`, or a coefficient that overflows.
pub(crate) fn checked_pieces(
    Names { of, x, y }: Names,
    points: &[(f64, f64)],
    (join, above): (Join, Above),
    check: impl Fn(usize, (f64, f64)) -> Result<(), Error>,
) -> Result<Vec<Cubic>, Error> {
    let (count, allowed) = (points.len(), "points ≥ 2: the number of measured points");
    Error::check(of, "points", count as f64, count >= 2, allowed)?;
    let mut last = f64::NEG_INFINITY;
    for (index, &point) in points.iter().enumerate() {
        let allowed = "greater than at the point before";
        check(index, point)
            .and_then(|()| Error::check(of, x, point.0, point.0 > last, allowed))
            .and_then(|_| Error::check(of, y, point.1, true, "of any size"))
            .map_err(|error| error.at_point(index))?;
        last = point.0;
    }
    let pieces = pieces(points, join, above);
    for (index, piece) in pieces.iter().enumerate() {
        // A piece whose coefficients overflow is the fault of the point at its end.
        let next = (index + 1).min(count - 1);
        let in_range = piece.c.iter().all(|c| c.is_finite());
        let allowed = "so far from the point before that the slopes between them do not overflow";
        Error::check(of, x, points[next].0, in_range, allowed)
            .map_err(|error| error.at_point(next))?;
    }
    Ok(pieces)
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

/// Slope at an end of the table: that of the parabola through three points, limited so that the
/// cubic stays monotone; with two points that of their chord.
fn end_slope(chord: Chord, next: Option<&Chord>) -> f64 {
    let Some(&next) = next else {
        return chord.slope;
    };
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
