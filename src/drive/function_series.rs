use std::fmt;
use std::sync::Arc;

use super::function::TimeFunction;
use crate::clock::Clock;
use crate::error::Error;
use crate::numerics::gauss::gauss_legendre;
use crate::scalar::dual::Dual;
use crate::series::PowerSeries;

/// The formula of a function without its type.
trait Formula {
    fn value(&self, time: f64, piece: usize) -> f64;
    /// Value and slope.
    fn value_and_slope(&self, time: f64, piece: usize) -> [f64; 2];
    fn series(&self, time: f64, piece: usize) -> PowerSeries;
    fn name(&self) -> &'static str;
}

impl<F: TimeFunction> Formula for F {
    fn value(&self, time: f64, piece: usize) -> f64 {
        TimeFunction::value(self, time, piece)
    }

    fn value_and_slope(&self, time: f64, piece: usize) -> [f64; 2] {
        let found = TimeFunction::value(self, Dual::along(time, 1.0), piece);
        [found.value, found.derivative()]
    }

    fn series(&self, time: f64, piece: usize) -> PowerSeries {
        let mut times = PowerSeries::of(time);
        times[1] = 1.0;
        TimeFunction::value(self, times, piece)
    }

    fn name(&self) -> &'static str {
        std::any::type_name::<F>()
    }
}

/// A user's function of time, times a factor.
#[derive(Clone)]
pub(super) struct Function {
    formula: Arc<dyn Formula + Send + Sync>,
    factor: f64,
    /// Largest size of its values.
    size: f64,
    /// The timescale of each piece.
    timescales: Vec<f64>,
    /// The times at which pieces meet, in the first period, and the piece that begins there.
    marks: Vec<(f64, usize)>,
    period: Option<f64>,
}

/// The place of a time among the pieces.
#[derive(Clone, Copy)]
struct Place {
    /// Number of the period, and of the marks passed in it.
    turn: f64,
    passed: usize,
    piece: usize,
    /// The time in the period, and its rounding error.
    time: f64,
    rest: f64,
}

