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
}

impl Units {
    /// The units of the dimensionless system itself.
    pub(crate) const DIMENSIONLESS: Self = Self {
        length: 1.0,
        rate: 1.0,
        stiffness: 1.0,
    };

    /// ω0 L, metres per second.
    pub(crate) fn velocity(self) -> f64 {
        self.rate * self.length
    }

    /// A dimensionless state in these units.
    pub(crate) fn state(self, state: State) -> State {
        State::new(
            state.displacement * self.length,
            state.velocity * self.velocity(),
        )
    }
}
