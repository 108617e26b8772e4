//! First-order states z' = A_q q + A_v v + A_z z + u(t) + F, order by order, and the forces b z
//! that they exert.
//!
//! Order k + 1 of a state needs order k of all other numbers, so its force of each order is known
//! before the coordinates, as the forces of springs are.

use super::model::Model;
use super::series::Series;
use crate::series::INTEGRAL;

/// Order k of the forces of all first-order states, and k + 1 of the states.
pub(super) fn first_order_order(model: &Model<'_>, series: &mut Series, k: usize) {
    let Series {
        coordinates,
        states,
        inputs,
        laws,
        ..
    } = series;
    for (data, state) in std::iter::zip(&model.first_order, &*states) {
        for &(j, x) in &data.responses {
            coordinates[j].force[k] += x * state[k];
        }
    }
    for (number, data) in model.first_order.iter().enumerate() {
        let motion = |j: usize| &coordinates[j].motion;
        let rate = data.rate(
            |j| motion(j).displacement(k),
            |j| motion(j).velocity(k),
            |l| states[l][k],
        );
        states[number][k + 1] = (rate + inputs[number][k] + laws[number]) * INTEGRAL[k];
    }
}
