use crate::clock::Clock;
use crate::error::Error;

/// Straight lines through points (time, value), constant outside: at least two points, not all of
/// the same value; times do not descend.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(transparent))]
pub(super) struct Profile {
    points: Vec<(f64, f64)>,
    /// Largest size of its values.
    #[cfg_attr(feature = "serde", serde(skip))]
    size: f64,
}

impl Profile {
    pub(super) fn new(points: &[(f64, f64)]) -> Result<Self, Error> {
        let count = points.len() as f64;
        Error::check(
            "Drive",
            "points",
            count,
            count > 0.0,
            "points ≥ 1: their number",
        )?;
        for (index, &(time, value)) in points.iter().enumerate() {
            check_point(&points[..index], time, value).map_err(|error| error.at_point(index))?;
        }
        let sizes = points.iter().map(|(_, value)| value.abs());
        Ok(Self {
            points: points.to_vec(),
            size: sizes.fold(0.0, f64::max),
        })
    }

    /// The value of the profile, if it is constant.
    pub(super) fn as_constant(&self) -> Option<f64> {
        let &(_, first) = self.points.first()?;
        let constant = self.points.iter().all(|&(_, value)| value == first);
        constant.then_some(first)
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        let points = self.points.iter();
        Self {
            points: points
                .map(|&(time, value)| (time, value * factor))
                .collect(),
            size: self.size * factor.abs(),
        }
    }

    /// Largest size of its values.
    pub(super) fn size(&self) -> f64 {
        self.size
    }

    /// Value and slope.
    pub(super) fn at(&self, time: Clock) -> [f64; 2] {
        self.on_piece(self.passed(time), time)
    }

    /// The value at a time; at a jump the value just before it.
    pub(super) fn just_before(&self, time: Clock) -> f64 {
        let before = |&(point, _): &(f64, f64)| time.until(point) < 0.0;
        self.on_piece(self.points.partition_point(before), time)[0]
    }

    /// Number of points before a time and at it.
    fn passed(&self, time: Clock) -> usize {
        self.points
            .partition_point(|&(point, _)| time.until(point) <= 0.0)
    }

    /// Value and slope on the piece that ends at point number `end`; the last piece has no end.
    fn on_piece(&self, end: usize, time: Clock) -> [f64; 2] {
        let start = end.checked_sub(1).and_then(|start| self.points.get(start));
        match (start, self.points.get(end)) {
            (Some(&(t0, v0)), Some(&(t1, v1))) => {
                let slope = (v1 - v0) / (t1 - t0);
                let (since, left) = (-time.until(t0), time.until(t1));
                // From the nearer end: continuous to the bit.
                let value = if since <= left {
                    v0 + slope * since
                } else {
                    v1 - slope * left
                };
                [value, slope]
            }
            (Some(&(_, value)), None) | (None, Some(&(_, value))) => [value, 0.0],
            // There is a point at least.
            (None, None) => [f64::NAN, f64::NAN],
        }
    }

    pub(super) fn next_break(&self, time: Clock) -> Option<f64> {
        let next = self.points.get(self.passed(time));
        next.map(|&(time, _)| time)
    }

    /// The times of jumps, ascending.
    pub(super) fn jumps(&self) -> impl Iterator<Item = f64> {
        let pairs = self.points.windows(2);
        let jumps = pairs.filter(|pair| pair[0].0 == pair[1].0 && pair[0].1 != pair[1].1);
        jumps.map(|pair| pair[0].0)
    }

    /// ∫ f dt from one time to a later one, piece by piece.
    pub(super) fn integral(&self, from: Clock, to: Clock) -> f64 {
        let [first, last] = [from, to].map(|time| self.passed(time));
        let mut sum = 0.0;
        let mut start = from;
        for piece in first..=last {
            let end = match self.points.get(piece) {
                Some(&(time, _)) if piece < last => Clock::at(time),
                _ => to,
            };
            let duration = start.to(end);
            // A jump has no duration, and no slope.
            if duration != 0.0 {
                let mean = 0.5 * (self.on_piece(piece, start)[0] + self.on_piece(piece, end)[0]);
                sum += mean * duration;
            }
            start = end;
        }
        sum
    }
}

/// Returns an error unless a point may follow the points before it.
fn check_point(before: &[(f64, f64)], time: f64, value: f64) -> Result<(), Error> {
    Error::check("Drive", "value", value, true, "any size")?;
    let Some(&(last_time, last_value)) = before.last() else {
        Error::check("Drive", "time", time, true, "any time")?;
        return Ok(());
    };
    Error::check(
        "Drive",
        "time",
        time,
        time >= last_time,
        "no time before that of the point before",
    )?;
    if time > last_time {
        let (rise, run) = (value - last_value, time - last_time);
        let slope = rise / run;
        Error::check(
            "Drive",
            "time",
            time,
            slope.is_finite() && run.is_finite(),
            "so far from the time before, and no further, that the slope is a number",
        )?;
        return Ok(());
    }
    let third = before.len() >= 2 && before[before.len() - 2].0 == time;
    Error::check(
        "Drive",
        "time",
        time,
        !third,
        "at most two points at one time, which are a jump",
    )?;
    Ok(())
}
