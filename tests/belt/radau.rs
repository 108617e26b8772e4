//! An implicit integrator for stiff slip, that shares nothing with the crate's: Radau IIA with five
//! stages (order 9), Newton's method on the stages, steps checked by their halves.
//!
//! Its errors are measured in the sliding speed itself and in u itself, not in any scale of the
//! motion. Contacts and breakpoints are met by shortening the step, so there is no dense output.

use stick_slip::{FrictionLaw, MassOnBelt, State};

use crate::common::radau::{Matrix, STAGES, Stages, solve, weights};
use crate::common::simple::Seen;

/// The method, and how exact its steps are.
#[derive(Debug, Clone)]
pub(crate) struct Radau {
    a: Matrix,
    /// A².
    a2: Matrix,
    /// Error of a step that is taken, in parts of s and of u.
    tolerance: f64,
}

impl Radau {
    pub(crate) fn new(tolerance: f64) -> Self {
        let a = weights();
        let product = |i: usize, k: usize| (0..STAGES).map(|j| a[i][j] * a[j][k]).sum();
        Self {
            a,
            a2: std::array::from_fn(|i| std::array::from_fn(|k| product(i, k))),
            tolerance,
        }
    }
}

/// A slip phase of one system, on one side of the belt: x = σu and s.
struct Slip<'s, L> {
    system: &'s MassOnBelt<L>,
    sigma: f64,
    piece: usize,
}

type Point = [f64; 2];

impl<L: FrictionLaw> Slip<'_, L> {
    fn belt(&self) -> f64 {
        self.sigma * self.system.belt_velocity()
    }

    fn friction(&self, s: f64) -> f64 {
        let law = self.system.law();
        self.system.load() * law.kinetic_on(self.piece, s.max(0.0))
    }

    /// γ²dμ̂/ds, good enough for Newton's method.
    fn slope(&self, s: f64) -> f64 {
        let h = 1e-6 * s.abs().max(1e-300);
        (self.friction(s + h) - self.friction(s - h)) / (2.0 * h)
    }

    /// What rounding of the forces may shift s by within a step of length h.
    fn rounding(&self, [x, s]: Point, h: f64) -> f64 {
        let damping = 2.0 * self.system.damping();
        let forces = x.abs() + damping * (s + self.belt()).abs() + self.friction(s).abs();
        let decay = (damping + self.slope(s)).abs();
        8.0 * f64::EPSILON * forces * h.min(1.0 / decay)
    }

    fn rate(&self, [x, s]: Point) -> f64 {
        -x - 2.0 * self.system.damping() * (s + self.belt()) - self.friction(s)
    }

    /// One step, if Newton's method converges.
    fn step(&self, method: &Radau, [x, s]: Point, h: f64) -> Option<Point> {
        let mut stages = [s; STAGES];
        let damping = 2.0 * self.system.damping();
        let sum = |row: &Stages, of: &Stages| -> f64 {
            std::iter::zip(row, of).map(|(a, b)| a * b).sum()
        };
        let rounding = self.rounding([x, s], h);
        let mut last = f64::INFINITY;
        for _ in 0..30 {
            let speeds = stages.map(|s| s + self.belt());
            let place: Stages = std::array::from_fn(|i| x + h * sum(&method.a[i], &speeds));
            let rates = std::array::from_fn(|i| self.rate([place[i], stages[i]]));
            let slopes = stages.map(|s| damping + self.slope(s));
            let residual: Stages =
                std::array::from_fn(|i| s + h * sum(&method.a[i], &rates) - stages[i]);
            let jacobian: Matrix = std::array::from_fn(|i| {
                std::array::from_fn(|k| {
                    let unit = if i == k { 1.0 } else { 0.0 };
                    unit + h * h * method.a2[i][k] + h * method.a[i][k] * slopes[k]
                })
            });
            let correction = solve(jacobian, residual);
            let mut change = 0.0_f64;
            for (stage, d) in std::iter::zip(&mut stages, correction) {
                *stage += d;
                let beyond = (d.abs() - rounding).max(0.0);
                change = change.max(beyond / stage.abs().max((*stage - s).abs()));
            }
            if stages.iter().any(|s| !s.is_finite()) {
                return None;
            }
            if change <= 1e-15 || (change < 1e-10 && change >= 0.25 * last) {
                let speeds = stages.map(|s| s + self.belt());
                let end = x + h * sum(&method.a[STAGES - 1], &speeds);
                return Some([end, stages[STAGES - 1]]);
            }
            last = change;
        }
        None
    }

    /// Two steps of half the length, and how much one differs from them in parts of s and of u.
    fn checked(&self, method: &Radau, from: Point, h: f64) -> Option<(Point, f64)> {
        let whole = self.step(method, from, h)?;
        let middle = self.step(method, from, 0.5 * h)?;
        let end = self.step(method, middle, 0.5 * h)?;
        let rounding = self.rounding(from, h).max(self.rounding(end, h));
        let apart = |i: usize, rounding: f64| {
            let size = end[i].abs().max((end[i] - from[i]).abs());
            ((whole[i] - end[i]).abs() - rounding).max(0.0) / size
        };
        let error = apart(0, rounding * h).max(apart(1, rounding));
        // The halves are more exact than the whole by this.
        Some((end, error / 256.0))
    }
}

