//! What a user of a general integrator has to write around it for two blocks on a belt: the
//! equations of each pair of modes, what ends them, and the change of modes.

use stick_slip::{FrictionLaw, Structure};

use crate::phases::Clock;
use crate::set::Set;

/// Two blocks of mass 1 on one belt, joined to the ground and to each other.
#[derive(Clone, Copy)]
pub struct Blocks<L> {
    laws: [L; 2],
    loads: [f64; 2],
    stiffness: [[f64; 2]; 2],
    /// The dampers of each to the ground.
    damping: [f64; 2],
    belt_velocity: f64,
}

impl<L: FrictionLaw + Copy> Blocks<L> {
    /// Those of a structure, with the laws of its contacts.
    pub fn new(system: &Structure, laws: [L; 2]) -> Self {
        let of_contacts = [0, 1].map(|i| &system.contacts()[i]);
        Self {
            laws,
            loads: of_contacts.map(|contact| contact.load().value(0.0)),
            stiffness: [0, 1].map(|i| [0, 1].map(|j| system.stiffness()[(i, j)])),
            damping: [0, 1].map(|i| system.damping()[(i, i)]),
            belt_velocity: of_contacts[0].belt_velocity().value(0.0),
        }
    }

    /// Force of the springs on block i; linear.
    #[inline]
    fn springs(&self, i: usize, displacements: [f64; 2]) -> f64 {
        let [a, b] = self.stiffness[i];
        -(a * displacements[0] + b * displacements[1])
    }
}

/// The displacements u, then the velocities relative to the belt w = v − v_b: their roots are the
/// contacts, without cancellation.
pub type Point = [f64; 4];

/// A stretch of the motion in which no block changes its mode.
#[derive(Clone, Copy)]
pub struct Phase<L> {
    blocks: Blocks<L>,
    /// The sign of each w; 0 in stick.
    signs: [f64; 2],
}

/// End of a phase: which block changes its mode, and when from the phase's start.
pub struct End {
    pub block: usize,
    pub time: f64,
    pub point: Point,
}

impl<L: FrictionLaw + Copy> Phase<L> {
    /// Both blocks behind the belt.
    pub fn behind(blocks: Blocks<L>) -> Self {
        Self {
            blocks,
            signs: [-1.0, -1.0],
        }
    }

    /// d(u, w)/dτ.
    #[inline]
    pub fn derivative(&self, y: &Point) -> Point {
        let [v1, v2] = self.velocities(y);
        [v1, v2, self.acceleration(0, y), self.acceleration(1, y)]
    }

    #[inline]
    fn velocities(&self, y: &Point) -> [f64; 2] {
        let belt_velocity = self.blocks.belt_velocity;
        [y[2] + belt_velocity, y[3] + belt_velocity]
    }

    #[inline]
    fn acceleration(&self, i: usize, y: &Point) -> f64 {
        let sign = self.signs[i];
        if sign == 0.0 {
            return 0.0;
        }
        let Blocks { laws, loads, .. } = &self.blocks;
        self.force(i, y) - loads[i] * sign * laws[i].kinetic(sign * y[2 + i])
    }

    /// Force on block i, without friction.
    #[inline]
    fn force(&self, i: usize, y: &Point) -> f64 {
        let velocity = y[2 + i] + self.blocks.belt_velocity;
        self.blocks.springs(i, [y[0], y[1]]) - self.blocks.damping[i] * velocity
    }

    #[inline]
    fn static_limit(&self, i: usize) -> f64 {
        self.blocks.loads[i] * self.blocks.laws[i].static_coefficient()
    }

    /// What is positive until block i changes its mode: the sliding speed, or how far the force is
    /// from the limit of static friction.
    #[inline]
    pub fn margin(&self, i: usize, y: &Point) -> f64 {
        match self.signs[i] {
            0.0 => self.static_limit(i) - self.force(i, y).abs(),
            sign => sign * y[2 + i],
        }
    }

    /// The margin's derivative in time.
    #[inline]
    pub fn margin_rate(&self, i: usize, y: &Point) -> f64 {
        match self.signs[i] {
            0.0 => {
                let rate = self.blocks.springs(i, self.velocities(y));
                -self.force(i, y).signum() * rate
            }
            sign => sign * self.acceleration(i, y),
        }
    }

    /// The block whose margin is the first to fall to 0 between two points, by its chord; beside it
    /// which part of the way that is.
    pub fn first(&self, before: &Point, after: &Point) -> Option<(usize, f64)> {
        let part = |i: usize| {
            let [a, b] = [before, after].map(|y| self.margin(i, y));
            (b < 0.0).then(|| (i, a / (a - b)))
        };
        let earlier = |a: &(usize, f64), b: &(usize, f64)| a.1.total_cmp(&b.1);
        (0..2).filter_map(part).min_by(earlier)
    }

    /// The phase after the end of this one.
    fn next(mut self, block: usize, y: &Point) -> Self {
        let force = self.force(block, y);
        let sticks = self.signs[block] != 0.0 && force.abs() < self.static_limit(block);
        self.signs[block] = if sticks { 0.0 } else { force.signum() };
        self
    }
}

/// Runs the motion and writes down its events; `end` integrates one phase, its time from 0.
pub fn run<L: FrictionLaw + Copy>(
    set: &Set<Structure>,
    blocks: Blocks<L>,
    events: &mut Vec<f64>,
    mut end: impl FnMut(Phase<L>, Point) -> End,
) {
    let mut phase = Phase::behind(blocks);
    let (u, v) = (&set.start.displacements, &set.start.velocities);
    let belt_velocity = phase.blocks.belt_velocity;
    let mut point = [u[0], u[1], v[0] - belt_velocity, v[1] - belt_velocity];
    let mut clock = Clock::default();
    loop {
        let found = end(phase, point);
        if !clock.note(found.time, events) {
            break;
        }
        point = found.point;
        point[2 + found.block] = 0.0;
        phase = phase.next(found.block, &point);
    }
}
