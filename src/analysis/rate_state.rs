//! Rate-and-state friction ([`RateState`]): velocity steps, healing, earthquake nucleation and the
//! quasi-static spring-slider.
//!
//! μ = f₀ + a ln(V/V₀) + bφ with φ = ln(V₀θ/D_c). V is the sliding speed, θ the state variable, D_c
//! its length, and V₀ the reference speed. Where friction is needed, it is that of the law, with
//! arsinh.
//!
//! | function | situation | source |
//! |---|---|---|
//! | [`velocity_step`] | speed given: from one steady speed to another | J. H. Dieterich, *J. Geophys. Res.* 84 (1979) 2161-2168; A. Ruina, *J. Geophys. Res.* 88 (1983) 10359-10370 |
//! | [`healing`] | no sliding for some time | Dieterich 1979; N. M. Beeler, T. E. Tullis, J. D. Weeks, *Geophys. Res. Lett.* 21 (1994) 1987-1990 |
//! | [`time_to_instability`] | self-acceleration under a load that rises | J. H. Dieterich, *Tectonophysics* 211 (1992) 115-134; *J. Geophys. Res.* 99 (1994) 2601-2618 |
//! | [`stress_drop`] | a strong earthquake | J. R. Rice, S. T. Tse, *J. Geophys. Res.* 91 (1986) 521-530 |
//! | [`first_integral`] | a spring-slider without inertia at the critical stiffness | J.-C. Gu, J. R. Rice, A. L. Ruina, S. T. Tse, *J. Mech. Phys. Solids* 32 (1984) 167-196 (slip law); K. Ranjith, J. R. Rice, *J. Mech. Phys. Solids* 47 (1999) 1207-1218 (aging law) |
//!
#![doc = include_str!("../figures/fault.svg")]
//!
//! *The sliding speed of a fault over two cycles, and in an earthquake, computed by
//! [`orbit::shoot`](crate::orbit::shoot): the example `earthquake`.*
//!
//! Steady sliding, its critical stiffness and the frequency there are methods of the law:
//! [`RateState::steady`], [`RateState::critical_stiffness`], [`RateState::hopf_frequency`].

use crate::friction::memory::{ContactLaw, Evolution, RateState, Slip};

/// Friction coefficient after a velocity step: after steady sliding at the speed V₁ the contact
/// slides at the speed V₂, and has covered the distance `slip` at this speed. Dimensionless; exact.
/// NaN unless both speeds are positive and finite.
///
/// ```text
/// aging   V₂θ/D_c = 1 + (V₂/V₁ − 1) e^{−δ/D_c}          slip   ln(V₂θ/D_c) = ln(V₂/V₁) e^{−δ/D_c}
/// ```
///
/// δ is the distance. The coefficient jumps by a ln(V₂/V₁), and then changes by −b ln(V₂/V₁). The
/// steps up and down of the slip law are symmetric, those of the aging law are not. With two state
/// variables each has its own D_c.
///
/// ```
/// use stick_slip::{RateState, analysis::rate_state::velocity_step};
///
/// let law = RateState::slip(0.6, 0.01, 0.015, 1e-5, 1e-6)?;
/// let step = |slip: f64| velocity_step(&law, 1e-6, 1e-5, slip);
/// assert!((step(0.0) - (0.6 + 0.01 * 10_f64.ln())).abs() < 1e-15);
/// let half = 0.6 + (0.01 - 0.015 * 0.5) * 10_f64.ln();
/// assert!((step(1e-5 * 2_f64.ln()) - half).abs() < 1e-15);
/// assert!((step(1e-3) - law.steady(1e-5)).abs() < 1e-15);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn velocity_step<const STATES: usize>(
    law: &RateState<STATES>,
    v1: f64,
    v2: f64,
    slip: f64,
) -> f64 {
    if !are_speeds(&[v1, v2]) {
        return f64::NAN;
    }
    let after = Slip {
        speed: v2,
        direction: 1.0,
        piece: 0,
    };
    let memory = law.states.map(|state| {
        let decay = -slip / state.d_c;
        let left = decay.exp();
        // ln(V₂θ/D_c), as a sum of positive terms.
        let distance = match law.evolution {
            Evolution::Aging => (v2 / v1 * left - decay.exp_m1()).ln(),
            Evolution::Slip => (v2 / v1).ln() * left,
        };
        law.memory_at(v2) + distance
    });
    law.coefficient(after, memory)
}

