//! The constant data of a force element.

use std::sync::Arc;

use super::contact::Entries;
use crate::drive::Drive;
use crate::force::object::{ForceObject, Place};

/// The constant data of a force element.
#[derive(Clone)]
pub(crate) struct ElementData<'s> {
    /// a_i.
    pub(crate) directions: &'s [Vec<(usize, f64)>],
    /// M⁻¹a_i.
    pub(crate) responses: Vec<Vec<(usize, f64)>>,
    pub(crate) law: &'s dyn ForceObject,
    /// D.
    pub(crate) factor: Arc<Drive>,
    /// Positions at which pieces of the law meet.
    pub(crate) breakpoints: Vec<f64>,
    /// The contact of whose load the force is a part; `None` if it acts on the structure.
    pub(crate) pressed: Option<usize>,
}

impl<'s> ElementData<'s> {
    pub(crate) fn new(
        directions: &'s [Vec<(usize, f64)>],
        law: &'s dyn ForceObject,
        factor: Arc<Drive>,
    ) -> Self {
        Self {
            directions,
            responses: Vec::new(),
            law,
            factor,
            breakpoints: law.breakpoints(),
            pressed: None,
        }
    }

    /// a_i·x of each direction.
    pub(crate) fn along(&self, x: impl Fn(usize) -> f64) -> Vec<f64> {
        let directions = self.directions.iter();
        directions.map(|direction| sum(direction, &x)).collect()
    }

    /// The piece of the law just above a position.
    pub(crate) fn piece_above(&self, position: f64) -> usize {
        self.breakpoints.partition_point(|b| *b <= position)
    }

    /// F_i at positions and velocities of the coordinates, without the factor.
    pub(crate) fn forces(&self, q: impl Fn(usize) -> f64, v: impl Fn(usize) -> f64) -> Vec<f64> {
        let (positions, velocities) = (self.along(q), self.along(v));
        self.law.forces(self.place(&positions, &velocities))
    }

    /// D F of a part of a load.
    pub(crate) fn pressure(
        &self,
        time: f64,
        q: impl Fn(usize) -> f64,
        v: impl Fn(usize) -> f64,
    ) -> f64 {
        self.factor.value(time) * self.forces(q, v)[0]
    }

    /// The rate of a part of a load by the velocity along it; NaN if the force depends on this
    /// velocity, for its own rate is not known then.
    pub(crate) fn rate_by_positions(
        &self,
        factor: f64,
        q: impl Fn(usize) -> f64,
        v: impl Fn(usize) -> f64,
    ) -> f64 {
        let (positions, velocities) = (self.along(q), self.along(v));
        let place = self.place(&positions, &velocities);
        let [by_position, by_velocity] = [0, 1].map(|by| self.law.slopes(place, by)[0]);
        if by_velocity == 0.0 {
            factor * by_position * velocities[0]
        } else {
            f64::NAN
        }
    }

    /// F_i, and their derivatives by x_j and then y_j, a list over i for each, without the factor.
    pub(crate) fn tangent(&self, q: &[f64], v: &[f64]) -> ElementTangent {
        let [positions, velocities] = [q, v].map(|x| self.along(|j| x[j]));
        let place = self.place(&positions, &velocities);
        let inputs = 0..2 * positions.len();
        ElementTangent {
            forces: self.law.forces(place),
            slopes: inputs.map(|by| self.law.slopes(place, by)).collect(),
            positions,
        }
    }

    /// U; 0 for a law without a potential.
    pub(crate) fn potential(&self, q: impl Fn(usize) -> f64) -> f64 {
        let positions = self.along(q);
        let zeros = vec![0.0; positions.len()];
        let place = self.place(&positions, &zeros);
        self.law.potential(place).unwrap_or(0.0)
    }

    /// ∂U/∂x_i; 0 for a law without a potential.
    pub(crate) fn potential_slopes(&self, q: impl Fn(usize) -> f64) -> Vec<f64> {
        let positions = self.along(q);
        let zeros = vec![0.0; positions.len()];
        let place = self.place(&positions, &zeros);
        let slope = |by: usize| self.law.potential_slope(place, by).unwrap_or(0.0);
        (0..positions.len()).map(slope).collect()
    }

    fn place<'p>(&self, positions: &'p [f64], velocities: &'p [f64]) -> Place<'p, f64> {
        Place {
            positions,
            velocities,
            piece: self.piece_above(positions[0]),
        }
    }
}

impl std::fmt::Debug for ElementData<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let data = (self.directions, &self.factor);
        data.fmt(f)
    }
}

/// The force of an element and its derivatives in one state.
#[derive(Debug, Clone)]
pub(crate) struct ElementTangent {
    /// x_i.
    pub(crate) positions: Vec<f64>,
    pub(crate) forces: Vec<f64>,
    pub(crate) slopes: Vec<Vec<f64>>,
}

pub(super) fn sum(direction: &Entries, x: impl Fn(usize) -> f64) -> f64 {
    direction.iter().map(|&(j, a)| a * x(j)).sum()
}
