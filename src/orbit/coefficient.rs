//! The coefficients of the variational equations.

use crate::series::PowerSeries;

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
}

/// The series of a product.
pub(super) fn product(a: &PowerSeries, b: &PowerSeries) -> PowerSeries {
    if a.is_constant() {
        return b.scaled(a[0]);
    }
    PowerSeries::from_fn(|k| (0..=k).map(|l| a[l] * b[k - l]).sum())
}
