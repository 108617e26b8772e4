//! The constant data of a force element.

use std::borrow::Cow;
use std::sync::Arc;

use super::contact_data::Entries;
use crate::drive::Drive;
use crate::force::object::{ForceObject, Place};
use crate::force::stop::StopLaw;

/// The constant data of a force element, or of a law in the rate of a first-order state.
///
/// In directions and responses, a number beyond those of the n coordinates is that of a first-order
/// state, plus n: its value is a position, and its velocity counts as 0.
#[derive(Clone)]
pub(crate) struct ElementData<'s> {
    /// a_i.
    pub(crate) directions: Cow<'s, [Vec<(usize, f64)>]>,
    /// M⁻¹a_i; of a law in the rate of a state −1/T.
    pub(crate) responses: Vec<Vec<(usize, f64)>>,
    /// The first-order state whose rate has the law, and 1/T.
    pub(crate) rate_of: Option<(usize, f64)>,
    pub(crate) law: &'s dyn ForceObject,
    /// D.
    pub(crate) factor: Arc<Drive>,
    /// Positions at which pieces of the law meet.
    pub(crate) breakpoints: Vec<f64>,
    /// The law of a stop, whose pieces depend on the velocity, too.
    pub(crate) stop: Option<StopLaw>,
    /// The contact of whose load the force is a part; `None` if it acts on the structure.
    pub(crate) pressed: Option<usize>,
}

impl<'s> ElementData<'s> {
    pub(crate) fn new(
        directions: Cow<'s, [Vec<(usize, f64)>]>,
        law: &'s dyn ForceObject,
        factor: Arc<Drive>,
    ) -> Self {
        Self {
            directions,
            responses: Vec::new(),
            rate_of: None,
            law,
            factor,
            breakpoints: law.breakpoints(),
            stop: None,
            pressed: None,
        }
    }

    /// a_i·x of each direction.
    pub(crate) fn along(&self, x: &dyn Fn(usize) -> f64) -> Vec<f64> {
        let directions = self.directions.iter();
        directions.map(|direction| sum(direction, x)).collect()
    }

    /// The piece of the law just above a position.
    pub(crate) fn piece_above(&self, position: f64) -> usize {
        self.breakpoints.partition_point(|b| *b <= position)
    }

    /// The piece of the law at positions and velocities along its directions.
    pub(crate) fn piece(&self, positions: &[f64], velocities: &[f64]) -> usize {
        match &self.stop {
            None => self.piece_above(positions[0]),
            Some(stop) => stop.piece(positions[0], velocities[0]),
        }
    }

    /// F_i at positions and velocities of the coordinates, without the factor; on a piece of the
    /// law, if it is given.
    pub(crate) fn forces(
        &self,
        q: &dyn Fn(usize) -> f64,
        v: &dyn Fn(usize) -> f64,
        piece: Option<usize>,
    ) -> Vec<f64> {
        let (positions, velocities) = (self.along(q), self.along(v));
        let place = self.place(&positions, &velocities);
        self.law.forces(Place {
            piece: piece.unwrap_or(place.piece),
            ..place
        })
    }

    /// D F of a part of a load.
    pub(crate) fn pressure(
        &self,
        time: f64,
        q: &dyn Fn(usize) -> f64,
        v: &dyn Fn(usize) -> f64,
    ) -> f64 {
        self.factor.value(time) * self.forces(q, v, None)[0]
    }

    /// The rate of a part of a load by the velocity along it; NaN if the force depends on this
    /// velocity, for its own rate is not known then.
    pub(crate) fn rate_by_positions(
        &self,
        factor: f64,
        q: &dyn Fn(usize) -> f64,
        v: &dyn Fn(usize) -> f64,
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
        let [positions, velocities] = [q, v].map(|x| self.along(&|j| x[j]));
        let place = self.place(&positions, &velocities);
        let inputs = 0..2 * positions.len();
        ElementTangent {
            forces: self.law.forces(place),
            slopes: inputs.map(|by| self.law.slopes(place, by)).collect(),
            positions,
        }
    }

    /// U; 0 for a law without a potential.
    pub(crate) fn potential(&self, q: &dyn Fn(usize) -> f64) -> f64 {
        let positions = self.along(q);
        let zeros = vec![0.0; positions.len()];
        let place = self.place(&positions, &zeros);
        self.law.potential(place).unwrap_or(0.0)
    }

    /// ∂U/∂x_i; 0 for a law without a potential.
    pub(crate) fn potential_slopes(&self, q: &dyn Fn(usize) -> f64) -> Vec<f64> {
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
            piece: self.piece(positions, velocities),
        }
    }
}

impl std::fmt::Debug for ElementData<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let data = (&self.directions, &self.factor);
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

/// Σ |a_j x_j|.
pub(super) fn sum_of_sizes(direction: &Entries, x: &dyn Fn(usize) -> f64) -> f64 {
    direction.iter().map(|&(j, a)| (a * x(j)).abs()).sum()
}

pub(super) fn sum(direction: &Entries, x: impl Fn(usize) -> f64) -> f64 {
    direction.iter().map(|&(j, a)| a * x(j)).sum()
}