impl Function {
    pub(super) fn new<F: TimeFunction + Send + Sync + 'static>(function: F) -> Result<Self, Error> {
        let breakpoints: Vec<f64> = function.breakpoints().collect();
        let period = function.period();
        if let Some(period) = period {
            Error::check("Drive", "period", period, period > 0.0, "period > 0")?;
        }
        let size = function.size();
        Error::check("Drive", "size", size, size >= 0.0, "size ≥ 0")?;
        let timescales: Vec<f64> = (0..=breakpoints.len())
            .map(|piece| function.timescale(piece))
            .collect();
        for &time in timescales.iter().filter(|time| **time != f64::INFINITY) {
            let allowed = "timescale > 0, `f64::INFINITY` on a piece that is a polynomial";
            Error::check("Drive", "timescale", time, time > 0.0, allowed)?;
        }
        let mut last = f64::NEG_INFINITY;
        for (index, &value) in breakpoints.iter().enumerate() {
            let is_inside = period.is_none_or(|period| (0.0..period).contains(&value));
            if !(value.is_finite() && value > last && is_inside) {
                return Err(Error::BadBreakpoints { index, value });
            }
            last = value;
        }
        // The formula is that of one period.
        let is_started = period.is_some() && breakpoints.first().is_none_or(|b| *b > 0.0);
        let start = is_started.then_some((0.0, 0));
        let marks = breakpoints
            .iter()
            .zip(1..)
            .map(|(&time, piece)| (time, piece));
        let found = Self {
            formula: Arc::new(function),
            factor: 1.0,
            size,
            timescales,
            marks: start.into_iter().chain(marks).collect(),
            period,
        };
        found.check_values()?;
        Ok(found)
    }

    /// Checks that the value is a number at time 0 and on both sides of every breakpoint.
    fn check_values(&self) -> Result<(), Error> {
        let at_zero = self.at(Clock::at(0.0))[0];
        let sides = (0..self.marks.len()).flat_map(|mark| self.sides(mark).map(|[value, _]| value));
        for value in std::iter::once(at_zero).chain(sides) {
            let allowed = "a number at time 0 and on both sides of every breakpoint";
            Error::check("Drive", "value", value, true, allowed)?;
        }
        Ok(())
    }

    pub(super) fn scaled(&self, factor: f64) -> Self {
        Self {
            factor: self.factor * factor,
            ..self.clone()
        }
    }

    /// Largest size of its values.
    pub(super) fn size(&self) -> f64 {
        (self.factor * self.size).abs()
    }

    pub(super) fn period(&self) -> Option<f64> {
        self.period
    }

    /// The reciprocal of its shortest timescale.
    pub(super) fn fastest(&self) -> f64 {
        let times = self.timescales.iter().copied();
        times.fold(f64::INFINITY, f64::min).recip()
    }

    /// The place of a time; at a mark that of the piece before it if `before`.
    fn place(&self, clock: Clock, before: bool) -> Place {
        let is_passed = |turn: f64, mark: f64| {
            let left = clock.until(self.mark_in(turn, mark));
            left < 0.0 || left == 0.0 && !before
        };
        let passed = |turn: f64| {
            self.marks
                .partition_point(|&(mark, _)| is_passed(turn, mark))
        };
        let period = self.period.unwrap_or(0.0);
        let mut turn = self
            .period
            .map_or(0.0, |period| (clock.time / period).floor());
        let mut count = passed(turn);
        if self.period.is_some() && !self.marks.is_empty() {
            // The quotient is rounded.
            if count == 0 {
                turn -= 1.0;
                count = passed(turn);
            } else if count == self.marks.len() && passed(turn + 1.0) > 0 {
                turn += 1.0;
                count = passed(turn);
            }
        }
        let (time, remainder) = clock.times(1.0);
        let start = turn * period;
        let error = turn.mul_add(period, -start);
        let (time, rest) = Clock::at(time - start).after(remainder - error).times(1.0);
        let last = count.checked_sub(1).and_then(|last| self.marks.get(last));
        Place {
            turn,
            passed: count,
            piece: last.map_or(0, |&(_, piece)| piece),
            time,
            rest,
        }
    }

    /// The time of a mark in a period.
    fn mark_in(&self, turn: f64, mark: f64) -> f64 {
        self.period
            .map_or(mark, |period| turn.mul_add(period, mark))
    }

    fn at_place(&self, place: Place) -> [f64; 2] {
        let [value, slope] = self.formula.value_and_slope(place.time, place.piece);
        [
            self.factor * (value + slope * place.rest),
            self.factor * slope,
        ]
    }

    /// Value and slope.
    pub(super) fn at(&self, time: Clock) -> [f64; 2] {
        self.at_place(self.place(time, false))
    }

    /// The value at a time; at a jump the value just before it.
    pub(super) fn just_before(&self, time: Clock) -> f64 {
        self.at_place(self.place(time, true))[0]
    }

    /// The series in the time since `start`.
    pub(super) fn series(&self, start: Clock) -> PowerSeries {
        self.series_at(self.place(start, false))
    }

    fn series_at(&self, place: Place) -> PowerSeries {
        let mut series = self.formula.series(place.time, place.piece);
        if place.rest != 0.0 {
            series.add(place.rest, &series.derivative());
        }
        series.scaled(self.factor)
    }

    pub(super) fn next_break(&self, clock: Clock) -> Option<f64> {
        let place = self.place(clock, false);
        let next = match self.marks.get(place.passed) {
            Some(&(mark, _)) => self.mark_in(place.turn, mark),
            None => {
                let &(mark, _) = self.marks.first().filter(|_| self.period.is_some())?;
                self.mark_in(place.turn + 1.0, mark)
            }
        };
        // A clock that resolves no periods has no break to come.
        (clock.until(next) > 0.0).then_some(next)
    }

    /// Value and slope just before a mark and just after it, without the factor.
    fn sides(&self, mark: usize) -> [[f64; 2]; 2] {
        let (time, piece) = self.marks[mark];
        let before = match (mark, self.period) {
            (0, Some(period)) => (time + period, self.timescales.len() - 1),
            _ => (time, piece - 1),
        };
        [before, (time, piece)].map(|(time, piece)| self.formula.value_and_slope(time, piece))
    }

    /// Returns true if the value jumps at a mark, by more than its rounding errors and those of
    /// the time.
    fn jumps_at_mark(&self, mark: usize) -> bool {
        const ROUNDING: f64 = 64.0 * f64::EPSILON;
        let [before, after] = self.sides(mark);
        let time = self.period.unwrap_or(0.0).max(self.marks[mark].0.abs());
        let by_time = time * before[1].abs().max(after[1].abs());
        let size = self.size.max(before[0].abs()).max(after[0].abs()) + by_time;
        (before[0] - after[0]).abs() > ROUNDING * size
    }

    /// The first time at which it jumps; with a period the first from time 0 on.
    pub(super) fn first_jump(&self) -> Option<f64> {
        let jump = (0..self.marks.len()).find(|&mark| self.jumps_at_mark(mark))?;
        Some(self.marks[jump].0)
    }

    pub(super) fn jumps_at(&self, time: f64) -> bool {
        let Place { turn, passed, .. } = self.place(Clock::at(time), false);
        let last = passed.checked_sub(1);
        last.is_some_and(|mark| {
            self.mark_in(turn, self.marks[mark].0) == time && self.jumps_at_mark(mark)
        })
    }

    /// ∫ f dt from one time to a later one, piece by piece, and whole periods at once.
    pub(super) fn integral(&self, from: Clock, to: Clock) -> f64 {
        let duration = from.to(to);
        let Some(period) = self.period.filter(|period| duration >= 2.0 * period) else {
            return self.integral_by_pieces(from, to);
        };
        let turns = (duration / period).floor() - 1.0;
        let skipped = turns * period;
        let middle = from.after(skipped).after(turns.mul_add(period, -skipped));
        let of_period = self.integral_by_pieces(Clock::at(0.0), Clock::at(period));
        turns * of_period + self.integral_by_pieces(middle, to)
    }

    fn integral_by_pieces(&self, from: Clock, to: Clock) -> f64 {
        let mut sum = 0.0;
        let mut start = from;
        loop {
            let next = self.next_break(start).map(Clock::at);
            let next = next.filter(|next| next.to(to) > 0.0);
            sum += self.integral_on_piece(start, start.to(next.unwrap_or(to)));
            match next {
                Some(next) => start = next,
                None => return self.factor * sum,
            }
        }
    }

    /// ∫ f dt from a time on over a duration on one piece, without the factor.
    fn integral_on_piece(&self, start: Clock, duration: f64) -> f64 {
        /// No duration is divided further.
        const MOST_PANELS: f64 = 65536.0;
        let place = self.place(start, false);
        let value = |t: f64| {
            self.formula
                .value(place.time + (place.rest + t), place.piece)
        };
        let panels = (duration / self.timescales[place.piece]).ceil();
        let panels = panels.clamp(1.0, MOST_PANELS);
        let time = |i: usize| duration * (i as f64 / panels);
        // NaN is one panel.
        let indices = 0..(panels as usize).max(1);
        indices
            .map(|i| adaptive(time(i), time(i + 1), self.size, &value, DEEPEST))
            .sum()
    }

    /// The longest step in which it is looked at often enough.
    pub(super) fn foresight(&self, start: Clock) -> f64 {
        MOST_LOOKS / LOOKS * self.timescales[self.place(start, false).piece]
    }

    /// The largest distance from its series within a duration from `start` on, beyond what the
    /// rounding of the time causes, and its size.
    pub(super) fn defect(&self, start: Clock, duration: f64) -> [f64; 2] {
        /// Rounding of the time, in units of ε times the time.
        const ROUNDING: f64 = 4.0 * f64::EPSILON;
        let place = self.place(start, false);
        let series = self.series_at(place);
        let looks = LOOKS * duration / self.timescales[place.piece];
        let looks = looks.ceil().clamp(FEWEST_LOOKS, MOST_LOOKS);
        let mut largest = 0.0;
        for look in 1..=looks as usize {
            let t = duration * (look as f64 / looks);
            let time = place.time + (place.rest + t);
            let value = self.factor * self.formula.value(time, place.piece);
            let by_time = ROUNDING * (time * series.slope_at(t)).abs();
            let defect = (value - series.at(t)).abs() - by_time;
            // NaN is not dropped.
            largest = if defect <= largest { largest } else { defect };
        }
        [largest, self.size()]
    }
}

