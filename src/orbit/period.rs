use super::type_erased_system::Rhythm;
use crate::error::Error;

/// The period of the motion to be found.
///
/// ```
/// use stick_slip::orbit::Period;
/// assert_ne!(Period::Driven(2), Period::Free(2.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Period {
    /// A forced motion. Its period is the common period of the drives of a
    /// [`Structure`](crate::Structure), times this number (at least 1). Its start is the state at
    /// time 0 of the drives.
    Driven(usize),
    /// An autonomous motion, of a system in which no drive varies. The number is an estimate of the
    /// motion's period, in units of time.
    ///
    /// A phase condition fixes the start of the motion. [`shoot`](super::shoot) and
    /// [`settle`](super::settle) begin at a guess, a state near the motion: the start lies on the
    /// plane through the guess, normal to the flow x' at the guess (x: state). The functions
    /// [`follow`](super::follow()) and [`begin`](super::begin()) choose a start at a turning point
    /// of one coordinate; if all turning points are near events, `follow` chooses a plane across
    /// the motion.
    Free(f64),
}

impl Period {
    /// This kind of motion with the period of one: it takes the place of the estimate.
    pub(super) fn with_period(self, period: f64) -> Self {
        match self {
            Self::Free(_) => Self::Free(period),
            Self::Driven(_) => self,
        }
    }

    /// The duration in units of time, for drives that vary like this.
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
