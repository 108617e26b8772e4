//! The attractors over a range of a parameter: the results of `vibration_ranges`.

use std::fmt;
use std::ops::Range;

use super::super::branch::{BifurcationKind, Branch};
use super::super::sweep::{Sweep, SweepPoint};
use crate::motion::{AttractorKind, SystemState};

/// The attractors of a system over a range of a parameter: see
/// [`vibration_ranges`](super::vibration_ranges()).
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct VibrationRanges<S: SystemState> {
    /// The ranges, in ascending order. Together they cover the range that was searched, except the
    /// values at which the family returns an error.
    pub ranges: Vec<VibrationRange>,
    /// The branches of periodic motions that were followed.
    pub branches: Vec<Branch<S>>,
    /// The attractors that the sweep reached at 17 equidistant values, upward and downward.
    pub sweep: Sweep<S>,
    /// The attractors that single motions reached: from rest at these values except the first, with
    /// which the sweep begins; then at the middles of ranges, from rest where no other search found
    /// an attractor, and from the last periodic motions of a branch that ends at a border.
    pub probes: Vec<SweepPoint<S>>,
    /// The value of the parameter at which the watcher stopped the search; `None` if the watcher
    /// did not stop it. After a stop the ranges may lack attractors, even some that the sweep
    /// reached.
    pub stopped: Option<f64>,
}

/// A range of a parameter of any system with the same attractors throughout; part of
/// [`VibrationRanges`].
///
/// For a mass on a belt, [`bifurcation::vibration_ranges`](crate::bifurcation::vibration_ranges)
/// returns a similar type without the kinds of the borders. At each velocity that this function
/// tries, it finds every attractor, within the [limits](crate::limit_cycle#what-is-guaranteed) of
/// `limit_cycle::find`.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct VibrationRange {
    /// The values of the parameter, in its own units.
    pub parameters: Range<f64>,
    /// The kinds of all attractors that were found, one entry for each attractor. If there are two
    /// or more, the range has hysteresis: the start determines which attractor is reached. The list
    /// is empty if no attractor was found.
    ///
    /// [`AttractorKind::Irregular`], and any other attractor on no branch that was followed, is
    /// entered for the whole range if a search reached it at one value or more of the range. A
    /// long transient counts as irregular, too, for example near a bifurcation: an irregular motion
    /// in the list need not be another attractor. The points of [`VibrationRanges::sweep`] and
    /// [`VibrationRanges::probes`] in the range tell how many values are irregular. To decide,
    /// simulate the motion at one of these values for longer and
    /// [`classify`](crate::orbit::classify()) its end, or compute its
    /// [`lyapunov`](crate::orbit::lyapunov()) exponent.
    pub attractors: Vec<AttractorKind>,
    /// The two ends of the range: the reasons why the attractors change there, or the ends of the
    /// range that was searched.
    pub borders: [Border; 2],
}

/// An end of a [`VibrationRange`]: the reason why the attractors change there, or the end of the
/// range that was searched.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum Border {
    /// The end of the range that was searched. The attractors need not change there.
    Range,
    /// Steady sliding changes its stability, and a periodic motion is born.
    Hopf,
    /// A real eigenvalue of steady sliding is 0: on the unstable side perturbations grow without
    /// oscillation.
    Divergence,
    /// Steady sliding begins to exist or ceases to exist.
    NoSteadySliding,
    /// The function `family` returns an error on the other side of this end.
    NoSystem,
    /// A periodic motion has a bifurcation at which its kind or its stability changes, or at which
    /// it vanishes. A branch that ends with
    /// [`BranchEnd::Grazing`](super::super::BranchEnd::Grazing) or
    /// [`BranchEnd::OneWaySlip`](super::super::BranchEnd::OneWaySlip) has the border
    /// [`BifurcationKind::Grazing`].
    Bifurcation(BifurcationKind),
    /// A periodic motion jumps: see
    /// [`BranchEnd::Discontinuity`](super::super::BranchEnd::Discontinuity).
    Discontinuity,
    /// A branch could not be followed further; its end in [`VibrationRanges::branches`] gives the
    /// reason.
    Unknown,
}

impl fmt::Display for Border {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Range => "end of the range",
            Self::Hopf => "Hopf",
            Self::Divergence => "divergence",
            Self::NoSteadySliding => "no steady sliding",
            Self::NoSystem => "no system",
            Self::Bifurcation(kind) => kind.name(),
            Self::Discontinuity => "discontinuity",
            Self::Unknown => "unknown",
        })
    }
}
