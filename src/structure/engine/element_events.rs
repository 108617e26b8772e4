//! Passages from one piece of the law of an element to another: they end a step. Those of force
//! elements, at the breakpoints of their laws, are no events; those of stops are, if the stop opens
//! or closes.
//!
//! | border of a stop | watched |
//! |---|---|
//! | 0 | δ |
//! | 1 | kδ + cδ', of a stop that never pulls |

use super::cholesky::ROUNDING;
use super::element_data::{ElementData, sum_of_sizes};
use super::element_series::ElementSeries;
use crate::force::stop::{CLOSED, OPEN, StopLaw, UNLOADED};
use crate::series::{EventDistance, PowerSeries, TooCurved};

/// The border of a stop at which its force becomes 0 although δ > 0, or acts again.
const PRESSURE: usize = 1;

/// An element at the start of a step.
#[derive(Debug, Clone)]
pub(super) struct ElementState {
    /// The piece of the law that holds.
    pub(super) piece: usize,
    /// The border, of this number, on which the element is: a breakpoint of its law.
    pub(super) on: Option<usize>,
    /// True while it is not decided to which side it leaves this border.
    pub(super) is_open: bool,
}

impl ElementState {
    /// The state at positions and velocities of the coordinates: on a breakpoint if the position is
    /// exactly there, and on a border of a stop if it is there to rounding.
    pub(super) fn at(
        element: &ElementData<'_>,
        time: f64,
        q: impl Fn(usize) -> f64,
        v: impl Fn(usize) -> f64,
    ) -> Self {
        let (positions, velocities) = (element.along(&q), element.along(&v));
        let on = match &element.stop {
            None => element.breakpoints.iter().position(|b| *b == positions[0]),
            Some(stop) => {
                let direction = &element.directions[0];
                let sizes = [sum_of_sizes(direction, &q), sum_of_sizes(direction, &v)];
                border_at(stop, time, [positions[0], velocities[0]], sizes)
            }
        };
        let piece = match on {
            // The piece to which the velocity leads, so that no force jumps if it is revised.
            Some(0) if element.stop.is_some() => element.piece_beyond(0, velocities[0] > 0.0),
            _ => element.piece(&positions, &velocities),
        };
        Self {
            piece,
            on,
            is_open: on.is_some(),
        }
    }

    /// Moves the element to the end of a step. Returns true if its force jumps there.
    pub(super) fn land(&mut self, element: &ElementData<'_>, passage: Option<Passage>) -> bool {
        self.on = passage.map(|passage| passage.border);
        self.is_open = passage.is_some();
        let before = self.piece;
        if let Some(passage) = passage {
            self.piece = element.piece_beyond(passage.border, passage.rises);
        }
        let is_damped = element.stop.is_some_and(|stop| stop.damping != 0.0);
        let jumps = self.on.is_some_and(|border| border != PRESSURE);
        is_damped && jumps && (before == CLOSED) != (self.piece == CLOSED)
    }

    /// The series of the distance from a border, with the zero that is known: x − b of a
    /// breakpoint.
    pub(super) fn distance(
        &self,
        element: &ElementData<'_>,
        series: &ElementSeries,
        border: usize,
    ) -> PowerSeries {
        let positions = &series.positions[0];
        let mut distance = match &element.stop {
            Some(stop) if border == PRESSURE => {
                let velocities = &series.velocities[0];
                PowerSeries::from_fn(|k| {
                    let position = if k == 0 {
                        positions[0] - stop.gap
                    } else {
                        positions[k]
                    };
                    position * stop.stiffness + velocities[k] * stop.damping
                })
            }
            _ => positions.minus(element.breakpoints[border]),
        };
        if self.on == Some(border) {
            distance[0] = 0.0;
        }
        distance
    }

    /// The borders of the piece that holds, each with true if the distance from it rises to 0.
    fn borders(&self, element: &ElementData<'_>) -> [Option<(usize, bool)>; 2] {
        if element.stop.is_some_and(|stop| stop.may_unload()) {
            return match self.piece {
                OPEN => [None, Some((0, true))],
                UNLOADED => [Some((0, false)), Some((PRESSURE, true))],
                _ => [Some((PRESSURE, false)), None],
            };
        }
        let below = self.piece.checked_sub(1);
        let above = Some(self.piece).filter(|&border| border < element.breakpoints.len());
        [
            below.map(|border| (border, false)),
            above.map(|border| (border, true)),
        ]
    }
}

/// The border of a stop on which a position and a velocity are, to the rounding of sums with terms
/// of these sizes. The time is known to its rounding error, too, in which the position changes.
fn border_at(stop: &StopLaw, time: f64, [x, y]: [f64; 2], [size, fast]: [f64; 2]) -> Option<usize> {
    let depth = x - stop.gap;
    let rounding = ROUNDING * (size + stop.gap.abs()) + f64::EPSILON * (y * time).abs();
    if depth.abs() <= rounding {
        return Some(0);
    }
    let pressure = stop.stiffness * depth + stop.damping * y;
    let rounding = stop.stiffness * rounding + ROUNDING * stop.damping * fast;
    (stop.may_unload() && depth > 0.0 && pressure.abs() <= rounding).then_some(PRESSURE)
}

impl ElementData<'_> {
    /// The piece of the law beyond a border, above it or below.
    pub(super) fn piece_beyond(&self, border: usize, rises: bool) -> usize {
        match &self.stop {
            Some(stop) if border == PRESSURE => stop.beyond(rises),
            _ => border + usize::from(rises),
        }
    }
}

/// The passage of a border.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Passage {
    pub(super) time: f64,
    border: usize,
    rises: bool,
}

/// The first passage in (0, h] of a border of an element.
pub(super) fn first_passage(
    element: &ElementData<'_>,
    state: &ElementState,
    series: &ElementSeries,
    h: f64,
) -> Result<Option<Passage>, TooCurved> {
    let mut first: Option<Passage> = None;
    for (border, rises) in state.borders(element).into_iter().flatten() {
        let distance = state.distance(element, series, border);
        let distance = if rises {
            distance.scaled(-1.0)
        } else {
            distance
        };
        let h = first.map_or(h, |first| first.time);
        let found = match EventDistance::new(&distance) {
            Some(positive) => positive.first_zero(h)?,
            None => None,
        };
        if let Some(time) = found {
            first = Some(Passage {
                time,
                border,
                rises,
            });
        }
    }
    Ok(first)
}
