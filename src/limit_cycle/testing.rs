//! What the tests of this module share.

use super::Tracer;
use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::FrictionLaw;

/// What a tracer of the system finds.
pub(super) fn traced<L: FrictionLaw, T>(
    system: &MassOnBelt<L>,
    f: impl FnOnce(&mut Tracer<'_, L>) -> Result<T, Error>,
) -> T {
    let forward = system.moving_forward().unwrap();
    f(&mut Tracer::new(forward)).unwrap()
}

#[track_caller]
pub(super) fn assert_close(found: f64, expected: f64, error: f64) {
    assert!(
        (found - expected).abs() <= error,
        "{found} {expected} ± {error}"
    );
}
