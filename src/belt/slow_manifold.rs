//! The slow manifold of a stiff slip phase.
//!
//! If D = 2β + γ²dμ̂/ds is large, the sliding speed tends within the time 1/D to a slow manifold,
//! on which friction balances the other forces. The length of an explicit step is then about 10/D,
//! however slow the motion is, because the recurrence for the coefficients s_k amplifies a
//! deviation of s_0 by D^k/k!. The coefficients of the slow manifold are the solution that the
//! recurrence does not amplify, its *minimal solution*. Such a solution is not computed forward
//! from the start. All coefficients are computed together, with s_26 = 0 at the other end; here by
//! Newton's method, because friction is not linear. The truncation changes s_0 by about 26!/(D·R)²⁶
//! of itself, where R is the radius of convergence; this is less than rounding if D·R > 43. An
//! explicit step of accuracy ε has the length R/4 if accuracy limits it, and 10/D if stability
//! limits it; both are equal at D·R = 40. The series of the slow manifold are therefore exact for
//! stiffnesses above that at which explicit steps become short.
//!
//! Sources: F. W. J. Olver, Numerical solution of second-order linear difference equations, *J.
//! Res. NBS* 71B (1967) 111-129, doi:10.6028/jres.071B.018; W. Gautschi, Computational aspects of
//! three-term recurrence relations, *SIAM Review* 9 (1967) 24-82, doi:10.1137/1009002; NIST Digital
//! Library of Mathematical Functions, §3.6, <https://dlmf.nist.gov/3.6>.

use super::model::Belt;
use crate::clock::Time;
use crate::error::Error;
use crate::friction::slip_series::{Expander, Expansion, Known, SlipPoint, SlipSeries};
use crate::motion::step_control::Allowance;
use crate::series::{INTEGRAL, PowerSeries, TERMS};

/// Number of coefficients that are solved for: s_0 … s_25.
const UNKNOWNS: usize = TERMS - 1;

/// Distance from the slow manifold, in units of the error of a step, below which a motion has
/// reached the manifold.
///
/// The 26th root of the last term of an explicit step equals that of the error to 6 %, so the last
/// term is up to 1.06²⁶ = 4.5 errors. The deviation that remains after such a step is 0.4 of its
/// last term.
const CLOSE: f64 = 4.0;

/// Deviation from the slow manifold, in errors of a step, up to which the current series is tried.
const FAR_OFF: f64 = 1e4;

/// Limit of passes. Each doubles the number of correct coefficients; from one, five passes give all
/// of them.
const MOST_PASSES: usize = 8;

/// Size of coefficients, and of factors of them, above which bounds of a series overflow.
const LARGEST: f64 = 1e280;

/// Part of the step within which corrections count. Over the whole step the corrections of the last
/// coefficients, which hardly matter, would dominate.
const INNER: f64 = 0.8;

