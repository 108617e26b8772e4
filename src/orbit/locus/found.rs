//! Special points and ends of curves in two parameters.

use std::fmt;

use super::super::periodic_orbit::Orbit;
use crate::error::Error;
use crate::motion::SystemState;
use crate::numerics::trace::End;

/// A curve of bifurcations of periodic motions in two parameters; returned by
/// [`locus`](super::locus()).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct Locus<S: SystemState> {
    /// The kind of bifurcation.
    pub kind: LocusKind,
    /// The points, from one end of the curve to the other.
    pub points: Vec<LocusPoint<S>>,
    /// The special points of the curve, in the order of `points`.
    pub special: Vec<SpecialPoint<S>>,
    /// The reasons why the curve ends before its first point, and after its last one.
    pub ends: [LocusEnd; 2],
}

/// A point of a [`Locus`].
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct LocusPoint<S: SystemState> {
    /// The two parameters, in their own units.
    pub parameters: [f64; 2],
    /// The motion at the bifurcation, with its multipliers.
    pub orbit: Orbit<S>,
}

/// A special point of a [`Locus`].
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct SpecialPoint<S: SystemState> {
    /// The second condition, which holds at this point in addition to that of the curve.
    pub kind: SpecialKind,
    /// The two parameters, in their own units.
    pub parameters: [f64; 2],
    /// The motion at this point.
    pub orbit: Orbit<S>,
}

/// The kind of a [`Locus`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum LocusKind {
    /// A multiplier is +1.
    Fold,
    /// A multiplier is −1.
    Flip,
    /// A pair of multipliers lies on the unit circle.
    NeimarkSacker,
    /// A symmetric motion has a multiplier +1 whose eigenvector breaks the symmetry.
    Pitchfork,
    /// A contact that slips reaches relative velocity 0 tangentially.
    Grazing {
        /// The contact.
        contact: usize,
    },
    /// The force that the contact needs to stick equals the static limit at an instant of zero
    /// relative velocity. On one side of the curve the contact sticks at this instant. On the other
    /// side the relative velocity passes through 0, and the contact slips in the opposite
    /// direction.
    StopOnset {
        /// The contact.
        contact: usize,
    },
    /// Two contacts have events at the same time. The order of these events differs on the two
    /// sides of the curve.
    Order {
        /// The two contacts, in ascending order.
        contacts: [usize; 2],
    },
}

impl fmt::Display for LocusKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Fold => "fold",
            Self::Flip => "flip",
            Self::NeimarkSacker => "Neimark-Sacker",
            Self::Pitchfork => "pitchfork",
            Self::Grazing { .. } => "grazing",
            Self::StopOnset { .. } => "onset of stops",
            Self::Order { .. } => "order of events",
        })
    }
}

/// The kind of a special point of a curve in two parameters. At a special point a second condition
/// holds (codimension two). Curves of Hopf points are computed by
/// [`hopf_locus`](crate::bifurcation::hopf_locus).
///
/// Source: Kuznetsov, *Elements of Applied Bifurcation Theory*, chapters 8 (equilibria) and 9
/// (fixed points of maps).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SpecialKind {
    /// Two curves of folds meet tangentially. Between these curves there are three motions.
    Cusp,
    /// Strong resonance 1:n, with the number n from 1 to 4. The two critical multipliers are both 1
    /// (n = 1), both −1 (n = 2), exp(±2πi/3) (n = 3) or ±i (n = 4). A curve of Neimark-Sacker
    /// bifurcations begins or ends at 1:1 and 1:2 resonances.
    Resonance(u8),
    /// One multiplier is +1 and another is −1.
    FoldFlip,
    /// A multiplier is +1, and a pair of multipliers lies on the unit circle.
    FoldNeimarkSacker,
    /// A symmetric motion is at a pitchfork and at a fold: the multiplier +1 is double.
    FoldPitchfork,
    /// A symmetric motion is at a pitchfork, and a pair of multipliers lies on the unit circle.
    PitchforkNeimarkSacker,
    /// A multiplier is −1, and a pair of multipliers lies on the unit circle.
    FlipNeimarkSacker,
    /// Two pairs of multipliers lie on the unit circle.
    DoubleNeimarkSacker,
    /// A multiplier is +1, and a contact that slips reaches relative velocity 0 tangentially.
    FoldGrazing,
    /// Two conditions on the events hold at the same time. For example, two contacts reach relative
    /// velocity 0 tangentially, or one contact reaches it at two instants of the period.
    DoubleGrazing,
    /// The bifurcation on a curve of Hopf points changes from supercritical to subcritical. A curve
    /// of folds of limit cycles begins at this point.
    Bautin,
    /// A second pair of eigenvalues on a curve of Hopf points is imaginary.
    DoubleHopf,
    /// Another eigenvalue on a curve of Hopf points is 0.
    ZeroHopf,
    /// One of the two parameters has a local maximum or minimum on a curve of Hopf points. The
    /// number is 0 for the first parameter and 1 for the second.
    Turn(usize),
}

