//! A mass on its belt for the engines, with the law as a trait object.

use super::equilibrium::Equilibrium;
use crate::error::Error;
use crate::friction::slip_series::Equation;
use crate::friction::{Law, Values, finite_at};
use crate::state::{Direction, State, Surface, relative_velocity};

/// The parameters of a system. They are checked against the law's values alone: a program that only
/// makes a system compiles no motion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Parameters {
    pub(super) belt_velocity: f64,
    pub(super) damping: f64,
    pub(super) load: f64,
}

impl Parameters {
    pub(super) fn with_damping(mut self, damping: f64, law: &dyn Values) -> Result<Self, Error> {
        self.damping = damping;
        Error::check(
            "MassOnBelt",
            "damping",
            damping,
            damping >= 0.0 && self.has_finite_limits(law),
            "damping ≥ 0, and 2βv_b ± γ²μ_s finite",
        )?;
        Ok(self)
    }

    pub(super) fn with_load(mut self, load: f64, law: &dyn Values) -> Result<Self, Error> {
        self.load = load;
        Error::check(
            "MassOnBelt",
            "load",
            load,
            load > 0.0 && self.has_finite_limits(law),
            "load > 0, and 2βv_b ± γ²μ_s finite",
        )?;
        Ok(self)
    }

    pub(super) fn with_belt_velocity(
        mut self,
        belt_velocity: f64,
        law: &dyn Values,
    ) -> Result<Self, Error> {
        self.belt_velocity = belt_velocity;
        Error::check(
            "MassOnBelt",
            "belt_velocity",
            belt_velocity,
            self.has_finite_limits(law),
            "2βv_b ± γ²μ_s finite",
        )?;
        finite_at(law, belt_velocity.abs())?;
        Ok(self)
    }

    fn has_finite_limits(&self, law: &dyn Values) -> bool {
        self.stick_limits(law.static_coefficient())
            .iter()
            .all(|limit| limit.is_finite())
    }

    fn stick_limits(&self, static_coefficient: f64) -> [f64; 2] {
        let (largest, carried) = (self.load * static_coefficient, self.carried_force());
        [-largest - carried, largest - carried]
    }

    fn carried_force(&self) -> f64 {
        2.0 * self.damping * self.belt_velocity
    }
}

/// A [`MassOnBelt`](super::MassOnBelt) of any law. Everything that follows from its parameters is
/// computed here; `MassOnBelt` calls it.
#[derive(Clone, Copy)]
pub(crate) struct Belt<'s> {
    pub(super) law: &'s dyn Law,
    pub(super) parameters: Parameters,
}

impl<'s> Belt<'s> {
    // Not inlined: searches make systems at many places, each of which would hold all checks.

    #[inline(never)]
    pub(crate) fn with_damping(self, damping: f64) -> Result<Self, Error> {
        self.with(self.parameters.with_damping(damping, self.law))
    }

    #[inline(never)]
    pub(crate) fn with_load(self, load: f64) -> Result<Self, Error> {
        self.with(self.parameters.with_load(load, self.law))
    }

    #[inline(never)]
    pub(crate) fn with_belt_velocity(self, belt_velocity: f64) -> Result<Self, Error> {
        self.with(self.parameters.with_belt_velocity(belt_velocity, self.law))
    }

    fn with(self, parameters: Result<Parameters, Error>) -> Result<Self, Error> {
        parameters.map(|parameters| Self { parameters, ..self })
    }

