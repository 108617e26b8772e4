//! Limits of stick against slip backward and forward, of which one may be infinite.

/// N μ_s. An infinite limit holds under any load.
pub(crate) fn limit_force(load: f64, coefficient: f64) -> f64 {
    if coefficient == f64::INFINITY {
        coefficient
    } else {
        load * coefficient
    }
}

/// The larger of two limits that is finite: a scale of forces.
pub(crate) fn larger_finite(limits: [f64; 2]) -> f64 {
    match limits {
        [f64::INFINITY, limit] | [limit, f64::INFINITY] => limit,
        [one, other] => one.max(other),
    }
}
