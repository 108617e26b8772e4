//! The power series at one force element in a step.

use super::coordinate_series::CoordinateSeries;
use super::element::{ElementData, sum};
use crate::force::object::Place;
use crate::scalar::jet::Tape;
use crate::series::PowerSeries;

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
    tape: Tape,
}

impl ElementSeries {
    pub(super) fn new(element: &ElementData<'_>, time: f64) -> Self {
        let zeros = vec![PowerSeries::ZERO; element.directions.len()];
        Self {
            positions: zeros.clone(),
            velocities: zeros.clone(),
            forces: zeros,
            factor: PowerSeries::of(element.factor.value(time)),
            piece: 0,
            tangents: vec![Vec::new(); element.directions.len()],
            tape: Tape::new(),
        }
    }

    /// Returns true if no position changes: the force is constant but for its factor.
    pub(super) fn rests(&self) -> bool {
        let is_zero = |velocity: &PowerSeries| velocity.first_nonzero().is_none();
        self.velocities.iter().all(is_zero)
    }

    /// Notes the tangents at the start.
    pub(super) fn note_tangents(&mut self, element: &ElementData<'_>) {
        let [positions, velocities] = [&self.positions, &self.velocities].map(|series| {
            let start: Vec<f64> = series.iter().map(|series| series[0]).collect();
            start
        });
        let place = Place {
            positions: &positions,
            velocities: &velocities,
            piece: self.piece,
        };
        for (by, tangents) in self.tangents.iter_mut().enumerate() {
            *tangents = element.law.slopes(place, by);
        }
    }

    /// The sizes of the terms of each D F_i at the start: F_i and its change over the whole of each
    /// position, whose rounding errors it magnifies.
    pub(super) fn sizes(&self, element: &ElementData<'_>) -> Vec<f64> {
        let positions = &self.positions;
        let size = |(i, force): (usize, &PowerSeries)| {
            let changes = std::iter::zip(&self.tangents, positions);
            let changes = changes.map(|(tangents, x)| (tangents[i] * x[0]).abs());
            (force[0].abs() + changes.sum::<f64>()) * element.factor.size()
        };
        self.forces.iter().enumerate().map(size).collect()
    }

    /// Order k of the force.
    pub(super) fn order(
        &mut self,
        element: &ElementData<'_>,
        coordinates: &[CoordinateSeries],
        k: usize,
    ) {
        let motion = |j: usize| &coordinates[j].motion;
        for (i, direction) in element.directions.iter().enumerate() {
            self.positions[i][k] = sum(direction, |j| motion(j).displacement(k));
            self.velocities[i][k] = sum(direction, |j| motion(j).velocity(k));
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

    /// Adds the largest defect |D| |F_i(x(t), y(t)) − F_i(t)| at four times, for each direction.
    pub(super) fn add_defects(&self, element: &ElementData<'_>, times: [f64; 4], sums: &mut [f64]) {
        let values = |series: &[PowerSeries]| -> Vec<[f64; 4]> {
            series.iter().map(|series| series.at_some(times)).collect()
        };
        let [x, y] = [&self.positions, &self.velocities].map(|series| values(series));
        let (forces, factors) = (values(&self.forces), self.factor.at_some(times));
        let factor = factors.iter().fold(0.0, |most: f64, d| most.max(d.abs()));
        let mut largest = vec![0.0; sums.len()];
        for lane in 0..times.len() {
            let [positions, velocities] = [&x, &y]
                .map(|values| -> Vec<f64> { values.iter().map(|values| values[lane]).collect() });
            let exact = element.law.forces(Place {
                positions: &positions,
                velocities: &velocities,
                piece: self.piece,
            });
            for ((largest, exact), force) in std::iter::zip(&mut largest, exact).zip(&forces) {
                let defect = (exact - force[lane]).abs();
                // Numbers that are not finite are not dropped.
                *largest = if defect <= *largest { *largest } else { defect };
            }
        }
        for (sum, largest) in std::iter::zip(sums, largest) {
            *sum += factor * largest;
        }
    }

    /// Coefficient k of D F_i.
    pub(super) fn product(&self, i: usize, k: usize) -> f64 {
        let force = &self.forces[i];
        if self.factor.is_constant() {
            return self.factor[0] * force[k];
        }
        (0..=k).map(|l| self.factor[l] * force[k - l]).sum()
    }
}
