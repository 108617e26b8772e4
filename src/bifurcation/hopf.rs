use std::ops::{ControlFlow, Range};

use super::positive;
use crate::belt::MassOnBelt;
use crate::error::Error;
use crate::friction::{FrictionLaw, finite_at, taylor_coefficients};
use crate::scalar::LONGEST;
use crate::series::{PowerSeries, TERMS, quarters};

/// A series is used as far as its last terms stay below this, relative to its largest.
const TRUNCATION: f64 = 1e-16;

/// It must give h1 this well in between, relative to its largest term.
const DEFECT: f64 = 1e-12;

/// Rounding of h1, relative to the largest value met so far.
const ROUNDING: f64 = 1e-14;

/// Least number of series for a range.
const PIECES: f64 = 64.0;

/// The search begins this part below the range, so that a root exactly at its start is seen as one.
const LOOK_BACK: f64 = 1e-6;

/// Belt velocities in `range`, ascending, at which the equilibrium loses or regains stability:
/// where h1 changes sign,
///
/// ```text
/// h1(v) = 2β + γ² dμ̂/ds(v).
/// ```
///
/// The law is expanded in power series from one end of the range to the other, each used as far as
/// it converges and checked in between, and the roots of each are isolated, so that none is
/// skipped. Where h1 touches zero without changing sign, to rounding, nothing happens, and nothing
/// is reported. Where it jumps over zero, at a [breakpoint](FrictionLaw::breakpoints), that is
/// reported; where it is zero over a whole interval, the end of that interval, if the sign behind
/// it is another.
///
/// For the exponential law there is the closed form
/// [`analysis::exponential::hopf_velocities`](crate::analysis::exponential::hopf_velocities).
///
/// Source: Farshidianfar and Noei Aghaee, Eqs. 10a and 14, for any law.
///
/// # Errors
///
/// [`Error::InvalidParameter`] unless the range is finite, not empty and holds positive velocities,
/// and if it is so long that the law takes more than 10⁴ power series; [`Error::NonFiniteFriction`]
/// or [`Error::NotAnalytic`] if the law has no series somewhere in it.
///
/// ```
/// use stick_slip::{Exponential, MassOnBelt, bifurcation};
///
/// let system = MassOnBelt::new(Exponential::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let hopf = bifurcation::hopf_velocities(&system, 0.0..10.0)?;
/// assert_eq!(hopf.len(), 2);
/// assert!((hopf[0] - 0.0858251835248284677).abs() < 1e-15);
/// assert!((hopf[1] - 0.738553461542470176).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn hopf_velocities<L: FrictionLaw>(
    system: &MassOnBelt<L>,
    range: Range<f64>,
) -> Result<Vec<f64>, Error> {
    let range = positive(range)?;
    let mut v = range.start * (1.0 - LOOK_BACK);
    let longest = (range.end - v) / PIECES;
    let mut stretches = 0;
    let mut ends: Vec<f64> = system.law().breakpoints().collect();
    ends.retain(|&end| v < end && end < range.end);
    ends.push(range.end);
    let mut changes = SignChanges {
        h1: |v| system.effective_damping(v),
        positive: None,
        roots: Vec::new(),
    };
    let mut largest = 2.0 * system.damping();
    for end in ends {
        while v < end {
            Error::check(
                "range.end",
                range.end,
                stretches < MOST_STRETCHES,
                "a shorter range: it takes more than 10000 power series of the law to get there",
            )?;
            stretches += 1;
            let mut stretch = Stretch::new(system, v, longest.min(end - v), &mut largest)?;
            let ends_here = v + stretch.length >= end;
            if !ends_here {
                stretch.end_away_from_zero();
            }
            changes.follow(v, &stretch, ROUNDING * largest);
            v = if ends_here {
                end
            } else {
                (v + stretch.length).max(v.next_up())
            };
        }
    }
    changes.roots.retain(|root| range.contains(root));
    Ok(changes.roots)
}

/// h1(v + t) as a power series in t, for 0 ≤ t ≤ length.
struct Stretch {
    series: PowerSeries,
    length: f64,
}

impl Stretch {
    /// The series from v, at most `longest` far; `largest`, the largest |h1| met so far, is kept
    /// up.
    fn new<L: FrictionLaw>(
        system: &MassOnBelt<L>,
        v: f64,
        longest: f64,
        largest: &mut f64,
    ) -> Result<Self, Error> {
        finite_at(system.law(), v)?;
        let friction = taylor_coefficients::<LONGEST, _>(&system.law(), v);
        let mut series: PowerSeries =
            PowerSeries::from_fn(|k| system.load() * (k + 1) as f64 * friction[k + 1]);
        series[0] += 2.0 * system.damping();
        let mut stretch = Self {
            series,
            length: longest,
        };
        loop {
            let size = stretch.largest_term();
            *largest = largest.max(series[0].abs());
            let allowed = DEFECT * (size + 2.0 * system.damping())
                + ROUNDING * *largest
                + stretch.rounding_of_velocity(v);
            if stretch.converges(size + *largest * ROUNDING)
                && stretch.fits(allowed, |t| system.effective_damping(v + t))
            {
                return Ok(stretch);
            }
            stretch.length *= 0.5;
            if v + stretch.length <= v {
                finite_at(system.law(), v.next_up())?;
                return Err(Error::NotAnalytic {
                    speed: v,
                    reached: None,
                });
            }
        }
    }

    /// |c_k| length^k.
    fn term(&self, k: usize) -> f64 {
        match self.series[k] {
            // Not 0·∞.
            0.0 => 0.0,
            coefficient => coefficient.abs() * self.length.powi(k as i32),
        }
    }

