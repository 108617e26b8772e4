//! The active piece of the law, and the end of a step on it: a breakpoint or contact.

use super::model::Belt;
use crate::clock::Time;
use crate::friction::Values;
use crate::friction::slip_series::SlipPoint;
use crate::series::{PowerSeries, TooCurved, quarters};

/// The speeds at which the pieces of a law meet, ascending.
#[derive(Debug, Clone)]
pub(super) struct Breakpoints(Vec<f64>);

impl Breakpoints {
    pub(super) fn new(law: &dyn Values) -> Self {
        Self(law.breakpoints().collect())
    }

    /// The active piece of the law for a motion from this point, and the rate ds/dt that decided on
    /// the piece, if one had to.
    #[inline(always)]
    pub(super) fn piece(
        &self,
        system: &Belt<'_>,
        point: &SlipPoint,
        time: Time,
    ) -> (usize, Option<f64>) {
        if self.0.is_empty() {
            (0, None)
        } else {
            self.among_pieces(system, point, time)
        }
    }

    /// [`piece`](Self::piece) for a law of several pieces.
    ///
    /// At a breakpoint the sign of the rate ds/dt decides between the two pieces. The series then
    /// starts with this rate.
    #[inline(never)]
    fn among_pieces(
        &self,
        system: &Belt<'_>,
        point: &SlipPoint,
        time: Time,
    ) -> (usize, Option<f64>) {
        let above = self.piece_above(point.speed);
        if above == 0 || self.0[above - 1] != point.speed {
            return (above, None);
        }
        let sigma = point.direction.sign();
        let state = point.state(system);
        let equation = || {
            let (friction, spring) = (system.friction_force(state), state.displacement);
            let damper = 2.0 * system.damping() * state.velocity;
            let largest = friction.abs() + spring.abs() + damper.abs();
            let rate = time.sign() * sigma * (friction - damper - spring);
            if rate.abs() <= ROUNDING * f64::EPSILON * largest {
                0.0
            } else {
                rate
            }
        };
        let rate = point.rate.unwrap_or_else(equation);
        // Where s' = σv' is zero, s'' = −σv decides.
        let rising = rate > 0.0 || (rate == 0.0 && sigma * state.velocity < 0.0);
        (if rising { above } else { above - 1 }, Some(rate))
    }

    /// The piece that holds speeds just above this one.
    pub(super) fn piece_above(&self, speed: f64) -> usize {
        self.0.partition_point(|&b| b <= speed)
    }

    /// The sliding speeds at which a step on this piece must end.
    pub(super) fn limits(&self, piece: usize) -> Limits {
        Limits {
            low: if piece == 0 { 0.0 } else { self.0[piece - 1] },
            high: self.0.get(piece).copied(),
        }
    }
}

/// Size of a rate that rounding alone may cause, in units of ε times the largest force.
const ROUNDING: f64 = 16.0;

/// The time at which a step leaves its piece of the law, and the sliding speed there; `None` if it
/// stays on the piece.
pub(super) type Exit = Option<(f64, f64)>;

/// The sliding speeds between which one piece of the law holds.
pub(super) struct Limits {
    low: f64,
    high: Option<f64>,
}

impl Limits {
    /// Returns true if a speed lies on the piece, but not at an end of it.
    pub(super) fn contain(&self, speed: f64) -> bool {
        self.low < speed && self.high.is_none_or(|high| speed < high)
    }

    /// Returns true if this end of the piece is the lower one.
    pub(super) fn is_low(&self, limit: f64) -> bool {
        limit == self.low
    }

    /// The first time in (0, h] at which s(t) reaches a limit, and that limit. `speeds` are the
    /// values of s at the quarters of h.
    #[inline(always)]
    pub(super) fn first_exit(
        &self,
        speed: &PowerSeries,
        h: f64,
        speeds: [f64; 4],
    ) -> Result<Exit, TooCurved> {
        if self.high.is_none() && self.low == 0.0 && speed[0] > 0.0 {
            // The usual case, kept short.
            return Ok(speed.first_root(h, speeds)?.map(|time| (time, 0.0)));
        }
        self.first_exit_from_piece(speed, h, speeds)
    }

    #[inline(never)]
    fn first_exit_from_piece(
        &self,
        speed: &PowerSeries,
        h: f64,
        speeds: [f64; 4],
    ) -> Result<Exit, TooCurved> {
        let low = first_passage(speed, self.low, 1.0, h, speeds)?.map(|time| (time, self.low));
        let Some(limit) = self.high else {
            return Ok(low);
        };
        let high = first_passage(speed, limit, -1.0, h, speeds)?.map(|time| (time, limit));
        Ok(match (low, high) {
            (Some(low), Some(high)) if high.0 < low.0 => Some(high),
            (low, high) => low.or(high),
        })
    }
}

/// The first root in (0, h] of sign·(s(t) − level), which is positive just after t = 0.
///
/// If the motion starts on the level, the root at t = 0 is known (it is double if the rate is zero)
/// and is divided out, so that no short time has to be skipped.
fn first_passage(
    speed: &PowerSeries,
    level: f64,
    sign: f64,
    h: f64,
    speeds: [f64; 4],
) -> Result<Option<f64>, TooCurved> {
    let mut distance = speed.scaled(sign);
    distance[0] -= sign * level;
    let mut distances = speeds.map(|s| sign * (s - level));
    if speed[0] == level {
        distance = distance.without_root(if speed[1] == 0.0 { 2 } else { 1 });
        distances = distance.at_some(quarters(h));
    }
    distance.first_root(h, distances)
}
