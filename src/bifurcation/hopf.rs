use std::ops::{ControlFlow, Range};

use super::positive;
use crate::friction::{FrictionLaw, taylor_coefficients};
use crate::integrator::{Polynomial, evaluate_four, quarters, reach, sign_changes};
use crate::scalar::LONGEST;
use crate::{Error, MassOnBelt};

/// Terms of the series below this, relative to the largest, are left out.
const TRUNCATION: f64 = 1e-16;

/// The series must give the slope of the law this well in between, relative to the largest term.
const DEFECT: f64 = 1e-12;

/// Belt velocities in `range`, ascending, at which the equilibrium loses or regains stability: where h1 changes sign,
///
/// ```text
/// h1(v) = 2β + γ² dμ̂/ds(v).
/// ```
///
/// The law is expanded in power series from one end of the range to the other, each used as far as it converges and checked in between, and the
/// roots of each are isolated, so that none is skipped; where h1 touches zero without changing sign nothing happens, and nothing is reported.
///
/// Source: Farshidianfar and Noei Aghaee, Eqs. 10a and 14, for any law.
///
/// # Errors
///
/// [`Error::InvalidParameter`] unless the range is finite, not empty and holds positive velocities; [`Error::NonFiniteFriction`] or
/// [`Error::NotAnalytic`] if the law has no series somewhere in it; [`Error::StepUnderflow`] never.
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
    let law = system.law();
    let mut roots: Vec<f64> = Vec::new();
    let mut ends: Vec<f64> = law
        .breakpoints()
        .filter(|&b| range.start < b && b < range.end)
        .collect();
    ends.push(range.end);
    let mut v = range.start;
    for end in ends {
        while v < end {
            crate::friction::finite_at(law, v)?;
            let series = stability_series(system, v);
            let largest = series[0].abs() + 2.0 * system.damping();
            let mut h = reach(&series, TRUNCATION * largest).min(end - v);
            let slope_at = |t: f64| effective_damping(system, v + t);
            while !fits(&series, h, largest, slope_at) && h > f64::EPSILON * v {
                h *= 0.5;
            }
            let _ = sign_changes(&series, h, &mut |t, _| {
                roots.push(v + t);
                ControlFlow::Continue(())
            });
            v = if v + h > v { (v + h).min(end) } else { end };
        }
    }
    roots.retain(|root| range.contains(root));
    Ok(roots)
}

fn effective_damping<L: FrictionLaw>(system: &MassOnBelt<L>, v: f64) -> f64 {
    2.0 * system.damping() + system.load() * system.law().slope(v)
}

/// h1(v + t) as a power series in t.
fn stability_series<L: FrictionLaw>(system: &MassOnBelt<L>, v: f64) -> Polynomial {
    let friction = taylor_coefficients::<LONGEST, _>(&system.law(), v);
    let mut series: Polynomial =
        std::array::from_fn(|k| system.load() * (k + 1) as f64 * friction[k + 1]);
    series[0] += 2.0 * system.damping();
    series
}

/// Whether the series gives the function at the quarters of [0, h].
fn fits(series: &Polynomial, h: f64, largest: f64, f: impl Fn(f64) -> f64) -> bool {
    std::iter::zip(quarters(h), evaluate_four(series, quarters(h)))
        // The end of the range may be a breakpoint, where the slope is that of the next piece.
        .take(3)
        .all(|(t, value)| (f(t) - value).abs() <= DEFECT * (largest + value.abs()))
}

/// How a pure-slip cycle is born at a Hopf point.
///
/// Source: the averaged equation A' = −½h1 A − (3/8)h3 A³ with h3 = γ² μ̂'''(v_b)/6 (Eq. 12 of Farshidianfar and Noei Aghaee, for any law).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Criticality {
    /// A stable cycle surrounds the unstable equilibrium: μ̂'''(v_b) > 0.
    Supercritical,
    /// An unstable cycle surrounds the stable equilibrium: μ̂'''(v_b) < 0.
    Subcritical,
    /// The third derivative is zero; higher ones decide.
    Degenerate,
}

/// Whether the Hopf point at the belt velocity v_b is super- or subcritical, from the sign of μ̂'''(|v_b|).
///
/// That v_b is a Hopf point is not checked. At a breakpoint the piece above counts.
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