impl fmt::Display for SpecialKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cusp => f.pad("cusp"),
            Self::Resonance(order) => f.pad(&format!("1:{order} resonance")),
            Self::FoldFlip => f.pad("fold-flip"),
            Self::FoldNeimarkSacker => f.pad("fold-Neimark-Sacker"),
            Self::FoldPitchfork => f.pad("fold-pitchfork"),
            Self::PitchforkNeimarkSacker => f.pad("pitchfork-Neimark-Sacker"),
            Self::FlipNeimarkSacker => f.pad("flip-Neimark-Sacker"),
            Self::DoubleNeimarkSacker => f.pad("double Neimark-Sacker"),
            Self::FoldGrazing => f.pad("fold-grazing"),
            Self::DoubleGrazing => f.pad("double grazing"),
            Self::Bautin => f.pad("Bautin"),
            Self::DoubleHopf => f.pad("double Hopf"),
            Self::ZeroHopf => f.pad("zero-Hopf"),
            Self::Turn(which) => f.pad(&format!("turn in parameter {which}")),
        }
    }
}

/// The reason why a curve in two parameters ends. Parameters are in their own units.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum LocusEnd {
    /// The curve reached a border of the two ranges of parameters.
    Ranges,
    /// The curve is closed: it returned to its start.
    Closed,
    /// The curve ends at its last special point, for example a 1:1 resonance. Beyond this point the
    /// bifurcation is of another kind.
    Special,
    /// The motion has other events beyond the last point, and the motion or its derivative jumps
    /// there. No curve of this kind continues.
    Jump,
    /// The motion shrank to a point: steady sliding has a Hopf bifurcation at these parameters. At
    /// the end of a curve of folds this is a Bautin point.
    Hopf {
        /// The parameters at this end.
        parameters: [f64; 2],
    },
    /// The steps become shorter and shorter: the last 128 steps together are shorter than 1e-3.
    /// States are measured in units of the size of the motion, parameters in units of their ranges.
    /// Near the last point the motion has no derivative with respect to the parameters. An example
    /// is a grazing that coincides with another event of the same contact.
    Crawls {
        /// The parameters of the last point.
        parameters: [f64; 2],
    },
    /// A limit of work was reached: 2048 points, 2·10⁷ integration steps or 2·10⁵ motions tried, in
    /// one direction. [`Search`](crate::orbit::Search) sets other limits of points and steps.
    Work,
    /// The watcher of the [`Search`](crate::orbit::Search) stopped the search.
    Stopped {
        /// The parameters of the last point.
        parameters: [f64; 2],
    },
    /// The curve was lost: the function `family` returns an error beyond the last point, or
    /// Newton's method does not converge even with the shortest step.
    Lost {
        /// The parameters of the last point.
        parameters: [f64; 2],
        /// The error that ended the curve just beyond the last point, with the parameters at which
        /// it occurred.
        error: Error,
    },
}

impl LocusEnd {
    /// The end of a trace with these last parameters.
    pub(crate) fn of(end: End, parameters: [f64; 2]) -> Self {
        match end {
            End::Ranges => Self::Ranges,
            End::Closed => Self::Closed,
            End::Special => Self::Special,
            End::Vanishes(parameters) => Self::Hopf { parameters },
            End::Crawls => Self::Crawls { parameters },
            End::Work => Self::Work,
            End::Lost(error) => Self::Lost { parameters, error },
        }
    }
}
