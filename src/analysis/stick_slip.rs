use std::f64::consts::{PI, TAU};

use crate::belt::{Belt, MassOnBelt};
use crate::error::Error;
use crate::friction::check::STATIC_ROUNDING;
use crate::friction::{FrictionLaw, Values, slope_on, taylor_coefficients};
use crate::numerics::adaptive::{gauss, graded};
use crate::scalar::LONGEST;

/// The stick-slip formulas of Farshidianfar and Noei Aghaee, for any law: stick, then a slip arc of
/// an undamped oscillation about the equilibrium.
///
/// [`limit_cycle::stick_slip`](crate::limit_cycle::stick_slip) computes the exact motion. v_b is
/// the belt velocity, β the damping ratio, γ² the friction load, μ_s the static coefficient, and
/// μ̂(s) the kinetic coefficient at the sliding speed s. u is the displacement, ū that of the
/// equilibrium, and κ|v_b| the distance of the release point from the equilibrium. A1 is the
/// amplitude, T the period and ω_ss the angular frequency. η and v_m are those of
/// [`PureSlip`](super::PureSlip).
///
/// ```text
/// κ    = [γ²(μ_s − μ̂(|v_b|)) − 2β|v_b|] / |v_b|      (polynomial law: η(1 − (v_b/v_m)²/3) − 2β)
/// A1   = |v_b| √(1 + κ²)                              (Eqs. 16-18)
/// stick 2κ,   slip 2π − 2 atan κ,   T = 2π + 2(κ − atan κ),   ω_ss = 2π/T
/// ```
///
/// In these formulas the mass neither gains nor loses energy during slip, so the slip arc ends at ū
/// − κv_b, the mirror image of the release point ū + κv_b. In reality the mass gains energy of
/// order ε, the small parameter of [`analysis`](super), and the distance of the end from ū is
/// larger by O(ε^{1/2}). The formulas are therefore inaccurate: the errors are O(ε) in A1,
/// O(ε^{3/2}) in T and O(ε^{1/2}) in the durations. (The error of the constant 2π, as an
/// approximation of T, has the same order.) For a cubic law use [`first_order`](Self::first_order)
/// and [`second_order`](Self::second_order). The formulas are valid for κ > 0 and, with the
/// polynomial law, for 0 < |v_b| < v_b0 ([`stick_velocity`](super::PureSlip::stick_velocity)).
///
/// All quantities are dimensionless. The formulas hold for both signs of v_b.
///
/// Source: Farshidianfar and Noei Aghaee, Eqs. 16-18, for any law.
///
/// ```
/// use stick_slip::analysis::StickSlip;
/// use stick_slip::{MassOnBelt, Polynomial, limit_cycle};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?.with_damping(0.05)?;
/// let formulas = StickSlip::new(&system).unwrap();
/// assert!((formulas.kappa() - 0.326).abs() < 1e-15); // (γ²(μ_s − μ̂(0.2)) − 2β·0.2)/0.2
/// assert!((formulas.amplitude() - 0.2103593117).abs() < 1e-10); // exact: 0.28621
/// assert_eq!(formulas.velocity_amplitude(), formulas.amplitude()); // exact: 0.28610
/// assert!((formulas.stick_duration() - 0.652).abs() < 1e-15); // exact: 1.62956
/// assert!((formulas.slip_duration() - 5.6529131095).abs() < 1e-10); // exact: 5.16986
/// assert!((formulas.period() - 6.3049131095).abs() < 1e-10); // exact: 6.79942
/// assert!((formulas.frequency() - 0.99655383).abs() < 1e-8); // exact: 0.92408
/// // Formulas that include the energy gained during slip, of first and second order.
/// let u_max = limit_cycle::stick_slip(&system)?.unwrap().max_displacement();
/// let [first, second] = [formulas.first_order(), formulas.second_order()].map(Option::unwrap);
/// assert!((first.u_max - u_max).abs() < 2e-3 && (first.slip - 5.16986).abs() < 0.2);
/// assert!((second.u_max - u_max).abs() < 2e-4 && (second.slip - 5.16986).abs() < 0.05);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StickSlip {
    belt_velocity: f64,
    equilibrium: f64,
    kappa: f64,
    /// Largest friction force γ²μ_s.
    largest_friction: f64,
    /// Coefficients for a law that is a cubic polynomial from rest on.
    cubic: Option<Cubic>,
}

