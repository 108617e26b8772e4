//! Contacts on the edge of their stick band, or at load 0: the coefficients that are known to be 0
//! there, and the side to which the contact leaves the edge.

use super::contact_series::ContactSeries;
use crate::series::{PowerSeries, TERMS};
use crate::state::Direction;

/// Rounding error of the force in a contact, in units of ε times the sum of its terms, within which
/// it is on the edge at a start or on arrival.
pub(super) const EDGE_ROUNDING: f64 = 4.0;

/// Height above its bound, in units of ε times that bound, up to which the force has only touched
/// it; and height above or below 0, in units of ε times the sum of the sizes of its terms, up to
/// which a normal load has only touched 0.
const TOUCH_ROUNDING: f64 = 8.0;

/// Position of a contact relative to the bound of its stick band, or of its load.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) enum Edge {
    /// The contact is not on the bound, as far as is known.
    #[default]
    Away,
    /// The contact is on the bound, and this number of the first coefficients of its distance are
    /// 0: one if it reaches the bound, two if it only touches it.
    On(Option<Direction>, usize),
    /// The contact stays on the bound: all coefficients of its distance are 0.
    Along(Direction),
}

impl Edge {
    /// A contact that has just reached the bound.
    pub(super) fn reached(side: Option<Direction>) -> Self {
        Self::On(side, 1)
    }

    /// Number of coefficients of the distance from the bound that are 0.
    pub(super) fn known(self) -> usize {
        match self {
            Self::Away => 0,
            Self::On(_, known) => known,
            Self::Along(_) => TERMS,
        }
    }

    /// Returns true if the contact is at the bound on this side.
    fn is_at(self, side: Direction) -> bool {
        match self {
            Self::On(at, _) => at.is_none_or(|at| at == side),
            Self::Along(at) => at == side,
            Self::Away => false,
        }
    }

    /// N μ_s ∓ ℓ, with the zeros that are known; its first coefficient is infinite if N μ_s is.
    pub(super) fn distance(self, series: &ContactSeries, side: Direction) -> PowerSeries {
        let (bound, carried) = (series.bound(side), &series.carried);
        let distance = PowerSeries::from_fn(|k| bound[k] - side.sign() * carried[k]);
        self.with_zeros(distance, side)
    }

    /// A distance with the zeros that are known.
    pub(super) fn with_zeros(self, mut distance: PowerSeries, side: Direction) -> PowerSeries {
        if self.is_at(side) {
            for k in 0..self.known() {
                distance[k] = 0.0;
            }
        }
        distance
    }

    /// The direction in which a force leaves its bound on a side, and its position afterwards. Only
    /// the distance itself is known to be 0: zeros found while other contacts had other modes no
    /// longer count.
    pub(super) fn leaving(series: &ContactSeries, side: Direction) -> (Self, f64) {
        let distance = Self::reached(Some(side)).distance(series, side);
        leaving(&distance, series.bound(side)[0], Some(side))
    }
}

impl ContactSeries {
    /// Returns true if a force that stays on an edge of its band is still there a time t after the
    /// start of the step, within rounding.
    pub(super) fn stays_along(&self, edge: Edge, t: f64) -> bool {
        let Edge::Along(side) = edge else {
            return false;
        };
        let rounding = PowerSeries::from_fn(|k| self.rounding(side, k)).at(t);
        Edge::Away.distance(self, side).at(t).abs() <= rounding
    }
}

/// The direction of slip with a sign; leading for 0.
pub(super) fn side_of(sign: f64) -> Direction {
    if sign < 0.0 {
        Direction::Lagging
    } else {
        Direction::Leading
    }
}

/// The sign with which a distance leaves 0: +1 if it grows, −1 if it becomes negative, 0 if it
/// remains 0. Also returns the position afterwards.
pub(super) fn leaving(distance: &PowerSeries, bound: f64, side: Option<Direction>) -> (Edge, f64) {
    match deciding(distance, bound) {
        Some((order, c)) => (Edge::On(side, order), c.signum()),
        None => (Edge::reached(side), 0.0),
    }
}

/// Order and value of the coefficient that decides the sign with which a distance leaves 0: the
/// first one after c_0 that is not 0.
///
/// If it is so small that the distance turns back within rounding of 0, on either side, the next
/// one decides: the bound was only touched. Rounding is measured by the size of the terms, so that
/// units of force and time do not matter.
pub(super) fn deciding(distance: &PowerSeries, bound: f64) -> Option<(usize, f64)> {
    let c = distance.coefficients();
    let order = (1..c.len()).find(|&k| c[k] != 0.0)?;
    let (first, second) = (c[order], c.get(order + 1).copied().unwrap_or(0.0));
    // The distance turns back where k c_k t^(k−1) + (k + 1) c_{k+1} t^k is 0.
    let k = order as f64;
    let turn = k * first.abs() / ((k + 1.0) * second.abs());
    let height = first.abs() * turn.powi(order as i32) / (k + 1.0);
    let is_opposed = second != 0.0 && first.signum() != second.signum();
    if is_opposed && height <= TOUCH_ROUNDING * f64::EPSILON * bound.abs() {
        return Some((order + 1, second));
    }
    Some((order, first))
}

/// The order and the value of the first coefficient that decides, for a contact that shares
/// coordinates, on an edge of its band: coefficients that are rounding count as 0. `None` if all
/// are rounding.
pub(super) fn deciding_distance(of: &ContactSeries, side: Direction) -> Option<(usize, f64)> {
    let distance = Edge::reached(Some(side)).distance(of, side);
    let distance = PowerSeries::from_fn(|k| {
        let is_rounding = distance[k].abs() <= of.rounding(side, k);
        if is_rounding { 0.0 } else { distance[k] }
    });
    deciding(&distance, of.bound(side)[0])
}
