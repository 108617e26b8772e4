//! One Taylor step of a slip phase: the series, how far it reaches, and whether it held.

use super::polynomial::{INTEGRAL, Polynomial, TERMS, derivative, evaluate, evaluate_four};
use crate::friction::FrictionLaw;
use crate::scalar::{Workspace, expand, mul_add};
use crate::{Direction, Error, MassOnBelt, State};

/// A point of a slip phase.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SlipPoint {
    /// σ, the sign of v_r.
    pub(crate) direction: Direction,
    /// u.
    pub(crate) displacement: f64,
    /// s = |v_r|.
    pub(crate) speed: f64,
    /// ds/dt, in the direction of time that is followed, where it is known better than the equation
    /// of motion gives it: on the belt, and at an extremum of v.
    pub(crate) rate: Option<f64>,
}

impl SlipPoint {
    /// On the belt, with the rate that the equation of motion gives.
    pub(crate) fn on_belt(displacement: f64, direction: Direction) -> Self {
        Self {
            direction,
            displacement,
            speed: 0.0,
            rate: None,
        }
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

/// The power series of a slip phase about one of its points, in the time since.
///
/// With σ = ±1 and x = σu the equations of slip are
///
/// ```text
/// x' = s + σv_b,   s' = −x − 2β(s + σv_b) − γ²μ̂(s),
/// ```
///
/// in the sliding speed s and not in v, so that contact is exact however large the belt velocity
/// is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Series {
    /// s(t).
    pub(crate) speed: Polynomial,
    /// μ̂(s(t)), without its last coefficient, which the motion does not need.
    friction: Polynomial,
}

impl Series {
    pub(crate) const ZERO: Self = Self {
        speed: [0.0; TERMS],
        friction: [0.0; TERMS],
    };

    /// Expands the motion about a point, on one piece of the law.
    ///
    /// The law comes as an argument of its own: behind a reference inside the system, the compiler
    /// would have to load its parameters anew after every coefficient stored.
    ///
    /// In place: a copy would load what has just been stored, and wait for it. Kept out of line:
    /// inlined into the stepper, it competes for registers and runs at half the speed.
    #[inline(never)]
    pub(crate) fn expand<L: FrictionLaw>(
        &mut self,
        law: &L,
        system: &MassOnBelt<&L>,
        workspace: &mut Workspace<TERMS>,
        from: &SlipPoint,
        piece: usize,
        time: Time,
    ) -> Result<(), Error> {
        let sigma = from.direction.sign();
        let (damping, load) = (2.0 * system.damping(), system.load());
        let belt = sigma * system.belt_velocity();
        let Self {
            speed: series,
            friction,
        } = self;

        let s0 = from.speed;
        // (k + 1) s_{k+1} = −x_k − 2β s_k − γ² m_k, where x_k = s_{k−1}/k and m_k = slope·s_k +
        // scale·rest. The rest is put in last: it has waited for s_{k−1} to pass through the law,
        // and that takes longer than s_k.
        let (mut decay, mut older) = (0.0, 0.0);
        let (value, slope) = expand(law, piece, workspace, s0, |k, s, m| {
            series[k] = s;
            let weight = -INTEGRAL[k];
            if k == 0 {
                decay = mul_add(load, m.slope, damping);
                friction[0] = m.rest;
                older = s + belt;
                let equation = -(sigma * from.displacement) - damping * (s + belt) - load * m.rest;
                return from.rate.map_or(equation, |rate| time.sign() * rate);
            }
            friction[k] = mul_add(m.slope, s, m.scale * m.rest);
            // x_1 = s_0 + σv_b
            let spring = if k == 1 {
                weight * older
            } else {
                weight * INTEGRAL[k - 1] * older
            };
            older = s;
            let next = mul_add(weight * decay, s, spring);
            let next = mul_add(weight * load * m.scale, m.rest, next);
            if k + 1 == TERMS - 1 {
                series[k + 1] = next;
            }
            next
        });
        if !value.is_finite() {
            return Err(Error::NonFiniteFriction {
                speed: s0,
                value,
                reached: None,
            });
        }
        if !slope.is_finite() {
            return Err(Error::NotAnalytic {
                speed: s0,
                reached: None,
            });
        }
        if time == Time::Backward {
            // f(−t): the odd coefficients change sign.
            for k in (1..TERMS).step_by(2) {
                series[k] = -series[k];
                friction[k] = -friction[k];
            }
        }
        Ok(())
    }

    /// |u| + 2β|v| + γ²μ̂ at the start: what the rounding errors of the equation of motion are measured by.
    #[inline(always)]
    pub(crate) fn largest_term<L>(&self, system: &MassOnBelt<L>, state: State) -> f64 {
        state.displacement.abs()
            + 2.0 * system.damping() * state.velocity.abs()
            + system.load() * self.friction[0].abs()
    }

