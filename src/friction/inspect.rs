//! Inspection of a law over a range of speeds: faults that make motions wrong or end them.

use std::ops::Range;

use super::fault::LawFault;
use super::slope_zeros::{MOST_STRETCHES, Stretch};
use super::{FrictionLaw, Values, taylor_coefficients_on, validate};
use crate::error::Error;
use crate::numerics::sort::sort_by;
use crate::series::{PowerSeries, TERMS};

/// Checks a friction law over a range of sliding speeds, before motions with these speeds are
/// simulated. Returns the faults that would make a motion wrong or end the motion. The list is
/// empty if no fault is found.
///
/// For motions on a belt of velocity v_b, check the speeds from 0 to at least 2|v_b|. The largest
/// sliding speed of a limit cycle is
/// [`LimitCycle::max_sliding_speed`](crate::LimitCycle::max_sliding_speed).
///
/// The range is covered by a chain of power series of the law, each used within its radius of
/// convergence. The series are compared with the law's values at 4096 points of the range, and at
/// 16 or more points of each series. Features narrower than the distance between these points can
/// be missed.
///
/// A narrow feature is an interval of speeds in which the law differs from a power series that
/// agrees with it on both sides. A step of a motion can pass over such a feature. A power series
/// that begins close to a feature reproduces the feature and does not reveal it. The law is
/// therefore compared with series that begin at nine points of the range, upwards and downwards. A
/// feature at an end of the range is not reported, because it has only one side. A feature counts
/// as narrow if it fits between two speeds at which the integrator checks the law, in a motion
/// whose velocity amplitude is half the range. A bump exp(−((s − s_0)/w)²) at a speed s_0 inside
/// the range counts as narrow if w is less than about 1/85 of the range.
///
/// # Errors
///
/// * The errors of [`MassOnBelt::new`](crate::MassOnBelt::new) that concern the law;
/// * [`Error::InvalidParameter`] if the range does not satisfy 0 ≤ start < end ≤ 10¹⁰, or if
///   10 000 power series do not reach its end.
///
/// ```
/// use stick_slip::{FrictionLaw, LawFault, Polynomial, Scalar, check_law};
///
/// assert_eq!(check_law(&Polynomial::new(0.4, 0.25, 0.5)?, 0.0..2.0)?, []);
///
/// /// Friction that stops falling at the speed 0.5, which is not named as a breakpoint.
/// struct Kinked;
/// impl FrictionLaw for Kinked {
///     fn static_coefficient(&self) -> f64 {
///         0.4
///     }
///     fn kinetic<S: Scalar>(&self, speed: S) -> S {
///         if speed.value() < 0.5 { speed * -0.2 + 0.4 } else { speed.constant(0.3) }
///     }
/// }
/// let faults = check_law(&Kinked, 0.0..2.0)?;
/// let [LawFault::Kink { speed, slope_below, slope_above }] = faults[..] else { panic!() };
/// assert!((speed - 0.5).abs() < 1e-10);
/// assert_eq!((slope_below, slope_above), (-0.2, 0.0));
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[doc(alias = "validate")]
pub fn check_law<L: FrictionLaw>(law: &L, speeds: Range<f64>) -> Result<Vec<LawFault>, Error> {
    inspect(law, speeds)
}

fn inspect(law: &dyn Values, speeds: Range<f64>) -> Result<Vec<LawFault>, Error> {
    validate(law)?;
    let Range { start, end } = speeds;
    Error::check(
        "check_law",
        "speeds.start",
        start,
        start >= 0.0,
        "0 ≤ start < end",
    )?;
    Error::check(
        "check_law",
        "speeds.end",
        end,
        end > start && end <= LARGEST_SPEED,
        "start < end ≤ 1e10",
    )?;
    let mut inspection = Inspection {
        law,
        range: end - start,
        size: law.static_coefficient(),
        stretches: 0,
        negative_from: None,
        faults: Vec::new(),
    };
    let mut from = start;
    for (piece, to) in law.breakpoints().chain([f64::INFINITY]).enumerate() {
        let to = to.min(end);
        if from < to {
            inspection.piece(piece, from, to)?;
            inspection.features(piece, from, to);
            from = to;
        }
    }
    Ok(inspection.finish(end))
}

