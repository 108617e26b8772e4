//! Curves of Hopf points of steady sliding in two parameters.

mod equations;

use std::ops::Range;

use nalgebra::DVector;
use num_complex::Complex;

use self::equations::{Balanced, Bordered, HopfPoints};
use crate::belt::Criticality;
use crate::error::Error;
use crate::numerics::eigenvalues::{eigenvalues, growing};
use crate::numerics::trace::{
    Chord, Equations, Plane, Point, both_ways, check_ranges, joined, solve,
};
use crate::orbit::{LocusEnd, Oscillator, SpecialKind, member};

/// A curve of Hopf points of steady sliding in two parameters; returned by [`hopf_locus`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct HopfLocus {
    /// The points, from one end of the curve to the other.
    pub points: Vec<HopfPoint>,
    /// The special points of the curve, in the order of `points`.
    pub special: Vec<SpecialHopfPoint>,
    /// The reasons why the curve ends before its first point, and after its last one.
    pub ends: [LocusEnd; 2],
}

/// A point of a [`HopfLocus`]: steady sliding with a pair of eigenvalues ±iω.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct HopfPoint {
    /// The two parameters, in their own units.
    pub parameters: [f64; 2],
    /// The angular frequency ω, in radians per unit of time.
    pub frequency: f64,
    /// Displacement of each coordinate in steady sliding, in the units of the system.
    pub displacements: Vec<f64>,
    /// The first Lyapunov coefficient l1, for an eigenvector of length 1 in the units of the
    /// system. Only the sign of l1 is independent of these units. NaN if 0 or ±2iω is an
    /// eigenvalue.
    pub first_lyapunov_coefficient: f64,
    /// The largest real part of the other eigenvalues, per unit of time; −∞ if there are no others.
    /// Memory without influence has none, as in
    /// [`SteadySliding::eigenvalues`](crate::structure::SteadySliding::eigenvalues).
    /// If this number is positive, steady sliding is unstable on both sides of the curve.
    pub largest_other: f64,
    /// The rounding of the coefficient.
    rounding: f64,
}

/// A special point of a [`HopfLocus`].
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct SpecialHopfPoint {
    /// The kind of special point.
    pub kind: SpecialKind,
    /// The Hopf point.
    pub point: HopfPoint,
}

impl HopfPoint {
    /// Returns whether the motion that is born at this point is stable (supercritical) or unstable
    /// (subcritical), from the sign of the first Lyapunov coefficient. If another eigenvalue has a
    /// positive real part, the motion is unstable in both cases. The result is
    /// [`Criticality::Degenerate`] if the coefficient is NaN, or 0 to rounding, as for contacts
    /// with Coulomb's law.
    pub fn criticality(&self) -> Criticality {
        let value = self.first_lyapunov_coefficient;
        if value < -self.rounding {
            Criticality::Supercritical
        } else if value > self.rounding {
            Criticality::Subcritical
        } else {
            Criticality::Degenerate
        }
    }
}

/// Intervals into which each range is divided for the search.
const INTERVALS: usize = 64;

/// Bisections of an interval in which the number of unstable eigenvalues changes, before Newton's
/// method begins.
const HALVINGS: usize = 20;

/// Real parts below this fraction of the largest eigenvalue count as 0 in the search.
const ROUNDING: f64 = 1e-10;

/// A point within this distance of a curve, in units of the ranges, lies on it.
const SAME: f64 = 1e-7;