/// A cubic law, as the expansions use it.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Cubic {
    /// The coefficients H1, H2, H3 of h(y) = H1 y + H2 y²/|v_b| + H3 y³/v_b², for a belt that moves
    /// forward.
    h: [f64; 3],
    /// Sliding speed up to which the law is this polynomial.
    up_to: f64,
}

impl StickSlip {
    /// Computes the formulas for a system. `None` if v_b = 0, if κ is not finite, or if κ ≤ 0. If κ
    /// ≤ 0, the force of the damper at the belt velocity is at least the difference between static
    /// and kinetic friction.
    ///
    /// A system with κ ≤ 0 may still have a stick-slip cycle, but these formulas do not describe
    /// it.
    pub fn new<L: FrictionLaw>(system: &MassOnBelt<L>) -> Option<Self> {
        Self::of(&system.belt())
    }

    fn of(system: &Belt<'_>) -> Option<Self> {
        let (law, load) = (system.law(), system.load());
        let v_b = system.belt_velocity();
        let speed = v_b.abs();
        if speed == 0.0 {
            return None;
        }
        let jump = static_jump(law);
        let fall = jump / speed - mean_slope(law, speed).ok()?;
        let kappa = load * fall - 2.0 * system.damping();
        let series = taylor_coefficients::<LONGEST>(law, speed);
        let first_breakpoint = law.breakpoints().next().unwrap_or(f64::INFINITY);
        let is_cubic =
            jump == 0.0 && speed < first_breakpoint && series[4..].iter().all(|&c| c == 0.0);
        let [_, m1, m2, m3, ..] = series;
        (kappa > 0.0 && kappa.is_finite()).then_some(Self {
            belt_velocity: v_b,
            equilibrium: system.equilibrium_displacement(),
            kappa,
            largest_friction: load * law.static_coefficient(),
            cubic: is_cubic.then_some(Cubic {
                h: [
                    2.0 * system.damping() + load * m1,
                    -load * m2 * speed,
                    load * m3 * speed * speed,
                ],
                up_to: first_breakpoint,
            }),
        })
    }

    /// Distance κ = [γ²(μ_s − μ̂(|v_b|)) − 2β|v_b|]/|v_b| of the release point from ū, in units
    /// of |v_b|. Dimensionless, exact.
    ///
    /// Source: Farshidianfar and Noei Aghaee, before Eq. 18.
    pub fn kappa(&self) -> f64 {
        self.kappa
    }

    /// Amplitude A1 = |v_b|√(1 + κ²), dimensionless. Its error is O(ε) as an approximation of
    /// u_max − ū, of ū − u_min or of half the range of u.
    ///
    /// Source: Farshidianfar and Noei Aghaee, Eq. 18.
    pub fn amplitude(&self) -> f64 {
        self.belt_velocity.abs() * self.kappa.hypot(1.0)
    }

    /// Largest speed of the mass against the belt's direction, equal to A1. (In the belt's
    /// direction the largest speed is exactly |v_b|.) Dimensionless, error O(ε).
    ///
    /// Source: Farshidianfar and Noei Aghaee, Eq. 17.
    pub fn velocity_amplitude(&self) -> f64 {
        self.amplitude()
    }

    /// Duration of stick, 2κ, dimensionless. Error O(ε^{1/2}).
    ///
    /// Source: Farshidianfar and Noei Aghaee, Eqs. 16-18.
    pub fn stick_duration(&self) -> f64 {
        2.0 * self.kappa
    }

    /// Duration of slip, 2π − 2 atan κ, dimensionless. Error O(ε^{1/2}).
    ///
    /// Source: Farshidianfar and Noei Aghaee, Eqs. 16-18.
    pub fn slip_duration(&self) -> f64 {
        TAU - 2.0 * self.kappa.atan()
    }

    /// Period T = 2π + 2(κ − atan κ), dimensionless. Error O(ε^{3/2}).
    ///
    /// Source: Farshidianfar and Noei Aghaee, after Eq. 18.
    pub fn period(&self) -> f64 {
        self.stick_duration() + self.slip_duration()
    }

    /// Angular frequency ω_ss = 2π/T, dimensionless (in units of ω0). Error O(ε^{3/2}).
    ///
    /// Source: Farshidianfar and Noei Aghaee, after Eq. 18.
    pub fn frequency(&self) -> f64 {
        TAU / self.period()
    }