/// Largest speed of an inspection. At much larger speeds the powers of a series overflow.
const LARGEST_SPEED: f64 = 1e10;

/// Least number of points in the range at which the law is evaluated.
const PLACES: f64 = 4096.0;

/// Least number of points in each interval at which it is evaluated.
const PLACES_IN_STRETCH: f64 = 16.0;

/// Longest stretch of one series, in parts of the range: one radian of a motion whose velocity
/// amplitude is half the range.
const REACH: f64 = 0.5;

/// Distance of the integrator's checks of a step, in parts of its length.
const CHECKS: f64 = 0.25;

/// Number of intervals between the points over the range, and from the ends of each piece, from
/// which narrow features are searched in both directions. A series that begins near a feature shows
/// it in its coefficients; the steps of a motion may begin anywhere.
const STARTS: f64 = 8.0;

/// Shortest interval, in parts of the range: a series that converges over less indicates a fault.
const SHORTEST: f64 = 1e-10;

/// Distance, in shortest intervals, at which the search continues behind a point without a series.
const GAP: f64 = 64.0;

/// Largest difference of law and series that counts as rounding, relative to the largest
/// coefficient. The integrator's checks see about as much.
const MISFIT: f64 = 1e-12;

/// Largest difference of two neighbouring series where both hold, relative to the largest
/// coefficient.
const OVERLAP: f64 = 1e-9;

/// Least difference of the values on both sides of a gap that counts as a jump, relative to the
/// largest coefficient. An infinite slope, as of a square root, gives less.
const LEAST_JUMP: f64 = 1e-3;

/// Least difference of two slopes that counts as a kink, relative to the largest coefficient over
/// the range. Where a higher derivative jumps, the slopes differ by less at the place found.
const LEAST_KINK: f64 = 1e-5;

/// The search for faults.
struct Inspection<'l> {
    law: &'l dyn Values,
    /// Length of the range.
    range: f64,
    /// The largest coefficient met so far.
    size: f64,
    stretches: usize,
    /// The speed from which on the law is negative, if it is.
    negative_from: Option<f64>,
    faults: Vec<LawFault>,
}

