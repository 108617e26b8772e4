//! Continuous families of closed motions, told from folds and pitchforks.

use nalgebra::DVector;

use super::period_map::run::period_map;
use super::period_map::{CLOSED, PeriodMap, state, vector};
use super::type_erased_system::GeneralForm;
use crate::numerics::least_norm::conserving;

/// The distance of the neighbour that is tried, in units of the sizes. A fold or a pitchfork has a
/// multiplier 1, too, but its residual there is of the order of the square or the cube.
const APART: f64 = 3e-3;

/// Singular values below this part of the largest count as 0 while the neighbour is corrected:
/// along a family they are of the order of its residual, beside a fold and a pitchfork of the order
/// of the distance or of its square.
const SINGULAR: f64 = 1e-5;

/// Corrections of the neighbour, which converge quadratically. At a fold each halves the distance.
const CORRECTIONS: usize = 6;

/// The directions of the continuous family to which a closed motion belongs: perturbations of its
/// start.
pub(super) fn families(
    form: &GeneralForm<'_>,
    map: &PeriodMap,
    is_free: bool,
    period: f64,
) -> Vec<DVector<f64>> {
    let sizes = map.sizes();
    let mut neutral = map.neutral(is_free, period);
    // Where there are no more than those that are known, no fold hides among them.
    if neutral.len() > map.known_families() {
        let is_one = |neighbour: &(DVector<f64>, f64)| {
            [APART, -APART].into_iter().any(|by| {
                has_neighbour(form, (map, is_free, period), neighbour, by).unwrap_or(false)
            })
        };
        neutral.retain(is_one);
    }
    let found = neutral.into_iter();
    found.map(|(d, _)| d.component_mul(&sizes)).collect()
}

/// Returns true if a closed motion lies at a distance in a direction, in units of the sizes, in
/// which the period grows; `None` if a motion there fails.
fn has_neighbour(
    form: &GeneralForm<'_>,
    (map, is_free, period): (&PeriodMap, bool, f64),
    (direction, longer): &(DVector<f64>, f64),
    by: f64,
) -> Option<bool> {
    let (order, n) = (map.order(), form.len());
    let (sizes, origin) = (map.sizes(), vector(&map.start, map.order()));
    let mut start = &origin + (direction * by).component_mul(&sizes);
    let mut period = period * (1.0 + by * longer);
    let modes = map.end_modes();
    let motion = |start: &DVector<f64>, period: f64| {
        let mut here = state(start, n);
        form.put_in_modes(&mut here, 0.0, &|c| Some(modes[c]));
        let there = period_map(form, 0.0, &here, period).ok()?;
        Some((vector(&here, order), there))
    };
    for _ in 0..CORRECTIONS {
        let (here, there) = motion(&start, period)?;
        let (matrix, right, unit) = there.equations(is_free.then_some(&map.flow[0]), period);
        let step = conserving(matrix, &right, SINGULAR, order)?;
        start = here + step.rows(0, order).component_mul(&there.sizes());
        if is_free {
            period *= 1.0 + step[order] / unit;
        }
    }
    let (here, there) = motion(&start, period)?;
    let moved = (here - origin).component_div(&sizes);
    let part = moved.dot(direction) / (by * direction.norm_squared());
    Some(part > 0.5 && there.miss() <= CLOSED * there.growth())
}
