//! The coefficients of the variational equations.

use crate::series::{PowerSeries, TERMS};

/// A coefficient of the variational equations.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Coefficient {
    pub(super) series: PowerSeries,
    /// Number of terms up to the last that is not 0.
    pub(super) terms: usize,
}

impl From<PowerSeries> for Coefficient {
    fn from(series: PowerSeries) -> Self {
        let last = series.coefficients().iter().rposition(|c| *c != 0.0);
        let terms = last.map_or(0, |last| last + 1);
        Self { series, terms }
    }
}

impl Coefficient {
    pub(super) fn is_constant(&self) -> bool {
        self.terms <= 1
    }

    /// Returns this coefficient as a series about a later time.
    pub(super) fn shifted(&self, time: f64) -> Self {
        // Where a stiff contact settles, high orders overflow.
        let is_beyond = |k: &usize| *k > 0 && !self.series[*k].is_finite();
        let kept = (0..TERMS).find(is_beyond).unwrap_or(TERMS);
        let finite = |k: usize| if k < kept { self.series[k] } else { 0.0 };
        Self::from(PowerSeries::from_fn(finite).shifted(time))
    }
}

/// The series of a product.
pub(super) fn product(a: &PowerSeries, b: &PowerSeries) -> PowerSeries {
    if a.is_constant() {
        return b.scaled(a[0]);
    }
    PowerSeries::from_fn(|k| (0..=k).map(|l| a[l] * b[k - l]).sum())
}
