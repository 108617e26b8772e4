//! Initial values of slip phases.

use super::model::Belt;
use crate::friction::slip_series::SlipPoint;
use crate::state::{Direction, State};

/// The mode of the mass at the start of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Start {
    /// The mass moves with the belt, possibly for a time 0 only.
    Stick,
    Slip(SlipPoint),
}

impl Start {
    /// The mode of the mass at the start of the motion from this state.
    pub(crate) fn of(system: &Belt<'_>, state: State) -> Self {
        let State {
            displacement,
            velocity,
        } = state;
        let relative_velocity = system.relative_velocity(velocity);
        if let Some(direction) = Direction::of(relative_velocity) {
            return Self::Slip(SlipPoint {
                direction,
                displacement,
                speed: relative_velocity.abs(),
                rate: None,
            });
        }
        match system.slides_at(displacement) {
            // At the release point the mass is in stick, with no time left there.
            Some(direction) if !system.is_release(displacement) => {
                Self::Slip(SlipPoint::leaving(system, displacement, direction))
            }
            _ => Self::Stick,
        }
    }
}

impl SlipPoint {
    /// The point on the belt where slip in a direction begins.
    ///
    /// The rate follows from the force beyond the stick band, so that it is exactly 0 at the
    /// release point of a law with μ̂(0) = μ_s.
    pub(crate) fn leaving(system: &Belt<'_>, displacement: f64, direction: Direction) -> Self {
        let exact = match system.release_state() {
            Some(release) if system.is_release(displacement) => release.displacement,
            _ => displacement,
        };
        Self {
            rate: Some(system.slip_rate(exact, direction)),
            ..Self::arriving(displacement, direction)
        }
    }

    /// The point on the belt at which slip in a direction ends, from which the motion is followed
    /// backwards in time. The equation of motion gives the rate.
    pub(crate) fn arriving(displacement: f64, direction: Direction) -> Self {
        Self {
            direction,
            displacement,
            speed: 0.0,
            rate: None,
        }
    }

    /// The state (u, v) at this point.
    #[inline]
    pub(crate) fn state(&self, system: &Belt<'_>) -> State {
        let velocity = system.belt_velocity() + self.direction.sign() * self.speed;
        State::new(self.displacement, velocity)
    }

    /// The point with v < v_b, v_b > 0, at which the velocity has a maximum: v = `peak`, v' = 0.
    pub(crate) fn at_maximum(system: &Belt<'_>, peak: f64) -> Self {
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
