//! The power series at one force element in a step.

use super::coordinate_series::CoordinateSeries;
use super::element_data::{ElementData, sum};
use crate::force::object::{Along, Place};
use crate::scalar::jet::Tape;
use crate::series::many::Block;
use crate::series::{INTEGRAL, PowerSeries};

/// The series at one element.
#[derive(Debug, Clone)]
pub(super) struct ElementSeries {
    /// x_i and y_i.
    pub(super) positions: Vec<PowerSeries>,
    pub(super) velocities: Vec<PowerSeries>,
    /// F_i.
    pub(super) forces: Vec<PowerSeries>,
    /// D.
    pub(super) factor: PowerSeries,
    /// The piece of the law that holds.
    pub(super) piece: usize,
    /// ∂F_i/∂x_j at the start, a list for each j.
    pub(super) tangents: Vec<Vec<f64>>,
    /// The sums of the defects of each F_i at the quarters of a step, about extrema and between.
    pub(super) defects: Vec<[f64; 3]>,
    /// False for a stop without a force.
    pub(super) acts: bool,
    factor_varies: bool,
    tape: Tape,
}

impl ElementSeries {
    pub(super) fn new(element: &ElementData<'_>, time: f64) -> Self {
        let m = element.directions.len();
        let zeros = vec![PowerSeries::ZERO; m];
        Self {
            positions: zeros.clone(),
            velocities: zeros.clone(),
            forces: zeros,
            factor: PowerSeries::of(element.factor.value(time)),
            piece: 0,
            tangents: vec![vec![0.0; m]; m],
            defects: vec![[0.0; 3]; m],
            acts: true,
            factor_varies: false,
            tape: Tape::new(),
        }
    }

    /// The series that the law depends on, and its piece.
    pub(super) fn place(&self) -> Place<'_, PowerSeries> {
        Place {
            positions: &self.positions,
            velocities: &self.velocities,
            piece: self.piece,
        }
    }

    /// Returns true if no position changes: the force is constant but for its factor.
    pub(super) fn rests(&self) -> bool {
        let is_zero = |velocity: &PowerSeries| velocity.first_nonzero().is_none();
        self.velocities.iter().all(is_zero)
    }

    /// Notes the tangents at the start.
    pub(super) fn note_tangents(&mut self, element: &ElementData<'_>) {
        if !self.acts {
            self.tangents.iter_mut().for_each(|of| of.fill(0.0));
            return;
        }
        let place = Place {
            positions: &self.positions,
            velocities: &self.velocities,
            piece: self.piece,
        };
        for (by, tangents) in self.tangents.iter_mut().enumerate() {
            element.law.start_slopes(place, by, tangents);
        }
    }

    /// The size of the terms of D F_i at the start: F_i and its change over the whole of each
    /// position, whose rounding errors it magnifies.
    pub(super) fn size(&self, element: &ElementData<'_>, i: usize) -> f64 {
        let changes = std::iter::zip(&self.tangents, &self.positions);
        let changes = changes.map(|(tangents, x)| (tangents[i] * x[0]).abs());
        (self.forces[i][0].abs() + changes.sum::<f64>()) * element.factor.size()
    }

    /// Order k of the positions and velocities.
    pub(super) fn follow(
        &mut self,
        element: &ElementData<'_>,
        (coordinates, states): (&[CoordinateSeries], &[PowerSeries]),
        k: usize,
    ) {
        let motion = |j: usize| &coordinates[j].motion;
        let n = coordinates.len();
        for (i, direction) in element.directions.iter().enumerate() {
            self.positions[i][k] = sum(direction, |j| match j.checked_sub(n) {
                None => motion(j).displacement(k),
                Some(state) => states[state][k],
            });
            self.velocities[i][k] = sum(direction, |j| match j < n {
                true => motion(j).velocity(k),
                false => 0.0,
            });
        }
    }

    /// Order k of the force, and of the positions and velocities.
    pub(super) fn order(
        &mut self,
        element: &ElementData<'_>,
        motion: (&[CoordinateSeries], &[PowerSeries]),
        k: usize,
    ) {
        if k == 0 {
            self.factor_varies = !self.factor.is_constant();
        }
        self.follow(element, motion, k);
        self.force_order(element, k);
    }

    /// Order k > 0 of the force, and of the positions and velocities, if a single coordinate is
    /// accelerated: from this order of its velocity, and for each direction from its entry there
    /// and in the response. Returns the acceleration against the force.
    pub(super) fn order_along(
        &mut self,
        element: &ElementData<'_>,
        entries: &[[f64; 2]],
        velocity: f64,
        k: usize,
    ) -> f64 {
        let motion = std::iter::zip(&mut self.positions, &mut self.velocities);
        for ((position, own), [entry, _]) in motion.zip(entries) {
            position[k] = own[k - 1] * INTEGRAL[k - 1];
            own[k] = entry * velocity;
        }
        self.force_order(element, k);
        let responses = entries.iter().enumerate();
        responses.map(|(i, [_, x])| x * self.product(i, k)).sum()
    }

    /// Order k of the force, after that of the positions and velocities.
    fn force_order(&mut self, element: &ElementData<'_>, k: usize) {
        if !self.acts {
            self.forces[0][k] = 0.0;
            return;
        }
        let Self {
            positions,
            velocities,
            forces,
            piece,
            tape,
            ..
        } = self;
        let place = Place {
            positions,
            velocities,
            piece: *piece,
        };
        element.law.order(tape, k, place, forces);
    }

    /// Adds the defects in groups of four times to the sums of these kinds.
    pub(super) fn add_defects(
        &self,
        element: &ElementData<'_>,
        (times, kinds): (&Block, &[usize]),
        sums: &mut [[f64; 3]],
    ) {
        let along = Along {
            place: Place {
                positions: &self.positions,
                velocities: &self.velocities,
                piece: self.piece,
            },
            forces: &self.forces,
            factor: &self.factor,
        };
        element.law.add_defects(along, times, kinds, sums);
    }

    /// Coefficient k of D F_i.
    pub(super) fn product(&self, i: usize, k: usize) -> f64 {
        let force = &self.forces[i];
        if !self.factor_varies {
            return self.factor[0] * force[k];
        }
        (0..=k).map(|l| self.factor[l] * force[k - l]).sum()
    }
}
