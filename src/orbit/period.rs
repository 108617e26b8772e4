use super::form::Rhythm;
use crate::error::Error;

/// The period of a motion that is looked for.
///
/// ```
/// use stick_slip::orbit::Period;
/// assert_ne!(Period::Driven(2), Period::Free(2.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Period {
    /// So many periods of the drives of a [`Structure`](crate::Structure), at least 1. The state is
    /// that at time 0 of the drives.
    Driven(usize),
    /// An estimate of the period of a free motion, in which no drive varies, in units of time.
    ///
    /// The state is on the section through the guess that is normal to the flow there.
    Free(f64),
}

impl Period {
    /// In units of time, where drives vary like this.
    pub(super) fn duration(self, rhythm: Rhythm) -> Result<f64, Error> {
        match (self, rhythm) {
            (Self::Driven(count), Rhythm::Periodic(period)) => {
                let allowed = "periods ≥ 1";
                Ok(
                    Error::check("orbit::Period", "periods", count as f64, count > 0, allowed)?
                        * period,
                )
            }
            (Self::Driven(_), _) => Err(Error::NoCommonPeriod),
            (Self::Free(estimate), Rhythm::Constant) => Error::check(
                "orbit::Period",
                "period",
                estimate,
                estimate > 0.0,
                "period > 0",
            ),
            (Self::Free(_), _) => Err(Error::NotFree),
        }
    }
}