    /// The cycle to first order in ε, which includes the energy gained during slip. For errors and
    /// range see [`StickSlipCycle`].
    ///
    /// `None` in these cases:
    ///
    /// * the law is not a cubic polynomial from s = 0 up to the largest sliding speed of the cycle,
    ///   with μ_s = μ̂(0);
    /// * W1 ≤ 0, with W1 of [`StickSlipCycle`]; for the polynomial law this is |v_b| ≥ v_b0;
    /// * the mass would overtake the belt (see [`second_order`](Self::second_order));
    /// * the duration of slip would not be positive (W1 ≥ 2π²).
    pub fn first_order(&self) -> Option<StickSlipCycle> {
        let cubic = self.cubic?;
        self.on_belt(&cubic, cubic.first_order()?)
    }

    /// The cycle to second order in ε. For errors and range see [`StickSlipCycle`].
    ///
    /// `None` in the first three cases of [`first_order`](Self::first_order), if W ≤ 0 with W of
    /// [`StickSlipCycle`], or if the duration of stick or slip would not be positive. The mass
    /// would overtake the belt in the following case. In a stick of duration θ the mass moves by
    /// |v_b|θ, up to the release point at one end of the stick band. If |v_b|θ exceeds the width
    /// 2γ²μ_s of this band, the mass reaches the belt velocity outside the band. It cannot stick
    /// there, and overtakes the belt.
    pub fn second_order(&self) -> Option<StickSlipCycle> {
        let cubic = self.cubic?;
        self.on_belt(&cubic, cubic.second_order()?)
    }

    /// Scales a cycle to this belt. `None` if it leaves the range of the formulas, or if a term
    /// overflowed.
    fn on_belt(&self, cubic: &Cubic, cycle: UnitCycle) -> Option<StickSlipCycle> {
        let (v_b, speed) = (self.belt_velocity, self.belt_velocity.abs());
        let overtakes = |cycle: UnitCycle| speed * cycle.stick > 2.0 * self.largest_friction;
        let in_range = cycle.period.is_finite()
            && cycle.stick > 0.0
            && cycle.slip > 0.0
            && speed * (1.0 - cycle.v_min) <= cubic.up_to;
        if !in_range || cubic.second_order().is_some_and(overtakes) {
            return None;
        }
        let [far, near, back] = [cycle.z_max, cycle.z_min, cycle.v_min].map(|x| v_b * x);
        Some(StickSlipCycle {
            u_max: self.equilibrium + far.max(near),
            u_min: self.equilibrium + far.min(near),
            z_max: far.max(near),
            z_min: far.min(near),
            v_max: v_b.max(back),
            v_min: v_b.min(back),
            stick: cycle.stick,
            slip: cycle.slip,
            period: cycle.period,
            growth: cycle.growth,
            return_angle: cycle.return_angle,
        })
    }
}

/// Static jump μ_s − μ̂(0); 0 if the two differ by rounding alone.
fn static_jump(law: &dyn Values) -> f64 {
    let mu_s = law.static_coefficient();
    let jump = mu_s - law.kinetic(0.0);
    if jump <= STATIC_ROUNDING * mu_s {
        0.0
    } else {
        jump
    }
}

/// Mean slope (μ̂(s) − μ̂(0))/s of the law, without cancellation at small s.
fn mean_slope(law: &dyn Values, speed: f64) -> Result<f64, Error> {
    let mut ends = vec![0.0];
    ends.extend(law.breakpoints().take_while(|&b| b < speed));
    ends.push(speed);
    let mut mean = 0.0;
    for (piece, ends) in ends.windows(2).enumerate() {
        let slope = |x: f64| Ok([slope_on(law, piece, x * speed)?]);
        mean += gauss(slope, &graded(ends[0] / speed, ends[1] / speed), 0.0)?.parts[0];
    }
    Ok(mean)
}

/// A cycle with v_b = 1 and ū = 0.
#[derive(Clone, Copy)]
struct UnitCycle {
    z_max: f64,
    z_min: f64,
    v_min: f64,
    growth: f64,
    return_angle: f64,
    stick: f64,
    slip: f64,
    period: f64,
}

impl Cubic {
    fn first_order(&self) -> Option<UnitCycle> {
        let [h1, h2, h3] = self.h;
        // W1 = −πH1 − (3π/4)H3,  q0 = √(2W1)
        let growth = -PI * (h1 + 0.75 * h3);
        let q0 = (2.0 * growth).sqrt();
        (growth > 0.0).then_some(UnitCycle {
            z_max: 1.0 - PI / 4.0 * h1 - 2.0 / 3.0 * h2 - 3.0 * PI / 16.0 * h3,
            z_min: -(1.0 - 3.0 * PI / 4.0 * h1 + 2.0 / 3.0 * h2 - 9.0 * PI / 16.0 * h3),
            v_min: -(1.0 - PI / 2.0 * h1 - 3.0 * PI / 8.0 * h3),
            growth,
            return_angle: q0,
            stick: q0,
            slip: TAU - q0,
            period: TAU + q0 * q0 * q0 / 3.0,
        })
    }

