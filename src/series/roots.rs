//! Roots of a power series over a step: the first one, or every sign change, none skipped.

use std::cell::Cell;
use std::ops::ControlFlow;

use super::{PowerSeries, quarters};

/// Error: the roots of a polynomial cannot be isolated in bounded work, because its coefficients
/// are far larger than its values, because it is very flat about a root, or because its values
/// overflow. Remedy: a shorter step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct TooCurved;

/// Divisions of intervals after which a search gives up. Two roots that are almost one take about a
/// hundred.
pub(super) const MOST_DIVISIONS: usize = 1000;

impl PowerSeries {
    /// The first time in (0, h], to the last bit, at which a polynomial that starts positive
    /// becomes zero or negative.
    ///
    /// `values` are the polynomial's values at the [`quarters`] of h.
    #[inline(always)]
    pub(crate) fn first_root(&self, h: f64, values: [f64; 4]) -> Result<Option<f64>, TooCurved> {
        self.first_root_by(h, values, self.curvature_bound(h))
    }

    /// Searches the [first root](Self::first_root) with a given bound of |c''| on [0, h].
    #[inline(always)]
    pub(crate) fn first_root_by(
        &self,
        h: f64,
        values: [f64; 4],
        curvature: f64,
    ) -> Result<Option<f64>, TooCurved> {
        if self.stays_away(h, values, curvature) {
            return Ok(None);
        }
        if !values.iter().all(|value| value.is_finite()) {
            return Err(TooCurved);
        }
        let mut root = None;
        let search = Search::new(self, h, curvature);
        let _ = search.run(h, values, &mut |t, rising| {
            if rising {
                return ControlFlow::Continue(());
            }
            root = Some(t);
            ControlFlow::Break(())
        });
        if search.divisions.get() < MOST_DIVISIONS {
            Ok(root)
        } else {
            Err(TooCurved)
        }
    }

    /// Calls `visit` with every time in (0, h] at which the polynomial changes sign, in order, and
    /// with `true` where it rises.
    pub(crate) fn sign_changes(&self, h: f64, visit: &mut dyn FnMut(f64, bool)) {
        let _ = self.search_sign_changes(h, &mut |t, rises| {
            visit(t, rises);
            ControlFlow::Continue(())
        });
    }

    /// Calls `visit` as [`sign_changes`](Self::sign_changes) does, until it stops the search.
    ///
    /// A root at t = 0 is not reported. After [`MOST_DIVISIONS`], in stiff systems, an interval
    /// counts as one with a sign change only if the signs at its ends differ.
    pub(crate) fn search_sign_changes(&self, h: f64, visit: Visit<'_>) -> ControlFlow<()> {
        let values = self.at_some(quarters(h));
        let curvature = self.curvature_bound(h);
        if self.stays_away(h, values, curvature) {
            return ControlFlow::Continue(());
        }
        Search::new(self, h, curvature).run(h, values, visit)
    }

    /// Returns true if the polynomial surely has no root on [0, h], as in most steps: at 0 and at
    /// the quarters of h it is farther from zero than it can bend in between.
    #[inline(always)]
    pub(super) fn stays_away(&self, h: f64, values: [f64; 4], curvature: f64) -> bool {
        let sign = self.0[0].signum();
        let least = values
            .iter()
            .fold(self.0[0].abs(), |least, value| least.min(sign * value));
        least > curvature * h * h / 128.0
    }
}

/// A function called at each sign change, in order of time, with its time and `true` if the
/// polynomial rises there.
type Visit<'v> = &'v mut dyn FnMut(f64, bool) -> ControlFlow<()>;

/// A search for the sign changes of a polynomial on [0, h].
///
/// No sign change is skipped, however close two lie. Let c have the values p and q at the ends of
/// an interval of width Δ. The interval is free of roots if p and q have one sign and min(|p|, |q|)
/// exceeds max|c''|·Δ²/8. It holds at most one root if |q − p| exceeds max|c''|·Δ²/2, because c is
/// then monotone. Any other interval is halved, until Δ is so small that c differs from its chord
/// by less than the rounding error of its values. There the computed signs at the ends decide, so
/// that a tangential touch within rounding is no root.
pub(super) struct Search<'c> {
    c: &'c PowerSeries,
    /// Bound of |c''|.
    curvature: f64,
    /// Bound of the rounding error of a computed value.
    rounding: f64,
    pub(super) divisions: Cell<usize>,
}

