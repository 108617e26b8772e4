//! The start of motions: what does not change during Newton's method.

use nalgebra::DVector;

use super::super::hold::{Hold, Then};
use super::super::translation::Turning;
use super::change::{Change, Mark};
use crate::motion::Mode;

/// The start of motions: the data that do not change during Newton's method.
#[derive(Debug, Clone)]
pub(super) struct FrozenStart {
    /// The start of a forced motion, as a part of its period.
    pub(super) phase: f64,
    /// The modes of the contacts at the start.
    pub(super) modes: Vec<Mode>,
    /// The phase condition of an autonomous motion.
    pub(super) section: Option<Section>,
    /// The sizes of the start, and the period.
    pub(super) sizes: DVector<f64>,
    /// Contacts held past touches, and events that are watched.
    pub(super) holds: Vec<Hold>,
    pub(super) marks: Vec<Mark>,
}

/// The phase condition of an autonomous motion: a plane.
#[derive(Debug, Clone)]
pub(super) struct Section {
    /// The coordinate that turns at the start, v_i = 0: the condition holds however small the
    /// motion becomes. Otherwise the plane lies across the flow.
    pub(super) turning: Option<Turning>,
    pub(super) point: DVector<f64>,
    /// The normal, in units in which it is of size 1.
    pub(super) normal: DVector<f64>,
}

impl FrozenStart {
    /// The start at time 0, with no contact known to stick.
    pub(super) fn at_zero() -> Self {
        Self {
            phase: 0.0,
            modes: Vec::new(),
            section: None,
            sizes: DVector::zeros(0),
            holds: Vec::new(),
            marks: Vec::new(),
        }
    }

    /// Holds and watches another change of events.
    pub(super) fn add(&mut self, change: &Change) {
        let first = self.holds.len();
        let holds = change.holds.iter().map(|hold| Hold {
            number: first + hold.number,
            ..*hold
        });
        self.holds.extend(holds);
        self.marks.extend(&change.marks);
    }

    /// Lets contacts slip on past their touches without a rest.
    pub(super) fn slip_on(&mut self) {
        let holds = self.holds.iter_mut();
        let rest = holds.filter(|hold| hold.then == Then::SlipsAfterRest);
        rest.for_each(|hold| hold.then = Then::Slips);
    }
}

impl Section {
    /// The residual of the phase condition, in units in which the normal is of size 1.
    pub(super) fn at(&self, start: &DVector<f64>) -> f64 {
        self.normal.dot(&(start - &self.point))
    }
}
