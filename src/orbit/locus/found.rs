//! Special points and ends of curves in two parameters.

use std::fmt;

use crate::error::Error;
use crate::numerics::trace::End;

/// The kind of a special point of a curve in two parameters: a point at which a second condition
/// holds (codimension two).
///
/// Source: Kuznetsov, *Elements of Applied Bifurcation Theory*, chapters 8 (equilibria) and 9
/// (fixed points of maps).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum SpecialKind {
    /// Hopf points change between super- and subcritical: a curve of folds of cycles begins.
    Bautin,
    /// A second pair of eigenvalues is imaginary.
    DoubleHopf,
    /// Another eigenvalue is 0.
    ZeroHopf,
    /// The curve turns back in one of the two parameters, numbered from 0: the value is the largest
    /// or the least near this point.
    Turn(usize),
}

impl fmt::Display for SpecialKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Bautin => f.pad("Bautin"),
            Self::DoubleHopf => f.pad("double Hopf"),
            Self::ZeroHopf => f.pad("zero-Hopf"),
            Self::Turn(which) => f.pad(&format!("turn in parameter {which}")),
        }
    }
}

/// Why a curve in two parameters ends.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum LocusEnd {
    /// It reached a side of the rectangle of parameters.
    Ranges,
    /// It returned to its start.
    Closed,
    /// The kind of the curve ends at its last special point.
    Special,
    /// The limit of work was reached.
    Work,
    /// The curve was lost: the family has no system there, or Newton's method does not converge
    /// however short the step.
    Lost {
        /// The parameters of the last point.
        parameters: [f64; 2],
        /// The error beyond, with the parameters there.
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
            End::Work => Self::Work,
            End::Lost(error) => Self::Lost { parameters, error },
        }
    }
}
