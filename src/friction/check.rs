//! Checks of a law before it is used, and whether it is constant.

use super::{Values, finite_at, taylor_coefficients, taylor_coefficients_on};
use crate::error::Error;
use crate::scalar::LONGEST;

/// The static coefficient of the law `of`, if it is finite and ≥ 0.
pub(crate) fn check_static(of: &'static str, static_coefficient: f64) -> Result<f64, Error> {
    Error::check(
        of,
        "static_coefficient",
        static_coefficient,
        static_coefficient >= 0.0,
        "static_coefficient ≥ 0",
    )
}

/// The error of a law whose static coefficient has turned NaN since the law was checked.
pub(crate) fn static_is_nan() -> Error {
    Error::InvalidParameter {
        of: "FrictionLaw",
        name: "static_coefficient",
        value: f64::NAN,
        allowed: "static_coefficient ≥ 0",
    }
}

/// The kinetic coefficient of the law `of`, if 0 ≤ μ_k ≤ μ_s.
pub(crate) fn check_kinetic(
    of: &'static str,
    static_coefficient: f64,
    kinetic_coefficient: f64,
) -> Result<f64, Error> {
    Error::check(
        of,
        "kinetic_coefficient",
        kinetic_coefficient,
        (0.0..=static_coefficient).contains(&kinetic_coefficient),
        "0 ≤ kinetic_coefficient ≤ static_coefficient",
    )
}

/// Checks that the kinetic coefficient of the law `of` at speed 0 is not negative.
pub(crate) fn check_opposing(of: &'static str, kinetic_coefficient: f64) -> Result<(), Error> {
    Error::check(
        of,
        "kinetic coefficient at speed 0",
        kinetic_coefficient,
        kinetic_coefficient >= 0.0,
        "friction that opposes slip: at least 0",
    )
    .map(drop)
}

/// Checks the rules of the trait [`FrictionLaw`] on which a system relies: μ_s is finite and ≥
/// μ̂(0) ≥ 0, the breakpoints ascend, and the law is continuous.
pub(crate) fn validate(law: &dyn Values) -> Result<(), Error> {
    let static_coefficient = law.static_coefficient();
    check_static("FrictionLaw", static_coefficient)?;
    let kinetic_coefficient = law.kinetic(0.0);
    finite_at(law, 0.0)?;
    check_opposing("FrictionLaw", kinetic_coefficient)?;
    if kinetic_coefficient > static_coefficient * (1.0 + STATIC_ROUNDING) {
        return Err(Error::StaticBelowKinetic {
            static_coefficient,
            kinetic_coefficient,
        });
    }
    let mut last = 0.0;
    for (index, value) in law.breakpoints().enumerate() {
        let [below, above] = [index, index + 1].map(|piece| law.kinetic_on(piece, value));
        let scale = static_coefficient.max(below.abs());
        let continuous = (below - above).abs() <= JUMP * scale;
        if !(value.is_finite() && value > last && continuous) {
            return Err(Error::BadBreakpoints { index, value });
        }
        last = value;
    }
    Ok(())
}

/// Part of μ_s by which μ̂(0) may exceed it, or fall below it, by rounding alone.
pub(crate) const STATIC_ROUNDING: f64 = 8.0 * f64::EPSILON;

/// Largest relative jump at a breakpoint that counts as rounding.
pub(crate) const JUMP: f64 = 1e-12;

/// Returns true if friction is constant near this sliding speed: all derivatives of the law are
/// zero.
pub(crate) fn is_constant_near(law: &dyn Values, speed: f64) -> bool {
    is_constant(&taylor_coefficients(law, speed))
}

/// Returns true if friction is constant on a piece of the law, expanded about a speed on it or at
/// its end.
pub(crate) fn is_constant_on(law: &dyn Values, piece: usize, speed: f64) -> bool {
    is_constant(&taylor_coefficients_on(law, piece, speed))
}

/// The speed up to which there is no kinetic friction: the end of the pieces on which the law and
/// all its derivatives are zero; 0 if there are none, infinite if there is no other piece.
pub(crate) fn frictionless_speed(law: &dyn Values) -> f64 {
    let starts = std::iter::once(0.0).chain(law.breakpoints());
    let mut rubbing = starts.enumerate().filter(|&(piece, speed)| {
        let series = taylor_coefficients_on(law, piece, speed);
        series[0] != 0.0 || !is_constant(&series)
    });
    rubbing.next().map_or(f64::INFINITY, |(_, speed)| speed)
}

fn is_constant(series: &[f64; LONGEST]) -> bool {
    series[1..].iter().all(|&c| c == 0.0)
}
