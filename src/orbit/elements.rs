//! Force elements in the variational equations.
//!
//! ```text
//! M δv' = … − Σ_i a_i D Σ_j (∂F_i/∂x_j a_j·δq + ∂F_i/∂y_j a_j·δv)
//! ```
//!
//! The part of a contact's load that has a law is an element, too: its force is a perturbation of
//! the load.
//!
//! The forces of force elements are continuous, and passages of breakpoints change their slopes
//! only: the saltation matrix of a passage is S = I. That of a stop whose force jumps is in
//! `saltation.rs`.

use super::coefficient::{Coefficient, product};
use crate::force::object::Place;
use crate::motion::Segment;
use crate::series::{INTEGRAL, PowerSeries};
use crate::structure::Step;
use crate::structure::engine::element_data::ElementData;
use crate::structure::engine::model::Model;

/// The derivatives of one element along a step: D ∂F_i/∂x_j, then D ∂F_i/∂y_j, a list over i for
/// each j.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct ElementDerivatives(pub(super) Vec<Vec<Coefficient>>);

impl ElementDerivatives {
    /// The derivatives of element number `e`.
    pub(super) fn of(model: &Model<'_>, e: usize, step: &Step) -> Self {
        let element = &model.elements[e];
        let along = Along::of(model, e, step);
        let factor = element.factor.series(step.clock());
        let by = |by: usize| {
            let slopes = element.law.derivative(along.place(), by);
            let slopes = slopes.iter().map(|slope| product(&factor, slope).into());
            slopes.collect()
        };
        Self((0..2 * element.directions.len()).map(by).collect())
    }

    /// D F_i of element number `e` along a step.
    pub(super) fn forces(model: &Model<'_>, e: usize, step: &Step) -> Vec<PowerSeries> {
        let element = &model.elements[e];
        let factor = element.factor.series(step.clock());
        let forces = element.law.series(Along::of(model, e, step).place());
        forces.iter().map(|force| product(&factor, force)).collect()
    }

    pub(super) fn is_constant(&self) -> bool {
        self.0.iter().flatten().all(Coefficient::is_constant)
    }
}

/// The positions and velocities of an element along a step.
struct Along {
    positions: Vec<PowerSeries>,
    velocities: Vec<PowerSeries>,
    piece: usize,
}

impl Along {
    fn of(model: &Model<'_>, e: usize, step: &Step) -> Self {
        let element = &model.elements[e];
        let stop = e.checked_sub(model.first_stop());
        let piece = stop.map(|stop| step.stops()[stop]);
        // The law of a first-order state, by its value.
        if let [(j, 1.0)] = element.directions[0][..]
            && j >= model.len()
        {
            let value = step.series().get(model.position_row(j) - model.len());
            let positions = vec![value.copied().unwrap_or(PowerSeries::ZERO)];
            let velocities = vec![PowerSeries::ZERO];
            return Self::on_piece((element, piece), positions, velocities, step);
        }
        let start = element.along(&|j| step.state().displacements[j]);
        let velocities = element.directions.iter().map(|direction| {
            let mut velocity = PowerSeries::ZERO;
            for &(j, a) in direction {
                if let Some(series) = step.series().get(j) {
                    velocity.add(a, series);
                }
            }
            velocity
        });
        let velocities: Vec<PowerSeries> = velocities.collect();
        let positions = std::iter::zip(start, &velocities).map(|(start, velocity)| {
            PowerSeries::from_fn(|k| match k {
                0 => start,
                _ => velocity[k - 1] * INTEGRAL[k - 1],
            })
        });
        let positions: Vec<PowerSeries> = positions.collect();
        Self::on_piece((element, piece), positions, velocities, step)
    }

    /// The derivatives of the piece of the law that holds in the step; the piece of a stop is
    /// given.
    fn on_piece(
        (element, piece): (&ElementData<'_>, Option<usize>),
        positions: Vec<PowerSeries>,
        velocities: Vec<PowerSeries>,
        step: &Step,
    ) -> Self {
        let above = || element.piece_above(positions[0].at(0.5 * step.duration()));
        let piece = piece.unwrap_or_else(above);
        Self {
            positions,
            velocities,
            piece,
        }
    }

    fn place(&self) -> Place<'_, PowerSeries> {
        Place {
            positions: &self.positions,
            velocities: &self.velocities,
            piece: self.piece,
        }
    }
}