/// Increase of the friction coefficient by a hold: after steady sliding at the reference speed V₀
/// the surfaces rest for the time `hold` ≥ 0. It is the increase of the peak in sliding at V₀
/// afterwards, with a stiff spring. Dimensionless; exact. NaN unless `hold` ≥ 0.
///
/// ```text
/// aging   Σ b ln(1 + V₀t/D_c)          slip   0
/// ```
///
/// The slip law heals only while the contact creeps, which a spring lets it do during a hold.
///
/// ```
/// use stick_slip::{RateState, analysis::rate_state::healing};
///
/// let law = RateState::aging(0.6, 0.01, 0.015, 1e-5, 1e-6)?;
/// // By b ln 10 in each decade of time beyond D_c/V₀ = 10 s.
/// let decade = healing(&law, 1e6) - healing(&law, 1e5);
/// assert!((decade - 0.015 * 10_f64.ln()).abs() < 2e-6);
/// assert!((healing(&law, 10.0) - 0.015 * 2_f64.ln()).abs() < 1e-17);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn healing<const STATES: usize>(law: &RateState<STATES>, hold: f64) -> f64 {
    if hold.is_nan() || hold < 0.0 {
        return f64::NAN;
    }
    let parts = law.states.iter().map(|state| match law.evolution {
        Evolution::Aging => state.b * (law.v0 * hold / state.d_c).ln_1p(),
        Evolution::Slip => 0.0,
    });
    parts.sum()
}

/// Time until the speed of a self-accelerating contact without inertia grows without bound, with
/// the aging law.
///
/// ```text
/// t_f = (aN/τ') ln(1 + τ'/(HNV)),   H = b/D_c − k/N;     τ' = 0: t_f = a/(HV)
/// ```
///
/// `load` is the normal load N, `stiffness` the spring k, `v` the speed V now, and `load_rate` the
/// rate τ' at which the spring would be loaded without sliding, k times the speed of its end. The
/// formula neglects aging: its relative error is O(D_c/(Vθ)), small where the contact slides far
/// faster than in steady sliding with the same θ. `None` unless H > 0 and V > 0, if a falling load
/// ends the acceleration, or for the slip law.
///
/// This holds up to the critical stiffness N(b − a)/D_c. Above it steady sliding is stable, and no
/// speed grows without bound: Vθ falls, and the speed has a maximum. The result is the time of this
/// maximum, with a relative error O((D_c/(Vθ))^p), p = min(1, HD_c/(a − HD_c)).
///
/// ```
/// use stick_slip::{RateState, analysis::rate_state::time_to_instability};
///
/// let law = RateState::aging(0.6, 0.01, 0.015, 1e-5, 1e-6)?;
/// let time = |rate: f64| time_to_instability(&law, 5e6, 5e9, 1e-9, rate);
/// // H = 500/m.
/// assert!((time(0.0).unwrap() - 2e4).abs() < 1e-8);
/// assert!((time(2.5).unwrap() - 2e4 * 2_f64.ln()).abs() < 1e-8);
/// assert_eq!(time(-2.5), None);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn time_to_instability(
    law: &RateState,
    load: f64,
    stiffness: f64,
    v: f64,
    load_rate: f64,
) -> Option<f64> {
    let [state] = law.states;
    let growth = state.b / state.d_c - stiffness / load;
    if law.evolution != Evolution::Aging
        || !(growth > 0.0 && v > 0.0 && v.is_finite() && load > 0.0)
    {
        return None;
    }
    let ratio = load_rate / (growth * load * v);
    // ln(1 + x)/x
    let factor = if ratio == 0.0 {
        1.0
    } else {
        ratio.ln_1p() / ratio
    };
    let time = law.a / (growth * v) * factor;
    (ratio > -1.0 && time.is_finite()).then_some(time)
}