    // Inlined where the compiler divides the crate into several units, too.
    #[inline]
    pub(crate) fn law(&self) -> &'s dyn Law {
        self.law
    }

    #[inline]
    pub(crate) fn belt_velocity(&self) -> f64 {
        self.parameters.belt_velocity
    }

    #[inline]
    pub(crate) fn damping(&self) -> f64 {
        self.parameters.damping
    }

    #[inline]
    pub(crate) fn load(&self) -> f64 {
        self.parameters.load
    }

    /// The constants of slip in a direction.
    #[inline]
    pub(crate) fn equation(&self, direction: Direction) -> Equation {
        Equation {
            stiffness: 1.0,
            damping: 2.0 * self.parameters.damping,
            load: self.parameters.load,
            belt: direction.sign() * self.parameters.belt_velocity,
            pull: 0.0,
            drift: 0.0,
        }
    }

    /// [`MassOnBelt::stick_limits`](super::MassOnBelt::stick_limits).
    pub(crate) fn stick_limits(&self) -> [f64; 2] {
        self.parameters.stick_limits(self.law.static_coefficient())
    }

    /// The largest force that the contact can carry in stick, γ²μ_s.
    #[inline]
    pub(crate) fn largest_friction(&self) -> f64 {
        self.parameters.load * self.law.static_coefficient()
    }

    /// The force that the contact carries in stick at u = 0, 2βv_b.
    #[inline]
    pub(crate) fn carried_force(&self) -> f64 {
        self.parameters.carried_force()
    }

    /// The effective damping 2β + γ² dμ̂/ds at a sliding speed: the rate at which the flow
    /// contracts areas in the plane (u, v). At |v_b| it is h1 of Eq. 10a.
    pub(crate) fn effective_damping(&self, speed: f64) -> f64 {
        2.0 * self.parameters.damping + self.parameters.load * self.law.slope(speed)
    }

    /// [`MassOnBelt::release_state`](super::MassOnBelt::release_state).
    pub(crate) fn release_state(&self) -> Option<State> {
        let [low, high] = self.stick_limits();
        let v_b = self.parameters.belt_velocity;
        if v_b > 0.0 {
            Some(State::new(high, v_b))
        } else if v_b < 0.0 {
            Some(State::new(low, v_b))
        } else {
            None
        }
    }

    /// v_r at a velocity; 0 if it is within its rounding error.
    #[inline]
    pub(crate) fn relative_velocity(&self, velocity: f64) -> f64 {
        let belt = self.parameters.belt_velocity;
        let surface = Surface {
            velocity: belt,
            size: belt.abs(),
            drift: 0.0,
        };
        relative_velocity(std::iter::once(velocity), surface)
    }

    /// The direction in which a mass at displacement u and with the velocity of the belt begins to
    /// slide; `None` if it sticks.
    #[inline(never)]
    pub(crate) fn slides_at(&self, displacement: f64) -> Option<Direction> {
        let [low, high] = self.stick_limits();
        let v_b = self.parameters.belt_velocity;
        let (below, above) = (displacement < low, displacement > high);
        if above || (displacement == high && v_b > 0.0) {
            Some(Direction::Lagging)
        } else if below || (displacement == low && v_b < 0.0) {
            Some(Direction::Leading)
        } else {
            None
        }
    }

    /// The outcome when slip in a direction reaches the belt's velocity at displacement u.
    pub(crate) fn landing(&self, displacement: f64, from: Direction) -> Landing {
        match self.slides_at(displacement) {
            None => Landing::Stick,
            Some(side) if side == from => Landing::Touch,
            Some(side) => Landing::Crossing(side),
        }
    }

    /// Returns true if u is the release point, up to the different ways of rounding its formula.
    pub(crate) fn is_release(&self, displacement: f64) -> bool {
        let release = self.release_state();
        release.is_some_and(|release| self.is_rounded(displacement, release.displacement))
    }

    /// Returns true if u is an end of the stick band, up to the different ways of rounding its
    /// formula.
    pub(crate) fn is_at_limit(&self, displacement: f64) -> bool {
        let mut limits = self.stick_limits().into_iter();
        limits.any(|limit| self.is_rounded(displacement, limit))
    }

    /// Returns true if u is this end of the stick band, except for rounding.
    fn is_rounded(&self, displacement: f64, limit: f64) -> bool {
        let largest = self
            .largest_friction()
            .max(limit.abs())
            .max(displacement.abs());
        (displacement - limit).abs() <= RELEASE_ROUNDING * f64::EPSILON * largest
    }

    /// The rate ds/dτ = |F| − γ²μ̂(0) of a mass that begins to slide at displacement u, with
    /// relative velocity 0.
    ///
    /// The rate is computed from the stick limits that every decision uses, so that it is exactly 0
    /// at the release point of a law with μ̂(0) = μ_s.
    pub(crate) fn slip_rate(&self, displacement: f64, direction: Direction) -> f64 {
        let [low, high] = self.stick_limits();
        let beyond = match direction {
            Direction::Lagging => displacement - high,
            Direction::Leading => low - displacement,
        };
        let jump = self.law.static_coefficient() - self.law.kinetic(0.0);
        // μ̂(0) may exceed μ_s by an ulp.
        beyond.max(0.0) + (self.parameters.load * jump).max(0.0)
    }

    /// [`MassOnBelt::friction_force`](super::MassOnBelt::friction_force).
    pub(crate) fn friction_force(&self, state: State) -> f64 {
        let relative_velocity = self.relative_velocity(state.velocity);
        if relative_velocity == 0.0 {
            match self.slides_at(state.displacement) {
                None => state.displacement + self.carried_force(),
                Some(direction) => -direction.sign() * self.parameters.load * self.law.kinetic(0.0),
            }
        } else {
            -self.parameters.load * self.law.coefficient(relative_velocity)
        }
    }

    /// [`MassOnBelt::acceleration`](super::MassOnBelt::acceleration).
    pub(crate) fn acceleration(&self, state: State) -> f64 {
        let State {
            displacement,
            velocity,
        } = state;
        if self.relative_velocity(velocity) == 0.0 && self.slides_at(displacement).is_none() {
            return 0.0;
        }
        self.friction_force(state) - 2.0 * self.parameters.damping * velocity - displacement
    }

    /// [`MassOnBelt::equilibrium`](super::MassOnBelt::equilibrium).
    pub(crate) fn equilibrium(&self) -> Option<Equilibrium> {
        let speed = self.parameters.belt_velocity.abs();
        (speed > 0.0).then(|| {
            Equilibrium::new(
                self.equilibrium_displacement(),
                self.effective_damping(speed),
            )
        })
    }

    /// The displacement of steady sliding, ū = sgn(v_b)·γ²μ̂(|v_b|); 0 at v_b = 0.
    pub(crate) fn equilibrium_displacement(&self) -> f64 {
        self.parameters.load * self.law.coefficient(self.parameters.belt_velocity)
    }
}

/// The outcome when slip reaches the belt's velocity.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Landing {
    /// Static friction holds the mass.
    Stick,
    /// Slip continues in the other direction.
    Crossing(Direction),
    /// Slip continues in its direction: the motion has only touched the belt's velocity, at the
    /// open end of the stick band.
    Touch,
}

/// Distance from the release point within which a displacement counts as the release point, in
/// units of ε times the largest term of its formula.
const RELEASE_ROUNDING: f64 = 4.0;
