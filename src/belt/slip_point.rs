//! Points of slip phases: how each kind of slip begins.

use super::system::MassOnBelt;
use crate::friction::FrictionLaw;
use crate::state::{Direction, State};

/// A point of a slip phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SlipPoint {
    /// σ, the sign of v_r.
    pub(crate) direction: Direction,
    /// u.
    pub(crate) displacement: f64,
    /// s = |v_r|.
    pub(crate) speed: f64,
    /// ds/dt, in the direction of time that is followed, where it is known better than the equation
    /// of motion gives it: on the belt, and at an extremum of v.
    pub(crate) rate: Option<f64>,
}

/// What the mass does at the start of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Start {
    /// It moves with the belt, if only for a time 0.
    Stick,
    Slip(SlipPoint),
}

impl Start {
    /// Of the motion from a state.
    pub(crate) fn of<L: FrictionLaw>(system: &MassOnBelt<L>, state: State) -> Self {
        let State {
            displacement,
            velocity,
        } = state;
        let relative_velocity = velocity - system.belt_velocity();
        if let Some(direction) = Direction::of(relative_velocity) {
            return Self::Slip(SlipPoint {
                direction,
                displacement,
                speed: relative_velocity.abs(),
                rate: None,
            });
        }
        match system.slides_at(displacement) {
            // At the release point it is in stick, with no time left in it.
            Some(direction) if !system.is_release(displacement) => {
                Self::Slip(SlipPoint::leaving(system, displacement, direction))
            }
            _ => Self::Stick,
        }
    }
}

impl SlipPoint {
    /// On the belt, where slip in a direction begins: with the rate that the force beyond the stick
    /// band gives, exactly 0 at the release point of a law with μ̂(0) = μ_s.
    pub(crate) fn leaving<L: FrictionLaw>(
        system: &MassOnBelt<L>,
        displacement: f64,
        direction: Direction,
    ) -> Self {
        let exact = match system.release_state() {
            Some(release) if system.is_release(displacement) => release.displacement,
            _ => displacement,
        };
        Self {
            rate: Some(system.slip_rate(exact, direction)),
            ..Self::arriving(displacement, direction)
        }
    }

    /// On the belt, where slip in a direction ends, to be followed backwards: with the rate that
    /// the equation of motion gives.
    pub(crate) fn arriving(displacement: f64, direction: Direction) -> Self {
        Self {
            direction,
            displacement,
            speed: 0.0,
            rate: None,
        }
    }

    /// Its state.
    pub(crate) fn state<L>(&self, system: &MassOnBelt<L>) -> State {
        let velocity = system.belt_velocity() + self.direction.sign() * self.speed;
        State::new(self.displacement, velocity)
    }

    /// Behind a belt of velocity v_b > 0, where the velocity has a maximum V: v = V, v' = 0.
    pub(crate) fn at_maximum<L: FrictionLaw>(system: &MassOnBelt<L>, peak: f64) -> Self {
        let speed = system.belt_velocity() - peak;
        let friction = system.load() * system.law().kinetic(speed);
        Self {
            direction: Direction::Lagging,
            displacement: friction - 2.0 * system.damping() * peak,
            speed,
            rate: Some(0.0),
        }
    }
}
