//! The modes of all contacts at an instant.
//!
//! What a contact carries is a function of q, v and t alone, so contacts decide one by one. Only at
//! the very edge of its band does a contact need rates, which may depend on the modes of others: it
//! is then taken to stick, all is expanded, and the sign of the first derivative that is not 0
//! decides. That is repeated until nothing changes. A contact can only be released by it, so it
//! ends after as many rounds as there are contacts, and one.

use super::engine::{Engine, side_of};
use super::laws::Laws;
use super::parts::{Edge, Joint};
use crate::error::Error;
use crate::friction::memory::Slip;
use crate::motion::Mode;
use crate::series::PowerSeries;
use crate::state::Direction;

/// Rounding error of what a contact carries, in units of ε times the sum of its terms: so near is
/// on the edge, at a start or on arrival.
const EDGE_ROUNDING: f64 = 4.0;

/// Height above its bound, in units of ε times that bound, up to which a load carried has only
/// touched it; and that above or below 0, in units of ε times the sum of the sizes of its terms, up
/// to which a normal load has only touched 0.
const TOUCH_ROUNDING: f64 = 8.0;

impl Engine<'_> {
    /// Decides the modes, and expands the motion that follows.
    pub(super) fn decide(&mut self) -> Result<(), Error> {
        for c in 0..self.joints.len() {
            self.arrive(c);
        }
        // Each round but the last changes a contact: its load, its band, or its piece of the law.
        for _ in 0..=4 * self.joints.len() {
            self.expand().map_err(|fault| self.fault(fault))?;
            let mut changed = false;
            for c in 0..self.joints.len() {
                changed |= self.revise_load(c)? || self.revise_mode(c);
            }
            if !changed {
                break;
            }
        }
        Ok(())
    }

    /// A contact that has come to r = 0 is taken to stick, until what it carries says otherwise.
    fn arrive(&mut self, c: usize) {
        let (joint, laws) = (&mut self.joints[c], &self.model.laws);
        if !joint.fresh {
            return;
        }
        let body = &mut self.bodies[joint.body];
        if let Mode::Slip(_) = joint.mode {
            joint.arrived_from = joint.direction();
            joint.memory_on_arrival.clone_from(&joint.memory);
            laws.caught(c, &mut joint.memory);
        }
        joint.mode = Mode::Stick;
        joint.limit = laws.limit(c, &|j| joint.memory[j]);
        joint.carried_from = (self.clock, body.displacement);
        (body.speed, body.side, body.rate) = (0.0, 0.0, None);
    }

    /// A contact without friction so far meets its surface: slip if there is a relative velocity.
    pub(super) fn close(&mut self, c: usize) {
        let (joint, drive) = (&mut self.joints[c], &self.model.contacts[c].belt_velocity);
        let body = &mut self.bodies[joint.body];
        let velocity = body.velocity();
        body.surface = if drive.is_constant() {
            let mut surface = PowerSeries::ZERO;
            surface[0] = drive.value(0.0);
            surface
        } else {
            drive.series(self.clock)
        };
        let relative = velocity - body.surface[0];
        joint.fresh = relative == 0.0;
        joint.mode = Mode::Stick;
        joint.arrived_from = None;
        (body.speed, body.side) = (0.0, 0.0);
        if let Some(direction) = Direction::of(relative) {
            joint.mode = Mode::Slip(direction);
            joint.piece = joint.piece_above(relative.abs());
            (body.speed, body.side) = (relative.abs(), direction.sign());
        }
    }

    /// The contact loses its load: its mass is free.
    fn open(&mut self, c: usize) {
        let joint = &mut self.joints[c];
        let body = &mut self.bodies[joint.body];
        (body.speed, body.side, body.rate) = (body.velocity(), 1.0, None);
        body.surface = PowerSeries::ZERO;
        // Rest that ends here has ended; and nothing happens to a contact without load.
        if joint.mode == Mode::Stick {
            self.model.laws.caught(c, &mut joint.memory);
        }
        for (series, memory) in std::iter::zip(&mut joint.memories, &joint.memory) {
            *series = PowerSeries::ZERO;
            series[0] = *memory;
        }
        joint.mode = Mode::Open;
        joint.fresh = false;
    }

    /// Opens or closes a contact as its load says; whether that has changed anything.
    fn revise_load(&mut self, c: usize) -> Result<bool, Error> {
        if !self.joints[c].load_varies {
            return Ok(false);
        }
        let terms = self.load_terms(c);
        let rounding = EDGE_ROUNDING * f64::EPSILON * terms;
        let joint = &mut self.joints[c];
        let load = joint.load;
        let is_on_edge = joint.load_edge != Edge::Away || load[0].abs() <= rounding;
        let sign = if is_on_edge {
            let (edge, sign) = leaving(&load, terms, None);
            joint.load_edge = edge;
            // One that stays 0 gives no friction.
            if sign == 0.0 { -1.0 } else { sign }
        } else {
            load[0]
        };
        match (joint.mode, sign < 0.0) {
            (Mode::Open, false) => {
                self.close(c);
                self.arrive(c);
                Ok(true)
            }
            (Mode::Stick | Mode::Slip(_), true) => {
                if !self.model.contacts[c].load_gradient.is_empty() {
                    let reached = self.reached();
                    return Err(Error::Separation {
                        contact: c,
                        reached,
                    });
                }
                self.open(c);
                Ok(true)
            }
            _ => Ok(false),
        }
    }

    /// Releases a contact that cannot stick, and puts one that slides onto its piece of the law;
    /// whether that has changed anything.
    fn revise_mode(&mut self, c: usize) -> bool {
        let (joint, laws) = (&mut self.joints[c], &*self.model.laws);
        let body = &mut self.bodies[joint.body];
        match joint.mode {
            Mode::Open => false,
            Mode::Slip(_) => revise_piece(joint, &body.speeds),
            Mode::Stick if joint.limit.is_none() => {
                // Its own law says what it carries at r = 0: the same on both sides.
                let coefficient = joint.start_coefficient(laws, c, Direction::Leading);
                let rate = body.carried[0] - joint.load[0] * coefficient;
                let back = joint.arrived_from.map_or(1.0, |from| -from.sign());
                let direction = side_of(if rate == 0.0 { back } else { rate });
                if joint.arrived_from.is_some() {
                    joint.memory.clone_from(&joint.memory_on_arrival);
                }
                joint.mode = Mode::Slip(direction);
                (joint.piece, body.side) = (0, direction.sign());
                true
            }
            Mode::Stick => self.revise_stick(c),
        }
    }

    /// Releases a contact that carries more than it can; whether it does.
    fn revise_stick(&mut self, c: usize) -> bool {
        let i = self.joints[c].body;
        let force = self.model.forces[i].size() * self.model.inverse_mass[i];
        let terms = self.terms(i) + force;
        let load_terms = self.load_terms(c);
        let (joint, laws) = (&mut self.joints[c], &*self.model.laws);
        let body = &mut self.bodies[i];
        let (carried, bound) = (body.carried[0], joint.bound[0]);
        // Not of the load itself, which may have just come back from 0.
        let terms = terms + load_terms * joint.static_coefficient();
        let rounding = EDGE_ROUNDING * f64::EPSILON * terms;
        let is_known = joint.edge != Edge::Away;
        let side = match joint.edge {
            Edge::On(Some(side)) | Edge::Touched(Some(side)) => side,
            _ => side_of(carried),
        };
        let mut release = None;
        if joint.fresh && bound.max(carried.abs()) <= rounding {
            // No band yet, for the load begins: on both of its bounds.
            joint.edge = Edge::On(None);
            let rates =
                [side, side.opposite()].map(|side| (side, joint.leaving(&body.carried, side).1));
            let out = rates.into_iter().find(|(_, sign)| *sign < 0.0);
            release = out.map(|(side, _)| (side, 0.0));
        } else {
            let beyond = side.sign() * carried - bound;
            if beyond > rounding && !is_known {
                release = Some((side, beyond));
            } else if is_known || beyond >= 0.0 || (joint.fresh && beyond >= -rounding) {
                let (edge, sign) = joint.leaving(&body.carried, side);
                joint.edge = edge;
                release = (sign < 0.0).then_some((side, 0.0));
            }
        }
        let Some((side, beyond)) = release else {
            return false;
        };
        let coefficient = joint.start_coefficient(laws, c, side);
        let jump = bound - joint.load[0] * side.sign() * coefficient;
        joint.mode = Mode::Slip(side);
        match joint.arrived_from {
            Some(_) => joint.memory.clone_from(&joint.memory_on_arrival),
            None => laws.caught(c, &mut joint.memory),
        }
        (joint.piece, joint.fresh) = (0, false);
        (body.speed, body.side) = (0.0, side.sign());
        // μ̂(0) may exceed μ_s by an ulp.
        body.rate = Some(beyond + jump.max(0.0));
        true
    }

    /// Sum of the sizes of all terms of the load of a contact, divided by the mass.
    pub(super) fn load_terms(&self, c: usize) -> f64 {
        let (joint, contact) = (&self.joints[c], &self.model.contacts[c]);
        let gradient = contact.load_gradient.iter();
        let from_displacements: f64 = gradient
            .map(|&(j, n)| (n * self.bodies[j].displacement).abs())
            .sum();
        let sum = contact.load.size() + from_displacements;
        sum * self.model.inverse_mass[joint.body]
    }

    /// Sum of the sizes of all terms of what a contact carries, divided by the mass.
    pub(super) fn terms(&self, i: usize) -> f64 {
        let (spring, springs) = self.model.stiffness.row(i);
        let (damper, dampers) = self.model.damping.row(i);
        let body = &self.bodies[i];
        let mut sum = body.force[0].abs()
            + body.surface[1].abs()
            + (spring * body.displacement).abs()
            + (damper * body.velocity()).abs();
        for &(j, a) in springs {
            sum += (a * self.bodies[j].displacement).abs();
        }
        for &(j, a) in dampers {
            sum += (a * self.bodies[j].velocity()).abs();
        }
        sum
    }
}

