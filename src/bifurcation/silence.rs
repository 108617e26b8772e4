use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::FrictionLaw;
use crate::limit_cycle::{find_borrowed, is_frictionless};
use crate::numerics::bracket::Bracket;

/// The least damping ratio β, dimensionless, from which on no vibration lasts at the system's belt
/// velocity: steady sliding is stable, and there is no periodic motion. With less damping there is
/// a periodic motion, or steady sliding is unstable. The system's own β is ignored; 0 at v_b = 0.
///
/// Why there is such a border: more damping turns the velocity field at every state inwards. Take a
/// cycle at one β. With less damping, every motion that starts outside this curve stays outside it
/// and never reaches steady sliding. So a system that vibrates at one β can vibrate at every
/// smaller one.
///
/// At the border steady sliding becomes stable (β = −½γ²dμ̂/ds(|v_b|)), or the last two cycles
/// meet, or stick-slip grazes the belt. The border is enclosed by doubling β and narrowed to
/// neighbouring numbers. [`find`](crate::limit_cycle::find) judges whether a system vibrates, so
/// the result is as complete as that search; a range that [can't be
/// resolved](crate::limit_cycle::CycleSet::unresolved) counts as a vibration. On very slow belts
/// and near steady sliding, one turn may change a motion by less than rounding does; `find` then
/// decides by averaging. If steady sliding becomes stable and vibration ends within a relative 10⁻⁸
/// of the same β, the two are not told apart.
///
/// Source: cycles of rotated vector fields, Duff, *Ann. Math.* 57 (1953) 15-31.
///
/// # Errors
///
/// [`Error::At`], with the β tried and one of the errors of [`find`](crate::limit_cycle::find). No
/// β tried is larger than the largest of 10⁻³, twice the result, and twice the β at which steady
/// sliding becomes stable.
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
#[doc(alias = "squeal")]
#[doc(alias = "critical damping")]
#[doc(alias = "least_damping")]
pub fn silencing_damping<L: FrictionLaw>(system: &MassOnBelt<L>) -> Result<f64, Error> {
    if system.belt_velocity() == 0.0 || is_frictionless(system.law()) {
        return Ok(0.0);
    }
    let system = system.by_reference();
    // A trait object, so that the search is compiled once.
    let vibrates: &dyn Fn(f64) -> Result<bool, Error> = &|damping| {
        let cycles = system
            .with_damping(damping)
            .and_then(find_borrowed)
            .map_err(|error| error.at("damping", damping))?;
        Ok(!cycles.is_empty() || !cycles.unresolved().is_empty())
    };
    let slope = system.law().slope(system.belt_velocity().abs());
    // The β below which steady sliding is unstable.
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

/// Relative distance above the β at which steady sliding becomes stable; small cycles closer to it
/// are not resolved.
const MARGIN: f64 = 1e-8;

/// First β that is tried if steady sliding is always stable.
const FIRST: f64 = 1e-3;

#[cfg(test)]
mod tests;
