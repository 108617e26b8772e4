use super::ForceLaw;
use crate::error::Error;
use crate::numerics::interpolation::{Above, Cubic, Join, Names, checked_pieces};
use crate::scalar::Scalar;

/// A spring through measured points, joined by monotone cubics (PCHIP) or by straight lines.
///
/// ```text
/// F(x) = F_i + d_i t + c_i t² + b_i t³,   t = x − x_i,   x_i ≤ x ≤ x_{i+1};   U(x) = ∫_0^x F dx
/// ```
///
/// F is the force at the position x, and U its potential. The points are (x_i, F_i); b_i, c_i and
/// d_i are the coefficients of the polynomial above point i. The law goes through every point, and
/// is monotone between two neighbouring points, to rounding.
///
/// * [`TabulatedForce::new`] joins the points by cubics, so that the stiffness is continuous. They
///   are those of [`Tabulated`](crate::Tabulated), with the same end formula at both ends.
/// * [`TabulatedForce::piecewise_linear`] joins them by straight lines: b_i = c_i = 0, and d_i is
///   the slope of the chord.
///
/// Below the first and above the last point the law is the straight line with the slope at this
/// point. All points are [breakpoints](ForceLaw::breakpoints): the integrator ends a step at each
/// point that the motion passes. A few dozen points are enough.
///
/// Source: that of [`Tabulated`](crate::Tabulated).
///
/// ```
/// use stick_slip::{ForceLaw, TabulatedForce};
///
/// let points = [(-1.0, -3.0), (0.0, 0.0), (1.0, 1.0), (2.0, 4.0)];
/// let rubber = TabulatedForce::new(&points)?;
/// assert_eq!(rubber.breakpoints().collect::<Vec<_>>(), [-1.0, 0.0, 1.0, 2.0]);
/// assert_eq!(rubber.force(1.0, 0.0, 3), 1.0);
///
/// // Piece 2 lies between points 1 and 2, piece 4 above the last point.
/// let lines = TabulatedForce::piecewise_linear(&points)?;
/// assert_eq!(lines.force(0.5, 0.0, 2), 0.5);
/// assert_eq!(lines.potential(0.5, 2), Some(0.125));
/// assert_eq!(lines.force(3.0, 0.0, 4), 7.0);
/// assert_eq!(lines.potential(3.0, 4), Some(0.5 + 2.5 + 5.5));
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "super::read::TabulatedForce")
)]
pub struct TabulatedForce {
    points: Vec<(f64, f64)>,
    #[cfg_attr(feature = "serde", serde(skip_serializing_if = "std::ops::Not::not"))]
    piecewise_linear: bool,
    /// Piece i ends at point i; the last piece has no end.
    #[cfg_attr(feature = "serde", serde(skip_serializing))]
    pieces: Vec<Piece>,
}

#[derive(Debug, Clone, Copy, PartialEq)]
struct Piece {
    force: Cubic,
    /// U at the start of the cubic.
    energy: f64,
}

impl TabulatedForce {
    /// Creates a law of monotone cubics through the points (x_i, F_i). The positions x_i ascend.
    ///
    /// # Errors
    ///
    /// [`Error::InvalidParameter`] if there are fewer than two points; [`Error::BadPoint`], with
    /// the first point at fault, if a number is not finite, if the positions do not ascend
    /// strictly, or if a coefficient of a cubic or the potential at a point overflows.
    pub fn new(points: &[(f64, f64)]) -> Result<Self, Error> {
        Self::joined(points, Join::Cubics)
    }

    /// Creates a law of straight lines through the points (x_i, F_i). The positions x_i ascend.
    ///
    /// # Errors
    ///
    /// The errors of [`new`](Self::new).
    pub fn piecewise_linear(points: &[(f64, f64)]) -> Result<Self, Error> {
        Self::joined(points, Join::Lines)
    }

    fn joined(points: &[(f64, f64)], join: Join) -> Result<Self, Error> {
        let names = Names {
            of: "TabulatedForce",
            x: "position",
            y: "force",
        };
        let above = checked_pieces(names, points, (join, Above::Line), |_, _| Ok(()))?;
        let below = Cubic::line(points[0], above[0].c[1]);
        let pieces = with_energies(std::iter::once(below).chain(above).collect(), points);
        for (index, (piece, point)) in std::iter::zip(&pieces[1..], points).enumerate() {
            let allowed = "a force with which the potential does not overflow";
            let is_finite = piece.energy.is_finite();
            Error::check(names.of, names.y, point.1, is_finite, allowed)
                .map_err(|error| error.at_point(index))?;
        }
        Ok(Self {
            points: points.to_vec(),
            piecewise_linear: join == Join::Lines,
            pieces,
        })
    }

    /// The points (x_i, F_i).
    pub fn points(&self) -> &[(f64, f64)] {
        &self.points
    }

    /// Returns true if straight lines join the points.
    pub fn is_piecewise_linear(&self) -> bool {
        self.piecewise_linear
    }
}

/// The pieces with their potential, which is continuous, and 0 at x = 0.
fn with_energies(cubics: Vec<Cubic>, points: &[(f64, f64)]) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = cubics
        .into_iter()
        .map(|force| Piece { force, energy: 0.0 })
        .collect();
    // Outwards from 0, so that the rounding errors are those of energies along the way.
    let zero = points.partition_point(|point| point.0 <= 0.0);
    pieces[zero].energy = -pieces[zero].potential(0.0);
    let mut join = |from: usize, to: usize, position: f64| {
        pieces[to].energy = pieces[from].potential(position) - pieces[to].potential(position);
    };
    (zero..points.len()).for_each(|i| join(i, i + 1, points[i].0));
    (0..zero).rev().for_each(|i| join(i + 1, i, points[i].0));
    pieces
}

impl Piece {
    /// The energy at the start, and the integral of the force from there.
    #[inline(always)]
    fn potential<S: Scalar>(&self, position: S) -> S {
        let Cubic { start, c } = self.force;
        let t = position - start;
        (((t * (c[3] / 4.0) + c[2] / 3.0) * t + c[1] / 2.0) * t + c[0]) * t + self.energy
    }
}

impl ForceLaw for TabulatedForce {
    #[inline(always)]
    fn force<S: Scalar>(&self, position: S, _: S, piece: usize) -> S {
        match self.pieces.get(piece) {
            Some(piece) => piece.force.at(position),
            None => position.constant(f64::NAN),
        }
    }

    fn potential<S: Scalar>(&self, position: S, piece: usize) -> Option<S> {
        Some(self.pieces.get(piece)?.potential(position))
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        self.points.iter().map(|point| point.0)
    }
}