    fn largest_term(&self) -> f64 {
        (0..TERMS).map(|k| self.term(k)).fold(0.0, f64::max)
    }

    /// What the rounding of v + t changes in h1.
    fn rounding_of_velocity(&self, v: f64) -> f64 {
        let steepest = (1..TERMS).map(|k| k as f64 * self.term(k)).sum::<f64>() / self.length;
        f64::EPSILON * (v + self.length) * steepest
    }

    /// Whether the last terms, two because a series may be even or odd, are rounding beside `size`.
    fn converges(&self, size: f64) -> bool {
        [TERMS - 2, TERMS - 1]
            .iter()
            .all(|&k| self.term(k) <= TRUNCATION * size)
    }

    /// Whether the series gives `h1` inside.
    fn fits(&self, allowed: f64, h1: impl Fn(f64) -> f64) -> bool {
        let times = quarters(self.length);
        std::iter::zip(times, self.series.at_four(times))
            // The end may be a breakpoint, where the slope is that of the next piece.
            .take(3)
            .all(|(t, value)| (h1(t) - value).abs() <= allowed)
    }

    /// Shortens it so that no root of h1 lies at its end, where the rounding of two series could
    /// lose it, or find it twice.
    fn end_away_from_zero(&mut self) {
        let ends = [1.0, 0.875, 0.75].map(|part| part * self.length);
        let height = |t: &f64| self.series.at(*t).abs();
        if let Some(end) = ends
            .into_iter()
            .max_by(|a, b| height(a).total_cmp(&height(b)))
        {
            self.length = end;
        }
    }
}

/// Stretches after which a search gives up, well within a second.
const MOST_STRETCHES: usize = 10_000;

/// Part of a stretch within which a root belongs to a zero at its end.
const AT_END: f64 = 1e-3;

/// Distance, relative to v, of two roots that may be a touch of zero split by rounding.
const TOUCH: f64 = 1e-6;

/// Where h1 changes its sign, as it is followed.
struct SignChanges<H> {
    h1: H,
    positive: Option<bool>,
    roots: Vec<f64>,
}

impl<H: Fn(f64) -> f64> SignChanges<H> {
    /// The sign changes on a stretch from v, and one at v itself if h1 jumps over zero there, or
    /// passes it.
    fn follow(&mut self, v: f64, stretch: &Stretch, rounding: f64) {
        let Stretch { series, length } = stretch;
        if stretch.largest_term() <= rounding {
            return; // zero all along
        }
        // A zero at an end is at v, or at the start of the next stretch.
        let is_zero = |t: f64| series.at(t).abs() <= rounding;
        let first = if is_zero(0.0) { AT_END * length } else { 0.0 };
        let last = if is_zero(*length) {
            (1.0 - AT_END) * length
        } else {
            *length
        };
        self.add(v, series.at(first) > 0.0, rounding);
        let _ = series.sign_changes(*length, &mut |t, rising| {
            if first <= t && t <= last {
                self.add(v + t, rising, rounding);
            }
            ControlFlow::Continue(())
        });
    }

    /// From v on the sign is this.
    fn add(&mut self, v: f64, positive: bool, rounding: f64) {
        let before = self.positive.replace(positive);
        if before.is_none_or(|before| before == positive) {
            return;
        }
        match self.roots.last() {
            // There and back within rounding.
            Some(&last)
                if v - last <= TOUCH * v && (self.h1)(0.5 * (last + v)).abs() <= rounding =>
            {
                self.roots.pop();
            }
            _ => self.roots.push(v),
        }
    }
}

/// How a pure-slip cycle is born at a Hopf point.
///
/// Source: the averaged equation A' = −½h1 A − (3/8)h3 A³ with h3 = γ² μ̂'''(v_b)/6 (Eq. 12 of
/// Farshidianfar and Noei Aghaee, for any law).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Criticality {
    /// A stable cycle surrounds the unstable equilibrium: μ̂'''(v_b) > 0.
    Supercritical,
    /// An unstable cycle surrounds the stable equilibrium: μ̂'''(v_b) < 0.
    Subcritical,
    /// The third derivative is zero, and higher ones decide; or it is not a number.
    Degenerate,
}

impl std::fmt::Display for Criticality {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(match self {
            Self::Supercritical => "supercritical",
            Self::Subcritical => "subcritical",
            Self::Degenerate => "degenerate",
        })
    }
}

/// Whether the Hopf point at the belt velocity v_b is super- or subcritical, from the sign of
/// μ̂'''(|v_b|).
///
/// That v_b is a Hopf point is not checked. At a breakpoint the piece above counts; where h1 jumps
/// over zero there, the third derivative says nothing.
///
/// ```
/// use stick_slip::bifurcation::{Criticality, criticality, hopf_velocities};
/// use stick_slip::{Exponential, MassOnBelt};
///
/// let system = MassOnBelt::new(Exponential::new(0.6, 0.3, 0.4)?, 1.0)?.with_damping(0.01)?;
/// let hopf = hopf_velocities(&system, 0.0..5.0)?;
/// assert_eq!(criticality(&system, hopf[0]), Criticality::Supercritical);
/// assert_eq!(criticality(&system, hopf[1]), Criticality::Subcritical);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn criticality<L: FrictionLaw>(system: &MassOnBelt<L>, belt_velocity: f64) -> Criticality {
    let third = system.law().derivative(3, belt_velocity.abs());
    if third > 0.0 {
        Criticality::Supercritical
    } else if third < 0.0 {
        Criticality::Subcritical
    } else {
        Criticality::Degenerate
    }
}
