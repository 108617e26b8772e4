use std::fmt;

/// The side of a Hopf point, a flip or a pitchfork on which the new motions exist.
///
/// For a Hopf point of a mass on a belt, the sign of d³μ̂/ds³(v_b) decides: the third derivative of
/// the kinetic friction coefficient μ̂(s) at the belt velocity. The amplitude A obeys the averaged
/// equation A' = −½h1 A − (3/8)h3 A³ with h1 = 2β + γ² dμ̂/ds(v_b), h3 = (γ²/6) d³μ̂/ds³(v_b), the
/// damping ratio β and the friction load γ² (Eq. 12 of Farshidianfar and Noei Aghaee, for any law).
/// For a Hopf point of a structure, the sign of the first Lyapunov coefficient decides.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Criticality {
    /// The new motions are stable and exist where the old motion is unstable (for a mass on a belt:
    /// d³μ̂/ds³(v_b) > 0).
    Supercritical,
    /// The new motions are unstable and exist where the old motion is still stable (for a mass on a
    /// belt: d³μ̂/ds³(v_b) < 0).
    Subcritical,
    /// The side is not decided. For a Hopf point: the third derivative of μ̂ or the first Lyapunov
    /// coefficient is NaN or 0. If it is 0, terms of higher order decide. (Friction that is
    /// constant or linear in the sliding speed has none.) For a flip or a pitchfork: the
    /// multipliers do not determine the side.
    Degenerate,
}

impl fmt::Display for Criticality {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(match self {
            Self::Supercritical => "supercritical",
            Self::Subcritical => "subcritical",
            Self::Degenerate => "degenerate",
        })
    }
}
