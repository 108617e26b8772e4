//! Passages of the breakpoints of force elements: they end a step, but are no events.

use super::element::ElementData;
use super::element_series::ElementSeries;
use crate::series::{EventDistance, PowerSeries, TooCurved};

/// An element at the start of a step.
#[derive(Debug, Clone)]
pub(super) struct ElementState {
    /// The piece of the law that holds.
    pub(super) piece: usize,
    /// The breakpoint at which the position is.
    pub(super) on: Option<usize>,
    /// True while it is not decided to which side the position leaves this breakpoint.
    pub(super) is_open: bool,
}

impl ElementState {
    /// The state at a position: on a breakpoint if it is exactly there.
    pub(super) fn at(element: &ElementData<'_>, position: f64) -> Self {
        let on = element.breakpoints.iter().position(|b| *b == position);
        Self {
            piece: element.piece_above(position),
            on,
            is_open: on.is_some(),
        }
    }

    /// Moves the element to the end of a step.
    pub(super) fn land(&mut self, passage: Option<Passage>) {
        self.on = passage.map(|passage| passage.breakpoint);
        self.is_open = passage.is_some();
        if let Some(passage) = passage {
            self.piece = passage.breakpoint + usize::from(passage.rises);
        }
    }

    /// The series of x − b at a breakpoint, with the zero that is known.
    pub(super) fn distance(
        &self,
        positions: &PowerSeries,
        breakpoints: &[f64],
        number: usize,
    ) -> PowerSeries {
        let mut distance = positions.minus(breakpoints[number]);
        if self.on == Some(number) {
            distance[0] = 0.0;
        }
        distance
    }
}

/// The passage of a breakpoint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Passage {
    pub(super) time: f64,
    breakpoint: usize,
    rises: bool,
}

/// The first passage in (0, h] of a breakpoint of an element.
pub(super) fn first_passage(
    element: &ElementData<'_>,
    state: &ElementState,
    series: &ElementSeries,
    h: f64,
) -> Result<Option<Passage>, TooCurved> {
    let breakpoints = &element.breakpoints;
    let mut first: Option<Passage> = None;
    for rises in [false, true] {
        let Some(breakpoint) = (state.piece + usize::from(rises)).checked_sub(1) else {
            continue;
        };
        if breakpoint >= breakpoints.len() {
            continue;
        }
        let distance = state.distance(&series.positions[0], breakpoints, breakpoint);
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
                breakpoint,
                rises,
            });
        }
    }
    Ok(first)
}
