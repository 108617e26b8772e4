//! One root between two places of different sign, from values alone, down to neighbouring numbers.

use crate::error::Error;

/// An interval at whose ends a function has different signs (0 counts as negative), and that
/// shrinks with every value inside.
///
/// The method is false position: the next place is where the chord passes zero. As long as only one
/// end moves, its steps are doubled each time, so that the other end soon moves, too. If three
/// values have not halved the interval, it is bisected.
#[derive(Debug, Clone)]
pub(crate) struct Bracket {
    low: f64,
    low_value: f64,
    high: f64,
    high_value: f64,
    /// The end that moved last.
    moved: Option<End>,
    /// Factor by which the next step goes farther than the zero of the chord.
    stretch: f64,
    /// Width when the interval was last halved.
    width: f64,
    /// Number of values that have failed to halve the interval, less one for each that did.
    slow: u32,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum End {
    Low,
    High,
}

/// A sign change of a function, between the number `below` and the next one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SignChange {
    /// The lower of the two neighbouring numbers. If a range is divided, this number lies in the
    /// part in which the change is found, so that no change is lost or found twice.
    pub(crate) below: f64,
    /// The function at `below`, and at the number above.
    pub(crate) values: [f64; 2],
}

impl SignChange {
    /// The larger |value| on the two sides of the change: large where the function jumps over zero.
    pub(crate) fn residual(&self) -> f64 {
        self.values[0].abs().max(self.values[1].abs())
    }

    /// The one of the two neighbouring numbers at which the function is nearer to zero.
    pub(crate) fn nearest(&self) -> f64 {
        if self.values[1].abs() < self.values[0].abs() {
            self.below.next_up()
        } else {
            self.below
        }
    }
}

/// The two neighbouring numbers between which a property changes, by bisection; `low` has the
/// property and `high` does not.
pub(crate) fn border(mut low: f64, mut high: f64, holds: impl Fn(f64) -> bool) -> [f64; 2] {
    loop {
        let middle = 0.5 * low + 0.5 * high;
        if !(low < middle && middle < high) {
            return [low, high];
        }
        if holds(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
}

impl Bracket {
    /// The bracket between two places, the lower first, with the values of different sign there.
    pub(crate) fn new((low, low_value): (f64, f64), (high, high_value): (f64, f64)) -> Self {
        Self {
            low,
            low_value,
            high,
            high_value,
            moved: None,
            stretch: 1.0,
            width: high - low,
            slow: 0,
        }
    }

    pub(crate) fn width(&self) -> f64 {
        self.high - self.low
    }

    /// The next place to evaluate; `None` if no number is left between the ends.
    pub(crate) fn next_place(&self) -> Option<f64> {
        let (a, b) = (self.low, self.high);
        let chord = a + (b - a) * (self.low_value / (self.low_value - self.high_value));
        // An end may be a root itself.
        let chord = chord.max(a.next_up()).min(b.next_down());
        let step = match self.moved {
            None => chord,
            Some(End::Low) => (a + self.stretch * (chord - a)).max(a.next_up()),
            Some(End::High) => (b - self.stretch * (b - chord)).min(b.next_down()),
        };
        let x = if self.slow < 3 && a < step && step < b {
            step
        } else {
            0.5 * (a + b)
        };
        (a < x && x < b).then_some(x)
    }

    /// Shrinks the interval by the value at a place inside.
    #[inline(never)]
    pub(crate) fn narrow(&mut self, x: f64, value: f64) {
        let end = if (value > 0.0) == (self.low_value > 0.0) {
            (self.low, self.low_value) = (x, value);
            End::Low
        } else {
            (self.high, self.high_value) = (x, value);
            End::High
        };
        self.stretch = if self.moved == Some(end) {
            2.0 * self.stretch
        } else {
            1.0
        };
        self.moved = Some(end);
        if self.width() <= 0.5 * self.width {
            (self.width, self.slow) = (self.width(), self.slow.saturating_sub(1));
        } else {
            self.slow += 1;
        }
    }

    /// The sign change, once no number is left inside.
    pub(crate) fn sign_change(&self) -> SignChange {
        SignChange {
            below: self.low,
            values: [self.low_value, self.high_value],
        }
    }
}

/// The sign change of a function between two places, the lower first, each given with its value;
/// the values differ in sign. `None` if the function gives `None` at a place in between.
pub(crate) fn sign_change_between(
    f: &mut dyn FnMut(f64) -> Result<Option<f64>, Error>,
    a: (f64, f64),
    b: (f64, f64),
) -> Result<Option<SignChange>, Error> {
    let mut bracket = Bracket::new(a, b);
    while let Some(x) = bracket.next_place() {
        let Some(value) = f(x)? else {
            return Ok(None);
        };
        bracket.narrow(x, value);
    }
    Ok(Some(bracket.sign_change()))
}

/// The root of a function between two places, in either order, at which its signs differ: of the
/// two neighbouring numbers about it, the one at which the function is nearer to zero.
pub(crate) fn root_between(
    f: &mut dyn FnMut(f64) -> Result<f64, Error>,
    a: f64,
    b: f64,
) -> Result<f64, Error> {
    let (low, high) = (a.min(b), a.max(b));
    let ends = [(low, f(low)?), (high, f(high)?)];
    if let Some((root, _)) = ends.into_iter().find(|(_, value)| *value == 0.0) {
        return Ok(root);
    }
    let change = sign_change_between(&mut |x| f(x).map(Some), ends[0], ends[1])?;
    // This function never gives `None`.
    Ok(change.map_or(low, |change| change.nearest()))
}

#[cfg(test)]
mod tests;