/// Number of times that a function is looked at in its timescale, and in a step.
const LOOKS: f64 = 2.0;
const FEWEST_LOOKS: f64 = 8.0;
const MOST_LOOKS: f64 = 1024.0;

/// Largest number of times that a panel is halved.
const DEEPEST: usize = 12;

/// ∫ f from a to b by halves, until both together give what the whole does.
fn adaptive(a: f64, b: f64, size: f64, f: &dyn Fn(f64) -> f64, depth: usize) -> f64 {
    const ROUNDING: f64 = 4.0 * f64::EPSILON;
    let middle = 0.5 * (a + b);
    let [whole, left, right] =
        [[a, b], [a, middle], [middle, b]].map(|[a, b]| gauss_legendre(a, b, f));
    let is_uneven = (left + right - whole).abs() > ROUNDING * size * (b - a);
    if is_uneven && depth > 0 {
        adaptive(a, middle, size, f, depth - 1) + adaptive(middle, b, size, f, depth - 1)
    } else {
        left + right
    }
}

/// A function is equal to itself, in a clone of its drive.
impl PartialEq for Function {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.formula, &other.formula) && self.factor == other.factor
    }
}

impl fmt::Debug for Function {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} · {}", self.factor, self.formula.name())
    }
}

#[cfg(feature = "serde")]
impl serde::Serialize for Function {
    fn serialize<S: serde::Serializer>(&self, _: S) -> Result<S::Ok, S::Error> {
        Err(serde::ser::Error::custom(
            "a drive has a user's own function of time, which has no name to be written by; write \
             the function's parameters beside the structure, and add the function with \
             `Drive::with_function` after reading",
        ))
    }
}
