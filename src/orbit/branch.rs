//! Branches of periodic motions over a parameter: the results of `follow`.

use std::fmt;
use std::ops::Range;

use super::oscillator::{Oscillator, Systems};
use super::period::Period;
use super::periodic_orbit::Orbit;
use super::shooting_residual::TrialMotion;
use crate::error::{Element, Error};
use crate::motion::{EventKind, SystemState};
use crate::state::Direction;

/// The periodic motions over a parameter that [`follow`](super::follow()) finds in both directions
/// from one motion.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Branch<S: SystemState> {
    /// The motions, from one end of the branch to the other.
    pub points: Vec<BranchPoint<S>>,
    /// The bifurcations between the motions, in the order of `points`. If the branch ends at a
    /// grazing or at its birth, the list also contains this change, as the first or the last entry.
    pub bifurcations: Vec<Bifurcation<S>>,
    /// The reasons why the branch ends before its first point, and after its last one.
    pub ends: [BranchEnd; 2],
}

/// A periodic motion of a [`Branch`].
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct BranchPoint<S: SystemState> {
    /// The parameter, in its own units.
    pub parameter: f64,
    /// The motion, with its multipliers.
    pub orbit: Orbit<S>,
}

/// A motion of a [`Branch`] at which the sequence of events, the stability, or the number of
/// neighbouring motions changes.
#[derive(Debug, Clone)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[non_exhaustive]
pub struct Bifurcation<S: SystemState> {
    /// The parameter, in its own units.
    pub parameter: f64,
    /// The kind of bifurcation.
    pub kind: BifurcationKind,
    /// The motion at the bifurcation. At a change of the event sequence there is a motion on each
    /// side; `orbit` is the motion in which perturbations grow less within a period.
    pub orbit: Orbit<S>,
    /// The number of the last point of the branch before it.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) behind: usize,
    /// The range of the parameter in which the branch was followed.
    #[cfg_attr(feature = "serde", serde(skip))]
    pub(super) range: Range<f64>,
}

/// The kind of a [`Bifurcation`].
///
/// Multipliers are the eigenvalues of the monodromy matrix: see [the page of this
/// module](super#multipliers).
///
/// Source: Kuznetsov, *Elements of Applied Bifurcation Theory*, chapters 4 and 5 (fold, flip,
/// Neimark-Sacker); di Bernardo, Budd, Champneys and Kowalczyk, *Piecewise-smooth Dynamical
/// Systems*, chapters 7 and 8 (grazing and sliding).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(rename_all = "snake_case")
)]
pub enum BifurcationKind {
    /// A multiplier is +1: two motions meet and vanish, and the branch turns back. A branch that is
    /// born at a flip or a pitchfork of another branch turns back at its birth. This turning point
    /// is reported as a fold of the new branch.
    Fold,
    /// A multiplier is −1: a motion of twice the period is born. [`Bifurcation::switch`] finds this
    /// motion.
    Flip,
    /// A multiplier of a symmetric motion is +1, but the branch continues. Two motions without the
    /// symmetry, mirror images of each other, are born. [`Bifurcation::switch`] finds one of them.
    ///
    /// A motion x(t) of period T is symmetric if x(t + T/2) = c − x(t) with constant c: see
    /// [`Orbit::is_symmetric`]. Consider the map over half a period, followed by the reflection of
    /// x to c − x. At a pitchfork this map has the multiplier −1. (The multipliers of a symmetric
    /// motion are the squares of those of this map. A simple multiplier −1 is therefore impossible,
    /// and a symmetric motion has no flip.)
    Pitchfork,
    /// A pair of multipliers lies on the unit circle: quasi-periodic motions on a torus are born.
    NeimarkSacker,
    /// A slipping contact reaches relative velocity 0 tangentially, the force of a sticking contact
    /// reaches its limit tangentially, or a stop is just touched. Two new events appear.
    Grazing,
    /// One event changes into others (for example, a crossing into stick and release), or two
    /// events of different contacts change their order.
    Sequence,
}

