use super::PureSlip;
use crate::belt::MassOnBelt;
use crate::friction::Polynomial;
use crate::motion::AttractorKind;

/// Returns the motion to which a system with the polynomial law settles, by closed forms for weak
/// friction and damping.
///
/// | belt velocity | motion |
/// |---|---|
/// | v_b = 0 | [`Rest`](AttractorKind::Rest): the mass comes to rest on the belt |
/// | 0 < \|v_b\| ≤ v_b0 | [`StickSlip`](AttractorKind::StickSlip), also of a mass that overtakes the belt |
/// | v_b0 < \|v_b\| < v_b1 | [`PureSlip`](AttractorKind::PureSlip) |
/// | \|v_b\| ≥ v_b1 | [`SteadySliding`](AttractorKind::SteadySliding) |
///
/// With constant friction and without damping the motion is a member of a
/// [`Continuum`](AttractorKind::Continuum), unless v_b = 0: every vibration with an amplitude up to
/// |v_b| lasts for ever.
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
/// use stick_slip::analysis::regime;
/// use stick_slip::{AttractorKind, MassOnBelt, Polynomial};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.0)?.with_damping(0.05)?;
/// assert_eq!(regime(&system), AttractorKind::Rest);
/// assert_eq!(regime(&system.with_belt_velocity(0.2)?), AttractorKind::StickSlip);
/// assert_eq!(regime(&system.with_belt_velocity(0.4)?), AttractorKind::PureSlip);
/// assert_eq!(regime(&system.with_belt_velocity(-0.5)?), AttractorKind::SteadySliding);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn regime(system: &MassOnBelt<Polynomial>) -> AttractorKind {
    let Some(equilibrium) = system.equilibrium() else {
        return AttractorKind::Rest;
    };
    match PureSlip::new(system) {
        Some(formulas) if formulas.eta() == 0.0 && system.damping() == 0.0 => {
            AttractorKind::Continuum
        }
        Some(formulas) if formulas.h1() >= 0.0 => AttractorKind::SteadySliding,
        Some(formulas) if formulas.is_valid() => AttractorKind::PureSlip,
        // The coefficients overflow.
        None if equilibrium.is_stable() => AttractorKind::SteadySliding,
        _ => AttractorKind::StickSlip,
    }
}
