//! The time of a motion, summed without loss over any number of steps, and its direction.

/// A time as the sum of two numbers, so that 10⁶ steps lose nothing.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Clock {
    /// The time, rounded.
    pub(crate) time: f64,
    /// The rounding error of `time`.
    remainder: f64,
}

impl Clock {
    /// The clock that shows exactly `time`.
    pub(crate) const fn at(time: f64) -> Self {
        Self {
            time,
            remainder: 0.0,
        }
    }

    /// The clock a duration later (Knuth's two-sum).
    #[inline(always)]
    pub(crate) fn after(self, duration: f64) -> Self {
        let step = duration + self.remainder;
        let time = self.time + step;
        let taken = time - self.time;
        let remainder = (self.time - (time - taken)) + (step - taken);
        Self { time, remainder }
    }

    /// The sum of durations.
    pub(crate) fn sum(durations: impl Iterator<Item = f64>) -> f64 {
        durations.fold(Self::default(), Self::after).time
    }

    /// The time that this clock shows if a unit of its time lasts 1/rate.
    pub(crate) fn at_rate(self, rate: f64) -> Self {
        Self {
            time: self.time / rate,
            remainder: self.remainder / rate,
        }
    }

    /// Duration from this clock's time to `time`.
    #[inline(always)]
    pub(crate) fn until(self, time: f64) -> f64 {
        (time - self.time) - self.remainder
    }

    /// Duration from this clock's time to another clock's time.
    pub(crate) fn to(self, later: Self) -> f64 {
        (later.time - self.time) + (later.remainder - self.remainder)
    }

    /// The product factor·time as a number and its rounding error.
    ///
    /// Together the two are good to about ε² of the product (two-product with a fused
    /// multiply-add).
    pub(crate) fn times(self, factor: f64) -> (f64, f64) {
        let product = factor * self.time;
        let error = factor.mul_add(self.time, -product);
        (product, error + factor * self.remainder)
    }
}

/// The direction of time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Time {
    Forward,
    Backward,
}

impl Time {
    pub(crate) fn sign(self) -> f64 {
        match self {
            Self::Forward => 1.0,
            Self::Backward => -1.0,
        }
    }
}
