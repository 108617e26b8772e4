//! Special points and ends of curves in two parameters.

use std::fmt;

use super::super::found::Orbit;
use crate::error::Error;
use crate::motion::System;
use crate::numerics::trace::End;

/// A curve of bifurcations of periodic motions in two parameters; returned by [`locus`].
///
/// [`locus`]: super::locus
#[non_exhaustive]
pub struct Locus<S: System> {
    /// The kind of bifurcation.
    pub kind: LocusKind,
    /// The points, from one end of the curve to the other.
    pub points: Vec<LocusPoint<S>>,
    /// The special points between these points, in the same order.
    pub special: Vec<SpecialPoint<S>>,
    /// The reasons why the curve ends before its first point, and after its last one.
    pub ends: [LocusEnd; 2],
}

/// A point of a [`Locus`].
#[non_exhaustive]
pub struct LocusPoint<S: System> {
    /// The two parameters, in their own units.
    pub parameters: [f64; 2],
    /// The motion at the bifurcation, with its multipliers.
    pub orbit: Orbit<S>,
}

/// A special point of a [`Locus`].
#[non_exhaustive]
pub struct SpecialPoint<S: System> {
    /// The second condition that holds at this point.
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
    /// At an instant of zero relative velocity, the force that stick would need equals the static
    /// limit. On one side of the curve the contact sticks at this instant; on the other side it
    /// slips on in the opposite direction.
    StopOnset {
        /// The contact.
        contact: usize,
    },
    /// Two contacts have events at the same time; the order of these events differs on the two
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

impl<S: System> Clone for Locus<S> {
    fn clone(&self) -> Self {
        Self {
            kind: self.kind,
            points: self.points.clone(),
            special: self.special.clone(),
            ends: self.ends.clone(),
        }
    }
}

impl<S: System> Clone for LocusPoint<S> {
    fn clone(&self) -> Self {
        let orbit = self.orbit.clone();
        Self { orbit, ..*self }
    }
}

impl<S: System> Clone for SpecialPoint<S> {
    fn clone(&self) -> Self {
        let orbit = self.orbit.clone();
        Self { orbit, ..*self }
    }
}

impl<S: System> fmt::Debug for Locus<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Locus")
            .field("kind", &self.kind)
            .field("points", &self.points)
            .field("special", &self.special)
            .field("ends", &self.ends)
            .finish()
    }
}

impl<S: System> fmt::Debug for LocusPoint<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LocusPoint")
            .field("parameters", &self.parameters)
            .field("orbit", &self.orbit)
            .finish()
    }
}

impl<S: System> fmt::Debug for SpecialPoint<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("SpecialPoint")
            .field("kind", &self.kind)
            .field("parameters", &self.parameters)
            .field("orbit", &self.orbit)
            .finish()
    }
}

/// The kind of a special point of a curve in two parameters: a point at which a second condition
/// holds (codimension two).
///
/// Source: Kuznetsov, *Elements of Applied Bifurcation Theory*, chapters 8 (equilibria) and 9
/// (fixed points of maps).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SpecialKind {
    /// Two curves of folds meet tangentially; between the curves there are three motions.
    Cusp,
    /// Strong resonance: the critical multipliers are both 1 (number 1), both −1 (number 2),
    /// exp(±2πi/3) (number 3) or ±i (number 4). A curve of Neimark-Sacker bifurcations begins or
    /// ends at numbers 1 and 2.
    Resonance(u8),
    /// One multiplier is +1 and another is −1.
    FoldFlip,
    /// A multiplier is +1, and a pair of multipliers lies on the unit circle.
    FoldNeimarkSacker,
    /// A symmetric motion is at a pitchfork and at a fold: its multiplier +1 is double.
    FoldPitchfork,
    /// A symmetric motion is at a pitchfork, and a pair of multipliers lies on the unit circle.
    PitchforkNeimarkSacker,
    /// A multiplier is −1, and a pair of multipliers lies on the unit circle.
    FlipNeimarkSacker,
    /// Two pairs of multipliers lie on the unit circle.
    DoubleNeimarkSacker,
    /// A multiplier is +1, and a contact that slips reaches relative velocity 0 tangentially.
    FoldGrazing,
    /// Two conditions on the events hold at once. For example, two contacts reach relative velocity
    /// 0 tangentially, or one contact does so at two instants of the period.
    DoubleGrazing,
    /// Hopf points change from supercritical to subcritical: a curve of folds of limit cycles
    /// begins.
    Bautin,
    /// On a curve of Hopf points, a second pair of eigenvalues is imaginary.
    DoubleHopf,
    /// On a curve of Hopf points, another eigenvalue is 0.
    ZeroHopf,
    /// One of the two parameters has a local maximum or minimum along the curve. The number is 0
    /// for the first parameter and 1 for the second.
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
    /// The curve ends at its last special point, for example a 1:1 resonance: beyond this point the
    /// bifurcation is of another kind.
    Special,
    /// The events of the motion change beyond the last point, and no curve of this kind continues:
    /// the motion or its derivative jumps there.
    Jump,
    /// The motion shrank to a point: steady sliding has a Hopf bifurcation there (a Bautin point,
    /// if the curve is one of folds).
    Hopf {
        /// The parameters there.
        parameters: [f64; 2],
    },
    /// The steps become shorter and shorter: the last 128 steps together are shorter than 1e-3, in
    /// units of the size of the motion and of the ranges of the parameters. Near the last point the
    /// motion has no derivative with respect to the parameters, for example because a grazing
    /// coincides with another event of the same contact.
    Crawls {
        /// The parameters of the last point.
        parameters: [f64; 2],
    },
    /// A limit of work was reached: 2048 points or 2·10⁷ steps in one direction
    /// ([`Search`](crate::orbit::Search) sets other limits), or 2·10⁵ motions tried.
    Work,
    /// The watcher stopped the search.
    Stopped {
        /// The parameters of the last point.
        parameters: [f64; 2],
    },
    /// The curve was lost: the family has no system beyond the last point, or Newton's method does
    /// not converge even with the shortest step.
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