impl BifurcationKind {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Fold => "fold",
            Self::Flip => "flip",
            Self::Pitchfork => "pitchfork",
            Self::NeimarkSacker => "Neimark-Sacker",
            Self::Grazing => "grazing",
            Self::Sequence => "change of events",
        }
    }
}

impl fmt::Display for BifurcationKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl<S: SystemState> Branch<S> {
    /// The point of the branch at which the [amplitude](Orbit::amplitude) of a coordinate is
    /// largest, for example of a resonance. `None` if the coordinate does not exist. Neighbouring
    /// points of a branch are at most 1/64 of the range apart: for more digits
    /// [`follow`](super::follow()) the branch in a narrower range.
    ///
    /// ```
    /// use stick_slip::orbit::{self, Period};
    /// use stick_slip::{Drive, Error, Structure, structure::State};
    ///
    /// // x'' + 0.1 x' + x = cos Ωt: the largest amplitude is that at Ω² = 1 − 2·0.05².
    /// let family = |frequency: f64| -> Result<Structure, Error> {
    ///     Structure::new(&[1.0])?
    ///         .with_ground_spring(0, 1.0)?
    ///         .with_ground_damper(0, 0.1)?
    ///         .with_force(0, Drive::harmonic(1.0, frequency, 0.0)?)
    /// };
    /// let start = State::at_rest(1);
    /// let orbit = orbit::shoot(&family(0.9)?, &start, Period::Driven(1))?;
    /// let branch = orbit::follow(family, 0.9, &orbit, 0.9..1.1)?;
    /// let peak = branch.peak(0).ok_or("no such coordinate")?;
    /// assert!((peak.parameter - 0.9975_f64).abs() < 0.2 / 64.0);
    /// assert!((peak.orbit.amplitude(0) - 10.0125).abs() < 0.01);
    /// assert!(branch.peak(1).is_none());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    #[doc(alias = "resonance")]
    pub fn peak(&self, coordinate: usize) -> Option<&BranchPoint<S>> {
        let amplitude = |point: &&BranchPoint<S>| point.orbit.amplitude(coordinate);
        let points = self
            .points
            .iter()
            .filter(|point| !amplitude(point).is_nan());
        points.max_by(|a, b| amplitude(a).total_cmp(&amplitude(b)))
    }
}

