//! The slip phase under constant kinetic friction: a part of a damped free vibration.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::numerics::bracket::root_between;

/// The damping ratio below which θ = √(4πβ) and Λ = 1/θ to rounding: relative errors are O(β).
pub(super) const SMALL: f64 = 1e-17;

/// A stick-slip cycle under constant kinetic friction, in closed form except for one scalar root.
///
/// The slip phase is a damped free vibration about the displacement at which kinetic friction
/// balances the spring. At the start and at the end of slip the mass has the velocity of the belt.
/// All units are those of the system. If `belt_velocity` is negative, `release_displacement` and
/// `contact_displacement` have the opposite signs of those for −`belt_velocity`.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct ExactCycle {
    /// Belt velocity.
    pub belt_velocity: f64,
    /// Duration θ of stick.
    pub stick_duration: f64,
    /// Duration of slip.
    pub slip_duration: f64,
    /// Displacement at the release, where slip begins.
    pub release_displacement: f64,
    /// Displacement at which the mass reaches the belt velocity again and slip ends.
    pub contact_displacement: f64,
    /// Half the distance between the largest and the least displacement.
    pub amplitude: f64,
    /// Largest sliding speed |v − v_b|.
    pub max_sliding_speed: f64,
    /// Floquet multiplier of a perturbation of the release displacement, dimensionless. A shift in
    /// time has the multiplier 1. All other multipliers are 0, because stick removes these
    /// perturbations.
    pub multiplier: f64,
}

impl ExactCycle {
    /// Period: stick and slip together.
    pub fn period(&self) -> f64 {
        self.stick_duration + self.slip_duration
    }

    /// Returns true if small perturbations decay: |multiplier| < 1.
    pub fn is_stable(&self) -> bool {
        self.multiplier.abs() < 1.0
    }
}

/// One mass on a spring and a damper, with constant kinetic friction; any consistent units.
#[derive(Debug, Clone, Copy)]
pub(super) struct Oscillator {
    /// ω = √(k/m).
    pub(super) frequency: f64,
    /// β = c/(2√(km)), below 1.
    pub(super) damping: f64,
    pub(super) stiffness: f64,
    /// N μ_k.
    pub(super) kinetic: f64,
}

/// A slip arc in units of 1/ω and v/ω, about the displacement where kinetic friction balances the
/// spring:
///
/// ```text
/// y'' + 2βy' + y = 0,   y(0) = x,   y'(0) = 1 = y'(s)
/// s = (2/ω_d)(π − atan p),   ω_d = √(1 − β²)
/// ```
///
/// p > 0 numbers the arcs; without damping it is x.
#[derive(Debug, Clone, Copy)]
pub(super) struct SlipArc {
    damping: f64,
    /// ω_d.
    frequency: f64,
    p: f64,
    /// s.
    duration: f64,
    /// X = x + 2β: by how much friction rises above its kinetic value before the release.
    pub(super) start: f64,
    /// Acceleration at the contact, −y(s) − 2β.
    pub(super) arrival: f64,
}

impl SlipArc {
    pub(super) fn new(damping: f64, p: f64) -> Self {
        let frequency = ((1.0 - damping) * (1.0 + damping)).sqrt();
        let duration = 2.0 * (PI - p.atan()) / frequency;
        // x + β = ω_d (e^{βs} − cos ω_d s)/(−sin ω_d s), and y(s) + β is −x − β for −s.
        let half = 0.5 * (p + p.recip());
        let at = |exponent: f64| frequency * (exponent.exp_m1() * half + p);
        Self {
            damping,
            frequency,
            p,
            duration,
            start: at(damping * duration) + damping,
            arrival: at(-damping * duration) - damping,
        }
    }

    /// Duration of stick between two such arcs, θ = x − y(s).
    pub(super) fn rest(&self) -> f64 {
        self.start + self.arrival
    }

    /// dy(s)/dx, times the acceleration at the contact.
    pub(super) fn stretched_arrival(&self) -> f64 {
        let (beta, frequency) = (self.damping, self.frequency);
        let square = self.p * self.p;
        // ω_d s = 2π − 2 atan p.
        let [cosine, sine] = if square.is_finite() {
            [
                (1.0 - square) / (1.0 + square),
                -2.0 * self.p / (1.0 + square),
            ]
        } else {
            [-1.0, -2.0 / self.p]
        };
        let turned = (cosine + beta * sine / frequency) * self.arrival + sine / frequency;
        (-beta * self.duration).exp() * turned
    }

    /// The cycle of an oscillator with this arc, on a belt of velocity v > 0. `growth` is the rate
    /// at which static friction grows at the release, as a force per time.
    pub(super) fn cycle(&self, of: &Oscillator, velocity: f64, growth: f64) -> ExactCycle {
        let (beta, length) = (self.damping, velocity / of.frequency);
        let center = of.kinetic / of.stiffness;
        let (x, start) = (self.start - 2.0 * beta, self.start);
        // y' = 0 first, and then half a turn later.
        let turn = self.frequency.atan2(x + beta) / self.frequency;
        let highest = (-beta * turn).exp() * (1.0 + x * (x + 2.0 * beta)).sqrt();
        let lower = 1.0 + (-PI * beta / self.frequency).exp();
        // y'' = 0.
        let fastest = (self.frequency * start).atan2(beta * start - 1.0) / self.frequency;
        let speed = (-beta * fastest).exp() * (1.0 + start * x).sqrt();
        let held_back = growth - of.stiffness * velocity;
        let multiplier = if growth == 0.0 {
            0.0
        } else {
            growth / held_back * (self.stretched_arrival() / self.arrival)
        };
        ExactCycle {
            belt_velocity: velocity,
            stick_duration: self.rest() / of.frequency,
            slip_duration: self.duration / of.frequency,
            release_displacement: center + length * x,
            contact_displacement: center - length * (self.arrival + 2.0 * beta),
            amplitude: 0.5 * length * highest * lower,
            max_sliding_speed: velocity * (1.0 + speed),
            multiplier,
        }
    }
}

/// 2π − ω_d s of the slip phase of duration s that begins and ends tangentially to the belt's
/// velocity: see [`tangential_slip`](super::coulomb::tangential_slip). `None` unless 0 < β < 1.
pub(super) fn tangential_angle(damping: f64) -> Option<f64> {
    if !(damping > 0.0 && damping < 1.0) {
        return None;
    }
    let frequency = ((1.0 - damping) * (1.0 + damping)).sqrt();
    let ratio = damping / frequency;
    // With θ = 2π − ω_d s: β s + ln(cos θ + (β/ω_d) sin θ) falls from 2πβ/ω_d at θ = 0 to −∞ at θ =
    // π/2 + asin β, where the logarithm's argument vanishes. ln_1p keeps small β exact.
    let mut residual = |theta: f64| {
        let sine_half = (0.5 * theta).sin();
        let logarithm = (ratio * theta.sin() - 2.0 * sine_half * sine_half).ln_1p();
        // At the far end rounding may make the argument negative; `max` replaces NaN and −∞.
        Ok((ratio * (2.0 * PI - theta) + logarithm).max(-f64::MAX))
    };
    if damping < SMALL {
        return Some((4.0 * PI).sqrt() * damping.sqrt());
    }
    root_between(&mut residual, 0.0, FRAC_PI_2 + damping.asin()).ok()
}
