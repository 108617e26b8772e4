use std::ops::Deref;

use super::model::Belt;

/// A system whose belt moves forward, v_b > 0.
///
/// Searches for periodic motions take this type, so that they need not handle the sign of v_b.
#[derive(Clone, Copy)]
pub(crate) struct Forward<'s>(Belt<'s>);

impl<'s> Forward<'s> {
    /// The system itself, or its mirror image if v_b < 0, which slides alike because laws are odd
    /// in v_r. `None` on a belt that stands still.
    pub(crate) fn of(system: Belt<'s>) -> Option<Self> {
        let mut forward = system;
        forward.parameters.belt_velocity = system.belt_velocity().abs();
        (forward.belt_velocity() != 0.0).then_some(Self(forward))
    }
}

impl<'s> Deref for Forward<'s> {
    type Target = Belt<'s>;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}