/// The curves of Hopf points of steady sliding in a rectangle of two parameters. At a Hopf point a
/// pair of eigenvalues ±iω of the linearised motion crosses the imaginary axis, and a periodic
/// motion is born.
///
/// `family` returns the system for values of the two parameters, which may be anything that a
/// closure can set. There is no curve at values for which `family` returns an error or the system
/// has no steady sliding.
///
/// The search counts the unstable eigenvalues at the nodes of a grid of 65 × 65 values. It finds
/// every curve that passes between two neighbouring nodes with different numbers of unstable
/// eigenvalues, for any number of masses. A closed curve inside one cell of the grid, or two curves
/// between the same nodes, can be missed.
///
/// Each curve is followed by pseudo-arclength continuation. Newton's method with a bordered matrix
/// solves
///
/// ```text
/// (A − iω) w = 0,    A = ∂F/∂x at steady sliding,
/// ```
///
/// where x' = F(x) are the equations of motion in slip, x is the state, and w an eigenvector.
/// Contacts on surfaces at rest, and joints between masses, stick in steady sliding; w then is a
/// motion that they allow, as for [`begin`](crate::orbit::begin). The curve ends where other
/// contacts stick. The error of the parameters and of ω is the rounding error of A, divided by the
/// rate at which the eigenvalue crosses the axis.
///
/// The first Lyapunov coefficient l1 decides whether the motion that is born is stable. It is
/// computed from the second and third derivatives of friction with respect to velocities, loads and
/// memory variables. The power series of the laws give these derivatives. The special points are
///
/// * zeros of l1 ([`SpecialKind::Bautin`]);
/// * points with other eigenvalues on the imaginary axis ([`SpecialKind::DoubleHopf`],
///   [`SpecialKind::ZeroHopf`]);
/// * local maxima and minima of each parameter along the curve ([`SpecialKind::Turn`]).
///
/// A search solves some 10⁴ eigenvalue problems of order 2n + m, with n coordinates and m memory
/// variables.
///
/// Sources: Kuznetsov, *Elements of Applied Bifurcation Theory*, section 5.4 (l1) and chapter 8;
/// Govaerts, *Numerical Methods for Bifurcations of Dynamical Equilibria*, chapters 3 and 4
/// (bordered matrices).
///
/// # Errors
///
/// [`Error::InvalidParameter`] unless both ranges are finite and not empty. If no node of the grid
/// has steady sliding, the function returns the error of the first node.
///
/// ```
/// use stick_slip::bifurcation::{self, Criticality};
/// use stick_slip::orbit::SpecialKind;
/// use stick_slip::{Exponential, MassOnBelt};
///
/// // Belt velocity and damping ratio at which steady sliding is neutrally stable.
/// let family = |v_b: f64, beta: f64| {
///     MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, v_b)?.with_damping(beta)
/// };
/// let [curve] = &bifurcation::hopf_locus(family, [0.02..1.2, 0.005..0.2])?[..] else { panic!() };
/// for point in &curve.points {
///     // 2β = −dμ̂/ds, in closed form.
///     let [v_b, beta] = point.parameters;
///     let expected = 0.15 * v_b / 0.25 * (-(v_b / 0.5).powi(2)).exp();
///     assert!((beta - expected).abs() < 1e-14);
///     let stable = v_b < 1.5_f64.sqrt() * 0.5;
///     assert_eq!(point.criticality() == Criticality::Supercritical, stable);
/// }
/// let bautin = curve.special.iter().find(|point| point.kind == SpecialKind::Bautin).unwrap();
/// assert!((bautin.point.parameters[0] - 1.5_f64.sqrt() * 0.5).abs() < 1e-13);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "continuation")]
#[doc(alias = "stability chart")]
pub fn hopf_locus<S: Oscillator>(
    family: impl Fn(f64, f64) -> Result<S, Error>,
    ranges: [Range<f64>; 2],
) -> Result<Vec<HopfLocus>, Error> {
    check_ranges("bifurcation::hopf_locus", &ranges)?;
    let mut search = GridSearch {
        points: HopfPoints {
            family: &|first, second| member(family(first, second)),
            ranges,
        },
        curves: Vec::new(),
    };
    search.run()?;
    Ok(search.curves.into_iter().map(HopfLocus::from).collect())
}

type Solved = Point<Bordered>;

/// A curve that was followed.
struct Curve {
    points: Vec<Solved>,
    special: Vec<(usize, Solved)>,
    ends: [LocusEnd; 2],
}

struct GridSearch<'f> {
    points: HopfPoints<'f>,
    curves: Vec<Curve>,
}

/// A node of the grid: the number of unstable eigenvalues, and the contacts that stick.
type Node = Result<(usize, Vec<usize>), Error>;

