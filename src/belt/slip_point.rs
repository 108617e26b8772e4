//! Points of slip phases, and how each kind of slip begins.

use super::system::MassOnBelt;
use crate::friction::FrictionLaw;
use crate::state::{Direction, State};

/// A point of a slip phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SlipPoint {
    /// The direction of slip σ, the sign of v_r.
    pub(crate) direction: Direction,
    /// Displacement u.
    pub(crate) displacement: f64,
    /// Sliding speed s = |v_r|.
    pub(crate) speed: f64,
    /// The rate ds/dt in the direction of time that is followed, if it is known better than from
    /// the equation of motion: on the belt, and at an extremum of v.
    pub(crate) rate: Option<f64>,
}

/// What the mass does at the start of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Start {
    /// The mass moves with the belt, if only for a time 0.
    Stick,
    Slip(SlipPoint),
}

impl Start {
    /// What the mass does at the start of the motion from this state.
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

    /// The point on the belt where slip in a direction ends, to be followed backwards in time. The
    /// equation of motion gives the rate.
    pub(crate) fn arriving(displacement: f64, direction: Direction) -> Self {
        Self {
            direction,
            displacement,
            speed: 0.0,
            rate: None,
        }
    }

    /// The state (u, v) at this point.
    pub(crate) fn state<L>(&self, system: &MassOnBelt<L>) -> State {
        let velocity = system.belt_velocity() + self.direction.sign() * self.speed;
        State::new(self.displacement, velocity)
    }

    /// The point behind a belt of velocity v_b > 0 where the velocity has a maximum: v = `peak`,
    /// v' = 0.
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