    fn second_order(&self) -> Option<UnitCycle> {
        let first = self.first_order()?;
        let [h1, h2, h3] = self.h;
        let [h11, h12, h13, h22, h23, h33] = [h1 * h1, h1 * h2, h1 * h3, h2 * h2, h2 * h3, h3 * h3];
        const PI2: f64 = PI * PI;
        let z_max = (PI2 / 32.0 - 0.25) * h11
            + (PI / 3.0 - 8.0 / 9.0) * h12
            + (3.0 * PI2 / 32.0 - 0.75) * h13
            + h22 / 9.0
            + (PI / 4.0 - 8.0 / 15.0) * h23
            + (27.0 * PI2 / 512.0 - 0.375) * h33;
        let z_min = (0.25 - 9.0 * PI2 / 32.0) * h11
            + (PI + 8.0 / 9.0) * h12
            + (0.75 - 27.0 * PI2 / 32.0) * h13
            - h22 / 9.0
            + (3.0 * PI / 4.0 + 8.0 / 15.0) * h23
            + (0.375 - 243.0 * PI2 / 512.0) * h33;
        let v_min = -PI2 / 8.0 * h11 + 16.0 / 9.0 * h12 - 3.0 * PI2 / 8.0 * h13 + 16.0 / 15.0 * h23
            - 27.0 * PI2 / 128.0 * h33;
        // W2 and T2
        let growth = PI2 * (0.5 * h11 + 1.5 * h13 + 27.0 / 32.0 * h33);
        let delay = PI
            * (0.25 * h11
                + 2.0 / 3.0 * h12
                + 33.0 / 16.0 * h13
                + h22 / 3.0
                + 0.5 * h23
                + 189.0 / 128.0 * h33);
        // h' = H1 + 2H2 + 3H3,  W = W1 + W2,  r = W/(1 + W),  tan δ = √(W(2 + W))
        let w = first.growth + growth;
        let correction = (h1 + 2.0 * h2 + 3.0 * h3) * w / (1.0 + w);
        let tangent = (w * (2.0 + w)).sqrt();
        let delta = tangent.atan();
        (w > 0.0).then_some(UnitCycle {
            z_max: first.z_max + z_max,
            z_min: first.z_min + z_min,
            v_min: first.v_min + v_min,
            growth: w,
            return_angle: delta,
            stick: tangent + 2.0 / 3.0 * correction,
            slip: TAU + delay - delta + correction / 3.0,
            period: TAU + delay + (tangent - delta) + correction,
        })
    }
}