    /// Largest |γ²[μ̂(s(t)) − m(t)]| at four times, where s(t) has the values `speeds`: the defect
    /// of the series, up to terms as small as its last.
    ///
    /// Coefficients alone miss what lies hidden behind an underflow, such as the flank of a narrow
    /// Gaussian.
    #[inline(always)]
    pub(crate) fn defect<L: FrictionLaw>(
        &self,
        system: &MassOnBelt<L>,
        piece: usize,
        times: [f64; 4],
        speeds: [f64; 4],
    ) -> f64 {
        let friction = evaluate_four(&self.friction, times);
        let mut largest = 0.0;
        for (s, m) in std::iter::zip(speeds, friction) {
            let difference = (system.law().kinetic_on(piece, s.max(0.0)) - m).abs();
            // Not f64::max, which would drop a NaN.
            largest = if largest >= difference {
                largest
            } else {
                difference + 0.0 * largest
            };
        }
        system.load() * largest
    }

    /// The same about the places where the motion comes closest to the belt within a step of length
    /// h, if it does; `speeds` are its values at the [`quarters`] of h. The law may have a feature
    /// at slow speeds that is passed between two of them.
    #[inline(always)]
    pub(crate) fn defect_at_minimum<L: FrictionLaw>(
        &self,
        system: &MassOnBelt<L>,
        piece: usize,
        h: f64,
        speeds: [f64; 4],
    ) -> f64 {
        let (start, [a, b, c, d]) = (self.speed[0], speeds);
        // At the end by the parabola of fourth degree through the five values.
        let at_end = (25.0 * d - 48.0 * c + 36.0 * b - 16.0 * a + 3.0 * start) / 12.0;
        // ds/dt·h/4 at the PARTS of the step.
        let start_slope = 0.25 * h * self.speed[1];
        let slopes = [start_slope, a - start, b - a, c - b, d - c, at_end];
        if slopes.windows(2).any(is_turn) {
            self.defect_near_minima(system, piece, h, slopes)
        } else {
            0.0
        }
    }

    #[inline(never)]
    fn defect_near_minima<L: FrictionLaw>(
        &self,
        system: &MassOnBelt<L>,
        piece: usize,
        h: f64,
        slopes: [f64; 6],
    ) -> f64 {
        const PARTS: [f64; 6] = [0.0, 0.125, 0.375, 0.625, 0.875, 1.0];
        const MOST_PASSES: usize = 10;
        /// Part of a step; the next correction would be far smaller.
        const CLOSE: f64 = 1e-3;
        let slope = derivative(&self.speed);
        let curvature = derivative(&slope);
        let mut largest = 0.0;
        for (slopes, parts) in std::iter::zip(slopes.windows(2), PARTS.windows(2)) {
            if !is_turn(slopes) {
                continue;
            }
            let [mut left, mut right] = [parts[0] * h, parts[1] * h];
            let mut t = left + (right - left) * slopes[0] / (slopes[0] - slopes[1]);
            // Newton's method, and halving where it would leave the stretch.
            for _ in 0..MOST_PASSES {
                let slope_here = evaluate(&slope, t);
                if slope_here > 0.0 {
                    right = t;
                } else {
                    left = t;
                }
                let newton = t - slope_here / evaluate(&curvature, t);
                let last = t;
                t = if left <= newton && newton <= right {
                    newton
                } else {
                    0.5 * (left + right)
                };
                if (t - last).abs() <= CLOSE * h {
                    break;
                }
            }
            let about = [-0.05, 0.0, 0.02, 0.1].map(|part| (t + part * h).clamp(0.0, h));
            // Not f64::max, which would drop a NaN.
            largest += self.defect(system, piece, about, evaluate_four(&self.speed, about));
        }
        largest
    }

    /// The same in between, at least every quarter of a radian, in a step of length h > [`LONG`]:
    /// where the law is flat, a step may pass over a whole feature of it.
    #[inline(never)]
    pub(crate) fn defect_in_between<L: FrictionLaw>(
        &self,
        system: &MassOnBelt<L>,
        piece: usize,
        h: f64,
    ) -> f64 {
        let fours = h.ceil().min(MOST_FOURS);
        let part = 0.25 * h / fours;
        let mut largest = 0.0;
        for i in 0..fours as usize {
            let start = i as f64 * 4.0 * part;
            let times = [0.5, 1.5, 2.5, 3.5].map(|place| start + place * part);
            // Not f64::max, which would drop a NaN.
            largest += self.defect(system, piece, times, evaluate_four(&self.speed, times));
        }
        largest
    }
}

/// A step longer than this, in radians of the undamped oscillator, is looked at in more than four
/// places; few are.
pub(crate) const LONG: f64 = 1.0;

/// Most fours of such places. Steps longer than three radians are those of motions that hardly
/// move.
const MOST_FOURS: f64 = 16.0;

/// Whether a function has a minimum between two places, by its slopes there.
#[inline(always)]
fn is_turn(slopes: &[f64]) -> bool {
    slopes[0] < 0.0 && slopes[1] >= 0.0
}

#[cfg(test)]
mod tests;
