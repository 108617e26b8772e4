use std::ops::Range;

use super::positive;
use super::scan::root_between;
use crate::friction::FrictionLaw;
use crate::limit_cycle::Tracer;
use crate::{Error, MassOnBelt};

/// Belt velocities that a range is first divided into.
const INTERVALS: usize = 64;

/// Halvings of an interval in which turning points appear or disappear.
const DEPTH: u32 = 6;

/// Belt velocities in `range`, ascending, at which two pure-slip cycles, one stable and one unstable, meet and vanish.
///
/// At each belt velocity the growth of a motion over one turn, P(V)/V − 1 as a function of its peak velocity V, has turning points,
/// where its exact derivative is zero; a fold is where the growth at a turning point passes through zero, and there the multiplier is 1. Turning
/// points are followed over 64 belt velocities, and where their number changes over up to 2⁶ times as many.
///
/// # Errors
///
/// As [`grazing_velocities`](super::grazing_velocities).
///
/// ```
/// use stick_slip::{Exponential, MassOnBelt, bifurcation};
///
/// let system = MassOnBelt::new(Exponential::new(0.4, 0.3, 1.0)?, 1.4)?.with_damping(0.02)?;
/// let folds = bifurcation::fold_velocities(&system, 1.3..1.6)?;
/// assert_eq!(folds.len(), 1);
/// assert!((folds[0] - 1.457823592457963272).abs() < 1e-13);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn fold_velocities<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    range: Range<f64>,
) -> Result<Vec<f64>, Error> {
    let range = positive(range)?;
    let system = system.moving_forward();
    let turning_points = |v_b: f64| -> Result<Vec<(f64, f64)>, Error> {
        if v_b == 0.0 {
            return Ok(Vec::new());
        }
        let system = system.with_belt_velocity(v_b)?;
        Tracer::new(&system).turning_points()
    };
    let mut folds = Vec::new();
    let width = (range.end - range.start) / INTERVALS as f64;
    let mut left = (range.start, turning_points(range.start)?);
    for i in 1..=INTERVALS {
        let v_b = range.start + width * i as f64;
        let right = (v_b, turning_points(v_b)?);
        divide(&turning_points, &left, &right, DEPTH, &mut folds)?;
        left = right;
    }
    folds.retain(|fold| range.contains(fold));
    Ok(folds)
}

/// A belt velocity, and the turning points there: peak velocity and growth.
type Row = (f64, Vec<(f64, f64)>);

fn divide(
    turning_points: &impl Fn(f64) -> Result<Vec<(f64, f64)>, Error>,
    a: &Row,
    b: &Row,
    depth: u32,
    folds: &mut Vec<f64>,
) -> Result<(), Error> {
    if a.1.len() != b.1.len() {
        if depth > 0 {
            let v_b = 0.5 * (a.0 + b.0);
            let middle = (v_b, turning_points(v_b)?);
            divide(turning_points, a, &middle, depth - 1, folds)?;
            divide(turning_points, &middle, b, depth - 1, folds)?;
        }
        return Ok(());
    }
    for (i, (p, q)) in std::iter::zip(&a.1, &b.1).enumerate() {
        if (p.1 > 0.0) != (q.1 > 0.0) {
            let mut growth = |v_b: f64| Ok(turning_points(v_b)?.get(i).map(|point| point.1));
            folds.push(root_between(&mut growth, (a.0, p.1), (b.0, q.1))?);
        }
    }
    Ok(())
}
