//! Force elements: known forces of positions and velocities, order by order before the coordinates.
//!
//! Order k of a force needs orders up to k of the displacements and velocities, which are known
//! before order k + 1 of the velocities. The forces of force elements are continuous in the state.
//! That of a stop with a damper jumps where it closes: contacts are then decided as where a drive
//! jumps. A stop without a force has no effect on any order.

use std::ops::Range;

use super::contact_data::entry;
use super::element_data::ElementData;
use super::element_series::ElementSeries;
use super::fault::{Fault, FaultyLaw};
use super::model::Model;
use super::series::Series;
use super::state::Situation;
use crate::force::object::Place;
use crate::series::{PowerSeries, TERMS};

/// Changes the piece of each element that leaves its border to the other side; returns true if
/// there are any.
pub(super) fn revise_pieces(model: &Model<'_>, situation: &mut Situation, series: &Series) -> bool {
    let mut changed = false;
    let elements = std::iter::zip(&model.elements, &series.elements);
    for ((element, of), state) in std::iter::zip(elements, &mut situation.elements) {
        let Some(border) = state.on.filter(|_| state.is_open) else {
            continue;
        };
        let distance = state.distance(element, of, border);
        let Some(first) = distance.first_nonzero() else {
            continue;
        };
        state.is_open = false;
        let piece = element.piece_beyond(border, first > 0.0);
        changed |= piece != state.piece;
        state.piece = piece;
    }
    changed
}

/// Order k of all elements, and of the laws of first-order states.
pub(super) fn element_order(model: &Model<'_>, series: &mut Series, k: usize) {
    let motion = (&*series.coordinates, &*series.states);
    for (element, of) in std::iter::zip(&model.elements, &mut series.elements) {
        of.order(element, motion, k);
        if k == 0 {
            of.note_tangents(element);
        }
    }
}

/// Order k of their forces on the coordinates.
pub(super) fn push(model: &Model<'_>, series: &mut Series, k: usize) {
    let Series {
        coordinates,
        elements,
        laws,
        ..
    } = series;
    laws.fill(0.0);
    for (element, of) in std::iter::zip(&model.elements, elements) {
        if !of.acts {
            continue;
        }
        for (i, response) in element.responses.iter().enumerate() {
            let force = of.product(i, k);
            for &(j, x) in response {
                match j.checked_sub(coordinates.len()) {
                    None => coordinates[j].force[k] -= x * force,
                    Some(state) => laws[state] -= x * force,
                }
            }
        }
    }
}

/// The elements that act on a coordinate while no other one is accelerated.
pub(super) struct Pushing<'e, 'm> {
    elements: &'e [ElementData<'m>],
    series: &'e mut [ElementSeries],
    /// The entries of the coordinate in each direction and in its response.
    entries: Vec<[f64; 2]>,
}

impl<'e, 'm> Pushing<'e, 'm> {
    pub(super) fn new(
        elements: &'e [ElementData<'m>],
        series: &'e mut [ElementSeries],
        i: usize,
    ) -> Self {
        let entries = elements.iter().flat_map(|element| {
            let directions = std::iter::zip(&*element.directions, &element.responses);
            directions.map(|(direction, response)| [entry(direction, i), entry(response, i)])
        });
        let entries = entries.collect();
        Self {
            elements,
            series,
            entries,
        }
    }

    /// The acceleration against all of them of order k > 0, from this order of the velocity.
    pub(super) fn order(&mut self, velocity: f64, k: usize) -> f64 {
        let (mut against, mut entries) = (0.0, &self.entries[..]);
        for (element, of) in std::iter::zip(self.elements, &mut *self.series) {
            let (own, others) = entries.split_at(element.responses.len());
            against += of.order_along(element, own, velocity, k);
            entries = others;
        }
        against
    }
}

/// Orders of the positions and velocities of stops without a force, which do not act on the
/// coordinates.
pub(super) fn watch(model: &Model<'_>, series: &mut Series, orders: Range<usize>) {
    let Series {
        coordinates,
        elements,
        states,
        ..
    } = series;
    let elements = std::iter::zip(&model.elements, elements);
    for (element, of) in elements.filter(|(_, of)| !of.acts) {
        for k in orders.clone() {
            of.follow(element, (coordinates, states), k);
        }
    }
}

/// The fault of an element: of its force, of the load of which it is a part, or of the rate.
fn fault(model: &Model<'_>, series: &Series, element: usize, value: Option<f64>) -> Fault {
    let (data, of) = (&model.elements[element], &series.elements[element]);
    let velocity = of.velocities[0][0];
    let law = match (data.rate_of, data.pressed) {
        (Some((state, _)), _) => FaultyLaw::Rate(state),
        (None, Some(contact)) => FaultyLaw::Load(contact, velocity),
        (None, None) => FaultyLaw::Force(element, velocity),
    };
    let place = of.positions[0][0];
    Fault { law, place, value }
}

/// The fault of the first element whose force is no number, or has no series. That of a stop is
/// linear.
pub(super) fn force_fault(model: &Model<'_>, series: &Series) -> Option<Fault> {
    let mut elements = series.elements[..model.first_stop()].iter().enumerate();
    elements.find_map(|(element, of)| {
        if let Some(force) = of.forces.iter().find(|force| !force[0].is_finite()) {
            return Some(fault(model, series, element, Some(force[0])));
        }
        let is_given = |series: &PowerSeries| series[0].is_finite() && series[1].is_finite();
        let mut motion = of.positions.iter().chain(&of.velocities);
        let has_no_series = of.forces.iter().any(|force| !force[1].is_finite());
        (has_no_series && motion.all(is_given)).then(|| fault(model, series, element, None))
    })
}

/// The first element whose force has a singular point close to the position at the start, if steps
/// have become too short: a pole if the force grows towards it.
pub(super) fn singular_force(model: &Model<'_>, series: &Series) -> Option<Fault> {
    /// Largest distance of the point, as a part of the position; of positions below this, of this.
    const CLOSE: f64 = 1e-6;
    let elements = std::iter::zip(&model.elements, &series.elements).enumerate();
    let elements = elements.take(model.first_stop());
    let mut faults = elements.filter_map(|(element, (data, of))| {
        let position = of.positions[0][0];
        // The power series of F along the first direction.
        let fixed = |series: &Vec<PowerSeries>| -> Vec<PowerSeries> {
            series
                .iter()
                .map(|series| PowerSeries::of(series[0]))
                .collect()
        };
        let (mut positions, velocities) = (fixed(&of.positions), fixed(&of.velocities));
        positions[0][1] = 1.0;
        let place = Place {
            positions: &positions,
            velocities: &velocities,
            piece: of.piece,
        };
        let force = data.law.series(place).swap_remove(0);
        let ratios = (TERMS / 2..TERMS - 1).map(|k| (force[k] / force[k + 1]).abs());
        let radius = ratios.fold(f64::INFINITY, f64::min);
        if radius.is_nan() || radius > CLOSE * position.abs().max(CLOSE) {
            return None;
        }
        let towards = [0.9, -0.9].map(|part| {
            let mut near: Vec<f64> = positions.iter().map(|x| x[0]).collect();
            near[0] += part * radius;
            let velocities: Vec<f64> = velocities.iter().map(|y| y[0]).collect();
            data.law.forces(Place {
                positions: &near,
                velocities: &velocities,
                piece: of.piece,
            })[0]
                .abs()
        });
        let value = force[0];
        let grows = towards.iter().any(|near| *near > 2.0 * value.abs());
        Some(fault(model, series, element, grows.then_some(value)))
    });
    faults.next()
}