/// A stick-slip cycle of a cubic law, as an expansion for weak friction and damping. Dimensionless.
/// [`StickSlip::first_order`] and [`StickSlip::second_order`] compute it.
///
/// β is the damping ratio, γ² the friction load, v_b the belt velocity, μ_s the static coefficient,
/// and μ̂(s) the kinetic coefficient at the sliding speed s. u is the displacement, ū that of
/// steady sliding, and v the velocity.
///
/// Let H1 = h1, H2 = h2 v_b and H3 = h3 v_b², with h1, h2, h3 of [`PureSlip`](super::PureSlip). For
/// any cubic law H1 = 2β + γ² dμ̂/ds, H2 = −½γ²v_b d²μ̂/ds² and H3 = (1/6)γ²v_b² d³μ̂/ds³, at s =
/// v_b. For v_b > 0 the cycle to first order is given below; the cycle for v_b < 0 is its mirror
/// image. `stick` and `slip` are durations.
///
/// ```text
/// u_max = ū + v_b[1 − (π/4)H1 − (2/3)H2 − (3π/16)H3]
/// u_min = ū − v_b[1 − (3π/4)H1 + (2/3)H2 − (9π/16)H3]
/// v_min = −v_b[1 − (π/2)H1 − (3π/8)H3]
/// W1 = −πH1 − (3π/4)H3,   q0 = √(2W1)
/// stick = q0,   slip = 2π − q0,   T = 2π + q0³/3
/// ```
///
/// For [`Polynomial`](crate::Polynomial), W1 = π[η(1 − (5/4)(v_b/v_m)²) − 2β], with v_m the speed
/// of least friction, μ_m the least coefficient and η = (3/2)γ²(μ_s − μ_m)/v_m. The sum
/// stick + slip lacks the term q0³/3 of T, because stick and slip have errors of this order.
///
/// To second order the durations are
///
/// ```text
/// W  = W1 + π²[H1²/2 + (3/2)H1H3 + (27/32)H3²],   r = W/(1 + W),   tan δ = √(W(2 + W))
/// T2 = π[H1²/4 + (2/3)H1H2 + (33/16)H1H3 + H2²/3 + H2H3/2 + (189/128)H3²]
/// h' = H1 + 2H2 + 3H3
/// stick = tan δ + (2/3)h'r,   slip = 2π + T2 − δ + h'r/3,   T = 2π + T2 + tan δ − δ + h'r
/// ```
///
/// The extremes also get terms quadratic in H1, H2, H3. The errors have the following orders in ε.
/// An error of order n shrinks like εⁿ if γ² and β are multiplied by a small ε.
///
/// | field | first order | second order |
/// |---|---|---|
/// | `z_max`, `z_min`, `u_max`, `u_min` | 2 | 3 |
/// | `stick`, `slip` | 3/2 | 5/2 |
/// | `period` | 2 | 3 |
/// | `growth` | 2 | 3 |
/// | `return_angle` | 3/2 | 2 |
/// | `v_min` for v_b > 0, `v_max` for v_b < 0 | 2 | 3 |
///
/// The expansion is valid if W1 is positive and small compared with 1, and if |v_b|·stick ≤ 2γ²μ_s,
/// so that the mass sticks when it reaches the belt velocity. For the polynomial law W1 > 0 means
/// |v_b| < v_b0, with v_b0 of [`stick_velocity`](super::PureSlip::stick_velocity). The condition
/// |v_b|·stick ≤ 2γ²μ_s fails as ε → 0 at fixed μ_s. To satisfy it, raise μ_s and μ_m by the same
/// constant: the stick band becomes wider, and u − ū does not change.
///
/// As |v_b| → v_b0, the duration of stick in these formulas goes to zero like √d, with d = 1 −
/// |v_b|/v_b0. The exact duration of stick goes to zero at
/// [`grazing_velocity`](super::PureSlip::grazing_velocity), a little above v_b0. The second-order
/// duration is therefore too short. Let e = (3461/153600) q²/d, where q is that of
/// `grazing_velocity`. If e is small, it is the relative error of this duration. Keep d above q²,
/// or compute the exact cycle. The errors of the extremes and of the period do not grow.
///
/// Source: expansion of the slip arc that begins at the release point, which replaces
/// Eqs. 16-18 of Farshidianfar and Noei Aghaee.
///
/// ```
/// use stick_slip::analysis::StickSlip;
/// use stick_slip::{MassOnBelt, Polynomial};
///
/// let system = MassOnBelt::new(Polynomial::new(0.4, 0.25, 0.5)?, 0.2)?;
/// let system = system.with_damping(0.0075)?.with_load(0.15)?;
/// let formulas = StickSlip::new(&system).unwrap();
/// let exact = 6.3193778906; // period
/// let first = formulas.first_order().unwrap().period;
/// let second = formulas.second_order().unwrap().period;
/// assert!((formulas.period() - exact).abs() > 3e-2);
/// assert!((first - exact).abs() < 5e-3 && (second - exact).abs() < 7e-4);
/// # Ok::<(), stick_slip::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub struct StickSlipCycle {
    /// Largest displacement u_max.
    pub u_max: f64,
    /// Least displacement u_min.
    pub u_min: f64,
    /// Largest distance from the equilibrium upwards, u_max − ū.
    pub z_max: f64,
    /// Largest distance from the equilibrium downwards, u_min − ū (negative).
    pub z_min: f64,
    /// Largest velocity v_max; it is v_b for v_b > 0.
    pub v_max: f64,
    /// Least velocity v_min; it is v_b for v_b < 0.
    pub v_min: f64,
    /// Duration of stick.
    pub stick: f64,
    /// Duration of slip.
    pub slip: f64,
    /// Period T.
    pub period: f64,
    /// Growth W = (V − |v_b|)/|v_b|, which is W1 to first order. V is hypothetical, because the
    /// mass sticks when it reaches the belt velocity. If it did not stick, and the same cubic gave
    /// its friction above the belt velocity, V would be its first maximum of velocity, in the
    /// direction of the belt, after the release. During slip the mass gains the energy v_b²(W +
    /// W²/2).
    pub growth: f64,
    /// Return angle δ, in radians, which is q0 to first order: the phase by which the slip arc is
    /// shorter than a full period of free vibration.
    pub return_angle: f64,
}
