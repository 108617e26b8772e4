use super::object::{ForceObject, Place};
use crate::error::Error;
use crate::friction::check::JUMP;

/// Checks the rules on which a structure relies: the breakpoints ascend, the force is continuous
/// there, and the slope of the potential is the force at rest.
pub(crate) fn validate(law: &dyn ForceObject) -> Result<(), Error> {
    let breakpoints = law.breakpoints();
    let mut last = f64::NEG_INFINITY;
    for (index, &value) in breakpoints.iter().enumerate() {
        let is_allowed = value.is_finite() && value > last;
        if !(is_allowed && is_continuous(law, &breakpoints, index)) {
            return Err(Error::BadBreakpoints { index, value });
        }
        last = value;
    }
    let unit = breakpoints
        .iter()
        .fold(0.0, |unit: f64, b| unit.max(b.abs()));
    let unit = if unit > 0.0 { unit } else { 1.0 };
    (0..PARTS.len()).try_for_each(|shift| {
        let positions = (0..law.count()).map(|i| unit * PARTS[(shift + 2 * i) % PARTS.len()]);
        check_potential(law, &breakpoints, &positions.collect::<Vec<_>>())
    })
}

/// Positions at which a potential is compared with its force, in units of the largest breakpoint.
const PARTS: [f64; 5] = [-1.7, -0.6, 0.1, 0.4, 1.3];

/// Velocities at which the pieces of a law are compared.
const VELOCITIES: [f64; 3] = [0.0, 1.0, -1.0];

/// Returns true if the pieces that meet at a breakpoint agree there, relative to the forces there
/// and at the other ends of these pieces, and to the change of the force from 0 to the breakpoint.
fn is_continuous(law: &dyn ForceObject, breakpoints: &[f64], index: usize) -> bool {
    VELOCITIES.iter().all(|&velocity| {
        let [below, above] = [0, 1].map(|side| {
            let at = |x: f64| force_and_slope(law, x, velocity, index + side);
            let here = breakpoints[index];
            let (force, slope) = at(here);
            let end = (index + 2 * side).checked_sub(1);
            let end = end.and_then(|end| breakpoints.get(end));
            let far = end.map_or(0.0, |&end| at(end).0);
            let sizes = [force, far, slope * here].map(f64::abs);
            let sizes = sizes.into_iter().filter(|size| size.is_finite());
            (force, sizes.fold(0.0, f64::max))
        });
        (below.0 - above.0).abs() <= JUMP * below.1.max(above.1)
    })
}

/// F and ∂F/∂x on a piece of a law of one direction.
fn force_and_slope(law: &dyn ForceObject, x: f64, velocity: f64, piece: usize) -> (f64, f64) {
    let place = Place {
        positions: &[x],
        velocities: &[velocity],
        piece,
    };
    (law.forces(place)[0], law.slopes(place, 0)[0])
}

/// Compares ∂U/∂x_i with F_i where F_i is finite.
fn check_potential(
    law: &dyn ForceObject,
    breakpoints: &[f64],
    positions: &[f64],
) -> Result<(), Error> {
    let zeros = vec![0.0; positions.len()];
    let place = Place {
        positions,
        velocities: &zeros,
        piece: breakpoints.partition_point(|b| *b <= positions[0]),
    };
    let Some(energy) = law.potential(place) else {
        return Ok(());
    };
    for (i, (force, x)) in std::iter::zip(&law.forces(place), positions).enumerate() {
        let slope = law.potential_slope(place, i).unwrap_or(f64::NAN);
        if !force.is_finite() {
            continue;
        }
        // Where a law oscillates many times between 0 and x, rounding is that of x F'.
        let sizes = [*force, energy / x, x * law.slopes(place, i)[i]].map(f64::abs);
        let scale = sizes.into_iter().fold(0.0, f64::max);
        let agrees = energy.is_finite() && (slope - force).abs() <= JUMP * scale;
        let allowed = "the force at rest: F = dU/dx";
        Error::check("ForceLaw", "slope of the potential", slope, agrees, allowed)?;
    }
    Ok(())
}
