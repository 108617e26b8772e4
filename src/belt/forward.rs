use std::ops::Deref;

use super::system::MassOnBelt;
use crate::friction::FrictionLaw;

/// A system whose belt moves forward, v_b > 0, with its law borrowed.
///
/// Searches for periodic motions take this type. None of them then has to ask which way the belt
/// moves, and each is compiled only once for a law, however it is called.
#[derive(Debug)]
pub(crate) struct Forward<'s, L>(MassOnBelt<&'s L>);

impl<'s, L> Forward<'s, L> {
    /// The system itself, or its mirror image if v_b < 0, which slides alike because laws are odd
    /// in v_r. `None` on a belt that stands still.
    pub(crate) fn of(system: MassOnBelt<&'s L>) -> Option<Self> {
        (system.belt_velocity() != 0.0).then(|| Self(system.with_belt_speed()))
    }
}

impl<'s, L: FrictionLaw> Forward<'s, L> {
    /// The law itself, not the reference to it: what is done with it is compiled for the law, once.
    pub(crate) fn law(&self) -> &'s L {
        self.0.law()
    }
}

impl<L: FrictionLaw> MassOnBelt<L> {
    /// The same system if v_b > 0, its mirror image if v_b < 0; `None` at v_b = 0.
    pub(crate) fn moving_forward(&self) -> Option<Forward<'_, L>> {
        Forward::of(self.by_reference())
    }
}

impl<'s, L> Deref for Forward<'s, L> {
    type Target = MassOnBelt<&'s L>;

    fn deref(&self) -> &Self::Target {
        &self.0
    }
}

// `derive` would ask for L: Clone.
impl<L> Clone for Forward<'_, L> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<L> Copy for Forward<'_, L> {}