impl Joint {
    /// N μ_s/m ∓ R/m, with the zeros that are known.
    pub(super) fn distance(&self, carried: &PowerSeries, side: Direction) -> PowerSeries {
        let mut distance = PowerSeries::from_fn(|k| self.bound[k] - side.sign() * carried[k]);
        let is_at = |edge: Edge| match edge {
            Edge::On(at) | Edge::Touched(at) => at.is_none_or(|at| at == side),
            Edge::Away => false,
        };
        if is_at(self.edge) {
            for k in 0..self.edge.known() {
                distance[k] = 0.0;
            }
        }
        distance
    }

    /// Which way the load carried goes at its bound on a side, and what is known of it then.
    fn leaving(&self, carried: &PowerSeries, side: Direction) -> (Edge, f64) {
        let mut distance = self.distance(carried, side);
        distance[0] = 0.0;
        leaving(&distance, self.bound[0], Some(side))
    }

    /// μ at the start of slip in a direction.
    fn start_coefficient(&self, laws: &dyn Laws, number: usize, side: Direction) -> f64 {
        let slip = Slip {
            speed: 0.0,
            direction: side.sign(),
            piece: 0,
        };
        laws.coefficient(number, slip, &|j| self.memory[j])
    }
}

/// At a breakpoint the motion decides on the piece: by its first derivative that is not 0.
fn revise_piece(joint: &mut Joint, speeds: &PowerSeries) -> bool {
    let above = joint.piece_above(speeds[0]);
    if above == 0 || joint.breakpoints[above - 1] != speeds[0] {
        let changed = joint.piece != above;
        joint.piece = above;
        return changed;
    }
    let mut rest = *speeds;
    rest[0] = 0.0;
    let piece = above - usize::from(rest.first_nonzero().is_some_and(|c| c < 0.0));
    let changed = joint.piece != piece && !joint.fresh;
    if changed {
        // Once: both pieces give the same rate.
        (joint.piece, joint.fresh) = (piece, true);
    }
    changed
}

/// Which way a distance goes that is 0: +1 where it grows, −1 where it becomes negative, 0 if it
/// stays; and what is known of it then.
///
/// A rate so small that the distance turns back within rounding of 0, on either side, is none: the
/// bound was only touched. Rounding is measured by the size of the terms, so that no unit of force
/// or of time changes what counts as a touch.
fn leaving(distance: &PowerSeries, bound: f64, side: Option<Direction>) -> (Edge, f64) {
    let (first, second) = (distance[1], distance[2]);
    let height = first * first / (4.0 * second.abs());
    let touched =
        first.signum() != second.signum() && height <= TOUCH_ROUNDING * f64::EPSILON * bound.abs();
    if touched {
        return (Edge::Touched(side), second.signum());
    }
    let mut rest = *distance;
    rest[0] = 0.0;
    (
        Edge::On(side),
        rest.first_nonzero().map_or(0.0, f64::signum),
    )
}
