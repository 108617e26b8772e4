use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::limit_cycle::{find_borrowed, is_frictionless};
use crate::numerics::bracket::Bracket;

/// The least damping ratio β from which on no vibration lasts at the system's belt velocity: steady
/// sliding is stable, and there is no periodic motion. Below it there is one, or steady sliding is
/// unstable. The system's own β is ignored; 0 at v_b = 0.
///
/// Such a border exists. With more damping the velocity field at every state is turned inwards, so
/// round a cycle at one β every motion with less damping that starts outside stays outside, and
/// never gets to steady sliding: what vibrates at one β can vibrate at every smaller one.
///
/// At the border steady sliding becomes stable, at β = −½γ²dμ̂/ds(|v_b|), or the last two cycles
/// meet, or stick-slip grazes the belt. It is enclosed by doubling and narrowed to neighbouring
/// numbers, with [`find`](crate::limit_cycle::find) as the judge, and is as complete as that is: a
/// range that [can't be resolved](crate::limit_cycle::CycleSet::unresolved) counts as a vibration.
/// Where rounding hides the growth over a turn, near steady sliding and on very slow belts, `find`
/// decides by averaging. Steady sliding and a vibration that end within a relative 10⁻⁸ of each
/// other are not told apart.
///
/// Source: cycles of rotated vector fields, Duff, *Ann. Math.* 57 (1953) 15-31.
///
/// # Errors
///
/// [`Error::At`], with the damping and one of the errors of [`find`](crate::limit_cycle::find), at
/// any of the β tried: the largest is 10⁻³, or less than twice the result, or than twice the β at
/// which steady sliding becomes stable.
///
/// ```
/// use stick_slip::{Coulomb, Exponential, MassOnBelt, bifurcation};
///
/// let system = MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, 1.0)?;
/// let silent = bifurcation::silencing_damping(&system)?;
/// // Steady sliding is stable from 0.0110 on; stick-slip goes on beside it.
/// assert!(silent > 0.012);
///
/// // Coulomb's law never destabilises steady sliding.
/// let system = MassOnBelt::new(Coulomb::new(0.4, 0.25)?, 0.1)?;
/// assert!(bifurcation::silencing_damping(&system)? > 0.1);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn silencing_damping<L: FrictionLaw>(system: &MassOnBelt<L>) -> Result<f64, Error> {
    if system.belt_velocity() == 0.0 || is_frictionless(system.law()) {
        return Ok(0.0);
    }
    let system = system.by_reference();
    // Compiled once, for all that ask it.
    let vibrates: &dyn Fn(f64) -> Result<bool, Error> = &|damping| {
        let cycles = system
            .with_damping(damping)
            .and_then(find_borrowed)
            .map_err(|error| error.at("damping", damping))?;
        Ok(!cycles.is_empty() || !cycles.unresolved().is_empty())
    };
    let slope = system.law().slope(system.belt_velocity().abs());
    // Steady sliding is unstable below.
    let stable = (-0.5 * system.load() * slope).max(0.0);
    let just_above = stable * (1.0 + MARGIN) + f64::MIN_POSITIVE;
    if !vibrates(just_above)? {
        return Ok(stable);
    }
    let (mut loud, mut silent) = (just_above, (2.0 * just_above).max(FIRST));
    while vibrates(silent)? {
        (loud, silent) = (silent, 2.0 * silent);
    }
    let mut border = Bracket::new((loud, 1.0), (silent, -1.0));
    while let Some(damping) = border.next_place() {
        border.narrow(damping, if vibrates(damping)? { 1.0 } else { -1.0 });
    }
    Ok(border.sign_change().below.next_up())
}

/// Relative distance from the border of stability within which small cycles are not resolved.
const MARGIN: f64 = 1e-8;

/// First β that is tried, if steady sliding is always stable.
const FIRST: f64 = 1e-3;

#[cfg(test)]
mod tests;