impl SlipSeries {
    /// The series of the slow manifold through the same displacement, if the motion has reached it,
    /// and the time over which it can be used. `self` is the explicit series, from `from`. Counts
    /// the series that are computed for it.
    pub(super) fn slow(
        &self,
        piece: usize,
        system: &Belt<'_>,
        expander: &mut Expander,
        from: &SlipPoint,
        time: Time,
        allowance: &Allowance,
    ) -> Option<(Self, f64)> {
        let (slow, speed) = (Slow::new(system, from, time), from.speed);
        let equation = system.equation(from.direction);
        // The series of the friction along a given series of the sliding speed.
        let mut compose = |c: &PowerSeries| -> Result<Self, Error> {
            expander.passes += 1;
            // Cleared, because the last coefficient of the explicit series is not overwritten here.
            expander.series = Self::ZERO;
            system.law().expand_slip(Expansion {
                expander: &mut *expander,
                piece,
                equation: &equation,
                from,
                time,
                known: Known::Speed(c),
            })?;
            Ok(expander.series)
        };
        let closing = time.sign() * self.decay;
        let unit = slow.unit(speed, closing);
        let mut c = slow.guess(&self.speed, closing, unit, allowance.error);
        let close = CLOSE * allowance.error.max(f64::EPSILON * speed);
        let farthest = Allowance::farthest(closing) / unit;
        for pass in 0..MOST_PASSES {
            let composed = compose(&c).ok()?;
            let correction = slow.correction(&c, &composed, unit);
            // The first correction is already the distance, as far as it is small: a motion that is
            // still on its way costs one pass.
            let has_come = correction[0].abs() <= close;
            if pass == 0 && !has_come {
                return None;
            }
            let mut inner = 1.0;
            let mut largest = 0.0;
            for (k, correction) in correction.iter().enumerate().take(UNKNOWNS) {
                c[k] += correction;
            }
            let reach = allowance.reach_of(&c, UNKNOWNS - 1, farthest);
            for correction in &correction[..UNKNOWNS] {
                // Not f64::max, which would drop a NaN.
                largest += correction.abs() * inner;
                inner *= INNER * reach;
            }
            // Rounding displaces s_0 by ε s_0 and, near a node, the whole motion by ε s_0
            // exp(−t/D). The absolute values of the terms of this exponential sum to exp(t/D).
            let passed_on = (INNER * reach * unit / closing).exp();
            if largest <= close * passed_on {
                if (c[0] - speed).abs() > 2.0 * close {
                    return None;
                }
                // The next correction would be the square of this one.
                return compose(&c).ok()?.in_time(unit, allowance, farthest * unit);
            }
        }
        None
    }

    /// A series in units of time `unit` as one in time, and the time over which it can be used.
    fn in_time(mut self, unit: f64, allowance: &Allowance, farthest: f64) -> Option<(Self, f64)> {
        let mut power = 1.0;
        let mut order = 0;
        for k in 0..UNKNOWNS {
            if power < LARGEST && power.recip() < LARGEST {
                self.speed[k] /= power;
                self.friction[k] /= power;
                order = k;
            } else {
                self.speed[k] = 0.0;
                self.friction[k] = 0.0;
            }
            power *= unit;
        }
        (order >= 2).then(|| (self, allowance.reach_of(&self.speed, order, farthest)))
    }

    /// Drops coefficients that overflow, by a rule that is independent of the unit of length;
    /// returns the highest order that remains.
    #[cold]
    pub(super) fn truncate(&mut self) -> usize {
        // All three vanish only at an equilibrium.
        let by_decay = |s: f64, power| (s / self.decay.powi(power)).abs();
        let [a, b, c] = [0, 1, 2].map(|k| by_decay(self.speed[k as usize], k));
        let size = a.max(b).max(c);
        let most = (LARGEST * 1e-20 * size).min(LARGEST);
        let mut left = 0;
        for k in 0..TERMS {
            let is_ordinary = self.speed[k].abs() <= most && self.friction[k].abs() < LARGEST;
            if is_ordinary && left == k {
                left += 1;
            } else {
                self.speed[k] = 0.0;
                self.friction[k] = 0.0;
            }
        }
        left.saturating_sub(1)
    }
}

/// The equations of the coefficients, in the direction of time in use:
///
/// ```text
/// (k + 1) s_{k+1} + x_k + 2β (s_k + σv_b [k = 0]) + γ² m_k = 0
/// x_1 = s_0 + σv_b,   x_k = s_{k−1}/k
/// ```
///
/// with x_0 = σu, β and γ² of the other sign backward in time.
struct Slow {
    /// Sign of time: 1, or −1 backward in time.
    forward: f64,
    position: f64,
    belt: f64,
    damping: f64,
    load: f64,
}

impl Slow {
    fn new(system: &Belt<'_>, from: &SlipPoint, time: Time) -> Self {
        let (sigma, forward) = (from.direction.sign(), time.sign());
        Self {
            forward,
            position: forward * sigma * from.displacement,
            belt: sigma * system.belt_velocity(),
            damping: forward * 2.0 * system.damping(),
            load: forward * system.load(),
        }
    }