impl<'c> Search<'c> {
    #[inline(never)]
    pub(super) fn new(c: &'c PowerSeries, h: f64, curvature: f64) -> Self {
        Self {
            c,
            curvature,
            rounding: c.rounding_bound(h),
            divisions: Cell::new(0),
        }
    }

    pub(super) fn run(&self, h: f64, values: [f64; 4], visit: Visit<'_>) -> ControlFlow<()> {
        // A polynomial that starts at 0 is given the sign that it takes first, with a value so
        // small that it does not pass for a distance from 0.
        let start = if self.c[0] == 0.0 {
            let first = self.c.first_nonzero();
            first.map_or(0.0, |c| f64::MIN_POSITIVE.copysign(c))
        } else {
            self.c[0]
        };
        let mut left = (0.0, start);
        for right in std::iter::zip(quarters(h), values) {
            self.between(left, right, visit)?;
            left = right;
        }
        ControlFlow::Continue(())
    }

    /// Sign changes in (a, b], given the values there; zero counts as negative.
    fn between(
        &self,
        (a, at_a): (f64, f64),
        (b, at_b): (f64, f64),
        visit: Visit<'_>,
    ) -> ControlFlow<()> {
        let width = b - a;
        let changes = (at_a > 0.0) != (at_b > 0.0);
        let is_settled = |curvature: f64| {
            // Largest distance of c from its chord.
            let sagitta = curvature * width * width / 8.0;
            let monotone = (at_b - at_a).abs() > 4.0 * sagitta + 2.0 * self.rounding;
            let away = !changes && at_a.abs().min(at_b.abs()) > sagitta + self.rounding;
            away || monotone || sagitta <= self.rounding
        };
        let middle = 0.5 * (a + b);
        let exhausted = !(a < middle && middle < b) || self.divisions.get() >= MOST_DIVISIONS;
        let settled = is_settled(self.curvature) || exhausted || {
            // The bound on [0, b] is smaller than the one on all of [0, h], and worth its time only
            // where that one is too large.
            let curvature = self.c.curvature_bound(b);
            is_settled(curvature) || !curvature.is_finite()
        };
        if settled {
            return if changes {
                visit(self.refine((a, at_a), (b, at_b)), at_b > 0.0)
            } else {
                ControlFlow::Continue(())
            };
        }
        self.divisions.set(self.divisions.get() + 1);
        let at_middle = (middle, self.c.at(middle));
        self.between((a, at_a), at_middle, visit)?;
        self.between(at_middle, (b, at_b), visit)
    }

    /// The root between a and b, where c changes sign once: Newton's method kept inside the
    /// bracket.
    fn refine(&self, (mut a, at_a): (f64, f64), (mut b, at_b): (f64, f64)) -> f64 {
        let slope = self.c.derivative();
        let mut t = b + (b - a) * (at_b / (at_a - at_b));
        if t <= a {
            // The chord's zero is rounded to a: the root lies very close to a, or a is another
            // root, at the start.
            let newton = a - at_a / slope.at(a);
            t = if a <= newton && newton < b {
                newton.max(a.next_up())
            } else {
                0.5 * (a + b)
            };
        }
        let mut last = f64::INFINITY;
        // Bisection alone takes some 60 passes; Newton's method three or four.
        for _ in 0..128 {
            let value = self.c.at(t);
            if (value > 0.0) == (at_a > 0.0) {
                a = t;
            } else {
                b = t;
            }
            let slope_here = slope.at(t);
            let correction = value / slope_here;
            // Quadratic convergence ends where rounding takes over and corrections no longer
            // shrink.
            let settled = correction.abs() <= NEWTON_REGIME * t && correction.abs() >= 0.25 * last;
            if settled || correction.abs() <= 0.5 * f64::EPSILON * t {
                break;
            }
            let newton = t - correction;
            // Bound of the error of Newton's next place.
            let error = 0.5 * self.curvature * correction * correction / slope_here.abs();
            (t, last) = if a < newton && newton < b {
                // The second condition: t is not so much larger than the root that rounding of t
                // would count.
                if error <= 0.25 * f64::EPSILON * newton && correction.abs() <= 0.5 * newton {
                    return newton;
                }
                (newton, correction.abs())
            } else {
                (0.5 * (a + b), f64::INFINITY)
            };
        }
        t
    }
}

/// Relative correction below which Newton's method converges quadratically, unless rounding has
/// taken over.
const NEWTON_REGIME: f64 = 1e-8;
