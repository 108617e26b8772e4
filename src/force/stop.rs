use super::ForceLaw;
use crate::scalar::Scalar;

/// The law of a stop with spring and damper, as a force of the position x with velocity y: δ = x −
/// g is the depth behind the gap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct StopLaw {
    pub(crate) gap: f64,
    pub(crate) stiffness: f64,
    pub(crate) damping: f64,
    pub(crate) is_adhesive: bool,
}

/// The pieces of the law: δ < 0; δ > 0 with a force; δ > 0 without one, where kδ + cδ' < 0.
pub(crate) const OPEN: usize = 0;
pub(crate) const CLOSED: usize = 1;
pub(crate) const UNLOADED: usize = 2;

impl StopLaw {
    /// Returns true if the stop may lose its force before δ = 0.
    pub(crate) fn may_unload(&self) -> bool {
        self.damping != 0.0 && !self.is_adhesive
    }

    /// kδ + cδ'.
    pub(crate) fn pressure<S: Scalar>(&self, position: S, velocity: S) -> S {
        (position - self.gap) * self.stiffness + velocity * self.damping
    }

    /// The piece at a position and a velocity; at δ = 0 the one to which the velocity leads.
    pub(crate) fn piece(&self, position: f64, velocity: f64) -> usize {
        let depth = position - self.gap;
        if depth < 0.0 || (depth == 0.0 && velocity <= 0.0) {
            OPEN
        } else {
            self.beyond(self.pressure(position, velocity) >= 0.0)
        }
    }

    /// The piece where δ > 0, by the sign of kδ + cδ'.
    pub(crate) fn beyond(&self, is_pressed: bool) -> usize {
        if is_pressed || !self.may_unload() {
            CLOSED
        } else {
            UNLOADED
        }
    }
}

impl ForceLaw for StopLaw {
    #[inline(always)]
    fn force<S: Scalar>(&self, position: S, velocity: S, piece: usize) -> S {
        match piece {
            CLOSED => self.pressure(position, velocity),
            _ => position.constant(0.0),
        }
    }

    fn potential<S: Scalar>(&self, position: S, piece: usize) -> Option<S> {
        Some(match piece {
            OPEN => position.constant(0.0),
            _ => (position - self.gap).square() * (0.5 * self.stiffness),
        })
    }

    fn breakpoints(&self) -> impl Iterator<Item = f64> {
        std::iter::once(self.gap)
    }
}