impl Inspection<'_> {
    /// Inspects one piece of the law.
    fn piece(&mut self, piece: usize, start: f64, end: f64) -> Result<(), Error> {
        let mut at = start;
        let mut before: Option<Stretch> = None;
        while at < end {
            self.stretches += 1;
            let few = self.stretches <= MOST_STRETCHES;
            Error::check(
                "check_law",
                "speeds.end",
                end,
                few,
                "a shorter range: the law is too rough",
            )?;
            let c = taylor_coefficients_on::<TERMS>(self.law, piece, at);
            let series = PowerSeries::from_fn(|k| c[k]);
            if !series[0].is_finite() {
                at = self.not_finite(piece, at, end);
                before = None;
                continue;
            }
            self.size = self.size.max(series[0].abs());
            let mut stretch = Stretch {
                start: at,
                length: (REACH * self.range).min(end - at),
                piece,
                series,
            };
            let shortest = (SHORTEST * self.range).max(8.0 * f64::EPSILON * at);
            let least = shortest.min(end - at);
            while stretch.length >= least && !stretch.converges(self.size) {
                stretch.length *= 0.5;
            }
            if stretch.length < least || (0..TERMS).any(|k| !series[k].is_finite()) {
                at = self.without_series(piece, at, (at + GAP * shortest).min(end));
                before = None;
                continue;
            }
            let next = match self.first_difference(&stretch, end) {
                None => at + stretch.length,
                Some(beyond) => beyond,
            };
            stretch.length = next - at;
            if let Some(before) = before {
                self.compare(&before, &stretch);
            }
            self.signs(&stretch);
            before = Some(stretch);
            at = next.max(at.next_up());
            if at + least > end {
                at = end;
            }
        }
        Ok(())
    }

    /// Records the narrow features of one piece of the law: speeds at which it differs from a
    /// series that begins far away, and soon agrees with it again.
    fn features(&mut self, piece: usize, start: f64, end: f64) {
        let parts = (STARTS * ((end - start) / self.range)).ceil();
        for i in 0..=parts as usize {
            let at = (start + (end - start) * (i as f64 / parts)).min(end);
            let c = taylor_coefficients_on::<TERMS>(self.law, piece, at);
            let series = PowerSeries::from_fn(|k| c[k]);
            if c.iter().any(|c| !c.is_finite()) {
                continue;
            }
            for (direction, most) in [(1.0, end - at), (-1.0, at - start)] {
                let mut stretch = Stretch {
                    start: at,
                    length: most.min(REACH * self.range),
                    piece,
                    series,
                };
                let least = most.min(self.range / PLACES);
                while stretch.length >= least && !stretch.converges(self.size) {
                    stretch.length *= 0.5;
                }
                if most > 0.0 && stretch.length >= least {
                    self.features_along(&stretch, direction);
                }
            }
        }
    }

    /// Searches features along one series, up or down.
    fn features_along(&mut self, stretch: &Stretch, direction: f64) {
        let spacing = (self.range / PLACES).min(stretch.length / PLACES_IN_STRETCH);
        let step = direction * spacing;
        let mut feature = Vec::new();
        for i in 0..=(stretch.length / spacing) as usize {
            let difference = self.difference(stretch, i as f64 * step);
            if difference != 0.0 {
                feature.push(difference);
                continue;
            }
            let places = feature.len();
            if (1..i).contains(&places) && places as f64 * spacing < CHECKS * stretch.length {
                self.narrow(stretch.start + (i - places) as f64 * step, step, &feature);
            }
            feature.clear();
        }
    }

    /// The difference of the law's value from the series at the time t of an interval; 0 within
    /// rounding.
    fn difference(&self, stretch: &Stretch, t: f64) -> f64 {
        let speed = stretch.start + t;
        let steep = stretch.series.derivative().at(t).abs();
        let allowed = MISFIT * self.size + 4.0 * f64::EPSILON * speed * steep;
        let difference = (self.law.kinetic_on(stretch.piece, speed) - stretch.series.at(t)).abs();
        // NaN counts as a difference.
        if difference <= allowed {
            0.0
        } else {
            difference
        }
    }

    /// The first speed of an interval at which the law differs from the series, among the points of
    /// evaluation. Records a feature behind which they soon agree again.
    fn first_difference(&mut self, stretch: &Stretch, end: f64) -> Option<f64> {
        let spacing = (self.range / PLACES).min(stretch.length / PLACES_IN_STRETCH);
        let time = |i: usize| i as f64 * spacing;
        let last = (stretch.length / spacing).round() as usize;
        let far = 1.0 + CHECKS;
        let farthest = ((far * stretch.length).min(end - stretch.start) / spacing) as usize;
        let mut first = None;
        let mut feature = Vec::new();
        for i in 0..=farthest {
            let difference = self.difference(stretch, time(i));
            match first {
                None if difference != 0.0 => first = Some(i),
                None if i >= last => return None,
                None => continue,
                Some(start) if difference == 0.0 => {
                    if start > 0 && time(feature.len()) < CHECKS * stretch.length {
                        self.narrow(stretch.start + time(start), spacing, &feature);
                    }
                    break;
                }
                Some(_) => {}
            }
            feature.push(difference);
        }
        let first = first?;
        let (mut same, mut other) = (time(first.saturating_sub(1)), time(first));
        loop {
            let middle = 0.5 * (same + other);
            let speed = stretch.start + middle;
            if !(stretch.start + same < speed && speed < stretch.start + other) {
                return Some(stretch.start + other);
            }
            if self.difference(stretch, middle) == 0.0 {
                same = middle;
            } else {
                other = middle;
            }
        }
    }

    /// Records a narrow feature, given by its heights at points from `start` on.
    fn narrow(&mut self, start: f64, spacing: f64, heights: &[f64]) {
        let (mut place, mut highest) = (0, 0.0);
        for (i, &height) in heights.iter().enumerate() {
            if height > highest {
                (place, highest) = (i, height);
            }
        }
        let high = heights.iter().filter(|&&h| h > 0.5 * highest).count();
        self.faults.push(LawFault::Narrow {
            speed: start + place as f64 * spacing,
            width: high as f64 * spacing.abs(),
        });
    }

    /// Records a fault where two intervals meet, if the law below does not agree with the series
    /// above.
    fn compare(&mut self, below: &Stretch, above: &Stretch) {
        let back = 0.125 * below.length.min(above.length);
        let there = self.law.kinetic_on(above.piece, above.start - back);
        if (above.series.at(-back) - there).abs() <= OVERLAP * self.size {
            return;
        }
        let speed = above.start;
        let t = below.length;
        let (value, slope) = (below.series.at(t), below.series.derivative().at(t));
        self.faults
            .push(if (above.series[0] - value).abs() > OVERLAP * self.size {
                LawFault::Jump {
                    speed,
                    below: value,
                    above: above.series[0],
                }
            } else if (above.series[1] - slope).abs() * self.range > LEAST_KINK * self.size {
                LawFault::Kink {
                    speed,
                    slope_below: slope,
                    slope_above: above.series[1],
                }
            } else {
                LawFault::NotAnalytic { speed }
            });
    }

    /// Records a point at which the law has a value but no series, and returns the speed at which
    /// to continue.
    fn without_series(&mut self, piece: usize, speed: f64, behind: f64) -> f64 {
        let (below, above) = (
            self.law.kinetic_on(piece, speed),
            self.law.kinetic_on(piece, behind),
        );
        if (above - below).abs() > LEAST_JUMP * self.size {
            self.faults.push(LawFault::Jump {
                speed,
                below,
                above,
            });
        } else if above.is_finite() {
            self.faults.push(LawFault::NotAnalytic { speed });
        }
        behind
    }

    /// Records an interval on which the law has no finite value, and returns the speed behind it.
    fn not_finite(&mut self, piece: usize, start: f64, end: f64) -> f64 {
        let value = self.law.kinetic_on(piece, start);
        self.faults.push(LawFault::NotFinite {
            speed: start,
            value,
        });
        let spacing = self.range / PLACES;
        let mut behind = start + spacing;
        while behind < end && !self.law.kinetic_on(piece, behind).is_finite() {
            behind += spacing;
        }
        behind.min(end)
    }

    /// Records the speeds at which the law is negative along an interval.
    fn signs(&mut self, stretch: &Stretch) {
        let rounding = MISFIT * self.size;
        if stretch.series[0] < -rounding {
            self.negative_from.get_or_insert(stretch.start);
        } else if stretch.series[0] > rounding {
            self.positive_from(stretch.start);
        }
        stretch
            .series
            .sign_changes(stretch.length, &mut |t, rising| {
                if rising {
                    self.positive_from(stretch.start + t);
                } else if stretch.series.at(t + 1e-3 * stretch.length) < -rounding {
                    self.negative_from.get_or_insert(stretch.start + t);
                }
            });
    }

    /// Records the end, at this speed, of an interval on which the law is negative, if there is
    /// one.
    fn positive_from(&mut self, to: f64) {
        if let Some(from) = self.negative_from.take() {
            self.faults.push(LawFault::Negative { from, to });
        }
    }

    /// Returns all faults, once each, by ascending speed.
    fn finish(mut self, end: f64) -> Vec<LawFault> {
        self.positive_from(end);
        let place = |fault: &LawFault| match *fault {
            LawFault::Jump { speed, .. }
            | LawFault::Kink { speed, .. }
            | LawFault::NotAnalytic { speed }
            | LawFault::NotFinite { speed, .. }
            | LawFault::Narrow { speed, .. } => speed,
            LawFault::Negative { from, .. } => from,
        };
        let all = std::mem::take(&mut self.faults);
        let mut faults: Vec<LawFault> = Vec::new();
        for (i, fault) in all.iter().enumerate() {
            // A narrow feature may be a jump or a kink, and may be found from two stretches.
            let said = |other: &LawFault, near: f64| (place(other) - place(fault)).abs() <= near;
            let repeated = match *fault {
                LawFault::Narrow { width, .. } => {
                    let near = width.max(2.0 * self.range / PLACES);
                    all.iter().enumerate().any(|(j, other)| match other {
                        LawFault::Narrow { .. } => j < i && said(other, near),
                        LawFault::Negative { .. } => false,
                        _ => said(other, near),
                    })
                }
                _ => false,
            };
            if !repeated {
                faults.push(*fault);
            }
        }
        sort_by(&mut faults, place);
        faults
    }
}