/// Where a motion ends, and what was seen on the way.
#[derive(Debug, Clone)]
pub(crate) struct Motion {
    pub(crate) end: State,
    /// |v − v_b|, exact where it is small.
    pub(crate) speed: f64,
    pub(crate) seen: Vec<Seen>,
    pub(crate) steps: usize,
}

impl Radau {
    /// Follows a motion; `None` if more than `most` steps do not do, or no step does.
    pub(crate) fn run<L: FrictionLaw>(
        &self,
        system: &MassOnBelt<L>,
        start: State,
        duration: f64,
        most: usize,
    ) -> Option<Motion> {
        let v_b = system.belt_velocity();
        let [low, high] = system.stick_limits();
        let breakpoints: Vec<f64> = system.law().breakpoints().collect();
        let relative = start.velocity - v_b;
        let (mut u, mut speed) = (start.displacement, relative.abs());
        let outside = |u: f64| {
            if u > high || (u == high && v_b > 0.0) {
                -1.0
            } else if u < low || (u == low && v_b < 0.0) {
                1.0
            } else {
                0.0
            }
        };
        let mut side = if relative == 0.0 {
            outside(u)
        } else {
            relative.signum()
        };
        let mut time = 0.0;
        let mut h = 1e-3_f64;
        let mut seen = Vec::new();
        if side == -v_b.signum() && speed == 0.0 && u == if v_b > 0.0 { high } else { low } {
            seen.push((0.0, 'r', side));
        }
        for steps in 0..most {
            let stop = |speed: f64, u: f64, side: f64, seen: Vec<Seen>| {
                let end = State::new(u, v_b + side * speed);
                Some(Motion {
                    end,
                    speed,
                    seen,
                    steps,
                })
            };
            if time >= duration {
                return stop(speed, u, side, seen);
            }
            if side == 0.0 {
                let release = if v_b > 0.0 { high } else { low };
                let wait = (release - u) / v_b;
                if v_b == 0.0 || time + wait > duration {
                    return stop(0.0, u + v_b * (duration - time), 0.0, seen);
                }
                time += wait;
                (u, speed, side) = (release, 0.0, -v_b.signum());
                seen.push((time, 'r', side));
                h = 1e-6;
                continue;
            }
            let above = breakpoints.partition_point(|b| *b <= speed);
            let at = above > 0 && breakpoints[above - 1] == speed;
            let mut slip = Slip {
                system,
                sigma: side,
                piece: above,
            };
            if at && slip.rate([side * u, speed]) < 0.0 {
                slip.piece -= 1;
            }
            let bottom = if slip.piece == 0 {
                0.0
            } else {
                breakpoints[slip.piece - 1]
            };
            let top = breakpoints
                .get(slip.piece)
                .copied()
                .unwrap_or(f64::INFINITY);
            let from = [side * u, speed];
            let left = duration - time;
            h = h.min(left);
            let (end, mut used) = loop {
                if h.is_nan() || h <= 1e-30 {
                    return None;
                }
                match slip.checked(self, from, h) {
                    Some((end, error)) if error <= self.tolerance => {
                        let used = h;
                        let grow = (self.tolerance / error.max(1e-30)).powf(0.1);
                        h *= (0.8 * grow).clamp(0.5, 3.0);
                        break (end, used);
                    }
                    Some((end, error)) if error.is_finite() && end[1].is_finite() => {
                        let shrink = (self.tolerance / error).powf(0.1);
                        h *= (0.8 * shrink).clamp(0.1, 0.7);
                    }
                    _ => h *= 0.25,
                }
            };
            let mut end = end;
            let beyond = |s: f64| s < bottom || s > top || (s == bottom && speed > bottom);
            let mut reached = None;
            if beyond(end[1]) {
                let level = if end[1] <= bottom { bottom } else { top };
                // The length of the step that ends on the level, by halving and secants.
                let (mut a, mut b) = (0.0, used);
                let sign = (end[1] - level).signum();
                for _ in 0..200 {
                    let middle = 0.5 * (a + b);
                    if middle <= a || middle >= b {
                        break;
                    }
                    let there = slip.step(self, from, middle)?;
                    if (there[1] - level) * sign >= 0.0 {
                        b = middle;
                    } else {
                        a = middle;
                    }
                    if b - a <= 1e-16 * (time + b) {
                        break;
                    }
                }
                let (there, error) = slip.checked(self, from, b)?;
                if error > self.tolerance && b > 1e-12 * time {
                    h = 0.5 * b;
                    continue;
                }
                (end, used) = (there, b);
                end[1] = level;
                reached = Some(level);
                h = used;
            }
            time = if used == left { duration } else { time + used };
            (u, speed) = (side * end[0], end[1]);
            if reached == Some(0.0) {
                let next = outside(u);
                if next != side {
                    seen.push((time, if next == 0.0 { 's' } else { 'c' }, next));
                }
                side = next;
                h = h.max(1e-6);
            }
        }
        None
    }
}
