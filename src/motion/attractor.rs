use std::fmt;

/// A kind of motion to which a system can settle.
///
/// [`bifurcation::vibration_ranges`](crate::bifurcation::vibration_ranges) finds all attractors of
/// a mass on a belt. For any system,
/// [`orbit::vibration_ranges`](crate::orbit::vibration_ranges()) and
/// [`orbit::classify`](crate::orbit::classify()) tell apart only whether a periodic motion sticks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum AttractorKind {
    /// Every mass is at rest, and every contact sticks.
    Rest,
    /// Every mass is at rest, and contacts slide steadily: stable steady sliding.
    SteadySliding,
    /// A family of periodic motions about steady sliding. None of them is asymptotically stable: a
    /// motion that reaches the family is one of its members from that time on.
    Continuum,
    /// A periodic motion in which no contact alternates between stick and slip.
    PureSlip,
    /// A periodic motion in which a contact alternates between stick and slip.
    StickSlip,
    /// Stick-slip of a mass that overtakes its belt: see
    /// [`CycleKind::Overshoot`](crate::CycleKind::Overshoot).
    Overshoot,
    /// Slip of a mass that crosses the velocity of its belt: see
    /// [`CycleKind::Crossing`](crate::CycleKind::Crossing).
    Crossing,
    /// Neither at rest nor periodic: see
    /// [`orbit::Attractor::Irregular`](crate::orbit::Attractor::Irregular).
    Irregular,
}

impl fmt::Display for AttractorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Rest => "rest",
            Self::SteadySliding => "steady sliding",
            Self::Continuum => "continuum",
            Self::PureSlip => "pure slip",
            Self::StickSlip => "stick-slip",
            Self::Overshoot => "overshoot",
            Self::Crossing => "crossing",
            Self::Irregular => "irregular",
        })
    }
}