    /// A unit of time T, a power of two, in which the coefficients are of similar size: the time in
    /// which the slow motion, s' ≈ −v/D, changes s significantly, and u − ū decays to a part.
    fn unit(&self, speed: f64, closing: f64) -> f64 {
        let time = (speed * closing / (speed + self.belt).abs()).min(closing);
        const EXPONENT: u64 = 0x7ff << 52;
        f64::from_bits(time.to_bits() & EXPONENT)
    }

    /// The first coefficients of the explicit series, up to the order at which a deviation hides
    /// those of the slow manifold. Then one correction gives s_0 to the square of the deviation.
    fn guess(&self, explicit: &PowerSeries, closing: f64, unit: f64, error: f64) -> PowerSeries {
        let mut c = PowerSeries::ZERO;
        c[0] = explicit[0];
        c[1] = -(explicit[0] + self.belt) / closing * unit;
        let (mut power, mut deviation) = (1.0, FAR_OFF * error);
        for k in 1..UNKNOWNS {
            power *= unit;
            deviation *= closing * unit / k as f64;
            let coefficient = explicit[k] * power;
            let is_seen = deviation <= 0.5 * coefficient.abs();
            if !is_seen {
                break;
            }
            c[k] = coefficient;
        }
        c
    }

    /// Newton's correction of the coefficients c, with their friction composed: the solution of
    ///
    /// ```text
    /// (k + 1) δ_{k+1} + Σ_{j≤k} D_j δ_{k−j} + δ_{k−1}/k = −r_k,   δ_26 = 0,
    /// D(t) = 2β + γ² m'(t)/s'(t)
    /// ```
    fn correction(&self, c: &PowerSeries, composed: &SlipSeries, unit: f64) -> [f64; TERMS] {
        let m = &composed.friction;
        let decay = self.decays(c, composed);
        let mut right = [0.0; UNKNOWNS];
        for k in 0..UNKNOWNS {
            let spring = match k {
                0 => self.position,
                1 => unit * (c[0] + self.belt),
                _ => unit * c[k - 1] * INTEGRAL[k - 1],
            };
            let speed = if k == 0 { c[0] + self.belt } else { c[k] };
            let rate = (k + 1) as f64 * c[k + 1] / unit;
            right[k] = -(rate + spring + self.damping * speed + self.load * m[k]);
        }
        // Rows from the last one up lose what stands above the diagonal.
        let mut rows = [[0.0; UNKNOWNS]; UNKNOWNS];
        for (k, row) in rows.iter_mut().enumerate() {
            for j in 0..=k {
                row[k - j] = decay[j];
            }
            if k > 0 {
                row[k - 1] += unit * INTEGRAL[k - 1];
            }
        }
        for k in (1..UNKNOWNS).rev() {
            let (above, below) = rows.split_at_mut(k);
            let (above, below) = (&mut above[k - 1], &below[0]);
            let factor = k as f64 / (unit * below[k]);
            for (a, b) in std::iter::zip(&mut above[..k], &below[..k]) {
                *a -= factor * b;
            }
            right[k - 1] -= factor * right[k];
        }
        let mut correction = [0.0; TERMS];
        for k in 0..UNKNOWNS {
            let known = std::iter::zip(&rows[k][..k], &correction[..k]);
            let sum: f64 = known.map(|(a, d)| a * d).sum();
            correction[k] = (right[k] - sum) / rows[k][k];
        }
        correction
    }

    /// The series of D, by division.
    fn decays(&self, c: &PowerSeries, composed: &SlipSeries) -> [f64; UNKNOWNS] {
        let (friction, rate) = (composed.friction.derivative(), c.derivative());
        let mut decay = [0.0; UNKNOWNS];
        decay[0] = self.forward * composed.decay;
        if rate[0] != 0.0 {
            for j in 1..UNKNOWNS - 1 {
                let by_law = decay[0] - self.damping;
                let later: f64 = (1..j).map(|i| rate[i] * decay[j - i]).sum();
                decay[j] = (self.load * friction[j] - later - rate[j] * by_law) / rate[0];
            }
        }
        decay
    }
}