/// Fall of the friction force in a strong earthquake, in units of force: from steady sliding at
/// the plate speed to steady sliding at the coseismic speed.
///
/// ```text
/// Δτ = N Σ(b) ln(V_co/V_p) − N a ln(V_co/V_p)
/// ```
///
/// It is an estimate of the stress drop of a stick-slip cycle, because the speed at which sliding
/// ends depends on inertia or damping. The slip in an earthquake is then Δτ/k without inertia, up
/// to 2Δτ/k with it; over a cycle, the recurrence time is exactly the slip divided by V_p. NaN
/// unless both speeds are positive and finite.
///
/// ```
/// use stick_slip::{RateState, analysis::rate_state::stress_drop};
///
/// let law = RateState::aging(0.6, 0.01, 0.015, 8e-3, 1e-6)?;
/// let drop = stress_drop(&law, 5e7, 1e-9, 1.0);
/// assert!((drop - 5e7 * 0.005 * 1e9_f64.ln()).abs() < 1e-8);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn stress_drop<const STATES: usize>(
    law: &RateState<STATES>,
    load: f64,
    plate_speed: f64,
    coseismic_speed: f64,
) -> f64 {
    if !are_speeds(&[plate_speed, coseismic_speed]) {
        return f64::NAN;
    }
    let b: f64 = law.states.iter().map(|state| state.b).sum();
    load * (b - law.a) * (coseismic_speed / plate_speed).ln()
}

/// First integral of a spring-slider without inertia and damping at the critical stiffness k = N(b
/// − a)/D_c, pulled at the speed V_p: a number that stays constant along every motion.
/// Dimensionless.
///
/// ```text
/// aging   H = ((b − a)/a)(Θ − ln Θ) + xΘ − ln(xΘ)
/// slip    H = (b − a)G − a[y + ln(1 − y)],   G = ln x + 1/x − 1,
///         y = [a ln x + b ln Θ + (b − a)G]/a
/// ```
///
/// x = V/V_p, Θ = V_pθ/D_c. `v` is the speed V, and `memory` the value of φ = ln(V₀θ/D_c). Motions
/// with H above its value in steady sliding, Θ = x = 1, are closed curves; in the slip law for y <
/// 1, and `None` beyond, where the speed grows without bound. With a small mass H drifts in
/// proportion to the mass.
///
/// ```
/// use stick_slip::{RateState, analysis::rate_state::first_integral};
///
/// let law = RateState::aging(0.6, 0.01, 0.015, 1e-5, 1e-6)?;
/// let steady = first_integral(&law, 1e-7, 1e-7, law.memory_at(1e-7)).unwrap();
/// assert!((steady - 1.5).abs() < 1e-14);
/// let above = first_integral(&law, 1e-7, 2e-7, law.memory_at(1e-7)).unwrap();
/// assert!((above - (2.5 - 2_f64.ln())).abs() < 1e-14);
/// # Ok::<(), stick_slip::Error>(())
/// ```
pub fn first_integral(law: &RateState, plate_speed: f64, v: f64, memory: f64) -> Option<f64> {
    let (a, [state]) = (law.a, law.states);
    let fall = state.b - a;
    let ln_speed = (v / plate_speed).ln();
    let ln_state = memory - law.memory_at(plate_speed);
    let integral = match law.evolution {
        Evolution::Aging => {
            let product = ln_speed + ln_state;
            fall / a * (ln_state.exp() - ln_state) + product.exp() - product
        }
        Evolution::Slip => {
            let g = ln_speed + (-ln_speed).exp_m1();
            let y = (a * ln_speed + state.b * ln_state + fall * g) / a;
            fall * g - a * (y + (-y).ln_1p())
        }
    };
    integral.is_finite().then_some(integral)
}

fn are_speeds(numbers: &[f64]) -> bool {
    numbers.iter().all(|&v| v > 0.0 && v.is_finite())
}
