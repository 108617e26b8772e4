//! Branches of periodic motions over a parameter, as they are found.

use std::fmt;

use super::found::Orbit;
use crate::error::Error;
use crate::motion::{EventKind, System};

/// Periodic motions over a parameter, followed in both directions from one of them.
#[non_exhaustive]
pub struct Branch<S: System> {
    /// The motions, from one end of the branch to the other.
    pub points: Vec<BranchPoint<S>>,
    /// What happens between them, in the same order.
    pub bifurcations: Vec<Bifurcation<S>>,
    /// Why the branch ends before its first point, and after its last one.
    pub ends: [BranchEnd; 2],
}

/// A periodic motion of a [`Branch`].
#[non_exhaustive]
pub struct BranchPoint<S: System> {
    /// The parameter, in its own units.
    pub parameter: f64,
    /// The motion, with its multipliers.
    pub orbit: Orbit<S>,
}

/// A motion of a [`Branch`] at which its kind changes, or that of the motions near to it.
#[non_exhaustive]
pub struct Bifurcation<S: System> {
    /// The parameter, in its own units.
    pub parameter: f64,
    /// What happens there.
    pub kind: BifurcationKind,
    /// The motion there; at a change of its events, that on the smoother side.
    pub orbit: Orbit<S>,
}

/// What happens at a [`Bifurcation`].
///
/// Source: Kuznetsov, *Elements of Applied Bifurcation Theory*, chapters 4 and 5 (fold, flip,
/// Neimark-Sacker); di Bernardo, Budd, Champneys and Kowalczyk, *Piecewise-smooth Dynamical
/// Systems*, chapters 7 and 8 (grazing and sliding).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum BifurcationKind {
    /// A multiplier is +1: two motions meet and vanish, and the branch turns back. In a symmetric
    /// system the branch may go on instead, and another one crosses it.
    Fold,
    /// A multiplier is −1: a motion of twice the period is born.
    Flip,
    /// A pair of multipliers lies on the unit circle: motions on a torus are born.
    NeimarkSacker,
    /// A contact that slips touches its belt, or one that sticks touches the most that it can
    /// carry, and goes back: a pair of events is born.
    Grazing,
    /// One event changes into others (a crossing into a stop, for example), or two events of
    /// different contacts change their order.
    Sequence,
}

impl fmt::Display for BifurcationKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Fold => "fold",
            Self::Flip => "flip",
            Self::NeimarkSacker => "Neimark-Sacker",
            Self::Grazing => "grazing",
            Self::Sequence => "change of events",
        })
    }
}

/// Why a [`Branch`] ends.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum BranchEnd {
    /// The parameter came to an end of the range.
    Range,
    /// The motion shrank to a point, where a state of equilibrium changes its stability: a Hopf
    /// bifurcation.
    Hopf {
        /// The parameter there.
        parameter: f64,
    },
    /// An event of the motion became tangential, and no motion near to it goes on: a contact that
    /// caught the mass is only touched there, and missed beyond.
    Grazing {
        /// The parameter there, by extrapolation: good to about 1e-8 of the range.
        parameter: f64,
    },
    /// The motion itself jumps there, and no motion near to it goes on. At one instant a contact
    /// stands between two fates: it carries exactly the most that it can, as it arrives or while it
    /// sticks, and is released beyond, which changes the motion at once where static friction is
    /// above the kinetic one; or it is just caught by its belt, and missed beyond. The multipliers
    /// on this side say nothing of it.
    Discontinuity {
        /// The parameter there.
        parameter: f64,
        /// When the motions on the two sides part, in units of time since the start of the period.
        time: f64,
        /// The contact at which they part.
        contact: usize,
        /// The events of the last motion, by contact and kind.
        events: Vec<(usize, EventKind)>,
        /// The events of the motion from the same start just beyond. Where they are of the same
        /// kinds, the time of one jumps.
        beyond: Vec<(usize, EventKind)>,
    },
    /// The branch came back to where it began.
    Closed,
    /// The work allowed was done: 2048 points in one direction, or 50 000 motions tried, or 10⁷
    /// steps of them.
    Work,
    /// The motion could not be followed further. The family had no system there, or Newton's method
    /// found no motion however short the step.
    Lost {
        /// The last parameter at which a motion was found.
        parameter: f64,
        /// What happened beyond, with the parameter there.
        error: Error,
    },
}

impl<S: System> Clone for Branch<S> {
    fn clone(&self) -> Self {
        Self {
            points: self.points.clone(),
            bifurcations: self.bifurcations.clone(),
            ends: self.ends.clone(),
        }
    }
}

impl<S: System> Clone for BranchPoint<S> {
    fn clone(&self) -> Self {
        let orbit = self.orbit.clone();
        Self { orbit, ..*self }
    }
}

impl<S: System> Clone for Bifurcation<S> {
    fn clone(&self) -> Self {
        let orbit = self.orbit.clone();
        Self { orbit, ..*self }
    }
}

impl<S: System> fmt::Debug for Branch<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Branch")
            .field("points", &self.points)
            .field("bifurcations", &self.bifurcations)
            .field("ends", &self.ends)
            .finish()
    }
}

impl<S: System> fmt::Debug for BranchPoint<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("BranchPoint")
            .field("parameter", &self.parameter)
            .field("orbit", &self.orbit)
            .finish()
    }
}

impl<S: System> fmt::Debug for Bifurcation<S> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Bifurcation")
            .field("parameter", &self.parameter)
            .field("kind", &self.kind)
            .field("orbit", &self.orbit)
            .finish()
    }
}
