use super::State;

/// The units in which a dimensionless motion is measured: the sizes, in SI units, of the
/// dimensionless length 1 and so on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Units {
    /// L, metres.
    pub(crate) length: f64,
    /// ω0, radians per second: 1/ω0 is the unit of time.
    pub(crate) rate: f64,
    /// K, newtons per metre.
    pub(crate) stiffness: f64,
    /// V, metres per second: the velocity of a mass that sticks has its bits. `None` if it is only
    /// known without units.
    pub(crate) belt_velocity: Option<f64>,
}

impl Units {
    /// The units of the dimensionless system itself.
    pub(crate) const DIMENSIONLESS: Self = Self {
        length: 1.0,
        rate: 1.0,
        stiffness: 1.0,
        belt_velocity: None,
    };

    /// ω0 L, metres per second.
    pub(crate) fn velocity(self) -> f64 {
        self.rate * self.length
    }

    /// K L, newtons.
    pub(crate) fn force(self) -> f64 {
        self.stiffness * self.length
    }

    /// A parameter of the dimensionless system, or an end of a range of belt velocities, in these
    /// units, with its name in [`Physical`](crate::Physical); `None` for other names.
    pub(crate) fn parameter(self, name: &str, value: f64) -> Option<(&'static str, f64)> {
        match name {
            "belt_velocity" => Some(("belt_velocity", value * self.velocity())),
            "range.start" => Some(("range.start", value * self.velocity())),
            "range.end" => Some(("range.end", value * self.velocity())),
            // C = 2β√(K M), with √(K M) = K/ω0.
            "damping" => Some(("damping", 2.0 * value * self.stiffness / self.rate)),
            "load" => Some(("normal_force", value * self.force())),
            _ => None,
        }
    }

    /// A dimensionless state in these units.
    pub(crate) fn state(self, state: State) -> State {
        State::new(
            state.displacement * self.length,
            state.velocity * self.velocity(),
        )
    }

    /// A state in these units without them.
    pub(crate) fn dimensionless(self, state: State) -> State {
        State::new(
            state.displacement / self.length,
            state.velocity / self.velocity(),
        )
    }
}
