//! Families of periodic motions: if friction and damping transfer no net energy, every motion is
//! periodic.

#[cfg(feature = "serde")]
use super::written;
use crate::belt::{Belt, Forward};
use crate::friction::{Values, frictionless_speed, is_constant_near, is_constant_on};

/// A continuous family of periodic motions, one for each amplitude in a range.
///
/// On a moving belt the family fills a disc around the equilibrium. The family exists if there is
/// no damping, and friction does not depend on the speed near the sliding speed |v_b|, the speed of
/// the belt. Constant friction, as in Coulomb's law, neither feeds nor damps a motion in slip.
///
/// On a belt at rest the family exists if there is neither damping nor, up to a speed above γ²μ_s,
/// kinetic friction. It then consists of all motions with amplitudes between γ²μ_s, the product of
/// friction load and static coefficient, and that speed. A mass that turns back at a smaller
/// displacement sticks.
///
/// ```
/// use stick_slip::{Coulomb, MassOnBelt, limit_cycle};
///
/// let cycles = limit_cycle::find(&MassOnBelt::new(Coulomb::new(0.4, 0.25)?, 0.2)?)?;
/// assert_eq!(cycles.continuum().unwrap().max_amplitude, 0.2);
/// assert_eq!(cycles.len(), 1); // and the stick-slip cycle round it
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Continuum {
    /// Amplitude of the largest motion of the family, dimensionless: |v_b| if that motion touches
    /// the belt velocity; less if friction is constant only up to a breakpoint of the law; infinite
    /// if there is no friction; on a belt at rest the speed up to which there is none.
    #[cfg_attr(feature = "serde", serde(serialize_with = "written::infinite_as_none"))]
    pub max_amplitude: f64,
}

impl Continuum {
    pub(super) const WITHOUT_FRICTION: Self = Self {
        max_amplitude: f64::INFINITY,
    };

    /// The family on a belt at rest.
    pub(super) fn at_rest(system: Belt<'_>) -> Option<Self> {
        let [_, band] = system.stick_limits();
        let max_amplitude = frictionless_speed(system.law());
        (system.damping() == 0.0 && max_amplitude > band).then_some(Self { max_amplitude })
    }
}

/// Returns true if small motions are periodic: there is no damping, and friction does not depend on
/// the speed near v_b.
pub(super) fn is_flat(system: &Forward<'_>) -> bool {
    system.damping() == 0.0
        && is_constant_near(system.law(), system.belt_velocity())
        && flat_amplitude(system) > 0.0
}

/// Velocity amplitude up to which a motion in slip, where friction is constant near v_b, meets no
/// piece of the law on which friction varies; at most v_b.
pub(super) fn flat_amplitude(system: &Forward<'_>) -> f64 {
    let (law, v_b) = (system.law(), system.belt_velocity());
    let varies = |piece: usize, end: f64| !is_constant_on(law, piece, end);
    let mut amplitude = v_b;
    for (i, breakpoint) in law.breakpoints().enumerate() {
        let beyond = if breakpoint <= v_b { i } else { i + 1 };
        if varies(beyond, breakpoint) {
            amplitude = amplitude.min((v_b - breakpoint).abs());
        }
    }
    amplitude
}

/// Returns true if there is no friction at all.
pub(crate) fn is_frictionless(law: &dyn Values) -> bool {
    law.static_coefficient() == 0.0 && frictionless_speed(law) == f64::INFINITY
}
