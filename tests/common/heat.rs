//! A friction law with a temperature.

use stick_slip::{ContactLaw, Motion, Scalar, Slip};

/// Friction heats the contact, z' = aN|μr| − b(1 + cN)z, and falls with its temperature z, from
/// `cold` towards `hot`.
#[derive(Debug, Clone, Copy)]
pub struct Heat {
    pub cold: f64,
    pub hot: f64,
    pub heating: f64,
    pub cooling: f64,
    /// c: a contact that is pressed conducts more heat.
    pub conduction: f64,
    /// The part of z that is left where stick begins or ends.
    pub kept: f64,
}

impl Heat {
    fn level<S: Scalar>(&self, z: S) -> S {
        (-z).exp() * (self.cold - self.hot) + self.hot
    }
}

impl ContactLaw for Heat {
    type Memory<S: Scalar> = [S; 1];
    fn coefficient<S: Scalar>(&self, slip: Slip<S>, [z]: [S; 1]) -> S {
        self.level(z) * slip.direction
    }
    fn limit<S: Scalar>(&self, _: S, [z]: [S; 1]) -> Option<S> {
        Some(self.level(z) * 1.25)
    }
    fn rates<S: Scalar>(&self, motion: Motion<S>, load: S, [z]: [S; 1]) -> [S; 1] {
        let loss = (load * self.conduction + 1.0) * z * self.cooling;
        match motion {
            Motion::Stick => [-loss],
            Motion::Slip(slip) => [self.level(z) * load * slip.speed * self.heating - loss],
        }
    }
    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        std::iter::empty()
    }
    fn caught(&self, [z]: [f64; 1]) -> [f64; 1] {
        [self.kept * z]
    }
    fn changes_while_open(&self) -> bool {
        true
    }
}