impl GridSearch<'_> {
    fn run(&mut self) -> Result<(), Error> {
        let value = |which: usize, i: usize| {
            let (range, part) = (&self.points.ranges[which], i as f64 / INTERVALS as f64);
            range.start * (1.0 - part) + range.end * part
        };
        let count = INTERVALS + 1;
        let places: Vec<[f64; 2]> = (0..count * count)
            .map(|k| [value(0, k % count), value(1, k / count)])
            .collect();
        let nodes: Vec<Node> = places.iter().map(|&place| self.unstable(place)).collect();
        if let (true, Some(Err(error))) = (nodes.iter().all(Result::is_err), nodes.first()) {
            return Err(error.clone());
        }
        for k in 0..nodes.len() {
            let right = (k % count < INTERVALS).then_some((0, k + 1));
            let above = (k / count < INTERVALS).then_some((1, k + count));
            for (which, next) in [right, above].into_iter().flatten() {
                if let (Ok(a), Ok(b)) = (&nodes[k], &nodes[next])
                    && a.0 != b.0
                    && a.1 == b.1
                {
                    self.cross(which, [places[k], places[next]], a);
                }
            }
        }
        Ok(())
    }

    fn unstable(&self, place: [f64; 2]) -> Node {
        let Balanced {
            matrix, sticking, ..
        } = self.points.balanced(place)?;
        let values = eigenvalues(matrix.clone()).ok_or(Error::NoHopfPoint)?;
        Ok((growing(&matrix, &values, ROUNDING), sticking))
    }

    /// Finds the curve that crosses an edge of the grid, unless it is known.
    fn cross(
        &mut self,
        which: usize,
        [mut low, mut high]: [[f64; 2]; 2],
        (count, sticking): &(usize, Vec<usize>),
    ) {
        for _ in 0..HALVINGS {
            let mut middle = low;
            middle[which] = 0.5 * (low[which] + high[which]);
            match self.unstable(middle) {
                Ok((now, held)) if held == *sticking => match now == *count {
                    true => low = middle,
                    false => high = middle,
                },
                // No steady sliding in between, or other contacts stick.
                _ => return,
            }
        }
        let Some(first) = self.begin(which, low) else {
            return;
        };
        if !self.is_known(&first) {
            let curve = self.follow(&first);
            self.curves.push(curve);
        }
    }

    /// The Hopf point on an edge.
    fn begin(&self, which: usize, place: [f64; 2]) -> Option<Solved> {
        let Balanced { matrix, .. } = self.points.balanced(place).ok()?;
        let values = eigenvalues(matrix)?;
        let oscillating = values.iter().filter(|value| value.im > 0.0);
        let off = |value: &Complex<f64>| (value.re / value.im).abs();
        let nearest = oscillating.min_by(|a, b| off(a).total_cmp(&off(b)))?;
        let begun = self.points.begun(place, nearest.im).ok()?;
        let guess = DVector::from_column_slice(&[place[0], place[1], nearest.im]);
        let scale = self.points.scale(&guess, &begun);
        let fixed = 1 - which;
        // In the direction of the edge's normal, or along the edge.
        let mut along = DVector::from_element(3, 0.001);
        along[fixed] += 1.0;
        let plane = Plane::with_value(fixed, guess[fixed], &along, &scale);
        let point = solve(&self.points, &guess, &begun, &plane).ok()?;
        let inside = [0, 1].into_iter().all(|i| {
            let range = &self.points.ranges[i];
            (range.start..=range.end).contains(&point.y[i])
        });
        inside.then_some(point)
    }

    /// Returns true if a point lies on a curve that was followed.
    fn is_known(&self, point: &Solved) -> bool {
        let (y, scale) = (&point.y, &point.scale);
        let mut pairs = self.curves.iter().flat_map(|curve| curve.points.windows(2));
        pairs.any(|pair| {
            let chord = Chord::new([&pair[0].y, &pair[1].y], scale);
            let (part, beside) = chord.place(y);
            let margin = SAME / chord.step.norm();
            if !((-margin..=1.0 + margin).contains(&part) && beside <= 0.5) {
                return false;
            }
            let (guess, near) = (chord.at(part), &pair[0].value);
            let found = solve(&self.points, &guess, near, &chord.plane_through(y));
            found.is_ok_and(|found| (found.y - y).component_div(scale).amax() <= SAME)
        })
    }

    /// The curve through a point, in both directions.
    fn follow(&self, first: &Solved) -> Curve {
        let halves = both_ways(&self.points, first);
        let ends = halves.each_ref().map(|half| {
            let last = half.points.last().unwrap_or(first);
            LocusEnd::of(half.end.clone(), [last.y[0], last.y[1]])
        });
        let (mut points, special) = joined(halves, first);
        if ends[1] == LocusEnd::Closed {
            points.push(first.clone());
        }
        Curve {
            points,
            special,
            ends,
        }
    }
}

impl From<&Solved> for HopfPoint {
    fn from(point: &Solved) -> Self {
        let (y, value) = (&point.y, &point.value);
        let others = value.others.iter().map(|value| value.re);
        Self {
            parameters: [y[0], y[1]],
            frequency: y[2],
            displacements: value.displacements.clone(),
            first_lyapunov_coefficient: value.lyapunov[0],
            largest_other: others.fold(f64::NEG_INFINITY, f64::max),
            rounding: value.lyapunov[1],
        }
    }
}

impl From<Curve> for HopfLocus {
    fn from(curve: Curve) -> Self {
        let special = curve.special.iter().map(|(test, point)| {
            let others = point.value.others.iter();
            let nearest = others.min_by(|a, b| a.re.abs().total_cmp(&b.re.abs()));
            let kind = match (test, nearest) {
                (0, _) => SpecialKind::Bautin,
                (1, Some(Complex { im, .. })) if *im == 0.0 => SpecialKind::ZeroHopf,
                (1, _) => SpecialKind::DoubleHopf,
                (test, _) => SpecialKind::Turn(test - 2),
            };
            SpecialHopfPoint {
                kind,
                point: point.into(),
            }
        });
        Self {
            special: special.collect(),
            points: curve.points.iter().map(HopfPoint::from).collect(),
            ends: curve.ends,
        }
    }
}
