use super::PureSlip;
use crate::belt::MassOnBelt;
use crate::friction::Polynomial;

/// The motion to which a system with the polynomial law settles, for weak friction and damping.
///
/// [`regime`] returns it from the belt velocity v_b and two limits, which Farshidianfar and Noei
/// Aghaee give after Eq. 15. Steady sliding is unstable for |v_b| below v_b1, the
/// [`PureSlip::onset_velocity`], which is exact. The mass sticks for |v_b| below v_b0, the
/// [`PureSlip::stick_velocity`], which is approximate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Regime {
    /// The mass comes to rest on the belt: v_b = 0.
    Rest,
    /// Steady sliding: |v_b| ≥ v_b1.
    Equilibrium,
    /// Vibration that slips all the time: v_b0 < |v_b| < v_b1. Constant friction without damping
    /// also counts as pure slip: every vibration with an amplitude up to |v_b| then lasts for ever.
    PureSlip,
    /// Vibration that sticks, or overtakes the belt: 0 < |v_b| ≤ v_b0.
    StickSlip,
}

impl std::fmt::Display for Regime {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Rest => "rest",
            Self::Equilibrium => "equilibrium",
            Self::PureSlip => "pure slip",
            Self::StickSlip => "stick-slip",
        })
    }
}

/// Returns the motion to which a system with the polynomial law settles, by closed forms for weak
/// friction and damping.
///
/// The limit v_b1 of steady sliding ([`PureSlip::onset_velocity`]) is exact. The limit v_b0 of
/// stick ([`PureSlip::stick_velocity`]) has a relative error O(ε²), with ε of [`analysis`](super);
/// [`PureSlip::grazing_velocity`] is more accurate. For other laws there is no single answer,
/// because several attractors can coexist.
///
/// Source: Farshidianfar and Noei Aghaee, after Eq. 15, corrected: v_b0 = √(4/5) v_b1 instead of
/// the printed √(4/3) v_b1, and stick-slip below v_b0 only.
///
/// ```
/// use stick_slip::analysis::{Regime, regime};
/// use stick_slip::{MassOnBelt, Polynomial};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.0)?.with_damping(0.05)?;
/// assert_eq!(regime(&system), Regime::Rest);
/// assert_eq!(regime(&system.with_belt_velocity(0.2)?), Regime::StickSlip);
/// assert_eq!(regime(&system.with_belt_velocity(0.4)?), Regime::PureSlip);
/// assert_eq!(regime(&system.with_belt_velocity(-0.5)?), Regime::Equilibrium);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn regime(system: &MassOnBelt<Polynomial>) -> Regime {
    let Some(equilibrium) = system.equilibrium() else {
        return Regime::Rest;
    };
    match PureSlip::new(system) {
        Some(formulas) if formulas.eta() == 0.0 && system.damping() == 0.0 => Regime::PureSlip,
        Some(formulas) if formulas.h1() >= 0.0 => Regime::Equilibrium,
        Some(formulas) if formulas.is_valid() => Regime::PureSlip,
        // The coefficients overflow.
        None if equilibrium.is_stable() => Regime::Equilibrium,
        _ => Regime::StickSlip,
    }
}