/// The reason why a [`Branch`] ends. Parameters are in their own units.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum BranchEnd {
    /// The parameter reached an end of the range.
    Range,
    /// The motion shrank to an equilibrium that changes its stability at this parameter: a Hopf
    /// bifurcation.
    Hopf {
        /// The parameter of the Hopf bifurcation, at which the growth rate of steady sliding is 0.
        /// It is exact to rounding if it is found from the eigenvalues of steady sliding. Otherwise
        /// it is extrapolated from four small motions, with an error of about 1e-9 of the range.
        parameter: f64,
    },
    /// An event of the motion became tangential, and the branch cannot continue. At the end of the
    /// branch the relative velocity of a contact reaches 0 tangentially. Beyond the end the
    /// relative velocity does not reach 0.
    Grazing {
        /// The parameter of the end, to rounding. The motion at the end is stored as the first or
        /// the last entry of [`Branch::bifurcations`]. The derivative of the period map is
        /// unbounded there: the first multiplier is infinite, and the others are NaN.
        parameter: f64,
    },
    /// The motion jumps as the parameter passes this value, and the branch cannot continue. The
    /// motions on the two sides agree up to one instant of the period. At this instant a contact
    /// enters different modes. There are three cases:
    ///
    /// * In stick, or at the start of stick, the force of the contact just reaches the static
    ///   limit. Beyond the parameter the contact slips at this instant. If static friction exceeds
    ///   kinetic friction, the friction force jumps.
    /// * The relative velocity of the contact just reaches 0, and the derivative of the period map
    ///   stays bounded. (If it grows without bound, the end is a [`Grazing`](Self::Grazing).)
    ///   Beyond the parameter the relative velocity does not reach 0.
    /// * In stick, the force of the contact reaches the static limit tangentially, and static
    ///   friction exceeds kinetic friction. Before the end, the contact is released at this
    ///   instant; beyond, its force stays below the limit.
    ///
    /// In the first two cases the multipliers do not show the jump in advance. In the third case,
    /// as before a [`Grazing`](Self::Grazing), the first multiplier grows without bound.
    Discontinuity {
        /// The parameter at the jump. In the third case it is extrapolated from up to five motions,
        /// with an error of about 1e-3 of its distance from the last motion.
        parameter: f64,
        /// The time at which the motions on the two sides of the jump separate, in units of time,
        /// counted from the start of the period.
        time: f64,
        /// The contact at which the motions separate.
        contact: usize,
        /// The events of the last motion, by element and kind.
        events: Vec<(Element, EventKind)>,
        /// The events of the motion that has the same start just beyond the parameter. If this list
        /// equals `events`, the time of an event at `contact` jumps.
        beyond: Vec<(Element, EventKind)>,
    },
    /// The friction force of a contact that never slips reaches its limit at one instant of the
    /// period. Beyond this parameter the contact slips at this instant in each period, and no slip
    /// in the other direction compensates for this slip. The contact is then displaced in each
    /// period, and the motion is not periodic.
    ///
    /// Motions in which a contact never slips form a continuum, one motion for each position of the
    /// contact. The branch consists of the motions with one position. Beyond the end of the branch
    /// the slips change the position. Either they continue (ratcheting), or they become shorter and
    /// cease: the contact has then reached a position of another branch (shakedown). To find that
    /// branch, start [`settle`](super::settle) from the last motion.
    ///
    /// Source: A. Klarbring, M. Ciavarella, J. R. Barber, "Shakedown in elastic contact problems
    /// with Coulomb friction", Int. J. Solids Struct. 44 (2007) 8355.
    OneWaySlip {
        /// The parameter at this end, to rounding.
        parameter: f64,
        /// The contact.
        contact: usize,
        /// The direction of the slip beyond the end.
        direction: Direction,
    },
    /// The branch is born at this change of the events, from motions with a symmetry that its own
    /// motions lack: their period is a part of its period, or they are
    /// [symmetric](super::Orbit::is_symmetric). Beyond the end lie the images of its motions: the
    /// same motions, begun a part of the period later, or their mirror images. The change is the
    /// first or the last entry of [`Branch::bifurcations`]. (A branch that is born at a
    /// [`Flip`](BifurcationKind::Flip) or [`Pitchfork`](BifurcationKind::Pitchfork) has a fold
    /// there, and continues with these images.)
    Birth {
        /// The parameter of the change, to rounding.
        parameter: f64,
    },
    /// The branch reached motions that it already contains. Either it is a closed curve, and
    /// returned to its start, or it meets itself. For example, a branch leaves the symmetric
    /// motions at a change of the events, and returns to this change along the mirror images.
    Closed,
    /// A limit of work was reached: 2048 points, 10⁷ integration steps or 50 000 motions tried, in
    /// one direction. [`Search`](super::Search) sets other limits of points and steps.
    Work,
    /// The watcher of the [`Search`](super::Search) stopped the search.
    Stopped {
        /// The last parameter at which a motion was found.
        parameter: f64,
    },
    /// The motion was lost: the function `family` returns an error at the next parameter, or
    /// Newton's method does not converge even with the shortest step.
    Lost {
        /// The last parameter at which a motion was found.
        parameter: f64,
        /// The error that ended the branch just beyond the last motion, with the parameter at which
        /// it occurred.
        #[cfg_attr(feature = "serde", serde(serialize_with = "super::written::in_words"))]
        error: Error,
    },
}

impl<S: SystemState> BranchPoint<S> {
    /// The motion of a trial, with the parameter at which it was found.
    pub(super) fn of<T: Oscillator<State = S>>(
        family: &Systems<'_, T>,
        parameter: f64,
        trial: TrialMotion,
        kind: Period,
    ) -> Result<Self, Error> {
        let find = || {
            let system = family(parameter)?;
            Orbit::new(&system, &system.form(), trial, kind)
        };
        let orbit = find().map_err(|error: Error| error.at("parameter", parameter))?;
        Ok(Self { parameter, orbit })
    }
}
