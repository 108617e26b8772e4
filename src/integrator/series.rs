//! One Taylor step of a slip phase: the series, how far it reaches, and whether it held.

use super::polynomial::{INTEGRAL, Polynomial, TERMS, evaluate_four, quarters};
use crate::friction::FrictionLaw;
use crate::scalar::{Workspace, expand, mul_add};
use crate::{Direction, Error, MassOnBelt, State};

/// A point of a slip phase: sliding direction σ, displacement u, sliding speed s = σ·v_r ≥ 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SlipPoint {
    pub(crate) direction: Direction,
    pub(crate) displacement: f64,
    pub(crate) speed: f64,
    /// Piece of the law that the motion is in.
    pub(crate) piece: usize,
    /// ds/dτ where it is known better than the equation of motion gives it: at the start of a slip phase.
    pub(crate) rate: Option<f64>,
}

/// The power series of a slip phase about one of its points, in the time since.
///
/// With σ = ±1 and x = σu the equations of slip are
///
/// ```text
/// x' = s + σv_b,   s' = −x − 2β(s + σv_b) − γ²μ̂(s),
/// ```
///
/// in the sliding speed s and not in v, so that contact is exact however large the belt velocity is.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Series {
    /// s(t).
    pub(crate) speed: Polynomial,
    /// μ̂(s(t)), without its last coefficient, which the motion does not need.
    friction: Polynomial,
}

impl Series {
    /// Expands the motion about a point.
    ///
    /// Kept out of line: inlined into the stepper, it competes for registers and runs at half the speed.
    #[inline(never)]
    pub(crate) fn new<L: FrictionLaw>(
        system: &MassOnBelt<L>,
        workspace: &mut Workspace<TERMS>,
        from: &SlipPoint,
    ) -> Result<Self, Error> {
        let sigma = from.direction.sign();
        let (damping, load) = (2.0 * system.damping(), system.load());
        let belt = sigma * system.belt_velocity();
        let mut friction = [0.0; TERMS];

        let s0 = from.speed;
        // x_k, which follows from s_{k−1}, and 2β + γ²·dμ̂/ds at s_0.
        let (mut x, mut decay) = (sigma * from.displacement, 0.0);
        let (value, slope) = expand(system.law(), from.piece, workspace, s0, |k, s, m| {
            if k == 0 {
                decay = mul_add(load, m.slope, damping);
                friction[0] = m.rest;
                let rate = -x - damping * (s + belt) - load * m.rest;
                x = s + belt;
                return from.rate.unwrap_or(rate);
            }
            // (k + 1) s_{k+1} = −x_k − 2β s_k − γ² m_k, with m_k = slope·s_k + rest: s_k is put in last.
            friction[k] = mul_add(m.slope, s, m.rest);
            let older = mul_add(load, m.rest, x);
            x = s * INTEGRAL[k];
            -mul_add(decay, s, older) * INTEGRAL[k]
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
        Ok(Self {
            speed: workspace.speed(),
            friction,
        })
    }

    /// Length of a step whose last terms stay below `error`: (error/|s_n|)^(1/n) for the last two n, to 6 %.
    ///
    /// Infinite series coefficients (a system too stiff for f64) give 0 or NaN.
    #[inline(always)]
    pub(crate) fn reach(&self, error: f64) -> f64 {
        let by = |n: usize| root(error / self.speed[n].abs(), n);
        by(TERMS - 1).min(by(TERMS - 2)).min(LONGEST_STEP)
    }

    /// |u| + 2β|v| + γ²μ̂ at the start: what the rounding errors of the equation of motion are measured by.
    #[inline(always)]
    pub(crate) fn largest_term<L>(&self, system: &MassOnBelt<L>, state: State) -> f64 {
        state.displacement.abs()
            + 2.0 * system.damping() * state.velocity.abs()
            + system.load() * self.friction[0].abs()
    }

    /// Largest |γ²[μ̂(s(t)) − m(t)]| at the [`quarters`] of h, where s(t) has the values `speeds`: the defect of the series, up to terms as
    /// small as its last.
    ///
    /// Coefficients alone miss what lies hidden behind an underflow, such as the flank of a narrow Gaussian.
    #[inline(always)]
    pub(crate) fn defect<L: FrictionLaw>(
        &self,
        system: &MassOnBelt<L>,
        piece: usize,
        h: f64,
        speeds: [f64; 4],
    ) -> f64 {
        let friction = evaluate_four(&self.friction, quarters(h));
        let mut largest = 0.0;
        for (s, m) in std::iter::zip(speeds, friction) {
            let difference = (system.law().kinetic_on(piece, s.max(0.0)) - m).abs();
            // Not f64::max, which would drop a NaN.
            if !(difference <= largest) {
                largest = difference;
            }
        }
        system.load() * largest
    }
}

/// No step is longer, even where the last coefficients vanish: the oscillator turns once in about 2π.
const LONGEST_STEP: f64 = 8.0;

/// x^(1/n) to 6 %, from the bits of x: exponent and mantissa together are nearly a logarithm.
#[inline(always)]
fn root(x: f64, n: usize) -> f64 {
    const ONE: i64 = 1.0_f64.to_bits() as i64;
    f64::from_bits((ONE + (x.to_bits() as i64 - ONE) / n as i64) as u64)
}
